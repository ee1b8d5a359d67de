"""Texture coordinates by projection: a mesh laid onto a sphere, a cylinder, a plane or a box (FoCG 11.2.1).

    globe = project_uvs(mesh, "sphere")

The texture is wrapped round the mesh along straight lines from a centre, from an axis, or along one. What is simple for points is not for
triangles: where a texture that goes all round begins again, a triangle with corners at u = 0.98 and u = 0.03 would show the whole picture
backwards. Texture coordinates are therefore given by corner, and go on beyond 1 there:

        u  0.94   0.98 | 0.03   0.08                  0.94   0.98 | 1.03
            .------.---|--.------.         ->          .------.---|--.        (and 0.03 in the next triangle)

At a pole, which has all u at once, each triangle takes the middle of its own.
"""

from __future__ import annotations

import dataclasses
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .mesh import Mesh
from .normals import face_normals
from .weld import welded

__all__ = ["Axis", "Projection", "project_uvs"]

Projection = Literal["sphere", "cylinder", "plane", "box"]
Axis = Literal["x", "y", "z"]
Floats = NDArray[np.float64]

_CYCLIC = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
"""Which coordinates stand for the formulas' x, y and z, so that the axis is their z and the frame stays right-handed."""


def project_uvs(
    mesh: Mesh, onto: Projection, *, axis: Axis = "z", center: ArrayLike | None = (0.0, 0.0, 0.0), size: float | None = None
) -> Mesh:
    """Give a mesh texture coordinates by projection.

    Parameters
    ----------
    mesh : Mesh
    onto : "sphere" | "cylinder" | "plane" | "box"
        With x, y, z from the center, z along the axis, and r the distance from the center:

        - sphere: ``u = 0.5 + atan2(y, x) / 2 pi``, ``v = 1 - acos(z / r) / pi``;
        - cylinder: u as the sphere, v from 0 to 1 from the mesh's lowest to its highest z;
        - plane: ``u = 0.5 + x / size``, ``v = 0.5 + y / size``;
        - box: as a plane, for each triangle the one of six that its normal is nearest to; seen from outside none is mirrored, and on the
          four sides v grows along the axis.
    axis : "x" | "y" | "z"
        The poles of the sphere, the axis of the cylinder, the normal of the plane, what is up for the box. For "x" and "y", the other
        coordinates follow in cyclic order.
    center : three floats, optional
        Object space, metres. None: the middle of the bounds.
    size : float > 0, optional
        For plane and box: how many metres the texture covers. None: the longest side of the bounds.

    Returns
    -------
    Mesh
        With `uvs` and `uv_triangles`. No triangle has corners more than half a turn apart, but where one holds the axis. Tangents and the
        second set of texture coordinates, which belonged to the first, are gone.

    Raises SceneError where the projection is none of these, or a number is not what it must be.

    Examples
    --------
    >>> mesh = Mesh([[0, -1, 0], [0, 0, 1], [1, 0, 0]], [[0, 1, 2]])
    >>> projected = project_uvs(mesh, "sphere")
    >>> projected.uvs[projected.uv_triangles[0]].tolist()
    [[0.25, 0.5], [0.375, 1.0], [0.5, 0.5]]

    **Source**: Marschner and Shirley, *Fundamentals of Computer Graphics*, 4th ed., section 11.2.1; the corner at a seam or pole is ours.
    """
    middle = _checked(mesh, onto, axis, center, size)
    points = (mesh.positions.astype(np.float64) - middle)[:, _CYCLIC[axis]]
    longest = float(np.ptp(mesh.bounds, axis=0).max()) if len(mesh.triangles) else 1.0
    scale = 1.0 / (size or longest or 1.0)
    if onto == "box":
        return _with_corners(mesh, 0.5 + scale * _sides(points, mesh.triangles))
    if onto == "plane":
        return _replaced(mesh, 0.5 + scale * points[:, :2], mesh.triangles)
    x, y, z = points.T
    if onto == "sphere":
        r = np.sqrt(x * x + y * y + z * z)
        v = 1.0 - np.arccos(np.clip(z / np.where(r > 0.0, r, 1.0), -1.0, 1.0)) / np.pi
    else:
        used = z[mesh.triangles] if len(mesh.triangles) else np.zeros(1)
        v = (z - used.min()) / (np.ptp(used) or 1.0)
    u = 0.5 + np.arctan2(y, x) / (2.0 * np.pi)
    around = _unwrapped(u[mesh.triangles], ((x == 0.0) & (y == 0.0))[mesh.triangles])
    return _with_corners(mesh, np.stack([around, v[mesh.triangles]], axis=-1))


