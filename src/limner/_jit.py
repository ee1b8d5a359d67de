"""The one decorator for kernels, and the three modes they run in.

    @kernel
    def reflect(d: Vec3, n: Vec3) -> Vec3:
        return d - n * (TWO * dot(d, n))

- **compiled** (default): Numba compiles the function into the doors that reach it (`limner._door`). It is not callable from
  Python itself.
- **python** (``LIMNER_MODE=python`` or ``NUMBA_DISABLE_JIT=1``): the function as written; breakpoints, coverage, the same bits.
- **traced** (``LIMNER_MODE=traced``): as python, and inside ``with recording() as calls:`` every kernel call is recorded as a
  tree of name, arguments, result and the first line of the docstring: why does this pixel look like that?

The mode is chosen by the environment before limner is imported.

Floating point: no fast-math flag, not even contraction, on anything that reaches a pixel, so compiled and uncompiled runs, and
all CPUs, agree to the bit. Division by zero gives infinity, as in NumPy. Kernels never allocate and never raise, so reference
counting is switched off: a kernel that makes an array does not compile.
"""

from __future__ import annotations

import functools
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, TypeVar

__all__ = ["MODE", "Call", "inlined", "kernel", "outlined", "recording"]

F = TypeVar("F", bound=Callable[..., Any])


def _mode_from_environment() -> str:
    mode = os.environ.get("LIMNER_MODE", "")
    if mode not in ("", "compiled", "python", "traced"):
        raise ValueError(f"LIMNER_MODE must be compiled, python or traced, got {mode!r}")
    if mode:
        return mode
    return "python" if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0") else "compiled"


MODE = _mode_from_environment()


@dataclass
class Call:
    """One recorded kernel call: a node of the trace.

    Parameters
    ----------
    name : str
        ``module.function``.
    arguments : tuple
    result : object
    source : str
        First line of the kernel's docstring.
    calls : list of Call
        The kernel calls it made, in order.
    """

    name: str
    arguments: tuple[Any, ...]
    source: str
    result: Any = None
    calls: list[Call] = field(default_factory=list)

    def walk(self) -> Iterator[Call]:
        """Yield this call and all below it, in order of execution."""
        yield self
        for call in self.calls:
            yield from call.walk()


class _Recorder(threading.local):
    open_calls: list[Call] | None = None


_recorder = _Recorder()


@contextmanager
def recording() -> Iterator[list[Call]]:
    """Record the kernel calls of this thread (traced mode only; elsewhere the list stays empty).

    Yields the list of outermost calls, which fills as they return.
    """
    root = Call("recording", (), "")
    before, _recorder.open_calls = _recorder.open_calls, [root]
    try:
        yield root.calls
    finally:
        _recorder.open_calls = before


def _traced(function: F) -> F:
    source = (function.__doc__ or "").strip().splitlines()
    first_line = source[0] if source else ""
    name = f"{function.__module__}.{function.__qualname__}"

    @functools.wraps(function)
    def wrapper(*arguments: Any) -> Any:
        open_calls = _recorder.open_calls
        if open_calls is None:
            return function(*arguments)
        call = Call(name, arguments, first_line)
        open_calls[-1].calls.append(call)
        open_calls.append(call)
        try:
            call.result = function(*arguments)
        finally:
            open_calls.pop()
        return call.result

    return wrapper  # type: ignore[return-value]


def kernel(function: F) -> F:
    """Make `function` a kernel: compiled into doors, plain Python, or recorded, as the mode says."""
    return _made(function)


def outlined(function: F) -> F:
    """Make `function` a kernel that is called and never inlined.

    For what is large and seldom reached from a loop that must be fast: inlined, it would take the loop's registers, be compiled once for
    every caller, and keep its callers from being inlined themselves.
    """
    return _made(function, placed="outlined")


def inlined(function: F) -> F:
    """Make `function` a kernel that stands wherever it is called.

    For what is large and called from few loops that must be fast, and nowhere else: LLVM would call it for its size, and pass its many
    arguments and its result through memory.
    """
    return _made(function, placed="inlined")


def _made(function: F, *, placed: str = "") -> F:
    if MODE == "python":
        return function
    if MODE == "traced":
        return _traced(function)
    from ._compile import inner_kernel

    compiled: F = inner_kernel(function, placed=placed)
    return compiled
