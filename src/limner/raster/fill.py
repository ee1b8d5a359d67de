"""Rasterisation with depth (FoCG 8.1.2, 8.2.3): which triangle does each sample of a tile see?

A sample is inside where the three edge functions are not negative. They are integers on the subpixel grid, so they are exact, and
a sample on an edge belongs to the triangle on whose left or top that edge lies: two triangles that share an edge draw each pixel of
it once. The depth buffer holds near/depth, greater is nearer; the first triangle drawn wins a tie.

Eight samples are asked at once (Pineda, *A parallel algorithm for polygon rasterization*, 1988): one of each of eight pixels in a row, or
eight of one pixel. A `Pattern` tells which; the loops are the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.lanes import any_of, bool8, f32x8, i32x8, lane, lanes_of, load8, long8, prefetch, splat8_int, store8, to_float, where
from ..kernel.vec import ZERO
from ..shading.bsdf import alpha_at
from ..shading.visible import visible_point
from ..tables.layouts import BLEND, MASK
from .layouts import SUBPIXELS

__all__ = ["Pattern", "eight_pixels", "eight_samples", "fill_opaque", "fill_transparent", "vertices_of"]

f32, f64, i64 = np.float32, np.float64, np.int64
_GRID_STEP = f32(1.0 / SUBPIXELS)
_COUNTING = np.arange(8, dtype=np.int32)
_AHEAD = 6
_SMALL = 96 * SUBPIXELS  # the edge functions of a triangle with a box of this size fit 32 bits


class Pattern(NamedTuple):
    """Where the eight samples lie that are asked at once, relative to the centre of the first one's pixel, and where they are kept."""

    x: i32x8  # on the subpixel grid
    y: i32x8
    column: i32x8  # pixels to the right
    active: bool8
    step: int  # pixels from one eight to the next
    per_pixel: int  # samples that a pixel has in the buffers
    low: int  # the least and the greatest place of a sample relative to its own pixel's centre
    high: int


@kernel
def eight_pixels(ox: int, oy: int) -> Pattern:
    """One sample, at (ox, oy) on the subpixel grid, of each of eight neighbours."""
    column = load8(_COUNTING, 0)
    everywhere = column >= 0
    return Pattern(column * SUBPIXELS + ox, splat8_int(oy), column, everywhere, 8, 1, min(ox, oy), max(ox, oy))


@kernel
def eight_samples(places, n: int, low: int, high: int) -> Pattern:
    """n <= 8 samples of one pixel: places (16,) int32 are their x and then their y."""
    return Pattern(load8(places, 0), load8(places, 8), splat8_int(0), load8(_COUNTING, 0) < n, 1, 8, low, high)


@kernel
def vertices_of(screen_triangle, instances, meshes, triangles, vertices, first_vertex):
    """The three homogeneous raster vertices of a screen triangle's whole, unclipped triangle."""
    mesh = meshes[instances[screen_triangle["instance"]]["mesh"]]
    row = mesh["triangle"] + screen_triangle["triangle"]
    start = first_vertex[screen_triangle["instance"]]
    i0, i1, i2 = start + triangles[row, 0], start + triangles[row, 1], start + triangles[row, 2]
    return (
        (vertices[i0, 0], vertices[i0, 1], vertices[i0, 2], vertices[i0, 3]),
        (vertices[i1, 0], vertices[i1, 1], vertices[i1, 2], vertices[i1, 3]),
        (vertices[i2, 0], vertices[i2, 1], vertices[i2, 2], vertices[i2, 3]),
    )


@kernel
def _covers(screen_triangle, x: f32x8, y: f32x8, camera, scene, frame) -> bool8:
    """The alpha test of a masked material at raster points (x, y)."""
    instances, meshes, _, triangles, _, _, materials, _, textures, texels = scene
    vertices, first_vertex, _ = frame
    v0, v1, v2 = vertices_of(screen_triangle, instances, meshes, triangles, vertices, first_vertex)
    instance, triangle = np.int64(screen_triangle["instance"]), np.int64(screen_triangle["triangle"])
    point = visible_point(scene, camera, instance, triangle, v0, v1, v2, x, y)
    return alpha_at(materials[screen_triangle["material"]], point, textures, texels) > ZERO


