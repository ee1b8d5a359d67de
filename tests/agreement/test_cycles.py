"""glTF's layered materials against Blender Cycles, where its pictures are at hand.

The two standards differ: Cycles has another sheen (microfibres), scales specular at normal incidence alone, and takes a transmission
without volume for solid glass. So scenes of these are left out or held loosely, and what is compared is the typical pixel, since the sun
in the sky is a few texels and mirrored in sparks.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from limner.files.load import load
from limner.files.open_image import open_image
from limner.render import Renderer
from limner.scene.camera import PerspectiveCamera
from limner.scene.environment import Environment

pytestmark = pytest.mark.compiled

DATA = Path(__file__).resolve().parents[2] / ".." / "shared"
SCENES = DATA / "reference" / "cycles"


def coarser(picture: np.ndarray, k: int) -> np.ndarray:
    height, width, channels = picture.shape
    return picture.reshape(height // k, k, width // k, k, channels).mean(axis=(1, 3))


def premultiplied(pixels: np.ndarray) -> np.ndarray:
    alpha = pixels[..., 3:].astype(np.float64)
    return np.concatenate([pixels[..., :3] * alpha, alpha], axis=2)


@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
@pytest.mark.parametrize(
    ("name", "typical"), [("ClearCoatTest", 0.12), ("SpecularTest", 0.08), ("TransmissionTest", 0.16), ("AttenuationTest", 0.08)]
)
def test_the_typical_pixel(name, typical):
    """The median difference of solid pixels, over the median of the reference."""
    folder = SCENES / name
    if not folder.is_dir():
        pytest.skip("the pictures of Cycles are not at hand")
    told = json.loads((folder / "scene.json").read_text())
    camera = PerspectiveCamera.look_at(told["eye"], told["target"], told["up"], yfov_degrees=told["yfov_degrees"])
    sky = Environment(str(DATA / told["environment_folder"] / told["environment"]))
    scene = load(DATA / told["model_folder"] / told["model"]).replace(camera=camera, environment=sky)
    with Renderer(scene, renderer="path", width=told["width"] // 4, height=told["height"] // 4, samples=32, max_depth=12) as renderer:
        seen = premultiplied(renderer.render().pixels)
    reference = coarser(premultiplied(open_image(folder / "reference_undenoised.exr").pixels), 4)
    solid = (reference[..., 3] > 0.99) & (seen[..., 3] > 0.99)
    a, b = seen[solid, :3], reference[solid, :3]
    assert solid.mean() > 0.05
    assert np.median(np.abs(a - b)) < typical * np.median(b)
