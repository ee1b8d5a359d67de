"""The sky as rough mirrors see it: the blur, the tabulated albedo, and both together against the path tracer."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.render import render
from limner.scene.camera import PerspectiveCamera
from limner.scene.environment import Environment
from limner.scene.material import MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Plane, Shape
from limner.shading.albedo_table import GRAZING, NODES, TOTAL
from limner.tables.layouts import BLURRED_HEIGHT, BLURRED_LEVELS, BLURRED_WIDTH
from limner.tables.sky_blur import blurred_sky


def lobe_integrals(roughness: float, n_v: float) -> tuple[float, float]:
    """The microfacet lobe over the hemisphere, by the midpoint rule in half vectors; with and without (1 - v.h)^5."""
    alpha2 = roughness**4
    n = 700
    # tan(theta) of the half vector as its distribution has it, so that the midpoints lie where the lobe is.
    u, phi = np.meshgrid((np.arange(n) + 0.5) / n, 2 * np.pi * (np.arange(n) + 0.5) / n)
    cos_h = np.sqrt((1 - u) / (1 + (alpha2 - 1) * u))
    sin_h = np.sqrt(1 - cos_h**2)
    sin_v = math.sqrt(1 - n_v**2)
    v_h = sin_v * sin_h * np.cos(phi) + n_v * cos_h
    n_l = 2 * v_h * cos_h - n_v
    seen = (v_h > 0) & (n_l > 0)
    c = np.where(seen, n_l, 1.0)
    visibility = 0.5 / (n_v * np.sqrt(c**2 * (1 - alpha2) + alpha2) + c * np.sqrt(n_v**2 * (1 - alpha2) + alpha2))
    # value cos / pdf with pdf = D n.h / (4 v.h)
    weight = np.where(seen, visibility * c * 4 * v_h / cos_h, 0.0)
    return float(weight.mean()), float((weight * (1 - np.clip(v_h, 0, 1)) ** 5).mean())


@pytest.mark.parametrize("row", [3, 6, 9, 12, 15])
@pytest.mark.parametrize("column", [2, 5, 10, 15])
def test_albedo_table(row, column):
    """Each number is the integral it claims to be, by another way of integrating."""
    total, grazing = lobe_integrals(row / (NODES - 1), column / (NODES - 1))
    assert TOTAL[row, column] == pytest.approx(total, abs=3.5e-3)
    assert GRAZING[row, column] == pytest.approx(grazing, abs=3.5e-3)


def test_albedo_table_is_a_share():
    """A mirror sends on everything, a rough one less; nothing is gained. Head on and fully rough: 1 - ln 2."""
    assert (TOTAL <= 1.0).all()
    assert (GRAZING >= 0.0).all()
    assert (GRAZING <= TOTAL).all()
    assert (TOTAL[0, 1:] > 0.999).all()
    assert TOTAL[-1, -1] == pytest.approx(1 - math.log(2), abs=1e-3)


def test_blur_keeps_an_even_sky():
    """Every average of a constant is the constant."""
    blurred = blurred_sky(np.full((32, 64, 3), 0.7, dtype=np.float32), 1)
    assert blurred.shape == (BLURRED_LEVELS * BLURRED_HEIGHT, BLURRED_WIDTH, 3)
    np.testing.assert_allclose(blurred, 0.7, rtol=1e-5)


def test_blur_is_the_mean_over_the_lobe():
    """Against the definition, for one direction of each roughness: weights D(h) n.l with n = v."""
    rng = np.random.default_rng(1)
    sky = rng.uniform(0, 2, size=(16, 32, 3)).astype(np.float32)
    blurred = blurred_sky(sky, 2)
    theta = np.pi * (np.arange(16) + 0.5) / 16
    phi = 2 * np.pi * ((np.arange(32) + 0.5) / 32 - 0.5)
    t, p = np.meshgrid(theta, phi, indexing="ij")
    d = np.stack([np.sin(t) * np.cos(p), np.cos(t), np.sin(t) * np.sin(p)], axis=-1)
    j, i = 20, 40
    t0, p0 = np.pi * (1 - (j + 0.5) / BLURRED_HEIGHT), 2 * np.pi * ((i + 0.5) / BLURRED_WIDTH - 0.5)
    n = np.array([np.sin(t0) * np.cos(p0), np.cos(t0), np.sin(t0) * np.sin(p0)])
    for level in range(BLURRED_LEVELS):
        alpha2 = ((level + 1) / BLURRED_LEVELS) ** 4
        n_l = d @ n
        weight = np.maximum(n_l, 0) * np.sin(t) / (((1 + n_l) / 2) * (alpha2 - 1) + 1) ** 2
        expected = (sky * weight[..., None]).sum(axis=(0, 1)) / weight.sum()
        np.testing.assert_allclose(blurred[level * BLURRED_HEIGHT + j, i], expected, rtol=2e-3)


@pytest.mark.compiled
@pytest.mark.parametrize("elevation_degrees", [90.0, 45.0, 20.0])
@pytest.mark.parametrize("roughness", [0.0, 0.2, 0.5, 0.8, 1.0])
def test_metal_under_an_even_sky_is_as_the_path_tracer_has_it(elevation_degrees, roughness):
    """Blur and table together are exact where the sky is even."""
    e = math.radians(elevation_degrees)
    up = (0, 0, -1) if elevation_degrees == 90.0 else (0, 1, 0)
    camera = PerspectiveCamera.look_at((0, 3 * math.sin(e), 3 * math.cos(e)), (0, 0, 0), up=up, yfov_degrees=1.0)
    metal = MetallicRoughness((0.8, 0.6, 0.4), 1.0, roughness, double_sided=True)
    scene = Scene(Node(shapes=(Shape(Plane(), (metal,)),)), camera=camera, environment=Environment((1.5, 1.5, 1.5)))
    fast = {
        name: render(scene, width=8, height=8, samples=1, renderer=name).pixels[..., :3].mean(axis=(0, 1)) for name in ("raster", "ray")
    }
    true = render(scene, width=8, height=8, samples=256, renderer="path").pixels[..., :3].mean(axis=(0, 1))
    np.testing.assert_array_equal(fast["raster"], fast["ray"])
    np.testing.assert_allclose(fast["raster"], true, rtol=0.01)
