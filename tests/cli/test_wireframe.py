"""`limner wireframe`: as a process, with its codes and lines."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as Picture

Run = Callable[..., Any]

SIZE = ("--width", "48", "--height", "36")
BOX = """v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"""


@pytest.fixture
def box(tmp_path: Path) -> str:
    (tmp_path / "box.obj").write_text(BOX)
    return "box.obj"


def lines_of(path: Path) -> int:
    return sum(element.get("d", "").count("M") for element in ET.parse(path).getroot().iter("{http://www.w3.org/2000/svg}path"))


def test_a_picture_of_lines(limner_process: Run, tmp_path: Path, box: str) -> None:
    """Black on white, of the asked size, and nothing is said."""
    done = limner_process("wireframe", box, "-o", "lines.png", *SIZE, "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    with Picture.open(tmp_path / "lines.png") as picture:
        assert picture.size == (48, 36)
        codes = np.asarray(picture.convert("RGB"))
    assert (codes[0, 0] == 255).all()
    assert codes.min() < 80
    assert (codes[..., 0] == codes[..., 2]).all()


def test_a_drawing_as_svg(limner_process: Run, tmp_path: Path, box: str) -> None:
    """Features are fewer than all edges, hidden ones are added in their colour; nothing else lies about."""
    assert limner_process("wireframe", box, "-o", "all.svg", *SIZE).returncode == 0
    assert limner_process("wireframe", box, "-o", "few.svg", *SIZE, "--edges", "features").returncode == 0
    assert limner_process("wireframe", box, "-o", "both.svg", *SIZE, "--edges", "features", "--hidden", "#c8ccd2").returncode == 0
    assert lines_of(tmp_path / "few.svg") < lines_of(tmp_path / "all.svg")
    assert lines_of(tmp_path / "few.svg") < lines_of(tmp_path / "both.svg")
    assert "#c8ccd2" in (tmp_path / "both.svg").read_text()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["all.svg", "both.svg", "box.obj", "few.svg"]


def test_lines_over_the_model_and_on_nothing(limner_process: Run, tmp_path: Path, box: str) -> None:
    """Red lines over grey; on a transparent ground there is nothing beside the lines."""
    assert limner_process("wireframe", box, "-o", "shaded.png", *SIZE, "--shaded", "--color", "#ff000080").returncode == 0
    with Picture.open(tmp_path / "shaded.png") as picture:
        codes = np.asarray(picture.convert("RGB")).astype(int)
    assert (codes[..., 0] - codes[..., 1] > 30).any()
    assert limner_process("wireframe", box, "-o", "clear.png", *SIZE, "--background", "transparent").returncode == 0
    with Picture.open(tmp_path / "clear.png") as picture:
        assert np.asarray(picture)[0, 0].tolist() == [0, 0, 0, 0]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("-o", "lines.xyz"), "or .svg"),
        (("-o", "nowhere/lines.svg"), "there is no folder"),
        (("-o", "lines.png", "--color", "purple"), "color must be black, white, #RGB"),
        (("-o", "lines.png", "--line-width", "0"), "--line-width"),
        (("-o", "lines.png", "--background", "environment"), "makes no sense here"),
        (("-o", "lines.png", "--edges", "some"), "--edges"),
        (("-o", "lines.png", "--target", "0,0,0"), "--target needs --eye"),
    ],
)
def test_a_slip_is_one_line(limner_process: Run, tmp_path: Path, words: tuple[str, ...], message: str) -> None:
    """Code 2, one line, nothing written."""
    done = limner_process("wireframe", "cornell", *words)
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith("limner: error: ")
    assert done.stderr.count("\n") == 1
    assert message in done.stderr
    assert not list(tmp_path.iterdir())
