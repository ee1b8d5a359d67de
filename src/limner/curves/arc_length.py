"""Arc length: how long a curve is, and running along it at an even speed (FoCG 15.1.1).

The length is the integral of the speed |f'|. It is taken piece by piece by a Gauss rule of seven points inside a Kronrod rule of
fifteen; what the two disagree about bounds the error, and pieces that err too much are halved, all at once.

    even = ArcLength(curve)
    curve.at(even.parameter(np.linspace(0.0, even.length, 25)))      # 25 points at equal distances along the curve
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import RenderError, SceneError
from .control import parameters
from .curve import Curve, Parametric

__all__ = ["ArcLength", "length"]

Floats = NDArray[np.float64]

# Positive nodes of the rule of fifteen, its weights, and those of the rule of seven (zero where it has no node).
# Source: Piessens, de Doncker-Kapenga, Überhuber and Kahaner, *QUADPACK*, 1983.
_HALF_NODES = (
    0.0, 0.20778495500789848, 0.40584515137739717, 0.58608723546769113, 0.74153118559939444, 0.86486442335976907, 0.94910791234275852,
    0.99145537112081264,
)  # fmt: skip
_HALF_KRONROD = (
    0.20948214108472783, 0.20443294007529889, 0.19035057806478540, 0.16900472663926790, 0.14065325971552592, 0.10479001032225018,
    0.06309209262997856, 0.02293532201052922,
)  # fmt: skip
_HALF_GAUSS = (0.41795918367346939, 0.0, 0.38183005050511894, 0.0, 0.27970539148927667, 0.0, 0.12948496616886969, 0.0)


def _mirrored(half: tuple[float, ...], sign: float) -> Floats:
    return np.array([sign * x for x in half[:0:-1]] + list(half))


_NODES, _KRONROD, _GAUSS = _mirrored(_HALF_NODES, -1.0), _mirrored(_HALF_KRONROD, 1.0), _mirrored(_HALF_GAUSS, 1.0)

_MOST_PIECES = 1 << 16
_MOST_HALVINGS = 48
_NEWTON_STEPS = 60


def length(curve: Curve, start: float | None = None, end: float | None = None, tolerance: float = 1e-10) -> float:
    """Measure a curve, or a part of it.

    Parameters
    ----------
    curve : Curve
    start, end : float, optional
        Parameters, in order; None: those of the curve.
    tolerance : float > 0
        Relative: how far the result may be off.

    Returns
    -------
    float

    Examples
    --------
    >>> from limner.curves.nurbs import circle
    >>> round(length(circle()) / math.pi, 9)
    2.0
    """
    low = float(curve.knots[0]) if start is None else float(parameters(start, curve.knots[0], curve.knots[-1]))
    high = float(curve.knots[-1]) if end is None else float(parameters(end, curve.knots[0], curve.knots[-1]))
    if high < low:
        raise SceneError(f"a part of a curve must not end, at {high:g}, before it starts, at {low:g}")
    if high == low:
        return 0.0
    return float(_pieces(curve, low, high, tolerance)[1].sum())


def _pieces(curve: Curve, low: float, high: float, tolerance: float) -> tuple[Floats, Floats]:
    """Ends of pieces (k + 1,), on each of which one rule is exact enough, and their lengths (k,)."""
    if not 0.0 < tolerance < 1.0:
        raise SceneError(f"the tolerance of a length must lie in (0, 1), got {tolerance}")
    knots = curve.knots
    ends = np.unique(np.concatenate([[low], knots[(knots > low) & (knots < high)], [high]]))
    a, b = ends[:-1], ends[1:]
    done_a, done_length = [np.zeros(0)], [np.zeros(0)]
    total = 0.0
    for _ in range(_MOST_HALVINGS):
        fine, error = _rules(curve, a, b)
        total = sum(float(part.sum()) for part in done_length) + float(fine.sum())
        # No piece may err by more than its share, nor is less asked of it than its sum can be held to
        share = np.maximum(0.5 * tolerance * total * np.maximum((b - a) / (high - low), 2.0**-10), 4e-16 * total)
        good = error <= share
        done_a.append(a[good])
        done_length.append(fine[good])
        a, b = a[~good], b[~good]
        if not len(a):
            break
        if len(a) > _MOST_PIECES:
            raise RenderError(f"the length of the curve could not be found to {tolerance:g}: its speed jumps too often")
        middle = 0.5 * (a + b)
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    else:
        # Pieces that are left are as short as numbers go: a jump of the speed, which counts for nothing
        done_a.append(a)
        done_length.append(_rules(curve, a, b)[0])
    starts, lengths = np.concatenate(done_a), np.concatenate(done_length)
    order = np.argsort(starts)
    return np.append(starts[order], high), lengths[order]


def _rules(curve: Curve, a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Length of each piece, and a bound of its error."""
    half = 0.5 * (b - a)
    speed = np.linalg.norm(curve.derivative(0.5 * (a + b)[:, None] + half[:, None] * _NODES), axis=-1)
    fine = half * (speed @ _KRONROD)
    return fine, np.abs(fine - half * (speed @ _GAUSS))


