"""Making a picture again from the recipe that travels in its file, and saying whether the bits agree.

    found = limner.produce.again.verify("picture.png")
    found.agrees, found.reasons

A recipe holds the renderer, its settings, the camera and a digest of the scene. Pictures that the command line made also say where
their model is, as seen from the picture's own folder; for others the model has to be given.
"""

from __future__ import annotations

import dataclasses
import inspect
import os
from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..errors import SceneError, UnsupportedError
from ..image.image import Image
from ..scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from ..scene.environment import Environment
from ..scene.library import BUILTINS, builtin
from ..scene.scene import Scene

if TYPE_CHECKING:
    from ..progress import OnProgress

__all__ = ["Verdict", "camera_from_recipe", "moved", "origin", "render_again", "scene_from_recipe", "verify"]

_NOT_SETTINGS = ("camera", "scene", "threads", "tile_size", "aovs", "on_progress", "cancel", "on_snapshot")


class Verdict(NamedTuple):
    """Whether a picture could be made again.

    agrees : bool
        Every stored value is the same.
    n_different : int
        Pixels that are not.
    max_difference : float
        Of linear light, or of alpha.
    reasons : tuple of str
        What else is not as it was: the scene, the version.
    """

    agrees: bool
    n_different: int
    max_difference: float
    reasons: tuple[str, ...]


def origin(model: str, output: str, *, environment: str | None, ground: bool, background: Any) -> dict[str, Any]:
    """Say, for a recipe, where a scene came from and what was done to it; files as seen from the folder of `output`.

    >>> origin("teapot", "pictures/a.png", environment=None, ground=True, background=None)
    {'model': 'teapot', 'ground': True}
    """
    folder = Path.cwd() if output == "-" else Path(output).absolute().parent
    told: dict[str, Any] = {"model": model if model in BUILTINS else _as_seen_from(folder, model)}
    if environment is not None:
        told["environment"] = _as_seen_from(folder, environment)
    if ground:
        told["ground"] = True
    if background is not None:
        told["background"] = background if isinstance(background, str) else list(background)
    return told


def moved(recipe: Mapping[str, Any], source: str | os.PathLike[str], output: str | os.PathLike[str]) -> dict[str, Any]:
    """The recipe of a picture that is written again elsewhere: the same files, as seen from the folder of `output`.

    >>> moved({"model": "./car.glb", "seed": 1}, "models/a.png", "pictures/a.jpg")
    {'model': '../models/car.glb', 'seed': 1}
    """
    before, after = Path(source).absolute().parent, Path(output).absolute().parent

    def seen(value: Any) -> Any:
        is_relative = isinstance(value, str) and value.startswith(("./", "../"))
        return _as_seen_from(after, os.path.normpath(before / value)) if is_relative else value

    return {key: seen(value) if key in ("model", "environment") else value for key, value in recipe.items()}


def verify(
    path: str | os.PathLike[str], model: str | None = None, *, threads: int | None = None, on_progress: OnProgress | None = None
) -> Verdict:
    """Render a picture again and compare it with what is stored.

    Parameters
    ----------
    path : str or path-like
        A picture that limner saved.
    model : str, optional
        The model's file, or a built-in scene, in place of what the recipe says.
    threads : int, optional
    on_progress : callable, optional

    Raises
    ------
    SceneError
        There is no recipe in the file, it was stopped before it was finished, or its model is not to be found.
    """
    from .. import __version__
    from ..files.open_image import open_image

    stored = open_image(path)
    recipe = stored.recipe
    if "renderer" not in recipe or "camera" not in recipe:
        raise SceneError(f"{os.fspath(path)} holds no recipe of limner's: it cannot be made again")
    if recipe.get("finished") is False:
        raise SceneError(f"{os.fspath(path)} was stopped before it was finished: only finished pictures can be made again")
    made = render_again(recipe, Path(path).absolute().parent, model, threads=threads, on_progress=on_progress)
    reasons = []
    if recipe.get("scene") != made.recipe["scene"]:
        reasons.append("the scene is not the one that the picture was made of (its digest differs)")
    if recipe.get("limner") != __version__:
        reasons.append(f"the picture was made by limner {recipe.get('limner', '?')}, this is {__version__}")
    again = _as_stored(made, Path(path).suffix, recipe.get("saved", {}))
    if again.pixels.shape != stored.pixels.shape:
        size = f"{stored.width} x {stored.height}"
        reasons.append(f"the picture has {size} pixels, its recipe makes {again.width} x {again.height}: it was resized since")
        return Verdict(False, max(stored.width * stored.height, again.width * again.height), float("inf"), tuple(reasons))
    # Bits, not values: -0 is not 0, and no number is itself.
    differs = (stored.pixels.view(np.uint32) != again.pixels.view(np.uint32)).any(axis=2)
    with np.errstate(invalid="ignore"):
        furthest = float(np.nanmax(np.abs(stored.pixels.astype(np.float64) - again.pixels), initial=0.0))
    return Verdict(not differs.any(), int(differs.sum()), furthest, tuple(reasons))


