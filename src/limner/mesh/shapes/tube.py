"""Tubes along lines of points: wires, ropes, knots, streamlines.

A ring of points is carried along the line in a frame that does not turn about it more than the line makes it, and set where two pieces
meet in the plane between them, so that each piece is a cylinder (or a cone) from ring to ring. A line that closes brings the frame back
turned by some angle, which is spread over its length: no piece shows it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...curves.frames import rotation_minimizing_frames
from ...errors import SceneError
from ..mesh import Mesh
from ..sizes import check_count, check_triangles, finite_points
from .bands import halved

__all__ = ["CAPS", "tube"]

CAPS = ("round", "flat", "none")
_MITRE_LIMIT = 3.0  # how much wider than its radius a tube gets across a sharp bend

Points = NDArray[np.float64]
Indices = NDArray[np.int64]


def tube(line: ArrayLike, radius: ArrayLike = 0.1, n: int = 16, caps: str = "round", closed: bool = False) -> Mesh:
    """Make a tube round a line of points.

    Parameters
    ----------
    line : (k, 3) float, k >= 2
        Points that are joined by straight pieces, metres; of points that are equal to the one before one is kept.
    radius : float > 0, or (k,) floats > 0
        Of the tube, everywhere or at each point.
    n : int >= 3
        Sides.
    caps : str
        What ends it: "round" (half balls), "flat" (disks) or "none"; nothing where it is closed.
    closed : bool
        The last point is joined to the first.

    Returns
    -------
    Mesh
        Smooth round about and along the line. u runs around, counter-clockwise seen from the end towards the start, v along the line by
        its length; a flat cap shows the disk cut out of the texture.

    Examples
    --------
    >>> tube([(0, 0, 0), (0, 1, 0)], 0.1, 8, caps="flat")
    Mesh('tube', 18 positions, 32 triangles)
    """
    points, radii = _checked(line, radius, closed)
    n = check_count(n, 3, "tube.n")
    check_triangles(2 * n * (len(points) + n), f"tube.n = {n} along {len(points)} points")
    if caps not in CAPS:
        raise SceneError(f"tube.caps must be one of {', '.join(CAPS)}, got {caps!r}")
    tangents = _tangents(points, closed)
    side, lift = rotation_minimizing_frames(points, tangents, closed)
    rings = _Rings(n)
    round_ends = caps == "round" and not closed
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    span = arc[-1] + (float(np.linalg.norm(points[0] - points[-1])) if closed else 0.0)
    # Half a circle's length belongs to each round end
    before = 0.5 * math.pi * radii[0] if round_ends else 0.0
    span += before + (0.5 * math.pi * radii[-1] if round_ends else 0.0)
    around = np.cos(rings.angle)[:, None] * side[:, None] + np.sin(rings.angle)[:, None] * lift[:, None]
    if round_ends:
        rings.add_ball(points[0], radii[0], around[0], -tangents[0], 0.0, before / span, at_start=True)
    rings.add(*_mitred(points, radii, tangents, around, closed), (before + arc) / span)
    if round_ends:
        rings.add_ball(points[-1], radii[-1], around[-1], tangents[-1], (before + arc[-1]) / span, 1.0, at_start=False)
    return rings.mesh(closed, flat_caps=(-tangents[0], tangents[-1]) if caps == "flat" and not closed else None)


def _checked(line: ArrayLike, radius: ArrayLike, closed: bool) -> tuple[Points, Points]:
    points = finite_points(line, 3, 2, "tube.line")
    radii = np.asarray(radius, dtype=np.float64)
    if radii.shape not in ((), (len(points),)):
        raise SceneError(f"tube.radius must be one number or one per point ({len(points)}), got shape {radii.shape}")
    if not (np.isfinite(radii) & (radii > 0.0)).all():
        raise SceneError(f"tube.radius must be positive and finite, got {float(np.nanmin(radii)) if radii.ndim else float(radii)}")
    radii = np.broadcast_to(radii, (len(points),))
    kept = np.concatenate([[True], (np.diff(points, axis=0) != 0.0).any(axis=1)])
    if closed and (points[kept][0] == points[kept][-1]).all():
        kept[np.flatnonzero(kept)[-1]] = False
    points, radii = points[kept], radii[kept]
    if len(points) < (3 if closed else 2):
        raise SceneError(f"tube.line must have at least {3 if closed else 2} distinct points, got {len(points)}")
    return points, radii


def _pieces(points: Points, closed: bool) -> tuple[Points, Points]:
    """Unit directions of the pieces before and after each point."""
    along = np.diff(points, axis=0, append=points[:1] if closed else points[-1:] + (points[-1:] - points[-2:-1]))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    before, after = np.roll(along, 1, axis=0), along
    if not closed:
        before[0] = after[0]
    return before, after


def _tangents(points: Points, closed: bool) -> Points:
    before, after = _pieces(points, closed)
    mean = before + after
    lengths = np.linalg.norm(mean, axis=1, keepdims=True)
    if lengths.min() < 1e-6:
        raise SceneError(f"tube.line must not turn back on itself, as it does at point {int(np.argmin(lengths))}")
    return mean / lengths


def _mitred(points: Points, radii: Points, tangents: Points, around: Points, closed: bool) -> tuple[Points, Points]:
    """Positions and normals of the rings (k, n, 3), which lie in the planes between the pieces."""
    _, after = _pieces(points, closed)
    cosine = np.maximum((tangents * after).sum(axis=1), 1.0 / _MITRE_LIMIT)[:, None]
    bend = after - (after * tangents).sum(axis=1, keepdims=True) * tangents
    lengths = np.linalg.norm(bend, axis=1, keepdims=True)
    bend = np.where(lengths > 1e-9, bend / np.maximum(lengths, 1e-9), 0.0)
    across = np.einsum("knc,kc->kn", around, bend)[:, :, None] * bend[:, None]
    positions = points[:, None] + radii[:, None, None] * (around + (1.0 / cosine - 1.0)[:, None] * across)
    # A tube that narrows looks ahead
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    slope = np.zeros(len(points)) if closed else np.gradient(radii, arc)
    normals = around - slope[:, None, None] * tangents[:, None]
    return positions, normals / np.linalg.norm(normals, axis=2, keepdims=True)


class _Rings:
    """Rings of n points, from the start of the tube to its end; poles are rings that are one point."""

    def __init__(self, n: int) -> None:
        self.n = n
        self.angle = 2.0 * math.pi * np.arange(n) / n
        self.positions: list[Points] = []
        self.normals: list[Points] = []
        self.v: list[float] = []
        self.start_pole: Points | None = None
        self.end_pole: Points | None = None

    def add(self, positions: Points, normals: Points, v: Points) -> None:
        self.positions += list(positions)
        self.normals += list(normals)
        self.v += v.tolist()

    def add_ball(self, center: Points, radius: float, around: Points, pole: Points, v0: float, v1: float, *, at_start: bool) -> None:
        """Half a ball: its rings between the pole and the rim, which the tube has already."""
        n_bands = max(1, self.n // 4)
        latitude = 0.5 * math.pi * np.arange(1, n_bands) / n_bands
        share = latitude / (0.5 * math.pi)
        if at_start:
            latitude, share = latitude[::-1], 1.0 - share[::-1]
            self.start_pole = center + radius * pole
        else:
            self.end_pole = center + radius * pole
        normals = np.cos(latitude)[:, None, None] * around + np.sin(latitude)[:, None, None] * pole
        self.add(center + radius * normals, normals, v0 + (v1 - v0) * share)

    def mesh(self, closed: bool, flat_caps: tuple[Points, Points] | None) -> Mesh:
        """Join the rings."""
        n, k = self.n, len(self.positions)
        rows = k if closed else k - 1
        column, row = np.arange(n), np.arange(rows)[:, None]
        following, upper = (column + 1) % n, (row + 1) % k
        triangles = [halved(n * row + column, n * row + following, n * upper + following, n * upper + column)]
        uv_row, uv_upper = (n + 1) * row, (n + 1) * (row + 1)
        uv_triangles = [halved(uv_row + column, uv_row + column + 1, uv_upper + column + 1, uv_upper + column)]
        v = np.array([*self.v, 1.0] if closed else self.v)
        positions, normals = [np.concatenate(self.positions)], [np.concatenate(self.normals)]
        uvs = [np.stack(np.broadcast_arrays(np.arange(n + 1) / n, v[:, None]), axis=-1).reshape(-1, 2)]
        normal_triangles = [triangles[0]]
        rims = ((0, self.start_pole, following, column, 0.0, -1.0), (k - 1, self.end_pole, column, following, 1.0, 1.0))
        n_positions, n_normals, n_uvs = n * k, n * k, (n + 1) * len(v)
        for index, (ring, pole, first, second, end_v, turn) in enumerate(rims):
            cap_normal = flat_caps[index] if flat_caps is not None else None
            if pole is None and cap_normal is None:
                continue
            middle = self.positions[ring].mean(axis=0) if pole is None else pole
            positions.append(middle[None])
            triangles.append(np.stack([n * ring + first, n * ring + second, np.full(n, n_positions)], axis=1))
            n_positions += 1
            if cap_normal is not None:
                normals.append(cap_normal[None])
                normal_triangles.append(np.full((n, 3), n_normals))
                disk = 0.5 + 0.5 * np.stack([np.cos(self.angle), turn * np.sin(self.angle)], axis=1)
                uvs.append(np.concatenate([disk, [[0.5, 0.5]]]))
                uv_triangles.append(n_uvs + np.stack([first, second, np.full(n, n)], axis=1))
                n_normals, n_uvs = n_normals + 1, n_uvs + n + 1
            else:
                assert pole is not None
                outwards = pole - self.positions[ring].mean(axis=0)
                normals.append((outwards / np.linalg.norm(outwards))[None])
                normal_triangles.append(np.stack([n * ring + first, n * ring + second, np.full(n, n_normals)], axis=1))
                uvs.append(np.stack([(column + 0.5) / n, np.full(n, end_v)], axis=1))
                left, right = (column + 1, column) if index == 0 else (column, column + 1)
                uv_triangles.append(np.stack([(n + 1) * ring + left, (n + 1) * ring + right, n_uvs + column], axis=1))
                n_normals, n_uvs = n_normals + 1, n_uvs + n
        return Mesh(
            positions=np.concatenate(positions).astype(np.float32),
            triangles=np.concatenate(triangles).astype(np.int32),
            normals=np.concatenate(normals).astype(np.float32),
            normal_triangles=np.concatenate(normal_triangles).astype(np.int32),
            uvs=np.concatenate(uvs).astype(np.float32),
            uv_triangles=np.concatenate(uv_triangles).astype(np.int32),
            name="tube",
        )
