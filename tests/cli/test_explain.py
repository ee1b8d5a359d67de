"""`limner explain` on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON

from limner.cli.main import main
from limner.render import render

_SMALL = ("--width", "32", "--height", "24", "--samples", "1")


@SLOW_AS_PYTHON
def test_text_json_and_page_tell_of_the_pictures_pixel(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """JSON has the bits of the stored pixel; the page needs nothing beside it; text can be cut at a depth."""
    command = ["explain", "cornell", "--pixel", "14,20", "--renderer", "ray", *_SMALL]
    for name in ("pixel.json", "pixel.html"):
        assert main([*command, "-o", str(tmp_path / name)]) == 0
    told = json.loads((tmp_path / "pixel.json").read_text(encoding="utf-8"))
    stored = render("cornell", width=32, height=24, renderer="ray", samples=1).pixels[20, 14]
    assert np.array(told["pixel"], dtype=np.float32).tobytes() == stored.tobytes()
    assert told["is_exact"] is True
    page = (tmp_path / "pixel.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")
    assert "<script" not in page
    assert page.count("<svg") >= 4
    assert not any(f'{attribute}="http' in page.replace('xmlns="http://www.w3.org/2000/svg"', "") for attribute in ("src", "href", "xmlns"))
    assert main([*command, "--levels", "1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("pixel (14, 20) by ray, 1 samples = (")
    assert all(line.startswith(("├─ ", "└─ ")) for line in lines[1:])


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--pixel", "32,0", *_SMALL], "--pixel 32,0 is not in a picture of 32 x 24"),
        (["--pixel", "1.5,0"], "expected a column and a row X,Y"),
        (["--pixel", "1,1", "--sample", "few"], 'expected a number or "all"'),
        (["--pixel", "1,1", "-o", "pixel.pdf"], "-o must end in .html, .json or .txt"),
        (["--pixel", "1,1", "--target", "0,0,0"], "--target needs --eye"),
        ([], "Missing option '--pixel'"),
    ],
)
def test_bad_calls_are_one_line(words: list[str], expected: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2, and what was expected."""
    assert main(["explain", "teapot", *words]) == 2
    error = capsys.readouterr().err
    assert expected in error
    assert len(error.strip().splitlines()) == 1
