"""Distribution ray tracing (FoCG 13.4): one scene six times, with one more thing drawn by lot in each picture.

One sample in a pixel; several; a lamp with an area; a lens; mirrors that are not perfect; and a shutter that stays open while things move.

    python examples/distribution.py distribution.png
"""

from __future__ import annotations

import math
import sys
from typing import Any

import numpy as np

import limner
from limner.linear.transform import frame_from_gaze, rotate_z, translate


def shown(geometry: object, material: object, place: np.ndarray, **fields: Any) -> limner.Node:
    """A node with one shape."""
    return limner.Node(parent_from_node=place, shapes=(limner.Shape(geometry, (material,)),), **fields)


def wheel(turn: limner.Motion) -> limner.Node:
    """A rim with six spokes that turns."""
    dark, steel = limner.Lambert((0.08, 0.08, 0.09)), limner.Lambert((0.55, 0.57, 0.6))
    spokes = (shown(limner.Box((0.05, 1.0, 0.05)), steel, rotate_z(math.pi * k / 3)) for k in range(3))
    rim = shown(limner.Torus(0.55, 0.09), dark, np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]]))
    return limner.Node("wheel", translate(1.15, 0.65, 0.3), children=(rim, *spokes), motion=turn)


def scene(*, area: bool, lens: bool, blur: float | None, rough: float) -> limner.Scene:
    """The scene, with as much of it soft as is said."""
    tiles = np.full((2, 2, 4), 255, dtype=np.uint8)
    tiles[[0, 1], [0, 1], :3] = (92, 60, 44)
    floor = limner.Lambert((0.8, 0.8, 0.8), texture=limner.Texture(limner.Texels(tiles), filter="nearest"))
    silver = limner.BlinnPhong(diffuse=(0.03, 0.03, 0.03), mirror=(0.85, 0.85, 0.88), mirror_blur=blur)
    gold = limner.MetallicRoughness((1.0, 0.72, 0.3), metallic=1.0, roughness=rough, double_sided=True)
    above = frame_from_gaze((-2.0, 4.0, 2.0), (2.0, -4.0, -2.0), (0.0, 1.0, 0.0))
    light = limner.DiskLight(intensity=14.0, radius=0.8) if area else limner.PointLight(intensity=14.0 * math.pi * 0.64)
    falling = limner.Motion.shift((-0.3, -0.6, 0.0))
    ball = shown(limner.Sphere(0.22), limner.Lambert((0.8, 0.1, 0.1)), translate(2.1, 1.25, -0.6), motion=falling)
    parts = (
        shown(limner.Plane(), floor, np.eye(4)),
        shown(limner.Sphere(0.5), silver, translate(-1.2, 0.5, -0.3)),
        shown(limner.Sphere(0.4), gold, translate(-0.15, 0.4, 0.8)),
        shown(limner.Box((0.5, 1.5, 0.5)), limner.Lambert((0.2, 0.35, 0.7)), translate(-0.1, 0.75, -2.6)),
        wheel(limner.Motion.turn((0, 0, 1), -50)),
        ball,
        limner.Node("lamp", above, lights=(light,)),
        limner.Node("ambient", lights=(limner.AmbientLight(intensity=0.18),)),
    )
    opening = {"aperture_radius": 0.09} if lens else {}
    camera = limner.Camera.look_at((0.2, 1.5, 4.6), (-0.15, 0.4, 0.8), yfov_degrees=38, **opening)
    return limner.Scene(limner.Node(children=parts), camera, background=(0.25, 0.3, 0.38))


def pictures(small: bool) -> list[np.ndarray]:
    """Six pictures, row 0 on top, sRGB codes."""
    plain = {"area": False, "lens": False, "blur": None, "rough": 0.0}
    steps: list[tuple[dict[str, Any], dict[str, Any]]] = [
        ({}, {"samples": 1}),
        ({}, {"samples": 16}),
        ({"area": True}, {"samples": 36}),
        ({"lens": True}, {"samples": 64}),
        ({"blur": 0.25, "rough": 0.35}, {"samples": 64, "glossy": True}),
        ({}, {"samples": 100, "shutter": (0.0, 1.0), "glossy": True}),
    ]
    width, height = (80, 52) if small else (400, 260)
    made, soft = [], dict(plain)
    for change, options in steps:
        soft.update(change)
        options["samples"] = math.isqrt(options["samples"]) if small else options["samples"]
        image = limner.render(scene(**soft), width=width, height=height, renderer="ray", sampler="multijittered", **options)
        made.append(image.to_uint8())
    return made


def main(target: str, small: bool = False) -> None:
    """Put them side by side, three in a row."""
    made = pictures(small)
    rows = [np.concatenate(made[k : k + 3], axis=1) for k in (0, 3)]
    codes = np.concatenate(rows, axis=0).astype(np.float32) / 255.0
    linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    linear[..., 3] = 1.0
    limner.Image(linear.astype(np.float32)).save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "distribution.png", "--small" in sys.argv)
