"""Models that others made: Khronos' sample assets and feature scenes, its validator's tests, well-known OBJ meshes.

They lie beside a developer's checkout; where they are missing the tests are skipped.
"""

from __future__ import annotations

import importlib.util
import json
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from limner.errors import FileFormatError, LimnerError, UnsupportedError
from limner.files.load import load
from limner.mesh.mesh import Mesh
from limner.scene.line_set import LineSet
from limner.scene.points import PointCloud
from limner.scene.scene import Scene

DATA = Path(__file__).resolve().parents[4] / "shared" / "data"

pytestmark = [
    pytest.mark.skipif(not DATA.is_dir(), reason="the sample models are not here"),
    pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning"),
]


def models(folder: str) -> list[Path]:
    """Return all models below a folder of samples."""
    return sorted(path for path in (DATA / folder).rglob("*") if path.suffix in (".gltf", ".glb", ".obj"))


def world_triangles(scene: Scene) -> np.ndarray:
    """Return the corners of all triangles in the world, (n, 3, 3)."""
    found = [np.zeros((0, 3, 3))]
    for placed, shape in scene.shapes():
        if isinstance(shape.geometry, (LineSet, PointCloud)):
            continue
        assert isinstance(shape.geometry, Mesh)
        corners = shape.geometry.positions[shape.geometry.triangles].astype(np.float64)
        found.append(corners @ placed.world_from_object[:3, :3].T + placed.world_from_object[:3, 3])
    return np.concatenate(found)


@pytest.mark.parametrize("path", models("khronos"), ids=lambda path: path.relative_to(DATA / "khronos").as_posix())
def test_khronos_samples(path: Path) -> None:
    """Each sample gives triangles and all its pictures; only Draco without its library is refused, naming it."""
    if "Draco" in path.as_posix() and importlib.util.find_spec("DracoPy") is None:
        with pytest.raises(UnsupportedError, match="KHR_draco_mesh_compression"):
            load(path)
        return
    scene = load(path)
    assert len(world_triangles(scene)) > 0
    assert np.isfinite(scene.bounds()).all()
    assert not any("drawn without, " in note or "left out:" in note for note in scene.notes)


@pytest.mark.parametrize("path", models("features"), ids=lambda path: path.stem)
def test_feature_scenes(path: Path) -> None:
    """Each feature scene is read; those whose buffer was not copied along say that it is missing."""
    uris = [buffer.get("uri") for buffer in json.loads(path.read_text()).get("buffers", [])]
    missing = [uri for uri in uris if uri and not uri.startswith("data:") and not (path.parent / uri).exists()]
    if missing and len(uris) == 1:
        with pytest.raises(FileFormatError, match="is missing"):
            load(path)
        return
    assert isinstance(load(path), Scene)


@pytest.mark.parametrize("path", models("validator"), ids=lambda path: path.relative_to(DATA / "validator").as_posix())
def test_validator_files(path: Path) -> None:
    """Valid files are read; bad ones are read in part or refused in one line; none takes memory."""
    report_path = path.with_name(path.name + ".report.json")
    report = json.loads(report_path.read_text()) if report_path.exists() else {}
    is_valid = report.get("issues", {}).get("numErrors", 1) == 0
    said = ""
    tracemalloc.start()
    try:
        load(path)
    except UnsupportedError:
        assert "minVersion" in path.read_text() or not is_valid
    except LimnerError as error:
        said = str(error)
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert "\n" not in said
    assert not (said and is_valid)
    assert peak < 20_000_000


def test_one_model_in_four_encodings() -> None:
    """Duck as glTF, embedded, binary and quantised: the same triangles, the last up to its step."""
    ducks = [world_triangles(load(DATA / "khronos" / "Duck" / name)) for name in (
        "glTF/Duck.gltf", "glTF-Embedded/Duck.gltf", "glTF-Binary/Duck.glb", "glTF-Quantized/Duck.gltf",
    )]  # fmt: skip
    np.testing.assert_array_equal(ducks[0], ducks[1])
    np.testing.assert_allclose(ducks[2], ducks[0], atol=1e-6)
    size = np.ptp(ducks[0].reshape(-1, 3), axis=0).max()
    for mine, exact in zip(np.sort(ducks[3].reshape(-1, 3), axis=0), np.sort(ducks[0].reshape(-1, 3), axis=0), strict=True):
        np.testing.assert_allclose(mine, exact, atol=size / 256.0)


