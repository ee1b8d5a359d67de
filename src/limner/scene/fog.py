"""Fog: air in which what stands far off fades away."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import SceneError
from ._values import Triple, finite, triple

__all__ = ["Fog"]


@dataclass(frozen=True)
class Fog:
    """Even fog wherever nothing else is: after d metres, ``exp(-density d)`` of what lies behind is seen, the rest is fog.

    It dims what is seen, straight, in mirrors or through glass, not the light that falls on surfaces. For `ray` and `path`. Fog that
    fills a shape is a `Dielectric` of `ior` 1 with absorption and haze.

    Parameters
    ----------
    color : three floats >= 0
        Radiance of fog so thick that nothing is seen but fog.
    density : float >= 0
        Per metre: at ``1 / density`` metres, 37 % is left.
    """

    color: Triple = (0.7, 0.75, 0.8)
    density: float = 0.05

    def __post_init__(self) -> None:
        object.__setattr__(self, "color", triple(self.color, "fog.color", minimum=0.0))
        density = finite(self.density, "fog.density")
        if density < 0.0:
            raise SceneError(f"fog.density must not be negative, got {density}")
        object.__setattr__(self, "density", density)
