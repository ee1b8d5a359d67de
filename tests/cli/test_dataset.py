"""`limner dataset`: a folder from the command line, its codes, going on after a stop."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.image.image import Image
from limner.scene.camera import Camera
from limner.scene.library import builtin
from limner.scene.scene import Scene

SIZE = ("--width", "12", "--height", "9", "--samples", "1", "--views", "2")


def test_a_folder_from_all_around(limner_process: Callable[..., Any], tmp_path: Path) -> None:
    """As a process: two views of the teapot with what was asked; the JSON tells; again is refused, --resume has nothing to do."""
    words = ("dataset", "teapot", "-o", "views", *SIZE, "--aov", "depth", "--masks", "instance", "--json")
    done = limner_process(*words)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == {"finished": True, "output": "views", "rendered": 2, "views": 2, "warnings": []}
    listing = json.loads((tmp_path / "views/cameras.json").read_text())
    assert [view["name"] for view in listing["views"]] == ["orbit 0", "orbit 1"]
    with np.load(tmp_path / "views/arrays/000001.npz") as arrays:
        assert arrays["depth"].shape == (9, 12)
        assert np.isfinite(arrays["depth"]).any()
    assert len(list((tmp_path / "views").rglob("*.png"))) == 4
    again = limner_process(*words)
    assert (again.returncode, again.stdout) == (2, "")
    assert again.stderr == "limner: error: views holds a data set already: resume it, or choose another folder\n"
    assert json.loads(limner_process(*words, "--resume").stdout)["rendered"] == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--views", "0"), "--views"),
        (("--elevation", "91"), "--elevation"),
        (("--elevation", "nan"), "elevation_degrees must be finite"),
        (("--yfov", "180"), "--yfov must lie between 0 and 180 degrees, got 180"),
        (("--aov", "mood"), "aov must be one of"),
        (("--masks", "triangle"), "'triangle' is not one of"),
        (("--width", "32768", "--height", "32768"), "must not exceed"),
        (("-o", "file"), "is no folder"),
    ],
)
def test_a_slip_is_one_line(limner_process: Callable[..., Any], tmp_path: Path, words: tuple[str, ...], message: str) -> None:
    """Nothing is written, nothing but the line is said."""
    (tmp_path / "file").write_text("mine")
    done = limner_process("dataset", "cornell", "-o", "views", *SIZE, *words)
    assert done.returncode == (1 if message == "is no folder" else 2)
    assert done.stderr.startswith("limner: error: ")
    assert done.stderr.count("\n") == 1
    assert message in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


class _StoppedAtTheSecond:
    """A Renderer whose second picture is interrupted."""

    def __init__(self, scene: Scene, *, width: int, height: int, **_: object) -> None:
        self._size, self._n_made = (height, width), 0

    def render(self, camera: Camera, **_: object) -> Image:
        self._n_made += 1
        return Image(np.ones((*self._size, 4), dtype=np.float32), finished=self._n_made < 2)


def test_an_interrupt_keeps_what_is_finished(limner: Callable[..., Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The engine is stopped in its second picture: code 130, one view, and how to go on."""
    monkeypatch.setattr(sys.modules["limner.render"], "Renderer", _StoppedAtTheSecond, raising=False)
    monkeypatch.setattr("limner.cli.dataset.open_model", lambda _: builtin("cornell"))
    done = limner("dataset", "m", "-o", "views", *SIZE, "--aov", "", "--annotations", "none")
    assert done.code == 130
    assert done.err == "limner: interrupted: 1 of 2 views are in views; --resume goes on\n"
    assert len(json.loads((tmp_path / "views/cameras.json").read_text())["views"]) == 1
