"""The seen point: where ray tracing and rasterisation meet.

Both find *which* triangle a raster point sees; what is there is computed here, from the same vertices by the same operations, so
that both get the same bits. Barycentric coordinates come from the raster point and the vertices' homogeneous raster coordinates:
with the vertices taken relative to the point, ``q_i = (x_i - x w_i, y_i - y w_i)``, the ratios of the areas ``q_j x q_k`` are the
perspective-correct coordinates, also where a vertex lies behind the eye (Olano and Greer, *Triangle scan conversion using 2D
homogeneous coordinates*, 1997). Their derivatives by x and y give the footprint of the pixel in the texture.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..kernel.lanes import at, max, min, spread, where
from ..kernel.transform import transform_point, transform_vector
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot, normalize, spread3

__all__ = [
    "Barycentrics",
    "Detail",
    "Footprint",
    "SurfacePoint",
    "barycentrics_at",
    "barycentrics_of_hit",
    "flip_to_front",
    "no_detail",
    "surface_at",
    "to_raster",
    "transform_normal",
    "transformed_reach",
    "transposed_vector",
    "turned_over",
    "vertices_at",
    "with_normal",
]  # fmt: skip

f32 = np.float32
_NO_TANGENT = f32(0.0)


class Barycentrics(NamedTuple):
    """Weights of the three vertices and their derivatives along the picture's x and y, per pixel."""

    b0: np.float32
    b1: np.float32
    b2: np.float32
    db0dx: np.float32
    db1dx: np.float32
    db0dy: np.float32
    db1dy: np.float32


class Footprint(NamedTuple):
    """How the texture coordinates of set 0 and set 1 change from a pixel to its neighbour."""

    dudx: np.float32
    dvdx: np.float32
    dudy: np.float32
    dvdy: np.float32
    du1dx: np.float32
    dv1dx: np.float32
    du1dy: np.float32
    dv1dy: np.float32


class Detail(NamedTuple):
    """The point in the object's own space, where solid textures and heights are; zeros where no material of the instance asks."""

    p: Vec3
    n: Vec3  # outward, of any length
    dpdx: Vec3  # how p moves from pixel to pixel
    dpdy: Vec3
    gradient_u: Vec3  # du = gradient_u . dp along the surface; of texture coordinates 0
    gradient_v: Vec3


class SurfacePoint(NamedTuple):
    """A point of a surface, in world space."""

    position: Vec3
    n: Vec3  # geometric normal, unit, to the front
    ns: Vec3  # shading normal, unit, to the front
    tangent: Vec3  # along u; not unit, zero where there is none
    bitangent_sign: np.float32
    u: np.float32
    v: np.float32
    u1: np.float32
    v1: np.float32
    color: Color  # vertex colour
    alpha: np.float32
    footprint: Footprint
    material: int
    bulge: Vec3  # from the flat triangle to the smooth surface that its normals tell of; where shadow rays start
    reach: np.float32  # the greatest number its position was computed from: rounding errors are measured by it
    detail: Detail


# --- transforms -----------------------------------------------------------------------------------------------------------


@kernel
def transformed_reach(m, x: np.float32, y: np.float32, z: np.float32) -> np.float32:
    """The greatest number that occurs in M p for points with coordinates up to x, y, z."""
    row0 = abs(m[0, 0]) * x + abs(m[0, 1]) * y + abs(m[0, 2]) * z + abs(m[0, 3])
    row1 = abs(m[1, 0]) * x + abs(m[1, 1]) * y + abs(m[1, 2]) * z + abs(m[1, 3])
    row2 = abs(m[2, 0]) * x + abs(m[2, 1]) * y + abs(m[2, 2]) * z + abs(m[2, 3])
    return max(row0, max(row1, row2))


@kernel
def transposed_vector(m, v: Vec3) -> Vec3:
    """M^T v for the linear part of a (3, 4) or (3, 3) matrix: takes normals and gradients the way back."""
    return Vec3(
        m[0, 0] * v.x + m[1, 0] * v.y + m[2, 0] * v.z,
        m[0, 1] * v.x + m[1, 1] * v.y + m[2, 1] * v.z,
        m[0, 2] * v.x + m[1, 2] * v.y + m[2, 2] * v.z,
    )


@kernel
def transform_normal(instance, n: Vec3) -> Vec3:
    """The unit normal in the world, by the cofactor matrix (FoCG 6.2.2)."""
    return normalize(transform_vector(instance["world_from_normal"], n))


