"""AgX: light as a photograph holds it, so that the brightest light turns pale instead of strangely coloured.

A curve on each channel drives saturated light against the walls of the screen's gamut: a blue lamp stays blue at any brightness, an orange
one turns yellow. Film does not do that: its layers see a little of each other's light. AgX does the same in four steps:

    inset      mix a little of each primary into the others, so that nothing is quite pure
    encode     log2 of what comes out, from 10 stops below middle grey to 6.5 above, as [0, 1]
    bend       a sigmoid: a toe, a slope of 2 through middle grey, a shoulder
    outset     take the mixing back, so that what was not bent is as saturated as before

**Source**: Sobotka, *AgX* (2022; `AgX.py` and its OpenColorIO configuration): range, pivot, slope and powers of the sigmoid. The matrix for
linear Rec. 709 is that of the configuration's Rec. 709 inset as printed by Wrensch, *Minimal AgX implementation*, 2023; its inverse as
outset is his, too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .tonemap import Floats, sound_light

__all__ = ["INSET", "agx", "agx_curve"]

INSET: NDArray[np.float64] = np.array(
    [
        [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
        [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
        [0.0423756549057051, 0.0784336, 0.879142973793104],
    ]
)
"""(3, 3): linear Rec. 709 with a little of each primary in the others; greys stay."""
INSET.setflags(write=False)

MIDDLE_GREY = 0.18
_STOPS_BELOW, _STOPS_ABOVE = 10.0, 6.5
_PIVOT = _STOPS_BELOW / (_STOPS_BELOW + _STOPS_ABOVE), 0.5
_SLOPE = 2.0
_TOE_POWER, _SHOULDER_POWER = 3.0, 3.25
_DISPLAY_GAMMA = 2.2


def agx(linear: ArrayLike) -> Floats:
    """Bend light as AgX does, with its base look.

    Parameters
    ----------
    linear : (..., 3) float
        Linear Rec. 709 without limit.

    Returns
    -------
    (..., 3) float in [0, 1]
        Linear Rec. 709 of the screen. Middle grey becomes the middle of the code: 0.5^2.2 = 0.218.

    >>> agx([0.18, 0.18, 0.18]).round(3).tolist()
    [0.218, 0.218, 0.218]
    """
    light = sound_light(linear)
    kind = light.dtype
    stops = np.log2(np.maximum(light @ INSET.T.astype(kind), kind.type(1e-12)) / kind.type(MIDDLE_GREY))
    encoded = np.clip((stops + kind.type(_STOPS_BELOW)) / kind.type(_STOPS_BELOW + _STOPS_ABOVE), 0.0, 1.0)
    code = np.clip(agx_curve(encoded) @ np.linalg.inv(INSET).T.astype(kind), 0.0, 1.0)
    return np.power(code, kind.type(_DISPLAY_GAMMA)).astype(kind)


def agx_curve(encoded: ArrayLike) -> Floats:
    """The sigmoid: [0, 1] of log-encoded light to [0, 1] of a display of gamma 2.2.

    ``y0 + s h(m (x - x0) / s)`` with ``h(t) = t / (1 + |t|^p)^(1/p)`` below and above the pivot (x0, y0) each, s such that it ends in
    (0, 0) and (1, 1), m = 2 the slope at the pivot and p the power.

    >>> [round(abs(float(code)), 6) for code in agx_curve([0.0, 10.0 / 16.5, 1.0])]
    [0.0, 0.5, 1.0]
    """
    x = np.asarray(encoded)
    x0, y0 = _PIVOT
    toe, shoulder = _scale(x0, y0, _TOE_POWER), _scale(1.0 - x0, 1.0 - y0, _SHOULDER_POWER)
    below = y0 - toe * _hyperbola(_SLOPE * np.maximum(x0 - x, 0.0) / toe, _TOE_POWER)
    above = y0 + shoulder * _hyperbola(_SLOPE * np.maximum(x - x0, 0.0) / shoulder, _SHOULDER_POWER)
    return np.where(x < x0, below, above).astype(x.dtype if x.dtype == np.float32 else np.float64)


def _hyperbola(t: Floats, power: float) -> Floats:
    return t / np.power(1.0 + np.power(t, power), 1.0 / power)


def _scale(width: float, height: float, power: float) -> float:
    """The scale with which a half of the sigmoid, as wide and high as given, ends in its corner."""
    return float(((_SLOPE * width) ** -power * ((_SLOPE * width / height) ** power - 1.0)) ** (-1.0 / power))
