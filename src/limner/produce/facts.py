"""What a scene is, in numbers and names: what a reviewer or a program asks before it looks.

    told = facts(limner.load("model.glb"))
    told["size"], told["triangles"], told["up"]["axis"]

Everything is plain (JSON can hold it), and where there is nothing to say it is None or empty. What is likely to be a slip stands in
``told["warnings"]``.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..color.transfer import bytes_from_linear
from ..linear import transform
from ..mesh.mesh import Mesh
from ..scene.material import Material, MetallicRoughness
from ..scene.scene import Scene
from ..scene.shape import Geometry
from ..scene.texture import Texels, Texture
from ..tables.exact import materials_of

__all__ = ["dominant_colors", "facts", "guess_up", "number", "report_of_pixels", "tight_bounds"]

MOST_LISTED = 200
"""Materials, textures, lights, cameras that are named; their numbers tell of all."""

_MOST_TRIANGLES = 2_000_000  # whose areas are added up for a guess
_MOST_VERTICES = 1 << 22  # that are moved one by one for exact bounds
_SLAB = 0.02  # of the extent: what counts as the ground that a model stands on
_STANDS = 0.25  # of its footprint, that flat ground must fill
_COARSE, _FINE = 1000.0, 0.001  # metres
_FAR_OFF = 20.0  # sizes from the origin

Floats = NDArray[np.float64]


def number(value: float) -> str:
    """A number as people write it: to four digits, but whole numbers whole.

    >>> number(1.23456), number(12345.6), number(0.00012), number(0.0), number(3e9)
    ('1.235', '12346', '0.00012', '0', '3e+09')
    """
    return f"{value:.0f}" if 1000.0 <= abs(value) < 1e7 else f"{value:.4g}"


def facts(scene: Scene) -> dict[str, Any]:
    """Tell about a scene.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    dict
        ``bounds`` (two corners), ``size``, ``center`` in metres, None where nothing is bounded; counts of ``nodes``, ``shapes``,
        ``meshes``, ``triangles`` (of all meshes, each once), ``drawn_triangles`` (as often as they are shown), ``vertices``;
        ``materials``, ``textures``, ``lights``, ``cameras``, the first 200 of each, beside ``n_materials`` and so on; ``up``, a guess;
        ``notes`` of the reader; ``warnings``.
    """
    shown = scene.shapes()
    meshes = list({id(shape.geometry): shape.geometry for _, shape in shown if isinstance(shape.geometry, Mesh)}.values())
    materials = list({id(material): material for _, shape in shown for material in materials_of(shape)}.values())
    textures = _texels(materials)
    lights, cameras = scene.lights(), scene.cameras()
    bounds = tight_bounds(scene)
    bounded = bool(np.isfinite(bounds).all())
    told: dict[str, Any] = {
        "name": scene.name,
        "bounds": bounds.tolist() if bounded else None,
        "size": (bounds[1] - bounds[0]).tolist() if bounded else None,
        "center": ((bounds[0] + bounds[1]) / 2.0).tolist() if bounded else None,
        "unit": "m",
        "nodes": sum(1 for _ in scene.root.walk()),
        "hidden_nodes": sum(1 for _ in scene.root.walk()) - sum(1 for _ in scene.walk()),
        "shapes": len(shown),
        "shapes_by_kind": _counted(type(shape.geometry).__name__ for _, shape in shown),
        "meshes": len(meshes),
        "triangles": sum(len(mesh.triangles) for mesh in meshes),
        "drawn_triangles": sum(len(shape.geometry.triangles) for _, shape in shown if isinstance(shape.geometry, Mesh)),
        "vertices": sum(len(mesh.positions) for mesh in meshes),
        "meshes_with": {what: sum(getattr(mesh, what) is not None for mesh in meshes) for what in ("normals", "uvs", "colors", "tangents")},
        "n_materials": len(materials),
        "materials": [_material(material) for material in materials[:MOST_LISTED]],
        "n_textures": len(textures),
        "textures": [_texture(texels) for texels in textures[:MOST_LISTED]],
        "n_lights": len(lights),
        "lights": [{"kind": type(light).__name__, "name": light.name, "node": at.path} for at, light in lights[:MOST_LISTED]],
        "n_cameras": len(cameras),
        "cameras": [{"kind": type(camera).__name__, "name": camera.name} for camera in cameras[:MOST_LISTED]],
        "up": guess_up(scene),
        "notes": list(scene.notes),
    }
    return {**told, "warnings": _slips(told, meshes)}


def _counted(names: Iterable[str]) -> dict[str, int]:
    counts: dict[str, int] = {}
    for name in names:
        counts[name] = counts.get(name, 0) + 1
    return counts


def _pictures(material: Material) -> dict[str, Texels]:
    found = {field.name: getattr(material, field.name) for field in dataclasses.fields(material)}
    return {name: value.texels for name, value in found.items() if isinstance(value, Texture)}


def _texels(materials: Sequence[Material]) -> list[Texels]:
    return list({id(texels): texels for material in materials for texels in _pictures(material).values()}.values())


def _texture(texels: Texels) -> dict[str, Any]:
    return {"name": texels.name, "width": int(texels.pixels.shape[1]), "height": int(texels.pixels.shape[0])}


def _material(material: Material) -> dict[str, Any]:
    told: dict[str, Any] = {"name": material.name, "kind": type(material).__name__}
    color = next((getattr(material, name) for name in ("base_color", "diffuse", "color") if hasattr(material, name)), None)
    if color is not None:
        told["color"] = _hex(np.asarray(color, dtype=np.float64))
    if isinstance(material, MetallicRoughness):
        told |= {"metallic": material.metallic, "roughness": material.roughness}
    if material.alpha_mode != "opaque":
        told["alpha_mode"] = material.alpha_mode
    if any(channel > 0.0 for channel in material.emission):
        told["emits"] = True
    return {**told, "textures": {name: texels.name for name, texels in _pictures(material).items()}}


def _hex(linear: Floats) -> str:
    """#RRGGBB of linear light; what is brighter than 1 is clipped."""
    red, green, blue = bytes_from_linear(linear.astype(np.float32)[None, None, :])[0, 0, :3].tolist()
    return f"#{red:02x}{green:02x}{blue:02x}"


