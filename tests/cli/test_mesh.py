"""`limner mesh`: verdicts, measures, repairs and other formats, from the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.errors import SceneError
from limner.files.load import load
from limner.mesh.examine.report import topology_report
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.scene.meshes import meshes_of, with_meshes
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Shape

BOX = primitives.box()


def _obj(name: str, positions: Any, triangles: Any) -> str:
    """Write an OBJ into the current folder."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in np.asarray(positions).tolist()]
    lines += ["f " + " ".join(str(corner + 1) for corner in row) for row in np.asarray(triangles).tolist()]
    Path(name).write_text("\n".join(lines) + "\n")
    return name


def _messy() -> str:
    """A box of triangles without a common vertex, one turned over, one there twice, one missing."""
    triangles = np.arange(36).reshape(12, 3)
    triangles[3] = triangles[3, ::-1]
    return _obj("messy.obj", BOX.positions[BOX.triangles].reshape(-1, 3), np.concatenate([triangles[:11], triangles[4:5]]))


def _checked(path: str) -> Any:
    (mesh,) = meshes_of(load(path)).values()
    return topology_report(mesh)


def test_check_says_what_is_wrong(limner: Callable[..., Any]) -> None:
    """Code 0 for what is sound, 1 with the faults by name for what is not; --closed asks for more, --weld forgives seams."""
    _obj("box.obj", BOX.positions, BOX.triangles)
    sound = limner("mesh", "check", "box.obj", "--closed")
    assert (sound.code, sound.err) == (0, "")
    assert sound.out.splitlines()[0] == "world/box: sound"
    assert "closed manifold, consistently oriented, Euler characteristic 2, genus 0" in sound.out
    _messy()
    bad = limner("mesh", "check", "messy.obj", "--weld", "0")
    assert bad.code == 1
    assert "fault: 1 duplicate triangle: 11" in bad.out
    assert "triangles that face opposite sides" in bad.out
    assert "limner: note: 1 of 1 not sound: world/messy\n" in bad.err
    # Without welding the triangles know nothing of each other, but for the one that is there twice.
    apart = limner("mesh", "check", "messy.obj", "--json")
    told = json.loads(apart.out)
    assert (apart.code, told["is_sound"], told["meshes"]["world/messy"]["n_components"]) == (1, False, 11)
    _obj("sheet.obj", BOX.positions, BOX.triangles[:2])
    assert limner("mesh", "check", "sheet.obj").code == 0
    assert limner("mesh", "check", "sheet.obj", "--closed").code == 1


def test_info_measures(limner: Callable[..., Any]) -> None:
    """Area, volume and genus, as text and as JSON."""
    _obj("box.obj", BOX.positions, BOX.triangles)
    text = limner("mesh", "info", "box.obj")
    assert text.code == 0
    assert "  volume                1\n" in text.out
    facts = json.loads(limner("mesh", "info", "box.obj", "--json").out)["meshes"]["world/box"]
    assert (facts["area"], facts["volume"], facts["genus"], facts["pieces"]) == (6.0, 1.0, 0, 1)


@pytest.mark.parametrize("extension", ["obj", "ply", "stl"])
def test_repair_makes_it_sound(limner: Callable[..., Any], extension: str) -> None:
    """What comes out, read again and welded, is a closed box of volume 1; what was done is told."""
    pytest.importorskip("limner.files.save_mesh")
    done = limner("mesh", "repair", _messy(), "-o", f"whole.{extension}", "--fill-holes")
    assert done.code == 0
    steps = ("25 vertices welded", "1 duplicate triangle dropped", "1 triangle turned over", "1 hole filled", "1 triangle added")
    assert done.out == f"world/messy: {', '.join(steps)}\n"
    assert limner("mesh", "check", f"whole.{extension}", "--weld", "0", "--closed").code == 0
    told = json.loads(limner("mesh", "repair", "messy.obj", "-o", f"open.{extension}", "--no-weld", "--json").out)
    assert {name: count for name, count in told["meshes"]["world/messy"].items() if count} == {"dropped_duplicates": 1}


def test_convert(limner: Callable[..., Any]) -> None:
    """A built-in model as OBJ, read again, has its triangles."""
    pytest.importorskip("limner.files.save_mesh")
    assert limner("mesh", "convert", _obj("box.obj", BOX.positions, BOX.triangles), "-o", "again.obj").code == 0
    report = _checked("again.obj")
    assert (report.n_triangles, report.is_sound) == (12, True)


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("check", "no.obj"), "there is no file 'no.obj'"),
        (("repair", "box.obj"), "Missing option '-o'"),
        (("repair", "box.obj", "-o", "x.obj", "--weld", "-1"), "-1.0 is not in the range x>=0.0"),
        (("repair", "box.obj", "-o", "x.obj", "--weld", "1", "--no-weld"), "--weld and --no-weld exclude each other"),
        (("repair", "box.obj", "-o", "x.docx"), "x.docx"),
        (("melt", "box.obj"), "No such command 'melt'"),
    ],
)
def test_one_clear_line(limner: Callable[..., Any], words: tuple[str, ...], complaint: str) -> None:
    """Code 2, one line on standard error, and no file."""
    _obj("box.obj", BOX.positions, BOX.triangles)
    done = limner("mesh", *words)
    assert done.code == 2
    assert complaint in done.err
    assert done.err.count("\n") == 1
    assert sorted(path.name for path in Path().iterdir()) == ["box.obj"]


def test_help_names_all_commands(limner: Callable[..., Any]) -> None:
    """Those that stand in files of their own, too."""
    told = limner("mesh", "--help").out
    assert [name for name in ("check", "convert", "info", "repair", "unwrap") if f"\n  {name} " not in told] == []


def test_a_mesh_that_is_shown_twice_is_changed_once() -> None:
    """Instances stay instances; exact shapes and meshes that do not change stay as they are; each mesh has the first node's path."""
    other = Mesh(BOX.positions, BOX.triangles[:4], name="other")
    twice = Node("twice", shapes=(Shape(BOX), Shape(other)))
    scene = Scene(Node("world", children=(twice, Node("again", shapes=(Shape(BOX),)), Node("exact", shapes=(Shape(Box(1.0)),)))))
    assert meshes_of(scene) == {"world/twice": BOX, "world/twice 2": other}
    seen = []

    def change(mesh: Mesh) -> Mesh:
        seen.append(mesh)
        return Mesh(mesh.positions, mesh.triangles[:2]) if mesh is BOX else mesh

    changed = with_meshes(scene, change)
    assert seen == [BOX, other]
    shapes = [shape for _, shape in changed.shapes()]
    assert shapes[0].geometry is shapes[2].geometry
    assert len(shapes[0].geometry.triangles) == 2
    assert shapes[1] is twice.shapes[1]
    assert isinstance(shapes[3].geometry, Box)


def test_a_model_without_meshes(limner: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """An exact shape has no triangles to check: one line."""
    monkeypatch.setattr("limner.cli.mesh.open_model", lambda _: Scene(Node(shapes=(Shape(Box(1.0)),))))
    done = limner("mesh", "check", "box")
    assert (done.code, done.err) == (2, "limner: error: box has no meshes\n")
    assert issubclass(SceneError, Exception)
