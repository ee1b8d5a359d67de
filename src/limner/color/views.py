"""Views: how light becomes what a screen shows, by name, and exposure in stops.

    none               the numbers themselves, without a curve: for data
    standard           the sRGB curve alone; what is brighter than 1 is cut off
    reinhard           L / (1 + L) on luminance
    reinhard_extended  the same, with 4 (two stops above 1) as white
    hable              a film's curve on each channel
    aces               the Academy's, nearly (Hill's fit)
    narkowicz          the same, more simply and more saturated
    agx                as a photograph: bright saturated light turns pale
    pbr_neutral        Khronos': the picture as it is, and highlights bent

What each does to the light says `limner.color.tonemap`, and `limner.color.agx`. Exposure comes first: one stop doubles the light.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from .agx import agx
from .tonemap import Floats, aces, hable, narkowicz, pbr_neutral, reinhard

__all__ = ["VIEWS", "checked_exposure", "checked_view", "screen_light"]

_EXTENDED_WHITE = 4.0
_MAX_STOPS = 64.0


def _as_it_is(light: ArrayLike) -> Floats:
    return np.asarray(light)


def _reinhard_extended(light: ArrayLike) -> Floats:
    return reinhard(light, _EXTENDED_WHITE)


_CURVES: dict[str, Callable[[ArrayLike], Floats]] = {
    "none": _as_it_is,
    "standard": _as_it_is,
    "reinhard": reinhard,
    "reinhard_extended": _reinhard_extended,
    "hable": hable,
    "aces": aces,
    "narkowicz": narkowicz,
    "agx": agx,
    "pbr_neutral": pbr_neutral,
}

VIEWS = tuple(_CURVES)
"""The names."""


def screen_light(pixels: NDArray[np.float32], view: str = "standard", exposure: float = 0.0) -> NDArray[np.float32]:
    """What a screen is to emit for a picture.

    Parameters
    ----------
    pixels : (..., 3) or (..., 4) float32
        Linear Rec. 709, and alpha, which is kept as it is.
    view : str
        One of `VIEWS`.
    exposure : float
        Stops: the light is multiplied by 2^exposure first.

    Returns
    -------
    float32 of the same shape
        Linear Rec. 709. In [0, 1] but for the views "none" and "standard", which change nothing: the encoding cuts off. The same array
        where nothing changes.

    >>> grey = np.full((1, 3), 0.18, dtype=np.float32)
    >>> [round(float(screen_light(grey, name)[0, 0]), 3) for name in ("standard", "reinhard", "agx", "pbr_neutral")]
    [0.18, 0.153, 0.218, 0.14]
    >>> round(float(screen_light(grey, exposure=1.0)[0, 0]), 6)
    0.36
    """
    curve, stops = _CURVES[checked_view(view)], checked_exposure(exposure)
    if curve is _as_it_is and stops == 0.0:
        return pixels
    color = pixels[..., :3] * np.float32(2.0**stops) if stops != 0.0 else pixels[..., :3]
    made = curve(color)
    if pixels.shape[-1] == 3:
        return made.astype(np.float32, copy=False)
    return np.concatenate([made, pixels[..., 3:]], axis=-1, dtype=np.float32)


def checked_view(view: str) -> str:
    """The name, if it is one of `VIEWS`; UnsupportedError names all of them."""
    if view not in VIEWS:
        raise UnsupportedError(f"view must be one of {', '.join(VIEWS)}, got {view!r}")
    return view


def checked_exposure(exposure: float) -> float:
    """Stops as a float, from -64 to 64; SceneError else."""
    try:
        stops = float(exposure)
    except (TypeError, ValueError):
        raise SceneError(f"exposure must be a number of stops, got {exposure!r}") from None
    if not (math.isfinite(stops) and abs(stops) <= _MAX_STOPS):
        raise SceneError(f"exposure must lie between -{_MAX_STOPS:g} and {_MAX_STOPS:g} stops, got {exposure!r}")
    return stops
