"""The load report: every reader fills it, and it says the same as the notes, in parts."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any, get_args

import pytest

from limner.errors import FileFormatError, LimnerWarning
from limner.files.load import load
from limner.files.notes import MAX_NOTES, Kind, Notes, kind_of
from limner.files.report import KINDS, LoadEntry, load_report, report_of
from limner.scene.library import builtin
from limner.scene.scene import Scene


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("extension 'KHR_x' is ignored", "ignored"), ("map_bump is ignored", "ignored"), ("left out, it has no lines", "ignored"),
        ("drawn without map_Kd 'a.png': is missing", "ignored"), ("/nodes/3 has no light: is missing", "ignored"),
        ("the file has 2 scenes; only the default one is read", "ignored"), ("300 smoothing groups are not told apart", "ignored"),
        ("the default material stands in: no such index", "replaced"), ("material 'a' is not defined and drawn in grey", "replaced"),
        ("has no data and stands for zeros", "replaced"), ("3 normals without length are replaced by those of the surface", "repaired"),
        ("/nodes/0/matrix: its last row is taken as 0 0 0 1, it is [1, 0, 0, 1]", "repaired"),
        ("the binary chunk is cut off: it declares 9 bytes, 4 are left", "repaired"),
        ("2 triangles have no area; they are kept", "read"), ("illum 0 (colour without light) is drawn as a matte surface", "approximated"),
        ("Kd 0 0 0 with map_Kd is read as 1 1 1", "approximated"),
    ],
)  # fmt: skip
def test_words_tell_the_kind(text: str, kind: str) -> None:
    """What readers say without a kind of their own is sorted by its words."""
    assert kind_of(text) == kind


def test_a_reader_may_say_the_kind() -> None:
    """It goes before the words, and so does what it is about; notes are what they were."""
    notes = Notes()
    notes.add("is ignored", "line 3", kind="replaced", what="bsdf hair")
    notes.slip("a colour is clipped", "line 4")
    notes.add("is ignored", "line 9")
    assert notes.lines() == ("line 3 and 1 more: is ignored", "line 4: a colour is clipped")
    first, second = notes.remarks()
    assert first == ("replaced", "is ignored", "line 3", "bsdf hair", 2)
    assert second.kind == "approximated"


OBJ = "mtllib gone.mtl\no tile\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 0\nusemtl red\nf 1//1 2//1 3//1\np 1 2\n"


def test_entries_are_the_notes(tmp_path: Path) -> None:
    """What is not "read" is, line for line, what `scene.notes` has; nothing is warned about; the scene is the same."""
    (tmp_path / "tile.obj").write_text(OBJ)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        report = load_report(tmp_path / "tile.obj")
    with pytest.warns(LimnerWarning):
        scene = load(tmp_path / "tile.obj")
    said = report.entries[-len(scene.notes) :]
    assert report.scene.notes == scene.notes
    assert len(scene.notes) >= 3
    assert [str(entry).removeprefix(f"{entry.kind:<12}  ") for entry in said] == list(scene.notes)
    assert report.format == "obj"
    assert {"ignored", "replaced", "repaired"} <= {entry.kind for entry in report.entries}
    assert not report.is_exact
    assert report.settings == {}


def test_what_was_read_is_counted(triangle: Any, tmp_path: Path) -> None:
    """A sound file's report holds nothing else, and says that it is exact."""
    (tmp_path / "model.glb").write_bytes(triangle.glb())
    report = load_report(tmp_path / "model.glb", up="z")
    assert report.is_exact
    assert report.counts() == {"read": len(report.entries), "approximated": 0, "ignored": 0, "replaced": 0, "repaired": 0}
    assert report.of("read")[0].text == "shapes: 1 Mesh, 1 triangles"
    assert report.of("ignored") == ()


def test_built_in_scenes_have_reports() -> None:
    """Lights, cameras and materials by their kinds."""
    texts = [entry.text for entry in report_of(builtin("cornell"), Notes()).entries]
    assert any(text.startswith("materials: ") for text in texts)
    assert any(text.startswith("cameras: 1 PerspectiveCamera") for text in texts)


def test_json_and_text(tmp_path: Path) -> None:
    """Both say everything; JSON has plain values only, in one line."""
    (tmp_path / "tile.obj").write_text(OBJ)
    report = load_report(tmp_path / "tile.obj")
    told = json.loads(report.to_json())
    assert told == report.as_dict()
    assert "\n" not in report.to_json()
    assert [LoadEntry(e["kind"], e["text"], e["where"], e["what"], e["places"]) for e in told["entries"]] == list(report.entries)
    assert str(report).splitlines()[0] == f"{tmp_path / 'tile.obj'} (obj)"
    assert len(str(report).splitlines()) == 1 + len(report.entries)


def test_more_than_can_be_kept() -> None:
    """The report says how many remarks there were besides."""
    notes = Notes()
    for k in range(MAX_NOTES + 5):
        notes.add(f"remark {k} is ignored")
    report = report_of(Scene(), notes, "a", "b")
    assert report.n_more == 5
    assert len(report.of("ignored")) == MAX_NOTES
    assert report.lines()[-1] == "and 5 more such remarks"


def test_what_is_said_of_a_file_that_another_refers_to() -> None:
    """Its remarks come with its name, and keep their kind."""
    inner, outer = Notes(), Notes()
    inner.slip("is cut off", "line 2")
    outer.absorb(inner, "mesh.obj")
    assert outer.lines() == outer.warnings() == ("mesh.obj, line 2: is cut off",)
    assert next(outer.remarks()).kind == "repaired"


def test_kinds_and_errors(tmp_path: Path) -> None:
    """The kinds are those that notes have; a missing file is the error that it is for load."""
    assert get_args(Kind) == KINDS
    with pytest.raises(FileFormatError, match="no such file"):
        load_report(tmp_path / "gone.glb")


def test_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`info --report` tells it on standard output, in place of the notes; as JSON it is what `as_dict` says."""
    from limner.cli.main import main

    (tmp_path / "scene.xml").write_text('<scene version="3.0.0"><shape type="hair"/><shape type="cube"/></scene>')
    name = str(tmp_path / "scene.xml")
    assert main(["info", name, "--report"]) == 0
    out, err = capsys.readouterr()
    assert "  ignored       line 1: shape hair is left out: it is not read" in out.splitlines()
    assert "hair" not in err
    assert main(["info", name, "--report", "--json", "--quiet"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["report"] == load_report(name).as_dict()
    assert main(["info", "cornell", "--report", "--json", "--quiet"]) == 0
    assert json.loads(capsys.readouterr().out)["report"]["exact"]
