"""Tessellation without cracks: patches cut as finely as each bends, and neighbours that agree on their common border.

    o---o---o---o      the border is cut by its own bend alone, in the same points for whoever shares it;
    |\\ / \\ / \\ /|      inside stands a grid that the patch's bend asks for,
    | o---o---o |      and a strip of triangles joins the two
    |/|   |   |\\|

Both patches compute the points of a border from its control points, taken in one direction; so they are the same to the bit, and become
one vertex. Where a border has shrunk to a point, so does its row of vertices.

**Source**: Moreton, "Watertight tessellation using forward differencing", *Graphics Hardware* 2001; the bounds are those of Filip,
Magedson and Markot, "Surface algorithms using bounds on derivatives", *CAGD* 3(4), 1986.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from . import bezier, surface, triangle_patch
from .patch import Tessellation, normals
from .surface import net_of, unit_normals

__all__ = ["grid_triangles", "patch_counts", "tessellated", "tessellated_triangle"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_MOST_CUTS = 1024
_MOST_TRIANGLES = 1 << 24


def patch_counts(net: ArrayLike, tolerance: float) -> tuple[int, int]:
    """Count the steps in u and in v with which a grid of triangles strays from a Bézier patch by no more than a tolerance.

    Parameters
    ----------
    net : (m + 1, n + 1, 3) float
    tolerance : float > 0

    Returns
    -------
    (int, int)
        Each at least 1, at most 1024.

    **Source**: Filip, Magedson and Markot 1986: the error of a triangle with legs l1, l2 is at most
    ``(l1^2 M_uu + 2 l1 l2 M_uv + l2^2 M_vv) / 8``, M bounding the second derivatives.
    """
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise SceneError(f"the tolerance of a tessellation must be positive, got {tolerance}")
    points = net_of(net)
    m, n = points.shape[0] - 1, points.shape[1] - 1
    bend_u = n * (n - 1) * _greatest(np.diff(points, n=2, axis=1))
    bend_v = m * (m - 1) * _greatest(np.diff(points, n=2, axis=0))
    twist = n * m * _greatest(np.diff(np.diff(points, axis=0), axis=1))
    # Half of the tolerance for what each direction bends, its share of the twist added
    across = math.sqrt((bend_u + twist) / (4.0 * tolerance))
    along = math.sqrt((bend_v + twist) / (4.0 * tolerance))
    return min(_MOST_CUTS, max(1, math.ceil(across))), min(_MOST_CUTS, max(1, math.ceil(along)))


def _greatest(vectors: Floats) -> float:
    return float(np.linalg.norm(vectors, axis=-1).max(initial=0.0))


def _edge_cuts(control: Floats, tolerance: float) -> int:
    degree = len(control) - 1
    bend = degree * (degree - 1) / 8.0 * _greatest(np.diff(control, n=2, axis=0))
    return min(_MOST_CUTS, max(1, math.ceil(math.sqrt(bend / tolerance))))


def tessellated(nets: list[Floats] | Floats, tolerance: float) -> Tessellation:
    """Cut Bézier patches into triangles that stray from them by no more than a tolerance.

    Parameters
    ----------
    nets : (k, m + 1, n + 1, 3) float, or a list of nets (m + 1, n + 1, 3)
        Rows along v, columns along u. Borders that are to have no cracks have the same control points, in either order.
    tolerance : float > 0
        In the units of the points.

    Returns
    -------
    Tessellation
        All patches as one mesh, its positions each once: where patches share a border they share vertices. A normal is that of the
        first patch that has the vertex; uvs are the parameters within that patch. Triangles of no area are left out.

    Examples
    --------
    >>> grid = np.stack(np.meshgrid(range(4), range(4), [0.0]), axis=-1).reshape(4, 4, 3)
    >>> flat = tessellated([grid, grid + (3.0, 0.0, 0.0)], 0.01)
    >>> len(flat.positions), len(flat.triangles)
    (8, 8)
    """
    made = _Welded()
    for k, net in enumerate(nets):
        points = net_of(net, f"nets[{k}]")
        if points.shape[2] != 3:
            raise SceneError(f"nets[{k}] must have 3 coordinates each, got {points.shape[2]}")
        _add_patch(made, points, tolerance)
    return made.tessellation()


def _add_patch(made: _Welded, net: Floats, tolerance: float) -> None:
    n_u, n_v = patch_counts(net, tolerance)
    # Two steps at least: the inner grid is not empty
    columns, rows = max(2, n_u), max(2, n_v)
    borders = [net[0], net[:, -1], net[-1][::-1], net[:, 0][::-1]]
    cuts = [_edge_cuts(border, tolerance) for border in borders]
    inner_u, inner_v = np.arange(1, columns) / columns, np.arange(1, rows) / rows
    u, v = np.meshgrid(inner_u, inner_v)
    inner = made.vertices(surface.evaluate(net, u, v).reshape(-1, 3), _normals(net, u, v).reshape(-1, 3), u, v, shared=False)
    inner = inner.reshape(rows - 1, columns - 1)
    made.triangles.append(grid_triangles(inner))
    ring = [inner[0], inner[:, -1], inner[-1][::-1], inner[:, 0][::-1]]
    for side, (border, count) in enumerate(zip(borders, cuts, strict=True)):
        t = np.arange(count + 1) / count
        places = _border_points(border, count)
        su, sv = _on_side(side, t)
        outer = made.vertices(places, _normals(net, su, sv), su, sv, shared=True)
        steps = (inner_u, inner_v, inner_u, inner_v)[side]
        made.triangles.append(_strip(outer, t, ring[side], steps))


def _normals(net: Floats, u: Floats, v: Floats) -> Floats:
    """With their limits where a border has shrunk to a point; these are known of bicubic nets."""
    return normals(surface.bicubic(net), u, v) if max(net.shape[:2]) <= 4 else unit_normals(net, u, v)


def _on_side(side: int, t: Floats) -> tuple[Floats, Floats]:
    """Parameters along a border, counter-clockwise round the patch."""
    zero, one = np.zeros_like(t), np.ones_like(t)
    return ((t, zero), (one, t), (1.0 - t, one), (zero, 1.0 - t))[side]


def _border_points(control: Floats, count: int) -> Floats:
    """Points of a border in equal steps, computed in one direction, whichever it is given in."""
    turned = control[0].tolist() > control[-1].tolist() or (
        control[0].tolist() == control[-1].tolist() and control.tolist() > control[::-1].tolist()
    )
    points = bezier.evaluate(control[::-1] if turned else control, np.arange(count + 1) / count)
    return points[::-1] if turned else points


def grid_triangles(index: Indices) -> Indices:
    """(2 (rows - 1) (columns - 1), 3) int64: a grid of numbered vertices, the next row to the left of the way along one."""
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def _strip(outer: Indices, outer_t: Floats, inner: Indices, inner_t: Floats) -> Indices:
    """Join two rows of vertices, the inner one to the left of the way along the outer one: always on where less has been gone."""
    triangles, i, j = [], 0, 0
    while i < len(outer) - 1 or j < len(inner) - 1:
        on_outer = j == len(inner) - 1 or (i < len(outer) - 1 and outer_t[i] + outer_t[i + 1] <= inner_t[j] + inner_t[j + 1])
        if on_outer:
            triangles.append((outer[i], outer[i + 1], inner[j]))
            i += 1
        else:
            triangles.append((outer[i], inner[j + 1], inner[j]))
            j += 1
    return np.array(triangles, dtype=np.int64).reshape(-1, 3)


class _Welded:
    """Vertices and triangles of a mesh under construction; border vertices at one place are one."""

    def __init__(self) -> None:
        self.places: list[Floats] = []
        self.normals: list[Floats] = []
        self.uvs: list[Floats] = []
        self.triangles: list[Indices] = []
        self._count = 0
        self._at: dict[bytes, int] = {}

    def vertices(self, places: Floats, normals: Floats, u: Floats, v: Floats, *, shared: bool) -> Indices:
        """Numbers of vertices at places (k, 3), which are added where they are not there yet."""
        # + 0.0, for -0.0 is another pattern of bits
        places, uvs = places + 0.0, np.stack([u.reshape(-1), v.reshape(-1)], axis=1)
        new = np.ones(len(places), dtype=bool)
        index = np.empty(len(places), dtype=np.int64)
        for k, place in enumerate(places):
            known = self._at.setdefault(place.tobytes(), self._count) if shared else self._count
            index[k], new[k] = known, known == self._count
            self._count += int(new[k])
        self.places.append(places[new])
        self.normals.append(normals[new])
        self.uvs.append(uvs[new])
        return index

    def tessellation(self) -> Tessellation:
        triangles = np.concatenate([np.zeros((0, 3), dtype=np.int64), *self.triangles])
        if len(triangles) > _MOST_TRIANGLES:
            raise SceneError(f"there would be {len(triangles):,} triangles; the most is {_MOST_TRIANGLES:,}; ask for a greater tolerance")
        a, b, c = triangles.T
        triangles = triangles[(a != b) & (b != c) & (c != a)]
        empty = [np.zeros((0, 3))]
        return Tessellation(
            np.concatenate(self.places or empty), np.concatenate(self.normals or empty), np.concatenate(self.uvs or [np.zeros((0, 2))]),
            triangles.astype(np.int32),
        )  # fmt: skip


def tessellated_triangle(net: ArrayLike, n: int) -> Tessellation:
    """Cut a Bézier triangle into n^2 triangles, in equal steps.

    Parameters
    ----------
    net : ((n + 1) (n + 2) / 2, 3) float
        As in `limner.curves.triangle_patch`.
    n : int >= 1

    Returns
    -------
    Tessellation
        uvs are the second and third barycentric.
    """
    if n < 1:
        raise SceneError(f"a triangle must be cut into at least 1 piece a side, got {n}")
    b = triangle_patch.indices(n) / n
    row = np.repeat(np.arange(n), np.arange(1, n + 1))
    first = np.arange(len(row))
    upright = np.stack([first, first + row + 1, first + row + 2], axis=1)
    # All but the last of each row have one that points down between themselves and the next
    between = first[first < (row * (row + 3)) // 2]
    turned = np.stack([between, between + row[between] + 2, between + 1], axis=1)
    return Tessellation(
        triangle_patch.evaluate(net, b), triangle_patch.normals(net, b), b[:, 1:], np.concatenate([upright, turned]).astype(np.int32)
    )
