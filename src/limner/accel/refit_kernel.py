"""The kernel behind `RayCaster.refit`: new corners for the triangles of a tree, new boxes round them, the tree as it is."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import as_float, as_int
from .layouts import CORNERS, LINKS, NODE_WORDS, PACK_WORDS, TAG_WORDS

__all__ = ["refit"]

f32 = np.float32
_INFINITY = f32(np.inf)


@kernel
def _move_triangles(packs, tags, rows, corners):
    """Write the new corners into the packs; a place without a triangle holds NaN."""
    for pack in range(packs.shape[0] // PACK_WORDS):
        for i in range(8):
            if packs[PACK_WORDS * pack + i] == packs[PACK_WORDS * pack + i]:
                row = rows[tags[TAG_WORDS * pack + 8 + i]]
                for c in range(9):
                    packs[PACK_WORDS * pack + 8 * c + i] = corners[row, c]


@kernel
def _edge_of_pack(packs, pack: int, edge: int) -> np.float32:
    """One of the six edges of the box round a pack: low x, y, z, high x, y, z."""
    axis, is_low = edge % 3, edge < 3
    bound = _INFINITY if is_low else -_INFINITY
    for corner in range(3):
        for i in range(8):
            x = packs[PACK_WORDS * pack + 8 * (3 * corner + axis) + i]
            # Written so that NaN, where there is no triangle, is passed over.
            if (is_low and x < bound) or (not is_low and x > bound):
                bound = x
    return bound


@kernel
def _edge_of_node(nodes, node: int, edge: int) -> np.float32:
    """The same of all that is below a node."""
    bound = _INFINITY if edge < 3 else -_INFINITY
    for i in range(8):
        x = as_float(nodes[NODE_WORDS * node + 8 * edge + i])
        bound = min(bound, x) if edge < 3 else max(bound, x)
    return bound


@kernel
def refit(nodes, packs, tags, rows, corners):
    """Move the triangles of a tree of triangles alone, and its boxes with them.

    `rows`: where the triangle of a number stands in `corners` (n, 9). A node stands behind its parent, so from the last to the first all
    that is below a node is ready when its turn comes.
    """
    _move_triangles(packs, tags, rows, corners)
    n_nodes = nodes.shape[0] // NODE_WORDS
    for node in range(n_nodes - 1, -1, -1):
        for i in range(8):
            place = NODE_WORDS * node + i
            link = np.int64(nodes[place + LINKS])
            if as_float(nodes[place]) < _INFINITY:
                for edge in range(6):
                    bound = _edge_of_node(nodes, link, edge) if link >= 0 else _edge_of_pack(packs, (-1 - link) >> 1, edge)
                    nodes[place + 8 * edge] = as_int(bound)
    if n_nodes > 0:
        for edge in range(6):
            nodes[CORNERS + edge] = as_int(_edge_of_node(nodes, 0, edge))
