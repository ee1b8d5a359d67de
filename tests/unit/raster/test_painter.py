"""The painter's algorithm (FoCG 8.2.2, 12.4): back to front shows what the z-buffer shows, also where triangles must be cut."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, place, scene_of, two_triangles

from limner.aov import empty_values
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.raster import bsp, painter, pipeline
from limner.samples import pixel_samples
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.material import Lambert
from limner.scene.scene import Scene
from limner.tables.build import build, view
from limner.tables.layouts import SceneTables
from limner.tables.lighting import lighting

SIZE = 160, 120
CAMERA = PerspectiveCamera.look_at((0.4, 1.1, 3.0), (0, 0, 0), yfov_degrees=45)
PARALLEL = OrthographicCamera.look_at((0.4, 1.1, 3.0), (0, 0, 0), height=2.6)


def _ids(scene: Scene, camera: Camera, **options: object) -> NDArray[np.int32]:
    """(height, width, 2): instance and triangle at the centre of each pixel."""
    tables = build(scene, camera, *SIZE)
    values, ids = empty_values(*SIZE)
    pipeline.draw_channels(tables, view(scene, tables, camera, *SIZE), values, ids, threads=1, **options)
    return np.stack([ids[..., 0], ids[..., 2]], axis=-1)


def _both(scene: Scene, camera: Camera) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    return _ids(scene, camera, hidden_surfaces="painter"), _ids(scene, camera)


def _film(scene: Scene, camera: Camera, samples: int = 4, multisample: int = 0, **options: object) -> NDArray[np.float32]:
    tables = build(scene, camera, *SIZE)
    film, background = np.zeros((SIZE[1], SIZE[0], 4), np.float32), np.zeros(4, np.float32)
    work = pipeline.prepare(
        tables, lighting(tables, None), view(scene, tables, camera, *SIZE), pixel_samples(samples), background, film, threads=1,
        multisample=multisample, **options,
    )  # fmt: skip
    for tile in pipeline.tiles_of(*SIZE, pipeline.TILE_SIZE):
        work(tile, 0, samples)
    return film / samples


def _soup(n: int, size: float = 0.3, seed: int = 1) -> Mesh:
    """Triangles at random, through each other."""
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, size=(n, 1, 3)) + random.normal(size=(n, 3, 3)) * size
    return Mesh(corners.reshape(-1, 3).astype(np.float32), np.arange(3 * n, dtype=np.int32).reshape(n, 3))


def _bars() -> Scene:
    """Three bars, each over the next: no order of the whole ones is right."""
    slope = np.arctan2(0.4, 1.8)
    bar = transform.translate(0, 0.55, 0) @ transform.rotate_y(slope)
    corners = (-1.2, -0.12, 0), (1.2, -0.12, 0), (1.2, 0.12, 0), (-1.2, 0.12, 0)
    turns = [transform.rotate_z(k * 2 * np.pi / 3) @ bar for k in range(3)]
    return scene_of(*(place(two_triangles(*corners), matrix=turn) for turn in turns))


def test_each_bar_over_the_next():
    scene = _bars()
    for camera in (PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0)), OrthographicCamera.look_at((0, 0, 4), (0, 0, 0), height=2.6)):
        drawn, tested = _both(scene, camera)
        np.testing.assert_array_equal(drawn, tested)
        assert set(np.unique(drawn[..., 0])) == {-1, 0, 1, 2}
    # There is something to cut: without it no order is right.
    tables = build(scene, CAMERA, *SIZE)
    tree = painter.build_tree(tables)
    assert tree is not None
    assert len(tree.fragments) > len(tree.triangles)


def test_sheets_through_each_other():
    """Away from the line of intersection, the very ids of the z-buffer; on it, one of the two."""
    sheets = [
        place(two_triangles((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), matrix=transform.rotate_y(t) @ transform.rotate_x(0.3 * t))
        for t in (0.3, 1.2, 2.1)
    ]
    for camera in (CAMERA, PARALLEL):
        drawn, tested = _both(scene_of(*sheets), camera)
        assert set(np.unique(drawn[..., 0])) == {-1, 0, 1, 2}
        assert (drawn != tested).any(axis=-1).mean() < 2e-4


@SLOW_AS_PYTHON
def test_two_thousand_triangles_at_random():
    for size, camera in ((0.1, CAMERA), (0.1, PARALLEL), (0.3, CAMERA)):
        drawn, tested = _both(scene_of(place(_soup(2000, size))), camera)
        np.testing.assert_array_equal(drawn[..., 0], tested[..., 0])
        assert (drawn != tested).any(axis=-1).mean() < 1e-3


@SLOW_AS_PYTHON
def test_coverage_is_that_of_the_whole_triangles():
    """Bug class: a mesh cut at one triangle's plane but not at its neighbour's shows gaps where their vertices no longer meet. Fragments
    are whole triangles within cuts, so every sample of a closed surface is covered, and the alpha is the z-buffer's, to the bit."""
    solids = place(primitives.sphere(0.8, 24)), place(primitives.sphere(0.7, 20), at=(0.5, 0.2, 0.1))
    scene = scene_of(*solids, place(_soup(60, 0.8), Lambert(double_sided=True)))
    for multisample in (0, 8):
        drawn, tested = (_film(scene, CAMERA, 8, multisample, hidden_surfaces=h) for h in ("painter", "zbuffer"))
        np.testing.assert_array_equal(drawn[..., 3], tested[..., 3])
        assert (np.abs(drawn - tested).max(axis=-1) > 0.02).mean() < 2e-3


