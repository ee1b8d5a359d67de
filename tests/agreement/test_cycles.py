"""glTF's materials against Blender Cycles, where its pictures are at hand.

Cycles ignores the lights of the files and gives back what rough metals lose, so both is asked of limner, too. Beyond that the two standards
differ: Cycles scales specular at normal incidence alone, and takes a transmission without volume for solid glass, so these scenes are held
loosely. Its sheen is of another kind (microfibres): of velvet (GlamVelvetSofa) it sends back four fifths of what glTF's sheen does, of the
ToyCar's cloth two thirds in the sheen's own red, and both scenes are left out. The typical pixel and the mean of what is not overexposed
are held, since the sun in the sky is a few texels and mirrored in sparks.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from limner.files.load import load
from limner.files.open_image import open_image
from limner.render import Renderer
from limner.scene.camera import PerspectiveCamera
from limner.scene.environment import Environment
from limner.scene.material import Material, MetallicRoughness
from limner.scene.node import Node

pytestmark = pytest.mark.compiled

DATA = Path(__file__).resolve().parents[2] / ".." / "shared"
SCENES = DATA / "reference" / "cycles"


def coarser(picture: np.ndarray, k: int) -> np.ndarray:
    height, width, channels = picture.shape
    return picture.reshape(height // k, k, width // k, k, channels).mean(axis=(1, 3))


def premultiplied(pixels: np.ndarray) -> np.ndarray:
    alpha = pixels[..., 3:].astype(np.float64)
    return np.concatenate([pixels[..., :3] * alpha, alpha], axis=2)


def as_in_cycles(node: Node) -> Node:
    """The node without lights, its microfacets with all their energy."""

    def kept(material: Material) -> Material:
        return replace(material, energy_compensation=True) if isinstance(material, MetallicRoughness) else material

    shapes = tuple(replace(shape, materials=tuple(map(kept, shape.materials))) for shape in node.shapes)
    return replace(node, shapes=shapes, lights=(), children=tuple(map(as_in_cycles, node.children)))


@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
@pytest.mark.parametrize(("name", "typical", "level"), [
    ("ClearCoatTest", 0.12, 0.08), ("SpecularTest", 0.08, 0.03), ("TransmissionTest", 0.16, 0.05), ("AttenuationTest", 0.08, 0.04),
    ("MetalRoughSpheresNoTextures", 0.13, 0.04), ("NormalTangentTest", 0.08, 0.04), ("NegativeScaleTest", 0.1, 0.04), ("Duck", 0.05, 0.03),
])  # fmt: skip
def test_the_typical_pixel_and_the_level(name: str, typical: float, level: float) -> None:
    """The median difference of solid pixels, over the median of the reference; and the mean of what is cut at 1, over the reference's."""
    folder = SCENES / name
    if not folder.is_dir():
        pytest.skip("the pictures of Cycles are not at hand")
    told = json.loads((folder / "scene.json").read_text())
    camera = PerspectiveCamera.look_at(told["eye"], told["target"], told["up"], yfov_degrees=told["yfov_degrees"])
    sky = Environment(str(DATA / told["environment_folder"] / told["environment"]))
    scene = load(DATA / told["model_folder"] / told["model"]).replace(camera=camera, environment=sky)
    scene = scene.replace(root=as_in_cycles(scene.root))
    width, height = told["width"] // 4, told["height"] // 4
    with Renderer(scene, renderer="path", width=width, height=height, samples=32, max_depth=12, default_lights=False) as renderer:
        seen = premultiplied(renderer.render().pixels)
    reference = coarser(premultiplied(open_image(folder / "reference_undenoised.exr").pixels), 4)
    solid = (reference[..., 3] > 0.99) & (seen[..., 3] > 0.99)
    a, b = seen[solid, :3], reference[solid, :3]
    assert solid.mean() > 0.05
    assert np.median(np.abs(a - b)) < typical * np.median(b)
    assert np.minimum(a, 1.0).mean() == pytest.approx(np.minimum(b, 1.0).mean(), rel=level)
