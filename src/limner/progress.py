"""How long work says where it is.

A picture can take a tenth of a second or an hour. Whoever waits hears it as a stream of small values, and decides what becomes
of them: a line on a terminal, a widget, a log, nothing.

    def show(progress: Progress) -> None:
        print(f"{progress.what}: {progress.done:.0%}")

    image = limner.render(scene, on_progress=show)
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

__all__ = ["Meter", "OnProgress", "Progress"]


@dataclass(frozen=True)
class Progress:
    """Where the work is.

    Parameters
    ----------
    done : float in [0, 1]
        1 is said once, at the end.
    elapsed : float
        Seconds since the work began.
    remaining : float, optional
        Seconds to go, at the speed so far; None: nothing is done yet that tells.
    what : str
        What is being done: "render".
    """

    done: float
    elapsed: float
    remaining: float | None
    what: str


OnProgress: TypeAlias = Callable[[Progress], None]


class Meter:
    """Turns "so much is done" into `Progress`, no oftener than a person can see.

    Parameters
    ----------
    on_progress : callable, optional
        Takes each `Progress`; None: nobody listens, and nothing is done.
    what : str
    interval : float
        The least time between two reports, seconds; beginning and end are always told.
    clock : callable
        Gives seconds.

    Not for several threads at once: the one that collects the results reports.

    >>> heard = []
    >>> meter = Meter(heard.append, "render", interval=0.0)
    >>> meter.report(0.5); meter.report(1.0)
    >>> [progress.done for progress in heard]
    [0.5, 1.0]
    """

    def __init__(
        self,
        on_progress: OnProgress | None,
        what: str,
        *,
        interval: float = 0.05,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self._on_progress, self._what, self._interval, self._clock = on_progress, what, interval, clock
        self._started = clock()
        self._told = -float("inf")

    def report(self, done: float) -> None:
        """Say that the share `done` of the work (0 to 1, clipped) is behind."""
        if self._on_progress is None:
            return
        done = min(max(done, 0.0), 1.0)
        now = self._clock()
        if 0.0 < done < 1.0 and now - self._told < self._interval:
            return
        self._told = now
        elapsed = now - self._started
        remaining = elapsed / done - elapsed if done > 0.0 else None
        self._on_progress(Progress(done, elapsed, remaining, self._what))
