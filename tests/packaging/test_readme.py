"""The first page is true: its lines of Python and of the shell do what they say."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from limner.image.image import Image

README = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")


def _blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)


def test_the_lines_of_python_run(tmp_path: Path) -> None:
    """Copied into a file, they end well, write the picture, and print what the comment says."""
    (code,) = _blocks("python")
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("(600, 800, 4) ")
    assert (tmp_path / "ball.png").stat().st_size > 1000


def _command_lines() -> list[str]:
    lines = (line for block in _blocks("sh") for line in block.splitlines())
    return [line for line in lines if line.startswith("limner ")]


@pytest.mark.parametrize("line", _command_lines())
def test_the_command_lines_work(
    limner_process: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, line: str
) -> None:
    """Each with a built-in scene in the model's place, a grey sky, and small."""
    Image(np.full((8, 16, 4), 0.5, dtype=np.float32)).save(tmp_path / "sky.hdr")
    for name in ("picture", "before", "after"):
        limner_process("render", "cornell", "-o", f"{name}.png", "--width", "16", "--height", "12")
    words = shlex.split(line, comments=True)[1:]
    replaced = {"model.glb": "cornell", "sky.hdr": str(tmp_path / "sky.hdr"), "72": "2", "36": "2"}
    words = [replaced.get(word, word) for word in words]
    if "--width" not in words and words[0] in ("render", "dataset", "turntable"):
        words += ["--width", "16", "--height", "12"]
    done = limner_process(*words)
    assert done.returncode == 0, done.stderr
