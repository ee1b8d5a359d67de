"""Exact geometries (FoCG 4.4): what a ray meets by a formula, at any distance round.

Each stands in its node's own space, about +y where it is round, and says how far it reaches along any direction, from which its box in
any place follows. Spheres, boxes and tori have an inside; cylinders, cones and quadrics have one if they are capped, and the plane has
y <= 0: these can be combined (`limner.scene.solid`). Disks and patches are sheets.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ._values import Triple, finite, positive, triple

__all__ = ["BilinearPatch", "Box", "Cone", "Cylinder", "Disk", "Plane", "Primitive", "Quadric", "Sphere", "Torus"]

Floats = NDArray[np.float64]
Range = tuple[Floats, Floats]

_SIDES = 32
_ANGLES = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
_RING = np.stack([np.cos(_ANGLES), np.zeros(_SIDES), np.sin(_ANGLES)], axis=-1) / math.cos(np.pi / _SIDES)
_CUBE = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


class _Bounded:
    """What follows from how far a geometry reaches."""

    def range_along(self, directions: ArrayLike) -> Range:
        """Tell the least and the greatest a . p over the geometry, (n,) float64 each, for (n, 3) directions a of any length."""
        a = np.asarray(directions, dtype=np.float64)
        reach = self._reach(a)
        return -reach, reach

    def _reach(self, a: Floats) -> Floats:
        raise NotImplementedError

    @property
    def bounds(self) -> Floats:
        """(2, 3) float64: least and greatest corner in the node's own space."""
        return np.array(self.range_along(np.eye(3)))

    @property
    def hull(self) -> Floats:
        """(n, 3) float64: points whose convex hull holds the geometry, tightly where that is cheap."""
        low, high = self.bounds
        return np.asarray((low + high) / 2.0 + (high - low) / 2.0 * _CUBE)


def _flag(value: Any, name: str) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise SceneError(f"{name} must be True or False, got {value!r}")
    return bool(value)


def _off_axis(a: Floats) -> Floats:
    return np.hypot(a[:, 0], a[:, 2])


@dataclass(frozen=True)
class Sphere(_Bounded):
    """|p| = radius, around the node's origin."""

    radius: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "sphere.radius"))

    def _reach(self, a: Floats) -> Floats:
        return np.asarray(self.radius * np.linalg.norm(a, axis=1))


@dataclass(frozen=True)
class Plane(_Bounded):
    """The infinite plane y = 0, its front towards +y; (u, v) = (x, -z), metres. As a solid, the half space y <= 0."""

    def range_along(self, directions: ArrayLike) -> Range:
        """See `Sphere.range_along`: of the half space below it, infinite but for what looks straight up or down."""
        a = np.asarray(directions, dtype=np.float64)
        upright = (a[:, 0] == 0.0) & (a[:, 2] == 0.0)
        low = np.where(upright & (a[:, 1] <= 0.0), 0.0, -np.inf)
        return low, np.where(upright & (a[:, 1] >= 0.0), 0.0, np.inf)

    @property
    def hull(self) -> Floats:
        """(0, 3) float64: a plane has no end."""
        return np.zeros((0, 3))


@dataclass(frozen=True)
class Box(_Bounded):
    """The axis-aligned box of the given edge lengths around the node's origin."""

    size: Triple = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        size = triple(self.size, "box.size")
        for edge in size:
            positive(edge, "box.size")
        object.__setattr__(self, "size", size)

    def _reach(self, a: Floats) -> Floats:
        return np.asarray(np.abs(a) @ (np.array(self.size) / 2.0))


@dataclass(frozen=True)
class Disk(_Bounded):
    """The points of y = 0 within `radius` of the origin, front towards +y; u = (1 + x/r) / 2, v = (1 - z/r) / 2."""

    radius: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "disk.radius"))

    def _reach(self, a: Floats) -> Floats:
        return np.asarray(self.radius * _off_axis(a))

    @property
    def hull(self) -> Floats:
        """(n, 3) float64: a polygon around it."""
        return np.asarray(self.radius * _RING)


