"""glTF as it should not be: each bad file gets one line that says where, or is drawn as far as it can be.

Whatever a file holds, only a LimnerError may come of it.
"""

from __future__ import annotations

import copy
import json
import os
import random
import struct
import tracemalloc
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.errors import FileFormatError, LimnerError, LimnerWarning, UnsupportedError
from limner.files.gltf import read
from limner.files.load import load
from limner.mesh.mesh import Mesh


def drawn(data: bytes, path: Path) -> int:
    """Read quietly and return how many triangles there are; the scene must hold together."""
    scene = read(data, path)
    assert np.isfinite(scene.bounds()).all() or not scene.shapes()
    return sum(len(shape.geometry.triangles) for _, shape in scene.shapes() if isinstance(shape.geometry, Mesh))


def test_index_beyond_the_vertices(writer: Any, tmp_path: Path) -> None:
    """The triangle that refers to vertex 9 of 3 is left out, the other is drawn."""
    writer.primitive([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 9]])
    with pytest.warns(LimnerWarning, match=r"/meshes/0/primitives/0/indices: 1 triangles refer to vertices"):
        scene = load(writer.save(tmp_path))
    np.testing.assert_array_equal(scene.shapes()[0][1].geometry.triangles, [[0, 1, 2]])  # type: ignore[union-attr]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_positions_that_are_no_numbers(writer: Any, tmp_path: Path, bad: float) -> None:
    """Triangles with such a corner are left out, and the mesh is finite."""
    writer.primitive([[0, 0, 0], [1, 0, 0], [0, 1, 0], [bad, 0, 0]], [[0, 1, 2], [0, 1, 3]])
    with pytest.warns(LimnerWarning, match="POSITION: 1 triangles with positions that are not finite"):
        scene = load(writer.save(tmp_path))
    assert np.isfinite(scene.bounds()).all()
    assert len(scene.shapes()[0][1].geometry.triangles) == 1  # type: ignore[union-attr]


def test_degenerate_triangles_are_kept_and_counted(writer: Any, tmp_path: Path) -> None:
    """A triangle without area stays, so that triangle numbers stay, and is counted in a note."""
    writer.primitive([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]], [[0, 1, 2], [0, 1, 3], [0, 0, 1]])
    with pytest.warns(LimnerWarning, match="2 triangles have no area"):
        scene = load(writer.save(tmp_path))
    assert len(scene.shapes()[0][1].geometry.triangles) == 3  # type: ignore[union-attr]


def test_bad_normals_and_tangents_are_repaired(triangle: Any, tmp_path: Path) -> None:
    """Long normals become unit, zero and NaN ones those of the surface; tangents stand on them, their signs are 1 or -1."""
    attributes = triangle.document["meshes"][0]["primitives"][0]["attributes"]
    attributes["NORMAL"] = triangle.accessor([[0, 0, 5], [0, 0, 0], [np.nan, 0, 1]])
    attributes["TANGENT"] = triangle.accessor([[2, 0, 0, 0.5], [0, 0, 0, -1], [np.inf, 0, 0, 1]])
    mesh = load(triangle.save(tmp_path)).shapes()[0][1].geometry
    assert isinstance(mesh, Mesh)
    assert mesh.tangents is not None
    np.testing.assert_allclose(mesh.normals, [[0, 0, 1]] * 3)
    np.testing.assert_allclose(np.linalg.norm(mesh.tangents[:, :3], axis=1), 1.0, rtol=1e-6)
    np.testing.assert_allclose(mesh.tangents[:, 2], 0.0)
    np.testing.assert_array_equal(mesh.tangents[:, 3], [1, -1, 1])


def test_one_bad_primitive_of_two(triangle: Any, tmp_path: Path) -> None:
    """The good one is drawn, the bad one is named with its place; alone, the bad one is an error with that place."""
    triangle.primitive([[0, 0, 0]] * 3)["attributes"]["POSITION"] = 99
    with pytest.warns(LimnerWarning, match=r"/meshes/0/primitives/1.*attributes/POSITION: must be an index below \d+, got 99"):
        assert len(load(triangle.save(tmp_path)).shapes()) == 1
    triangle.document["meshes"][0]["primitives"].pop(0)
    with pytest.raises(FileFormatError, match="got 99") as caught:
        load(triangle.save(tmp_path))
    assert caught.value.position == "/meshes/0/primitives/0/attributes/POSITION"


