"""Fields of distances that are not made of others: solids around the origin, about +y where they are round, and two fractals.

The distance is exact, inside and out, but for the ellipsoid, the gyroid and the fractals: their fields are less, and zero at the same
places.

**Source**: Quilez, *Distance functions* (iquilezles.org), for box, capped cone, octahedron and Menger's sponge; Hart, Sandin and
Kauffman, *Ray tracing deterministic 3-D fractals*, 1989, for the quaternion Julia set.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ._values import Triple, finite, positive, triple
from .distance_field import Distance

__all__ = [
    "JULIA_DEPTH", "JULIA_ESCAPE", "JULIA_ROOM", "Box", "Capsule", "Cone", "Cylinder", "Ellipsoid", "Gyroid", "MengerSponge", "Octahedron",
    "Plane", "QuaternionJulia", "RoundedBox", "Segment", "Sphere", "Torus",
]  # fmt: skip

Floats = NDArray[np.float64]

JULIA_ESCAPE = 2.0**16
"""How far out a point of a Julia set's iteration is on its way to infinity."""

JULIA_ROOM = 2.0
"""Radius, in units of its ball, within which a Julia set's own formula holds."""

JULIA_DEPTH = 0.01
"""The most that its field says inside, where the formula means nothing, in units of its ball's radius."""


def _cube(reach: Floats | float) -> Floats:
    """(2, 3): the box around the origin of the given half edges."""
    half = np.broadcast_to(np.asarray(reach, dtype=np.float64), 3)
    return np.array([-half, half])


def _length(*parts: Floats) -> Floats:
    return np.asarray(np.sqrt(sum(part * part for part in parts)))


@dataclass(frozen=True)
class Sphere(Distance):
    """|p| - radius"""

    radius: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "sphere.radius"))

    def _at(self, p: Floats) -> Floats:
        return _length(*p.T) - self.radius

    def _within(self, level: float) -> Floats:
        return _cube(self.radius + level)


@dataclass(frozen=True)
class Box(Distance):
    """The axis-aligned box of the given edge lengths."""

    size: Triple = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", _sizes(self.size, "box.size"))

    def _at(self, p: Floats) -> Floats:
        return _box(p, np.array(self.size) / 2.0)

    def _within(self, level: float) -> Floats:
        return _cube(np.array(self.size) / 2.0 + level)


def _sizes(value: object, name: str) -> Triple:
    size = triple(value, name)
    for edge in size:
        positive(edge, name)
    return size


def _box(p: Floats, half: Floats) -> Floats:
    q = np.abs(p) - half
    return _length(*np.maximum(q, 0.0).T) + np.minimum(q.max(axis=1), 0.0)


@dataclass(frozen=True)
class RoundedBox(Distance):
    """A box of the given edge lengths, its edges rounded by a radius of at most half the shortest."""

    size: Triple = (1.0, 1.0, 1.0)
    radius: float = 0.1

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", _sizes(self.size, "rounded_box.size"))
        object.__setattr__(self, "radius", positive(self.radius, "rounded_box.radius"))
        if self.radius > min(self.size) / 2.0:
            raise SceneError(f"rounded_box.radius must be at most half the shortest edge, {min(self.size) / 2.0:g}, got {self.radius:g}")

    def _at(self, p: Floats) -> Floats:
        return _box(p, np.array(self.size) / 2.0 - self.radius) - self.radius

    def _within(self, level: float) -> Floats:
        return _cube(np.array(self.size) / 2.0 + level)


@dataclass(frozen=True)
class Torus(Distance):
    """All points within minor_radius of the circle of major_radius in y = 0."""

    major_radius: float = 0.75
    minor_radius: float = 0.25

    def __post_init__(self) -> None:
        object.__setattr__(self, "major_radius", positive(self.major_radius, "torus.major_radius"))
        object.__setattr__(self, "minor_radius", positive(self.minor_radius, "torus.minor_radius"))

    def _at(self, p: Floats) -> Floats:
        x, y, z = p.T
        return _length(_length(x, z) - self.major_radius, y) - self.minor_radius

    def _within(self, level: float) -> Floats:
        minor = self.minor_radius + level
        return _cube(np.array([self.major_radius + minor, minor, self.major_radius + minor]))


