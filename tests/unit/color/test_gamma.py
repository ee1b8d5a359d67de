"""The plain power of a monitor: known values, there and back, and how near sRGB is to 2.2."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.color.transfer import gamma_from_linear, linear_from_gamma, linear_from_srgb
from limner.errors import SceneError


def test_a_checkerboard_measures_gamma() -> None:
    """The book's experiment: the input a that looks as bright as half of all pixels has gamma = ln 0.5 / ln a."""
    for gamma in (1.0, 1.8, 2.2, 2.6):
        a = gamma_from_linear(0.5, gamma)
        assert np.log(0.5) / np.log(a) == pytest.approx(gamma)


@given(st.floats(0.0, 1.0), st.floats(0.3, 4.0))
def test_decoding_undoes_encoding(x: float, gamma: float) -> None:
    """Both ways, and nothing leaves [0, 1]."""
    assert linear_from_gamma(gamma_from_linear(x, gamma), gamma) == pytest.approx(x, abs=1e-12)
    assert (linear_from_gamma([-1.0, 2.0], gamma) == [0.0, 1.0]).all()


def test_srgb_is_nearly_a_power_of_2_2() -> None:
    """Within one hundredth of full light, as everybody says."""
    s = np.linspace(0.0, 1.0, 1001)
    assert np.abs(linear_from_srgb(s) - linear_from_gamma(s, 2.2)).max() < 0.01


@pytest.mark.parametrize("gamma", [0.0, -2.2, np.nan, np.inf])
def test_powers_that_are_none_are_refused(gamma: float) -> None:
    """By name."""
    with pytest.raises(SceneError, match="gamma must be a positive number"):
        linear_from_gamma(0.5, gamma)
