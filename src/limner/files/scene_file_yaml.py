"""YAML as text and as plain values that know their lines.

Only the grammar is a library's (PyYAML, and libyaml in it): it cuts the text into events. What they mean is decided here, so that a file
can say nothing but mappings, lists, text, numbers, flags and nothing: there are no tags to make objects with. Scalars are those of YAML
1.2's core schema (`yes` is a word, `1e3` a number). Aliases are followed, and what they stand for counts as often as it stands there: a
few lines that would unfold to gigabytes are refused, as are keys that are given twice, and nesting without end.

**Source**: YAML 1.2.2, 10.3 (core schema).
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import yaml  # type: ignore[import-untyped]

from ..errors import FileFormatError, UnsupportedError
from .notes import quoted

__all__ = ["MAX_BYTES", "MAX_NESTING", "MAX_VALUES", "Document", "Where", "compose", "emit", "spelled"]

MAX_BYTES = 32 << 20
"""Of the text; large arrays stand in a file beside it."""

MAX_NESTING = 300
"""How deep mappings and lists may stand in each other."""

MAX_VALUES = 4_000_000
"""Of one document, aliases counted as often as they stand there."""

Where = tuple[str | int, ...]
"""The way from the top of a document to a place in it: keys and numbers."""

_WIDTH = 110
_LONGEST_NUMBER = 400  # characters

_NOTHING = {"": None, "~": None, "null": None, "Null": None, "NULL": None}
_FLAGS = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_INTEGER = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_NUMBER = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_WITHOUT_END = re.compile(r"([-+]?)\.(?:inf|Inf|INF)")
_NO_NUMBER = re.compile(r"\.(?:nan|NaN|NAN)")
_OLD_FLAGS = {"y", "n", "yes", "no", "on", "off"}  # flags of YAML 1.1, which other readers may take for such


class Document:
    """What a file holds, and in which lines.

    Parameters
    ----------
    path : path-like
    top : plain value
    lines : dict
        Of each mapping and list, by `id`: its line, and those of its entries.
    """

    def __init__(self, path: str | os.PathLike[str], top: Any, lines: dict[int, tuple[int, Any]]) -> None:
        self.path = path
        self.top = top
        self._lines = lines

    def line_of(self, where: Where) -> int:
        """The line of a place; of one that is not there, that of the last one on the way to it."""
        value, line = self.top, self._lines.get(id(self.top), (1, None))[0]
        for step in where:
            _, entries = self._lines.get(id(value), (0, {}))
            try:
                line, value = entries[step], value[step]
            except (KeyError, IndexError, TypeError):
                break
        return line

    def error(self, where: Where, text: str) -> FileFormatError:
        """What is wrong with a place, as an error that says where it is."""
        place = f"line {self.line_of(where)}"
        return FileFormatError(text, self.path, f"{place}, {spelled(where)}" if where else place)


def spelled(where: Where) -> str:
    """A place in words.

    >>> spelled(("nodes", 3, "shapes", 0, "sphere", "radius"))
    'nodes[3].shapes[0].sphere.radius'
    """
    parts = [f"[{step}]" if isinstance(step, int) else f".{step}" for step in where]
    return "".join(parts).removeprefix(".")


# --- reading --------------------------------------------------------------------------------------------------------------


class _Kept(NamedTuple):
    """What an alias may stand for: the value, how many values it is, and how deep they stand in each other."""

    value: Any
    n_values: int
    height: int


class _Open:
    """A mapping or list that has not ended yet."""

    def __init__(self, value: Any, line: int, anchor: str | None, count: int) -> None:
        self.value, self.line, self.anchor, self.count = value, line, anchor, count
        self.lines: Any = {} if isinstance(value, dict) else []
        self.key: str | None = None
        self.height = 1


class _Composer:
    """Makes plain values of events, without recursion."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = path
        self.lines: dict[int, tuple[int, Any]] = {}
        self.top: Any = None
        self._stack: list[_Open] = []
        self._kept: dict[str, _Kept] = {}
        self._count = 0
        self._n_documents = 0

    def take(self, event: Any) -> None:
        line, kind = event.start_mark.line + 1, type(event)
        if kind is yaml.ScalarEvent:
            self._scalar(event, line)
        elif kind in (yaml.MappingStartEvent, yaml.SequenceStartEvent):
            self._begin(event, line)
        elif kind in (yaml.MappingEndEvent, yaml.SequenceEndEvent):
            self._end()
        elif kind is yaml.AliasEvent:
            self._alias(event, line)
        elif kind is yaml.DocumentStartEvent:
            self._n_documents += 1
            if self._n_documents > 1:
                raise self._error("must be one document, and a second one begins here", line)

    def _error(self, text: str, line: int) -> FileFormatError:
        return FileFormatError(text, self.path, f"line {line}")

    def _scalar(self, event: Any, line: int) -> None:
        if self._awaits_key():
            self._name(event.value, line)
            return
        is_text = not event.implicit[0] or event.style in ("'", '"', "|", ">")
        if event.tag not in (None, "!", "tag:yaml.org,2002:str"):
            raise self._error(f"tags are not read, got {quoted(event.tag)}", line)
        if not is_text and len(event.value) > _LONGEST_NUMBER and event.value[:1] in "+-.0123456789":
            raise self._error(f"a number must not be longer than {_LONGEST_NUMBER} characters; put text into quotes", line)
        value = event.value if is_text else _meaning(event.value)
        self._add_count(1, line)
        if event.anchor:
            self._kept[event.anchor] = _Kept(value, 1, 0)
        self._put(value, line, 0)

    def _begin(self, event: Any, line: int) -> None:
        if event.tag not in (None, "!"):
            raise self._error(f"tags are not read, got {quoted(event.tag)}", line)
        if self._awaits_key():
            raise self._error("a key must be a word", line)
        if len(self._stack) >= MAX_NESTING:
            raise self._error(f"must not be nested deeper than {MAX_NESTING}", line)
        value: Any = {} if isinstance(event, yaml.MappingStartEvent) else []
        self._stack.append(_Open(value, line, event.anchor, self._count))
        self._add_count(1, line)
        # While it is open its name means nothing: it cannot hold itself.
        self._kept.pop(event.anchor, None)

    def _end(self) -> None:
        done = self._stack.pop()
        self.lines[id(done.value)] = done.line, done.lines
        if done.anchor:
            self._kept[done.anchor] = _Kept(done.value, self._count - done.count, done.height)
        self._put(done.value, done.line, done.height)

    def _alias(self, event: Any, line: int) -> None:
        if self._awaits_key():
            raise self._error("a key must be a word", line)
        kept = self._kept.get(event.anchor)
        if kept is None:
            raise self._error(f"*{event.anchor} stands for nothing that has ended before", line)
        if len(self._stack) + kept.height > MAX_NESTING:
            raise self._error(f"must not be nested deeper than {MAX_NESTING}", line)
        self._add_count(kept.n_values, line)
        self._put(kept.value, line, kept.height)

    def _add_count(self, n: int, line: int) -> None:
        self._count += n
        if self._count > MAX_VALUES:
            raise self._error(f"holds more than {MAX_VALUES} values, with what its aliases stand for", line)

    def _awaits_key(self) -> bool:
        return bool(self._stack) and isinstance(self._stack[-1].value, dict) and self._stack[-1].key is None

    def _name(self, key: str, line: int) -> None:
        into = self._stack[-1]
        if key in into.value:
            raise self._error(f"{quoted(key)} is given twice, here and in line {into.lines[key]}", line)
        into.key = key
        into.lines[key] = line

    def _put(self, value: Any, line: int, height: int) -> None:
        if not self._stack:
            self.top = value
            return
        into = self._stack[-1]
        into.height = max(into.height, height + 1)
        if isinstance(into.value, dict):
            into.value[into.key] = value
            into.key = None
        else:
            into.value.append(value)
            into.lines.append(line)