@pytest.mark.parametrize(
    "name",
    ["Duck/glTF-Binary/Duck.glb", "DamagedHelmet/DamagedHelmet.glb", "CesiumMilkTruck/CesiumMilkTruck.glb",
     "BoxInterleaved/BoxInterleaved.glb", "OrientationTest/OrientationTest.glb", "NegativeScaleTest/NegativeScaleTest.glb"],
)  # fmt: skip
def test_the_same_surface_as_trimesh(name: str) -> None:
    """trimesh, which reads glTF by other means, finds the same bounds and the same area in the world."""
    trimesh = pytest.importorskip("trimesh", reason="the formats extra is not installed")
    corners = world_triangles(load(DATA / "khronos" / name))
    other = trimesh.load_scene(DATA / "khronos" / name)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2.0
    np.testing.assert_allclose(corners.reshape(-1, 3).min(axis=0), other.bounds[0], atol=1e-4 * np.ptp(other.bounds))
    np.testing.assert_allclose(corners.reshape(-1, 3).max(axis=0), other.bounds[1], atol=1e-4 * np.ptp(other.bounds))
    assert area == pytest.approx(other.to_mesh().area, rel=1e-4)


@pytest.mark.parametrize("name", ["AlphaBlendModeTest", "AnisotropyRotationTest"])
def test_bitangents_point_along_v(name: str) -> None:
    """In sample models with tangents ``w cross(n, t)`` points along increasing v, as it is here, and t along u."""
    checked = 0
    for _, shape in load(DATA / "khronos" / name / f"{name}.glb").shapes():
        mesh = shape.geometry
        assert isinstance(mesh, Mesh)
        if mesh.tangents is None or mesh.uvs is None or mesh.normals is None:
            continue
        p, uv = mesh.positions[mesh.triangles].astype(float), mesh.uvs[mesh.triangles].astype(float)
        (e1, e2), (d1, d2) = (p[:, 1:] - p[:, :1]).swapaxes(0, 1), (uv[:, 1:] - uv[:, :1]).swapaxes(0, 1)
        determinant = d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]
        along_v = (e2 * d1[:, :1] - e1 * d2[:, :1]) * np.sign(determinant)[:, None]
        along_u = (e1 * d2[:, 1:] - e2 * d1[:, 1:]) * np.sign(determinant)[:, None]
        normal, tangent = mesh.normals[mesh.triangles[:, 0]], mesh.tangents[mesh.triangles[:, 0]]
        bitangent = tangent[:, 3:] * np.cross(normal, tangent[:, :3])
        good = np.abs(determinant) > 1e-9
        assert np.einsum("ti,ti->t", bitangent, along_v)[good].min() > 0.0
        assert np.einsum("ti,ti->t", tangent[:, :3], along_u)[good].min() > 0.0
        checked += int(good.sum())
    assert checked > 50


@pytest.mark.parametrize("path", models("meshes"), ids=lambda path: path.stem)
def test_well_known_meshes(path: Path) -> None:
    """Each OBJ mesh has the vertices and triangles that a plain reading of its lines counts, in order."""
    positions, triangles = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            positions.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
            triangles.append(len(corners) - 2)
            if len(corners) == 3:
                triangles[-1] = 1
    ((_, shape),) = load(path).shapes()
    mesh = shape.geometry
    assert isinstance(mesh, Mesh)
    np.testing.assert_allclose(mesh.positions, np.array(positions, dtype=np.float32))
    assert len(mesh.triangles) == sum(triangles)
    assert mesh.normals is not None
    assert np.abs(np.linalg.norm(mesh.normals, axis=1) - 1.0).max() < 1e-5
