"""Rays and single shapes against float64 geometry, and where they touch, graze and miss (FoCG 4.4)."""

from __future__ import annotations

import numpy as np
import pytest
from compiled import door_of, over
from numpy.typing import NDArray

from limner._door import Array
from limner._jit import kernel
from limner.intersect.box import meet_box
from limner.intersect.plane import intersect_plane
from limner.intersect.sphere import intersect_sphere
from limner.intersect.triangle import hit_triangle, turned_ray
from limner.kernel.vec import ONE, ZERO, Vec3

INF = np.float32(np.inf)
N = 2000


@kernel
def _triangles(corners, rays, out):
    for k in range(rays.shape[0]):
        ray = turned_ray(Vec3(rays[k, 0], rays[k, 1], rays[k, 2]), Vec3(rays[k, 3], rays[k, 4], rays[k, 5]))
        x, y, z = ray.kx, ray.ky, ray.kz
        a = Vec3(corners[k, x], corners[k, y], corners[k, z])
        b = Vec3(corners[k, 3 + x], corners[k, 3 + y], corners[k, 3 + z])
        c = Vec3(corners[k, 6 + x], corners[k, 6 + y], corners[k, 6 + z])
        hit = hit_triangle(ray, a, b, c, rays[k, 6], rays[k, 7])
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = hit.t, hit.u, hit.v, hit.facing


@kernel
def _boxes(boxes, rays, out):
    for k in range(rays.shape[0]):
        o, d = Vec3(rays[k, 0], rays[k, 1], rays[k, 2]), Vec3(rays[k, 3], rays[k, 4], rays[k, 5])
        inverse = Vec3(ONE / d.x, ONE / d.y, ONE / d.z)
        low, high = Vec3(boxes[k, 0], boxes[k, 1], boxes[k, 2]), Vec3(boxes[k, 3], boxes[k, 4], boxes[k, 5])
        near = Vec3(high.x if inverse.x < 0 else low.x, high.y if inverse.y < 0 else low.y, high.z if inverse.z < 0 else low.z)
        far = Vec3(low.x if inverse.x < 0 else high.x, low.y if inverse.y < 0 else high.y, low.z if inverse.z < 0 else high.z)
        enter, leave = meet_box(near, far, o, inverse, rays[k, 6], rays[k, 7], ZERO)
        out[k, 0] = enter if enter <= leave else np.float32(np.inf)


def _run(entry: object, shapes: object, o: object, d: object, t_min: float = 0.0, t_max: float = np.inf) -> NDArray[np.float32]:
    shapes = np.atleast_2d(np.asarray(shapes, np.float32))
    o, d = np.atleast_2d(np.asarray(o, np.float32)), np.atleast_2d(np.asarray(d, np.float32))
    n = max(len(shapes), len(o), len(d))
    rays = np.empty((n, 8), np.float32)
    rays[:, :3], rays[:, 3:6], rays[:, 6], rays[:, 7] = o, d, t_min, t_max
    out = np.zeros((n, 4), np.float32)
    shapes = np.ascontiguousarray(np.broadcast_to(shapes, (n, shapes.shape[1])))
    door_of(entry, Array(np.float32, 2), Array(np.float32, 2), Array(np.float32, 2))(shapes, rays, out)
    return out


def _random() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    random = np.random.default_rng(4)
    o = random.normal(size=(N, 3)) * 3
    return o, -o + random.normal(size=(N, 3)) * 1.3


def test_triangles_against_the_linear_system():
    """o + t d = (1-u-v) a + u b + v c, solved in float64; the front is where the corners turn counter-clockwise."""
    o, d = _random()
    corners = np.random.default_rng(5).normal(size=(N, 9)) * 1.5
    a, b, c = corners[:, :3], corners[:, 3:6], corners[:, 6:]
    t, u, v, facing = _run(_triangles, corners, o, d).T.astype(np.float64)
    exact = np.linalg.solve(np.stack([-d, b - a, c - a], axis=2), (o - a)[:, :, None])[:, :, 0]
    inside = (exact[:, 1:] > 1e-5).all(axis=1) & (exact[:, 1] + exact[:, 2] < 1 - 1e-5) & (exact[:, 0] > 1e-5)
    outside = (exact[:, 1:] < -1e-5).any(axis=1) | (exact[:, 1] + exact[:, 2] > 1 + 1e-5) | (exact[:, 0] < -1e-5)
    assert inside.sum() > 200
    assert np.isinf(t[outside]).all()
    assert np.isfinite(t[inside]).all()
    good = inside & (np.abs(np.einsum("nk,nk->n", np.cross(b - a, c - a), d)) > 0.05)
    np.testing.assert_allclose(np.stack([t, u, v], 1)[good], exact[good], rtol=2e-4, atol=2e-5)
    np.testing.assert_array_equal((facing > 0)[inside], (np.einsum("nk,nk->n", np.cross(b - a, c - a), d) < 0)[inside])


