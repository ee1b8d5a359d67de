"""The ray caster against a brute-force oracle in float64, and against geometry that leaves no way out."""

from __future__ import annotations

import pickle
from typing import Any, get_args

import numpy as np
import pytest
from numpy.typing import NDArray

from limner import _jit
from limner.errors import SceneError, UnsupportedError
from limner.mesh.shapes.revolution import torus
from limner.raycaster import Hits, Kind, RayCaster

MANY = 2000 if _jit.MODE == "compiled" else 200  # kernels as Python take a millisecond a ray

KINDS = get_args(Kind)
TRIANGLE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def brute_force(corners: NDArray[np.float64], origins: Any, directions: Any) -> tuple[NDArray[np.float64], ...]:
    """t, triangle, and the margin by which the ray passes inside the triangle's edges (< 0: outside), for every ray and triangle.

    Moeller and Trumbore, *Fast, minimum storage ray/triangle intersection*, 1997, in float64.
    """
    a, e1, e2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    o, d = np.asarray(origins, np.float64)[:, None], np.asarray(directions, np.float64)[:, None]
    with np.errstate(all="ignore"):
        p = np.cross(d, e2)
        inverse = 1.0 / (p * e1).sum(-1)
        s = o - a
        u = (p * s).sum(-1) * inverse
        q = np.cross(s, e1)
        v = (q * d).sum(-1) * inverse
        t = (q * e2).sum(-1) * inverse
    margin = np.where(np.isfinite(t), np.minimum(np.minimum(u, v), 1.0 - u - v), -np.inf)
    return t, u, v, margin


def check_against_oracle(corners: NDArray[np.float64], origins: Any, directions: Any, hits: Hits, epsilon: float = 1e-4) -> int:
    """Each hit is one of the oracle's, nothing the ray certainly meets lies before it. Returns the number of certain hits."""
    t, u, v, margin = brute_force(corners, origins, directions)
    certain = np.where((margin > epsilon) & (t > 0.0), t, np.inf)
    first = certain.min(axis=1)
    scale = np.abs(corners).max() + 1.0
    slack = epsilon * scale / np.linalg.norm(directions, axis=1)
    assert (hits.t <= first + slack).all()
    rows = np.flatnonzero(hits.hit)
    chosen = hits.triangle[rows]
    assert (margin[rows, chosen] > -epsilon).all()
    np.testing.assert_array_less(np.abs(hits.t[rows] - t[rows, chosen]), slack[rows])
    inside = margin[rows, chosen] > 0.01
    np.testing.assert_allclose(hits.u[rows][inside], u[rows, chosen][inside], atol=5e-3)
    np.testing.assert_allclose(hits.v[rows][inside], v[rows, chosen][inside], atol=5e-3)
    assert np.isinf(hits.t[~hits.hit]).all()
    return int(np.isfinite(first).sum())


def soup(n: int, seed: int = 0) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Random triangles that share nothing."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1.0, 1.0, (n, 1, 3)) + rng.uniform(-0.3, 0.3, (n, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * n).reshape(-1, 3)


