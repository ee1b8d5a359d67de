"""`limner draw`, and lines and styles of `limner render`: as processes, with their codes and lines."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]

SIZE = ("--width", "48", "--height", "36")
BOX = """v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"""


@pytest.fixture
def box(tmp_path: Path) -> str:
    (tmp_path / "box.obj").write_text(BOX)
    return "box.obj"


def test_a_technical_sheet(limner_process: Run, tmp_path: Path, box: str) -> None:
    """Twice the same bytes, on A4, with its layers; JSON says what is on it."""
    words = ("draw", box, "--views", "front,top,right,iso", "--paper", "A4", "--unit", "cm", "--dimensions", "--quiet")
    done = limner_process(*words, "-o", "sheet.svg", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert (told["views"], told["scale"], told["size"]) == (["front", "top", "right", "iso"], "2:1", [20.0, 20.0, 20.0])
    assert limner_process(*words, "-o", "again.svg").returncode == 0
    assert (tmp_path / "sheet.svg").read_bytes() == (tmp_path / "again.svg").read_bytes()
    root = ET.parse(tmp_path / "sheet.svg").getroot()
    assert (root.get("width"), root.get("height")) == ("297mm", "210mm")
    names = [group.get("id") for group in root.findall("{http://www.w3.org/2000/svg}g")]
    assert {"dimensions", "notes", "border"} < set(names)


def test_lines_by_render(limner_process: Run, tmp_path: Path, box: str) -> None:
    """As vectors and as a picture, in a style."""
    for name, start in (("a.pdf", b"%PDF"), ("a.png", b"\x89PNG")):
        done = limner_process("render", box, "-o", name, "--renderer", "lines", "--style", "technical", *SIZE, "--quiet")
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        assert (tmp_path / name).read_bytes().startswith(start)


def test_tone_and_areas(limner_process: Run, tmp_path: Path, box: str) -> None:
    """They are layers under the lines."""
    done = limner_process("draw", box, "-o", "a.svg", "--style", "sketch", "--tone", "hatching", "--fill", *SIZE)
    assert done.returncode == 0, done.stderr
    names = [group.get("id") for group in ET.parse(tmp_path / "a.svg").getroot().findall("{http://www.w3.org/2000/svg}g")]
    assert names[:2] == ["areas", "hatching"]
    assert all(name and name.startswith("visible-") for name in names[2:])
    assert len(names) > 2


def test_a_style_of_a_picture(limner_process: Run, tmp_path: Path, box: str) -> None:
    """Cool to warm with lines differs from the plain picture."""
    assert limner_process("render", box, "-o", "a.png", *SIZE, "--style", "gooch", "--lines").returncode == 0
    assert limner_process("render", box, "-o", "b.png", *SIZE).returncode == 0
    assert (tmp_path / "a.png").read_bytes() != (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("draw", "cornell", "-o", "a.xyz"), ".svg, .pdf, .dxf"),
        (("draw", "cornell", "-o", "nowhere/a.svg"), "cannot write nowhere/a.svg: there is no folder"),
        (("draw", "cornell", "-o", "a.svg", "--variant", "winter"), "variant"),
        (("draw", "cornell", "-o", "a.svg", "--views", "side"), "a view must be one of front"),
        (("draw", "cornell", "-o", "a.svg", "--views", "front", "--fill"), "--views excludes"),
        (("draw", "cornell", "-o", "a.svg", "--scale", "1:2"), "perspective has no scale"),
        (("render", "cornell", "-o", "a.png", "--style", "sketch"), "--renderer raster, which has gooch, toon, xray"),
    ],
)
def test_a_slip_is_one_line(limner_process: Run, tmp_path: Path, words: tuple[str, ...], message: str) -> None:
    """Code 2, one line, nothing written."""
    done = limner_process(*words)
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith("limner: error: ")
    assert done.stderr.count("\n") == 1, done.stderr
    assert message in done.stderr
    assert not list(tmp_path.iterdir())
