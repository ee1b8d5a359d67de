"""Orthonormal frames: the z axis of a shading computation is the normal.

Warps and lobes are written about +z. A frame carries a direction there and back:

    wi = to_world(frame_from_normal(n), warp_hemisphere_cosine(u, v))
"""

from __future__ import annotations

from typing import NamedTuple

from .._jit import kernel
from .lanes import where
from .vec import ONE, ZERO, Vec3, dot

__all__ = ["Frame", "frame_from_normal", "to_local", "to_world"]


class Frame(NamedTuple):
    """Three unit vectors at right angles, right-handed: tangent x bitangent = normal."""

    tangent: Vec3
    bitangent: Vec3
    normal: Vec3


@kernel
def frame_from_normal(n: Vec3) -> Frame:
    """A frame about the unit vector n, without a branch; it jumps only where n.z changes its sign.

    **Source**: T. Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1), 2017, listing 3.
    """
    sign = where(n.z >= ZERO, ONE, -ONE)
    a = -ONE / (sign + n.z)
    b = n.x * n.y * a
    tangent = Vec3(ONE + sign * n.x * n.x * a, sign * b, -sign * n.x)
    bitangent = Vec3(b, sign + n.y * n.y * a, -n.y)
    return Frame(tangent, bitangent, n)


@kernel
def to_world(frame: Frame, v: Vec3) -> Vec3:
    """The vector whose coordinates in the frame are v."""
    return frame.tangent * v.x + frame.bitangent * v.y + frame.normal * v.z


@kernel
def to_local(frame: Frame, v: Vec3) -> Vec3:
    """The coordinates of v in the frame."""
    return Vec3(dot(v, frame.tangent), dot(v, frame.bitangent), dot(v, frame.normal))
