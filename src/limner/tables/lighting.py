"""The environment and the surfaces that shine, as kernels read them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import layouts
from .layouts import Lighting, SceneTables
from .light_tree import is_scattered, leaf_order, tree_nodes

__all__ = ["irradiance_harmonics", "lighting", "sky_cumulative", "sky_directions"]

_FEW = 8  # triangles: they are drawn by their power
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def lighting(
    tables: SceneTables, sky: NDArray[np.float32] | None, intensity: float = 1.0, rotation_degrees: float = 0.0, visible: bool = False,
    blurred: NDArray[np.float32] | None = None, moving: NDArray[np.int32] | None = None,
) -> Lighting:  # fmt: skip
    """Make the tables of a scene's lighting.

    Parameters
    ----------
    tables : SceneTables
    sky : (height, width, 3) float32, optional
        Radiance, equirectangular, row 0 on top; None: no sky. What is infinite counts as the greatest that is not.
    intensity : float
    rotation_degrees : float
        Turns the sky about +y, counter-clockwise seen from above.
    visible : bool
        Whether the sky is also what lies behind everything.
    blurred : (n, width, 3) float32, optional
        What `limner.shading.prefilter` makes of the sky.
    moving : (n,) int32, optional
        Rows of the instances that do not stand still while the shutter is open.
    """
    header = np.zeros(1, dtype=layouts.LIGHTING)
    row = header[0]
    pixels = np.zeros((0, 0, 3), dtype=np.float32)
    cumulative = np.zeros(0, dtype=np.float32)
    if sky is not None:
        pixels = _finite(np.ascontiguousarray(sky[::-1], dtype=np.float32))
        angle = math.radians(rotation_degrees)
        row["sky_present"], row["sky_visible"] = 1, visible
        row["sky_height"], row["sky_width"] = pixels.shape[:2]
        row["sky_intensity"], row["sky_cos"], row["sky_sin"] = intensity, math.cos(angle), math.sin(angle)
        row["sky_even"] = bool((pixels == pixels[:1, :1]).all())
        row["irradiance"] = irradiance_harmonics(pixels, angle) * intensity
        cumulative = sky_cumulative(pixels)
    emitters, power, has_tree = _emitters(tables, moving)
    row["emitted_power"], row["light_tree"] = power, has_tree
    return Lighting(header, pixels, cumulative, emitters, np.zeros((0, 0, 3), dtype=np.float32) if blurred is None else blurred)


def _finite(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Radiance with infinity, as files of half floats say of the sun, as much as the greatest that is not, and black for no number."""
    known = np.isfinite(pixels)
    if known.all():
        return pixels
    return np.nan_to_num(pixels, nan=0.0, posinf=float(pixels[known].max(initial=0.0)), neginf=0.0)


