"""Fields of distances: what they are, and how fields are made of fields (FoCG 22, implicit modelling).

A field tells of every point how far the nearest surface is at least, negative inside. Nothing else is asked of it, so fields can be
bent, repeated and melted together where a formula for the intersection with a ray would be hopeless:

    drop = Union(Sphere(0.6), Sphere(0.35).translated(0, 0.8, 0), radius=0.4)
    shape = Shape(DistanceField(drop - Box((2, 2, 0.2))), glass)

Two things are known of every node. Its `lipschitz` bound L: |f(p) - f(q)| <= L |p - q|, so that nothing of the surface is nearer than
|f(p)| / L, which is how far a ray may go (Hart, *Sphere tracing*, 1996). And a box that holds its inside, from which the box of what
is made of it follows; what has no end must be cut off by something that has one.

    operator                      f                         L
    a | b, a & b, a - b           min, max, max(a, -b)      the greater
    with a radius                 the smooth minimum        the greater: its slope is a mean of both slopes
    offset, shell                 a - r, |a| - t/2          the same
    placed                        s a(M^-1 p)               the same: only turned, moved and scaled evenly
    elongated, mirrored           a(folded p)               the same: folding brings no two points apart
    twisted                       a(turned p)               more, the farther from the axis

**Source**: Hart, *Sphere tracing: a geometric method for the antialiased ray tracing of implicit surfaces*, 1996; Quilez, *Distance
functions* and *Smooth minimum* (iquilezles.org), whose operators these are.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ..linear import transform
from ._values import Triple, finite, matrix4, positive, triple
from .primitive import Range, _Bounded

__all__ = [
    "MAX_NESTING", "Difference", "Distance", "DistanceField", "Elongated", "Intersection", "Mirrored", "Offset", "Placed", "Repeated",
    "Shell", "Twisted", "Union", "smooth_minimum",
]  # fmt: skip

Floats = NDArray[np.float64]

MAX_NESTING = 48
"""How deep fields may stand in each other."""

_SLACK = 1e-9  # of an extent: sums of float64 that should be equal


class Distance:
    """A field of distances: the base of all of them, and their operators."""

    _nesting: int = 1

    @property
    def lipschitz(self) -> float:
        """L with |f(p) - f(q)| <= L |p - q|."""
        return 1.0

    def distance(self, points: ArrayLike) -> Floats:
        """Evaluate the field.

        Parameters
        ----------
        points : (..., 3) float

        Returns
        -------
        (...) float64
            Negative inside.
        """
        p = np.asarray(points, dtype=np.float64)
        if p.shape[-1:] != (3,):
            raise SceneError(f"points must have three coordinates each, got an array of shape {p.shape}")
        return self._at(p.reshape(-1, 3)).reshape(p.shape[:-1])

    def gradient(self, points: ArrayLike, step: float) -> Floats:
        """Differences of the field over `step` to both sides of points (n, 3) along each axis: (n, 3), which points outwards."""
        p = np.asarray(points, dtype=np.float64)
        along = [self._at(p + step * axis) - self._at(p - step * axis) for axis in np.eye(3)]
        return np.stack(along, axis=-1) / (2.0 * step)

    @property
    def bounds(self) -> Floats:
        """(2, 3) float64: least and greatest corner of a box that holds the inside; infinite where that has no end."""
        return self._within(0.0)

    def _at(self, p: Floats) -> Floats:
        """(n,): the field at (n, 3) points."""
        raise NotImplementedError

    def _within(self, level: float) -> Floats:
        """(2, 3): a box that holds all points where the field is at most `level`, which is not negative."""
        raise NotImplementedError

    def __or__(self, other: Distance) -> Distance:
        """What is in either."""
        return Union(*_same_kind(Union, self), *_same_kind(Union, other))

    def __and__(self, other: Distance) -> Distance:
        """What is in both."""
        return Intersection(*_same_kind(Intersection, self), *_same_kind(Intersection, other))

    def __sub__(self, other: Distance) -> Distance:
        """What is in this and not in the other."""
        return Difference(*_same_kind(Difference, self), other)

    def placed(self, parent_from_part: ArrayLike) -> Distance:
        """Move, turn, reflect and scale by a (4, 4) matrix, evenly; what was placed before is moved with it."""
        if isinstance(self, Placed):
            return Placed(self.part, np.asarray(parent_from_part) @ self.parent_from_part)
        return Placed(self, np.asarray(parent_from_part))

    def translated(self, x: float, y: float, z: float) -> Distance:
        """Move."""
        return self.placed(transform.translate(x, y, z))

    def rotated(self, axis: ArrayLike, degrees: float) -> Distance:
        """Turn about an axis through the origin, counter-clockwise seen from its tip."""
        return self.placed(transform.rotate(axis, math.radians(degrees)))

    def scaled(self, factor: float) -> Distance:
        """Scale evenly, about the origin."""
        factor = positive(factor, "scaled.factor")
        return self.placed(transform.scale(factor, factor, factor))

    def offset(self, amount: float) -> Distance:
        """Grow by an amount, its edges rounded; shrink by a negative one."""
        return Offset(self, amount)

    def shell(self, thickness: float) -> Distance:
        """Keep what is near the surface: walls of a thickness."""
        return Shell(self, thickness)

    def elongated(self, x: float, y: float, z: float) -> Distance:
        """Pull the halves apart by x to both sides, and by y and z."""
        return Elongated(self, (x, y, z))

    def mirrored(self, axes: str) -> Distance:
        """Show what lies on the positive side of some axes, "x" to "xyz", on the negative side as well, and nothing else there."""
        return Mirrored(self, axes)

    def repeated(self, spacing: Any, counts: Any = None, *, alternating: bool = False) -> Distance:
        """Repeat along the axes; see `Repeated`."""
        return Repeated(self, spacing, counts, alternating)

    def twisted(self, degrees_per_unit: float) -> Distance:
        """Turn about +y, the more the higher."""
        return Twisted(self, degrees_per_unit)


def _same_kind(kind: type, node: Distance) -> tuple[Distance, ...]:
    """What an operator of a kind can take in place of a node: `a | b | c` is one union of three. What is smooth stays by itself."""
    return node.parts if type(node) is kind and isinstance(node, _Joined) and node.radius == 0.0 else (node,)


def _part(value: Any, name: str) -> Distance:
    if not isinstance(value, Distance):
        raise SceneError(f"{name} must be a distance field such as distance.Sphere(1.0), got {type(value).__name__}")
    return value


def _nested(node: Distance, *parts: Distance) -> None:
    """Tell a node how deep it is, and complain where that is too deep."""
    nesting = 1 + max(part._nesting for part in parts)
    if nesting > MAX_NESTING:
        raise SceneError(f"a distance field is nested {nesting} deep, more than {MAX_NESTING}")
    object.__setattr__(node, "_nesting", nesting)


def smooth_minimum(a: Floats, b: Floats, radius: float) -> Floats:
    """The lesser of both; where they differ by less than `radius`, less than that by up to radius / 4, and smooth.

    ``min(a, b) - h^2 k / 4``, ``h = max(k - |a - b|, 0) / k``. Its slopes by a and b are (1 + h)/2 and (1 - h)/2 in some order: a mean,
    so that a bound of both slopes is one of its own.

    **Source**: Quilez, *Smooth minimum*, the quadratic polynomial; k is his radius of influence.
    """
    if radius <= 0.0:
        return np.minimum(a, b)
    h = np.maximum(radius - np.abs(a - b), 0.0) / radius
    return np.asarray(np.minimum(a, b) - h * h * (radius / 4.0))


# --- of several -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, init=False)
class _Joined(Distance):
    """Fields, and what is made of them, from the first to the last.

    Parameters
    ----------
    parts : Distance
        Two or more.
    radius : float
        Where distances differ by less, metres, what is made of them is smooth; 0: it has edges.
    """

    parts: tuple[Distance, ...]
    radius: float

    def __init__(self, *parts: Any, radius: float = 0.0) -> None:
        name = type(self).__name__
        if len(parts) < 2:
            raise SceneError(f"{name} must have at least 2 parts, got {len(parts)}")
        object.__setattr__(self, "parts", tuple(_part(part, f"{name}'s parts") for part in parts))
        radius = finite(radius, f"{name}'s radius")
        if radius < 0.0:
            raise SceneError(f"{name}'s radius must not be negative, got {radius}")
        object.__setattr__(self, "radius", radius)
        _nested(self, *self.parts)

    @property
    def lipschitz(self) -> float:
        """The greatest of its parts'."""
        return max(part.lipschitz for part in self.parts)

    def _at(self, p: Floats) -> Floats:
        found = self.parts[0]._at(p)
        for part in self.parts[1:]:
            found = self._joined(found, part._at(p))
        return found

    def _joined(self, a: Floats, b: Floats) -> Floats:
        raise NotImplementedError


