"""A page as PDF: real paths and words, layers that a reader can switch off, nothing else (ISO 32000-1).

    open("sheet.pdf", "wb").write(page_pdf(page))

Paths go into the file as they are; words are set in Helvetica, which every reader has, stretched to the length that they have in limner's
other pictures. There is no date and no random identifier: the same page is the same bytes.

**Source**: ISO 32000-1:2008: 7.5 (the file), 8.4.3 (line width, caps, joins, dashes), 8.5 (paths), 8.11 (optional content), 9.6.2.2
(standard fonts), 11.6.4.4 (constant alpha). Adobe, *Core 14 AFM files*, Helvetica (advance widths).
"""

from __future__ import annotations

import unicodedata
import zlib
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from .ink import Rgba, hex_from_linear
from .page import Caption, Dots, Mark, Page, Patch, Run, Trace, advance, runs
from .stroke import CAPS, JOINS, Pen
from .svg import number

__all__ = ["page_pdf"]

_POINTS = 72.0 / 25.4  # in a millimetre
_CAPS = dict(zip(CAPS, (0, 1, 2), strict=True))
_JOINS = dict(zip(JOINS, (0, 1, 2), strict=True))
_ARC = 0.5522847498  # of a quarter circle's radius: how far its control points lie from its ends

_WIDTHS = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 278, 278, 278, 556, 556, 556, 556, 556, 556, 556, 556, 556, 556, 278,
    278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667, 611, 722,
    667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556, 556,
    556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
]  # fmt: skip
_OTHER_WIDTHS = {"°": 400, "Ø": 778, "±": 584, "×": 584, "²": 333, "³": 333, "–": 556}


def page_pdf(page: Page) -> bytes:
    """Write a page as a PDF document.

    >>> page_pdf(Page(210, 297))[:8], b"[0 0 595.2756 841.8898]" in page_pdf(Page(210, 297))
    (b'%PDF-1.5', True)
    """
    finer = _POINTS * page.millimetres
    alphas: dict[float, str] = {}
    content = [f"{_precise(finer)} 0 0 {_precise(-finer)} 0 {number(page.height * finer)} cm"]
    if page.ground is not None:
        content += [*_ink(page.ground, alphas), f"0 0 {number(page.width)} {number(page.height)} re f"]
    for index, layer in enumerate(page.layers):
        content += [f"/OC /L{index} BDC", *(word for run in runs(layer) for word in _painted(run, alphas)), "EMC"]
    return _file(page, zlib.compress("\n".join(content).encode("latin-1"), 9), alphas, finer)


def _file(page: Page, content: bytes, alphas: dict[float, str], finer: float) -> bytes:
    """Objects 1 to 5 are the catalogue, the list of pages, the page, what it shows and the font; then come the layers."""
    layers = [f"{6 + index} 0 R" for index in range(len(page.layers))]
    shown = " ".join(layers)
    states = " ".join(f"/{name} << /CA {number(alpha)} /ca {number(alpha)} >>" for alpha, name in alphas.items())
    named = " ".join(f"/L{index} {layer}" for index, layer in enumerate(layers))
    resources = f"<< /Font << /F 5 0 R >> /ExtGState << {states} >> /Properties << {named} >> >>"
    box = f"[0 0 {number(page.width * finer)} {number(page.height * finer)}]"
    objects = [
        f"<< /Type /Catalog /Pages 2 0 R /OCProperties << /OCGs [{shown}] /D << /Order [{shown}] /ON [{shown}] >> >> >>".encode(),
        b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox {box} /Contents 4 0 R /Resources {resources} >>".encode(),
        b"<< /Length %d /Filter /FlateDecode >>\nstream\n%b\nendstream" % (len(content), content),
        b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
        *(f"<< /Type /OCG /Name ({layer.name}) >>".encode() for layer in page.layers),
        b"<< /Title %b /Producer (limner) >>" % _title(page.title),
    ]
    made, starts = bytearray(b"%PDF-1.5\n%\xe2\xe3\xcf\xd3\n"), []
    for index, body in enumerate(objects):
        starts.append(len(made))
        made += b"%d 0 obj\n%b\nendobj\n" % (index + 1, body)
    table = b"".join(b"%010d 00000 n \n" % start for start in starts)
    trailer = b"<< /Size %d /Root 1 0 R /Info %d 0 R >>" % (len(objects) + 1, len(objects))
    head = b"xref\n0 %d\n0000000000 65535 f \n" % (len(objects) + 1)
    return bytes(made) + head + table + b"trailer\n%b\nstartxref\n%d\n%%%%EOF\n" % (trailer, len(made))


