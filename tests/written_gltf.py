"""What scenes are written as, as glTF, and what comes back."""

from __future__ import annotations

import dataclasses
import json
import struct
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from limner.errors import LimnerWarning
from limner.files.load import load
from limner.files.write_gltf import write
from limner.mesh.mesh import Mesh
from limner.scene.material import MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape

__all__ = ["TRIANGLE", "again", "document", "geometry", "places", "plain", "saved", "showing"]

TRIANGLE = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], name="t")


def document(path: Path) -> dict[str, Any]:
    """The JSON of a .glb."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    found: dict[str, Any] = json.loads(data[20 : 20 + length])
    return found


def saved(scene: Scene, folder: Path, **options: Any) -> dict[str, Any]:
    """What a scene is written as."""
    write(scene, folder / "a.glb", **options)
    return document(folder / "a.glb")


def again(scene: Scene, folder: Path) -> Scene:
    """A scene, saved and loaded."""
    write(scene, folder / "a.glb")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimnerWarning)
        return load(folder / "a.glb")


def showing(*materials: Any, mesh: Mesh = TRIANGLE) -> Scene:
    """A scene of one mesh."""
    return Scene(Node(children=(Node("n", shapes=(Shape(mesh, materials or (MetallicRoughness(),)),)),)))


def geometry(scene: Scene) -> Mesh:
    """The first mesh of a scene."""
    found = scene.shapes()[0][1].geometry
    assert isinstance(found, Mesh)
    return found


def places(scene: Scene) -> dict[str, np.ndarray]:
    """Where nodes stand, by their paths."""
    return {placed.path: placed.world_from_object for placed in scene.root.walk()}


def plain(value: Any) -> Any:
    """A description as numbers that can be compared, its pictures by their bytes."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    return value.tobytes() if isinstance(value, np.ndarray) else value
