"""Rays in float64, brought close to a mesh before they become float32."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO, Vec3

__all__ = ["FAR_SQUARED", "LONGEST", "SHORTEST", "NearRay", "near_ray"]

f32, f64 = np.float32, np.float64
_NOWHERE = f64(np.inf)
_NOTHING = f64(0.0)
SHORTEST, LONGEST = f64(1e-12), f64(1e12)  # directions whose reciprocals and products are safe in float32
FAR_SQUARED = f64(16.0)  # beyond four radii of its bounding sphere, a mesh is approached before anything is rounded


class NearRay(NamedTuple):
    """A ray in float32, in the mesh's own frame and close to it. The given ray's t is (start + t) / length."""

    o: Vec3
    d: Vec3
    start: np.float64
    length: np.float64
    sound: bool


@kernel
def _no_ray() -> NearRay:
    nothing = Vec3(ZERO, ZERO, ONE)
    return NearRay(nothing, nothing, _NOTHING, f64(1.0), False)


@kernel
def near_ray(origins, directions, k: int, frame) -> NearRay:
    """Ray k, brought close to the bounding sphere in float64; not sound where it is no ray, or passes the sphere from afar.

    `frame` (8,) float64: the shift and the scale that the mesh was moved by, then the centre and the radius of its sphere.
    """
    scale = frame[3]
    ox, oy, oz = (origins[k, 0] - frame[0]) * scale, (origins[k, 1] - frame[1]) * scale, (origins[k, 2] - frame[2]) * scale
    dx, dy, dz = directions[k, 0] * scale, directions[k, 1] * scale, directions[k, 2] * scale
    # Written so that a NaN is no ray.
    if not (abs(ox) < _NOWHERE and abs(oy) < _NOWHERE and abs(oz) < _NOWHERE):
        return _no_ray()
    if not (abs(dx) < _NOWHERE and abs(dy) < _NOWHERE and abs(dz) < _NOWHERE):
        return _no_ray()
    greatest = max(max(abs(dx), abs(dy)), abs(dz))
    if greatest == _NOTHING:
        return _no_ray()
    length = f64(1.0)
    if greatest < SHORTEST or greatest > LONGEST:
        length = greatest
        dx, dy, dz = dx / length, dy / length, dz / length
    cx, cy, cz = frame[4] - ox, frame[5] - oy, frame[6] - oz
    away = cx * cx + cy * cy + cz * cz
    radius_squared = frame[7] * frame[7]
    start = _NOTHING
    if away > FAR_SQUARED * radius_squared:
        squared = dx * dx + dy * dy + dz * dz
        closest = (cx * dx + cy * dy + cz * dz) / squared
        if not away - closest * closest * squared <= f64(1e-9) * away + radius_squared:
            return _no_ray()
        start = closest - f64(2.0) * frame[7] / np.sqrt(squared)
        if not start > _NOTHING:
            return _no_ray()
        ox, oy, oz = ox + start * dx, oy + start * dy, oz + start * dz
    return NearRay(Vec3(f32(ox), f32(oy), f32(oz)), Vec3(f32(dx), f32(dy), f32(dz)), start, length, True)
