"""Distribution ray tracing as a whole (FoCG 13.4): samplers, glossy reflections, and the promise of the same bits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, checkers, lit_from, place, scene_of, two_triangles

from limner.errors import SceneError, UnsupportedError
from limner.kernel.sampler_kinds import SAMPLERS
from limner.linear import transform
from limner.render import Renderer, render
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.fog import Fog
from limner.scene.light import AmbientLight, DiskLight, RectangleLight, SphereLight
from limner.scene.material import BlinnPhong, CoolToWarm, Dielectric, Lambert, MetallicRoughness
from limner.scene.motion import Motion
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Cylinder, Difference, Plane, Shape, Solid, Sphere

DARK = Node(lights=(AmbientLight(intensity=0.0),))
GLOW = Lambert(color=0, emission=(1.0, 1.0, 1.0))
SHEET = two_triangles((-0.125, -0.25, 0), (0.125, -0.25, 0), (0.125, 0.25, 0), (-0.125, 0.25, 0))
BOTH = pytest.mark.parametrize("renderer", ["ray", "path"])


def _everything() -> Scene:
    """Glass, fog, soft shadows, a lens, a moving ball, blurred mirrors and rough metal in one picture."""
    return scene_of(
        place(Plane(), Lambert(texture=checkers(2))),
        place(Sphere(0.5), Dielectric(1.5, absorption=(0.2, 0.1, 0.4)), at=(-0.8, 0.5, 0)),
        place(Sphere(0.2), Dielectric(1.0), at=(-0.8, 0.5, 0)),
        place(Box((0.6, 0.6, 0.6)), Dielectric(1.3, roughness=0.3), at=(0.3, 0.3, 0.6)),
        place(Sphere(0.4), MetallicRoughness((0.9, 0.6, 0.3), metallic=1.0, roughness=0.3, double_sided=True), at=(0.8, 0.4, -0.3)),
        place(Sphere(0.3), BlinnPhong(diffuse=(0.1, 0.1, 0.1), mirror=0.8, mirror_blur=0.3), at=(0.1, 0.3, -0.8)),
        Node("mover", transform.translate(0.0, 1.2, 0.0), shapes=(Shape(Sphere(0.2)),), motion=Motion.shift((0.5, 0.3, 0.0))),
        Node("turner", transform.translate(1.0, 1.3, 0.0), shapes=(Shape(Box((0.3,) * 3), (GLOW,)),), motion=Motion.turn((1, 1, 0), 80)),
        Node("disk", transform.frame_from_gaze((1, 3, 1), (-1, -3, -1), (0, 0, 1)), lights=(DiskLight(intensity=6.0),)),
        Node("ball", transform.translate(-2, 2, 1), lights=(SphereLight(intensity=9.0, radius=0.2),)),
        camera=PerspectiveCamera.look_at(
            (0.2, 1.6, 3.6), (0, 0.6, 0), yfov_degrees=36, aperture_radius=0.03, motion=Motion.shift((0.05, 0, 0))
        ),
        background=(0.1, 0.2, 0.3),
    ).replace(fog=Fog(density=0.02))  # fmt: skip


ALL = {"glossy": True, "emitters": True, "shutter": (0.0, 1.0)}


# --- the same bits --------------------------------------------------------------------------------------------------------


@SLOW_AS_PYTHON
@BOTH
@pytest.mark.parametrize("sampler", [None, "multijittered"])
def test_threads_and_tiles_change_no_bit(renderer, sampler):
    """With all effects at once: a pixel's samples are its own, whoever computes them, and in whatever order."""
    options = {"width": 50, "height": 40, "renderer": renderer, "samples": 5, "sampler": sampler, "seed": 3, **ALL}
    expected = render(_everything(), threads=1, tile_size=64, **options).pixels
    for threads, tile_size in ((2, 8), (3, 16)):
        np.testing.assert_array_equal(render(_everything(), threads=threads, tile_size=tile_size, **options).pixels, expected)
    assert np.isfinite(expected).all()
    assert (render(_everything(), **{**options, "seed": 4}).pixels != expected).any()


