"""Eight numbers at once: `f32x8`, `i32x8` and `bool8`, one SIMD register each, with operators; and what is said of one or of eight alike.

Numba does not vectorise a kernel that shades a pixel or takes a step of a BVH traversal. So kernels that want vector instructions
say so. Most say it by their arguments alone: a formula such as

    kd * (INV_PI * max(ZERO, dot(n, l)))

takes one normal or eight, and is compiled for what it is called with. What must be written with care is a choice. Eight pixels cannot
take two branches of an `if`, so a choice that the lanes may take differently is

    where(cos_theta > ZERO, lit, BLACK)

which computes both; `if` remains for what all lanes share (a material, a light, a wrap mode), and `any_of(condition)` tells whether a part
can be left out for all of them. Conditions are joined by `&`, `|` and `~`. A number beside lanes becomes eight of it.

The classes below run uncompiled; compiled, the same names are LLVM vectors (`_lane_types`), which become AVX registers, pairs of SSE or
NEON registers, or plain scalars, whatever the CPU has. Every lane is rounded like a scalar, so the bits are the same.

NaN: comparisons with it are false; `max(a, b)` is b where b is greater and else a, as Python's own. So write the operand that may be NaN
second, and it loses.
"""

from __future__ import annotations

import builtins
from typing import Any

import numpy as np

from .._jit import MODE

__all__ = [
    "ALL_LANES", "add_rows", "add_rows_at", "all_of", "any_of", "at", "bool8", "compressed", "count_set", "double", "f32x8", "f64x8",
    "first_set", "four_bytes", "halves_swapped", "highest", "i32x8", "i64x8", "int32", "lane", "lanes_of", "load8", "load_rows", "long8",
    "lowest", "mask_of", "max", "min", "prefetch", "put", "single", "splat8", "splat8_int", "spread", "store8", "store_rows", "store_words",
    "sum8", "three_columns", "to_float", "to_int", "where", "with_lane",
]  # fmt: skip

ALL_LANES = np.int32(255)


class _Lanes:
    """Eight values of one kind, and the operators all kinds have."""

    __slots__ = ("values",)
    __array_ufunc__ = None  # NumPy's scalars leave the operators to us
    element: Any

    def __init__(self, values: Any) -> None:
        self.values = np.asarray(values, dtype=self.element).reshape(8)

    def _other(self, o: Any) -> Any:
        """The other operand's values: lanes of this kind, or a number."""
        return o.values if isinstance(o, _Lanes) else self.element(o)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.values.tolist()})"


class bool8(_Lanes):  # noqa: N801 - named like the number types it stands beside
    """Eight conditions, joined by & | ^ and ~."""

    __slots__ = ()
    element = np.bool_

    def __and__(self, o: Any) -> bool8:
        return bool8(self.values & self._other(o))

    def __or__(self, o: Any) -> bool8:
        return bool8(self.values | self._other(o))

    def __xor__(self, o: Any) -> bool8:
        return bool8(self.values ^ self._other(o))

    __rand__, __ror__, __rxor__ = __and__, __or__, __xor__

    def __invert__(self) -> bool8:
        return bool8(~self.values)

    def __bool__(self) -> bool:
        raise TypeError("eight conditions are not one: choose with where(), or ask any_of() or all_of()")


class _Numbers(_Lanes):
    """Lanes that one can calculate with and compare."""

    __slots__ = ()
    __hash__ = None  # type: ignore[assignment]

    def _with(self, values: Any) -> Any:
        return type(self)(values)

    def __add__(self, o: Any) -> Any:
        return self._with(self.values + self._other(o)) if _fit(self, o) else NotImplemented

    def __sub__(self, o: Any) -> Any:
        return self._with(self.values - self._other(o)) if _fit(self, o) else NotImplemented

    def __mul__(self, o: Any) -> Any:
        return self._with(self.values * self._other(o)) if _fit(self, o) else NotImplemented

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, o: Any) -> Any:
        return self._with(self._other(o) - self.values)

    def __neg__(self) -> Any:
        return self._with(-self.values)

    def __lt__(self, o: Any) -> bool8:
        return bool8(self.values < self._other(o))

    def __le__(self, o: Any) -> bool8:
        return bool8(self.values <= self._other(o))

    def __gt__(self, o: Any) -> bool8:
        return bool8(self.values > self._other(o))

    def __ge__(self, o: Any) -> bool8:
        return bool8(self.values >= self._other(o))

    def __eq__(self, o: Any) -> bool8:  # type: ignore[override]
        return bool8(self.values == self._other(o))

    def __ne__(self, o: Any) -> bool8:  # type: ignore[override]
        return bool8(self.values != self._other(o))


