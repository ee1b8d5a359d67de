"""Newell's teapot as a mesh: the patches of `limner.curves.teapot`, cut into triangles without cracks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...curves import patch as bezier_patch
from ...curves.teapot import Part, parts, patches
from ...errors import SceneError
from ..mesh import Mesh

__all__ = ["patches", "teapot"]

Points = NDArray[np.float64]


def teapot(n: int = 16, size: float = 1.0) -> Mesh:
    """Make the teapot: y up, standing on y = 0, its axis the y axis, spout towards +x.

    Parameters
    ----------
    n : int >= 2
        Each of the 32 patches is cut into n by n quadrilaterals; from 8 on even the lip of the spout looks round.
    size : float > 0
        Radius of the body, metres: the pot is 1.575 times as high and 3.2 times as long.

    Returns
    -------
    Mesh
        Body with bottom, lid, handle and spout, each without cracks, its vertices shared between patches; exact unit normals;
        texture coordinates once round each part and once along it. The lid does not touch the rim, and handle and spout end
        inside the body, as in the original.

    Examples
    --------
    >>> teapot(4)
    Mesh('teapot', 530 positions, 992 triangles)
    """
    if n < 2:
        raise SceneError(f"a teapot patch must be cut into at least 2 pieces a side, got {n}")
    if not 0.0 < size < np.inf:
        raise SceneError(f"teapot size must be positive and finite, got {size}")
    pieces = [_tessellate_part(part, n) for part in parts()]
    y_up = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    # + 0.0 turns the -0.0 of mirrored points into 0.0.
    positions = np.concatenate([piece.positions for piece in pieces]) @ y_up.T * (size / 2.0) + 0.0
    normals = np.concatenate([piece.normals for piece in pieces]) @ y_up.T + 0.0
    return Mesh(
        positions=positions.astype(np.float32),
        triangles=_renumbered([piece.triangles for piece in pieces], [len(piece.positions) for piece in pieces]),
        normals=normals.astype(np.float32),
        uvs=np.concatenate([piece.uvs for piece in pieces]).astype(np.float32),
        uv_triangles=_renumbered([piece.uv_triangles for piece in pieces], [len(piece.uvs) for piece in pieces]),
        name="teapot",
    )


def _renumbered(triangles: list[NDArray[np.int64]], counts: list[int]) -> NDArray[np.int32]:
    """Join the triangles of parts whose vertices are joined in the same order."""
    starts = np.cumsum([0, *counts[:-1]])
    return np.concatenate([part + start for part, start in zip(triangles, starts, strict=True)]).astype(np.int32)


class _TessellatedPart(NamedTuple):
    positions: Points
    normals: Points
    uvs: Points
    triangles: NDArray[np.int64]
    uv_triangles: NDArray[np.int64]


def _tessellate_part(part: Part, n: int) -> _TessellatedPart:
    """Tessellate a ring of patches into one grid, whose first and last column, and whose poles, are one vertex each."""
    n_along, n_around = part.nets.shape[:2]
    n_rows, n_columns = n_along * n + 1, n_around * n
    positions = np.empty((n_rows, n_columns, 3))
    normals = np.zeros((n_rows, n_columns, 3))
    for along in range(n_along):
        for around in range(n_around):
            piece = bezier_patch.tessellate(part.nets[along, around], n)
            rows = along * n + np.arange(n + 1)[:, None]
            columns = (around * n + np.arange(n + 1)) % n_columns
            positions[rows, columns] = piece.positions.reshape(n + 1, n + 1, 3)
            normals[rows, columns] += piece.normals.reshape(n + 1, n + 1, 3)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    vertex = np.arange(n_rows * n_columns).reshape(n_rows, n_columns)
    for row in (0, n_rows - 1):
        # A row of equal control points comes out equal but for rounding.
        if np.ptp(positions[row], axis=0).max() < 1e-12:
            vertex[row] = vertex[row, 0]
            normals[row] = normals[row].mean(axis=0) / np.linalg.norm(normals[row].mean(axis=0))
    used, compact = np.unique(vertex, return_inverse=True)
    compact = compact.reshape(vertex.shape)
    triangles = _grid_triangles(np.concatenate([compact, compact[:, :1]], axis=1))
    uv_triangles = _grid_triangles(np.arange(n_rows * (n_columns + 1)).reshape(n_rows, n_columns + 1))
    a, b, c = triangles.T
    whole = (a != b) & (b != c) & (c != a)
    return _TessellatedPart(
        positions.reshape(-1, 3)[used],
        normals.reshape(-1, 3)[used],
        _grid_uvs(n_rows, n_columns, part.reversed),
        triangles[whole],
        uv_triangles[whole],
    )


def _grid_triangles(index: NDArray[np.int64]) -> NDArray[np.int64]:
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def _grid_uvs(n_rows: int, n_columns: int, reverse: bool) -> Points:
    u, v = np.meshgrid(np.arange(n_columns + 1) / n_columns, np.arange(n_rows) / (n_rows - 1))
    uvs = np.stack([u, v], axis=-1).reshape(-1, 2)
    return 1.0 - uvs if reverse else uvs
