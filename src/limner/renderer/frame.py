"""A picture that is being made."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..aov import Moments
from ..film import Film
from ..raster.memory import Memory
from ..raytrace import driver
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..tables.build import Built, View
from ..tiles import Tile

__all__ = ["Frame", "Work"]

Work = Callable[[Tile, int, int], object]


class Frame(NamedTuple):
    """A picture that is being made."""

    scene: Scene
    camera: Camera
    built: Built
    view: View
    film: Film
    memory: Memory
    work: Work
    messages: tuple[str, ...]
    stage: driver.Stage | None
    moments: Moments | None
