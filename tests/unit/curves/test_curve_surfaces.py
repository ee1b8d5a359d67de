"""Surfaces that curves make: patches of any degree, triangles, sheets, sweeps, and tessellations without cracks."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.curves import bezier, bspline, nurbs, patch, surface, sweep, teapot, tessellate, triangle_patch
from limner.curves.curve import Parametric, Spline
from limner.errors import SceneError

Floats = NDArray[np.float64]
RNG = np.random.default_rng(11)


def edges(triangles: NDArray[np.int32]) -> dict[tuple[int, int], int]:
    """How often each directed edge is there."""
    made: dict[tuple[int, int], int] = {}
    for a, b, c in triangles.tolist():
        for edge in ((a, b), (b, c), (c, a)):
            made[edge] = made.get(edge, 0) + 1
    return made


def open_edges(triangles: NDArray[np.int32]) -> list[tuple[int, int]]:
    found = edges(triangles)
    assert max(found.values()) == 1  # consistently oriented, nothing twice
    return [(a, b) for a, b in found if (b, a) not in found]


def test_patches_of_any_degree_agree_with_the_bicubic_kind_and_with_curves() -> None:
    """Elevated to bicubic the same points; rows of control points are the borders; derivatives against differences."""
    net = RNG.normal(size=(3, 4, 3))
    u, v = RNG.uniform(0, 1, (2, 9))
    points = surface.evaluate(net, u, v)
    np.testing.assert_allclose(patch.positions(surface.bicubic(net), u, v), points, atol=1e-13)
    np.testing.assert_allclose(surface.evaluate(net, u, 0.0), bezier.evaluate(net[0], u), atol=1e-14)
    np.testing.assert_allclose(surface.evaluate(surface.elevate(net, 2, 3), u, v), points, atol=1e-13)
    step = 1e-6
    for orders, du, dv in (((1, 0), step, 0.0), ((0, 1), 0.0, step)):
        expected = (surface.evaluate(net, u + du, v + dv) - surface.evaluate(net, u - du, v - dv)) / (2 * step)
        np.testing.assert_allclose(surface.partial(net, u, v, orders), expected, atol=1e-7)
    assert not surface.partial(net, u, v, (4, 0)).any()
    low, high = surface.split(net, 0.3, 0.6)
    s, t = 0.25, 0.75
    places = ((0.3 * s, 0.6 * t), (0.3 + 0.7 * s, 0.6 * t), (0.3 * s, 0.6 + 0.4 * t), (0.3 + 0.7 * s, 0.6 + 0.4 * t))
    for part, (x, y) in zip((*low, *high), places, strict=True):
        np.testing.assert_allclose(surface.evaluate(part, s, t), surface.evaluate(net, x, y), atol=1e-13)


def test_a_sphere_is_a_rational_patch() -> None:
    """An eighth of a sphere: every point at distance 1."""
    w = math.sqrt(0.5)
    arc = np.array([[1, 0], [1, 1], [0, 1]], dtype=float)
    net = np.array([[(x * r, y * r, z) for x, y in arc] for r, z in arc])
    weights = np.outer([1, w, 1], [1, w, 1])
    u, v = RNG.uniform(0, 1, (2, 20))
    np.testing.assert_allclose(np.linalg.norm(surface.rational_evaluate(net, weights, u, v), axis=1), 1.0, atol=1e-14)


def test_sheets_are_their_patches() -> None:
    """A B-spline sheet is the B-spline of B-splines; its patches meet to rounding."""
    net = RNG.normal(size=(5, 6, 3))
    patches = surface.bspline_patches(net)
    assert patches.shape == (2, 3, 4, 4, 3)
    u, v = 0.55, 0.2
    rows = np.array([bspline.evaluate(row, u) for row in net])
    column = int(u * 3)
    np.testing.assert_allclose(surface.evaluate(patches[0, column], u * 3 - column, v * 2), bspline.evaluate(rows, v), atol=1e-12)
    np.testing.assert_allclose(patches[0, 0][-1], patches[1, 0][0], atol=1e-13)


def test_triangles_have_their_borders_corners_and_degree() -> None:
    """Bézier curves along the borders; a flat net of the corners' means is the plane; affine invariance; weights sum to one."""
    for degree in (1, 2, 3, 4):
        ijk = triangle_patch.indices(degree)
        net = RNG.normal(size=(len(ijk), 3))
        t = np.linspace(0, 1, 7)
        for side in range(3):
            b = np.zeros((7, 3))
            b[:, (side + 1) % 3], b[:, (side + 2) % 3] = 1 - t, t
            np.testing.assert_allclose(triangle_patch.evaluate(net, b), bezier.evaluate(triangle_patch.border(net, side), t), atol=1e-13)
        b = RNG.dirichlet(np.ones(3), 10)
        bernstein = [math.factorial(degree) / math.prod(math.factorial(k) for k in row) * np.prod(b**row, axis=1) for row in ijk.tolist()]
        np.testing.assert_allclose(np.array(bernstein).T @ net, triangle_patch.evaluate(net, b), atol=1e-13)
        corners = RNG.normal(size=(3, 3))
        np.testing.assert_allclose(triangle_patch.evaluate(ijk / degree @ corners, b), b @ corners, atol=1e-13)


