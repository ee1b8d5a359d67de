"""Charts of colour: that the numbers are where the axes say, that what must look alike does, and that the greys are the asked ones."""

from __future__ import annotations

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON

from limner.color.spaces import SPACES
from limner.color.transfer import bytes_from_linear, gamma_from_match
from limner.draw.canvas import Canvas, Pasted
from limner.errors import SceneError, UnsupportedError
from limner.produce.charts import CHARTS, chart
from limner.produce.chromaticity_chart import chromaticity_chart
from limner.produce.plot import Plot
from limner.produce.screen_charts import banding_chart, checker_chart, gamma_chart
from limner.produce.spectrum_charts import metamers_chart, spectra_chart

SIZE = {"width": 240, "height": 200}


@SLOW_AS_PYTHON
@pytest.mark.parametrize("kind", CHARTS)
def test_every_chart_is_a_picture_and_a_drawing(kind: str) -> None:
    """Of the asked size, opaque, not all one colour; the same commands as SVG."""
    canvas = chart(kind, **SIZE)
    pixels = canvas.image().pixels
    assert pixels.shape == (200, 240, 4)
    assert (pixels[..., 3] > 0.999).all()
    assert np.ptp(pixels[..., :3]) > 0.5
    assert canvas.svg().startswith("<svg")


@SLOW_AS_PYTHON
def test_the_diagram_is_painted_with_the_colours_that_it_names() -> None:
    """At a point inside sRGB the paint has that chromaticity, less the little white in all of it; outside the locus is none."""
    canvas = chromaticity_chart((), temperatures=False, width=400, height=420)
    (painted,) = [command.image for command in canvas.commands if isinstance(command, Pasted)]
    plot = Plot(Canvas(400, 420), (-0.06, 0.78), (-0.04, 0.89), "x", "y", "CIE 1931 chromaticity", is_square=True)
    for x, y in ((0.35, 0.35), (0.5, 0.35), (0.3, 0.5), (0.2, 0.2)):
        column, row = np.round(plot.at(x, y)).astype(int)
        light = (painted.pixels[row, column, :3].astype(np.float64) - 0.04) @ SPACES["srgb"].xyz_from_rgb.T
        assert light[:2] / light.sum() == pytest.approx((x, y), abs=0.006)
    column, row = np.round(plot.at(0.6, 0.6)).astype(int)
    assert painted.pixels[row, column, 3] == 0.0


@SLOW_AS_PYTHON
def test_gamma_patches_have_the_codes_that_they_say() -> None:
    """The board is black and white in equal parts; each grey gives its gamma back within the rounding of its code."""
    gammas = (1.8, 2.2, 2.6)
    codes = bytes_from_linear(gamma_chart(gammas, width=600, height=300).image().pixels[..., :3])
    row = codes[150, :, 0].astype(int)
    for k, gamma in enumerate(gammas):
        assert gamma_from_match(row[100 + 200 * k] / 255.0) == pytest.approx(gamma, abs=0.02)
    board = codes[140:160, 2:32, 0]
    assert set(np.unique(board)) == {0, 255}
    assert (board == 255).mean() == 0.5


@SLOW_AS_PYTHON
def test_metamers_are_one_patch_by_day_and_two_by_lamp() -> None:
    """The halves of the left patch are the same to the byte, those of the right one are not."""
    pixels = metamers_chart(width=480, height=360).image().to_uint8()
    row = pixels[330, :, :3].astype(int)
    left, right = row[120:200], row[300:450]
    assert np.ptp(left, axis=0).max() <= 1
    assert np.ptp(right, axis=0).max() > 8


@SLOW_AS_PYTHON
def test_the_checker_has_its_well_known_codes() -> None:
    """Dark skin is 115, 82, 68, as everybody has it; the last row is grey."""
    pixels = checker_chart(width=480, height=340).image().to_uint8()
    assert pixels[20, 40, :3].tolist() == [115, 82, 68]
    for column in range(1, 6):
        grey = pixels[275, 40 + column * 78, :3].astype(int)
        assert np.ptp(grey) <= 4


def test_sizes_and_numbers_that_make_no_chart_are_refused() -> None:
    """In words."""
    with pytest.raises(UnsupportedError, match=r"chromaticity, matching.*got 'pie'"):
        chart("pie")
    with pytest.raises(SceneError, match="at least 200 pixels"):
        chart("gamma", width=100)
    with pytest.raises(UnsupportedError, match="xy, uv"):
        chromaticity_chart(plane="lab")
    with pytest.raises(SceneError, match="bits must be"):
        banding_chart((9,))
    with pytest.raises(SceneError, match="at least one gamma"):
        gamma_chart(())
    with pytest.raises(SceneError, match="1 to 7 spectra"):
        spectra_chart({})
