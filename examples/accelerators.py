"""What rays look at (FoCG 12.3): cells of a grid, nodes of a BSP and boxes of a tree for each pixel, and triangles.

A teapot in a stadium: steps around a field, and all the detail in one place. The columns are grid, BSP, the tree of least volumes and the
tree of eight children to a node, which limner uses; above, the parts of the structure that a pixel's ray visits, below, the triangles that
it meets: colours go with the logarithm, from none to a thousand. The grid has one size of cell, and the teapot fits into a few of them.

    python examples/accelerators.py accelerators.png
"""

from __future__ import annotations

import sys
from typing import cast

import numpy as np
from numpy.typing import NDArray

import limner
from limner.color.maps import mapped
from limner.draw.canvas import Canvas
from limner.image.image import Image
from limner.mesh.shapes.teapot import teapot
from limner.raycaster import Kind

KINDS = {"grid": "uniform grid", "bsp": "binary space partition", "volume_tree": "tree of least volumes", "bvh": "tree of eight"}
WIDTH, HEIGHT, LINE = 420, 300, 30
MOST = 1000.0
RINGS, SIDES = 12, 120


def stadium() -> NDArray[np.float64]:
    """(n, 3, 3): steps around a field of a hundred metres."""
    angle = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    around = np.stack([np.cos(angle), np.zeros(SIDES), 0.7 * np.sin(angle)], axis=1)
    radii = np.repeat(50.0 + 3.0 * np.arange(RINGS + 1), 2)[1:-1]
    heights = np.repeat(1.5 * np.arange(RINGS), 2)
    points = radii[:, None, None] * around + heights[:, None, None] * np.array([0.0, 1.0, 0.0])
    a, b = points, np.roll(points, -1, axis=1)
    steps = [np.stack(part, axis=-2).reshape(-1, 3, 3) for part in ((a[:-1], b[:-1], a[1:]), (a[1:], b[:-1], b[1:]))]
    middle = np.broadcast_to(np.zeros(3), a[0].shape)
    return np.concatenate([*steps, np.stack([middle, b[0], a[0]], axis=1)])


def triangles() -> NDArray[np.float64]:
    """(n, 3, 3): the stadium, and the teapot in the middle of its field."""
    pot = teapot(12, 3.0)
    return np.concatenate([stadium(), pot.positions[pot.triangles].astype(np.float64)])


def eye_rays(width: int, height: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The eye, and a direction (h, w, 3) for every pixel."""
    eye, target = np.array([6.0, 5.2, 12.0]), np.array([0.4, 1.8, 0.0])
    backward = (eye - target) / np.linalg.norm(eye - target)
    right = np.cross((0.0, 1.0, 0.0), backward)
    right /= np.linalg.norm(right)
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, height / 2 - np.arange(height) - 0.5)
    slope = np.tan(np.radians(55.0) / 2.0) / (height / 2)
    return eye, slope * (x[..., None] * right + y[..., None] * np.cross(backward, right)) - backward


def picture(counts: NDArray[np.int32]) -> Image:
    """Numbers as colours."""
    colors = mapped(np.log2(1.0 + counts), "inferno", (0.0, np.log2(1.0 + MOST)))
    return Image(np.concatenate([colors, np.ones((*counts.shape, 1), dtype=np.float32)], axis=-1))


def main(target: str, small: bool = False) -> None:
    """Two rows of pictures."""
    corners = triangles()
    width, height = (105, 75) if small else (WIDTH, HEIGHT)
    eye, directions = eye_rays(width, height)
    sheet = Canvas(len(KINDS) * width, 2 * (height + LINE), "#10131a")
    for column, (kind, name) in enumerate(KINDS.items()):
        caster = limner.RayCaster(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), accelerator=cast(Kind, kind))
        seen = caster.visits(eye, directions)
        for row, (counts, what) in enumerate(((seen.nodes, "parts"), (seen.triangles, "triangles"))):
            sheet.paste(picture(counts), column * width, row * (height + LINE) + LINE)
            words = f"{name}: {counts.mean():.1f} {what} a ray, at most {counts.max()}"
            sheet.text(column * width + 8, row * (height + LINE) + LINE / 2, words, "white", 15.0, baseline="middle")
    sheet.image().save(target)
    print(f"{target}: {len(corners)} triangles, {len(KINDS)} structures")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "accelerators.png", "--small" in sys.argv)
