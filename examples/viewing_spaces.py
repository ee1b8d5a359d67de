"""Show a cube in every space that it passes on its way to the picture (FoCG 7): object, world, camera, clip, NDC, raster, pixels.

    python examples/viewing_spaces.py viewing_spaces.png

The orange frame is what the camera sees: a truncated pyramid in the world, and the canonical cube after the divide. The red ball is
one corner of the cube; what happens to its numbers stands in the last panel, as `camera.explain` tells it.
"""

from __future__ import annotations

import sys

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from transforms_drawing import (
    BLACK,
    CUBE_CORNERS,
    GRAY,
    ORANGE,
    PALE,
    RED,
    Panel,
    axes,
    ball,
    box_edges,
    cube,
    grid,
    plates,
    render,
    sheet,
)  # fmt: skip

import limner
from limner.linear import transform
from limner.linear.affine import in_order
from limner.linear.explain import point_to_pixel
from limner.linear.projection import camera_from_world, clip_from_camera, divided
from limner.linear.viewport import viewport

N_X, N_Y = 32, 24  # the little picture that all this leads to
CORNER = 7  # (1, 1, 1) of the cube
WORLD_FROM_OBJECT = in_order(transform.scale(1.3), transform.rotate((0.1, 1.0, 0.0), 0.6), transform.translate(0.4, 0.7, 0.0))
CAMERA = limner.Camera.look_at((1.8, 1.9, 4.6), (0.1, 0.8, 0.0), yfov_degrees=38, near=2.6, far=7.5)
OBJECT = CUBE_CORNERS - 0.5


def homogeneous(points: np.ndarray) -> np.ndarray:
    """(n, 4): points with their 1."""
    return np.append(points, np.ones((len(points), 1)), axis=1)


def panels(width: int, height: int) -> list[Panel]:
    """The seven spaces, and the numbers."""
    from_world, to_clip, to_raster = (
        camera_from_world(CAMERA),
        clip_from_camera(CAMERA, N_X, N_Y, CAMERA.near, CAMERA.far),
        viewport(N_X, N_Y),
    )
    canonical = 2.0 * CUBE_CORNERS - 1.0
    frustum_camera = divided(homogeneous(canonical) @ np.linalg.inv(to_clip).T)
    frustum_world = transform.transform_points(CAMERA.world_from_camera, frustum_camera)
    world = transform.transform_points(WORLD_FROM_OBJECT, OBJECT)
    in_camera = transform.transform_points(from_world, world)
    clip, frustum_clip = homogeneous(in_camera) @ to_clip.T, homogeneous(frustum_camera) @ to_clip.T
    ndc = divided(clip)
    raster, frustum_raster = transform.transform_points(to_raster, ndc), transform.transform_points(to_raster, canonical)

    def picture(nodes: list[limner.Node], target: tuple[float, float, float], distance: float, azimuth: float = 30, elevation: float = 22):
        eye = limner.Camera.orbit(target, distance, azimuth, elevation, yfov_degrees=30)
        return render(nodes, eye, width, height)

    def xyw(points: np.ndarray) -> np.ndarray:
        """Of four numbers a picture shows three: x, y and w, w into the picture as the depth that it is."""
        return points[:, [0, 1, 3]] * (1.0, 1.0, -1.0)

    def in_pixels(points: np.ndarray) -> np.ndarray:
        """Pixels are many and normalised depth is little: z is drawn eight times as large."""
        return points * (1.0, 1.0, 8.0)

    eye = ball((0, 0, 0), 0.09, BLACK)
    return [
        Panel(
            "object space", "the unit cube around its own origin",
            picture([cube(OBJECT, 0.014), ball(OBJECT[CORNER], 0.05, RED), axes(0.015, 1.1)], (0.1, 0.1, 0.1), 4.4),
        ),
        Panel(
            "world space", "M: scaled, turned, moved (6.3)",
            picture(
                [cube(world, 0.025), ball(world[CORNER], 0.09, RED), axes(0.03, 1.5), grid((-4, 0, -4), (4, 0, 6), (8, 10), 0.008),
                 box_edges(frustum_world, 0.025, ORANGE), ball(CAMERA.world_from_camera[:3, 3], 0.12, BLACK),
                 axes(0.02, 0.7, CAMERA.world_from_camera)],
                (0.4, 0.8, 0.8), 17, 60, 25,
            ),
        ),
        Panel(
            "camera space", "M_cam: the eye is the origin, the gaze -z (7.1.3)",
            picture(
                [cube(in_camera, 0.025), ball(in_camera[CORNER], 0.09, RED), box_edges(frustum_camera, 0.025, ORANGE),
                 axes(0.03, 1.5), eye],
                (0, 0, -3.5), 17, 60, 25,
            ),
        ),
        Panel(
            "clip space (x, y, w)", "-M_per: visible is -w <= x, y <= w (7.3)",
            picture(
                [cube(xyw(clip), 0.035), ball(xyw(clip)[CORNER], 0.13, RED), box_edges(xyw(frustum_clip), 0.035, ORANGE),
                 axes(0.04, 2.0), eye],
                (0, 0, -3.5), 34, 55, 22,
            ),
        ),
        Panel(
            "normalised device coordinates", "/ w: near is +1 and towards us, far is -1 (7.2)",
            picture(
                [cube(ndc, 0.012), ball(ndc[CORNER], 0.05, RED), box_edges(canonical, 0.014, ORANGE), axes(0.014, 0.8)],
                (0, 0, 0), 6.3, 28, 20,
            ),
        ),
        Panel(
            "raster space", f"M_vp: {N_X} x {N_Y} pixels, centres at integers (7.1.1)",
            picture(
                [cube(in_pixels(raster), 0.13), ball(in_pixels(raster)[CORNER], 0.6, RED),
                 box_edges(in_pixels(frustum_raster), 0.14, ORANGE),
                 grid((-0.5, -0.5, -8), (N_X - 0.5, N_Y - 0.5, -8), (N_X, N_Y), 0.03, GRAY)],
                ((N_X - 1) / 2, (N_Y - 1) / 2, 0), 72, 22, 14,
            ),
        ),
        Panel("the picture", "rendered by the same matrices, pixel by pixel", pixels(width, height)),
        Panel("the corner's numbers", "point_to_pixel(camera, corner, width, height)", numbers(width, height)),
    ]  # fmt: skip


