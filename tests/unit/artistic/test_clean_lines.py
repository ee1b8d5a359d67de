"""Clean lines: silhouettes that close, overlaps drawn once, strokes with few points, curves of combined solids in one piece."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.artistic.edges import Wanted, edge_kinds, faces_of
from limner.artistic.lines import Drawing, drawing_of
from limner.artistic.outlines import outlines
from limner.artistic.sight_lines import sight_lines
from limner.artistic.simplify import points_that_show
from limner.artistic.surfaces import surfaces_of
from limner.linear.transform import translate
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.primitive import Box, Cylinder
from limner.scene.scene import Scene
from limner.scene.shape import Geometry, Shape
from limner.scene.solid import Difference, Solid, Union
from tests.staging import SLOW_AS_PYTHON

WIDTH, HEIGHT = 200, 160
FRONT = OrthographicCamera.look_at((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), height=4.0)
ABOVE = OrthographicCamera.look_at((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), height=4.0)


def scene_of(*shown: tuple[Geometry, NDArray[np.float64]]) -> Scene:
    nodes = tuple(Node(parent_from_node=matrix, shapes=(Shape(geometry, (Lambert(),)),)) for geometry, matrix in shown)
    return Scene(root=Node(children=nodes))


def drawn(geometry: Geometry, camera: Camera, **options: object) -> Drawing:
    return drawing_of(scene_of((geometry, np.eye(4))), camera, width=WIDTH, height=HEIGHT, **options)  # type: ignore[arg-type]


def rough_ball(noise: float, seed: int = 0, bands: int = 12) -> Mesh:
    ball = primitives.sphere(1.0, bands)
    points, index = np.unique(ball.positions, axis=0, return_inverse=True)
    moved = points * (1.0 + np.random.default_rng(seed).normal(0.0, noise, (len(points), 1)))
    return Mesh(moved.astype(np.float32), index.reshape(-1)[ball.triangles].astype(np.int32))


@pytest.mark.parametrize("noise", [0.0, 0.02, 0.2])
@pytest.mark.parametrize("width", [20, 200, 4000])
def test_silhouettes_of_what_is_closed_are_closed(noise: float, width: int) -> None:
    """An even number of pieces meets at every point, to the bit, whichever triangles are smooth and whichever are not: bug, where two
    normals changed sides at different places of one edge, the piece between was missing."""
    camera = PerspectiveCamera.look_at((3.0, 2.0, 4.0), (0.0, 0.0, 0.0), yfov_degrees=40)
    surfaces = surfaces_of(scene_of((rough_ball(noise), np.eye(4))), camera, width, width)
    sight, faces = sight_lines(camera, width, width, surfaces.points), faces_of(surfaces)
    kinds = edge_kinds(surfaces, faces, Wanted(-1, 2, -1, -1), 30.0)
    found = outlines(surfaces, faces, sight, kinds, 0).segments
    _, count = np.unique(found.ends.reshape(-1, 3), axis=0, return_counts=True)
    assert len(count) > 8
    assert (count % 2 == 0).all()


def test_a_fine_ball_is_one_smooth_ring() -> None:
    """By default, too: a closed stroke that is a circle to a sixth of a pixel."""
    camera = PerspectiveCamera.look_at((0, 0, 4.0), (0, 0, 0), yfov_degrees=60)
    (line,) = drawn(rough_ball(0.0, bands=32), camera).lines
    radius = camera.intrinsics(WIDTH, HEIGHT)[0, 0] / math.sqrt(15.0)
    assert line.closed
    assert line.kind == "silhouette"
    assert np.abs(np.hypot(*(line.picture - (WIDTH / 2, HEIGHT / 2)).T) - radius).max() < 0.17


@SLOW_AS_PYTHON
def test_neighbouring_views_have_nearly_the_same_lines() -> None:
    """Ten views of a dented ball, a degree apart: what is seen of its silhouette grows or shrinks by little from one to the next."""
    ball, lengths = rough_ball(0.004, seed=3, bands=24), []
    for angle in np.radians(np.arange(10.0)):
        camera = OrthographicCamera.look_at((5 * math.sin(angle), 2.0, 5 * math.cos(angle)), (0, 0, 0), height=2.4)
        lengths.append(sum(line.length for line in drawn(ball, camera).of("silhouette", hidden=False)))
    assert np.abs(np.diff(lengths)).max() < 0.03 * np.mean(lengths)


def test_lines_that_overlap_in_part_are_drawn_once() -> None:
    """Behind a sheet of the width 2 stands one that reaches farther to the right: of its upper edge, in line with the other's, only what
    stands out is drawn."""

    def sheet(x0: float, x1: float) -> Mesh:
        return primitives.quad([[x0, -0.5, 0], [x1, -0.5, 0], [x1, 0.5, 0], [x0, 0.5, 0]])

    scene = scene_of((sheet(-1.0, 1.0), np.eye(4)), (sheet(0.0, 1.5), translate(0.0, 0.0, -1.0)))
    drawing = drawing_of(scene, FRONT, width=WIDTH, height=HEIGHT)
    # Around the first; of the second its hidden left side, its right side, and half a metre above and below.
    assert sum(line.length for line in drawing.lines) == pytest.approx(40.0 * (6.0 + 1.0 + 1.0 + 2 * 0.5), rel=1e-6)
    along = [p for line in drawing.lines for p in itertools.pairwise(line.picture) if p[0][1] == p[1][1] == 60.0]
    spans = sorted((min(p[0], q[0]), max(p[0], q[0]), line) for line, (p, q) in enumerate(along))
    assert spans[0][0] == pytest.approx(60.0)
    assert spans[-1][1] == pytest.approx(160.0)
    assert sum(high - low for low, high, _ in spans) == pytest.approx(100.0)


@pytest.mark.parametrize("tolerance", [0.01, 0.1, 1.0])
def test_points_that_are_left_out_lie_on_the_line(tolerance: float) -> None:
    """Every point is within the tolerance of the stroke that is left; ends stay; lines do not mix."""
    t = np.linspace(0.0, 6.0, 200)
    lines = [np.stack([10 * t, 8 * np.sin(t)], 1), np.stack([t, t], 1), np.stack([np.cos(t), np.sin(t)], 1), np.zeros((1, 2))]
    count = np.array([len(line) for line in lines])
    kept = np.split(points_that_show(np.concatenate(lines), count, tolerance), np.cumsum(count)[:-1])
    assert kept[1].sum() == 2
    for line, rows in zip(lines, kept, strict=True):
        assert rows[0]
        assert rows[-1]
        left = line[rows]
        for p in line[~rows]:
            a, way = left[:-1], np.diff(left, axis=0)
            u = np.clip(((p - a) * way).sum(axis=1) / (way * way).sum(axis=1), 0.0, 1.0)
            assert np.hypot(*(a + u[:, None] * way - p).T).min() <= tolerance + 1e-12


@SLOW_AS_PYTHON
def test_the_rim_of_a_drilled_hole_is_one_ring() -> None:
    """From above a drilled plate is a rectangle and a ring, and nothing else."""
    plate = Difference(Solid(Box((2.0, 0.5, 2.0))), Solid(Cylinder(0.5, 3.0)))
    ring, outline = sorted(drawn(plate, ABOVE).of(hidden=False), key=lambda line: line.length)
    assert ring.closed
    assert outline.closed
    assert ring.length == pytest.approx(40.0 * math.pi, rel=0.01)
    assert outline.length == pytest.approx(40.0 * 8.0, rel=1e-3)


@SLOW_AS_PYTHON
def test_flush_blocks_have_no_line_between_them() -> None:
    """A block that stands on another, level with it in front: seen from the front their outline, and no line across."""
    wide, tall = Solid(Box((2.0, 0.5, 1.0)), translate(0.0, -0.25, 0.0)), Solid(Box((0.5, 1.0, 1.0)), translate(0.3, 0.5, 0.0))
    lines = drawn(Union(wide, tall), FRONT).of(hidden=False)
    assert {line.kind for line in lines} == {"silhouette"}
    assert sum(line.length for line in lines) == pytest.approx(40.0 * (2 * 2.0 + 2 * 1.5), rel=0.01)
