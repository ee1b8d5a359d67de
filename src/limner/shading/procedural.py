"""The value of a pattern at a place, and the colour that its ramp gives the value (FoCG 11.5).

Sharp edges are averaged over the pixel exactly, in closed form, along each axis of the pattern: a pixel's footprint is taken for a box as
wide as the footprint varies. Waves are damped as a box damps them, noise loses the octaves that are too fine.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import PI, TWO_PI, floor, sin, sqrt
from ..kernel.lanes import max, min, spread, where
from ..kernel.transform import transform_point, transform_vector
from ..kernel.vec import ONE, ZERO, Color, Vec3
from ..tables.layouts import CHECKER, GRADIENT, MARBLE, MIRROR, NOISE, REPEAT, STRIPES, TURBULENCE, WOOD
from .noise import summed_octaves

__all__ = ["filtered_checker", "filtered_stripe", "pattern_color", "pattern_value"]

f32 = np.float32
_QUARTER, _HALF, _TWO = f32(0.25), f32(0.5), f32(2.0)
_NARROW = f32(2.0**-10)


@kernel
def _wide(x: np.float32, y: np.float32) -> np.float32:
    """The width of a box that varies as two ways do that are as long as x and y."""
    return sqrt(x * x + y * y)


@kernel
def _triangle_wave(x: np.float32) -> np.float32:
    """The integral of the square wave, from 0: up to 1 and down again over a length of 2."""
    folded = x - _TWO * floor(x * _HALF)
    return ONE - abs(folded - ONE)


@outlined
def _square_wave(x: np.float32, width: np.float32) -> np.float32:
    """1 in even cells, -1 in odd ones, averaged over a box around x."""
    cell = floor(x)
    inside = x - cell
    sign = where(cell == _TWO * floor(cell * _HALF), ONE, -ONE)
    # A box narrower than a cell crosses one edge at most: the closed form of the other case would cancel.
    edge = min(inside, ONE - inside) * _TWO
    share = where(edge < width, edge / max(width, _NARROW * _NARROW), ONE)
    near = x - _TWO * floor(x * _HALF)
    far_width = max(width, ONE)
    wide = (_triangle_wave(near + _HALF * far_width) - _triangle_wave(near - _HALF * far_width)) / far_width
    return where(width <= ONE, sign * share, wide)


@kernel
def filtered_checker(p: Vec3, width: Vec3) -> np.float32:
    """How much of a box around p lies in odd cells: 1/2 - 1/2 of the product of a square wave along each axis."""
    return _HALF - _HALF * (_square_wave(p.x, width.x) * _square_wave(p.y, width.y) * _square_wave(p.z, width.z))


@kernel
def _stripe_integral(x: np.float32, share: np.float32) -> np.float32:
    """How much of [0, x] is striped: the last `share` of every unit is."""
    cell = floor(x)
    return cell * share + max(x - cell - (ONE - share), ZERO)


@kernel
def filtered_stripe(x: np.float32, width: np.float32, share: np.float32) -> np.float32:
    """How much of [x - w/2, x + w/2] is striped: of every unit the last `share`."""
    inside = x - floor(x)
    held = max(width, _NARROW)
    mean = (_stripe_integral(inside + _HALF * held, share) - _stripe_integral(inside - _HALF * held, share)) / held
    return where(width > _NARROW, mean, where(inside >= ONE - share, spread(ONE, x), ZERO))


@kernel
def pattern_value(texture, p: Vec3, dpdx: Vec3, dpdy: Vec3) -> np.float32:
    """The place on the ramp, at a place of the pattern that changes so from pixel to pixel."""
    kind = texture["kind"]
    across = Vec3(_wide(dpdx.x, dpdy.x), _wide(dpdx.y, dpdy.y), _wide(dpdx.z, dpdy.z))
    if kind == CHECKER:
        return filtered_checker(p, across)
    if kind == STRIPES:
        return filtered_stripe(p.x, across.x, texture["amount"])
    if kind == GRADIENT:
        if texture["wrap_u"] == MIRROR:
            return _triangle_wave(p.x)
        return p.x - floor(p.x) if texture["wrap_u"] == REPEAT else min(max(p.x, ZERO), ONE)
    width = max(across.x, max(across.y, across.z))
    creased = kind in (TURBULENCE, MARBLE)
    n = summed_octaves(p, width, texture["octaves"], texture["gain"], texture["lacunarity"], texture["seed"], creased)
    if kind == TURBULENCE:
        return n
    if kind == NOISE:
        return _HALF + _HALF * (n * texture["amount"])
    phase, damped = p.x, across.x
    if kind == WOOD:
        # -cos 2 pi r = sin 2 pi (r - 1/4)
        phase, damped = sqrt(p.x * p.x + p.z * p.z) - _QUARTER, _wide(across.x, across.z)
    phase = phase + texture["amount"] * n
    # A box of width w leaves sin(pi w) / (pi w) of a wave. Whole turns are taken off, for the sine knows no large angles.
    held = PI * max(damped, _NARROW)
    damping = where(damped > _NARROW, sin(held) / held, ONE)
    return _HALF + _HALF * (sin(TWO_PI * (phase - floor(phase))) * damping)


@kernel
def pattern_color(texture, p: Vec3, dpdx: Vec3, dpdy: Vec3):
    """(Color, alpha) of a procedural texture at a place, in object space or (u, v, 0), and its change from pixel to pixel."""
    m = texture["pattern_from_place"]
    value = pattern_value(texture, transform_point(m, p), transform_vector(m, dpdx), transform_vector(m, dpdy))
    # The ramp: between its stops linear, beyond the first and the last, theirs.
    stops = texture["stop_color"]
    r, g = spread(stops[0, 0], value), spread(stops[0, 1], value)
    b, alpha = spread(stops[0, 2], value), spread(stops[0, 3], value)
    for k in range(1, texture["n_stops"]):
        before = texture["stop"][k - 1]
        t = min(max((value - before) * texture["stop_rise"][k], ZERO), ONE)
        reached = value > before
        r = where(reached, stops[k - 1, 0] + t * (stops[k, 0] - stops[k - 1, 0]), r)
        g = where(reached, stops[k - 1, 1] + t * (stops[k, 1] - stops[k - 1, 1]), g)
        b = where(reached, stops[k - 1, 2] + t * (stops[k, 2] - stops[k - 1, 2]), b)
        alpha = where(reached, stops[k - 1, 3] + t * (stops[k, 3] - stops[k - 1, 3]), alpha)
    return Color(r, g, b), alpha
