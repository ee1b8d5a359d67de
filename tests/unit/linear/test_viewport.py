"""The viewport transformation (FoCG 7.1.1, with the errata's translation)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError
from limner.linear.projection import divided, perspective
from limner.linear.viewport import crop, inverse_viewport, rows_from_top, viewport

sizes = st.integers(1, 4096)
places = st.integers(-4096, 4096)


@given(st.integers(1, 1 << 20), st.integers(1, 1 << 20))
def test_canonical_square_becomes_the_picture_exactly(n_x, n_y):
    """[-1, 1]^2 -> [-0.5, n_x - 0.5] x [-0.5, n_y - 0.5] without rounding, and z stays."""
    corners = viewport(n_x, n_y) @ np.array([[-1.0, 1.0], [-1.0, 1.0], [0.25, -0.25], [1.0, 1.0]])
    np.testing.assert_array_equal(corners, [[-0.5, n_x - 0.5], [-0.5, n_y - 0.5], [0.25, -0.25], [1.0, 1.0]])


def test_pixel_centres_are_integers():
    """The first pixel's centre lies half a pixel inside the picture: at -1 + 1/n."""
    m = viewport(4, 2)
    np.testing.assert_array_equal((m @ [-0.75, -0.5, 0.0, 1.0])[:2], [0.0, 0.0])
    np.testing.assert_array_equal((m @ [0.75, 0.5, 0.0, 1.0])[:2], [3.0, 1.0])


def test_empty_pictures_are_refused():
    with pytest.raises(SceneError, match="0 x 4"):
        viewport(0, 4)
    with pytest.raises(SceneError, match="4 x 0"):
        crop(8, 8, 0, 0, 4, 0)


@given(sizes, sizes, places, places)
def test_viewport_may_be_a_part_of_the_picture(n_x, n_y, left, bottom):
    """FoCG 7.1: the size *and position* of the output; its inverse undoes it."""
    m = viewport(n_x, n_y, left, bottom)
    np.testing.assert_array_equal((m @ [-1, -1, 0.5, 1])[:3], [left - 0.5, bottom - 0.5, 0.5])
    np.testing.assert_array_equal((m @ [1, 1, 0.5, 1])[:3], [left + n_x - 0.5, bottom + n_y - 0.5, 0.5])
    np.testing.assert_allclose(inverse_viewport(n_x, n_y, left, bottom) @ m, np.eye(4), atol=1e-9)


def test_rows_from_the_top():
    """Row 0 from the bottom is the last from the top; twice is nothing."""
    np.testing.assert_array_equal(rows_from_top(480) @ [3, 0, 0.5, 1], [3, 479, 0.5, 1])
    np.testing.assert_array_equal(rows_from_top(480) @ rows_from_top(480), np.eye(4))


@given(sizes, sizes, places, places, sizes, sizes)
def test_pixels_of_a_part_are_pixels_of_the_whole(n_x, n_y, left, bottom, crop_x, crop_y):
    """What `crop` cuts out lies where it lay, less the corner; also before the divide, with w not 1."""
    clip = perspective(-1, 2, -1, 1, -1, -9) @ np.array([0.5, 0.25, -3.0, 1.0])
    whole = divided(viewport(n_x, n_y) @ clip)
    part = divided(viewport(crop_x, crop_y) @ crop(n_x, n_y, left, bottom, crop_x, crop_y) @ clip)
    np.testing.assert_allclose(part, whole - [left, bottom, 0.0], rtol=1e-12, atol=1e-9)
