"""Primitive assembly: triangles of vertices to triangles on the screen, clipped, culled, in order. Eight at once where none is clipped."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import as_int
from ..kernel.lanes import (
    all_of,
    any_of,
    at,
    double,
    first_set,
    i32x8,
    lane,
    load8,
    long8,
    mask_of,
    max,
    min,
    prefetch,
    single,
    splat8_int,
    spread,
    store_words,
    where,
)
from ..tables.layouts import ORTHOGRAPHIC
from .clip import clip_polygon
from .layouts import BACK_SIDE, BOTH_SIDES, HIGH_WORD, LOW_WORD, SUBPIXELS, UNSNAPPED, WORDS
from .plane_clip import clip_triangle_to_planes
from .vertex import snap

__all__ = ["assemble_triangles", "bin_triangles", "count_bins", "screen_plane"]

f32, f64, i32 = np.float32, np.float64, np.int32
_COUNTING = np.arange(8, dtype=np.int32)
_NOWHERE = 1 << 30
_AHEAD = 32


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
def screen_plane(a, b, c, ra: np.float64, rb: np.float64, rc: np.float64, x_reference: int, y_reference: int):
    """(is one, z, dz/dx, dz/dy): what has the values r_i w_i at three homogeneous raster vertices, as a function of the screen.

    Of one triangle or of eight.

    The solution of ``z w_i + dzdx x_i + dzdy y_i = r_i`` with x_i, y_i homogeneous and relative to the reference pixel. Float64: the
    system is badly conditioned for thin triangles.
    """
    wa, wb, wc = double(a[3]), double(b[3]), double(c[3])
    xr, yr = double(x_reference), double(y_reference)
    xa, xb, xc = double(a[0]) - wa * xr, double(b[0]) - wb * xr, double(c[0]) - wc * xr
    ya, yb, yc = double(a[1]) - wa * yr, double(b[1]) - wb * yr, double(c[1]) - wc * yr
    bc, ca, ab = yb * wc - yc * wb, yc * wa - ya * wc, ya * wb - yb * wa
    det = xa * bc + xb * ca + xc * ab
    fits = (det > f64(0.0)) | (det < f64(0.0))
    divisor = where(fits, det, f64(1.0))
    dzdx = (bc * ra + ca * rb + ab * rc) / divisor
    dzdy = ((wb * xc - wc * xb) * ra + (wc * xa - wa * xc) * rb + (wa * xb - wb * xa) * rc) / divisor
    z = ((xb * yc - xc * yb) * ra + (xc * ya - xa * yc) * rb + (xa * yb - xb * ya) * rc) / divisor
    return fits, z, dzdx, dzdy


@kernel
def _depth_plane(a, b, c, x_reference: int, y_reference: int, camera):
    """(is one, z, dz/dx, dz/dy) of the depth-buffer value at the reference pixel.

    Near/depth (perspective), or the part of the way back from far to near (orthographic), is an affine function of the screen.
    """
    near, far = f64(camera["near"]), f64(camera["far"])
    if camera["kind"] == ORTHOGRAPHIC:
        scale = f64(1.0) / (far - near)
        ra, rb, rc = (far - double(a[2])) * scale, (far - double(b[2])) * scale, (far - double(c[2])) * scale
    else:
        same = spread(near, a[2])
        ra, rb, rc = double(same), double(same), double(same)
    fits, z, dzdx, dzdy = screen_plane(a, b, c, ra, rb, rc, x_reference, y_reference)
    return fits, single(z), single(dzdx), single(dzdy)


@kernel
def _emit(screen, place, limit, x0, y0, x1, y1, x2, y2, corners, camera, facing, side):
    """Write a screen triangle, counter-clockwise. Returns 1 if it is one: not empty, not culled."""
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    is_front = (area > 0) == (facing > 0)
    if area == 0 or (side != BOTH_SIDES and is_front == (side == BACK_SIDE)):
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
def _assemble_one(job, t: int, geometry, frame, clip_planes, polygons, screen, place: int, limit: int, camera, sided) -> int:
    """Clip a triangle and write what is left of it from `place` on. Returns the next place."""
    instances, meshes, positions, triangles, slots, materials = geometry
    vertices, _, raster_from_object = frame
    polygon, scratch, world, world_scratch = polygons
    instance, start = job
    mesh = meshes[instances[instance]["mesh"]]
    facing = -1 if instances[instance]["flipped"] != 0 else 1
    in_world = clip_planes.shape[0] > 0
    width, height, near = f32(camera["width"]), f32(camera["height"]), camera["near"]
    row = mesh["triangle"] + t
    a = _corner(vertices, start + triangles[row, 0])
    b = _corner(vertices, start + triangles[row, 1])
    c = _corner(vertices, start + triangles[row, 2])
    if not (_is_number(a) and _is_number(b) and _is_number(c)) or (not in_world and _outside_picture(a, b, c, width, height)):
        return place
    material = instances[instance]["material"]
    if mesh["slot"] >= 0:
        material = material + slots[mesh["slot"] + t]
    side = sided[material, 0]
    before = place
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
        x0, y0 = _snapped(polygon, 0)
        x1, y1 = _snapped(polygon, i)
        x2, y2 = _snapped(polygon, i + 1)
        place += _emit(screen, place, limit, x0, y0, x1, y1, x2, y2, (a, b, c), camera, facing, side)
    for i in range(before, min(place, limit)):
        screen[i]["instance"], screen[i]["triangle"] = instance, t
        screen[i]["material"], screen[i]["alpha_mode"] = material, materials[material]["alpha_mode"]
    return place


@kernel
def _snapped(polygon, k: int):
    return np.int64(snap(polygon[k, 0], polygon[k, 3])), np.int64(snap(polygon[k, 1], polygon[k, 3]))


@kernel
def _screen_points(snapped, i0: i32x8, i1: i32x8, i2: i32x8):
    """x and y of the three corners of eight triangles, on the subpixel grid."""
    return (
        at(snapped, i0 * 2), at(snapped, i0 * 2 + 1), at(snapped, i1 * 2), at(snapped, i1 * 2 + 1), at(snapped, i2 * 2),
        at(snapped, i2 * 2 + 1),
    )  # fmt: skip


@kernel
def _samples_between(low: i32x8, high: i32x8, places, pixels: int):
    """(first, last) of the picture's columns (or rows) that may have a sample between two places."""
    return max((low - places[1] + (SUBPIXELS - 1)) >> 8, 0), min((high - places[0]) >> 8, pixels - 1)


