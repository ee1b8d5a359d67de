"""What a reader says about a file that it could read, but not to the letter.

A note is one line for `Scene.notes`: something approximated, ignored or repaired. A slip is a note that somebody probably
wants to hear at once: a missing texture, a broken primitive; it is a warning too.

Every note has a kind, for `limner.load_report`. A reader may say which; where it does not, the words tell: what "is left out" was
ignored, what "stands in" replaced something.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from ..errors import FileFormatError

__all__ = ["MAX_NOTES", "Kind", "Notes", "Remark", "kind_of", "quoted", "without_path"]

Kind = Literal["read", "approximated", "ignored", "replaced", "repaired"]

MAX_NOTES = 100
MAX_SLIPS = 10
MAX_LENGTH = 300


def quoted(value: object, length: int = 60) -> str:
    """Return the repr of something from a file, on one line and cut to `length` characters; of containers only the kind.

    >>> quoted("a" * 100, 10)
    "'aaaaaaaa…"
    """
    if isinstance(value, (dict, list)):
        return "an object" if isinstance(value, dict) else "an array"
    text = repr(value if not isinstance(value, str) else value[: length + 1])
    return text if len(text) <= length else text[: length - 1] + "…"


def without_path(error: Exception) -> str:
    """Return an error's message without the file it begins with: a scene's notes are all about one file."""
    text = str(error)
    return text.removeprefix(error.path).removeprefix(", ").removeprefix(": ") if isinstance(error, FileFormatError) else text


# In this order: "its normals are replaced" is a repair, "the default material stands in" is not.
_WORDS: tuple[tuple[Kind, str], ...] = (
    ("repaired", r"normals .*are replaced|not finite are set to|are made |cut off|clipped to|shown once|its last row is taken as|"
                 r"more than one parent|does not end where|is closed"),
    ("replaced", r"stands? in\b|stands? for|drawn in gr[ea]y|in its place|is taken for|is replaced by|as it is at rest"),
    ("ignored", r"ignored|not drawn|left out|leaves out|drawn without|shown without|morphed without|is not morphed|neither morphed|"
                r"does not move|"
                r"has no (?:light|camera)|stays where its parent is|stays as it is|shows its mesh once|shows? (?:nothing|none)|not read|"
                r"only the default one|not led by|not told apart|not supported"),
    ("read", r"they are kept|is shown:|the first scene is read"),
)  # fmt: skip


def kind_of(text: str) -> Kind:
    """Return the kind of a remark, told by its words; "approximated" where they do not say.

    >>> kind_of("extension 'KHR_x' is ignored"), kind_of("illum 2 is drawn as a matte surface")
    ('ignored', 'approximated')
    """
    return next((kind for kind, words in _WORDS if re.search(words, text)), "approximated")


class Remark(NamedTuple):
    """What was said: its kind, the text, the first place it was said of, what it is about ("bsdf roughplastic"), and of how many places."""

    kind: Kind
    text: str
    where: str
    what: str
    n_places: int


class Notes:
    """One-line remarks, the first hundred of them; what is said of several places is said once, with their number.

    Attributes
    ----------
    settings : dict
        What the file says about how its picture is to be made, as arguments of `limner.render`.
    """

    def __init__(self) -> None:
        self._remarks: dict[str, _Remark] = {}
        self._n_dropped = 0
        self.settings: dict[str, Any] = {}

    def add(self, text: str, where: str = "", *, slip: bool = False, kind: Kind | None = None, what: str = "") -> None:
        """Keep a remark about the place `where`; `slip` makes it a warning too. `kind` None: told by the words."""
        line = " ".join(text.split())
        line = line if len(line) <= MAX_LENGTH else line[: MAX_LENGTH - 1] + "…"
        remark = self._remarks.get(line)
        if remark is not None:
            remark.n_places += 1
            remark.slip |= slip
        elif len(self._remarks) < MAX_NOTES:
            self._remarks[line] = _Remark(line, where, slip, kind or kind_of(line), what)
        else:
            self._n_dropped += 1

    def slip(self, text: str, where: str = "", *, kind: Kind | None = None, what: str = "") -> None:
        """Keep a remark that is worth a warning."""
        self.add(text, where, slip=True, kind=kind, what=what)

    def absorb(self, other: Notes, name: str) -> None:
        """Keep what was said about a file that this one refers to by `name`."""
        for remark in other._remarks.values():
            place = ", ".join(part for part in (name, remark.where) if part)
            self.add(remark.text, place, slip=remark.slip, kind=remark.kind, what=remark.what)
        self._n_dropped += other._n_dropped

    def remarks(self) -> Iterator[Remark]:
        """Everything that was kept, in order, in parts."""
        for remark in self._remarks.values():
            yield Remark(remark.kind, remark.text, remark.where, remark.what, remark.n_places)

    @property
    def n_dropped(self) -> int:
        """How many remarks were too many to be kept."""
        return self._n_dropped

    def lines(self) -> tuple[str, ...]:
        """Everything that was said, in order."""
        more = (f"and {self._n_dropped} more such remarks",) if self._n_dropped else ()
        return (*map(str, self._remarks.values()), *more)

    def warnings(self) -> tuple[str, ...]:
        """The slips; the first ten, and how many there were."""
        slips = [str(remark) for remark in self._remarks.values() if remark.slip]
        more = (f"and {len(slips) - MAX_SLIPS} more; scene.notes has them",) if len(slips) > MAX_SLIPS else ()
        return (*slips[:MAX_SLIPS], *more)


@dataclass
class _Remark:
    text: str
    where: str
    slip: bool
    kind: Kind
    what: str
    n_places: int = 1

    def __str__(self) -> str:
        if not self.where:
            return self.text
        return f"{self.where}{f' and {self.n_places - 1} more' if self.n_places > 1 else ''}: {self.text}"
