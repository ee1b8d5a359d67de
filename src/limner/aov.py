"""The channels beside the picture: their names, their place in the two arrays that kernels fill, and those arrays unfilled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .tables import layouts
from .tables.layouts import SceneTables

__all__ = ["CHANNELS", "channels", "empty_values", "with_solid_blends"]

_FLOATS = {
    "depth": (0, 1), "distance": (1, 1), "normal": (2, 3), "normal_geometric": (5, 3), "position": (8, 3), "uv": (11, 2),
    "albedo": (13, 3),
}  # fmt: skip
_IDS = {"instance_id": 0, "material_id": 1, "triangle_id": 2}

CHANNELS = (*_FLOATS, *_IDS)
"""The names; see `limner.shading.aov` for what each holds."""


def empty_values(width: int, height: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """(height, width, 16) float32 and (height, width, 3) int32 that see nothing: infinitely far, no normal, no id."""
    values = np.zeros((height, width, 16), dtype=np.float32)
    values[..., 0:2] = np.inf
    return values, np.full((height, width, 3), -1, dtype=np.int32)


def channels(
    wanted: tuple[str, ...], values: NDArray[np.float32], ids: NDArray[np.int32]
) -> dict[str, NDArray[np.float32] | NDArray[np.int32]]:
    """The wanted channels by name, row 0 on top: (height, width) or (height, width, n)."""
    made: dict[str, NDArray[np.float32] | NDArray[np.int32]] = {}
    for name in wanted:
        if name in _IDS:
            made[name] = np.ascontiguousarray(ids[::-1, :, _IDS[name]])
        else:
            first, n = _FLOATS[name]
            part = values[::-1, :, first] if n == 1 else values[::-1, :, first : first + n]
            made[name] = np.ascontiguousarray(part)
    return made


def with_solid_blends(tables: SceneTables) -> SceneTables:
    """The same scene with blended materials cut out where their alpha is below one half, and glass as solid as it feels."""
    blended = tables.materials["alpha_mode"] == layouts.BLEND
    if not blended.any():
        return tables
    materials = tables.materials.copy()
    materials["alpha_mode"][blended] = layouts.MASK
    materials["alpha_cutoff"][blended] = 0.5
    seen = (materials["kind"] == layouts.DIELECTRIC) | (materials["layers"] & layouts.SOLID != 0)
    materials["alpha_mode"][seen] = layouts.OPAQUE
    return tables._replace(materials=materials)
