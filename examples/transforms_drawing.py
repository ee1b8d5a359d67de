"""What the sheets of transformations and views are drawn with: bars for lines, plates for faces, panels with titles.

Everything in a panel is a mesh that limner renders; Pillow writes the words. A bar is a unit prism that a product of matrices puts on
its edge, which is chapter 6 at work.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFont

import limner
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.scene.camera import Camera

__all__ = [
    "BLACK", "BLUE", "CUBE_CORNERS", "CUBE_EDGES", "GRAY", "GREEN", "ORANGE", "PALE", "RED", "Panel", "arrows", "axes", "ball", "bars",
    "box_edges", "cube", "grid", "plates", "render", "sheet",
]  # fmt: skip

Floats = NDArray[np.float64]
Color = tuple[float, float, float]

BLACK, GRAY, PALE = (0.015, 0.015, 0.02), (0.25, 0.26, 0.28), (0.55, 0.57, 0.6)
RED, GREEN, BLUE, ORANGE = (0.75, 0.06, 0.05), (0.08, 0.42, 0.08), (0.06, 0.16, 0.7), (0.9, 0.36, 0.02)
_PAPER = (1.0, 1.0, 1.0)

# Corners in the order of their bits (x, y, z), and the pairs that differ in one of them.
CUBE_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)
CUBE_EDGES = np.array([(a, a | bit) for bit in (4, 2, 1) for a in range(8) if not a & bit])
_CUBE_FACES = (
    ((4, 6, 7, 5), RED),
    ((0, 1, 3, 2), ORANGE),
    ((2, 3, 7, 6), GREEN),
    ((0, 4, 5, 1), PALE),
    ((1, 5, 7, 3), BLUE),
    ((0, 2, 6, 4), GRAY),
)


class Panel(NamedTuple):
    """A title, a line below it, and (height, width, 3) uint8 pixels."""

    title: str
    remark: str
    pixels: NDArray[np.uint8]


def _node(positions: Floats, triangles: NDArray[np.int64], color: Color, glow: float = 0.0) -> limner.Node:
    mesh = Mesh(positions=positions.astype(np.float32), triangles=triangles.astype(np.int32))
    material = limner.Lambert(color, emission=tuple(glow * value for value in color))
    return limner.Node(shapes=(limner.Shape(mesh, (material,)),))


def bars(edges: ArrayLike, radius: float, color: Color, sides: int = 8) -> limner.Node:
    """Draw lines, (n, 2, 3), as thin prisms."""
    start, end = np.moveaxis(np.asarray(edges, dtype=np.float64).reshape(-1, 2, 3), 1, 0)
    along = end - start
    length = np.linalg.norm(along, axis=-1)
    start, along, length = start[length > 0.0], along[length > 0.0], length[length > 0.0]
    place = transform.affine(transform.basis(along), start) @ transform.scale(radius, radius, length)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=-1)
    above = np.array([0.0, 0.0, 1.0])
    prism = np.concatenate([ring, ring + above, [0.0 * above, above]])
    i, j = np.arange(sides), (np.arange(sides) + 1) % sides
    bottom, top = np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
    quarters = [(i, j, j + sides), (i, j + sides, i + sides), (j, i, bottom), (i + sides, j + sides, top)]
    triangles = np.concatenate([np.stack(corners, axis=-1) for corners in quarters])
    positions = transform.transform_points(place[:, None], prism)
    every = triangles + len(prism) * np.arange(len(positions))[:, None, None]
    return _node(positions.reshape(-1, 3), every.reshape(-1, 3), color, 0.15)


def arrows(origin: ArrayLike, vectors: ArrayLike, radius: float, color: Color) -> limner.Node:
    """Draw vectors, (n, 3), from their origins as bars with a thicker end."""
    start, along = np.broadcast_arrays(np.asarray(origin, dtype=np.float64), np.asarray(vectors, dtype=np.float64))
    start, end = start.reshape(-1, 3), (start + along).reshape(-1, 3)
    shaft = bars(np.stack([start, end], axis=1), radius, color)
    head = bars(np.stack([start + 0.86 * (end - start), end], axis=1), 2.6 * radius, color)
    return limner.Node(children=(shaft, head))


def axes(radius: float, length: float = 1.0, world_from_axes: ArrayLike | None = None) -> limner.Node:
    """x red, y green, z blue."""
    place = np.eye(4) if world_from_axes is None else np.asarray(world_from_axes)
    colors = (RED, GREEN, BLUE)
    return limner.Node(children=tuple(arrows(place[:3, 3], length * place[:3, i], radius, colors[i]) for i in range(3)))


def ball(center: ArrayLike, radius: float, color: Color) -> limner.Node:
    """Mark a point."""
    place = transform.translate(*np.asarray(center, dtype=np.float64))
    material = limner.Lambert(color, emission=tuple(0.3 * value for value in color))
    return limner.Node(parent_from_node=place, shapes=(limner.Shape(limner.Sphere(radius), (material,)),))


def plates(corners: ArrayLike, color: Color) -> limner.Node:
    """Draw flat quadrilaterals, (n, 4, 3), counter-clockwise."""
    positions = np.asarray(corners, dtype=np.float64).reshape(-1, 4, 3)
    triangles = np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(len(positions))[:, None, None]
    return _node(positions.reshape(-1, 3), triangles.reshape(-1, 3), color, 0.12)


def cube(corners: ArrayLike, radius: float) -> limner.Node:
    """Draw what became of the unit cube's corners, (8, 3): a face of each colour, dark edges. Flat faces stay flat in all of it."""
    at = np.asarray(corners, dtype=np.float64)
    faces = tuple(plates(at[list(face)], color) for face, color in _CUBE_FACES)
    return limner.Node(children=(*faces, bars(at[CUBE_EDGES], radius, BLACK)))