def _meaning(text: str) -> Any:
    """What an unquoted scalar stands for."""
    if text in _NOTHING:
        return None
    if text in _FLAGS:
        return _FLAGS[text]
    if _INTEGER.fullmatch(text):
        return int(text, {"0o": 8, "0x": 16}.get(text[:2], 10))
    if _NUMBER.fullmatch(text):
        return float(text)
    without_end = _WITHOUT_END.fullmatch(text)
    if without_end:
        return -math.inf if without_end[1] == "-" else math.inf
    return math.nan if _NO_NUMBER.fullmatch(text) else text


def compose(data: bytes, path: str | os.PathLike[str]) -> Document:
    """Read a YAML text.

    Raises FileFormatError with its line: no YAML, a key given twice, too large, too deep, tags.
    """
    if len(data) > MAX_BYTES:
        raise FileFormatError(f"must not be longer than {MAX_BYTES} bytes, got {len(data)}: put arrays into a file beside it", path)
    composer = _Composer(path)
    try:
        text = data.decode("utf-8-sig")
        for event in yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
            composer.take(event)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise FileFormatError("is not UTF-8", path, f"line {line}") from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        raise FileFormatError(f"is no YAML: {error.problem or error.context}", path, f"line {mark.line + 1}" if mark else "") from None
    except yaml.YAMLError as error:
        raise FileFormatError(f"is no YAML: {' '.join(str(error).split())}", path) from None
    return Document(path, composer.top, composer.lines)