@pytest.mark.parametrize("count", [2**62, 10**9, -1, 0, 1.5, "3", None, True])
def test_absurd_counts_allocate_nothing(triangle: Any, tmp_path: Path, count: Any) -> None:
    """A count that the bytes do not bear out is an error at its accessor, before any memory is taken."""
    triangle.document["accessors"][0]["count"] = count
    data = triangle.glb()
    tracemalloc.start()
    with pytest.raises(FileFormatError, match=r"/accessors/0|max_triangles"):
        read(data, tmp_path / "a.glb")
    assert tracemalloc.get_traced_memory()[1] < 5_000_000
    tracemalloc.stop()


def test_accessors_without_data_are_bounded(triangle: Any, tmp_path: Path) -> None:
    """Zeros that no bytes stand for are made only in small numbers."""
    del triangle.document["accessors"][0]["bufferView"]
    triangle.document["accessors"][0]["count"] = 10**8
    with pytest.raises(FileFormatError, match="without data"):
        read(triangle.glb(), tmp_path / "a.glb")


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ("byteOffset", 2**62), ("byteLength", 2**62), ("byteLength", 20), ("byteStride", 2**62), ("byteStride", 8),
        ("byteStride", 0), ("buffer", 5), ("byteOffset", -4),
    ],
)  # fmt: skip
def test_views_beyond_their_buffers(triangle: Any, tmp_path: Path, place: str, value: int) -> None:
    """Offsets, lengths and strides that lead out of the bytes are errors that name the view or the accessor."""
    triangle.document["bufferViews"][0][place] = value
    with pytest.raises(FileFormatError, match=r"/bufferViews/0|/accessors/0"):
        read(triangle.glb(), tmp_path / "a.glb")


@pytest.mark.parametrize("field", ["indices", "values"])
@pytest.mark.parametrize("value", [{"bufferView": 77}, {"byteOffset": 10**9}, {"componentType": 5126}, {"count": 9}])
def test_bad_sparse_accessors(triangle: Any, tmp_path: Path, field: str, value: dict[str, int]) -> None:
    """Sparse parts are held to the same bounds."""
    sparse = {
        "count": 1,
        "indices": {"bufferView": triangle.view(b"\x07\0\0\0"), "componentType": 5121},
        "values": {"bufferView": triangle.view(b"\0" * 12)},
    }
    triangle.document["accessors"][0]["sparse"] = sparse
    sparse[field].update(value)  # type: ignore[attr-defined]
    with pytest.raises(FileFormatError):
        read(triangle.glb(), tmp_path / "a.glb")


@pytest.mark.parametrize(
    "uri",
    [
        "../secret.bin", "a/../../secret.bin", "%2e%2e/secret.bin", "/etc/passwd", "file:///etc/passwd", "http://x.org/a.bin",
        "C:\\secret.bin", "..\\secret.bin", "\\\\host\\share", "a\0b", "", "//host/x",
    ],
)  # fmt: skip
def test_references_out_of_the_folder(triangle: Any, tmp_path: Path, uri: str) -> None:
    """A buffer that lies elsewhere is refused with the whole file, though nothing may use it."""
    folder = tmp_path / "model"
    folder.mkdir()
    (tmp_path / "secret.bin").write_bytes(bytes(triangle.buffer))
    data = triangle.separate(folder)
    document = json.loads(data)
    document["buffers"].append({"uri": uri, "byteLength": 4})
    with pytest.raises(FileFormatError, match="/buffers/1/uri"):
        read(json.dumps(document).encode(), folder / "a.gltf")


def test_pictures_out_of_the_folder(rich: Any, tmp_path: Path) -> None:
    """A picture that lies elsewhere is left out with a warning."""
    rich.document["images"][0] = {"uri": "../../picture.png"}
    with pytest.warns(LimnerWarning, match=r"/materials/0/.* and 4 more: drawn without, /images/0/uri: must stay inside"):
        scene = load(rich.save(tmp_path))
    assert scene.shapes()[0][1].materials[0].base_color_texture is None  # type: ignore[union-attr]


@pytest.mark.parametrize("damage", [b"", b"no picture at all", b"\x89PNG\r\n\x1a\n", None])
def test_missing_and_broken_pictures(rich: Any, tmp_path: Path, damage: bytes | None) -> None:
    """A picture that is missing, empty or broken is left out with a warning; the model is drawn."""
    rich.document["images"][0] = {"uri": "picture.png"}
    if damage is not None:
        (tmp_path / "picture.png").write_bytes(damage)
    with pytest.warns(LimnerWarning, match="/materials/0/.*/baseColorTexture and 4 more: drawn without, /images/0"):
        assert len(load(rich.save(tmp_path)).shapes()) == 1


