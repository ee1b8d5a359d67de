"""Doors: machine code that is loaded without Numba, is never stale, and survives every kind of cache folder.

The cache tests run a copy of the package with a small door of their own, so that its sources can be edited.
"""

from __future__ import annotations

import gc
import json
import os
import re
import shutil
import subprocess
import sys
import threading
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from compiled import door_of

import limner
from limner import _door
from limner._door import Array, Scalar

_SOURCES = Path(limner.__file__).parent


# --- arguments ------------------------------------------------------------------------------------------------------------


def _add(x, table, factor, shift):
    for k in range(x.shape[0]):
        x[k] = x[k] * factor + table[k, shift]


_RECORD = np.dtype([("weight", np.float32), ("count", np.int32), ("color", np.float32, 3)], align=True)


def _weigh(rows, out):
    for k in range(rows.shape[0]):
        row = rows[k]
        out[k] = row["weight"] * np.float32(row["count"]) + row["color"][2]


def _door_of_add() -> _door.Door:
    return door_of(_add, Array(np.float32, 1), Array(np.float32, 2), Scalar(np.float32), Scalar(np.int64))


def _arguments() -> tuple[np.ndarray, np.ndarray, float, int]:
    return np.ones(3, np.float32), np.arange(6, dtype=np.float32).reshape(3, 2), 2.0, 1


def test_arrays_scalars_and_records_arrive() -> None:
    """Every kind of argument, and results written in place."""
    arguments = _arguments()
    _door_of_add()(*arguments)
    np.testing.assert_array_equal(arguments[0], [3, 5, 7])
    rows = np.array([(0.5, 4, (0, 0, 1)), (2.0, 3, (0, 0, 0.25))], _RECORD)
    out = np.zeros(2, np.float32)
    door_of(_weigh, Array(_RECORD, 1), Array(np.float32, 1))(rows, out)
    np.testing.assert_array_equal(out, [3.0, 6.25])


def test_empty_arrays_are_arrays() -> None:
    """Families without members have length 0."""
    _door_of_add()(np.zeros(0, np.float32), np.zeros((0, 2), np.float32), 1.0, 0)


def test_bound_arguments_come_first() -> None:
    """`bind` converts once what stays; each call brings the rest."""
    x, table, factor, shift = _arguments()
    call = _door_of_add().bind(x, table)
    call(factor, shift)
    call(factor, 0)
    np.testing.assert_array_equal(x, [6, 12, 18])


@pytest.mark.parametrize(
    ("place", "wrong", "said"),
    [
        (0, np.ones(3), "contiguous float32 array with 1 dimensions, got float64 of shape (3,)"),
        (0, np.ones(6, np.float32)[::2], "contiguous float32 array with 1 dimensions, got float32 of shape (3,)"),
        (0, np.ones((3, 1), np.float32), "got float32 of shape (3, 1)"),
        (0, [1.0, 1.0, 1.0], "got [1.0, 1.0, 1.0]"),
        (1, np.ones((3, 2), np.float32, order="F"), "contiguous float32 array with 2 dimensions"),
        (2, "two", "needs a float32 number, got 'two'"),
        (3, 1.5, "needs a int64 number, got 1.5"),
        (3, 2**63, "needs a int64 number, got 9223372036854775808"),
    ],
)
def test_a_wrong_argument_is_named(place: int, wrong: Any, said: str) -> None:
    """Wrong dtype, layout, dimension or type: a TypeError with the door's name, and nothing has been read or written."""
    door = _door_of_add()
    arguments = list(_arguments())
    arguments[place] = wrong
    with pytest.raises(TypeError, match=re.escape(said)) as caught:
        door(*arguments)
    assert str(caught.value).startswith(f"{door.name} needs")
    with pytest.raises(TypeError, match=re.escape(said)):
        door.bind(*arguments[:place])(*arguments[place:])


@pytest.mark.parametrize("count", [0, 3, 5])
def test_a_wrong_number_of_arguments_is_told(count: int) -> None:
    """Too few or too many, at once or after `bind`.

    Bug: arguments beyond the last were dropped without a word. Fix: they are counted.
    """
    arguments = (*_arguments(), 1)[:count]
    with pytest.raises(TypeError, match=f"takes 4 arguments, got {count}"):
        _door_of_add()(*arguments)
    with pytest.raises(TypeError, match=f"takes 4 arguments, got {count}"):
        _door_of_add().bind(*arguments[:2])(*arguments[2:])


