"""Whole pictures against formulas: a plane under one light has a known radiance at every pixel.

The plane z = 0 fills the picture, the eye stands at (0, 0, 1): pixel (column, row) sees the point that `_points` tells. Each test
asks both renderers, which share the shading but not the way to it.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import flat_picture, point_light_at, scene_of, two_triangles

from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.render import RENDERERS, render
from limner.scene.light import AmbientLight, DirectionalLight, PointLight, SpotLight
from limner.scene.material import BlinnPhong, Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.shape import Shape

WIDTH, HEIGHT = 24, 18
WALL = two_triangles((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0))
KD = (0.7, 0.4, 0.2)
DIRECT = [name for name in ("raster", "ray") if name in RENDERERS]


@pytest.fixture(params=DIRECT)
def renderer(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def _points() -> NDArray[np.float64]:
    """(height, width, 3): what each pixel's centre sees of the plane z = 0."""
    step = 2.0 / HEIGHT
    x, y = np.meshgrid((np.arange(WIDTH) - (WIDTH - 1) / 2) * step, ((HEIGHT - 1) / 2 - np.arange(HEIGHT)) * step)
    return np.stack([x, y, np.zeros_like(x)], axis=-1)


def _picture(renderer: str, material: object, *lights: Node, mesh: Mesh = WALL, **scene_fields: object) -> NDArray[np.float64]:
    lights = lights or (Node(lights=(AmbientLight(intensity=0.0),)),)
    scene = scene_of(Node(shapes=(Shape(mesh, (material,)),)), *lights, camera=flat_picture(), **scene_fields)
    return render(scene, width=WIDTH, height=HEIGHT, renderer=renderer, samples=1).pixels.astype(np.float64)


