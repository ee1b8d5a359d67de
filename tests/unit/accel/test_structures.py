"""What a grid, a BSP and a plain tree of boxes are: where they list triangles, and what a walk through them looks at."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from limner import _jit
from limner.accel.bsp import Bsp, build_bsp
from limner.accel.grid import build_grid
from limner.accel.volume_tree import build_volume_tree
from limner.raycaster import RayCaster

N = 300 if _jit.MODE == "compiled" else 40
Corners = NDArray[np.float32]


def soup(n: int, size: float = 0.3, seed: int = 0) -> Corners:
    """Random triangles, (n, 9)."""
    random = np.random.default_rng(seed)
    return (random.uniform(-1.0, 1.0, (n, 1, 3)) + random.uniform(-size, size, (n, 3, 3))).reshape(n, 9).astype(np.float32)


def points_on(corners: Corners, n: int, seed: int = 1) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Which triangle, and where on it: corners and points of edges among the points."""
    random = np.random.default_rng(seed)
    which = random.integers(len(corners), size=n)
    weights = random.dirichlet((0.4, 0.4, 0.4), size=n)
    weights[::3] = np.eye(3)[random.integers(3, size=len(weights[::3]))]
    return which, np.einsum("nk,nkc->nc", weights, corners[which].reshape(-1, 3, 3).astype(np.float64))


def caster_of(corners: Corners, kind: Any) -> RayCaster:
    return RayCaster(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), accelerator=kind)


def test_a_grid_lists_a_triangle_wherever_a_point_of_it_lies() -> None:
    """In the cell of every point of a triangle that triangle is listed, in each once; and in fewer cells than its box is in."""
    corners = soup(N, 0.5)
    grid = build_grid(corners)
    which, points = points_on(corners, 2000)
    low, high = grid.bounds
    x, y, z = np.clip((points - low) / (high - low) * grid.resolution, 0, grid.resolution - 1).astype(int).T
    cells = (z * grid.resolution[1] + y) * grid.resolution[0] + x
    for triangle, cell in zip(which, cells, strict=True):
        listed = grid.items[grid.starts[cell] : grid.starts[cell + 1]].tolist()
        assert listed.count(triangle) == 1
    assert grid.starts[0] == 0
    assert grid.starts[-1] == len(grid.items)
    spans = (np.ptp(corners.reshape(-1, 3, 3), axis=1) / (high - low) * grid.resolution + 1).prod(axis=1)
    assert len(grid.items) < 0.8 * spans.sum()


def leaves_of(bsp: Bsp) -> list[tuple[NDArray[np.float64], set[int]]]:
    """The space (2, 3) of each leaf, and what it lists."""
    found, waiting = [], [(0, bsp.bounds.copy())]
    while waiting:
        n, room = waiting.pop()
        node = bsp.nodes[n]
        if node["axis"] < 0:
            found.append((room, set(bsp.items[node["first"] : node["first"] + node["count"]].tolist())))
            continue
        below, above = room.copy(), room.copy()
        below[1, node["axis"]] = above[0, node["axis"]] = node["plane"]
        waiting += [(int(node["first"]), below), (int(node["first"]) + 1, above)]
    return found


def test_the_leaves_of_a_bsp_share_out_space() -> None:
    """Their volumes add up to that of everything, and the leaf in which a point of a triangle lies lists it."""
    corners = soup(N)
    leaves = leaves_of(build_bsp(corners))
    assert len(leaves) > N // 2
    rooms = np.array([room for room, _ in leaves])
    whole = build_bsp(corners).bounds
    assert np.prod(rooms[:, 1] - rooms[:, 0], axis=1).sum() == pytest.approx(np.prod(whole[1] - whole[0]), rel=1e-5)
    which, points = points_on(corners, 500)
    for triangle, point in zip(which, points, strict=True):
        inside = np.flatnonzero(((rooms[:, 0] <= point) & (point <= rooms[:, 1])).all(axis=1))
        assert len(inside)
        assert all(int(triangle) in leaves[k][1] for k in inside)


