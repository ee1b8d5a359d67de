"""Show each transformation of chapter 6 on a letter: what it was in gray, what it became in colour.

    python examples/transforms_sheet.py transforms.png

The first two rows are the plane (FoCG 6.1), seen straight from the front; the others are space (6.2, 6.3), where each panel is a
matrix of `limner.linear.transform`.
"""

from __future__ import annotations

import math
import sys

import numpy as np
from numpy.typing import ArrayLike, NDArray
from transforms_drawing import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PALE,
    RED,
    Panel,
    arrows,
    axes,
    bars,
    box_edges,
    cube,
    grid,
    plates,
    render,
    sheet,
)  # fmt: skip

import limner
from limner.linear import decompose, quaternion, transform, transform2d
from limner.linear.affine import affine, in_order

Floats = NDArray[np.float64]

# The letter F, of unit height, as a polygon and as the rectangles that fill it.
OUTLINE = np.array([(0, 0), (0.2, 0), (0.2, 0.4), (0.5, 0.4), (0.5, 0.6), (0.2, 0.6), (0.2, 0.8), (0.6, 0.8), (0.6, 1), (0, 1)])
PARTS = (((0, 0), (0.2, 1)), ((0.2, 0.4), (0.5, 0.6)), ((0.2, 0.8), (0.6, 1)))
THICK = 0.2
FRONT = limner.OrthographicCamera.look_at((0.25, 0.3, 5), (0.25, 0.3, 0), height=3.0)


def flat(points: ArrayLike, z: float = 0.0) -> Floats:
    """Points of the plane in space."""
    given = np.asarray(points, dtype=np.float64)
    return np.append(given, np.full((*given.shape[:-1], 1), z), axis=-1)


def outline(points: Floats) -> Floats:
    """A closed polygon's edges."""
    return np.stack([points, np.roll(points, -1, axis=0)], axis=1)


def letter2d(matrix: ArrayLike, color: tuple[float, float, float], z: float = 0.0) -> list[limner.Node]:
    """The letter in the plane, filled, its edges dark."""
    corners = np.array([[(a, c), (b, c), (b, d), (a, d)] for (a, c), (b, d) in PARTS], dtype=np.float64)
    moved = transform2d.transform_points(matrix, corners)
    edges = outline(transform2d.transform_points(matrix, OUTLINE))
    return [plates(flat(moved, z), color), bars(flat(edges, z + 0.02), 0.012, BLACK)]


def letter3d(matrix: Floats, color: tuple[float, float, float]) -> list[limner.Node]:
    """The letter as a block."""
    front, back = (transform.transform_points(matrix, flat(OUTLINE, z)) for z in (THICK / 2, -THICK / 2))
    walls = np.stack([back, np.roll(back, -1, axis=0), np.roll(front, -1, axis=0), front], axis=1)
    corners = np.array([[(a, c), (b, c), (b, d), (a, d)] for (a, c), (b, d) in PARTS], dtype=np.float64)
    faces = [transform.transform_points(matrix, flat(corners, z)) for z in (THICK / 2, -THICK / 2)]
    edges = np.concatenate([outline(front), outline(back), np.stack([front, back], axis=1)])
    return [plates(walls, color), *(plates(face, color) for face in faces), bars(edges, 0.012, BLACK)]


def before3d() -> limner.Node:
    """The block as it was, as a wire."""
    front, back = flat(OUTLINE, THICK / 2), flat(OUTLINE, -THICK / 2)
    return bars(np.concatenate([outline(front), outline(back), np.stack([front, back], axis=1)]), 0.007, PALE)


