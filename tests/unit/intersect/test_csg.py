"""Constructive solid geometry by ray intervals (FoCG 13.3) against Boolean algebra point by point, and against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from shapes import NOTHING, along, at, csg_hits, csg_inside, hits, oracle, points, row, stack

from limner._jit import MODE
from limner.errors import SceneError
from limner.intersect.csg_program import check_program, program_bounds
from limner.intersect.layouts import (
    BOX,
    COMPLEMENT,
    CONE,
    CYLINDER,
    DIFFERENCE,
    DISK,
    INTERSECTION,
    MAX_LEAVES,
    PLANE,
    SPHERE,
    TORUS,
    UNION,
)
from limner.linear.transform import in_order, rotate, scale, translate

N = 400 if MODE == "compiled" else 40
INF = np.inf
Numbers = NDArray[np.float64]
Solid = tuple[NDArray[np.void], NDArray[np.int32]]


def _solid(program: list[int], *leaves: NDArray[np.void]) -> Solid:
    return stack(*leaves), check_program(program, len(leaves))


def _moved(x: float, y: float = 0.0, z: float = 0.0) -> Numbers:
    return translate(x, y, z)


def _pose(random: np.random.Generator, spread: float = 0.6) -> Numbers:
    """Turned and moved, scaled unevenly."""
    turned = rotate(random.normal(size=3), random.uniform(0, 6))
    return in_order(scale(*random.uniform(0.5, 1.3, 3)), turned, translate(*random.normal(size=3) * spread))


def _leaves(random: np.random.Generator, n: int, size_of_all: float = 1.0) -> NDArray[np.void]:
    kinds = [(SPHERE, (0.9,)), (BOX, (0.7, 0.5, 0.8)), (CYLINDER, (0.5, 1.8)), (CONE, (0.8, 0.1, 1.6)), (TORUS, (0.7, 0.3)), (PLANE, ())]
    picked = [kinds[k] for k in random.integers(0, len(kinds), n)]
    return stack(*(row(kind, size, world_from_object=scale(size_of_all) @ _pose(random)) for kind, size in picked))


def _random_program(random: np.random.Generator, n: int) -> NDArray[np.int32]:
    """A program that names each of n leaves once, and some twice, with all four operations."""
    waiting = [[int(k)] for k in random.permutation(n)] + [[int(k)] for k in random.integers(0, n, n // 2)]
    while len(waiting) > 1:
        a, b = waiting.pop(random.integers(len(waiting))), waiting.pop(random.integers(len(waiting)))
        waiting.append(a + b + [int(random.choice([UNION, INTERSECTION, DIFFERENCE]))])
        if random.random() < 0.2:
            waiting[-1] = waiting[-1] + [COMPLEMENT]
    return check_program(waiting[0], n)


def _membership(solid: Solid, p: Numbers) -> tuple[NDArray[np.bool_], Numbers]:
    """Whether points are in the solid, by Boolean algebra on oracles in float64, and how far the nearest surface of a leaf is."""
    leaves, program = solid
    inside, distance = [], np.full(p.shape[:-1], INF)
    for leaf in leaves:
        m = leaf["object_from_world"].astype(np.float64)
        g = oracle(leaf, p @ m[:, :3].T + m[:, 3])
        inside.append(g < 0)
        distance = np.minimum(distance, np.abs(g))
    sets: list[NDArray[np.bool_]] = []
    for token in program.tolist():
        if token >= 0:
            sets.append(inside[token])
        elif token == COMPLEMENT:
            sets.append(~sets.pop())
        else:
            b, a = sets.pop(), sets.pop()
            sets.append(a | b if token == UNION else a & b if token == INTERSECTION else a & ~b)
    return sets.pop(), distance


def _crossings(solid: Solid, rays: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(n, m) float32 each: all hits of each ray, one after the other, infinity from the last on, and their facings."""
    rays = rays.copy()
    all_t, all_facing = [], []
    while not all_t or np.isfinite(all_t[-1]).any():
        t, facing = csg_hits(solid, rays)[0].T
        all_t.append(t.copy())
        all_facing.append(facing.copy())
        rays[:, 6] = t
        assert len(all_t) < 60
    return np.stack(all_t, axis=1), np.stack(all_facing, axis=1)


