"""Where the camera's rays begin: what the eye is in, and when it looks."""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..accel.walk import first_hit
from ..kernel.vec import ZERO, Vec3, dot
from ..shading.medium import within, without
from ..tables.layouts import PERSPECTIVE
from ..visibility.hit import hit_point
from ..visibility.spawn import off_surface

__all__ = ["LENS", "TIME", "media_around", "media_of_eye", "set_instant"]

f32, i64 = np.float32, np.int64
_INFINITY = f32(np.inf)
_MAX_SURFACES = 256
_BYTE, _LAST_PLACE = i64(256), i64(1) << i64(48)

# Decisions of a sample that are not those of a surface: dimensions of its sampler
LENS, TIME = -1, -2


@outlined
def media_around(scene, accelerator, p: Vec3, stack) -> int:
    """The media that a point lies in, as a ray carries them: those that a ray out of it leaves and did not enter, inner before outer."""
    instances, materials = scene[0], scene[6]
    # A direction in which nobody builds walls
    d, o = Vec3(f32(0.3713907), f32(0.7427814), f32(0.5570860)), p
    around, place, entered = i64(0), i64(1), i64(0)
    for _ in range(_MAX_SURFACES):
        hit = first_hit(accelerator, instances, o, d, ZERO, _INFINITY, True, stack)
        if hit.instance < 0:
            break
        point = hit_point(scene, accelerator, hit, o, d)
        medium = i64(materials[point.material]["medium"])
        if materials[point.material]["medium"] > 0:
            following = within(entered, medium) if dot(point.n, d) < ZERO else without(entered, medium)
            if following == entered and place <= _LAST_PLACE:
                around, place = around + medium * place, place * _BYTE
            entered = following
        o = off_surface(point, point.n if dot(point.n, d) >= ZERO else -point.n)
    return around


@kernel
def media_of_eye(scene, accelerator, media, camera, o: Vec3, stack) -> int:
    """The media that a camera ray begins in; rays of parallel projection begin outside."""
    if media.shape[0] < 2 or camera["kind"] != PERSPECTIVE:
        return i64(0)
    return media_around(scene, accelerator, o, stack)


@kernel
def set_instant(instances, camera_table, instants, moving, cameras, u: np.float32):
    """Put what moves where it is at a time: u in [0, 1) is the part of the shutter's time that has passed.

    `instances` and `camera_table` belong to this thread alone. `instants` holds the rows of all that moves, instant after instant.
    """
    n = cameras.shape[0]
    k = min(int(u * f32(n)), n - 1)
    camera_table[0] = cameras[k]
    m = moving.shape[0]
    for row in range(m):
        instances[moving[row]] = instants[k * m + row]
