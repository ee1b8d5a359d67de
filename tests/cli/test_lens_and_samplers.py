"""The command line's words for lens, samplers and glossy mirrors (FoCG 13.4)."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from limner.files.open_image import open_image

pytestmark = pytest.mark.compiled

SMALL = ("--width", "32", "--height", "24", "--samples", "4", "--quiet")


def test_a_lens_blurs_and_the_recipe_remembers_it(limner_process: Callable[..., Any], tmp_path) -> None:
    """In focus at the middle of the model unless said; the picture can be made again."""
    for name, words in (("sharp", ()), ("lens", ("--aperture", "0.3")), ("near", ("--aperture", "0.3", "--focus", "2"))):
        done = limner_process("render", "teapot", "-o", f"{name}.png", "--renderer", "ray", *SMALL, *words)
        assert done.returncode == 0, done.stderr
    pictures = {name: open_image(tmp_path / f"{name}.png") for name in ("sharp", "lens", "near")}
    camera = pictures["near"].recipe["camera"]
    assert (camera["aperture_radius"], camera["focus_distance"]) == (0.3, 2.0)
    assert 4.0 < pictures["lens"].recipe["camera"]["focus_distance"] < 8.0
    off = {name: float(np.abs(image.pixels - pictures["sharp"].pixels).mean()) for name, image in pictures.items()}
    assert off["near"] > off["lens"] > 0.0
    assert limner_process("verify", "near.png").returncode == 0


def test_samplers_and_flags_reach_the_renderer(limner_process: Callable[..., Any]) -> None:
    words = ("render", "cornell", "-o", "a.png", "--renderer", "ray", *SMALL, "--sampler", "halton", "--glossy", "--emitters", "--json")
    done = limner_process(*words)
    assert done.returncode == 0, done.stderr
    recipe = json.loads(done.stdout)["recipe"]
    assert (recipe["sampler"], recipe["glossy"], recipe["emitters"]) == ("halton", True, True)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--sampler", "poisson"), "poisson"), (("--aperture", "-1"), "-1"), (("--focus", "0"), "0"),
        (("--renderer", "raster", "--sampler", "sobol"), "raster has one pattern"),
    ],
)  # fmt: skip
def test_what_cannot_be(limner_process: Callable[..., Any], words: tuple[str, ...], said: str) -> None:
    done = limner_process("render", "teapot", "-o", "a.png", *words)
    assert done.returncode == 2
    assert said in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
