"""What a node shows: a geometry and its materials. Meshes are triangles; all other geometries are exact."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from ..errors import SceneError
from ..mesh.mesh import Mesh
from .material import Lambert, Material
from .primitive import BilinearPatch, Box, Cone, Cylinder, Disk, Plane, Primitive, Quadric, Sphere, Torus
from .solid import Combination, Complement, Difference, Intersection, Solid, Union

__all__ = [
    "BilinearPatch", "Box", "Combination", "Complement", "Cone", "Cylinder", "Difference", "Disk", "Geometry", "Intersection", "Plane",
    "Primitive", "Quadric", "Shape", "Solid", "Sphere", "Torus", "Union",
]  # fmt: skip

Geometry: TypeAlias = Mesh | Primitive | Combination


@dataclass(frozen=True)
class Shape:
    """A geometry with its materials.

    Parameters
    ----------
    geometry : Mesh, primitive or combination
        Sphere, Plane, Box, Disk, Cylinder, Cone, Torus, Quadric, BilinearPatch; Union, Intersection, Difference, Complement.
    materials : tuple of materials, or one material
        A mesh's `triangle_materials` index into it; all else takes the first, but for parts of combinations that have their own.
    """

    geometry: Geometry
    materials: tuple[Material, ...] = field(default=(Lambert(),))

    def __post_init__(self) -> None:
        if not isinstance(self.geometry, Geometry):
            expected = "a Mesh, a Sphere, Box or another primitive, or a combination of solids"
            raise SceneError(f"shape.geometry must be {expected}, got {type(self.geometry).__name__}")
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
