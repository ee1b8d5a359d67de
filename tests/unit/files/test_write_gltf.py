"""Scenes into glTF: what the document says, and what comes back when it is read."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import struct
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from menagerie import ODD_NAME, menagerie, seamed, texels

from limner.errors import LimnerWarning, RenderError, SceneError, UnsupportedError
from limner.files.gltf_material import turned_transform
from limner.files.load import load
from limner.files.save_mesh import save_model
from limner.files.write_gltf import write
from limner.files.write_gltf_exact import given_transform, inverted, parts_of
from limner.files.write_gltf_material import nearest
from limner.files.write_gltf_mesh import vertices_of
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.scene.animation import Animation, FieldChannel, NodeChannel
from limner.scene.camera import PerspectiveCamera
from limner.scene.displacement import Displacement
from limner.scene.environment import Environment
from limner.scene.light import AmbientLight, PointLight, SphereLight
from limner.scene.material import BlinnPhong, CoolToWarm, Dielectric, Lambert, MetallicRoughness
from limner.scene.material_extensions import Conductor
from limner.scene.motion import KeyedMotion, Motion
from limner.scene.node import Node
from limner.scene.procedural import Checker
from limner.scene.rig import Binding, Morph, Skin
from limner.scene.scene import Scene
from limner.scene.shape import Box, Difference, Plane, Shape, Solid, Sphere
from limner.scene.texture import Texels, Texture
from limner.scene.track import Track

TRIANGLE = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], name="t")


def document(path: Path) -> dict[str, Any]:
    """The JSON of a .glb."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    found: dict[str, Any] = json.loads(data[20 : 20 + length])
    return found


def saved(scene: Scene, folder: Path, **options: Any) -> dict[str, Any]:
    """What a scene is written as."""
    write(scene, folder / "a.glb", **options)
    return document(folder / "a.glb")


def again(scene: Scene, folder: Path) -> Scene:
    """A scene, saved and loaded."""
    write(scene, folder / "a.glb")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimnerWarning)
        return load(folder / "a.glb")


def showing(*materials: Any, mesh: Mesh = TRIANGLE) -> Scene:
    """A scene of one mesh."""
    return Scene(Node(children=(Node("n", shapes=(Shape(mesh, materials or (MetallicRoughness(),)),)),)))


def geometry(scene: Scene) -> Mesh:
    """The first mesh of a scene."""
    found = scene.shapes()[0][1].geometry
    assert isinstance(found, Mesh)
    return found


def places(scene: Scene) -> dict[str, np.ndarray]:
    """Where nodes stand, by their paths."""
    return {placed.path: placed.world_from_object for placed in scene.root.walk()}


# --- meshes ---------------------------------------------------------------------------------------------------------------


def test_corners_become_the_fewest_vertices_that_tell_them_apart() -> None:
    """Each corner keeps its position, normal and coordinates; there are as many vertices as different corners, in a fixed order."""
    rng = np.random.default_rng(1)
    columns = [rng.integers(0, n, (30, 3)) for n in (5, 4, 3)]
    normals, uvs = rng.random((4, 3), dtype=np.float32), rng.random((3, 2), dtype=np.float32)
    mesh = Mesh(rng.random((5, 3)), columns[0], normals=normals, normal_triangles=columns[1], uvs=uvs, uv_triangles=columns[2])
    made = vertices_of(mesh)
    rows = [np.asarray(column) for column in (made.positions, made.normals, made.uvs)]
    for column, row in zip(columns, rows, strict=True):
        np.testing.assert_array_equal(row[made.triangles], column)
    triples = np.stack(rows, axis=1)
    np.testing.assert_array_equal(triples, np.unique(np.stack([c.reshape(-1) for c in columns], axis=1), axis=0))


def test_where_corners_agree_nothing_is_split(tmp_path: Path) -> None:
    """Index arrays that repeat the triangles change nothing."""
    faces = np.array([[0, 2, 1], [3, 1, 2]])
    mesh = Mesh(np.eye(4)[:, :3], faces, normals=np.tile([0, 0, 1], (4, 1)), normal_triangles=faces)
    found = geometry(again(showing(mesh=mesh), tmp_path))
    np.testing.assert_array_equal(found.positions, mesh.positions)
    np.testing.assert_array_equal(found.triangles, faces)


def test_all_that_lives_on_a_mesh_comes_back(tmp_path: Path) -> None:
    """By corners, so that neither splitting nor the parts by material matter."""
    mesh = seamed()
    first, second = MetallicRoughness(name="0"), MetallicRoughness(name="1")
    shapes = again(showing(first, second, mesh=mesh), tmp_path).shapes()
    assert [shape.materials[0].name for _, shape in shapes] == ["0", "1"]
    assert mesh.normal_triangles is not None
    for triangle, (_, shape) in zip((1, 0), shapes, strict=True):
        found = shape.geometry
        assert isinstance(found, Mesh)
        corners = found.triangles[0]
        for field, rows in (("positions", mesh.triangles), ("normals", mesh.normal_triangles), ("uvs", mesh.triangles),
                            ("uvs1", mesh.triangles), ("colors", mesh.triangles)):  # fmt: skip
            np.testing.assert_array_equal(getattr(found, field)[corners], getattr(mesh, field)[rows[triangle]], field)
        assert found.scalars is not None
        np.testing.assert_array_equal(found.scalars["heat"][corners], mesh.triangles[triangle])