def _checked(mesh: Mesh, onto: str, axis: str, center: ArrayLike | None, size: float | None) -> Floats:
    """The center, if all else is what it must be."""
    for name, given, kinds in (("projection", onto, get_args(Projection)), ("axis", axis, get_args(Axis))):
        if given not in kinds:
            raise SceneError(f"{name} must be one of {', '.join(kinds)}, got {given!r}", mesh.name)
    if size is not None and not (np.isfinite(size) and size > 0.0):
        raise SceneError(f"size must be positive, got {size}", mesh.name)
    if center is None:
        return np.asarray(mesh.bounds.mean(axis=0)) if len(mesh.triangles) else np.zeros(3)
    middle = np.asarray(center, dtype=np.float64)
    if middle.shape != (3,) or not np.isfinite(middle).all():
        raise SceneError(f"center must be three finite numbers, got {center!r}", mesh.name)
    return middle


def _unwrapped(u: Floats, is_pole: NDArray[np.bool_]) -> Floats:
    """(m, 3) u of corners without a jump inside a triangle, the least in [0, 1]; corners on the axis in the middle of the others."""
    first = np.argmin(is_pole, axis=1)
    reference = np.take_along_axis(u, first[:, None], axis=1)
    # Whole turns are added once: a number that went back and forth would not be the same float any more.
    turns = -np.round(u - reference)
    least = np.where(is_pole, np.inf, u + turns).min(axis=1, keepdims=True)
    around = u + (turns - np.where(least < 0.0, np.floor(least), 0.0))
    others = np.where(is_pole, 0.0, around).sum(axis=1) / np.maximum((~is_pole).sum(axis=1), 1)
    return np.where(is_pole, others[:, None], around)


def _sides(points: Floats, triangles: NDArray[np.int32]) -> Floats:
    """(m, 3, 2): each triangle's corners in the plane of the side of a box that it looks to; z is up."""
    normals = face_normals(points, triangles)
    looks = np.argmax(np.abs(normals), axis=1)
    sign = np.where(np.take_along_axis(normals, looks[:, None], axis=1)[:, 0] < 0.0, -1.0, 1.0)
    corners = points[triangles]
    # u is to the right of who looks at the side from outside: up x normal, and x on top.
    right = np.stack([corners[..., 1], -corners[..., 0], corners[..., 0]])[looks, np.arange(len(looks))]
    up = np.where((looks == 2)[:, None], corners[..., 1], corners[..., 2])
    return np.stack([right * sign[:, None], up], axis=-1)


def _with_corners(mesh: Mesh, uvs: Floats) -> Mesh:
    """The mesh with (m, 3, 2) texture coordinates of corners; those of one position that are equal are shared."""
    index, _ = welded(uvs.reshape(-1, 2).astype(np.float32))
    key = mesh.triangles.reshape(-1).astype(np.int64) * (len(index) + 1) + index
    _, first, shared = np.unique(key, return_index=True, return_inverse=True)
    return _replaced(mesh, uvs.reshape(-1, 2)[first], shared.reshape(-1, 3))


def _replaced(mesh: Mesh, uvs: Floats, uv_triangles: NDArray[np.int64] | NDArray[np.int32]) -> Mesh:
    return dataclasses.replace(
        mesh, uvs=uvs.astype(np.float32), uv_triangles=uv_triangles.astype(np.int32), uvs1=None, tangents=None
    )
