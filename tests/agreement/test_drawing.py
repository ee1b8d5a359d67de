"""A drawing and the rasteriser's picture: the outlines are where ids change, and what is seen of lines is what is not behind the depths."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.artistic.lines import Drawing, drawing_of
from limner.files.load import load
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.render import render
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.primitive import Box, Sphere, Torus
from limner.scene.scene import Scene
from limner.scene.shape import Geometry, Shape
from tests.staging import SLOW_AS_PYTHON

MESHES = Path(__file__).resolve().parents[2] / ".." / "shared" / "data" / "meshes"
WIDTH, HEIGHT = 240, 180

pytestmark = SLOW_AS_PYTHON


def shown(geometry: Geometry, *place: NDArray[np.float64]) -> Node:
    matrix = np.eye(4)
    for part in place:
        matrix = matrix @ part
    return Node(parent_from_node=matrix, shapes=(Shape(geometry, (Lambert(),)),))


def workshop() -> Scene:
    """Boxes upon and in each other, a ball half in a box, a torus round another, and the teapot."""
    return Scene(
        root=Node(
            children=(
                shown(Box((4.0, 0.2, 4.0)), transform.translate(0.0, -0.6, 0.0)),
                shown(Box((1.0, 1.0, 1.0)), transform.rotate_y(0.5)),
                shown(Sphere(0.5), transform.translate(0.4, 0.5, 0.3)),
                shown(Torus(0.7, 0.1), transform.translate(0.0, 0.1, 0.0)),
                shown(primitives.teapot(), transform.translate(-1.1, -0.5, 0.9), transform.scale(0.25, 0.25, 0.25)),
            )
        )
    )


CAMERAS = (
    PerspectiveCamera.look_at((2.5, 2.0, 3.5), (0, 0, 0), yfov_degrees=45),
    OrthographicCamera.look_at((-2.0, 1.5, 3.0), (0, 0, 0), height=4.0),
)


def compare(scene: Scene, camera: Camera, drawing: Drawing) -> None:
    """Every pixel beside which the picture shows another shape has a line within a pixel, and no line is seen behind what hides it, but for
    parts of smooth silhouettes of a few pixels, which go with their neighbours, and say so."""
    picture = render(scene.replace(camera=camera), width=WIDTH, height=HEIGHT, samples=1, aovs=("depth", "instance_id"))
    ids, depth = picture.aov["instance_id"], picture.aov["depth"]
    points, depths, seen, own = samples(drawing)
    near_line = np.zeros((HEIGHT + 4, WIDTH + 4), dtype=bool)
    column, row = np.floor(points[seen]).astype(int).T + 2
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            near_line[np.clip(row + j, 0, HEIGHT + 3), np.clip(column + i, 0, WIDTH + 3)] = True
    near_line = near_line[2:-2, 2:-2]
    across, down = np.zeros(ids.shape, dtype=bool), np.zeros(ids.shape, dtype=bool)
    across[:, :-1], down[:-1] = ids[:, :-1] != ids[:, 1:], ids[:-1] != ids[1:]
    assert (across | down).sum() > 100
    assert not ((across | down) & ~near_line).any()
    # The farthest and the nearest depth of the pixels around a point; the picture's spheres and tori are exact, the drawing's are not.
    column, row = np.clip(np.floor(points).astype(int).T, 1, [[WIDTH - 2], [HEIGHT - 2]])
    around = np.stack([depth[row + j, column + i] for i in (-1, 0, 1) for j in (-1, 0, 1)])
    inside = ((points > 1.0) & (points < (WIDTH - 1.0, HEIGHT - 1.0))).all(axis=1)
    before, behind = depths <= around.max(axis=0) * 1.01, depths >= around.min(axis=0) * 0.99
    assert before[seen & inside].mean() > 0.995
    assert behind[~seen & inside].mean() > 0.995
    # Of what is not drawn like its neighbours it holds of all, within what the triangles that stand for smooth surfaces are off.
    assert (depths <= around.max(axis=0) * 1.025)[seen & inside & own].all()
    assert (depths >= around.min(axis=0) * 0.975)[~seen & inside & own].all()
    assert own.mean() > 0.98


def samples(drawing: Drawing) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]]:
    """Points along all lines, two a pixel, their depths, whether they are seen, and whether that is so by themselves, and not because they
    are drawn like what is beside them."""
    points, depths, seen, own = [], [], [], []
    for line in drawing.lines:
        along = np.append(0.0, np.cumsum(np.hypot(*np.diff(line.picture, axis=0).T)))
        at = np.linspace(0.0, along[-1], max(2, int(along[-1] * 2.0)))[1:-1]
        points.append(np.stack([np.interp(at, along, column) for column in line.picture.T], axis=1))
        # Even steps on the picture are even steps of the reciprocal depth in perspective (FoCG 11.3.1), of the depth itself without.
        straight = 1.0 / line.depth if isinstance(drawing.camera, PerspectiveCamera) else line.depth
        between = np.interp(at, along, straight)
        depths.append(1.0 / between if isinstance(drawing.camera, PerspectiveCamera) else between)
        seen.append(np.full(len(at), line.hidden_by == 0))
        bridged = np.zeros(len(line.depth) - 1, dtype=bool) if line.bridged is None else line.bridged
        own.append(~bridged[np.clip(np.searchsorted(along, at) - 1, 0, len(bridged) - 1)])
    return np.concatenate(points), np.concatenate(depths), np.concatenate(seen), np.concatenate(own)


@pytest.mark.parametrize("camera", CAMERAS, ids=["perspective", "parallel"])
def test_outlines_are_where_ids_change_and_depths_tell_what_is_seen(camera: Camera) -> None:
    """Of shapes upon, in and around each other."""
    scene = workshop()
    compare(scene, camera, drawing_of(scene, camera, width=WIDTH, height=HEIGHT))


@pytest.mark.parametrize("name", ["fandisk", "rocker-arm", "stanford-bunny"])
def test_meshes_as_they_come(name: str) -> None:
    """Designed, scanned, with holes: the same holds."""
    path = MESHES / f"{name}.obj"
    if not path.is_file():
        pytest.skip(f"the optional mesh {path.name} is not there")
    scene = load(path)
    drawing = drawing_of(scene, width=WIDTH, height=HEIGHT)
    compare(scene, drawing.camera, drawing)
