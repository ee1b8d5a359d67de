"""A scene at a moment: the summary's car with its turning wheels, morphs and skins, each against what can be said without them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from menagerie import menagerie

from limner.errors import SceneError
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.scene.animation import Animation, FieldChannel, NodeChannel, WeightsChannel
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import PointLight
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.motion import KeyedMotion, Motion
from limner.scene.node import Node
from limner.scene.pose import animated, posed
from limner.scene.rig import Binding, Morph, Skin
from limner.scene.scene import Scene
from limner.scene.shape import Box, Shape, Sphere
from limner.scene.texture import Texels, Texture
from limner.scene.track import Track

STILL = (Track.constant((0.0, 0.0, 0.0)), Track.constant((0, 0, 0, 1), rotates=True), Track.constant((1.0, 1.0, 1.0)))
SQUARE = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], normals=[[0, 0, 1]] * 4)


def moving(translation: Track | None = None, rotation: Track | None = None, scale: Track | None = None) -> KeyedMotion:
    """A motion of which only what is given moves."""
    return KeyedMotion(translation or STILL[0], rotation or STILL[1], scale or STILL[2])


def places(scene: Scene, time: float = 0.0) -> dict[str, np.ndarray]:
    """Where every node stands, by its path."""
    return {placed.path: placed.world_from_object for placed in scene.walk(time)}


def quarter_turn() -> Track:
    """From nothing to 90 degrees about z in a second."""
    half = math.sqrt(0.5)
    return Track((0.0, 1.0), ((0, 0, 0, 1), (0, 0, half, half)), rotates=True)


def car() -> Scene:
    """The summary's example (12.2): a car that drives, with wheels that turn and that inherit where it is."""
    wheels = tuple(Node("wheel", transform.translate(x, 0, 0), shapes=(Shape(Sphere(0.5)),)) for x in (-1.0, 1.0))
    body = Node("car", children=(*wheels, Node("lamp", lights=(PointLight(name="head"),))), shapes=(Shape(Box((3, 1, 1))),))
    drive = NodeChannel("world/car", moving(Track((0.0, 2.0), ((0, 0, 0), (4, 0, 0)))))
    turn = NodeChannel("world/car/wheel#2", KeyedMotion(Track.constant((1, 0, 0)), quarter_turn(), STILL[2]))
    return Scene(Node("world", children=(body, Node("tree"))), animations=(Animation("drive", (drive, turn)),))