def test_a_ray_through_a_shared_edge_or_vertex_hits_one_of_the_triangles():
    """Watertight (Woop et al. 2013): from anywhere, towards any point of the edge, over all scales of the triangles."""
    random = np.random.default_rng(6)
    p = random.normal(size=(N, 4, 3)) * 10.0 ** random.uniform(-4, 4, size=(N, 1, 1))
    p = p.astype(np.float32).astype(np.float64)
    w = random.random((N, 1))
    w[::5] = 0.0
    target = p[:, 0] * (1 - w) + p[:, 1] * w
    o = target + random.normal(size=(N, 3)) * np.linalg.norm(p[:, 0] - p[:, 1], axis=1, keepdims=True)
    o = o.astype(np.float32).astype(np.float64)
    first = _run(_triangles, p[:, [0, 1, 2]].reshape(N, 9), o, target - o)[:, 0]
    second = _run(_triangles, p[:, [1, 0, 3]].reshape(N, 9), o, target - o)[:, 0]
    # The two lie on both sides of the edge as the ray sees them, or on one: then there is no inside to lose.
    d = target - o
    plane = np.cross(p[:, 1] - p[:, 0], d)
    opposite = np.einsum("nk,nk->n", plane, p[:, 2] - p[:, 0]) * np.einsum("nk,nk->n", plane, p[:, 3] - p[:, 0]) < 0
    # Where the target rounds to beyond the end of the edge, neither owns it.
    middle = (w[:, 0] > 1e-3) & (w[:, 0] < 1 - 1e-3)
    assert (opposite & middle).sum() > 300
    assert np.isfinite(np.minimum(first, second))[opposite & middle].all()


def test_triangles_without_area_and_numbers_that_are_none_are_missed():
    o, d = (0, 0, 5), (0, 0, -1)
    for corners in (
        (0, 0, 0, 0, 0, 0, 0, 0, 0),
        (-1, 0, 0, 1, 0, 0, 3, 0, 0),
        (np.nan, 0, 0, 1, 0, 0, 0, 1, 0),
        (-np.inf, -1, 0, 1, -1, 0, 0, 1, 0),
    ):
        assert np.isinf(_run(_triangles, corners, o, d)[0, 0])
    whole = (-1, -1, 0, 1, -1, 0, 0, 1, 0)
    assert np.isinf(_run(_triangles, whole, (np.nan, 0, 5), d)[0, 0])
    assert np.isinf(_run(_triangles, whole, o, (0, np.nan, -1))[0, 0])
    assert np.isinf(_run(_triangles, whole, (0, 0, 0), (0, 1, 0))[0, 0])  # in its plane


def test_t_is_in_units_of_the_direction_and_its_limits_are_excluded():
    whole = (-1, -1, 0, 1, -1, 0, 0, 1, 0)
    assert _run(_triangles, whole, (0, 0, 5), (0, 0, -2.5))[0, 0] == 2.0
    assert np.isinf(_run(_triangles, whole, (0, 0, 5), (0, 0, -2.5), t_min=2.0)[0, 0])
    assert np.isinf(_run(_triangles, whole, (0, 0, 5), (0, 0, -2.5), t_max=2.0)[0, 0])
    assert _run(_triangles, whole, (0, 0, -5), (0, 0, -2.5), t_min=-10)[0, 0] == -2.0


