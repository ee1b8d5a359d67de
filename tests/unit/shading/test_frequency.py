"""Where shading is computed: at fragments, at vertices, once a triangle (FoCG 8.2.4, 8.2.5, 10.1.3, 10.2.2); and Phong's highlight."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.errors import SceneError, UnsupportedError
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.render import render
from limner.scene.camera import OrthographicCamera
from limner.scene.light import DirectionalLight
from limner.scene.material import BlinnPhong
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape

FRONT = OrthographicCamera.look_at((0, 0, 5), (0, 0, 0), height=2.2)
GLOSS = BlinnPhong((0.3, 0.5, 0.7), (0.4, 0.4, 0.4), 20.0)


def lit(mesh: Mesh, material: BlinnPhong = GLOSS, towards: tuple[float, float, float] = (0.3, 0.4, 1.0)) -> Scene:
    sun = Node("sun", transform.frame_from_gaze((0, 0, 0), -np.array(towards), (0, 1, 0)), lights=(DirectionalLight(intensity=3.0),))
    return Scene(Node(children=(Node(shapes=(Shape(mesh, (material,)),)), sun)), camera=FRONT)


def inner_pixels(shading: str, mesh: Mesh) -> list[tuple[np.ndarray, np.ndarray]]:
    """(columns and rows, colours) of each triangle's pixels that have only its own around them."""
    image = render(lit(mesh), width=64, height=64, samples=1, shading=shading, aovs=("triangle_id",))
    ids = image.aov["triangle_id"]
    inner = np.ones_like(ids, dtype=bool)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            inner &= np.roll(ids, (dy, dx), axis=(0, 1)) == ids
    found = []
    for triangle in np.unique(ids[inner & (ids >= 0)]):
        y, x = np.nonzero(inner & (ids == triangle))
        if len(x) >= 6:
            found.append((np.stack([x, y], axis=1), image.pixels[y, x, :3].astype(np.float64)))
    assert len(found) > 5
    return found


def test_flat_is_one_colour_a_triangle():
    """And its neighbours' are others."""
    colours = [np.unique(c, axis=0) for _, c in inner_pixels("flat", primitives.sphere(1.0, 6))]
    assert all(len(c) == 1 for c in colours)
    assert len({tuple(c[0]) for c in colours}) > len(colours) / 3


def test_gouraud_is_affine_over_a_triangle():
    """Seen in parallel, colours interpolated from the vertices are an affine function of the pixel; those of fragments are not."""

    def worst(shading: str) -> float:
        left = 0.0
        for places, colours in inner_pixels(shading, primitives.sphere(1.0, 6)):
            plane = np.c_[places, np.ones(len(places))]
            fit, *_ = np.linalg.lstsq(plane, colours, rcond=None)
            left = max(left, float(np.abs(plane @ fit - colours).max()))
        return left

    assert worst("vertex") < 1e-5
    assert worst("fragment") > 1e-2


def test_gouraud_meets_the_fragments_at_the_vertices():
    """The finer the mesh, the nearer both come: interpolation is all that differs."""
    differences = []
    for bands in (8, 16, 32):
        scene = lit(primitives.sphere(1.0, bands))
        pictures = [render(scene, width=48, height=48, samples=1, shading=s).pixels for s in ("vertex", "fragment")]
        differences.append(float(np.abs(pictures[0] - pictures[1]).mean()))
    assert differences[0] > 2.0 * differences[1] > 4.0 * differences[2]


@pytest.mark.parametrize("renderer", ["raster", "ray", "path"])
@pytest.mark.parametrize("normalized", [False, True])
def test_phong_highlight(renderer, normalized):
    """kd/pi E n.l + c_p/pi E (r.e)^p on a plane seen head on, where r.e = n.l (FoCG 10.2.1)."""
    kd, cp, p, lux = np.array([0.3, 0.5, 0.7]), 0.4, 20.0, 3.0
    towards = np.array([0.2, 0.3, 1.0])
    n_l = towards[2] / np.linalg.norm(towards)
    square = primitives.quad([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]])
    material = BlinnPhong(tuple(kd), (cp,) * 3, p, highlight="phong", normalized=normalized)
    image = render(lit(square, material, tuple(towards)), width=8, height=8, samples=4, renderer=renderer, max_depth=1)
    scale = (p + 1) / 2 if normalized else 1.0
    expected = lux / math.pi * (kd * n_l + cp * scale * n_l**p)
    np.testing.assert_allclose(image.pixels[4, 4, :3], expected, rtol=2e-5)


def test_unknown_words_are_named():
    """One line each, with what is known."""
    with pytest.raises(UnsupportedError, match="shading must be one of fragment, vertex, flat"):
        render(lit(primitives.sphere(1.0, 4)), width=8, height=8, shading="gouraud")
    with pytest.raises(SceneError, match="highlight"):
        BlinnPhong(highlight="ward")
