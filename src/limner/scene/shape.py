"""What a node shows: a geometry and its materials. Spheres, planes and boxes are exact; meshes are triangles."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from ..errors import SceneError
from ..mesh.mesh import Mesh
from ._values import Triple, positive, triple
from .material import Lambert, Material

__all__ = ["Box", "Geometry", "Plane", "Shape", "Sphere"]


@dataclass(frozen=True)
class Sphere:
    """|p| = radius, around the node's origin."""

    radius: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "sphere.radius"))


@dataclass(frozen=True)
class Plane:
    """The infinite plane y = 0, its front towards +y; (u, v) = (x, -z), metres."""


@dataclass(frozen=True)
class Box:
    """The axis-aligned box of the given edge lengths around the node's origin."""

    size: Triple = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        size = triple(self.size, "box.size")
        for edge in size:
            positive(edge, "box.size")
        object.__setattr__(self, "size", size)


Geometry: TypeAlias = Mesh | Sphere | Plane | Box


@dataclass(frozen=True)
class Shape:
    """A geometry with its materials.

    Parameters
    ----------
    geometry : Mesh | Sphere | Plane | Box
    materials : tuple of materials, or one material
        A mesh's `triangle_materials` index into it; all else takes the first.
    """

    geometry: Geometry
    materials: tuple[Material, ...] = field(default=(Lambert(),))

    def __post_init__(self) -> None:
        if not isinstance(self.geometry, Geometry):
            raise SceneError(f"shape.geometry must be a Mesh, Sphere, Plane or Box, got {type(self.geometry).__name__}")
        given = self.materials
        materials = tuple(given) if isinstance(given, (tuple, list)) else (given,)
        if not materials:
            materials = (Lambert(),)
        for material in materials:
            if not isinstance(material, Material):
                raise SceneError(f"shape.materials must be materials, got {type(material).__name__}")
        object.__setattr__(self, "materials", materials)
        slots = getattr(self.geometry, "triangle_materials", None)
        if slots is not None and slots.size and int(slots.max()) >= len(materials):
            raise SceneError(f"mesh.triangle_materials needs {int(slots.max()) + 1} materials, the shape has {len(materials)}")
