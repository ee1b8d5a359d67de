"""A model's animation, picture by picture.

    limner.write_animation("fox.glb", "walk.webp", animation="Walk", fps=24)
    for image in limner.animate(scene, fps=12, width=320, height=320):
        ...

The k-th picture is of the time start + k / fps, the last one step before the end, so that what comes back to its beginning plays round
without a stop. A scene without a camera is seen by one for the whole clip: the nearest that has everything in its picture at all times
that were looked at.
"""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, UnsupportedError
from ..image.image import Image
from ..linear.project import check_size
from ..progress import OnProgress
from ..scene.camera import Camera
from ..scene.framing import extent_points, framing_camera
from ..scene.pose import animation_of, at
from ..scene.scene import Scene
from .clip import Clip, check_clip
from .play import before_paper, played, written

__all__ = ["animate", "camera_for_all", "frame_times", "write_animation"]

MAX_FRAMES = 100_000
_LOOKS = 24  # moments at which a camera for all is asked to see everything


def animate(
    scene: Any,
    *,
    animation: str | int | None = None,
    fps: float = 24.0,
    start: float | None = None,
    end: float | None = None,
    shutter: float = 0.0,
    width: int = 640,
    height: int = 480,
    camera: Camera | None = None,
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
    **options: Any,
) -> Iterator[Image]:
    """Render an animation, picture by picture.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        As for `limner.render`.
    animation : str | int, optional
        Its name or number; None: the first; "all": all at once.
    fps : float > 0
        Pictures a second of the animation's time.
    start, end : float, optional
        Seconds; None: of the animation.
    shutter : float in [0, 1]
        How much of the time from one picture to the next the shutter is open (`ray`, `path`): what moves is blurred. Film has 0.5.
    width, height : int
    camera : Camera, optional
        None: the scene's own, which the animation may move; or one that frames all that happens.
    on_progress, cancel, **options
        As for `limner.render`: renderer, samples, seed, threads, ….

    Yields
    ------
    Image
        The last may be unfinished: `cancel`, or an interrupt.

    Raises
    ------
    SceneError, UnsupportedError, FileFormatError
        At the call, not at the first picture.
    """
    check_size(width, height)
    if not 0.0 <= shutter <= 1.0:
        raise SceneError(f"shutter must lie in [0, 1], the part of a picture's time that it is open, got {shutter}")
    if shutter and options.get("renderer", "raster") == "raster":
        raise UnsupportedError("raster sees one time only; ray and path can leave the shutter open")
    from ..files.interop import as_scene
    from ..render import Renderer

    scene = scene if isinstance(scene, Scene) else as_scene(scene)
    times = frame_times(scene, animation, fps, start, end)
    if camera is None and scene.camera is None and not scene.cameras():
        camera = camera_for_all(scene, times, animation, width / height)
    renderer = Renderer(scene, width=width, height=height, **options)

    def prepare(index: int) -> Camera | None:
        time = float(times[index])
        if shutter > 0.0:
            renderer.show(shutter=(time, time + shutter / fps), animation=animation)
        else:
            renderer.show(time=time, animation=animation)
        return camera

    return played(renderer, len(times), prepare, "animation", on_progress, cancel)


def write_animation(
    scene: Any,
    path: str | os.PathLike[str],
    *,
    fps: float = 24.0,
    animation: str | int | None = None,
    start: float | None = None,
    end: float | None = None,
    quality: int | None = None,
    view: str = "standard",
    exposure: float = 0.0,
    on_progress: OnProgress | None = None,
    **options: Any,
) -> Clip:
    """Render an animation into a file that plays for ever, or into a folder of pictures.

    Parameters
    ----------
    scene, fps, animation, start, end
        As for `animate`.
    path : str or path-like
        .gif, .webp, .png (animated), .mp4 (needs the extra ``video``); without extension: a folder of PNGs. GIF and MP4 have no
        transparency: there a scene without background stands before white.
    quality : int from 1 to 100, optional
        Of WebP and MP4; None: WebP without loss, MP4 as good as it looks.
    view, exposure
        As for `limner.Image.save`.
    on_progress, **options
        As for `animate`.

    Returns
    -------
    Clip
        `finished` False: stopped by the user. Then there is no file; in a folder, the pictures so far, all of them whole.
    """
    from ..files.interop import as_scene

    scene = scene if isinstance(scene, Scene) else as_scene(scene)
    kind = check_clip(path, n_pictures=len(frame_times(scene, animation, fps, start, end)), fps=fps, quality=quality)
    shown = before_paper(scene, kind, view, exposure)

    def pictures(rendering: OnProgress) -> Iterator[Image]:
        return animate(shown, animation=animation, fps=fps, start=start, end=end, on_progress=rendering, **options)

    return written(pictures, path, "animation", on_progress, fps=fps, quality=quality, view=view, exposure=exposure)


def frame_times(
    scene: Scene, animation: str | int | None, fps: float, start: float | None = None, end: float | None = None
) -> NDArray[np.float64]:
    """When each picture is taken: (n,) float64, seconds.

    Raises SceneError where the scene has no animation and no time is said, or where there would be too many pictures.
    """
    if not (isinstance(fps, (int, float)) and math.isfinite(fps) and fps > 0.0):
        raise SceneError(f"fps must be positive and finite, got {fps!r}")
    found = animation_of(scene, animation)
    if found is None and end is None:
        raise SceneError("the scene has no animation; `limner info` tells what is in it")
    first = float(start) if start is not None else found.start if found is not None else 0.0
    last = float(end) if end is not None else found.end if found is not None else first
    if not (math.isfinite(first) and math.isfinite(last) and first <= last):
        raise SceneError(f"an animation must end after it starts, got {first} to {last}")
    count = max(1, round((last - first) * fps))
    if count > MAX_FRAMES:
        raise SceneError(f"{last - first:g} seconds at {fps:g} pictures a second are {count} pictures, the most is {MAX_FRAMES}")
    return first + np.arange(count) / fps


def camera_for_all(scene: Scene, times: NDArray[np.float64], animation: str | int | None, aspect: float) -> Camera:
    """The nearest camera that sees everything at all of the times, or at some two dozen of them."""
    looks = times[np.unique(np.linspace(0, len(times) - 1, min(len(times), _LOOKS)).astype(np.intp))]
    boxes = []
    for time in looks:
        points = extent_points(at(scene, float(time), animation))
        points = points[np.isfinite(points).all(axis=1)]
        if len(points):
            boxes.append(points)
    return framing_camera(np.concatenate(boxes) if boxes else np.zeros((0, 3)), aspect)
