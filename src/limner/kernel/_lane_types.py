"""How Numba holds eight lanes: an LLVM vector, its operations lowered to single vector instructions without fast-math flags."""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

__all__ = [
    "count_set", "first_set", "floor8", "lane", "load8", "mask_equal", "mask_greater", "mask_greater_equal", "mask_less",
    "mask_less_equal", "max8", "min8", "reduce_max8", "reduce_min8", "register", "select8", "splat8", "splat8_int", "sqrt8",
    "store8", "to_float8", "to_int8",
]  # fmt: skip

_I32 = ir.IntType(32)
_EIGHT = 8


class _LaneType(types.Type):  # type: ignore[misc]
    def __init__(self, name: str, element: types.Type, llvm_element: ir.Type) -> None:
        self.element, self.vector = element, ir.VectorType(llvm_element, _EIGHT)
        super().__init__(name=name)

    @property
    def is_float(self) -> bool:
        return self.element is types.float32


class _FloatLanes(_LaneType):
    pass


class _IntLanes(_LaneType):
    pass


_FLOATS = _FloatLanes("f32x8", types.float32, ir.FloatType())
_INTS = _IntLanes("i32x8", types.int32, _I32)
_KINDS = (_FLOATS, _INTS)


@register_model(_FloatLanes)
@register_model(_IntLanes)
class _LaneModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, fe_type: _LaneType) -> None:
        super().__init__(manager, fe_type, fe_type.vector)


# --- operators ------------------------------------------------------------------------------------------------------------

_FLOAT_OPERATORS = {operator.add: "fadd", operator.sub: "fsub", operator.mul: "fmul", operator.truediv: "fdiv"}
_INT_OPERATORS = {
    operator.add: "add", operator.sub: "sub", operator.mul: "mul",
    operator.and_: "and_", operator.or_: "or_", operator.xor: "xor",
}  # fmt: skip


def register(float_class: type, int_class: type) -> None:
    """Teach Numba the operators of both lane types; their classes are names in annotations only and cannot be called."""
    for op in {**_FLOAT_OPERATORS, **_INT_OPERATORS}:
        _register_typing(op)
    for table, lanes in ((_FLOAT_OPERATORS, _FloatLanes), (_INT_OPERATORS, _IntLanes)):
        for op, instruction in table.items():
            lower_builtin(op, lanes, lanes)(_binary(instruction))
    _register_negation()


def _register_typing(op: Any) -> None:
    @infer_global(op)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            fits = len(args) == 2 and args[0] == args[1]
            known = (
                (args[0] == _FLOATS and op in _FLOAT_OPERATORS) or (args[0] == _INTS and op in _INT_OPERATORS)
                if fits
                else False
            )
            return signature(args[0], *args) if known else None


def _binary(instruction: str) -> Any:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, instruction)(*args)

    return lower


