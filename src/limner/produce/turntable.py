"""A model turned once round before the camera.

    limner.write_turntable(scene, "clip.webp", 72, fps=20)
    for image in limner.turntable(scene, 8, width=320, height=320):
        ...

What turns is the camera: every point of the model goes round on a circle before it. One distance serves the whole turn, so that
nothing pumps: the nearest from which all of these circles, not only the points at some azimuths, are in the picture.

            ___
          .     .        r      how far a point is from the axis
    axis  |  +  | point         it sweeps x = r sin t,  c = r cos t for every t
          ' ___ '
             :
          camera

The last picture is one step before the first, so the loop has no seam.
"""

from __future__ import annotations

import dataclasses
import math
import os
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from ..image.image import Image
from ..linear import transform
from ..linear.project import check_size
from ..progress import OnProgress
from ..scene.camera import PerspectiveCamera
from ..scene.environment import Environment
from ..scene.framing import extent_points, with_defaults
from ..scene.node import Node
from ..scene.scene import Scene
from .clip import Clip, check_clip
from .play import before_paper, played, written

__all__ = ["LIGHTS", "nearest_eye", "turntable", "turntable_cameras", "without_lights", "write_turntable"]

LIGHTS = ("auto", "camera", "world")
MAX_FRAMES = 100_000

_MARGIN = 1.08  # of the picture's side to what touches it
_LEAST_DISTANCE = 0.25  # from the eye to what is nearest, in extents

Floats = NDArray[np.float64]


def turntable(
    scene: Any,
    n: int = 72,
    *,
    width: int = 640,
    height: int = 480,
    elevation_degrees: float = 20.0,
    azimuth_degrees: float = 30.0,
    yfov_degrees: float = 30.0,
    lights: str = "auto",
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
    **options: Any,
) -> Iterator[Image]:
    """Render a full turn, picture by picture.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        As for `limner.render`. Its own cameras are not used.
    n : int >= 1
        Pictures, in equal steps; the first would follow the last.
    width, height : int
    elevation_degrees : float in [-90, 90]
        Of the camera above the horizon.
    azimuth_degrees : float
        Of the first picture, from +z towards +x; the others follow in that direction.
    yfov_degrees : float in (0, 180)
        A long lens keeps the model's proportions.
    lights : "auto" | "camera" | "world"
        What shines from where. "auto": a scene without light is lit from the camera, as on a turntable in a studio; lights and
        surroundings of its own stay where they are. "camera": all of them go with the camera, as if the model turned under them.
        "world": all of them stay, the default light where it would be for the first picture.
    on_progress, cancel, **options
        As for `limner.render`: renderer, samples, seed, threads, ….

    Yields
    ------
    Image
        The last may be unfinished: the turn was stopped by `cancel` or an interrupt.

    Raises
    ------
    SceneError, UnsupportedError, FileFormatError
        At the call, not at the first picture.
    """
    if lights not in LIGHTS:
        raise UnsupportedError(f"lights must be one of {', '.join(LIGHTS)}, got {lights!r}")
    check_size(width, height)
    from ..files.interop import as_scene
    from ..render import Renderer

    scene = scene if isinstance(scene, Scene) else as_scene(scene)
    cameras = turntable_cameras(
        scene,
        n,
        aspect=width / height,
        elevation_degrees=elevation_degrees,
        azimuth_degrees=azimuth_degrees,
        yfov_degrees=yfov_degrees,
    )
    if lights == "world":
        scene, _ = with_defaults(scene.replace(camera=cameras[0]), width / height, lights=bool(options.get("default_lights", True)))
    rig = _Rig(scene) if lights == "camera" else None
    renderer = Renderer(scene, width=width, height=height, **options)

    def prepare(index: int) -> PerspectiveCamera:
        if rig is not None:
            renderer.scene = rig.turned(360.0 * index / len(cameras))
        return cameras[index]

    return played(renderer, len(cameras), prepare, "turntable", on_progress, cancel)


