"""A canvas as SVG: the same commands as vectors, so that a chart can be printed at any size (SVG 1.1).

Curves stay curves and arcs stay arcs; numbers are written with at most four decimals, so that the same drawing gives the same
text. Three things differ from the pixels of the canvas: viewers mix colours as sRGB codes and not as light, which shows where
something is transparent and along edges; they set text in a face of their own where they lack the canvas's, squeezed to the
same length; and triangles whose corners differ in colour, which SVG has no means for, are a picture of the canvas's size.
"""

from __future__ import annotations

import base64
import math
import re
from collections.abc import Sequence
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from ..image.image import Image
from ..image.png import png_bytes
from .canvas import Canvas, Command, Filled, Pasted, Segments, Stroked, Triangles, Written
from .coverage import Bounds
from .ink import Rgba, hex_from_linear
from .path import Arc, Cubic, Lines, Path
from .stroke import Pen
from .text import family, measure

__all__ = ["number", "paint", "pairs", "path_data", "pen_attributes", "plain_words", "svg"]

_FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # what XML 1.0 cannot hold


def svg(commands: Sequence[Command], width: int, height: int, background: Rgba = (0.0, 0.0, 0.0, 0.0)) -> str:
    """Write commands as an SVG document, with a canvas of width x height pixels.

    >>> canvas = Canvas(20, 10).rectangle(1, 1, 8, 4, fill="#ff0000")
    >>> print(canvas.svg())
    <svg xmlns="http://www.w3.org/2000/svg" width="20" height="10" viewBox="-0.5 -0.5 20 10">
    <path d="M1 1L9 1L9 5L1 5Z" fill="#ff0000"/>
    </svg>
    """
    clips: dict[Bounds, str] = {}
    lines = []
    if background[3] > 0.0:
        lines.append(f'<rect x="-0.5" y="-0.5" width="{width}" height="{height}"{paint("fill", background)}/>')
    for command in commands:
        drawn = _elements(command, width, height)
        if command.clip is not None and drawn:
            name = clips.setdefault(command.clip, f"clip{len(clips)}")
            drawn = [f'<g clip-path="url(#{name})">', *drawn, "</g>"]
        lines += drawn
    defined = [_clip_path(bounds, name) for bounds, name in clips.items()]
    if defined:
        defined = ["<defs>", *defined, "</defs>"]
    size = f'width="{width}" height="{height}" viewBox="-0.5 -0.5 {width} {height}"'
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" {size}>', *defined, *lines, "</svg>"]) + "\n"


def path_data(path: Path) -> str:
    """The path in SVG's own words: the value of the attribute `d`.

    >>> path_data(Path().move_to(0, 0).cubic_to(1, 0, 2, 1, 2, 2).close())
    'M0 0C1 0 2 1 2 2Z'
    """
    words = []
    for subpath in path.subpaths:
        words.append("M" + pairs(subpath.start[None, :]))
        for piece in subpath.pieces:
            if isinstance(piece, Lines):
                words += ["L" + pairs(point[None, :]) for point in piece.points]
            elif isinstance(piece, Cubic):
                words.append("C" + pairs(piece.points))
            else:
                words.append(_arc(piece))
        if subpath.closed:
            words.append("Z")
    return "".join(words)


def _arc(arc: Arc) -> str:
    """SVG names an arc by its ends, so that a whole turn needs two."""
    if not (arc.radii > 0.0).all():
        return "".join("L" + pairs(point[None, :]) for point in arc.flattened(arc.center, 0.01))
    parts = max(1, math.ceil(abs(arc.sweep) / (0.999 * math.pi)))
    radii = f"{number(arc.radii[0])} {number(arc.radii[1])} {number(math.degrees(arc.rotation))}"
    clockwise = 1 if arc.sweep > 0.0 else 0
    ends = arc.at(arc.start + arc.sweep * np.arange(1, parts + 1) / parts)
    return "".join(f"A{radii} 0 {clockwise} {pairs(end[None, :])}" for end in ends)


def _elements(command: Command, width: int, height: int) -> list[str]:
    if isinstance(command, Filled):
        rule = ' fill-rule="evenodd"' if command.rule == "evenodd" else ""
        return [f'<path d="{path_data(command.path)}"{paint("fill", command.color)}{rule}/>']
    if isinstance(command, Stroked):
        return [f'<path d="{path_data(command.path)}" fill="none"{paint("stroke", command.color)}{pen_attributes(command.pen)}/>']
    if isinstance(command, Segments):
        return _segments(command)
    if isinstance(command, Triangles):
        return _triangles(command, width, height)
    if isinstance(command, Written):
        return _text(command)
    return [_picture(command)]


