"""Highlights (FoCG 4.5.2, 10.2): Phong's and Blinn's by exponent, and a microfacet's by roughness.

From left to right the surface gets smoother. Above, the reflection's angle to the eye (Phong 1975); in the middle, the half vector's to
the normal (Blinn 1977), wider for the same exponent; below, GGX facets of metal, whose highlights have long tails and keep their energy.

    python examples/highlights.py highlights.png
"""

from __future__ import annotations

import sys

import limner
from limner.linear.transform import rotate, translate

EXPONENTS = (4, 16, 64, 256, 1024)
ROUGHNESS = (0.75, 0.55, 0.4, 0.28, 0.18)
RED, GREEN = (0.5, 0.06, 0.04), (0.05, 0.3, 0.14)


def rows() -> list[list[limner.BlinnPhong | limner.MetallicRoughness]]:
    """Three formulas, five smoothnesses."""
    shiny = {"specular": (0.6, 0.6, 0.6)}
    return [
        [limner.BlinnPhong(diffuse=RED, exponent=p, highlight="phong", **shiny) for p in EXPONENTS],
        [limner.BlinnPhong(diffuse=GREEN, exponent=p, **shiny) for p in EXPONENTS],
        [limner.MetallicRoughness(base_color=(0.95, 0.72, 0.4), metallic=1.0, roughness=r) for r in ROUGHNESS],
    ]


def main(target: str, small: bool = False) -> None:
    """Fifteen balls under two suns."""
    balls = [
        limner.Node(parent_from_node=translate(2.15 * (k - 2), 2.15 * (1 - row), 0.0), shapes=(limner.Shape(limner.Sphere(1.0), material),))
        for row, materials in enumerate(rows())
        for k, material in enumerate(materials)
    ]
    suns = [
        limner.Node(parent_from_node=rotate((0, 1, 0), turn) @ rotate((1, 0, 0), -0.6), lights=(limner.DirectionalLight(intensity=power),))
        for turn, power in ((-0.7, 2.4), (1.2, 0.7))
    ]
    air = limner.Node(lights=(limner.AmbientLight(intensity=0.25),))
    camera = limner.Camera.look_at((0, 0, 24), (0, 0, 0), yfov_degrees=16)
    scene = limner.Scene(limner.Node(children=(*balls, *suns, air)), camera, background=(0.12, 0.13, 0.15))
    width, height, samples = (150, 90, 2) if small else (1000, 600, 8)
    limner.render(scene, width=width, height=height, samples=samples, antialiasing="supersample").save(target)
    print(f"{target}: exponents {EXPONENTS}, roughness {ROUGHNESS}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "highlights.png", "--small" in sys.argv)