def write_turntable(
    scene: Any,
    path: str | os.PathLike[str],
    n: int = 72,
    *,
    fps: float = 20.0,
    quality: int | None = None,
    view: str = "standard",
    exposure: float = 0.0,
    on_progress: OnProgress | None = None,
    **options: Any,
) -> Clip:
    """Render a full turn into a file that plays for ever, or into a folder of pictures.

    Parameters
    ----------
    scene, n
        As for `turntable`.
    path : str or path-like
        .gif, .webp, .png (animated), .mp4 (needs the extra ``video``); without extension: a folder of PNGs. GIF and MP4 have no
        transparency: there a scene without background stands before white.
    fps : float > 0
        Pictures a second; at most 50 in a GIF.
    quality : int from 1 to 100, optional
        Of WebP and MP4; None: WebP without loss, MP4 as good as it looks.
    view, exposure
        As for `limner.Image.save`.
    on_progress : callable, optional
    **options
        As for `turntable`.

    Returns
    -------
    Clip
        `finished` False: stopped by the user. Then there is no file; in a folder, the pictures so far, all of them whole.

    Raises
    ------
    SceneError, UnsupportedError, FileFormatError
        Before anything is drawn.
    RenderError
        The file cannot be written; what was there before is still there.
    """
    kind = check_clip(path, n_pictures=_checked_count(n), fps=fps, quality=quality)
    from ..files.interop import as_scene

    scene = scene if isinstance(scene, Scene) else as_scene(scene)
    shown = before_paper(scene, kind, view, exposure)

    def pictures(rendering: OnProgress) -> Iterator[Image]:
        return turntable(shown, n, on_progress=rendering, **options)

    return written(pictures, path, "turntable", on_progress, fps=fps, quality=quality, view=view, exposure=exposure)


# --- the camera -----------------------------------------------------------------------------------------------------------


def turntable_cameras(
    scene: Scene,
    n: int,
    *,
    aspect: float = 4.0 / 3.0,
    elevation_degrees: float = 20.0,
    azimuth_degrees: float = 30.0,
    yfov_degrees: float = 30.0,
) -> tuple[PerspectiveCamera, ...]:
    """Place `n` cameras round the vertical axis through the scene's middle: the nearest that see all of it all the way round.

    Parameters
    ----------
    scene : Scene
        Its bounded shapes count.
    n : int >= 1
    aspect : float > 0
        Width / height of the pictures.
    elevation_degrees, azimuth_degrees, yfov_degrees
        As for `turntable`.

    Returns
    -------
    tuple of PerspectiveCamera
        They differ by a turn about the axis and in nothing else.
    """
    count = _checked_count(n)
    if not 0.0 < aspect < math.inf:
        raise SceneError(f"aspect must be positive and finite, got {aspect}")
    middle, radius, y = _swept(scene)
    lens = PerspectiveCamera(yfov_degrees=yfov_degrees)
    # `orbit` checks the elevation, and knows what is up at the poles.
    first = PerspectiveCamera.orbit(middle, 1.0, azimuth_degrees, elevation_degrees)
    up, towards = nearest_eye(radius, y, math.radians(float(elevation_degrees)), lens.half_height() / _MARGIN, aspect)
    axes = first.world_from_camera[:3, :3]
    place = np.eye(4)
    place[:3, :3], place[:3, 3] = axes, axes @ np.array([0.0, up, towards])
    return tuple(
        PerspectiveCamera(
            world_from_camera=transform.translate(*middle) @ transform.rotate_y(2.0 * math.pi * k / count) @ place,
            yfov_degrees=lens.yfov_degrees,
            name=f"turntable {k}",
        )
        for k in range(count)
    )


