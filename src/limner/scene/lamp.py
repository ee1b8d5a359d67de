"""Lamps: the surfaces of lights that have an area, so that they are seen, and meet rays, like everything else.

A visible area light stands in the scene once more as a shape that shines. Its node is a new one at the end of the graph, so that the
ids of all else stay what they were.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..linear import transform
from ..linear.affine import cross
from ..mesh.mesh import Mesh
from .light import AreaLight, DiskLight, RectangleLight, SphereLight
from .material import Dielectric, Lambert
from .node import Node
from .scene import Scene
from .shape import Box, Shape, Sphere

__all__ = ["LampShape", "has_solids", "light_frame", "lights_in_solids", "with_lamps"]

_CORNERS = 256  # of the polygon that is seen of a disk


@dataclass(frozen=True)
class LampShape(Shape):
    """The surface of a light.

    Parameters
    ----------
    light : int
        Which of the scene's lights it is.
    """

    light: int = -1


def light_frame(world_from_light: NDArray[np.float64]) -> NDArray[np.float64]:
    """(4, 4) float64: where a light stands, and its axes as unit vectors at right angles, -z along which it shines; scale left out."""
    w = world_from_light[:3, 2]
    w = w / (np.linalg.norm(w) or 1.0)
    u = cross(world_from_light[:3, 1], w)
    if not np.linalg.norm(u) > 1e-9 * np.linalg.norm(world_from_light[:3, 1]):
        u = cross((0.0, 0.0, 1.0) if abs(w[2]) < 0.9 else (1.0, 0.0, 0.0), w)
    u = u / np.linalg.norm(u)
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3] = u, cross(w, u), w, world_from_light[:3, 3]
    return frame


def with_lamps(scene: Scene, time: float = 0.0) -> Scene:
    """The scene with a shape for every visible light that has an area, where it stands at a time; the same scene where there is none."""
    lamps = tuple(
        Node(
            light.name or f"{placed.path}/lamp", light_frame(placed.world_from_object),
            shapes=(LampShape(_surface(light), (_glow(light),), light=index),),
        )
        for index, (placed, light) in enumerate(scene.lights(time))
        if isinstance(light, AreaLight) and light.visible
    )  # fmt: skip
    if not lamps:
        return scene
    root = scene.root
    if root.motion is not None or not abs(np.linalg.det(root.parent_from_node[:3, :3])) > 1e-12:
        root = Node(root.name, children=(root,))
    node_from_world = np.linalg.inv(root.parent_from_node).astype(np.float64)
    node_from_world[3] = (0.0, 0.0, 0.0, 1.0)
    return scene.replace(root=dataclasses.replace(root, children=(*root.children, Node("lamps", node_from_world, children=lamps))))


def _glow(light: AreaLight) -> Lambert:
    red, green, blue = (light.intensity * c for c in light.color)
    return Lambert((0.0, 0.0, 0.0), emission=(red, green, blue), double_sided=False, name=light.name or "lamp")


def _surface(light: AreaLight) -> Mesh | Sphere:
    if isinstance(light, SphereLight):
        return Sphere(light.radius)
    if isinstance(light, RectangleLight):
        corners = np.array([(-1, -1), (-1, 1), (1, 1), (1, -1)]) * (light.width / 2.0, light.height / 2.0)
    else:
        corners = _polygon(light)
    positions = np.concatenate([corners, np.zeros((len(corners), 1))], axis=1).astype(np.float32)
    k = np.arange(1, len(corners) - 1)
    triangles = np.stack([np.zeros_like(k), k, k + 1], axis=1).astype(np.int32)
    return Mesh(positions, triangles, name="lamp")


def _polygon(light: DiskLight) -> NDArray[np.float64]:
    """Corners of the regular polygon that has the disk's area, clockwise, so that its front is -z."""
    step = 2.0 * math.pi / _CORNERS
    radius = light.radius * math.sqrt(step / math.sin(step))
    angle = -step * np.arange(_CORNERS)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def lights_in_solids(scene: Scene) -> tuple[str, ...]:
    """A sentence for every light that stands in an opaque ball or box in which the camera does not stand."""
    solids = [(placed, geometry) for placed, shape in scene.shapes() if (geometry := _solid(shape)) is not None]
    eye = None if scene.camera is None else scene.camera.world_from_camera[:3, 3]
    said = []
    for placed, light in scene.lights():
        if type(light).__name__ in ("AmbientLight", "DirectionalLight"):
            continue
        place = placed.world_from_object[:3, 3]
        for solid, geometry in solids:
            if _inside(geometry, solid.world_from_object, place) and not (
                eye is not None and _inside(geometry, solid.world_from_object, eye)
            ):
                said.append(f"the light {light.name or placed.path!r} stands inside {solid.path!r}: its light does not get out")
    return tuple(said)


def has_solids(scene: Scene) -> bool:
    """Whether a light or a camera can stand inside something that keeps light in."""
    return any(_solid(shape) is not None for _, shape in scene.shapes())


def _solid(shape: Shape) -> Sphere | Box | None:
    """The opaque ball or box that a shape is."""
    if not isinstance(shape.geometry, (Sphere, Box)) or isinstance(shape, LampShape):
        return None
    is_opaque = not isinstance(shape.materials[0], Dielectric) and shape.materials[0].alpha_mode == "opaque"
    return shape.geometry if is_opaque else None


def _inside(geometry: Sphere | Box, world_from_object: NDArray[np.float64], point: NDArray[np.float64]) -> bool:
    if not abs(np.linalg.det(world_from_object[:3, :3])) > 0.0:
        return False
    p = transform.transform_points(np.linalg.inv(world_from_object), point)
    if isinstance(geometry, Sphere):
        return bool(np.linalg.norm(p) < geometry.radius)
    return bool((np.abs(p) < np.asarray(geometry.size) / 2.0).all())
