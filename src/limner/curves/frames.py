"""How a curve turns: curvature, torsion, and frames that go along (FoCG 15.2; 2.4.5 for what a frame is).

The Frenet frame is the curve's own: tangent, the direction in which it bends, and what is left. Where it does not bend there is none,
and where it begins to bend to the other side the frame flips. A frame that does not turn about the tangent more than it must has
neither fault: it is carried along, and carries rings, ribbons and cameras.

**Source**: do Carmo, *Differential Geometry of Curves and Surfaces*, 1976, 1-5; Wang, Jüttler, Zheng and Liu, "Computation of Rotation
Minimizing Frames", *ACM Transactions on Graphics* 27(1), 2008: the double reflection method (algorithm 1).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .curve import Curve

__all__ = [
    "Frames", "curvature", "curvature_vector", "frenet_frames", "rotation_minimizing_frames", "tangents", "torsion", "turned_along",
]  # fmt: skip

Points = NDArray[np.float64]

_STRAIGHT = 1e-12


class Frames(NamedTuple):
    """Unit vectors along a curve, (..., 3) float64: tangent x normal = binormal; a zero vector is one that does not exist."""

    tangent: Points
    normal: Points
    binormal: Points


def tangents(curve: Curve, u: ArrayLike) -> Points:
    """Unit tangents, (..., d) float64; zero where the derivative vanishes."""
    return _unit(curve.derivative(u))


def curvature_vector(first: Points, second: Points) -> Points:
    """The curvature vector from the first two derivatives, (..., d): second derivative by arc length; zero where the first vanishes."""
    squared = (first * first).sum(axis=-1, keepdims=True)
    safe = np.where(squared > 0.0, squared, 1.0)
    across = second - (second * first).sum(axis=-1, keepdims=True) / safe * first
    return np.asarray(np.where(squared > 0.0, across / safe, 0.0))


def curvature(curve: Curve, u: ArrayLike) -> Points:
    """Evaluate the curvature: one over the radius of the circle that fits best.

    Parameters
    ----------
    curve : Curve
    u : (...) float

    Returns
    -------
    (...) float64
        In the plane with a sign, positive where the curve bends to the left; 0 where the derivative vanishes.

    **Source**: ``|f' x f''| / |f'|^3``, do Carmo 1976, 1-5.
    """
    first, second = curve.derivative(u), curve.derivative(u, 2)
    vector = curvature_vector(first, second)
    length = np.linalg.norm(vector, axis=-1)
    if first.shape[-1] != 2:
        return np.asarray(length)
    return np.asarray(np.copysign(length, first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]))


def torsion(curve: Curve, u: ArrayLike) -> Points:
    """Evaluate the torsion of a curve in space, (...) float64: how fast it leaves its plane; 0 where it does not bend.

    **Source**: ``(f' x f'') . f''' / |f' x f''|^2``, do Carmo 1976, 1-5.
    """
    first, second, third = (curve.derivative(u, k) for k in (1, 2, 3))
    if first.shape[-1] != 3:
        raise SceneError(f"torsion is that of curves in space, got {first.shape[-1]} coordinates")
    across = np.cross(first, second)
    squared = (across * across).sum(axis=-1)
    scale = (first * first).sum(axis=-1) * (second * second).sum(axis=-1)
    bends = squared > _STRAIGHT**2 * scale
    return np.asarray(np.where(bends, (across * third).sum(axis=-1) / np.where(bends, squared, 1.0), 0.0))


def frenet_frames(curve: Curve, u: ArrayLike) -> Frames:
    """Evaluate the Frenet frames of a curve in space.

    Parameters
    ----------
    curve : Curve
    u : (...) float

    Returns
    -------
    Frames
        Normal and binormal are zero where the curve does not bend.
    """
    first, second = curve.derivative(u), curve.derivative(u, 2)
    if first.shape[-1] != 3:
        raise SceneError(f"frames are those of curves in space, got {first.shape[-1]} coordinates")
    tangent, vector = _unit(first), curvature_vector(first, second)
    speed_squared = (first * first).sum(axis=-1, keepdims=True)
    least = _STRAIGHT * np.linalg.norm(second, axis=-1, keepdims=True) / np.where(speed_squared > 0.0, speed_squared, 1.0)
    normal = np.where(np.linalg.norm(vector, axis=-1, keepdims=True) > least, _unit(vector), 0.0)
    return Frames(tangent, normal, np.cross(tangent, normal))


def _unit(vectors: Points) -> Points:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(np.where(lengths > 0.0, vectors / np.where(lengths > 0.0, lengths, 1.0), 0.0))


def turned_along(curve: Curve, u: ArrayLike, closed: bool = False) -> Frames:
    """Carry a frame along a curve in space, without turning it about the tangent more than it must.

    Parameters
    ----------
    curve : Curve
    u : (k,) float, k >= 2
        Increasing; the error falls with the fourth power of the steps.
    closed : bool
        The frame at the last parameter must be that at the first: what is left is spread over the length.

    Returns
    -------
    Frames
    """
    points, directions = curve.at(u), tangents(curve, u)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
        raise SceneError(f"frames are carried along 2 or more points in space, got shape {points.shape}")
    if not directions.any(axis=1).all():
        raise SceneError(f"the curve has no tangent at point {int(np.argmin(directions.any(axis=1)))}, where its derivative vanishes")
    if closed:
        side, lift = rotation_minimizing_frames(points[:-1], directions[:-1], closed=True)
        side, lift = np.concatenate([side, side[:1]]), np.concatenate([lift, lift[:1]])
    else:
        side, lift = rotation_minimizing_frames(points, directions)
    return Frames(directions, side, lift)


def rotation_minimizing_frames(points: Points, tangents: Points, closed: bool = False) -> tuple[Points, Points]:
    """Carry a frame along a line.

    Parameters
    ----------
    points, tangents : (k, 3) float64
        Tangents unit.
    closed : bool
        The frame comes back to itself: the angle that is left is spread over the length.

    Returns
    -------
    side, lift : (k, 3) float64
        Unit, side x lift = tangent.
    """
    side = np.empty_like(points)
    axis = np.eye(3)[int(np.argmin(np.abs(tangents[0])))]
    side[0] = np.cross(tangents[0], axis) / np.linalg.norm(np.cross(tangents[0], axis))
    carried = side[0]
    for k in range(1, len(points) + (1 if closed else 0)):
        here, there = k - 1, k % len(points)
        carried = _doubly_reflected(carried, tangents[here], tangents[there], points[there] - points[here])
        if k < len(points):
            side[k] = carried
    side -= (side * tangents).sum(axis=1, keepdims=True) * tangents
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    lift = np.cross(tangents, side)
    if closed:
        left = math.atan2(float(carried @ lift[0]), float(carried @ side[0]))
        steps = np.linalg.norm(np.diff(points, axis=0, append=points[:1]), axis=1)
        turn = -left * np.concatenate([[0.0], np.cumsum(steps)[:-1]]) / steps.sum()
        cos, sin = np.cos(turn)[:, None], np.sin(turn)[:, None]
        side, lift = cos * side + sin * lift, cos * lift - sin * side
    return side, lift


def _doubly_reflected(side: Points, tangent: Points, next_tangent: Points, step: Points) -> Points:
    """Reflect in the plane between two points, then in the one that brings the tangent to the next one's."""
    reflected = side - 2.0 * (step @ side) / (step @ step) * step
    off = next_tangent - (tangent - 2.0 * (step @ tangent) / (step @ step) * step)
    squared = float(off @ off)
    return reflected - 2.0 * (off @ reflected) / squared * off if squared > 1e-24 else reflected
