"""The film: sums of light, and how many samples each part of it has taken.

All samples of a pixel are added in their order, whatever tiles and passes they come in, so that a picture made at once, refined step by
step, or stopped and gone on with, has the same bits. A part that has taken fewer samples than the rest, because the user stopped, is
divided by its own number. A film can be used again: what the last picture left is wiped off part by part, when it is in the way.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._door import Array, Door, Scalar, Signature
from .color.transfer import srgb_codes
from .tiles import Tile, run_all, tiles_of

__all__ = ["ENCODING", "Film", "not_encoded"]

_SUMS, _BAD, _WIDTH, _SHARE = Array(np.float32, 2), Array(np.int64, 1), Scalar(np.int64), Scalar(np.float32)
_TILE: Signature = (Scalar(np.int64),) * 5
_CLEAR = Door("limner.film_kernel", "clear_tile", (_SUMS, _WIDTH, *_TILE), "clearing")
_DEVELOP = Door("limner.film_kernel", "develop_tile", (_SUMS, Array(np.float32, 1), _BAD, _WIDTH, _SHARE, *_TILE), "developing")
_ENCODE = Door(
    "limner.film_kernel",
    "encode_tile",
    (_SUMS, Array(np.int32, 1), Array(np.float32, 1), Array(np.int32, 1), _BAD, _WIDTH, _SHARE, *_TILE),
    "developing for screens",
)

ENCODING: Signature = (Array(np.int32, 1), Array(np.float32, 1), Array(np.int32, 1), _BAD, _SHARE)
"""What a kernel needs that makes bytes of its sums itself: codes, changes, the bytes, what was bad, and one over the number of samples."""


def not_encoded() -> tuple[Any, ...]:
    """`ENCODING` where the sums go to the film."""
    none = np.zeros(0, dtype=np.int32)
    return none, np.zeros(0, dtype=np.float32), none, np.zeros(0, dtype=np.int64), 1.0


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
    on_exposed : callable, optional
        Takes a tile and the number of samples that it has just been given.
    """

    def __init__(self, width: int, height: int, tile_size: int) -> None:
        self.sums = np.zeros((height, width, 4), dtype=np.float32)
        self.tiles: list[Tile] = tiles_of(width, height, tile_size)
        self.taken = np.zeros(len(self.tiles), dtype=np.int64)
        self.on_exposed: Callable[[Tile, int], None] | None = None
        self._exposed = [False] * len(self.tiles)
        self._cleared: Callable[..., None] | None = None

    def expose(self, tile: Tile, work: Callable[[Tile, int, int], object], first: int, last: int) -> None:
        """Add samples first..last to a tile by `work`, which returns False where there was nothing to add."""
        if first == 0 and self._exposed[tile.number]:
            self._clear(*tile)
            self._exposed[tile.number] = False
        if work(tile, first, last) is not False:
            self._exposed[tile.number] = True
        self.taken[tile.number] = last
        if self.on_exposed is not None:
            self.on_exposed(tile, last - first)

    def restore(self, sums: NDArray[np.float32], taken: NDArray[np.int64]) -> None:
        """Go on from the sums and samples that another film of the same size and tiles had."""
        self.sums[:], self.taken[:] = sums, taken
        self._exposed = [True] * len(self.tiles)

    def _clear(self, *tile: int) -> None:
        if self._cleared is None:
            self._cleared = _CLEAR.bind(self.sums.reshape(-1, 4), self.sums.shape[1])
        self._cleared(*tile)

    def developing(self) -> tuple[NDArray[np.float32], Callable[[Tile], None], NDArray[np.int64]]:
        """The picture, (height, width, 4) float32, straight alpha, row 0 on top, yet to be filled; what fills a tile; what was bad.

        The last is how many pixels of each tile are not finite and became black.
        """
        pixels = np.zeros_like(self.sums)
        return pixels, *self._by(_DEVELOP, pixels.reshape(-1))

    def encoding(self) -> tuple[NDArray[np.uint8], Callable[[Tile], None], NDArray[np.int64]]:
        """The same as a screen wants it, (height, width, 4) uint8: what `Image.to_uint8` makes of it, at once."""
        words = np.zeros(self.sums.shape[:2], dtype=np.int32)
        table = srgb_codes()
        return words.view(np.uint8).reshape(self.sums.shape), *self._by(_ENCODE, table.code, table.change, words.reshape(-1))

    def encoding_at_once(self, samples: int) -> tuple[NDArray[np.uint8], NDArray[np.int64], tuple[Any, ...]]:
        """The same for who encodes a tile as soon as all its samples are there: the picture, what was bad, and `ENCODING`."""
        words = np.zeros(self.sums.shape[:2], dtype=np.int32)
        bad, table = np.zeros(len(self.tiles), dtype=np.int64), srgb_codes()
        pixels = words.view(np.uint8).reshape(self.sums.shape)
        return pixels, bad, (table.code, table.change, words.reshape(-1), bad, 1.0 / samples)

    def _by(self, door: Door, *arrays: NDArray[np.generic]) -> tuple[Callable[[Tile], None], NDArray[np.int64]]:
        bad = np.zeros(len(self.tiles), dtype=np.int64)
        develop = door.bind(self.sums.reshape(-1, 4), *arrays, bad, self.sums.shape[1])

        def fill(tile: Tile) -> None:
            if self._exposed[tile.number]:
                develop(1.0 / max(int(self.taken[tile.number]), 1), *tile)

        return fill, bad

    def developed(self, threads: int = 1) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """The picture so far, (height, width, 4) float32, straight alpha, row 0 on top; and what is wrong with it.

        Pixels that are not finite become black, and are told of with the place of one of them.
        """
        pixels, fill, bad = self.developing()
        run_all(fill, self.tiles, threads)
        return pixels, self.slips(bad)

    def encoded(self, threads: int = 1) -> tuple[NDArray[np.uint8], tuple[str, ...]]:
        """The same as a screen wants it, (height, width, 4) uint8."""
        encoded, fill, bad = self.encoding()
        run_all(fill, self.tiles, threads)
        return encoded, self.slips(bad)

    def slips(self, bad: NDArray[np.int64]) -> tuple[str, ...]:
        """What is wrong with a picture, in words."""
        total = int(bad.sum())
        if not total:
            return ()
        rows, columns, _ = np.nonzero(~np.isfinite(self.sums[::-1]))
        place = f", the first at x = {columns[0]}, y = {rows[0]}" if len(rows) else ""
        return (f"{total} pixels are not finite and were made black{place}",)
