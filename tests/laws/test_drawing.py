"""What holds of the lines of every scene: how many surfaces hide them is what rays count, and does not depend on how they are described."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.artistic import chain
from limner.artistic.lines import Drawing, drawing_of
from limner.linear import transform
from limner.mesh.adjacency import adjacency_of_triangles
from limner.mesh.mesh import Mesh
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape

Floats = NDArray[np.float64]

SIZE = 100
OUTSIDE = PerspectiveCamera.look_at((0.3, 0.4, 4.0), (0, 0, 0), yfov_degrees=40)
INSIDE = PerspectiveCamera.look_at((0.1, 0.2, 0.3), (0.5, -0.2, -1.0), yfov_degrees=80)
PARALLEL = OrthographicCamera.look_at((1.0, 2.0, 3.0), (0, 0, 0), height=2.5)


def soup(seed: int, n: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Triangles anywhere in a cube, through each other and through the eye that is in it."""
    rng = np.random.default_rng(seed)
    middle = rng.uniform(-1.0, 1.0, (n, 1, 3))
    points = (middle + rng.uniform(-0.6, 0.6, (n, 3, 3))).astype(np.float32).reshape(-1, 3)
    return points, np.arange(3 * n, dtype=np.int32).reshape(-1, 3)


def drawn(points: Floats | NDArray[np.float32], triangles: NDArray[np.int32], camera: Camera, **options: object) -> Drawing:
    root = Node(shapes=(Shape(Mesh(np.float32(points), triangles), (Lambert(),)),))
    return drawing_of(Scene(root=root), camera, width=SIZE, height=SIZE, **options)  # type: ignore[arg-type]


def in_front(p: Floats, camera: Camera, corners: Floats, near: float) -> tuple[int, float]:
    """How many triangles a ray from the near plane to a point meets, and by how much (relative) it might have been another number."""
    place = np.asarray(camera.world_from_camera)
    eye = place[:3, 3] if isinstance(camera, PerspectiveCamera) else p + 50.0 * place[:3, 2]
    way = p - eye
    a, e1, e2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    h = np.cross(way, e2)
    determinant = (e1 * h).sum(axis=1)
    s = eye - a
    u = (s * h).sum(axis=1) / determinant
    q = np.cross(s, e1)
    v = (q @ way) / determinant
    t = (e2 * q).sum(axis=1) / determinant
    first = near / float(-(way @ place[:3, 2])) if isinstance(camera, PerspectiveCamera) else -np.inf
    margins = np.stack([u, v, 1.0 - u - v, 1.0 - t, t - first], axis=1).min(axis=1)
    # Its own triangle is met at t = 1, where it neither hides nor nearly does.
    other = ~((np.abs(t - 1.0) < 1e-5) & (np.minimum(np.minimum(u, v), 1.0 - u - v) > -1e-5))
    return int((margins[other] > 0.0).sum()), float(np.abs(margins[other]).min(initial=1.0))


@pytest.mark.parametrize(("camera", "seed"), [(OUTSIDE, 1), (INSIDE, 2), (PARALLEL, 3)])
def test_rays_count_as_many_surfaces(camera: Camera, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """On every line, at points that are not just at a crossing, a ray meets as many triangles as the line is hidden by."""
    monkeypatch.setattr(chain, "_LEAST", 0.0)  # parts that are too short to be seen are parts too
    monkeypatch.setattr(chain, "_LEAST_SMOOTH", 0.0)
    points, triangles = soup(seed, 30)
    drawing = drawn(points, triangles, camera, kinds=("boundary", "intersection"))
    corners = points[triangles].astype(np.float64)
    near = 1e-6 * float(np.abs(corners).max())
    asked = 0
    for line in drawing.lines:
        for p, q in zip(line.world[:-1], line.world[1:], strict=True):
            for share in (0.21, 0.5, 0.83):
                count, margin = in_front(p + share * (q - p), camera, corners, near)
                if margin > 1e-4:
                    assert count == line.hidden_by
                    asked += 1
    assert asked > 100
    assert len({line.hidden_by for line in drawing.lines}) > 2


def lengths(drawing: Drawing) -> dict[tuple[str, int], float]:
    """How much there is of each kind, by how many hide it."""
    found: dict[tuple[str, int], float] = {}
    for line in drawing.lines:
        key = line.kind, line.hidden_by
        found[key] = found.get(key, 0.0) + line.length
    return found


def agree(one: Drawing, other: Drawing) -> None:
    """The same lines, but for rounding and for parts that are too short to be seen."""
    a, b = lengths(one), lengths(other)
    assert all(abs(a.get(key, 0.0) - b.get(key, 0.0)) < 1.0 for key in a.keys() | b.keys())


def test_the_order_of_triangles_does_not_matter() -> None:
    """Nor which corner they begin with."""
    points, triangles = soup(5, 20)
    rng = np.random.default_rng(0)
    shuffled = np.stack([np.roll(t, k) for t, k in zip(triangles, rng.integers(0, 3, len(triangles)), strict=True)])
    agree(drawn(points, triangles, OUTSIDE), drawn(points, rng.permutation(shuffled), OUTSIDE))


def test_how_surfaces_are_divided_does_not_matter() -> None:
    """Each triangle cut in four hides as much, without gaps between the parts, and shows no lines inside."""
    points, triangles = soup(6, 16)
    points = np.round(points * 64.0) / 64.0  # whose midpoints are exact
    found = adjacency_of_triangles(triangles, len(points))
    middles = (points[found.edges[:, 0]] + points[found.edges[:, 1]]) / 2.0
    (i, j, k), (x, y, z) = triangles.T, found.triangle_edges.T + len(points)
    quarters = np.concatenate([np.stack(c, axis=1) for c in ((i, x, z), (x, j, y), (z, y, k), (x, y, z))]).astype(np.int32)
    for camera in (OUTSIDE, PARALLEL):
        agree(drawn(points, triangles, camera), drawn(np.concatenate([points, middles]), quarters, camera))


def test_moving_all_moves_nothing() -> None:
    """The scene and the camera turned and shifted together."""
    points, triangles = soup(7, 16)
    moved = transform.translate(3.0, -2.0, 1.0) @ transform.rotate_y(0.7) @ transform.rotate_x(-0.4)
    there = points @ moved[:3, :3].T + moved[:3, 3]
    agree(drawn(points, triangles, OUTSIDE), drawn(there, triangles, OUTSIDE.replace(world_from_camera=moved @ OUTSIDE.world_from_camera)))


def test_lines_without_what_is_hidden_are_the_same_lines() -> None:
    """Asked for what is seen only, one gets exactly what is seen."""
    points, triangles = soup(8, 12)
    seen = drawn(points, triangles, OUTSIDE, hidden=False).lines
    expected = drawn(points, triangles, OUTSIDE).of(hidden=False)
    assert len(seen) == len(expected)
    assert all((a.picture == b.picture).all() for a, b in zip(seen, expected, strict=True))
