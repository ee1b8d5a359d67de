"""Quaternions: turning, composing, and the way between two rotations."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limner.errors import SceneError
from limner.linear import quaternion, transform

numbers = st.integers(-192, 192).map(lambda n: n / 64.0)
quaternions = arrays(np.float64, 4, elements=numbers).filter(np.any)
vectors = arrays(np.float64, 3, elements=numbers).filter(np.any)
shares = st.floats(0.0, 1.0)
REST = [0.0, 0.0, 0.0, 1.0]


def same_turn(p, q, atol=1e-12) -> None:
    np.testing.assert_allclose(quaternion.to_matrix(p), quaternion.to_matrix(q), atol=atol)


@given(vectors, st.floats(-np.pi, np.pi))
def test_axis_and_angle_are_told_back(axis, angle):
    """In [0, pi], with the axis turned round for negative angles."""
    found_axis, found_angle = quaternion.axis_and_angle(quaternion.from_axis_angle(axis, angle))
    assert float(found_angle) == pytest.approx(abs(angle), abs=1e-12)
    if abs(angle) > 1e-150:
        np.testing.assert_allclose(found_axis, np.sign(angle) * axis / np.linalg.norm(axis), atol=1e-12)


def test_what_turns_nothing():
    """Identity and the zero quaternion: angle 0 about +x."""
    for q in (REST, [0, 0, 0, -2], [0, 0, 0, 0]):
        axis, angle = quaternion.axis_and_angle(q)
        assert axis.tolist() == [1, 0, 0]
        assert angle == 0.0
        np.testing.assert_array_equal(quaternion.to_matrix(q), np.eye(3))


@given(quaternions, quaternions, vectors)
def test_products_are_turns_one_after_the_other(p, q, v):
    """In the order of matrices, right to left; and the conjugate turns back."""
    p, q = quaternion.normalized(p), quaternion.normalized(q)
    product = quaternion.multiply(p, q)
    np.testing.assert_allclose(quaternion.to_matrix(product), quaternion.to_matrix(p) @ quaternion.to_matrix(q), atol=1e-13)
    np.testing.assert_allclose(quaternion.rotate(product, v), quaternion.rotate(p, quaternion.rotate(q, v)), atol=1e-12)
    np.testing.assert_allclose(quaternion.rotate(p, v), quaternion.to_matrix(p) @ v, atol=1e-12)
    np.testing.assert_allclose(quaternion.multiply(p, quaternion.conjugate(p)), REST, atol=1e-14)


@given(quaternions)
def test_matrices_lead_back_to_their_quaternion(q):
    """Up to its sign and length; a rotation by half a turn about any axis too, where w = 0."""
    found = quaternion.from_matrix(quaternion.to_matrix(q))
    unit = quaternion.normalized(q)
    np.testing.assert_allclose(found * np.sign(found @ unit), unit, atol=1e-13)
    assert found[3] >= 0.0
    half_turn = quaternion.normalized([*q[:3], 0.0]) if q[:3].any() else quaternion.normalized([1, 2, 3, 0])
    same_turn(quaternion.from_matrix(quaternion.to_matrix(half_turn)), half_turn)


def test_arrays_of_matrices():
    """All four branches of Shepperd's method at once, of any leading shape, 3x3 or 4x4."""
    q = quaternion.normalized(np.random.default_rng(3).normal(size=(4, 8, 4)) + 3.0 * np.eye(4)[:, None, :])
    q = np.where(q[..., 3:] < 0.0, -q, q)
    np.testing.assert_allclose(quaternion.from_matrix(quaternion.to_matrix(q)), q, atol=1e-14)
    np.testing.assert_allclose(quaternion.from_matrix(transform.compose_trs((1, 2, 3), q, (1, 1, 1))), q, atol=1e-14)
    assert set(np.argmax(q, axis=-1).ravel()) == {0, 1, 2, 3}


@given(vectors, vectors)
def test_the_smallest_turn_between_two_directions(a, b):
    """It takes a to b, about an axis at right angles to both, and is no larger than the angle between them."""
    unit_a, unit_b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    q = quaternion.between(a, b)
    np.testing.assert_allclose(quaternion.rotate(q, unit_a), unit_b, atol=1e-13)
    _, angle = quaternion.axis_and_angle(q)
    assert float(angle) == pytest.approx(2 * np.arctan2(np.linalg.norm(unit_a - unit_b), np.linalg.norm(unit_a + unit_b)), abs=1e-7)


