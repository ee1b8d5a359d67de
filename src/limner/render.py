"""From a scene to pictures: the one door.

    image = limner.render("model.glb", width=800, height=600, renderer="ray")

    with limner.Renderer(scene, width=1280, height=720) as renderer:
        for camera in cameras:
            frame = renderer.render(camera)

What a scene lacks (a camera, light) is added and said; then the scene is flattened to tables, and a renderer exposes a film. A Renderer
keeps what did not change from one picture to the next.
"""

from __future__ import annotations

import os
import threading
import warnings as python_warnings
from collections.abc import Callable, Iterable
from typing import Any

from .errors import LimnerWarning
from .image.image import Image
from .progress import OnProgress
from .renderer.choices import AOVS
from .renderer.frame import Frame
from .renderer.limits import MAX_PIXELS, MAX_SIDE, RENDERERS, check_counts
from .renderer.moment import Moment, checked_moment
from .renderer.renderer import Renderer, as_scene
from .scene.camera import Camera
from .scene.pose import at

__all__ = ["AOVS", "MAX_PIXELS", "MAX_SIDE", "RENDERERS", "Frame", "Renderer", "render"]


def render(
    scene: Any,
    *,
    width: int = 800,
    height: int = 600,
    renderer: str = "raster",
    samples: int | None = None,
    seed: int = 0,
    camera: Camera | None = None,
    max_depth: int = 8,
    shadows: bool | None = None,
    sampler: str | None = None,
    glossy: bool = False,
    emitters: bool = False,
    tinted_shadows: bool | None = None,
    shutter: tuple[float, float] | None = None,
    time: float | None = None,
    animation: str | int | None = None,
    antialiasing: str = "multisample",
    shading: str = "fragment",
    hidden_surfaces: str = "zbuffer",
    clipping: str = "homogeneous",
    culling: str = "material",
    filter: str = "box",
    threads: int | None = None,
    tile_size: int | None = None,
    aovs: Iterable[str] = (),
    denoise: str | None = None,
    default_lights: bool = True,
    noise: float | None = None,
    time_limit: float | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    checkpoint_seconds: float = 60.0,
    resume: bool = False,
    on_snapshot: Callable[[Image], object] | None = None,
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
) -> Image:
    """Make a picture of a scene.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        A path is loaded; "teapot" and "cornell" are built in.
    width, height : int
        Pixels, 1 to 32768 each.
    renderer : "raster" | "ray" | "path" | "lines"
        The graphics pipeline, without reflections; ray tracing with both; or path tracing, with all light that surfaces
        send to each other. Or the outlines and creases alone, black on the background or on white, for which only the picture's size,
        camera and moment count; `limner.drawing` has their styles and vectors.
    samples : int, optional
        Points of every pixel that are looked at; None: 8, or 64 paths.
    seed : int
        For what is drawn by lot; the same seed, the same picture.
    camera : Camera, optional
        In place of the scene's own.
    max_depth : int >= 0
        How often a ray is reflected and refracted (`ray`) or light scattered (`path`) at most.
    shadows : bool, optional
        Whether lights can be hidden (`ray`, `raster`); None: by `ray` they can, by `raster` not, which is faster.
    sampler : "regular" | "random" | "jittered" | "multijittered" | "halton" | "sobol", optional
        Where every pixel's samples look, and how all that is drawn by lot is spread over them: the lens, the time, points of lights,
        reflections (`ray`, `path`). "regular" and the jittered ones divide a pixel into as many cells as there are samples, so square
        numbers suit them. None: a pattern that all pixels share (`raster`, `ray`), and "sobol" for all else.
    glossy : bool
        Whether the rough mirrors of metallic-roughness materials are followed by rays (`ray`), so that they reflect what stands around
        them; otherwise they reflect lights and the blurred sky.
    emitters : bool
        Whether surfaces that shine light others (`ray`). In `path` they do, and area lights do in both.
    tinted_shadows : bool, optional
        Whether light goes straight through glass and water, dimmed and coloured, to what lies behind; otherwise it is stopped there, and
        `path` finds what they focus, by chance. None: in `ray`, where nothing else lights what lies behind, but not in `path`.
    shutter : (float, float), optional
        When it opens and closes: what has a motion is blurred (`ray`, `path`), and so are nodes that an animation moves; meshes that it
        bends are as they are when it opens. None: a picture of one moment.
    time : float, optional
        The moment of the scene's animation that is shown, in seconds. None: of what no animation has moved; motions are at time 0.
    animation : str | int, optional
        The animation that `time` or `shutter` is a time of, by name or number; None: the first; "all": all at once.
    antialiasing : "multisample" | "supersample"
        Whether what covers several samples of a pixel is shaded once, in the middle of them, or every sample for itself (`raster`).
        Edges are the same; supersampling is smoother where shading changes within a pixel, has the very colours of `ray`, and takes as
        many times longer to shade as there are samples.
    shading : "fragment" | "vertex" | "flat"
        Where colours are computed (`raster`): at every fragment, from interpolated normals; at the vertices, and interpolated (Gouraud);
        or once for each triangle, with its own normal.
    hidden_surfaces : "zbuffer" | "painter"
        How `raster` finds what is in front: by a depth for every sample, or by drawing from back to front, in the order of a tree of
        planes that splits what overlaps in a cycle (up to 10,000 triangles; beyond, by their centroids, which a message says).
    clipping : "homogeneous" | "world"
        Whether `raster` clips after the projection, or before it against the planes of the viewing pyramid.
    culling : "material" | "back" | "front" | "none"
        Which triangles `raster` leaves out: the backs of one-sided materials; all backs; all fronts, to look inside; or none.
    filter : "box" | "tent" | "gaussian" | "mitchell" | "lanczos3"
        How the samples around a pixel are weighed (`raster`): alike, within the pixel; or by a wider filter, which wants more samples.
        See `limner.image.reconstruct`.
    threads : int, optional
        None: all cores. The picture does not depend on it, nor on `tile_size`.
    aovs : iterable of str
        What to keep beside the picture, of `AOVS`: from one ray or sample through the centre of each pixel; what is told to denoisers,
        as means over the pixel, and variance and samples of its light (`ray`, `path`); "direct" (light that was scattered at most once)
        and "indirect" (the rest), and "light_groups", a channel ``light_NAME`` for each light, shining material, and the sky (`path`; each
        costs its tracing again).
    denoise : "filter" | "oidn", optional
        How noise is taken out of the finished picture (`ray`, `path`): by our own filter, or by Intel's Open Image Denoise (extra
        ``denoise``); see `limner.image.denoise`. None: not at all.
    default_lights : bool
        Whether a scene without any light gets some.
    noise : float, optional
        Go on in every part of the picture until the error that is left is this share of its brightness, 0.02 for example (`path`);
        `samples` are then the most, 4096 where they are not given. See `limner.budget`.
    time_limit : float, optional
        Stop after so many seconds (`path`). How many samples were taken by then is `image.recipe["samples"]`, and so many of them make the
        same picture again; `samples` are the most, 65536 where they are not given.
    checkpoint : path, optional
        A file in which the sums are kept every `checkpoint_seconds`, in case the process is killed (`path`); it goes when the picture is
        done, and stays where time was up.
    checkpoint_seconds : float
    resume : bool
        Whether to go on from the checkpoint, if it is there; the picture has the bits of one that was never stopped.
    on_snapshot : callable, optional
        Takes the picture so far every `checkpoint_seconds` (`path`).
    on_progress : callable, optional
        Takes a `Progress` now and then.
    cancel : threading.Event, optional
        Set it to stop; the image so far comes back, `finished` False. So does a KeyboardInterrupt.

    Returns
    -------
    Image

    Raises
    ------
    SceneError, UnsupportedError, FileFormatError
        Before anything is drawn.
    """
    if renderer == "lines":
        return _lines(scene, width, height, camera, checked_moment(None, time, animation), on_progress, cancel)
    with Renderer(
        scene, width=width, height=height, renderer=renderer, samples=samples, seed=seed, max_depth=max_depth, shadows=shadows,
        sampler=sampler, glossy=glossy, emitters=emitters, tinted_shadows=tinted_shadows, shutter=shutter,
        time=time, animation=animation, antialiasing=antialiasing, shading=shading, hidden_surfaces=hidden_surfaces, clipping=clipping,
        culling=culling, filter=filter, threads=threads, tile_size=tile_size, aovs=aovs, denoise=denoise,
        default_lights=default_lights,
        noise=noise, time_limit=time_limit, checkpoint=checkpoint, checkpoint_seconds=checkpoint_seconds, resume=resume,
        on_snapshot=on_snapshot,
    ) as once:  # fmt: skip
        image = once.render(camera, on_progress=on_progress, cancel=cancel)
    for slip in once.slips:
        python_warnings.warn(slip, LimnerWarning, stacklevel=2)
    return image


def _lines(
    scene: Any, width: int, height: int, camera: Camera | None, moment: Moment | None,
    on_progress: OnProgress | None, cancel: threading.Event | None,
) -> Image:  # fmt: skip
    """The picture of a drawing."""
    from .artistic.picture import line_picture

    check_counts(width, height, "raster", None, 0, 0, None)
    shown = as_scene(scene)
    if moment is not None:
        shown = at(shown, moment[0] or 0.0, moment[1])
    return line_picture(shown, camera, width=int(width), height=int(height), on_progress=on_progress, cancel=cancel)