def _fit(a: _Numbers, o: Any) -> bool:
    return type(o) is type(a) or (not isinstance(o, _Lanes) and isinstance(o, (int, float, np.number)))


class f32x8(_Numbers):  # noqa: N801
    """Eight float32, with + - * / and comparisons."""

    __slots__ = ()
    element = np.float32

    def __truediv__(self, o: Any) -> f32x8:
        return f32x8(self.values / self._other(o))

    def __rtruediv__(self, o: Any) -> f32x8:
        return f32x8(self._other(o) / self.values)

    def __abs__(self) -> f32x8:
        return f32x8(np.abs(self.values))


class f64x8(f32x8):  # noqa: N801
    """Eight float64, with + - * / and comparisons."""

    __slots__ = ()
    element = np.float64

    def __truediv__(self, o: Any) -> f64x8:
        return f64x8(self.values / self._other(o))

    def __rtruediv__(self, o: Any) -> f64x8:
        return f64x8(self._other(o) / self.values)


class i32x8(_Numbers):  # noqa: N801
    """Eight int32, modulo 2^32, with + - * & | ^ << >> and comparisons."""

    __slots__ = ()
    element = np.int32

    def _other(self, o: Any) -> Any:
        return o.values if isinstance(o, _Lanes) else np.int64(o).astype(np.int32)

    def __and__(self, o: Any) -> i32x8:
        return self._with(self.values & self._other(o))

    def __or__(self, o: Any) -> i32x8:
        return self._with(self.values | self._other(o))

    def __xor__(self, o: Any) -> i32x8:
        return self._with(self.values ^ self._other(o))

    def __lshift__(self, o: Any) -> i32x8:
        return self._with(self.values << self._other(o))

    def __rshift__(self, o: Any) -> i32x8:
        return self._with(self.values >> self._other(o))


class i64x8(i32x8):  # noqa: N801
    """Eight int64, modulo 2^64: where products of two int32 are kept whole."""

    __slots__ = ()
    element = np.int64

    def _other(self, o: Any) -> Any:
        return o.values if isinstance(o, _Lanes) else np.int64(o)


if MODE == "compiled":
    from ._lane_choice import (
        all_of,
        any_of,
        compressed,
        count_set,
        first_set,
        halves_swapped,
        lane,
        lanes_of,
        mask_of,
        splat8,
        splat8_int,
        spread,
        where,
        with_lane,
    )
    from ._lane_gather import at, four_bytes, put
    from ._lane_memory import add_rows, add_rows_at, load8, load_rows, prefetch, store8, store_rows, store_words, three_columns
    from ._lane_numbers import double, highest, int32, long8, lowest, single, sum8, to_float, to_int
    from ._lane_operators import register

    register()
    max, min = builtins.max, builtins.min  # Numba knows them of lanes, too
