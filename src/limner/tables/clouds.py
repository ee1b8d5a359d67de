"""Triangles that stand for the points of a cloud: discs as polygons, spheres as polyhedra, each as fine as it is seen.

A polygon has its disc's area, and a polyhedron its sphere's surface, so that neither covers more or less of the picture than what it
stands for, however few corners it has: the shadow of a convex body is on average a quarter of its surface (Cauchy). With few corners
they leave the round outline by more; that may be a tenth of a pixel, as for other round shapes, until all the points of a cloud together
would need more triangles than a cloud may have. Then it may be more, until they do not.

**Source**: Cauchy's mean projection: Santaló, *Integral Geometry and Geometric Probability*, 1976, 13.2.
"""

from __future__ import annotations

import hashlib
import math
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh.mesh import Mesh
from ..scene.points import PointCloud

if TYPE_CHECKING:
    from .stand_ins import Sight, StandIns

__all__ = ["MOST_TRIANGLES", "cloud_mesh", "fineness", "round_solids", "solid_errors", "tangents"]

Floats = NDArray[np.float64]
Levels = NDArray[np.int8]

MOST_TRIANGLES = 1 << 22
"""Of one cloud, unless it has more points than that."""

_CHORD_ERROR = 0.1  # pixels between what is round and what stands for it
_CORNERS = (3, 4, 8, 16, 32, 64)  # of polygons
_ALIKE = 4.0  # how much larger one point may be seen than another that is treated alike
_SUBDIVISIONS = 4  # of the icosahedron, at most


class _Solid(NamedTuple):
    """A polyhedron round the origin with the surface of the unit sphere."""

    corners: Floats
    triangles: NDArray[np.int32]


def cloud_mesh(cloud: PointCloud, matrix: Floats, sight: Sight, stand_ins: StandIns) -> Mesh:
    """The triangles that stand for a cloud which `matrix` places in the world."""
    n_shown = int(np.count_nonzero(cloud.shown))
    # Four triangles are the least that a solid has.
    as_discs = cloud.shown_as == "discs" or 4 * n_shown > MOST_TRIANGLES
    errors = _polygon_errors() if as_discs else solid_errors()
    counts = [n - 2 for n in _CORNERS] if as_discs else [len(solid.triangles) for solid in round_solids()]
    levels = fineness(_pixel_radii(cloud, matrix, sight), np.array(errors), np.array(counts))
    facing = as_discs and (cloud.normals is None or cloud.shown_as == "spheres" or not cloud.normals.any(axis=1).all())
    seen = tuple(sight.eye) + tuple(sight.towards) if facing else ()
    name = f"cloud {_content(cloud)} {hashlib.blake2b(levels.tobytes(), digest_size=12).hexdigest()} {as_discs} {seen}"
    if as_discs:
        return stand_ins.named(name, lambda: _discs(cloud, levels, _disc_normals(cloud, matrix, sight)))
    return stand_ins.named(name, lambda: _spheres(cloud, levels))


def _content(cloud: PointCloud) -> str:
    """A word for what a cloud shows."""
    state = hashlib.blake2b(digest_size=12)
    for array in (cloud.positions, cloud.colors, cloud.normals, cloud.radii):
        state.update(b"|" if array is None else np.ascontiguousarray(array).tobytes() + str(np.shape(array)).encode())
    return state.hexdigest()


def _pixel_radii(cloud: PointCloud, matrix: Floats, sight: Sight) -> NDArray[np.float32]:
    """(k,) float32: how large each point that is shown is seen."""
    scale = float(np.linalg.norm(matrix[:3, :3], ord=2))
    points = cloud.positions[cloud.shown].astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    return sight.pixels(points, scale * cloud.point_radii[cloud.shown].astype(np.float64)).astype(np.float32)


