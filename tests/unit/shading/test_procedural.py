"""Patterns against closed forms: noise on its lattice, its slopes, statistics; checkers and stripes against integrals; lanes and bits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from compiled import door_of, over
from numpy.typing import NDArray

from limner._door import Array
from limner._jit import MODE, kernel
from limner.errors import SceneError
from limner.kernel.lanes import load8, store8
from limner.kernel.vec import Vec3
from limner.scene.material import Lambert
from limner.scene.procedural import Checker, Gradient, Marble, Noise, Pattern, Stripes, Turbulence, Wood
from limner.shading.noise import MEAN_MAGNITUDE, gradient_noise, summed_octaves
from limner.shading.procedural import filtered_checker, filtered_stripe, pattern_color
from limner.tables.layouts import TEXTURE
from limner.tables.textures import texture_tables

PATTERNS = [
    Checker(scale=3.0), Stripes(scale=2.0, axis=(1, 1, 1), share=0.3), Gradient(wrap="mirror"), Gradient(wrap="repeat", scale=3.0),
    Noise(octaves=3, seed=5, scale=(2.0, 3.0, 4.0)), Turbulence(octaves=3), Marble(octaves=3, seed=-4), Wood(octaves=2, axis=(0, 0, 1)),
]  # fmt: skip


def _points(n: int, size: float = 20.0, seed: int = 1) -> NDArray[np.float32]:
    return np.random.default_rng(seed).uniform(-size, size, (n, 3)).astype(np.float32)


def _color_of_one(textures, rows, out):
    for k in range(rows.shape[1]):
        r = rows[:, k]
        c, a = pattern_color(textures[0], Vec3(r[0], r[1], r[2]), Vec3(r[3], r[4], r[5]), Vec3(r[6], r[7], r[8]))
        out[0, k], out[1, k], out[2, k], out[3, k] = c.r, c.g, c.b, a


def _color_of_eight(textures, rows, out):
    for k in range(0, rows.shape[1], 8):
        p = Vec3(load8(rows[0], k), load8(rows[1], k), load8(rows[2], k))
        dpdx = Vec3(load8(rows[3], k), load8(rows[4], k), load8(rows[5], k))
        dpdy = Vec3(load8(rows[6], k), load8(rows[7], k), load8(rows[8], k))
        c, a = pattern_color(textures[0], p, dpdx, dpdy)
        store8(out[0], k, c.r)
        store8(out[1], k, c.g)
        store8(out[2], k, c.b)
        store8(out[3], k, a)


_SIGNATURE = (Array(TEXTURE, 1), Array(np.float32, 2), Array(np.float32, 2))


def _colors(pattern: Pattern, p: Any, dx: Any = 0.0, dy: Any = 0.0, entry: Any = _color_of_one) -> NDArray[np.float32]:
    """(n, 4) of a pattern at (n, 3) places that change by dx and dy from pixel to pixel."""
    p = np.asarray(p, np.float32)
    rows = np.concatenate([p, np.broadcast_to(dx, p.shape), np.broadcast_to(dy, p.shape)], axis=1).T.astype(np.float32)
    out = np.zeros((4, len(p)), np.float32)
    door_of(entry, *_SIGNATURE)(texture_tables([pattern])[0], np.ascontiguousarray(rows), out)
    return out.T


# --- noise ------------------------------------------------------------------------------------------------------------------


def test_noise_vanishes_on_its_lattice():
    """At every point with whole coordinates, whatever the seed: exactly 0."""
    lattice = np.round(_points(60))
    assert not over(gradient_noise, lattice, 0).any()
    assert not over(gradient_noise, lattice, -77).any()


def test_noise_and_its_slopes_have_no_jumps():
    """Across a face of the lattice value, slope and bend go over into each other: differences from both sides agree."""
    face = _points(40)
    face[:, 0] = np.round(face[:, 0])
    h = 1.0 / 64.0
    at = {k: over(gradient_noise, face + np.float32([k * h, 0, 0]), 3).astype(np.float64) for k in range(-3, 4)}
    left, right = (at[0] - at[-1]) / h, (at[1] - at[0]) / h
    np.testing.assert_allclose(left, right, atol=2.0 * h)
    bend_left, bend_right = (at[-1] - 2 * at[-2] + at[-3]) / h**2, (at[3] - 2 * at[2] + at[1]) / h**2
    np.testing.assert_allclose(bend_left, bend_right, atol=60.0 * h * 4)


def test_noise_has_the_statistics_of_its_formula():
    """Mean 0 and E n^2 = 16 A^2 B for gradients to the middles of a cube's edges (Perlin 2002), and the mean magnitude that is used."""
    n = 200000 if MODE == "compiled" else 1200
    found = over(gradient_noise, _points(n, 400.0), 11).astype(np.float64)
    t = (np.arange(2000) + 0.5) / 2000
    weight = (1.0 - t**3 * (t * (6.0 * t - 15.0) + 10.0)) ** 2
    variance = 16.0 * weight.mean() ** 2 * (weight * t**2).mean()
    error = 4.0 / math.sqrt(n)
    assert abs(found.mean()) < error * math.sqrt(variance)
    assert found.var() == pytest.approx(variance, rel=1.5 * error)
    assert np.abs(found).mean() == pytest.approx(float(MEAN_MAGNITUDE), rel=error)
    assert np.abs(found).max() <= 1.04


