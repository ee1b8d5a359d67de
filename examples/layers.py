"""Light in layers: one rendering, mixed anew without rendering again, and everything else that one EXR file holds.

A picture is the sum of what each lamp brings. The path tracer keeps them apart (`aovs=("light_groups",)`), so that a lamp can be dimmed or
tinted afterwards. Below, what else was kept: depth, normals and who is who, which a compositor masks with.

    python examples/layers.py layers.png        writes layers.png and layers.exr
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import frame_from_gaze, rotate, translate


def lamp(name: str, place: tuple[float, float, float], color: tuple[float, float, float], power: float) -> limner.Node:
    """A panel that shines at the origin."""
    frame = frame_from_gaze(place, tuple(-value for value in place), (0.0, 1.0, 0.0))
    return limner.Node(parent_from_node=frame, lights=(limner.RectangleLight(color, power, 1.2, 1.2, visible=False, name=name),))


def scene() -> limner.Scene:
    """A teapot and a ball between a warm lamp and a cold one."""
    clay, gray = limner.Lambert((0.7, 0.62, 0.55)), limner.Lambert((0.5, 0.5, 0.5))
    nodes = (
        limner.Node("pot", rotate((0, 1, 0), 0.3), shapes=(limner.Shape(limner.primitives.teapot(10, 0.7), clay),)),
        limner.Node("ball", translate(1.15, 0.35, 0.7), shapes=(limner.Shape(limner.Sphere(0.35), gray),)),
        lamp("warm", (-2.6, 2.0, 1.6), (1.0, 0.62, 0.3), 30.0),
        lamp("cold", (2.8, 2.4, 0.6), (0.35, 0.6, 1.0), 30.0),
    )
    camera = limner.Camera.look_at((0.4, 1.7, 4.6), (0.15, 0.5, 0.0), yfov_degrees=30)
    return limner.Scene(limner.Node(children=nodes), camera).with_ground(gray)


def seen(values: np.ndarray) -> limner.Image:
    """(height, width, 3) as a picture."""
    return limner.Image(np.concatenate([values, np.ones_like(values[..., :1])], axis=-1).astype(np.float32))


def main(target: str, small: bool = False) -> None:
    """Render once, show six things."""
    width, height, samples = (64, 48, 4) if small else (320, 240, 25)
    image = limner.render(
        scene(), width=width, height=height, renderer="path", samples=samples, aovs=("light_groups", "depth", "normal", "instance_id"),
    )  # fmt: skip
    image.save(Path(target).with_suffix(".exr"))
    warm, cold = image.aov["light_warm"], image.aov["light_cold"]
    depth = image.aov["depth"]
    near, far = depth.min(), np.percentile(depth[np.isfinite(depth)], 90)
    gray = np.clip((far - depth) / (far - near), 0.0, 1.0)[..., None].repeat(3, axis=-1)
    colors = np.array([(0.75, 0.3, 0.2), (0.2, 0.5, 0.75), (0.35, 0.38, 0.4), (0.05, 0.05, 0.06)])
    shown = {
        "warm lamp": seen(warm),
        "cold lamp": seen(cold),
        "warm, and a third of the cold, reddened": seen(warm + cold * (0.45, 0.2, 0.25)),
        "depth": seen(gray**2.2),
        "normal": seen((0.5 + 0.5 * image.aov["normal"]) ** 2.2),
        "instance": seen(colors[image.aov["instance_id"]]),
    }
    sheet = Canvas(3 * width, 2 * height, "black")
    for k, (words, picture) in enumerate(shown.items()):
        sheet.paste(picture, k % 3 * width, k // 3 * height).text(k % 3 * width + 10, k // 3 * height + 22, words, "white", 14)
    sheet.image().save(target)
    print(f"{target}: layers {', '.join(image.aov)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "layers.png", "--small" in sys.argv)
