"""The channels beside the picture: their names, their place in the arrays that kernels fill, and those arrays unfilled.

    of a pixel's centre     depth, normal, albedo, instance_id, …       `limner.shading.aov`
    means over a pixel      denoising_albedo, denoising_normal, denoising_depth      what a denoiser is told (`ray`, `path`)
    of its light            variance, samples                           how sure the picture is of itself (`ray`, `path`)
    parts of its light      direct, indirect, light_groups              which add up to the picture (`path`)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .tables import layouts
from .tables.layouts import SceneTables
from .tiles import Tile

__all__ = [
    "CHANNELS", "FEATURES", "LIGHT", "PASSES", "Moments", "channels", "empty_values", "features_of", "samples_of", "with_solid_blends",
]  # fmt: skip

_FLOATS = {
    "depth": (0, 1), "distance": (1, 1), "normal": (2, 3), "normal_geometric": (5, 3), "position": (8, 3), "uv": (11, 2),
    "albedo": (13, 3),
}  # fmt: skip
_IDS = {"instance_id": 0, "material_id": 1, "triangle_id": 2}

CHANNELS = (*_FLOATS, *_IDS)
"""The names of what is seen in a pixel's centre; see `limner.shading.aov` for what each holds."""

FEATURES = ("denoising_albedo", "denoising_normal", "denoising_depth")
"""Means over a pixel, through mirrors; see `limner.raytrace.features_tile`."""

PASSES = ("direct", "indirect", "light_groups")
"""Parts of the picture's light; the last stands for a channel ``light_NAME`` of each group (`limner.raytrace.light_passes`)."""

LIGHT = ("variance", "samples")
"""Of a pixel's light: the variance of its mean, and how many samples that is of."""


def empty_values(width: int, height: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """(height, width, 16) float32 and (height, width, 3) int32 that see nothing: infinitely far, no normal, no id."""
    values = np.zeros((height, width, 16), dtype=np.float32)
    values[..., 0:2] = np.inf
    return values, np.full((height, width, 3), -1, dtype=np.int32)


def channels(
    wanted: tuple[str, ...], values: NDArray[np.float32], ids: NDArray[np.int32]
) -> dict[str, NDArray[np.float32] | NDArray[np.int32]]:
    """The wanted channels by name, row 0 on top: (height, width) or (height, width, n)."""
    made: dict[str, NDArray[np.float32] | NDArray[np.int32]] = {}
    for name in wanted:
        if name not in CHANNELS:
            continue
        if name in _IDS:
            made[name] = np.ascontiguousarray(ids[::-1, :, _IDS[name]])
        else:
            first, n = _FLOATS[name]
            part = values[::-1, :, first] if n == 1 else values[::-1, :, first : first + n]
            made[name] = np.ascontiguousarray(part)
    return made


def features_of(values: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
    """`FEATURES` by name, row 0 on top, from what the kernel filled: (height, width, 7) float32, row 0 at the bottom.

    Depth is the way to what is seen, in mirrors the whole way; infinity: nothing.
    """
    top = values[::-1]
    with np.errstate(divide="ignore"):
        depth = np.float32(1.0) / top[..., 6]
    return dict(zip(FEATURES, (np.ascontiguousarray(top[..., 0:3]), np.ascontiguousarray(top[..., 3:6]), depth), strict=True))


class Moments:
    """How much a pixel's light differs from one pass of samples to the next: its variance follows from that.

    Parameters
    ----------
    sums : (height, width, 4) float32
        Of a film; looked at after every pass.
    n_tiles : int
    """

    def __init__(self, sums: NDArray[np.float32], n_tiles: int) -> None:
        self._sums = sums
        self._start = np.zeros((*sums.shape[:2], 3), dtype=np.float32)
        self._before = np.zeros_like(self._start)
        self._squares = np.zeros(self._start.shape, dtype=np.float64)
        self._tiles: list[tuple[Tile, int, int] | None] = [None] * n_tiles

    def begin(self) -> None:
        """Begin with the sums as they are now: what they hold came in passes that nobody looked at."""
        self._start[:] = self._sums[..., :3]
        self._before[:] = self._start

    def add(self, tile: Tile, n: int) -> None:
        """Take note of a pass of n samples that was added to a tile of the sums."""
        place = _place(tile)
        now = self._sums[place][..., :3]
        added = now - self._before[place]
        self._squares[place] += added.astype(np.float64) ** 2 / n
        self._before[place] = now
        known = self._tiles[tile.number]
        self._tiles[tile.number] = tile, (known[1] if known else 0) + 1, (known[2] if known else 0) + n

    def variance(self, taken: NDArray[np.int64]) -> NDArray[np.float32]:
        """(height, width, 3) float32, row 0 on top: of the mean of straight colour; 0 where fewer than two passes were looked at.

        ``(sum n_k m_k² - n m²) / (p - 1)`` of p passes with means m_k of n_k samples is the variance of one sample; that of the mean is
        this over how many each tile has taken, `taken` (n,). Samples that are spread more evenly than by chance make the mean better than
        this says.
        """
        made = np.zeros(self._squares.shape, dtype=np.float64)
        for entry in self._tiles:
            if entry is None or entry[1] < 2:
                continue
            tile, passes, n = entry
            place, total = _place(tile), int(taken[tile.number])
            added = (self._sums[place][..., :3] - self._start[place]).astype(np.float64)
            alpha = self._sums[place][..., 3:].astype(np.float64) / total
            spread = self._squares[place] - added**2 / n
            partial = np.where((alpha > 0.0) & (alpha < 1.0), alpha, 1.0)
            made[place] = np.maximum(spread, 0.0) / ((passes - 1) * total) / partial**2
        return np.ascontiguousarray(made[::-1], dtype=np.float32)


def samples_of(tiles: list[Tile], taken: NDArray[np.int64]) -> NDArray[np.int32]:
    """(height, width) int32, row 0 on top: how many samples each pixel has taken, from those of each tile."""
    height = max(tile.first_row + tile.rows for tile in tiles)
    made = np.zeros((height, max(tile.first_column + tile.columns for tile in tiles)), dtype=np.int32)
    for tile in tiles:
        made[_place(tile)] = taken[tile.number]
    return np.ascontiguousarray(made[::-1])


def _place(tile: Tile) -> tuple[slice, slice]:
    return slice(tile.first_row, tile.first_row + tile.rows), slice(tile.first_column, tile.first_column + tile.columns)


def with_solid_blends(tables: SceneTables) -> SceneTables:
    """The same scene with blended materials cut out where their alpha is below one half, and glass as solid as it feels."""
    blended = tables.materials["alpha_mode"] == layouts.BLEND
    if not blended.any():
        return tables
    materials = tables.materials.copy()
    materials["alpha_mode"][blended] = layouts.MASK
    materials["alpha_cutoff"][blended] = 0.5
    seen = (materials["kind"] == layouts.DIELECTRIC) | (materials["layers"] & layouts.SOLID != 0)
    materials["alpha_mode"][seen] = layouts.OPAQUE
    return tables._replace(materials=materials)
