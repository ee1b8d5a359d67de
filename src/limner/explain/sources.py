"""Who says that a formula is so: what a kernel's docstring cites, else its module's, else the chapter of its room."""

from __future__ import annotations

import importlib
import re

__all__ = ["formula_of", "source_of"]

_BOOK = re.compile(r"FoCG[ \n]+\d+(?:\.\d+)*(?:(?:, | and |-|;[ \n]*)\d+(?:\.\d+)*)*")
_BRACKETED = re.compile(r" \(FoCG [^()]*\)")
_NAMED = re.compile(r"\*\*Source\*\*: (.*?)(?:\n\s*\n|\Z)", re.DOTALL)
_PAPER = re.compile(r"\(([A-Z][^()]{2,80}?\b(?:19|20)\d\d\b[^()]*)\)")
_STANDARD = re.compile(r"KHR_\w+|glTF 2\.0")

_CHAPTERS = {
    "accel": "FoCG 12.3", "intersect": "FoCG 4.4", "kernel": "FoCG 2", "linear": "FoCG 6, 7",
    "raster": "FoCG 8", "raytrace": "FoCG 4, 13, 23",
    "shading": "FoCG 4.5, 10, 11", "visibility": "FoCG 4.7",
}  # fmt: skip
"""What each room is about."""


def formula_of(name: str) -> str:
    """The first sentence of a kernel's docstring on one line: its formula, or what it does."""
    text = " ".join(_docstring(name).split("\n\n")[0].split())
    return _BRACKETED.sub("", text).rstrip(".")


def source_of(name: str) -> str:
    """What the kernel ``module.function`` refers to: FoCG's sections, papers, standards; the room's chapters where nothing is cited.

    >>> source_of("limner.shading.phong.eval_blinn_phong")
    'FoCG 4.5.2, 10.2'
    """
    module = name.rpartition(".")[0]
    found = _cited(_docstring(name), with_papers=True) or _cited(_docstring(module), with_papers=False)
    if found:
        return found
    room = module.split(".")[1] if module.count(".") else ""
    return _CHAPTERS.get(room, "")


def _cited(text: str, *, with_papers: bool) -> str:
    """What a text refers to. The papers that a module speaks of are about some of its kernels only."""
    named = _NAMED.search(text)
    if named:
        return " ".join(named[1].split()).replace("*", "").rstrip(".")
    papers = _PAPER.findall(text) if with_papers else ()
    found = [" ".join(match.split()) for match in (*_BOOK.findall(text), *papers, *_STANDARD.findall(text))]
    return "; ".join(dict.fromkeys(part.replace("*", "") for part in found if not _is_within(part, found)))


def _is_within(part: str, others: list[str]) -> bool:
    return any(part != other and part in other for other in others)


def _docstring(name: str) -> str:
    """Of a module, or of something in one; empty where there is none."""
    try:
        return importlib.import_module(name).__doc__ or ""
    except ImportError:
        module, _, function = name.rpartition(".")
    try:
        return getattr(importlib.import_module(module), function).__doc__ or "" if module else ""
    except (ImportError, AttributeError):
        return ""