@kernel
def _within_cuts(screen_triangle, cuts, pattern: Pattern, i: int, j: int):
    """The mask of the samples that lie within a screen triangle's cuts.

    The two sides of a cut find its sign by the same numbers: no sample is lost or drawn twice.
    """
    mask = 0
    start = i64(screen_triangle["first_cut"])
    for s in range(8):
        x = f64(lane(pattern.x, s)) * f64(_GRID_STEP) + f64(i - screen_triangle["x_reference"])
        y = f64(lane(pattern.y, s)) * f64(_GRID_STEP) + f64(j - screen_triangle["y_reference"])
        keeps = 1
        for k in range(start, start + i64(screen_triangle["n_cuts"])):
            cut = cuts[k]
            value = (cut["value"] + cut["slope_y"] * y) + cut["slope_x"] * x
            if (value >= f64(0.0)) != (cut["side"] > 0):
                keeps = 0
        mask |= keeps << s
    return mask


@kernel
def _bounds(screen_triangle, window, pattern: Pattern):
    """The pixels of a window (first column, first row, columns, rows) whose samples may lie in the triangle's box."""
    low, high = screen_triangle["low"], screen_triangle["high"]
    i0 = max(window[0], (low[0] - pattern.high + SUBPIXELS - 1) // SUBPIXELS)
    i1 = min(window[0] + window[2], (high[0] - pattern.low) // SUBPIXELS + 1)
    j0 = max(window[1], (low[1] - pattern.high + SUBPIXELS - 1) // SUBPIXELS)
    j1 = min(window[1] + window[3], (high[1] - pattern.low) // SUBPIXELS + 1)
    return i0, i1, j0, j1


@kernel
def _edge(xa: int, ya: int, xb: int, yb: int, x: int, y: int):
    """(value, dx, dy): the edge function of a -> b at (x, y), less 1 where points on the edge belong to the neighbour."""
    dx, dy = i64(xb) - i64(xa), i64(yb) - i64(ya)
    value = dx * (y - i64(ya)) - dy * (x - i64(xa))
    owns_edge = dy < 0 or (dy == 0 and dx < 0)
    return (value if owns_edge else value - 1), dx, dy


@kernel
def _nearer(triangle, row: int, z: f32x8, inside: bool8, buffers, place: int) -> bool8:
    """Which samples' depth and what they see a triangle changes: the nearest opaque one, or the next layer of the blended ones."""
    depth, _, peel = buffers
    nearer = inside & (z > load8(depth, place))
    if peel[0] != 0:
        _, last_depth, last_seen, next_depth = peel
        last_z = load8(last_depth, place)
        # Ties in depth are broken by the order of drawing.
        behind = (z < last_z) | ((z == last_z) & (load8(last_seen, place) < row))
        nearer = nearer & behind & (z > load8(next_depth, place))
    return nearer


@kernel
def _fill(t, row: int, bounds, x: i32x8, y: i32x8, pattern: Pattern, window, camera, scene, frame, buffers) -> bool:
    """Draw one triangle into the buffers. x and y are the pattern's, in as many bits as its edge functions need."""
    depth, seen, peel = buffers
    target = peel[3] if peel[0] != 0 else depth
    i0, i1, j0, j1 = bounds
    first_x, first_y = i0 * SUBPIXELS, j0 * SUBPIXELS
    tx, ty = t["x"], t["y"]
    value0, dx0, dy0 = _edge(tx[1], ty[1], tx[2], ty[2], first_x, first_y)
    value1, dx1, dy1 = _edge(tx[2], ty[2], tx[0], ty[0], first_x, first_y)
    value2, dx2, dy2 = _edge(tx[0], ty[0], tx[1], ty[1], first_x, first_y)
    start0 = y * dx0 - x * dy0 + value0
    start1 = y * dx1 - x * dy1 + value1
    start2 = y * dx2 - x * dy2 + value2
    across0, across1, across2 = -dy0 * SUBPIXELS * pattern.step, -dy1 * SUBPIXELS * pattern.step, -dy2 * SUBPIXELS * pattern.step
    up0, up1, up2 = dx0 * SUBPIXELS, dx1 * SUBPIXELS, dx2 * SUBPIXELS
    fx, fy = to_float(pattern.x - pattern.column * SUBPIXELS) * _GRID_STEP, to_float(pattern.y) * _GRID_STEP
    is_masked, n_cuts = t["alpha_mode"] == MASK, t["n_cuts"]
    z0, dzdx, dzdy, x_reference, y_reference = t["z"], t["dzdx"], t["dzdy"], i64(t["x_reference"]), i64(t["y_reference"])
    drawn = False
    for j in range(j0, j1):
        e0, e1, e2 = start0, start1, start2
        z_of_row = z0 + (fy + f32(j - y_reference)) * dzdy
        place = ((j - window[1]) * window[2] + (i0 - window[0])) * pattern.per_pixel
        i = i0
        while i < i1:
            inside = ((e0 | e1 | e2) >= 0) & (pattern.column < i1 - i) & pattern.active
            if any_of(inside):
                column = to_float(pattern.column + (i - x_reference)) + fx
                z = z_of_row + column * dzdx
                nearer = _nearer(t, row, z, inside, buffers, place)
                if n_cuts > 0 and any_of(nearer):
                    nearer = nearer & lanes_of(_within_cuts(t, frame[2], pattern, i, j))
                if is_masked and any_of(nearer):
                    at_x, at_y = to_float(pattern.column + i) + fx, fy + f32(j)
                    nearer = nearer & _covers(t, at_x, at_y, camera, scene, frame)
                if any_of(nearer):
                    store8(target, place, where(nearer, z, load8(target, place)))
                    store8(seen, place, where(nearer, splat8_int(row), load8(seen, place)))
                    drawn = True
            e0, e1, e2 = e0 + across0, e1 + across1, e2 + across2
            place += 8
            i += pattern.step
        start0, start1, start2 = start0 + up0, start1 + up1, start2 + up2
    return drawn


@kernel
def _fill_bin(screen, binned, first: int, last: int, window, pattern: Pattern, camera, scene, frame, buffers, blended: bool) -> bool:
    """Draw the blended triangles of a bin, or all others."""
    wide_x, wide_y = long8(pattern.x), long8(pattern.y)
    drawn = False
    for k in range(first, last):
        row = i64(binned[k])
        # A tile's triangles come from all over the table.
        prefetch(screen, i64(binned[min(k + _AHEAD, last - 1)]))
        t = screen[row]
        if (t["alpha_mode"] == BLEND) != blended:
            continue
        bounds = _bounds(t, window, pattern)
        if bounds[0] >= bounds[1] or bounds[2] >= bounds[3]:
            continue
        if t["high"][0] - t["low"][0] <= _SMALL and t["high"][1] - t["low"][1] <= _SMALL:
            drawn |= _fill(t, row, bounds, pattern.x, pattern.y, pattern, window, camera, scene, frame, buffers)
        else:
            drawn |= _fill(t, row, bounds, wide_x, wide_y, pattern, window, camera, scene, frame, buffers)
    return drawn


@kernel
def fill_opaque(screen, binned, first: int, last: int, window, pattern: Pattern, camera, scene, frame, depth, seen):
    """Draw a tile's opaque and masked triangles into its depth buffer and `seen`, the row of the screen triangle or -1.

    depth, seen (pixels times samples, and 8 more): rows of pixels, each with the samples that the pattern says.
    """
    _fill_bin(screen, binned, first, last, window, pattern, camera, scene, frame, (depth, seen, (0, depth, seen, depth)), False)


@kernel
def fill_transparent(
    screen, binned, first, last, window, pattern, camera, scene, frame, depth, last_depth, last_seen, next_depth, next_seen
) -> bool:
    """One layer of depth peeling: for each sample the nearest blended triangle behind the last one and before what is opaque.

    Ties in depth are broken by the order of drawing. Returns whether any sample found one.
    **Source**: Everitt, *Interactive order-independent transparency*, 2001; exact, in memory that does not grow with the layers.
    """
    buffers = (depth, next_seen, (1, last_depth, last_seen, next_depth))
    return _fill_bin(screen, binned, first, last, window, pattern, camera, scene, frame, buffers, True)
