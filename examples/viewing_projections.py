"""Show what projections do to the same scene (FoCG 7): parallel, oblique, perspective, off centre, cut out, resized, deep and shallow.

    python examples/viewing_projections.py viewing_projections.png

An oblique projection is a shear of camera space before the orthographic one, so here the whole scene is sheared with the camera's own
frame around it, ``world_from_camera @ cabinet() @ camera_from_world``.
"""

from __future__ import annotations

import math
import sys

import numpy as np
from PIL import Image, ImageDraw
from transforms_drawing import CUBE_CORNERS, PALE, Panel, cube, plates, render, sheet

import limner
from limner.linear import transform
from limner.linear.affine import about, in_order
from limner.linear.projection import cabinet, camera_from_world, cavalier
from limner.scene.camera import Camera

Scene = list[limner.Node]


def town() -> Scene:
    """Three blocks on a chequered square, all upright and square to the axes."""
    places = (((-1.0, 0, 0.5), (0.7, 1.0, 0.7)), ((0.4, 0, -0.2), (0.7, 1.6, 0.7)), ((0.0, 0, -1.6), (0.7, 0.7, 0.7)))
    blocks = [
        cube(transform.transform_points(transform.translate(*at) @ transform.scale(*size), CUBE_CORNERS), 0.014) for at, size in places
    ]
    fields = [
        [[x, 0, z + 0.5], [x + 0.5, 0, z + 0.5], [x + 0.5, 0, z], [x, 0, z]] for x in np.arange(-2, 2, 0.5) for z in np.arange(-2, 2, 0.5)
    ]
    return [*blocks, plates([f for f in fields if (f[0][0] + f[2][2]) % 1.0], PALE)]


def sheared(nodes: Scene, camera: Camera, shear: np.ndarray) -> Scene:
    """The scene as if camera space leaned; what lies five metres before the eye stays."""
    leaning = about((0.0, 0.0, -5.0), shear[:3, :3])
    place = in_order(camera_from_world(camera), leaning, camera.world_from_camera)
    return [limner.Node(parent_from_node=place, children=tuple(nodes))]


def part_of(camera: limner.Camera, width: int, height: int, left: int, bottom: int, part_width: int, part_height: int) -> limner.Camera:
    """The camera that sees a rectangle of another's picture, pixel for pixel: its window on the picture plane."""
    yfov = 2.0 * math.degrees(math.atan(camera.half_height() * part_height / height))
    shift_x, shift_y = (2 * left + part_width - width) / part_width, (2 * bottom + part_height - height) / part_height
    return camera.replace(yfov_degrees=yfov, shift_x=shift_x, shift_y=shift_y)


def panels(width: int, height: int) -> list[Panel]:
    """Ten views."""
    nodes, made = town(), list[Panel]()

    def show(title: str, remark: str, camera: Camera, scene: Scene | None = None, w: int = width, h: int = height) -> None:
        page = np.full((height, width, 3), 244, np.uint8)
        top, left = (height - h) // 2, (width - w) // 2
        page[top : top + h, left : left + w] = render(scene or nodes, camera, w, h)
        made.append(Panel(title, remark, page))

    target = (0.0, 0.5, -0.4)
    corner = limner.OrthographicCamera.look_at((3, 2.5, 3), target, height=3.8)
    front = limner.OrthographicCamera.look_at((0.35, 0.9, 5), (0.35, 0.9, 0), height=4.2)
    eye = limner.Camera.look_at((2.6, 2.1, 4.0), target, yfov_degrees=40)
    show("orthographic", "parallels stay parallel (7.1.2)", corner)
    show("orthographic, from the front", "no side is seen but one", front)
    show("cavalier", "oblique: depth at 45 degrees, full length", front, sheared(nodes, front, cavalier()))
    show("cabinet", "oblique: depth at half length", front, sheared(nodes, front, cabinet()))
    show("perspective, 40 degrees", "parallels meet (7.3)", eye)
    gaze = np.array(target) - (2.6, 2.1, 4.0)
    near_eye = np.array(target) - 0.52 * gaze
    show("perspective, 70 degrees, closer", "the middle as large, but steeper", eye.look_at(near_eye, target, yfov_degrees=70))
    tower = limner.Camera.look_at((1.9, 0.5, 3.4), (0.2, 0.5, -0.4), yfov_degrees=48, shift_y=0.4)
    show("shifted window", "an off-centre frustum: verticals stay upright (7.3)", tower)
    left, bottom, w, h = width // 3, height // 2, width // 3, height // 3
    made.append(
        Panel(
            "a window of the picture",
            "the rectangle, left and bottom in pixels",
            framed(render(nodes, eye, width, height), left, bottom, w, h),
        )
    )
    show(
        "that window alone",
        "viewport.crop: l, r, b, t of the rectangle",
        part_of(eye, width, height, left, bottom, w, h),
        None,
        w * 2,
        h * 2,
    )
    show("another shape, same height", "resized: the vertical field of view stays", eye, None, height // 2, height)
    return made


def framed(pixels: np.ndarray, left: int, bottom: int, width: int, height: int) -> np.ndarray:
    """The picture with a rectangle on it, counted from the bottom."""
    page = Image.fromarray(pixels)
    top = pixels.shape[0] - bottom - height
    ImageDraw.Draw(page).rectangle((left, top, left + width, top + height), outline=(220, 20, 20), width=2)
    return np.asarray(page)


def main(target: str, small: bool = False) -> None:
    """Draw the sheet."""
    width = 96 if small else 320
    sheet(panels(width, 3 * width // 4), 5, "One scene, many projections").save(target)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "viewing_projections.png", "--small" in sys.argv)
