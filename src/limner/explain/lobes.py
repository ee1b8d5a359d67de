"""How the surfaces of a story scatter light: polar plots of what they return, in the plane of the eye and their shading normal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._jit import Call
from ..kernel.lanes import _Lanes
from ..kernel.vec import Vec3

__all__ = ["lobes"]

_MOST = 6
_STEP_DEGREES = 3


def lobes(calls: Sequence[Call]) -> list[dict[str, Any]]:
    """For each surface that was asked what it returns of light: ``wo`` and ``wi``, angles from the normal in degrees, and ``values``.

    The values are (angle, luminance) for light from all directions of the plane of wo and the normal: what is returned of irradiance,
    the cosine included. Angles are positive on the eye's side. None where the kernel that is asked for cannot be found.
    """
    found: list[dict[str, Any]] = []
    seen: set[tuple[Any, ...]] = set()
    for call in (made for root in calls for made in root.walk() if made.name.endswith(".bsdf.eval_bsdf")):
        if len(found) == _MOST or len(call.arguments) < 3:
            break
        bsdf, wo, wi = call.arguments[:3]
        if not hasattr(bsdf, "ns"):
            continue
        n, v, light = _numbers(bsdf.ns), _numbers(wo), _numbers(wi)
        key = (*n.tolist(), *v.tolist())
        if key not in seen:
            seen.add(key)
            found.append(_lobe(bsdf, wo, n, v, light))
    return found


def _numbers(v: Any) -> NDArray[np.float64]:
    """The first lane of a vector."""
    parts = (v.x, v.y, v.z)
    return np.array([part.values[0] if isinstance(part, _Lanes) else part for part in parts], dtype=np.float64)


def _lobe(bsdf: Any, wo: Any, n: NDArray[np.float64], v: NDArray[np.float64], light: NDArray[np.float64]) -> dict[str, Any]:
    from ..shading.bsdf import eval_bsdf

    side = v - n * (n @ v)
    if not np.linalg.norm(side) > 1e-6:
        side = np.cross(n, (1.0, 0.0, 0.0) if abs(n[0]) < 0.9 else (0.0, 1.0, 0.0))
    side = side / np.linalg.norm(side)
    values = []
    for degrees in range(-90, 91, _STEP_DEGREES):
        angle = math.radians(degrees)
        d = n * math.cos(angle) + side * math.sin(angle)
        with np.errstate(all="ignore"):
            c = eval_bsdf(bsdf, wo, Vec3(*(np.float32(part) for part in d)))
        parts = [float(part.values[0] if isinstance(part, _Lanes) else part) for part in (c.r, c.g, c.b)]
        level = 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]
        values.append([degrees, level if math.isfinite(level) else 0.0])
    return {"wo": _degrees(v, n, side), "wi": _degrees(light, n, side), "values": values}


def _degrees(d: NDArray[np.float64], n: NDArray[np.float64], side: NDArray[np.float64]) -> float:
    """The angle from the normal, positive towards the side; of a direction beside the plane, as it is seen along the plane's normal."""
    return round(math.degrees(math.atan2(float(d @ side), float(d @ n))), 3)
