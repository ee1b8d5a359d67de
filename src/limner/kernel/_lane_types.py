"""How Numba holds eight lanes: LLVM vectors. What is done with them stands beside: `_lane_operators`, `_lane_choice`, …

A number beside lanes is cast to lanes (`lower_cast`), also where the branches of an `if` leave one or the other in a variable.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typeconv import Conversion
from numba.extending import lower_cast, models, register_model

__all__ = [
    "BOOL_LANES", "DOUBLE_LANES", "EIGHT", "FLOAT_LANES", "I1", "I8", "I32", "I64", "INT_LANES", "LONG_LANES", "NUMBERS", "BoolLanes",
    "FloatLanes", "IntLanes", "LaneType", "eightfold", "lanes_for", "scalar_for", "spread_value", "vector_call",
]  # fmt: skip

I1, I8, I32, I64 = (ir.IntType(bits) for bits in (1, 8, 32, 64))
EIGHT = 8


class LaneType(types.Type):  # type: ignore[misc]
    """Eight numbers of one kind; `from_` are the kinds of number that become such lanes by themselves."""

    from_: tuple[Any, ...] = ()

    def __init__(self, name: str, element: types.Type, llvm_element: ir.Type) -> None:
        self.element, self.vector = element, ir.VectorType(llvm_element, EIGHT)
        super().__init__(name=name)

    def can_convert_from(self, typingctx: Any, other: Any) -> Any:
        return Conversion.safe if isinstance(other, self.from_) else None

    def unify(self, typingctx: Any, other: Any) -> Any:
        return self if isinstance(other, self.from_) else None


class FloatLanes(LaneType):
    from_ = (types.Float, types.Integer)


class IntLanes(LaneType):
    from_ = (types.Integer,)


class BoolLanes(LaneType):
    from_ = (types.Boolean,)


FLOAT_LANES = FloatLanes("f32x8", types.float32, ir.FloatType())
INT_LANES = IntLanes("i32x8", types.int32, I32)
DOUBLE_LANES = FloatLanes("f64x8", types.float64, ir.DoubleType())
LONG_LANES = IntLanes("i64x8", types.int64, I64)
BOOL_LANES = BoolLanes("bool8", types.boolean, I1)
NUMBERS = (FLOAT_LANES, DOUBLE_LANES, INT_LANES, LONG_LANES)


@register_model(FloatLanes)
@register_model(IntLanes)
@register_model(BoolLanes)
class _LaneModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, fe_type: LaneType) -> None:
        super().__init__(manager, fe_type, fe_type.vector)


# --- from one to eight ----------------------------------------------------------------------------------------------------


def spread_value(builder: Any, kind: LaneType, value: Any) -> Any:
    """Eight times an LLVM value of the lanes' own element."""
    first = builder.insert_element(ir.Constant(kind.vector, ir.Undefined), value, I32(0))
    return builder.shuffle_vector(first, first, ir.Constant(ir.VectorType(I32, EIGHT), [0] * EIGHT))


def _cast_number(context: Any, builder: Any, fromty: Any, toty: Any, value: Any) -> Any:
    return spread_value(builder, toty, context.cast(builder, value, types.unliteral(fromty), toty.element))


for _lanes in (FloatLanes, IntLanes, BoolLanes):
    for _number in _lanes.from_:
        lower_cast(_number, _lanes)(_cast_number)


def lanes_for(a: Any, b: Any) -> LaneType | None:
    """The lanes that an operation on a and b yields: one of them is lanes, the other such lanes too or a number that becomes them."""
    for kind, other in ((a, b), (b, a)):
        if isinstance(kind, (FloatLanes, IntLanes)) and (other == kind or isinstance(other, kind.from_)):
            return kind
    return None


def scalar_for(typingctx: Any, a: Any, b: Any) -> Any:
    a, b = types.unliteral(a), types.unliteral(b)
    return a if a == b else typingctx.unify_pairs(a, b)


def eightfold(kind: Any) -> Any:
    """The lanes of a kind of value."""
    if isinstance(kind, types.Boolean):
        return BOOL_LANES
    if isinstance(kind, types.Float):
        return FLOAT_LANES
    if isinstance(kind, types.Integer):
        return INT_LANES
    return getattr(kind, "eightfold", kind)


def vector_call(builder: Any, name: str, args: Any) -> Any:
    """Call an LLVM function of float lanes that yields float lanes."""
    function_type = ir.FunctionType(FLOAT_LANES.vector, [FLOAT_LANES.vector] * len(args))
    return builder.call(cgutils.get_or_insert_function(builder.module, function_type, name), args)
