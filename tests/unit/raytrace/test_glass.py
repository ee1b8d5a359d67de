"""Glass, water and fog in pictures, against what can be computed by hand (FoCG 13.1)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, place, point_light_at, scene_of, two_triangles

from limner.errors import SceneError, UnsupportedError
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.render import render
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.fog import Fog
from limner.scene.light import AmbientLight, PointLight
from limner.scene.material import BlinnPhong, Dielectric, Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Intersection, Plane, Solid, Sphere

DARK = Node(lights=(AmbientLight(intensity=0.0),))
GLOW = Lambert(color=0, emission=(1.0, 1.0, 1.0))
BOTH = pytest.mark.parametrize("renderer", ["ray", "path"])


def _pixels(scene: Scene, width: int = 65, height: int = 65, **options: object) -> NDArray[np.float64]:
    image = render(scene, width=width, height=height, **{"renderer": "ray", "samples": 1, "max_depth": 16, **options})
    return image.pixels.astype(np.float64)


def _wall(z: float, emission: object = (1.0, 1.0, 1.0), half: float = 50.0) -> Node:
    corners = ((-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z))
    return place(two_triangles(*corners), Lambert(color=0, emission=emission))


def _through(*media: Node, behind: float = -5.0, eye: float = 5.0, **fields: object) -> Scene:
    """A white wall seen straight through something."""
    camera = PerspectiveCamera.look_at((0, 0, eye), (0, 0, 0), yfov_degrees=0.5)
    return scene_of(*media, _wall(behind), DARK, camera=camera).replace(**fields)


def _middle(scene: Scene, **options: object) -> NDArray[np.float64]:
    return _pixels(scene, 3, 3, **options)[1, 1, :3]


# --- where things are seen ------------------------------------------------------------------------------------------------


@SLOW_AS_PYTHON
@pytest.mark.parametrize("ior", [1.33, 1.5, 2.4])
def test_apparent_depth_under_water(ior):
    """Seen straight from above, what lies at depth d under water seems to lie at d / n."""
    depth, height = 2.0, 3.0
    coin = place(Sphere(0.05), GLOW, at=(0.2, -depth, 0.0))
    water = place(Box((20, 10, 20)), Dielectric(ior), at=(0, -5, 0))
    camera = PerspectiveCamera.look_at((0, height, 0), (0, 0, 0), up=(0, 0, -1), yfov_degrees=12)
    pixels = _pixels(scene_of(coin, water, DARK, camera=camera, background=(0, 0, 0)), 301, 301)[..., 0]
    pixels[pixels < 0.5 * pixels.max()] = 0.0  # the ground of the pool mirrors it, too
    column = (pixels * np.arange(301)).sum() / pixels.sum()
    tangent = (column - 150) / 150.5 * camera.half_height()
    theta = math.atan(tangent)
    # the ray enters at height tan(theta) and goes on under phi
    phi = math.asin(math.sin(theta) / ior)
    assert height * tangent + depth * math.tan(phi) == pytest.approx(0.2, abs=1e-3)
    assert 0.2 / tangent - height == pytest.approx(depth / ior, rel=0.01)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("degrees", [0.0, 30.0, 60.0])
def test_a_parallel_plate_moves_what_is_behind_it(degrees):
    """By d sin(theta - phi) / cos(phi) across the gaze, whatever the distance."""
    thickness, theta = 0.5, math.radians(degrees)
    turned = transform.rotate_y(theta)
    plate = place(Box((9, 9, thickness)), Dielectric(1.5), matrix=turned)
    lamp = place(Sphere(0.03), GLOW, at=(0, 0, -6))
    camera = OrthographicCamera.look_at((0, 0, 6), (0, 0, 0), height=1.0)
    pixels = _pixels(scene_of(plate, lamp, DARK, camera=camera, background=(0, 0, 0)), 401, 401)[..., 0]
    bright = pixels > 0.5 * pixels.max()
    column, row = np.nonzero(bright)[1].mean(), np.nonzero(bright)[0].mean()
    phi = math.asin(math.sin(theta) / 1.5)
    shift = thickness * math.sin(theta - phi) / math.cos(phi)
    assert abs(column - 200) / 401 == pytest.approx(shift, abs=2e-3)
    assert row == pytest.approx(200, abs=0.5)


@SLOW_AS_PYTHON
@BOTH
def test_from_under_water_the_sky_is_a_window(renderer):
    """All of it within the critical angle, arcsin(1/n) about straight up (Snell's window); beyond, the surface is a mirror."""
    water = place(Plane(), Dielectric(1.33), at=(0, 10, 0))
    sky = place(two_triangles((-4000, 50, -4000), (4000, 50, -4000), (4000, 50, 4000), (-4000, 50, 4000)), GLOW)
    camera = PerspectiveCamera.look_at((0, 9, 0), (0, 10, 0), up=(0, 0, 1), yfov_degrees=120)
    pixels = _pixels(scene_of(water, sky, DARK, camera=camera), 161, 161, renderer=renderer, samples=16)[..., 0]
    area = (pixels > 0.02).sum() / 161**2 * (2 * camera.half_height()) ** 2
    assert math.sqrt(area / math.pi) == pytest.approx(math.tan(math.asin(1 / 1.33)), rel=0.01)
    assert pixels[80, 80] == pytest.approx(1.33**2 * (1 - (0.33 / 2.33) ** 2), rel=1e-3 if renderer == "ray" else 0.1)


@SLOW_AS_PYTHON
@BOTH
def test_a_lens_cut_from_two_balls_has_its_focus(renderer):
    """Biconvex, of radius R: parallel rays meet at R / (2 (n - 1)) behind it, as far as it is thin; elsewhere they are spread."""
    radius, ior, half = 4.0, 1.5, 0.5
    sag = radius - math.sqrt(radius**2 - half**2)
    parts = (Solid(Sphere(radius), transform.translate(0, 0, side * (radius - sag))) for side in (-1, 1))
    lens = place(Intersection(*parts), Dielectric(ior))
    focal = radius / (2 * (ior - 1))
    camera = OrthographicCamera.look_at((0, 0, 3), (0, 0, 0), height=2 * half)

    def share(distance: float) -> float:
        target = place(Sphere(0.03), GLOW, at=(0, 0, -distance))
        seen = _pixels(scene_of(lens, target, DARK, camera=camera, background=(0, 0, 0)), 64, 64, renderer=renderer, samples=4)[..., 0]
        return float((seen > 0.3).sum() / 64**2 / (math.pi / 4))

    assert share(focal) > 0.95
    assert share(0.5 * focal) < 0.2
    assert share(1.6 * focal) < 0.2


# --- how much light is left -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fresnel", ["exact", "schlick"])
def test_a_pane_lets_through_what_it_does_not_reflect(fresnel):
    """Of white behind a pane, (1 - R) / (1 + R) with all reflections inside; of white all around, all of it."""
    pane = place(Box((9, 9, 0.2)), Dielectric(1.5, fresnel=fresnel))
    r = (0.5 / 2.5) ** 2
    np.testing.assert_allclose(_middle(_through(pane)), (1 - r) / (1 + r), rtol=2e-3)
    np.testing.assert_allclose(_middle(_through(pane, _wall(9.0))), 1.0, rtol=2e-3)


@BOTH
def test_beers_law(renderer):
    """exp(-a d) after a way d in the glass, exponential in the distance, each colour for itself; tint at each surface."""
    for thickness in (0.1, 1.0, 4.0):
        amber = Dielectric(1.0, tint=(1.0, 0.5, 0.25), absorption=(0.0, 0.5, 2.0))
        seen = _middle(_through(place(Box((9, 9, thickness)), amber)), renderer=renderer)
        np.testing.assert_allclose(seen, np.exp(np.array((0.0, -0.5, -2.0)) * thickness) * (1.0, 0.25, 0.0625), rtol=2e-4)
    coloured = Dielectric.with_color_at((0.5, 0.25, 1.0), 2.0, ior=1.0)
    np.testing.assert_allclose(_middle(_through(place(Box((9, 9, 2)), coloured)), renderer=renderer), (0.5, 0.25, 1.0), rtol=2e-4)


@BOTH
def test_fog(renderer):
    """What is d metres away is seen by exp(-density d), the rest is fog; behind everything there is nothing but fog; opaque, both."""
    scene = _through(fog=Fog((0.2, 0.4, 0.6), 0.1))
    left = math.exp(-0.1 * 10.0)
    np.testing.assert_allclose(_middle(scene, renderer=renderer), left + (1 - left) * np.array((0.2, 0.4, 0.6)), rtol=1e-4)
    empty = scene_of(place(Sphere(0.01), at=(0, -3, 0)), DARK, camera=scene.camera).replace(fog=Fog((0.2, 0.4, 0.6), 0.1))
    np.testing.assert_allclose(_pixels(empty, 3, 3, renderer=renderer)[1, 1], (0.2, 0.4, 0.6, 1.0), rtol=1e-5)


@BOTH
def test_fog_in_a_box(renderer):
    """Of index 1, with absorption and haze: there, and only there, things fade."""
    box = place(Box((4, 4, 4)), Dielectric(1.0, absorption=(0.3, 0.3, 0.3), haze=(0.5, 0.5, 0.5)))
    left = math.exp(-0.3 * 4.0)
    np.testing.assert_allclose(_middle(_through(box), renderer=renderer), left + (1 - left) * 0.5, rtol=2e-4)


@SLOW_AS_PYTHON
@BOTH
@pytest.mark.parametrize("ior", [1.0, 1.5])
def test_the_eye_may_be_in_it(renderer, ior):
    """From inside a ball of glass, light has come through the half that lies in the gaze, in its own measure: n^2 times (1 - R)."""
    ball = place(Sphere(2.0), Dielectric(ior, absorption=(0.1, 0.2, 0.4)))
    scene = _through(ball, _wall(9.0), eye=0.5)
    r = ((ior - 1) / (ior + 1)) ** 2
    seen = _middle(scene, renderer=renderer, samples=1 if renderer == "ray" else 4096, max_depth=24)
    way, diameter = np.exp(-2.5 * np.array((0.1, 0.2, 0.4))), np.exp(-4.0 * np.array((0.1, 0.2, 0.4)))
    expected = ior**2 * (1 - r) * way / (1 - r * diameter)
    np.testing.assert_allclose(seen, expected, rtol=2e-3 if renderer == "ray" else 0.03)


@SLOW_AS_PYTHON
@BOTH
def test_furnace(renderer):
    """In a room that shines with 1 everywhere, glass that takes nothing cannot be seen, whatever its shape."""
    room = place(Box((20, 20, 20)), GLOW)
    for shape, glass in (
        (Sphere(1.0), Dielectric(1.5)), (Box((1.5, 1.5, 1.5)), Dielectric(1.33)),
        (primitives.sphere(1.0, 24), Dielectric(1.5, fresnel="schlick")),
    ):  # fmt: skip
        camera = PerspectiveCamera.look_at((1, 1.5, 4), (0, 0, 0), yfov_degrees=30)
        scene = scene_of(room, place(shape, glass), DARK, camera=camera)
        seen = _pixels(scene, 24, 24, renderer=renderer, max_depth=60, samples=1 if renderer == "ray" else 32)[..., 0]
        # Light that circles inside a box longer than a ray is followed is missing.
        assert np.median(seen) == pytest.approx(1.0, abs=0.01)
        assert seen.mean() == pytest.approx(1.0, abs=0.02)
        assert seen.max() < 1.01 or renderer == "path"


# --- media in media -------------------------------------------------------------------------------------------------------


def _reflectance(a: float, b: float) -> float:
    return ((a - b) / (a + b)) ** 2


@SLOW_AS_PYTHON
@BOTH
def test_water_in_glass_touches_it(renderer):
    """Water reaches into the wall of its glass, which has the priority: where they touch, light meets one surface of 1.5 to 1.33."""
    absorbing = {"absorption": (0.0, 0.1, 1.0)}
    glass = Dielectric(1.5, priority=2)
    walls = [place(Box((9, 9, 0.2)), glass, at=(0, 0, z)) for z in (-1.0, 1.0)]
    water = place(Box((9, 9, 2.0)), Dielectric(1.33, **absorbing))  # from wall's middle to wall's middle
    seen = _middle(_through(*walls, water), renderer=renderer, samples=1 if renderer == "ray" else 4096)
    once = (1 - _reflectance(1, 1.5)) ** 2 * (1 - _reflectance(1.5, 1.33)) ** 2
    attenuated = np.exp(-1.8 * np.array(absorbing["absorption"]))
    # what is reflected to and fro adds up to less than 6 %
    assert (seen > once * attenuated * (0.999 if renderer == "ray" else 0.98)).all()
    assert (seen < once * attenuated * 1.06).all()
    # the same light, glass drawn last or first, water without or with the lower priority said
    again = _middle(_through(water, *reversed(walls)), renderer=renderer, samples=1 if renderer == "ray" else 4096)
    np.testing.assert_allclose(again, seen, rtol=1e-5 if renderer == "ray" else 0.03)


def test_a_gap_is_seen():
    """Bug that the stack prevents: with a hair of air between them, glass and water reflect 4 % and 2 % more."""
    walls = [place(Box((9, 9, 0.2)), Dielectric(1.5), at=(0, 0, z)) for z in (-1.0, 1.0)]
    apart = _middle(_through(*walls, place(Box((9, 9, 1.7)), Dielectric(1.33))))[0]
    joined = _middle(_through(*[place(Box((9, 9, 0.2)), Dielectric(1.5, priority=1), at=(0, 0, z)) for z in (-1.0, 1.0)],
                              place(Box((9, 9, 1.9)), Dielectric(1.33))))[0]  # fmt: skip
    assert joined > apart + 0.05


@SLOW_AS_PYTHON
@BOTH
def test_a_bubble_is_a_ball_of_air(renderer):
    """Of equal priority the inner one counts: a shell of glass, its way through glass 2 (R - r)."""
    ball = place(Sphere(1.0), Dielectric(1.0, absorption=(1.0, 1.0, 1.0)))
    bubble = place(Sphere(0.6), Dielectric(1.0))
    for scene in (_through(ball, bubble), _through(bubble, ball)):
        seen = _middle(scene, renderer=renderer, samples=1 if renderer == "ray" else 4096)
        np.testing.assert_allclose(seen, math.exp(-0.8), rtol=1e-3 if renderer == "ray" else 0.05)


@BOTH
@pytest.mark.parametrize(("first", "second"), [(1, 0), (0, 1), (0, 0)])
def test_where_two_overlap_the_priority_decides(renderer, first, second):
    """Boxes from -2 to 0.5 and from -0.5 to 2: the middle belongs to the one of higher priority, among equals to the one entered last."""
    a, b = Dielectric(1.0, absorption=(1.0, 0.0, 0.0), priority=first), Dielectric(1.0, absorption=(0.0, 1.0, 0.0), priority=second)
    near, far = place(Box((9, 9, 2.5)), a, at=(0, 0, 0.75)), place(Box((9, 9, 2.5)), b, at=(0, 0, -0.75))
    red, green = 2.5 if first > second else 1.5, 2.5 if second >= first else 1.5
    np.testing.assert_allclose(_middle(_through(near, far), renderer=renderer)[:2], np.exp((-red, -green)), rtol=1e-3)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("mirrored", [False, True])
def test_meshes_spheres_and_mirrored_ones_enter_alike(mirrored):
    """A mesh, an exact ball, and both turned inside out by a mirror: which side is inside is the same."""
    glass = Dielectric(1.5, absorption=(0.5, 1.0, 2.0))
    matrix = transform.scale(-1.0, 1.0, 1.0) if mirrored else np.eye(4)
    exact = _middle(_through(place(Sphere(1.0), glass, matrix=matrix)))
    meshed = _middle(_through(place(primitives.sphere(1.0, 128), glass, matrix=matrix)))
    np.testing.assert_allclose(meshed, exact, rtol=0.01)
    r = _reflectance(1.0, 1.5)
    np.testing.assert_allclose(exact, (1 - r) ** 2 * np.exp(np.array((-1.0, -2.0, -4.0))), rtol=0.01)


# --- the tree of rays -----------------------------------------------------------------------------------------------------


def test_rays_are_followed_as_often_as_said():
    """A wall behind n panes of two surfaces is seen from 2n refractions on, and not before."""
    panes = [place(Box((9, 9, 0.1)), Dielectric(1.0001), at=(0, 0, z)) for z in (0.0, 0.5, 1.0)]
    for depth in (0, 3, 5):
        assert _middle(_through(*panes), max_depth=depth)[0] == 0.0
    assert _middle(_through(*panes), max_depth=6)[0] == pytest.approx(1.0, abs=1e-3)


def test_what_cannot_be_seen_is_not_followed():
    """Between two panes of dark glass a mirror's images fade below a thousandth, and there the tree ends: the same to a thousandth."""
    smoked = Dielectric(1.5, tint=(0.1, 0.1, 0.1))
    scene = _through(place(Box((9, 9, 0.5)), smoked), place(Box((9, 9, 0.5)), smoked, at=(0, 0, 2)))
    assert abs(_middle(scene, max_depth=4)[0] - _middle(scene, max_depth=1000)[0]) < 1e-3


# --- light through glass --------------------------------------------------------------------------------------------------


def _under_a_pane(pane: Dielectric, **options: object) -> float:
    """The radiance of a white floor below a pane of glass, over that without."""
    floor, lamp = place(Plane(), Lambert(color=(1, 1, 1))), point_light_at((0, 4, 0), PointLight(intensity=50.0))
    camera = PerspectiveCamera.look_at((0.0, 0.5, 0.0), (0, 0, 0), up=(0, 0, -1), yfov_degrees=1)
    sheet = place(Box((3, 0.1, 3)), pane, at=(0, 2, 0))
    covered, bare = (_middle(scene_of(floor, lamp, *more, camera=camera), **options)[0] for more in ((sheet,), ()))
    return float(covered / bare)


@BOTH
def test_tinted_shadows(renderer):
    """Straight through, dimmed by both surfaces and the way between them; on request, which `ray` takes as given."""
    pane = Dielectric(1.5, tint=(0.8, 0.8, 0.8), absorption=(2.0, 2.0, 2.0))
    expected = (0.8 * 0.96) ** 2 * math.exp(-0.2)
    assert _under_a_pane(pane, renderer=renderer, tinted_shadows=True, max_depth=1) == pytest.approx(expected, rel=1e-3)
    assert _under_a_pane(pane, renderer=renderer, tinted_shadows=False, max_depth=1) == 0.0
    by_default = _under_a_pane(pane, renderer=renderer, max_depth=1)
    assert by_default == (pytest.approx(expected, rel=1e-3) if renderer == "ray" else 0.0)


@SLOW_AS_PYTHON
def test_path_finds_light_through_glass_by_chance_or_straight_but_not_twice():
    """A floor under a pane and a shining ceiling: found through the pane by chance, or asked for straight through it, it is as bright."""
    floor = place(Plane(), Lambert(color=(0.5, 0.5, 0.5)))
    ceiling = place(two_triangles((-3, 3, -3), (3, 3, -3), (3, 3, 3), (-3, 3, 3)), Lambert(color=0, emission=(1, 1, 1)))
    pane = place(Box((30, 0.05, 30)), Dielectric(1.5), at=(0, 1, 0))
    camera = PerspectiveCamera.look_at((0.0, 0.5, 0.0), (0, 0, 0), up=(0, 0, -1), yfov_degrees=10)
    scene = scene_of(floor, ceiling, pane, DARK, camera=camera)
    means = [
        _pixels(scene, 12, 12, renderer="path", samples=1024, max_depth=5, tinted_shadows=tinted)[..., 0].mean() for tinted in (False, True)
    ]
    assert means[1] == pytest.approx(means[0], rel=0.05)


@SLOW_AS_PYTHON
def test_frosted_glass_agrees_between_the_renderers():
    """What lies behind a rough pane, and what it reflects: the same mean, whether both ways are followed or one by lot."""
    frosted = Dielectric(1.5, roughness=0.4)
    sky = place(Box((40, 40, 40)), Lambert(color=0, emission=(0.3, 0.6, 1.0)))
    lamp = place(Sphere(0.8), Lambert(color=0, emission=(5.0, 4.0, 3.0)), at=(0.5, 0.3, -3))
    camera = PerspectiveCamera.look_at((0.4, 0.6, 4), (0, 0, 0), yfov_degrees=30)
    scene = scene_of(sky, lamp, place(Box((1.5, 1.5, 0.2)), frosted), DARK, camera=camera)
    ray = _pixels(scene, 16, 16, samples=256, max_depth=8)
    path = _pixels(scene, 16, 16, renderer="path", samples=1024, max_depth=8)
    np.testing.assert_allclose(ray[5:11, 5:11, :3].mean(axis=(0, 1)), path[5:11, 5:11, :3].mean(axis=(0, 1)), rtol=0.02)


@SLOW_AS_PYTHON
def test_mirrors_and_glass_agree_between_the_renderers():
    """Without anything matte, a path is one way through the tree of rays: the same picture in the mean."""
    sky = place(Box((40, 40, 40)), Lambert(color=0, emission=(0.3, 0.6, 1.0)))
    lamp = place(Sphere(1.5), Lambert(color=0, emission=(5.0, 4.0, 3.0)), at=(-2, 1, -5))
    mirror = place(Sphere(0.6), BlinnPhong(diffuse=0, mirror=(0.9, 0.8, 0.7)), at=(0.9, 0, 0))
    ball = place(Sphere(0.7), Dielectric(1.5, absorption=(0.1, 0.3, 0.8)), at=(-0.6, 0, 0))
    camera = PerspectiveCamera.look_at((0, 0.5, 4), (0, 0, 0), yfov_degrees=36)
    scene = scene_of(sky, lamp, mirror, ball, DARK, camera=camera)
    ray, path = _pixels(scene, 16, 16, samples=64), _pixels(scene, 16, 16, renderer="path", samples=512)
    np.testing.assert_allclose(ray[..., :3].mean(axis=(0, 1)), path[..., :3].mean(axis=(0, 1)), rtol=0.015)


def test_a_backdrop_is_seen_through_glass():
    """A background colour lies behind everything: seen past, in and through."""
    camera = PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0))
    scene = scene_of(place(Sphere(1.0), Dielectric(1.0)), DARK, camera=camera, background=(0.2, 0.4, 0.8))
    for renderer in ("ray", "path"):
        seen = _pixels(scene, 8, 8, renderer=renderer)[..., :3]
        np.testing.assert_allclose(seen, np.broadcast_to((0.2, 0.4, 0.8), (8, 8, 3)), rtol=1e-5)


