"""The ray engine for trimesh, against shapes of which everything is known."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from limner import _jit
from limner.errors import SceneError
from limner.interop.trimesh import RayMeshIntersector

trimesh = pytest.importorskip("trimesh", reason="the engine is for trimesh")

MANY = 1500 if _jit.MODE == "compiled" else 60


def rays(n: int, seed: int = 0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    random = np.random.default_rng(seed)
    origins = random.normal(size=(n, 3))
    origins *= 3.0 / np.linalg.norm(origins, axis=1, keepdims=True)
    return origins, random.uniform(-0.6, 0.6, (n, 3)) - origins


def test_a_box_is_entered_and_left() -> None:
    """Two hits of every ray that meets a box, where the slabs say, in order and to the precision of doubles."""
    mesh = trimesh.creation.box((1.0, 1.2, 0.8))
    engine = RayMeshIntersector(mesh)
    origins, directions = rays(MANY)
    a, b = ((sign * mesh.extents / 2.0 - origins) / directions for sign in (-1, 1))
    enter, leave = np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)
    met = enter < leave
    locations, ray, triangle = engine.intersects_location(origins, directions)
    assert ray.tolist() == np.repeat(np.flatnonzero(met), 2).tolist()
    expected = np.stack([enter, leave], axis=1)[met].reshape(-1, 1) * directions[ray] + origins[ray]
    np.testing.assert_allclose(locations, expected, atol=1e-12)
    first, which = engine.intersects_id(origins, directions, multiple_hits=False)
    np.testing.assert_array_equal(which, np.flatnonzero(met))
    np.testing.assert_array_equal(first, triangle[::2])
    np.testing.assert_array_equal(engine.intersects_first(origins, directions)[met], first)
    np.testing.assert_array_equal(engine.intersects_any(origins, directions), met)
    assert (engine.intersects_first(origins, directions)[~met] == -1).all()
    one, of = engine.intersects_id(origins, directions, max_hits=1)
    np.testing.assert_array_equal((one, of), (first, which))


def test_edges_and_vertices_are_one_crossing() -> None:
    """Rays through the corners, edges and diagonals of a box's faces cross it twice; past an edge, as often in as out."""
    engine = RayMeshIntersector(trimesh.creation.box((2.0, 2.0, 2.0)))
    inside = [(0, 0), (0.5, 0.5), (-0.5, 0.5), (0.25, -0.25), (0.9, 0.9)]
    straight = np.array([(x, y, 5.0) for x, y in inside])
    _, ray, _ = engine.intersects_location(straight, (0, 0, -1))
    assert ray.tolist() == np.repeat(np.arange(len(inside)), 2).tolist()
    skew = np.array([(1, 1, 1), (1, 0, 1), (1, 1, 0), (-1, 1, 0.5), (0.3, 1, -1)]) - (0.1, 0.2, -0.3)
    _, ray, _ = engine.intersects_location((0.1, 0.2, -0.3), skew)
    assert ray.tolist() == [0, 1, 2, 3, 4]
    triangle, ray, locations = engine.intersects_id((1, 3, 1), (0, -1, 0), return_locations=True)
    assert len(triangle) == len(ray) == len(locations)


def test_points_inside() -> None:
    """Of a ball, a shell with a hollow, and a ring; asked through the mesh itself, which asks its engine."""
    random = np.random.default_rng(2)
    points = random.uniform(-1.3, 1.3, (MANY, 3))
    ball = trimesh.creation.icosphere(2 if _jit.MODE == "compiled" else 1)
    ball.ray = RayMeshIntersector(ball)
    away = np.linalg.norm(points, axis=1)
    surface = np.linalg.norm(ball.triangles_center, axis=1).min()
    sure = (away < surface) | (away > 1.0)
    np.testing.assert_array_equal(ball.contains(points)[sure], (away < surface)[sure])
    hollow = ball.copy()
    hollow.apply_scale(0.5)
    hollow.invert()
    shell = trimesh.util.concatenate([ball, hollow])
    sure &= (away < 0.5 * surface) | (away > 0.5)
    np.testing.assert_array_equal(RayMeshIntersector(shell).contains_points(points)[sure], ((away > 0.5) & (away < surface))[sure])
    assert RayMeshIntersector(ball).contains_points(ball.vertices * 0.5).all(), "rays from inside through vertices"
    assert RayMeshIntersector(ball).contains_points([]).shape == (0,)


def test_a_mesh_that_changes_is_looked_at_again() -> None:
    """After it was moved, hits move; a copy and a travelled engine answer the same."""
    mesh = trimesh.creation.box()
    engine = RayMeshIntersector(mesh)
    assert engine.intersects_any((0.1, 0.2, 5), (0, 0, -1)).all()
    mesh.apply_translation((3, 0, 0))
    assert not engine.intersects_any((0.1, 0.2, 5), (0, 0, -1)).any()
    for other in (copy.copy(engine), copy.deepcopy(engine), pickle.loads(pickle.dumps(engine)), RayMeshIntersector(mesh, True)):
        assert other.intersects_first((3.1, 0.2, 5), (0, 0, -1)) == engine.intersects_first((3.1, 0.2, 5), (0, 0, -1))
    assert repr(engine) == "RayMeshIntersector(12 triangles)"


class _Bare:
    vertices = ((0, 0, 0), (1, 0, 0), (0, 1, 0))
    faces = ((0, 1, 2),)


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, np.int8])
def test_bare_meshes_and_arrays_of_all_kinds(kind: Any) -> None:
    """Anything with vertices and faces; Fortran order, strided and reversed views; no rays, bad rays, rays that do not fit."""
    engine = RayMeshIntersector(_Bare(), threads=1)
    origins = np.asfortranarray(np.array([[0, 0, 3], [5, 5, 3], [0, 0, -3]], dtype=kind))
    directions = np.array([[0, 0, 1], [9, 9, 9], [0, 0, -1], [9, 9, 9], [0, 0, -2]], dtype=kind)[::-2]
    assert engine.intersects_first(origins, directions).tolist() == [0, -1, 0]
    locations, ray, triangle = engine.intersects_location(origins, directions, multiple_hits=False)
    assert (locations.tolist(), ray.tolist(), triangle.tolist()) == ([[0.0, 0.0, 0.0]] * 2, [0, 2], [0, 0])
    assert [part.shape for part in engine.intersects_id([], [], return_locations=True)] == [(0,), (0,), (0, 3)]
    assert engine.intersects_any([[np.nan, 0, 1], [0.2, 0.2, 1], [0.2, 0.2, 1]], [[0, 0, -1], [0, 0, 0], [0, 0, -1]]).tolist() == [0, 0, 1]
    with pytest.raises(SceneError, match=r"ray_origins must have shape \(n, 3\), got \(2, 2\)"):
        engine.intersects_any(np.zeros((2, 2)), (0, 0, 1))
    with pytest.raises(SceneError, match="of the same number, or one; got 2 and 3"):
        engine.intersects_id(np.zeros((2, 3)), np.ones((3, 3)))
