"""How long to go on: until so many samples are taken, until a picture is smooth enough, or until time is up.

Noise is looked at where the number of samples has doubled, block by block of 16 by 16 pixels that do not depend on tiles or threads. With
the mean of the first half of the samples and the mean of all at hand, their difference has the size of the error that is left: of two
halves A and B, ``(A - (A + B)/2) = (A - B)/2`` varies as much as their mean does. A block is settled when that difference, its root mean
square over the block, is at most the target times the block's brightness; where it is darker than a hundredth of the picture's mean, times
that. Samples that are spread better than random ones differ more between their halves than their sum errs, so the target is rather
overshot. Since the same samples decide and are shown, the mean is shifted by a small part of the noise that is left.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .checkpoint import State, read_checkpoint, write_checkpoint
from .errors import RenderError
from .film import Film
from .tiles import Cancel, Tile, run_all

__all__ = ["BLOCK", "Budget", "Spending", "noise_of"]

BLOCK = 16
_FIRST_LOOK = 8  # samples
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float64)
_DARK = 0.01  # of the picture's mean


class Budget(NamedTuple):
    """What ends a picture, and what is kept of it meanwhile.

    Attributes
    ----------
    noise : float, optional
        The error to go down to, as a share of the brightness.
    seconds : float, optional
    checkpoint : path, optional
        Where to keep what is needed to go on.
    interval : float
        Seconds between two checkpoints.
    resume : bool
        Whether to go on from the checkpoint that is there.
    """

    noise: float | None = None
    seconds: float | None = None
    checkpoint: str | os.PathLike[str] | None = None
    interval: float = 60.0
    resume: bool = False


class Spending:
    """Fills a film within a budget.

    Parameters
    ----------
    film : Film
        Cut into blocks of `BLOCK` where there is a target for the noise.
    work : callable
        As `Film.expose` takes it.
    samples : int
        The most of each pixel.
    budget : Budget
    key : str
        Of which picture a checkpoint is.
    clock : callable
        Gives seconds.
    """

    def __init__(
        self, film: Film, work: Callable[[Tile, int, int], object], samples: int, budget: Budget, key: str,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:  # fmt: skip
        self._film, self._work, self._samples, self._budget, self._key, self._clock = film, work, samples, budget, key, clock
        self._started = self._kept = clock()
        self._half = np.zeros((*film.sums.shape[:2], 3), dtype=np.float32)
        self._settled = np.zeros(len(film.tiles), dtype=np.bool_)
        self.reached = 0
        """Samples of every block that is not settled."""
        self.is_out_of_time = False
        if budget.resume and budget.checkpoint is not None:
            state = read_checkpoint(budget.checkpoint, key)
            if state is not None:
                film.restore(state.sums, state.taken)
                if state.samples > samples:
                    name = os.fspath(budget.checkpoint)
                    raise RenderError(f"{name} holds {state.samples} samples of each pixel, which are more than {samples}; ask for as many")
                self.reached, self._half, self._settled = state.samples, state.half, state.settled

    def passes(
        self, step: int, threads: int, report: Callable[[float], None], cancel: Cancel | None, on_kept: Callable[[], None] | None = None
    ) -> None:
        """Take samples, `step` at a time, until the budget is spent; `on_kept` is called once an interval."""
        while self.reached < self._samples and not self._settled.all():
            if self.reached and self._budget.seconds is not None and self._clock() - self._started >= self._budget.seconds:
                self.is_out_of_time = True
                if self._budget.checkpoint is not None:
                    self._keep(None, always=True)
                return
            first, last = self.reached, min(self.reached - self.reached % step + step, self._samples)
            waiting = [tile for tile in self._film.tiles if not self._settled[tile.number]]

            def expose(tile: Tile, first: int = first, last: int = last) -> None:
                self._film.expose(tile, self._work, first, last)

            run_all(expose, waiting, threads, None, cancel)
            self.reached = last
            report(self._part_done())
            if self._budget.noise is not None and last >= _FIRST_LOOK and last & (last - 1) == 0:
                self._look(self._budget.noise)
            self._keep(on_kept, always=False)
        if self._budget.checkpoint is not None:
            Path(self._budget.checkpoint).unlink(missing_ok=True)

    def _part_done(self) -> float:
        part = self.reached / self._samples
        return part if self._budget.seconds is None else max(part, min((self._clock() - self._started) / self._budget.seconds, 1.0))

    def _look(self, target: float) -> None:
        """Settle the blocks that are smooth enough."""
        if self.reached > _FIRST_LOOK:
            noise = noise_of(self._film, self._half, self.reached)
            self._settled |= noise <= target
        self._half[:] = self._film.sums[..., :3]

    def _keep(self, on_kept: Callable[[], None] | None, *, always: bool) -> None:
        if not (always or self._clock() - self._kept >= self._budget.interval):
            return
        if self._budget.checkpoint is not None:
            state = State(self.reached, self._film.sums, self._film.taken, self._half, self._settled)
            write_checkpoint(self._budget.checkpoint, self._key, state)
        if on_kept is not None:
            on_kept()
        self._kept = self._clock()


def noise_of(film: Film, half: NDArray[np.float32], samples: int) -> NDArray[np.float64]:
    """(n,): the error of each block as a share of its brightness, from the sums of half the samples and of all.

    What a block's error is, if it has taken fewer samples, is not asked for: it is settled.
    """
    brightness, before = film.sums[..., :3].astype(np.float64) @ _LUMINANCE, half.astype(np.float64) @ _LUMINANCE / (samples // 2)
    blocks = [np.s_[j : j + rows, i : i + columns] for _, i, j, columns, rows in film.tiles]
    for block, taken in zip(blocks, film.taken, strict=True):
        brightness[block] /= max(int(taken), 1)
    dark = _DARK * max(float(brightness.mean()), 1e-30)
    return np.array(
        [np.sqrt(((before[block] - brightness[block]) ** 2).mean()) / max(float(brightness[block].mean()), dark) for block in blocks]
    )
