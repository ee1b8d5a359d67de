"""A binary space partition along the axes (FoCG 12.3.4), often called a kd-tree: a plane cuts space in two, again and again.

Unlike boxes around surfaces, its parts never overlap: what a ray meets in the nearer one hides all in the farther. The price is that a
triangle on both sides of a plane is listed on both.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from .margins import boxes_of, whole_of

__all__ = ["BSP_NODE", "DEEPEST", "Bsp", "build_bsp"]

f32, i32 = np.float32, np.int32

BSP_NODE = np.dtype(
    [
        ("plane", f32),
        ("axis", i32),  # that the plane cuts; -1: a leaf
        ("first", i32),  # the child below the plane, the one above it follows; of a leaf, the first of its items
        ("count", i32),  # items of a leaf
    ],
    align=True,
)

DEEPEST = 62
_MOST_ITEMS = (4, 16, 64)  # a triangle, on average: the first that suffices; beyond the last, leaves are left as they are

_BUILD = Door(
    "limner.accel.bsp_build",
    "build_bsp_tree",
    (
        Array(f32, 2), Array(BSP_NODE, 1), Array(i32, 1), Array(i32, 1), Array(i32, 1), Array(np.int64, 2), Array(f32, 2),
        Array(i32, 2), Scalar(np.int64), Array(np.int64, 1),
    ),
    "the binary space partition",
)  # fmt: skip


class Bsp(NamedTuple):
    """A binary space partition over triangles.

    Attributes
    ----------
    bounds : (2, 3) float64
        Low and high corner.
    nodes : (k,) BSP_NODE
        The root first.
    items : (l,) int32
        Rows of `corners`, leaf by leaf.
    corners : (n, 9) float32
    """

    bounds: NDArray[np.float64]
    nodes: NDArray[np.void]
    items: NDArray[np.int32]
    corners: NDArray[np.float32]


def build_bsp(corners: NDArray[np.float32]) -> Bsp:
    """Cut the space of the triangles (n, 9) float32, all finite, where the surface area heuristic expects a ray to have the least to do.

    Candidates are 33 planes along each axis between the ends of the triangles' boxes, the ends among them, which cut off empty space.

    **Source**: MacDonald and Booth, *Heuristics for ray tracing using space subdivision*, 1990; the bonus of empty space and the depth,
    ``8 + 1.3 log2 n``, are those of Pharr, Jakob and Humphreys, *Physically Based Rendering*, 3rd edition 2016, 4.4.
    """
    boxes = boxes_of(corners)
    bounds = whole_of(boxes)
    n = len(boxes)
    if n == 0:
        leaf = np.zeros(1, dtype=BSP_NODE)
        leaf["axis"] = -1
        return Bsp(bounds, leaf, np.zeros(0, dtype=i32), corners)
    for most in _MOST_ITEMS:
        nodes, items, n_crowded = _cut(boxes, bounds, most * n)
        if n_crowded == 0:
            break
    return Bsp(bounds, nodes.copy(), items.copy(), corners)


def _cut(boxes: NDArray[np.float32], bounds: NDArray[np.float64], most: int) -> tuple[NDArray[np.void], NDArray[np.int32], int]:
    """Nodes and items, of which there is room for so many; and how many leaves suffer from that."""
    n = len(boxes)
    nodes = np.empty(2 * most + 1, dtype=BSP_NODE)
    items, lists, aside = np.empty(most, dtype=i32), np.empty(most, dtype=i32), np.empty(n, dtype=i32)
    room = np.zeros((DEEPEST + 2, 6), dtype=f32)
    room[0] = bounds.reshape(-1)
    stack, bins, used = np.zeros((DEEPEST + 2, 4), dtype=np.int64), np.zeros((2, 32), dtype=i32), np.zeros(3, dtype=np.int64)
    _BUILD(boxes, nodes, lists, aside, items, stack, room, bins, min(DEEPEST, int(8 + 1.3 * math.log2(n))), used)
    return nodes[: used[0]], items[: used[1]], int(used[2])
