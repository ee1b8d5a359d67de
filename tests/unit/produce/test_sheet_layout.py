"""Technical sheets: views in line, standard scales, numbers that are true."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.draw.page import Caption, Patch, Trace
from limner.errors import SceneError, UnsupportedError
from limner.produce.sheet_layout import Area, fitting_scale, lay_out, paper_size, places, read_scale, scale_name, scales_below
from limner.produce.sheet_marks import dimension, projection_symbol, scale_bar

SIZES = {"front": (40.0, 30.0), "top": (40.0, 20.0), "right": (20.0, 30.0), "left": (20.0, 30.0), "back": (40.0, 30.0), "iso": (45.0, 45.0)}
AREA = Area(20.0, 10.0, 390.0, 240.0)


@pytest.mark.parametrize("angle", ["first", "third"])
def test_views_stand_in_line(angle: str) -> None:
    """Front and top share their middle from left to right, front, right, left and back theirs from above to below; none overlaps."""
    scale, areas = lay_out(SIZES, angle, AREA, 12.0)
    assert scale == 2.0
    middles = {name: (area.x + area.width / 2.0, area.y + area.height / 2.0) for name, area in areas.items()}
    assert math.isclose(middles["front"][0], middles["top"][0])
    assert all(math.isclose(middles["front"][1], middles[name][1]) for name in ("right", "left", "back"))
    assert (middles["top"][1] > middles["front"][1]) == (angle == "first")
    assert (middles["right"][0] > middles["front"][0]) == (angle == "third")
    assert middles["back"][0] == max(x for x, _ in middles.values())
    for name, area in areas.items():
        assert (area.width, area.height) == (SIZES[name][0] * scale, SIZES[name][1] * scale)
        assert area.x >= AREA.x
        assert area.x + area.width <= AREA.x + AREA.width
        for other, beside in areas.items():
            apart = max(beside.x - area.x - area.width, area.x - beside.x - beside.width, beside.y - area.y - area.height,
                        area.y - beside.y - beside.height)  # fmt: skip
            assert name == other or apart >= 12.0 - 1e-9


def test_scales_are_standard_and_the_largest() -> None:
    """1, 2 or 5 times a power of ten, at most what fits and more than half (or two fifths) of it, over twelve decades."""
    for most in np.geomspace(1e-6, 1e6, 241):
        scale = fitting_scale(float(most))
        assert 0.4 * most <= scale <= most * (1.0 + 1e-8)
        mantissa = scale / 10.0 ** math.floor(math.log10(scale) + 1e-9)
        assert min(abs(mantissa - m) for m in (1.0, 2.0, 5.0)) < 1e-9
        assert math.isclose(read_scale(scale_name(scale)), scale)


def test_views_fill_the_paper() -> None:
    """Of parts of any shape and size, with all that stands beside them clear of the title block: the scale is the largest that drawings
    have, of all corners for the view along no axis, or a standard one that is more than seven tenths of it; and it is told exactly."""
    block, rng = Area(230.0, 250.0, 180.0, 36.0), np.random.default_rng(4)
    room = AREA.inset(0.0, 0.0, 0.0, -20.0)
    for _ in range(60):
        w, h, d = 10.0 ** rng.uniform(-3.0, 5.0) * rng.uniform(0.2, 1.0, 3)
        iso = (w + d) * math.sqrt(0.5), h + 0.4 * (w + d)
        sizes = {"front": (w, h), "top": (w, d), "right": (d, h), "iso": iso}
        plain = lay_out(sizes, "first", AREA, 12.0)
        scale, areas = lay_out(sizes, "first", AREA, 12.0, None, "A3", 20.0, block)
        assert scale >= plain.scale * 0.7
        assert any(math.isclose(scale, s) for s in scales_below(1.1 * scale))
        assert math.isclose(read_scale(scale_name(scale)), scale)
        for one in areas.values():
            assert one.x >= room.x - 1e-9
            assert one.y >= room.y - 1e-9
            assert one.x + one.width <= room.x + room.width + 1e-9
            assert one.y + one.height <= room.y + room.height + 1e-9
            assert min(block.x - one.x - one.width, block.y - one.y - one.height) > 0.0 or max(
                block.x - one.x - one.width, block.y - one.y - one.height
            ) >= 6.0 - 1e-9
        # From one scale to the next it is a half at most, over seven tenths.
        with pytest.raises(SceneError, match="do not fit"):
            lay_out(sizes, "first", AREA, 12.0, scale * 1.5 / 0.7, "A3", 20.0, block)


def test_a_scale_that_does_not_fit_is_refused() -> None:
    """With the one that does; words that are no scale, too."""
    assert lay_out(SIZES, "first", AREA, 12.0, 0.1).scale == 0.1
    with pytest.raises(SceneError, match=r"at 10:1 the views do not fit on A3: choose 2:1 or a larger paper"):
        lay_out(SIZES, "first", AREA, 12.0, 10.0, "A3")
    with pytest.raises(SceneError, match="no room"):
        lay_out(SIZES, "first", AREA.inset(0, 0, 380, 0), 12.0)
    for word in ("1:0", "wide", "0", "-1", ""):
        with pytest.raises(SceneError, match="scale must be"):
            read_scale(word)
    with pytest.raises(UnsupportedError, match="A4, A3"):
        paper_size("letter")
    with pytest.raises(UnsupportedError, match="first, third"):
        places(["front"], "second")


def test_dimensions_measure_what_they_stand_at() -> None:
    """The line is as long as the part and outside it, arrows point at its ends from within, the number stands in the middle."""
    for start, end, upward in (((10.0, 50.0), (60.0, 50.0), False), ((10.0, 50.0), (10.0, 15.0), True)):
        marks = dimension(start, end, 9.0, "50")
        lines = [mark for mark in marks if isinstance(mark, Trace)]
        arrows = [mark.rings[0] for mark in marks if isinstance(mark, Patch)]
        (words,) = [mark for mark in marks if isinstance(mark, Caption)]
        main = lines[-1].points
        assert np.isclose(np.linalg.norm(main[1] - main[0]), math.dist(start, end))
        assert np.allclose([arrows[0][0], arrows[1][0]], main)
        assert all(np.linalg.norm(arrow - main.mean(axis=0), axis=1).max() <= math.dist(start, end) / 2.0 + 1e-9 for arrow in arrows)
        assert words.upward == upward
        assert np.linalg.norm(main.mean(axis=0) - (words.x, words.y)) <= 1.0 + 1e-9
        assert main[:, 0].max() < 10.0 if upward else main[:, 1].min() > 50.0
    short = dimension((10.0, 50.0), (12.0, 50.0), 9.0, "2")
    tips = [mark.rings[0] for mark in short if isinstance(mark, Patch)]
    assert tips[0][1:, 0].max() < 10.0  # the arrows stand outside
    assert tips[1][1:, 0].min() > 12.0


def test_the_scale_bar_is_as_long_as_it_says() -> None:
    """At 1:50 a bar that says 2000 mm is 40 mm long, in five parts."""
    marks = scale_bar(0.0, 0.0, 1.0 / 50.0)
    said = [mark.words for mark in marks if isinstance(mark, Caption)]
    box = next(mark for mark in marks if isinstance(mark, Trace))
    assert said == ["0", "2000 mm"]
    assert np.isclose(np.ptp(box.points[:, 0]), 40.0)
    assert sum(isinstance(mark, Patch) for mark in marks) == 3


def test_the_symbol_shows_the_angle() -> None:
    """The small end of the cone is at its left; the rings stand right of it in first angle, left in third."""
    for angle, right in (("first", True), ("third", False)):
        marks = [mark for mark in projection_symbol(0.0, 0.0, angle) if isinstance(mark, Trace) and mark.closed]
        cone, ring = marks[0].points, marks[1].points
        left, other = (np.ptp(cone[cone[:, 0] == x][:, 1]) for x in (cone[:, 0].min(), cone[:, 0].max()))
        assert left < other
        assert (ring[:, 0].mean() > cone[:, 0].mean()) == right
        assert abs(np.concatenate([cone, ring])[:, 0].max() + np.concatenate([cone, ring])[:, 0].min()) < 1e-9