def box_edges(corners: ArrayLike, radius: float, color: Color) -> limner.Node:
    """Draw the edges of a box, or of what became of it; its corners as those of the cube."""
    return bars(np.asarray(corners, dtype=np.float64)[CUBE_EDGES], radius, color)


def grid(low: Sequence[float], high: Sequence[float], steps: tuple[int, int], radius: float, color: Color = PALE) -> limner.Node:
    """Draw lines over a rectangle that is flat along one axis: `steps` fields along the other two."""
    a, b = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    first, second = np.flatnonzero(a != b)
    lines = []
    for axis, other, count in ((first, second, steps[0]), (second, first, steps[1])):
        for value in np.linspace(a[axis], b[axis], count + 1):
            line = np.array([a, a])
            line[:, axis], line[1, other] = value, b[other]
            lines.append(line)
    return bars(np.array(lines), radius, color, sides=4)


def _lights(camera: Camera) -> limner.Node:
    """A key light over the shoulder, and as much from everywhere that no side is black."""
    turned = camera.world_from_camera @ transform.rotate_y(0.5) @ transform.rotate_x(-0.6)
    turned = transform.affine(turned[:3, :3])
    key = limner.Node(parent_from_node=turned, lights=(limner.DirectionalLight(intensity=1.9),))
    return limner.Node(children=(key, limner.Node(lights=(limner.AmbientLight(intensity=0.42),))))


def render(nodes: Sequence[limner.Node], camera: Camera, width: int, height: int, samples: int = 8) -> NDArray[np.uint8]:
    """(height, width, 3) uint8."""
    scene = limner.Scene(limner.Node(children=(*nodes, _lights(camera))), background=_PAPER)
    return limner.render(scene, width=width, height=height, samples=samples, camera=camera).to_uint8()[..., :3]


def sheet(panels: Sequence[Panel], columns: int, title: str) -> Image.Image:
    """Put panels side by side, each under its title, the whole under its own."""
    width, height = max(p.pixels.shape[1] for p in panels), max(p.pixels.shape[0] for p in panels)
    size = max(width // 22, 9)
    large, small, huge = (ImageFont.load_default(s) for s in (size, 0.8 * size, 1.4 * size))
    gap, head = size, round(3.2 * size)
    rows = -(-len(panels) // columns)
    page = Image.new("RGB", (columns * (width + gap) + gap, rows * (height + head + gap) + gap + 2 * size), "white")
    pen = ImageDraw.Draw(page)
    pen.text((gap, gap), title, fill=(20, 20, 24), font=huge)
    for index, panel in enumerate(panels):
        x, y = gap + index % columns * (width + gap), gap + 2 * size + index // columns * (height + head + gap)
        pen.text((x, y + 0.6 * size), panel.title, fill=(20, 20, 24), font=large)
        pen.text((x, y + 2.0 * size), panel.remark, fill=(110, 110, 116), font=small)
        page.paste(Image.fromarray(panel.pixels), (x, y + head))
        pen.rectangle((x - 1, y + head - 1, x + panel.pixels.shape[1], y + head + panel.pixels.shape[0]), outline=(205, 205, 210))
    return page
