"""Progress: as often as a person can see, and always the beginning and the end."""

from __future__ import annotations

import io

import pytest

from limner.cli.bar import Bar
from limner.progress import Meter, Progress


def test_reports_keep_their_distance_but_for_both_ends() -> None:
    """A thousand reports within a second are about twenty; 0 and 1 are among them."""
    now = [0.0]
    heard: list[Progress] = []
    meter = Meter(heard.append, "render", interval=0.05, clock=lambda: now[0])
    for step in range(1001):
        now[0] = step / 1000.0
        meter.report(step / 1000.0)
    assert 18 <= len(heard) <= 23
    assert (heard[0].done, heard[-1].done) == (0.0, 1.0)
    assert [p.done for p in heard] == sorted(p.done for p in heard)


def test_what_remains_is_what_the_speed_so_far_says() -> None:
    """A quarter in two seconds leaves six; nothing done says nothing."""
    now = [0.0]
    heard: list[Progress] = []
    meter = Meter(heard.append, "render", interval=0.0, clock=lambda: now[0])
    meter.report(0.0)
    now[0] = 2.0
    meter.report(0.25)
    assert heard[0].remaining is None
    assert heard[1] == Progress(0.25, 2.0, pytest.approx(6.0), "render")


def test_nobody_listens() -> None:
    """Reporting to nobody is nothing."""
    Meter(None, "render").report(0.5)


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_the_bar_is_silent_where_nobody_looks_or_nobody_waits() -> None:
    """No terminal, switched off, or quickly done: not a byte."""
    slow, quick = Progress(0.5, 3.0, 3.0, "render"), Progress(0.5, 0.1, 0.1, "render")
    pipe, terminal, quiet = io.StringIO(), _Terminal(), _Terminal()
    for stream, enabled, progress in ((pipe, True, slow), (terminal, True, quick), (quiet, False, slow)):
        with Bar(stream=stream, enabled=enabled) as bar:
            bar(progress)
        assert stream.getvalue() == ""


def test_the_bar_speaks_to_a_terminal_and_tidies_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """With rich, and without it in plain text."""
    terminal = _Terminal()
    with Bar(stream=terminal) as bar:
        bar(Progress(0.5, 3.0, 3.0, "render"))
    assert "render" in terminal.getvalue()
    monkeypatch.setitem(__import__("sys").modules, "rich.console", None)
    plain = _Terminal()
    with Bar(stream=plain) as bar:
        bar(Progress(0.5, 3.0, 3.0, "render"))
    assert plain.getvalue() == "\r\x1b[Krender: 50%, 3 s left\r\x1b[K"