@dataclass(frozen=True)
class Segment(Distance):
    """All points within `radius` of the line from one point to another."""

    begin: Triple = (0.0, -0.5, 0.0)
    end: Triple = (0.0, 0.5, 0.0)
    radius: float = 0.1

    def __post_init__(self) -> None:
        object.__setattr__(self, "begin", triple(self.begin, "segment.begin"))
        object.__setattr__(self, "end", triple(self.end, "segment.end"))
        object.__setattr__(self, "radius", positive(self.radius, "segment.radius"))

    def _at(self, p: Floats) -> Floats:
        along = np.array(self.end) - np.array(self.begin)
        squared = float(along @ along)
        from_begin = p - np.array(self.begin)
        share = np.clip(from_begin @ along / squared, 0.0, 1.0) if squared > 0.0 else np.zeros(len(p))
        return _length(*(from_begin - share[:, None] * along).T) - self.radius

    def _within(self, level: float) -> Floats:
        ends = np.array([self.begin, self.end])
        return np.array([ends.min(axis=0) - self.radius - level, ends.max(axis=0) + self.radius + level])


class Capsule(Segment):
    """A cylinder about +y with half balls at its ends, `height` from tip to tip."""

    def __init__(self, radius: float = 0.25, height: float = 1.0) -> None:
        radius, height = positive(radius, "capsule.radius"), positive(height, "capsule.height")
        if height < 2.0 * radius:
            raise SceneError(f"capsule.height must be at least twice the radius, {2.0 * radius:g}, got {height:g}")
        half = height / 2.0 - radius
        super().__init__((0.0, -half, 0.0), (0.0, half, 0.0), radius)


@dataclass(frozen=True)
class Cylinder(Distance):
    """A capped cylinder about +y, around the origin."""

    radius: float = 0.5
    height: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "cylinder.radius"))
        object.__setattr__(self, "height", positive(self.height, "cylinder.height"))

    def _at(self, p: Floats) -> Floats:
        x, y, z = p.T
        outwards, up = _length(x, z) - self.radius, np.abs(y) - self.height / 2.0
        beside = _length(np.maximum(outwards, 0.0), np.maximum(up, 0.0))
        return beside + np.minimum(np.maximum(outwards, up), 0.0)

    def _within(self, level: float) -> Floats:
        return _cube(np.array([self.radius, self.height / 2.0, self.radius]) + level)


@dataclass(frozen=True)
class Cone(Distance):
    """A capped cone about +y from `radius` at -height/2 to `top_radius` at height/2."""

    radius: float = 0.5
    height: float = 1.0
    top_radius: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "cone.radius"))
        object.__setattr__(self, "height", positive(self.height, "cone.height"))
        object.__setattr__(self, "top_radius", finite(self.top_radius, "cone.top_radius"))
        if self.top_radius < 0.0:
            raise SceneError(f"cone.top_radius must not be negative, got {self.top_radius}")

    def _at(self, p: Floats) -> Floats:
        x, y, z = p.T
        from_axis, half = _length(x, z), self.height / 2.0
        # The nearest point of the caps, and the nearest one of the side
        over = from_axis - np.minimum(from_axis, np.where(y < 0.0, self.radius, self.top_radius))
        up = np.abs(y) - half
        narrower, squared = self.top_radius - self.radius, (self.top_radius - self.radius) ** 2 + self.height**2
        share = np.clip(((self.top_radius - from_axis) * narrower + (half - y) * self.height) / squared, 0.0, 1.0)
        side_x, side_y = from_axis - self.top_radius + narrower * share, y - half + self.height * share
        distance = np.minimum(_length(over, up), _length(side_x, side_y))
        return np.where((side_x < 0.0) & (up < 0.0), -distance, distance)

    def _within(self, level: float) -> Floats:
        widest = max(self.radius, self.top_radius)
        return _cube(np.array([widest, self.height / 2.0, widest]) + level)


