"""From the scene to the tables: the one step between what people write and what kernels read."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..linear.transform import normal_matrix
from ..mesh import primitives
from ..mesh.mesh import Mesh
from ..scene.camera import Camera, PerspectiveCamera
from ..scene.light import AmbientLight, DirectionalLight, Light, SpotLight
from ..scene.material import BlinnPhong, Lambert, Material, MetallicRoughness, ShadowCatcher
from ..scene.scene import Scene
from ..scene.shape import Box, Plane, Shape, Sphere
from ..scene.texture import Texture
from . import layouts
from .camera import camera_record, near_and_far, raster_from_world
from .layouts import SceneTables
from .textures import texture_tables

__all__ = ["Built", "View", "build", "flatten", "names", "view"]

_CHORD_ERROR = 0.1  # pixels between a sphere and its tessellation
_STAND_IN = "stand-in: "  # how the names of tessellations begin
_HORIZON = 1e5  # how far an infinite plane is drawn, in units of the distance that matters
_ALPHA_MODES = {"opaque": layouts.OPAQUE, "mask": layouts.MASK, "blend": layouts.BLEND}


class View(NamedTuple):
    """A camera with a picture size.

    Attributes
    ----------
    camera : (1,) CAMERA
    raster_from_object : (n, 4, 4) float32
        One for every instance: object space to (x w, y w, depth, w).
    """

    camera: NDArray[np.void]
    raster_from_object: NDArray[np.float32]


@np.errstate(over="ignore", invalid="ignore")
def view(scene: Scene, tables: SceneTables, camera: Camera, width: int, height: int) -> View:
    """The part of the tables that depends on the camera alone."""
    near, far = near_and_far(camera, scene.bounds())
    to_raster = raster_from_world(camera, width, height, near, far)
    places = np.array([placed.world_from_object for placed, _ in scene.shapes()]).reshape(-1, 4, 4)
    return View(camera_record(camera, width, height, near, far), (to_raster @ places).astype(np.float32))


def names(scene: Scene) -> dict[str, tuple[str, ...]]:
    """What the ids in the AOVs mean: the path of the node of each instance, the name of each material."""
    rows, _ = _material_rows(scene)
    return {
        "instance_id": tuple(placed.path for placed, _ in scene.shapes()),
        "material_id": tuple(material.name or type(material).__name__ for material in rows),
    }


class Built(NamedTuple):
    """Tables, and what they were made of: what a next build compares with, by identity.

    Attributes
    ----------
    tables : SceneTables
    meshes : tuple of Mesh
        In the order of their rows; kept alive, so that an identity means the same object.
    textures : tuple of Texture
    """

    tables: SceneTables
    meshes: tuple[Mesh, ...]
    textures: tuple[Texture, ...]


def build(scene: Scene, camera: Camera, width: int, height: int) -> SceneTables:
    """Flatten a scene, with nothing to compare with; see `flatten`."""
    return flatten(scene, camera, width, height).tables


@np.errstate(over="ignore", invalid="ignore")  # what float32 cannot hold becomes infinite, and is left out later
def flatten(
    scene: Scene, camera: Camera, width: int, height: int, previous: Built | None = None, *, tessellate: bool = True
) -> Built:
    """Flatten a scene.

    Parameters
    ----------
    scene : Scene
    camera : Camera
    width, height : int
        Decide how finely spheres are tessellated where triangles are needed: to a tenth of a pixel.
    previous : Built, optional
        What was built before. Meshes and textures that are the very same objects are not copied again; the tables do not depend
        on it.
    tessellate : bool
        Whether spheres and planes need triangles.
    """
    materials, first_material = _material_rows(scene)
    pixels_per_unit = _pixels_per_unit(camera, height)
    eye = np.asarray(camera.world_from_camera)[:3, 3]
    bounds = scene.bounds()
    shapes = scene.shapes()
    stand_ins = _StandIns(() if previous is None else previous.meshes)
    rows: dict[int, int] = {}
    meshes: list[Mesh] = []
    instances = np.zeros(len(shapes), dtype=layouts.INSTANCE)
    for row, (placed, shape) in zip(instances, shapes, strict=True):
        matrix = placed.world_from_object
        row["world_from_object"] = matrix[:3]
        row["object_from_world"] = _inverse(matrix)[:3]
        row["world_from_normal"] = _unit_scale(normal_matrix(matrix))
        row["flipped"] = np.linalg.det(matrix[:3, :3]) < 0.0
        row["material"] = first_material[_material_key(shape)]
        row["kind"], row["size"] = _kind_and_size(shape, matrix)
        row["mesh"] = -1
        if tessellate or row["kind"] in (layouts.MESH, layouts.BOX):
            mesh = _tessellation(shape, matrix, eye, camera, pixels_per_unit, bounds, stand_ins)
            if id(mesh) not in rows:
                rows[id(mesh)] = len(meshes)
                meshes.append(mesh)
            row["mesh"] = rows[id(mesh)]
    textures: dict[Texture, int] = {}
    material_table = _material_table(materials, textures)
    if previous is not None and _same(previous.meshes, meshes):
        geometry = previous.tables[1:6]
    else:
        geometry = _geometry_tables(meshes)
    if previous is not None and _same(previous.textures, tuple(textures)):
        texture_table, texels = previous.tables.textures, previous.tables.texels
    else:
        texture_table, texels = texture_tables(list(textures))
    tables = SceneTables(instances, *geometry, material_table, _light_table(scene), texture_table, texels)
    return Built(tables, tuple(meshes), tuple(textures))


def _same(before: tuple[object, ...], now: list[Mesh] | tuple[object, ...]) -> bool:
    return len(before) == len(now) and all(a is b for a, b in zip(before, now, strict=True))


class _StandIns:
    """Tessellations of exact shapes by what they are made from, so that the same question gets the same object again."""

    def __init__(self, before: tuple[Mesh, ...]) -> None:
        self._known = {mesh.name: mesh for mesh in before if mesh.name.startswith(_STAND_IN)}

    def get(self, make: Callable[..., Mesh], *arguments: object) -> Mesh:
        name = f"{_STAND_IN}{make.__name__}{arguments}"
        if name not in self._known:
            self._known[name] = dataclasses.replace(make(*arguments), name=name)
        return self._known[name]


# --- geometry -------------------------------------------------------------------------------------------------------------


def _geometry_tables(
    meshes: list[Mesh],
) -> tuple[NDArray[np.void], NDArray[np.float32], NDArray[np.int32], NDArray[np.float32], NDArray[np.int32]]:
    """MESH_RANGES, positions, triangles, attributes and slots of meshes one after the other."""
    positions, triangles = _Column(), _Column()
    attributes, slots = _Column(), _Column()

    def attribute(array: NDArray[np.float32] | None) -> int:
        return attributes.append(None if array is None else np.nan_to_num(array).reshape(-1))

    ranges = [
        (
            positions.append(mesh.positions),
            len(mesh.positions),
            triangles.append(mesh.triangles),
            len(mesh.triangles),
            attribute(mesh.normals),
            triangles.append(mesh.normal_triangles),
            attribute(mesh.uvs),
            triangles.append(mesh.uv_triangles),
            attribute(mesh.uvs1),
            attribute(_with_alpha(mesh.colors)),
            attribute(mesh.tangents),
            slots.append(mesh.triangle_materials),
        )
        for mesh in meshes
    ]
    return (
        np.array(ranges, dtype=layouts.MESH_RANGES).reshape(-1),
        _joined(positions.parts, np.float32, (0, 3)),
        _joined(triangles.parts, np.int32, (0, 3)),
        _joined(attributes.parts, np.float32, (0,)),
        _joined(slots.parts, np.int32, (0,)),
    )


class _Column:
    """Arrays that will stand one after the other."""

    def __init__(self) -> None:
        self.parts: list[NDArray[np.generic]] = []
        self._length = 0

    def append(self, array: NDArray[np.generic] | None) -> int:
        """Where the array begins; -1 for none."""
        if array is None:
            return -1
        start = self._length
        self.parts.append(array)
        self._length += len(array)
        return start


def _joined(parts: list[NDArray[np.generic]], dtype: type, empty: tuple[int, ...]) -> NDArray:  # type: ignore[type-arg]
    """One writeable contiguous array: a read-only one would be another type to a kernel."""
    return np.concatenate(parts).astype(dtype, copy=False) if parts else np.zeros(empty, dtype=dtype)


def _with_alpha(colors: NDArray[np.float32] | None) -> NDArray[np.float32] | None:
    if colors is None or colors.shape[1] == 4:
        return colors
    return np.concatenate([colors, np.ones((len(colors), 1), dtype=np.float32)], axis=1)


def _inverse(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """The inverse, or the pseudo-inverse of a transform that flattens."""
    try:
        return np.linalg.inv(matrix).astype(np.float64)
    except np.linalg.LinAlgError:
        return np.linalg.pinv(matrix).astype(np.float64)


def _unit_scale(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    largest = np.abs(matrix).max()
    return matrix / largest if largest > 0.0 else np.eye(3)


def _kind_and_size(shape: Shape, matrix: NDArray[np.float64]) -> tuple[int, tuple[float, float, float]]:
    geometry = shape.geometry
    if isinstance(geometry, (Sphere, Plane)) and _flattens(matrix):
        # No ray can be taken into its space and back: its tessellation takes its place.
        return layouts.MESH, (0.0, 0.0, 0.0)
    if isinstance(geometry, Sphere):
        return layouts.SPHERE, (geometry.radius, geometry.radius, geometry.radius)
    if isinstance(geometry, Box):
        x, y, z = geometry.size
        return layouts.BOX, (x / 2.0, y / 2.0, z / 2.0)
    if isinstance(geometry, Plane):
        return layouts.PLANE, (0.0, 0.0, 0.0)
    return layouts.MESH, (0.0, 0.0, 0.0)


def _flattens(matrix: NDArray[np.float64]) -> bool:
    """Whether a transform leaves next to nothing of some direction, as far as float32 can tell."""
    lengths = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return not lengths[-1] > 1e-6 * lengths[0]


def _pixels_per_unit(camera: Camera, height: int) -> float:
    """Pixels per unit of length, along the denser axis, at distance 1 (perspective) or anywhere (orthographic)."""
    half = camera.half_height() if isinstance(camera, PerspectiveCamera) else camera.height / 2.0
    return height / (2.0 * half * min(1.0, camera.pixel_aspect))


def _tessellation(
    shape: Shape,
    matrix: NDArray[np.float64],
    eye: NDArray[np.float64],
    camera: Camera,
    pixels_per_unit: float,
    bounds: NDArray[np.float64],
    stand_ins: _StandIns,
) -> Mesh:
    """The triangles that stand for a shape."""
    geometry = shape.geometry
    if isinstance(geometry, Mesh):
        return geometry
    if isinstance(geometry, Box):
        return stand_ins.get(primitives.box, geometry.size)
    if isinstance(geometry, Sphere):
        largest = float(np.linalg.norm(matrix[:3, :3], ord=2)) * geometry.radius
        distance = max(float(np.linalg.norm(matrix[:3, 3] - eye)) - largest, 0.01 * largest, 1e-30)
        radius = largest * pixels_per_unit / (distance if isinstance(camera, PerspectiveCamera) else 1.0)
        return stand_ins.get(primitives.sphere, geometry.radius, _sphere_bands(radius))
    return _plane_around(matrix, eye, bounds, stand_ins)


def _sphere_bands(radius_in_pixels: float) -> int:
    """Bands from pole to pole whose chords stay within a tenth of a pixel, r (1 - cos(pi/2n)) <= 1/10: a power of two.

    A camera that moves a little then finds the same sphere again.
    """
    ratio = min(_CHORD_ERROR / max(radius_in_pixels, 1e-9), 1.0)
    bands = math.pi / (2.0 * max(math.acos(1.0 - ratio), 1e-3))
    return int(min(max(2 ** math.ceil(math.log2(bands)), 8), 256))


def _plane_around(
    matrix: NDArray[np.float64], eye: NDArray[np.float64], bounds: NDArray[np.float64], stand_ins: _StandIns
) -> Mesh:
    """The infinite plane as rings around the point below the eye, as far as the horizon needs."""
    local = _inverse(matrix) @ np.append(eye, 1.0)
    height = abs(float(local[1]))
    extent = float(np.linalg.norm(bounds[1] - bounds[0])) if np.isfinite(bounds).all() else 1.0
    reach = max(height, extent, 1e-6)
    foot = (float(local[0]), float(local[2]))
    return stand_ins.get(primitives.plane_disk, foot, max(0.25 * height, 1e-4 * reach), _HORIZON * reach, 48)


# --- materials ------------------------------------------------------------------------------------------------------------


def _material_key(shape: Shape) -> tuple[int, ...]:
    return tuple(id(material) for material in shape.materials)


def _material_rows(scene: Scene) -> tuple[list[Material], dict[tuple[int, ...], int]]:
    """Materials in the order of their first use, those of one shape side by side, and where each such group begins."""
    rows: list[Material] = []
    first: dict[tuple[int, ...], int] = {}
    for _, shape in scene.shapes():
        key = _material_key(shape)
        if key not in first:
            first[key] = len(rows)
            rows.extend(shape.materials)
    return rows, first


def _material_table(materials: list[Material], textures: dict[Texture, int]) -> NDArray[np.void]:
    table = np.zeros(len(materials), dtype=layouts.MATERIAL)
    for row, material in zip(table, materials, strict=True):
        row["alpha"], row["alpha_cutoff"] = material.alpha, material.alpha_cutoff
        row["alpha_mode"] = _ALPHA_MODES[material.alpha_mode]
        row["double_sided"], row["emission"] = material.double_sided, material.emission
        row["emission_weight"] = _emission_weight(material)
        row["specular_scale"] = row["normal_scale"] = row["roughness"] = row["exponent"] = 1.0
        for field in layouts.MATERIAL.names or ():
            if field.endswith("_texture"):
                row[field] = -1
        _FILL[type(material)](row, material, textures)
    return table


def _emission_weight(material: Material) -> float:
    """The luminance of what a material gives off, its texture averaged: how often a path tracer asks it for light."""
    weight = float(np.dot(material.emission, (0.2126, 0.7152, 0.0722)))
    texture = material.emissive_texture if isinstance(material, MetallicRoughness) else None
    if weight > 0.0 and texture is not None:
        pixels = texture.texels.pixels
        few = pixels[:: max(1, pixels.shape[0] // 64), :: max(1, pixels.shape[1] // 64), :3] / 255.0
        weight *= max(float((few**2.2).mean()), 1e-3)
    return weight


def _row(texture: Texture | None, textures: dict[Texture, int]) -> int:
    return -1 if texture is None else textures.setdefault(texture, len(textures))


def _fill_lambert(row: np.void, material: Lambert, textures: dict[Texture, int]) -> None:
    row["kind"], row["color"], row["ambient"] = layouts.LAMBERT, material.color, (-1.0, -1.0, -1.0)
    row["color_texture"] = _row(material.texture, textures)


def _fill_blinn_phong(row: np.void, material: BlinnPhong, textures: dict[Texture, int]) -> None:
    row["kind"], row["color"], row["specular"] = layouts.BLINN_PHONG, material.diffuse, material.specular
    row["exponent"], row["mirror"] = material.exponent, material.mirror
    row["highlight"] = layouts.PHONG if material.highlight == "phong" else layouts.BLINN
    row["ambient"] = (-1.0, -1.0, -1.0) if material.ambient is None else material.ambient
    row["specular_scale"] = _highlight_scale(material) if material.normalized else 1.0
    row["color_texture"] = _row(material.diffuse_texture, textures)
    row["specular_texture"] = _row(material.specular_texture, textures)


def _highlight_scale(material: BlinnPhong) -> float:
    """What makes the highlight's energy independent of its exponent: one over its integral, seen from straight above."""
    return (material.exponent + 2.0) / 8.0 if material.highlight == "blinn" else (material.exponent + 1.0) / 2.0


