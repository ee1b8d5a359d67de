"""A data set for learning: one model from all around, with depth, normals, masks, boxes and cameras.

A folder is written as programs that learn expect it: pictures, what each pixel is (depth in metres, normal, instance), annotations, and
each camera's matrix. The sheet shows three of the views, row by row: picture, depth, normals, masks. `limner dataset MODEL` does it from
the shell.

    python examples/training_data.py data.png        writes data.png and the folder data/
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import limner
from limner.color.maps import mapped
from limner.draw.canvas import Canvas
from limner.linear.transform import rotate, translate

INKS = np.array([(0.9, 0.3, 0.2), (0.2, 0.55, 0.85), (0.3, 0.7, 0.3), (0.05, 0.05, 0.06)], dtype=np.float32)  # the last for nothing


def scene() -> limner.Scene:
    """Three things on top of each other."""
    things = (
        ("pot", limner.primitives.teapot(8, 0.7), (0.75, 0.4, 0.25), translate(0.0, 0.5, 0.0)),
        ("crate", limner.primitives.box((1.3, 0.5, 1.0)), (0.45, 0.5, 0.6), translate(0.0, 0.25, 0.0) @ rotate((0, 1, 0), 0.3)),
        ("ring", limner.primitives.torus(0.3, 0.1), (0.35, 0.6, 0.35), translate(0.75, 0.1, 0.85)),
    )
    nodes = (
        limner.Node(name, place, shapes=(limner.Shape(mesh, limner.Lambert(color)),)) for name, mesh, color, place in things
    )
    return limner.Scene(limner.Node(children=tuple(nodes)))


def picture(rgb: np.ndarray) -> limner.Image:
    """(height, width, 3) colours as a picture."""
    return limner.Image(np.concatenate([rgb, np.ones_like(rgb[..., :1])], axis=-1).astype(np.float32))


def main(target: str, small: bool = False) -> None:
    """Write the folder, and three views of it on a sheet."""
    width, height, n = (48, 36, 3) if small else (240, 180, 24)
    shown = scene()
    cameras = limner.dataset.orbit_cameras(shown, n, elevation_degrees=25.0)
    written = limner.dataset.write(shown, cameras, Path(target).with_suffix(""), width=width, height=height, resume=True)
    sheet = Canvas(4 * width, 3 * height, "black")
    with limner.Renderer(shown, width=width, height=height, aovs=("depth", "normal", "instance_id")) as renderer:
        for row in range(3):
            image = renderer.render(cameras[row * n // 3])
            depth = image.aov["depth"]
            seen = np.isfinite(depth)
            spread = mapped(-np.where(seen, depth, depth[seen].max()), "viridis", (-depth[seen].max(), -depth[seen].min()))
            for column, what in enumerate(
                (image, picture(spread), picture((0.5 + 0.5 * image.aov["normal"]) ** 2.2), picture(INKS[image.aov["instance_id"]]))
            ):
                sheet.paste(what, column * width, row * height)
    sheet.image().save(target)
    print(f"{target}: {written}"[:300])


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "data.png", "--small" in sys.argv)
