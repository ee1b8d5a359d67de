"""Data sets: one scene from many cameras, with everything that a trainer or a reconstruction asks of each view.

    cameras = limner.dataset.orbit_cameras(scene, 36, elevation_degrees=25)
    limner.dataset.write(scene, cameras, "views", width=640, height=480, aovs=("depth", "normal"), masks="instance")

    views/
        cameras.json           K, world_to_camera, camera_to_world, size and files of every view; the names of ids; the recipe
        annotations.json       the instances in every view as COCO has them: box, area, run lengths
        images/000000.png      the picture
        arrays/000000.npz      depth, normal, instance_id, …: as in `Image.aov`, exact
        masks/000000.png       16 bits: 0 nothing, else 1 + id

Every file is written under another name and moved into place when it is whole, and `cameras.json` lists what is finished and nothing
else, so an interrupt leaves a smaller data set, not a broken one; ``resume=True`` goes on with it. The same call writes the same bytes.
"""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, UnsupportedError
from ..linear.project import check_size
from ..progress import Meter, OnProgress, Progress
from ..scene.camera import Camera, PerspectiveCamera
from ..scene.framing import extent_points, with_defaults
from ..scene.scene import Scene
from .folder import LISTING, check_folder, json_bytes, make_folders, mask_png, npz_bytes, put
from .listing import SeenIds, coco_annotations, head, view
from .masks import channel, mask_from_counts, masks

__all__ = ["Written", "mask_from_counts", "masks", "orbit_cameras", "write"]

_MARGIN = 1.08  # of the picture's side to what touches it
_MAX_MASK_ID = 65534  # 0 is for nothing


@dataclass(frozen=True)
class Written:
    """What became of a data set.

    Parameters
    ----------
    folder : Path
    n_views : int
        That are whole in the folder.
    n_rendered : int
        Of these, that were rendered now.
    finished : bool
        False: stopped by the user; what is there is a data set, but not all of it.
    warnings : tuple of str
        Likely slips, each once.
    """

    folder: Path
    n_views: int
    n_rendered: int
    finished: bool
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Order:
    """What is asked of every view."""

    folder: Path
    width: int
    height: int
    aovs: tuple[str, ...]
    masks: str | None
    annotations: str | None
    options: dict[str, Any]

    def channels(self) -> tuple[str, ...]:
        """The AOVs to render: those to keep, and those that masks and annotations are made of."""
        kinds = {kind for kind in (self.masks, self.annotations) if kind is not None}
        needed = [channel(kind) for kind in sorted(kinds)] + (["instance_id"] if self.annotations else [])
        return tuple(dict.fromkeys((*self.aovs, *needed)))

    def files(self, index: int) -> dict[str, str]:
        """The files of a view by what they hold, relative to the folder; the picture is written last."""
        stem = f"{index:06d}"
        made = {"arrays": f"arrays/{stem}.npz"} if self.channels() else {}
        if self.masks is not None:
            made["mask"] = f"masks/{stem}.png"
        return {**made, "image": f"images/{stem}.png"}


def write(
    scene: Scene,
    cameras: Iterable[Camera],
    folder: str | os.PathLike[str],
    *,
    width: int = 640,
    height: int = 480,
    renderer: str = "raster",
    samples: int | None = None,
    seed: int = 0,
    aovs: Iterable[str] = ("depth", "normal", "instance_id"),
    masks: str | None = None,
    annotations: str | None = "instance",
    resume: bool = False,
    threads: int | None = None,
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
    **options: Any,
) -> Written:
    """Render a scene from every camera into a folder.

    Parameters
    ----------
    scene : Scene
        Where it has no light, light is added once, for the first camera: it stays while the camera moves.
    cameras : iterable of Camera
        At least one.
    folder : path
        Is made where it is not there; one that holds a data set already is refused, unless `resume` goes on with it.
    width, height, renderer, samples, seed, threads, **options
        As for `limner.render`; the options are max_depth, shadows, tile_size and default_lights.
    aovs : iterable of str
        What to keep beside each picture, in ``arrays/*.npz``.
    masks : "instance" | "material", optional
        Write ``masks/*.png``, 16 bits: 0 for nothing, else 1 + id.
    annotations : "instance" | "material" | None
        Write ``annotations.json``: one annotation for every instance that is seen, its category the name of the instance; or one for
        every material on it, its category the name of the material.
    resume : bool
        Keep the views that are there. The folder must have been begun with the same cameras, sizes and options; whether the scene is
        the same is for the caller to know.
    on_progress : callable, optional
        Takes a `Progress` now and then.
    cancel : threading.Event, optional
        Set it to stop. So does a KeyboardInterrupt.

    Returns
    -------
    Written

    Raises
    ------
    SceneError, UnsupportedError
        Before anything is written.
    RenderError
        A file cannot be written.
    """
    if not isinstance(scene, Scene):
        raise SceneError(f"scene must be a Scene, as limner.load gives it, got {type(scene).__name__}")
    check_size(width, height)
    views = _checked_cameras(cameras)
    recipe = {"renderer": renderer, "samples": samples, "seed": seed, **options}
    order = _Order(Path(folder), width, height, _checked_aovs(aovs), masks, annotations, {**recipe, "threads": threads})
    work = _Work(order, scene, views, recipe)
    check_folder(order.folder, work.head["plan"], resume)
    return work.run(resume, on_progress, cancel)


