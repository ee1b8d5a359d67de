"""Normals made for meshes without: flat, smooth, and smooth up to creases."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError
from limner.mesh.normals import crease_normals, face_normals, vertex_normals
from limner.mesh.shapes import primitives

MESHES = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "meshes"


def oracle(positions, triangles, crease_degrees) -> np.ndarray:
    """The rule by the letter, corner by corner: (m, 3, 3)."""
    faces = face_normals(positions, triangles)
    made = np.zeros((len(triangles), 3, 3))
    for face, corners in enumerate(triangles):
        for k, vertex in enumerate(corners):
            for other, its in enumerate(triangles):
                for j in range(3):
                    if its[j] != vertex or faces[face] @ faces[other] < np.cos(np.radians(crease_degrees)) - 1e-6:
                        continue
                    p, q, r = (positions[its[(j + i) % 3]].astype(np.float64) for i in range(3))
                    cosine = (q - p) @ (r - p) / np.linalg.norm(q - p) / np.linalg.norm(r - p)
                    made[face, k] += np.arccos(np.clip(cosine, -1, 1)) * faces[other]
    return made / np.linalg.norm(made, axis=-1, keepdims=True)


@given(st.integers(0, 10_000), st.floats(0.0, 180.0))
def test_crease_normals_follow_the_rule(seed, crease_degrees):
    """Against the oracle, on a crumpled sphere whose vertices are partly smooth and partly creased."""
    rng = np.random.default_rng(seed)
    mesh = primitives.uv_sphere(6, 4)
    positions = (mesh.positions * rng.uniform(0.6, 1.2, (len(mesh.positions), 1))).astype(np.float32)
    faces = face_normals(positions, mesh.triangles)
    angles = np.degrees(np.arccos(np.clip(faces @ faces.T, -1, 1)))
    if np.abs(angles - crease_degrees).min() < 1e-2:
        return
    normals, index = crease_normals(positions, mesh.triangles, crease_degrees)
    np.testing.assert_allclose(normals[index], oracle(positions, mesh.triangles, crease_degrees), atol=1e-5)


def test_cube_stays_faceted():
    """Faces at right angles are not mixed: six directions, three at each vertex, and each corner has its face's."""
    mesh = primitives.box()
    normals, index = crease_normals(mesh.positions, mesh.triangles)
    np.testing.assert_array_equal(normals[index], np.repeat(face_normals(mesh.positions, mesh.triangles)[:, None], 3, axis=1))
    assert len(normals) == 8 + 24
    assert len(np.unique(index)) == 24


def test_smooth_cube_has_its_diagonals():
    """Beyond 90 degrees a cube's vertex averages its three faces alike, whichever way their squares are cut: the weights are
    angles."""
    mesh = primitives.box()
    expected = np.sign(mesh.positions) / np.sqrt(3.0)
    normals, index = crease_normals(mesh.positions, mesh.triangles, 100.0)
    np.testing.assert_allclose(normals[index], expected[mesh.triangles], atol=1e-6)
    np.testing.assert_allclose(vertex_normals(mesh.positions, mesh.triangles), expected, atol=1e-6)


def test_sphere_gets_radial_normals_shared():
    """One normal per vertex, within a tenth of the angle between its faces of the radius."""
    mesh = primitives.sphere(1.0, 24)
    normals, index = crease_normals(mesh.positions, mesh.triangles)
    assert len(normals) == len(mesh.positions)
    np.testing.assert_array_equal(index, mesh.triangles)
    assert (normals * mesh.normals).sum(axis=1).min() > np.cos(0.1 * np.pi / 24)


@pytest.mark.parametrize(("degrees", "kept"), [(60.0, True), (39.0, False)], ids=["sharp", "blunt"])
def test_wedge_keeps_its_crease_and_smooths_a_blunt_one(degrees, kept):
    """A roof of two strips: across a ridge of 60 degrees the normals stay apart, across one of 39 they are one."""
    a = np.radians(degrees) / 2.0
    along = np.arange(5.0)
    left = np.stack([-np.cos(a) + 0 * along, -np.sin(a) + 0 * along, along], axis=1)
    ridge, right = np.stack([0 * along, 0 * along, along], axis=1), left * (-1, 1, 1)
    positions = np.concatenate([left, ridge, right]).astype(np.float32)
    triangles = []
    for i in range(4):
        for lower, upper in ((0, 5), (5, 10)):
            q = (lower + i, lower + i + 1, upper + i + 1, upper + i)
            triangles += [(q[0], q[1], q[2]), (q[0], q[2], q[3])]
    normals, index = crease_normals(positions, triangles)
    at_ridge = {tuple(np.round(n, 4) + 0.0) for n in normals[index][(np.array(triangles) // 5) == 1].tolist()}
    sides = {(-round(np.sin(a), 4), round(np.cos(a), 4), 0.0), (round(np.sin(a), 4), round(np.cos(a), 4), 0.0)}
    assert at_ridge == (sides if kept else {(0.0, 1.0, 0.0)})


def test_degenerate_triangles_count_for_nothing():
    """Slivers and repeated corners change no normal; alone, they get +z; unit everywhere, without a warning."""
    mesh = primitives.box()
    more = np.concatenate([mesh.triangles, [[0, 0, 1], [2, 2, 2]]])
    normals, index = crease_normals(mesh.positions, more)
    clean, clean_index = crease_normals(mesh.positions, mesh.triangles)
    np.testing.assert_array_equal(normals[index[:-2]], clean[clean_index])
    np.testing.assert_allclose(np.linalg.norm(normals[index], axis=-1), 1.0, atol=1e-6)
    line = np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2]], dtype=np.float32)
    normals, index = crease_normals(line, [[0, 1, 2]])
    np.testing.assert_array_equal(normals[index], [[[0, 0, 1]] * 3])
    assert (face_normals(line, [[0, 1, 2]]) == 0.0).all()


