"""Dashes fit their lines."""

from __future__ import annotations

import numpy as np

from limner.draw.dash import fitted


def test_short_lines_begin_and_end_with_a_dash() -> None:
    """At least two dashes of about the pattern's proportions; the last is neither a speck nor followed by much."""
    for length in np.linspace(1.0, 18.0, 60).tolist():
        dash, gap = fitted((3.0, 0.75), length)
        assert np.isclose(dash / gap, 4.0)
        assert dash + gap < length
        count = round((length + gap) / (dash + gap))
        assert count >= 2
        last = length - (count - 1) * (dash + gap)  # of the pattern, from where its last dash begins
        assert 0.3 * dash < last < 1.5 * dash


def test_other_lines_keep_their_pattern() -> None:
    """Long ones, those without length, and patterns of more parts."""
    for dashes, length in (((3.0, 0.75), 100.0), ((3.0, 0.75), 0.0), ((4.0, 1.0, 0.5, 1.0), 5.0), ((), 5.0)):
        assert fitted(dashes, length) == dashes
