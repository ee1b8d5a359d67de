"""Which instances can be in the picture at all: of what is repeated many times, most of it is often behind the camera or beside its view.

The corners of a box are taken to the raster like vertices. Where all eight lie on the far side of one edge of the picture, or behind the
near plane, so does everything between them: in homogeneous coordinates these are half-spaces, whatever the sign of w (FoCG 8.1.5).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import UnsupportedError
from ..tables.build import View
from ..tables.layouts import SceneTables
from .layouts import SUBPIXELS, WORDS

__all__ = ["instances_in_view"]

_REPEATED = 2  # so many vertices for each that the meshes have make a look at their boxes worth its time
_AT_ONCE = 1 << 14
_MOST_WORDS = 1 << 31  # what a 32-bit index tells apart


def instances_in_view(tables: SceneTables, view: View, width: int, height: int, samples: tuple[int, int]) -> NDArray[np.bool_]:
    """(n,) bool: the instances that may touch a sample; all of them where little is repeated.

    Parameters
    ----------
    tables : SceneTables
    view : View
    width, height : int
    samples : (int, int)
        How far the samples lie from their pixel's centre at most, on the subpixel grid.

    Raises
    ------
    UnsupportedError
        What is left has more triangles than the pipeline can tell apart.
    """
    mesh = tables.instances["mesh"]
    found = np.ones(len(mesh), dtype=np.bool_)
    if len(mesh) and int(tables.meshes["n_positions"][mesh].sum(dtype=np.int64)) > _REPEATED * len(tables.positions):
        boxes = _boxes(tables)
        reach = 1.0 + max(abs(side) for side in samples) / SUBPIXELS
        for start in range(0, len(mesh), _AT_ONCE):
            part = slice(start, start + _AT_ONCE)
            found[part] = _may_touch(boxes[mesh[part]], view.raster_from_object[part], view.camera[0]["near"], width, height, reach)
    n = int(tables.meshes["n_triangles"][mesh[found]].sum(dtype=np.int64))
    if n * WORDS >= _MOST_WORDS:
        raise UnsupportedError(
            f"raster draws at most {_MOST_WORDS // WORDS} triangles in a picture, here are {n}; "
            "ray and path trace what is repeated without copying it"
        )
    return found


def _boxes(tables: SceneTables) -> NDArray[np.float32]:
    """(m, 2, 3): the least and the greatest corner of every mesh."""
    boxes = np.zeros((len(tables.meshes), 2, 3), dtype=np.float32)
    for row, mesh in enumerate(tables.meshes):
        positions = tables.positions[mesh["position"] : mesh["position"] + mesh["n_positions"]]
        if len(positions):
            boxes[row] = positions.min(axis=0), positions.max(axis=0)
    return boxes


@np.errstate(over="ignore", invalid="ignore")
def _may_touch(
    boxes: NDArray[np.float32], raster_from_object: NDArray[np.float32], near: float, width: int, height: int, reach: float
) -> NDArray[np.bool_]:
    corners = boxes[:, [[0, 0, 0], [0, 0, 1], [0, 1, 0], [0, 1, 1], [1, 0, 0], [1, 0, 1], [1, 1, 0], [1, 1, 1]], [0, 1, 2]]
    m = raster_from_object
    x, y, _, w = np.moveaxis(corners @ np.swapaxes(m[:, :, :3], 1, 2) + m[:, None, :, 3], 2, 0)
    beyond = (x < -reach * w, x > (width - 1 + reach) * w, y < -reach * w, y > (height - 1 + reach) * w, w < 0.999 * near)
    return ~np.logical_or.reduce([side.all(axis=1) for side in beyond])
