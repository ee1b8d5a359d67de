"""`python -m limner` as a process: codes, streams, closed pipes, signals, and what a start costs."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Picture

import limner

Finished = subprocess.CompletedProcess[str]
Run = Callable[..., Finished]


def test_the_version_is_told(limner_process: Run) -> None:
    """One line, code 0."""
    done = limner_process("--version")
    assert (done.returncode, done.stdout, done.stderr) == (0, f"limner {limner.__version__}\n", "")


def test_help_names_every_command(limner_process: Run) -> None:
    """And each command's help names its options."""
    done = limner_process("--help")
    assert done.returncode == 0
    for command in ("dataset", "info", "render", "warmup"):
        assert f"  {command} " in done.stdout
    assert "--renderer [raster|ray|path|lines]" in limner_process("render", "--help").stdout


def test_without_a_command_the_help_is_on_standard_error(limner_process: Run) -> None:
    """Code 2: nothing was done."""
    done = limner_process()
    assert (done.returncode, done.stdout) == (2, "")
    assert "Commands:" in done.stderr


_WHAT_IS_LOADED = """
import json, sys
from limner.cli.main import main
try:
    main({words!r})
finally:
    sys.stderr.write(json.dumps(sorted(sys.modules)))
"""


@pytest.mark.parametrize(
    "words", [["--version"], ["--help"], ["render", "--help"], ["render"], ["render", "x", "-o", "a.nope"]]
)
def test_what_computes_nothing_loads_nothing(words: list[str]) -> None:
    """Neither the compiler nor what it stands on for a help page or a slip."""
    script = _WHAT_IS_LOADED.format(words=words)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    loaded = json.loads(done.stderr.splitlines()[-1])
    forbidden = {"numba", "llvmlite", "rich", "PIL", "OpenEXR", "trimesh"}
    if "-o" not in words:
        forbidden.add("numpy")
    assert not forbidden & set(loaded)


@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_a_built_in_scene_becomes_a_picture(limner_process: Run, tmp_path: Path, renderer: str) -> None:
    """From the command line to a PNG that shows something, and the JSON that goes with it."""
    words = ("--renderer", renderer, "--width", 64, "--height", 48, "--json")
    done = limner_process("render", "teapot", "-o", "a.png", *words)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert (told["width"], told["height"], told["finished"]) == (64, 48, True)
    with Picture.open(tmp_path / "a.png") as picture:
        shown = np.asarray(picture.convert("RGB")).astype(int)
        recipe = json.loads(picture.text["limner"])  # type: ignore[attr-defined]
    assert shown.shape == (48, 64, 3)
    assert shown.std() > 5.0
    assert recipe == told["recipe"]


def test_a_layered_picture(limner_process: Run, tmp_path: Path) -> None:
    """AOVs arrive in the EXR by the names of compositors."""
    import OpenEXR

    words = ("--aov", "depth,normal,instance_id", "--width", 32, "--height", 24)
    done = limner_process("render", "cornell", "-o", "a.exr", *words)
    assert done.returncode == 0, done.stderr
    with OpenEXR.File(os.fspath(tmp_path / "a.exr"), separate_channels=True) as file:
        names = set(file.channels())
    assert {"R", "G", "B", "A", "depth.Z", "normal.X", "normal.Y", "normal.Z", "instance_id.X"} <= names


def test_an_unknown_aov_is_refused(limner_process: Run, tmp_path: Path) -> None:
    """By name, and nothing is written."""
    done = limner_process("render", "teapot", "-o", "a.exr", "--aov", "mood", "--width", 8, "--height", 8)
    assert done.returncode == 2
    assert "mood" in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("missing.glb", None, "there is no file 'missing.glb'"),
        ("broken.glb", b"glTF\x02\x00", "broken.glb"),
        ("empty.gltf", b"", "empty.gltf"),
        ("picture.blend", b"x", ".blend"),
    ],
)
def test_a_bad_model_is_one_line(limner_process: Run, tmp_path: Path, name: str, content: bytes | None, message: str) -> None:
    """Code 2 and the file's name, for `render` and `info` alike; no picture."""
    if content is not None:
        (tmp_path / name).write_bytes(content)
    for words in (("render", name, "-o", "a.png"), ("info", name)):
        done = limner_process(*words)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith("limner: error: ")
        assert done.stderr.count("\n") == 1
        assert message in done.stderr
    assert not (tmp_path / "a.png").exists()


