"""Materials into glTF, and what moves: bones, morphs, textures that slide, and their animations."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from menagerie import menagerie, texels
from written_gltf import TRIANGLE, again, document, geometry, places, plain, saved, showing

from limner.files.load import load
from limner.files.write_gltf import write
from limner.files.write_gltf_material import nearest
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.scene.animation import Animation, FieldChannel, NodeChannel
from limner.scene.material import BlinnPhong, CoolToWarm, Dielectric, Lambert, MetallicRoughness
from limner.scene.material_extensions import Clearcoat
from limner.scene.motion import KeyedMotion, Motion
from limner.scene.node import Node
from limner.scene.procedural import Checker
from limner.scene.rig import Binding, Morph, Skin
from limner.scene.scene import Scene
from limner.scene.shape import Shape
from limner.scene.texture import Texels, Texture
from limner.scene.track import Track

# --- materials ------------------------------------------------------------------------------------------------------------


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


def test_a_coat_s_normal_map_has_tangents_in_the_file(tmp_path: Path) -> None:
    """Without a normal map of the material's own a reader would not know them; with one they are left to it. The picture is the same."""
    bumps = Texture(Texels(np.full((2, 2, 4), 128, dtype=np.uint8)))
    coat = Clearcoat(1.0, normal_texture=bumps)
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    mesh = Mesh(corners, [[0, 1, 2]], normals=[[0, 0, 1]] * 3, uvs=[[0, 0], [1, 0], [0, 1]])
    for look, expected in ((MetallicRoughness(clearcoat=coat), True), (MetallicRoughness(clearcoat=coat, normal_texture=bumps), False)):
        primitive = saved(showing(look, mesh=mesh), tmp_path)["meshes"][0]["primitives"][0]
        assert ("TANGENT" in primitive["attributes"]) is expected
    found = geometry(again(showing(MetallicRoughness(clearcoat=coat), mesh=mesh), tmp_path))
    np.testing.assert_array_equal(found.tangents, [[1, 0, 0, 1]] * 3)


def test_what_is_animated_rests_where_it_did(tmp_path: Path) -> None:
    """A bone whose quaternion a file had in single precision, not quite of length 1: its matrix comes back to the bit."""
    quaternion = np.float32([0.2588191032409668, 0.0, 0.0, 0.9659258127212524]).astype(np.float64)
    size = (1.0, 0.9999999403953552, 0.9999999403953552)
    matrix = transform.compose_trs((0.0, 1.0, 0.0), quaternion, size)
    turn = KeyedMotion(Track.constant((0, 1, 0)), Track((0, 1), [[0, 0, 0, 1], [1, 0, 0, 0]], rotates=True), Track.constant(size))
    scene = Scene(Node(children=(Node("bone", matrix),)), animations=(Animation("a", (NodeChannel("world/bone", turn),)),))
    np.testing.assert_array_equal(places(again(scene, tmp_path))["world/bone"], matrix)


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
