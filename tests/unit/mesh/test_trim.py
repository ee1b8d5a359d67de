"""Surfaces cut where an answer changes, and surfaces of implicit functions: areas, volumes, topology."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.mesh.implicit.level_set import level_set
from limner.mesh.mesh import Mesh
from limner.mesh.reshape.trim import Surface, joined, refined, surface_of, trimmed
from limner.mesh.shapes import primitives

EVERYWHERE = np.array([[-9.0, -9.0, -9.0], [9.0, 9.0, 9.0]])


def _area(surface: Surface) -> float:
    p = surface.corners[surface.triangles, :3]
    return float(np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum() / 2)


def _euler(n_positions: int, triangles: NDArray[np.integer]) -> int:
    edges = np.unique(np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1), axis=0)
    return n_positions - len(edges) + len(triangles)


@pytest.mark.parametrize("mesh", [primitives.box((1, 2, 3)), primitives.sphere(1.0, 6), primitives.cone()], ids=["box", "sphere", "cone"])
def test_refining_keeps_the_surface(mesh: Mesh) -> None:
    """No edge is longer than asked, the area is the same, and where nothing gaped nothing gapes."""
    whole = surface_of(mesh)
    fine = refined(whole, 0.11, EVERYWHERE)
    p = fine.corners[fine.triangles, :3]
    assert np.linalg.norm(p - np.roll(p, 1, axis=1), axis=2).max() <= 0.11
    np.testing.assert_allclose(_area(fine), _area(whole), rtol=1e-12)
    points, place = np.unique(fine.corners[:, :3].round(9) + 0.0, axis=0, return_inverse=True)
    assert _euler(len(points), place.reshape(-1)[fine.triangles]) == 2


def test_what_lies_beyond_a_box_is_left_out() -> None:
    """Half of a box's triangles, and those that touch it."""
    fine = refined(surface_of(primitives.box(2.0)), 0.1, np.array([[0.0, -2, -2], [2, 2, 2]]))
    assert fine.corners[fine.triangles, 0].max(axis=1).min() >= -1e-5
    assert 12.0 <= _area(fine) < 12.0 + 4 * 2 * 0.1


def test_a_circle_cut_out_of_a_square() -> None:
    """Along edges that are found to 1e-6: the area is that of a polygon in the circle; kept and dropped make up the whole."""
    square = refined(surface_of(primitives.quad([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]])), 0.05, EVERYWHERE)
    disk = trimmed(square, lambda corners: np.hypot(corners[:, 0], corners[:, 2]) < 0.8)
    rest = trimmed(square, lambda corners: np.hypot(corners[:, 0], corners[:, 2]) >= 0.8)
    np.testing.assert_allclose(_area(disk), np.pi * 0.64, rtol=2e-3)
    np.testing.assert_allclose(_area(disk) + _area(rest), 4.0, rtol=1e-5)
    rim = np.setdiff1d(np.arange(len(disk.corners)), np.arange(len(square.corners)))
    np.testing.assert_allclose(np.hypot(disk.corners[rim, 0], disk.corners[rim, 2]), 0.8, atol=1e-6)
    # Texture coordinates are cut where positions are
    np.testing.assert_allclose(disk.corners[rim, 6:], disk.corners[rim][:, [0, 2]] * (0.5, -0.5) + 0.5, atol=1e-6)
    mesh = joined([disk, rest]).mesh(np.repeat(np.int32([0, 1]), [len(disk.triangles), len(rest.triangles)]))
    assert mesh.triangle_materials is not None
    np.testing.assert_array_equal(np.unique(mesh.triangles), np.arange(len(mesh.positions)))
    np.testing.assert_allclose(mesh.normals, [[0, 1, 0]] * len(mesh.positions), atol=1e-6)


def test_nothing_and_everything() -> None:
    """What belongs nowhere leaves nothing; what belongs everywhere is left alone."""
    whole = surface_of(primitives.box(1.0))
    assert len(trimmed(whole, lambda corners: np.zeros(len(corners), dtype=bool)).triangles) == 0
    assert len(trimmed(whole, lambda corners: np.ones(len(corners), dtype=bool)).triangles) == 12
    assert len(refined(joined([]), 0.1, EVERYWHERE).triangles) == 0


@pytest.mark.parametrize(
    ("f", "euler", "volume"),
    [
        (lambda p: np.linalg.norm(p, axis=1) - 1.0, 2, 4 / 3 * np.pi),
        (lambda p: np.hypot(np.hypot(p[:, 0], p[:, 2]) - 1.0, p[:, 1]) - 0.4, 0, 2 * np.pi**2 * 0.16),
        (lambda p: np.abs(p).sum(axis=1) - 1.2, 2, 4 / 3 * 1.2**3),
    ],
    ids=["sphere", "torus", "octahedron"],
)
def test_level_sets_are_closed_and_hold_their_volume(f, euler: int, volume: float) -> None:  # type: ignore[no-untyped-def]
    """Every edge has two triangles, V - E + F is that of the shape, all triangles look outwards, and every vertex lies on it."""
    positions, triangles = level_set(f, (-1.6, -1.5, -1.7), (1.5, 1.7, 1.6), 40)
    pairs = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    assert (np.unique(pairs, axis=0, return_counts=True)[1] == 2).all()
    assert _euler(len(positions), triangles) == euler
    p = positions[triangles]
    np.testing.assert_allclose(np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6, volume, rtol=0.01)
    np.testing.assert_allclose(f(positions), 0.0, atol=1e-3)  # where f has a kink; elsewhere
    assert np.median(np.abs(f(positions))) < 1e-9
    n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    outwards = f(p.mean(axis=1) + 0.05 * n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-12))
    assert (outwards[np.linalg.norm(n, axis=1) > 1e-6] > 0.0).mean() > 0.999


def test_a_box_without_surface_has_none() -> None:
    """All inside, or all outside."""
    for sign in (1.0, -1.0):
        positions, triangles = level_set(lambda p, sign=sign: np.full(len(p), sign), (0, 0, 0), (1, 1, 1), 3)
        assert positions.shape == (0, 3)
        assert triangles.shape == (0, 3)
