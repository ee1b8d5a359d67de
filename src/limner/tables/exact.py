"""Exact shapes as kernels read them: kinds, sizes, the numbers of quadrics and patches, the leaves and programs of combinations.

A combination of solids is a tree, and a ray must not recurse. So it is written as a program for a stack, its parts before their
operation (Łukasiewicz), and its primitives as rows beside those of the scene:

    Difference(Sphere(), Union(Box(), Torus()))     ->     leaves: sphere, box, torus     program: 0 1 2 UNION DIFFERENCE
"""

from __future__ import annotations

import zlib
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh.mesh import Mesh
from ..scene.distance_field import DistanceField
from ..scene.line_set import LineSet
from ..scene.material import Material
from ..scene.points import PointCloud
from ..scene.primitive import BilinearPatch, Box, Cone, Cylinder, Disk, Plane, Primitive, Quadric, Sphere, Torus
from ..scene.shape import Geometry, Shape
from ..scene.solid import Combination, Complement, Difference, Intersection, Union
from . import layouts
from .distance import numbers_of

__all__ = ["Leaf", "Numbers", "fill_shape", "leaves_and_program", "materials_of"]

_OPERATIONS = {
    Union: layouts.UNION,
    Intersection: layouts.INTERSECTION,
    Difference: layouts.DIFFERENCE,
    Complement: layouts.COMPLEMENT,
}


class Leaf(NamedTuple):
    """A primitive of a combination, in its place there; material None: that of the shape."""

    geometry: Primitive
    combination_from_leaf: NDArray[np.float64]
    material: Material | None


class Numbers:
    """Numbers that stand one after the other, behind those of the meshes; what is the same is there once."""

    def __init__(self) -> None:
        self._parts: dict[bytes, tuple[int, NDArray[np.generic]]] = {}
        self._length = 0

    def put(self, row: np.void, numbers: NDArray[np.generic]) -> None:
        """Append them, unless they are there, and tell the row where they begin."""
        content = numbers.tobytes()
        if content not in self._parts:
            self._parts[content] = self._length, numbers
            self._length += len(numbers)
        row["place"] = self._parts[content][0]
        row["checksum"] = np.uint32(zlib.crc32(content)).astype(np.int32)

    def behind(self, array: NDArray[Any]) -> NDArray[Any]:
        """`array`, and all of these after it."""
        return np.concatenate([array, *(part for _, part in self._parts.values())]) if self._parts else array


def fill_shape(row: np.void, geometry: Geometry, numbers: Numbers) -> None:
    """Fill kind, size, capped and place of an instance that is no combination; of a mesh only the kind."""
    row["kind"], row["place"] = layouts.MESH, -1
    if isinstance(geometry, (Mesh, PointCloud, LineSet)):
        return
    row["capped"] = getattr(geometry, "capped", True)
    if isinstance(geometry, Sphere):
        row["kind"], row["size"] = layouts.SPHERE, geometry.radius
    elif isinstance(geometry, Plane):
        row["kind"] = layouts.PLANE
    elif isinstance(geometry, Box):
        row["kind"], row["size"] = layouts.BOX, np.array(geometry.size) / 2.0
    elif isinstance(geometry, Disk):
        row["kind"], row["size"] = layouts.DISK, (geometry.radius, 0.0, 0.0)
    elif isinstance(geometry, Cylinder):
        row["kind"], row["size"] = layouts.CYLINDER, (geometry.radius, geometry.height, 0.0)
    elif isinstance(geometry, Cone):
        row["kind"], row["size"] = layouts.CONE, (geometry.radius, geometry.top_radius, geometry.height)
    elif isinstance(geometry, Torus):
        row["kind"], row["size"] = layouts.TORUS, (geometry.major_radius, geometry.minor_radius, 0.0)
    elif isinstance(geometry, Quadric):
        row["kind"] = layouts.QUADRIC
        numbers.put(row, np.array([*_scaled(geometry.coefficients), *geometry.low, *geometry.high], dtype=np.float32))
    elif isinstance(geometry, BilinearPatch):
        row["kind"] = layouts.PATCH
        numbers.put(row, np.array(geometry.corners, dtype=np.float32).reshape(-1))
    elif isinstance(geometry, DistanceField):
        row["kind"] = layouts.DISTANCE_FIELD
        numbers.put(row, numbers_of(geometry))


def _scaled(coefficients: tuple[float, ...]) -> NDArray[np.float64]:
    """Coefficients whose greatest is between 1/2 and 1: the same surface, safe in float32. A power of two, so that nothing is rounded."""
    given = np.array(coefficients)
    return np.asarray(np.ldexp(given, -int(np.frexp(np.abs(given).max())[1])))


def leaves_and_program(combination: Combination) -> tuple[list[Leaf], NDArray[np.int32]]:
    """Tell what a combination is made of, and how; a primitive that occurs twice in the same place is one leaf.

    Examples
    --------
    >>> leaves, program = leaves_and_program(Difference(Sphere(), Union(Box(), Torus())))
    >>> [type(leaf.geometry).__name__ for leaf in leaves], program.tolist()
    (['Sphere', 'Box', 'Torus'], [0, 1, 2, -1, -3])
    """
    leaves: list[Leaf] = []
    known: dict[tuple[object, ...], int] = {}
    program: list[int] = []

    def visit(geometry: Primitive | Combination, place: NDArray[np.float64], material: Material | None) -> None:
        if not isinstance(geometry, Combination):
            key = (id(geometry), place.tobytes(), id(material))
            if key not in known:
                known[key] = len(leaves)
                leaves.append(Leaf(geometry, place, material))
            program.append(known[key])
            return
        for k, part in enumerate(geometry.parts):
            visit(part.geometry, place @ part.parent_from_solid, part.material or material)
            if k > 0 or isinstance(geometry, Complement):
                program.append(_OPERATIONS[type(geometry)])

    visit(combination, np.eye(4), None)
    return leaves, np.array(program, dtype=np.int32)


def materials_of(shape: Shape) -> tuple[Material, ...]:
    """A shape's materials; of a combination the one that it is given, and those that its leaves have of their own."""
    if not isinstance(shape.geometry, Combination):
        return shape.materials
    leaves, _ = leaves_and_program(shape.geometry)
    found = {id(material): material for material in (shape.materials[0], *(leaf.material for leaf in leaves)) if material is not None}
    return tuple(found.values())
