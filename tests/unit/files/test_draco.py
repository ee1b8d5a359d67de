"""Draco-compressed geometry: what the library gives becomes a mesh; without it the message says what helps."""

from __future__ import annotations

import base64
import random
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from limner import load
from limner.errors import FileFormatError, LimnerError, UnsupportedError
from limner.files.draco import DracoError, decode
from limner.files.gltf import read
from limner.files.limits import Limits
from limner.files.notes import Notes

DUCK = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "khronos" / "Duck"
# A square of two triangles, as DracoPy 2.2 writes it.
STREAM = "RFJBQ08CAgEBAAAABAIAAgAAAR//AREB/wAAAQAJAwAAAgEBAQAPAwEgARArARADADCQSgCAAOD/BwAAAAD/PwAAAAAAAAAAAAAAAAAAAACAPw4="
POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.5]], dtype=np.float32)
TRIANGLES = np.array([[0, 1, 2], [2, 1, 3]])


def library(**fields: Any) -> SimpleNamespace:
    """A stand-in for the library, whose streams all hold the square."""
    part = {"unique_id": 5, "data": POSITIONS}
    colors = {"unique_id": 7, "data": np.full((4, 4), 255, dtype=np.uint8)}
    mesh = SimpleNamespace(**{"attributes": [part, colors], "faces": TRIANGLES.astype(np.int64)} | fields)
    return SimpleNamespace(decode=lambda data: mesh)


@pytest.fixture
def square(writer: Any) -> Any:
    """A document whose accessors have no bytes of their own."""
    primitive = writer.primitive(POSITIONS, TRIANGLES)
    primitive["attributes"]["COLOR_0"] = writer.accessor([[0, 0, 0, 0]] * 4, "u1", normalized=True)
    for accessor in writer.document["accessors"]:
        del accessor["bufferView"]
    view = writer.view(base64.b64decode(STREAM))
    attributes = {"POSITION": 5, "COLOR_0": 7}
    primitive["extensions"] = {"KHR_draco_mesh_compression": {"bufferView": view, "attributes": attributes}}
    return writer


def test_what_the_library_gives(square: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Attributes are found by their numbers in the stream, integers are fractions where the accessor says so; strips come as triangles."""
    monkeypatch.setitem(sys.modules, "DracoPy", library())
    square.document["meshes"][0]["primitives"][0]["mode"] = 5
    mesh: Any = read(square.glb(), "model.glb").shapes()[0][1].geometry
    assert mesh.positions.tolist() == POSITIONS.tolist()
    assert mesh.triangles.tolist() == TRIANGLES.tolist()
    assert mesh.colors.tolist() == np.ones((4, 4)).tolist()


def test_missing_attribute(square: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A number that the stream does not have costs the attribute; positions are the mesh itself."""
    monkeypatch.setitem(sys.modules, "DracoPy", library())
    attributes = square.document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]
    attributes["COLOR_0"] = 6
    notes = Notes()
    mesh: Any = read(square.glb(), "model.glb", notes=notes).shapes()[0][1].geometry
    assert mesh.colors is None
    assert any("drawn without COLOR_0" in line and "[5, 7]" in line for line in notes.lines())
    attributes["POSITION"] = 7
    with pytest.raises(FileFormatError, match="3 numbers for each element, its compressed stream has 4"):
        read(square.glb(), "model.glb", notes=Notes())


def test_without_the_library(square: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message names what is missing and how to get it; where the file has the geometry uncompressed, that is read."""
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    with pytest.raises(UnsupportedError, match=r'KHR_draco_mesh_compression; pip install "limner\[draco\]".*gltf-transform'):
        read(square.glb(), "model.glb", notes=Notes())


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"faces": np.array([[0, 1, 4]])}, "refer to vertices"), ({"faces": np.zeros((0, 2))}, "no triangles"),
        ({"attributes": []}, "no triangles"), ({"attributes": None}, "no readable"),
        ({"attributes": [{"unique_id": k, "data": np.zeros((k, 3))} for k in (2, 3)]}, "no triangles"),
    ],
)  # fmt: skip
def test_strange_streams(fields: dict[str, Any], message: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the library gives is not taken on trust."""
    monkeypatch.setitem(sys.modules, "DracoPy", library(**fields))
    with pytest.raises(DracoError, match=message):
        decode(b"DRACO", "model.glb")


def test_limits(square: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both what the file declares and what comes out of the stream count for the limits."""
    monkeypatch.setitem(sys.modules, "DracoPy", library())
    with pytest.raises(FileFormatError, match="max_vertices"):
        read(square.glb(), "model.glb", notes=Notes(), limits=Limits(max_vertices=3))
    square.document["accessors"][0]["count"] = 1
    with pytest.raises(FileFormatError, match="max_vertices"):
        read(square.glb(), "model.glb", notes=Notes(), limits=Limits(max_vertices=3))
    with pytest.raises(FileFormatError, match="max_triangles"):
        read(square.glb(), "model.glb", notes=Notes(), limits=Limits(max_triangles=1))


def test_real_stream() -> None:
    """The library itself: a square comes back but for its quantisation, and broken streams are errors and nothing worse."""
    pytest.importorskip("DracoPy", reason="needs DracoPy, of the extra draco")
    mesh = decode(base64.b64decode(STREAM), "model.glb")
    corners = np.sort(mesh.attributes[0][mesh.triangles].reshape(2, -1), axis=None)
    assert np.allclose(corners, np.sort(POSITIONS[TRIANGLES].reshape(2, -1), axis=None), atol=1e-3)
    rng, sound = random.Random(2), base64.b64decode(STREAM)
    for _ in range(200):
        changed = bytearray(sound)
        changed[rng.randrange(len(changed))] = rng.randrange(256)
        try:
            decode(bytes(changed), "model.glb")
        except LimnerError:
            continue


@pytest.mark.skipif(not DUCK.is_dir(), reason="the sample models are not here")
def test_duck() -> None:
    """The compressed duck is the duck, to what its compression lost."""
    pytest.importorskip("DracoPy", reason="needs DracoPy, of the extra draco")
    packed: Any = load(DUCK / "glTF-Draco" / "Duck.gltf").shapes()[0][1].geometry
    plain: Any = load(DUCK / "glTF" / "Duck.gltf").shapes()[0][1].geometry
    assert len(packed.triangles) == len(plain.triangles)
    step = np.ptp(plain.positions, axis=0).max() / 2000.0
    centres = [mesh.positions[mesh.triangles].mean(axis=1) for mesh in (packed, plain)]
    assert np.abs(np.sort(centres[0], axis=0) - np.sort(centres[1], axis=0)).max() < step
