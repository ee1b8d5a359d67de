"""A pixel that is told has the bits of the picture; `explain_pixels.py`, beside this file, looks at hundreds."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON

from limner.explain.explain import explain


@pytest.fixture(scope="module")
def pixels() -> ModuleType:
    """The script."""
    spec = importlib.util.spec_from_file_location("explain_pixels", Path(__file__).with_name("explain_pixels.py"))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@SLOW_AS_PYTHON
@pytest.mark.parametrize(
    ("name", "renderer"),
    [("layered", "path"), ("textured", "raster"), ("solids", "ray"), ("clouds", "path"), ("instances", "raster")],
)
def test_a_pixel_told_is_the_pixel(pixels: ModuleType, name: str, renderer: str) -> None:
    """At random near the middle: traced = compiled in every sample, the story ends in the pixel, and that is the picture's."""
    scene, image = pixels.picture(name, renderer)
    rng = np.random.default_rng(sum(map(ord, name)))
    x, y = rng.integers((10, 8), (30, 24)).tolist()
    assert pixels.check_pixel(scene, image, name, renderer, x, y) == ""


@SLOW_AS_PYTHON
def test_the_story_of_a_matte_scene_is_one_of_one_path(pixels: ModuleType) -> None:
    """Its picture is made eight paths at a time; told is a path, with its weights, and it has the picture's bits."""
    scene, image = pixels.picture("cornell", "path")
    told = explain(scene, 20, 20, sample="all", **pixels.options_of("cornell", "path"))
    assert told.is_exact
    assert told.pixel.tobytes() == image.pixels[20, 20].tobytes()
    kernels = [step.kernel for step in told.story.walk()]
    assert "raytrace.path.path_radiance" in kernels
    assert any(kernel.endswith("balance") for kernel in kernels)