class Sheet:
    """Panels of one size."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height, self.panels = width, height, list[Panel]()

    def plane(self, title: str, remark: str, *matrices: ArrayLike, extra: tuple[limner.Node, ...] = ()) -> None:
        """The letter under 2x2 or 3x3 matrices, the last in the strongest colour."""
        colors = (BLUE, GREEN, ORANGE)[-len(matrices) :] if len(matrices) > 1 else (BLUE,)
        nodes = [grid((-1.75, -1.25, -0.05), (2.25, 1.75, -0.05), (16, 12), 0.003), *extra]
        nodes += [bars(flat([[(-1.75, 0), (2.25, 0)], [(0, -1.25), (0, 1.75)]], -0.03), 0.008, PALE)]
        nodes += letter2d(np.eye(2), PALE, -0.02)
        for index, (matrix, color) in enumerate(zip(matrices, colors, strict=True)):
            nodes += letter2d(matrix, color, 0.05 * (index + 1))
        self.panels.append(Panel(title, remark, render(nodes, FRONT, self.width, self.height)))

    def space(self, title: str, remark: str, nodes: list[limner.Node], azimuth: float = 28.0) -> None:
        """Whatever is to be seen, over a floor."""
        eye = limner.Camera.orbit((0.25, 0.35, 0.0), 5.2, azimuth, 24, yfov_degrees=30)
        floor = [grid((-1.5, -0.002, -1.5), (2, -0.002, 1.5), (14, 12), 0.003), axes(0.01, 1.25)]
        self.panels.append(Panel(title, remark, render([*floor, *nodes], eye, self.width, self.height)))

    def block(self, title: str, remark: str, matrix: Floats, *extra: limner.Node) -> None:
        """The block under a 4x4 matrix."""
        self.space(title, remark, [before3d(), *letter3d(matrix, BLUE), *extra])


def plane_panels(page: Sheet) -> None:
    """FoCG 6.1."""
    turn, wide = transform2d.rotate(math.radians(45)), transform2d.scale(1.6, 0.7)
    page.plane("scale(1.6, 0.7)", "along the axes (6.1.1)", wide)
    page.plane("shear-x(0.8)", "x moves with y (6.1.2)", transform2d.shear_x(0.8))
    page.plane("shear-y(0.8)", "y moves with x (6.1.2)", transform2d.shear_y(0.8))
    page.plane("rotate(45 degrees)", "counter-clockwise (6.1.3)", turn)
    page.plane("reflect-y", "across the y-axis: x is negated (6.1.4)", transform2d.reflect_y())
    line = (math.cos(0.4), math.sin(0.4))
    mirror = bars(flat([[(-1.7 * line[0], -1.7 * line[1]), (2.2 * line[0], 2.2 * line[1])]], 0.2), 0.012, RED)
    page.plane("reflect(line)", "across any line: 2 d d^T - I (6.1.4)", transform2d.reflect(line), extra=(mirror,))
    page.plane("first scale, then rotate", "in_order(S, R) = R S (6.1.5)", in_order(wide, turn))
    page.plane("first rotate, then scale", "in_order(R, S) = S R: another thing (6.1.5)", in_order(turn, wide))
    first, second, third = decompose.shears(math.radians(45))
    page.plane("a rotation as three shears", "Paeth: green, orange after blue (6.1.6)", third, second @ third, first @ second @ third)
    page.plane("rotate_about(point)", "3x3: move, turn, move back (6.3)", transform2d.rotate_about((0.6, 1.0), math.radians(-60)))


def space_panels(page: Sheet) -> None:
    """FoCG 6.2 and 6.3."""
    page.block("scale(1.3, 0.8, 3)", "along three axes (6.2)", transform.scale(1.3, 0.8, 3.0))
    page.block("shear-x(0.5, 1.5)", "x moves with y and with z (6.2)", transform.shear_x(0.5, 1.5))
    page.block("rotate-y(60 degrees)", "about an axis (6.2)", transform.rotate_y(math.radians(60)))
    axis = np.array([1.0, 1.0, 0.6])
    page.block("rotate(w, 80 degrees)", "about any axis: R_uvw^T R_z R_uvw (6.2.1)", transform.rotate(axis, math.radians(80)),
               bars([[-0.3 * axis, 1.1 * axis]], 0.015, RED))  # fmt: skip
    normal, point = np.array([1.0, 0.25, 0.3]), np.array([-0.25, 0.0, 0.0])
    u, v, _ = transform.basis(normal).T
    pane = [point + a * u + b * v for a, b in ((-0.7, -0.7), (0.7, -0.7), (0.7, 0.7), (-0.7, 0.7))]
    page.block(
        "reflect(normal, point)",
        "across any plane (6.1.4, 6.2)",
        transform.reflect(normal, point),
        bars(outline(np.array(pane)), 0.015, RED),
    )
    shear = transform.shear_x(0.9, 0.0)
    corners = np.array([[(0.0, 0, z), (0.7, 0, z), (0.7, 1, z), (0, 1, z)] for z in (-0.35, 0.35)])
    box = corners.reshape(8, 3)
    faces = [[0, 1, 5, 4], [3, 7, 6, 2], [0, 4, 7, 3], [1, 2, 6, 5], [4, 5, 6, 7], [0, 3, 2, 1]]
    solid = plates(transform.transform_points(shear, box[faces]), PALE)
    middles = transform.transform_points(shear, [(0.7, 0.5, 0.0), (0.7, 0.5, 0.0)])
    wrong = transform.transform_vectors(shear, [(0.6, 0, 0)])
    right = 0.6 * transform.transform_normals(shear, [(1, 0, 0)])
    page.space("normals under shear", "red: M n leans; green: N n, the cofactors, stands up (6.2.2)",
               [solid, bars(outline(transform.transform_points(shear, corners[1])), 0.012, BLACK),
                arrows(middles[:1], wrong, 0.015, RED), arrows(middles[1:], right, 0.015, GREEN)], azimuth=6.0)  # fmt: skip
    page.block("translate(0.8, 0.3, -0.5)", "4x4: points move, vectors do not (6.3)", transform.translate(0.8, 0.3, -0.5))
    window = transform.window((0, 0, -THICK / 2), (0.6, 1, THICK / 2), (-1.2, 0.2, -1), (1.6, 0.7, -0.4))
    target = np.array([[x, y, z] for x in (-1.2, 1.6) for y in (0.2, 0.7) for z in (-1, -0.4)])
    page.block("window(box, box)", "one box to another: orange (6.3)", window, box_edges(target, 0.01, ORANGE))
    start, end = (
        transform.compose_trs((-1.0, 0.1, 0.4), quaternion.from_axis_angle((0, 1, 0), 0.4), (0.45, 0.45, 0.45)),
        in_order(transform.scale(0.75), transform.rotate((0.3, 0.2, 1.0), 2.2), transform.translate(1.7, 0.6, -0.4)),
    )
    steps = decompose.interpolate(start, end, np.linspace(0.0, 1.0, 6))
    colors = [tuple((1 - t) * np.array(BLUE) + t * np.array(ORANGE)) for t in np.linspace(0, 1, 6)]
    page.space("interpolate(A, B, t)", "polar factors and slerp: even turning (6.1.6)",
               [node for m, color in zip(steps, colors, strict=True) for node in letter3d(m, color)])  # fmt: skip
    stretched = transform.scale(1.5, 0.6, 0.8) @ transform.rotate((1, 1, 1), 0.7)
    after, factors, before = decompose.singular(stretched[:3, :3])
    ghost = affine(after @ np.diag(factors) @ before.T, (0.3, 0.4, 0.0))
    corners3 = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    spokes = (after * factors).T
    page.space("singular(A) = U S V^T", "the axes of the stretch, at right angles (6.1.6)",
               [cube(transform.transform_points(ghost, corners3), 0.01), arrows((0.3, 0.4, 0.0), spokes, 0.015, BLACK)])  # fmt: skip


def main(target: str, small: bool = False) -> None:
    """Draw the sheet."""
    width = 96 if small else 320
    page = Sheet(width, 3 * width // 4)
    plane_panels(page)
    space_panels(page)
    sheet(page.panels, 5, "Transformations, each by its matrix").save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "transforms.png", "--small" in sys.argv)
