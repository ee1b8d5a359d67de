"""What a curve is to those who measure and draw it: a point for each parameter of an interval, and its derivatives.

Two kinds keep the promise of `Curve`: `Spline`, pieces of (rational) Bézier curves end to end, to which all curves with control points
come down; and `Parametric`, any function. `composed`, `on_unit_interval` and `backwards` run along the same points in another way
(FoCG 15.1.1).

    circle = Parametric(lambda u: np.stack([np.cos(u), np.sin(u)], axis=-1), 0.0, 2.0 * math.pi)
    circle.at(0.0), circle.derivative(0.0)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from . import bezier, rational
from .bernstein import basis_columns
from .control import breaks, control_points, degree_of, parameters

__all__ = ["Curve", "Parametric", "Spline", "backwards", "composed", "on_unit_interval"]

Floats = NDArray[np.float64]
Function = Callable[[Floats], Floats]

_CHUNK = 1 << 13
_STENCIL = 9  # points in a difference


class Curve(Protocol):
    """A curve over the interval from `start` to `end`.

    Attributes
    ----------
    knots : (m + 1,) float64
        From `start` to `end`: where pieces meet, and derivatives may jump.
    """

    @property
    def knots(self) -> Floats: ...

    def at(self, u: ArrayLike) -> Floats:
        """Points: (...) float to (..., d) float64."""
        ...

    def derivative(self, u: ArrayLike, order: int = 1) -> Floats:
        """Derivatives by the parameter: (...) float to (..., d) float64; where pieces meet, of the later one."""
        ...


@dataclass(frozen=True)
class Spline:
    """Pieces of Bézier curves, one after the other.

    Parameters
    ----------
    knots : (m + 1,) float
        Increasing: the parameters where pieces begin and end.
    pieces : (m, n + 1, d) float
        Control points of each.
    rational : bool
        The last coordinate is a weight that has been multiplied into the others, see `limner.curves.rational.homogeneous`.

    Examples
    --------
    >>> line = Spline([0.0, 2.0], [[[0.0, 0.0], [4.0, 2.0]]])
    >>> line.at(1.0).tolist(), line.derivative(1.0).tolist()
    ([2.0, 1.0], [2.0, 1.0])
    """

    knots: Floats
    pieces: Floats
    rational: bool = False

    def __post_init__(self) -> None:
        pieces = np.array(self.pieces, dtype=np.float64)
        if pieces.ndim != 3 or 0 in pieces.shape or not np.isfinite(pieces).all():
            raise SceneError(f"spline.pieces must be finite numbers of shape (m, n + 1, d), got shape {pieces.shape}")
        if self.rational and not (pieces[..., -1] > 0.0).all():
            raise SceneError("spline.pieces must have positive weights")
        knots = breaks(np.array(self.knots, dtype=np.float64), len(pieces) + 1, "spline.knots")
        for name, value in (("knots", knots), ("pieces", pieces)):
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    @classmethod
    def bezier(cls, points: ArrayLike, weights: ArrayLike | None = None) -> Spline:
        """One Bézier curve over [0, 1], rational where there are weights."""
        control = control_points(points) if weights is None else rational.homogeneous(points, weights)
        return cls(np.array([0.0, 1.0]), control[None], weights is not None)

    @classmethod
    def joined(cls, pieces: Sequence[ArrayLike]) -> Spline:
        """Bézier curves of any degrees end to end, each over one unit of the parameter."""
        controls = [control_points(piece, name=f"pieces[{k}]") for k, piece in enumerate(pieces)]
        if not controls:
            raise SceneError("a spline needs at least one piece")
        most = max(len(control) for control in controls)
        raised = [bezier.elevate(control, most - len(control)) for control in controls]
        return cls(np.arange(len(raised) + 1.0), np.array(raised))

    @property
    def degree(self) -> int:
        """Of its pieces."""
        return self.pieces.shape[1] - 1

    @property
    def dimension(self) -> int:
        """Coordinates of a point."""
        return self.pieces.shape[2] - self.rational

    def at(self, u: ArrayLike) -> Floats:
        """Points: (...) float within the knots to (..., d) float64."""
        lifted = self._lifted(u, 0)
        return lifted[..., :-1] / lifted[..., -1:] if self.rational else lifted

    def derivative(self, u: ArrayLike, order: int = 1) -> Floats:
        """Derivatives: (...) float within the knots to (..., d) float64; at a knot of the piece that begins there."""
        degree_of(order)
        if self.rational:
            return rational.quotient([self._lifted(u, k) for k in range(order + 1)])
        return self._lifted(u, order)

    def _lifted(self, u: ArrayLike, order: int) -> Floats:
        t = parameters(u, float(self.knots[0]), float(self.knots[-1]))
        degree = self.degree - order
        if degree < 0:
            return np.zeros((*t.shape, self.pieces.shape[2]))
        spans = np.diff(self.knots)
        scale = np.prod(np.arange(self.degree, degree, -1.0)) / spans**order
        control = np.diff(self.pieces, n=order, axis=1) * scale[:, None, None]
        flat = t.reshape(-1)
        made = np.empty((len(flat), self.pieces.shape[2]))
        for begin in range(0, len(flat), _CHUNK):
            here = flat[begin : begin + _CHUNK]
            row = np.searchsorted(self.knots[1:-1], here, side="right")
            weights = basis_columns(degree, (here - self.knots[row]) / spans[row])
            for axis in range(made.shape[1]):
                total = weights[0] * control[:, 0, axis].take(row)
                for k in range(1, degree + 1):
                    total += weights[k] * control[:, k, axis].take(row)
                made[begin : begin + _CHUNK, axis] = total
        return made.reshape(*t.shape, self.pieces.shape[2])


@dataclass(frozen=True)
class Parametric:
    """A curve that is any function.

    Parameters
    ----------
    function : callable
        (...) float64 to (..., d) float64.
    start, end : float, start < end
    derivatives : tuple of callables
        Of order 1, 2, ..., as far as they are known; the others are taken by differences of the highest one, of points within the
        interval: to about ten digits of the first, seven of the second, five of the third.
    inner : tuple of float
        Parameters between the ends where derivatives jump.
    """

    function: Function
    start: float = 0.0
    end: float = 1.0
    derivatives: tuple[Function, ...] = ()
    inner: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        breaks([self.start, *self.inner, self.end], len(self.inner) + 2, "parametric.start, inner and end")

    @property
    def knots(self) -> Floats:
        """(m + 1,) float64"""
        return np.array([self.start, *self.inner, self.end])

    def at(self, u: ArrayLike) -> Floats:
        """Points: (...) float in [start, end] to (..., d) float64."""
        return _asked(self.function, parameters(u, self.start, self.end))

    def derivative(self, u: ArrayLike, order: int = 1) -> Floats:
        """Derivatives: (...) float in [start, end] to (..., d) float64."""
        t = parameters(u, self.start, self.end)
        known = (self.function, *self.derivatives)
        if degree_of(order) < len(known):
            return _asked(known[order], t)
        return _difference(known[-1], t, order - len(known) + 1, self.knots)


def _asked(function: Function, t: Floats) -> Floats:
    made = np.asarray(function(t), dtype=np.float64)
    if made.ndim != t.ndim + 1 or made.shape[:-1] != t.shape:
        raise SceneError(f"a curve's function must return shape {(*t.shape, 'd')} for parameters of shape {t.shape}, got {made.shape}")
    if not np.isfinite(made).all():
        bad = float(t[~np.isfinite(made).all(axis=-1)][0]) if t.ndim else float(t)
        raise SceneError(f"a curve's function must be finite in its interval, got NaN or infinity at {bad:g}")
    return made


def _difference(function: Function, t: Floats, order: int, knots: Floats) -> Floats:
    """A derivative as a sum over points that are moved to where the function has no break."""
    if order >= _STENCIL:
        raise UnsupportedError(f"derivatives by differences go up to order {_STENCIL - 1}, got {order}; give the derivatives")
    row = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(knots) - 2)
    low, high = knots[row], knots[row + 1]
    # Where rounding, eps / h^order, and what is left out, h^(9 - order), weigh the same; steps that the interval is long for
    step = (high - low) * np.finfo(np.float64).eps ** (1.0 / _STENCIL) / (_STENCIL - 1.0)
    offset = np.arange(_STENCIL) - (_STENCIL - 1) // 2
    first = np.clip(t + offset[0] * step, low, high - (_STENCIL - 1.0) * step)
    places = first[..., None] + step[..., None] * np.arange(_STENCIL)
    # Where t lies in units of the steps, which differs near an end of the interval
    local = (places - t[..., None]) / step[..., None]
    matrix = local[..., None, :] ** np.arange(_STENCIL)[:, None]
    target = np.zeros((*t.shape, _STENCIL))
    target[..., order] = math.factorial(order)
    weights = np.linalg.solve(matrix, target[..., None])[..., 0] / step[..., None] ** order
    return np.asarray((weights[..., None] * _asked(function, np.clip(places, low[..., None], high[..., None]))).sum(axis=-2))


def composed(curve: Curve, change: Function, start: float, end: float, derivatives: tuple[Function, ...] = ()) -> Parametric:
    """Run along a curve in another way: ``g(s) = f(change(s))`` (FoCG 15.1.1).

    Parameters
    ----------
    curve : Curve
    change : callable
        (...) float64 to (...) float64, from [start, end] into the curve's interval.
    start, end : float
    derivatives : tuple of callables
        The first derivatives of `change`, at most two; with them those of the curve are exact, by the chain rule.

    Returns
    -------
    Parametric

    Examples
    --------
    >>> line = Spline.bezier([[0.0, 0.0], [1.0, 2.0]])
    >>> composed(line, lambda s: s * s, 0.0, 1.0, (lambda s: 2.0 * s,)).derivative(0.5).tolist()
    [1.0, 2.0]
    """
    known: list[Function] = []
    if derivatives:
        rate = derivatives[0]
        known.append(lambda s: curve.derivative(change(s)) * rate(s)[..., None])
    if len(derivatives) > 1:
        bend = derivatives[1]
        known.append(
            lambda s: curve.derivative(change(s), 2) * rate(s)[..., None] ** 2 + curve.derivative(change(s)) * bend(s)[..., None]
        )
    return Parametric(lambda s: curve.at(change(s)), start, end, tuple(known))


def on_unit_interval(curve: Curve) -> Parametric:
    """Run along a curve while the parameter goes from 0 to 1, in proportion."""
    low, span = float(curve.knots[0]), float(curve.knots[-1] - curve.knots[0])
    return _moved(curve, low, span)


def backwards(curve: Curve) -> Parametric:
    """Run along a curve from its end to its start while the parameter goes from 0 to 1."""
    return _moved(curve, float(curve.knots[-1]), float(curve.knots[0] - curve.knots[-1]))


def _moved(curve: Curve, origin: float, span: float) -> Parametric:
    inner = tuple(sorted(((curve.knots[1:-1] - origin) / span).tolist()))

    def of_order(order: int) -> Function:
        return lambda s: span**order * curve.derivative(origin + span * s, order)

    return Parametric(lambda s: curve.at(origin + span * s), 0.0, 1.0, (of_order(1), of_order(2), of_order(3)), inner)
