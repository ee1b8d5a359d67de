"""A cube map (FoCG 11.4.5): six pictures from the middle of a room, each with a right angle of view, become the surroundings of a kettle.

Left the six, laid out as a cross; right a teapot of polished metal that is not in the room at all, and mirrors it: `Environment.from_cube`.

    python examples/cube_map.py cube_map.png
"""

from __future__ import annotations

import sys

import numpy as np

import limner
from limner.draw.canvas import Canvas
from limner.linear.transform import rotate, translate

SIDES = {  # of the cube, in the order of OpenGL's files: where it looks, and what is above
    "right": ((1, 0, 0), (0, 1, 0)), "left": ((-1, 0, 0), (0, 1, 0)), "up": ((0, 1, 0), (0, 0, 1)), "down": ((0, -1, 0), (0, 0, -1)),
    "front": ((0, 0, -1), (0, 1, 0)), "back": ((0, 0, 1), (0, 1, 0)),
}  # fmt: skip
CROSS = {"up": (1, 0), "left": (0, 1), "front": (1, 1), "right": (2, 1), "back": (3, 1), "down": (1, 2)}


def room() -> limner.Scene:
    """Coloured walls, a checkered floor, balls, and lamps at the ceiling."""
    hues = {(1, 0): (0.75, 0.25, 0.2), (-1, 0): (0.2, 0.45, 0.75), (0, 1): (0.8, 0.75, 0.6), (0, -1): (0.35, 0.6, 0.35)}
    nodes: list[limner.Node] = []

    def add(at: np.ndarray, geometry: object, material: object) -> None:
        nodes.append(limner.Node(parent_from_node=at, shapes=(limner.Shape(geometry, (material,)),)))

    for (x, z), color in hues.items():
        add(translate(5.0 * x, 0.0, 5.0 * z), limner.Box((0.2 if x else 10.0, 6.0, 0.2 if z else 10.0)), limner.Lambert(color))
    tiles = limner.Lambert(texture=limner.Checker(((0.85, 0.85, 0.8), (0.2, 0.2, 0.25))))
    for y, material in ((-3.0, tiles), (3.0, limner.Lambert((0.9, 0.9, 0.9)))):
        add(translate(0, y, 0), limner.Box((10.0, 0.2, 10.0)), material)
    for k in range(6):
        at = rotate((0, 1, 0), k * np.pi / 3.0 + 0.3) @ translate(0.0, -2.1, 3.4)
        color = tuple(0.5 + 0.4 * np.cos(k + np.array([0.0, 2.0, 4.0])))
        add(at, limner.Sphere(0.8), limner.BlinnPhong(color, (0.3, 0.3, 0.3)))
    for x, z in ((-2.5, -2.0), (2.5, -2.0), (0.0, 3.0)):
        panel = limner.Lambert((0, 0, 0), emission=(14.0, 13.0, 11.0))
        add(translate(x, 2.85, z), limner.Box((1.6, 0.1, 1.6)), panel)
        nodes.append(limner.Node(parent_from_node=translate(x, 2.5, z), lights=(limner.PointLight((1.0, 0.95, 0.85), 22.0),)))
    return limner.Scene(limner.Node(children=(*nodes, limner.Node(lights=(limner.AmbientLight(intensity=0.15),)))))


def main(target: str, small: bool = False) -> None:
    """The room six times, and the teapot."""
    side, samples = (24, 2) if small else (160, 16)
    views = {
        name: limner.render(room(), camera=limner.Camera.look_at((0, 0, 0), gaze, up, yfov_degrees=90), width=side, height=side,
                            renderer="ray", samples=samples)
        for name, (gaze, up) in SIDES.items()
    }  # fmt: skip
    sky = limner.Environment.from_cube([view.pixels[..., :3] for view in views.values()])
    steel = limner.MetallicRoughness((0.92, 0.93, 0.95), 1.0, 0.05)
    pot = limner.Node("pot", rotate((0, 1, 0), 0.5), shapes=(limner.Shape(limner.primitives.teapot(12, 1.0), (steel,)),))
    camera = limner.Camera.look_at((0.0, 1.7, 4.4), (0.0, 0.62, 0.0), yfov_degrees=32)
    scene = limner.Scene(limner.Node(children=(pot,)), camera, environment=sky)
    shown = limner.render(scene, width=4 * side, height=3 * side, renderer="ray", samples=samples, glossy=True)
    sheet = Canvas(8 * side, 3 * side, "white").paste(shown, 4 * side, 0)
    for name, (column, row) in CROSS.items():
        sheet.paste(views[name], column * side, row * side).text(column * side + 6, row * side + 18, name, "black", 13)
    sheet.image().save(target)
    print(f"{target}: six pictures of {side} x {side}, and what mirrors them")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "cube_map.png", "--small" in sys.argv)
