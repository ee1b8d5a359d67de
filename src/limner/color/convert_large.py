"""Pictures of many float32 colours, from lamps to lamps, by a compiled kernel."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from .encodings import Encoding
from .triples import Floats

__all__ = ["converted"]

_a1 = Array(np.float32, 1)
_convert = Door(
    "limner.color.convert_kernel", "convert_rgb", (_a1, _a1, _a1, _a1, _a1, *(3 * (Scalar(np.int64),))), "the conversion of colours"
)


def converted(given: NDArray[Any], matrix: Floats, decode: Encoding, encode: Encoding, out: NDArray[Any] | None) -> NDArray[Any]:
    """Decode, mix by a matrix, encode: (..., 3) float32 to the same shape, into `out` where it is contiguous."""
    source = np.ascontiguousarray(given).reshape(-1)
    made = out if out is not None and out.flags.c_contiguous else np.empty(given.shape, dtype=np.float32)
    target = made.reshape(-1)
    gamma, inverse, share, slope, joint = decode.curve
    light = np.array([gamma, inverse, share / inverse, slope, joint], dtype=np.float32)
    gamma, inverse, share, slope, joint = encode.curve
    below = slope * joint
    stored = np.array([1.0 / gamma, 1.0 / inverse, share / inverse, 1.0 / slope if slope else 0.0, below], dtype=np.float32)
    flags = (decode.name != "linear", not np.array_equal(matrix, np.eye(3)), encode.name != "linear")
    _convert(source, target, light, matrix.astype(np.float32).reshape(-1), stored, *map(int, flags))
    return made
