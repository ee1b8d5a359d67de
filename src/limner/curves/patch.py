"""Bicubic Bézier patches: a sheet over four by four control points, for teapots (FoCG 15.6.1 in two parameters).

    p(u, v) = sum_i sum_j b_i(v) b_j(u) P[i, j]

Rows run along v, columns along u: a curve of the patch at fixed v is a Bézier curve, and so is one at fixed u. Where two
patches have the four control points of a border in common, and in the same order, they share that border: the basis is exactly
0 or 1 there and the sums are taken in one order, so the positions agree to the bit.

The normal is the direction of ``dp/du x dp/dv``. Where a border shrinks to a point (the tip of a teapot's lid) one of the two
derivatives vanishes; near it, it is the mixed derivative times the distance, and with that the normal has a limit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .bernstein import basis, basis_derivatives

__all__ = ["Tessellation", "normals", "partials", "positions", "tessellate"]

Points = NDArray[np.float64]

# A derivative this small against the size of the control net is a border that has shrunk to a point.
_VANISHING = 1e-9


class Tessellation(NamedTuple):
    """A patch as a grid of triangles.

    positions : ((n + 1)^2, 3) float64
    normals : ((n + 1)^2, 3) float64, unit
    uvs : ((n + 1)^2, 2) float64, the patch's parameters
    triangles : (2 n^2, 3) int32, counter-clockwise seen from where the normals point to
    """

    positions: Points
    normals: Points
    uvs: Points
    triangles: NDArray[np.int32]


def _net(patch: ArrayLike) -> Points:
    net = np.asarray(patch, dtype=np.float64)
    if net.shape != (4, 4, 3):
        raise SceneError(f"a bicubic patch must have control points of shape (4, 4, 3), got {net.shape}")
    return net


def _blend(net: Points, weights_v: Points, weights_u: Points) -> Points:
    # Plain sums in one order, not a matrix product: shared borders must come out alike whatever the batch's size.
    rows = [sum(weights_u[..., j, None] * net[i, j] for j in range(4)) for i in range(4)]
    return np.asarray(sum(weights_v[..., i, None] * rows[i] for i in range(4)))


def positions(patch: ArrayLike, u: ArrayLike, v: ArrayLike) -> Points:
    """Evaluate the patch.

    Parameters
    ----------
    patch : (4, 4, 3) float
        Control points, rows along v, columns along u.
    u, v : (...) float in [0, 1], of shapes that broadcast

    Returns
    -------
    (..., 3) float64
    """
    return _blend(_net(patch), basis(3, v), basis(3, u))


def partials(patch: ArrayLike, u: ArrayLike, v: ArrayLike) -> tuple[Points, Points]:
    """Evaluate the derivatives dp/du and dp/dv.

    Parameters
    ----------
    patch : (4, 4, 3) float
    u, v : (...) float in [0, 1], of shapes that broadcast

    Returns
    -------
    dp_du, dp_dv : (..., 3) float64
    """
    net = _net(patch)
    return _blend(net, basis(3, v), basis_derivatives(3, u)), _blend(net, basis_derivatives(3, v), basis(3, u))


def normals(patch: ArrayLike, u: ArrayLike, v: ArrayLike) -> Points:
    """Evaluate the unit normal, dp/du x dp/dv made unit, or its limit where a border has shrunk to a point.

    Parameters
    ----------
    patch : (4, 4, 3) float
    u, v : (...) float in [0, 1], of shapes that broadcast

    Returns
    -------
    (..., 3) float64
        Zero where the patch has no normal: all control points on a line.

    **Source**: Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, 15.3, 16.2 (degenerate patches).
    """
    net = _net(patch)
    s, t = np.broadcast_arrays(np.asarray(u, dtype=np.float64), np.asarray(v, dtype=np.float64))
    dp_du, dp_dv = partials(net, s, t)
    # d2p/dudv times the sign of the step back into the patch: dp/du near v = 0 is v times it, near v = 1 (v - 1) times it.
    mixed = _blend(net, basis_derivatives(3, t), basis_derivatives(3, s))
    size = float(np.ptp(net.reshape(-1, 3), axis=0).max())
    dp_du, dp_dv = (
        np.where(_vanishes(dp_du, size), np.where(t > 0.5, -1.0, 1.0)[..., None] * mixed, dp_du),
        np.where(_vanishes(dp_dv, size), np.where(s > 0.5, -1.0, 1.0)[..., None] * mixed, dp_dv),
    )
    normal = np.cross(dp_du, dp_dv)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.where(length > _VANISHING * size * size, normal / np.where(length > 0.0, length, 1.0), 0.0)


def _vanishes(vectors: Points, size: float) -> NDArray[np.bool_]:
    return np.asarray(np.linalg.norm(vectors, axis=-1, keepdims=True) <= _VANISHING * size)


def tessellate(patch: ArrayLike, n: int) -> Tessellation:
    """Cut a patch into n by n quadrilaterals, each into two triangles.

    Parameters
    ----------
    patch : (4, 4, 3) float
    n : int >= 1

    Returns
    -------
    Tessellation
        Vertex ``row (n + 1) + column`` stands at u = column / n, v = row / n. Triangles of zero area at a pole are among them.

    Examples
    --------
    >>> grid = np.stack(np.meshgrid(range(4), range(4), [0.0]), axis=-1).reshape(4, 4, 3)
    >>> flat = tessellate(grid, 2)
    >>> flat.normals[0].tolist(), len(flat.triangles)
    ([0.0, 0.0, 1.0], 8)
    """
    if n < 1:
        raise SceneError(f"a patch must be cut into at least 1 piece a side, got {n}")
    steps = np.arange(n + 1) / n
    u, v = np.tile(steps, n + 1), np.repeat(steps, n + 1)
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).reshape(-1)
    corners = np.stack([first, first + 1, first + n + 2, first, first + n + 2, first + n + 1], axis=1)
    return Tessellation(
        positions(patch, u, v), normals(patch, u, v), np.stack([u, v], axis=1), corners.reshape(-1, 3).astype(np.int32)
    )
