"""Surfaces that shine, as paths ask them for light."""

from __future__ import annotations

import numpy as np
import pytest

from limner._door import Array
from limner._jit import kernel
from limner.kernel.vec import Vec3
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.render import Renderer
from limner.scene.camera import PerspectiveCamera
from limner.scene.environment import Environment
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.shading.light_tree import draw_leaf, share_of
from limner.tables.build import flatten
from limner.tables.layouts import EMITTER
from limner.tables.lighting import lighting, sky_cumulative
from tests.compiled import door_of
from tests.staging import SLOW_AS_PYTHON, grid, place

CAMERA = PerspectiveCamera.look_at((0.0, 1.5, 4.0), (0.0, 0.0, 0.0), yfov_degrees=40.0)
DOWN = transform.rotate((1.0, 0.0, 0.0), np.pi)


def lamp_over_floor(n: int, matrix: np.ndarray | None = None) -> Scene:
    """A floor under a square lamp of 2 (n - 1)^2 triangles that shines downwards."""
    lamp = place(grid(n, 0.5), Lambert(color=(0.0, 0.0, 0.0), emission=(5.0, 5.0, 5.0)), matrix=matrix)
    floor = place(grid(2, 2.0), Lambert(color=(0.5, 0.5, 0.5), double_sided=True))
    return Scene(Node(children=(lamp, floor, Node("no default light", lights=()))), camera=CAMERA, background=(0.0, 0.0, 0.0))


def drawn(scene: Scene, seed: int = 0, samples: int = 16) -> np.ndarray:
    with Renderer(
        scene, renderer="path", width=12, height=8, samples=samples, seed=seed, max_depth=1, default_lights=False, threads=1
    ) as renderer:
        return renderer.render().pixels[..., :3].astype(np.float64)


def above(matrix: np.ndarray) -> np.ndarray:
    return transform.translate(0.0, 1.4, 0.0) @ matrix


@SLOW_AS_PYTHON
def test_a_lamp_of_many_triangles_is_as_quiet_as_one_of_few():
    """From 8 triangles to 10,082, the mean stays and the variance at most doubles: what is left of the number that chose a triangle
    chooses the point, so the points stay spread over the whole lamp."""
    few, many = ([drawn(lamp_over_floor(n, above(DOWN)), seed) for seed in range(96)] for n in (3, 72))
    assert np.mean(many) == pytest.approx(np.mean(few), rel=0.003)
    assert np.var(many, axis=0).mean() < 2.0 * np.var(few, axis=0).mean()


@SLOW_AS_PYTHON
def test_a_mirrored_lamp_shines_to_the_same_side():
    """A place that reflects turns triangles round, not what is outside."""
    mirrored = above(DOWN) @ transform.scale(-1.0, 1.0, 1.0)
    assert drawn(lamp_over_floor(3, mirrored)).mean() == pytest.approx(drawn(lamp_over_floor(3, above(DOWN))).mean(), rel=0.01)


def lanterns(n: int) -> Scene:
    """Small square lamps that hang about in a room, one-sided, every second of another strength, over a floor."""
    rng = np.random.default_rng(3)
    corner, a = rng.uniform((-3.0, 0.6, -3.0), (3.0, 1.8, 3.0), (n, 3)), rng.normal(size=(n, 3))
    a *= 0.2 / np.linalg.norm(a, axis=1, keepdims=True)
    b = np.cross(a, rng.normal(size=(n, 3)))
    b *= 0.2 / np.linalg.norm(b, axis=1, keepdims=True)
    positions = np.stack([corner, corner + a, corner + a + b, corner + b], axis=1).astype(np.float32)
    squares = np.array([[0, 1, 2], [0, 2, 3]])

    def hung(places: np.ndarray, level: float) -> Node:
        triangles = squares + 4 * np.arange(len(places))[:, None, None]
        return place(Mesh(places.reshape(-1, 3), triangles.reshape(-1, 3)), Lambert(color=(0.0, 0.0, 0.0), emission=(level, level, level)))

    weak, strong = hung(positions[::2], 4.0), hung(positions[1::2], 12.0)
    floor = place(grid(2, 4.0), Lambert(color=(0.5, 0.5, 0.5)))
    camera = PerspectiveCamera.look_at((0.0, 0.5, 4.0), (0.0, 0.0, 1.5), yfov_degrees=40.0)
    return Scene(Node(children=(floor, weak, strong)), camera=camera, background=(0.0, 0.0, 0.0))


def test_the_chances_of_a_tree_are_those_with_which_it_is_drawn():
    """They sum to 1 where anything shines; an even comb of numbers finds every row as often as its chance says (its discrepancy bounds the
    count's error by 1); and what is left of a number is a number."""
    rows = lighting(flatten(lanterns(37), CAMERA, 8, 8).tables, None)
    assert rows.header["light_tree"][0] == 1
    n, comb = len(rows.emitters), ((np.arange(2000) + 0.5) / 2000).astype(np.float32)
    for p in ((0.3, 0.0, 0.2), (1.0, 1.2, -1.0), (-2.0, 0.0, 2.9), (30.0, 1.0, 0.0)):
        chances, drawn = shares_and_draws(rows.emitters, np.float32(p), comb)
        assert chances.sum() == pytest.approx(1.0, abs=1e-5)
        found, share, rest = drawn.T
        assert np.abs(np.bincount(found.astype(np.int64), minlength=n) - 2000 * chances).max() <= 1.01
        np.testing.assert_allclose(share, chances[found.astype(np.int64)], rtol=1e-4)
        assert rest.min() >= 0.0
        assert rest.max() < 1.0


