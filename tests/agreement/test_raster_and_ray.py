"""Both renderers see the same: the same surface at every pixel away from edges, and there the same colour to the last bit.

What they may differ in is *which* triangle a sample on an edge sees: the rasteriser rounds vertices to 1/256 pixel, the ray tracer
does not. So every comparison leaves out pixels whose neighbourhood holds an edge of the picture, and bounds how many differ at all.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, checkers, grid, interior, lit_from, place, scene_of, seen_by_both, two_triangles

from limner.aov import CHANNELS
from limner.files.load import load
from limner.image.image import Image
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.library import BUILTINS, builtin
from limner.scene.light import PointLight, SpotLight
from limner.scene.material import BlinnPhong, Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Sphere

DATA = Path(__file__).resolve().parents[2] / ".." / "shared" / "data"
CAMERA = PerspectiveCamera.look_at((2.0, 1.6, 3.1), (0.1, 0.2, 0.0), yfov_degrees=42)


def _agree(raster: Image, ray: Image, at_edges: float) -> None:
    """Every channel and the picture are equal in the interior; at most a share `at_edges` of the pixels sees another surface."""
    same = (raster.aov["instance_id"] == ray.aov["instance_id"]) & (raster.aov["triangle_id"] == ray.aov["triangle_id"])
    inside = interior(raster.aov["instance_id"]) & interior(ray.aov["instance_id"])
    np.testing.assert_array_equal(raster.aov["instance_id"][inside], ray.aov["instance_id"][inside])
    assert (~same).mean() <= at_edges
    for name in (*raster.aov, "pixels"):
        mine, theirs = (image.pixels if name == "pixels" else image.aov[name] for image in (raster, ray))
        differs = (mine != theirs) & ~((mine != mine) & (theirs != theirs))
        assert not (differs.reshape(*same.shape, -1).any(axis=2) & same).any(), f"{name} differs where both see the same triangle"


def _solids(material: Callable[[], object] = Lambert) -> Scene:
    return scene_of(
        place(Sphere(0.7), material(), at=(-0.9, 0.7, 0.0)),
        place(Box((0.8, 1.2, 0.5)), material(), matrix=transform.translate(0.6, 0.6, -0.2) @ transform.rotate_y(0.6)),
        place(primitives.sphere(0.4, 12), material(), at=(0.3, 0.4, 1.0)),
        place(Plane(), Lambert(color=(0.5, 0.6, 0.7))),
        camera=CAMERA,
    )


def _reflected() -> Scene:
    """Negative scales turn triangles inside out; a mesh that stands in the scene three times is stored once."""
    pot = primitives.uv_sphere(14, 9, 0.5)
    one_sided = MetallicRoughness(base_color=(0.8, 0.4, 0.2), metallic=0.2, roughness=0.4)
    return scene_of(
        place(pot, one_sided, matrix=transform.translate(-1.0, 0.3, 0.0) @ transform.scale(-1.0, 1.2, 1.0)),
        place(pot, one_sided, matrix=transform.translate(0.2, 0.3, 0.0) @ transform.scale(-1.0, -0.7, -1.3)),
        place(pot, Lambert(color=(0.1, 0.6, 0.3)), matrix=transform.translate(1.2, 0.3, 0.0) @ transform.rotate_z(0.4)),
        place(Box((0.5, 0.5, 0.5)), one_sided, matrix=transform.translate(0.2, 1.1, 0.0) @ transform.scale(1.0, -1.0, 1.0)),
        place(Sphere(0.3), one_sided, matrix=transform.translate(0.9, 1.2, 0.0) @ transform.scale(-1.0, 1.4, 0.6)),
        camera=CAMERA,
    )


def _textured() -> Scene:
    floor = grid(9, 3.0)
    mirrored = checkers(16, wrap_u="mirror", wrap_v="clamp", scale=(3.0, 2.5), offset=(0.2, 0.1), rotation=0.4)
    return scene_of(
        place(floor, Lambert(texture=checkers(scale=(5.0, 5.0)))),
        place(Sphere(0.6), BlinnPhong(diffuse_texture=checkers(32), specular=0.5, exponent=40), at=(-0.7, 0.6, 0.3)),
        place(Box(), Lambert(texture=mirrored), matrix=transform.translate(0.8, 0.5, 0) @ transform.rotate_y(0.5)),
        place(two_triangles((-1, 0, -1), (1, 0, -1), (1, 1.5, -1), (-1, 1.5, -1)), Lambert(texture=checkers())),
        camera=CAMERA,
    )


def _masked() -> Scene:
    leaf = Lambert(texture=checkers(8, alpha=0, filter="nearest"), alpha_mode="mask")
    walls = [place(primitives.quad(((-1, 0, z), (1, 0, z), (1, 1.4, z), (-1, 1.4, z))), leaf) for z in (-0.8, 0.0, 0.7)]
    ball = place(Sphere(0.5), leaf, at=(0.0, 0.6, -1.6))
    return scene_of(*walls, ball, place(Plane(), Lambert(texture=checkers())), camera=CAMERA)


def _lights() -> Scene:
    lamp = Node(parent_from_node=transform.translate(0.5, 2.0, 1.0), lights=(PointLight(color=(1, 0.8, 0.6), intensity=9.0, range=5.0),))
    spot = lit_from((-1.5, 2.0, 1.5), SpotLight(intensity=30.0, inner_degrees=10, outer_degrees=25))
    gloss = BlinnPhong(diffuse=(0.3, 0.3, 0.5), specular=0.7, exponent=90, normalized=True, mirror=0.5)
    return Scene(Node(children=(*_solids(lambda: gloss).root.children, lamp, spot)), camera=CAMERA)


def _from_inside() -> Scene:
    """Solids of one-sided material are not seen from within, exact or not; the plane is not seen from below."""
    skin = MetallicRoughness(base_color=(0.5, 0.5, 0.5), metallic=0.0)
    eye = PerspectiveCamera.look_at((0, -0.2, 0), (0.5, -0.1, -1), yfov_degrees=80)
    shell = place(Sphere(3.0), Lambert(texture=checkers(32)))
    around = [place(Sphere(1.0), skin), place(Box((2.5, 2.5, 2.5)), skin), place(Plane(), skin, at=(0, 0.1, 0)), shell]
    return scene_of(*around, place(Box((0.2, 0.2, 0.2)), at=(0.4, -0.1, -0.8)), camera=eye)


SCENES = {
    "solids": _solids,
    "glossy": lambda: _solids(lambda: MetallicRoughness(base_color=(0.9, 0.6, 0.3), metallic=0.7, roughness=0.3)),
    "reflected": _reflected,
    "textured": _textured,
    "masked": _masked,
    "lights": _lights,
    "from inside": _from_inside,
    "orthographic": lambda: _solids().replace(
        camera=OrthographicCamera.look_at((2.0, 1.6, 3.1), (0.1, 0.5, 0.0), height=2.6)
    ),
    "orthographic, masked": lambda: _masked().replace(
        # The eye stands in the middle of things: what lies behind it has negative depth.
        camera=OrthographicCamera.look_at((0.3, 0.6, 0.1), (0.0, 0.5, -0.3), height=2.6)
    ),
}  # fmt: skip


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", SCENES)
def test_procedural_scenes(name):
    """Ids, every channel and colours agree on every kind of shape, material, light and camera."""
    raster, ray = seen_by_both(SCENES[name](), aovs=CHANNELS)
    _agree(raster, ray, at_edges=0.012)
    assert (raster.aov["instance_id"] >= 0).mean() > 0.2


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", BUILTINS)
def test_builtin_scenes(name):
    raster, ray = seen_by_both(builtin(name), 160, 120, aovs=CHANNELS)
    _agree(raster, ray, at_edges=0.002)


@SLOW_AS_PYTHON
def test_blended_surfaces():
    """Layers of glass over each other, in any order of drawing: equal up to the order of the sums."""
    glass = Lambert(color=(0.2, 0.7, 0.3), alpha=0.4, alpha_mode="blend")
    stained = Lambert(texture=checkers(8, alpha=90), alpha_mode="blend")
    panes = [
        place(primitives.quad(((-1, 0, z), (1, 0, z), (1, 1.4, z), (-1, 1.4, z))), glass if k % 2 else stained)
        for k, z in enumerate((0.6, -0.9, 0.1, -0.4))
    ]
    ball = place(Sphere(0.5), glass, at=(0.2, 0.6, 0.2))
    scene = scene_of(*panes, ball, place(Plane(), Lambert(texture=checkers())), camera=CAMERA)
    raster, ray = seen_by_both(scene)
    differs = (np.abs(raster.pixels - ray.pixels) > 2e-6).any(axis=2)
    assert differs.mean() < 0.012
    ids = raster.aov["instance_id"]
    assert not (differs & interior(ids) & interior(ray.aov["instance_id"])).mean() > 0.004  # edges of what is half transparent


@SLOW_AS_PYTHON
def test_shared_edges_of_blended_triangles_are_seen_once():
    """A blended surface of many triangles, seen along a pixel grid: no ray meets two of them, none slips through."""
    glass = Lambert(alpha=0.5, alpha_mode="blend")
    for n in (5, 9, 17):
        scene = scene_of(place(grid(n, 1.0), glass), camera=OrthographicCamera.look_at((0, 1, 0), (0, 0, 0), up=(0, 0, -1), height=2))
        for image in seen_by_both(scene, 33, 33, aovs=()):
            np.testing.assert_array_equal(image.pixels[..., 3], np.float32(0.5))


def test_depth_and_distance_and_position_are_of_one_point():
    """position = eye + distance along the pixel's ray, depth = its part along the gaze."""
    for scene in (_solids(), SCENES["orthographic"]()):
        for image in seen_by_both(scene, 48, 36, aovs=("position", "depth", "distance")):
            frame = scene.camera.world_from_camera
            hit = np.isfinite(image.aov["depth"])
            local = (image.aov["position"][hit].astype(np.float64) - frame[:3, 3]) @ frame[:3, :3]
            np.testing.assert_allclose(image.aov["depth"][hit], -local[:, 2], rtol=1e-5, atol=1e-5)
            np.testing.assert_allclose(image.aov["distance"][hit], np.linalg.norm(local, axis=1), rtol=1e-5)