class Union(_Joined):
    """What is in any of its parts; with a radius, they melt together."""

    def _joined(self, a: Floats, b: Floats) -> Floats:
        return smooth_minimum(a, b, self.radius)

    def _within(self, level: float) -> Floats:
        # Each step takes off a quarter of the radius at most.
        boxes = np.array([part._within(level + (len(self.parts) - 1) * self.radius / 4.0) for part in self.parts])
        kept = boxes[(boxes[:, 0] <= boxes[:, 1]).all(axis=1)]
        kept = kept if len(kept) else boxes
        return np.array([kept[:, 0].min(axis=0), kept[:, 1].max(axis=0)])


class Intersection(_Joined):
    """What is in all of its parts; with a radius, its edges are rounded off."""

    def _joined(self, a: Floats, b: Floats) -> Floats:
        return -smooth_minimum(-a, -b, self.radius)

    def _within(self, level: float) -> Floats:
        boxes = np.array([part._within(level) for part in self.parts])
        return np.array([boxes[:, 0].max(axis=0), boxes[:, 1].min(axis=0)])


class Difference(_Joined):
    """What is in its first part and in none of the others; with a radius, its edges are rounded off."""

    def _joined(self, a: Floats, b: Floats) -> Floats:
        return -smooth_minimum(-a, b, self.radius)

    def _within(self, level: float) -> Floats:
        return self.parts[0]._within(level)


