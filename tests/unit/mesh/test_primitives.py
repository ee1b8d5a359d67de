"""Meshes of simple solids: closed, oriented, exact where they claim to be, and converging to the solid."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives


def edges_of(mesh: Mesh) -> np.ndarray:
    """Directed edges (3 m, 2)."""
    return np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]])


def crosses(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    return p, np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])


def signed_volume(mesh: Mesh) -> float:
    p, cross = crosses(mesh)
    return float((p[:, 0] * cross).sum() / 6)


def area(mesh: Mesh) -> float:
    return float(np.linalg.norm(crosses(mesh)[1], axis=1).sum() / 2)


def corner_values(mesh: Mesh, field: str) -> np.ndarray:
    values, index = {"normals": (mesh.normals, mesh.normal_triangles), "uvs": (mesh.uvs, mesh.uv_triangles)}[field]
    return values[mesh.triangles if index is None else index]


@pytest.mark.parametrize("mesh", [primitives.uv_sphere(3, 2), primitives.uv_sphere(16, 7), primitives.box((1, 2, 3))], ids=repr)
def test_solids_are_closed_and_consistently_oriented(mesh):
    """Each directed edge once and its opposite once, V - E + F = 2, and the inside is where the volume is positive."""
    edges = edges_of(mesh)
    assert len({tuple(e) for e in edges.tolist()}) == len(edges)
    assert {tuple(e) for e in edges.tolist()} == {tuple(e[::-1]) for e in edges.tolist()}
    assert len(mesh.positions) - len(edges) // 2 + len(mesh.triangles) == 2
    assert signed_volume(mesh) > 0.0


@pytest.mark.parametrize(
    "mesh",
    [primitives.uv_sphere(12, 6), primitives.box((1, 2, 3)), primitives.plane_disk((1, 2), 1, 50, 7)],
    ids=repr,
)
def test_normals_and_textures_face_outwards(mesh):
    """Corner normals are unit and on the side of the winding; no texture is mirrored seen from outside."""
    _, cross = crosses(mesh)
    normals = corner_values(mesh, "normals").astype(np.float64)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1.0, atol=1e-6)
    assert (np.einsum("mkc,mc->mk", normals, cross) > 0.0).all()
    uv = corner_values(mesh, "uvs").astype(np.float64)
    e, f = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    assert (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0] > 0.0).all()


@given(st.integers(3, 40), st.integers(2, 40), st.floats(1e-3, 1e3))
def test_sphere_lies_on_the_sphere(n_u, n_v, radius):
    """Every vertex at the radius to a float32's rounding, its normal radial."""
    mesh = primitives.uv_sphere(n_u, n_v, radius)
    distance = np.linalg.norm(mesh.positions.astype(np.float64), axis=1)
    np.testing.assert_allclose(distance, radius, rtol=2e-7)
    np.testing.assert_allclose(mesh.normals, mesh.positions / np.float32(radius), atol=1e-6)


def test_sphere_converges_to_area_and_volume():
    """4 pi r^2 and 4/3 pi r^3 from below, the error falling with the square of the resolution."""
    errors = []
    for n in (16, 32, 64):
        mesh = primitives.sphere(2.0, n)
        errors.append((16 * math.pi - area(mesh), 32 / 3 * math.pi - signed_volume(mesh)))
    errors = np.array(errors)
    assert (errors > 0.0).all()
    np.testing.assert_allclose(errors[:-1] / errors[1:], 4.0, rtol=0.05)
    assert errors[-1, 1] < 1e-2 * 32 / 3 * math.pi


def test_sphere_texture_coordinates_follow_the_formula():
    """FoCG 11.1 turned to y up: u = 1/2 + atan2(-z, x)/(2 pi), v = 1 - acos(y/r)/pi; no triangle spans the seam backwards."""
    mesh = primitives.uv_sphere(24, 12)
    uv = corner_values(mesh, "uvs").astype(np.float64)
    x, y, z = np.moveaxis(mesh.positions.astype(np.float64)[mesh.triangles], -1, 0)
    pole = np.abs(y) > 0.9999
    turn = uv[..., 0] - (0.5 + np.arctan2(-z, x) / (2 * math.pi))
    np.testing.assert_allclose((turn - np.round(turn))[~pole], 0.0, atol=1e-6)
    np.testing.assert_allclose(uv[..., 1], 1 - np.arccos(np.clip(y, -1, 1)) / math.pi, atol=1e-6)
    assert np.ptp(uv[..., 0], axis=1).max() < 1.5 / 24
    # +x is the middle of the picture, +z a quarter to its left, seen from outside with v up.
    np.testing.assert_allclose(uv[(x > 0.999) & (np.abs(y) < 1e-6)], [[0.5, 0.5]] * 6, atol=1e-6)
    np.testing.assert_allclose(uv[(z > 0.999) & (np.abs(y) < 1e-6)], [[0.25, 0.5]] * 6, atol=1e-6)