def _register_negation() -> None:
    @infer_global(operator.neg)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            return signature(args[0], *args) if len(args) == 1 and args[0] in _KINDS else None

    @lower_builtin(operator.neg, _FloatLanes)
    def negate_floats(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.fneg(args[0])

    @lower_builtin(operator.neg, _IntLanes)
    def negate_ints(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.neg(args[0])


# --- memory ---------------------------------------------------------------------------------------------------------------


def _lanes_of(array: Any) -> _LaneType | None:
    if isinstance(array, types.Array) and array.ndim == 1 and array.layout == "C":
        for kind in _KINDS:
            if array.dtype == kind.element:
                return kind
    return None


def _address(context: Any, builder: Any, array_type: Any, array: Any, offset: Any, kind: _LaneType) -> Any:
    data = context.make_array(array_type)(context, builder, array).data
    element = builder.gep(data, [offset], inbounds=True)
    return builder.bitcast(element, ir.PointerType(kind.vector))


@intrinsic  # type: ignore[misc]
def load8(typingctx: Any, array: Any, offset: Any) -> Any:
    """Eight neighbours of a contiguous 1D float32 or int32 array, from `offset` on; it need not be aligned."""
    kind = _lanes_of(array)
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
    kind = _lanes_of(array)
    if kind is None or v != kind or not array.mutable or not isinstance(offset, types.Integer):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _address(context, builder, sig.args[0], args[0], args[1], kind)).align = 4
        return context.get_dummy_value()

    return types.void(array, types.intp, kind), lower


# --- lanes ----------------------------------------------------------------------------------------------------------------


def _splat(kind: _LaneType, description: str) -> Any:
    def build(typingctx: Any, x: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            first = builder.insert_element(ir.Constant(kind.vector, ir.Undefined), args[0], _I32(0))
            return builder.shuffle_vector(first, first, ir.Constant(ir.VectorType(_I32, _EIGHT), [0] * _EIGHT))

        return (kind(kind.element), lower) if isinstance(x, types.Number) else None

    build.__doc__ = description
    return intrinsic(build)


splat8 = _splat(_FLOATS, "Eight times the float x.")
splat8_int = _splat(_INTS, "Eight times the integer x.")


@intrinsic  # type: ignore[misc]
def lane(typingctx: Any, v: Any, i: Any) -> Any:
    """One lane, 0 <= i < 8."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.extract_element(args[0], args[1])

    return (v.element(v, types.int32), lower) if v in _KINDS and isinstance(i, types.Integer) else None


def _compare(builder: Any, op: str, kind: _LaneType, a: Any, b: Any) -> Any:
    return builder.fcmp_ordered(op, a, b) if kind.is_float else builder.icmp_signed(op, a, b)


def _extreme(op: str, description: str) -> Any:
    def build(typingctx: Any, a: Any, b: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.select(_compare(builder, op, a, *args), *args)

        return (a(a, b), lower) if a in _KINDS and a == b else None

    build.__doc__ = description
    return intrinsic(build)


min8 = _extreme("<", "a < b ? a : b, lane by lane.")
max8 = _extreme(">", "a > b ? a : b, lane by lane.")


def _reduction(op: str, description: str) -> Any:
    def build(typingctx: Any, v: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            values, width = args[0], _EIGHT
            while width > 1:
                width //= 2
                halves = [
                    builder.shuffle_vector(values, values, ir.Constant(ir.VectorType(_I32, width), list(range(at, at + width))))
                    for at in (0, width)
                ]
                values = builder.select(_compare(builder, op, v, *halves), *halves)
            return builder.extract_element(values, _I32(0))

        return (v.element(v), lower) if v in _KINDS else None

    build.__doc__ = description
    return intrinsic(build)


reduce_min8 = _reduction("<", "The least lane (of lanes without NaN).")
reduce_max8 = _reduction(">", "The greatest lane (of lanes without NaN).")


def _unary_float(name: str, description: str) -> Any:
    def build(typingctx: Any, a: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            function_type = ir.FunctionType(_FLOATS.vector, [_FLOATS.vector])
            function = cgutils.get_or_insert_function(builder.module, function_type, f"{name}.v8f32")
            return builder.call(function, args)

        return (_FLOATS(_FLOATS), lower) if a == _FLOATS else None

    build.__doc__ = description
    return intrinsic(build)


sqrt8 = _unary_float("llvm.sqrt", "The correctly rounded square roots; NaN below zero.")
floor8 = _unary_float("llvm.floor", "The greatest integers not above, as float32.")


@intrinsic  # type: ignore[misc]
def to_float8(typingctx: Any, a: Any) -> Any:
    """The nearest float32 of each integer."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.sitofp(args[0], _FLOATS.vector)

    return (_FLOATS(_INTS), lower) if a == _INTS else None


@intrinsic  # type: ignore[misc]
def to_int8(typingctx: Any, a: Any) -> Any:
    """The integers towards zero; -2^31 for NaN and for what an int32 cannot hold."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        limit = 2.0**31
        low, high = (ir.Constant(_FLOATS.vector, [x] * _EIGHT) for x in (-limit, limit))
        fits = builder.and_(builder.fcmp_ordered(">=", args[0], low), builder.fcmp_ordered("<", args[0], high))
        # fptosi of what does not fit is poison in LLVM: choose a number that fits before the conversion.
        safe = builder.select(fits, args[0], low)
        return builder.fptosi(safe, _INTS.vector)

    return (_INTS(_FLOATS), lower) if a == _FLOATS else None


# --- masks ----------------------------------------------------------------------------------------------------------------


def _mask(op: str, description: str) -> Any:
    def build(typingctx: Any, a: Any, b: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            bits = builder.bitcast(_compare(builder, op, a, *args), ir.IntType(_EIGHT))
            return builder.zext(bits, _I32)

        return (types.int32(a, b), lower) if a in _KINDS and a == b else None

    build.__doc__ = description
    return intrinsic(build)


mask_less = _mask("<", "The mask of a < b: bit k tells of lane k.")
mask_less_equal = _mask("<=", "The mask of a <= b.")
mask_greater = _mask(">", "The mask of a > b.")
mask_greater_equal = _mask(">=", "The mask of a >= b.")
mask_equal = _mask("==", "The mask of a == b.")


@intrinsic  # type: ignore[misc]
def select8(typingctx: Any, mask: Any, a: Any, b: Any) -> Any:
    """a where the mask's bit is set, b elsewhere."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        bits = builder.bitcast(builder.trunc(args[0], ir.IntType(_EIGHT)), ir.VectorType(ir.IntType(1), _EIGHT))
        return builder.select(bits, args[1], args[2])

    return (a(types.int32, a, b), lower) if isinstance(mask, types.Integer) and a in _KINDS and a == b else None


def _bit_count(lowering: Any, description: str) -> Any:
    def build(typingctx: Any, mask: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return lowering(builder, args[0])

        return (types.int32(types.int32), lower) if isinstance(mask, types.Integer) else None

    build.__doc__ = description
    return intrinsic(build)


first_set = _bit_count(
    lambda builder, x: builder.cttz(x, ir.Constant(ir.IntType(1), 0)),
    "The number of the lowest lane of a mask; 32 if it is empty.",
)
count_set = _bit_count(lambda builder, x: builder.ctpop(x), "How many lanes a mask has.")