def _checked_cameras(cameras: Iterable[Camera]) -> tuple[Camera, ...]:
    views = (cameras,) if isinstance(cameras, Camera) else tuple(cameras)
    if not views:
        raise SceneError("a data set needs at least one camera")
    for index, camera in enumerate(views):
        if not isinstance(camera, Camera):
            raise SceneError(f"cameras[{index}] must be a Camera, got {type(camera).__name__}")
    return views


def _checked_aovs(aovs: Iterable[str]) -> tuple[str, ...]:
    from ..aov import CHANNELS

    wanted = (aovs,) if isinstance(aovs, str) else tuple(dict.fromkeys(aovs))
    for name in wanted:
        if name not in CHANNELS:
            raise UnsupportedError(f"aov must be one of {', '.join(CHANNELS)}, got {name!r}")
    return wanted


class _Work:
    """One data set on its way into its folder."""

    def __init__(self, order: _Order, scene: Scene, cameras: Sequence[Camera], recipe: dict[str, Any]) -> None:
        from ..render import Renderer

        self._order, self._cameras = order, cameras
        lights = bool(order.options.get("default_lights", True))
        self._scene, said = with_defaults(scene.replace(camera=cameras[0]), order.width / order.height, lights=lights)
        self._renderer = Renderer(self._scene, width=order.width, height=order.height, aovs=order.channels(), **order.options)
        self._warnings = dict.fromkeys(said)
        self._done: list[int] = []
        self.head = self._planned(recipe)

    def _planned(self, recipe: dict[str, Any]) -> dict[str, Any]:
        from .. import __version__
        from ..tables.build import names

        order, id_names = self._order, names(self._scene)
        if order.masks is not None and len(id_names[channel(order.masks)]) > _MAX_MASK_ID:
            instead = f"keep {channel(order.masks)!r} in aovs instead"
            raise UnsupportedError(f"masks of 16 bits hold at most {_MAX_MASK_ID} ids: {instead}")
        whole = {**recipe, "width": order.width, "height": order.height, "aovs": order.channels(), "limner": __version__}
        whole |= {"masks": order.masks, "annotations": order.annotations}
        return head(whole, id_names, [self._view(index) for index in range(len(self._cameras))])

    def _view(self, index: int) -> dict[str, Any]:
        order = self._order
        return view(self._cameras[index], index, order.width, order.height, order.files(index))

    def run(self, resume: bool, on_progress: OnProgress | None, cancel: threading.Event | None) -> Written:
        """Render what is missing, one view after the other, and list what is there, whatever happens."""
        meter = Meter(on_progress, "dataset")
        n_rendered, n = 0, len(self._cameras)
        try:
            for index in range(n):
                meter.report(index / n)
                if cancel is not None and cancel.is_set():
                    break
                if not (resume and self._is_whole(index)):
                    if not self._render(index, meter, cancel):
                        break
                    n_rendered += 1
                self._done.append(index)
        except KeyboardInterrupt:  # what is done is kept; `finished` tells
            pass
        finally:
            if self._done:
                self._list()
        finished = len(self._done) == n
        if finished:
            meter.report(1.0)
        return Written(self._order.folder, len(self._done), n_rendered, finished, tuple(self._warnings))

    def _is_whole(self, index: int) -> bool:
        """Files come whole or not at all, so one that is there is finished."""
        return all((self._order.folder / name).is_file() for name in self._order.files(index).values())

    def _render(self, index: int, meter: Meter, cancel: threading.Event | None) -> bool:
        """Make the files of a view; False where it was stopped before."""
        order, n = self._order, len(self._cameras)

        def on_progress(progress: Progress) -> None:
            meter.report(min((index + progress.done) / n, 1.0 - 1e-9))

        image = self._renderer.render(self._cameras[index], on_progress=on_progress, cancel=cancel)
        if not image.finished:
            return False
        self._warnings.update(dict.fromkeys(image.warnings))
        files = order.files(index)
        if not (order.folder / LISTING).is_file():
            make_folders(order.folder, files.values())
            put(order.folder / LISTING, json_bytes({**self.head, "views": []}))
        if "arrays" in files:
            put(order.folder / files["arrays"], npz_bytes(image.aov))
        if order.masks is not None:
            put(order.folder / files["mask"], mask_png(image.aov[channel(order.masks)]))
        image.save(order.folder / files["image"])
        return True

    def _list(self) -> None:
        """Write what is finished into `annotations.json` and `cameras.json`."""
        folder, by = self._order.folder, self._order.annotations
        if by is not None:
            told = coco_annotations(by, self.head["id_names"][channel(by)], self._seen(by))
            put(folder / "annotations.json", json_bytes(told))
        put(folder / LISTING, json_bytes({**self.head, "views": [self._view(index) for index in self._done]}))

    def _seen(self, by: str) -> Iterator[SeenIds]:
        for index in self._done:
            files = self._order.files(index)
            with np.load(self._order.folder / files["arrays"]) as arrays:
                yield SeenIds(index + 1, files["image"], arrays["instance_id"], arrays[channel(by)])


