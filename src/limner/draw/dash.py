"""Dashes that end where their line ends: a short dashed line, too, begins and ends with a dash, and so meets its neighbours (ISO 128-2).

    fitted((3.0, 0.75), 4.0)        two dashes with a gap between them, a little shorter than asked

A pattern that is simply begun at one end of a line leaves at the other what is left: a gap, where a corner should be, or one dash alone,
which looks like a line that is not dashed at all.
"""

from __future__ import annotations

import math

__all__ = ["fitted"]

_PERIODS = 5  # beyond so many, an end is a small part of the line
_STEPS = 16  # to the double of a pattern, so that lines of about one length share one


def fitted(dashes: tuple[float, ...], length: float) -> tuple[float, ...]:
    """Stretch or shrink a pattern of a dash and a gap so that a line begins and ends with a dash.

    Parameters
    ----------
    dashes : (float, float)
        Other patterns are returned as they are.
    length : float
        Of the line; a line of many dashes keeps its pattern.

    >>> dash, gap = fitted((3.0, 0.75), 4.0)
    >>> round(2 * dash + gap, 2), round(dash / gap, 2)
    (3.84, 4.0)
    """
    if len(dashes) != 2 or not sum(dashes) > 0.0 or not 0.0 < length < _PERIODS * sum(dashes):
        return dashes
    dash, gap = dashes
    count = max(2, round((length + gap) / (dash + gap)))
    scale = length / (count * dash + (count - 1) * gap)
    scale = 2.0 ** (math.floor(math.log2(scale) * _STEPS) / _STEPS)
    return dash * scale, gap * scale
