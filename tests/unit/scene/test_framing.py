"""The camera and the lights that a scene gets when it has none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.errors import SceneError
from limner.linear import projection, transform
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.framing import default_lights, extent_points, framing_camera, with_defaults
from limner.scene.light import AmbientLight, DirectionalLight, PointLight
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Plane, Shape, Sphere

boxes = st.tuples(
    st.tuples(*[st.floats(-100, 100)] * 3), st.tuples(*[st.floats(0.01, 50)] * 3)
).map(lambda b: np.array([b[0], np.add(*b)]))  # fmt: skip


@given(boxes, st.floats(0.3, 3.0), st.floats(10, 120), st.floats(-180, 180), st.floats(-80, 80), st.integers(1, 30))
def test_framing_camera_just_holds_all_points(bounds, aspect, yfov, azimuth, elevation, n):
    """No point comes nearer to the side than 1/1.08, and at least two opposite sides are touched at that: none stands nearer."""
    points = np.random.default_rng(n).uniform(*bounds, size=(n + 1, 3))
    camera = framing_camera(points, aspect, yfov_degrees=yfov, azimuth_degrees=azimuth, elevation_degrees=elevation)
    x, y, z = transform.transform_points(projection.camera_from_world(camera), points).T
    extent = np.linalg.norm(np.ptp(points, axis=0))
    assert z.max() <= -0.25 * extent * (1 - 1e-9)
    tangent = math.tan(math.radians(yfov) / 2)
    across, upwards = x / -z / (tangent * aspect), y / -z / tangent
    most = max(np.abs(across).max(), np.abs(upwards).max())
    assert most <= (1 / 1.08) * (1 + 1e-6)
    if z.max() < -0.2500001 * extent:
        touched = across if np.abs(across).max() > np.abs(upwards).max() else upwards
        assert touched.max() == pytest.approx(1 / 1.08, rel=1e-6)
        assert touched.min() == pytest.approx(-1 / 1.08, rel=1e-6)


@given(st.floats(-180, 180), st.floats(-80, 80), st.floats(0.2, 5.0))
def test_a_framed_sphere_is_whole_and_fills_the_picture(azimuth, elevation, radius):
    """The sphere's silhouette cone fits between the sides, and takes more than four fifths of them."""
    scene = Scene(Node(shapes=(Shape(Sphere(radius)),)))
    camera = framing_camera(extent_points(scene), 1.0, azimuth_degrees=azimuth, elevation_degrees=elevation)
    distance = np.linalg.norm(camera.world_from_camera[:3, 3])
    half = math.tan(math.asin(radius / distance)) / math.tan(math.radians(20.0))
    assert 0.8 < half < 1.0


def test_framing_camera_stands_where_the_angles_say():
    """Azimuth from +z towards +x, elevation above the horizon, upright."""
    bounds = [[-1, -1, -1], [1, 1, 1]]
    for azimuth, elevation, expected in ((0, 0, (0, 0, 1)), (90, 0, (1, 0, 0)), (180, 30, (0, 0.5, -math.sqrt(0.75)))):
        camera = framing_camera(bounds, 1.0, azimuth_degrees=azimuth, elevation_degrees=elevation)
        np.testing.assert_allclose(camera.world_from_camera[:3, 2], expected, atol=1e-12)
        assert camera.world_from_camera[1, 1] > 0.0


@pytest.mark.parametrize(
    "bounds",
    [
        [[np.inf] * 3, [-np.inf] * 3],
        [[0, 0, 0], [0, 0, 0]],
        [[1e5, 1e5, 1e5], [1e5, 1e5, 1e5]],
        [[-1e-12, 0, 0], [1e-12, 0, 0]],
        [[-1e8] * 3, [1e8] * 3],
    ],
    ids=["nothing", "a point", "a far point", "an atom", "a planet"],
)
def test_degenerate_bounds_have_a_camera(bounds):
    """Finite, at a positive distance, looking at the place where there would be something."""
    camera = framing_camera(bounds, 1.5)
    eye = camera.world_from_camera[:3, 3]
    center = np.mean(bounds, axis=0) if np.isfinite(bounds).all() else np.zeros(3)
    assert np.isfinite(camera.world_from_camera).all()
    assert np.linalg.norm(eye - center) > 0.0
    lights = default_lights(camera, bounds)
    assert all(np.isfinite(matrix).all() for _, matrix in lights)


