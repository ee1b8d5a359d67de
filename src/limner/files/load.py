"""From a file to a scene: which reader, and its remarks as warnings.

The first bytes decide where they are beyond doubt (a GLB named .obj is a GLB); then the extension; then, where there is
none, a guess at what the text looks like.
"""

from __future__ import annotations

import os
import re
import warnings
from pathlib import Path

import numpy as np

from ..errors import FileFormatError, LimnerWarning, UnsupportedError
from ..scene.node import Node
from ..scene.scene import Scene
from .limits import DEFAULT, Limits
from .notes import Notes
from .sources import Sources

__all__ = ["EXTENSIONS", "UP", "load", "model_format", "read_model", "upright"]

UP = ("y", "z")
_Y_UP_FROM_Z_UP = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])

EXTENSIONS = {
    ".gltf": "gltf", ".glb": "gltf", ".vrm": "gltf", ".obj": "obj",
    ".ply": "ply", ".stl": "stl", ".off": "off", ".3mf": "3mf", ".dae": "dae", ".xml": "mitsuba",
    ".usd": "usd", ".usda": "usd", ".usdc": "usd", ".usdz": "usd",
    ".yaml": "scene", ".yml": "scene", ".limner": "scene",
}  # fmt: skip

# Magic numbers of models, and of what people hand over by mistake.
_MODELS = {b"glTF": "gltf", b"ply\n": "ply", b"ply\r": "ply", b"PXR-USDC": "usd", b"#usda ": "usd"}
_STRANGERS = {
    b"\x89PNG": "a PNG picture", b"\xff\xd8\xff": "a JPEG picture", b"GIF8": "a GIF picture", b"%PDF": "a PDF document",
    b"\x1f\x8b": "gzip-compressed (unpack it first)", b"BLENDER": "a Blender file (export it as .glb)",
    b"Kaydara FBX": "an FBX file (convert it to .glb)",
    b"version https://git-lfs": "a Git LFS pointer, not the file itself (run git lfs pull)",
}  # fmt: skip
_SCENE_LINE = re.compile(rb"(?:^|\n)(?:limner|\"limner\"):[ \t]*\d")
_OBJ_LINE = re.compile(rb"(?:^|\n)[ \t]*(?:v|vt|vn|f|o|g|usemtl|mtllib)[ \t]+[^\n]")


def load(path: str | os.PathLike[str], *, up: str = "y", scene: str | int | None = None, limits: Limits = DEFAULT) -> Scene:
    """Read a model.

    Parameters
    ----------
    path : str or path-like
        glTF 2.0 (.gltf, .glb), OBJ with MTL, PLY, Mitsuba scenes (.xml) and limner's own scene files (.yaml, .yml, .limner) are
        read by limner itself; .stl, .off, .3mf and .dae need trimesh, and .usd, .usda, .usdc and .usdz need usd-core.
    up : "y" | "z"
        Which axis of the file points up. "y" takes every file as it is, as glTF and limner mean it. Models for printing and construction
        (.stl, .3mf), scans (.ply) and Blender's own axes mean z: with "z" they are turned upright, (x, y, z) to (x, z, -y).
    scene : str or int, optional
        Which of the scenes of a glTF file, by its name or number. None: the one that the file shows by default.
    limits : Limits
        How much it may ask for.

    Returns
    -------
    Scene
        Its `notes` say what was approximated, ignored or repaired; likely slips among them are warned about too. `limner.load_report`
        says more, and in parts.

    Raises
    ------
    FileFormatError
        The file is missing or broken; the message says where.
    UnsupportedError
        The file may be sound, but is of a kind that is not read; the message says what helps.
    """
    found, notes, _ = read_model(path, up=up, scene=scene, limits=limits)
    for text in notes.warnings():
        warnings.warn(f"{Path(path).name}: {text}", LimnerWarning, stacklevel=2)
    return found