def test_what_is_shared_is_written_once(tmp_path: Path) -> None:
    """One mesh, one picture, one set of bytes, however many nodes; meshes that are equal but not the same stay two, over the same bytes."""
    picture = texels(1, srgb=True)
    materials = [MetallicRoughness(name=str(k), base_color_texture=Texture(picture)) for k in range(2)]
    twin = dataclasses.replace(TRIANGLE, name="twin")
    shape = Shape(TRIANGLE, (materials[0],))
    nodes = [Node(str(k), transform.translate(k, 0, 0), (shape,)) for k in range(5)]
    scene = Scene(Node(children=(*nodes, Node("twin", shapes=(Shape(twin, (materials[1],)),)))))
    found = saved(scene, tmp_path)
    assert [node["mesh"] for node in found["nodes"]] == [0, 0, 0, 0, 0, 1]
    assert (len(found["images"]), len(found["textures"]), len(found["samplers"]), len(found["materials"])) == (1, 1, 1, 2)
    assert [mesh["name"] for mesh in found["meshes"]] == ["t", "twin"]
    assert sum("target" in view and view["target"] == 34962 for view in found["bufferViews"]) == 2  # positions; no coordinates: zeros
    back = [shape.geometry for _, shape in load(tmp_path / "a.glb").shapes()]
    assert all(mesh is back[0] for mesh in back[:5])
    assert back[5] is not back[0]


def test_bytes_are_the_same_each_time(tmp_path: Path) -> None:
    """Of equal scenes, made twice; and every view begins at a multiple of four, within the buffer."""
    write(menagerie(), tmp_path / "a.glb")
    write(menagerie(), tmp_path / "b.glb")
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()
    found = document(tmp_path / "a.glb")
    assert found["asset"] == {"generator": "limner", "version": "2.0"}
    assert all(view["byteOffset"] % 4 == 0 for view in found["bufferViews"])
    assert max(view["byteOffset"] + view["byteLength"] for view in found["bufferViews"]) <= found["buffers"][0]["byteLength"]
    assert os.path.getsize(tmp_path / "a.glb") % 4 == 0


def test_vectors_without_length_and_numbers_that_are_none(tmp_path: Path) -> None:
    """NaN never gets into a file; what takes its place is said."""
    nan = np.nan
    mesh = Mesh(TRIANGLE.positions, TRIANGLE.triangles, normals=[[0, 0, 0], [0, 0, 2], [nan, 0, 0]], uvs=[[nan, 0], [0, 0], [0, 0]],
                tangents=[[0, 0, 0, 1], [2, 0, 0, -3], [1, 0, 0, 1]], colors=[[nan, 0, 0], [2, 0, 0], [0, 0, 0]],
                scalars={"bad": [nan, 0, 0]})  # fmt: skip
    notes = write(showing(mesh=mesh), tmp_path / "a.glb")
    assert [note.split(": ")[1].split(" ")[0] for note in notes] == ["normals", "tangents", "texture", "colours", "vertex", "the"]
    found = geometry(load(tmp_path / "a.glb"))
    assert found.normals is not None
    assert found.tangents is not None
    assert found.colors is not None
    assert found.scalars is None
    np.testing.assert_array_equal(found.normals, [[0, 0, 1]] * 3)
    np.testing.assert_allclose(np.linalg.norm(found.tangents[:, :3], axis=1), 1.0, rtol=1e-6)
    assert found.tangents[:, 3].tolist() == [1, -1, 1]
    assert found.colors[:, 0].tolist() == [0, 1, 0]


# --- places ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("matrix", "keys"),
    [
        (np.eye(4), set()),
        (transform.translate(1, 2, 3), {"translation"}),
        (transform.scale(2, -1, 0.5), {"scale"}),
        (transform.translate(0.1, 0, 0) @ transform.rotate_y(0.7) @ transform.scale(2, 3, 4), {"translation", "rotation", "scale"}),
        (transform.rotate_x(0.3) @ transform.rotate_z(0.4), {"rotation"}),
        (np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]), {"matrix"}),
        (transform.scale(0, 1, 2) @ transform.rotate_y(0.0), {"scale"}),
    ],
)
def test_places(matrix: np.ndarray, keys: set[str], tmp_path: Path) -> None:
    """Three factors where they make the matrix, else the matrix to the bit."""
    scene = Scene(Node(children=(Node("n", matrix, (Shape(TRIANGLE),)),)))
    found = saved(scene, tmp_path)["nodes"][0]
    assert set(found) - {"name", "mesh"} == keys
    back = places(load(tmp_path / "a.glb"))["world/n"]
    np.testing.assert_allclose(back, matrix, atol=1e-14)
    if keys == {"matrix"}:
        np.testing.assert_array_equal(back, matrix)