def test_a_bsp_cuts_off_what_is_empty() -> None:
    """Two heaps far from each other: a ray between them meets no triangle at all."""
    corners = np.concatenate([soup(N // 2, 0.1), soup(N // 2, 0.1) + np.float32(20.0)])
    seen = caster_of(corners, "bsp").visits((10, 10, 0), [[0, 0, 1], [0.1, 0.2, 1]])
    assert seen.triangles.max() == 0
    assert seen.nodes.max() < 12


def test_the_volume_tree_takes_the_axis_of_least_volumes() -> None:
    """At every node: halves of equal size, in the order of their middles along the axis whose boxes have the least volumes; boxes hold."""
    corners = soup(N, 0.2) * np.tile([1.0, 2.0, 0.5], 3).astype(np.float32)
    tree = build_volume_tree(corners)
    assert sorted(tree.items.tolist()) == list(range(N))
    points = corners.reshape(-1, 3, 3).astype(np.float64)
    low, high = points.min(axis=1), points.max(axis=1)

    def volume(rows: NDArray[Any]) -> float:
        return float(np.prod(high[rows].max(axis=0) - low[rows].min(axis=0)))

    def check(n: int) -> NDArray[Any]:
        node = tree.nodes[n]
        if node["count"] > 0:
            rows = tree.items[node["first"] : node["first"] + node["count"]]
        else:
            halves = check(int(node["first"])), check(int(node["first"]) + 1)
            assert 0 <= len(halves[1]) - len(halves[0]) <= 1
            rows = np.concatenate(halves)
            taken = sum(map(volume, halves))
            for axis in range(3):
                order = rows[np.argsort((low + high)[rows, axis])]
                assert taken <= 1.001 * (volume(order[: len(halves[0])]) + volume(order[len(halves[0]) :]))
        assert (node["box"][:3] <= low[rows].min(axis=0)).all()
        assert (node["box"][3:] >= high[rows].max(axis=0)).all()
        return rows

    assert len(check(0)) == N


def test_partitioning_makes_the_tree_that_sorting_makes() -> None:
    """Box by box, where many middles coincide too."""
    corners = np.concatenate([soup(N, 0.2), np.tile(soup(1), (N // 3, 1)), np.round(soup(N, 0.2) * 2)])
    one, other = build_volume_tree(corners, "partition"), build_volume_tree(corners, "sort")
    np.testing.assert_array_equal(one.nodes, other.nodes)
    for node in one.nodes[one.nodes["count"] > 0]:
        leaf = slice(node["first"], node["first"] + node["count"])
        assert set(one.items[leaf]) == set(other.items[leaf])


def test_a_ray_through_an_empty_row_of_cells_visits_each_once() -> None:
    """Along an axis, through a plane with a hole: as many cells as there are, in either direction; a little aslant, a few more."""
    n = 12
    y, z = (part.ravel() for part in np.meshgrid(np.arange(n), np.arange(n)))
    base = np.stack([np.zeros(n * n), y, z], axis=1)
    corners = np.concatenate([base, base + np.array([0, 0.4, 0]), base + np.array([0, 0, 0.4])], axis=1)
    ends = np.array([[-5.0, 0, 0, -5.0, 0.1, 0, -5.0, 0, 0.1], [5.0, 0, 0, 5.0, 0.1, 0, 5.0, 0, 0.1]])
    both = np.concatenate([corners, ends]).astype(np.float32)
    caster = caster_of(both, "grid")
    nx = build_grid(both).resolution[0]
    seen = caster.visits([[-9, 6.7, 6.7], [9, 6.7, 6.7], [0, 30, 0]], [[2, 0, 0], [-1, 0, 0], [1, 0, 0]])
    assert seen.nodes.tolist() == [nx, nx, 0]
    aslant = caster.visits((-9, 6.7, 6.7), (1, 0.01, -0.02))
    assert nx <= aslant.nodes[0] <= nx + 4


@pytest.mark.parametrize("kind", ["bvh", "grid", "bsp", "volume_tree"])
def test_a_walk_ends_at_the_first_hit(kind: Any) -> None:
    """Of a hundred sheets, one behind the other, a ray meets the first few only; and any hit costs no more than the nearest."""
    x = np.arange(100.0)[:, None, None]
    sheet = np.array([[0.0, -1, -1], [0.0, 2, -1], [0.0, -1, 2]])
    caster = caster_of((sheet + x * np.array([1.0, 0, 0])).reshape(-1, 9).astype(np.float32), kind)
    for origin, direction in (((-3, 0.1, 0.2), (1, 0, 0)), ((102, 0.1, 0.2), (-1, 0.001, 0.002))):
        nearest, anything = (caster.visits(origin, direction, any_hit=any_hit) for any_hit in (False, True))
        assert 1 <= nearest.triangles[0] <= 8
        assert anything.triangles[0] <= nearest.triangles[0]
        assert anything.nodes[0] <= nearest.nodes[0]
        nothing = caster.visits(origin, direction, t_max=1e-3)
        assert nothing.triangles[0] == 0


def test_who_tries_all_visits_all_and_rays_that_are_none_nothing() -> None:
    """The list meets every triangle and no box, and so does a tree that is too small to be one; a NaN meets nothing."""
    for kind, n in (("linear", 20), ("bvh", 5)):
        seen = caster_of(soup(n), kind).visits((0, 0, 0), (0, 0, 1))
        assert (seen.nodes[0], seen.triangles[0]) == (0, n)
    for kind in ("bsp", "bvh", "linear"):
        seen = caster_of(soup(20), kind).visits(np.full((2, 3, 3), np.nan), (0, 0, 1))
        assert seen.nodes.shape == seen.triangles.shape == (2, 3)
        assert seen.nodes.sum() == seen.triangles.sum() == 0


@pytest.mark.compiled
def test_the_cost_grows_slowly() -> None:
    """Sixteen times as many triangles of a sixteenth of the area: less than three times as much is looked at."""
    random = np.random.default_rng(0)
    origins, directions = random.uniform(-2, 2, (500, 3)), random.normal(size=(500, 3))
    for kind in ("bvh", "bsp", "volume_tree", "grid"):
        few, many = (caster_of(soup(n, 0.8 / n**0.5), kind).visits(origins, directions) for n in (500, 8000))
        assert many.nodes.sum() + many.triangles.sum() < 3 * (few.nodes.sum() + few.triangles.sum())


@pytest.mark.compiled
@pytest.mark.parametrize("kind", ["grid", "bsp", "volume_tree"])
def test_threads_change_nothing(kind: Any) -> None:
    """One thread or five: the same hits, the same visits, the same of all along a ray."""
    random = np.random.default_rng(0)
    origins, directions = random.uniform(-2, 2, (9000, 3)).astype(np.float32), np.asfortranarray(random.normal(size=(9000, 3)))
    caster = caster_of(soup(N), kind)
    for ask, names in (
        (caster.intersect, ("t", "triangle", "u", "v")),
        (caster.visits, ("nodes", "triangles")),
        (caster.all_hits, ("ray", "t", "triangle", "starts")),
    ):
        alone, crowd = (ask(origins, directions, threads=threads) for threads in (1, 5))
        for name in names:
            np.testing.assert_array_equal(getattr(alone, name), getattr(crowd, name))
