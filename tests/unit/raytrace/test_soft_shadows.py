"""Lights with an area (FoCG 13.4.2): how much of them arrives, how soft their shadows are, and that they are seen."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, place, scene_of, two_triangles

from limner.errors import SceneError
from limner.linear import transform
from limner.render import render
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.light import AmbientLight, AreaLight, DiskLight, PointLight, RectangleLight, SphereLight
from limner.scene.material import BlinnPhong, Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Sphere

DARK = Node(lights=(AmbientLight(intensity=0.0),))
BOTH = pytest.mark.parametrize("renderer", ["ray", "path"])
LIGHTS = (
    RectangleLight(intensity=3.0, width=1.0, height=2.0), DiskLight(intensity=3.0, radius=0.8), SphereLight(intensity=3.0, radius=0.6),
)  # fmt: skip


def _hanging(light: object, height: float, at: tuple[float, float] = (0.0, 0.0)) -> Node:
    """A light at a height that shines straight down."""
    frame = transform.frame_from_gaze((at[0], height, at[1]), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
    return Node("hanging", frame, lights=(light,))


def _picture(scene: Scene, width: int = 8, height: int = 8, **options: object) -> NDArray[np.float64]:
    image = render(scene, width=width, height=height, **{"renderer": "ray", "samples": 256, "max_depth": 1, **options})
    return image.pixels.astype(np.float64)


def _floor_below(node: Node, *others: Node, **options: object) -> float:
    """The radiance of a white floor at the origin."""
    floor = place(Plane(), Lambert(color=(1, 1, 1)))
    camera = PerspectiveCamera.look_at((0, 0.1, 0), (0, 0, 0), up=(0, 0, -1), yfov_degrees=1)
    return float(_picture(scene_of(floor, node, *others, camera=camera), **options)[..., 0].mean())


# --- how much arrives -----------------------------------------------------------------------------------------------------


@SLOW_AS_PYTHON
@BOTH
@pytest.mark.parametrize(("height", "width", "depth"), [(1.0, 1.0, 1.0), (0.5, 2.0, 1.0), (4.0, 0.5, 3.0)])
def test_a_rectangle_over_the_floor(renderer, height, width, depth):
    """Radiance L times the form factor of a rectangle over a point below its middle: four of Howell's B-4."""
    a, b = width / 2 / height, depth / 2 / height
    p, q = math.hypot(1, a), math.hypot(1, b)
    quarter = (a / p * math.atan(b / p) + b / q * math.atan(a / q)) / (2 * math.pi)
    light = RectangleLight(intensity=3.0, width=width, height=depth)
    assert _floor_below(_hanging(light, height), renderer=renderer) == pytest.approx(3.0 * 4 * quarter, rel=0.01)


@SLOW_AS_PYTHON
@BOTH
@pytest.mark.parametrize(("height", "radius"), [(1.0, 0.5), (0.5, 1.0), (5.0, 2.0)])
def test_a_disk_over_the_floor(renderer, height, radius):
    """L R^2 / (R^2 + h^2)."""
    light = DiskLight(intensity=2.0, radius=radius)
    expected = 2.0 * radius**2 / (radius**2 + height**2)
    assert _floor_below(_hanging(light, height), renderer=renderer) == pytest.approx(expected, rel=0.01)


@SLOW_AS_PYTHON
@BOTH
@pytest.mark.parametrize(("height", "radius"), [(1.0, 0.5), (1.0, 0.95), (20.0, 0.3)])
def test_a_sphere_over_the_floor(renderer, height, radius):
    """L R^2 / h^2, with h to its centre."""
    expected = 2.0 * radius**2 / height**2
    seen = _floor_below(_hanging(SphereLight(intensity=2.0, radius=radius), height), renderer=renderer)
    assert seen == pytest.approx(expected, rel=0.01)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("light", LIGHTS, ids=lambda light: type(light).__name__)
