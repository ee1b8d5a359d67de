"""A bounding volume hierarchy (FoCG 12.3.2), split by the surface area heuristic.

A ray that hits a box may hit what is inside; a ray that misses it cannot. The tree halves the work again and again, and how well
depends on where it is split: the chance that a ray which hits a box also hits a part of it is the ratio of their surface areas
(Goldsmith and Salmon 1987), so the split with the least ``area x count`` on both sides is expected to cost least (MacDonald and
Booth 1990), found among 16 bins along each axis (Wald, *On fast construction of SAH-based bounding volume hierarchies*, 2007).

What many instances share, and what moves, has a tree in its own space, and is one primitive of the world's (`own_space`).
"""

from __future__ import annotations

import math
import mmap
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..errors import UnsupportedError
from ..intersect.csg_program import program_bounds
from ..tables import layouts as tables_layouts
from ..tables.layouts import BOX, CSG, DISK, MESH, PLANE, SPHERE, Instants, SceneTables
from ..tiles import run_all, thread_count
from .bending import bounds_of_keys, trees_of_keys
from .layouts import (
    CORNERS,
    FIRST_TREE,
    LINKS,
    NODE,
    NODE_WORDS,
    PACK_WORDS,
    PRIMITIVE,
    TAG_WORDS,
    TREE_LINK,
    Accelerator,
)  # fmt: skip
from .own_space import FEW_COPIES, groups_of, swept_bounds, widen_moving
from .presplit import split_boxes

__all__ = ["Kind", "build", "build_over", "build_over_triangles"]

Kind = Literal["bvh", "linear"]

_LEAF_SIZE = 8  # as many as are met at once
_LINE = 64  # bytes
_MANY, _PIECES = 1 << 15, 64  # triangles of a tree that is made in pieces; how many of them, or a few more
_I64 = Scalar(np.int64)
_NO_PRIMITIVES, _NO_ROWS = np.zeros(0, dtype=PRIMITIVE), np.zeros((0, 3), dtype=np.int32)

_GATHER = Door(
    "limner.accel.bvh_build",
    "gather_primitives",
    (
        Array(tables_layouts.INSTANCE, 1), Array(tables_layouts.MESH_RANGES, 1), Array(np.float32, 2), Array(np.int32, 2),
        Array(np.int32, 1), Array(tables_layouts.MATERIAL, 1), Array(np.int64, 1), _I64, _I64, Array(PRIMITIVE, 1),
        Array(np.float32, 2), Array(np.float32, 2),
    ),
    "gathering primitives",
)  # fmt: skip

_BUILD = Door(
    "limner.accel.bvh_build",
    "build_tree",
    (
        Array(np.float32, 1), Array(np.int32, 1), Array(NODE, 1), Array(np.int32, 2), Array(np.float32, 1), Array(np.float32, 1),
        Array(np.int32, 1), Array(np.float32, 1), _I64, _I64, Array(np.int64, 1),
    ),
    "the bounding volume hierarchy",
)

_TURN_BOUNDS = Door("limner.accel.bvh_build", "turn_bounds", (Array(np.float32, 2), Array(np.float32, 1)), "the boxes of a hierarchy")

_BOUND_TRIANGLES = Door(
    "limner.accel.bvh_build",
    "bound_triangles",
    (Array(np.float32, 2), Array(np.int32, 2), Array(np.float32, 1)),
    "the bounds of triangles",
)

_WIDEN = Door(
    "limner.accel.widen",
    "widen",
    (
        Array(NODE, 1), Array(PRIMITIVE, 1), Array(np.float32, 2), Array(np.int32, 2), Array(np.int32, 1), Array(np.int32, 1),
        Array(np.float32, 1), Array(np.int32, 1), Array(np.float32, 2), Array(np.int8, 2), Array(np.int32, 1), Array(np.int32, 1),
        Array(np.int32, 2), Array(np.int32, 2), Array(np.int64, 1),
    ),
    "widening the hierarchy",
)  # fmt: skip