# --- cameras --------------------------------------------------------------------------------------------------------------


def orbit_cameras(
    scene: Scene,
    n: int,
    *,
    elevation_degrees: float = 20.0,
    azimuth_degrees: float = 0.0,
    yfov_degrees: float = 40.0,
    aspect: float = 4.0 / 3.0,
    distance: float | None = None,
) -> tuple[PerspectiveCamera, ...]:
    """Stand around a scene: `n` cameras in equal steps of a full turn, all at one distance, all of them seeing everything.

    Parameters
    ----------
    scene : Scene
        Its bounded shapes count.
    n : int >= 1
    elevation_degrees : float in [-90, 90]
        Above the horizon.
    azimuth_degrees : float
        Of the first, from +z towards +x; the others follow in that direction.
    yfov_degrees : float in (0, 180)
    aspect : float > 0
        Width / height of the pictures.
    distance : float > 0, optional
        From the middle; None: as near as the sphere round everything stays in the picture, with 8 % to spare.

    Returns
    -------
    tuple of PerspectiveCamera
    """
    if not isinstance(n, (int, np.integer)) or n < 1:
        raise SceneError(f"the number of cameras must be an integer of at least 1, got {n!r}")
    if not 0.0 < aspect < math.inf:
        raise SceneError(f"aspect must be positive and finite, got {aspect}")
    first = PerspectiveCamera(yfov_degrees=yfov_degrees)
    middle, radius = _ball(scene)
    if distance is None:
        tangent = first.half_height() * min(aspect, 1.0) / _MARGIN
        distance = radius * math.hypot(1.0, 1.0 / tangent)
    return tuple(
        PerspectiveCamera.orbit(
            middle, distance, azimuth_degrees + 360.0 * k / n, elevation_degrees, yfov_degrees=yfov_degrees, name=f"orbit {k}"
        )
        for k in range(n)
    )


def _ball(scene: Scene) -> tuple[NDArray[np.float64], float]:
    """Middle and radius of a sphere that holds every bounded shape; the unit sphere where there is none."""
    points = extent_points(scene)
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return np.zeros(3), 1.0
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    return middle, float(np.linalg.norm(points - middle, axis=1).max()) or 1.0
