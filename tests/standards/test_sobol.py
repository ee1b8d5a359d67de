"""Sobol's sequence as published.

Sources: S. Joe and F. Kuo, "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci. Comput. 30,
2008, direction numbers new-joe-kuo-6.21201 (dimension 1: the identity; dimension 2: s = 1, a = 0, m1 = 1), and the first ten
points that their program prints.
"""

from __future__ import annotations

import numpy as np
import pytest
from compiled import over

from limner.kernel.sampler import reverse_bits, sobol_2d

# Joe and Kuo's program walks the sequence in Gray-code order: its n-th point is the one of index n ^ (n >> 1).
_PUBLISHED = np.array(
    [
        [0, 0], [0.5, 0.5], [0.75, 0.25], [0.25, 0.75], [0.375, 0.375],
        [0.875, 0.875], [0.625, 0.125], [0.125, 0.625], [0.1875, 0.3125], [0.6875, 0.8125],
    ]
)  # fmt: skip


def _points(indices: np.ndarray) -> np.ndarray:
    return np.stack(over(sobol_2d, indices), axis=1) / 2.0**32


def test_first_points_are_the_published_ones() -> None:
    """Ten points, exactly."""
    n = np.arange(10)
    np.testing.assert_array_equal(_points(n ^ (n >> 1)), _PUBLISHED)


def test_every_direction_number_follows_the_recurrence() -> None:
    """Index 2^k gives the k-th direction number: 2^-(k+1), and v_k = v_(k-1) xor v_(k-1) / 2."""
    first, second = over(sobol_2d, 2 ** np.arange(32))
    v = [1 << 31]
    for _ in range(31):
        v.append(v[-1] ^ (v[-1] >> 1))
    np.testing.assert_array_equal(first, 2 ** np.arange(31, -1, -1))
    np.testing.assert_array_equal(second, v)


def test_the_sequence_is_linear_over_xor() -> None:
    """The point of a xor b is the xor of their points: with the direction numbers, this fixes all 2^32 points."""
    a, b = np.random.default_rng(0).integers(0, 2**32, (2, 500))
    for combined, one, other in zip(over(sobol_2d, a ^ b), over(sobol_2d, a), over(sobol_2d, b), strict=True):
        np.testing.assert_array_equal(combined, one ^ other)


def test_scipy_agrees() -> None:
    """An independent implementation: 1024 points in its Gray-code order."""
    qmc = pytest.importorskip("scipy.stats.qmc")
    n = np.arange(1024)
    np.testing.assert_array_equal(_points(n ^ (n >> 1)), qmc.Sobol(2, scramble=False, bits=32).random(1024))


def test_reverse_bits_reads_backwards() -> None:
    """Against the binary digits as text, and twice is once."""
    words = np.r_[0, 1, 2**31, 2**32 - 1, np.random.default_rng(1).integers(0, 2**32, 100)]
    backwards = [int(f"{word:032b}"[::-1], 2) for word in words]
    np.testing.assert_array_equal(over(reverse_bits, words), backwards)
    np.testing.assert_array_equal(over(reverse_bits, backwards), words)
