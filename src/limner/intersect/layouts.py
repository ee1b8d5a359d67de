"""What kernels read of exact shapes: rows of `tables.layouts.INSTANCE`, and what a kind means by the fields of its row.

A shape has a kind, its transforms and three numbers of `size`; what needs more has its `place` in a float32 array `numbers` (the tables'
`attributes`):

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
| DISTANCE_FIELD | its box's | | box, slope, program (`tables.distance`) | yes |

Constructive solid geometry (`intersect.csg`): a CSG shape names its leaves, consecutive rows of shapes with transforms from the world, and
its program, a stretch of `programs` (the tables' `slots`) that begins at its `place`. A program is postfix, one int32 a token: k >= 0 is
the solid's leaf k, a negative number an operation on what came before.

    sphere - (box | torus)         ->         0  1  2  UNION  DIFFERENCE

A leaf carries its own transform, complete, so that a world ray is taken to it in one step, and its own material: it is a shape like
any other except that no tree holds it, and that its `owner` is the combination.

Nothing here imports a kernel: the host reads it, too.
"""

from __future__ import annotations

from ..tables.layouts import (
    BOX,
    COMPLEMENT,
    CONE,
    CSG,
    CYLINDER,
    DIFFERENCE,
    DISK,
    DISTANCE_FIELD,
    INTERSECTION,
    MAX_LEAVES,
    MESH,
    PATCH,
    PLANE,
    QUADRIC,
    SPHERE,
    TORUS,
    UNION,
)

__all__ = [
    "BOX", "COMPLEMENT", "CONE", "CSG", "CYLINDER", "DIFFERENCE", "DISK", "DISTANCE_FIELD", "ENDS_WIDTH", "INTERSECTION", "MAX_LEAVES",
    "MESH", "PATCH", "PLANE", "QUADRIC", "SPHERE", "TORUS", "UNION",
]  # fmt: skip

ENDS_WIDTH = 6
"""Columns of the float64 scratch of `intersect_csg`, which has a row for each leaf."""
