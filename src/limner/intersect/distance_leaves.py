"""How far a point is from each kind of solid that fields of distances are made of; where the formulas come from and why they hold is told
where these are described (`limner.scene`, fields of distances), of which this is the twin.

In float64. `i`: where a leaf's numbers begin; what they are, and in which order, `limner.tables.distance` says.
"""

from __future__ import annotations

import math

import numpy as np

from .._jit import kernel
from ..tables.distance_codes import BALL, BLOCK, CONE, CYLINDER, ELLIPSOID, GYROID, OCTAHEDRON, PLANE, RING, SEGMENT, SPONGE
from .double import logarithm, sine_and_cosine

__all__ = ["leaf_distance"]

f64 = np.float64
_NONE, _HALF, _ONE, _TWO, _THREE, _FOUR = f64(0.0), f64(0.5), f64(1.0), f64(2.0), f64(3.0), f64(4.0)
_ROOT_THREE, _LEAST = f64(math.sqrt(3.0)), f64(1e-60)


@kernel
def _norm(x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    return np.sqrt(x * x + y * y + z * z)


@kernel
def _norm2(x: np.float64, y: np.float64) -> np.float64:
    return np.sqrt(x * x + y * y)


@kernel
def _between(x: np.float64, low: np.float64, high: np.float64) -> np.float64:
    return min(max(x, low), high)


@kernel
def _block(x: np.float64, y: np.float64, z: np.float64, half_x: np.float64, half_y: np.float64, half_z: np.float64) -> np.float64:
    x, y, z = abs(x) - half_x, abs(y) - half_y, abs(z) - half_z
    return _norm(max(x, _NONE), max(y, _NONE), max(z, _NONE)) + min(max(x, max(y, z)), _NONE)


@kernel
def _segment(numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    ax, ay, az = f64(numbers[i]), f64(numbers[i + 1]), f64(numbers[i + 2])
    dx, dy, dz = f64(numbers[i + 3]) - ax, f64(numbers[i + 4]) - ay, f64(numbers[i + 5]) - az
    x, y, z = x - ax, y - ay, z - az
    squared = dx * dx + dy * dy + dz * dz
    share = _between((x * dx + y * dy + z * dz) / squared, _NONE, _ONE) if squared > _NONE else _NONE
    return _norm(x - share * dx, y - share * dy, z - share * dz) - f64(numbers[i + 6])


@kernel
def _cylinder(numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    outwards, up = _norm2(x, z) - f64(numbers[i]), abs(y) - f64(numbers[i + 1])
    return _norm2(max(outwards, _NONE), max(up, _NONE)) + min(max(outwards, up), _NONE)


@kernel
def _cone(numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    bottom, top, half = f64(numbers[i]), f64(numbers[i + 1]), f64(numbers[i + 2])
    from_axis = _norm2(x, z)
    # The nearest point of the caps, and the nearest one of the side
    over, up = from_axis - min(from_axis, bottom if y < _NONE else top), abs(y) - half
    narrower, height = top - bottom, _TWO * half
    share = ((top - from_axis) * narrower + (half - y) * height) / (narrower * narrower + height * height)
    share = _between(share, _NONE, _ONE)
    side_x, side_y = from_axis - top + narrower * share, y - half + height * share
    distance = min(_norm2(over, up), _norm2(side_x, side_y))
    return -distance if side_x < _NONE and up < _NONE else distance


@kernel
def _ellipsoid(numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    a, b, c = f64(numbers[i]), f64(numbers[i + 1]), f64(numbers[i + 2])
    return (_norm(x / a, y / b, z / c) - _ONE) * min(a, min(b, c))


@kernel
def _octahedron(radius: np.float64, x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    x, y, z = abs(x), abs(y), abs(z)
    least, greatest = min(x, min(y, z)), max(x, max(y, z))
    middle = max(min(x, y), min(max(x, y), z))
    over = least + middle + greatest - radius
    if _THREE * least < over:
        k = _between(_HALF * (greatest - middle + radius), _NONE, radius)
        return _norm(least, middle - radius + k, greatest - k)
    return over / _ROOT_THREE


@kernel
def _gyroid(numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    turns, half = f64(numbers[i]), f64(numbers[i + 1])
    sx, cx = sine_and_cosine(turns * x)
    sy, cy = sine_and_cosine(turns * y)
    sz, cz = sine_and_cosine(turns * z)
    value = (sx * cy + sy * cz + sz * cx) / (_ROOT_THREE * turns)
    return abs(value) - half if half > _NONE else value


@kernel
def _from_tunnel(x: np.float64) -> np.float64:
    """How far from the middle of its tunnel a coordinate is, in units of half its width; tunnels are 2 apart."""
    return abs(_ONE - _THREE * abs(x - _TWO * np.floor(x * _HALF) - _ONE))


@kernel
def _sponge(numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    half = f64(numbers[i])
    x, y, z = x / half, y / half, z / half
    found, scale = _block(x, y, z, _ONE, _ONE, _ONE), _ONE
    for _ in range(int(numbers[i + 1])):
        a, b, c = _from_tunnel(x * scale), _from_tunnel(y * scale), _from_tunnel(z * scale)
        scale = scale * _THREE
        found = max(found, (max(min(a, b), min(max(a, b), c)) - _ONE) / scale)
    return found * half


@kernel
def _julia(numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    most, radius, room, escaped = int(numbers[i + 4]), f64(numbers[i + 5]), f64(numbers[i + 6]), f64(numbers[i + 8])
    from_middle = _norm(x, y, z)
    near = room / from_middle if from_middle > room else _ONE
    a, b, c, d = x * near, y * near, z * near, _NONE
    squared, slope, level, n = a * a + b * b + c * c, _ONE, _ONE, 0
    while n < most and squared <= escaped:
        slope = slope * (_FOUR * squared)
        real = a * a - b * b - c * c - d * d
        b, c, d = _TWO * a * b + numbers[i + 1], _TWO * a * c + numbers[i + 2], _TWO * a * d + numbers[i + 3]
        a = real + numbers[i]
        squared = a * a + b * b + c * c + d * d
        n += 1
    for _ in range(most - n):
        level = level * _HALF
    squared = max(squared, _LEAST)
    value = _HALF * np.sqrt(squared / max(slope, _LEAST)) * (_HALF * logarithm(squared) - level * (_HALF * logarithm(escaped)))
    return max(max(value, -f64(numbers[i + 7])), from_middle - radius)


@kernel
def leaf_distance(code: int, numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> np.float64:
    """The distance of a point from a leaf's surface, negative inside."""
    if code == BALL:
        return _norm(x, y, z) - f64(numbers[i])
    if code == BLOCK:
        return _block(x, y, z, f64(numbers[i]), f64(numbers[i + 1]), f64(numbers[i + 2])) - f64(numbers[i + 3])
    if code == RING:
        return _norm2(_norm2(x, z) - f64(numbers[i]), y) - f64(numbers[i + 1])
    if code == SEGMENT:
        return _segment(numbers, i, x, y, z)
    if code == CYLINDER:
        return _cylinder(numbers, i, x, y, z)
    if code == CONE:
        return _cone(numbers, i, x, y, z)
    if code == PLANE:
        return y
    if code == ELLIPSOID:
        return _ellipsoid(numbers, i, x, y, z)
    if code == OCTAHEDRON:
        return _octahedron(f64(numbers[i]), x, y, z)
    if code == GYROID:
        return _gyroid(numbers, i, x, y, z)
    if code == SPONGE:
        return _sponge(numbers, i, x, y, z)
    return _julia(numbers, i, x, y, z)
