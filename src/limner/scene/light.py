"""Lights (FoCG 4.5-4.7; KHR_lights_punctual).

Their numbers are taken as they stand: candela for points and spots, lux for directions, nit for areas, with factor 1. A light shines
along the -z of its node and stands at the node's origin; a node's scale does not change it.

Lights with an area cast soft shadows (FoCG 13.4.2) in `ray` and `path`, where each is asked at a point of its own for every sample;
`raster` takes them for points. They are seen, in mirrors, too, as surfaces of one radiance, unless they are invisible.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from ..errors import SceneError
from ._values import Triple, finite, positive, triple

__all__ = [
    "AmbientLight", "AreaLight", "DirectionalLight", "DiskLight", "Falloff", "Light", "PointLight", "RectangleLight", "SphereLight",
    "SpotLight",
]  # fmt: skip

Falloff = Literal["inverse_square", "none"]


def _check(light: Light) -> None:
    object.__setattr__(light, "color", triple(light.color, "light.color", minimum=0.0))
    intensity = finite(light.intensity, "light.intensity")
    if intensity < 0.0:
        raise SceneError(f"light.intensity must not be negative, got {intensity}", light.name)
    object.__setattr__(light, "intensity", intensity)
    if isinstance(light, (PointLight, SpotLight)):
        if light.falloff not in ("inverse_square", "none"):
            raise SceneError(f'light.falloff must be "inverse_square" or "none", got {light.falloff!r}', light.name)
        if light.range is not None:
            object.__setattr__(light, "range", positive(light.range, "light.range"))


@dataclass(frozen=True)
class PointLight:
    """A point that shines alike in all directions.

    Parameters
    ----------
    color : three floats >= 0
        Linear Rec. 709.
    intensity : float >= 0
        Candela: the irradiance at distance d, facing it, is ``color intensity / d^2``.
    range : float > 0, optional
        Metres beyond which nothing arrives; the glTF window ``max(min(1 - (d/range)^4, 1), 0)``. None: no end.
    falloff : "inverse_square" | "none"
        "none": the book's light, the same irradiance at any distance.
    """

    color: Triple = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    range: float | None = None
    falloff: Falloff = "inverse_square"
    name: str = ""

    def __post_init__(self) -> None:
        _check(self)


@dataclass(frozen=True)
class DirectionalLight:
    """Parallel light from infinitely far, along the node's -z.

    Parameters
    ----------
    color : three floats >= 0
    intensity : float >= 0
        Lux: the irradiance of a surface that faces it.
    """

    color: Triple = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    name: str = ""

    def __post_init__(self) -> None:
        _check(self)


@dataclass(frozen=True)
class SpotLight:
    """A point that shines into a cone along the node's -z.

    Parameters
    ----------
    intensity : float >= 0
        Candela inside the inner cone.
    inner_degrees, outer_degrees : floats, 0 <= inner < outer <= 90
        Half angles; between them the intensity falls as in KHR_lights_punctual.
    """

    color: Triple = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    inner_degrees: float = 0.0
    outer_degrees: float = 45.0
    range: float | None = None
    falloff: Falloff = "inverse_square"
    name: str = ""

    def __post_init__(self) -> None:
        _check(self)
        inner = finite(self.inner_degrees, "light.inner_degrees")
        outer = finite(self.outer_degrees, "light.outer_degrees")
        if not (0.0 <= inner < outer <= 90.0 and math.isfinite(outer)):
            raise SceneError(f"light cone must satisfy 0 <= inner < outer <= 90 degrees, got {inner}, {outer}", self.name)


@dataclass(frozen=True)
class AmbientLight:
    """Light from everywhere alike (FoCG 4.5.3, 10.1.2): the book's I_a, added to all surfaces as ``ka I_a``.

    Parameters
    ----------
    color : three floats >= 0
    intensity : float >= 0
        I_a, the radiance that a white surface gets from it.
    """

    color: Triple = (1.0, 1.0, 1.0)
    intensity: float = 0.1
    name: str = ""

    def __post_init__(self) -> None:
        _check(self)


@dataclass(frozen=True)
class RectangleLight:
    """A rectangle that shines to its front, the node's -z, alike from everywhere and in all directions.

    Parameters
    ----------
    color : three floats >= 0
    intensity : float >= 0
        Nit: its radiance is ``color intensity``; seen straight from the front, from afar, it is ``intensity width height`` candela.
    width, height : float > 0
        Along the node's x and y, metres.
    visible : bool
        Whether it is seen. An invisible one is not in the way of other light either.
    """

    color: Triple = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    width: float = 1.0
    height: float = 1.0
    visible: bool = True
    name: str = ""

    def __post_init__(self) -> None:
        _check(self)
        object.__setattr__(self, "width", positive(self.width, "light.width"))
        object.__setattr__(self, "height", positive(self.height, "light.height"))


@dataclass(frozen=True)
class DiskLight:
    """A disk that shines to its front, the node's -z.

    Parameters
    ----------
    color, intensity, visible
        As of `RectangleLight`.
    radius : float > 0
    """

    color: Triple = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    radius: float = 0.5
    visible: bool = True
    name: str = ""

    def __post_init__(self) -> None:
        _check(self)
        object.__setattr__(self, "radius", positive(self.radius, "light.radius"))


@dataclass(frozen=True)
class SphereLight:
    """A sphere that shines outwards, in all directions.

    Parameters
    ----------
    color, intensity, visible
        As of `RectangleLight`.
    radius : float > 0
    """

    color: Triple = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    radius: float = 0.5
    visible: bool = True
    name: str = ""

    def __post_init__(self) -> None:
        _check(self)
        object.__setattr__(self, "radius", positive(self.radius, "light.radius"))


AreaLight: TypeAlias = RectangleLight | DiskLight | SphereLight
Light: TypeAlias = PointLight | DirectionalLight | SpotLight | AmbientLight | RectangleLight | DiskLight | SphereLight
