"""Tangents as the published MikkTSpace makes them."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.errors import SceneError
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.mesh.tangents import corner_tangents, with_tangents
from limner.mesh.weld import welded

SAMPLES = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "khronos"

LEFT = {
    0: (-0.8730, -0.2159, 0.4374),
    1: (-0.9806, -0.1961, 0.0000),
    3: (-0.8025, -0.1981, 0.5628),
    4: (-0.9636, -0.1851, 0.1927),
    6: (-0.6042, -0.1665, 0.7793),
    7: (-0.7713, -0.1558, 0.6171),
}
RIGHT = {
    1: (0.9806, -0.1961, 0.0000),
    2: (0.8311, -0.1141, 0.5443),
    4: (0.9607, -0.2005, -0.1921),
    5: (0.9033, -0.1238, 0.4108),
    7: (0.7681, -0.1800, -0.6145),
    8: (0.9783, -0.1604, -0.1315),
}
"""What the author's own program (mikktspace.c, github.com/mmikk/MikkTSpace) gives for `saddle`: its mirrored half, and the other."""


def saddle() -> Mesh:
    """Eight triangles over a saddle whose texture is mirrored at x = 0 and skewed, and a ninth without area."""
    x, y = np.meshgrid([-1.0, 0.0, 1.0], [0.0, 0.5, 2.0])
    z = 0.3 * x * x - 0.4 * x * y
    normals = np.stack([0.4 * y - 0.6 * x, 0.4 * x, np.ones_like(x)], axis=-1).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    uvs = np.stack([np.abs(x) + 0.1 * y, y + 0.2 * x * x], axis=-1).reshape(-1, 2)
    triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [3, 4, 7], [3, 7, 6], [4, 5, 8], [4, 8, 7], [4, 4, 8]]
    return Mesh(np.stack([x, y, z], axis=-1).reshape(-1, 3), triangles, normals=normals, uvs=uvs)


def _corners(mesh: Mesh) -> NDArray[np.float32]:
    """(m, 3, 4) tangents of a mesh's corners."""
    assert mesh.tangents is not None
    assert mesh.normal_triangles is not None
    return mesh.tangents[mesh.normal_triangles]


def test_as_the_published_program() -> None:
    """Directions, handedness, the split along the mirror's seam, and what a triangle without area takes from others."""
    mesh = saddle()
    made = corner_tangents(mesh)
    for triangle, corners in zip(made, mesh.triangles, strict=True):
        for tangent, vertex in zip(triangle, corners, strict=True):
            is_left = vertex in (0, 3, 6) or tangent[3] < 0.0
            np.testing.assert_allclose(tangent, (*(LEFT if is_left else RIGHT)[int(vertex)], -1.0 if is_left else 1.0), atol=6e-5)
    # The ninth takes what the first triangle at its vertex has: the left half's at vertex 4.
    assert made[8, :, 3].tolist() == [-1.0, -1.0, 1.0]


def test_the_mesh_is_the_same_but_for_split_normals() -> None:
    """Corners keep their normals and get their tangents; a normal is split where two groups of corners share it, and nowhere else."""
    mesh = saddle()
    made = with_tangents(mesh)
    assert mesh.normals is not None
    assert made.normals is not None
    assert (made.normals[made.normal_triangles] == mesh.normals[mesh.triangles]).all()
    assert (_corners(made) == corner_tangents(mesh)).all()
    assert len(made.normals) == 9 + 3
    assert made.positions is mesh.positions
    assert made.triangles is mesh.triangles


def test_a_sphere_has_its_meridians_and_parallels() -> None:
    """Tangents go east at right angles to the normals, and one vertex on the seam has one direction on both sides of it."""
    mesh = primitives.sphere(1.0, 24)
    tangents, p = corner_tangents(mesh), mesh.positions[mesh.triangles].astype(float)
    assert mesh.normals is not None
    assert np.abs((tangents[..., :3] * mesh.normals[mesh.triangles]).sum(axis=-1)).max() < 1e-6
    assert (tangents[..., 3] == 1.0).all()
    east = np.stack([p[..., 2], np.zeros(p.shape[:2]), -p[..., 0]], axis=-1)
    off = np.linalg.norm(east, axis=-1) > 0.3
    cosine = (tangents[..., :3] * east).sum(axis=-1)[off] / np.linalg.norm(east, axis=-1)[off]
    assert cosine.min() > np.cos(np.radians(8.0))


