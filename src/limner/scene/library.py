"""Scenes that come with limner: something to look at before anything is loaded.

    teapot     Newell's teapot as glazed earthenware on a checkered floor without horizon
    cornell    the Cornell box, as measured

Each has its camera and its lights, and fits pictures from 4:3 to wide.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..linear import transform
from ..mesh.mesh import Mesh
from ..mesh.shapes.teapot import teapot
from .camera import PerspectiveCamera
from .light import AmbientLight, DirectionalLight, SpotLight
from .material import BlinnPhong, Lambert, Material
from .node import Node
from .scene import Scene
from .shape import Plane, Shape
from .texture import Texels, Texture

__all__ = ["BUILTINS", "builtin"]

BUILTINS = ("cornell", "teapot")


def builtin(name: str) -> Scene:
    """Make one of the scenes that come with limner.

    Parameters
    ----------
    name : str
        One of `BUILTINS`.

    Returns
    -------
    Scene

    Examples
    --------
    >>> [placed.path for placed, _ in builtin("teapot").shapes()]
    ['teapot/floor', 'teapot/pot']
    """
    if name == "teapot":
        return _teapot_scene()
    if name == "cornell":
        return _cornell_scene()
    raise SceneError(f"built-in scenes are {' and '.join(BUILTINS)}, got {name!r}")


# --- teapot ---------------------------------------------------------------------------------------------------------------

_TOWARDS_KEY = (-0.55, 0.95, 0.75)
_TOWARDS_FILL = (0.9, 0.35, 0.35)
_KEY_LUX = 0.88 * math.pi
_FILL_LUX = 0.16 * math.pi
_AMBIENT = 0.14

# Linear, in 255ths; their mean is a whole number, so that the smallest mipmap holds it exactly.
_LIGHT_TILE = (158, 162, 166)
_DARK_TILE = (118, 124, 130)
_TILE_METRES = 0.5


def _teapot_scene() -> Scene:
    glaze = BlinnPhong(
        diffuse=(0.62, 0.17, 0.055), specular=(0.6, 0.58, 0.54), exponent=160.0, mirror=(0.05, 0.05, 0.05), name="glaze"
    )
    root = Node(
        name="teapot",
        children=(
            Node(name="floor", parent_from_node=transform.rotate_y(math.radians(12.0)), shapes=(Shape(Plane(), (_tiles(),)),)),
            Node(name="pot", shapes=(Shape(teapot(), (glaze,)),)),
            _sun("key", _TOWARDS_KEY, DirectionalLight(color=(1.0, 0.97, 0.92), intensity=_KEY_LUX)),
            _sun("fill", _TOWARDS_FILL, DirectionalLight(color=(0.88, 0.94, 1.0), intensity=_FILL_LUX)),
            Node(name="ambient", lights=(AmbientLight(intensity=_AMBIENT),)),
        ),
    )
    camera = PerspectiveCamera.look_at((1.35, 2.35, 5.9), (0.1, 0.68, 0.0), yfov_degrees=27.0, name="camera")
    return Scene(root=root, camera=camera, background=_floor_radiance(), name="teapot")


def _sun(name: str, towards: tuple[float, float, float], light: DirectionalLight) -> Node:
    frame = transform.frame_from_gaze(10.0 * np.array(towards), -np.array(towards), (0.0, 1.0, 0.0))
    return Node(name=name, parent_from_node=frame, lights=(light,))


def _tiles() -> Lambert:
    """A checkered floor of two by two tiles a texture."""
    texels = np.empty((128, 128, 4), dtype=np.uint8)
    row, column = np.indices((128, 128)) // 64
    texels[..., :3] = np.where(((row + column) % 2 == 0)[..., None], _LIGHT_TILE, _DARK_TILE)
    texels[..., 3] = 255
    scale = 1.0 / (2.0 * _TILE_METRES)
    texture = Texture(Texels(texels, srgb=False, name="tiles"), scale=(scale, scale))
    return Lambert(color=(1.0, 1.0, 1.0), texture=texture, name="tiles")


def _floor_radiance() -> tuple[float, float, float]:
    """Radiance of the floor where its tiles blur into their mean: as a background, it hides the horizon."""
    tone = (np.array(_LIGHT_TILE) + np.array(_DARK_TILE)) / 2.0 / 255.0
    key, fill = (v[1] / math.hypot(*v) for v in (_TOWARDS_KEY, _TOWARDS_FILL))
    light = (
        np.array((1.0, 0.97, 0.92)) * (_KEY_LUX * key / math.pi)
        + np.array((0.88, 0.94, 1.0)) * (_FILL_LUX * fill / math.pi)
        + _AMBIENT
    )
    red, green, blue = (tone * light).tolist()
    return red, green, blue


# --- Cornell box ------------------------------------------------------------------------------------------------------------
#
# Source: "Cornell Box Data", Cornell University Program of Computer Graphics (graphics.cornell.edu/online/box/data.html), made
# public as a reference for renderers; after Goral, Torrance, Greenberg and Battaile, "Modeling the Interaction of Light Between
# Diffuse Surfaces", SIGGRAPH 1984. Quadrilaterals as published, in millimetres, counter-clockwise seen from inside the box.

_QUADS = {
    "floor": ((552.8, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 559.2), (549.6, 0.0, 559.2)),
    "ceiling": ((556.0, 548.8, 0.0), (556.0, 548.8, 559.2), (0.0, 548.8, 559.2), (0.0, 548.8, 0.0)),
    "back wall": ((549.6, 0.0, 559.2), (0.0, 0.0, 559.2), (0.0, 548.8, 559.2), (556.0, 548.8, 559.2)),
    "right wall": ((0.0, 0.0, 559.2), (0.0, 0.0, 0.0), (0.0, 548.8, 0.0), (0.0, 548.8, 559.2)),
    "left wall": ((552.8, 0.0, 0.0), (549.6, 0.0, 559.2), (556.0, 548.8, 559.2), (556.0, 548.8, 0.0)),
}
_LIGHT = ((343.0, 548.8, 227.0), (343.0, 548.8, 332.0), (213.0, 548.8, 332.0), (213.0, 548.8, 227.0))
# Footprints (x, z), clockwise on the plan seen with x right and z up, and heights. Published without their undersides.
_SHORT_BLOCK = ((130.0, 65.0), (82.0, 225.0), (240.0, 272.0), (290.0, 114.0)), 165.0
_TALL_BLOCK = ((423.0, 247.0), (265.0, 296.0), (314.0, 456.0), (472.0, 406.0)), 330.0

# The measured reflectance spectra as linear Rec. 709, as Morgan McGuire's Computer Graphics Archive has them.
_WHITE = Lambert(color=(0.725, 0.71, 0.68), name="white")
_RED = Lambert(color=(0.63, 0.065, 0.05), name="red")
_GREEN = Lambert(color=(0.14, 0.45, 0.091), name="green")

# The light stands in the plane of the ceiling; a millimetre lower it is in front of it for certain.
_LIGHT_DROP = 1.0
_LIGHT_COLOR = (1.0, 0.93, 0.82)
_LIGHT_CANDELA = 0.7


def _cornell_scene() -> Scene:
    walls = {"right wall": _GREEN, "left wall": _RED}
    children = [_cornell_node(name, _faces((corners,)), walls.get(name, _WHITE)) for name, corners in _QUADS.items()]
    children += [_cornell_node("short block", _block(*_SHORT_BLOCK), _WHITE)]
    children += [_cornell_node("tall block", _block(*_TALL_BLOCK), _WHITE)]
    lamp = np.array(_LIGHT) - (0.0, _LIGHT_DROP, 0.0)
    glow = Lambert(color=(0.78, 0.78, 0.78), emission=(4.0, 3.6, 3.0), name="light")
    children += [_cornell_node("light", _faces((lamp,)), glow), _lamp_node(lamp.mean(axis=0) / 1000.0)]
    children += [Node(name="ambient", lights=(AmbientLight(intensity=0.12),))]
    # 35 mm behind a film of 25 by 25 mm.
    yfov_degrees = math.degrees(2.0 * math.atan(0.0125 / 0.035))
    camera = PerspectiveCamera.look_at((0.278, 0.273, -0.8), (0.278, 0.273, 0.0), yfov_degrees=yfov_degrees, name="camera")
    return Scene(root=Node(name="cornell", children=tuple(children)), camera=camera, background=(0.0, 0.0, 0.0), name="cornell")


def _lamp_node(center: NDArray[np.float64]) -> Node:
    """A lamp in the middle of the light that shines downwards only, and the less the flatter, as a luminous patch does."""
    frame = transform.frame_from_gaze(center - (0.0, 0.001, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
    lamp = SpotLight(color=_LIGHT_COLOR, intensity=_LIGHT_CANDELA, inner_degrees=0.0, outer_degrees=90.0, name="lamp")
    return Node(name="lamp", parent_from_node=frame, lights=(lamp,))


def _cornell_node(name: str, mesh: Mesh, material: Material) -> Node:
    return Node(name=name, shapes=(Shape(mesh, (material,)),))


def _faces(quads: object) -> Mesh:
    """Flat quadrilaterals, millimetres, as a faceted mesh in metres."""
    corners = np.asarray(quads, dtype=np.float64).reshape(-1, 4, 3) / 1000.0
    split = np.array([0, 1, 2, 0, 2, 3])
    triangles = (4 * np.arange(len(corners))[:, None] + split).reshape(-1, 3)
    return Mesh(positions=corners.reshape(-1, 3).astype(np.float32), triangles=triangles.astype(np.int32))


def _block(footprint: tuple[tuple[float, float], ...], height: float) -> Mesh:
    top = [(x, height, z) for x, z in footprint]
    floor = [(x, 0.0, z) for x, z in footprint]
    sides = [(floor[i], floor[(i + 1) % 4], top[(i + 1) % 4], top[i]) for i in range(4)]
    return _faces([top, *sides])
