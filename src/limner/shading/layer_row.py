"""Whether a door knows layers, as something that the compiler knows.

Most pictures have no material with a coat, a film or an inside, and should neither wait for these to be compiled nor carry them about. So a
door takes the material rows either as `MATERIAL` or as `LAYERED_MATERIAL`, the same bytes under another name, and `layer_row` is None for
the first: what is done `if row is not None` is not compiled there.
"""

from __future__ import annotations

from typing import Any

from .._jit import MODE

__all__ = ["if_layered", "layer_row"]

_MARK = "has_layers"


def layer_row(material: Any) -> Any:
    """The row itself, in a door that knows layers; else None."""
    return material if _MARK in material.dtype.names else None


def if_layered(row: Any, value: Any) -> Any:
    """A value, in a door that knows layers; else None."""
    return None if row is None else value


if MODE == "compiled":
    from numba.core import types
    from numba.extending import lower_builtin, type_callable

    @type_callable(layer_row)
    def _type_of_row(context: Any) -> Any:
        return lambda material: material if _MARK in material.fields else types.none

    @lower_builtin(layer_row, types.Record)
    def _lowered_row(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return context.get_dummy_value() if signature.return_type == types.none else arguments[0]

    @type_callable(if_layered)
    def _type_of_value(context: Any) -> Any:
        return lambda row, value: types.none if row == types.none else value

    @lower_builtin(if_layered, types.Any, types.Any)
    def _lowered_value(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return context.get_dummy_value() if signature.return_type == types.none else arguments[1]
