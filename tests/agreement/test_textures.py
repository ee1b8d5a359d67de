"""Every kind of texture on a small scene, by the rasteriser and by rays: within 1/255 away from edges; and by paths, in the mean."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, interior, lit_from, place, scene_of, seen_by_both

from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.render import render
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import AmbientLight
from limner.scene.material import BlinnPhong, Dielectric, Lambert, Material, MetallicRoughness
from limner.scene.node import Node
from limner.scene.procedural import Checker, Gradient, Marble, Noise, Stripes, Turbulence, Wood
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Sphere, Torus
from limner.scene.solid import Difference, Solid
from limner.scene.texture import Texels, Texture

pytestmark = SLOW_AS_PYTHON

CAMERA = PerspectiveCamera.look_at((1.6, 1.9, 3.4), (0.0, 0.35, 0.0), yfov_degrees=38)
STANDING = transform.translate(-0.9, 0.5, 0.2) @ transform.rotate_x(0.7)


def _smooth(dtype: Any, n: int = 16) -> NDArray[Any]:
    """A wavy picture that tiles, (n, n, 4), of any depth."""
    x = np.arange(n) / n * 2.0 * np.pi
    waves = 0.5 + 0.4 * np.stack([np.sin(x)[:, None] * np.cos(x), np.cos(x)[:, None] * np.cos(x), np.sin(x + x[:, None])], axis=-1)
    rgba = np.concatenate([waves, np.ones((n, n, 1))], axis=-1)
    return (rgba * np.iinfo(dtype).max).astype(dtype) if np.dtype(dtype).kind == "u" else rgba.astype(dtype)


def _picture(dtype: Any, **fields: Any) -> Texture:
    return Texture(Texels(_smooth(dtype), srgb=np.dtype(dtype).kind == "u"), **fields)


HEIGHT = Texture(Texels(_smooth(np.float32), srgb=False), scale=(3.0, 3.0))
TONES = ((0.1, 0.1, 0.3), (0.9, 0.4, 0.2), (0.9, 0.9, 0.6))

MATERIALS: dict[str, Material] = {
    "checker": Lambert(texture=Checker(TONES, scale=3.0, offset=(0.3, 0.2, 0.1))),
    "checker on uv": Lambert(texture=Checker(TONES, scale=6.0, mapping="uv")),
    "stripes": Lambert(texture=Stripes(TONES, scale=4.0, axis=(1, 2, 0), share=0.3)),
    "gradient": Lambert(texture=Gradient(TONES, wrap="mirror", scale=2.0)),
    "noise": BlinnPhong(diffuse_texture=Noise(TONES, scale=4.0, octaves=4, seed=3), specular=(0.3, 0.3, 0.3)),
    "turbulence": Lambert(texture=Turbulence(TONES, scale=3.0)),
    "marble": Lambert(texture=Marble(TONES, scale=2.0, axis=(0, 0, 1))),
    "wood": MetallicRoughness(metallic=0.0, roughness=0.4, base_color_texture=Wood(scale=5.0, axis=(1, 0, 0.2))),
    "rough by noise": MetallicRoughness(metallic_roughness_texture=Noise(scale=3.0), base_color=(0.9, 0.7, 0.4)),
    "shining checker": Lambert(emission=(1, 1, 1), emission_texture=Checker(scale=2.2)),
    "bytes": Lambert(texture=_picture(np.uint8)),
    "words": Lambert(texture=_picture(np.uint16)),
    "words, anisotropic": Lambert(texture=_picture(np.uint16, filter="anisotropic", scale=(3.0, 2.0))),
    "floats": Lambert(texture=_picture(np.float32, filter="bilinear")),
    "floats, ripmap": Lambert(texture=_picture(np.float32, filter="ripmap", scale=(3.0, 2.0))),
    "floats, nearest": Lambert(texture=_picture(np.float32, filter="nearest")),
    "tri-planar bytes": Lambert(texture=_picture(np.uint8, mapping="triplanar", scale=(2.0, 2.0))),
    "tri-planar words": Lambert(texture=_picture(np.uint16, mapping="triplanar", sharpness=8.0)),
    "bumps of noise": Lambert(bump_texture=Noise(scale=3.0, octaves=2), bump_scale=0.2),
    "bumps of a picture": BlinnPhong(bump_texture=HEIGHT, bump_scale=0.05, specular=(0.4, 0.4, 0.4)),
    "bumps of three": MetallicRoughness(bump_texture=_picture(np.uint8, mapping="triplanar"), bump_scale=0.1, metallic=0.0),
    "normal map": BlinnPhong(normal_texture=Texture(Texels(_smooth(np.uint8), srgb=False)), normal_scale=0.4),
    "holes": Lambert(alpha_texture=Checker(scale=3.3, offset=(0.1, 0.3, 0.2)), alpha_mode="mask"),
    "veil": Lambert(alpha_texture=Marble(((0.2,) * 3, (1,) * 3)), alpha_channel="g", alpha_mode="blend"),
}


def _scene(material: Material) -> Scene:
    """The exact shapes that both have, a mesh with texture coordinates, and a ring of which the rasteriser has a mesh."""
    return scene_of(
        place(Sphere(0.5), material, matrix=STANDING),
        place(Box((0.8, 0.7, 0.5)), material, matrix=transform.translate(0.5, 0.36, 0.6) @ transform.rotate_y(0.5)),
        place(primitives.uv_sphere(24, 12, 0.45), material, matrix=transform.translate(0.2, 0.5, -0.7) @ np.diag([1.2, 0.8, 1.0, 1.0])),
        place(Plane(), material),
        camera=CAMERA,
    )


@pytest.mark.parametrize("name", MATERIALS)
def test_raster_and_rays_see_the_same_texture(name):
    """Both find the same colours wherever they see the same triangle or shape, and a textured surface is not even."""
    raster, ray = seen_by_both(_scene(MATERIALS[name]), 80, 60, aovs=("instance_id", "triangle_id", "albedo", "normal"))
    inside = interior(raster.aov["instance_id"]) & interior(ray.aov["instance_id"])
    assert inside.mean() > 0.15
    differs = np.abs(raster.pixels - ray.pixels).max(axis=2) > 1.0 / 255.0
    assert not (differs & inside).any()
    assert raster.pixels[..., 1][inside].std() > 0.02


@pytest.mark.parametrize("texture", [Checker(TONES, scale=3.0, offset=(0.3, 0.2, 0.1)), Marble(TONES, scale=2.0)])
def test_a_carved_solid_shows_one_pattern(texture):
    """What the rasteriser draws as a mesh and rays see as a combination of leaves is cut from the same block."""
    hollow = Difference(Box(1.0), Solid(Sphere(0.55), transform.translate(0.4, 0.4, 0.4)))
    scene = scene_of(place(hollow, Lambert(texture=texture)), camera=CAMERA)
    raster, ray = seen_by_both(scene, 64, 48)
    inside = interior(raster.aov["instance_id"]) & interior(ray.aov["instance_id"])
    far = np.abs(raster.pixels - ray.pixels).max(axis=2) > 8.0 / 255.0
    assert (far & inside).mean() < 0.02


def test_paths_see_the_same_texture():
    """In even light that comes from everywhere a convex surface shows its albedo, textured or not."""
    scene = scene_of(
        place(Sphere(0.8), Lambert(texture=Noise(TONES, scale=4.0, octaves=3))), Node(lights=(AmbientLight(intensity=1.0),)),
        camera=PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0), yfov_degrees=30),
    )  # fmt: skip
    path = render(scene, width=24, height=24, renderer="path", samples=256)
    ray = render(scene, width=24, height=24, renderer="ray", samples=256)
    inside = (ray.pixels[..., 3] == 1.0) & interior((ray.pixels[..., 3] == 1.0).astype(np.int32))
    assert np.abs(path.pixels - ray.pixels)[inside].max() < 0.03


def test_a_pattern_moves_with_its_object():
    """The same object elsewhere, seen by a camera that went along, gives the same picture."""
    torus = Lambert(texture=Wood(scale=6.0), bump_texture=Turbulence(scale=5.0, octaves=2), bump_scale=0.02)
    turn = transform.translate(3.0, -2.0, 5.0) @ transform.rotate_y(1.1)
    lamp = lit_from((0.3, 1.0, 0.5))
    here = Scene(root=Node(children=(place(Torus(0.6, 0.25), torus), lamp)), camera=CAMERA)
    moved = Node(parent_from_node=turn, children=here.root.children)
    eye, target, up = (transform.transform_points(turn, np.array([p]))[0] for p in ((1.6, 1.9, 3.4), (0.0, 0.35, 0.0), (0.0, 1.0, 0.0)))
    there = PerspectiveCamera.look_at(eye, target, up - turn[:3, 3], yfov_degrees=38)
    a = render(here, width=64, height=48, renderer="ray", samples=1)
    b = render(Scene(root=moved, camera=there), width=64, height=48, renderer="ray", samples=1)
    assert (np.abs(a.pixels - b.pixels).max(axis=2) > 2.0 / 255.0).mean() < 0.02


def test_glass_has_tints_and_ripples():
    """A tint texture colours what is seen through glass, a bump map moves it; without both nothing changes."""
    behind = place(Plane(), Lambert(texture=Checker(scale=2.0)), matrix=transform.translate(0, 0, -1) @ transform.rotate_x(np.pi / 2))

    def seen(glass: Dielectric) -> NDArray[np.float32]:
        camera = PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0), yfov_degrees=20)
        scene = scene_of(place(Box((2, 2, 0.2)), glass), behind, camera=camera)
        return render(scene, width=32, height=32, renderer="ray", samples=1).pixels[..., :3]

    clear = seen(Dielectric())
    green = seen(Dielectric(tint_texture=Gradient(((0, 1, 0), (0, 1, 0)))))
    assert (green[..., 0] < clear[..., 0]).mean() > 0.4
    np.testing.assert_array_equal(seen(Dielectric(tint_texture=Gradient(((1, 1, 1), (1, 1, 1))))), clear)
    np.testing.assert_array_equal(seen(Dielectric(bump_texture=Noise(scale=3.0), bump_scale=0.0)).round(5), clear.round(5))
    assert np.abs(seen(Dielectric(bump_texture=Noise(scale=3.0), bump_scale=0.3)) - clear).mean() > 0.01
