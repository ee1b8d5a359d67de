"""The key to colours: round numbers where they belong, the colours of the map, and a picture that is otherwise as it was."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limner.color.maps import mapped
from limner.draw.color_bar import ColorBar, round_ticks, with_color_bar
from limner.errors import SceneError, UnsupportedError
from limner.image.image import Image

GREY = Image(np.full((200, 240, 4), [0.25, 0.25, 0.25, 1.0], dtype=np.float32), aov={"depth": np.ones((200, 240), dtype=np.float32)})


@settings(max_examples=50, deadline=None)
@given(low=st.floats(-1e12, 1e12), span=st.floats(1e-6, 1e12), most=st.integers(2, 9))
def test_ticks_are_round_and_few(low: float, span: float, most: int) -> None:
    """Steps are 1, 2 or 5 times a power of ten, at least one tick fits in and no more than asked for, and all are told apart."""
    high = low + span
    ticks = round_ticks(low, high, most)
    values = [value for value, _ in ticks]
    assert 1 <= len(ticks) <= most
    assert len({text for _, text in ticks}) == len(ticks)
    if span > 1e-9 * abs(low):
        assert values[0] >= low - 1e-9 * span
        assert values[-1] <= high + 1e-9 * span
        assert np.allclose([float(text) for _, text in ticks], values, rtol=1e-6, atol=1e-6 * span)
    if len(values) > 2 and span > 1e-6 * abs(low):
        mantissa = float(f"{values[1] - values[0]:e}".split("e")[0])
        assert min(abs(mantissa - digit) for digit in (1, 2, 5, 10)) < 1e-3


def test_ticks_of_one_number() -> None:
    """A range of one number has that for a tick."""
    assert round_ticks(2.5, 2.5) == [(2.5, "2.5")]


@pytest.mark.parametrize("name", ["viridis", "cool_warm"])
def test_the_strip_has_the_colours_of_the_map(name: str) -> None:
    """From bottom to top the strip runs through the map; the rest of the picture, and what lies beside it, is untouched."""
    made = with_color_bar(GREY, ColorBar(name, (0.0, 1.0), "heat"))
    changed = (made.pixels != GREY.pixels).any(axis=2)
    assert not changed[:, :140].any()
    assert made.aov["depth"].shape == (200, 240)
    ends = mapped([0.0, 1.0], name)
    # The column that holds both ends of the map, the greater on top.
    distance = [np.abs(made.pixels[..., :3] - end).max(axis=2) < 0.02 for end in ends]
    columns = np.flatnonzero(distance[0].any(axis=0) & distance[1].any(axis=0))
    assert len(columns) >= 8
    low, high = (int(np.flatnonzero(d[:, columns[3]]).mean()) for d in distance)
    assert low - high > 100


def test_beside() -> None:
    """Beside the picture it makes the picture wider, and covers nothing."""
    made = with_color_bar(GREY, ColorBar(range=(0.0, 37.5)), place="beside")
    assert made.width > GREY.width
    assert (made.pixels[:, :240] == GREY.pixels).all()
    assert made.aov == {}


def test_small_pictures_and_constant_ranges() -> None:
    """A picture too small to write in stays as it is; a range of one number is drawn in its one colour."""
    small = Image(np.ones((20, 20, 4), dtype=np.float32))
    assert with_color_bar(small, ColorBar()) is small
    made = with_color_bar(GREY, ColorBar("grey", (3.0, 3.0)))
    strip = made.pixels[90:110, 180:]
    assert (np.abs(strip[..., :3] - mapped([3.0], "grey")[0]).max(axis=2) < 1e-5).sum() > 100


def test_what_is_refused() -> None:
    """Unknown maps and places, ranges and labels that are none."""
    with pytest.raises(UnsupportedError, match="viridis"):
        ColorBar("rainbow")
    with pytest.raises(SceneError, match="range must be finite"):
        ColorBar(range=(1.0, 0.0))
    with pytest.raises(SceneError, match="label must be a string"):
        ColorBar(label=7)  # type: ignore[arg-type]
    with pytest.raises(UnsupportedError, match="inside, beside"):
        with_color_bar(GREY, ColorBar(), place="above")
    with pytest.raises(SceneError, match="must be a ColorBar"):
        with_color_bar(GREY, "viridis")  # type: ignore[arg-type]
