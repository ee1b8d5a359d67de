"""Resampling: the same picture with other pixels (FoCG 3.2, 9.4).

New pixels are samples of the picture that the old ones stand for. Both pictures cover the same rectangle, so the centre of new pixel i
of n lies at ``(i + 1/2) N/n - 1/2`` of N old ones. Where the picture shrinks, the filter grows with the new pixels: detail that they
cannot show is averaged, not picked at random. Colour is weighted by alpha, so that what is transparent does not bleed in.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from .image import straight
from .reconstruct import Reconstruction, Taps, reconstruction, taps
from .separable import filtered

__all__ = ["MAX_SIDE", "resized"]

MAX_SIDE = 32768


def resized(pixels: NDArray[np.float32], width: int, height: int, filter: str = "mitchell") -> NDArray[np.float32]:
    """Resample a picture.

    Parameters
    ----------
    pixels : (old height, old width, 4) float32
        Linear light, straight alpha.
    width, height : int, 1 to 32768
    filter : "box" | "tent" | "gaussian" | "mitchell" | "lanczos3"
        The last two ring a little: a result may lie below the darkest or above the brightest pixel. Alpha is held in [0, 1].

    Returns
    -------
    (height, width, 4) float32
        A constant picture stays the same to the bit; the same size is the same picture where the filter interpolates (all but
        gaussian and mitchell, which soften).

    **Source**: Schumacher, *General filtered image rescaling*, Graphics Gems III, 1992; premultiplied as Porter and Duff, 1984.
    """
    for name, value in (("width", width), ("height", height)):
        if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not 1 <= value <= MAX_SIDE:
            raise SceneError(f"{name} must be an integer from 1 to {MAX_SIDE}, got {value!r}")
    kind = reconstruction(filter)
    old_height, old_width = pixels.shape[:2]
    down, across = _axis(old_height, int(height), kind), _axis(old_width, int(width), kind)
    alpha = pixels[..., 3:]
    if (alpha == 1.0).all():
        opaque = np.ones((int(height), int(width), 4), dtype=np.float32)
        opaque[..., :3] = filtered(pixels[..., :3], down, across)
        return opaque
    weighted = np.concatenate([pixels[..., :3].astype(np.float64) * alpha, alpha], axis=2)
    return straight(filtered(weighted, down, across)).astype(np.float32)


def _axis(n_old: int, n_new: int, kind: Reconstruction) -> Taps:
    step = n_old / n_new
    centres = (np.arange(n_new, dtype=np.float64) + 0.5) * step - 0.5
    return taps(centres, n_old, kind, max(1.0, step))
