"""What the acceleration structures hold."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array
from ..intersect.layouts import ENDS_WIDTH, MAX_LEAVES

__all__ = ["ACCELERATOR_ARRAYS", "ENDS_SHAPE", "FIRST_MOVING", "NODE", "PRIMITIVE", "STACK_SIZE", "Accelerator"]

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
        ("triangle", i32),  # of the instance's mesh; -1: the instance's sphere or plane; -2: its other exact shape; -3 - k: triangle k,
        # which moves, and has its corners in its object's space
        ("facing", i32),  # 0: both sides are seen; 1, -1: only the side from which it winds counter-clockwise, clockwise;
        # of an exact shape, 1: only the outside
        ("opaque", i32),  # 0: masked, blended or transparent
    ],
    align=True,
)

FIRST_MOVING = -3
"""What stands for triangle 0 where it moves; -3 - k for triangle k."""

STACK_SIZE = 96
"""Nodes that wait during a walk; the builder keeps trees shallower than this."""

ENDS_SHAPE = (MAX_LEAVES, ENDS_WIDTH)
"""Shape of the float64 scratch in which a walk counts where a ray is inside the leaves of a combination of solids."""


class Accelerator(NamedTuple):
    """A tree over the primitives of a scene, in world space.

    Kernels take it as a tuple of these four and a fifth, for what exact shapes need: (attributes, slots, ends), of the tables and of
    scratch memory; None where there are only triangles, spheres and planes (`accel.walk.exact_tables`).

    Attributes
    ----------
    nodes : (n,) NODE
        The root first; none: the primitives are tried one after the other.
    primitives : (m,) PRIMITIVE
        In the order of the leaves.
    corners : (m, 9) float32
        The vertices of the triangles among them.
    planes : (k,) PRIMITIVE
        What has no bounds, tried by every ray.
    """

    nodes: NDArray[np.void]
    primitives: NDArray[np.void]
    corners: NDArray[np.float32]
    planes: NDArray[np.void]


ACCELERATOR_ARRAYS = (Array(NODE, 1), Array(PRIMITIVE, 1), Array(np.float32, 2), Array(PRIMITIVE, 1))
"""The door arguments that an Accelerator unpacks to."""
