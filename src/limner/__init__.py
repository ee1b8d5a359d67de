"""limner: pictures from three-dimensional models, on the processor alone.

    import limner

    scene = limner.load("model.glb")
    image = limner.render(scene, width=800, height=600)
    image.save("picture.png")

Names are loaded on first use: importing limner imports neither NumPy nor Numba.
"""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import draw
    from .artistic.lines import Drawing, FeatureLine, drawing_of
    from .artistic.style import LineLook, LineStyle
    from .color.convert import convert_color
    from .color.difference import color_difference
    from .color.gamut import fit_to_gamut
    from .color.light import light_color, rgb_from_reflectance
    from .color.metals import metal_color
    from .color.spectrum import Spectrum
    from .color.transfer import gamma_from_match
    from .curves.arc_length import ArcLength
    from .curves.curve import Parametric, Spline
    from .draw.color_bar import ColorBar, with_color_bar
    from .errors import FileFormatError, LimnerError, LimnerWarning, RenderError, SceneError, UnsupportedError
    from .explain.doctor import doctor
    from .explain.explain import Explanation, explain
    from .explain.findings import Diagnosis, Finding
    from .files.interop import to_trimesh
    from .files.load import load
    from .files.open_image import open_image
    from .files.pictures import read_texels
    from .files.report import LoadEntry, LoadReport, load_report
    from .files.save_mesh import save_model
    from .files.scene_file import save_scene, settings_of
    from .image.denoise import denoised
    from .image.image import Image
    from .mesh import subdivide
    from .mesh.adjacency import adjacency
    from .mesh.examine.report import TopologyReport, topology_report
    from .mesh.implicit.marching_cubes import marching_cubes
    from .mesh.mesh import Mesh
    from .mesh.polygons import mesh_from_polygons
    from .mesh.projection import project_uvs
    from .mesh.repair.repair import RepairReport, repair
    from .mesh.reshape.boolean import boolean
    from .mesh.reshape.displace import displaced
    from .mesh.reshape.simplify import simplify
    from .mesh.shapes import primitives
    from .mesh.tangents import with_tangents
    from .mesh.unwrap.distortion import UnwrapReport, unwrap_report, uv_distortion
    from .mesh.unwrap.unwrap import uv_unwrap
    from .produce import dataset
    from .produce.animate import animate, write_animation
    from .produce.charts import chart
    from .produce.draw_sheet import technical_sheet
    from .produce.drawing import Plate, drawing
    from .produce.stages import stages
    from .produce.stylized import stylized
    from .produce.thumbnails import thumbnails
    from .produce.turntable import turntable, write_turntable
    from .produce.uv_chart import uv_chart
    from .produce.views import views
    from .produce.wireframe import wireframe
    from .progress import Progress
    from .raycaster import AllHits, RayCaster, Visits
    from .render import Renderer, render
    from .scene import distance
    from .scene.animation import Animation, FieldChannel, NodeChannel, WeightsChannel
    from .scene.camera import OrthographicCamera
    from .scene.camera import PerspectiveCamera as Camera
    from .scene.color_by import color_by
    from .scene.displacement import Displacement
    from .scene.environment import Environment
    from .scene.fog import Fog
    from .scene.library import builtin
    from .scene.light import AmbientLight, DirectionalLight, DiskLight, PointLight, RectangleLight, SphereLight, SpotLight
    from .scene.line_set import LineSet
    from .scene.material import BlinnPhong, CoolToWarm, Dielectric, Lambert, MetallicRoughness, ShadowCatcher, Variant
    from .scene.material_extensions import Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Sheen, Specular, Transmission, Volume
    from .scene.motion import KeyedMotion, Motion
    from .scene.node import Node
    from .scene.points import PointCloud
    from .scene.procedural import Checker, Gradient, Marble, Noise, Stripes, Turbulence, Wood
    from .scene.rig import Binding, Morph, Skin
    from .scene.scene import Scene
    from .scene.shape import (
        BilinearPatch,
        Box,
        Complement,
        Cone,
        Cylinder,
        Difference,
        Disk,
        DistanceField,
        Intersection,
        Plane,
        Quadric,
        Shape,
        Solid,
        Sphere,
        Torus,
        Union,
    )
    from .scene.texture import Texels, Texture
    from .scene.track import Track
    from .scene.variants import variant_names, with_variant

__version__ = "0.1.0"

