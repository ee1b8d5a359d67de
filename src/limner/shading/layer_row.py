"""Whether a door knows layers, as something that the compiler knows.

Most pictures have no material with a coat, a film or an inside, and should neither wait for these to be compiled nor carry them about. So a
door takes the material rows either as `MATERIAL` or as `LAYERED_MATERIAL`, the same bytes under another name, and `layer_row` is None for
the first: what is done `if row is not None` is not compiled there.
"""

from __future__ import annotations

from typing import Any

from .._jit import MODE

__all__ = ["layer_row"]

_MARK = "has_layers"


def layer_row(material: Any) -> Any:
    """The row itself, in a door that knows layers; else None."""
    return material if _MARK in material.dtype.names else None


if MODE == "compiled":
    from numba.extending import overload

    def _layer_row(material: Any) -> Any:
        """Stands for the Python function in kernels."""

    def _found(material: Any) -> Any:
        if _MARK in material.fields:
            return lambda material: material
        return lambda material: None

    overload(layer_row, inline="always", jit_options={"_nrt": False})(_found)
