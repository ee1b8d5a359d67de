"""B-splines: a curve of many pieces that one polygon draws, each point of it pulling on its neighbourhood only (FoCG 15.6.2).

With n control points and degree p there are n + p + 1 knots; between two knots the curve is a polynomial, and a knot that stands there
k times leaves p - k continuous derivatives. The point for arguments a1, ..., ap that its piece's polynomial has in the symmetric,
multi-affine form (its *blossom*) says it all: at (u, u, ..., u) it is the curve, at p successive knots a control point, at a, ..., b,
... a Bézier point of the piece from a to b.

**Source**: de Boor, "On calculating with B-splines", 1972; Ramshaw, *Blossoming: a connect-the-dots approach to splines*, 1987.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .control import control_points, degree_of, parameters
from .curve import Spline

__all__ = [
    "basis", "check_knots", "clamped_knots", "derivative", "evaluate", "insert", "interpolate", "periodic", "spline", "uniform_knots",
]  # fmt: skip

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


def clamped_knots(count: int, degree: int = 3) -> Floats:
    """Return knots for `count` control points, (count + degree + 1,) float64: equal steps from 0 to 1, the ends `degree` + 1 times.

    The curve starts in the first control point and ends in the last.

    >>> clamped_knots(5, 3).tolist()
    [0.0, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0]
    """
    p = degree_of(degree, 1)
    _check_count(count, p)
    return np.concatenate([np.zeros(p), np.arange(count - p + 1) / (count - p), np.ones(p)])


def uniform_knots(count: int, degree: int = 3) -> Floats:
    """Return the knots 0, 1, 2, ... for `count` control points, (count + degree + 1,) float64."""
    p = degree_of(degree, 1)
    _check_count(count, p)
    return np.arange(float(count + p + 1))


def _check_count(count: int, degree: int) -> None:
    if count < degree + 1:
        raise SceneError(f"a B-spline of degree {degree} needs at least {degree + 1} control points, got {count}")


def check_knots(knots: ArrayLike, count: int, degree: int) -> Floats:
    """Return knots as float64; raise SceneError where they cannot be those of `count` control points.

    They are ``count + degree + 1``, finite, never decrease, span an interval between number `degree` and number `count`, and none stands
    there more often than the order, degree + 1 times.
    """
    p = degree_of(degree, 1)
    _check_count(count, p)
    t = np.array(knots, dtype=np.float64)
    if t.shape != (count + p + 1,):
        raise SceneError(f"{count} control points of degree {p} need {count + p + 1} knots, got shape {t.shape}")
    if not np.isfinite(t).all() or (np.diff(t) < 0.0).any():
        raise SceneError(f"knots must be finite and must not decrease, got {t.tolist()}")
    values, counts = np.unique(t, return_counts=True)
    if counts.max() > p + 1:
        k = int(np.argmax(counts))
        raise SceneError(f"a knot must not be repeated beyond the order {p + 1}, got {values[k]:g} {counts[k]} times")
    if not t[p] < t[count]:
        raise SceneError(f"knots {p} and {count} must span an interval, got {t[p]:g} and {t[count]:g}")
    return t


def _span(t: Floats, u: Floats, count: int, degree: int) -> Indices:
    """The number of the last knot not beyond u, of those that begin an interval of the curve."""
    last = int(np.searchsorted(t, t[count], side="left")) - 1
    return np.clip(np.searchsorted(t, u, side="right") - 1, degree, last).astype(np.int64)


def _blossom(control: Floats, t: Floats, degree: int, span: Indices, arguments: Floats) -> Floats:
    """De Boor's triangle with an argument of its own at each level: spans (...), arguments (..., degree), to (..., d)."""
    rows = span[..., None] - degree + np.arange(degree + 1)
    level = control[rows]
    for k in range(degree):
        first = rows[..., k + 1 :]
        low, high = t[first], t[first + degree - k]
        share = ((arguments[..., k : k + 1] - low) / (high - low))[..., None]
        level = (1.0 - share) * level[..., :-1, :] + share * level[..., 1:, :]
    return level[..., 0, :]


def evaluate(control: ArrayLike, u: ArrayLike, knots: ArrayLike | None = None, degree: int = 3) -> Floats:
    """Evaluate a B-spline curve by de Boor's repeated interpolation.

    Parameters
    ----------
    control : (n, d) float, n > degree
    u : (...) float
        From knot number `degree` to knot number n.
    knots : (n + degree + 1,) float, optional
        None: `clamped_knots`.
    degree : int >= 1

    Returns
    -------
    (..., d) float64

    Examples
    --------
    >>> evaluate([[0, 0], [1, 2], [3, 2], [4, 0]], [0.0, 0.5, 1.0]).tolist()
    [[0.0, 0.0], [2.0, 1.5], [4.0, 0.0]]
    """
    points, t = _checked(control, knots, degree)
    at = parameters(u, float(t[degree]), float(t[len(points)]))
    return _blossom(points, t, degree, _span(t, at, len(points), degree), np.broadcast_to(at[..., None], (*at.shape, degree)))


def derivative(control: ArrayLike, u: ArrayLike, knots: ArrayLike | None = None, degree: int = 3, order: int = 1) -> Floats:
    """Evaluate a derivative, (..., d) float64: a B-spline again, of the polygon's legs; at a knot that of the piece that begins there.

    **Source**: Piegl and Tiller, *The NURBS Book*, 2nd ed., 1997, 3.3.
    """
    points, t = _checked(control, knots, degree)
    at = parameters(u, float(t[degree]), float(t[len(points)]))
    p = degree
    for _ in range(degree_of(order)):
        if p == 0:
            return np.zeros((*at.shape, points.shape[1]))
        span = (t[p + 1 : -1] - t[1 : -p - 1])[:, None]
        points = p * np.diff(points, axis=0) / np.where(span > 0.0, span, 1.0)
        t, p = t[1:-1], p - 1
    return _blossom(points, t, p, _span(t, at, len(points), p), np.broadcast_to(at[..., None], (*at.shape, p)))


