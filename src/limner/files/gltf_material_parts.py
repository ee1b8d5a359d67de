"""What glTF's material extensions are called in a file, and what they are called here: one table, for the reader and for the writer.

Each row is an extension that is a part of `MetallicRoughness`; the part has the extension's own quantities, so that a file's numbers are
kept as they are.

**Source**: Khronos Group, the extensions that are named.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

from ..scene._values import Triple
from ..scene.material_extensions import Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Sheen, Specular, Transmission, Volume

__all__ = ["DISPERSION", "IOR", "NORMAL_SCALE", "PARTS", "Part"]

IOR, DISPERSION = "KHR_materials_ior", "KHR_materials_dispersion"
NORMAL_SCALE = "normal_scale"  # said of the texture, not of the part


@dataclasses.dataclass(frozen=True)
class Part:
    """An extension: its name, the field of the material that holds it, the class of what is held.

    Parameters
    ----------
    numbers : mapping
        Of each key of the file: our field, and what it is where the file does not say.
    colors : mapping
        Likewise.
    textures : mapping
        Of each key of the file: our field, and whether its colours are sRGB-encoded.
    """

    extension: str
    field: str
    kind: type
    numbers: Mapping[str, tuple[str, float | None]] = dataclasses.field(default_factory=dict)
    colors: Mapping[str, tuple[str, Triple]] = dataclasses.field(default_factory=dict)
    textures: Mapping[str, tuple[str, bool]] = dataclasses.field(default_factory=dict)


_WHITE, _BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)

PARTS = (
    Part(
        "KHR_materials_clearcoat", "clearcoat", Clearcoat,
        {"clearcoatFactor": ("factor", 0.0), "clearcoatRoughnessFactor": ("roughness", 0.0)},
        textures={
            "clearcoatTexture": ("factor_texture", False), "clearcoatRoughnessTexture": ("roughness_texture", False),
            "clearcoatNormalTexture": ("normal_texture", False),
        },
    ),
    Part(
        "KHR_materials_sheen", "sheen", Sheen, {"sheenRoughnessFactor": ("roughness", 0.0)}, {"sheenColorFactor": ("color", _BLACK)},
        {"sheenColorTexture": ("color_texture", True), "sheenRoughnessTexture": ("roughness_texture", False)},
    ),
    Part(
        "KHR_materials_specular", "specular", Specular, {"specularFactor": ("factor", 1.0)}, {"specularColorFactor": ("color", _WHITE)},
        {"specularTexture": ("factor_texture", False), "specularColorTexture": ("color_texture", True)},
    ),
    Part(
        "KHR_materials_transmission", "transmission", Transmission, {"transmissionFactor": ("factor", 0.0)},
        textures={"transmissionTexture": ("factor_texture", False)},
    ),
    Part(
        "KHR_materials_volume", "volume", Volume,
        {"thicknessFactor": ("thickness", 0.0), "attenuationDistance": ("attenuation_distance", None)},
        {"attenuationColor": ("attenuation_color", _WHITE)}, {"thicknessTexture": ("thickness_texture", False)},
    ),
    Part(
        "KHR_materials_anisotropy", "anisotropy", Anisotropy,
        {"anisotropyStrength": ("strength", 0.0), "anisotropyRotation": ("rotation", 0.0)},
        textures={"anisotropyTexture": ("texture", False)},
    ),
    Part(
        "KHR_materials_iridescence", "iridescence", Iridescence,
        {
            "iridescenceFactor": ("factor", 0.0), "iridescenceIor": ("ior", 1.3),
            "iridescenceThicknessMinimum": ("thickness_minimum", 100.0), "iridescenceThicknessMaximum": ("thickness_maximum", 400.0),
        },
        textures={"iridescenceTexture": ("factor_texture", False), "iridescenceThicknessTexture": ("thickness_texture", False)},
    ),
    Part(
        "KHR_materials_diffuse_transmission", "diffuse_transmission", DiffuseTransmission,
        {"diffuseTransmissionFactor": ("factor", 0.0)}, {"diffuseTransmissionColorFactor": ("color", _WHITE)},
        {"diffuseTransmissionTexture": ("factor_texture", False), "diffuseTransmissionColorTexture": ("color_texture", True)},
    ),
)  # fmt: skip