__all__ = [
    "AllHits",
    "AmbientLight",
    "Animation",
    "Anisotropy",
    "ArcLength",
    "BilinearPatch",
    "Binding",
    "BlinnPhong",
    "Box",
    "Camera",
    "Checker",
    "Clearcoat",
    "ColorBar",
    "Complement",
    "Cone",
    "CoolToWarm",
    "Cylinder",
    "Diagnosis",
    "Dielectric",
    "Difference",
    "DiffuseTransmission",
    "DirectionalLight",
    "Disk",
    "DiskLight",
    "Displacement",
    "DistanceField",
    "Drawing",
    "Environment",
    "Explanation",
    "FeatureLine",
    "FieldChannel",
    "FileFormatError",
    "Finding",
    "Fog",
    "Gradient",
    "Image",
    "Intersection",
    "Iridescence",
    "KeyedMotion",
    "Lambert",
    "LimnerError",
    "LimnerWarning",
    "LineLook",
    "LineSet",
    "LineStyle",
    "LoadEntry",
    "LoadReport",
    "Marble",
    "Mesh",
    "MetallicRoughness",
    "Morph",
    "Motion",
    "Node",
    "NodeChannel",
    "Noise",
    "OrthographicCamera",
    "Parametric",
    "Plane",
    "Plate",
    "PointCloud",
    "PointLight",
    "Progress",
    "Quadric",
    "RayCaster",
    "RectangleLight",
    "RenderError",
    "Renderer",
    "RepairReport",
    "Scene",
    "SceneError",
    "ShadowCatcher",
    "Shape",
    "Sheen",
    "Skin",
    "Solid",
    "Spectrum",
    "Specular",
    "Sphere",
    "SphereLight",
    "Spline",
    "SpotLight",
    "Stripes",
    "Texels",
    "Texture",
    "TopologyReport",
    "Torus",
    "Track",
    "Transmission",
    "Turbulence",
    "Union",
    "UnsupportedError",
    "UnwrapReport",
    "Variant",
    "Visits",
    "Volume",
    "WeightsChannel",
    "Wood",
    "__version__",
    "adjacency",
    "animate",
    "boolean",
    "builtin",
    "chart",
    "color_by",
    "color_difference",
    "convert_color",
    "dataset",
    "denoised",
    "displaced",
    "distance",
    "doctor",
    "draw",
    "drawing",
    "drawing_of",
    "explain",
    "fit_to_gamut",
    "gamma_from_match",
    "light_color",
    "load",
    "load_report",
    "marching_cubes",
    "mesh_from_polygons",
    "metal_color",
    "open_image",
    "primitives",
    "project_uvs",
    "read_texels",
    "render",
    "repair",
    "rgb_from_reflectance",
    "save_model",
    "save_scene",
    "settings_of",
    "simplify",
    "stages",
    "stylized",
    "subdivide",
    "technical_sheet",
    "thumbnails",
    "to_trimesh",
    "topology_report",
    "turntable",
    "unwrap_report",
    "uv_chart",
    "uv_distortion",
    "uv_unwrap",
    "variant_names",
    "views",
    "wireframe",
    "with_color_bar",
    "with_tangents",
    "with_variant",
    "write_animation",
    "write_turntable",
]

_ORIGINAL_NAMES = {"Camera": "PerspectiveCamera"}

