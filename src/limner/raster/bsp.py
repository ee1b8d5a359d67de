"""A BSP tree over a scene's triangles (FoCG 12.4): one tree, and from it a back-to-front order for every place of the eye.

    tree = bsp.build(world_triangles(tables))
    fragments = bsp.back_to_front(tree, eye)

Triangles that no plane separates (they pierce each other, or overlap in a circle) are cut along the planes of others, so that an order
exists. The planes are the triangles' own; which one divides a node is the best of a few candidates, chosen without chance.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..tables.layouts import SceneTables

__all__ = ["MAX_FRAGMENTS", "BspTree", "back_to_front", "build", "world_triangles"]

MAX_FRAGMENTS = 1 << 20
"""What triangles may be cut into at most."""

_TOLERANCE = 2.0**-24  # of the greatest coordinate: what float32 positions cannot tell apart lies in one plane

_BUILD = Door(
    "limner.raster.bsp_kernel",
    "build_tree",
    (
        Array(np.float64, 3), Array(np.float64, 2), Array(np.float64, 1), Scalar(np.float64), Array(np.float64, 2), Array(np.int32, 2),
        Array(np.int32, 2), Array(np.int32, 2), Array(np.int32, 2), Array(np.int64, 1),
    ),
    "the painter's tree",
)  # fmt: skip

_WALK = Door(
    "limner.raster.bsp_kernel",
    "walk_tree",
    (
        Array(np.int32, 2), Array(np.int32, 2), Array(np.float64, 2), Array(np.float64, 1), Array(np.int32, 2), Array(np.int32, 1),
        Array(np.int64, 1),
    ),
    "the painter's order",
)  # fmt: skip


class BspTree(NamedTuple):
    """A tree over triangles; `limner.raster.bsp_kernel` names the columns.

    Attributes
    ----------
    triangles : (n, 3, 3) float64
        World space.
    planes : (n, 4) float64
        Of each triangle, with a unit normal.
    members : (n,) int64
        Which of the triangles that were given these are: those without area are left out.
    points : (p, 3) float64
        Vertices of the fragments.
    fragments : (f, 6) int32
    cuts : (c, 3) int32
    nodes : (m, 4) int32
    """

    triangles: NDArray[np.float64]
    planes: NDArray[np.float64]
    members: NDArray[np.int64]
    points: NDArray[np.float64]
    fragments: NDArray[np.int32]
    cuts: NDArray[np.int32]
    nodes: NDArray[np.int32]


def world_triangles(tables: SceneTables) -> NDArray[np.float64]:
    """(n, 3, 3) float64: all triangles of all instances in world space, instance by instance."""
    parts = [np.zeros((0, 3, 3))]
    for instance in tables.instances:
        if instance["mesh"] < 0:
            continue
        mesh = tables.meshes[instance["mesh"]]
        first, n = int(mesh["triangle"]), int(mesh["n_triangles"])
        positions = tables.positions[mesh["position"] : mesh["position"] + mesh["n_positions"]].astype(np.float64)
        matrix = instance["world_from_object"].astype(np.float64)
        parts.append((positions @ matrix[:, :3].T + matrix[:, 3])[tables.triangles[first : first + n]])
    return np.concatenate(parts)


@np.errstate(all="ignore")
def build(triangles: NDArray[np.float64]) -> BspTree | None:
    """The tree over (n, 3, 3) triangles; None if they would be cut into more than `MAX_FRAGMENTS`."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    members = np.flatnonzero((areas > 0.0) & np.isfinite(areas))
    triangles, areas = np.ascontiguousarray(triangles[members]), areas[members]
    normals = normals[members] / areas[:, None]
    planes = np.column_stack([normals, -np.einsum("ij,ij->i", normals, triangles[:, 0])])
    tolerance = _TOLERANCE * float(np.abs(triangles).max(initial=0.0))
    capacity = 2 * len(triangles) + 64
    while True:
        points, cuts = np.empty((8 * capacity, 3)), np.empty((2 * capacity, 3), dtype=np.int32)
        fragments, nodes = np.empty((capacity, 6), dtype=np.int32), np.empty((capacity, 4), dtype=np.int32)
        used = np.zeros(5, dtype=np.int64)
        stack = np.empty((capacity + 1, 3), dtype=np.int32)
        _BUILD(triangles, planes, areas, tolerance, points, fragments, cuts, nodes, stack, used)
        if not used[4]:
            break
        if capacity >= MAX_FRAGMENTS:
            return None
        capacity = min(4 * capacity, MAX_FRAGMENTS)
    n_points, n_fragments, n_cuts, n_nodes = used[:4].tolist()
    return BspTree(
        triangles, planes, members, points[:n_points].copy(), fragments[:n_fragments].copy(), cuts[:n_cuts].copy(), nodes[:n_nodes].copy()
    )


def back_to_front(tree: BspTree, eye: NDArray[np.float64]) -> NDArray[np.int32]:
    """Rows of the tree's fragments in an order in which none hides one that comes later.

    Parameters
    ----------
    eye : (4,) float64
        (x, y, z, 1), or for parallel projection (direction to the eye, 0).
    """
    order, used = np.empty(len(tree.fragments), dtype=np.int32), np.zeros(1, dtype=np.int64)
    stack = np.empty((2 * len(tree.nodes) + 2, 2), dtype=np.int32)
    _WALK(tree.nodes, tree.fragments, tree.planes, np.ascontiguousarray(eye, dtype=np.float64), stack, order, used)
    return order[: used[0]]
