"""Scene files written by hand, by others, or to do harm: short forms, parts of other files, and what is wrong, told with its line."""

from __future__ import annotations

import contextlib
import dataclasses
import io
import re
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from menagerie import menagerie, seamed

from limner.errors import FileFormatError, LimnerError
from limner.files.limits import DEFAULT
from limner.files.load import load, model_format
from limner.files.save_mesh import save_model
from limner.files.scene_file import save_scene, settings_of
from limner.files.scene_file_yaml import MAX_NESTING
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.scene import camera, material
from limner.scene.digest import scene_digest
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import (
    Shape,
    Sphere,
)

# --- by hand --------------------------------------------------------------------------------------------------------------

BY_HAND = """\
limner: 1
settings: {renderer: path, width: 64, shutter: [0, 1], aovs: [depth]}
camera:
  perspective: {place: {look_at: {eye: [3, 2, 5], target: [0, 1, 0]}}, focal_length_mm: 50, f_number: 2}
materials:
  clay: {lambert: {color: 0.5}}
geometries:
  pot: {mesh: {builtin: teapot}}
  floor: {plane: }
subtrees:
  lamp: {lights: [point: {intensity: 3}]}
nodes:
- shapes: {geometry: floor}
- name: ball
  place: {rotate: {axis: [0, 0, 1], degrees: 90}, translate: [0, 1, 0], scale: 2}
  shapes: {sphere: {radius: 2}, materials: clay}
- shapes:
  - {geometry: pot, materials: [clay]}
  - difference:
      parts:
      - box: {size: 1}
      - {geometry: pin, place: {translate: [1, 0, 0]}, material: clay}
- lamp
- {place: {translate: [0, 5, 0]}, children: [lamp]}
- {name: room, model: cornell}
"""


def _scene(tmp_path: Path, text: str, **files: bytes) -> Scene:
    for name, data in files.items():
        (tmp_path / name.replace("__", ".")).write_bytes(data)
    (tmp_path / "scene.yaml").write_text(text, encoding="utf-8")
    return load(tmp_path / "scene.yaml")


def test_a_file_says_what_python_would(tmp_path: Path) -> None:
    """Short forms: places, lenses, names from tables, single shapes, built-ins."""
    scene = _scene(tmp_path, BY_HAND.replace("subtrees:", "  pin: {sphere: {radius: 0.1}}\nsubtrees:"))
    assert settings_of(tmp_path / "scene.yaml") == {"renderer": "path", "width": 64, "shutter": (0, 1), "aovs": ("depth",)}
    eye = camera.PerspectiveCamera.look_at((3, 2, 5), (0, 1, 0), focal_length_mm=50, f_number=2)
    assert scene.camera is not None
    assert scene_digest(Scene(camera=scene.camera)) == scene_digest(Scene(camera=eye))
    _, ball, pots, lamp, above, room = scene.root.children
    expected = transform.in_order(transform.scale(2), transform.rotate_z(np.pi / 2), transform.translate(0, 1, 0))
    assert np.allclose(ball.parent_from_node, expected)
    assert ball.shapes == (Shape(Sphere(2), material.Lambert(0.5, name="clay")),)
    assert ball.shapes[0].materials[0] is pots.shapes[0].materials[0] is pots.shapes[1].geometry.parts[1].material
    assert above.children[0] is lamp
    assert lamp.name == "lamp"
    assert room.children[0].name == "cornell"
    assert len(pots.shapes[0].geometry.triangles) > 1000