def random_rays(n: int, seed: int = 1) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rays from all around and inside towards the middle, with directions of many lengths."""
    rng = np.random.default_rng(seed)
    origins = rng.uniform(-2.0, 2.0, (n, 3))
    return origins, (rng.uniform(-1.0, 1.0, (n, 3)) - origins) * 10.0 ** rng.uniform(-2.0, 2.0, (n, 1))


def icosphere(subdivisions: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A closed mesh on the unit sphere: the icosahedron, each triangle cut in four again and again."""
    g = (1.0 + 5.0**0.5) / 2.0
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g)]
    points += [(g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    v = np.array(points) / np.hypot(1.0, g)
    f = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8)]
    f += [(3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    triangles = np.array(f)
    for _ in range(subdivisions):
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        pairs, which = np.unique(edges, axis=0, return_inverse=True)
        middles = v[pairs].mean(axis=1)
        middles /= np.linalg.norm(middles, axis=1, keepdims=True)
        m = which.reshape(-1, 3) + len(v)
        a, b, c = triangles.T
        x, y, z = m.T
        triangles = np.concatenate([np.stack(part, axis=1) for part in ((a, x, z), (x, b, y), (z, y, c), (x, y, z))])
        v = np.concatenate([v, middles])
    return v, triangles


@pytest.mark.parametrize("accelerator", KINDS)
def test_random_triangles_and_rays(accelerator: Any) -> None:
    """Every hit is right, and none is missed, by either way of looking."""
    vertices, triangles = soup(200 if _jit.MODE == "compiled" else 30)
    origins, directions = random_rays(MANY)
    caster = RayCaster(vertices, triangles, accelerator=accelerator)
    hits = caster.intersect(origins, directions)
    n_certain = check_against_oracle(vertices[triangles], origins, directions, hits)
    assert n_certain > MANY // 10
    np.testing.assert_array_equal(caster.occluded(origins, directions), hits.hit)


@pytest.mark.parametrize("scale", [1e-30, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e30])
@pytest.mark.parametrize("shift", [0.0, 5.0, 3e4])
def test_scales_and_places(scale: float, shift: float) -> None:
    """What is hit does not depend on the unit of length, nor much on where the mesh stands."""
    vertices, triangles = soup(20)
    origins, directions = random_rays(min(MANY, 500))
    offset = np.array([shift, -shift, shift / 3.0])
    moved = ((vertices + offset) * scale)[triangles]
    caster = RayCaster((vertices + offset) * scale, triangles)
    hits = caster.intersect((origins + offset) * scale, directions * scale)
    assert check_against_oracle((moved / scale) - offset, origins, directions, hits) > 10


def test_far_rays_lose_no_digits() -> None:
    """A ray from a million radii away, given in float64, meets what a ray from nearby meets."""
    vertices, triangles = soup(100 if _jit.MODE == "compiled" else 20)
    origins, directions = random_rays(min(MANY, 500))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins = origins - 10.0 * directions
    near = RayCaster(vertices, triangles).intersect(origins, directions)
    far = RayCaster(vertices, triangles).intersect(origins - 1e6 * directions, directions)
    assert (near.triangle == far.triangle).mean() > 0.99
    both = near.hit & (near.triangle == far.triangle)
    np.testing.assert_allclose(far.t[both], near.t[both] + 1e6, atol=0.2)


@pytest.mark.parametrize("accelerator", KINDS)
def test_nothing_escapes_from_a_closed_mesh(accelerator: Any) -> None:
    """From inside a sphere of triangles, rays at the very vertices, edges and centres all meet it."""
    vertices, triangles = icosphere(3 if _jit.MODE == "compiled" else 0)
    corners = vertices.astype(np.float32).astype(np.float64)[triangles]
    targets = np.concatenate([
        corners.reshape(-1, 3), corners.mean(axis=1), (corners + np.roll(corners, 1, axis=1)).reshape(-1, 3) / 2.0,
        (0.3 * corners + 0.7 * np.roll(corners, 1, axis=1)).reshape(-1, 3),
    ])  # fmt: skip
    caster = RayCaster(vertices, triangles, accelerator=accelerator)
    for origin in ((0.0, 0.0, 0.0), (0.25, -0.5, 0.125), (0.7, 0.1, -0.3)):
        directions = targets - np.array(origin)
        hits = caster.intersect(origin, directions)
        assert hits.hit.all()
        np.testing.assert_allclose(hits.t, 1.0, atol=0.08)  # what lies around a vertex is a little nearer than the vertex
        assert caster.occluded(origin, directions).all()


def test_rays_along_the_axes_at_a_grid() -> None:
    """Rays straight down at the vertices and edges of a flat grid, along the planes of its boxes, all meet it."""
    n = 17 if _jit.MODE == "compiled" else 5
    y, x = np.mgrid[0:n, 0:n]
    vertices = np.stack([x.ravel(), np.zeros(n * n), y.ravel()], axis=1)
    corner = (y[:-1, :-1] * n + x[:-1, :-1]).ravel()
    triangles = np.concatenate([np.stack([corner, corner + n, corner + 1], 1), np.stack([corner + 1, corner + n, corner + n + 1], 1)])
    halves = np.mgrid[1 : 2 * n - 2, 1 : 2 * n - 2].reshape(2, -1).T / 2.0
    origins = np.stack([halves[:, 0], np.full(len(halves), 3.0), halves[:, 1]], axis=1)
    hits = RayCaster(vertices, triangles).intersect(origins, (0, -1, 0))
    assert hits.hit.all()
    np.testing.assert_array_equal(hits.t, 3.0)
    assert not RayCaster(vertices, triangles).occluded(origins, (0, 1, 0)).any()
    assert not RayCaster(vertices, triangles).occluded(origins - (0, 3, 0), (1, 0, 0)).any(), "rays within the plane"


def test_barycentrics_and_both_sides() -> None:
    """u and v belong to the second and third vertex, from either side; t is in units of the direction."""
    caster = RayCaster(TRIANGLE, [[0, 1, 2]])
    for direction in ((0, 0, -2), (0, 0, 2)):
        hits = caster.intersect((0.25, 0.5, -direction[2]), direction)
        assert (hits.t.tolist(), hits.triangle.tolist(), hits.u.tolist(), hits.v.tolist()) == ([1.0], [0], [0.25], [0.5])


def test_t_max() -> None:
    """Hits count before t_max only, which may differ from ray to ray."""
    caster = RayCaster(TRIANGLE, [[0, 1, 2]])
    ends = [0.5, 1.0, np.nextafter(np.float32(1.0), np.float32(2.0)), np.inf, -1.0, np.nan, 0.0]
    hits = caster.intersect((0.25, 0.25, 1), (0, 0, -1), t_max=ends)
    assert hits.hit.tolist() == [False, False, True, True, False, False, False]
    assert caster.occluded((0.25, 0.25, 1), (0, 0, -1), t_max=ends).tolist() == hits.hit.tolist()
    assert caster.occluded((0.25, 0.25, 1000), [(0, 0, -1)], t_max=[999.0, 1001.0]).tolist() == [False, True]
    assert not caster.intersect((0.25, 0.25, 0), (0, 0, -1)).hit.any(), "where it begins, a ray meets nothing"


@pytest.mark.parametrize("bad", [0.0, -0.0, np.nan, np.inf, -np.inf, 1e200, 1e-320])
def test_rays_that_are_none(bad: float) -> None:
    """Zero, infinite and absurd numbers are misses, or hits as they stand; they never hang and never spoil their neighbours."""
    vertices, triangles = icosphere(1)
    caster = RayCaster(vertices, triangles)
    directions = np.array([[1.0, 0.2, 0.3], [bad, bad, bad], [bad, 0.0, 0.0], [1.0, bad, 0.0], [0.3, -1.0, 0.2]])
    hits = caster.intersect((0, 0, 0), directions)
    assert hits.hit[[0, 4]].all()
    usable = np.isfinite(directions).all(axis=1) & (directions != 0.0).any(axis=1)
    np.testing.assert_array_equal(hits.hit, usable)
    np.testing.assert_array_equal(caster.occluded((0, 0, 0), directions), usable)
    origins = np.where(directions == 1.0, 0.0, directions)
    expected = np.abs(origins).max(axis=1) < 0.9
    found = caster.intersect(origins, (0.1, 0.2, 1.0)).hit
    np.testing.assert_array_equal(found[expected], True)
    assert not found[~np.isfinite(origins).all(axis=1)].any()


@pytest.mark.parametrize("accelerator", KINDS)
@pytest.mark.parametrize(("vertices", "triangles"), [([], []), (np.zeros((0, 3)), np.zeros((0, 3), int)), (TRIANGLE, [])])
def test_empty_meshes(vertices: Any, triangles: Any, accelerator: Any) -> None:
    """No triangles, no hits; no rays, empty arrays."""
    caster = RayCaster(vertices, triangles, accelerator=accelerator)
    assert not caster.intersect(np.zeros((5, 3)), (0, 0, 1)).hit.any()
    assert caster.occluded(np.zeros((5, 3)), (0, 0, 1)).tolist() == [False] * 5
    assert len(caster.intersect([], [])) == 0
    assert caster.intersect(np.zeros((0, 3)), (0, 0, 1)).t.shape == (0,)


def test_degenerate_and_broken_triangles() -> None:
    """Triangles without area are never hit, those with NaN are left out, and the numbers of the others stay."""
    points = np.array([*TRIANGLE, [np.nan, 0, 0], [np.inf, 0, 0], [0.5, 0.5, 0.0]])
    triangles = [[0, 1, 3], [0, 0, 1], [0, 0, 0], [1, 2, 5], [4, 1, 2], [0, 1, 2], [3, 3, 3]]
    for accelerator in KINDS:
        caster = RayCaster(points, triangles * 5, accelerator=accelerator)
        assert caster.n_triangles == 35
        hits = caster.intersect([[0.2, 0.2, 1], [0.5, 0.5, 1], [0, 0, 1], [0.5, 0, 1], [2, 2, 1]], (0, 0, -1))
        assert (hits.triangle[:4] % 7 == 5).all()
        assert hits.triangle[4] == -1
    assert not RayCaster(points, [[0, 1, 3]]).intersect((0, 0, 1), (0, 0, -1)).hit.any()


@pytest.mark.parametrize("accelerator", ["bvh", "bsp", "linear"])
def test_all_hits_along_rays(accelerator: Any) -> None:
    """Those that an oracle in float64 is sure of, in order; the first is the nearest; nothing is told twice."""
    vertices, triangles = soup(200 if _jit.MODE == "compiled" else 30)
    origins, directions = random_rays(min(MANY, 400) // (1 if _jit.MODE == "compiled" else 4))
    caster = RayCaster(vertices, triangles, accelerator=accelerator)
    every = caster.all_hits(origins, directions)
    t, _, _, margin = brute_force(vertices[triangles], origins, directions)
    found = np.zeros(t.shape, dtype=bool)
    found[every.ray, every.triangle] = True
    assert found.sum() == len(every) == every.starts[-1] == every.counts.sum()
    assert found[(margin > 1e-4) & (t > 1e-4)].all()
    assert (margin[found] > -1e-4).all()
    np.testing.assert_allclose(every.t, t[every.ray, every.triangle], rtol=1e-4, atol=1e-3)
    same_ray = every.ray[1:] == every.ray[:-1]
    assert (np.diff(every.t)[same_ray] >= 0).all()
    assert (np.diff(every.ray) >= 0).all()
    nearest = caster.intersect(origins, directions)
    np.testing.assert_array_equal(every.counts > 0, nearest.hit)
    first = every.starts[:-1][nearest.hit]
    for name in ("t", "triangle", "u", "v"):
        np.testing.assert_array_equal(getattr(every, name)[first], getattr(nearest, name)[nearest.hit])
    part = caster.all_hits(origins, directions, t_max=1.0, threads=3)
    np.testing.assert_array_equal(part.t, every.t[every.t < 1.0])


def test_all_hits_of_little() -> None:
    """No triangles, no rays, rays that are none; a pile of equal triangles in the order of their numbers; the numbers of those left out."""
    caster = RayCaster(TRIANGLE, [[0, 1, 2]] * 5, accelerator="volume_tree")
    assert len(RayCaster([], []).all_hits(np.zeros((5, 3)), (0, 0, 1))) == 0
    assert caster.all_hits([], []).starts.tolist() == [0]
    assert caster.all_hits(np.full((2, 2, 3), np.nan), (0, 0, 0)).counts.tolist() == [0] * 4
    every = caster.all_hits([[0.2, 0.2, 1], [2, 2, 1], [0.3, 0.3, -2]], [[0, 0, -1], [0, 0, -1], [0, 0, 2]])
    assert every.triangle.tolist() == [0, 1, 2, 3, 4] * 2
    assert every.counts.tolist() == [5, 0, 5]
    assert every.t.tolist() == [1.0] * 10
    points = np.array([*TRIANGLE, [np.nan, 0, 0]])
    assert RayCaster(points, [[0, 1, 3], [0, 1, 2]]).all_hits((0.2, 0.2, 1), (0, 0, -1)).triangle.tolist() == [1]


def test_many_equal_triangles() -> None:
    """A pile of the same triangle, which no plane divides, is built and walked all the same."""
    caster = RayCaster(TRIANGLE, [[0, 1, 2]] * (3000 if _jit.MODE == "compiled" else 100))
    assert caster.intersect([[0.2, 0.2, 1], [2, 2, 1]], (0, 0, -1)).hit.tolist() == [True, False]
    for accelerator in ("grid", "bsp", "volume_tree"):
        caster = RayCaster(TRIANGLE, [[0, 1, 2]] * 100, accelerator=accelerator)  # type: ignore[arg-type]
        assert caster.intersect([[0.2, 0.2, 1], [2, 2, 1]], (0, 0, -1)).triangle.tolist() == [0, -1]


@pytest.mark.compiled
def test_threads_change_nothing() -> None:
    """One thread or five, in one piece or in many: the same bits."""
    vertices, triangles = soup(500)
    origins, directions = random_rays(40_000)
    caster = RayCaster(vertices, triangles)
    alone = caster.intersect(origins, directions, threads=1)
    crowd = caster.intersect(origins, directions, threads=5)
    parts = [caster.intersect(origins[k : k + 7001], directions[k : k + 7001]) for k in range(0, 40_000, 7001)]
    for name in ("t", "triangle", "u", "v"):
        np.testing.assert_array_equal(getattr(alone, name), getattr(crowd, name))
        np.testing.assert_array_equal(getattr(alone, name), np.concatenate([getattr(part, name) for part in parts]))
    np.testing.assert_array_equal(caster.occluded(origins, directions, threads=5), alone.hit)


def test_kinds_and_layouts_of_arrays() -> None:
    """Lists, integers, halves, doubles, Fortran order, strided and read-only views: the same answer."""
    vertices = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]])
    expected = RayCaster(vertices.astype(np.float32), np.array([[0, 1, 2]], np.int32)).intersect([[1, 2, 3]], [[0, 0, -1]])
    wide = np.zeros((3, 6))
    wide[:, ::2] = vertices
    frozen = vertices.astype(float)
    frozen.flags.writeable = False
    small, half, fortran = vertices.astype(np.int8), vertices.astype(np.float16), np.asfortranarray(vertices)
    for points in (vertices.tolist(), small, half, fortran, wide[:, ::2], frozen):
        for rows in ([[0, 1, 2]], np.array([[0, 1, 2]], np.uint64), np.asfortranarray(np.array([[0, 1, 2]], np.int16))):
            caster = RayCaster(points, rows)
            hits = caster.intersect(np.array([[1, 2, 3]], np.float16), np.asfortranarray([[0, 0, -1]]))
            assert (hits.t, hits.triangle, hits.u, hits.v) == (expected.t, expected.triangle, expected.u, expected.v)
    assert (expected.t.dtype, expected.triangle.dtype, expected.u.dtype) == (np.float32, np.int32, np.float32)


