"""Subdivision: against B-splines and box splines, counts, limits that further steps do not move, seams, creases, attributes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.interpolate import BSpline

from limner.errors import SceneError
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.mesh.subdivide import catmull_clark, loop, sqrt3

SCHEMES = {"loop": loop, "catmull_clark": catmull_clark, "sqrt3": sqrt3}


def edges_of(mesh: Mesh) -> np.ndarray:
    t = mesh.triangles
    return np.unique(np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1), axis=0)


def euler(mesh: Mesh) -> int:
    return len(mesh.positions) - len(edges_of(mesh)) + len(mesh.triangles)


def bare(mesh: Mesh) -> Mesh:
    return Mesh(mesh.positions, mesh.triangles)


def shaken(mesh: Mesh, seed: int = 0) -> Mesh:
    """The same mesh with every vertex moved a little."""
    rng = np.random.default_rng(seed)
    return dataclasses.replace(mesh, positions=mesh.positions + rng.normal(scale=0.1, size=mesh.positions.shape).astype(np.float32))


def corner_normals(mesh: Mesh) -> np.ndarray:
    assert mesh.normals is not None
    return mesh.normals[mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles]


MESHES = {
    "icosahedron": primitives.icosahedron(),
    "torus": primitives.torus(1.0, 0.3, 5, 4),
    "open cylinder": primitives.cylinder(1.0, 2.0, 5, capped=False),
    "disk": primitives.disk(1.0, 7),
}


@pytest.mark.parametrize("name", MESHES)
def test_counts_are_exact_and_topology_is_kept(name):
    """V + E (Loop), V + E + F (Catmull-Clark), V + F (root of three) vertices after a step; V - E + F as before."""
    mesh = MESHES[name]
    v, e, f = len(mesh.positions), len(edges_of(mesh)), len(mesh.triangles)
    for made, vertices, triangles in (
        (loop(mesh), v + e, 4 * f), (catmull_clark(mesh, polygons="triangles"), v + e + f, 6 * f), (sqrt3(mesh, 1), v + f, 3 * f),
        (sqrt3(mesh, 2), v + f + 2 * e, 9 * f),
    ):  # fmt: skip
        assert (len(made.positions), len(made.triangles)) == (vertices, triangles)
        assert euler(made) == euler(mesh)
        assert made.normals is not None
        np.testing.assert_allclose(np.linalg.norm(made.normals, axis=1), 1.0, atol=1e-6)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_affine_maps_commute_with_subdivision(scheme):
    """Weights add up to 1: subdividing a mapped mesh is mapping the subdivided one; colours that are linear in the place stay so."""
    subdivide = SCHEMES[scheme]
    matrix, offset = np.array([[1.0, 0.5, 0.0], [-0.2, 0.7, 0.1], [0.0, 0.3, 1.5]]), np.array([3.0, -1.0, 0.5])
    for mesh in (primitives.icosahedron(), primitives.cylinder(1.0, 2.0, 5, capped=False)):
        mesh = dataclasses.replace(mesh, colors=mesh.positions * np.float32(0.25) + np.float32(0.5))
        mapped = dataclasses.replace(mesh, positions=(mesh.positions @ matrix.T + offset).astype(np.float32))
        for limit in (False, True):
            one, other = (subdivide(m, 2, limit=limit) for m in (mesh, mapped))
            np.testing.assert_allclose(other.positions, one.positions @ matrix.T + offset, atol=2e-6)
            np.testing.assert_allclose(one.colors, one.positions * 0.25 + 0.5, atol=1e-6)


def test_loop_on_a_regular_grid_is_the_box_spline():
    """A unit height in one vertex of a triangular grid becomes 1/2 there and 1/12 at its six neighbours, as of the quartic box spline."""
    plane = primitives.plane(6.0, 6)
    heights = np.zeros(49)
    heights[24] = 1.0
    mesh = Mesh(np.stack([plane.positions[:, 0], heights, plane.positions[:, 2]], axis=1), plane.triangles)
    limit = loop(mesh, 1, limit=True).positions[:49, 1]
    neighbours = np.setdiff1d(mesh.triangles[(mesh.triangles == 24).any(axis=1)], [24])
    assert limit[24] == pytest.approx(1 / 2, abs=1e-7)
    np.testing.assert_allclose(limit[neighbours], 1 / 12, atol=1e-7)
    assert np.count_nonzero(limit) == 7
    # The spline's parts add up to 1, and so do these
    np.testing.assert_allclose(limit.sum(), 1.0, atol=1e-6)


def test_catmull_clark_on_a_grid_is_the_bicubic_b_spline():
    """Vertices and normals of the limit lie on the tensor product of uniform cubic B-splines, and on its border curves."""
    rng = np.random.default_rng(2)
    n = 6
    control = rng.normal(size=(n, n, 3))
    index = np.arange(n * n).reshape(n, n)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    made = catmull_clark((control.reshape(-1, 3), quads.tolist()), 2, limit=True)
    # What the grid's own parameters become is what the same steps make of a flat grid
    flat = np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), axis=-1).reshape(-1, 2)
    grid = catmull_clark((np.insert(flat.astype(float), 2, 0.0, axis=1), quads.tolist()), 2, limit=True)
    u, v = grid.positions[:, :2].astype(np.float64).T
    inner = (u >= 1) & (u <= n - 2) & (v >= 1) & (v <= n - 2)
    assert inner.sum() == (4 * (n - 3) + 1) ** 2
    knots = np.arange(n + 4) - 2.0
    along_u = BSpline(knots, control, 3)

    def spline(du: int, dv: int) -> np.ndarray:
        rows = (along_u.derivative(du) if du else along_u)(u[inner])
        across = [BSpline(knots, rows[k], 3) for k in range(len(rows))]
        return np.array([(curve.derivative(dv) if dv else curve)(at) for curve, at in zip(across, v[inner], strict=True)])

    np.testing.assert_allclose(made.positions[inner], spline(0, 0), atol=2e-6)
    normals = np.cross(spline(1, 0), spline(0, 1))
    assert made.normals is not None
    assert made.normal_triangles is not None
    of_vertex = np.zeros((len(made.positions), 3))
    of_vertex[made.triangles] = made.normals[made.normal_triangles]
    np.testing.assert_allclose(of_vertex[inner], normals / np.linalg.norm(normals, axis=1, keepdims=True), atol=1e-5)
    border = (v == 0) & (u >= 1) & (u <= n - 2)
    np.testing.assert_allclose(made.positions[border], BSpline(knots, control[:, 0], 3)(u[border]), atol=2e-6)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_borders_are_cubic_b_splines(scheme):
    """The rim of a disk is the closed B-spline of its corners, whatever lies within: every vertex of the limit's rim is on that curve."""
    mesh = shaken(bare(primitives.disk(1.0, 7)), 1)
    made = SCHEMES[scheme](mesh, 2, limit=True)
    rim = np.flatnonzero(np.bincount(edges_of(mesh).reshape(-1), minlength=8) == 3)
    rim = rim[np.argsort(np.arctan2(mesh.positions[rim, 2], mesh.positions[rim, 0]))]
    control = mesh.positions[np.concatenate([rim, rim[:3]])].astype(np.float64)
    curve = BSpline(np.arange(len(control) + 4) - 2.0, control, 3)
    parts = 3 if scheme == "sqrt3" else 4
    expected = curve(1.0 + np.arange(7 * parts) / parts)
    t = made.triangles
    sides = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    distinct, count = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    on_rim = made.positions[np.unique(distinct[count == 1])]
    assert len(on_rim) == 7 * parts
    distance = np.linalg.norm(on_rim[:, None] - expected, axis=2)
    assert distance.min(axis=1).max() < 1e-6
    assert distance.min(axis=0).max() < 1e-6


