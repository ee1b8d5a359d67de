"""Where light passes from one medium into another: how much is reflected, and where the rest goes (FoCG 13.1).

Snell: ``n_i sin theta = n_t sin phi``. A ray d that meets a surface with normal n goes on along

    t = (n_i / n_t) (d - n (d.n)) - n sqrt(1 - (n_i / n_t)^2 (1 - (d.n)^2)),

and where the root has no real value there is no such ray: all light is reflected (total internal reflection).

A frosted surface is one of many small mirrors, of which the eye sees some: the ray meets one of these, drawn by how visible it is (Walter
et al., *Microfacet models for refraction through rough surfaces*, 2007; Heitz 2018), and what other facets hide on the way out is
Smith's G1.

Radiance that enters a denser medium is squeezed into a narrower cone: L / n^2 stays the same, so a ray that goes from n_i to n_t carries
back ``(n_i / n_t)^2`` of what it finds there.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.elementary import safe_sqrt, sqrt
from ..kernel.frame import frame_from_normal, to_local, to_world
from ..kernel.vec import ONE, ZERO, Vec3, dot, reflect
from ..tables.layouts import SCHLICK
from .fresnel import schlick_weight
from .sample import visible_normal

__all__ = ["Interface", "fresnel", "meet_interface", "refract", "reflectance", "straight_transmittance"]  # noqa: RUF022 - as told

f32 = np.float32
_HALF, _TWO, _LEAST_ALPHA = f32(0.5), f32(2.0), f32(1e-3)


@kernel
def refract(d: Vec3, n: Vec3, eta: np.float32) -> tuple[Vec3, np.float32]:
    """The refracted ray of a unit ray d that comes from where the unit normal n points, and its cosine; -1 if there is none.

    `eta` is n_i / n_t.
    """
    cos_i = -dot(d, n)
    squared = ONE - eta * eta * (ONE - cos_i * cos_i)
    if squared <= ZERO:
        return d, -ONE
    cos_t = sqrt(squared)
    return d * eta + n * (eta * cos_i - cos_t), cos_t


@kernel
def fresnel(cos_i: np.float32, cos_t: np.float32, n_i: np.float32, n_t: np.float32) -> np.float32:
    """The share of unpolarised light that is reflected: the mean of Fresnel's two polarisations."""
    across = (n_i * cos_i - n_t * cos_t) / (n_i * cos_i + n_t * cos_t)
    along = (n_t * cos_i - n_i * cos_t) / (n_t * cos_i + n_i * cos_t)
    return _HALF * (across * across + along * along)


@kernel
def reflectance(kind: int, cos_i: np.float32, cos_t: np.float32, n_i: np.float32, n_t: np.float32) -> np.float32:
    """The share that is reflected, exactly or by Schlick: ``R_0 + (1 - R_0) (1 - cos)^5``, R_0 = ((n_i - n_t) / (n_i + n_t))^2.

    The cosine is that on the side of the lower index. `cos_t` -1 tells of total reflection.
    """
    if cos_t < ZERO:
        return ONE
    if kind == SCHLICK:
        ratio = (n_i - n_t) / (n_i + n_t)
        r0 = ratio * ratio
        return r0 + (ONE - r0) * schlick_weight(cos_i if n_i <= n_t else cos_t)
    return fresnel(cos_i, cos_t, n_i, n_t)


@kernel
def straight_transmittance(kind: int, cosine: np.float32, n_i: np.float32, n_t: np.float32) -> np.float32:
    """The share that goes through, of light that is taken to go straight on: by its angle in the thinner medium, so never none."""
    low, high = min(n_i, n_t), max(n_i, n_t)
    eta = low / high
    cos_t = safe_sqrt(ONE - eta * eta * (ONE - cosine * cosine))
    return ONE - reflectance(kind, cosine, cos_t, low, high)


class Interface(NamedTuple):
    """The two ways on from a surface, unit, and what light from there is multiplied by; zero where a way is closed."""

    reflected: Vec3
    reflectance: np.float32
    transmitted: Vec3
    transmittance: np.float32  # without the squeeze (n_i / n_t)^2 and the tint


@kernel
def _unmasked(alpha2: np.float32, cosine: np.float32) -> np.float32:
    """Smith's G1 = 2 n.v / (n.v + sqrt(a^2 + (1 - a^2) (n.v)^2))."""
    return _TWO * cosine / (cosine + sqrt(alpha2 + (ONE - alpha2) * cosine * cosine))


@kernel
def meet_interface(
    kind: int, roughness2: np.float32, n: Vec3, ns: Vec3, d: Vec3, n_i: np.float32, n_t: np.float32, u: np.float32, v: np.float32
) -> Interface:
    """Where a unit ray d goes at a surface with geometric normal n and shading normal ns, both towards where it comes from.

    `roughness2` is GGX's alpha, 0 for a polished surface; u and v in [0, 1) choose the facet.
    """
    eta = n_i / n_t
    h = ns if dot(ns, d) < ZERO else n
    is_rough = roughness2 > ZERO
    alpha = max(roughness2, _LEAST_ALPHA)
    if is_rough:
        frame = frame_from_normal(h)
        h = to_world(frame, visible_normal(alpha, to_local(frame, -d), u, v))
    r = reflect(d, h)
    t, cos_t = refract(d, h, eta)
    if not is_rough and (dot(r, n) <= ZERO or (cos_t > ZERO and dot(t, n) >= ZERO)):
        # A shading normal that leans so far would send light to the wrong side.
        h = n
        r = reflect(d, h)
        t, cos_t = refract(d, h, eta)
    share = reflectance(kind, -dot(d, h), cos_t, n_i, n_t)
    up, down = dot(r, n), -dot(t, n)
    reflected, transmitted = share, ONE - share
    if is_rough:
        alpha2 = alpha * alpha
        reflected = reflected * _unmasked(alpha2, max(dot(r, ns), ZERO))
        transmitted = transmitted * _unmasked(alpha2, max(-dot(t, ns), ZERO))
    return Interface(r, reflected if up > ZERO else ZERO, t, transmitted if down > ZERO and cos_t > ZERO else ZERO)