@kernel
def _is_inside(xa: i32x8, ya: i32x8, xb: i32x8, yb: i32x8, x: i32x8, y: i32x8):
    """Whether a point lies to the left of a -> b, or on it where that edge owns its points, as in `fill`; of tiny triangles."""
    dx, dy = xb - xa, yb - ya
    value = dx * (y - ya) - dy * (x - xa)
    return (value > 0) | ((value == 0) & ((dy < 0) | ((dy == 0) & (dx < 0))))


@kernel
def _covers(points, positive, x: i32x8, y: i32x8):
    """Whether tiny triangles cover a point of the subpixel grid."""
    x0, y0, x1, y1, x2, y2 = points
    xa, ya, xb, yb = where(positive, x1, x2), where(positive, y1, y2), where(positive, x2, x1), where(positive, y2, y1)
    return _is_inside(xa, ya, xb, yb, x, y) & _is_inside(xb, yb, x0, y0, x, y) & _is_inside(x0, y0, xa, ya, x, y)


@kernel
def _is_counterclockwise(points):
    """(the doubled area is not zero, it is positive) of eight triangles."""
    x0, y0, x1, y1, x2, y2 = points
    left = long8(x1 - x0) * long8(y2 - y0)
    right = long8(x2 - x0) * long8(y1 - y0)
    return left != right, left > right


