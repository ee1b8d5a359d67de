"""From the scene to the tables: the one step between what people write and what kernels read."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from ..errors import UnsupportedError
from ..linear.transform import normal_matrix
from ..mesh.mesh import Mesh
from ..scene.camera import Camera
from ..scene.lamp import LampShape, light_frame
from ..scene.light import AmbientLight, AreaLight, DirectionalLight, PointLight, RectangleLight, SphereLight, SpotLight
from ..scene.material import BlinnPhong, CoolToWarm, Dielectric, Lambert, Material, MetallicRoughness, ShadowCatcher
from ..scene.material_extensions import Part
from ..scene.scene import Scene
from ..scene.shape import Box, Combination, Shape
from ..scene.texture import AnyTexture
from . import layouts
from .camera import camera_record, near_and_far, raster_from_world
from .exact import Numbers, fill_shape, leaves_and_program, materials_of
from .frames import framed_alike, with_frames
from .layers import attenuation_of, dielectric_f0, dispersion_of, fill_layers, fill_rough_matte, fills_shape
from .layouts import SceneTables
from .relief import Reliefs
from .stand_ins import Sight, StandIns, flattens, inverse, tessellation
from .textures import asks_for_detail, mean_color, texture_tables

__all__ = ["Built", "View", "build", "flatten", "media_table", "names", "view"]

_ROWS_AT_ONCE = 1 << 13
_INFINITE_IOR = 1e6  # reflects all but a few millionths
_ALPHA_MODES = {"opaque": layouts.OPAQUE, "mask": layouts.MASK, "blend": layouts.BLEND}


_Geometry = tuple[NDArray[np.void], NDArray[np.float32], NDArray[np.int32], NDArray[np.float32], NDArray[np.int32]]


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
def view(scene: Scene, tables: SceneTables, camera: Camera, width: int, height: int, time: float = 0.0) -> View:
    """The part of the tables that depends on the camera alone, at a time."""
    camera = camera.standing(time)
    near, far = near_and_far(camera, scene.bounds())
    to_raster = raster_from_world(camera, width, height, near, far)
    shapes = scene.shapes(time)
    raster_from_object = np.empty((len(shapes), 4, 4), dtype=np.float32)
    for part in _parts(len(shapes)):
        raster_from_object[part] = to_raster @ _matrices([placed.world_from_object for placed, _ in shapes[part]])
    return View(camera_record(camera, width, height, near, far), raster_from_object)


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
    geometry : tuple
        MESH_RANGES, positions, triangles, attributes and slots of the meshes alone.
    stand_ins : StandIns
    reliefs : Reliefs
    notes : tuple of str
        What could not be made as it was asked for.
    is_for_all : bool
        Whether every camera would have got the same: nothing is cut to a pixel's size, and nothing is lit from where it stands.
    n_keys : mapping of int to int
        Of the rows of meshes that bend while the shutter is open, how many keys they have; the others' rows follow the first one's.
    """

    tables: SceneTables
    meshes: tuple[Mesh, ...]
    textures: tuple[AnyTexture, ...]
    geometry: _Geometry
    stand_ins: StandIns
    reliefs: Reliefs
    notes: tuple[str, ...]
    is_for_all: bool
    n_keys: Mapping[int, int]


def build(scene: Scene, camera: Camera, width: int, height: int) -> SceneTables:
    """Flatten a scene, with nothing to compare with; see `flatten`."""
    return flatten(scene, camera, width, height).tables


