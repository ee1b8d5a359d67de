"""Skins and morphs while the shutter is open: at each time a ray sees the mesh as it then is."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from casting import cast, cast_at
from staging import SLOW_AS_PYTHON, lit_from

from limner.accel import bvh
from limner.linear import quaternion, transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.render import render
from limner.scene.animation import Animation, NodeChannel, WeightsChannel
from limner.scene.bending import bent_meshes
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import AmbientLight
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.motion import KeyedMotion
from limner.scene.node import Node
from limner.scene.pose import animated, posed
from limner.scene.rig import Binding, Morph, Skin
from limner.scene.scene import Scene
from limner.scene.shape import Shape
from limner.scene.texture import Texels, Texture
from limner.scene.track import Track
from limner.tables.build import flatten
from limner.tables.motion import instants

BOTH = pytest.mark.parametrize("renderer", ["ray", "path"])
CAMERA = PerspectiveCamera.look_at((0, 0.5, 4), (0, 0.5, 0), yfov_degrees=40)
GLOW = Lambert(color=(0, 0, 0), emission=(1, 1, 1))


def _widening(weights: Track) -> Scene:
    """A square of light whose right half goes to the right by the weight, on a black ground."""
    square = Mesh([[-1, 0, 0], [0, 0, 0], [0, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    shape = Shape(square, (GLOW,), morphs=(Morph([[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 0]]),))
    node = Node("square", shapes=(shape,), weights=(0.0,))
    animation = Animation("widen", (WeightsChannel("world/square", weights),))
    return Scene(Node(children=(node,)), CAMERA, (0.0, 0.0, 0.0), animations=(animation,))


def _arm(degrees: float = 80.0) -> Scene:
    """A lit arm with a shining patch, whose upper half is led by a joint that turns, beside a ball that stands still."""
    tube = primitives.tube(np.linspace((0, 0, 0), (0, 1.6, 0), 5), 0.25, n=8, caps="flat")
    up = np.clip(tube.positions[:, 1] - 0.4, 0.0, 0.8) / 0.8
    binding = Binding(np.tile([0, 1], (len(up), 1)), np.stack([1.0 - up, up], axis=1))
    skin = Skin(("world/low", "world/low/high"), np.stack([np.eye(4), transform.translate(0, -0.7, 0)]))
    paint = Texture(Texels(np.array([[[255, 80, 40, 255], [40, 120, 255, 255]]], np.uint8)))
    arm = Node("arm", shapes=(Shape(tube, (MetallicRoughness(base_color_texture=paint, roughness=0.6),), binding=binding),), skin=skin)
    turned = np.stack([quaternion.from_axis_angle((0, 0, 1), np.radians(angle)) for angle in (0.0, -degrees)])
    motion = KeyedMotion(Track.constant((0.0, 0.7, 0.0)), Track((0.0, 1.0), turned, rotates=True), Track.constant((1.0, 1.0, 1.0)))
    bones = Node("low", children=(Node("high", transform.translate(0, 0.7, 0)),))
    still = Node("ball", transform.translate(-0.9, 0.4, 0), shapes=(Shape(primitives.uv_sphere(8, 4, 0.3)),))
    lights = (lit_from((0.4, 1.0, 0.6)), Node(lights=(AmbientLight(intensity=0.3),)))
    animation = Animation("bow", (NodeChannel("world/low/high", motion),))
    return Scene(Node(children=(bones, arm, still, *lights)), CAMERA, (0.1, 0.1, 0.1), animations=(animation,))


def _opened(scene: Scene, shutter=(0.0, 1.0)):
    """The scene when the shutter opens, and what its meshes turn into."""
    opening = posed(animated(scene, None, shutter[0]), shutter[0])
    return opening, bent_meshes(lambda time: posed(animated(scene, None, time), time), opening, shutter)


def test_each_ray_meets_the_mesh_of_its_time():
    """t, u, v and triangle, bit for bit, are those that the search through all triangles finds in a mesh of the mixed vertices."""
    opening, bent = _opened(_arm())
    built = flatten(opening, CAMERA, 8, 8, tessellate=False, bent=bent)
    moved = instants(opening, built.tables, CAMERA, 8, 8, (0.0, 1.0), built.n_keys)
    tree = bvh.build(built.tables, instants=moved)
    random = np.random.default_rng(3)
    origins = random.uniform((-2, -0.5, 2), (2, 2, 3), (60, 3))
    directions = random.uniform((-0.8, 0, -0.3), (1.2, 1.6, 0.3), (60, 3)) - origins
    (mesh,) = bent
    keys, n_hits = (mesh, *bent[mesh]), 0
    for instant in (0, 500, len(moved.cameras) - 1):
        (row,) = moved.instances[instant * len(moved.moving) : (instant + 1) * len(moved.moving)]
        built.tables.instances[moved.moving] = row
        now, later = keys[row["key"] - 1], keys[row["key"]]
        mixed = now.positions + (later.positions - now.positions) * row["share"]
        bare = [placed.node for placed in opening.root.walk() if placed.node.name == "ball"]
        alone = Node("arm", shapes=(Shape(dataclasses.replace(mesh, positions=mixed)),))
        oracle = cast(Scene(Node(children=(alone, *bare))), origins, directions, "linear")
        found = cast_at(built.tables, tree, origins, directions)
        for field in ("t", "u", "v", "triangle", "instance", "occluded"):
            np.testing.assert_array_equal(getattr(found, field), getattr(oracle, field))
        n_hits += int((found.instance == 0).sum())
    assert n_hits > 40


@SLOW_AS_PYTHON
@BOTH
def test_a_widening_square_ends_in_a_ramp(renderer):
    """Closed form: a place that the edge, at constant speed, passes at time s is covered for 1 - s of the time."""
    scene = _widening(Track((0.0, 1.0), (0.0, 1.0)))
    seen = render(scene, width=48, height=3, renderer=renderer, samples=64, shutter=(0, 1), default_lights=False).pixels[1, :, 0]
    x = (np.arange(48) - 23.5) / 3 * 2 * 4 * np.tan(np.radians(20))
    np.testing.assert_allclose(seen[(x > 0) & (x < 1.2)], np.clip(1.0 - x, 0, 1)[(x > 0) & (x < 1.2)], atol=0.13)
    np.testing.assert_array_equal(seen[(x > -0.9) & (x < -0.1)], 1.0)
    np.testing.assert_array_equal(seen[x > 1.2], 0.0)


@SLOW_AS_PYTHON
@BOTH
def test_an_open_shutter_sees_the_mean_of_still_pictures(renderer):
    """An arm that turns by 80 degrees, lit and textured: the mean over 160 moments, in which nothing is blurred."""
    options = {"width": 24, "height": 18, "renderer": renderer}
    blurred = render(_arm(), samples=1024, shutter=(0.0, 1.0), **options).pixels
    stills = [render(_arm(), samples=16, sampler="jittered", seed=k, time=(k + 0.5) / 160, **options).pixels for k in range(160)]
    difference = blurred - np.mean(stills, axis=0)
    assert np.abs(difference).max() < 0.015
    assert abs(difference.mean()) < 0.0002


@SLOW_AS_PYTHON
@BOTH
def test_a_lamp_that_grows_gives_as_much_light_as_it_is_large(renderer):
    """A far square of light that becomes three times as large: its floor is twice as bright, on average, as at first."""
    square = Mesh([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], [[0, 1, 2], [0, 2, 3]])
    wider = Morph([[0, 0, 0], [2, 0, 0], [2, 0, 0], [0, 0, 0]])
    lamp = Node("lamp", transform.translate(-1.5, 30, 0), shapes=(Shape(square, (GLOW,), morphs=(wider,)),), weights=(0.0,))
    floor = Node("floor", shapes=(Shape(primitives.plane(1.0)),))
    animation = Animation("grow", (WeightsChannel("world/lamp", Track((0.0, 1.0), (0.0, 1.0))),))
    camera = PerspectiveCamera.look_at((0, 0.5, 0), (0, 0, 0), up=(0, 0, 1), yfov_degrees=40)
    scene = Scene(Node(children=(lamp, floor)), camera, (0.0, 0.0, 0.0), animations=(animation,))
    options = {"width": 8, "height": 8, "renderer": renderer, "emitters": True, "default_lights": False}
    if renderer == "path":
        del options["emitters"]
    first = render(scene, samples=64, **options).pixels[..., :3].mean()
    assert render(scene, samples=256, shutter=(0, 1), **options).pixels[..., :3].mean() == pytest.approx(2.0 * first, rel=0.02)


@SLOW_AS_PYTHON
@BOTH
def test_threads_and_tiles_change_no_bit(renderer):
    """Each thread mixes its own vertices."""
    options = {"width": 30, "height": 20, "renderer": renderer, "samples": 4, "shutter": (0.0, 1.0)}
    expected = render(_arm(), threads=1, **options).pixels
    np.testing.assert_array_equal(render(_arm(), threads=2, tile_size=8, **options).pixels, expected)


def test_as_many_keys_as_the_way_is_bent():
    """A straight way needs two; back and forth needs one where it turns; an arc needs many; what rests has none."""
    def n_keys(scene: Scene, shutter=(0.0, 1.0)) -> list[int]:
        return [1 + len(later) for later in _opened(scene, shutter)[1].values()]

    assert n_keys(_widening(Track((0.0, 1.0), (0.0, 1.0)))) == [2]
    assert n_keys(_widening(Track((0.0, 0.25, 0.5, 0.75, 1.0), (0.0, 1.0, 0.0, 1.0, 0.0)))) == [5]
    assert n_keys(_arm(80)) == [17]
    assert n_keys(_arm(), (1.0, 2.0)) == n_keys(_arm(0.0)) == n_keys(_arm(), (0.5, 0.5)) == []


@BOTH
def test_what_does_not_bend_while_the_shutter_is_open_is_a_still_picture(renderer):
    """An animation that is over: the same bits as of its end."""
    options = {"width": 8, "height": 6, "renderer": renderer, "samples": 2}
    np.testing.assert_array_equal(
        render(_arm(), shutter=(1.0, 3.0), **options).pixels, render(_arm(), shutter=(1.0, 1.0), **options).pixels
    )
