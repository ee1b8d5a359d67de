"""Texture lookup (FoCG 11.3): nearest, bilinear, in mipmaps and in ripmaps; texels are bytes, sRGB decoded by table, or deeper.

A pixel sees a piece of the texture. `nearest` and `bilinear` look at its middle; `trilinear` averages a square as large as the
piece is long; `anisotropic` and `ripmap` average what is seen, also where it is longer than wide (`anisotropy`).

Nearly all textures are pictures of bytes on texture coordinates, and all that is looked up in a picture's inner loop is laid out for
them. Whatever else there is (deeper texels, patterns, three pictures for three directions) stands behind one call, `sample_place`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..color.decode_table import SRGB_DECODE
from ..kernel.elementary import as_float, floor, log2, power
from ..kernel.lanes import any_of, at, four_bytes, highest, lowest, max, min, spread, to_float, to_int, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, normalize
from ..tables.layouts import (
    ANISOTROPIC,
    BILINEAR,
    BYTE_TEXELS,
    CLAMP,
    FLOAT_TEXELS,
    MIRROR,
    NEAREST,
    PICTURE,
    REPEAT,
    RIPMAP,
    TRILINEAR,
    TRIPLANAR_MAPPING,
    UV_MAPPING,
)
from .anisotropy import Probes, probes_of_footprint, reduction_along
from .procedural import pattern_color
from .surface import Detail, SurfacePoint

__all__ = ["Place", "level_of_detail", "place_in", "sample_place", "sample_texture"]

f32 = np.float32
_HALF, _TWO = f32(0.5), f32(2.0)
_TO_UNIT, _DEEP_TO_UNIT = f32(1.0 / 255.0), f32(1.0 / 65535.0)
_HAIR = f32(2.0**-18)
_LIMIT = f32(16777216.0)  # beyond it a float32 has no fraction left


@kernel
def _fold(x: np.float32, wrap: int) -> np.float32:
    """Bring a texture coordinate into [0, 1] as the wrap mode says; NaN gives 0."""
    x = where(x == x, min(max(x, -_LIMIT), _LIMIT), ZERO)
    if wrap == CLAMP:
        return min(max(x, ZERO), ONE)
    if wrap == MIRROR:
        half = x * _HALF
        back = (half - floor(half)) * _TWO
        return where(back <= ONE, back, _TWO - back)
    return x - floor(x)


@kernel
def _neighbour(i: int, n: int, wrap: int) -> int:
    """A texel index one step outside at most, as the wrap mode says (mirrored and clamped: the border texel again)."""
    if wrap == REPEAT:
        return where(i < 0, i + n, where(i >= n, i - n, i))
    return min(max(i, 0), n - 1)


@kernel
def _decoded(x: np.float32) -> np.float32:
    """Linear light of an sRGB-encoded value in [0, 1] (IEC 61966-2-1)."""
    return where(x <= f32(0.04045), x * f32(1.0 / 12.92), power((x + f32(0.055)) * f32(1.0 / 1.055), f32(2.4)))


@outlined
def _deep_texel(texels, start: int, place: int, srgb: int, depth: int):
    """(Color, alpha) of a texel of 2 or 4 bytes a channel."""
    if depth == FLOAT_TEXELS:
        r, g = as_float(four_bytes(texels, start, place * 4)), as_float(four_bytes(texels, start, place * 4 + 1))
        b, alpha = as_float(four_bytes(texels, start, place * 4 + 2)), as_float(four_bytes(texels, start, place * 4 + 3))
        return Color(r, g, b), alpha
    low, high = four_bytes(texels, start, place * 2), four_bytes(texels, start, place * 2 + 1)
    r, g = to_float(low & 65535) * _DEEP_TO_UNIT, to_float((low >> 16) & 65535) * _DEEP_TO_UNIT
    b, alpha = to_float(high & 65535) * _DEEP_TO_UNIT, to_float((high >> 16) & 65535) * _DEEP_TO_UNIT
    if srgb != 0:
        return Color(_decoded(r), _decoded(g), _decoded(b)), alpha
    return Color(r, g, b), alpha


@kernel
def _texel(texels, start: int, place: int, srgb: int):
    """(Color, alpha) of the texel `place` of a picture of bytes that begins at byte `start`."""
    word = four_bytes(texels, start, place)
    r, g, b = word & 255, (word >> 8) & 255, (word >> 16) & 255
    alpha = to_float((word >> 24) & 255) * _TO_UNIT
    if srgb != 0:
        return Color(at(SRGB_DECODE, r), at(SRGB_DECODE, g), at(SRGB_DECODE, b)), alpha
    return Color(to_float(r) * _TO_UNIT, to_float(g) * _TO_UNIT, to_float(b) * _TO_UNIT), alpha


@kernel
def _any_texel(texels, start: int, place: int, srgb: int, depth: int):
    """The same of a picture of any depth."""
    if depth != BYTE_TEXELS:
        return _deep_texel(texels, start, place, srgb, depth)
    return _texel(texels, start, place, srgb)


@kernel
def _nearest(texture, s: np.float32, t: np.float32) -> int:
    """The place of the texel in which (s, t) lies."""
    w, h = texture["width"], texture["height"]
    return min(to_int(t * f32(h)), h - 1) * w + min(to_int(s * f32(w)), w - 1)


@kernel
def _four_places(texture, w: int, h: int, s: np.float32, t: np.float32):
    """The places of the four texels around (s, t) in a picture of w x h, and how near (s, t) is to the right and the upper ones."""
    x, y = s * f32(w) - _HALF, t * f32(h) - _HALF
    fx, fy = floor(x), floor(y)
    a, b = x - fx, y - fy
    i0, j0 = to_int(fx), to_int(fy)
    i1 = _neighbour(i0 + 1, w, texture["wrap_u"])
    j1 = _neighbour(j0 + 1, h, texture["wrap_v"]) * w
    i0 = _neighbour(i0, w, texture["wrap_u"])
    j0 = _neighbour(j0, h, texture["wrap_v"]) * w
    return j0 + i0, j0 + i1, j1 + i0, j1 + i1, a, b


@kernel
def _bilinear(texture, texels, level: int, s: np.float32, t: np.float32):
    """The four texels around (s, t) in a mipmap level, weighted by their nearness (FoCG 11.3.2)."""
    w, h = max(1, texture["width"] >> level), max(1, texture["height"] >> level)
    start = texture["level"][level]
    p00, p10, p01, p11, a, b = _four_places(texture, w, h, s, t)
    srgb = texture["srgb"]
    c00, a00 = _texel(texels, start, p00, srgb)
    c10, a10 = _texel(texels, start, p10, srgb)
    c01, a01 = _texel(texels, start, p01, srgb)
    c11, a11 = _texel(texels, start, p11, srgb)
    lower, upper = c00 * (ONE - a) + c10 * a, c01 * (ONE - a) + c11 * a
    lower_alpha, upper_alpha = a00 * (ONE - a) + a10 * a, a01 * (ONE - a) + a11 * a
    return lower * (ONE - b) + upper * b, lower_alpha * (ONE - b) + upper_alpha * b


@kernel
def _steady(texture, texels, depth: int, start: int, w: int, h: int, s: np.float32, t: np.float32):
    """The same mean written as p + (q - p) a, which is p to the bit where p = q: sums of many lookups stay what they were."""
    p00, p10, p01, p11, a, b = _four_places(texture, w, h, s, t)
    srgb = texture["srgb"]
    c00, a00 = _any_texel(texels, start, p00, srgb, depth)
    c10, a10 = _any_texel(texels, start, p10, srgb, depth)
    c01, a01 = _any_texel(texels, start, p01, srgb, depth)
    c11, a11 = _any_texel(texels, start, p11, srgb, depth)
    lower, upper = c00 + (c10 - c00) * a, c01 + (c11 - c01) * a
    lower_alpha, upper_alpha = a00 + (a10 - a00) * a, a01 + (a11 - a01) * a
    return lower + (upper - lower) * b, lower_alpha + (upper_alpha - lower_alpha) * b


@kernel
def level_of_detail(texture, dudx: np.float32, dvdx: np.float32, dudy: np.float32, dvdy: np.float32) -> np.float32:
    """log2 of the longer side of the pixel's footprint in texels (Williams 1983; OpenGL 4.6, 8.14)."""
    w, h = f32(texture["width"]), f32(texture["height"])
    along_x = dudx * dudx * w * w + dvdx * dvdx * h * h
    along_y = dudy * dudy * w * w + dvdy * dvdy * h * h
    longer = max(along_x, along_y)
    return where(longer > ONE, _HALF * log2(longer), ZERO)


