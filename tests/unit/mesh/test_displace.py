"""Displaced surfaces: where they are, that they stay closed, and that no more triangles are made than were allowed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.mesh.mesh import Mesh
from limner.mesh.projection import project_uvs
from limner.mesh.reshape.displace import displaced
from limner.mesh.reshape.refine import closed_marks, cut, longest_edges
from limner.mesh.shapes import primitives

Floats = NDArray[np.float64]

SQUARE = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], uvs=[[0, 0], [1, 0], [1, 1], [0, 1]])


def _waves(uvs: Floats, _points: Floats, _normals: Floats) -> Floats:
    return np.asarray(0.5 + 0.5 * np.sin(9.0 * uvs[:, 0]) * np.cos(7.0 * uvs[:, 1]))


def _one(uvs: Floats, _points: Floats, _normals: Floats) -> Floats:
    return np.ones(len(uvs))


def _from(eye: tuple[float, float, float], pixels: float = 150.0) -> Callable[[Floats, Floats], Floats]:
    """Edges in pixels, as an eye at a place sees them."""

    def length(a: Floats, b: Floats) -> Floats:
        distance = np.maximum(np.linalg.norm((a + b) / 2.0 - eye, axis=1), 0.05)
        return np.asarray(pixels * np.linalg.norm(b - a, axis=1) / distance)

    return length


def _edges(mesh: Mesh) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """(e, 2) edges and how many triangles each has."""
    t = mesh.triangles
    ends = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    return np.unique(ends, axis=0, return_counts=True)


def _area(mesh: Mesh) -> float:
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(float) for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def _split_at_uvs(mesh: Mesh) -> Mesh:
    """The same surface with a position for every pair of position and texture coordinate, as files often have it."""
    assert mesh.uvs is not None
    assert mesh.uv_triangles is not None
    pairs, index = np.unique(np.stack([mesh.triangles.ravel(), mesh.uv_triangles.ravel()], axis=1), axis=0, return_inverse=True)
    return Mesh(mesh.positions[pairs[:, 0]], index.reshape(-1, 3), uvs=mesh.uvs[pairs[:, 1]])


def test_a_plane_becomes_the_height_functions_graph() -> None:
    """z = scale (h(u, v) - midlevel) at every vertex, x = u and y = v; edges are as short as was asked; normals are the graph's."""
    made = displaced(SQUARE, _waves, scale=0.2, midlevel=0.25, longest_edge=0.02).mesh
    x, y, z = made.positions.T.astype(float)
    np.testing.assert_allclose(z, 0.2 * (0.25 + 0.5 * np.sin(9 * x) * np.cos(7 * y)), atol=1e-6)
    ends, counts = _edges(made)
    flat = made.positions[ends][..., :2]
    assert np.linalg.norm(flat[:, 0] - flat[:, 1], axis=1).max() <= 0.02 + 1e-6
    assert set(np.unique(counts)) == {1, 2}
    slope = 0.1 * np.stack([9 * np.cos(9 * x) * np.cos(7 * y), -7 * np.sin(9 * x) * np.sin(7 * y)], axis=1)
    normal = np.concatenate([-slope, np.ones((len(x), 1))], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    inside = (np.minimum(x, y) > 0.03) & (np.maximum(x, y) < 0.97)
    assert made.normals is not None
    assert (made.normals * normal).sum(axis=1)[inside].min() > np.cos(np.radians(1.5))


def test_more_triangles_where_the_height_changes() -> None:
    """A flat half stays as coarse as asked, a wavy half is finer; but no edge is split below an eighth of the limit."""

    def half(uvs: Floats, _points: Floats, _normals: Floats) -> Floats:
        return np.where(uvs[:, 0] > 0.5, np.sin(60.0 * uvs[:, 0]) - np.sin(30.0), 0.0)

    made = displaced(SQUARE, half, scale=0.05, longest_edge=0.1).mesh
    middle = made.positions[made.triangles].mean(axis=1)[:, 0]
    assert (middle < 0.4).sum() * 5 < (middle > 0.6).sum()
    ends, _ = _edges(made)
    flat = made.positions[ends][..., :2]
    assert np.linalg.norm(flat[:, 0] - flat[:, 1], axis=1).min() > 0.1 / 8


def test_a_sphere_moved_by_a_constant_is_a_larger_sphere() -> None:
    """Radius 1 + 0.3, with the points between the mesh's put onto the sphere first; normals point away from the middle."""
    made = displaced(primitives.sphere(1.0, 8), _one, scale=0.3, longest_edge=0.1, onto=lambda _, normal: normal).mesh
    radius = np.linalg.norm(made.positions, axis=1)
    np.testing.assert_allclose(radius, 1.3, atol=1e-6)
    assert made.normals is not None
    assert (made.normals * made.positions / radius[:, None]).sum(axis=1).min() > np.cos(np.radians(2.0))


@pytest.mark.parametrize("eye", [(8.0, 1.0, 0.0), (2.0, 0.5, 0.3), (1.05, 0.0, 0.0)], ids=["far", "near", "touching"])
@pytest.mark.parametrize(
    ("mesh", "euler"),
    [
        (primitives.sphere(1.0, 6), 2),
        (primitives.torus(1.0, 0.4, 12, 6), 0),
        (primitives.box((1.0, 1.0, 1.0)), 2),
        (_split_at_uvs(project_uvs(primitives.sphere(1.0, 6), "sphere")), 2),
    ],
    ids=["sphere", "torus", "box", "split at its seams"],
)
def test_what_is_closed_stays_closed(mesh: Mesh, euler: int, eye: tuple[float, float, float]) -> None:
    """Every edge has two triangles, once in each direction, at any distance, across seams and creases; V - E + F is what it was."""
    made = displaced(mesh, _waves, scale=0.2, longest_edge=6.0, length=_from(eye), max_triangles=15_000).mesh
    t = made.triangles
    directed = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    ends, counts = _edges(made)
    assert (counts == 2).all()
    assert len(np.unique(directed, axis=0)) == len(directed)
    assert len(made.positions) - len(ends) + len(t) == euler
    assert len(t) > len(mesh.triangles)


def test_no_slivers() -> None:
    """However uneven the heights, triangles keep their shape (Rivara's bound: half the least angle), since longest edges go first."""
    rng = np.random.default_rng(5)
    table = rng.random((64, 64))

    def noise(uvs: Floats, _points: Floats, _normals: Floats) -> Floats:
        return table[(uvs[:, 1] * 63).astype(int), (uvs[:, 0] * 63).astype(int)]

    made = displaced(SQUARE, noise, scale=0.02, longest_edge=0.1, max_triangles=20_000).mesh
    corners = made.positions[made.triangles][..., :2].astype(float)
    sides = np.roll(corners, -1, axis=1) - corners
    length = np.linalg.norm(sides, axis=2)
    cosine = -(sides * np.roll(sides, 1, axis=1)).sum(axis=2) / (length * np.roll(length, 1, axis=1))
    assert np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))).min() > 22.4


