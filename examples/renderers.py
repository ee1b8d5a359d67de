"""One scene, four renderers: the pipeline, rays, paths, and lines.

All read the same description and shade by the same formulas. `raster` asks what each triangle covers: no reflections, no soft shadows, and
the fastest by far. `ray` adds mirrors, glass and shadows; `path` adds light from surface to surface; `lines` leaves all but outlines out.

    python examples/renderers.py renderers.png
"""

from __future__ import annotations

import sys

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import frame_from_gaze, rotate, translate

WAYS = {"raster": {}, "ray": {"samples": 36, "glossy": True}, "path": {"samples": 144, "denoise": "filter"}, "lines": {}}


def scene() -> limner.Scene:
    """A corner with a red wall, a mirror, glass, and a teapot."""
    silver = limner.BlinnPhong(diffuse=(0.04, 0.04, 0.04), mirror=(0.85, 0.85, 0.87))
    glaze = limner.MetallicRoughness(base_color=(0.15, 0.42, 0.4), metallic=0.0, roughness=0.25)
    white, red = limner.Lambert((0.72, 0.7, 0.66)), limner.Lambert((0.7, 0.1, 0.07))
    lamp = frame_from_gaze((1.6, 3.6, 2.6), (-1.8, -3.4, -2.6), (0.0, 1.0, 0.0))
    things = (
        (limner.Box((6.0, 0.1, 6.0)), white, translate(0.0, -0.05, 0.0)),
        (limner.Box((6.0, 4.0, 0.1)), white, translate(0.0, 2.0, -1.8)),
        (limner.Box((0.1, 4.0, 6.0)), red, translate(-1.9, 2.0, 0.0)),
        (limner.Sphere(0.55), silver, translate(-0.85, 0.551, -0.7)),
        (limner.Sphere(0.38), limner.Dielectric(1.5), translate(0.55, 0.381, 0.85)),
        (limner.primitives.teapot(10, 0.55), glaze, translate(0.55, 0.0, -0.6) @ rotate((0, 1, 0), 0.5)),
        (limner.Box(0.5), white, translate(-0.7, 0.25, 0.75) @ rotate((0, 1, 0), 0.4)),
    )
    nodes = [limner.Node(parent_from_node=place, shapes=(limner.Shape(geometry, paint),)) for geometry, paint, place in things]
    light = limner.RectangleLight(intensity=13.0, width=1.3, height=1.3, visible=False)
    nodes += [limner.Node(parent_from_node=lamp, lights=(light,)), limner.Node(lights=(limner.AmbientLight(intensity=0.1),))]
    camera = limner.Camera.look_at((1.5, 1.7, 4.6), (-0.1, 0.55, 0.0), yfov_degrees=32)
    return limner.Scene(limner.Node(children=tuple(nodes)), camera)


def main(target: str, small: bool = False) -> None:
    """Two rows of two."""
    width, height = (72, 54) if small else (480, 360)
    sheet = Canvas(2 * width, 2 * height, "white")
    for k, (renderer, options) in enumerate(WAYS.items()):
        chosen = {**options, "samples": 4} if small and "samples" in options else options
        image = limner.render(scene(), width=width, height=height, renderer=renderer, **chosen)
        sheet.paste(image, k % 2 * width, k // 2 * height)
        sheet.text(k % 2 * width + 10, k // 2 * height + 22, renderer, "#222222" if renderer == "lines" else "white", 15)
    sheet.image().save(target)
    print(f"{target}: {', '.join(WAYS)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "renderers.png", "--small" in sys.argv)
