"""Rows of materials with what glTF has extensions for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from staging import place, scene_of

from limner.mesh.shapes import primitives
from limner.scene.camera import PerspectiveCamera
from limner.scene.material import Dielectric, Lambert, Material, MetallicRoughness
from limner.scene.material_extensions import Clearcoat, Sheen, Specular, Transmission, Volume
from limner.scene.scene import Scene
from limner.tables import layouts
from limner.tables.build import build, media_table

BALL = primitives.sphere(1.0, 4)


def in_picture(material: Material) -> Scene:
    return scene_of(place(BALL, material), camera=PerspectiveCamera.look_at((0, 0, 4), (0, 0, 0)))


def row_of(material: Material) -> np.void:
    scene = in_picture(material)
    assert scene.camera is not None
    return build(scene, scene.camera, 8, 8).materials[0]


def test_a_plain_material_has_no_layers():
    """Its reflectance is glTF's 0.04 to the bit, and no door need know of layers."""
    row = row_of(MetallicRoughness())
    assert row["layers"] == 0
    assert row["dielectric_f0"] == np.float32(0.04)
    assert row_of(MetallicRoughness(ior=2.0))["dielectric_f0"] == np.float32(1 / 9)
    assert row_of(MetallicRoughness(ior=0.0))["dielectric_f0"] == 1.0
    assert row_of(Lambert())["layers"] == 0


@pytest.mark.parametrize(
    "part",
    [{"clearcoat": Clearcoat(0.0)}, {"sheen": Sheen((0.0, 0.0, 0.0))}, {"transmission": Transmission(0.0), "volume": Volume(1.0)}],
    ids=["coat", "sheen", "transmission"],
)
def test_what_a_part_has_none_of_is_no_layer(part):
    row = row_of(MetallicRoughness(metallic=0.0, **part))
    assert row["layers"] == 0
    assert row["alpha_mode"] == layouts.OPAQUE


def test_sheets_and_volumes():
    """A transmission without a thickness is a sheet; with one it fills its shape, and is a medium after Beer's law."""
    sheet = row_of(MetallicRoughness(transmission=Transmission()))
    assert sheet["layers"] == layouts.SHEET | layouts.SOLID
    assert sheet["alpha_mode"] == layouts.BLEND
    assert sheet["medium"] == 0
    glass = MetallicRoughness(transmission=Transmission(), volume=Volume(0.5, None, 2.0, (0.5, 1.0, 0.25)), ior=1.4, dispersion=2.0)
    row = row_of(glass)
    assert row["layers"] == layouts.VOLUME | layouts.SOLID
    assert row["medium"] == 1
    media = media_table(in_picture(glass))
    np.testing.assert_allclose(media[1]["attenuation"], [math.log(2) / 2, 0.0, math.log(4) / 2], rtol=1e-6, atol=1e-7)
    assert media[1]["ior"] == np.float32(1.4)
    # KHR_materials_dispersion: half spread = (ior - 1) 0.025 dispersion
    assert media[1]["dispersion"] == np.float32(0.4 * 0.025 * 2.0)
    assert media_table(in_picture(Dielectric()))[1]["dispersion"] == 0.0


def test_layers_of_an_unlit_material_are_not_looked_at():
    assert row_of(MetallicRoughness(unlit=True, specular=Specular(0.5), transmission=Transmission()))["layers"] == 0


def test_doors_take_the_same_bytes_under_two_names():
    """Rows for a door that knows layers are a view of those for one that does not."""
    plain, layered = layouts.MATERIAL, layouts.LAYERED_MATERIAL
    assert plain.itemsize == layered.itemsize
    assert list(plain.fields.values()) == list(layered.fields.values())
    assert set(plain.names) ^ set(layered.names) == {"no_layers", "has_layers"}