class TestNodes:
    """Translations, rotations and scales of the graph."""

    def test_wheels_go_with_the_car_and_turn(self) -> None:
        """At 1/2 s the car has gone one metre, and one wheel has turned by 45 degrees about its own axis."""
        found = places(car().at(0.5))
        np.testing.assert_allclose(found["world/car"][:3, 3], (1, 0, 0), atol=1e-12)
        np.testing.assert_allclose(found["world/car/wheel"], transform.translate(0, 0, 0), atol=1e-12)
        expected = transform.translate(2, 0, 0) @ transform.rotate_z(math.pi / 4)
        np.testing.assert_allclose(found["world/car/wheel#2"], expected, atol=1e-12)

    def test_nothing_is_left_to_move(self) -> None:
        """A moment is the same whenever it is looked at."""
        moment = car().at(0.5)
        for path, place in places(moment, 7.0).items():
            np.testing.assert_array_equal(place, places(moment)[path])

    def test_what_stands_still_is_shared(self) -> None:
        """Branches in which nothing changes are the very same nodes, and shapes of moved ones the very same shapes."""
        scene = car()
        moment = scene.at(0.5)
        assert moment.root.children[1] is scene.root.children[1]
        assert moment.root.children[0].children[0] is scene.root.children[0].children[0]
        assert moment.root.children[0].shapes[0] is scene.root.children[0].shapes[0]

    def test_animated_is_at_for_every_time(self) -> None:
        """Nodes that are left moving stand, at each time, where they stand in the scene of that time."""
        scene = animated(car())
        for time in (0.0, 0.3, 1.0, 5.0):
            expected = places(car().at(time))
            for path, place in places(scene, time).items():
                np.testing.assert_allclose(place, expected[path], atol=1e-12)

    def test_motions_stop_too(self) -> None:
        """A node's own motion is part of the moment, with an animation or without."""
        scene = Scene(Node("world", children=(Node("ball", motion=Motion.shift((2, 0, 0))),)))
        np.testing.assert_allclose(places(scene.at(0.25))["world/ball"][:3, 3], (0.5, 0, 0))

    def test_a_ground_leaves_nodes_their_paths(self) -> None:
        """Bug: a ground put everything a level deeper, and animations and skins no longer found their nodes. Fix: it stands beside them."""
        scene = menagerie()
        before = [placed.path for placed, _ in scene.at(0.5).shapes()]
        after = [placed.path for placed, _ in scene.with_ground().at(0.5).shapes()]
        assert after == [*before, "world/ground"]

    def test_a_scale_may_pass_through_zero(self) -> None:
        """Nothing is divided by it."""
        scale = Track((0.0, 1.0), ((1, 1, 1), (-1, -1, -1)))
        swell = Animation("", (NodeChannel("world", moving(scale=scale)),))
        scene = Scene(Node("world", shapes=(Shape(Sphere(1.0)),)), animations=(swell,))
        assert np.count_nonzero(places(scene.at(0.5))["world"]) == 1

    def test_an_animation_is_chosen_by_name_or_number(self) -> None:
        """The first unless told; an unknown one is answered with those that there are."""
        drive = car().animations[0]
        scene = car().replace(animations=(Animation("rest"), drive))
        for animation in ("drive", 1):
            np.testing.assert_allclose(places(scene.at(2.0, animation))["world/car"][:3, 3], (4, 0, 0))
        np.testing.assert_allclose(places(scene.at(2.0))["world/car"], np.eye(4))
        for unknown in ("fly", 2, -1):
            with pytest.raises(SceneError, match=r"no animation .*; it has 0 'rest', 1 'drive'"):
                scene.at(0.0, unknown)

    def test_a_lost_target_is_said(self) -> None:
        """An animation of a node that is not there is an error, by the node's path."""
        scene = car().replace(root=Node("world"))
        with pytest.raises(SceneError, match="moves 'world/car', and there is no such node"):
            scene.at(0.0)

    def test_start_and_end_are_the_keys(self) -> None:
        """Of what moves; constants have a key that is none."""
        assert (car().animations[0].start, car().animations[0].end) == (0.0, 2.0)


class TestFields:
    """Materials, lights, cameras and visibility."""

    def scene(self, *channels: FieldChannel) -> Scene:
        picture = Texture(Texels(np.zeros((1, 1, 4), dtype=np.uint8)))
        shapes = (Shape(Sphere(1.0), (MetallicRoughness(base_color_texture=picture, name="paint"),)), Shape(Box(), (Lambert(name="wall"),)))
        nodes = (
            Node("a", shapes=shapes), Node("b", shapes=shapes[:1]),
            Node("c", lights=(PointLight(name="lamp"),), cameras=(PerspectiveCamera(name="eye"),)),
        )  # fmt: skip
        return Scene(Node("world", children=nodes), animations=(Animation("", channels),))

    def test_all_materials_of_the_name_change(self) -> None:
        """In every node that shows it, and the one object is changed once."""
        moment = self.scene(FieldChannel("material", "paint", "base_color", Track((0.0, 1.0), ((0, 0, 0), (1, 0.5, 0.25))))).at(0.5)
        (_, one), (_, wall), (_, other) = moment.shapes()
        assert isinstance(one.materials[0], MetallicRoughness)
        assert one.materials[0].base_color == (0.5, 0.25, 0.125)
        assert other.materials[0] is one.materials[0]
        assert wall.materials[0].name == "wall"

    def test_what_lies_deeper_changes(self) -> None:
        """A texture's offset."""
        moment = self.scene(FieldChannel("material", "paint", "base_color_texture.offset", Track((0.0, 1.0), ((0, 0), (1, 2))))).at(0.25)
        material = moment.shapes()[0][1].materials[0]
        assert isinstance(material, MetallicRoughness)
        assert material.base_color_texture is not None
        assert material.base_color_texture.offset == (0.25, 0.5)

    def test_lights_and_cameras_change(self) -> None:
        """By name, several fields at once."""
        moment = self.scene(
            FieldChannel("light", "lamp", "intensity", Track((0.0, 1.0), (0.0, 8.0))),
            FieldChannel("light", "lamp", "color", Track.constant((1, 0, 0))),
            FieldChannel("camera", "eye", "yfov_degrees", Track((0.0, 1.0), (20.0, 60.0))),
        ).at(0.5)
        ((_, lamp),) = moment.lights()
        assert (lamp.intensity, lamp.color) == (4.0, (1.0, 0.0, 0.0))
        (eye,) = moment.cameras()
        assert isinstance(eye, PerspectiveCamera)
        assert eye.yfov_degrees == 40.0

    def test_nodes_come_and_go(self) -> None:
        """Visibility is a flag, up or down."""
        scene = self.scene(FieldChannel("node", "world/a", "visible", Track((0.0, 1.0), (1.0, 0.0), "step")))
        assert [len(scene.at(time).shapes()) for time in (0.0, 0.5, 1.0)] == [3, 3, 1]

    def test_overshoot_is_held(self) -> None:
        """A curve that leaves what a field allows is held at its bound."""
        keys = np.array([[[0.0], [0.1], [-9.0]], [[0.0], [0.1], [0.0]]])
        moment = self.scene(FieldChannel("material", "paint", "roughness", Track((0.0, 1.0), keys, "cubic"))).at(0.3)
        material = moment.shapes()[0][1].materials[0]
        assert isinstance(material, MetallicRoughness)
        assert material.roughness == 0.0

    def test_a_field_that_is_not_there_is_said(self) -> None:
        """With the kind of thing that lacks it."""
        with pytest.raises(SceneError, match="changes 'shine', and a MetallicRoughness has no such field"):
            self.scene(FieldChannel("material", "paint", "shine", Track.constant(1.0))).at(0.0)


