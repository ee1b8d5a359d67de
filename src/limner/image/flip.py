"""FLIP: how different two pictures look to someone who flips between them.

Numbers such as the RMSE count every pixel alone. An eye does not: what is finer than it resolves it averages, a shift of colour it sees
less than one of lightness, and edges and specks it sees first. FLIP follows it in two pipelines and joins them,

    dE = dE_color ^ (1 - dE_feature)

one number from 0 to 1 for each pixel: how much it seems to change.

    colour     filter both pictures as the eye does at that distance; measure the distance in a uniform colour space (Hunt-adjusted
               CIELAB, HyAB); compress, since large differences are all alike
    feature    edges and points in the lightness of both, of the size that the eye sees best

**Source**: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, *FLIP: a difference evaluator for alternating images*,
HPG 2020; constants in its sections 4 and 5.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .separable import convolution_taps, filtered

__all__ = ["PIXELS_PER_DEGREE", "flip_map", "pixels_per_degree"]

Floats = NDArray[np.float64]

_CHROMATICITIES = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))  # Rec. 709
_WHITE = (0.3127, 0.3290)  # D65

_CONTRAST = (  # of the eye, per channel: a1, b1, a2, b2 in a1 exp(-b1 f^2) + a2 exp(-b2 f^2), f in cycles per degree
    (1.0, 0.0047, 0.0, 1e-5),
    (1.0, 0.0053, 0.0, 1e-5),
    (34.1, 0.04, 13.5, 0.025),
)
_Q_COLOR, _P_COLOR, _P_TOP = 0.7, 0.4, 0.95
_FEATURE_DEGREES, _Q_FEATURE = 0.082, 0.5


def pixels_per_degree(distance: float = 0.7, width_pixels: float = 3840.0, width: float = 0.7) -> float:
    """Return how many pixels one degree of the eye's field holds.

    Parameters
    ----------
    distance : float > 0
        From eye to monitor, metres.
    width_pixels, width : float > 0
        Of the monitor; metres.

    >>> round(pixels_per_degree(), 4)
    67.0206
    """
    return distance * width_pixels / width * math.pi / 180.0


PIXELS_PER_DEGREE = pixels_per_degree()
"""Of the paper: a monitor of 3840 pixels and 0.7 m, seen from 0.7 m."""


def flip_map(reference: NDArray[np.floating], test: NDArray[np.floating], ppd: float = PIXELS_PER_DEGREE) -> NDArray[np.float32]:
    """Compare two pictures for a screen.

    Parameters
    ----------
    reference, test : (height, width, 3) float
        *Linear* Rec. 709, as a screen shows it: clipped to [0, 1].
    ppd : float > 0
        Pixels per degree.

    Returns
    -------
    (height, width) float32 in [0, 1]
        0: nobody sees a difference.
    """
    spaces = [_opponent_from_linear(np.clip(np.asarray(picture, dtype=np.float64), 0.0, 1.0)) for picture in (reference, test)]
    color = _color_difference(*(_seen(space, ppd) for space in spaces))
    first, second = ((space[..., :1] + 16.0) / 116.0 for space in spaces)
    feature = _feature_difference(first, second, ppd)
    return np.power(color, 1.0 - feature).astype(np.float32)


# --- colour spaces ----------------------------------------------------------------------------------------------------------


class _Primaries(NamedTuple):
    xyz_from_rgb: Floats
    rgb_from_xyz: Floats
    white: Floats


def _primaries() -> _Primaries:
    """The matrices of Rec. 709, from its chromaticities: each primary so bright that together they are white of Y = 1."""
    columns = np.array([[x / y, 1.0, (1.0 - x - y) / y] for x, y in _CHROMATICITIES]).T
    white = np.array([_WHITE[0] / _WHITE[1], 1.0, (1.0 - sum(_WHITE)) / _WHITE[1]])
    matrix = columns * np.linalg.solve(columns, white)
    return _Primaries(matrix, np.linalg.inv(matrix), white)


_RGB = _primaries()


def _opponent_from_linear(rgb: Floats) -> Floats:
    """YyCxCz: lightness, red-green, blue-yellow, all linear in light, so that they may be filtered."""
    x, y, z = np.moveaxis(rgb @ _RGB.xyz_from_rgb.T / _RGB.white, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def _linear_from_opponent(opponent: Floats) -> Floats:
    y = (opponent[..., 0] + 16.0) / 116.0
    xyz = np.stack([y + opponent[..., 1] / 500.0, y, y - opponent[..., 2] / 200.0], axis=-1)
    return (xyz * _RGB.white) @ _RGB.rgb_from_xyz.T


def _lab_from_linear(rgb: Floats) -> Floats:
    ratio = rgb @ _RGB.xyz_from_rgb.T / _RGB.white
    edge = 6.0 / 29.0
    f = np.where(ratio > edge**3, np.cbrt(ratio), ratio / (3.0 * edge**2) + 4.0 / 29.0)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def _hunt_adjusted(lab: Floats) -> Floats:
    """What is darker is less colourful."""
    lab[..., 1:] *= 0.01 * lab[..., :1]
    return lab


def _hyab(a: Floats, b: Floats) -> Floats:
    difference = a - b
    return np.abs(difference[..., 0]) + np.hypot(difference[..., 1], difference[..., 2])


# --- colour -----------------------------------------------------------------------------------------------------------------


def _seen(opponent: Floats, ppd: float) -> Floats:
    """The picture as the eye resolves it: each opponent channel through its contrast sensitivity, in space a sum of Gaussians."""
    widest = max(b for _, b1, _, b2 in _CONTRAST for b in (b1, b2))
    radius = math.ceil(3.0 * math.sqrt(widest / (2.0 * math.pi**2)) * ppd)
    degrees = np.arange(-radius, radius + 1) / ppd
    height, width = opponent.shape[:2]
    made = np.zeros_like(opponent)
    for channel, (a1, b1, a2, b2) in enumerate(_CONTRAST):
        plane, total = opponent[..., channel : channel + 1], 0.0
        for a, b in ((a1, b1), (a2, b2)):
            if a == 0.0:
                continue
            kernel = np.exp(-(math.pi**2) / b * degrees**2)
            strength = a * math.sqrt(math.pi / b)
            total += strength * kernel.sum() ** 2
            blurred = filtered(plane, convolution_taps(kernel, height), convolution_taps(kernel, width))
            made[..., channel : channel + 1] += strength * blurred
        made[..., channel] /= total
    return np.clip(_linear_from_opponent(made), 0.0, 1.0)


def _color_difference(reference: Floats, test: Floats) -> Floats:
    error = np.power(_hyab(_hunt_adjusted(_lab_from_linear(reference)), _hunt_adjusted(_lab_from_linear(test))), _Q_COLOR)
    green, blue = (_hunt_adjusted(_lab_from_linear(np.array([color]))) for color in ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    greatest = float(_hyab(green, blue)[0] ** _Q_COLOR)
    bend = _P_COLOR * greatest
    return np.where(error < bend, _P_TOP / bend * error, _P_TOP + (error - bend) / (greatest - bend) * (1.0 - _P_TOP))


# --- features ---------------------------------------------------------------------------------------------------------------


def _feature_difference(reference: Floats, test: Floats, ppd: float) -> Floats:
    """How much edges and points differ, whichever more: (height, width) in [0, 1]."""
    sigma = 0.5 * _FEATURE_DEGREES * ppd
    radius = math.ceil(3.0 * sigma)
    x = np.arange(-radius, radius + 1.0)
    smooth = np.exp(-(x**2) / (2.0 * sigma**2))
    smooth /= smooth.sum()
    edge = _normalised(-x * np.exp(-(x**2) / (2.0 * sigma**2)))
    point = _normalised((x**2 / sigma**2 - 1.0) * np.exp(-(x**2) / (2.0 * sigma**2)))
    differences = [np.abs(_strength(test, kernel, smooth) - _strength(reference, kernel, smooth)) for kernel in (edge, point)]
    return np.power(np.maximum(*differences) / math.sqrt(2.0), _Q_FEATURE)


def _normalised(kernel: Floats) -> Floats:
    """Positive weights that sum to 1, negative ones that sum to -1."""
    return np.where(kernel > 0.0, kernel / kernel[kernel > 0.0].sum(), kernel / -kernel[kernel < 0.0].sum())


def _strength(lightness: Floats, kernel: Floats, smooth: Floats) -> Floats:
    height, width = lightness.shape[:2]
    across = filtered(lightness, convolution_taps(smooth, height), convolution_taps(kernel, width))[..., 0]
    down = filtered(lightness, convolution_taps(kernel, height), convolution_taps(smooth, width))[..., 0]
    return np.hypot(across, down)
