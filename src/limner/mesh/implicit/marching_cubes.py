"""Triangles of an implicit surface, or of a level of a table of samples: marching cubes (FoCG 22).

A grid of cubes; where the corners of one lie on both sides of the surface, it is crossed in one of the ways of `cube_cases`. Vertices lie
on edges of the grid and are shared by all around them. Where a face leaves open which corners belong together, the sign of the bilinear
interpolant in its saddle point decides, for both cubes alike: the surface is closed but where it leaves the box, and a manifold, whatever
the numbers are.

Which of both to use: `marching_cubes` makes a third as many triangles as `level_set`'s tetrahedra, better shaped, with normals, and takes
tables; `level_set`, which needs no table of cases, also crosses the cubes' diagonals and so follows thin parts a little further.

**Source**: Lorensen and Cline, "Marching Cubes", SIGGRAPH 1987; Nielson and Hamann, "The Asymptotic Decider", IEEE Visualization 1991;
Chernyaev, *Marching Cubes 33*, CERN CN/95-17, 1995, without his tests for tunnels inside a cube: where two sheets pass through one cube,
they stay apart.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import SceneError
from ..mesh import Mesh
from ..normals import vertex_normals
from ..sizes import check_count
from .cube_cases import EDGES, FACES, MIDDLE, case_table
from .level_set import crossings

__all__ = ["INSIDES", "marching_cubes"]

INSIDES = ("below", "above")
_MOST_CUBES = 1 << 30
_SAMPLES_AT_ONCE = 1 << 21
# What lies beyond a cap, whatever the samples are
_BEYOND = 1.0
# Of an edge: nearer to its ends no vertex comes, so that no triangle vanishes
_MARGIN = 1e-4
# Of a cube: the step of central differences, where float64 has digits enough and the surface has not yet turned
_STEP = 1e-3

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Field = Callable[[Floats], ArrayLike]


def marching_cubes(
    field: Field | ArrayLike,
    bounds: ArrayLike | None = None,
    resolution: int | tuple[int, int, int] = 64,
    level: float = 0.0,
    *,
    inside: str = "below",
    capped: bool = False,
) -> Mesh:
    """Find triangles of the surface where a function, or a table of samples, has a value.

    Parameters
    ----------
    field : callable, or (nx, ny, nz) float
        Takes points (k, 3) float64 and returns (k,); or samples at the points of a grid, x along the first axis, at least 2 along each.
    bounds : (2, 3) float, optional
        Least and greatest corner of the box; a table's first and last samples lie on its faces. Must be given with a function; None, of
        a table: its indices are its coordinates.
    resolution : int >= 1, or three
        Cubes along the longest edge of the box (the others in proportion), or along each. Not looked at where samples are given.
    level : float
        The value on the surface.
    inside : "below" or "above"
        Where the solid is: below, as of distances, or above, as of densities.
    capped : bool
        Closes the surface where it leaves the box, by taking all beyond for outside.

    Returns
    -------
    Mesh
        Counter-clockwise seen from outside; smooth normals along the gradient. Without triangles where there is no surface. Of a function
        the vertices lie on the surface itself, found along the edges of the grid, of a table where it is interpolated.

    Examples
    --------
    >>> marching_cubes(lambda p: np.linalg.norm(p, axis=1) - 1.0, [(-1.1, -1.1, -1.1), (1.1, 1.1, 1.1)], 8)
    Mesh('surface', 270 positions, 536 triangles)
    """
    grid = _grid(field, bounds, resolution, level, inside, capped)
    cells = [_crossed(grid, samples, first) for samples, first in grid.slabs()]
    corners, middles = _all_cells(cells)
    keys, vertex = np.unique(corners, return_inverse=True)
    n_middles = int((keys < 0).sum())
    # Middle k has the key -1 - k, so that their keys come first, backwards; they become the last vertices
    points, gradients = _edge_vertices(grid, keys[n_middles:])
    number = np.concatenate([len(points) + np.arange(n_middles)[::-1], np.arange(len(points))])
    if n_middles:
        at = np.searchsorted(keys[n_middles:], np.maximum(middles, 0))
        known = (middles >= 0)[..., None]
        points = np.concatenate([points, (points[at] * known).sum(axis=1) / known.sum(axis=1)])
        gradients = np.concatenate([gradients, (gradients[at] * known).sum(axis=1)])
    caps = np.concatenate([cell.caps for cell in cells])
    return _mesh(points, number[vertex.reshape(-1)].reshape(-1, 3), gradients, caps)


class _Grid(NamedTuple):
    """Where samples are taken, and what they are: below 0 inside.

    A cap is a layer of points outside around the box, which lie in the same places as those on its faces.

    Attributes
    ----------
    function : callable, or None
        (k, 3) to (k,).
    table : (nx, ny, nz), or None
    sign, level : float
        A sample is ``sign * (value - level)``.
    axes : three (n,) float64
        Coordinates of the points.
    capped : bool
    """

    function: Callable[[Floats], Floats] | None
    table: NDArray[np.floating] | None
    sign: float
    level: float
    axes: tuple[Floats, Floats, Floats]
    capped: bool

    @property
    def shape(self) -> tuple[int, int, int]:
        """Points along x, y and z."""
        nx, ny, nz = (len(axis) for axis in self.axes)
        return nx, ny, nz

    def values(self, points: Floats) -> Floats:
        """Samples of the function."""
        assert self.function is not None
        return self.sign * (self.function(points) - self.level)

    def slabs(self) -> Iterator[tuple[Floats, int]]:
        """Samples of layers along x that overlap by one, and the number of the first layer."""
        nx, ny, nz = self.shape
        thickness = max(1, _SAMPLES_AT_ONCE // (ny * nz))
        samples = self._layers(0, 1)
        for first in range(0, nx - 1, thickness):
            last = min(first + thickness, nx - 1)
            samples = np.concatenate([samples[-1:], self._layers(first + 1, last + 1)])
            yield samples, first

    def _layers(self, begin: int, end: int) -> Floats:
        """Samples of layers begin .. end - 1."""
        pad = int(self.capped)
        made = np.full((end - begin, *self.shape[1:]), _BEYOND)
        low, high = max(begin, pad), min(end, self.shape[0] - pad)
        if high > low:
            inner = slice(pad, -pad or None)
            if self.table is None:
                x, y, z = self.axes[0][low:high], self.axes[1][inner], self.axes[2][inner]
                points = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
                values = self.values(points.reshape(-1, 3)).reshape(points.shape[:3])
            else:
                values = self.sign * (self.table[low - pad : high - pad].astype(np.float64) - self.level)
            made[low - begin : high - begin, inner, inner] = values
        return made

    def samples(self, index: Indices) -> Floats:
        """Samples of a table at points (k, 3) of the grid."""
        assert self.table is not None
        inner = index - int(self.capped)
        size = np.array(self.table.shape)
        values = self.table[tuple(np.clip(inner, 0, size - 1).T)].astype(np.float64)
        return np.where(((inner < 0) | (inner >= size)).any(axis=1), _BEYOND, self.sign * (values - self.level))

    def gradients(self, index: Indices) -> Floats:
        """Central differences of a table at points (k, 3) of the grid, one-sided on its border."""
        assert self.table is not None
        pad = int(self.capped)
        gradients = np.empty((len(index), 3))
        inside = np.clip(index, pad, np.array(self.shape) - 1 - pad)
        for k in range(3):
            before, after = inside.copy(), inside.copy()
            before[:, k] = np.maximum(before[:, k] - 1, pad)
            after[:, k] = np.minimum(after[:, k] + 1, self.shape[k] - 1 - pad)
            width = self.axes[k][after[:, k]] - self.axes[k][before[:, k]]
            gradients[:, k] = (self.samples(after) - self.samples(before)) / width
        return gradients


def _grid(
    field: Field | ArrayLike, bounds: ArrayLike | None, resolution: int | tuple[int, int, int], level: float, inside: str, capped: bool
) -> _Grid:
    if inside not in INSIDES:
        raise SceneError(f"marching_cubes.inside must be one of {', '.join(INSIDES)}, got {inside!r}")
    if not np.isfinite(level):
        raise SceneError(f"marching_cubes.level must be finite, got {level}")
    function, table = (_checked_function(field), None) if callable(field) else (None, _checked_table(field))
    if table is None:
        if bounds is None:
            raise SceneError("marching_cubes.bounds must be given with a function")
        box = _checked_bounds(bounds)
        cubes = _cubes(resolution, box)
    else:
        cubes = tuple(n - 1 for n in table.shape)
        box = np.array([(0, 0, 0), cubes], dtype=np.float64) if bounds is None else _checked_bounds(bounds)
    if cubes[0] * cubes[1] * cubes[2] > _MOST_CUBES:
        raise SceneError(f"marching_cubes.resolution: {' x '.join(map(str, cubes))} cubes are more than the {_MOST_CUBES:,} that are tried")
    pad = int(capped)
    x, y, z = (np.pad(np.linspace(low, high, n + 1), pad, mode="edge") for low, high, n in zip(*box, cubes, strict=True))
    return _Grid(function, table, 1.0 if inside == "below" else -1.0, float(level), (x, y, z), capped)


def _checked_bounds(bounds: ArrayLike) -> Floats:
    box = np.asarray(bounds, dtype=np.float64)
    if box.shape != (2, 3) or not np.isfinite(box).all() or not (box[0] < box[1]).all():
        raise SceneError(f"marching_cubes.bounds must be a least and a greatest corner, (2, 3) and finite, got {box.tolist()}")
    return box


def _cubes(resolution: int | tuple[int, int, int], box: Floats) -> tuple[int, ...]:
    if isinstance(resolution, tuple | list):
        if len(resolution) != 3:
            raise SceneError(f"marching_cubes.resolution must be one number or three, got {resolution}")
        return tuple(check_count(n, 1, "marching_cubes.resolution") for n in resolution)
    longest = check_count(resolution, 1, "marching_cubes.resolution")
    size = box[1] - box[0]
    return tuple(max(1, round(longest * float(edge / size.max()))) for edge in size)


def _checked_table(field: ArrayLike) -> NDArray[np.floating]:
    table = np.asarray(field)
    if table.ndim != 3 or min(table.shape) < 2 or table.dtype.kind not in "fiub":
        raise SceneError(
            f"marching_cubes.field must be a function or samples of shape (nx, ny, nz), at least 2 each, got {table.dtype} {table.shape}"
        )
    if table.dtype.kind == "f" and not np.isfinite(table).all():
        at = tuple(int(i) for i in np.argwhere(~np.isfinite(table))[0])
        raise SceneError(f"marching_cubes.field must be finite, got {table[at]} at sample {at}")
    return table


def _checked_function(field: Field) -> Callable[[Floats], Floats]:
    def values(points: Floats) -> Floats:
        made = np.asarray(field(points), dtype=np.float64)
        if made.shape != (len(points),):
            raise SceneError(f"marching_cubes.field must return shape ({len(points)},) for points ({len(points)}, 3), got {made.shape}")
        if not np.isfinite(made).all():
            bad = int(np.flatnonzero(~np.isfinite(made))[0])
            raise SceneError(f"marching_cubes.field must be finite, got {made[bad]} at {points[bad].tolist()}")
        return made

    return values


class _Cells(NamedTuple):
    """The triangles of a slab of cubes.

    Attributes
    ----------
    corners : (m, 3) int64
        Vertices by their keys: 3 point + axis of an edge of the grid, or -1 - k of middle k.
    middles : (k, 12) int64
        Keys of the edges that each middle is the mean of; -1: no more.
    caps : (m,) int64
        The face of the box that a triangle of a cap lies on, 2 axis + (0 at its least, 1 at its greatest); -1: it is of no cap.
    """

    corners: Indices
    middles: Indices
    caps: Indices


def _crossed(grid: _Grid, samples: Floats, first: int) -> _Cells:
    """The triangles in a slab of cubes."""
    table = case_table()
    _, ny, nz = grid.shape
    below = (samples < 0.0).view(np.uint8)
    case = np.zeros(tuple(n - 1 for n in samples.shape), dtype=np.uint8)
    for corner in range(8):
        x, y, z = corner & 1, corner >> 1 & 1, corner >> 2
        case |= below[x : x + case.shape[0], y : y + case.shape[1], z : z + case.shape[2]] << corner
    cubes = np.flatnonzero((case != 0) & (case != 255))
    cases = case.reshape(-1)[cubes].astype(np.int64)
    i, j, k = np.unravel_index(cubes, case.shape)
    step = np.array([ny * nz, nz, 1])
    origin = i * step[0] + j * step[1] + k
    offsets = np.array([(corner & 1) * step[0] + (corner >> 1 & 1) * step[1] + (corner >> 2) for corner in range(8)])
    entry = 64 * cases + _joined(table.ambiguous[cases], samples.reshape(-1), origin, offsets)
    count = table.start[entry + 1] - table.start[entry]
    cube = np.repeat(np.arange(len(cubes)), count)
    row = table.start[entry][cube] + np.arange(len(cube)) - np.repeat(np.cumsum(count) - count, count)
    # The key of an edge: its lesser point's number in the whole grid, and its axis
    origin = origin + first * step[0]
    edge_keys = np.array([3 * offsets[corner] + axis for corner, axis in EDGES] + [0])
    named = table.triangles[row]
    corners = 3 * origin[cube][:, None] + edge_keys[named]
    corners, middles = _with_middles(corners, named, table.loop[row], 3 * origin[cube], edge_keys)
    caps = np.full(len(cube), -1, dtype=np.int64)
    if grid.capped:
        for axis, at in enumerate((i + first, j, k)):
            caps[(at == 0)[cube]] = 2 * axis
            caps[(at == grid.shape[axis] - 2)[cube]] = 2 * axis + 1
    return _Cells(corners, middles, caps)


def _joined(ambiguous: Indices, samples: Floats, origin: Indices, offsets: Indices) -> Indices:
    """Bits of the faces whose inside is joined across the face."""
    joined = np.zeros(len(origin), dtype=np.int64)
    for f, face in enumerate(FACES):
        open_ = np.flatnonzero(ambiguous >> f & 1)
        a, b, c, d = (samples[origin[open_] + offsets[corner]] for corner in face)
        # The saddle is a c - b d over a + c - b - d; both cubes compute the very same products
        along, across = a * c, b * d
        joined[open_] |= np.where(a < 0.0, along > across, across > along).astype(np.int64) << f
    return joined


def _with_middles(
    corners: Indices, named: Indices, loops: Indices, origin: Indices, edge_keys: Indices
) -> tuple[Indices, Indices]:
    """Give the middles of fans their keys, and list what they are the means of."""
    rows = np.flatnonzero((named == MIDDLE).any(axis=1))
    if not len(rows):
        return corners, np.zeros((0, 12), dtype=np.int64)
    # A fan's triangles share the loop's edges, whose keys tell fans apart
    members = np.where(loops[rows] >= 0, origin[rows, None] + edge_keys[loops[rows]], -1)
    middles, fan = np.unique(members, axis=0, return_inverse=True)
    at = named[rows] == MIDDLE
    kept = corners[rows]
    kept[at] = -1 - fan.reshape(-1)
    corners[rows] = kept
    return corners, middles


def _all_cells(cells: list[_Cells]) -> tuple[Indices, Indices]:
    """The triangles and the middles of all slabs, middles counted on from slab to slab."""
    before = np.cumsum([0, *(len(cell.middles) for cell in cells)])
    corners = [np.where(cell.corners < 0, cell.corners - n, cell.corners) for cell, n in zip(cells, before, strict=False)]
    return np.concatenate(corners), np.concatenate([cell.middles for cell in cells])


def _edge_vertices(grid: _Grid, keys: Indices) -> tuple[Floats, Floats]:
    """Where the surface crosses edges of the grid, and the gradient there."""
    point, axis = keys // 3, keys % 3
    index = np.stack(np.unravel_index(point, grid.shape), axis=1).astype(np.int64)
    other = index.copy()
    other[np.arange(len(keys)), axis] += 1
    low, high = (np.stack([grid.axes[k][at[:, k]] for k in range(3)], axis=1) for at in (index, other))
    if grid.table is not None:
        at_low, at_high = grid.samples(index), grid.samples(other)
        share = np.clip(at_low / (at_low - at_high), _MARGIN, 1.0 - _MARGIN)[:, None]
        return low + share * (high - low), (1.0 - share) * grid.gradients(index) + share * grid.gradients(other)
    if not len(keys):
        return low, low
    points = crossings(grid.values, low, high, grid.values(low) < 0.0)
    points = np.clip(points, low + _MARGIN * (high - low), high - _MARGIN * (high - low))
    pad = int(grid.capped)
    step = _STEP * np.array([a[pad + 1] - a[pad] for a in grid.axes])
    return points, _gradients(grid.values, points, step, np.array([[a[0], a[-1]] for a in grid.axes]).T)


def _gradients(field: Callable[[Floats], Floats], points: Floats, step: Floats, box: Floats) -> Floats:
    """Central differences; one-sided on the faces of the box, beyond which the function is not asked."""
    gradients = np.empty_like(points)
    for k in range(3):
        before, after = points.copy(), points.copy()
        before[:, k] = np.maximum(points[:, k] - step[k], box[0, k])
        after[:, k] = np.minimum(points[:, k] + step[k], box[1, k])
        gradients[:, k] = (field(after) - field(before)) / (after[:, k] - before[:, k])
    return gradients


def _mesh(points: Floats, triangles: Indices, gradients: Floats, caps: Indices) -> Mesh:
    positions, corners = points.astype(np.float32), triangles.astype(np.int32)
    lengths = np.linalg.norm(gradients, axis=1, keepdims=True)
    known = lengths > 0.0
    normals = gradients / np.where(known, lengths, 1.0)
    if not known.all():
        normals = np.where(known, normals, vertex_normals(positions, corners))
    on_cap = caps >= 0
    if not on_cap.any():
        return Mesh(positions, corners, normals=normals.astype(np.float32), name="surface")
    faces = np.stack([-np.eye(3), np.eye(3)], axis=1).reshape(6, 3)
    normal_corners = np.where(on_cap[:, None], len(normals) + caps[:, None], corners).astype(np.int32)
    return Mesh(positions, corners, np.concatenate([normals, faces]).astype(np.float32), normal_corners, name="surface")
