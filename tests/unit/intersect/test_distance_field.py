"""Rays and fields of distances (FoCG 22): the field as kernels run it, and its surface against exact shapes and solids."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest
from compiled import door_of
from fields import FIELDS
from numpy.typing import ArrayLike, NDArray
from shapes import along, csg_hits, hits, points, row, stack

from limner._door import Array
from limner._jit import MODE, kernel
from limner.intersect.csg_program import check_program
from limner.intersect.distance_field import distance_field_at, intersect_distance_field
from limner.intersect.distance_program import field_value
from limner.intersect.double import logarithm, sine_and_cosine
from limner.intersect.layouts import BOX, CONE, CYLINDER, DIFFERENCE, DISTANCE_FIELD, ENDS_WIDTH, MAX_LEAVES, SPHERE, TORUS, UNION
from limner.kernel.vec import Vec3
from limner.linear.transform import in_order, rotate, scale, translate
from limner.scene import distance
from limner.scene.distance import Distance, DistanceField
from limner.tables.distance import numbers_of
from limner.tables.distance_codes import HEADER
from limner.tables.layouts import INSTANCE

F32, F64, I32 = np.float32, np.float64, np.int32
N = 600 if MODE == "compiled" else 80
INF = np.inf
Numbers = NDArray[np.float64]
Rays = NDArray[np.float32]


@kernel
def _values(numbers, p, stack, out):
    for k in range(p.shape[0]):
        out[k] = field_value(numbers, HEADER, numbers.shape[0], p[k, 0], p[k, 1], p[k, 2], stack)


@kernel
def _field_hits(shapes, numbers, rays, stack, out, at):
    for k in range(rays.shape[0]):
        shape = shapes[0]
        o, d = Vec3(rays[k, 0], rays[k, 1], rays[k, 2]), Vec3(rays[k, 3], rays[k, 4], rays[k, 5])
        h = intersect_distance_field(shape, numbers, o, d, rays[k, 6], rays[k, 7], rays[k, 8] > rays[k, 9], stack)
        out[k, 0], out[k, 1] = h.t, h.facing
        if h.part >= 0:
            a = distance_field_at(shape, numbers, o, d, h.t, stack)
            at[k, 0], at[k, 1], at[k, 2], at[k, 3], at[k, 4], at[k, 5] = a.p.x, a.p.y, a.p.z, a.n.x, a.n.y, a.n.z
            at[k, 6], at[k, 7] = a.u, a.v


@kernel
def _doubles(x, y, out):
    for k in range(x.shape[0]):
        out[k, 0], out[k, 1] = sine_and_cosine(x[k])
        out[k, 2] = logarithm(y[k])


def _stack() -> Numbers:
    return np.full((MAX_LEAVES, ENDS_WIDTH), np.nan)


def _hits(field: Distance, rays: Rays, world_from_object: ArrayLike | None = None) -> tuple[Rays, Rays]:
    """(n, 2): t and facing; (n, 8): position, normal, texture coordinates in the field's space."""
    shape = row(DISTANCE_FIELD, place=0, world_from_object=world_from_object)
    out, at = np.zeros((len(rays), 2), F32), np.zeros((len(rays), 8), F32)
    two = Array(F32, 2)
    door = door_of(_field_hits, Array(INSTANCE, 1), Array(F32, 1), two, Array(F64, 2), two, two)
    door(shape, numbers_of(DistanceField(field)), rays, _stack(), out, at)
    return out, at


def _rays(seed: int, n: int = N) -> Rays:
    random = np.random.default_rng(seed)
    o = random.normal(size=(n, 3)) * random.choice([0.4, 3.0, 40.0], size=(n, 1))
    d = random.normal(size=(n, 3)) * 0.5 - o
    d[::7, 1] = 0.0
    return along(o, d * 10.0 ** random.uniform(-2, 2, size=(n, 1)))


