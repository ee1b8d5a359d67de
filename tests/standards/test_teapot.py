"""Newell's teapot: the published numbers, and a surface as it should be.

The control points are compared with the list of 306 points and 32 patches by its fingerprint: the sixteen points of each patch
sorted, the patches sorted, six digits. It was taken from the list as public programs have it, so that a slip in one of our
numbers, or in the way the symmetric parts are unfolded, cannot pass.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limner.errors import SceneError
from limner.mesh.shapes.teapot import patches, teapot

FINGERPRINT = "401ca6ff95f573c8d0212a41087b64145b25d656aeb01a507bb633cc2aa68983"
MESHES = Path(__file__).resolve().parents[2] / ".." / "shared" / "data" / "meshes"


def edge_counts(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How often each undirected edge is used, and the sum of its directions."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    direction = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    _, index, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    return count, np.bincount(index.reshape(-1), weights=direction)


def test_control_points_are_the_published_ones():
    """32 patches of 16 points, by fingerprint, and some of them by eye."""
    nets = patches()
    assert nets.shape == (32, 4, 4, 3)
    canonical = []
    for net in np.round(nets.reshape(32, 16, 3), 6) + 0.0:
        canonical.append(tuple(map(tuple, net[np.lexsort(net.T[::-1])])))
    text = "\n".join(" ".join(f"{c:.6f}" for p in net for c in p) for net in sorted(canonical))
    assert hashlib.sha256(text.encode()).hexdigest() == FINGERPRINT
    points = {tuple(p) for p in (np.round(nets.reshape(-1, 3), 6) + 0.0).tolist()}
    assert {(1.4, -0.784, 2.4), (0.0, 0.0, 3.15), (0.45, -0.8, 3.15), (-2.65, 0.3, 0.9375), (3.525, 0.25, 2.49375)} <= points
    np.testing.assert_allclose([nets.min(axis=(0, 1, 2)), nets.max(axis=(0, 1, 2))], [[-3, -2, 0], [3.525, 2, 3.15]])


@settings(max_examples=12)
@given(st.integers(2, 24))
def test_surface_has_no_cracks(n):
    """Four pieces; inside each every edge has its two faces, in opposite directions; only the rim, the lid's edge and the ends
    of handle and spout are open. No triangle is without area."""
    mesh = teapot(n)
    count, direction = edge_counts(mesh.triangles)
    assert count.max() == 2
    assert (direction[count == 2] == 0).all()
    # Open: body rim and lid edge of four patches each, two ends of handle and spout of two each.
    assert (count == 1).sum() == n * (4 + 4 + 4 + 4)
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    assert np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).min() > 0.0


def test_neighbouring_patches_agree_on_their_border_to_the_bit():
    """What is welded is one point before it is welded: tessellated one by one, shared borders have equal float32 positions."""
    from limner.curves.patch import tessellate

    nets = patches()
    for n in (3, 7, 16):
        grids = [tessellate(net, n).positions.astype(np.float32).reshape(n + 1, n + 1, 3) for net in nets]
        for start in (0, 4, 8, 12, 16, 20):
            for k in range(4):
                np.testing.assert_array_equal(grids[start + k][:, -1], grids[start + (k + 1) % 4][:, 0])
        for upper in (*range(12), *range(16, 20)):
            np.testing.assert_array_equal(grids[upper][-1], grids[upper + 4][0])


@pytest.mark.parametrize("n", [8, 16, 32])
def test_normals_are_unit_exact_and_agree_with_the_winding(n):
    """Every corner's normal is on its triangle's front side, and the angle between them falls as 1/n."""
    mesh = teapot(n)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-6)
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    cross = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    cross /= np.linalg.norm(cross, axis=1, keepdims=True)
    cosines = np.einsum("mkc,mc->mk", mesh.normals[mesh.triangles], cross)
    assert cosines.min() > 0.0
    assert np.degrees(np.arccos(np.clip(cosines, -1, 1))).mean() < 90.0 / n
    # The lid's tip and the bottom's centre, where the patches are degenerate.
    top, bottom = mesh.positions[:, 1].argmax(), np.abs(mesh.positions).sum(axis=1).argmin()
    np.testing.assert_allclose(mesh.normals[top], [0, 1, 0], atol=1e-7)
    np.testing.assert_allclose(mesh.normals[bottom], [0, -1, 0], atol=1e-7)


def test_pot_stands_and_points_outwards():
    """On y = 0, as wide as asked, spout towards +x, symmetric in z; the enclosed volume is positive and, per body radius, the
    integral of the profile: about 3.0 for the body alone."""
    mesh = teapot(16, size=2.0)
    low, high = mesh.bounds
    np.testing.assert_allclose([low[1], high[1]], [0.0, 3.15], atol=1e-6)
    np.testing.assert_allclose([low[2], high[2]], [-2.0, 2.0], atol=1e-3)
    assert high[0] > 3.4
    assert low[0] < -2.99
    mirrored = mesh.positions * np.float32([1, 1, -1])
    assert {tuple(q) for q in np.round(mirrored, 5).tolist()} == {tuple(q) for q in np.round(mesh.positions, 5).tolist()}
    p = teapot(16).positions.astype(np.float64)[mesh.triangles]
    volume = (p[:, 0] * np.cross(p[:, 1], p[:, 2])).sum() / 6
    assert 3.0 < volume < 3.5


def test_texture_is_not_mirrored():
    """Seen from outside, u and v turn counter-clockwise on every triangle, and stay in the unit square."""
    mesh = teapot(5)
    assert mesh.uvs.min() == 0.0
    assert mesh.uvs.max() == 1.0
    uv = mesh.uvs[mesh.uv_triangles].astype(np.float64)
    e, f = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    assert (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0] > 0.0).all()


def test_agrees_with_a_tessellation_from_elsewhere():
    """Nearly every vertex of the teapot that circulates as an OBJ file lies on our surface."""
    path = MESHES / "teapot.obj"
    if not path.exists():
        pytest.skip("needs ../shared/data/meshes/teapot.obj")
    from scipy.spatial import cKDTree

    rows = [line.split()[1:4] for line in path.read_text().splitlines() if line.startswith("v ")]
    theirs = np.array(rows, dtype=np.float64)
    ours = teapot(40, size=2.0).positions.astype(np.float64)
    distance, _ = cKDTree(ours).query(theirs)
    assert np.quantile(distance, 0.99) < 0.05
    np.testing.assert_allclose(theirs.max(axis=0), ours.max(axis=0), atol=0.02)
    np.testing.assert_allclose(theirs.min(axis=0), ours.min(axis=0), atol=0.02)


@pytest.mark.parametrize("call", [lambda: teapot(1), lambda: teapot(4, size=0.0), lambda: teapot(4, size=float("nan"))])
def test_impossible_pots_are_refused(call):
    with pytest.raises(SceneError):
        call()
