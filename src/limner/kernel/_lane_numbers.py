"""From lanes of one kind of number to another, and from eight to one."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

from ._lane_operators import compare
from ._lane_types import DOUBLE_LANES, EIGHT, FLOAT_LANES, I32, I64, INT_LANES, LONG_LANES, NUMBERS

__all__ = ["double", "highest", "int32", "long8", "lowest", "single", "sum8", "to_float", "to_int"]


def _reduction(sign: str, description: str) -> Any:
    def build(typingctx: Any, v: Any) -> Any:
        if isinstance(v, types.Number):
            v = types.unliteral(v)
            return v(v), lambda context, builder, sig, args: args[0]

        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            values, width = args[0], EIGHT
            while width > 1:
                width //= 2
                low, high = (
                    builder.shuffle_vector(values, values, ir.Constant(ir.VectorType(I32, width), list(range(at, at + width))))
                    for at in (0, width)
                )
                values = builder.select(compare(builder, sign, v, low, high), low, high)
            return builder.extract_element(values, I32(0))

        return (v.element(v), lower) if v in NUMBERS else None

    build.__doc__ = description
    return intrinsic(build)


lowest = _reduction("<", "The number itself, or the least of eight (of lanes without NaN).")
highest = _reduction(">", "The number itself, or the greatest of eight (of lanes without NaN).")


@intrinsic  # type: ignore[misc]
def sum8(typingctx: Any, v: Any) -> Any:
    """The sum of eight numbers, from the first to the last."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        total = builder.extract_element(args[0], I32(0))
        for k in range(1, EIGHT):
            total = (builder.fadd if v == FLOAT_LANES else builder.add)(total, builder.extract_element(args[0], I32(k)))
        return total

    return (v.element(v), lower) if v in (FLOAT_LANES, INT_LANES) else None


@intrinsic  # type: ignore[misc]
def int32(typingctx: Any, a: Any) -> Any:
    """A number, which must fit, as int32, towards zero; integers lose their upper bits."""
    if isinstance(a, types.Number):
        a = types.unliteral(a)
        return types.int32(a), lambda context, builder, sig, args: context.cast(builder, args[0], a, types.int32)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.fptosi(args[0], INT_LANES.vector) if a == FLOAT_LANES else args[0]

    return (INT_LANES(a), lower) if a in (FLOAT_LANES, INT_LANES) else None


@intrinsic  # type: ignore[misc]
def double(typingctx: Any, a: Any) -> Any:
    """A float32 or an integer as float64."""
    if isinstance(a, types.Number):
        a = types.unliteral(a)
        return types.float64(a), lambda context, builder, sig, args: context.cast(builder, args[0], a, types.float64)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return (builder.sitofp if a == INT_LANES else builder.fpext)(args[0], DOUBLE_LANES.vector)

    return (DOUBLE_LANES(a), lower) if a in (FLOAT_LANES, INT_LANES) else None


@intrinsic  # type: ignore[misc]
def single(typingctx: Any, a: Any) -> Any:
    """The nearest float32 of a float64."""
    if isinstance(a, types.Number):
        return types.float32(types.float64), lambda context, builder, sig, args: builder.fptrunc(args[0], ir.FloatType())

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.fptrunc(args[0], FLOAT_LANES.vector)

    return (FLOAT_LANES(DOUBLE_LANES), lower) if a == DOUBLE_LANES else None


@intrinsic  # type: ignore[misc]
def long8(typingctx: Any, a: Any) -> Any:
    """Eight int32 as eight int64."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.sext(args[0], LONG_LANES.vector)

    return (LONG_LANES(INT_LANES), lower) if a == INT_LANES else None


@intrinsic  # type: ignore[misc]
def to_float(typingctx: Any, a: Any) -> Any:
    """The nearest float32 of an integer."""
    if isinstance(a, types.Number):
        a = types.unliteral(a)
        return types.float32(a), lambda context, builder, sig, args: context.cast(builder, args[0], a, types.float32)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.sitofp(args[0], FLOAT_LANES.vector)

    return (FLOAT_LANES(INT_LANES), lower) if a == INT_LANES else None


@intrinsic  # type: ignore[misc]
def to_int(typingctx: Any, a: Any) -> Any:
    """The integer towards zero; -2^31 for NaN and for what an int32 cannot hold."""
    if not (isinstance(a, types.Float) or a == FLOAT_LANES):
        return None
    eight = a == FLOAT_LANES
    floats, ints = (FLOAT_LANES.vector, INT_LANES.vector) if eight else (ir.FloatType(), I32)

    def constant(value: float) -> Any:
        return ir.Constant(floats, [value] * EIGHT if eight else value)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        low, high = constant(-(2.0**31)), constant(2.0**31)
        fits = builder.and_(builder.fcmp_ordered(">=", args[0], low), builder.fcmp_ordered("<", args[0], high))
        # fptosi of what does not fit is poison in LLVM: choose a number that fits before the conversion.
        found = builder.fptosi(builder.select(fits, args[0], low), ints)
        return found if eight else builder.sext(found, I64)

    return (INT_LANES(FLOAT_LANES) if eight else types.int64(types.float32)), lower
