"""`limner render` of what has numbers: colours with their key, the size of points, which axis points up."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.color.maps import mapped
from limner.files.open_image import open_image
from limner.files.save_mesh import save_model
from limner.scene.node import Node
from limner.scene.points import PointCloud
from limner.scene.scene import Scene
from limner.scene.shape import Shape

CLOUD = PointCloud([[0, 0, 0], [1, 0, 0], [0, 0, 5]], scalars={"heat": [0.0, 5.0, 10.0]})  # type: ignore[dict-item]


@pytest.fixture
def with_cloud(engine: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Every MODEL is a cloud of three points."""
    monkeypatch.setattr("limner.cli.picture.open_model", lambda *_: Scene(Node(shapes=(Shape(CLOUD),))))
    return engine


def test_colours_and_their_key(limner: Any, with_cloud: Any) -> None:
    """The scene is coloured by the numbers that are named, and the picture holds the colours of their map."""
    words = ("--scalars", "heat", "--color-map", "magma", "--scalar-range", "0,5", "--point-size", "0.5")
    done = limner("render", "scan.ply", "-o", "a.png", "--width", 200, "--height", 160, *words)
    assert (done.code, done.out) == (0, "")
    cloud = with_cloud.asked[0]["scene"].shapes()[0][1].geometry
    assert (cloud.colors == mapped([0.0, 5.0, 10.0], "magma", (0.0, 5.0))).all()
    assert cloud.point_radii.tolist() == [0.5] * 3
    pixels = open_image("a.png").pixels[..., :3]
    for color in mapped([0.0, 5.0], "magma", (0.0, 5.0)):
        assert (np.abs(pixels - color).max(axis=2) < 0.03).any()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--scalars", "cold"), "nothing has scalars 'cold'; there are: heat"),
        (("--scalars", "heat", "--color-map", "jet"), "color_map must be one of viridis"),
        (("--scalars", "heat", "--scalar-range", "5,1"), "two finite numbers"),
        (("--point-size", "-1"), "--point-size"),
        (("--model-up", "x"), "--model-up"),
    ],
)
def test_slips(limner: Any, with_cloud: Any, words: tuple[str, ...], message: str) -> None:
    """Each in one line, with code 2, and no file."""
    done = limner("render", "scan.ply", "-o", "a.png", *words)
    assert done.code == 2
    assert message in done.err
    assert not Path("a.png").exists()


def test_models_are_converted(limner: Any) -> None:
    """Where the output is a model, so is the input; what is for pictures is refused."""
    from limner.cli.convert import MODELS
    from limner.files.save_mesh import SAVED

    assert MODELS == SAVED
    save_model(CLOUD, "scan.ply")
    assert limner("convert", "scan.ply", "scan.obj").code == 0
    assert Path("scan.obj").read_text().count("\nv ") == 3
    done = limner("convert", "scan.ply", "other.obj", "--width", 3)
    assert (done.code, Path("other.obj").exists()) == (2, False)
    assert "--width is for pictures" in done.err


def test_up(limner: Any, engine: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The file's z becomes the scene's y; the recipe does not claim what it cannot say."""
    from limner.cli.model import open_model

    monkeypatch.setattr("limner.cli.picture.open_model", open_model)
    save_model(PointCloud(CLOUD.positions, radii=0.25), "scan.ply")
    assert limner("render", "scan.ply", "-o", "a.png", "--model-up", "z").code == 0
    assert engine.asked[0]["scene"].bounds()[1].tolist() == [1.25, 5.25, 0.25]
    assert "model" not in open_image("a.png").recipe