@kernel
def to_raster(raster_from_object, instance: int, p: Vec3):
    """(x w, y w, depth, w) of an object-space point: homogeneous raster coordinates, and its distance along the gaze."""
    m = raster_from_object
    k = instance
    return (
        m[k, 0, 0] * p.x + m[k, 0, 1] * p.y + m[k, 0, 2] * p.z + m[k, 0, 3],
        m[k, 1, 0] * p.x + m[k, 1, 1] * p.y + m[k, 1, 2] * p.z + m[k, 1, 3],
        m[k, 2, 0] * p.x + m[k, 2, 1] * p.y + m[k, 2, 2] * p.z + m[k, 2, 3],
        m[k, 3, 0] * p.x + m[k, 3, 1] * p.y + m[k, 3, 2] * p.z + m[k, 3, 3],
    )


# --- barycentric coordinates ----------------------------------------------------------------------------------------------


@kernel
def barycentrics_at(x: np.float32, y: np.float32, v0, v1, v2) -> Barycentrics:
    """Perspective-correct barycentric coordinates of raster point (x, y) in the triangle of homogeneous raster vertices."""
    q0x, q0y = v0[0] - x * v0[3], v0[1] - y * v0[3]
    q1x, q1y = v1[0] - x * v1[3], v1[1] - y * v1[3]
    q2x, q2y = v2[0] - x * v2[3], v2[1] - y * v2[3]
    e0 = q1x * q2y - q1y * q2x
    e1 = q2x * q0y - q2y * q0x
    e2 = q0x * q1y - q0y * q1x
    total = e0 + e1 + e2
    inverse = where(total != ZERO, ONE / where(total != ZERO, total, ONE), ZERO)
    # d q_i/dx = (-w_i, 0), d q_i/dy = (0, -w_i)
    de0dx, de0dy = q1y * v2[3] - v1[3] * q2y, v1[3] * q2x - q1x * v2[3]
    de1dx, de1dy = q2y * v0[3] - v2[3] * q0y, v2[3] * q0x - q2x * v0[3]
    de2dx, de2dy = q0y * v1[3] - v0[3] * q1y, v0[3] * q1x - q0x * v1[3]
    dtdx, dtdy = de0dx + de1dx + de2dx, de0dy + de1dy + de2dy
    b0, b1 = e0 * inverse, e1 * inverse
    return Barycentrics(
        b0,
        b1,
        (ONE - b0) - b1,
        (de0dx - b0 * dtdx) * inverse,
        (de1dx - b1 * dtdx) * inverse,
        (de0dy - b0 * dtdy) * inverse,
        (de1dy - b1 * dtdy) * inverse,
    )


@kernel
def barycentrics_of_hit(u: np.float32, v: np.float32) -> Barycentrics:
    """Barycentric coordinates (1 - u - v, u, v) of a ray's hit, with no footprint."""
    return Barycentrics((ONE - u) - v, u, v, ZERO, ZERO, ZERO, ZERO)


# --- the point ------------------------------------------------------------------------------------------------------------


@kernel
def _corners(triangles, row: int):
    return at(triangles, (row, 0)), at(triangles, (row, 1)), at(triangles, (row, 2))


@kernel
def _position(positions, row: int) -> Vec3:
    return Vec3(at(positions, (row, 0)), at(positions, (row, 1)), at(positions, (row, 2)))


@kernel
def _direction(attributes, place: int) -> Vec3:
    return Vec3(at(attributes, place), at(attributes, place + 1), at(attributes, place + 2))


@kernel
def _mix3(a: Vec3, b: Vec3, c: Vec3, w: Barycentrics) -> Vec3:
    return a * w.b0 + b * w.b1 + c * w.b2


@kernel
def _mix(attributes, p0: int, p1: int, p2: int, w: Barycentrics) -> np.float32:
    return at(attributes, p0) * w.b0 + at(attributes, p1) * w.b1 + at(attributes, p2) * w.b2


@kernel
def _change(attributes, p0: int, p1: int, p2: int, db0: np.float32, db1: np.float32) -> np.float32:
    """The derivative of an attribute along a direction in which b0, b1 change so, and b2 = 1 - b0 - b1."""
    last = at(attributes, p2)
    return (at(attributes, p0) - last) * db0 + (at(attributes, p1) - last) * db1


@kernel
def _between(now: Vec3, later: Vec3, share: np.float32) -> Vec3:
    """What is on its way from one key to the next."""
    return now + (later - now) * share


