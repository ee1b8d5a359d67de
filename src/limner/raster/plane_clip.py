"""Clipping before the transform (FoCG 8.1.4, 8.1.6): a polygon in world space against the planes of the viewing pyramid.

Where an edge crosses a plane ``f(p) = n · p + d`` it is cut at ``t = f(a) / (f(a) - f(b))``, and everything that its ends carry is cut at
the same t. A polygon's row is x, y, z and then its attributes; a triangle carries its barycentric coordinates, from which all others
follow. Float64, because a floor may reach a thousand times as far as the picture is wide.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

__all__ = ["clip_polygon_to_plane", "clip_triangle_to_planes", "signed_distance"]

_ZERO = np.float64(0.0)


@kernel
def signed_distance(planes, plane: int, points, row: int) -> np.float64:
    """n · p + d: positive on the inner side."""
    return planes[plane, 0] * points[row, 0] + planes[plane, 1] * points[row, 1] + planes[plane, 2] * points[row, 2] + planes[plane, 3]


@kernel
def clip_polygon_to_plane(source, n: int, target, planes, plane: int) -> int:
    """Copy the part of a convex polygon inside a plane, attributes and all (Sutherland and Hodgman 1974). Returns how many vertices."""
    count = 0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        fa, fb = signed_distance(planes, plane, source, i), signed_distance(planes, plane, source, j)
        if fa >= _ZERO:
            for c in range(source.shape[1]):
                target[count, c] = source[i, c]
            count += 1
        if (fa >= _ZERO) != (fb >= _ZERO):
            # Always from the inner end: the neighbour that runs along this edge the other way must find the very same point.
            inner, outer = (i, j) if fa >= _ZERO else (j, i)
            t = fa / (fa - fb) if fa >= _ZERO else fb / (fb - fa)
            for c in range(source.shape[1]):
                target[count, c] = source[inner, c] + t * (source[outer, c] - source[inner, c])
            count += 1
    return count


@kernel
def clip_triangle_to_planes(polygon, scratch, planes) -> int:
    """Clip the triangle in the first three rows of `polygon` in place. Returns its number of vertices, 0 if nothing is left.

    A plane that has all vertices inside costs three dot products; one that has all outside ends the work.
    """
    n = 3
    for plane in range(planes.shape[0]):
        inside = 0
        for i in range(n):
            inside += 1 if signed_distance(planes, plane, polygon, i) >= _ZERO else 0
        if inside == 0:
            return 0
        if inside < n:
            n = clip_polygon_to_plane(polygon, n, scratch, planes, plane)
            for i in range(n):
                for c in range(polygon.shape[1]):
                    polygon[i, c] = scratch[i, c]
    return n
