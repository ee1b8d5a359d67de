"""`limner turntable`, `limner views`, `limner thumbnails`: as processes, with their codes, lines and JSON."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image as Picture

Run = Callable[..., Any]

TURN = ("turntable", "cornell", "--frames", "3", "--width", "16", "--height", "12", "--samples", "1")
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.mark.parametrize("name", ["clip.gif", "clip.webp", "clip.png"])
def test_a_clip_plays(limner_process: Run, tmp_path: Path, name: str) -> None:
    """Three pictures of the asked size, for ever; the JSON tells; nothing else lies about."""
    done = limner_process(*TURN, "-o", name, "--fps", "10", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert (told["frames"], told["fps"], told["seconds"], told["finished"]) == (3, 10.0, 0.3, True)
    with Picture.open(tmp_path / name) as clip:
        assert (clip.n_frames, clip.size, clip.info["loop"]) == (3, (16, 12), 0)
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_folder_of_frames(limner_process: Run, tmp_path: Path) -> None:
    """Without extension: numbered pictures; quietly."""
    done = limner_process(*TURN, "-o", "frames", "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert sorted(path.name for path in (tmp_path / "frames").iterdir()) == ["0000.png", "0001.png", "0002.png"]


def test_transparency_that_is_lost_is_told_of(limner_process: Run) -> None:
    """A GIF has none: white is behind the model, and a line says so."""
    done = limner_process(*TURN, "-o", "clip.gif", "--background", "transparent")
    assert done.returncode == 0
    assert "limner: warning: GIF has no transparency: white is behind the model" in done.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((*TURN, "-o", "clip.avi"), "a clip must be .gif, .webp, .png"),
        ((*TURN, "-o", "clip.gif", "--fps", "60"), "at most 50 in GIF, got 60"),
        ((*TURN, "-o", "clip.gif", "--fps", "nan"), "fps must be above 0"),
        ((*TURN, "-o", "clip.gif", "--frames", "0"), "--frames"),
        ((*TURN, "-o", "clip.gif", "--yfov", "180"), "--yfov must lie between 0 and 180 degrees, got 180"),
        ((*TURN, "-o", "nowhere/clip.gif"), "there is no folder"),
        (("turntable", "nothing.glb", "-o", "clip.gif"), "there is no file 'nothing.glb'"),
        (("views", "cornell"), "give -o, --json or both"),
        (("views", "cornell", "-o", "-", "--json"), "both want standard output"),
        (("views", "cornell", "-o", "sheet.xyz"), "the extension of 'sheet.xyz' must be one of"),
        (("views", "cornell", "-o", "sheet.png", "--size", "64"), "--size"),
        (("thumbnails", "nowhere", "-o", "out"), "there is no folder nowhere"),
        (("thumbnails", ".", "-o", "out"), "there is no model in ."),
        (("thumbnails", ".", "-o", "out", "--sheet", "nowhere/index.png"), "there is no folder"),
        (("thumbnails", ".", "-o", "out", "--background", "environment"), "makes no sense here"),
    ],
)
def test_a_slip_is_one_line(limner_process: Run, tmp_path: Path, words: tuple[str, ...], message: str) -> None:
    """Code 2, one line, nothing written."""
    done = limner_process(*words)
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith("limner: error: ")
    assert done.stderr.count("\n") == 1
    assert message in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name != "posix", reason="sends an interrupt as POSIX knows it")
@pytest.mark.parametrize("name", ["clip.gif", "clip.webp", "clip.png"])
def test_ctrl_c_leaves_no_half_a_clip(limner_process: Run, tmp_path: Path, name: str) -> None:
    """A turn of minutes, interrupted: within seconds code 130 and a line, the old file as it was, nothing beside it."""
    assert limner_process(*TURN, "-o", "warm.gif").returncode == 0  # all is compiled now
    (tmp_path / "warm.gif").unlink()
    (tmp_path / name).write_text("old")
    words = ("turntable", "cornell", "-o", name, "--frames", "5000", "--width", "320", "--height", "240")
    with subprocess.Popen([sys.executable, "-m", "limner", *words], stderr=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        try:
            time.sleep(2.0)
            process.send_signal(signal.SIGINT)
            _, said = process.communicate(timeout=20)
        finally:
            process.kill()
    assert process.returncode == 130, said
    assert "limner: interrupted: nothing was written" in said
    assert "Traceback" not in said
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [(name, "old")]


def test_views_make_a_sheet_and_facts(limner_process: Run, tmp_path: Path) -> None:
    """The sheet opens, its views are where the JSON says, and the JSON has what a reviewer asks for; alone, it writes no file."""
    words = ("views", "cornell", "--size", "128", "--samples", "1", "--json")
    done = limner_process(*words, "-o", "sheet.png")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert {"bounds", "size", "triangles", "materials", "textures", "up", "notes", "warnings", "views", "blank", "colors"} <= set(told)
    assert told["size"] == pytest.approx([0.556, 0.5488, 0.5592], abs=2e-3)
    assert not told["blank"]
    with Picture.open(tmp_path / "sheet.png") as sheet:
        for view in told["views"]:
            left, top, width, height = view["cell"]
            assert 0 <= left < left + width <= sheet.width
            assert 0 <= top < top + height <= sheet.height
    (tmp_path / "sheet.png").unlink()
    alone = limner_process(*words)
    assert json.loads(alone.stdout) == {**told, "output": None}
    assert not list(tmp_path.iterdir())


def test_thumbnails_of_a_folder(limner_process: Run, tmp_path: Path) -> None:
    """A broken model costs code 1 and a line, even quietly; the others are there, on the sheet, in the JSON; --update keeps them."""
    models = tmp_path / "models"
    (models / "deeper").mkdir(parents=True)
    (models / "a.obj").write_text(TRIANGLE)
    (models / "deeper/b.obj").write_text(TRIANGLE)
    (models / "broken.glb").write_bytes(b"glTF nonsense")
    words = ("thumbnails", "models", "-o", "out", "--size", "24", "--samples", "1", "--recursive", "--quiet", "--json")
    done = limner_process(*words, "--sheet", "index.png")
    assert done.returncode == 1
    assert done.stderr.startswith("limner: error: models/broken.glb: ")
    assert done.stderr.count("\n") == 1
    told = json.loads(done.stdout)
    assert (told["made"], told["kept"], told["failed"], told["finished"]) == (2, 0, 1, True)
    assert [item["path"] for item in told["items"]] == ["out/a.obj.png", None, "out/deeper/b.obj.png"]
    for name in ("out/a.obj.png", "out/deeper/b.obj.png", "index.png"):
        with Picture.open(tmp_path / name) as picture:
            assert name == "index.png" or picture.size == (24, 24)
    (models / "broken.glb").unlink()
    again = limner_process(*words, "--update")
    assert (again.returncode, again.stderr) == (0, "")
    assert json.loads(again.stdout)["kept"] == 2


@pytest.mark.parametrize("command", ["turntable", "views", "thumbnails"])
def test_help_imports_nothing_heavy(command: str) -> None:
    """Neither NumPy nor Pillow nor the compiler."""
    script = (
        "import sys\nfrom limner.cli.main import main\n"
        f"code = main(['{command}', '--help'])\n"
        "print([name for name in ('numpy', 'PIL', 'numba', 'llvmlite') if name in sys.modules], code)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[] 0"
