"""Cameras of Mitsuba scenes, and how they ask for their picture to be made.

Mitsuba's camera looks along +z with +y up, and so has +x on its left; limner's looks along -z: half a turn about y lies between. Its field
of view is measured along any of five ways across the picture, limner's from bottom to top, so that the shape of the film decides.

How many pixels and samples, and how often light is reflected, is no part of a scene: it becomes the arguments of `limner.render` that make
the same picture (`limner.load_report(path).settings`).

**Source**: the Mitsuba 3 documentation, *Sensors*, *Films*, *Integrators*.
"""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from ..scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from .mitsuba_light import HALF_TURN
from .mitsuba_properties import Properties
from .mitsuba_xml import Element
from .notes import Notes, quoted
from .sources import Sources

__all__ = ["integrator_settings", "read_sensor"]

_WIDTH, _HEIGHT, _SAMPLES = 768, 576, 4
_FILM_DIAGONAL = math.hypot(36.0, 24.0)  # of 35 mm film, millimetres
_ENDLESS = 100  # reflections where there is no end to them; what is left by then is nothing
_FILTERS = {"box": "box", "tent": "tent", "gaussian": "gaussian", "mitchell": "mitchell", "lanczos": "lanczos3", "catmullrom": "mitchell"}


def read_sensor(properties: Properties, sources: Sources, notes: Notes) -> tuple[Camera | None, dict[str, Any]]:
    """The camera, None where it is of a kind that is not read, and the settings of its film and sampler."""
    settings = _film_settings(properties, sources, notes)
    aspect = settings["width"] / settings["height"]
    kind = properties.element.kind
    if kind in ("perspective", "thinlens"):
        camera: Camera | None = _perspective(properties, aspect, notes)
    elif kind == "orthographic":
        place, scale = _place(properties, notes)
        # The film's width is two units of the sensor's own space.
        camera = OrthographicCamera(place, height=2.0 * float(scale[0]) / aspect, **_planes(properties), name=properties.element.id)
    else:
        notes.slip(f"{properties.what} is left out: it is not read", properties.where, kind="ignored", what=properties.what)
        camera = None
    properties.skip("srf", "principal_point_offset_x", "principal_point_offset_y")
    for child in properties.unknown():
        notes.add(f"{properties.what}: {quoted(child.name)} is ignored", child.where, kind="ignored", what=properties.what)
    return camera, settings


def integrator_settings(properties: Properties, notes: Notes) -> dict[str, Any]:
    """How light is followed: "path" with as many reflections. Mitsuba counts what lights are seen as the first, limner does not."""
    kind = properties.element.kind
    if kind == "direct":
        return {"renderer": "path", "max_depth": 1}
    depth = properties.integer("max_depth", -1)
    properties.skip("rr_depth", "hide_emitters", "strict_normals", "samples_per_pass")
    if kind not in ("path", "volpath", "volpathmis", "ptracer", "bdpt"):
        for child in properties.element.children:
            if child.tag == "integrator":
                return integrator_settings(properties.of(child), notes)
        text = f"{properties.what} is not read; path tracing stands in"
        notes.add(text, properties.where, kind="replaced", what=properties.what)
    return {"renderer": "path", "max_depth": _ENDLESS if depth < 0 else max(depth - 1, 0)}


def _perspective(properties: Properties, aspect: float, notes: Notes) -> PerspectiveCamera:
    place, _ = _place(properties, notes)
    fields: dict[str, Any] = _planes(properties)
    if properties.element.kind == "thinlens":
        radius = properties.number("aperture_radius", 0.1)
        focus = properties.number("focus_distance", fields["far"] or 1.0)
        if radius < 0.0 or focus <= 0.0:
            raise properties.error(f"a lens needs aperture_radius >= 0 and focus_distance > 0, got {radius:g} and {focus:g}")
        fields.update(aperture_radius=radius, focus_distance=focus)
    else:
        properties.skip("focus_distance", "aperture_radius")
    return PerspectiveCamera(
        place, _yfov_degrees(properties, aspect), name=properties.element.id,
        shift_x=2.0 * properties.number("principal_point_offset_x", 0.0),
        shift_y=-2.0 * properties.number("principal_point_offset_y", 0.0), **fields,
    )  # fmt: skip


