"""Growing clusters of triangles from seeds over a surface, those that fit best first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..._jit import kernel

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@kernel
def _push(keys: Floats, items: Indices, owners: Indices, size: int, key: float, item: int, owner: int) -> int:
    """Put an entry on the heap; return its new size."""
    place = size
    while place > 0:
        above = (place - 1) // 2
        if keys[above] <= key:
            break
        keys[place], items[place], owners[place] = keys[above], items[above], owners[above]
        place = above
    keys[place], items[place], owners[place] = key, item, owner
    return size + 1


@kernel
def _drop_first(keys: Floats, items: Indices, owners: Indices, size: int) -> int:
    """Take the least entry off the heap; return its new size."""
    size -= 1
    key, item, owner = keys[size], items[size], owners[size]
    place = 0
    below = 1
    while below < size:
        if below + 1 < size and keys[below + 1] < keys[below]:
            below += 1
        if keys[below] >= key:
            break
        keys[place], items[place], owners[place] = keys[below], items[below], owners[below]
        place = below
        below = 2 * place + 1
    keys[place], items[place], owners[place] = key, item, owner
    return size


@kernel
def _misfit(t: int, owner: int, normals: Floats, centroids: Floats, proxies: Floats, closeness: float) -> float:
    """How badly a triangle fits a cluster: squared distance of the normals, and a little of the centres."""
    dx, dy, dz = normals[t, 0] - proxies[owner, 0], normals[t, 1] - proxies[owner, 1], normals[t, 2] - proxies[owner, 2]
    cx, cy, cz = centroids[t, 0] - proxies[owner, 3], centroids[t, 1] - proxies[owner, 4], centroids[t, 2] - proxies[owner, 5]
    return dx * dx + dy * dy + dz * dz + closeness * (cx * cx + cy * cy + cz * cz)


@kernel
def grow(normals, centroids, mates, seeds, proxies, n_seeds, closeness, labels, misfits, keys, items, owners, count):
    """Label every triangle; where no seed reaches a new one is set. `count[0]` becomes the number of clusters."""
    n_triangles = len(labels)
    for t in range(n_triangles):
        labels[t] = -1
    size = 0
    for s in range(n_seeds):
        size = _push(keys, items, owners, size, -1.0, seeds[s], s)
    n_clusters = n_seeds
    unreached = 0
    while True:
        while size > 0:
            t, owner, misfit = items[0], owners[0], keys[0]
            size = _drop_first(keys, items, owners, size)
            if labels[t] >= 0:
                continue
            labels[t] = owner
            misfits[t] = max(misfit, 0.0)
            for c in range(3):
                mate = mates[3 * t + c]
                if mate >= 0 and labels[mate // 3] < 0:
                    other = mate // 3
                    size = _push(keys, items, owners, size, _misfit(other, owner, normals, centroids, proxies, closeness), other, owner)
        while unreached < n_triangles and labels[unreached] >= 0:
            unreached += 1
        if unreached == n_triangles:
            break
        seeds[n_clusters] = unreached
        for k in range(3):
            proxies[n_clusters, k] = normals[unreached, k]
            proxies[n_clusters, 3 + k] = centroids[unreached, k]
        size = _push(keys, items, owners, size, -1.0, unreached, n_clusters)
        n_clusters += 1
    count[0] = n_clusters


@kernel
def straighten(mates, costs, labels, n_passes):
    """Give a triangle to the neighbouring cluster that has more of its rim, by `costs` of the half-edges, until none changes."""
    for _ in range(n_passes):
        changed = 0
        for t in range(len(labels)):
            own = labels[t]
            kept, best, gained = 0.0, own, 0.0
            for c in range(3):
                mate = mates[3 * t + c]
                if mate >= 0 and labels[mate // 3] == own:
                    kept += costs[3 * t + c]
            for c in range(3):
                mate = mates[3 * t + c]
                if mate < 0 or labels[mate // 3] == own:
                    continue
                other = labels[mate // 3]
                share = 0.0
                for d in range(3):
                    beside = mates[3 * t + d]
                    if beside >= 0 and labels[beside // 3] == other:
                        share += costs[3 * t + d]
                if share > gained:
                    best, gained = other, share
            if gained > kept * (1.0 + 1e-9) and best != own:
                labels[t] = best
                changed += 1
        if changed == 0:
            break
