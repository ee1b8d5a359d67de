"""KHR_animation_pointer: everything that a file can say may move, and is written as it was read."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from animated_gltf import TRIANGLE, channel, pointer

from limner.files.gltf_material_parts import PARTS
from limner.files.load import load
from limner.files.save_mesh import save_model
from limner.mesh.mesh import Mesh
from limner.scene.animation import WeightsChannel
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.material import MetallicRoughness
from limner.scene.scene import Scene


def read_twice(writer: Any, folder: Path) -> tuple[Scene, Scene]:
    """The file, and the file that is written of it; nothing is to be said of either."""
    first = load(writer.save(folder))
    assert save_model(first, folder / "again.glb") == ()
    second = load(folder / "again.glb")
    assert first.notes == second.notes == ()
    return first, second


def material(scene: Scene, time: float) -> MetallicRoughness:
    """The look of the first shape."""
    look = scene.at(time).shapes()[0][1].materials[0]
    assert isinstance(look, MetallicRoughness)
    return look


@pytest.mark.parametrize("owner", ["/nodes/0", "/meshes/0"])
def test_single_weights(writer: Any, tmp_path: Path, owner: str) -> None:
    """Two of three morphs move by keys of their own, one goes straight and one stands still between its keys; the third is at rest."""
    primitive = writer.primitive(TRIANGLE)
    primitive["targets"] = [{"POSITION": writer.accessor([[x, y, z]] * 3)} for x, y, z in np.eye(3)]
    writer.document["meshes"][0]["weights"] = [0.0, 0.25, 0.0]
    writer.document["nodes"] = [{"mesh": 0, "name": "n"}]
    channel(writer, pointer(f"{owner}/weights/0"), [0, 1], [0, 1])
    channel(writer, pointer(f"{owner}/weights/2"), [0, 0.5], [1, 2], "STEP")
    for scene in read_twice(writer, tmp_path):
        for time, expected in ((0.25, (0.25, 0.25, 1.0)), (0.75, (0.75, 0.25, 2.0))):
            mesh = scene.at(time).shapes()[0][1].geometry
            assert isinstance(mesh, Mesh)
            np.testing.assert_allclose(mesh.positions[0], expected, atol=1e-6)


def test_single_weights_over_all_of_them(writer: Any, tmp_path: Path) -> None:
    """What points to one weight counts for it; what is said of all, for the others. Keys at the same times stay as few as they are."""
    primitive = writer.primitive(TRIANGLE)
    primitive["targets"] = [{"POSITION": writer.accessor([[1, 0, 0]] * 3)}] * 2
    writer.document["nodes"] = [{"mesh": 0, "name": "n"}]
    channel(writer, pointer("/nodes/0/weights/1"), [0, 1], [0, 8])
    channel(writer, {"node": 0, "path": "weights"}, [0, 1], [0, 1, 0, 4])
    for scene in read_twice(writer, tmp_path):
        (found,) = scene.animations[0].channels
        assert isinstance(found, WeightsChannel)
        np.testing.assert_array_equal(found.weights.values, [[0, 0], [0, 8]])


def test_a_weight_that_is_not_there(writer: Any, tmp_path: Path) -> None:
    """It is left out, with the number of those that there are."""
    primitive = writer.primitive(TRIANGLE)
    primitive["targets"] = [{"POSITION": writer.accessor([[1, 0, 0]] * 3)}]
    channel(writer, pointer("/nodes/0/weights/1"), [0, 1], [0, 8])
    with pytest.warns(match="has 1 morph targets, and an animation moves number 1"):
        assert load(writer.save(tmp_path)).animations == ()


def test_factor_and_strength_of_what_shines(writer: Any, tmp_path: Path) -> None:
    """Their product at every time, though both move: half of (0, 4, 0) by the mean of 1 and 5."""
    writer.primitive(TRIANGLE, material=0)
    writer.document["materials"] = [{"name": "m", "emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {}}}]
    channel(writer, pointer("/materials/0/emissiveFactor"), [0, 1], [[0, 0, 0], [0, 1, 0]])
    strength = "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength"
    channel(writer, pointer(strength), [0, 1], [1, 5])
    for scene in read_twice(writer, tmp_path):
        np.testing.assert_allclose(material(scene, 0.5).emission, (0.0, 1.5, 0.0), atol=1e-5)
        np.testing.assert_allclose(material(scene, 1.0).emission, (0.0, 5.0, 0.0), atol=1e-5)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.extension)
def test_every_number_of_every_extension(writer: Any, tmp_path: Path, part: Any) -> None:
    """From its value at 0 half the way to that at 1, whatever it is, twice."""
    writer.primitive(TRIANGLE, material=0)
    numbers: dict[str, Any] = {key: 1.25 if key.endswith("Ior") else 0.25 for key in part.numbers}
    numbers |= {key: [0.25, 0.5, 0.75] for key in part.colors}
    writer.document["materials"] = [{"name": "m", "extensions": {part.extension: dict(numbers)}}]
    for key, low in numbers.items():
        values = [low, 0.75 + low] if isinstance(low, float) else [low, [1.0, 1.0, 1.0]]
        channel(writer, pointer(f"/materials/0/extensions/{part.extension}/{key}"), [0, 1], values)
    for scene in read_twice(writer, tmp_path):
        at_rest, half, end = (getattr(material(scene, time), part.field) for time in (0.0, 0.5, 1.0))
        for field, _ in (*part.numbers.values(), *part.colors.values()):
            a, b, c = (np.asarray(getattr(moment, field)) for moment in (at_rest, half, end))
            np.testing.assert_allclose(b, (a + c) / 2.0, atol=1e-6)
            assert (a != c).all()


def test_cameras(writer: Any, tmp_path: Path) -> None:
    """Angles, planes, and what a view is wide: of a parallel one half width over half height."""
    writer.primitive(TRIANGLE)
    writer.document["cameras"] = [
        {"type": "perspective", "name": "p", "perspective": {"yfov": 1.0, "znear": 0.5, "zfar": 9.0, "aspectRatio": 1.0}},
        {"type": "orthographic", "name": "o", "orthographic": {"xmag": 2.0, "ymag": 1.0, "znear": 0.5, "zfar": 9.0}},
    ]
    writer.document["nodes"] += [{"camera": 0}, {"camera": 1}]
    writer.document["scenes"] = [{"nodes": [0, 1, 2]}]
    for name, low, high in (("yfov", 1.0, 0.5), ("znear", 0.5, 1.5), ("zfar", 9.0, 11.0), ("aspectRatio", 1.0, 3.0)):
        channel(writer, pointer(f"/cameras/0/perspective/{name}"), [0, 1], [low, high])
    for name, low, high in (("xmag", 2.0, 4.0), ("ymag", 1.0, 2.0), ("znear", 0.5, 1.5), ("zfar", 9.0, 11.0)):
        channel(writer, pointer(f"/cameras/1/orthographic/{name}"), [0, 1], [low, high])
    for scene in read_twice(writer, tmp_path):
        lens, parallel = scene.at(0.5).cameras()
        assert isinstance(lens, PerspectiveCamera)
        assert isinstance(parallel, OrthographicCamera)
        np.testing.assert_allclose((lens.yfov_degrees, lens.near, lens.far, lens.aspect), (math.degrees(0.75), 1.0, 10.0, 2.0), rtol=1e-6)
        np.testing.assert_allclose((parallel.height, parallel.aspect, parallel.near, parallel.far), (3.0, 2.0, 1.0, 10.0), rtol=1e-6)


def test_lights(writer: Any, tmp_path: Path) -> None:
    """Colour, intensity, range and both angles of a cone."""
    writer.primitive(TRIANGLE)
    writer.document["extensions"] = {"KHR_lights_punctual": {"lights": [{
        "type": "spot", "name": "s", "color": [1, 1, 1], "intensity": 2, "range": 4, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5},
    }]}}  # fmt: skip
    writer.document["nodes"].append({"extensions": {"KHR_lights_punctual": {"light": 0}}})
    writer.document["scenes"] = [{"nodes": [0, 1]}]
    root = "/extensions/KHR_lights_punctual/lights/0"
    cone = ("spot/innerConeAngle", [0.1, 0.3]), ("spot/outerConeAngle", [0.5, 0.7])
    for name, values in (("intensity", [2, 4]), ("range", [4, 8]), *cone):
        channel(writer, pointer(f"{root}/{name}"), [0, 1], values)
    channel(writer, pointer(f"{root}/color"), [0, 1], [[1, 1, 1], [0, 0.5, 1]])
    for scene in read_twice(writer, tmp_path):
        (_, light), *_ = scene.at(0.5).lights()
        found = (*light.color, light.intensity, light.range, math.radians(light.inner_degrees), math.radians(light.outer_degrees))  # type: ignore[union-attr]
        np.testing.assert_allclose(found, (0.5, 0.75, 1.0, 3.0, 6.0, 0.2, 0.6), rtol=1e-6)
