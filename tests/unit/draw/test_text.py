"""Words in pictures: where they lie, and what they cover."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.draw.canvas import Canvas
from limner.draw.text import BASELINES, Text, measure
from limner.errors import FileFormatError, SceneError, UnsupportedError


def covered(words: str, x: float = 60.0, y: float = 40.0, **how: object) -> NDArray[np.float32]:
    return Canvas(120, 80).text(x, y, words, "white", **how).image().pixels[..., 3]  # type: ignore[arg-type]


def bounds(alpha: NDArray[np.float32]) -> tuple[int, int, int, int]:
    rows, columns = np.flatnonzero(alpha.max(axis=1) > 0.3), np.flatnonzero(alpha.max(axis=0) > 0.3)
    return int(columns[0]), int(rows[0]), int(columns[-1]), int(rows[-1])


def test_letters_stand_on_their_baseline() -> None:
    """A capital ends just above y and begins at x; a letter with a tail goes below."""
    left, top, _, bottom = bounds(covered("H", size=32))
    assert abs(bottom - 39.5) <= 1.0
    assert 60 <= left <= 64
    assert 18 <= bottom - top <= 26  # two thirds of the size, about
    assert bounds(covered("p", size=32))[3] > 43


@pytest.mark.parametrize(("align", "share"), [("left", 0.0), ("center", 0.5), ("right", 1.0)])
def test_alignment_puts_a_part_of_each_line_at_x(align: str, share: float) -> None:
    for line in measure(Text("a longer line\nshort", 14, align), 60, 40).lines:
        assert line.x + share * line.advance == pytest.approx(60)


def test_baselines_put_a_height_of_the_block_at_y() -> None:
    """Top, middle and bottom of the box; the first line's baseline."""
    boxes = {name: measure(Text("one\ntwo\nthree", 12, baseline=name), 0, 40) for name in BASELINES}
    assert boxes["top"].top == 40
    assert (boxes["middle"].top + boxes["middle"].bottom) / 2 == pytest.approx(40)
    assert boxes["bottom"].bottom == 40
    assert boxes["baseline"].lines[0].y == 40
    assert boxes["top"].lines[2].y - boxes["top"].lines[1].y == pytest.approx(12 * 1.2)


def test_the_box_holds_the_ink() -> None:
    """What is drawn lies inside what was measured, and fills most of its width."""
    words = "Measured,\nboxes (of) gy"
    box = Canvas(1, 1).text_box(8.0, 10.0, words, size=17, baseline="top")
    drawn = Canvas(160, 80).text(8.0, 10.0, words, "white", size=17, baseline="top").image()
    left, top, right, bottom = bounds(drawn.pixels[..., 3])
    assert box.left - 1 <= left <= right <= box.right + 1
    assert box.top - 1 <= top <= bottom <= box.bottom + 1
    assert right - left > 0.9 * box.width - 2


def test_text_mixes_as_light() -> None:
    """Half transparent white over black: no pixel above one half, letters' insides at one half."""
    pixels = Canvas(120, 80, "black").text(60, 60, "M", (1, 1, 1, 0.5), size=60, align="center").image().pixels
    assert pixels[..., 0].max() == pytest.approx(0.5, abs=1e-6)
    assert (pixels[..., 3] == 1.0).all()


def test_text_beyond_the_border_is_cut() -> None:
    """The same letters, moved off the picture by whole pixels, are the same pixels as far as they are there."""
    whole = covered("Words", 30, 40, size=24)
    np.testing.assert_allclose(covered("Words", -2, 12, size=24)[:52, :88], whole[28:, 32:], atol=1e-6)
    assert not covered("Words", 1e6, 40, size=24).any()


def test_one_face_everywhere() -> None:
    """The face comes with Pillow: the same letters are the same pixels on every machine with that Pillow, at all sizes."""
    assert covered("limner").sum() == covered("limner").sum()
    assert measure(Text("limner", 40)).width == pytest.approx(2 * measure(Text("limner", 20)).width, rel=0.05)


def test_pillow_is_imported_for_text_only() -> None:
    """Shapes do without."""
    script = (
        "import sys; from limner.draw.canvas import Canvas; c = Canvas(9, 9).circle(4, 4, 3, fill='white');"
        "assert 'PIL' not in sys.modules; c.text(1, 1, 'a', 'white'); assert 'PIL' in sys.modules"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("how", "error", "message"),
    [
        ({"size": 0}, SceneError, "text.size must be positive"),
        ({"size": 1e9}, SceneError, "at most 4096"),
        ({"align": "justify"}, UnsupportedError, "left, center, right"),
        ({"baseline": "hanging"}, UnsupportedError, "top, middle, baseline, bottom"),
        ({"x": float("nan")}, SceneError, "finite x and y"),
        ({"font": "nowhere.ttf"}, FileFormatError, "nowhere.ttf: not a font"),
    ],
)
def test_bad_calls_say_what_is_wrong(how: dict[str, object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        covered("words", **how)  # type: ignore[arg-type]


def test_words_must_be_words() -> None:
    with pytest.raises(SceneError, match="text must be a string, got 7"):
        covered(7)  # type: ignore[arg-type]
