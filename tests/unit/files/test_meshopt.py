"""Meshopt compression, undone: against bytes that its own encoder wrote, against formulas, and against what nobody would write."""

from __future__ import annotations

import base64
import json
import random
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.errors import FileFormatError
from limner.files.gltf import read
from limner.files.limits import Limits
from limner.files.meshopt import MeshoptError, decode, decode_attributes, decode_indices, decode_triangles
from limner.files.meshopt_filters import FILTERS
from limner.files.notes import Notes

# What the encoder of meshoptimizer 1.3 wrote of what `vertices`, `grid` and the others below say.
V0 = (
    "oB8AAgYKDhIWGh4iJiouMjY6PkJGSk5SVlpeYmZqbnJ2ev//AAB+goaKjpKWmhSAAgCAgIAAACoN3d3d3d3d3d3d3d3d3d3d3d3d3QAAAAABAAAABAAAFSq6rqsHBwe"
    "q6rquBwcHq6oAAAcAAAAvAAD/gIBAQEBAICAgICAgICAQEBAQEBAQEBAQEBAQEBD4iIiIAAAAABAFMIAAAHyAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAGDqAAAAAA"
    "AAAAA="
)
V1 = (
    "oZuaOgACBgoOEhYaHiImKi4yNjo+QkZKTlJWWl5iZmpucnZ6foKGio6SlpoqDd3d3d3d3d3d3d3d3d3d3d3d3d0AAAAAFSq6rqsHBweq6rquBwcHq6oAAAcAAACAgEB"
    "AQEAgICAgICAgIBAQEBAQEBAQEBAQEBAQEBAICAgICAgIAQYAfAEAAAAAAAAAAAAAAGDqAAAAAAAAAAABAAE="
)
TURNED = {
    (2, 3): "oa4AGy1nPXQrfSd8JXstdD9lK2wlbyVsK2UAAAAAAAAAAAAAAAAAAAAAAAAAeFY0EmI=",
    (4, 1): "oa4ACRsJPywZCzkkFwk7JAkXOSQLGTckCRsAAAAAAAAAAAAAAAAAAAAAAAAAeFY0EkI=",
}
TRIANGLES = (
    "4f4eEA4QDhAOEA7+HhkOGA4XDhYO/x4WDhYOFg4WDv8eFg4WDhYOFg7/HhYOFg4WDhYO//5PDwyfAl8JDF8JDF8JDP+KD8kP2sUI9N/FCBIAdodWZ3iphmWJaJgBaQ"
    "AA"
)
INDICES = "0QD/v82yBAQLBAsECwQLBAsECwQLBAsECwQLBAsECwQLBAsECwQLBAsECwQLAAAAAA=="
FILTERED = {
    ("OCTAHEDRAL", 4): "oAE//wAACVVzZxynIQE//wAARxMzO3lPMgACA0NDQwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAALVJ/gQ==",
    ("OCTAHEDRAL", 8): (
        "oAE//wAAqaSqnyNfMQEP7QAABQUHFgE//wAAg7zMMkL84QIFAzcyAAAAAAAAAgNDQ0MAAAAAARmZAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAADZAiYF/wcB"
        "gA=="
    ),
    ("QUATERNION", 8): (
        "oAE//wAArEzalZOk0wE//wAATFMjWGqnGwE//wAAHLd654KhtwE//wAAWAi8+LItLQE//wAA8kssP+C26AE//wAATqKMjnBEmQEDOAAABQQAAAAAAAAAAAAA"
        "AAAAAAAAAAAAAAAAAAAAAAAAAAAA/38="
    ),
    ("EXPONENTIAL", 12): (
        "oAEP/wAAgJ9AEAcQATyAAAAJCAEwgAAADAE/KAAAEAQEAQ/8AABWRQMFAwEkAAAAATAAAAADAT8oAAAQBAQBAD8AAP//gAEz/wAAX9XWlJbTATPeAAAOBQYD"
        "AT8oAAAQBAQAAAAAAAAAAAAAAAAAAAAAAAAAAAAA+e8AAALvAAAA7w=="
    ),
    ("COLOR", 4): "oAE//wAALi6RLi6RLgE//wAAW1ndWVndWwE//wAAdXVKd3VKdQE//wAAfn1+fX59fgAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAB/AH/A",
    ("COLOR", 8): (
        "oAE//wAAkZGRkZGRkQIMz6z8AAAAACMjAT//AADb2d3Z2d3bAT//AAAXFUgVF0oXAT//AABKSkpISkpKAT//AAAbHRIdHRIbARmZAAABP/8AAB4dHh0eHR4A"
        "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAD/HwAA/x8AMA=="
    ),
}
N_FILTERED = 8