def render_again(
    recipe: Mapping[str, Any],
    folder: str | os.PathLike[str] = ".",
    model: str | None = None,
    *,
    threads: int | None = None,
    on_progress: OnProgress | None = None,
) -> Image:
    """Make the picture of a recipe; files that it names are looked for from `folder`."""
    from ..render import render

    known = [name for name in inspect.signature(render).parameters if name not in _NOT_SETTINGS]
    settings = {name: recipe[name] for name in known if name in recipe}
    scene = scene_from_recipe(recipe, folder, model)
    camera = camera_from_recipe(recipe["camera"])
    try:
        return render(scene, camera=camera, threads=threads, on_progress=on_progress, **settings)
    except TypeError as error:
        raise SceneError(f"the recipe cannot be followed: {error}") from None


def scene_from_recipe(recipe: Mapping[str, Any], folder: str | os.PathLike[str] = ".", model: str | None = None) -> Scene:
    """Read the model of a recipe and do to it what was done; SceneError where the model is not known or not there."""
    from ..files.load import load

    if model is None:
        told = recipe.get("model")
        if not isinstance(told, str):
            raise SceneError("the recipe does not say of what model the picture is: name it")
        scene = builtin(told) if told in BUILTINS else load(_found(told, Path(folder), "model"))
    else:
        scene = builtin(model) if model in BUILTINS else load(model)
    if isinstance(recipe.get("environment"), str):
        scene = scene.replace(environment=Environment(str(_found(recipe["environment"], Path(folder), "environment"))))
    if recipe.get("background") is not None:
        scene = scene.replace(background=None if recipe["background"] == "transparent" else _background(recipe["background"]))
    return scene.with_ground() if recipe.get("ground") else scene


def camera_from_recipe(told: Any) -> Camera:
    """The camera whose fields a recipe holds; SceneError where it is none."""
    for kind in (PerspectiveCamera, OrthographicCamera):
        if isinstance(told, Mapping) and set(told) <= {field.name for field in dataclasses.fields(kind)}:
            return kind(**told)
    raise SceneError("the recipe's camera is of no kind that this version knows")


def _background(told: Any) -> Any:
    return tuple(told) if isinstance(told, list) else told


def _as_seen_from(folder: Path, name: str) -> str:
    """A file's path from a folder, with slashes; absolute where there is none (another drive)."""
    target = Path(name).absolute()
    try:
        relative = PurePath(os.path.relpath(target, folder)).as_posix()
    except ValueError:
        return target.as_posix()
    return relative if relative.startswith("../") else f"./{relative}"


def _found(name: str, folder: Path, what: str) -> Path:
    """A file that a recipe names: from the picture's folder, else from the current one."""
    for place in (folder / name, Path(name)):
        if place.exists():
            return place
    raise SceneError(f"the {what} {name!r} that the recipe names is not there, seen from {folder}: name it")


def _as_stored(made: Image, extension: str, saved: Mapping[str, Any]) -> Image:
    """The picture as it comes back from a file of the same kind: with its rounding, and its loss if it has any."""
    import tempfile

    from ..files.open_image import open_image

    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / f"again{extension}"
        try:
            made.save(place, **saved)
        except (TypeError, UnsupportedError) as error:
            raise SceneError(f"the recipe does not say how the picture was saved: {error}") from None
        return open_image(place)
