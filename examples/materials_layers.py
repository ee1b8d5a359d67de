"""What a glTF material may have beyond its core (sheen, coat, film, an inside …), on a shelf of balls under one lamp and the sky.

Behind: lacquer, velvet, a soap film on black, brushed steel, gold by its measured index. In front: plastic of index 2, frosted glass,
glass that is green where it is thick, a leaf with the light behind it, plaster.

    python examples/materials_layers.py materials.png
"""

from __future__ import annotations

import sys

import limner
from limner.linear.transform import translate
from limner.scene.material_extensions import (
    Anisotropy,
    Clearcoat,
    Conductor,
    DiffuseTransmission,
    Iridescence,
    Sheen,
    Specular,
    Transmission,
    Volume,
)  # fmt: skip
from limner.scene.procedural import Checker

STEP = 2.3  # from ball to ball


def plastic(color: tuple[float, float, float], roughness: float = 0.4, **layers: object) -> limner.MetallicRoughness:
    """What is no metal, with layers."""
    return limner.MetallicRoughness(color, metallic=0.0, roughness=roughness, **layers)


MATERIALS = (
    (
        plastic((0.5, 0.02, 0.02), 0.6, clearcoat=Clearcoat(roughness=0.05)),
        plastic((0.15, 0.02, 0.1), 0.9, sheen=Sheen((0.9, 0.5, 0.8), 0.4)),
        plastic((0.01, 0.01, 0.01), 0.1, iridescence=Iridescence(ior=1.4, thickness_maximum=450.0)),
        limner.MetallicRoughness((0.6, 0.6, 0.62), roughness=0.3, anisotropy=Anisotropy(0.8)),
        limner.MetallicRoughness(roughness=0.35, conductor=Conductor.named("gold"), energy_compensation=True),
    ),
    (
        plastic((0.05, 0.1, 0.4), 0.2, ior=2.0, specular=Specular(1.0, (1.0, 0.8, 0.6))),
        limner.Dielectric(1.5, tint=(0.9, 0.95, 1.0), roughness=0.45, energy_compensation=True),
        plastic((1.0, 1.0, 1.0), 0.0, transmission=Transmission(), volume=Volume(1.0, None, 1.0, (0.55, 0.95, 0.7)), dispersion=0.4),
        plastic((0.1, 0.35, 0.05), 0.6, diffuse_transmission=DiffuseTransmission(0.6, (0.5, 0.8, 0.1))),
        limner.Lambert((0.8, 0.76, 0.7), roughness_degrees=35.0),
    ),
)


def main(target: str, small: bool = False) -> None:
    """Put them in two rows on a ground, and follow light through them."""
    ball = limner.primitives.sphere(1.0, 12 if small else 64)
    nodes = [
        limner.Node(
            parent_from_node=translate((column - (len(row) - 1) / 2) * STEP, 1.0, k * 1.25 * STEP),
            shapes=(limner.Shape(ball, (material,)),),
        )
        for k, row in enumerate(MATERIALS)
        for column, material in enumerate(row)
    ]
    lamp = limner.Node(parent_from_node=translate(-4, 8, 6), lights=(limner.SphereLight(intensity=48.0, radius=2.0),))
    camera = limner.Camera.look_at((0, 9, 14), (0, 0.6, 1.3), yfov_degrees=28.5)
    scene = limner.Scene(limner.Node(children=(*nodes, lamp)), camera=camera, environment=limner.Environment((0.3, 0.34, 0.42)))
    squares = Checker(((0.12, 0.13, 0.16), (0.38, 0.37, 0.35)), scale=2.0 / STEP, offset=(0.5, 0.5, 0.5))
    scene = scene.with_ground(limner.Lambert((1.0, 1.0, 1.0), texture=squares))
    width, height, samples = (96, 54, 4) if small else (640, 360, 192)
    limner.render(scene, width=width, height=height, renderer="path", samples=samples, denoise="filter").save(target)
    print(f"{target}: {len(nodes)} materials")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "materials.png", "--small" in sys.argv)