# --- of one ---------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Changed(Distance):
    """A field made of one other."""

    part: Distance

    def __post_init__(self) -> None:
        _part(self.part, f"{type(self).__name__}'s part")
        _nested(self, self.part)

    @property
    def lipschitz(self) -> float:
        """That of its part."""
        return self.part.lipschitz


@dataclass(frozen=True)
class Offset(_Changed):
    """What is within `amount` of its part, metres; for a negative amount, what is as deep inside."""

    amount: float

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "amount", finite(self.amount, "offset.amount"))

    def _at(self, p: Floats) -> Floats:
        return self.part._at(p) - self.amount

    def _within(self, level: float) -> Floats:
        return self.part._within(max(level + self.amount, 0.0))


@dataclass(frozen=True)
class Shell(_Changed):
    """What is within half a thickness of its part's surface."""

    thickness: float

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "thickness", positive(self.thickness, "shell.thickness"))

    def _at(self, p: Floats) -> Floats:
        return np.abs(self.part._at(p)) - self.thickness / 2.0

    def _within(self, level: float) -> Floats:
        return self.part._within(level + self.thickness / 2.0)


@dataclass(frozen=True, eq=False)
class Placed(_Changed):
    """Its part in another place.

    Parameters
    ----------
    part : Distance
    parent_from_part : (4, 4) float64
        Moves, turns, reflects and scales, alike along all axes: only so distances stay distances.
    """

    parent_from_part: Floats = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        super().__post_init__()
        matrix = matrix4(self.parent_from_part, "placed.parent_from_part")
        squared = matrix[:3, :3].T @ matrix[:3, :3]
        if not (squared[0, 0] > 0.0 and np.allclose(squared, squared[0, 0] * np.eye(3), rtol=0.0, atol=1e-9 * squared[0, 0])):
            raise SceneError("placed.parent_from_part must scale alike along all axes, and not shear: distances would be none")
        object.__setattr__(self, "parent_from_part", matrix)

    @property
    def factor(self) -> float:
        """By which it scales."""
        return float(np.linalg.norm(self.parent_from_part[:3, 0]))

    @property
    def part_from_parent(self) -> Floats:
        """(4, 4) float64: the inverse."""
        return np.asarray(np.linalg.inv(self.parent_from_part), dtype=np.float64)

    def _at(self, p: Floats) -> Floats:
        inverse = self.part_from_parent
        return self.factor * self.part._at(p @ inverse[:3, :3].T + inverse[:3, 3])

    def _within(self, level: float) -> Floats:
        low, high = self.part._within(level / self.factor)
        turned = self.parent_from_part[:3, :3]
        with np.errstate(invalid="ignore"):
            ends = np.where(turned != 0.0, np.stack([turned * low, turned * high]), 0.0)
            moved = self.parent_from_part[:3, 3]
            box = np.array([ends.min(axis=0).sum(axis=1) + moved, ends.max(axis=0).sum(axis=1) + moved])
        return np.where(np.isnan(box), [[-np.inf], [np.inf]], box)


