"""The film: sums of light, and how many samples each part of it has taken.

All samples of a pixel are added in their order, whatever tiles and passes they come in, so that a picture made at once, refined step by
step, or stopped and gone on with, has the same bits. A part that has taken fewer samples than the rest, because the user stopped, is
divided by its own number.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ._door import Array, Door, Scalar, Signature
from .color.transfer import srgb_codes
from .tiles import Tile, run_all, tiles_of

__all__ = ["Film"]

_ROWS: Signature = (Array(np.float32, 3), Array(np.float32, 1), *[Scalar(np.int64)] * 4)
_DEVELOP = Door("limner.film_kernel", "develop_rows", (*_ROWS, Array(np.float32, 3), Array(np.int64, 1)), "developing")
_ENCODE = Door(
    "limner.film_kernel",
    "encode_rows",
    (*_ROWS, Array(np.uint16, 1), Array(np.float32, 1), Array(np.uint8, 3), Array(np.int64, 1)),
    "developing for screens",
)


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
        self._tile_size = tile_size
        self.sums = np.zeros((height, width, 4), dtype=np.float32)
        self.tiles: list[Tile] = tiles_of(width, height, tile_size)
        self.taken = np.zeros(len(self.tiles), dtype=np.int64)

    def developed(self, threads: int = 1) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """The picture so far, (height, width, 4) float32, straight alpha, row 0 on top; and what is wrong with it.

        Pixels that are not finite become black, and are told of with the place of one of them.
        """
        pixels = np.empty_like(self.sums)
        bad = np.zeros(len(self.sums), dtype=np.int64)
        run_all(lambda rows: _DEVELOP(self.sums, *self._shares(), *rows, pixels, bad), self._bands(), threads)
        return pixels, self._slips(bad)

    def encoded(self, threads: int = 1) -> tuple[NDArray[np.uint8], tuple[str, ...]]:
        """The same as a screen wants it, (height, width, 4) uint8: what `Image.to_uint8` makes of it, at once."""
        encoded = np.empty(self.sums.shape, dtype=np.uint8)
        bad = np.zeros(len(self.sums), dtype=np.int64)
        table = srgb_codes()
        run_all(lambda rows: _ENCODE(self.sums, *self._shares(), *rows, table.code, table.change, encoded, bad), self._bands(), threads)
        return encoded, self._slips(bad)

    def _bands(self) -> list[tuple[int, int]]:
        height = len(self.sums)
        step = max(16, -(-height // 8))
        return [(first, min(first + step, height)) for first in range(0, height, step)]

    def _shares(self) -> tuple[NDArray[np.float32], int, int]:
        """One over the number of samples of each tile, 0 where there are none; the side of a tile, and tiles in a row."""
        shares = (1.0 / np.maximum(self.taken, 1)).astype(np.float32)
        shares[self.taken == 0] = 0.0
        return shares, self._tile_size, -(-self.sums.shape[1] // self._tile_size)

    def _slips(self, bad: NDArray[np.int64]) -> tuple[str, ...]:
        total = int(bad.sum())
        if not total:
            return ()
        j = int(np.flatnonzero(bad)[-1])
        i = int(np.flatnonzero(~np.isfinite(self.sums[j]).all(axis=1))[0]) if not np.isfinite(self.sums[j]).all() else 0
        return (f"{total} pixels are not finite and were made black, the first at x = {i}, y = {len(bad) - 1 - j}",)
