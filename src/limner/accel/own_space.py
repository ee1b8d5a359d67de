"""Which meshes get a tree in their own space, and where in the world these trees stand.

A mesh that stands in a hundred thousand places need not be there a hundred thousand times: rays are taken to its space instead, where one
tree serves all. Nor does a tree have to follow what moves: in its own space it rests, and rays come to it from where it is at their time.
The price is paid by rays: the boxes of instances overlap where their triangles do not, and each that is met costs a transformation. So
what stands still and is not often repeated stays in the tree of the world.

A moving primitive's box holds it at every instant that a ray can have; rays that come at another time look in vain.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..tables.layouts import BOX, MESH, OPAQUE, Instants, SceneTables

__all__ = ["FEW_COPIES", "box_corners", "groups_of", "swept_bounds", "widen_moving"]

FEW_COPIES = 1 << 18
"""So many triangles (some 30 MB of tree) are rather copied than shared."""

_COARSE = 33  # instants at which each primitive is looked at; the others' are bounded by how they differ from these
_MARGIN = 1e-6
_LEAST_SHARED = 32
_ROWS_AT_ONCE = 1 << 13


def groups_of(tables: SceneTables, instants: Instants | None, few_copies: int = FEW_COPIES) -> list[NDArray[np.int64]]:
    """The instances that share a tree, group by group: those of one mesh, seen from the same sides and through the same holes.

    Parameters
    ----------
    tables : SceneTables
    instants : Instants, optional
        What moves gets a tree, however few it is.
    few_copies : int
        Meshes at rest are shared where more triangles than this would be copies.
    """
    instances = tables.instances
    rows = np.flatnonzero(np.isin(instances["kind"], (MESH, BOX)) & (instances["mesh"] >= 0))
    rows = rows[tables.meshes["n_triangles"][instances["mesh"][rows]] > 0]
    if not len(rows):
        return []
    mesh, material = instances["mesh"][rows].astype(np.int64), instances["material"][rows].astype(np.int64)
    # What a tree knows of a material; where a mesh has several, the first of them stands for all.
    look = 2 * (tables.materials["double_sided"][material] != 0) + (tables.materials["alpha_mode"][material] == OPAQUE)
    look = np.where(tables.meshes["slot"][mesh] >= 0, 4 + material, look)
    _, group = np.unique(mesh * (int(look.max()) + 1) + look, return_inverse=True)
    moves = np.isin(instances["owner"][rows], instants.moving) if instants is not None else np.zeros(len(rows), dtype=np.bool_)
    n_resting = np.bincount(group[~moves], minlength=int(group.max()) + 1)
    sizes = np.zeros(len(n_resting), dtype=np.int64)
    sizes[group] = tables.meshes["n_triangles"][mesh]
    copies = np.maximum(n_resting - 1, 0) * sizes
    shared = copies > 0 if int(copies.sum()) > few_copies else np.zeros(len(copies), dtype=np.bool_)
    # Two triangles in many places are sooner copied than reached through a tree.
    shared &= sizes > _LEAST_SHARED
    apart = moves | shared[group]
    order = np.flatnonzero(apart)[np.argsort(group[apart], kind="stable")]
    return np.split(rows[order].astype(np.int64), np.flatnonzero(np.diff(group[order])) + 1) if len(order) else []


@np.errstate(over="ignore", invalid="ignore")
def swept_bounds(box: NDArray[np.float32], rows: NDArray[np.int64], tables: SceneTables, instants: Instants | None) -> NDArray[np.float32]:
    """(n, 6) float32: where in the world the box of a mesh is, in each of its instances, at all instants.

    Parameters
    ----------
    box : (6,) float32
        In the mesh's space.
    rows : (n,) int64
        Instances of it.

    **Source**: of a box that rests, each axis by itself: Arvo, *Transforming axis-aligned bounding boxes*, Graphics Gems, 1990.
    """
    corners = box_corners(box[None].astype(np.float64))[0]
    bounds = np.empty((len(rows), 6), dtype=np.float32)
    places = tables.instances["world_from_object"][rows].astype(np.float64)
    for start in range(0, len(rows), _ROWS_AT_ONCE):
        part = slice(start, start + _ROWS_AT_ONCE)
        turn, shift = places[part, :, :3], places[part, :, 3]
        at_low, at_high = turn * corners[0], turn * corners[-1]
        margin = _MARGIN * (np.abs(turn) @ np.abs(corners).max(axis=0) + np.abs(shift))
        bounds[part, :3] = np.minimum(at_low, at_high).sum(axis=2) + shift - margin
        bounds[part, 3:] = np.maximum(at_low, at_high).sum(axis=2) + shift + margin
    if instants is not None and len(instants.moving):
        columns = {int(row): column for column, row in enumerate(instants.moving)}
        for k in np.flatnonzero(np.isin(tables.instances["owner"][rows], instants.moving)):
            bounds[k] = _swept(corners[None], _places(columns[int(tables.instances["owner"][rows[k]])], instants))[0]
    return bounds


def widen_moving(primitives: NDArray[np.void], bounds: NDArray[np.float32], tables: SceneTables, instants: Instants) -> None:
    """Widen the bounds of exact shapes that move; in place.

    Parameters
    ----------
    primitives : (n,) PRIMITIVE
    bounds : (n, 6) float32
    """
    columns = {int(row): column for column, row in enumerate(instants.moving)}
    owners = tables.instances["owner"][primitives["instance"]] if len(primitives) else np.zeros(0, dtype=np.int32)
    exact = (primitives["triangle"] < 0) & np.isin(owners, instants.moving)
    for row in np.unique(owners[exact]):
        mine = np.flatnonzero(exact & (owners == row))
        # The box that it has when the shutter opens goes with it.
        start = np.vstack([tables.instances[row]["world_from_object"].astype(np.float64), (0.0, 0.0, 0.0, 1.0)])
        bounds[mine] = _swept(box_corners(bounds[mine].astype(np.float64)), _places(columns[int(row)], instants) @ np.linalg.inv(start))


def _places(column: int, instants: Instants) -> NDArray[np.float64]:
    """(k, 3, 4): an instance's places at all instants."""
    return np.asarray(instants.instances[column :: len(instants.moving)]["world_from_object"].astype(np.float64))


def box_corners(boxes: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, 8, 3) float64: the corners of boxes (n, 6)."""
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
