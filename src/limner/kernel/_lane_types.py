"""How Numba holds eight lanes: LLVM vectors, their operations lowered to vector instructions without fast-math flags.

A number beside lanes is cast to lanes (`lower_cast`), also where the branches of an `if` leave one or the other in a variable.
"""

from __future__ import annotations

import builtins
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_cast, models, register_model

__all__ = [
    "BOOL_LANES", "DOUBLE_LANES", "FLOAT_LANES", "INT_LANES", "LONG_LANES", "add_rows", "all_of", "any_of", "at", "count_set", "double",
    "first_set", "four_bytes", "highest", "int32", "lane", "lanes_of", "load8", "long8", "lowest", "mask_of", "prefetch", "put",
    "register", "single", "splat8", "splat8_int", "spread", "spread_value", "store8", "store_rows", "store_words", "sum8", "to_float",
    "to_int", "vector_call", "where", "with_lane",
]  # fmt: skip

_I1, _I8, _I32, _I64 = (ir.IntType(bits) for bits in (1, 8, 32, 64))
_EIGHT = 8


class _LaneType(types.Type):  # type: ignore[misc]
    """Eight numbers of one kind; `from_` are the kinds of number that become such lanes by themselves."""

    from_: tuple[Any, ...] = ()

    def __init__(self, name: str, element: types.Type, llvm_element: ir.Type) -> None:
        self.element, self.vector = element, ir.VectorType(llvm_element, _EIGHT)
        super().__init__(name=name)

    def can_convert_from(self, typingctx: Any, other: Any) -> Any:
        return Conversion.safe if isinstance(other, self.from_) else None

    def unify(self, typingctx: Any, other: Any) -> Any:
        return self if isinstance(other, self.from_) else None


class _FloatLanes(_LaneType):
    from_ = (types.Float, types.Integer)


class _IntLanes(_LaneType):
    from_ = (types.Integer,)


class _BoolLanes(_LaneType):
    from_ = (types.Boolean,)


FLOAT_LANES = _FloatLanes("f32x8", types.float32, ir.FloatType())
INT_LANES = _IntLanes("i32x8", types.int32, _I32)
DOUBLE_LANES = _FloatLanes("f64x8", types.float64, ir.DoubleType())
LONG_LANES = _IntLanes("i64x8", types.int64, _I64)
BOOL_LANES = _BoolLanes("bool8", types.boolean, _I1)
_NUMBERS = (FLOAT_LANES, DOUBLE_LANES, INT_LANES, LONG_LANES)


@register_model(_FloatLanes)
@register_model(_IntLanes)
@register_model(_BoolLanes)
class _LaneModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, fe_type: _LaneType) -> None:
        super().__init__(manager, fe_type, fe_type.vector)


# --- from one to eight ----------------------------------------------------------------------------------------------------


def spread_value(builder: Any, kind: _LaneType, value: Any) -> Any:
    """Eight times an LLVM value of the lanes' own element."""
    first = builder.insert_element(ir.Constant(kind.vector, ir.Undefined), value, _I32(0))
    return builder.shuffle_vector(first, first, ir.Constant(ir.VectorType(_I32, _EIGHT), [0] * _EIGHT))


def _cast_number(context: Any, builder: Any, fromty: Any, toty: Any, value: Any) -> Any:
    return spread_value(builder, toty, context.cast(builder, value, types.unliteral(fromty), toty.element))


for _lanes in (_FloatLanes, _IntLanes, _BoolLanes):
    for _number in _lanes.from_:
        lower_cast(_number, _lanes)(_cast_number)


def _lanes_for(a: Any, b: Any) -> _LaneType | None:
    """The lanes that an operation on a and b yields: one of them is lanes, the other such lanes too or a number that becomes them."""
    for kind, other in ((a, b), (b, a)):
        if isinstance(kind, (_FloatLanes, _IntLanes)) and (other == kind or isinstance(other, kind.from_)):
            return kind
    return None


