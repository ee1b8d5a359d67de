"""What each stage of the pipeline leaves, kept to be looked at (FoCG 8).

    taken = capture(tables, view, 640, 480)
    taken.screen             the triangles that are left after clipping and culling
    taken.samples            how much of each pixel they cover
    taken.channels           depth, normal, uv, … of what is seen
    taken.barycentrics       where in its triangle each pixel lies

The stages are those that make pictures, run over the same tables; nothing is computed a second way.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door
from ..aov import CHANNELS, channels, empty_values, with_solid_blends
from ..samples import pixel_samples
from ..tables import layouts
from ..tables.build import View
from ..tables.layouts import SCENE_ARRAYS, SceneTables
from . import pipeline
from .layouts import SCREEN_TRIANGLE, SUBPIXELS

__all__ = ["N_SAMPLES", "Capture", "capture"]

N_SAMPLES = 16
"""Places in each pixel where coverage is asked for."""

_COVER = Door(
    "limner.raster.stages_kernel",
    "count_coverage",
    (Array(SCREEN_TRIANGLE, 1), Array(np.int32, 2), Array(np.int32, 2), Array(np.int32, 2)),
    "the coverage of pixels",
)

_DESCRIBE = Door(
    "limner.raster.stages_kernel",
    "describe_pixels",
    (
        *SCENE_ARRAYS, Array(layouts.CAMERA, 1), Array(np.float32, 2), Array(np.int64, 1), Array(np.int32, 3), Array(np.float32, 3),
        Array(np.float32, 2),
    ),
    "the stages of the pipeline",
)  # fmt: skip


class Capture(NamedTuple):
    """A picture's way through the pipeline. Arrays with rows and columns have row 0 on top.

    Attributes
    ----------
    screen : (n,) SCREEN_TRIANGLE
        Triangles and pieces of triangles that may touch the picture, in the order of drawing, y up.
    cut : (n,) bool
        Which of them are pieces that clipping has made.
    samples : (height, width) int32
        How many of `N_SAMPLES` places in the pixel lie in some triangle, be it seen or hidden.
    layers : (height, width) int32
        How many triangles cover the pixel's centre.
    channels : dict
        As `limner.aov` has them, by name.
    faces : (height, width, 2) int32
        Instance and triangle that the pixel's centre sees, -1: nothing; exact shapes by the triangles that stand for them.
    barycentrics : (height, width, 3) float32
        Of the pixel's centre in that triangle, perspective-correct; NaN: nothing.
    mip_level : (height, width) float32
        Of the base colour's texture; NaN: nothing, or no texture.
    """

    screen: NDArray[np.void]
    cut: NDArray[np.bool_]
    samples: NDArray[np.int32]
    layers: NDArray[np.int32]
    channels: dict[str, NDArray[Any]]
    faces: NDArray[np.int32]
    barycentrics: NDArray[np.float32]
    mip_level: NDArray[np.float32]

    @property
    def seen(self) -> NDArray[np.bool_]:
        """(height, width) bool: where there is anything."""
        seen: NDArray[np.bool_] = self.faces[..., 0] >= 0
        return seen


def capture(
    tables: SceneTables, view: View, width: int, height: int, *, clipping: str = "homogeneous", threads: int = 1
) -> Capture:
    """Run the stages and keep what they leave.

    Parameters
    ----------
    tables, view : SceneTables, View
        Spheres and planes as triangles, too (`limner.tables.build.flatten`).
    width, height : int
        Those of the view.
    clipping : "homogeneous" | "world"
        As in `limner.raster.pipeline.prepare`.
    """
    tables = with_solid_blends(tables)
    vertices, bins = pipeline._geometry(tables, view, width, height, pipeline.TILE_SIZE, threads, clipping=clipping)
    screen = np.ascontiguousarray(bins.screen[np.unique(bins.binned)])
    screen = screen[tables.materials["kind"][screen["material"]] != layouts.SHADOW_CATCHER]
    covered, layers = (np.zeros((height, width), dtype=np.int32) for _ in range(2))
    _COVER(screen, pixel_samples(N_SAMPLES), covered, layers)
    values, ids = _seen(tables, view, width, height, clipping, threads)
    faces = _faces(tables, view, ids, clipping, threads)
    barycentrics = np.full((height, width, 3), np.nan, dtype=np.float32)
    levels = np.full((height, width), np.nan, dtype=np.float32)
    _DESCRIBE(*tables, view.camera, *vertices, faces, barycentrics, levels)
    counts = np.bitwise_count(covered).astype(np.int32)
    upright = [np.ascontiguousarray(rows[::-1]) for rows in (counts, layers, faces, barycentrics, levels)]
    counts, layers, faces, barycentrics, levels = upright
    cut = _are_pieces(tables, vertices, screen)
    return Capture(screen, cut, counts, layers, channels(CHANNELS, values, ids), faces, barycentrics, levels)


def _seen(
    tables: SceneTables, view: View, width: int, height: int, clipping: str, threads: int
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    values, ids = empty_values(width, height)
    pipeline.draw_channels(tables, view, values, ids, threads=threads, clipping=clipping)
    return values, ids


def _faces(tables: SceneTables, view: View, ids: NDArray[np.int32], clipping: str, threads: int) -> NDArray[np.int32]:
    """(height, width, 2): instance and triangle; of exact shapes, whose triangles the ids do not name, as if they were meshes."""
    if (tables.instances["kind"] != layouts.MESH).any():
        instances = tables.instances.copy()
        instances["kind"] = layouts.MESH
        height, width = ids.shape[:2]
        _, ids = _seen(tables._replace(instances=instances), view, width, height, clipping, threads)
    return np.ascontiguousarray(ids[..., [0, 2]])


def _are_pieces(tables: SceneTables, vertices: pipeline.Vertices, screen: NDArray[np.void]) -> NDArray[np.bool_]:
    """(n,): which screen triangles do not have the corners of their whole triangle."""
    mesh = tables.meshes[tables.instances["mesh"][screen["instance"]]]
    corners = tables.triangles[mesh["triangle"] + screen["triangle"]] + vertices.first_vertex[screen["instance"]][:, None]
    whole = vertices.transformed[corners]
    with np.errstate(all="ignore"):
        x, y = (np.floor(whole[..., k] / whole[..., 3] * np.float32(SUBPIXELS) + np.float32(0.5)) for k in (0, 1))
    same = np.zeros(len(screen), dtype=bool)
    for order in ([0, 1, 2], [0, 2, 1]):  # assembly turns clockwise triangles over
        same |= ((screen["x"] == x[:, order]) & (screen["y"] == y[:, order])).all(axis=1)
    return ~(same & (whole[..., 3] > 0.0).all(axis=1))
