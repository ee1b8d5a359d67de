"""Spheres, superquadrics, Platonic solids and capsules: closed, oriented, as large as the formulas say."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.special import beta

from limner.errors import SceneError
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.mesh.sizes import check_triangles


def crosses(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    return p, np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])


def volume(mesh: Mesh) -> float:
    p, cross = crosses(mesh)
    return float((p[:, 0] * cross).sum() / 6)


def area(mesh: Mesh) -> float:
    return float(np.linalg.norm(crosses(mesh)[1], axis=1).sum() / 2)


def assert_sound(mesh: Mesh, euler: int = 2) -> None:
    """Closed and oriented; V - E + F; no triangle without area; normals unit and on the side of the winding; textures unmirrored."""
    t = mesh.triangles
    sides = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]).astype(np.int64)
    n = len(mesh.positions)
    keys = sides @ np.array([n, 1])
    assert len(np.unique(keys)) == len(keys)
    np.testing.assert_array_equal(np.sort(keys), np.sort(sides @ np.array([1, n])))
    assert n - len(keys) // 2 + len(t) == euler
    _, cross = crosses(mesh)
    assert np.linalg.norm(cross, axis=1).min() > 0.0
    assert mesh.normals is not None
    normals = mesh.normals[t if mesh.normal_triangles is None else mesh.normal_triangles]
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1.0, atol=1e-6)
    assert ((normals * cross[:, None]).sum(axis=-1) > 0.0).all()
    assert mesh.uvs is not None
    uv = mesh.uvs[t if mesh.uv_triangles is None else mesh.uv_triangles].astype(np.float64)
    e, f = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    assert (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0] > 0.0).all()
    assert volume(mesh) > 0.0


GOLDEN = (1 + math.sqrt(5)) / 2
PLATONIC = {
    # name: corners, faces, sides of a face, volume and area of circumradius 1
    "tetrahedron": (4, 4, 3, 8 * math.sqrt(3) / 27, 8 / math.sqrt(3)),
    "cube": (8, 6, 4, 8 / (3 * math.sqrt(3)), 8.0),
    "octahedron": (6, 8, 3, 4 / 3, 4 * math.sqrt(3)),
    "dodecahedron": (20, 12, 5, 2 / 9 * math.sqrt(3) * (5 + math.sqrt(5)), None),
    "icosahedron": (12, 20, 3, 2 / 3 * math.sqrt(2 * (5 + math.sqrt(5))), 2 * math.sqrt(3) * (5 - math.sqrt(5))),
}


@pytest.mark.parametrize("name", PLATONIC)
def test_regular_solids(name):
    """Euclid's five: corners on the sphere, edges of one length, flat faces with one normal each, volumes and areas."""
    corners, faces, sides, expected, surface = PLATONIC[name]
    mesh = getattr(primitives, name)(2.0)
    assert_sound(mesh)
    assert (len(mesh.positions), len(mesh.normals), len(mesh.triangles)) == (corners, faces, faces * (sides - 2))
    np.testing.assert_allclose(np.linalg.norm(mesh.positions, axis=1), 2.0, rtol=1e-6)
    assert volume(mesh) == pytest.approx(8 * expected, rel=1e-6)
    if surface is not None:
        assert area(mesh) == pytest.approx(4 * surface, rel=1e-6)
    _, cross = crosses(mesh)
    unit = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    np.testing.assert_allclose(mesh.normals[mesh.normal_triangles], np.repeat(unit[:, None], 3, axis=1), atol=1e-6)
    nearest = np.sort(np.linalg.norm(mesh.positions[:, None] - mesh.positions, axis=-1), axis=1)[:, 1]
    np.testing.assert_allclose(nearest, nearest[0], rtol=1e-6)


@pytest.mark.parametrize("levels", [0, 1, 3])
def test_an_icosphere_lies_on_the_sphere_and_follows_the_globe(levels):
    """10 4^k + 2 points at the radius; areas within a factor of 2; texture coordinates of the formula, none spanning the seam."""
    mesh = primitives.icosphere(1.5, levels)
    assert_sound(mesh)
    assert (len(mesh.positions), len(mesh.triangles)) == (10 * 4**levels + 2, 20 * 4**levels)
    np.testing.assert_allclose(np.linalg.norm(mesh.positions.astype(np.float64), axis=1), 1.5, rtol=2e-7)
    sizes = np.linalg.norm(crosses(mesh)[1], axis=1)
    assert sizes.max() < 2 * sizes.min()
    uv = mesh.uvs[mesh.uv_triangles].reshape(-1, 2).astype(np.float64)
    x, y, z = mesh.positions.astype(np.float64)[mesh.triangles].reshape(-1, 3).T / 1.5
    turn = uv[:, 0] - (0.5 + np.arctan2(-z, x) / (2 * np.pi))
    np.testing.assert_allclose((turn - np.round(turn))[np.abs(y) < 0.9999], 0.0, atol=1e-6)
    np.testing.assert_allclose(uv[:, 1], 1 - np.arccos(np.clip(y, -1, 1)) / np.pi, atol=1e-3)
    assert np.ptp(uv[:, 0].reshape(-1, 3), axis=1).max() <= 0.5


