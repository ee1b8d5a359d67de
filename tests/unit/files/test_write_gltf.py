"""Scenes into glTF: what the document says, and what comes back when it is read."""

from __future__ import annotations

import dataclasses
import math
import os
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from menagerie import ODD_NAME, menagerie, seamed, texels
from written_gltf import TRIANGLE, again, document, geometry, places, plain, saved, showing

from limner.errors import LimnerWarning, RenderError, SceneError, UnsupportedError
from limner.files.gltf_material import turned_transform
from limner.files.load import load
from limner.files.save_mesh import save_model
from limner.files.write_gltf import write
from limner.files.write_gltf_exact import given_transform, inverted, parts_of
from limner.files.write_gltf_mesh import vertices_of
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.scene.animation import Animation, FieldChannel
from limner.scene.camera import PerspectiveCamera
from limner.scene.displacement import Displacement
from limner.scene.environment import Environment
from limner.scene.light import AmbientLight, PointLight, SphereLight
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.material_extensions import Conductor
from limner.scene.node import Node
from limner.scene.rig import Binding, Morph, Skin
from limner.scene.scene import Scene
from limner.scene.shape import Box, Difference, Plane, Shape, Solid, Sphere
from limner.scene.texture import Texels, Texture
from limner.scene.track import Track

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
