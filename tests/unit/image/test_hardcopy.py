"""Paper: sizes in closed form, screens whose share of ink is the tone, at the frequency and angle asked for."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.errors import SceneError, UnsupportedError
from limner.image.hardcopy import SHAPES, grey_levels, halftoned, print_size
from limner.image.image import Image


def test_print_sizes_are_closed_forms() -> None:
    """Pixels by pixels per inch, times 25.4 mm; A4 at 300 dpi is 2480 x 3508."""
    assert print_size(300, 600, 300) == (25.4, 50.8)
    width, height = print_size(2480, 3508, 300)
    assert (round(width), round(height)) == (210, 297)
    assert Image(np.ones((100, 200, 4), dtype=np.float32), dpi=100.0).print_size() == (50.8, 25.4)


@pytest.mark.parametrize("dpi", [0, -1, math.nan, math.inf, "300", True])
def test_resolutions_that_are_none_are_refused(dpi: object) -> None:
    """By name."""
    with pytest.raises(SceneError, match="dpi must be a positive number"):
        print_size(1, 1, dpi)  # type: ignore[arg-type]
    with pytest.raises(SceneError, match=r"image\.dpi must be a positive number"):
        Image(np.ones((1, 1, 4), dtype=np.float32), dpi=dpi)  # type: ignore[arg-type]
    with pytest.raises(SceneError, match="has none of its own"):
        Image(np.ones((1, 1, 4), dtype=np.float32)).print_size()


@pytest.mark.parametrize("shape", sorted(SHAPES))
@pytest.mark.parametrize("angle", [0.0, 15.0, 45.0])
@pytest.mark.parametrize("tone", [0.0, 0.04, 0.25, 0.5, 0.6, 0.9, 1.0])
def test_the_share_of_paper_is_the_tone(shape: str, angle: float, tone: float) -> None:
    """Whatever the dots look like: light mixes by area. Cells that are no whole number of dots wide, so that they average."""
    paper = halftoned(np.full((500, 500), tone), 600, 53.7, angle, shape)
    assert paper.mean() == pytest.approx(tone, abs=0.012)
    if tone in (0.0, 1.0):
        assert (paper == bool(tone)).all()


@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0])
def test_the_screen_has_its_frequency_and_angle(angle: float) -> None:
    """The strongest frequency of a line screen is lpi / dpi, across the lines, turned counter-clockwise with y up."""
    n, dpi, lines = 512, 600.0, 75.0
    pattern = halftoned(np.full((n, n), 0.5), dpi, lines, angle, "line") - 0.5
    power = np.abs(np.fft.fft2(pattern))
    row, column = divmod(int(np.argmax(power)), n)
    fy, fx = -np.fft.fftfreq(n)[row], np.fft.fftfreq(n)[column]
    assert math.hypot(fx, fy) == pytest.approx(lines / dpi, abs=1 / n)
    across = math.degrees(math.atan2(fy, fx)) % 180.0
    assert across == pytest.approx((angle + 90.0) % 180.0, abs=1.5)


def test_dots_are_clustered() -> None:
    """At a quarter of ink there is one dot in each cell, not a scatter: as many clusters as cells."""
    from scipy.ndimage import label

    paper = halftoned(np.full((240, 240), 0.75), 600, 50, 0.0, "round")
    wrapped = ~np.roll(paper, (6, 6), axis=(0, 1))  # cells of 12 dots, moved so that none is cut
    assert label(wrapped)[1] == (240 // 12) ** 2


def test_round_dots_make_a_checkerboard_at_half() -> None:
    """The pattern is its own negative, half a cell on in both directions."""
    paper = halftoned(np.full((96, 96), 0.5), 600, 50, 0.0, "round")
    agree = (paper == ~np.roll(paper, (6, 6), axis=(0, 1))).mean()
    assert agree > 0.8


def test_grey_levels() -> None:
    """Dots of a cell and one."""
    assert (grey_levels(300, 300), grey_levels(600, 150), grey_levels(1200, 100)) == (2, 17, 145)


def test_a_picture_becomes_ink() -> None:
    """Black or white, opaque, over white paper, at the printer's resolution; a ramp keeps its tone in every part."""
    pixels = np.ones((128, 512, 4), dtype=np.float32)
    pixels[..., :3] = np.linspace(0.0, 1.0, 512, dtype=np.float32)[:, None]
    pixels[:, :64, 3] = 0.0
    made = Image(pixels, recipe={"seed": 2}).halftoned(600, 100)
    assert (set(np.unique(made.pixels)), made.dpi, made.recipe) == ({0.0, 1.0}, 600, {"seed": 2})
    tone = made.pixels[..., 0].reshape(128, 8, 64).mean(axis=(0, 2))
    assert tone[0] == 1.0
    np.testing.assert_allclose(tone[1:], (np.arange(1, 8) + 0.5) / 8, atol=0.03)


def test_slips_are_told() -> None:
    """A screen finer than the printer, an unknown dot, an angle that is none."""
    tone = np.ones((4, 4))
    with pytest.raises(SceneError, match="at most half the printer's dpi"):
        halftoned(tone, 300, 200)
    with pytest.raises(UnsupportedError, match="round, diamond, line, got 'star'"):
        halftoned(tone, 600, 75, 45, "star")
    with pytest.raises(SceneError, match="angle_degrees must be finite"):
        halftoned(tone, 600, 75, math.nan)
