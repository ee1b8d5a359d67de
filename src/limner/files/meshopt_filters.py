"""What is done to attributes so that they compress better, undone: octahedral, quaternion, exponential, color.

Each takes elements as their bytes and returns as many: a filter changes what numbers mean, not how long they are.

**Source**: Khronos Group, *KHR_meshopt_compression*, appendix B.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

__all__ = ["FILTERS", "color", "exponential", "octahedral", "quaternion"]

Bytes = NDArray[np.uint8]
Floats = NDArray[np.float32]


def octahedral(rows: Bytes) -> Bytes:
    """Turn points of an octahedron laid flat into unit vectors: (n, 4 or 8) uint8, four integers each, the fourth left as it is.

    The third is 1 in as many bits as the first two have. ``z = 1 - |x| - |y|``; where that is below 0, x and y were folded over.
    """
    dtype, most = (np.dtype("i1"), 127) if rows.shape[1] == 4 else (np.dtype("<i2"), 32767)
    given = np.ascontiguousarray(rows).view(dtype)
    one = np.maximum(given[:, 2].astype(np.float32), np.float32(1.0))
    x, y = given[:, 0] / one, given[:, 1] / one
    z = np.float32(1.0) - np.abs(x) - np.abs(y)
    fold = np.minimum(z, np.float32(0.0))
    x, y = x - np.copysign(fold, x), y - np.copysign(fold, y)
    scale = np.float32(most) / np.maximum(np.sqrt(x * x + y * y + z * z), np.float32(1e-30))
    made = given.copy()
    scaled = np.stack([x, y, z], axis=1) * scale[:, None]
    made[:, :3] = _rounded(scaled.astype(np.float32, copy=False), -most, most)
    return made.view(np.uint8)


def quaternion(rows: Bytes) -> Bytes:
    """Find the greatest component of unit quaternions by the three others: (n, 8) uint8, four 16-bit integers each.

    The fourth is 1 in as many bits as the others have; its last two say which component is missing.
    """
    given = np.ascontiguousarray(rows).view("<i2")
    one = (given[:, 3] | 3).astype(np.float32)
    three = given[:, :3] / np.maximum(one, np.float32(1.0))[:, None] * np.float32(np.sqrt(0.5))
    greatest = np.sqrt(np.maximum(np.float32(1.0) - (three * three).sum(axis=1), np.float32(0.0)))
    scaled = _rounded(np.concatenate([greatest[:, None], three], axis=1) * np.float32(32767.0), -32767, 32767).astype("<i2")
    made = np.empty_like(scaled)
    where = ((given[:, 3:4] & 3) + np.arange(4)) % 4
    np.put_along_axis(made, where, scaled, axis=1)
    return made.view(np.uint8)


def exponential(rows: Bytes) -> Bytes:
    """Turn 24 bits of mantissa and 8 of exponent into floats, ``m 2^e``: (n, a multiple of 4) uint8."""
    given = np.ascontiguousarray(rows).view("<i4")
    exponent, mantissa = given >> 24, given << 8 >> 8
    # Within the range that the specification allows, nothing overflows.
    return np.ldexp(mantissa.astype(np.float32), np.clip(exponent, -100, 100)).astype("<f4").view(np.uint8)


def color(rows: Bytes) -> Bytes:
    """Turn YCoCg with alpha into RGBA: (n, 4 or 8) uint8, four integers each.

    How many bits they have, the highest bit of alpha says, of which one less is left.
    """
    unsigned, signed, most = (np.dtype("u1"), np.dtype("i1"), 255) if rows.shape[1] == 4 else (np.dtype("<u2"), np.dtype("<i2"), 65535)
    given = np.ascontiguousarray(rows)
    y, alpha = (given.view(unsigned)[:, k].astype(np.int64) for k in (0, 3))
    orange, green = (given.view(signed)[:, k].astype(np.int64) for k in (1, 2))
    full = alpha.copy()
    for shift in (1, 2, 4, 8):
        full |= full >> shift
    alpha &= full >> 1
    alpha = alpha << 1 | alpha & 1
    channels = np.stack([y + orange - green, y + green, y - orange - green, alpha], axis=1).astype(np.float32)
    scale = np.float32(most) / np.maximum(full, 1).astype(np.float32)
    return _rounded(channels * scale[:, None], 0, most).astype(unsigned).view(np.uint8)


def _rounded(values: Floats, least: int, most: int) -> Floats:
    """The nearest integers, halves away from zero."""
    return np.clip(np.trunc(values + np.copysign(np.float32(0.5), values)), np.float32(least), np.float32(most))


FILTERS: Mapping[str, Callable[[Bytes], Bytes]] = {
    "OCTAHEDRAL": octahedral, "QUATERNION": quaternion, "EXPONENTIAL": exponential, "COLOR": color,
}  # fmt: skip