@dataclass(frozen=True)
class Elongated(_Changed):
    """Its part cut in halves, which are pulled apart by `amounts` to both sides of each axis; between them, what is in the middle."""

    amounts: Triple

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "amounts", triple(self.amounts, "elongated.amounts", minimum=0.0))

    def _at(self, p: Floats) -> Floats:
        amounts = np.array(self.amounts)
        return self.part._at(p - np.clip(p, -amounts, amounts))

    def _within(self, level: float) -> Floats:
        low, high = self.part._within(level)
        return np.array([low - self.amounts, high + self.amounts])


@dataclass(frozen=True)
class Mirrored(_Changed):
    """What lies on the positive side of the axes, and its mirror image on the other side."""

    axes: str

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.axes, str) or not self.axes or set(self.axes) - set("xyz"):
            raise SceneError(f'mirrored.axes must be some of "x", "y", "z", got {self.axes!r}')

    @property
    def flags(self) -> tuple[bool, bool, bool]:
        """For each axis, whether it is mirrored."""
        return "x" in self.axes, "y" in self.axes, "z" in self.axes

    def _at(self, p: Floats) -> Floats:
        return self.part._at(np.where(self.flags, np.abs(p), p))

    def _within(self, level: float) -> Floats:
        low, high = self.part._within(level)
        reach = np.maximum(high, 0.0)
        return np.where(self.flags, [-reach, reach], [low, high])


@dataclass(frozen=True)
class Repeated(_Changed):
    """Copies of its part in rows.

    Parameters
    ----------
    part : Distance
        No longer than the spacing, but where the copies alternate; there, what is longer is cut off.
    spacing : float or three
        From copy to copy along each axis; 0: not repeated along that.
    counts : int or three, optional
        How many, evenly to both sides of where the part was; None: without end.
    alternating : bool
        Every other copy is mirrored, so that neighbours always meet.

    Copies that are not mirrored: of each axis the two next to the point are asked, which is enough (of what is farther, all is at least
    as far as the same point of one of these), and the second one only where it could be nearer than the first. Of a part whose field is
    less than its distance, the lesser of both may leap where the second one changes; it still is nowhere more than the distance.
    """

    spacing: Triple
    counts: tuple[int, int, int] | None = None
    alternating: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        spacing = triple(self.spacing, "repeated.spacing", minimum=0.0)
        if not any(spacing):
            raise SceneError("repeated.spacing must be positive along some axis, got 0 for all")
        object.__setattr__(self, "spacing", spacing)
        if self.counts is not None:
            counts = triple(self.counts, "repeated.counts", minimum=1.0)
            if any(count != int(count) or count > 1e6 for count in counts):
                raise SceneError(f"repeated.counts must be whole numbers up to a million, got {self.counts!r}")
            object.__setattr__(self, "counts", tuple(int(count) for count in counts))
        if not self.alternating:
            longest = np.ptp(self.part.bounds, axis=0)
            for axis, space, length in zip("xyz", spacing, longest, strict=True):
                if space and not length <= space * (1.0 + _SLACK):
                    raise SceneError(f"repeated.spacing along {axis} must be at least the part's length {length:g}, got {space:g}")

    @property
    def lipschitz(self) -> float:
        """That of its part, and at least 1, as the distance from the next copy's box has."""
        return max(self.part.lipschitz, 1.0)

    @property
    def middle_and_half(self) -> tuple[Floats, Floats]:
        """(3,) each: of the part's box along the axes that are repeated, 0 along the others; mirrored copies are about the origin."""
        low, high = self.part.bounds
        apart = (np.array(self.spacing) > 0.0) & (not self.alternating)
        with np.errstate(invalid="ignore"):
            return np.where(apart, (low + high) / 2.0, 0.0), np.where(apart, (high - low) / 2.0, 0.0)

    @property
    def first_and_last(self) -> tuple[Floats, Floats, Floats]:
        """(3,) each: the number of the first copy along each axis, that of the last, and where copy 0 stands."""
        spacing = np.array(self.spacing)
        if self.counts is None:
            endless = np.where(spacing > 0.0, np.inf, 0.0)
            return -endless, endless, np.zeros(3)
        last = np.where(spacing > 0.0, np.array(self.counts) - 1.0, 0.0)
        return np.zeros(3), last, -spacing * last / 2.0

    def _at(self, p: Floats) -> Floats:
        spacing = np.array(self.spacing)
        middle, half = self.middle_and_half
        first, last, start = self.first_and_last
        step = np.where(spacing > 0.0, spacing, 1.0)
        from_start = p - (middle + start)
        cell = np.clip(np.floor(from_start / step + 0.5), first, last)
        local = from_start - cell * spacing
        if self.alternating:
            return self.part._at(np.where(np.mod(cell, 2.0) == 1.0, -local, local))
        towards = np.where(local < 0.0, -1.0, 1.0)
        moved = np.clip(cell + towards, first, last) - cell
        gaps = np.where(moved != 0.0, spacing - np.abs(local) - half, -np.inf)
        found = self.part._at(local + middle)
        for other in list(itertools.product((False, True), repeat=3))[1:]:
            if not (spacing[list(other)] > 0.0).all():
                continue
            there = np.where(other, moved, 0.0)
            is_other = (there != 0.0).any(axis=1)
            gap = np.where(other, gaps, -np.inf).max(axis=1)
            value = np.maximum(self.part._at(local - there * spacing + middle), gap)
            found = np.where(is_other, np.minimum(found, value), found)
        return found

    def _within(self, level: float) -> Floats:
        low, high = self.part._within(level)
        if self.alternating:
            reach = np.maximum(np.abs(low), np.abs(high))
            low, high = np.where(np.array(self.spacing) > 0.0, [-reach, reach], [low, high])
        first, last, start = self.first_and_last
        with np.errstate(invalid="ignore"):
            begin, end = (np.where(np.array(self.spacing) > 0.0, start + k * np.array(self.spacing), 0.0) for k in (first, last))
        return np.array([low + begin, high + end])


