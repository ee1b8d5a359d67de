"""A page as SVG: its layers as named groups that drawing programs show as layers, its lengths in millimetres (SVG 1.1).

    <svg width="210mm" height="297mm" viewBox="0 0 210 297">
    <g id="visible" class="visible" inkscape:groupmode="layer" inkscape:label="visible">
    <g fill="none" stroke="#000000" stroke-width="0.5">
    <path d="M20 20L60 20"/>

One unit of the coordinates is one millimetre (or pixel) of the page, so that what is measured in the file is what is printed. Each line
is a path of its own, to be chosen and moved; what lines have in common stands once, on the group round them, opacity, too: where lines of
one look cross, they are no darker. Numbers have at most four decimals, and there is no date: the same page is the same text.
"""

from __future__ import annotations

from collections.abc import Iterator
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import ArrayLike

from .page import Caption, Dots, Layer, Mark, Page, Patch, Run, Trace, advance, runs
from .stroke import Pen
from .svg import number, paint, pairs, pen_attributes, plain_words
from .text import Text, family

__all__ = ["page_svg"]

_ANCHORS = {"left": "start", "center": "middle", "right": "end"}
_INKSCAPE = "http://www.inkscape.org/namespaces/inkscape"


def page_svg(page: Page) -> str:
    """Write a page as an SVG document.

    >>> from .page import Layer
    >>> line = Trace([(1, 1), (9, 4)], (0.0, 0.0, 0.0, 1.0), Pen(0.5))
    >>> print(page_svg(Page(10, 5, "mm", (Layer("outline", (line,)),))), end="")
    <svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" \
width="10mm" height="5mm" viewBox="0 0 10 5">
    <g id="outline" inkscape:groupmode="layer" inkscape:label="outline">
    <path fill="none" stroke="#000000" stroke-width="0.5" d="M1 1L9 4"/>
    </g>
    </svg>
    """
    width, height = number(page.width), number(page.height)
    unit = "" if page.unit == "px" else page.unit
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="{_INKSCAPE}" width="{width}{unit}" height="{height}{unit}"'
        f' viewBox="0 0 {width} {height}">'
    ]
    if page.title:
        lines.append(f"<title>{plain_words(page.title)}</title>")
    if page.ground is not None and page.ground[3] > 0.0:
        lines.append(f'<rect width="{width}" height="{height}"{paint("fill", page.ground)}/>')
    for layer in page.layers:
        lines += _group(layer)
    return "\n".join([*lines, "</svg>"]) + "\n"


def _group(layer: Layer) -> Iterator[str]:
    classes = f" class={quoteattr(' '.join(layer.classes))}" if layer.classes else ""
    yield f'<g id="{layer.name}"{classes} inkscape:groupmode="layer" inkscape:label="{layer.name}">'
    for run in runs(layer):
        look = _look(run)
        elements = [element for mark in run.marks for element in _elements(mark)]
        if len(elements) == 1:
            name, rest = elements[0].split(" ", 1)
            yield f"{name}{look} {rest}"
        elif elements:
            yield f"<g{look}>"
            yield from elements
            yield "</g>"
    yield "</g>"


def _look(run: Run) -> str:
    """What the marks of a run have in common; `opacity` is of them together."""
    opacity = "" if run.color[3] == 1.0 else f' opacity="{number(run.color[3])}"'
    opaque = (*run.color[:3], 1.0)
    if isinstance(run.style, Pen):
        width = f' stroke-width="{number(run.style.width)}"' if run.style.width == 1.0 else ""
        return f' fill="none"{paint("stroke", opaque)}{width}{pen_attributes(run.style)}{opacity}'
    rule = ' fill-rule="evenodd"' if run.style == "evenodd" else ""
    letters = f" font-family={quoteattr(family(Text('', 16.0)))}" if run.kind is Caption else ""
    return f"{paint('fill', opaque)}{rule}{letters}{opacity}"


def _elements(mark: Mark) -> list[str]:
    if isinstance(mark, Trace):
        return [f'<path d="{_data(mark.points, mark.closed)}"/>']
    if isinstance(mark, Patch):
        return [f'<path d="{"".join(_data(ring, True) for ring in mark.rings)}"/>']
    if isinstance(mark, Dots):
        return [
            f'<circle cx="{number(x)}" cy="{number(y)}" r="{number(radius)}"/>'
            for (x, y), radius in zip(mark.centers.tolist(), mark.radii.tolist(), strict=True)
        ]
    if not mark.words.strip():
        return []
    place = f'x="{number(mark.x)}" y="{number(mark.y)}"'
    turned = f' transform="rotate(-90 {number(mark.x)} {number(mark.y)})"' if mark.upward else ""
    length = number(advance(mark.words, mark.size))
    fitted = f'textLength="{length}" lengthAdjust="spacingAndGlyphs" xml:space="preserve"'
    return [
        f'<text {place} font-size="{number(mark.size)}" text-anchor="{_ANCHORS[mark.align]}"{turned} {fitted}>'
        f"{plain_words(mark.words)}</text>"
    ]


def _data(points: ArrayLike, closed: bool) -> str:
    made = np.asarray(points, dtype=np.float64)
    if len(made) == 1:
        made = np.vstack([made, made])  # a dot: its caps alone
    return f"M{'L'.join(pairs(point) for point in made)}{'Z' if closed else ''}"