def test_shapes_of_rays() -> None:
    """One origin for many directions, many for one, a grid of rays; the answer has their shape."""
    caster = RayCaster(TRIANGLE, [[0, 1, 2]])
    assert caster.intersect((0.2, 0.2, 1), [[0, 0, -1], [0, 0, 1]]).triangle.tolist() == [0, -1]
    assert caster.intersect([[0.2, 0.2, 1], [5, 5, 1]], (0, 0, -1)).triangle.tolist() == [0, -1]
    grid = np.full((4, 5, 3), (0.2, 0.2, 1.0))
    hits = caster.intersect(grid, (0, 0, -1), t_max=np.full((4, 5), 2.0))
    assert hits.t.shape == hits.hit.shape == caster.occluded(grid, (0, 0, -1)).shape == (4, 5)
    assert hits.hit.all()


def test_pickles() -> None:
    """A caster that travelled answers the same."""
    vertices, triangles = soup(50)
    origins, directions = random_rays(50)
    caster = RayCaster(vertices, triangles)
    travelled = pickle.loads(pickle.dumps(caster))
    assert repr(travelled) == repr(caster) == "RayCaster(50 triangles)"
    np.testing.assert_array_equal(travelled.intersect(origins, directions).t, caster.intersect(origins, directions).t)


