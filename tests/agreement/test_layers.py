"""Layered materials in all three renderers, and against what can be computed by hand."""

from __future__ import annotations

import numpy as np
import pytest

from limner.mesh.shapes import primitives
from limner.render import Renderer
from limner.scene.camera import PerspectiveCamera
from limner.scene.environment import Environment
from limner.scene.light import DirectionalLight
from limner.scene.material import Dielectric, Lambert, Material, MetallicRoughness
from limner.scene.material_extensions import (
    Anisotropy,
    Clearcoat,
    Conductor,
    DiffuseTransmission,
    Iridescence,
    Sheen,
    Specular,
    Transmission,
    Volume,
)  # fmt: skip
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape, Sphere

pytestmark = pytest.mark.compiled

CAMERA = PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0), yfov_degrees=24.0)
BALL = primitives.sphere(1.0, 32)


def picture(renderer: str, material: Material, *, sky: float | None = 1.0, sun: float = 0.0, geometry=BALL, **fields) -> np.ndarray:
    """Radiance and alpha of a ball that fills most of the picture."""
    lights = (Node(lights=(DirectionalLight(intensity=sun),)),) if sun else ()
    scene = Scene(
        Node(shapes=(Shape(geometry, (material,)),), children=lights),
        camera=CAMERA,
        environment=None if sky is None else Environment((sky,) * 3),
        background="environment" if sky is not None else None,
    )
    with Renderer(scene, renderer=renderer, width=20, height=20, default_lights=False, **fields) as r:
        return r.render().pixels.astype(np.float64)


def dull(**layers) -> MetallicRoughness:
    return MetallicRoughness((0.7, 0.4, 0.2), metallic=0.0, roughness=0.6, **layers)


LAYERS = {
    "specular": dull(ior=1.9, specular=Specular(0.7, (1.0, 0.8, 0.4))),
    "coat": dull(clearcoat=Clearcoat(0.8, 0.4)),
    "sheen": dull(sheen=Sheen((0.9, 0.6, 0.8), 0.5)),
    "film": dull(iridescence=Iridescence()),
    "brushed": MetallicRoughness((0.8, 0.7, 0.6), roughness=0.5, anisotropy=Anisotropy(0.7)),
    "gold": MetallicRoughness(roughness=0.6, conductor=Conductor.named("gold"), energy_compensation=True),
    "leaf": dull(diffuse_transmission=DiffuseTransmission(0.5, (0.5, 0.8, 0.2))),
    "plaster": Lambert((0.7, 0.6, 0.5), roughness_degrees=30.0),
}


@pytest.mark.parametrize("name", LAYERS)
def test_raster_and_rays_shade_alike(name):
    """One sample in the middle of each pixel, under the sun and the sky: within 1/255 of each other inside the outline."""
    drawn, traced = (picture(r, LAYERS[name], sky=0.5, sun=1.5, samples=1, **f) for r, f in (("raster", {}), ("ray", {"shadows": False})))
    inside = np.s_[6:14, 6:14, :3]
    np.testing.assert_allclose(drawn[inside], traced[inside], atol=1 / 255)


def test_white_furnace_of_glass():
    """Glass that absorbs nothing sends on all of an even sky: thin, or as a solid, or as one that disperses."""
    clear = {"base_color": (1.0, 1.0, 1.0), "metallic": 0.0, "roughness": 0.0}
    for more in ({"transmission": Transmission()}, {"transmission": Transmission(), "volume": Volume(1.0), "dispersion": 3.0}):
        seen = picture("path", MetallicRoughness(**clear, **more), geometry=Sphere(1.0), samples=64, max_depth=30)
        np.testing.assert_allclose(seen[6:14, 6:14, :3].mean(axis=(0, 1)), 1.0, atol=0.01)


def test_plaster_under_an_even_sky():
    """What a rough matte ball sends on is known in closed form, so raster has it as path does."""
    drawn, traced = (picture(r, LAYERS["plaster"], samples=n, geometry=Sphere(1.0)) for r, n in (("raster", 1), ("path", 256)))
    np.testing.assert_allclose(drawn[6:14, 6:14, :3].mean(axis=(0, 1)), traced[6:14, 6:14, :3].mean(axis=(0, 1)), rtol=0.02)


FROSTED = {
    "dielectric": lambda roughness, ior, kept: Dielectric(ior, roughness=roughness, energy_compensation=kept),
    "solid": lambda roughness, ior, kept: MetallicRoughness(
        metallic=0.0, roughness=roughness, ior=ior, transmission=Transmission(), volume=Volume(1.0), energy_compensation=kept
    ),
    "sheet": lambda roughness, ior, kept: MetallicRoughness(
        metallic=0.0, roughness=roughness, ior=ior, transmission=Transmission(), energy_compensation=kept, double_sided=True
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", FROSTED)
def test_white_furnace_of_rough_glass(kind):
    """With compensation glass of any roughness and index vanishes before an even sky; without, the roughest loses half."""
    # What solids lose comes back exactly; sheets send some of it aside, by lot.
    many = 2048 if kind == "sheet" else 128
    for roughness, ior, samples in ((0.1, 2.0, 32), (0.5, 1.5, 64), (1.0, 1.1, many), (1.0, 2.0, many)):
        seen = picture("path", FROSTED[kind](roughness, ior, True), geometry=Sphere(1.0), samples=samples, max_depth=200)
        assert seen[6:14, 6:14, :3].mean() == pytest.approx(1.0, abs=0.01)
    lossy = picture("path", FROSTED[kind](1.0, 1.5, False), geometry=Sphere(1.0), samples=16, max_depth=200)
    assert lossy[6:14, 6:14, :3].mean() < 0.5


def test_white_furnace_of_a_metal_on_a_path():
    """With compensation a rough metal that reflects everything vanishes before an even sky; without, it loses a third."""
    lossy, kept = (
        picture("path", MetallicRoughness(roughness=1.0, energy_compensation=c), geometry=Sphere(1.0), samples=256)[6:14, 6:14, :3].mean()
        for c in (False, True)
    )
    assert kept == pytest.approx(1.0, abs=0.01)
    assert lossy < 0.7


def test_what_a_solid_absorbs():
    """Seen through the middle of a ball of index 1, white light has the attenuation colour to the power of way over distance."""
    material = MetallicRoughness(
        (1.0, 1.0, 1.0), metallic=0.0, roughness=0.0, ior=1.0, transmission=Transmission(), volume=Volume(1.0, None, 1.0, (0.9, 0.5, 0.25))
    )
    for renderer in ("ray", "path"):
        seen = picture(renderer, material, geometry=Sphere(1.0), samples=16)[9:11, 9:11, :3].mean(axis=(0, 1))
        np.testing.assert_allclose(seen, np.array([0.9, 0.5, 0.25]) ** 2, rtol=0.02)


def test_a_thin_sheet_is_looked_through():
    """A polished sheet is no lens: what is behind is seen straight on, tinted twice by a hollow ball."""
    polished = MetallicRoughness(
        (0.9, 0.5, 0.25), metallic=0.0, roughness=0.0, ior=1.0, transmission=Transmission(), double_sided=True
    )
    expected = np.array([0.9, 0.5, 0.25]) ** 2
    for renderer in ("ray", "path"):
        seen = picture(renderer, polished, geometry=Sphere(1.0), samples=16)[8:12, 8:12, :3].mean(axis=(0, 1))
        np.testing.assert_allclose(seen, expected, rtol=0.03)
