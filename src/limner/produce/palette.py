"""256 colours for a whole clip: what a GIF can show.

One palette serves all pictures, so that nothing flickers where nothing moves. Colours are divided where they differ most, then every
one moves into the middle of what it stands for. What a picture shows of one model differs by less than a level from it; what has
wide gradients, such as a sky, would show steps, and is dithered with a pattern that stands still.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..image.blue_noise import SIDE, blue_noise

__all__ = ["Palette", "Tally", "fitted"]

N_COLORS = 255  # the last is left for "as before"

_ROUNDS = 8  # of moving into the middle; more change less than rounding
_LARGE = 1 << 17  # pixels: of larger pictures, every second column and row is enough to know the colours
_MOST_KEPT = 1 << 20  # distinct colours that are kept apart; beyond them, they are counted in twos
_NOTICED = 0.6  # mean error, in levels, from which steps are seen
_SPREAD = 7.0  # of the dither's pattern, in mean errors

Bytes = NDArray[np.uint8]
Codes = NDArray[np.int64]
Floats = NDArray[np.float64]


def _codes(picture: Bytes) -> Codes:
    """(...) int64: red, green and blue in one number."""
    wide = picture.astype(np.int64)
    return wide[..., 0] << 16 | wide[..., 1] << 8 | wide[..., 2]


def _colors(codes: Codes) -> Floats:
    return np.stack([codes >> 16, codes >> 8 & 255, codes & 255], axis=-1).astype(np.float64)


class Tally:
    """Which colours a clip has, and how often: counted picture by picture in bounded memory.

    >>> tally = Tally()
    >>> tally.add(np.zeros((4, 4, 3), dtype=np.uint8))
    >>> tally.colors.tolist(), tally.counts.tolist()
    ([[0.0, 0.0, 0.0]], [16.0])
    """

    def __init__(self) -> None:
        self._codes: Codes = np.zeros(0, dtype=np.int64)
        self._counts: Floats = np.zeros(0)

    def add(self, picture: Bytes) -> None:
        """Count the colours of a picture, (height, width, 3) uint8."""
        step = 2 if picture.shape[0] * picture.shape[1] > _LARGE else 1
        found, counts = np.unique(_codes(picture[::step, ::step]), return_counts=True)
        self._codes, place = np.unique(np.concatenate([self._codes, found]), return_inverse=True)
        self._counts = np.bincount(place, np.concatenate([self._counts, counts])).astype(np.float64)
        if len(self._codes) > _MOST_KEPT:
            self._codes, self._counts = _coarser(self._codes, self._counts)

    @property
    def colors(self) -> Floats:
        """(n, 3) float64, 0 to 255."""
        return _colors(self._codes)

    @property
    def counts(self) -> Floats:
        """(n,) float64."""
        return self._counts


def _coarser(codes: Codes, counts: Floats) -> tuple[Codes, Floats]:
    """Two levels of each channel become one."""
    merged, place = np.unique(codes & 0xFEFEFE, return_inverse=True)
    return merged, np.bincount(place, counts).astype(np.float64)


class Palette(NamedTuple):
    """Colours, and how pictures are shown with them.

    Attributes
    ----------
    colors : (n, 3) uint8
        At most 255.
    spread : float
        Of the dither, in levels; 0: none.
    nearest : (2^24,) uint8
        For each colour that was met, the nearest one's place.
    met : (2^24,) bool
    """

    colors: Bytes
    spread: float
    nearest: Bytes
    met: NDArray[np.bool_]

    def indices(self, picture: Bytes) -> Bytes:
        """(height, width) uint8: the places of the colours that stand for those of a (height, width, 3) picture."""
        plain = self._nearest(picture)
        if not self.spread:
            return plain
        height, width = picture.shape[:2]
        tiles = -(-height // SIDE), -(-width // SIDE)
        pattern = (np.tile(blue_noise(), tiles)[:height, :width, None] + 0.5) / SIDE**2 - 0.5
        moved = np.clip(np.rint(picture + self.spread * pattern), 0.0, 255.0).astype(np.uint8)
        exact = (self.colors[plain] == picture).all(axis=2)  # what the palette has needs no help: a white ground stays white
        return np.where(exact, plain, self._nearest(moved))

    def _nearest(self, picture: Bytes) -> Bytes:
        codes = _codes(picture)
        new = np.unique(codes)
        new = new[~self.met[new]]
        colors = self.colors.astype(np.float64)
        for start in range(0, len(new), 1 << 16):
            part = new[start : start + (1 << 16)]
            self.nearest[part] = ((colors**2).sum(axis=1) - 2.0 * _colors(part) @ colors.T).argmin(axis=1)
        self.met[new] = True
        return self.nearest[codes]


def fitted(tally: Tally, n: int = N_COLORS) -> Palette:
    """Choose the colours for what was counted.

    Parameters
    ----------
    tally : Tally
    n : int
        Colours at most; where there are no more, all of them are in the palette as they are.

    Notes
    -----
    A colour counts with the root of its number: the eye asks for the small and the rare, too.

    **Source**: Wan, Wong and Prusinkiewicz, *An algorithm for multidimensional data clustering*, 1988 (the box that varies most is
    divided at its mean); Lloyd, *Least squares quantization in PCM*, 1982.
    """
    colors, counts = tally.colors, tally.counts
    error = 0.0
    chosen = colors
    if len(colors) > n:
        weights = np.sqrt(counts)
        chosen = _settled(colors, weights, _divided(colors, weights, n))
        chosen = _with_ground(chosen, colors[counts.argmax()])
        error = _mean_error(colors, counts, chosen)
    spread = _SPREAD * error if error > _NOTICED else 0.0
    return Palette(np.rint(chosen).astype(np.uint8), spread, np.zeros(1 << 24, np.uint8), np.zeros(1 << 24, np.bool_))


def _divided(colors: Floats, weights: Floats, n: int) -> Floats:
    """(n, 3): the means of boxes, of which always the one that varies most is divided at its mean."""
    boxes = [np.arange(len(colors))]
    varied = [_variation(colors, weights)]
    while len(boxes) < n:
        widest = int(np.argmax([float(v.max()) for v in varied]))
        if not varied[widest].max() > 0.0:
            break
        box, axis = boxes[widest], int(varied[widest].argmax())
        along = colors[box, axis]
        below = along <= np.average(along, weights=weights[box])
        boxes[widest : widest + 1] = [box[below], box[~below]]
        varied[widest : widest + 1] = [_variation(colors[part], weights[part]) for part in boxes[widest : widest + 2]]
    return np.array([np.average(colors[box], axis=0, weights=weights[box]) for box in boxes])


def _variation(colors: Floats, weights: Floats) -> Floats:
    """(3,): the weighted sum of squares about the mean, by channel."""
    mean = np.average(colors, axis=0, weights=weights)
    return weights @ (colors - mean) ** 2


def _settled(colors: Floats, weights: Floats, centers: Floats) -> Floats:
    """Move each centre into the mean of what is nearest to it, a few times."""
    for _ in range(_ROUNDS):
        owner = _owners(colors, centers)
        mass = np.bincount(owner, weights, minlength=len(centers))
        sums = [np.bincount(owner, weights * colors[:, channel], minlength=len(centers)) for channel in range(3)]
        held = mass > 0.0
        centers = centers.copy()
        centers[held] = np.stack(sums, axis=1)[held] / mass[held, None]
    return centers


def _with_ground(centers: Floats, ground: Floats) -> Floats:
    """The commonest colour is the background: it has to be exact."""
    centers = centers.copy()
    centers[int(((centers - ground) ** 2).sum(axis=1).argmin())] = ground
    return centers


def _owners(colors: Floats, centers: Floats) -> NDArray[np.intp]:
    parts = [colors[start : start + (1 << 16)] for start in range(0, len(colors), 1 << 16)]
    return np.concatenate([((centers**2).sum(axis=1) - 2.0 * part @ centers.T).argmin(axis=1) for part in parts])


def _mean_error(colors: Floats, counts: Floats, centers: Floats) -> float:
    off = np.abs(colors - centers[_owners(colors, centers)]).mean(axis=1)
    return float(off @ counts / counts.sum())
