"""`limner render`: every option reaches the engine, and every slip is one line before any work."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as Picture

from limner.errors import LimnerWarning, RenderError, SceneError
from limner.progress import Progress


def test_a_picture_is_made_with_the_defaults(limner: Callable[..., Any], engine: Any) -> None:
    """800 x 600, raster, seed 0, and whatever the renderer thinks best; standard output stays empty."""
    done = limner("render", "model.glb", "-o", "a.png")
    assert (done.code, done.out) == (0, "")
    with Picture.open("a.png") as picture:
        assert picture.size == (800, 600)
    asked = engine.asked[0]
    assert [asked[name] for name in ("renderer", "samples", "seed", "camera", "threads")] == ["raster", None, 0, None, None]
    assert asked["aovs"] == ()


def test_every_option_reaches_the_engine(limner: Callable[..., Any], engine: Any) -> None:
    """Nothing is dropped on the way."""
    numbers = ("--width", 64, "--height", 48, "--samples", 9, "--seed", 5, "--threads", 3)
    names = ("--renderer", "ray", "--aov", "depth,normal,depth", "--background", "#ff8000")
    done = limner("render", "m", "-o", "a.exr", *numbers, *names)
    assert done.code == 0
    asked = engine.asked[0]
    assert (asked["renderer"], asked["width"], asked["height"]) == ("ray", 64, 48)
    assert (asked["samples"], asked["seed"], asked["threads"], asked["aovs"]) == (9, 5, 3, ("depth", "normal"))
    assert asked["scene"].background == pytest.approx((1.0, 0.2158605, 0.0), abs=1e-6)


@pytest.mark.parametrize(
    ("words", "background"),
    [
        (("--background", "white"), (1.0, 1.0, 1.0)),
        (("--background", "0.5,0,2"), (0.5, 0.0, 2.0)),
        (("--background", "transparent"), None),
        (("--transparent",), None),
    ],
)
def test_backgrounds(limner: Callable[..., Any], engine: Any, words: tuple[str, ...], background: Any) -> None:
    """Names, linear numbers, nothing."""
    assert limner("render", "m", "-o", "a.png", *words).code == 0
    assert engine.asked[0]["scene"].background == background


def test_a_camera_by_name_by_number_or_by_place(limner: Callable[..., Any], engine: Any) -> None:
    """--camera picks one of the model's; --eye makes one that looks at the middle unless told otherwise."""
    assert limner("render", "m", "-o", "a.png", "--camera", "plan").code == 0
    assert limner("render", "m", "-o", "a.png", "--camera", "0").code == 0
    assert limner("render", "m", "-o", "a.png", "--eye", "0,0,9", "--yfov", "30").code == 0
    assert limner("render", "m", "-o", "a.png", "--eye=-3,0,0", "--target", "1,0,0", "--up", "0,0,1").code == 0
    plan, front, made, aside = (asked["camera"] for asked in engine.asked)
    assert (plan.name, front.name) == ("plan", "front")
    assert made.yfov_degrees == 30.0
    assert made.world_from_camera[:3, 3].tolist() == [0.0, 0.0, 9.0]
    assert made.world_from_camera[:3, 2] == pytest.approx([0.0, 0.0, 1.0])
    assert aside.world_from_camera[:3, 2] == pytest.approx([-1.0, 0.0, 0.0])
    assert aside.world_from_camera[:3, 1] == pytest.approx([0.0, 0.0, 1.0])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--width", "0"), "0 is not in the range"),
        (("--height", "-5"), "-5 is not in the range"),
        (("--width", "1000000"), "1000000 is not in the range"),
        (("--width", "32768", "--height", "32768"), "must not exceed 67108864 pixels, got 32768 x 32768"),
        (("--width", "wide"), "'wide' is not a valid int"),
        (("--samples", "0"), "0 is not in the range"),
        (("--seed", "-1"), "-1 is not in the range"),
        (("--threads", "0"), "0 is not in the range"),
        (("--renderer", "magic"), "'magic' is not one of 'raster', 'ray'"),
        (("--eye", "1,2"), "expected three numbers X,Y,Z, got '1,2'"),
        (("--eye", "1,2,nan"), "expected finite numbers, got '1,2,nan'"),
        (("--eye", "1,2,3", "--target", "1,2,3"), "camera.eye and camera.target must differ"),
        (("--eye", "0,5,0", "--target", "0,0,0"), "camera.up must not be zero or along the gaze"),
        (("--eye", "0,0,5", "--up", "0,0,0"), "camera.up must not be zero"),
        (("--eye", "0,0,5", "--yfov", "180"), "--yfov must lie between 0 and 180 degrees, got 180"),
        (("--eye", "0,0,5", "--yfov", "nan"), "--yfov must lie between 0 and 180 degrees, got nan"),
        (("--eye", "0,0,5", "--camera", "0"), "--camera and --eye exclude each other"),
        (("--target", "0,0,5"), "--target needs --eye"),
        (("--camera", "side"), "there is no camera 'side' in m; it has: 0 'front', 1 'plan'"),
        (("--camera", "2"), "there is no camera '2' in m"),
        (("--camera", "-1"), "there is no camera '-1' in m"),
        (("--background", "mauve"), "expected environment, transparent, black, white, gray"),
        (("--background", "1,-1,0"), "expected environment, transparent"),
        (("--background", "white", "--transparent"), "say different things"),
        (("--aov", "depth"), "--aov needs an output that can hold more than a picture (.exr), got a.png"),
        (("-o", "a.gif"), "must be one of .png"),
        (("-o", "missing/a.png"), "there is no folder"),
        (("-o", "."), "must be one of .png"),
        (("--bogus",), "No such option"),
        (("-o", "-", "--json"), "both want standard output"),
    ],
)
def test_a_slip_is_one_line_and_no_file(
    limner: Callable[..., Any], engine: Any, words: tuple[str, ...], message: str, tmp_path: Path
) -> None:
    """Exit code 2, one line on standard error that says what was expected, nothing rendered, nothing written."""
    done = limner("render", "m", "-o", "a.png", *words)
    assert (done.code, done.out) == (2, "")
    errors = [line for line in done.err.splitlines() if not line.startswith("limner: note:")]
    assert len(errors) == 1
    assert errors[0].startswith("limner: error: ")
    assert message in errors[0]
    assert not engine.asked
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", [("render",), ("render", "m"), ("info",), ("unknown",), ("--unknown",)])
def test_an_incomplete_command_line_is_refused(limner: Callable[..., Any], command: tuple[str, ...]) -> None:
    """In one line that says where to read on."""
    done = limner(*command)
    assert done.code == 2
    assert done.err.count("\n") == 1
    assert "--help)" in done.err


