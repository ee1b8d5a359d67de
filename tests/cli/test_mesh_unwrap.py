"""`limner mesh unwrap`: as a process, with its codes, lines and files."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image as Picture

pytest.importorskip("scipy")

Run = Callable[..., Any]

BOX = """v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"""


@pytest.fixture
def box(tmp_path: Path) -> str:
    (tmp_path / "box.obj").write_text(BOX)
    return "box.obj"


def test_a_model_its_report_and_its_charts(limner_process: Run, tmp_path: Path, box: str) -> None:
    """One call writes a model with coordinates in the square, a picture and a report of an isometry."""
    done = limner_process("mesh", "unwrap", box, "-o", "out.obj", "--json", "--chart", "charts.png", "--resolution", "128")
    assert done.returncode == 0, done.stderr
    (report,) = json.loads(done.stdout)["meshes"].values()
    assert report["n_triangles"] == 12
    assert (report["n_flipped"], report["overlap"]) == (0, 0.0)
    assert report["conformal_max"] == pytest.approx(1.0, abs=1e-5)
    coordinates = [line.split()[1:3] for line in (tmp_path / "out.obj").read_text().splitlines() if line.startswith("vt ")]
    assert len(coordinates) >= 8
    assert all(0.0 <= float(value) <= 1.0 for pair in coordinates for value in pair)
    with Picture.open(tmp_path / "charts.png") as picture:
        assert picture.size[0] == 128


def test_charts_as_vectors_and_a_report_to_read(limner_process: Run, tmp_path: Path, box: str) -> None:
    """SVG by its extension; a report without --json is lines."""
    done = limner_process("mesh", "unwrap", box, "--chart", "charts.svg", "--report", "--method", "conformal", "--resolution", "64")
    assert done.returncode == 0, done.stderr
    assert "charts  " in done.stdout
    assert "0 flipped" in done.stdout
    assert ET.parse(tmp_path / "charts.svg").getroot().tag.endswith("svg")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "nothing to do"),
        (("-o", "out.xyz"), "models are saved as"),
        (("--chart", "charts.xyz"), ".svg"),
        (("--report", "--resolution", "16", "--margin", "9"), "do not fit into 16 x 16 texels"),
    ],
)
def test_bad_calls_are_one_line(limner_process: Run, tmp_path: Path, box: str, arguments: tuple[str, ...], words: str) -> None:
    """Code 2, one line that says what is wrong, no file left."""
    done = limner_process("mesh", "unwrap", box, *arguments)
    assert done.returncode == 2
    assert words in done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["box.obj"]
