"""Writing glTF 2.0, as one binary file (.glb) and as text with what belongs to it (.gltf).

    notes = write(scene, "chair.glb")                    one file
    notes = write(scene, "chair.gltf")                   chair.gltf, chair.bin and the pictures beside it
    notes = write(scene, "chair.gltf", embedded=True)    one file of text

The graph is kept: names, places, what is hidden, what is shared, what moves and bends. What glTF can say is read back as it was, to the
bit, but for the last digits of places, and for keys of animations, which are of single precision there. What it cannot say is approximated
or left out, and the notes say what and where. The same scene gives the same bytes.

**Source**: Khronos Group, *glTF 2.0 Specification*, version 2.0.1.
"""

from __future__ import annotations

import base64
import json
import os
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

from ..errors import UnsupportedError
from ..scene.scene import Scene
from .glb import BINARY_CHUNK, JSON_CHUNK, MAGIC
from .notes import Notes
from .write_gltf_animation import Animations, moving
from .write_gltf_buffers import Buffers, Json
from .write_gltf_camera import Cameras, Lights
from .write_gltf_files import File, check_place, put_whole
from .write_gltf_material import VARIANTS, Materials, plain_text
from .write_gltf_mesh import Meshes
from .write_gltf_nodes import Graph

__all__ = ["EXTENSIONS", "write"]

EXTENSIONS = (".glb", ".gltf")

_GENERATOR = "limner"
_REQUIRED = frozenset({"EXT_mesh_gpu_instancing"})  # without which something else would be seen
_MOST_BYTES = (1 << 32) - 1  # of a GLB: its length has 32 bits
_PNG = "image/png"


def write(scene: Scene, path: str | os.PathLike[str], *, embedded: bool = False, gpu_instancing: bool = False) -> tuple[str, ...]:
    """Write a scene as glTF.

    Parameters
    ----------
    scene : Scene
        All of it, what is hidden too, as it stands at time 0, with its animations. A camera of its own becomes the first of the file.
    path : str or path-like
        ``.glb``: all in one; ``.gltf``: text, with a ``.bin`` and pictures named after it beside it.
    embedded : bool
        Put what would lie beside a ``.gltf`` into it.
    gpu_instancing : bool
        Write siblings that do nothing but show the same mesh as one node with many places (EXT_mesh_gpu_instancing): shorter, but
        without their names, and not every program reads it. Without it the mesh is written once all the same.

    Returns
    -------
    tuple of str
        What was approximated or left out, and where.

    Raises
    ------
    UnsupportedError
        Another extension, or a GLB of more than 4 GiB.
    SceneError
        A skin names joints that are not there.
    RenderError
        The file cannot be written: no such folder, no permission, a full disk. What was there before is still there.
    """
    target = Path(os.fspath(path))
    if target.suffix.lower() not in EXTENSIONS:
        raise UnsupportedError(f"glTF is saved as {' or '.join(EXTENSIONS)}, got {os.fspath(path)!r}")
    check_place(target)
    binary = target.suffix.lower() == ".glb"
    writer = _Writer(scene, target, inside=binary or embedded, gpu_instancing=gpu_instancing)
    put_whole(writer.glb() if binary else writer.text())
    return writer.notes.lines()


