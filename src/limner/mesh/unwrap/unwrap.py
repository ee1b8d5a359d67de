"""Texture coordinates for any surface: cut into charts, each laid flat with little distortion, all packed into the unit square (FoCG 11.1).

    mesh = uv_unwrap(mesh)
    print(unwrap_report(mesh))

        surface ──► clusters ──► gluing, merging ──► conformal | tutte ──► isometric ──► overlap ──► packing
                    nearly flat   charts: discs       a first map           a good one    one to one   uvs

Every step keeps a promise, whatever the input: charts are discs, no triangle is turned over, no chart lies over itself or over another.
Not every surface can be cut and laid flat without distortion (a sphere cannot at all): the fewer the cuts, the more of it, and `distortion`
says how much a chart may have.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError, UnsupportedError
from ..mesh import Mesh
from .clusters import clusters
from .flatten import METHODS, flattened_whole
from .gluing import Gluing
from .merging import Limits, merged
from .packing import pack
from .surface import Surface

__all__ = ["METHODS", "charts_of", "uv_unwrap"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_SPREAD = 0.9  # radians: how much a cluster may bend
_CLOSENESS = 0.05
_USUAL_DISTORTION = 0.085
_RAGGEDNESS = 2.7
_FULLNESS = 0.42
_HEIGHT = 1.25
_WORST_ENERGY = 1.2
_SOFT_BEND = 0.4  # radians: a cut along a bend of this much costs half as much as one over what is flat


def uv_unwrap(
    mesh: Mesh, *, method: str = "balanced", distortion: float = _USUAL_DISTORTION, resolution: int = 1024, margin: int = 2
) -> Mesh:
    """Give a mesh texture coordinates of which no two places share one.

    Parameters
    ----------
    mesh : Mesh
        Anything: open, closed, with handles, in many parts, not manifold, not orientable. Surface that is there twice is laid out twice.
    method : "balanced" | "isometric" | "conformal" | "tutte"
        What charts keep: angles, and areas as far as that costs no angles; both alike; angles alone; only who is next to whom, on disks.
    distortion : float > 0
        How much charts may be distorted: less makes more charts. It is the root mean square of the logarithm of the scale of areas that a
        conformal map would have, and guides where cuts are made; what came of it tells `unwrap_report`.
    resolution : int from 16 to 16384
        Texels along a side of the texture that it is for.
    margin : int >= 0
        Texels between any two charts, so that filters and mipmaps do not mix them.

    Returns
    -------
    Mesh
        The same with `uvs` in [0, 1] and `uv_triangles`; positions are not split. Charts have the same scale and are not mirrored.
        Tangents and the second set of coordinates, which belonged to the old first, are left out. A triangle that names a position
        twice has the coordinates of its neighbours, and no area.

    Raises SceneError where the charts do not fit, UnsupportedError where SciPy is missing.

    Examples
    --------
    >>> from limner.mesh.shapes.primitives import box
    >>> flat = uv_unwrap(box(), resolution=64)
    >>> flat.uv_triangles.shape, len(flat.positions)
    ((12, 3), 8)

    **Source**: Lévy, Petitjean, Ray and Maillot, *Least squares conformal maps for automatic texture atlas generation*, 2002, in
    outline; each step names its own.
    """
    _check(method, distortion, resolution, margin)
    surface = Surface(mesh)
    if not surface.n_triangles:
        return _with_uvs(mesh, surface, np.zeros((0, 3), dtype=np.int64), np.zeros((0, 2)))
    _, pieces, flat = flattened_whole(charts_of(surface, distortion), method, _WORST_ENERGY, 1.05 * _HEIGHT)
    packing = pack(pieces, flat, resolution, margin)
    return _with_uvs(mesh, surface, pieces.corners, packing.uvs)


def charts_of(surface: Surface, distortion: float = _USUAL_DISTORTION) -> Gluing:
    """Cut a surface into discs.

    Parameters
    ----------
    surface : Surface
    distortion : float > 0
        As for `uv_unwrap`.
    """
    spread = _SPREAD * min(1.0, math.sqrt(distortion / _USUAL_DISTORTION))
    gluing = Gluing(surface)
    # Where a cluster is no disc it is cut where it bends most.
    gluing.glue(np.argsort(surface.bends, kind="stable"), clusters(surface, max(spread, 0.05), _CLOSENESS))
    limits = Limits(distortion, _RAGGEDNESS, _FULLNESS, _HEIGHT)
    return merged(gluing, limits, surface.lengths / (1.0 + surface.bends / _SOFT_BEND))


def _check(method: str, distortion: float, resolution: int, margin: int) -> None:
    if method not in METHODS:
        raise UnsupportedError(f"method must be one of {', '.join(METHODS)}, got {method!r}")
    if not (math.isfinite(distortion) and distortion > 0.0):
        raise SceneError(f"distortion must be positive and finite, got {distortion}")
    if not (hasattr(resolution, "__index__") and 16 <= resolution <= 16384):
        raise SceneError(f"resolution must be an integer from 16 to 16384, got {resolution!r}")
    if not (hasattr(margin, "__index__") and margin >= 0):
        raise SceneError(f"margin must be an integer >= 0, got {margin!r}")


def _with_uvs(mesh: Mesh, surface: Surface, corners: Indices, uvs: Floats) -> Mesh:
    """The mesh with texture coordinates for the corners of the surface's triangles."""
    uv_triangles = np.zeros(mesh.triangles.shape, dtype=np.int64)
    uv_triangles[surface.kept] = corners
    left = np.ones(len(mesh.triangles), dtype=bool)
    left[surface.kept] = False
    if left.any():
        uv_of = np.full(len(mesh.positions), -1, dtype=np.int64)
        uv_of[surface.triangles.reshape(-1)] = corners.reshape(-1)
        positions = mesh.triangles[left]
        lone = np.unique(positions[uv_of[positions] < 0])
        uv_of[lone] = len(uvs) + np.arange(len(lone))
        uvs = np.concatenate([uvs, np.zeros((len(lone), 2))])
        uv_triangles[left] = uv_of[positions]
    return dataclasses.replace(
        mesh,
        uvs=np.clip(uvs, 0.0, 1.0).astype(np.float32),
        uv_triangles=uv_triangles.astype(np.int32),
        uvs1=None,
        tangents=None,
    )
