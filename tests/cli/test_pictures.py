"""`limner compare`, `verify` and `convert`: what they say, the codes they end with, the files they leave."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as Picture

import limner
from limner.cli.main import main
from limner.image.image import Image

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """A command line in this process, in an empty folder: code, standard output, standard error."""
    monkeypatch.chdir(tmp_path)

    def call(*words: object) -> tuple[int, str, str]:
        code = main([str(word) for word in words])
        said = capsys.readouterr()
        return code, said.out, said.err

    return call


def _picture(seed: int = 0, size: int = 16) -> Image:
    pixels = np.random.default_rng(seed).random((size, size, 4), dtype=np.float32)
    pixels[..., 3] = 1.0
    return Image(pixels, dpi=100.0)


def test_compare_tells_and_ends_with_a_code(run: Run) -> None:
    """0: equal; 1: they differ, or differ too much; 2: nothing to compare."""
    _picture().save("a.png")
    _picture().save("b.png")
    _picture(1).save("c.png")
    _picture(size=8).save("d.png")
    code, out, err = run("compare", "a.png", "b.png")
    assert (code, err) == (0, "")
    assert "n_different     0" in out
    assert run("compare", "a.png", "c.png")[0] == 1
    assert run("compare", "a.png", "c.png", "--fail-above", 1.0)[0] == 0
    code, _, err = run("compare", "a.png", "c.png", "--metric", "rmse", "--fail-above", 0.01)
    assert code == 1
    assert "rmse is 0." in err
    assert run("compare", "a.png", "c.png", "--metric", "psnr", "--fail-below", 1.0)[0] == 0
    assert run("compare", "a.png", "c.png", "--metric", "ssim", "--fail-below", 0.9)[0] == 1
    for words in (("a.png", "missing.png"), ("a.png", "d.png"), ("a.png", "b.png", "-o", "x.nope")):
        code, out, err = run("compare", *words)
        assert (code, out, err.count("\n")) == (2, "", 1)
    assert "use --fail-below" in run("compare", "a.png", "b.png", "--metric", "ssim", "--fail-above", 1)[2]
    assert "use --fail-above" in run("compare", "a.png", "b.png", "--fail-below", 1)[2]


def test_compare_as_json_and_picture(run: Run) -> None:
    """All measures as numbers, the infinite one as null; a picture of the difference."""
    _picture().save("a.png")
    _picture(1).save("c.png")
    code, out, _ = run("compare", "a.png", "c.png", "--json", "-o", "d.png")
    told = json.loads(out)
    assert (code, told["different"], told["n_different"]) == (1, True, 256)
    assert 0 < told["flip"] < 1
    assert limner.open_image("d.png").pixels.shape == (16, 16, 4)
    assert json.loads(run("compare", "a.png", "a.png", "--json")[1])["psnr"] is None


def test_render_then_verify(run: Run) -> None:
    """The recipe that `render` leaves is enough for `verify`; a picture without one is refused, a changed one found."""
    assert run("render", "teapot", "-o", "a.png", "--width", 16, "--height", 12, "--samples", 1, "--background", "white")[0] == 0
    assert run("verify", "a.png") == (0, "a.png: the same to the bit\n", "")
    assert json.loads(run("verify", "a.png", "--json")[1])["agrees"] is True
    code, out, err = run("verify", "a.png", "--model", "cornell")
    assert code == 1
    assert "pixels differ" in out
    assert "its digest differs" in err
    _picture().save("b.png")
    code, out, err = run("verify", "b.png")
    assert (code, out) == (2, "")
    assert "holds no recipe" in err


def test_convert_formats_and_sizes(run: Run, tmp_path: Path) -> None:
    """One side keeps the shape; light stays light; the recipe follows to another folder."""
    assert run("render", "teapot", "-o", "a.exr", "--width", 40, "--height", 30, "--samples", 1, "--aov", "depth")[0] == 0
    (tmp_path / "out").mkdir()
    code, _, err = run("convert", "a.exr", "out/b.png", "--width", 20, "--bits", 16)
    assert code == 0
    assert "left out: depth" in err
    made = limner.open_image("out/b.png")
    assert (made.width, made.height, made.recipe["model"]) == (20, 15, "teapot")
    assert run("convert", "a.exr", "c.exr", "--bits", 16) == (0, "", "")
    assert "depth" in limner.open_image("c.exr").aov


def test_convert_for_a_printer(run: Run) -> None:
    """One bit, at the printer's resolution, its size on paper told; without a resolution it cannot be screened."""
    _picture(size=60).save("a.png")
    code, _, err = run("convert", "a.png", "b.png", "--dpi", 600, "--halftone", 75, "--verbose")
    assert code == 0
    assert "on paper 2.5 x 2.5 mm at 600 dpi" in err
    with Picture.open("b.png") as picture:
        assert (picture.mode, picture.info["dpi"]) == ("1", pytest.approx((600, 600), abs=0.02))
    Image(np.ones((4, 4, 4), dtype=np.float32)).save("c.png")
    assert "--dpi" in run("convert", "c.png", "d.png", "--halftone", 75)[2]


@pytest.mark.parametrize(
    "words",
    [
        ("a.png", "b.nope"),
        ("missing.png", "b.png"),
        ("a.png", "b.png", "--width", 0),
        ("a.png", "b.jpg", "--bits", 16),
        ("a.png", "b.exr", "--dither", "random"),
    ],
)
def test_convert_refuses_in_one_line(run: Run, tmp_path: Path, words: tuple[Any, ...]) -> None:
    """And leaves no file."""
    _picture().save("a.png")
    code, out, err = run("convert", *words)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
