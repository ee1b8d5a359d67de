"""Which triangles, edges and vertices touch: against a search one by one, and how long a million takes."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surfaces import brute_edges, heap, klein_bottle, large_torus, platonic_solids

from limner.errors import SceneError
from limner.mesh.adjacency import adjacency, adjacency_of_triangles, following, grouped_order, preceding
from limner.mesh.components import component_labels
from limner.mesh.mesh import Mesh
from limner.mesh.normals import vertex_normals
from limner.scene.digest import scene_digest
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape


@settings(max_examples=30)
@given(st.integers(0, 10_000), st.integers(1, 9), st.integers(0, 24))
def test_heaps_agree_with_a_search_one_by_one(seed, n_vertices, n_triangles):
    """Whatever triangles are thrown together: edges in order, half-edges of each, opposites, corners at each vertex."""
    mesh = heap(np.random.default_rng(seed), n_vertices, n_triangles)
    found, expected = adjacency(mesh), brute_edges(mesh.triangles)
    assert [tuple(edge) for edge in found.edges.tolist()] == list(expected)
    groups = np.split(found.edge_halfedges, found.edge_start[1:-1]) if expected else []
    assert [group.tolist() for group in groups] == list(expected.values())
    opposite, edge_of = np.full(mesh.triangles.size, -1), np.full(mesh.triangles.size, -1)
    for number, halfedges in enumerate(expected.values()):
        edge_of[halfedges] = number
        if len(halfedges) == 2:
            opposite[halfedges] = halfedges[::-1]
    np.testing.assert_array_equal(found.opposite, opposite)
    np.testing.assert_array_equal(found.triangle_edges.reshape(-1), edge_of)
    whole = np.repeat(np.array([len(set(row)) == 3 for row in mesh.triangles.tolist()], dtype=bool), 3)
    for vertex in range(n_vertices):
        corners = np.flatnonzero((mesh.triangles.reshape(-1) == vertex) & whole)
        np.testing.assert_array_equal(found.triangles_of_vertex(vertex), corners // 3)
    for number, halfedges in enumerate(expected.values()):
        np.testing.assert_array_equal(found.triangles_of_edge(number), np.array(halfedges) // 3)
        assert found.edge_triangles[number].tolist() == [h // 3 for h in [*halfedges, -3][:2]]


def test_around_a_vertex_and_back():
    """On closed oriented solids the next half-edge around a vertex leaves it, too, and as many steps as triangles lead home."""
    for mesh in platonic_solids().values():
        found = adjacency(mesh)
        start = mesh.triangles.reshape(-1)
        step = np.arange(mesh.triangles.size)
        np.testing.assert_array_equal(start[found.next_around], start)
        for count in range(1, int(found.vertex_counts.max()) + 1):
            step = found.next_around[step]
            home = found.vertex_counts[start] == count
            np.testing.assert_array_equal((step == np.arange(len(step)))[home], True)
        np.testing.assert_array_equal(following(preceding(step)), step)
    assert (adjacency(klein_bottle()).next_around < 0).any()


def test_nothing_and_nonsense():
    """No triangles, no vertices, collapsed triangles: empty arrays. An index out of range: one line. The caller's array stays writable."""
    for triangles, n in (([], 0), ([], 3), ([[1, 1, 2], [0, 0, 0]], 3)):
        found = adjacency_of_triangles(triangles, n)
        assert found.edges.shape == (0, 2)
        assert found.vertex_start.tolist() == [0] * (n + 1)
        assert (found.triangle_edges == -1).all()
    with pytest.raises(SceneError, match=r"index into 2 vertices, got 0\.\.2"):
        adjacency_of_triangles([[0, 1, 2]], 2)
    own = np.array([[0, 1, 2]], dtype=np.int32)
    found = adjacency_of_triangles(own, 3)
    own[0, 0] = 0
    with pytest.raises(ValueError, match="read-only"):
        found.edges[0] = 0


def test_keys_too_long_to_pack():
    """Keys that leave no room for numbers are sorted indirectly, with the same answer."""
    key = np.random.default_rng(0).integers(0, 50, 1000)
    for ours, theirs in zip(grouped_order(key, 6), grouped_order(key, 62), strict=True):
        np.testing.assert_array_equal(ours, theirs)