def nearest_eye(radius: ArrayLike, y: ArrayLike, elevation: float, tangent: float, aspect: float) -> tuple[float, float]:
    """Where the eye stands, in its own frame, to see circles about the vertical axis.

    Parameters
    ----------
    radius, y : (m,) float
        Of the circles: their radii, and their heights above the frame's origin, which lies on the axis.
    elevation : float
        Of the eye, radians.
    tangent : float > 0
        Half the picture's height at distance 1.
    aspect : float > 0

    Returns
    -------
    up, towards : float
        The eye's second and third coordinate, the first being 0; the third no nearer to anything than a quarter of the whole.

    Notes
    -----
    A point of a circle has, in the camera's frame at elevation e and with c = r cos t, the coordinates ``x = r sin t``,
    ``y' = y cos e - c sin e``, ``z' = y sin e + c cos e``. It is inside where ``|x| <= (z_e - z') a T`` and
    ``|y' - y_e| <= (z_e - z') T``; the greatest that the left sides ask for over all t follow from ``max (A sin t + B cos t) =
    sqrt(A² + B²)``:

    - ``z_e a T >= y sin e a T + r sqrt(1 + (a T cos e)²)``
    - ``z_e T + y_e >= y (cos e + T sin e) + r |T cos e - sin e|``
    - ``z_e T - y_e >= y (T sin e - cos e) + r |T cos e + sin e|``

    >>> up, towards = nearest_eye([0.0, 0.0], [-1.0, 1.0], 0.0, 1.0, 1.0)
    >>> round(up, 12), round(towards, 12)
    (0.0, 1.0)
    """
    r, height = np.asarray(radius, dtype=np.float64), np.asarray(y, dtype=np.float64)
    sine, cosine, tangent_x = math.sin(elevation), math.cos(elevation), tangent * aspect
    across = float((height * sine * tangent_x + r * math.hypot(1.0, tangent_x * cosine)).max()) / tangent_x
    above = float((height * (cosine + tangent * sine) + r * abs(tangent * cosine - sine)).max())
    below = float((height * (tangent * sine - cosine) + r * abs(tangent * cosine + sine)).max())
    extent = math.hypot(2.0 * float(r.max()), float(np.ptp(height)))
    least = float((height * sine + r * abs(cosine)).max()) + _LEAST_DISTANCE * extent
    return (above - below) / 2.0, max(across, (above + below) / (2.0 * tangent), least)


def _swept(scene: Scene) -> tuple[Floats, Floats, Floats]:
    """The middle of what is there, and of every point its distance from the vertical axis through it and its height above it."""
    points = extent_points(scene)
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return np.zeros(3), np.array([0.5]), np.array([0.0])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    points -= middle
    radius, y = np.hypot(points[:, 0], points[:, 2]), points[:, 1]
    extent = max(float(radius.max()), float(y.max()))
    # Below float32's resolution at this place there is nothing to see from nearer.
    if not extent > 1e-6 * float(np.abs(middle).max()):
        return middle, np.array([0.5]), np.array([0.0])
    return middle, radius, y


def _checked_count(n: Any) -> int:
    if isinstance(n, bool) or not hasattr(n, "__index__") or not 1 <= n <= MAX_FRAMES:
        raise SceneError(f"the number of pictures must be an integer from 1 to {MAX_FRAMES}, got {n!r}")
    return int(n)


# --- lights that go with the camera ---------------------------------------------------------------------------------------


class _Rig:
    """Everything that gives light, taken off the scene to be turned about the axis; what is lit stays, so that its tables are kept."""

    def __init__(self, scene: Scene) -> None:
        self._middle, _, _ = _swept(scene)
        self._scene = scene.replace(environment=_in_memory(scene.environment))
        self._unlit = without_lights(scene.root)
        self._lights = [(light, placed.world_from_object) for placed, light in scene.lights()]

    def turned(self, degrees: float) -> Scene:
        """The scene with its lights turned by so much about the vertical axis, as the camera is."""
        x, _, z = self._middle
        turn = transform.translate(x, 0.0, z) @ transform.rotate_y(math.radians(degrees)) @ transform.translate(-x, 0.0, -z)
        nodes = tuple(Node(light.name, turn @ place, lights=(light,)) for light, place in self._lights)
        environment = self._scene.environment
        if environment is not None:
            environment = dataclasses.replace(environment, rotation_degrees=environment.rotation_degrees + degrees)
        return self._scene.replace(root=Node(self._unlit.name, children=(self._unlit, *nodes)), environment=environment)


def without_lights(node: Node) -> Node:
    """The same graph with nothing that shines but surfaces; what has no light in it is the same node."""
    children = []
    for child in node.children:  # a comprehension's own frame would halve the depth of the graphs that fit on the stack
        children.append(without_lights(child))
    same = not node.lights and all(a is b for a, b in zip(children, node.children, strict=True))
    return node if same else dataclasses.replace(node, lights=(), children=tuple(children))


def _in_memory(environment: Environment | None) -> Environment | None:
    """The same surroundings, read once for all pictures."""
    if environment is None or not isinstance(environment.source, str):
        return environment
    from ..files.radiance import read_radiance

    return dataclasses.replace(environment, source=read_radiance(environment.source))
