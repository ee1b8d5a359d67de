"""Offset curves: all points at a distance from a curve, to its left (FoCG 15.6's curves are not closed under it).

The offset of a Bézier curve is no Bézier curve, but near one: between two parameters it is taken as the cubic with the true ends, the
true tangents and speeds ``f' (1 - d k)`` there, k being the curvature. Where that cubic is off by more than the tolerance, the piece is
halved. Where ``1 - d k`` changes its sign, the offset turns back in a cusp; pieces are cut there.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import RenderError, SceneError
from .curve import Curve, Spline
from .frames import curvature, tangents

__all__ = ["offset", "offset_points"]

Floats = NDArray[np.float64]

_LOOKS = np.array([0.2, 0.35, 0.5, 0.65, 0.8])
_SCAN = 64
_MOST_PIECES = 1 << 14
_MOST_HALVINGS = 24


def offset_points(curve: Curve, u: ArrayLike, distance: float) -> Floats:
    """Evaluate the exact offset: ``f(u) + distance n(u)`` with the unit normal to the left; (..., 2) float64."""
    t = tangents(curve, u)
    if t.shape[-1] != 2:
        raise SceneError(f"offsets are those of curves in the plane, got {t.shape[-1]} coordinates")
    return np.asarray(curve.at(u) + distance * np.stack([-t[..., 1], t[..., 0]], axis=-1))


def offset(curve: Curve, distance: float, tolerance: float = 1e-3) -> Spline:
    """Draw the offset of a curve in the plane by cubic pieces.

    Parameters
    ----------
    curve : Curve
        Without points where its derivative vanishes.
    distance : float
        To the left where it is positive.
    tolerance : float > 0
        How far the pieces may be off.

    Returns
    -------
    Spline
        Over the same parameters, of degree 3. At a corner of the curve the offset jumps, and a straight piece is not added: corners are
        for `limner.draw.stroke`.
    """
    if not math.isfinite(distance):
        raise SceneError(f"the distance of an offset must be finite, got {distance}")
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise SceneError(f"the tolerance of an offset must be positive, got {tolerance}")
    ends = np.unique(np.concatenate([curve.knots, _cusps(curve, distance)]))
    a, b = ends[:-1], ends[1:]
    done: list[tuple[Floats, Floats]] = []
    for step in range(_MOST_HALVINGS + 1):
        pieces = _fitted(curve, a, b, distance)
        good = _error(curve, pieces, a, b, distance) <= tolerance
        if step == _MOST_HALVINGS:
            good[:] = True
        done.append((a[good], pieces[good]))
        a, b = a[~good], b[~good]
        if not len(a):
            break
        if len(a) > _MOST_PIECES:
            raise RenderError(f"an offset to {tolerance:g} would take more than {_MOST_PIECES:,} pieces")
        middle = 0.5 * (a + b)
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    starts = np.concatenate([start for start, _ in done])
    order = np.argsort(starts)
    return Spline(np.append(starts[order], curve.knots[-1]), np.concatenate([made for _, made in done])[order])


def _cusps(curve: Curve, distance: float) -> Floats:
    """Parameters at which ``1 - d k`` changes its sign, by halving."""
    found = []
    for start, end in zip(curve.knots[:-1], curve.knots[1:], strict=True):
        u = np.linspace(start, end, _SCAN + 1)[:-1] + 1e-9 * (end - start)
        turned = 1.0 - distance * curvature(curve, u) > 0.0
        change = np.flatnonzero(turned[1:] != turned[:-1])
        low, high = u[change], u[change + 1]
        for _ in range(52):
            middle = 0.5 * (low + high)
            same = (1.0 - distance * curvature(curve, middle) > 0.0) == turned[change]
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        found.append(low)
    return np.concatenate(found)


def _fitted(curve: Curve, a: Floats, b: Floats, distance: float) -> Floats:
    """Cubics (k, 4, 2) with the ends and the derivatives of the offset; at the end those from before a knot."""
    before = np.where(np.isin(b, curve.knots[1:-1]), b - 1e-9 * (b - a), b)
    starts, ends = offset_points(curve, a, distance), offset_points(curve, before, distance)
    third = (b - a)[:, None] / 3.0
    first, last = third * _velocity(curve, a, distance), third * _velocity(curve, before, distance)
    return np.stack([starts, starts + first, ends - last, ends], axis=1)


def _velocity(curve: Curve, u: Floats, distance: float) -> Floats:
    return np.asarray((1.0 - distance * curvature(curve, u))[:, None] * curve.derivative(u))


def _error(curve: Curve, pieces: Floats, a: Floats, b: Floats, distance: float) -> Floats:
    t = _LOOKS[:, None]
    weights = np.concatenate([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3], axis=1)
    made = np.einsum("lj,kjd->kld", weights, pieces)
    true = offset_points(curve, a[:, None] + (b - a)[:, None] * _LOOKS, distance)
    return np.asarray(np.linalg.norm(made - true, axis=2).max(axis=1))