class ArcLength:
    """A curve, measured: parameters from lengths and lengths from parameters.

    Parameters
    ----------
    curve : Curve
    tolerance : float > 0
        Relative to the whole length: how far any length may be off.

    Attributes
    ----------
    length : float
        Of the whole curve.

    Examples
    --------
    >>> square = Parametric(lambda u: np.stack([u * u, 0.0 * u], axis=-1), 0.0, 2.0, (lambda u: np.stack([2.0 * u, 0.0 * u], axis=-1),))
    >>> even = ArcLength(square)
    >>> round(even.length, 9), even.parameter([0.0, 1.0, 4.0]).round(9).tolist()
    (4.0, [0.0, 1.0, 2.0])
    """

    def __init__(self, curve: Curve, tolerance: float = 1e-10) -> None:
        self.curve, self.tolerance = curve, tolerance
        self._ends, lengths = _pieces(curve, float(curve.knots[0]), float(curve.knots[-1]), tolerance)
        self._sums = np.concatenate([[0.0], np.cumsum(lengths)])
        self.length = float(self._sums[-1])
        if not self.length > 0.0:
            raise SceneError("a curve that is one point cannot be run along")

    def at(self, u: ArrayLike) -> Floats:
        """Length from the start to a parameter, (...) float64."""
        t = parameters(u, self._ends[0], self._ends[-1])
        row = np.clip(np.searchsorted(self._ends, t, side="right") - 1, 0, len(self._ends) - 2)
        return self._sums[row] + self._within(row, t)

    def _within(self, row: NDArray[np.int64], t: Floats) -> Floats:
        """Length from the start of a piece to a parameter in it."""
        half = 0.5 * (t - self._ends[row])
        places = self._ends[row][..., None] + half[..., None] * (_NODES + 1.0)
        return np.asarray(half * (np.linalg.norm(self.curve.derivative(places), axis=-1) @ _KRONROD))

    def parameter(self, lengths: ArrayLike) -> Floats:
        """Parameters at which the curve has run a length.

        Parameters
        ----------
        lengths : (...) float in [0, length]

        Returns
        -------
        (...) float64
            Found by Newton's steps, which are halvings where they would leave what holds the answer.
        """
        s = parameters(lengths, 0.0, self.length)
        flat = s.reshape(-1)
        row = np.clip(np.searchsorted(self._sums, flat, side="right") - 1, 0, len(self._ends) - 2)
        low, high = self._ends[row].copy(), self._ends[row + 1].copy()
        wanted = flat - self._sums[row]
        share = np.diff(self._sums)[row]
        t = low + (high - low) * np.clip(wanted / np.where(share > 0.0, share, 1.0), 0.0, 1.0)
        enough = 0.1 * self.tolerance * self.length
        for _ in range(_NEWTON_STEPS):
            off = self._within(row, t) - wanted
            low, high = np.where(off < 0.0, t, low), np.where(off > 0.0, t, high)
            if (np.abs(off) <= enough).all():
                break
            speed = np.linalg.norm(self.curve.derivative(t), axis=-1)
            step = t - off / np.where(speed > 0.0, speed, 1.0)
            moved = np.where((speed > 0.0) & (step >= low) & (step <= high), step, 0.5 * (low + high))
            t = np.where(np.abs(off) <= enough, t, moved)
        return t.reshape(s.shape)

    def curve_by_length(self) -> Parametric:
        """The same curve over [0, length], with speed 1: its second derivative is the curvature vector."""
        return Parametric(lambda s: self.curve.at(self.parameter(s)), 0.0, self.length, (self._direction,))

    def _direction(self, s: Floats) -> Floats:
        first = self.curve.derivative(self.parameter(s))
        speed = np.linalg.norm(first, axis=-1, keepdims=True)
        return np.asarray(first / np.where(speed > 0.0, speed, math.inf))