@dataclass(frozen=True)
class Cylinder(_Bounded):
    """x^2 + z^2 = radius^2 for y from -height/2 to height/2.

    Parameters
    ----------
    radius, height : float > 0
    capped : bool
        Closed by disks; otherwise a tube, whose inside is seen where its material is double-sided. u runs around, v up the side; each cap
        shows the disk cut out of the texture.
    """

    radius: float = 1.0
    height: float = 2.0
    capped: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "cylinder.radius"))
        object.__setattr__(self, "height", positive(self.height, "cylinder.height"))
        object.__setattr__(self, "capped", _flag(self.capped, "cylinder.capped"))

    def _reach(self, a: Floats) -> Floats:
        return np.asarray(self.radius * _off_axis(a) + np.abs(a[:, 1]) * self.height / 2.0)

    @property
    def hull(self) -> Floats:
        """(n, 3) float64: polygons around both ends."""
        return np.concatenate([self.radius * _RING + np.array([0.0, y, 0.0]) for y in (-self.height / 2.0, self.height / 2.0)])


@dataclass(frozen=True)
class Cone(_Bounded):
    """A cone about +y from `radius` at y = -height/2 to `top_radius` at y = height/2.

    Parameters
    ----------
    radius : float >= 0
        At the bottom.
    height : float > 0
    top_radius : float >= 0
        0: a cone with its apex on top; more: one that is cut off. Not both radii may be 0.
    capped : bool
        As of a Cylinder; so are u and v.
    """

    radius: float = 1.0
    height: float = 2.0
    top_radius: float = 0.0
    capped: bool = True

    def __post_init__(self) -> None:
        for name in ("radius", "top_radius"):
            number = finite(getattr(self, name), f"cone.{name}")
            if number < 0.0:
                raise SceneError(f"cone.{name} must not be negative, got {number}")
            object.__setattr__(self, name, number)
        if self.radius == self.top_radius == 0.0:
            raise SceneError("cone.radius and cone.top_radius must not both be 0")
        object.__setattr__(self, "height", positive(self.height, "cone.height"))
        object.__setattr__(self, "capped", _flag(self.capped, "cone.capped"))

    def range_along(self, directions: ArrayLike) -> Range:
        """See `Sphere.range_along`."""
        a = np.asarray(directions, dtype=np.float64)
        up, off_axis = a[:, 1] * self.height / 2.0, _off_axis(a)
        low = np.minimum(-up - self.radius * off_axis, up - self.top_radius * off_axis)
        return low, np.maximum(-up + self.radius * off_axis, up + self.top_radius * off_axis)

    @property
    def hull(self) -> Floats:
        """(n, 3) float64: polygons around both ends."""
        half = self.height / 2.0
        return np.concatenate([self.radius * _RING + np.array([0.0, -half, 0.0]), self.top_radius * _RING + np.array([0.0, half, 0.0])])


@dataclass(frozen=True)
class Torus(_Bounded):
    """All points `minor_radius` away from the circle of `major_radius` around the origin in y = 0.

    Parameters
    ----------
    major_radius : float > 0
        Of the circle in the middle of the tube.
    minor_radius : float > 0
        Of the tube, at most `major_radius`: a torus has a hole. u runs around +y, v around the tube.
    """

    major_radius: float = 1.0
    minor_radius: float = 0.25

    def __post_init__(self) -> None:
        object.__setattr__(self, "major_radius", positive(self.major_radius, "torus.major_radius"))
        object.__setattr__(self, "minor_radius", positive(self.minor_radius, "torus.minor_radius"))
        if self.minor_radius > self.major_radius:
            raise SceneError(f"torus.minor_radius must not exceed the major radius of {self.major_radius}, got {self.minor_radius}")

    def _reach(self, a: Floats) -> Floats:
        return np.asarray(self.major_radius * _off_axis(a) + self.minor_radius * np.linalg.norm(a, axis=1))

    @property
    def hull(self) -> Floats:
        """(n, 3) float64: polygons around its top and its bottom."""
        ring = (self.major_radius + self.minor_radius) * _RING
        return np.concatenate([ring + np.array([0.0, y, 0.0]) for y in (-self.minor_radius, self.minor_radius)])