@SLOW_AS_PYTHON
@BOTH
def test_refining_ends_in_the_same_picture(renderer):
    """Better and better pictures of a moving scene through a lens; the last has the bits of the one that is made at once."""
    options = {"width": 24, "height": 18, "renderer": renderer, "samples": 6, "sampler": "jittered", **ALL}
    with Renderer(_everything(), **options) as renderer_:
        *_, last = renderer_.refine()
        np.testing.assert_array_equal(last.pixels, renderer_.render().pixels)


@SLOW_AS_PYTHON
@BOTH
def test_a_still_scene_needs_no_shutter(renderer):
    """What does not move is the same picture, to the bit, whether the shutter stays open or not."""
    scene = scene_of(place(Sphere(0.5)), place(Plane(), at=(0, -0.5, 0)), camera=PerspectiveCamera.look_at((0, 1, 3), (0, 0, 0)))
    options = {"width": 20, "height": 15, "renderer": renderer, "samples": 4}
    np.testing.assert_array_equal(render(scene, shutter=(0, 1), **options).pixels, render(scene, **options).pixels)


# --- samplers -------------------------------------------------------------------------------------------------------------


@SLOW_AS_PYTHON
@BOTH
@pytest.mark.parametrize("sampler", SAMPLERS)
def test_samplers_agree_in_the_mean(renderer, sampler):
    """However samples are spread, the picture they converge to is one: blocks of it, of all effects at once."""
    options = {"width": 24, "height": 16, "renderer": renderer, **ALL, "max_depth": 4}
    expected = render(_everything(), samples=1024, seed=9, **options).pixels[..., :3].reshape(4, 4, 4, 6, 3).mean(axis=(1, 3))
    found = render(_everything(), samples=256, sampler=sampler, **options).pixels[..., :3].reshape(4, 4, 4, 6, 3).mean(axis=(1, 3))
    # A regular grid is no random one: what it sees of few lights and facets is the same for all pixels, but for their order.
    np.testing.assert_allclose(found, expected, rtol=0.06, atol=0.03)


@SLOW_AS_PYTHON
def test_edges_are_smoother_where_samples_are_spread():
    """A slanted edge: the error of each pixel's coverage is least for nets, most for random points (FoCG 13.4.1)."""
    wall = place(two_triangles((-9, -9, 0), (-1.6, -9, 0), (1.5, 9, 0), (-9, 9, 0)), GLOW)
    camera = OrthographicCamera.look_at((0, 0, 1), (0, 0, 0), height=2.0)
    scene = scene_of(wall, DARK, camera=camera, background=(0.0, 0.0, 0.0))
    options = {"width": 33, "height": 33, "renderer": "ray"}
    exact = render(scene, samples=4096, **options).pixels[..., 0]

    def error(sampler: str) -> float:
        seen = [render(scene, samples=16, sampler=sampler, seed=k, **options).pixels[..., 0] for k in range(4)]
        return float(np.sqrt(np.mean((np.array(seen) - exact) ** 2)))

    errors = {name: error(name) for name in SAMPLERS}
    assert errors["jittered"] < 0.7 * errors["random"]
    assert errors["multijittered"] < errors["jittered"]
    assert errors["sobol"] < errors["jittered"]
    assert errors["halton"] < 0.7 * errors["random"]


@SLOW_AS_PYTHON
def test_regular_samples_alias_where_random_ones_are_noise():
    """Stripes finer than a pixel: nine regular samples see a moiré in all rows alike, random ones do not (FoCG 13.4.1)."""
    stripes = checkers(2, filter="nearest", scale=(185.0, 0.0001))
    floor = place(Plane(), Lambert(color=1, texture=stripes))
    scene = scene_of(floor, lit_from((0, 1, 0)), camera=OrthographicCamera.look_at((0, 1, 0), (0, 0, 0), up=(0, 0, -1), height=1.0))
    columns = {
        name: render(scene, width=61, height=61, renderer="ray", samples=9, sampler=name).pixels[:30, :, 1].mean(axis=0).std()
        for name in ("regular", "random")
    }
    assert columns["regular"] > 3 * columns["random"]