# --- writing --------------------------------------------------------------------------------------------------------------


def emit(value: dict[str, Any]) -> bytes:
    """Write plain values as YAML; `compose` gives the same values back, floats to the bit.

    Raises UnsupportedError for text that is no Unicode.
    """
    events = [
        yaml.StreamStartEvent(), yaml.DocumentStartEvent(explicit=False), *_events(value), yaml.DocumentEndEvent(explicit=False),
        yaml.StreamEndEvent(),
    ]  # fmt: skip
    try:
        text = yaml.emit(events, Dumper=getattr(yaml, "CSafeDumper", yaml.SafeDumper), allow_unicode=True, width=_WIDTH)
        return str(text).encode()
    except UnicodeEncodeError as error:
        raise UnsupportedError(f"a scene file holds Unicode text, got {quoted(error.object)}") from None


def _events(value: Any) -> Iterator[Any]:
    if isinstance(value, dict):
        yield yaml.MappingStartEvent(None, None, implicit=True, flow_style=not value or _fits_a_line(value))
        for key, held in value.items():
            yield _text(key)
            yield from _events(held)
        yield yaml.MappingEndEvent()
    elif isinstance(value, (list, tuple)):
        yield yaml.SequenceStartEvent(None, None, implicit=True, flow_style=_is_row(value))
        for held in value:
            yield from _events(held)
        yield yaml.SequenceEndEvent()
    elif isinstance(value, str):
        yield _text(value)
    else:
        yield yaml.ScalarEvent(None, None, implicit=(True, False), value=_written(value))


def _is_row(value: Any) -> bool:
    return all(_is_row(held) if isinstance(held, (list, tuple)) else not isinstance(held, dict) for held in value)


def _fits_a_line(value: dict[str, Any]) -> bool:
    if any(isinstance(held, dict) or (isinstance(held, list) and not _is_row(held)) for held in value.values()):
        return False
    return len(repr(value)) <= _WIDTH * 3 // 4


def _text(text: str) -> Any:
    plain = isinstance(_meaning(text), str) and text.lower() not in _OLD_FLAGS
    style = None if plain else '"'
    return yaml.ScalarEvent(None, None, implicit=(plain, True), value=text, style=style)


def _written(value: Any) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0.0 else "-.inf"
    mantissa, e, exponent = repr(float(value)).partition("e")
    # 1e-05 is a number in YAML 1.2 only; with the point it is one in 1.1, too.
    return f"{mantissa}.0e{exponent}" if e and "." not in mantissa else f"{mantissa}{e}{exponent}"
