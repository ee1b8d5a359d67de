"""Programs of constructive solid geometry, on the host: are they sound, and how large is what they make?"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError
from .layouts import COMPLEMENT, DIFFERENCE, INTERSECTION, MAX_LEAVES, UNION

__all__ = ["check_program", "program_bounds"]

_NAMES = {UNION: "union", INTERSECTION: "intersection", DIFFERENCE: "difference", COMPLEMENT: "complement"}


def check_program(program: ArrayLike, n_leaves: int) -> NDArray[np.int32]:
    """Return a program as kernels read it, or complain.

    Parameters
    ----------
    program : (n,) int
        Postfix; see `limner.intersect.layouts`.
    n_leaves : int
        At most 62.

    Examples
    --------
    >>> check_program([0, 1, DIFFERENCE], 2)
    array([ 0,  1, -3], dtype=int32)
    """
    tokens = np.asarray(program)
    if tokens.ndim != 1 or tokens.size == 0 or tokens.dtype.kind not in "iu":
        raise SceneError(f"a solid's program must be a list of integers, got {program!r}")
    if n_leaves > MAX_LEAVES:
        raise SceneError(f"a solid is made of at most {MAX_LEAVES} primitives, got {n_leaves}")
    depth = 0
    for position, token in enumerate(tokens.tolist()):
        if token >= n_leaves or token < COMPLEMENT:
            raise SceneError(f"a solid's program names leaf or operation {token} at {position}; it has {n_leaves} leaves")
        needed = 0 if token >= 0 else 1 if token == COMPLEMENT else 2
        if depth < needed:
            raise SceneError(f"a solid's program has too little before its {_NAMES[token]} at {position}: {depth} of {needed}")
        depth += 1 - needed
        if depth > MAX_LEAVES:
            raise SceneError(f"a solid's program keeps more than {MAX_LEAVES} sets waiting at {position}")
    if depth != 1:
        raise SceneError(f"a solid's program must leave one set, it leaves {depth}")
    return tokens.astype(np.int32)


def program_bounds(program: ArrayLike, boxes: ArrayLike) -> NDArray[np.float64]:
    """Bound what a sound program makes of leaves whose boxes are known.

    Parameters
    ----------
    program : (n,) int
    boxes : (m, 6) float
        Low corner, high corner of each leaf; infinite for a half space.

    Returns
    -------
    (6,) float64
        Low corner, high corner; inf and -inf where nothing is left, infinite the other way round where there is no end.

    Examples
    --------
    >>> program_bounds([0, 1, INTERSECTION], [[0, 0, 0, 2, 2, 2], [1, -1, 0, 3, 1, 9]])
    array([1., 0., 0., 2., 1., 2.])
    """
    leaves = np.asarray(boxes, dtype=np.float64).reshape(-1, 6)
    empty, endless = np.repeat([np.inf, -np.inf], 3), np.repeat([-np.inf, np.inf], 3)
    stack: list[NDArray[np.float64]] = []
    for token in np.asarray(program).tolist():
        if token >= 0:
            stack.append(leaves[token])
            continue
        top = stack.pop()
        if token == COMPLEMENT:
            stack.append(endless)
        elif token == UNION:
            under = stack.pop()
            stack.append(np.concatenate([np.minimum(under[:3], top[:3]), np.maximum(under[3:], top[3:])]))
        elif token == INTERSECTION:
            under = stack.pop()
            both = np.concatenate([np.maximum(under[:3], top[:3]), np.minimum(under[3:], top[3:])])
            stack.append(both if np.all(both[:3] <= both[3:]) else empty)
    return stack.pop()
