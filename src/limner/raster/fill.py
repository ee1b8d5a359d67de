"""Rasterisation with depth (FoCG 8.1.2, 8.2.3): which triangle does each sample of a tile see?

A sample is inside where the three edge functions are not negative. They are integers on the subpixel grid, so they are exact, and
a sample on an edge belongs to the triangle on whose left or top that edge lies: two triangles that share an edge draw each pixel of
it once. The depth buffer holds near/depth, greater is nearer; the first triangle drawn wins a tie.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ZERO
from ..shading.bsdf import alpha_at
from ..shading.visible import visible_point
from ..tables.layouts import BLEND, MASK
from .layouts import SUBPIXELS

__all__ = ["fill_opaque", "fill_transparent", "vertices_of"]

f32, f64, i64 = np.float32, np.float64, np.int64
_GRID_STEP = f32(1.0 / SUBPIXELS)


@kernel
def _edge(xa: int, ya: int, xb: int, yb: int, x: int, y: int) -> int:
    """The edge function of a -> b at (x, y), less 1 where points on the edge belong to the neighbour."""
    dx, dy = i64(xb) - i64(xa), i64(yb) - i64(ya)
    value = dx * (i64(y) - i64(ya)) - dy * (i64(x) - i64(xa))
    owns_edge = dy < 0 or (dy == 0 and dx < 0)
    return value if owns_edge else value - 1


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
def _covers(screen_triangle, x: np.float32, y: np.float32, camera, scene, frame) -> bool:
    """The alpha test of a masked material at raster point (x, y)."""
    instances, meshes, _, triangles, _, _, materials, _, textures, texels = scene
    vertices, first_vertex, _ = frame
    v0, v1, v2 = vertices_of(screen_triangle, instances, meshes, triangles, vertices, first_vertex)
    instance, triangle = np.int64(screen_triangle["instance"]), np.int64(screen_triangle["triangle"])
    point = visible_point(scene, camera, instance, triangle, v0, v1, v2, x, y)
    return alpha_at(materials[point.material], point, textures, texels) > ZERO


@kernel
def _bounds(screen_triangle, window, ox: int, oy: int):
    """The pixels of a window (first column, first row, columns, rows) whose samples lie in the triangle's box."""
    low, high = screen_triangle["low"], screen_triangle["high"]
    i0 = max(window[0], (low[0] - ox + SUBPIXELS - 1) // SUBPIXELS)
    i1 = min(window[0] + window[2], (high[0] - ox) // SUBPIXELS + 1)
    j0 = max(window[1], (low[1] - oy + SUBPIXELS - 1) // SUBPIXELS)
    j1 = min(window[1] + window[3], (high[1] - oy) // SUBPIXELS + 1)
    return i0, i1, j0, j1


@kernel
def _between_cuts(screen_triangle, cuts, j: int, ox: int, oy: int, i0: int, i1: int):
    """The part of columns i0..i1 of row j that lies within a screen triangle's cuts.

    A cut is crossed once along a row, and its two sides find the same column by the same numbers: no sample is lost or drawn twice.
    """
    x = f64(ox) * f64(_GRID_STEP) - f64(screen_triangle["x_reference"])
    y = f64(oy) * f64(_GRID_STEP) + f64(j - screen_triangle["y_reference"])
    start = i64(screen_triangle["first_cut"])
    for k in range(start, start + i64(screen_triangle["n_cuts"])):
        cut = cuts[k]
        value = cut["value"] + cut["slope_y"] * y
        slope = cut["slope_x"]
        keep_positive = cut["side"] > 0
        if slope == f64(0.0):
            if (value >= f64(0.0)) != keep_positive:
                return i0, i0
            continue
        # From this column on the sign is that of the slope.
        crossing = min(max(-value / slope - x, f64(i0)), f64(i1))
        column = int(crossing)
        column += 1 if crossing > f64(column) else 0
        if (slope > f64(0.0)) == keep_positive:
            i0 = max(i0, column)
        else:
            i1 = min(i1, column)
        if i0 >= i1:
            return i0, i0
    return i0, i1


@kernel
def fill_opaque(screen, binned, first, last, window, ox, oy, camera, scene, frame, depth, seen, offset):
    """Draw a tile's opaque and masked triangles into its depth buffer and `seen`, the row of the screen triangle or -1.

    (ox, oy) is the sample's place in its pixel, on the subpixel grid; `seen` is filled from `offset` on.
    """
    _, _, cuts = frame
    for k in range(first, last):
        t = screen[binned[k]]
        if t["alpha_mode"] == BLEND:
            continue
        x, y = t["x"], t["y"]
        first_i, last_i, j0, j1 = _bounds(t, window, ox, oy)
        i0, i1 = first_i, last_i
        xs = i0 * SUBPIXELS + ox
        y0, y1, y2 = i64(y[0]), i64(y[1]), i64(y[2])
        step0, step1, step2 = (y1 - y2) * SUBPIXELS, (y2 - y0) * SUBPIXELS, (y0 - y1) * SUBPIXELS
        fx, fy = f32(ox) * _GRID_STEP, f32(oy) * _GRID_STEP
        for j in range(j0, j1):
            ys = j * SUBPIXELS + oy
            if t["n_cuts"] > 0:
                i0, i1 = _between_cuts(t, cuts, j, ox, oy, first_i, last_i)
                xs = i0 * SUBPIXELS + ox
            e0 = _edge(x[1], y[1], x[2], y[2], xs, ys)
            e1 = _edge(x[2], y[2], x[0], y[0], xs, ys)
            e2 = _edge(x[0], y[0], x[1], y[1], xs, ys)
            zy = t["z"] + t["dzdy"] * (f32(j - t["y_reference"]) + fy)
            place = (j - window[1]) * window[2] - window[0]
            entered = False
            for i in range(i0, i1):
                if (e0 | e1 | e2) >= 0:
                    entered = True
                    z = zy + t["dzdx"] * (f32(i - t["x_reference"]) + fx)
                    if z > depth[place + i] and (t["alpha_mode"] != MASK or _covers(t, f32(i) + fx, f32(j) + fy, camera, scene, frame)):
                        depth[place + i] = z
                        seen[offset + place + i] = binned[k]
                elif entered:
                    break  # a triangle is convex: its row has one run
                e0 += step0
                e1 += step1
                e2 += step2


@kernel
def fill_transparent(screen, binned, first, last, window, ox, oy, frame, depth, last_depth, last_seen, next_depth, next_seen):
    """One layer of depth peeling: for each sample the nearest blended triangle behind the last one and before what is opaque.

    Ties in depth are broken by the order of drawing. Returns whether any sample found one.
    **Source**: Everitt, *Interactive order-independent transparency*, 2001; exact, in memory that does not grow with the layers.
    """
    _, _, cuts = frame
    found = False
    for k in range(first, last):
        t = screen[binned[k]]
        if t["alpha_mode"] != BLEND:
            continue
        x, y = t["x"], t["y"]
        first_i, last_i, j0, j1 = _bounds(t, window, ox, oy)
        i0, i1 = first_i, last_i
        fx, fy = f32(ox) * _GRID_STEP, f32(oy) * _GRID_STEP
        for j in range(j0, j1):
            ys = j * SUBPIXELS + oy
            zy = t["z"] + t["dzdy"] * (f32(j - t["y_reference"]) + fy)
            place = (j - window[1]) * window[2] - window[0]
            if t["n_cuts"] > 0:
                i0, i1 = _between_cuts(t, cuts, j, ox, oy, first_i, last_i)
            for i in range(i0, i1):
                xs = i * SUBPIXELS + ox
                e0 = _edge(x[1], y[1], x[2], y[2], xs, ys)
                e1 = _edge(x[2], y[2], x[0], y[0], xs, ys)
                e2 = _edge(x[0], y[0], x[1], y[1], xs, ys)
                if (e0 | e1 | e2) < 0:
                    continue
                z = zy + t["dzdx"] * (f32(i - t["x_reference"]) + fx)
                p = place + i
                behind = z < last_depth[p] or (z == last_depth[p] and binned[k] > last_seen[p])
                if z > depth[p] and behind and z > next_depth[p]:
                    next_depth[p], next_seen[p] = z, binned[k]
                    found = True
    return found