def test_parts_of_a_triangle_are_the_same_surface() -> None:
    """Cut at a point into three, and at the middles into four: looked up at barycentrics within each part."""
    net = RNG.normal(size=(10, 3))
    b = RNG.dirichlet(np.ones(3), 6)
    at = np.array([0.2, 0.3, 0.5])
    for corner, part in enumerate(triangle_patch.subdivided(net, at)):
        corners = np.eye(3)
        corners[corner] = at
        np.testing.assert_allclose(triangle_patch.evaluate(part, b), triangle_patch.evaluate(net, b @ corners), atol=1e-12)
    ab, bc, ca = (0.5, 0.5, 0.0), (0.0, 0.5, 0.5), (0.5, 0.0, 0.5)
    one, two, three = np.eye(3)
    places = ((one, ab, ca), (ab, two, bc), (ca, bc, three), (bc, ca, ab))
    for part, corners in zip(triangle_patch.quartered(net), places, strict=True):
        np.testing.assert_allclose(triangle_patch.evaluate(part, b), triangle_patch.evaluate(net, b @ np.array(corners)), atol=1e-12)
    to_second, to_third = triangle_patch.partials(net, b[0])
    step = 1e-6
    for made, way in ((to_second, (-1, 1, 0)), (to_third, (-1, 0, 1))):
        ends = [triangle_patch.evaluate(net, b[0] + sign * step * np.array(way)) for sign in (1, -1)]
        np.testing.assert_allclose(made, (ends[0] - ends[1]) / (2 * step), atol=1e-7)


def test_a_triangle_s_grid_is_whole() -> None:
    """n^2 triangles, every inner edge twice, the border 3 n edges, the flat one's area that of the triangle."""
    net = triangle_patch.indices(2) / 2.0 @ np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    made = tessellate.tessellated_triangle(net, 5)
    assert len(made.triangles) == 25
    assert len(open_edges(made.triangles)) == 15
    p = made.positions[made.triangles]
    assert np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])[:, 2].sum() / 2 == pytest.approx(0.5)
    np.testing.assert_allclose(made.normals, np.broadcast_to((0.0, 0.0, 1.0), made.normals.shape), atol=1e-12)


@pytest.mark.parametrize("tolerance", [0.3, 0.05, 0.01])
def test_neighbours_of_different_bend_have_no_cracks(tolerance: float) -> None:
    """A flat patch, a bent one beside it, a third turned by a half turn: one boundary, and errors within the tolerance."""
    grid = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0), [0.0]), axis=-1).reshape(4, 4, 3)
    bent = grid + np.array([3.0, 0.0, 0.0])
    bent[1:3, 1:, 2] = 3.0
    third = bent[:, ::-1] * (-1, 1, 1) + np.array([12.0, 0.0, 0.0])
    turned = np.array(third)[::-1, ::-1]
    made = tessellate.tessellated([grid, bent, turned], tolerance)
    border = open_edges(made.triangles)
    ends = np.array([made.positions[list(edge)] for edge in border])
    # Open edges lie on the outline only: x = 0, x = 9, or y = 0 or 3
    outline = (ends[..., 0] == 0).all(axis=1) | (ends[..., 0] == 9).all(axis=1) | (ends[..., 1] <= 1e-12).all(axis=1)
    assert (outline | (ends[..., 1] >= 3 - 1e-12).all(axis=1)).all()
    n_edges = (3 * len(made.triangles) + len(border)) // 2
    assert len(made.positions) - n_edges + len(made.triangles) == 1  # Euler: a disk
    n_u, n_v = tessellate.patch_counts(bent, tolerance)
    steps_u, steps_v = np.arange(n_u) / n_u, np.arange(n_v) / n_v
    u, v = np.meshgrid(steps_u, steps_v)
    a, b = surface.evaluate(bent, u, v), surface.evaluate(bent, u + 1 / n_u, v + 1 / n_v)
    off = np.linalg.norm(0.5 * (a + b) - surface.evaluate(bent, u + 0.5 / n_u, v + 0.5 / n_v), axis=-1)
    assert off.max() <= tolerance


