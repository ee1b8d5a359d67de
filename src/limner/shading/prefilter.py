"""The sky as rough mirrors see it: blurred once for each of a few roughnesses, and looked up by the direction of the reflection.

A rough mirror gathers light from a lobe about its reflection. Seen head on that lobe is the microfacet distribution itself, so its
average over the sky depends on one direction and the roughness, and can be made beforehand; what is left out is how the lobe stretches at
grazing angles. How much of it a surface sends on depends on the angle, the roughness and F0, and is tabulated (`albedo_table`).

**Source**: Karis, *Real shading in Unreal Engine 4*, SIGGRAPH 2013 course notes (the split sum).
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import INV_PI, TWO_PI, acos, atan2, floor
from ..kernel.lanes import any_of, at, highest, lowest, max, min, to_float, to_int, where
from ..kernel.vec import ONE, ZERO, Color, Vec3
from ..tables.layouts import BLURRED_HEIGHT, BLURRED_LEVELS, BLURRED_WIDTH
from .albedo_table import GRAZING, NODES, TOTAL

__all__ = ["blurred_radiance", "sent_on"]

f32 = np.float32
_HALF = f32(0.5)
_STEPS = f32(BLURRED_LEVELS)
_LAST = f32(NODES - 1)


@kernel
def _texel(blurred, row: int, i: int) -> Color:
    return Color(at(blurred, (row, i, 0)), at(blurred, (row, i, 1)), at(blurred, (row, i, 2)))


@kernel
def _level(blurred, level: int, x: np.float32, y: np.float32) -> Color:
    """Bilinear in one level; x in texels round the horizon, y from the bottom."""
    fx, fy = floor(x), floor(y)
    a, b = x - fx, y - fy
    i0, j0 = to_int(fx), to_int(fy)
    i1, j1 = i0 + 1, min(j0 + 1, BLURRED_HEIGHT - 1)
    i0 = where(i0 < 0, i0 + BLURRED_WIDTH, i0)
    i1 = where(i1 >= BLURRED_WIDTH, i1 - BLURRED_WIDTH, i1)
    start = level * BLURRED_HEIGHT
    j0, j1 = start + max(j0, 0), start + j1
    lower = _texel(blurred, j0, i0) * (ONE - a) + _texel(blurred, j0, i1) * a
    upper = _texel(blurred, j1, i0) * (ONE - a) + _texel(blurred, j1, i1) * a
    return lower * (ONE - b) + upper * b


@kernel
def blurred_radiance(blurred, sharp: Color, d: Vec3, roughness: np.float32, intensity: np.float32) -> Color:
    """The sky about direction d (in its own frame) as a mirror of perceptual roughness sees it.

    `sharp` is the sky itself there, with its intensity.
    """
    x = (_HALF + atan2(d.z, d.x) / TWO_PI) * f32(BLURRED_WIDTH) - _HALF
    y = (ONE - acos(d.y) * INV_PI) * f32(BLURRED_HEIGHT) - _HALF
    step = min(max(roughness, ZERO), ONE) * _STEPS
    level = min(floor(step), _STEPS - ONE)
    t = step - level
    smoother, rougher = sharp, sharp
    # Level by level, since eight pixels may look into several of them.
    for k in range(max(to_int(lowest(level)) - 1, 0), to_int(highest(level)) + 1):
        is_smoother, is_rougher = level == f32(k + 1), level == f32(k)
        if any_of(is_smoother | is_rougher):
            c = _level(blurred, k, x, y) * intensity
            smoother, rougher = where(is_smoother, c, smoother), where(is_rougher, c, rougher)
    return smoother * (ONE - t) + rougher * t


@kernel
def _between(table, i: int, j: int, a: np.float32, b: np.float32) -> np.float32:
    """Bilinear in a table, from node (i, j) on."""
    low = at(table, (i, j)) * (ONE - b) + at(table, (i, j + 1)) * b
    high = at(table, (i + 1, j)) * (ONE - b) + at(table, (i + 1, j + 1)) * b
    return low * (ONE - a) + high * a


@kernel
def _sent(n_v: np.float32, roughness: np.float32):
    """(total, grazing) of the tables."""
    x, y = min(max(roughness, ZERO), ONE) * _LAST, min(max(n_v, ZERO), ONE) * _LAST
    i, j = min(to_int(x), NODES - 2), min(to_int(y), NODES - 2)
    a, b = x - to_float(i), y - to_float(j)
    return _between(TOTAL, i, j, a, b), _between(GRAZING, i, j, a, b)


@kernel
def sent_on(f0: Color, n_v: np.float32, roughness: np.float32) -> Color:
    """The share of an even sky that the microfacet lobe sends towards the eye, by Schlick's reflectance."""
    total, grazing = _sent(n_v, roughness)
    return f0 * (total - grazing) + Color(grazing, grazing, grazing)


@kernel
def facets_share(f0: Color, f90: np.float32, n_v: np.float32, roughness: np.float32) -> Color:
    """The same with another reflectance than 1 at grazing angles."""
    total, grazing = _sent(n_v, roughness)
    edge = grazing * f90
    return f0 * (total - grazing) + Color(edge, edge, edge)
