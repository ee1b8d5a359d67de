"""Lanes that lie anywhere in memory: eight elements at eight places, found or put there."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from ._lane_memory import lanes_in
from ._lane_types import BOOL_LANES, EIGHT, FLOAT_LANES, I32, I64, INT_LANES, LONG_LANES, IntLanes, LaneType, eightfold, spread_value

__all__ = ["at", "four_bytes", "put"]


def _scatter(context: Any, builder: Any, array_type: Any, array: Any, index: Any, v: Any, condition: Any) -> Any:
    kind = lanes_in(array_type)
    assert kind is not None
    data = context.make_array(array_type)(context, builder, array).data
    pointers = _addresses(builder, data, index, kind)
    name = f"llvm.masked.scatter.v8{'f' if kind == FLOAT_LANES else 'i'}32.v8p0"
    function_type = ir.FunctionType(ir.VoidType(), [kind.vector, pointers.type, I32, BOOL_LANES.vector])
    function = cgutils.get_or_insert_function(builder.module, function_type, name)
    builder.call(function, [v, pointers, I32(4), condition])
    return context.get_dummy_value()


def _put_one(array: Any, index: Any, v: Any) -> Any:
    if not (isinstance(array, types.Array) and array.ndim == 1 and array.layout == "C" and array.mutable and isinstance(v, types.Number)):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        builder.store(args[2], builder.gep(data, [args[1]]))
        return context.get_dummy_value()

    return types.void(array, types.int64, array.dtype), lower


@intrinsic  # type: ignore[misc]
def put(typingctx: Any, array: Any, index: Any, v: Any) -> Any:
    """Write a number, or eight lanes, to a place, or eight, of a contiguous 1D array; of two in one place the higher lane stays."""
    if isinstance(index, types.Integer):
        return _put_one(array, index, v)
    if lanes_in(array) != v or index != INT_LANES or not array.mutable:
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _scatter(context, builder, sig.args[0], *args, ir.Constant(BOOL_LANES.vector, [1] * EIGHT))

    return types.void(array, index, v), lower


def _element(builder: Any, pointer: Any, array: Any) -> Any:
    """Load an array's element; bytes become int32."""
    value = builder.load(pointer)
    return builder.zext(value, I32) if array.dtype == types.uint8 else value


@intrinsic  # type: ignore[misc]
def at(typingctx: Any, array: Any, index: Any) -> Any:
    """The element of a contiguous array at an index, or the eight at eight.

    `index` is an integer or lanes, or a tuple of them, one for each dimension; it must lie within. Bytes come as integers.
    """
    parts = tuple(index) if isinstance(index, types.BaseTuple) else (index,)
    fits = isinstance(array, types.Array) and array.layout == "C" and array.ndim == len(parts)
    if not fits or not all(isinstance(part, (types.Integer, IntLanes)) for part in parts):
        return None
    single = types.int32 if array.dtype == types.uint8 else array.dtype
    eight = any(isinstance(part, IntLanes) for part in parts)
    kind = eightfold(single) if eight else single
    parts = tuple(types.unliteral(part) for part in parts)
    wanted = types.Tuple(parts) if isinstance(index, types.BaseTuple) else parts[0]

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        view = context.make_array(sig.args[0])(context, builder, args[0])
        shape = cgutils.unpack_tuple(builder, view.shape)
        found = [args[1]] if len(parts) == 1 and not isinstance(index, types.BaseTuple) else cgutils.unpack_tuple(builder, args[1])
        one: Any = I64(0)
        lanes: Any = None
        for dimension, (part, value) in enumerate(zip(parts, found, strict=True)):
            one = builder.mul(one, shape[dimension])
            if lanes is not None:
                step = spread_value(builder, INT_LANES, builder.trunc(shape[dimension], I32))
                lanes = builder.mul(lanes, step)
            if isinstance(part, IntLanes):
                lanes = value if lanes is None else builder.add(lanes, value)
            else:
                one = builder.add(one, context.cast(builder, value, part, types.int64))
        base = builder.gep(view.data, [one], inbounds=False)
        return _element(builder, base, array) if lanes is None else _gather(builder, base, lanes, array, kind)

    return kind(array, wanted), lower


def _addresses(builder: Any, base: Any, lanes: Any, kind: LaneType) -> Any:
    """The addresses of eight elements."""
    wide = builder.sext(lanes, LONG_LANES.vector)
    # llvmlite builds addresses from single numbers only; LLVM takes lanes in the same place.
    pointers = builder.gep(base, [I64(0)])
    pointers.indices, pointers.type = [wide], ir.VectorType(ir.PointerType(kind.vector.element), EIGHT)
    return pointers


def _gather_words(builder: Any, base: Any, lanes: Any, kind: LaneType) -> Any:
    """Eight 32-bit elements: one instruction where the CPU has one that is worth it."""
    pointers = _addresses(builder, base, lanes, kind)
    name = f"llvm.masked.gather.v8{'f' if kind == FLOAT_LANES else 'i'}32.v8p0"
    function_type = ir.FunctionType(kind.vector, [pointers.type, I32, BOOL_LANES.vector, kind.vector])
    function = cgutils.get_or_insert_function(builder.module, function_type, name)
    everywhere = ir.Constant(BOOL_LANES.vector, [1] * EIGHT)
    return builder.call(function, [pointers, I32(1), everywhere, ir.Constant(kind.vector, ir.Undefined)])


def _gather(builder: Any, base: Any, lanes: Any, array: Any, kind: LaneType) -> Any:
    if array.dtype in (types.float32, types.int32):
        return _gather_words(builder, base, lanes, kind)
    made = ir.Constant(kind.vector, ir.Undefined)
    for k in range(EIGHT):
        offset = builder.sext(builder.extract_element(lanes, I32(k)), I64)
        made = builder.insert_element(made, _element(builder, builder.gep(base, [offset]), array), I32(k))
    return made


@intrinsic  # type: ignore[misc]
def four_bytes(typingctx: Any, array: Any, start: Any, index: Any) -> Any:
    """The bytes 4 index .. 4 index + 3 after `start`, as an int32 or eight, the first one lowest."""
    eight = isinstance(index, IntLanes)
    fits = isinstance(array, types.Array) and array.dtype == types.uint8 and array.layout == "C" and isinstance(start, types.Integer)
    if not fits or not (eight or isinstance(index, types.Integer)):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        base = builder.bitcast(builder.gep(data, [args[1]]), ir.PointerType(I32))

        def word(offset: Any) -> Any:
            loaded = builder.load(builder.gep(base, [offset]))
            loaded.align = 1
            return loaded

        if not eight:
            return word(args[2])
        return _gather_words(builder, base, args[2], INT_LANES)

    kind = INT_LANES if eight else types.int32
    return kind(array, types.int64, INT_LANES if eight else types.int64), lower
