"""Disk, cylinder, cone, torus, quadric, patch and box: single rays whose answers are known, and the formulas of the surface."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike
from shapes import along, area, bounds, hits, points, quadric_numbers, row, spans

from limner.intersect.layouts import BOX, CONE, CSG, CYLINDER, DISK, MESH, PATCH, PLANE, QUADRIC, SPHERE, TORUS

INF = np.inf
_PROGRAM = Path(__file__).with_name("fingerprint.py")

BALL_IN_BOX = quadric_numbers((1, 1, 1, 0, 0, 0, 0, 0, 0, -1), (-0.5, -2, -2), (2, 2, 2))
BENT = np.array([0, 0, 0, 1, 0, 0, 1, 1, 1, 0, 1, 0], np.float32)  # z = x y over the unit square
SHAPES = {
    "ball": (row(SPHERE, (1.0,)), BENT),
    "plane": (row(PLANE), BENT),
    "box": (row(BOX, (1.0, 1.0, 1.0)), BENT),
    "disk": (row(DISK, (1.0,)), BENT),
    "cylinder": (row(CYLINDER, (1.0, 2.0)), BENT),
    "tube": (row(CYLINDER, (1.0, 2.0), capped=False), BENT),
    "cone": (row(CONE, (1.0, 0.0, 2.0)), BENT),
    "open cone": (row(CONE, (1.0, 0.5, 2.0), capped=False), BENT),
    "torus": (row(TORUS, (1.0, 0.25)), BENT),
    "quadric": (row(QUADRIC, place=0), BALL_IN_BOX),
    "open quadric": (row(QUADRIC, place=0, capped=False), BALL_IN_BOX),
    "patch": (row(PATCH, place=0), BENT),
}


def _t(name: str, o: ArrayLike, d: ArrayLike, **limits: float) -> float:
    shape, numbers = SHAPES[name]
    return float(hits(shape, along(o, d, **limits), numbers)[0][0, 0])


def _part(name: str, o: ArrayLike, d: ArrayLike) -> tuple[int, float]:
    shape, numbers = SHAPES[name]
    found, part = hits(shape, along(o, d), numbers)
    return int(part[0]), float(found[0, 3])


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_no_ray_misses(name: str) -> None:
    """NaN or infinity in any component, a direction of zero, limits that are NaN or leave nothing; parts and facing say so."""
    shape, numbers = SHAPES[name]
    good = [0.3, 3.0, 0.2, 0.01, -1.0, 0.02]
    assert name in ("tube", "open cone", "torus", "patch") or np.isfinite(_t(name, good[:3], good[3:]))
    for bad in (np.nan, INF, -INF):
        for k in range(6):
            ray = good.copy()
            ray[k] = bad
            found, part = hits(shape, along(ray[:3], ray[3:]), numbers)
            np.testing.assert_array_equal(found[0], [INF, 0, 0, 0])
            assert part[0] == -1
    assert np.isinf(_t(name, good[:3], (0.0, -0.0, 0.0)))
    for t_min, t_max in ((np.nan, INF), (0.0, np.nan), (5.0, 1.0), (0.0, 0.0)):
        assert np.isinf(_t(name, good[:3], good[3:], t_min=t_min, t_max=t_max))


def test_a_disk_has_a_rim_and_two_sides() -> None:
    """The rim counts, a rounding beyond does not; parallel rays miss, those in its plane too."""
    assert _t("disk", (1, 2, 0), (0, -4, 0)) == 0.5
    assert np.isinf(_t("disk", (np.nextafter(np.float32(1), np.float32(2)), 2, 0), (0, -4, 0)))
    assert _part("disk", (0, 2, 0), (0, -1, 0)) == (0, 1.0)
    assert _part("disk", (0, -2, 0), (0, 1, 0)) == (0, -1.0)
    assert np.isinf(hits(SHAPES["disk"][0], along((0, -2, 0), (0, 1, 0), both_sides=False))[0][0, 0])
    assert np.isinf(_t("disk", (0, 0, 0), (1, 0, 0)))
    assert np.isinf(_t("disk", (0, 1, 0), (1, 0, 0)))


def test_a_cylinder_along_its_axis_and_its_caps() -> None:
    """Down the axis: cap to cap; parallel to the caps: side to side; on a cap's very plane it is still inside."""
    assert (_t("cylinder", (0, 5, 0), (0, -1, 0)), _part("cylinder", (0, 5, 0), (0, -1, 0))) == (4.0, (2, 1.0))
    assert (_t("cylinder", (0, 0, 0), (0, -1, 0)), _part("cylinder", (0, 0, 0), (0, -1, 0))) == (1.0, (1, -1.0))
    assert (_t("cylinder", (-5, 0.5, 0), (1, 0, 0)), _part("cylinder", (-5, 0.5, 0), (1, 0, 0))) == (4.0, (0, 1.0))
    assert _t("cylinder", (-5, 1, 0), (1, 0, 0)) == 4.0
    assert np.isinf(_t("cylinder", (-5, np.nextafter(np.float32(1), np.float32(2)), 0), (1, 0, 0)))
    assert np.isinf(_t("cylinder", (1.01, 5, 0), (0, -1, 0)))
    # On the side, straight down: the closed solid is met; without caps there is nothing to meet
    assert _t("cylinder", (1, 5, 0), (0, -1, 0)) == 4.0
    assert np.isinf(_t("tube", (0, 5, 0), (0, -1, 0)))


