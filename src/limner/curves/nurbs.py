"""NURBS: rational B-splines, in which circles, conics and free forms are of one kind.

    f(u) = sum_k N_k(u) w_k p_k / sum_k N_k(u) w_k

**Source**: Piegl and Tiller, *The NURBS Book*, 2nd ed., 1997, 4 and 7.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import bspline
from .control import degree_of
from .curve import Spline
from .rational import arc, homogeneous, plain, quotient

__all__ = ["circle", "circle_arc", "derivative", "evaluate", "insert", "spline"]

Floats = NDArray[np.float64]


def evaluate(control: ArrayLike, weights: ArrayLike, u: ArrayLike, knots: ArrayLike | None = None, degree: int = 3) -> Floats:
    """Evaluate a NURBS curve.

    Parameters
    ----------
    control : (n, d) float, n > degree
    weights : (n,) float > 0
    u : (...) float
        From knot number `degree` to knot number n.
    knots : (n + degree + 1,) float, optional
        None: `limner.curves.bspline.clamped_knots`.
    degree : int >= 1

    Returns
    -------
    (..., d) float64
    """
    lifted = bspline.evaluate(homogeneous(control, weights), u, knots, degree)
    return lifted[..., :-1] / lifted[..., -1:]


def derivative(
    control: ArrayLike, weights: ArrayLike, u: ArrayLike, knots: ArrayLike | None = None, degree: int = 3, order: int = 1
) -> Floats:
    """Evaluate a derivative, (..., d) float64."""
    lifted = homogeneous(control, weights)
    return quotient([bspline.derivative(lifted, u, knots, degree, k) for k in range(degree_of(order) + 1)])


def insert(control: ArrayLike, weights: ArrayLike, knots: ArrayLike, degree: int, at: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Insert knots; returns control points, weights and knots of the same curve."""
    lifted, t = bspline.insert(homogeneous(control, weights), knots, degree, at)
    return *plain(lifted), t


def spline(control: ArrayLike, weights: ArrayLike, knots: ArrayLike | None = None, degree: int = 3) -> Spline:
    """Turn a NURBS curve into its rational Bézier pieces."""
    return bspline.spline(homogeneous(control, weights), knots, degree, rational=True)


def circle_arc(start: float, sweep: float, radius: float = 1.0, center: ArrayLike = (0.0, 0.0)) -> Spline:
    """Draw a part of a circle, exactly, over as many units of the parameter as it has pieces.

    Parameters
    ----------
    start, sweep : float
        Radians, counter-clockwise; up to a whole turn either way.
    radius : float > 0
    center : (2,) float

    Returns
    -------
    Spline
        Rational, of degree 2, a piece for each quarter turn.
    """
    if not 0.0 < abs(sweep) <= 2.0 * math.pi * (1.0 + 1e-12):
        raise SceneError(f"an arc must sweep at most a whole turn, and not 0, got {sweep} radians")
    parts = math.ceil(abs(sweep) / (0.5 * math.pi) - 1e-9)
    step = sweep / parts
    pieces = [homogeneous(*arc(start + k * step, step, radius, center)) for k in range(parts)]
    return Spline(np.arange(parts + 1.0), np.array(pieces), rational=True)


def circle(radius: float = 1.0, center: ArrayLike = (0.0, 0.0)) -> Spline:
    """Draw a circle, exactly, over [0, 4].

    >>> bool(np.allclose(np.linalg.norm(circle(2.0).at(np.linspace(0.0, 4.0, 9)), axis=1), 2.0))
    True
    """
    return circle_arc(0.0, 2.0 * math.pi, radius, center)
