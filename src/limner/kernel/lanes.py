"""Eight numbers at once: `f32x8` and `i32x8`, one SIMD register each, with operators.

Numba does not vectorise a loop that loads, compares and branches, such as a step of a BVH traversal. So kernels that want
vector instructions say so: eight boxes, triangles or pixels side by side, comparisons that give a mask, a bit for each lane.

    near = max8(max8(tx0, ty0), tz0)
    far = min8(min8(tx1, ty1), tz1)
    hits = mask_less_equal(near, far)
    while hits != 0:
        k = first_set(hits)
        hits &= hits - 1
        visit(child[k], lane(near, k))

The classes below run uncompiled; compiled, the same names are LLVM vectors (`_lane_types`), which become AVX registers, pairs
of SSE or NEON registers, or plain scalars, whatever the CPU has. Every lane is rounded like a scalar, so the bits are the same.

NaN: comparisons with it are false; `min8(a, b)` and `max8(a, b)` then give `b`, and also where both are zeros of either sign
(one x86 instruction). So write the operand that may be NaN first, and it loses.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .._jit import MODE

__all__ = [
    "ALL_LANES", "count_set", "f32x8", "first_set", "floor8", "i32x8", "lane", "load8", "mask_equal", "mask_greater",
    "mask_greater_equal", "mask_less", "mask_less_equal", "max8", "min8", "reduce_max8", "reduce_min8", "select8", "splat8",
    "splat8_int", "sqrt8", "store8", "to_float8", "to_int8",
]  # fmt: skip

ALL_LANES = np.int32(255)


class _Lanes:
    """Eight numbers of one kind, and the operators both kinds have."""

    __slots__ = ("values",)
    element: Any

    def __init__(self, values: Any) -> None:
        self.values = np.asarray(values, dtype=self.element).reshape(8)

    def _with(self, values: Any) -> Any:
        return type(self)(values)

    def __add__(self, o: Any) -> Any:
        return self._with(self.values + o.values)

    def __sub__(self, o: Any) -> Any:
        return self._with(self.values - o.values)

    def __mul__(self, o: Any) -> Any:
        return self._with(self.values * o.values)

    def __neg__(self) -> Any:
        return self._with(-self.values)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.values.tolist()})"


class f32x8(_Lanes):  # noqa: N801 - named like the number types it stands beside
    """Eight float32; both operands of + - * / are lanes: `splat8` makes them of a number."""

    __slots__ = ()
    element = np.float32

    def __truediv__(self, o: f32x8) -> f32x8:
        return f32x8(self.values / o.values)


class i32x8(_Lanes):  # noqa: N801
    """Eight int32, modulo 2^32, with + - * & | ^ and negation."""

    __slots__ = ()
    element = np.int32

    def __and__(self, o: i32x8) -> i32x8:
        return i32x8(self.values & o.values)

    def __or__(self, o: i32x8) -> i32x8:
        return i32x8(self.values | o.values)

    def __xor__(self, o: i32x8) -> i32x8:
        return i32x8(self.values ^ o.values)


if MODE == "compiled":
    from ._lane_types import (
        count_set,
        first_set,
        floor8,
        lane,
        load8,
        mask_equal,
        mask_greater,
        mask_greater_equal,
        mask_less,
        mask_less_equal,
        max8,
        min8,
        reduce_max8,
        reduce_min8,
        register,
        select8,
        splat8,
        splat8_int,
        sqrt8,
        store8,
        to_float8,
        to_int8,
    )

    register(f32x8, i32x8)
else:

    def load8(array: np.ndarray, offset: int) -> Any:
        """Eight neighbours of a contiguous 1D float32 or int32 array, from `offset` on; it need not be aligned."""
        return (f32x8 if array.dtype == np.float32 else i32x8)(array[offset : offset + 8].copy())

    def store8(array: np.ndarray, offset: int, v: Any) -> None:
        """Write eight lanes to a contiguous 1D array of their kind, from `offset` on."""
        array[offset : offset + 8] = v.values

    def splat8(x: np.float32) -> f32x8:
        """Eight times the float x."""
        return f32x8(np.full(8, x, dtype=np.float32))

    def splat8_int(x: np.int32) -> i32x8:
        """Eight times the integer x."""
        return i32x8(np.full(8, np.int64(x), dtype=np.int64).astype(np.int32))

    def lane(v: Any, i: int) -> Any:
        """One lane, 0 <= i < 8."""
        return v.values[i]

    def min8(a: Any, b: Any) -> Any:
        """a < b ? a : b, lane by lane."""
        return a._with(np.where(a.values < b.values, a.values, b.values))

    def max8(a: Any, b: Any) -> Any:
        """a > b ? a : b, lane by lane."""
        return a._with(np.where(a.values > b.values, a.values, b.values))

    def sqrt8(a: f32x8) -> f32x8:
        """The correctly rounded square roots; NaN below zero."""
        return f32x8(np.sqrt(a.values))

    def floor8(a: f32x8) -> f32x8:
        """The greatest integers not above, as float32."""
        return f32x8(np.floor(a.values))

    def to_float8(a: i32x8) -> f32x8:
        """The nearest float32 of each integer."""
        return f32x8(a.values.astype(np.float32))

    def to_int8(a: f32x8) -> i32x8:
        """The integers towards zero; -2^31 for NaN and for what an int32 cannot hold."""
        fits = (a.values >= np.float32(-(2.0**31))) & (a.values < np.float32(2.0**31))
        return i32x8(np.where(fits, np.where(fits, a.values, np.float32(0)).astype(np.int32), np.int32(-(2**31))))

    def _mask(truth: np.ndarray) -> np.int32:
        return np.int32(np.packbits(truth, bitorder="little")[0])

    def mask_less(a: Any, b: Any) -> np.int32:
        """The mask of a < b: bit k tells of lane k."""
        return _mask(a.values < b.values)

    def mask_less_equal(a: Any, b: Any) -> np.int32:
        """The mask of a <= b."""
        return _mask(a.values <= b.values)

    def mask_greater(a: Any, b: Any) -> np.int32:
        """The mask of a > b."""
        return _mask(a.values > b.values)

    def mask_greater_equal(a: Any, b: Any) -> np.int32:
        """The mask of a >= b."""
        return _mask(a.values >= b.values)

    def mask_equal(a: Any, b: Any) -> np.int32:
        """The mask of a == b."""
        return _mask(a.values == b.values)

    def select8(mask: int, a: Any, b: Any) -> Any:
        """a where the mask's bit is set, b elsewhere."""
        chosen = np.unpackbits(np.uint8(int(mask) & 255), bitorder="little").astype(bool)
        return a._with(np.where(chosen, a.values, b.values))

    def first_set(mask: int) -> np.int32:
        """The number of the lowest lane of a mask; 32 if it is empty."""
        bits = int(mask) & 0xFFFFFFFF
        return np.int32((bits & -bits).bit_length() - 1 if bits else 32)

    def count_set(mask: int) -> np.int32:
        """How many lanes a mask has."""
        return np.int32((int(mask) & 0xFFFFFFFF).bit_count())

    def _fold(v: Any, combine: Any) -> Any:
        """Halves against each other, the lower one first, as the compiled form does: NaN has the same fate."""
        values = v.values
        while len(values) > 1:
            half = len(values) // 2
            values = np.where(combine(values[:half], values[half:]), values[:half], values[half:])
        return values[0]

    def reduce_min8(v: Any) -> Any:
        """The least lane (of lanes without NaN)."""
        return _fold(v, np.less)

    def reduce_max8(v: Any) -> Any:
        """The greatest lane (of lanes without NaN)."""
        return _fold(v, np.greater)
