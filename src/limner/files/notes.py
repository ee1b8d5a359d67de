"""What a reader says about a file that it could read, but not to the letter.

A note is one line for `Scene.notes`: something approximated, ignored or repaired. A slip is a note that somebody probably
wants to hear at once: a missing texture, a broken primitive; it is a warning too.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import FileFormatError

__all__ = ["MAX_NOTES", "Notes", "quoted", "without_path"]

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


class Notes:
    """One-line remarks, the first hundred of them; what is said of several places is said once, with their number."""

    def __init__(self) -> None:
        self._remarks: dict[str, _Remark] = {}
        self._n_dropped = 0

    def add(self, text: str, where: str = "", *, slip: bool = False) -> None:
        """Keep a remark about the place `where`; `slip` makes it a warning too."""
        line = " ".join(text.split())
        line = line if len(line) <= MAX_LENGTH else line[: MAX_LENGTH - 1] + "…"
        remark = self._remarks.get(line)
        if remark is not None:
            remark.n_places += 1
            remark.slip |= slip
        elif len(self._remarks) < MAX_NOTES:
            self._remarks[line] = _Remark(line, where, slip)
        else:
            self._n_dropped += 1

    def slip(self, text: str, where: str = "") -> None:
        """Keep a remark that is worth a warning."""
        self.add(text, where, slip=True)

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
    n_places: int = 1

    def __str__(self) -> str:
        if not self.where:
            return self.text
        return f"{self.where}{f' and {self.n_places - 1} more' if self.n_places > 1 else ''}: {self.text}"
