"""Displacement (FoCG 11.4.3): height maps that move the surface, on as many triangles as the picture needs.

A moon with craters, a studded torus and a worn block over a stretch of dunes. Outlines change, parts hide each other, shadows fall where
they should.

    python examples/displacement.py displacement.png
"""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray

import limner
from limner.linear.transform import in_order, rotate, translate
from limner.mesh.projection import project_uvs
from limner.mesh.shapes import primitives
from limner.scene.displacement import Displacement

Heights = NDArray[np.float64]


def texture(heights: Heights) -> limner.Texture:
    """Heights as a texture of 8 bits, least to greatest; row 0 at the bottom."""
    low, high = heights.min(), heights.max()
    grey = np.round(255.0 * (heights - low) / (high - low)).astype(np.uint8)
    return limner.Texture(limner.Texels(np.repeat(grey[..., None], 4, axis=2), srgb=False))


def waves(rows: int, columns: int, seed: int, roughness: float = 1.6) -> Heights:
    """Noise that repeats on all sides: cosines of random phase, weaker the faster they are."""
    rng = np.random.default_rng(seed)
    fast = np.hypot(*np.meshgrid(np.fft.fftfreq(columns) * columns, np.fft.fftfreq(rows) * rows))
    fast[0, 0] = np.inf
    phases = np.exp(2j * np.pi * rng.random((rows, columns)))
    return np.asarray(np.fft.ifft2(phases / fast**roughness).real * np.sqrt(rows * columns) * rows)


def craters(rows: int, columns: int, n: int = 70) -> Heights:
    """A rim round a bowl, n times on a sphere; where two meet, the later one."""
    rng = np.random.default_rng(4)
    u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    polar, around = np.pi * (1.0 - v), 2.0 * np.pi * (u - 0.5)
    place = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    # Fades out to the poles, where a row of texels is a point.
    heights = 0.03 * waves(rows, columns, 1, 1.9) * np.sin(polar) ** 2
    for _ in range(n):
        middle = rng.normal(size=3)
        radius = 0.06 + 0.32 * rng.random() ** 3
        far = np.arccos(np.clip(place @ (middle / np.linalg.norm(middle)), -1.0, 1.0)) / radius
        bowl = radius * np.minimum(far**2 - 0.8, 0.2 * np.exp(-4.0 * np.maximum(far - 1.0, 0.0)))
        share = np.clip((1.6 - far) / 0.6, 0.0, 1.0)
        heights = heights * (1.0 - share) + bowl * share
    return heights


def studs(n: int = 64) -> Heights:
    """Half a ball in the middle of a square."""
    x = 2.0 * (np.arange(n) + 0.5) / n - 1.0
    return np.asarray(np.sqrt(np.maximum(0.0, 0.45 - x[:, None] ** 2 - x**2)))


def dunes(rows: int = 256, columns: int = 256) -> Heights:
    """Steep to one side, bent by slow noise."""
    slow = waves(rows, columns, 7, 3.0)
    phase = 2.0 * np.pi * (np.arange(columns) / columns * 9.0 + slow / np.abs(slow).max() * 0.8)
    return np.asarray(0.5 + 0.5 * np.sin(phase + 0.7 * np.sin(phase))) + 0.004 * waves(rows, columns, 8, 2.0)


def main(target: str, small: bool = False) -> None:
    """Put them over the dunes, and look."""
    grey = limner.BlinnPhong(diffuse=(0.55, 0.53, 0.5), specular=(0.04, 0.04, 0.04), exponent=20)
    green = limner.BlinnPhong(diffuse=(0.1, 0.35, 0.18), specular=(0.4, 0.4, 0.4), exponent=80)
    brick = limner.Lambert((0.5, 0.2, 0.12))
    sand = limner.Lambert((0.62, 0.48, 0.3))
    ball = project_uvs(primitives.sphere(1.0, 24), "sphere", axis="y")
    moon = limner.Shape(ball, (grey,), displacement=Displacement(texture(craters(64, 128) if small else craters(512, 1024)), 0.35, 0.5))
    studded = texture(studs())
    ring = limner.Shape(
        limner.Torus(0.8, 0.3), (green,),
        displacement=Displacement(limner.Texture(studded.texels, scale=(24.0, 9.0)), 0.09),
    )  # fmt: skip
    worn = texture(waves(256, 256, 3))
    block = limner.Shape(project_uvs(primitives.box((1.2, 1.2, 1.2)), "box"), (brick,), displacement=Displacement(worn, 0.25, 0.5))
    ground = limner.Shape(
        primitives.quad([[-8, 0, 8], [8, 0, 8], [8, 0, -8], [-8, 0, -8]]), (sand,), displacement=Displacement(texture(dunes()), 0.45)
    )
    nodes = (
        limner.Node("ground", shapes=(ground,)),
        limner.Node("moon", translate(-1.7, 1.5, 0.0), shapes=(moon,)),
        limner.Node("ring", in_order(rotate((1, 0, 0), 1.1), translate(0.9, 1.2, 0.5)), shapes=(ring,)),
        limner.Node("block", in_order(rotate((0, 1, 0), 0.6), translate(3.0, 1.0, -0.6)), shapes=(block,)),
        limner.Node("sun", rotate((0, 1, 0), -0.9) @ rotate((1, 0, 0), -0.45), lights=(limner.DirectionalLight(intensity=3.0),)),
        limner.Node("sky", lights=(limner.AmbientLight((0.5, 0.65, 1.0), intensity=0.35),)),
    )
    camera = limner.Camera.look_at((0.6, 2.6, 8.5), (0.5, 0.9, 0), yfov_degrees=34)
    scene = limner.Scene(limner.Node(children=nodes), camera=camera, background=(0.45, 0.6, 0.85))
    width, height, samples = (120, 75, 1) if small else (960, 600, 8)
    image = limner.render(scene, width=width, height=height, renderer="ray", samples=samples)
    image.save(target)
    print(f"{target}: {len(nodes) - 2} displaced shapes")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "displacement.png", "--small" in sys.argv)
