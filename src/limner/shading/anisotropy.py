"""The footprint of a pixel in a texture, where it is longer than it is wide (FoCG 11.3.3, anisotropic mipmapping).

Towards the horizon a square pixel covers a long, thin piece of a texture. A mipmap knows squares only: one that covers the piece's
length blurs across it, one that fits its width lets the length alias. There are two ways out. Either the piece is covered by
several squares in a row (`probes_of_footprint`), or the texture is kept reduced in width and height separately, and a rectangle is
looked up (`reduction_along`).

The footprint is an ellipse: what a circle of one pixel's diameter becomes under the Jacobian J of texels by pixels. Its axes are the
singular values of J (Heckbert, *Fundamentals of Texture Mapping and Image Warping*, 1989, 3.5).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.elementary import floor, log2, sqrt
from ..kernel.lanes import max, min, where
from ..kernel.vec import ONE, ZERO

__all__ = ["MAX_PROBES", "Probes", "probes_of_footprint", "reduction_along"]

f32 = np.float32
MAX_PROBES = 16
_HALF, _LONGEST = f32(0.5), f32(MAX_PROBES)
_ROUND_ENOUGH = f32(1.0 / 16.0)  # rounding must not turn a circle into an ellipse with two probes


class Probes(NamedTuple):
    """Where to look a texture up, evenly from -1/2 to 1/2 times (du, dv) around the point, and in which mipmap level."""

    count: np.float32  # a whole number
    level: np.float32
    du: np.float32
    dv: np.float32


@kernel
def probes_of_footprint(
    dudx: np.float32, dvdx: np.float32, dudy: np.float32, dvdy: np.float32, width: np.float32, height: np.float32
) -> Probes:
    """Circles as wide as the footprint's shorter axis that cover the longer one from end to end; at most `MAX_PROBES`.

    A footprint longer than that is covered by wider circles. In a footprint shorter than a texel there is nothing to filter.

    **Source**: McCormack, Perry, Farkas and Jouppi, *Feline: Fast Elliptical Lines for Anisotropic Texture Mapping*, 1999, 3. They
    weigh the probes by a Gaussian and let them overlap by half; here they touch and weigh alike, as do all points of a box-filtered
    pixel, which takes half as many.
    """
    ux, vx, uy, vy = dudx * width, dvdx * height, dudy * width, dvdy * height
    # J J^T = [[mean + half, across], [across, mean - half]]
    uu, vv, across = ux * ux + uy * uy, vx * vx + vy * vy, ux * vx + uy * vy
    half = _HALF * (uu - vv)
    root = sqrt(half * half + across * across)
    longer_squared = _HALF * (uu + vv) + root
    minified = longer_squared > ONE  # not where it is NaN
    longer_squared = where(minified, longer_squared, ONE)
    longer = sqrt(longer_squared)
    # |det J| / longer: the difference of mean and root would cancel
    shorter = max(max(abs(ux * vy - uy * vx) / longer, longer / _LONGEST), ONE)
    ratio = longer / shorter
    is_long = minified & (ratio > ONE + _ROUND_ENOUGH)
    level = where(is_long, log2(shorter), _HALF * log2(longer_squared))
    count = where(is_long, min(_LONGEST, -floor(_ROUND_ENOUGH - ratio)), ONE)
    # the eigenvector of J J^T, from the row in which nothing cancels
    x = where(half >= ZERO, half + root, across)
    y = where(half >= ZERO, across, root - half)
    squared = x * x + y * y
    reach = (longer - shorter) / sqrt(where(squared > ZERO, squared, ONE))
    du, dv = x * reach / width, y * reach / height
    return Probes(count, level, where(is_long, du, ZERO), where(is_long, dv, ZERO))


@kernel
def reduction_along(dx: np.float32, dy: np.float32, size: np.float32) -> np.float32:
    """log2 of how many texels the footprint extends along one coordinate: the ellipse's bounding box; 0 below one texel."""
    x, y = dx * size, dy * size
    squared = x * x + y * y
    return where(squared > ONE, _HALF * log2(squared), ZERO)
