"""The sRGB curve: the standard's numbers, there and back, and the fast path to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from limner.color.transfer import bytes_from_linear, bytes_from_unit, linear_from_srgb, srgb_from_linear


def _by_the_formula(linear: np.ndarray) -> np.ndarray:
    """Write the standard's two branches out, in float64, and round half up."""
    with np.errstate(invalid="ignore"):  # signalling NaNs say so when they are widened
        wide = np.asarray(linear).astype(np.float64)
    x = np.nan_to_num(wide, nan=0.0, posinf=1.0, neginf=0.0).clip(0.0, 1.0)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1.0 / 2.4) - 0.055)
    return np.floor(encoded * 255.0 + 0.5).astype(np.uint8)


@pytest.mark.parametrize(
    ("linear", "encoded"),
    [(0.0, 0.0), (1.0, 1.0), (0.0031308, 0.04045), (0.2140411, 0.5), (0.5, 0.7353570), (0.18, 0.4613561)],
)
def test_the_curve_passes_through_known_points(linear: float, encoded: float) -> None:
    """Values of IEC 61966-2-1 at six digits, both ways."""
    assert srgb_from_linear(linear) == pytest.approx(encoded, abs=1e-6)
    assert linear_from_srgb(encoded) == pytest.approx(linear, abs=1e-6)


@given(st.floats(0.0, 1.0))
def test_decoding_undoes_encoding(x: float) -> None:
    """The two branches meet within 4e-8 at the standard's rounded threshold; elsewhere they are inverse to rounding."""
    assert linear_from_srgb(srgb_from_linear(x)) == pytest.approx(x, abs=1e-7)


def test_every_code_survives_there_and_back() -> None:
    """All 256 codes come back as they were: a texture that is only copied does not change."""
    codes = np.arange(256, dtype=np.uint8)
    assert (bytes_from_linear(linear_from_srgb(codes / 255.0).astype(np.float32)) == codes).all()


def test_the_table_is_the_formula_on_both_sides_of_every_rounding() -> None:
    """At each of the 255 changes of code the last float32 below and the first at or above it are told apart."""
    changes = linear_from_srgb((np.arange(1, 256) - 0.5) / 255.0).astype(np.float32)
    for steps in range(-8, 9):
        near = (changes.view(np.int32) + np.int32(steps)).view(np.float32)
        assert (bytes_from_linear(near) == _by_the_formula(near)).all()


def test_the_table_is_the_formula_all_over_float32() -> None:
    """Every 4099th of all 2^32 bit patterns: negative, tiny, huge, infinite and NaN too."""
    patterns = np.arange(0, 1 << 32, 4099, dtype=np.uint64).astype(np.uint32).view(np.float32)
    assert (bytes_from_linear(patterns) == _by_the_formula(patterns)).all()


@given(arrays.arrays(np.float32, arrays.array_shapes(min_dims=0, max_dims=3), elements=st.floats(-2.0, 2.0, width=32)))
def test_any_shape_goes_in_and_comes_out(linear: np.ndarray) -> None:
    """Shapes are kept, strides do not matter."""
    assert bytes_from_linear(linear).shape == linear.shape
    assert (bytes_from_linear(linear.T) == _by_the_formula(linear.T)).all()


def test_unit_values_round_to_the_nearest_code() -> None:
    """Alpha: each code's own value comes back, halves go up, what is no number is nothing."""
    codes = np.arange(256)
    assert (bytes_from_unit((codes / 255.0).astype(np.float32)) == codes).all()
    odd = np.array([-np.inf, -0.1, 0.5, 1.5, np.inf, np.nan], dtype=np.float32)
    assert bytes_from_unit(odd).tolist() == [0, 0, 128, 255, 255, 0]
