"""Making meshes sound: what each step does to what is known, that nothing on the mesh gets lost, and that heaps of anything come out
sound."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surfaces import (
    bow_tie,
    fin,
    heap,
    klein_bottle,
    moebius_strip,
    open_cylinder,
    plate,
    platonic_solids,
    shuffled,
    split_apart,
    voxels,
    with_all_attributes,
)

from limner.errors import SceneError
from limner.mesh.adjacency import adjacency
from limner.mesh.examine.measure import area, signed_volume, volume
from limner.mesh.examine.report import topology_report
from limner.mesh.examine.topology import boundary_loops, is_manifold
from limner.mesh.mesh import Mesh
from limner.mesh.normals import face_normals
from limner.mesh.repair.repair import RepairReport, repair
from limner.mesh.shapes import primitives

NOTHING = {"weld": None, "degenerate": False, "duplicates": False, "junctions": False, "orient": False, "unused": False}


def done(report: RepairReport) -> dict[str, int]:
    """What is not 0."""
    return {name: count for name, count in report.as_dict().items() if count}


def without(mesh: Mesh, triangles: list[int]) -> Mesh:
    """A mesh with holes."""
    return Mesh(mesh.positions, np.delete(mesh.triangles, triangles, axis=0), name=mesh.name)


@pytest.mark.parametrize("name", platonic_solids())
def test_what_is_sound_stays_as_it_is(name):
    """Nothing to repair, not a bit changed; by all steps, and by none."""
    mesh = with_all_attributes(platonic_solids()[name])
    for options in ({"split": True, "fill_holes": True}, NOTHING):
        made, report = repair(mesh, **options)
        assert not report.has_changed
        assert str(report) == "nothing to repair"
        for field in dataclasses.fields(Mesh):
            ours, theirs = getattr(made, field.name), getattr(mesh, field.name)
            if isinstance(theirs, dict):
                assert list(ours) == list(theirs)
                for key in theirs:
                    np.testing.assert_array_equal(ours[key], theirs[key])
            else:
                np.testing.assert_array_equal(ours, theirs)


@settings(max_examples=15)
@given(st.integers(0, 10_000), st.sampled_from([*platonic_solids(), "torus"]))
def test_a_torn_and_turned_solid_is_sewn(seed, name):
    """Every triangle alone, half of them turned over, some twice, dust around: the solid comes back, facing outwards."""
    rng = np.random.default_rng(seed)
    solid = plate(1) if name == "torus" else platonic_solids()[name]
    torn = shuffled(split_apart(solid), rng)
    again = rng.integers(0, len(torn.triangles), 3)
    triangles = np.concatenate([torn.triangles, torn.triangles[again], [[0, 0, 1], [2, 2, 2]]])
    mesh = Mesh(np.concatenate([torn.positions, rng.random((4, 3))]), triangles)
    made, report = repair(mesh)
    assert is_manifold(made)
    assert volume(made) == pytest.approx(volume(solid), rel=1e-6)
    assert len(made.positions) == len(solid.positions)
    assert (report.dropped_duplicates, report.dropped_degenerate, report.dropped_vertices) == (3, 2, 4)
    assert report.welded_vertices == len(torn.positions) - len(solid.positions)


def test_welding_by_distance():
    """Vertices a little apart become the first of them, also in chains; those further apart do not; None welds nothing."""
    rng = np.random.default_rng(1)
    torn = split_apart(primitives.sphere(1.0, 8))
    noisy = Mesh(torn.positions + rng.uniform(-1e-4, 1e-4, torn.positions.shape), torn.triangles)
    made, report = repair(noisy, weld=1e-3)
    assert topology_report(made).genus == 0
    assert is_manifold(made)
    assert report.welded_vertices == len(torn.positions) - len(primitives.sphere(1.0, 8).positions)
    assert repair(noisy, weld=1e-6)[1].welded_vertices == 0
    assert repair(torn, weld=None)[1].welded_vertices == 0
    assert set(map(tuple, made.positions.tolist())) <= set(map(tuple, noisy.positions.tolist()))


def test_what_looks_different_is_not_welded():
    """Two triangles side by side, whose common corners have other colours, or another attribute: they stay apart, and it is said."""
    positions = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    triangles = [[0, 1, 2], [3, 4, 5]]
    shades = np.array([[1, 0, 0]] * 3 + [[0, 0, 1]] * 3, dtype=np.float32)
    for held in ({"colors": shades}, {"vertex_attributes": {"side": shades[:, 0] > 0}}, {"scalars": {"heat": shades[:, 0]}}):
        made, report = repair(Mesh(positions, triangles, **held))
        assert done(report) == {"vertices_kept_apart": 2}
        assert not report.has_changed
        assert len(made.positions) == 6
    made, report = repair(Mesh(positions, triangles, colors=np.ones((6, 3))))
    assert done(report) == {"welded_vertices": 2}
    assert len(made.colors) == 4


def test_seams_survive_welding():
    """A box with a normal and a texture coordinate for each corner is welded to 8 vertices; every corner keeps what it had."""
    box = primitives.box()
    corners = box.positions[box.triangles].reshape(-1, 3)
    index = np.arange(36).reshape(12, 3)
    uvs = box.uvs[box.uv_triangles].reshape(-1, 2)
    normals = box.normals[box.normal_triangles].reshape(-1, 3)
    tangents = np.concatenate([np.roll(normals, 1, axis=1), np.ones((36, 1))], axis=1)
    made, _ = repair(Mesh(corners, index, normals=normals, uvs=uvs, uvs1=1 - uvs, tangents=tangents))
    assert len(made.positions) == 8
    assert is_manifold(made)
    np.testing.assert_array_equal(made.positions[made.triangles].reshape(-1, 3), corners)
    np.testing.assert_array_equal(made.normals[made.normal_triangles].reshape(-1, 3), normals)
    np.testing.assert_array_equal(made.uvs[made.uv_triangles].reshape(-1, 2), uvs)
    np.testing.assert_array_equal(made.uvs1[made.uv_triangles].reshape(-1, 2), 1 - uvs)
    np.testing.assert_array_equal(made.tangents[made.normal_triangles].reshape(-1, 4), tangents)


def test_turned_triangles_take_their_normals_along():
    """A normal that pointed to the front still does; one that was right all along is left alone; bitangents stay where they were."""
    box = primitives.box()
    over = box.triangles[:, ::-1].copy()
    tangents = np.concatenate([np.roll(box.normals, 1, axis=1), np.ones((6, 1))], axis=1)
    inward = Mesh(box.positions, over, normals=-box.normals, normal_triangles=box.normal_triangles[:, ::-1], tangents=tangents)
    made, report = repair(inward)
    assert done(report) == {"flipped_triangles": 12}
    fronts = face_normals(made.positions, made.triangles)
    np.testing.assert_array_equal(made.normals[made.normal_triangles], np.repeat(fronts[:, None], 3, axis=1))
    after = made.tangents[made.normal_triangles]
    bitangents = after[..., 3:] * np.cross(fronts[:, None], after[..., :3])
    before = inward.tangents[inward.normal_triangles]
    old = before[..., 3:] * np.cross(-fronts[:, None], before[..., :3])
    np.testing.assert_array_equal(bitangents, old[:, [0, 2, 1]])
    outward = Mesh(box.positions, over, normals=box.normals, normal_triangles=box.normal_triangles[:, ::-1])
    made, _ = repair(outward)
    np.testing.assert_array_equal(made.normals[made.normal_triangles], np.repeat(fronts[:, None], 3, axis=1))


def test_closed_pieces_face_outwards_but_for_cavities():
    """Of two boxes side by side both are turned; of one inside another that faces inwards, none; twice inside, the inner one is."""
    box = primitives.box()

    def boxes(*kinds):
        positions = [scale * box.positions + np.array([x, 0, 0]) for scale, x, _ in kinds]
        triangles = [8 * k + (box.triangles[:, ::-1] if over else box.triangles) for k, (_, _, over) in enumerate(kinds)]
        return Mesh(np.concatenate(positions), np.concatenate(triangles))

    assert repair(boxes((1, 0, True), (1, 3, True)))[1].flipped_triangles == 24
    made, report = repair(boxes((4, 0, False), (1, 0.3, True)))
    assert report.flipped_triangles == 0
    assert volume(made) == pytest.approx(63.0)
    assert repair(boxes((4, 0, False), (2, 0, False), (1, 0.3, True)))[1].flipped_triangles == 12
    assert repair(boxes((4, 0, False), (2, 0, True), (1, 9, True)))[1].flipped_triangles == 12


def test_open_and_one_sided_pieces():
    """An open piece faces as most of its area did; what cannot be oriented is left, and it is said."""
    tube = open_cylinder(12)
    turned = tube.triangles.copy()
    turned[:4] = turned[:4, ::-1]
    made, report = repair(Mesh(tube.positions, turned))
    assert done(report) == {"flipped_triangles": 4}
    assert signed_volume(made) == pytest.approx(signed_volume(tube))
    for mesh in (moebius_strip(), klein_bottle()):
        made, report = repair(mesh, junctions=False)
        assert done(report) == {"one_sided_pieces": 1}
        np.testing.assert_array_equal(made.triangles, mesh.triangles)


def test_t_junctions_are_closed():
    """A large triangle beside three small ones: it is split at their corners; its texture coordinates are those of its plane."""
    positions = np.array([[0, 0, 0], [3, 0, 0], [1.5, 2, 0], [1, 0, 0], [2, 0, 0], [1.5, -1, 0]], dtype=np.float32)
    mesh = with_all_attributes(Mesh(positions, [[0, 1, 2], [0, 5, 3], [3, 5, 4], [4, 5, 1]]))
    mesh = dataclasses.replace(mesh, normals=np.tile(np.float32([0, 0, 1]), (6, 1)))
    made, report = repair(mesh)
    assert done(report) == {"closed_t_junctions": 2}
    assert topology_report(made).is_sound
    assert [len(loop) for loop in boundary_loops(made)] == [4]
    assert area(made) == pytest.approx(area(mesh))
    check_what_lives_on_it(made)
    assert np.bincount(made.face_attributes["number"]).tolist() == [3, 1, 1, 1]


def test_a_cap_without_area_leaves_no_crack():
    """A triangle of three points on a line is dropped, and the neighbour on its long side split where its middle corner was."""
    positions = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 1, 0], [1, -1, 0]]
    made, report = repair(Mesh(positions, [[0, 1, 2], [0, 2, 3], [0, 4, 1], [1, 4, 2]]))
    assert (report.dropped_degenerate, report.closed_t_junctions) == (1, 1)
    assert topology_report(made).is_sound
    assert area(made) == pytest.approx(2.0)
    assert len(boundary_loops(made)) == 1


@pytest.mark.parametrize("name", ["cube", "dodecahedron", "icosahedron"])
def test_holes_are_filled(name):
    """Whatever triangles are missing: the solid is closed again, and with flat faces it encloses what it did."""
    solid = platonic_solids()[name]
    faces = solid.face_attributes["polygon"] if solid.face_attributes else np.arange(len(solid.triangles))
    made, report = repair(without(solid, np.flatnonzero(faces <= 1).tolist()), fill_holes=True)
    assert is_manifold(made)
    assert report.holes_left == 0
    if name != "icosahedron":
        missing_neighbours = without(solid, np.flatnonzero(faces == 0).tolist())
        made, _ = repair(missing_neighbours, fill_holes=True)
        assert volume(made) == pytest.approx(volume(solid), rel=1e-6)


def test_holes_that_meet_in_a_vertex():
    """Two holes with a common corner are two: the plate with two handles is what it was."""
    solid = plate(2)
    for missing in ([0, 1, 2], [0, 4]):
        made, report = repair(without(solid, missing), fill_holes=True)
        assert topology_report(made).genus == 2
        assert report.holes_left == 0
        assert volume(made) == pytest.approx(volume(solid))


@pytest.mark.parametrize("size", [1e-30, 1e-8, 1e8, 1e30])
def test_size_does_not_matter(size):
    """Tiny or huge, a torn plate with a hole becomes whole, and T-junctions are found; the default tolerances go with the size."""
    solid = plate(1)
    torn = split_apart(without(solid, [0, 4]))
    made, report = repair(Mesh(torn.positions * np.float32(size), torn.triangles), fill_holes=True)
    assert is_manifold(made)
    assert report.filled_holes == 2
    assert volume(made) / size**3 == pytest.approx(8.0)
    roof = np.array([[0, 0, 0], [3, 0, 0], [1.5, 2, 0], [1, 0, 0], [1.5, -1, 0]]) * size
    assert repair(Mesh(roof, [[0, 1, 2], [0, 4, 3], [3, 4, 1]]))[1].closed_t_junctions == 1


def test_a_concave_hole_is_filled_flat():
    """The lid of an extruded arrow: a flat cover of the right area, where a fan round the middle would stick out."""
    outline = np.array([[0, 0], [4, -2], [1, 0], [4, 2]], dtype=float)
    ring = np.concatenate([np.c_[outline, [0] * 4], np.c_[outline, [1] * 4]])
    k, ahead = np.arange(4), (np.arange(4) + 1) % 4
    walls = Mesh(ring, np.concatenate([np.stack([k, ahead, 4 + ahead], 1), np.stack([k, 4 + ahead, 4 + k], 1)]))
    made, report = repair(walls, fill_holes=True)
    assert done(report) == {"filled_holes": 2, "added_triangles": 4}
    shoelace = 0.5 * abs(float(np.sum(outline[:, 0] * np.roll(outline[:, 1], -1) - outline[:, 1] * np.roll(outline[:, 0], -1))))
    assert volume(made) == pytest.approx(shoelace)
    assert area(made) == pytest.approx(area(walls) + 2 * shoelace)


def test_what_fills_a_hole_takes_after_its_neighbours():
    """A box without a lid: the new triangles face up, with normals of their own, since those of the walls lie across the edge; of a
    sphere they are the neighbours'. Numbers of triangles, materials and texture coordinates are those of triangles beside."""
    box = primitives.box()
    lid = np.flatnonzero(face_normals(box.positions, box.triangles)[:, 1] > 0.5)
    kept = np.delete(np.arange(12), lid)
    walls = Mesh(
        box.positions, box.triangles[kept], normals=box.normals, normal_triangles=box.normal_triangles[kept], uvs=box.uvs,
        uv_triangles=box.uv_triangles[kept], triangle_materials=kept, face_attributes={"number": kept},
    )  # fmt: skip
    made, report = repair(walls, fill_holes=4)
    assert done(report) == {"filled_holes": 1, "added_triangles": 2}
    np.testing.assert_array_equal(made.normals[made.normal_triangles[10:]].reshape(-1, 3), [[0, 1, 0]] * 6)
    assert set(made.triangle_materials[10:].tolist()) <= set(kept.tolist())
    np.testing.assert_array_equal(made.triangle_materials, made.face_attributes["number"])
    assert repair(walls, fill_holes=3)[1].holes_left == 1
    ball = primitives.sphere(1.0, 12)
    open_ball = Mesh(ball.positions, ball.triangles[40:], normals=ball.normals, name="ball")
    made, _ = repair(open_ball, fill_holes=True, unused=False)
    np.testing.assert_array_equal(made.normals, ball.normals)
    assert made.normal_triangles is None


