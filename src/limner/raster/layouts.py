"""What the stages of the pipeline hand to each other."""

from __future__ import annotations

import numpy as np

__all__ = [
    "BACK_SIDE", "BOTH_SIDES", "CUT", "FLOAT_ROWS", "FRONT_SIDE", "GUARD_BAND", "HIGH_WORD", "INSTANCE_WORD", "INT_ROWS", "LOW_WORD",
    "MATERIAL_WORD", "MAX_CLIPPED", "PER_FRAGMENT", "PER_TRIANGLE", "PER_VERTEX", "SCREEN_TRIANGLE", "SUBPIXELS", "TRIANGLE_WORD",
    "UNSNAPPED", "WORDS",
]  # fmt: skip

f32, i32 = np.float32, np.int32

# Where the shading is computed
PER_FRAGMENT, PER_VERTEX, PER_TRIANGLE = 0, 1, 2

# Which sides of a triangle are drawn
FRONT_SIDE, BACK_SIDE, BOTH_SIDES = 0, 1, 2

SUBPIXELS = 256
"""Screen vertices lie on a grid of 1/256 pixel, where edge functions are exact integers."""

FLOAT_ROWS, INT_ROWS = 15, 11
"""Rows of scratch memory that a tile needs."""

GUARD_BAND = f32(1 << 19)
"""Pixels from the origin beyond which triangles are clipped, so that edge functions fit 64 bits with room to spare."""

UNSNAPPED = np.int32(-(2**31))
"""The x of a vertex that clipping has to deal with."""

MAX_CLIPPED = 12
"""Vertices that a triangle can have after clipping against five planes, and some."""

SCREEN_TRIANGLE = np.dtype(
    [
        ("x", i32, 3),  # vertices on the subpixel grid, counter-clockwise
        ("y", i32, 3),
        ("low", i32, 2),  # the box around it, (x, y) on the subpixel grid
        ("high", i32, 2),
        ("z", f32),  # depth-buffer value at the reference pixel
        ("dzdx", f32),
        ("dzdy", f32),
        ("x_reference", i32),
        ("y_reference", i32),
        ("instance", i32),
        ("triangle", i32),  # of the instance's mesh
        ("material", i32),
        ("alpha_mode", i32),
        ("first_cut", i32),  # row of the cuts that bound the part of it that is meant
        ("n_cuts", i32),
        ("unused", i32, 3),  # a row takes a whole number of registers
    ],
    align=True,
)

def _word(field: str) -> int:
    offset: int = SCREEN_TRIANGLE.fields[field][1]  # type: ignore[index]
    return offset // 4


WORDS = SCREEN_TRIANGLE.itemsize // 4
"""Of a screen triangle, if it is taken as a row of int32 (`assemble._emit_eight` writes them one by one)."""

INSTANCE_WORD, MATERIAL_WORD, TRIANGLE_WORD = _word("instance"), _word("material"), _word("triangle")
LOW_WORD, HIGH_WORD = _word("low"), _word("high")
"""Where a screen triangle has these, if it is taken as a row of int32."""

CUT = np.dtype(
    [
        ("value", np.float64),  # at the reference pixel of the screen triangle
        ("slope_x", np.float64),  # per pixel
        ("slope_y", np.float64),
        ("side", np.int64),  # 1: what is not negative is kept, -1: what is
    ],
    align=True,
)
"""A line through a screen triangle. Of two parts with the same cut and opposite sides, each sample belongs to exactly one."""
