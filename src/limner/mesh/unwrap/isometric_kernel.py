"""The energy of flattened triangles with its gradient, and how far they are from collapse."""

from __future__ import annotations

import math

from ..._jit import kernel


@kernel
def evaluate(flat, corners, charts, shapes, areas, w, values, gradient):
    """Sum c a^w of the triangles, by area, into the `values` of their charts, and its derivatives into `gradient`, (n, 2).

    d(c a^w) = a^w dc + w c a^(w-1) da, with dc = J/det − ‖J‖²/(2 det²) cof J and da = (1 − 1/det²)/2 cof J
    """
    for k in range(len(values)):
        values[k] = 0.0
    for k in range(len(gradient)):
        gradient[k, 0] = gradient[k, 1] = 0.0
    for t in range(len(corners)):
        i, j, k = corners[t, 0], corners[t, 1], corners[t, 2]
        length, x, y = shapes[t, 0], shapes[t, 1], shapes[t, 2]
        p, r = (flat[j, 0] - flat[i, 0]) / length, (flat[j, 1] - flat[i, 1]) / length
        q, s = (flat[k, 0] - flat[i, 0] - p * x) / y, (flat[k, 1] - flat[i, 1] - r * x) / y
        det = p * s - q * r
        if not det > 0.0:
            values[charts[t]] = math.inf
            continue
        norm = p * p + q * q + r * r + s * s
        c, a = norm / (2.0 * det), 0.5 * (det + 1.0 / det)
        weight = areas[t] * (a if w == 1.0 else math.pow(a, w))
        values[charts[t]] += weight * c
        by_j = weight / det
        by_cofactor = weight * (w * c / a * 0.5 * (1.0 - 1.0 / (det * det)) - norm / (2.0 * det * det))
        for m in range(2):
            along = by_j * p + by_cofactor * s if m == 0 else by_j * r - by_cofactor * q
            across = by_j * q - by_cofactor * r if m == 0 else by_j * s + by_cofactor * p
            third = across / y
            second = (along - third * x) / length
            gradient[i, m] -= second + third
            gradient[j, m] += second
            gradient[k, m] += third


@kernel
def first_collapses(flat, direction, corners, charts, nearest):
    """Find for each chart how many times `direction` leads to its first triangle without area; inf: none does.

    The least positive root of a quadratic for each triangle, without cancellation.
    """
    for k in range(len(nearest)):
        nearest[k] = math.inf
    for t in range(len(corners)):
        i, j, k = corners[t, 0], corners[t, 1], corners[t, 2]
        ex, ey, fx, fy = flat[j, 0] - flat[i, 0], flat[j, 1] - flat[i, 1], flat[k, 0] - flat[i, 0], flat[k, 1] - flat[i, 1]
        dex, dey = direction[j, 0] - direction[i, 0], direction[j, 1] - direction[i, 1]
        dfx, dfy = direction[k, 0] - direction[i, 0], direction[k, 1] - direction[i, 1]
        constant, linear, square = ex * fy - ey * fx, ex * dfy - ey * dfx + dex * fy - dey * fx, dex * dfy - dey * dfx
        discriminant = linear * linear - 4.0 * square * constant
        if discriminant < 0.0:
            continue
        root = math.sqrt(discriminant)
        half = -0.5 * (linear + (root if linear >= 0.0 else -root))
        if half != 0.0 and constant / half > 0.0:
            nearest[charts[t]] = min(nearest[charts[t]], constant / half)
        if square != 0.0 and half / square > 0.0:
            nearest[charts[t]] = min(nearest[charts[t]], half / square)
