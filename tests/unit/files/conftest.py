"""A small writer of glTF, good and bad, for the tests of its reader."""

from __future__ import annotations

import base64
import copy
import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


class GltfWriter:
    """A glTF document under construction: one buffer, one scene."""

    def __init__(self) -> None:
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": []}], "accessors": [], "bufferViews": [], "buffers": [{"byteLength": 0}],
        }  # fmt: skip
        self.buffer = bytearray()

    def view(self, data: bytes, **fields: Any) -> int:
        """Add bytes, aligned to 4, as a buffer view."""
        self.buffer.extend(b"\0" * (-len(self.buffer) % 4))
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data), **fields})
        self.buffer.extend(data)
        return len(self.document["bufferViews"]) - 1

    def accessor(self, values: Any, dtype: str = "f4", **fields: Any) -> int:
        """Add an accessor over a view of its own."""
        array = np.atleast_2d(np.asarray(values, dtype="<" + dtype).T).T
        self.document["accessors"].append({
            "bufferView": self.view(array.tobytes()), "componentType": COMPONENTS[dtype], "count": len(array),
            "type": TYPES[array.shape[1]], **fields,
        })  # fmt: skip
        return len(self.document["accessors"]) - 1

    def primitive(self, positions: Any, indices: Any = None, dtype: str = "u2", **fields: Any) -> dict[str, Any]:
        """Add a primitive to the mesh and return it."""
        made: dict[str, Any] = {"attributes": {"POSITION": self.accessor(positions)}, **fields}
        if indices is not None:
            made["indices"] = self.accessor(np.ravel(indices), dtype)
        self.document["meshes"][0]["primitives"].append(made)
        return made

    def picture(self, pixels: Any, kind: str = "PNG") -> int:
        """Add an encoded picture, and a texture of the same number, and return that."""
        stream = io.BytesIO()
        Image.fromarray(np.asarray(pixels, dtype=np.uint8)).save(stream, kind, **({"lossless": True} if kind == "WEBP" else {}))
        self.document.setdefault("images", []).append({"bufferView": self.view(stream.getvalue()), "mimeType": "image/png"})
        self.document.setdefault("textures", []).append({"source": len(self.document["images"]) - 1})
        return len(self.document["textures"]) - 1

    def _finished(self) -> dict[str, Any]:
        document = copy.deepcopy(self.document)
        if document.get("buffers"):
            document["buffers"][0].setdefault("byteLength", 0)
            document["buffers"][0]["byteLength"] = document["buffers"][0]["byteLength"] or len(self.buffer)
        return document

    def glb(self) -> bytes:
        """The document as a binary file."""
        text = json.dumps(self._finished()).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.buffer) + b"\0" * (-len(self.buffer) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def embedded(self) -> bytes:
        """The document as text with its buffer in a data: URI."""
        document = self._finished()
        document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.buffer).decode()
        return json.dumps(document).encode()

    def separate(self, folder: Path, uri: str = "model.bin", name: str = "model.bin") -> bytes:
        """The document as text that refers to a file, which is written."""
        (folder / name).write_bytes(self.buffer)
        document = self._finished()
        document["buffers"][0]["uri"] = uri
        return json.dumps(document).encode()

    def save(self, folder: Path) -> Path:
        """Write the binary file and return its path."""
        path = folder / "model.glb"
        path.write_bytes(self.glb())
        return path


@pytest.fixture
def writer() -> GltfWriter:
    """An empty document."""
    return GltfWriter()


@pytest.fixture
def triangle(writer: GltfWriter) -> GltfWriter:
    """A document with one indexed triangle."""
    writer.primitive([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    return writer


@pytest.fixture
def rich(writer: GltfWriter) -> GltfWriter:
    """A document with one of everything: the seed of the fuzz tests."""
    primitive = writer.primitive([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [2, 1, 3]], material=0)
    primitive["attributes"].update(
        NORMAL=writer.accessor([[0, 0, 1]] * 4),
        TANGENT=writer.accessor([[1, 0, 0, 1]] * 4),
        TEXCOORD_0=writer.accessor([[0, 0], [1, 0], [0, 1], [1, 1]]),
        COLOR_0=writer.accessor([[255, 0, 0, 255]] * 4, "u1", normalized=True),
    )
    texture = writer.picture(np.zeros((2, 2, 3)))
    document = writer.document
    document["materials"] = [{
        "name": "m", "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": True, "emissiveFactor": [1, 0.5, 0],
        "pbrMetallicRoughness": {
            "baseColorFactor": [1, 1, 1, 0.5], "metallicFactor": 0.1, "roughnessFactor": 0.2,
            "baseColorTexture": {
                "index": texture, "texCoord": 0,
                "extensions": {"KHR_texture_transform": {"offset": [0.1, 0.2], "rotation": 0.3, "scale": [2, 3]}},
            },
            "metallicRoughnessTexture": {"index": texture},
        },
        "normalTexture": {"index": texture, "scale": 0.5}, "occlusionTexture": {"index": texture, "strength": 0.5},
        "emissiveTexture": {"index": texture},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}, "KHR_materials_unlit": {}},
    }]  # fmt: skip
    document["samplers"] = [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9729, "minFilter": 9729}]
    document["textures"][0]["sampler"] = 0
    document["cameras"] = [
        {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1, "zfar": 100, "aspectRatio": 1.5}},
        {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 1, "znear": 0.1, "zfar": 10}},
    ]
    document["extensions"] = {"KHR_lights_punctual": {"lights": [
        {"type": "point", "intensity": 20, "color": [1, 0.9, 0.8], "range": 5},
        {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}},
        {"type": "directional"},
    ]}}  # fmt: skip
    document["nodes"] = [
        {"mesh": 0, "children": [1, 2], "name": "top"},
        {"camera": 0, "translation": [0, 0, 5], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]},
        {"camera": 1, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 2, 1], "children": [3, 4, 5]},
        *({"extensions": {"KHR_lights_punctual": {"light": light}}} for light in range(3)),
    ]
    return writer
