"""The sheets of chapters 6 and 7: they are drawn, and what they say about windows is so."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from PIL import Image

import limner
from limner.linear import projection, viewport

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
NAMES = ("transforms_sheet", "viewing_spaces", "viewing_projections")

pytestmark = pytest.mark.skipif(not EXAMPLES.exists(), reason="the examples are not part of this installation")


@pytest.fixture
def projections(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(EXAMPLES)
    return importlib.import_module("viewing_projections")


@pytest.mark.parametrize("name", NAMES)
def test_sheets_are_drawn(name, tmp_path):
    """A picture of the expected number of panels, in which there is something to see."""
    path = tmp_path / "sheet.png"
    words = [sys.executable, str(EXAMPLES / f"{name}.py"), str(path), "--small"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    with Image.open(path) as page:
        columns = {"transforms_sheet": 5, "viewing_spaces": 4, "viewing_projections": 5}[name]
        assert page.width == columns * (96 + 9) + 9
        assert len(np.unique(np.asarray(page.convert("RGB")).reshape(-1, 3), axis=0)) > 100
    if name == "viewing_spaces":
        assert done.stdout.splitlines()[-1].startswith("pixel    (24.12")


def test_the_camera_of_a_window_is_the_cropped_matrix(projections):
    """A camera with another window is the whole one's projection after `crop`, and its picture the whole one's rectangle."""
    whole = limner.Camera.look_at((2, 2, 4), (0, 0.5, 0), yfov_degrees=40, near=0.5, far=20.0)
    width, height, left, bottom, w, h = 96, 72, 30, 20, 40, 24
    part = projections.part_of(whole, width, height, left, bottom, w, h)
    expected = viewport.crop(width, height, left, bottom, w, h) @ projection.clip_from_camera(whole, width, height, 0.5, 20.0)
    np.testing.assert_allclose(projection.clip_from_camera(part, w, h, 0.5, 20.0), expected, rtol=1e-12, atol=1e-12)
    scene = limner.builtin("teapot")
    seen = [limner.render(scene, width=x, height=y, camera=c, samples=1).pixels for x, y, c in ((width, height, whole), (w, h, part))]
    top = height - bottom - h
    cut = seen[0][top : top + h, left : left + w]
    assert np.mean(np.abs(cut - seen[1]).max(axis=-1) > 1e-3) < 0.01