def _unit(v: NDArray[np.float64]) -> NDArray[np.float64]:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def _facing(position: tuple[float, float, float]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Distance to a light, unit direction to it, and its cosine, at every pixel."""
    to_light = np.array(position) - _points()
    d = np.linalg.norm(to_light, axis=-1, keepdims=True)
    return d, to_light / d, (to_light / d)[..., 2:]


def test_lambert_under_a_point_light(renderer):
    """kd/pi I cos/d^2 (FoCG 4.5.1, 10.1.1; inverse square)."""
    place, candela = (0.4, 0.3, 1.7), 5.0
    d, _, cos = _facing(place)
    seen = _picture(renderer, Lambert(color=KD), point_light_at(place, PointLight(color=(1, 0.5, 0.25), intensity=candela)))
    expected = np.array(KD) / np.pi * candela * np.array((1, 0.5, 0.25)) * cos / d**2
    np.testing.assert_allclose(seen[..., :3], expected, rtol=2e-6)
    np.testing.assert_array_equal(seen[..., 3], 1.0)


def test_a_light_without_falloff(renderer):
    """The book's light: E = I at any distance (FoCG 4.5.1), so that the surface shows kd I/pi cos."""
    place = (0.4, 0.3, 1.7)
    _, _, cos = _facing(place)
    seen = _picture(renderer, Lambert(color=KD), point_light_at(place, PointLight(intensity=np.pi, falloff="none")))
    np.testing.assert_allclose(seen[..., :3], np.array(KD) * cos, rtol=2e-6)


def test_a_light_with_a_range(renderer):
    """KHR_lights_punctual: max(min(1 - (d/range)^4, 1), 0) / d^2."""
    place, reach = (0.9, 0.5, 0.4), 1.3
    d, _, cos = _facing(place)
    seen = _picture(renderer, Lambert(color=KD), point_light_at(place, PointLight(intensity=2.0, range=reach)))
    expected = np.array(KD) / np.pi * 2.0 * cos / d**2 * np.clip(1 - (d / reach) ** 4, 0, 1)
    np.testing.assert_allclose(seen[..., :3], expected, rtol=3e-5, atol=1e-6)
    assert (seen[..., :3] == 0).all(axis=2).any()


def test_lambert_under_the_sun(renderer):
    """kd/pi E cos for E lux, the light travelling along the node's -z."""
    towards = np.array((0.3, 0.8, 0.5))
    frame = transform.frame_from_gaze((0, 0, 0), -towards, (0, 1, 0.1))
    sun = Node(parent_from_node=frame, lights=(DirectionalLight(color=(1, 0.9, 0.8), intensity=4.0),))
    seen = _picture(renderer, Lambert(color=KD), sun)
    expected = np.array(KD) / np.pi * 4.0 * np.array((1, 0.9, 0.8)) * 0.5 / np.linalg.norm(towards)
    np.testing.assert_allclose(seen[..., :3], np.broadcast_to(expected, seen[..., :3].shape), rtol=2e-6)


def test_spot_cone(renderer):
    """KHR_lights_punctual: clamp(cos angle * scale + offset)^2 with scale = 1/(cos inner - cos outer), offset = -cos outer * scale."""
    place, inner, outer = (0.0, 0.0, 1.0), 10.0, 35.0
    d, l, cos = _facing(place)  # noqa: E741
    scale = 1 / (np.cos(np.radians(inner)) - np.cos(np.radians(outer)))
    cone = np.clip(l[..., 2:] * scale - np.cos(np.radians(outer)) * scale, 0, 1) ** 2
    spot = SpotLight(intensity=3.0, inner_degrees=inner, outer_degrees=outer)
    seen = _picture(renderer, Lambert(color=KD), point_light_at(place, spot))
    np.testing.assert_allclose(seen[..., :3], np.array(KD) / np.pi * 3.0 * cos / d**2 * cone, rtol=2e-5, atol=2e-6)
    assert (cone == 0).any()
    assert (cone == 1).any()


@pytest.mark.parametrize("normalized", [False, True])
def test_blinn_phong(renderer, normalized):
    """(kd n.l + ks (n.h)^p) E/pi, h = (v + l)/|v + l| (FoCG 4.5.2, 10.2.1; errata 4.5.2); normalised: ks (p + 2)/8."""
    place, ks, p = (0.5, 0.4, 0.8), (0.5, 0.6, 0.7), 40.0
    d, l, cos = _facing(place)  # noqa: E741
    v = _unit(np.array((0, 0, 1.0)) - _points())
    highlight = _unit(v + l)[..., 2:] ** p * ((p + 2) / 8 if normalized else 1.0)
    gloss = BlinnPhong(diffuse=KD, specular=ks, exponent=p, normalized=normalized)
    seen = _picture(renderer, gloss, point_light_at(place, PointLight(intensity=6.0)))
    np.testing.assert_allclose(seen[..., :3], (np.array(KD) * cos + np.array(ks) * highlight) * 6.0 / d**2 / np.pi, rtol=1e-4)


def test_ambient_light(renderer):
    """ka I_a, ka the diffuse coefficient unless given; lights of this kind add up (FoCG 4.5.3, 10.1.2)."""
    lights = [Node(lights=(AmbientLight(color=(1, 0.5, 1), intensity=i),)) for i in (0.25, 0.5)]
    for material, ka in (
        (Lambert(color=KD), KD),
        (BlinnPhong(diffuse=KD), KD),
        (BlinnPhong(diffuse=KD, ambient=(0.1, 0.2, 0.3)), (0.1, 0.2, 0.3)),
    ):
        seen = _picture(renderer, material, *lights)
        np.testing.assert_allclose(seen[0, 0, :3], np.array(ka) * (0.75, 0.375, 0.75), rtol=1e-6)
        assert (seen == seen[0, 0]).all()


def test_a_white_surface_vanishes_in_a_white_room(renderer):
    """Under ambient light 1 and before a background of 1, what is white cannot be seen."""
    for material in (Lambert(color=(1, 1, 1)), BlinnPhong(diffuse=(1, 1, 1)), MetallicRoughness(metallic=1.0)):
        seen = _picture(renderer, material, Node(lights=(AmbientLight(intensity=1.0),)), background=(1, 1, 1))
        np.testing.assert_allclose(seen, 1.0, rtol=1e-6)


def test_lights_add_up(renderer):
    """The picture under several lights is the sum of the pictures under each (FoCG 4.5.4)."""
    lights = [point_light_at(p, PointLight(intensity=i)) for p, i in (((1, 1, 1), 2.0), ((-1, 0.5, 0.6), 1.0), ((0, -1, 2), 4.0))]
    gloss = BlinnPhong(diffuse=KD, specular=0.5, exponent=20)
    parts = sum(_picture(renderer, gloss, light)[..., :3] for light in lights)
    np.testing.assert_allclose(_picture(renderer, gloss, *lights)[..., :3], parts, rtol=1e-6)


def test_emission_and_unlit_need_no_light(renderer):
    seen = _picture(renderer, Lambert(color=KD, emission=(0.3, 0.0, 2.0)))
    np.testing.assert_allclose(seen[3, 3, :3], (0.3, 0.0, 2.0))
    seen = _picture(renderer, MetallicRoughness(base_color=KD, unlit=True), point_light_at((0, 0, 1), PointLight(intensity=9.0)))
    np.testing.assert_allclose(seen[3, 3, :3], KD, rtol=1e-6)


def test_alpha_blends_over_the_background(renderer):
    """c alpha + b (1 - alpha); over nothing the colour stays straight."""
    glass = Lambert(color=KD, emission=(0.4, 0.8, 0.0), alpha=0.25, alpha_mode="blend")
    over_blue = _picture(renderer, glass, background=(0.0, 0.2, 1.0))
    np.testing.assert_allclose(over_blue[4, 4], (0.1, 0.35, 0.75, 1.0), rtol=1e-6)
    np.testing.assert_allclose(_picture(renderer, glass)[4, 4], (0.4, 0.8, 0.0, 0.25), rtol=1e-6)


def test_colour_runs_linearly_over_a_facing_triangle(renderer):
    """Vertex colours are interpolated with barycentric coordinates (FoCG 8.1.2)."""
    corners = np.array(((-9, -9, 0), (9, -9, 0), (0, 9, 0)), dtype=np.float32)
    mesh = Mesh(corners, np.array([[0, 1, 2]], dtype=np.int32), colors=np.eye(3, dtype=np.float32))
    white = Lambert(color=(1, 1, 1))
    seen = _picture(renderer, white, Node(lights=(AmbientLight(intensity=1.0),)), mesh=mesh)
    system = np.concatenate([corners[:, :2].T, np.ones((1, 3))])
    points = _points()
    b = np.linalg.solve(system, np.stack([points[..., 0].ravel(), points[..., 1].ravel(), np.ones(points[..., 0].size)]))
    np.testing.assert_allclose(seen[..., :3].reshape(-1, 3), b.T, atol=1e-6)


def test_normals_are_interpolated_then_shaded(renderer):
    """Phong's interpolation (FoCG 10.2.2, 8.2.5): the normal of a pixel is the unit mix of the vertices' normals."""
    corners = np.array(((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)), dtype=np.float32)
    normals = _unit(np.array(((-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)), dtype=np.float64)).astype(np.float32)
    mesh = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), normals=normals)
    sun = Node(lights=(DirectionalLight(intensity=np.pi),))  # along -z
    seen = _picture(renderer, Lambert(color=(1, 1, 1)), sun, mesh=mesh)
    p = _points()
    mixed = np.stack([p[..., 0] / 9, p[..., 1] / 9, np.ones(p.shape[:2])], axis=-1)
    np.testing.assert_allclose(seen[..., 0], _unit(mixed)[..., 2], rtol=1e-5)


def test_what_faces_away_from_the_light_is_black(renderer):
    seen = _picture(renderer, BlinnPhong(diffuse=1, specular=1, exponent=2), point_light_at((0, 0, -0.5), PointLight(intensity=9)))
    np.testing.assert_array_equal(seen[..., :3], 0.0)


def test_a_light_in_the_surface_itself(renderer):
    """At the light's own point there is neither direction nor distance: dark or bright, but a number."""
    assert np.isfinite(_picture(renderer, Lambert(), point_light_at((0, 0, 0), PointLight(intensity=1.0)))).all()
