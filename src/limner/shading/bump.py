"""Bump maps: the normals of a rough surface on a smooth one (FoCG 11.4; Blinn, *Simulation of wrinkled surfaces*, 1978).

A height h moves each point along the normal, to p + h n. The surface itself stays where it is; it only takes the normal that the moved
one would have: ``n - grad h``, with the gradient along the surface. How steep that is depends on lengths, so it is worked out in the
object's own space, where heights and shapes are measured alike, and taken to the world as normals are: an object twice as large has bumps
twice as high, and one that is squeezed has squeezed ones.

Heights are taken from the texture at four places around the point: a gradient of differences works for pictures, for patterns and for
three pictures at once. They are as far apart as a texel, a fraction of the finest octave, or the pixel, whichever is widest.

**Source**: Mikkelsen, *Surface gradient-based bump mapping framework*, 2020, sections 2 and 3; the curvature of the smooth surface, which
h would stretch, is left out as by Blinn (5).
"""

from __future__ import annotations

import numpy as np

from .._jit import outlined
from ..kernel.lanes import max, spread, where
from ..kernel.vec import ONE, ZERO, Vec3, dot, length, normalize
from ..tables.layouts import UV_MAPPING
from .surface import Detail, SurfacePoint, transposed_vector
from .texture import Place, place_in, sample_place

__all__ = ["bumped_normal", "height_gradient"]

f32 = np.float32
_QUARTER, _HALF = f32(0.25), f32(0.5)


@outlined
def height_gradient(texture, texels, place: Place) -> Vec3:
    """How the height, a texture's red channel, grows in object space; what it says across the surface is of no account.

    The heights are taken at the corners of a tetrahedron, (1, -1, -1), (-1, 1, -1), (-1, -1, 1) and (1, 1, 1) half steps away; on texture
    coordinates these are the corners of a square.
    """
    zero, d = spread(ZERO, place.u), place.detail
    du, dv, step = zero, zero, zero
    on_uv = texture["mapping"] == UV_MAPPING
    if on_uv:
        du = max(_HALF * max(abs(place.dudx), abs(place.dudy)), texture["bump_step"][0])
        dv = max(_HALF * max(abs(place.dvdx), abs(place.dvdy)), texture["bump_step"][1])
    else:
        step = max(_HALF * max(length(d.dpdx), length(d.dpdy)), texture["bump_step"][0])
    x, y, z = zero, zero, zero
    for k in range(4):
        cx, cy, cz = ONE if k == 0 or k == 3 else -ONE, ONE if k == 1 or k == 3 else -ONE, ONE if k >= 2 else -ONE
        at = Detail(d.p + Vec3(step * cx, step * cy, step * cz), d.n, d.dpdx, d.dpdy, d.gradient_u, d.gradient_v)
        here = Place(place.u + du * cx, place.v + dv * cy, place.dudx, place.dvdx, place.dudy, place.dvdy, at)
        c, _ = sample_place(texture, texels, here)
        x, y, z = x + c.r * cx, y + c.r * cy, z + c.r * cz
    if on_uv:
        # h_u grad u + h_v grad v
        return d.gradient_u * (x * _QUARTER / du) + d.gradient_v * (y * _QUARTER / dv)
    return Vec3(x, y, z) * (_QUARTER / step)


@outlined
def bumped_normal(material, instance, ns: Vec3, point: SurfacePoint, textures, texels) -> Vec3:
    """The shading normal ns of a point, bent as a height bends the surface; seen from behind, bumps are dents."""
    texture = textures[material["bump_texture"]]
    slope = height_gradient(texture, texels, place_in(texture, point))
    n = normalize(transposed_vector(instance["world_from_object"], ns))
    side = where(dot(n, point.detail.n) < ZERO, -ONE, spread(ONE, n.x))
    slope = slope - n * dot(n, slope)
    bent = normalize(transposed_vector(instance["object_from_world"], n - slope * (side * material["bump_scale"])))
    return where(dot(bent, bent) > ZERO, bent, ns)
