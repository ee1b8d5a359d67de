"""Environments: which way they look, what they take, and what the scene makes of them."""

from __future__ import annotations

import dataclasses
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import limner
from limner.errors import SceneError
from limner.scene.environment import Environment, direction_from_uv, uv_from_direction
from limner.scene.scene import Scene


def test_the_convention() -> None:
    """Centre +x, three quarters +z, one quarter -z, edges -x, top row +y: as in the reference pictures."""
    directions = [(1, 0, 0), (0, 0, 1), (0, 0, -1), (-1, 0, 1e-12), (-1, 0, -1e-12)]
    np.testing.assert_allclose(uv_from_direction(directions), [(0.5, 0.5), (0.75, 0.5), (0.25, 0.5), (1, 0.5), (0, 0.5)], atol=1e-9)
    assert uv_from_direction([(0, 1, 0), (0, -1, 0)])[:, 1].tolist() == [0.0, 1.0]
    # The sun of a picture whose notes give its place and its direction.
    np.testing.assert_allclose(direction_from_uv((0.601, 0.331)), (0.69, 0.51, 0.51), atol=5e-3)


def test_seen_from_inside_it_is_not_mirrored() -> None:
    """Looking at the middle, +x, with +y up, what is further right in the picture is further right in the world."""
    gaze, up = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    right = np.cross(gaze, up)
    assert direction_from_uv((0.55, 0.5)) @ right > 0.0
    assert direction_from_uv((0.5, 0.45)) @ up > 0.0


@pytest.mark.parametrize("rotation", [0.0, 30.0, 90.0, -200.0, 720.0])
def test_there_and_back(rotation: float) -> None:
    """Places to directions to places, directions to places to directions; u stays in [0, 1)."""
    rng = np.random.default_rng(0)
    uv = rng.uniform(0.001, 0.999, (100, 2))
    np.testing.assert_allclose(uv_from_direction(direction_from_uv(uv, rotation) * 3.0, rotation), uv, atol=1e-12)
    directions = rng.normal(size=(50, 4, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    there = uv_from_direction(directions, rotation)
    assert there.shape == (50, 4, 2)
    assert (there >= 0.0).all()
    assert (there[..., 0] < 1.0).all()
    np.testing.assert_allclose(direction_from_uv(there, rotation), directions, atol=1e-12)


def test_rotation_turns_the_surroundings_counter_clockwise_from_above() -> None:
    """By 90 degrees, what was towards +x is found towards -z: the right-hand rule about +y."""
    quarter = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # R_y(90 degrees)
    directions = np.random.default_rng(1).normal(size=(20, 3))
    np.testing.assert_allclose(uv_from_direction(directions @ quarter.T, 90.0), uv_from_direction(directions), atol=1e-12)
    np.testing.assert_allclose(uv_from_direction((0, 0, -1), 90.0), (0.5, 0.5), atol=1e-12)


def test_sources(tmp_path: Path) -> None:
    """A path stays a string, a picture becomes a read-only float32 copy, a colour three floats."""
    assert Environment(tmp_path / "sky.hdr").source == str(tmp_path / "sky.hdr")
    given = np.ones((2, 4, 3))
    environment = Environment(given, intensity=2, rotation_degrees=np.float32(30))
    given[:] = 7.0
    assert isinstance(environment.source, np.ndarray)
    assert (environment.source.dtype, environment.source.max(), environment.source.flags.writeable) == (np.float32, 1.0, False)
    assert (environment.intensity, environment.rotation_degrees, environment.is_constant) == (2.0, 30.0, False)
    assert repr(environment) == "Environment(4 x 2, intensity=2, rotation_degrees=30)"
    for color in ((1, 2, 3), [1.0, 2.0, 3.0], np.array([1, 2, 3])):
        assert Environment(color).source == (1.0, 2.0, 3.0)
        assert Environment(color).is_constant
    assert Environment(0.5).source == (0.5, 0.5, 0.5)  # type: ignore[arg-type]
    nested = [[[0.0, 1.0, 2.0]] * 4] * 2
    assert Environment(nested).source.shape == (2, 4, 3)  # type: ignore[union-attr, arg-type]
    half = dataclasses.replace(environment, intensity=0.5)
    assert half.intensity == 0.5


def picture(row: int, column: int, value: float) -> Any:
    """Light with one pixel that is none."""
    made = np.ones((3, 5, 3))
    made[row, column, 1] = value
    return made


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("", "environment.source must name a file"),
        ((1, 2), "environment.source must be three numbers"),
        ((1, -2, 3), "environment.source must not be below 0"),
        ((1, np.nan, 3), "environment.source must be finite"),
        (None, "environment.source must be three numbers, got None"),
        (np.ones((4, 4)), r"must be a picture of shape \(height, width, 3\), got \(4, 4\)"),
        (np.ones((4, 4, 4)), r"got \(4, 4, 4\); leave the alpha out"),
        (np.ones((0, 4, 3)), r"got \(0, 4, 3\)"),
        (np.ones((4, 4, 3), np.uint8), "must be linear radiance in floats, got uint8"),
        ([[[1, 2, 3]], [[1, 2]]], "rows of different lengths"),
        (picture(1, 2, np.nan), r"must be finite and not negative, got \(1, nan, 1\) at row 1, column 2"),
        (picture(2, 4, -0.5), r"got \(1, -0.5, 1\) at row 2, column 4"),
        (picture(0, 0, np.inf), r"got \(1, inf, 1\) at row 0, column 0"),
        (picture(0, 1, 1e300), r"got \(1, 1e\+300, 1\) at row 0, column 1"),
    ],
)
def test_sources_that_are_none(source: Any, message: str) -> None:
    """One line: the field, what was expected, what was found, and where."""
    with pytest.raises(SceneError, match=message) as caught:
        Environment(source)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"intensity": -1}, "environment.intensity must not be negative, got -1"),
        ({"intensity": np.nan}, "environment.intensity must be finite"),
        ({"rotation_degrees": np.inf}, "environment.rotation_degrees must be finite"),
        ({"rotation_degrees": "north"}, "environment.rotation_degrees must be a number"),
    ],
)
def test_fields_that_are_none(fields: Any, message: str) -> None:
    """Intensity and rotation are plain, sensible numbers."""
    with pytest.raises(SceneError, match=message):
        Environment((1, 1, 1), **fields)


