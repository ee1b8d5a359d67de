"""Flattening: a curve as straight lines that nowhere stray from it by more than a tolerance.

A Bézier curve strays from the chord between its ends by no more than its polygon bends (`straying`): that is a promise, and holds for
whole chords. Any other curve can only be looked at here and there, and is halved until what is seen is straight enough.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import RenderError, SceneError
from . import bezier
from .control import control_points
from .curve import Curve, Spline

__all__ = ["bezier_parameters", "chords", "flattened", "parameters_of", "straying"]

Floats = NDArray[np.float64]

_MOST_POINTS = 1 << 20
_MOST_HALVINGS = 30
_LOOKS = np.array([0.137, 0.25, 0.391, 0.5, 0.609, 0.75, 0.863])  # where a chord is compared with its curve


def straying(points: ArrayLike) -> float:
    """Bound how far a Bézier curve strays from the line through the same share of its chord.

    Parameters
    ----------
    points : (n + 1, d) float

    Returns
    -------
    float
        ``n (n - 1) / 8`` times the greatest second difference of the control points.

    **Source**: Filip, Magedson and Markot, "Surface algorithms using bounds on derivatives", *CAGD* 3(4), 1986.
    """
    control = control_points(points)
    degree = len(control) - 1
    if degree < 2:
        return 0.0
    return degree * (degree - 1) / 8.0 * float(np.linalg.norm(bezier.second_differences(control), axis=1).max())


def chords(points: ArrayLike, tolerance: float) -> int:
    """Count the chords of equal steps of u that a Bézier curve needs: straying falls with their number squared."""
    return max(1, math.ceil(math.sqrt(straying(points) / _checked(tolerance))))


def _checked(tolerance: float) -> float:
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise SceneError(f"the tolerance of a flattening must be positive, got {tolerance}")
    return tolerance


def bezier_parameters(points: ArrayLike, tolerance: float) -> Floats:
    """Find parameters from 0 to 1 between which no chord strays by more than a tolerance: more of them where the curve bends more.

    Parameters
    ----------
    points : (n + 1, d) float
        Control points.
    tolerance : float > 0

    Returns
    -------
    (k,) float64
        In order, 0 and 1 among them.

    Examples
    --------
    >>> bezier_parameters([[0, 0], [1, 2], [2, 0]], 0.1).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    _checked(tolerance)
    waiting, found = [(0.0, 1.0, control_points(points))], [0.0]
    while waiting:
        low, high, here = waiting.pop()
        # What is as short as numbers go cannot bend
        if straying(here) <= tolerance or high - low < 2.0**-_MOST_HALVINGS:
            found.append(high)
            if len(found) > _MOST_POINTS:
                raise RenderError(f"a tolerance of {tolerance:g} would take more than {_MOST_POINTS:,} lines")
            continue
        left, right = bezier.split(here)
        middle = 0.5 * (low + high)
        waiting += [(middle, high, right), (low, middle, left)]
    return np.array(found)


def parameters_of(curve: Curve, tolerance: float) -> Floats:
    """Find parameters of any curve between which chords stray by no more than a tolerance.

    Parameters
    ----------
    curve : Curve
    tolerance : float > 0

    Returns
    -------
    (k,) float64
        In order, all knots among them. For splines that are not rational the tolerance is a promise.
    """
    if isinstance(curve, Spline) and not curve.rational:
        spans = np.diff(curve.knots)
        parts = [
            curve.knots[k] + spans[k] * bezier_parameters(piece, tolerance)[:-1] for k, piece in enumerate(curve.pieces)
        ]
        return np.append(np.concatenate(parts), curve.knots[-1])
    _checked(tolerance)
    # At first eight chords a piece, lest a symmetric one look straight
    found = [np.linspace(a, b, 9)[:-1] for a, b in zip(curve.knots[:-1], curve.knots[1:], strict=True)]
    starts = np.concatenate(found)
    ends = np.append(starts[1:], curve.knots[-1])
    done = [np.zeros(0)]
    for _ in range(_MOST_HALVINGS):
        good = _off_chord(curve, starts, ends) <= tolerance
        done.append(ends[good])
        starts, ends = starts[~good], ends[~good]
        if not len(starts):
            break
        if len(starts) > _MOST_POINTS:
            raise RenderError(f"a tolerance of {tolerance:g} would take more than {_MOST_POINTS:,} lines")
        middle = 0.5 * (starts + ends)
        starts, ends = np.concatenate([starts, middle]), np.concatenate([middle, ends])
    else:
        done.append(ends)
    return np.sort(np.concatenate([curve.knots[:1], *done]))


def _off_chord(curve: Curve, starts: Floats, ends: Floats) -> Floats:
    """Greatest distance of the points looked at from the line through the ends; where these coincide, from them."""
    a, b = curve.at(starts)[:, None], curve.at(ends)[:, None]
    seen = curve.at(starts[:, None] + (ends - starts)[:, None] * _LOOKS)
    along = b - a
    squared = (along * along).sum(axis=-1, keepdims=True)
    share = ((seen - a) * along).sum(axis=-1, keepdims=True) / np.where(squared > 0.0, squared, 1.0)
    return np.asarray(np.linalg.norm(seen - a - np.clip(share, 0.0, 1.0) * along, axis=-1).max(axis=1))


def flattened(curve: Curve, tolerance: float) -> Floats:
    """Return points of a curve, (k, d) float64, joined by lines that stray from it by no more than a tolerance."""
    return curve.at(parameters_of(curve, tolerance))