def _checked(control: ArrayLike, knots: ArrayLike | None, degree: int) -> tuple[Floats, Floats]:
    points = control_points(control)
    made = clamped_knots(len(points), degree) if knots is None else knots
    return points, check_knots(made, len(points), degree)


def basis(knots: ArrayLike, degree: int, u: ArrayLike) -> Floats:
    """Evaluate all basis functions, (..., n) float64: not negative, with a sum of 1, and at most degree + 1 of them not 0.

    Parameters
    ----------
    knots : (n + degree + 1,) float
    degree : int >= 1
    u : (...) float
        From knot number `degree` to knot number n.

    Examples
    --------
    >>> basis(clamped_knots(4, 2), 2, 0.25).tolist()
    [0.25, 0.625, 0.125, 0.0]
    """
    return evaluate(np.eye(max(1, len(np.asarray(knots)) - degree_of(degree, 1) - 1)), u, knots, degree)


def insert(control: ArrayLike, knots: ArrayLike, degree: int, at: ArrayLike) -> tuple[Floats, Floats]:
    """Insert knots; the curve stays as it is.

    Parameters
    ----------
    control : (n, d) float
    knots : (n + degree + 1,) float
    degree : int >= 1
    at : (m,) float
        From knot number `degree` to knot number n, ends excluded.

    Returns
    -------
    control : (n + m, d) float64
    knots : (n + m + degree + 1,) float64

    **Source**: Boehm, "Inserting new knots into B-spline curves", *Computer-Aided Design* 12(4), 1980.
    """
    points, t = _checked(control, knots, degree)
    for knot in np.atleast_1d(np.asarray(at, dtype=np.float64)).tolist():
        if not t[degree] < knot < t[len(points)]:
            raise SceneError(f"a knot must be inserted within ({t[degree]:g}, {t[len(points)]:g}), got {knot}")
        k = int(np.searchsorted(t, knot, side="right")) - 1
        rows = np.arange(k - degree + 1, k + 1)
        share = ((knot - t[rows]) / (t[rows + degree] - t[rows]))[:, None]
        cut = (1.0 - share) * points[rows - 1] + share * points[rows]
        points = np.concatenate([points[: k - degree + 1], cut, points[k:]])
        t = check_knots(np.insert(t, k + 1, knot), len(points), degree)
    return points, t


def spline(control: ArrayLike, knots: ArrayLike | None = None, degree: int = 3, *, rational: bool = False) -> Spline:
    """Turn a B-spline curve into its Bézier pieces.

    Parameters
    ----------
    control : (n, d) float, n > degree
    knots : (n + degree + 1,) float, optional
        None: `clamped_knots`.
    degree : int >= 1
    rational : bool
        The last coordinate is a weight, see `limner.curves.nurbs`.

    Returns
    -------
    Spline
        The same curve over the same parameters, from knot number `degree` to knot number n.
    """
    points, t = _checked(control, knots, degree)
    ends = np.unique(t[degree : len(points) + 1])
    span = _span(t, ends[:-1], len(points), degree)
    pieces = []
    for k in range(degree + 1):
        arguments = np.concatenate([np.repeat(ends[:-1, None], degree - k, 1), np.repeat(ends[1:, None], k, 1)], axis=1)
        pieces.append(_blossom(points, t, degree, span, arguments))
    return Spline(ends, np.stack(pieces, axis=1), rational)


def periodic(control: ArrayLike, degree: int = 3) -> Spline:
    """Draw a closed uniform B-spline, smooth everywhere, over [0, n].

    Parameters
    ----------
    control : (n, d) float, n >= degree
        The first is not repeated.
    degree : int >= 1
    """
    p = degree_of(degree, 1)
    points = control_points(control, max(3, p))
    around = np.concatenate([points, points[:p]])
    made = spline(around, uniform_knots(len(around), p), p)
    return Spline(made.knots - made.knots[0], made.pieces)


def interpolate(points: ArrayLike, degree: int = 3, u: ArrayLike | None = None) -> tuple[Floats, Floats]:
    """Find the B-spline through points.

    Parameters
    ----------
    points : (n, d) float, n > degree
    degree : int >= 1
    u : (n,) float, optional
        Increasing: where the curve is at the points. None: in proportion to the length of the polygon up to them.

    Returns
    -------
    control : (n, d) float64
    knots : (n + degree + 1,) float64
        Inner knots are means of `degree` successive parameters.

    **Source**: Piegl and Tiller 1997, 9.2.1, equation 9.8.
    """
    p, degree = control_points(points), degree_of(degree, 1)
    _check_count(len(p), degree)
    if u is None:
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
        u = along / along[-1] if along[-1] > 0.0 else along
    at = np.asarray(u, dtype=np.float64)
    if at.shape != (len(p),) or not (np.diff(at) > 0.0).all():
        raise SceneError("points must differ from their neighbours, and their parameters must increase")
    inner = [float(at[k : k + degree].mean()) for k in range(1, len(p) - degree)]
    knots = np.array([*[at[0]] * (degree + 1), *inner, *[at[-1]] * (degree + 1)])
    return np.asarray(np.linalg.solve(basis(knots, degree, at), p), dtype=np.float64), knots