def sky_directions(height: int, width: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(height, width, 3) unit directions of texel centres, row 0 at the bottom, and (height, 1) solid angles."""
    theta = np.pi * (1.0 - (np.arange(height) + 0.5) / height)[:, None]
    phi = 2.0 * np.pi * ((np.arange(width) + 0.5) / width - 0.5)[None, :]
    x, z = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
    solid_angle = 2.0 * np.pi / width * (2.0 * np.sin(theta) * np.sin(0.5 * np.pi / height))
    return np.stack([x, np.broadcast_to(np.cos(theta), x.shape), z], axis=-1), solid_angle


def irradiance_harmonics(pixels: NDArray[np.float32], angle: float) -> NDArray[np.float64]:
    """(9, 3): A_l L_lm, so that the irradiance on n is the sum of these times Y_lm(n).

    **Source**: Ramamoorthi and Hanrahan 2001, eq. 3, 5, 8; A_0 = pi, A_1 = 2 pi/3, A_2 = pi/4.
    """
    height, width = pixels.shape[:2]
    # Irradiance is smooth: a picture of a few thousand directions holds all of it.
    step_y, step_x = max(1, height // 64), max(1, width // 128)
    rows, columns = height // step_y * step_y, width // step_x * step_x
    small = pixels[:rows, :columns].reshape(rows // step_y, step_y, columns // step_x, step_x, 3).mean(axis=(1, 3), dtype=np.float64)
    d, solid_angle = sky_directions(*small.shape[:2])
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = c * d[..., 0] + s * d[..., 2], d[..., 1], -s * d[..., 0] + c * d[..., 2]
    y1, y2, y20 = math.sqrt(3 / (4 * math.pi)), math.sqrt(15 / (4 * math.pi)), math.sqrt(5 / (16 * math.pi))
    basis = np.stack(
        [
            np.full(x.shape, 0.5 / math.sqrt(math.pi)),
            y1 * y, y1 * z, y1 * x,
            y2 * x * y, y2 * y * z, y20 * (3 * z * z - 1), y2 * x * z, 0.5 * y2 * (x * x - y * y),
        ]
    )  # fmt: skip
    weights = np.array([math.pi] + [2 * math.pi / 3] * 3 + [math.pi / 4] * 5)
    return np.einsum("kij,ijc,ij->kc", basis, small, np.broadcast_to(solid_angle, x.shape)) * weights[:, None]


def sky_cumulative(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Shares of the radiance, row by row and within each row.

    A texel counts with its neighbours, since looking it up mixes them in: what can be seen can be drawn.
    """
    height = len(pixels)
    brightness = pixels.astype(np.float64) @ _LUMINANCE
    padded = np.concatenate([brightness[:1], brightness, brightness[-1:]])
    vertical = (padded[:-2] + 2.0 * padded[1:-1] + padded[2:]) / 4.0
    spread = (np.roll(vertical, 1, axis=1) + 2.0 * vertical + np.roll(vertical, -1, axis=1)) / 4.0
    sin_theta = np.sin(np.pi * (np.arange(height) + 0.5) / height)[:, None]
    weight = (spread + 1e-4 * spread.mean() + 1e-30) * sin_theta
    rows = weight.sum(axis=1)
    within = np.concatenate([np.zeros((height, 1)), np.cumsum(weight, axis=1) / rows[:, None]], axis=1)
    marginal = np.concatenate([[0.0], np.cumsum(rows) / rows.sum()])
    within[:, -1], marginal[-1] = 1.0, 1.0
    return np.concatenate([marginal, within.reshape(-1)]).astype(np.float32)


class _Shining(NamedTuple):
    """The triangles of one instance that shine."""

    instance: int
    triangles: NDArray[np.int64]
    materials: NDArray[np.int64]
    corners: NDArray[np.float64]  # (n, 3, 3), world space
    power: NDArray[np.float64]


def _emitters(tables: SceneTables, moving: NDArray[np.int32] | None) -> tuple[NDArray[np.void], float, bool]:
    """The triangles that shine, with their shares of the power: weight of their material times area; all power; whether there is a tree."""
    found = [
        shining
        for k, instance in enumerate(tables.instances)
        if instance["kind"] in (layouts.MESH, layouts.BOX) and instance["mesh"] >= 0 and (shining := _shining(tables, k)) is not None
    ] if (tables.materials["emission_weight"] > 0.0).any() else []  # fmt: skip
    power = np.concatenate([shining.power for shining in found]) if found else np.zeros(0)
    emitters = np.zeros(len(power), dtype=layouts.EMITTER)
    total = float(power.sum())
    if not len(power):
        return emitters, 0.0, False
    rows = np.concatenate([np.full(len(shining.power), shining.instance) for shining in found])
    materials = tables.materials[np.concatenate([shining.materials for shining in found])]
    corners, triangles = np.concatenate([shining.corners for shining in found]), np.concatenate([shining.triangles for shining in found])
    emitters["key_instance"], emitters["key_triangle"], emitters["key_row"] = rows, triangles, np.arange(len(power))
    has_tree = len(power) > _FEW and is_scattered(corners)
    if has_tree:
        order = leaf_order(corners.mean(axis=1))
        emitters["key_row"][order] = np.arange(len(power))
        power, rows, materials, corners, triangles = power[order], rows[order], materials[order], corners[order], triangles[order]
    edge_u, edge_v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(edge_u, edge_v) * np.where(tables.instances["flipped"][rows] != 0, -1.0, 1.0)[:, None]
    emitters["instance"], emitters["triangle"] = rows, triangles
    emitters["corner"], emitters["edge_u"], emitters["edge_v"] = corners[:, 0], edge_u, edge_v
    size = np.linalg.norm(across, axis=1, keepdims=True)
    emitters["normal"], emitters["area"] = across / size, 0.5 * size[:, 0]
    emitters["radiance"], emitters["double_sided"] = materials["emission"], materials["double_sided"]
    emitters["weight"] = materials["emission_weight"]
    is_even = (materials["emission_texture"] < 0) & (materials["alpha_mode"] == layouts.OPAQUE) & (materials["unlit"] == 0)
    emitters["plain"] = is_even & (materials["kind"] != layouts.COOL_TO_WARM) & ~np.isin(rows, [] if moving is None else moving)
    if has_tree:
        nodes = tree_nodes(corners, across / size, power, materials["double_sided"] != 0)
        emitters["nodes"] = np.stack([nodes[: len(power)], nodes[len(power) :]], axis=1)
    emitters["cumulative"] = np.cumsum(power) / total
    emitters["cumulative"][-1] = 1.0
    return emitters, total, has_tree


def _shining(tables: SceneTables, row: int) -> _Shining | None:
    """The triangles of an instance that shine; those without area, or with none that is finite, do not."""
    instance = tables.instances[row]
    mesh = tables.meshes[instance["mesh"]]
    n = int(mesh["n_triangles"])
    slots = tables.slots[mesh["slot"] : mesh["slot"] + n] if mesh["slot"] >= 0 else np.zeros(n, dtype=np.int32)
    materials = (instance["material"] + slots).astype(np.int64)
    weight = tables.materials["emission_weight"][materials]
    shining = np.flatnonzero(weight > 0.0)
    if not len(shining):
        return None
    corners = tables.positions[mesh["position"] + tables.triangles[mesh["triangle"] + shining]].astype(np.float64)
    placed = instance["world_from_object"].astype(np.float64)
    world = corners @ placed[:, :3].T + placed[:, 3]
    power = weight[shining] * 0.5 * np.linalg.norm(np.cross(world[:, 1] - world[:, 0], world[:, 2] - world[:, 0]), axis=1)
    kept = np.isfinite(power) & (power > 0.0)
    return _Shining(row, shining[kept], materials[shining[kept]], world[kept], power[kept])