def test_box_has_the_volume_area_and_bounds_of_a_box():
    mesh = primitives.box((1, 2, 3))
    assert signed_volume(mesh) == pytest.approx(6.0)
    assert area(mesh) == pytest.approx(22.0)
    np.testing.assert_array_equal(mesh.bounds, [[-0.5, -1, -1.5], [0.5, 1, 1.5]])
    # Flat: each triangle's three normals are its own.
    _, cross = crosses(mesh)
    unit = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    np.testing.assert_allclose(corner_values(mesh, "normals"), np.repeat(unit[:, None], 3, axis=1), atol=1e-7)


def test_quad_shows_the_whole_texture():
    mesh = primitives.quad([(0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 0)])
    assert area(mesh) == pytest.approx(6.0)
    np.testing.assert_array_equal(mesh.normals, [[0, 0, 1]])
    np.testing.assert_array_equal(mesh.positions[:, :2] / (2, 3), mesh.uvs)


@given(st.floats(-50, 50), st.floats(0.1, 10), st.floats(1.0, 1e5), st.integers(3, 48))
def test_plane_disk_covers_its_disk_without_gaps(x, inner, ratio, n_segments):
    """Its area is the polygon's, its border encloses the disk, and its triangles share all inner edges."""
    outer = inner * ratio
    mesh = primitives.plane_disk((x, 2.0), inner, outer, n_segments)
    assert (mesh.positions[:, 1] == 0.0).all()
    _, cross = crosses(mesh)
    assert (cross[:, 1] > 0.0).all()
    reach = outer / math.cos(math.pi / n_segments)
    polygon = n_segments / 2 * reach**2 * math.sin(2 * math.pi / n_segments)
    assert area(mesh) == pytest.approx(polygon, rel=1e-3)
    edges = {tuple(e) for e in edges_of(mesh).tolist()}
    border = [e for e in edges if e[::-1] not in edges]
    assert len(border) == n_segments
    middle = mesh.positions.astype(np.float64)[np.array(border)].mean(axis=1) - (x, 0.0, 2.0)
    assert np.linalg.norm(middle, axis=1).min() >= outer * (1 - 1e-5) - 1e-5
    np.testing.assert_array_equal(mesh.uvs, mesh.positions[:, [0, 2]] * np.float32([1, -1]))


def test_plane_disk_rings_double():
    """Near the eye the triangles are small: each ring is at most twice as far as the one before."""
    mesh = primitives.plane_disk((0, 0), 1.0, 1e4, 8)
    radii = np.unique(np.round(np.linalg.norm(mesh.positions, axis=1), 2))[1:]
    assert radii[0] == 1.0
    assert (radii[1:] / radii[:-1]).max() < 2.01


@pytest.mark.parametrize(
    "call",
    [
        lambda: primitives.uv_sphere(2, 2),
        lambda: primitives.sphere(-1.0),
        lambda: primitives.box((1, 0, 1)),
        lambda: primitives.box(math.nan),
        lambda: primitives.quad([(0, 0, 0)] * 4),
        lambda: primitives.quad([(0, 0, 0)] * 3),
        lambda: primitives.plane_disk((0, 0), 2.0, 1.0),
        lambda: primitives.plane_disk((0, 0), 0.0, 1.0),
    ],
)
def test_impossible_solids_are_refused(call):
    with pytest.raises(SceneError):
        call()


REVOLVED = {
    "disk": (primitives.disk(1.5, 96), 1, np.pi * 2.25, 0.0),
    "cylinder": (primitives.cylinder(0.7, 2.0, 96), 2, 2 * np.pi * 0.7 * 2.7, np.pi * 0.49 * 2),
    "tube": (primitives.cylinder(0.7, 2.0, 96, False), 0, 2 * np.pi * 0.7 * 2.0, None),
    "cone": (primitives.cone(1.0, 2.0, 0.0, 96), 2, np.pi * (1 + np.sqrt(5)), np.pi * 2 / 3),
    "upside down": (primitives.cone(0.0, 2.0, 1.0, 96), 2, np.pi * (1 + np.sqrt(5)), np.pi * 2 / 3),
    "frustum": (primitives.cone(1.0, 1.0, 0.5, 96), 2, np.pi * (1.5 * np.sqrt(1.25) + 1.25), np.pi / 3 * 1.75),
    "torus": (primitives.torus(1.0, 0.4, 96, 64), 0, 4 * np.pi**2 * 0.4, 2 * np.pi**2 * 0.16),
}


