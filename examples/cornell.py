"""Global illumination (FoCG 23): the Cornell box by its measured walls, with direct light alone, and with all light.

What the lamp sees is lit in both. The red and green that bleed into the boxes, the ceiling, and all that lies in shadow are lit by light
that was scattered at least once: rays to the lamp never find it, paths do.

    python examples/cornell.py cornell.png
"""

from __future__ import annotations

import sys

import limner
from limner.draw.canvas import Canvas


def main(target: str, small: bool = False) -> None:
    """Bounces: one, two, and as many as it takes."""
    side, samples = (48, 4) if small else (400, 96)
    scene = limner.builtin("cornell")
    sheet = Canvas(3 * side, side, "black")
    for k, (depth, words) in enumerate(((1, "light from the lamp"), (2, "scattered twice"), (12, "all light"))):
        image = limner.render(
            scene, width=side, height=side, renderer="path", samples=samples, max_depth=depth, denoise="filter",
        )  # fmt: skip
        sheet.paste(image, k * side, 0).text(k * side + 10, side - 12, words, "white", 15)
        print(f"at most {depth} scatterings: mean {image.pixels[..., :3].mean():.4f}")
    sheet.image().save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "cornell.png", "--small" in sys.argv)