@dataclass(frozen=True)
class Plane(Distance):
    """The half space y <= 0. It has no end."""

    def _at(self, p: Floats) -> Floats:
        return p[:, 1].copy()

    def _within(self, level: float) -> Floats:
        return np.array([[-np.inf, -np.inf, -np.inf], [np.inf, level, np.inf]])


@dataclass(frozen=True)
class Ellipsoid(Distance):
    """``(|p / r| - 1) min r``: a bound, exact along the shortest axis; the slope of |p / r| is nowhere more than 1 / min r."""

    radii: Triple = (1.0, 0.5, 0.75)

    def __post_init__(self) -> None:
        object.__setattr__(self, "radii", _sizes(self.radii, "ellipsoid.radii"))

    def _at(self, p: Floats) -> Floats:
        return (_length(*(p / np.array(self.radii)).T) - 1.0) * min(self.radii)

    def _within(self, level: float) -> Floats:
        return _cube(np.array(self.radii) * (1.0 + level / min(self.radii)))


@dataclass(frozen=True)
class Octahedron(Distance):
    """|x| + |y| + |z| <= radius"""

    radius: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "octahedron.radius"))

    def _at(self, p: Floats) -> Floats:
        # The nearest point of the face, or of the edge that two coordinates have in common, where the third one is the least
        a, b, c = np.sort(np.abs(p), axis=1).T
        over = a + b + c - self.radius
        k = np.clip(0.5 * (c - b + self.radius), 0.0, self.radius)
        return np.where(3.0 * a < over, _length(a, b - self.radius + k, c - k), over / math.sqrt(3.0))

    def _within(self, level: float) -> Floats:
        return _cube(self.radius + level)


@dataclass(frozen=True)
class Gyroid(Distance):
    """Schoen's minimal surface ``sin x cos y + sin y cos z + sin z cos x = 0`` of a period, as walls of a thickness. It has no end.

    Its slope is at most sqrt(3): that by x is ``cos x cos y - sin z sin x <= sqrt(cos^2 y + sin^2 z)``, and the squares of all three
    have the sum 3. Divided by that, walls are at least as thick as asked for. A thickness of 0 stands for one half of space.

    **Source**: Schoen, *Infinite periodic minimal surfaces without self-intersections*, 1970.
    """

    period: float = 1.0
    thickness: float = 0.1

    def __post_init__(self) -> None:
        object.__setattr__(self, "period", positive(self.period, "gyroid.period"))
        object.__setattr__(self, "thickness", finite(self.thickness, "gyroid.thickness"))
        if self.thickness < 0.0:
            raise SceneError(f"gyroid.thickness must not be negative, got {self.thickness}")

    def _at(self, p: Floats) -> Floats:
        turns = 2.0 * math.pi / self.period
        (sx, sy, sz), (cx, cy, cz) = np.sin(turns * p.T), np.cos(turns * p.T)
        value = (sx * cy + sy * cz + sz * cx) / (math.sqrt(3.0) * turns)
        return np.abs(value) - self.thickness / 2.0 if self.thickness > 0.0 else value

    def _within(self, level: float) -> Floats:
        return _cube(np.inf)


@dataclass(frozen=True)
class MengerSponge(Distance):
    """A cube of an edge length, from which ever smaller crosses of square tunnels are taken: Menger's universal curve, after some steps.

    **Source**: Menger, *Allgemeine Räume und Cartesische Räume*, 1926; Quilez, *Menger fractal*.
    """

    size: float = 2.0
    iterations: int = 4

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", positive(self.size, "menger_sponge.size"))
        object.__setattr__(self, "iterations", _iterations(self.iterations, 0, 10, "menger_sponge"))

    def _at(self, p: Floats) -> Floats:
        half = self.size / 2.0
        q = p / half
        found, scale = _box(q, np.ones(3)), 1.0
        for _ in range(self.iterations):
            # How far from the middle of its tunnel a point is along each axis, in units of half its width
            along = np.abs(1.0 - 3.0 * np.abs(np.mod(q * scale, 2.0) - 1.0))
            scale *= 3.0
            found = np.maximum(found, (np.median(along, axis=1) - 1.0) / scale)
        return found * half

    def _within(self, level: float) -> Floats:
        return _cube(self.size / 2.0 + level)


