"""A page as DXF, the drawing format that every CAD program and every cutter reads (release 12, ASCII).

    open("sheet.dxf", "wb").write(page_dxf(page))

Coordinates are millimetres, x to the right, **y up**, from the page's lower left corner. Lines of two points are LINE, others POLYLINE,
dots CIRCLE, filled triangles SOLID, the outlines of other areas closed POLYLINEs, words TEXT. Each layer has its colour, of the nine that
every reader knows, and its line type; widths are not kept, since release 12 has them for polylines only, where cutters do not want them.

**Source**: Autodesk, *DXF Reference*, AutoCAD Release 12 (header, tables LTYPE, LAYER and STYLE, entities).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..color.transfer import srgb_from_linear
from .ink import Rgba
from .page import Caption, Dots, Layer, Mark, Page, Patch, Trace

__all__ = ["page_dxf"]

_COLORS = {
    1: (255, 0, 0), 2: (255, 255, 0), 3: (0, 255, 0), 4: (0, 255, 255), 5: (0, 0, 255), 6: (255, 0, 255), 7: (0, 0, 0), 8: (128, 128, 128),
    9: (192, 192, 192),
}  # fmt: skip
_ALIGNS = {"left": 0, "center": 1, "right": 2}
_CAPITALS = 0.72  # of a size: the height of capital letters, which TEXT is measured by
_SPECIAL = {"°": "%%d", "±": "%%p", "Ø": "%%c", "%": "%%%"}

Dashes = tuple[float, ...]


def page_dxf(page: Page) -> bytes:
    """Write a page as a DXF drawing.

    >>> from .stroke import Pen
    >>> line = Trace([(1, 1), (9, 4)], (0.0, 0.0, 0.0, 1.0), Pen())
    >>> b"LINE" in page_dxf(Page(10, 5, "mm", (Layer("outline", (line,)),)))
    True
    """
    scale = page.millimetres
    types = _line_types(page.layers, scale)
    size = page.width * scale, page.height * scale
    tags = [*_header(size), *_tables(page.layers, types, scale), *_tag(0, "SECTION"), *_tag(2, "ENTITIES")]
    for layer in page.layers:
        for mark in layer.marks:
            tags += _entity(mark, layer.name, scale, size[1])
    tags += [*_tag(0, "ENDSEC"), *_tag(0, "EOF")]
    return ("\n".join(tags) + "\n").encode("ascii")


def _tag(code: int, value: str | int | float) -> tuple[str, str]:
    return f"{code:3d}", f"{value:.6f}" if isinstance(value, float) else str(value)


def _header(size: tuple[float, float]) -> Iterator[str]:
    variables = (("$ACADVER", ((1, "AC1009"),)), ("$EXTMIN", ((10, 0.0), (20, 0.0))), ("$EXTMAX", ((10, size[0]), (20, size[1]))))
    yield from (*_tag(0, "SECTION"), *_tag(2, "HEADER"))
    for name, values in variables:
        yield from _tag(9, name)
        for code, value in values:
            yield from _tag(code, value)
    yield from _tag(0, "ENDSEC")


def _line_types(layers: tuple[Layer, ...], scale: float) -> dict[Dashes, str]:
    """The names of the dashes that layers have, in millimetres."""
    found: dict[Dashes, str] = {(): "CONTINUOUS"}
    for layer in layers:
        found.setdefault(_dashes(layer, scale), f"DASHED{len(found)}")
    return found


def _dashes(layer: Layer, scale: float) -> Dashes:
    """The longest of a layer's patterns: short lines have shorter ones, so as to fit them. Dashes of odd number count twice."""
    longest = max((mark.pen.dashes for mark in layer.marks if isinstance(mark, Trace)), key=sum, default=())
    return tuple(round(dash * scale, 4) for dash in longest * (1 + len(longest) % 2))


