"""Rays of one's own: a `RayCaster` measures how far a twisted teapot is below each point of a sheet, pose after pose.

The triangles stay and their corners move, so the tree is fitted anew instead of being built again: `refit` takes a fraction of the time,
and finds the same. Bright is near; outlines are where the distance jumps.

    python examples/ray_batches.py ray_batches.png
"""

from __future__ import annotations

import sys
import time

import numpy as np

import limner
from limner.draw.canvas import Canvas


def twisted(positions: np.ndarray, angle: float) -> np.ndarray:
    """Turned about +y, the more the higher."""
    turn = angle * positions[:, 1]
    x, y, z = positions.T
    return np.stack([x * np.cos(turn) + z * np.sin(turn), y, z * np.cos(turn) - x * np.sin(turn)], axis=-1)


def gray(distances: np.ndarray) -> limner.Image:
    """Near is bright, nothing is dark blue, jumps are lines."""
    hit = np.isfinite(distances)
    light = np.where(hit, 1.25 - 0.5 * np.where(hit, distances, 0.0), 0.0)
    filled = np.where(hit, distances, 9.0)
    edge = np.hypot(*np.gradient(filled)) > 0.12
    color = np.where(hit[..., None], np.clip(light, 0.03, 1.0)[..., None] ** 2.2 * (1.0, 0.93, 0.82), (0.01, 0.015, 0.03))
    color[edge] *= 0.35
    return limner.Image(np.concatenate([color, np.ones_like(color[..., :1])], axis=-1).astype(np.float32))


def main(target: str, small: bool = False) -> None:
    """Six poses; how long building, fitting and casting take is printed."""
    width, height = (48, 32) if small else (320, 224)
    mesh = limner.primitives.teapot(6 if small else 24, 1.0)
    began = time.perf_counter()
    caster = limner.RayCaster(mesh.positions, mesh.triangles)
    print(f"{len(mesh.triangles)} triangles: built in {1e3 * (time.perf_counter() - began):.0f} ms")
    x, y = np.meshgrid(np.linspace(-1.55, 1.55, width), np.linspace(2.2, 0.03, height))
    origins = np.stack([x, y, np.full_like(x, 2.0)], axis=-1)
    sheet = Canvas(3 * width, 2 * height, "black")
    for k, angle in enumerate(np.linspace(-2.5, 2.5, 6)):
        began = time.perf_counter()
        caster.refit(twisted(mesh.positions, angle))
        fitted = time.perf_counter()
        hits = caster.intersect(origins, (0.0, -0.25, -1.0))
        cast = time.perf_counter()
        print(f"twist {angle:+.1f}: fitted in {1e3 * (fitted - began):.1f} ms, {hits.t.size} rays in {1e3 * (cast - fitted):.1f} ms")
        left, top = k % 3 * width, k // 3 * height
        sheet.paste(gray(hits.t), left, top).text(left + 8, top + 18, f"{angle:+.1f} rad/m", "white", 12)
    sheet.image().save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "ray_batches.png", "--small" in sys.argv)
