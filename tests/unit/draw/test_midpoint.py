"""Lines of whole pixels (FoCG 8.1.1)."""

from __future__ import annotations

import numpy as np
import pytest

from limner.draw.canvas import Canvas
from limner.draw.midpoint import line_pixels
from limner.errors import SceneError


def test_the_book_s_line() -> None:
    """Slope 3/7: two pixels a row."""
    assert line_pixels(0, 0, 7, 3).tolist() == [[0, 0], [1, 0], [2, 1], [3, 1], [4, 2], [5, 2], [6, 3], [7, 3]]


def test_ties_go_to_the_smaller_coordinate() -> None:
    """A line through midpoints, rising and falling, shallow and steep."""
    assert line_pixels(0, 0, 2, 1)[:, 1].tolist() == [0, 0, 1]
    assert line_pixels(0, 1, 2, 0)[:, 1].tolist() == [1, 0, 0]
    assert line_pixels(0, 0, 1, 2)[:, 0].tolist() == [0, 0, 1]
    assert line_pixels(1, 0, 0, 2)[:, 0].tolist() == [1, 0, 0]


def test_a_line_of_no_length_is_one_pixel() -> None:
    assert line_pixels(2.25, 3.5, 2.25, 3.5).tolist() == [[2, 3]]


def test_far_ends_are_exact_and_not_walked() -> None:
    """A line a million pixels long through a small picture: the pixels of the same line cut by hand."""
    far = line_pixels(-1_000_000, -500_000, 1_000_000, 500_000, clip=(0, 0, 8, 8))
    assert far.tolist() == line_pixels(0, 0, 7, 3.5).tolist()


@pytest.mark.parametrize("end", [float("nan"), float("inf"), 2e6])
def test_ends_out_of_reach_are_refused(end: float) -> None:
    with pytest.raises(SceneError, match="ends of lines must be finite"):
        line_pixels(0, 0, end, 1)


def test_painted_lines_are_the_listed_pixels() -> None:
    """Onto a canvas, with a clip rectangle and alpha, in order."""
    lines = [(1, 1, 9, 4), (9, 0, 2, 9), (-5, 3, 20, 8)]
    canvas = Canvas(10, 10)
    with canvas.clipped(1.5, 0.5, 6, 8):
        canvas.pixel_lines(lines, [(1, 0, 0, 0.5), (0, 1, 0, 0.5), (0, 0, 1, 1)])
    expected = np.zeros((10, 10, 4))
    for line, color in zip(lines, [(0.5, 0, 0, 0.5), (0, 0.5, 0, 0.5), (0, 0, 1, 1)], strict=True):
        for x, y in line_pixels(*line, clip=(2, 1, 8, 9)).tolist():
            expected[y, x] = np.array(color) + expected[y, x] * (1.0 - color[3])
    alpha = expected[..., 3:]
    straight = np.where(alpha > 0, expected / np.where(alpha > 0, alpha, 1), 0)
    straight[..., 3] = expected[..., 3]
    np.testing.assert_allclose(canvas.image().pixels, straight, atol=1e-6)
