"""The path tracer against what can be computed by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.render import Renderer
from limner.scene.camera import PerspectiveCamera
from limner.scene.environment import Environment
from limner.scene.light import AmbientLight, DirectionalLight, PointLight
from limner.scene.material import BlinnPhong, Lambert, MetallicRoughness, ShadowCatcher
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Shape, Sphere

pytestmark = pytest.mark.compiled

INSIDE = PerspectiveCamera(yfov_degrees=70.0)
FROM_FRONT = PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0), yfov_degrees=20.0)


def picture(scene: Scene, *, size: int = 24, samples: int = 64, max_depth: int = 8, seed: int = 0) -> np.ndarray:
    with Renderer(
        scene, renderer="path", width=size, height=size, samples=samples, max_depth=max_depth, seed=seed, default_lights=False
    ) as renderer:
        return renderer.render().pixels.astype(np.float64)


@pytest.mark.parametrize("max_depth", [0, 1, 2, 5, 20])
def test_furnace(max_depth):
    """Inside a closed box that shines with 1 and reflects a, the radiance is 1 + a + a^2 + …, to as many terms as are followed."""
    albedo = 0.6
    furnace = Shape(Box((2, 2, 2)), (Lambert(color=(albedo,) * 3, emission=(1.0, 1.0, 1.0)),))
    seen = picture(Scene(Node(shapes=(furnace,)), camera=INSIDE), max_depth=max_depth, samples=256)
    assert seen[..., :3].mean() == pytest.approx(sum(albedo**k for k in range(max_depth + 1)), rel=0.01)


@pytest.mark.parametrize("geometry", [Sphere(1.0), primitives.sphere(1.0, 64)], ids=["exact", "mesh"])
def test_sphere_round_a_light(geometry):
    """A sphere of albedo 1/2 round a point light of pi candela: direct light 1/2, with all that follows 1, everywhere alike."""
    light = Node(lights=(PointLight(intensity=math.pi),))
    scene = Scene(Node(shapes=(Shape(geometry, (Lambert((0.5, 0.5, 0.5)),)),), children=(light,)), camera=INSIDE)
    seen = picture(scene, max_depth=30, samples=128)[..., :3]
    assert seen.mean() == pytest.approx(1.0, rel=0.005)
    assert seen.mean(axis=2).std() < 0.1


@pytest.mark.parametrize("turn", [0.0, 117.0])
def test_convex_body_under_an_even_sky(turn):
    """Every point of a matte sphere under a sky of radiance L reflects albedo L."""
    scene = Scene(
        Node(shapes=(Shape(Sphere(1.0), (Lambert((0.8, 0.5, 0.2)),)),)),
        camera=FROM_FRONT,
        environment=Environment((2.0, 2.0, 2.0), rotation_degrees=turn),
    )
    seen = picture(scene)
    inside = seen[10:14, 10:14, :3]
    np.testing.assert_allclose(inside.mean(axis=(0, 1)), [1.6, 1.0, 0.4], rtol=0.01)


@pytest.mark.parametrize("roughness", [0.1, 0.3, 0.5, 1.0])
def test_white_metal_under_an_even_sky(roughness):
    """One reflection off microfacets, the rest lost: seen from straight above, by the integral of the lobe.

    For roughness 1 the lobe is ``1 / (2 pi (n.l + 1))`` and its integral with the cosine is 1 - ln 2.
    """
    metal = MetallicRoughness((1.0, 1.0, 1.0), metallic=1.0, roughness=roughness, double_sided=True)
    camera = PerspectiveCamera.look_at((0, 1, 0), (0, 0, 0), up=(0, 0, 1), yfov_degrees=0.5)
    scene = Scene(Node(shapes=(Shape(Plane(), (metal,)),)), camera=camera, environment=Environment((1.0, 1.0, 1.0)))
    value = picture(scene, samples=512, size=12)[..., :3].mean()
    cosine = (np.arange(200_000) + 0.5) / 200_000
    alpha2 = roughness**4
    half = np.sqrt((1 + cosine) / 2)
    distribution = alpha2 / (math.pi * (half**2 * (alpha2 - 1) + 1) ** 2)
    visibility = 0.5 / (cosine + np.sqrt(cosine**2 * (1 - alpha2) + alpha2))
    expected = 2 * math.pi * (distribution * visibility * cosine).mean()
    if roughness == 1.0:
        assert expected == pytest.approx(1 - math.log(2), rel=1e-4)
    assert value == pytest.approx(expected, rel=0.01)
    assert value < 1.0


def _square_light(height: float, side: float, radiance: float) -> Node:
    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], dtype=np.float32) * np.float32(side / 2)
    mesh = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32))
    material = Lambert((0.0, 0.0, 0.0), emission=(radiance,) * 3, double_sided=False)
    return Node("light", transform.translate(0, height, 0), shapes=(Shape(mesh, (material,)),))


@pytest.mark.parametrize(("height", "side"), [(1.0, 1.0), (0.25, 2.0), (3.0, 0.5)])
def test_square_light_over_a_floor(height, side):
    """Radiance of the floor below the middle of a square light: albedo L F, with the form factor of parallel squares.

    **Source**: Howell, *A catalog of radiation heat transfer configuration factors*, B-3, four quadrants.
    """
    a = side / 2 / height
    quadrant = 2 * a / math.sqrt(1 + a * a) * math.atan(a / math.sqrt(1 + a * a)) / (2 * math.pi)
    floor = Node("floor", shapes=(Shape(Plane(), (Lambert((0.5, 0.5, 0.5)),)),))
    camera = PerspectiveCamera.look_at((0, 0.1 * height, 0), (0, 0, 0), up=(0, 0, 1), yfov_degrees=1.0)
    seen = picture(Scene(Node(children=(floor, _square_light(height, side, 3.0))), camera=camera), size=8, samples=1024, max_depth=1)
    assert seen[..., :3].mean() == pytest.approx(0.5 * 3.0 * 4 * quadrant, rel=0.01)


def test_light_is_found_alike_by_asking_and_by_chance():
    """The estimators are weighted so that a scene does not change its mean when its light is given as one emitter or as the sky."""
    sky = np.zeros((64, 128, 3), dtype=np.float32)
    sky[5:12, 20:40] = 30.0
    shiny = BlinnPhong(diffuse=(0.3, 0.3, 0.3), specular=(0.4, 0.4, 0.4), exponent=20.0)
    floor = Node(shapes=(Shape(Plane(), (shiny,)),))
    camera = PerspectiveCamera.look_at((0, 1, 3), (0, 0, 0), yfov_degrees=10.0)
    scene = Scene(Node(children=(floor,)), camera=camera, environment=Environment(sky))
    asked = picture(scene, samples=512, max_depth=1)[..., :3].mean()
    # The same sky seen by chance only: as ambient rays would, with no density to ask by.
    turned = picture(scene.replace(environment=Environment(np.roll(sky, 64, axis=1), rotation_degrees=180.0)), samples=512, max_depth=1)
    assert turned[..., :3].mean() == pytest.approx(asked, rel=0.02)


def test_ambient_light_is_an_even_sky_that_is_not_seen():
    """A matte sphere in ambient light I_a has radiance albedo I_a; what lies behind stays transparent."""
    scene = Scene(
        Node(shapes=(Shape(Sphere(1.0), (Lambert((0.5, 0.5, 0.5)),)),), lights=(AmbientLight(intensity=0.8),)),
        camera=PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0), yfov_degrees=40.0),
    )
    seen = picture(scene)
    assert seen[10:14, 10:14, :3].mean() == pytest.approx(0.4, rel=0.02)
    assert seen[0, 0].tolist() == [0.0, 0.0, 0.0, 0.0]


def test_directional_light_agrees_with_ray():
    """Direct light alone is what Whitted's algorithm computes: the same numbers at pixels without edges."""
    sun = Node("sun", transform.rotate_x(-1.0), lights=(DirectionalLight(intensity=3.0),))
    scene = Scene(Node(children=(Node(shapes=(Shape(Plane(), (Lambert((0.5, 0.5, 0.5)),)),)), sun)),
                  camera=PerspectiveCamera.look_at((0, 2, 4), (0, 0, 0)))  # fmt: skip
    with Renderer(scene, renderer="ray", width=24, height=24, samples=1, default_lights=False) as renderer:
        expected = renderer.render().pixels
    np.testing.assert_allclose(picture(scene, max_depth=1, samples=4)[14:, :, :3], expected[14:, :, :3], rtol=1e-5)


