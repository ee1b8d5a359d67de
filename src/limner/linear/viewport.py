"""The viewport transformation: from the canonical square to pixels (FoCG 7.1.1).

Pixel (i, j) counts columns from the left and rows from the *bottom*, its centre has integer coordinates, and the picture covers
[-0.5, n_x - 0.5] x [-0.5, n_y - 0.5].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

__all__ = ["viewport"]


def viewport(n_x: int, n_y: int) -> NDArray[np.float64]:
    """Map [-1, 1]^2 to [-0.5, n_x - 0.5] x [-0.5, n_y - 0.5]; z stays.

    Parameters
    ----------
    n_x, n_y : int >= 1
        Width and height of the picture in pixels.

    Returns
    -------
    (4, 4) float64
        M_vp.

    Examples
    --------
    >>> (viewport(640, 480) @ [-1, 1, 0, 1]).tolist()
    [-0.5, 479.5, 0.0, 1.0]

    **Source**: FoCG 7.1.1.
    """
    if n_x < 1 or n_y < 1:
        raise SceneError(f"a picture must be at least 1 pixel wide and high, got {n_x} x {n_y}")
    matrix = np.diag([n_x / 2.0, n_y / 2.0, 1.0, 1.0])
    matrix[:2, 3] = (n_x - 1) / 2.0, (n_y - 1) / 2.0
    return matrix