def _scalar_for(typingctx: Any, a: Any, b: Any) -> Any:
    a, b = types.unliteral(a), types.unliteral(b)
    return a if a == b else typingctx.unify_pairs(a, b)


# --- operators ------------------------------------------------------------------------------------------------------------

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
    for table, lanes in ((_FLOAT_OPERATORS, _FloatLanes), (_INT_OPERATORS, _IntLanes), (_BOOL_OPERATORS, _BoolLanes)):
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
                fits = all(isinstance(arg, (_BoolLanes, types.Boolean)) for arg in args)
                return signature(BOOL_LANES, BOOL_LANES, BOOL_LANES) if fits else None
            kind = _lanes_for(*args)
            table = _FLOAT_OPERATORS if isinstance(kind, _FloatLanes) else _INT_OPERATORS
            return signature(kind, kind, kind) if kind is not None and op in table else None


def _binary(instruction: str) -> Any:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, instruction)(*args)

    return lower


def _compare(builder: Any, sign: str, kind: _LaneType, a: Any, b: Any) -> Any:
    if isinstance(kind, _IntLanes):
        return builder.icmp_signed(sign, a, b)
    return builder.fcmp_unordered(sign, a, b) if sign == "!=" else builder.fcmp_ordered(sign, a, b)


def _register_comparison(op: Any, sign: str) -> None:
    @infer_global(op)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            kind = _lanes_for(*args) if len(args) == 2 else None
            return signature(BOOL_LANES, kind, kind) if kind is not None else None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _compare(builder, sign, sig.args[0], *args)

    for lanes in (_FloatLanes, _IntLanes):
        lower_builtin(op, lanes, lanes)(lower)


def _register_extreme(function: Any, sign: str) -> None:
    """`max` and `min`, as Python has them: the second where it is greater (less), else the first."""

    @infer_global(function)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            kind = _lanes_for(*args) if len(args) == 2 else None
            return signature(kind, kind, kind) if kind is not None else None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = args
        return builder.select(_compare(builder, sign, sig.args[0], b, a), b, a)

    for lanes in (_FloatLanes, _IntLanes):
        lower_builtin(function, lanes, lanes)(lower)


