"""Into a photograph: a teapot on a floor that shows nothing but shadows, laid over a picture that was there before.

`ShadowCatcher` is as transparent as it is lit, so what the camera returns has alpha: the pot, and darkness where light is missing. The
camera is the photograph's own; here the photograph is painted by arithmetic, a wooden table before a wall.

    python examples/shadow_catcher.py catcher.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import frame_from_gaze


def photograph(width: int, height: int) -> np.ndarray:
    """(height, width, 3) linear light: boards that run away from the eye, and a wall."""
    x, y = np.meshgrid((np.arange(width) + 0.5) / width - 0.5, (np.arange(height) + 0.5) / height)
    depth = 1.0 / np.maximum(y - 0.32, 1e-3)
    board = np.floor(x * depth * 1.1 + 0.5)
    grain = np.sin(60.0 * np.sin(board * 12.9) + 9.0 * depth) + 0.5 * np.sin(23.0 * x * depth + board)
    gap = np.abs(x * depth * 1.1 + 0.5 - board - 0.5) > 0.49
    wood = np.stack([0.34 + 0.03 * grain, 0.2 + 0.02 * grain, 0.11 + 0.012 * grain], axis=-1) * np.where(gap, 0.35, 1.0)[..., None]
    wall = np.array([0.42, 0.47, 0.5]) * (0.75 + 0.5 * x[..., None])
    return np.where((y < 0.36)[..., None], wall, wood * np.clip(1.25 - 0.06 * depth, 0.5, 1.2)[..., None]).astype(np.float32)


def scene() -> limner.Scene:
    """The pot, the catcher, a lamp, no background."""
    glaze = limner.MetallicRoughness(base_color=(0.12, 0.3, 0.55), metallic=0.0, roughness=0.2)
    frame = frame_from_gaze((2.6, 4.2, 2.2), (-2.6, -4.2, -2.2), (0.0, 1.0, 0.0))
    nodes = (
        limner.Node(shapes=(limner.Shape(limner.primitives.teapot(12, 1.0), glaze),)),
        limner.Node(shapes=(limner.Shape(limner.Plane(), limner.ShadowCatcher()),)),
        limner.Node(parent_from_node=frame, lights=(limner.DiskLight(intensity=26.0, radius=0.6, visible=False),)),
        limner.Node(lights=(limner.AmbientLight((0.8, 0.9, 1.0), intensity=0.25),)),
    )
    return limner.Scene(limner.Node(children=nodes), limner.Camera.look_at((0, 2.0, 5.6), (0.1, 0.75, 0), yfov_degrees=34))


def main(target: str, small: bool = False) -> None:
    """What was rendered, and what it looks like in its place."""
    width, height, samples = (72, 54, 4) if small else (440, 330, 49)
    image = limner.render(scene(), width=width, height=height, renderer="ray", samples=samples, sampler="multijittered")
    over = photograph(width, height)
    alpha = image.pixels[..., 3:]
    placed = np.concatenate([image.pixels[..., :3] * alpha + over * (1.0 - alpha), np.ones_like(alpha)], axis=-1)
    checks = (np.indices((height, width)) // 12).sum(axis=0) % 2
    plain = np.repeat(np.where(checks, 0.75, 0.6)[..., None], 3, axis=-1)
    shown = np.concatenate([image.pixels[..., :3] * alpha + plain * (1.0 - alpha), np.ones_like(alpha)], axis=-1).astype(np.float32)
    sheet = Canvas(2 * width, height, "white").paste(limner.Image(shown), 0, 0).paste(limner.Image(placed), width, 0)
    sheet.image().save(target)
    print(f"{target}: alpha from {alpha.min():.2f} to {alpha.max():.2f}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "catcher.png", "--small" in sys.argv)
