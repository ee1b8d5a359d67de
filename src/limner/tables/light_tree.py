"""A tree of the triangles that shine: which of ten thousand to ask is found by a dozen choices between two.

A lamp matters by its power, by how near it is, and by whether it shines this way. So triangles that lie near one another stand together,
and of every group of them is known how much power it has, the sphere that it lies in, and the cone in which its normals are; a kernel goes
down from the root, at every node to one of two by what they may be worth (`limner.shading.light_tree`).

The tree is a heap: the children of node k are 2k and 2k + 1, and leaf k of n is the row k - n of the emitters. Leaves stand in the order of
a curve that fills space, so that every node is a piece of it.

**Source**: A. Conty Estévez and C. Kulla, *Importance sampling of many lights with adaptive tree splitting*, HPG 2018, section 4; in place
of their cost, the order is that of G. Morton, *A computer oriented geodetic data base*, 1966, as no tree needs to be searched for then.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .layouts import NODE_NUMBERS

__all__ = ["is_scattered", "leaf_order", "tree_nodes"]

_BITS = 10
_SCATTERED = 16.0


def is_scattered(corners: NDArray[np.float64]) -> bool:
    """Whether triangles (n, 3, 3) are many lamps far apart, of which some matter here and others there, or rather one lamp in many pieces.

    One that is as good as solid is asked sooner, and as well, by its area alone. A square fills half of its diagonal's square, a sphere
    all of it, a tube ten times as long as wide a tenth.
    """
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    return bool(((high - low) ** 2).sum() > _SCATTERED * area)


def leaf_order(centres: NDArray[np.float64]) -> NDArray[np.int64]:
    """Which emitter stands at each leaf of the heap: neighbours in space at neighbouring leaves.

    Parameters
    ----------
    centres : (n, 3) float64

    Returns
    -------
    (n,) int64
        Emitters, from leaf n to leaf 2n - 1. The lowest leaves of a heap, which come first along the curve, have the highest numbers.
    """
    n = len(centres)
    low, extent = centres.min(axis=0), np.ptp(centres, axis=0)
    cells = ((centres - low) / np.where(extent > 0.0, extent, 1.0) * (2**_BITS - 1)).astype(np.int64)
    code = np.zeros(n, dtype=np.int64)
    for bit in range(_BITS):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    along = np.argsort(code, kind="stable")
    n_lowest = 2 * n - 2 ** int(np.log2(2 * n - 1))
    return np.concatenate([along[n_lowest:], along[:n_lowest]])


def tree_nodes(
    corners: NDArray[np.float64], normals: NDArray[np.float64], power: NDArray[np.float64], double_sided: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """The nodes of the heap, (2n, 9) float32; row 0 is none's.

    Of each the centre and the squared radius of a sphere round it, the axis and the cosine of the half angle of the cone that holds its
    normals (-1: all directions), and its power.

    Parameters
    ----------
    corners : (n, 3, 3) float64
        In the order of the leaves, as all that follow.
    normals : (n, 3) float64
    power : (n,) float64
    double_sided : (n,) bool
    """
    n = len(power)
    low, high = np.empty((2 * n, 3)), np.empty((2 * n, 3))
    axis, angle, total = np.zeros((2 * n, 3)), np.zeros(2 * n), np.zeros(2 * n)
    low[n:], high[n:] = corners.min(axis=1), corners.max(axis=1)
    axis[n:], angle[n:], total[n:] = normals, np.where(double_sided, np.pi, 0.0), power
    end = n
    while end > 1:
        # Nodes whose children are all made: those of one level, of the lowest perhaps two.
        first = (end + 1) // 2
        k = np.arange(first, end)
        a, b = 2 * k, 2 * k + 1
        low[k], high[k], total[k] = np.minimum(low[a], low[b]), np.maximum(high[a], high[b]), total[a] + total[b]
        mean = axis[a] * total[a, None] + axis[b] * total[b, None]
        size = np.linalg.norm(mean, axis=1)
        axis[k] = np.where(size[:, None] > 1e-9 * total[k, None], mean / np.where(size > 0.0, size, 1.0)[:, None], axis[a])
        spread = [angle[c] + np.arccos(np.clip((axis[k] * axis[c]).sum(axis=1), -1.0, 1.0)) for c in (a, b)]
        angle[k] = np.minimum(np.maximum(*spread), np.pi)
        end = first
    nodes = np.zeros((2 * n, NODE_NUMBERS), dtype=np.float32)
    low[0], high[0] = 0.0, 0.0
    nodes[:, :3], nodes[:, 3] = (low + high) * 0.5, ((high - low) ** 2).sum(axis=1) * 0.25
    nodes[:, 4:7], nodes[:, 7], nodes[:, 8] = axis, np.cos(angle), total / total[1]
    # A little wider, for the cosines of single precision
    nodes[:, 7] = np.maximum(nodes[:, 7] - 1e-4, -1.0)
    return nodes
