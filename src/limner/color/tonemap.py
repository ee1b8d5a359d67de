"""From light without limit to the light of a screen: the classic tone curves (FoCG 20).

A scene's light spans a million to one, a screen's some hundreds to one. Cutting off what is too bright loses the sun, the lamp and the
highlight; a tone curve bends them down instead, the brightest most. Each curve here takes linear Rec. 709 light without limit, where 0.18
is a grey card in the exposure's middle, and gives linear Rec. 709 light in [0, 1], which a screen's own curve encodes.

    reinhard      L / (1 + L), on luminance: never white, and colours as they are
    hable         a film's curve as a fraction of quadratics, on each channel
    aces          a fit of the Academy's reference rendering and display, with its matrices
    narkowicz     a simpler fit of the same, on each channel
    pbr_neutral   the picture as it is up to 0.76, and only what is brighter bent, towards white

What light cannot be (less than 0, no number) is taken as 0; infinity is taken as very bright.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["aces", "hable", "narkowicz", "pbr_neutral", "reinhard", "sound_light"]

Floats = NDArray[np.floating]

_LUMINANCE = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709-6, 3.2
_BRIGHTEST = 1e9  # its square is still a float32


def sound_light(linear: ArrayLike) -> Floats:
    """Light as it can be: what is below 0 or no number becomes 0, what is beyond 1e9 becomes that; float32 stays it, else float64.

    >>> sound_light(np.array([-1.0, np.nan, 0.18, np.inf])).tolist()
    [0.0, 0.0, 0.18, 1000000000.0]
    """
    given = np.asarray(linear)
    kind = np.float32 if given.dtype in (np.float32, np.float16) else np.float64
    return np.minimum(np.fmax(given.astype(kind, copy=False), kind(0.0)), kind(_BRIGHTEST))


def reinhard(linear: ArrayLike, white: float | None = None) -> Floats:
    """Bend luminance, and scale colours with it.

    Parameters
    ----------
    linear : (..., 3) float
        Linear Rec. 709.
    white : float > 0, optional
        The least luminance that becomes 1; None: only infinity does.

    Returns
    -------
    (..., 3) float in [0, 1]
        ``L (1 + L / white²) / (1 + L)``, times the colour over its luminance L; what a saturated colour then has above 1 is cut off.

    >>> reinhard([1.0, 1.0, 1.0]).round(6).tolist(), reinhard([4.0, 4.0, 4.0], white=4.0).round(6).tolist()
    ([0.5, 0.5, 0.5], [1.0, 1.0, 1.0])

    **Source**: Reinhard, Stark, Shirley and Ferwerda, *Photographic tone reproduction for digital images*, SIGGRAPH 2002, equations 3
    and 4, without the adaptation to the picture's mean (equations 1 and 2): exposure is told, so that pictures of a clip match.
    """
    if white is not None and not white > 0.0:
        raise SceneError(f"white must be a positive number, got {white!r}")
    light = sound_light(linear)
    luminance = (light @ np.array(_LUMINANCE, dtype=light.dtype))[..., None]
    share = 1.0 / (1.0 + luminance)
    if white is not None:
        share = share * (1.0 + luminance / white**2)
    return np.minimum(light * share.astype(light.dtype), 1.0)


def hable(linear: ArrayLike) -> Floats:
    """Bend each channel as a film does: a soft toe, a straight middle, a long shoulder.

    ``f(2 x) / f(11.2)`` with ``f(x) = (x (A x + C B) + D E) / (x (A x + B) + D F) - E / F``: (..., 3) float -> (..., 3) float in [0, 1].

    >>> hable([0.0, 0.18, 5.6]).round(4).tolist()
    [0.0, 0.1283, 1.0]

    **Source**: Hable, *Uncharted 2: HDR lighting*, GDC 2010, with its constants: A, B shoulder and linear strength 0.15, 0.50, C linear
    angle 0.10, D, E, F toe 0.20, 0.02, 0.30; exposure bias 2, white 11.2.
    """
    A, B, C, D, E, F = 0.15, 0.50, 0.10, 0.20, 0.02, 0.30

    def filmed(x: Floats) -> Floats:
        return (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F

    light = sound_light(linear)
    at_white = float(filmed(np.float64(11.2)))
    return np.clip(filmed(2.0 * light) / at_white, 0.0, 1.0).astype(light.dtype)


_ACES_INPUT = (
    (0.59719, 0.35458, 0.04823),
    (0.07600, 0.90834, 0.01566),
    (0.02840, 0.13383, 0.83777),
)
_ACES_OUTPUT = (
    (1.60475, -0.53108, -0.07367),
    (-0.10208, 1.10813, -0.00605),
    (-0.00327, -0.07276, 1.07602),
)


def aces(linear: ArrayLike) -> Floats:
    """Bend as the Academy's reference rendering and its transform for a monitor of 100 nit do, nearly.

    ``output · r(input · linear)`` with ``r(x) = (x² + 0.0245786 x - 0.000090537) / (0.983729 x² + 0.4329510 x + 0.238081)``: into a wide
    space a little less saturated, bent there, and back, so that bright saturated light turns pale: (..., 3) float -> (..., 3) float.

    >>> aces([0.0, 0.0, 0.0]).tolist(), aces([0.18, 0.18, 0.18]).round(3).tolist()
    ([0.0, 0.0, 0.0], [0.106, 0.106, 0.106])

    **Source**: the fit and both matrices are S. Hill's, as published with M. Pettineo's *Baking Lab* (2016), of ACES 1.0's RRT and
    ODT.Academy.Rec709_100nits_dim, from and to linear Rec. 709; without the factor of 1.8 that game engines put before it.
    """
    light = sound_light(linear)
    x = light @ np.array(_ACES_INPUT, dtype=light.dtype).T
    bent = (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081)
    return np.clip(bent @ np.array(_ACES_OUTPUT, dtype=light.dtype).T, 0.0, 1.0).astype(light.dtype)


def narkowicz(linear: ArrayLike) -> Floats:
    """Bend each channel by a simple fit of the Academy's curve.

    ``x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14)``, at most 1: (..., 3) float -> (..., 3) float. Brighter and more saturated than
    `aces`: primaries stay so however bright they are.

    >>> narkowicz([0.0, 0.18, 1.0]).round(4).tolist()
    [0.0, 0.2669, 0.8038]

    **Source**: Narkowicz, *ACES filmic tone mapping curve*, 2016.
    """
    x = sound_light(linear)
    return np.minimum(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 1.0).astype(x.dtype)


def pbr_neutral(linear: ArrayLike) -> Floats:
    """Keep colours as they are, and bend only what is too bright for the screen: for goods that must look like themselves.

    The reflection that every dielectric has at normal incidence (0.04) is taken off, so that base colours come out as they were painted
    under grey light; a greatest channel p beyond 0.76 becomes ``1 - d² / (p + d - 0.76)`` with d = 0.24, and the colour is mixed with
    white by ``1 - 1 / (0.15 (p - p') + 1)``: (..., 3) float -> (..., 3) float in [0, 1].

    >>> pbr_neutral([0.54, 0.34, 0.24]).round(6).tolist(), pbr_neutral([0.02, 0.02, 0.02]).round(6).tolist()
    ([0.5, 0.3, 0.2], [0.0025, 0.0025, 0.0025])

    **Source**: Khronos Group, *PBR Neutral tone mapper* (specification, 2024): F90 and start of compression 0.8 - 0.04, desaturation
    0.15.
    """
    F90, START, DESATURATION = 0.04, 0.8 - 0.04, 0.15
    light = sound_light(linear)
    least = light.min(axis=-1, keepdims=True)
    offset = np.where(least < 2.0 * F90, least - least**2 / (4.0 * F90), F90)
    color = light - offset
    peak = color.max(axis=-1, keepdims=True)
    d = 1.0 - START
    bent = 1.0 - d * d / (np.maximum(peak, START) + d - START)
    pale = 1.0 - 1.0 / (DESATURATION * (peak - bent) + 1.0)
    compressed = color * (bent / np.maximum(peak, START))
    compressed += (bent - compressed) * pale
    return np.clip(np.where(peak < START, color, compressed), 0.0, 1.0).astype(light.dtype)
