"""Point clouds: what a scanner, a depth camera or a simulation knows of a surface, without triangles (FoCG 12.1).

    cloud = limner.PointCloud(positions, colors=colors, normals=normals)
    limner.render(cloud).save("cloud.png")

A point has no size, so each is shown as something that has: a disc across its normal, where it has one, or a small sphere. How large, the
cloud itself says, unless it is told: spheres just touch where points stand in a square grid of the cloud's spacing, and discs close up.

    o   o   o        (#(#)#(#)#)     discs of radius s, the spacing, cover a grid with much to spare;
    o   o   o   ->   (#(#)#(#)#)     of a surface whose points are scattered at random exp(-pi) = 4 % stay open
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import LimnerWarning, SceneError
from ..mesh.mesh import named_scalars, read_only

__all__ = ["SHOWN_AS", "PointCloud", "checked_radii", "spacing"]

Floats = NDArray[np.float64]

SHOWN_AS = ("discs", "spheres")

_BITS = 20  # of a cell's place along each axis, at the finest
_MOST_COUNTED = 1 << 17  # points that the spacing is estimated from
_POINTS_IN_A_CELL = 4.0  # on average, where cells are counted
_LONE_RADIUS = 0.5  # of points that have no neighbours
_AT_ONCE = 1 << 18  # points
_MOST_IN_HULL = 1 << 16
_AXES = np.concatenate([np.eye(3), -np.eye(3)])


@dataclass(frozen=True, eq=False)
class PointCloud:
    """Points, each shown as a disc or as a sphere.

    Parameters
    ----------
    positions : (n, 3) float32
        Object space, metres. What is not finite is not shown, which a warning says.
    colors : (n, 3) or (n, 4) float32, optional
        Linear colour (and alpha) of each point.
    normals : (n, 3) float32, optional
        Made unit; where one has no length its disc faces the eye.
    radii : float > 0 or (n,) float32 > 0, optional
        Object space, metres. None: s for discs and ``s / 2`` for spheres, with s the `spacing` of the cloud.
    shown_as : "discs" | "spheres", optional
        Discs without normals face the eye. None: discs if there are normals, else spheres.
    scalars : mapping of str to (n,) float, optional
        What else is known of each point, by name, to be shown by `limner.color_by`.
    name : str

    Raises SceneError where shapes do not fit, a radius is not positive, or no point is finite.

    >>> PointCloud([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], radii=0.5).bounds.tolist()
    [[-0.5, -0.5, -0.5], [1.5, 1.5, 0.5]]
    """

    positions: NDArray[np.float32]
    colors: NDArray[np.float32] | None = None
    normals: NDArray[np.float32] | None = None
    radii: float | NDArray[np.float32] | None = None
    shown_as: str | None = None
    scalars: Mapping[str, NDArray[np.float32]] | None = None
    name: str = ""

    def __post_init__(self) -> None:
        def put(field: str, value: Any) -> None:
            object.__setattr__(self, field, value)

        put("positions", read_only(self.positions, np.float32, (3,), "point_cloud.positions"))
        n_points = len(self.positions)
        if self.colors is not None:
            put("colors", read_only(self.colors, np.float32, (3, 4), "point_cloud.colors"))
            self._check_rows("colors", len(self.colors))
        if self.normals is not None:
            put("normals", _unit(read_only(self.normals, np.float32, (3,), "point_cloud.normals")))
            self._check_rows("normals", len(self.normals))
        if self.radii is not None:
            put("radii", checked_radii(self.radii, n_points, "point_cloud.radii"))
        if self.shown_as is None:
            put("shown_as", "spheres" if self.normals is None else "discs")
        elif self.shown_as not in SHOWN_AS:
            raise SceneError(f"point_cloud.shown_as must be one of {', '.join(SHOWN_AS)}, got {self.shown_as!r}", self.name)
        put("scalars", named_scalars(self.scalars, n_points, "point_cloud.scalars"))
        n_shown = int(np.count_nonzero(self.shown))
        if not n_shown:
            raise SceneError(f"point_cloud.positions must have at least one finite row, got {n_points} rows", self.name)
        if n_shown < n_points:
            warn(f"{n_points - n_shown} of {n_points} points are not finite and are not shown", LimnerWarning, stacklevel=3)

    def _check_rows(self, field: str, n_rows: int) -> None:
        if n_rows != len(self.positions):
            raise SceneError(f"point_cloud.{field} must have one row per point ({len(self.positions)}), got {n_rows}", self.name)

    @cached_property
    def shown(self) -> NDArray[np.bool_]:
        """(n,) bool: which points are finite."""
        return np.asarray(np.isfinite(self.positions).all(axis=1))

    @cached_property
    def point_radii(self) -> NDArray[np.float32]:
        """(n,) float32: the radius of each point, given or from the cloud's spacing."""
        if self.radii is not None:
            return np.broadcast_to(np.asarray(self.radii, dtype=np.float32), (len(self.positions),))
        found = spacing(self.positions)
        radius = found / (1.0 if self.shown_as == "discs" else 2.0) if found > 0.0 else _LONE_RADIUS
        return np.broadcast_to(np.float32(radius), (len(self.positions),))

    def range_along(self, directions: ArrayLike) -> tuple[Floats, Floats]:
        """Tell the least and the greatest a . p over the cloud, (n,) float64 each, for (n, 3) directions a of any length."""
        a = np.asarray(directions, dtype=np.float64)
        low, high = np.full(len(a), np.inf), np.full(len(a), -np.inf)
        length = np.linalg.norm(a, axis=1)
        for start in range(0, len(self.positions), _AT_ONCE):
            part = slice(start, start + _AT_ONCE)
            shown = self.shown[part]
            if shown.any():
                along = self.positions[part][shown].astype(np.float64) @ a.T
                reach = self.point_radii[part][shown].astype(np.float64)[:, None] * length
                low, high = np.minimum(low, (along - reach).min(axis=0)), np.maximum(high, (along + reach).max(axis=0))
        return low, high

    @cached_property
    def bounds(self) -> Floats:
        """(2, 3) float64: least and greatest corner in the node's own space."""
        return np.array(self.range_along(np.eye(3)))

    @property
    def hull(self) -> Floats:
        """(k, 3) float64: points whose convex hull holds the cloud; of a large one the corners of its box."""
        if len(self.positions) > _MOST_IN_HULL:
            low, high = self.bounds
            return np.array([[x[0], y[1], z[2]] for x in (low, high) for y in (low, high) for z in (low, high)])
        points, radii = self.positions[self.shown].astype(np.float64), self.point_radii[self.shown].astype(np.float64)
        # An octahedron of this size holds the sphere.
        return np.asarray((points[:, None] + math.sqrt(3.0) * radii[:, None, None] * _AXES).reshape(-1, 3))

    def __repr__(self) -> str:
        return f"PointCloud({self.name!r}, {len(self.positions)} points)"


