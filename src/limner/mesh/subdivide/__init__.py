"""Smooth surfaces as the limits of meshes that are divided again and again (FoCG 12.1, 15).

    loop            triangles into four; the box splines of the three directions where six meet       (Loop 1987)
    catmull_clark   polygons into quadrilaterals; bicubic B-splines where four meet                   (Catmull and Clark 1978)
    sqrt3           triangles into three, turned; the slowest growth, nine triangles in two steps     (Kobbelt 2000)

A new vertex is a mean of old ones with published weights, so every scheme is a few sums over the mesh's edges. Vertices are shared
before and after: what was closed stays closed.
"""

from __future__ import annotations

from .catmull_clark_rule import catmull_clark
from .loop_rule import loop
from .sqrt3_rule import sqrt3

__all__ = ["catmull_clark", "loop", "sqrt3"]