def _iterations(value: object, least: int, most: int, name: str) -> int:
    if not isinstance(value, (int, np.integer)) or isinstance(value, bool) or not least <= value <= most:
        raise SceneError(f"{name}.iterations must be a whole number from {least} to {most}, got {value!r}")
    return int(value)


@dataclass(frozen=True)
class QuaternionJulia(Distance):
    """The points (x, y, z, 0) that z -> z^2 + c, for quaternions, keeps: a slice of a filled Julia set.

    Which points escape to infinity, and how fast, tells how far away those are that never do: with the potential
    ``G = log|z_n| / 2^n`` the distance is at least about ``G / 2 |G'|`` (Hart, Sandin and Kauffman 1989, from Douady and Hubbard).
    After some iterations, the rest counts as kept: the surface is where G has the value that is left then. That this estimate is
    nowhere more than the distance, and its slope outside little more than 1, is found by trying, not proven. Inside, the field says that
    it is inside, and no distance.

    Parameters
    ----------
    constant : four floats
        c, real part first.
    iterations : int
        From 4 to 24: detail.
    """

    constant: tuple[float, float, float, float] = (-0.2, 0.6, 0.2, 0.2)
    iterations: int = 10

    def __post_init__(self) -> None:
        try:
            constant = tuple(finite(part, "quaternion_julia.constant") for part in self.constant)
        except TypeError:
            constant = ()
        if len(constant) != 4 or math.hypot(*constant) > 4.0:
            raise SceneError(f"quaternion_julia.constant must be four numbers, no longer than 4 together, got {self.constant!r}")
        object.__setattr__(self, "constant", constant)
        object.__setattr__(self, "iterations", _iterations(self.iterations, 4, 24, "quaternion_julia"))

    @property
    def lipschitz(self) -> float:
        """Of the outside: 1.14 is the most that was found."""
        return 1.25

    @property
    def radius(self) -> float:
        """Of a ball out of which all points escape: where |z|^2 - |c| = |z|."""
        return (1.0 + math.sqrt(1.0 + 4.0 * math.hypot(*self.constant))) / 2.0

    def _at(self, p: Floats) -> Floats:
        from_middle = _length(*p.T)
        room = JULIA_ROOM * self.radius
        near = p * np.where(from_middle > room, room / np.where(from_middle > 0.0, from_middle, 1.0), 1.0)[:, None]
        a, b, c = near.T.copy()
        d, slope, level = np.zeros_like(a), np.ones_like(a), np.full(len(a), 0.5**self.iterations)
        squared = a * a + b * b + c * c
        for n in range(self.iterations):
            goes_on = squared <= JULIA_ESCAPE * JULIA_ESCAPE
            slope = np.where(goes_on, slope * (4.0 * squared), slope)
            after = (a * a - b * b - c * c - d * d, 2.0 * a * b, 2.0 * a * c, 2.0 * a * d)
            a, b, c, d = (np.where(goes_on, v + k, w) for v, k, w in zip(after, self.constant, (a, b, c, d), strict=True))
            squared = a * a + b * b + c * c + d * d
            level = np.where(goes_on, 0.5 ** (self.iterations - n - 1), level)
        squared = np.maximum(squared, 1e-60)
        value = 0.5 * np.sqrt(squared / np.maximum(slope, 1e-60)) * (0.5 * np.log(squared) - level * math.log(JULIA_ESCAPE))
        return np.maximum(np.maximum(value, -JULIA_DEPTH * self.radius), from_middle - self.radius)

    def _within(self, level: float) -> Floats:
        return _cube(self.radius + level)
