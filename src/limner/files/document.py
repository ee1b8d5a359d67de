"""Typed access to a JSON document that somebody else wrote.

Any value of a foreign file may be of any type. An `Element` is a value together with its place (a JSON pointer, RFC 6901);
whoever takes something out of it says what it must be, and gets either that or a FileFormatError with the place:

    model.gltf, /meshes/0/primitives/1/material: must be an index below 3, got 7
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from typing import Any, NoReturn

from ..errors import FileFormatError
from .notes import quoted

__all__ = ["Element", "parse_json"]

MAX_EXACT_INTEGER = 2**53
GREATEST_SINGLE = (2.0 - 2.0**-23) * 2.0**127


def parse_json(data: bytes | memoryview, path: str | os.PathLike[str]) -> Element:
    """Parse UTF-8 JSON (RFC 8259, so neither NaN nor Infinity) whose top is an object; a byte order mark is skipped.

    Raises FileFormatError with line and column, also for nesting beyond what the parser can follow.
    """
    try:
        text = str(data, "utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileFormatError("must be UTF-8 text", path, f"byte {error.start} of the JSON") from None
    try:
        value = json.loads(text, parse_constant=_no_constant)
    except json.JSONDecodeError as error:
        raise FileFormatError(f"not valid JSON: {error.msg}", path, f"line {error.lineno}, column {error.colno}") from None
    except RecursionError:
        raise FileFormatError("not readable JSON: it is nested too deep", path) from None
    except ValueError as error:
        raise FileFormatError(f"not valid JSON: {error}", path) from None
    if not isinstance(value, dict):
        raise FileFormatError(f"the JSON must be an object, got {type(value).__name__}", path)
    return Element(value, "", os.fspath(path))


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not allowed")


class Element:
    """A JSON value that knows where it stands.

    Parameters
    ----------
    value : Any
    pointer : str
        "/meshes/0"; empty for the whole document.
    path : str
        The file.
    """

    __slots__ = ("path", "pointer", "value")

    def __init__(self, value: Any, pointer: str, path: str) -> None:
        self.value = value
        self.pointer = pointer
        self.path = path

    def error(self, message: str, key: str | int | None = None) -> FileFormatError:
        """Make (not raise) the error that stands at this element, or at its member `key`."""
        return FileFormatError(message, self.path, self.pointer if key is None else self._below(key))

    def _below(self, key: str | int) -> str:
        escaped = key.replace("~", "~0").replace("/", "~1") if isinstance(key, str) else key
        return f"{self.pointer}/{escaped}"

    def _object(self) -> dict[str, Any]:
        if not isinstance(self.value, dict):
            raise self.error(f"must be an object, got {quoted(self.value)}")
        return self.value

    def has(self, key: str) -> bool:
        """Whether this object has the member `key`."""
        return key in self._object()

    def keys(self) -> list[str]:
        """The names of this object's members."""
        return list(self._object())

    def get(self, key: str) -> Element | None:
        """The member `key` of this object, or None."""
        members = self._object()
        return Element(members[key], self._below(key), self.path) if key in members else None

    def child(self, key: str) -> Element:
        """The member `key` of this object, which must be there."""
        found = self.get(key)
        if found is None:
            raise self.error("is missing", key)
        return found

    def extension(self, name: str) -> Element | None:
        """The extension object `name` of this object, or None."""
        extensions = self.get("extensions")
        found = extensions.get(name) if extensions is not None else None
        if found is not None:
            found._object()
        return found

    def elements(self) -> list[Element]:
        """The elements of this array."""
        if not isinstance(self.value, list):
            raise self.error(f"must be an array, got {quoted(self.value)}")
        return [Element(value, self._below(i), self.path) for i, value in enumerate(self.value)]

    def array(self, key: str) -> list[Element]:
        """The elements of the array `key`; none where it is missing."""
        found = self.get(key)
        return found.elements() if found is not None else []

    def number(self, least: float = -math.inf, most: float = math.inf) -> float:
        """This value as a float in [least, most], finite in single precision too: that is what pictures are computed in."""
        value = self.value
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.error(f"must be a number, got {quoted(value)}")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not abs(number) <= GREATEST_SINGLE:
            raise self.error("must be a number that 32 bits can hold")
        if not least <= number <= most:
            bounds = f"at least {least:g}" if most == math.inf else f"in [{least:g}, {most:g}]"
            raise self.error(f"must be {bounds}, got {number:g}")
        return number

    def get_number(self, key: str, default: float, least: float = -math.inf, most: float = math.inf) -> float:
        """The number `key`, or `default`."""
        found = self.get(key)
        return default if found is None else found.number(least, most)

    def integer(self, least: int = 0) -> int:
        """This value as an integer >= least; 5.0 counts as 5."""
        value = self.value
        if isinstance(value, float) and value.is_integer() and abs(value) <= MAX_EXACT_INTEGER:
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int):
            raise self.error(f"must be an integer, got {quoted(value)}")
        if value < least:
            raise self.error(f"must be at least {least}, got {quoted(value)}")
        return value

    def get_integer(self, key: str, default: int, least: int = 0) -> int:
        """The integer `key`, or `default`."""
        found = self.get(key)
        return default if found is None else found.integer(least)

    def index(self, limit: int) -> int:
        """This value as an index into something of `limit` elements."""
        value = self.integer()
        if value >= limit:
            expected = f"an index below {limit}" if limit else "absent, since there is nothing to refer to"
            raise self.error(f"must be {expected}, got {quoted(value)}")
        return value

    def text(self) -> str:
        """This value as a string."""
        if not isinstance(self.value, str):
            raise self.error(f"must be a string, got {quoted(self.value)}")
        return self.value

    def get_text(self, key: str, default: str = "") -> str:
        """The string `key`, or `default`."""
        found = self.get(key)
        return default if found is None else found.text()

    def get_flag(self, key: str, default: bool) -> bool:
        """The boolean `key`, or `default`."""
        found = self.get(key)
        if found is None:
            return default
        if not isinstance(found.value, bool):
            raise found.error(f"must be true or false, got {quoted(found.value)}")
        return found.value

    def get_numbers(self, key: str, default: tuple[float, ...], least: float = -math.inf, most: float = math.inf) -> tuple[float, ...]:
        """The array `key` of as many numbers as `default` has, or `default`."""
        found = self.get(key)
        if found is None:
            return default
        elements = found.elements()
        if len(elements) != len(default):
            raise found.error(f"must be {len(default)} numbers, got {len(elements)}")
        return tuple(element.number(least, most) for element in elements)

    def name(self) -> str:
        """The member "name" where it is a string; a bad name is no reason to refuse anything."""
        value = self.value.get("name") if isinstance(self.value, dict) else None
        return value if isinstance(value, str) else ""

    def __iter__(self) -> Iterator[Element]:
        return iter(self.elements())
