"""Light in parts: direct and indirect, and light by light, add up to the picture; and what else lies beside a path traced picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from staging import SLOW_AS_PYTHON, grid, place, point_light_at, scene_of

from limner.errors import LimnerError
from limner.files.open_image import open_image
from limner.image.image import Image
from limner.render import Renderer, render
from limner.scene.camera import PerspectiveCamera
from limner.scene.environment import Environment
from limner.scene.light import AmbientLight, PointLight, RectangleLight
from limner.scene.material import BlinnPhong, Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Sphere

pytestmark = SLOW_AS_PYTHON

PARTS = ("direct", "indirect", "light_groups")


def _stage() -> Scene:
    """All kinds of light at once: a named and a nameless point, a lamp, a shining box, ambient light and a sky."""
    mirror = BlinnPhong((0.1, 0.1, 0.1), mirror=(0.8, 0.8, 0.8), name="mirror")
    scene = scene_of(
        place(grid(2, 4.0), Lambert((0.7, 0.5, 0.3))),
        place(Sphere(0.6), mirror, at=(0.8, 0.6, 0.0)),
        place(Box((0.4, 0.4, 0.4)), Lambert((0.0, 0.0, 0.0), emission=(0.2, 2.0, 0.4), name="neon"), at=(-0.9, 0.3, 0.6)),
        point_light_at((2.0, 3.0, 2.0), PointLight(intensity=9.0, name="key")),
        point_light_at((-2.0, 2.0, 2.0), PointLight(color=(1.0, 0.3, 0.2), intensity=5.0)),
        point_light_at((0.0, 1.5, 1.5), RectangleLight(intensity=4.0, width=0.5, height=0.5, name="soft box")),
        Node(lights=(AmbientLight(intensity=0.1, name="fill"),)),
        camera=PerspectiveCamera.look_at((0, 1.5, 5), (0, 0.6, 0), yfov_degrees=35),
    )
    return scene.replace(environment=Environment((0.05, 0.08, 0.2)), background="environment")


@pytest.fixture(scope="module")
def picture() -> Image:
    """A picture with its parts."""
    return render(_stage(), width=24, height=18, renderer="path", samples=8, aovs=(*PARTS, "variance", "samples"), threads=1)


def _light(picture: Image) -> dict[str, np.ndarray]:
    return {name: values for name, values in picture.aov.items() if name.startswith("light_")}


def test_groups_are_named_as_lights_and_materials_are(picture: Image) -> None:
    """Lights first; a name is made fit for a layer's."""
    assert list(_light(picture)) == ["light_key", "light_light", "light_soft_box", "light_fill", "light_neon", "light_sky"]


def test_parts_add_up_to_the_picture(picture: Image) -> None:
    """Pixel by pixel, noise and all: the parts have the very paths of the whole."""
    color = picture.pixels[..., :3]
    np.testing.assert_allclose(sum(_light(picture).values()), color, rtol=1e-4, atol=1e-5)
    np.testing.assert_allclose(picture.aov["direct"] + picture.aov["indirect"], color, rtol=1e-5, atol=1e-6)
    assert all(values.min() >= -1e-6 for name, values in picture.aov.items() if name in PARTS or name.startswith("light_"))
    assert all(values.max() > 1e-3 for values in _light(picture).values())


def test_asking_for_parts_changes_no_bit(picture: Image) -> None:
    """The picture is the one that is made without."""
    alone = render(_stage(), width=24, height=18, renderer="path", samples=8, threads=1)
    assert (alone.pixels == picture.pixels).all()


def test_a_group_is_the_picture_of_its_light_alone() -> None:
    """Another scene with that light and no other: the same mean light, within the noise of both."""
    scene = scene_of(
        place(grid(2, 4.0), Lambert((0.6, 0.6, 0.6))),
        point_light_at((0.0, 2.0, 0.0), PointLight(intensity=5.0, name="a")),
        point_light_at((1.0, 2.0, 1.0), PointLight(color=(0.0, 1.0, 0.0), intensity=5.0, name="b")),
        camera=PerspectiveCamera.look_at((0, 3, 4), (0, 0, 0)),
    )
    lamp = scene_of(*scene.root.children[:2], camera=scene.camera)
    how = {"width": 12, "height": 8, "renderer": "path", "samples": 4, "threads": 1}
    part = render(scene, aovs=("light_groups",), **how).aov["light_a"]
    np.testing.assert_allclose(part, render(lamp, **how).pixels[..., :3], rtol=1e-4, atol=1e-6)


