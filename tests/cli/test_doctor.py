"""`limner doctor` on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from limner.cli.main import main

_CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"


def _told(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert main(["doctor", *words]) == 0
    return capsys.readouterr().out


def test_a_sound_scene_is_left_in_peace(capsys: pytest.CaptureFixture[str]) -> None:
    """One line that says so; for programs, an empty list."""
    assert _told(capsys, "cornell", "--no-picture").splitlines() == ["cornell", "  nothing is wrong"]
    assert json.loads(_told(capsys, "cornell", "--no-picture", "--json")) == {"model": "cornell", "is_sound": True, "findings": []}


def test_a_fault_is_told_with_its_place_its_reason_and_its_cure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A tetrahedron whose faces look inwards."""
    model = tmp_path / "tetrahedron.obj"
    model.write_text(_CORNERS + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    flipped = tmp_path / "flipped.obj"
    flipped.write_text(_CORNERS + "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n")
    found = [json.loads(_told(capsys, str(path), "--no-picture", "--json"))["findings"] for path in (model, flipped)]
    assert [[finding["kind"] for finding in one] for one in found] == [[], ["inside-out"]]
    lines = _told(capsys, str(flipped), "--no-picture").splitlines()
    assert len(lines) == 4
    assert lines[2].startswith("      why: ")
    assert lines[3].startswith("      do:  ")


def test_bad_calls_are_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    """An unknown model, an unknown renderer: exit code 2."""
    for words in (["doctor", "nothing.glb"], ["doctor", "teapot", "--renderer", "rey"]):
        assert main(words) == 2
        assert len(capsys.readouterr().err.strip().splitlines()) == 1
