"""One pass of the edge-aware filter over a tile: 25 neighbours, some steps apart, each weighed by how likely it shows the same."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._jit import kernel
from ..kernel.elementary import exp2, sqrt

__all__ = ["denoise_tile"]

f32 = np.float32
_ZERO, _ONE = f32(0.0), f32(1.0)
_LOG2_E = f32(1.4426950408889634)
_R, _G, _B = f32(0.2126), f32(0.7152), f32(0.0722)
_TINY = f32(1e-12)
# What a difference of one costs in the exponent
_NORMAL, _ALBEDO, _DEPTH = f32(32.0), f32(4.0), f32(20.0)
_LEAST_WEIGHT = f32(-20.0)  # log2 of what is not worth adding


@kernel
def _blurred(variance: Any, i: int, j: int) -> np.float32:
    """The variance around a pixel: of one pixel's few samples it is itself a matter of luck."""
    height, width = variance.shape
    total, weights = _ZERO, _ZERO
    for dj in range(-1, 2):
        for di in range(-1, 2):
            x, y = i + di, j + dj
            if x >= 0 and x < width and y >= 0 and y < height:
                weight = f32((2 - abs(di)) * (2 - abs(dj)))
                total += weight * variance[y, x]
                weights += weight
    return total / weights


@kernel
def _spline(offset: int) -> np.float32:
    """16 times the cubic B-spline's weights."""
    return f32(6.0) if offset == 0 else (f32(4.0) if abs(offset) == 1 else _ONE)


@kernel
def denoise_tile(
    light: Any, variance: Any, guide: Any, to_light: Any, to_variance: Any, strength: np.float32, step: int, tile: int, first_column: int,
    first_row: int, columns: int, rows: int,
) -> None:  # fmt: skip
    """Filter a tile of `light` (height, width, 4: colour and weight) and its `variance` (height, width), of luminance.

    `guide` (height, width, 9): normal, albedo, one over depth and its change to the right and down. A neighbour's share is
    ``B(dx) B(dy) exp(-|dn|² 32 - |da|² 4 - |dz| 20 - |dl| / (strength σ))``: B the spline (1 4 6 4 1) / 16, dz what is off the plane
    through the pixel, relative, and dl the difference of luminance against its standard deviation σ.
    """
    height, width = variance.shape
    for j in range(first_row, first_row + rows):
        for i in range(first_column, first_column + columns):
            r, g, b = light[j, i, 0], light[j, i, 1], light[j, i, 2]
            here = _R * r + _G * g + _B * b
            near = guide[j, i, 6]
            per_deviation = _ONE / (strength * sqrt(_blurred(variance, i, j)) + f32(1e-4) * here + _TINY)
            per_depth = _DEPTH / (near + _TINY)
            total_r, total_g, total_b, total_variance, weights = _ZERO, _ZERO, _ZERO, _ZERO, _ZERO
            for dj in range(-2, 3):
                y = j + dj * step
                if y < 0 or y >= height:
                    continue
                for di in range(-2, 3):
                    x = i + di * step
                    if x < 0 or x >= width:
                        continue
                    exponent = _ZERO
                    if di != 0 or dj != 0:
                        n0, n1, n2 = guide[y, x, 0] - guide[j, i, 0], guide[y, x, 1] - guide[j, i, 1], guide[y, x, 2] - guide[j, i, 2]
                        a0, a1, a2 = guide[y, x, 3] - guide[j, i, 3], guide[y, x, 4] - guide[j, i, 4], guide[y, x, 5] - guide[j, i, 5]
                        plane = near + guide[j, i, 7] * f32(di * step) + guide[j, i, 8] * f32(dj * step)
                        there = _R * light[y, x, 0] + _G * light[y, x, 1] + _B * light[y, x, 2]
                        exponent = -(
                            (n0 * n0 + n1 * n1 + n2 * n2) * _NORMAL + (a0 * a0 + a1 * a1 + a2 * a2) * _ALBEDO
                            + abs(guide[y, x, 6] - plane) * per_depth + abs(there - here) * per_deviation
                        ) * _LOG2_E  # fmt: skip
                    if exponent > _LEAST_WEIGHT:
                        weight = _spline(di) * _spline(dj) * exp2(exponent) * light[y, x, 3]
                        total_r += weight * light[y, x, 0]
                        total_g += weight * light[y, x, 1]
                        total_b += weight * light[y, x, 2]
                        total_variance += weight * weight * variance[y, x]
                        weights += weight
            to_light[j, i, 3] = light[j, i, 3]
            if weights > _ZERO:
                share = _ONE / weights
                to_light[j, i, 0], to_light[j, i, 1], to_light[j, i, 2] = total_r * share, total_g * share, total_b * share
                to_variance[j, i] = total_variance * share * share
            else:
                to_light[j, i, 0], to_light[j, i, 1], to_light[j, i, 2] = r, g, b
                to_variance[j, i] = variance[j, i]
