"""The plain hierarchy of bounding boxes (FoCG 12.3.2): half of the surfaces to the one side, half to the other.

Surfaces are put in order along an axis and divided in the middle, and the axis is the one for which the boxes of the two halves have
the least volume, taken together. It need not be a whole order: that the lesser half comes before the greater will do.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from .margins import boxes_of, whole_of

__all__ = ["DEEPEST", "TREE_NODE", "Ordering", "VolumeTree", "build_volume_tree"]

f32, i32 = np.float32, np.int32

Ordering = Literal["partition", "sort"]

TREE_NODE = np.dtype(
    [
        ("box", f32, 6),  # low corner, high corner
        ("first", i32),  # the first child, the second follows; of a leaf, the first of its items
        ("count", i32),  # items of a leaf; 0: no leaf
    ],
    align=True,
)

DEEPEST = 40  # halving 2^31 triangles does not get there

_BUILD = Door(
    "limner.accel.volume_tree_build",
    "build_halves",
    (Array(f32, 2), Array(i32, 1), Array(TREE_NODE, 1), Array(np.int64, 2), Scalar(np.int64), Array(np.int64, 1)),
    "the tree of least volumes",
)


class VolumeTree(NamedTuple):
    """A tree of bounding boxes over triangles.

    Attributes
    ----------
    bounds : (2, 3) float64
        Low and high corner of everything.
    nodes : (k,) TREE_NODE
        The root first.
    items : (n,) int32
        Rows of `corners`, leaf by leaf.
    corners : (n, 9) float32
    """

    bounds: NDArray[np.float64]
    nodes: NDArray[np.void]
    items: NDArray[np.int32]
    corners: NDArray[np.float32]


def build_volume_tree(corners: NDArray[np.float32], ordering: Ordering = "partition") -> VolumeTree:
    """Build the tree over triangles (n, 9) float32, all finite.

    Parameters
    ----------
    corners : (n, 9) float32
    ordering : "partition" | "sort"
        How the halves are found: partitioned only, in linear time, or sorted. The tree is the same.
    """
    boxes = boxes_of(corners)
    n = len(boxes)
    items = np.arange(n, dtype=i32)
    if n == 0:
        return VolumeTree(whole_of(boxes), np.zeros(0, dtype=TREE_NODE), items, corners)
    nodes = np.zeros(2 * n, dtype=TREE_NODE)
    used = np.zeros(1, dtype=np.int64)
    _BUILD(boxes, items, nodes, np.zeros((DEEPEST + 2, 3), dtype=np.int64), int(ordering == "sort"), used)
    return VolumeTree(whole_of(boxes), nodes[: used[0]].copy(), items, corners)