@np.errstate(over="ignore", invalid="ignore")  # what float32 cannot hold becomes infinite, and is left out later
def flatten(
    scene: Scene, camera: Camera, width: int, height: int, previous: Built | None = None, *, tessellate: bool = True, time: float = 0.0,
    bent: Mapping[Mesh, tuple[Mesh, ...]] | None = None,
) -> Built:
    """Flatten a scene.

    Parameters
    ----------
    scene : Scene
    camera : Camera
    width, height : int
        Decide how finely round shapes are tessellated where triangles are needed: to a tenth of a pixel.
    previous : Built, optional
        What was built before. Meshes and textures that are the very same objects are not copied again; the tables do not depend
        on it.
    tessellate : bool
        Whether exact shapes need triangles, as the rasteriser does. Combinations of solids then are nothing else; otherwise they have
        leaves, which rays need.
    time : float
        When to look at what moves.
    bent : mapping of Mesh to tuple of Mesh, optional
        What meshes of the scene turn into until the shutter closes: `limner.scene.bending.bent_meshes`.
    """
    materials, first_material = _material_rows(scene)
    shapes = scene.shapes(time)
    sight = Sight(camera.standing(time), width, height, scene.bounds())
    stand_ins = StandIns(None if previous is None else previous.stand_ins)
    reliefs = Reliefs(None if previous is None else previous.reliefs)
    meshes = _Meshes(bent or {})
    numbers, programs = Numbers(), Numbers()
    instances = np.zeros(len(shapes), dtype=layouts.INSTANCE)
    for part in _parts(len(shapes)):
        _place(instances[part], _matrices([placed.world_from_object for placed, _ in shapes[part]]))
    instances["owner"] = np.arange(len(shapes))
    instances["material"] = [first_material[id(shape)] for _, shape in shapes]
    leaves: list[NDArray[np.void]] = []
    plain: dict[int, int] = {}
    for k, (placed, shape) in enumerate(shapes):
        if id(shape) in plain:
            # What a scene may have a hundred thousand of.
            continue
        row = instances[k]
        if isinstance(shape, LampShape):
            row["lamp"] = shape.light + 1
        if isinstance(shape.geometry, Mesh) and shape.displacement is None:
            row["mesh"] = meshes.row(shape, shape.geometry)
            if not isinstance(shape, LampShape):
                plain[id(shape)] = int(row["mesh"])
            continue
        matrix = placed.world_from_object
        if shape.displacement is not None:
            pass  # what is moved is a mesh
        elif isinstance(shape.geometry, Combination):
            if not tessellate and not flattens(matrix):
                first = len(instances) + sum(map(len, leaves))
                leaves.append(_combine(row, shape, matrix, first, numbers, programs))
        elif isinstance(shape.geometry, Box) or not flattens(matrix):
            fill_shape(row, shape.geometry, numbers)
        # What is left a mesh is one, or no ray can be taken into its space and back.
        if tessellate or row["kind"] in (layouts.MESH, layouts.BOX):
            mesh = tessellation(shape, matrix, sight, stand_ins)
            if shape.displacement is not None:
                mesh = reliefs.get(shape, mesh, matrix, inverse(matrix), sight, placed.path)
            row["mesh"] = meshes.row(shape, mesh)
    instances["mesh"] = [plain.get(id(shape), mesh) for (_, shape), mesh in zip(shapes, instances["mesh"].tolist(), strict=True)]
    instances = np.concatenate([instances, *leaves]) if leaves else instances
    detailed = {id(shape): any(map(_is_detailed, materials_of(shape))) for shape in {id(shape): shape for _, shape in shapes}.values()}
    instances["detailed"] = np.array([detailed[id(shape)] for _, shape in shapes], dtype=np.int32)[instances["owner"]]
    textures: dict[AnyTexture, int] = {}
    material_table = _material_table(materials, textures, camera.place(time))
    for row in instances[instances["lamp"] > 0]:
        # Asked as a light, not as a shining surface.
        material_table[row["material"]]["emission_weight"] = 0.0
    reused = previous is not None and _same(previous.meshes, meshes.found)
    geometry = previous.geometry if previous is not None and reused else _geometry_tables(meshes.found)
    ranges, positions, triangles, attributes, slots = geometry
    _shift_places(instances, len(attributes), len(slots))
    if previous is not None and _same(previous.textures, tuple(textures)):
        texture_table, texels = previous.tables.textures, previous.tables.texels
    else:
        texture_table, texels = texture_tables(list(textures))
    tables = SceneTables(
        instances, ranges, positions, triangles, numbers.behind(attributes), programs.behind(slots), material_table,
        _light_table(scene, time), texture_table, texels,
    )  # fmt: skip
    is_for_all = stand_ins.is_empty and reliefs.is_empty and not any(isinstance(material, CoolToWarm) for material in materials)
    return Built(tables, tuple(meshes.found), tuple(textures), geometry, stand_ins, reliefs, reliefs.notes, is_for_all, meshes.n_keys)


