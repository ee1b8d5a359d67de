"""A command line whose scene and engine are stand-ins: what is tested is the command line."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from limner.cli.main import main
from limner.image.image import Image
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Shape

SCENE = Scene(
    root=Node(
        "world",
        shapes=(Shape(Box((2.0, 4.0, 6.0))),),
        cameras=(PerspectiveCamera(name="front"), OrthographicCamera(name="plan")),
    ),
    notes=("extension EXT_nothing is ignored",),
)


@dataclass
class StandIn:
    """Takes the engine's place: remembers what it was asked for and does what the test says."""

    asked: list[dict[str, Any]] = field(default_factory=list)
    act: Callable[[dict[str, Any]], None] = lambda _: None
    warnings: tuple[str, ...] = ()
    finished: bool = True

    def render(self, scene: Scene, **options: Any) -> Image:
        self.asked.append({"scene": scene, **options})
        self.act(options)
        pixels = np.ones((options["height"], options["width"], 4), dtype=np.float32)
        aov = dict.fromkeys(options["aovs"], pixels[..., 0])
        recipe = {"seed": options["seed"]}
        return Image(pixels, aov=aov, warnings=self.warnings, recipe=recipe, finished=self.finished)


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> StandIn:
    """The stand-in behind `limner render`; every MODEL is a box with two cameras."""
    stand_in = StandIn()
    module = ModuleType("limner.render")
    module.render = stand_in.render  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "limner.render", module)
    monkeypatch.setattr("limner.cli.picture.open_model", lambda *_: SCENE)
    monkeypatch.setattr("limner.cli.info.open_model", lambda _: SCENE)
    return stand_in


@dataclass(frozen=True)
class Outcome:
    """What a command line came to."""

    code: int
    out: str
    err: str


@pytest.fixture
def limner(
    engine: StandIn, capsys: pytest.CaptureFixture[str], tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> Callable[..., Outcome]:
    """Run a command line in this process, in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def run(*words: object) -> Outcome:
        code = main([str(word) for word in words])
        said = capsys.readouterr()
        return Outcome(code, said.out, said.err)

    return run
