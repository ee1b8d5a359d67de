"""Triangles in parts: their boxes hold them, and rays find what they find without."""

from __future__ import annotations

import numpy as np

from limner import _jit
from limner.accel.presplit import split_boxes
from limner.raycaster import RayCaster


def _needles(n: int, n_long: int) -> np.ndarray:
    """(n, 3, 3): small triangles, and among them long ones across the axes."""
    random = np.random.default_rng(3)
    centre, along = random.uniform(-1, 1, (n, 3)), random.normal(size=(n, 3))
    along *= np.where(np.arange(n) < n_long, 1.0, 0.02)[:, None] / np.linalg.norm(along, axis=1, keepdims=True)
    return np.stack([centre - along, centre + along, centre + 0.02 * random.normal(size=(n, 3))], axis=1)


def test_parts_hold_the_whole():
    """Any point of a triangle lies in one of its boxes; these waste less than the one box did, and there are as many as there may be."""
    triangles = _needles(300, 60).astype(np.float32)
    whole = np.concatenate([triangles.min(axis=1), triangles.max(axis=1)], axis=1)
    rows, boxes = split_boxes(triangles.reshape(-1, 9), whole)
    assert 330 < len(rows) <= 450
    np.testing.assert_array_equal(rows[:300], np.arange(300))
    weights = np.random.default_rng(4).dirichlet((0.6, 0.6, 0.6), size=200)
    for k in range(80):
        points = weights @ triangles[k].astype(np.float64)
        mine = boxes[rows == k].astype(np.float64)
        slack = 1e-6
        inside = ((points[:, None] >= mine[:, :3] - slack) & (points[:, None] <= mine[:, 3:] + slack)).all(axis=2)
        assert inside.any(axis=1).all()
        assert (mine[:, :3] >= whole[k, :3]).all()
        assert (mine[:, 3:] <= whole[k, 3:]).all()
    sizes = np.prod(boxes[:, 3:] - boxes[:, :3], axis=1)
    assert sizes.sum() < 0.5 * np.prod(whole[:, 3:] - whole[:, :3], axis=1).sum()


def test_hits_are_the_same():
    """Closest and any hit, and all hits once each, with triangles in parts and without; degenerate ones among them."""
    triangles = _needles(3000, 200)
    triangles[5], triangles[6, 1] = triangles[5, 0], triangles[6, 0]
    vertices, indices = triangles.reshape(-1, 3), np.arange(9000).reshape(-1, 3)
    random = np.random.default_rng(5)
    n = 500 if _jit.MODE == "compiled" else 40
    origins = 2.0 * random.normal(size=(n, 3))
    directions = random.uniform(-1, 1, (n, 3)) - origins
    whole, parts = (RayCaster(vertices, indices, spatial_splits=split) for split in (False, True))
    one, other = whole.intersect(origins, directions), parts.intersect(origins, directions)
    for field in ("t", "triangle", "u", "v"):
        np.testing.assert_array_equal(getattr(one, field), getattr(other, field))
    np.testing.assert_array_equal(whole.occluded(origins, directions), parts.occluded(origins, directions))
    assert 0.2 < one.hit.mean() < 0.99
    every, each = whole.all_hits(origins, directions), parts.all_hits(origins, directions)
    np.testing.assert_array_equal(every.ray, each.ray)
    np.testing.assert_array_equal(every.triangle, each.triangle)
