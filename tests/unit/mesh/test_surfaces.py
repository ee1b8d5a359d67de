"""Planes, heights, profiles turned, outlines extruded, lines thickened: closed forms, closed solids, refused slips."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.curves.frames import rotation_minimizing_frames
from limner.errors import SceneError
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.mesh.shapes.outlines import oriented_outlines, signed_area, triangulated


def crosses(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    return p, np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])


def volume(mesh: Mesh) -> float:
    p, cross = crosses(mesh)
    return float((p[:, 0] * cross).sum() / 6)


def area(mesh: Mesh) -> float:
    return float(np.linalg.norm(crosses(mesh)[1], axis=1).sum() / 2)


def corners_of(mesh: Mesh, field: str) -> np.ndarray:
    values, index = {"normals": (mesh.normals, mesh.normal_triangles), "uvs": (mesh.uvs, mesh.uv_triangles)}[field]
    return values[mesh.triangles if index is None else index].astype(np.float64)


def open_sides(mesh: Mesh) -> int:
    """How many sides have no opposite; every side must be there once."""
    sides = [(a, b) for t in mesh.triangles.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)]
    assert len(set(sides)) == len(sides)
    return len({(b, a) for a, b in sides} - set(sides))


def euler(mesh: Mesh) -> int:
    t = mesh.triangles
    sides = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    return len(mesh.positions) - len(np.unique(sides, axis=0)) + len(t)


def assert_faces_outwards(mesh: Mesh) -> None:
    """Normals unit and on the side of the winding; no texture mirrored."""
    normals = corners_of(mesh, "normals")
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1.0, atol=1e-6)
    assert ((normals * crosses(mesh)[1][:, None]).sum(axis=-1) > 0.0).all()
    uv = corners_of(mesh, "uvs")
    e, f = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    assert (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0] > 0.0).all()


# --- sheets ---------------------------------------------------------------------------------------------------------------


def test_a_plane_is_flat_and_shows_the_whole_texture():
    mesh = primitives.plane((2.0, 3.0), 4)
    assert (len(mesh.positions), len(mesh.triangles), open_sides(mesh)) == (25, 32, 16)
    assert area(mesh) == pytest.approx(6.0)
    assert_faces_outwards(mesh)
    np.testing.assert_allclose(mesh.uvs, mesh.positions[:, [0, 2]] / (2.0, -3.0) + 0.5, atol=1e-6)


def test_heights_stand_where_the_map_shows_them():
    """Row 0 at the back; a parabola's central differences are its derivatives, but on the border."""
    x, z = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-2, 2, 17))
    mesh = primitives.heightfield(x * x - 0.5 * z * z + 0.25 * x, (2.0, 4.0), 0.5)
    px, py, pz = mesh.positions.astype(np.float64).T
    np.testing.assert_allclose(py, 0.5 * (px * px - 0.5 * pz * pz + 0.25 * px), atol=1e-6)
    assert_faces_outwards(mesh)
    inner = (np.abs(px) < 0.99) & (np.abs(pz) < 1.99)
    normals = np.stack([-(px + 0.125), np.ones_like(px), 0.5 * pz], axis=1)
    np.testing.assert_allclose(mesh.normals[inner], (normals / np.linalg.norm(normals, axis=1, keepdims=True))[inner], atol=1e-6)


# --- revolution -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backwards", [False, True])
def test_pappus_says_how_large_a_solid_of_revolution_is(backwards):
    """Area and volume are 2 pi times the way of the centroids; either sense of the profile; V - E + F of ball and ring."""
    ring = np.array([(1.0, 0.0), (2.0, 0.0), (1.5, 1.0), (1.0, 0.0)])
    spindle = np.array([(0.0, -1.0), (1.0, 0.0), (1.0, 0.5), (0.0, 1.0)])
    for profile, chi, turned in ((ring, 0, 2 * np.pi * 1.5 * 0.5), (spindle, 2, np.pi * (1 / 3 + 0.5 + 1 / 6))):
        mesh = primitives.revolution(profile[::-1] if backwards else profile, 192)
        assert (open_sides(mesh), euler(mesh)) == (0, chi)
        assert volume(mesh) == pytest.approx(turned, rel=1e-3)
        middles, lengths = (profile[1:] + profile[:-1])[:, 0] / 2, np.linalg.norm(np.diff(profile, axis=0), axis=1)
        assert area(mesh) == pytest.approx(2 * np.pi * (middles * lengths).sum(), rel=1e-3)
        assert_faces_outwards(mesh)


