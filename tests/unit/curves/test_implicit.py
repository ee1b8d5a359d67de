"""Implicit curves: the right number of lines, closed where they should be, on the curve, the inside on the left."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.curves.implicit import traced
from limner.errors import SceneError

Floats = NDArray[np.float64]


def cassini(x: Floats, y: Floats, b: float) -> Floats:
    """Cassini's ovals about (-1, 0) and (1, 0): one line for b > 1, two for b < 1."""
    return b**4 - ((x - 1) ** 2 + y**2) * ((x + 1) ** 2 + y**2)


def signed_area(points: Floats) -> float:
    x, y = points.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


@pytest.mark.parametrize(("b", "count"), [(0.97, 2), (1.03, 1), (0.7, 2), (1.5, 1)])
@pytest.mark.parametrize("resolution", [12, 13, 40])
def test_ovals_have_the_right_topology(b: float, count: int, resolution: int) -> None:
    """Near the value at which they join too, where cells are doubtful; every line closes, the inside on its left."""
    lines = traced(lambda x, y: cassini(x, y, b), (-2.0, -1.5, 2.0, 1.5), resolution)
    if resolution > 20 or not 0.9 < b < 1.1:
        assert len(lines) == count
    for line in lines:
        assert line.closed
        assert signed_area(line.points) > 0.0
        distances = np.linalg.norm(line.points - (1, 0), axis=1) * np.linalg.norm(line.points - (-1, 0), axis=1)
        np.testing.assert_allclose(distances, b * b, rtol=1e-9)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_lines_are_as_near_as_asked(tolerance: float) -> None:
    """Middles of the lines round a circle, and its area from the polygon."""
    (circle,) = traced(lambda x, y: 1.0 - x * x - y * y, (-1.5, -1.5, 1.5, 1.5), 6, tolerance)
    middles = 0.5 * (circle.points + np.roll(circle.points, -1, axis=0))
    assert 1.0 - np.linalg.norm(middles, axis=1).min() <= tolerance
    assert signed_area(circle.points) == pytest.approx(math.pi, abs=8 * tolerance)
    assert len(circle.points) < 60 / math.sqrt(tolerance)


def test_doubtful_cells_never_branch() -> None:
    """Any signs at the corners of a grid: each point is on one line, lines end only at the border, and zeros in corners do no harm."""
    rng = np.random.default_rng(5)
    heights = rng.integers(-1, 2, (9, 9)).astype(float)

    def bilinear(x: Floats, y: Floats) -> Floats:
        i, j = np.clip(x.astype(int), 0, 7), np.clip(y.astype(int), 0, 7)
        s, t = x - i, y - j
        low = (1 - s) * heights[j, i] + s * heights[j, i + 1]
        return (1 - t) * low + t * ((1 - s) * heights[j + 1, i] + s * heights[j + 1, i + 1])

    lines = traced(bilinear, (0.0, 0.0, 8.0, 8.0), 8)
    assert lines
    for line in lines:
        if not line.closed:
            ends = line.points[[0, -1]]
            assert (((ends < 1e-9) | (ends > 8 - 1e-9)).any(axis=1)).all()


def test_lines_end_at_the_border_and_where_the_function_does() -> None:
    """A straight line through the picture; the same where the function is only defined on the right."""
    (line,) = traced(lambda x, y: y - 0.3 * x, (-1.0, -1.0, 1.0, 1.0), 10)
    assert not line.closed
    np.testing.assert_allclose(line.points[:, 1], 0.3 * line.points[:, 0], atol=1e-12)
    np.testing.assert_allclose(line.points[[0, -1], 0], [-1.0, 1.0])  # what is above is on the left
    (half,) = traced(lambda x, y: np.sqrt(x) * 0.0 + y - 0.05, (-1.0, -1.0, 1.0, 1.0), 16)
    assert half.points[:, 0].min() >= -1e-12
    assert traced(lambda x, y: 1.0, (0.0, 0.0, 1.0, 1.0), 4) == []


@pytest.mark.parametrize(
    ("bounds", "resolution", "tolerance", "words"),
    [((1, 0, 0, 1), 8, None, "left < right"), ((0, 0, 1, math.nan), 8, None, "left < right"), ((0, 0, 1, 1), 0, None, "at least 1"),
     ((0, 0, 1, 1), 100_000, None, "cells"), ((0, 0, 1, 1), 8, -1.0, "tolerance")],
)  # fmt: skip
def test_bad_input_is_refused(bounds: tuple[float, ...], resolution: int, tolerance: float | None, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        traced(lambda x, y: x, bounds, resolution, tolerance)  # type: ignore[arg-type]


def test_a_function_of_the_wrong_shape_is_refused() -> None:
    with pytest.raises(SceneError, match="one number for each point"):
        traced(lambda x, y: np.zeros(3), (0.0, 0.0, 1.0, 1.0), 8)
