"""Inverses by structure (FoCG 6.4), each against elimination."""

from __future__ import annotations

import numpy as np
import pytest

from limner.errors import SceneError
from limner.linear import inverse, transform, transform2d

TURN = transform.rotate((1, 2, 3), np.linspace(-3, 3, 7))
MOVE = transform.translate(np.arange(7.0), 2, 3)
SIZE = transform.scale(np.arange(1.0, 8.0), 2, -3)


@pytest.mark.parametrize(
    ("invert", "matrix"),
    [
        (inverse.inverse_scale, SIZE),
        (inverse.inverse_scale, transform2d.scale(2, -4)),
        (inverse.inverse_rotation, TURN),
        (inverse.inverse_rotation, transform.reflect((1, 2, 3))),
        (inverse.inverse_rotation, transform2d.rotate(0.3)),
        (inverse.inverse_translation, MOVE),
        (inverse.inverse_shear, transform.shear((1, 2, 3), (3, -1, 2))),
        (inverse.inverse_shear, transform2d.shear_y(3.0)),
        (inverse.inverse_rigid, MOVE @ TURN),
        (inverse.inverse_rigid, transform2d.rotate_about((1, 2), 0.5)),
        (inverse.inverse_affine, MOVE @ TURN @ SIZE @ transform.shear_x(1, 2)),
        (inverse.inverse_affine, transform2d.affine([[1, 2], [3, 4]], (5, 6))),
    ],
)
def test_inverse_undoes(invert, matrix):
    """Times the matrix it is nothing, from both sides; elimination finds the same; and the matrix itself is left alone."""
    before = matrix.copy()
    back = invert(matrix)
    np.testing.assert_array_equal(matrix, before)
    unit = np.broadcast_to(np.eye(matrix.shape[-1]), matrix.shape)
    np.testing.assert_allclose(back @ matrix, unit, atol=1e-13)
    np.testing.assert_allclose(matrix @ back, unit, atol=1e-13)
    np.testing.assert_allclose(back, np.linalg.inv(matrix), atol=1e-13)


def test_simple_inverses_are_exact():
    """Powers of two are inverted, moves reversed and rotations transposed without any rounding."""
    np.testing.assert_array_equal(inverse.inverse_scale(transform.scale(2, 4, -8)), transform.scale(0.5, 0.25, -0.125))
    np.testing.assert_array_equal(inverse.inverse_translation(MOVE), transform.translate(-np.arange(7.0), -2, -3))
    np.testing.assert_array_equal(inverse.inverse_rotation(transform.rotate_y(0.3)), transform.rotate_y(-0.3))


def test_the_inverse_of_a_product_is_the_product_of_inverses_reversed():
    product = MOVE @ TURN @ SIZE
    back = inverse.inverse_scale(SIZE) @ inverse.inverse_rotation(TURN) @ inverse.inverse_translation(MOVE)
    np.testing.assert_allclose(back, inverse.inverse_affine(product), atol=1e-13)


@pytest.mark.parametrize("invert", [inverse.inverse_scale, inverse.inverse_affine])
def test_what_is_flat_has_no_inverse(invert):
    with pytest.raises(SceneError, match="no inverse"):
        invert(transform.scale(1, 0, 1))
