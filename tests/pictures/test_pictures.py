"""Regression tests: small pictures as they were when someone last looked at them, compared byte for byte.

They prove nothing but that nothing has changed; the tests of agreement and of closed forms say that it is right. Where a picture
is meant to change, look at the new ones and keep them:

    python tests/pictures/test_pictures.py
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as Pillow

FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))

from staging import SLOW_AS_PYTHON, checkers, grid, lit_from, place, point_light_at, scene_of  # noqa: E402

from limner.image.image import Image  # noqa: E402
from limner.linear import transform  # noqa: E402
from limner.mesh.shapes import primitives  # noqa: E402
from limner.render import render  # noqa: E402
from limner.scene.camera import OrthographicCamera, PerspectiveCamera  # noqa: E402
from limner.scene.library import builtin  # noqa: E402
from limner.scene.light import AmbientLight, PointLight, SpotLight  # noqa: E402
from limner.scene.material import BlinnPhong, Lambert, MetallicRoughness  # noqa: E402
from limner.scene.node import Node  # noqa: E402
from limner.scene.scene import Scene  # noqa: E402
from limner.scene.shape import Box, Plane, Sphere  # noqa: E402

SIZE = {"width": 96, "height": 64, "samples": 4}


def _still_life() -> Scene:
    """Mirror, glass, cut-out, gloss, texture, spot and lamp."""
    glass = Lambert(color=(0.9, 0.3, 0.2), alpha=0.45, alpha_mode="blend")
    return scene_of(
        place(Plane(), Lambert(color=1, texture=checkers(2, scale=(0.8, 0.8)))),
        place(Sphere(0.55), BlinnPhong(diffuse=0.05, specular=0.6, exponent=120, mirror=(0.8, 0.8, 0.75)), at=(-0.75, 0.55, 0.0)),
        place(primitives.sphere(0.4, 10), Lambert(texture=checkers(8, alpha=0), alpha_mode="mask"), at=(0.25, 0.4, 0.75)),
        place(Box((0.7, 1.0, 0.6)), BlinnPhong(diffuse=(0.2, 0.35, 0.6), specular=0.4), matrix=_turned(0.8, 0.5, -0.4, 0.5)),
        place(grid(2, 0.6, transform.rotate_x(math.pi / 2)), glass, at=(0.9, 0.6, 0.6)),
        point_light_at((-1.2, 2.2, 1.6), PointLight(color=(1.0, 0.85, 0.7), intensity=9.0)),
        lit_from((1.5, 2.5, 1.0), SpotLight(color=(0.7, 0.8, 1.0), intensity=30.0, inner_degrees=8, outer_degrees=22)),
        Node(lights=(AmbientLight(intensity=0.12),)),
        camera=PerspectiveCamera.look_at((0.4, 1.3, 3.3), (0.05, 0.45, 0.0), yfov_degrees=38),
        background=(0.25, 0.3, 0.4),
    )


def _turned(x: float, y: float, z: float, angle: float) -> NDArray[np.float64]:
    return transform.translate(x, y, z) @ transform.rotate_y(angle)


def _metals() -> Scene:
    """Roughness from left to right, metal above, plastic below; seen in parallel, on nothing."""
    balls = [
        place(Sphere(0.42), MetallicRoughness(base_color=(0.9, 0.6, 0.3), metallic=m, roughness=r), at=(k - 1.0, m - 0.5, 0))
        for m in (0.0, 1.0)
        for k, r in enumerate((0.2, 0.5, 0.9))
    ]
    camera = OrthographicCamera.look_at((0, 0, 5), (0, 0, 0), height=2.1)
    return scene_of(*balls, lit_from((1, 2, 2)), lit_from((-2, 0.5, 1)), camera=camera)


PICTURES: dict[str, Callable[[], Image]] = {
    "teapot-raster": lambda: render(builtin("teapot"), renderer="raster", **SIZE),
    "teapot-ray": lambda: render(builtin("teapot"), renderer="ray", **SIZE),
    "cornell-ray": lambda: render(builtin("cornell"), renderer="ray", **SIZE),
    "still-life-raster": lambda: render(_still_life(), renderer="raster", **SIZE),
    "still-life-ray": lambda: render(_still_life(), renderer="ray", **SIZE),
    "metals-raster": lambda: render(_metals(), renderer="raster", **SIZE),
}


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", PICTURES)
def test_the_picture_has_not_changed(name, tmp_path):
    """On a difference its amplified picture is left beside the new one in the test's own folder."""
    seen = PICTURES[name]().to_uint8()
    with Pillow.open(FOLDER / f"{name}.png") as file:
        kept = np.asarray(file.convert("RGBA"))
    if not np.array_equal(seen, kept):
        difference = np.abs(seen.astype(int) - kept)
        evidence = np.clip(difference * 16, 0, 255).astype(np.uint8)
        evidence[..., 3] = 255
        Pillow.fromarray(evidence).save(tmp_path / f"{name}-difference-x16.png")
        Pillow.fromarray(seen).save(tmp_path / f"{name}-now.png")
        changed = int((difference > 0).any(axis=2).sum())
        pytest.fail(f"{changed} pixels changed, by up to {difference.max()}: see {tmp_path}")


if __name__ == "__main__":
    for picture, draw in PICTURES.items():
        Pillow.fromarray(draw().to_uint8()).save(FOLDER / f"{picture}.png", optimize=True)
