"""Polygons with any number of corners, cut into triangles (FoCG 12.1 knows triangles only).

    mesh = mesh_from_polygons(positions, [(0, 1, 2, 3), (4, 5, 6, 7, 8)])
    mesh.face_attributes["polygon"]                                         which polygon each triangle is part of

A convex polygon is a fan round its first corner. Of one that is not, or has corners that go straight on, ears are clipped: a corner
whose triangle lies inside and holds no other corner is cut off, until a triangle is left.

           2          a quadrilateral 0 1 2 3 with a notch at 1:
         .'/          the fan round 0 cuts along 0-2, which lies outside,
        3 1           the diagonal 1-3 lies inside
         '.\\
           0

**Source**: G. H. Meisters, *Polygons have ears*, The American Mathematical Monthly 82 (1975); M. Newell's plane from the
areas of the projections (Sutherland, Sproull, Schumacker, *A Characterization of Ten Hidden-Surface Algorithms*, 1974).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .mesh import Mesh

__all__ = ["MAX_CLIPPED_CORNERS", "mesh_from_polygons", "triangulate"]

# Clipping takes quadratic time. A larger polygon of a file, which anyone may have made, becomes a fan if it is not convex.
MAX_CLIPPED_CORNERS = 512
_WORK = 20_000_000
# Sine of a turn that counts as going straight on: some roundings of float32.
_STRAIGHT = 1e-6
# Corners that are tested one by one; more go through NumPy together.
_FEW = 24

Point = tuple[float, float]
Points = NDArray[np.float64]
Indices = NDArray[np.int64]


def mesh_from_polygons(positions: ArrayLike, polygons: Iterable[ArrayLike], name: str = "") -> Mesh:
    """Make a mesh of polygons.

    Parameters
    ----------
    positions : (n, 3) float
        Metres.
    polygons : (p, k) int, or a sequence of p sequences of at least 3 int
        Position indices of the corners, counter-clockwise seen from outside; simple, nearly planar, convex or not.
    name : str

    Returns
    -------
    Mesh
        The triangles of each polygon in its place; `face_attributes` has "polygon", (m,) int32. No position is added.

    Raises SceneError where a polygon has fewer than 3 corners or an index is out of range.

    >>> mesh_from_polygons([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]], [(0, 1, 2, 3), (1, 4, 2)], "kite")
    Mesh('kite', 5 positions, 3 triangles)
    """
    points = np.asarray(positions, dtype=np.float64).reshape(-1, 3)
    rows = [np.asarray(polygon) for polygon in polygons]
    for number, row in enumerate(rows):
        if row.ndim != 1 or len(row) < 3 or row.dtype.kind not in "iu":
            raise SceneError(f"polygons must have at least 3 indices each, got {row.tolist()} at polygon {number}", name)
        if row.min() < 0 or row.max() >= len(points):
            raise SceneError(f"polygons must index into {len(points)} positions, got {row.tolist()} at polygon {number}", name)
    sizes = np.array([len(row) for row in rows], dtype=np.int64)
    start = np.cumsum(sizes - 2) - (sizes - 2)
    triangles = np.empty((int((sizes - 2).sum()), 3), dtype=np.int32)
    for size in np.unique(sizes).tolist():
        numbers = np.flatnonzero(sizes == size)
        corners = np.stack([rows[number] for number in numbers])
        cut, _ = triangulate(points[corners], max_clipped=None)
        places = start[numbers, None] + np.arange(size - 2)
        triangles[places] = corners[np.arange(len(numbers))[:, None, None], cut]
    owner = np.repeat(np.arange(len(rows), dtype=np.int32), sizes - 2)
    return Mesh(points.astype(np.float32), triangles, name=name, face_attributes={"polygon": owner})


def triangulate(polygons: Points, max_clipped: int | None = MAX_CLIPPED_CORNERS) -> tuple[Indices, int]:
    """Cut polygons that all have the same number of corners.

    Parameters
    ----------
    polygons : (n, k, 3) float64, k >= 3
        The corners in order; nearly planar.
    max_clipped : int or None
        A polygon that is not convex and has more corners becomes a fan, and so do all once the work exceeds a limit; None: every one is
        clipped, however long it takes.

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
        sides = np.linalg.norm(inward, axis=2) * np.linalg.norm(outward, axis=2) * np.linalg.norm(normals, axis=1)[:, None]
    reflex, straight = turns < 0.0, ~(turns > _STRAIGHT * sides)
    if k == 4:
        # The diagonal must start at the reflex corner, where there is one, and better at one that goes straight on.
        wanted = reflex[:, 1] | reflex[:, 3] | ((straight[:, 1] | straight[:, 3]) & ~(reflex[:, 0] | reflex[:, 2]))
        triangles[wanted] = np.array([[0, 1, 3], [1, 2, 3]])
        return triangles, 0
    n_fans, work = 0, _WORK
    no_fan = reflex.any(axis=1) | (_winding(polygons, normals) > 1.5)
    for index in np.flatnonzero(straight.any(axis=1) | no_fan):
        work -= k * k
        if max_clipped is not None and (k > max_clipped or work < 0):
            n_fans += int(no_fan[index])
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
    ring = _Ring(flat)
    triangles: list[tuple[int, int, int]] = []
    start = 0
    while len(ring.corners) > 3:
        n = len(ring.corners)
        # Begin where the last ear was: neighbours of an ear often are ears, and slivers do not pile up at corner 0.
        order = [(start + step) % n for step in range(n)]
        at = next((i for least in (_STRAIGHT, 0.0) for i in order if ring.is_ear(i, least)), order[0])
        triangles.append(ring.clip(at))
        start = at % (n - 1)
    triangles.append((ring.corners[0], ring.corners[1], ring.corners[2]))
    return np.array(triangles, dtype=np.int64)