def test_who_has_which_sampler():
    scene = scene_of(place(Sphere(1.0)))
    with pytest.raises(UnsupportedError, match="sampler must be one of regular, random, jittered, multijittered, halton, sobol"):
        render(scene, renderer="ray", sampler="poisson")
    with pytest.raises(UnsupportedError, match="raster has one pattern"):
        render(scene, renderer="raster", sampler="sobol")


# --- glossy ---------------------------------------------------------------------------------------------------------------


@SLOW_AS_PYTHON
@BOTH
@pytest.mark.parametrize("width", [0.1, 0.4])
def test_the_square_of_a_glossy_mirror(renderer, width):
    """A small far lamp, seen in a blurred mirror, is a square of the width a: at distance 1 along the mirrored ray (FoCG 13.4.4)."""
    mirror = place(two_triangles((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)), BlinnPhong(diffuse=0, mirror=1, mirror_blur=width))
    lamp = place(Sphere(0.01), Lambert(color=0, emission=(4e3, 4e3, 4e3)), at=(0, 0, 1.0))
    camera = OrthographicCamera.look_at((0, 0, 0.5), (0, 0, 0), height=1.0, near=0.01)
    seen = render(scene_of(mirror, lamp, DARK, camera=camera), width=40, height=40, renderer=renderer, samples=1024).pixels[..., 0]
    lit = np.argwhere(seen > 0.1 * np.percentile(seen, 99))
    np.testing.assert_allclose(np.ptp(lit, axis=0) / 40, width, atol=0.08)
    np.testing.assert_allclose(lit.mean(axis=0), 19.5, atol=1.5)
    # an even sky stays what it was: no light is lost, not even at grazing angles
    sky = scene_of(mirror, place(Box((99, 99, 99)), GLOW), DARK, camera=PerspectiveCamera.look_at((0, 5, 0.3), (0, 0, 0), yfov_degrees=10))
    np.testing.assert_allclose(render(sky, width=6, height=6, renderer=renderer, samples=64).pixels[..., 0], 1.0, atol=1e-5)


def test_a_blur_of_zero_is_an_ideal_mirror():
    nodes = place(Plane(), Lambert(texture=checkers(2))), place(Sphere(0.3), at=(0.7, 0.3, 0.7))
    camera = PerspectiveCamera.look_at((0, 1, 4), (0, 0.5, 0))
    pictures = [
        render(
            scene_of(*nodes, place(Sphere(0.5), BlinnPhong(mirror=0.9, mirror_blur=blur), at=(0, 0.5, 0)), camera=camera),
            width=24, height=18, renderer="ray", samples=2,
        ).pixels
        for blur in (None, 0.0)
    ]  # fmt: skip
    np.testing.assert_array_equal(*pictures)
    with pytest.raises(SceneError, match=r"material.mirror_blur must lie in"):
        BlinnPhong(mirror_blur=-0.1)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("roughness", [0.05, 0.2, 0.5, 1.0])
@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_rough_mirrors_agree_between_the_renderers(roughness, metallic):
    """A rough ball between a glowing wall and a lamp: followed by rays, as `path` has it; both only glow, so one reflection is all."""
    ball = place(Sphere(1.0), MetallicRoughness((0.9, 0.7, 0.4), metallic=metallic, roughness=roughness, double_sided=True))
    wall = place(two_triangles((-8, -8, 6), (8, -8, 6), (8, 0, 6), (-8, 0, 6)), Lambert(color=0, emission=(0.8, 0.2, 0.1)))
    frame = transform.frame_from_gaze((3, 4, 3), (-3, -4, -3), (0, 1, 0))
    lamp = Node("lamp", frame, lights=(RectangleLight(intensity=8.0, width=2.0, height=1.0),))
    scene = scene_of(ball, wall, lamp, camera=PerspectiveCamera.look_at((0, 1, 4), (0, 0, 0), yfov_degrees=28))
    # what glows lights the matte part, too
    options = {"width": 24, "height": 24, "max_depth": 1, "glossy": True, "emitters": True}
    blocks = [
        render(scene, renderer=renderer, samples=n, **options).pixels[4:20, 4:20, :3].reshape(4, 4, 4, 4, 3).mean(axis=(1, 3))
        for renderer, n in (("ray", 1024), ("path", 1024))
    ]
    np.testing.assert_allclose(blocks[0], blocks[1], rtol=0.06, atol=0.01)


