"""Points of eight flat triangles at once, each of an instance of its own: `limner.shading.surface`, bit for bit.

A hit's surface point waits for one look-up after another: the instance, its mesh, the triangle, its vertices. Of eight hits the look-ups go
side by side. What an instance says comes as rows of plain numbers (`limner.tables.facets`).
"""

from __future__ import annotations

from typing import NamedTuple

from .._jit import kernel
from ..kernel.lanes import at, f32x8, i32x8, max, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot, normalize
from ..tables.facets import COLOR, FIRST_POSITION, FIRST_TRIANGLE, WORLD_FROM_NORMAL, WORLD_FROM_OBJECT

__all__ = ["Facets", "facets_at"]


class Facets(NamedTuple):
    """Eight surface points, their unit normals on the side that is seen."""

    position: Vec3
    n: Vec3
    paint: Color
    reach: f32x8


@kernel
def _vertex(positions, row: i32x8) -> Vec3:
    return Vec3(at(positions, (row, 0)), at(positions, (row, 1)), at(positions, (row, 2)))


@kernel
def _numbers(numbers, instance: i32x8, column: int) -> Vec3:
    return Vec3(at(numbers, (instance, column)), at(numbers, (instance, column + 1)), at(numbers, (instance, column + 2)))


@kernel
def _row_reach(row: Vec3, along: f32x8, x: f32x8, y: f32x8, z: f32x8) -> f32x8:
    return abs(row.x) * x + abs(row.y) * y + abs(row.z) * z + abs(along)


@kernel
def _greatest(a: f32x8, b: f32x8, c: f32x8) -> f32x8:
    return max(abs(a), max(abs(b), abs(c)))


@kernel
def facets_at(positions, triangles, numbers, places, instance: i32x8, triangle: i32x8, u: f32x8, v: f32x8, wo: Vec3) -> Facets:
    """`surface_at` for eight hits that are seen from wo, turned as by `flip_to_front`; every index must be one that there is."""
    row, start = triangle + at(places, (instance, FIRST_TRIANGLE)), at(places, (instance, FIRST_POSITION))
    o0 = _vertex(positions, start + at(triangles, (row, 0)))
    o1 = _vertex(positions, start + at(triangles, (row, 1)))
    o2 = _vertex(positions, start + at(triangles, (row, 2)))
    x, y, z = _greatest(o0.x, o1.x, o2.x), _greatest(o0.y, o1.y, o2.y), _greatest(o0.z, o1.z, o2.z)
    p = o0 * ((ONE - u) - v) + o1 * u + o2 * v
    row0, along0 = _numbers(numbers, instance, WORLD_FROM_OBJECT), at(numbers, (instance, WORLD_FROM_OBJECT + 3))
    row1, along1 = _numbers(numbers, instance, WORLD_FROM_OBJECT + 4), at(numbers, (instance, WORLD_FROM_OBJECT + 7))
    row2, along2 = _numbers(numbers, instance, WORLD_FROM_OBJECT + 8), at(numbers, (instance, WORLD_FROM_OBJECT + 11))
    position = Vec3(dot(row0, p) + along0, dot(row1, p) + along1, dot(row2, p) + along2)
    reach = max(_row_reach(row0, along0, x, y, z), max(_row_reach(row1, along1, x, y, z), _row_reach(row2, along2, x, y, z)))
    outward = cross(o1 - o0, o2 - o0)
    n0, n1 = _numbers(numbers, instance, WORLD_FROM_NORMAL), _numbers(numbers, instance, WORLD_FROM_NORMAL + 3)
    n2 = _numbers(numbers, instance, WORLD_FROM_NORMAL + 6)
    n = normalize(Vec3(dot(n0, outward), dot(n1, outward), dot(n2, outward)))
    n = where(dot(n, wo) >= ZERO, n, -n)
    paint = _numbers(numbers, instance, COLOR)
    return Facets(position, n, Color(paint.x, paint.y, paint.z), reach)
