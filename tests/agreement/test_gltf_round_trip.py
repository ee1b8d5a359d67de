"""What is saved as glTF and loaded again is the same scene: to the bit in its pictures, sound to others who read it."""

from __future__ import annotations

import dataclasses
import json
import os
import shutil
import subprocess
import warnings
from pathlib import Path

import numpy as np
import pytest
from menagerie import menagerie
from staging import SLOW_AS_PYTHON

from limner.errors import LimnerWarning
from limner.files.load import load
from limner.files.write_gltf import write
from limner.linear import transform
from limner.render import render
from limner.scene.node import Node
from limner.scene.scene import Scene

KHRONOS = Path(__file__).resolve().parents[2] / ".." / "shared" / "data" / "khronos"
# Matrices and hierarchy, textures, transforms and samplers, skins, morphs, mirrors, instances, colours.
MODELS = ("Box", "BoxTextured/glTF-Binary", "BoxVertexColors", "SimpleSkin", "AnimatedMorphCube", "TextureTransformTest",
          "NegativeScaleTest", "SimpleInstancing")  # fmt: skip


def picture(scene: Scene, time: float | None = None) -> np.ndarray:
    """What is seen of a scene, at rest or at a time of its first animation."""
    return render(scene if time is None else scene.at(time), width=64, height=48, samples=1).pixels


def read(path: Path) -> Scene:
    """Load a model; what it lacks is of no interest here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimnerWarning)
        return load(path)


@SLOW_AS_PYTHON
@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
@pytest.mark.parametrize("name", MODELS)
def test_models_are_seen_alike(name: str, tmp_path: Path) -> None:
    """Load, save, load: the same picture to the bit, at rest and while it moves, and nothing to be said about it."""
    folder = KHRONOS / name
    if not folder.is_dir():
        pytest.skip(f"the Khronos sample model {name} is not here")
    first = read(next(path for path in sorted(folder.iterdir()) if path.suffix in (".glb", ".gltf")))
    assert write(first, tmp_path / "a.glb") == ()
    second = read(tmp_path / "a.glb")
    for time in (None, 0.4) if first.animations else (None,):
        np.testing.assert_array_equal(picture(first, time), picture(second, time))


@SLOW_AS_PYTHON
@pytest.mark.filterwarnings("ignore::limner.errors.LimnerWarning")
@pytest.mark.parametrize("extension", [".glb", ".gltf"])
def test_one_of_everything_is_seen_alike(extension: str, tmp_path: Path) -> None:
    """A scene that no file was before: nothing is lost, and what a file once had comes back to the bit."""
    scene = menagerie()
    first_path, second_path = tmp_path / f"a {extension}", tmp_path / f"b{extension}"
    assert write(scene, first_path) == ()
    first = read(first_path)
    assert first.notes == ()
    assert write(first, second_path) == ()
    second = read(second_path)
    np.testing.assert_array_equal(picture(scene), picture(first))
    for time in (0.0, 0.3, 0.7, 1.4):
        # Keys become single precision, which may move an edge by a pixel.
        assert np.quantile(np.abs(picture(scene, time) - picture(first, time)), 0.99) < 2e-5
        np.testing.assert_array_equal(picture(first, time), picture(second, time))


def test_the_khronos_validator_finds_no_error(tmp_path: Path) -> None:
    """Everything, as text and binary, with instances, and what is broken: no error in the reference validator."""
    require = "require.resolve('gltf-validator')"
    node = shutil.which("node")
    if node is None or subprocess.run([node, "-e", require], capture_output=True, env=os.environ, check=False).returncode:
        pytest.skip("needs node and the npm package gltf-validator (NODE_PATH)")
    scene = menagerie()
    sheared = np.array([[1.0, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    root = dataclasses.replace(scene.root, parent_from_node=sheared, name="all")
    write(scene, tmp_path / "a.glb")
    write(scene, tmp_path / "b.gltf")
    write(Scene(_without_skin(root)), tmp_path / "c.glb", gpu_instancing=True)
    write(Scene(), tmp_path / "d.glb")
    program = """
        const validator = require('gltf-validator'), fs = require('fs'), path = require('path');
        const read = (name) => new Uint8Array(fs.readFileSync(path.join(process.argv[1], decodeURIComponent(name))));
        (async () => {
            for (const name of fs.readdirSync(process.argv[1]).filter((name) => /glb$|gltf$/.test(name))) {
                const options = {uri: name, externalResourceFunction: async (uri) => read(uri)};
                const report = await validator.validateBytes(read(name), options);
                console.log(JSON.stringify([name, report.issues.messages.filter((message) => message.severity === 0)]));
            }
        })();"""
    told = subprocess.run([node, "-e", program, str(tmp_path)], capture_output=True, env=os.environ, text=True, check=True).stdout
    reports = dict(json.loads(line) for line in told.splitlines())
    assert reports == {"a.glb": [], "b.gltf": [], "c.glb": [], "d.glb": []}


def _without_skin(root: Node) -> Node:
    return dataclasses.replace(root, children=tuple(dataclasses.replace(child, skin=None) for child in root.children))


def test_trimesh_reads_the_same_geometry(tmp_path: Path) -> None:
    """An oracle: triangles in the world, one by one, and the bounds."""
    trimesh = pytest.importorskip("trimesh")
    scene = menagerie()
    kept = tuple(child for child in scene.root.children if child.name in ("pair", "bones"))
    scene = Scene(dataclasses.replace(scene.root, children=kept))
    write(scene, tmp_path / "a.glb")
    read_there = trimesh.load_scene(tmp_path / "a.glb", process=False)
    theirs = np.concatenate([
        trimesh.transform_points(geometry.vertices, matrix)[geometry.faces]
        for name in read_there.graph.nodes_geometry
        for matrix, key in [read_there.graph[name]] for geometry in [read_there.geometry[key]]
    ])  # fmt: skip
    ours = np.concatenate([
        transform.transform_points(placed.world_from_object, shape.geometry.positions.astype(np.float64))[shape.geometry.triangles]  # type: ignore[union-attr]
        for placed, shape in scene.shapes()
    ])  # fmt: skip
    np.testing.assert_allclose(read_there.bounds, scene.bounds(), atol=1e-6)

    def ordered(triangles: np.ndarray) -> np.ndarray:
        rows = triangles.reshape(len(triangles), 9).round(5) + 0.0
        return rows[np.lexsort(rows.T)]

    np.testing.assert_allclose(ordered(theirs), ordered(ours), atol=2e-5)
