"""What hangs together: connected components of any graph, without a loop over its nodes.

Every node begins as its own root. In each round a link between two roots hangs the one with the greater number under the other, and
every node climbs to its root by doubling its steps. Links inside one tree are dropped, so that the rounds shrink.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["component_labels"]

Labels = NDArray[np.int32]


def component_labels(n_nodes: int, first: NDArray[Any], second: NDArray[Any]) -> Labels:
    """Name each node's component by the least node in it.

    Parameters
    ----------
    n_nodes : int
    first, second : (k,) int
        The ends of the links.

    Returns
    -------
    (n_nodes,) int32

    Notes
    -----
    A root that can hang under several others hangs under any of them; as it always goes down in number there is no circle, and the least
    node of a component is the only one that never hangs.

    **Source**: after Y. Shiloach and U. Vishkin, "An O(log n) parallel connectivity algorithm", *Journal of Algorithms* 3(1), 1982; every
    round climbs all the way to the roots.

    >>> component_labels(5, np.array([3, 1]), np.array([4, 3])).tolist()
    [0, 1, 2, 1, 1]
    """
    root = np.arange(n_nodes, dtype=np.int32)
    a, b = np.asarray(first, dtype=np.int32), np.asarray(second, dtype=np.int32)
    while True:
        a, b = root[a], root[b]
        apart = a != b
        if not apart.any():
            return root
        a, b = a[apart], b[apart]
        root[np.maximum(a, b)] = np.minimum(a, b)
        while True:
            higher = root[root]
            if np.array_equal(higher, root):
                break
            root = higher
