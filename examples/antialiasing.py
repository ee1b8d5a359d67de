"""Antialiasing (FoCG 8.3, 9.2, 13.4.1): a fan of thin spokes, magnified; one sample, several, and wider filters.

One sample in each pixel turns edges into stairs and thin spokes into dots. More samples give grey levels; a wider filter than the box
takes what moiré is left, and some sharpness with it.

    python examples/antialiasing.py antialiasing.png
"""

from __future__ import annotations

import math
import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas

WAYS = {
    "1 sample": {"samples": 1},
    "4 samples": {"samples": 4},
    "64 samples, box": {"samples": 64},
    "64 samples, tent": {"samples": 64, "filter": "tent"},
    "64 samples, gaussian": {"samples": 64, "filter": "gaussian"},
    "64 samples, lanczos": {"samples": 64, "filter": "lanczos3"},
}


def fan(n: int = 48) -> limner.Scene:
    """Black triangles that meet in the middle of a white picture."""
    edges = 2.0 * math.pi * (np.arange(2 * n) + 0.31) / (2 * n)
    rim = np.stack([np.cos(edges), np.sin(edges), np.zeros(2 * n)], axis=1)
    positions = np.concatenate([rim, np.zeros((1, 3))]).astype(np.float32)
    triangles = np.stack([np.full(n, 2 * n), 2 * np.arange(n), 2 * np.arange(n) + 1], axis=1).astype(np.int32)
    black = limner.Lambert((0.0, 0.0, 0.0))
    camera = limner.OrthographicCamera.look_at((0, 0, 2), (0, 0, 0), height=2.1)
    return limner.Scene(limner.Node(shapes=(limner.Shape(limner.Mesh(positions, triangles), black),)), camera, background=(1.0, 1.0, 1.0))


def main(target: str, small: bool = False) -> None:
    """Every pixel four times as large as it is."""
    side, times = (30, 2) if small else (80, 4)
    large = side * times
    sheet = Canvas(3 * large, 2 * (large + 26), "#dddddd")
    for k, (words, options) in enumerate(WAYS.items()):
        image = limner.render(fan(), width=side, height=side, **options)
        x, y = k % 3 * large, k // 3 * (large + 26)
        sheet.paste(limner.Image(image.pixels.repeat(times, axis=0).repeat(times, axis=1)), x, y + 26)
        sheet.text(x + large / 2, y + 18, words, "#222222", 14, "center")
    sheet.image().save(target)
    print(f"{target}: {', '.join(WAYS)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "antialiasing.png", "--small" in sys.argv)
