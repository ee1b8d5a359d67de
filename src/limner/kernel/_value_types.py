"""How Numba holds a value type of float32 fields: a struct, its operators lowered straight to LLVM without fast-math flags.

Each has a form of eight: the same fields as lanes. Where one of it meets eight, it becomes eight.
"""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin, lower_cast, make_attribute_wrapper, models, register_model

from ._lane_types import FLOAT_LANES

__all__ = ["register"]

F32 = types.float32
_BINARY: dict[Any, str] = {operator.add: "fadd", operator.sub: "fsub", operator.mul: "fmul", operator.truediv: "fdiv"}


def register(cls: type, fields: tuple[str, ...], *, componentwise: bool) -> types.Type:
    """Teach Numba `cls`: float32 `fields`, + - and negation, * and / by a scalar, and * by itself if `componentwise`."""
    count = len(fields)

    class ValueType(types.Type):  # type: ignore[misc]
        llvm_fields = count
        element = F32

    class EightType(types.Type):  # type: ignore[misc]
        llvm_fields = count
        element = FLOAT_LANES

        def can_convert_from(self, typingctx: Any, other: Any) -> Any:
            return Conversion.safe if other == one else None

        def unify(self, typingctx: Any, other: Any) -> Any:
            return self if other == one else None

    one, eight = ValueType(name=cls.__name__), EightType(name=f"{cls.__name__}x8")
    one.eightfold = eight.eightfold = eight

    for kind_class, element in ((ValueType, F32), (EightType, FLOAT_LANES)):
        _register_model(kind_class, fields, element)
    _register_constructor(cls, one, eight, count)

    @lower_cast(ValueType, EightType)
    def cast(context: Any, builder: Any, fromty: Any, toty: Any, value: Any) -> Any:
        parts = [context.cast(builder, part, F32, FLOAT_LANES) for part in _fields_of(builder, value, count)]
        return _packed(builder, parts, context.get_value_type(toty))

    for op, instruction in _BINARY.items():
        scalar = op in (operator.mul, operator.truediv)
        _register_typing(op, one, eight, scalar=scalar, same=not scalar or (componentwise and op is operator.mul))
        for kind_class, element in ((ValueType, types.Float), (EightType, type(FLOAT_LANES))):
            if scalar:
                lower_builtin(op, kind_class, element)(_scalar_lowering(instruction, count))
            lower_builtin(op, kind_class, kind_class)(_value_lowering(instruction, count))
    _register_negation((one, eight), (ValueType, EightType), count)
    return one


def _register_model(kind_class: type, fields: tuple[str, ...], element: types.Type) -> None:
    @register_model(kind_class)
    class _Model(models.StructModel):  # type: ignore[misc]
        def __init__(self, manager: Any, fe_type: Any) -> None:
            super().__init__(manager, fe_type, [(field, element) for field in fields])

    for field in fields:
        make_attribute_wrapper(kind_class, field, field)


def _register_constructor(cls: type, one: types.Type, eight: types.Type, count: int) -> None:
    @infer_global(cls)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            if len(args) != count or not all(isinstance(part, types.Number) or part == FLOAT_LANES for part in args):
                return None
            value = eight if FLOAT_LANES in args else one
            return signature(value, *[value.element] * count)

    def construct(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _packed(builder, args, context.get_value_type(sig.return_type))

    lower_builtin(cls, *[types.Number] * count)(construct)
    lower_builtin(cls, *[type(FLOAT_LANES)] * count)(construct)


def _register_typing(op: Any, one: types.Type, eight: types.Type, *, scalar: bool, same: bool) -> None:
    @infer_global(op)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            if len(args) != 2 or args[0] not in (one, eight):
                return None
            a, b = args
            if b in (one, eight):
                value = eight if eight in (a, b) else one
                return signature(value, value, value) if same else None
            if not scalar or not (isinstance(b, (types.Float, types.Integer)) or b == FLOAT_LANES):
                return None
            value = eight if a == eight or b == FLOAT_LANES else one
            return signature(value, value, value.element)


def _fields_of(builder: Any, struct: Any, count: int) -> list[Any]:
    return [builder.extract_value(struct, k) for k in range(count)]


def _packed(builder: Any, parts: Any, llvm_type: Any) -> Any:
    made = ir.Constant(llvm_type, ir.Undefined)
    for k, part in enumerate(parts):
        made = builder.insert_value(made, part, k)
    return made


def _value_lowering(instruction: str, count: int) -> Any:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (_fields_of(builder, arg, count) for arg in args)
        return _packed(builder, [getattr(builder, instruction)(x, y) for x, y in zip(a, b, strict=True)], args[0].type)

    return lower


def _scalar_lowering(instruction: str, count: int) -> Any:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        parts = _fields_of(builder, args[0], count)
        return _packed(builder, [getattr(builder, instruction)(x, args[1]) for x in parts], args[0].type)

    return lower


def _register_negation(kinds: tuple[types.Type, ...], kind_classes: tuple[type, ...], count: int) -> None:
    @infer_global(operator.neg)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            return signature(args[0], args[0]) if len(args) == 1 and args[0] in kinds else None

    def negate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _packed(builder, [builder.fneg(x) for x in _fields_of(builder, args[0], count)], args[0].type)

    for kind_class in kind_classes:
        lower_builtin(operator.neg, kind_class)(negate)
