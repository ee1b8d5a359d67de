"""The grain of surfaces: what is scanned is drawn as the form that it is of, and what is designed as it is."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, place, scene_of

from limner.artistic.crowded import beside_others
from limner.artistic.edges import Wanted, edge_kinds, faces_of
from limner.artistic.grain import without_grain
from limner.artistic.lines import Drawing, drawing_of
from limner.artistic.surfaces import corner_normals, surfaces_of
from limner.files.load import load
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.scene.camera import Camera, OrthographicCamera
from limner.scene.scene import Scene

MESHES = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "meshes"
WIDTH, HEIGHT = 200, 160
FRONT = OrthographicCamera.look_at((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), height=3.0)


def rough(mesh: Mesh, noise: float, seed: int = 0) -> Mesh:
    """The mesh with its points moved at random by so much of a metre, and without its normals."""
    points, index = np.unique(mesh.positions, axis=0, return_inverse=True)
    moved = points + np.random.default_rng(seed).normal(0.0, noise, points.shape)
    return Mesh(moved.astype(np.float32), index.reshape(-1)[mesh.triangles].astype(np.int32))


def bent_sheet(n: int, angle: float, noise: float = 0.0) -> Mesh:
    """A square sheet of n by n squares that is bent along its middle."""
    x, y = np.meshgrid(np.linspace(-1.0, 1.0, n + 1), np.linspace(-1.0, 1.0, n + 1))
    half = math.radians(angle) / 2.0
    points = np.stack([x * math.cos(half), y, -np.abs(x) * math.sin(half)], axis=-1).reshape(-1, 3)
    points += np.random.default_rng(1).normal(0.0, 1.0, points.shape) * noise
    i = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).reshape(-1)
    corners = np.concatenate([np.stack([i, i + 1, i + n + 2], axis=1), np.stack([i, i + n + 2, i + n + 1], axis=1)])
    return Mesh(points.astype(np.float32), corners.astype(np.int32))


def drawn(mesh: Mesh, camera: Camera = FRONT, **options: object) -> Drawing:
    return drawing_of(scene_of(place(mesh)), camera, width=WIDTH, height=HEIGHT, **options)  # type: ignore[arg-type]


def grain_of(mesh: Mesh) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Normals at corners as they come, without grain, and how much of it there is."""
    surfaces = surfaces_of(scene_of(place(mesh)), FRONT, WIDTH, HEIGHT)
    faces = faces_of(surfaces)
    sharp = edge_kinds(surfaces, faces, Wanted(0, 1, -1, -1), 30.0).sharp
    normals = corner_normals(surfaces, faces.adjacency, sharp)
    return normals.copy(), *without_grain(surfaces, faces.adjacency, sharp, normals)


def test_what_is_smooth_has_no_grain() -> None:
    """Of a ball, a tube and a bent sheet not a bit of a normal changes."""
    for mesh in (primitives.sphere(1.0, 24), primitives.cylinder(0.5, 1.0, 40), bent_sheet(8, 50.0)):
        before, after, noise = grain_of(mesh)
        assert (before == after).all()
        assert not noise.any()


def test_grain_is_found_and_taken_away() -> None:
    """Normals of a rough ball come by a quarter nearer to those of the ball, and the grain that is told is of the size it has."""
    mesh = rough(primitives.sphere(1.0, 24), 0.008)
    before, after, noise = grain_of(mesh)
    true = mesh.positions[mesh.triangles].astype(np.float64)
    true /= np.linalg.norm(true, axis=2, keepdims=True)
    off, left = (np.linalg.norm(normals - true, axis=2).mean() for normals in (before, after))
    assert left < 0.75 * off
    assert 0.5 * off < noise.mean() < 1.5 * off


@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_a_fold_stays_a_crease(noise: float) -> None:
    """Smooth or rough, a bent sheet has one crease, in its middle, all along, and no other."""
    lines = drawn(bent_sheet(16, 60.0, noise), kinds=("crease",)).lines
    assert sum(line.length for line in lines) == pytest.approx(2.0 * HEIGHT / 3.0, rel=0.02)
    assert all(np.abs(line.picture[:, 0] - WIDTH / 2).max() < 1.5 for line in lines)