@pytest.mark.parametrize("size", [1e-8, 1e8])
def test_size_does_not_matter(size):
    """The same cube, tiny or huge, has the same normals to the bit."""
    mesh = primitives.box()
    scaled = mesh.positions * np.float32(2.0 ** np.round(np.log2(size)))
    pairs = zip(crease_normals(scaled, mesh.triangles), crease_normals(mesh.positions, mesh.triangles), strict=True)
    for ours, theirs in pairs:
        np.testing.assert_array_equal(ours, theirs)


def test_opposite_faces_of_a_sheet():
    """Two faces back to back cancel in the mean, and are told apart by the crease."""
    positions = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)
    normals, index = crease_normals(positions, [[0, 1, 2], [0, 2, 1]])
    np.testing.assert_array_equal(normals[index], [[[0, 0, 1]] * 3, [[0, 0, -1]] * 3])
    np.testing.assert_array_equal(vertex_normals(positions, [[0, 1, 2], [0, 2, 1]]), [[0, 0, 1]] * 3)


def test_a_vertex_of_a_thousand_faces():
    """A sharp fan of many faces needs no memory quadratic in their number at once, and ends."""
    angle = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    rim = np.stack([np.cos(angle), np.full_like(angle, -3.0), np.sin(angle)], axis=1)
    positions = np.concatenate([[[0, 0, 0]], rim]).astype(np.float32)
    k = np.arange(3000)
    normals, index = crease_normals(positions, np.stack([0 * k, 1 + (k + 1) % 3000, 1 + k], axis=1), 10.0)
    np.testing.assert_allclose(np.linalg.norm(normals[index], axis=-1), 1.0, atol=1e-6)
    # At the tip each face averages a symmetric share around itself: its own direction round the axis.
    middle = angle + np.pi / 3000
    tip = normals[index[:, 0]]
    assert (tip[:, 0] * np.cos(middle) + tip[:, 2] * np.sin(middle) > 0.9).all()


def test_nothing_and_nonsense():
    """No triangles: +z for each vertex. An index out of range, an angle out of range: one line."""
    normals, index = crease_normals(np.zeros((2, 3)), np.zeros((0, 3), dtype=np.int32))
    assert normals.tolist() == [[0, 0, 1]] * 2
    assert index.shape == (0, 3)
    with pytest.raises(SceneError, match="index into 2 positions"):
        crease_normals(np.zeros((2, 3)), [[0, 1, 2]])
    with pytest.raises(SceneError, match="crease_degrees"):
        crease_normals(np.zeros((3, 3)), [[0, 1, 2]], 200.0)


def test_a_scanned_bunny_stays_whole():
    """Of 69 000 triangles few vertices are split, and what they are split for is said: no corner's normal is far from its face's."""
    path = MESHES / "stanford-bunny.obj"
    if not path.exists():
        pytest.skip("needs ../shared/data/meshes/stanford-bunny.obj")
    lines = path.read_text().splitlines()
    positions = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], dtype=np.float32)
    corners = [[c.split("/")[0] for c in line.split()[1:4]] for line in lines if line.startswith("f ")]
    triangles = np.array(corners, dtype=np.int32) - 1
    normals, index = crease_normals(positions, triangles)
    assert len(normals) < 1.2 * len(positions)
    cosines = np.einsum("mkc,mc->mk", normals[index], face_normals(positions, triangles))
    assert (cosines > np.cos(np.radians(41.0))).mean() > 0.999


def test_weights_by_area_are_sums_of_cross_products():
    """Twice the area times the normal is the cross product of two sides; a quadrilateral's normal then depends on how it is cut."""
    mesh = primitives.uv_sphere(7, 5)
    rng = np.random.default_rng(4)
    positions = (mesh.positions * rng.uniform(0.6, 1.2, (len(mesh.positions), 1))).astype(np.float32)
    a, b, c = positions[mesh.triangles].astype(np.float64).transpose(1, 0, 2)
    sums = np.zeros((len(positions), 3))
    for corner in range(3):
        np.add.at(sums, mesh.triangles[:, corner], np.cross(b - a, c - a))
    expected = sums / np.linalg.norm(sums, axis=1, keepdims=True)
    np.testing.assert_allclose(vertex_normals(positions, mesh.triangles, "area"), expected, atol=1e-6)
    with pytest.raises(SceneError, match='weights must be "angle" or "area"'):
        vertex_normals(positions, mesh.triangles, "edge")