def test_an_open_tube_is_seen_from_inside() -> None:
    """Through the missing cap onto the wall from behind; a ray through both openings misses."""
    assert _t("tube", (0, 2, 0), (1, -1.5, 0)) == 1.0
    assert _part("tube", (0, 2, 0), (1, -1.5, 0)) == (0, -1.0)
    assert np.isinf(_t("tube", (0, 2, 0), (0.2, -1, 0)))
    tube = SHAPES["tube"][0]
    assert np.isinf(hits(tube, along((0, 2, 0), (1, -1.5, 0), both_sides=False))[0][0, 0])


def test_a_cone_and_its_apex() -> None:
    """Down onto the apex, along a line of the cone, through its mirror image, which is not there, and from below."""
    assert _t("cone", (0, 5, 0), (0, -1, 0)) == 4.0
    assert _t("cone", (0, -5, 0), (0, 2, 0)) == 2.0
    assert _part("cone", (0, -5, 0), (0, 2, 0)) == (1, 1.0)
    # Parallel to the line from (0, 1, 0) to (1, -1, 0), a tenth inside: from the cap to the far side
    ends, parts = spans(SHAPES["cone"][0], along((0.9 - 2, -1 + 4, 0), (1, -2, 0)))
    assert ends[0, 1] == pytest.approx(2.0)
    assert parts[0, 1] == 1
    for y in (1.5, 3.0, 100.0):
        assert np.isinf(_t("cone", (-5, y, 0.01), (1, 0, 0)))
    assert _t("cone", (-5, 0, 0), (1, 0, 0)) == 4.5
    assert _part("cone", (-5, 0, 0), (1, 0, 0)) == (0, 1.0)


def test_a_cone_without_slope_is_a_cylinder() -> None:
    """The same ends to the last bits, the same parts."""
    random = np.random.default_rng(1)
    rays = along(random.normal(size=(300, 3)) * 2, random.normal(size=(300, 3)))
    one, other = spans(row(CONE, (0.7, 0.7, 1.5)), rays), spans(row(CYLINDER, (0.7, 1.5)), rays)
    finite = np.isfinite(one[0])
    np.testing.assert_array_equal(finite, np.isfinite(other[0]))
    np.testing.assert_allclose(one[0][finite], other[0][finite], rtol=1e-12)
    np.testing.assert_array_equal(one[1], other[1])


