"""The ways to draw samples, as numbers that kernels know and names that people give: no compiler is needed to say them."""

from __future__ import annotations

import math

__all__ = ["HALTON", "JITTERED", "MIDPOINT", "MULTI_JITTERED", "RANDOM", "REGULAR", "SAMPLERS", "SOBOL", "columns_of"]

MIDPOINT, RANDOM, SOBOL, REGULAR, JITTERED, MULTI_JITTERED, HALTON = 0, 1, 2, 3, 4, 5, 6

SAMPLERS = {
    "regular": REGULAR, "random": RANDOM, "jittered": JITTERED, "multijittered": MULTI_JITTERED, "halton": HALTON, "sobol": SOBOL,
}  # fmt: skip
"""What can be asked for, by name; see `limner.kernel.sampler`."""


def columns_of(n: int) -> int:
    """Into how many columns the squarest grid of n cells divides a pixel: the greatest divisor of n up to its root.

    >>> [columns_of(n) for n in (1, 7, 12, 16, 64)]
    [1, 1, 3, 4, 8]
    """
    return next(columns for columns in range(math.isqrt(n), 0, -1) if n % columns == 0)