def test_it_pickles() -> None:
    """As everything that is described does."""
    environment = pickle.loads(pickle.dumps(Environment(np.full((2, 4, 3), 0.25), 2.0, 45.0)))
    assert (environment.source.tolist(), environment.intensity) == (np.full((2, 4, 3), 0.25).tolist(), 2.0)


def test_scenes_have_environments_and_may_show_them() -> None:
    """Behind everything stand three numbers, the environment where there is one, or nothing."""
    assert Scene().environment is None
    assert Scene().background is None
    sky = Environment((0.1, 0.2, 0.3))
    scene = Scene().replace(environment=sky, background="environment")
    assert scene.environment is sky
    assert scene.background == "environment"
    assert scene.replace(background=0.5).background == (0.5, 0.5, 0.5)
    with pytest.raises(SceneError, match=r"but scene\.environment is None"):
        Scene(background="environment")
    with pytest.raises(SceneError, match=r"must be three numbers, .environment. or None, got 'sky'"):
        Scene(background="sky", environment=sky)  # type: ignore[arg-type]
    with pytest.raises(SceneError, match=r"scene\.environment must be an Environment, got str"):
        Scene(environment="garden.hdr")  # type: ignore[arg-type]


@pytest.mark.compiled
def test_notebooks_show_scenes() -> None:
    """A scene is a small PNG there; one that cannot be drawn is its text, not a traceback."""
    shown = limner.builtin("cornell")._repr_png_()
    assert shown is not None
    assert shown.startswith(b"\x89PNG")
    broken = limner.builtin("cornell").replace(environment=Environment("there/is/no/such.hdr"))
    assert broken._repr_png_() is None
