"""Turning the words of a command line into values, or saying what was expected."""

from __future__ import annotations

import math
import re
from typing import Any

import click

__all__ = ["BACKGROUND", "INTERVAL", "TRIPLE", "WORDS", "Background", "Triple"]

Triple = tuple[float, float, float]
Background = Triple | str

_NAMED = {"black": (0.0, 0.0, 0.0), "white": (1.0, 1.0, 1.0), "gray": (0.18, 0.18, 0.18), "grey": (0.18, 0.18, 0.18)}


class _TripleType(click.ParamType[Triple]):
    name = "x,y,z"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Triple:
        if isinstance(value, tuple):
            return value
        try:
            x, y, z = (float(part) for part in str(value).split(","))
        except ValueError:
            self.fail(f"expected three numbers X,Y,Z, got {value!r}", param, ctx)
        if not all(math.isfinite(number) for number in (x, y, z)):
            self.fail(f"expected finite numbers, got {value!r}", param, ctx)
        return x, y, z


class _BackgroundType(click.ParamType[Background]):
    name = "color"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Background:
        word = str(value).strip().lower()
        if word in ("transparent", "environment"):
            return word
        if word in _NAMED:
            return _NAMED[word]
        if re.fullmatch(r"#[0-9a-f]{6}", word):
            from ..color.transfer import linear_from_srgb

            red, green, blue = linear_from_srgb([int(word[at : at + 2], 16) / 255.0 for at in (1, 3, 5)]).tolist()
            return red, green, blue
        try:
            numbers = tuple(float(part) for part in word.split(","))
        except ValueError:
            numbers = ()
        if len(numbers) != 3 or not all(math.isfinite(number) and number >= 0.0 for number in numbers):
            expected = "environment, transparent, black, white, gray, #RRGGBB (sRGB) or R,G,B (linear light, not negative)"
            self.fail(f"expected {expected}, got {value!r}", param, ctx)
        return numbers


class _IntervalType(click.ParamType[tuple[float, float]]):
    name = "first,last"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[float, float]:
        if isinstance(value, tuple):
            return value
        try:
            first, last = (float(part) for part in str(value).split(","))
        except ValueError:
            self.fail(f"expected two numbers FIRST,LAST, got {value!r}", param, ctx)
        if not (math.isfinite(first) and math.isfinite(last) and first <= last):
            self.fail(f"expected two finite numbers, the second not below the first, got {value!r}", param, ctx)
        return first, last


class _WordsType(click.ParamType[tuple[str, ...]]):
    """Names with commas between them, each once."""

    name = "name,name,…"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, ...]:
        if isinstance(value, tuple):
            return value
        return tuple(dict.fromkeys(word.strip() for word in str(value).split(",") if word.strip()))


TRIPLE = _TripleType()
INTERVAL = _IntervalType()
BACKGROUND = _BackgroundType()
WORDS = _WordsType()
