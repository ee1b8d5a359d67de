"""The film: sums of light, and how many samples each part of it has taken.

All samples of a pixel are added in their order, whatever tiles and passes they come in, so that a picture made at once, refined step by
step, or stopped and gone on with, has the same bits. A part that has taken fewer samples than the rest, because the user stopped, is
divided by its own number.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .tiles import Tile, tiles_of

__all__ = ["Film"]


class Film:
    """Sums of premultiplied radiance and alpha.

    Parameters
    ----------
    width, height : int
    tile_size : int
        Side of the parts that are exposed one by one.

    Attributes
    ----------
    sums : (height, width, 4) float32
        Row 0 at the bottom.
    tiles : list of Tile
    taken : (n,) int64
        Samples of each tile.
    """

    def __init__(self, width: int, height: int, tile_size: int) -> None:
        self.sums = np.zeros((height, width, 4), dtype=np.float32)
        self.tiles: list[Tile] = tiles_of(width, height, tile_size)
        self.taken = np.zeros(len(self.tiles), dtype=np.int64)

    def developed(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """The picture so far, (height, width, 4) float32, straight alpha, row 0 on top; and what is wrong with it.

        Pixels that are not finite become black, and are told of with the place of the first.
        """
        pixels = self.sums * self._share()
        alpha = pixels[..., 3:]
        partial = (alpha > 0.0) & (alpha < 1.0)
        if partial.any():
            np.divide(pixels[..., :3], alpha, out=pixels[..., :3], where=partial)
        slips: tuple[str, ...] = ()
        if not np.isfinite(pixels.sum(dtype=np.float64)):
            bad = ~np.isfinite(pixels).all(axis=2)
            if bad.any():
                j, i = (int(k) for k in np.argwhere(bad)[-1])
                place = f"x = {i}, y = {len(pixels) - 1 - j}"
                slips = (f"{int(bad.sum())} pixels are not finite and were made black, the first at {place}",)
                pixels[bad] = 0.0
        return np.ascontiguousarray(pixels[::-1]), slips

    def _share(self) -> NDArray[np.float32] | np.float32:
        """One over the number of samples, of the whole or of each pixel; 0 where there are none."""
        if (self.taken == self.taken[0]).all():
            return np.float32(1.0 / max(int(self.taken[0]), 1))
        shares = np.zeros((*self.sums.shape[:2], 1), dtype=np.float32)
        for tile, taken in zip(self.tiles, self.taken.tolist(), strict=True):
            part = shares[tile.first_row : tile.first_row + tile.rows, tile.first_column : tile.first_column + tile.columns]
            part[...] = 1.0 / taken if taken else 0.0
        return shares
