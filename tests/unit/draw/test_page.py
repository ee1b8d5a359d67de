"""Pages: one drawing, four formats, the same picture by every reader, the same bytes every time."""

from __future__ import annotations

import io
import re
import zlib
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.draw.dxf import page_dxf
from limner.draw.page import Caption, Dots, Layer, Page, Patch, Trace, advance, page_image
from limner.draw.pdf import page_pdf
from limner.draw.stroke import Pen
from limner.draw.svg_page import page_svg
from limner.errors import SceneError, UnsupportedError

BLACK, RED = (0.0, 0.0, 0.0, 1.0), (0.8, 0.05, 0.05, 1.0)
SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
DPI = 127.0  # five dots in a millimetre


def page() -> Page:
    """Lines, dashes, an area with a hole, dots: 30 x 20 mm."""
    outline = Trace(np.array([(2.0, 2.0), (14.0, 2.0), (14.0, 9.0), (2.0, 9.0)]), BLACK, Pen(0.6, "round", "round"), True)
    dashed = [Trace(np.array([(2.0, y), (14.0, y + 4.0)]), BLACK, Pen(0.4, dashes=(2.0, 1.0))) for y in (11.0, 14.0)]
    hole = tuple(np.array(ring, dtype=float) for ring in ([(17, 2), (28, 2), (28, 9), (17, 9)], [(20, 4), (20, 7), (25, 7), (25, 4)]))
    wedge = Patch((np.array([(17.0, 12.0), (22.0, 12.0), (19.0, 17.0)]),), RED)
    dots = Dots(np.array([(25.0, 13.0), (27.0, 16.0)]), np.array([0.8, 1.2]), RED)
    layers = (Layer("outline", (outline,), ("visible", "crease")), Layer("hidden", dashed), Layer("areas", (Patch(hole, RED), wedge, dots)))
    return Page(30.0, 20.0, "mm", layers, "a part <1>", (1.0, 1.0, 1.0, 1.0))


def alike(theirs: NDArray[np.uint8], ours: NDArray[np.uint8]) -> None:
    """The same codes where nothing changes nearby, and on the whole."""
    assert theirs.shape == ours.shape
    difference = np.abs(theirs.astype(int) - ours.astype(int)).max(axis=2)
    around = np.lib.stride_tricks.sliding_window_view(ours.astype(int), (3, 3), axis=(0, 1))
    flat = np.ptp(around, axis=(-2, -1)).max(axis=-1) == 0
    assert flat.mean() > 0.5
    assert difference[1:-1, 1:-1][flat].max() <= 1
    assert (difference > 100).mean() < 0.02


def test_another_program_draws_the_svg() -> None:
    """By resvg, in millimetres: the picture that the page is."""
    resvg = pytest.importorskip("resvg_py", reason="needs resvg-py: an independent renderer of SVG")
    from PIL import Image as Pictures

    data = bytes(resvg.svg_to_bytes(svg_string=page_svg(page()), dpi=int(DPI)))
    alike(np.asarray(Pictures.open(io.BytesIO(data)).convert("RGB")), page_image(page(), DPI).to_uint8()[..., :3])


def test_another_program_draws_the_pdf() -> None:
    """By pdfium: the picture that the page is, on a page of its size, with its layers' names and its title."""
    pdfium = pytest.importorskip("pypdfium2", reason="needs pypdfium2: an independent reader of PDF")
    document = pdfium.PdfDocument(page_pdf(page()))
    assert np.allclose(document[0].get_size(), np.array([30.0, 20.0]) / 25.4 * 72.0, atol=1e-3)
    assert document.get_metadata_value("Title") == "a part <1>"
    alike(np.asarray(document[0].render(scale=DPI / 72.0).to_pil().convert("RGB"))[:, :150], page_image(page(), DPI).to_uint8()[..., :3])


def test_the_pdf_is_whole() -> None:
    """Every object begins where the table says, every layer has a name, and what is shown can be read without any library."""
    data = page_pdf(page())
    start = int(re.findall(rb"startxref\n(\d+)\n%%EOF\n$", data)[0])
    entries = re.findall(rb"(\d{10}) 00000 n \n", data[start:])
    assert len(entries) == 9
    for number, entry in enumerate(entries, 1):
        assert data[int(entry) :].startswith(b"%d 0 obj\n" % number)
    assert re.findall(rb"/Type /OCG /Name \((\w+)\)", data) == [b"outline", b"hidden", b"areas"]
    length = int(re.findall(rb"/Length (\d+)", data)[0])
    begin = data.index(b"stream\n") + 7
    shown = zlib.decompress(data[begin : begin + length]).decode()
    assert shown.count(" BDC") == shown.count("EMC") == 3
    assert shown.count("\nS\n") == 2  # the dashed lines are one stroke: where they cross they are no darker
    assert "[2 1] 0 d" in shown