def test_a_torus_through_its_hole_and_along_its_tangents() -> None:
    """Nothing through the hole, four ends across, two along the tube; tangent inside the hole it passes the tube twice."""
    torus = SHAPES["torus"][0]
    assert np.isinf(_t("torus", (0, 5, 0), (0, -1, 0)))
    np.testing.assert_allclose(spans(torus, along((-3, 0, 0), (2, 0, 0)))[0][0], np.array([1.75, 2.25, 3.75, 4.25]) / 2, rtol=1e-14)
    np.testing.assert_allclose(spans(torus, along((1, 3, 0), (0, -1, 0)))[0][0], [2.75, 3.25, INF, INF], rtol=1e-14)
    chord = np.sqrt(1.25**2 - 1)
    np.testing.assert_allclose(spans(torus, along((1, 0, -2), (0, 0, 1)))[0][0, :2], [2 - chord, 2 + chord], rtol=1e-14)
    # Lying on the table that it stands on: touching along a circle
    assert _t("torus", (-3, 0.25, 0), (1, 0, 0)) == pytest.approx(2.0, abs=1e-3) or np.isinf(_t("torus", (-3, 0.25, 0), (1, 0, 0)))
    assert np.isinf(_t("torus", (-3, 0.2500001, 0), (1, 0, 0)))
    # Seen from within the tube, and, fronts only, from the tube through to the opposite side
    assert _t("torus", (1, 0, 0), (-1, 0, 0)) == 0.25
    assert hits(torus, along((1, 0, 0), (-1, 0, 0), both_sides=False))[0][0, 0] == 1.75


def test_a_quadric_is_cut_by_its_box() -> None:
    """A ball cut at x = -1/2: closed by a cap, or open; along the cut, from inside; directions in which it is linear."""
    assert _t("quadric", (-5, 0, 0), (1, 0, 0)) == 4.5
    assert _part("quadric", (-5, 0, 0), (1, 0, 0)) == (2, 1.0)
    assert _t("open quadric", (-5, 0, 0), (1, 0, 0)) == 6.0
    assert _part("open quadric", (-5, 0, 0), (1, 0, 0)) == (0, -1.0)
    assert _t("quadric", (5, 0, 0), (-1, 0, 0)) == 4.0
    assert _t("quadric", (0, 0, 0), (0, 0, 4)) == 0.25
    paraboloid = quadric_numbers((1, 0, 1, 0, 0, 0, 0, -1, 0, 0), (-2, -1, -2), (2, 1, 2))  # y >= x^2 + z^2, up to y = 1
    ends, parts = spans(row(QUADRIC, place=0), along((0.5, 3, 0), (0, -1, 0)), paraboloid)
    np.testing.assert_allclose(ends[0], [2, 2.75, INF, INF], rtol=1e-14)
    np.testing.assert_array_equal(parts[0, :2], [3, 0])
    saddle = quadric_numbers((1, 0, -1, 0, 0, 0, 0, 0, 0, 0), (-1, -1, -1), (1, 1, 1))  # |x| <= |z|: two wedges
    ends, _ = spans(row(QUADRIC, place=0), along((0.5, 0, -3), (0, 0, 1)), saddle)
    np.testing.assert_allclose(ends[0], [2, 2.5, 3.5, 4], rtol=1e-14)


def test_a_patch_against_its_equation() -> None:
    """z = x y over the unit square, met at most twice; u and v are x and y; its front is towards +z; edges count."""
    shape, numbers = SHAPES["patch"]
    random = np.random.default_rng(3)
    xy = np.concatenate([random.random((200, 2)), [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.25]]])
    target = np.concatenate([xy, xy[:, :1] * xy[:, 1:]], axis=1).astype(np.float32)
    d = np.concatenate([random.normal(size=(len(xy), 2)) * 0.3, np.full((len(xy), 1), -1.0)], axis=1)
    d[::5, :2] = 0.0
    d[200:, :2] = 0.0
    rays = along(target - 2 * d.astype(np.float32), d)
    found, part = hits(shape, rays, numbers)
    np.testing.assert_allclose(found[:, 0], 2.0, rtol=2e-6)
    np.testing.assert_allclose(found[:, 1:3], xy, atol=2e-6)
    np.testing.assert_array_equal(part, 0)
    np.testing.assert_array_equal(found[:, 3], 1.0)
    back = along(rays[:, :3] + 4 * rays[:, 3:6], -rays[:, 3:6])
    np.testing.assert_array_equal(hits(shape, back, numbers)[0][:, 3], -1.0)
    # Skimming: x = y = t, z = 1/4 meets x y = 1/4 once; from corner to corner through the saddle twice
    assert _t("patch", (0, 0, 0.25), (1, 1, 0)) == 0.5
    twice = along((0, 1, 0.2), (1, -1, 0.0))
    expected = (1 - np.sqrt(1 - 0.8)) / 2, (1 + np.sqrt(1 - 0.8)) / 2
    assert hits(shape, twice, numbers)[0][0, 0] == pytest.approx(expected[0], rel=1e-6)
    twice[:, 6] = np.float32(expected[0] + 1e-3)
    assert hits(shape, twice, numbers)[0][0, 0] == pytest.approx(expected[1], rel=1e-6)


