"""A caustic (FoCG 23, 13.1): light that a ball of glass gathers on the floor, by paths that come upon the lamp by chance.

No ray from the floor to the lamp gets through the ball: it would have to bend. So `path` finds this light only where a scattered ray, bent
twice, happens to hit the lamp, and a large lamp is hit more often. What noise is left, the filter takes out. The `ray` renderer, on the
left, lets light straight through the glass instead: it dims it, and does not focus it.

    python examples/caustic.py caustic.png
"""

from __future__ import annotations

import sys

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import frame_from_gaze, translate


def scene() -> limner.Scene:
    """Clear and amber glass on a table, under a lamp from behind."""
    amber = limner.Dielectric.with_color_at((0.95, 0.5, 0.1), 1.0, ior=1.5)
    lamp = frame_from_gaze((-2.2, 3.6, -2.2), (2.2, -3.6, 2.2), (0.0, 1.0, 0.0))
    nodes = (
        limner.Node(parent_from_node=translate(-0.55, 0.601, 0.0), shapes=(limner.Shape(limner.Sphere(0.6), limner.Dielectric(1.5)),)),
        limner.Node(parent_from_node=translate(0.75, 0.451, 0.25), shapes=(limner.Shape(limner.Sphere(0.45), amber),)),
        limner.Node(parent_from_node=lamp, lights=(limner.DiskLight(intensity=16.0, radius=0.7),)),
        limner.Node(lights=(limner.AmbientLight((0.7, 0.8, 1.0), intensity=0.06),)),
    )
    camera = limner.Camera.look_at((0.6, 2.2, 5.0), (0.3, 0.3, 0.4), yfov_degrees=32)
    return limner.Scene(limner.Node(children=nodes), camera, background=(0.05, 0.06, 0.08)).with_ground(limner.Lambert((0.6, 0.58, 0.55)))


def main(target: str, small: bool = False) -> None:
    """By rays, and by paths."""
    width, height, samples = (64, 48, 16) if small else (320, 240, 128)
    sheet = Canvas(2 * width, height, "black")
    sheet.paste(limner.render(scene(), width=width, height=height, renderer="ray", samples=16, sampler="multijittered"), 0, 0)
    sheet.paste(limner.render(scene(), width=width, height=height, renderer="path", samples=samples, denoise="filter"), width, 0)
    for k, words in enumerate(("ray: straight through", "path: focused")):
        sheet.text(k * width + 10, 22, words, "white", 15)
    sheet.image().save(target)
    print(f"{target}: {samples} paths a pixel")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "caustic.png", "--small" in sys.argv)