def _title(words: str) -> bytes:
    return b"<" + b"\xfe\xff".hex().encode() + words.encode("utf-16-be", "replace").hex().encode() + b">"


def _precise(value: float) -> str:
    """A number of the page's scale, which all others are multiplied by."""
    return f"{value:.8f}".rstrip("0").rstrip(".")


# --- what is painted --------------------------------------------------------------------------------------------------------


def _painted(run: Run, alphas: dict[float, str]) -> Iterator[str]:
    """The marks of a run as one path, so that they are painted at once."""
    yield from _ink(run.color, alphas)
    if run.kind is Caption:
        yield from (word for mark in run.marks for word in _caption(mark))
        return
    if isinstance(run.style, Pen):
        yield from _pen(run.style)
    yield from (word for mark in run.marks for word in _path(mark))
    yield "S" if isinstance(run.style, Pen) else "f*" if run.style == "evenodd" else "f"


def _ink(color: Rgba, alphas: dict[float, str]) -> list[str]:
    """The colour of lines and areas, and how much of it there is."""
    text = hex_from_linear(color)
    codes = " ".join(number(int(text[at : at + 2], 16) / 255.0) for at in (1, 3, 5))
    return [f"{codes} RG {codes} rg", f"/{alphas.setdefault(color[3], f'A{len(alphas)}')} gs"]


def _pen(pen: Pen) -> list[str]:
    dashes = " ".join(number(dash) for dash in pen.dashes)
    return [
        f"{number(pen.width)} w {_CAPS[pen.cap]} J {_JOINS[pen.join]} j {number(pen.miter_limit)} M",
        f"[{dashes}] {number(pen.dash_offset)} d",
    ]


def _path(mark: Mark) -> list[str]:
    if isinstance(mark, Trace):
        return _lines(mark.points, mark.closed)
    if isinstance(mark, Patch):
        return [word for ring in mark.rings for word in _lines(ring, True)]
    assert isinstance(mark, Dots)
    places = zip(mark.centers.tolist(), mark.radii.tolist(), strict=True)
    return [word for (x, y), radius in places for word in _circle(x, y, radius)]


def _lines(points: ArrayLike, closed: bool) -> list[str]:
    made: Sequence[tuple[float, float]] = np.asarray(points, dtype=np.float64).tolist()
    words = [f"{number(x)} {number(y)} {'l' if index else 'm'}" for index, (x, y) in enumerate(made)]
    if len(made) == 1:
        words.append(words[0][:-1] + "l")  # a dot: its caps alone
    return [*words, "h"] if closed else words


def _circle(x: float, y: float, radius: float) -> list[str]:
    words = [f"{number(x + radius)} {number(y)} m"]
    c, s = 1.0, 0.0
    for _ in range(4):
        around = [(c - _ARC * s, s + _ARC * c), (_ARC * c - s, _ARC * s + c), (-s, c)]
        words.append(" ".join(f"{number(x + radius * a)} {number(y + radius * b)}" for a, b in around) + " c")
        c, s = -s, c
    return [*words, "h"]


def _caption(mark: Mark) -> list[str]:
    """Letters are upright where y points down, and as long together as in every other format."""
    assert isinstance(mark, Caption)
    words = mark.words.encode("cp1252", "replace").decode("cp1252")
    length, own = advance(words, mark.size), sum(map(_width, words)) * mark.size / 1000.0
    if not words.strip() or own <= 0.0:
        return []
    before = {"left": 0.0, "center": 0.5, "right": 1.0}[mark.align] * length
    x, y = (mark.x, mark.y + before) if mark.upward else (mark.x - before, mark.y)
    turn = "0 -1 -1 0" if mark.upward else "1 0 0 -1"
    spelled = words.encode("cp1252").hex()
    return [f"BT /F {number(mark.size)} Tf {number(100.0 * length / own)} Tz {turn} {number(x)} {number(y)} Tm <{spelled}> Tj ET"]


def _width(letter: str) -> int:
    """Of Helvetica, in thousandths of its size."""
    plain = unicodedata.normalize("NFD", letter)[0]
    return _OTHER_WIDTHS.get(letter, _WIDTHS[ord(plain) - 32] if 32 <= ord(plain) < 127 else 556)
