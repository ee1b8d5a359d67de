"""The scenes that come with limner: as measured, well exposed, and in the picture."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest

from limner.errors import SceneError
from limner.linear import projection, transform
from limner.scene.framing import with_defaults
from limner.scene.library import BUILTINS, builtin
from limner.scene.light import AmbientLight, DirectionalLight, SpotLight
from limner.scene.shape import Plane


def world_mesh(scene, path) -> tuple[np.ndarray, np.ndarray]:
    placed, shape = next((p, s) for p, s in scene.shapes() if p.path == path)
    return transform.transform_points(placed.world_from_object, shape.geometry.positions), shape.geometry.triangles


def in_picture(scene, points, aspect) -> np.ndarray:
    clip = projection.clip_from_camera(scene.camera, 1000, round(1000 / aspect), 0.01, 100.0)
    seen = np.c_[points, np.ones(len(points))] @ (clip @ projection.camera_from_world(scene.camera)).T
    assert (seen[:, 3] > 0.0).all()
    return seen[:, :2] / seen[:, 3:]


@pytest.mark.parametrize("name", BUILTINS)
def test_builtins_are_complete(name):
    """Each brings its camera and its lights: nothing has to be added, and names are unique."""
    scene = builtin(name)
    same, messages = with_defaults(scene, 4 / 3)
    assert same is scene
    assert messages == ()
    paths = [placed.path for placed in scene.walk()]
    assert len(set(paths)) == len(paths)


def test_unknown_builtins_are_named():
    with pytest.raises(SceneError, match="cornell and teapot, got 'kettle'"):
        builtin("kettle")


@pytest.mark.parametrize("aspect", [4 / 3, 16 / 9])
def test_teapot_fills_the_picture_without_touching_its_border(aspect):
    scene = builtin("teapot")
    seen = in_picture(scene, world_mesh(scene, "teapot/pot")[0], aspect)
    assert np.abs(seen).max() < 0.95
    assert np.ptp(seen[:, 0]).max() > 1.0
    assert abs(seen[:, 0].max() + seen[:, 0].min()) < 0.2


def test_teapot_floor_fades_into_the_background():
    """Where the tiles blur into their mean, the lit floor has the background's radiance: the horizon cannot be seen."""
    scene = builtin("teapot")
    shape = next(s for _, s in scene.shapes() if isinstance(s.geometry, Plane))
    material = shape.materials[0]
    tone = material.texture.texels.pixels[..., :3].reshape(-1, 3).mean(axis=0) / 255.0
    light = np.zeros(3)
    for placed, lamp in scene.lights():
        color = np.array(lamp.color) * lamp.intensity
        if isinstance(lamp, DirectionalLight):
            light += color / math.pi * placed.world_from_object[1, 2]
        elif isinstance(lamp, AmbientLight):
            light += color
    assert not material.texture.texels.srgb
    np.testing.assert_allclose(scene.background, tone * light, rtol=1e-9)
    assert 0.2 < np.mean(scene.background) < 0.8


def test_cornell_box_has_the_measured_geometry():
    """Corners and areas from the published table (millimetres), the camera of the photograph, everything facing inside."""
    scene = builtin("cornell")
    np.testing.assert_allclose(scene.bounds(), [[0, 0, 0], [0.556, 0.5488, 0.5592]], atol=1e-7)
    middle = np.array([0.278, 0.274, 0.28])
    for path, area in (("floor", 0.5 * (0.5528 + 0.5496) * 0.5592), ("ceiling", 0.556 * 0.5592), ("light", 0.13 * 0.105)):
        p, t = world_mesh(scene, f"cornell/{path}")
        cross = np.cross(p[t[:, 1]] - p[t[:, 0]], p[t[:, 2]] - p[t[:, 0]])
        assert np.linalg.norm(cross, axis=1).sum() / 2 == pytest.approx(area, rel=1e-5)
    for path in ("floor", "ceiling", "light", "back wall", "left wall", "right wall"):
        p, t = world_mesh(scene, f"cornell/{path}")
        cross = np.cross(p[t[:, 1]] - p[t[:, 0]], p[t[:, 2]] - p[t[:, 0]])
        assert (np.einsum("mc,mc->m", cross, middle - p[t[:, 0]]) > 0.0).all()
    for path, corner in (("short block", (0.290, 0.165, 0.114)), ("tall block", (0.472, 0.330, 0.406))):
        p, t = world_mesh(scene, f"cornell/{path}")
        assert np.abs(p - corner).max(axis=1).min() < 1e-6
        cross = np.cross(p[t[:, 1]] - p[t[:, 0]], p[t[:, 2]] - p[t[:, 0]])
        assert (np.einsum("mc,mc->m", cross, p[t].mean(axis=1) - p.mean(axis=0)) > 0.0).all()
    camera = scene.camera
    np.testing.assert_allclose(camera.world_from_camera[:3, 3], [0.278, 0.273, -0.8])
    np.testing.assert_allclose(camera.world_from_camera[:3, 2], [0, 0, -1])
    assert camera.half_height() == pytest.approx(0.0125 / 0.035)


def test_cornell_box_has_red_on_the_left():
    """Seen by its camera: +x is on the left there, and the red wall with it."""
    scene = builtin("cornell")
    for path, side in (("left wall", -1), ("right wall", 1)):
        assert (in_picture(scene, world_mesh(scene, f"cornell/{path}")[0], 1.0)[:, 0] * side > 0.5).all()
    red = next(s.materials[0] for p, s in scene.shapes() if p.path == "cornell/left wall")
    assert red.color[0] > 5 * red.color[1]


def test_cornell_box_is_well_exposed():
    """Direct light, E = I/d^2 and kd E/pi: the floor's middle is bright and not burnt, and the lamp lights nothing above it."""
    scene = builtin("cornell")
    placed, lamp = next((p, light) for p, light in scene.lights() if isinstance(light, SpotLight))
    position, down = placed.world_from_object[:3, 3], -placed.world_from_object[:3, 2]
    np.testing.assert_allclose(down, [0, -1, 0], atol=1e-12)
    assert lamp.outer_degrees == 90.0
    light_height = world_mesh(scene, "cornell/light")[0][:, 1]
    assert position[1] < light_height.min() <= light_height.max() < 0.5488
    radiance = 0.7 / math.pi * lamp.intensity / position[1] ** 2
    assert 0.3 < radiance < 0.9


def test_describing_a_scene_does_not_import_the_compiler():
    """Built-ins, framing and their meshes are NumPy alone; neither SciPy nor Numba comes along."""
    code = (
        "import sys; import limner.scene.library as l, limner.scene.framing as f; f.with_defaults(l.builtin('teapot'), 1.5);"
        "assert not {'numba', 'llvmlite', 'scipy', 'PIL'} & set(sys.modules), 'imported'"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