class TestMorphs:
    """Meshes that turn into others."""

    def test_weights_are_sums(self) -> None:
        """p + w0 d0 + w1 d1, and normals unit."""
        lift, push = Morph(positions=[[0, 0, 1]] * 4, normals=[[0, 1, 0]] * 4), Morph(positions=[[1, 0, 0]] * 4)
        node = Node("world", shapes=(Shape(SQUARE, morphs=(lift, push)),), weights=(0.5, 2.0))
        ((_, shape),) = posed(Scene(node)).shapes()
        assert isinstance(shape.geometry, Mesh)
        assert shape.geometry.normals is not None
        np.testing.assert_allclose(shape.geometry.positions, np.add(SQUARE.positions, (2.0, 0.0, 0.5)))
        np.testing.assert_allclose(shape.geometry.normals, [[0, 0.5 / math.hypot(1, 0.5), 1 / math.hypot(1, 0.5)]] * 4, rtol=1e-6)
        assert shape.geometry.triangles is SQUARE.triangles or (shape.geometry.triangles == SQUARE.triangles).all()

    def test_weights_move(self) -> None:
        """An animation's weights are the node's."""
        node = Node("world", shapes=(Shape(SQUARE, morphs=(Morph(positions=[[0, 0, 1]] * 4),)),), weights=(9.0,))
        scene = Scene(node, animations=(Animation("", (WeightsChannel("world", Track((0.0, 1.0), (0.0, 1.0))),)),))
        ((_, shape),) = scene.at(0.25).shapes()
        assert isinstance(shape.geometry, Mesh)
        np.testing.assert_allclose(shape.geometry.positions[:, 2], 0.25)

    def test_morphs_that_do_not_fit_are_refused(self) -> None:
        """Row for row."""
        with pytest.raises(SceneError, match=r"morph.positions must have a row for each of the mesh's 4 positions, got 3"):
            Shape(SQUARE, morphs=(Morph(positions=[[0, 0, 1]] * 3),))
        with pytest.raises(SceneError, match="for meshes, got Sphere"):
            Shape(Sphere(1.0), morphs=(Morph(),))


