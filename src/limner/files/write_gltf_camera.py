"""Cameras and lights into glTF (glTF 2.0, section 3.10; KHR_lights_punctual).

A light's colour may not exceed 1 there; what it is divided by, a power of two, its intensity is multiplied by, so that nothing changes.
Angles become radians that are read back as the same degrees. What a field leaves to the scene's bounds ("near" and "far") glTF wants to
be told, so it gets numbers from them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..scene.camera import Camera, PerspectiveCamera
from ..scene.light import DirectionalLight, Light, PointLight, SpotLight
from ..scene.scene import Scene
from .notes import Notes
from .write_gltf_buffers import Json
from .write_gltf_exact import inverted
from .write_gltf_material import plain_text, strength_for

__all__ = ["Cameras", "Lights"]

_NEAR_SHARE, _FAR_SHARE = 1e-4, 10.0  # of the scene's extent, where a camera leaves it open
_OPEN = (("shift_x", 0.0), ("shift_y", 0.0), ("pixel_aspect", 1.0))


class Cameras:
    """The cameras of one file; those that are alike are written once."""

    def __init__(self, scene: Scene, notes: Notes) -> None:
        low, high = scene.bounds()
        extent = float(np.linalg.norm(high - low))
        self._extent = extent if math.isfinite(extent) and extent > 0.0 else 100.0
        self._notes = notes
        self.cameras: list[Json] = []
        self._names: list[str] = []

    def index_of(self, camera: Camera, path: str) -> int:
        """The number of a camera."""
        for field, plain in _OPEN:
            if getattr(camera, field) != plain:
                self._notes.add(f"a camera's {field} is left out", path)
        if camera.motion is not None:
            self._notes.add("a camera's own motion is left out: it stands where it is at time 0", path)
        perspective = isinstance(camera, PerspectiveCamera)
        made: Json = {"name": plain_text(camera.name)} if camera.name else {}
        if isinstance(camera, PerspectiveCamera):
            if camera.aperture_radius:
                self._notes.add("a camera's lens is left out: everything is sharp", path)
            made |= {"type": "perspective", "perspective": self._perspective(camera, path)}
        else:
            made |= {"type": "orthographic", "orthographic": self._orthographic(camera, path)}
        if perspective and camera.near is None:
            self._notes.add("a camera's near plane, which was left open, stands close before its eye", path)
        return _number_of(self.cameras, self._names, made, camera.name)

    def named(self, name: str) -> list[tuple[int, Json]]:
        """The cameras of a name, with their numbers."""
        return [(index, self.cameras[index]) for index, held in enumerate(self._names) if held == name]

    def _perspective(self, camera: PerspectiveCamera, path: str) -> Json:
        near = camera.near
        if near is None:
            near = _NEAR_SHARE * self._extent
            near = near if camera.far is None else min(near, 0.5 * camera.far)
        made: Json = {"yfov": inverted(math.degrees, math.radians(camera.yfov_degrees), camera.yfov_degrees), "znear": near}
        made |= {} if camera.far is None else {"zfar": camera.far}
        return made | ({} if camera.aspect is None else {"aspectRatio": camera.aspect})

    def _orthographic(self, camera: Any, path: str) -> Json:
        half, aspect = camera.height / 2.0, camera.aspect
        wide = half if aspect is None else inverted(lambda width: width / half, aspect * half, aspect)
        near, far = camera.near or 0.0, camera.far
        if far is None:
            far = near + _FAR_SHARE * self._extent
            self._notes.add("a camera's far plane, which was left open, stands far behind everything", path)
        return {"xmag": wide, "ymag": half, "znear": near, "zfar": far}


class Lights:
    """The lights of one file; those that are alike are written once.

    Parameters
    ----------
    moving : mapping
        The names of lights that are animated, with the fields that are and the greatest number of each.
    """

    def __init__(self, notes: Notes, moving: Mapping[str, Mapping[str, float]]) -> None:
        self._notes = notes
        self._moving = moving
        self.lights: list[Json] = []
        self._names: list[str] = []
        self._strengths: list[float] = []

    def index_of(self, light: Light, path: str) -> int | None:
        """The number of a light; None, with a note, for one that glTF cannot hold."""
        if not isinstance(light, (PointLight, DirectionalLight, SpotLight)):
            self._notes.add(f"{type(light).__name__} is left out: glTF has points, spots and directions only", path)
            return None
        strength = strength_for(max(*light.color, self._moving.get(light.name, {}).get("color", 0.0)))
        made: Json = {"name": plain_text(light.name)} if light.name else {}
        made |= {"type": {"PointLight": "point", "SpotLight": "spot"}.get(type(light).__name__, "directional")}
        made |= {"color": [channel / strength for channel in light.color], "intensity": light.intensity * strength}
        if isinstance(light, (PointLight, SpotLight)):
            if light.falloff != "inverse_square":
                self._notes.add("a light without falloff is written with it: glTF has no other", path)
            made |= {} if light.range is None else {"range": light.range}
        if isinstance(light, SpotLight):
            made["spot"] = {
                "innerConeAngle": _radians(light.inner_degrees), "outerConeAngle": min(_radians(light.outer_degrees), math.pi / 2.0),
            }  # fmt: skip
        index = _number_of(self.lights, self._names, made, light.name)
        self._strengths += [strength] * (len(self.lights) - len(self._strengths))
        return index

    def named(self, name: str) -> list[tuple[int, Json, float]]:
        """The lights of a name: number, as it is written, and what its colour was divided by and its intensity multiplied."""
        return [(index, self.lights[index], self._strengths[index]) for index, held in enumerate(self._names) if held == name]


def _radians(degrees: float) -> float:
    return inverted(math.degrees, math.radians(degrees), degrees)


def _number_of(held: list[Json], names: list[str], wanted: Json, name: str) -> int:
    if wanted not in held:
        held.append(wanted)
        names.append(name)
    return held.index(wanted)