def test_splitting_what_is_no_manifold():
    """A fin, a bow-tie, cubes that touch in an edge or a corner come apart; the copies stand where the vertices stood."""
    corner, edge = voxels((0, 0, 0), (1, 1, 1)), voxels((0, 0, 0), (1, 1, 0))
    for mesh, copies, pieces in ((fin(), 4, 3), (bow_tie(), 1, 2), (corner, 1, 2), (edge, 2, 2)):
        made, report = repair(with_all_attributes(mesh), split=True)
        assert report.split_vertices == copies
        assert topology_report(made).is_manifold_with_boundary
        assert topology_report(made).n_components == pieces
        assert area(made) == pytest.approx(area(mesh))
        check_what_lives_on_it(made)


def check_what_lives_on_it(made: Mesh) -> None:
    """Values of `with_all_attributes` are still those of the place; edges know their middles, unless they are new."""
    np.testing.assert_allclose(made.colors, np.abs(made.positions), atol=1e-6)
    np.testing.assert_array_equal(made.scalars["x"], made.positions[:, 0])
    np.testing.assert_array_equal(made.vertex_attributes["place"], made.positions)
    corners = made.triangles if made.uv_triangles is None else made.uv_triangles
    places = made.positions[made.triangles]
    np.testing.assert_allclose(made.uvs[corners], places[..., :2] + 2.0 * places[..., 2:], atol=1e-5)
    np.testing.assert_array_equal(made.uvs1[corners], -made.uvs[corners])
    np.testing.assert_array_equal(made.triangle_materials, made.face_attributes["number"])
    known, middle = made.edge_attributes["known"], made.edge_attributes["middle"]
    np.testing.assert_allclose(middle[known], made.positions[adjacency(made).edges].mean(axis=1)[known], atol=1e-6)
    assert np.isnan(middle[~known]).all()


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.integers(3, 9), st.integers(0, 16))
def test_heaps_come_out_sound(seed, n_vertices, n_triangles):
    """Whatever triangles are thrown together on a small lattice: afterwards a manifold with boundary, nothing degenerate or twice, nothing
    unused, oriented but for what cannot be; what lives on it is right; and so it stays when holes are filled."""
    mesh = with_all_attributes(heap(np.random.default_rng(seed), n_vertices, n_triangles))
    made, report = repair(mesh, split=True, fill_holes=False)
    found = topology_report(made)
    assert found.is_manifold_with_boundary
    assert found.degenerate_triangles == found.duplicate_triangles == found.unused_vertices == ()
    assert found.is_consistently_oriented or report.one_sided_pieces
    if len(made.triangles):
        check_what_lives_on_it(made)
    json.dumps(report.as_dict())
    filled, _ = repair(made, weld=None, split=True, fill_holes=True)
    assert topology_report(filled).is_manifold_with_boundary
    assert not topology_report(filled).duplicate_triangles


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"weld": -1.0}, "weld must be a distance of at least 0, got -1"),
        ({"weld": float("nan")}, "weld must be a distance"),
        ({"fill_holes": -3}, "fill_holes must be True, False or a number of edges, got -3"),
    ],
)
def test_nonsense(options, complaint):
    """One line."""
    with pytest.raises(SceneError, match=complaint):
        repair(primitives.box(), **options)


def test_nothing_at_all():
    """No triangles: vertices are dropped, or kept where that is asked for."""
    dots = Mesh(np.eye(3), np.zeros((0, 3), int))
    assert len(repair(dots, split=True, fill_holes=True)[0].positions) == 0
    assert len(repair(dots, unused=False)[0].positions) == 3
    assert str(repair(dots)[1]) == "3 unused vertices dropped"
