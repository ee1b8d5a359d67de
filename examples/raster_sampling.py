"""An image as a function (FoCG 3.2), and what is left of it in few bits (3.2.1).

Left to right, top to bottom: a corner of a small picture, magnified by each filter; the whole of it in two bits a channel, by each dither.

    python examples/raster_sampling.py sampling.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.color.transfer import linear_from_srgb, srgb_from_linear
from limner.image.quantize import DITHERS, quantize
from limner.image.reconstruct import FILTERS


def main(target: str, small: bool = False) -> None:
    """Render once, look at it in ten ways, save the sheet."""
    side = 48 if small else 192
    image = limner.render("teapot", width=side, height=side)
    y, x = np.mgrid[0:side, 0:side]
    magnified = [image.sample(0.42 * side + x / 8, 0.18 * side + y / 8, filter=name) for name in FILTERS]
    encoded = srgb_from_linear(image.pixels[..., :3])
    few = []
    for dither in (None, *DITHERS):
        pixels = np.ones((side, side, 4), dtype=np.float32)
        pixels[..., :3] = linear_from_srgb(quantize(encoded, 2, dither) / 3.0)
        few.append(pixels)
    sheet = np.concatenate([np.concatenate(row, axis=1) for row in (magnified, few)], axis=0)
    limner.Image(sheet).save(target)
    print(f"{target}: {', '.join(FILTERS)}; {', '.join(map(str, (None, *DITHERS)))}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "sampling.png", "--small" in sys.argv)