def test_a_call_keeps_no_array() -> None:
    """Once a call is over, its arrays are freed at once.

    Bug: the bound call referred to itself, so that every picture waited for the cycle collector. Fix: no cycle.
    """
    arguments = _arguments()
    held = weakref.ref(arguments[0])
    gc.disable()
    try:
        _door_of_add()(*arguments)
        del arguments
        assert held() is None
    finally:
        gc.enable()


def test_threads_share_a_door() -> None:
    """Eight threads open and call one door at once; each gets its own result."""
    door = _door_of_add()
    results = [np.full(1000, k, np.float32) for k in range(8)]
    table = np.ones((1000, 1), np.float32)
    threads = [threading.Thread(target=door, args=(x, table, 3.0, 0)) for x in results]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k, x in enumerate(results):
        np.testing.assert_array_equal(x, 3 * k + 1)


# --- sources --------------------------------------------------------------------------------------------------------------


def test_the_closure_of_a_kernel_is_what_it_imports() -> None:
    """Every module that is compiled in, and none that is not."""
    closure = _door._closure("limner.kernel.frame")
    assert {"limner.kernel.frame", "limner.kernel.vec", "limner.kernel.elementary", "limner._jit", "limner._compile"} <= closure
    assert {"limner.kernel._bits", "limner.kernel._value_types"} <= closure
    assert not closure & {"limner.kernel.warp", "limner.kernel.sampler", "limner.render", "limner.errors"}
    assert {"limner.kernel.sampler", "limner.kernel.rng"} <= _door._closure("limner.kernel.sampler")


def test_the_key_follows_the_sources_and_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """An edit inside the closure changes the key, one outside does not; so does a NUMBA_ setting, a signature, a name."""
    door = _door.Door("limner.kernel.warp", "entry", (Array(np.float32, 1),), "a test")
    monkeypatch.delitem(_door._registry, door.name)
    key, read = door._key(), _door._source

    def edited(module: str) -> Callable[[str], bytes]:
        return lambda name: read(name) + (b"# edited\n" if name == module else b"")

    for module in ("limner.kernel.warp", "limner.kernel.vec", "limner.kernel._bits", "limner._jit", "limner._compile"):
        monkeypatch.setattr(_door, "_source", edited(module))
        assert door._key() != key, module
    for module in ("limner.kernel.sampler", "limner.errors"):
        monkeypatch.setattr(_door, "_source", edited(module))
        assert door._key() == key, module
    monkeypatch.setattr(_door, "_source", read)
    keys = {key}
    for signature in ((Array(np.float64, 1),), (Array(np.float32, 2),), (Scalar(np.float32),), ()):
        door.signature = signature
        keys.add(door._key())
    door.signature = (Array(np.float32, 1),)
    monkeypatch.setenv("NUMBA_CPU_NAME", "some-other-cpu")
    keys.add(door._key())
    assert len(keys) == 6


def test_modules_import_each_other_relatively() -> None:
    """The closure follows relative imports alone: an absolute one would be a stale cache."""
    absolute = re.compile(r"^\s*(from limner\b|import limner\b)", re.MULTILINE)
    for path in _SOURCES.rglob("*.py"):
        code = re.sub(r'"""(?:.|\n)*?"""', "", path.read_text("utf-8"))
        assert not absolute.search(code), path


# --- the cache ------------------------------------------------------------------------------------------------------------

_KERNEL = """
from .demo_helper import scaled

def demo(x, factor):
    for k in range(x.shape[0]):
        x[k] = scaled(x[k], factor)
"""
_HELPER = """
from ._jit import kernel

@kernel
def scaled(x, factor):
    return x * factor
"""
_PROGRAM = """
import json, sys
import numpy as np
from limner._door import Array, Door, Scalar
door = Door("limner.demo", "demo", (Array(np.float32, 1), Scalar(np.float32)), "the demo")
cached = door.is_cached()
x = np.arange(3, dtype=np.float32)
door(x, 2.0)
print(json.dumps({"x": x.tolist(), "cached": cached, "numba": "numba" in sys.modules}))
"""


