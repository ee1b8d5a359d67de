"""Run a kernel over columns of numbers, in the mode the tests run in.

A kernel cannot be called from Python when it is compiled: Python enters through a door, and a door has a fixed shape. Here a
kernel's annotations say what that shape is. `over` writes the entry kernel (the loop, and the unpacking of columns into numbers
and vectors), opens a door for it, and calls that door:

    over(atan2, y, x)                # (n,), (n,) -> (n,)
    over(normalize, vectors)         # (n, 3) -> (n, 3)
    over(frame_from_normal, normals) # (n, 3) -> three times (n, 3)

Compiled or not, the same test sees the same numbers. Scalar arguments are repeated.
"""

from __future__ import annotations

import hashlib
import inspect
import itertools
import sys
import types
import typing
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from limner import _door
from limner._door import Array, Door, Signature
from limner.kernel.vec import Color, Vec3

__all__ = ["door_of", "over"]

_VALUES: dict[Any, tuple[str, ...]] = {Vec3: ("x", "y", "z"), Color: ("r", "g", "b")}
_INTEGERS = {int: "np.int64", np.int64: "np.int64", np.int32: "np.int32", np.uint32: "np.uint32"}
_numbers = itertools.count()
_doors: dict[Any, Door] = {}


class _DoorOfTest(Door):
    """A door whose kernel stands in a test: its key covers the test's text and the rooms that the test can reach."""

    def __init__(self, function: Any, signature: Signature, text: str, rooms: set[str]) -> None:
        module = types.ModuleType(f"limner_test_entry_{next(_numbers)}")
        setattr(module, "entry", function)  # noqa: B010
        sys.modules[module.__name__] = module
        super().__init__(module.__name__, "entry", signature, "a test")
        _door._registry.pop(self.name)  # `warm_up` is about limner's own
        self._text, self._rooms = text, rooms

    def _path(self) -> Path:
        return _door.cache_folder() / "tests" / super()._path().name

    def _key(self) -> str:
        digest = hashlib.blake2b(_door._machine() + self._text.encode() + repr(self.signature).encode(), digest_size=12)
        for module in sorted(set().union(*map(_door._closure, self._rooms))):
            digest.update(module.encode() + _door._source(module))
        return digest.hexdigest()


def _python_function(kernel: Any) -> Any:
    return getattr(kernel, "py_func", None) or inspect.unwrap(kernel)


def _rooms(function: Any) -> set[str]:
    """The modules of limner that a function's module has names from."""
    homes = {getattr(_python_function(value), "__module__", None) for value in function.__globals__.values() if callable(value)}
    return {home for home in (*homes, function.__module__) if home and home.startswith("limner.")} | {
        "limner.kernel.elementary"
    }


def door_of(function: Callable[..., None], *signature: Any) -> Door:
    """A door for an entry kernel that stands in a test file. Its arguments and no result, as for `limner._door.Door`."""
    python = _python_function(function)
    if python not in _doors:
        text = inspect.getsource(sys.modules[python.__module__])
        _doors[python] = _DoorOfTest(function, tuple(signature), python.__qualname__ + text, _rooms(python))
    return _doors[python]


