"""Lines that run through triangles: where a quantity that is known at their corners passes through zero.

An edge of a mesh can only be a rough silhouette of the smooth surface that the mesh stands for. With normals at the corners, n . e is known
there, and between them it goes evenly: its zeros are a smooth line that crosses the triangles. Where the surface does not turn away yet,
but would if the eye moved a little, runs the suggestive contour: there the curvature towards the eye passes through zero.

**Source**: A. Hertzmann and D. Zorin, "Illustrating smooth surfaces", SIGGRAPH 2000 (smooth silhouettes); D. DeCarlo, A. Finkelstein,
S. Rusinkiewicz and A. Santella, "Suggestive Contours for Conveying Shape", SIGGRAPH 2003; S. Rusinkiewicz, "Estimating Curvatures and
Their Derivatives on Triangle Meshes", 3DPVT 2004 (the tensor of curvature; ours is carried from triangle to corner without a rotation).
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from ..mesh.adjacency import Adjacency
from .segments import ROUNDING, Segments, joined
from .sight_lines import SightLines
from .surfaces import Surfaces, corner_normals

__all__ = ["curvature_tensors", "smooth_silhouettes", "suggestive_contours", "zero_segments"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_EDGE_ON = 2e-7  # cosine between a normal and the ray to the eye: what rounding to float32 leaves of 0
_AT_END = 1e-9  # of a side's length
_BENT = 2.0  # times longest side times turn of the normals: how far a mesh and its smooth surface are apart
_SMOOTHED = 3  # times that curvature is averaged with that of the neighbours
_LEAST_TURN = 0.2  # cosine between normal and ray: nearer to the silhouette there would be two lines for one
_LEAST_CHANGE = 0.5  # of curvature along the surface towards the eye, times the square of the object's extent over 10


def zero_segments(surfaces: Surfaces, values: Floats) -> tuple[Floats, Indices]:
    """Where values at corners, (m, 3), pass through zero: ends (k, 2, 3), equal to the bit where two meet, and triangles (k,)."""
    above = values > 0.0
    rows = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    # The corner that is alone on its side comes first: the line crosses the two sides that meet there.
    alone_above = above[rows].sum(axis=1) == 1
    alone = (above[rows] == alone_above[:, None]).argmax(axis=1)
    ends = [_crossing(surfaces, values, rows, alone, (alone + k) % 3) for k in (1, 2)]
    made = np.stack(ends, axis=1)
    kept = (made[:, 0] != made[:, 1]).any(axis=1)
    return made[kept], rows[kept]


def _crossing(surfaces: Surfaces, values: Floats, rows: Indices, i: Indices, j: Indices) -> Floats:
    a, b = surfaces.triangles[rows, i], surfaces.triangles[rows, j]
    f, g = values[rows, i], values[rows, j]
    # From the lesser point to the greater, so that both triangles at a side get the same bits.
    swap = a > b
    a, b, f, g = np.where(swap, b, a), np.where(swap, a, b), np.where(swap, g, f), np.where(swap, f, g)
    p, q = surfaces.points[a], surfaces.points[b]
    return _on(p, q, f / (f - g))


def smooth_silhouettes(surfaces: Surfaces, adjacency: Adjacency, sight: SightLines, kind: int) -> Segments:
    """The zeros of n . e, with n between the corners' normals; and, where two triangles have others at their common edge, the parts of
    the edge at which one of them faces the eye and the other does not."""
    normals = corner_normals(surfaces)
    corners = surfaces.points[surfaces.triangles]
    values = (normals * sight.towards(corners.reshape(-1, 3)).reshape(corners.shape)).sum(axis=2)
    distance = np.linalg.norm(sight.towards(corners.reshape(-1, 3)), axis=1).reshape(values.shape)
    values[np.abs(values) < _EDGE_ON * distance] = 0.0
    values[~surfaces.bounded] = 1.0
    ends, rows = zero_segments(surfaces, values)
    gradient, _ = _gradient(corners[rows], values[rows])
    # Towards the eye n . e grows where the surface bends away, and falls where it hollows: there it hides its own silhouette.
    inwards = (gradient * sight.towards(ends.mean(axis=1))).sum(axis=1) < 0.0
    smooth = _segments(surfaces, kind, ends, rows, _apart(corners[rows], normals[rows]), inwards.astype(np.int64))
    ends, one, other = _jumps(surfaces, adjacency, values)
    slack = np.maximum(_apart(corners[one], normals[one]), _apart(corners[other], normals[other]))
    sharp = _segments(surfaces, kind, ends, one, slack, np.zeros(len(one), dtype=np.int64))
    sharp.triangles[:, 1] = other
    return joined([smooth, sharp])


def _apart(corners: Floats, normals: Floats) -> Floats:
    """How far triangles and the smooth surface that they stand for may be apart, (k,) metres."""
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0.0)
    bent = np.linalg.norm(normals - np.roll(normals, 1, axis=1), axis=2).max(axis=1, initial=0.0)
    return np.asarray(_BENT * longest * bent)


def _jumps(surfaces: Surfaces, adjacency: Adjacency, values: Floats) -> tuple[Floats, Indices, Indices]:
    """The parts of edges at which values on both sides have opposite signs: ends (k, 2, 3), and the triangles on both sides, (k,) each."""
    first = adjacency.edge_start[:-1][adjacency.edge_counts == 2]
    one, other = adjacency.edge_halfedges[first].astype(np.int64), adjacency.edge_halfedges[first + 1].astype(np.int64)
    flat, corner = values.reshape(-1), surfaces.triangles.reshape(-1)
    f, g = _from_lesser(flat, corner, one), _from_lesser(flat, corner, other)
    apart = ((f > 0.0) != (g > 0.0)).any(axis=0)
    one, other, f, g = one[apart], other[apart], f[:, apart], g[:, apart]
    following = np.where(one % 3 == 2, one - 2, one + 1)
    p, q = np.sort(np.stack([corner[one], corner[following]]), axis=0)
    p, q = surfaces.points[p], surfaces.points[q]
    zeros = np.sort(np.stack([_zero(f), _zero(g)]), axis=0)
    stops = np.stack([np.zeros(len(one)), zeros[0], zeros[1], np.ones(len(one))])
    ends, rows = [], []
    for a, b in itertools.pairwise(stops):
        middle = 0.5 * (a + b)
        parted = (a < b) & ((f[0] + middle * (f[1] - f[0]) > 0.0) != (g[0] + middle * (g[1] - g[0]) > 0.0))
        row = np.flatnonzero(parted)
        ends.append(np.stack([_on(p[row], q[row], a[row]), _on(p[row], q[row], b[row])], axis=1))
        rows.append(row)
    row = np.concatenate(rows)
    return np.concatenate(ends), one[row] // 3, other[row] // 3


def _from_lesser(flat: Floats, corner: Indices, half_edge: Indices) -> Floats:
    """Values at the ends of half-edges, (2, k), that of the lesser point first."""
    following = np.where(half_edge % 3 == 2, half_edge - 2, half_edge + 1)
    swap = corner[half_edge] > corner[following]
    return np.stack([flat[np.where(swap, following, half_edge)], flat[np.where(swap, half_edge, following)]])


def _zero(f: Floats) -> Floats:
    """Where values that go evenly from f[0] to f[1] pass through zero; 1: nowhere."""
    mixed = (f[0] > 0.0) != (f[1] > 0.0)
    return np.asarray(np.where(mixed, f[0] / np.where(mixed, f[0] - f[1], 1.0), 1.0))


def _on(p: Floats, q: Floats, t: Floats) -> Floats:
    """Points at t between p and q; where t is 0 or 1 but for rounding, p and q themselves."""
    between = p + t[:, None] * (q - p)
    return np.asarray(np.where((t > 1.0 - _AT_END)[:, None], q, np.where((t < _AT_END)[:, None], p, between)))


def suggestive_contours(surfaces: Surfaces, sight: SightLines, kind: int) -> Segments:
    """The zeros of the curvature in the direction of the eye, on what faces it, where the surface bends away in front of them."""
    normals = corner_normals(surfaces)
    points, triangles = surfaces.points, surfaces.triangles
    at_points = np.zeros((len(points), 3))
    at_points[triangles.reshape(-1)] = normals.reshape(-1, 3)
    tensors = curvature_tensors(points, triangles, at_points)
    to_eye = sight.towards(points)
    to_eye = to_eye / np.maximum(np.linalg.norm(to_eye, axis=1), 1e-300)[:, None]
    facing = (to_eye * at_points).sum(axis=1)
    along = to_eye - facing[:, None] * at_points
    squared = np.maximum((along * along).sum(axis=1), 1e-300)
    radial = np.einsum("ni,nij,nj->n", along, tensors, along) / squared
    values = radial[triangles]
    values[~surfaces.bounded] = 1.0
    ends, rows = zero_segments(surfaces, values)
    gradient, normal = _gradient(points[triangles[rows]], values[rows])
    direction = along[triangles[rows]].mean(axis=1)
    length = np.linalg.norm(direction, axis=1)
    change = (gradient * direction).sum(axis=1) / np.maximum(length, 1e-300)
    size = 0.1 * surfaces.extent
    seen = (facing[triangles[rows]].min(axis=1) > _LEAST_TURN) & ((normal * sight.towards(ends[:, 0])).sum(axis=1) > 0.0)
    kept = seen & (change * size * size > _LEAST_CHANGE)
    return _segments(surfaces, kind, ends[kept], rows[kept], np.zeros(int(kept.sum())), np.zeros(int(kept.sum()), dtype=np.int64))


def _segments(surfaces: Surfaces, kind: int, ends: Floats, rows: Indices, slack: Floats, hidden: Indices) -> Segments:
    own = np.stack([rows, np.full(len(rows), -1)], axis=1)
    return Segments(np.full(len(rows), kind), ends, own, slack + ROUNDING * surfaces.extent, hidden, surfaces.instance[rows])


def _gradient(corners: Floats, values: Floats) -> tuple[Floats, Floats]:
    """In triangles (k, 3, 3) with values (k, 3) at their corners: the gradient, (k, 3), and the normal, of any length."""
    a, b, c = corners.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    squared = (normal * normal).sum(axis=1)
    opposite = np.stack([c - b, a - c, b - a], axis=1)
    turned = np.cross(normal[:, None], opposite)
    return (values[:, :, None] * turned).sum(axis=1) / np.maximum(squared, 1e-300)[:, None], normal


def curvature_tensors(points: Floats, triangles: Indices, normals: Floats) -> Floats:
    """How normals turn along the surface, (n, 3, 3) float64, 1/m: d . T d is the curvature in a unit direction d, positive on a sphere.

    `normals`, (n, 3), are those at the points.
    """
    corners, at = points[triangles], normals[triangles]
    sides = np.stack([corners[:, 2] - corners[:, 1], corners[:, 0] - corners[:, 2], corners[:, 1] - corners[:, 0]], axis=1)
    turns = np.stack([at[:, 2] - at[:, 1], at[:, 0] - at[:, 2], at[:, 1] - at[:, 0]], axis=1)
    across = np.cross(sides[:, 0], sides[:, 1])
    double_area = np.linalg.norm(across, axis=1)
    safe = double_area > 1e-12 * np.maximum((sides * sides).sum(axis=2).max(axis=1, initial=0.0), 1e-300)
    u = sides[:, 0] / np.maximum(np.linalg.norm(sides[:, 0], axis=1), 1e-300)[:, None]
    v = np.cross(across / np.where(safe, double_area, 1.0)[:, None], u)
    su, sv = np.einsum("mki,mi->mk", sides, u), np.einsum("mki,mi->mk", sides, v)
    tu, tv = np.einsum("mki,mi->mk", turns, u), np.einsum("mki,mi->mk", turns, v)
    # Least squares for e, f, g in [e f; f g] side = turn, of three sides.
    uu, uv, vv = (su * su).sum(axis=1), (su * sv).sum(axis=1), (sv * sv).sum(axis=1)
    zero = np.zeros(len(uu))
    matrix = np.stack([np.stack([uu, uv, zero], 1), np.stack([uv, uu + vv, uv], 1), np.stack([zero, uv, vv], 1)], axis=1)
    wanted = np.stack([(su * tu).sum(axis=1), (su * tv + sv * tu).sum(axis=1), (sv * tv).sum(axis=1)], axis=1)
    matrix[~safe] = np.eye(3)
    wanted[~safe] = 0.0
    e, f, g = np.linalg.solve(matrix, wanted[:, :, None])[:, :, 0].T
    tensors = (
        e[:, None, None] * u[:, :, None] * u[:, None]
        + f[:, None, None] * (u[:, :, None] * v[:, None] + v[:, :, None] * u[:, None])
        + g[:, None, None] * v[:, :, None] * v[:, None]
    )
    made = _at_points(triangles, tensors * double_area[:, None, None], double_area, len(points))
    for _ in range(_SMOOTHED):
        made = _at_points(triangles, made[triangles].mean(axis=1) * double_area[:, None, None], double_area, len(points))
    return made


def _at_points(triangles: Indices, weighted: Floats, weights: Floats, n_points: int) -> Floats:
    """Means at points of what triangles have, (m, 3, 3), given times their weights."""
    corner = triangles.reshape(-1)
    total = np.bincount(corner, np.repeat(weights, 3), n_points)
    columns = [np.bincount(corner, np.repeat(column, 3), n_points) for column in weighted.reshape(-1, 9).T]
    return np.asarray(np.stack(columns, axis=1).reshape(-1, 3, 3) / np.where(total > 0.0, total, 1.0)[:, None, None])