@pytest.mark.parametrize("name", FIELDS)
def test_kernels_and_host_know_the_same_field(name: str) -> None:
    """The program that kernels run, and the tree that the host walks, say the same of every point, but for float32 parameters."""
    p = np.random.default_rng(1).uniform(-2.5, 2.5, size=(N, 3))
    p[::5] = np.round(p[::5] * 4) / 4  # where cells, planes and axes meet
    out, numbers = np.zeros(len(p)), numbers_of(DistanceField(FIELDS[name]))
    door_of(_values, Array(F32, 1), Array(F64, 2), Array(F64, 2), Array(F64, 1))(numbers, p, _stack(), out)
    expected = FIELDS[name].distance(p)
    # A fractal tells float32 constants apart; beside it, all is the same to rounding.
    np.testing.assert_allclose(out, expected, rtol=1e-5, atol=2e-3 if name == "julia" else 2e-6)


EXACT = {
    "sphere": (distance.Sphere(0.9), row(SPHERE, (0.9,))),
    "box": (distance.Box((1.0, 1.6, 2.2)), row(BOX, (0.5, 0.8, 1.1))),
    "torus": (distance.Torus(0.8, 0.3), row(TORUS, (0.8, 0.3))),
    "cylinder": (distance.Cylinder(0.7, 1.6), row(CYLINDER, (0.7, 1.6))),
    "cone": (distance.Cone(0.9, 1.5, 0.2), row(CONE, (0.9, 0.2, 1.5))),
}
POSE = in_order(scale(0.7, 1.2, 1.0), rotate((1, 2, 0.5), 0.7), translate(0.3, -0.2, 0.4))


def _same_t(found: Rays, expected: Rays) -> NDArray[np.bool_]:
    """Where both hit at the same place; but for a ray in two hundred that grazes, that is where either hits."""
    both = np.isfinite(found) & np.isfinite(expected)
    near = np.zeros_like(both)
    near[both] = np.abs(found[both] - expected[both]) <= 1e-4 * np.abs(expected[both])
    same = near | (found == expected)
    assert same.mean() > 0.995
    return near


@pytest.mark.parametrize("name", EXACT)
@pytest.mark.parametrize("both_sides", [True, False])
def test_fields_of_exact_shapes_agree_with_them(name: str, both_sides: bool) -> None:
    """t to 1e-4 of itself, facing, normals to 1e-3, in a place that scales unevenly, from inside and outside, near and far."""
    field, _ = EXACT[name]
    exact = row(int(EXACT[name][1][0]["kind"]), EXACT[name][1][0]["size"], world_from_object=POSE)
    rays = _rays(3)
    rays[:, 8] = both_sides
    found, at = _hits(field, rays, POSE)
    expected, parts = hits(exact, rays)
    near = _same_t(found[:, 0], expected[:, 0])
    assert near.sum() > N // 6
    np.testing.assert_array_equal(found[near, 1], expected[near, 3])
    there = points(exact, rays, expected, parts)
    apart = np.abs(at[:, 3:6] - there["n"]).max(axis=1)[near]
    assert np.quantile(apart, 0.98) < 1e-3  # of rays that meet an edge, one may see the other side
    if name == "box":
        flat = near.copy()
        flat[near] = apart < 1e-3
        np.testing.assert_allclose(at[flat, 6:], there["uv"][flat], atol=1e-3)


def test_solids_of_fields_agree_with_exact_solids() -> None:
    """(box | torus) - ball, by distances and by the spans of exact shapes."""
    field = (distance.Box((1.0, 1.6, 2.2)) | distance.Torus(0.9, 0.3)) - distance.Sphere(0.7).translated(0.4, 0.3, 0.5)
    leaves = stack(
        row(BOX, (0.5, 0.8, 1.1), world_from_object=POSE),
        row(TORUS, (0.9, 0.3), world_from_object=POSE),
        row(SPHERE, (0.7,), world_from_object=POSE @ translate(0.4, 0.3, 0.5)),
    )
    rays = _rays(5)
    found, _ = _hits(field, rays, POSE)
    expected = csg_hits((leaves, check_program([0, 1, UNION, 2, DIFFERENCE], 3)), rays)[0]
    near = _same_t(found[:, 0], expected[:, 0])
    np.testing.assert_array_equal(found[near, 1], expected[near, 1])