def read_model(
    path: str | os.PathLike[str], *, up: str = "y", scene: str | int | None = None, limits: Limits = DEFAULT
) -> tuple[Scene, Notes, str]:
    """Read a model as `load` does; return its scene, what the reader said, and which format it was in."""
    if not isinstance(path, (str, os.PathLike)):
        raise UnsupportedError(f"load needs the path of a file, got {type(path).__name__}; render takes meshes and arrays as they are")
    if up not in UP:
        raise UnsupportedError(f"up must be one of {', '.join(UP)}, got {up!r}")
    sources = Sources(path, limits)
    notes = Notes()
    data = sources.read_model()
    kind = model_format(data, path)
    if scene is not None and kind != "gltf":
        raise UnsupportedError(f"{os.fspath(path)}: only glTF files have several scenes to choose from, got scene={scene!r}")
    if kind == "gltf":
        from .gltf import read as read_gltf

        found = read_gltf(data, path, scene=scene, limits=limits, notes=notes, sources=sources)
    elif kind == "obj":
        from .obj import read as read_obj

        found = read_obj(data, path, limits=limits, notes=notes, sources=sources)
    elif kind == "ply":
        from .ply import read as read_ply

        found = read_ply(data, path, limits=limits, notes=notes, sources=sources)
    elif kind == "mitsuba":
        from .mitsuba import read as read_mitsuba

        found = read_mitsuba(data, path, limits=limits, notes=notes, sources=sources)
    elif kind == "usd":
        from .usd import read as read_usd

        found = read_usd(data, path, limits=limits, notes=notes, sources=sources)
    elif kind == "scene":
        from .scene_file import read as read_scene

        found = read_scene(data, path, limits=limits, notes=notes, sources=sources)
    else:
        from .interop import read as read_with_trimesh

        found = read_with_trimesh(data, path, kind, limits=limits, notes=notes)
    return upright(found) if up == "z" else found, notes, kind


def upright(scene: Scene) -> Scene:
    """Turn a scene whose +z points up so that +y does, with what stands in it.

    >>> from ..scene.shape import Box, Shape
    >>> upright(Scene(Node(shapes=(Shape(Box((1, 2, 3))),)))).bounds().tolist()
    [[-0.5, -1.5, -1.0], [0.5, 1.5, 1.0]]
    """
    return scene.replace(root=Node(parent_from_node=_Y_UP_FROM_Z_UP, children=(scene.root,)))


def model_format(data: bytes, path: str | os.PathLike[str]) -> str:
    """Return which format a file is in: "scene", "gltf", "obj", "ply", "stl", "off", "3mf", "dae", "usd" or
    "mitsuba".

    Raises FileFormatError for an empty file, or one that is plainly something else, and UnsupportedError where neither its
    extension nor its first bytes are known.
    """
    if not data:
        raise FileFormatError("the file is empty", path)
    for magic, kind in _MODELS.items():
        if data.startswith(magic):
            return kind
    for magic, what in _STRANGERS.items():
        if data.startswith(magic):
            raise FileFormatError(f"is no model but {what}", path)
    extension = Path(path).suffix.lower()
    kind = EXTENSIONS.get(extension) or _guess(data)
    if kind:
        return kind
    readable = ", ".join(EXTENSIONS)
    named = f"models named {extension}" if extension else "models of this kind"
    raise UnsupportedError(f"{os.fspath(path)}: {named} are not read; these are: {readable}")


def _guess(data: bytes) -> str:
    head = data[:4096].removeprefix(b"\xef\xbb\xbf").lstrip()
    if _SCENE_LINE.search(head):
        return "scene"
    if head.startswith(b"{") and b'"asset"' in data:
        return "gltf"
    if head.startswith(b"solid ") and b"facet" in data[:65536]:
        return "stl"
    if head.startswith(b"OFF"):
        return "off"
    if b"<COLLADA" in head:
        return "dae"
    if re.match(rb"(?:<\?xml[^>]*>|<!--.*?-->|\s)*<scene\b", head, re.DOTALL):
        return "mitsuba"
    return "obj" if _OBJ_LINE.search(head) and b"\0" not in head else ""
