"""What is told of a pixel is the pixel: the traced kernels on the picture's own tables find the bits that `render` stores."""

from __future__ import annotations

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, checkers, flat_picture, grid, lit_from, place, point_light_at, scene_of, two_triangles

from limner.explain.explain import explain
from limner.linear import transform
from limner.render import render
from limner.scene.light import SphereLight
from limner.scene.material import BlinnPhong, Dielectric, Lambert, MetallicRoughness
from limner.scene.scene import Scene
from limner.scene.shape import Plane, Sphere

WIDTH, HEIGHT = 24, 18


def _balls() -> Scene:
    """Glass, a mirror and gold over a chessboard, under a sun and a lamp."""
    return scene_of(
        place(Sphere(0.3), Dielectric(ior=1.5), at=(-0.4, 0.0, 0.0)),
        place(Sphere(0.3), BlinnPhong(diffuse=(0.2, 0.1, 0.1), mirror=(0.7, 0.7, 0.7)), at=(0.4, 0.1, 0.0)),
        place(Sphere(0.2), MetallicRoughness(base_color=(1.0, 0.8, 0.4), roughness=0.3), at=(0.0, -0.1, 0.3)),
        place(grid(2, 2.0), Lambert(texture=checkers()), at=(0.0, -0.4, 0.0)),
        lit_from((0.4, 1.0, 0.6)),
        point_light_at((0.3, 0.8, 0.5), SphereLight(intensity=20.0, radius=0.1)),
        camera=flat_picture(1.5), background=(0.2, 0.3, 0.5),
    )  # fmt: skip


def _layers() -> Scene:
    """Half transparent squares before each other, and one with holes."""
    square = two_triangles((-0.6, -0.5, 0.0), (0.6, -0.5, 0.0), (0.6, 0.5, 0.0), (-0.6, 0.5, 0.0))
    return scene_of(
        place(square, Lambert((0.9, 0.2, 0.2), alpha=0.4, alpha_mode="blend"), at=(0.1, 0.1, 0.2)),
        place(square, Lambert((0.2, 0.9, 0.2), alpha=0.6, alpha_mode="blend"), matrix=transform.rotate((0, 1, 0), 0.4)),
        place(grid(3, 0.7, transform.rotate((1, 0, 0), np.pi / 2)), Lambert(texture=checkers(alpha=0), alpha_mode="mask"), at=(0, 0, -0.3)),
        place(Plane(), Lambert((0.5, 0.5, 0.5)), at=(0.0, -0.6, 0.0)),
        camera=flat_picture(1.5),
    )  # fmt: skip


SCENES = {"balls": _balls, "layers": _layers}


PIXELS = {"balls": ((5, 9), (17, 8), (12, 12), (12, 15)), "layers": ((13, 9), (9, 11), (6, 6), (15, 7))}


@SLOW_AS_PYTHON
@pytest.mark.parametrize(
    ("name", "renderer", "samples"),
    [("balls", "raster", 8), ("layers", "raster", 3), ("balls", "ray", 2), ("layers", "path", 2), ("balls", "path", 2)],
)
def test_the_story_ends_in_the_stored_bits(name: str, renderer: str, samples: int) -> None:
    """The pixel is the picture's, and each sample that is told of has, traced, the bits that the compiled kernel added to the film."""
    scene = SCENES[name]()
    stored = render(scene, width=WIDTH, height=HEIGHT, renderer=renderer, samples=samples).pixels
    x, y = PIXELS[name][("raster", "ray", "path").index(renderer) + (samples == 3)]
    told = explain(scene, x, y, width=WIDTH, height=HEIGHT, renderer=renderer, samples=samples, sample="all")
    assert told.pixel.tobytes() == stored[y, x].tobytes()
    assert told.is_exact
    assert told.told == tuple(range(len(told.contributions)))