WRONG = {
    "nodes:\n- shapes:\n  - sphere:\n      radius: -1": ("line 5, nodes[0].shapes[0].sphere.radius", "must be positive, got -1.0"),
    "nodes:\n- shapes:\n  - sphere: {radus: 1}": ("line 4, nodes[0].shapes[0].sphere.radus", "did you mean 'radius'?"),
    "nodes:\n- shapes: {spere: {}}": ("line 3, nodes[0].shapes.spere", "did you mean 'sphere'?"),
    "nodes:\n- shapes: {materials: a}": ("line 3, nodes[0].shapes", "must have exactly one of mesh, point_cloud,"),
    "nodes:\n- shapes: {sphere: {}, box: {}}": ("line 3, nodes[0].shapes", "got sphere and box"),
    "nodes:\n- shapes: {sphere: {}, materials: tin}\nmaterials: {tine: {lambert: {}}}": (
        "line 3, nodes[0].shapes.materials", "nothing named 'tin' in materials; did you mean 'tine'?"
    ),
    "background: environment": ("line 2, background", 'is "environment", but'),
    "background: sky": ("line 2, background", "must be environment, a number or a list, got 'sky'"),
    "nodes: [{visible: yes}]": ("line 2, nodes[0].visible", "must be true or false, got 'yes'"),
    "fog: {color: [1, 2]}": ("line 2, fog.color", "must be a list of 3, got 2"),
    "fog: {density: thick}": ("line 2, fog.density", "must be a number, got 'thick'"),
    "fog: {density: 1, color: 2, density: 3}": ("line 2", "'density' is given twice, here and in line 2"),
    "settings: {renderer: rya}": ("line 2, settings.renderer", "must be path, raster or ray, got 'rya'; did you mean 'ray'?"),
    "materials:\n  a:\n    lambert: {alpha: 2}": ("line 4, materials.a.lambert.alpha", "must lie in [0, 1], got 2.0"),
    "subtrees:\n  a: {children: [b]}\n  b: {children: [a]}": ("line 4, subtrees.b.children[0]", "'a' refers to itself"),
    "nodes:\n- {model: scene.yaml}": ("line 3, nodes[0].model", "includes itself"),
    "nodes:\n- {model: ../other.glb}": ("line 3, nodes[0].model", "must stay inside the model's folder"),
    "nodes:\n- {model: none.glb}": ("line 3, nodes[0].model", "'none.glb' is missing"),
    "environment: {source: /etc/passwd}": ("line 2, environment.source", "must stay inside"),
    "arrays: https://example.org/a.npz": ("line 2, arrays", "only files beside the model"),
    "nodes:\n- place: {translate: [0, 0, .inf]}": ("line 3, nodes[0].place", "must be finite"),
    "nodes:\n- place: [[1, 0, 0, 0]]": ("line 3, nodes[0].place", "must be a 4x4 matrix"),
    "nodes:\n- place: {look_at: {eye: [1, 2, 3], target: [1, 2, 3]}}": ("nodes[0].place.look_at", "eye and camera.target must differ"),
    "nodes:\n- shapes: {mesh: {positions: [[0, 0, 0]], triangles: [[0, 0, 1]]}}": ("nodes[0].shapes.mesh.triangles", "must lie in 0..0"),
    "nodes:\n- shapes: {mesh: {positions: [[0, 0], [1]], triangles: []}}": ("shapes.mesh.positions", "must be an array of numbers"),
    "nodes:\n- shapes: {point_cloud: {positions: [[0, 0, 0]], scalars: {heat: [1], x: {dtype: fp}}}}": (
        "shapes.point_cloud.scalars.x.dtype", "got 'fp'"
    ),
    "nodes:\n- shapes: {mesh: {positions: [[0, 0, 0]], triangles: {dtype: int32, values: [[0, 0, 0.5]]}}}": (
        "shapes.mesh.triangles", "not all of them are int32"
    ),
    "nodes:\n- shapes: {mesh: {triangles: []}}": ("line 3, nodes[0].shapes.mesh", "positions is missing"),
    "nodes:\n- shapes: {point_cloud: {positions: {array: p}}}": ("positions.array", "there is no file of arrays"),
    "camera: {perspective: {focal_length_mm: 50, yfov_degrees: 40}}": ("line 2, camera.perspective", "must be said once"),
    "name: !!python/object:os.system {}": ("line 2", "tags are not read"),
    "name: [": ("line 3", "is no YAML"),
    "nodes: 5": ("line 2, nodes", "must be"),
    "root: {}\nnodes: []": ("line 3, nodes", "there is a root already"),
}  # fmt: skip


@pytest.mark.parametrize("text", WRONG)
def test_what_is_wrong_is_told_with_its_line(tmp_path: Path, text: str) -> None:
    """One line: the file, the line, the way to the place, what was expected and what was found."""
    with pytest.raises(LimnerError) as caught:
        _scene(tmp_path, f"limner: 1\n{text}\n")
    place, said = WRONG[text]
    assert re.search(rf"(?:scene\.yaml, )?.*{re.escape(place)}.*: .*{re.escape(said)}", str(caught.value)), str(caught.value)
    assert "\n" not in str(caught.value)


