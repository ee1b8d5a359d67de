"""Progress on a terminal: one line on standard error, and only where someone is there to see it and has to wait."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import Any, TextIO

from ..progress import Progress

__all__ = ["Bar"]

PATIENCE = 0.5  # seconds that nobody minds


class Bar:
    """A callable that shows `Progress`; a context manager that tidies up.

    Parameters
    ----------
    enabled : bool
        False: say nothing.
    stream : text file, optional
        Default: standard error. Nothing is shown where it is no terminal.
    """

    def __init__(self, *, enabled: bool = True, stream: TextIO | None = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._enabled = enabled and self._stream.isatty()
        self._rich: Any = None
        self._task: Any = None
        self._plain = False

    def __enter__(self) -> Bar:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._rich is not None:
            self._rich.stop()
        elif self._plain:
            self._stream.write("\r\x1b[K")
            self._stream.flush()

    def __call__(self, progress: Progress) -> None:
        """Show where the work is, if it has taken long enough to wonder."""
        if not self._enabled or progress.elapsed < PATIENCE:
            return
        if self._rich is None and not self._plain:
            self._open()
        if self._rich is not None:
            self._rich.update(self._task, completed=progress.done, description=progress.what)
        else:
            left = "" if progress.remaining is None else f", {progress.remaining:.0f} s left"
            self._stream.write(f"\r\x1b[K{progress.what}: {progress.done:.0%}{left}")
            self._stream.flush()

    def _open(self) -> None:
        try:
            from rich.console import Console
            from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn
            from rich.progress import Progress as RichProgress
        except ImportError:
            self._plain = True
            return
        columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
        self._rich = RichProgress(*columns, console=Console(file=self._stream), transient=True)
        self._task = self._rich.add_task("", total=1.0)
        self._rich.start()
