"""Eight points of shining surfaces, as they are seen from eight places: `limner.shading.emitters` in lanes, bit for bit.

Lanes read tables of one kind of number, so the rows of the emitters come as float32 words, integers by their bits. All stand
still and shine alike everywhere, as their rows say.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ..kernel.elementary import as_int, sqrt
from ..kernel.lanes import at, f32x8, i32x8, min, spread, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot
from ..kernel.warp import warp_triangle
from ..tables.layouts import EMITTER
from .emitters import EmitterSample

__all__ = ["sample_emitters"]

f32 = np.float32
_WORDS = EMITTER.itemsize // 4
_CUMULATIVE, _CORNER, _EDGE_U, _EDGE_V, _NORMAL, _RADIANCE, _WEIGHT, _DOUBLE_SIDED = (
    EMITTER.fields[name][1] // 4
    for name in ("cumulative", "corner", "edge_u", "edge_v", "normal", "radiance", "weight", "double_sided")
)  # fmt: skip


@kernel
def _find(words, u: f32x8) -> i32x8:
    """The first emitters whose share of the power reaches beyond u."""
    n = words.shape[0] // _WORDS
    low = as_int(u) * np.int32(0)
    high = low + np.int32(n - 1)
    while n > 1:
        # As many steps as the widest of eight intervals may need: where low and high have met, another one changes nothing.
        middle = (low + high) >> np.int32(1)
        beyond = (at(words, middle * np.int32(_WORDS) + np.int32(_CUMULATIVE)) > u) | (low >= high)
        low, high = where(beyond, low, middle + np.int32(1)), where(beyond, where(low >= high, high, middle), high)
        n = (n + 1) // 2
    return low


@kernel
def _vector(words, place: i32x8) -> Vec3:
    return Vec3(at(words, place), at(words, place + np.int32(1)), at(words, place + np.int32(2)))


@kernel
def sample_emitters(words, power: np.float32, p: Vec3, u: f32x8, v: f32x8) -> EmitterSample:
    """`sample_emitter` for eight points p; pdf 0: none."""
    k = _find(words, u)
    place = k * np.int32(_WORDS)
    is_first = k == np.int32(0)
    last = where(is_first, place, place - np.int32(_WORDS)) + np.int32(_CUMULATIVE)
    before = where(is_first, spread(ZERO, u), at(words, last))
    share = at(words, place + np.int32(_CUMULATIVE)) - before
    has_share = share > ZERO
    rest = where(has_share, min((u - before) / where(has_share, share, ONE), spread(ONE, u)), ZERO)
    b1, b2 = warp_triangle(rest, v)
    position = _vector(words, place + np.int32(_CORNER)) + _vector(words, place + np.int32(_EDGE_U)) * b1
    position = position + _vector(words, place + np.int32(_EDGE_V)) * b2
    c = _vector(words, place + np.int32(_RADIANCE))
    to_light = position - p
    squared = dot(to_light, to_light)
    apart = squared > ZERO
    distance = sqrt(squared)
    wi = to_light * (ONE / where(apart, distance, ONE))
    cos_theta = -dot(_vector(words, place + np.int32(_NORMAL)), wi)
    cos_theta = where(as_int(at(words, place + np.int32(_DOUBLE_SIDED))) != np.int32(0), abs(cos_theta), cos_theta)
    is_seen = apart & (cos_theta > ZERO)
    pdf = at(words, place + np.int32(_WEIGHT)) / power * squared / where(is_seen, cos_theta, ONE)
    return EmitterSample(wi, distance, Color(c.x, c.y, c.z), where(is_seen, pdf, ZERO))
