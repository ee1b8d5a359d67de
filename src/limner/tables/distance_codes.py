r"""The instructions that fields of distances are made of, as numbers: what `limner.tables.distance` writes and kernels read.

An instruction is its code, how many numbers it has in all, and those that it needs:

| code | numbers | what it does |
|---|---|---|
| BALL … JULIA | of the leaf (`intersect.distance_leaves`) | puts its distance at the point on the stack |
| JOIN, COMMON, WITHOUT | radius | of the two distances on top makes one |
| GROW | amount | subtracts it |
| WALLS | half thickness | of \|d\| |
| PLACE | (3, 4) matrix | keeps the point, goes on with M p |
| FOLD | 0 or 1 for each axis | keeps the point, goes on with \|p\| |
| STRETCH | amounts | keeps the point, goes on with what of p is beyond them |
| TURN | angle per unit, radius | keeps the point, goes on with p turned about +y |
| TILE | spacing, first, last, start | keeps the point, goes on with it in its cell, every other one mirrored |
| LEAVE | factor | scales the distance, goes back to the point that was kept |
| REPEAT | spacing, first, last, start, middle, half | keeps the point, goes on with it as the nearest copy sees it |
| AGAIN | length of what is repeated | keeps the least distance; goes on with the next copy after REPEAT, or goes back to the point |

Two heights of a stack count: distances, and points that are kept.
"""

from __future__ import annotations

__all__ = [
    "AGAIN", "BALL", "BLOCK", "COMMON", "CONE", "CYLINDER", "ELLIPSOID", "FIRST_JOINING", "FIRST_MOVING", "FOLD", "GROW", "GYROID",
    "HEADER", "HIGH", "JOIN", "JULIA", "LEAVE", "LENGTH", "LOW", "OCTAHEDRON", "PLACE", "PLANE", "REPEAT", "RING", "SEGMENT", "SLOPE",
    "SPONGE", "STRETCH", "TILE", "TURN", "WALLS", "WITHOUT",
]  # fmt: skip

LOW, HIGH, SLOPE, LENGTH, HEADER = 0, 3, 6, 7, 8
"""Where the corners, the slope's bound and the program's length stand, and where the program begins."""

BALL, BLOCK, RING, SEGMENT, CYLINDER, CONE, PLANE, ELLIPSOID, OCTAHEDRON, GYROID, SPONGE, JULIA = range(12)
JOIN, COMMON, WITHOUT, GROW, WALLS = range(12, 17)
PLACE, FOLD, STRETCH, TURN, TILE, REPEAT, LEAVE, AGAIN = range(17, 25)
FIRST_JOINING, FIRST_MOVING = JOIN, PLACE
