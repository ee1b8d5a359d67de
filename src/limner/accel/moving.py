"""Primitives that move: a tree over everywhere they come while the shutter is open.

A moving triangle stays in its object's space, and rays are taken there, by the instance as it is at their time. Its box in the tree holds
it at every instant that a ray can have; so no ray misses it, and rays that come at another time look in vain.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..tables.layouts import Instants, SceneTables
from .layouts import FIRST_MOVING

__all__ = ["set_moving"]

_COARSE = 33  # instants at which each triangle is looked at; the others' are bounded by how they differ from these
_MARGIN = 1e-6


def set_moving(
    primitives: NDArray[np.void],
    corners: NDArray[np.float32],
    bounds: NDArray[np.float32],
    tables: SceneTables,
    instants: Instants,
) -> None:
    """Mark the primitives of instances that move, put their corners into object space, and widen their bounds; in place.

    Parameters
    ----------
    primitives : (n,) PRIMITIVE
    corners : (n, 9) float32
    bounds : (n, 6) float32
    """
    m = len(instants.moving)
    columns = {int(row): column for column, row in enumerate(instants.moving)}
    owners = tables.instances["owner"][primitives["instance"]] if len(primitives) else np.zeros(0, dtype=np.int32)
    for row in np.unique(owners[np.isin(owners, instants.moving)]):
        mine = np.flatnonzero(owners == row)
        places = instants.instances[columns[int(row)] :: m]["world_from_object"].astype(np.float64)
        triangles = mine[primitives["triangle"][mine] >= 0]
        if len(triangles):
            corners[triangles] = _object_corners(tables, int(row), primitives["triangle"][triangles])
            # In object space, nothing is mirrored: all that are seen from one side are seen from the front.
            primitives["facing"][triangles] = np.abs(primitives["facing"][triangles])
            primitives["triangle"][triangles] = FIRST_MOVING - primitives["triangle"][triangles]
            bounds[triangles] = _swept(corners[triangles].reshape(-1, 3, 3).astype(np.float64), places)
        exact = mine[primitives["triangle"][mine] < 0]
        if len(exact):
            # The box that it has when the shutter opens goes with it.
            start = np.vstack([tables.instances[row]["world_from_object"].astype(np.float64), (0.0, 0.0, 0.0, 1.0)])
            bounds[exact] = _swept(_box_corners(bounds[exact].astype(np.float64)), places @ np.linalg.inv(start))


def _object_corners(tables: SceneTables, row: int, triangles: NDArray[np.int32]) -> NDArray[np.float32]:
    mesh = tables.meshes[tables.instances[row]["mesh"]]
    vertices = tables.positions[mesh["position"] + tables.triangles[mesh["triangle"] + triangles]]
    return np.ascontiguousarray(vertices.reshape(-1, 9))


def _box_corners(boxes: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, 8, 3) from (n, 6)."""
    pick = np.array([[x, 1 + y, 2 + z] for x in (0, 3) for y in (0, 3) for z in (0, 3)])
    return boxes[:, pick]


def _swept(points: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float32]:
    """(n, 6) float32: boxes that hold points (n, c, 3) at all places (k, 3, 4).

    At some instants the points are followed; those in between are nearly on straight lines between these, and how far off, for any point
    of the object, follows from the matrices alone.
    """
    chosen = np.unique(np.linspace(0, len(places) - 1, min(_COARSE, len(places))).astype(int))
    low, high = np.full((len(points), 3), np.inf), np.full((len(points), 3), -np.inf)
    for place in places[chosen]:
        moved = points @ place[:, :3].T + place[:, 3]
        low, high = np.minimum(low, moved.min(axis=1)), np.maximum(high, moved.max(axis=1))
    k = np.arange(len(places))
    after = np.clip(np.searchsorted(chosen, k, side="right"), 1, max(1, len(chosen) - 1))
    a, b = chosen[after - 1], chosen[np.minimum(after, len(chosen) - 1)]
    share = ((k - a) / np.maximum(b - a, 1))[:, None, None]
    off = np.abs(places - ((1.0 - share) * places[a] + share * places[b]))
    reach = np.append(np.abs(points).max(axis=(0, 1)), 1.0)
    margin = (off @ reach).max(axis=0) + _MARGIN * (np.abs(places) @ reach).max(axis=0)
    return np.concatenate([low - margin, high + margin], axis=1).astype(np.float32)