def _tables(layers: tuple[Layer, ...], types: dict[Dashes, str], scale: float) -> Iterator[str]:
    yield from (*_tag(0, "SECTION"), *_tag(2, "TABLES"))
    yield from (*_tag(0, "TABLE"), *_tag(2, "LTYPE"), *_tag(70, len(types)))
    for dashes, name in types.items():
        yield from (*_tag(0, "LTYPE"), *_tag(2, name), *_tag(70, 0), *_tag(3, name.lower()), *_tag(72, 65))
        yield from (*_tag(73, len(dashes)), *_tag(40, float(sum(dashes))))
        for index, dash in enumerate(dashes):
            yield from _tag(49, float(-dash if index % 2 else dash))  # gaps are negative
    yield from (*_tag(0, "ENDTAB"), *_tag(0, "TABLE"), *_tag(2, "LAYER"), *_tag(70, len(layers)))
    for layer in layers:
        kind = types[_dashes(layer, scale)]
        yield from (*_tag(0, "LAYER"), *_tag(2, layer.name), *_tag(70, 0), *_tag(62, _color(layer)), *_tag(6, kind))
    yield from (*_tag(0, "ENDTAB"), *_tag(0, "TABLE"), *_tag(2, "STYLE"), *_tag(70, 1))
    yield from (*_tag(0, "STYLE"), *_tag(2, "STANDARD"), *_tag(70, 0), *_tag(40, 0.0), *_tag(41, 1.0), *_tag(50, 0.0))
    yield from (*_tag(71, 0), *_tag(42, 2.5), *_tag(3, "txt"), *_tag(4, ""), *_tag(0, "ENDTAB"), *_tag(0, "ENDSEC"))


def _color(layer: Layer) -> int:
    """The number of the colour nearest to that of a layer's first mark."""
    color: Rgba = layer.marks[0].color if layer.marks else (0.0, 0.0, 0.0, 1.0)
    codes = srgb_from_linear(color[:3]) * 255.0
    return min(_COLORS, key=lambda index: (float(((codes - _COLORS[index]) ** 2).sum()), index))


# --- entities -------------------------------------------------------------------------------------------------------------


def _entity(mark: Mark, layer: str, scale: float, height: float) -> list[str]:
    """One mark; places are turned so that y points up."""

    def placed(points: ArrayLike) -> NDArray[np.float64]:
        return np.asarray(points, dtype=np.float64) * (scale, -scale) + (0.0, height)

    if isinstance(mark, Trace):
        return _line(placed(mark.points), layer, mark.closed)
    if isinstance(mark, Patch):
        if len(mark.rings) == 1 and len(mark.rings[0]) == 3:
            return _solid(placed(mark.rings[0]), layer)
        return [tag for ring in mark.rings for tag in _line(placed(ring), layer, True)]
    if isinstance(mark, Dots):
        circles = zip(placed(mark.centers), mark.radii * scale, strict=True)
        return [tag for center, radius in circles for tag in (*_begin("CIRCLE", layer), *_place(10, center), *_tag(40, float(radius)))]
    return _text(mark, placed([[mark.x, mark.y]])[0], mark.size * scale, layer)


def _begin(kind: str, layer: str) -> list[str]:
    return [*_tag(0, kind), *_tag(8, layer)]


def _place(code: int, point: NDArray[np.float64]) -> list[str]:
    return [*_tag(code, float(point[0])), *_tag(code + 10, float(point[1])), *_tag(code + 20, 0.0)]


def _line(points: NDArray[np.float64], layer: str, closed: bool) -> list[str]:
    if len(points) == 1:
        return [*_begin("POINT", layer), *_place(10, points[0])]
    if len(points) == 2:
        return [*_begin("LINE", layer), *_place(10, points[0]), *_place(11, points[1])]
    tags = [*_begin("POLYLINE", layer), *_tag(66, 1), *_place(10, np.zeros(2)), *_tag(70, int(closed))]
    for point in points:
        tags += [*_begin("VERTEX", layer), *_place(10, point)]
    return [*tags, *_begin("SEQEND", layer)]


def _solid(corners: NDArray[np.float64], layer: str) -> list[str]:
    """A triangle is a quadrilateral whose last corner comes twice."""
    places = [tag for index, corner in enumerate([*corners, corners[2]]) for tag in _place(10 + index, corner)]
    return [*_begin("SOLID", layer), *places]


def _text(mark: Caption, place: NDArray[np.float64], size: float, layer: str) -> list[str]:
    words = "".join(_SPECIAL.get(c) or (c if c.isascii() and c.isprintable() else f"\\U+{ord(c):04X}") for c in mark.words)
    if not words.strip():
        return []
    tags = [*_begin("TEXT", layer), *_place(10, place), *_tag(40, _CAPITALS * size), *_tag(1, words)]
    tags += _tag(50, 90.0 if mark.upward else 0.0)
    return tags if mark.align == "left" else [*tags, *_tag(72, _ALIGNS[mark.align]), *_place(11, place)]
