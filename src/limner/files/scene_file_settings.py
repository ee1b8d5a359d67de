"""What a scene file may say about how its picture is made: the settings of `limner.render`, each with what it may be.

They stand here a second time because reading a file must not load the renderers; a test holds both to each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["Settings"]


@dataclass(frozen=True)
class Settings:
    """How a picture is made; None: as `limner.render` has it."""

    renderer: Literal["raster", "ray", "path"] | None = None
    width: int | None = None
    height: int | None = None
    samples: int | None = None
    seed: int | None = None
    noise: float | None = None
    time_limit: float | None = None
    max_depth: int | None = None
    shadows: bool | None = None
    sampler: Literal["regular", "random", "jittered", "multijittered", "halton", "sobol"] | None = None
    glossy: bool | None = None
    emitters: bool | None = None
    tinted_shadows: bool | None = None
    shutter: tuple[float, float] | None = None
    time: float | None = None
    animation: str | int | None = None
    antialiasing: Literal["multisample", "supersample"] | None = None
    shading: Literal["fragment", "vertex", "flat"] | None = None
    hidden_surfaces: Literal["zbuffer", "painter"] | None = None
    clipping: Literal["homogeneous", "world"] | None = None
    culling: Literal["material", "back", "front", "none"] | None = None
    filter: Literal["box", "tent", "gaussian", "mitchell", "lanczos3"] | None = None
    aovs: tuple[str, ...] | None = None
    denoise: Literal["filter", "oidn"] | None = None
    default_lights: bool | None = None
