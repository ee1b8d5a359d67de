"""What a file says of its colours, read: ICC profiles of three lamps and curves, CICP codes, chromaticities.

A picture whose numbers are not sRGB's becomes linear Rec. 709, as all pictures are inside. A profile of another kind (tables for printers,
greys) and a broken one say nothing here, and the numbers are taken for sRGB.

**Source**: ICC.1:2022 (4.4), 7.3, 10.6 (curv), 10.18 (para), 10.31 (XYZ); ITU-T H.273 for the codes.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerError
from .adaptation import adaptation_matrix
from .encodings import encoding
from .spaces import SPACES, Space, rgb_from_rgb

__all__ = ["Meaning", "meaning_of_cicp", "meaning_of_profile", "rec709_from_chromaticities"]

Floats = NDArray[np.float64]

_D50 = (0.9642, 1.0, 0.8249)
_ALIKE = 2e-3  # of lamps and of curves: what differs by less is sRGB, as its many profiles are
_SHORTEST = 128 + 4
_MOST_TAGS, _MOST_ENTRIES = 200, 65536


class Meaning(NamedTuple):
    """How stored numbers become light: a curve for each of the three, then a matrix to linear Rec. 709."""

    decode: tuple[Callable[[Floats], Floats], ...]
    matrix: Floats

    def light(self, stored: Floats) -> Floats:
        """(n, 3) float64: linear Rec. 709 of stored numbers."""
        made = np.stack([curve(stored[:, k]) for k, curve in enumerate(self.decode)], axis=1)
        return np.asarray(made @ self.matrix.T)


def meaning_of_profile(profile: bytes) -> Meaning | None:
    """What a profile says; None where it says sRGB, or nothing that is understood."""
    try:
        found = _parsed(profile)
    except (struct.error, ValueError, IndexError, OverflowError, ZeroDivisionError):
        return None
    if found is None or not np.isfinite(found.matrix).all():
        return None
    steps = np.linspace(0.0, 1.0, 33)
    usual = encoding("srgb").decode(steps)
    is_usual = np.abs(found.matrix - np.eye(3)).max() < _ALIKE and all(
        np.abs(curve(steps) - usual).max() < _ALIKE for curve in found.decode
    )
    return None if is_usual else found


def meaning_of_cicp(primaries: int, transfer: int) -> Meaning | None:
    """What a code says; None where it says sRGB, or a space that is not known here."""
    for known in SPACES.values():
        if known.cicp == (primaries, transfer) and known.name != "srgb":
            return Meaning((known.encoding.decode,) * 3, rgb_from_rgb("srgb", known))
    return None


def rec709_from_chromaticities(corners: Sequence[float]) -> Floats | None:
    """(3, 3) float64 to linear Rec. 709 from x, y of red, green, blue and white; None where they are Rec. 709's, or are none."""
    try:
        red, green, blue, white = [(float(x), float(y)) for x, y in np.asarray(corners, dtype=np.float64).reshape(4, 2)]
        made = Space("own", "own", red, green, blue, white, "linear")
        matrix = rgb_from_rgb("srgb", made)
    except (LimnerError, ValueError, TypeError, np.linalg.LinAlgError):
        return None
    return matrix if np.isfinite(matrix).all() and np.abs(matrix - np.eye(3)).max() > _ALIKE else None


def _parsed(profile: bytes) -> Meaning | None:
    if len(profile) < _SHORTEST or profile[36:40] != b"acsp" or profile[16:24] != b"RGB XYZ ":
        return None
    (count,) = struct.unpack_from(">I", profile, 128)
    tags = {}
    for k in range(min(count, _MOST_TAGS)):
        key, start, size = struct.unpack_from(">4sII", profile, 132 + 12 * k)
        tags[key] = profile[start : start + size]
    if b"A2B0" in tags or not {b"rXYZ", b"gXYZ", b"bXYZ", b"rTRC", b"gTRC", b"bTRC"} <= set(tags):
        return None
    lamps = np.array([struct.unpack_from(">3i", tags[key], 8) for key in (b"rXYZ", b"gXYZ", b"bXYZ")]).T / 65536.0
    curves = tuple(_curve(tags[key]) for key in (b"rTRC", b"gTRC", b"bTRC"))
    srgb = SPACES["srgb"]
    return Meaning(curves, srgb.rgb_from_xyz @ adaptation_matrix(srgb.white_xyz, _D50) @ lamps)


def _curve(tag: bytes) -> Callable[[Floats], Floats]:
    kind = tag[:4]
    if kind == b"curv":
        (count,) = struct.unpack_from(">I", tag, 8)
        if count == 0:
            return lambda s: s
        if count > _MOST_ENTRIES:
            raise ValueError("a curve of too many entries")
        entries = np.array(struct.unpack_from(f">{count}H", tag, 12), dtype=np.float64)
        if count == 1:
            return lambda s: np.power(np.maximum(s, 0.0), entries[0] / 256.0)
        return lambda s: np.interp(s, np.linspace(0.0, 1.0, count), entries / 65535.0)
    if kind != b"para":
        raise ValueError("a curve of another kind")
    (function,) = struct.unpack_from(">H", tag, 8)
    sizes = (1, 3, 4, 5, 7)
    given = [part / 65536.0 for part in struct.unpack_from(f">{sizes[function]}i", tag, 12)]
    return _parametric(function, given)


def _parametric(function: int, given: list[float]) -> Callable[[Floats], Floats]:
    """``(a s + b)^g + e`` from d on, ``c s + f`` below; the shorter kinds leave some of these out."""
    gamma, a, b, c, d, e, f = {
        0: lambda g: (g, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        1: lambda g, a, b: (g, a, b, 0.0, -b / a, 0.0, 0.0),
        2: lambda g, a, b, c: (g, a, b, 0.0, -b / a, c, c),
        3: lambda g, a, b, c, d: (g, a, b, c, d, 0.0, 0.0),
        4: lambda g, a, b, c, d, e, f: (g, a, b, c, d, e, f),
    }[function](*given)  # type: ignore[operator]
    return lambda s: np.where(s >= d, np.power(np.maximum(a * s + b, 0.0), gamma) + e, c * s + f)