@pytest.mark.parametrize("most", [2, 50, 3000])
def test_the_number_of_triangles_is_bounded(most: int) -> None:
    """Never more than were allowed, nearly as many as were, and the longest edge that was left is told."""
    made, longest = displaced(SQUARE, _waves, scale=0.2, longest_edge=0.001, max_triangles=most)
    assert 0.6 * most <= len(made.triangles) <= most
    ends, _ = _edges(made)
    flat = made.positions[ends][..., :2]
    # Of edges that were asked in the last round; older ones are not longer.
    assert np.linalg.norm(flat[:, 0] - flat[:, 1], axis=1).max() <= max(longest, 1.5) * (1.0 + 1e-6)
    assert longest > 0.001


def test_seams_move_by_the_mean_of_their_heights() -> None:
    """A height that is 0 at the left end of the texture and 1 at its right moves the seam by 1/2, and both sides to one place."""
    mesh = primitives.cylinder(1.0, 2.0, 16, capped=False)
    made = displaced(mesh, lambda uvs, *_: np.where(uvs[:, 0] > 1.0 - 1e-9, 1.0, 0.0), scale=1.0, longest_edge=0.2).mesh
    radius = np.hypot(made.positions[:, 0], made.positions[:, 2])
    assert radius.max() == pytest.approx(1.5)
    assert (np.unique(made.positions, axis=0, return_counts=True)[1] == 1).all()


