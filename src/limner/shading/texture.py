"""Texture lookup (FoCG 11.3): nearest, bilinear, trilinear in mipmaps; texels are bytes, sRGB decoded by table."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..color.decode_table import SRGB_DECODE
from ..kernel.elementary import floor, log2
from ..kernel.vec import ONE, ZERO, Color
from ..tables.layouts import CLAMP, MIRROR, NEAREST, REPEAT, TRILINEAR
from .surface import SurfacePoint

__all__ = ["sample_texture"]

f32 = np.float32
_HALF, _TWO = f32(0.5), f32(2.0)
_TO_UNIT = f32(1.0 / 255.0)
_LIMIT = f32(16777216.0)  # beyond it a float32 has no fraction left


@kernel
def _fold(x: np.float32, wrap: int) -> np.float32:
    """Bring a texture coordinate into [0, 1] as the wrap mode says; NaN gives 0."""
    x = min(max(x, -_LIMIT), _LIMIT)
    x = x if x == x else ZERO
    if wrap == CLAMP:
        return min(max(x, ZERO), ONE)
    if wrap == MIRROR:
        half = x * _HALF
        back = (half - floor(half)) * _TWO
        return back if back <= ONE else _TWO - back
    return x - floor(x)


@kernel
def _neighbour(i: int, n: int, wrap: int) -> int:
    """A texel index one step outside at most, as the wrap mode says (mirrored and clamped: the border texel again)."""
    if i < 0:
        return 0 if wrap != REPEAT else n - 1
    if i >= n:
        return n - 1 if wrap != REPEAT else 0
    return i


@kernel
def _texel(texels, place: int, srgb: int):
    """(Color, alpha) of one texel."""
    r, g, b = texels[place], texels[place + 1], texels[place + 2]
    alpha = f32(texels[place + 3]) * _TO_UNIT
    if srgb != 0:
        return Color(SRGB_DECODE[r], SRGB_DECODE[g], SRGB_DECODE[b]), alpha
    return Color(f32(r) * _TO_UNIT, f32(g) * _TO_UNIT, f32(b) * _TO_UNIT), alpha


@kernel
def _nearest(texture, texels, s: np.float32, t: np.float32):
    w, h = texture["width"], texture["height"]
    i = min(int(s * f32(w)), w - 1)
    j = min(int(t * f32(h)), h - 1)
    return _texel(texels, texture["level"][0] + 4 * (j * w + i), texture["srgb"])


@kernel
def _bilinear(texture, texels, level: int, s: np.float32, t: np.float32):
    """The four texels around (s, t), weighted by their nearness (FoCG 11.3.2)."""
    w, h = max(1, texture["width"] >> level), max(1, texture["height"] >> level)
    x, y = s * f32(w) - _HALF, t * f32(h) - _HALF
    fx, fy = floor(x), floor(y)
    a, b = x - fx, y - fy
    i0, j0 = int(fx), int(fy)
    i1 = _neighbour(i0 + 1, w, texture["wrap_u"])
    j1 = _neighbour(j0 + 1, h, texture["wrap_v"])
    i0 = _neighbour(i0, w, texture["wrap_u"])
    j0 = _neighbour(j0, h, texture["wrap_v"])
    start, srgb = texture["level"][level], texture["srgb"]
    c00, a00 = _texel(texels, start + 4 * (j0 * w + i0), srgb)
    c10, a10 = _texel(texels, start + 4 * (j0 * w + i1), srgb)
    c01, a01 = _texel(texels, start + 4 * (j1 * w + i0), srgb)
    c11, a11 = _texel(texels, start + 4 * (j1 * w + i1), srgb)
    lower, upper = c00 * (ONE - a) + c10 * a, c01 * (ONE - a) + c11 * a
    lower_alpha, upper_alpha = a00 * (ONE - a) + a10 * a, a01 * (ONE - a) + a11 * a
    return lower * (ONE - b) + upper * b, lower_alpha * (ONE - b) + upper_alpha * b


@kernel
def _level_of_detail(texture, dudx: np.float32, dvdx: np.float32, dudy: np.float32, dvdy: np.float32) -> np.float32:
    """log2 of the longer side of the pixel's footprint in texels (Williams 1983; OpenGL 4.6, 8.14)."""
    w, h = f32(texture["width"]), f32(texture["height"])
    along_x = dudx * dudx * w * w + dvdx * dvdx * h * h
    along_y = dudy * dudy * w * w + dvdy * dvdy * h * h
    longer = max(along_x, along_y)
    return _HALF * log2(longer) if longer > ONE else ZERO


@kernel
def sample_texture(texture, texels, point: SurfacePoint):
    """(Color, alpha) of a texture at a surface point, filtered over the pixel's footprint."""
    m, f = texture["transform"], point.footprint
    u, v = point.u, point.v
    dudx, dvdx, dudy, dvdy = f.dudx, f.dvdx, f.dudy, f.dvdy
    if texture["uv_set"] == 1:
        u, v = point.u1, point.v1
        dudx, dvdx, dudy, dvdy = f.du1dx, f.dv1dx, f.du1dy, f.dv1dy
    s = _fold(m[0, 0] * u + m[0, 1] * v + m[0, 2], texture["wrap_u"])
    t = _fold(m[1, 0] * u + m[1, 1] * v + m[1, 2], texture["wrap_v"])
    if texture["filter"] == NEAREST:
        return _nearest(texture, texels, s, t)
    if texture["filter"] != TRILINEAR:
        return _bilinear(texture, texels, 0, s, t)
    lod = _level_of_detail(
        texture,
        m[0, 0] * dudx + m[0, 1] * dvdx,
        m[1, 0] * dudx + m[1, 1] * dvdx,
        m[0, 0] * dudy + m[0, 1] * dvdy,
        m[1, 0] * dudy + m[1, 1] * dvdy,
    )
    last = texture["n_levels"] - 1
    lod = min(lod, f32(last))
    level = int(lod)
    c, alpha = _bilinear(texture, texels, level, s, t)
    b = lod - f32(level)
    if b > ZERO and level < last:
        coarse, coarse_alpha = _bilinear(texture, texels, level + 1, s, t)
        return c * (ONE - b) + coarse * b, alpha * (ONE - b) + coarse_alpha * b
    return c, alpha