def test_seeds_and_neighbours_are_independent():
    """Correlation below what chance leaves: between seeds, and between places some cells apart, along every axis."""
    p = _points(1200, 300.0)
    a = over(gradient_noise, p, 1)
    for other in (over(gradient_noise, p, 2), *(over(gradient_noise, p + np.float32(step), 1) for step in np.eye(3) * 256.0)):
        assert abs(np.corrcoef(a, other)[0, 1]) < 4.5 / math.sqrt(len(p))


def test_turbulence_is_the_sum_of_the_book():
    """sum |n(2^k p)| / 2^k with a new seed for each octave; noise the same without magnitudes."""
    p = _points(50)
    octaves = [over(gradient_noise, p * np.float32(2**k), 4 + k) for k in range(3)]
    summed = sum(np.abs(n) / 2**k for k, n in enumerate(octaves))
    np.testing.assert_allclose(over(_summed, p, 0.0, 1), summed, atol=1e-6)
    np.testing.assert_allclose(over(_summed, p, 0.0, 0), sum(n / 2**k for k, n in enumerate(octaves)), atol=1e-6)


@kernel
def _summed(p: Vec3, width: np.float32, creased: int) -> np.float32:
    return summed_octaves(p, width, 3, np.float32(0.5), np.float32(2.0), 4, creased != 0)


def test_octaves_that_are_too_fine_are_left_out():
    """A pixel a cell wide sees the mean: 0, or that of |n| for each octave; one that is 0.3 cells wide sees the first octave alone."""
    p = _points(20)
    assert not over(_summed, p, 1.0, 0).any()
    np.testing.assert_allclose(over(_summed, p, 1.0, 1), MEAN_MAGNITUDE * 1.75, rtol=1e-6)
    np.testing.assert_array_equal(over(_summed, p, 0.5, 0), over(gradient_noise, p, 4))


# --- checkers and stripes ---------------------------------------------------------------------------------------------------


def test_checker_is_exact():
    """Without a footprint: the parity of the cells' sum, exactly 0 or 1."""
    p = _points(300)
    np.testing.assert_array_equal(over(filtered_checker, p, np.zeros(3)), np.floor(p).sum(axis=1) % 2)


@pytest.mark.parametrize("width", [0.01, 0.4, 0.99, 1.0, 1.7, 2.0, 5.3])
def test_checker_is_the_mean_over_a_box(width):
    """The closed form is the mean over many points of the box."""
    p = _points(12, 6.0)
    n = 24
    offsets = ((np.arange(n) + 0.5) / n - 0.5) * width
    signs = [np.where(np.floor(p[:, c, None] + offsets) % 2 == 0, 1.0, -1.0).mean(axis=1) for c in range(3)]
    np.testing.assert_allclose(over(filtered_checker, p, np.full(3, width)), 0.5 - 0.5 * np.prod(signs, axis=0), atol=3.5 / n)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 1.0])
def test_stripes_are_the_mean_over_a_pixel(share):
    """Of every unit the last `share` is striped, and a pixel shows the part that it covers."""
    x = np.linspace(-3.1, 3.1, 41).astype(np.float32)
    for width in (0.0, 0.2, 1.0, 2.6):
        n = 400
        samples = x[:, None].astype(np.float64) + ((np.arange(n) + 0.5) / n - 0.5) * width
        exact = ((samples % 1.0) >= 1.0 - share).mean(axis=1)
        np.testing.assert_allclose(over(filtered_stripe, x, width, share), exact, atol=2.1 / n + 1e-5)


# --- colours ----------------------------------------------------------------------------------------------------------------


def test_a_ramp_runs_through_its_stops():
    """At each position the colour, between them their mixture, outside the ends; two stops in one place are a step."""
    colors = ((0, 0, 1, 0.5), (0, 1, 0), (1, 0, 0), (1, 1, 1))
    ramp = Gradient(colors, positions=(0.2, 0.5, 0.5, 0.9))
    seen = _colors(ramp, [[x, 7.0, 9.0] for x in (0.0, 0.2, 0.35, 0.5, 0.501, 0.7, 0.95)])
    expected = [[0, 0, 1, 0.5], [0, 0, 1, 0.5], [0, 0.5, 0.5, 0.75], [0, 1, 0, 1], [1, 0.0025, 0.0025, 1], [1, 0.5, 0.5, 1], [1, 1, 1, 1]]
    np.testing.assert_allclose(seen, expected, atol=2e-4)