@given(vectors, st.sampled_from([0.0, 1e-15, 1e-9, 1e-5]))
def test_opposite_directions_are_half_a_turn_apart(a, off):
    """Exactly or nearly: there is always some axis."""
    b = -a + off * np.roll(a, 1)
    q = quaternion.between(a, b)
    np.testing.assert_allclose(quaternion.rotate(q, a / np.linalg.norm(a)), b / np.linalg.norm(b), atol=1e-13)


@given(quaternions, quaternions, shares)
def test_slerp_has_constant_speed(p, q, t):
    """FoCG 16.2.2: after a share t of the time, a share t of the angle; ends included; never more than half a turn."""
    whole = float(quaternion.angle_between(p, q))
    assert 0.0 <= whole <= np.pi + 1e-12
    here = quaternion.slerp(p, q, t)
    assert np.linalg.norm(here) == pytest.approx(1.0)
    assert float(quaternion.angle_between(p, here)) == pytest.approx(t * whole, abs=1e-12)
    assert float(quaternion.angle_between(here, q)) == pytest.approx((1 - t) * whole, abs=1e-12)
    same_turn(quaternion.slerp(p, q, 0.0), p)
    same_turn(quaternion.slerp(p, q, 1.0), q)


@given(quaternions, quaternions, shares)
def test_slerp_turns_about_one_axis(p, q, t):
    """It is: turn back by p, take a share of what is left to q's angle about its axis."""
    p, q = quaternion.normalized(p), quaternion.normalized(q)
    axis, angle = quaternion.axis_and_angle(quaternion.multiply(q, quaternion.conjugate(p)))
    if angle > np.pi - 1e-6:  # the two ways round are equally long
        return
    same_turn(quaternion.slerp(p, q, t), quaternion.multiply(quaternion.from_axis_angle(axis, t * angle), p), 1e-11)


@given(quaternions, st.floats(1e-18, 1e-7), shares)
def test_slerp_of_rotations_that_are_almost_one(q, angle, t):
    """No 0 / 0: tiny angles are shared out as finely as floats are."""
    p = quaternion.normalized(q)
    near = quaternion.multiply(quaternion.from_axis_angle((1, 0, 0), angle), p)
    assert float(quaternion.angle_between(p, quaternion.slerp(p, near, t))) == pytest.approx(t * angle, abs=1e-15)


@given(quaternions, quaternions, shares)
def test_nlerp_keeps_to_the_arc_and_lags_little(p, q, t):
    """The same way as slerp, the same in the middle, and never more than 8.15 degrees of turning off (half a turn's worst)."""
    here, even = quaternion.nlerp(p, q, t), quaternion.slerp(p, q, t)
    whole = float(quaternion.angle_between(p, q))
    assert float(quaternion.angle_between(here, even)) <= np.radians(8.15)
    done = float(quaternion.angle_between(p, here)) + float(quaternion.angle_between(here, q))
    assert done == pytest.approx(whole, abs=1e-12)
    same_turn(quaternion.nlerp(p, q, 0.5), quaternion.slerp(p, q, 0.5))


def test_the_shorter_way_round():
    """q and -q turn alike, and the way to them is the same."""
    p, q = quaternion.from_axis_angle((0, 0, 1), 0.1), quaternion.from_axis_angle((0, 0, 1), 0.3)
    for end in (q, -q):
        same_turn(quaternion.slerp(p, end, 0.5), quaternion.from_axis_angle((0, 0, 1), 0.2))
        same_turn(quaternion.nlerp(p, end, 0.5), quaternion.from_axis_angle((0, 0, 1), 0.2))
    p, q = quaternion.from_axis_angle((0, 0, 1), np.radians(-170)), quaternion.from_axis_angle((0, 0, 1), np.radians(170))
    same_turn(quaternion.slerp(p, q, 0.5), quaternion.from_axis_angle((0, 0, 1), np.pi))


def test_many_shares_at_once():
    """An animation's frames: (k,) shares of one way are (k, 4)."""
    p, q, t = quaternion.from_axis_angle((0, 1, 0), [0.0, 1.0]), quaternion.from_axis_angle((1, 0, 0), 1.0), np.linspace(0, 1, 5)
    many = quaternion.slerp(p[:, None], q, t)
    assert many.shape == (2, 5, 4)
    np.testing.assert_allclose(many[1, 3], quaternion.slerp(p[1], q, t[3]), atol=1e-15)
    np.testing.assert_allclose(quaternion.rotate(many, (1, 2, 3))[1, 3], quaternion.rotate(many[1, 3], (1, 2, 3)), atol=1e-15)


@pytest.mark.parametrize("call", [lambda: quaternion.from_axis_angle((0, 0, 0), 1.0), lambda: quaternion.between((0, 0, 0), (1, 0, 0))])
def test_no_direction_is_refused(call):
    with pytest.raises(SceneError):
        call()