@pytest.mark.parametrize(
    ("vertices", "triangles", "message"),
    [
        (np.zeros((3, 2)), [[0, 1, 2]], r"vertices must have shape \(n, 3\), got \(3, 2\)"),
        (TRIANGLE, [[0, 1, 2, 0]], r"triangles must have shape \(n, 3\), got \(1, 4\)"),
        (TRIANGLE, [[0, 1, 3]], r"triangles must lie in 0\.\.2, got \[0, 1, 3\] at triangle 0"),
        (TRIANGLE, [[0, 1, 2], [0, -1, 2]], r"got \[0, -1, 2\] at triangle 1"),
        (TRIANGLE, [[0.0, 1.0, 2.0]], "triangles must be integers, got float64"),
        ([[0, 0, 0], [1, 0]], [[0, 1, 2]], "vertices must be an array of numbers, got rows of different lengths"),
        ([["a", "b", "c"]], [[0, 0, 0]], "vertices must be real numbers"),
        (TRIANGLE * 1j, [[0, 1, 2]], "vertices must be real numbers, got complex128"),
        (None, [[0, 1, 2]], "vertices must be real numbers, got object"),
    ],
)
def test_meshes_that_are_none(vertices: Any, triangles: Any, message: str) -> None:
    """One line that names the argument, what was expected and what was found."""
    with pytest.raises(SceneError, match=message) as caught:
        RayCaster(vertices, triangles)
    assert "\n" not in str(caught.value)


