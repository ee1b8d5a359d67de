"""Open surfaces over a square or a disk: a quadrilateral, planes, a bilinear patch, a field of heights."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..mesh import Mesh
from ..sizes import check_count, check_length, check_triangles, edge_lengths
from .bands import grid_triangles, halved

__all__ = ["bilinear_patch", "heightfield", "plane", "plane_disk", "quad"]


def quad(corners: ArrayLike) -> Mesh:
    """Make a flat quadrilateral of two triangles.

    Parameters
    ----------
    corners : (4, 3) float
        Counter-clockwise seen from the front, in one plane, convex; they get the texture coordinates (0, 0), (1, 0), (1, 1) and
        (0, 1).

    Returns
    -------
    Mesh
        4 positions, 2 triangles, one normal.
    """
    points = np.asarray(corners, dtype=np.float64)
    if points.shape != (4, 3):
        raise SceneError(f"a quadrilateral has corners of shape (4, 3), got {points.shape}")
    normal = np.cross(points[2] - points[0], points[3] - points[1])
    length = float(np.linalg.norm(normal))
    if not (math.isfinite(length) and length > 0.0):
        raise SceneError(f"a quadrilateral must have an area, got corners {points.tolist()}")
    split = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    return Mesh(
        positions=points.astype(np.float32),
        triangles=split,
        normals=(normal / length).astype(np.float32)[None],
        normal_triangles=np.zeros_like(split),
        uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32),
        name="quad",
    )


def plane_disk(center: ArrayLike, inner_radius: float, outer_radius: float, n_segments: int = 32) -> Mesh:
    """Cover the infinite plane y = 0 around a foot point: rings of triangles whose radii double.

    A single huge triangle would leave float32 nothing for what is near the eye; here no triangle is much longer than its own
    distance from the foot point, so interpolation over it is as exact as its distance deserves.

    Parameters
    ----------
    center : (2,) float
        x and z of the foot point, below the eye.
    inner_radius, outer_radius : float, 0 < inner <= outer
        Metres: of the innermost ring, which is a fan around the foot point, and of the disk that is covered for certain.
    n_segments : int >= 3
        Sides of the ring.

    Returns
    -------
    Mesh
        ``1 + n_segments rings`` positions; normal +y; texture coordinates (x, -z), as of an infinite plane.

    Examples
    --------
    >>> plane_disk((0.0, 0.0), 1.0, 1000.0, 16)
    Mesh('plane', 177 positions, 336 triangles)
    """
    check_length(inner_radius, "inner_radius")
    check_length(outer_radius, "outer_radius")
    if not inner_radius <= outer_radius or n_segments < 3:
        raise SceneError(
            f"a disk needs inner_radius <= outer_radius and 3 segments, got {inner_radius}, {outer_radius} and {n_segments}"
        )
    # A polygon reaches less far in the middle of its sides than at its corners.
    reach = outer_radius / math.cos(math.pi / n_segments)
    n_rings = max(1, math.ceil(math.log2(reach / inner_radius) - 1e-9) + 1)
    radii = np.minimum(inner_radius * 2.0 ** np.arange(n_rings), reach)
    radii[-1] = reach
    angle = 2.0 * math.pi * np.arange(n_segments) / n_segments
    rings = radii[:, None, None] * np.stack([np.cos(angle), -np.sin(angle)], axis=1)
    xz = np.concatenate([[[0.0, 0.0]], rings.reshape(-1, 2)]) + np.asarray(center, dtype=np.float64).reshape(2)
    column = np.arange(n_segments)
    following = (column + 1) % n_segments
    row = 1 + n_segments * np.arange(n_rings - 1)[:, None]
    a, b, c, d = row + column, row + n_segments + column, row + n_segments + following, row + following
    fan = np.stack([np.zeros_like(column), 1 + column, 1 + following], axis=1)
    triangles = np.concatenate([fan, np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)]).astype(np.int32)
    return Mesh(
        positions=np.stack([xz[:, 0], np.zeros(len(xz)), xz[:, 1]], axis=1).astype(np.float32),
        triangles=triangles,
        normals=np.array([[0.0, 1.0, 0.0]], dtype=np.float32),
        normal_triangles=np.zeros_like(triangles),
        uvs=np.stack([xz[:, 0], -xz[:, 1]], axis=1).astype(np.float32),
        name="plane",
    )


def bilinear_patch(corners: ArrayLike, n: int = 32) -> Mesh:
    """Make a bilinear patch of n x n quadrilaterals, which are flat only where it is.

    Parameters
    ----------
    corners : (4, 3) float
        p00, p10, p11, p01, counter-clockwise seen from the front; p(u, v) = (1-u)(1-v) p00 + u (1-v) p10 + u v p11 + (1-u) v p01.
    n : int >= 1

    Returns
    -------
    Mesh
        Positions, normals and (u, v) on a grid, row by row.
    """
    points = np.asarray(corners, dtype=np.float64)
    if points.shape != (4, 3):
        raise SceneError(f"a bilinear patch has corners of shape (4, 3), got {points.shape}")
    if n < 1:
        raise SceneError(f"a bilinear patch needs at least 1 quadrilateral a side, got {n}")
    p00, p10, p11, p01 = points
    v, u = (axis.reshape(-1, 1) for axis in np.mgrid[0 : n + 1, 0 : n + 1] / n)
    along_u, along_v = (1.0 - v) * (p10 - p00) + v * (p11 - p01), (1.0 - u) * (p01 - p00) + u * (p11 - p10)
    normals = np.cross(along_u, along_v)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    # Where two corners meet there is no normal: that of the diagonals.
    normals = np.where(lengths > 0.0, normals, np.cross(p11 - p00, p01 - p10))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    row, column = (n + 1) * np.arange(n)[:, None], np.arange(n)
    return Mesh(
        positions=((1.0 - v) * ((1.0 - u) * p00 + u * p10) + v * (u * p11 + (1.0 - u) * p01)).astype(np.float32),
        triangles=halved(row + column, row + column + 1, row + column + n + 2, row + column + n + 1).astype(np.int32),
        normals=normals.astype(np.float32),
        uvs=np.concatenate([u, v], axis=1).astype(np.float32),
        name="bilinear patch",
    )


def plane(size: ArrayLike = 2.0, n: int = 1) -> Mesh:
    """Make a flat square or rectangle in y = 0, its front towards +y, divided into n x n.

    Parameters
    ----------
    size : two floats > 0, or one for both
        Along x and along z, metres.
    n : int >= 1
        Quadrilaterals along each side.

    Returns
    -------
    Mesh
        ``(n + 1)^2`` positions, row by row from +z to -z, ``2 n^2`` triangles, one normal; it shows the whole texture, u along +x and v
        along -z.

    Examples
    --------
    >>> plane(2.0, 4)
    Mesh('plane', 25 positions, 32 triangles)
    """
    n = check_count(n, 1, "plane.n")
    check_triangles(2 * n * n, f"plane.n = {n}")
    return _over_rectangle(np.zeros((n + 1, n + 1)), size, "plane")


def heightfield(heights: ArrayLike, size: ArrayLike = 2.0, scale: float = 1.0) -> Mesh:
    """Make a landscape from a table of heights.

    Parameters
    ----------
    heights : (rows, columns) float, at least 2 of each
        Row 0 is at the back, at -z, as the top row of a map that is looked at from +y.
    size : two floats > 0, or one for both
        Along x and along z, metres.
    scale : float
        What heights are multiplied with to be metres.

    Returns
    -------
    Mesh
        ``rows * columns`` positions, row by row from +z to -z; normals of the function's gradient by central differences; the whole
        texture, u along +x and v along -z.

    Examples
    --------
    >>> heightfield([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]).bounds.tolist()
    [[-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]]
    """
    table = np.asarray(heights, dtype=np.float64)
    if table.ndim != 2 or min(table.shape) < 2:
        raise SceneError(f"heightfield.heights must have shape (rows, columns), at least (2, 2), got {table.shape}")
    if not math.isfinite(scale):
        raise SceneError(f"heightfield.scale must be finite, got {scale}")
    if not np.isfinite(table).all():
        row, column = np.argwhere(~np.isfinite(table))[0]
        raise SceneError(f"heightfield.heights must be finite, got {table[row, column]} at row {row}, column {column}")
    check_triangles(2 * (table.shape[0] - 1) * (table.shape[1] - 1), f"heightfield.heights of shape {table.shape}")
    return _over_rectangle(table[::-1] * scale, size, "heightfield")


def _over_rectangle(heights: NDArray[np.float64], size: ArrayLike, name: str) -> Mesh:
    """Heights over a rectangle, row 0 at +z."""
    width, depth = edge_lengths(size, 2, f"{name}.size").tolist()
    rows, columns = heights.shape
    v, u = (axis.reshape(-1) for axis in np.meshgrid(np.arange(rows) / (rows - 1), np.arange(columns) / (columns - 1), indexing="ij"))
    triangles = grid_triangles(rows, columns).astype(np.int32)
    flat = not heights.any()
    normals = np.array([[0.0, 1.0, 0.0]]) if flat else _normals_of_heights(heights, width / (columns - 1), depth / (rows - 1))
    return Mesh(
        positions=np.stack([(u - 0.5) * width, heights.reshape(-1), (0.5 - v) * depth], axis=1).astype(np.float32),
        triangles=triangles,
        normals=normals.astype(np.float32),
        normal_triangles=np.zeros_like(triangles) if flat else None,
        uvs=np.stack([u, v], axis=1).astype(np.float32),
        name=name,
    )


def _normals_of_heights(heights: NDArray[np.float64], step_x: float, step_z: float) -> NDArray[np.float64]:
    """(k, 3): the normals (-dy/dx, 1, -dy/dz), unit; rows run towards -z."""
    towards_back, towards_right = np.gradient(heights, step_z, step_x)
    normals = np.stack([-towards_right, np.ones_like(heights), towards_back], axis=-1).reshape(-1, 3)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)
