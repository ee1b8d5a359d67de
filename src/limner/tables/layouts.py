"""Every dtype and kind number that kernels see: one page, the contract between the scene and the kernels.

A family (instances, meshes, materials, lights, textures) is one record array; bulk numbers are plain C-contiguous arrays. An
index of -1 refers to nothing. Numbers in records are float32 and int32 unless they count bytes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array

__all__ = ["LIGHTING_ARRAYS", "SCENE_ARRAYS", "Lighting", "SceneTables"]

f32, i32, i64 = np.float32, np.int32, np.int64

# Kinds of geometry
MESH, SPHERE, PLANE, BOX = 0, 1, 2, 3

# Kinds of material
LAMBERT, BLINN_PHONG, METALLIC_ROUGHNESS, SHADOW_CATCHER = 0, 1, 2, 3

# Kinds of highlight
BLINN, PHONG = 0, 1

# Kinds of light
POINT_LIGHT, DIRECTIONAL_LIGHT, SPOT_LIGHT, AMBIENT_LIGHT = 0, 1, 2, 3

# How a surface's alpha is used
OPAQUE, MASK, BLEND = 0, 1, 2

# What lies outside a texture
REPEAT, MIRROR, CLAMP = 0, 1, 2

# How texels are combined
NEAREST, BILINEAR, TRILINEAR, ANISOTROPIC, RIPMAP = 0, 1, 2, 3, 4

# Kinds of projection
PERSPECTIVE, ORTHOGRAPHIC = 0, 1

MAX_TEXTURE_LEVELS = 16

# The sky blurred for rough mirrors
BLURRED_WIDTH, BLURRED_HEIGHT, BLURRED_LEVELS = 64, 32, 6

CAMERA = np.dtype(
    [
        ("position", f32, 3),  # world: the eye; orthographic: the centre of the picture
        ("corner", f32, 3),  # towards raster point (0, 0) at distance 1; orthographic: from the position to it
        ("dx", f32, 3),  # one pixel to the right
        ("dy", f32, 3),  # one pixel up
        ("gaze", f32, 3),  # unit, along which depth is measured
        ("near", f32),
        ("far", f32),
        ("kind", i32),
        ("width", i32),
        ("height", i32),
    ],
    align=True,
)

INSTANCE = np.dtype(
    [
        ("world_from_object", f32, (3, 4)),
        ("object_from_world", f32, (3, 4)),
        ("world_from_normal", f32, (3, 3)),
        ("size", f32, 3),  # sphere: radius in [0]; box: half edges
        ("kind", i32),
        ("mesh", i32),  # what is drawn as triangles: for a sphere, box or plane its tessellation; -1: none
        ("material", i32),  # first of its materials
        ("flipped", i32),  # 1: the transform reflects, so that clockwise is outside
    ],
    align=True,
)

MESH_RANGES = np.dtype(
    [
        ("position", i32),  # row of positions
        ("n_positions", i32),
        ("triangle", i32),  # row of triangles
        ("n_triangles", i32),
        ("normal", i64),  # place in attributes, 3 numbers each; -1: faceted
        ("normal_triangle", i32),  # row of triangles with the normals' indices; -1: those of the positions
        ("uv", i64),  # place in attributes, 2 numbers each
        ("uv_triangle", i32),
        ("uv1", i64),
        ("color", i64),  # 4 numbers each, indexed as the positions
        ("tangent", i64),  # 4 numbers each, indexed as the normals
        ("slot", i32),  # place in slots: one material offset per triangle; -1: all 0
    ],
    align=True,
)

MATERIAL = np.dtype(
    [
        ("color", f32, 3),  # kd, or the base colour
        ("alpha", f32),
        ("specular", f32, 3),  # ks
        ("exponent", f32),
        ("specular_scale", f32),  # 1, or the normalisation (p + 2) / 8
        ("highlight", i32),  # BLINN or PHONG
        ("ambient", f32, 3),  # ka; negative: the diffuse coefficient
        ("mirror", f32, 3),
        ("emission", f32, 3),
        ("emission_weight", f32),  # luminance of the emission, texture averaged: how often its triangles are drawn
        ("metallic", f32),
        ("roughness", f32),
        ("normal_scale", f32),
        ("occlusion_strength", f32),
        ("alpha_cutoff", f32),
        ("kind", i32),
        ("alpha_mode", i32),
        ("double_sided", i32),
        ("unlit", i32),
        ("color_texture", i32),
        ("specular_texture", i32),
        ("metallic_roughness_texture", i32),
        ("normal_texture", i32),
        ("occlusion_texture", i32),
        ("emission_texture", i32),
    ],
    align=True,
)

LIGHT = np.dtype(
    [
        ("position", f32, 3),
        ("direction", f32, 3),  # unit, the way the light travels
        ("intensity", f32, 3),  # colour times candela, lux, or I_a
        ("inverse_range", f32),  # 0: no end
        ("cone_scale", f32),  # KHR_lights_punctual: 1 / (cos inner - cos outer)
        ("cone_offset", f32),  # -cos outer * cone_scale
        ("kind", i32),
        ("inverse_square", i32),
    ],
    align=True,
)

TEXTURE = np.dtype(
    [
        ("level", i64, MAX_TEXTURE_LEVELS),  # place in texels of each mipmap level
        ("widths", i64, MAX_TEXTURE_LEVELS),  # ripmap: how many texels the first k copies of a row are wide together
        ("heights", i64, MAX_TEXTURE_LEVELS),  # ripmap: how many texels the first k rows of copies are high together
        ("transform", f32, (2, 3)),  # texture from uv
        ("width", i32),
        ("height", i32),
        ("n_levels", i32),
        ("n_columns", i32),  # ripmap: copies of different width; 0: there are only mipmaps
        ("n_rows", i32),
        ("srgb", i32),
        ("wrap_u", i32),
        ("wrap_v", i32),
        ("filter", i32),
        ("uv_set", i32),
    ],
    align=True,
)

LIGHTING = np.dtype(
    [
        ("sky_present", i32),
        ("sky_visible", i32),  # 1: it is also what lies behind everything
        ("sky_width", i32),
        ("sky_height", i32),
        ("sky_intensity", f32),
        ("sky_cos", f32),  # of its turn about +y
        ("sky_sin", f32),
        ("irradiance", f32, (9, 3)),  # of the sky, as spherical harmonics of the normal
        ("emitted_power", f32),  # sum of weight times area over the emitters
    ],
    align=True,
)

EMITTER = np.dtype(
    [
        ("instance", i32),
        ("triangle", i32),
        ("cumulative", f32),  # share of the power up to and with this one
    ],
    align=True,
)


class Lighting(NamedTuple):
    """Light that comes from surfaces and from all around.

    Attributes
    ----------
    header : (1,) LIGHTING
    sky : (height, width, 3) float32
        Radiance by direction, equirectangular, row 0 at the bottom.
    sky_cumulative : (n,) float32
        For drawing directions by their radiance: height + 1 shares of the rows, then width + 1 within each row.
    emitters : (n,) EMITTER
    blurred : (n, width, 3) float32
        The sky as rough mirrors see it, level below level (`limner.shading.prefilter`); empty where nobody asks for it.
    """

    header: NDArray[np.void]
    sky: NDArray[np.float32]
    sky_cumulative: NDArray[np.float32]
    emitters: NDArray[np.void]
    blurred: NDArray[np.float32]


LIGHTING_ARRAYS = (Array(LIGHTING, 1), Array(np.float32, 3), Array(np.float32, 1), Array(EMITTER, 1), Array(np.float32, 3))
"""The door arguments that a Lighting unpacks to."""


class SceneTables(NamedTuple):
    """A scene as kernels read it.

    Attributes
    ----------
    instances : (n,) INSTANCE
        One for every visible shape: their rows are the instance ids.
    meshes : (n,) MESH_RANGES
    positions : (n, 3) float32
        Object space.
    triangles : (n, 3) int32
        Indices relative to their mesh.
    attributes : (n,) float32
        Normals, texture coordinates, colours, tangents.
    slots : (n,) int32
    materials : (n,) MATERIAL
    lights : (n,) LIGHT
    textures : (n,) TEXTURE
    texels : (n,) uint8
        RGBA, row 0 at the bottom, all levels of all textures.
    """

    instances: NDArray[np.void]
    meshes: NDArray[np.void]
    positions: NDArray[np.float32]
    triangles: NDArray[np.int32]
    attributes: NDArray[np.float32]
    slots: NDArray[np.int32]
    materials: NDArray[np.void]
    lights: NDArray[np.void]
    textures: NDArray[np.void]
    texels: NDArray[np.uint8]


SCENE_ARRAYS = (
    Array(INSTANCE, 1),
    Array(MESH_RANGES, 1),
    Array(np.float32, 2),
    Array(np.int32, 2),
    Array(np.float32, 1),
    Array(np.int32, 1),
    Array(MATERIAL, 1),
    Array(LIGHT, 1),
    Array(TEXTURE, 1),
    Array(np.uint8, 1),
)
"""The door arguments that a SceneTables unpacks to."""
