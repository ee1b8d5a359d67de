"""What holds for every exact shape and every ray (FoCG 4.4): against sampling in float64, integral geometry, and differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapes import along, area, at, bounds, contains, hits, oracle, points, quadric_numbers, row, spans, stack

from limner._jit import MODE
from limner.intersect.layouts import BOX, CONE, CYLINDER, DISK, PATCH, PLANE, QUADRIC, SPHERE, TORUS

N = 600 if MODE == "compiled" else 60
INF = np.inf
SOLIDS = {"ball": SPHERE, "half space": PLANE, "box": BOX, "cylinder": CYLINDER, "cone": CONE, "torus": TORUS, "quadric": QUADRIC}
Numbers = NDArray[np.float64]

# Ellipsoid, one sheet, two sheets, paraboloid, saddle, double cone, parabolic cylinder, two planes, and a ball turned inside out
QUADRICS = (
    (1.0, 2.0, 0.5, 0.3, -0.2, 0.1, 0.05, -0.1, 0.0, -0.3),
    (1.0, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.1),
    (1.0, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1),
    (1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0),
    (1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0),
    (1.0, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (-1.0, -1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.4),
)


def _quadric(which: int, scale: float) -> NDArray[np.float32]:
    """A quadric of QUADRICS, scaled, in a box that its middle does not share."""
    c = np.array(QUADRICS[which]) / np.array([scale**2] * 6 + [scale] * 3 + [1.0])
    return quadric_numbers(c, np.array([-1.0, -0.8, -0.9]) * scale, np.array([0.9, 1.0, 1.1]) * scale)


def _shape(kind: int, scale: float, a: float, b: float, c: float, capped: bool = True) -> tuple[NDArray[np.void], NDArray[np.float32]]:
    """A shape of about the size `scale`, with proportions a, b, c in [0, 1], and the numbers it refers to."""
    numbers = _quadric(int(8.999 * a), scale)
    sizes = {
        SPHERE: (scale,),
        PLANE: (),
        BOX: (scale * (0.01 + a), scale * (0.01 + b), scale * (0.01 + c)),
        CYLINDER: (scale * (0.01 + a), scale * (0.01 + b)),
        CONE: (scale * a, scale * b if c < 0.8 else 0.0, scale * (0.01 + c)),
        TORUS: (scale * (0.3 + a), scale * (0.3 + a) * (0.01 + 0.99 * b)),
        QUADRIC: (),
    }
    return row(kind, sizes[kind], place=0, capped=capped), numbers


def _rays(scale: Numbers | float, random: np.random.Generator, n: int) -> NDArray[np.float32]:
    """From outside and inside, towards the middle and past it; a third with components that are zero or next to it."""
    scale = np.broadcast_to(np.asarray(scale, np.float64), (n,))[:, None]
    o = random.normal(size=(n, 3)) * scale * random.choice([0.3, 1.5, 20.0], size=(n, 1))
    d = random.normal(size=(n, 3)) * scale * 0.8 - o
    nasty = random.random((n, 3)) < np.where(random.random((n, 1)) < 0.33, 0.5, 0.0)
    d = np.where(nasty, d * random.choice([0.0, -0.0, 1e-9, 1e-20], size=(n, 3)), d)
    d[~(np.abs(d) > 0).any(axis=1)] = scale[0]
    return along(o, d * 10.0 ** random.uniform(-3, 3, size=(n, 1)))


def _assert_spans_fit(shape: NDArray[np.void], numbers: NDArray[np.float32], rays: NDArray[np.float32], scale: float) -> None:
    """Every point clearly inside lies in a span, none clearly outside does: at even steps, and where the ray comes closest."""
    ends, _ = spans(shape, rays, numbers)
    d, o = rays[:, 3:6].astype(np.float64), rays[:, :3].astype(np.float64)
    squared = (d * d).sum(1)
    closest = -(o * d).sum(1) / squared
    half = 5 * scale / np.sqrt(squared)
    low, high = closest - half, closest + half
    for _ in range(3):
        t = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, 257)
        g = oracle(shape[0], at(rays, t), numbers) / scale
        inside = contains(ends, t)
        sure = np.abs(g) > 1e-9
        np.testing.assert_array_equal(inside[sure], (g < 0)[sure])
        best = t[np.arange(len(t)), np.argmin(np.abs(g), axis=1)]
        width = (high - low) / 100
        low, high = best - width, best + width
    assert (ends[:, 0] <= ends[:, 1]).all()
    assert (ends[:, 1] <= ends[:, 2]).all()
    assert (ends[:, 2] <= ends[:, 3]).all()


@pytest.mark.parametrize("kind", SOLIDS.values(), ids=SOLIDS)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_spans_are_where_the_solid_is(kind: int, scale: float) -> None:
    """Shapes thick and thin, rays of any length of direction, from inside and far outside, along axes and nearly so."""
    random = np.random.default_rng(kind + 10)
    for k in range(9):
        a = (k + 0.5) / 9 if kind == QUADRIC else random.random()
        shape, numbers = _shape(kind, scale, a, *random.random(2))
        _assert_spans_fit(shape, numbers, _rays(scale, random, N // 9 + 2), scale)


_PLACE = st.sampled_from([0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 0.25, 2.0, -3.0, 1e-4]) | st.floats(-3, 3, width=32)
_WAY = st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e-4, -1e-7, 1e-12, 1e-30, 3.0]) | st.floats(-1, 1, width=32)
_UNIT = st.sampled_from([0.0, 0.5, 1.0]) | st.floats(0, 1, width=32)


@given(
    kind=st.sampled_from(list(SOLIDS.values())), proportions=st.tuples(_UNIT, _UNIT, _UNIT), exponent=st.integers(-3, 3),
    o=st.tuples(_PLACE, _PLACE, _PLACE), d=st.tuples(_WAY, _WAY, _WAY), length=st.sampled_from([1.0, 1e-3, 1e3]),
)  # fmt: skip
def test_no_ray_is_nasty_enough(kind, proportions, exponent, o, d, length) -> None:
    """On faces, edges and axes, parallel to sides and caps, denormal and zero components; a direction of zero hits nothing."""
    scale = 10.0**exponent
    shape, numbers = _shape(kind, scale, *proportions)
    rays = along(np.array(o) * scale, np.array(d) * length)
    if not np.any(rays[:, 3:6]):
        assert np.isinf(spans(shape, rays, numbers)[0]).all()
        return
    if np.abs(rays[:, 3:6]).max() < 1e-20:
        rays[:, 3:6] *= np.float32(1e30)  # the oracle squares them, too
    _assert_spans_fit(shape, numbers, rays, scale)


@pytest.mark.parametrize("kind", SOLIDS.values(), ids=SOLIDS)
def test_the_nearest_hit_is_the_first_end_within_the_limits(kind: int) -> None:
    """Limits excluded, also where they are an end itself; from the front only, the first entry."""
    random = np.random.default_rng(3)
    shape, numbers = _shape(kind, 1.0, 0.3, 0.4, 0.5)
    rays = _rays(1.0, random, N)
    ends, parts = spans(shape, rays, numbers)
    ends32 = ends.astype(np.float32)
    finite = np.where(np.isfinite(ends32), ends32, 0.0)
    pick = random.integers(0, 4, size=(N, 2))
    rays[:, 6] = np.where(random.random(N) < 0.5, finite[np.arange(N), pick[:, 0]], -10.0)
    rays[:, 7] = np.where(random.random(N) < 0.5, finite[np.arange(N), pick[:, 1]], INF)
    for both_sides in (True, False):
        rays[:, 8] = both_sides
        t, _, _, facing = hits(shape, rays, numbers)[0].T
        part = hits(shape, rays, numbers)[1]
        allowed = (rays[:, 6:7] < ends32) & (ends32 < rays[:, 7:8]) & np.array([True, both_sides, True, both_sides])
        first = np.argmax(allowed, axis=1)
        found = allowed.any(axis=1)
        np.testing.assert_array_equal(t, np.where(found, ends32[np.arange(N), first], INF))
        np.testing.assert_array_equal(part, np.where(found, parts[np.arange(N), first], -1))
        np.testing.assert_array_equal(facing, np.where(found, np.array([1, -1, 1, -1])[first], 0))


@pytest.mark.parametrize("ratio", [1e-3, 0.1, 0.5, 0.999, 1.0])
def test_the_torus_has_the_roots_of_its_quartic(ratio: float) -> None:
    """Against the eigenvalues of the companion matrix, wherever these tell clearly how many roots are real."""
    random = np.random.default_rng(9)
    R, r = np.float32(1.0), np.float32(ratio)
    o = random.normal(size=(N, 3))
    target = random.normal(size=(N, 3))
    ring = target * [1, 0, 1] / np.linalg.norm(target * [1, 0, 1], axis=1, keepdims=True)
    rays = along(o * 2, ring + random.normal(size=(N, 3)) * ratio * 0.7 - o * 2)
    ends, _ = spans(row(TORUS, (R, r)), rays)
    compared = 0
    for k in range(N):
        p, d = rays[k, :3].astype(np.float64), rays[k, 3:6].astype(np.float64)
        dd, pd, pp = d @ d, p @ d, p @ p + 1.0 - float(r) ** 2
        flat = np.array([d[0] ** 2 + d[2] ** 2, p[0] * d[0] + p[2] * d[2], p[0] ** 2 + p[2] ** 2])
        c = [dd * dd, 4 * dd * pd, 2 * dd * pp + 4 * pd * pd - 4 * flat[0], 4 * pd * pp - 8 * flat[1], pp * pp - 4 * flat[2]]
        roots = np.roots(c)
        imaginary = np.abs(roots.imag) * np.sqrt(dd)
        if np.any((imaginary > 1e-12) & (imaginary < 1e-3 * ratio)):
            continue
        real = np.sort(roots[imaginary <= 1e-12].real)
        if np.any(np.diff(real) * np.sqrt(dd) < 1e-2 * ratio):
            continue
        compared += 1
        np.testing.assert_array_equal(np.isfinite(ends[k]).sum(), len(real))
        np.testing.assert_allclose(ends[k][: len(real)], real, rtol=0, atol=1e-5 * ratio / np.sqrt(dd))
    assert compared > 0.7 * N


@pytest.mark.parametrize("kind", [SPHERE, CYLINDER, CONE, TORUS], ids=["ball", "cylinder", "cone", "torus"])
@pytest.mark.parametrize("distance", [3.0, 1e3, 1e5])
def test_a_ray_that_grazes_is_decided_rightly(kind: int, distance: float) -> None:
    """Along tangents moved along the normal, out by a few roundings of the ray's own numbers: a miss; in by as much: a hit.

    From 10^5 radii away, where a formula in float32, and for the torus one in radicals, has lost every digit.
    """
    random = np.random.default_rng(5)
    shape = row(kind, {SPHERE: (1.0,), CYLINDER: (0.5, 2.0), CONE: (0.9, 0.3, 2.0), TORUS: (1.0, 0.25)}[kind])
    inwards = along(random.normal(size=(8 * N, 3)) * 0.8, random.normal(size=(8 * N, 3)))
    found, part = hits(shape, inwards)
    p = points(shape, inwards, found, part)
    n, q = p["n"], p["p"]
    curved = (part == 0) & (np.abs(q[:, 1]) < 0.95)
    if kind == TORUS:
        curved &= np.hypot(q[:, 0], q[:, 2]) > 1.05  # where it bulges, so that a tangent stays outside
    n, q = n[curved], q[curved]
    across = np.cross(n, random.normal(size=n.shape))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    if kind == CONE:  # across its lines, lest the tangent is one
        across = np.cross(n, np.array([0.0, 1.0, 0.0]))
    step = 1e-6 * distance
    for sign in (1.0, -1.0):
        o = q + sign * step * n - distance * across
        rays = along(o, across)
        moved = rays.astype(np.float64)
        # Where the rounded ray truly passes, at its closest to the point
        t = ((q - moved[:, :3]) * moved[:, 3:6]).sum(1) / (moved[:, 3:6] ** 2).sum(1)
        nearest = oracle(shape[0], moved[:, None, :3] + (t[:, None] + np.linspace(-0.3, 0.3, 2001))[:, :, None] * moved[:, None, 3:6]).min(
            axis=1
        )
        within = oracle(shape[0], at(rays, t[:, None]))[:, 0]
        ends, _ = spans(shape, rays)
        hit = np.isfinite(ends[:, 0])
        assert hit[(within < -1e-9)].all()
        if distance <= 1e3:
            assert not hit[nearest > 1e-5].any()


@pytest.mark.parametrize("kind", [CYLINDER, CONE, QUADRIC], ids=["cylinder", "cone", "quadric"])
def test_an_open_sheet_is_hit_where_its_side_is_crossed(kind: int) -> None:
    """Between the caps, every change of sign of the endless side along the ray is a hit, and nothing else."""
    random = np.random.default_rng(11)
    for k in range(9):
        shape, numbers = _shape(kind, 1.0, (k + 0.5) / 9, *random.random(2), capped=False)
        rays = _rays(1.0, random, N // 9 + 2)
        low, high = oracle_slab(shape[0], rays, numbers)
        t = low[:, None] + (high - low)[:, None] * np.linspace(1e-7, 1 - 1e-7, 1025)
        positive = np.where(low < high, 1.0, np.nan)
        g = oracle(shape[0], at(rays, t), numbers, side_only=True) * positive[:, None]
        crossed = (g[:, 1:] > 1e-8) & (g[:, :-1] < -1e-8) | (g[:, 1:] < -1e-8) & (g[:, :-1] > 1e-8)
        ahead = (t[:, :-1] > 1e-6) & crossed
        certain = ahead.any(axis=1)
        first = np.argmax(ahead, axis=1)
        found, _ = hits(shape, rays, numbers)
        rows = np.arange(len(rays))
        assert (found[certain, 0] <= (t[rows, first + 1] * (1 + 1e-6))[certain]).all()
        met = np.isfinite(found[:, 0])
        p = at(rays, np.where(met, found[:, 0], 0.0)[:, None])[:, 0]
        reach = 1e-6 * (1 + np.abs(rays[:, :3]).max(axis=1))
        assert (np.abs(oracle(shape[0], p, numbers, side_only=True)) < 20 * reach)[met].all()
        assert (found[met, 0] >= (low - 1e-6 * np.abs(low))[met].astype(np.float32) * (1 - 1e-6) - 1e-6).all()


def oracle_slab(shape: np.void, rays: NDArray[np.float32], numbers: NDArray[np.float32]) -> tuple[Numbers, Numbers]:
    """Between which parameters a ray is between the caps, or in the quadric's box."""
    size = shape["size"].astype(np.float64)
    high = {CYLINDER: [9e9, size[1] / 2, 9e9], CONE: [9e9, size[2] / 2, 9e9], QUADRIC: numbers[13:]}[int(shape["kind"])]
    low = numbers[10:13] if shape["kind"] == QUADRIC else -np.asarray(high)
    o, d = rays[:, :3].astype(np.float64), rays[:, 3:6].astype(np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        near, far = (low - o) / d, (high - o) / d
    enter = np.fmin(near, far).max(axis=1)
    leave = np.fmax(near, far).min(axis=1)
    outside = ((d == 0) & ((o < low) | (o > high))).any(axis=1)
    return np.where(outside, 1.0, np.clip(enter, -1e6, 1e6)), np.where(outside, 0.0, np.clip(leave, -1e6, 1e6))


# --- points ---------------------------------------------------------------------------------------------------------------

PATCHES = np.array([[-1, 0, 1, 1, 0.3, 1, 1, -0.2, -1, -1, 0.5, -1], [-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0]], np.float32)

SURFACES = {
    "ball": row(SPHERE, (1.3,)),
    "plane": row(PLANE),
    "box": row(BOX, (0.5, 0.8, 1.1)),
    "disk": row(DISK, (1.2,)),
    "cylinder": row(CYLINDER, (0.7, 1.6)),
    "cone": row(CONE, (0.9, 0.2, 1.5)),
    "pointed cone": row(CONE, (0.9, 0.0, 1.5)),
    "torus": row(TORUS, (1.0, 0.4)),
    "ellipsoid": row(QUADRIC, place=0),
    "paraboloid": row(QUADRIC, place=48),
    "saddle": row(QUADRIC, place=64),
    "patch": row(PATCH, place=144),
    "square": row(PATCH, place=156),
}
NUMBERS = np.concatenate([_quadric(k, 1.0) for k in range(9)] + [*PATCHES])


def _seen(name: str) -> tuple[NDArray[np.void], NDArray[np.float32], NDArray[np.float32], NDArray[np.int32]]:
    """A surface, rays, what they hit; those that miss left out."""
    random = np.random.default_rng(2)
    rays = along(random.normal(size=(4 * N, 3)), random.normal(size=(4 * N, 3)))
    found, parts = hits(SURFACES[name], rays, NUMBERS)
    met = np.isfinite(found[:, 0]) & (found[:, 0] < 1e3)
    assert met.sum() > N // 4
    return SURFACES[name], rays[met], np.ascontiguousarray(found[met]), parts[met]


@pytest.mark.parametrize("name", SURFACES)
def test_points_lie_on_the_surface_with_normals_outwards(name: str) -> None:
    """p is where the ray is, and on the surface to a rounding; n is unit, the slope of the oracle, and tells the side that is hit."""
    shape, rays, found, parts = _seen(name)
    seen = points(shape, rays, found, parts, NUMBERS)
    p, n, facing = seen["p"], seen["n"], found[:, 3]
    np.testing.assert_allclose(p, at(rays, found[:, :1])[:, 0], atol=2e-5, rtol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1.0, atol=1e-6)
    along_ray = (n * rays[:, 3:6]).sum(1) / np.linalg.norm(rays[:, 3:6], axis=1)
    clear = np.abs(along_ray) > 1e-3
    np.testing.assert_array_equal(np.sign(-along_ray)[clear], facing[clear])
    np.testing.assert_allclose((seen["tangent"] * n).sum(1), 0.0, atol=2e-6)
    if shape["kind"][0] in (DISK, PATCH):
        return
    g = oracle(shape[0], p, NUMBERS)
    np.testing.assert_allclose(g, 0.0, atol=3e-7 * np.maximum(1.0, np.abs(p).max(axis=1)).max())
    h = 1e-4
    slope = np.stack([oracle(shape[0], p + h * e, NUMBERS) - oracle(shape[0], p - h * e, NUMBERS) for e in np.eye(3)], axis=1)
    length = np.linalg.norm(slope, axis=1)
    # Away from the edges, where the two points belong to different parts
    inner = np.abs(oracle(shape[0], p - 1e-3 * n, NUMBERS) + oracle(shape[0], p + 1e-3 * n, NUMBERS)) < 2e-5
    assert inner.mean() > 0.8
    cosine = (slope * n).sum(1) / length
    smooth = inner & (length > 0)
    assert np.quantile(cosine[smooth], 0.03) > 1 - 1e-5


@pytest.mark.parametrize("name", SURFACES)
def test_gradients_say_how_texture_coordinates_change(name: str) -> None:
    """From a hit to a hit nearby on the same part: du = gradient_u . dp; u and v in [0, 1], and right-handed from outside."""
    shape, rays, found, parts = _seen(name)
    here = points(shape, rays, found, parts, NUMBERS)
    near = rays.copy()
    near[:, 3:6] += np.random.default_rng(8).normal(size=(len(rays), 3)) * 2e-3
    found2, parts2 = hits(shape, near, NUMBERS)
    again = np.isfinite(found2[:, 0])
    here, there = {key: value[again] for key, value in here.items()}, points(shape, near[again], found2[again], parts2[again], NUMBERS)
    dp, duv = there["p"] - here["p"], there["uv"] - here["uv"]
    together = (parts == parts2)[again] & (np.linalg.norm(dp, axis=1) < 0.02)
    if name not in ("plane", "disk", "patch", "square", "box"):
        together &= (np.hypot(here["p"][:, 0], here["p"][:, 2]) > 0.15) & (np.abs(duv[:, 0]) < 0.5) & (np.abs(duv[:, 1]) < 0.5)
    assert together.mean() > 0.4
    for k, gradient in enumerate(("gradient_u", "gradient_v")):
        middle = (here[gradient] + there[gradient]) / 2
        expected = (middle * dp).sum(1)
        np.testing.assert_allclose(duv[together, k], expected[together], atol=4e-5 * max(1.0, np.abs(here["uv"]).max()))
    if name != "plane":
        assert (here["uv"] >= 0).all()
        assert (here["uv"] <= 1).all()
    if name in ("ellipsoid", "paraboloid", "saddle"):
        return
    away = (np.linalg.norm(here["gradient_u"], axis=1) > 0) & (np.linalg.norm(here["gradient_v"], axis=1) > 0)
    bitangent = np.cross(here["n"], here["tangent"])
    assert ((here["gradient_u"] * here["tangent"]).sum(1)[away] > 0).all()
    assert ((here["gradient_v"] * bitangent).sum(1)[away] > 0).all()


# --- measures -------------------------------------------------------------------------------------------------------------


def _lines(radius: float, n: int) -> NDArray[np.float32]:
    """Lines that meet a ball around the origin, each as likely as any other: a direction, and a point of the disk across it."""
    random = np.random.default_rng(21)
    d = random.normal(size=(n, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    u = np.cross(d, random.normal(size=(n, 3)))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    # Stratified by area and turn, as a spiral of the golden angle
    k = np.arange(n) + 0.5
    r, turn = radius * np.sqrt(k / n), k * np.pi * (3 - np.sqrt(5))
    o = r[:, None] * (np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * np.cross(d, u))
    return along(o - 2 * radius * d, d)


def _tetrahedral_patch_area() -> float:
    u, v = (np.arange(400)[:, None] + 0.5) / 400, (np.arange(400)[None, :] + 0.5) / 400
    p00, p10, p11, p01 = PATCHES[0].astype(np.float64).reshape(4, 3)
    du = (p10 - p00) * (1 - v[..., None]) + (p11 - p01) * v[..., None]
    dv = (p01 - p00) * (1 - u[..., None]) + (p11 - p10) * u[..., None]
    return float(np.linalg.norm(np.cross(du, dv), axis=-1).mean())


AREAS = {
    "ball": (SURFACES["ball"], None),
    "box": (SURFACES["box"], None),
    "disk": (SURFACES["disk"], None),
    "cylinder": (SURFACES["cylinder"], None),
    "tube": (row(CYLINDER, (0.7, 1.6), capped=False), None),
    "cone": (SURFACES["cone"], None),
    "open cone": (row(CONE, (0.9, 0.2, 1.5), capped=False), None),
    "torus": (SURFACES["torus"], None),
    "patch": (SURFACES["patch"], _tetrahedral_patch_area()),
}


@pytest.mark.parametrize("name", AREAS)
def test_areas_by_the_lines_that_cross_them(name: str) -> None:
    """Cauchy and Crofton: lines through a ball of radius r cross a surface A / (2 pi r^2) times on average."""
    shape, expected = AREAS[name]
    n = 60 * N
    rays = _lines(2.0, n)
    crossings = 0
    for _ in range(5):
        t = hits(shape, rays, NUMBERS)[0][:, 0]
        crossings += int(np.isfinite(t).sum())
        rays = rays[np.isfinite(t)]
        rays[:, 6] = t[np.isfinite(t)]
    assert len(rays) == 0
    expected = float(area(shape, NUMBERS)[0]) if expected is None else expected
    mean = expected / (2 * np.pi * 4)
    assert crossings / n == pytest.approx(mean, abs=5 * np.sqrt(mean * 2.5 / n))


VOLUMES = {
    "ball": (SURFACES["ball"], 4 / 3 * np.pi * 1.3**3),
    "box": (SURFACES["box"], 8 * 0.5 * 0.8 * 1.1),
    "cylinder": (SURFACES["cylinder"], np.pi * 0.7**2 * 1.6),
    "cone": (SURFACES["cone"], np.pi * 1.5 / 3 * (0.9**2 + 0.9 * 0.2 + 0.2**2)),
    "torus": (SURFACES["torus"], 2 * np.pi**2 * 0.4**2),
}


@pytest.mark.parametrize("name", VOLUMES)
def test_volumes_by_the_lengths_of_spans(name: str) -> None:
    """The mean length inside, of lines through a disk of radius r, times its area (Cavalieri)."""
    shape, expected = VOLUMES[name]
    ends, _ = spans(shape, _lines(2.0, 60 * N))
    lengths = np.where(np.isfinite(ends[:, :2]).all(axis=1), ends[:, 1] - np.where(np.isfinite(ends[:, 0]), ends[:, 0], 0.0), 0.0)
    second = np.isfinite(ends[:, 2])
    lengths[second] += ends[second, 3] - ends[second, 2]
    error = lengths.std() / np.sqrt(len(lengths))
    assert lengths.mean() * np.pi * 4 == pytest.approx(expected, abs=5 * error * np.pi * 4)


@pytest.mark.parametrize("name", [name for name in SURFACES if name != "plane"])
def test_bounds_hold_the_shape_and_fit(name: str) -> None:
    """Under turning, shearing and moving, no hit lies outside; where the formula is exact, hits come close to every side."""
    random = np.random.default_rng(31)
    m = np.eye(4)
    m[:3, :3] = random.normal(size=(3, 3))
    m[:3, 3] = (5.0, -7.0, 2.0)
    shape, rays, found, parts = _seen(name)
    p = points(shape, rays, found, parts, NUMBERS)["p"] @ m[:3, :3].T + m[:3, 3]
    placed = shape.copy()
    placed["world_from_object"] = m[:3]
    low, high = np.split(bounds(placed, NUMBERS)[0].astype(np.float64), 2)
    assert (p >= low).all()
    assert (p <= high).all()
    if name not in ("ellipsoid", "paraboloid", "saddle") and MODE == "compiled":
        # Corners are seldom hit: what is missing is small beside the size
        assert (p.min(axis=0) - low < 0.2 * (high - low)).all()
        assert (high - p.max(axis=0) < 0.2 * (high - low)).all()


def test_a_world_ray_is_taken_to_the_shape_and_keeps_its_t() -> None:
    """A torus turned, scaled unevenly and moved far away, hit from there: the same t as for the ray in its own space."""
    random = np.random.default_rng(41)
    m = np.eye(4)
    m[:3, :3] = random.normal(size=(3, 3))
    m[:3, 3] = (100.0, -30.0, 20.0)
    shape = stack(SURFACES["torus"])
    rays = _rays(1.0, random, N)
    t = hits(shape, rays)[0][:, 0]
    placed = row(TORUS, (1.0, 0.4), world_from_object=m)
    world = along(rays[:, :3] @ m[:3, :3].T + m[:3, 3], rays[:, 3:6] @ m[:3, :3].T)
    t_placed = hits(placed, world)[0][:, 0]
    speed = np.linalg.norm(rays[:, 3:6], axis=1)
    both = np.isfinite(t) & np.isfinite(t_placed)
    assert both.sum() >= 0.97 * np.isfinite(t).sum()
    close = np.abs(t[both] - t_placed[both]) * speed[both] < 1e-3 * (1 + np.abs(rays[both, :3]).max(axis=1))
    assert close.mean() > 0.95
