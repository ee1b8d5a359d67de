"""Normals averaged over their neighbours, and by how much that changes them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@kernel
def average_normals(
    groups: Indices,
    instance: Indices,
    area: Floats,
    normals: Floats,
    rounds: int,
    split: float,
    rim: float,
    own: Floats,
    mean: Floats,
    total: Floats,
    weight: Floats,
    change: Floats,
    kept: Indices,
    before: Floats,
    after: Floats,
) -> None:
    """Average normals at corners with those around them.

    `groups` (m, 3) numbers what is one place of a smooth surface, `normals` (m, 3, 3) are unit, `area` (m,) is what triangles count. Of the
    groups are made: `own` their normals and `mean` the averages, (g, 3); `change` their mean differences thereabouts and `kept`, (g,), not
    0 where the normals stay: they are not one, by more than `split`, or their average differs by more than `rim`. Of each `instance`:
    how much neighbours differ `before` and `after`. `total` (g, 3) and `weight` (g,) are room.
    """
    m, g = groups.shape[0], own.shape[0]
    for k in range(m):
        for c in range(3):
            i = groups[k, c]
            weight[i] += area[k]
            for axis in range(3):
                own[i, axis] = normals[k, c, axis]
    for k in range(m):
        for c in range(3):
            i = groups[k, c]
            for axis in range(3):
                if abs(normals[k, c, axis] - own[i, axis]) > split:
                    kept[i] = 1
    for i in range(g):
        for axis in range(3):
            mean[i, axis] = own[i, axis]
    for _ in range(rounds):
        for i in range(g):
            total[i, 0] = total[i, 1] = total[i, 2] = 0.0
        for k in range(m):
            share = area[k] / 3.0
            a, b, c = groups[k, 0], groups[k, 1], groups[k, 2]
            for axis in range(3):
                value = (mean[a, axis] + mean[b, axis] + mean[c, axis]) * share
                total[a, axis] += value
                total[b, axis] += value
                total[c, axis] += value
        for i in range(g):
            length = math.sqrt(total[i, 0] * total[i, 0] + total[i, 1] * total[i, 1] + total[i, 2] * total[i, 2])
            if kept[i] == 0 and length > 0.0:
                for axis in range(3):
                    mean[i, axis] = total[i, axis] / length
    for k in range(m):
        for c in range(3):
            i, j = groups[k, c], groups[k, (c + 1) % 3]
            before[instance[k]] += area[k] * _distance(own, i, own, j)
            after[instance[k]] += area[k] * _distance(mean, i, mean, j)
    for i in range(g):
        total[i, 0] = _distance(own, i, mean, i)
        if total[i, 0] > rim:
            kept[i] = 1
        if kept[i] != 0:
            total[i, 0] = 0.0
    for k in range(m):
        value = (total[groups[k, 0], 0] + total[groups[k, 1], 0] + total[groups[k, 2], 0]) * (area[k] / 3.0)
        for c in range(3):
            change[groups[k, c]] += value
    for i in range(g):
        if weight[i] > 0.0:
            change[i] /= weight[i]


@kernel
def _distance(p: Floats, i: int, q: Floats, j: int) -> float:
    x, y, z = p[i, 0] - q[j, 0], p[i, 1] - q[j, 1], p[i, 2] - q[j, 2]
    return math.sqrt(x * x + y * y + z * z)


@kernel
def take_averages(
    groups: Indices, instance: Indices, share: Floats, mean: Floats, change: Floats, kept: Indices, normals: Floats, noise: Floats
) -> None:
    """Move normals, (m, 3, 3), a share of the way to their averages, and tell how much grain there is at each, (m, 3)."""
    for k in range(groups.shape[0]):
        part = share[instance[k]]
        if part == 0.0:
            continue
        for c in range(3):
            i = groups[k, c]
            noise[k, c] = part * change[i]
            if kept[i] == 0:
                for axis in range(3):
                    normals[k, c, axis] += part * (mean[i, axis] - normals[k, c, axis])


@kernel
def face_eye(
    corners: Floats,
    flat: Floats,
    normals: Floats,
    noise: Floats,
    keep_smooth: int,
    eye: Floats,
    perspective: int,
    depth_of: Floats,
    near: float,
    pixels: float,
    limits: Floats,
    values: Floats,
    apart: Floats,
) -> None:
    """How much surfaces face the eye at the corners of triangles, `values` (m, 3), and how far the triangles are from them, `apart` (m,).

    `corners` (m, 3, 3); `flat` (m, 3) their own normals; `normals` (m, 3, 3) the surface's and `noise` (m, 3) its grain, which become those
    of triangles that one can tell from it, unless `keep_smooth`. `eye` is a place, or in parallel projection the way to it; `depth_of` (4,)
    the row of the camera's matrix; `limits` are `edge-on`, the most of the grain that counts, what is visible in pixels, and by what the
    turn of the normals tells how far a mesh and its surface are apart.
    """
    edge_on, most, visible, bends = limits[0], limits[1], limits[2], limits[3]
    for k in range(corners.shape[0]):
        pixel = 1.0 / pixels
        if perspective == 1:
            depth = -(corners[k, 0, 0] * depth_of[0] + corners[k, 0, 1] * depth_of[1] + corners[k, 0, 2] * depth_of[2] + depth_of[3])
            pixel *= max(depth, near)
        longest, turn, against = 0.0, 0.0, False
        for c in range(3):
            longest = max(longest, _distance(corners[k], c, corners[k], (c + 1) % 3))
            x, y, z = normals[k, c, 0] - flat[k, 0], normals[k, c, 1] - flat[k, 1], normals[k, c, 2] - flat[k, 2]
            turn = max(turn, math.sqrt(x * x + y * y + z * z))
            against = against or normals[k, c, 0] * flat[k, 0] + normals[k, c, 1] * flat[k, 1] + normals[k, c, 2] * flat[k, 2] <= 0.0
        # An arc that turns by a over a chord s is a s / 8 away from it, and its ends turn by a / 2.
        if keep_smooth == 0 and (against or 0.25 * turn * longest > visible * pixel):
            for c in range(3):
                noise[k, c] = 0.0
                for axis in range(3):
                    normals[k, c, axis] = flat[k, axis]
        bent, grain = 0.0, 0.0
        for c in range(3):
            bent = max(bent, _distance(normals[k], c, normals[k], (c + 1) % 3))
            grain = max(grain, noise[k, c])
            x, y, z = eye[0], eye[1], eye[2]
            if perspective == 1:
                x, y, z = x - corners[k, c, 0], y - corners[k, c, 1], z - corners[k, c, 2]
            value = normals[k, c, 0] * x + normals[k, c, 1] * y + normals[k, c, 2] * z
            values[k, c] = value - (edge_on + min(noise[k, c], most)) * math.sqrt(x * x + y * y + z * z)
        apart[k] = bends * bent * longest
        if bent > 0.0 and grain > 0.0:
            # What is not seen of the grain hides nothing, nor half as much again where there is much.
            apart[k] = max(apart[k], visible * (1.0 + 0.5 * min(grain / most, 1.0)) * pixel)