def _place(properties: Properties, notes: Notes) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Where the camera stands, unit axes at right angles unless it is mirrored, and the scale along each axis that was taken out."""
    world = properties.transform("to_world") @ HALF_TURN
    scale = np.linalg.norm(world[:3, :3], axis=0)
    if not scale.min() > 0.0:
        raise properties.error("to_world of a sensor must not be singular", properties.child("to_world"))
    place = world.copy()
    place[:3, :3] /= scale
    if np.linalg.det(place[:3, :3]) < 0.0:
        place[:3, 0] *= -1.0
        text = "the picture of a mirrored camera is not mirrored: flip it from left to right"
        notes.slip(text, properties.where, kind="approximated", what=properties.what)
    return place, scale


def _planes(properties: Properties) -> dict[str, Any]:
    near, far = properties.number("near_clip", 0.0), properties.number("far_clip", 0.0)
    sound = 0.0 < near < far or (far == 0.0 and near > 0.0)
    return {"near": near if sound else None, "far": far if far > max(near, 0.0) else None}


def _yfov_degrees(properties: Properties, aspect: float) -> float:
    """The full vertical field of view that a film of this shape gets."""
    axis = properties.text("fov_axis", "x")
    if properties.has("focal_length") and not properties.has("fov"):
        text = properties.text("focal_length")
        found = re.fullmatch(r"\s*([\d.]+)\s*(?:mm)?\s*", text)
        if found is None or not float(found[1]) > 0.0:
            raise properties.error(f'focal_length must be such as "50mm", got {quoted(text)}', properties.child("focal_length"))
        half, axis = _FILM_DIAGONAL / (2.0 * float(found[1])), "diagonal"
    else:
        properties.skip("focal_length")
        fov = properties.number("fov", 2.0 * math.degrees(math.atan(_FILM_DIAGONAL / 100.0)) if not properties.has("fov") else 0.0)
        if not properties.has("fov"):
            axis = "diagonal"
        if not 0.0 < fov < 180.0:
            raise properties.error(f"fov must lie between 0 and 180 degrees, got {fov:g}", properties.child("fov"))
        half = math.tan(math.radians(fov) / 2.0)
    if axis in ("smaller", "larger"):
        axis = "x" if (aspect < 1.0) == (axis == "smaller") else "y"
    across = {"x": half / aspect, "y": half, "diagonal": half / math.hypot(1.0, aspect)}
    if axis not in across:
        raise properties.error(f"fov_axis must be x, y, diagonal, smaller or larger, got {quoted(axis)}", properties.child("fov_axis"))
    return math.degrees(2.0 * math.atan(across[axis]))


def _film_settings(properties: Properties, sources: Sources, notes: Notes) -> dict[str, Any]:
    settings: dict[str, Any] = {"width": _WIDTH, "height": _HEIGHT, "samples": _SAMPLES}
    for child in properties.element.children:
        held = Properties(child, sources)
        if child.tag == "film":
            for name in ("width", "height"):
                settings[name] = held.integer(name, int(settings[name]))
                if not 1 <= settings[name] <= 32768:
                    raise held.error(f"{name} must lie in [1, 32768], got {settings[name]}", held.child(name))
            settings.update(_filter(child))
            if any(held.has(name) for name in ("crop_width", "crop_height", "crop_offset_x", "crop_offset_y")):
                notes.add("the crop of the film is ignored: the whole is drawn", child.where, kind="ignored", what=held.what)
        elif child.tag == "sampler":
            settings["samples"] = max(1, held.integer("sample_count", _SAMPLES))
    return settings


def _filter(film: Element) -> dict[str, Any]:
    """The reconstruction filter; what Mitsuba takes by default is a gaussian."""
    kinds = [child.kind for child in film.children if child.tag == "rfilter"]
    return {"filter": _FILTERS.get(kinds[0], "gaussian") if kinds else "gaussian"}