def stream(text: str) -> bytes:
    """The bytes of a literal."""
    return base64.b64decode(text)


def vertices(n: int = 40) -> np.ndarray:
    """Elements of 12 bytes: squares, a slope, nothing, a saw, and a float."""
    i = np.arange(n)
    columns = np.stack([i * i, (60000 - 7 * i) & 65535, 0 * i, i % 5], axis=1).astype("<u2")
    return np.concatenate([columns.view(np.uint8), (i / 8.0).astype("<f4").reshape(-1, 1).view(np.uint8)], axis=1)


def grid() -> np.ndarray:
    """A grid of 5 x 5 squares, and three triangles that jump about."""
    corners = [k for y in range(5) for a in range(6 * y, 6 * y + 5) for k in (a, a + 1, a + 6, a + 6, a + 1, a + 7)]
    return np.array([*corners, 1000, 3, 70000, 0, 35, 7, 70000, 3, 9], dtype=np.uint32)


def sequence() -> np.ndarray:
    """Two sequences, one in between the other, one of great numbers."""
    i = np.arange(20)
    return np.stack([i, 4000000000 - 3 * i], axis=1).reshape(-1).astype(np.uint32)


def directions() -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors and unit quaternions."""
    i = np.arange(N_FILTERED)
    a, h, t = 0.8 * i, 1.0 - 2.0 * (i + 0.5) / N_FILTERED, 0.4 * i
    r = np.sqrt(1.0 - h * h)
    unit = np.stack([r * np.cos(a), h, r * np.sin(a)], axis=1)
    return unit, np.concatenate([np.sin(t)[:, None] * unit, np.cos(t)[:, None]], axis=1)


def test_what_the_encoder_wrote() -> None:
    """Attributes of both versions, triangles and index sequences come back to the bit."""
    assert (decode_attributes(stream(V0), 40, 12) == vertices()).all()
    assert (decode_attributes(stream(V1), 40, 12) == vertices()).all()
    assert decode_triangles(stream(TRIANGLES), len(grid())).reshape(-1, 3).tolist() == canonical(grid().reshape(-1, 3))
    assert decode_indices(stream(INDICES), 40).tolist() == sequence().tolist()
    assert decode_indices(memoryview(stream(INDICES)), 40).dtype == np.uint32


def canonical(triangles: np.ndarray) -> list[list[int]]:
    """The triangles, each begun at the corner at which the encoder began it: that much it may change."""
    decoded = decode_triangles(stream(TRIANGLES), 3 * len(triangles)).reshape(-1, 3)
    turned = []
    for one, other in zip(triangles.tolist(), decoded.tolist(), strict=True):
        k = one.index(other[0])
        turned.append(one[k:] + one[:k])
    return turned


@pytest.mark.parametrize(("shift", "factor"), TURNED)
def test_turned_words(shift: int, factor: int) -> None:
    """Words whose differences are exclusive ors, turned so that few bytes differ: to the right, whatever the draft says."""
    i = np.arange(24)
    expected = ((9 * i % 37 * factor & 255) << shift) ^ 0x12345678
    assert decode_attributes(stream(TURNED[shift, factor]), 24, 4).view("<u4").reshape(-1).tolist() == expected.tolist()


def test_sentinels() -> None:
    """The example of the specification: sixteen differences of four bits, two of them escaped."""
    packed = bytes([0x17, 0x5F, 0xF0, 0xBC, 0x77, 0xA9, 0x21, 0x00, 0x34, 0xB5])
    data = b"\xa0" + b"\x02" + packed + b"\0\0\0" + bytes(32)  # four data blocks: a header byte each
    expected = np.cumsum([-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]) % 256
    rows = decode_attributes(data, 16, 4)
    assert rows[:, 0].tolist() == expected.tolist()
    assert not rows[:, 1:].any()


@pytest.mark.parametrize("count", [1, 15, 16, 17, 255, 256, 257, 600])
@pytest.mark.parametrize("stride", [4, 40])
def test_literal_blocks(count: int, stride: int) -> None:
    """A stream of plain differences, written here: blocks end where they should, differences go on from block to block."""
    rows = np.random.default_rng(count).integers(0, 256, (count, stride), dtype=np.uint8)
    signed = np.diff(rows, axis=0, prepend=rows[:1] * 0).view(np.int8).astype(np.int16)
    zigzag = (signed << 1 ^ signed >> 7).astype(np.uint8)
    size = min(8192 // stride & ~15, 256)
    blocks = [zigzag[start : start + size] for start in range(0, count, size)]
    body = b"".join(b"\xff" * (stride // 4) + block.T.tobytes() for block in blocks)
    tail = bytes(stride + stride // 4).rjust(24, b"\0")
    assert (decode_attributes(b"\xa1" + body + tail, count, stride) == rows).all()


def test_octahedral() -> None:
    """Unit vectors come back within a step of what they were rounded to, and what is beside them as it was."""
    unit, _ = directions()
    for stride, steps, kind, tolerance in ((4, 127, "i1", 0.015), (8, 32767, "<i2", 0.001)):
        found = decode(stream(FILTERED["OCTAHEDRAL", stride]), N_FILTERED, stride, "ATTRIBUTES", "OCTAHEDRAL").view(kind).reshape(-1, 4)
        assert np.abs(found[:, :3] / steps - unit).max() < tolerance
        assert (np.sign(found[:, 3]) == np.where(np.arange(N_FILTERED) % 2, 1, -1)).all()


def test_quaternion() -> None:
    """Unit quaternions come back, up to the sign of all four, which turns nothing."""
    _, given = directions()
    found = decode(stream(FILTERED["QUATERNION", 8]), N_FILTERED, 8, "ATTRIBUTES", "QUATERNION").view("<i2").reshape(-1, 4) / 32767.0
    assert np.abs(np.abs((found * given).sum(axis=1)) - 1.0).max() < 1e-4


def test_exponential() -> None:
    """Floats of very different sizes come back to 20 bits of the greatest of each element."""
    i = np.arange(N_FILTERED)
    given = np.stack([i - 3.5, 1.0 / (i + 1), 1000.0 * i * i], axis=1)
    found = decode(stream(FILTERED["EXPONENTIAL", 12]), N_FILTERED, 12, "ATTRIBUTES", "EXPONENTIAL").view("<f4").reshape(-1, 3)
    assert (np.abs(found - given) <= 2.0**-18 * np.abs(given).max(axis=1, keepdims=True)).all()


def test_color() -> None:
    """Colours with alpha come back within the steps of their bits."""
    i = np.arange(N_FILTERED)
    given = np.stack([i / 7, 1 - i / 7, (i % 3) / 2, np.where(i % 2, 1.0, 0.5)], axis=1)
    for stride, most, kind, tolerance in ((4, 255, "u1", 0.012), (8, 65535, "<u2", 3e-4)):
        found = decode(stream(FILTERED["COLOR", stride]), N_FILTERED, stride, "ATTRIBUTES", "COLOR").view(kind).reshape(-1, 4)
        assert np.abs(found / most - given).max() < tolerance


@pytest.mark.parametrize("name", FILTERS)
def test_filters_take_anything(name: str) -> None:
    """Bytes that no encoder writes give numbers, and no warning."""
    stride = 8 if name != "EXPONENTIAL" else 12
    rows = np.random.default_rng(3).integers(0, 256, (500, stride), dtype=np.uint8)
    rows[:8] = [[0], [255], [127], [128], [1], [254], [64], [3]]
    made = FILTERS[name](rows)
    assert made.shape == rows.shape
    if name == "EXPONENTIAL":
        assert np.isfinite(made.view("<f4")).all()


CASES = [
    (V0, 40, 12, "ATTRIBUTES"), (V1, 40, 12, "ATTRIBUTES"), (TURNED[2, 3], 24, 4, "ATTRIBUTES"), (TRIANGLES, 159, 4, "TRIANGLES"),
    (INDICES, 40, 4, "INDICES"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "count", "stride", "mode"), CASES)
def test_garbage(text: str, count: int, stride: int, mode: str) -> None:
    """Streams that are cut off, longer, changed or counted wrongly give as many bytes as were asked for, or one clear error."""
    rng, sound = random.Random(7), stream(text)
    broken = [sound[:end] for end in range(0, len(sound), 3)] + [sound + b"\0", b"", sound[:1]]
    for _ in range(300):
        changed = bytearray(sound)
        for _ in range(rng.randint(1, 8)):
            changed[rng.randrange(len(changed))] = rng.randrange(256)
        broken.append(bytes(changed))
    n_refused = 0
    for data in broken:
        try:
            assert decode(data, count, stride, mode).shape == (count * stride,)
        except MeshoptError:
            n_refused += 1
    assert n_refused > len(sound) // 4
    for wrong in (count // 48 * 24, count + 48, 3 * 10**9):
        with pytest.raises(MeshoptError):
            decode(sound, wrong, stride, mode)


@pytest.mark.parametrize(
    ("stride", "mode", "filtering", "message"),
    [
        (3, "ATTRIBUTES", "NONE", "multiple of 4"), (260, "ATTRIBUTES", "NONE", "4 to 256"), (12, "ATTRIBUTES", "OCTAHEDRAL", "4 or 8"),
        (12, "ATTRIBUTES", "ZIP", "filter NONE"), (12, "LINES", "NONE", "ATTRIBUTES, TRIANGLES"), (1, "INDICES", "NONE", "2 or 4"),
        (4, "TRIANGLES", "COLOR", "no filter"),
    ],
)  # fmt: skip
def test_what_is_asked_for(stride: int, mode: str, filtering: str, message: str) -> None:
    """What the extension does not allow is refused in its words."""
    with pytest.raises(MeshoptError, match=message):
        decode(stream(V0), 40, stride, mode, filtering)


def test_indices_that_do_not_fit() -> None:
    """An index that two bytes cannot hold is not cut off."""
    with pytest.raises(MeshoptError, match="70000"):
        decode(stream(TRIANGLES), len(grid()), 2, "TRIANGLES")


# --- in a file ------------------------------------------------------------------------------------------------------------------


def document(extension: str, *, fallback: bool) -> bytes:
    """A mesh whose floats are the last of each vertex of `vertices`, all of it compressed."""
    buffer = stream(V1) + bytes(-len(stream(V1)) % 4) + stream(TRIANGLES)
    start = len(buffer) - len(stream(TRIANGLES))
    views: list[dict[str, Any]] = [
        {"buffer": 1, "byteLength": 480, "byteStride": 12, "extensions": {extension: {
            "buffer": 0, "byteLength": len(stream(V1)), "byteStride": 12, "count": 40, "mode": "ATTRIBUTES"}}},
        {"buffer": 1, "byteOffset": 480, "byteLength": 636, "extensions": {extension: {
            "buffer": 0, "byteOffset": start, "byteLength": len(stream(TRIANGLES)), "byteStride": 4, "count": 159, "mode": "TRIANGLES"}}},
    ]  # fmt: skip
    plain = {"uri": "data:;base64," + base64.b64encode(bytes(1116)).decode()} if fallback else {}
    return json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": [extension], "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "buffers": [{"byteLength": len(buffer), "uri": "data:;base64," + base64.b64encode(buffer).decode()}, {"byteLength": 1116} | plain],
        "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5123, "count": 40, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 150, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    }).encode()  # fmt: skip


@pytest.mark.parametrize("extension", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
@pytest.mark.parametrize("fallback", [True, False])
def test_model(extension: str, fallback: bool) -> None:
    """A compressed model is read from its compressed bytes, whether it has others or not; decompressed views count for the limits."""
    geometry: Any = read(document(extension, fallback=fallback), "model.gltf", notes=Notes()).shapes()[0][1].geometry
    assert geometry.positions.tolist() == vertices()[:, :6].copy().view("<u2").astype(float).tolist()
    assert geometry.triangles.tolist() == decode_triangles(stream(TRIANGLES), 159)[:150].reshape(-1, 3).tolist()


def test_broken_model() -> None:
    """A broken stream, or more than the limits allow, is the fault of its place in the file."""
    notes = Notes()
    broken = document("KHR_meshopt_compression", fallback=False).replace(b'"count": 40, "mode"', b'"count": 41, "mode"')
    with pytest.raises(FileFormatError, match="byteLength"):
        read(broken, "model.gltf", notes=notes)
    with pytest.raises(FileFormatError, match="max_file_bytes"):
        read(document("KHR_meshopt_compression", fallback=False), "model.gltf", notes=notes, limits=Limits(max_file_bytes=700))


# --- against the encoder itself ---------------------------------------------------------------------------------------------------

ENCODE = """
import { MeshoptEncoder as E } from 'meshoptimizer';
import fs from 'fs';
await E.ready;
const cases = JSON.parse(fs.readFileSync(0));
console.log(JSON.stringify(cases.map(c => Buffer.from(c.mode == 'ATTRIBUTES'
    ? E.encodeVertexBufferLevel(Buffer.from(c.data, 'base64'), c.count, c.stride, c.level, c.version)
    : E.encodeGltfBuffer(Buffer.from(c.data, 'base64'), c.count, c.stride, c.mode)).toString('base64'))));
