"""A canvas as SVG: well-formed, the same for the same drawing, and the same picture."""

from __future__ import annotations

import io
import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.draw.canvas import Canvas
from limner.draw.path import Path
from limner.draw.stroke import Pen
from limner.draw.svg import path_data
from limner.image.image import Image

SVG = "{http://www.w3.org/2000/svg}"


def drawing() -> Canvas:
    """Opaque shapes of every kind but text."""
    canvas = Canvas(160, 120, background="#ffffff")
    turn = 4.0 * np.pi / 5.0 * np.arange(5)
    canvas.polygon(np.stack([35 + 30 * np.cos(turn), 35 + 30 * np.sin(turn)], axis=1), fill="#cc3333", rule="evenodd")
    canvas.polyline([(80, 10), (100, 60), (110, 15), (150, 50)], "#223366", Pen(9, "square", "miter", 10))
    canvas.polyline([(80, 60), (100, 105), (110, 65)], "#226633", Pen(8, "round", "round"))
    canvas.circle(35, 90, 22, stroke="black", pen=Pen(4, "round", dashes=(9, 8), dash_offset=3))
    canvas.draw(Path().arc(120, 90, 30, 12, 0.4, -4.5, rotation=0.5), stroke="#884400", pen=3)
    canvas.rectangle(62, 70, 14, 40, fill="#3388cc", radius=5)
    canvas.stroke(Path().move_to(5, 115).cubic_to(40, 60, 60, 160, 90, 112).quadratic_to(120, 80, 155, 115), "#660066", 2)
    canvas.segments([(1, 1, 40, 3), (1, 8, 40, 5)], "black", 1.5)
    canvas.triangles([[(120, 60), (155, 62), (140, 80)]], [[(0, 1, 1)] * 3])
    canvas.triangles([[(60, 2), (75, 3), (66, 20)]], [[(1, 0, 0), (0, 1, 0), (0, 0, 1)]])
    with canvas.clipped(130.5, 1.5, 20, 12):
        canvas.circle(140, 1, 11, fill="#ff8800")
    return canvas.paste(Image(np.full((4, 6, 4), (0.0, 0.5, 0.0, 1.0), dtype=np.float32)), 150, 100)


def rasterized(svg: str) -> NDArray[np.uint8]:
    """What resvg makes of it, (height, width, 4), straight alpha."""
    resvg = pytest.importorskip("resvg_py", reason="needs resvg-py: an independent renderer of SVG")
    from PIL import Image as Pictures

    return np.asarray(Pictures.open(io.BytesIO(bytes(resvg.svg_to_bytes(svg_string=svg)))).convert("RGBA"))


def test_another_renderer_draws_the_same_picture() -> None:
    """Opaque shapes by resvg: the same codes, but along edges, where it mixes codes and not light and its curves are coarse."""
    canvas = drawing()
    theirs = rasterized(canvas.svg()).astype(np.int64)
    ours = canvas.image().to_uint8().astype(np.int64)
    difference = np.abs(theirs - ours)[..., :3].max(axis=2)
    around = np.lib.stride_tricks.sliding_window_view(ours, (3, 3), axis=(0, 1))
    flat = np.ptp(around, axis=(-2, -1)).max(axis=-1) == 0
    assert flat.mean() > 0.6
    assert difference[1:-1, 1:-1][flat].max() <= 1
    assert (difference > 80).mean() < 0.01


@pytest.mark.parametrize("join", ["miter", "round", "bevel"])
def test_coverage_is_that_of_another_renderer(join: str) -> None:
    """Black on transparent: alpha is coverage, which both give, whatever light they mix; resvg to about a sixteenth."""
    cap = {"miter": "square", "round": "round", "bevel": "butt"}[join]
    canvas = Canvas(64, 64).polyline([(9, 9), (50, 20), (10, 50)], "black", Pen(8, cap, join))
    canvas.line(25, 58, 60, 35, "black", Pen(5, dashes=(9, 4)))
    difference = rasterized(canvas.svg())[..., 3] / 255.0 - canvas.image().pixels[..., 3]
    assert np.abs(difference).max() < 0.1
    assert abs(difference.mean()) < 2e-3


def test_the_text_is_well_formed_and_the_same_each_time() -> None:
    """Parsed by an XML reader; no number has more than four decimals."""
    first, second = drawing().svg(), drawing().svg()
    assert first == second
    root = ElementTree.fromstring(first)
    assert root.get("viewBox") == "-0.5 -0.5 160 120"
    data = [element.get("d", "") for element in root.iter(f"{SVG}path")]
    assert len(data) >= 8
    assert not any("e" in d.lower() or "nan" in d.lower() for d in data)
    assert all(len(part) <= 4 for d in data for part in _decimals(d))


def _decimals(data: str) -> list[str]:
    return re.findall(r"\.(\d+)", data)


def test_words_are_escaped() -> None:
    """Signs that XML keeps for itself, quotes, blanks, and characters it cannot hold."""
    words = 'a < b & "c" > \'d\'  e\x00\x1b\nsecond line'
    root = ElementTree.fromstring(Canvas(99, 50).text(50, 20, words, (1, 0, 0, 0.5), align="center").svg())
    texts = list(root.iter(f"{SVG}text"))
    assert [text.text for text in texts] == ['a < b & "c" > \'d\'  e\ufffd\ufffd', "second line"]
    assert texts[0].get("fill") == "#ff0000"
    assert texts[0].get("fill-opacity") == "0.5"
    assert texts[0].get("font-family", "").startswith("Aileron")
    assert float(texts[0].get("textLength", "0")) > float(texts[1].get("textLength", "0")) > 0


def test_a_path_may_grow_after_it_was_drawn() -> None:
    """The drawing keeps what it drew."""
    path = Path().move_to(1, 1).line_to(5, 1).line_to(5, 5)
    canvas = Canvas(9, 9).fill(path, "black")
    before = canvas.svg()
    path.line_to(1, 5).close().move_to(0, 0).line_to(9, 9)
    assert canvas.svg() == before


def test_clips_are_defined_once() -> None:
    canvas = Canvas(30, 30)
    with canvas.clipped(1, 2, 10, 9):
        canvas.circle(5, 5, 9, fill="white").circle(9, 5, 9, fill="black")
    root = ElementTree.fromstring(canvas.svg())
    assert [rect.attrib for rect in root.iterfind(f"{SVG}defs/{SVG}clipPath/{SVG}rect")] == [
        {"x": "1", "y": "2", "width": "10", "height": "9"}
    ]
    assert len(root.findall(f"{SVG}g[@clip-path='url(#clip0)']")) == 2


def test_path_data() -> None:
    """Moves, lines, curves, arcs in SVG's words; a circle is two or more, for SVG's arcs end elsewhere than they begin."""
    path = Path().move_to(1, 2).line_to(3.5, -0.00001).cubic_to(1, 2, 3, 4, 5, 6).close()
    assert path_data(path) == "M1 2L3.5 0C1 2 3 4 5 6Z"
    assert path_data(Path().arc(0, 0, 2, 1, 0, math.pi / 2)) == "M2 0A2 1 0 0 1 0 1"
    assert path_data(Path().circle(0, 0, 1)).count("A") >= 2
    assert path_data(Path().arc(0, 0, 1, 1, 0, -1)).split()[3:5] == ["0", "0"]  # neither large nor towards +y
