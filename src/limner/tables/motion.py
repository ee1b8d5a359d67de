"""What moves, at many instants while the shutter is open (FoCG 13.4.5).

A ray belongs to one time, T = T_0 + xi (T_1 - T_0). Of these times, as many instants as matter are worked out ahead, in float64 and with
rotations that stay rotations (slerp): 1024, so that whatever crosses the picture moves by less than a pixel from one to the next. A ray
then takes the instant in which its time lies: the scene of that instant is exact, and kernels know nothing of keys and quaternions.

A mesh that bends has keys, as many as its vertices need to go straight from one to the next: an instant says between which two it is, and
what share of the way has passed. Vertices and normals are mixed where a ray asks for them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..linear.transform import normal_matrix
from ..scene.camera import Camera
from ..scene.scene import Scene
from . import layouts
from .camera import camera_record, near_and_far
from .layouts import Instants, SceneTables

__all__ = ["MAX_INSTANTS", "instants", "instants_of_nothing"]

MAX_INSTANTS = 1024
_MOST_ROWS = 1 << 18  # of instances at instants: some 60 MB
_FEWEST_INSTANTS = 32


def instants_of_nothing() -> Instants:
    """Of a scene in which nothing moves while the shutter is open."""
    return Instants(np.zeros(0, dtype=layouts.INSTANCE), np.zeros(0, dtype=np.int32), np.zeros(0, dtype=layouts.CAMERA))


def instants(
    scene: Scene, tables: SceneTables, camera: Camera, width: int, height: int, shutter: tuple[float, float],
    n_keys: Mapping[int, int] | None = None,
) -> Instants:
    """Work out where everything is while the shutter is open.

    Parameters
    ----------
    scene : Scene
    tables : SceneTables
        Of the scene as it is when the shutter opens.
    camera : Camera
    width, height : int
    shutter : (float, float)
        When it opens and closes.
    n_keys : mapping of int to int, optional
        Of rows of meshes that bend, how many keys they have: `limner.tables.build.Built`.
    """
    first, last = shutter
    if not first < last:
        return instants_of_nothing()
    probe = np.array([first, last])
    movers = [k for k, (placed, _) in enumerate(scene.shapes(probe)) if placed.world_from_object.ndim == 3]
    n_keys = n_keys or {}
    movers.extend(np.unique(tables.instances["owner"][np.isin(tables.instances["mesh"], list(n_keys))]).tolist())
    if not movers and camera.motion is None:
        return instants_of_nothing()
    moving = np.flatnonzero(np.isin(tables.instances["owner"], movers)).astype(np.int32)
    k = int(min(MAX_INSTANTS, max(_FEWEST_INSTANTS, _MOST_ROWS // max(1, len(moving)))))
    times = first + (np.arange(k) + 0.5) / k * (last - first)
    rows = _instances(scene, tables, moving, first, times)
    for mesh, n in n_keys.items():
        bending = rows["mesh"] == mesh
        passed = (np.arange(k) + 0.5) / k * (n - 1)
        key = np.minimum(passed.astype(np.int32), n - 2)
        rows["key"][bending] = np.broadcast_to(1 + key[:, None], rows.shape)[bending]
        rows["share"][bending] = np.broadcast_to((passed - key)[:, None], rows.shape)[bending]
        rows["mesh"][bending] += rows["key"][bending] - 1
    return Instants(rows.reshape(-1), moving, _cameras(scene, camera, width, height, times))


def _instances(scene: Scene, tables: SceneTables, moving: NDArray[np.int32], first: float, times: NDArray[np.float64]) -> NDArray[np.void]:
    """(k, m) INSTANCE: each row as its owner moves since the shutter opened."""
    rows = np.zeros((len(times), len(moving)), dtype=layouts.INSTANCE)
    shapes, opening = scene.shapes(times), scene.shapes(first)
    for column, row in enumerate(moving):
        instance = tables.instances[row]
        owner = int(instance["owner"])
        places = shapes[owner][0].world_from_object
        if places.ndim == 2:  # it bends where it stands
            places = np.broadcast_to(places, (len(times), 4, 4))
        if owner != row:
            start = np.eye(4)
            start[:3] = instance["world_from_object"]
            places = places @ np.linalg.inv(opening[owner][0].world_from_object) @ start
        normals = normal_matrix(places)
        part = rows[:, column]
        part[...] = instance
        part["world_from_object"], part["object_from_world"] = places[:, :3], np.linalg.inv(places)[:, :3]
        part["world_from_normal"] = normals / np.abs(normals).max(axis=(1, 2), keepdims=True)
    return rows


def _cameras(scene: Scene, camera: Camera, width: int, height: int, times: NDArray[np.float64]) -> NDArray[np.void]:
    near, far = near_and_far(camera.standing(float(times[0])), scene.bounds())
    if camera.motion is None:
        return np.repeat(camera_record(camera, width, height, near, far), len(times))
    return np.concatenate([camera_record(camera.standing(float(time)), width, height, near, far) for time in times])
