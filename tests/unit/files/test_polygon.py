"""Cutting polygons: whatever the shape, the triangles cover it exactly once."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from limner.files.polygon import triangulate


def areas(polygon: NDArray[np.float64], triangles: NDArray[np.int64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Signed areas of the triangles, seen along the polygon's normal."""
    a, b, c = (polygon[triangles[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a) @ normal / 2.0


@given(
    radii=st.lists(st.floats(0.1, 2.0), min_size=4, max_size=24),
    tilt=st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1)),
)
def test_stars_are_covered_once(radii: list[float], tilt: tuple[float, float, float]) -> None:
    """Star-shaped polygons of any radii in any plane: all triangles turn the polygon's way, and their areas sum to its own."""
    k = len(radii)
    angles = np.arange(k) * 2.0 * math.pi / k
    flat = np.stack([np.array(radii) * np.cos(angles), np.array(radii) * np.sin(angles), np.zeros(k)], axis=1)
    q, _ = np.linalg.qr(np.eye(3) + np.cross(np.eye(3), tilt))
    q = q * np.sign(np.linalg.det(q))
    polygon = flat @ q.T
    (triangles,), n_fans = triangulate(polygon[None])
    parts = areas(polygon, triangles, q[:, 2])
    shoelace = 0.5 * np.sum(flat[:, 0] * np.roll(flat[:, 1], -1) - flat[:, 1] * np.roll(flat[:, 0], -1))
    assert n_fans == 0
    assert parts.min() > -1e-9
    assert parts.sum() == pytest.approx(shoelace)


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("mirrored", [False, True])
def test_arrow_head(turn: int, mirrored: bool) -> None:
    """A quadrilateral with a notch, begun at any corner, either way round, is cut along the right diagonal."""
    polygon = np.roll(np.array([[1, -1, 0], [0.25, 0, 0], [1, 1, 0], [-1, 0, 0]], dtype=float), turn, axis=0)
    polygon = polygon[::-1] if mirrored else polygon
    (triangles,), _ = triangulate(polygon[None])
    parts = areas(polygon, triangles, np.array([0.0, 0.0, -1.0 if mirrored else 1.0]))
    assert parts.min() > 0.0
    assert parts.sum() == pytest.approx(1.25)


def test_comb() -> None:
    """A comb of thirty teeth needs real ears: no fan covers it."""
    teeth = 30
    top = [(x + 0.25 * (x % 2), 1.0 if x % 2 else 0.2) for x in range(2 * teeth, -1, -1)]
    polygon = np.array([(0.0, 0.0, 0.0), (2.0 * teeth, 0.0, 0.0), *((x, y, 0.0) for x, y in top)])
    (triangles,), _ = triangulate(polygon[None])
    parts = areas(polygon, triangles, np.array([0.0, 0.0, 1.0]))
    x, y, _ = polygon.T
    assert parts.min() > -1e-12
    assert parts.sum() == pytest.approx(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@pytest.mark.parametrize("k", [3, 4, 5, 9])
def test_degenerate_polygons_still_give_triangles(k: int) -> None:
    """All corners in one point, or on one line: k - 2 triangles with corners of the polygon."""
    for polygon in (np.zeros((k, 3)), np.arange(3 * k, dtype=float).reshape(k, 3), np.full((k, 3), 1e300)):
        (triangles,), _ = triangulate(polygon[None])
        assert triangles.shape == (k - 2, 3)
        assert triangles.min() >= 0
        assert triangles.max() < k


def test_large_polygons_become_fans() -> None:
    """Beyond 512 corners a polygon that is not convex is cut as a fan, and counted."""
    angles = np.arange(1000) * 2.0 * math.pi / 1000
    radii = np.where(np.arange(1000) % 2, 1.0, 0.5)
    ring = np.stack([radii * np.cos(angles), radii * np.sin(angles), np.zeros(1000)], axis=1)
    assert triangulate(ring[None])[1] == 1
    assert triangulate((ring / radii[:, None])[None])[1] == 0
