"""Primitive assembly: triangles of vertices to triangles on the screen, clipped, culled, snapped to the subpixel grid."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import floor
from ..tables.layouts import ORTHOGRAPHIC
from .clip import clip_polygon, inside_all
from .layouts import SUBPIXELS
from .plane_clip import clip_triangle_to_planes

__all__ = ["assemble_triangles", "bin_triangles", "count_bins", "screen_plane"]

f32, f64, i32 = np.float32, np.float64, np.int32
_HALF = f32(0.5)
_GRID = f32(SUBPIXELS)


@kernel
def _outside_picture(a, b, c, width: np.float32, height: np.float32) -> bool:
    """Whether all three vertices lie beyond the same side of the picture."""
    if a[0] < -a[3] and b[0] < -b[3] and c[0] < -c[3]:
        return True
    if a[1] < -a[3] and b[1] < -b[3] and c[1] < -c[3]:
        return True
    if a[0] > width * a[3] and b[0] > width * b[3] and c[0] > width * c[3]:
        return True
    return a[1] > height * a[3] and b[1] > height * b[3] and c[1] > height * c[3]


@kernel
def _snap(numerator: np.float32, w: np.float32) -> int:
    """The homogeneous divide, rounded to the subpixel grid."""
    return int(floor(numerator / w * _GRID + _HALF))


@kernel
def screen_plane(a, b, c, ra: np.float64, rb: np.float64, rc: np.float64, x_reference: int, y_reference: int):
    """(is one, z, dz/dx, dz/dy): what has the values r_i w_i at three homogeneous raster vertices, as a function of the screen.

    The solution of ``z w_i + dzdx x_i + dzdy y_i = r_i`` with x_i, y_i homogeneous and relative to the reference pixel. Float64: the
    system is badly conditioned for thin triangles.
    """
    wa, wb, wc = f64(a[3]), f64(b[3]), f64(c[3])
    xr, yr = f64(x_reference), f64(y_reference)
    xa, xb, xc = f64(a[0]) - xr * wa, f64(b[0]) - xr * wb, f64(c[0]) - xr * wc
    ya, yb, yc = f64(a[1]) - yr * wa, f64(b[1]) - yr * wb, f64(c[1]) - yr * wc
    bc, ca, ab = yb * wc - yc * wb, yc * wa - ya * wc, ya * wb - yb * wa
    det = xa * bc + xb * ca + xc * ab
    if det == f64(0.0):
        return False, f64(0.0), f64(0.0), f64(0.0)
    dzdx = (ra * bc + rb * ca + rc * ab) / det
    dzdy = (ra * (wb * xc - wc * xb) + rb * (wc * xa - wa * xc) + rc * (wa * xb - wb * xa)) / det
    z = (ra * (xb * yc - xc * yb) + rb * (xc * ya - xa * yc) + rc * (xa * yb - xb * ya)) / det
    return True, z, dzdx, dzdy


@kernel
def _depth_plane(a, b, c, x_reference: int, y_reference: int, camera):
    """(is one, z, dz/dx, dz/dy) of the depth-buffer value at the reference pixel.

    Near/depth (perspective), or the part of the way back from far to near (orthographic), is an affine function of the screen.
    """
    near, far = f64(camera["near"]), f64(camera["far"])
    ra, rb, rc = near, near, near
    if camera["kind"] == ORTHOGRAPHIC:
        ra, rb, rc = far - f64(a[2]), far - f64(b[2]), far - f64(c[2])
        scale = f64(1.0) / (far - near)
        ra, rb, rc = ra * scale, rb * scale, rc * scale
    fits, z, dzdx, dzdy = screen_plane(a, b, c, ra, rb, rc, x_reference, y_reference)
    return fits, f32(z), f32(dzdx), f32(dzdy)


@kernel
def _emit(screen, place, limit, x0, y0, x1, y1, x2, y2, corners, camera, facing, double_sided):
    """Write a screen triangle, counter-clockwise. Returns 1 if it is one: not empty, not culled."""
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if area == 0 or (not double_sided and (area > 0) != (facing > 0)):
        return 0
    if area < 0:
        x1, y1, x2, y2 = x2, y2, x1, y1
    x_low, x_high = min(x0, min(x1, x2)), max(x0, max(x1, x2))
    y_low, y_high = min(y0, min(y1, y2)), max(y0, max(y1, y2))
    # Within the picture: far outside, where large triangles have their middle, float32 would leave nothing of the depth inside.
    xr = min(max((x_low + x_high) // (2 * SUBPIXELS), 0), np.int64(camera["width"]))
    yr = min(max((y_low + y_high) // (2 * SUBPIXELS), 0), np.int64(camera["height"]))
    a, b, c = corners
    fits, z, dzdx, dzdy = _depth_plane(a, b, c, xr, yr, camera)
    if not fits:
        return 0
    if place < limit:
        row = screen[place]
        row["x"][0], row["x"][1], row["x"][2] = x0, x1, x2
        row["y"][0], row["y"][1], row["y"][2] = y0, y1, y2
        row["low"][0], row["low"][1], row["high"][0], row["high"][1] = x_low, y_low, x_high, y_high
        row["z"], row["dzdx"], row["dzdy"] = z, dzdx, dzdy
        row["x_reference"], row["y_reference"] = xr, yr
        row["first_cut"], row["n_cuts"] = 0, 0
    return 1


@kernel
def _corner(vertices, row: int):
    return vertices[row, 0], vertices[row, 1], vertices[row, 2], vertices[row, 3]


@kernel
def _is_number(v) -> bool:
    """Whether no coordinate is NaN or infinite."""
    total = (v[0] - v[0]) + (v[1] - v[1]) + (v[2] - v[2]) + (v[3] - v[3])
    return total == f32(0.0)


@kernel
def _clip_in_world(polygon, world, scratch, corners, objects, instance, raster_from_object, planes) -> int:
    """Clip a triangle in world space, then transform what is left to `polygon` (k, 4). Returns its number of vertices.

    `objects` are the three object-space points, `raster_from_object` the instance's (4, 4). Vertices that are left keep their bits.
    """
    m = instance["world_from_object"]
    for i in range(3):
        x, y, z = objects[i]
        for c in range(3):
            world[i, c] = f64(m[c, 0]) * x + f64(m[c, 1]) * y + f64(m[c, 2]) * z + f64(m[c, 3])
            world[i, 3 + c] = f64(1.0) if i == c else f64(0.0)
    n = clip_triangle_to_planes(world, scratch, planes)
    (xa, ya, za), (xb, yb, zb), (xc, yc, zc) = objects
    for i in range(n):
        b0, b1, b2 = world[i, 3], world[i, 4], world[i, 5]
        x, y, z = b0 * xa + b1 * xb + b2 * xc, b0 * ya + b1 * yb + b2 * yc, b0 * za + b1 * zb + b2 * zc
        for c in range(4):
            r = raster_from_object[c]
            polygon[i, c] = f32(f64(r[0]) * x + f64(r[1]) * y + f64(r[2]) * z + f64(r[3]))
            for corner in range(3):
                if world[i, 3 + corner] == f64(1.0):
                    polygon[i, c] = corners[corner][c]
        if polygon[i, 3] <= f32(0.0):
            return 0
    return n


@kernel
def _object_point(positions, row: int):
    return f64(positions[row, 0]), f64(positions[row, 1]), f64(positions[row, 2])


@kernel
def assemble_triangles(
    instances, meshes, positions, triangles, slots, materials, camera_table, raster_from_object, vertices, clip_planes, jobs, first_job,
    last_job, polygon, scratch, world, world_scratch, screen, first_place, limit, counts, chunk,
):  # fmt: skip
    """Fill `screen` from `first_place` up to `limit` with the triangles of some jobs; counts[chunk] is how many there are in all.

    A job is (instance, first, last, place): a range of its mesh's triangles, and where its vertices begin. clip_planes (n, 4): clip to
    these in world space (FoCG 8.1.4); none: clip in homogeneous coordinates (FoCG 8.1.5).
    """
    in_world = clip_planes.shape[0] > 0
    camera = camera_table[0]
    width, height, near = f32(camera["width"]), f32(camera["height"]), camera["near"]
    place = first_place
    for k in range(first_job, last_job):
        instance, start = jobs[k, 0], jobs[k, 3]
        mesh = meshes[instances[instance]["mesh"]]
        facing = -1 if instances[instance]["flipped"] != 0 else 1
        for t in range(jobs[k, 1], jobs[k, 2]):
            row = mesh["triangle"] + t
            a = _corner(vertices, start + triangles[row, 0])
            b = _corner(vertices, start + triangles[row, 1])
            c = _corner(vertices, start + triangles[row, 2])
            if not (_is_number(a) and _is_number(b) and _is_number(c)) or (not in_world and _outside_picture(a, b, c, width, height)):
                continue
            material = instances[instance]["material"]
            if mesh["slot"] >= 0:
                material = material + slots[mesh["slot"] + t]
            double_sided = materials[material]["double_sided"] != 0
            before = place
            if not in_world and inside_all(a, near) and inside_all(b, near) and inside_all(c, near):
                x0, y0 = _snap(a[0], a[3]), _snap(a[1], a[3])
                x1, y1 = _snap(b[0], b[3]), _snap(b[1], b[3])
                x2, y2 = _snap(c[0], c[3]), _snap(c[1], c[3])
                place += _emit(screen, place, limit, x0, y0, x1, y1, x2, y2, (a, b, c), camera, facing, double_sided)
            else:
                if in_world:
                    p = mesh["position"]
                    oa = _object_point(positions, p + triangles[row, 0])
                    ob = _object_point(positions, p + triangles[row, 1])
                    oc = _object_point(positions, p + triangles[row, 2])
                    to_raster = raster_from_object[instance]
                    n = _clip_in_world(polygon, world, world_scratch, (a, b, c), (oa, ob, oc), instances[instance], to_raster, clip_planes)
                else:
                    for i in range(4):
                        polygon[0, i], polygon[1, i], polygon[2, i] = a[i], b[i], c[i]
                    n = clip_polygon(polygon, scratch, near)
                for i in range(1, n - 1):
                    x0, y0 = _snap(polygon[0, 0], polygon[0, 3]), _snap(polygon[0, 1], polygon[0, 3])
                    x1, y1 = _snap(polygon[i, 0], polygon[i, 3]), _snap(polygon[i, 1], polygon[i, 3])
                    x2, y2 = _snap(polygon[i + 1, 0], polygon[i + 1, 3]), _snap(polygon[i + 1, 1], polygon[i + 1, 3])
                    place += _emit(screen, place, limit, x0, y0, x1, y1, x2, y2, (a, b, c), camera, facing, double_sided)
            for i in range(before, min(place, limit)):
                screen[i]["instance"], screen[i]["triangle"] = instance, t
                screen[i]["material"], screen[i]["alpha_mode"] = material, materials[material]["alpha_mode"]
    counts[chunk] = place - first_place


@kernel
def _tile_range(screen_triangle, tile_size, columns, rows):
    """(first column, last, first row, last) of the tiles whose samples a triangle may cover."""
    half = SUBPIXELS // 2
    low, high = screen_triangle["low"], screen_triangle["high"]
    side = tile_size * SUBPIXELS
    # A pixel's samples reach half a pixel around its centre.
    c0 = max(0, (low[0] - half) // side)
    c1 = min(columns - 1, (high[0] + half) // side)
    r0 = max(0, (low[1] - half) // side)
    r1 = min(rows - 1, (high[1] + half) // side)
    return c0, c1, r0, r1


@kernel
def count_bins(screen, first, last, tile_size, columns, rows, bin_counts, chunk):
    """Count for each tile the triangles of one chunk that may touch it: bin_counts (chunks, tiles)."""
    for k in range(first, last):
        c0, c1, r0, r1 = _tile_range(screen[k], tile_size, columns, rows)
        for r in range(r0, r1 + 1):
            for c in range(c0, c1 + 1):
                bin_counts[chunk, r * columns + c] += 1


@kernel
def bin_triangles(screen, first, last, tile_size, columns, rows, bin_places, chunk, binned):
    """Write one chunk's triangles into the tiles' lists, in order; bin_places (chunks, tiles) moves on."""
    for k in range(first, last):
        c0, c1, r0, r1 = _tile_range(screen[k], tile_size, columns, rows)
        for r in range(r0, r1 + 1):
            for c in range(c0, c1 + 1):
                tile = r * columns + c
                binned[bin_places[chunk, tile]] = k
                bin_places[chunk, tile] += 1