def fineness(pixels: NDArray[np.float32], errors: Floats, counts: NDArray[np.int_]) -> Levels:
    """How fine each point is: as its size asks, coarser all alike while together they are too many.

    Points that are seen about equally large are as fine as the largest, to a power of two: a camera that moves a little then finds the
    same triangles again.
    """
    allowed = _CHORD_ERROR
    largest = float(pixels.max())
    if largest <= _ALIKE * float(pixels.min()):
        pixels = np.full_like(pixels, 2.0 ** math.ceil(math.log2(max(largest, 1e-30))))
    while True:
        levels = np.minimum(np.searchsorted(allowed / errors, pixels), len(errors) - 1).astype(np.int8)
        if int(counts[levels].sum()) <= MOST_TRIANGLES or not levels.any():
            return levels
        allowed *= 2.0


# --- discs ------------------------------------------------------------------------------------------------------------------


def _polygon(n: int) -> Floats:
    """(n, 2): a regular polygon with the area of the unit disc."""
    radius = math.sqrt(2.0 * math.pi / (n * math.sin(2.0 * math.pi / n)))
    angles = 2.0 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _polygon_errors() -> list[float]:
    """How far the outline of each polygon is from the circle, of its radius."""
    radii = [float(np.linalg.norm(_polygon(n)[0])) for n in _CORNERS]
    return [max(radius - 1.0, 1.0 - radius * math.cos(math.pi / n)) for radius, n in zip(radii, _CORNERS, strict=True)]


def _disc_normals(cloud: PointCloud, matrix: Floats, sight: Sight) -> NDArray[np.float32]:
    """(k, 3): what each disc faces in the cloud's own space; the eye where the cloud does not say."""
    points = cloud.positions[cloud.shown]
    given = np.zeros_like(points) if cloud.normals is None or cloud.shown_as == "spheres" else cloud.normals[cloud.shown]
    without = ~given.any(axis=1)
    if not without.any():
        return given
    world = points[without].astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    # A plane's normal goes back through the transposed of what takes its points forth.
    facing = sight.to_eye(world) @ matrix[:3, :3]
    length = np.linalg.norm(facing, axis=1, keepdims=True)
    normals = given.copy()
    normals[without] = np.where(length > 0.0, facing / np.where(length > 0.0, length, 1.0), (0.0, 0.0, 1.0))
    return normals


def _discs(cloud: PointCloud, levels: Levels, normals: NDArray[np.float32]) -> Mesh:
    points, radii = cloud.positions[cloud.shown], cloud.point_radii[cloud.shown]
    along, across = tangents(normals)
    parts = []
    for level, n in enumerate(_CORNERS):
        here = np.flatnonzero(levels == level).astype(np.int32)
        outline = _polygon(n).astype(np.float32)
        corners = outline[:, :1] * along[here, None] + outline[:, 1:] * across[here, None]
        corners *= radii[here, None, None]
        corners += points[here, None]
        fan = np.stack([np.zeros(n - 2), np.arange(1, n - 1), np.arange(2, n)], axis=1).astype(np.int32)
        parts.append((here, corners, fan, np.zeros_like(fan), 1))
    return _joined(cloud, parts, normals)