def test_standard_output_takes_a_png(tmp_path: Path) -> None:
    """-o - into a pipe is the picture and nothing else."""
    words = [sys.executable, "-m", "limner", "render", "teapot", "-o", "-", "--width", "16", "--height", "16", "--quiet"]
    done = subprocess.run(words, capture_output=True, check=True, cwd=tmp_path)
    assert done.stdout.startswith(b"\x89PNG")
    assert done.stdout.endswith(b"IEND\xaeB`\x82")
    assert done.stderr == b""


@pytest.mark.skipif(os.name != "posix", reason="closes a pipe as POSIX knows it")
@pytest.mark.parametrize("words", [("info", "cornell", "--quiet"), ("render", "teapot", "-o", "-", "--quiet", "--width", "64")])
def test_a_closed_pipe_is_one_line(words: tuple[str, ...], tmp_path: Path) -> None:
    """Whoever reads has gone: code 1 and a line, not two tracebacks."""
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "limner", *words],
            stdout=writing, stderr=subprocess.PIPE, text=True, cwd=tmp_path, check=False,
        )  # fmt: skip
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (1, "limner: error: whoever read standard output closed it\n")


@pytest.mark.skipif(os.name != "posix", reason="sends an interrupt as POSIX knows it")
def test_ctrl_c_saves_the_picture_so_far(limner_process: Run, tmp_path: Path) -> None:
    """A render of minutes is interrupted: within seconds there is code 130, and a picture that opens."""
    scene = ("render", "cornell", "--renderer", "ray")
    assert limner_process(*scene, "-o", "warm.png", "--width", 4, "--height", 4).returncode == 0  # all is compiled now
    words = [sys.executable, "-m", "limner", *scene, "-o", "a.png", "--width", "256", "--height", "256", "--samples", "4096"]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        try:
            time.sleep(2.0)
            process.send_signal(signal.SIGINT)
            _, said = process.communicate(timeout=15)
        finally:
            process.kill()
    assert process.returncode == 130, said
    assert "limner: interrupted: the picture so far is in a.png" in said
    assert "Traceback" not in said
    with Picture.open(tmp_path / "a.png") as picture:
        assert picture.size == (256, 256)


def test_warmup_says_that_all_is_ready(limner_process: Run) -> None:
    """A second warm-up compiles nothing."""
    assert limner_process("warmup", timeout=900).returncode == 0
    again = limner_process("warmup")
    assert again.returncode == 0
    assert again.stdout.startswith("everything is ready in ")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full here")
@pytest.mark.parametrize("words", [("--help",), ("info", "cornell", "--json"), ("render", "cornell", "-o", "-", "--width", "8")])
def test_a_full_standard_output_is_one_line(words: tuple[str, ...]) -> None:
    """Code 1, and no talk of what was not foreseen."""
    with open("/dev/full", "wb") as full:
        done = subprocess.run([sys.executable, "-m", "limner", *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=120)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == "limner: error: cannot write standard output: No space left on device"
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(os.name == "nt", reason="a shell of Unix closes the streams")
def test_closed_streams(tmp_path: Path) -> None:
    """A picture needs neither stream; a result without standard output is an error, not a traceback."""
    picture = tmp_path / "picture.png"
    limner_command = f"{sys.executable} -m limner"
    render = f"{limner_command} render cornell -o {picture} --width 8 --height 8 <&- >&- 2>&-"
    assert subprocess.run(["sh", "-c", render], timeout=120).returncode == 0
    with Picture.open(picture) as seen:
        assert seen.size == (8, 8)
    told = subprocess.run(["sh", "-c", f"{limner_command} info cornell >&-"], stderr=subprocess.PIPE, text=True, timeout=120)
    assert told.returncode == 1
    assert told.stderr == "limner: error: cannot write standard output: Bad file descriptor\n"