def test_transparent_layers_are_composited_in_the_painter_s_order():
    """Half transparent sheets through each other and through an opaque one: the z-buffer's peeled layers, without any depth."""
    glass = [Lambert(color=c, alpha=0.5, alpha_mode="blend", double_sided=True) for c in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    corners = (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)
    sheets = [place(two_triangles(*corners), m, matrix=transform.rotate_y(t)) for t, m in zip((0.3, 1.2, 2.1), glass, strict=True)]
    scene = scene_of(*sheets, place(two_triangles(*corners), Lambert(double_sided=True), matrix=transform.rotate_x(1.2)))
    drawn, tested = (_film(scene, CAMERA, 1, hidden_surfaces=h) for h in ("painter", "zbuffer"))
    assert len(np.unique(tested.round(3).reshape(-1, 4), axis=0)) > 10
    assert (np.abs(drawn - tested).max(axis=-1) > 1e-5).mean() < 2e-3


def test_what_lies_in_one_plane_shows_the_first_of_the_scene():
    """The rule of the z-buffer for ties, without its rounding: here two walls of different triangles never flicker."""
    wall = two_triangles((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))
    shifted = two_triangles((-0.5, -0.5, 0), (1.5, -0.5, 0), (1.5, 1.5, 0), (-0.5, 1.5, 0))
    drawn = _ids(scene_of(place(shifted), place(wall), place(wall), place(shifted)), CAMERA, hidden_surfaces="painter")[..., 0]
    first, second = (_ids(scene_of(place(mesh)), CAMERA)[..., 0] == 0 for mesh in (shifted, wall))
    np.testing.assert_array_equal(drawn, np.where(first, 0, np.where(second, 1, -1)))


def test_far_cuts_as_the_z_buffer_does():
    floor = two_triangles((-9, 0, 9), (9, 0, 9), (9, 0, -9), (-9, 0, -9))
    wall = two_triangles((-9, -9, -5), (9, -9, -5), (9, 9, -5), (-9, 9, -5))
    for kind in (PerspectiveCamera, OrthographicCamera):
        camera = kind.look_at((0, 1, 3), (0.3, 0.2, 0), near=0.5, far=6.0)
        drawn, tested = _both(scene_of(place(floor), place(wall)), camera)
        np.testing.assert_array_equal(drawn, tested)
        assert {-1, 0} <= set(np.unique(drawn[..., 0]))


def test_boxes_beside_each_other_are_drawn_back_to_front():
    """Separated convex solids, seen from any side."""
    random = np.random.default_rng(3)
    places = np.array([(x, y, z) for x in (-2, 0, 2) for y in (-2, 0, 2) for z in (-2, 0, 2)], dtype=float)
    scene = scene_of(*(place(primitives.box((1, 1, 1)), at=tuple(p)) for p in places))
    for _ in range(6):
        eye = random.normal(size=3)
        camera = PerspectiveCamera.look_at(8 * eye / np.linalg.norm(eye), (0, 0, 0))
        tables = build(scene, camera, *SIZE)
        order, note = painter.order(tables, view(scene, tables, camera, *SIZE).camera)
        assert note is None
        assert order.tree is not None
        _assert_back_to_front(order.tree, order.fragments, np.asarray(camera.world_from_camera)[:3, 3])


def _assert_back_to_front(tree: bsp.BspTree, order: NDArray[np.int32], eye: NDArray[np.float64], n_rays: int = 200) -> None:
    """Along rays from the eye, what is drawn later is met earlier."""
    fans = []
    for rank, (first, n) in enumerate(tree.fragments[order, :2]):
        p = tree.points[first : first + n]
        fans += [(rank, p[0], p[i], p[i + 1]) for i in range(1, n - 1)]
    ranks = np.array([rank for rank, *_ in fans])
    a, b, c = (np.array([fan[k] for fan in fans]) for k in (1, 2, 3))
    targets = np.random.default_rng(5).uniform(tree.points.min(axis=0), tree.points.max(axis=0), size=(n_rays, 3))
    met = 0
    for d in (targets - eye) / np.linalg.norm(targets - eye, axis=1, keepdims=True):
        p, s = np.cross(d, c - a), eye - a
        with np.errstate(all="ignore"):
            q, det = np.cross(s, b - a), np.einsum("ij,ij->i", b - a, p)
            u, v, t = np.einsum("ij,ij->i", s, p) / det, q @ d / det, np.einsum("ij,ij->i", c - a, q) / det
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        assert (np.diff(ranks[hit]) >= 0).all()
        assert (np.diff(t[hit]) < 1e-5).all()
        met += max(0, int(hit.sum()) - 1)
    assert met > 0


@SLOW_AS_PYTHON
@settings(max_examples=15)
@given(seed=st.integers(0, 1 << 30))
def test_fragments_make_up_their_triangles_and_an_order(seed):
    """Cutting loses no area, and the order is from back to front for eyes outside and amidst."""
    soup = _soup(40, 0.6, seed)
    triangles = soup.positions[soup.triangles].astype(np.float64)
    tree = bsp.build(triangles)
    assert tree is not None
    areas = np.zeros(len(triangles))
    for first, n, triangle, *_ in tree.fragments:
        p = tree.points[first : first + n]
        areas[triangle] += np.linalg.norm(np.cross(p[1:-1] - p[0], p[2:] - p[0]).sum(axis=0)) / 2
    whole = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1) / 2
    np.testing.assert_allclose(areas, whole, rtol=1e-5, atol=1e-7)
    for eye in ((3.0, 2.0, 4.0), (0.1, 0.0, 0.0)):
        order = bsp.back_to_front(tree, np.array([*eye, 1.0]))
        assert sorted(order) == list(range(len(tree.fragments)))
        _assert_back_to_front(tree, order, np.array(eye), 40)