@kernel
def vertices_at(positions, triangles, instance, mesh, triangle: int, meshes, exact):
    """The three vertices of a triangle in object space; of a mesh that bends, at the instance's time.

    Among `meshes` the next key of a mesh that bends stands behind the one that is past. `exact`: None, known to the compiler, in doors that
    meet nothing that moves (`accel.walk.exact_tables`).
    """
    i0, i1, i2 = _corners(triangles, mesh["triangle"] + triangle)
    start = mesh["position"]
    o0, o1, o2 = _position(positions, start + i0), _position(positions, start + i1), _position(positions, start + i2)
    if exact is not None:
        if instance["key"] > 0:
            start, share = meshes[instance["mesh"] + 1]["position"], instance["share"]
            o0 = _between(o0, _position(positions, start + i0), share)
            o1 = _between(o1, _position(positions, start + i1), share)
            o2 = _between(o2, _position(positions, start + i2), share)
    return o0, o1, o2


@kernel
def _normals_at(attributes, instance, mesh, p0: int, p1: int, p2: int, meshes, exact):
    """The normals at three places of the attributes, as `vertices_at`."""
    n0, n1, n2 = _direction(attributes, p0), _direction(attributes, p1), _direction(attributes, p2)
    if exact is not None:
        if instance["key"] > 0:
            on, share = meshes[instance["mesh"] + 1]["normal"] - mesh["normal"], instance["share"]
            n0 = _between(n0, _direction(attributes, p0 + on), share)
            n1 = _between(n1, _direction(attributes, p1 + on), share)
            n2 = _between(n2, _direction(attributes, p2 + on), share)
    return n0, n1, n2


@kernel
def surface_at(scene_geometry, instance, mesh, triangle: int, w: Barycentrics, meshes, exact) -> SurfacePoint:
    """The surface point of an instance's triangle at barycentric coordinates w (FoCG 8.1.2, 10.2.2).

    `scene_geometry` is (positions, triangles, attributes, slots); `triangle` counts from the mesh's first; `meshes` and `exact` as of
    `vertices_at`.
    """
    positions, triangles, attributes, slots = scene_geometry
    i0, i1, i2 = _corners(triangles, mesh["triangle"] + triangle)
    o0, o1, o2 = vertices_at(positions, triangles, instance, mesh, triangle, meshes, exact)
    m = instance["world_from_object"]
    position = transform_point(m, _mix3(o0, o1, o2, w))
    greatest = transformed_reach(
        m,
        max(abs(o0.x), max(abs(o1.x), abs(o2.x))),
        max(abs(o0.y), max(abs(o1.y), abs(o2.y))),
        max(abs(o0.z), max(abs(o1.z), abs(o2.z))),
    )
    reach = spread(greatest, w.b0)
    a, b = o1 - o0, o2 - o0
    n = spread3(transform_normal(instance, cross(a, b)), w.b0)

    zero = spread(ZERO, w.b0)
    ns, tangent, sign, bulge = n, Vec3(zero, zero, zero), spread(ONE, w.b0), Vec3(zero, zero, zero)
    if mesh["normal"] >= 0:
        k0, k1, k2 = i0, i1, i2
        if mesh["normal_triangle"] >= 0:
            k0, k1, k2 = _corners(triangles, mesh["normal_triangle"] + triangle)
        p = mesh["normal"]
        n0, n1, n2 = _normals_at(attributes, instance, mesh, p + 3 * k0, p + 3 * k1, p + 3 * k2, meshes, exact)
        ns = transform_normal(instance, _mix3(n0, n1, n2, w))
        bulge = transform_vector(m, _bulge(_mix3(o0, o1, o2, w), o0, o1, o2, n0, n1, n2, w))
        ns = where(dot(ns, ns) > f32(0.5), ns, n)
        if mesh["tangent"] >= 0:
            p = mesh["tangent"]
            p0, p1, p2 = p + 4 * k0, p + 4 * k1, p + 4 * k2
            along = _mix3(_direction(attributes, p0), _direction(attributes, p1), _direction(attributes, p2), w)
            if exact is not None:
                if instance["key"] > 0:
                    on = meshes[instance["mesh"] + 1]["tangent"] - p
                    later = _mix3(_direction(attributes, p0 + on), _direction(attributes, p1 + on), _direction(attributes, p2 + on), w)
                    along = _between(along, later, instance["share"])
            tangent = transform_vector(m, along)
            sign = where(at(attributes, p + 4 * k0 + 3) < ZERO, -ONE, ONE)
            sign = -sign if instance["flipped"] != 0 else sign

    u, v, u1, v1 = zero, zero, zero, zero
    footprint = Footprint(zero, zero, zero, zero, zero, zero, zero, zero)
    if mesh["uv"] >= 0:
        k0, k1, k2 = i0, i1, i2
        if mesh["uv_triangle"] >= 0:
            k0, k1, k2 = _corners(triangles, mesh["uv_triangle"] + triangle)
        p = mesh["uv"]
        p0, p1, p2 = p + 2 * k0, p + 2 * k1, p + 2 * k2
        u, v = _mix(attributes, p0, p1, p2, w), _mix(attributes, p0 + 1, p1 + 1, p2 + 1, w)
        dudx, dvdx = _change(attributes, p0, p1, p2, w.db0dx, w.db1dx), _change(attributes, p0 + 1, p1 + 1, p2 + 1, w.db0dx, w.db1dx)
        dudy, dvdy = _change(attributes, p0, p1, p2, w.db0dy, w.db1dy), _change(attributes, p0 + 1, p1 + 1, p2 + 1, w.db0dy, w.db1dy)
        if mesh["tangent"] < 0:
            tangent, sign = _tangent_of_triangle(m, a, b, attributes, p0, p1, p2)
        if mesh["uv1"] >= 0:
            p = mesh["uv1"]
            p0, p1, p2 = p + 2 * k0, p + 2 * k1, p + 2 * k2
            u1, v1 = _mix(attributes, p0, p1, p2, w), _mix(attributes, p0 + 1, p1 + 1, p2 + 1, w)
            du1dx, dv1dx = _change(attributes, p0, p1, p2, w.db0dx, w.db1dx), _change(attributes, p0 + 1, p1 + 1, p2 + 1, w.db0dx, w.db1dx)
            du1dy, dv1dy = _change(attributes, p0, p1, p2, w.db0dy, w.db1dy), _change(attributes, p0 + 1, p1 + 1, p2 + 1, w.db0dy, w.db1dy)
            footprint = Footprint(dudx, dvdx, dudy, dvdy, du1dx, dv1dx, du1dy, dv1dy)
        else:
            footprint = Footprint(dudx, dvdx, dudy, dvdy, zero, zero, zero, zero)

    alpha = spread(ONE, w.b0)
    color = Color(alpha, alpha, alpha)
    if mesh["color"] >= 0:
        p = mesh["color"]
        p0, p1, p2 = p + 4 * i0, p + 4 * i1, p + 4 * i2
        r, g = _mix(attributes, p0, p1, p2, w), _mix(attributes, p0 + 1, p1 + 1, p2 + 1, w)
        color = Color(r, g, _mix(attributes, p0 + 2, p1 + 2, p2 + 2, w))
        alpha = _mix(attributes, p0 + 3, p1 + 3, p2 + 3, w)

    material = spread(np.int64(instance["material"]), w.b0)
    if mesh["slot"] >= 0:
        material = material + at(slots, mesh["slot"] + triangle)
    detail = no_detail(w.b0)
    if instance["detailed"] != 0:
        detail = _detail_of_triangle(scene_geometry, instance, mesh, triangle, w, meshes, exact)
    return SurfacePoint(position, n, ns, tangent, sign, u, v, u1, v1, color, alpha, footprint, material, bulge, reach, detail)