def test_variance_foretells_the_error() -> None:
    """Of many pictures by independent samples, the mean of what each says of its variance is that of their differences, within a fourth."""
    def made(seed: int) -> Image:
        how = {"renderer": "path", "samples": 16, "sampler": "random", "seed": seed, "threads": 1, "aovs": ("variance", "samples")}
        return render("cornell", width=16, height=16, **how)

    pictures = [made(seed) for seed in range(12)]
    pixels = np.stack([image.pixels[..., :3] for image in pictures]).astype(np.float64)
    told = np.stack([image.aov["variance"] for image in pictures]).mean()
    assert told == pytest.approx(pixels.var(axis=0, ddof=1).mean(), rel=0.25)
    assert (pictures[0].aov["samples"] == 16).all()
    assert pictures[0].aov["samples"].dtype == np.int32


def test_blocks_that_end_early_have_parts_of_as_many_samples() -> None:
    """Where noise decides, some blocks take fewer samples than others: `samples` says how many, and the parts have the same."""
    picture = render(
        "cornell", width=32, height=32, renderer="path", noise=0.15, samples=64, threads=1, aovs=("samples", "variance", "light_groups")
    )
    samples = picture.aov["samples"]
    assert 8 <= samples.min() < samples.max() <= 64
    np.testing.assert_allclose(sum(_light(picture).values()), picture.pixels[..., :3], rtol=1e-4, atol=1e-5)
    assert picture.aov["variance"].max() > 0.0


def test_features_follow_mirrors() -> None:
    """In a mirror the paint and the way are those of what is seen in it; nothing is seen in the sky."""
    red = place(grid(2, 50.0, np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 4.0], [0, 0, 0, 1]])), Lambert((0.8, 0.1, 0.1)))
    mirror = place(grid(2, 1.0, np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])),
                   BlinnPhong((0.0, 0.0, 0.0), mirror=(0.5, 0.5, 0.5)))  # fmt: skip
    scene = scene_of(red, mirror, camera=PerspectiveCamera.look_at((0, 0, 2), (0, 0, 0), yfov_degrees=90))
    beside = render(
        scene, width=9, height=9, renderer="path", samples=4, threads=1, aovs=("denoising_albedo", "denoising_normal", "denoising_depth")
    ).aov
    middle = 4, 4
    assert beside["denoising_albedo"][middle] == pytest.approx([0.4, 0.05, 0.05], abs=1e-5)
    assert beside["denoising_depth"][middle] == pytest.approx(2.0 + 4.0, rel=0.02)
    assert np.linalg.norm(beside["denoising_normal"][middle]) == pytest.approx(1.0, abs=1e-5)
    assert beside["denoising_depth"][0, 0] == np.inf
    assert (beside["denoising_albedo"][0, 0] == 0.0).all()


def test_denoising_brings_a_picture_nearer_to_the_converged_one() -> None:
    """The Cornell box with 16 paths a pixel: the mean squared error, relative, falls to less than half."""
    how = {"width": 40, "height": 40, "renderer": "path", "threads": 1}
    noisy = render("cornell", samples=16, **how)
    clean = render("cornell", samples=16, denoise="filter", **how)
    converged = render("cornell", samples=400, seed=1, **how).pixels[..., :3]

    def error(image: Image) -> float:
        return float(((image.pixels[..., :3] - converged) ** 2 / (converged**2 + 0.01)).mean())

    assert error(clean) < error(noisy) / 2.0
    assert clean.recipe["denoise"] == "filter"
    assert not clean.aov
    with Renderer("cornell", samples=16, denoise="filter", **how) as renderer:
        assert (renderer.render(output="uint8") == clean.to_uint8()).all()


def test_compositors_find_the_layers(tmp_path: Path, picture: Image) -> None:
    """Parts of the light are R, G, B and premultiplied as the picture is, so that they add up there, too; they come back straight."""
    pixels = picture.pixels.copy()
    pixels[:4, :, 3] = 0.5
    image = Image(pixels, aov=picture.aov)
    image.save(tmp_path / "a.exr")
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    assert {"direct.R", "indirect.G", "light_key.B", "light_soft_box.R", "variance.R", "samples.X"} <= set(channels)
    total = sum(values for name, values in channels.items() if name.startswith("light_") and name.endswith(".G"))
    np.testing.assert_allclose(total, channels["G"], rtol=1e-4, atol=1e-5)
    read = open_image(tmp_path / "a.exr")
    np.testing.assert_allclose(read.aov["light_key"], image.aov["light_key"], rtol=1e-6)
    assert read.aov["samples"].dtype == np.int32


@pytest.mark.parametrize(
    "how",
    [
        {"renderer": "raster", "aovs": ("variance",)},
        {"renderer": "raster", "aovs": ("denoising_albedo",)},
        {"renderer": "raster", "denoise": "filter"},
        {"renderer": "ray", "aovs": ("light_groups",)},
        {"renderer": "path", "aovs": ("variance",), "samples": 1},
        {"renderer": "path", "denoise": "median"},
    ],
)
def test_what_a_renderer_does_not_have_is_refused(how: dict) -> None:
    """Before anything is drawn, in one line."""
    with pytest.raises(LimnerError) as raised:
        Renderer("cornell", width=8, height=8, **how)
    assert "\n" not in str(raised.value)
