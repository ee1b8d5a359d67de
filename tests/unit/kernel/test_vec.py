"""Vectors and colours: the algebra they promise, and float32 throughout."""

from __future__ import annotations

import numpy as np
from compiled import over
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from limner._jit import kernel
from limner.kernel import vec
from limner.kernel.vec import Color, Vec3

_coordinate = st.floats(-1e6, 1e6, width=32)
_vectors = arrays(np.float32, (4, 3), elements=_coordinate)
_scales = arrays(np.float32, 4, elements=st.floats(2.0**-10, 1024.0, width=32))
_EPS = np.finfo(np.float32).eps


@kernel
def _plus(a: Vec3, b: Vec3) -> Vec3:
    return a + b


@kernel
def _minus(a: Vec3, b: Vec3) -> Vec3:
    return a - b


@kernel
def _scaled(a: Vec3, s: np.float32) -> tuple[Vec3, Vec3, Vec3, Vec3]:
    return a * s, a / s, -a, a * 0.1


@kernel
def _tinted(a: Color, b: Color, s: np.float32) -> tuple[Color, Color, Color, Color, Color]:
    return a * b, a + b, a - b, a * s, -(a / s)


@given(_vectors, _vectors, _scales)
def test_operators_are_float32_component_by_component(a: np.ndarray, b: np.ndarray, s: np.ndarray) -> None:
    """The same bits as NumPy in float32, also times the Python float 0.1."""
    np.testing.assert_array_equal(over(_plus, a, b), a + b)
    np.testing.assert_array_equal(over(_minus, a, b), a - b)
    times, divided, negated, tenth = over(_scaled, a, s)
    np.testing.assert_array_equal(times, a * s[:, None])
    np.testing.assert_array_equal(divided, a / s[:, None])
    np.testing.assert_array_equal(negated, -a)
    np.testing.assert_array_equal(tenth, a * np.float32(0.1))


@given(_vectors, _vectors, _scales)
def test_colors_multiply_componentwise(a: np.ndarray, b: np.ndarray, s: np.ndarray) -> None:
    """Filtering light: channel by channel; the other operators as for vectors."""
    product, total, difference, scaled, negated = over(_tinted, a, b, s)
    np.testing.assert_array_equal(product, a * b)
    np.testing.assert_array_equal(total, a + b)
    np.testing.assert_array_equal(difference, a - b)
    np.testing.assert_array_equal(scaled, a * s[:, None])
    np.testing.assert_array_equal(negated, -(a / s[:, None]))


@given(_vectors, _vectors)
def test_cross_is_perpendicular_and_antisymmetric(a: np.ndarray, b: np.ndarray) -> None:
    """a x b = -(b x a), and its dot product with either is rounding noise; dot agrees with float64."""
    c = over(vec.cross, a, b)
    np.testing.assert_array_equal(c, -over(vec.cross, b, a))
    size = np.linalg.norm(a.astype(float), axis=1) * np.linalg.norm(b.astype(float), axis=1)
    for side in (a, b):
        slack = 8 * _EPS * size * np.linalg.norm(side.astype(float), axis=1)
        assert np.all(np.abs((c.astype(float) * side).sum(1)) <= slack + 1e-30)
    assert np.all(np.abs(over(vec.dot, a, b) - (a.astype(float) * b).sum(1)) <= 4 * _EPS * size + 1e-30)


@given(_vectors)
def test_normalize_gives_unit_vectors_in_the_same_direction(a: np.ndarray) -> None:
    """|v| = 1 within 4 eps unless the square underflows; zero stays zero."""
    size = np.linalg.norm(a.astype(float), axis=1)
    unit = over(vec.normalize, a)
    usable = size > 1e-15
    assert np.all(np.abs(np.linalg.norm(unit[usable].astype(float), axis=1) - 1) < 4 * _EPS)
    np.testing.assert_allclose(unit[usable] * size[usable, None], a[usable], rtol=1e-5, atol=1e-5 * size.max(initial=0.0))
    np.testing.assert_array_equal(unit[size == 0], 0.0)
    np.testing.assert_allclose(over(vec.length, a)[usable], size[usable], rtol=4 * _EPS)


@given(_vectors, _vectors)
def test_reflection_is_an_involution_that_keeps_lengths(d: np.ndarray, n: np.ndarray) -> None:
    """Reflecting twice gives the direction back; n . r = -n . d."""
    n = n.astype(float) + np.array([0.0, 0.0, 3e6])
    n = (n / np.linalg.norm(n, axis=1, keepdims=True)).astype(np.float32)
    r = over(vec.reflect, d, n)
    size = np.linalg.norm(d.astype(float), axis=1)
    slack = 20 * _EPS * size + 1e-30
    assert np.all(np.abs(over(vec.reflect, r, n) - d).max(1) <= slack)
    assert np.all(np.abs(np.linalg.norm(r.astype(float), axis=1) - size) <= slack)
    assert np.all(np.abs(((r.astype(float) + d) * n).sum(1)) <= slack)


@given(arrays(np.float32, 4, elements=_coordinate), arrays(np.float32, 4, elements=_coordinate), st.floats(0, 1, width=32))
def test_lerp_meets_its_ends_and_stays_between(a: np.ndarray, b: np.ndarray, t: float) -> None:
    """(1 - t) a + t b, exact at both ends."""
    np.testing.assert_array_equal(over(vec.lerp, a, b, 0.0), a)
    np.testing.assert_array_equal(over(vec.lerp, a, b, 1.0), b)
    slack = 2 * _EPS * np.maximum(np.abs(a), np.abs(b))
    between = over(vec.lerp, a, b, t)
    assert np.all((between >= np.minimum(a, b) - slack) & (between <= np.maximum(a, b) + slack))


def test_luminance_of_white_is_one_and_of_primaries_their_share() -> None:
    """ITU-R BT.709: 0.2126, 0.7152, 0.0722."""
    colors = np.array([[1, 1, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]], np.float32)
    np.testing.assert_allclose(over(vec.luminance, colors), [1, 0.2126, 0.7152, 0.0722, 0], atol=1e-7)
    np.testing.assert_array_equal(over(vec.max_component, colors * np.float32([1, 2, 3])), [3, 1, 2, 3, 0])