def test_calls_that_are_none() -> None:
    """Rays that do not fit each other, and threads and accelerators that do not exist."""
    caster = RayCaster(TRIANGLE, [[0, 1, 2]])
    with pytest.raises(SceneError, match=r"origins must have shape \(n, 3\), got \(2, 2\)"):
        caster.intersect(np.zeros((2, 2)), (0, 0, 1))
    with pytest.raises(SceneError, match=r"of the same number, or one; got origins \(2, 3\), directions \(3, 3\), t_max \(\)"):
        caster.intersect(np.zeros((2, 3)), np.ones((3, 3)))
    with pytest.raises(SceneError, match=r"t_max \(4,\)"):
        caster.occluded(np.zeros((2, 3)), (0, 0, 1), t_max=[1.0] * 4)
    with pytest.raises(SceneError, match="directions must be real numbers"):
        caster.intersect((0, 0, 0), ["x", "y", "z"])
    with pytest.raises(SceneError, match="threads must be"):
        caster.intersect((0, 0, 0), (0, 0, 1), threads=0)
    with pytest.raises(UnsupportedError, match="accelerator must be"):
        RayCaster(TRIANGLE, [[0, 1, 2]], accelerator="octree")  # type: ignore[arg-type]


@pytest.mark.parametrize("spread", [1.0, 0.05])
def test_rays_that_go_together_hit_what_they_hit_alone(spread: float) -> None:
    """Neighbours of a picture are traced as one bundle, the same rays in another order singly: not a bit differs.

    Eight of them where they spread, whole blocks where they do not, and those that go both up and down an axis by turns.
    """
    mesh, random = torus(1.0, 0.4, 24, 16), np.random.default_rng(11)
    caster = RayCaster(mesh.positions, mesh.triangles)
    side = np.linspace(-0.6, 0.6, 64 if _jit.MODE == "compiled" else 16)
    x, y = (spread * part.ravel() for part in np.meshgrid(side, side))
    order = random.permutation(len(x))
    for turn in (np.eye(3), np.linalg.qr(random.normal(size=(3, 3)))[0]):
        for distance in (0.2, 2.5):
            directions = np.stack([x + (1.0 - spread) * 0.35, y, -np.ones_like(x)], axis=1) @ turn.T
            origins = np.tile(turn @ (0.05, 0.1, distance), (len(x), 1))
            together, alone = caster.intersect(origins, directions), caster.intersect(origins[order], directions[order])
            for field in ("t", "triangle", "u", "v"):
                np.testing.assert_array_equal(getattr(together, field)[order], getattr(alone, field))
            np.testing.assert_array_equal(caster.occluded(origins, directions), together.triangle >= 0)
            assert spread < 1.0 or 0.1 < (together.triangle >= 0).mean() < 0.999