def tangents(normals: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Two unit vectors across each normal, which turn counter-clockwise seen from where it points to.

    **Source**: Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017, listing 3.
    """
    x, y, z = normals.T
    sign = np.copysign(np.float32(1.0), z)
    a = np.float32(-1.0) / (sign + z)
    b = x * y * a
    along = np.stack([np.float32(1.0) + sign * x * x * a, sign * b, -sign * x], axis=1)
    return along, np.stack([b, sign + y * y * a, -y], axis=1)


# --- spheres ----------------------------------------------------------------------------------------------------------------


@cache
def round_solids() -> tuple[_Solid, ...]:
    """Tetrahedron, octahedron, icosahedron and what it is divided into, coarse to fine."""
    golden = (1.0 + math.sqrt(5.0)) / 2.0
    corners = np.array([(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0)])
    twelve = np.concatenate([corners, np.roll(corners, 1, axis=1), np.roll(corners, 2, axis=1)])
    solids = [
        _hull(np.array([(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)])),
        _hull(np.concatenate([np.eye(3), -np.eye(3)])),
        _hull(twelve),
    ]
    for _ in range(_SUBDIVISIONS):
        solids.append(_divided(solids[-1]))
    return tuple(_sized(solid) for solid in solids)


def _hull(corners: Floats) -> _Solid:
    """The triangles between neighbours of a solid that has nothing but triangles, counter-clockwise from outside."""
    unit = corners / np.linalg.norm(corners[0])
    n = len(unit)
    edge = min(float(np.linalg.norm(unit[0] - other)) for other in unit[1:])
    near = np.linalg.norm(unit[:, None] - unit, axis=2) < 1.01 * edge
    found = [(i, j, k) for i in range(n) for j in range(i + 1, n) for k in range(j + 1, n) if near[i, j] and near[j, k] and near[k, i]]
    turned = [t if np.linalg.det(unit[list(t)]) > 0.0 else (t[0], t[2], t[1]) for t in found]
    return _Solid(unit, np.array(turned, dtype=np.int32))


def _divided(solid: _Solid) -> _Solid:
    """Each triangle cut into four, the new corners on the unit sphere."""
    corners, triangles = solid
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    unique, which = np.unique(edges, axis=0, return_inverse=True)
    middles = corners[unique].sum(axis=1)
    ab, bc, ca = (len(corners) + which.reshape(3, -1)).astype(np.int32)
    a, b, c = triangles.T
    cut = [np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return _Solid(np.concatenate([corners, middles / np.linalg.norm(middles, axis=1, keepdims=True)]), np.concatenate(cut))


def _sized(solid: _Solid) -> _Solid:
    a, b, c = (solid.corners[solid.triangles[:, k]] for k in range(3))
    surface = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0
    return _Solid(solid.corners * math.sqrt(4.0 * math.pi / surface), solid.triangles)


def solid_errors() -> list[float]:
    """How far each solid's surface is from the unit sphere."""
    errors = []
    for corners, triangles in round_solids():
        middles = corners[triangles].mean(axis=1)
        errors.append(max(float(np.linalg.norm(corners[0])) - 1.0, 1.0 - float(np.linalg.norm(middles, axis=1).min())))
    return errors


def _spheres(cloud: PointCloud, levels: Levels) -> Mesh:
    points, radii = cloud.positions[cloud.shown], cloud.point_radii[cloud.shown]
    parts, directions, first = [], [], 0
    for level, solid in enumerate(round_solids()):
        here = np.flatnonzero(levels == level).astype(np.int32)
        corners = radii[here, None, None] * solid.corners.astype(np.float32)
        corners += points[here, None]
        parts.append((here, corners, solid.triangles, solid.triangles + np.int32(first), 0))
        directions.append(solid.corners / np.linalg.norm(solid.corners, axis=1, keepdims=True))
        first += len(solid.corners)
    return _joined(cloud, parts, np.concatenate(directions).astype(np.float32))


def _joined(
    cloud: PointCloud,
    parts: list[tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.int32], NDArray[np.int32], int]],
    normals: NDArray[np.float32],
) -> Mesh:
    """One mesh of (points, their corners, triangles of one, their normals' indices, and whether those count from the point)."""
    positions, triangles, normal_triangles, colors = [], [], [], []
    first = 0
    shown_colors = None if cloud.colors is None else cloud.colors[cloud.shown]
    for here, corners, pattern, normal_pattern, per_point in parts:
        k = corners.shape[1]
        starts = first + k * np.arange(len(here), dtype=np.int32)
        positions.append(corners.reshape(-1, 3))
        triangles.append((starts[:, None, None] + pattern).reshape(-1, 3))
        normal_triangles.append((per_point * here[:, None, None] + normal_pattern).reshape(-1, 3))
        if shown_colors is not None:
            colors.append(np.repeat(shown_colors[here], k, axis=0))
        first += k * len(here)
    return Mesh(
        np.concatenate(positions), np.concatenate(triangles), normals=normals, normal_triangles=np.concatenate(normal_triangles),
        colors=np.concatenate(colors) if colors else None, name=cloud.name,
    )  # fmt: skip
