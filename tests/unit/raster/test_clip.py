"""Clipping in homogeneous coordinates (FoCG 8.1.5, 8.1.6): what is kept lies inside and on the triangle, and nothing inside is lost."""

from __future__ import annotations

import numpy as np
from compiled import door_of
from numpy.typing import NDArray

from limner._door import Array
from limner._jit import kernel
from limner.raster.clip import clip_polygon, inside_all
from limner.raster.layouts import GUARD_BAND, MAX_CLIPPED

NEAR = 0.5


@kernel
def _clip_each(triangles, near, polygons, scratch, counts):
    for k in range(triangles.shape[0]):
        for i in range(3):
            for c in range(4):
                polygons[k, i, c] = triangles[k, i, c]
        counts[k, 0] = clip_polygon(polygons[k], scratch, near[0])
        inside = True
        for i in range(3):
            inside = inside and inside_all(triangles[k, i], near[0])
        counts[k, 1] = 1 if inside else 0


def _clipped(triangles: NDArray[np.float64], near: float = NEAR) -> tuple[list[NDArray[np.float64]], NDArray[np.bool_]]:
    n = len(triangles)
    polygons, counts = np.zeros((n, MAX_CLIPPED, 4), np.float32), np.zeros((n, 2), np.int64)
    door = door_of(_clip_each, Array(np.float32, 3), Array(np.float32, 1), Array(np.float32, 3), Array(np.float32, 2), Array(np.int64, 2))
    scratch = np.zeros((MAX_CLIPPED, 4), np.float32)
    door(np.ascontiguousarray(triangles, np.float32), np.full(1, near, np.float32), polygons, scratch, counts)
    return [polygon[:count].astype(np.float64) for polygon, count in zip(polygons, counts[:, 0], strict=True)], counts[:, 1] == 1


def _random(n: int = 500) -> NDArray[np.float64]:
    """(x w, y w, depth, w) of perspective views: w is the depth; some vertices behind the eye, some far beyond the guard band."""
    random = np.random.default_rng(6)
    triangles = random.normal(size=(n, 3, 4)) * 3
    triangles[..., :2] *= 10.0 ** random.uniform(-2, 7, size=(n, 1, 1))
    triangles[..., 3] = triangles[..., 2]
    return triangles.astype(np.float32).astype(np.float64)


def _distances(v: NDArray[np.float64]) -> NDArray[np.float64]:
    """Signed distances to the five planes, relative to the size of the numbers."""
    x, y, depth, w = v.T
    limit = float(GUARD_BAND) * w
    scale = np.maximum(np.abs(limit), 1.0)
    return np.stack([depth - NEAR, (x + limit) / scale, (limit - x) / scale, (y + limit) / scale, (limit - y) / scale])


def _area(polygon: NDArray[np.float64]) -> float:
    x, y = polygon[:, 0], polygon[:, 1]
    return float(abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2)


def test_what_is_kept_lies_inside_and_on_the_triangle():
    """Each vertex is a combination of the triangle's three with weights in [0, 1] that sum to 1, so that attributes survive."""
    triangles = _random()
    polygons, _ = _clipped(triangles)
    assert sum(len(p) > 3 for p in polygons) > 100
    for triangle, polygon in zip(triangles, polygons, strict=True):
        if len(polygon) == 0:
            continue
        assert _distances(polygon).min() > -2e-6
        size = np.abs(triangle).max(axis=0)
        system = np.concatenate([(triangle / size).T, np.ones((1, 3))])
        target = np.concatenate([(polygon / size).T, np.ones((1, len(polygon)))])
        weights, *_ = np.linalg.lstsq(system, target, rcond=None)
        np.testing.assert_allclose(system @ weights, target, atol=3e-6)
        if np.linalg.cond(system) < 100:
            assert weights.min() > -1e-4


def test_what_is_inside_is_left_alone_and_what_is_outside_vanishes():
    triangles = _random()
    polygons, inside = _clipped(triangles)
    distances = np.array([_distances(t) for t in triangles])
    np.testing.assert_array_equal(inside, (distances >= 0).all(axis=(1, 2)))
    for triangle, polygon, kept, d in zip(triangles, polygons, inside, distances, strict=True):
        if kept:
            np.testing.assert_array_equal(polygon, triangle)
        if (d.max(axis=1) < 0).any():
            assert len(polygon) == 0


def test_clipping_preserves_area():
    """The part before the near plane and the part behind it make up the triangle."""
    random = np.random.default_rng(9)
    triangles = random.normal(size=(300, 3, 4))
    triangles[..., 3] = 1.0  # parallel projection: areas can be added
    before, _ = _clipped(triangles, 0.2)
    mirrored = triangles * (1, 1, -1, 1)
    behind, _ = _clipped(mirrored, -0.2)
    for triangle, a, b in zip(triangles, before, behind, strict=True):
        parts = sum(_area(p) for p in (a, b) if len(p))
        np.testing.assert_allclose(parts, _area(triangle), rtol=1e-4, atol=1e-6)


def test_an_edge_is_cut_at_one_point_from_both_sides():
    """The same edge run along in both ways gives the very same vertex."""
    triangles = _random()
    there, _ = _clipped(triangles)
    back, _ = _clipped(triangles[:, ::-1])
    for a, b in zip(there, back, strict=True):
        assert {tuple(v) for v in a} == {tuple(v) for v in b}