def test_missing_buffer(triangle: Any, tmp_path: Path) -> None:
    """A .bin that is not there is named."""
    data = triangle.separate(tmp_path, uri="elsewhere.bin")
    with pytest.raises(FileFormatError, match=r"/buffers/0/uri: 'elsewhere.bin' is missing"):
        read(data, tmp_path / "a.gltf")


@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
def test_truncated_buffer(triangle: Any, tmp_path: Path) -> None:
    """A .bin that ends early gives what lies within it, and an error where that is nothing."""
    triangle.primitive([[0, 0, 0], [2, 0, 0], [0, 2, 0]])
    data = triangle.separate(tmp_path)
    whole = (tmp_path / "model.bin").read_bytes()
    (tmp_path / "model.bin").write_bytes(whole[:-4])
    (tmp_path / "a.gltf").write_bytes(data)
    with pytest.warns(LimnerWarning, match="/buffers/0: is cut off"):
        assert len(load(tmp_path / "a.gltf").shapes()) == 1
    (tmp_path / "model.bin").write_bytes(whole[:4])
    with pytest.raises(FileFormatError, match="/bufferViews/"):
        load(tmp_path / "a.gltf")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_only_regular_files_are_opened(triangle: Any, tmp_path: Path) -> None:
    """A pipe or a folder in place of the buffer is an error and not a wait without end."""
    data = triangle.separate(tmp_path, uri="pipe")
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(FileFormatError, match="no regular file"):
        read(data, tmp_path / "a.gltf")
    (tmp_path / "pipe").unlink()
    (tmp_path / "pipe").mkdir()
    with pytest.raises(FileFormatError, match="is a folder"):
        read(data, tmp_path / "a.gltf")


def test_cycles_are_named(triangle: Any, tmp_path: Path) -> None:
    """A cycle is refused with the nodes on it, shown or not."""
    triangle.document["nodes"] = [{"mesh": 0}, {"children": [2], "name": "two"}, {"children": [3]}, {"children": [1]}]
    with pytest.raises(FileFormatError, match=r"cycle: 1 'two' -> 2 -> 3 -> 1 'two'"):
        read(triangle.glb(), tmp_path / "a.glb")
    triangle.document["nodes"] = [{"mesh": 0, "children": [0]}]
    with pytest.raises(FileFormatError, match="cycle: 0 -> 0"):
        read(triangle.glb(), tmp_path / "a.glb")


def test_node_with_two_parents(triangle: Any, tmp_path: Path) -> None:
    """It is shown below both, and that is said."""
    triangle.document["scenes"] = [{"nodes": [0, 1]}]
    triangle.document["nodes"] = [{"children": [2]}, {"children": [2], "translation": [5, 0, 0]}, {"mesh": 0}]
    with pytest.warns(LimnerWarning, match="/nodes/2 have more than one parent"):
        shapes = load(triangle.save(tmp_path)).shapes()
    assert [placed.world_from_object[0, 3] for placed, _ in shapes] == [0.0, 5.0]


def test_doubling_graph_is_counted_not_walked(triangle: Any, tmp_path: Path) -> None:
    """Sixty nodes that each show the next one twice are 2^60 nodes, and are refused at once."""
    n = 60
    triangle.document["nodes"] = [{"children": [i + 1, i + 1]} for i in range(n)] + [{"mesh": 0}]
    with pytest.raises(FileFormatError, match="max_nodes"):
        read(triangle.glb(), tmp_path / "a.glb")


def test_deep_graphs_and_deep_json(triangle: Any, tmp_path: Path) -> None:
    """A chain of many nodes, and JSON nested without end, are errors and not stack overflows."""
    n = 20_000
    triangle.document["nodes"] = [{"children": [i + 1]} for i in range(n)] + [{"mesh": 0}]
    with pytest.raises(FileFormatError, match="deeper than"):
        read(triangle.glb(), tmp_path / "a.glb")
    with pytest.raises(FileFormatError, match="JSON"):
        read(b'{"asset":' + b"[" * 200_000, tmp_path / "a.gltf")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "Expecting value"), (b"[]", "must be an object"), (b"{", "line 1"), (b'{"asset": NaN}', "NaN"),
        (b"\xff\xfe{", "UTF-8"), (b'{"asset": {"version": "2.0"}, "nodes": 3}', "/nodes: must be an array"),
        (b'{"asset": {"version": "2.0"}, "meshes": [1], "nodes": [{"mesh": 0}]}', ""), (b"{}", "/asset: is missing"),
        (b'{"asset": {"version": "2.0"}, "nodes": [7]}', "/nodes/0: must be an object"),
        (b'{"a": 1' + b"0" * 5000 + b"}", "JSON"),
    ],
)  # fmt: skip
def test_text_that_is_no_gltf(tmp_path: Path, data: bytes, message: str) -> None:
    """Each kind of nonsense gets a line that says what it is."""
    if not message:
        assert drawn(data, tmp_path / "a.gltf") == 0
        return
    with pytest.raises(FileFormatError, match=message) as caught:
        read(data, tmp_path / "a.gltf")
    assert "\n" not in str(caught.value)


