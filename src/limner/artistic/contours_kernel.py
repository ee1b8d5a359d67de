"""Curvature of a surface at the corners of its triangles, and how it is curved towards the eye."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@kernel
def _turn(normals: Floats, a: int, b: int, ux: float, uy: float, uz: float) -> float:
    return (normals[b, 0] - normals[a, 0]) * ux + (normals[b, 1] - normals[a, 1]) * uy + (normals[b, 2] - normals[a, 2]) * uz


@kernel
def curve(
    points: Floats, triangles: Indices, normals: Floats, rounds: int, area: Floats, share: Floats, tensors: Floats, room: Floats
) -> None:
    """Find the tensors of curvature at points, `tensors` (n, 6): xx, yy, zz, xy, xz, yz.

    Those of triangles follow, by least squares, from how normals, (n, 3), turn along their sides; those of points are means of the
    triangles', by area, averaged `rounds` times more with their neighbours. `area` (m,), `share` (n,) and `room` (n, 6) are room.
    """
    for k in range(triangles.shape[0]):
        a, b, c = triangles[k, 0], triangles[k, 1], triangles[k, 2]
        ex, ey, ez = points[c, 0] - points[b, 0], points[c, 1] - points[b, 1], points[c, 2] - points[b, 2]
        fx, fy, fz = points[a, 0] - points[c, 0], points[a, 1] - points[c, 1], points[a, 2] - points[c, 2]
        gx, gy, gz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
        double = math.sqrt(nx * nx + ny * ny + nz * nz)
        area[k] = double
        share[a] += double
        share[b] += double
        share[c] += double
        first = ex * ex + ey * ey + ez * ez
        longest = max(first, max(fx * fx + fy * fy + fz * fz, gx * gx + gy * gy + gz * gz))
        if double <= 1e-12 * longest or first == 0.0:
            continue
        length = math.sqrt(first)
        ux, uy, uz = ex / length, ey / length, ez / length
        vx, vy, vz = (ny * uz - nz * uy) / double, (nz * ux - nx * uz) / double, (nx * uy - ny * ux) / double
        u1, u2, u3 = ex * ux + ey * uy + ez * uz, fx * ux + fy * uy + fz * uz, gx * ux + gy * uy + gz * uz
        v1, v2, v3 = ex * vx + ey * vy + ez * vz, fx * vx + fy * vy + fz * vz, gx * vx + gy * vy + gz * vz
        p1, p2, p3 = _turn(normals, b, c, ux, uy, uz), _turn(normals, c, a, ux, uy, uz), _turn(normals, a, b, ux, uy, uz)
        q1, q2, q3 = _turn(normals, b, c, vx, vy, vz), _turn(normals, c, a, vx, vy, vz), _turn(normals, a, b, vx, vy, vz)
        # [uu uv 0; uv uu + vv uv; 0 uv vv] (e f g) = (one two three), by Cramer's rule.
        uu, uv, vv = u1 * u1 + u2 * u2 + u3 * u3, u1 * v1 + u2 * v2 + u3 * v3, v1 * v1 + v2 * v2 + v3 * v3
        one, three = u1 * p1 + u2 * p2 + u3 * p3, v1 * q1 + v2 * q2 + v3 * q3
        two = u1 * q1 + v1 * p1 + u2 * q2 + v2 * p2 + u3 * q3 + v3 * p3
        flat = uu * vv - uv * uv
        divisor = (uu + vv) * flat
        if divisor <= 0.0:
            continue
        e = (one * (flat + vv * vv) - uv * (two * vv - uv * three)) / divisor * double
        f = (uu * (two * vv - uv * three) - one * uv * vv) / divisor * double
        g = (three * (flat + uu * uu) - uv * (two * uu - uv * one)) / divisor * double
        xx, yy, zz = e * ux * ux + 2.0 * f * ux * vx + g * vx * vx, e * uy * uy + 2.0 * f * uy * vy + g * vy * vy, (
            e * uz * uz + 2.0 * f * uz * vz + g * vz * vz
        )
        xy, xz = e * ux * uy + f * (ux * vy + vx * uy) + g * vx * vy, e * ux * uz + f * (ux * vz + vx * uz) + g * vx * vz
        yz = e * uy * uz + f * (uy * vz + vy * uz) + g * vy * vz
        for i in (a, b, c):
            tensors[i, 0] += xx
            tensors[i, 1] += yy
            tensors[i, 2] += zz
            tensors[i, 3] += xy
            tensors[i, 4] += xz
            tensors[i, 5] += yz
    for i in range(points.shape[0]):
        share[i] = 1.0 / share[i] if share[i] > 0.0 else 1.0
        for j in range(6):
            tensors[i, j] *= share[i]
    for _ in range(rounds):
        for i in range(points.shape[0]):
            for j in range(6):
                room[i, j] = 0.0
        for k in range(triangles.shape[0]):
            a, b, c = triangles[k, 0], triangles[k, 1], triangles[k, 2]
            weight = area[k] / 3.0
            for j in range(6):
                value = (tensors[a, j] + tensors[b, j] + tensors[c, j]) * weight
                room[a, j] += value
                room[b, j] += value
                room[c, j] += value
        for i in range(points.shape[0]):
            for j in range(6):
                tensors[i, j] = room[i, j] * share[i]


@kernel
def bend_towards(
    points: Floats, normals: Floats, tensors: Floats, eye: Floats, perspective: int, along: Floats, facing: Floats, radial: Floats
) -> None:
    """At points: the way to the eye `along` the surface, (n, 3), how much it is `facing` the eye, (n,), the cosine of the angle, and its
    curvature in that direction, `radial` (n,)."""
    for i in range(points.shape[0]):
        x, y, z = eye[0], eye[1], eye[2]
        if perspective == 1:
            x, y, z = x - points[i, 0], y - points[i, 1], z - points[i, 2]
        length = max(math.sqrt(x * x + y * y + z * z), 1e-300)
        x, y, z = x / length, y / length, z / length
        cosine = x * normals[i, 0] + y * normals[i, 1] + z * normals[i, 2]
        x, y, z = x - cosine * normals[i, 0], y - cosine * normals[i, 1], z - cosine * normals[i, 2]
        facing[i] = cosine
        along[i, 0], along[i, 1], along[i, 2] = x, y, z
        bent = tensors[i, 0] * x * x + tensors[i, 1] * y * y + tensors[i, 2] * z * z
        bent += 2.0 * (tensors[i, 3] * x * y + tensors[i, 4] * x * z + tensors[i, 5] * y * z)
        radial[i] = bent / max(x * x + y * y + z * z, 1e-300)
