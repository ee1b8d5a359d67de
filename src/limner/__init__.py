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
    from .errors import FileFormatError, LimnerError, LimnerWarning, RenderError, SceneError, UnsupportedError
    from .files.load import load
    from .files.open_image import open_image
    from .image.image import Image
    from .mesh.mesh import Mesh
    from .produce import dataset
    from .produce.stages import stages
    from .produce.thumbnails import thumbnails
    from .produce.turntable import turntable, write_turntable
    from .produce.views import views
    from .produce.wireframe import wireframe
    from .progress import Progress
    from .raycaster import RayCaster
    from .render import Renderer, render
    from .scene.camera import OrthographicCamera
    from .scene.camera import PerspectiveCamera as Camera
    from .scene.environment import Environment
    from .scene.fog import Fog
    from .scene.library import builtin
    from .scene.light import AmbientLight, DirectionalLight, DiskLight, PointLight, RectangleLight, SphereLight, SpotLight
    from .scene.material import BlinnPhong, CoolToWarm, Dielectric, Lambert, MetallicRoughness, ShadowCatcher
    from .scene.motion import Motion
    from .scene.node import Node
    from .scene.scene import Scene
    from .scene.shape import (
        BilinearPatch,
        Box,
        Complement,
        Cone,
        Cylinder,
        Difference,
        Disk,
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

__version__ = "0.1.0"

__all__ = [
    "AmbientLight",
    "BilinearPatch",
    "BlinnPhong",
    "Box",
    "Camera",
    "Complement",
    "Cone",
    "CoolToWarm",
    "Cylinder",
    "Dielectric",
    "Difference",
    "DirectionalLight",
    "Disk",
    "DiskLight",
    "Environment",
    "FileFormatError",
    "Fog",
    "Image",
    "Intersection",
    "Lambert",
    "LimnerError",
    "LimnerWarning",
    "Mesh",
    "MetallicRoughness",
    "Motion",
    "Node",
    "OrthographicCamera",
    "Plane",
    "PointLight",
    "Progress",
    "Quadric",
    "RayCaster",
    "RectangleLight",
    "RenderError",
    "Renderer",
    "Scene",
    "SceneError",
    "ShadowCatcher",
    "Shape",
    "Solid",
    "Sphere",
    "SphereLight",
    "SpotLight",
    "Texels",
    "Texture",
    "Torus",
    "Union",
    "UnsupportedError",
    "__version__",
    "builtin",
    "dataset",
    "draw",
    "load",
    "open_image",
    "render",
    "stages",
    "thumbnails",
    "turntable",
    "views",
    "wireframe",
    "write_turntable",
]

_ORIGINAL_NAMES = {"Camera": "PerspectiveCamera"}

_HOMES = {
    "errors": ("FileFormatError", "LimnerError", "LimnerWarning", "RenderError", "SceneError", "UnsupportedError"),
    "files.load": ("load",),
    "files.open_image": ("open_image",),
    "image.image": ("Image",),
    "mesh.mesh": ("Mesh",),
    "produce.stages": ("stages",),
    "produce.thumbnails": ("thumbnails",),
    "produce.turntable": ("turntable", "write_turntable"),
    "produce.views": ("views",),
    "produce.wireframe": ("wireframe",),
    "progress": ("Progress",),
    "raycaster": ("RayCaster",),
    "render": ("Renderer", "render"),
    "scene.camera": ("Camera", "OrthographicCamera"),
    "scene.environment": ("Environment",),
    "scene.fog": ("Fog",),
    "scene.library": ("builtin",),
    "scene.light": ("AmbientLight", "DirectionalLight", "DiskLight", "PointLight", "RectangleLight", "SphereLight", "SpotLight"),
    "scene.material": ("BlinnPhong", "CoolToWarm", "Dielectric", "Lambert", "MetallicRoughness", "ShadowCatcher"),
    "scene.motion": ("Motion",),
    "scene.node": ("Node",),
    "scene.scene": ("Scene",),
    "scene.shape": (
        "BilinearPatch", "Box", "Complement", "Cone", "Cylinder", "Difference", "Disk", "Intersection", "Plane", "Quadric", "Shape",
        "Solid", "Sphere", "Torus", "Union",
    ),
    "scene.texture": ("Texels", "Texture"),
}
_MODULES = {"dataset": "produce.dataset", "draw": "draw"}
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
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
