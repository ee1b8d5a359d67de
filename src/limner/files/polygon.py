"""Cutting polygons into triangles (FoCG 12.1 knows triangles only).

A convex polygon is a fan round its first corner. Of a polygon that is not convex ears are clipped: a corner whose triangle
lies inside and holds no other corner is cut off, until a triangle is left.

           2          a quadrilateral 0 1 2 3 with a notch at 1:
         .'/          the fan round 0 cuts along 0-2, which lies outside,
        3 1           the diagonal 1-3 lies inside
         '.\\
           0

**Source**: G. H. Meisters, *Polygons have ears*, The American Mathematical Monthly 82 (1975); M. Newell's plane from the
areas of the projections (Sutherland, Sproull, Schumacker, *A Characterization of Ten Hidden-Surface Algorithms*, 1974).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["MAX_CLIPPED_CORNERS", "triangulate"]

# Clipping takes quadratic time; a larger polygon that is not convex becomes a fan.
MAX_CLIPPED_CORNERS = 512
_WORK = 20_000_000

Points = NDArray[np.float64]
Indices = NDArray[np.int64]


def triangulate(polygons: Points) -> tuple[Indices, int]:
    """Cut polygons that all have the same number of corners.

    Parameters
    ----------
    polygons : (n, k, 3) float64, k >= 3
        The corners in order; nearly planar.

    Returns
    -------
    triangles : (n, k - 2, 3) int64
        Corners by their number in the polygon, turning as the polygon does.
    n_fans : int
        How many polygons were too large to clip, and may be wrong.

    >>> triangulate(np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=float))[0].tolist()
    [[[0, 1, 2], [0, 2, 3]]]
    """
    n, k = polygons.shape[:2]
    first = np.arange(1, k - 1)
    triangles = np.tile(np.stack([np.zeros_like(first), first, first + 1], axis=1), (n, 1, 1))
    if k == 3 or n == 0:
        return triangles, 0
    with np.errstate(all="ignore"):
        normals = _newell_normals(polygons)
        inward = np.roll(polygons, 1, axis=1) - polygons
        outward = np.roll(polygons, -1, axis=1) - polygons
        turns = np.einsum("nkc,nc->nk", np.cross(outward, inward), normals)
    reflex = turns < 0.0
    if k == 4:
        # The diagonal must start at the reflex corner, where there is one.
        triangles[reflex[:, 1] | reflex[:, 3]] = np.array([[0, 1, 3], [1, 2, 3]])
        return triangles, 0
    n_fans, work = 0, _WORK
    for index in np.flatnonzero(reflex.any(axis=1) | (_winding(polygons, normals) > 1.5)):
        work -= k * k
        if k > MAX_CLIPPED_CORNERS or work < 0:
            n_fans += 1
        else:
            triangles[index] = _clip_ears(_flatten(polygons[index], normals[index]))
    return triangles, n_fans


def _newell_normals(polygons: Points) -> Points:
    local = polygons - polygons[:, :1]
    return np.cross(local, np.roll(local, -1, axis=1)).sum(axis=1)


def _winding(polygons: Points, normals: Points) -> Points:
    """How often each polygon turns round: 1 for a simple one; a star whose corners all turn left has more."""
    with np.errstate(all="ignore"):
        edges = np.roll(polygons, -1, axis=1) - polygons
        following = np.roll(edges, -1, axis=1)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        unit = normals / np.where(length > 0.0, length, 1.0)
        sines = np.einsum("nkc,nc->nk", np.cross(edges, following), unit)
        cosines = np.einsum("nkc,nkc->nk", edges, following)
        turned: Points = np.arctan2(sines, cosines).sum(axis=1) / (2.0 * np.pi)
    return turned


def _flatten(polygon: Points, normal: Points) -> Points:
    """Leave out the axis along which the polygon's plane is seen best; keep its sense of turning."""
    axis = int(np.argmax(np.abs(normal)))
    kept = [(1, 2), (2, 0), (0, 1)][axis]
    flat = polygon[:, kept]
    return flat if normal[axis] >= 0.0 else flat[:, ::-1]


def _clip_ears(flat: Points) -> Indices:
    """Clip the ears of one polygon in the plane, counter-clockwise, (k, 2); a bad one still gives k - 2 triangles."""
    corners = list(range(len(flat)))
    points = [(float(x), float(y)) for x, y in flat]
    triangles: list[tuple[int, int, int]] = []
    start = 0
    while len(corners) > 3:
        n = len(corners)
        # Begin where the last ear was: neighbours of an ear often are ears, and slivers do not pile up at corner 0.
        order = [(start + step) % n for step in range(n)]
        at = next((i for i in order if _is_ear(points, corners, i)), order[0])
        triangles.append((corners[at - 1], corners[at], corners[(at + 1) % n]))
        del corners[at]
        start = at % (n - 1)
    triangles.append((corners[0], corners[1], corners[2]))
    return np.array(triangles, dtype=np.int64)


def _is_ear(points: list[tuple[float, float]], corners: list[int], at: int) -> bool:
    before, tip, after = corners[at - 1], corners[at], corners[(at + 1) % len(corners)]
    a, b, c = points[before], points[tip], points[after]
    if _area(a, b, c) <= 0.0:
        return False
    for other in corners:
        p = points[other]
        if other in (before, tip, after) or p in (a, b, c):
            continue
        if _area(a, b, p) >= 0.0 and _area(b, c, p) >= 0.0 and _area(c, a, p) >= 0.0:
            return False
    return True


def _area(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    """Twice the signed area of a triangle, positive counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