class Workshop:
    """A copy of the package with a door that can be edited, and processes that open it."""

    def __init__(self, folder: Path) -> None:
        self.package = folder / "limner"
        self.cache = folder / "cache"
        self.package.mkdir()
        for name in ("__init__.py", "_jit.py", "_door.py", "_compile.py", "errors.py"):
            shutil.copy(_SOURCES / name, self.package / name)
        (self.package / "demo.py").write_text(_KERNEL)
        (self.package / "demo_helper.py").write_text(_HELPER)

    def start(self, **environment: str) -> subprocess.Popen[str]:
        """A process that opens the door."""
        env = {**os.environ, "PYTHONPATH": str(self.package.parent), "LIMNER_CACHE_DIR": str(self.cache), **environment}
        return subprocess.Popen(
            [sys.executable, "-c", _PROGRAM], env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )

    def finish(self, process: subprocess.Popen[str]) -> dict[str, Any]:
        """What it printed, and what it said on stderr, by line."""
        out, err = process.communicate(timeout=120)
        assert process.returncode == 0, err
        return {**json.loads(out), "said": err.splitlines()}

    def run(self, **environment: str) -> dict[str, Any]:
        return self.finish(self.start(**environment))

    def cached(self) -> list[Path]:
        return sorted(self.cache.iterdir())


@pytest.fixture
def workshop(tmp_path: Path) -> Workshop:
    """An empty cache."""
    return Workshop(tmp_path)


_COMPILING = "compiling the demo for this machine; this happens once"


@pytest.mark.compiled
def test_the_second_process_never_sees_numba_and_an_edit_compiles_again(workshop: Workshop) -> None:
    """Cold, warm, after an edit elsewhere, after an edit of a helper in another module: compiled exactly when it must be."""
    assert workshop.run() == {"x": [0, 2, 4], "cached": False, "numba": True, "said": [_COMPILING]}
    warm = {"x": [0, 2, 4], "cached": True, "numba": False, "said": []}
    assert workshop.run() == warm
    (workshop.package / "errors.py").write_text("# another room\n")
    assert workshop.run() == warm
    helper = workshop.package / "demo_helper.py"
    helper.write_text(_HELPER.replace("x * factor", "x * factor + factor"))
    assert workshop.run() == {"x": [2, 4, 6], "cached": False, "numba": True, "said": [_COMPILING]}
    helper.write_text(_HELPER)
    assert workshop.run() == warm
    assert len(workshop.cached()) == 2


@pytest.mark.compiled
def test_a_damaged_file_is_compiled_again_and_repaired(workshop: Workshop) -> None:
    """Cut short, a byte changed, empty: the digest tells, and the next process finds a sound file."""
    workshop.run()
    (file,) = workshop.cached()
    sound = file.read_bytes()
    middle = len(sound) // 2
    for damaged in (sound[:middle] + bytes([sound[middle] ^ 1]) + sound[middle + 1 :], sound[:middle], b""):
        file.write_bytes(damaged)
        found = workshop.run()
        assert (found["x"], found["said"]) == ([0, 2, 4], [_COMPILING])
    found = workshop.run()
    assert (found["x"], found["numba"], found["said"]) == ([0, 2, 4], False, [])


@pytest.mark.compiled
def test_without_a_place_to_write_it_warns_once_and_works(workshop: Workshop) -> None:
    """The cache folder's parent is a file, as good as a read-only disk: the picture is made, one line tells what to do."""
    workshop.cache.write_text("in the way")
    found = workshop.run(LIMNER_CACHE_DIR=str(workshop.cache / "limner"))
    assert found["x"] == [0, 2, 4]
    compiling, warning = found["said"]
    assert compiling == _COMPILING
    assert warning.startswith(f"the compiled code could not be kept in {workshop.cache / 'limner'} (")
    assert warning.endswith("set LIMNER_CACHE_DIR to a writable folder")


@pytest.mark.compiled
def test_processes_may_start_at_once(workshop: Workshop) -> None:
    """Three processes find no cache together: all succeed, one sound file is left and nothing half-written."""
    processes = [workshop.start() for _ in range(3)]
    for process in processes:
        assert workshop.finish(process)["x"] == [0, 2, 4]
    (file,) = workshop.cached()
    assert file.suffix == ".o"
    assert workshop.run()["numba"] is False


def test_python_mode_needs_neither_numba_nor_a_cache(workshop: Workshop) -> None:
    """The same door, the same numbers, nothing compiled, nothing written."""
    for mode in ("python", "traced"):
        assert workshop.run(LIMNER_MODE=mode) == {"x": [0, 2, 4], "cached": True, "numba": False, "said": []}
    assert not workshop.cache.exists()


def test_old_files_are_pruned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The most recently written are kept."""
    monkeypatch.setattr(_door, "_KEPT_FILES", 3)
    for k in range(6):
        _door._write(tmp_path / f"{k}.o", b"code", "symbol")
        os.utime(tmp_path / f"{k}.o", (k, k))
    assert sorted(file.name for file in tmp_path.iterdir()) == ["3.o", "4.o", "5.o"]
    assert _door._read(tmp_path / "5.o") == (b"code", "symbol")
    assert _door._read(tmp_path / "0.o") is None