def test_the_teapot_has_no_cracks_but_its_openings() -> None:
    """All 32 patches at once: open edges are the rims of body, lid, handle and spout; with a finer tolerance more triangles."""
    nets = teapot.patches()
    coarse, fine = tessellate.tessellated(nets, 0.05), tessellate.tessellated(nets, 0.02)
    assert len(fine.triangles) > len(coarse.triangles)
    border = open_edges(coarse.triangles)
    following = dict(border)
    assert len(following) == len(border)
    loops, left = 0, set(following)
    while left:
        at = start = left.pop()
        while (at := following[at]) != start:
            left.remove(at)
        loops += 1
    # The body's upper rim, the lid's lower one, two ends of the handle and two of the spout
    assert loops == 6
    np.testing.assert_allclose(np.linalg.norm(coarse.normals, axis=1), 1.0, atol=1e-9)


def test_a_swept_circle_is_a_tube_and_faces_outwards() -> None:
    """Every point at its distance from the curve, its volume that of the tube; twist and scale do what they say."""
    ring = np.stack([0.2 * np.cos(a := np.linspace(0, 2 * np.pi, 25)), 0.2 * np.sin(a)], axis=1)
    ring[-1] = ring[0]
    circle = Parametric(lambda u: np.stack([np.cos(u), np.sin(u), 0 * u], axis=-1), 0.0, 2 * math.pi)
    made = sweep.swept(circle, ring, 96, closed=True)
    radial = np.hypot(made.positions[:, 0], made.positions[:, 1]) - 1.0
    np.testing.assert_allclose(np.hypot(radial, made.positions[:, 2]), 0.2, atol=1e-6)
    p = made.positions[made.triangles]
    volume = np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6
    assert volume == pytest.approx(2 * math.pi**2 * 0.04, rel=0.02)
    foot = made.positions * (1, 1, 0)
    foot /= np.linalg.norm(foot, axis=1, keepdims=True)
    np.testing.assert_allclose(((made.positions - foot) / 0.2 * made.normals).sum(axis=1), 1.0, atol=1e-2)
    line = Spline.bezier([[0, 0, 0], [0, 0, 4]])
    band = sweep.ribbon(line, 2.0, 8, twist=math.pi / 2).positions.reshape(9, 2, 3)
    across = band[:, 1] - band[:, 0]
    assert abs(across[0] @ across[-1]) < 1e-9
    np.testing.assert_allclose(np.linalg.norm(across, axis=1), 2.0)
    grown = sweep.swept(line, ring, 4, scale=(1.0, 3.0)).positions.reshape(5, 25, 3)
    np.testing.assert_allclose(np.linalg.norm(grown[-1, :, :2], axis=1), 0.6)


def test_lines_for_tubes_follow_their_curve() -> None:
    """Points of a curve in space, to a tolerance."""
    curve = Spline.bezier([[0, 0, 0], [1, 2, 0], [2, 0, 3]])
    points = sweep.along(curve, 0.01)
    assert 4 < len(points) < 64
    with pytest.raises(SceneError, match="space"):
        sweep.along(nurbs.circle(), 0.1)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: triangle_patch.evaluate(np.zeros((4, 3)), (1, 0, 0)), "control points"),
        (lambda: triangle_patch.evaluate(np.zeros((3, 3)), (1, 1, 0)), "sum 1"),
        (lambda: surface.evaluate(np.zeros((2, 3)), 0, 0), "shape"),
        (lambda: surface.bicubic(np.zeros((5, 2, 3))), "bicubic"),
        (lambda: tessellate.tessellated([np.zeros((2, 2, 2))], 0.1), "3 coordinates"),
        (lambda: tessellate.patch_counts(np.zeros((2, 2, 3)), 0.0), "tolerance"),
        (lambda: sweep.ribbon(Spline.bezier([[0, 0, 0], [0, 0, 4]]), -1.0), "width"),
        (lambda: sweep.swept(nurbs.circle(), [(0, 0), (1, 0)], 4), "space"),
        (lambda: surface.rational_evaluate(np.zeros((2, 2, 3)), np.zeros((2, 2)), 0, 0), "weights"),
    ],
)
def test_bad_input_is_refused(call: object, words: str) -> None:
    assert callable(call)
    with pytest.raises(SceneError, match=words):
        call()