@pytest.mark.parametrize("camera", ["perspective", "orthographic"])
def test_points_are_where_their_pixel_is(camera):
    """project(point on the ray through (x, y)) = (x, y), for both ways that the tables hold a camera."""
    scene = _solids() if camera == "perspective" else SCENES["orthographic"]()
    width, height = 61, 37
    for image in seen_by_both(scene, width, height, aovs=("position", "depth")):
        position = image.aov["position"].astype(np.float64)
        frame = scene.camera.world_from_camera
        local = (position - frame[:3, 3]) @ frame[:3, :3]
        scale = -local[..., 2] * math.tan(math.radians(21)) if camera == "perspective" else np.full((height, width), 1.3)
        x = local[..., 0] / scale * height / 2 + width / 2 - 0.5
        y = height / 2 - local[..., 1] / scale * height / 2 - 0.5
        row, column = np.indices((height, width))
        hit = np.isfinite(image.aov["depth"])
        near = hit & (image.aov["depth"] < 50)
        assert near.sum() > 500
        np.testing.assert_allclose(x[near], column[near], atol=2e-3)
        np.testing.assert_allclose(y[near], row[near], atol=2e-3)


@SLOW_AS_PYTHON
def test_a_triangle_through_the_eye_plane():
    """Vertices behind the eye, beside it, and on its very plane: clipped, and seen as the ray tracer sees them."""
    random = np.random.default_rng(4)
    for k in range(12):
        points = random.normal(size=(9, 3)).astype(np.float32) * (1.0, 1.0, 2.0)
        if k % 3 == 0:
            points[::2, 2] = 0.0
        mesh = Mesh(points.astype(np.float32), np.arange(9, dtype=np.int32).reshape(3, 3))
        camera = PerspectiveCamera(yfov_degrees=100, near=0.01)
        raster, ray = seen_by_both(scene_of(place(mesh), camera=camera), 64, 48)
        _agree(raster, ray, at_edges=0.02)