def pixels(width: int, height: int) -> np.ndarray:
    """The little picture, enlarged, with the corner where `point_to_pixel` says."""
    world = transform.transform_points(WORLD_FROM_OBJECT, OBJECT)
    floor = plates(
        [[[x, 0, z + 1], [x + 1, 0, z + 1], [x + 1, 0, z], [x, 0, z]] for x in range(-4, 4) for z in range(-4, 4) if (x + z) % 2], PALE
    )
    small = render([cube(world, 0.02), floor], CAMERA, N_X, N_Y, samples=16)
    times = min(width // N_X, height // N_Y)
    large = Image.fromarray(np.full((height, width, 3), 244, np.uint8))
    left, top = (width - times * N_X) // 2, (height - times * N_Y) // 2
    large.paste(Image.fromarray(small).resize((times * N_X, times * N_Y), Image.Resampling.NEAREST), (left, top))
    x, y = point_to_pixel(CAMERA, world[CORNER], N_X, N_Y).at("pixel")
    at_x, at_y, r = left + (x + 0.5) * times, top + (y + 0.5) * times, 0.7 * times
    ImageDraw.Draw(large).ellipse((at_x - r, at_y - r, at_x + r, at_y + r), outline=(210, 20, 20), width=max(times // 4, 1))
    return np.asarray(large)


def numbers(width: int, height: int) -> np.ndarray:
    """The way of the corner as text."""
    page = Image.fromarray(np.full((height, width, 3), 252, np.uint8))
    pen, size = ImageDraw.Draw(page), max(width // 27, 8)
    font, line = ImageFont.load_default(size), height / 9.5
    for index, step in enumerate(point_to_pixel(CAMERA, OBJECT[CORNER], N_X, N_Y, world_from_object=WORLD_FROM_OBJECT)):
        y = (index + 0.8) * line
        pen.text((0.04 * width, y), step.space, fill=(20, 20, 24), font=font)
        pen.text((0.21 * width, y), step.matrix_name, fill=(190, 90, 0), font=font)
        pen.text((0.45 * width, y), ", ".join(f"{value:.2f}" for value in step.coordinates), fill=(60, 60, 66), font=font)
    return np.asarray(page)


def main(target: str, small: bool = False) -> None:
    """Draw the sheet."""
    width = 96 if small else 400
    sheet(panels(width, 3 * width // 4), 4, "From the object to the picture").save(target)
    print(point_to_pixel(CAMERA, OBJECT[CORNER], N_X, N_Y, world_from_object=WORLD_FROM_OBJECT))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "viewing_spaces.png", "--small" in sys.argv)