@SLOW_AS_PYTHON
def test_white_metal_in_a_white_room():
    """As bright as the room, less what is scattered twice: by rays the same as by the blurred sky's table, 2 %."""
    metal = place(Sphere(1.0), MetallicRoughness((1, 1, 1), metallic=1.0, roughness=0.4, double_sided=True))
    room = place(Box((20, 20, 20)), GLOW)
    camera = PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0), yfov_degrees=4)
    seen = render(scene_of(metal, room, DARK, camera=camera), width=8, height=8, renderer="ray", samples=256, glossy=True).pixels[..., 0]
    assert 0.95 < seen.mean() < 1.0


# --- cool to warm ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("renderer", ["raster", "ray", "path"])
def test_cool_to_warm(renderer):
    """k_w = (1 + n.l) / 2 of warm and the rest cool (errata to 10.3.2), the same in every renderer, whatever the light."""
    cool, warm = np.array((0.1, 0.2, 0.6)), np.array((0.9, 0.6, 0.3))
    drawn = CoolToWarm(cool=tuple(cool), warm=tuple(warm), towards=(1.0, 0.0, 0.0))
    camera = OrthographicCamera.look_at((0, 0, 4), (0, 0, 0), height=2.0)
    pixels = render(scene_of(place(Sphere(1.0), drawn), camera=camera), width=41, height=41, renderer=renderer, samples=16).pixels
    x = (np.arange(41) - 20) / 41 * 2
    share = ((1 + x) / 2)[2:-2, None]
    np.testing.assert_allclose(pixels[20, 2:-2, :3], share * warm + (1 - share) * cool, atol=0.012)


def test_cool_to_warm_from_the_upper_left():
    """Where nobody says where the light stands, it stands at right angles to the gaze, so that all of the range is seen."""
    camera = OrthographicCamera.look_at((3, 2, 4), (0, 0, 0), height=2.0)
    drawn = CoolToWarm(cool=(0, 0, 1), warm=(1, 0, 0))
    red = render(scene_of(place(Sphere(1.0), drawn), camera=camera), width=41, height=41, renderer="ray", samples=4).pixels[..., 0]
    row, column = np.unravel_index(red.argmax(), red.shape)
    assert row < 10
    assert column < 10
    assert red[20, 20] == pytest.approx(0.5, abs=0.02)
    with pytest.raises(SceneError, match=r"material.towards must not be zero"):
        CoolToWarm(towards=(0, 0, 0))


# --- motion ---------------------------------------------------------------------------------------------------------------


def _over_time(node: Node, camera: object, **options: object) -> NDArray[np.float64]:
    chosen = {"width": 64, "height": 64, "renderer": "ray", "samples": 256, "shutter": (0.0, 1.0), **options}
    return render(scene_of(node, DARK, camera=camera, background=(0.0, 0.0, 0.0)), **chosen).pixels[..., 0].astype(np.float64)


FLAT = OrthographicCamera.look_at((0, 0, 4), (0, 0, 0), height=2.0)


