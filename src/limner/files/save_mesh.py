"""Models into files: glTF, scene files, OBJ, PLY and STL, and never half a file.

    limner.save_model(scene, "chair.glb")        all of it: the graph, materials, cameras, lights, animations
    limner.save_model(scene, "chair.obj")        with chair.mtl and its textures beside it
    limner.save_model("chair.glb", "chair.stl")

A file is written beside its place under another name and moved into it when it is whole. What each format keeps say `write_obj`,
`write_ply`, `write_stl`, `write_gltf` and `scene_file`; all but the last two hold the scene as it stands at time 0, in the world, +y up.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from ..errors import RenderError, UnsupportedError
from .interop import as_scene
from .world_parts import Part, world_parts
from .write_gltf import EXTENSIONS, write
from .write_obj import Library, write_obj
from .write_ply import write_ply
from .write_stl import write_stl

__all__ = ["SAVED", "save_model"]

SAVED = (".glb", ".gltf", ".yaml", ".yml", ".limner", ".obj", ".ply", ".stl")

Write = Callable[[IO[bytes]], None]


def save_model(thing: Any, path: str | os.PathLike[str]) -> tuple[str, ...]:
    """Write a model to a file.

    Parameters
    ----------
    thing : Scene, Mesh, PointCloud, or whatever else `limner.render` takes
        Of a scene all that is visible, where it stands in the world. Exact shapes become triangles; infinite planes are left out, which a
        warning says; so are lights and cameras. Not so glTF and scene files, which have the whole scene.
    path : str or path-like
        The extension says the format:

        .glb, .gltf
            The graph with names and all that is hidden, moves or bends, each mesh and picture once; see `limner.files.write_gltf`.
        .yaml, .yml, .limner
            A scene file, which holds all that a scene can; see `limner.files.scene_file`.
        .obj
            Positions, normals, texture coordinates, vertex colours, materials, textures; an object for each shape.
        .ply
            One mesh, or one cloud: positions, normals and texture coordinates where they are per vertex (texture coordinates otherwise
            with the faces), vertex colours with the materials' own, scalars by name. Little-endian.
        .stl
            One mesh: triangles alone. Binary.

    Returns
    -------
    tuple of str
        What glTF could not hold, and where; of the others nothing is said.

    Raises
    ------
    UnsupportedError
        Another extension.
    SceneError
        There is nothing to save.
    RenderError
        The file cannot be written: no such folder, no permission, a full disk. What was there before is still there.
    """
    target = Path(os.fspath(path))
    kind = target.suffix.lower()
    if kind not in SAVED:
        raise UnsupportedError(f"models are saved as {', '.join(SAVED)}, got {os.fspath(path)!r}")
    _check_place(target)
    scene = as_scene(thing)
    if kind in EXTENSIONS:
        return write(scene, target)
    if kind in (".yaml", ".yml", ".limner"):
        from .scene_file import save_scene

        save_scene(scene, target)
        return ()
    parts = world_parts(scene, lines=kind == ".obj")
    try:
        if kind == ".obj":
            _save_obj(parts, target)
        elif kind == ".ply":
            _save_whole(target, lambda stream: write_ply(parts, stream))
        else:
            _save_whole(target, lambda stream: write_stl(parts, stream))
    except OSError as error:
        raise RenderError(f"cannot write {os.fspath(path)}: {error.strerror or error}") from error
    return ()


def _check_place(target: Path) -> None:
    """Refuse a place where no file can be, before any work is done for it."""
    if target.is_dir():
        raise RenderError(f"cannot write {target}: it is a folder")
    if not target.parent.is_dir():
        raise RenderError(f"cannot write {target}: there is no folder {target.parent}")


def _save_obj(parts: list[Part], target: Path) -> None:
    """What the file refers to is written first, so that a file that is there has all that it needs."""
    library = Library(parts, target.stem)
    for name, data in library.pictures().items():
        _save_whole(target.with_name(name), lambda stream, data=data: _put(stream, data))  # type: ignore[misc]
    library_file = target.with_suffix(".mtl")
    _save_whole(library_file, lambda stream: _put(stream, library.text()))
    _save_whole(target, lambda stream: write_obj(parts, library, library_file.name, stream))


def _put(stream: IO[bytes], data: bytes) -> None:
    stream.write(data)


def _save_whole(target: Path, write: Write) -> None:
    """Write under another name in the same folder, then move into place."""
    place = Path(os.path.realpath(target))
    part = place.with_name(f".{place.name[:100]}.{os.urandom(6).hex()}.part")
    try:
        with open(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666), "wb") as stream:
            if place.is_file():
                part.chmod(stat.S_IMODE(place.stat().st_mode))
            write(stream)
        os.replace(part, place)
    except BaseException:  # an interrupt, too, must leave nothing behind
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise
