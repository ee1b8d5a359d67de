"""Doors: how Python calls compiled kernels without importing the compiler.

A door is an entry kernel with a declared signature. The first time it is opened on a machine, Numba compiles it and all that
it calls, and the machine code goes into a cache. From then on a process loads the code with `llvmlite.binding` alone, in
milliseconds; Numba is never imported.

    render_tile = Door("limner.raster.tile", "render_tile", (Array(np.float32, 2), Scalar(np.int64)))
    render_tile(picture, 3)

The cached code is named by a hash of the kernel's sources (the door's import closure inside limner), the versions of Numba and
llvmlite, and the CPU: it cannot be stale, and an edit elsewhere recompiles nothing. It is written under a temporary name and
moved into place, so that processes may race; a folder that cannot be written costs the cache, not the picture.

Environment: ``LIMNER_CACHE_DIR`` names the cache folder (default: ``limner`` in the user's cache folder). ``NUMBA_CPU_NAME=generic`` makes
code for any CPU of the architecture, and a cache that may be carried from one machine to another, as in a container's image.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import importlib
import importlib.util
import logging
import operator
import os
import re
import struct
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import DTypeLike, NDArray

from . import _jit

__all__ = ["Array", "Door", "DoorCall", "Scalar", "Signature", "cache_folder", "doors", "is_witnessed", "warm_up", "witnessed"]

_log = logging.getLogger("limner")
_PACKAGE = Path(__file__).parent
_KEPT_FILES = 256  # some tens of doors, on a few CPUs, over a few versions


class Array(NamedTuple):
    """A C-contiguous array argument."""

    dtype: DTypeLike
    ndim: int


class Scalar(NamedTuple):
    """A scalar argument."""

    dtype: DTypeLike


Signature: TypeAlias = tuple[Array | Scalar, ...]


class DoorCall(NamedTuple):
    """What a door was called with, and which."""

    module: str
    function: str
    arguments: tuple[Any, ...]


class _Witness(threading.local):
    calls: list[DoorCall] | None = None


_witness = _Witness()


@contextmanager
def witnessed() -> Iterator[list[DoorCall]]:
    """Write down with what this thread calls doors that it binds meanwhile: the same call can then be made once more, to be looked at."""
    before, _witness.calls = _witness.calls, []
    try:
        yield _witness.calls
    finally:
        _witness.calls = before


def is_witnessed() -> bool:
    """Whether this thread's calls are written down: where two doors make the same bits, the one whose story is plainer is wanted then."""
    return _witness.calls is not None


_registry: dict[str, Door] = {}
# What declares doors, when imported
_DECLARING = (
    "limner.render", "limner.raycaster", "limner.draw.canvas", "limner.draw.wireframe", "limner.raster.stages",
    "limner.mesh.unwrap.unwrap", "limner.mesh.unwrap.distortion", "limner.artistic.lines", "limner.image.denoise",
    "limner.color.convert_large",
)  # fmt: skip


def doors() -> dict[str, Door]:
    """All doors declared so far, by name."""
    return dict(_registry)


class Door:
    """An entry kernel, compiled once for a machine.

    Parameters
    ----------
    module, function : str
        Where the kernel stands; imported only when it has to be compiled (or runs as Python).
    signature : tuple of Array and Scalar
        Its arguments; it returns nothing.
    what : str
        What a person waits for while it compiles.
    """

    def __init__(self, module: str, function: str, signature: Signature, what: str) -> None:
        self.module, self.function, self.signature, self.what = module, function, signature, what
        self.name = f"{module}.{function}"
        self._lock = threading.Lock()
        self._entry: Callable[..., int] | None = None
        self._python: Callable[..., Any] | None = None
        self._keep: Any = None
        self._forms: dict[int, tuple[struct.Struct, struct.Struct]] = {}
        # Where what a kernel returns and what it raises go: nothing, both.
        self._nowhere = ctypes.c_int64()
        _registry[self.name] = self

    def __call__(self, *arguments: Any) -> None:
        """Run the kernel; the interpreter's lock is released meanwhile."""
        self.bind(*arguments)()

    def bind(self, *arguments: Any, for_one_thread: bool = False) -> Callable[..., None]:
        """Convert the leading arguments once; the result takes the remaining ones, from any thread, or a little faster from one."""
        bound, calls = self._bound(*arguments, for_one_thread=for_one_thread), _witness.calls
        if calls is None:
            return bound

        def call(*more: Any) -> None:
            bound(*more)
            given = zip((*arguments, *more), self.signature, strict=True)
            values = tuple(_checked(value, kind, self.name)[0] for value, kind in given)
            calls.append(DoorCall(self.module, self.function, values))

        return call

    def _bound(self, *arguments: Any, for_one_thread: bool) -> Callable[..., None]:
        self.open()
        head = self._converted(arguments, self.signature)
        rest = self.signature[len(arguments) :]
        if self._python is not None:
            return self._bound_python(arguments, head, rest)
        before, form = self._packers(len(arguments))
        packed = before.pack(*head)
        first, size, entry = _RESULT_SLOTS + len(packed), _RESULT_SLOTS + len(packed) + form.size, self._entry
        packed = struct.pack("QQ", *[ctypes.addressof(self._nowhere)] * 2) + packed
        has_numbers_only = all(isinstance(kind, Scalar) for kind in rest)
        assert entry is not None
        own = ctypes.create_string_buffer(packed, size) if for_one_thread else None

        def call(*more: Any) -> None:
            # `arguments` is held by this function: the arrays must outlive the addresses in `packed`.
            if len(more) != len(rest):
                raise self._wrong_count(len(arguments) + len(more))
            slots = own
            if slots is None:
                slots = ctypes.create_string_buffer(size)
                ctypes.memmove(slots, packed, first)
            try:
                form.pack_into(slots, first, *(more if has_numbers_only else self._converted(more, rest)))
            except struct.error:
                form.pack_into(slots, first, *self._converted(more, rest))
            entry(ctypes.addressof(slots))

        return call

    def _packers(self, n: int) -> tuple[struct.Struct, struct.Struct]:
        """How the first n arguments lie in memory, and how the rest does."""
        found = self._forms.get(n)
        if found is None:
            found = self._forms[n] = _packer(self.signature[:n]), _packer(self.signature[n:])
        return found

    def _bound_python(self, arguments: tuple[Any, ...], head: list[Any], rest: Signature) -> Callable[..., None]:
        def call(*more: Any) -> None:
            if len(more) != len(rest):
                raise self._wrong_count(len(arguments) + len(more))
            assert self._python is not None
            with np.errstate(all="ignore"):
                self._python(*head, *self._converted(more, rest))

        return call

    def _converted(self, values: tuple[Any, ...], kinds: Signature) -> list[Any]:
        """The arguments as the kernel takes them: machine values, or as Python checked arrays and NumPy scalars."""
        if len(values) > len(kinds):
            raise self._wrong_count(len(self.signature) - len(kinds) + len(values))
        convert = _flatten if self._python is None else _checked
        return [part for value, kind in zip(values, kinds, strict=False) for part in convert(value, kind, self.name)]

    def _wrong_count(self, count: int) -> TypeError:
        return TypeError(f"{self.name} takes {len(self.signature)} arguments, got {count}")

    def open(self) -> None:
        """Make the kernel ready: load its machine code, or compile it and tell what is being waited for."""
        if self._entry is not None or self._python is not None:
            return
        with self._lock:
            if self._entry is not None or self._python is not None:
                return
            if _jit.MODE != "compiled":
                self._python = getattr(importlib.import_module(self.module), self.function)
                return
            path = self._path()
            found = _read(path)
            if found is None:
                started = time.perf_counter()
                _log.warning("compiling %s for this machine; this happens once", self.what)
                from ._compile import compile_door

                found = compile_door(getattr(importlib.import_module(self.module), self.function), self.signature)
                _log.info("compiled %s in %.1f s", self.what, time.perf_counter() - started)
                _write(path, *found)
            self._entry, self._keep = _load(*found)

    def is_cached(self) -> bool:
        """Whether opening it compiles nothing."""
        return self._entry is not None or _jit.MODE != "compiled" or self._path().exists()

    def _path(self) -> Path:
        return cache_folder() / f"{self.function}-{self._key()}.o"

    def _key(self) -> str:
        digest = hashlib.blake2b(_machine(), digest_size=12)
        digest.update(f"{self.name} {[(np.dtype(k.dtype).descr, *k[1:]) for k in self.signature]}".encode())
        for module in sorted(_closure(self.module)):
            digest.update(module.encode() + _source(module))
        return digest.hexdigest()


def warm_up(on_event: Callable[[str], None] | None = None, processes: int = 1) -> int:
    """Compile every door ahead of its first use. Returns how many were not in the cache.

    Parameters
    ----------
    on_event : callable, optional
        Takes what is compiled, or ready.
    processes : int
        How many compile side by side; a compiler keeps one core busy.
    """
    for declaring in _DECLARING:
        importlib.import_module(declaring)
    missing = [door for door in _registry.values() if not door.is_cached()]
    if processes > 1 and len(missing) > 1:
        _compile_apart(missing, processes, on_event)
    for door in _registry.values():
        if on_event is not None and (processes == 1 or door not in missing):
            on_event(door.what)
        door.open()
    return len(missing)


def _compile_apart(missing: list[Door], processes: int, on_event: Callable[[str], None] | None) -> None:
    """Compile doors in processes of their own, the one with most arguments first: it takes longest."""
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor, as_completed

    in_order = sorted(missing, key=lambda door: -len(door.signature))
    with ProcessPoolExecutor(min(processes, len(missing)), multiprocessing.get_context("spawn")) as pool:
        waiting = {pool.submit(_compile_one, door.name): door for door in in_order}
        try:
            for done in as_completed(waiting):
                done.result()
                if on_event is not None:
                    on_event(waiting[done].what)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _compile_one(name: str) -> None:
    """Compile one door; what is worth saying, the process that asked says."""
    _log.disabled = True
    for declaring in _DECLARING:
        importlib.import_module(declaring)
    _registry[name].open()


# --- arguments: Numba's own calling convention ---------------------------------------------------------------------------


def _checked(value: Any, kind: Array | Scalar, name: str) -> list[Any]:
    """The argument alone, a scalar as a NumPy scalar; TypeError if the kernel was not declared for it."""
    dtype = np.dtype(kind.dtype)
    if isinstance(kind, Scalar):
        try:
            return [dtype.type(operator.index(value) if dtype.kind == "i" else value)]
        except (TypeError, ValueError, OverflowError):
            raise TypeError(f"{name} needs a {dtype} number, got {value!r}") from None
    if not isinstance(value, np.ndarray) or value.dtype != dtype or value.ndim != kind.ndim or not value.flags.c_contiguous:
        found = f"{value.dtype} of shape {value.shape}" if isinstance(value, np.ndarray) else repr(value)
        raise TypeError(f"{name} needs a contiguous {dtype} array with {kind.ndim} dimensions, got {found}")
    return [value]


def _flatten(value: Any, kind: Array | Scalar, name: str) -> list[Any]:
    """The machine values of one argument; an array has owner, parent, size, item size, data, shape, strides (numba.core)."""
    (checked,) = _checked(value, kind, name)
    if isinstance(kind, Scalar):
        return [checked.item()]
    return [0, 0, checked.size, checked.itemsize, _address(checked), *checked.shape, *checked.strides]


def _address(array: NDArray[Any]) -> int:
    """Where an array's numbers begin, found in a third of the time that ``array.ctypes.data`` takes: a picture hands over a hundred."""
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))  # type: ignore[arg-type]  # an array is a buffer
    except (TypeError, ValueError, BufferError):  # not to be written to, or empty
        return array.ctypes.data


_RESULT_SLOTS = 16
_SLOTS = {"q": "q", "l": "q", "f": "f4x", "d": "d"}


def _packer(signature: Signature) -> struct.Struct:
    """How arguments lie in memory for `limner._compile`'s entry: eight bytes for each machine value."""
    parts = (_SLOTS[np.dtype(k.dtype).char] if isinstance(k, Scalar) else "QQqqQ" + "q" * (2 * k.ndim) for k in signature)
    return struct.Struct("=" + "".join(parts))


# --- machine code ---------------------------------------------------------------------------------------------------------

_engines_lock = threading.Lock()


def _load(code: bytes, symbol: str) -> tuple[Callable[..., int], Any]:
    import llvmlite.binding as llvm

    with _engines_lock:
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        machine = llvm.Target.from_default_triple().create_target_machine()
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        address = engine.get_function_address(symbol)
    return ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p)(address), engine


def _machine() -> bytes:
    """Everything but the sources that decides about the machine code."""
    import llvmlite.binding as llvm

    parts = [llvm.get_process_triple(), *_processor()]
    parts += [f"{k}={v}" for k, v in sorted(os.environ.items()) if k.startswith("NUMBA_") and k != "NUMBA_CACHE_DIR"]
    text = "\n".join(parts).encode()
    for package in ("numba", "llvmlite"):
        found = importlib.util.find_spec(package)
        if found is not None and found.origin:
            text += (Path(found.origin).parent / "_version.py").read_bytes()
    return text


def _processor() -> tuple[str, str]:
    """Name and features of the CPU that code is made for: this one, or one that Numba is told of (``NUMBA_CPU_NAME=generic``)."""
    import llvmlite.binding as llvm

    name = os.environ.get("NUMBA_CPU_NAME", "")
    features = os.environ.get("NUMBA_CPU_FEATURES", "" if name.lower() == "generic" else None)
    if name and features is not None:
        return name, features
    return llvm.get_host_cpu_name(), str(sorted(llvm.get_host_cpu_features().items()))


# --- sources --------------------------------------------------------------------------------------------------------------

_IMPORT = re.compile(rb"^\s*from (\.*)([\w.]*) import ([^\n(]*|\([^)]*\))", re.MULTILINE)


@functools.cache
def _file(module: str) -> str | None:
    if module.partition(".")[0] != __package__:
        return None
    base = os.path.join(_PACKAGE, *module.split(".")[1:])
    return next((path for path in (f"{base}.py", os.path.join(base, "__init__.py")) if os.path.isfile(path)), None)


@functools.cache
def _source(module: str) -> bytes:
    path = _file(module)
    return Path(path).read_bytes() if path is not None else b""


@functools.cache
def _imports(module: str) -> tuple[str, ...]:
    """The modules of limner that a module imports relatively. Found once: the doors of a picture share most of what they reach."""
    path, found = _file(module), []
    parts = module.split(".")
    package = parts if path is not None and path.endswith("__init__.py") else parts[:-1]
    for dots, name, imported in _IMPORT.findall(_source(module)):
        if not dots:
            continue
        target = ".".join([*package[: len(package) - len(dots) + 1], *(name.decode().split(".") if name else [])])
        names = [part.strip().split(" ")[0] for part in imported.decode().strip("()").split(",")]
        submodules = [f"{target}.{part}" for part in names if part and _file(f"{target}.{part}") is not None]
        found.extend(submodules or [target])
    return tuple(found)


def _closure(module: str) -> set[str]:
    """The modules of limner that `module` reaches by relative imports, itself included."""
    found: set[str] = set()
    waiting = [module, "limner._jit", "limner._compile"]
    while waiting:
        current = waiting.pop()
        if current not in found:
            found.add(current)
            waiting.extend(_imports(current))
    return found


# --- the cache ------------------------------------------------------------------------------------------------------------


def cache_folder() -> Path:
    """Where machine code is kept."""
    named = os.environ.get("LIMNER_CACHE_DIR")
    if named:
        return Path(named)
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(base) if base else Path(os.path.expanduser("~")) / ".cache") / "limner"


def _read(path: Path) -> tuple[bytes, str] | None:
    """Code and symbol, or None where there is none or it is damaged."""
    try:
        data = path.read_bytes()
    except OSError:
        return None
    digest, _, rest = data.partition(b"\n")
    symbol, _, code = rest.partition(b"\n")
    if digest != hashlib.blake2b(rest, digest_size=16).hexdigest().encode() or not code:
        return None
    return code, symbol.decode()


def _write(path: Path, code: bytes, symbol: str) -> None:
    rest = symbol.encode() + b"\n" + code
    data = hashlib.blake2b(rest, digest_size=16).hexdigest().encode() + b"\n" + rest
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
            os.replace(temporary, path)
        except OSError:
            os.unlink(temporary)
            raise
        _prune(path.parent)
    except OSError as error:
        advice = "set LIMNER_CACHE_DIR to a writable folder"
        _log.warning("the compiled code could not be kept in %s (%s); %s", path.parent, error, advice)


def _prune(folder: Path) -> None:
    """Keep the most recently written files."""
    files = sorted(folder.glob("*.o"), key=lambda file: file.stat().st_mtime, reverse=True)
    for file in files[_KEPT_FILES:]:
        file.unlink(missing_ok=True)