@SLOW_AS_PYTHON
@BOTH
@pytest.mark.parametrize("geometry", [Box((0.25, 0.5, 0.1)), Cylinder(0.125, 0.5), SHEET], ids=["box", "cylinder", "mesh"])
def test_what_moves_is_seen_where_it_is_as_long_as_it_is(renderer, geometry):
    """A bar that moves by twice its width: at each place it is seen for its share of the time, a ramp, a level of 1/2, a ramp."""
    bar = Node("bar", transform.translate(-0.25, 0, 0), shapes=(Shape(geometry, (GLOW,)),), motion=Motion.shift((0.5, 0, 0)))
    profile = _over_time(bar, FLAT, renderer=renderer)[24:40].mean(axis=0)
    x = (np.arange(64) - 31.5) / 32
    expected = np.clip((x + 0.375) / 0.5, 0, 1) - np.clip((x + 0.125) / 0.5, 0, 1)
    np.testing.assert_allclose(profile, expected, atol=0.05)
    assert profile.sum() / 32 == pytest.approx(0.25, abs=0.005)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("degrees", [90.0, 270.0])
def test_a_wheel_that_turns_stays_round(degrees):
    """A rim that turns is as round as one that stands, to a hundredth; a point on it runs along the circle, not across (slerp)."""
    wheel = Node(shapes=(Shape(Sphere(0.05), (GLOW,)),), parent_from_node=transform.translate(0.8, 0, 0))
    seen = _over_time(Node("axle", children=(wheel,), motion=Motion.turn((0, 0, 1), degrees)), FLAT)
    y, x = (31.5 - np.arange(64)[:, None]) / 32, (np.arange(64) - 31.5) / 32
    distance = np.hypot(x, y)
    lit = seen > 0.05 * seen.max()
    assert distance[lit].min() > 0.8 - 0.05 - 0.05
    assert distance[lit].max() < 0.8 + 0.05 + 0.05
    angle = np.degrees(np.broadcast_to(np.arctan2(y, x), seen.shape)[lit]) % 360
    assert np.ptp((angle + 20) % 360) == pytest.approx(degrees + 7, abs=8)
    # as bright everywhere along its way: it turns at constant speed
    middle = np.broadcast_to(np.degrees(np.arctan2(y, x)) % 360, seen.shape)
    sums = [seen[(middle > a) & (middle < a + 20)].sum() for a in np.arange(5, degrees - 25, 20)]
    np.testing.assert_allclose(sums, np.mean(sums), rtol=0.1)


@SLOW_AS_PYTHON
@BOTH
def test_a_camera_that_moves_blurs_what_stands(renderer):
    """As the same motion of the thing, the other way."""
    ball = Node(shapes=(Shape(Sphere(0.2), (GLOW,)),))
    moving = Node(shapes=(Shape(Sphere(0.2), (GLOW,)),), motion=Motion.shift((0.6, 0.2, 0)))
    camera = OrthographicCamera.look_at((0, 0, 4), (0, 0, 0), height=2.0, motion=Motion.shift((-0.6, -0.2, 0)))
    np.testing.assert_allclose(_over_time(ball, camera, renderer=renderer), _over_time(moving, FLAT, renderer=renderer), atol=0.02)


@SLOW_AS_PYTHON
def test_parts_move_with_the_whole():
    """A spoke that turns on a wheel that rolls: the world's pose is the product of both at each time; the hub moves straight."""
    hub = Node(shapes=(Shape(Sphere(0.05), (GLOW,)),))
    wheel = Node("wheel", children=(hub,), motion=Motion.turn((0, 0, 1), -180))
    car = Node("car", transform.translate(-0.5, 0, 0), children=(wheel,), motion=Motion.shift((1, 0, 0)))
    straight = Node("straight", transform.translate(-0.5, 0, 0), children=(hub,), motion=Motion.shift((1, 0, 0)))
    np.testing.assert_allclose(_over_time(car, FLAT), _over_time(straight, FLAT), atol=1e-3)