@pytest.mark.parametrize("accelerator", ["bvh", "linear"])
def test_a_ray_hits_what_it_hits_whoever_goes_with_it(accelerator: Any) -> None:
    """Alone, among seven, one more than a block, in float32 or float64, each with an end of its own or all with one: not a bit differs.

    Among the rays are some that are none, and some from far away, which are brought close first.
    """
    vertices, triangles = soup(60)
    caster = RayCaster(vertices, triangles, accelerator=accelerator)
    origins, directions = (part[:130].astype(np.float32) for part in random_rays(130))
    origins[40], directions[70] = np.nan, 0.0
    origins[60:68] -= np.float32(10.0) * directions[60:68]
    whole = caster.intersect(origins, directions)
    assert 0.1 < whole.hit.mean() < 0.9
    assert whole.hit[60:68].any()
    dark = caster.occluded(origins, directions)
    np.testing.assert_array_equal(dark, whole.hit)
    for size in (1, 7, 65):
        starts = range(0, 130, size)
        parts = [caster.intersect(origins[k : k + size], directions[k : k + size]) for k in starts]
        for field in ("t", "triangle", "u", "v"):
            np.testing.assert_array_equal(np.concatenate([getattr(part, field) for part in parts]), getattr(whole, field))
    double = caster.intersect(origins.astype(np.float64), directions.astype(np.float64), t_max=np.full(130, np.inf))
    for field in ("t", "triangle", "u", "v"):
        np.testing.assert_array_equal(getattr(double, field), getattr(whole, field))
    np.testing.assert_array_equal(caster.occluded(origins.astype(np.float64), directions), dark)