@kernel
def _trilinear(texture, texels, lod: np.float32, s: np.float32, t: np.float32):
    """Bilinear in the two mipmap levels around `lod`, mixed."""
    last = texture["n_levels"] - 1
    lod = min(lod, f32(last))
    level = floor(lod)
    b = lod - level
    fine_alpha, coarse_alpha = spread(ZERO, s), spread(ZERO, s)
    fine, coarse = Color(fine_alpha, fine_alpha, fine_alpha), Color(fine_alpha, fine_alpha, fine_alpha)
    # Level by level, since eight pixels may look into several of them.
    for k in range(to_int(lowest(level)), min(to_int(highest(level)) + 1, last) + 1):
        is_fine, is_coarse = level == f32(k), (level == f32(k - 1)) & (b > ZERO)
        if any_of(is_fine | is_coarse):
            c, alpha = _bilinear(texture, texels, k, s, t)
            fine, fine_alpha = where(is_fine, c, fine), where(is_fine, alpha, fine_alpha)
            coarse, coarse_alpha = where(is_coarse, c, coarse), where(is_coarse, alpha, coarse_alpha)
    return fine * (ONE - b) + coarse * b, fine_alpha * (ONE - b) + coarse_alpha * b


@kernel
def _in_level(texture, texels, depth: int, level: int, s: np.float32, t: np.float32):
    w, h = max(1, texture["width"] >> level), max(1, texture["height"] >> level)
    return _steady(texture, texels, depth, texture["level"][level], w, h, s, t)


