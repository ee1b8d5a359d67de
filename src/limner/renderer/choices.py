"""What a Renderer was told, checked and completed: one line for people where it cannot be, before anything is drawn."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import NamedTuple

from ..aov import CHANNELS, FEATURES, LIGHT, PASSES
from ..budget import BLOCK, Budget
from ..errors import SceneError, UnsupportedError
from ..image.denoise import GUIDES, checked_denoiser
from ..image.reconstruct import FILTERS
from ..kernel.sampler_kinds import SAMPLERS
from ..raster import pipeline
from ..raster.layouts import PER_FRAGMENT, PER_TRIANGLE, PER_VERTEX
from ..raster.pipeline import CULLINGS
from ..tiles import thread_count
from .ending import checked_budget
from .limits import check_counts
from .moment import Moment, checked_moment, checked_shutter

__all__ = ["AOVS", "FREQUENCIES", "Choices", "chosen"]

AOVS = (*CHANNELS, *FEATURES, *LIGHT, *PASSES)
FREQUENCIES = {"fragment": PER_FRAGMENT, "vertex": PER_VERTEX, "flat": PER_TRIANGLE}
_MOST_SAMPLES = {"noise": 4096, "time": 1 << 16}
_DEFAULT_SAMPLES = {"raster": 8, "ray": 8, "path": 64}
_TILE_SIZE = {"raster": pipeline.TILE_SIZE, "ray": 32, "path": 32}
_SAMPLES_AT_ONCE = {"raster": 8, "ray": 8, "path": 4}
_LEAST_PASSES = 16  # where variance is asked for


class Choices(NamedTuple):
    """What pictures are made by; the fields are the parameters of `limner.render`, with nothing left open."""

    width: int
    height: int
    renderer: str
    samples: int
    seed: int
    max_depth: int
    shadows: bool
    sampler: str | None
    glossy: bool
    emitters: bool
    tinted_shadows: bool
    shutter: tuple[float, float]
    moment: Moment | None
    multisample: int
    shading: str
    hidden_surfaces: str
    clipping: str
    culling: str
    filter: str
    threads: int
    tile_size: int
    aovs: tuple[str, ...]
    denoise: str | None
    default_lights: bool
    budget: Budget | None

    @property
    def is_raster(self) -> bool:
        """Whether the pipeline draws, not rays."""
        return self.renderer == "raster"

    @property
    def at_once(self) -> int:
        """Samples of a pass, so few that a stop is soon heard."""
        return _SAMPLES_AT_ONCE[self.renderer]

    @property
    def step(self) -> int:
        """Samples of a pass where the passes are what a variance is made of."""
        return max(1, min(self.at_once, self.samples // _LEAST_PASSES)) if "variance" in self.beside else self.at_once

    @property
    def beside(self) -> tuple[str, ...]:
        """The channels that are asked for, and those that a denoiser needs."""
        needed = GUIDES if self.denoise is not None else ()
        return (*self.aovs, *(name for name in needed if name not in self.aovs and (name != "variance" or self.samples > 1)))

    def showing(self, shutter: tuple[float, float] | None, time: float | None, animation: str | int | None) -> Choices:
        """The same, of another moment."""
        return self._replace(
            shutter=checked_shutter(shutter, self.renderer, time), moment=checked_moment(shutter, time, animation)
        )


def chosen(
    *,
    width: int,
    height: int,
    renderer: str,
    samples: int | None,
    seed: int,
    max_depth: int,
    shadows: bool | None,
    sampler: str | None,
    glossy: bool,
    emitters: bool,
    tinted_shadows: bool | None,
    shutter: tuple[float, float] | None,
    time: float | None,
    animation: str | int | None,
    antialiasing: str,
    shading: str,
    hidden_surfaces: str,
    clipping: str,
    culling: str,
    filter: str,
    threads: int | None,
    tile_size: int | None,
    aovs: Iterable[str],
    denoise: str | None,
    default_lights: bool,
    noise: float | None,
    time_limit: float | None,
    checkpoint: str | os.PathLike[str] | None,
    checkpoint_seconds: float,
    resume: bool,
    on_snapshot: object,
) -> Choices:
    """Check what a Renderer is told, and decide what was left open.

    Raises
    ------
    SceneError, UnsupportedError
    """
    check_counts(width, height, renderer, samples, seed, max_depth, tile_size)
    budget = checked_budget(renderer, sampler, noise, time_limit, checkpoint, checkpoint_seconds, resume, on_snapshot)
    if samples is None:
        is_open = noise is not None or time_limit is not None
        samples = _MOST_SAMPLES["noise" if noise is not None else "time"] if is_open else _DEFAULT_SAMPLES[renderer]
    _check_pipeline(antialiasing, shading, hidden_surfaces, clipping)
    sampler, shutter_times = _checked_sampler(sampler, renderer), checked_shutter(shutter, renderer, time)
    moment = checked_moment(shutter, time, animation)
    _check_seen(renderer, culling, filter)
    n_threads = thread_count(threads)
    if noise is not None:
        tile_size = BLOCK  # what is decided block by block must not depend on tiles
    wanted, cleaner = _wanted_aovs(aovs), _checked_denoiser(denoise, renderer)
    _check_beside(wanted, renderer, int(samples))
    return Choices(
        width=int(width), height=int(height), renderer=renderer, samples=int(samples), seed=int(seed), max_depth=int(max_depth),
        shadows=renderer != "raster" if shadows is None else bool(shadows), sampler=sampler, glossy=bool(glossy), emitters=bool(emitters),
        tinted_shadows=renderer == "ray" if tinted_shadows is None else bool(tinted_shadows), shutter=shutter_times, moment=moment,
        multisample=_SAMPLES_AT_ONCE["raster"] if antialiasing == "multisample" and renderer == "raster" else 0, shading=shading,
        hidden_surfaces=hidden_surfaces, clipping=clipping, culling=culling, filter=filter, threads=n_threads,
        tile_size=_TILE_SIZE[renderer] if tile_size is None else int(tile_size), aovs=wanted, denoise=cleaner,
        default_lights=bool(default_lights), budget=budget,
    )  # fmt: skip


def _check_pipeline(antialiasing: str, shading: str, hidden_surfaces: str, clipping: str) -> None:
    if antialiasing not in ("supersample", "multisample"):
        raise UnsupportedError(f'antialiasing must be "supersample" or "multisample", got {antialiasing!r}')
    if shading not in FREQUENCIES:
        raise UnsupportedError(f"shading must be one of {', '.join(FREQUENCIES)}, got {shading!r}")
    if hidden_surfaces not in ("zbuffer", "painter"):
        raise UnsupportedError(f'hidden_surfaces must be "zbuffer" or "painter", got {hidden_surfaces!r}')
    if clipping not in ("homogeneous", "world"):
        raise UnsupportedError(f'clipping must be "homogeneous" or "world", got {clipping!r}')


def _check_seen(renderer: str, culling: str, filter: str) -> None:
    if culling not in CULLINGS:
        raise UnsupportedError(f"culling must be one of {', '.join(CULLINGS)}, got {culling!r}")
    if filter not in FILTERS:
        raise UnsupportedError(f"filter must be one of {', '.join(FILTERS)}, got {filter!r}")
    if filter != "box" and renderer != "raster":
        raise UnsupportedError(f'the {renderer} renderer has the filter "box" only, got {filter!r}; renderer="raster" has all')


def _checked_sampler(sampler: str | None, renderer: str) -> str | None:
    if sampler is None:
        return None
    if sampler not in SAMPLERS:
        raise UnsupportedError(f"sampler must be one of {', '.join(SAMPLERS)}, got {sampler!r}")
    if renderer == "raster":
        raise UnsupportedError(f"raster has one pattern of samples for all pixels; ray and path can have the sampler {sampler!r}")
    return sampler


def _wanted_aovs(aovs: Iterable[str]) -> tuple[str, ...]:
    if isinstance(aovs, str) or not isinstance(aovs, Iterable):
        raise UnsupportedError(f'aovs must be names, as in ("depth", "normal"), got {aovs!r}')
    wanted = tuple(dict.fromkeys(aovs))
    for name in wanted:
        if name not in AOVS:
            raise UnsupportedError(f"aov must be one of {', '.join(AOVS)}, got {name!r}")
    return wanted


def _checked_denoiser(denoise: str | None, renderer: str) -> str | None:
    if denoise is None:
        return None
    if renderer == "raster":
        raise UnsupportedError("raster makes no noise to take out; ray and path can have denoise")
    return checked_denoiser(denoise)


def _check_beside(aovs: tuple[str, ...], renderer: str, samples: int) -> None:
    """Refuse channels that a renderer does not have."""
    beyond = [name for name in aovs if name in FEATURES or name in LIGHT]
    if beyond and renderer == "raster":
        raise UnsupportedError(f"raster has no channel {beyond[0]}; ray and path have")
    parts = [name for name in aovs if name in PASSES]
    if parts and renderer != "path":
        raise UnsupportedError(f"{renderer} has no channel {parts[0]}; path has")
    if "variance" in beyond and samples < 2:
        raise SceneError(f"the channel variance needs 2 samples or more, got {samples}")
