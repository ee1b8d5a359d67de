"""Docstrings as Markdown.

The docstrings of limner are prose with NumPy's sections: indented blocks are code or drawings, single backticks are code, `|v|` is a length
and `*` a product. That is Markdown but for the sections, so this turns those into lists and hands everything else over as it stands.
"""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Callable, Iterator, Sequence

__all__ = ["first_paragraph", "markdown_of"]

_LISTS = {"Parameters", "Returns", "Yields", "Raises", "Attributes"}
_TAG = re.compile(r"<(?=[A-Za-z/!])")


def markdown_of(docstring: str | None) -> str:
    """Return the Markdown of a docstring as it stands in the source."""
    return "\n".join(_blocks(inspect.cleandoc(docstring or "").split("\n")))


def first_paragraph(docstring: str | None) -> str:
    """Return what a docstring opens with, on one line."""
    return _shown(" ".join(inspect.cleandoc(docstring or "").split("\n\n")[0].split()))


def _blocks(lines: Sequence[str]) -> Iterator[str]:
    at = 0
    while at < len(lines):
        if at + 1 < len(lines) and re.fullmatch(r"-{3,}", lines[at + 1]):
            title, start = lines[at], at + 2
            yield f"\n**{title}**\n"
            at = _end_of_list(lines, start) if title in _LISTS else start
            yield from _list(lines[start:at])
        elif lines[at].startswith(">>>"):
            end = _end(lines, at, lambda line: line.strip() != "")
            yield _fenced("pycon", lines[at:end])
            at = end
        elif lines[at].startswith("    "):
            end = _end(lines, at, lambda line: line.startswith("    ") or not line.strip())
            code = inspect.cleandoc("\n".join(["", *lines[at:end]])).rstrip().split("\n")
            yield _fenced("python" if _is_python(code) else "text", code)
            at = end
        else:
            yield _shown(lines[at])
            at += 1


def _end(lines: Sequence[str], start: int, belongs: Callable[[str], bool]) -> int:
    end = start
    while end < len(lines) and belongs(lines[end]):
        end += 1
    return end


def _end_of_list(lines: Sequence[str], start: int) -> int:
    """A list ends at a blank line after which nothing is indented."""
    for at in range(start, len(lines)):
        if not lines[at].strip() and (at + 1 == len(lines) or not lines[at + 1].startswith(" ")):
            return at
    return len(lines)


def _list(lines: Sequence[str]) -> Iterator[str]:
    """`name : type` with what is said about it below, as a list of definitions."""
    at = 0
    while at < len(lines):
        end = _end(lines, at + 1, lambda line: line.startswith(" ") or not line.strip())
        said = list(_blocks(inspect.cleandoc("\n".join(["", *lines[at + 1 : end]])).split("\n")))
        name, colon, kind = lines[at].partition(" : ")
        term = f"`{name}` {_shown(kind)}" if colon and "`" not in name else _shown(lines[at])
        if any(line.strip() for line in said):
            text = "\n".join(said).strip("\n").split("\n")
            yield "\n".join([term, f": {text[0]}", *(f"  {line}" if line else "" for line in text[1:]), ""])
        else:
            yield f"{term}\n"
        at = end


def _shown(line: str) -> str:
    """A line of prose: what stands in angles is no tag of HTML."""
    parts = re.split(r"(``.+?``|`[^`]+`)", line)
    return "".join(part if part.startswith("`") else _TAG.sub(r"\\<", part) for part in parts)


def _is_python(lines: Sequence[str]) -> bool:
    try:
        ast.parse("\n".join(lines))
    except SyntaxError:
        return False
    return True


def _fenced(language: str, lines: Sequence[str]) -> str:
    return "\n".join(["", f"```{language}", *lines, "```", ""])