@kernel
def _in_two_levels(texture, texels, depth: int, level: np.float32, b: np.float32, last: int, s: np.float32, t: np.float32):
    """Between a level, a whole number, and the next one, as `_trilinear` does it but steadily."""
    fine_alpha, coarse_alpha = spread(ZERO, s), spread(ZERO, s)
    fine, coarse = Color(fine_alpha, fine_alpha, fine_alpha), Color(fine_alpha, fine_alpha, fine_alpha)
    for k in range(to_int(lowest(level)), min(to_int(highest(level)) + 1, last) + 1):
        is_fine, is_coarse = level == f32(k), (level == f32(k - 1)) & (b > ZERO)
        if any_of(is_fine | is_coarse):
            c, alpha = _in_level(texture, texels, depth, k, s, t)
            fine, fine_alpha = where(is_fine, c, fine), where(is_fine, alpha, fine_alpha)
            coarse, coarse_alpha = where(is_coarse, c, coarse), where(is_coarse, alpha, coarse_alpha)
    mixed, mixed_alpha = fine + (coarse - fine) * b, fine_alpha + (coarse_alpha - fine_alpha) * b
    return where(b > ZERO, mixed, fine), where(b > ZERO, mixed_alpha, fine_alpha)


@kernel
def _probes(texture, u: np.float32, change) -> Probes:
    """Where a filter other than a ripmap looks up what: for all but the anisotropic one, once."""
    dudx, dvdx, dudy, dvdy = change
    if texture["filter"] == ANISOTROPIC:
        return probes_of_footprint(dudx, dvdx, dudy, dvdy, f32(texture["width"]), f32(texture["height"]))
    one, zero = spread(ONE, u), spread(ZERO, u)
    if texture["filter"] == TRILINEAR:
        return Probes(one, level_of_detail(texture, dudx, dvdx, dudy, dvdy), zero, zero)
    return Probes(one, zero, zero, zero)


@kernel
def _anisotropic(texture, texels, depth: int, u: np.float32, v: np.float32, probes: Probes):
    """The mean of trilinear lookups along the longer axis of the pixel's footprint; (u, v) is not yet folded."""
    last = texture["n_levels"] - 1
    lod = min(probes.level, f32(last))
    level = floor(lod)
    b = lod - level
    inverse = ONE / max(ONE, probes.count - ONE)
    first_alpha, more_alpha = spread(ZERO, u), spread(ZERO, u)
    first, more = Color(first_alpha, first_alpha, first_alpha), Color(first_alpha, first_alpha, first_alpha)
    for k in range(to_int(highest(probes.count))):
        place = f32(k) * inverse - _HALF
        s = _fold(u + probes.du * place, texture["wrap_u"])
        t = _fold(v + probes.dv * place, texture["wrap_v"])
        c, alpha = _in_two_levels(texture, texels, depth, level, b, last, s, t)
        if k == 0:
            first, first_alpha = c, alpha
        counts = f32(k) < probes.count
        more, more_alpha = where(counts, more + (c - first), more), where(counts, more_alpha + (alpha - first_alpha), more_alpha)
    share = ONE / probes.count
    return first + more * share, first_alpha + more_alpha * share


@kernel
def _in_copy(texture, texels, depth: int, column: int, row: int, s: np.float32, t: np.float32):
    """Bilinear in the copy of a ripmap that is reduced `column` times in width and `row` times in height."""
    w, h = max(1, texture["width"] >> column), max(1, texture["height"] >> row)
    whole_row = texture["widths"][texture["n_columns"]]
    texel_bytes = 4 << texture["format"]
    start = texture["level"][0] + texel_bytes * (texture["heights"][row] * whole_row + h * texture["widths"][column])
    return _steady(texture, texels, depth, start, w, h, s, t)


