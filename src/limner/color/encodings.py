"""Transfer functions of colour spaces: between light and the numbers that are stored, without a bound (FoCG 19.2).

Stored numbers are spent as the eye spends them: many steps for the dark. Each function here has its inverse, takes numbers beyond [0, 1]
(a colour outside a space has negative numbers there, and highlights are above 1), and comes back to 1e-12: below 0 the curve is its own
mirror image. `limner.color.transfer` has the clipped forms that pictures of 8 bits want.

    srgb                                         IEC 61966-2-1: 12.92 x, then 1.055 x^(1/2.4) - 0.055
    rec709, rec2020                              what cameras do: 4.5 x, then a x^0.45 - (a - 1)
    gamma_2.2 (Adobe RGB: 563/256), gamma_2.6    plain powers
    romm                                         ProPhoto: 16 x, then x^(1/1.8)
    pq                                           SMPTE ST 2084: absolute, up to 10 000 cd/m2; 1 is a white of 203 cd/m2 here
    hlg                                          ARIB STD-B67: scene light; 1 is the white at 75 % of the signal here
    linear                                       nothing

**Source**: IEC 61966-2-1:1999; ITU-R BT.709-6; BT.2020-2; BT.2100-2 (PQ, HLG); BT.2408-5, 2.1 (where white is); Adobe RGB (1998), 4.3.1.2;
ISO 22028-2 (ROMM); SMPTE RP 431-2 (2.6).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UnsupportedError
from .triples import float_array

__all__ = [
    "ENCODINGS", "HLG_WHITE", "PQ_WHITE_NITS", "Encoding", "decoded", "encoded", "encoding", "hlg_from_linear", "linear_from_hlg",
    "nits_from_pq", "pq_from_nits",
]  # fmt: skip

Floats = NDArray[np.float64]

PQ_WHITE_NITS = 203.0
"""cd/m2 of diffuse white in a picture of high dynamic range. **Source**: ITU-R BT.2408-5, 2.1."""

_PQ_GREATEST = 10000.0
_M1, _M2 = 2610.0 / 16384.0, 2523.0 / 4096.0 * 128.0
_C1, _C2, _C3 = 3424.0 / 4096.0, 2413.0 / 4096.0 * 32.0, 2392.0 / 4096.0 * 32.0
_HLG_A = 0.17883277
_HLG_B = 1.0 - 4.0 * _HLG_A
_HLG_C = 0.5 - _HLG_A * float(np.log(4.0 * _HLG_A))


class Encoding(NamedTuple):
    """A curve with its inverse; both take and give float64 of any shape."""

    name: str
    encode: Callable[[Floats], Floats]
    decode: Callable[[Floats], Floats]
    curve: tuple[float, ...] = ()
    """Of what is a line and then a power: gamma, a, b, c, d of ``(a s + b)^gamma`` from d on, ``c s`` below; how profiles say it."""


def _line_then_power(name: str, scale: float, slope: float, gamma: float, joint: float) -> Encoding:
    """``slope x`` below `joint`, ``scale x^(1/gamma) - (scale - 1)`` beyond; odd."""
    offset = scale - 1.0

    def encode(x: Floats) -> Floats:
        size = np.abs(x)
        power = scale * np.power(size, 1.0 / gamma) - offset
        return np.copysign(np.where(size < joint, slope * size, power), x)

    def decode(s: Floats) -> Floats:
        size = np.abs(s)
        power = np.power((size + offset) / scale, gamma)
        return np.copysign(np.where(size < slope * joint, size / slope, power), s)

    return Encoding(name, encode, decode, (gamma, 1.0 / scale, offset / scale, 1.0 / slope, slope * joint))


def _power(name: str, gamma: float) -> Encoding:
    return Encoding(
        name,
        lambda x: np.copysign(np.power(np.abs(x), 1.0 / gamma), x),
        lambda s: np.copysign(np.power(np.abs(s), gamma), s),
        (gamma, 1.0, 0.0, 0.0, 0.0),
    )


def _wide(values: NDArray[np.floating]) -> Floats:
    return np.asarray(values, dtype=np.float64)


def pq_from_nits(nits: ArrayLike) -> NDArray[np.floating]:
    """(...): the PQ signal of luminances, cd/m2; 10 000 is 1. Below 0 the curve is mirrored.

    >>> pq_from_nits([0.0, 100.0, 10000.0]).round(4).tolist()
    [0.0, 0.5081, 1.0]

    **Source**: ITU-R BT.2100-2, table 4 (SMPTE ST 2084): ``((c1 + c2 Y^m1) / (1 + c3 Y^m1))^m2``; less its 7e-7 at 0, so that black is 0.
    """
    given = float_array(nits, "nits")
    y = np.power(np.abs(given.astype(np.float64)) / _PQ_GREATEST, _M1)
    made = np.power((_C1 + _C2 * y) / (1.0 + _C3 * y), _M2)
    made = np.where(given == 0.0, 0.0, made)
    return np.copysign(made, given).astype(given.dtype)


def nits_from_pq(signal: ArrayLike) -> NDArray[np.floating]:
    """(...): cd/m2 of a PQ signal; the inverse of `pq_from_nits`. A signal beyond what any luminance has gives infinity.

    **Source**: ITU-R BT.2100-2, table 4.
    """
    given = float_array(signal, "signal")
    root = np.power(np.abs(given.astype(np.float64)), 1.0 / _M2)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.maximum(root - _C1, 0.0) / (_C2 - _C3 * root)
        made = np.where(root >= _C2 / _C3, np.inf, _PQ_GREATEST * np.power(np.where(ratio < 0.0, np.inf, ratio), 1.0 / _M1))
    return np.copysign(np.where(np.isnan(given), np.nan, made), given).astype(given.dtype)


def hlg_from_linear(light: ArrayLike) -> NDArray[np.floating]:
    """(...): the hybrid log-gamma signal of a scene's light, [0, 1] to [0, 1]: a square root, then a logarithm.

    >>> hlg_from_linear([0.0, 1.0 / 12.0, 1.0]).round(6).tolist()
    [0.0, 0.5, 1.0]

    **Source**: ITU-R BT.2100-2, table 5 (OETF).
    """
    given = float_array(light, "light")
    size = np.abs(given.astype(np.float64))
    log = _HLG_A * np.log(np.maximum(12.0 * size - _HLG_B, 1e-300)) + _HLG_C
    return np.copysign(np.where(size <= 1.0 / 12.0, np.sqrt(3.0 * size), log), given).astype(given.dtype)


def linear_from_hlg(signal: ArrayLike) -> NDArray[np.floating]:
    """(...): a scene's light of a hybrid log-gamma signal; the inverse of `hlg_from_linear`."""
    given = float_array(signal, "signal")
    size = np.abs(given.astype(np.float64))
    with np.errstate(over="ignore"):
        exp = (np.exp((size - _HLG_C) / _HLG_A) + _HLG_B) / 12.0
    return np.copysign(np.where(size <= 0.5, size * size / 3.0, exp), given).astype(given.dtype)