CREASED = {"creases": [[0, 1], [1, 3], [3, 2], [2, 0]]}


@pytest.mark.parametrize(
    ("scheme", "mesh", "options"),
    [
        ("loop", bare(primitives.disk(1.0, 5)), {}),
        ("loop", bare(primitives.box(2.0)), CREASED),
        ("loop", Mesh(primitives.disk(1.0, 9).positions, primitives.disk(1.0, 9).triangles[:5]), {"keep_corners": True}),
        ("catmull_clark", bare(primitives.plane(2.0, 2)), {}),
        ("catmull_clark", bare(primitives.box(2.0)), CREASED),
        ("catmull_clark", bare(primitives.disk(1.0, 9)), {"polygons": "triangles", "keep_corners": True}),
        ("sqrt3", bare(primitives.disk(1.0, 5)), {}),
    ],
)
def test_the_limit_is_where_more_steps_lead(scheme, mesh, options):
    """Limits of the vertices after few steps and after four are the same points with the same normals: inside, on borders and creases."""
    mesh = shaken(mesh, 3)
    first, later = (SCHEMES[scheme](mesh, levels, limit=True, **options) for levels in (2 if scheme == "sqrt3" else 1, 4))
    n = len(first.positions)
    np.testing.assert_allclose(later.positions[:n], first.positions, atol=1e-6)
    if scheme == "sqrt3":
        return
    for vertex in range(n):
        ours, theirs = (corner_normals(made)[made.triangles == vertex] for made in (first, later))
        for normal in ours:
            assert np.linalg.norm(theirs - normal, axis=1).min() < 1e-5