def test_from_afar_all_are_points(light):
    """Of area times intensity candela straight ahead; to the rasteriser they are points anywhere."""
    area = {RectangleLight: 2.0, DiskLight: math.pi * 0.64, SphereLight: math.pi * 0.36}[type(light)]
    point = PointLight(intensity=3.0 * area)
    for renderer in ("ray", "path", "raster"):
        samples = 8 if renderer == "raster" else 64
        found, expected = (
            _floor_below(_hanging(each, 50.0), renderer=renderer, samples=samples) for each in (light, point)
        )
        assert found == pytest.approx(expected, rel=0.01)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("visible", [True, False])
@pytest.mark.parametrize("light", LIGHTS, ids=lambda light: type(light).__name__)
def test_ray_and_path_agree_on_direct_light(light, visible):
    """Matte, shiny and metal surfaces with a shadow on them: the same means of blocks of pixels, however the light is found."""
    light = type(light)(**{**vars(light), "visible": visible})
    nodes = (
        place(Plane(), Lambert(color=(0.7, 0.6, 0.5))),
        place(Sphere(0.4), BlinnPhong(diffuse=(0.3, 0.3, 0.3), specular=0.5, exponent=40), at=(-0.5, 0.4, 0)),
        place(Box((0.6, 0.6, 0.6)), MetallicRoughness((0.9, 0.7, 0.3), metallic=0.5, roughness=0.5, double_sided=True), at=(0.5, 0.3, 0)),
        _hanging(light, 1.8, (0.4, 0.3)),
    )  # fmt: skip
    scene = scene_of(*nodes, camera=PerspectiveCamera.look_at((0, 1.2, 2.4), (0, 0.3, 0), yfov_degrees=45))
    pictures = [_picture(scene, 32, 24, renderer=renderer, samples=256)[..., :3] for renderer in ("ray", "path")]
    blocks = [picture.reshape(6, 4, 8, 4, 3).mean(axis=(1, 3)) for picture in pictures]
    np.testing.assert_allclose(blocks[0], blocks[1], rtol=0.03, atol=0.01)


@SLOW_AS_PYTHON
def test_shining_meshes_light_others_on_request():
    """In `ray` as in `path`: the form factor of a square; without, their glow alone is seen."""
    square = two_triangles((-0.5, 1, -0.5), (0.5, 1, -0.5), (0.5, 1, 0.5), (-0.5, 1, 0.5))
    lamp = place(square, Lambert(color=0, emission=(3, 3, 3), double_sided=False))
    a = 0.5
    expected = 3.0 * 4 * 2 * a / math.hypot(1, a) * math.atan(a / math.hypot(1, a)) / (2 * math.pi)
    assert _floor_below(lamp, DARK, emitters=True) == pytest.approx(expected, rel=0.01)
    assert _floor_below(lamp, DARK, renderer="path") == pytest.approx(expected, rel=0.01)
    assert _floor_below(lamp, DARK) == 0.0


# --- shadows --------------------------------------------------------------------------------------------------------------


@SLOW_AS_PYTHON
@BOTH
def test_width_of_a_penumbra(renderer):
    """An edge at height h below a light of width w at height H: from light to dark in w h / (H - h), evenly if the light is far."""
    width, light_height, edge_height = 2.0, 40.0, 4.0
    light = RectangleLight(intensity=100.0, width=width, height=0.01, visible=False)
    edge = place(two_triangles((0, edge_height, -9), (9, edge_height, -9), (9, edge_height, 9), (0, edge_height, 9)))
    floor = place(Plane(), Lambert(color=(1, 1, 1)))
    camera = OrthographicCamera.look_at((0, 2, 0), (0, 0, 0), up=(0, 0, -1), height=0.5, near=0.01)
    seen = _picture(scene_of(floor, edge, _hanging(light, light_height), camera=camera), 64, 64, renderer=renderer, samples=256)[..., 0]
    profile = seen.mean(axis=0) / seen[:, :8].mean()
    x = (np.arange(64) - 31.5) / 64 * 0.5
    expected = np.clip(0.5 - x / (width * edge_height / (light_height - edge_height)), 0, 1)
    np.testing.assert_allclose(profile, expected, atol=0.03)


@SLOW_AS_PYTHON
def test_a_disk_between_hides_as_much_as_it_covers():
    """Seen from the floor, a ball of half the light's angle covers a quarter of a far disk: the core of the shadow has 3/4."""
    ball = place(Sphere(0.5), at=(0, 20, 0))
    lit = _floor_below(_hanging(DiskLight(intensity=50.0, radius=2.0), 40.0))
    assert _floor_below(_hanging(DiskLight(intensity=50.0, radius=2.0), 40.0), ball) / lit == pytest.approx(0.75, abs=0.01)


