"""Choosing between lanes, looking at one, and conditions that hold in some of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from ._lane_types import BOOL_LANES, EIGHT, FLOAT_LANES, I1, I8, I32, INT_LANES, BoolLanes, LaneType, eightfold, scalar_for, spread_value

__all__ = [
    "all_of", "any_of", "compressed", "count_set", "first_set", "halves_swapped", "lane", "lanes_of", "mask_of", "splat8", "splat8_int",
    "spread", "where", "with_lane",
]  # fmt: skip


def _chosen(context: Any, builder: Any, kind: Any, condition: Any, a: Any, b: Any) -> Any:
    """`select`, field by field where the values are structs."""
    fields = getattr(kind, "llvm_fields", None)
    if fields is None:
        return builder.select(condition, a, b)
    made = ir.Constant(context.get_value_type(kind), ir.Undefined)
    for k in range(fields):
        part = builder.select(condition, builder.extract_value(a, k), builder.extract_value(b, k))
        made = builder.insert_value(made, part, k)
    return made


@intrinsic  # type: ignore[misc]
def where(typingctx: Any, condition: Any, a: Any, b: Any) -> Any:
    """a where the condition holds, b elsewhere: of one or of eight. Both are computed."""
    kind = scalar_for(typingctx, a, b)
    if kind is None or not isinstance(condition, (types.Boolean, BoolLanes)):
        return None
    if isinstance(condition, BoolLanes):
        kind = eightfold(kind)
        if kind is None:
            return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _chosen(context, builder, sig.return_type, *args)

    return kind(condition, kind, kind), lower


@intrinsic  # type: ignore[misc]
def spread(typingctx: Any, value: Any, like: Any) -> Any:
    """A number, as one or eight of it as `like` is."""
    value = types.unliteral(value)
    kind = eightfold(value) if isinstance(like, LaneType) else value

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return context.cast(builder, args[0], sig.args[0], sig.return_type)

    return kind(value, like), lower


def _splat(kind: LaneType, description: str) -> Any:
    def build(typingctx: Any, x: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return spread_value(builder, kind, args[0])

        return (kind(kind.element), lower) if isinstance(x, types.Number) else None

    build.__doc__ = description
    return intrinsic(build)


splat8 = _splat(FLOAT_LANES, "Eight times the float x.")
splat8_int = _splat(INT_LANES, "Eight times the integer x.")


@intrinsic  # type: ignore[misc]
def lane(typingctx: Any, v: Any, i: Any) -> Any:
    """One lane, 0 <= i < 8."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.extract_element(args[0], args[1])

    return (v.element(v, types.int32), lower) if isinstance(v, LaneType) and isinstance(i, types.Integer) else None


@intrinsic  # type: ignore[misc]
def with_lane(typingctx: Any, v: Any, i: Any, x: Any) -> Any:
    """The lanes with another number in lane i."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.insert_element(args[0], args[2], args[1])

    fits = isinstance(v, LaneType) and isinstance(i, types.Integer) and isinstance(x, types.Number)
    return (v(v, types.int32, v.element), lower) if fits else None


@intrinsic  # type: ignore[misc]
def compressed(typingctx: Any, v: Any, condition: Any) -> Any:
    """The lanes of float32 or int32 where the condition holds, moved together to the front; what is behind them may be anything."""
    if v not in (FLOAT_LANES, INT_LANES) or condition != BOOL_LANES:
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        kind = sig.return_type
        name = f"llvm.experimental.vector.compress.v8{'f' if kind == FLOAT_LANES else 'i'}32"
        function_type = ir.FunctionType(kind.vector, [kind.vector, BOOL_LANES.vector, kind.vector])
        function = cgutils.get_or_insert_function(builder.module, function_type, name)
        return builder.call(function, [args[0], args[1], ir.Constant(kind.vector, ir.Undefined)])

    return v(v, condition), lower


@intrinsic  # type: ignore[misc]
def halves_swapped(typingctx: Any, v: Any) -> Any:
    """Lanes 4 to 7, then lanes 0 to 3."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.shuffle_vector(args[0], args[0], ir.Constant(ir.VectorType(I32, EIGHT), [4, 5, 6, 7, 0, 1, 2, 3]))

    return (v(v), lower) if isinstance(v, LaneType) else None


# --- conditions -----------------------------------------------------------------------------------------------------------


def _condition(of_mask: Callable[[Any, Any], Any], description: str) -> Any:
    def build(typingctx: Any, condition: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return of_mask(builder, builder.bitcast(args[0], I8)) if condition == BOOL_LANES else args[0]

        return (types.boolean(condition), lower) if isinstance(condition, (types.Boolean, BoolLanes)) else None

    build.__doc__ = description
    return intrinsic(build)


any_of = _condition(
    lambda builder, mask: builder.icmp_unsigned("!=", mask, I8(0)), "Whether a condition holds for the one, or for any of eight."
)
all_of = _condition(
    lambda builder, mask: builder.icmp_unsigned("==", mask, I8(255)), "Whether a condition holds for the one, or for all of eight."
)


@intrinsic  # type: ignore[misc]
def mask_of(typingctx: Any, condition: Any) -> Any:
    """The lanes where a condition holds as an integer: bit k tells of lane k."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.zext(builder.bitcast(args[0], I8), I32)

    return (types.int32(condition), lower) if condition == BOOL_LANES else None


@intrinsic  # type: ignore[misc]
def lanes_of(typingctx: Any, mask: Any) -> Any:
    """The condition that holds in the lanes whose bit is set."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.bitcast(builder.trunc(args[0], I8), BOOL_LANES.vector)

    return (BOOL_LANES(types.int32), lower) if isinstance(mask, types.Integer) else None


def _bit_count(lowering: Any, description: str) -> Any:
    def build(typingctx: Any, mask: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return lowering(builder, args[0])

        return (types.int32(types.int32), lower) if isinstance(mask, types.Integer) else None

    build.__doc__ = description
    return intrinsic(build)


first_set = _bit_count(lambda builder, x: builder.cttz(x, I1(0)), "The number of the lowest lane of a mask; 32 if it is empty.")
count_set = _bit_count(lambda builder, x: builder.ctpop(x), "How many lanes a mask has.")