def test_no_scene_file_is_told_so(tmp_path: Path) -> None:
    """Another YAML file, a later version, no mapping, no UTF-8, a second document."""
    for text, said in {
        "a: 1": "must begin with 'limner: 1'", "limner: 2": "version 2 is not read yet", "- 1": "must be a mapping",
        "": "the file is empty",
        "limner: 1\n---\nlimner: 1": "must be one document",
    }.items():  # fmt: skip
        with pytest.raises(FileFormatError, match=re.escape(said)):
            _scene(tmp_path, text)
    (tmp_path / "latin.yaml").write_bytes(b"limner: 1\nname: \xe9\n")
    with pytest.raises(FileFormatError, match="line 2: is not UTF-8"):
        load(tmp_path / "latin.yaml")
    assert model_format(b"# mine\nlimner: 1\n", "scene") == "scene"
    assert model_format(b"limner: 1\n", "scene.yaml") == "scene"


# --- from elsewhere -------------------------------------------------------------------------------------------------------


def test_models_bring_their_paths_with_them(tmp_path: Path) -> None:
    """What a model's skins and animations name is found in the scene that includes it; its meshes are one, however often it is shown."""
    save_model(menagerie(), tmp_path / "zoo.glb")
    scene = _scene(tmp_path, "limner: 1\nname: n\nnodes:\n- {name: left, model: zoo.glb}\n- {name: right, model: zoo.glb}\n")
    paths = {placed.path for placed in scene.root.walk()}
    skins = [placed.node.skin for placed in scene.root.walk() if placed.node.skin is not None]
    assert len(skins) == 2
    assert all(joint in paths for skin in skins for joint in skin.joints)
    assert [joint.split("/")[1] for skin in skins for joint in skin.joints] == ["left", "left", "right", "right"]
    targets = {channel.target for clip in scene.animations for channel in clip.channels if getattr(channel, "kind", "node") == "node"}
    assert targets
    assert targets <= paths
    assert scene.at(0.5).root is not scene.root
    meshes = [shape.geometry for placed in scene.root.walk() for shape in placed.node.shapes if isinstance(shape.geometry, Mesh)]
    assert len({id(mesh) for mesh in meshes}) <= len(meshes) // 2


def test_parts_of_files(tmp_path: Path) -> None:
    """A node of a model, one of its meshes, texels of a picture; a scene file in a scene file; what is not there is told."""
    from PIL import Image as Pillow

    wheel = Node("wheel", shapes=(Shape(seamed(), (material.Lambert((0.1, 0.2, 0.3)), material.BlinnPhong())),))
    save_scene(Scene(Node("car", children=(wheel, Node("seat")))), tmp_path / "car.yaml")
    Pillow.new("RGB", (2, 3), (255, 0, 0)).save(tmp_path / "red.png")
    text = """\
limner: 1
nodes:
- {model: {file: car.yaml, node: car/wheel}}
- shapes:
    mesh: {file: car.yaml}
    materials: [{lambert: {texture: {texture: {texels: {file: red.png}}}}}, {lambert: {}}]
"""
    scene = _scene(tmp_path, text)
    wheel, own = scene.root.children[0].children[0], scene.root.children[1].shapes[0]
    assert wheel.name == "wheel"
    assert own.geometry is wheel.shapes[0].geometry
    assert own.materials[0].texture.texels.pixels.shape == (3, 2, 4)
    with pytest.raises(FileFormatError, match=r"line 3, nodes\[0\].model: there is no node 'car/wheels'"):
        _scene(tmp_path, text.replace("car/wheel", "car/wheels"))
    with pytest.raises(FileFormatError, match="holds 0 of what is asked for"):
        _scene(tmp_path, text.replace("mesh: {file", "point_cloud: {file"))
    text = "limner: 1\nnodes:\n- {model: car.yaml, shapes: [mesh: {file: car.yaml, number: 1}]}\n"
    with pytest.raises(FileFormatError, match=r"number: must lie in 0..0, got 1"):
        _scene(tmp_path, text)