def test_creases_of_a_profile():
    """A polygon with many sides is smooth, a square is not; caps close what is open, on the right of the way where it is not closed."""
    angle = np.pi * (np.arange(33) / 32 - 0.5)
    ball = primitives.revolution(np.stack([np.maximum(np.cos(angle), 0.0) * (np.abs(angle) < 1.57), np.sin(angle)], axis=1), 64)
    towards = ball.positions[ball.triangles] / np.linalg.norm(ball.positions, axis=1)[ball.triangles][..., None]
    assert (corners_of(ball, "normals") * towards).sum(axis=-1).min() > 0.998
    can = primitives.revolution([(1.0, 0.0), (1.0, 2.0)], 64, capped=True)
    assert (open_sides(can), euler(can)) == (0, 2)
    np.testing.assert_allclose(np.abs(corners_of(can, "normals")[..., 1]).reshape(-1) % 1.0, 0.0, atol=1e-6)
    assert volume(primitives.revolution([(1.0, 2.0), (1.0, 0.0)], 64, capped=True)) == pytest.approx(volume(can))
    inner = primitives.revolution([(1.0, 2.0), (1.0, 0.0)], 64)
    assert volume(inner) < 0.0
    assert open_sides(inner) == 128
    sharp, smooth = (primitives.revolution([(1.0, 0.0), (1.2, 1.0), (1.0, 2.0)], 8, crease_degrees=c) for c in (10.0, 90.0))
    assert len(np.unique(corners_of(sharp, "normals").reshape(-1, 3).round(5), axis=0)) == 16
    assert len(np.unique(corners_of(smooth, "normals").reshape(-1, 3).round(5), axis=0)) == 24


# --- extrusion ------------------------------------------------------------------------------------------------------------

TURN = np.arange(10) * np.pi / 5
STAR = np.stack([np.cos(TURN), np.sin(TURN)], axis=1) * np.where(np.arange(10) % 2, 2.0, 4.0)[:, None]
HOLES = [0.5 * STAR[::2] * 0.4 + (0.8, 0.0), 0.1 * STAR + (-0.8, 0.3), 0.1 * STAR[::-1] + (-0.6, -0.8)]


def test_prisms_have_the_area_of_their_outline():
    """Volume = area x depth, surface = 2 area + perimeter x depth, V - E + F = 2 - 2 holes, whichever way outlines turn."""
    for outline in (STAR, STAR[::-1]):
        for holes in ([], HOLES[:1], HOLES):
            mesh = primitives.extrusion(outline, 1.5, holes)
            flat = abs(signed_area(STAR)) - sum(abs(signed_area(hole)) for hole in holes)
            around = sum(np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1).sum() for ring in (STAR, *holes))
            assert volume(mesh) == pytest.approx(1.5 * flat, rel=1e-6)
            assert area(mesh) == pytest.approx(2 * flat + 1.5 * around, rel=1e-6)
            assert (open_sides(mesh), euler(mesh)) == (0, 2 - 2 * len(holes))
            assert_faces_outwards(mesh)
            n = corners_of(mesh, "normals")
            cross = crosses(mesh)[1]
            np.testing.assert_allclose(n[:, 0], cross / np.linalg.norm(cross, axis=1, keepdims=True), atol=1e-5)
    assert open_sides(primitives.extrusion(STAR, 1.0, HOLES, capped=False)) == 2 * (10 + 5 + 10 + 10)


def test_walls_of_round_outlines_are_smooth():
    circle = np.stack([np.cos(np.arange(48) * np.pi / 24), np.sin(np.arange(48) * np.pi / 24)], axis=1)
    mesh = primitives.extrusion(circle, 2.0)
    wall = np.abs(corners_of(mesh, "normals")[..., 2]) < 0.5
    p = mesh.positions[mesh.triangles]
    np.testing.assert_allclose(corners_of(mesh, "normals")[wall][:, :2], p[wall][:, :2], atol=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_outlines_are_covered_once(seed):
    """Random stars with random holes: triangles all counter-clockwise, their areas the outline's, every edge of it a side of one."""
    rng = np.random.default_rng(seed)

    def star(n: int, low: float, high: float) -> np.ndarray:
        angle = np.sort(rng.uniform(0, 2 * np.pi, n))
        return np.stack([np.cos(angle), np.sin(angle)], axis=1) * rng.uniform(low, high, n)[:, None]

    while True:  # stars with a gap of half a turn leave their middle
        try:
            places = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.2)])[: seed % 5]
            holes = [place + star(rng.integers(3, 9), 0.1, 0.45) for place in places]
            rings = oriented_outlines(star(rng.integers(12, 60), 2.5, 9.0), holes, "test")
            break
        except SceneError:
            continue
    triangles = triangulated(rings)
    p = np.concatenate(rings)
    a, b, c = (p[triangles[:, k]] for k in range(3))
    areas = ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])) / 2
    assert (areas > 0.0).all()
    assert areas.sum() == pytest.approx(sum(signed_area(ring) for ring in rings), rel=1e-9)
    assert len(triangles) == len(p) - 2 + 2 * (len(rings) - 1)
    sides = {(i, j) for t in triangles.tolist() for i, j in zip(t, t[1:] + t[:1], strict=True)}
    start = 0
    for ring in rings:
        assert all((start + k, start + (k + 1) % len(ring)) in sides for k in range(len(ring)))
        start += len(ring)