def _fill_metallic_roughness(row: np.void, material: MetallicRoughness, textures: dict[Texture, int]) -> None:
    row["kind"], row["color"], row["ambient"] = layouts.METALLIC_ROUGHNESS, material.base_color, (-1.0, -1.0, -1.0)
    row["metallic"], row["roughness"], row["unlit"] = material.metallic, material.roughness, material.unlit
    row["normal_scale"], row["occlusion_strength"] = material.normal_scale, material.occlusion_strength
    row["color_texture"] = _row(material.base_color_texture, textures)
    row["metallic_roughness_texture"] = _row(material.metallic_roughness_texture, textures)
    row["normal_texture"] = _row(material.normal_texture, textures)
    row["occlusion_texture"] = _row(material.occlusion_texture, textures)
    row["emission_texture"] = _row(material.emissive_texture, textures)


def _fill_shadow_catcher(row: np.void, material: ShadowCatcher, textures: dict[Texture, int]) -> None:
    row["kind"], row["color"] = layouts.SHADOW_CATCHER, material.color


_FILL: dict[type, Callable[..., None]] = {
    Lambert: _fill_lambert,
    BlinnPhong: _fill_blinn_phong,
    MetallicRoughness: _fill_metallic_roughness,
    ShadowCatcher: _fill_shadow_catcher,
}


