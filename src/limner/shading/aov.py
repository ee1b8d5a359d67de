"""What lies beside the picture: geometry and names of what the centre of each pixel sees, unfiltered (arbitrary output variables).

    depth                -z in camera space, metres along the gaze; infinity: nothing
    distance             from the eye, Euclidean
    normal               shading normal, world, towards the eye; zero: nothing
    normal_geometric     of the triangle itself
    position             world
    uv                   first texture coordinates, v up
    albedo               the base colour as painted
    instance_id          which shape of the scene, -1: nothing
    material_id
    triangle_id          of the instance's mesh; -1: nothing, or an exact shape

Blended surfaces count as solid where their alpha is at least one half.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import sqrt
from ..kernel.vec import Vec3, dot
from ..tables.layouts import MESH
from .bsdf import resolve
from .surface import flip_to_front
from .visible import direction_to_eye

__all__ = ["write_aov"]

_NOTHING = np.int32(-1)


@kernel
def write_aov(scene, camera, instance_id: int, triangle: int, point, values, ids, i: int, j: int):
    """Fill values[j, i] (16 float32) and ids[j, i] (3 int32) from a surface point."""
    instances, _, _, _, _, _, materials, _, textures, texels = scene
    point = flip_to_front(point, direction_to_eye(camera, point.position))
    bsdf = resolve(materials[point.material], instances[instances[instance_id]["owner"]], point, textures, texels)
    to_point = point.position - Vec3(camera["position"][0], camera["position"][1], camera["position"][2])
    gaze = Vec3(camera["gaze"][0], camera["gaze"][1], camera["gaze"][2])
    row = values[j, i]
    row[0], row[1] = dot(to_point, gaze), sqrt(dot(to_point, to_point))
    row[2], row[3], row[4] = bsdf.ns.x, bsdf.ns.y, bsdf.ns.z
    row[5], row[6], row[7] = point.n.x, point.n.y, point.n.z
    row[8], row[9], row[10] = point.position.x, point.position.y, point.position.z
    row[11], row[12] = point.u, point.v
    row[13], row[14], row[15] = bsdf.albedo.r, bsdf.albedo.g, bsdf.albedo.b
    ids[j, i, 0], ids[j, i, 1] = instances[instance_id]["owner"], point.material
    ids[j, i, 2] = triangle if instances[instance_id]["kind"] == MESH else _NOTHING
