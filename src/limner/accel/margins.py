"""Triangles and their boxes, as the structures that cut space take them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["boxes_of", "margin_of", "whole_of"]

_MARGIN = 2.0**-18


def margin_of(corners: NDArray[np.float32]) -> float:
    """By how much boxes around the triangles (n, 9) are made larger: 2^-18 of the extent and the place of all.

    A ray that is rounded to float32 a few extents away may pass beside the point that it hits; this is more than that, so that no structure
    loses a hit between two cells. It also gives a volume to the boxes of what is flat.
    """
    if not len(corners):
        return 0.0
    points = corners.reshape(-1, 3)
    low, high = points.min(axis=0).astype(np.float64), points.max(axis=0).astype(np.float64)
    return float(_MARGIN * (np.linalg.norm(high - low) + max(np.abs(low).max(), np.abs(high).max())) + np.finfo(np.float32).tiny)


def boxes_of(corners: NDArray[np.float32]) -> NDArray[np.float32]:
    """Boxes (n, 6) float32 of the triangles (n, 9), all finite: low corner, high corner; larger than they are by the margin."""
    points = corners.reshape(-1, 3, 3)
    margin = np.float32(margin_of(corners))
    return np.concatenate([points.min(axis=1) - margin, points.max(axis=1) + margin], axis=1)


def whole_of(boxes: NDArray[np.float32]) -> NDArray[np.float64]:
    """(2, 3) float64: the low and the high corner of all boxes; of none, some room with nothing in it."""
    if not len(boxes):
        return np.array([[-1.0] * 3, [1.0] * 3])
    return np.stack([boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)]).astype(np.float64)
