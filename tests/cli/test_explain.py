"""`limner explain` on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from menagerie import menagerie
from staging import SLOW_AS_PYTHON

from limner.cli.explain import explain as explain_command
from limner.cli.main import main
from limner.cli.render import render as render_command
from limner.errors import UnsupportedError
from limner.explain.explain import explain
from limner.files.open_image import open_image
from limner.files.save_mesh import save_model
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


@SLOW_AS_PYTHON
@pytest.mark.parametrize(
    "words",
    [
        ["--renderer", "ray", "--time", "0.5", "--aperture", "0.1", "--sampler", "jittered", "--ground", "--background", "0.1,0.2,0.3"],
        ["--style", "gooch", "--time", "0.5", "--camera", "1", "--shading", "vertex", "--culling", "none", "--seed", "3"],
    ],
)
def test_the_words_of_render_tell_of_its_picture(words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With the very options of a picture, the pixel told is the pixel stored, to the bit."""
    model, picture = str(tmp_path / "model.glb"), str(tmp_path / "picture.exr")
    save_model(menagerie(), model)
    options = [*_SMALL, "--eye", "0.5,0.5,6", *words] if "--camera" not in words else [*_SMALL, *words]
    assert main(["render", model, "-o", picture, *options]) == 0
    pixels = open_image(picture).pixels
    y, x = next(zip(*np.nonzero(pixels[..., 3] == 1.0), strict=True))
    assert main(["explain", model, "--pixel", f"{x},{y}", "-o", str(tmp_path / "pixel.json"), *options]) == 0
    told = json.loads((tmp_path / "pixel.json").read_text(encoding="utf-8"))
    assert told["is_exact"] is True
    assert np.array(told["pixel"], dtype=np.float32).tobytes() == pixels[y, x].tobytes()


def test_explain_knows_every_option_that_decides_a_pixel() -> None:
    """What `render` has and `explain` has not says what becomes of the whole picture, not what a pixel is."""
    of_render, of_explain = ({option.name for option in command.params} for command in (render_command, explain_command))
    assert of_render - of_explain == {
        "lines", "noise", "time_limit", "snapshots", "resume", "aovs", "denoise", "color_space", "threads", "report", "as_json", "view",
        "exposure",
    }  # fmt: skip


@pytest.mark.parametrize("option", ["denoise", "noise", "time_limit"])
def test_what_looks_at_whole_pictures_is_refused(option: str) -> None:
    """A pixel that depends on its neighbours, or on a clock, has no story of its own."""
    with pytest.raises(UnsupportedError, match=f"explain tells of one pixel, and {option} looks at whole pictures"):
        explain("teapot", 3, 3, **{option: "filter" if option == "denoise" else 1.0})


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
