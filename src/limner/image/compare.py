"""How different two pictures are: numbers, and a picture of where.

    rmse        root of the mean squared difference of linear light: for renderings, in their own unit
    rel_mse     squared difference over squared reference: bright and dark places count alike
    psnr        decibels between the screen's full range and the error of what is encoded; inf: equal
    ssim        structure as the eye takes it in, 1: equal (Wang et al. 2004)
    flip        mean of what someone sees who flips between them, 0: nothing (`limner.image.flip`)

Pictures with alpha are compared over black, and their alphas with them where that is a number of its own (rmse).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..color.transfer import linear_from_srgb, srgb_from_linear
from ..errors import SceneError, UnsupportedError
from .flip import PIXELS_PER_DEGREE, flip_map
from .formats import LUMINANCE
from .image import Image
from .separable import convolution_taps, filtered

__all__ = ["METRICS", "Comparison", "compared", "difference_picture", "flip", "psnr", "rel_mse", "rmse", "ssim", "ssim_of"]

METRICS = ("rmse", "rel_mse", "psnr", "ssim", "flip")

Floats = NDArray[np.float64]

_REL_FLOOR = 1e-2  # added to the squared reference, so that black is no division by zero
_SSIM_SIGMA, _SSIM_RADIUS = 1.5, 5
_SSIM_K1, _SSIM_K2 = 0.01, 0.03
# From nothing to everything: dark violet, red, light yellow; sRGB, each lighter than the last.
_HEAT = np.array(
    [
        (0, 0, 4), (28, 16, 68), (79, 18, 123), (129, 37, 129), (181, 54, 122), (229, 80, 100), (251, 135, 97), (254, 194, 135),
        (252, 253, 191),
    ]
) / 255.0  # fmt: skip


class Comparison(NamedTuple):
    """What differs between two pictures: METRICS, the greatest difference of linear light, and how many pixels differ at all."""

    rmse: float
    rel_mse: float
    psnr: float
    ssim: float
    flip: float
    max_difference: float
    n_different: int


def compared(reference: Image, test: Image, ppd: float = PIXELS_PER_DEGREE) -> Comparison:
    """Measure all there is to measure.

    >>> white, grey = (Image(np.full((8, 8, 4), value, dtype=np.float32)) for value in (1.0, 0.5))
    >>> compared(white, white).ssim, compared(white, white).psnr, compared(white, grey).max_difference
    (1.0, inf, 0.75)
    """
    a, b = _over_black(reference), _over_black(test)
    _check_sizes(reference, test)
    difference = np.abs(a - b)
    return Comparison(
        rmse(reference, test),
        rel_mse(reference, test),
        psnr(reference, test),
        ssim(reference, test),
        flip(reference, test, ppd),
        float(difference.max()),
        int((reference.pixels != test.pixels).any(axis=2).sum()),
    )


def rmse(reference: Image, test: Image) -> float:
    """Root mean squared difference of premultiplied linear light, and of alpha where either picture has any."""
    _check_sizes(reference, test)
    planes = [_over_black(reference) - _over_black(test)]
    alphas = reference.pixels[..., 3:], test.pixels[..., 3:]
    if any((alpha != 1.0).any() for alpha in alphas):
        planes.append(alphas[0].astype(np.float64) - alphas[1])
    return math.sqrt(float(np.mean(np.concatenate(planes, axis=2) ** 2)))


def rel_mse(reference: Image, test: Image) -> float:
    """Mean of ``(test - reference)^2 / (reference^2 + 0.01)`` over pixels and channels.

    **Source**: Rousselle, Knaus and Zwicker, *Adaptive sampling and reconstruction using greedy error minimization*, 2011.
    """
    _check_sizes(reference, test)
    a, b = _over_black(reference), _over_black(test)
    return float(np.mean((b - a) ** 2 / (a**2 + _REL_FLOOR)))


def psnr(reference: Image, test: Image) -> float:
    """Decibels: ``10 log10(1 / mean squared difference)`` of sRGB-encoded values in [0, 1]; inf where they are equal."""
    _check_sizes(reference, test)
    error = float(np.mean((srgb_from_linear(_over_black(reference)) - srgb_from_linear(_over_black(test))) ** 2))
    return 10.0 * math.log10(1.0 / error) if error > 0.0 else math.inf


def ssim(reference: Image, test: Image) -> float:
    """Mean structural similarity of encoded luminance, in [-1, 1]; see `ssim_of`."""
    _check_sizes(reference, test)
    a, b = (srgb_from_linear(_over_black(image) @ LUMINANCE.astype(np.float64)) for image in (reference, test))
    return ssim_of(a, b)


def ssim_of(a: NDArray[np.floating], b: NDArray[np.floating]) -> float:
    """Mean structural similarity of two grey pictures (height, width) with values in [0, 1].

    Windows are Gaussians of 11 x 11 pixels, sigma 1.5, that lie inside the picture; where it is smaller than one, its edges go on.

    **Source**: Wang, Bovik, Sheikh and Simoncelli, *Image quality assessment: from error visibility to structural similarity*, 2004,
    eq. 13 with K1 = 0.01, K2 = 0.03.
    """
    places = np.arange(-_SSIM_RADIUS, _SSIM_RADIUS + 1)
    window = np.exp(-(places**2) / (2.0 * _SSIM_SIGMA**2))
    window /= window.sum()
    height, width = a.shape
    x, y = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    moments = np.stack([x, y, x * x, y * y, x * y], axis=-1)
    mean_x, mean_y, xx, yy, xy = np.moveaxis(filtered(moments, convolution_taps(window, height), convolution_taps(window, width)), -1, 0)
    c1, c2 = _SSIM_K1**2, _SSIM_K2**2
    numerator = (2.0 * mean_x * mean_y + c1) * (2.0 * (xy - mean_x * mean_y) + c2)
    denominator = (mean_x**2 + mean_y**2 + c1) * (xx - mean_x**2 + yy - mean_y**2 + c2)
    similarity = numerator / denominator
    inside = similarity[_SSIM_RADIUS:-_SSIM_RADIUS, _SSIM_RADIUS:-_SSIM_RADIUS]
    return float((inside if inside.size else similarity).mean())


def flip(reference: Image, test: Image, ppd: float = PIXELS_PER_DEGREE) -> float:
    """Mean of the FLIP map, 0 to 1."""
    _check_sizes(reference, test)
    return float(flip_map(_over_black(reference), _over_black(test), ppd).mean())


def difference_picture(reference: Image, test: Image, kind: str = "flip", gain: float = 10.0, ppd: float = PIXELS_PER_DEGREE) -> Image:
    """Show where two pictures differ.

    Parameters
    ----------
    kind : "flip" | "absolute"
        FLIP's map from black over red to light yellow; or ``gain`` times the difference of linear light, and of alpha as grey added.
    gain : float > 0
    """
    _check_sizes(reference, test)
    if kind == "flip":
        color = linear_from_srgb(_heat(flip_map(_over_black(reference), _over_black(test), ppd)))
    elif kind == "absolute":
        alpha = np.abs(reference.pixels[..., 3:].astype(np.float64) - test.pixels[..., 3:])
        color = gain * (np.abs(_over_black(reference) - _over_black(test)) + alpha)
    else:
        raise UnsupportedError(f"kind must be flip or absolute, got {kind!r}")
    pixels = np.ones((reference.height, reference.width, 4), dtype=np.float32)
    pixels[..., :3] = color
    return Image(pixels)


def _heat(values: NDArray[np.floating]) -> Floats:
    """(..., 3) sRGB-encoded colours of values in [0, 1]; lighter is more."""
    steps = np.linspace(0.0, 1.0, len(_HEAT))
    return np.stack([np.interp(values, steps, _HEAT[:, channel]) for channel in range(3)], axis=-1)


def _over_black(image: Image) -> Floats:
    return image.pixels[..., :3].astype(np.float64) * image.pixels[..., 3:]


def _check_sizes(reference: Image, test: Image) -> None:
    if reference.pixels.shape != test.pixels.shape:
        sizes = f"{reference.width} x {reference.height} and {test.width} x {test.height}"
        raise SceneError(f"pictures that are compared must be of one size, got {sizes}")