else:

    def max(a: Any, b: Any) -> Any:
        """b where b > a, else a."""
        return where(b > a, b, a) if isinstance(a, _Lanes) or isinstance(b, _Lanes) else builtins.max(a, b)

    def min(a: Any, b: Any) -> Any:
        """b where b < a, else a."""
        return where(b < a, b, a) if isinstance(a, _Lanes) or isinstance(b, _Lanes) else builtins.min(a, b)

    def where(condition: Any, a: Any, b: Any) -> Any:
        """a where the condition holds, b elsewhere: of one or of eight. Both are computed."""
        if not isinstance(condition, bool8):
            if isinstance(a, _Lanes) != isinstance(b, _Lanes):
                return spread(a, b) if condition else spread(b, a)
            return a if condition else b
        if hasattr(a, "fields"):
            return type(a)(*(where(condition, getattr(a, name), getattr(b, name)) for name in a.fields))
        a, b = (x if isinstance(x, _Lanes) else _kind_of(x)(np.full(8, x)) for x in (a, b))
        return type(a)(np.where(condition.values, a.values, b.values))

    def _kind_of(x: Any) -> type[_Lanes]:
        if isinstance(x, (bool, np.bool_)):
            return bool8
        return i32x8 if isinstance(x, (int, np.integer)) else f32x8

    def spread(value: Any, like: Any) -> Any:
        """A number, as one or eight of it as `like` is."""
        if not isinstance(like, _Lanes) or isinstance(value, _Lanes):
            return value
        return _kind_of(value)(np.full(8, value))

    def compressed(v: Any, condition: bool8) -> Any:
        """The lanes of float32 or int32 where the condition holds, moved together to the front; what is behind them may be anything."""
        return v._with(np.concatenate([v.values[condition.values], v.values[~condition.values]]))

    def halves_swapped(v: Any) -> Any:
        """Lanes 4 to 7, then lanes 0 to 3."""
        return v._with(np.roll(v.values, 4))

    def any_of(condition: Any) -> bool:
        """Whether a condition holds for the one, or for any of eight."""
        return bool(condition.values.any()) if isinstance(condition, bool8) else bool(condition)

    def all_of(condition: Any) -> bool:
        """Whether a condition holds for the one, or for all of eight."""
        return bool(condition.values.all()) if isinstance(condition, bool8) else bool(condition)

    def mask_of(condition: bool8) -> np.int32:
        """The lanes where a condition holds as an integer: bit k tells of lane k."""
        return np.int32(np.packbits(condition.values, bitorder="little")[0])

    def lanes_of(mask: int) -> bool8:
        """The condition that holds in the lanes whose bit is set."""
        return bool8(np.unpackbits(np.uint8(int(mask) & 255), bitorder="little").astype(bool))

    def load8(array: np.ndarray, offset: int) -> Any:
        """Eight neighbours of a contiguous 1D float32 or int32 array, from `offset` on; it need not be aligned."""
        return (f32x8 if array.dtype == np.float32 else i32x8)(array[offset : offset + 8].copy())

    def store8(array: np.ndarray, offset: int, v: Any) -> None:
        """Write eight lanes to a contiguous 1D array of their kind, from `offset` on."""
        array[offset : offset + 8] = v.values

    def three_columns(array: np.ndarray, row: int) -> tuple[f32x8, f32x8, f32x8]:
        """The columns of eight neighbouring rows of a contiguous (n, 3) array of float32 or float64, rounded to float32: three lanes."""
        x, y, z = (f32x8(column) for column in array[row : row + 8].T)
        return x, y, z

    def splat8(x: np.float32) -> f32x8:
        """Eight times the float x."""
        return f32x8(np.full(8, x, dtype=np.float32))

    def splat8_int(x: np.int32) -> i32x8:
        """Eight times the integer x."""
        return i32x8(np.full(8, np.int64(x), dtype=np.int64).astype(np.int32))

    def prefetch(array: np.ndarray, index: Any) -> None:
        """Ask for a row of a contiguous array (an element, if it has one dimension), or for eight, to be brought near."""

    def store_words(array: np.ndarray, start: int, step: int, a: i32x8, b: i32x8, c: i32x8, d: i32x8) -> None:
        """Write (a, b, c, d) of lane k to array[start + step k :] for all eight: a part of eight rows of a table of int32."""
        for k in range(8):
            array[start + step * k : start + step * k + 4] = [v.values[k] for v in (a, b, c, d)]

    def add_rows(array: np.ndarray, row: int, a: f32x8, b: f32x8, c: f32x8, d: f32x8) -> None:
        """Add (a, b, c, d) of each lane to eight neighbouring rows of a contiguous (n, 4) float32 array, from `row` on."""
        array[row : row + 8] += np.stack([a.values, b.values, c.values, d.values], axis=1)

    def add_rows_at(array: np.ndarray, index: i32x8, a: f32x8, b: f32x8, c: f32x8, d: f32x8) -> None:
        """Add (a, b, c, d) of each lane to eight rows of a contiguous (n, 4) float32 array, from the first lane to the last."""
        for k, row in enumerate(index.values):
            array[row] += np.array([a.values[k], b.values[k], c.values[k], d.values[k]])

    def load_rows(array: np.ndarray, row: int) -> tuple[f32x8, f32x8, f32x8, f32x8]:
        """(a, b, c, d) of eight neighbouring rows of a contiguous (n, 4) float32 array, from `row` on: a lane for each row."""
        a, b, c, d = (f32x8(array[row : row + 8, k].copy()) for k in range(4))
        return a, b, c, d

    def store_rows(array: np.ndarray, row: int, a: f32x8, b: f32x8, c: f32x8, d: f32x8) -> None:
        """Write (a, b, c, d) of each lane to eight neighbouring rows of a contiguous (n, 4) float32 array, from `row` on."""
        array[row : row + 8] = np.stack([a.values, b.values, c.values, d.values], axis=1)

    def put(array: np.ndarray, index: Any, v: Any) -> None:
        """Write a number, or eight lanes, to a place, or eight, of a contiguous 1D array; of two in one place the higher lane stays."""
        if not isinstance(index, _Lanes):
            array[index] = v
            return
        for place, value in zip(index.values, v.values, strict=True):
            array[place] = value

    def lane(v: Any, i: int) -> Any:
        """One lane, 0 <= i < 8."""
        return v.values[i]

    def with_lane(v: Any, i: int, x: Any) -> Any:
        """The lanes with another number in lane i."""
        values = v.values.copy()
        values[i] = x
        return v._with(values)

    def at(array: np.ndarray, index: Any) -> Any:
        """The element of a contiguous array at an index, or the eight at eight.

        `index` is an integer or lanes, or a tuple of them, one for each dimension; it must lie within. Bytes come as integers.
        """
        parts = index if isinstance(index, tuple) else (index,)
        if not any(isinstance(part, _Lanes) for part in parts):
            value = array[parts]
            return np.int32(value) if array.dtype == np.uint8 else value
        found = array[tuple(part.values if isinstance(part, _Lanes) else part for part in parts)]
        return (f32x8 if array.dtype == np.float32 else i32x8)(found)

    def four_bytes(array: np.ndarray, start: int, index: Any) -> Any:
        """The bytes 4 index .. 4 index + 3 after `start`, as an int32 or eight, the first one lowest."""
        places = np.int64(start) + 4 * np.int64(index.values if isinstance(index, _Lanes) else index)
        words = array[places[..., None] + np.arange(4)].astype("<u1").view("<i4")[..., 0]
        return i32x8(words) if isinstance(index, _Lanes) else np.int32(words)

    def sum8(v: Any) -> Any:
        """The sum of eight numbers, from the first to the last."""
        total = v.values[0]
        for value in v.values[1:]:
            total = total + value
        return total

    def int32(a: Any) -> Any:
        """A number, which must fit, as int32, towards zero; integers lose their upper bits."""
        return i32x8(a.values.astype(np.int32)) if isinstance(a, _Lanes) else np.int32(a)

    def double(a: Any) -> Any:
        """A float32 or an integer as float64."""
        return f64x8(a.values) if isinstance(a, _Lanes) else np.float64(a)

    def single(a: Any) -> Any:
        """The nearest float32 of a float64."""
        return f32x8(a.values) if isinstance(a, _Lanes) else np.float32(a)

    def long8(a: i32x8) -> i64x8:
        """Eight int32 as eight int64."""
        return i64x8(a.values)

    def to_float(a: Any) -> Any:
        """The nearest float32 of an integer."""
        return f32x8(a.values.astype(np.float32)) if isinstance(a, _Lanes) else np.float32(a)

    def to_int(a: Any) -> Any:
        """The integer towards zero; -2^31 for NaN and for what an int32 cannot hold."""
        values = np.asarray(a.values if isinstance(a, _Lanes) else a)
        fits = (values >= np.float32(-(2.0**31))) & (values < np.float32(2.0**31))
        found = np.where(fits, np.where(fits, values, np.float32(0)).astype(np.int32), np.int32(-(2**31)))
        return i32x8(found) if isinstance(a, _Lanes) else np.int64(found)

    def first_set(mask: int) -> np.int32:
        """The number of the lowest lane of a mask; 32 if it is empty."""
        bits = int(mask) & 0xFFFFFFFF
        return np.int32((bits & -bits).bit_length() - 1 if bits else 32)

    def count_set(mask: int) -> np.int32:
        """How many lanes a mask has."""
        return np.int32((int(mask) & 0xFFFFFFFF).bit_count())

    def _fold(v: Any, combine: Any) -> Any:
        """Halves against each other, the lower one first, as the compiled form does: NaN has the same fate."""
        if not isinstance(v, _Lanes):
            return v
        values = v.values
        while len(values) > 1:
            half = len(values) // 2
            values = np.where(combine(values[:half], values[half:]), values[:half], values[half:])
        return values[0]

    def lowest(v: Any) -> Any:
        """The number itself, or the least of eight (of lanes without NaN)."""
        return _fold(v, np.less)

    def highest(v: Any) -> Any:
        """The number itself, or the greatest of eight (of lanes without NaN)."""
        return _fold(v, np.greater)
