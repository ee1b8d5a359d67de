"""Decompositions (FoCG 6.1.5, 6.1.6): the factors are what they are said to be, and multiply to the matrix again."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limner.errors import SceneError
from limner.linear import decompose, quaternion, transform, transform2d

numbers = st.integers(-192, 192).map(lambda n: n / 64.0)
matrices = st.sampled_from([2, 3]).flatmap(lambda n: arrays(np.float64, (n, n), elements=numbers))
sizes = st.sampled_from([-2.0, -1e-6, 0.0, 1e-6, 0.5, 1.0, 3.0, 1e6])
vectors = arrays(np.float64, 3, elements=numbers)
quaternions = arrays(np.float64, 4, elements=numbers).filter(np.any)


def assert_rotation(m, determinant=1.0) -> None:
    np.testing.assert_allclose(m.T @ m, np.eye(len(m)), atol=1e-12)
    assert np.linalg.det(m) == pytest.approx(determinant)


@given(matrices)
def test_eigen(m):
    """A rotation to the axes, a stretch, and the rotation back."""
    symmetric = m + m.T
    rotation, factors = decompose.eigen(symmetric)
    assert_rotation(rotation)
    np.testing.assert_allclose(rotation @ np.diag(factors) @ rotation.T, symmetric, atol=1e-12)
    assert (np.diff(factors) <= 0.0).all()


@given(matrices)
def test_singular(m):
    """Two rotations; a mirror stays in the last factor."""
    after, factors, before = decompose.singular(m)
    assert_rotation(after)
    assert_rotation(before)
    np.testing.assert_allclose(after @ np.diag(factors) @ before.T, m, atol=1e-12)
    assert (factors[:-1] >= 0.0).all()
    assert (np.diff(np.abs(factors)) <= 0.0).all()


@given(matrices)
def test_polar(m):
    """An orthogonal factor and a symmetric one without negative eigenvalues, also of singular matrices."""
    rotation, stretch = decompose.polar(m)
    np.testing.assert_allclose(rotation.T @ rotation, np.eye(len(m)), atol=1e-12)
    np.testing.assert_allclose(stretch, stretch.T, atol=1e-12)
    assert np.linalg.eigvalsh(stretch).min() > -1e-12
    np.testing.assert_allclose(rotation @ stretch, m, atol=1e-12)


def test_polar_is_the_limit_of_higham_s_iteration():
    """Q <- (Q + Q^-T) / 2, started at the matrix: a way to the same factor without singular values."""
    for m in np.random.default_rng(5).normal(size=(20, 3, 3)):
        q = m
        for _ in range(60):
            q = (q + np.linalg.inv(q).T) / 2.0
        np.testing.assert_allclose(decompose.polar(m).rotation, q, atol=1e-9)


@given(vectors, quaternions, st.tuples(sizes, sizes, sizes))
def test_trs_recomposes(translation, q, size):
    """Any translation, rotation and scale: mirrored, flattened, thin or huge; the size comes back but for signs."""
    m = transform.compose_trs(translation, q, size)
    found = decompose.trs(m)
    np.testing.assert_allclose(transform.compose_trs(*found), m, rtol=1e-9, atol=1e-12 * max(map(abs, size)))
    np.testing.assert_array_equal(found.translation, translation)
    np.testing.assert_allclose(np.abs(found.size), np.abs(size), rtol=1e-12)
    assert (found.size[1:] >= 0.0).all()
    if all(s > 0.0 for s in size):
        np.testing.assert_allclose(quaternion.to_matrix(found.rotation), quaternion.to_matrix(q), atol=1e-9)


def test_trs_of_many_and_of_none():
    m = transform.compose_trs((1, 2, 3), quaternion.from_axis_angle((1, 2, 3), np.linspace(-3, 3, 7)), (1, 2, -3))
    found = decompose.trs(m.reshape(7, 1, 4, 4))
    assert found.size.shape == (7, 1, 3)
    np.testing.assert_allclose(transform.compose_trs(*found)[:, 0], m, atol=1e-14)
    assert decompose.trs(np.zeros((0, 4, 4))).rotation.shape == (0, 4)


def test_shear_is_no_trs():
    """It is named, and how far the axes are off; rounding is let pass."""
    with pytest.raises(SceneError, match=r"shear.*0\.45"):
        decompose.trs(transform.shear_x(0.5, 0.0))
    decompose.trs(transform.shear_x(1e-12, 0.0))


@given(vectors, vectors, quaternions, quaternions, st.floats(0, 1))
def test_interpolation_of_rigid_motions_is_slerp_and_a_straight_line(a, b, p, q, t):
    """And both ends are met."""
    start, end = transform.compose_trs(a, p, (1, 1, 1)), transform.compose_trs(b, q, (1, 1, 1))
    here = decompose.interpolate(start, end, t)
    np.testing.assert_allclose(here[:3, 3], (1 - t) * a + t * b, atol=1e-12)
    assert_rotation(here[:3, :3])
    if quaternion.angle_between(p, q) < np.pi - 1e-3:
        np.testing.assert_allclose(here[:3, :3], quaternion.to_matrix(quaternion.slerp(p, q, t)), atol=1e-10)
    np.testing.assert_allclose(decompose.interpolate(start, end, 0.0), start, atol=1e-12)
    np.testing.assert_allclose(decompose.interpolate(start, end, 1.0), end, atol=1e-12)


def test_interpolation_with_shear_scale_and_mirrors():
    """Ends are met whatever they are; a scale goes straight; from a mirrored to an unmirrored one there is no way."""
    start = transform.shear_x(1, 2) @ transform.scale(1, 2, 3)
    end = transform.translate(1, 2, 3) @ transform.rotate((1, 2, 3), 2.0) @ transform.shear_z(1, 0)
    mirror = transform.reflect((1, 2, 3))
    for a, b in ((start, end), (mirror @ start, mirror @ end)):
        ends = decompose.interpolate(a, b, [0.0, 1.0])
        np.testing.assert_allclose(ends, [a, b], atol=1e-13)
    np.testing.assert_allclose(
        decompose.interpolate(transform.scale(1), transform.scale(3, 5, 7), 0.5), transform.scale(2, 3, 4), atol=1e-14
    )
    with pytest.raises(SceneError, match="mirrored"):
        decompose.interpolate(np.eye(4), mirror, 0.5)


@given(st.floats(-3.0, 3.0))
def test_a_rotation_is_three_shears(angle):
    """Paeth's: each has determinant 1 and moves points along one axis only."""
    first, second, third = decompose.shears(angle)
    np.testing.assert_allclose(first @ second @ third, transform2d.rotate(angle), atol=1e-13)
    np.testing.assert_array_equal(first, transform2d.shear_x(first[0, 1]))
    np.testing.assert_array_equal(second, transform2d.shear_y(second[1, 0]))
    np.testing.assert_array_equal(third, first)


def test_half_a_turn_is_no_three_shears():
    with pytest.raises(SceneError, match="half a turn"):
        decompose.shears(np.pi)
