"""Ray tracing's first picture (FoCG 4.8, 13.1): a hollow ball of glass before a mirroring one, over a checkered floor.

After Whitted, An Improved Illumination Model for Shaded Display (1980): every hit sends a ray to the lamp, one along the reflection, and
one through the glass. One lamp, perfectly sharp shadows; what mirrors is not lit by lot, so the picture has no noise.

    python examples/whitted.py whitted.png
"""

from __future__ import annotations

import sys

import limner
from limner.linear.transform import translate

CHECKS = limner.Checker(((0.9, 0.75, 0.1), (0.75, 0.06, 0.04)), scale=1.0, offset=(0.0, 0.5, 0.0))


def ball(radius: float, place: tuple[float, float, float], material: limner.Dielectric | limner.BlinnPhong) -> limner.Node:
    """A sphere somewhere."""
    return limner.Node(parent_from_node=translate(*place), shapes=(limner.Shape(limner.Sphere(radius), material),))


def scene() -> limner.Scene:
    """Two balls, a floor that ends, a lamp, a blue sky."""
    silver = limner.BlinnPhong(diffuse=(0.04, 0.04, 0.05), specular=(0.5, 0.5, 0.5), exponent=400, mirror=(0.75, 0.75, 0.78))
    floor = limner.Shape(limner.Box((8.0, 0.2, 16.0)), limner.Lambert((0.95, 0.95, 0.95), texture=CHECKS))
    nodes = (
        limner.Node(parent_from_node=translate(0.0, -0.1, -4.0), shapes=(floor,)),
        ball(0.85, (-0.55, 1.25, 0.9), limner.Dielectric(1.5)),
        ball(0.8, (-0.55, 1.25, 0.9), limner.Dielectric(1.0)),  # the hollow: air in the glass
        ball(0.95, (0.85, 0.96, -0.8), silver),
        limner.Node(parent_from_node=translate(-3.0, 7.0, 5.0), lights=(limner.PointLight(intensity=150.0),)),
        limner.Node(lights=(limner.AmbientLight(intensity=0.35),)),
    )
    camera = limner.Camera.look_at((0.0, 1.9, 6.2), (0.0, 0.95, 0.0), yfov_degrees=34)
    return limner.Scene(limner.Node(children=nodes), camera, background=(0.18, 0.36, 0.75))


def main(target: str, small: bool = False) -> None:
    """Nine rays a pixel, no chance."""
    width, height, samples = (128, 80, 1) if small else (960, 600, 9)
    limner.render(scene(), width=width, height=height, renderer="ray", samples=samples, max_depth=8).save(target)
    print(f"{target}: {samples} rays through each pixel")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "whitted.png", "--small" in sys.argv)
