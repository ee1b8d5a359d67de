"""What a pixel sees of a texture (FoCG 11.3): a chessboard to the horizon, one sample a pixel, through each filter.

Left to right, top to bottom: nearest and bilinear, which look at the pixel's middle and flicker; trilinear, which blurs the
distance, since its squares are as large as the footprint is long; anisotropic, several small squares in its place; ripmap,
rectangles, which are sharp where the board runs along the picture; and what all are after: bilinear with 64 samples a pixel.

    python examples/texture_filters.py filters.png
"""

from __future__ import annotations

import sys
from typing import get_args

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import AmbientLight
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Plane, Shape
from limner.scene.texture import Filter, Texels, Texture


def chessboard() -> Texels:
    """Two by two fields of 64 by 64 texels."""
    column, row = np.indices((128, 128)) // 64
    pixels = np.full((128, 128, 4), 255, dtype=np.uint8)
    pixels[column != row, :3] = (140, 30, 25)
    return Texels(pixels)


def floor(name: Filter, samples: int, width: int, height: int) -> np.ndarray:
    """The board as far as one can see: (height, width, 4) float32."""
    board = Lambert(color=1, texture=Texture(chessboard(), filter=name))
    scene = Scene(
        root=Node(shapes=(Shape(Plane(), (board,)),), lights=(AmbientLight(intensity=1.0),)),
        camera=PerspectiveCamera.look_at((0.3, 0.6, 0.0), (0.45, 0.4, -1.0), yfov_degrees=50),
        background=(0.25, 0.4, 0.7),
    )
    return limner.render(scene, width=width, height=height, samples=samples, antialiasing="supersample").pixels


def main(target: str, small: bool = False) -> None:
    """Render the floor six times and save the sheet."""
    size = (96, 64) if small else (384, 256)
    tiles = [floor(name, 1, *size) for name in get_args(Filter)]
    tiles.append(floor("bilinear", 64, *size))
    sheet = Canvas(3 * size[0], 2 * size[1], "white")
    for k, (words, tile) in enumerate(zip((*get_args(Filter), "64 samples"), tiles, strict=True)):
        x, y = k % 3 * size[0], k // 3 * size[1]
        sheet.paste(limner.Image(tile), x, y).text(x + 10, y + 22, words, "white", 15)
    sheet.image().save(target)
    print(f"{target}: {', '.join(get_args(Filter))}, 64 samples")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "filters.png", "--small" in sys.argv)