def test_attributes_go_along() -> None:
    """Texture coordinates of both sets, colours and materials are those of the point of the flat mesh."""
    mesh = Mesh(
        SQUARE.positions, SQUARE.triangles, uvs=SQUARE.uvs, uvs1=1.0 - np.asarray(SQUARE.uvs),
        colors=[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], triangle_materials=[0, 1],
    )  # fmt: skip
    made = displaced(mesh, _waves, scale=0.0, longest_edge=0.1).mesh
    assert made.uvs is not None
    assert made.uvs1 is not None
    assert made.uv_triangles is not None
    assert made.colors is not None
    assert made.triangle_materials is not None
    corners = made.positions[made.triangles]
    np.testing.assert_allclose(made.uvs[made.uv_triangles], corners[..., :2], atol=1e-6)
    np.testing.assert_allclose(made.uvs1[made.uv_triangles], 1.0 - corners[..., :2], atol=1e-6)
    np.testing.assert_allclose(made.colors[:, :2], made.positions[:, :2], atol=1e-6)
    middle = corners.mean(axis=1)
    assert (made.triangle_materials == (middle[:, 1] > middle[:, 0])).all()


def test_equal_positions_of_different_colour_stay_together() -> None:
    """Colours may break where the surface must not: both sides move alike."""
    positions = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0], [1, 1, 0], [0, 1, 0]]
    mesh = Mesh(positions, [[0, 1, 2], [3, 4, 5]], colors=[[1, 0, 0]] * 3 + [[0, 0, 1]] * 3)
    made = displaced(mesh, lambda _, p, __: p[:, 0] * p[:, 1], scale=0.5, longest_edge=0.2).mesh
    np.testing.assert_allclose(made.positions[:, 2], 0.5 * made.positions[:, 0] * made.positions[:, 1], atol=1e-6)
    assert made.colors is not None
    assert set(map(tuple, np.unique(made.colors, axis=0))) == {(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)}


def test_degenerate_triangles_do_no_harm() -> None:
    """No NaN, and no end without an end, for triangles without area, points without normals, and meshes without triangles."""
    mesh = Mesh([[0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 0, 0], [0, 2, 3]], uvs=[[np.nan, 0]] * 4)
    made = displaced(mesh, _waves, scale=0.1, longest_edge=0.1).mesh
    for values in (made.positions, made.normals, made.uvs):
        assert np.isfinite(np.asarray(values)).all()
    empty = displaced(Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int)), _waves, scale=0.1, longest_edge=0.1)
    assert len(empty.mesh.triangles) == 0


def test_pieces_cover_their_triangle() -> None:
    """For every pattern of split edges the pieces have the triangle's orientation, and its area together; shared edges have one number."""
    points = np.array([[0.0, 0.0], [1.0, 0.2], [0.3, 0.9]])
    six = np.concatenate([points, (points + points[[1, 2, 0]]) / 2.0])
    for pattern in range(8):
        for longest in range(3):
            split = np.array([[(pattern >> k) & 1 for k in range(3)]], dtype=bool)
            made = cut(split, np.array([longest]))
            a, b = six[made.corner[:, 1]] - six[made.corner[:, 0]], six[made.corner[:, 2]] - six[made.corner[:, 0]]
            areas = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2.0
            assert areas.min() > 0.0
            assert areas.sum() == pytest.approx(0.42)
            _, counts = np.unique(made.edge[made.edge >= 9], return_counts=True)
            assert (counts == 2).all()


def test_marks_reach_the_longest_edge() -> None:
    """A chain of triangles, each shorter than the next: marking the first marks the longest of all."""
    edges = np.array([[0, 1, 2], [2, 3, 4], [4, 5, 6]])
    length = np.arange(7.0)
    longest = edges[np.arange(3), longest_edges(edges, length)]
    assert longest.tolist() == [2, 4, 6]
    assert np.flatnonzero(closed_marks(length == 0.0, edges, longest)).tolist() == [0, 2, 4, 6]
    assert longest_edges(np.array([[3, 5, 4]]), np.ones(6)).tolist() == [1]
