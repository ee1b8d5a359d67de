"""Which numbers a picture can be made by: sides, samples, seeds."""

from __future__ import annotations

from ..errors import SceneError, UnsupportedError
from ..tiles import is_whole

__all__ = ["MAX_PIXELS", "MAX_SAMPLES", "MAX_SIDE", "RENDERERS", "check_counts"]

RENDERERS = ("raster", "ray", "path")
MAX_SIDE = 32768
MAX_PIXELS = 1 << 26
MAX_SAMPLES = 1 << 20


def check_counts(width: int, height: int, renderer: str, samples: int | None, seed: int, max_depth: int, tile_size: int | None) -> None:
    for name, value in (("width", width), ("height", height)):
        if not is_whole(value) or not 1 <= value <= MAX_SIDE:
            raise SceneError(f"{name} must be an integer from 1 to {MAX_SIDE}, got {value!r}")
    if width * height > MAX_PIXELS:
        raise SceneError(f"a picture must not have more than {MAX_PIXELS} pixels, got {width} x {height}")
    if renderer not in RENDERERS:
        raise UnsupportedError(f"renderer must be one of {', '.join(RENDERERS)} (or lines, in limner.render), got {renderer!r}")
    if samples is not None and (not is_whole(samples) or not 1 <= samples <= MAX_SAMPLES):
        raise SceneError(f"samples must be an integer from 1 to {MAX_SAMPLES}, got {samples!r}")
    if not is_whole(seed) or not 0 <= seed < 1 << 63:
        raise SceneError(f"seed must be an integer from 0 to 2^63 - 1, got {seed!r}")
    if not is_whole(max_depth) or not 0 <= max_depth <= 1000:
        raise SceneError(f"max_depth must be an integer from 0 to 1000, got {max_depth!r}")
    if tile_size is not None and (not is_whole(tile_size) or not 8 <= tile_size <= 1024):
        raise SceneError(f"tile_size must be an integer from 8 to 1024, got {tile_size!r}")