def spacing(positions: ArrayLike) -> float:
    """Estimate how far apart the points of a cloud are.

    Parameters
    ----------
    positions : (n, 3) float
        What is not finite does not count.

    Returns
    -------
    float
        0 where fewer than two places are occupied.

    Notes
    -----
    Cubic cells of edge h hold the cloud; N(h) of them hold points. How N changes with h tells the dimension of what was sampled,
    ``d = log2(N(h) / N(2h))``, between 1 (a curve) and 3 (a volume). It has the size ``N h^d``, and each of n points has a share of
    ``s^d``, so that ``s = h (N / n)^(1/d)``. h is the finest edge (of the cloud's extent halved again and again) at which an occupied cell
    holds four points or more; of a large cloud every k-th point is counted, and s is scaled by the share of those.

    **Source**: the box-counting dimension: Falconer, *Fractal Geometry*, 1990, 3.1.

    >>> grid = np.stack(np.meshgrid(np.arange(64), np.arange(64), [0.0]), axis=-1).reshape(-1, 3)
    >>> round(spacing(grid), 1)
    1.0
    """
    points = np.asarray(positions)
    points = points[np.isfinite(points).all(axis=1)]
    n_points = len(points)
    if n_points < 2:
        return 0.0
    counted = points[:: -(-n_points // _MOST_COUNTED)].astype(np.float64)
    low = counted.min(axis=0)
    extent = float((counted.max(axis=0) - low).max())
    if extent == 0.0:
        return 0.0
    places = np.minimum((counted - low) * (2.0**_BITS / extent), 2.0**_BITS - 1.0).astype(np.int64)
    halvings = _BITS
    occupied = _n_cells(places)
    distinct = occupied
    while halvings > 0 and occupied * _POINTS_IN_A_CELL > distinct:
        halvings, places = halvings - 1, places >> 1
        occupied = _n_cells(places)
    coarser = _n_cells(places >> 1)
    dimension = min(max(math.log2(occupied / coarser), 1.0), 3.0) if occupied > coarser else 1.0
    edge = extent * 0.5**halvings
    sampled = edge * (occupied / distinct) ** (1.0 / dimension)
    return float(sampled * (len(counted) / n_points) ** (1.0 / dimension))


def _n_cells(places: NDArray[np.int64]) -> int:
    keys = (places[:, 0] << 2 * _BITS) | (places[:, 1] << _BITS) | places[:, 2]
    return len(np.unique(keys))


def checked_radii(given: Any, count: int, field: str) -> float | NDArray[np.float32]:
    """One radius, or one per point, read-only; SceneError, naming the field, where they are neither or not positive."""
    try:
        radii = np.array(given, dtype=np.float32)
    except (TypeError, ValueError):
        raise SceneError(f"{field} must be a number, or one per point, got {given!r}") from None
    if radii.ndim and radii.shape != (count,):
        raise SceneError(f"{field} must be a number, or one per point ({count}), got shape {radii.shape}")
    bad = np.flatnonzero(~(np.isfinite(radii) & (radii > 0.0)).reshape(-1))
    if len(bad):
        where = f" at point {bad[0]}" if radii.ndim else ""
        raise SceneError(f"{field} must be positive, got {radii.reshape(-1)[bad[0]]}{where}")
    if not radii.ndim:
        return float(radii)
    radii.flags.writeable = False
    return radii


def _unit(normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """Unit vectors; zero for those without length."""
    with np.errstate(over="ignore", invalid="ignore"):
        length = np.sqrt(np.einsum("ij,ij->i", normals, normals, dtype=np.float64))
    usable = np.isfinite(length) & (length > 0.0)
    made = np.where(usable[:, None], normals, np.float32(0.0)) / np.where(usable, length, 1.0)[:, None].astype(np.float32)
    made.flags.writeable = False
    return np.asarray(made)
