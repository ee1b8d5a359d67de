"""Where the views of a technical drawing stand, and at what scale (ISO 5455, 5456-2, 5457).

        first angle            third angle

              bottom               top     iso
        right front left     left  front   right  back
              top    iso           bottom

In both, neighbouring views share their axis and stand in line; in first angle a view is behind what it shows, as a shadow that the part
throws, in third angle in front of it, as on a glass box round the part. A view that is along no axis stands in the corner between others
in which all may be drawn the largest, and where the title block leaves room, they stand beside it.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ..errors import SceneError, UnsupportedError

__all__ = ["ANGLES", "PAPERS", "Area", "Layout", "fitting_scale", "lay_out", "paper_size", "read_scale", "scale_name", "scales_below"]

PAPERS: Mapping[str, tuple[float, float]] = {
    "A4": (297.0, 210.0), "A3": (420.0, 297.0), "A2": (594.0, 420.0), "A1": (841.0, 594.0), "A0": (1189.0, 841.0),
    "A4-portrait": (210.0, 297.0), "A3-portrait": (297.0, 420.0),
}  # fmt: skip
"""Width and height, millimetres."""

ANGLES = ("first", "third")

_FILLED = 0.7  # of what fits: where a standard scale is less, one between the standard ones is taken

_THIRD = {"front": (0, 0), "top": (0, -1), "bottom": (0, 1), "right": (1, 0), "left": (-1, 0), "back": (2, 0)}
_CORNERS = {"first": ((1, 1), (1, -1), (-1, -1), (-1, 1)), "third": ((1, -1), (1, 1), (-1, -1), (-1, 1))}


class Area(NamedTuple):
    """A rectangle on the page, millimetres from its upper left corner."""

    x: float
    y: float
    width: float
    height: float

    def inset(self, left: float, top: float, right: float, bottom: float) -> Area:
        """What is left of it within margins."""
        return Area(self.x + left, self.y + top, self.width - left - right, self.height - top - bottom)


class Layout(NamedTuple):
    """The scale, in millimetres on paper for each of the model, and the rectangle of each view, by its name."""

    scale: float
    areas: dict[str, Area]


def paper_size(name: str, extra: str = "") -> tuple[float, float]:
    """The sides of a paper, millimetres."""
    if name not in PAPERS:
        raise UnsupportedError(f"paper must be one of {', '.join(PAPERS)}, got {name!r}{extra}")
    return PAPERS[name]


def read_scale(scale: str | float) -> float:
    """A scale, written 1:2 or 2:1 or as a number.

    >>> read_scale("1:2"), read_scale("5:1"), read_scale(0.1)
    (0.5, 5.0, 0.1)
    """
    found = re.fullmatch(r"\s*([0-9.]+)\s*:\s*([0-9.]+)\s*", scale) if isinstance(scale, str) else None
    try:
        value = float(found[1]) / float(found[2]) if found else float(scale)
    except (TypeError, ValueError, ZeroDivisionError):
        value = math.nan
    if not (math.isfinite(value) and value > 0.0):
        raise SceneError(f"scale must be as in 1:2 or 5:1, or a positive number, got {scale!r}")
    return value


def scale_name(scale: float) -> str:
    """A scale as drawings state it.

    >>> scale_name(0.5), scale_name(20.0), scale_name(1.0)
    ('1:2', '20:1', '1:1')
    """
    return f"{scale:.12g}:1" if scale >= 1.0 else f"1:{1.0 / scale:.12g}"


def fitting_scale(most: float) -> float:
    """The largest of the standard scales, 1, 2 and 5 times powers of ten, that is at most `most`.

    >>> fitting_scale(0.73), fitting_scale(7.0), fitting_scale(0.0199999), fitting_scale(1.0)
    (0.5, 5.0, 0.01, 1.0)

    **Source**: ISO 5455:1979, 3.1.
    """
    decade = math.floor(math.log10(most * (1.0 + 1e-9)))
    for exponent in (decade, decade - 1):
        for mantissa in (5.0, 2.0, 1.0):
            scale = mantissa * 10.0**exponent if exponent >= 0 else mantissa / 10.0**-exponent
            if scale <= most * (1.0 + 1e-9):
                return scale
    raise AssertionError("a power of ten is at most the number whose logarithm it has")


def scales_below(most: float) -> Iterator[float]:
    """Standard scales and those between them that drawings have where a standard one would leave half of the paper empty, from the largest
    that is at most `most` to an eighth of it.

    >>> [scale_name(scale) for scale in scales_below(0.11)]
    ['1:10', '1:15', '1:20', '1:25', '1:40', '1:50']
    >>> [scale_name(scale) for scale in scales_below(4.5)]
    ['4:1', '2.5:1', '2:1', '1:1', '1:1.5']

    **Source**: ISO 5455:1979, 3.1 and 3.2 (intermediate scales where the standard ones do not do); GOST 2.302-68 (which).
    """
    decade = math.floor(math.log10(most))
    larger = [m * 10.0**k for k in range(max(decade - 1, 0), decade + 2) for m in (1.0, 2.0, 2.5, 4.0, 5.0)]
    smaller = [1.0 / (m * 10.0**k) for k in range(max(-decade - 2, 0), max(-decade + 2, 0)) for m in (1.5, 2.0, 2.5, 4.0, 5.0, 7.5, 10.0)]
    yield from sorted((scale for scale in larger + smaller if most / 8.0 <= scale <= most * (1.0 + 1e-9)), reverse=True)


def places(views: Sequence[str], angle: str) -> dict[str, tuple[int, int]]:
    """Column and row of each view, the front at (0, 0); what is no view along an axis gets a corner that is free."""
    return next(_arrangements(views, angle))


def _arrangements(views: Sequence[str], angle: str) -> Iterator[dict[str, tuple[int, int]]]:
    """The places of views, with those that are along no axis in one of the free corners after the other."""
    if angle not in ANGLES:
        raise UnsupportedError(f"projection must be one of {', '.join(ANGLES)}, got {angle!r}")
    sign = -1 if angle == "first" else 1
    found = {name: (sign * _THIRD[name][0], sign * _THIRD[name][1]) for name in views if name in _THIRD}
    if "back" in found:
        found["back"] = (2, 0)  # at the right end, in both
    free = [corner for corner in _CORNERS[angle] if corner not in found.values()]
    others = [name for name in views if name not in found]
    for corners in itertools.permutations(free, len(others)):
        yield {name: found[name] if name in found else corners[others.index(name)] for name in views}


def lay_out(
    sizes: Mapping[str, tuple[float, float]], angle: str, area: Area, gap: float, scale: float | None = None, paper: str = "the paper",
    below: float = 0.0, taken: Area | None = None,
) -> Layout:  # fmt: skip
    """Put views in line in the middle of an area.

    Parameters
    ----------
    sizes : mapping from str to (float, float)
        Width and height of each view, millimetres of the model.
    angle : "first" | "third"
    area : Area
    gap : float
        Between views, millimetres.
    scale : float, optional
        None: the largest standard scale that fits, or one between these where that leaves much of the paper empty.
    paper : str
        What an error calls the area.
    below : float
        By how much views may reach beyond the area's lower end, where they stay clear of what is taken.
    taken : Area, optional
    """
    arrangements = list(_arrangements(list(sizes), angle))
    rooms = [area] if below == 0.0 else [area, area.inset(0.0, 0.0, 0.0, -below)]
    tables = [(cells, _tracks(sizes, cells, 0), _tracks(sizes, cells, 1)) for cells in arrangements]
    if min(min(_left(rooms[-1], columns, rows, gap)) for _, columns, rows in tables) <= 0.0:
        raise SceneError(f"{paper} has no room for {len(sizes)} views: choose a larger one")
    most = max(_most(rooms[-1], columns, rows, gap) for _, columns, rows in tables)

    def made(wanted: float) -> Layout | None:
        for (cells, columns, rows), room in itertools.product(tables, rooms):
            if wanted > _most(room, columns, rows, gap) * (1.0 + 1e-9):
                continue
            for left in (0.5, 0.25, 0.0):
                layout = _layout(sizes, cells, columns, rows, room, gap, wanted, left)
                if taken is None or not any(_overlap(view, taken, gap) for view in layout.areas.values()):
                    return layout
        return None

    if scale is not None:
        layout = made(scale)
        if layout is None:
            fits = scale_name(_largest(made, most).scale)
            raise SceneError(f"at {scale_name(scale)} the views do not fit on {paper}: choose {fits} or a larger paper")
        return layout
    return _largest(made, most)


def _largest(made: Callable[[float], Layout | None], most: float) -> Layout:
    """The layout at the largest scale that is standard, unless one between the standard ones is much larger."""
    layouts = [layout for layout in map(made, scales_below(most)) if layout is not None]
    largest = layouts[0] if layouts else made(fitting_scale(most / 8.0))
    assert largest is not None
    for layout in layouts:
        if math.isclose(layout.scale, fitting_scale(layout.scale)):
            return layout if layout.scale > _FILLED * largest.scale else largest
    return largest


def _most(area: Area, columns: Mapping[int, float], rows: Mapping[int, float], gap: float) -> float:
    """The scale at which views fill an area."""
    wanted = sum(columns.values()), sum(rows.values())
    return min((have / need for have, need in zip(_left(area, columns, rows, gap), wanted, strict=True) if need > 0.0), default=1.0)


def _left(area: Area, columns: Mapping[int, float], rows: Mapping[int, float], gap: float) -> tuple[float, float]:
    """What gaps leave of an area's sides."""
    return area.width - gap * (len(columns) - 1), area.height - gap * (len(rows) - 1)


