"""Light on a frosted surface, followed from facet to facet until it leaves, so that none is lost.

Rough glass is many small facets. A ray that one of them sends on may meet the next, and of light followed to one facet alone a surface of
roughness 1 keeps less than half. Here the ray walks: how far it gets above the facets is a lot, by how steep it is and by how high it
stands; where it meets a facet, that is one of those that it sees, and it is reflected or refracted by lot. A ray that is refracted goes on
below, where the surface is the same turned over. It leaves with all the light with which it came.

    height h in [-1, 1], evenly spread    C(h) = (h + 1) / 2
    a way out from h along d              G(h, d) = C(h)^L(d),    L(d) = (sqrt(1 + a^2 tan^2) / sign(d.n) - 1) / 2

L of a ray that goes down is below -1, so that it always meets something; one that goes up leaves with the chance G.

**Source**: Heitz, Hanika, d'Eon and Dachsbacher, *Multiple-scattering microfacet BSDFs with the Smith model*, SIGGRAPH 2016, eq. 20 to 24
and algorithms 1 to 3, with heights spread evenly. Our lots are hashes of the two numbers that choose the first facet.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import as_int, power, sqrt
from ..kernel.frame import frame_from_normal, to_local, to_world
from ..kernel.rng import combine, float_from_word, word
from ..kernel.vec import ONE, ZERO, Vec3, dot, normalize, reflect
from ..tables.layouts import COMPENSATED
from .dielectric import Interface, meet_interface, reflectance, refract
from .layer_row import layer_row
from .sample import visible_normal

__all__ = ["meet_surface", "walk_interface"]

f32, i64 = np.float32, np.int64
_HALF, _LEAST_ALPHA, _LEVEL, _UPRIGHT = f32(0.5), f32(1e-3), f32(1e-5), f32(0.99999)
_MOST_FACETS = 64


@kernel
def _slope_factor(alpha: np.float32, z: np.float32) -> np.float32:
    """L(d), of a ray of direction cosine z that is neither level nor upright."""
    return _HALF * (sqrt(ONE + alpha * alpha * (ONE - z * z) / (z * z)) / (ONE if z > ZERO else -ONE) - ONE)


@kernel
def _next_height(alpha: np.float32, z: np.float32, below: np.float32, lot: np.float32) -> np.float32:
    """C of the height at which a ray of direction cosine z meets the next facet, from where it is `below`; 2 where it leaves.

    The chance to get from C to C' without meeting any is ``(C / C')^L``.
    """
    if z > _UPRIGHT:
        return f32(2.0)
    if z < -_UPRIGHT:
        return lot * below
    if abs(z) < _LEVEL:
        return below
    factor = _slope_factor(alpha, z)
    if z > ZERO and lot >= ONE - power(below, factor):
        return f32(2.0)
    return min(below * power(ONE - lot, -ONE / factor), ONE)


@outlined
def walk_interface(
    kind: int, roughness2: np.float32, n: Vec3, ns: Vec3, d: Vec3, n_i: np.float32, n_t: np.float32, u: np.float32, v: np.float32
) -> Interface:
    """As `meet_interface`, but light is followed from facet to facet: one of the two ways, chosen by lot, carries all of it."""
    alpha = max(roughness2, _LEAST_ALPHA)
    up = ns if dot(ns, d) < ZERO else n
    frame = frame_from_normal(up)
    ray = to_local(frame, d)
    state = combine(word(i64(as_int(u))), i64(as_int(v)))
    below, above, here, there = ONE, True, n_i, n_t
    for facet in range(_MOST_FACETS):
        state = combine(state, i64(facet))
        below = _next_height(alpha, ray.z, below, float_from_word(state))
        if below > ONE:
            break
        if facet > 0:
            state = combine(state, i64(1))
            u = float_from_word(state)
            state = combine(state, i64(2))
            v = float_from_word(state)
        towards = -ray
        h = visible_normal(alpha, towards, u, v)
        cosine = dot(towards, h)
        onward, cos_t = refract(ray, h, here / there)
        state = combine(state, i64(3))
        if cosine <= ZERO or float_from_word(state) < reflectance(kind, cosine, cos_t, here, there):
            ray = normalize(reflect(ray, h)) if cosine > ZERO else ray
        else:
            # Below, the surface is the same turned over.
            ray, below, above = normalize(Vec3(onward.x, onward.y, -onward.z)), ONE - below, not above
            here, there = there, here
    if above:
        r = to_world(frame, ray)
        return Interface(r, ONE if dot(r, n) > ZERO else ZERO, d, ZERO)
    t = to_world(frame, Vec3(ray.x, ray.y, -ray.z))
    return Interface(reflect(d, up), ZERO, t, ONE if dot(t, n) < ZERO else ZERO)


@kernel
def meet_surface(
    material, roughness2: np.float32, n: Vec3, ns: Vec3, d: Vec3, n_i: np.float32, n_t: np.float32, u: np.float32, v: np.float32
) -> Interface:
    """Where a unit ray d goes at the surface of a medium: with what its facets lose, or with `energy_compensation` without."""
    return _meet(layer_row(material), material, roughness2, n, ns, d, n_i, n_t, u, v)


@kernel
def _meet(
    row, material, roughness2: np.float32, n: Vec3, ns: Vec3, d: Vec3, n_i: np.float32, n_t: np.float32, u: np.float32, v: np.float32
) -> Interface:
    if row is not None:
        if row["layers"] & COMPENSATED != 0 and roughness2 > ZERO:
            return walk_interface(material["fresnel"], roughness2, n, ns, d, n_i, n_t, u, v)
    return meet_interface(material["fresnel"], roughness2, n, ns, d, n_i, n_t, u, v)
