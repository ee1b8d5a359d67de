"""`limner schema`, and scene files where a model is expected."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from limner.cli.main import main
from limner.cli.schema import schema
from limner.cli.talk import Talk


def test_schema_is_json() -> None:
    """What is written is a JSON Schema whose definitions refer to each other, and to nothing else."""
    told = CliRunner().invoke(schema, [], obj=Talk())
    assert told.exit_code == 0
    found = json.loads(told.output)
    assert found["$ref"] == "#/$defs/SceneFile"
    referred = {part.split('"')[0] for part in told.output.split('"#/$defs/')[1:]}
    assert referred <= set(found["$defs"])


def test_info_reads_scene_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A scene file is a model as others are; what is wrong with it is one line, and bad input."""
    monkeypatch.chdir(tmp_path)
    Path("scene.yaml").write_text("limner: 1\nnodes:\n- {name: ball, shapes: {sphere: {radius: 1}}}\n")
    assert main(["info", "scene.yaml"]) == 0
    Path("scene.yaml").write_text("limner: 1\nnodes:\n- {name: ball, shapes: {sphere: {radius: 0}}}\n")
    capsys.readouterr()
    assert main(["info", "scene.yaml"]) == 2
    assert capsys.readouterr().err == (
        "limner: error: scene.yaml, line 3, nodes[0].shapes.sphere.radius: must be positive, got 0.0\n"
    )
