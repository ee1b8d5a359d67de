"""What `+`, `<`, `max`, … do with lanes: LLVM's vector instructions, without fast-math flags."""

from __future__ import annotations

import builtins
import operator
from typing import Any

from numba.core import types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin

from ._lane_types import BOOL_LANES, FLOAT_LANES, NUMBERS, BoolLanes, FloatLanes, IntLanes, LaneType, lanes_for, vector_call

__all__ = ["compare", "register"]

_FLOAT_OPERATORS = {operator.add: "fadd", operator.sub: "fsub", operator.mul: "fmul", operator.truediv: "fdiv"}
_INT_OPERATORS = {
    operator.add: "add", operator.sub: "sub", operator.mul: "mul", operator.and_: "and_", operator.or_: "or_", operator.xor: "xor",
    operator.lshift: "shl", operator.rshift: "ashr",
}  # fmt: skip
_BOOL_OPERATORS = {operator.and_: "and_", operator.or_: "or_", operator.xor: "xor"}
_COMPARISONS = {operator.lt: "<", operator.le: "<=", operator.gt: ">", operator.ge: ">=", operator.eq: "==", operator.ne: "!="}


def register() -> None:
    """Teach Numba the operators of the lane types; their classes are names in annotations only and cannot be called."""
    for op in {**_FLOAT_OPERATORS, **_INT_OPERATORS}:
        _register_typing(op)
    for table, lanes in ((_FLOAT_OPERATORS, FloatLanes), (_INT_OPERATORS, IntLanes), (_BOOL_OPERATORS, BoolLanes)):
        for op, instruction in table.items():
            lower_builtin(op, lanes, lanes)(_binary(instruction))
    for op, sign in _COMPARISONS.items():
        _register_comparison(op, sign)
    for function, sign in ((builtins.max, ">"), (builtins.min, "<")):
        _register_extreme(function, sign)
    _register_unary()


def _register_typing(op: Any) -> None:
    @infer_global(op)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            if len(args) != 2:
                return None
            if BOOL_LANES in args and op in _BOOL_OPERATORS:
                fits = all(isinstance(arg, (BoolLanes, types.Boolean)) for arg in args)
                return signature(BOOL_LANES, BOOL_LANES, BOOL_LANES) if fits else None
            kind = lanes_for(*args)
            table = _FLOAT_OPERATORS if isinstance(kind, FloatLanes) else _INT_OPERATORS
            return signature(kind, kind, kind) if kind is not None and op in table else None


def _binary(instruction: str) -> Any:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, instruction)(*args)

    return lower


def compare(builder: Any, sign: str, kind: LaneType, a: Any, b: Any) -> Any:
    """LLVM's comparison of lanes of one kind; with NaN, only what is unequal holds."""
    if isinstance(kind, IntLanes):
        return builder.icmp_signed(sign, a, b)
    return builder.fcmp_unordered(sign, a, b) if sign == "!=" else builder.fcmp_ordered(sign, a, b)


def _register_comparison(op: Any, sign: str) -> None:
    @infer_global(op)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            kind = lanes_for(*args) if len(args) == 2 else None
            return signature(BOOL_LANES, kind, kind) if kind is not None else None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return compare(builder, sign, sig.args[0], *args)

    for lanes in (FloatLanes, IntLanes):
        lower_builtin(op, lanes, lanes)(lower)


def _register_extreme(function: Any, sign: str) -> None:
    """`max` and `min`, as Python has them: the second where it is greater (less), else the first."""

    @infer_global(function)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            kind = lanes_for(*args) if len(args) == 2 else None
            return signature(kind, kind, kind) if kind is not None else None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = args
        return builder.select(compare(builder, sign, sig.args[0], b, a), b, a)

    for lanes in (FloatLanes, IntLanes):
        lower_builtin(function, lanes, lanes)(lower)


def _register_unary() -> None:
    def typing_of(function: Any, *kinds: Any) -> None:
        @infer_global(function)
        class _Typing(AbstractTemplate):  # type: ignore[misc]
            def generic(self, args: Any, kws: Any) -> Any:
                return signature(args[0], *args) if len(args) == 1 and args[0] in kinds else None

    typing_of(operator.neg, *NUMBERS)
    typing_of(builtins.abs, FLOAT_LANES)
    typing_of(operator.invert, BOOL_LANES)

    @lower_builtin(operator.neg, FloatLanes)
    def negate_floats(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.fneg(args[0])

    @lower_builtin(operator.neg, IntLanes)
    def negate_ints(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.neg(args[0])

    @lower_builtin(builtins.abs, FloatLanes)
    def absolute(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return vector_call(builder, "llvm.fabs.v8f32", args)

    @lower_builtin(operator.invert, BoolLanes)
    def invert(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.not_(args[0])
