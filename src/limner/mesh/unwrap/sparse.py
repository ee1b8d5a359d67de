"""Sparse systems, solved by SciPy, which is imported only when a surface is flattened."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .surface import Surface, scipy_sparse

__all__ = ["Factor", "assembled", "dirichlet", "factorized"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class Factor(NamedTuple):
    """A matrix taken apart, to solve with again and again."""

    lu: Any

    def solve(self, right: NDArray[Any]) -> NDArray[Any]:
        """The solution for a right-hand side, (n,) or (n, k)."""
        return np.ascontiguousarray(self.lu.solve(right))


def assembled(n: int, rows: Indices, columns: Indices, values: NDArray[Any]) -> Any:
    """An (n, n) sparse matrix; values at the same place are added."""
    return scipy_sparse().coo_array((values, (rows, columns)), shape=(n, n)).tocsc()


def factorized(matrix: Any, symmetric: bool = True) -> Factor:
    """Take a regular sparse matrix apart; a symmetric (or Hermitian) positive definite one needs no pivots and half the fill."""
    from scipy.sparse.linalg import splu

    if symmetric:
        return Factor(splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}))
    return Factor(splu(matrix))


def dirichlet(surface: Surface, corners: Indices, n: int, triangles: Indices | slice = slice(None)) -> Any:
    """The matrix L of the Dirichlet energy ``1/2 u^T L u`` of functions that are linear on triangles: the cotangent formula.

    Parameters
    ----------
    surface : Surface
    corners : (k, 3) int64
        Row of each corner of the given triangles.
    n : int
        Rows.
    triangles : (k,) int64, or all

    **Source**: Pinkall and Polthier, *Computing discrete minimal surfaces and their conjugates*, 1993.
    """
    # The edge that lies opposite to a corner has half its cotangent.
    weights = 0.5 * surface.cotangents[triangles]
    a, b = np.roll(corners, -1, axis=1).reshape(-1), np.roll(corners, -2, axis=1).reshape(-1)
    w = weights.reshape(-1)
    return assembled(n, np.concatenate([a, b, a, b]), np.concatenate([b, a, a, b]), np.concatenate([-w, -w, w, w]))