def test_limits_of_regular_solids():
    """Of an icosahedron by Loop, 1 - 5 w + sqrt(5) w; of a cube by Catmull-Clark half its corners; both nearly round."""
    beta = (5 / 8 - (3 / 8 + np.cos(2 * np.pi / 5) / 4) ** 2) / 5
    weight = 1 / (5 + 3 / (8 * beta))
    ball = loop(primitives.icosahedron(), 3, limit=True)
    radii = np.linalg.norm(ball.positions.astype(np.float64), axis=1)
    np.testing.assert_allclose(radii[:12], 1 - 5 * weight + np.sqrt(5) * weight, rtol=1e-6)
    assert np.ptp(radii) < 0.02
    assert ball.normals is not None
    assert ball.normal_triangles is not None
    towards = ball.positions / radii[:, None]
    assert (corner_normals(ball) * towards[ball.triangles]).sum(axis=-1).min() > 0.999
    cube = catmull_clark(primitives.box(2.0), 3, limit=True)
    np.testing.assert_allclose(np.abs(cube.positions[:8]), 0.5, atol=1e-7)
    assert np.ptp(np.linalg.norm(cube.positions, axis=1)) < 0.08


def test_creases_for_ever_and_for_a_while():
    """A box whose edges are all sharp stays a box with flat normals; a crease for one step is one for ever in that step only."""
    box = primitives.box((1.0, 2.0, 3.0))
    sides = box.positions[edges_of(box)]
    creases = edges_of(box)[(np.ptp(sides, axis=1) > 0).sum(axis=1) == 1]
    sharp = catmull_clark(box, 2, creases=creases)
    on_face = np.abs(np.abs(sharp.positions) - (0.5, 1.0, 1.5)) < 1e-6
    assert on_face.any(axis=1).all()
    np.testing.assert_allclose(np.sort(np.abs(corner_normals(sharp)), axis=-1), np.broadcast_to([0, 0, 1], (192, 3, 3)), atol=1e-6)
    once = [catmull_clark(box, 1, creases=creases, sharpness=s).positions for s in (1.0, np.inf)]
    np.testing.assert_array_equal(*once)
    twice = [np.abs(catmull_clark(box, 2, creases=creases, sharpness=s).positions).sum() for s in (0.0, 0.5, 1.0, 1.5, np.inf)]
    assert (np.diff(twice) > 0.0).all()
    smooth = catmull_clark(box, 2).positions
    np.testing.assert_array_equal(catmull_clark(box, 2, creases=creases, sharpness=0.0).positions, smooth)


