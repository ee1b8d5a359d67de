"""Running the program of a field of distances: how far is this point from the surface, at least?

The instructions are those of `limner.tables.distance_codes`. They work on two stacks that share the rows of one scratch array:

    column   0 1 2             3           4                           5
             points kept       distances   least of the copies so far  number of the copy that is being asked

A description is nested less deeply than the array has rows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..tables.distance_codes import (
    COMMON,
    FIRST_JOINING,
    FIRST_MOVING,
    FOLD,
    GROW,
    JOIN,
    LEAVE,
    PLACE,
    REPEAT,
    STRETCH,
    TILE,
    WALLS,
)
from .distance_leaves import leaf_distance
from .double import sine_and_cosine

__all__ = ["field_value"]

f64 = np.float64
_NONE, _HALF, _ONE, _TWO, _FOUR = f64(0.0), f64(0.5), f64(1.0), f64(2.0), f64(4.0)
_FAR = f64(np.inf)
_DISTANCE, _LEAST, _COPY = 3, 4, 5  # columns
_REPEAT_NUMBERS = 18
_COPIES = 8  # two along each axis


class _Place(NamedTuple):
    """A coordinate, or a point; `gap`: how far at least a copy is that stands there."""

    x: np.float64
    y: np.float64
    z: np.float64
    gap: np.float64


@kernel
def _smooth_minimum(a: np.float64, b: np.float64, radius: np.float64) -> np.float64:
    """``min(a, b) - h^2 k / 4``, ``h = max(k - |a - b|, 0) / k``. **Source**: Quilez, *Smooth minimum*."""
    if radius <= _NONE:
        return min(a, b)
    h = max(radius - abs(a - b), _NONE) / radius
    return min(a, b) - h * h * (radius / _FOUR)


@kernel
def _joined(code: int, a: np.float64, b: np.float64, radius: np.float64) -> np.float64:
    if code == JOIN:
        return _smooth_minimum(a, b, radius)
    return -_smooth_minimum(-a, -b if code == COMMON else b, radius)


@kernel
def _turned(numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> _Place:
    radius, from_axis = f64(numbers[i + 1]), np.sqrt(x * x + z * z)
    share = radius / from_axis if from_axis > radius else _ONE
    s, c = sine_and_cosine(f64(numbers[i]) * y)
    s, c = s * share, c * share
    return _Place(c * x - s * z, y, s * x + c * z, _NONE)


@kernel
def _cell(numbers, i: int, from_start: np.float64) -> np.float64:
    """The number of the copy next to a coordinate; spacing, first and last stand at i, i + 3 and i + 6."""
    spacing = f64(numbers[i])
    step = spacing if spacing > _NONE else _ONE
    return min(max(np.floor(from_start / step + _HALF), f64(numbers[i + 3])), f64(numbers[i + 6]))


@kernel
def _tiled(numbers, i: int, p: np.float64) -> np.float64:
    from_start = p - f64(numbers[i + 9])
    cell = _cell(numbers, i, from_start)
    local = from_start - cell * numbers[i]
    return -local if cell - _TWO * np.floor(cell * _HALF) == _ONE else local


@kernel
def _copied(numbers, i: int, p: np.float64, second: bool) -> _Place:
    """A coordinate as the nearest copy sees it, or the second nearest, and the gap; a copy that is not there is infinitely far."""
    spacing, middle = f64(numbers[i]), f64(numbers[i + 12])
    from_start = p - (middle + f64(numbers[i + 9]))
    cell = _cell(numbers, i, from_start)
    local = from_start - cell * spacing
    if not second:
        return _Place(local + middle, _NONE, _NONE, -_FAR)
    other = min(max(cell + (-_ONE if local < _NONE else _ONE), f64(numbers[i + 3])), f64(numbers[i + 6]))
    if other == cell:
        return _Place(local, _NONE, _NONE, _FAR)
    return _Place(local - (other - cell) * spacing + middle, _NONE, _NONE, spacing - abs(local) - f64(numbers[i + 15]))


@outlined
def _copy(numbers, i: int, copy: int, x: np.float64, y: np.float64, z: np.float64) -> _Place:
    """A point as one of eight copies sees it: bit by bit, the nearest or the second along each axis."""
    a, b, c = _copied(numbers, i, x, copy & 1 != 0), _copied(numbers, i + 1, y, copy & 2 != 0), _copied(numbers, i + 2, z, copy & 4 != 0)
    return _Place(a.x, b.x, c.x, max(a.gap, max(b.gap, c.gap)))


@kernel
def _moved(code: int, numbers, i: int, x: np.float64, y: np.float64, z: np.float64) -> _Place:
    """The point at which a part is asked."""
    if code == PLACE:
        return _Place(
            numbers[i] * x + numbers[i + 1] * y + numbers[i + 2] * z + numbers[i + 3],
            numbers[i + 4] * x + numbers[i + 5] * y + numbers[i + 6] * z + numbers[i + 7],
            numbers[i + 8] * x + numbers[i + 9] * y + numbers[i + 10] * z + numbers[i + 11],
            _NONE,
        )
    if code == FOLD:
        return _Place(
            abs(x) if numbers[i] > _NONE else x, abs(y) if numbers[i + 1] > _NONE else y, abs(z) if numbers[i + 2] > _NONE else z, _NONE
        )
    if code == STRETCH:
        a, b, c = f64(numbers[i]), f64(numbers[i + 1]), f64(numbers[i + 2])
        return _Place(x - min(max(x, -a), a), y - min(max(y, -b), b), z - min(max(z, -c), c), _NONE)
    if code == TILE:
        return _Place(_tiled(numbers, i, x), _tiled(numbers, i + 1, y), _tiled(numbers, i + 2, z), _NONE)
    if code == REPEAT:
        return _copy(numbers, i, 0, x, y, z)
    return _turned(numbers, i, x, y, z)


@kernel
def _next_copy(numbers, i: int, x: np.float64, y: np.float64, z: np.float64, value: np.float64, stack, kept: int) -> _Place:
    """Keep the least of the copies' distances in row `kept`, and return the point as the next copy sees it; infinitely far: no other
    could be nearer.
    """
    copy, least = int(stack[kept, _COPY]), value
    if copy > 0:
        least = min(stack[kept, _LEAST], max(value, _copy(numbers, i, copy, x, y, z).gap))
    stack[kept, _LEAST] = least
    for following in range(copy + 1, _COPIES):
        p = _copy(numbers, i, following, x, y, z)
        if p.gap < least:
            stack[kept, _COPY] = following
            return p
    return _Place(x, y, z, _FAR)


@outlined
def field_value(numbers, first: int, last: int, x: np.float64, y: np.float64, z: np.float64, stack) -> np.float64:
    """What the program numbers[first : last] says of a point; `stack` (n, 6) float64 is scratch."""
    at, kept, found = first, 0, 0
    while at < last:
        code, i, following = int(numbers[at]), at + 2, at + int(numbers[at + 1])
        if code < FIRST_JOINING:
            stack[found, _DISTANCE] = leaf_distance(code, numbers, i, x, y, z)
            found += 1
        elif code == GROW:
            stack[found - 1, _DISTANCE] -= numbers[i]
        elif code == WALLS:
            stack[found - 1, _DISTANCE] = abs(stack[found - 1, _DISTANCE]) - numbers[i]
        elif code < FIRST_MOVING:
            found -= 1
            stack[found - 1, _DISTANCE] = _joined(code, stack[found - 1, _DISTANCE], stack[found, _DISTANCE], f64(numbers[i]))
        elif code < LEAVE:
            stack[kept, 0], stack[kept, 1], stack[kept, 2], stack[kept, _COPY] = x, y, z, _NONE
            kept += 1
            p = _moved(code, numbers, i, x, y, z)
            x, y, z = p.x, p.y, p.z
        else:
            kept -= 1
            x, y, z = stack[kept, 0], stack[kept, 1], stack[kept, 2]
            if code == LEAVE:
                stack[found - 1, _DISTANCE] *= numbers[i]
            else:
                body = at - int(numbers[i])
                p = _next_copy(numbers, body - _REPEAT_NUMBERS, x, y, z, stack[found - 1, _DISTANCE], stack, kept)
                if p.gap < _FAR:
                    x, y, z = p.x, p.y, p.z
                    kept, found, following = kept + 1, found - 1, body
                else:
                    stack[found - 1, _DISTANCE] = stack[kept, _LEAST]
        at = following
    return stack[0, _DISTANCE]
