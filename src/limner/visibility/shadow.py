"""How much of a light reaches a point (FoCG 4.7): nothing through what is opaque, 1 - alpha through the rest.

Glass and water bend light, so what lies behind them gets it from elsewhere than from straight ahead, in patterns that are called caustics
and that only paths of light find. A ray tracer that wants light there all the same takes it to go straight on (`tinted`): dimmed by what
each surface reflects, coloured by the way through.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..accel.walk import first_hit, occluded
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, length, max_component, normalize
from ..shading.bsdf import alpha_at, tint_at
from ..shading.dielectric import straight_transmittance
from ..shading.layers import glass_share, sheet_veil
from ..shading.medium import cross_surface, filling, passed
from ..shading.surface import SurfacePoint
from .hit import hit_point
from .spawn import off_surface

__all__ = ["Seen", "aimed", "transmittance"]

f32 = np.float32
_INFINITY = f32(np.inf)
_BEFORE_LIGHT = f32(1.0 - 1e-4)
_MAX_SURFACES = 256  # that one ray goes through


class Seen(NamedTuple):
    """How much of a light is seen, and whether through what would have bent it."""

    share: Color
    through_glass: bool


@kernel
def _through_surface(material, tint: Color, media, before: int, after: int, cosine: np.float32) -> Color:
    """What is left of light that goes straight through the surface of a dielectric."""
    if before == after:
        return Color(ONE, ONE, ONE)
    share = straight_transmittance(material["fresnel"], cosine, media[before]["ior"], media[after]["ior"])
    return tint * share


@kernel
def _through_medium(media, inside: int, distance: np.float32) -> Color:
    """What is left after a way inside something; fog outside dims what is seen, not what lights."""
    row = filling(inside, media)
    return passed(media, row, distance) if row > 0 else Color(ONE, ONE, ONE)


@kernel
def aimed(o: Vec3, position: Vec3, wi: Vec3, distance: np.float32):
    """(direction, length) of a shadow ray from o, beside `position`, that stops short of a light, which may be a surface."""
    to_light = position + wi * distance - o
    return normalize(to_light), length(to_light) * _BEFORE_LIGHT


@kernel
def transmittance(
    scene, accelerator, media, inside: int, tinted: int, has_alpha: int, point: SurfacePoint, wi: Vec3, distance: np.float32, stack
) -> Seen:
    """The share of a light that reaches a point from direction wi; `inside`: the media in which the point lies."""
    instances, _, _, _, _, _, materials, _, textures, texels = scene
    o = off_surface(point, point.n) + point.bulge if dot(point.n, wi) >= ZERO else off_surface(point, -point.n)
    t_max = _INFINITY
    if distance < _INFINITY:
        # The origin has moved: aim anew.
        wi, t_max = aimed(o, point.position, wi, distance)
    if occluded(accelerator, instances, o, wi, ZERO, t_max, stack):
        return Seen(Color(ZERO, ZERO, ZERO), False)
    left, through_glass = Color(ONE, ONE, ONE), False
    if has_alpha == 0:
        return Seen(left, False)
    for _ in range(_MAX_SURFACES):
        hit = first_hit(accelerator, instances, o, wi, ZERO, t_max, True, stack)
        if hit.instance < 0:
            return Seen(left * _through_medium(media, inside, t_max), through_glass)
        point = hit_point(scene, accelerator, hit, o, wi)
        material = materials[point.material]
        left = left * _through_medium(media, inside, hit.t)
        if material["medium"] > 0:
            if tinted == 0:
                return Seen(Color(ZERO, ZERO, ZERO), False)
            crossing = cross_surface(inside, media, np.int64(material["medium"]), dot(point.n, wi) < ZERO)
            tint = tint_at(material, point, textures, texels)
            tint = tint * glass_share(material, point, textures, texels)
            left = left * _through_surface(material, tint, media, crossing.before, crossing.after, abs(dot(point.ns, wi)))
            inside, through_glass = crossing.inside, through_glass or crossing.before != crossing.after
        else:
            left = left * sheet_veil(material, point, wi, alpha_at(material, point, textures, texels), textures, texels)
        if max_component(left) <= ZERO:
            break
        t_max = t_max - hit.t
        o = off_surface(point, point.n if dot(point.n, wi) >= ZERO else -point.n)
    return Seen(left, through_glass)