def _register_unary() -> None:
    def typing_of(function: Any, *kinds: Any) -> None:
        @infer_global(function)
        class _Typing(AbstractTemplate):  # type: ignore[misc]
            def generic(self, args: Any, kws: Any) -> Any:
                return signature(args[0], *args) if len(args) == 1 and args[0] in kinds else None

    typing_of(operator.neg, *_NUMBERS)
    typing_of(builtins.abs, FLOAT_LANES)
    typing_of(operator.invert, BOOL_LANES)

    @lower_builtin(operator.neg, _FloatLanes)
    def negate_floats(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.fneg(args[0])

    @lower_builtin(operator.neg, _IntLanes)
    def negate_ints(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.neg(args[0])

    @lower_builtin(builtins.abs, _FloatLanes)
    def absolute(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return vector_call(builder, "llvm.fabs.v8f32", args)

    @lower_builtin(operator.invert, _BoolLanes)
    def invert(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.not_(args[0])


def vector_call(builder: Any, name: str, args: Any) -> Any:
    """Call an LLVM function of float lanes that yields float lanes."""
    function_type = ir.FunctionType(FLOAT_LANES.vector, [FLOAT_LANES.vector] * len(args))
    return builder.call(cgutils.get_or_insert_function(builder.module, function_type, name), args)


# --- choosing -------------------------------------------------------------------------------------------------------------


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
    kind = _scalar_for(typingctx, a, b)
    if kind is None or not isinstance(condition, (types.Boolean, _BoolLanes)):
        return None
    if isinstance(condition, _BoolLanes):
        kind = _eightfold(kind)
        if kind is None:
            return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _chosen(context, builder, sig.return_type, *args)

    return kind(condition, kind, kind), lower


def _eightfold(kind: Any) -> Any:
    """The lanes of a kind of value."""
    if isinstance(kind, types.Boolean):
        return BOOL_LANES
    if isinstance(kind, types.Float):
        return FLOAT_LANES
    if isinstance(kind, types.Integer):
        return INT_LANES
    return getattr(kind, "eightfold", kind)


@intrinsic  # type: ignore[misc]
def spread(typingctx: Any, value: Any, like: Any) -> Any:
    """A number, as one or eight of it as `like` is."""
    value = types.unliteral(value)
    kind = _eightfold(value) if isinstance(like, _LaneType) else value

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return context.cast(builder, args[0], sig.args[0], sig.return_type)

    return kind(value, like), lower


def _splat(kind: _LaneType, description: str) -> Any:
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

    return (v.element(v, types.int32), lower) if isinstance(v, _LaneType) and isinstance(i, types.Integer) else None


@intrinsic  # type: ignore[misc]
def with_lane(typingctx: Any, v: Any, i: Any, x: Any) -> Any:
    """The lanes with another number in lane i."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.insert_element(args[0], args[2], args[1])

    fits = isinstance(v, _LaneType) and isinstance(i, types.Integer) and isinstance(x, types.Number)
    return (v(v, types.int32, v.element), lower) if fits else None


# --- conditions -----------------------------------------------------------------------------------------------------------


def _condition(of_mask: Callable[[Any, Any], Any], description: str) -> Any:
    def build(typingctx: Any, condition: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return of_mask(builder, builder.bitcast(args[0], _I8)) if condition == BOOL_LANES else args[0]

        return (types.boolean(condition), lower) if isinstance(condition, (types.Boolean, _BoolLanes)) else None

    build.__doc__ = description
    return intrinsic(build)


any_of = _condition(
    lambda builder, mask: builder.icmp_unsigned("!=", mask, _I8(0)), "Whether a condition holds for the one, or for any of eight."
)
all_of = _condition(
    lambda builder, mask: builder.icmp_unsigned("==", mask, _I8(255)), "Whether a condition holds for the one, or for all of eight."
)


@intrinsic  # type: ignore[misc]
def mask_of(typingctx: Any, condition: Any) -> Any:
    """The lanes where a condition holds as an integer: bit k tells of lane k."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.zext(builder.bitcast(args[0], _I8), _I32)

    return (types.int32(condition), lower) if condition == BOOL_LANES else None


@intrinsic  # type: ignore[misc]
def lanes_of(typingctx: Any, mask: Any) -> Any:
    """The condition that holds in the lanes whose bit is set."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.bitcast(builder.trunc(args[0], _I8), BOOL_LANES.vector)

    return (BOOL_LANES(types.int32), lower) if isinstance(mask, types.Integer) else None


def _bit_count(lowering: Any, description: str) -> Any:
    def build(typingctx: Any, mask: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return lowering(builder, args[0])

        return (types.int32(types.int32), lower) if isinstance(mask, types.Integer) else None

    build.__doc__ = description
    return intrinsic(build)


first_set = _bit_count(lambda builder, x: builder.cttz(x, _I1(0)), "The number of the lowest lane of a mask; 32 if it is empty.")
count_set = _bit_count(lambda builder, x: builder.ctpop(x), "How many lanes a mask has.")


# --- numbers --------------------------------------------------------------------------------------------------------------


def _reduction(sign: str, description: str) -> Any:
    def build(typingctx: Any, v: Any) -> Any:
        if isinstance(v, types.Number):
            v = types.unliteral(v)
            return v(v), lambda context, builder, sig, args: args[0]

        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            values, width = args[0], _EIGHT
            while width > 1:
                width //= 2
                low, high = (
                    builder.shuffle_vector(values, values, ir.Constant(ir.VectorType(_I32, width), list(range(at, at + width))))
                    for at in (0, width)
                )
                values = builder.select(_compare(builder, sign, v, low, high), low, high)
            return builder.extract_element(values, _I32(0))

        return (v.element(v), lower) if v in _NUMBERS else None

    build.__doc__ = description
    return intrinsic(build)


lowest = _reduction("<", "The number itself, or the least of eight (of lanes without NaN).")
highest = _reduction(">", "The number itself, or the greatest of eight (of lanes without NaN).")


@intrinsic  # type: ignore[misc]
def sum8(typingctx: Any, v: Any) -> Any:
    """The sum of eight numbers, from the first to the last."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        total = builder.extract_element(args[0], _I32(0))
        for k in range(1, _EIGHT):
            total = (builder.fadd if v == FLOAT_LANES else builder.add)(total, builder.extract_element(args[0], _I32(k)))
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
    floats, ints = (FLOAT_LANES.vector, INT_LANES.vector) if eight else (ir.FloatType(), _I32)

    def constant(value: float) -> Any:
        return ir.Constant(floats, [value] * _EIGHT if eight else value)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        low, high = constant(-(2.0**31)), constant(2.0**31)
        fits = builder.and_(builder.fcmp_ordered(">=", args[0], low), builder.fcmp_ordered("<", args[0], high))
        # fptosi of what does not fit is poison in LLVM: choose a number that fits before the conversion.
        found = builder.fptosi(builder.select(fits, args[0], low), ints)
        return found if eight else builder.sext(found, _I64)

    return (INT_LANES(FLOAT_LANES) if eight else types.int64(types.float32)), lower


# --- memory ---------------------------------------------------------------------------------------------------------------


def _lanes_in(array: Any) -> _LaneType | None:
    if isinstance(array, types.Array) and array.ndim == 1 and array.layout == "C":
        for kind in (FLOAT_LANES, INT_LANES):
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
    kind = _lanes_in(array)
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
    kind = _lanes_in(array)
    if kind is None or v != kind or not array.mutable or not isinstance(offset, types.Integer):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _address(context, builder, sig.args[0], args[0], args[1], kind)).align = 4
        return context.get_dummy_value()

    return types.void(array, types.intp, kind), lower


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
        return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(_I32, _EIGHT), lanes))

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        start = builder.mul(args[1], _I64(4))
        for pair in range(4):
            k, m = 2 * pair, 2 * pair + 1
            # Of two rows: first their a and b, then their c and d, then both side by side.
            ab = shuffled(builder, args[2], args[3], [k, k + 8, 0, 0, m, m + 8, 0, 0])
            cd = shuffled(builder, args[4], args[5], [k, k + 8, 0, 0, m, m + 8, 0, 0])
            rows = shuffled(builder, ab, cd, [0, 1, 8, 9, 4, 5, 12, 13])
            element = builder.gep(data, [builder.add(start, _I64(8 * pair))])
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


def _scatter(context: Any, builder: Any, array_type: Any, array: Any, index: Any, v: Any, condition: Any) -> Any:
    kind = _lanes_in(array_type)
    assert kind is not None
    data = context.make_array(array_type)(context, builder, array).data
    pointers = _addresses(builder, data, index, kind)
    name = f"llvm.masked.scatter.v8{'f' if kind == FLOAT_LANES else 'i'}32.v8p0"
    function_type = ir.FunctionType(ir.VoidType(), [kind.vector, pointers.type, _I32, BOOL_LANES.vector])
    function = cgutils.get_or_insert_function(builder.module, function_type, name)
    builder.call(function, [v, pointers, _I32(4), condition])
    return context.get_dummy_value()


@intrinsic  # type: ignore[misc]
def prefetch(typingctx: Any, array: Any, index: Any) -> Any:
    """Ask for a row of a contiguous array (an element, if it has one dimension), or for eight, to be brought near: it is soon looked at."""
    eight = index == INT_LANES
    if not (isinstance(array, types.Array) and array.ndim <= 2 and array.layout == "C" and (eight or isinstance(index, types.Integer))):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        view = context.make_array(sig.args[0])(context, builder, args[0])
        byte = ir.PointerType(_I8)
        function_type = ir.FunctionType(ir.VoidType(), [byte, _I32, _I32, _I32])
        function = cgutils.get_or_insert_function(builder.module, function_type, "llvm.prefetch.p0")
        n_bytes = context.get_abi_sizeof(context.get_data_type(array.dtype))
        for k in range(_EIGHT if eight else 1):
            row = builder.sext(builder.extract_element(args[1], _I32(k)), _I64) if eight else args[1]
            if array.ndim == 2:
                row = builder.mul(row, cgutils.unpack_tuple(builder, view.shape)[1])
            place = builder.bitcast(builder.gep(view.data, [row]), byte)
            for offset in range(0, n_bytes, 64):
                builder.call(function, [builder.gep(place, [_I64(offset)]), _I32(0), _I32(3), _I32(1)])
        return context.get_dummy_value()

    return types.void(array, INT_LANES if eight else types.int64), lower


@intrinsic  # type: ignore[misc]
def store_words(typingctx: Any, array: Any, start: Any, step: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """Write (a, b, c, d) of lane k to array[start + step k :] for all eight: a part of eight rows of a table of int32."""
    fits = _lanes_in(array) == INT_LANES and array.mutable and isinstance(start, types.Integer) and isinstance(step, types.Integer)
    if not fits or (a, b, c, d) != (INT_LANES,) * 4:
        return None
    four = ir.VectorType(_I32, 4)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data

        def shuffled(x: Any, y: Any, lanes: list[int]) -> Any:
            return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(_I32, len(lanes)), lanes))

        for half in (0, 4):
            pairs = [[half + k, half + k + 8, half + k + 1, half + k + 9] for k in (0, 2)]
            ab, cd = ([shuffled(args[n], args[n + 1], lanes) for lanes in pairs] for n in (3, 5))
            for k in range(4):
                first = 2 * (k % 2)
                row = shuffled(ab[k // 2], cd[k // 2], [first, first + 1, first + 4, first + 5])
                place = builder.add(args[1], builder.mul(args[2], _I64(half + k)))
                builder.store(row, builder.bitcast(builder.gep(data, [place]), ir.PointerType(four))).align = 4
        return context.get_dummy_value()

    return types.void(array, types.int64, types.int64, a, b, c, d), lower


@intrinsic  # type: ignore[misc]
def put(typingctx: Any, array: Any, index: Any, v: Any) -> Any:
    """Write eight lanes to eight places of a contiguous 1D array of their kind; of two in one place the higher lane stays."""
    if _lanes_in(array) != v or index != INT_LANES or not array.mutable:
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _scatter(context, builder, sig.args[0], *args, ir.Constant(BOOL_LANES.vector, [1] * _EIGHT))

    return types.void(array, index, v), lower


def _element(builder: Any, pointer: Any, array: Any) -> Any:
    """Load an array's element; bytes become int32."""
    value = builder.load(pointer)
    return builder.zext(value, _I32) if array.dtype == types.uint8 else value


@intrinsic  # type: ignore[misc]
def at(typingctx: Any, array: Any, index: Any) -> Any:
    """The element of a contiguous array at an index, or the eight at eight.

    `index` is an integer or lanes, or a tuple of them, one for each dimension; it must lie within. Bytes come as integers.
    """
    parts = tuple(index) if isinstance(index, types.BaseTuple) else (index,)
    fits = isinstance(array, types.Array) and array.layout == "C" and array.ndim == len(parts)
    if not fits or not all(isinstance(part, (types.Integer, _IntLanes)) for part in parts):
        return None
    single = types.int32 if array.dtype == types.uint8 else array.dtype
    eight = any(isinstance(part, _IntLanes) for part in parts)
    kind = _eightfold(single) if eight else single
    parts = tuple(types.unliteral(part) for part in parts)
    wanted = types.Tuple(parts) if isinstance(index, types.BaseTuple) else parts[0]

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        view = context.make_array(sig.args[0])(context, builder, args[0])
        shape = cgutils.unpack_tuple(builder, view.shape)
        found = [args[1]] if len(parts) == 1 and not isinstance(index, types.BaseTuple) else cgutils.unpack_tuple(builder, args[1])
        one: Any = _I64(0)
        lanes: Any = None
        for dimension, (part, value) in enumerate(zip(parts, found, strict=True)):
            one = builder.mul(one, shape[dimension])
            if lanes is not None:
                step = spread_value(builder, INT_LANES, builder.trunc(shape[dimension], _I32))
                lanes = builder.mul(lanes, step)
            if isinstance(part, _IntLanes):
                lanes = value if lanes is None else builder.add(lanes, value)
            else:
                one = builder.add(one, context.cast(builder, value, part, types.int64))
        base = builder.gep(view.data, [one], inbounds=False)
        return _element(builder, base, array) if lanes is None else _gather(builder, base, lanes, array, kind)

    return kind(array, wanted), lower


def _addresses(builder: Any, base: Any, lanes: Any, kind: _LaneType) -> Any:
    """The addresses of eight elements."""
    wide = builder.sext(lanes, LONG_LANES.vector)
    # llvmlite builds addresses from single numbers only; LLVM takes lanes in the same place.
    pointers = builder.gep(base, [_I64(0)])
    pointers.indices, pointers.type = [wide], ir.VectorType(ir.PointerType(kind.vector.element), _EIGHT)
    return pointers


def _gather_words(builder: Any, base: Any, lanes: Any, kind: _LaneType) -> Any:
    """Eight 32-bit elements: one instruction where the CPU has one that is worth it."""
    pointers = _addresses(builder, base, lanes, kind)
    name = f"llvm.masked.gather.v8{'f' if kind == FLOAT_LANES else 'i'}32.v8p0"
    function_type = ir.FunctionType(kind.vector, [pointers.type, _I32, BOOL_LANES.vector, kind.vector])
    function = cgutils.get_or_insert_function(builder.module, function_type, name)
    everywhere = ir.Constant(BOOL_LANES.vector, [1] * _EIGHT)
    return builder.call(function, [pointers, _I32(1), everywhere, ir.Constant(kind.vector, ir.Undefined)])


def _gather(builder: Any, base: Any, lanes: Any, array: Any, kind: _LaneType) -> Any:
    if array.dtype in (types.float32, types.int32):
        return _gather_words(builder, base, lanes, kind)
    made = ir.Constant(kind.vector, ir.Undefined)
    for k in range(_EIGHT):
        offset = builder.sext(builder.extract_element(lanes, _I32(k)), _I64)
        made = builder.insert_element(made, _element(builder, builder.gep(base, [offset]), array), _I32(k))
    return made


@intrinsic  # type: ignore[misc]
def four_bytes(typingctx: Any, array: Any, start: Any, index: Any) -> Any:
    """The bytes 4 index .. 4 index + 3 after `start`, as an int32 or eight, the first one lowest."""
    eight = isinstance(index, _IntLanes)
    fits = isinstance(array, types.Array) and array.dtype == types.uint8 and array.layout == "C" and isinstance(start, types.Integer)
    if not fits or not (eight or isinstance(index, types.Integer)):
        return None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        base = builder.bitcast(builder.gep(data, [args[1]]), ir.PointerType(_I32))

        def word(offset: Any) -> Any:
            loaded = builder.load(builder.gep(base, [offset]))
            loaded.align = 1
            return loaded

        if not eight:
            return word(args[2])
        return _gather_words(builder, base, args[2], INT_LANES)

    kind = INT_LANES if eight else types.int32
    return kind(array, types.int64, INT_LANES if eight else types.int64), lower
