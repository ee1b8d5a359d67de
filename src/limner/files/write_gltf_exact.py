"""Numbers that are read back to the bit.

A reader turns what a file says into what a scene says: radians into degrees, three factors into a matrix, the offset of a picture whose v
points down into that of one whose v points up. Each rounds. Writing the inverse rounds again, and the last bit may be another one; so
it is looked for among the numbers beside it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..linear.decompose import polar, singular, trs
from ..linear.quaternion import from_matrix
from ..linear.transform import compose_trs
from .gltf_material import turned_transform

__all__ = ["Parts", "factors", "given_transform", "inverted", "nearest_parts", "parts_of"]

Floats = NDArray[np.float64]
Pair = tuple[float, float]

_REACH = 4  # neighbours on each side that are tried
_ROUNDING = 1e-14  # as a share of the greatest scale
_LENGTHS = 24  # steps up and down that are tried
_DIGITS = (9, 8, 7, 6, 5, 4, 3)  # that people and exporters write


class Parts(NamedTuple):
    """A node's translation, rotation (x, y, z, w) and scale."""

    translation: Floats
    rotation: Floats
    scale: Floats


def inverted(forward: Callable[[float], float], guess: float, wanted: float) -> float:
    """Find x near `guess` with ``forward(x) == wanted``; `guess` itself where there is none.

    >>> x = inverted(math.degrees, math.radians(36.9), 36.9)
    >>> math.degrees(x) == 36.9
    True
    """
    return next((x for x in _beside(guess) if forward(x) == wanted), guess)


def _beside(x: float) -> Iterator[float]:
    """x and its neighbours, the nearest first."""
    yield x
    below = above = x
    for _ in range(_REACH):
        below, above = math.nextafter(below, -math.inf), math.nextafter(above, math.inf)
        yield below
        yield above


def given_transform(offset: Pair, rotation: float, scale: Pair) -> tuple[Pair, float, Pair]:
    """Return what `turned_transform` turns into the given numbers: KHR_texture_transform's offset, rotation and scale.

    ``t = (o_u - s S_v, 1 - o_v - c S_v)`` with c and s the cosine and sine of the rotation.
    """
    c, s = math.cos(rotation), math.sin(rotation)

    def along_u(t: float) -> float:
        return turned_transform((t, 0.0), rotation, scale)[0][0]

    def along_v(t: float) -> float:
        return turned_transform((0.0, t), rotation, scale)[0][1]

    t_u = inverted(along_u, offset[0] - s * scale[1], offset[0])
    t_v = inverted(along_v, 1.0 - offset[1] - c * scale[1], offset[1])
    return (t_u, t_v), rotation, scale


def parts_of(matrix: Floats) -> Parts | None:
    """Take a node's matrix apart; None where translation, rotation and scale do not make it again, but for the last digits.

    Of numbers that make it equally well, those with the fewest digits are taken: they are what a file had, and make it to the bit. What
    only swaps axes has exact zeros, which turns by a quarter do not; it is taken apart only where they do.
    """
    linear = matrix[:3, :3]
    if np.array_equal(linear, np.diag(np.diagonal(linear))):
        return Parts(matrix[:3, 3].copy(), np.array([0.0, 0.0, 0.0, 1.0]), np.diagonal(linear).copy())
    try:
        translation, rotation, scale = trs(matrix)
    except SceneError:
        return None
    rotations, scales = (np.array(list(_shorter(part))) for part in (rotation, scale))
    found, error = _best(linear, translation, rotations, scales)
    if error > 0.0:
        found, error = min((found, error), _best(linear, translation, _not_quite_unit(rotation), scales[:2]), key=lambda made: made[1])
    swaps_axes = bool((np.count_nonzero(linear, axis=0) <= 1).all())
    most = 0.0 if swaps_axes and scale.all() else _ROUNDING * float(np.abs(scale).max())
    return found if error <= most else None


def _best(linear: Floats, translation: Floats, rotations: Floats, scales: Floats) -> tuple[Parts, float]:
    """Of all pairs the one that makes a matrix best, and how far off that is."""
    pairs = np.array(list(itertools.product(range(len(rotations)), range(len(scales)))))
    made = compose_trs(translation, rotations[pairs[:, 0]], scales[pairs[:, 1]])[:, :3, :3]
    errors = np.abs(made - linear).max(axis=(1, 2))
    best = int(np.argmin(errors))
    return Parts(translation, rotations[pairs[best, 0]], scales[pairs[best, 1]]), float(errors[best])


def _not_quite_unit(rotation: Floats) -> Floats:
    """What a quaternion may have been in a file's single precision, where its length is 1 but for rounding."""
    lengths = 1.0 + np.arange(-_LENGTHS, _LENGTHS + 1) * 2.0**-26
    return np.unique((rotation * lengths[:, None]).astype(np.float32), axis=0).astype(np.float64)


def _shorter(numbers: Floats) -> Iterator[Floats]:
    """What three or four numbers may have been before they were computed with."""
    single = numbers.astype(np.float32)
    yield numbers
    yield single.astype(np.float64)
    yield np.array([float(str(number)) for number in single])
    for digits in _DIGITS:
        yield numbers.round(digits)


def nearest_parts(matrix: Floats) -> Parts:
    """The rotation and scale nearest to a matrix that may have shear."""
    try:
        return Parts(*trs(matrix))
    except SceneError:
        turn = polar(matrix[:3, :3]).rotation
        sign = -1.0 if np.linalg.det(turn) < 0.0 else 1.0
        turn = turn * (sign, 1.0, 1.0)
        return Parts(matrix[:3, 3].copy(), from_matrix(turn), np.einsum("ij,ij->j", turn, matrix[:3, :3]))


def factors(matrix: Floats) -> tuple[Parts, Parts]:
    """Take a matrix with shear apart into two that have none: ``A = R S Q``, first R S and in it Q.

    **Source**: FoCG 6.1.6, singular value decomposition.
    """
    after, sizes, before = singular(matrix[:3, :3])
    outer = Parts(matrix[:3, 3].copy(), from_matrix(after), sizes)
    return outer, Parts(np.zeros(3), from_matrix(before.T), np.ones(3))
