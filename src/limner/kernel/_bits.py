"""What kernels need of the machine itself: square root, floor, and the bits of a float, as single instructions."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

__all__ = ["as_float", "as_int", "floor", "sqrt"]


def _unary_float(name: str, description: str) -> Any:
    def build(typingctx: Any, x: Any) -> Any:
        if not isinstance(x, types.Number):
            return None

        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            function = builder.module.declare_intrinsic(name, [ir.FloatType()])
            return builder.call(function, args)

        return types.float32(types.float32), lower

    build.__doc__ = description
    return intrinsic(build)


sqrt = _unary_float("llvm.sqrt", "The correctly rounded square root of a float32.")
floor = _unary_float("llvm.floor", "The greatest integer not above a float32, as float32.")


@intrinsic  # type: ignore[misc]
def as_int(typingctx: Any, x: Any) -> Any:
    """The bits of a float32 as int32."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.bitcast(args[0], ir.IntType(32))

    return types.int32(types.float32), lower


@intrinsic  # type: ignore[misc]
def as_float(typingctx: Any, i: Any) -> Any:
    """The float32 of the given bits."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.bitcast(args[0], ir.FloatType())

    return types.float32(types.int32), lower
