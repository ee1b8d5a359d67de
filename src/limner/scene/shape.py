"""What a node shows: a geometry and its materials. Meshes are triangles; all other geometries are exact."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from ..errors import SceneError
from ..mesh.mesh import Mesh
from .displacement import Displacement
from .distance_field import DistanceField
from .line_set import LineSet
from .material import Lambert, Material
from .points import PointCloud
from .primitive import BilinearPatch, Box, Cone, Cylinder, Disk, Plane, Primitive, Quadric, Sphere, Torus
from .rig import Binding, Morph
from .solid import Combination, Complement, Difference, Intersection, Solid, Union

__all__ = [
    "BilinearPatch", "Box", "Combination", "Complement", "Cone", "Cylinder", "Difference", "Disk", "DistanceField", "Geometry",
    "Intersection", "LineSet", "Plane", "PointCloud", "Primitive", "Quadric", "Shape", "Solid", "Sphere", "Torus", "Union",
]  # fmt: skip

Geometry: TypeAlias = Mesh | PointCloud | LineSet | Primitive | Combination | DistanceField


@dataclass(frozen=True)
class Shape:
    """A geometry with its materials.

    Parameters
    ----------
    geometry : Mesh, PointCloud, LineSet, primitive, combination or DistanceField
        Sphere, Plane, Box, Disk, Cylinder, Cone, Torus, Quadric, BilinearPatch; Union, Intersection, Difference, Complement.
    materials : tuple of materials, or one material
        A mesh's `triangle_materials` index into it; all else takes the first, but for parts of combinations that have their own.
    morphs : tuple of Morph
        What a mesh turns into, by the weights of the node that shows it.
    binding : Binding, optional
        By which joints of the node's skin a mesh is led.
    displacement : Displacement, optional
        How its surface is moved, on as many triangles as the picture needs. Exact shapes then are no longer exact: what is moved is their
        tessellation.
    """

    geometry: Geometry
    materials: tuple[Material, ...] = field(default=(Lambert(),))
    morphs: tuple[Morph, ...] = ()
    binding: Binding | None = None
    displacement: Displacement | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.geometry, Geometry):
            expected = "a Mesh, a PointCloud, a LineSet, a Sphere, Box or another primitive, a DistanceField or a combination of solids"
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
        object.__setattr__(self, "morphs", tuple(self.morphs))
        if self.morphs or self.binding is not None:
            self._check_rig()
        if self.displacement is not None:
            self._check_displacement()

    def _check_rig(self) -> None:
        if not isinstance(self.geometry, Mesh):
            raise SceneError(f"shape.morphs and shape.binding are for meshes, got {type(self.geometry).__name__}")
        for morph in self.morphs:
            if not isinstance(morph, Morph):
                raise SceneError(f"shape.morphs must be Morphs, got {type(morph).__name__}")
            morph.check(self.geometry)
        if self.binding is not None and (not isinstance(self.binding, Binding) or len(self.binding.joints) != len(self.geometry.positions)):
            count = len(self.geometry.positions)
            raise SceneError(f"shape.binding must be a Binding with a row for each of the mesh's {count} positions", self.geometry.name)

    def _check_displacement(self) -> None:
        if not isinstance(self.displacement, Displacement):
            raise SceneError(f"shape.displacement must be a Displacement, got {type(self.displacement).__name__}")
        without = {Plane: "a plane without end", PointCloud: "a point cloud", LineSet: "lines"}
        if type(self.geometry) in without:
            what = without[type(self.geometry)]
            raise SceneError(f"shape.displacement moves bounded surfaces, not {what}: use a mesh")
