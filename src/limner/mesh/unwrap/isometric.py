"""Lengths kept as well as angles: a flattening improved until nothing gets better, with no triangle ever turned over.

A triangle whose map stretches by s1 and s2 has the energy

    c a^w,    c = (s1/s2 + s2/s1) / 2   what angles suffer,    a = (s1 s2 + 1/(s1 s2)) / 2   what its area suffers

which is 1 for an isometry and grows beyond all bounds before a triangle collapses. With w = 1 it is the symmetric Dirichlet energy
(‖J‖² + ‖J⁻¹‖²)/4; with a smaller w angles count more. It is minimised by quasi-Newton steps (L-BFGS) that begin with the inverse of the
Dirichlet energy's matrix, which is the same in all steps and is taken apart once; a step goes at most nine tenths of the way to where
the first triangle of its chart would collapse.

**Source**: Degener, Meseth and Klein, *An adaptable surface parameterization method*, 2003 (the energy); Smith and Schaefer, *Bijective
parameterization with free boundaries*, 2015 (the steps); Liu, Bouaziz and Kavan, *Quasi-Newton methods for real-time simulation of
hyperelastic materials*, 2017 (beginning with the Laplacian).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..._door import Array, Door, Scalar
from .pieces import Pieces
from .sparse import Factor, dirichlet, factorized

__all__ = ["energies", "isometric"]

Floats = NDArray[np.float64]

_f1, _f2, _i1, _i2 = Array(np.float64, 1), Array(np.float64, 2), Array(np.int64, 1), Array(np.int64, 2)
_evaluate = Door(
    "limner.mesh.unwrap.isometric_kernel",
    "evaluate",
    (_f2, _i2, _i1, _f2, _f1, Scalar(np.float64), _f1, _f2),
    "the energy of flattened charts",
)
_first_collapses = Door(
    "limner.mesh.unwrap.isometric_kernel", "first_collapses", (_f2, _f2, _i2, _i1, _f1), "the steps of flattening"
)

_MEMORY = 6
_HALVINGS = 8
_SUFFICIENT = 1e-4


class _Step(NamedTuple):
    """What a step changed: the vertices, the gradient, and the product of both for each chart."""

    move: Floats
    change: Floats
    product: Floats


def isometric(pieces: Pieces, flat: Floats, area_weight: float = 1.0, steps: int = 30, tolerance: float = 1e-5) -> Floats:
    """Improve flattened charts.

    Parameters
    ----------
    pieces : Pieces
    flat : (n, 2) float64
        With no triangle on its face.
    area_weight : float >= 0
        The w of the energy.
    steps : int
        At most.
    tolerance : float
        A chart is done when a step lowers its energy by a smaller part.

    Returns
    -------
    (n, 2) float64
        No triangle on its face; the energy of no chart is greater than before.
    """
    matrix = dirichlet(pieces.surface, pieces.corners, pieces.n_vertices, pieces.triangles)
    matrix.setdiag(matrix.diagonal() * (1.0 + 1e-7) + 1e-9)
    factor = factorized(matrix.tocsc())
    value, gradient = _value_and_gradient(pieces, flat, area_weight)
    memory: list[_Step] = []
    active = np.ones(pieces.n_charts, dtype=bool)
    for _ in range(steps):
        direction = _direction(pieces, factor, gradient, memory)
        slope = pieces.chart_sums((direction * gradient).sum(axis=1))
        direction = np.where((active & (slope < 0.0))[pieces.chart_of][:, None], direction, 0.0)
        lengths = np.minimum(1.0, 0.9 * _first_collapse(pieces, flat, direction))
        moved, new_value, new_gradient = flat, value, gradient
        pending = active.copy()
        for _ in range(_HALVINGS):
            moved = flat + lengths[pieces.chart_of][:, None] * direction
            new_value, new_gradient = _value_and_gradient(pieces, moved, area_weight)
            pending = active & ~(new_value <= value + _SUFFICIENT * lengths * slope)
            if not pending.any():
                break
            lengths = np.where(pending, 0.5 * lengths, lengths)
        stuck = pending[pieces.chart_of][:, None]
        moved, new_gradient = np.where(stuck, flat, moved), np.where(stuck, gradient, new_gradient)
        new_value = np.where(pending, value, new_value)
        memory = [*memory[-_MEMORY + 1 :], _step(pieces, moved - flat, new_gradient - gradient)]
        active &= value - new_value > tolerance * (value - pieces.chart_areas + 1e-12 * pieces.chart_areas)
        flat, value, gradient = moved, new_value, new_gradient
        if not active.any():
            break
    return flat


def energies(jacobians: Floats, area_weight: float) -> Floats:
    """(k,) float64: c a^w for maps (2, 2, k); inf where one turns its triangle over."""
    (p, q), (r, s) = jacobians
    det = p * s - q * r
    safe = np.where(det > 0.0, det, 1.0)
    found = (p * p + q * q + r * r + s * s) / (2.0 * safe) * (0.5 * (safe + 1.0 / safe)) ** area_weight
    return np.where(det > 0.0, found, np.inf)


def _value_and_gradient(pieces: Pieces, flat: Floats, w: float) -> tuple[Floats, Floats]:
    """Energy of each chart, weighted by areas on the surface; and its gradient, (n, 2)."""
    value, gradient = np.empty(pieces.n_charts), np.empty((pieces.n_vertices, 2))
    _evaluate(flat, pieces.corners, pieces.charts, pieces.shapes, pieces.areas, w, value, gradient)
    return value, gradient


def _direction(pieces: Pieces, factor: Factor, gradient: Floats, memory: list[_Step]) -> Floats:
    """The two loops of L-BFGS, with the products of each chart by themselves."""

    def spread(numbers: Floats) -> Floats:
        return numbers[pieces.chart_of][:, None]

    def products(first: Floats, second: Floats) -> Floats:
        return pieces.chart_sums(np.einsum("ij,ij->i", first, second))

    q = gradient.copy()
    shares = []
    for step in reversed(memory):
        share = np.where(step.product > 0.0, products(step.move, q) / np.where(step.product > 0.0, step.product, 1.0), 0.0)
        q -= spread(share) * step.change
        shares.append(share)
    found = factor.solve(q)
    if memory:
        last = memory[-1]
        curvature = products(last.change, factor.solve(last.change))
        found *= spread(np.where((last.product > 0.0) & (curvature > 0.0), last.product / np.where(curvature > 0.0, curvature, 1.0), 0.5))
    else:
        found *= 0.5
    for step, share in zip(memory, reversed(shares), strict=True):
        back = np.where(step.product > 0.0, products(step.change, found) / np.where(step.product > 0.0, step.product, 1.0), 0.0)
        found += spread(share - back) * step.move
    return -found


def _step(pieces: Pieces, move: Floats, change: Floats) -> _Step:
    return _Step(move, change, pieces.chart_sums((move * change).sum(axis=1)))


def _first_collapse(pieces: Pieces, flat: Floats, direction: Floats) -> Floats:
    """(charts,) float64: how many times `direction` leads to the first triangle without area; inf: none does.

    **Source**: Smith and Schaefer 2015, section 3.3: the least positive root of a quadratic for each triangle.
    """
    nearest = np.empty(pieces.n_charts)
    _first_collapses(flat, np.ascontiguousarray(direction), pieces.corners, pieces.charts, nearest)
    return nearest
