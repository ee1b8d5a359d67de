"""Marching cubes: closed and manifold whatever the samples are, second order on smooth fields, as scikit-image has it."""

from __future__ import annotations

import numpy as np
import pytest

from limner.errors import SceneError
from limner.mesh.implicit.cube_cases import EDGES, MIDDLE, case_table
from limner.mesh.implicit.level_set import level_set
from limner.mesh.implicit.marching_cubes import marching_cubes
from limner.mesh.mesh import Mesh

BOX = ((-1.1, -1.2, -1.3), (1.3, 1.2, 1.1))


def ball(p: np.ndarray) -> np.ndarray:
    return np.linalg.norm(p, axis=1) - 1.0


def crosses(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    return p, np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])


def area(mesh: Mesh) -> float:
    return float(np.linalg.norm(crosses(mesh)[1], axis=1).sum() / 2)


def volume(mesh: Mesh) -> float:
    p, cross = crosses(mesh)
    return float((p[:, 0] * cross).sum() / 6)


def assert_closed_and_manifold(triangles: np.ndarray) -> None:
    """Each directed edge once and its opposite once; round each vertex the triangles make one loop."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    n = int(triangles.max()) + 1
    keys, turned = sides @ np.array([n, 1]), sides @ np.array([1, n])
    assert len(np.unique(keys)) == len(keys)
    np.testing.assert_array_equal(np.sort(keys), np.sort(turned))
    # A triangle a b c leads from b to c round a: every permutation of a vertex' neighbours must be one cycle
    onwards = {(a, b): c for t in triangles.tolist() for a, b, c in (t, t[1:] + t[:1], t[2:] + t[:2])}
    valence = np.bincount(triangles.reshape(-1), minlength=n)
    first = dict(reversed(list(onwards)))
    for vertex, start in first.items():
        length, at = 1, onwards[vertex, start]
        while at != start:
            length, at = length + 1, onwards[vertex, at]
        assert length == valence[vertex]


def test_a_ball_converges_with_the_square_of_the_resolution():
    """Vertices on the sphere, normals radial, V - E + F = 2; the errors of area and volume fall by 4 where the cubes are halved."""
    errors = []
    for n in (8, 16, 32):
        mesh = marching_cubes(ball, BOX, n)
        assert len(mesh.positions) - len(mesh.triangles) // 2 == 2
        np.testing.assert_allclose(np.linalg.norm(mesh.positions, axis=1), 1.0, atol=1e-4 * 2.4 / n)
        assert mesh.normals is not None
        np.testing.assert_allclose(mesh.normals, mesh.positions, atol=1e-4)
        assert ((mesh.normals[mesh.triangles] * crosses(mesh)[1][:, None]).sum(axis=-1) > 0.0).all()
        errors.append((4 * np.pi - area(mesh), 4 / 3 * np.pi - volume(mesh)))
    ratios = np.array(errors)[:-1] / np.array(errors)[1:]
    np.testing.assert_allclose(ratios, 4.0, rtol=0.15)


@pytest.mark.parametrize("kind", ["normal", "three values", "checkers"])
def test_random_fields_give_closed_manifolds(kind):
    """Every case with every choice on open faces: closed, one loop of triangles round each vertex, capped or padded with outside."""
    rng = np.random.default_rng(5)
    shape = (9, 10, 8)
    samples = {
        "normal": rng.normal(size=shape),
        "three values": rng.integers(-1, 2, shape).astype(float),  # zeros lie on the surface
        "checkers": (np.indices(shape).sum(axis=0) % 2 - 0.5) * rng.uniform(0.5, 1.5, shape),
    }[kind]
    capped = marching_cubes(samples, capped=True)
    assert_closed_and_manifold(capped.triangles)
    padded = marching_cubes(np.pad(samples, 1, constant_values=2.0))
    assert_closed_and_manifold(padded.triangles)
    # Both cut the same edges of the grid, and a cap stays in the box
    np.testing.assert_array_equal(np.sort(capped.triangles, axis=None), np.sort(padded.triangles, axis=None))
    assert (capped.positions >= 0.0).all()
    assert (capped.positions <= np.array(shape) - 1).all()
    assert volume(padded) > 0.0


def test_the_table_covers_all_cases_with_diagonals_inside_the_cube():
    """Every crossed edge is a vertex, no other is; what two triangles of a cube share lies in none of its faces."""
    table = case_table()
    faces = [{2 * axis + (corner >> axis & 1) for axis in range(3) if axis != along} for corner, along in EDGES]
    for entry in np.flatnonzero(np.diff(table.start)):
        case = entry // 64
        rows = table.triangles[table.start[entry] : table.start[entry + 1]]
        crossed = {k for k, (corner, axis) in enumerate(EDGES) if (case >> corner & 1) != (case >> (corner | 1 << axis) & 1)}
        assert set(rows.reshape(-1).tolist()) - {MIDDLE} == crossed
        sides = [frozenset((int(a), int(b))) for t in rows for a, b in zip(t, np.roll(t, -1), strict=True) if MIDDLE not in (a, b)]
        for side in sides:
            a, b = side
            assert (sides.count(side) == 1) == bool(faces[a] & faces[b])


def test_the_same_surface_from_a_function_a_table_and_densities():
    """A table of the ball's samples, and the same with signs and level turned: the same triangles; vertices within the grid's error."""
    axes = [np.linspace(low, high, 17) for low, high in zip(*BOX, strict=True)]
    samples = ball(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)).reshape(17, 17, 17)
    function = marching_cubes(ball, BOX, (16, 16, 16))
    table = marching_cubes(samples, BOX)
    densities = marching_cubes(3.0 - samples, BOX, level=3.0, inside="above")
    np.testing.assert_array_equal(table.triangles, function.triangles)
    np.testing.assert_allclose(np.linalg.norm(table.positions, axis=1), 1.0, atol=0.004)
    np.testing.assert_array_equal(densities.triangles, table.triangles)
    np.testing.assert_allclose(densities.positions, table.positions, atol=1e-6)
    np.testing.assert_allclose(densities.normals, table.normals, atol=1e-5)
    assert table.normals is not None
    assert (table.normals * function.normals).sum(axis=1).min() > 0.999


def test_slabs_leave_no_trace(monkeypatch):
    """Worked through layer by layer, middles of loops included, the mesh is the same."""
    samples = np.random.default_rng(6).normal(size=(12, 7, 6))
    whole = marching_cubes(samples, capped=True)
    monkeypatch.setattr("limner.mesh.implicit.marching_cubes._SAMPLES_AT_ONCE", 100)
    parts = marching_cubes(samples, capped=True)
    assert len(parts.positions) == len(whole.positions)
    assert_closed_and_manifold(parts.triangles)
    order = [np.lexsort(mesh.positions.T) for mesh in (whole, parts)]
    np.testing.assert_array_equal(whole.positions[order[0]], parts.positions[order[1]])


def test_a_cap_closes_what_leaves_the_box():
    """Half a space in a box: a block with the box's own faces, flat there; without a cap it is open."""
    cut = marching_cubes(lambda p: p[:, 1] - 0.3, ((0, 0, 0), (1, 1, 1)), 4, capped=True)
    assert_closed_and_manifold(cut.triangles)
    assert volume(cut) == pytest.approx(0.3, abs=1e-6)
    assert area(cut) == pytest.approx(2 * 1 + 4 * 0.3, abs=1e-6)
    p, cross = crosses(cut)
    size = np.linalg.norm(cross, axis=1)
    on_cap = (p[..., 1].max(axis=1) < 0.29) & (size > 1e-6)
    assert cut.normals is not None
    normals = cut.normals[cut.normal_triangles][on_cap]
    np.testing.assert_allclose(normals, np.repeat((cross[on_cap] / size[on_cap, None])[:, None], 3, axis=1), atol=1e-6)
    sheet = marching_cubes(lambda p: p[:, 1] - 0.3, ((0, 0, 0), (1, 1, 1)), 4)
    assert area(sheet) == pytest.approx(1.0, abs=1e-6)
    np.testing.assert_allclose(sheet.normals, [[0, 1, 0]] * len(sheet.positions), atol=1e-6)