@kernel
def _emit_eight(queue, n: int, job, geometry, frame, screen, words, place: int, limit: int, camera, sided) -> int:
    """Write the n <= 8 triangles in the queue, none of which has to be clipped. Returns the next place; there must be room for eight."""
    instances, meshes, _, triangles, slots, _ = geometry
    vertices, snapped, _ = frame
    instance, start = job
    mesh = meshes[instances[instance]["mesh"]]
    counting = min(load8(_COUNTING, 0), n - 1)
    t = at(queue, counting)
    i0, i1, i2 = _corners_of(triangles, t + np.int64(mesh["triangle"]), start)
    points = _screen_points(snapped, i0, i1, i2)
    x0, y0, x1, y1, x2, y2 = points
    _, positive = _is_counterclockwise(points)
    x_low, x_high = min(x0, min(x1, x2)), max(x0, max(x1, x2))
    y_low, y_high = min(y0, min(y1, y2)), max(y0, max(y1, y2))
    xr = min(max((x_low + x_high) >> 9, 0), np.int64(camera["width"]))
    yr = min(max((y_low + y_high) >> 9, 0), np.int64(camera["height"]))
    a, b, c = _homogeneous(vertices, i0), _homogeneous(vertices, i1), _homogeneous(vertices, i2)
    fits, z, dzdx, dzdy = _depth_plane(a, b, c, xr, yr, camera)
    material = spread(np.int64(instances[instance]["material"]), t)
    if mesh["slot"] >= 0:
        material = material + at(slots, t + np.int64(mesh["slot"]))
    if place + 8 > limit:
        return place + n  # the caller makes more room, and all is done again
    # What has no depth stays in its place, with a box that is nowhere.
    x_low, x_high = where(fits, x_low, _NOWHERE), where(fits, x_high, -_NOWHERE)
    zero, mode, to = splat8_int(0), at(sided, (material, 1)), place * WORDS
    store_words(words, to, WORDS, x0, where(positive, x1, x2), where(positive, x2, x1), y0)
    store_words(words, to + 4, WORDS, where(positive, y1, y2), where(positive, y2, y1), x_low, y_low)
    store_words(words, to + 8, WORDS, x_high, y_high, as_int(z), as_int(dzdx))
    store_words(words, to + 12, WORDS, as_int(dzdy), xr, yr, splat8_int(instance))
    store_words(words, to + 16, WORDS, t, material, mode, zero)
    store_words(words, to + 20, WORDS, zero, zero, zero, zero)
    return place + n


@kernel
def _corners_of(triangles, row: i32x8, start: int):
    return at(triangles, (row, 0)) + start, at(triangles, (row, 1)) + start, at(triangles, (row, 2)) + start


@kernel
def _homogeneous(vertices, row: i32x8):
    return at(vertices, (row, 0)), at(vertices, (row, 1)), at(vertices, (row, 2)), at(vertices, (row, 3))


@kernel
def assemble_triangles(
    instances, meshes, positions, triangles, slots, materials, camera_table, raster_from_object, vertices, snapped, clip_planes, sided,
    sample_low, sample_high, jobs, first_job, last_job, polygon, scratch, world, world_scratch, queue, screen, words, first_place, limit,
    counts, chunk,
):  # fmt: skip
    """Fill `screen` from `first_place` up to `limit` with the triangles of some jobs; counts[chunk] is how many there are in all.

    A job is (instance, first, last, place): a range of its mesh's triangles, and where its vertices begin. clip_planes (n, 4): clip to
    these in world space (FoCG 8.1.4); none: clip in homogeneous coordinates (FoCG 8.1.5). sided (materials, 2) int32: the sides that are
    drawn, and the alpha mode. Samples lie sample_low to sample_high from their pixel's centre. queue (16,) int32: scratch.
    words: `screen` as int32.

    Eight triangles are looked at at once; those that may be seen wait in the queue until there are eight of them.
    """
    geometry = (instances, meshes, positions, triangles, slots, materials)
    frame = (vertices, snapped, raster_from_object)
    polygons = (polygon, scratch, world, world_scratch)
    camera = camera_table[0]
    width, height = np.int64(camera["width"]), np.int64(camera["height"])
    samples = (sample_low, sample_high)
    place = first_place
    for k in range(first_job, last_job):
        instance, start, last = jobs[k, 0], jobs[k, 3], jobs[k, 2]
        job = (instance, start)
        mesh = meshes[instances[instance]["mesh"]]
        facing = instances[instance]["flipped"] == 0
        waiting = 0
        for first in range(jobs[k, 1], last, 8):
            # The vertices of neighbours may lie anywhere.
            for corner in range(3):
                row = min(load8(_COUNTING, 0) + (first + _AHEAD), last - 1) + np.int64(mesh["triangle"])
                soon = at(triangles, (row, corner)) + start
                prefetch(snapped, soon * 2)
                prefetch(vertices, soon)
            t = min(load8(_COUNTING, 0) + first, last - 1)
            i0, i1, i2 = _corners_of(triangles, t + np.int64(mesh["triangle"]), start)
            points = _screen_points(snapped, i0, i1, i2)
            x0, y0, x1, y1, x2, y2 = points
            if clip_planes.shape[0] > 0 or any_of((x0 == UNSNAPPED) | (x1 == UNSNAPPED) | (x2 == UNSNAPPED)):
                place = _emit_eight(queue, waiting, job, geometry, frame, screen, words, place, limit, camera, sided) if waiting else place
                waiting = 0
                for one in range(first, min(first + 8, last)):
                    place = _assemble_one(job, one, geometry, frame, clip_planes, polygons, screen, place, limit, camera, sided)
                continue
            is_area, positive = _is_counterclockwise(points)
            material = spread(np.int64(instances[instance]["material"]), t)
            if mesh["slot"] >= 0:
                material = material + at(slots, t + np.int64(mesh["slot"]))
            side, is_front = at(sided, (material, 0)), positive ^ (not facing)
            is_shown = (side == BOTH_SIDES) | (is_front ^ (side == BACK_SIDE))
            # Most tiny triangles miss all samples.
            i, last_i = _samples_between(min(x0, min(x1, x2)), max(x0, max(x1, x2)), samples, width)
            j, last_j = _samples_between(min(y0, min(y1, y2)), max(y0, max(y1, y2)), samples, height)
            is_kept = is_area & is_shown & (i <= last_i) & (j <= last_j) & (load8(_COUNTING, 0) < last - first)
            if sample_low == sample_high:
                has_many = (i < last_i) | (j < last_j)
                is_kept = is_kept & (has_many | _covers(points, positive, i * SUBPIXELS + sample_low, j * SUBPIXELS + sample_low))
            kept = mask_of(is_kept)
            while kept != 0:
                queue[waiting] = first + first_set(kept)
                kept = kept & (kept - 1)
                waiting += 1
            if waiting >= 8:
                place = _emit_eight(queue, 8, job, geometry, frame, screen, words, place, limit, camera, sided)
                for s in range(8, waiting):
                    queue[s - 8] = queue[s]
                waiting -= 8
        if waiting:
            place = _emit_eight(queue, waiting, job, geometry, frame, screen, words, place, limit, camera, sided)
    counts[chunk] = place - first_place