class _Writer:
    """One glTF file while it is put together.

    Parameters
    ----------
    inside : bool
        Whether buffers and pictures are part of the file.
    """

    def __init__(self, scene: Scene, target: Path, *, inside: bool, gpu_instancing: bool) -> None:
        self._target = target
        self._inside = inside
        self._is_binary = target.suffix.lower() == ".glb"
        self._beside: list[File] = []
        self.notes = Notes()
        self._buffers = Buffers()
        self._document = self._build(scene, gpu_instancing)

    def glb(self) -> list[File]:
        """The file as a binary container (4.4)."""
        text = self._json()
        text += b" " * (-len(text) % 4)
        length = self._buffers.length
        total = 12 + 8 + len(text) + (8 + length if length else 0)
        if total > _MOST_BYTES:
            raise UnsupportedError(f"a GLB holds 4 GiB at most, and this scene needs {total} bytes; save it as .gltf")

        def chunks() -> Iterator[bytes | memoryview]:
            yield MAGIC + struct.pack("<II", 2, total)
            yield struct.pack("<II", len(text), JSON_CHUNK) + text
            if length:
                yield struct.pack("<II", length, BINARY_CHUNK)
                yield from self._buffers.chunks()

        return [File(self._target, chunks)]

    def text(self) -> list[File]:
        """The file as text, after those that it names."""
        if self._buffers.length and not self._inside:
            self._beside.append(File(self._target.with_suffix(".bin"), self._buffers.chunks))
        return [*self._beside, File(self._target, lambda: [self._json()])]

    def _json(self) -> bytes:
        return json.dumps(self._document, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()

    def _build(self, scene: Scene, gpu_instancing: bool) -> Json:
        changes = moving(scene)
        materials = Materials(self._store, self.notes, changes.materials)
        meshes = Meshes(self._buffers, materials, self.notes)
        cameras, lights = Cameras(scene, self.notes), Lights(self.notes, changes.lights)
        graph = Graph(
            scene, self._buffers, meshes, cameras, lights, self.notes,
            moving=changes.nodes, told=changes.shown, gpu_instancing=gpu_instancing,
        )  # fmt: skip
        graph.build()
        animations = Animations(self._buffers, graph.stands, materials, cameras, lights, self.notes)
        for animation in scene.animations:
            animations.add(animation)
        animations.add_motions(scene)
        self._note_surroundings(scene)
        used = graph.extensions | materials.extensions | animations.extensions
        shown: Json = ({"name": plain_text(scene.name)} if scene.name else {}) | ({"nodes": graph.roots} if graph.roots else {})
        made: Json = {
            "asset": {"generator": _GENERATOR, "version": "2.0"},
            "extensionsUsed": sorted(used),
            "extensionsRequired": sorted(used & _REQUIRED),
            "extensions": ({"KHR_lights_punctual": {"lights": lights.lights}} if lights.lights else {})
            | ({VARIANTS: {"variants": materials.variants}} if materials.variants else {}),
            "scene": 0,
            "scenes": [shown],
            "nodes": graph.nodes,
            "cameras": cameras.cameras,
            "meshes": meshes.meshes,
            "skins": graph.skins,
            "animations": animations.animations,
            "materials": materials.materials,
            "textures": materials.textures,
            "samplers": materials.samplers,
            "images": materials.images,
            "accessors": self._buffers.accessors,
            "bufferViews": self._buffers.views(),
            "buffers": self._described_buffers(),
        }
        # The specification forbids lists that are empty.
        return {key: value for key, value in made.items() if value not in ([], {})}

    def _described_buffers(self) -> list[Json]:
        length = self._buffers.length
        if not length:
            return []
        described: Json = {"byteLength": length}
        if not self._is_binary:
            described["uri"] = self._embedded_buffer() if self._inside else quote(self._target.with_suffix(".bin").name)
        return [described]

    def _embedded_buffer(self) -> str:
        return _data_uri(b"".join(self._buffers.chunks()), "application/octet-stream")

    def _store(self, data: bytes, name: str) -> Json:
        """Put a picture where pictures go, and say where that is."""
        if self._is_binary:
            return {"bufferView": self._buffers.picture(data), "mimeType": _PNG}
        if self._inside:
            return {"uri": _data_uri(data, _PNG)}
        beside = self._target.with_name(f"{self._target.stem}_{len(self._beside)}.png")
        self._beside.append(File(beside, lambda: [data]))
        return {"uri": quote(beside.name)}

    def _note_surroundings(self, scene: Scene) -> None:
        left: dict[str, Any] = {"environment": scene.environment, "background": scene.background, "fog": scene.fog}
        for what, value in left.items():
            if value is not None:
                self.notes.add(f"the scene's {what} is left out, glTF has none")


def _data_uri(data: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"
