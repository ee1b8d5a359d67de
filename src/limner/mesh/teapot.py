"""Newell's teapot: the most rendered pot in the world, from its Bézier patches (FoCG 15.6.1).

Martin Newell sketched his Melitta teapot and typed its control points in; they are in his thesis (*The Utilization of
Procedure Models in Digital Image Synthesis*, University of Utah, 1975), and became known through Frank Crow, "The Origins of
the Teapot", *IEEE Computer Graphics and Applications* 7(1), 1987. The list as it is passed on, with a bottom that was added
later, has 306 points and 32 bicubic patches; but the pot is regular, and is written here as what it is:

    rim, body, bottom, lid    profiles turned round the axis, in quarters with circle control points at 0.56 of the radius
    handle, spout             half tubes of the given rows, and their mirror images

The numbers are those of the list, in its units: z up, spout towards +x, 3.15 high. They are facts, published by their author
and free for everyone. The list shows the pot as it is known, without the factor 1.3 by which the one on Newell's table is
taller (James Blinn flattened it for a display with tall pixels, and it stayed so): scale y by 1.3 for the pot of clay.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..curves import patch as bezier_patch
from ..errors import SceneError
from .mesh import Mesh

__all__ = ["patches", "teapot"]

Points = NDArray[np.float64]
Row = tuple[tuple[float, float], tuple[float, float], float]

# A quarter circle of radius r has its inner control points at r k; the exact circle would ask for 0.5523.
_CIRCLE = 0.56

# Profiles as (radius, height), four points a patch, neighbours sharing one; from the top down the outside, to the axis.
_BODY = (
    (1.4, 2.4), (1.3375, 2.53125), (1.4375, 2.53125), (1.5, 2.4),
    (1.75, 1.875), (2.0, 1.35), (2.0, 0.9), (2.0, 0.45), (1.5, 0.225), (1.5, 0.15),
    (1.5, 0.075), (1.425, 0.0), (0.0, 0.0),
)  # fmt: skip
_LID = ((0.0, 3.15), (0.8, 3.15), (0.0, 2.85), (0.2, 2.7), (0.4, 2.55), (1.3, 2.55), (1.3, 2.4))
# The list rounds one ring of the knob otherwise: 0.45 at radius 0.8.
_KNOB_CIRCLE = 0.5625

# Half tubes as rows of (x, z) in the mirror plane on the one and on the other side, and the half width between.
_HANDLE: tuple[Row, ...] = (
    ((-1.6, 2.025), (-1.5, 2.25), 0.3), ((-2.3, 2.025), (-2.5, 2.25), 0.3), ((-2.7, 2.025), (-3.0, 2.25), 0.3),
    ((-2.7, 1.8), (-3.0, 1.8), 0.3), ((-2.7, 1.575), (-3.0, 1.35), 0.3), ((-2.5, 1.125), (-2.65, 0.9375), 0.3),
    ((-2.0, 0.9), (-1.9, 0.6), 0.3),
)  # fmt: skip
_SPOUT: tuple[Row, ...] = (
    ((1.7, 1.425), (1.7, 0.6), 0.66), ((2.6, 1.425), (3.1, 0.825), 0.66), ((2.3, 2.1), (2.4, 2.025), 0.25),
    ((2.7, 2.4), (3.3, 2.4), 0.25), ((2.8, 2.475), (3.525, 2.49375), 0.25), ((2.9, 2.475), (3.45, 2.5125), 0.15),
    ((2.8, 2.4), (3.2, 2.4), 0.15),
)  # fmt: skip


class _Part(NamedTuple):
    """Patches that close to a ring: nets (along, around, 4, 4, 3), and whether the texture runs against both directions."""

    nets: Points
    reversed: bool


def patches() -> Points:
    """Return the control points of the teapot.

    Returns
    -------
    (32, 4, 4, 3) float64
        In the published units, z up: rim, body and bottom (16 patches), lid (8), handle (4), spout (4). Normals point outwards.

    Examples
    --------
    >>> patches()[0, 0].tolist()
    [[1.4, 0.0, 2.4], [1.4, -0.784, 2.4], [0.784, -1.4, 2.4], [0.0, -1.4, 2.4]]

    **Source**: Newell 1975; Crow 1987. The bottom's rows run on from the body's instead of out from its centre.
    """
    return np.concatenate([part.nets.reshape(-1, 4, 4, 3) for part in _parts()])


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
    parts = [_tessellate_part(part, n) for part in _parts()]
    y_up = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    # + 0.0 turns the -0.0 of mirrored points into 0.0.
    positions = np.concatenate([part.positions for part in parts]) @ y_up.T * (size / 2.0) + 0.0
    normals = np.concatenate([part.normals for part in parts]) @ y_up.T + 0.0
    return Mesh(
        positions=positions.astype(np.float32),
        triangles=_renumbered([part.triangles for part in parts], [len(part.positions) for part in parts]),
        normals=normals.astype(np.float32),
        uvs=np.concatenate([part.uvs for part in parts]).astype(np.float32),
        uv_triangles=_renumbered([part.uv_triangles for part in parts], [len(part.uvs) for part in parts]),
        name="teapot",
    )


def _renumbered(triangles: list[NDArray[np.int64]], counts: list[int]) -> NDArray[np.int32]:
    """Join the triangles of parts whose vertices are joined in the same order."""
    starts = np.cumsum([0, *counts[:-1]])
    return np.concatenate([part + start for part, start in zip(triangles, starts, strict=True)]).astype(np.int32)


def _parts() -> list[_Part]:
    lid_circles = [_CIRCLE, _KNOB_CIRCLE, *[_CIRCLE] * 5]
    return [
        _Part(_turned(_BODY, [_CIRCLE] * len(_BODY)), reversed=True),
        _Part(_turned(_LID, lid_circles), reversed=True),
        _Part(_tube(_HANDLE), reversed=True),
        _Part(_tube(_SPOUT), reversed=False),
    ]


def _turned(profile: tuple[tuple[float, float], ...], circles: list[float]) -> Points:
    """Turn a profile round the z axis, clockwise seen from above."""
    quarter = np.empty((len(profile), 4, 3))
    for row, ((radius, height), circle) in enumerate(zip(profile, circles, strict=True)):
        inner = round(radius * circle, 9)
        quarter[row] = [(radius, 0, height), (radius, -inner, height), (inner, -radius, height), (0, -radius, height)]
    around = [quarter]
    for _ in range(3):
        last = around[-1]
        around.append(np.stack([last[..., 1], -last[..., 0], last[..., 2]], axis=-1))
    return _split_rows(around)


def _tube(rows: tuple[Row, ...]) -> Points:
    """Close half a tube with its mirror image in y = 0."""
    half = np.array(
        [[(x0, 0, z0), (x0, -width, z0), (x1, -width, z1), (x1, 0, z1)] for (x0, z0), (x1, z1), width in rows], dtype=np.float64
    )
    return _split_rows([half, half[:, ::-1] * (1.0, -1.0, 1.0)])


def _split_rows(around: list[Points]) -> Points:
    n_along = (len(around[0]) - 1) // 3
    return np.array([[column[3 * k : 3 * k + 4] for column in around] for k in range(n_along)]) + 0.0


class _TessellatedPart(NamedTuple):
    positions: Points
    normals: Points
    uvs: Points
    triangles: NDArray[np.int64]
    uv_triangles: NDArray[np.int64]


def _tessellate_part(part: _Part, n: int) -> _TessellatedPart:
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