def _overlap(one: Area, other: Area, gap: float) -> bool:
    across = min(one.x + one.width, other.x + other.width) - max(one.x, other.x)
    down = min(one.y + one.height, other.y + other.height) - max(one.y, other.y)
    return across > -gap / 2.0 and down > -gap / 2.0


def _layout(
    sizes: Mapping[str, tuple[float, float]], cells: Mapping[str, tuple[int, int]], columns: Mapping[int, float],
    rows: Mapping[int, float], area: Area, gap: float, scale: float, left: float,
) -> Layout:  # fmt: skip
    across = _starts(columns, scale, gap, area.x, area.width, left)
    down = _starts(rows, scale, gap, area.y, area.height, 0.5)
    areas = {}
    for name, (width, height) in sizes.items():
        column, row = cells[name]
        w, h = width * scale, height * scale
        areas[name] = Area(across[column] + (columns[column] * scale - w) / 2.0, down[row] + (rows[row] * scale - h) / 2.0, w, h)
    return Layout(scale, areas)


def _tracks(sizes: Mapping[str, tuple[float, float]], cells: Mapping[str, tuple[int, int]], axis: int) -> dict[int, float]:
    """The columns (axis 0) or rows (1) that have views, and the greatest size in each."""
    found: dict[int, float] = {}
    for name, size in sizes.items():
        track = cells[name][axis]
        found[track] = max(found.get(track, 0.0), size[axis])
    return dict(sorted(found.items()))


def _starts(tracks: Mapping[int, float], scale: float, gap: float, first: float, room: float, share: float) -> dict[int, float]:
    """Where columns or rows begin, with a share of what room they leave before them."""
    total = sum(tracks.values()) * scale + gap * (len(tracks) - 1)
    at, starts = first + (room - total) * share, {}
    for track, size in tracks.items():
        starts[track] = at
        at += size * scale + gap
    return starts
