"""Small, nearly flat clusters of triangles: the pieces that charts are put together from.

Variational shape approximation: each cluster has a proxy, its mean normal and centre; triangles are given to the proxy they fit best by
growing from seeds, then the proxies are fitted anew, and so on. A cluster whose triangles do not fit gets a second seed where it is
worst, so that flat parts stay whole, a curved part is divided as finely as it is curved, and borders fall on creases by themselves.

**Source**: Cohen-Steiner, Alliez and Desbrun, *Variational shape approximation*, 2004 (the metric L2,1, and growing from seeds).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..._door import Array, Door, Scalar
from .surface import Surface

__all__ = ["clusters"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_f, _i = np.float64, np.int64
_grow = Door(
    "limner.mesh.unwrap.clusters_kernel",
    "grow",
    (Array(_f, 2), Array(_f, 2), Array(_i, 1), Array(_i, 1), Array(_f, 2), Scalar(_i), Scalar(_f), Array(_i, 1), Array(_f, 1),
     Array(_f, 1), Array(_i, 1), Array(_i, 1), Array(_i, 1)),
    "the cutting of surfaces",
)  # fmt: skip
_straighten = Door(
    "limner.mesh.unwrap.clusters_kernel",
    "straighten",
    (Array(_i, 1), Array(_f, 1), Array(_i, 1), Scalar(_i)),
    "the straightening of cuts",
)

_ROUNDS = 12
_SETTLING = 3
_SOFT_BEND = 0.4  # radians: a border along a bend of this much costs half as much as one over what is flat
_STRAIGHTENING_PASSES = 20


def clusters(surface: Surface, spread: float, closeness: float) -> Indices:
    """Divide a surface.

    Parameters
    ----------
    surface : Surface
    spread : float
        Radians that a normal may differ from its cluster's mean, about.
    closeness : float
        How much being far from the centre counts against a triangle, per unit of area.

    Returns
    -------
    (m,) int64
        The cluster of each triangle; from 0, all used, each connected along mates except for what straightening cut off.
    """
    m = surface.n_triangles
    if m == 0:
        return np.zeros(0, dtype=np.int64)
    labels, misfits, count = np.empty(m, _i), np.empty(m), np.zeros(1, _i)
    seeds, proxies = np.zeros(m, _i), np.zeros((m, 6))
    heap = (np.empty(3 * m + m), np.empty(4 * m, _i), np.empty(4 * m, _i))

    def flood(n_seeds: int) -> int:
        _grow(
            surface.normals, surface.centroids, surface.mates, seeds, proxies, n_seeds, closeness, labels, misfits, *heap, count
        )
        return int(count[0])

    n_seeds = 0
    limit = (2.0 * np.sin(spread / 2.0)) ** 2
    settling = _SETTLING
    for _ in range(_ROUNDS + _SETTLING):
        n_clusters = flood(n_seeds)
        own, worst = _refit(surface, labels, misfits, n_clusters, seeds, proxies)
        poor = np.flatnonzero(own > limit) if settling == _SETTLING else np.zeros(0, _i)
        poor = poor[worst[poor] != seeds[poor]]
        n_seeds = n_clusters + len(poor)
        seeds[n_clusters:n_seeds] = worst[poor]
        proxies[n_clusters:n_seeds, :3] = surface.normals[worst[poor]]
        proxies[n_clusters:n_seeds, 3:] = surface.centroids[worst[poor]]
        if not len(poor):
            settling -= 1
            if settling == 0:
                break
    flood(n_seeds)
    costs = surface.lengths / (1.0 + surface.bends / _SOFT_BEND)
    _straighten(surface.mates, costs, labels, _STRAIGHTENING_PASSES)
    return np.unique(labels, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _refit(
    surface: Surface, labels: Indices, misfits: Floats, n_clusters: int, seeds: Indices, proxies: Floats
) -> tuple[Floats, Indices]:
    """Fit proxies and seeds to the clusters; return the misfit of each one's worst triangle, by normals alone, and that triangle."""
    weights = surface.areas + 1e-15
    for k in range(3):
        proxies[:n_clusters, k] = np.bincount(labels, surface.normals[:, k] * weights, n_clusters)
        proxies[:n_clusters, 3 + k] = np.bincount(labels, surface.centroids[:, k] * weights, n_clusters)
    proxies[:n_clusters, :3] /= np.maximum(np.linalg.norm(proxies[:n_clusters, :3], axis=1), 1e-300)[:, None]
    proxies[:n_clusters, 3:] /= np.maximum(np.bincount(labels, weights, n_clusters), 1e-300)[:, None]
    off_normal = ((surface.normals - proxies[labels, :3]) ** 2).sum(axis=1) * (surface.areas > 0.0)
    off_centre = ((surface.centroids - proxies[labels, 3:]) ** 2).sum(axis=1)
    # Of each cluster the triangle nearest to its proxy is the next seed.
    order = np.lexsort((off_normal + off_centre / np.maximum(np.bincount(labels, surface.areas, n_clusters)[labels], 1e-300), labels))
    first = np.append(True, labels[order][1:] != labels[order][:-1])
    seeds[:n_clusters] = order[first]
    order = np.lexsort((-off_normal, labels))
    worst = order[first]
    return off_normal[worst], worst