def _segments(command: Segments) -> list[str]:
    """Lines of one opaque colour are one path; others lie one over the other."""
    style = pen_attributes(command.pen)
    words = [f"M{pairs(line[None, :2])}L{pairs(line[None, 2:])}" for line in command.lines]
    if len(words) and (command.colors == command.colors[0]).all() and command.colors[0, 3] == 1.0:
        words, colors = ["".join(words)], command.colors[:1]
    else:
        colors = command.colors
    return [
        f'<path d="{word}" fill="none"{paint("stroke", _straight(color))}{style}/>'
        for word, color in zip(words, colors, strict=True)
    ]


def _triangles(command: Triangles, width: int, height: int) -> list[str]:
    if (command.colors == command.colors[:, :1]).all():
        return [
            f'<path d="M{"L".join(pairs(point[None, :]) for point in corners)}Z"{paint("fill", _straight(colors[0]))}/>'
            for corners, colors in zip(command.corners, command.colors, strict=True)
        ]
    alpha = command.colors[..., 3:]
    straight = command.colors / np.where(alpha > 0.0, alpha, 1.0)
    straight[..., 3:] = alpha
    layer = Canvas(width, height).triangles(command.corners, straight)
    return [_picture(Pasted(layer.image(), 0, 0, None))]


def _text(command: Written) -> list[str]:
    text = command.text
    style = f'font-family={quoteattr(family(text))} font-size="{number(text.size)}"{paint("fill", command.color)}'
    return [
        f'<text x="{number(line.x)}" y="{number(line.y)}" textLength="{number(line.advance)}" xml:space="preserve"'
        f' lengthAdjust="spacingAndGlyphs" {style}>{plain_words(line.words)}</text>'
        for line in measure(text, command.x, command.y).lines
        if line.words.strip()
    ]


def plain_words(text: str) -> str:
    """A text as the content of an element."""
    return escape(_FORBIDDEN.sub("\ufffd", text))


def _picture(command: Pasted) -> str:
    image: Image = command.image
    data = base64.b64encode(png_bytes(image.to_uint8())).decode("ascii")
    place = f'x="{number(command.x - 0.5)}" y="{number(command.y - 0.5)}" width="{image.width}" height="{image.height}"'
    return f'<image {place} href="data:image/png;base64,{data}"/>'


def _clip_path(bounds: Bounds, name: str) -> str:
    left, top, right, bottom = bounds
    size = f'width="{number(max(0.0, right - left))}" height="{number(max(0.0, bottom - top))}"'
    return f'<clipPath id="{name}"><rect x="{number(left)}" y="{number(top)}" {size}/></clipPath>'


def _straight(premultiplied: np.ndarray) -> Rgba:
    r, g, b, a = premultiplied.tolist()
    return (r / a, g / a, b / a, a) if a > 0.0 else (0.0, 0.0, 0.0, 0.0)


def paint(what: str, color: Rgba) -> str:
    """The attributes of a colour: `what` is "fill" or "stroke"."""
    opacity = "" if color[3] == 1.0 else f' {what}-opacity="{number(color[3])}"'
    return f' {what}="{hex_from_linear(color)}"{opacity}'


def pen_attributes(pen: Pen) -> str:
    """The attributes that differ from SVG's own defaults."""
    words = [f' stroke-width="{number(pen.width)}"'] if pen.width != 1.0 else []
    if pen.cap != "butt":
        words.append(f' stroke-linecap="{pen.cap}"')
    if pen.join != "miter":
        words.append(f' stroke-linejoin="{pen.join}"')
    if pen.miter_limit != 4.0:
        words.append(f' stroke-miterlimit="{number(pen.miter_limit)}"')
    if pen.dashes:
        words.append(f' stroke-dasharray="{" ".join(map(number, pen.dashes))}"')
        if pen.dash_offset:
            words.append(f' stroke-dashoffset="{number(pen.dash_offset)}"')
    return "".join(words)


def pairs(points: np.ndarray) -> str:
    """Coordinates one after the other."""
    return " ".join(number(value) for value in points.ravel().tolist())


def number(value: float) -> str:
    """A number with at most four decimals, and no more than it needs."""
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
