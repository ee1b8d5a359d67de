"""Gluing triangles along their edges so that every piece stays a topological disc."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..._jit import kernel

Indices = NDArray[np.int64]


@kernel
def _root(parents: Indices, t: int) -> int:
    """The triangle that stands for the piece of a triangle; paths are halved on the way."""
    while parents[t] != t:
        parents[t] = parents[parents[t]]
        t = parents[t]
    return t


@kernel
def _close_up(mates, pinned, groups, parents, lengths, following, before, glued, h, g):
    """Glue two half-edges that follow each other on one rim, and what then follows each other, and so on."""
    while mates[h] == g and following[h] == g and pinned[g] == 0 and groups[h // 3] == groups[g // 3]:
        root = _root(parents, h // 3)
        # A rim of fewer than three edges has no shape in the plane.
        if lengths[root] < 5:
            break
        glued[h], glued[g] = 1, 1
        lengths[root] -= 2
        h, g = before[h], following[g]
        following[h], before[g] = g, h


@kernel
def glue(order, mates, pinned, groups, parents, lengths, following, before, glued):
    """Glue the half-edges of `order` to their mates, in turn, where both triangles are of one group and a disc remains.

    Two discs glued along an edge are a disc; a disc glued to itself remains one where the edges follow each other on its rim. Vertices that
    are `pinned`, at the starts of half-edges, stay on the rim.
    """
    for k in range(len(order)):
        h = order[k]
        g = mates[h]
        if g < 0 or glued[h] != 0 or groups[h // 3] != groups[g // 3]:
            continue
        first, second = _root(parents, h // 3), _root(parents, g // 3)
        if first == second:
            if following[h] == g:
                _close_up(mates, pinned, groups, parents, lengths, following, before, glued, h, g)
            elif following[g] == h:
                _close_up(mates, pinned, groups, parents, lengths, following, before, glued, g, h)
            continue
        glued[h], glued[g] = 1, 1
        if lengths[first] < lengths[second]:
            first, second = second, first
        parents[second] = first
        lengths[first] += lengths[second] - 2
        h0, h1, g0, g1 = before[h], following[h], before[g], following[g]
        following[h0], before[g1] = g1, h0
        following[g0], before[h1] = h1, g0
        _close_up(mates, pinned, groups, parents, lengths, following, before, glued, h0, g1)
        # Closing up on one side may have used up the other.
        if glued[g0] == 0 and glued[h1] == 0:
            _close_up(mates, pinned, groups, parents, lengths, following, before, glued, g0, h1)


@kernel
def runs(mates, pinned, parents, following, before, glued, costs, starts, sizes, count):
    """Find where two pieces lie along each other: each unbroken run once, its first half-edge and the sum of its costs."""
    n_runs = 0
    for h in range(len(mates)):
        g = mates[h]
        if g < 0 or glued[h] != 0:
            continue
        own, other = _root(parents, h // 3), _root(parents, g // 3)
        if own >= other:
            continue
        if pinned[h] == 0 and mates[before[h]] >= 0 and following[g] == mates[before[h]]:
            continue
        total, k = 0.0, h
        while True:
            total += costs[k]
            beyond = following[k]
            if beyond == h or pinned[beyond] != 0 or mates[beyond] < 0 or mates[beyond] != before[mates[k]]:
                break
            k = beyond
        starts[n_runs], sizes[n_runs] = h, total
        n_runs += 1
    count[0] = n_runs


@kernel
def walk_rims(parents, following, before, glued, seen, rim, first, count):
    """List the rims of all pieces, one after the other: half-edges in order, and where each rim begins."""
    n_rims, place = 0, 0
    for h in range(len(glued)):
        if glued[h] != 0 or seen[h] != 0:
            continue
        first[n_rims] = place
        n_rims += 1
        k = h
        while seen[k] == 0:
            seen[k] = 1
            rim[place] = k
            place += 1
            k = following[k]
    first[n_rims] = place
    count[0] = n_rims
