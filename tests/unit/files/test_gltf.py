"""glTF 2.0 as it should be: what the file says is what the scene holds."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import FileFormatError, LimnerWarning, UnsupportedError
from limner.files.gltf import read
from limner.files.gltf_material import turned_transform
from limner.files.gltf_mesh import fan_triangles, strip_triangles
from limner.files.limits import Limits
from limner.files.load import load
from limner.mesh.mesh import Mesh
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.light import DirectionalLight, PointLight, SpotLight
from limner.scene.material import MetallicRoughness
from limner.scene.scene import Scene

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


def only_mesh(scene: Scene) -> Mesh:
    """Return the geometry of a scene's only shape."""
    ((_, shape),) = scene.shapes()
    assert isinstance(shape.geometry, Mesh)
    return shape.geometry


def test_three_encodings_are_one_scene(rich: Any, tmp_path: Path) -> None:
    """A GLB, a data: URI and a separate file with a percent-encoded name hold the same numbers."""
    scenes = [
        read(rich.glb(), tmp_path / "a.glb"),
        read(rich.embedded(), tmp_path / "a.gltf"),
        read(rich.separate(tmp_path, "my%20b%C3%BCffer.bin", "my büffer.bin"), tmp_path / "a.gltf"),
    ]
    meshes = [only_mesh(scene) for scene in scenes]
    for field in ("positions", "triangles", "normals", "tangents", "uvs", "colors"):
        for mesh in meshes[1:]:
            np.testing.assert_array_equal(getattr(mesh, field), getattr(meshes[0], field))
    assert [scene.notes for scene in scenes] == [()] * 3


