"""How far our own elementary functions are from the true ones, over wide ranges, and what they do at the edges.

References are NumPy's float64 functions at the float32 argument. An ulp is the spacing of float32 at the reference.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from compiled import over

from limner._jit import MODE
from limner.kernel import elementary

N = 100_000 if MODE == "compiled" else 3_000
INF, NAN = np.inf, np.nan


def _uniform(low: float, high: float) -> np.ndarray:
    return np.random.default_rng(7).uniform(low, high, N).astype(np.float32)


def _ulps(got: np.ndarray, want: np.ndarray) -> float:
    spacing = np.spacing(np.abs(want).astype(np.float32)).astype(np.float64)
    return float(np.max(np.abs(got.astype(np.float64) - want) / spacing))


def _absolute(got: np.ndarray, want: np.ndarray) -> float:
    return float(np.max(np.abs(got.astype(np.float64) - want)))


def _expect(kernel: Any, *rows: tuple[float, ...]) -> None:
    """Exact values at the edges, the sign of a zero aside. A row: the arguments, then the value."""
    *arguments, values = np.array(rows, np.float32).T
    np.testing.assert_array_equal(over(kernel, *arguments), values)


@pytest.mark.parametrize(("low", "high"), [(-126.0, 127.9999), (-1.0, 1.0)])
def test_exp2_is_within_two_ulps(low: float, high: float) -> None:
    """Over all normal results, and where the polynomial alone decides."""
    x = _uniform(low, high)
    assert _ulps(over(elementary.exp2, x), np.exp2(x.astype(np.float64))) < 2.0


def test_exp2_of_integers_is_exact() -> None:
    """2^n for every n whose power is a normal number."""
    n = np.arange(-126, 128)
    np.testing.assert_array_equal(over(elementary.exp2, n), np.exp2(n.astype(np.float64)).astype(np.float32))


def test_exp2_at_the_edges() -> None:
    """0 below the least normal number and for NaN, infinity from 128 on, and finite just below.

    Bug: everything from 127.5 on was infinite, since the integer part 128 does not fit one exponent. Fix: two halves.
    """
    none = [(-126.00001, 0), (-127, 0), (-1e30, 0), (-INF, 0), (NAN, 0)]
    _expect(elementary.exp2, *none, (0.0, 1), (-0.0, 1), (128, INF), (1e30, INF), (INF, INF))
    assert np.all(np.isfinite(over(elementary.exp2, [127.5, 127.9, 127.99999])))


def test_log2_is_within_four_ulps() -> None:
    """Over all normal arguments, and near 1, where the result vanishes."""
    for x in (np.exp2(_uniform(-126, 127.99).astype(np.float64)).astype(np.float32), _uniform(0.5, 2.0)):
        x = x[x != 1.0]
        assert _ulps(over(elementary.log2, x), np.log2(x.astype(np.float64))) < 4.0


def test_log2_of_powers_is_exact_and_total() -> None:
    """log2 2^n = n; what is below the least normal number counts as it, NaN too.

    Bug: log2(-0.0) was 129 and log2(-1) was -256, from the sign bit.
    """
    n = np.arange(-126, 128)
    np.testing.assert_array_equal(over(elementary.log2, np.exp2(n.astype(np.float64)).astype(np.float32)), n)
    _expect(elementary.log2, (0.0, -126), (-0.0, -126), (-1, -126), (-INF, -126), (NAN, -126), (1e-45, -126), (INF, 128))


def test_power_is_as_accurate_as_its_exponent_allows() -> None:
    """The relative error is below 2e-7 for each unit of |p log2 x| (and one more), for Phong's range of exponents."""
    rng = np.random.default_rng(8)
    x, p = np.exp2(rng.uniform(-20, 2, N)).astype(np.float32), rng.uniform(0, 200, N).astype(np.float32)
    exponent = p.astype(np.float64) * np.log2(x.astype(np.float64))
    keep = (exponent > -125.9) & (exponent < 127.9)
    relative = np.abs(over(elementary.power, x, p)[keep] / np.exp2(exponent[keep]) - 1.0)
    assert np.max(relative / (1.0 + np.abs(exponent[keep]))) < 2e-7


def test_power_at_the_edges() -> None:
    """0^p = 0, x^0 = 1 for every x, negative and NaN bases give 0."""
    zero_base = [(0.0, 1, 0), (0.0, 0.5, 0), (0.0, 0, 1), (0.0, -1, 0), (-0.0, 2, 0)]
    no_base = [(-1, 2, 0), (-1, 0, 1), (NAN, 1, 0), (NAN, 0, 1)]
    extremes = [(1, 1e5, 1), (2, 10, 1024), (2, 128, INF), (0.5, 200, 0), (INF, 1, INF), (0.5, INF, 0)]
    _expect(elementary.power, *zero_base, *no_base, *extremes)


@pytest.mark.parametrize("reach", [1.0, 100.0, 1000.0, 10000.0])
def test_sine_and_cosine_are_within_2e_7(reach: float) -> None:
    """Absolute error, also where the reduction has to cancel thousands of turns."""
    x = _uniform(-reach, reach)
    assert _absolute(over(elementary.sin, x), np.sin(x.astype(np.float64))) < 2e-7
    assert _absolute(over(elementary.cos, x), np.cos(x.astype(np.float64))) < 2e-7