def test_smooth_fields_agree_with_scikit_image():
    """The area of a gyroid's level, on the same samples, to a thousandth; as many triangles to a hundredth."""
    measure = pytest.importorskip("skimage.measure")
    x, y, z = np.meshgrid(*[np.linspace(-3.0, 3.5, 24)] * 3, indexing="ij")
    samples = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x) - 0.2
    ours = marching_cubes(samples)
    vertices, triangles, _, _ = measure.marching_cubes(samples, 0.0)
    assert area(ours) == pytest.approx(measure.mesh_surface_area(vertices, triangles), rel=1e-3)
    assert len(ours.triangles) == pytest.approx(len(triangles), rel=0.01)


def test_fewer_triangles_than_by_tetrahedra_for_the_same_volume():
    """A third of level_set's on the same grid, both within a thousandth of the ball."""
    cubes = marching_cubes(ball, BOX, (24, 24, 24))
    positions, triangles = level_set(ball, *BOX, 24)
    assert 2.5 < len(triangles) / len(cubes.triangles) < 3.5
    p = positions[triangles]
    for found in (volume(cubes), float(np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6)):
        assert found == pytest.approx(4 / 3 * np.pi, rel=1e-2)


def test_nothing_and_resolution_in_proportion():
    """Where nothing is crossed there are no triangles; a number goes along the longest edge of the box."""
    for value in (-1.0, 1.0):
        assert len(marching_cubes(np.full((3, 3, 3), value)).triangles) == 0
    assert len(marching_cubes(lambda p: np.ones(len(p)), BOX, 3).positions) == 0
    calls: list[int] = []
    marching_cubes(lambda p: calls.append(len(p)) or p[:, 0], ((0, 0, 0), (4, 2, 1)), 8)
    assert sum(calls[:2]) == 9 * 5 * 3


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: marching_cubes(ball), "bounds must be given"),
        (lambda: marching_cubes(ball, [(0, 0, 0), (1, 0, 1)]), "least and a greatest corner"),
        (lambda: marching_cubes(ball, [(0, 0, 0), (1, np.nan, 1)]), "least and a greatest corner"),
        (lambda: marching_cubes(ball, BOX, 0), "resolution must be at least 1"),
        (lambda: marching_cubes(ball, BOX, (4, 4)), "one number or three"),
        (lambda: marching_cubes(ball, BOX, 5000), "cubes are more than"),
        (lambda: marching_cubes(ball, BOX, level=np.inf), "level must be finite"),
        (lambda: marching_cubes(ball, BOX, inside="left"), "inside must be one of"),
        (lambda: marching_cubes(lambda p: p, BOX, 2), "must return shape"),
        (lambda: marching_cubes(lambda p: np.full(len(p), np.nan), BOX, 2), "must be finite, got nan"),
        (lambda: marching_cubes(np.zeros((1, 2, 2))), "at least 2 each"),
        (lambda: marching_cubes(np.zeros((2, 2))), "shape"),
        (lambda: marching_cubes(np.full((2, 2, 2), np.inf)), "sample"),
        (lambda: marching_cubes([["a"]]), "samples of shape"),
    ],
)
def test_what_is_no_field_is_refused(call, words):
    with pytest.raises(SceneError, match=words):
        call()