_PACK = Door(
    "limner.accel.widen",
    "fill_packs",
    (Array(PRIMITIVE, 1), Array(np.float32, 2), Array(np.int32, 2), Array(np.int32, 1), Array(np.float32, 1), Array(np.int32, 1)),
    "gathering primitives in packs",
)

_BOUND = Door(
    "limner.accel.shape_bounds_kernel",
    "bound_shapes",
    (Array(tables_layouts.INSTANCE, 1), Array(np.float32, 1), Array(np.float32, 2)),
    "the bounds of exact shapes",
)


def build(
    tables: SceneTables, accelerator: Kind = "bvh", instants: Instants | None = None, few_copies: int = FEW_COPIES
) -> Accelerator:
    """Build an accelerator for a scene.

    Parameters
    ----------
    tables : SceneTables
    accelerator : "bvh" | "linear"
        Linear tries everything: slow, and the oracle of the tests. What moves has its tree all the same.
    instants : Instants, optional
        Where what moves is while the shutter is open.
    few_copies : int
        How many triangles are rather copied for each instance than shared by all.
    """
    few_copies = few_copies if accelerator == "bvh" else np.iinfo(np.int64).max
    groups = groups_of(tables, instants, few_copies)
    primitives, corners, bounds = _primitives(tables, groups)
    planes = _planes(tables)
    others, boxes = _exact_shapes(tables)
    if len(others):
        bounded = np.isfinite(boxes).all(axis=1)
        endless = ~bounded & ~np.isnan(boxes).any(axis=1)
        primitives, planes = np.concatenate([primitives, others[bounded]]), np.concatenate([planes, others[endless]])
        corners = np.concatenate([corners, np.zeros((int(bounded.sum()), 9), dtype=np.float32)])
        bounds = np.concatenate([bounds, boxes[bounded]])
    if instants is not None and len(instants.moving):
        widen_moving(primitives, bounds, tables, instants)
    if not groups:
        return build_over(primitives, corners, bounds, planes, accelerator)
    trees = [_trees_of_mesh(tables, int(rows[0]), _n_keys(tables, int(rows[0]), instants)) for rows in groups]
    return _with_trees((primitives, corners, bounds), planes, groups, trees, tables, instants)