@kernel
def no_detail(like: np.float32) -> Detail:
    """The detail that nobody asks for, of one point or of eight."""
    zero = spread(ZERO, like)
    none = Vec3(zero, zero, zero)
    return Detail(none, none, none, none, none, none)


@outlined
def _detail_of_triangle(scene_geometry, instance, mesh, triangle: int, w: Barycentrics, meshes, exact) -> Detail:
    """What solid textures and bump maps ask of a point of a triangle.

    The gradient of a linear function on the triangle with edges a and b, along which it grows by f and g, is
    ``(f (b x n) + g (n x a)) / n.n`` with ``n = a x b``.
    """
    positions, triangles, attributes, _ = scene_geometry
    i0, i1, i2 = _corners(triangles, mesh["triangle"] + triangle)
    o0, o1, o2 = vertices_at(positions, triangles, instance, mesh, triangle, meshes, exact)
    a, b = o1 - o0, o2 - o0
    n = spread3(cross(a, b), w.b0)
    zero = spread(ZERO, w.b0)
    outward, gradient_u, gradient_v = n, Vec3(zero, zero, zero), Vec3(zero, zero, zero)
    if mesh["normal"] >= 0:
        k0, k1, k2 = i0, i1, i2
        if mesh["normal_triangle"] >= 0:
            k0, k1, k2 = _corners(triangles, mesh["normal_triangle"] + triangle)
        p = mesh["normal"]
        n0, n1, n2 = _normals_at(attributes, instance, mesh, p + 3 * k0, p + 3 * k1, p + 3 * k2, meshes, exact)
        mixed = _mix3(n0, n1, n2, w)
        outward = where(dot(mixed, mixed) > ZERO, mixed, n)
    if mesh["uv"] >= 0:
        k0, k1, k2 = i0, i1, i2
        if mesh["uv_triangle"] >= 0:
            k0, k1, k2 = _corners(triangles, mesh["uv_triangle"] + triangle)
        p = mesh["uv"]
        p0, p1, p2 = p + 2 * k0, p + 2 * k1, p + 2 * k2
        squared = dot(n, n)
        scale = where(squared > ZERO, ONE / where(squared > ZERO, squared, ONE), ZERO)
        along_b, along_a = spread3(cross(b, cross(a, b)), w.b0) * scale, spread3(cross(cross(a, b), a), w.b0) * scale
        u0, v0 = at(attributes, p0), at(attributes, p0 + 1)
        gradient_u = along_b * (at(attributes, p1) - u0) + along_a * (at(attributes, p2) - u0)
        gradient_v = along_b * (at(attributes, p1 + 1) - v0) + along_a * (at(attributes, p2 + 1) - v0)
    dpdx = (o0 - o2) * w.db0dx + (o1 - o2) * w.db1dx
    dpdy = (o0 - o2) * w.db0dy + (o1 - o2) * w.db1dy
    return Detail(_mix3(o0, o1, o2, w), outward, dpdx, dpdy, gradient_u, gradient_v)