# --- lights ---------------------------------------------------------------------------------------------------------------


def _light_table(scene: Scene) -> NDArray[np.void]:
    lights = scene.lights()
    table = np.zeros(len(lights), dtype=layouts.LIGHT)
    for row, (placed, light) in zip(table, lights, strict=True):
        row["position"] = placed.world_from_object[:3, 3]
        axis = -placed.world_from_object[:3, 2]
        row["direction"] = axis / (np.linalg.norm(axis) or 1.0)
        row["intensity"] = np.array(light.color) * light.intensity
        _fill_light(row, light)
    return table


def _fill_light(row: np.void, light: Light) -> None:
    if isinstance(light, AmbientLight):
        row["kind"] = layouts.AMBIENT_LIGHT
    elif isinstance(light, DirectionalLight):
        row["kind"] = layouts.DIRECTIONAL_LIGHT
    else:
        row["kind"] = layouts.POINT_LIGHT
        row["inverse_square"] = light.falloff == "inverse_square"
        row["inverse_range"] = 1.0 / light.range if light.range is not None else 0.0
        if isinstance(light, SpotLight):
            row["kind"] = layouts.SPOT_LIGHT
            inner, outer = math.cos(math.radians(light.inner_degrees)), math.cos(math.radians(light.outer_degrees))
            row["cone_scale"] = 1.0 / max(1e-3, inner - outer)
            row["cone_offset"] = -outer * float(row["cone_scale"])
