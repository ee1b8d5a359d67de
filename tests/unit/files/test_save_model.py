"""Saving models: what is written is read again as it was, by limner and by trimesh, and there is never half a file."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.errors import LimnerWarning, RenderError, SceneError, UnsupportedError
from limner.files.load import load
from limner.files.save_mesh import save_model
from limner.linear.transform import scale, translate
from limner.mesh.mesh import Mesh
from limner.scene.material import BlinnPhong, Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.points import PointCloud
from limner.scene.scene import Scene
from limner.scene.shape import Plane, Shape, Sphere
from limner.scene.texture import Texels, Texture

RNG = np.random.default_rng(5)
POSITIONS = RNG.normal(size=(7, 3)).astype(np.float32) * np.float32(1e3) ** RNG.integers(-2, 3, size=(7, 1)).astype(np.float32)
TRIANGLES = np.array([[0, 1, 2], [2, 1, 3], [3, 4, 5], [5, 6, 0]], dtype=np.int32)
PER_VERTEX = Mesh(
    POSITIONS, TRIANGLES, normals=np.tile(np.float32([0, 0.6, 0.8]), (7, 1)), uvs=RNG.random((7, 2)).astype(np.float32),
    colors=np.float32([[0, 0, 0], [1, 1, 1], [1, 0, 0]])[np.arange(7) % 3],
    scalars={"heat": np.arange(7.0, dtype=np.float32), "two words": np.full(7, np.nan, dtype=np.float32)}, name="m",
)  # fmt: skip
AT_CORNERS = dataclasses.replace(
    PER_VERTEX, colors=None, uvs=RNG.random((5, 2)).astype(np.float32), uv_triangles=RNG.integers(0, 5, (4, 3)).astype(np.int32),
    normals=np.float32([[1, 0, 0], [0, 1, 0]]), normal_triangles=RNG.integers(0, 2, (4, 3)).astype(np.int32), scalars=None,
    triangle_materials=np.array([0, 1, 1, 0], dtype=np.int32),
)  # fmt: skip
WHITE = Lambert((1.0, 1.0, 1.0))


def again(thing: Any, path: Path) -> Any:
    """The geometry of what is read from what was saved."""
    save_model(thing, path)
    assert [p.name for p in path.parent.iterdir() if p.name.startswith(".")] == []
    return load(path).shapes()[0][1].geometry


def as_arrays(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Normals and coordinates of every corner."""
    assert mesh.normals is not None
    assert mesh.uvs is not None
    normals = mesh.normals[mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles]
    return normals, mesh.uvs[mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles]


@pytest.mark.parametrize("kind", ["obj", "ply"])
@pytest.mark.parametrize("mesh", [PER_VERTEX, AT_CORNERS], ids=["per vertex", "at corners"])
def test_round_trip(tmp_path: Path, kind: str, mesh: Mesh) -> None:
    """Positions and triangles come back to the bit, and so does what is on them, wherever it was kept."""
    path = tmp_path / f"a.{kind}"
    made = again(Scene(Node(shapes=(Shape(mesh, (WHITE, Lambert((0.5, 0.25, 1.0)))),))), path)
    assert (made.positions == mesh.positions).all()
    assert (made.triangles == mesh.triangles).all()
    normals, uvs = as_arrays(made)
    own_normals, own_uvs = as_arrays(mesh)
    assert (uvs == own_uvs).all()
    if kind == "obj" or mesh.normal_triangles is None:
        assert np.allclose(normals, own_normals, atol=1e-6)
    if mesh is PER_VERTEX:
        assert np.allclose(made.colors, mesh.colors, atol=1e-6)
        if kind == "ply":
            assert made.scalars["heat"].tolist() == list(range(7))
            assert np.isnan(made.scalars["two_words"]).all()


@pytest.mark.parametrize("kind", ["obj", "ply", "stl"])
def test_trimesh_reads_it_as_it_is(tmp_path: Path, kind: str) -> None:
    """The oracle: another reader finds the same positions in the same triangles."""
    trimesh = pytest.importorskip("trimesh", reason="the formats extra is not installed")
    path = tmp_path / f"a.{kind}"
    save_model(PER_VERTEX, path)
    found = trimesh.load_mesh(path, process=False)
    assert (np.asarray(found.triangles, dtype=np.float32) == POSITIONS[TRIANGLES]).all()
    if kind == "ply":
        assert (found.faces == TRIANGLES).all()


