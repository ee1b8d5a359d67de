"""Ray and half space: the plane y = 0 with what lies below it. It has no end, so it is for cutting other solids."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.vec import ONE, ZERO, Vec3
from .interval import FAR, Ray, Spans, everywhere, is_ray, nowhere, span
from .object_point import ObjectPoint

__all__ = ["half_space_at", "half_space_spans"]

_NONE = np.float64(0.0)


@kernel
def half_space_spans(ray: Ray) -> Spans:
    """Where the ray is at y <= 0."""
    if not is_ray(ray):
        return nowhere()
    if ray.dy == _NONE:
        return everywhere() if ray.oy <= _NONE else nowhere()
    t = -ray.oy / ray.dy
    return span(t, 0, FAR, 0) if ray.dy < _NONE else span(-FAR, 0, t, 0)


@kernel
def half_space_at(p: Vec3) -> ObjectPoint:
    """The plane's point below p; (u, v) = (x, -z)."""
    return ObjectPoint(
        Vec3(p.x, ZERO, p.z), Vec3(ZERO, ONE, ZERO), Vec3(ONE, ZERO, ZERO), p.x, -p.z, Vec3(ONE, ZERO, ZERO), Vec3(ZERO, ZERO, -ONE)
    )
