"""What a picture says about how it was made: enough to make it again."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from ..image.recipe import Recipe
from ..scene.scene import Scene
from .choices import Choices
from .frame import Frame

__all__ = ["key_of", "recipe_of"]


def recipe_of(choices: Choices, frame: Frame, samples: int, *, finished: bool) -> Recipe:
    from .. import __version__

    values: dict[str, Any] = {
        "limner": __version__,
        "renderer": choices.renderer,
        "width": choices.width,
        "height": choices.height,
        "samples": samples,
        "seed": choices.seed,
        "max_depth": choices.max_depth,
        "shadows": choices.shadows,
        "sampler": choices.sampler,
        "glossy": choices.glossy,
        "emitters": choices.emitters,
        "tinted_shadows": choices.tinted_shadows,
        "shutter": list(choices.shutter),
        "time": None if choices.moment is None else choices.moment[0],
        "animation": None if choices.moment is None else choices.moment[1],
        "antialiasing": "multisample" if choices.multisample else "supersample",
        "shading": choices.shading,
        "hidden_surfaces": choices.hidden_surfaces,
        "clipping": choices.clipping,
        "culling": choices.culling,
        "filter": choices.filter,
        "denoise": choices.denoise,
        "default_lights": choices.default_lights,
        "camera": _plain(frame.camera),
    }
    if choices.budget is not None and choices.budget.noise is not None:
        values["noise"] = choices.budget.noise
    if not finished:
        values["finished"] = False
    scene = frame.scene
    return Recipe(values, {"scene": lambda: _digest(scene)})


def key_of(choices: Choices, frame: Frame) -> str:
    """Of which picture a checkpoint is; how many samples it will have at last is not told by the samplers that do not care."""
    if choices.budget is None or choices.budget.checkpoint is None:
        return ""
    told = dict(recipe_of(choices, frame, 0, finished=True))
    samples = 0 if choices.sampler in (None, "sobol", "random") else choices.samples
    return json.dumps({**told, "samples": samples, "tile_size": choices.tile_size}, sort_keys=True)


def _digest(scene: Scene) -> str:
    """What a recipe says about the scene; the camera stands beside it."""
    from ..scene.digest import scene_digest

    return scene_digest(scene.replace(camera=None))


def _plain(value: Any) -> Any:
    """A camera or what it holds as plain values, as a recipe can keep them."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    return {key: _plain(held) for key, held in vars(value).items()} if hasattr(value, "__dict__") else value
