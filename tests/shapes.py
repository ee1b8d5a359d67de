"""Exact shapes for tests: rows as kernels read them, doors to what kernels answer, and the same shapes in float64 as an oracle.

The oracle is a function g(p), negative inside and positive outside, whose slope is about 1 where it vanishes. It shares nothing with
the kernels but the definition of the shape.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from compiled import door_of
from numpy.typing import ArrayLike, NDArray

from limner._door import Array
from limner._jit import kernel
from limner.intersect import layouts
from limner.intersect.csg import intersect_csg, is_inside
from limner.intersect.interval import ray_in
from limner.intersect.layouts import BOX, CONE, CYLINDER, DISK, PATCH, PLANE, QUADRIC, SPHERE, TORUS
from limner.intersect.shape import intersect_shape, shape_area, shape_at, shape_bounds, solid_spans
from limner.kernel.vec import Vec3
from limner.tables.layouts import INSTANCE

__all__ = [
    "along", "area", "at", "bounds", "contains", "csg_hits", "csg_inside", "hits", "oracle", "points", "quadric_numbers", "row",
    "spans", "stack",
]  # fmt: skip

F32, F64, I32 = np.float32, np.float64, np.int32
Numbers = NDArray[np.float64]
Rays = NDArray[np.float32]
Parts = NDArray[np.int32]
NOTHING = np.zeros(1, F32)


# --- doors ----------------------------------------------------------------------------------------------------------------


@kernel
def _spans(shapes, numbers, rays, out, parts):
    for k in range(rays.shape[0]):
        shape = shapes[k % shapes.shape[0]]
        o, d = Vec3(rays[k, 0], rays[k, 1], rays[k, 2]), Vec3(rays[k, 3], rays[k, 4], rays[k, 5])
        s = solid_spans(shape, numbers, ray_in(shape["object_from_world"], o, d))
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = s.t0, s.t1, s.t2, s.t3
        parts[k, 0], parts[k, 1], parts[k, 2], parts[k, 3] = s.part0, s.part1, s.part2, s.part3


@kernel
def _hits(shapes, numbers, rays, out, parts):
    for k in range(rays.shape[0]):
        o, d = Vec3(rays[k, 0], rays[k, 1], rays[k, 2]), Vec3(rays[k, 3], rays[k, 4], rays[k, 5])
        h = intersect_shape(shapes[k % shapes.shape[0]], numbers, o, d, rays[k, 6], rays[k, 7], rays[k, 8] > rays[k, 9])
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = h.t, h.u, h.v, h.facing
        parts[k, 0] = h.part


@kernel
def _points(shapes, numbers, rays, found, parts, out):
    for k in range(rays.shape[0]):
        o, d = Vec3(rays[k, 0], rays[k, 1], rays[k, 2]), Vec3(rays[k, 3], rays[k, 4], rays[k, 5])
        at = shape_at(shapes[k % shapes.shape[0]], numbers, o, d, found[k, 0], np.int64(parts[k, 0]), found[k, 1], found[k, 2])
        out[k, 0], out[k, 1], out[k, 2] = at.p.x, at.p.y, at.p.z
        out[k, 3], out[k, 4], out[k, 5] = at.n.x, at.n.y, at.n.z
        out[k, 6], out[k, 7], out[k, 8] = at.tangent.x, at.tangent.y, at.tangent.z
        out[k, 9], out[k, 10] = at.u, at.v
        out[k, 11], out[k, 12], out[k, 13] = at.gradient_u.x, at.gradient_u.y, at.gradient_u.z
        out[k, 14], out[k, 15], out[k, 16] = at.gradient_v.x, at.gradient_v.y, at.gradient_v.z


@kernel
def _measures(shapes, numbers, out):
    for k in range(shapes.shape[0]):
        low, high = shape_bounds(shapes[k], numbers)
        out[k, 0], out[k, 1], out[k, 2], out[k, 3], out[k, 4], out[k, 5] = low.x, low.y, low.z, high.x, high.y, high.z
        out[k, 6] = shape_area(shapes[k])


@kernel
def _csg_hits(solids, leaves, numbers, programs, rays, ends, out, parts):
    for k in range(rays.shape[0]):
        o, d = Vec3(rays[k, 0], rays[k, 1], rays[k, 2]), Vec3(rays[k, 3], rays[k, 4], rays[k, 5])
        h = intersect_csg(
            solids[k % solids.shape[0]], leaves, numbers, programs, o, d, rays[k, 6], rays[k, 7], rays[k, 8] > rays[k, 9], ends
        )
        out[k, 0], out[k, 1] = h.t, h.facing
        parts[k, 0], parts[k, 1], parts[k, 2] = h.leaf, h.part, h.flipped


@kernel
def _csg_inside(solids, leaves, numbers, programs, rays, ends, parts):
    for k in range(rays.shape[0]):
        p = Vec3(rays[k, 0], rays[k, 1], rays[k, 2])
        parts[k, 0] = 1 if is_inside(solids[k % solids.shape[0]], leaves, numbers, programs, p, ends) else 0


_SHAPES, _NUMBERS, _ROWS = Array(INSTANCE, 1), Array(F32, 1), Array(F32, 2)
_SOLIDS, _PROGRAMS, _ENDS, _PARTS = Array(INSTANCE, 1), Array(I32, 1), Array(F64, 2), Array(I32, 2)


def along(o: ArrayLike, d: ArrayLike, t_min: ArrayLike = 0.0, t_max: ArrayLike = np.inf, both_sides: ArrayLike = True) -> Rays:
    """(n, 10) float32: rays as the doors here take them."""
    o, d = np.atleast_2d(np.asarray(o, F32)), np.atleast_2d(np.asarray(d, F32))
    rays = np.zeros((max(len(o), len(d)), 10), F32)
    rays[:, :3], rays[:, 3:6], rays[:, 6], rays[:, 7], rays[:, 8] = o, d, t_min, t_max, both_sides
    return rays


def spans(shapes: NDArray[np.void], rays: Rays, numbers: ArrayLike = NOTHING) -> tuple[Numbers, Parts]:
    """(n, 4) float64 and (n, 4) int32: the ends of the spans and their parts; shape k is asked ray k, in turn."""
    out, parts = np.zeros((len(rays), 4)), np.zeros((len(rays), 4), I32)
    door_of(_spans, _SHAPES, _NUMBERS, _ROWS, _ENDS, _PARTS)(shapes, np.asarray(numbers, F32), rays, out, parts)
    return out, parts


def hits(shapes: NDArray[np.void], rays: Rays, numbers: ArrayLike = NOTHING) -> tuple[Rays, Parts]:
    """(n, 4) float32: t, u, v, facing; (n,) int32: the part."""
    out, parts = np.zeros((len(rays), 4), F32), np.zeros((len(rays), 1), I32)
    door_of(_hits, _SHAPES, _NUMBERS, _ROWS, _ROWS, _PARTS)(shapes, np.asarray(numbers, F32), rays, out, parts)
    return out, parts[:, 0]


def points(shapes: NDArray[np.void], rays: Rays, found: Rays, parts: Parts, numbers: ArrayLike = NOTHING) -> dict[str, Numbers]:
    """What stands in an ObjectPoint, in object space, at what `hits` found."""
    out = np.zeros((len(rays), 17), F32)
    parts = np.ascontiguousarray(parts[:, None])
    door_of(_points, _SHAPES, _NUMBERS, _ROWS, _ROWS, _PARTS, _ROWS)(shapes, np.asarray(numbers, F32), rays, found, parts, out)
    out = out.astype(F64)
    return {
        "p": out[:, :3], "n": out[:, 3:6], "tangent": out[:, 6:9], "uv": out[:, 9:11], "gradient_u": out[:, 11:14],
        "gradient_v": out[:, 14:],
    }  # fmt: skip


def _measured(shapes: NDArray[np.void], numbers: ArrayLike) -> Rays:
    out = np.zeros((len(shapes), 7), F32)
    door_of(_measures, _SHAPES, _NUMBERS, _ROWS)(shapes, np.asarray(numbers, F32), out)
    return out


def bounds(shapes: NDArray[np.void], numbers: ArrayLike = NOTHING) -> Rays:
    """(n, 6) float32: low and high corners in the world."""
    return _measured(shapes, numbers)[:, :6]


def area(shapes: NDArray[np.void], numbers: ArrayLike = NOTHING) -> Rays:
    """(n,) float32"""
    return _measured(shapes, numbers)[:, 6]


Solid = tuple[NDArray[np.void], Parts]


def _tables(solid: Solid) -> tuple[NDArray[np.void], NDArray[np.void], Parts, Numbers]:
    leaves, program = solid
    solids = np.zeros(1, INSTANCE)
    solids["n_leaves"], solids["n_program"] = len(leaves), len(program)
    return solids, leaves, np.asarray(program, I32), np.empty((len(leaves), layouts.ENDS_WIDTH))


def csg_hits(solid: Solid, rays: Rays, numbers: ArrayLike = NOTHING) -> tuple[Rays, Parts]:
    """(n, 2) float32: t, facing; (n, 3) int32: leaf, part, flipped. A solid is its leaves and its program."""
    solids, leaves, program, ends = _tables(solid)
    out, parts = np.zeros((len(rays), 2), F32), np.zeros((len(rays), 3), I32)
    door = door_of(_csg_hits, _SOLIDS, _SHAPES, _NUMBERS, _PROGRAMS, _ROWS, _ENDS, _ROWS, _PARTS)
    door(solids, leaves, np.asarray(numbers, F32), program, rays, ends, out, parts)
    return out, parts


def csg_inside(solid: Solid, p: ArrayLike, numbers: ArrayLike = NOTHING) -> NDArray[np.bool_]:
    """(n,) bool: whether points of the world are in the solid."""
    solids, leaves, program, ends = _tables(solid)
    rays = along(p, (1.0, 0.0, 0.0))
    parts = np.zeros((len(rays), 1), I32)
    door = door_of(_csg_inside, _SOLIDS, _SHAPES, _NUMBERS, _PROGRAMS, _ROWS, _ENDS, _PARTS)
    door(solids, leaves, np.asarray(numbers, F32), program, rays, ends, parts)
    return parts[:, 0] == 1


# --- rows -----------------------------------------------------------------------------------------------------------------


def row(
    kind: int, size: tuple[float, ...] = (), *, capped: bool = True, place: int = -1, world_from_object: ArrayLike | None = None
) -> NDArray[np.void]:
    """(1,) INSTANCE"""
    shape = np.zeros(1, INSTANCE)
    m = np.eye(4) if world_from_object is None else np.asarray(world_from_object, F64)
    shape["kind"], shape["capped"], shape["place"] = kind, capped, place
    shape["size"][0, : len(size)] = size
    shape["world_from_object"], shape["object_from_world"] = m[:3], np.linalg.inv(m)[:3]
    return shape


def stack(*rows: NDArray[np.void]) -> NDArray[np.void]:
    """Rows one after the other."""
    return np.concatenate(rows)


def quadric_numbers(coefficients: ArrayLike, low: ArrayLike, high: ArrayLike) -> Rays:
    """(16,) float32"""
    return np.concatenate([np.asarray(part, F32) for part in (coefficients, low, high)])


# --- the oracle -----------------------------------------------------------------------------------------------------------


def _box_oracle(p: Numbers, low: Numbers, high: Numbers) -> Numbers:
    return np.max(np.maximum(low - p, p - high), axis=-1)


def _quadric_value(c: Numbers, p: Numbers) -> Numbers:
    x, y, z = p[..., 0], p[..., 1], p[..., 2]
    return c[0] * x * x + c[1] * y * y + c[2] * z * z + c[3] * x * y + c[4] * x * z + c[5] * y * z + c[6] * x + c[7] * y + c[8] * z + c[9]


def oracle(shape: np.void, p: Numbers, numbers: ArrayLike = NOTHING, *, side_only: bool = False) -> Numbers:
    """g at points (…, 3) of the shape's own space; `side_only`: of the endless side of a cylinder, cone or quadric."""
    kind, size = int(shape["kind"]), shape["size"].astype(F64)
    y, around = p[..., 1], np.hypot(p[..., 0], p[..., 2])
    if kind == SPHERE:
        return np.linalg.norm(p, axis=-1) - size[0]
    if kind == PLANE:
        return y
    if kind == BOX:
        return _box_oracle(p, -size, size)
    if kind == TORUS:
        return np.hypot(around - size[0], y) - size[1]
    if kind == CYLINDER:
        side, caps = around - size[0], np.abs(y) - size[1] / 2
    elif kind == CONE:
        slope = (size[1] - size[0]) / size[2]
        side = (around - (size[0] + size[1]) / 2 - slope * y) / np.hypot(1.0, slope)
        caps = np.abs(y) - size[2] / 2
    elif kind == QUADRIC:
        own = np.asarray(numbers, F64)[shape["place"] : shape["place"] + 16]
        reach = np.abs(own[10:]).max()
        # Divided by the greatest term near the box, so that it is a length
        c = own[:10] * np.array([reach] * 6 + [1.0] * 3 + [1.0 / reach])
        side, caps = _quadric_value(own, p) / max(np.abs(c).max(), 1e-30), _box_oracle(p, own[10:13], own[13:])
    else:
        raise ValueError(f"no oracle for kind {kind} ({DISK}: disk, {PATCH}: patch)")
    return side if side_only else np.maximum(side, caps)


def contains(ends: Numbers, t: Numbers) -> NDArray[np.bool_]:
    """(n, m) bool: whether parameters (n, m) lie in the spans (n, 4)."""
    ends = ends[:, :, None]
    return ((ends[:, 0] <= t) & (t <= ends[:, 1])) | ((ends[:, 2] <= t) & (t <= ends[:, 3]))


def at(rays: Rays, t: Any) -> Numbers:
    """(n, m, 3) float64: the points of rays at parameters (n, m)."""
    rays = rays.astype(F64)
    return rays[:, None, :3] + np.asarray(t, F64)[:, :, None] * rays[:, None, 3:6]