@pytest.mark.parametrize("name", ["union", "difference", "shell", "sponge", "row", "gyroid in a ball"])
def test_hits_are_where_the_sign_changes(name: str) -> None:
    """From hit to hit: each lies on the surface, facings alternate, and between two there is no change that many samples see."""
    field = FIELDS[name]
    rays = _rays(7, 60 if MODE == "compiled" else 3)
    length = np.linalg.norm(rays[:, 3:6], axis=1)
    rays = rays[length > 0.01]
    length = length[length > 0.01].astype(F64)
    o, d = rays[:, :3].astype(F64), rays[:, 3:6].astype(F64)
    samples = np.linspace(0.0, 1.0, 500)[None] * (np.linalg.norm(o, axis=1) + 4.0)[:, None] / length[:, None]
    inside = field.distance(o[:, None] + samples[..., None] * d[:, None]) < 0
    seen, facing = np.zeros(len(rays)), np.where(inside[:, 0], 1.0, -1.0)
    count = np.zeros_like(samples)
    for _ in range(64):
        found, _ = _hits(field, rays)
        hit = np.isfinite(found[:, 0])
        if not hit.any():
            break
        np.testing.assert_array_equal(found[hit, 1], -facing[hit])
        facing = np.where(hit, found[:, 1], facing)
        off = field.distance(o + found[:, :1].astype(F64).clip(max=1e9) * d)[hit]
        assert np.abs(off).max() < 1e-6 * (np.linalg.norm(o, axis=1).max() + 5)
        count += hit[:, None] & (found[:, :1] <= samples)
        seen += hit
        rays[:, 6] = np.where(hit, found[:, 0], INF)
    assert not hit.any()
    assert seen.sum() > len(rays) / 2
    wrong = (samples > 0) & ((count % 2 == 1) != (inside != inside[:, :1]))
    assert wrong.mean() < 1e-3


def test_a_ray_leaves_the_surface_that_it_begins_on() -> None:
    """Pushed off by what `visibility.spawn` pushes: outwards a convex body is never met again, inwards its other side is."""
    for name in ("ball", "block", "ellipsoid", "octahedron", "smooth intersection"):
        rays = _rays(11)
        found, at = _hits(FIELDS[name], rays)
        hit = np.isfinite(found[:, 0])
        p, n = at[hit, :3], at[hit, 3:6]
        random = np.random.default_rng(3).normal(size=n.shape)
        out = random * np.sign((random * n).sum(axis=1, keepdims=True))
        push = 2.0**-18 * np.abs(p).sum(axis=1, keepdims=True)
        assert (np.abs(FIELDS[name].distance(p)) < 0.25 * push[:, 0]).all()
        smooth = np.abs((out * n).sum(axis=1)) > 1e-3
        assert np.isinf(_hits(FIELDS[name], along(p + push * n, out)[smooth])[0][:, 0]).mean() > 0.995  # a few begin at an edge
        inwards, _ = _hits(FIELDS[name], along(p - push * n, -out)[smooth])
        assert (inwards[:, 1] == -1).mean() > 0.995


