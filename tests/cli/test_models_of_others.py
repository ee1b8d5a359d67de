"""Models whose axes or pictures are somebody else's: which axis points up, and what a scene says about its own picture."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click
import pytest

from limner.cli.main import main
from limner.cli.model import open_model
from limner.files.save_mesh import save_model
from limner.mesh.shapes.primitives import box

MITSUBA = """<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="4"/></integrator>
<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="16"/></film>
<sampler type="independent"><integer name="sample_count" value="2"/></sampler></sensor><shape type="sphere"/></scene>"""

ON_MODELS = (
    "animate", "convert", "dataset", "doctor", "draw", "explain", "info", "render", "stages", "thumbnails", "turntable", "views",
    "wireframe", "mesh check", "mesh convert", "mesh info", "mesh repair", "mesh unwrap",
)  # fmt: skip


def test_every_command_that_opens_a_model_asks_which_axis_points_up() -> None:
    """What `--model-up` is to one, it is to all."""
    from limner.cli.commands import limner as group

    for words in ON_MODELS:
        command: Any = group
        for word in words.split():
            command = command.get_command(click.Context(command), word)
        assert "--model-up" in {option for parameter in command.params for option in parameter.opts}, words


@pytest.mark.parametrize("up", ["y", "z"])
def test_a_model_is_turned_upright(up: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A box of 2 x 4 x 6 whose +z points up is 6 high; without a command line, and on the next, +y points up."""
    model = tmp_path / "box.stl"
    save_model(box((2.0, 4.0, 6.0)), model)
    assert main(["info", str(model), "--json", "--model-up", up]) == 0
    told = json.loads(capsys.readouterr().out)
    low, high = told["bounds"]
    assert [b - a for a, b in zip(low, high, strict=True)] == pytest.approx([2, 4, 6] if up == "y" else [2, 6, 4])
    assert open_model(str(model)).bounds()[1].tolist() == [1, 2, 3]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ((), {"width": 32, "height": 16, "samples": 2, "renderer": "path", "max_depth": 3}),
        (("--width", "20", "--renderer", "ray"), {"width": 20, "height": 16, "samples": 2, "renderer": "ray", "max_depth": 3}),
        (("--samples", "7", "--max-depth", "1"), {"width": 32, "samples": 7, "renderer": "path", "max_depth": 1}),
    ],
)
def test_mitsuba_scenes_say_how_they_are_drawn(limner: Any, engine: Any, words: tuple[str, ...], expected: dict[str, Any]) -> None:
    """Size, samples, renderer and depth are the file's own, unless the command line says otherwise."""
    Path("scene.xml").write_text(MITSUBA)
    done = limner("render", "scene.xml", "-o", "a.png", *words)
    assert done.code == 0, done.err
    asked = engine.asked[0]
    assert {name: asked[name] for name in expected} == expected
    assert asked.get("filter", "box") == "box"
    assert asked["default_lights"] is False
