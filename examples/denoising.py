"""Noise, and how it goes (FoCG 14.3, 23): few paths, four times as many, sixteen times, and few paths with a filter.

Four times the paths halve the noise. The filter looks at what is free of noise (colour of the surface, normal, depth) to tell an edge
from a speck, and gets from eight paths what would take a hundred, at the price of a little bias in soft shadows.

    python examples/denoising.py denoising.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas


def main(target: str, small: bool = False) -> None:
    """The same scene four times, and how far each is from the best of them."""
    side, few = (40, 2) if small else (200, 8)
    scene = limner.builtin("cornell")
    options = {"width": side, "height": side, "renderer": "path"}
    pictures = {f"{k * few} paths": limner.render(scene, samples=k * few, **options) for k in (1, 4, 16)}
    pictures[f"{few} paths, filtered"] = limner.render(scene, samples=few, denoise="filter", **options)
    best = np.minimum(list(pictures.values())[2].pixels, 1.0)
    sheet = Canvas(4 * side, side, "black")
    for k, (words, image) in enumerate(pictures.items()):
        sheet.paste(image, k * side, 0).text(k * side + 10, side - 12, words, "white", 15)
        print(f"{words}: {np.sqrt(np.mean((np.minimum(image.pixels, 1.0) - best) ** 2)):.4f} off")
    sheet.image().save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "denoising.png", "--small" in sys.argv)
