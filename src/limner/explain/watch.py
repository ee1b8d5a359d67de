"""Run a kernel as Python and write down what happens: every call, and every change of the sums that make the pixel.

The traced mode (`limner._jit`) records calls, with arguments and results. What a loop adds up between them stands in local variables; where
a kernel keeps light in `total`, or what is left of it in `throughput`, each new value is written down, with the line of the source that
made it. So the last value of `total` *is* what the kernel returns, to the bit, and the changes before it are where it came from.
"""

from __future__ import annotations

import linecache
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import CodeType, FrameType
from typing import Any, NamedTuple

import numpy as np

from .._jit import Call, recording

__all__ = ["WATCHED", "Change", "Record", "watch"]

WATCHED = ("total", "radiance", "throughput", "clear", "alpha")
"""Names of the local variables that are followed: light, and what of it gets through."""


class Change(NamedTuple):
    """A new value of a local variable.

    Attributes
    ----------
    place : int
        How many calls the kernel had made before.
    variable : str
    value : object
    statement : str
        The line of the source.
    line : int
    """

    place: int
    variable: str
    value: Any
    statement: str
    line: int


class Record(NamedTuple):
    """What happened: the outermost calls, and the changes within some calls, by their identity."""

    calls: list[Call]
    changes: dict[int, list[Change]]


def watch(kernel: Callable[..., Any], arguments: Sequence[Any], watched: Sequence[Callable[..., Any]]) -> Record:
    """Call `kernel` in the traced mode; follow the sums in the kernels `watched`."""
    changes: dict[int, list[Change]] = {}
    with recording() as calls, _following(watched, calls, changes), np.errstate(all="ignore"):
        kernel(*arguments)
    return Record(calls, changes)


@contextmanager
def _following(watched: Sequence[Callable[..., Any]], calls: list[Call], changes: dict[int, list[Change]]) -> Iterator[None]:
    names: dict[CodeType, str] = {}
    for function in watched:
        inner = getattr(function, "__wrapped__", function)
        names[inner.__code__] = f"{inner.__module__}.{inner.__qualname__}"

    def enter(frame: FrameType, event: str, argument: Any) -> Any:
        name = names.get(frame.f_code)
        if name is None:
            return None
        call = _open_call(calls, name)
        return None if call is None else _Follower(call, changes.setdefault(id(call), []))

    before = sys.gettrace()
    sys.settrace(enter)
    try:
        yield
    finally:
        sys.settrace(before)


class _Follower:
    """Looks at a kernel's local variables after each of its lines."""

    def __init__(self, call: Call, changes: list[Change]) -> None:
        self._call, self._changes = call, changes
        self._last: dict[str, Any] = {}
        self._line = 0

    def __call__(self, frame: FrameType, event: str, argument: Any) -> Any:
        held = frame.f_locals
        for name in WATCHED:
            if name in held and held[name] is not self._last.get(name):
                value = self._last[name] = held[name]
                statement = _statement(frame.f_code.co_filename, self._line)
                self._changes.append(Change(len(self._call.calls), name, value, statement, self._line))
        self._line = frame.f_lineno
        return self


def _statement(file: str, line: int) -> str:
    """A statement as it stands in the source; joined, where it goes over several lines."""
    text = linecache.getline(file, line).split("#")[0].strip() if line else ""
    following = line
    while line and text and (text.count("(") > text.count(")")) and following < line + 8:
        following += 1
        text += " " + linecache.getline(file, following).split("#")[0].strip()
    return text


def _open_call(calls: list[Call], name: str) -> Call | None:
    """The call of that name that is being made: on the way along the last calls."""
    found = None
    while calls:
        if calls[-1].name == name:
            found = calls[-1]
        calls = calls[-1].calls
    return found