def test_creases_by_accident_are_none() -> None:
    """A flat sheet that is rougher than the angle of a crease in many places has none; at 0 degrees every edge is one."""
    mesh = bent_sheet(16, 0.0, 0.012)
    surfaces = surfaces_of(scene_of(place(mesh)), FRONT, WIDTH, HEIGHT)
    faces = faces_of(surfaces)
    first = faces.adjacency.edge_start[:-1][faces.adjacency.edge_counts == 2]
    s, t = (faces.normals[faces.adjacency.edge_halfedges[first + k] // 3] for k in (0, 1))
    assert ((s * t).sum(axis=1) < math.cos(math.radians(30.0))).sum() > 12
    assert not drawn(mesh, kinds=("crease",)).lines
    every = drawn(bent_sheet(3, 0.0, 0.02), kinds=("crease",), crease_degrees=0.0).of(hidden=False)
    assert sum(line.length for line in every) > 0.98 * HEIGHT / 3.0 * (2 * 2 * 2.0 + 9 * math.hypot(2 / 3, 2 / 3))


def test_facets_of_a_design_are_creases() -> None:
    """A prism of eight sides has all its 24 edges, which meet at 45 degrees and at right angles."""
    turned = OrthographicCamera.look_at((3.0, 2.0, 5.0), (0.0, 0.0, 0.0), height=3.0)
    lines = drawn(primitives.cylinder(0.5, 1.0, 8), turned, kinds=("crease",)).lines
    ends = [pair for line in lines for pair in itertools.pairwise(line.world.round(3).tolist())]
    edges = {tuple(sorted((tuple(a), tuple(b)))) for a, b in ends}
    assert len(edges) == 24


@SLOW_AS_PYTHON
def test_the_outline_of_what_is_rough_is_one_line() -> None:
    """Of a rough ball there is its outline, a circle without gaps, and nothing that is far from it."""
    ball = rough(primitives.sphere(1.0, 32), 0.004)
    radius = HEIGHT / 3.0
    for angle in (0.0, 0.7, 1.9):
        camera = OrthographicCamera.look_at((5.0 * math.sin(angle), 1.0, 5.0 * math.cos(angle)), (0.0, 0.0, 0.0), height=3.0)
        lines = drawn(ball, camera).of(hidden=False)
        steps = np.linspace(0.0, 1.0, 9)[:, None]
        pieces = [p + steps * (q - p) for line in lines for p, q in itertools.pairwise(line.picture)]
        points = np.concatenate(pieces) - (WIDTH / 2, HEIGHT / 2)
        assert np.abs(np.hypot(points[:, 0], points[:, 1]) - radius).max() < 4.5
        assert sum(line.length for line in lines) < 1.9 * 2.0 * math.pi * radius
        around = np.sort(np.arctan2(points[:, 1], points[:, 0]))
        assert np.diff(np.append(around, around[0] + 2.0 * math.pi)).max() * radius < 2.0


def test_dashes_beside_a_line_are_left_out() -> None:
    """Of two lines two pixels apart the hidden one is, for as long as they run together; of another shape, farther off, or across: not."""
    steps = np.linspace(0.0, 40.0, 9)

    def parts(x: float, along: bool = True) -> NDArray[np.float64]:
        ends = np.stack([np.stack([np.full(8, x), steps[:-1]], 1), np.stack([np.full(8, x), steps[1:]], 1)], axis=1)
        return ends if along else ends[:, :, ::-1]

    def left_out(other: NDArray[np.float64], instance: int = 0, hidden: bool = True) -> list[bool]:
        ends = np.concatenate([parts(10.0), other])
        run, length = np.repeat([0, 1], 8), np.full(16, 5.0)
        found = beside_others(ends, np.repeat([False, hidden], 8), np.repeat([0, instance], 8), run, length)
        assert not found[:8].any()
        return found[8:].tolist()

    assert left_out(parts(12.0)) == [True] * 8
    assert left_out(parts(12.0) + np.array([0.0, 20.0])) == [True] * 4 + [False] * 4
    assert left_out(parts(14.0)) == [False] * 8
    assert left_out(parts(12.0), instance=1) == [False] * 8
    assert left_out(parts(12.0), hidden=False) == [False] * 8
    assert left_out(parts(20.0, along=False)) == [False] * 8


def moving(scene: Scene, start: float, height: float) -> NDArray[np.float64]:
    """What is seen of the lines in six views, half a degree from one to the next: their length."""
    low, high = (np.asarray(corner, dtype=np.float64) for corner in scene.bounds())
    middle, lengths = (low + high) / 2.0, []
    for angle in np.radians(start + 0.5 * np.arange(6)):
        eye = middle + 5.0 * np.array([math.sin(angle), 0.6, math.cos(angle)]) * height
        drawing = drawing_of(scene, OrthographicCamera.look_at(tuple(eye), tuple(middle), height=height), width=WIDTH, height=HEIGHT)
        lengths.append(sum(line.length for line in drawing.of(hidden=False)))
    return np.array(lengths)


@SLOW_AS_PYTHON
def test_a_rough_ball_does_not_flicker() -> None:
    """From view to view what is seen changes by less than three hundredths."""
    lengths = moving(scene_of(place(rough(primitives.sphere(1.0, 24), 0.006))), 10.0, 3.0)
    assert np.abs(np.diff(lengths)).max() < 0.03 * lengths.mean()


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", ["rocker-arm", "spot"])
def test_models_do_not_flicker(name: str) -> None:
    """Scanned, and coarse: the same."""
    path = MESHES / f"{name}.obj"
    if not path.is_file():
        pytest.skip(f"the optional mesh {path.name} is not there")
    scene = load(path)
    low, high = (np.asarray(corner) for corner in scene.bounds())
    lengths = moving(scene, 20.0, float(np.linalg.norm(high - low)))
    assert np.abs(np.diff(lengths)).max() < 0.03 * lengths.mean()
