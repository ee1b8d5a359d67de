"""Light in parts: what each light brings, and what comes straight from lights, so that a picture can be lit again without rendering it.

Light adds up. A picture is the sum of the pictures that each light alone would make, and of light that was scattered once and light that
was scattered more often. Each part is made with the very paths of the whole: all choices by lot are those that the whole scene asks for,
and only what shines is switched off, so that the parts have the noise of the whole and add up to it, pixel by pixel, as rounding allows.

    group        a light's name, else "light", of area lights "lamp"; the name of a material that shines, else its kind; "sky";
                 "background" for what stands behind everything, and for fog

A part costs the tracing of its paths again. A ground that shows shadows alone (`SHADOW_CATCHER`) is as transparent as it is lit: over it
the groups do not add up, for each has shadows of its own.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from ..scene.light import AreaLight
from ..scene.scene import Scene
from ..tables import layouts
from ..tables.build import names
from .driver import Stage

__all__ = ["group_names", "lit_by"]

_SKY, _BACKGROUND = "sky", "background"


def group_names(stage: Stage, scene: Scene) -> tuple[str, ...]:
    """The groups from which light comes, in the order of lights, materials, sky and background.

    Parameters
    ----------
    stage : Stage
    scene : Scene
        Of which the stage's tables were made, with its lamps.
    """
    lights = [name for name, row in zip(_lights(scene), stage.tables.lights, strict=True) if row["intensity"].any()]
    shining = _shining(stage.tables.materials)
    materials = [name for name, shines in zip(_materials(stage, scene), shining, strict=True) if shines]
    has_sky = stage.lighting.header["sky_present"][0] != 0
    behind = stage.background[:3].any() or (len(stage.media) and stage.media["haze"].any())
    return tuple(dict.fromkeys([*lights, *materials, *([_SKY] if has_sky else []), *([_BACKGROUND] if behind else [])]))


def lit_by(stage: Stage, scene: Scene, group: str) -> Stage:
    """The same stage with all light switched off but that of a group; what is drawn by lot stays as it is."""
    tables, lighting = stage.tables, stage.lighting
    lights = tables.lights.copy()
    lights["intensity"][[name != group for name in _lights(scene)]] = 0.0
    dark = np.array([name != group for name in _materials(stage, scene)], dtype=bool)
    materials = tables.materials.copy()
    materials["emission"][dark] = 0.0
    # What an unlit or an illustrator's material shows is its own light.
    painted = dark & _shows_itself(materials)
    for field in ("color", "cool"):
        materials[field][painted] = 0.0
    header = lighting.header.copy()
    if group != _SKY:
        header["sky_intensity"], header["irradiance"] = 0.0, 0.0
    emitters = lighting.emitters
    if "radiance" in (emitters.dtype.names or ()):
        emitters = emitters.copy()
        emitters["radiance"][dark[_materials_of_emitters(stage)]] = 0.0
    background, media = stage.background.copy(), stage.media.copy()
    if group != _BACKGROUND:
        background[:3], media["haze"] = 0.0, 0.0
    return stage._replace(
        tables=tables._replace(lights=lights, materials=materials), lighting=lighting._replace(header=header, emitters=emitters),
        background=background, media=media,
    )  # fmt: skip


def _lights(scene: Scene) -> list[str]:
    """The group of every light."""
    return [_plain(light.name or ("lamp" if isinstance(light, AreaLight) else "light")) for _, light in scene.lights()]


def _materials(stage: Stage, scene: Scene) -> list[str]:
    """The group of every row of the materials; the surface of a light belongs to the light."""
    groups = [_plain(name) for name in names(scene)["material_id"]]
    groups += [_BACKGROUND] * (len(stage.tables.materials) - len(groups))
    lights = _lights(scene)
    for instance in stage.tables.instances[stage.tables.instances["lamp"] > 0]:
        groups[int(instance["material"])] = lights[int(instance["lamp"]) - 1]
    return groups


def _shining(materials: NDArray[np.void]) -> NDArray[np.bool_]:
    shines: NDArray[np.bool_] = (materials["emission"] > 0.0).any(axis=1) | _shows_itself(materials)
    return shines


def _shows_itself(materials: NDArray[np.void]) -> NDArray[np.bool_]:
    shown: NDArray[np.bool_] = (materials["unlit"] != 0) | (materials["kind"] == layouts.COOL_TO_WARM)
    return shown


def _materials_of_emitters(stage: Stage) -> NDArray[np.int64]:
    """(n,) int64: the row of the material of every triangle that shines."""
    tables, emitters = stage.tables, stage.lighting.emitters
    instances = tables.instances[emitters["instance"]]
    first = tables.meshes["slot"][instances["mesh"]]
    slot = np.where(first >= 0, tables.slots[np.maximum(first + emitters["triangle"], 0)] if len(tables.slots) else 0, 0)
    return (instances["material"] + slot).astype(np.int64)


def _plain(name: str) -> str:
    """A name that can be a part of a layer's: letters, digits, - and _."""
    return re.sub(r"[^\w-]+", "_", name).strip("_") or "light"
