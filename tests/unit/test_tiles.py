"""Work on threads: all of it is done once, and whatever stops it leaves no thread waiting."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import threading
import time
import weakref

import pytest

from limner.tiles import Cancelled, run_all


@pytest.mark.parametrize("threads", [1, 2, 7])
def test_every_item_is_worked_on_once(threads: int) -> None:
    """With fewer items than threads, too; progress grows and ends at 1."""
    for n in (0, 1, 3, 500):
        done: list[int] = []
        told: list[float] = []
        run_all(done.append, range(n), threads, told.append)
        assert sorted(done) == list(range(n))
        assert told == sorted(told)
        assert told[-1:] == [1.0][: n > 0]


@pytest.mark.parametrize("threads", [1, 2])
def test_an_error_stops_the_rest(threads: int) -> None:
    """It is raised where the work was called for; what had not begun never begins."""
    begun: list[int] = []

    def work(item: int) -> None:
        begun.append(item)
        time.sleep(0.001)
        if item == 5:
            raise ValueError("five")

    with pytest.raises(ValueError, match="five"):
        run_all(work, range(10_000), threads)
    assert len(begun) < 1000


@pytest.mark.parametrize("threads", [1, 2])
def test_cancelling(threads: int) -> None:
    """Between two items."""
    cancel = threading.Event()

    def work(item: int) -> None:
        time.sleep(0.001)
        if item == 5:
            cancel.set()

    with pytest.raises(Cancelled):
        run_all(work, range(10_000), threads, cancel=cancel)


_MANY_SHORT_ITEMS = """
import sys, time
from limner.tiles import run_all
print("ready", flush=True)
try:
    run_all(lambda item: time.sleep(1e-4), range(200_000), 2)
except KeyboardInterrupt:
    sys.exit(130)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals are sent to one process")
def test_an_interrupt_leaves_nobody_waiting() -> None:
    """Bug: an interrupt inside `concurrent.futures.wait` left the locks of thousands of tasks taken, and the process hung. Fix: a queue."""
    for delay in (0.05, 0.12, 0.2):
        with subprocess.Popen([sys.executable, "-c", _MANY_SHORT_ITEMS], stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
            time.sleep(delay)
            process.send_signal(signal.SIGINT)
            try:
                assert process.wait(timeout=20) == 130
            finally:
                process.kill()


def test_threads_that_wait_hold_nothing() -> None:
    """Bug: a helper kept its last call, and with it the film and the tree of the last picture. Fix: it lets go before it waits."""

    class Film:
        pass

    def run() -> weakref.ref[Film]:
        film = Film()
        run_all(lambda item: time.sleep(0.001 if film else 0.0), range(40), 3)
        return weakref.ref(film)

    left = run()
    deadline = time.monotonic() + 5.0
    while left() is not None and time.monotonic() < deadline:
        gc.collect()
        time.sleep(0.01)
    assert left() is None