def _slips(told: dict[str, Any], meshes: Sequence[Mesh]) -> list[str]:
    found = []
    if not told["shapes"]:
        found.append("there is nothing to see: no shape is visible")
    empty = sum(1 for mesh in meshes if not len(mesh.triangles))
    if empty:
        found.append(f"{empty} of {told['meshes']} meshes have no triangles")
    if told["size"] is not None:
        largest = max(told["size"])
        if largest > _COARSE:
            found.append(f"the model is {number(largest)} m large: is it in millimetres?")
        elif 0.0 < largest < _FINE:
            found.append(f"the model is {number(largest)} m large: is it in kilometres?")
        if largest > 0.0 and math.hypot(*told["center"]) > _FAR_OFF * largest:
            found.append(f"the model stands {number(math.hypot(*told['center']))} m from the origin, far beyond its own size")
    if told["up"]["axis"] != "+y" and told["up"]["confidence"] == "high":
        found.append(f"{told['up']['axis']} seems to be up ({told['up']['because']}); limner takes +y")
    return found


def tight_bounds(scene: Scene) -> Floats:
    """(2, 3) float64: least and greatest corner of what is visible, through the points themselves; (inf, -inf) where nothing is bounded.

    `Scene.bounds` turns boxes, which grow by it; this turns what is in them, unless there are too many vertices.
    """
    shapes = scene.shapes()
    if sum(len(shape.geometry.positions) for _, shape in shapes if isinstance(shape.geometry, Mesh)) > _MOST_VERTICES:
        return scene.bounds()
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for placed, shape in shapes:
        found = _extremes(placed.world_from_object, shape.geometry)
        if found is not None and np.isfinite(found).all():
            low, high = np.minimum(low, found[0]), np.maximum(high, found[1])
    return np.array([low, high])


def _extremes(world_from_object: Floats, geometry: Geometry) -> tuple[Floats, Floats] | None:
    linear, middle = world_from_object[:3, :3], world_from_object[:3, 3]
    if isinstance(geometry, Mesh):
        if not len(geometry.triangles):
            return None
        used = np.zeros(len(geometry.positions), dtype=bool)
        used[geometry.triangles.reshape(-1)] = True
        points = transform.transform_points(world_from_object, np.asarray(geometry.positions, dtype=np.float64)[used])
        return points.min(axis=0), points.max(axis=0)
    low, high = geometry.range_along(linear)
    return (middle + low, middle + high) if (low <= high).all() else None


# --- which way is up ------------------------------------------------------------------------------------------------------


