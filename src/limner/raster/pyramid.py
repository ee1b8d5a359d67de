"""The truncated viewing pyramid in world space (FoCG 8.1.4): the planes between which the picture lies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..tables.layouts import PERSPECTIVE

__all__ = ["pyramid_planes"]

_MARGIN = 1.0  # pixels beyond the border, where cut corners may be rounded without a sample noticing


def pyramid_planes(camera: NDArray[np.void]) -> NDArray[np.float64]:
    """The planes of a camera: near, left, right, bottom, top, and far where it is finite.

    Parameters
    ----------
    camera : (1,) CAMERA

    Returns
    -------
    (5 or 6, 4) float64
        Rows (a, b, c, d), with ``a x + b y + c z + d >= 0`` inside, in world space; (a, b, c) is a unit vector. The sides stand one pixel
        outside the picture.

    **Source**: FoCG 8.1.4; the planes follow from the rays through the picture's border instead of from eight transformed corners.
    """
    row = camera[0]
    eye, corner, dx, dy, gaze = (row[name].astype(np.float64) for name in ("position", "corner", "dx", "dy", "gaze"))
    low = -0.5 - _MARGIN
    right, top = row["width"] - 0.5 + _MARGIN, row["height"] - 0.5 + _MARGIN
    below, above = corner + low * dx + low * dy, corner + right * dx + top * dy
    planes = [_plane(gaze, eye + float(row["near"]) * gaze)]
    if row["kind"] == PERSPECTIVE:
        inside = corner + 0.5 * (row["width"] - 1) * dx + 0.5 * (row["height"] - 1) * dy
        for edge, along in ((below, dy), (above, dy), (below, dx), (above, dx)):
            normal = np.cross(edge, along)
            planes.append(_plane(normal if normal @ inside > 0.0 else -normal, eye))
    else:
        for edge, normal in ((below, dx), (above, -dx), (below, dy), (above, -dy)):
            planes.append(_plane(normal, eye + edge))
    if np.isfinite(row["far"]):
        planes.append(_plane(-gaze, eye + float(row["far"]) * gaze))
    return np.ascontiguousarray(planes)


def _plane(normal: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
    unit = normal / np.linalg.norm(normal)
    return np.append(unit, -unit @ point)