def build_over_triangles(
    points: NDArray[np.float32],
    triangles: NDArray[np.int32],
    accelerator: Kind = "bvh",
    *,
    numbers: NDArray[np.int32] | None = None,
    spatial_splits: bool = False,
) -> Accelerator:
    """Build an accelerator over triangles alone, seen from both sides, that keeps no primitives: all that is said of them is in the packs.

    Parameters
    ----------
    points : (k, 3) float32
    triangles : (n, 3) int32
    accelerator : "bvh" | "linear"
    numbers : (n,) int32, optional
        What the triangles are known as; None: their rows.
    spatial_splits : bool
        Whether large ones stand in the tree in parts.
    """
    known = numbers
    if accelerator == "linear" or len(triangles) <= _LEAF_SIZE:
        tree = _list(_NO_PRIMITIVES, points, triangles, _NO_PRIMITIVES)
    else:
        if spatial_splits:
            corners = points[triangles]
            rows, bounds = split_boxes(corners.reshape(-1, 9), np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1))
            triangles, known = triangles[rows], rows.astype(np.int32) if known is None else known[rows]
            binary, order = _binary_tree(_turned(bounds), 0)
        else:
            binary, order = _binary_tree(_bounds_of(points, triangles), 0)
        tree = _wide_tree(_NO_PRIMITIVES, points, triangles, binary, order, _NO_PRIMITIVES, 0)
    if known is not None and len(known):
        names = tree.tags.reshape(-1, 2, TAG_WORDS // 2)[:, 1]
        names[:] = known[names]
    return tree


def build_over(
    primitives: NDArray[np.void],
    corners: NDArray[np.float32],
    bounds: NDArray[np.float32],
    planes: NDArray[np.void],
    accelerator: Kind = "bvh",
) -> Accelerator:
    """Build an accelerator over primitives that somebody gathered.

    Parameters
    ----------
    primitives : (n,) PRIMITIVE
    corners : (n, 9) float32
        The vertices of the triangles among them.
    bounds : (n, 6) float32
        Finite: low corner, high corner.
    planes : (k,) PRIMITIVE
        What has no bounds.
    accelerator : "bvh" | "linear"
    """
    if accelerator not in ("bvh", "linear"):
        raise UnsupportedError(f'accelerator must be "bvh" or "linear", got {accelerator!r}')
    n = len(primitives)
    if accelerator == "linear" or n <= _LEAF_SIZE:
        return _list(primitives, corners.reshape(-1, 3), _NO_ROWS, planes)
    return _hierarchy(primitives, corners, bounds, planes, 0)


def _list(
    primitives: NDArray[np.void], points: NDArray[np.float32], triangles: NDArray[np.int32], planes: NDArray[np.void]
) -> Accelerator:
    """Packs without a tree."""
    n = len(primitives) or len(triangles)
    packs, tags = _room_for_packs((n + 7) // 8)
    _PACK(primitives, points, triangles, np.arange(n, dtype=np.int32), packs, tags)
    return Accelerator(np.zeros(0, dtype=np.int32), packs, tags, primitives, planes)


def _hierarchy(
    primitives: NDArray[np.void], corners: NDArray[np.float32], bounds: NDArray[np.float32], planes: NDArray[np.void], n_trees: int
) -> Accelerator:
    """The tree over more primitives than fit into a pack, of which the first `n_trees` are trees."""
    binary, order = _binary_tree(_turned(bounds), n_trees)
    return _wide_tree(primitives, corners.reshape(-1, 3), _NO_ROWS, binary, order, planes, n_trees)


def _bounds_of(points: NDArray[np.float32], triangles: NDArray[np.int32]) -> NDArray[np.float32]:
    """(n, 8): the boxes of triangles as the builder wants them."""
    boxes = np.empty((len(triangles), 8), dtype=np.float32)
    _BOUND_TRIANGLES(points, triangles, boxes.reshape(-1))
    return boxes


def _turned(bounds: NDArray[np.float32]) -> NDArray[np.float32]:
    """(n, 8): boxes (n, 6) as the builder wants them."""
    boxes = np.empty((len(bounds), 8), dtype=np.float32)
    _TURN_BOUNDS(bounds, boxes.reshape(-1))
    return boxes


def _wide_tree(
    primitives: NDArray[np.void],
    points: NDArray[np.float32],
    triangles: NDArray[np.int32],
    binary: NDArray[np.void],
    order: NDArray[np.int32],
    planes: NDArray[np.void],
    n_trees: int,
) -> Accelerator:
    """The tree of eight for a tree of two over primitives, of which the first `n_trees` are trees; arguments as of `widen.widen`."""
    n_binary = len(binary)
    nodes = _aligned(NODE_WORDS * n_binary, np.int32)
    packs, tags = _room_for_packs(n_binary + 1)
    costs, splits = _borrowed((2 * n_binary, 7), np.float32), _borrowed((2 * n_binary, 8), np.int8)
    counts, firsts = _borrowed((2 * n_binary,), np.int32), _borrowed((2 * n_binary,), np.int32)
    waiting, slots = _borrowed((n_binary, 3), np.int32), np.empty((4, 16), dtype=np.int32)
    used = np.array([0, n_trees], dtype=np.int64)
    _WIDEN(binary, primitives, points, triangles, order, nodes, packs, tags, costs, splits, counts, firsts, waiting, slots, used)
    n_nodes, n_packs = (int(count) for count in used)
    nodes, packs, tags = _cut(nodes, NODE_WORDS * n_nodes), _cut(packs, PACK_WORDS * n_packs), _cut(tags, TAG_WORDS * n_packs)
    return Accelerator(nodes, packs, tags, primitives, planes)


def _binary_tree(boxes: NDArray[np.float32], n_trees: int) -> tuple[NDArray[np.void], NDArray[np.int32]]:
    """(k,) NODE: the tree of two over boxes (n, 8), of which the first `n_trees` are trees; and (n,) the order of its leaves.

    Of many, the upper part is made first, and what is below it on all threads, piece by piece: the same tree. `boxes` come into its order.
    """
    n = len(boxes)
    order, room = np.arange(n, dtype=np.int32), np.zeros(n, dtype=NODE)
    if n < _MANY or n_trees:
        return _subtree(boxes, order, room, _LEAF_SIZE, 0, n_trees).copy(), order
    upper = _subtree(boxes, order, room, n // _PIECES, 0, 0).copy()
    depths = np.zeros(len(upper), dtype=np.int64)
    for node, children in enumerate(upper["child"]):
        depths[children[children >= 0]] = depths[node] + 1
    pieces = [(node, side) for node, side in np.argwhere(upper["count"] > _LEAF_SIZE)]
    room, n_made = np.zeros(len(upper) + n, dtype=NODE), [0] * len(pieces)

    def part_of(k: int) -> tuple[int, int]:
        node, side = pieces[k]
        return -1 - int(upper["child"][node, side]), int(upper["count"][node, side])

    def build_piece(k: int) -> None:
        first, count = part_of(k)
        part, place = slice(first, first + count), len(upper) + first
        made = _subtree(boxes[part], order[part], room[place : place + count], _LEAF_SIZE, int(depths[pieces[k][0]]) + 1, 0)
        made["child"][made["child"] < 0] -= first
        n_made[k] = len(made)

    run_all(build_piece, range(len(pieces)), thread_count(None))
    # Each piece has fewer nodes than primitives, so moved to the front in their order none meets the next.
    end = len(upper)
    for k in sorted(range(len(pieces)), key=lambda k: part_of(k)[0]):
        place, (node, side) = len(upper) + part_of(k)[0], pieces[k]
        piece = room[end : end + n_made[k]]
        piece[:] = room[place : place + n_made[k]]
        piece["child"][piece["child"] >= 0] += end
        upper["child"][node, side], upper["count"][node, side] = end, 0
        end += n_made[k]
    room[: len(upper)] = upper
    room.resize(end, refcheck=False)
    return room, order


def _subtree(
    boxes: NDArray[np.float32], order: NDArray[np.int32], room: NDArray[np.void], leaf_size: int, above: int, n_trees: int
) -> NDArray[np.void]:
    """The tree over some boxes, in the first part of `room`."""
    used = np.array([0, n_trees], dtype=np.int64)
    _BUILD(boxes.reshape(-1), order, room, *_build_scratch(), leaf_size, above, used)
    return room[: int(used[0])]


def _build_scratch() -> tuple[NDArray[Any], ...]:
    """What waits, where its centres lie, bins and what is counted of them: see `bvh_build.build_tree`."""
    stack, ranges = np.empty((256, 4), dtype=np.int32), np.empty(8 * 257, dtype=np.float32)
    return stack, ranges, np.empty(416, dtype=np.float32), np.empty(48, dtype=np.int32), np.empty(16, dtype=np.float32)


def _single_node(
    primitives: NDArray[np.void], corners: NDArray[np.float32], bounds: NDArray[np.float32], planes: NDArray[np.void], n_trees: int
) -> Accelerator:
    """A root alone, over at most eight primitives, of which the first `n_trees` are trees: a child for each of these, one for the rest."""
    packs, tags = _room_for_packs(1)
    rest = np.arange(n_trees, len(primitives), dtype=np.int32)
    _PACK(primitives, corners.reshape(-1, 3), _NO_ROWS, rest, packs, tags)
    boxes = [*bounds[:n_trees], np.concatenate([bounds[rest, :3].min(axis=0), bounds[rest, 3:].max(axis=0)])] if len(rest) else [*bounds]
    node = _aligned(NODE_WORDS, np.int32)
    edges = np.repeat(np.array([np.inf, -np.inf], dtype=np.float32), 24).reshape(6, 8)
    edges[:, : len(boxes)] = np.transpose(boxes)
    node[:LINKS], node[LINKS:] = edges.ravel().view(np.int32), 0
    node[LINKS : LINKS + n_trees] = TREE_LINK - np.arange(n_trees)
    if len(rest):
        node[LINKS + n_trees] = -1 if (primitives["triangle"][rest] >= 0).all() else -2
    low, high = bounds[:, :3].min(axis=0), bounds[:, 3:].max(axis=0)
    node[CORNERS : CORNERS + 6] = np.concatenate([low, high]).view(np.int32)
    return Accelerator(node, packs, tags, primitives, planes)


def _rooted(
    primitives: NDArray[np.void], corners: NDArray[np.float32], bounds: NDArray[np.float32], planes: NDArray[np.void], n_trees: int
) -> Accelerator:
    """A tree that has a root, however little it is over."""
    make = _single_node if len(primitives) <= _LEAF_SIZE else _hierarchy
    return make(primitives, corners, bounds, planes, n_trees)


def _n_keys(tables: SceneTables, row: int, instants: Instants | None) -> int:
    """How many keys an instance's mesh has: 1, unless it bends while the shutter is open."""
    column = np.flatnonzero(instants.moving == row) if instants is not None else ()
    if instants is None or not len(column):
        return 1
    return int(instants.instances["key"][column[0] :: len(instants.moving)].max()) + 1


def _trees_of_mesh(tables: SceneTables, row: int, n_keys: int) -> list[Accelerator]:
    """The tree of an instance's mesh in its own space, as nobody's, for each of its keys; none where all of it is no numbers."""
    own = tables.instances[row : row + 1].copy()
    own["world_from_object"], own["flipped"] = np.eye(3, 4, dtype=np.float32), 0
    places = np.array([0, tables.meshes["n_triangles"][own["mesh"][0]]], dtype=np.int64)
    primitives, corners, bounds = _gathered(tables, own, places)
    if not len(primitives):
        return []
    keys = [corners]
    for _ in range(1, n_keys):
        own["mesh"] += 1
        _, corners, box = _gathered(tables, own, places)
        keys.append(corners)
        bounds[:, :3], bounds[:, 3:] = np.minimum(bounds[:, :3], box[:, :3]), np.maximum(bounds[:, 3:], box[:, 3:])
    tree = _rooted(primitives, keys[0], bounds, np.zeros(0, dtype=PRIMITIVE), 0)
    return trees_of_keys(tree, keys) if n_keys > 1 else [tree]


def _with_trees(
    resting: tuple[NDArray[np.void], NDArray[np.float32], NDArray[np.float32]],
    planes: NDArray[np.void],
    groups: list[NDArray[np.int64]],
    trees: list[list[Accelerator]],
    tables: SceneTables,
    instants: Instants | None,
) -> Accelerator:
    """The tree over what rests in the world and over the trees of meshes, and these behind it."""
    roots, boxes, sound = [], [], list[Accelerator]()
    for rows, keys in zip(groups, trees, strict=True):
        if keys:
            root = np.zeros(len(rows), dtype=PRIMITIVE)
            root["instance"], root["opaque"] = rows, keys[0].primitives["opaque"].any()
            root["triangle"] = len(sound)
            roots.append(root)
            boxes.append(swept_bounds(bounds_of_keys(keys), rows, tables, instants))
            sound.extend(keys)
    primitives, corners, bounds = resting
    standing, places = np.concatenate([*roots, primitives[:0]]), np.concatenate([*boxes, bounds[:0]])
    finite = np.isfinite(places).all(axis=1)
    standing, places = standing[finite], places[finite]
    if not len(standing):
        return build_over(primitives, corners, bounds, planes)
    n_trees = len(standing)
    kinds = standing["triangle"].copy()
    standing["triangle"] = FIRST_TREE
    world = _rooted(
        np.concatenate([standing, primitives]), np.concatenate([np.zeros((n_trees, 9), dtype=np.float32), corners]),
        np.concatenate([places, bounds]), planes, n_trees,
    )  # fmt: skip
    joined, firsts = _joined([world, *sound])
    world.primitives["triangle"][:n_trees] = FIRST_TREE - firsts[1:][kinds]
    return joined


def _joined(trees: list[Accelerator]) -> tuple[Accelerator, NDArray[np.int64]]:
    """Trees one after the other, their links moved on, with the primitives and planes of the first; and (n,) their roots' nodes."""
    n_nodes, n_packs = ([len(part) // words for part in parts] for parts, words in (
        ([tree.nodes for tree in trees], NODE_WORDS), ([tree.tags for tree in trees], TAG_WORDS),
    ))  # fmt: skip
    firsts, first_packs = np.cumsum([0, *n_nodes]), np.cumsum([0, *n_packs])
    nodes, (packs, tags) = _aligned(NODE_WORDS * int(firsts[-1]), np.int32), _room_for_packs(int(first_packs[-1]))
    for k, tree in enumerate(trees):
        part = nodes[NODE_WORDS * firsts[k] : NODE_WORDS * firsts[k + 1]]
        part[:] = tree.nodes
        links = part.reshape(-1, NODE_WORDS)[:, LINKS : LINKS + 8]
        links[links >= 0] += firsts[k]
        links[(links < 0) & (links > TREE_LINK)] -= 2 * first_packs[k]
        packs[PACK_WORDS * first_packs[k] : PACK_WORDS * first_packs[k + 1]] = tree.packs
        tags[TAG_WORDS * first_packs[k] : TAG_WORDS * first_packs[k + 1]] = tree.tags
    return Accelerator(nodes, packs, tags, trees[0].primitives, trees[0].planes), firsts[:-1]


def _room_for_packs(n: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    return _aligned(PACK_WORDS * n, np.float32), _aligned(TAG_WORDS * n, np.int32)


def _aligned(n: int, dtype: type) -> NDArray[Any]:
    """(n,) of four bytes each, from a cache line's start: what is met together is fetched together."""
    room = np.empty(n + _LINE // 4, dtype=dtype)
    start = -room.ctypes.data % _LINE // 4
    return room[start : start + n]


def _borrowed(shape: tuple[int, ...], dtype: type) -> NDArray[Any]:
    """Scratch that goes back to the system when it is let go of; what the C library frees, it may keep."""
    count = math.prod(shape)
    return np.frombuffer(mmap.mmap(-1, max(count, 1) * np.dtype(dtype).itemsize), dtype=dtype, count=count).reshape(shape)


def _cut(array: NDArray[Any], n: int) -> NDArray[Any]:
    """The first n numbers of what `_aligned` made; the room behind them is given back, without a copy. `array` is not to be used again."""
    room = array.base
    assert room is not None
    start = (array.ctypes.data - room.ctypes.data) // array.itemsize
    room.resize(start + n, refcheck=False)
    return room[start:]


def _visible(tables: SceneTables) -> NDArray[np.bool_]:
    """(n,) bool: which instances are themselves seen, and no leaves of others."""
    return np.asarray(tables.instances["owner"] == np.arange(len(tables.instances)))


def _planes(tables: SceneTables) -> NDArray[np.void]:
    """(k,) PRIMITIVE: the infinite planes."""
    found = np.flatnonzero((tables.instances["kind"] == PLANE) & _visible(tables))
    materials = tables.materials[tables.instances["material"][found]]
    planes = np.zeros(len(found), dtype=PRIMITIVE)
    planes["instance"], planes["triangle"] = found, -1
    planes["facing"] = materials["double_sided"] == 0
    planes["opaque"] = materials["alpha_mode"] == tables_layouts.OPAQUE
    return planes


def _exact_shapes(tables: SceneTables) -> tuple[NDArray[np.void], NDArray[np.float32]]:
    """The other exact shapes in the world: (n,) PRIMITIVE, (n, 6) bounds; without combinations of which nothing is left."""
    instances = tables.instances
    rows = np.flatnonzero((instances["kind"] >= DISK) & _visible(tables))
    found, boxes = np.zeros(len(rows), dtype=PRIMITIVE), np.zeros((len(rows), 6), dtype=np.float32)
    if not len(rows):
        return found, boxes
    all_boxes = np.full((len(instances), 6), np.nan, dtype=np.float32)
    _BOUND(instances, tables.attributes, all_boxes)
    for k, row in enumerate(rows):
        shape = instances[row]
        parts, boxes[k] = slice(row, row + 1), all_boxes[row]
        if shape["kind"] == CSG:
            parts = slice(shape["leaf"], shape["leaf"] + shape["n_leaves"])
            boxes[k] = program_bounds(tables.slots[shape["place"] : shape["place"] + shape["n_program"]], all_boxes[parts])
        materials = tables.materials[instances["material"][parts]]
        # One answer for a whole combination: all of it is seen from inside if any part of it is.
        found[k]["facing"] = (materials["double_sided"] == 0).all()
        found[k]["opaque"] = (materials["alpha_mode"] == tables_layouts.OPAQUE).all()
    found["instance"], found["triangle"] = rows, -2
    left = ~(boxes[:, :3] > boxes[:, 3:]).any(axis=1)
    return found[left], boxes[left]


def _primitives(
    tables: SceneTables, groups: list[NDArray[np.int64]]
) -> tuple[NDArray[np.void], NDArray[np.float32], NDArray[np.float32]]:
    """Triangles and spheres in the world, but those of `groups`, as `_gathered` gives them."""
    instances = tables.instances
    counts = np.zeros(len(instances), dtype=np.int64)
    solid = np.isin(instances["kind"], (MESH, BOX)) & (instances["mesh"] >= 0)  # the others may have a tessellation, or none
    counts[solid] = tables.meshes["n_triangles"][instances["mesh"][solid]]
    counts[(instances["kind"] == SPHERE) & _visible(tables)] = 1
    for rows in groups:
        counts[rows] = 0
    return _gathered(tables, instances, np.concatenate([[0], np.cumsum(counts)]).astype(np.int64))


def _gathered(
    tables: SceneTables, instances: NDArray[np.void], places: NDArray[np.int64]
) -> tuple[NDArray[np.void], NDArray[np.float32], NDArray[np.float32]]:
    """(n,) PRIMITIVE, (n, 9) vertices, (n, 6) bounds of instances' triangles and spheres; those that are no numbers are left out.

    Parameters
    ----------
    instances : (k,) INSTANCE
    places : (k + 1,) int64
        Where the primitives of each begin.
    """
    n = int(places[-1])
    primitives, corners = np.zeros(n, dtype=PRIMITIVE), np.zeros((n, 9), dtype=np.float32)
    bounds = np.zeros((n, 6), dtype=np.float32)
    _GATHER(
        instances, tables.meshes, tables.positions, tables.triangles, tables.slots, tables.materials, places, 0, len(instances),
        primitives, corners, bounds,
    )  # fmt: skip
    sound = np.isfinite(bounds).all(axis=1)
    if not sound.all():
        primitives, corners, bounds = primitives[sound], corners[sound], np.ascontiguousarray(bounds[sound])
    return primitives, corners, bounds