@kernel
def _tiles_between(low: i32x8, high: i32x8, places, tile_of):
    """(first, last) of the columns (or rows) of tiles whose samples may lie between two places; the first is after the last if none.

    tile_of (pixels,) int32: the tile of each pixel of a row (or column).
    """
    first, last = _samples_between(low, high, places, tile_of.shape[0])
    is_none, end = first > last, tile_of.shape[0] - 1
    return where(is_none, 1, at(tile_of, min(first, end))), where(is_none, 0, at(tile_of, max(last, 0)))


@kernel
def count_bins(words, first, last, sample_low, sample_high, column_of, row_of, columns, bin_counts, chunk, touched):
    """Count for each tile the triangles of one chunk that may touch it: bin_counts (chunks, tiles).

    words: the screen triangles as int32. touched (4 n,) int32 becomes the first and last column and row of tiles of each triangle: a sixth
    of what it was read from.
    """
    places = (sample_low, sample_high)
    for start in range(first, last, 8):
        row = min(load8(_COUNTING, 0) + start, last - 1)
        c0, c1 = _tiles_between(at(words, (row, LOW_WORD)), at(words, (row, HIGH_WORD)), places, column_of)
        r0, r1 = _tiles_between(at(words, (row, LOW_WORD + 1)), at(words, (row, HIGH_WORD + 1)), places, row_of)
        store_words(touched, 4 * start, 4, c0, c1, r0, r1)
        n = min(8, last - start)
        tile, only = r0 * columns + c0, np.int64(lane(c0, 0))
        only += np.int64(lane(r0, 0)) * columns
        if all_of((c0 == c1) & (r0 == r1) & (tile == only)):
            bin_counts[chunk, only] += n  # neighbours in the mesh are neighbours in the picture
            continue
        for s in range(n):
            k = 4 * (start + s)
            for r in range(touched[k + 2], touched[k + 3] + 1):
                for c in range(touched[k], touched[k + 1] + 1):
                    bin_counts[chunk, r * columns + c] += 1


@kernel
def bin_triangles(touched, first, last, columns, bin_places, chunk, binned):
    """Write one chunk's triangles into the tiles' lists, in order; bin_places (chunks, tiles) moves on."""
    for k in range(first, last):
        for r in range(touched[4 * k + 2], touched[4 * k + 3] + 1):
            for c in range(touched[4 * k], touched[4 * k + 1] + 1):
                tile = r * columns + c
                binned[bin_places[chunk, tile]] = k
                bin_places[chunk, tile] += 1