def _rays(random: np.random.Generator, n: int) -> NDArray[np.float32]:
    o = random.normal(size=(n, 3)) * random.choice([0.5, 3.0], size=(n, 1))
    d = random.normal(size=(n, 3)) * 0.7 - o
    d[::7, 1] = 0.0
    return along(o, d * 10.0 ** random.uniform(-2, 2, size=(n, 1)))


@pytest.mark.parametrize("seed", range(24))
def test_hits_are_where_membership_changes(seed: int) -> None:
    """Random programs over up to eight leaves in random poses: every change along a ray is a hit, every hit a change, alternating.

    In the world a thousandth as large, as large, and a thousand times as large as a leaf in its own space.
    """
    random = np.random.default_rng(seed)
    n, size = 1 + seed % 8, 10.0 ** (3 * (seed % 3 - 1))
    solid = _leaves(random, n, size), _random_program(random, n)
    rays = _rays(random, N // 8)
    rays[:, :3] *= size
    t, facing = _crossings(solid, rays)
    begins = csg_inside(solid, rays[:, :3])
    samples = np.linspace(0, 8 * size, 1500)[None] / np.linalg.norm(rays[:, 3:6], axis=1)[:, None]
    inside, distance = _membership(solid, at(rays, samples))
    crossed = (t[:, None, :] < samples[:, :, None]).sum(axis=2)
    sure = distance > 1e-4
    np.testing.assert_array_equal((begins[:, None] ^ (crossed % 2 == 1))[sure], inside[sure])
    entering = np.where(np.arange(t.shape[1]) % 2 == begins[:, None], 1.0, -1.0)
    np.testing.assert_array_equal(facing, np.where(np.isfinite(t), entering, 0.0))


@pytest.mark.parametrize("seed", range(8))
def test_the_leaf_that_is_hit_has_the_normal(seed: int) -> None:
    """The hit lies on the leaf's surface; with its sign turned where flipped, the leaf's normal points out of the whole."""
    random = np.random.default_rng(100 + seed)
    solid = _leaves(random, 4), _random_program(random, 4)
    rays = _rays(random, N)
    (t, facing), (leaf, part, flipped) = csg_hits(solid, rays)[0].T, csg_hits(solid, rays)[1].T
    met = np.isfinite(t)
    np.testing.assert_array_equal(leaf[~met], -1)
    for k in range(4):
        mine = met & (leaf == k)
        if not mine.any():
            continue
        found = np.zeros((int(mine.sum()), 4), np.float32)
        found[:, 0] = t[mine]
        n = points(solid[0][k : k + 1], rays[mine], found, part[mine])["n"]
        m = solid[0][k]["object_from_world"].astype(np.float64)
        p = at(rays[mine], t[mine][:, None])[:, 0] @ m[:, :3].T + m[:, 3]
        # t has the rounding of float32, and the ray may come from far away
        assert (np.abs(oracle(solid[0][k], p)) < 1e-5).all()
        d = rays[mine, 3:6] @ m[:, :3].T
        outwards = (n * d).sum(1) * np.where(flipped[mine] == 1, -1, 1)
        clear = np.abs(outwards) > 1e-3 * np.linalg.norm(d, axis=1)
        np.testing.assert_array_equal(np.sign(-outwards)[clear], facing[mine][clear])


def test_one_leaf_alone_is_the_shape_itself() -> None:
    """The same t, part and facing as without a program; its complement is hit in the same places from the other side."""
    random = np.random.default_rng(6)
    for kind, size in ((SPHERE, (0.9,)), (TORUS, (0.8, 0.3)), (BOX, (0.5, 0.6, 0.7)), (CONE, (0.7, 0.0, 1.5))):
        shape = row(kind, size, world_from_object=_pose(random))
        rays = _rays(random, N)
        for both_sides in (True, False):
            rays[:, 8] = both_sides
            found, part = hits(shape, rays)
            numbers, rows = csg_hits(_solid([0], shape), rays)
            np.testing.assert_array_equal(numbers, found[:, [0, 3]])
            np.testing.assert_array_equal(rows[:, 1], part)
            np.testing.assert_array_equal(rows[:, 2], 0)
        rays[:, 8] = True
        numbers, rows = csg_hits(_solid([0, COMPLEMENT], shape), rays)
        found, part = hits(shape, rays)
        np.testing.assert_array_equal(numbers, found[:, [0, 3]] * [1, -1])
        np.testing.assert_array_equal(rows[:, 2], np.where(np.isfinite(found[:, 0]), 1, 0))


@pytest.mark.parametrize("seed", range(4))
def test_the_laws_of_de_morgan_and_others_hold_to_the_bit(seed: int) -> None:
    """Different programs for the same set give the same hits: distance, leaf, part and side."""
    random = np.random.default_rng(200 + seed)
    leaves = _leaves(random, 3)
    rays = _rays(random, N)
    same = [
        ([0, 1, UNION, COMPLEMENT], [0, COMPLEMENT, 1, COMPLEMENT, INTERSECTION]),
        ([0, 1, INTERSECTION, COMPLEMENT], [0, COMPLEMENT, 1, COMPLEMENT, UNION]),
        ([0, 1, DIFFERENCE], [0, 1, COMPLEMENT, INTERSECTION]),
        ([0, 1, DIFFERENCE, 2, DIFFERENCE], [0, 1, 2, UNION, DIFFERENCE]),
        ([0, 1, 2, UNION, INTERSECTION], [0, 1, INTERSECTION, 0, 2, INTERSECTION, UNION]),
        ([0, 1, UNION, 2, UNION], [2, 1, UNION, 0, UNION]),
        ([0], [0, COMPLEMENT, COMPLEMENT]),
        ([0], [0, 1, UNION, 0, INTERSECTION]),
    ]
    for left, right in same:
        one, other = (csg_hits((leaves, check_program(program, 3)), rays) for program in (left, right))
        np.testing.assert_array_equal(one[0], other[0])
        np.testing.assert_array_equal(one[1], other[1])
    for nothing in ([0, 0, DIFFERENCE], [0, 0, COMPLEMENT, INTERSECTION], [0, 0, COMPLEMENT, UNION]):
        assert np.isinf(csg_hits((leaves, check_program(nothing, 3)), rays)[0][:, 0]).all()


@pytest.mark.parametrize("radius", [1.0, 2.0, 7.0])
def test_a_napkin_ring_has_the_volume_of_a_ball_as_high(radius: float) -> None:
    """A ball with a round hole drilled through: pi h^3 / 6, whatever its radius. Volume by the lengths of the ray within."""
    height = 1.5
    hole = np.sqrt(radius**2 - height**2 / 4)
    ring = _solid([0, 1, DIFFERENCE], row(SPHERE, (radius,)), row(CYLINDER, (hole, 4 * radius)))
    # Upright lines, evenly over the annulus that holds it, by area: within, the length is known to be smooth
    n = 100 * N
    rho = np.sqrt(hole**2 + (radius**2 - hole**2) * (np.arange(n) + 0.5) / n)
    turn = np.arange(n) * 2.399963
    rays = along(np.stack([rho * np.cos(turn), np.full(n, -2 * radius), rho * np.sin(turn)], axis=1), (0.0, 1.0, 0.0))
    t, _ = _crossings(ring, rays)
    lengths = np.where(np.isfinite(t[:, 1]), t[:, 1].astype(np.float64) - np.where(np.isfinite(t[:, 0]), t[:, 0], 0.0), 0.0)
    assert lengths.mean() * np.pi * (radius**2 - hole**2) == pytest.approx(np.pi * height**3 / 6, rel=2e-3)
    # Seen from the side, too: past the hole's axis, in and out of the wall twice
    across = along((-3 * radius, 0.1, 0.0), (1.0, 0.0, 0.0))
    t, facing = _crossings(ring, across)
    outer = np.sqrt(radius**2 - 0.01)
    np.testing.assert_allclose(t[0, :4], [3 * radius - outer, 3 * radius - hole, 3 * radius + hole, 3 * radius + outer], rtol=1e-6)
    np.testing.assert_array_equal(facing[0, :4], [1, -1, 1, -1])


def test_a_hole_shows_the_drill_inside_out() -> None:
    """Difference: behind the face of A lies B's wall, flipped, and B's part is told."""
    block = _solid([0, 1, DIFFERENCE], row(BOX, (1, 1, 1)), row(CYLINDER, (0.5, 3.0)))
    numbers, rows = csg_hits(block, along((0.1, 5, 0), [(0.2, -1, 0), (0.08, -1, 0)]))
    # x = 0.1 + 0.2 t reaches 0.5 at t = 2, above the block: the top face at t = 4 is met at x = 0.9
    np.testing.assert_array_equal([*numbers[0], *rows[0]], [4.0, 1.0, 0, 2, 0])
    np.testing.assert_allclose([*numbers[1], *rows[1]], [5.0, 1.0, 1, 0, 1], rtol=1e-6)


def test_rays_that_begin_inside() -> None:
    """In the solid: the way out, seen from behind, or nothing where only fronts count; in the hole: the wall."""
    block = _solid([0, 1, DIFFERENCE], row(BOX, (1, 1, 1)), row(SPHERE, (0.5,)))
    t, facing = csg_hits(block, along((0.75, 0, 0), (1, 0, 0)))[0][0]
    assert (t, facing) == (0.25, -1.0)
    assert np.isinf(csg_hits(block, along((0.75, 0, 0), (1, 0, 0), both_sides=False))[0][0, 0])
    t, facing = csg_hits(block, along((0, 0, 0), (0, 2, 0)))[0][0]
    assert (t, facing) == (0.25, 1.0)
    np.testing.assert_array_equal(csg_inside(block, [(0.75, 0, 0), (0, 0, 0), (2, 0, 0)]), [True, False, False])
    # Limits, excluded, at an end itself
    t, facing = csg_hits(block, along((-3, 0, 0), (1, 0, 0), t_min=2.0))[0][0]
    assert (t, facing) == (2.5, -1.0)
    assert np.isinf(csg_hits(block, along((-3, 0, 0), (1, 0, 0), t_max=2.0))[0][0, 0])


@pytest.mark.parametrize("distance", [3.0, 100.0, 1e4])
def test_surfaces_that_coincide_leave_no_film_and_no_wall(distance: float) -> None:
    """Under any turn, seen from near and far: what is cut off flush is gone, and two blocks side by side are one.

    Rounding puts the two faces a little apart, here in front, there behind; without care, a third of the rays would hit the film.
    """
    random = np.random.default_rng(17)
    for _ in range(10):
        turn = in_order(rotate(random.normal(size=3), random.uniform(0, 6)), translate(*random.normal(size=3) * 2))
        big = row(BOX, (1, 1, 1), world_from_object=turn)
        cut = row(BOX, (1, 0.3, 1), world_from_object=turn @ _moved(0, 0.7))  # its top and walls are the big one's
        target = random.uniform(-0.9, 0.9, size=(N // 4, 3)) * [1, 0, 1] + [0, 1.0, 0]
        way = random.normal(size=target.shape)
        way[:, 1] = -np.abs(way[:, 1]) - random.choice([0.5, 0.05], size=N // 4)
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        to_world = lambda p, w=1.0, turn=turn: p @ turn[:3, :3].T + turn[:3, 3] * w  # noqa: E731
        rays = along(to_world(target - distance * way), to_world(way, 0.0))
        t, _ = csg_hits(_solid([0, 1, DIFFERENCE], big, cut), rays)[0].T
        p = at(rays, np.where(np.isfinite(t), t, 0.0)[:, None])[:, 0]
        y = ((p - turn[:3, 3]) @ turn[:3, :3])[:, 1]
        # The top is gone: what is met is the new top at 0.4 or a wall below it
        assert (y[np.isfinite(t)] < 0.4 + 1e-6 * distance + 1e-5).all()
        # Side by side: from the middle of the one, nothing until the far side of the other
        left, right = row(BOX, (1, 1, 1), world_from_object=turn), row(BOX, (0.5, 1, 1), world_from_object=turn @ _moved(1.5))
        start = random.uniform(-0.5, 0.5, size=(N // 4, 3))
        end = np.stack([np.full(N // 4, 2.0), *random.uniform(-0.5, 0.5, size=(2, N // 4))], axis=1)
        through = along(to_world(start - distance * (end - start)), to_world(end - start, 0.0), t_min=distance)
        t, _ = csg_hits(_solid([0, 1, UNION], left, right), through)[0].T
        np.testing.assert_allclose(t, distance + 1, rtol=2e-6)


@pytest.mark.parametrize(
    ("kind", "size", "half"), [(SPHERE, (1.0,), (0.5,)), (CYLINDER, (0.7, 1.6), (0.35, 0.8)), (TORUS, (0.7, 0.3), (0.35, 0.15))]
)
def test_a_curved_solid_less_itself_is_nothing(kind: int, size: tuple[float, ...], half: tuple[float, ...]) -> None:
    """Of half the size and scaled by two, so that the numbers differ: no shell; a ray in a thousand may graze too flat."""
    random = np.random.default_rng(23)
    for _ in range(10):
        turn = in_order(rotate(random.normal(size=3), random.uniform(0, 6)), translate(*random.normal(size=3) * 3))
        one, two = row(kind, size, world_from_object=turn), row(kind, half, world_from_object=turn @ scale(2.0))
        rays = along(random.normal(size=(N, 3)) * 0.6 @ turn[:3, :3].T + turn[:3, 3], random.normal(size=(N, 3)))
        rays[:, :3] -= 20 * rays[:, 3:6]
        rays = rays[np.isfinite(hits(one, rays)[0][:, 0])]
        assert len(rays) > N // 4
        t, _ = csg_hits(_solid([0, 1, DIFFERENCE], one, two), rays)[0].T
        assert np.isfinite(t).mean() < 1e-3


def test_coincident_surfaces_belong_to_the_first_leaf_that_matters() -> None:
    """Exactly equal ends: the union's face is the first leaf's; swapping the leaves swaps the owner."""
    box, far = row(BOX, (1, 1, 1)), row(BOX, (1, 1, 1), world_from_object=_moved(0.5))
    ray = along((0.75, 5, 0), (0, -1, 0))  # through the tops of both
    assert csg_hits(_solid([0, 1, UNION], box, far), ray)[1][0, 0] == 0
    assert csg_hits(_solid([1, 0, UNION], box, far), ray)[1][0, 0] == 0
    np.testing.assert_array_equal(csg_hits(_solid([0, 1, INTERSECTION], box, far), ray)[0][0], [4, 1])
    left = along((0.0, 5, 0), (0, -1, 0))
    assert np.isinf(csg_hits(_solid([0, 0, DIFFERENCE], box), left)[0][0, 0])
    # A thin plate is not swallowed: the two ends of one leaf are never one place
    plate = _solid([0], row(BOX, (1, 1e-7, 1)))
    assert csg_hits(plate, along((0, 50, 0), (0, -1, 0)))[0][0, 0] == 50.0


def test_half_spaces_cut_and_have_no_end() -> None:
    """Half a ball; and a half space alone, in which a ray may begin and which it never leaves."""
    half_ball = _solid([0, 1, INTERSECTION], row(SPHERE, (1.0,)), row(PLANE))
    assert csg_hits(half_ball, along((0.2, 5, 0), (0, -1, 0)))[0][0, 0] == 5.0
    t, facing = csg_hits(half_ball, along((0, -0.5, 0), (0, -1, 0)))[0][0]
    assert (t, facing) == (0.5, -1.0)
    ground = _solid([0], row(PLANE))
    assert np.isinf(csg_hits(ground, along((0, -1, 0), (1, -1, 0)))[0][0, 0])
    np.testing.assert_array_equal(csg_hits(ground, along((0, -1, 0), (1, 1, 0)))[0][0], [1, -1])


def test_what_is_no_ray_misses() -> None:
    """NaN, infinity and a direction of zero, of the complement as well; a disk has no inside."""
    for program in ([0], [0, COMPLEMENT]):
        solid = _solid(program, row(SPHERE, (1.0,)))
        for o, d in (((np.nan, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 0, 0)), ((0, 0, 0), (1, np.nan, 0)), ((INF, 0, 0), (-1, 0, 0))):
            assert np.isinf(csg_hits(solid, along(o, d))[0][0, 0])
    assert np.isinf(csg_hits(_solid([0], row(DISK, (1.0,))), along((0, 1, 0), (0, -1, 0)))[0][0, 0])


def test_as_many_leaves_as_there_may_be() -> None:
    """A row of 62 balls, joined: 124 hits; the last of them, alone, as the difference of all others."""
    balls = stack(*(row(SPHERE, (0.25,), world_from_object=_moved(float(k))) for k in range(MAX_LEAVES)))
    union = [0] + [token for k in range(1, MAX_LEAVES) for token in (k, UNION)]
    ray = along((-1, 0, 0), (1, 0, 0))
    solid = balls, check_program(union, MAX_LEAVES)
    place, expected = 0.0, [k + 1 + side for k in range(MAX_LEAVES) for side in (-0.25, 0.25)]
    found = []
    while np.isfinite(place):
        place = float(csg_hits(solid, along((-1, 0, 0), (1, 0, 0), t_min=place))[0][0, 0])
        found.append(place)
    np.testing.assert_array_equal(found[:-1], expected)
    # All wait before the first operation
    deep = list(range(MAX_LEAVES)) + [UNION] * (MAX_LEAVES - 2) + [DIFFERENCE]
    assert csg_hits((balls, check_program(deep, MAX_LEAVES)), ray)[0][0, 0] == 0.75


@pytest.mark.parametrize(
    ("program", "n_leaves", "message"),
    [
        ([], 1, "list of integers"),
        ([0.5], 1, "list of integers"),
        ([1], 1, "leaf or operation 1 at 0"),
        ([-5], 1, "leaf or operation -5 at 0"),
        ([0, UNION], 1, "too little before its union at 1: 1 of 2"),
        ([COMPLEMENT], 1, "too little before its complement at 0: 0 of 1"),
        ([0, 0], 1, "must leave one set, it leaves 2"),
        ([0], 63, "at most 62 primitives, got 63"),
        ([0] * 63 + [UNION] * 62, 1, "more than 62 sets waiting at 62"),
    ],
)
def test_unsound_programs_are_refused_in_words(program: list[int], n_leaves: int, message: str) -> None:
    """What is wrong, and where."""
    with pytest.raises(SceneError, match=message):
        check_program(program, n_leaves)


@pytest.mark.parametrize("seed", range(6))
def test_bounds_of_programs_hold_what_they_make(seed: int) -> None:
    """No point inside lies outside the box of the whole, made of the leaves' boxes."""
    random = np.random.default_rng(300 + seed)
    leaves = stack(*(row(BOX, tuple(random.uniform(0.2, 1, 3)), world_from_object=_moved(*random.normal(size=3))) for _ in range(4)))
    program = _random_program(random, 4)
    centers = leaves["world_from_object"][:, :, 3].astype(np.float64)
    boxes = np.concatenate([centers - leaves["size"], centers + leaves["size"]], axis=1)
    box = program_bounds(program, boxes)
    p = random.uniform(-3, 3, size=(20 * N, 3))
    inside, _ = _membership((leaves, program), p)
    assert ((p >= box[:3]) & (p <= box[3:])).all(axis=1)[inside].all()
    assert np.isinf(program_bounds([0, COMPLEMENT], boxes)).all()
    apart = program_bounds([0, 1, INTERSECTION, 0, UNION], [[0, 0, 0, 1, 1, 1], [2, 2, 2, 3, 3, 3]])
    np.testing.assert_array_equal(apart, [0, 0, 0, 1, 1, 1])


def test_numbers_may_be_absent() -> None:
    """A solid without quadrics refers to none."""
    assert csg_hits(_solid([0], row(SPHERE, (1.0,))), along((0, 0, 3), (0, 0, -1)), NOTHING[:0])[0][0, 0] == 2.0