@pytest.mark.parametrize(("dtype", "limit"), [("i1", 127), ("u1", 255), ("i2", 32767), ("u2", 65535), ("u4", 2**32 - 1)])
def test_normalized_integers(writer: Any, tmp_path: Path, dtype: str, limit: int) -> None:
    """The greatest integer is 1, half of it a half, and the least of a signed type is -1 and not below (3.6.2.2)."""
    least = -limit - 1 if dtype[0] == "i" else 0
    coordinates = [[limit, 0], [limit // 2, limit], [least, 0]]
    primitive = writer.primitive(SQUARE[:3])
    primitive["attributes"]["TEXCOORD_0"] = writer.accessor(coordinates, dtype, normalized=True)
    uvs = only_mesh(load(writer.save(tmp_path))).uvs
    assert uvs is not None
    np.testing.assert_allclose(uvs[:, 0], [1.0, (limit // 2) / limit, -1.0 if least else 0.0], rtol=1e-6)
    np.testing.assert_allclose(uvs[:, 1], [1.0, 0.0, 1.0], atol=1e-6)


@pytest.mark.parametrize("dtype", ["i1", "u1", "i2", "u2"])
def test_integer_positions_are_taken_as_they_stand(writer: Any, tmp_path: Path, dtype: str) -> None:
    """KHR_mesh_quantization: positions of small integers, not normalised, padded to four bytes."""
    primitive = writer.primitive(SQUARE[:3])
    rows = np.zeros((3, 4), dtype=dtype)
    rows[:, :3] = [[0, 0, 0], [100, 0, 0], [0, 50, 7]]
    view = writer.view(rows.tobytes(), byteStride=rows.strides[0])
    writer.document["accessors"].append({
        "bufferView": view, "componentType": {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123}[dtype], "count": 3,
        "type": "VEC3",
    })  # fmt: skip
    primitive["attributes"]["POSITION"] = len(writer.document["accessors"]) - 1
    np.testing.assert_array_equal(only_mesh(load(writer.save(tmp_path))).positions, rows[:, :3])


@pytest.mark.parametrize("dtype", ["u1", "u2", "u4"])
def test_index_types(writer: Any, tmp_path: Path, dtype: str) -> None:
    """All three index types give int32 triangles in the file's order."""
    writer.primitive(SQUARE, [[0, 1, 2], [0, 2, 3]], dtype)
    triangles = only_mesh(load(writer.save(tmp_path))).triangles
    assert triangles.dtype == np.int32
    np.testing.assert_array_equal(triangles, [[0, 1, 2], [0, 2, 3]])


def test_interleaved_and_offset(writer: Any, tmp_path: Path) -> None:
    """Position and normal in one view, 28 bytes apart, at an offset: both come out whole, contiguous and aligned."""
    rows = np.zeros((4, 7), dtype="<f4")
    rows[:, :3], rows[:, 3:6], rows[:, 6] = SQUARE, (0, 0, 1), 9.0
    view = writer.view(b"\x7f" * 8 + rows.tobytes(), byteStride=28)
    for offset in (8, 20):
        writer.document["accessors"].append({
            "bufferView": view, "byteOffset": offset, "componentType": 5126, "count": 4, "type": "VEC3",
        })  # fmt: skip
    indices = writer.accessor([0, 1, 2, 0, 2, 3], "u2")
    writer.document["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": indices})
    mesh = only_mesh(load(writer.save(tmp_path)))
    np.testing.assert_array_equal(mesh.positions, SQUARE)
    np.testing.assert_array_equal(mesh.normals, [[0, 0, 1]] * 4)
    assert mesh.positions.flags.c_contiguous
    assert mesh.positions.flags.aligned


@pytest.mark.parametrize("based", [True, False])
def test_sparse_accessor(writer: Any, tmp_path: Path, based: bool) -> None:
    """Sparse values replace those of the base view, or zeros where there is none; the base is not changed."""
    primitive = writer.primitive(SQUARE[:3])
    accessor = writer.document["accessors"][0]
    accessor["sparse"] = {
        "count": 2,
        "indices": {"bufferView": writer.view(np.array([1, 2], "<u1").tobytes()), "componentType": 5121},
        "values": {"bufferView": writer.view(np.array([[5, 5, 5], [6, 0, 6]], "<f4").tobytes())},
    }
    if not based:
        del accessor["bufferView"]
    assert primitive["attributes"]["POSITION"] == 0
    expected = [[0, 0, 0], [5, 5, 5], [6, 0, 6]]
    np.testing.assert_array_equal(only_mesh(load(writer.save(tmp_path))).positions, expected)


def test_strips_and_fans_cover_the_same_square() -> None:
    """A strip and a fan over a convex polygon turn alike, triangle by triangle, and sum to its area."""
    angles = np.linspace(0.0, 2.0 * math.pi, 9)[:-1]
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    zigzag = np.array([0, 1, 7, 2, 6, 3, 5, 4])
    for triangles in (strip_triangles(zigzag), fan_triangles(np.arange(8))):
        a, b, c = (ring[triangles[:, corner]] for corner in range(3))
        (e_x, e_y), (f_x, f_y) = (b - a).T, (c - a).T
        areas = (e_x * f_y - e_y * f_x) / 2.0
        assert (areas > 0.0).all()
        np.testing.assert_allclose(areas.sum(), 8.0 / 2.0 * math.sin(2.0 * math.pi / 8.0))


@pytest.mark.parametrize(("mode", "n_triangles"), [(4, 1), (5, 2), (6, 2)])
def test_modes_without_indices(writer: Any, tmp_path: Path, mode: int, n_triangles: int) -> None:
    """Four vertices without indices are one triangle and a rest, a strip of two, or a fan of two."""
    writer.primitive(SQUARE, mode=mode)
    if mode == 4:
        with pytest.warns(LimnerWarning, match="no multiple of three"):
            mesh = only_mesh(load(writer.save(tmp_path)))
    else:
        mesh = only_mesh(load(writer.save(tmp_path)))
    assert len(mesh.triangles) == n_triangles


@given(
    offset=st.tuples(st.floats(-2, 2), st.floats(-2, 2)),
    scale=st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
    rotation=st.floats(-7, 7),
    u=st.floats(-2, 2),
    v=st.floats(-2, 2),
)
def test_texture_transform(offset: tuple[float, float], scale: tuple[float, float], rotation: float, u: float, v: float) -> None:
    """Turning after the file's transform is transforming, our way, after turning: one texel, whichever way it is reached."""
    c, s = math.cos(rotation), math.sin(rotation)
    x, y = scale[0] * u, scale[1] * v
    by_file = (offset[0] + c * x + s * y, offset[1] - s * x + c * y)
    (t_u, t_v), angle, (s_u, s_v) = turned_transform(offset, rotation, scale)
    c, s = math.cos(angle), math.sin(angle)
    x, y = s_u * u, s_v * (1.0 - v)
    ours = (t_u + c * x - s * y, t_v + s * x + c * y)
    assert ours == pytest.approx((by_file[0], 1.0 - by_file[1]), abs=1e-9)


def test_texture_transform_turns_as_the_sample_model_does() -> None:
    """Khronos' TextureTransformTest, quad "Rotation": at the green marker the rotated quad shows the arrow's tip.

    On a unit square whose corner (0, 0) of the file is top left, the tip lies 1.1 along the diagonal; rotated by 22.5 degrees
    the marker stands at (0.421, 1.016) right of and below that corner.
    """
    (t_u, t_v), angle, _ = turned_transform((0.0, 0.0), 0.39269908169872414, (1.0, 1.0))
    h = np.array([-0.07904822439840126 + 0.5, -0.5162674857624154 + 0.5])
    c, s = math.cos(angle), math.sin(angle)
    found = np.array([t_u + c * h[0] - s * h[1], t_v + s * h[0] + c * h[1]])
    np.testing.assert_allclose(found, [0.2778174593052023 + 0.5, -0.2778174593052023 + 0.5], atol=1e-6)


def test_material(rich: Any, tmp_path: Path) -> None:
    """Every field of the core material, the sampler and three extensions arrive."""
    material = read(rich.glb(), tmp_path / "a.glb").shapes()[0][1].materials[0]
    assert isinstance(material, MetallicRoughness)
    assert (material.metallic, material.roughness, material.alpha) == (0.1, 0.2, 0.5)
    assert (material.alpha_mode, material.alpha_cutoff, material.double_sided, material.unlit) == ("mask", 0.3, True, True)
    assert material.emission == (4.0, 2.0, 0.0)
    assert (material.normal_scale, material.occlusion_strength) == (0.5, 0.5)
    base, data = material.base_color_texture, material.metallic_roughness_texture
    assert base is not None
    assert data is not None
    assert (base.wrap_u, base.wrap_v, base.filter) == ("clamp", "mirror", "bilinear")
    assert (base.texels.srgb, data.texels.srgb) == (True, False)
    assert np.shares_memory(base.texels.pixels, data.texels.pixels)
    assert data.texels is material.normal_texture.texels  # type: ignore[union-attr]


def test_default_material(triangle: Any, tmp_path: Path) -> None:
    """A primitive without material has glTF's default one: white metal, roughness 1 (3.9.6)."""
    assert load(triangle.save(tmp_path)).shapes()[0][1].materials == (MetallicRoughness(),)


@pytest.mark.parametrize("kind", ["PNG", "WEBP"])
def test_pictures_are_turned_once(triangle: Any, tmp_path: Path, kind: str) -> None:
    """The file's (0, 0) is the top left texel: v = 1 here, and the last row of the texels."""
    pixels = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
    texture = triangle.picture(pixels, kind)
    if kind == "WEBP":
        triangle.document["textures"][0] = {"extensions": {"EXT_texture_webp": {"source": 0}}}
    primitive = triangle.document["meshes"][0]["primitives"][0]
    primitive["attributes"]["TEXCOORD_0"] = triangle.accessor([[0, 0], [1, 0], [0, 0.25]])
    primitive["material"] = 0
    triangle.document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}}]
    ((_, shape),) = load(triangle.save(tmp_path)).shapes()
    assert isinstance(shape.geometry, Mesh)
    np.testing.assert_array_equal(shape.geometry.uvs, np.float32([[0, 1], [1, 1], [0, 0.75]]))
    material = shape.materials[0]
    assert isinstance(material, MetallicRoughness)
    assert material.base_color_texture is not None
    np.testing.assert_array_equal(material.base_color_texture.texels.pixels[::-1, :, :3], pixels)


def test_shared_meshes_are_shared_objects(triangle: Any, tmp_path: Path) -> None:
    """Two nodes with one mesh, and a second mesh over the same accessors, show one Mesh object."""
    triangle.document["nodes"] = [{"mesh": 0, "children": [1, 2]}, {"mesh": 0}, {"mesh": 1}]
    triangle.document["meshes"].append({"primitives": [dict(triangle.document["meshes"][0]["primitives"][0])]})
    shapes = load(triangle.save(tmp_path)).shapes()
    assert len(shapes) == 3
    assert len({id(shape.geometry) for _, shape in shapes}) == 1


def test_nodes_place_what_they_hold(triangle: Any, tmp_path: Path) -> None:
    """Translation, rotation, scale, in that order from the left; a matrix is column by column."""
    half = math.sqrt(0.5)
    triangle.document["nodes"] = [
        {"name": "a", "translation": [1, 2, 3], "rotation": [0, 0, half, half], "scale": [2, 1, 1], "children": [1]},
        {"name": "b", "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1]},
    ]
    ((placed, _),) = load(triangle.save(tmp_path)).shapes()
    assert placed.path == "world/a/b"
    np.testing.assert_allclose(placed.world_from_object @ [0, 0, 0, 1], [1 - 20, 2 + 20, 33, 1], atol=1e-12)
    np.testing.assert_allclose(placed.world_from_object @ [1, 0, 0, 0], [0, 2, 0, 0], atol=1e-12)


def test_cameras_and_lights(rich: Any, tmp_path: Path) -> None:
    """Angles in degrees, magnifications as a height, lights with their cones and ranges, each at its node."""
    scene = read(rich.glb(), tmp_path / "a.glb")
    perspective, orthographic = scene.cameras()
    assert isinstance(perspective, PerspectiveCamera)
    assert perspective.yfov_degrees == pytest.approx(math.degrees(0.7))
    assert (perspective.near, perspective.far, perspective.aspect) == (0.1, 100.0, 1.5)
    np.testing.assert_allclose(perspective.world_from_camera[:3, 3], [0, 0, 5])
    assert isinstance(orthographic, OrthographicCamera)
    assert (orthographic.height, orthographic.aspect) == (2.0, 2.0)
    point, spot, sun = (light for _, light in scene.lights())
    assert isinstance(point, PointLight)
    assert (point.intensity, point.color, point.range) == (20.0, (1.0, 0.9, 0.8), 5.0)
    assert isinstance(spot, SpotLight)
    assert (spot.inner_degrees, spot.outer_degrees) == pytest.approx((math.degrees(0.1), math.degrees(0.5)))
    assert isinstance(sun, DirectionalLight)


def test_infinite_perspective(rich: Any, tmp_path: Path) -> None:
    """Without zfar the camera sees to infinity: far is None."""
    del rich.document["cameras"][0]["perspective"]["zfar"]
    assert read(rich.glb(), tmp_path / "a.glb").cameras()[0].far is None


def test_the_default_scene_is_read(triangle: Any, tmp_path: Path) -> None:
    """`scene` picks one of several; without scenes all nodes without parents are shown."""
    document = triangle.document
    document.update(scene=1, scenes=[{"nodes": []}, {"nodes": [0], "name": "second"}])
    scene = load(triangle.save(tmp_path))
    assert (len(scene.shapes()), scene.name) == (1, "second")
    del document["scene"], document["scenes"]
    document["nodes"] = [{"children": [1]}, {"mesh": 0}, {"mesh": 0}]
    scene = load(triangle.save(tmp_path))
    assert [placed.path for placed, _ in scene.shapes()] == ["world/0/0", "world/1"]


def test_gpu_instances_become_nodes(triangle: Any, tmp_path: Path) -> None:
    """EXT_mesh_gpu_instancing: one node for each place, all with one Mesh."""
    places = triangle.accessor([[1, 0, 0], [2, 0, 0], [3, 0, 0]])
    triangle.document["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}
    shapes = load(triangle.save(tmp_path)).shapes()
    assert [placed.world_from_object[0, 3] for placed, _ in shapes] == [1.0, 2.0, 3.0]
    assert len({id(shape.geometry) for _, shape in shapes}) == 1


def test_hidden_nodes(triangle: Any, tmp_path: Path) -> None:
    """KHR_node_visibility hides a node and what is below it."""
    triangle.document["nodes"] = [{"children": [1], "extensions": {"KHR_node_visibility": {"visible": False}}}, {"mesh": 0}]
    assert load(triangle.save(tmp_path)).shapes() == []


def test_unused_vertices_are_left_out(writer: Any, tmp_path: Path) -> None:
    """A primitive that uses a corner of a large shared vertex buffer keeps only that corner, attributes and all."""
    positions = np.arange(300, dtype=np.float32).reshape(100, 3) ** 2
    primitive = writer.primitive(positions, [[90, 95, 99]])
    primitive["attributes"]["TEXCOORD_0"] = writer.accessor(positions[:, :2])
    mesh = only_mesh(load(writer.save(tmp_path)))
    np.testing.assert_array_equal(mesh.positions[mesh.triangles[0]], positions[[90, 95, 99]])
    assert mesh.uvs is not None
    np.testing.assert_array_equal(mesh.uvs[mesh.triangles[0], 0], positions[[90, 95, 99], 0])
    assert len(mesh.positions) == 3


def test_unknown_extensions_are_named(triangle: Any, tmp_path: Path) -> None:
    """What is used is noted; what is required and unknown is a warning, and drawn all the same."""
    triangle.document.update(extensionsUsed=["ACME_dust", "ACME_magic"], extensionsRequired=["ACME_magic"])
    with pytest.warns(LimnerWarning, match="requires 'ACME_magic'"):
        scene = load(triangle.save(tmp_path))
    assert len(scene.shapes()) == 1
    assert any("ACME_dust" in note for note in scene.notes)


def test_scene_by_name(triangle: Any, tmp_path: Path) -> None:
    """`load` shows any of a file's scenes, by name or number; one that is not there is refused with those that are."""
    triangle.document["scenes"] = [{"nodes": [0], "name": "shop"}, {"nodes": [], "name": "void"}]
    path = triangle.save(tmp_path)
    assert [load(path, scene=wanted).name for wanted in (None, 0, "shop")] == ["shop"] * 3
    with pytest.warns(LimnerWarning, match="shows none"):
        assert not load(path, scene="void").shapes()
    for wanted in ("bar", 2, -1):
        with pytest.raises(FileFormatError, match="its 2 scenes are 'shop', 'void'"):
            load(path, scene=wanted)
    (tmp_path / "model.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(UnsupportedError, match="only glTF files"):
        load(tmp_path / "model.obj", scene=0)


@pytest.mark.parametrize("fallback", [True, False])
def test_draco(triangle: Any, tmp_path: Path, fallback: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without its library compressed geometry is refused, naming what helps, unless the file has it uncompressed too."""
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    primitive = triangle.document["meshes"][0]["primitives"][0]
    primitive["extensions"] = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
    if fallback:
        assert len(load(triangle.save(tmp_path)).shapes()) == 1
        return
    for accessor in triangle.document["accessors"]:
        del accessor["bufferView"]
    with pytest.raises(UnsupportedError, match=r"KHR_draco_mesh_compression.*gltf-transform"):
        load(triangle.save(tmp_path))


def test_versions(triangle: Any, tmp_path: Path) -> None:
    """2.x is read, 1.0 is refused with its number, no version is no glTF."""
    triangle.document["asset"]["version"] = "2.7"
    assert load(triangle.save(tmp_path)).shapes()
    triangle.document["asset"]["version"] = "1.0"
    with pytest.raises(UnsupportedError, match=r"version 1\.0"):
        load(triangle.save(tmp_path))
    triangle.document["asset"] = {}
    with pytest.raises(FileFormatError, match="/asset/version"):
        load(triangle.save(tmp_path))


def test_limits_are_named(rich: Any, tmp_path: Path) -> None:
    """Each limit refuses early, with its own name; pictures beyond theirs are left out."""
    path = rich.save(tmp_path)
    for limits, name in (
        (Limits(max_file_bytes=100), "max_file_bytes"), (Limits(max_vertices=3), "max_vertices"),
        (Limits(max_triangles=1), "max_triangles"), (Limits(max_nodes=5), "max_nodes"),
        (Limits(max_json_bytes=10), "max_json_bytes"),
    ):  # fmt: skip
        with pytest.raises(FileFormatError, match=name):
            load(path, limits=limits)
    for limits in (Limits(max_texture_pixels=3), Limits(max_total_texture_pixels=3)):
        with pytest.warns(LimnerWarning, match="texture_pixels"):
            assert load(path, limits=limits).shapes()


def test_json_with_a_byte_order_mark(triangle: Any, tmp_path: Path) -> None:
    """A mark before the JSON, which the specification forbids and editors write, is skipped."""
    assert read(b"\xef\xbb\xbf" + triangle.embedded(), tmp_path / "a.gltf").shapes()
    with pytest.raises(FileFormatError, match="UTF-8"):
        read(json.dumps({"asset": {"version": "2.0"}}).encode("utf-16"), tmp_path / "a.gltf")
