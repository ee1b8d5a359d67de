"""What only a picture tells: that it is empty, black, burnt out or noisy; and why, by asking again with one thing changed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..image.image import Image
from ..linear import transform
from ..mesh.mesh import Mesh
from ..produce.facts import number, report_of_pixels
from ..render import Renderer
from ..scene.framing import extent_points, with_defaults
from ..scene.material import Dielectric
from ..scene.scene import Scene
from .findings import Finding
from .solids import Solid, is_inside

__all__ = ["examine_picture", "small_picture"]

_WIDTH, _HEIGHT = 96, 72
_DARK, _BURNT = 0.004, 0.6
_TINY = 2e-4  # the share of pixels that a thing in the picture covers at least
_NOISY = 0.12  # standard deviation of a pixel over the picture's mean


def small_picture(scene: Scene, renderer: str = "raster", **options: Any) -> Image:
    """A small picture of the scene before nothing, without what it warns of."""
    settings = {"width": _WIDTH, "height": _HEIGHT, "renderer": renderer, "samples": 1, **options}
    with Renderer(scene.replace(background=None), **settings) as once:
        return once.render()


def examine_picture(scene: Scene, renderer: str, samples: int | None) -> Iterator[Finding]:
    """Draw it small, and look at it."""
    if not scene.shapes():
        return
    told = report_of_pixels(small_picture(scene).pixels)
    if told["coverage"] < _TINY:
        yield from _why_empty(scene)
        return
    yield from _camera_in_solid(scene)
    yield from _cut_by_planes(scene)
    if told["brightness"] is not None and told["brightness"] < _DARK and not _is_meant_dark(scene):
        what, do = "half of what is seen is black", "look at where the lights stand and what stands before them"
        if told["brightness"] > 0.0:
            what = f"half of what is seen is darker than {told['brightness']:.2g} of white"
            do = f"dataclasses.replace(light, intensity={number(0.3 / told['brightness'])} * light.intensity)"
        why = _why_dark(scene)
        if _has_unsurrounded_metal(scene):
            why, do = "metals show what they mirror, and there is no environment around them", "--environment FILE, or scene.environment"
        yield Finding("too-dark", what, "", why, do)
    elif told["burnt_out"] is not None and told["burnt_out"] > _BURNT and not _is_meant_white(scene):
        yield Finding(
            "too-bright", f"{told['burnt_out']:.0%} of what is seen is brighter than white", "",
            "light's numbers are taken as they stand, in candela, lux and nit: files from other programs often have watts",
            "make the lights weaker, or save as .exr, which clips nothing",
        )  # fmt: skip
    if renderer == "path" and samples is not None:
        yield from _noise(scene, samples)


def _why_empty(scene: Scene) -> Iterator[Finding]:
    """Why nothing is in the picture."""
    seen, _ = with_defaults(scene, _WIDTH / _HEIGHT)
    camera = seen.camera
    assert camera is not None
    if report_of_pixels(small_picture(scene, culling="none").pixels)["coverage"] >= _TINY:
        paths = ", ".join(dict.fromkeys(placed.path for placed, shape in scene.shapes() if not all(_is_double(m) for m in shape.materials)))
        yield Finding(
            "seen-from-behind", "single-sided surfaces are seen from behind", paths, "their backs are left out, and nothing else is there",
            "material.double_sided=True, the other way round: Mesh(positions, triangles[:, ::-1]), or --culling none",
        )  # fmt: skip
        return
    points = transform.transform_points(np.linalg.inv(camera.world_from_camera), extent_points(scene))
    depths = -points[np.isfinite(points).all(axis=1), 2]
    if not len(depths):
        return
    what, kind = "the camera looks past everything", "looks-past"
    do = "--camera frame, or limner.Camera.look_at(eye, target)"
    if (depths <= 0.0).all():
        what, kind = "all of the scene lies behind the camera", "behind-camera"
    elif camera.near is not None and depths.max() < camera.near:
        what, kind = f"everything is nearer than camera.near, {number(camera.near)} m", "near-plane"
        do = "camera.near=None: from the scene's size"
    elif camera.far is not None and depths.min() > camera.far:
        what, kind = f"everything is beyond camera.far, {number(camera.far)} m", "far-plane"
        do = "camera.far=None: from the scene's size"
    elif _is_speck(depths, points):
        what = f"the camera stands {number(float(depths.min()))} m away from a model of {number(_extent(points))} m"
        kind = "camera-far-outside"
        do += "; are the model's units millimetres, and the camera's metres?"
    yield Finding(kind, what, "camera", "the picture is empty", do)


def _is_double(material: Any) -> bool:
    return bool(getattr(material, "double_sided", True))


def _extent(points: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(np.ptp(points[np.isfinite(points).all(axis=1)], axis=0)))


def _is_speck(depths: NDArray[np.float64], points: NDArray[np.float64]) -> bool:
    return float(depths.min()) > 50.0 * max(_extent(points), 1e-12)


def _camera_in_solid(scene: Scene) -> Iterator[Finding]:
    camera = scene.camera or next(iter(scene.cameras()), None)
    if camera is None:
        return
    eye = camera.world_from_camera[:3, 3]
    for placed, shape in scene.shapes():
        if not isinstance(shape.geometry, Mesh) or any(isinstance(material, Dielectric) for material in shape.materials):
            continue
        solid = Solid(placed.path, shape.geometry, placed.world_from_object)
        if is_inside(solid, eye) and _has_things_outside(scene, placed.path):
            why = "what is seen is its inside; all else is hidden, and lights outside do not reach in"
            what = f"the camera stands inside {placed.path!r}"
            yield Finding("camera-inside", what, "camera", why, "--camera frame, or move the eye out")


def _has_things_outside(scene: Scene, path: str) -> bool:
    """Whether anything stands beyond the shape in which the camera is: a room holds all there is."""
    shapes = scene.shapes()
    own = [shape.geometry for placed, shape in shapes if placed.path == path]
    matrix = next(placed.world_from_object for placed, _ in shapes if placed.path == path)
    if not isinstance(own[0], Mesh):
        return False
    room = Solid(path, own[0], matrix)
    others = [placed.world_from_object[:3, 3] for placed, _ in shapes if placed.path != path]
    return any(not is_inside(room, point) for point in others)


def _cut_by_planes(scene: Scene) -> Iterator[Finding]:
    """Near and far planes that cut what is in the picture."""
    camera = scene.camera or next(iter(scene.cameras()), None)
    if camera is None or (camera.near is None and camera.far is None):
        return
    points = extent_points(scene)
    places, depths = camera.project(points[np.isfinite(points).all(axis=1)], _WIDTH, _HEIGHT)
    with np.errstate(invalid="ignore"):
        inside = (depths > 0.0) & (places >= -0.5).all(axis=1) & (places < (_WIDTH - 0.5, _HEIGHT - 0.5)).all(axis=1)
    for name, cut in (("near", inside & (depths < (camera.near or 0.0))), ("far", inside & (depths > (camera.far or math.inf)))):
        if cut.sum() > 0.02 * max(int(inside.sum()), 1) and cut.any():
            share = f"{int(cut.sum())} of {int(inside.sum())} points in view"
            what = f"camera.{name} = {number(getattr(camera, name))} m cuts the scene: {share}"
            do = f"camera.{name}=None: from the scene's size"
            yield Finding(f"{name}-plane", what, "camera", "parts of it are missing from the picture", do)


# --- light ----------------------------------------------------------------------------------------------------------------


def _is_meant_dark(scene: Scene) -> bool:
    """Whether the surfaces themselves are black."""
    colors = [np.asarray(_color(m)).max(initial=0.0) for _, shape in scene.shapes() for m in shape.materials]
    return bool(colors) and max(colors) < 0.02 and not any(max(m.emission) > 0.0 for _, s in scene.shapes() for m in s.materials)


def _color(material: Any) -> Any:
    return next((getattr(material, name) for name in ("base_color", "diffuse", "color") if hasattr(material, name)), (1.0, 1.0, 1.0))


def _is_meant_white(scene: Scene) -> bool:
    """Whether surfaces shine, or are painted unlit, as white as that."""
    materials = [m for _, shape in scene.shapes() for m in shape.materials]
    return any(max(m.emission) >= 1.0 or getattr(m, "unlit", False) for m in materials)


def _has_unsurrounded_metal(scene: Scene) -> bool:
    metals = (getattr(material, "metallic", 0.0) > 0.9 for _, shape in scene.shapes() for material in shape.materials)
    return scene.environment is None and any(metals)


def _why_dark(scene: Scene) -> str:
    if scene.lights():
        return "the lights are too weak for their distance: light falls off with its square, and numbers are in candela and lux"
    return "little light reaches what is seen"


def _noise(scene: Scene, samples: int) -> Iterator[Finding]:
    """How far two pictures with different random numbers differ."""
    one, other = (
        small_picture(scene, "path", width=48, height=36, samples=samples, seed=seed).pixels[..., :3].astype(np.float64) for seed in (1, 2)
    )
    mean = float((one + other).mean()) / 2.0
    noise = float(np.sqrt(((np.clip(one, 0.0, 4.0) - np.clip(other, 0.0, 4.0)) ** 2).mean() / 2.0)) / max(mean, 1e-9)
    if noise > _NOISY:
        enough = min(math.ceil(samples * (noise / 0.03) ** 2), 1 << 20)
        what = f"with {samples} samples a pixel is off by {noise:.0%} of the picture's mean"
        why = "paths find light by chance: noise falls with the root of the samples, and small bright things are found seldom"
        do = f"--samples {enough}; make small bright surfaces area lights, which are asked directly"
        yield Finding("noisy", what, "", why, do)
