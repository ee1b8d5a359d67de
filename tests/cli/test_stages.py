"""`limner stages`: as a process, with its codes, lines and JSON."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image as Picture

Run = Callable[..., Any]

WORDS = ("stages", "cornell", "--width", "320", "--height", "160", "--samples", "2")


def test_stages_make_a_sheet_and_numbers(limner_process: Run, tmp_path: Path) -> None:
    """The sheet opens, its panels are where the JSON says, and each stage hands on what the next one counts; alone, it writes no file."""
    done = limner_process(*WORDS, "--json", "-o", "sheet.png")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["triangles"] == 32
    assert told["screen_triangles"] <= told["triangles"]
    assert told["fragments"] >= told["pixels"] > 0
    assert told["clipping"]["cut"] > 0
    with Picture.open(tmp_path / "sheet.png") as sheet:
        for panel in told["panels"]:
            left, top, width, height = panel["cell"]
            assert (width, height) == (320, 160)
            assert 0 <= left < left + width <= sheet.width
            assert 0 <= top < top + height <= sheet.height
    (tmp_path / "sheet.png").unlink()
    alone = limner_process(*WORDS, "--json")
    assert json.loads(alone.stdout) == {**told, "output": None}
    assert not list(tmp_path.iterdir())


def test_another_eye_sees_other_pixels(limner_process: Run) -> None:
    """The camera is the one that the words say; quietly."""
    one, other = (
        json.loads(limner_process(*WORDS, "--json", "--quiet", *more).stdout)
        for more in ((), ("--eye", "0.278,0.273,-2", "--target", "0.278,0.273,0"))
    )
    assert other["depth"]["least"] > one["depth"]["least"] + 1.0
    assert other["pixels"] < one["pixels"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("stages", "cornell"), "give -o, --json or both"),
        (("stages", "cornell", "-o", "-", "--json"), "both want standard output"),
        (("stages", "cornell", "-o", "sheet.xyz"), "the extension of 'sheet.xyz' must be one of"),
        (("stages", "cornell", "-o", "nowhere/sheet.png"), "there is no folder"),
        (("stages", "cornell", "-o", "sheet.png", "--width", "100"), "--width"),
        (("stages", "cornell", "-o", "sheet.png", "--yfov", "40"), "--yfov needs --eye"),
        (("stages", "cornell", "-o", "sheet.png", "--camera", "nobody"), "there is no camera 'nobody'"),
        (("stages", "nothing.glb", "-o", "sheet.png"), "there is no file 'nothing.glb'"),
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


@pytest.mark.parametrize("command", ["stages", "wireframe"])
def test_help_imports_nothing_heavy(command: str) -> None:
    """Neither NumPy nor Pillow nor the compiler."""
    script = (
        "import sys\nfrom limner.cli.main import main\n"
        f"code = main(['{command}', '--help'])\n"
        "print([name for name in ('numpy', 'PIL', 'numba', 'llvmlite') if name in sys.modules], code)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, env=os.environ)
    assert done.stdout.splitlines()[-1] == "[] 0"
