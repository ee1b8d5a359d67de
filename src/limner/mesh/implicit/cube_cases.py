"""How a surface crosses a cube, given which corners lie inside and, where a face leaves it open, which corners it joins.

On each face of the cube the surface leaves segments between crossed edges, directed so that the inside is on their left, seen from outside
the cube:

    o-----o       o--x--o       a face with the corners inside on a diagonal has two ways: the inside is cut in two,
    |     |       | / \\ |       or joined. Both cubes at the face must choose the same.
    x-----x       x     x
    |     |       | \\ / |
    *-----*       *--x--o

Every crossed edge of the cube ends one segment and begins another, so that segments chain into loops; a loop is filled with triangles that
use no diagonal in a face of the cube, where the neighbour may have the same one. Where there is no such filling, a point is put in
the middle. So every edge of the result is the side of two triangles and every vertex has one loop of them, whatever the numbers are.

The table is worked out here, not written down.

**Source**: Lorensen and Cline, "Marching Cubes", SIGGRAPH 1987; Nielson and Hamann, "The Asymptotic Decider", IEEE Visualization 1991; the
care with diagonals is Chernyaev's, *Marching Cubes 33*, CERN CN/95-17, 1995.
"""

from __future__ import annotations

import itertools
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["EDGES", "FACES", "MIDDLE", "CaseTable", "case_table"]

# Corner k of the unit cube is (k & 1, k >> 1 & 1, k >> 2): bit 0 along x
CORNERS = tuple((k & 1, k >> 1 & 1, k >> 2) for k in range(8))
# Edge: its lesser corner and its axis
EDGES = tuple((corner, axis) for axis in range(3) for corner in range(8) if not corner >> axis & 1)
_EDGE_OF = {frozenset((corner, corner | 1 << axis)): k for k, (corner, axis) in enumerate(EDGES)}
MIDDLE = 12  # stands for the point in the middle of a loop

# Corners of the faces at 0 and at 1 of each axis, in the same order for both cubes that share it: round about, from the lesser corner
FACES = tuple(
    (low, low | 1 << u, low | 1 << u | 1 << v, low | 1 << v)
    for axis in range(3)
    for u, v in [((axis + 1) % 3, (axis + 2) % 3)]
    for low in (0, 1 << axis)
)

Loop = tuple[int, ...]


class CaseTable(NamedTuple):
    """The triangles of all cases.

    Attributes
    ----------
    ambiguous : (256,) int64
        Bit f: face f has its corners inside (bits of the case) on a diagonal.
    start : (256 * 64 + 1,) int64
        Triangles of case c with joined faces j (bits, ambiguous ones only) are start[64 c + j] .. start[64 c + j + 1].
    triangles : (t, 3) int64
        By edges of the cube, counter-clockwise seen from outside the surface; MIDDLE: the point in the middle of `loop`.
    loop : (t, 12) int64
        For triangles with a MIDDLE: the edges whose points it is the mean of; -1: no more.
    """

    ambiguous: NDArray[np.int64]
    start: NDArray[np.int64]
    triangles: NDArray[np.int64]
    loop: NDArray[np.int64]


@cache
def case_table() -> CaseTable:
    """Work out the table; once, in some tens of milliseconds."""
    ambiguous = np.zeros(256, dtype=np.int64)
    triangles: list[Loop] = []
    loops: list[Loop] = []
    count = np.zeros(256 * 64, dtype=np.int64)
    for case in range(256):
        open_faces = [f for f, face in enumerate(FACES) if _is_ambiguous(case, face)]
        ambiguous[case] = sum(1 << f for f in open_faces)
        for chosen in itertools.product((0, 1), repeat=len(open_faces)):
            # The least face last, so that what is joined counts up as the table does
            joined = sum(bit << f for bit, f in zip(chosen, reversed(open_faces), strict=True))
            made = [entry for loop in _loops(case, joined) for entry in _filled(loop)]
            count[64 * case + joined] = len(made)
            triangles += [triangle for triangle, _ in made]
            loops += [loop for _, loop in made]
    padded = np.full((len(loops), 12), -1, dtype=np.int64)
    for row, loop in zip(padded, loops, strict=True):
        row[: len(loop)] = loop
    return CaseTable(ambiguous, np.concatenate([[0], np.cumsum(count)]), np.array(triangles, dtype=np.int64), padded)


def _is_ambiguous(case: int, face: tuple[int, ...]) -> bool:
    a, b, c, d = (case >> corner & 1 for corner in face)
    return a == c != b == d


def _outward(f: int) -> tuple[int, ...]:
    """The corners of a face, counter-clockwise seen from outside the cube."""
    return FACES[f] if f % 2 else FACES[f][::-1]


def _loops(case: int, joined: int) -> list[Loop]:
    """Loops of crossed edges; counter-clockwise seen from the outside of the surface."""
    onwards: dict[int, int] = {}
    for f in range(6):
        corners = _outward(f)
        inside = [bool(case >> corner & 1) for corner in corners]
        sides = [_EDGE_OF[frozenset((corners[k], corners[(k + 1) % 4]))] for k in range(4)]
        leaving = [k for k in range(4) if inside[k] and not inside[(k + 1) % 4]]
        for k in leaving:
            # Back to where the inside was entered; joined corners are left round the outside's next corner
            step = 1 if len(leaving) == 2 and joined >> f & 1 else -1
            entering = (k + step) % 4
            while inside[entering] or not inside[(entering + 1) % 4]:
                entering = (entering + step) % 4
            onwards[sides[entering]] = sides[k]
    loops = []
    while onwards:
        first = next(iter(onwards))
        loop, edge = [first], onwards.pop(first)
        while edge != first:
            loop.append(edge)
            edge = onwards.pop(edge)
        loops.append(tuple(loop))
    return loops


def _share_a_face(a: int, b: int) -> bool:
    def faces(edge: int) -> set[int]:
        corner, axis = EDGES[edge]
        return {f for f, face in enumerate(FACES) if corner in face and corner | 1 << axis in face}

    return bool(faces(a) & faces(b))


def _length(a: int, b: int) -> float:
    """Between the middles of two edges."""
    p, q = (np.array(CORNERS[corner]) + 0.5 * np.eye(3)[axis] for corner, axis in (EDGES[a], EDGES[b]))
    return float(np.linalg.norm(p - q))


def _filled(loop: Loop) -> list[tuple[Loop, Loop]]:
    """Triangles that fill a loop, with the shortest diagonals that lie in no face; a fan about the middle where there are none."""
    n = len(loop)
    if n == 3:
        return [(loop, ())]
    best: dict[tuple[int, int], tuple[float, int]] = {(k, k + 1): (0.0, -1) for k in range(n - 1)}
    for width in range(2, n):
        for i in range(n - width):
            j = i + width
            closes = (i, j) == (0, n - 1)
            if not closes and _share_a_face(loop[i], loop[j]):
                continue
            own = 0.0 if closes else _length(loop[i], loop[j])
            ways = [(best[i, k][0] + best[k, j][0] + own, k) for k in range(i + 1, j) if (i, k) in best and (k, j) in best]
            if ways:
                best[i, j] = min(ways)
    if (0, n - 1) not in best:
        return [((loop[k], loop[(k + 1) % n], MIDDLE), loop) for k in range(n)]
    triangles: list[tuple[Loop, Loop]] = []
    spans = [(0, n - 1)]
    while spans:
        i, j = spans.pop()
        k = best[i, j][1]
        if k >= 0:
            triangles.append(((loop[i], loop[k], loop[j]), ()))
            spans += [(i, k), (k, j)]
    return triangles
