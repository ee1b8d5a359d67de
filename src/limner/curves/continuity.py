"""Continuity: how smoothly two curves meet, measured, and curves that go on as smoothly as wanted (FoCG 15.2.1).

    C^n     the first n derivatives by the parameter are equal
    G^1     the tangents have one direction: f1'(1) = k f2'(0) with k > 0
    G^2     so they have, and one curvature

Where the derivative does not vanish, C^n implies G^n; not the other way. G^n asks for derivatives that a change of the parameter's speed
would make equal, the beta constraints, in which b1 > 0, b2 and b3 may be anything:

    r'   = b1 l'
    r''  = b1^2 l'' + b2 l'
    r''' = b1^3 l''' + 3 b1 b2 l'' + b3 l'

**Source**: Barsky and DeRose, "Geometric continuity of parametric curves", *IEEE Computer Graphics and Applications* 9(6), 1989.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from .bernstein import binomials
from .control import control_points, degree_of
from .curve import Curve, Spline
from .frames import curvature_vector

__all__ = ["Joint", "between", "continued", "joints", "linked"]

Floats = NDArray[np.float64]

_MOST_BETAS = 3


class Joint(NamedTuple):
    """How two curves meet.

    Attributes
    ----------
    parametric : int
        The greatest n for which they are C^n; -1: there is a gap.
    geometric : int
        The greatest n up to 2 for which they are G^n; -1: there is a gap, 0: a corner, or no tangent.
    gaps : (k + 1,) float64
        Distances between the points, between the first derivatives, and so on.
    angle : float
        Between the tangents, radians; NaN where a derivative vanishes.
    curvature_gap : float
        Length of the difference between the curvature vectors; NaN where a derivative vanishes.
    beta1, beta2 : float
        The constraints' numbers, by least squares; NaN where a derivative vanishes.
    """

    parametric: int
    geometric: int
    gaps: Floats
    angle: float
    curvature_gap: float
    beta1: float
    beta2: float

    def report(self) -> str:
        """One line for people."""
        c = f"C{self.parametric}" if self.parametric >= 0 else "a gap"
        g = f"G{self.geometric}" if self.geometric >= 0 else "a gap"
        gaps = ", ".join(f"{gap:.3g}" for gap in self.gaps)
        return (
            f"{c}, {g}; gaps of derivatives 0 to {len(self.gaps) - 1}: {gaps}; angle {math.degrees(self.angle):.3g} degrees, "
            f"curvature gap {self.curvature_gap:.3g}, beta {self.beta1:.4g}, {self.beta2:.4g}"
        )


def between(left: Curve, right: Curve, order: int = 3, tolerance: float = 1e-9) -> Joint:
    """Measure how the end of one curve meets the start of another.

    Parameters
    ----------
    left, right : Curve
    order : int >= 2
        Up to which derivatives are compared.
    tolerance : float > 0
        Relative: of derivatives against the greater of both (points against the curves' size), of the angle in radians, of curvature
        against the greater of both curvatures or one over the size.

    Returns
    -------
    Joint

    Examples
    --------
    >>> a, b = Spline.bezier([[0, 0], [1, 0], [2, 0]]), Spline.bezier([[2, 0], [3, 0], [4, 1]])
    >>> joint = between(a, b)
    >>> joint.parametric, joint.geometric, joint.beta1
    (1, 1, 1.0)
    """
    before = [left.derivative(left.knots[-1], k) if k else left.at(left.knots[-1]) for k in range(max(2, degree_of(order)) + 1)]
    if isinstance(left, Spline):
        # The last piece's own derivatives, at the end of which no other begins
        before = _of_end(left, len(before) - 1)
    after = [right.derivative(right.knots[0], k) if k else right.at(right.knots[0]) for k in range(len(before))]
    return _joint(before, after, max(_size(left), _size(right)), tolerance)


def joints(spline: Spline, tolerance: float = 1e-9, closed: bool = False) -> list[Joint]:
    """Measure all joints of a spline, in order; the last one of a closed spline is that of its end and its start."""
    pieces = [Spline(spline.knots[k : k + 2], spline.pieces[k : k + 1], spline.rational) for k in range(len(spline.pieces))]
    pairs = list(zip(pieces, [*pieces[1:], pieces[0]], strict=True))
    order = max(2, spline.degree)
    return [between(a, b, order, tolerance) for a, b in (pairs if closed else pairs[:-1])]


def _of_end(spline: Spline, order: int) -> list[Floats]:
    end = spline.knots[-1]
    last = Spline(spline.knots[-2:], spline.pieces[-1:], spline.rational)
    return [last.derivative(end, k) if k else last.at(end) for k in range(order + 1)]


def _size(curve: Curve) -> float:
    points = curve.at(np.linspace(curve.knots[0], curve.knots[-1], 17))
    return float(np.ptp(points, axis=0).max())


def _joint(before: list[Floats], after: list[Floats], size: float, tolerance: float) -> Joint:
    gaps = np.array([float(np.linalg.norm(a - b)) for a, b in zip(before, after, strict=True)])
    # Derivatives that are nothing but rounding are compared with those of a curve of that size
    scales = [max(size, float(np.linalg.norm(a)), float(np.linalg.norm(b))) for a, b in zip(before, after, strict=True)]
    close = gaps <= tolerance * np.array([size, *scales[1:]])
    parametric = (len(gaps) if close.all() else int(np.argmin(close))) - 1
    speeds = np.linalg.norm(before[1]), np.linalg.norm(after[1])
    if min(speeds) <= tolerance * size:
        return Joint(parametric, min(parametric, 0), gaps, math.nan, math.nan, math.nan, math.nan)
    tangents = before[1] / speeds[0], after[1] / speeds[1]
    angle = 2.0 * math.asin(min(1.0, 0.5 * float(np.linalg.norm(tangents[0] - tangents[1]))))
    bends = curvature_vector(before[1], before[2]), curvature_vector(after[1], after[2])
    curvature_gap = float(np.linalg.norm(bends[0] - bends[1]))
    bend = max(float(np.linalg.norm(bends[0])), float(np.linalg.norm(bends[1])), 1.0 / size)
    geometric = -1 if not close[0] else 0 if angle > tolerance else 1 if curvature_gap > tolerance * bend else 2
    beta1 = float(speeds[1] / speeds[0])
    beta2 = float((after[2] - beta1**2 * before[2]) @ before[1] / speeds[0] ** 2)
    return Joint(parametric, geometric, gaps, angle, curvature_gap, beta1, beta2)


def continued(left: ArrayLike, order: int, degree: int | None = None, betas: tuple[float, ...] = ()) -> Floats:
    """Find the first control points of a Bézier curve that goes on from another.

    Parameters
    ----------
    left : (m + 1, d) float
        Control points.
    order : int >= 0
        How smoothly: n of C^n, or of G^n where there are betas.
    degree : int >= order, optional
        Of the curve that goes on; None: m.
    betas : up to three floats
        b1 > 0, b2, b3 of the constraints; those that are missing are 1, 0, 0, with which G^n is C^n.

    Returns
    -------
    (order + 1, d) float64
        The other control points are free.

    Examples
    --------
    >>> continued([[0.0, 0.0], [1.0, 0.0], [2.0, 1.0]], 1, betas=(2.0,)).tolist()
    [[2.0, 1.0], [4.0, 3.0]]
    """
    control = control_points(left)
    n = len(control) - 1 if degree is None else degree_of(degree)
    if degree_of(order) > n:
        raise SceneError(f"a curve of degree {n} cannot go on to order {order}")
    derivatives, scale = [control[-1]], 1.0
    legs = control
    for k in range(order):
        scale *= max(0, len(control) - 1 - k)
        legs = np.diff(legs, axis=0) if len(legs) > 1 else np.zeros((1, control.shape[1]))
        derivatives.append(scale * legs[-1])
    wanted = _constrained(derivatives, betas)
    # f^(j)(0) = n! / (n - j)! times the j-th difference of the control points
    scaled, falling = [], 1.0
    for j, value in enumerate(wanted):
        scaled.append(value / falling)
        falling *= n - j
    return np.array([binomials(k) @ np.array(scaled[: k + 1]) for k in range(order + 1)])


def _constrained(derivatives: list[Floats], betas: tuple[float, ...]) -> list[Floats]:
    if not betas:
        return derivatives
    if len(derivatives) > _MOST_BETAS + 1 or len(betas) > _MOST_BETAS:
        raise UnsupportedError(f"beta constraints go up to order {_MOST_BETAS}, got order {len(derivatives) - 1} and {len(betas)} betas")
    b1, b2, b3 = (*betas, 1.0, 0.0, 0.0)[: len(betas)] + (1.0, 0.0, 0.0)[len(betas) :]
    if not b1 > 0.0:
        raise SceneError(f"the first beta must be positive, or the curve turns back, got {b1}")
    point, *rest = derivatives
    made = [point]
    if len(rest) > 0:
        made.append(b1 * rest[0])
    if len(rest) > 1:
        made.append(b1**2 * rest[1] + b2 * rest[0])
    if len(rest) > 2:
        made.append(b1**3 * rest[2] + 3.0 * b1 * b2 * rest[1] + b3 * rest[0])
    return made


def linked(left: ArrayLike, right: ArrayLike, order: int = 2, betas: tuple[float, ...] = ()) -> Floats:
    """Find a Bézier curve that joins the end of one to the start of another, as smoothly at both.

    Parameters
    ----------
    left, right : (m + 1, d), (n + 1, d) float
        Control points.
    order : int >= 0
    betas : up to three floats
        Of both joints, seen from the given curves outwards.

    Returns
    -------
    (2 order + 2, d) float64
        Control points, of degree 2 order + 1.
    """
    degree = 2 * degree_of(order) + 1
    head = continued(left, order, degree, betas)
    tail = continued(control_points(right)[::-1], order, degree, betas)
    return np.concatenate([head, tail[::-1]])
