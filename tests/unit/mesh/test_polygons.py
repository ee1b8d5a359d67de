"""Meshes of polygons: each polygon is covered once, whatever its shape; what cannot be one is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surfaces import platonic_solids

from limner.errors import SceneError
from limner.mesh.examine.measure import area, triangle_areas
from limner.mesh.mesh import Mesh
from limner.mesh.polygons import mesh_from_polygons, triangulate
from limner.mesh.repair.holes import triangulate_loop


def star(radii):
    """A polygon around the origin, in the plane z = 0."""
    turn = 2 * np.pi * np.arange(len(radii)) / len(radii)
    return np.stack([radii * np.cos(turn), radii * np.sin(turn), 0 * turn], axis=1)


def enclosed(points):
    """The area of a flat polygon, by Gauss's formula."""
    x, y, _ = points.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def test_polygons_of_all_sizes_in_their_order():
    """Triangles stand where their polygon stood, and say which it was; a dodecahedron's pentagons make three each."""
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [3, 1, 0], [2, 2, 0]]
    mesh = mesh_from_polygons(points, [(0, 1, 2, 3), (1, 4, 2), (2, 4, 5, 6)])
    assert mesh.face_attributes["polygon"].tolist() == [0, 0, 1, 2, 2]
    assert mesh.triangles[2].tolist() == [1, 4, 2]
    assert area(mesh) == pytest.approx(1.0 + 0.5 + 2.0)
    assert np.bincount(platonic_solids()["dodecahedron"].face_attributes["polygon"]).tolist() == [3] * 12
    assert len(mesh_from_polygons(points, np.zeros((0, 4), int)).triangles) == 0


@settings(max_examples=30)
@given(st.lists(st.floats(0.1, 2.0), min_size=5, max_size=60), st.integers(0, 1000))
def test_stars_and_loops_are_covered_once(radii, seed):
    """Clipped ears and the loop of least area: as many triangles as it takes, none turned over, and their areas sum to what the polygon
    encloses; also when it is not quite flat."""
    flat = star(np.array(radii))
    bumpy = flat + np.random.default_rng(seed).uniform(-1e-3, 1e-3, flat.shape) * (0, 0, 1)
    for cut in (triangulate_loop(flat), triangulate(bumpy[None])[0][0]):
        parts = np.cross(flat[cut[:, 1]] - flat[cut[:, 0]], flat[cut[:, 2]] - flat[cut[:, 0]])[:, 2] / 2
        assert cut.shape == (len(flat) - 2, 3)
        assert parts.min() > -1e-9
        assert parts.sum() == pytest.approx(enclosed(flat))


def test_corners_on_a_line():
    """A square with corners along its sides gets no triangle without area."""
    side = np.array([[t, 0, 0] for t in (0.0, 0.25, 0.5, 0.75)])
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    points, place = [], np.zeros(3)
    for k in range(4):
        points += [place + p @ np.linalg.matrix_power(turn.T, k) for p in side]
        place = place + np.array([1, 0, 0]) @ np.linalg.matrix_power(turn.T, k)
    ring = np.arange(16)
    for cut in (triangulate_loop(np.array(points)), mesh_from_polygons(points, [ring]).triangles):
        assert triangle_areas(Mesh(points, cut)).min() > 0.01
        assert area(Mesh(points, cut)) == pytest.approx(1.0)


def test_a_thousand_corners():
    """Beyond what a file may ask for, a polygon is still cut right where it is asked for."""
    points = star(np.where(np.arange(1000) % 2, 1.0, 0.5))
    mesh = mesh_from_polygons(points, [np.arange(1000)])
    assert area(mesh) == pytest.approx(enclosed(points), rel=1e-5)
    normals = np.cross(*(mesh.positions[mesh.triangles[:, k]] - mesh.positions[mesh.triangles[:, 0]] for k in (1, 2)))
    assert normals[:, 2].min() > -1e-6
    assert len(triangulate_loop(points)) == 998


def test_diagonals_that_are_taken_are_avoided():
    """Of a square's two diagonals the one that is left; a saddle takes the cut of least area."""
    square = star(np.ones(4))
    for taken in ((0, 2), (1, 3)):
        forbidden = np.zeros((4, 4), dtype=bool)
        forbidden[taken] = forbidden[taken[::-1]] = True
        cut = triangulate_loop(square, forbidden)
        assert not any(set(taken) <= set(row) for row in cut.tolist())
    assert triangulate_loop(square[:3]).tolist() == [[0, 1, 2]]
    assert math.isclose(area(Mesh(square, triangulate_loop(square))), 2.0, rel_tol=1e-6)


@pytest.mark.parametrize(
    ("polygons", "complaint"),
    [
        ([(0, 1)], r"at least 3 indices each, got \[0, 1\] at polygon 0"),
        ([(0, 1, 2), (0.5, 1, 2)], "at polygon 1"),
        ([(0, 1, 7)], r"index into 3 positions, got \[0, 1, 7\] at polygon 0"),
        ([(0, 1, -1)], r"index into 3 positions"),
    ],
)
def test_no_polygons(polygons, complaint):
    """One line that names the polygon."""
    with pytest.raises(SceneError, match=complaint):
        mesh_from_polygons(np.eye(3), polygons)
