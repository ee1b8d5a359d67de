"""Pictures that say their space (FoCG 19.2): one picture written in the numbers of five spaces, and what becomes of it if nobody listens.

A file says what its numbers mean (an ICC profile in PNG, chromaticities in EXR). Above, each as a program shows it that heeds this: all
alike. Below, as one shows it that takes every number for sRGB: the wider the space, the paler the picture.

    python examples/color_spaces.py color_spaces.png
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

import limner
from limner.color.transfer import linear_from_srgb
from limner.draw.canvas import Canvas
from limner.linear.transform import translate

SPACES = ("srgb", "display_p3", "adobe_rgb", "rec2020", "prophoto")


def scene() -> limner.Scene:
    """Balls of strong colours."""
    paints = ((0.85, 0.05, 0.04), (0.9, 0.5, 0.02), (0.1, 0.6, 0.08), (0.02, 0.35, 0.7), (0.4, 0.05, 0.5))
    balls = [
        limner.Node(parent_from_node=translate(0.75 * (k % 3) - 0.75 + 0.38 * (k // 3), 0.34, 0.7 * (k // 3) - 0.3), shapes=(
            limner.Shape(limner.Sphere(0.34), (limner.MetallicRoughness(paint, 0.0, 0.35),)),))
        for k, paint in enumerate(paints)
    ]  # fmt: skip
    lamp = limner.Node(parent_from_node=translate(-2.0, 3.0, 2.5), lights=(limner.SphereLight(intensity=65.0, radius=0.3, visible=False),))
    sky = limner.Node(lights=(limner.AmbientLight((0.9, 0.95, 1.0), 0.35),))
    camera = limner.Camera.look_at((0.0, 1.5, 3.6), (0.0, 0.3, 0.1), yfov_degrees=30)
    return limner.Scene(limner.Node(children=(*balls, lamp, sky)), camera).with_ground(limner.Lambert((0.7, 0.7, 0.7)))


def main(target: str, small: bool = False) -> None:
    """One rendering, five files, read twice each."""
    width, height, samples = (32, 24, 2) if small else (190, 150, 32)
    picture = limner.render(scene(), width=width, height=height, renderer="ray", samples=samples)
    sheet = Canvas(len(SPACES) * width, 2 * height, "white")
    with tempfile.TemporaryDirectory() as folder:
        for k, space in enumerate(SPACES):
            path = Path(folder) / f"{space}.png"
            picture.save(path, color_space=space, bits=16)
            heeded = limner.open_image(path)
            picture.save(path, color_space=space)
            with Image.open(path) as stored:
                codes = np.asarray(stored.convert("RGB"))
            ignored = np.ones((height, width, 4), dtype=np.float32)
            ignored[..., :3] = linear_from_srgb(codes / 255.0)
            print(f"{space}: heeded, off by {np.abs(heeded.pixels - picture.pixels)[..., :3].max():.4f} at most")
            sheet.paste(heeded, k * width, 0).paste(limner.Image(ignored), k * width, height)
            sheet.text(k * width + 6, 16, space, "white", 12).text(k * width + 6, height + 16, "taken for srgb", "white", 12)
    sheet.image().save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "color_spaces.png", "--small" in sys.argv)
