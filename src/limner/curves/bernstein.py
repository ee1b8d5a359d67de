"""The Bernstein basis: how much each control point pulls on a Bézier curve (FoCG 15.6.1).

The basis functions of degree n are the terms of ``(u + (1 - u))^n = 1``: none is negative on [0, 1] and they sum to one, so a
curve is a weighted mean of its control points and stays in their convex hull. They mirror, ``b_k(u) = b_{n-k}(1 - u)``, and at
the ends they are exactly 0 or 1: two pieces that meet in a control point meet there to the bit.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError

__all__ = ["basis", "basis_derivatives"]


def basis(degree: int, u: ArrayLike) -> NDArray[np.float64]:
    """Evaluate the Bernstein polynomials ``b_{k,n}(u) = C(n,k) u^k (1-u)^(n-k)``, k = 0..n.

    Parameters
    ----------
    degree : int >= 0
        n.
    u : (...) float
        Any real number; the convex hull property holds in [0, 1].

    Returns
    -------
    (..., n + 1) float64

    Examples
    --------
    >>> basis(3, 0.5).tolist()
    [0.125, 0.375, 0.375, 0.125]

    **Source**: Marschner and Shirley, *Fundamentals of Computer Graphics*, 4th ed., 2015, 15.6.1.
    """
    if degree < 0:
        raise SceneError(f"the degree of a Bernstein basis must not be negative, got {degree}")
    t = np.asarray(u, dtype=np.float64)[..., None]
    k = np.arange(degree + 1)
    binomials = np.array([math.comb(degree, int(j)) for j in k], dtype=np.float64)
    return binomials * t**k * (1.0 - t) ** (degree - k)


def basis_derivatives(degree: int, u: ArrayLike) -> NDArray[np.float64]:
    """Evaluate the derivatives ``b'_{k,n}(u) = n (b_{k-1,n-1}(u) - b_{k,n-1}(u))``.

    Parameters
    ----------
    degree : int >= 0
    u : (...) float

    Returns
    -------
    (..., n + 1) float64
        They sum to zero, as the basis sums to one.

    **Source**: Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, 5.3.
    """
    if degree == 0:
        return np.zeros((*np.shape(u), 1))
    lower = basis(degree - 1, u)
    zero = np.zeros((*lower.shape[:-1], 1))
    made: NDArray[np.float64] = degree * (np.concatenate([zero, lower], axis=-1) - np.concatenate([lower, zero], axis=-1))
    return made
