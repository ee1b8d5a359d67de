"""A tree for every key of a mesh that bends while the shutter is open.

Between two keys each vertex goes straight, so a box round a part of the mesh at both keys holds that part all the way. One tree is made
over the boxes of all keys; then each key has a copy of it, with its own vertices, and with boxes that hold these and those of the next key:
a ray goes through the tree of the key that is past at its time, and mixes the vertices of a pack with those that stand in its place at the
next (Glassner, *Spacetime ray tracing for animation*, 1988, without his slabs). The trees have the same nodes and packs in the same order,
so that a number says how far it is from one to the next.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .batch import refit
from .layouts import CORNERS, KEY_NODES, KEY_PACKS, LINKS, NODE_WORDS, TAG_WORDS, Accelerator

__all__ = ["bounds_of_keys", "trees_of_keys"]

_MARGIN = np.float32(2.0**-20)  # what a mixed vertex may lie outside of both keys, by its greatest number


def trees_of_keys(tree: Accelerator, keys: Sequence[NDArray[np.float32]]) -> list[Accelerator]:
    """The tree of a mesh that bends, once for each key.

    Parameters
    ----------
    tree : Accelerator
        Of the mesh alone, with a root, over triangles only.
    keys : sequence of (n, 9) float32
        The corners of its n primitives at each key, in their order.
    """
    moved = [_at_key(tree, corners) for corners in keys]
    for now, later in pairwise(moved):
        _hold_both(now.nodes, later.nodes)
    for key in moved:
        root = key.nodes[:NODE_WORDS]
        root[KEY_NODES], root[KEY_PACKS] = len(tree.nodes) // NODE_WORDS, len(tree.tags) // TAG_WORDS
    return moved


def bounds_of_keys(trees: Sequence[Accelerator]) -> NDArray[np.float32]:
    """(6,) float32: the box of all keys."""
    boxes = np.stack([tree.nodes[CORNERS : CORNERS + 6].view(np.float32) for tree in trees])
    return np.concatenate([boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)])


def _at_key(tree: Accelerator, corners: NDArray[np.float32]) -> Accelerator:
    moved = tree._replace(nodes=tree.nodes.copy(), packs=tree.packs.copy())
    refit(moved, tree.primitives["triangle"], int(tree.primitives["triangle"].max()) + 1, corners)
    return moved


def _hold_both(now: NDArray[np.int32], later: NDArray[np.int32]) -> None:
    """Widen the boxes of one key so that they hold the next one's, too; in place."""
    a, b = (nodes.view(np.float32).reshape(-1, NODE_WORDS) for nodes in (now, later))
    for low, high in ((slice(0, LINKS // 2), slice(LINKS // 2, LINKS)), (slice(CORNERS, CORNERS + 3), slice(CORNERS + 3, CORNERS + 6))):
        rows = slice(None) if low.start == 0 else slice(1)
        lows, highs = np.minimum(a[rows, low], b[rows, low]), np.maximum(a[rows, high], b[rows, high])
        present = lows <= highs
        margin = _MARGIN * np.maximum(np.abs(lows), np.abs(highs), out=np.zeros_like(lows), where=present)
        a[rows, low], a[rows, high] = lows - margin, highs + margin