def test_spheres_against_the_quadratic():
    """The least root of |o + t d|^2 = r^2 within the limits."""
    o, d = _random()
    r = np.random.default_rng(7).uniform(0.05, 4.0, size=N)
    t = over(intersect_sphere, o, d, r, np.zeros(N), np.full(N, INF)).astype(np.float64)
    o, d, r = (x.astype(np.float32).astype(np.float64) for x in (o, d, r))
    a, b, c = (d * d).sum(1), (o * d).sum(1), (o * o).sum(1) - r * r
    root = np.sqrt(np.maximum(b * b - a * c, 0))
    near, far = (-b - root) / a, (-b + root) / a
    exact = np.where(b * b < a * c, np.inf, np.where(near > 0, near, np.where(far > 0, far, np.inf)))
    sure = (np.abs(b * b - a * c) > 1e-3 * a * r * r) & (np.abs(near) > 1e-3) & (np.abs(far) > 1e-3)
    np.testing.assert_allclose(t[sure], exact[sure], rtol=1e-4)
    assert (np.isfinite(t) & sure).sum() > 500


@pytest.mark.parametrize("distance", [1e2, 1e4, 1e6])
def test_a_small_sphere_far_away_keeps_its_place(distance):
    """Haines et al. 2019: the discriminant from the closest point; the naive one has lost all its digits at 1e4."""
    t = over(intersect_sphere, (0.0, 0.0, distance), (0.0, 0.0, -1.0), 0.5, 0.0, INF)[0]
    assert t == pytest.approx(distance - 0.5, rel=1e-7)
    assert np.isinf(over(intersect_sphere, (0.51, 0.0, distance), (0.0, 0.0, -1.0), 0.5, 0.0, INF)[0])
    assert np.isfinite(over(intersect_sphere, (0.49, 0.0, distance), (0.0, 0.0, -1.0), 0.5, 0.0, INF)[0])


def test_planes():
    o, d = _random()
    t = over(intersect_plane, o, d, np.zeros(N), np.full(N, INF))
    exact = -o[:, 1] / d[:, 1]
    np.testing.assert_allclose(t, np.where(exact > 0, exact, np.inf), rtol=1e-5)
    for o, d in (((0, 1, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0)), ((0, 1, 0), (1, -0.0, 0)), ((0, 1, 0), (0, np.nan, 0))):
        assert np.isinf(over(intersect_plane, np.array(o, float), np.array(d, float), 0.0, INF)[0])


def test_boxes_against_slabs_in_float64():
    """Where the ray is inside all three slabs; never a miss for a hit, and a hit for a miss only by rounding."""
    o, d = _random()
    random = np.random.default_rng(8)
    low = random.normal(size=(N, 3))
    high = low + 3 * random.exponential(size=(N, 3)) * (random.random((N, 3)) > 0.2)
    boxes = np.concatenate([low, high], axis=1).astype(np.float32)
    enter = _run(_boxes, boxes, o, d)[:, 0]
    o, d, boxes = (x.astype(np.float32).astype(np.float64) for x in (o, d, boxes))
    near, far = (boxes[:, :3] - o) / d, (boxes[:, 3:] - o) / d
    exact_enter = np.maximum(np.minimum(near, far).max(axis=1), 0)
    exact_leave = np.maximum(near, far).min(axis=1)
    hits = exact_enter <= exact_leave
    assert hits.sum() > 200
    assert np.isfinite(enter[hits]).all()
    np.testing.assert_allclose(enter[hits], exact_enter[hits], rtol=1e-5, atol=1e-6)
    assert np.isinf(enter[exact_enter > exact_leave * (1 + 1e-5) + 1e-6]).all()


@pytest.mark.parametrize("t_min", [0.0, -20.0])
def test_boxes_and_rays_along_their_slabs(t_min):
    """Zero components of either sign, the origin within, on the very planes, and outside; before and behind the origin."""
    box = (0, 0, 0, 1, 2, 3)
    for axis in range(3):
        for sign in (1.0, -1.0):
            for zero in (0.0, -0.0):
                d = np.full(3, zero)
                d[axis] = sign
                for share in ((0.0, 0.0), (0.5, 0.5), (1.0, 1.0), (0.0, 1.0), (1.0, 0.25)):
                    o = np.array(box[3:]) * np.insert(share, axis, 0.5)
                    o[axis] = -sign * 5 if t_min == 0 else sign * 5
                    assert np.isfinite(_run(_boxes, box, o, d, t_min)[0, 0]), (o, d)
                    o[(axis + 1) % 3] = -0.01
                    assert np.isinf(_run(_boxes, box, o, d, t_min)[0, 0]), (o, d)