@kernel
def _bulge(p: Vec3, o0: Vec3, o1: Vec3, o2: Vec3, n0: Vec3, n1: Vec3, n2: Vec3, w: Barycentrics) -> Vec3:
    """From a point of the triangle to the surface that its normals round: outwards only.

    A coarse mesh shades smoothly but shadows itself in facets where light grazes it; shadow rays that start on the rounded surface do not.
    **Source**: Hanika, *Hacking the shadow terminator*, Ray Tracing Gems II, 2021, ch. 4.
    """
    below0, below1, below2 = min(ZERO, dot(p - o0, n0)), min(ZERO, dot(p - o1, n1)), min(ZERO, dot(p - o2, n2))
    return -(n0 * (below0 * w.b0) + n1 * (below1 * w.b1) + n2 * (below2 * w.b2))


@kernel
def _tangent_of_triangle(m, a: Vec3, b: Vec3, attributes, p0: int, p1: int, p2: int):
    """The direction in which u grows, and whether v grows to its left (+1) or right (-1), constant over the triangle."""
    u0, v0 = at(attributes, p0), at(attributes, p0 + 1)
    du1, dv1 = at(attributes, p1) - u0, at(attributes, p1 + 1) - v0
    du2, dv2 = at(attributes, p2) - u0, at(attributes, p2 + 1) - v0
    area = du1 * dv2 - du2 * dv1
    sign = where(area < ZERO, -ONE, ONE)
    # Scaled by the sign alone: only the direction counts, and a degenerate area must not blow it up.
    return transform_vector(m, (a * dv2 - b * dv1) * sign), sign


@kernel
def with_normal(point: SurfacePoint, ns: Vec3) -> SurfacePoint:
    """The same point with another shading normal."""
    return SurfacePoint(
        point.position, point.n, ns, point.tangent, point.bitangent_sign, point.u, point.v, point.u1, point.v1, point.color, point.alpha,
        point.footprint, point.material, point.bulge, point.reach, point.detail,
    )  # fmt: skip


@kernel
def flip_to_front(point: SurfacePoint, wo: Vec3) -> SurfacePoint:
    """Turn both normals to the side that is seen; a shading normal that looks away stays on the geometric one's side."""
    from_front = dot(point.n, wo) >= ZERO
    n = where(from_front, point.n, -point.n)
    bulge = where(from_front, point.bulge, Vec3(ZERO, ZERO, ZERO))
    ns = where(dot(point.ns, n) >= ZERO, point.ns, -point.ns)
    return SurfacePoint(
        point.position, n, ns, point.tangent, point.bitangent_sign, point.u, point.v, point.u1, point.v1, point.color, point.alpha,
        point.footprint, point.material, bulge, point.reach, point.detail,
    )  # fmt: skip


@kernel
def turned_over(point: SurfacePoint) -> SurfacePoint:
    """The same point as it is seen from the other side."""
    return SurfacePoint(
        point.position, -point.n, -point.ns, point.tangent, point.bitangent_sign, point.u, point.v, point.u1, point.v1, point.color,
        point.alpha, point.footprint, point.material, Vec3(ZERO, ZERO, ZERO), point.reach, point.detail,
    )  # fmt: skip
