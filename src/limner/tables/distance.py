"""A field of distances as kernels read it: a program for a stack, in numbers.

A description is a tree, and a ray must not recurse. So, as of combinations of solids (`limner.tables.exact`), a program is made of it,
parts before their operation. What changes the point at which its part is asked stands around that part:

    Union(Sphere(), Box().translated(...))     ->     SPHERE   PLACE BOX LEAVE   UNION

One float32 array holds all of it: the box, low and high corner; by how much a step has to be shorter than the field's value; how many
numbers the program has; the program (`limner.tables.distance_codes`).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..scene import distance
from ..scene.distance_leaves import JULIA_DEPTH, JULIA_ESCAPE, JULIA_ROOM
from .distance_codes import (
    AGAIN,
    BALL,
    BLOCK,
    COMMON,
    CONE,
    CYLINDER,
    ELLIPSOID,
    FOLD,
    GROW,
    GYROID,
    JOIN,
    JULIA,
    LEAVE,
    OCTAHEDRON,
    PLACE,
    PLANE,
    REPEAT,
    RING,
    SEGMENT,
    SPONGE,
    STRETCH,
    TILE,
    TURN,
    WALLS,
    WITHOUT,
)

__all__ = ["numbers_of"]

_MARGIN = 1e-5  # of its extent, by which the box is wider than it must be: float32 rounds
_ROUNDING = 2.0**-22  # of its farthest corner
_SLOPE_MARGIN = 1.0 + 1e-6


def numbers_of(field: distance.DistanceField) -> NDArray[np.float32]:
    """(n,) float32: box, slope and program of a field.

    Examples
    --------
    >>> numbers_of(distance.DistanceField(distance.Sphere(2.0)))[8:].tolist()   # BALL, 3 numbers, radius
    [0.0, 3.0, 2.0]
    """
    low, high = field.expression.bounds
    margin = _MARGIN * float(np.linalg.norm(high - low)) + _ROUNDING * float(np.abs([low, high]).max())
    program = _program(field.expression)
    header = [*(low - margin), *(high + margin), field.expression.lipschitz * _SLOPE_MARGIN, len(program)]
    return np.array([*header, *program], dtype=np.float32)


def _instruction(code: int, *numbers: float) -> list[float]:
    return [code, 2 + len(numbers), *numbers]


@functools.singledispatch
def _program(node: Any) -> list[float]:
    """What leaves the distance of a node on the stack."""
    raise AssertionError(f"no program for {type(node).__name__}")


def _leaf(code: int, numbers: Callable[[Any], Iterable[float]]) -> Callable[[Any], list[float]]:
    return lambda node: _instruction(code, *numbers(node))


def _julia(node: distance.QuaternionJulia) -> Iterable[float]:
    sizes = (node.radius, JULIA_ROOM * node.radius, JULIA_DEPTH * node.radius)
    return (*node.constant, node.iterations, *sizes, JULIA_ESCAPE * JULIA_ESCAPE)


for _kind, _code, _numbers in (
    (distance.Sphere, BALL, lambda n: (n.radius,)),
    (distance.Box, BLOCK, lambda n: (*np.array(n.size) / 2.0, 0.0)),
    (distance.RoundedBox, BLOCK, lambda n: (*np.array(n.size) / 2.0 - n.radius, n.radius)),
    (distance.Torus, RING, lambda n: (n.major_radius, n.minor_radius)),
    (distance.Segment, SEGMENT, lambda n: (*n.begin, *n.end, n.radius)),
    (distance.Cylinder, CYLINDER, lambda n: (n.radius, n.height / 2.0)),
    (distance.Cone, CONE, lambda n: (n.radius, n.top_radius, n.height / 2.0)),
    (distance.Plane, PLANE, lambda n: ()),
    (distance.Ellipsoid, ELLIPSOID, lambda n: n.radii),
    (distance.Octahedron, OCTAHEDRON, lambda n: (n.radius,)),
    (distance.Gyroid, GYROID, lambda n: (2.0 * math.pi / n.period, n.thickness / 2.0)),
    (distance.MengerSponge, SPONGE, lambda n: (n.size / 2.0, n.iterations)),
    (distance.QuaternionJulia, JULIA, _julia),
):
    _program.register(_kind)(_leaf(_code, _numbers))


def _joined(code: int) -> Callable[[Any], list[float]]:
    def program(node: Any) -> list[float]:
        first, *others = (_program(part) for part in node.parts)
        return first + [number for other in others for number in (*other, *_instruction(code, node.radius))]

    return program


_program.register(distance.Union)(_joined(JOIN))
_program.register(distance.Intersection)(_joined(COMMON))
_program.register(distance.Difference)(_joined(WITHOUT))


@_program.register
def _(node: distance.Offset) -> list[float]:
    return _program(node.part) + _instruction(GROW, node.amount)


@_program.register
def _(node: distance.Shell) -> list[float]:
    return _program(node.part) + _instruction(WALLS, node.thickness / 2.0)


@_program.register
def _(node: distance.Placed) -> list[float]:
    return _instruction(PLACE, *node.part_from_parent[:3].reshape(-1)) + _program(node.part) + _instruction(LEAVE, node.factor)


@_program.register
def _(node: distance.Mirrored) -> list[float]:
    return _instruction(FOLD, *node.flags) + _program(node.part) + _instruction(LEAVE, 1.0)


@_program.register
def _(node: distance.Elongated) -> list[float]:
    return _instruction(STRETCH, *node.amounts) + _program(node.part) + _instruction(LEAVE, 1.0)


@_program.register
def _(node: distance.Twisted) -> list[float]:
    turned = [*_instruction(TURN, math.radians(node.degrees_per_unit), node.radius), *_program(node.part), *_instruction(LEAVE, 1.0)]
    return turned + _instruction(CYLINDER, node.radius, math.inf) + _instruction(COMMON, 0.0)


@_program.register
def _(node: distance.Repeated) -> list[float]:
    middle, half = node.middle_and_half
    first, last, start = node.first_and_last
    if node.alternating:
        return _instruction(TILE, *node.spacing, *first, *last, *start) + _program(node.part) + _instruction(LEAVE, 1.0)
    begin = _instruction(REPEAT, *node.spacing, *first, *last, *start, *middle, *half)
    body = _program(node.part)
    return begin + body + _instruction(AGAIN, len(body))