class TestSkins:
    """Meshes that hang on joints."""

    def skinned(self, joints: tuple[Node, ...], led: list[list[int]], by: list[list[float]], place: np.ndarray | None = None) -> Scene:
        skin = Skin(tuple(f"world/{joint.name}" for joint in joints))
        body = Node("body", np.eye(4) if place is None else place, shapes=(Shape(SQUARE, binding=Binding(led, by)),), skin=skin)
        return Scene(Node("world", children=(*joints, body)))

    def in_world(self, scene: Scene) -> np.ndarray:
        ((placed, shape),) = scene.shapes()
        assert isinstance(shape.geometry, Mesh)
        return transform.transform_points(placed.world_from_object, shape.geometry.positions)

    def test_one_joint_is_a_node(self) -> None:
        """A mesh that hangs on one joint stands where a child of it would, wherever the node that shows it is."""
        place = transform.translate(1, 2, 3) @ transform.rotate_y(0.7) @ transform.scale(2.0)
        joint = Node("bone", place)
        for body in (np.eye(4), transform.translate(9, 9, 9) @ transform.rotate_x(1.0)):
            found = self.in_world(posed(self.skinned((joint,), [[0]] * 4, [[1.0]] * 4, body)))
            np.testing.assert_allclose(found, transform.transform_points(place, SQUARE.positions), atol=1e-5)

    def test_two_joints_are_their_mean(self) -> None:
        """Weights need not sum to one in the file; they do here."""
        joints = (Node("a", transform.translate(0, 0, 2)), Node("b", transform.translate(4, 0, 0)))
        found = self.in_world(posed(self.skinned(joints, [[0, 1]] * 4, [[3.0, 1.0]] * 4)))
        np.testing.assert_allclose(found, np.add(SQUARE.positions, (1.0, 0.0, 1.5)), atol=1e-6)

    def test_joints_inherit_and_move(self) -> None:
        """A forearm on an arm that turns by 90 degrees goes round with it."""
        forearm = Node("forearm", transform.translate(2, 0, 0))
        arm = Node("arm", children=(forearm,))
        skin = Skin(("world/arm/forearm",), transform.translate(-2, 0, 0)[None])
        body = Node("body", shapes=(Shape(SQUARE, binding=Binding([[0]] * 4, [[1.0]] * 4)),), skin=skin)
        turn = NodeChannel("world/arm", moving(rotation=quarter_turn()))
        scene = Scene(Node("world", children=(arm, body)), animations=(Animation("", (turn,)),))
        np.testing.assert_allclose(self.in_world(scene.at(0.0)), SQUARE.positions, atol=1e-6)
        np.testing.assert_allclose(self.in_world(scene.at(1.0)), SQUARE.positions[:, [1, 0, 2]] * (-1, 1, 1), atol=1e-6)

    def test_normals_stand_on_the_bent_surface(self) -> None:
        """Under uneven scale, too: they go by cofactors."""
        tilted = Mesh(SQUARE.positions @ transform.rotate_x(0.6)[:3, :3].T, SQUARE.triangles, normals=[transform.rotate_x(0.6)[:3, 2]] * 4)
        scene = self.skinned((Node("bone", transform.scale(1.0, 3.0, 0.5)),), [[0]] * 4, [[1.0]] * 4)
        body = scene.root.children[1]
        shape = Shape(tilted, binding=body.shapes[0].binding)
        root = Node("world", children=(scene.root.children[0], Node("body", shapes=(shape,), skin=body.skin)))
        ((_, bent),) = posed(scene.replace(root=root)).shapes()
        assert isinstance(bent.geometry, Mesh)
        assert bent.geometry.normals is not None
        a, b, c = bent.geometry.positions[:3].astype(np.float64)
        np.testing.assert_allclose(bent.geometry.normals @ np.stack([b - a, c - a]).T, 0.0, atol=1e-6)

    @pytest.mark.parametrize(
        ("make", "message"),
        [
            (lambda: Binding([[0]], [[-1.0]]), "binding.weights must be finite and not negative"),
            (lambda: Binding([[0.5]], [[1.0]]), "binding.joints must be integers"),
            (lambda: Binding([[0]], [[1.0, 1.0]]), "must have the shape of binding.joints"),
            (lambda: Skin(()), "skin.joints must be paths"),
            (lambda: Skin(("a",), np.zeros((2, 4, 4))), "skin.joint_from_mesh must have shape"),
            (lambda: Shape(SQUARE, binding=Binding([[0]] * 3, [[1.0]] * 3)), "a row for each of the mesh's 4 positions"),
        ],
    )
    def test_bad_rigs_are_refused(self, make: object, message: str) -> None:
        """In one line."""
        with pytest.raises(SceneError, match=message):
            make()  # type: ignore[operator]

    def test_missing_joints_are_said(self) -> None:
        """A joint that is no node, and one that the skin does not have."""
        lost = Scene(Node("world", shapes=(Shape(SQUARE, binding=Binding([[0]] * 4, [[1.0]] * 4)),), skin=Skin(("world/bone",))))
        with pytest.raises(SceneError, match="names the joint 'world/bone', and there is no such node"):
            posed(lost)
        with pytest.raises(SceneError, match="hangs on joint 3, its skin has 1"):
            posed(self.skinned((Node("bone"),), [[3]] * 4, [[1.0]] * 4))
