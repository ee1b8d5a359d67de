"""Tiles on threads: the driver of every renderer. It owns the progress and the cancelling, and nothing else.

A tile is a rectangle of the picture and belongs to one thread at a time; what a pixel becomes does not depend on the tile it lies
in, so that threads and tiles cannot change a bit.
"""

from __future__ import annotations

import os
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple, Protocol, TypeAlias, TypeVar

import numpy as np

from .errors import SceneError

__all__ = ["Cancelled", "OnProgress", "PerThread", "Tile", "is_whole", "run_all", "thread_count", "tiles_of"]

T = TypeVar("T")

OnProgress = Callable[[float], None]
"""Called now and then, from the calling thread, with the part that is done: 0 to 1."""

Finished: TypeAlias = "queue.SimpleQueue[BaseException | None]"
"""What threads hand back for each item: what went wrong, or None."""


class Cancel(Protocol):
    """What can be asked whether to stop: a threading.Event."""

    def is_set(self) -> bool: ...


class Cancelled(Exception):  # noqa: N818 - not an error: the picture so far is kept
    """The work was stopped before its end."""


class PerThread(threading.local):
    """What every thread makes for itself, once, on its first look: scratch memory, converted arguments.

    Parameters
    ----------
    make : callable
        Called without arguments; its result is `value`.
    """

    def __init__(self, make: Callable[[], Any]) -> None:
        self.value = make()


class Tile(NamedTuple):
    """A rectangle of the picture, rows counted from the bottom."""

    number: int
    first_column: int
    first_row: int
    columns: int
    rows: int


def tiles_of(width: int, height: int, size: int) -> list[Tile]:
    """Cut a picture into tiles of `size` pixels a side, row by row from the bottom."""
    starts = [(i, j) for j in range(0, height, size) for i in range(0, width, size)]
    return [Tile(k, i, j, min(size, width - i), min(size, height - j)) for k, (i, j) in enumerate(starts)]


def thread_count(threads: int | None) -> int:
    """How many threads to use: all cores that this process may use, unless told otherwise."""
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not is_whole(threads) or threads < 1:
        raise SceneError(f"threads must be an integer, at least 1, got {threads!r}")
    return int(threads)


def is_whole(value: object) -> bool:
    """Whether a value counts something: an integer of Python or NumPy, and no bool."""
    return hasattr(value, "__index__") and not isinstance(value, (bool, np.bool_))


def run_all(
    work: Callable[[T], object],
    items: Sequence[T] | Iterable[T],
    threads: int,
    on_progress: OnProgress | None = None,
    cancel: Cancel | None = None,
) -> None:
    """Run `work` on every item, on some threads. An error in one stops the rest and is raised; an interrupt likewise.

    Raises Cancelled where `cancel` was set.
    """
    waiting = list(items)
    if threads == 1 or len(waiting) < 2:
        for done, item in enumerate(waiting):
            _stop_if(cancel)
            work(item)
            if on_progress is not None:
                on_progress((done + 1) / len(waiting))
        return
    stop = threading.Event()
    left = deque(waiting)
    finished: Finished = queue.SimpleQueue()

    def serve() -> None:
        while not stop.is_set():
            try:
                item = left.popleft()
            except IndexError:
                return
            try:
                work(item)
            except BaseException as error:
                finished.put(error)
                return
            finished.put(None)

    with ThreadPoolExecutor(threads) as pool:
        try:
            for _ in range(min(threads, len(waiting))):
                pool.submit(serve)
            _wait_for(finished, len(waiting), on_progress, cancel)
        finally:
            stop.set()


def _wait_for(finished: Finished, total: int, on_progress: OnProgress | None, cancel: Cancel | None) -> None:
    """Count what is finished; raise what went wrong.

    Not `concurrent.futures.wait`: it takes a lock of every task that is pending, at every call, and an interrupt in the middle
    leaves them taken, for which the threads then wait for ever.
    """
    done, last = 0, time.monotonic()
    while done < total:
        try:
            error = finished.get(timeout=0.1)
        except queue.Empty:
            pass
        else:
            if error is not None:
                raise error
            done += 1
        _stop_if(cancel)
        now = time.monotonic()
        if on_progress is not None and (now - last > 0.05 or done == total):
            last = now
            on_progress(done / total)


def _stop_if(cancel: Cancel | None) -> None:
    if cancel is not None and cancel.is_set():
        raise Cancelled