class _Meshes:
    """The meshes of a scene in the order of their first use."""

    def __init__(self, bent: Mapping[Mesh, tuple[Mesh, ...]]) -> None:
        self.found: list[Mesh] = []
        self.n_keys: dict[int, int] = {}
        self._bent = bent
        self._rows: dict[int, int] = {}
        self._of_shapes: dict[tuple[int, int], int] = {}

    def row(self, shape: Shape, mesh: Mesh) -> int:
        """Where the mesh stands that shows a shape: the given one, with tangents where a material asks for them."""
        key = id(shape), id(mesh)
        if key not in self._of_shapes:
            framed = with_frames(mesh, materials_of(shape))
            if id(framed) not in self._rows:
                self._rows[id(framed)] = len(self.found)
                self.found.append(framed)
                later = self._bent.get(mesh, ())
                if later:
                    self.n_keys[self._rows[id(framed)]] = 1 + len(later)
                    self.found.extend(framed_alike(key, framed, mesh, materials_of(shape)) for key in later)
            self._of_shapes[key] = self._rows[id(framed)]
        return self._of_shapes[key]


def _parts(n: int) -> Iterator[slice]:
    """Some thousand rows of n after the other: float64 matrices of all at once would take more room than what is made of them."""
    return (slice(start, start + _ROWS_AT_ONCE) for start in range(0, n, _ROWS_AT_ONCE))


