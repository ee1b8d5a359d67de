"""What a command line puts round a model: a sky, a background, a ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .values import Background

if TYPE_CHECKING:
    from ..scene.scene import Scene

__all__ = ["surrounded"]


def surrounded(scene: Scene, environment: str | None, background: Background | None = None, *, ground: bool = False) -> Scene:
    """The scene under the sky of a file, before a background, on a ground; None: as the model has it."""
    if environment is not None:
        from ..scene.environment import Environment

        scene = scene.replace(environment=Environment(environment))
    if background is not None:
        scene = scene.replace(background=None if background == "transparent" else background)
    return scene.with_ground() if ground else scene
