"""Affine transformations in any number of dimensions (FoCG 6.1.5, 6.3): composition, windows, whole arrays."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limner.errors import SceneError
from limner.linear import affine, projection, transform, transform2d

numbers = st.integers(-192, 192).map(lambda n: n / 64.0)
dimensions = st.sampled_from([2, 3])


def test_affine_is_a_linear_part_a_move_and_a_row():
    m = affine.affine([[1, 2], [3, 4]], (5, 6))
    np.testing.assert_array_equal(m, [[1, 2, 5], [3, 4, 6], [0, 0, 1]])
    np.testing.assert_array_equal(affine.affine(np.eye(3)), np.eye(4))
    assert affine.affine(np.eye(3), np.zeros((5, 1, 3))).shape == (5, 1, 4, 4)


@given(st.data(), dimensions)
def test_steps_happen_in_the_order_in_which_they_are_named(data, n):
    """The first step first; numbers are such that products are exact."""
    steps = [data.draw(arrays(np.float64, (n + 1, n + 1), elements=st.integers(-4, 4).map(float))) for _ in range(3)]
    for step in steps:
        step[n] = np.eye(n + 1)[n]
    point = data.draw(arrays(np.float64, n, elements=numbers))
    one_by_one = point
    for step in steps:
        one_by_one = affine.transform_points(step, one_by_one)
    np.testing.assert_array_equal(affine.transform_points(affine.in_order(*steps), point), one_by_one)
    np.testing.assert_array_equal(affine.in_order(*steps), steps[2] @ steps[1] @ steps[0])


def test_the_order_matters():
    """FoCG 6.1.5: first scale, then rotate is not first rotate, then scale."""
    wide, quarter = transform2d.scale(2, 1), transform2d.rotate(np.pi / 2)
    np.testing.assert_allclose(affine.in_order(wide, quarter) @ [1, 0], [0, 2], atol=1e-15)
    np.testing.assert_allclose(affine.in_order(quarter, wide) @ [1, 0], [0, 1], atol=1e-15)
    with pytest.raises(SceneError, match="at least one"):
        affine.in_order()


@given(st.data(), dimensions)
def test_about_keeps_the_point(data, n):
    """It is move, transform, move back; of affine matrices too."""
    linear = data.draw(arrays(np.float64, (n, n), elements=numbers))
    point, shift = (data.draw(arrays(np.float64, n, elements=numbers)) for _ in range(2))
    np.testing.assert_array_equal(affine.transform_points(affine.about(point, linear), point), point)
    there, back = affine.affine(np.eye(n), -point), affine.affine(np.eye(n), point)
    m = affine.affine(linear, shift)
    np.testing.assert_array_equal(affine.about(point, m), affine.in_order(there, m, back))


@given(st.data(), dimensions)
def test_window_takes_corner_to_corner(data, n):
    corners = data.draw(arrays(np.float64, (4, n), elements=numbers))
    low, high, to_low, to_high = corners
    if (low == high).any():
        with pytest.raises(SceneError, match="extent"):
            affine.window(*corners)
        return
    m = affine.window(*corners)
    np.testing.assert_allclose(affine.transform_points(m, low), to_low, atol=1e-9)
    np.testing.assert_allclose(affine.transform_points(m, high), to_high, atol=1e-9)
    np.testing.assert_allclose(affine.transform_points(m, (low + high) / 2), (to_low + to_high) / 2, atol=1e-9)


def test_orthographic_projection_is_a_window():
    """FoCG 7.1.2: M_orth takes the box [l, r] x [b, t] x [f, n] to [-1, 1]^3, as the windowing transformation does."""
    m = affine.window((-2, -1, -9), (3, 5, -1), (-1, -1, -1), (1, 1, 1))
    np.testing.assert_allclose(m, projection.orthographic(-2, 3, -1, 5, -1, -9), atol=1e-15)


def test_leading_axes_are_broadcast():
    """k matrices with k points: each its own; matrices[:, None]: every matrix with every point; as one at a time."""
    matrices = transform.rotate((1, 2, 3), np.linspace(0, 3, 5)) @ transform.translate(1, 2, 3)
    points = np.random.default_rng(0).normal(size=(5, 3))
    own = np.stack([affine.transform_points(m, p) for m, p in zip(matrices, points, strict=True)])
    np.testing.assert_allclose(affine.transform_points(matrices, points), own, atol=1e-14)
    every = np.stack([affine.transform_points(m, points) for m in matrices])
    np.testing.assert_allclose(affine.transform_points(matrices[:, None], points), every, atol=1e-14)
    vectors = np.stack([affine.transform_vectors(m, points) for m in matrices])
    np.testing.assert_allclose(affine.transform_vectors(matrices[:, None], points), vectors, atol=1e-14)
    np.testing.assert_allclose(affine.transform_points(matrices, (1, 2, 3))[4], affine.transform_points(matrices[4], (1, 2, 3)))
    assert affine.transform_points(matrices[0], np.zeros((0, 3))).shape == (0, 3)


@pytest.mark.parametrize("count", [4096, 4097, 12289])
def test_many_points_are_transformed_in_blocks(count):
    """The same as all at once, whatever is left over at the end; strided and shaped arrays too."""
    points = np.random.default_rng(count).normal(size=(count, 6))[:, ::2]
    m = transform.rotate((1, 2, 3), 0.5) @ transform.translate(1, 2, 3) @ transform.shear_x(2, 3)
    moved = affine.transform_points(m, points)
    np.testing.assert_allclose(moved, points @ m[:3, :3].T + m[:3, 3], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(affine.transform_vectors(m, points), points @ m[:3, :3].T, rtol=1e-12, atol=1e-14)
    np.testing.assert_array_equal(affine.transform_points(m, np.stack([points, points]))[1], affine.transform_points(m, points))


def test_linear_matrices_serve_points_and_vectors():
    """A 2x2 matrix on 2D points: FoCG 6.1, no homogeneous coordinate needed."""
    m = transform2d.shear_x(2.0)
    np.testing.assert_array_equal(affine.transform_points(m, [[1, 1], [0, 3]]), [[3, 1], [6, 3]])
    np.testing.assert_array_equal(affine.transform_vectors(m, [1, 1]), [3, 1])


@pytest.mark.parametrize(
    ("matrix", "points"), [(np.eye(4), (1, 2)), (np.eye(2), (1, 2, 3)), (np.eye(4), 5.0), (np.zeros((3, 4)), (1, 2, 3))]
)
def test_what_does_not_fit_is_refused(matrix, points):
    for apply in (affine.transform_points, affine.transform_vectors):
        with pytest.raises(SceneError, match="shape"):
            apply(matrix, points)