@pytest.mark.parametrize(("e1", "e2"), [(1.0, 1.0), (0.3, 0.3), (0.2, 1.0), (1.0, 0.4), (2.0, 2.0), (1.5, 0.5), (2.5, 2.5)])
def test_superquadrics_have_barrs_volume_and_normals(e1, e2):
    """V = 2 a b c e1 e2 B(e1/2 + 1, e1) B(e2/2, e2/2); the implicit form is 1 at all vertices; normals at right angles to the surface."""
    mesh = primitives.superquadric((2.0, 3.0, 1.0), e1, e2, 96, 48)
    assert_sound(mesh)
    a, b, c = 1.0, 1.5, 0.5
    expected = 2 * a * b * c * e1 * e2 * beta(e1 / 2 + 1, e1) * beta(e2 / 2, e2 / 2)
    assert volume(mesh) == pytest.approx(expected, rel=2e-2)
    x, y, z = np.abs(mesh.positions.astype(np.float64) / (a, b, c)).T
    # float32 positions: values of the form, to the rounding that its exponents magnify
    form = ((x ** (2 / e2) + z ** (2 / e2)) ** (e2 / e1) + y ** (2 / e1)) ** (e1 / 2)
    np.testing.assert_allclose(form, 1.0, rtol=1e-4)
    if max(e1, e2) <= 1.0:
        _, cross = crosses(mesh)
        mean = mesh.normals[mesh.triangles].mean(axis=1)
        size = np.linalg.norm(cross, axis=1)
        aligned = (mean * cross).sum(axis=1) / np.maximum(size, 1e-30) / np.linalg.norm(mean, axis=1)
        assert np.average(aligned, weights=size) > 0.995
    if e1 == e2 == 1.0:
        scaled = primitives.uv_sphere(96, 48)
        np.testing.assert_allclose(mesh.positions, scaled.positions * np.float32([a, b, c]), atol=1e-6)
    if e1 == e2 == 2.0:
        octant = np.abs(mesh.positions).min(axis=1) > 1e-4
        flat = np.array([1 / a, 1 / b, 1 / c]) / np.linalg.norm([1 / a, 1 / b, 1 / c])
        np.testing.assert_allclose(np.abs(mesh.normals[octant]), np.broadcast_to(flat, (octant.sum(), 3)), atol=1e-4)


def test_capsule_is_a_cylinder_and_a_ball():
    """Volume and area of both, closed, its normals the direction from the nearest point of its axis."""
    mesh = primitives.capsule(0.5, 2.0, 96, 24)
    assert_sound(mesh)
    assert volume(mesh) == pytest.approx(np.pi * 0.25 * 2 + 4 / 3 * np.pi * 0.125, rel=3e-3)
    assert area(mesh) == pytest.approx(2 * np.pi * 0.5 * 2 + 4 * np.pi * 0.25, rel=3e-3)
    p = mesh.positions[mesh.triangles].reshape(-1, 3)
    axis = np.stack([np.zeros(len(p)), np.clip(p[:, 1], -1.0, 1.0), np.zeros(len(p))], axis=1)
    np.testing.assert_allclose(mesh.normals[mesh.normal_triangles].reshape(-1, 3), (p - axis) / 0.5, atol=1e-5)
    np.testing.assert_allclose(mesh.bounds, [[-0.5, -1.5, -0.5], [0.5, 1.5, 0.5]], atol=1e-6)


def test_errors_of_spheres_fall_with_the_square_of_the_edges():
    """An icosphere's volume comes four times nearer with each level."""
    missing = [4 / 3 * np.pi - volume(primitives.icosphere(1.0, levels)) for levels in (1, 2, 3)]
    for coarse, fine in pairwise(missing):
        assert 3.6 < coarse / fine < 4.2


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: primitives.icosphere(-1.0), "icosphere.radius must be positive"),
        (lambda: primitives.icosphere(1.0, -1), "icosphere.levels must be at least 0"),
        (lambda: primitives.icosphere(1.0, 20), "would make 21,990,232,555,520 triangles"),
        (lambda: primitives.icosphere(1.0, "many"), "must be a whole number"),
        (lambda: primitives.superquadric(2.0, 0.0), "superquadric.north_south"),
        (lambda: primitives.superquadric(2.0, 1.0, 9.0), "superquadric.east_west"),
        (lambda: primitives.superquadric((1.0, 0.0, 1.0)), "superquadric.size"),
        (lambda: primitives.tetrahedron(0.0), "tetrahedron.radius"),
        (lambda: primitives.cube(math.nan), "cube.radius"),
        (lambda: primitives.capsule(0.5, 0.0), "capsule.length"),
        (lambda: primitives.capsule(0.5, 1.0, 2), "capsule.n must be at least 3"),
        (lambda: primitives.cylinder(1.0, 1.0, 10**9), "would make"),
        (lambda: check_triangles(1 << 40, "something"), "something would make"),
    ],
)
def test_solids_that_are_none_are_refused(call, words):
    with pytest.raises(SceneError, match=words):
        call()
