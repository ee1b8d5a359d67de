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
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np

from .errors import SceneError

__all__ = ["Cancelled", "OnProgress", "PerThread", "Tile", "is_whole", "run_all", "thread_count", "tiles_of"]

T = TypeVar("T")

OnProgress = Callable[[float], None]
"""Called now and then, from the calling thread, with the part that is done: 0 to 1."""

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
    crew = _Crew(work, waiting)
    for _ in range(min(threads, len(waiting)) - 1):
        _helpers.submit(crew.help)
    try:
        crew.lead(on_progress, cancel)
    finally:
        crew.dismiss()


class _Crew:
    """The caller's thread and its helpers, who take items from one list until it is empty.

    The caller works, too: a picture that takes two milliseconds has no time to wake a thread and to wait for it.
    """

    def __init__(self, work: Callable[[Any], object], items: list[Any]) -> None:
        self._work, self._left, self._total = work, deque(items), len(items)
        self._done: deque[None] = deque()  # one entry for each item: appending needs no lock
        self._failed: list[BaseException] = []
        self._changed = threading.Condition()
        self._helping, self._dismissed = 0, False

    def help(self) -> None:
        """What a helper does; one that comes too late goes again."""
        with self._changed:
            if self._dismissed:
                return
            self._helping += 1
        try:
            while not self._dismissed and self._left:
                self._take()
        except BaseException as error:
            self._failed.append(error)
        finally:
            with self._changed:
                self._helping -= 1
                self._changed.notify_all()

    def lead(self, on_progress: OnProgress | None, cancel: Cancel | None) -> None:
        """What the caller does: work, report, and listen for what stops it."""
        last = time.monotonic()
        while True:
            _stop_if(cancel)
            if self._failed:
                raise self._failed[0]
            done = len(self._done)
            now = time.monotonic()
            if on_progress is not None and (now - last > 0.05 or done == self._total):
                last = now
                on_progress(done / self._total)
            if done == self._total:
                return
            if self._left:
                self._take()
            else:
                with self._changed:
                    if len(self._done) < self._total and self._helping and not self._failed:
                        self._changed.wait(0.05)

    def dismiss(self) -> None:
        """Begin nothing more, and wait for what has begun."""
        with self._changed:
            self._dismissed = True
            while self._helping:
                self._changed.wait(0.05)

    def _take(self) -> None:
        try:
            item = self._left.popleft()
        except IndexError:
            return
        self._work(item)
        self._done.append(None)


class _Helpers:
    """Threads that wait for crews to help; they are kept, since starting one takes as long as a small picture's tile."""

    def __init__(self) -> None:
        self._calls: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._count, self._idle, self._process = 0, 0, os.getpid()

    def submit(self, call: Callable[[], None]) -> None:
        with self._lock:
            if self._process != os.getpid():  # threads do not survive a fork
                self._calls, self._count, self._idle, self._process = queue.SimpleQueue(), 0, 0, os.getpid()
            if self._idle <= self._calls.qsize() and self._count < _MOST_HELPERS:
                self._count += 1
                threading.Thread(target=self._serve, args=(self._calls,), name=f"limner {self._count}", daemon=True).start()
        self._calls.put(call)

    def _serve(self, calls: queue.SimpleQueue[Callable[[], None]]) -> None:
        while True:
            with self._lock:
                self._idle += 1
            call = calls.get()
            with self._lock:
                self._idle -= 1
            call()
            del call  # a thread that waits must not hold the last picture's film


_MOST_HELPERS = 256
_helpers = _Helpers()


def _stop_if(cancel: Cancel | None) -> None:
    if cancel is not None and cancel.is_set():
        raise Cancelled
