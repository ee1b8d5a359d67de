"""Every dtype and kind number that kernels see: one page, the contract between the scene and the kernels.

A family (instances, meshes, materials, lights, textures) is one record array; bulk numbers are plain C-contiguous arrays. An
index of -1 refers to nothing. Numbers in records are float32 and int32 unless they count bytes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array

__all__ = ["INSTANTS_ARRAYS", "LIGHTING_ARRAYS", "SCENE_ARRAYS", "Instants", "Lighting", "SceneTables"]

f32, i32, i64 = np.float32, np.int32, np.int64

# Kinds of geometry; what each means by size and place: limner.intersect.layouts
MESH, SPHERE, PLANE, BOX = 0, 1, 2, 3
DISK, CYLINDER, CONE, TORUS, QUADRIC, PATCH, CSG, DISTANCE_FIELD = 4, 5, 6, 7, 8, 9, 10, 11

# Operations of a combination of solids: on the two sets before it, or, the last one, on one
UNION, INTERSECTION, DIFFERENCE, COMPLEMENT = -1, -2, -3, -4

MAX_LEAVES = 62  # of one combination: as many as an int64 has bits to tell which of them a point is in, and some to spare

# Kinds of material
LAMBERT, BLINN_PHONG, METALLIC_ROUGHNESS, SHADOW_CATCHER, DIELECTRIC, COOL_TO_WARM = 0, 1, 2, 3, 4, 5

# What a material has beyond a matte base under microfacets: bits of its `layers`
SPECULAR_LAYER, COAT, SHEEN, ANISOTROPY, FILM, COMPENSATED = 1, 2, 4, 8, 16, 32
CONDUCTOR, ROUGH_MATTE, SHEET, BEHIND = 64, 128, 256, 512
VOLUME = 1024  # what it lets through fills a closed shape: a row of media
SOLID = 2048  # no coverage by alpha, though light goes through
MATTE_ONLY = 4096  # of lobes: the microfacets are somebody else's affair
FAR_SIDE = 8192  # of lobes: they are those of the side that is not seen

# How much a dielectric reflects
EXACT, SCHLICK = 0, 1

# Kinds of highlight
BLINN, PHONG = 0, 1

# Kinds of light
POINT_LIGHT, DIRECTIONAL_LIGHT, SPOT_LIGHT, AMBIENT_LIGHT, RECTANGLE_LIGHT, DISK_LIGHT, SPHERE_LIGHT = 0, 1, 2, 3, 4, 5, 6

# How a surface's alpha is used
OPAQUE, MASK, BLEND = 0, 1, 2

# What lies outside a texture
REPEAT, MIRROR, CLAMP = 0, 1, 2

# How texels are combined
NEAREST, BILINEAR, TRILINEAR, ANISOTROPIC, RIPMAP = 0, 1, 2, 3, 4

# What a texture is made of
PICTURE, CHECKER, STRIPES, GRADIENT, NOISE, TURBULENCE, MARBLE, WOOD = 0, 1, 2, 3, 4, 5, 6, 7

# How a place on a surface becomes one in a texture
UV_MAPPING, OBJECT_MAPPING, TRIPLANAR_MAPPING = 0, 1, 2

# How the channels of a texel are kept: 1, 2 or 4 bytes each
BYTE_TEXELS, WORD_TEXELS, FLOAT_TEXELS = 0, 1, 2

# Kinds of projection
PERSPECTIVE, ORTHOGRAPHIC = 0, 1

MAX_TEXTURE_LEVELS = 16

# Colours of a procedural texture's ramp
MAX_STOPS = 8

# Dielectric materials of a scene: as many as a byte counts, less one for what is outside of all
MAX_MEDIA = 255

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
        ("aperture_radius", f32),  # 0: a pinhole
        ("focus_distance", f32),
        ("blades", i32),  # corners of the opening; 0: it is round
    ],
    align=True,
)

INSTANCE = np.dtype(
    [
        ("world_from_object", f32, (3, 4)),
        ("object_from_world", f32, (3, 4)),
        ("world_from_normal", f32, (3, 3)),
        ("size", f32, 3),  # sphere: radius in [0]; box: half edges; the others: limner.intersect.layouts
        ("kind", i32),
        ("mesh", i32),  # what is drawn as triangles: for an exact shape its tessellation; -1: none
        ("material", i32),  # first of its materials
        ("flipped", i32),  # 1: the transform reflects, so that clockwise is outside
        ("owner", i32),  # its own row; of a leaf of a combination, the row of that
        ("capped", i32),  # 0: a cylinder, cone or quadric without caps
        ("place", i32),  # quadric, patch, distance field: of its numbers in attributes; combination: of its program in slots; else -1
        ("n_program", i32),  # of a combination
        ("leaf", i32),  # row of the first of its leaves, which follow each other
        ("n_leaves", i32),
        ("checksum", i32),  # of what stands at its place: equal rows are equal shapes
        ("lamp", i32),  # 1 + row of the light whose surface it is; 0: of none
        ("detailed", i32),  # 1: a material of it asks where on the object it is: solid and tri-planar textures, bump maps
        ("key", i32),  # of a mesh that bends while the shutter is open, 1 + the number of the key that is past; the next one's row of
        # meshes follows `mesh`; 0: it does not bend
        ("share", f32),  # of the way from the key that is past to the next one
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
        ("mirror_blur", f32),  # width of the square over which reflected rays are scattered
        ("emission", f32, 3),
        ("emission_weight", f32),  # luminance of the emission, texture averaged: how often its triangles are drawn
        ("metallic", f32),
        ("roughness", f32),
        ("normal_scale", f32),
        ("bump_scale", f32),  # height where the bump texture is 1, in the object's own units
        ("occlusion_strength", f32),
        ("alpha_cutoff", f32),
        ("kind", i32),
        ("alpha_mode", i32),
        ("double_sided", i32),
        ("unlit", i32),
        ("medium", i32),  # dielectric, or what has a volume: what is behind its surface, a row of media; 0 for all others
        ("layers", i32),  # bits: what it has of what follows here
        ("dielectric_f0", f32),  # what its part that is no metal reflects, seen straight on
        ("specular_factor", f32),
        ("coat", f32),
        ("coat_roughness", f32),
        ("coat_normal_scale", f32),
        ("sheen", f32, 3),
        ("sheen_roughness", f32),
        ("anisotropy", f32),
        ("anisotropy_direction", f32, 2),  # cosine and sine of its turn from the tangent
        ("film", f32),
        ("film_ior", f32),
        ("film_thickness", f32, 2),  # in nanometres, where the texture is 0 and where it is 1
        ("transmission", f32),
        ("behind", f32),  # share of the scattered light that goes through
        ("behind_color", f32, 3),
        ("eta", f32, 3),  # a conductor's complex index of refraction, by channel: eta - i k
        ("k", f32, 3),
        ("matte_roughness", f32),  # Oren and Nayar's sigma, in radians
        ("fresnel", i32),  # EXACT or SCHLICK
        ("cool", f32, 3),
        ("towards", f32, 3),  # unit, the light of cool-to-warm shading
        ("color_texture", i32),
        ("specular_texture", i32),
        ("metallic_roughness_texture", i32),
        ("normal_texture", i32),
        ("occlusion_texture", i32),
        ("emission_texture", i32),
        ("bump_texture", i32),
        ("alpha_texture", i32),
        ("alpha_channel", i32),  # of it: 0 to 3 for R, G, B and alpha
        ("specular_factor_texture", i32),
        ("coat_texture", i32),
        ("coat_roughness_texture", i32),
        ("coat_normal_texture", i32),
        ("sheen_texture", i32),
        ("sheen_roughness_texture", i32),
        ("anisotropy_texture", i32),
        ("film_texture", i32),
        ("film_thickness_texture", i32),
        ("transmission_texture", i32),
        ("behind_texture", i32),
        ("behind_color_texture", i32),
        ("no_layers", i32),  # nothing but its name, by which doors are told apart
    ],
    align=True,
)

LAYERED_MATERIAL = np.dtype([(name.replace("no_layers", "has_layers"), *kind) for name, *kind in MATERIAL.descr], align=True)
"""The same bytes, as doors take them that know layers: see `limner.shading.layer_row`."""

MATTE_MATERIAL = np.dtype([(name.replace("no_layers", "only_matte"), *kind) for name, *kind in MATERIAL.descr], align=True)
"""The same bytes, as doors take them that know nothing but matte surfaces: see `limner.shading.matte_row`."""

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
        ("axis_u", f32, 3),  # an area light's: half edges of the rectangle; radii, at right angles, of disk and sphere
        ("axis_v", f32, 3),
        ("area", f32),
        ("visible", i32),  # 1: it has a surface that rays can meet
    ],
    align=True,
)

MEDIUM = np.dtype(
    [
        ("attenuation", f32, 3),  # per metre
        ("haze", f32, 3),  # radiance of a thick layer
        ("ior", f32),
        ("dispersion", f32),  # half of how much greater its index is for blue than for red
        ("priority", i32),
    ],
    align=True,
)
"""What may lie between surfaces; row 0 is what is outside of all dielectrics."""

TEXTURE = np.dtype(
    [
        ("level", i64, MAX_TEXTURE_LEVELS),  # place in texels, in bytes, of each mipmap level
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
        ("kind", i32),  # PICTURE, or which pattern
        ("format", i32),  # BYTE_TEXELS, WORD_TEXELS or FLOAT_TEXELS
        ("mapping", i32),
        ("seldom", i32),  # 0: a picture of bytes on texture coordinates, looked up in no more than two mipmap levels
        ("bump_step", f32, 2),  # how far apart heights tell of a slope: along u and v, or in object space
        ("sharpness", f32),  # tri-planar: the power of the normal by which the three lookups are weighted
        ("pattern_from_place", f32, (3, 4)),  # pattern: from object space, or from (u, v, 0)
        ("octaves", i32),
        ("seed", i32),
        ("gain", f32),
        ("lacunarity", f32),
        ("amount", f32),  # marble, wood: how far noise moves the pattern; stripes: the share of the last colour
        ("n_stops", i32),
        ("stop", f32, MAX_STOPS),  # where on the ramp each colour is
        ("stop_rise", f32, MAX_STOPS),  # one over the way from the stop before
        ("stop_color", f32, (MAX_STOPS, 4)),
    ],
    align=True,
)

LIGHTING = np.dtype(
    [
        ("sky_present", i32),
        ("sky_visible", i32),  # 1: it is also what lies behind everything
        ("sky_even", i32),  # 1: of one radiance all around
        ("sky_width", i32),
        ("sky_height", i32),
        ("sky_intensity", f32),
        ("sky_cos", f32),  # of its turn about +y
        ("sky_sin", f32),
        ("irradiance", f32, (9, 3)),  # of the sky, as spherical harmonics of the normal
        ("emitted_power", f32),  # sum of weight times area over the emitters
        ("light_tree", i32),  # 1: emitters are drawn by the tree in their rows; 0: by their power
    ],
    align=True,
)

NODE_NUMBERS = 9
"""What a node of the tree of emitters is: `limner.tables.light_tree`."""

EMITTER = np.dtype(
    [
        ("instance", i32),
        ("triangle", i32),
        ("cumulative", f32),  # share of the power up to and with this one
        ("corner", f32, 3),  # world space, when the shutter opens
        ("edge_u", f32, 3),
        ("edge_v", f32, 3),
        ("normal", f32, 3),  # unit
        ("radiance", f32, 3),
        ("weight", f32),  # of its material
        ("double_sided", i32),
        ("plain", i32),  # 1: it stands still and shines alike everywhere, so that this row says all
        ("area", f32),
        ("nodes", f32, (2, NODE_NUMBERS)),  # of the tree of n emitters: of row k, node k and leaf n + k
        ("key_instance", i32),  # of all emitters by instance and triangle, the one that comes k-th: whose it is, and its row
        ("key_triangle", i32),
        ("key_row", i32),
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
        One for every visible shape: their rows are the instance ids. Then, where rays need them, the leaves of combinations of solids,
        which are seen through these alone.
    meshes : (n,) MESH_RANGES
    positions : (n, 3) float32
        Object space.
    triangles : (n, 3) int32
        Indices relative to their mesh.
    attributes : (n,) float32
        Normals, texture coordinates, colours, tangents; after those of all meshes, numbers of quadrics, patches and distance fields.
    slots : (n,) int32
        Which of its instance's materials a triangle has; after those of all meshes, programs of combinations of solids.
    materials : (n,) MATERIAL
    lights : (n,) LIGHT
    textures : (n,) TEXTURE
    texels : (n,) uint8
        RGBA of 1, 2 or 4 bytes a channel, row 0 at the bottom, all levels of all textures.
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


class Instants(NamedTuple):
    """Where what moves is at each of k instants, evenly through the shutter's time.

    Attributes
    ----------
    instances : (k * m,) INSTANCE
        The m rows of what moves, instant after instant.
    moving : (m,) int32
        Which rows of the scene's instances these are.
    cameras : (k,) CAMERA
        None, where nothing moves.
    """

    instances: NDArray[np.void]
    moving: NDArray[np.int32]
    cameras: NDArray[np.void]


INSTANTS_ARRAYS = (Array(INSTANCE, 1), Array(np.int32, 1), Array(CAMERA, 1))
"""The door arguments that an Instants unpacks to."""