HLG_WHITE = float(linear_from_hlg(0.75))
"""A scene's light of diffuse white in hybrid log-gamma: 75 % of the signal. **Source**: ITU-R BT.2408-5, 2.1."""


def _meeting(scale: float, slope: float, gamma: float, near: float) -> float:
    """Where the line and the power meet, which standards round: Newton's steps from the rounded number.

    With the rounded number the curve has a jump of some 1e-8, and numbers inside it would not come back.
    """
    x = near
    for _ in range(50):
        x -= (slope * x - scale * x ** (1.0 / gamma) + scale - 1.0) / (slope - scale / gamma * x ** (1.0 / gamma - 1.0))
    return x


_ROMM_JOINT = 16.0 ** (1.8 / (1.0 - 1.8))
_A_2020, _B_2020 = 1.09929682680944, 0.018053968510807

_KNOWN = (
    Encoding("linear", lambda x: x.copy(), lambda s: s.copy(), (1.0, 1.0, 0.0, 0.0, 0.0)),
    _line_then_power("srgb", 1.055, 12.92, 2.4, _meeting(1.055, 12.92, 2.4, 0.0031308)),
    _line_then_power("rec709", 1.099, 4.5, 1.0 / 0.45, 0.018),
    _line_then_power("rec2020", _A_2020, 4.5, 1.0 / 0.45, _B_2020),
    _line_then_power("romm", 1.0, 16.0, 1.8, _ROMM_JOINT),
    _power("gamma_2.2", 2.2),
    _power("adobe", 563.0 / 256.0),
    _power("gamma_2.6", 2.6),
    Encoding("pq", lambda x: _wide(pq_from_nits(x * PQ_WHITE_NITS)), lambda s: _wide(nits_from_pq(s) / PQ_WHITE_NITS)),
    Encoding("hlg", lambda x: _wide(hlg_from_linear(x * HLG_WHITE)), lambda s: _wide(linear_from_hlg(s) / HLG_WHITE)),
)
ENCODINGS = tuple(known.name for known in _KNOWN)
"""Names of transfer functions."""


def encoding(name: str) -> Encoding:
    """A transfer function by name; UnsupportedError names all."""
    for known in _KNOWN:
        if known.name == name:
            return known
    raise UnsupportedError(f"a transfer function must be one of {', '.join(ENCODINGS)}, got {name!r}")


def encoded(linear: ArrayLike, name: str) -> NDArray[np.floating]:
    """(...): the stored numbers of light, 1 being white; float32 where light is.

    >>> encoded([-0.5, 0.0, 0.18, 2.0], "srgb").round(4).tolist()
    [-0.7354, 0.0, 0.4614, 1.3533]
    """
    given = float_array(linear, "linear")
    return encoding(name).encode(given.astype(np.float64)).astype(given.dtype)


def decoded(stored: ArrayLike, name: str) -> NDArray[np.floating]:
    """(...): the light of stored numbers; the inverse of `encoded`."""
    given = float_array(stored, "stored")
    return encoding(name).decode(given.astype(np.float64)).astype(given.dtype)
