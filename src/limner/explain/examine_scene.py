"""What can be seen in a description without drawing it: sizes, lights, materials, textures."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..mesh.mesh import Mesh
from ..produce.facts import facts, number, tight_bounds
from ..scene.lamp import lights_in_solids
from ..scene.light import AmbientLight, DirectionalLight, SpotLight
from ..scene.material import Dielectric, ShadowCatcher
from ..scene.scene import Scene
from ..scene.texture import Texture
from ..tables.exact import materials_of
from .findings import Finding
from .solids import Solid, is_inside

__all__ = ["examine_environment", "examine_lights", "examine_materials", "examine_places", "examine_reading"]

_PICTURE = re.compile(r"texture|image|picture|\bmap_|\.(png|jpe?g|webp|ktx2|tga|bmp|tiff?|exr|hdr)\b", re.IGNORECASE)
_UNREADABLE = ("missing", "drawn without", "cut off", "cannot be read", "no file", "not found")

_SLIPS: tuple[tuple[str, str, str, str], ...] = (
    ("nothing to see", "empty", "the picture shows the background only", "look at node.visible, and at scene.root.walk()"),
    (
        "millimetres", "units", "lights, fog and lenses are in metres: falloff and depth of field come out wrong by a thousand",
        "scene.replace(root=limner.Node(parent_from_node=limner.linear.transform.scale(0.001), children=(scene.root,)))",
    ),
    (
        "kilometres", "units", "lights, fog and lenses are in metres: falloff and depth of field come out wrong",
        "scene.replace(root=limner.Node(parent_from_node=limner.linear.transform.scale(1000), children=(scene.root,)))",
    ),
    ("no triangles", "empty-mesh", "nothing of it is drawn", "remove it, or look at what wrote it"),
    (
        "far beyond its own size", "far-off", "positions are float32: so far from the origin little is left of their digits",
        "scene.replace(root=limner.Node(parent_from_node=limner.linear.transform.translate(…), children=(scene.root,)))",
    ),
    ("seems to be up", "up-axis", "the model lies on its side", "limner render MODEL --model-up z, or limner.load(path, up='z')"),
)  # fmt: skip
"""What the facts of a scene warn of, by words in the warning: kind, why, what to do."""


def examine_reading(scene: Scene) -> Iterator[Finding]:
    """What a reader could not read."""
    for note in scene.notes:
        if any(word in note for word in _UNREADABLE):
            is_picture = _PICTURE.search(note) is not None
            kind, why = "unread", "it is not in the picture"
            if is_picture:
                kind, why = "missing-texture", "surfaces are plain where a picture was meant"
            yield Finding(kind, note, "", why, "put the file where the model looks for it; limner info MODEL --report tells of each part")


def examine_places(scene: Scene) -> Iterator[Finding]:
    """Sizes and places: units, axes, what is flattened."""
    for warning in facts(scene)["warnings"]:
        unknown = ("slip", "it may not be what was meant", "limner info MODEL")
        kind, why, do = next((slip[1:] for slip in _SLIPS if slip[0] in warning), unknown)
        yield Finding(kind, warning, "", why, do)
    for placed, shape in scene.shapes():
        if np.linalg.matrix_rank(placed.world_from_object[:3, :3]) < 3:
            what = f"its {type(shape.geometry).__name__} is flattened by the scale of a node"
            why = "what has no volume is seen as a line, or not at all"
            yield Finding("flattened", what, placed.path, why, "look at parent_from_node: no scale may be 0")
        geometry = shape.geometry
        if isinstance(geometry, Mesh) and not np.isfinite(geometry.positions).all():
            yield Finding("not-finite", "vertices are not finite", placed.path, "their triangles are left out", "limner mesh repair MODEL")


# --- light ----------------------------------------------------------------------------------------------------------------


def _power(light: Any) -> float:
    return float(light.intensity) * max(light.color)


def examine_lights(scene: Scene, renderer: str) -> Iterator[Finding]:
    """Lights that light nothing."""
    lights = scene.lights()
    is_dark = bool(lights) and all(_power(light) <= 0.0 for _, light in lights) and scene.environment is None and not _shining(scene)
    for placed, light in lights:
        name = light.name or placed.path
        if _power(light) <= 0.0:
            why = "no light has any, and since there are lights none is added: the picture is black" if is_dark else "it lights nothing"
            do = f"give {name!r} an intensity above 0, or remove it"
            yield Finding("no-power", f"the light {name!r} has no power", placed.path, why, do)
    yield from _lights_in_solids(scene)
    bounds = tight_bounds(scene)
    if np.isfinite(bounds).all():
        for placed, light in lights:
            yield from _past_everything(placed.path, light, placed.world_from_object, bounds)
    strength = max(_shining(scene), default=0.0)
    if renderer == "raster" and strength > 1.0 and not lights and scene.environment is None and (scene.camera or scene.cameras()):
        what = "surfaces shine, and there is no other light: raster does not let them light others"
        why = "the room is lit by lights that were added, not by its own"
        yield Finding("emissive-only", what, "", why, "--renderer path, or --renderer ray --emitters")


def _shining(scene: Scene) -> list[float]:
    """How brightly the surfaces that shine do."""
    return [max(m.emission) for _, shape in scene.shapes() for m in materials_of(shape) if max(m.emission) > 0.0]


def _lights_in_solids(scene: Scene) -> Iterator[Finding]:
    why, do = "its light does not get out", "move it, or make the solid of glass: limner.Dielectric()"
    for said in lights_in_solids(scene):
        yield Finding("light-inside", said.split(":")[0], said.split("'")[-2] if "'" in said else "", why, do)
    if len(scene.lights()) == 0:
        return
    solids = [
        Solid(placed.path, shape.geometry, placed.world_from_object) for placed, shape in scene.shapes()
        if isinstance(shape.geometry, Mesh) and all(m.alpha_mode == "opaque" and not isinstance(m, Dielectric) for m in shape.materials)
    ]  # fmt: skip
    eye = None if scene.camera is None else scene.camera.world_from_camera[:3, 3]
    for placed, light in scene.lights():
        if isinstance(light, (AmbientLight, DirectionalLight)):
            continue
        for solid in solids:
            if is_inside(solid, placed.world_from_object[:3, 3]) and (eye is None or not is_inside(solid, eye)):
                yield Finding("light-inside", f"the light {light.name or placed.path!r} stands inside {solid.path!r}", placed.path, why, do)


def _past_everything(path: str, light: Any, world_from_light: NDArray[np.float64], bounds: NDArray[np.float64]) -> Iterator[Finding]:
    """A light whose range ends before anything, or whose cone misses all."""
    if isinstance(light, (AmbientLight, DirectionalLight)):
        return
    place = world_from_light[:3, 3]
    nearest = float(np.linalg.norm(np.maximum(np.maximum(bounds[0] - place, place - bounds[1]), 0.0)))
    reach = getattr(light, "range", None)
    name = light.name or path
    if reach is not None and reach < nearest:
        what = f"the light {name!r} reaches {number(reach)} m, and what is nearest to it is {number(nearest)} m away"
        yield Finding("out-of-range", what, path, "it lights nothing", "light.range=None, or greater")
    if isinstance(light, SpotLight) and nearest > 0.0 and _misses(light, world_from_light, bounds):
        what = f"the cone of the spot {name!r} misses everything"
        why = "it lights nothing: a spot shines along -z of its node"
        yield Finding("spot-misses", what, path, why, "turn the node: limner.linear.transform.frame_from_gaze")


def _misses(light: SpotLight, world_from_light: NDArray[np.float64], bounds: NDArray[np.float64]) -> bool:
    """Whether the ball around the bounds lies beside the cone."""
    center, radius = (bounds[0] + bounds[1]) / 2.0, float(np.linalg.norm(bounds[1] - bounds[0])) / 2.0
    axis = -world_from_light[:3, 2] / np.linalg.norm(world_from_light[:3, 2])
    to_center = center - world_from_light[:3, 3]
    distance = float(np.linalg.norm(to_center))
    if distance <= radius:
        return False
    angle = math.acos(max(-1.0, min(1.0, float(axis @ to_center) / distance)))
    return angle - math.asin(radius / distance) > math.radians(light.outer_degrees)


def examine_environment(scene: Scene, pixels: Callable[[Any], NDArray[np.float32]]) -> Iterator[Finding]:
    """A sky that gives no light."""
    environment = scene.environment
    if environment is None:
        return
    level = float(environment.intensity) * float(np.max(pixels(environment), initial=0.0))
    if not level > 0.0:
        why = "a sky is light, so no other is added: what no light reaches is black"
        do = "scene.replace(environment=None), or an intensity above 0"
        yield Finding("dark-sky", "the environment is black", "environment", why, do)


# --- matter ---------------------------------------------------------------------------------------------------------------


def examine_materials(scene: Scene) -> Iterator[Finding]:
    """Materials that are not seen, and textures that cannot be."""
    seen: set[tuple[int, int]] = set()
    for placed, shape in scene.shapes():
        for material in materials_of(shape):
            key = id(material), id(shape.geometry)
            if key in seen:
                continue
            seen.add(key)
            name = material.name or type(material).__name__
            yield from _invisible(placed.path, name, material)
            if isinstance(shape.geometry, Mesh) and shape.geometry.uvs is None and len(shape.geometry.triangles):
                maps = [what for what, held in _maps(material).items() if getattr(held, "mapping", "uv") == "uv"]
                if maps:
                    what = f"the material {name!r} has {_listed(maps)}, but the mesh has no texture coordinates"
                    do = "mesh coordinates first: limner mesh unwrap MODEL, or a texture with mapping='object'"
                    yield Finding("no-uvs", what, placed.path, "one texel colours the whole surface", do)


def _maps(material: Any) -> dict[str, Texture]:
    held = {field.name: getattr(material, field.name) for field in dataclasses.fields(material)}
    return {name: value for name, value in held.items() if isinstance(value, Texture)}


def _listed(names: list[str]) -> str:
    return " and ".join(f"a {name.replace('_', ' ')}" for name in names[:2])


def _invisible(path: str, name: str, material: Any) -> Iterator[Finding]:
    if isinstance(material, (ShadowCatcher, Dielectric)) or not isinstance(getattr(material, "alpha", None), float):
        return
    limit = material.alpha_cutoff if material.alpha_mode == "mask" else 0.0
    is_cut = material.alpha_mode == "mask" and material.alpha < limit
    if is_cut or (material.alpha_mode == "blend" and material.alpha <= 0.0):
        why = f"alpha_mode={material.alpha_mode!r} leaves nothing of it to be seen"
        do = f'alpha=1.0 or alpha_mode="opaque" for {name!r}; files often mean by 0 what others mean by 1'
        yield Finding("alpha", f"the material {name!r} has alpha {material.alpha:g}", path, why, do)