# --- tube -----------------------------------------------------------------------------------------------------------------


def knot(n: int) -> np.ndarray:
    s = 2 * np.pi * np.arange(n) / n
    return np.stack([np.sin(s) + 2 * np.sin(2 * s), np.cos(s) - 2 * np.cos(2 * s), -np.sin(3 * s)], axis=1)


@pytest.mark.parametrize(("caps", "chi", "gaps"), [("round", 2, 0), ("flat", 2, 0), ("none", 0, 64)])
def test_a_straight_tube_is_a_capsule_or_a_cylinder(caps, chi, gaps):
    mesh = primitives.tube([(0, 0, 0), (0, 0, 1), (0, 0, 1), (0, 0, 3)], 0.5, 32, caps)
    assert (euler(mesh), open_sides(mesh)) == (chi, gaps)
    assert_faces_outwards(mesh)
    sides = 32 / 2 * 0.25 * math.sin(2 * np.pi / 32)
    if caps == "flat":
        assert volume(mesh) == pytest.approx(3 * sides, rel=1e-6)
    if caps == "round":
        assert volume(mesh) == pytest.approx(3 * np.pi * 0.25 + 4 / 3 * np.pi * 0.125, rel=2e-2)
        np.testing.assert_allclose(mesh.bounds[:, 2], [-0.5, 3.5], atol=1e-6)


def test_a_closed_tube_comes_back_to_itself():
    """A knot is a torus: V - E + F = 0, volume length x area, and the frame turns as little over the last piece as over the others."""
    line = knot(240)
    mesh = primitives.tube(line, 0.2, 16, closed=True)
    assert (euler(mesh), open_sides(mesh), len(mesh.positions)) == (0, 0, 240 * 16)
    assert_faces_outwards(mesh)
    length = np.linalg.norm(line - np.roll(line, 1, axis=0), axis=1).sum()
    assert volume(mesh) == pytest.approx(length * 16 / 2 * 0.04 * math.sin(np.pi / 8), rel=1e-3)
    rings = mesh.positions.reshape(240, 16, 3).astype(np.float64)
    # Lines of one corner along the tube: none is longer than the curve's piece and its bend allow
    pieces = np.linalg.norm(np.roll(rings, -1, axis=0) - rings, axis=2)
    assert pieces[-1].max() / np.linalg.norm(line[0] - line[-1]) < 1.3
    assert np.ptp(corners_of(mesh, "uvs")[..., 0], axis=1).max() < 0.1


def test_frames_turn_less_than_the_helix_does():
    """On a helix the frame's side turns about the tangent by minus the torsion x length against the Frenet frame: not at all in space."""
    s = np.linspace(0.0, 4 * np.pi, 2001)
    r, h = 1.0, 0.5
    line = np.stack([r * np.cos(s), r * np.sin(s), h * s], axis=1)
    speed = math.hypot(r, h)
    tangents = np.stack([-r * np.sin(s), r * np.cos(s), np.full_like(s, h)], axis=1) / speed
    side, lift = rotation_minimizing_frames(line, tangents)
    np.testing.assert_allclose(np.cross(side, lift), tangents, atol=1e-9)
    normal = np.stack([-np.cos(s), -np.sin(s), np.zeros_like(s)], axis=1)
    binormal = np.cross(tangents, normal)
    angle = np.unwrap(np.arctan2((side * binormal).sum(axis=1), (side * normal).sum(axis=1)))
    torsion = h / (r * r + h * h)
    np.testing.assert_allclose(angle - angle[0], -torsion * speed * s, atol=1e-4)