def test_patches_side_by_side_leave_no_gap() -> None:
    """Rays at points of a shared edge, from anywhere and at all scales, hit one of the two, their ends and corners as well."""
    random = np.random.default_rng(8)
    n = 300
    corners = (random.normal(size=(n, 6, 3)) * 10.0 ** random.uniform(-3, 3, size=(n, 1, 1))).astype(np.float32)
    w = random.random((n, 1))
    w[::10] = 0.0
    a, b = corners[:, 0].astype(np.float64), corners[:, 1].astype(np.float64)
    target = a * (1 - w) + b * w
    way = random.normal(size=(n, 3)) * np.linalg.norm(a - b, axis=1, keepdims=True)
    missed = 0
    for k in range(n):
        left = corners[k, [0, 1, 2, 3]].reshape(-1)
        right = corners[k, [1, 0, 4, 5]].reshape(-1)
        numbers = np.concatenate([left, right])
        o = (target[k] - way[k]).astype(np.float32)
        ray = along(o, target[k] - o)
        t = [hits(row(PATCH, place=place), ray, numbers)[0][0, 0] for place in (0, 12)]
        plane = np.cross(b[k] - a[k], ray[0, 3:6])
        sides = [np.sign((corners[k, j] - a[k]) @ plane) for j in (2, 3, 4, 5)]
        straddles = sides[0] == sides[1] != sides[2] == sides[3] and 1e-3 < w[k, 0] < 1 - 1e-3
        missed += straddles and not np.isfinite(t).any()
    assert missed == 0


@pytest.mark.parametrize(("x", "u", "v"), [(-1, 0.0, 0.0), (1, 1.0, 1.0), (0, 0.5, 0.5)])
def test_texture_coordinates_of_a_disk(x: float, u: float, v: float) -> None:
    """The disk cut out of the texture: u along +x, v along -z."""
    shape, _ = SHAPES["disk"]
    rays = along((0.5 * x, 1, -0.5 * x), (0, -1, 0))
    seen = points(shape, rays, *hits(shape, rays))
    np.testing.assert_allclose(seen["uv"][0], [0.5 + (u - 0.5) / 2, 0.5 + (v - 0.5) / 2])
    np.testing.assert_array_equal(seen["n"][0], [0, 1, 0])


@pytest.mark.parametrize("name", ["ball", "cylinder", "cone", "torus"])
def test_round_shapes_turn_their_texture_alike(name: str) -> None:
    """u = 1/2 + atan2(-z, x) / 2 pi: from above counter-clockwise, 1/2 at +x, 1/4 at +z, 3/4 at -z; v grows upwards."""
    shape, _ = SHAPES[name]
    o = np.array([[3, 0, 0], [0, 0, 3], [0, 0, -3], [3, 0.1, 0]], float)
    rays = along(o, -o * [1, 0, 1])
    uv = points(shape, rays, *hits(shape, rays))["uv"]
    np.testing.assert_allclose(uv[:3, 0], [0.5, 0.25, 0.75], atol=1e-7)
    np.testing.assert_allclose(uv[:3, 1], 0.5, atol=1e-7)
    assert uv[3, 1] > 0.5


