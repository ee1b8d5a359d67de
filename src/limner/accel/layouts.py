"""What the acceleration structures hold."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array
from ..intersect.layouts import ENDS_WIDTH, MAX_LEAVES

__all__ = [
    "ACCELERATOR_ARRAYS", "BLOCK", "BLOCK_INTEGERS", "BLOCK_NUMBERS", "BLOCK_PLACES", "CORNERS", "ENDS_SHAPE", "ENTRIES", "FIRST_TREE",
    "KEY_NODES", "KEY_PACKS", "LINKS", "MAX_DEPTH", "NODE", "NODE_WORDS", "NOT_OPAQUE", "NOT_PLAIN", "ONLY_BACK", "ONLY_FRONT",
    "PACK_WORDS", "PRIMITIVE", "STACKS", "STACK_SIZE", "TAG_WORDS", "TREE_LINK", "WAITING", "Accelerator",
]  # fmt: skip

f32, i32 = np.float32, np.int32

NODE = np.dtype(
    [
        ("box", f32, 12),  # low and high corner of the left child, then of the right
        ("child", i32, 2),  # >= 0: a node; < 0: the leaf that begins at primitive -1 - child
        ("count", i32, 2),  # primitives of a leaf
    ],
    align=True,
)

PRIMITIVE = np.dtype(
    [
        ("instance", i32),
        ("triangle", i32),  # of the instance's mesh; -1: the instance's sphere or plane; -2: its other exact shape; -3 - k: its mesh,
        # of which a tree in its own space begins at node k
        ("facing", i32),  # 0: both sides are seen; 1, -1: only the side from which it winds counter-clockwise, clockwise;
        # of an exact shape, 1: only the outside
        ("opaque", i32),  # 0: masked, blended or transparent
    ],
    align=True,
)

FIRST_TREE = -3
"""What stands in the place of a triangle for the tree that begins at node 0; -3 - k for node k."""

TREE_LINK = -(1 << 30)
"""The link to the tree of primitive 0; less k to that of primitive k."""

MAX_DEPTH = 64
"""Of the tree of two children each that the builder makes before it is widened."""

STACK_SIZE = 2 * 2 * (7 * MAX_DEPTH + 8)
"""Room for what waits during a walk, two words each: seven children of every node on the way down, in the world and then in a mesh."""

BLOCK = 64
"""So many rays of a batch are made ready, and followed, at a time (`accel.ray_block`)."""

BLOCK_NUMBERS, BLOCK_INTEGERS, BLOCK_PLACES = 26 * BLOCK, 7 * BLOCK, 2 * BLOCK
"""Room for them, float32, int32 and float64."""

WAITING = 7 * MAX_DEPTH + 16
"""Room for what waits while one of them is followed, and for eight more."""

ENTRIES = BLOCK * WAITING + 528
"""Where the words begin that say where the ray enters, behind the links; not whole pages away, which the processor takes for one place."""

STACKS = ENTRIES + BLOCK * WAITING
"""Room for all that waits while a block is followed, int32."""

ENDS_SHAPE = (MAX_LEAVES, ENDS_WIDTH)
"""Shape of the float64 scratch in which a walk counts where a ray is inside the leaves of a combination of solids."""


class Accelerator(NamedTuple):
    """A tree over the primitives of a scene, in world space, and trees of meshes in their own.

    What many instances share, and what moves, is one primitive of the world's tree: rays that meet its box are taken to its space, and go
    through its tree, of which there is one for all. The trees stand one after the other, the world's first.

    Eight boxes are met at once, and eight triangles: what a node or a pack has eight of stands side by side, as registers want it.

    Kernels take it as a tuple of these five and a sixth, for what exact shapes need: (attributes, slots, ends), of the tables and of
    scratch memory; None where there are only triangles, spheres and planes (`accel.walk.exact_tables`).

    Attributes
    ----------
    nodes : (64 n,) int32
        Of each node, the root first, as bits of float32: eight low x of its children's boxes, eight low y, low z, high x, high y, high z,
        infinity and -infinity for children that there are not; then eight links, >= 0 a node, < 0 a pack: -1 - 2 pack, less 1 where
        not all of it are triangles, or the tree of a primitive: TREE_LINK - its row; then, of a root alone, the low and the high corner
        of everything; then, of a root of a mesh that bends, how many nodes and how many packs further on the next key's are, of which
        the one's boxes hold the other's triangles, too. No nodes: the packs are tried one after the other.
    packs : (72 m,) float32
        Of each pack, eight x of the first vertex, eight y, eight z, those of the second and of the third; NaN where there is no triangle.
    tags : (16 m,) int32
        Of each of its eight: 16 times the instance (0 in a mesh's own tree), and the bits ONLY_FRONT, ONLY_BACK, NOT_OPAQUE,
        NOT_PLAIN; then eight numbers of triangles, or of what is not plain the row of `primitives`.
    primitives : (k,) PRIMITIVE
    planes : (l,) PRIMITIVE
        What has no bounds, tried by every ray.
    """

    nodes: NDArray[np.int32]
    packs: NDArray[np.float32]
    tags: NDArray[np.int32]
    primitives: NDArray[np.void]
    planes: NDArray[np.void]


NODE_WORDS, LINKS, CORNERS, KEY_NODES, KEY_PACKS, PACK_WORDS, TAG_WORDS = 64, 48, 56, 62, 63, 72, 16

# What a pack says of its primitives
ONLY_FRONT, ONLY_BACK, NOT_OPAQUE, NOT_PLAIN = 1, 2, 4, 8

ACCELERATOR_ARRAYS = (
    Array(np.int32, 1), Array(np.float32, 1), Array(np.int32, 1), Array(PRIMITIVE, 1), Array(PRIMITIVE, 1),
)  # fmt: skip
"""The door arguments that an Accelerator unpacks to."""