@pytest.mark.parametrize("rule", ["smooth", "linear"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_texture_seams_stay_seams(scheme, rule):
    """Round a cylinder, u goes from 0 to 1 still; on both sides of the seam v agrees; no triangle runs back over it."""
    made = SCHEMES[scheme](primitives.cylinder(1.0, 2.0, 6, capped=False), 2, uv_rule=rule)
    assert made.uvs is not None
    uv = made.uvs[made.uv_triangles].reshape(-1, 2).astype(np.float64)
    assert np.ptp(uv[:, 0].reshape(-1, 3), axis=1).max() < 0.5
    assert uv.min() == 0.0
    assert uv.max() == 1.0
    vertex = made.triangles.reshape(-1)
    left, right = (dict(zip(vertex[uv[:, 0] == u], uv[uv[:, 0] == u, 1], strict=True)) for u in (0.0, 1.0))
    assert left.keys() == right.keys()
    assert len(left) > 2
    for key, v in left.items():
        assert v == pytest.approx(right[key], abs=1e-6)


def test_what_lives_on_a_mesh_goes_with_it():
    """Attributes of vertices are averaged like positions, those of faces and materials are handed on; areas keep their materials."""
    mesh = primitives.plane(2.0, 2)
    x = mesh.positions[:, 0]
    middle = mesh.positions[mesh.triangles].mean(axis=1)[:, 0]
    slots = (middle > 0.0).astype(np.int32)
    mesh = dataclasses.replace(
        mesh,
        scalars={"x": x},
        vertex_attributes={"place": mesh.positions.astype(np.float64), "phase": np.exp(1j * 0.0) * x},
        face_attributes={"number": np.arange(8)},
        triangle_materials=slots,
        uvs1=mesh.uvs,
    )
    for made in (loop(mesh, 2), catmull_clark(mesh, 2), sqrt3(mesh, 2), sqrt3(mesh, 1)):
        assert made.scalars is not None
        assert made.vertex_attributes is not None
        assert made.face_attributes is not None
        np.testing.assert_allclose(made.scalars["x"], made.positions[:, 0], atol=1e-6)
        np.testing.assert_allclose(made.vertex_attributes["place"], made.positions, atol=1e-6)
        np.testing.assert_allclose(made.vertex_attributes["phase"], made.positions[:, 0] + 0j, atol=1e-6)
        np.testing.assert_array_equal(slots[made.face_attributes["number"]], made.triangle_materials)
        np.testing.assert_array_equal(made.uvs, made.uvs1)
        centers = made.positions[made.triangles].mean(axis=1)[:, 0]
        np.testing.assert_array_equal(centers > 0.0, made.triangle_materials == 1)


def test_polygons_of_any_size():
    """A dodecahedron's fans are its pentagons; a concave polygon is one; 60 quadrilaterals come of 12 pentagons."""
    fans = catmull_clark(primitives.dodecahedron(), 1, polygons=np.arange(36) // 3)
    assert len(fans.triangles) == 120
    assert euler(fans) == 2
    np.testing.assert_array_equal(np.unique(np.bincount(fans.triangles.reshape(-1))[-12:]), [10])
    arrow = ([(0, 0, 0), (2, 0, 0), (1, 0.5, 0), (2, 2, 0), (0, 2, 0)], [[0, 1, 2, 3, 4]])
    once = catmull_clark(arrow, 1)
    np.testing.assert_allclose(once.positions[-1], np.mean(arrow[0], axis=0), atol=1e-7)
    # What comes out knows its quadrilaterals: going on is as two steps at once
    np.testing.assert_allclose(catmull_clark(once, 1).positions, catmull_clark(arrow, 2).positions, atol=1e-6)


def test_meshes_that_are_no_surfaces_do_not_break_it():
    """Edges with three triangles, triangles turned against each other, collapsed ones and unused vertices: finite numbers, kept counts."""
    rng = np.random.default_rng(4)
    mesh = Mesh(rng.normal(size=(9, 3)), [[0, 1, 2], [0, 1, 3], [1, 0, 4], [4, 5, 6], [4, 6, 5], [7, 7, 1]])
    for scheme, subdivide in SCHEMES.items():
        for limit in (False, True):
            options = {"polygons": "triangles"} if scheme == "catmull_clark" else {}
            made = subdivide(mesh, 2, limit=limit, **options)
            assert np.isfinite(made.positions).all()
            assert np.isfinite(made.normals).all()
            np.testing.assert_array_equal(made.positions[8], mesh.positions[8])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: loop(primitives.box(), -1), "loop.levels must be at least 0"),
        (lambda: loop(primitives.box(), 1.5), "loop.levels must be a whole number"),
        (lambda: loop(primitives.box(), 30), "would make 13,835,058,055,282,163,712 triangles"),
        (lambda: catmull_clark(primitives.box(), 30), "catmull_clark.levels = 30"),
        (lambda: sqrt3(primitives.box(), 40), "sqrt3.levels = 40"),
        (lambda: loop(Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int))), "loop.mesh must have triangles"),
        (lambda: loop(primitives.box(), creases=[[0, 7]]), "is not an edge"),
        (lambda: loop(primitives.box(), creases=[[0, 9]]), "must lie in 0..7"),
        (lambda: loop(primitives.box(), creases=[[0.5, 1]]), "loop.creases must be vertex pairs"),
        (lambda: loop(primitives.box(), creases=[[0, 1]], sharpness=-1.0), "loop.sharpness"),
        (lambda: loop(primitives.box(), uv_rule="wild"), "loop.uv_rule"),
        (lambda: catmull_clark(primitives.box(), 0, limit=True), "catmull_clark.levels must be at least 1"),
        (lambda: catmull_clark(primitives.box(), polygons="hexagons"), "catmull_clark.polygons"),
        (lambda: catmull_clark(primitives.box(), polygons=[1, 2]), "one whole number per triangle"),
        (lambda: catmull_clark(primitives.box(), polygons=np.zeros(12, dtype=int)), "polygon 0 has no border"),
        (lambda: catmull_clark(primitives.icosahedron(), polygons=np.r_[np.arange(19), 0]), "not one closed line"),
        (lambda: catmull_clark((np.zeros((3, 3)), [[0, 1]])), "at least 3 indices"),
    ],
)
def test_what_cannot_be_subdivided_is_refused(call, words):
    with pytest.raises(SceneError, match=words.replace("(", r"\(")):
        call()