def test_tubes_bend_without_narrowing_and_taper():
    """Round a right angle in the bisecting plane: every vertex at the radius from both pieces' axes; a taper's normals look ahead."""
    bent = primitives.tube([(-2, 0, 0), (0, 0, 0), (0, 2, 0)], 0.3, 24, "none")
    corner = bent.positions[24:48].astype(np.float64)
    np.testing.assert_allclose(np.hypot(corner[:, 1], corner[:, 2]), 0.3, atol=1e-6)
    np.testing.assert_allclose(np.hypot(corner[:, 0], corner[:, 2]), 0.3, atol=1e-6)
    taper = primitives.tube([(0, 0, 0), (1, 0, 0)], [0.5, 0.25], 24, "none")
    np.testing.assert_allclose(corners_of(taper, "normals")[..., 0], 0.25 / math.hypot(1.0, 0.25), atol=1e-6)


LINE = [(0, 0, 0), (1, 0, 0)]
SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: primitives.plane(0.0), "plane.size"),
        (lambda: primitives.plane((1.0, 2.0, 3.0)), "plane.size must be 2 lengths"),
        (lambda: primitives.plane(1.0, 0), "plane.n"),
        (lambda: primitives.plane(1.0, 10**6), "plane.n = 1000000 would make"),
        (lambda: primitives.heightfield([1.0, 2.0]), "heightfield.heights must have shape"),
        (lambda: primitives.heightfield([[1.0, math.nan], [0.0, 0.0]]), "row 0, column 1"),
        (lambda: primitives.heightfield(np.zeros((2, 2)), scale=math.inf), "heightfield.scale"),
        (lambda: primitives.revolution([(1.0, 0.0)]), "revolution.profile must have at least 2"),
        (lambda: primitives.revolution([(1.0, 0.0), (1.0, 0.0)]), "must be a line with a length"),
        (lambda: primitives.revolution([(0.0, 0.0), (0.0, 1.0)]), "away from the axis"),
        (lambda: primitives.revolution([(-1.0, 0.0), (1.0, 1.0)]), "must not cross the axis"),
        (lambda: primitives.revolution([(1.0, math.nan), (1.0, 1.0)]), "must be finite"),
        (lambda: primitives.revolution(LINE), "must have shape"),
        (lambda: primitives.revolution([(1, 0), (1, 1)], 2), "revolution.n must be at least 3"),
        (lambda: primitives.revolution([(1, 0), (1, 1)], crease_degrees=-1.0), "crease_degrees"),
        (lambda: primitives.extrusion(SQUARE[:2]), "extrusion.outline must have at least 3"),
        (lambda: primitives.extrusion([(0, 0), (1, 1), (2, 2)]), "must enclose an area"),
        (lambda: primitives.extrusion([(1, 1)] * 3), "must enclose an area"),
        (lambda: primitives.extrusion([(0, 0), (2, 2), (2, 0), (0, 2.5)]), "must not touch or cross"),
        (lambda: primitives.extrusion(SQUARE, 0.0), "extrusion.depth"),
        (lambda: primitives.extrusion(SQUARE, 1.0, [[(5, 5), (6, 5), (6, 6)]]), r"holes\[0\] must lie inside"),
        (lambda: primitives.extrusion(SQUARE, 1.0, [[(1, 1), (5, 1), (1, 2)]]), "must not touch or cross"),
        (lambda: primitives.extrusion(SQUARE, 1.0, [[(1, 1), (3, 1), (1, 3)], [(1.2, 1.2), (2, 1.2), (1.2, 2)]]), "inside another hole"),
        (lambda: primitives.extrusion(np.random.default_rng(0).random((5000, 2))), "more than 4096 corners"),
        (lambda: primitives.tube([(0, 0, 0)]), "tube.line must have at least 2"),
        (lambda: primitives.tube([(0, 0, 0)] * 3), "at least 2 distinct points"),
        (lambda: primitives.tube(LINE, closed=True), "at least 3 distinct points"),
        (lambda: primitives.tube([(0, 0, 0), (1, 0, 0), (0, 0, 0)]), "turn back on itself, as it does at point 1"),
        (lambda: primitives.tube(LINE, 0.0), "tube.radius must be positive"),
        (lambda: primitives.tube(LINE, [0.1, 0.1, 0.1]), "one per point"),
        (lambda: primitives.tube(LINE, 0.1, 2), "tube.n"),
        (lambda: primitives.tube(LINE, caps="square"), "tube.caps"),
    ],
)
def test_surfaces_that_are_none_are_refused(call, words):
    with pytest.raises(SceneError, match=words):
        call()