@pytest.mark.parametrize(
    "arguments", [{"aspect": 0.0}, {"aspect": math.nan}, {"yfov_degrees": 180.0}, {"elevation_degrees": 90.0}]
)
def test_impossible_framings_are_refused(arguments):
    with pytest.raises(SceneError):
        framing_camera([[0, 0, 0], [1, 1, 1]], **{"aspect": 1.0, **arguments})


@given(st.floats(-180, 180), st.floats(-80, 80))
def test_white_matte_facing_the_key_has_radiance_nine_tenths(azimuth, elevation):
    """The sum of E cos / pi over the directional lights, and the ambient radiance; wherever the camera stands."""
    bounds = [[-1, -2, -3], [3, 2, 1]]
    camera = framing_camera(bounds, 1.0, azimuth_degrees=azimuth, elevation_degrees=elevation)
    lights = default_lights(camera, bounds)
    suns = [(light.intensity, matrix[:3, 2]) for light, matrix in lights if isinstance(light, DirectionalLight)]
    ambient = sum(light.intensity for light, _ in lights if isinstance(light, AmbientLight))
    key = max(suns, key=lambda sun: sun[0])[1]
    total = ambient + sum(lux / math.pi * max(0.0, direction @ key) for lux, direction in suns)
    assert total == pytest.approx(0.9)
    # From the camera's side, from above, and from the left.
    u, v, w = camera.world_from_camera[:3, :3].T
    assert key @ w > 0.5
    assert key @ v > 0.3
    assert key @ u < 0.0


def scene_of(*lights, camera=None, **fields) -> Scene:
    ball = Node(name="ball", shapes=(Shape(Sphere()),))
    return Scene(root=Node(children=(ball, Node(name="lamps", lights=lights))), camera=camera, **fields)


def test_a_bare_scene_gets_camera_and_lights_and_says_so():
    scene, messages = with_defaults(scene_of(), 1.5)
    assert scene.camera is not None
    assert len(scene.lights()) == 3
    assert len(messages) == 2
    assert "no camera" in messages[0]
    assert "no light" in messages[1]
    assert [placed.path for placed, _ in scene.shapes()] == ["world/ball"]


def test_a_complete_scene_is_left_alone():
    given_scene = scene_of(PointLight(), camera=PerspectiveCamera())
    scene, messages = with_defaults(given_scene, 1.5)
    assert scene is given_scene
    assert messages == ()


def test_the_first_camera_of_the_graph_is_taken_before_framing():
    """The scene's own camera, else the graph's first where its node stands, else a new one."""
    first = Node(name="a", parent_from_node=transform.translate(1, 2, 3), cameras=(OrthographicCamera(name="first"),))
    second = Node(name="b", cameras=(PerspectiveCamera(name="second"),))
    bare = Scene(root=Node(children=(first, second), lights=(PointLight(),)))
    scene, messages = with_defaults(bare, 1.0)
    assert scene.camera.name == "first"
    np.testing.assert_array_equal(scene.camera.world_from_camera[:3, 3], [1, 2, 3])
    assert messages == ()
    own = PerspectiveCamera(name="own")
    assert with_defaults(bare.replace(camera=own), 1.0)[0].camera is own


@pytest.mark.parametrize(
    "root_matrix",
    [transform.translate(1, 2, 3) @ transform.rotate_x(1.0) @ transform.scale(2, 3, 4), transform.scale(1, 0, 1)],
    ids=["moved", "flattened"],
)
def test_lights_stand_in_the_world_whatever_the_root_does(root_matrix):
    """Default lights are given in world space; a root's own matrix is taken out again."""
    root = Node(parent_from_node=root_matrix, shapes=(Shape(Sphere()),))
    scene, _ = with_defaults(Scene(root=root, camera=PerspectiveCamera()), 1.0)
    expected = default_lights(scene.camera, scene.bounds())
    for (placed, _), (_, matrix) in zip(scene.lights(), expected, strict=True):
        np.testing.assert_allclose(placed.world_from_object, matrix, atol=1e-9)


def test_lights_shine_on_a_hidden_scene_and_on_planes_alone():
    """A scene whose root is invisible, or whose only shape has no bounds, still makes a picture."""
    for root in (Node(visible=False, shapes=(Shape(Sphere()),)), Node(shapes=(Shape(Plane()),)), Node()):
        scene, messages = with_defaults(Scene(root=root), 2.0)
        assert len(scene.lights()) == 3
        assert len(messages) == 2
