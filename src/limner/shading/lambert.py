"""The matte lobe (FoCG 4.5.1, 10.1.1): radiance ``kd/pi max(0, n.l) E``."""

from __future__ import annotations

from .._jit import kernel
from ..kernel.elementary import INV_PI
from ..kernel.lanes import max
from ..kernel.vec import ZERO, Color, Vec3, dot

__all__ = ["eval_lambert"]


@kernel
def eval_lambert(kd: Color, n: Vec3, l: Vec3) -> Color:  # noqa: E741 - the book's letter
    """kd/pi max(0, n.l): what irradiance E facing l is multiplied by."""
    return kd * (INV_PI * max(ZERO, dot(n, l)))
