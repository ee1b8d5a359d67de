"""Vec3 and Color: three float32, with operators, so that kernels read like the book.

    h = normalize(v + l)
    radiance = kd * E * (max(ZERO, dot(n, l)) * INV_PI)

Their components are numbers or lanes (`lanes`): one vector or eight, by the same formulas. A scalar operand is cast to float32, so nothing
silently becomes float64. `Vec3 * Vec3` is an error, `Color * Color` is
componentwise. The classes below are what runs uncompiled; compiled, the same names are a Numba value type of three floats
(`_value_types`), and every operation rounds alike, so both give the same bits.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .._jit import MODE, kernel
from .elementary import sqrt
from .lanes import _Lanes, max, spread, where

__all__ = [
    "BLACK_LIMIT", "ONE", "ZERO", "Color", "Vec3", "cross", "dot", "length", "lerp", "luminance", "max_component", "normalize",
    "reflect",
    "spread3",
]  # fmt: skip

f32 = np.float32
ZERO = f32(0.0)
ONE = f32(1.0)
TWO = f32(2.0)
BLACK_LIMIT = f32(1e-9)


def _component(x: Any) -> Any:
    return x if isinstance(x, _Lanes) else f32(x)


class Vec3:
    """A point, a direction or a normal: three float32."""

    __slots__ = ("x", "y", "z")
    fields = __slots__

    def __init__(self, x: Any, y: Any, z: Any) -> None:
        self.x = _component(x)
        self.y = _component(y)
        self.z = _component(z)

    def __add__(self, o: Vec3) -> Vec3:
        return Vec3(self.x + o.x, self.y + o.y, self.z + o.z)

    def __sub__(self, o: Vec3) -> Vec3:
        return Vec3(self.x - o.x, self.y - o.y, self.z - o.z)

    def __mul__(self, s: Any) -> Vec3:
        s = _component(s)
        return Vec3(self.x * s, self.y * s, self.z * s)

    def __truediv__(self, s: Any) -> Vec3:
        s = _component(s)
        return Vec3(self.x / s, self.y / s, self.z / s)

    def __neg__(self) -> Vec3:
        return Vec3(-self.x, -self.y, -self.z)

    def __repr__(self) -> str:
        return f"Vec3({self.x}, {self.y}, {self.z})"


class Color:
    """Linear light in three channels (Rec. 709): three float32."""

    __slots__ = ("b", "g", "r")
    fields = ("r", "g", "b")

    def __init__(self, r: Any, g: Any, b: Any) -> None:
        self.r = _component(r)
        self.g = _component(g)
        self.b = _component(b)

    def __add__(self, o: Color) -> Color:
        return Color(self.r + o.r, self.g + o.g, self.b + o.b)

    def __sub__(self, o: Color) -> Color:
        return Color(self.r - o.r, self.g - o.g, self.b - o.b)

    def __mul__(self, o: Any) -> Color:
        if isinstance(o, Color):
            return Color(self.r * o.r, self.g * o.g, self.b * o.b)
        o = _component(o)
        return Color(self.r * o, self.g * o, self.b * o)

    def __truediv__(self, s: Any) -> Color:
        s = _component(s)
        return Color(self.r / s, self.g / s, self.b / s)

    def __neg__(self) -> Color:
        return Color(-self.r, -self.g, -self.b)

    def __repr__(self) -> str:
        return f"Color({self.r}, {self.g}, {self.b})"


if MODE == "compiled":
    from ._value_types import register

    register(Vec3, ("x", "y", "z"), componentwise=False)
    register(Color, ("r", "g", "b"), componentwise=True)


@kernel
def dot(a: Vec3, b: Vec3) -> np.float32:
    """a . b"""
    return a.x * b.x + a.y * b.y + a.z * b.z


@kernel
def cross(a: Vec3, b: Vec3) -> Vec3:
    """a x b"""
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@kernel
def spread3(v: Vec3, like: np.float32) -> Vec3:
    """A vector, as one or eight of it as the number `like` is."""
    return Vec3(spread(v.x, like), spread(v.y, like), spread(v.z, like))


@kernel
def length(v: Vec3) -> np.float32:
    """|v|"""
    return sqrt(dot(v, v))


@kernel
def normalize(v: Vec3) -> Vec3:
    """v / |v|; the zero vector stays zero."""
    squared = dot(v, v)
    return v * (ONE / where(squared > ZERO, sqrt(squared), ONE))


@kernel
def reflect(d: Vec3, n: Vec3) -> Vec3:
    """r = d - 2 (d . n) n (FoCG 4.8)."""
    return d - n * (TWO * dot(d, n))


@kernel
def lerp(a: np.float32, b: np.float32, t: np.float32) -> np.float32:
    """(1 - t) a + t b"""
    return (ONE - t) * a + t * b


@kernel
def luminance(c: Color) -> np.float32:
    """Y of linear Rec. 709 (ITU-R BT.709, 3.2)."""
    return f32(0.2126) * c.r + f32(0.7152) * c.g + f32(0.0722) * c.b


@kernel
def max_component(c: Color) -> np.float32:
    """The greatest channel."""
    return max(c.r, max(c.g, c.b))
