"""Kinds of exact shapes and what kernels read of them, beside `tables.layouts`.

A shape is a row with a kind, its transforms and three numbers of `size`; what needs more has its `place` in a float32 array `numbers`:

| kind | canonical space | size | numbers | a solid |
|---|---|---|---|---|
| SPHERE | around the origin | radius | | yes |
| PLANE | y = 0, front +y | | | y <= 0 |
| BOX | around the origin | half edges | | yes |
| DISK | y = 0, front +y | radius | | no |
| CYLINDER | about +y, y from -h/2 to h/2 | radius, h | | if capped |
| CONE | the same | radius at -h/2, radius at h/2, h | | if capped |
| TORUS | about +y | radius R of the circle, radius r of the tube | | yes |
| QUADRIC | its box's | | ten coefficients, low and high corner | if capped |
| PATCH | its corners' | | four corners | no |
| CSG | the world | | | yes |

Constructive solid geometry (`intersect.csg`): a CSG shape's `place` is a row of `solids`, and that names its leaves, consecutive rows of
shapes with transforms from the world, and its program, a stretch of `programs`. A program is postfix, one int32 a token: k >= 0 is the
solid's leaf k, a negative number an operation on what came before.

    sphere - (box | torus)         ->         0  1  2  UNION  DIFFERENCE

A leaf carries its own transform, complete, so that a world ray is taken to it in one step, and its own material: it is a shape like
any other except that no tree holds it.
"""

from __future__ import annotations

import numpy as np

from ..tables.layouts import BOX, MESH, PLANE, SPHERE

__all__ = [
    "BOX", "COMPLEMENT", "CONE", "CSG", "CYLINDER", "DIFFERENCE", "DISK", "ENDS_WIDTH", "INTERSECTION", "MAX_LEAVES", "MESH", "PATCH",
    "PLANE", "QUADRIC", "SHAPE", "SOLID", "SPHERE", "TORUS", "UNION",
]  # fmt: skip

f32, i32 = np.float32, np.int32

# Kinds of geometry, after those of tables.layouts
DISK, CYLINDER, CONE, TORUS, QUADRIC, PATCH, CSG = 4, 5, 6, 7, 8, 9, 10

# Operations of a program: on the two sets before it, or, the last one, on one
UNION, INTERSECTION, DIFFERENCE, COMPLEMENT = -1, -2, -3, -4

MAX_LEAVES = 62
"""Leaves of one solid: as many as an int64 has bits to tell which of them a point is in, and some to spare."""

ENDS_WIDTH = 6
"""Columns of the float64 scratch of `intersect_csg`, which has a row for each leaf."""

SHAPE = np.dtype(
    [
        ("world_from_object", f32, (3, 4)),
        ("object_from_world", f32, (3, 4)),
        ("size", f32, 3),
        ("kind", i32),
        ("capped", i32),  # 0: a cylinder, cone or quadric without caps
        ("place", i32),  # QUADRIC, PATCH: in numbers; CSG: row of solids; else -1
    ],
    align=True,
)

SOLID = np.dtype(
    [
        ("leaf", i32),  # first of its leaves, rows of shapes
        ("n_leaves", i32),
        ("program", i32),  # place in programs
        ("n_program", i32),
    ],
    align=True,
)