@SLOW_AS_PYTHON
def test_without_shadows_nothing_hides_a_light():
    ball = place(Sphere(0.5), at=(0, 20, 0))
    light = _hanging(DiskLight(intensity=50.0, radius=2.0), 40.0)
    assert _floor_below(light, ball, shadows=False) == pytest.approx(_floor_below(light), rel=1e-6)


# --- lamps ----------------------------------------------------------------------------------------------------------------


@BOTH
@pytest.mark.parametrize("light", LIGHTS, ids=lambda light: type(light).__name__)
def test_lamps_are_seen(renderer, light):
    """From the front as a surface of their radiance, from the back not at all; a sphere from everywhere; invisible ones from nowhere."""
    node = Node(lights=(light,))  # shines along -z

    def seen(eye: tuple[float, float, float], shown: object) -> NDArray[np.float64]:
        camera = PerspectiveCamera.look_at(eye, (0, 0, 0), yfov_degrees=5)
        return _picture(scene_of(Node(lights=(shown,)), camera=camera), 4, 4, renderer=renderer, samples=4)

    np.testing.assert_array_equal(seen((0, 0, -4), light), np.broadcast_to((3.0, 3.0, 3.0, 1.0), (4, 4, 4)))
    behind = (3.0, 3.0, 3.0, 1.0) if isinstance(light, SphereLight) else (0.0,) * 4
    np.testing.assert_array_equal(seen((0, 0, 4), light), np.broadcast_to(behind, (4, 4, 4)))
    hidden = type(light)(**{**vars(light), "visible": False})
    np.testing.assert_array_equal(seen((0, 0, -4), hidden), 0.0)
    assert node.lights == (light,)


def test_lamps_are_there_in_every_renderer_with_names():
    """As the last of the instances, so that other ids stay."""
    bulb = Node(lights=(SphereLight(name="bulb", radius=0.5),))
    scene = scene_of(place(Sphere(0.3), at=(2, 0, 0)), bulb, camera=PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0)))
    for renderer in ("raster", "ray", "path"):
        image = render(scene, width=9, height=9, renderer=renderer, samples=1, aovs=("instance_id",))
        assert image.aov["instance_id"][4, 4] == 1
        assert image.id_names["instance_id"][1].endswith("lamps/bulb")


def test_a_lamp_does_not_hide_its_own_light_but_stands_in_the_way_of_others():
    """A disk light under another one: what the upper one sends is blocked by the lower lamp, unless that is invisible."""
    upper = _hanging(DiskLight(intensity=1.0, radius=0.1), 2.0)
    for visible, blocked in ((True, True), (False, False)):
        lower = _hanging(DiskLight(intensity=0.0, radius=0.5, visible=visible), 1.0)
        lit = _floor_below(upper, lower)
        assert (lit == 0.0) == blocked


@SLOW_AS_PYTHON
@pytest.mark.parametrize("scale", [0.01, 3.0])
def test_a_node_s_scale_does_not_change_a_light(scale):
    """As for all lights: size and radiance are what is said."""
    frame = transform.frame_from_gaze((0.0, 2.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)) @ transform.scale(abs(scale), 1.0, abs(scale))
    light = RectangleLight(intensity=3.0, width=1.0, height=2.0)
    scaled = _floor_below(Node("scaled", frame, lights=(light,)))
    assert scaled == pytest.approx(_floor_below(_hanging(light, 2.0)), rel=0.01)


@pytest.mark.parametrize("kind", [RectangleLight, DiskLight, SphereLight])
def test_what_is_no_area_light(kind):
    with pytest.raises(SceneError, match=r"light.intensity must not be negative"):
        kind(intensity=-1.0)
    size = "width" if kind is RectangleLight else "radius"
    for value in (0.0, -1.0, math.nan):
        with pytest.raises(SceneError, match=rf"light.{size} must be"):
            kind(**{size: value})
    assert isinstance(kind(), AreaLight)