# --- hostile --------------------------------------------------------------------------------------------------------------


def _laughs(n: int) -> str:
    lines = ["limner: 1", "a0: &a0 [0, 0, 0, 0, 0, 0, 0, 0, 0]"]
    return "\n".join(lines + [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, n)])


def test_bombs_do_not_go_off(tmp_path: Path) -> None:
    """Aliases that unfold, nesting, subtrees that double, graphs without end, long numbers: refused before they cost anything."""
    doubling = "".join(f"  s{k}: {{children: [s{k + 1}, s{k + 1}]}}\n" for k in range(40)) + "  s40: {}\n"
    chain = "".join(f"  s{k}: {{children: [s{k + 1}]}}\n" for k in range(200)) + "  s200: {}\n"
    alias = "limner: 1\na: &a [1]\n" + "".join(f"b{k}: &b{k} [*{'a' if not k else f'b{k - 1}'}]\n" for k in range(400))
    for text, said in {
        _laughs(9): "more than 4000000 values",
        "limner: 1\nname: " + "[" * 5000: f"nested deeper than {MAX_NESTING}",
        alias: f"nested deeper than {MAX_NESTING}",
        "limner: 1\na: &a [*a]": "stands for nothing that has ended",
        f"limner: 1\nsubtrees:\n{doubling}nodes: [s0]": "more than 1000000 nodes",
        f"limner: 1\nsubtrees:\n{chain}": "must not refer through more than",
        "limner: 1\nname: " + "9" * 5000: "a number must not be longer",
    }.items():
        with pytest.raises(FileFormatError, match=said):
            _scene(tmp_path, text)


TYPED = st.sampled_from(["", "-", "1", " ", "\n", "a", ": ", "[", "*a", "null"])


@given(cut=st.tuples(st.integers(0, len(BY_HAND)), st.integers(0, 30)), put=TYPED)
def test_what_is_garbled_is_an_error_or_a_scene(tmp_path_factory: pytest.TempPathFactory, cut: tuple[int, int], put: str) -> None:
    """Whatever is cut out of a file, or typed into it: no other exception than ours."""
    path = tmp_path_factory.getbasetemp() / "garbled.yaml"
    path.write_text(BY_HAND[: cut[0]] + put + BY_HAND[sum(cut) :] or " ")
    with contextlib.suppress(LimnerError):
        assert isinstance(load(path), Scene)
    with contextlib.suppress(LimnerError):
        assert isinstance(settings_of(path), dict)


def _npz(**members: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(f"{name}.npy", data)
    return stream.getvalue()


def _npy(array: Any) -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.asarray(array), allow_pickle=True)
    return stream.getvalue()


def test_files_of_arrays_are_not_trusted(tmp_path: Path) -> None:
    """No pickles, no sizes that are not there, no archive that unpacks to more than a model may; what is missing is told."""
    text = "limner: 1\narrays: a.npz\nnodes:\n- shapes: {point_cloud: {positions: {array: p}}}\n"
    rows = _npy(np.zeros((3, 3), dtype=np.float32))
    long = rows.replace(b"(3, 3)", b"(9, 9)")
    for data, said in {
        _npz(p=_npy(np.array([{}], dtype=object))): "it holds object", _npz(p=long): "its size is not that of",
        _npz(q=rows): "there is no array 'p'; known are q", _npz(p=rows[:20]): "cannot be read", _npz(p=b"junk"): "cannot be read",
        b"PK": "is no .npz file",
    }.items():  # fmt: skip
        with pytest.raises(FileFormatError, match=said):
            _scene(tmp_path, text, a__npz=data)
    assert len(_scene(tmp_path, text, a__npz=_npz(p=rows)).root.children[0].shapes[0].geometry.positions) == 3
    with pytest.raises(FileFormatError, match="max_file_bytes"):
        load(_written(tmp_path, text, _npz(p=_npy(np.zeros(100_000)))), limits=dataclasses.replace(DEFAULT, max_file_bytes=10_000))


def _written(tmp_path: Path, text: str, data: bytes) -> Path:
    (tmp_path / "a.npz").write_bytes(data)
    (tmp_path / "small.yaml").write_text(text)
    return tmp_path / "small.yaml"
