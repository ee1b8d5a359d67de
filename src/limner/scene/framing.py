"""A camera that frames everything, and a pleasant light, for scenes that come without.

The camera stands where a photographer would stand first: a little to the side, a little above, just far enough that everything
is in the picture, and in its middle. The lights move with it: a key over its left shoulder, a weak fill from the right, and ambient
light for what neither reaches.

             key
               \\
        fill -- (o) bounds
               /
          camera
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from ..linear import transform
from ..mesh.mesh import Mesh
from .camera import Camera, PerspectiveCamera
from .light import AmbientLight, DirectionalLight, Light
from .node import Node
from .scene import Scene
from .shape import Box, Sphere

__all__ = ["default_lights", "extent_points", "framing_camera", "with_defaults"]

Matrix = NDArray[np.float64]

_MARGIN = 1.08  # of the picture's side to what touches it
_LEAST_DISTANCE = 0.25  # from the eye to what is nearest, in extents
_MAX_POINTS = 1 << 21  # beyond so many vertices, boxes stand for the shapes

# Directions towards the lights in the camera's frame: x right, y up, z back to the eye.
_TOWARDS_KEY = (-0.45, 0.65, 0.8)
_TOWARDS_FILL = (0.85, 0.1, 0.6)
# Radiance of a white matte surface that faces the key: all in all, and the shares of ambient and of a fill that it would face.
_WHITE = 0.9
_AMBIENT = 0.12
_FILL = 0.2


def _ball(bounds: ArrayLike) -> tuple[Matrix, float]:
    """Centre and radius of the sphere around the bounds; the unit sphere where they hold nothing, radius 1 round a point."""
    box = np.asarray(bounds, dtype=np.float64)
    if box.shape != (2, 3):
        raise SceneError(f"bounds must have shape (2, 3), got {box.shape}")
    if not (np.isfinite(box).all() and (box[0] <= box[1]).all()):
        return np.zeros(3), 1.0
    center = box[0] + (box[1] - box[0]) / 2.0
    radius = float(np.linalg.norm((box[1] - box[0]) / 2.0))
    # Below float32's resolution at this place there is nothing to see from nearer.
    return center, radius if radius > 1e-6 * float(np.abs(center).max()) and radius > 0.0 else 1.0


def framing_camera(
    points: ArrayLike,
    aspect: float,
    *,
    yfov_degrees: float = 40.0,
    azimuth_degrees: float = 30.0,
    elevation_degrees: float = 20.0,
) -> PerspectiveCamera:
    """Place the nearest camera of a given direction that has all points in its picture, with 8 % to spare.

    Parameters
    ----------
    points : (n, 3) float
        World space; what is not finite does not count. Where there is nothing, the unit cube round the origin; where all points
        coincide, a unit cube round them.
    aspect : float > 0
        Width / height of the picture.
    yfov_degrees : float in (0, 180)
        Vertical field of view.
    azimuth_degrees : float
        From +z towards +x.
    elevation_degrees : float in (-90, 90)
        Above the horizon.

    Returns
    -------
    PerspectiveCamera
        Near and far are left to the scene's bounds.

    Notes
    -----
    With x along the picture and z towards the eye, a point is inside where ``|x - x_e| <= (z_e - z) tan``. The two sides give
    ``x_e + z_e tan >= max(x + z tan)`` and ``z_e tan - x_e >= max(z tan - x)``, whose solution with equality is the nearest eye, in
    the middle; the same upwards, and the farther of both, but no nearer to anything than a quarter of the whole.

    Examples
    --------
    >>> camera = framing_camera([[-1, -1, 0], [1, 1, 0]], 1.0, yfov_degrees=90, azimuth_degrees=0, elevation_degrees=0)
    >>> camera.world_from_camera[:3, 3].round(3).tolist()
    [0.0, 0.0, 1.08]
    """
    if not 0.0 < aspect < math.inf:
        raise SceneError(f"aspect must be positive and finite, got {aspect}")
    if not 0.0 < yfov_degrees < 180.0:
        raise SceneError(f"camera.yfov_degrees must lie between 0 and 180, got {yfov_degrees}")
    if not -90.0 < elevation_degrees < 90.0:
        raise SceneError(f"elevation_degrees must lie between -90 and 90, got {elevation_degrees}")
    azimuth, elevation = math.radians(azimuth_degrees), math.radians(elevation_degrees)
    outwards = np.array([math.sin(azimuth) * math.cos(elevation), math.sin(elevation), math.cos(azimuth) * math.cos(elevation)])
    axes = transform.frame_from_gaze((0.0, 0.0, 0.0), -outwards, (0.0, 1.0, 0.0))[:3, :3]
    shown = _with_extent(points)
    x, y, z = axes.T @ shown.T
    tan_y = math.tan(math.radians(yfov_degrees) / 2.0) / _MARGIN
    across = _nearest_eye(x, z, tan_y * aspect)
    upwards = _nearest_eye(y, z, tan_y)
    # What is thin along the gaze would be met with the nose on its tip.
    least = float(z.max()) + _LEAST_DISTANCE * float(np.linalg.norm(np.ptp(shown, axis=0)))
    eye = axes @ np.array([across[0], upwards[0], max(across[1], upwards[1], least)])
    return PerspectiveCamera(
        world_from_camera=transform.frame_from_gaze(eye, -outwards, (0.0, 1.0, 0.0)), yfov_degrees=yfov_degrees, name="framing camera"
    )


def _nearest_eye(x: Matrix, z: Matrix, tangent: float) -> tuple[float, float]:
    """(x, z) of the nearest eye between two sides of a picture."""
    right, left = float((x + z * tangent).max()), float((z * tangent - x).max())
    return (right - left) / 2.0, (right + left) / (2.0 * tangent)


def _with_extent(points: ArrayLike) -> Matrix:
    """Finite points that are not all in one place."""
    given = np.asarray(points, dtype=np.float64)
    if given.ndim != 2 or given.shape[1] != 3:
        raise SceneError(f"points must have shape (n, 3), got {given.shape}")
    given = given[np.isfinite(given).all(axis=1)]
    if not len(given):
        return _CUBE
    low, high = given.min(axis=0), given.max(axis=0)
    # Below float32's resolution at this place there is nothing to see from nearer.
    extent = float(np.linalg.norm(high - low))
    return given if extent > 1e-6 * float(np.abs(given).max()) and extent > 0.0 else low + _CUBE


_CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def extent_points(scene: Scene) -> Matrix:
    """(n, 3) float64: points in the world whose hull holds every bounded shape of the scene, tightly where that is cheap."""
    shapes = scene.shapes()
    n_vertices = sum(len(shape.geometry.positions) for _, shape in shapes if isinstance(shape.geometry, Mesh))
    found = [np.zeros((0, 3))]
    for placed, shape in shapes:
        geometry = shape.geometry
        if shape.displacement is not None:
            low, high = geometry.bounds + np.array([[-shape.displacement.reach], [shape.displacement.reach]])
            local = low + (high - low) * (_CUBE + 0.5)
        elif isinstance(geometry, Mesh) and n_vertices <= _MAX_POINTS:
            local = np.asarray(geometry.positions, dtype=np.float64)
            if len(geometry.triangles) < len(local):
                local = local[np.unique(geometry.triangles)]
        elif isinstance(geometry, Sphere):
            local = geometry.radius * _SPHERE
        elif isinstance(geometry, Box):
            local = np.asarray(geometry.size) * _CUBE
        elif isinstance(geometry, Mesh):
            low, high = geometry.bounds
            local = low + (high - low) * (_CUBE + 0.5)
        else:
            local = geometry.hull
        found.append(transform.transform_points(placed.world_from_object, local))
    return np.concatenate(found)


def _around_a_sphere(n: int) -> Matrix:
    """Points just off the unit sphere whose hull holds it."""
    polar, azimuth = np.meshgrid(np.pi * np.arange(n + 1) / n, np.pi * np.arange(2 * n) / n)
    points = np.stack([np.sin(polar) * np.cos(azimuth), np.cos(polar), np.sin(polar) * np.sin(azimuth)], axis=-1)
    return points.reshape(-1, 3) / math.cos(np.pi / n)


_SPHERE = _around_a_sphere(16)


def default_lights(camera: Camera, bounds: ArrayLike) -> tuple[tuple[Light, Matrix], ...]:
    """Light what a camera sees: a key over its left shoulder, a fill from its right, and ambient light.

    Parameters
    ----------
    camera : Camera
        World space.
    bounds : (2, 3) float
        What is to be lit; the lights' nodes stand around it, though only their direction counts.

    Returns
    -------
    tuple of (light, world_from_light)
        A white Lambert surface that faces the key has radiance 0.9.
    """
    center, radius = _ball(bounds)
    axes = np.asarray(camera.world_from_camera, dtype=np.float64)[:3, :3]
    axes = axes / np.linalg.norm(axes, axis=0)
    key, fill = (np.array(d) / np.linalg.norm(d) for d in (_TOWARDS_KEY, _TOWARDS_FILL))
    key_share = _WHITE - _AMBIENT - _FILL * max(0.0, float(key @ fill))
    lights: list[tuple[Light, Matrix]] = []
    for name, towards, share in (("key light", key, key_share), ("fill light", fill, _FILL)):
        direction = axes @ towards
        frame = transform.frame_from_gaze(center + 2.0 * radius * direction, -direction, axes[:, 1])
        lights.append((DirectionalLight(intensity=math.pi * share, name=name), frame))
    lights.append((AmbientLight(intensity=_AMBIENT, name="ambient light"), transform.translate(*center)))
    return tuple(lights)


def with_defaults(scene: Scene, aspect: float, *, lights: bool = True) -> tuple[Scene, tuple[str, ...]]:
    """Give a scene the camera and the lights that it lacks.

    Parameters
    ----------
    scene : Scene
    aspect : float > 0
        Width / height of the picture.
    lights : bool
        Whether light is added where there is none.

    Returns
    -------
    scene : Scene
        Its `camera` is set: its own, else the first of the graph, else one that frames everything. Where the graph has no
        visible light, key, fill and ambient light stand at its end, so that the ids of what it shows stay.
    messages : tuple of str
        What was added, a sentence each; empty where nothing was.
    """
    messages = []
    camera = scene.camera
    if camera is None:
        camera = next(iter(scene.cameras()), None)
    if camera is None:
        camera = framing_camera(extent_points(scene), aspect)
        eye = ", ".join(f"{x:.4g}" for x in camera.world_from_camera[:3, 3])
        messages.append(f"the scene has no camera: added one that frames everything, from ({eye})")
    root = scene.root
    if lights and not scene.lights() and scene.environment is None:
        root = _with_lights(root, default_lights(camera, scene.bounds()))
        messages.append("the scene has no light: added a key, a fill and an ambient light")
    if not messages and camera is scene.camera:
        return scene, ()
    return scene.replace(camera=camera, root=root), tuple(messages)


def _with_lights(root: Node, lights: tuple[tuple[Light, Matrix], ...]) -> Node:
    determinant = float(np.linalg.det(root.parent_from_node[:3, :3]))
    if not root.visible or not abs(determinant) > 1e-12:
        # What hides or flattens the scene must not do it to the lights.
        root = Node(children=(root,))
    node_from_world = np.linalg.inv(root.parent_from_node)
    added = tuple(
        Node(name=light.name, parent_from_node=_affine(node_from_world @ frame), lights=(light,)) for light, frame in lights
    )
    return dataclasses.replace(root, children=(*root.children, *added))


def _affine(matrix: Matrix) -> Matrix:
    matrix[3] = (0.0, 0.0, 0.0, 1.0)
    return matrix