class _Ring:
    """What is left of a polygon, and which of its corners turn the wrong way or not at all: only those can lie in an ear."""

    def __init__(self, flat: Points) -> None:
        self.corners = list(range(len(flat)))
        self._points = [(float(x), float(y)) for x, y in flat]
        self._flat = flat
        # Those that go straight on are kept too: a spike may touch an ear from within.
        self._wrong = {i for i in self.corners if not self._turn(i) > 0.0}
        self._array: Indices | None = None

    def _triple(self, at: int) -> tuple[int, int, int]:
        return self.corners[at - 1], self.corners[at], self.corners[(at + 1) % len(self.corners)]

    def _turn(self, at: int) -> float:
        before, tip, after = self._triple(at)
        return _area(self._points[before], self._points[tip], self._points[after])

    def is_ear(self, at: int, least: float) -> bool:
        """Whether the triangle at a corner lies inside, holds no other corner, and turns by more than the arc sine of `least`."""
        triple = self._triple(at)
        a, b, c = (self._points[i] for i in triple)
        area = _area(a, b, c)
        if not area > 0.0 or (least > 0.0 and not area > least * math.dist(a, b) * math.dist(b, c)):
            return False
        if len(self._wrong) > _FEW:
            return not self._holds_any(a, b, c)
        for other in self._wrong:
            p = self._points[other]
            if other in triple or p in (a, b, c):
                continue
            if _area(a, b, p) >= 0.0 and _area(b, c, p) >= 0.0 and _area(c, a, p) >= 0.0:
                return False
        return True

    def _holds_any(self, a: Point, b: Point, c: Point) -> bool:
        """The same test for many corners at once."""
        if self._array is None:
            self._array = np.fromiter(self._wrong, dtype=np.int64)
        others = self._flat[self._array]
        p = (others[:, 0], others[:, 1])
        held = (_area(a, b, p) >= 0.0) & (_area(b, c, p) >= 0.0) & (_area(c, a, p) >= 0.0)
        return any(tuple(corner) not in (a, b, c) for corner in others[held].tolist())

    def clip(self, at: int) -> tuple[int, int, int]:
        """Cut a corner off; its neighbours may come to turn the right way, or the wrong one if it was no ear."""
        triple = self._triple(at)
        del self.corners[at]
        for i in (at - 1, at % len(self.corners)):
            self._sort(i)
        if triple[1] in self._wrong:
            self._wrong.remove(triple[1])
            self._array = None
        return triple

    def _sort(self, at: int) -> None:
        """Keep a corner among those that turn the wrong way, or no longer."""
        corner, is_wrong = self.corners[at], not self._turn(at) > 0.0
        if is_wrong != (corner in self._wrong):
            (self._wrong.add if is_wrong else self._wrong.remove)(corner)
            self._array = None


def _area(a: Any, b: Any, c: Any) -> Any:
    """Twice the signed area of a triangle, positive counter-clockwise; of many where a corner has arrays."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
