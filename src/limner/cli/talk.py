"""What a command says on standard error: notes, warnings, what is being waited for. Standard output is for results."""

from __future__ import annotations

import logging
import sys
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TextIO

__all__ = ["Talk", "flattened"]


def flattened(text: str) -> str:
    """Return `text` on one line, without control characters that could write on a terminal."""
    return "".join(c if c.isprintable() else " " for c in " ".join(part.strip() for part in text.splitlines()))


@dataclass
class Talk:
    """One command's voice.

    Parameters
    ----------
    quiet : bool
        Say nothing but errors.
    verbose : bool
        Say what takes time, too.
    traceback : bool
        Show where an error arose.
    code : int
        What the command ends with when no error says otherwise.
    """

    quiet: bool = False
    verbose: bool = False
    traceback: bool = False
    code: int = 0
    _said: set[str] = field(default_factory=set)

    def say(self, kind: str, message: str) -> None:
        """Write ``limner: kind: message``, once."""
        line = f"limner: {kind}: {flattened(message)}"
        if self.quiet or line in self._said:
            return
        self._said.add(line)
        try:
            sys.stderr.write(line + "\n")
            sys.stderr.flush()
        except OSError:  # nobody listens, which is no reason to make no picture
            return

    def warn(self, messages: Iterable[str]) -> None:
        """Say warnings that were collected."""
        for message in messages:
            self.say("warning", message)

    def note(self, messages: Iterable[str]) -> None:
        """Say what a reader approximated, ignored or repaired."""
        for message in messages:
            if not any(line.endswith(f": {flattened(message)}") for line in self._said):  # some were warned about, too
                self.say("note", message)

    def detail(self, message: str) -> None:
        """Say what only ``--verbose`` asks for."""
        if self.verbose:
            self.say("note", message)

    @contextmanager
    def listening(self) -> Iterator[None]:
        """Turn Python's warnings, and what limner logs, into lines while the block runs."""
        handler = _Handler(self)
        logger = logging.getLogger("limner")
        with warnings.catch_warnings():
            from ..errors import LimnerWarning

            warnings.simplefilter("always", LimnerWarning)
            warnings.showwarning = self._show
            logger.addHandler(handler)
            propagate, logger.propagate = logger.propagate, False
            try:
                yield
            finally:
                logger.removeHandler(handler)
                logger.propagate = propagate

    def _show(
        self,
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        self.say("warning", str(message))


class _Handler(logging.Handler):
    def __init__(self, talk: Talk) -> None:
        super().__init__()
        self._talk = talk

    def emit(self, record: logging.LogRecord) -> None:
        message = record.getMessage()
        if record.levelno >= logging.WARNING:
            self._talk.say("note", message)
        else:
            self._talk.detail(message)