@dataclass(frozen=True)
class Twisted(_Changed):
    """Its part, turned about +y by an angle that grows with the height; its box must end to the sides.

    A cylinder about the axis that is as wide as its part's box holds the result, and is intersected with it; of a point outside, the next
    one of the cylinder is turned. So the slope has a bound: that of a shear by the angle that one step turns there (its greater singular
    value).
    """

    degrees_per_unit: float

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "degrees_per_unit", finite(self.degrees_per_unit, "twisted.degrees_per_unit"))
        if not np.isfinite(self.part.bounds[:, [0, 2]]).all():
            raise SceneError("twisted.part must end to all sides of +y: intersect it with a Box or a Cylinder")

    @property
    def radius(self) -> float:
        """Of the cylinder about +y that holds it."""
        return float(np.hypot(*np.abs(self.part.bounds[:, [0, 2]]).max(axis=0)))

    @property
    def lipschitz(self) -> float:
        """That of its part times ``(a + sqrt(a^2 + 4)) / 2``, a = angle per unit times radius; at least 1."""
        shear = abs(math.radians(self.degrees_per_unit)) * self.radius
        return max(self.part.lipschitz * (shear + math.sqrt(shear * shear + 4.0)) / 2.0, 1.0)

    def _at(self, p: Floats) -> Floats:
        radius, from_axis = self.radius, np.hypot(p[:, 0], p[:, 2])
        share = np.where(from_axis > radius, radius / np.where(from_axis > 0.0, from_axis, 1.0), 1.0)
        angle = math.radians(self.degrees_per_unit) * p[:, 1]
        c, s = np.cos(angle) * share, np.sin(angle) * share
        turned = np.stack([c * p[:, 0] - s * p[:, 2], p[:, 1], s * p[:, 0] + c * p[:, 2]], axis=1)
        return np.maximum(self.part._at(turned), from_axis - radius)

    def _within(self, level: float) -> Floats:
        low, high = self.part._within(level)
        reach = self.radius + level
        return np.array([[-reach, low[1], -reach], [reach, high[1], reach]])


# --- the geometry ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class DistanceField(_Bounded):
    """What is inside of a field of distances, as a geometry that a `Shape` shows.

    Rays trace spheres along it and find its surface to rounding. The rasteriser draws it as triangles, as fine as it is large in the
    picture but for what is smaller than a hundredth of it. Texture coordinates are those of its box: each point shows what the face
    shows towards which it looks most.

    Parameters
    ----------
    expression : Distance
        With an end: what has none is to be intersected with something that has one.
    """

    expression: Distance

    def __post_init__(self) -> None:
        _part(self.expression, "distance_field.expression")
        low, high = self.expression.bounds
        if not np.isfinite([low, high]).all():
            raise SceneError("distance_field.expression must have an end: intersect what has none with a Box or a Sphere")
        if not (low < high).all():
            raise SceneError("distance_field.expression holds nothing: its parts have nothing in common")

    def range_along(self, directions: ArrayLike) -> Range:
        """See `Sphere.range_along`: that of its box."""
        a = np.asarray(directions, dtype=np.float64)
        low, high = self.expression.bounds
        reach = np.abs(a) @ ((high - low) / 2.0)
        middle = a @ ((low + high) / 2.0)
        return middle - reach, middle + reach