def test_cosine_and_sine_of_an_octant() -> None:
    """Without reduction of the argument: as good as with it, to pi/4 on both sides."""
    x = _uniform(-np.pi / 4.0, np.pi / 4.0)
    c, s = over(elementary.cos_sin_of_octant, x)
    assert _absolute(s, np.sin(x.astype(np.float64))) < 1e-7
    assert _absolute(c, np.cos(x.astype(np.float64))) < 1e-7


def test_sine_keeps_its_relative_accuracy_near_zero() -> None:
    """sin x is x for tiny x, to the last place."""
    x = np.exp2(_uniform(-60, -1).astype(np.float64)).astype(np.float32)
    assert _ulps(over(elementary.sin, x), np.sin(x.astype(np.float64))) < 1.5


def test_sine_and_cosine_of_the_absurd() -> None:
    """Beyond 2^17, infinite or NaN: the angle counts as 0, so that the result is a point of the circle on every CPU."""
    absurd = [131073.0, -1e8, 1e30, INF, -INF, NAN]
    _expect(elementary.sin, *((x, 0.0) for x in absurd))
    _expect(elementary.cos, *((x, 1.0) for x in absurd))
    x = _uniform(-2e5, 2e5)
    assert np.max(np.abs(over(elementary.sin, x))) <= 1.0
    assert np.max(np.abs(over(elementary.cos, x))) <= 1.0


def test_atan2_is_within_3e_7_in_all_quadrants_and_scales() -> None:
    """From 2^-60 to 2^60 in either coordinate."""
    rng = np.random.default_rng(9)
    y, x = (rng.normal(size=(2, N)) * np.exp2(rng.uniform(-60, 60, (2, N)))).astype(np.float32)
    assert _absolute(over(elementary.atan2, y, x), np.arctan2(y.astype(np.float64), x.astype(np.float64))) < 3e-7
    y, x = rng.normal(size=(2, N)).astype(np.float32)
    got, want = over(elementary.atan2, y, x), np.arctan2(y.astype(np.float64), x.astype(np.float64))
    assert _absolute(got, want) < 3e-7
    assert _ulps(got, want) < 4.0


def test_atan2_on_axes_and_diagonals() -> None:
    """Multiples of 45 degrees are right to the bit; zeros count as positive; the origin is at angle 0."""
    pi = np.pi
    axes = [(0, 1, 0), (1, 0, pi / 2), (0, -1, pi), (-1, 0, -pi / 2)]
    diagonals = [(1, 1, pi / 4), (-1, 1, -pi / 4), (1, -1, 3 * pi / 4), (-1, -1, -3 * pi / 4)]
    zeros = [(0.0, 0.0, 0), (-0.0, 0.0, 0), (0.0, -0.0, 0), (-0.0, -0.0, 0), (-0.0, 1, 0), (-0.0, -1, pi), (1, -0.0, pi / 2)]
    far = [(1, INF, 0), (1, -INF, pi), (INF, 1, pi / 2), (-INF, 1, -pi / 2)]
    _expect(elementary.atan2, *axes, *diagonals, *zeros, *far)


def test_acos_is_within_3e_7_and_clamps() -> None:
    """Also within 4 ulps near 1, where the textbook formula loses half of its digits; beyond [-1, 1] it gives 0 or pi."""
    x = _uniform(-1.0, 1.0)
    assert _absolute(over(elementary.acos, x), np.arccos(x.astype(np.float64))) < 3e-7
    near = (1.0 - np.exp2(_uniform(-24, -1).astype(np.float64))).astype(np.float32)
    near = near[near < 1.0]
    assert _ulps(over(elementary.acos, near), np.arccos(near.astype(np.float64))) < 4.0
    _expect(
        elementary.acos,
        (1, 0),
        (-1, np.pi),
        (1.0000001, 0),
        (-1.0000001, np.pi),
        (5, 0),
        (-INF, np.pi),
        (0, np.pi / 2),
        (NAN, 0),
    )


def test_safe_sqrt_is_exact_and_zero_below_zero() -> None:
    """The machine's correctly rounded root; 0 for negative numbers and NaN."""
    x = np.exp2(_uniform(-149, 127.9).astype(np.float64)).astype(np.float32)
    np.testing.assert_array_equal(over(elementary.safe_sqrt, x), np.sqrt(x))
    _expect(elementary.safe_sqrt, (-1, 0), (-0.0, 0), (NAN, 0), (INF, INF), (4, 2), (-INF, 0))


def test_the_circle() -> None:
    """sin^2 + cos^2 = 1, and atan2 takes the point of the circle back to its angle."""
    x = _uniform(-3.1415, 3.1415)
    s, c = over(elementary.sin, x), over(elementary.cos, x)
    assert _absolute(s.astype(np.float64) ** 2 + c.astype(np.float64) ** 2, np.ones(N)) < 4e-7
    assert _absolute(over(elementary.atan2, s, c), x.astype(np.float64)) < 5e-7