@kernel
def _into(emitters, p, comb, chances, drawn):
    point = Vec3(p[0], p[1], p[2])
    for k in range(emitters.shape[0]):
        chances[k] = share_of(emitters, k, point)
    for k in range(comb.shape[0]):
        leaf = draw_leaf(emitters, point, comb[k])
        drawn[k, 0], drawn[k, 1], drawn[k, 2] = np.float32(leaf.row), leaf.share, leaf.rest


def shares_and_draws(emitters: np.ndarray, p: np.ndarray, comb: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    floats, table = Array(np.float32, 1), Array(np.float32, 2)
    chances, drawn = np.zeros(len(emitters), dtype=np.float32), np.zeros((len(comb), 3), dtype=np.float32)
    door_of(_into, Array(EMITTER, 1), floats, floats, floats, table)(emitters, p, comb, chances, drawn)
    return chances, drawn


def test_every_triangle_is_found_by_its_name():
    rows = lighting(flatten(lanterns(37), CAMERA, 8, 8).tables, None).emitters
    names = sorted(zip(rows["instance"].tolist(), rows["triangle"].tolist(), range(len(rows)), strict=True))
    keys = zip(rows["key_instance"].tolist(), rows["key_triangle"].tolist(), rows["key_row"].tolist(), strict=True)
    assert list(keys) == names


@SLOW_AS_PYTHON
def test_a_tree_changes_no_mean_and_makes_lanterns_quieter(monkeypatch: pytest.MonkeyPatch):
    """A path that meets a lantern by chance knows how likely it was to ask it. Rows of the floor alone."""
    by_tree = [drawn(lanterns(60), seed)[-3:] for seed in range(24)]
    monkeypatch.setattr("limner.tables.lighting._FEW", 10**9)
    by_power = [drawn(lanterns(60), seed)[-3:] for seed in range(24)]
    assert np.mean(by_tree) == pytest.approx(np.mean(by_power), rel=0.02)
    assert np.var(by_tree, axis=0).mean() < 0.7 * np.var(by_power, axis=0).mean()


def test_one_lamp_in_many_pieces_needs_no_tree():
    rows = lighting(flatten(lamp_over_floor(20, above(DOWN)), CAMERA, 8, 8).tables, None)
    assert rows.header["light_tree"][0] == 0


def test_rows_say_where_triangles_are():
    """Corners, edges and normals are those of the world; shares of the power end at 1 and are in proportion to the area."""
    scene = lamp_over_floor(3, above(DOWN) @ transform.scale(2.0, 1.0, 1.0))
    rows = lighting(flatten(scene, CAMERA, 8, 8).tables, None).emitters
    assert len(rows) == 8
    np.testing.assert_allclose(rows["normal"], np.tile((0.0, -1.0, 0.0), (8, 1)), atol=1e-6)
    np.testing.assert_allclose(rows["corner"][:, 1], 1.4, rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(np.cross(rows["edge_u"], rows["edge_v"]), axis=1), 0.5, rtol=1e-6)
    np.testing.assert_allclose(rows["cumulative"], np.arange(1, 9) / 8, rtol=1e-6)
    assert (rows["plain"] == 1).all()


def test_triangles_without_area_do_not_shine():
    positions = np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1], [2, 0, 0]], dtype=np.float32)
    mesh = Mesh(positions, np.array([[0, 1, 3], [0, 2, 1], [1, 1, 2]], dtype=np.int32))
    scene = Scene(Node(children=(place(mesh, Lambert(emission=(1.0, 1.0, 1.0))),)), camera=CAMERA)
    made = lighting(flatten(scene, CAMERA, 8, 8).tables, None)
    assert made.emitters["triangle"].tolist() == [1]
    assert made.header["emitted_power"][0] == pytest.approx(0.5)


def test_an_even_sky_is_known_as_one():
    tables = flatten(lamp_over_floor(2), CAMERA, 8, 8).tables
    sky = np.full((4, 8, 3), 0.5, dtype=np.float32)
    assert lighting(tables, sky).header["sky_even"][0] == 1
    sky[1, 1, 0] = 0.6
    assert lighting(tables, sky).header["sky_even"][0] == 0


@pytest.mark.filterwarnings("error")
def test_a_black_sky_can_be_drawn_from():
    shares = sky_cumulative(np.zeros((4, 8, 3), dtype=np.float32))
    assert np.isfinite(shares).all()
    assert shares[4] == 1.0


def test_infinite_radiance_is_the_greatest_that_is_not():
    sky = np.full((4, 8, 3), 0.5, dtype=np.float32)
    sky[0, 0], sky[1, 1], sky[2, 2] = np.inf, np.nan, 3.0
    made = lighting(flatten(lamp_over_floor(2), CAMERA, 8, 8).tables, sky)
    assert made.sky[3, 0].tolist() == [3.0] * 3
    assert made.sky[2, 1].tolist() == [0.0] * 3
    assert np.isfinite(made.sky_cumulative).all()
    assert np.isfinite(made.header["irradiance"]).all()


@SLOW_AS_PYTHON
@pytest.mark.parametrize("edge", [0.0, 1e-3])
def test_an_even_sky_lights_as_one_that_is_asked(edge):
    """A sky found by chance alone gives what one gives that differs in a single texel, and is therefore asked, too."""
    sky = np.full((16, 32, 3), 0.7, dtype=np.float32)
    sky[0, 0] += edge
    floor = place(grid(2, 50.0), Lambert(color=(0.5, 0.5, 0.5)))
    bare = Scene(Node(children=(floor,)), camera=CAMERA, environment=Environment(sky))
    assert drawn(bare, samples=64)[-1].mean() == pytest.approx(0.35, rel=0.02)
