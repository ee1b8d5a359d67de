"""glTF's material extensions: every number and every texture is read, kept and written; what is broken costs itself alone."""

from __future__ import annotations

import dataclasses
import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.color.transfer import linear_from_srgb
from limner.errors import SceneError
from limner.files.gltf import read
from limner.files.gltf_material_parts import PARTS
from limner.files.notes import Notes
from limner.files.specular_glossiness import converted
from limner.files.write_gltf import write
from limner.scene.digest import scene_digest
from limner.scene.material import MetallicRoughness
from limner.scene.material_extensions import (
    Anisotropy,
    Clearcoat,
    DiffuseTransmission,
    Iridescence,
    Sheen,
    Specular,
    Transmission,
    Volume,
)  # fmt: skip
from limner.scene.texture import Texels, Texture

FULL: dict[str, dict[str, Any]] = {
    "KHR_materials_clearcoat": {
        "clearcoatFactor": 0.25, "clearcoatRoughnessFactor": 0.5, "clearcoatTexture": 0, "clearcoatRoughnessTexture": 1,
        "clearcoatNormalTexture": 2,
    },
    "KHR_materials_sheen": {
        "sheenColorFactor": [0.25, 0.5, 0.75], "sheenRoughnessFactor": 0.125, "sheenColorTexture": 0, "sheenRoughnessTexture": 1,
    },
    "KHR_materials_specular": {
        "specularFactor": 0.5, "specularColorFactor": [2.0, 1.0, 0.5], "specularTexture": 1, "specularColorTexture": 0,
    },
    "KHR_materials_transmission": {"transmissionFactor": 0.75, "transmissionTexture": 1},
    "KHR_materials_volume": {
        "thicknessFactor": 0.25, "attenuationDistance": 4.0, "attenuationColor": [0.5, 0.25, 1.0], "thicknessTexture": 2,
    },
    "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": -1.5, "anisotropyTexture": 1},
    "KHR_materials_iridescence": {
        "iridescenceFactor": 0.5, "iridescenceIor": 1.75, "iridescenceThicknessMinimum": 200.0, "iridescenceThicknessMaximum": 500.0,
        "iridescenceTexture": 1, "iridescenceThicknessTexture": 2,
    },
    "KHR_materials_diffuse_transmission": {
        "diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": [1.0, 0.5, 0.25], "diffuseTransmissionTexture": 1,
        "diffuseTransmissionColorTexture": 0,
    },
}  # fmt: skip


def with_textures(fields: dict[str, Any]) -> dict[str, Any]:
    """An extension whose textures are informations: numbers stand for their indices."""
    return {key: {"index": value} if key.endswith("Texture") else value for key, value in fields.items()}


def document(triangle: Any, extensions: dict[str, Any], **fields: Any) -> bytes:
    """A triangle with a material and three one-texel textures: colour 10, 20, 30 and so on."""
    for k in range(3):
        triangle.picture([[[10 * k + 10, 10 * k + 20, 10 * k + 30, 255]]])
    triangle.document["materials"] = [{"name": "thing", "extensions": extensions, **fields}]
    triangle.document["meshes"][0]["primitives"][0]["material"] = 0
    return bytes(triangle.glb())


def material(data: bytes, notes: Notes | None = None) -> MetallicRoughness:
    """The material of the only shape of a file."""
    found = read(data, "model.glb", notes=notes or Notes()).shapes()[0][1].materials[0]
    assert isinstance(found, MetallicRoughness)
    return found


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.field)
def test_everything_is_read(part: Any, triangle: Any) -> None:
    """Every key of an extension arrives in its field; colours are sRGB-encoded, data are not; nothing is said of it."""
    given = FULL[part.extension]
    assert set(given) == {*part.numbers, *part.colors, *part.textures}
    notes = Notes()
    found = getattr(material(document(triangle, {part.extension: with_textures(given)}), notes), part.field)
    assert isinstance(found, part.kind)
    for key, (field, _) in part.numbers.items():
        assert getattr(found, field) == given[key]
    for key, (field, _) in part.colors.items():
        assert getattr(found, field) == tuple(given[key])
    for key, (field, srgb) in part.textures.items():
        texels = getattr(found, field).texels
        assert texels.pixels[0, 0, 0] == 10 * given[key] + 10
        assert texels.srgb == srgb
    assert not notes.lines()


def test_defaults() -> None:
    """The fields of an extension that says nothing are those of the file's defaults, not ours, and there are no others."""
    for part in PARTS:
        plain = dict((*part.numbers.values(), *part.colors.values()))
        assert set(plain) | {name for name, _ in part.textures.values()} | {"normal_scale"} >= {
            field.name for field in dataclasses.fields(part.kind)
        }


