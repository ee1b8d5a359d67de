"""Textures that are formulas: checkers, stripes, ramps, noise, marble and wood (FoCG 11.5).

A picture is laid onto a surface; a pattern may fill space, and the surface shows what it cuts through, as a block of stone is carved. It
has no texels that could be seen, and fits every shape without texture coordinates.

    marble = limner.Marble(colors=((0.9, 0.9, 0.88), (0.2, 0.2, 0.25)), scale=2.0)
    scene = limner.Scene(..., limner.Shape(limner.Sphere(), (limner.Lambert((1, 1, 1), texture=marble),)))

Every pattern is a number at each place, and a ramp of colours that the number looks up. It can stand wherever a `Texture` can; where one
channel is asked for (height, roughness, coverage), give greys. Towards the horizon, where a pattern is finer than a pixel, eye rays and
the rasteriser see its mean.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, TypeAlias

from ..errors import SceneError
from ._values import Triple, finite, positive, triple, unit_interval

__all__ = ["MAX_OCTAVES", "MAX_STOPS", "Checker", "Gradient", "Marble", "Noise", "Pattern", "Stripes", "Turbulence", "Wood"]

MAX_STOPS = 8
MAX_OCTAVES = 12

Colors: TypeAlias = tuple[tuple[float, ...], ...]
PatternMapping = Literal["object", "uv"]

_BLACK_TO_WHITE: Colors = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


def _put(pattern: _Laid, field: str, value: object) -> None:
    object.__setattr__(pattern, field, value)


def _name(pattern: _Laid, field: str) -> str:
    return f"{type(pattern).__name__.lower()}.{field}"


def _checked_colors(pattern: _Laid) -> Colors:
    name = _name(pattern, "colors")
    given: Any = pattern.colors
    try:
        colors = [tuple(finite(x, name) for x in color) for color in given]
    except TypeError:
        raise SceneError(f"{name} must be a list of colours, got {given!r}") from None
    if not 2 <= len(colors) <= MAX_STOPS:
        raise SceneError(f"{name} must hold 2 to {MAX_STOPS} colours, got {len(colors)}")
    for color in colors:
        if len(color) not in (3, 4) or min(color) < 0.0:
            raise SceneError(f"{name} must be three numbers >= 0 each, or four with alpha, got {color}")
    return tuple(colors)


def _checked_positions(pattern: _Laid) -> tuple[float, ...]:
    name, n = _name(pattern, "positions"), len(pattern.colors)
    if pattern.positions is None:
        return tuple(k / (n - 1) for k in range(n))
    positions = tuple(finite(x, name) for x in pattern.positions)
    if len(positions) != n or list(positions) != sorted(positions):
        raise SceneError(f"{name} must be {n} numbers in rising order, one for each colour, got {positions}")
    return positions


def _check_whole(pattern: _Laid, field: str, least: int, most: int) -> None:
    value = getattr(pattern, field)
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise SceneError(f"{_name(pattern, field)} must be an integer from {least} to {most}, got {value!r}")


def _check_noise(pattern: _Octaves | _Veined) -> None:
    """Check what patterns made of noise have."""
    _check_whole(pattern, "octaves", 1, MAX_OCTAVES)
    _check_whole(pattern, "seed", -(2**31), 2**31 - 1)


# --- what they have in common ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Laid:
    """The ramp, and where the pattern is."""

    colors: Colors = _BLACK_TO_WHITE
    positions: tuple[float, ...] | None = None
    scale: float | Triple = 1.0
    offset: Triple = (0.0, 0.0, 0.0)
    mapping: PatternMapping = "object"
    uv_set: int = 0

    def __post_init__(self) -> None:
        _put(self, "colors", _checked_colors(self))
        _put(self, "positions", _checked_positions(self))
        scale = triple(self.scale, _name(self, "scale"))
        if 0.0 in scale:
            raise SceneError(f"{_name(self, 'scale')} must not be zero, got {scale}")
        _put(self, "scale", scale)
        _put(self, "offset", triple(self.offset, _name(self, "offset")))
        if self.mapping not in ("object", "uv"):
            raise SceneError(f'{_name(self, "mapping")} must be "object" or "uv", got {self.mapping!r}')
        if self.uv_set not in (0, 1):
            raise SceneError(f"{_name(self, 'uv_set')} must be 0 or 1, got {self.uv_set!r}")


@dataclass(frozen=True)
class _Anywhere(_Laid):
    """The same in all directions: the axis is there for kernels only."""

    axis: ClassVar[Triple] = (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class _Along(_Laid):
    """Another along an axis than across it."""

    axis: Triple = (1.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        axis = triple(self.axis, _name(self, "axis"))
        length = math.hypot(*axis)
        if not length > 0.0:
            raise SceneError(f"{_name(self, 'axis')} must not be zero")
        _put(self, "axis", tuple(x / length for x in axis))


@dataclass(frozen=True)
class _Octaves(_Anywhere):
    """Noise upon noise."""

    octaves: int = 1
    gain: float = 0.5
    lacunarity: float = 2.0
    seed: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_noise(self)
        _put(self, "gain", unit_interval(self.gain, _name(self, "gain")))
        _put(self, "lacunarity", positive(self.lacunarity, _name(self, "lacunarity")))


@dataclass(frozen=True)
class _Veined(_Along):
    """A wave that noise has moved."""

    amount: float = 1.0
    octaves: int = 6
    seed: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_noise(self)
        _put(self, "amount", finite(self.amount, _name(self, "amount")))


# --- the patterns ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Checker(_Anywhere):
    """Cubes of two colours in turn; on texture coordinates, squares.

    Parameters
    ----------
    colors : 2 to 8 colours of three or four floats >= 0
        Linear Rec. 709, a fourth number is alpha. The ramp from 0, the cube at the origin, to 1, its neighbours.
    positions : as many floats in rising order, optional
        Where on the ramp the colours are; None: evenly from 0 to 1.
    scale : float or three floats
        Cubes per unit.
    offset : three floats
        Added after scaling.
    mapping : "object" | "uv"
        Solid, in the space of the object, so that the pattern moves with it and grows with it; or flat, on texture coordinates.
    uv_set : 0 or 1
    """


@dataclass(frozen=True)
class Stripes(_Along):
    """Bands of two colours across an axis, with sharp edges (FoCG 11.5.1).

    Parameters
    ----------
    colors, positions, scale, offset, mapping, uv_set
        As for `Checker`; `scale` counts pairs of bands per unit.
    axis : three floats
        Across the bands. Of texture coordinates the third number is 0.
    share : float in [0, 1]
        How much of each pair has the last colour.
    """

    share: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        _put(self, "share", unit_interval(self.share, "stripes.share"))


@dataclass(frozen=True)
class Gradient(_Along):
    """The ramp itself, along an axis from 0 to 1.

    Parameters
    ----------
    colors, positions, scale, offset, mapping, uv_set, axis
        As for `Stripes`.
    wrap : "clamp" | "repeat" | "mirror"
        What lies outside [0, 1].
    """

    wrap: Literal["clamp", "repeat", "mirror"] = "clamp"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.wrap not in ("clamp", "repeat", "mirror"):
            raise SceneError(f'gradient.wrap must be "clamp", "repeat" or "mirror", got {self.wrap!r}')


@dataclass(frozen=True)
class Noise(_Octaves):
    """Gradient noise, octave upon octave: ``1/2 + 1/2 sum g^k n(l^k p) / sum g^k`` (FoCG 11.5.2; fractional Brownian motion).

    Parameters
    ----------
    colors, positions, scale, offset, mapping, uv_set
        As for `Checker`; `scale` counts cells of the first octave per unit. Values crowd around 1/2: a ramp with `positions` from 0.3 to
        0.7 has more contrast.
    octaves : int from 1 to 12
    gain : float in [0, 1]
        g: how high an octave is, measured by the one before.
    lacunarity : float > 0
        l: how fine it is.
    seed : int
    """


@dataclass(frozen=True)
class Turbulence(_Octaves):
    """The sum of the noise's magnitudes, with creases where it changes its sign: ``sum g^k |n(l^k p)|`` (FoCG 11.5.3).

    Parameters
    ----------
    colors, positions, scale, offset, mapping, uv_set, octaves, gain, lacunarity, seed
        As for `Noise`; with the gain 1/2 and the lacunarity 2 it is the book's ``sum |n(2^k p)| / 2^k``, some 0.5 in the mean.
    """

    octaves: int = 6


@dataclass(frozen=True)
class Marble(_Veined):
    """Veins: a wave along an axis, its phase shifted by turbulence: ``(1 + sin 2 pi (x + a t(p))) / 2`` (Perlin 1985; FoCG 11.5.3).

    Parameters
    ----------
    colors, positions, scale, offset, mapping, uv_set, axis
        As for `Stripes`; `scale` counts waves, and cells of noise, per unit.
    amount : float
        a: by how many waves the veins are shifted where the turbulence is 1.
    octaves, seed
        As for `Noise`.
    """


@dataclass(frozen=True)
class Wood(_Veined):
    """Rings about an axis, not quite round: ``(1 - cos 2 pi (r + a n(p))) / 2`` at distance r from it (Perlin 1985).

    Parameters
    ----------
    colors, positions, scale, offset, mapping, uv_set
        As for `Checker`; `scale` counts rings, and cells of noise, per unit. Long fibres: a smaller number along the axis.
    axis : three floats
        Of the trunk.
    amount : float
        a: by how many rings the noise moves them.
    octaves, seed
        As for `Noise`.
    """

    colors: Colors = ((0.45, 0.25, 0.1), (0.25, 0.11, 0.04))
    axis: Triple = (0.0, 1.0, 0.0)
    amount: float = 0.3
    octaves: int = 2


Pattern: TypeAlias = Checker | Stripes | Gradient | Noise | Turbulence | Marble | Wood
