"""Which of many triangles that shine to ask from a point: down a tree, at every node to one of two by what they may be worth.

What a group of lamps may be worth is its power over the squared distance, times the greatest cosine at which any of them may be seen: the
group lies in a sphere, its normals in a cone (`limner.tables.light_tree`). The chance of a leaf is the product of the chances on the way,
and for a triangle that a ray met by chance they are multiplied on the way up.

**Source**: A. Conty Estévez and C. Kulla, *Importance sampling of many lights with adaptive tree splitting*, HPG 2018, sections 4 and 5.4,
without the cosine at the point itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import safe_sqrt, sqrt
from ..kernel.vec import ONE, ZERO, Vec3, dot

__all__ = ["Leaf", "draw_leaf", "row_of", "share_of"]

f32 = np.float32
_LAST = f32(1.0 - 2.0**-24)  # the greatest float32 below 1


class Leaf(NamedTuple):
    """A row of the emitters, the chance that it was drawn (0: nothing shines on the point), and what is left of the number that drew it."""

    row: int
    share: np.float32
    rest: np.float32


@kernel
def _worth(emitters, node: int, p: Vec3) -> np.float32:
    """What a node may be worth at p: `power max(cos) / d^2`."""
    n = emitters.shape[0]
    row, side = (node, 0) if node < n else (node - n, 1)
    numbers = emitters[row]["nodes"]
    d = p - Vec3(numbers[side, 0], numbers[side, 1], numbers[side, 2])
    squared, inner, power = dot(d, d), numbers[side, 3], numbers[side, 8]
    if squared <= inner:
        return power / inner if inner > ZERO else power
    level, cone = power / squared, numbers[side, 7]
    # Of the angle between axis and p the cone's half angle is taken, and that under which the sphere is seen from p.
    sin2 = inner / squared
    cos_sphere, sin_sphere, sin_cone = safe_sqrt(ONE - sin2), sqrt(sin2), safe_sqrt(ONE - cone * cone)
    cos_both, sin_both = cone * cos_sphere - sin_cone * sin_sphere, sin_cone * cos_sphere + cone * sin_sphere
    cos_axis = dot(Vec3(numbers[side, 4], numbers[side, 5], numbers[side, 6]), d) / sqrt(squared)
    if cone <= -ONE or (sin_both <= ZERO and cos_both < ZERO) or cos_axis >= cos_both:
        return level
    return level * max(cos_axis * cos_both + safe_sqrt(ONE - cos_axis * cos_axis) * sin_both, ZERO)


@outlined
def draw_leaf(emitters, p: Vec3, u: np.float32) -> Leaf:
    """Draw a row of the emitters as seen from p; u in [0, 1)."""
    n, node, share = emitters.shape[0], 1, ONE
    while node < n:
        a, b = _worth(emitters, 2 * node, p), _worth(emitters, 2 * node + 1, p)
        if not a + b > ZERO:
            return Leaf(0, ZERO, ZERO)
        first = a / (a + b)
        if u < first:
            node, share, u = 2 * node, share * first, min(u / first, _LAST)
        else:
            node, share, u = 2 * node + 1, share * (b / (a + b)), min((u - first) / (ONE - first), _LAST)
    return Leaf(node - n, share, u)


@outlined
def share_of(emitters, row: int, p: Vec3) -> np.float32:
    """The chance with which `draw_leaf` draws a row."""
    node, share = row + emitters.shape[0], ONE
    while node > 1 and share > ZERO:
        this, other = _worth(emitters, node, p), _worth(emitters, node ^ 1, p)
        share = share * (this / (this + other)) if this > ZERO else ZERO
        node = node >> 1
    return share


@kernel
def row_of(emitters, instance: int, triangle: int) -> int:
    """The row of a triangle of an instance; -1 if it is none of the emitters."""
    low, high = 0, emitters.shape[0]
    while low < high:
        middle = (low + high) // 2
        key = emitters[middle]
        if key["key_instance"] < instance or (key["key_instance"] == instance and key["key_triangle"] < triangle):
            low = middle + 1
        else:
            high = middle
    if low < emitters.shape[0] and emitters[low]["key_instance"] == instance and emitters[low]["key_triangle"] == triangle:
        return np.int64(emitters[low]["key_row"])
    return -1