@pytest.mark.parametrize("name", ["ring", "sponge", "julia", "twisted", "lattice in a ball", "rows of rows"])
def test_nasty_rays_come_to_an_end(name: str) -> None:
    """NaN, infinities, no direction, along axes, grazing, tiny and huge: an answer within the limits, or none."""
    odd = [0.0, -0.0, 1.0, np.nan, INF, 1e-38, 1e30]
    random = np.random.default_rng(1)
    o, d = random.choice(odd, size=(N, 3)), random.choice(odd, size=(N, 3))
    rays = along(o, d)
    low, high = DistanceField(FIELDS[name]).bounds
    # Along the faces of the box, and along lines in which surfaces lie
    axis = np.eye(3)[random.integers(0, 3, N)]
    slow = along(np.where(axis > 0, -3.0, random.choice([*low, *high, 0.0, 0.2], size=(N, 3))), axis)
    for asked in (rays, slow):
        found, at = _hits(FIELDS[name], asked)
        hit = np.isfinite(found[:, 0])
        assert not np.isnan(found).any()
        assert (found[~hit, 0] == INF).all()
        assert (found[hit, 0] > 0).all()
        assert np.isfinite(at[hit]).all()
    number = np.isfinite(rays[:, :6]).all(axis=1)
    assert not np.isfinite(_hits(FIELDS[name], rays)[0][~number, 0]).any()


def test_limits_are_kept() -> None:
    """What lies at t_min or before, or at t_max or beyond, is not met; a ray that sees the front only meets the first one that enters."""
    rays = along([[0, 0, 3]] * 6, [[0, 0, -1]] * 6, [0, 2, 2.5, 0, 4, 0], [INF, INF, INF, 2, INF, 2.5], [1, 1, 0, 1, 1, 0])
    np.testing.assert_allclose(_hits(distance.Sphere(1.0), rays)[0][:, 0], [2, 4, INF, INF, INF, 2])


def test_sine_cosine_and_logarithm() -> None:
    """To 1e-15, also far out."""
    x = np.concatenate([np.linspace(-50, 50, N), np.random.default_rng(0).normal(size=N) * 1e5])
    y = 10.0 ** np.linspace(-60, 20, len(x))
    out = np.zeros((len(x), 3))
    door_of(_doubles, Array(F64, 1), Array(F64, 1), Array(F64, 2))(x, y, out)
    np.testing.assert_allclose(out[:, 0], np.sin(x), rtol=0, atol=1e-15)
    np.testing.assert_allclose(out[:, 1], np.cos(x), rtol=0, atol=1e-15)
    np.testing.assert_allclose(out[:, 2], np.log(y), rtol=1e-15, atol=1e-15)


def test_the_same_bits_compiled_or_not() -> None:
    """One fixed set of rays through fields of every instruction has the same answers in every mode, here and elsewhere."""
    state = hashlib.blake2b(digest_size=8)
    for field in (
        distance.Difference(distance.Sphere(0.75), distance.Gyroid(0.5, 0.0), radius=0.125).twisted(0.0),
        distance.Union(distance.Cone(0.5, 1.0, 0.25), distance.Ellipsoid((0.75, 0.25, 0.5)), radius=0.25).elongated(0.0, 0.25, 0.0),
        distance.MengerSponge(1.5, 2).shell(0.03125) & distance.Octahedron(1.0),
        distance.QuaternionJulia((-0.25, 0.5, 0.25, 0.125), 6) - distance.Cylinder(0.25, 4.0),
        distance.Capsule(0.125, 0.5).mirrored("x").repeated((0.5, 0.0, 0.5), (2, 1, 3)),
    ):
        k = np.arange(12)
        o = np.stack([np.full(12, 3.0), k / 16 - 0.25, (k * 5 % 12) / 16 - 0.25], axis=1)
        found, at = _hits(field, along(o, [[-1.0, 0.0625, -0.03125]]))
        state.update(found.tobytes() + at.tobytes())
    assert state.hexdigest() == "f7cb0ed0d2227e7b"


def test_a_field_without_inside_has_no_surface() -> None:
    """It has a box, and rays pass."""
    found, _ = _hits(distance.Sphere(0.5).offset(-0.75), _rays(2))
    assert np.isinf(found[:, 0]).all()