@pytest.mark.parametrize("renderer", ["ray", "path"])
def test_shadow_catcher_shows_only_the_shadow(renderer):
    """Under the sun alone, the ground is black and opaque in the ball's shadow, and not there elsewhere."""
    sun = Node("sun", transform.rotate_x(-math.pi / 2), lights=(DirectionalLight(intensity=3.0),))
    ball = Node("ball", transform.translate(0, 3, 0), shapes=(Shape(Sphere(0.5)),))
    ground = Node("ground", shapes=(Shape(Plane(), (ShadowCatcher(),)),))
    camera = PerspectiveCamera.look_at((0, 2, 0), (0, 0, 0), up=(0, 0, 1), yfov_degrees=60.0)
    with Renderer(
        Scene(Node(children=(sun, ball, ground)), camera=camera), renderer=renderer, width=32, height=32, samples=4, default_lights=False
    ) as made:
        pixels = made.render().pixels
    assert pixels[15:17, 15:17].tolist() == [[[0.0, 0.0, 0.0, 1.0]] * 2] * 2
    assert pixels[0, 0].tolist() == [0.0, 0.0, 0.0, 0.0]


def test_refine_ends_where_render_does():
    """Better and better, and the last is the picture that `render` makes, to the bit."""
    scene = Scene(Node(shapes=(Shape(Sphere(1.0)),), lights=(AmbientLight(),)), camera=FROM_FRONT)
    with Renderer(scene, renderer="path", width=40, height=30, samples=13) as renderer:
        refined = list(renderer.refine())
        assert [image.recipe["samples"] for image in refined] == [1, 2, 4, 8, 13]
        assert np.array_equal(refined[-1].pixels, renderer.render().pixels)