def test_numbers_of_the_material(triangle: Any) -> None:
    """Index of refraction, dispersion and emissive strength are fields of the material itself."""
    extensions = {
        "KHR_materials_ior": {"ior": 2.5}, "KHR_materials_dispersion": {"dispersion": 0.25},
        "KHR_materials_emissive_strength": {"emissiveStrength": 4.0},
    }  # fmt: skip
    found = material(document(triangle, extensions, emissiveFactor=[0.5, 0.25, 0.0]))
    assert (found.ior, found.dispersion, found.emission) == (2.5, 0.25, (2.0, 1.0, 0.0))
    for ior, expected in ((0.0, 0.0), (1.0, 1.0), (0.5, 1.5)):
        triangle.document["materials"][0]["extensions"] = {"KHR_materials_ior": {"ior": ior}}
        assert material(triangle.glb()).ior == expected


def test_details_of_textures(triangle: Any) -> None:
    """The scale of a coat's normals, and transforms as of every other texture."""
    information = {"index": 0, "scale": 0.5, "extensions": {"KHR_texture_transform": {"scale": [2.0, 3.0]}}}
    found = material(document(triangle, {"KHR_materials_clearcoat": {"clearcoatNormalTexture": information}})).clearcoat
    assert found is not None
    assert (found.factor, found.normal_scale) == (0.0, 0.5)
    assert found.normal_texture is not None
    assert found.normal_texture.scale == (2.0, 3.0)


@pytest.mark.parametrize("broken", [{"sheenRoughnessFactor": 7.0}, {"sheenColorFactor": [1, 2]}, {"sheenRoughnessFactor": "rough"}, 7])
def test_one_broken_extension(broken: Any, triangle: Any) -> None:
    """A broken extension is left out with a word; the rest of the material stays."""
    notes = Notes()
    extensions = {"KHR_materials_sheen": broken, "KHR_materials_clearcoat": {"clearcoatFactor": 1.0}}
    found = material(document(triangle, extensions, pbrMetallicRoughness={"metallicFactor": 0.25}), notes)
    assert (found.sheen, found.clearcoat, found.metallic) == (None, Clearcoat(1.0), 0.25)
    assert any("KHR_materials_sheen is left out" in line for line in notes.lines())


def test_written_and_read(triangle: Any, tmp_path: Path) -> None:
    """A file with all of it, read, written and read again, has the same scene to the bit."""
    extensions = {name: with_textures(fields) for name, fields in FULL.items()}
    extensions |= {"KHR_materials_ior": {"ior": 1.25}, "KHR_materials_dispersion": {"dispersion": 0.5}}
    extensions["KHR_materials_clearcoat"]["clearcoatNormalTexture"]["scale"] = 0.5
    triangle.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = triangle.accessor([[0, 0], [1, 0], [0, 1]])
    first = read(document(triangle, extensions), "model.glb", notes=Notes())
    write(first, tmp_path / "again.glb")
    data = (tmp_path / "again.glb").read_bytes()
    assert scene_digest(read(data, "again.glb", notes=Notes())) == scene_digest(first)
    written = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    assert set(written["extensionsUsed"]) == set(extensions)


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: Clearcoat(factor=1.5), r"clearcoat.factor must lie in \[0, 1\]"),
        (lambda: Sheen(color=(0, 2, 0)), r"sheen.color .*\[0, 1\]"),
        (lambda: Specular(color=-1), "specular.color"), (lambda: Transmission(factor=math.nan), "transmission.factor must be finite"),
        (lambda: Volume(thickness=-1), "volume.thickness must not be below 0"), (lambda: Iridescence(ior=0.9), "iridescence.ior"),
        (lambda: Volume(attenuation_distance=0.0), "volume.attenuation_distance must be positive"),
        (lambda: Anisotropy(texture="brushed.png"), "anisotropy.texture must be a Texture"),  # type: ignore[arg-type]
        (lambda: DiffuseTransmission(factor=2), "diffuse_transmission.factor"), (lambda: MetallicRoughness(ior=0.5), "material.ior"),
        (lambda: MetallicRoughness(sheen=Clearcoat()), "material.sheen must be of type Sheen"),  # type: ignore[arg-type]
        (lambda: MetallicRoughness(variants=("red",)), "material.variants"),  # type: ignore[arg-type]
    ],
)  # fmt: skip
def test_what_is_refused(made: Any, message: str) -> None:
    """Descriptions complain in words, with the field."""
    with pytest.raises(SceneError, match=message):
        made()


# --- specular and glossiness --------------------------------------------------------------------------------------------------------


