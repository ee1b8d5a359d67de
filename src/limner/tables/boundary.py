"""The boundary of a combination of solids as triangles: what the rasteriser draws of it.

Every point of it lies on the surface of a leaf, and a point of a leaf's surface belongs to it where stepping through makes a difference
to the program's answer. So the leaves are tessellated, and of their triangles the parts are kept where it does
(`limner.mesh.reshape.trim`), turned inside out where the step leads out:

    before = is the point just outside the leaf in the whole?      after = is the point just inside?
    kept where before != after; turned where the whole ends there

Leaves that share a place are crossed by the same step, and the first of them at which the answer changes has it, as rays have it
(`limner.intersect.csg`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..mesh.reshape.trim import Surface, refined, trimmed
from ..scene.primitive import Box, Cone, Cylinder, Plane, Primitive, Quadric, Sphere, Torus
from . import layouts

__all__ = ["boundary_of_leaf", "inside", "quadric_values"]

Floats = NDArray[np.float64]
Truths = NDArray[np.bool_]

_STEP = 1e-5  # through a surface, in units of the whole's extent


def quadric_values(quadric: Quadric, p: Floats) -> Floats:
    """(n,): its polynomial at points (n, 3)."""
    c = quadric.coefficients
    x, y, z = p.T
    squares = c[0] * x * x + c[1] * y * y + c[2] * z * z + c[3] * x * y + c[4] * x * z + c[5] * y * z
    return np.asarray(squares + c[6] * x + c[7] * y + c[8] * z + c[9])


def inside(geometry: Primitive, p: Floats) -> Truths:
    """(n,) bool: whether points (n, 3) of its own space are in a solid primitive."""
    x, y, z = p.T
    off_axis = np.hypot(x, z)
    if isinstance(geometry, Sphere):
        return np.asarray(x * x + y * y + z * z < geometry.radius**2)
    if isinstance(geometry, Plane):
        return np.asarray(y < 0.0)
    if isinstance(geometry, Box):
        return np.asarray((np.abs(p) < np.array(geometry.size) / 2.0).all(axis=1))
    if isinstance(geometry, Cylinder):
        return np.asarray((off_axis < geometry.radius) & (np.abs(y) < geometry.height / 2.0))
    if isinstance(geometry, Cone):
        share = 0.5 + y / geometry.height
        return np.asarray((off_axis < geometry.radius + (geometry.top_radius - geometry.radius) * share) & (np.abs(share - 0.5) < 0.5))
    if isinstance(geometry, Torus):
        return np.asarray(np.hypot(off_axis - geometry.major_radius, y) < geometry.minor_radius)
    assert isinstance(geometry, Quadric)
    in_box = ((p > np.array(geometry.low)) & (p < np.array(geometry.high))).all(axis=1)
    return np.asarray(in_box & (quadric_values(geometry, p) < 0.0))


def _holds(program: NDArray[np.int32], truths: Truths) -> Truths:
    """(n,) bool: what a program says of points whose leaves are told by truths (k, n)."""
    stack: list[Truths] = []
    for token in program.tolist():
        if token >= 0:
            stack.append(truths[token])
        elif token == layouts.COMPLEMENT:
            stack.append(~stack.pop())
        else:
            top = stack.pop()
            under = stack.pop()
            stack.append(under | top if token == layouts.UNION else under & top if token == layouts.INTERSECTION else under & ~top)
    return stack.pop()


def _owners(program: NDArray[np.int32], outer: Truths, inner: Truths) -> NDArray[np.int64]:
    """(n,): the first leaf at which the answer changes when leaf after leaf is crossed; -1 where it does not."""
    before = _holds(program, outer)
    crossed, owners = outer.copy(), np.full(len(before), -1)
    for k in range(len(outer)):
        crossed[k] = inner[k]
        changed = (owners < 0) & (outer[k] != inner[k])
        if changed.any():
            owners[changed & (_holds(program, crossed) != before)] = k
    return np.where(_holds(program, inner) != before, owners, -1)


def boundary_of_leaf(
    surface: Surface, number: int, geometries: list[Primitive], places: list[Floats], program: NDArray[np.int32], extent: float,
    longest: float, within: Floats,
) -> list[Surface]:  # fmt: skip
    """What of one leaf's surface is the whole's.

    Parameters
    ----------
    surface : Surface
        Of the leaf, in the space of the whole, its normals outwards.
    number : int
        Which leaf it is.
    geometries : list of primitives
    places : list of (4, 4) float64
        The whole's space to each leaf's own.
    program : (n,) int32
    extent : float
        Of the whole, by which steps are measured.
    longest : float
        Edges are made as short before the surface is cut.
    within : (2, 3) float64
        A box beyond which there is nothing of the whole.

    Returns
    -------
    list of Surface
        Two: as the leaf has it, and turned inside out.
    """

    def truths(p: Floats) -> Truths:
        return np.array([inside(shape, p @ m[:3, :3].T + m[:3, 3]) for shape, m in zip(geometries, places, strict=True)])

    def ends(corners: Floats) -> Truths:
        return belongs(corners, True)

    def begins(corners: Floats) -> Truths:
        return belongs(corners, False)

    def belongs(corners: Floats, turned: bool) -> Truths:
        lengths = np.linalg.norm(corners[:, 3:6], axis=1, keepdims=True)
        step = corners[:, 3:6] / np.where(lengths > 0.0, lengths, 1.0) * (_STEP * extent)
        outer, inner = truths(corners[:, :3] + step), truths(corners[:, :3] - step)
        outer[number], inner[number] = False, True
        before, after = _holds(program, outer), _holds(program, inner)
        made = before & ~after if turned else after & ~before
        shared = made & (np.delete(outer, number, axis=0) != np.delete(inner, number, axis=0)).any(axis=0)
        made[shared] = _owners(program, outer[:, shared], inner[:, shared]) == number
        return made

    fine = refined(surface, longest, within)
    kept, turned = trimmed(fine, begins), trimmed(fine, ends)
    around = turned.corners.copy()
    around[:, 3:6] *= -1.0
    return [kept, Surface(around, turned.triangles[:, ::-1])]
