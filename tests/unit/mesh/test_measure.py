"""Lengths, angles, areas, volumes, centres and inertia: closed forms, and laws of motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surfaces import GOLDEN, bow_tie, klein_bottle, open_cylinder, plate, platonic_solids, shuffled

from limner.errors import SceneError
from limner.mesh.adjacency import adjacency
from limner.mesh.examine.measure import (
    area,
    centroid,
    corner_angles,
    dihedral_angles,
    edge_lengths,
    inertia,
    signed_volume,
    solid_centroid,
    summary,
    triangle_areas,
    volume,
)
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives

# dihedral angle, area and volume for unit edges: H. S. M. Coxeter, Regular Polytopes, 1973, table I
SOLIDS = {
    "tetrahedron": (math.acos(1 / 3), math.sqrt(3), math.sqrt(2) / 12),
    "cube": (math.pi / 2, 6.0, 1.0),
    "octahedron": (math.acos(-1 / 3), 2 * math.sqrt(3), math.sqrt(2) / 3),
    "dodecahedron": (math.acos(-1 / math.sqrt(5)), 3 * math.sqrt(25 + 10 * math.sqrt(5)), (15 + 7 * math.sqrt(5)) / 4),
    "icosahedron": (math.acos(-math.sqrt(5) / 3), 5 * math.sqrt(3), 5 * GOLDEN**2 / 6),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_platonic_solids(name):
    """Area, volume and dihedral angles are those of the books; flat edges inside a face turn by nothing."""
    mesh = platonic_solids()[name]
    angle, surface, content = SOLIDS[name]
    found = dihedral_angles(mesh)
    edge = float(edge_lengths(mesh)[np.abs(found - angle) < 1e-3].mean())
    np.testing.assert_allclose(np.minimum(np.abs(found - angle), np.abs(found - math.pi)), 0.0, atol=1e-6)
    assert np.count_nonzero(np.abs(found - angle) < 1e-6) == {"tetrahedron": 6, "cube": 12, "octahedron": 12}.get(name, 30)
    assert area(mesh) == pytest.approx(surface * edge**2, rel=1e-6)
    assert volume(mesh) == pytest.approx(content * edge**3, rel=1e-6)
    np.testing.assert_allclose(corner_angles(mesh).sum(axis=1), math.pi, rtol=1e-12)


@settings(max_examples=20)
@given(st.integers(0, 10_000))
def test_moving_a_solid(seed):
    """A box of known inertia, turned, scaled and carried off: area, volume, both centroids and the tensor follow."""
    rng = np.random.default_rng(seed)
    size, scale, offset = rng.uniform(0.5, 2.0, 3), rng.uniform(0.5, 2.0), rng.uniform(-5, 5, 3)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    box = primitives.box(size)
    moved = Mesh(scale * box.positions @ turn.T + offset, box.triangles)
    content = float(np.prod(size))
    assert volume(moved) == pytest.approx(scale**3 * content, rel=1e-5)
    assert area(moved) == pytest.approx(scale**2 * 2 * (size * np.roll(size, 1)).sum(), rel=1e-5)
    np.testing.assert_allclose(centroid(moved), offset, atol=1e-5)
    np.testing.assert_allclose(solid_centroid(moved), offset, atol=1e-5)
    tensor = scale**5 * content / 12 * np.diag((size**2).sum() - size**2)
    np.testing.assert_allclose(inertia(moved), turn @ tensor @ turn.T, rtol=1e-4, atol=1e-4)


def test_inside_out_and_valleys():
    """Turned over, the volume is negative and each angle what is missing to a full turn; the plate's holes have edges in valleys."""
    mesh = plate(1)
    over = Mesh(mesh.positions, mesh.triangles[:, ::-1])
    assert volume(over) == -volume(mesh)
    assert volume(mesh) == pytest.approx(8.0)
    # The edges are the same ones: both number them by their vertices.
    np.testing.assert_allclose(dihedral_angles(over), 2 * math.pi - dihedral_angles(mesh), rtol=1e-12)
    assert np.count_nonzero(np.isclose(dihedral_angles(mesh), 1.5 * math.pi)) == 4
    np.testing.assert_allclose(solid_centroid(over), solid_centroid(mesh), atol=1e-12)


def test_a_sphere_converges():
    """Area, volume and inertia of finer and finer spheres tend to the round one's as the square of the edge."""
    for n in (16, 32):
        ball = primitives.sphere(2.0, n)
        assert area(ball) == pytest.approx(16 * math.pi, rel=2.5 / n**2)
        assert volume(ball) == pytest.approx(32 * math.pi / 3, rel=5 / n**2)
        np.testing.assert_allclose(inertia(ball), 0.4 * 4 * volume(ball) * np.eye(3), rtol=5 / n**2, atol=1e-6)


def test_what_has_no_measure():
    """A volume of what is open or disagrees with itself, a centre of nothing: one line. Angles at such edges are NaN."""
    with pytest.raises(SceneError, match="volume needs a closed surface: 14 of its edges"):
        volume(open_cylinder())
    with pytest.raises(SceneError, match="consistently oriented surface: triangles disagree at 6 edges"):
        volume(klein_bottle())
    with pytest.raises(SceneError, match="needs triangles with an area"):
        centroid(Mesh([[0, 0, 0]], [[0, 0, 0]]))
    back = Mesh(bow_tie().positions, [[0, 2, 1], [0, 1, 2]])
    with pytest.raises(SceneError, match="encloses nothing"):
        solid_centroid(back)
    assert signed_volume(Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))) == 0.0
    assert np.isnan(dihedral_angles(bow_tie())).all()
    twisted = shuffled(plate(1), np.random.default_rng(0))
    assert np.isnan(dihedral_angles(twisted)).sum() > 0
    flat = Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], [[0, 1, 2], [1, 0, 3]])
    assert np.isnan(dihedral_angles(flat)).all()
    assert triangle_areas(flat).tolist() == [0.0, 0.5]
    assert corner_angles(flat)[0].tolist() == [0.0, 0.0, 0.0]


def test_summary_of_anything():
    """Every fact of a box; of an open surface no volume, of nothing no bounds."""
    facts = summary(primitives.box((1, 2, 3)))
    assert (facts["volume"], facts["area"], facts["genus"], facts["closed"]) == (6.0, 22.0, 0, True)
    assert facts["bounds"] == [[-0.5, -1.0, -1.5], [0.5, 1.0, 1.5]]
    assert facts["carries"] == ["normals", "uvs"]
    assert summary(open_cylinder())["volume"] is None
    empty = summary(Mesh([[0, 0, 0]], np.zeros((0, 3), int), vertex_attributes={"a": [1]}))
    assert (empty["bounds"], empty["centroid"], empty["closed"], empty["carries"]) == (None, None, False, ["vertex_attributes: a"])
    assert len(edge_lengths(primitives.box())) == len(adjacency(primitives.box()).edges)
