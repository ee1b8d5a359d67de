"""A thin lens (FoCG 13.4.3): rays that begin all over its opening and meet again in the plane that is in focus.

A pinhole sees everything sharp. Through an opening of radius R, a point at depth z, with the focus at depth f, is seen along rays that
spread, where the plane in focus stands, over a disk of radius ``R |z - f| / z``: its circle of confusion.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import TWO_PI, cos, floor, sin
from ..kernel.vec import ONE, ZERO, Vec3, normalize
from ..kernel.warp import warp_disk, warp_triangle
from ..shading.analytic import ViewRay, view_ray

__all__ = ["lens_ray", "warp_opening"]

f32 = np.float32


@kernel
def warp_opening(blades: int, u: np.float32, v: np.float32) -> tuple[np.float32, np.float32]:
    """A uniform point of the unit disk or, with blades, of the regular polygon in it whose first corner is on top."""
    if blades < 3:
        return warp_disk(u, v)
    n = f32(blades)
    blade = min(floor(u * n), n - ONE)
    b1, b2 = warp_triangle(u * n - blade, v)
    first, second = blade / n * TWO_PI, (blade + ONE) / n * TWO_PI
    return -(b1 * sin(first) + b2 * sin(second)), b1 * cos(first) + b2 * cos(second)


@outlined
def lens_ray(camera, x: np.float32, y: np.float32, u: np.float32, v: np.float32) -> ViewRay:
    """The ray through raster point (x, y) and the point of the lens that u and v in [0, 1) choose; one unit of depth per unit of t."""
    ray = view_ray(camera, x, y)
    a, b = warp_opening(camera["blades"], u, v)
    right = normalize(Vec3(camera["dx"][0], camera["dx"][1], camera["dx"][2]))
    up = normalize(Vec3(camera["dy"][0], camera["dy"][1], camera["dy"][2]))
    aside = (right * a + up * b) * camera["aperture_radius"]
    # (o + f d - o') / f: the plane in focus is parallel to the picture
    zero = Vec3(ZERO, ZERO, ZERO)
    return ViewRay(ray.o + aside, ray.d - aside * (ONE / camera["focus_distance"]), zero, zero, ray.dddx, ray.dddy)
