"""What stands on a technical drawing beside its views: frame, title block, projection symbol, scale bar, dimensions.

    frame      0.7 mm, 20 mm from the left edge (for filing), 10 mm from the others               ISO 5457
    title      180 x 36 mm in the lower right corner                                              ISO 7200
    symbol     the frustum of a cone, from the side and from its small end                        ISO 5456-2
    dimension  between extension lines 1 mm off the part, arrows of 3 mm, the number above        ISO 129-1

All lengths are millimetres of the page, y down; words are 3.5 mm high unless said.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..draw.ink import Rgba
from ..draw.page import Caption, Mark, Patch, Trace, advance
from ..draw.stroke import Pen
from .sheet_layout import Area

__all__ = [
    "BLACK", "TITLE_HEIGHT", "dimension", "frame_area", "frame_marks", "label", "projection_symbol", "scale_bar", "title_area",
    "title_block",
]  # fmt: skip

BLACK: Rgba = (0.0, 0.0, 0.0, 1.0)
TITLE_HEIGHT = 36.0
_TITLE_WIDTH = 180.0
_THICK, _THIN = Pen(0.7, "square", "miter"), Pen(0.25, "butt", "miter")
_ROUND = Pen(0.35, "round", "round")

_LETTERS, _SMALL = 3.5, 2.2
_ARROW = 3.0
_ARROW_HALF = 0.5  # of its width
_OFF, _BEYOND = 1.0, 2.0  # where an extension line begins off the part, and how far it goes beyond the dimension's


def frame_area(width: float, height: float) -> Area:
    """What is inside the frame of a page."""
    return Area(0.0, 0.0, width, height).inset(20.0, 10.0, 10.0, 10.0)


def frame_marks(frame: Area) -> list[Mark]:
    """The frame, and the marks in the middle of its sides by which prints are aligned."""
    x, y, right, bottom = frame.x, frame.y, frame.x + frame.width, frame.y + frame.height
    middle_x, middle_y = (x + right) / 2.0, (y + bottom) / 2.0
    ticks = [((middle_x, y - 5), (middle_x, y + 5)), ((middle_x, bottom), (middle_x, bottom + 5))]  # the title block is there
    ticks += [((x - 5, middle_y), (x + 5, middle_y)), ((right - 5, middle_y), (right + 5, middle_y))]
    return [_box(frame, _THICK), *(_line(a, b, _THICK) for a, b in ticks)]


def title_area(frame: Area) -> Area:
    """Where the title block stands in a frame."""
    width = min(_TITLE_WIDTH, frame.width)
    return Area(frame.x + frame.width - width, frame.y + frame.height - TITLE_HEIGHT, width, TITLE_HEIGHT)


def title_block(frame: Area, name: str, scale: str, paper: str, angle: str, unit: str, date: str) -> list[Mark]:
    """The block in the lower right corner of a frame."""
    block = title_area(frame)
    width = block.width
    left, half = width * 0.5, TITLE_HEIGHT / 2.0
    x, y = block.x, block.y
    marks: list[Mark] = [_box(block, _THICK), _line((x + left, y), (x + left, y + TITLE_HEIGHT), _ROUND)]
    marks += [_line((x, y + half), (x + width, y + half), _ROUND)]
    marks.append(_line((x + 0.25 * width, y + half), (x + 0.25 * width, y + TITLE_HEIGHT), _ROUND))
    marks.append(_line((x + 0.75 * width, y), (x + 0.75 * width, y + half), _ROUND))
    quarter = width / 4.0
    marks += _field(x, y, left, "Name", _fitted(name, 5.0, left - 4.0), 5.0)
    marks += _field(x, y + half, quarter, "Unit", unit)
    marks += _field(x + quarter, y + half, quarter, "Date", date)
    marks += _field(x + left, y, quarter, "Scale", scale, 5.0)
    marks += _field(x + left + quarter, y, quarter, "Paper", paper)
    marks += _field(x + left, y + half, quarter, "Projection", f"{angle} angle")
    return [*marks, *projection_symbol(x + left + 1.5 * quarter, y + 1.5 * half, angle)]


def _field(x: float, y: float, width: float, title: str, words: str, size: float = _LETTERS) -> list[Mark]:
    heading = Caption(title, x + 1.5, y + 1.2 + _SMALL * 0.8, _SMALL, BLACK)
    return [heading, Caption(_fitted(words, size, width - 4.0), x + 2.0, y + 13.0, size, BLACK)]


def _fitted(words: str, size: float, width: float) -> str:
    """The words, cut at their end where they are wider."""
    kept = len(words)
    while kept and advance(words[:kept] + "..." * (kept < len(words)), size) > width:
        kept -= 1
    return words[:kept] + "..." * (kept < len(words))


def projection_symbol(x: float, y: float, angle: str, height: float = 8.0) -> list[Mark]:
    """The frustum of a cone round (x, y): in first angle what is seen from its left, small end stands at its right.

    **Source**: ISO 5456-2:1996, figures 3 and 6.
    """
    large, small, gap = height / 2.0, height / 4.0, height * 0.3
    side, total = height, height + height * 0.3 + height
    begin = x - total / 2.0
    cone, rings = (begin, begin + side + gap + large) if angle == "first" else (begin + height + gap, begin + large)
    corners = np.array([(cone, y - small), (cone + side, y - large), (cone + side, y + large), (cone, y + small)])
    turn = 2.0 * math.pi * np.arange(48) / 48
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    center = Pen(0.18, "butt", dashes=(2.0, 0.5, 0.25, 0.5))
    return [
        Trace(corners, BLACK, _ROUND, True),
        *(Trace(radius * ring + (rings, y), BLACK, _ROUND, True) for radius in (large, small)),
        _line((cone - 1.5, y), (cone + side + 1.5, y), center),
        _line((rings - large - 1.5, y), (rings + large + 1.5, y), center),
        _line((rings, y - large - 1.5), (rings, y + large + 1.5), center),
    ]


def scale_bar(x: float, y: float, scale: float, longest: float = 60.0) -> list[Mark]:
    """A bar of 1, 2 or 5 times a power of ten millimetres of the model, its left end at (x, y): five parts, filled in turn."""
    from .sheet_layout import fitting_scale

    total = fitting_scale(longest / scale)
    step, height = total * scale / 5.0, 2.0
    marks: list[Mark] = [_box(Area(x, y, 5 * step, height), _THIN)]
    for part in (0, 2, 4):
        left, right = x + part * step, x + (part + 1) * step
        marks.append(Patch((np.array([(left, y), (right, y), (right, y + height), (left, y + height)]),), BLACK))
    words = [(0.0, "0"), (5.0, f"{total:.12g} mm")]
    return [*marks, *(Caption(text, x + at * step, y - 1.2, 2.5, BLACK, "center") for at, text in words)]


def label(area: Area, name: str) -> Mark:
    """The name of a view, above its left end."""
    return Caption(name, area.x, area.y - 3.0, 2.5, BLACK)


def dimension(start: tuple[float, float], end: tuple[float, float], distance: float, words: str) -> list[Mark]:
    """A length between two points of the part, one beside the other (measured below them) or one below the other (at their left).

    Parameters
    ----------
    start, end : (float, float)
        On one height, from left to right; or one below the other, from below to above.
    distance : float
        From the part to the dimension line.
    words : str
    """
    upward = start[0] == end[0]
    across = np.array([-1.0, 0.0]) if upward else np.array([0.0, 1.0])
    a, b = np.array(start), np.array(end)
    along = (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)
    first, last = a + distance * across, b + distance * across
    length = float(np.linalg.norm(b - a))
    marks: list[Mark] = [_line(p + _OFF * across, p + (distance + _BEYOND) * across, _THIN) for p in (a, b)]
    inside = length > 3.0 * _ARROW
    reach = np.zeros(2) if inside else 2.0 * _ARROW * along  # arrows that do not fit between point at the lines from outside
    marks.append(_line(first - reach, last + reach, _THIN))
    sense = 1.0 if inside else -1.0
    marks += [_arrow(first, sense * along), _arrow(last, -sense * along)]
    if (inside and advance(words, _LETTERS) <= length - 2.0 * _ARROW) or length >= advance(words, _LETTERS):
        place, align = (first + last) / 2.0, "center"
    else:
        place, align = last + reach + along, "left"
    x, y = place - 1.0 * (across if not upward else -across)
    return [*marks, Caption(words, float(x), float(y), _LETTERS, BLACK, align, upward)]


def _arrow(tip: np.ndarray, into: np.ndarray) -> Patch:
    """A filled arrowhead whose body lies in the direction `into`."""
    side = _ARROW_HALF * np.array([-into[1], into[0]])
    return Patch((np.stack([tip, tip + _ARROW * into + side, tip + _ARROW * into - side]),), BLACK)


def _line(a: Sequence[float] | np.ndarray, b: Sequence[float] | np.ndarray, pen: Pen) -> Trace:
    return Trace(np.array([a, b], dtype=np.float64), BLACK, pen)


def _box(area: Area, pen: Pen) -> Trace:
    x, y, right, bottom = area.x, area.y, area.x + area.width, area.y + area.height
    return Trace(np.array([(x, y), (right, y), (right, bottom), (x, bottom)]), BLACK, pen, True)
