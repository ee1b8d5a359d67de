"""Rays of a test's own through limner's accelerators."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from compiled import door_of
from numpy.typing import NDArray

from limner._door import Array
from limner._jit import kernel
from limner.accel import bvh
from limner.accel.layouts import ACCELERATOR_ARRAYS, ENDS_SHAPE, STACK_SIZE, Accelerator
from limner.accel.own_space import FEW_COPIES
from limner.accel.walk import nearest, occluded
from limner.kernel.vec import Vec3
from limner.scene.camera import PerspectiveCamera
from limner.scene.scene import Scene
from limner.tables import layouts
from limner.tables.build import flatten
from limner.tables.layouts import SceneTables

__all__ = ["Hits", "cast", "cast_at"]


class Hits(NamedTuple):
    t: NDArray[np.float32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    instance: NDArray[np.int32]
    triangle: NDArray[np.int32]
    occluded: NDArray[np.bool_]


@kernel
def _cast(instances, attributes, slots, nodes, packs, tags, primitives, planes, rays, stack, ends, numbers, ids):
    accelerator = (nodes, packs, tags, primitives, planes, (attributes, slots, ends))
    for k in range(rays.shape[0]):
        o, d = Vec3(rays[k, 0], rays[k, 1], rays[k, 2]), Vec3(rays[k, 3], rays[k, 4], rays[k, 5])
        hit = nearest(accelerator, instances, o, d, rays[k, 6], rays[k, 7], stack)
        numbers[k, 0], numbers[k, 1], numbers[k, 2] = hit.t, hit.u, hit.v
        ids[k, 0], ids[k, 1] = hit.instance, hit.triangle
        ids[k, 2] = 1 if occluded(accelerator, instances, o, d, rays[k, 6], rays[k, 7], stack) else 0


def cast(
    scene: Scene, origins: Any, directions: Any, kind: bvh.Kind = "bvh", t_min: float = 0.0, t_max: float = np.inf,
    few_copies: int = FEW_COPIES,
) -> Hits:  # fmt: skip
    """What each ray of a test meets in a scene."""
    tables = flatten(scene, PerspectiveCamera(), 64, 48, tessellate=False).tables
    return cast_at(tables, bvh.build(tables, kind, few_copies=few_copies), origins, directions, t_min, t_max)


def cast_at(
    tables: SceneTables, tree: Accelerator, origins: Any, directions: Any, t_min: float = 0.0, t_max: float = np.inf
) -> Hits:
    """What each ray of a test meets in tables, at the time at which their instances are."""
    rays = np.zeros((len(np.atleast_2d(directions)), 8), dtype=np.float32)
    rays[:, 0:3], rays[:, 3:6], rays[:, 6], rays[:, 7] = origins, directions, t_min, t_max
    numbers, ids = np.zeros((len(rays), 3), np.float32), np.zeros((len(rays), 3), np.int32)
    door = door_of(
        _cast, Array(layouts.INSTANCE, 1), Array(np.float32, 1), Array(np.int32, 1), *ACCELERATOR_ARRAYS, Array(np.float32, 2),
        Array(np.int32, 1), Array(np.float64, 2), Array(np.float32, 2), Array(np.int32, 2),
    )  # fmt: skip
    scratch = np.empty(STACK_SIZE, np.int32), np.empty(ENDS_SHAPE)
    door(tables.instances, tables.attributes, tables.slots, *tree, rays, *scratch, numbers, ids)
    return Hits(*numbers.T, ids[:, 0], ids[:, 1], ids[:, 2] == 1)
