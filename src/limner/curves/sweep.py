"""Sweeping: a line in a plane, carried along a curve in space (FoCG 15: the surfaces that curves make).

The plane stands across the curve and turns about it no more than it must (`limner.curves.frames.turned_along`), but for the twist that is
asked for. A ribbon is what a short straight line sweeps; a tube of constant width is rather `limner.mesh.shapes.tube`, which has caps and
mitres.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .control import control_points
from .curve import Curve
from .flatten import parameters_of
from .frames import Frames, turned_along
from .patch import Tessellation
from .tessellate import grid_triangles

__all__ = ["along", "ribbon", "swept"]

Floats = NDArray[np.float64]


def along(curve: Curve, tolerance: float) -> Floats:
    """Points of a curve in space whose chords stray from it by no more than a tolerance, (k, 3) float64: a line for a tube."""
    points = curve.at(parameters_of(curve, tolerance))
    if points.shape[1] != 3:
        raise SceneError(f"a curve in space has 3 coordinates, got {points.shape[1]}")
    return points


def swept(
    curve: Curve, profile: ArrayLike, n: int = 64, twist: float = 0.0, scale: tuple[float, float] = (1.0, 1.0), closed: bool = False
) -> Tessellation:
    """Carry a profile along a curve.

    Parameters
    ----------
    curve : Curve
        In space, without points where its derivative vanishes.
    profile : (m, 2) float, m >= 2
        In the plane across the curve, whose first axis is the frame's normal and whose second its binormal; closed where the last point is
        the first. The front is to its right, which is outside where it runs counter-clockwise.
    n : int >= 1
        Steps along the curve.
    twist : float
        Radians by which the profile has turned at the end.
    scale : (float, float) > 0
        Of the profile at the start and at the end.
    closed : bool
        The frame at the end is that at the start, for curves that close.

    Returns
    -------
    Tessellation
        u runs along the profile by its length, v along the curve's parameter; normals are those of the swept surface.

    Examples
    --------
    >>> from limner.curves.curve import Spline
    >>> wall = swept(Spline.bezier([[0, 0, 0], [0, 0, 2]]), [(-1, 0), (1, 0)], 4)
    >>> wall.positions.shape, wall.triangles.shape
    ((10, 3), (8, 3))
    """
    shape = control_points(profile, 2, "profile", 2)
    if n < 1:
        raise SceneError(f"a sweep needs at least 1 step along its curve, got {n}")
    if not (math.isfinite(twist) and min(scale) > 0.0 and math.isfinite(max(scale))):
        raise SceneError(f"a sweep's twist must be finite and its scales positive, got {twist} and {scale}")
    v = np.arange(n + 1) / n
    u = curve.knots[0] + (curve.knots[-1] - curve.knots[0]) * v
    frames, centers = turned_along(curve, u, closed), curve.at(u)
    angle, size = twist * v, scale[0] + (scale[1] - scale[0]) * v
    x = size[:, None] * (np.cos(angle)[:, None] * shape[:, 0] - np.sin(angle)[:, None] * shape[:, 1])
    y = size[:, None] * (np.sin(angle)[:, None] * shape[:, 0] + np.cos(angle)[:, None] * shape[:, 1])
    positions = centers[:, None] + x[..., None] * frames.normal[:, None] + y[..., None] * frames.binormal[:, None]
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(shape, axis=0), axis=1))])
    if not arc[-1] > 0.0:
        raise SceneError("a profile must be a line with a length")
    uvs = np.stack(np.broadcast_arrays(arc / arc[-1], v[:, None]), axis=-1)
    triangles = grid_triangles(np.arange(positions[..., 0].size).reshape(positions.shape[:2])).astype(np.int32)
    normals = _normals(positions, shape, frames, closed)
    return Tessellation(positions.reshape(-1, 3), normals.reshape(-1, 3), uvs.reshape(-1, 2), triangles)


def _normals(positions: Floats, shape: Floats, frames: Frames, closed: bool) -> Floats:
    """Across both directions of the grid, by differences that go round where the surface does."""
    ring = len(shape) > 2 and bool((shape[0] == shape[-1]).all())
    across, onward = _slope(positions, 1, ring), _slope(positions, 0, closed)
    normal = np.cross(across, onward)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    # Where the grid has shrunk or folded, at least the plane across the curve
    spare = np.broadcast_to(frames.normal[:, None], normal.shape)
    return np.asarray(np.where(length > 1e-300, normal / np.where(length > 0.0, length, 1.0), spare))


def _slope(positions: Floats, axis: int, ring: bool) -> Floats:
    if positions.shape[axis] < 3 or not ring:
        return np.asarray(np.gradient(positions, axis=axis, edge_order=2 if positions.shape[axis] > 2 else 1))
    p = np.moveaxis(positions, axis, 0)
    made = np.empty_like(p)
    made[1:-1] = 0.5 * (p[2:] - p[:-2])
    made[0] = made[-1] = 0.5 * (p[1] - p[-2])
    return np.moveaxis(made, 0, axis)


def ribbon(curve: Curve, width: float, n: int = 64, twist: float = 0.0, closed: bool = False) -> Tessellation:
    """Carry a straight line of a width along a curve; see `swept`."""
    if not (math.isfinite(width) and width > 0.0):
        raise SceneError(f"the width of a ribbon must be positive and finite, got {width}")
    return swept(curve, [(-0.5 * width, 0.0), (0.5 * width, 0.0)], n, twist, closed=closed)
