"""How Numba holds a value type of float32 fields: a struct, its operators lowered straight to LLVM without fast-math flags."""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin, make_attribute_wrapper, models, register_model

__all__ = ["register"]

F32 = types.float32
_BINARY: dict[Any, str] = {operator.add: "fadd", operator.sub: "fsub", operator.mul: "fmul", operator.truediv: "fdiv"}


def register(cls: type, fields: tuple[str, ...], *, componentwise: bool) -> types.Type:
    """Teach Numba `cls`: float32 `fields`, + - and negation, * and / by a scalar, and * by itself if `componentwise`."""

    class ValueType(types.Type):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(name=cls.__name__)

    value = ValueType()

    @register_model(ValueType)
    class _Model(models.StructModel):  # type: ignore[misc]
        def __init__(self, manager: Any, fe_type: Any) -> None:
            super().__init__(manager, fe_type, [(field, F32) for field in fields])

    for field in fields:
        make_attribute_wrapper(ValueType, field, field)

    _register_constructor(cls, value, len(fields))
    for op in _BINARY:
        scalar = op in (operator.mul, operator.truediv)
        _register_typing(op, value, scalar=scalar, same=not scalar or (componentwise and op is operator.mul))
        if scalar:
            for number in (types.Float, types.Integer):
                lower_builtin(op, ValueType, number)(_scalar_lowering(_BINARY[op], fields))
        lower_builtin(op, ValueType, ValueType)(_value_lowering(_BINARY[op], fields))
    _register_negation(value, ValueType, fields)
    return value


def _register_constructor(cls: type, value: types.Type, count: int) -> None:
    @infer_global(cls)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            fits = len(args) == count and all(isinstance(part, types.Number) for part in args)
            return signature(value, *args) if fits else None

    @lower_builtin(cls, *[types.Number] * count)
    def construct(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        parts = [context.cast(builder, part, kind, F32) for part, kind in zip(args, sig.args, strict=True)]
        return _packed(builder, parts, context.get_value_type(value))


def _register_typing(op: Any, value: types.Type, *, scalar: bool, same: bool) -> None:
    @infer_global(op)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            if len(args) != 2 or args[0] != value:
                return None
            if (same and args[1] == value) or (scalar and isinstance(args[1], (types.Float, types.Integer))):
                return signature(value, *args)
            return None


def _fields_of(builder: Any, struct: Any, count: int) -> list[Any]:
    return [builder.extract_value(struct, k) for k in range(count)]


def _packed(builder: Any, parts: list[Any], llvm_type: Any) -> Any:
    made = ir.Constant(llvm_type, ir.Undefined)
    for k, part in enumerate(parts):
        made = builder.insert_value(made, part, k)
    return made


def _value_lowering(instruction: str, fields: tuple[str, ...]) -> Any:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (_fields_of(builder, arg, len(fields)) for arg in args)
        return _packed(builder, [getattr(builder, instruction)(x, y) for x, y in zip(a, b, strict=True)], args[0].type)

    return lower


def _scalar_lowering(instruction: str, fields: tuple[str, ...]) -> Any:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        s = context.cast(builder, args[1], sig.args[1], F32)
        parts = _fields_of(builder, args[0], len(fields))
        return _packed(builder, [getattr(builder, instruction)(x, s) for x in parts], args[0].type)

    return lower


def _register_negation(value: types.Type, value_class: type, fields: tuple[str, ...]) -> None:
    @infer_global(operator.neg)
    class _Typing(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            return signature(value, value) if len(args) == 1 and args[0] == value else None

    @lower_builtin(operator.neg, value_class)
    def negate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _packed(builder, [builder.fneg(x) for x in _fields_of(builder, args[0], len(fields))], args[0].type)
