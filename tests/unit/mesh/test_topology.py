"""What kind of surface a mesh is: verdicts on surfaces that are known, and what stands in the way, by name."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surfaces import (
    bow_tie,
    fin,
    heap,
    klein_bottle,
    large_torus,
    moebius_strip,
    open_cylinder,
    plate,
    platonic_solids,
    shuffled,
    split_apart,
    voxels,
)

from limner.errors import SceneError
from limner.mesh.adjacency import adjacency
from limner.mesh.examine import topology
from limner.mesh.examine.defects import (
    degenerate_triangles,
    duplicate_triangles,
    duplicate_vertices,
    linked_within,
    near_pairs,
    t_junctions,
)
from limner.mesh.examine.report import topology_report
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives

MESHES = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "meshes"

# manifold, with boundary, oriented, orientable, Euler characteristic, boundary loops, pieces
VERDICTS = {
    **{name: (mesh, True, True, True, True, 2, 0, 1) for name, mesh in platonic_solids().items()},
    "torus": (plate(1), True, True, True, True, 0, 0, 1),
    "double torus": (plate(2), True, True, True, True, -2, 0, 1),
    "cylinder": (open_cylinder(), False, True, True, True, 0, 2, 1),
    "disk": (primitives.disk(), False, True, True, True, 1, 1, 1),
    "Moebius strip": (moebius_strip(), False, True, False, False, 0, 1, 1),
    "Klein bottle": (klein_bottle(), True, True, False, False, 0, 0, 1),
    "bow-tie": (bow_tie(), False, False, True, True, 1, 2, 2),
    "fin": (fin(), False, False, True, True, 1, 0, 1),
    "cubes at a corner": (voxels((0, 0, 0), (1, 1, 1)), False, False, True, True, 3, 0, 2),
    "cubes at an edge": (voxels((0, 0, 0), (1, 1, 0)), False, False, True, True, 3, 0, 1),
    "empty": (Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)), True, True, True, True, 0, 0, 0),
    "turned over": (shuffled(plate(1), np.random.default_rng(5)), True, True, False, True, 0, 0, 1),
}


@pytest.mark.parametrize("name", VERDICTS)
def test_verdicts(name):
    """All verdicts on a surface, one by one and in the report."""
    mesh, manifold, bounded, oriented, orientable, characteristic, n_loops, n_pieces = VERDICTS[name]
    found = adjacency(mesh)
    for surface in (mesh, found):
        assert topology.is_manifold(surface) is manifold
        assert topology.is_manifold_with_boundary(surface) is bounded
        assert topology.is_consistently_oriented(surface) is oriented
        assert topology.is_orientable(surface) is orientable
        assert topology.euler_characteristic(surface) == characteristic
        assert len(topology.boundary_loops(surface)) == n_loops
        assert topology.components(surface).max(initial=-1) + 1 == n_pieces
    report = topology_report(mesh)
    assert (report.is_manifold, report.is_manifold_with_boundary, report.is_consistently_oriented) == (manifold, bounded, oriented)
    assert (report.euler_characteristic, len(report.boundary_loop_lengths), report.n_components) == (characteristic, n_loops, n_pieces)
    assert report.is_sound is (bounded and oriented)
    assert json.loads(json.dumps(report.as_dict(), allow_nan=False))["is_sound"] is report.is_sound


def test_handles_and_cross_caps():
    """Genus 0, 1, 2, 5 by Euler; the sum over pieces; one cross-cap for a Möbius strip, two for a Klein bottle; else a clear refusal."""
    assert [topology.genus(mesh) for mesh in (primitives.box(), primitives.torus(), plate(2), plate(5), open_cylinder())] == [0, 1, 2, 5, 0]
    assert topology.genus(voxels((0, 0, 0), (2, 0, 0), (4, 4, 4))) == 0
    assert [topology.cross_caps(mesh) for mesh in (moebius_strip(), klein_bottle())] == [1, 2]
    with pytest.raises(SceneError, match="genus needs a manifold"):
        topology.genus(fin())
    with pytest.raises(SceneError, match="one side only"):
        topology.genus(klein_bottle())
    with pytest.raises(SceneError, match="cannot be oriented"):
        topology.cross_caps(primitives.box())


def test_offenders_are_named():
    """The edge of the fin, the middle of the bow-tie, the edges where a triangle was turned over, duplicates and what is left out."""
    assert topology_report(fin()).non_manifold_edges == ((0, 1),)
    assert topology_report(bow_tie()).bow_tie_vertices == (2,)
    assert topology_report(voxels((0, 0, 0), (1, 1, 1))).bow_tie_vertices == (7,)
    cube = platonic_solids()["cube"]
    corners = cube.triangles[4]
    turned = cube.triangles.copy()
    turned[4] = corners[::-1]
    sides = sorted(tuple(sorted((int(corners[k - 1]), int(corners[k])))) for k in range(3))
    assert list(topology_report(Mesh(cube.positions, turned)).inconsistent_edges) == sides
    messy = Mesh(
        np.concatenate([cube.positions, cube.positions[:1], [[9, 9, 9]]]),
        np.concatenate([cube.triangles, cube.triangles[3:4, ::-1], [[1, 1, 2], [8, 1, 0]]]),
    )
    report = topology_report(messy)
    assert report.duplicate_triangles == (12,)
    assert report.degenerate_triangles == (13, 14)
    assert report.duplicate_vertices == (8,)
    assert report.unused_vertices == (9,)
    assert "1 duplicate triangle: 12" in str(report)
    assert "2 triangles without area: 13, 14" in str(report)
    assert "1 vertex of no triangle: 9" in str(report)


def test_t_junctions():
    """Vertices on the edge of the large triangle, in order along it; by the tolerance; none at its ends, nor where neighbours fit."""
    positions = [[0, 0, 0], [3, 0, 0], [1.5, 2, 0], [1, 0, 0], [2, 1e-8, 0], [1.5, -1, 0]]
    mesh = Mesh(positions, [[0, 1, 2], [0, 5, 3], [3, 5, 4], [4, 5, 1]])
    assert topology_report(mesh).t_junctions == ((3, (0, 1)), (4, (0, 1)))
    assert "2 T-junctions: 3 on 0-1, 4 on 0-1" in str(topology_report(mesh))
    lifted = Mesh(np.array(positions) + np.array([[0, 0, 0]] * 3 + [[0, 0, 0.01]] + [[0, 0, 0]] * 2), mesh.triangles)
    assert t_junctions(lifted)[:, 0].tolist() == [4]
    assert t_junctions(lifted, 0.02)[:, 0].tolist() == [3, 4]
    assert not len(t_junctions(split_apart(primitives.torus())))
    assert not len(t_junctions(primitives.box()))


@settings(max_examples=20)
@given(st.integers(0, 10_000))
def test_t_junctions_agree_with_a_search_one_by_one(seed):
    """Triangles on a small lattice, so that many corners lie on many edges: all pairs of a boundary vertex and edge are tried."""
    rng = np.random.default_rng(seed)
    mesh = heap(rng, 12, 8, scale=4)
    found = adjacency(mesh)
    boundary = found.boundary_halfedges
    start, end = found.ends(boundary)
    expected = set()
    points = mesh.positions.astype(float)
    candidates = {tuple(points[v]): int(v) for v in sorted({*start.tolist(), *end.tolist()}, reverse=True)}
    for halfedge, a, b in zip(boundary.tolist(), points[start], points[end], strict=True):
        squared = (b - a) @ (b - a)
        for place, vertex in candidates.items():
            p = np.array(place)
            inside = squared > 0 and 0 < (p - a) @ (b - a) < squared and np.linalg.norm(np.cross(p - a, b - a)) < 1e-9
            if inside and vertex not in mesh.triangles[halfedge // 3]:
                expected.add((vertex, halfedge))
    assert {tuple(row) for row in t_junctions(mesh).tolist()} == expected


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.integers(1, 8), st.integers(0, 16))
def test_heaps_agree_with_searches_one_by_one(seed, n_vertices, n_triangles):
    """Fans around each vertex, duplicates, and loops whose edges are just the boundary's where the surface is a manifold."""
    mesh = heap(np.random.default_rng(seed), n_vertices, n_triangles)
    found = adjacency(mesh)
    whole = [set(row) if len(set(row)) == 3 else set() for row in mesh.triangles.tolist()]
    bow_ties = []
    for vertex in range(n_vertices):
        around = [corners - {vertex} for corners in whole if vertex in corners]
        while around and (joined := [other for other in around[1:] if other & around[0]]):
            around = [around[0].union(*joined), *(other for other in around[1:] if not other & around[0])]
        bow_ties += [vertex] * (len(around) > 1)
    assert topology.bow_tie_vertices(found).tolist() == bow_ties
    again = [k for k, corners in enumerate(whole) if corners and corners in whole[:k]]
    assert duplicate_triangles(found).tolist() == again
    loops = topology.boundary_loops(found)
    walked = [tuple(sorted(pair)) for loop in loops for pair in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True)]
    boundary = [tuple(edge) for edge in found.edges[found.edge_counts == 1].tolist()]
    assert len(set(walked)) == len(walked)
    assert set(walked) <= set(boundary)
    if topology.is_manifold_with_boundary(found):
        assert len(walked) == len(boundary)
    flips, one_sided = topology.orientation_flips(found)
    turned = np.where(flips[:, None], mesh.triangles[:, ::-1], mesh.triangles)
    if not len(one_sided):
        assert topology.is_consistently_oriented(Mesh(mesh.positions, turned))
    json.dumps(topology_report(mesh).as_dict(), allow_nan=False)


