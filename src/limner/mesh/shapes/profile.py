"""Lines in a plane that sweep a surface: their normals, smooth where they bend a little and split where they bend sharply."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["creased_profile"]

Points = NDArray[np.float64]


def creased_profile(points: Points, ring: bool, crease: float) -> tuple[Points, Points, Points]:
    """Give every point of a line the normals of the edges before and after it.

    Parameters
    ----------
    points : (k, 2) float64, k >= 2
        None equal to the next; of a ring the last is the first.
    ring : bool
    crease : float
        Radians: where the line bends by no more, both normals are the mean of the edges' normals.

    Returns
    -------
    points, normals : (m, 2) float64
        Every point twice, as the end of the edge before it and as the start of the one after; m = 2 k - 2, of a ring 2 k - 1. Normals
        are unit and to the right of the way along the line.
    arc : (m,) float64
        Length of the line up to the point.
    """
    along = np.diff(points, axis=0)
    lengths = np.linalg.norm(along, axis=1)
    normals = np.stack([along[:, 1], -along[:, 0]], axis=1) / lengths[:, None]
    before = np.concatenate([normals[-1:] if ring else normals[:1], normals])
    after = np.concatenate([normals, normals[:1] if ring else normals[-1:]])
    turn = np.abs(np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1)))
    mean = before + after
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12)
    smooth = (turn <= crease + 1e-9)[:, None]
    both = np.stack([np.where(smooth, mean, before), np.where(smooth, mean, after)], axis=1).reshape(-1, 2)
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    # What is before the first point and after the last sweeps nothing, but a ring ends in what it begins with
    kept = slice(0 if ring else 1, -1)
    return np.repeat(points, 2, axis=0)[kept], both[kept], np.repeat(arc, 2)[kept]
