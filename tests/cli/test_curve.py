"""`limner curve`: as a process, with its codes and lines."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image as Picture

Run = Callable[..., Any]

SIZE = ("--width", "60", "--height", "40")


def test_a_curve_as_svg_keeps_its_control_points(limner_process: Run, tmp_path: Path) -> None:
    """A Bézier curve is one in the file; what is told of it is JSON."""
    done = limner_process("curve", "bezier", "-o", "curve.svg", "--points", "0,0 1,2 3,2 4,0", "--json", *SIZE)
    assert (done.returncode, done.stderr) == (0, "")
    assert "C" in (tmp_path / "curve.svg").read_text()
    told = json.loads(done.stdout)
    assert told["bounds"] == [[0.0, 0.0], [4.0, 1.5]]
    assert told["length"] == pytest.approx(5.268365543, abs=1e-8)  # of two hundred thousand chords


def test_a_fractal_as_pixels(limner_process: Run, tmp_path: Path) -> None:
    """The Mandelbrot set, of the asked size, and nothing is said."""
    done = limner_process("curve", "mandelbrot", "-o", "set.png", *SIZE)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    with Picture.open(tmp_path / "set.png") as picture:
        assert picture.size == (60, 40)
        assert picture.convert("RGB").getpixel((30, 20)) == (0, 0, 0)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("bspline", "-o", "a.png", "--points", "0,0 1,1"), "at least 4 control points"),
        (("bezier", "-o", "a.png", "--points", "0,0 x"), "--points takes"),
        (("bezier", "-o", "a.svg", "--points", "0,0 nan,1"), "finite"),
        (("bezier", "-o", "a.png", "--closed"), "--closed is for"),
        (("natural", "-o", "a.png", "--construction", "0.5"), "--construction"),
        (("fern", "-o", "a.svg"), "ask for .png"),
    ],
)
def test_a_slip_is_one_line(run_curve: Callable[..., tuple[int, str]], tmp_path: Path, words: tuple[str, ...], message: str) -> None:
    """Code 2, one line, nothing written."""
    code, said = run_curve(*words)
    assert code == 2
    assert said.startswith("limner: error: ")
    assert said.count("\n") == 1
    assert message in said
    assert not list(tmp_path.iterdir())


@pytest.fixture
def run_curve(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str]]:
    """The command line in this process, which starts faster."""
    from limner.cli.main import main

    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> tuple[int, str]:
        return main(["curve", *words]), capsys.readouterr().err

    return run