def _matrices(places: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    return np.array(places, dtype=np.float64).reshape(-1, 4, 4)


def _place(rows: NDArray[np.void], matrices: NDArray[np.float64]) -> None:
    """Fill what instances have of their places, (n, 4, 4); they are meshes until something else is said."""
    rows["world_from_object"] = matrices[:, :3]
    rows["object_from_world"] = _inverses(matrices)[:, :3]
    rows["world_from_normal"] = _unit_scale(normal_matrix(matrices))
    rows["flipped"] = np.linalg.det(matrices[:, :3, :3]) < 0.0
    rows["kind"], rows["mesh"], rows["place"] = layouts.MESH, -1, -1


def _inverses(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    try:
        return np.linalg.inv(matrices).astype(np.float64)
    except np.linalg.LinAlgError:
        return _matrices([inverse(matrix) for matrix in matrices])


def _combine(
    row: np.void, shape: Shape, matrix: NDArray[np.float64], first: int, numbers: Numbers, programs: Numbers
) -> NDArray[np.void]:
    """Make an instance a combination of solids, and return its leaves, whose rows begin at `first`."""
    assert isinstance(shape.geometry, Combination)
    parts, program = leaves_and_program(shape.geometry)
    group = [id(material) for material in materials_of(shape)]
    leaves = np.zeros(len(parts), dtype=layouts.INSTANCE)
    _place(leaves, _matrices([matrix @ part.combination_from_leaf for part in parts]))
    leaves["owner"] = row["owner"]
    for leaf, part in zip(leaves, parts, strict=True):
        material = shape.materials[0] if part.material is None else part.material
        leaf["material"] = int(row["material"]) + group.index(id(material))
        fill_shape(leaf, part.geometry, numbers)
    programs.put(row, program)
    row["kind"], row["leaf"], row["n_leaves"], row["n_program"] = layouts.CSG, first, len(leaves), len(program)
    return leaves


def _shift_places(instances: NDArray[np.void], n_attributes: int, n_slots: int) -> None:
    """Count places of numbers and programs from the beginning of the arrays that they stand in, behind what meshes have there."""
    kinds = instances["kind"]
    instances["place"][np.isin(kinds, (layouts.QUADRIC, layouts.PATCH, layouts.DISTANCE_FIELD))] += n_attributes
    instances["place"][kinds == layouts.CSG] += n_slots


def _same(before: tuple[object, ...], now: list[Mesh] | tuple[object, ...]) -> bool:
    return len(before) == len(now) and all(a is b for a, b in zip(before, now, strict=True))


# --- geometry -------------------------------------------------------------------------------------------------------------


def _geometry_tables(meshes: list[Mesh]) -> _Geometry:
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


def _unit_scale(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, 3, 3): each by its greatest number; the identity where all are 0."""
    largest = np.abs(matrices).max(axis=(1, 2), keepdims=True)
    made: NDArray[np.float64] = np.where(largest > 0.0, matrices / np.where(largest > 0.0, largest, 1.0), np.eye(3))
    return made


# --- materials ------------------------------------------------------------------------------------------------------------


def _material_rows(scene: Scene) -> tuple[list[Material], dict[int, int]]:
    """Materials in the order of their first use, those of one shape side by side, and where each shape's begin, by its identity."""
    rows: list[Material] = []
    first: dict[tuple[int, ...], int] = {}
    of_shapes: dict[int, int] = {}
    for _, shape in scene.shapes():
        if id(shape) not in of_shapes:
            key = tuple(id(material) for material in materials_of(shape))
            if key not in first:
                first[key] = len(rows)
                rows.extend(materials_of(shape))
            of_shapes[id(shape)] = first[key]
    return rows, of_shapes


def _material_table(materials: list[Material], textures: dict[AnyTexture, int], eye: NDArray[np.float64]) -> NDArray[np.void]:
    table = np.zeros(len(materials), dtype=layouts.MATERIAL)
    filling = [fills_shape(material) for material in materials]
    if sum(filling) > layouts.MAX_MEDIA:
        raise UnsupportedError(f"a scene must not have more than {layouts.MAX_MEDIA} dielectric materials, got {sum(filling)}")
    for row, material in zip(table, materials, strict=True):
        row["alpha"], row["alpha_cutoff"] = material.alpha, material.alpha_cutoff
        row["alpha_mode"] = _ALPHA_MODES[material.alpha_mode]
        row["double_sided"], row["emission"] = material.double_sided, material.emission
        row["emission_weight"] = _emission_weight(material)
        row["specular_scale"] = row["normal_scale"] = row["roughness"] = row["exponent"] = row["specular_factor"] = 1.0
        for field in layouts.MATERIAL.names or ():
            if field.endswith("_texture"):
                row[field] = -1
        _FILL[type(material)](row, material, textures)
        _fill_relief(row, material, textures)
        if isinstance(material, CoolToWarm):
            row["towards"] = _towards(material, eye)
    table["medium"][filling] = np.arange(1, sum(filling) + 1)
    return table


def _towards(material: CoolToWarm, eye: NDArray[np.float64]) -> NDArray[np.float64]:
    """The unit vector to the light by which a surface is warm or cool: by itself, at right angles to the gaze, from the upper left."""
    given = eye[:3, 1] - eye[:3, 0] if material.towards is None else np.array(material.towards)
    return np.asarray(given / np.linalg.norm(given))


def media_table(scene: Scene) -> NDArray[np.void]:
    """(1 + n,) MEDIUM: what is outside, fog or clear air, and what fills each material's shapes in the order of the material rows."""
    filling = [material for material in _material_rows(scene)[0] if fills_shape(material)]
    table = np.zeros(1 + len(filling), dtype=layouts.MEDIUM)
    table[0]["ior"], table[0]["priority"] = 1.0, np.iinfo(np.int32).min
    if scene.fog is not None:
        table[0]["attenuation"], table[0]["haze"] = scene.fog.density, scene.fog.color
    for row, material in zip(table[1:], filling, strict=True):
        if isinstance(material, MetallicRoughness):
            row["ior"], row["dispersion"] = material.ior or _INFINITE_IOR, dispersion_of(material)
            row["attenuation"] = attenuation_of(material)
        elif isinstance(material, Dielectric):
            row["ior"], row["priority"] = material.ior, material.priority
            row["attenuation"], row["haze"] = material.absorption, material.haze
    return table


def _emission_weight(material: Material) -> float:
    """The luminance of what a material gives off, its texture averaged: how often a path tracer asks it for light."""
    weight = float(np.dot(material.emission, (0.2126, 0.7152, 0.0722)))
    texture = getattr(material, "emissive_texture", None) or getattr(material, "emission_texture", None)
    if weight > 0.0 and texture is not None:
        weight *= max(float(mean_color(texture).mean()), 1e-3)
    return weight


def _is_detailed(material: Material) -> bool:
    """Whether a material's textures ask where on the object a point is."""
    parts = [material, *(part for part in vars(material).values() if isinstance(part, get_args(Part)))]
    textures = [value for part in parts for name, value in vars(part).items() if name.endswith("texture")]
    return getattr(material, "bump_texture", None) is not None or any(map(asks_for_detail, textures))


def _row(texture: AnyTexture | None, textures: dict[AnyTexture, int]) -> int:
    return -1 if texture is None else textures.setdefault(texture, len(textures))


def _fill_relief(row: np.void, material: Material, textures: dict[AnyTexture, int]) -> None:
    """Normal map, bumps and the texture of the coverage, of those materials that have them."""
    row["normal_texture"] = _row(getattr(material, "normal_texture", None), textures)
    row["normal_scale"] = getattr(material, "normal_scale", 1.0)
    row["bump_texture"] = _row(getattr(material, "bump_texture", None), textures)
    row["bump_scale"] = getattr(material, "bump_scale", 1.0)
    row["alpha_texture"] = _row(getattr(material, "alpha_texture", None), textures)
    row["alpha_channel"] = ("r", "g", "b", "alpha").index(getattr(material, "alpha_channel", "r"))


def _fill_lambert(row: np.void, material: Lambert, textures: dict[AnyTexture, int]) -> None:
    row["kind"], row["color"], row["ambient"] = layouts.LAMBERT, material.color, (-1.0, -1.0, -1.0)
    row["color_texture"] = _row(material.texture, textures)
    row["emission_texture"] = _row(material.emission_texture, textures)
    fill_rough_matte(row, material)


def _fill_blinn_phong(row: np.void, material: BlinnPhong, textures: dict[AnyTexture, int]) -> None:
    row["kind"], row["color"], row["specular"] = layouts.BLINN_PHONG, material.diffuse, material.specular
    row["exponent"], row["mirror"] = material.exponent, material.mirror
    row["mirror_blur"] = material.mirror_blur or 0.0
    row["highlight"] = layouts.PHONG if material.highlight == "phong" else layouts.BLINN
    row["ambient"] = (-1.0, -1.0, -1.0) if material.ambient is None else material.ambient
    row["specular_scale"] = _highlight_scale(material) if material.normalized else 1.0
    row["color_texture"] = _row(material.diffuse_texture, textures)
    row["specular_texture"] = _row(material.specular_texture, textures)
    row["emission_texture"] = _row(material.emission_texture, textures)


def _highlight_scale(material: BlinnPhong) -> float:
    """What makes the highlight's energy independent of its exponent: one over its integral, seen from straight above."""
    return (material.exponent + 2.0) / 8.0 if material.highlight == "blinn" else (material.exponent + 1.0) / 2.0


def _fill_metallic_roughness(row: np.void, material: MetallicRoughness, textures: dict[AnyTexture, int]) -> None:
    row["kind"], row["color"], row["ambient"] = layouts.METALLIC_ROUGHNESS, material.base_color, (-1.0, -1.0, -1.0)
    row["metallic"], row["roughness"], row["unlit"] = material.metallic, material.roughness, material.unlit
    row["occlusion_strength"] = material.occlusion_strength
    row["color_texture"] = _row(material.base_color_texture, textures)
    row["metallic_roughness_texture"] = _row(material.metallic_roughness_texture, textures)
    row["occlusion_texture"] = _row(material.occlusion_texture, textures)
    row["emission_texture"] = _row(material.emissive_texture, textures)
    fill_layers(row, material, lambda texture: _row(texture, textures))


def _fill_shadow_catcher(row: np.void, material: ShadowCatcher, textures: dict[AnyTexture, int]) -> None:
    row["kind"], row["color"] = layouts.SHADOW_CATCHER, material.color


def _fill_dielectric(row: np.void, material: Dielectric, textures: dict[AnyTexture, int]) -> None:
    row["kind"], row["color"], row["roughness"] = layouts.DIELECTRIC, material.tint, material.roughness
    row["color_texture"] = _row(material.tint_texture, textures)
    row["specular"] = row["dielectric_f0"] = dielectric_f0(material.ior)
    row["layers"] = layouts.COMPENSATED if material.energy_compensation and material.roughness > 0.0 else 0
    row["fresnel"] = layouts.SCHLICK if material.fresnel == "schlick" else layouts.EXACT


def _fill_cool_to_warm(row: np.void, material: CoolToWarm, textures: dict[AnyTexture, int]) -> None:
    row["kind"], row["color"], row["cool"] = layouts.COOL_TO_WARM, material.warm, material.cool


_FILL: dict[type, Callable[..., None]] = {
    Lambert: _fill_lambert,
    BlinnPhong: _fill_blinn_phong,
    MetallicRoughness: _fill_metallic_roughness,
    ShadowCatcher: _fill_shadow_catcher,
    Dielectric: _fill_dielectric,
    CoolToWarm: _fill_cool_to_warm,
}


# --- lights ---------------------------------------------------------------------------------------------------------------


def _light_table(scene: Scene, time: float) -> NDArray[np.void]:
    lights = scene.lights(time)
    table = np.zeros(len(lights), dtype=layouts.LIGHT)
    for row, (placed, light) in zip(table, lights, strict=True):
        row["position"] = placed.world_from_object[:3, 3]
        axis = -placed.world_from_object[:3, 2]
        row["direction"] = axis / (np.linalg.norm(axis) or 1.0)
        row["intensity"] = np.array(light.color) * light.intensity
        if isinstance(light, AreaLight):
            _fill_area_light(row, light, light_frame(placed.world_from_object))
        else:
            _fill_light(row, light)
    return table


def _fill_area_light(row: np.void, light: AreaLight, frame: NDArray[np.float64]) -> None:
    row["inverse_square"], row["visible"] = 1, light.visible
    if isinstance(light, RectangleLight):
        row["kind"], row["area"] = layouts.RECTANGLE_LIGHT, light.width * light.height
        row["axis_u"], row["axis_v"] = frame[:3, 0] * (light.width / 2.0), frame[:3, 1] * (light.height / 2.0)
        return
    is_sphere = isinstance(light, SphereLight)
    row["kind"] = layouts.SPHERE_LIGHT if is_sphere else layouts.DISK_LIGHT
    row["area"] = (4.0 if is_sphere else 1.0) * math.pi * light.radius**2
    row["axis_u"], row["axis_v"] = frame[:3, 0] * light.radius, frame[:3, 1] * light.radius


def _fill_light(row: np.void, light: PointLight | DirectionalLight | SpotLight | AmbientLight) -> None:
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
