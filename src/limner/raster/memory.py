"""Memory that one picture leaves to the next.

A million triangles take a hundred megabytes on their way to the pixels. Fresh from the system, every page of it is zeroed at its first
touch, which takes as long as the work itself.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["Memory"]

T = TypeVar("T")

_ROOM_TO_GROW = 1.25


class Memory:
    """Arrays by name, for one picture at a time."""

    def __init__(self) -> None:
        self._kept: dict[str, NDArray[np.uint8]] = {}
        self._of_threads: dict[int, tuple[Any, Any]] = {}

    def of_thread(self, key: Hashable, make: Callable[[], T]) -> T:
        """What a thread made for itself the last time, or makes now; it is kept while it is asked for by the same key."""
        thread = threading.get_ident()
        found = self._of_threads.get(thread)
        if found is None or found[0] != key:
            found = self._of_threads[thread] = key, make()
        made: T = found[1]
        return made

    def array(self, name: str, shape: int | tuple[int, ...], dtype: Any) -> NDArray[Any]:
        """A C-contiguous array with anything in it; what had the name before is gone."""
        n_bytes = int(np.prod(shape)) * np.dtype(dtype).itemsize
        kept = self._kept.pop(name, None)
        if kept is None or kept.nbytes < n_bytes:
            room = n_bytes if kept is None else int(n_bytes * _ROOM_TO_GROW)
            kept = None  # before there is the new one
            kept = np.empty(room, dtype=np.uint8)
        self._kept[name] = kept
        return kept[:n_bytes].view(dtype).reshape(shape)
