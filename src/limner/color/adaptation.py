"""White stays white: what an eye used to one light sees in another (von Kries).

A sheet of paper looks white at noon and by a lamp, though the lamp's light is orange: each kind of cone gets used to how much it gets. Von
Kries took that literally: scale the answers of the cones so that one white becomes the other. Which mixtures stand for cones is what the
methods differ in: ``"bradford"`` was fitted to how colours are matched and is what profiles use; ``"von_kries"`` takes measured cones;
``"xyz"`` none.

**Source**: von Kries, *Chromatic adaptation*, 1902; Lam, *Metamerism and colour constancy*, University of Bradford, 1985; ICC.1:2022, annex
E; Hunt, *The Reproduction of Colour*, 2004 (Hunt, Pointer and Estévez's cones under D65).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError

__all__ = ["ADAPTATIONS", "adaptation_matrix"]

Floats = NDArray[np.float64]

_CONES_FROM_XYZ = {
    "bradford": np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]),
    "von_kries": np.array([[0.40024, 0.70760, -0.08081], [-0.22630, 1.16532, 0.04570], [0.0, 0.0, 0.91822]]),
    "cat02": np.array([[0.7328, 0.4296, -0.1624], [-0.7036, 1.6975, 0.0061], [0.0030, 0.0136, 0.9834]]),
    "xyz": np.eye(3),
}
ADAPTATIONS = tuple(_CONES_FROM_XYZ)


def adaptation_matrix(target_white: ArrayLike, source_white: ArrayLike, method: str = "bradford") -> Floats:
    """(3, 3) float64, target_from_source: XYZ as they look under one white, from those under another.

    Parameters
    ----------
    target_white, source_white : (3,) float
        XYZ; Y alike.
    method : "bradford" | "von_kries" | "cat02" | "xyz"

    >>> d65, d50 = [0.95047, 1.0, 1.08883], [0.96422, 1.0, 0.82521]
    >>> (adaptation_matrix(d50, d65) @ d65).round(5).tolist()
    [0.96422, 1.0, 0.82521]
    """
    if method not in _CONES_FROM_XYZ:
        raise UnsupportedError(f"adaptation must be one of {', '.join(ADAPTATIONS)}, got {method!r}")
    cones = _CONES_FROM_XYZ[method]
    whites = np.asarray([target_white, source_white], dtype=np.float64)
    if whites.shape != (2, 3) or not np.isfinite(whites).all():
        raise SceneError("whites must be XYZ: three finite numbers each")
    target, source = whites @ cones.T
    return np.linalg.solve(cones, (target / source)[:, None] * cones)
