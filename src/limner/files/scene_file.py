"""limner's own scene files: everything that a scene can hold, in words, and how its picture is made (FoCG 12.2).

    limner: 1
    settings: {renderer: ray, width: 800, height: 500}
    camera: {perspective: {place: {look_at: {eye: [4, 3, 6], target: [0, 1, 0]}}, yfov_degrees: 30}}
    materials:
      clay: {lambert: {color: [0.7, 0.4, 0.3]}}
    nodes:
    - {name: ball, place: {translate: [0, 1, 0]}, shapes: {sphere: {radius: 1}, materials: clay}}
    - {name: pot, model: teapot}

What may stand where are the fields of the descriptions themselves (`limner.scene`), so a file says what Python would, with the same names
and defaults, and new fields are there by themselves. Reading what was written gives the same scene, to the bit. Mistakes are told with
line and place:

    scene.yaml, line 8, nodes[0].shapes.sphere.radius: must be positive, got -1.0
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..errors import FileFormatError, SceneError
from ..scene.scene import Scene
from .limits import DEFAULT, Limits
from .notes import Notes
from .scene_file_models import Models
from .scene_file_reader import SceneReader
from .scene_file_schema import VERSION, MismatchError, check, json_schema
from .scene_file_settings import Settings
from .scene_file_writer import SceneWriter
from .scene_file_yaml import Document, compose, emit
from .sources import Sources
from .write_gltf_files import File, check_place, put_whole

__all__ = ["SUFFIXES", "read", "save_scene", "schema", "settings_of"]

SUFFIXES = (".yaml", ".yml", ".limner")
"""How the names of scene files end."""


def schema() -> dict[str, Any]:
    """The schema of scene files as JSON Schema (2020-12): editors that have it complete and check while one types.

    >>> sorted(schema()["$defs"]["Sphere"]["properties"])
    ['radius']
    """
    return json_schema()


def settings_of(path: str | os.PathLike[str], *, limits: Limits = DEFAULT) -> dict[str, Any]:
    """How the picture of a scene file is to be made.

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    dict of str to plain values
        Arguments of `limner.render`, those that the file names; empty for models that are no scene files.
    """
    if Path(path).suffix.lower() not in SUFFIXES:
        return {}
    document = compose(Sources(path, limits).read_model(), path)
    said = document.top.get("settings") if isinstance(document.top, dict) else None
    if said is None:
        return {}
    try:
        check({"limner": VERSION, "settings": said}, Scene)
    except MismatchError as error:
        raise document.error(error.where, error.text) from None
    return {name: tuple(value) if isinstance(value, list) else value for name, value in said.items() if value is not None}


def read(
    data: bytes, path: str | os.PathLike[str], *, limits: Limits, notes: Notes, sources: Sources, chain: tuple[Path, ...] = ()
) -> Scene:
    """Read a scene file.

    Parameters
    ----------
    data : bytes
        The text.
    path : str or path-like
        For messages; other files are looked for beside it.
    limits : Limits
    notes : Notes
    sources : Sources
        What else it may read.
    chain : tuple of Path
        The scene files that include this one.

    Raises
    ------
    FileFormatError
        With the line, and the way to what is wrong.
    """
    document = compose(data, path)
    _check_version(document)
    try:
        return SceneReader(document, sources, limits, notes, Models(sources, limits, _read_included, chain)).scene()
    except RecursionError:
        raise FileFormatError("is nested too deeply", path) from None


def _check_version(document: Document) -> None:
    top = document.top
    if isinstance(top, dict) and "limner" not in top:
        raise document.error((), "a scene file must begin with 'limner: 1', the version of its format")
    if isinstance(top, dict) and isinstance(top["limner"], int) and top["limner"] > VERSION:
        raise document.error(("limner",), f"version {top['limner']} is not read yet: this limner reads {VERSION}")


def _read_included(path: Path, up: str, limits: Limits, chain: tuple[Path, ...]) -> Scene:
    from .load import EXTENSIONS, load, model_format, upright

    sources = Sources(path, limits)
    # What is plainly no scene file is not read twice.
    if EXTENSIONS.get(path.suffix.lower(), "scene") != "scene" or model_format(data := sources.read_model(), path) != "scene":
        return load(path, up=up, limits=limits)
    scene = read(data, path, limits=limits, notes=Notes(), sources=sources, chain=chain)
    return upright(scene) if up == "z" else scene


def save_scene(scene: Scene, path: str | os.PathLike[str], *, settings: Mapping[str, Any] | None = None) -> None:
    """Write a scene as a scene file, whose reading gives the same scene to the bit.

    Parameters
    ----------
    scene : Scene
    path : str or path-like
        Ending in .yaml, .yml or .limner. Arrays of more than 64 numbers are put into a file beside it (``scene.yaml.arrays-….npz``), and
        so is an environment's picture that stands in another folder.
    settings : mapping, optional
        Arguments of `limner.render` by which its picture is to be made; see `settings_of`.

    Raises
    ------
    SceneError
        What `settings` names is no setting.
    UnsupportedError
        A scene that holds what files have no words for; nothing is written.
    RenderError
        It cannot be written. What was there before is still there, and still whole.
    """
    place = Path(path)
    if place.suffix.lower() not in SUFFIXES:
        raise SceneError(f"a scene file must end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}, got {place.name!r}")
    check_place(place)
    writer = SceneWriter(place)
    said = writer.document(scene)
    files = [File(place.with_name(name), _copied(source)) for name, source in writer.copies.items()]
    head: dict[str, Any] = {"limner": VERSION}
    if settings:
        head["settings"] = _checked_settings(settings)
    if writer.arrays:
        head["arrays"] = f"{place.name}.arrays-{writer.arrays.digest()}.npz".replace("%", "%25")
        files.append(File(place.with_name(head["arrays"].replace("%25", "%")), lambda: [writer.arrays.to_bytes()]))
    text = emit(head | said)
    put_whole([*files, File(place, lambda: [text])])
    _remove_old(place)


def _checked_settings(settings: Mapping[str, Any]) -> dict[str, Any]:
    said = {name: list(value) if isinstance(value, tuple) else value for name, value in settings.items() if value is not None}
    try:
        check(said, Settings)
    except MismatchError as error:
        raise SceneError(f"settings{''.join(f'.{step}' for step in error.where)}: {error.text}") from None
    return said


def _copied(source: Path) -> Any:
    def chunks() -> Iterable[bytes]:
        return [source.read_bytes()]

    return chunks


def _remove_old(place: Path) -> None:
    """Remove what former texts of this name had beside them, unless a scene file of the folder, such as a copy, names it still."""
    own = re.compile(re.escape(place.name) + r"\.(?:arrays-[0-9a-f]{16}\.npz|sky-[0-9a-f]{16}\.\w+)")
    with suppress(OSError):
        found = list(place.parent.iterdir())
        old = [beside for beside in found if own.fullmatch(beside.name)]
        for text in (one for one in found if old and one.suffix.lower() in SUFFIXES and one.is_file()):
            said = text.read_bytes()
            old = [beside for beside in old if beside.name.replace("%", "%25").encode() not in said]
        for beside in old:
            beside.unlink()