MODELS = (
    "khronos/Box/Box.glb",
    "khronos/Duck/glTF-Binary/Duck.glb",
    "khronos/NegativeScaleTest/NegativeScaleTest.glb",
    "khronos/TextureSettingsTest/TextureSettingsTest.glb",
    "khronos/OrientationTest/OrientationTest.glb",
    "khronos/SimpleInstancing/SimpleInstancing.glb",
    "khronos/MultiUVTest/MultiUVTest.glb",
    "khronos/VertexColorTest/VertexColorTest.glb",
    "khronos/NormalTangentTest/NormalTangentTest.glb",
    "khronos/CesiumMilkTruck/CesiumMilkTruck.glb",
    "khronos/BoxTextured/glTF-Binary/BoxTextured.glb",
    "khronos/TextureTransformTest/TextureTransformTest.gltf",
    "khronos/MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb",
    "meshes/cow.obj",
    "meshes/fandisk.obj",
    "meshes/nefertiti.obj",
    "meshes/rocker-arm.obj",
    "meshes/spot.obj",
    "meshes/stanford-bunny.obj",
    "meshes/suzanne.obj",
    "meshes/teapot.obj",
)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
def test_models(name):
    """Real models agree like the procedural ones."""
    path = DATA / name
    if not path.exists():
        pytest.skip(f"the optional model {name} is not there")
    raster, ray = seen_by_both(load(path), 120, 90, aovs=CHANNELS)
    _agree(raster, ray, at_edges=0.03)