@SLOW_AS_PYTHON
def test_beyond_the_limit_centroids_decide_and_a_note_says_so():
    scene = scene_of(place(primitives.sphere(0.8, 80)))
    notes: list[str] = []
    film = _film(scene, CAMERA, 1, hidden_surfaces="painter", on_note=notes.append)
    assert len(notes) == 1
    assert "centroids" in notes[0]
    tested = _film(scene, CAMERA, 1)
    np.testing.assert_array_equal(film[..., 3], tested[..., 3])
    np.testing.assert_array_equal(film, tested)  # a sphere hides its own back, and no more


@pytest.mark.parametrize("mesh", [Mesh(np.zeros((3, 3), np.float32), np.array([[0, 1, 2]], np.int32)), None])
def test_nothing_to_draw(mesh):
    scene = scene_of(place(mesh)) if mesh is not None else scene_of()
    assert (_ids(scene, CAMERA, hidden_surfaces="painter") == -1).all()


def test_a_tree_serves_every_camera():
    scene = _bars()
    tables: SceneTables = build(scene, CAMERA, *SIZE)
    tree = painter.build_tree(tables)
    for eye in ((0, 0, 4), (1, 2, -3), (0, 3, 0.1)):
        camera = PerspectiveCamera.look_at(eye, (0, 0, 0))
        np.testing.assert_array_equal(
            _ids(scene, camera, hidden_surfaces="painter", tree=tree), _ids(scene, camera, hidden_surfaces="painter")
        )
