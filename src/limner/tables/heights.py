"""Heights of a surface: what moves its vertices (FoCG 11.4.3).

Pictures on texture coordinates are looked up by NumPy, in float64: steps of float32 would be seen on a surface. All else, patterns and
tri-planar pictures, has its one formula in the kernels, which are asked through a door; it is named and not imported, as shading stands
above the tables.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door
from ..color.transfer import linear_from_srgb
from ..errors import SceneError
from ..mesh.mesh import Mesh
from ..mesh.reshape.displace import HeightFunction
from ..scene.displacement import Height
from ..scene.texture import Texture
from . import layouts
from .textures import texture_tables

__all__ = ["height_function"]

Floats = NDArray[np.float64]

_HEIGHTS = Door(
    "limner.shading.heights_kernel",
    "heights_at",
    (Array(layouts.TEXTURE, 1), Array(np.uint8, 1), Array(np.float32, 2), Array(np.float32, 1)),
    "heights of patterns",
)


def height_function(height: Height, mesh: Mesh, path: str) -> HeightFunction:
    """A function of texture coordinates (n, 2 or 4), points (n, 3) and their normals (n, 3) that gives heights (n,).

    Raises SceneError, naming the node, where the mesh lacks the texture coordinates that the height is looked up with.
    """
    on_uvs = height.mapping == "uv"
    if on_uvs and mesh.uvs is None:
        raise SceneError("displacement needs texture coordinates, and the mesh has none: see limner.project_uvs", path)
    if on_uvs and height.uv_set == 1 and mesh.uvs1 is None:
        raise SceneError("displacement.height.uv_set is 1, and the mesh has only one set of texture coordinates", path)
    first = 2 * height.uv_set if on_uvs else 0
    if isinstance(height, Texture) and on_uvs:
        red = _red(height)
        return lambda uvs, points, normals: _sampled(red, height, uvs[:, first : first + 2])
    records, texels = texture_tables([height])

    def look_up(uvs: Floats, points: Floats, normals: Floats) -> Floats:
        places = np.concatenate([uvs[:, first : first + 2], points, normals], axis=1).astype(np.float32)
        heights = np.empty(len(places), dtype=np.float32)
        _HEIGHTS(records, texels, places, heights)
        return heights.astype(np.float64)

    return look_up


def _red(texture: Texture) -> NDArray[np.float32]:
    """(height, width) float32: the red channel, decoded; of integers 0 to 1."""
    red = texture.texels.pixels[..., 0]
    if red.dtype == np.float32:
        return red.astype(np.float32)
    most = round(texture.texels.white)
    if texture.texels.srgb:
        return linear_from_srgb(np.arange(most + 1) / most)[red].astype(np.float32)
    return (red / np.float32(most)).astype(np.float32)


def _sampled(red: NDArray[np.float32], texture: Texture, uvs: Floats) -> Floats:
    """Bilinear, or nearest, with the texture's transform and wrap modes (FoCG 11.3.2); the conventions are those of the kernels."""
    c, s = math.cos(texture.rotation), math.sin(texture.rotation)
    u, v = uvs[:, 0] * texture.scale[0], uvs[:, 1] * texture.scale[1]
    rows, columns = red.shape
    x = _folded(c * u - s * v + texture.offset[0], texture.wrap_u) * columns
    y = _folded(s * u + c * v + texture.offset[1], texture.wrap_v) * rows
    if texture.filter == "nearest":
        return red[np.minimum(y.astype(np.int64), rows - 1), np.minimum(x.astype(np.int64), columns - 1)].astype(np.float64)
    i, j = np.floor(x - 0.5), np.floor(y - 0.5)
    a, b = x - 0.5 - i, y - 0.5 - j
    i0, i1 = (_neighbour(i.astype(np.int64) + k, columns, texture.wrap_u) for k in (0, 1))
    j0, j1 = (_neighbour(j.astype(np.int64) + k, rows, texture.wrap_v) for k in (0, 1))
    lower, upper = red[j0, i0] * (1.0 - a) + red[j0, i1] * a, red[j1, i0] * (1.0 - a) + red[j1, i1] * a
    return np.asarray(lower * (1.0 - b) + upper * b)


def _folded(x: Floats, wrap: str) -> Floats:
    """A texture coordinate brought into [0, 1]."""
    if wrap == "clamp":
        return np.clip(x, 0.0, 1.0)
    if wrap == "mirror":
        return 1.0 - np.abs(x % 2.0 - 1.0)
    return x - np.floor(x)


def _neighbour(i: NDArray[np.int64], n: int, wrap: str) -> NDArray[np.int64]:
    """A texel's number that may be one outside; mirrored and clamped, the border again."""
    return i % n if wrap == "repeat" else np.clip(i, 0, n - 1)