@kernel
def _in_row(texture, texels, depth: int, column: np.float32, a: np.float32, row: int, s: np.float32, t: np.float32):
    """Two neighbours of a ripmap's row of copies, mixed."""
    last = texture["n_columns"] - 1
    wide_alpha, narrow_alpha = spread(ZERO, s), spread(ZERO, s)
    wide, narrow = Color(wide_alpha, wide_alpha, wide_alpha), Color(wide_alpha, wide_alpha, wide_alpha)
    for k in range(to_int(lowest(column)), min(to_int(highest(column)) + 1, last) + 1):
        is_wide, is_narrow = column == f32(k), (column == f32(k - 1)) & (a > ZERO)
        if any_of(is_wide | is_narrow):
            c, alpha = _in_copy(texture, texels, depth, k, row, s, t)
            wide, wide_alpha = where(is_wide, c, wide), where(is_wide, alpha, wide_alpha)
            narrow, narrow_alpha = where(is_narrow, c, narrow), where(is_narrow, alpha, narrow_alpha)
    mixed, mixed_alpha = wide + (narrow - wide) * a, wide_alpha + (narrow_alpha - wide_alpha) * a
    return where(a > ZERO, mixed, wide), where(a > ZERO, mixed_alpha, wide_alpha)


@kernel
def _ripmap(texture, texels, depth: int, s: np.float32, t: np.float32, change):
    """Bilinear in each of the four copies around the footprint's extents along u and v, and bilinear among these (FoCG 11.3.3)."""
    dudx, dvdx, dudy, dvdy = change
    last = texture["n_rows"] - 1
    across = min(reduction_along(dudx, dudy, f32(texture["width"])), f32(texture["n_columns"] - 1))
    up = min(reduction_along(dvdx, dvdy, f32(texture["height"])), f32(last))
    column, row = floor(across), floor(up)
    a, b = across - column, up - row
    high_alpha, low_alpha = spread(ZERO, s), spread(ZERO, s)
    high, low = Color(high_alpha, high_alpha, high_alpha), Color(high_alpha, high_alpha, high_alpha)
    for k in range(to_int(lowest(row)), min(to_int(highest(row)) + 1, last) + 1):
        is_high, is_low = row == f32(k), (row == f32(k - 1)) & (b > ZERO)
        if any_of(is_high | is_low):
            c, alpha = _in_row(texture, texels, depth, column, a, k, s, t)
            high, high_alpha = where(is_high, c, high), where(is_high, alpha, high_alpha)
            low, low_alpha = where(is_low, c, low), where(is_low, alpha, low_alpha)
    mixed, mixed_alpha = high + (low - high) * b, high_alpha + (low_alpha - high_alpha) * b
    return where(b > ZERO, mixed, high), where(b > ZERO, mixed_alpha, high_alpha)


class Place(NamedTuple):
    """Where a texture is looked up: texture coordinates with their change from pixel to pixel, and the place on the object."""

    u: np.float32
    v: np.float32
    dudx: np.float32
    dvdx: np.float32
    dudy: np.float32
    dvdy: np.float32
    detail: Detail


@kernel
def place_in(texture, point: SurfacePoint) -> Place:
    """The place that a texture is asked for at a surface point."""
    f = point.footprint
    if texture["uv_set"] == 1:
        return Place(point.u1, point.v1, f.du1dx, f.dv1dx, f.du1dy, f.dv1dy, point.detail)
    return Place(point.u, point.v, f.dudx, f.dvdx, f.dudy, f.dvdy, point.detail)


@kernel
def sample_texture(texture, texels, point: SurfacePoint):
    """(Color, alpha) of a texture at a surface point, filtered over the pixel's footprint."""
    if texture["seldom"] != 0:
        return sample_place(texture, texels, place_in(texture, point))
    f = point.footprint
    u, v = point.u, point.v
    dudx, dvdx, dudy, dvdy = f.dudx, f.dvdx, f.dudy, f.dvdy
    if texture["uv_set"] == 1:
        u, v = point.u1, point.v1
        dudx, dvdx, dudy, dvdy = f.du1dx, f.dv1dx, f.du1dy, f.dv1dy
    m = texture["transform"]
    u, v = m[0, 0] * u + m[0, 1] * v + m[0, 2], m[1, 0] * u + m[1, 1] * v + m[1, 2]
    s, t = _fold(u, texture["wrap_u"]), _fold(v, texture["wrap_v"])
    filter_ = texture["filter"]
    if filter_ == NEAREST:
        return _texel(texels, texture["level"][0], _nearest(texture, s, t), texture["srgb"])
    if filter_ == BILINEAR:
        return _bilinear(texture, texels, 0, s, t)
    dudx, dvdx = m[0, 0] * dudx + m[0, 1] * dvdx, m[1, 0] * dudx + m[1, 1] * dvdx
    dudy, dvdy = m[0, 0] * dudy + m[0, 1] * dvdy, m[1, 0] * dudy + m[1, 1] * dvdy
    return _trilinear(texture, texels, level_of_detail(texture, dudx, dvdx, dudy, dvdy), s, t)


