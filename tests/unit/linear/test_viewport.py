"""The viewport transformation (FoCG 7.1.1, with the errata's translation)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError
from limner.linear.viewport import viewport


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