@SLOW_AS_PYTHON
def test_shadows_and_mirrors_move_along():
    """A ball that moves under a lamp from above: its shadow on the floor is smeared as it is."""
    ball = Node("ball", transform.translate(-0.3, 1, 0), shapes=(Shape(Sphere(0.2)),), motion=Motion.shift((0.6, 0, 0)))
    camera = OrthographicCamera.look_at((0, 0.5, 0), (0, 0, 0), up=(0, 0, -1), height=2.0, near=0.01)
    scene = scene_of(place(Plane(), Lambert(color=1)), ball, lit_from((0, 1, 0)), camera=camera)
    seen = render(scene, width=64, height=64, renderer="ray", samples=256, shutter=(0, 1)).pixels[..., 1]
    lost = (seen.max() - seen).sum() / seen.max() / 32**2
    assert lost == pytest.approx(math.pi * 0.2**2, rel=0.02)
    assert np.ptp(np.nonzero((seen < 0.98 * seen.max()).any(axis=0))[0]) / 32 == pytest.approx(1.0, abs=0.08)


@SLOW_AS_PYTHON
def test_solids_cut_from_one_another_move_as_one():
    """A ball with a bite, moved: as the ball with the bite there and then, at every time of a short shutter."""
    bitten = Difference(Solid(Sphere(0.5)), Solid(Sphere(0.4), transform.translate(0.3, 0.2, 0.4)))
    moving = Node("bitten", shapes=(Shape(bitten, (GLOW,)),), motion=Motion.shift((0.6, 0, 0)))
    stood = Node("bitten", transform.translate(0.3, 0, 0), shapes=(Shape(bitten, (GLOW,)),))
    short = _over_time(moving, FLAT, shutter=(0.4999, 0.5001), samples=16)
    np.testing.assert_allclose(short, _over_time(stood, FLAT, samples=16), atol=0.15)
    assert short.sum() == pytest.approx(_over_time(stood, FLAT, samples=16).sum(), rel=2e-3)


def test_the_shutter_opens_when_it_is_said():
    """A moment's picture is that of the pose at that time; the channels beside a blurred picture are of its beginning."""
    ball = Node("ball", shapes=(Shape(Sphere(0.2), (GLOW,)),), motion=Motion.shift((1, 0, 0)))
    stood = place(Sphere(0.2), GLOW, at=(0.5, 0, 0))
    np.testing.assert_allclose(_over_time(ball, FLAT, shutter=(0.5, 0.5), samples=4), _over_time(stood, FLAT, samples=4), atol=1e-5)
    for renderer in ("ray", "raster"):
        image = render(scene_of(ball, DARK, camera=FLAT), width=64, height=64, renderer=renderer, aovs=("instance_id",), samples=1,
                       shutter=(0.5, 0.5) if renderer == "raster" else (0.5, 1.0))  # fmt: skip
        assert np.argwhere(image.aov["instance_id"] == 0).mean(axis=0) == pytest.approx((31.5, 31.5 + 16), abs=0.2)


def test_what_is_no_shutter_and_no_motion():
    scene = scene_of(place(Sphere(1.0)))
    with pytest.raises(SceneError, match=r"the shutter must not close before it opens, got 1.0 and 0.5"):
        render(scene, renderer="ray", shutter=(1.0, 0.5))
    with pytest.raises(SceneError, match="shutter must be two times"):
        render(scene, renderer="ray", shutter=0.5)  # type: ignore[arg-type]
    with pytest.raises(UnsupportedError, match="raster sees one time only"):
        render(scene, shutter=(0.0, 1.0))
    with pytest.raises(SceneError, match=r"motion.times must grow"):
        Motion((1.0, 0.0), [np.eye(4)] * 2)
    with pytest.raises(SceneError, match=r"motion.poses must have shape"):
        Motion((0.0, 1.0), [np.eye(4)])
    with pytest.raises(SceneError, match="a motion must end after it starts"):
        Motion.shift((1, 0, 0), 1.0, 0.0)
    with pytest.raises(SceneError, match="nor mirror it"):
        Motion((0.0, 1.0), [np.eye(4), np.diag((-1.0, 1.0, 1.0, 1.0))])
    with pytest.raises(SceneError, match="axis must not be zero"):
        Motion.turn((0, 0, 0), 90)
    with pytest.raises(SceneError, match=r"node.motion"):
        Node(motion=np.eye(4))  # type: ignore[arg-type]