# --- what is seldom asked for ---------------------------------------------------------------------------------------------


@kernel
def _picture(texture, texels, u: np.float32, v: np.float32, change):
    """(Color, alpha) of a picture of any depth by any filter."""
    m, depth = texture["transform"], np.int64(texture["format"])
    dudx, dvdx, dudy, dvdy = change
    u, v = m[0, 0] * u + m[0, 1] * v + m[0, 2], m[1, 0] * u + m[1, 1] * v + m[1, 2]
    s, t = _fold(u, texture["wrap_u"]), _fold(v, texture["wrap_v"])
    if texture["filter"] == NEAREST:
        return _any_texel(texels, texture["level"][0], _nearest(texture, s, t), texture["srgb"], depth)
    dudx, dvdx = m[0, 0] * dudx + m[0, 1] * dvdx, m[1, 0] * dudx + m[1, 1] * dvdx
    dudy, dvdy = m[0, 0] * dudy + m[0, 1] * dvdy, m[1, 0] * dudy + m[1, 1] * dvdy
    if texture["filter"] == RIPMAP:
        return _ripmap(texture, texels, depth, s, t, (dudx, dvdx, dudy, dvdy))
    return _anisotropic(texture, texels, depth, u, v, _probes(texture, u, (dudx, dvdx, dudy, dvdy)))


@kernel
def _facing(axis: int, towards: np.float32, v: Vec3):
    """The coordinates of v in the picture that looks along an axis, upright and not mirrored from where `towards` points."""
    if axis == 0:
        return where(towards < ZERO, v.z, -v.z), v.y
    if axis == 1:
        return v.x, where(towards < ZERO, v.z, -v.z)
    return where(towards < ZERO, -v.x, v.x), v.y


@outlined
def sample_place(texture, texels, place: Place):
    """(Color, alpha) of any texture at any place: at that of a surface point, or at one a little farther on."""
    d = place.detail
    if texture["kind"] != PICTURE:
        if texture["mapping"] == UV_MAPPING:
            zero = spread(ZERO, place.u)
            at_place, dx, dy = Vec3(place.u, place.v, zero), Vec3(place.dudx, place.dvdx, zero), Vec3(place.dudy, place.dvdy, zero)
            return pattern_color(texture, at_place, dx, dy)
        # A hair below the surface: a face that lies between two cells of a pattern shows the inner one, however it was rounded.
        greatest = max(abs(d.p.x), max(abs(d.p.y), abs(d.p.z)))
        return pattern_color(texture, d.p - normalize(d.n) * (greatest * _HAIR), d.dpdx, d.dpdy)
    # One picture on texture coordinates, or three along the axes of the object, each counting as much as the surface faces it.
    u, v, change = place.u, place.v, (place.dudx, place.dvdx, place.dudy, place.dvdy)
    weights, total = Vec3(spread(ONE, u), ZERO, ZERO), spread(ONE, u)
    n_lookups = 1
    if texture["mapping"] == TRIPLANAR_MAPPING:
        n, k = normalize(d.n), texture["sharpness"]
        weights = Vec3(power(abs(n.x), k), power(abs(n.y), k), power(abs(n.z), k))
        total, n_lookups = weights.x + weights.y + weights.z, 3
    inverse = ONE / where(total > ZERO, total, ONE)
    alpha = spread(ZERO, u)
    color = Color(alpha, alpha, alpha)
    for axis in range(n_lookups):
        weight = weights.x * inverse
        if n_lookups == 3:
            towards = d.n.x
            if axis == 1:
                weight, towards = weights.y * inverse, d.n.y
            if axis == 2:
                weight, towards = weights.z * inverse, d.n.z
            u, v = _facing(axis, towards, d.p)
            dudx, dvdx = _facing(axis, towards, d.dpdx)
            dudy, dvdy = _facing(axis, towards, d.dpdy)
            change = (dudx, dvdx, dudy, dvdy)
        if any_of(weight > ZERO):
            c, a = _picture(texture, texels, u, v, change)
            color, alpha = color + c * weight, alpha + a * weight
    return color, alpha