def guess_up(scene: Scene) -> dict[str, str]:
    """Guess which axis points up in a model: y, as in glTF, or z, as in print and construction.

    Returns
    -------
    dict
        ``axis``: "+y" or "+z"; ``confidence``: "high", "medium" or "low"; ``because``: the evidence.

    Notes
    -----
    Things stand on something: the axis whose lower end is flat over much of the model's footprint, at 0, is up. Where nothing is flat,
    the axis along which the model begins at 0 and lies on both sides of 0 along the others. Where nothing is found it is +y. A
    heuristic: a box on its side deceives it.
    """
    usual = {"axis": "+y", "confidence": "low", "because": "nothing speaks for another axis than the usual one"}
    bounds = tight_bounds(scene)
    if not np.isfinite(bounds).all():
        return usual
    size = bounds[1] - bounds[0]
    starts = [abs(bounds[0][k]) <= 0.01 * size[k] and size[k] > 0.0 for k in range(3)]
    straddles = [bounds[0][k] < -0.2 * size[k] and bounds[1][k] > 0.2 * size[k] for k in range(3)]
    flat = _flat_shares(scene, bounds)
    for k, other in ((1, 2), (2, 1)):
        if flat[k] > _STANDS and flat[k] > 2.0 * flat[other]:
            because = f"its lower end is flat over {min(flat[k], 1.0):.0%} of its footprint"
            return {"axis": f"+{'xyz'[k]}", "confidence": "high" if starts[k] else "medium", "because": because}
    for k in (1, 2):
        if starts[k] and all(straddles[m] for m in range(3) if m != k):
            because = f"it begins at {'xyz'[k]} = 0 and lies on both sides of the others"
            return {"axis": f"+{'xyz'[k]}", "confidence": "medium", "because": because}
    return usual


def _flat_shares(scene: Scene, bounds: Floats) -> Floats:
    """(3,): along each axis, the area of what faces down at the lower end, over the footprint; 0 where there is too much to look at."""
    shapes = [(at.world_from_object, shape.geometry) for at, shape in scene.shapes() if isinstance(shape.geometry, Mesh)]
    areas = np.zeros(3)
    if sum(len(mesh.triangles) for _, mesh in shapes) > _MOST_TRIANGLES:
        return areas
    size = bounds[1] - bounds[0]
    for world_from_object, mesh in shapes:
        corners = transform.transform_points(world_from_object, np.asarray(mesh.positions, dtype=np.float64))[mesh.triangles]
        normal = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normal, axis=1)
        for k in range(3):
            low = corners[:, :, k].max(axis=1) <= bounds[0][k] + _SLAB * size[k]
            areas[k] -= float(normal[low & (normal[:, k] < -0.98 * length), k].sum())
    footprints = np.array([size[1] * size[2], size[0] * size[2], size[0] * size[1]])
    return areas / np.where(footprints > 0.0, footprints, np.inf)


# --- what is in pictures --------------------------------------------------------------------------------------------------


def dominant_colors(pixels: NDArray[np.float32], n: int = 5) -> list[dict[str, Any]]:
    """The commonest colours of what is visible.

    Parameters
    ----------
    pixels : (..., 4) float32
        Linear, straight alpha.
    n : int
        At most so many.

    Returns
    -------
    list of dict
        ``color`` as #rrggbb (sRGB) and ``share`` of the visible pixels, the commonest first: means of cells of an 8 x 8 x 8 raster.

    >>> dominant_colors(np.ones((2, 2, 4), dtype=np.float32))
    [{'color': '#ffffff', 'share': 1.0}]
    """
    visible = pixels.reshape(-1, 4)
    visible = visible[visible[:, 3] > 0.5]
    if not len(visible):
        return []
    encoded = bytes_from_linear(visible[None])[0, :, :3].astype(np.int64)
    cell = (encoded >> 5) @ np.array([64, 8, 1])
    counts = np.bincount(cell, minlength=512)
    means = np.stack([np.bincount(cell, encoded[:, k], minlength=512) for k in range(3)], axis=1) / np.maximum(counts, 1)[:, None]
    found = []
    for index in np.argsort(-counts, kind="stable")[:n]:
        if counts[index]:
            red, green, blue = np.rint(means[index]).astype(int).tolist()
            found.append({"color": f"#{red:02x}{green:02x}{blue:02x}", "share": round(float(counts[index]) / len(visible), 4)})
    return found


def report_of_pixels(pixels: NDArray[np.float32]) -> dict[str, Any]:
    """What can be said of a picture before a transparent background without knowing what it shows.

    Parameters
    ----------
    pixels : (height, width, 4) float32

    Returns
    -------
    dict
        ``coverage``: the share of pixels in which anything is seen; ``box``: left, top, width, height of these, None where there are
        none; ``brightness``: the median luminance of those that hide at least half of what lies behind, for a veil of glass has no
        brightness of its own, and None where there are none; ``burnt_out``: the share of these that has no channel below 1.
    """
    seen = pixels[..., 3] > 1.0 / 255.0
    told: dict[str, Any] = {"coverage": round(float(seen.mean()), 6), "box": None, "brightness": None, "burnt_out": None}
    if not seen.any():
        return told
    rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    left, top = int(columns[0]), int(rows[0])
    told["box"] = [left, top, int(columns[-1]) - left + 1, int(rows[-1]) - top + 1]
    color = pixels[pixels[..., 3] >= 0.5][:, :3]
    if not len(color):
        return told
    told["brightness"] = round(float(np.median(color @ np.array([0.2126, 0.7152, 0.0722], dtype=np.float32))), 6)
    told["burnt_out"] = round(float((color >= 1.0).all(axis=1).mean()), 6)
    return told