@pytest.mark.parametrize("accelerator", ["bvh", "linear"])
def test_another_pose_is_hit_as_a_new_caster_is(accelerator):
    """Bent, moved far away and made large: t, triangles and weights as if built anew, for rays through the whole."""
    mesh, random = torus(1.0, 0.4, 24, 16), np.random.default_rng(12)
    caster = RayCaster(mesh.positions, mesh.triangles, accelerator=accelerator)
    p = mesh.positions.astype(np.float64)
    bent = np.stack([p[:, 0] + np.sin(2 * p[:, 1]), p[:, 1], p[:, 2] * (1.5 + p[:, 0])], axis=1)
    n = MANY if _jit.MODE == "compiled" else 50
    for pose in (bent, 1e4 * bent + 1e7, p):
        caster.refit(pose)
        fresh = RayCaster(pose, mesh.triangles)
        centre, size = pose.mean(axis=0), np.ptp(pose, axis=0).max()
        origins, targets = (centre + size * scale * random.normal(size=(n, 3)) for scale in (2.0, 0.2))
        moved, expected = caster.intersect(origins, targets - origins), fresh.intersect(origins, targets - origins)
        np.testing.assert_array_equal(moved.triangle, expected.triangle)
        np.testing.assert_allclose(moved.t, expected.t, rtol=1e-6)
        assert 0.1 < expected.hit.mean() < 0.95
    assert len(caster.all_hits(origins, targets - origins)) == len(fresh.all_hits(origins, targets - origins))


def test_poses_that_do_not_fit_are_refused():
    """Another number of vertices, a corner that is no number, a structure that cannot change."""
    vertices, triangles = np.eye(3), [[0, 1, 2]]
    caster = RayCaster(vertices, triangles)
    with pytest.raises(SceneError, match=r"vertices must have shape \(3, 3\), as before, got \(4, 3\)"):
        caster.refit(np.zeros((4, 3)))
    with pytest.raises(SceneError, match=r"vertices must be finite, .* at triangle 0"):
        caster.refit(vertices * np.nan)
    with pytest.raises(UnsupportedError, match="make a new one"):
        RayCaster(vertices, triangles, accelerator="grid").refit(vertices)
