"""Which part of an exact shape's surface a ray meets, and whether that is turned inside out, in one number.

It is negative, so that a hit's `triangle` can hold either: the number of a triangle, or this. Inside out is the surface that something
leaves where it is cut away (`intersect.csg`).
"""

from __future__ import annotations

from .._jit import kernel

__all__ = ["is_turned", "part_of", "surface_code"]

_PARTS = 16


@kernel
def surface_code(part: int, turned: int) -> int:
    """-1 - part; of a surface that is turned inside out, 16 less."""
    return -1 - part - _PARTS * turned


@kernel
def part_of(code: int) -> int:
    """The part that a surface code tells of."""
    return -1 - code if code >= -_PARTS else -1 - code - _PARTS


@kernel
def is_turned(code: int) -> bool:
    """Whether a surface code tells of a surface that is turned inside out."""
    return code < -_PARTS