_HOMES = {
    "artistic.lines": ("Drawing", "FeatureLine", "drawing_of"),
    "artistic.style": ("LineLook", "LineStyle"),
    "color.convert": ("convert_color",),
    "color.difference": ("color_difference",),
    "color.gamut": ("fit_to_gamut",),
    "color.light": ("light_color", "rgb_from_reflectance"),
    "color.metals": ("metal_color",),
    "color.spectrum": ("Spectrum",),
    "color.transfer": ("gamma_from_match",),
    "curves.arc_length": ("ArcLength",),
    "curves.curve": ("Parametric", "Spline"),
    "draw.color_bar": ("ColorBar", "with_color_bar"),
    "errors": ("FileFormatError", "LimnerError", "LimnerWarning", "RenderError", "SceneError", "UnsupportedError"),
    "explain.doctor": ("doctor",),
    "explain.explain": ("Explanation", "explain"),
    "explain.findings": ("Diagnosis", "Finding"),
    "files.interop": ("to_trimesh",),
    "files.load": ("load",),
    "files.open_image": ("open_image",),
    "files.pictures": ("read_texels",),
    "files.report": ("LoadEntry", "LoadReport", "load_report"),
    "files.save_mesh": ("save_model",),
    "files.scene_file": ("save_scene", "settings_of"),
    "image.denoise": ("denoised",),
    "image.image": ("Image",),
    "mesh.adjacency": ("adjacency",),
    "mesh.examine.report": ("TopologyReport", "topology_report"),
    "mesh.implicit.marching_cubes": ("marching_cubes",),
    "mesh.mesh": ("Mesh",),
    "mesh.polygons": ("mesh_from_polygons",),
    "mesh.projection": ("project_uvs",),
    "mesh.repair.repair": ("RepairReport", "repair"),
    "mesh.reshape.boolean": ("boolean",),
    "mesh.reshape.displace": ("displaced",),
    "mesh.reshape.simplify": ("simplify",),
    "mesh.tangents": ("with_tangents",),
    "mesh.unwrap.distortion": ("UnwrapReport", "unwrap_report", "uv_distortion"),
    "mesh.unwrap.unwrap": ("uv_unwrap",),
    "produce.animate": ("animate", "write_animation"),
    "produce.charts": ("chart",),
    "produce.draw_sheet": ("technical_sheet",),
    "produce.drawing": ("Plate", "drawing"),
    "produce.stages": ("stages",),
    "produce.stylized": ("stylized",),
    "produce.thumbnails": ("thumbnails",),
    "produce.turntable": ("turntable", "write_turntable"),
    "produce.uv_chart": ("uv_chart",),
    "produce.views": ("views",),
    "produce.wireframe": ("wireframe",),
    "progress": ("Progress",),
    "raycaster": ("AllHits", "RayCaster", "Visits"),
    "render": ("Renderer", "render"),
    "scene.animation": ("Animation", "FieldChannel", "NodeChannel", "WeightsChannel"),
    "scene.camera": ("Camera", "OrthographicCamera"),
    "scene.color_by": ("color_by",),
    "scene.displacement": ("Displacement",),
    "scene.environment": ("Environment",),
    "scene.fog": ("Fog",),
    "scene.library": ("builtin",),
    "scene.light": ("AmbientLight", "DirectionalLight", "DiskLight", "PointLight", "RectangleLight", "SphereLight", "SpotLight"),
    "scene.line_set": ("LineSet",),
    "scene.material": ("BlinnPhong", "CoolToWarm", "Dielectric", "Lambert", "MetallicRoughness", "ShadowCatcher", "Variant"),
    "scene.material_extensions": (
        "Anisotropy", "Clearcoat", "DiffuseTransmission", "Iridescence", "Sheen", "Specular", "Transmission", "Volume",
    ),
    "scene.motion": ("KeyedMotion", "Motion"),
    "scene.node": ("Node",),
    "scene.points": ("PointCloud",),
    "scene.procedural": ("Checker", "Gradient", "Marble", "Noise", "Stripes", "Turbulence", "Wood"),
    "scene.rig": ("Binding", "Morph", "Skin"),
    "scene.scene": ("Scene",),
    "scene.shape": (
        "BilinearPatch", "Box", "Complement", "Cone", "Cylinder", "Difference", "Disk", "DistanceField", "Intersection", "Plane",
        "Quadric", "Shape", "Solid", "Sphere", "Torus", "Union",
    ),
    "scene.texture": ("Texels", "Texture"),
    "scene.track": ("Track",),
    "scene.variants": ("variant_names", "with_variant"),
}
_MODULES = {
    "dataset": "produce.dataset",
    "distance": "scene.distance",
    "draw": "draw",
    "primitives": "mesh.shapes.primitives",
    "subdivide": "mesh.subdivide",
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Load a public name on its first use (PEP 562)."""
    if name in _MODULES:
        return importlib.import_module(f".{_MODULES[name]}", __name__)
    home = _HOME_OF.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(f".{home}", __name__), _ORIGINAL_NAMES.get(name, name))
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class _Package(ModuleType):
    """Keeps `limner.render` the function: importing the module of that name would put the module in its place."""

    def __setattr__(self, name: str, value: Any) -> None:
        if name == "render" and isinstance(value, ModuleType):
            value = value.render
        if name == "explain" and isinstance(value, ModuleType):
            return
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
