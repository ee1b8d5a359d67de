"""Compiled drawing = drawing as plain Python, to the bit."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest

from limner.draw.canvas import Canvas
from limner.draw.stroke import Pen
from limner.draw.wireframe import draw_wireframe, visible_segments
from limner.linear.project import Lens, intrinsics


def fingerprint() -> str:
    """Lines of every kind, shapes that cross themselves and crowd a row, tiles, hidden lines."""
    rng = np.random.default_rng(3)
    canvas = Canvas(48, 40, "#20406080")
    canvas.segments(rng.uniform(-5, 50, (40, 4)), rng.uniform(0, 1, (40, 4)), Pen(2.2, "round"))
    canvas.pixel_lines(rng.uniform(-9, 60, (30, 4)), rng.uniform(0, 1, (30, 4)))
    canvas.polygon(rng.uniform(-3, 50, (30, 2)), fill=(0.9, 0.7, 0.1, 0.5), rule="evenodd")
    canvas.polyline(rng.uniform(0, 40, (20, 2)), (0.1, 0.2, 0.3, 0.3), Pen(1.7, join="round"))
    at = np.linspace(0.0, 47.0, 450)
    canvas.polygon(np.stack([at, np.where(np.arange(450) % 2, 12.2, 14.7)], axis=1), fill="#aa8800")
    canvas.triangles(rng.uniform(0, 45, (8, 3, 2)), rng.uniform(0, 1, (8, 3, 4)))
    depth = rng.uniform(2, 6, (40, 48)).astype(np.float32)
    ends = rng.uniform(-2, 2, (2, 12, 3)) - (0, 0, 4)
    seen = visible_segments(*ends, np.eye(4), intrinsics(Lens(0.6), 48, 40), perspective=True, width=48, height=40, depth=depth)
    draw_wireframe(canvas, seen, "white", 1.5, hidden="#ff000080")
    return hashlib.sha256(canvas.image().pixels.tobytes()).hexdigest()


@pytest.mark.compiled
def test_compiled_and_plain_python_draw_the_same_bits() -> None:
    """The same drawing in a process where kernels run as Python."""
    done = subprocess.run(
        [sys.executable, __file__],
        env={**os.environ, "LIMNER_MODE": "python"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == fingerprint()


if __name__ == "__main__":
    sys.stdout.write(fingerprint())
