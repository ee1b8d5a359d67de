"""Animations, morph targets and skins of glTF: what the file says is where things stand."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from animated_gltf import TRIANGLE, channel, pointer

from limner.errors import LimnerWarning
from limner.files.load import load
from limner.files.save_mesh import save_model
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.scene.light import SpotLight
from limner.scene.material import MetallicRoughness
from limner.scene.scene import Scene
from limner.scene.texture import Texture

KHRONOS = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "khronos"


def place(scene: Scene, path: str) -> np.ndarray:
    """Where a node stands."""
    return next(placed.world_from_object for placed in scene.walk() if placed.path == path)


def geometry(scene: Scene) -> Mesh:
    """The mesh of the first shape."""
    mesh = scene.shapes()[0][1].geometry
    assert isinstance(mesh, Mesh)
    return mesh


def points(scene: Scene) -> np.ndarray:
    """The vertices of all meshes, in the world."""
    meshes = [(placed, shape.geometry) for placed, shape in scene.shapes() if isinstance(shape.geometry, Mesh)]
    return np.concatenate([transform.transform_points(placed.world_from_object, mesh.positions) for placed, mesh in meshes])


def test_what_does_not_move_stays_as_the_file_has_it(writer: Any, tmp_path: Path) -> None:
    """A rotation with keys between a translation and a negative scale without."""
    writer.primitive(TRIANGLE)
    writer.document["nodes"] = [{"mesh": 0, "name": "n", "translation": [1, 2, 3], "scale": [-2, 1, 1]}]
    half = math.sqrt(0.5)
    channel(writer, {"node": 0, "path": "rotation"}, [0, 1], [[0, 0, 0, 1], [0, half, 0, half]])
    scene = load(writer.save(tmp_path))
    expected = transform.translate(1, 2, 3) @ transform.rotate_y(math.pi / 4) @ transform.scale(-2, 1, 1)
    np.testing.assert_allclose(place(scene.at(0.5), "world/n"), expected, atol=1e-6)
    np.testing.assert_allclose(place(scene, "world/n"), transform.translate(1, 2, 3) @ transform.scale(-2, 1, 1))
    assert scene.notes == ()


def test_a_matrix_is_taken_apart(writer: Any, tmp_path: Path) -> None:
    """A node with a matrix that is animated after all keeps what does not move of it."""
    matrix = transform.translate(1, 2, 3) @ transform.rotate_x(0.4) @ transform.scale(1, 2, 3)
    writer.primitive(TRIANGLE)
    writer.document["nodes"] = [{"mesh": 0, "name": "n", "matrix": matrix.T.reshape(-1).tolist()}]
    channel(writer, {"node": 0, "path": "translation"}, [0, 1], [[0, 0, 0], [8, 0, 0]])
    found = place(load(writer.save(tmp_path)).at(0.5), "world/n")
    np.testing.assert_allclose(found, transform.translate(4, 0, 0) @ transform.rotate_x(0.4) @ transform.scale(1, 2, 3), atol=1e-6)


@pytest.mark.parametrize(("dtype", "limit"), [("i1", 127), ("i2", 32767)])
def test_rotations_may_be_integers(writer: Any, tmp_path: Path, dtype: str, limit: int) -> None:
    """Normalised ones (3.11)."""
    writer.primitive(TRIANGLE)
    writer.document["nodes"] = [{"mesh": 0, "name": "n"}]
    channel(writer, {"node": 0, "path": "rotation"}, [0], [[0, 0, limit, 0]], dtype=dtype, normalized=True)
    np.testing.assert_allclose(place(load(writer.save(tmp_path)).at(0.0), "world/n"), transform.rotate_z(math.pi), atol=1e-6)


def test_nodes_of_one_name_are_told_apart(writer: Any, tmp_path: Path) -> None:
    """Siblings of one name, of which the second moves."""
    writer.primitive(TRIANGLE)
    writer.document["nodes"] = [{"name": "n", "mesh": 0}, {"name": "n", "mesh": 0}]
    writer.document["scenes"] = [{"nodes": [0, 1]}]
    channel(writer, {"node": 1, "path": "translation"}, [0], [[5, 0, 0]])
    moment = load(writer.save(tmp_path)).at(0.0)
    assert [placed.world_from_object[0, 3] for placed, _ in moment.shapes()] == [0.0, 5.0]


def test_morph_targets_and_their_weights(writer: Any, tmp_path: Path) -> None:
    """Of the mesh, of the node, of the animation: the later counts."""
    primitive = writer.primitive([[9, 9, 9]] * 4 + TRIANGLE, [4, 5, 6])
    deltas = np.concatenate([np.full((4, 3), 7.0), [[0, 0, 1]] * 3])
    primitive["targets"] = [{"POSITION": writer.accessor(deltas)}, {"POSITION": writer.accessor(2 * deltas)}]
    writer.document["meshes"][0]["weights"] = [1.0, 0.0]
    path = writer.save(tmp_path)
    import limner.scene.pose as pose

    np.testing.assert_allclose(geometry(pose.posed(load(path))).positions, np.add(TRIANGLE, (0, 0, 1)))
    writer.document["nodes"][0]["weights"] = [0.5, 0.5]
    channel(writer, {"node": 0, "path": "weights"}, [0, 1], [0, 0, 1, 2])
    scene = load(writer.save(tmp_path))
    np.testing.assert_allclose(geometry(pose.posed(scene)).positions, np.add(TRIANGLE, (0, 0, 1.5)))
    np.testing.assert_allclose(geometry(scene.at(0.5)).positions, np.add(TRIANGLE, (0, 0, 2.5)))


def test_a_skin_with_eight_joints_a_vertex(writer: Any, tmp_path: Path) -> None:
    """Two sets of joints, bytes and fractions; the inverse bind matrices undo where the joints stand."""
    primitive = writer.primitive(TRIANGLE)
    for k, joint in enumerate((0, 1)):
        primitive["attributes"][f"JOINTS_{k}"] = writer.accessor([[joint, 0, 0, 0]] * 3, "u1")
        primitive["attributes"][f"WEIGHTS_{k}"] = writer.accessor([[255, 0, 0, 0]] * 3, "u1", normalized=True)
    binds = np.stack([np.eye(4), transform.translate(0, -4, 0)]).transpose(0, 2, 1).reshape(-1, 16)
    view = writer.view(binds.astype("<f4").tobytes())
    writer.document["accessors"].append({"bufferView": view, "componentType": 5126, "count": 2, "type": "MAT4"})
    writer.document["skins"] = [{"joints": [1, 2], "inverseBindMatrices": len(writer.document["accessors"]) - 1}]
    writer.document["nodes"] = [
        {"mesh": 0, "skin": 0, "translation": [50, 0, 0]}, {"name": "a"}, {"name": "b", "translation": [0, 4, 2]},
    ]  # fmt: skip
    writer.document["scenes"] = [{"nodes": [0, 1, 2]}]
    scene = load(writer.save(tmp_path)).at(0.0)
    ((placed, shape),) = scene.shapes()
    assert isinstance(shape.geometry, Mesh)
    found = transform.transform_points(placed.world_from_object, shape.geometry.positions)
    np.testing.assert_allclose(found, np.add(TRIANGLE, (0, 0, 1)), atol=1e-5)


def test_pointers(writer: Any, tmp_path: Path) -> None:
    """KHR_animation_pointer: colours, factors, textures' places, lights, visibility, and nodes as ever."""
    primitive = writer.primitive(TRIANGLE, material=0)
    primitive["attributes"]["TEXCOORD_0"] = writer.accessor([[0, 0], [1, 0], [0, 1]])
    writer.picture([[[255, 0, 0]]])
    writer.document["materials"] = [
        {"name": "m", "emissiveFactor": [1, 0, 0], "pbrMetallicRoughness": {"baseColorTexture": {
            "index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2, 3]}}}},
         "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}},
        {"name": "m"},
    ]  # fmt: skip
    writer.primitive(TRIANGLE, material=1)
    writer.document["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}}
    writer.document["nodes"] = [{"mesh": 0, "name": "n"}, {"extensions": {"KHR_lights_punctual": {"light": 0}}}]
    writer.document["scenes"] = [{"nodes": [0, 1]}]
    transformed = "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform"
    channel(writer, pointer("/materials/0/pbrMetallicRoughness/baseColorFactor"), [0, 1], [[0, 0, 0, 0], [1, 0.5, 0, 1]])
    channel(writer, pointer("/materials/0/emissiveFactor"), [0, 1], [[0, 0, 0], [0, 4, 0]])
    channel(writer, pointer(f"{transformed}/offset"), [0, 1], [[0.25, 0.5], [1.25, 0.5]])
    channel(writer, pointer("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle"), [0, 1], [0.2, 1.0])
    channel(writer, pointer("/nodes/0/translation"), [0, 1], [[0, 0, 0], [0, 6, 0]])
    scene = load(writer.save(tmp_path))
    at_rest, moment = scene.at(0.0), scene.at(0.5)
    first, second = (shape.materials[0] for _, shape in moment.shapes())
    assert isinstance(first, MetallicRoughness)
    assert isinstance(second, MetallicRoughness)
    assert (first.base_color, first.alpha, first.emission) == ((0.5, 0.25, 0.0), 0.5, (0.0, 4.0, 0.0))
    assert second.base_color == (1.0, 1.0, 1.0)
    resting = scene.shapes()[0][1].materials[0]
    assert isinstance(resting, MetallicRoughness)
    assert first.base_color_texture is not None
    assert resting.base_color_texture is not None
    np.testing.assert_allclose(np.subtract(first.base_color_texture.offset, resting.base_color_texture.offset), (0.5, 0.0), atol=1e-12)
    lights = [light for _, light in moment.lights()]
    assert isinstance(lights[0], SpotLight)
    assert lights[0].outer_degrees == pytest.approx(math.degrees(0.6))
    assert place(moment, "world/n")[1, 3] == 3.0
    assert at_rest.shapes()[0][1].materials[0].alpha == 0.0


def test_pointers_into_extensions(writer: Any, tmp_path: Path) -> None:
    """Coats, colours of parts, indices, and the places of their pictures move; so do the morphs of a mesh, wherever it is shown."""
    primitive = writer.primitive(TRIANGLE, material=0)
    primitive["attributes"]["TEXCOORD_0"] = writer.accessor([[0, 0], [1, 0], [0, 1]])
    primitive["targets"] = [{"POSITION": writer.accessor([[0, 0, 1]] * 3)}]
    writer.picture([[[255, 0, 0]]])
    writer.document["materials"] = [{"name": "m", "extensions": {
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatTexture": {"index": 0}, "clearcoatNormalTexture": {"index": 0}},
        "KHR_materials_sheen": {}, "KHR_materials_ior": {"ior": 1.25},
    }}]  # fmt: skip
    writer.document["nodes"] = [{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "weights": [0.75]}]
    writer.document["scenes"] = [{"nodes": [0, 1]}]
    root = "/materials/0/extensions/"
    coat = f"{root}KHR_materials_clearcoat/"
    channel(writer, pointer(f"{coat}clearcoatFactor"), [0, 1], [0, 1])
    channel(writer, pointer(f"{coat}clearcoatTexture/extensions/KHR_texture_transform/offset"), [0, 1], [[0, 0], [1, 0]])
    channel(writer, pointer(f"{coat}clearcoatNormalTexture/scale"), [0, 1], [1, 3])
    channel(writer, pointer(f"{root}KHR_materials_sheen/sheenColorFactor"), [0, 1], [[0, 0, 0], [1, 0.5, 0.25]])
    channel(writer, pointer(f"{root}KHR_materials_ior/ior"), [0, 1], [1.25, 1.75])
    channel(writer, pointer("/meshes/0/weights"), [0, 1], [0, 1])
    scene = load(writer.save(tmp_path))
    save_model(scene, tmp_path / "again.glb")
    for found in (scene, load(tmp_path / "again.glb")):
        (_, first), (_, second) = found.at(0.5).shapes()
        look = first.materials[0]
        assert isinstance(look, MetallicRoughness)
        assert look.clearcoat is not None
        assert look.sheen is not None
        assert isinstance(look.clearcoat.factor_texture, Texture)
        assert (look.clearcoat.factor, look.clearcoat.normal_scale, look.ior) == (0.5, 2.0, 1.5)
        assert look.clearcoat.factor_texture.offset == (0.5, 0.0)
        assert look.sheen.color == (0.5, 0.25, 0.125)
        assert isinstance(first.geometry, Mesh)
        assert isinstance(second.geometry, Mesh)
        assert (first.geometry.positions[0, 2], second.geometry.positions[0, 2]) == (0.5, 0.75)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda a: a["samplers"][0].update(interpolation="SPLINE"), "must be one of STEP, LINEAR, CUBICSPLINE"),
        (lambda a: a["samplers"][0].update(interpolation="CUBICSPLINE"), "must have 6 x 3 numbers for 2 keys, got 6"),
        (lambda a: a["samplers"][0].update(output=99), "must be an index below"),
        (lambda a: a["channels"][0].update(sampler=7), "must be an index below 1"),
        (lambda a: a["channels"][0]["target"].update(path="colour"), "must be translation, rotation, scale or weights"),
        (lambda a: a["channels"][0]["target"].update(pointer("/materials/9/alphaCutoff")), "is not there or cannot be animated"),
        (lambda a: a["channels"][0]["target"].update(pointer("/nodes/0/name")), "must be translation, rotation, scale or weights"),
        (lambda a: a["channels"][0]["target"].update(node="zero"), "must be an integer"),
    ],
)
def test_a_broken_channel_is_left_out(writer: Any, tmp_path: Path, change: Any, message: str) -> None:
    """With a line that says where; the model is there."""
    writer.primitive(TRIANGLE)
    channel(writer, {"node": 0, "path": "translation"}, [0, 1], [[0, 0, 0], [1, 0, 0]])
    change(writer.document["animations"][0])
    with pytest.warns(LimnerWarning, match=message):
        scene = load(writer.save(tmp_path))
    assert len(scene.shapes()) == 1
    assert scene.animations == ()


def test_keys_that_do_not_grow_are_left_out(writer: Any, tmp_path: Path) -> None:
    """The first of a time counts."""
    writer.primitive(TRIANGLE)
    writer.document["nodes"][0]["name"] = "n"
    channel(writer, {"node": 0, "path": "translation"}, [0, 1, 1, 2], [[0, 0, 0], [1, 0, 0], [9, 0, 0], [2, 0, 0]])
    with pytest.warns(LimnerWarning, match="1 keys whose time is not after the one before are left out"):
        scene = load(writer.save(tmp_path))
    assert place(scene.at(1.5), "world/n")[0, 3] == 1.5


@pytest.mark.parametrize("name", ["CesiumMan", "Fox", "BrainStem", "RiggedSimple", "SimpleSkin", "AnimatedMorphCube", "InterpolationTest"])
def test_khronos_models_move(name: str) -> None:
    """They load without a word; every animation moves something, and nothing runs away."""
    path = KHRONOS / name / f"{name}.glb"
    found = sorted((KHRONOS / name).rglob("*.gl*"))
    if not found:
        pytest.skip(f"the Khronos model {name} is not here")
    scene = load(path if path.exists() else found[0])
    size = np.ptp(scene.at(0.0).bounds(), axis=0).max()
    for animation in scene.animations:
        first, later = (scene.at(animation.start + part * (animation.end - animation.start), animation.name) for part in (0.0, 0.37))
        before, after = points(first), points(later)
        moved = np.linalg.norm(after - before, axis=1)
        assert 0.0 < moved.max() < 2.0 * size
