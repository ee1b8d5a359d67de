"""`limner chart`: as a process, with its codes and lines."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image as Picture

from limner.cli.chart import CHARTS
from limner.cli.main import main
from limner.produce import charts

Run = Callable[..., Any]

SIZE = ("--width", "240", "--height", "200")


def test_the_command_line_knows_every_chart() -> None:
    """What is chosen from is what there is."""
    assert charts.CHARTS == CHARTS


def test_a_chart_as_picture_and_as_svg(limner_process: Run, tmp_path: Path) -> None:
    """Of the asked size, and nothing is said; a drawing by its extension."""
    done = limner_process("chart", "illuminants", "-o", "lamps.png", "--lights", "A,3200K", *SIZE)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    with Picture.open(tmp_path / "lamps.png") as opened:
        assert opened.size == (240, 200)
    done = limner_process("chart", "chromaticity", "-o", "xy.svg", "--points", "0.3,0.3 0.4,0.4", "--gamuts", "srgb,acescg", *SIZE)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "xy.svg").read_text().startswith("<svg")


def test_the_answer_to_the_gamma_chart(limner_process: Run) -> None:
    """The code 186 was as bright as the board: 2.20."""
    done = limner_process("chart", "gamma", "--grey", "186")
    assert (done.returncode, done.stdout, done.stderr) == (0, "gamma 2.20\n", "")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("chromaticity", "-o", "a.png", "--gamuts", "nope"), "display_p3"),
        (("chromaticity", "-o", "a.png", "--points", "1"), "--points takes pairs"),
        (("illuminants", "-o", "a.png", "--lights", "F2"), "D65"),
        (("cones", "-o", "a.txt"), "or .svg"),
        (("cones",), "nothing was asked for"),
        (("cones", "--grey", "3"), "the answer to the chart gamma"),
        (("gamma", "--grey", "300"), "between 0 and 255"),
    ],
)
def test_bad_words_get_one_line(words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Code 2, one line that says what was expected, and no file."""
    assert main(["chart", *words]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert said in told
    assert not Path("a.png").exists()
