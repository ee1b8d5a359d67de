"""Charts put together as long as they can be laid flat with little distortion.

How far from flat is a chart, whatever its shape? A conformal map scales lengths by e^u, and where the rim keeps its lengths (u = 0, which
is the least distorted of all conformal maps) u is told by the curvature alone:

    Δu = K    inside,        u = 0    on the rim

A cylinder, a cone without its apex, two sides of a box: K is 0 inside, and so is u. Bumps whose curvature cancels over a short way hardly
count, a dome counts by its height. One sparse system answers for all charts at once, because the vertices of every rim fall away.

In rounds, each chart is put together with the neighbour with which it shares the longest run of border for its size, unless the two
would be too distorted, or too ragged; what was refused is not tried again.

**Source**: the scale factor and its boundary values: Springborn, Schröder and Pinkall, *Conformal equivalence of triangle meshes*, 2008
(linearised); merging by pairs: Garland, Willmott and Heckbert, *Hierarchical face clustering on polygonal surfaces*, 2001.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .conformal import conformal
from .dividing import divided, regrouped
from .gluing import Gluing
from .overlap import overlapping, turned_over
from .packing import boxes
from .pieces import Pieces
from .sparse import dirichlet, factorized
from .surface import components

__all__ = ["Limits", "merged"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_ROUNDS = 40
_DIVISIONS = 5
_CREASE = 0.5  # radians
_SHARP_TURN = 0.5  # radians


class Limits(NamedTuple):
    """What a chart may be at most.

    Attributes
    ----------
    distortion : float
        Root mean square of the logarithm of the scale of areas, as it is predicted.
    raggedness : float
        Square of the rim's length over that of a circle of the same area.
    fullness : float
        The least part of its bounding box that the flattened chart must fill.
    height : float
        The longest that its box may be, in square roots of the area of the whole surface: what is longer leaves the square empty.
    """

    distortion: float
    raggedness: float
    fullness: float
    height: float


def merged(gluing: Gluing, limits: Limits, costs: Floats) -> Gluing:
    """Put charts together.

    Parameters
    ----------
    gluing : Gluing
    limits : Limits
    costs : (3 m,) float64
        What a cut along each half-edge costs.

    Returns
    -------
    Gluing
    """
    surface = gluing.surface
    energy = dirichlet(surface, surface.umbrellas, len(surface.defects)).tocsr()
    gluing = _sound(gluing, energy, limits)
    refused: set[tuple[int, ...]] = set()
    for _ in range(_ROUNDS):
        pairs = _pairs(gluing, costs, limits, refused)
        if not len(pairs):
            break
        roots = gluing.roots()
        trial = _glued(gluing, roots, pairs)
        fits = _fits(energy, gluing, trial, pairs[:, :2], limits)
        counts = np.bincount(roots, minlength=len(roots))
        refused.update((int(a), int(b), int(counts[a]), int(counts[b])) for a, b in pairs[~fits, :2])
        if fits.all():
            gluing = trial
        elif fits.any():
            gluing = _glued(gluing, roots, pairs[fits])
    return gluing


def _pairs(gluing: Gluing, costs: Floats, limits: Limits, refused: set[tuple[int, ...]]) -> Indices:
    """(k, 3): two charts by their roots, the smaller first, and a half-edge between them; no chart twice, the best first."""
    roots = gluing.roots()
    n = len(roots)
    runs = gluing.runs(costs)
    if not len(runs.starts):
        return np.zeros((0, 3), dtype=np.int64)
    open_costs = np.where(gluing.glued == 0, costs, 0.0)
    perimeters = np.bincount(np.repeat(roots, 3), open_costs, n)
    lengths = np.bincount(np.repeat(roots, 3), np.where(gluing.glued == 0, gluing.surface.lengths, 0.0), n)
    areas = np.bincount(roots, gluing.surface.areas, n)
    plain = gluing.runs(gluing.surface.lengths).sizes
    h = runs.starts
    a, b = roots[h // 3], roots[gluing.surface.mates[h] // 3]
    pairs = np.stack([np.minimum(a, b), np.maximum(a, b), h], axis=1)
    smaller = np.minimum(perimeters[a], perimeters[b])
    gain = runs.sizes / np.maximum(smaller, 1e-300)
    rim = lengths[a] + lengths[b] - 2.0 * plain
    ragged = rim * rim / np.maximum(4.0 * np.pi * (areas[a] + areas[b]), 1e-300)
    # Two charts that are ragged already may be put together to one that is less so.
    before = np.maximum(*(lengths[c] ** 2 / np.maximum(4.0 * np.pi * areas[c], 1e-300) for c in (a, b)))
    allowed = ragged <= np.maximum(limits.raggedness, before)
    counts = np.bincount(roots, minlength=n)
    taken: set[int] = set()
    chosen = []
    for k in np.argsort(-gain, kind="stable"):
        first, second = int(pairs[k, 0]), int(pairs[k, 1])
        if not allowed[k] or first in taken or second in taken or (first, second, int(counts[first]), int(counts[second])) in refused:
            continue
        taken.update((first, second))
        chosen.append(k)
    return pairs[chosen]


def _glued(gluing: Gluing, roots: Indices, pairs: Indices) -> Gluing:
    """A copy in which the pairs are glued, from their half-edges on."""
    groups = roots.copy()
    into = np.arange(len(roots))
    into[pairs[:, 1]] = pairs[:, 0]
    groups = into[groups]
    made = gluing.copy()
    made.glue(pairs[:, 2], groups)
    return made


def _fits(energy: Any, gluing: Gluing, trial: Gluing, pairs: Indices, limits: Limits) -> NDArray[np.bool_]:
    """(k,): whether the charts that the pairs became keep the limits, and can be laid flat one to one."""
    roots = gluing.roots()
    pair_of = np.full(len(roots), -1, dtype=np.int64)
    pair_of[pairs[:, 0]] = pair_of[pairs[:, 1]] = np.arange(len(pairs))
    triangles = np.flatnonzero(pair_of[roots] >= 0)
    which = pair_of[roots[triangles]]
    fits = _keeps(energy, trial, triangles, which, len(pairs), limits) & ~_rounds_corners(gluing, trial, triangles, which, len(pairs))
    if fits.any():
        everything = Pieces.of(trial)
        wanted = np.unique(everything.charts[triangles[fits[which]]])
        pieces, _ = everything.only(wanted)
        flat = conformal(pieces)
        sound = np.zeros(everything.n_charts, dtype=bool)
        _, box, height = boxes(pieces, flat)
        packable = (pieces.chart_areas >= limits.fullness * box) & (height <= limits.height)
        sound[wanted] = packable & ~(overlapping(pieces, flat) | turned_over(pieces, flat))
        fits &= np.bincount(which, sound[everything.charts[triangles]], len(pairs)) > 0
    return fits


def _keeps(energy: Any, gluing: Gluing, triangles: Indices, which: Indices, n: int, limits: Limits) -> NDArray[np.bool_]:
    """(n,): whether charts keep the limits, of which `triangles` are given and `which` chart each belongs to."""
    surface = gluing.surface
    u = _scales(energy, gluing, triangles)
    at = 2.0 * u[surface.umbrellas[triangles]]
    areas = surface.areas[triangles] + 1e-15
    total = np.bincount(which, areas, n)
    middle = np.bincount(which, areas * at.mean(axis=1), n) / total
    off = ((at - middle[which][:, None]) ** 2).mean(axis=1)
    kept: NDArray[np.bool_] = np.bincount(which, areas * off, n) / total <= limits.distortion**2
    return kept


def _rounds_corners(gluing: Gluing, trial: Gluing, triangles: Indices, which: Indices, n: int) -> NDArray[np.bool_]:
    """(n,): whether gluing closes around points of sharp edges that are curved in sum, as on the rim of a lid.

    To a formula for smooth surfaces that may seem little, but it would spoil two pieces that can be laid flat without any distortion.
    """
    surface = gluing.surface
    new = _inside(trial, triangles) & ~_inside(gluing, triangles) & surface.is_sharp
    umbrellas = surface.umbrellas[triangles]
    around = np.bincount(surface.umbrellas.reshape(-1), minlength=len(new))
    share = np.where(new, surface.defects / np.maximum(around, 1), 0.0)
    curvature = np.bincount(which, share[umbrellas].sum(axis=1), n)
    rounds: NDArray[np.bool_] = np.abs(curvature) > _SHARP_TURN
    return rounds


def _sound(gluing: Gluing, energy: Any, limits: Limits) -> Gluing:
    """Charts that do not keep the limits, cut where they bend sharply, then in two, until they do."""
    everything = np.arange(gluing.surface.n_triangles)
    for division in range(_DIVISIONS):
        charts = gluing.charts()
        n = int(charts.max()) + 1
        poor = ~_keeps(energy, gluing, everything, charts, n, limits) & (np.bincount(charts) > 1)
        if not poor.any():
            break
        if division == 0:
            flat = (gluing.glued == 1) & ((gluing.surface.bends < _CREASE) | ~np.repeat(poor[charts], 3))
            gluing = regrouped(gluing, components(len(charts), np.flatnonzero(flat) // 3, gluing.surface.mates[flat] // 3))
        else:
            chosen = np.flatnonzero(poor)
            gluing = divided(gluing, charts, chosen, np.full((len(chosen), 2), -1))
    return gluing


def _scales(energy: Any, gluing: Gluing, triangles: Indices) -> Floats:
    """(n,): u at each umbrella; 0 where it is not inside a chart."""
    free = np.flatnonzero(_inside(gluing, triangles))
    u = np.zeros(len(gluing.surface.defects))
    if len(free):
        u[free] = factorized(energy[free][:, free].tocsc()).solve(-gluing.surface.defects[free])
    return u


def _inside(gluing: Gluing, triangles: Indices) -> NDArray[np.bool_]:
    """(n,): whether each umbrella has one of the given triangles, and no cut: nor the surface's own rim, which has no mates to glue."""
    surface = gluing.surface
    inside = np.zeros(len(surface.defects), dtype=bool)
    at = surface.umbrellas.reshape(-1)
    inside[surface.umbrellas[triangles].reshape(-1)] = True
    cut = np.flatnonzero(gluing.glued == 0)
    inside[at[cut]] = inside[at[cut - cut % 3 + (cut + 1) % 3]] = False
    return inside
