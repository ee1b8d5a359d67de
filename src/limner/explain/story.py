"""A story as a tree: what was computed, from what, by which formula, and where that formula comes from.

    story.text()        the tree, a line for each step
    story.as_dict()     the same for programs
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from .values import text_of

__all__ = ["Step"]


@dataclass
class Step:
    """One step of a story.

    Attributes
    ----------
    title : str
        What happened, in words.
    terms : dict
        What it was computed from, by name: plain values, float32 as the shortest number that reads as the same.
    result : object
        What came out; None where nothing did, or where it is bulk data.
    formula : str
        What the kernel says of itself: its sentence or its formula.
    kernel : str
        ``module.function``, without the package; empty where no kernel speaks.
    source : str
        Who says that it is so: the section of *Fundamentals of Computer Graphics*, a paper, a specification.
    kind : str
        "call"; "change": of a sum; "ray"; "triangle": one that might cover the pixel; "note".
    steps : list of Step
    """

    title: str
    terms: dict[str, Any] = field(default_factory=dict)
    result: Any = None
    formula: str = ""
    kernel: str = ""
    source: str = ""
    kind: str = "call"
    steps: list[Step] = field(default_factory=list)

    def walk(self) -> Iterator[Step]:
        """Yield this step and all below it, in order."""
        yield self
        for step in self.steps:
            yield from step.walk()

    def as_dict(self) -> dict[str, Any]:
        """Plain values; what is empty is left out."""
        told: dict[str, Any] = {"title": self.title, "kind": self.kind}
        for name in ("terms", "result", "formula", "kernel", "source"):
            value = getattr(self, name)
            if value not in ("", None, {}):
                told[name] = value
        return {**told, "steps": [step.as_dict() for step in self.steps]} if self.steps else told

    @classmethod
    def from_dict(cls, told: Mapping[str, Any]) -> Step:
        """The step that `as_dict` tells of."""
        return cls(**{**told, "steps": [cls.from_dict(step) for step in told.get("steps", ())]})

    def text(self, depth: int | None = None) -> str:
        """The tree as lines, down to some depth."""
        return "\n".join(self._lines("", "", depth))

    def _lines(self, head: str, margin: str, depth: int | None, told: str = "") -> Iterator[str]:
        """Lines; a source that has been told of one step above is not repeated."""
        yield head + self.line(with_source=self.source != told and self.kind != "change")
        shown = self.steps if depth is None or depth > 0 else []
        for k, step in enumerate(shown):
            is_last = k == len(shown) - 1
            deeper = None if depth is None else depth - 1
            head, inner = margin + ("└─ " if is_last else "├─ "), margin + ("   " if is_last else "│  ")
            yield from step._lines(head, inner, deeper, self.source or told)

    def line(self, *, with_source: bool = True) -> str:
        """Title, result, terms, formula and source on one line."""
        parts = [self.title]
        if self.result is not None:
            parts.append(f"= {text_of(self.result)}")
        if self.terms:
            parts.append("; ".join(f"{name} {text_of(value)}" for name, value in self.terms.items()).join(("[", "]")))
        if self.formula and self.formula != self.title:
            parts.append(f"— {self.formula}")
        if self.source and with_source:
            parts.append(f"({self.source})")
        return " ".join(parts)
