"""Charts laid flat one to one.

The conformal map where it turns no triangle over, else Tutte's embedding; both improved until neither lengths nor angles get better; and a
chart that then lies over itself, or is too distorted, is cut in two.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from .conformal import conformal
from .dividing import divided
from .gluing import Gluing
from .isometric import energies, isometric
from .overlap import crossings, turned_over
from .packing import boxes
from .pieces import Pieces
from .tutte import tutte

__all__ = ["METHODS", "flattened", "flattened_whole"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

METHODS = ("balanced", "isometric", "conformal", "tutte")
_AREA_WEIGHTS = {"balanced": 0.05, "isometric": 1.0}
_STEPS = 30
_FAR_STEPS = 150  # from a disk, which may be far from any good shape
_CUTS = 6  # for less distortion; a chart that lies over itself is cut until it does not


def flattened(pieces: Pieces, method: str) -> Floats:
    """Lay charts flat with no triangle on its face.

    Parameters
    ----------
    pieces : Pieces
    method : "balanced" | "isometric" | "conformal" | "tutte"
        What is kept: angles before areas; both alike; angles alone where that is one to one; nothing but the neighbourhood, on disks.

    Returns
    -------
    (n, 2) float64
    """
    if method == "tutte" or not pieces.n_charts:
        return tutte(pieces)
    flat = conformal(pieces)
    bad = np.flatnonzero(turned_over(pieces, flat))
    weight = _AREA_WEIGHTS.get(method, 0.05)
    if len(bad):
        part, vertices = pieces.only(bad)
        flat[vertices] = isometric(part, tutte(part), weight, _FAR_STEPS, 1e-4)
    return flat if method == "conformal" else isometric(pieces, flat, weight, _STEPS)


def flattened_whole(gluing: Gluing, method: str, worst: float, tallest: float) -> tuple[Gluing, Pieces, Floats]:
    """Lay charts flat, each one to one; cut those in two of which the mean of `isometric.energies` exceeds `worst`,
    or the longer side of their bounding box `tallest`.

    Returns
    -------
    gluing, pieces, flat
        The charts as they are then.
    """
    pieces = Pieces.of(gluing)
    flat = flattened(pieces, method)
    if method == "tutte":
        return gluing, pieces, flat
    for cut in itertools.count():
        crossed = crossings(pieces, flat)
        poor = _poor(pieces, flat, worst if cut < _CUTS else np.inf, tallest if cut < _CUTS else np.inf, crossed[:, 0] >= 0)
        if not len(poor):
            break
        places = np.maximum(crossed[poor], 0)
        gluing = divided(gluing, pieces.charts, poor, np.where(crossed[poor] >= 0, pieces.rims.half_edges[places] // 3, -1))
        kept = np.isin(pieces.charts, poor, invert=True)
        before, old_corners = flat, pieces.corners
        pieces = Pieces.of(gluing)
        flat = np.zeros((pieces.n_vertices, 2))
        flat[pieces.corners[kept].reshape(-1)] = before[old_corners[kept].reshape(-1)]
        part, vertices = pieces.only(np.unique(pieces.charts[~kept]))
        flat[vertices] = flattened(part, method)
    return gluing, pieces, flat


def _poor(pieces: Pieces, flat: Floats, worst: float, tallest: float, folded: NDArray[np.bool_]) -> Indices:
    """Charts of more than one triangle that lie over themselves, are too distorted or too long."""
    energy = pieces.areas * np.minimum(energies(pieces.jacobians(flat), 1.0), 1e6)
    mean = np.bincount(pieces.charts, energy, pieces.n_charts) / pieces.chart_areas
    too_long = boxes(pieces, flat)[2] > tallest
    return np.flatnonzero((folded | too_long | (mean > worst)) & (np.bincount(pieces.charts, minlength=pieces.n_charts) > 1))