def test_notes_and_warnings_are_told_once_unless_quiet(limner: Callable[..., Any], engine: Any) -> None:
    """The reader's notes, warnings while rendering, and what the picture brings: one line each, on standard error."""

    def slip(_: object) -> None:
        import warnings

        warnings.warn("3 pixels are not\nfinite", LimnerWarning, stacklevel=1)
        warnings.warn("no light", LimnerWarning, stacklevel=1)

    engine.act, engine.warnings = slip, ("no light",)
    done = limner("render", "m", "-o", "a.png", "--width", "4", "--height", "4")
    assert done.err.splitlines() == [
        "limner: note: extension EXT_nothing is ignored",
        "limner: warning: 3 pixels are not finite",
        "limner: warning: no light",
    ]
    assert limner("render", "m", "-o", "a.png", "--width", "4", "--height", "4", "--quiet").err == ""


def test_json_tells_all(limner: Callable[..., Any], engine: Any) -> None:
    """One object on standard output: what was written, how long it took, what was said, how to make it again."""
    engine.warnings = ("no light",)
    done = limner("render", "m", "-o", "a.exr", "--width", "4", "--height", "3", "--json", "--seed", "8", "--aov", "depth")
    told = json.loads(done.out)
    assert (told["output"], told["width"], told["height"], told["finished"]) == ("a.exr", 4, 3, True)
    assert set(told["seconds"]) == {"load", "render", "save"}
    assert (told["recipe"], told["aovs"]) == ({"seed": 8, "model": "./m"}, ["depth"])
    assert (told["warnings"], told["notes"]) == (["no light"], ["extension EXT_nothing is ignored"])


def test_an_interrupt_keeps_the_picture_so_far(limner: Callable[..., Any], engine: Any) -> None:
    """The engine hands back what it has: it is saved, and the code says that it was not all."""
    engine.finished = False
    done = limner("render", "m", "-o", "a.png", "--width", "4", "--height", "4", "--quiet")
    assert done.code == 130
    assert np.asarray(Picture.open("a.png")).shape[:2] == (4, 4)


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (SceneError("sphere.radius must be positive,\n got -1.0", "world/ball"), 2, "must be positive, got -1.0 (world/ball)"),
        (RenderError("the worker died"), 1, "the worker died"),
        (MemoryError("Unable to allocate 9 TiB"), 1, "not enough memory: Unable to allocate 9 TiB"),
        (ZeroDivisionError("division by zero"), 1, "division by zero (ZeroDivisionError, not foreseen; --traceback shows it)"),
    ],
)
def test_whatever_goes_wrong_is_one_line(
    limner: Callable[..., Any], engine: Any, error: Exception, code: int, line: str, tmp_path: Path
) -> None:
    """Never a traceback, never a file; with --traceback the exception itself."""

    def fail(_: object) -> None:
        raise error

    engine.act = fail
    done = limner("render", "m", "-o", "a.png", "--quiet")
    assert done.code == code
    assert done.err.startswith("limner: error: ")
    assert done.err.endswith(line + "\n")
    assert done.err.count("\n") == 1
    assert not list(tmp_path.iterdir())
    with pytest.raises(type(error)):
        limner("render", "m", "-o", "a.png", "--traceback")


def test_ctrl_c_before_there_is_a_picture(limner: Callable[..., Any], engine: Any, tmp_path: Path) -> None:
    """130, one line, no file."""

    def interrupt(_: object) -> None:
        raise KeyboardInterrupt

    engine.act = interrupt
    done = limner("render", "m", "-o", "a.png", "--quiet")
    assert (done.code, done.err) == (130, "limner: interrupted\n")
    assert not list(tmp_path.iterdir())


def test_progress_stays_off_where_there_is_no_terminal(limner: Callable[..., Any], engine: Any) -> None:
    """A pipe gets no bar, however long it takes."""
    engine.act = lambda options: options["on_progress"](Progress(0.5, 60.0, 60.0, "render"))
    assert limner("render", "m", "-o", "a.png", "--width", "4", "--height", "4").err.startswith("limner: note:")


def test_control_characters_do_not_reach_the_terminal(limner: Callable[..., Any], engine: Any) -> None:
    """A name in a file may hold anything; a message may not."""
    engine.warnings = ("texture '\x1b[2J\x07evil' is missing",)
    assert "\x1b" not in limner("render", "m", "-o", "a.png", "--width", "4", "--height", "4").err