@dataclass(frozen=True)
class Quadric(_Bounded):
    """The surface of a polynomial of degree two, within a box: ellipsoids, paraboloids, saddles, hyperboloids, double cones, and more.

        c0 x^2 + c1 y^2 + c2 z^2 + c3 xy + c4 xz + c5 yz + c6 x + c7 y + c8 z + c9 = 0

    Parameters
    ----------
    coefficients : ten floats
        c0 … c9. Inside is where the polynomial is negative; all negated, the surface is turned inside out.
    low, high : three floats, or one for all
        Corners of the box that cuts it off.
    capped : bool
        Closed by the faces of the box where they are inside; otherwise an open sheet. u runs around +y, v is the share of the box's
        height.

    Examples
    --------
    >>> Quadric((1, -1, 1, 0, 0, 0, 0, 0, 0, -0.25), low=-1, high=1, capped=False).bounds.tolist()  # a cooling tower
    [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]
    """

    coefficients: tuple[float, ...]
    low: Triple = (-1.0, -1.0, -1.0)
    high: Triple = (1.0, 1.0, 1.0)
    capped: bool = True

    def __post_init__(self) -> None:
        given = self.coefficients
        if isinstance(given, str) or not np.iterable(given) or len(tuple(given)) != 10:
            raise SceneError(f"quadric.coefficients must be ten numbers, got {given!r}")
        coefficients = tuple(finite(c, "quadric.coefficients") for c in given)
        if not any(coefficients[:9]):
            raise SceneError("quadric.coefficients must not all be 0 but the last: that is no surface")
        low, high = triple(self.low, "quadric.low"), triple(self.high, "quadric.high")
        if not all(a < b for a, b in zip(low, high, strict=True)):
            raise SceneError(f"quadric.low must lie below quadric.high along every axis, got {low} and {high}")
        for name, value in (("coefficients", coefficients), ("low", low), ("high", high)):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "capped", _flag(self.capped, "quadric.capped"))

    def range_along(self, directions: ArrayLike) -> Range:
        """See `Sphere.range_along`: of its box."""
        a = np.asarray(directions, dtype=np.float64)
        low, high = np.array(self.low), np.array(self.high)
        middle, reach = a @ (low + (high - low) / 2.0), np.abs(a) @ ((high - low) / 2.0)
        return middle - reach, middle + reach


@dataclass(frozen=True)
class BilinearPatch(_Bounded):
    """The surface between four corners that is straight along both its sides, and in general not flat.

        p(u, v) = (1-u)(1-v) p00 + u (1-v) p10 + u v p11 + (1-u) v p01

    Parameters
    ----------
    corners : (4, 3) floats
        p00, p10, p11, p01: counter-clockwise seen from the front. Two may coincide; all on one line they may not lie.
    """

    corners: tuple[Triple, Triple, Triple, Triple] = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0))

    def __post_init__(self) -> None:
        given = self.corners
        if isinstance(given, str) or not np.iterable(given) or len(tuple(given)) != 4:
            raise SceneError(f"bilinear_patch.corners must be four points, got {given!r}")
        corners = tuple(triple(corner, "bilinear_patch.corners") for corner in given)
        spread = np.array(corners) - np.array(corners[0])
        largest = float(np.abs(spread).max())
        if largest == 0.0 or np.linalg.svd(spread / largest, compute_uv=False)[1] < 1e-9:
            raise SceneError(f"bilinear_patch.corners must not all lie on one line, got {corners}")
        object.__setattr__(self, "corners", corners)

    def range_along(self, directions: ArrayLike) -> Range:
        """See `Sphere.range_along`: of its corners."""
        along = np.asarray(directions, dtype=np.float64) @ np.array(self.corners).T
        return along.min(axis=1), along.max(axis=1)

    @property
    def hull(self) -> Floats:
        """(4, 3) float64: its corners."""
        return np.array(self.corners)


Primitive: TypeAlias = Sphere | Plane | Box | Disk | Cylinder | Cone | Torus | Quadric | BilinearPatch
