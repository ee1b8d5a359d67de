"""Whether a door knows matte surfaces alone, as something that the compiler knows.

Many scenes are made of opaque matte surfaces without textures, in clear air. What a path there never asks for (glass, layers, coverage,
footprints) need not be compiled into its loop, where it would stand in the way of what is asked at every surface. So a door takes the
material rows as `MATTE_MATERIAL`, the same bytes under another name, and `only_matte` is a constant in it.
"""

from __future__ import annotations

from typing import Any

from .._jit import MODE

__all__ = ["only_matte"]

_MARK = "only_matte"


def only_matte(materials: Any) -> bool:
    """Whether all materials are opaque, matte and without texture, in a scene of clear air that stands still: of a table or a row."""
    return _MARK in materials.dtype.names


if MODE == "compiled":
    from numba.core import cgutils, types
    from numba.extending import lower_builtin, type_callable

    @type_callable(only_matte)
    def _type_of_answer(context: Any) -> Any:
        return lambda materials: types.boolean

    @lower_builtin(only_matte, types.Any)
    def _lowered_answer(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        (materials,) = signature.args
        record = materials.dtype if isinstance(materials, types.Array) else materials
        return cgutils.true_bit if _MARK in record.fields else cgutils.false_bit
