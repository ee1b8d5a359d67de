"""What kernels need of the machine itself: square root, floor, and the bits of a float, of one number or of eight lanes."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

from ._lane_types import FLOAT_LANES, INT_LANES, vector_call

__all__ = ["as_float", "as_int", "floor", "sqrt"]


def _unary_float(name: str, description: str) -> Any:
    def build(typingctx: Any, x: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            function = builder.module.declare_intrinsic(name, [ir.FloatType()])
            return builder.call(function, args)

        def lower_lanes(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return vector_call(builder, f"{name}.v8f32", args)

        if x == FLOAT_LANES:
            return FLOAT_LANES(FLOAT_LANES), lower_lanes
        return (types.float32(types.float32), lower) if isinstance(x, types.Number) else None

    build.__doc__ = description
    return intrinsic(build)


sqrt = _unary_float("llvm.sqrt", "The correctly rounded square root of a float32.")
floor = _unary_float("llvm.floor", "The greatest integer not above a float32, as float32.")


def _same_bits(one: Any, eight: Any, llvm_one: ir.Type, description: str) -> Any:
    """Reinterpret: `one` and `eight` are (from, to)."""

    def build(typingctx: Any, x: Any) -> Any:
        source, target = eight if x == eight[0] else one
        llvm_type = target.vector if x == eight[0] else llvm_one

        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.bitcast(args[0], llvm_type)

        return target(source), lower

    build.__doc__ = description
    return intrinsic(build)


as_int = _same_bits((types.float32, types.int32), (FLOAT_LANES, INT_LANES), ir.IntType(32), "The bits of a float32 as int32.")
as_float = _same_bits((types.int32, types.float32), (INT_LANES, FLOAT_LANES), ir.FloatType(), "The float32 of the given bits.")