@settings(max_examples=30)
@given(st.integers(0, 10_000), st.integers(1, 40), st.integers(0, 40))
def test_components_of_any_graph(seed, n, k):
    """Labels are the least nodes of what a search from node to node reaches."""
    a, b = np.random.default_rng(seed).integers(0, n, (2, k))
    reach = np.eye(n, dtype=bool)
    reach[a, b] = reach[b, a] = True
    for middle in range(n):
        reach |= reach[:, middle : middle + 1] & reach[middle]
    np.testing.assert_array_equal(component_labels(n, a, b), reach.argmax(axis=1))


def test_a_long_chain_in_any_order():
    """A path of many nodes, numbered at random, is one component; rounds are few."""
    order = np.random.default_rng(3).permutation(100_000)
    assert not component_labels(len(order), order[:-1], order[1:]).any()


def test_many_triangles_in_no_order():
    """A torus of a hundred thousand: every edge between two, every vertex with a normal; `benchmarks/meshes.py` takes the time."""
    mesh = large_torus(500, 100)
    found = adjacency(mesh)
    assert len(found.edges) == 150_000
    assert (found.edge_counts == 2).all()
    normals = vertex_normals(mesh.positions, mesh.triangles)
    np.testing.assert_allclose(np.linalg.norm(normals[::100], axis=1), 1.0, atol=1e-6)


# --- attributes -----------------------------------------------------------------------------------------------------------

CORNER = {"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], "triangles": [[0, 1, 2], [1, 3, 2]]}


def test_attributes_of_vertices_edges_and_faces():
    """They are kept, read-only, one row for each; edges as adjacency numbers them; pickling keeps them, and so the digest."""
    mesh = Mesh(
        **CORNER, vertex_attributes={"heat": [1.0, 2.0, 3.0, 4.0]}, edge_attributes={"seam": np.arange(5) == 2},
        face_attributes={"part": np.zeros((2, 3, 2), np.int64)},
    )  # fmt: skip
    again = pickle.loads(pickle.dumps(mesh))
    for held in (mesh, again):
        assert held.vertex_attributes["heat"].tolist() == [1.0, 2.0, 3.0, 4.0]
        assert held.face_attributes["part"].shape == (2, 3, 2)
        assert adjacency(held).edges[held.edge_attributes["seam"]].tolist() == [[1, 2]]
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertex_attributes["heat"][0] = 0
    with pytest.raises(TypeError, match="cannot be changed"):
        mesh.vertex_attributes["heat"] = np.zeros(4)
    with pytest.raises(TypeError, match="cannot be changed"):
        mesh.vertex_attributes.update(heat=np.zeros(4))
    one, other = (scene_digest(Scene(Node(shapes=(Shape(held),)))) for held in (mesh, again))
    assert one == other
    assert Mesh(**CORNER, vertex_attributes={}).vertex_attributes is None


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        ({"vertex_attributes": {"a": [1, 2, 3]}}, r"mesh\.vertex_attributes\['a'\] must have one row per position \(4\), got shape \(3,\)"),
        ({"edge_attributes": {"a": np.zeros(6)}}, r"mesh\.edge_attributes\['a'\] must have one row per edge \(5\), got shape \(6,\)"),
        ({"face_attributes": {"a": 3.0}}, r"mesh\.face_attributes\['a'\] must have one row per triangle \(2\), got shape \(\)"),
        ({"face_attributes": {"a": ["x", "y"]}}, r"mesh\.face_attributes\['a'\] must be numbers or booleans, got <U1"),
        ({"face_attributes": {"a": [[1], [1, 2]]}}, r"mesh\.face_attributes\['a'\] must be an array"),
        ({"vertex_attributes": {3: np.zeros(4)}}, r"mesh\.vertex_attributes must have names that are strings, got 3"),
        ({"vertex_attributes": np.zeros(4)}, r"mesh\.vertex_attributes must map names to arrays, got ndarray"),
    ],
)
def test_attributes_that_do_not_fit(given, complaint):
    """One line that names the field."""
    with pytest.raises(SceneError, match=complaint):
        Mesh(**CORNER, **given)
