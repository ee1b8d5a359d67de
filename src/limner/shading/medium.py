"""What a ray is in: the media that it has entered and not left, and what they do to light on the way.

A ray carries its media as the bytes of one integer, each a row of the table `media`; the last one entered is the lowest byte, and 0 is
what is outside of all. Of those it is in, the one of the highest priority fills the place, and among equals the last one entered. So a
surface bends light only where it changes what fills the place: the surface of water inside the wall of its glass, where glass has the
higher priority, does nothing.

**Source**: Schmidt and Budge, *Simple nested dielectrics in ray traced images*, Journal of Graphics Tools 7(2), 2002.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.elementary import exp2
from ..kernel.vec import ONE, ZERO, Color

__all__ = ["Crossing", "cross_surface", "filling", "haze_of", "passed", "within", "without"]

f32, i64 = np.float32, np.int64
_BYTE = i64(256)
_FULL = i64(1) << i64(48)  # seven bytes are taken from here on, and the eighth holds the sign
_LOG2_E = f32(math.log2(math.e))


@kernel
def filling(inside: int, media) -> int:
    """The row of the medium that fills the place."""
    found, rest = i64(0), i64(inside)
    while rest > 0:
        row = rest % _BYTE
        if found == 0 or media[row]["priority"] > media[found]["priority"]:
            found = row
        rest = rest // _BYTE
    return found


@kernel
def within(inside: int, medium: int) -> int:
    """With one more medium entered; the same where there is no room for it."""
    return inside * _BYTE + medium if inside < _FULL else i64(inside)


@kernel
def without(inside: int, medium: int) -> int:
    """Without the last one entered of a medium; the same where there is none."""
    place, rest = i64(1), i64(inside)
    while rest > 0:
        if rest % _BYTE == medium:
            return (rest // _BYTE) * place + inside % place
        rest = rest // _BYTE
        place = place * _BYTE
    return i64(inside)


class Crossing(NamedTuple):
    """What is on both sides of a surface: rows of media, and what the ray is in once it has gone through."""

    before: int
    after: int
    inside: int


@kernel
def cross_surface(inside: int, media, medium: int, is_entered: bool) -> Crossing:
    """What happens at the surface of a medium. Where before is after, there is nothing to see.

    A ray that leaves a medium it never entered began in it.
    """
    if is_entered:
        following = within(inside, medium)
        return Crossing(filling(inside, media), filling(following, media), following)
    following = without(inside, medium)
    before = filling(inside, media)
    if following == inside and (before == 0 or media[medium]["priority"] > media[before]["priority"]):
        before = i64(medium)
    return Crossing(before, filling(following, media), following)


@kernel
def _left_of(attenuation: np.float32, distance: np.float32) -> np.float32:
    """exp(-a d), Beer's law (FoCG 13.1); 1 for a = 0, whatever the distance."""
    return exp2(-attenuation * distance * _LOG2_E) if attenuation > ZERO else ONE


@kernel
def passed(media, row: int, distance: np.float32) -> Color:
    """What is left of light after a distance in a medium."""
    a = media[row]["attenuation"]
    return Color(_left_of(a[0], distance), _left_of(a[1], distance), _left_of(a[2], distance))


@kernel
def haze_of(media, row: int) -> Color:
    """The radiance of a medium where it is thick."""
    haze = media[row]["haze"]
    return Color(haze[0], haze[1], haze[2])