@BOTH
def test_glass_before_nothing_is_as_clear_as_it_is(renderer):
    """On a transparent background the alpha is what does not go through: nothing of air, 1 - tint of a filter, 1 - T of a pane; opaque
    where something stands behind it."""
    camera = PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0), yfov_degrees=1)
    r = _reflectance(1.0, 1.5)
    for glass, expected in ((Dielectric(1.0), 0.0), (Dielectric(1.0, tint=(0.5,) * 3), 0.75), (Dielectric(1.5), 1 - (1 - r) / (1 + r))):
        pane = place(Box((9, 9, 0.5)), glass)
        options = {"renderer": renderer, "samples": 4 if renderer == "ray" else 1024}
        seen = _pixels(scene_of(pane, DARK, camera=camera), 3, 3, **options)[..., 3]
        assert seen.mean() == pytest.approx(expected, abs=2e-3 if renderer == "ray" else 0.02)
        np.testing.assert_allclose(_pixels(scene_of(pane, _wall(-3), DARK, camera=camera), 3, 3, **options)[..., 3], 1.0, atol=2e-3
                                   if renderer == "ray" else 0.05)  # fmt: skip


# --- bad input ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"ior": 0.0}, "material.ior must be positive"), ({"ior": -1.5}, "material.ior must be positive"),
        ({"ior": math.nan}, "material.ior must be finite"), ({"roughness": -0.1}, "material.roughness must lie in"),
        ({"tint": (1.0, 1.2, 1.0)}, "material.tint must lie in"),
        ({"absorption": (-1.0, 0.0, 0.0)}, "material.absorption must not be below 0"),
        ({"fresnel": "cook"}, 'material.fresnel must be "exact" or "schlick"'), ({"priority": 0.5}, "material.priority must be an integer"),
    ],
)  # fmt: skip
def test_what_is_no_glass(fields, said):
    with pytest.raises(SceneError, match=said):
        Dielectric(**fields)