def test_bad_containers(triangle: Any, tmp_path: Path) -> None:
    """Wrong magic, wrong version, wrong first chunk: each its own line."""
    whole = triangle.glb()
    path = tmp_path / "a.glb"
    with pytest.raises(FileFormatError, match='must begin with "glTF"'):
        read(b"glTX" + whole[4:], path)
    with pytest.raises(UnsupportedError, match="version 1 "):
        read(whole[:4] + struct.pack("<I", 1) + whole[8:], path)
    with pytest.raises(FileFormatError, match="first chunk"):
        read(whole[:16] + b"NOSJ" + whole[20:], path)
    assert drawn(whole + b"trailing", path) == 1
    huge = whole[:12] + struct.pack("<I", 2**32 - 1) + whole[16:]
    with pytest.raises(FileFormatError, match="JSON chunk is cut off"):
        read(huge, path)


@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
def test_truncation_at_every_seventh_byte(rich: Any, tmp_path: Path) -> None:
    """A file cut off anywhere is drawn in part or refused; never anything else."""
    whole = rich.glb()
    outcomes, said = set(), []
    for end in range(0, len(whole), 7):
        try:
            outcomes.add(drawn(whole[:end], tmp_path / "a.glb"))
        except LimnerError as error:
            said.append(str(error))
    assert outcomes == {2}
    assert not any("\n" in line for line in said)


@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
@pytest.mark.parametrize("seed", range(4))
def test_flipped_bytes(rich: Any, tmp_path: Path, seed: int) -> None:
    """Random bytes, one to five at a time, in the whole file: only LimnerErrors."""
    whole = rich.glb()
    chance = random.Random(seed)
    for _ in range(150):
        data = bytearray(whole)
        for _ in range(chance.randint(1, 5)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        try:
            drawn(bytes(data), tmp_path / "a.glb")
        except LimnerError:
            continue


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Yield each place of a document as container and key."""
    keys = value.keys() if isinstance(value, dict) else range(len(value))
    for key in list(keys):
        yield value, key
        if isinstance(value[key], (dict, list)):
            yield from places(value[key])


def test_every_value_of_every_wrong_type(rich: Any, tmp_path: Path) -> None:
    """Every value of the JSON, one after the other, becomes null, -1, 2^62, 1e308, text, a list, an object, true, or goes."""
    rich.document["extensionsUsed"] = ["KHR_materials_unlit"]
    wrong = [None, -1, 2**62, 1e308, 0.5, "x", [], {}, True, ...]
    original = json.loads(rich.embedded())
    said: set[str] = set()
    n = sum(1 for _ in places(original))
    assert n > 200
    for number in range(n):
        for value in wrong:
            document = copy.deepcopy(original)
            container, key = next(place for i, place in enumerate(places(document)) if i == number)
            if value is ...:
                del container[key]
            else:
                container[key] = value
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("error")
                    drawn(json.dumps(document).encode(), tmp_path / "a.gltf")
            except LimnerError as error:
                said.add(str(error))
    assert not any("\n" in line for line in said)


@pytest.mark.parametrize("n_notes", [1000])
def test_notes_are_bounded(triangle: Any, tmp_path: Path, n_notes: int) -> None:
    """A thousand alike remarks are one with a number, a thousand different ones are cut short."""
    mesh = triangle.document["meshes"][0]
    mesh["primitives"] += [{"attributes": {"_N": i}} for i in range(n_notes)]
    notes = read(triangle.glb(), tmp_path / "a.glb").notes
    assert notes == (f"/meshes/0/primitives/1 and {n_notes - 1} more: left out, it has no positions",)
    triangle.document["extensionsUsed"] = [f"ACME_{i}" for i in range(n_notes)]
    notes = read(triangle.glb(), tmp_path / "a.glb").notes
    assert len(notes) == 101
    assert "more such remarks" in notes[-1]