def test_loops_keep_to_their_fan():
    """Two holes that touch in one vertex are two loops, not an eight; their direction is that of the triangles."""
    sheet = primitives.quad([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    assert [loop.tolist() for loop in topology.boundary_loops(sheet)] == [[0, 1, 2, 3]]
    assert sorted(sorted(loop.tolist()) for loop in topology.boundary_loops(bow_tie())) == [[0, 1, 2], [2, 3, 4]]


def test_nearness():
    """Clusters by distance, in chains, against all pairs; vertices in one place, 0 being -0; a senseless radius is refused."""
    points = np.random.default_rng(2).random((60, 3)).astype(np.float32)
    near = np.linalg.norm(points.astype(float)[:, None] - points.astype(float), axis=2) <= 0.15
    for middle in range(60):
        near |= near[:, middle : middle + 1] & near[middle]
    np.testing.assert_array_equal(linked_within(points, 0.15), near.argmax(axis=1))
    assert duplicate_vertices(Mesh([[0, 0, 1], [-0.0, 0, 1], [0, 0, 2]], np.zeros((0, 3), int))).tolist() == [1]
    crowd = np.random.default_rng(2).random((60_000, 3))
    with pytest.raises(SceneError, match="too large"):
        sum(1 for _ in near_pairs(crowd, crowd, 2.0))


def test_a_sliver_is_degenerate_and_a_needle_is_not():
    """Three points on a line have no area, even off the axes; a long thin triangle has one."""
    points = np.array([[0, 0, 0], [1, 2, 3], [3, 6, 9], [0, 1e-4, 0], [1, 0, 0]], dtype=np.float32)
    assert degenerate_triangles(Mesh(points, [[0, 1, 2], [0, 4, 3], [1, 1, 2]])).tolist() == [0, 2]


# pieces, Euler characteristic, genus, boundary loops, closed; faults
SCANS = {
    "cow": (1, 1, None, 0, True, {"bow_tie_vertices": (253,)}),
    "fandisk": (1, 2, 0, 0, True, {}),
    "nefertiti": (1, 2, 0, 0, True, {}),
    "rocker-arm": (1, 0, 1, 0, True, {}),
    "spot": (1, 2, 0, 0, True, {}),
    "stanford-bunny": (1, -3, 0, 5, False, {}),
    "suzanne": (3, 3, None, 4, False, {"non_manifold_edges": ((70, 138),), "duplicate_triangles": (270,)}),
    "teapot": (19, -34, None, 25, False, None),
}


@pytest.mark.parametrize("name", SCANS)
def test_models_that_everybody_has(name):
    """The bunny's five holes, the rocker arm's handle, the cow's pinched vertex, Suzanne's double triangle."""
    path = MESHES / f"{name}.obj"
    if not path.exists():
        pytest.skip(f"needs ../shared/data/meshes/{name}.obj")
    lines = path.read_text().splitlines()
    positions = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], dtype=np.float32)
    polygons = [[int(corner.split("/")[0]) - 1 for corner in line.split()[1:]] for line in lines if line.startswith("f ")]
    report = topology_report(Mesh(positions, [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]))
    pieces, characteristic, genus, n_loops, closed, faults = SCANS[name]
    assert (report.n_components, report.euler_characteristic, report.genus) == (pieces, characteristic, genus)
    assert (len(report.boundary_loop_lengths), report.is_closed, report.is_consistently_oriented) == (n_loops, closed, True)
    fields = ("non_manifold_edges", "bow_tie_vertices", "inconsistent_edges", "t_junctions", "degenerate_triangles", "duplicate_triangles")
    named = {field: getattr(report, field) for field in fields if getattr(report, field)}
    assert named == faults if faults is not None else len(named["bow_tie_vertices"]) == 38


def test_many_triangles_are_examined():
    """Genus 1 among a hundred thousand triangles in no order."""
    report = topology_report(large_torus(250, 200))
    assert report.is_sound
    assert report.is_manifold
    assert report.genus == 1