def test_another_program_reads_the_dxf() -> None:
    """By ezdxf: no errors, lengths in millimetres with y up, layers with their colours and dashes."""
    ezdxf = pytest.importorskip("ezdxf", reason="needs ezdxf: an independent reader of DXF")
    document = ezdxf.read(io.StringIO(page_dxf(page()).decode()))
    assert not document.audit().errors
    space = document.modelspace()
    lines = [(tuple(line.dxf.start)[:2], tuple(line.dxf.end)[:2]) for line in space.query("LINE")]
    assert lines == [((2.0, 9.0), (14.0, 5.0)), ((2.0, 6.0), (14.0, 2.0))]
    outline = space.query("POLYLINE")[0]
    assert outline.is_closed
    assert [tuple(point)[:2] for point in outline.points()] == [(2.0, 18.0), (14.0, 18.0), (14.0, 11.0), (2.0, 11.0)]
    assert [circle.dxf.radius for circle in space.query("CIRCLE")] == [0.8, 1.2]
    assert len(space.query("SOLID")) == 1
    assert document.layers.get("hidden").dxf.linetype != document.layers.get("outline").dxf.linetype
    assert document.layers.get("areas").color == 1


def test_layers_are_named_groups() -> None:
    """With classes, as layers of Inkscape, with lengths in millimetres, each line a path of its own."""
    root = ElementTree.fromstring(page_svg(page()))
    assert (root.get("width"), root.get("viewBox")) == ("30mm", "0 0 30 20")
    groups = {group.get("id"): group for group in root.findall(f"{SVG}g")}
    assert list(groups) == ["outline", "hidden", "areas"]
    assert groups["outline"].get("class") == "visible crease"
    assert groups["outline"].get(f"{INKSCAPE}groupmode") == "layer"
    assert len(list(groups["hidden"].iter(f"{SVG}path"))) == 2
    assert root.findtext(f"{SVG}title") == "a part <1>"


def test_crossings_are_no_darker() -> None:
    """Two lines of half a colour that cross: where they do, half a colour."""
    half = (0.0, 0.0, 0.0, 0.5)
    cross = [Trace(np.array(ends, dtype=float), half, Pen(2.0)) for ends in ([(0, 5), (10, 5)], [(5, 0), (5, 10)])]
    drawn = page_image(Page(10, 10, "px", (Layer("cross", cross),)))
    assert np.allclose(drawn.pixels[4:6, 4:6, 3], 0.5)
    assert 'opacity="0.5"' in page_svg(Page(10, 10, "px", (Layer("cross", cross),)))


def test_words_run_as_far_in_every_format() -> None:
    """Level and upright: where letters lie, by the picture; how long they are, by what the files say."""
    words = [Caption("Scale 1:2", 15.0, 6.0, 4.0, BLACK, "center"), Caption("12.5", 28.0, 18.0, 4.0, BLACK, upward=True)]
    sheet = Page(30.0, 20.0, "mm", (Layer("words", words),))
    alpha = page_image(sheet, 254.0).pixels[..., 3]
    level = np.argwhere(alpha[:, :240] > 0.5) / 10.0
    length = advance("Scale 1:2", 4.0)
    assert np.abs(level[:, 1].min() - (15.0 - length / 2.0)) < 0.5
    assert np.abs(level[:, 1].max() - (15.0 + length / 2.0)) < 0.5
    upright = np.argwhere(alpha[:, 240:] > 0.5) / 10.0
    assert np.abs(upright[:, 0].max() - 18.0) < 0.8
    assert np.abs(upright[:, 0].min() - (18.0 - advance("12.5", 4.0))) < 0.8
    assert 27.5 < 24.0 + upright[:, 1].max() < 28.3
    svg = page_svg(sheet)
    assert f'textLength="{length:.4f}"'.rstrip('0"') in svg
    assert 'transform="rotate(-90 28 18)"' in svg
    assert b"TEXT" in page_dxf(sheet)


def test_the_same_page_is_the_same_bytes() -> None:
    """In each format, made twice."""
    for write in (page_svg, page_pdf, page_dxf):
        assert write(page()) == write(page())


def test_slips() -> None:
    """One line each."""
    with pytest.raises(SceneError, match="sides must be positive"):
        Page(0.0, 10.0)
    with pytest.raises(UnsupportedError, match="mm, px"):
        Page(1.0, 1.0, "inch")
    with pytest.raises(SceneError, match="one name"):
        Page(1.0, 1.0, "mm", (Layer("a", ()), Layer("a", ())))
    with pytest.raises(SceneError, match="letters, digits"):
        Layer("a b", ())
    with pytest.raises(SceneError, match="dpi must be positive"):
        page_image(Page(1.0, 1.0), 0.0)