def test_faces_of_a_box_show_the_texture_as_its_mesh_does() -> None:
    """The same normals and texture coordinates at the same points as `mesh.primitives.box`."""
    from limner.mesh.shapes.primitives import box

    size = np.array([1.0, 2.0, 3.0])
    mesh = box(size)
    shape = row(BOX, tuple(size / 2))
    for triangle in range(12):
        corners = mesh.positions[mesh.triangles[triangle]]
        n, uv = mesh.normals[mesh.normal_triangles[triangle, 0]], mesh.uvs[mesh.uv_triangles[triangle]]
        weights = np.array([0.2, 0.3, 0.5], np.float32)
        ray = along(weights @ corners + n, -n)
        found, part = hits(shape, ray)
        seen = points(shape, ray, found, part)
        assert part[0] == triangle // 2
        np.testing.assert_allclose(seen["n"][0], n)
        np.testing.assert_allclose(seen["uv"][0], weights @ uv, atol=1e-6)


def test_areas_and_bounds_of_known_shapes() -> None:
    """Closed forms; bounds touch the shape on every side."""
    pi = np.pi
    expected = {"ball": 4 * pi, "disk": pi, "cylinder": 6 * pi, "tube": 4 * pi, "cone": pi * np.sqrt(5) + pi, "torus": pi**2}
    for name, value in expected.items():
        assert area(SHAPES[name][0])[0] == pytest.approx(value, rel=1e-6)
    assert area(SHAPES["box"][0])[0] == 24
    for name in ("plane", "quadric", "patch"):
        assert area(*SHAPES[name])[0] == 0
    corners = {"disk": (1, 0, 1), "cylinder": (1, 1, 1), "cone": (1, 1, 1), "torus": (1.25, 0.25, 1.25), "box": (1, 1, 1)}
    for name, corner in corners.items():
        box = bounds(SHAPES[name][0])[0]
        np.testing.assert_allclose(box, [*(-np.array(corner)), *corner], atol=3e-6)
    np.testing.assert_allclose(bounds(SHAPES["patch"][0], BENT)[0], [0, 0, 0, 1, 1, 1], atol=3e-6)
    np.testing.assert_allclose(bounds(SHAPES["quadric"][0], BALL_IN_BOX)[0], [-0.5, -2, -2, 2, 2, 2], atol=6e-6)
    assert np.isinf(bounds(SHAPES["plane"][0])[0]).all()


@pytest.mark.parametrize("kind", [MESH, CSG, -1, 99])
def test_kinds_that_are_no_single_shape_are_missed(kind: int) -> None:
    """The dispatcher's last word is a miss, not the last shape."""
    shape, ray = row(kind, (1.0, 1.0, 1.0)), along((0, 0, 5), (0, 0, -1))
    assert np.isinf(hits(shape, ray)[0][0, 0])
    assert np.isinf(spans(shape, ray)[0]).all()


def _fingerprint(**environment: str) -> dict[str, str]:
    cleared = ("LIMNER_MODE", "NUMBA_DISABLE_JIT", "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")
    kept = {name: value for name, value in os.environ.items() if name not in cleared}
    done = subprocess.run(
        [sys.executable, str(_PROGRAM)], env={**kept, **environment}, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def as_python() -> dict[str, str]:
    """The reference: the kernels as they are written."""
    return _fingerprint(LIMNER_MODE="python")


@pytest.mark.compiled
@pytest.mark.parametrize("cpu", ["", "generic"])
def test_compiled_is_python_to_the_bit(as_python: dict[str, str], cpu: str) -> None:
    """Every shape and a solid, with fused multiply-add at hand and without."""
    assert _fingerprint(**({"NUMBA_CPU_NAME": cpu} if cpu else {})) == as_python


def test_tracing_changes_nothing(as_python: dict[str, str]) -> None:
    """What explains a pixel computes the same pixel."""
    assert _fingerprint(LIMNER_MODE="traced") == as_python