def test_conversion_keeps_what_can_be_kept() -> None:
    """Greys of any kind scatter and reflect afterwards what they did before; so do all colours that reflect 4 percent, and all metals."""
    rng = np.random.default_rng(8)
    grey = rng.random((200, 2, 1)) * np.ones(3)
    diffuse, specular = grey[:, 0], 0.04 + 0.96 * grey[:, 1]
    base, metallic = converted(diffuse, specular)
    k = 1.0 - metallic[:, None]
    assert np.allclose(0.04 * k + base * (1.0 - k), specular, atol=0.02)
    assert np.allclose(0.96 * base * k, diffuse * (1.0 - specular), atol=0.02)
    base, metallic = converted(rng.random((50, 3)), np.full((50, 3), 0.04))
    assert not metallic.any()
    colors = rng.random((50, 3))
    base, metallic = converted(np.zeros((50, 3)), colors + 0.05)
    assert np.allclose(metallic, 1.0)
    assert np.allclose(base, np.clip(colors + 0.05, 0.0, 1.0))


def test_factors_of_glossiness(triangle: Any) -> None:
    """A material without textures stays one: a red dielectric, and gold."""
    name = "KHR_materials_pbrSpecularGlossiness"
    given = {"diffuseFactor": [0.5, 0.0, 0.0, 0.5], "specularFactor": [0.04, 0.04, 0.04], "glossinessFactor": 0.75}
    red = material(document(triangle, {name: given}))
    assert np.allclose(red.base_color, (0.5, 0.0, 0.0))
    assert (red.metallic, red.roughness, red.alpha, red.base_color_texture) == (0.0, 0.25, 0.5, None)
    triangle.document["materials"][0]["extensions"] = {name: {"diffuseFactor": [0, 0, 0, 1], "specularFactor": [1.0, 0.75, 0.25]}}
    gold = material(triangle.glb())
    assert np.allclose(gold.base_color, (1.0, 0.75, 0.25))
    assert (gold.metallic, gold.roughness) == (1.0, 0.0)


def test_textures_of_glossiness(triangle: Any) -> None:
    """Texel by texel, the small texture enlarged: metal where the diffuse texture is black and the other bright, factors counted in."""
    diffuse = [[[0, 0, 0, 128], [188, 100, 50, 255]]]
    triangle.picture(diffuse)
    triangle.picture([[[255, 255, 255, 51]] * 4, [[56, 56, 56, 255]] * 4])
    triangle.document["materials"] = [{"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 1}, "glossinessFactor": 0.5,
    }}}]  # fmt: skip
    triangle.document["meshes"][0]["primitives"][0]["material"] = 0
    found = material(triangle.glb())
    assert isinstance(found.base_color_texture, Texture)
    assert isinstance(found.metallic_roughness_texture, Texture)
    colors, numbers = (texture.texels.pixels[::-1] for texture in (found.base_color_texture, found.metallic_roughness_texture))
    assert colors.shape == numbers.shape == (2, 4, 4)
    assert colors[0, 0].tolist() == [255, 255, 255, 128]
    assert numbers[0, 0, 1:3].tolist() == [round((1 - 0.2 * 0.5) * 255), 255]
    assert np.abs(colors[1, 3, :3].astype(int) - diffuse[0][1][:3]).max() <= 2
    assert numbers[1, 3, 2] <= 3
    assert not found.metallic_roughness_texture.texels.srgb
    assert (found.base_color, found.metallic, found.roughness) == ((1.0, 1.0, 1.0), 1.0, 1.0)
    assert linear_from_srgb(56 / 255) == pytest.approx(0.04, abs=0.001)


def test_other_textures_of_glossiness(triangle: Any) -> None:
    """A specular texture that lies otherwise is left out, and said; what pbrMetallicRoughness says comes first."""
    for value in (100, 200):
        triangle.picture([[[value] * 3]])
    given = {"diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 1, "texCoord": 1}}
    triangle.document["materials"] = [{"extensions": {"KHR_materials_pbrSpecularGlossiness": given}}]
    triangle.document["meshes"][0]["primitives"][0]["material"] = 0
    notes = Notes()
    assert material(triangle.glb(), notes).base_color_texture is not None
    assert any("specular texture" in line for line in notes.lines())
    triangle.document["materials"][0]["pbrMetallicRoughness"] = {"metallicFactor": 0.5}
    assert material(triangle.glb()).metallic == 0.5


def test_texels_of_parts_are_shared(triangle: Any) -> None:
    """A picture that several extensions show is there once."""
    extensions = {name: with_textures(FULL[name]) for name in ("KHR_materials_transmission", "KHR_materials_anisotropy")}
    found = material(document(triangle, extensions))
    assert found.transmission is not None
    assert found.anisotropy is not None
    textures = (found.transmission.factor_texture, found.anisotropy.texture)
    assert all(isinstance(texture, Texture) and isinstance(texture.texels, Texels) for texture in textures)
    assert textures[0].texels is textures[1].texels  # type: ignore[union-attr]