def test_numbers_of_files_are_found_again() -> None:
    """Rotations of a few digits, as single precision or text has them: most make the matrix to the bit, the others but for rounding."""
    rng = np.random.default_rng(3)
    n_exact = 0
    for k in range(30):
        q, size = rng.standard_normal(4), rng.random(3).round(2) + 0.5
        q = q / np.linalg.norm(q)
        matrix = transform.compose_trs((1, 2, 3), q.round(6) if k % 2 else q.astype(np.float32), size)
        parts = parts_of(matrix)
        assert parts is not None
        np.testing.assert_allclose(transform.compose_trs(*parts), matrix, atol=1e-15)
        n_exact += np.array_equal(transform.compose_trs(*parts), matrix)
    assert n_exact >= 15


def test_shear_is_written_as_two_nodes(tmp_path: Path) -> None:
    """A matrix that glTF forbids; what is below stands where it stood."""
    sheared = np.array([[1.0, 0.5, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])
    inner = Node("in", transform.translate(0, 1, 0), (Shape(TRIANGLE),))
    scene = Scene(Node(children=(Node("n", sheared, (Shape(TRIANGLE),), children=(inner,)),)))
    (note, _) = write(scene, tmp_path / "a.glb")
    assert note.startswith("world/n: has shear")
    back = load(tmp_path / "a.glb")
    assert not any("matrix" in node for node in document(tmp_path / "a.glb")["nodes"])
    for (ours, _), (theirs, _) in zip(scene.shapes(), back.shapes(), strict=True):
        np.testing.assert_allclose(theirs.world_from_object, ours.world_from_object, atol=1e-12)


def test_texture_transforms_and_angles_come_back_to_the_bit() -> None:
    """The inverse of what reading does, for any numbers."""
    rng = np.random.default_rng(2)
    n_exact = 0
    for offset, angle, scale in zip(rng.normal(size=(50, 2)), rng.normal(size=50), rng.normal(size=(50, 2)), strict=True):
        wanted = ((float(offset[0]), float(offset[1])), float(angle), (float(scale[0]), float(scale[1])))
        back = turned_transform(*given_transform(*wanted))
        np.testing.assert_allclose(back[0], wanted[0], atol=1e-15)
        n_exact += turned_transform(*given_transform(*back)) == back
        degrees = math.degrees(float(abs(offset[0])))
        assert math.degrees(inverted(math.degrees, math.radians(degrees), degrees)) == degrees
    assert n_exact == 50
    assert given_transform((0.0, 0.0), 0.0, (1.0, 1.0)) == ((0.0, 0.0), 0.0, (1.0, 1.0))


@pytest.mark.parametrize("scale", [2.0, None])
def test_instances_only_where_asked(scale: float | None, tmp_path: Path) -> None:
    """Leaves that show one mesh become one node with their places; what is more than that stays a node."""
    shapes = [Shape(TRIANGLE, (MetallicRoughness(),)) for _ in range(5)]
    leaves = [Node(str(k), transform.translate(k, 0, 0) @ transform.rotate_y(k), (shapes[k],)) for k in range(4)]
    lamp = Node("lamp", shapes=(shapes[4],), lights=(PointLight(),))
    n_roots = 0 if scale is None else 1
    root = Node(children=(*leaves, lamp)) if scale is None else Node("field", transform.scale(scale), children=(*leaves, lamp))
    scene = Scene(root)
    assert len(saved(scene, tmp_path)["nodes"]) == 5 + n_roots
    found = saved(scene, tmp_path, gpu_instancing=True)
    assert len(found["nodes"]) == 2 + n_roots
    assert found["extensionsRequired"] == ["EXT_mesh_gpu_instancing"]
    back = load(tmp_path / "a.glb")
    matrices = [np.sort([placed.world_from_object for placed, _ in held.shapes()], axis=0) for held in (scene, back)]
    np.testing.assert_allclose(*matrices, atol=1e-6)


# --- materials ------------------------------------------------------------------------------------------------------------


def plain(value: Any) -> Any:
    """A description as numbers that can be compared, its pictures by their bytes."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    return value.tobytes() if isinstance(value, np.ndarray) else value


def test_metallic_roughness_is_kept_to_the_bit(tmp_path: Path) -> None:
    """Every field, every texture with its sampler, transform and texels, emission beyond 1, and the default that is not written."""
    scene = menagerie().replace(animations=())
    back = again(scene, tmp_path)
    pairs = [(ours, theirs) for (_, a), (_, b) in zip(scene.shapes()[-2:], back.shapes()[-2:], strict=True)
             for ours, theirs in zip(a.materials, b.materials, strict=True)]  # fmt: skip
    # Of texture transforms whose numbers no file had, the last bit may be another: the one here is one that a file can have.
    for ours, theirs in pairs:
        first, second = plain(ours), plain(theirs)
        for held in (first, second):
            if held["base_color_texture"]:
                held["base_color_texture"]["offset"] = np.round(held["base_color_texture"]["offset"], 14).tolist()
        assert first == second
    found = document(tmp_path / "a.glb")
    lit = next(material for material in found["materials"] if material["name"] == "lit")
    assert lit["extensions"]["KHR_materials_emissive_strength"] == {"emissiveStrength": 8.0}
    assert "material" not in saved(showing(MetallicRoughness()), tmp_path)["meshes"][0]["primitives"][0]


def test_other_materials_become_the_nearest() -> None:
    """A mirror is a metal, what is matt is none, a highlight is as wide, and what has all three keeps its diffuse colour."""
    matt = nearest(Lambert((0.2, 0.4, 0.6), emission=(1, 0, 0)))
    assert (matt.base_color, matt.metallic, matt.roughness, matt.emission) == ((0.2, 0.4, 0.6), 0.0, 1.0, (1.0, 0.0, 0.0))
    mirror = nearest(BlinnPhong((0, 0, 0), mirror=(0.9, 0.7, 0.3)))
    assert mirror.metallic == 1.0
    assert mirror.roughness == 0.0
    np.testing.assert_allclose(mirror.base_color, (0.9, 0.7, 0.3))
    mixed = nearest(BlinnPhong((0.5, 0.5, 0.5), (0.3, 0.3, 0.3), exponent=98.0, normalized=True))
    np.testing.assert_allclose((1 - mixed.metallic) * np.array(mixed.base_color), 0.5, rtol=1e-12)
    np.testing.assert_allclose(0.04 * (1 - mixed.metallic) + mixed.metallic * np.array(mixed.base_color), 0.3, rtol=1e-12)
    np.testing.assert_allclose(mixed.roughness**4, 2.0 / 100.0)
    assert nearest(BlinnPhong((0.5, 0.5, 0.5))).metallic == 0.0


def test_what_is_not_glass_is_said_and_glass_keeps_its_color(tmp_path: Path) -> None:
    """Notes name the kind and the material; absorption becomes a colour at a depth (Beer's law)."""
    glass = Dielectric(1.4, absorption=(0.5, 1.0, 2.0), name="glass")
    materials = (glass, CoolToWarm(name="drawn"), Lambert((2, 0, 0), name="hot"))
    children = tuple(Node(shapes=(Shape(TRIANGLE, (material,)),)) for material in materials)
    notes = write(Scene(Node(children=children)), tmp_path / "a.glb")
    kinds = ("glass: Dielectric is", "drawn: CoolToWarm is", "hot: Lambert is", "hot: a base colour above 1")
    assert [note.startswith(kind) for note, kind in zip(notes, kinds, strict=True)] == [True] * 4
    extensions = document(tmp_path / "a.glb")["materials"][0]["extensions"]
    volume = extensions["KHR_materials_volume"]
    np.testing.assert_allclose(-np.log(volume["attenuationColor"]) / volume["attenuationDistance"], glass.absorption)
    assert extensions["KHR_materials_ior"] == {"ior": 1.4}


def test_pictures_that_are_used_otherwise_than_encoded(tmp_path: Path) -> None:
    """Linear texels as a base colour are encoded, with 16 bits, so that their light is what it was."""
    held = texels(1, srgb=False)
    assert any("encoded anew" in note for note in write(showing(MetallicRoughness(base_color_texture=Texture(held))), tmp_path / "a.glb"))
    material = load(tmp_path / "a.glb").shapes()[0][1].materials[0]
    assert isinstance(material, MetallicRoughness)
    assert material.base_color_texture is not None
    texture = material.base_color_texture
    assert isinstance(texture, Texture)
    found = texture.texels.pixels[..., :3] / 65535.0
    linear = np.where(found <= 0.04045, found / 12.92, ((found + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(linear, held.pixels[..., :3] / 255.0, atol=2e-5)


def test_words_stay_words_and_floats_become_words(tmp_path: Path) -> None:
    """Texels of 16 bits to the bit; floats by rounding, which is said; patterns and what glTF has no place for are left out, and said."""
    words = np.random.default_rng(7).integers(0, 65536, (3, 2, 4), dtype=np.uint16)
    floats = np.linspace(-0.5, 2.0, 24, dtype=np.float32).reshape(3, 2, 4)
    material = MetallicRoughness(
        name="m", base_color_texture=Texture(Texels(words)), metallic_roughness_texture=Texture(Texels(floats, srgb=False)),
        emissive_texture=Checker(), bump_texture=Checker(), normal_texture=Texture(texels(1, srgb=False), mapping="triplanar"),
    )  # fmt: skip
    told = "\n".join(write(showing(material), tmp_path / "a.glb"))
    wanted = ("bump_texture is left out", "texture of floats", "pattern Checker is left out", "tri-planar mapping is left out")
    assert [word for word in wanted if f"m: {word}" not in told and f"m: the {word}" not in told and f"m: a {word}" not in told] == []
    found = load(tmp_path / "a.glb").shapes()[0][1].materials[0]
    assert isinstance(found, MetallicRoughness)
    assert isinstance(found.base_color_texture, Texture)
    assert isinstance(found.metallic_roughness_texture, Texture)
    np.testing.assert_array_equal(found.base_color_texture.texels.pixels, words)
    read = found.metallic_roughness_texture.texels.pixels / 65535.0
    np.testing.assert_allclose(read, np.clip(floats, 0.0, 1.0), atol=1e-5)
    assert (found.emissive_texture, found.normal_texture, found.bump_texture) == (None, None, None)


# --- cameras, lights, surroundings ----------------------------------------------------------------------------------------


def test_cameras_and_lights_come_back(tmp_path: Path) -> None:
    """Places, angles and numbers to the bit; several at one node stand below it; a colour above 1 goes into the intensity."""
    scene = menagerie()
    back = again(scene.replace(animations=()), tmp_path)
    for ours, theirs in zip(scene.cameras(), back.cameras(), strict=True):
        assert type(ours) is type(theirs)
        fields = [{k: v for k, v in vars(camera).items() if k != "world_from_camera"} for camera in (ours, theirs)]
        assert fields[0] == fields[1]
        np.testing.assert_allclose(theirs.world_from_camera, ours.world_from_camera, atol=1e-14)
    for (_, ours), (_, theirs) in zip(scene.lights(), back.lights(), strict=True):
        power = [np.array(light.color) * light.intensity for light in (ours, theirs)]
        np.testing.assert_array_equal(*power)
        rest = [{k: v for k, v in vars(light).items() if k not in ("color", "intensity")} for light in (ours, theirs)]
        assert rest[0] == rest[1]


def test_the_camera_of_the_scene_is_the_first(tmp_path: Path) -> None:
    """Before those of the graph, where it stood; planes that it left open are said."""
    camera = PerspectiveCamera.look_at((1, 2, 3), (0, 0, 0), yfov_degrees=30, aperture_radius=0.1, name="mine")
    notes = write(menagerie().replace(camera=camera), tmp_path / "a.glb")
    assert len(notes) == 2
    found = load(tmp_path / "a.glb").cameras()[0]
    assert found.name == "mine"
    np.testing.assert_allclose(found.world_from_camera, camera.world_from_camera, atol=1e-14)


def test_what_gltf_has_not_is_said(tmp_path: Path) -> None:
    """Lights with an area, surroundings, exact shapes, planes without end."""
    lights = (AmbientLight(), SphereLight(), PointLight(falloff="none"))
    shapes = (Shape(Box((1, 1, 1))), Shape(Sphere(0.5)), Shape(Plane()))
    scene = Scene(Node("n", shapes=shapes, lights=lights), environment=Environment((1, 1, 1)), background=(1, 0, 0))
    told = "\n".join(write(scene, tmp_path / "a.glb"))
    words = ("AmbientLight is left out", "SphereLight is left out", "without falloff", "Box is", "Sphere is", "a plane without end",
             "environment is left out", "background is left out", "Lambert is")  # fmt: skip
    assert [word for word in words if word not in told] == []
    back = load(tmp_path / "a.glb")
    box, ball, ground = [shape.geometry for _, shape in back.shapes()]
    np.testing.assert_allclose(box.bounds, [[-0.5] * 3, [0.5] * 3])
    np.testing.assert_allclose(ball.bounds, [[-0.5] * 3, [0.5] * 3], atol=1e-3)
    assert float(np.ptp(ground.bounds[:, 0])) > 10.0


def test_displacement_and_combinations_become_triangles(tmp_path: Path) -> None:
    """A square raised by a texture of constant height stands there; the parts of a combination keep their materials."""
    full = Texture(Texels(np.full((2, 2, 4), 255, dtype=np.uint8), srgb=False))
    square = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], normals=[[0, 0, 1]] * 4,
                  uvs=[[0, 0], [1, 0], [1, 1], [0, 1]])  # fmt: skip
    raised = Shape(square, (MetallicRoughness(),), displacement=Displacement(full, 0.5, max_triangles=50))
    hollow = Difference(Box((1, 1, 1)), Solid(Sphere(0.6), material=MetallicRoughness(name="inside")))
    cut = Shape(hollow, (MetallicRoughness(name="outside"),))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimnerWarning)
        notes = write(Scene(Node(children=(Node("up", shapes=(raised,)), Node("cut", shapes=(cut,))))), tmp_path / "a.glb")
    assert notes == ("world/up: displacement is written as triangles", "world/cut: Difference is written as triangles")
    shapes = load(tmp_path / "a.glb").shapes()
    np.testing.assert_allclose(geometry(Scene(Node(shapes=(shapes[0][1],)))).positions[:, 2], 0.5, atol=1e-6)
    assert [shape.materials[0].name for _, shape in shapes[1:]] == ["outside", "inside"]


# --- what bends and moves -------------------------------------------------------------------------------------------------


def test_morphs_and_skins_come_back(tmp_path: Path) -> None:
    """Names, offsets, of which the few are stored sparsely; joints and weights in sets of four; the matrices of the joints."""
    scene = menagerie()
    back = again(scene, tmp_path)
    (ours, theirs) = [next(placed.node for placed in held.root.walk() if placed.node.skin) for held in (scene, back)]
    assert [morph.name for morph in theirs.shapes[0].morphs] == ["grow", "dent"]
    for a, b in zip(ours.shapes[0].morphs, theirs.shapes[0].morphs, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)
    assert ours.weights == theirs.weights
    first, second = ours.shapes[0].binding, theirs.shapes[0].binding
    assert first is not None
    assert second is not None
    np.testing.assert_array_equal(second.weights[:, :2], first.weights[:, :2])
    assert not second.weights[:, 2:].any()
    assert ours.skin is not None
    assert theirs.skin is not None
    assert (theirs.skin.joints, theirs.skin.name) == (ours.skin.joints, ours.skin.name)
    np.testing.assert_array_equal(theirs.skin.joint_from_mesh, ours.skin.joint_from_mesh)
    assert sum("sparse" in accessor for accessor in document(tmp_path / "a.glb")["accessors"]) == 1


def test_joints_that_are_named_twice(tmp_path: Path) -> None:
    """A vertex gets the sum of their weights, once."""
    binding = Binding(np.array([[3, 1, 3], [0, 0, 0], [2, 2, 1]]), np.array([[0.25, 0.5, 0.25], [1, 0, 0], [0, 0.5, 0.5]]))
    bones = Node("b", children=tuple(Node(str(k)) for k in range(4)))
    skin = Skin(tuple(f"world/b/{k}" for k in range(4)))
    scene = Scene(Node(children=(bones, Node("n", shapes=(Shape(TRIANGLE, binding=binding),), skin=skin))))
    found = again(scene, tmp_path).shapes()[0][1].binding
    assert found is not None
    assert [{joint: weight for joint, weight in zip(*row, strict=True) if weight} for row in
            zip(found.joints.tolist(), found.weights.tolist(), strict=True)] == [{3: 0.5, 1: 0.5}, {0: 1.0}, {2: 0.5, 1: 0.5}]  # fmt: skip


def test_a_morph_of_nothing_and_shapes_that_bend_differently(tmp_path: Path) -> None:
    """Shapes of one node with different morphs are told apart by nodes below it; all of them follow its weights."""
    up = Morph(np.tile(np.array([0, 0, 1], dtype=np.float32), (3, 1)))
    shapes = (Shape(TRIANGLE, morphs=(up, Morph(name="nothing"))), Shape(TRIANGLE, morphs=(up,)), Shape(TRIANGLE))
    scene = Scene(Node(children=(Node("n", shapes=shapes, weights=(0.5,)),)))
    back = again(scene, tmp_path)
    heights = [[geometry.bounds[1, 2] for _, shape in held.at(0.0).shapes() if isinstance(geometry := shape.geometry, Mesh)]
               for held in (scene, back)]  # fmt: skip
    assert heights == [[0.5, 0.5, 0.0]] * 2


def test_a_scene_moves_as_it_did(tmp_path: Path) -> None:
    """All kinds of channels: places, bent meshes, materials, lights and cameras at times before, between and after the keys."""
    scene = menagerie()
    back = again(scene, tmp_path)
    assert back.notes == ()
    for time in (-1.0, 0.0, 0.3, 0.75, 1.2, 9.0):
        ours, theirs = scene.at(time), back.at(time)
        expected, found = places(ours), places(theirs)
        # What stands several times at one node stands below it in the file.
        assert [path for path in found if "/eye/" not in path] == list(expected)
        for path, matrix in expected.items():
            np.testing.assert_allclose(found[path], matrix, atol=1e-6)
        assert len([path for path in found if path.startswith("world/hidden")]) == 1
        bent = [next(placed.node.shapes[0] for placed in held.walk() if placed.path == "world/strip") for held in (ours, theirs)]
        np.testing.assert_allclose(*(shape.geometry.positions for shape in bent), atol=1e-6)  # type: ignore[union-attr]
        for field in ("base_color", "alpha", "emission", "roughness"):
            np.testing.assert_allclose(*(getattr(shape.materials[0], field) for shape in bent), atol=1e-6)
        np.testing.assert_allclose(*(shape.materials[0].base_color_texture.offset for shape in bent), atol=1e-6)  # type: ignore[union-attr]
        assert [next(p.node.visible for p in held.root.walk() if p.path == "world/hidden") for held in (ours, theirs)] == [time >= 0.5] * 2
        np.testing.assert_allclose(*(held.cameras()[0].yfov_degrees for held in (ours, theirs)), rtol=1e-6)  # type: ignore[union-attr]
        spots: list[Any] = [held.lights()[0][1] for held in (ours, theirs)]
        np.testing.assert_allclose(*(np.array(spot.color) * spot.intensity for spot in spots), rtol=1e-6)
        np.testing.assert_allclose(spots[1].outer_degrees, spots[0].outer_degrees, rtol=1e-6)


@pytest.mark.parametrize("moved", [("offset",), ("offset", "rotation"), ("offset", "rotation", "scale")])
def test_textures_slide_and_turn_as_they_did(moved: tuple[str, ...], tmp_path: Path) -> None:
    """A file's offset follows from all three and goes along a curve where ours goes straight: exact at the keys, near between them."""
    texture = Texture(texels(1, srgb=True), offset=(0.0, 0.25), rotation=0.2)
    material = MetallicRoughness(name="m", base_color_texture=texture)
    keys = {"offset": [[0.0, 0.0], [1.0, 0.5]], "rotation": [0.0, 2.0], "scale": [[1.0, 1.0], [2.0, 3.0]]}
    channels = [FieldChannel("material", "m", f"base_color_texture.{part}", Track([0.0, 1.0], keys[part])) for part in moved]
    scene = showing(material).replace(animations=(Animation("slide", tuple(channels)),))
    found = saved(scene, tmp_path)
    pointed = [c["target"]["extensions"]["KHR_animation_pointer"]["pointer"].rpartition("/")[2] for c in found["animations"][0]["channels"]]
    assert sorted(pointed) == sorted(moved)
    back = load(tmp_path / "a.glb")
    for time in (0.0, 0.4, 0.9, 1.0):
        looks = [held.at(time).shapes()[0][1].materials[0].base_color_texture for held in (scene, back)]  # type: ignore[union-attr]
        for part in ("offset", "rotation", "scale"):
            np.testing.assert_allclose(*(getattr(look, part) for look in looks), atol=1e-3 if len(moved) > 1 and time % 1.0 else 1e-6)


def test_a_turning_texture_of_a_file_is_written_as_it_was(writer: Any, tmp_path: Path) -> None:
    """Read, its offset moves too; written, two keys of a rotation are two keys again."""
    primitive = writer.primitive([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    primitive["attributes"]["TEXCOORD_0"] = writer.accessor([[0, 0], [1, 0], [0, 1]])
    primitive["material"] = 0
    look = {"index": writer.picture(np.zeros((2, 2, 3))), "extensions": {"KHR_texture_transform": {"offset": [0.3, 0.4]}}}
    writer.document["materials"] = [{"name": "m", "pbrMetallicRoughness": {"baseColorTexture": look}}]
    pointer = "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/rotation"
    target = {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}
    sampler = {"input": writer.accessor([0, 1]), "output": writer.accessor([0, 2])}
    writer.document["animations"] = [{"samplers": [sampler], "channels": [{"sampler": 0, "target": target}]}]
    found = saved(load(writer.save(tmp_path)), tmp_path)
    (channel,) = found["animations"][0]["channels"]
    assert channel["target"] == target
    assert found["accessors"][found["animations"][0]["samplers"][0]["output"]]["count"] == 2
    assert found["materials"][0]["name"] == "m"


def test_motions_of_nodes_become_an_animation(tmp_path: Path) -> None:
    """A wheel that turns more than once, in a place of its own; and keys of an animation that begin before 0."""
    wheel = Node("wheel", transform.translate(1, 0, 0) @ transform.rotate_x(0.5), (Shape(TRIANGLE),), motion=Motion.turn((0, 0, 1), 500))
    moved = KeyedMotion(Track([-1.0, 1.0], [[0, 0, 0], [4, 0, 0]]), Track.constant((0, 0, 0, 1), rotates=True), Track.constant((1, 1, 1)))
    root = Node(children=(wheel, Node("box", shapes=(Shape(TRIANGLE),))))
    scene = Scene(root, animations=(Animation("go", (NodeChannel("world/box", moved),)),))
    assert "go: begins before 0 and is moved by 1 s" in write(scene, tmp_path / "a.glb")
    back = load(tmp_path / "a.glb")
    assert [animation.name for animation in back.animations] == ["go", "motion"]
    for time in (0.0, 0.33, 0.9):
        np.testing.assert_allclose(places(back.at(time, "motion"))["world/wheel"], scene.root.children[0].place(time), atol=1e-5)
        np.testing.assert_allclose(places(back.at(time + 1.0, "go"))["world/box"], moved.at(time), atol=1e-6)


# --- files ----------------------------------------------------------------------------------------------------------------


def test_text_with_files_beside_it_and_without(tmp_path: Path) -> None:
    """The same document in other clothes; names with spaces, percent signs and accents are percent-encoded."""
    scene = menagerie()
    write(scene, tmp_path / "a.glb")
    folder = tmp_path / "beside"
    folder.mkdir()
    write(scene, folder / "ä b%20.gltf")
    assert sorted(path.suffix for path in folder.iterdir()) == [".bin", ".gltf", *[".png"] * 4]
    write(scene, tmp_path / "in.gltf", embedded=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.glb", "beside", "in.gltf"]
    expected = load(tmp_path / "a.glb")
    for path in (folder / "ä b%20.gltf", tmp_path / "in.gltf"):
        found = load(path)
        assert found.notes == ()
        for (_, a), (_, b) in zip(found.shapes(), expected.shapes(), strict=True):
            assert plain(a.materials[0]) == plain(b.materials[0])
            np.testing.assert_array_equal(a.geometry.positions, b.geometry.positions)  # type: ignore[union-attr]


def test_names_may_be_anything(tmp_path: Path) -> None:
    """Quotes, line ends, slashes, emoji; half of a surrogate pair, which UTF-8 has not, becomes a question mark."""
    scene = Scene(Node(children=(Node(ODD_NAME, shapes=(Shape(TRIANGLE),)), Node("half \ud800", shapes=(Shape(TRIANGLE),)))), name=ODD_NAME)
    back = again(scene, tmp_path)
    assert [child.name for child in back.root.children] == [ODD_NAME, "half ?"]
    assert back.name == ODD_NAME
    half = "\ud800"
    mesh = dataclasses.replace(TRIANGLE, name=half, scalars={half: np.zeros(3)})
    morph = Morph(np.ones((3, 3), dtype=np.float32), name=half)
    material = MetallicRoughness(name=half, base_color_texture=Texture(Texels(np.zeros((1, 1, 4), np.uint8), name=half)))
    light, camera = PointLight(name=half), PerspectiveCamera(near=1.0, name=half)
    turn = FieldChannel("light", half, "intensity", Track([0.0, 1.0], [0.0, 1.0]))
    node = Node(half, shapes=(Shape(mesh, (material,), (morph,)),), lights=(light,), cameras=(camera,))
    back = again(Scene(Node(half, children=(node,)), animations=(Animation(half, (turn,)),)), tmp_path)
    assert [animation.name for animation in back.animations] == ["?"]
    assert back.shapes()[0][1].materials[0].name == "?"


def test_a_scene_of_nothing_is_a_file(tmp_path: Path) -> None:
    """Without a binary chunk, without lists that are empty."""
    assert saved(Scene(), tmp_path) == {"asset": {"generator": "limner", "version": "2.0"}, "scene": 0, "scenes": [{}]}
    assert load(tmp_path / "a.glb").root.children == ()


def test_a_root_that_is_somewhere_is_a_node(tmp_path: Path) -> None:
    """Names and hidden branches are kept; a root that only holds others is the file's scene."""
    root = Node("car", transform.translate(0, 1, 0), children=(Node("wheel", shapes=(Shape(TRIANGLE),), visible=False),))
    back = again(Scene(root), tmp_path)
    assert [placed.path for placed in back.root.walk()] == ["world", "world/car", "world/car/wheel"]
    assert back.shapes() == []
    assert "KHR_node_visibility" in document(tmp_path / "a.glb")["extensionsUsed"]


def test_bad_places_and_bad_scenes(tmp_path: Path) -> None:
    """One line each, and no file."""
    with pytest.raises(UnsupportedError, match=r"\.glb or \.gltf"):
        write(Scene(), tmp_path / "a.obj")
    with pytest.raises(RenderError, match="there is no folder"):
        write(Scene(), tmp_path / "no" / "a.glb")
    (tmp_path / "d.glb").mkdir()
    with pytest.raises(RenderError, match="is a folder"):
        save_model(Scene(), tmp_path / "d.glb")
    lost = Scene(Node(children=(Node("n", shapes=(Shape(TRIANGLE, binding=Binding(np.zeros((3, 1), int), np.ones((3, 1)))),),
                                     skin=Skin(("world/no",))),)))  # fmt: skip
    with pytest.raises(SceneError, match="names the joint 'world/no'"):
        write(lost, tmp_path / "a.glb")
    assert [path.name for path in tmp_path.iterdir()] == ["d.glb"]


def test_a_full_disk_leaves_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of several files none is replaced, and nothing of the new ones is left."""
    write(showing(), tmp_path / "a.gltf")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert set(before) == {"a.gltf", "a.bin"}

    def full(*_: Any) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("limner.files.write_gltf._Writer._json", full)
    with pytest.raises(RenderError, match=r"cannot write .*a\.gltf: No space left"):
        write(menagerie(), tmp_path / "a.gltf")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_measured_metal_is_written_by_its_colour(tmp_path: Path) -> None:
    """What it reflects straight on, times what it is lacquered with; that, and what glTF knows nothing of, is said."""
    gold = MetallicRoughness((1.0, 0.5, 1.0), conductor=Conductor((0.2, 1.0, 1.5), (4.0, 2.0, 1.0)), energy_compensation=True, name="gold")
    plaster = Lambert((0.5, 0.5, 0.5), roughness_degrees=20.0)
    scene = Scene(Node("n", shapes=(Shape(Box((1, 1, 1)), (gold,)), Shape(Box((2, 2, 2)), (plaster,)))))
    told = "\n".join(write(scene, tmp_path / "a.glb"))
    assert all(word in told for word in ("conductor is written as", "energy_compensation is left out", "roughness_degrees is left out"))
    material = load(tmp_path / "a.glb").shapes()[0][1].materials[0]
    assert isinstance(material, MetallicRoughness)
    assert material.conductor is None
    np.testing.assert_allclose(material.base_color, (16.64 / 17.44, 0.5 * 4.0 / 8.0, 1.25 / 7.25), atol=1e-6)
