"""Constructive solid geometry (FoCG 13.3): solids made of solids by union, intersection, difference and complement.

    die = Difference(
        Intersection(Box(1.0), Sphere(0.68)),
        Solid(Sphere(0.1), translate(0.0, 0.55, 0.0), material=black),
    )

A combination is a geometry like any other: a `Shape` shows it with a material. Its parts may bring their own places and materials, by
`Solid`; what is cut away leaves a surface of what cut it, in the material of that. It is seen from inside where any of its materials is
double-sided.

Rays meet combinations exactly. The rasteriser draws their boundary as triangles, whose edges follow cuts to a fraction of a pixel but
may miss what is smaller than a fiftieth of the whole (`limner.tables.stand_ins`).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ._values import matrix4
from .material import Material
from .primitive import Box, Cone, Cylinder, Plane, Quadric, Range, Sphere, Torus, _Bounded

__all__ = ["MAX_LEAVES", "MAX_NESTING", "Combination", "Complement", "Difference", "Intersection", "Solid", "Union"]

MAX_LEAVES = 62
"""Primitives of one combination."""

MAX_NESTING = 64
"""How deep combinations may stand in each other."""

_SOLID = (Sphere, Plane, Box, Cylinder, Cone, Torus, Quadric)
_HINT = "solids: a Sphere, Plane, Box, Torus, capped Cylinder, Cone or Quadric, or what is made of these"


@dataclass(frozen=True, eq=False)
class Solid:
    """A part of a combination: a solid in its place.

    Parameters
    ----------
    geometry : Sphere | Plane | Box | Torus | Cylinder | Cone | Quadric | Union | Intersection | Difference | Complement
        Cylinders, cones and quadrics must be capped.
    parent_from_solid : (4, 4) float64
        Affine; its place in what it is part of.
    material : Material, optional
        None: that of what it is part of.
    """

    geometry: Any
    parent_from_solid: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    material: Material | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.geometry, (*_SOLID, _Combination)):
            raise SceneError(f"solid.geometry must be one of the {_HINT}; got {type(self.geometry).__name__}")
        if not getattr(self.geometry, "capped", True):
            name = type(self.geometry).__name__
            raise SceneError(f"solid.geometry must have an inside: a {name} with capped=False is an open sheet")
        matrix = matrix4(self.parent_from_solid, "solid.parent_from_solid")
        if not abs(np.linalg.det(matrix[:3, :3])) > 0.0:
            raise SceneError("solid.parent_from_solid must not flatten")
        object.__setattr__(self, "parent_from_solid", matrix)
        if self.material is not None and not isinstance(self.material, Material):
            raise SceneError(f"solid.material must be a material, got {type(self.material).__name__}")

    def range_along(self, directions: ArrayLike) -> Range:
        """Tell the least and the greatest a . p over the solid in its place; see `Sphere.range_along`."""
        a = np.asarray(directions, dtype=np.float64)
        low, high = self.geometry.range_along(a @ self.parent_from_solid[:3, :3])
        moved = a @ self.parent_from_solid[:3, 3]
        return low + moved, high + moved


@dataclass(frozen=True, eq=False, init=False)
class _Combination(_Bounded):
    """Parts, and what is made of them."""

    parts: tuple[Solid, ...]

    def __init__(self, *parts: Any) -> None:
        name = type(self).__name__.lower()
        least, most = self._COUNTS
        if not least <= len(parts) <= (most or len(parts)):
            expected = f"{least} part" if most == least else f"at least {least} parts"
            raise SceneError(f"{name} must have {expected}, got {len(parts)}")
        for part in parts:
            if not isinstance(part, (Solid, *_SOLID, _Combination)):
                raise SceneError(f"{name} must be made of {_HINT}; got {type(part).__name__}")
        object.__setattr__(self, "parts", tuple(part if isinstance(part, Solid) else Solid(part) for part in parts))
        inner = [part.geometry for part in self.parts if isinstance(part.geometry, _Combination)]
        n_leaves = len(parts) - len(inner) + sum(geometry.n_leaves for geometry in inner)
        nesting = 1 + max((geometry._nesting for geometry in inner), default=0)
        if n_leaves > MAX_LEAVES:
            raise SceneError(f"{name} is made of {n_leaves} primitives, more than {MAX_LEAVES}: make several shapes of it")
        if nesting > MAX_NESTING:
            raise SceneError(f"{name} is nested {nesting} deep, more than {MAX_NESTING}")
        object.__setattr__(self, "n_leaves", n_leaves)
        object.__setattr__(self, "_nesting", nesting)

    _COUNTS = (2, 0)  # least and most parts; 0: no most
    n_leaves = 0
    """Primitives that it is made of."""
    _nesting = 0

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(repr(_plain(part)) for part in self.parts)})"

    @property
    def hull(self) -> NDArray[np.float64]:
        """(8, 3) float64: the corners of its box; (0, 3) where it has no end, or nothing is left."""
        low, high = self.bounds
        return super().hull if np.isfinite([low, high]).all() and (low <= high).all() else np.zeros((0, 3))


def _plain(part: Solid) -> Any:
    """The geometry of a part that has no place and no material of its own."""
    return part.geometry if part.material is None and np.array_equal(part.parent_from_solid, np.eye(4)) else part


class Union(_Combination):
    """What is in any of its parts."""

    def range_along(self, directions: ArrayLike) -> Range:
        """See `Sphere.range_along`."""
        lows, highs = zip(*(part.range_along(directions) for part in self.parts), strict=True)
        return np.min(lows, axis=0), np.max(highs, axis=0)


class Intersection(_Combination):
    """What is in all of its parts."""

    def range_along(self, directions: ArrayLike) -> Range:
        """See `Sphere.range_along`: no less than it reaches; the least above the greatest where nothing is left."""
        lows, highs = zip(*(part.range_along(directions) for part in self.parts), strict=True)
        return np.max(lows, axis=0), np.min(highs, axis=0)


class Difference(_Combination):
    """What is in its first part and in none of the others."""

    def range_along(self, directions: ArrayLike) -> Range:
        """See `Sphere.range_along`: that of the first part."""
        return self.parts[0].range_along(directions)


class Complement(_Combination):
    """What is not in its part: all space around it. It has no end, so it is for intersections."""

    _COUNTS = (1, 1)

    def range_along(self, directions: ArrayLike) -> Range:
        """See `Sphere.range_along`: without end."""
        n = len(np.asarray(directions))
        return np.full(n, -np.inf), np.full(n, np.inf)


Combination: TypeAlias = Union | Intersection | Difference | Complement
