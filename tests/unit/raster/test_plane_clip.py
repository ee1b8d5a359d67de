"""Clipping before the transform (FoCG 8.1.4, 8.1.6): polygons against planes in world space, and the picture that comes of it."""

from __future__ import annotations

import numpy as np
import pytest
from compiled import door_of
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, grid, interior, place, scene_of, two_triangles

from limner._door import Array
from limner._jit import kernel
from limner.aov import empty_values
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.raster import pipeline
from limner.raster.layouts import MAX_CLIPPED
from limner.raster.plane_clip import clip_triangle_to_planes
from limner.raster.pyramid import pyramid_planes
from limner.samples import pixel_samples
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.material import Lambert
from limner.scene.scene import Scene
from limner.tables.build import build, view
from limner.tables.camera import camera_record, near_and_far
from limner.tables.lighting import lighting

SIZE = 160, 120


@kernel
def _clip_each(polygons, scratch, planes, counts):
    for k in range(polygons.shape[0]):
        counts[k] = clip_triangle_to_planes(polygons[k], scratch, planes)


def _clipped(triangles: NDArray[np.float64], planes: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """What is left of (n, 3, 3 + attributes) triangles."""
    polygons = np.zeros((len(triangles), MAX_CLIPPED, triangles.shape[2]))
    polygons[:, :3] = triangles
    counts = np.zeros(len(triangles), np.int64)
    door = door_of(_clip_each, Array(np.float64, 3), Array(np.float64, 2), Array(np.float64, 2), Array(np.int64, 1))
    door(polygons, np.zeros((MAX_CLIPPED, triangles.shape[2])), np.ascontiguousarray(planes, dtype=np.float64), counts)
    return [polygon[:n] for polygon, n in zip(polygons, counts, strict=True)]


def _with_weights(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([corners, np.broadcast_to(np.eye(3), corners.shape)], axis=-1)


def _area(polygon: NDArray[np.float64]) -> float:
    p = polygon[:, :3]
    return float(np.linalg.norm(np.cross(p[1:-1] - p[0], p[2:] - p[0]).sum(axis=0)) / 2) if len(p) else 0.0


def test_attributes_are_cut_where_positions_are():
    """Barycentric coordinates that are carried along lead back to the cut points; all are inside every plane."""
    random = np.random.default_rng(4)
    triangles = _with_weights(random.normal(size=(400, 3, 3)))
    normals = random.normal(size=(6, 3))
    planes = np.column_stack([normals / np.linalg.norm(normals, axis=1, keepdims=True), np.full(6, 0.6)])
    parts = _clipped(triangles, planes)
    assert sum(len(p) > 3 for p in parts) > 50
    for triangle, part in zip(triangles, parts, strict=True):
        distances = triangle[:, :3] @ planes[:, :3].T + planes[:, 3]
        if (distances >= 0).all():
            np.testing.assert_array_equal(part, triangle)
        if (distances < 0).all(axis=0).any():
            assert len(part) == 0
        if len(part):
            assert (part[:, :3] @ planes[:, :3].T + planes[:, 3]).min() > -1e-12
            np.testing.assert_allclose(part[:, 3:] @ triangle[:, :3], part[:, :3], atol=1e-12)
            np.testing.assert_allclose(part[:, 3:].sum(axis=1), 1.0, atol=1e-12)
            assert part[:, 3:].min() > -1e-12


def test_the_two_sides_of_a_plane_make_up_the_triangle():
    random = np.random.default_rng(5)
    triangles = random.normal(size=(300, 3, 3))
    plane = np.array([[0.36, 0.48, 0.8, 0.1]])
    for triangle, a, b in zip(triangles, _clipped(triangles, plane), _clipped(triangles, -plane), strict=True):
        np.testing.assert_allclose(_area(a) + _area(b), _area(triangle), atol=1e-12)


def test_an_edge_is_cut_at_one_point_from_both_sides():
    random = np.random.default_rng(6)
    triangles = random.normal(size=(300, 3, 3))
    plane = np.array([[0.36, 0.48, 0.8, 0.1]])
    for a, b in zip(_clipped(triangles, plane), _clipped(triangles[:, ::-1], plane), strict=True):
        assert {tuple(v) for v in a} == {tuple(v) for v in b}


CAMERAS: dict[str, Camera] = {
    "perspective": PerspectiveCamera.look_at((0.4, 0.9, 2.0), (0, 0.1, 0), yfov_degrees=50),
    "far": PerspectiveCamera.look_at((0.4, 0.9, 2.0), (0, 0.1, 0), yfov_degrees=50, near=1.6, far=2.6),
    "parallel": OrthographicCamera.look_at((0.4, 0.9, 2.0), (0, 0.1, 0), height=1.2, near=1.2, far=2.6),
    "inside": PerspectiveCamera.look_at((0.1, 0.2, 0.1), (1, 0.3, -0.7), up=(0.2, 1, 0.3), yfov_degrees=120),
}


def _scene() -> Scene:
    mirrored = transform.translate(-0.5, 0, 0.3) @ transform.rotate_y(0.4) @ np.diag([-1.0, 1, 2, 1])
    return scene_of(
        place(primitives.box((6, 4, 6)), Lambert(double_sided=True)),
        place(grid(4, 50.0), at=(0, -0.6, 0)),
        place(primitives.sphere(0.5, 12), at=(0.7, 0, -0.6)),
        place(primitives.box((0.6, 0.6, 0.6)), matrix=mirrored),
    )


def _picture(scene: Scene, camera: Camera, clipping: str) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Instance and triangle of each pixel, and its colour."""
    tables = build(scene, camera, *SIZE)
    seen = view(scene, tables, camera, *SIZE)
    values, ids = empty_values(*SIZE)
    pipeline.draw_channels(tables, seen, values, ids, threads=1, clipping=clipping)
    film, background = np.zeros((SIZE[1], SIZE[0], 4), np.float32), np.zeros(4, np.float32)
    work = pipeline.prepare(tables, lighting(tables, None), seen, pixel_samples(1), background, film, threads=1, clipping=clipping)
    for tile in pipeline.tiles_of(*SIZE, pipeline.TILE_SIZE):
        work(tile, 0, 1)
    return np.stack([ids[..., 0], ids[..., 2]], axis=-1), film


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", CAMERAS)
def test_both_options_make_the_same_picture(name):
    """Pixels away from edges see the same triangle, at an edge at most a sample in a thousand the other; the same triangle has the same
    colour, to the bit, since it is shaded whole."""
    (before, colour_before), (after, colour_after) = (_picture(_scene(), CAMERAS[name], c) for c in ("world", "homogeneous"))
    same = (before == after).all(axis=-1)
    assert same.mean() > 0.999
    assert same[interior(after[..., 0] * 10_000 + after[..., 1])].all()
    np.testing.assert_array_equal(colour_before[same], colour_after[same])
    assert len(np.unique(after[..., 0])) > 2


@SLOW_AS_PYTHON
def test_no_seams_and_no_holes():
    """Neighbours that are both clipped share their edge: half transparent, each sample is covered once, at the picture's border too."""
    random = np.random.default_rng(2)
    glass = Lambert(alpha=0.5, alpha_mode="blend", double_sided=True)
    for _ in range(6):
        eye = random.uniform(-0.3, 0.3, size=3)
        camera = PerspectiveCamera.look_at(eye, eye + random.normal(size=3), up=random.normal(size=3), yfov_degrees=110)
        _, film = _picture(scene_of(place(primitives.sphere(1.0, 16), glass)), camera, "world")
        np.testing.assert_array_equal(film[..., 3], 0.5)


@pytest.mark.parametrize("camera", [CAMERAS["far"], CAMERAS["parallel"], PerspectiveCamera()])
def test_the_pyramid_is_that_of_the_picture(camera):
    """Rays through the picture's corners run inside all planes, between near and far; two pixels further out they do not."""
    bounds = np.array([(-1.0, -1, -1), (1, 1, 1)])
    near, far = near_and_far(camera, bounds)
    record = camera_record(camera, *SIZE, near, far)
    planes = pyramid_planes(record)
    assert len(planes) == (6 if np.isfinite(far) else 5)
    eye, corner, dx, dy, gaze = (record[0][name].astype(np.float64) for name in ("position", "corner", "dx", "dy", "gaze"))
    perspective = isinstance(camera, PerspectiveCamera)

    def distances(x: float, y: float, depth: float) -> NDArray[np.float64]:
        towards = corner + x * dx + y * dy
        p = eye + depth * towards if perspective else eye + towards + depth * gaze
        return planes[:, :3] @ p + planes[:, 3]

    depths = near * 1.01, min(far * 0.99, 100.0)
    right, top = SIZE[0] - 0.5, SIZE[1] - 0.5
    for depth in depths:
        for x, y in ((-0.5, -0.5), (right, -0.5), (right, top), (-0.5, top)):
            assert distances(x, y, depth).min() >= 0
        for x, y in ((-2.5, 9), (right + 2, 9), (9, -2.5), (9, top + 2)):
            assert distances(x, y, depth).min() < 0
    assert distances(9, 9, near * 0.99).min() < 0
    if np.isfinite(far):
        assert distances(9, 9, far * 1.01).min() < 0


def test_numbers_without_measure():
    """A floor a million times as large as the camera is high, and a triangle with a corner on the eye: as with the other option."""
    huge = two_triangles((-1e6, -1, -1e6), (1e6, -1, -1e6), (1e6, -1, 1e6), (-1e6, -1, 1e6))
    through = two_triangles((0, 0, 0), (1, -0.3, -1), (1, 1, -2), (-0.4, 1, -1))
    for mesh, seen in ((huge, 0.5), (through, 0.0)):  # what passes through the eye shows its edge alone
        scene, camera = scene_of(place(mesh, Lambert(double_sided=True))), PerspectiveCamera(near=0.1)
        (ids, film), (expected, _) = (_picture(scene, camera, clipping) for clipping in ("world", "homogeneous"))
        assert np.isfinite(film).all()
        np.testing.assert_array_equal(ids, expected)
        assert (ids[..., 0] == 0).mean() == seen
