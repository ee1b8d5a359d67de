"""When a path-traced picture ends, on the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np

from limner.files.open_image import open_image

SMALL = ("render", "cornell", "--renderer", "path", "--width", "16", "--height", "16", "--max-depth", "1")


def test_the_samples_that_time_allowed_are_told(limner_process: Callable[..., Any], tmp_path) -> None:
    """What is told after a time limit makes the same picture again, and nothing is left of the checkpoint of a whole one."""
    timed, again = tmp_path / "timed.exr", tmp_path / "again.exr"
    told = json.loads(limner_process(*SMALL, "-o", timed, "--time-limit", "0.05", "--json").stdout)
    samples = told["recipe"]["samples"]
    limner_process(*SMALL, "-o", again, "--samples", str(samples), "--snapshots", "0.01", "--resume")
    np.testing.assert_array_equal(open_image(timed).pixels, open_image(again).pixels)
    assert {path.name for path in tmp_path.iterdir()} == {"timed.exr", "again.exr"}