def over(kernel: Any, *columns: Any) -> Any:
    """The kernel's value for each row of the columns.

    Parameters
    ----------
    kernel : kernel
        Annotated with numbers, `Vec3`, `Color`, and for its result also named or plain tuples of these.
    columns : (n,) or (n, 3) array_like, or scalar
        One for each argument.

    Returns
    -------
    (n,) float32 or int64, (n, 3) float32, or a tuple of these
        Integers come back as int64.
    """
    function = _python_function(kernel)
    hints = typing.get_type_hints(function)
    kinds = [hints[name] for name in inspect.signature(function).parameters]
    if len(kinds) != len(columns):
        raise TypeError(f"{function.__qualname__} takes {len(kinds)} columns, got {len(columns)}")
    n = max((len(np.atleast_1d(column)) for column in columns), default=1)
    floats: list[np.ndarray] = []
    integers: list[np.ndarray] = []
    for kind, column in zip(kinds, columns, strict=True):
        if kind in _VALUES:
            floats.extend(np.broadcast_to(np.asarray(column, np.float32), (n, 3)).T)
        else:
            (integers if kind in _INTEGERS else floats).append(np.broadcast_to(np.asarray(column), (n,)))
    outputs = list(_outputs(hints["return"], "r"))
    results = np.zeros((len(outputs), n), np.float32), np.zeros((len(outputs), n), np.int64)
    _entry(kernel, function, kinds, outputs)(
        np.ascontiguousarray(floats, np.float32).reshape(-1, n),
        np.ascontiguousarray(integers, np.int64).reshape(-1, n),
        *results,
    )
    columns_out = iter(results[kind in _INTEGERS][row] for row, (_, kind) in enumerate(outputs))
    return _gathered(hints["return"], columns_out)


def _entry(kernel: Any, function: Any, kinds: list[Any], outputs: list[tuple[str, Any]]) -> Door:
    if kernel not in _doors:
        source = _entry_source(kinds, outputs)
        namespace = {"np": np, "kernel": kernel, "Vec3": Vec3, "Color": Color}
        exec(compile(source, f"<entry of {function.__qualname__}>", "exec"), namespace)
        signature = (Array(np.float32, 2), Array(np.int64, 2), Array(np.float32, 2), Array(np.int64, 2))
        home = function.__module__
        text = source + function.__qualname__ + ("" if home.startswith("limner.") else inspect.getsource(sys.modules[home]))
        _doors[kernel] = _DoorOfTest(namespace["entry"], signature, text, _rooms(function) | {"limner.kernel.vec"})
    return _doors[kernel]


def _entry_source(kinds: list[Any], outputs: list[tuple[str, Any]]) -> str:
    n_floats, n_integers = itertools.count(), itertools.count()
    arguments = []
    for kind in kinds:
        if kind in _VALUES:
            arguments.append(f"{kind.__name__}({', '.join(f'f[{next(n_floats)}, k]' for _ in range(3))})")
        elif kind in _INTEGERS:
            arguments.append(f"{_INTEGERS[kind]}(i[{next(n_integers)}, k])")
        else:
            arguments.append(f"f[{next(n_floats)}, k]")
    lines = [
        "def entry(f, i, out_f, out_i):",
        "    for k in range(out_f.shape[1]):",
        f"        r = kernel({', '.join(arguments)})",
    ]
    lines += [
        f"        out_{'i' if kind in _INTEGERS else 'f'}[{row}, k] = {place}" for row, (place, kind) in enumerate(outputs)
    ]
    return "\n".join(lines) + "\n"


def _parts(kind: Any, place: str) -> list[tuple[str, Any]]:
    """What a tuple is made of: an expression and a kind each; empty for what is no tuple."""
    if typing.get_origin(kind) is tuple:
        return [(f"{place}[{n}]", part) for n, part in enumerate(typing.get_args(kind))]
    if isinstance(kind, type) and issubclass(kind, tuple):
        return [(f"{place}.{name}", part) for name, part in typing.get_type_hints(kind).items()]
    return []


def _outputs(kind: Any, place: str) -> typing.Iterator[tuple[str, Any]]:
    """The numbers of a result: an expression and a kind each."""
    parts = _parts(kind, place)
    if parts:
        for expression, part in parts:
            yield from _outputs(part, expression)
    elif kind in _VALUES:
        yield from ((f"{place}.{field}", np.float32) for field in _VALUES[kind])
    else:
        yield place, kind


def _gathered(kind: Any, columns: typing.Iterator[np.ndarray]) -> Any:
    parts = _parts(kind, "r")
    if parts:
        return tuple(_gathered(part, columns) for _, part in parts)
    if kind in _VALUES:
        return np.stack([next(columns) for _ in range(3)], axis=1)
    return next(columns)