"""


def test_encoder_when_it_is_there() -> None:
    """Whatever meshoptimizer writes of random bytes, slopes and floats, at every level, comes back to the bit."""
    node, root = shutil.which("node"), Path(__file__).resolve().parents[3]
    if node is None or not (root / "node_modules" / "meshoptimizer").is_dir():
        pytest.skip("needs node and its package meshoptimizer (npm install meshoptimizer)")
    rng = np.random.default_rng(5)
    cases: list[dict[str, Any]] = []
    for stride in (4, 12, 64, 256):
        for count in (1, 17, 257, 500):
            given = (
                rng.integers(0, 256, (count, stride)), np.cumsum(rng.integers(-2, 3, (count, stride)), axis=0) & 255,
                np.cumsum(rng.normal(size=(count, stride // 4)), axis=0).astype("<f4").view(np.uint8), rng.random((count, stride)) < 0.02,
            )  # fmt: skip
            for values in given:
                data = base64.b64encode(values.astype(np.uint8).tobytes()).decode()
                for level, version in ((2, 0), (0, 1), (2, 1), (3, 1)):
                    case = {"data": data, "count": count, "stride": stride, "mode": "ATTRIBUTES", "level": level, "version": version}
                    cases.append(case)
    for values in (rng.integers(0, 1000, 900), np.arange(900), np.repeat(np.arange(300), 3) + np.tile([0, 1, 9], 300)):
        data = base64.b64encode(values.astype("<u4").tobytes()).decode()
        cases.append({"data": data, "count": 900, "stride": 4, "mode": "INDICES"})
    encoded = subprocess.run(
        [node, "--input-type=module", "-e", ENCODE], input=json.dumps(cases), capture_output=True, text=True, check=True, cwd=root
    )
    for case, text in zip(cases, json.loads(encoded.stdout), strict=True):
        assert decode(stream(text), case["count"], case["stride"], case["mode"]).tobytes() == stream(case["data"])