def test_it_does_not_matter_how_vertices_are_indexed() -> None:
    """A mesh whose corners all have rows of their own gets the very same tangents: equal rows are found."""
    mesh = primitives.torus(1.0, 0.4, 12, 8)
    assert mesh.normals is not None
    assert mesh.uvs is not None
    normal = mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles
    uv = mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles
    loose = Mesh(
        mesh.positions[mesh.triangles.reshape(-1)], np.arange(3 * len(mesh.triangles)).reshape(-1, 3),
        normals=mesh.normals[normal.reshape(-1)], uvs=mesh.uvs[uv.reshape(-1)],
    )  # fmt: skip
    np.testing.assert_allclose(corner_tangents(loose), corner_tangents(mesh), atol=1e-6)


def test_a_texture_mirrored_as_a_whole_changes_the_sign_alone() -> None:
    """v downwards instead of upwards: the same directions, the other handedness."""
    mesh = saddle()
    assert mesh.uvs is not None
    flipped = dataclasses.replace(mesh, uvs=mesh.uvs * np.array([1.0, -1.0], dtype=np.float32))
    np.testing.assert_allclose(corner_tangents(flipped)[:8] * (1, 1, 1, -1), corner_tangents(mesh)[:8], atol=1e-6)


def test_where_the_texture_says_nothing() -> None:
    """One texel on a whole mesh, no area at all, no triangles: unit vectors at right angles to the normals, no NaN."""
    mesh = saddle()
    for uvs in (np.zeros((9, 2)), np.full((9, 2), np.nan)):
        tangents = corner_tangents(dataclasses.replace(mesh, uvs=uvs))
        np.testing.assert_allclose(np.linalg.norm(tangents[..., :3], axis=-1), 1.0, atol=1e-6)
        assert mesh.normals is not None
        assert np.abs((tangents[..., :3] * mesh.normals[mesh.triangles]).sum(axis=-1)).max() < 1e-6
    assert corner_tangents(Mesh([[0, 0, 0]], [[0, 0, 0]], normals=[[0, 0, 1]], uvs=[[0, 0]])).shape == (1, 3, 4)
    none = np.zeros((0, 3))
    assert corner_tangents(Mesh(none, none.astype(int), normals=none, uvs=none[:, :2])).shape == (0, 3, 4)


def test_what_is_missing_is_told() -> None:
    """A mesh without normals, texture coordinates, or the set that is asked for."""
    mesh = saddle()
    with pytest.raises(SceneError, match="the mesh has no normals"):
        with_tangents(dataclasses.replace(mesh, normals=None))
    with pytest.raises(SceneError, match="has no texture coordinates"):
        with_tangents(dataclasses.replace(mesh, uvs=None))
    with pytest.raises(SceneError, match="set 1 of texture coordinates"):
        with_tangents(mesh, uv_set=1)


def test_welding_finds_equal_rows() -> None:
    """The same as comparing rows; zeros of either sign are equal."""
    rng = np.random.default_rng(2)
    rows = rng.integers(-1, 2, (200, 3)).astype(np.float32) * np.float32(0.1)
    index, first = welded(rows[:, :2], rows[:, 2:])
    assert (rows[first][index] == rows).all()
    assert len(first) == len(np.unique(rows + np.float32(0.0), axis=0))


def test_near_the_tangents_that_an_author_exported() -> None:
    """AnisotropyRotationTest comes with its exporter's MikkTSpace tangents: the generated ones differ by less than a degree."""
    path = SAMPLES / "AnisotropyRotationTest" / "AnisotropyRotationTest.glb"
    if not path.exists():
        pytest.skip("the Khronos sample models are not here")
    from limner.files.load import load

    scene = load(path)
    meshes = [shape.geometry for _, shape in scene.shapes() if isinstance(shape.geometry, Mesh) and shape.geometry.tangents is not None]
    assert meshes
    for mesh in meshes[:4]:
        assert mesh.tangents is not None
        authored = mesh.tangents[mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles]
        made = corner_tangents(mesh)
        cosine = (authored[..., :3] * made[..., :3]).sum(axis=-1)
        assert (authored[..., 3] == made[..., 3]).mean() > 0.999
        assert np.median(cosine) > np.cos(np.radians(1.0))
