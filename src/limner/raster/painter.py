"""The painter's algorithm (FoCG 8.2.2, 12.4): what is far is drawn first, and what is near over it.

    order, note = painter.order(tables, camera)

Up to `MAX_SORTED` triangles the order comes from a BSP tree, and is right for surfaces that pierce each other or overlap in a circle, since
the tree cuts them. Beyond that triangles are sorted by the depth of their centroids, which is wrong here and there.

A fragment is drawn as its whole triangle within cuts, so that it has the triangle's own samples and shading, and two fragments share
no sample and leave none out. Its place in the order is its depth: opaque triangles are drawn over those before them, and transparent layers
are composited in the same order, with no other depth looked at.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door
from ..tables import layouts
from ..tables.layouts import ORTHOGRAPHIC, SceneTables
from . import bsp
from .bsp import BspTree
from .layouts import CUT, SCREEN_TRIANGLE, SUBPIXELS

__all__ = ["MAX_SORTED", "Order", "build_tree", "order", "ranked"]

MAX_SORTED = 10_000
"""Triangles after instancing that a BSP tree is built over."""

_FAR_OFF = 2.0**30  # subpixels beyond which nothing lies
_BY_CENTROID = "hidden surfaces: {} are sorted by the depth of their centroids, which is not right everywhere; the z-buffer is"

_RANK = Door(
    "limner.raster.bsp_kernel",
    "rank_triangles",
    (
        Array(layouts.INSTANCE, 1), Array(layouts.MESH_RANGES, 1), Array(np.int32, 2), Array(layouts.CAMERA, 1), Array(np.float32, 2),
        Array(np.int64, 1), Array(np.int32, 1), Array(np.float64, 3), Array(np.float64, 2), Array(np.int32, 2), Array(np.int32, 2),
        Array(np.int32, 2), Array(SCREEN_TRIANGLE, 1), Array(CUT, 1), Array(np.int64, 1),
    ),
    "the painter's order",
)  # fmt: skip


class Order(NamedTuple):
    """What to draw, from back to front.

    Attributes
    ----------
    triangles : (n,) int64
        Of all triangles of all instances, instance by instance; a triangle comes once for each of its fragments.
    fragments : (n,) int32
        Rows of the tree's fragments; -1: the whole triangle.
    tree : BspTree or None
        Where the fragments' cuts are; None: sorted by centroid.
    """

    triangles: NDArray[np.int64]
    fragments: NDArray[np.int32]
    tree: BspTree | None


def build_tree(tables: SceneTables) -> BspTree | None:
    """The tree that `order` needs, which no camera changes. None where there are too many triangles or they would be cut into too many."""
    counts = tables.meshes["n_triangles"][tables.instances["mesh"][tables.instances["mesh"] >= 0]]
    if int(counts.sum(dtype=np.int64)) > MAX_SORTED:
        return None
    return bsp.build(bsp.world_triangles(tables))


def order(tables: SceneTables, camera: NDArray[np.void], tree: BspTree | None = None) -> tuple[Order, str | None]:
    """A back-to-front order of a scene's triangles, and what a person should know about it.

    Parameters
    ----------
    tables : SceneTables
    camera : (1,) CAMERA
    tree : BspTree, optional
        From `build_tree`, if it is there already.
    """
    row = camera[0]
    position, gaze = row["position"].astype(np.float64), row["gaze"].astype(np.float64)
    tree = build_tree(tables) if tree is None else tree
    if tree is not None:
        eye = np.append(-gaze, 0.0) if row["kind"] == ORTHOGRAPHIC else np.append(position, 1.0)
        fragments = bsp.back_to_front(tree, eye)
        return Order(tree.members[tree.fragments[fragments, 2]], fragments, tree), None
    triangles = bsp.world_triangles(tables)
    with np.errstate(all="ignore"):
        depth = (triangles.mean(axis=1) - position) @ gaze
    # Of equal ones the first of the scene comes last, and so is seen, as with a z-buffer.
    nearest_last = np.argsort(depth, kind="stable")[::-1].astype(np.int64)
    n = len(triangles)
    what = f"{n} triangles (more than {MAX_SORTED})" if n > MAX_SORTED else f"{n} triangles that would be cut into too many parts"
    return Order(nearest_last, np.full(n, -1, dtype=np.int32), None), _BY_CENTROID.format(what)


def ranked(
    tables: SceneTables,
    camera: NDArray[np.void],
    vertices: tuple[NDArray[np.float32], NDArray[np.int64]],
    screen: NDArray[np.void],
    drawn: Order,
) -> tuple[NDArray[np.void], NDArray[np.void]]:
    """Screen triangles in the order of drawing, with their rank for depth, and the cuts between their fragments.

    Parameters
    ----------
    vertices : (n, 4) float32, (instances + 1,) int64
        What the vertex stage left, and where each instance's begin.
    screen : (n,) SCREEN_TRIANGLE
        In the scene's order, without gaps.

    Returns
    -------
    (m,) SCREEN_TRIANGLE, (k,) CUT
    """
    mesh = tables.instances["mesh"]
    counts = np.where(mesh >= 0, tables.meshes["n_triangles"][mesh], 0) if len(tables.meshes) else np.zeros(len(mesh), dtype=np.int64)
    first = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
    of_screen = first[screen["instance"]] + screen["triangle"]
    starts = np.searchsorted(of_screen, drawn.triangles, side="left")
    n_parts = np.searchsorted(of_screen, drawn.triangles, side="right") - starts
    # A triangle that was clipped has several parts; each is drawn where the triangle is.
    total = int(n_parts.sum())
    within = np.arange(total) - np.repeat(np.cumsum(n_parts) - n_parts, n_parts)
    sorted_screen = screen[np.repeat(starts, n_parts) + within]
    fragment_of = np.ascontiguousarray(np.repeat(drawn.fragments, n_parts))
    tree = drawn.tree or _NO_TREE
    n_cuts = int(tree.fragments[fragment_of, 3].sum(dtype=np.int64)) if drawn.tree is not None else 0
    cuts, used = np.zeros(n_cuts + total, dtype=CUT), np.zeros(1, dtype=np.int64)
    _RANK(
        tables.instances, tables.meshes, tables.triangles, camera, *vertices, fragment_of, tree.triangles, tree.planes, tree.fragments,
        _boxes(tree, camera), tree.cuts, sorted_screen, cuts, used,
    )  # fmt: skip
    return sorted_screen, cuts[: used[0]]


@np.errstate(all="ignore")
def _boxes(tree: BspTree, camera: NDArray[np.void]) -> NDArray[np.int32]:
    """(f, 4) int32: boxes around the fragments on the screen, a pixel wider than they are; without end where one passes the eye's plane."""
    if len(tree.fragments) == 0:
        return np.zeros((0, 4), dtype=np.int32)
    row = camera[0]
    position, corner, dx, dy, gaze = (row[name].astype(np.float64) for name in ("position", "corner", "dx", "dy", "gaze"))
    if row["kind"] == ORTHOGRAPHIC:
        x, y, _ = np.linalg.solve(np.column_stack([dx, dy, gaze]), (tree.points - position - corner).T)
    else:
        x, y, w = np.linalg.solve(np.column_stack([dx, dy, corner]), (tree.points - position).T)
        x, y = (np.where(w > 0.0, along / w, np.nan) for along in (x, y))
    places = np.column_stack([x, y]) * SUBPIXELS
    corners = np.arange(len(tree.fragments)).repeat(tree.fragments[:, 1])
    first = np.concatenate([[0], np.cumsum(tree.fragments[:, 1], dtype=np.int64)])
    places = places[np.arange(first[-1]) - first[corners] + tree.fragments[corners, 0]]
    low, high = (extreme.reduceat(places, first[:-1], axis=0) for extreme in (np.minimum, np.maximum))
    box = np.nan_to_num(np.column_stack([np.floor(low - SUBPIXELS), np.ceil(high + SUBPIXELS)]), nan=np.inf)
    box[np.isnan(low).any(axis=1), :2] = -np.inf
    return np.clip(box, -_FAR_OFF, _FAR_OFF).astype(np.int32)


_NO_TREE = BspTree(
    np.zeros((0, 3, 3)), np.zeros((0, 4)), np.zeros(0, dtype=np.int64), np.zeros((0, 3)), np.zeros((0, 6), dtype=np.int32),
    np.zeros((0, 3), dtype=np.int32), np.zeros((0, 4), dtype=np.int32),
)  # fmt: skip
