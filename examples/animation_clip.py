"""An animation: a ball that bounces, squashed where it lands, as an animated picture with motion blur (FoCG 12.2, 13.4.5, 16).

Three tracks of keys say where the ball is, how it is turned and how it is stretched; falling is a parabola, so the keys lie on one. The
shutter stays open for half of the time between two pictures.

    python examples/animation_clip.py bounce.webp
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.linear import quaternion
from limner.linear.transform import rotate_x, rotate_y

SECONDS, HIGH, RADIUS = 1.0, 1.5, 0.4
CHECKS = limner.Checker(((0.85, 0.12, 0.08), (0.95, 0.9, 0.85)), scale=2.0)


def bounce() -> limner.Animation:
    """Down and up once, so that it can be played for ever."""
    times = np.linspace(0.0, SECONDS, 33)
    share = 1.0 - (2.0 * np.abs(times / SECONDS - 0.5) - 1.0) ** 2  # 0 high up, 1 where it lands
    fall = np.clip(2.0 * share, 0.0, 1.0) ** 8 * share**8
    squash = 1.0 - 0.38 * fall
    heights = HIGH * (1.0 - share) + RADIUS * squash
    places = limner.Track(times, [(0.0, y, 0.0) for y in heights])
    turns = limner.Track(times, [quaternion.from_axis_angle((0, 0, 1), -2.0 * np.pi * t / SECONDS) for t in times], rotates=True)
    sizes = limner.Track(times, [(1.0, 1.0, 1.0) for _ in times])
    still = limner.Track.constant((0, 0, 0, 1), rotates=True)
    flat = limner.Track(times, [(1.0 / np.sqrt(s), s, 1.0 / np.sqrt(s)) for s in squash])
    return limner.Animation(
        "bounce",
        (
            limner.NodeChannel("world/place", limner.KeyedMotion(places, still, flat)),
            limner.NodeChannel("world/place/ball", limner.KeyedMotion(limner.Track.constant((0, 0, 0)), turns, sizes)),
        ),
    )


def scene() -> limner.Scene:
    """The ball over a floor."""
    ball = limner.Node("ball", shapes=(limner.Shape(limner.Sphere(RADIUS), limner.Lambert((1, 1, 1), texture=CHECKS)),))
    lights = (limner.DirectionalLight(intensity=2.6), limner.AmbientLight(intensity=0.3))
    sun = limner.Node("sun", rotate_y(0.7) @ rotate_x(-1.0), lights=lights)
    floor = limner.Node("floor", shapes=(limner.Shape(limner.Plane(), limner.Lambert((0.5, 0.52, 0.56))),))
    camera = limner.Camera.look_at((0.0, 1.3, 5.2), (0.0, 0.95, 0.0), yfov_degrees=30)
    root = limner.Node("world", children=(limner.Node("place", children=(ball,)), floor, sun))
    return limner.Scene(root, camera, (0.7, 0.78, 0.88), animations=(bounce(),))


def main(target: str, small: bool = False) -> None:
    """Write the clip."""
    fps, width, height, samples = (4, 40, 40, 1) if small else (24, 280, 280, 25)
    clip = limner.write_animation(
        scene(), target, fps=fps, end=SECONDS - 1.0 / fps, quality=80, width=width, height=height, renderer="ray", samples=samples,
        shutter=0.5,
    )  # fmt: skip
    print(f"{clip.path}: {clip.n_pictures} pictures, {clip.path.stat().st_size // 1024} KiB")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "bounce.webp", "--small" in sys.argv)
