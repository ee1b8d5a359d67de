"""Lanes that are neighbours in memory: rows and runs of eight."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from ._lane_types import EIGHT, FLOAT_LANES, I8, I32, I64, INT_LANES, LaneType

__all__ = ["add_rows", "add_rows_at", "lanes_in", "load8", "load_rows", "prefetch", "store8", "store_rows", "store_words", "three_columns"]


def lanes_in(array: Any) -> LaneType | None:
    if isinstance(array, types.Array) and array.ndim == 1 and array.layout == "C":
        for kind in (FLOAT_LANES, INT_LANES):
            if array.dtype == kind.element:
                return kind
    return None


def _address(context: Any, builder: Any, array_type: Any, array: Any, offset: Any, kind: LaneType) -> Any:
    data = context.make_array(array_type)(context, builder, array).data
    element = builder.gep(data, [offset], inbounds=True)
    return builder.bitcast(element, ir.PointerType(kind.vector))


@intrinsic  # type: ignore[misc]
def load8(typingctx: Any, array: Any, offset: Any) -> Any:
    """Eight neighbours of a contiguous 1D float32 or int32 array, from `offset` on; it need not be aligned."""
    kind = lanes_in(array)
    if kind is None or not isinstance(offset, types.Integer):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        loaded = builder.load(_address(context, builder, sig.args[0], args[0], args[1], kind))
        loaded.align = 4
        return loaded

    return kind(array, types.intp), lower


@intrinsic  # type: ignore[misc]
def store8(typingctx: Any, array: Any, offset: Any, v: Any) -> Any:
    """Write eight lanes to a contiguous 1D array of their kind, from `offset` on."""
    kind = lanes_in(array)
    if kind is None or v != kind or not array.mutable or not isinstance(offset, types.Integer):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _address(context, builder, sig.args[0], args[0], args[1], kind)).align = 4
        return context.get_dummy_value()

    return types.void(array, types.intp, kind), lower


@intrinsic  # type: ignore[misc]
def load_rows(typingctx: Any, array: Any, row: Any) -> Any:
    """(a, b, c, d) of eight neighbouring rows of a contiguous (n, 4) float32 array, from `row` on: a lane for each row."""
    fits = isinstance(array, types.Array) and array.ndim == 2 and array.layout == "C" and array.dtype == types.float32
    if not fits or not isinstance(row, types.Integer):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        start = builder.mul(args[1], I64(4))

        def shuffled(x: Any, y: Any, lanes: list[int]) -> Any:
            return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(I32, EIGHT), lanes))

        pairs = []
        for pair in range(4):
            pointer = builder.bitcast(builder.gep(data, [builder.add(start, I64(8 * pair))]), ir.PointerType(FLOAT_LANES.vector))
            loaded = builder.load(pointer)
            loaded.align = 4
            pairs.append(loaded)
        # Rows 0 and 4 side by side, 1 and 5, and so on; then two columns of four rows each; then one column of all.
        sides = [shuffled(pairs[k // 2], pairs[k // 2 + 2], [4 * (k % 2) + n for n in (0, 1, 2, 3, 8, 9, 10, 11)]) for k in range(4)]
        low, high = [0, 8, 1, 9, 4, 12, 5, 13], [2, 10, 3, 11, 6, 14, 7, 15]
        columns = [
            shuffled(shuffled(sides[0], sides[1], halves), shuffled(sides[2], sides[3], halves), lanes)
            for halves in (low, high)
            for lanes in ([0, 1, 8, 9, 4, 5, 12, 13], [2, 3, 10, 11, 6, 7, 14, 15])
        ]
        return context.make_tuple(builder, sig.return_type, columns)

    return types.UniTuple(FLOAT_LANES, 4)(array, types.int64), lower


def _rows(*, adds: bool, description: str) -> Any:
    def build(typingctx: Any, array: Any, row: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
        fits = isinstance(array, types.Array) and array.ndim == 2 and array.layout == "C" and array.dtype == types.float32 and array.mutable
        if not fits or not isinstance(row, types.Integer) or (a, b, c, d) != (FLOAT_LANES,) * 4:
            return None
        return types.void(array, types.int64, a, b, c, d), _lower_rows(adds)

    build.__doc__ = description
    return intrinsic(build)


def _lower_rows(adds: bool) -> Any:
    def shuffled(builder: Any, x: Any, y: Any, lanes: list[int]) -> Any:
        return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(I32, EIGHT), lanes))

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        start = builder.mul(args[1], I64(4))
        for pair in range(4):
            k, m = 2 * pair, 2 * pair + 1
            # Of two rows: first their a and b, then their c and d, then both side by side.
            ab = shuffled(builder, args[2], args[3], [k, k + 8, 0, 0, m, m + 8, 0, 0])
            cd = shuffled(builder, args[4], args[5], [k, k + 8, 0, 0, m, m + 8, 0, 0])
            rows = shuffled(builder, ab, cd, [0, 1, 8, 9, 4, 5, 12, 13])
            element = builder.gep(data, [builder.add(start, I64(8 * pair))])
            pointer = builder.bitcast(element, ir.PointerType(FLOAT_LANES.vector))
            if adds:
                loaded = builder.load(pointer)
                loaded.align = 4
                rows = builder.fadd(loaded, rows)
            builder.store(rows, pointer).align = 4
        return context.get_dummy_value()

    return lower


add_rows = _rows(
    adds=True, description="Add (a, b, c, d) of each lane to eight neighbouring rows of a contiguous (n, 4) float32 array, from `row` on."
)
store_rows = _rows(
    adds=False, description="Write (a, b, c, d) of each lane to eight neighbouring rows of a contiguous (n, 4) float32 array."
)


@intrinsic  # type: ignore[misc]
def add_rows_at(typingctx: Any, array: Any, index: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """Add (a, b, c, d) of each lane to eight rows of a contiguous (n, 4) float32 array, from the first lane to the last."""
    fits = isinstance(array, types.Array) and array.ndim == 2 and array.layout == "C" and array.dtype == types.float32 and array.mutable
    if not fits or index != INT_LANES or (a, b, c, d) != (FLOAT_LANES,) * 4:
        return None
    four = ir.VectorType(FLOAT_LANES.vector.element, 4)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        for k, row in enumerate(rows_of_lanes(builder, args[2:])):
            place = builder.mul(builder.sext(builder.extract_element(args[1], I32(k)), I64), I64(4))
            pointer = builder.bitcast(builder.gep(data, [place]), ir.PointerType(four))
            loaded = builder.load(pointer)
            loaded.align = 4
            builder.store(builder.fadd(loaded, row), pointer).align = 4
        return context.get_dummy_value()

    return types.void(array, index, a, b, c, d), lower


def rows_of_lanes(builder: Any, columns: Any) -> list[Any]:
    """Four columns of eight lanes as eight rows of four."""

    def shuffled(x: Any, y: Any, lanes: list[int]) -> Any:
        return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(I32, len(lanes)), lanes))

    rows = []
    for half in (0, 4):
        pairs = [[half + k, half + k + 8, half + k + 1, half + k + 9] for k in (0, 2)]
        ab, cd = ([shuffled(columns[n], columns[n + 1], lanes) for lanes in pairs] for n in (0, 2))
        for k in range(4):
            first = 2 * (k % 2)
            rows.append(shuffled(ab[k // 2], cd[k // 2], [first, first + 1, first + 4, first + 5]))
    return rows


@intrinsic  # type: ignore[misc]
def prefetch(typingctx: Any, array: Any, index: Any) -> Any:
    """Ask for a row of a contiguous array (an element, if it has one dimension), or for eight, to be brought near: it is soon looked at."""
    eight = index == INT_LANES
    if not (isinstance(array, types.Array) and array.ndim <= 2 and array.layout == "C" and (eight or isinstance(index, types.Integer))):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        view = context.make_array(sig.args[0])(context, builder, args[0])
        byte = ir.PointerType(I8)
        function_type = ir.FunctionType(ir.VoidType(), [byte, I32, I32, I32])
        function = cgutils.get_or_insert_function(builder.module, function_type, "llvm.prefetch.p0")
        n_bytes = context.get_abi_sizeof(context.get_data_type(array.dtype))
        for k in range(EIGHT if eight else 1):
            row = builder.sext(builder.extract_element(args[1], I32(k)), I64) if eight else args[1]
            if array.ndim == 2:
                row = builder.mul(row, cgutils.unpack_tuple(builder, view.shape)[1])
            place = builder.bitcast(builder.gep(view.data, [row]), byte)
            for offset in range(0, n_bytes, 64):
                builder.call(function, [builder.gep(place, [I64(offset)]), I32(0), I32(3), I32(1)])
        return context.get_dummy_value()

    return types.void(array, INT_LANES if eight else types.int64), lower


@intrinsic  # type: ignore[misc]
def store_words(typingctx: Any, array: Any, start: Any, step: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """Write (a, b, c, d) of lane k to array[start + step k :] for all eight: a part of eight rows of a table of int32."""
    fits = lanes_in(array) == INT_LANES and array.mutable and isinstance(start, types.Integer) and isinstance(step, types.Integer)
    if not fits or (a, b, c, d) != (INT_LANES,) * 4:
        return None
    four = ir.VectorType(I32, 4)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        for k, row in enumerate(rows_of_lanes(builder, args[3:])):
            place = builder.add(args[1], builder.mul(args[2], I64(k)))
            builder.store(row, builder.bitcast(builder.gep(data, [place]), ir.PointerType(four))).align = 4
        return context.get_dummy_value()

    return types.void(array, types.int64, types.int64, a, b, c, d), lower


@intrinsic  # type: ignore[misc]
def three_columns(typingctx: Any, array: Any, row: Any) -> Any:
    """The columns of eight neighbouring rows of a contiguous (n, 3) array of float32 or float64, rounded to float32: three lanes."""
    fits = isinstance(array, types.Array) and array.ndim == 2 and array.layout == "C" and array.dtype in (types.float32, types.float64)
    if not fits or not isinstance(row, types.Integer):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        element = builder.gep(data, [builder.mul(args[1], I64(3))])
        kind = ir.VectorType(data.type.pointee, 3 * EIGHT)
        rows = builder.load(builder.bitcast(element, ir.PointerType(kind)))
        rows.align = 4
        columns = []
        for k in range(3):
            lanes = ir.Constant(ir.VectorType(I32, EIGHT), list(range(k, 3 * EIGHT, 3)))
            column = builder.shuffle_vector(rows, rows, lanes)
            columns.append(column if array.dtype == types.float32 else builder.fptrunc(column, FLOAT_LANES.vector))
        return context.make_tuple(builder, sig.return_type, columns)

    return types.UniTuple(FLOAT_LANES, 3)(array, types.int64), lower