def test_what_is_no_colour_of_glass_and_no_fog():
    with pytest.raises(SceneError, match="color must lie in"):
        Dielectric.with_color_at((0.0, 0.5, 0.5), 1.0)
    with pytest.raises(SceneError, match="depth must be positive"):
        Dielectric.with_color_at((0.5, 0.5, 0.5), 0.0)
    with pytest.raises(SceneError, match=r"fog.density must not be negative"):
        Fog(density=-1.0)
    with pytest.raises(SceneError, match=r"scene.fog must be a Fog"):
        Scene(fog=0.1)  # type: ignore[arg-type]


def test_more_kinds_of_glass_than_a_byte_counts():
    panes = [place(Sphere(0.1), Dielectric(1.0 + k / 1000), at=(k, 0, 0)) for k in range(1, 257)]
    with pytest.raises(UnsupportedError, match="more than 255 dielectric materials, got 256"):
        render(scene_of(*panes), width=2, height=2, renderer="ray")


def test_a_light_in_a_solid_is_told_of():
    """A lamp in an opaque ball lights nothing outside, and the picture says so; in glass, or round the camera, it is as it should be."""
    lamp = point_light_at((0, 0, 0), PointLight())

    def said(*nodes: Node, eye: object = (0, 0, 5)) -> tuple[str, ...]:
        camera = PerspectiveCamera.look_at(eye, (0, 0, -9))
        return render(scene_of(lamp, *nodes, camera=camera), width=4, height=4, samples=1, renderer="ray").warnings

    assert "its light does not get out" in said(place(Sphere(1.0)))[0]
    assert "its light does not get out" in said(place(Box((1, 1, 1)), MetallicRoughness()))[0]
    assert said(place(Sphere(1.0), Dielectric())) == ()
    assert said(place(Sphere(9.0))) == ()
    assert said(place(Sphere(1.0), at=(1.2, 0, 0))) == ()


def test_raster_says_what_it_leaves_out():
    scene = _through(place(Sphere(1.0), Dielectric()), fog=Fog())
    warnings = render(scene, width=8, height=8, renderer="raster").warnings
    assert [text for text in warnings if "bend light" in text]
    assert [text for text in warnings if "no fog" in text]
