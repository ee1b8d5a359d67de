"""What a raster point sees on a given instance and triangle: the one place where every renderer's primary hits become surface points."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.lanes import spread, where
from ..kernel.transform import transform_point, transform_vector
from ..kernel.vec import ONE, ZERO, Vec3, dot, normalize
from ..tables.layouts import ORTHOGRAPHIC, PLANE, SPHERE
from .analytic import analytic_at, hit_analytic, view_ray
from .surface import SurfacePoint, barycentrics_at, surface_at

__all__ = ["direction_to_eye", "is_analytic", "visible_point"]

f32 = np.float32
_INFINITY = f32(np.inf)
_STEP = f32(1e-5)


@kernel
def is_analytic(instance) -> bool:
    """Whether an instance is exact, and its triangles only stand for it."""
    return instance["kind"] == SPHERE or instance["kind"] == PLANE


@kernel
def direction_to_eye(camera, p: Vec3) -> Vec3:
    """wo: from a point to the eye, unit."""
    if camera["kind"] == ORTHOGRAPHIC:
        return Vec3(spread(-camera["gaze"][0], p.x), -camera["gaze"][1], -camera["gaze"][2])
    return normalize(Vec3(camera["position"][0], camera["position"][1], camera["position"][2]) - p)


@kernel
def _seen_from_behind(instance, v0, v1, v2, x: np.float32, y: np.float32) -> bool:
    """Whether the triangle that stands for an exact shape shows its back: then its far side is meant."""
    ax, ay, bx, by = v0[0] - x * v0[3], v0[1] - y * v0[3], v1[0] - x * v1[3], v1[1] - y * v1[3]
    cx, cy = v2[0] - x * v2[3], v2[1] - y * v2[3]
    area = (bx * cy - by * cx) + (cx * ay - cy * ax) + (ax * by - ay * bx)
    return area * where(instance["flipped"] != 0, -ONE, ONE) < ZERO


@kernel
def visible_point(scene, camera, instance_id: int, triangle: int, v0, v1, v2, x: np.float32, y: np.float32) -> SurfacePoint:
    """The surface point at raster point (x, y); v0, v1, v2 are the triangle's homogeneous raster vertices."""
    instances, meshes, positions, triangles, attributes, slots, _, _, _, _ = scene
    instance = instances[instance_id]
    if is_analytic(instance):
        ray = view_ray(camera, x, y)
        t = hit_analytic(instance, ray.o, ray.d, camera["near"], camera["far"])
        behind = hit_analytic(instance, ray.o, ray.d, t + abs(t) * _STEP, camera["far"])
        t = where(_seen_from_behind(instance, v0, v1, v2, x, y) & (behind < _INFINITY), behind, t)
        # The ray grazes the silhouette: its closest point to the centre will do.
        m = instance["object_from_world"]
        o, d = transform_point(m, ray.o), transform_vector(m, ray.d)
        t = where(t == _INFINITY, -dot(o, d) / dot(d, d), t)
        return analytic_at(instance, ray, t)
    w = barycentrics_at(x, y, v0, v1, v2)
    return surface_at((positions, triangles, attributes, slots), instance, meshes[instance["mesh"]], triangle, w, meshes, None)
