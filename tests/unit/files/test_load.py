"""The one door: which reader gets which file, and what strangers are told."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.errors import FileFormatError, LimnerError, LimnerWarning, SceneError, UnsupportedError
from limner.files.limits import Limits
from limner.files.load import EXTENSIONS, load, model_format
from limner.mesh.mesh import Mesh

OBJ = b"# made by hand\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.mark.parametrize("name", ["model.glb", "MODEL.GLB", "model", "model.obj", "model.xyz"])
def test_a_glb_is_a_glb(triangle: Any, tmp_path: Path, name: str) -> None:
    """Its first bytes decide, whatever it is called."""
    (tmp_path / name).write_bytes(triangle.glb())
    assert len(load(tmp_path / name).shapes()) == 1


def test_text_without_an_extension(triangle: Any, tmp_path: Path) -> None:
    """glTF and OBJ text are recognised, also as a str path."""
    for content in (triangle.embedded(), OBJ):
        (tmp_path / "model").write_bytes(content)
        assert len(load(str(tmp_path / "model")).shapes()) == 1


@pytest.mark.parametrize(
    ("data", "error", "message"),
    [
        (b"", FileFormatError, "is empty"), (b"\x89PNG\r\n\x1a\n", FileFormatError, "a PNG picture"),
        (b"%PDF-1.7", FileFormatError, "a PDF"), (b"BLENDER-v300", FileFormatError, "Blender file"),
        (b"version https://git-lfs.github.com/spec/v1", FileFormatError, "git lfs pull"),
        (b"Kaydara FBX Binary", FileFormatError, "FBX"), (b"some text", UnsupportedError, ".gltf, .glb"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("name", ["a.glb", "a.xyz"])
def test_strangers(tmp_path: Path, data: bytes, error: type[LimnerError], message: str, name: str) -> None:
    """What is no model is told what it is."""
    (tmp_path / name).write_bytes(data)
    if error is UnsupportedError and name == "a.glb":
        error, message = FileFormatError, "must begin with"
    with pytest.raises(error, match=message):
        load(tmp_path / name)


def test_files_that_cannot_be_opened(tmp_path: Path) -> None:
    """Missing files, folders and impossible names are FileFormatErrors with the path."""
    for path, message in (
        (tmp_path / "no.glb", "no such file"),
        (tmp_path, "a folder"),
        (tmp_path / ("x" * 5000), "cannot be read"),
    ):
        with pytest.raises(FileFormatError, match=message):
            load(path)


def test_every_extension_has_a_reader() -> None:
    """The table of extensions names formats that `model_format` gives."""
    for extension, kind in EXTENSIONS.items():
        assert model_format(b"anything", "model" + extension) == kind


def test_bad_limits_are_refused() -> None:
    """Limits are integers >= 0."""
    with pytest.raises(SceneError, match=r"limits\.max_nodes"):
        Limits(max_nodes=-1)


def test_warnings_point_at_the_caller(rich: Any, tmp_path: Path) -> None:
    """A slip is a warning at the line that called load, and stands in the notes."""
    rich.document["images"][0] = {"uri": "gone.png"}
    with pytest.warns(LimnerWarning, match="gone.png") as caught:
        scene = load(rich.save(tmp_path))
    assert caught[0].filename == __file__
    assert any("gone.png" in note for note in scene.notes)


def test_loading_imports_no_compiler(triangle: Any, tmp_path: Path) -> None:
    """Reading a file needs neither Numba nor trimesh, nor Pillow where there is no picture."""
    path = triangle.save(tmp_path)
    code = (
        "import sys; from limner.files.load import load; load(sys.argv[1]); "
        "print([m for m in ('numba', 'trimesh', 'PIL', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("kind", ["ply", "stl", "off"])
def test_formats_of_trimesh(tmp_path: Path, kind: str) -> None:
    """A sphere goes out through trimesh and comes back with its vertices, triangles and smooth normals."""
    trimesh = pytest.importorskip("trimesh", reason="the formats extra is not installed")
    sphere = trimesh.creation.icosphere(subdivisions=2)
    path = tmp_path / f"ball.{kind}"
    sphere.export(path)
    scene = load(path)
    mesh = scene.shapes()[0][1].geometry
    assert isinstance(mesh, Mesh)
    assert mesh.normals is not None
    assert (len(mesh.positions), len(mesh.triangles)) == (len(sphere.vertices), len(sphere.faces))
    corner_normals = mesh.normals[mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles]
    assert np.einsum("tci,tci->tc", corner_normals, mesh.positions[mesh.triangles]).min() > 0.99
    assert scene.name == "ball"


def test_colours_of_trimesh() -> None:
    """Vertex colours are decoded from sRGB; face colours get corners of their own."""
    trimesh = pytest.importorskip("trimesh", reason="the formats extra is not installed")
    from limner.files.interop import scene_from_trimesh

    box = trimesh.creation.box()
    box.visual.vertex_colors = np.tile([255, 188, 0, 255], (8, 1))
    ((_, shape),) = scene_from_trimesh(box).shapes()
    np.testing.assert_allclose(shape.geometry.colors, [[1.0, 0.5029, 0.0, 1.0]] * 8, atol=1e-3)  # type: ignore[union-attr]
    box.visual.face_colors = np.arange(48).reshape(12, 4) * 5
    ((_, shape),) = scene_from_trimesh(box).shapes()
    assert len(shape.geometry.positions) == 36  # type: ignore[union-attr]
    assert shape.materials[0].alpha_mode == "blend"


def test_scenes_of_trimesh() -> None:
    """Instances of a trimesh scene keep their places and share their mesh."""
    trimesh = pytest.importorskip("trimesh", reason="the formats extra is not installed")
    from limner.files.interop import scene_from_trimesh

    scene = trimesh.Scene()
    for x in (0.0, 3.0):
        place = trimesh.transformations.translation_matrix([x, 0, 0])
        scene.add_geometry(trimesh.creation.box(), geom_name="box", transform=place)
    found = scene_from_trimesh(scene)
    np.testing.assert_allclose(found.bounds(), scene.bounds)
    with pytest.raises(SceneError, match="trimesh"):
        scene_from_trimesh([1, 2, 3])


def test_bad_files_for_trimesh(tmp_path: Path) -> None:
    """Whatever trimesh raises is a FileFormatError of one line."""
    pytest.importorskip("trimesh", reason="the formats extra is not installed")
    huge = b"ply\nformat binary_little_endian 1.0\nelement vertex 4611686018427387904\nproperty float x\nend_header\n"
    for name, data in (
        ("a.ply", huge),
        ("a.ply", b"ply\n"),
        ("a.stl", b"solid x\n"),
        ("a.stl", b"\0" * 84),
        ("a.off", b"OFF\n1 2\n"),
    ):
        (tmp_path / name).write_bytes(data)
        with pytest.raises(FileFormatError) as caught:
            load(tmp_path / name)
        assert "\n" not in str(caught.value)