def test_axis_and_scale_turn_the_pattern():
    """A gradient along an axis is its dot product with the scaled place; rings are round about theirs."""
    p = _points(30, 1.0)
    axis = np.array([1.0, 2.0, -2.0]) / 3.0
    seen = _colors(Gradient(axis=(1, 2, -2), scale=(0.1, 0.2, 0.3), offset=(0.5, 0, 0)), p)[:, 0]
    np.testing.assert_allclose(seen, np.clip((p * [0.1, 0.2, 0.3]) @ axis + 0.5, 0, 1), atol=1e-6)
    radius = np.linalg.norm(np.cross(p.astype(np.float64), axis), axis=1)
    rings = _colors(Wood(((0, 0, 0), (1, 1, 1)), axis=(1, 2, -2), amount=0.0), p)[:, 0]
    np.testing.assert_allclose(rings, 0.5 - 0.5 * np.cos(2 * np.pi * radius), atol=1e-5)
    waves = _colors(Marble(amount=0.0, axis=(-1, 0, 0)), p)[:, 0]
    np.testing.assert_allclose(waves, 0.5 - 0.5 * np.sin(2 * np.pi * p[:, 0]), atol=1e-5)


def test_waves_are_damped_as_by_a_box():
    """sin(pi w) / (pi w) of a wave is left."""
    p = _points(20, 1.0)
    seen = _colors(Marble(amount=0.0), p, dx=(0.7, 0.0, 0.0))[:, 0]
    damping = math.sin(0.7 * math.pi) / (0.7 * math.pi)
    np.testing.assert_allclose(seen, 0.5 + 0.5 * damping * np.sin(2 * np.pi * p[:, 0]), atol=1e-5)


@pytest.mark.parametrize("pattern", PATTERNS, ids=lambda p: type(p).__name__)
def test_eight_lanes_are_eight_numbers(pattern):
    """To the bit, with footprints and without, also for what is no number."""
    p = _points(40, 5.0)
    p[:4] = [[np.nan, 0, 0], [np.inf, 1, 1], [3e9, -3e9, 0], [-0.0, 0.0, 1.0]]
    with np.errstate(invalid="ignore", over="ignore"):
        for dx in (0.0, (0.21, 0.05, 0.3)):
            one, eight = _colors(pattern, p, dx, 0.1), _colors(pattern, p, dx, 0.1, _color_of_eight)
            np.testing.assert_array_equal(one.view(np.int32), eight.view(np.int32))
            assert np.isfinite(one[4:]).all()


def test_patterns_are_the_same_on_every_machine():
    """Compiled or not: these numbers, to the bit."""
    seen = [_colors(pattern, [[0.3, 1.7, -2.2]], 0.01, 0.02)[0, 0].tobytes()[::-1].hex() for pattern in PATTERNS]
    assert seen == FINGERPRINTS


FINGERPRINTS = ["00000000", "3f800000", "3e99999a", "3f666667", "3f01e497", "3e9f0900", "3ddc1cbc", "3e873e54"]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Checker(((1, 1, 1),)), "checker.colors must hold 2 to 8 colours, got 1"),
        (lambda: Noise(((1, 1), (1, 1, 1))), "noise.colors must be three numbers >= 0 each"),
        (lambda: Gradient(positions=(1, 0)), "gradient.positions must be 2 numbers in rising order"),
        (lambda: Wood(scale=(1, 0, 1)), "wood.scale must not be zero"),
        (lambda: Marble(axis=(0, 0, 0)), "marble.axis must not be zero"),
        (lambda: Turbulence(octaves=13), "turbulence.octaves must be an integer from 1 to 12, got 13"),
        (lambda: Noise(seed=1.5), "noise.seed must be an integer"),
        (lambda: Stripes(share=1.5), r"stripes.share must lie in \[0, 1\]"),
        (lambda: Checker(mapping="world"), 'checker.mapping must be "object" or "uv"'),
        (lambda: Lambert(texture="wood"), "material.texture must be a Texture or a pattern, got str"),
        (lambda: Lambert(bump_texture=Noise(mapping="uv", uv_set=1)), "material.bump_texture must use the texture coordinates of set 0"),
    ],
)
def test_what_is_wrong_is_said(make, message):
    """Errors name the field, and what was expected."""
    with pytest.raises(SceneError, match=message):
        make()