@pytest.mark.parametrize("name", REVOLVED)
def test_what_is_round_about_an_axis(name):
    """Areas, volumes and V - E + F of the formulas; triangles wind as their normals point, which stand at right angles to the surface."""
    mesh, euler, area, volume = REVOLVED[name]
    pairs = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]])
    assert len(mesh.positions) - len(np.unique(np.sort(pairs, axis=1), axis=0)) + len(mesh.triangles) == euler
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    np.testing.assert_allclose(np.linalg.norm(n, axis=1).sum() / 2, area, rtol=3e-3)
    if volume is not None:
        np.testing.assert_allclose(np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6, volume, rtol=4e-3, atol=1e-12)
    normals = mesh.normals[mesh.normal_triangles]
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1.0, rtol=1e-6)
    assert ((n[:, None] * normals).sum(axis=-1) > 0.99 * np.linalg.norm(n, axis=1)[:, None]).all()
    u = mesh.uvs[mesh.uv_triangles][..., 0]
    assert u.min() >= 0
    assert u.max() <= 1
    assert np.ptp(u, axis=1).max() < 0.6  # no triangle runs back over the seam


def test_texture_coordinates_of_round_shapes_follow_their_formulas():
    """u = 1/2 + atan2(-z, x) / 2 pi around all of them; v up a cylinder and around a torus' tube; a cap is cut out of the texture."""
    for mesh, v_of in (
        (primitives.cylinder(0.7, 2.0, 32, False), lambda p: 0.5 + p[:, 1] / 2),
        (primitives.torus(1.0, 0.4, 32, 16), lambda p: 0.5 + np.arctan2(p[:, 1], np.hypot(p[:, 0], p[:, 2]) - 1) / (2 * np.pi)),
    ):
        p = mesh.positions.astype(np.float64)[mesh.triangles].reshape(-1, 3)
        u, v = mesh.uvs[mesh.uv_triangles].reshape(-1, 2).T
        np.testing.assert_allclose(np.mod(u - (0.5 + np.arctan2(-p[:, 2], p[:, 0]) / (2 * np.pi)) + 0.5, 1.0), 0.5, atol=1e-6)
        np.testing.assert_allclose(np.mod(v - v_of(p) + 0.5, 1.0), 0.5, atol=1e-6)
    disk = primitives.disk(2.0, 12)
    p, uv = disk.positions[disk.triangles].reshape(-1, 3), disk.uvs[disk.uv_triangles].reshape(-1, 2)
    np.testing.assert_allclose(uv, np.stack([0.5 + p[:, 0] / 4, 0.5 - p[:, 2] / 4], axis=1), atol=1e-6)


def test_a_bilinear_patch_lies_on_its_formula():
    """z = x y over the unit square; where two corners meet the normal is that of the diagonals."""
    mesh = primitives.bilinear_patch([[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0]], 8)
    x, y, z = mesh.positions.T
    np.testing.assert_allclose(z, x * y, atol=1e-7)
    np.testing.assert_allclose(mesh.uvs, np.stack([x, y], axis=1), atol=1e-7)
    expected = np.stack([-y, -x, np.ones_like(x)], axis=1)
    np.testing.assert_allclose(mesh.normals, expected / np.linalg.norm(expected, axis=1, keepdims=True), atol=1e-6)
    pinched = primitives.bilinear_patch([[0, 0, 0], [1, 0, 0], [0.5, 1, 0], [0.5, 1, 0]], 4)
    np.testing.assert_allclose(pinched.normals, [[0, 0, 1]] * 25, atol=1e-7)


@pytest.mark.parametrize(
    "make",
    [
        lambda: primitives.disk(0.0), lambda: primitives.cylinder(1.0, np.nan), lambda: primitives.cone(0.0, 1.0, 0.0),
        lambda: primitives.cone(-1.0, 1.0), lambda: primitives.torus(1.0, -1.0), lambda: primitives.disk(1.0, 2),
        lambda: primitives.bilinear_patch([[0, 0, 0]]), lambda: primitives.bilinear_patch(np.zeros((4, 3)), 0),
    ],
)  # fmt: skip
def test_round_shapes_that_are_none_are_refused(make):
    with pytest.raises(SceneError):
        make()