def test_scenes_become_one_space(tmp_path: Path) -> None:
    """What stands twice is written twice, where it stands; a mirror turns triangles round; spheres are cut up; planes are left out."""
    node = Node(shapes=(Shape(PER_VERTEX),))
    places = (translate(1e4, 0, 0), scale(-1, 1, 1))
    ball = Node(parent_from_node=translate(0, 5, 0), shapes=(Shape(Sphere(2.0)), Shape(Plane())))
    scene = Scene(Node(children=(*(Node(parent_from_node=at, children=(node,)) for at in places), ball)))
    with pytest.warns(LimnerWarning, match="infinite plane"):
        save_model(scene, tmp_path / "a.stl")
    record = np.dtype([("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")])
    corners = np.frombuffer((tmp_path / "a.stl").read_bytes()[84:], dtype=record)["p"]
    assert np.array_equal(corners[:4], POSITIONS[TRIANGLES] + np.float32([1e4, 0, 0]))
    assert np.array_equal(corners[4:8], (POSITIONS * np.float32([-1, 1, 1]))[TRIANGLES[:, ::-1]])
    assert np.allclose(np.linalg.norm(corners[8:] - [0, 5, 0], axis=2), 2.0, atol=1e-4)


def test_materials_of_obj(tmp_path: Path) -> None:
    """Materials come back by name with colours, highlights, metal and textures; equal names are told apart."""
    texels = Texels(RNG.integers(0, 256, (4, 3, 4), dtype=np.uint8) | np.uint8([[[0, 0, 0, 255]]]))
    given = (
        BlinnPhong((0.1, 0.2, 0.3), specular=(0.4, 0.4, 0.4), exponent=77.0, name="oak"),
        MetallicRoughness(metallic=0.25, roughness=0.75, base_color_texture=Texture(texels), alpha=0.5, alpha_mode="blend", name="oak"),
    )
    save_model(Scene(Node(shapes=(Shape(AT_CORNERS, given),))), tmp_path / "a b.obj")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a b.mtl", "a b.obj", "a_b_0.png"]
    phong, metal = load(tmp_path / "a b.obj").shapes()[0][1].materials
    assert dataclasses.replace(given[0], name=phong.name) == phong
    assert (metal.metallic, metal.roughness, metal.alpha) == (0.25, 0.75, 0.5)
    assert (metal.base_color_texture.texels.pixels == texels.pixels).all()


def test_clouds(tmp_path: Path) -> None:
    """Points come back as points, those at infinity left out; STL has no place for them."""
    with pytest.warns(LimnerWarning, match="1 of 3 points"):
        cloud = PointCloud(np.float32([[1, 2, 3], [np.nan, 0, 0], [4, 5, 6]]), radii=np.float32([1, 2, 3]), scalars={"t": np.arange(3.0)})
    made = again(cloud, tmp_path / "a.ply")
    assert made.positions.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert (made.point_radii.tolist(), made.scalars["t"].tolist()) == ([1, 3], [0, 2])
    save_model(cloud, tmp_path / "a.obj")
    assert (tmp_path / "a.obj").read_text().count("\np ") == 2
    with pytest.warns(LimnerWarning, match="points are left out"), pytest.raises(SceneError, match="STL needs triangles"):
        save_model(cloud, tmp_path / "a.stl")


def test_never_half_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that fills up leaves what was there before, and nothing else."""
    path = tmp_path / "a.ply"
    path.write_text("what was there")

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("limner.files.save_mesh.write_ply", full)
    with pytest.raises(RenderError, match=r"cannot write .*No space left"):
        save_model(PER_VERTEX, path)
    assert [p.name for p in tmp_path.iterdir()] == ["a.ply"]
    assert path.read_text() == "what was there"


def test_what_is_refused(tmp_path: Path) -> None:
    """Unknown formats, folders that are not there, and scenes with nothing in them, before anything is written."""
    with pytest.raises(UnsupportedError, match=r"\.obj, \.ply, \.stl"):
        save_model(PER_VERTEX, tmp_path / "a.fbx")
    with pytest.raises(RenderError, match="there is no folder"):
        save_model(PER_VERTEX, tmp_path / "no" / "a.ply")
    with pytest.raises(SceneError, match="nothing to save"):
        save_model(Scene(), tmp_path / "a.ply")
    assert not list(tmp_path.iterdir())
