"""The channels beside the picture: what each pixel shows, how sure it is, and its light in parts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..aov import CHANNELS, FEATURES, PASSES, channels, empty_values, features_of, samples_of, with_solid_blends
from ..film import Film
from ..raster import pipeline
from ..raytrace import driver
from ..raytrace.light_passes import group_names, lit_by
from ..samples import pixel_samples
from ..tiles import run_all
from .choices import Choices
from .frame import Frame
from .prepare import settings_of

__all__ = ["channels_beside"]

_FEATURE_SAMPLES = 16


def channels_beside(choices: Choices, frame: Frame) -> dict[str, NDArray[Any]]:
    """Everything that is kept beside a picture whose film has been exposed, by name."""
    return {
        **_centre_channels(choices, frame),
        **_features(choices, frame),
        **_light_channels(choices, frame),
        **_passes(choices, frame),
    }


def _passes(choices: Choices, frame: Frame) -> dict[str, NDArray[Any]]:
    """The picture's light in parts, as straight colour."""
    made: dict[str, NDArray[Any]] = {}
    wanted, stage = set(choices.aovs) & set(PASSES), frame.stage
    if not wanted or stage is None:
        return made
    settings = settings_of(choices)
    if wanted & {"direct", "indirect"}:
        whole, _ = frame.film.developed(choices.threads)
        direct = _part(choices, frame.film, stage, settings._replace(max_depth=min(settings.max_depth, 1)))
        made |= {"direct": direct, "indirect": whole[..., :3] - direct}
    if "light_groups" in wanted:
        for name in group_names(stage, frame.scene):
            made[f"light_{name}"] = _part(choices, frame.film, lit_by(stage, frame.scene, name), settings)
    return {name: values for name, values in made.items() if name in wanted or name.startswith("light_")}


def _part(choices: Choices, whole: Film, stage: driver.Stage, settings: driver.Settings) -> NDArray[np.float32]:
    """(height, width, 3) float32: the picture of a stage by the samples that the whole picture has taken."""
    film = Film(choices.width, choices.height, choices.tile_size)
    work = driver.prepare_paths(stage, settings, film.sums)
    run_all(lambda tile: film.expose(tile, work, 0, int(whole.taken[tile.number])), film.tiles, choices.threads)
    return np.ascontiguousarray(film.developed(choices.threads)[0][..., :3])


def _features(choices: Choices, frame: Frame) -> dict[str, NDArray[Any]]:
    """What denoisers are told."""
    if frame.stage is None or not set(FEATURES) & set(choices.beside):
        return {}
    values = np.zeros((choices.height, choices.width, 7), dtype=np.float32)
    places = pixel_samples(min(choices.samples, _FEATURE_SAMPLES))
    driver.draw_features(frame.stage, values, places, choices.seed, threads=choices.threads, tile_size=choices.tile_size)
    return {name: channel for name, channel in features_of(values).items() if name in choices.beside}


def _light_channels(choices: Choices, frame: Frame) -> dict[str, NDArray[Any]]:
    """How sure the picture is of itself."""
    made: dict[str, NDArray[Any]] = {}
    if frame.moments is not None:
        made["variance"] = frame.moments.variance(frame.film.taken)
    if "samples" in choices.beside:
        made["samples"] = samples_of(frame.film.tiles, frame.film.taken)
    return made


def _centre_channels(choices: Choices, frame: Frame) -> dict[str, NDArray[Any]]:
    """What one look through the middle of each pixel finds."""
    if not set(choices.aovs) & set(CHANNELS):
        return {}
    values, ids = empty_values(choices.width, choices.height)
    tables = with_solid_blends(frame.built.tables)
    if choices.is_raster:
        pipeline.draw_channels(
            tables, frame.view, values, ids, threads=choices.threads, tile_size=choices.tile_size,
            hidden_surfaces=choices.hidden_surfaces, clipping=choices.clipping, culling=choices.culling,
        )  # fmt: skip
    else:
        driver.draw_channels(tables, frame.view, values, ids, threads=choices.threads, tile_size=choices.tile_size)
    return channels(choices.aovs, values, ids)
