"""What one process of the raster benchmark draws, and by what.

It is read in the peers' environments, too, which have NumPy but no limner: what either needs is imported where it is used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[Any]
Vector = tuple[float, float, float]

N_VIEWS = 60
STRIDE = 37  # coprime to N_VIEWS: also the first few views look from all around
WARM_FRAMES = 4
LEAST_FRAMES = 3
YFOV_DEGREES = 40.0
ELEVATION_DEGREES = 20.0
BACKGROUND: Vector = (0.0, 0.0, 1.0)  # zeros and ones: the same in every encoding
COLOR: Vector = (0.8, 0.8, 0.8)
AMBIENT = 0.25
DIFFUSE = 0.75
TOWARDS_LIGHT: Vector = (0.48, 0.6, 0.64)
UP: Vector = (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class Job:
    """What one process draws.

    Parameters
    ----------
    renderer : str
        A key of `_RENDERERS`.
    model : str
        Folder of a model that `write_model` made.
    width, height, samples, threads : int
    eyes : list of N_VIEWS points
    target : point
    near, far : float
        Positive distances of the clipping planes.
    """

    renderer: str
    model: str
    width: int
    height: int
    samples: int
    threads: int
    eyes: list[Vector]
    target: Vector
    near: float
    far: float


class Model(NamedTuple):
    """Vertices that share one index, as graphics cards have them.

    Parameters
    ----------
    positions, normals : (n, 3) float32
    uvs : (n, 2) float32
        v up; zeros where there is no texture.
    triangles : (m, 3) int32
    texels : (height, width, 4) uint8
        sRGB, row 0 at the bottom; (0, 0, 4): no texture, the surface is `COLOR`.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    triangles: NDArray[np.int32]
    texels: NDArray[np.uint8]


class Drawing(NamedTuple):
    """A renderer that stands ready.

    Parameters
    ----------
    draw : callable
        Takes the number of a view; returns (height, width, 3 or 4), row 0 on top.
    samples : int
        Of a pixel, as the renderer counts them.
    linear : bool
        Whether what it draws is linear light, not sRGB.
    note : str
        What draws: the version, the device.
    """

    draw: Callable[[int], Pixels]
    samples: int
    linear: bool = False
    note: str = ""
