"""Drawing directions as surfaces scatter: each lobe by its own shape, chosen in proportion to how much it reflects.

The contract: `sample_bsdf` returns a direction, the value of `eval_bsdf` for it (cosine included), and the density per steradian of having
drawn it by any lobe, which `pdf_bsdf` returns for any direction; value / pdf is the weight of the path. A pdf of zero means that nothing
was drawn. An ideal mirror has no density: `is_mirror` is set, and value is what reflected radiance is multiplied by, over the chance
that the mirror was chosen, with pdf 1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.elementary import TWO_PI, cos, power, safe_sqrt, sin, sqrt
from ..kernel.frame import frame_from_normal, to_local, to_world
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot, luminance, max_component, normalize, reflect
from ..kernel.warp import pdf_hemisphere_cosine, warp_disk, warp_hemisphere_cosine
from .bsdf import Bsdf, eval_bsdf
from .fresnel import schlick
from .layered import draw_layers, pdf_layers
from .lobes import Layers
from .microfacet import ggx_distribution

__all__ = ["BsdfSample", "is_matte", "pdf_bsdf", "pdf_microfacet", "sample_bsdf", "visible_normal"]

f32 = np.float32
_HALF, _FOUR = f32(0.5), f32(4.0)
_LEAST_ALPHA = f32(1e-3)


class BsdfSample(NamedTuple):
    """A scattered direction, unit; see the module for the contract."""

    wi: Vec3
    value: Color
    pdf: np.float32
    is_mirror: bool


class Shares(NamedTuple):
    """The chance of each lobe to be drawn from."""

    diffuse: np.float32
    highlight: np.float32
    microfacet: np.float32
    mirror: np.float32


@kernel
def _is_matte(bsdf: Bsdf) -> bool:
    return max_component(bsdf.f0) <= ZERO and max_component(bsdf.specular) <= ZERO and max_component(bsdf.mirror) <= ZERO


@kernel
def is_matte(bsdf: Bsdf) -> bool:
    """Whether a surface has the matte lobe alone: `sample_bsdf` asks for no choice then."""
    return bsdf.layered == 0 and _is_matte(bsdf)


@kernel
def _sample_matte(bsdf: Bsdf, u: np.float32, w: np.float32) -> BsdfSample:
    local = warp_hemisphere_cosine(u, w)
    pdf = pdf_hemisphere_cosine(local.z)
    return BsdfSample(to_world(frame_from_normal(bsdf.ns), local), bsdf.diffuse * pdf, pdf, False)


@kernel
def _shares(bsdf: Bsdf, wo: Vec3) -> Shares:
    diffuse, highlight, mirror = luminance(bsdf.diffuse), luminance(bsdf.specular), luminance(bsdf.mirror)
    microfacet = luminance(schlick(bsdf.f0, dot(bsdf.ns, wo))) if luminance(bsdf.f0) > ZERO else ZERO
    total = diffuse + highlight + microfacet + mirror
    if total <= ZERO:
        return Shares(ZERO, ZERO, ZERO, ZERO)
    scale = ONE / total
    return Shares(diffuse * scale, highlight * scale, microfacet * scale, mirror * scale)


@kernel
def _pdf_highlight(p: np.float32, n: Vec3, v: Vec3, h: Vec3) -> np.float32:
    """(p + 1)/2pi (n.h)^p / (4 v.h): half vectors as the highlight has them (Pharr and Humphreys, PBR 1st ed., 15.5)."""
    v_h = dot(v, h)
    return (p + ONE) / TWO_PI * power(max(dot(n, h), ZERO), p) / (_FOUR * v_h) if v_h > ZERO else ZERO


@kernel
def _pdf_phong(p: np.float32, n: Vec3, v: Vec3, wi: Vec3) -> np.float32:
    """(p + 1)/2pi (r.wi)^p about the reflection r of v (Lafortune and Willems 1994)."""
    return (p + ONE) / TWO_PI * power(max(dot(reflect(-v, n), wi), ZERO), p)


@kernel
def pdf_microfacet(alpha: np.float32, n: Vec3, v: Vec3, h: Vec3) -> np.float32:
    """G1(v) D(h) / (4 n.v): the visible normals (Heitz, *Sampling the GGX distribution of visible normals*, JCGT 7(4), 2018)."""
    n_v, n_h = dot(n, v), dot(n, h)
    if n_v <= ZERO or n_h <= ZERO:
        return ZERO
    a = max(alpha, _LEAST_ALPHA)
    alpha2 = a * a
    # G1 / (4 n.v) = 1 / (2 (n.v + sqrt(a^2 + (1 - a^2)(n.v)^2)))
    return _HALF * ggx_distribution(alpha2, min(n_h, ONE)) / (n_v + sqrt(alpha2 + (ONE - alpha2) * n_v * n_v))


@kernel
def _pdf(bsdf: Bsdf, shares: Shares, wo: Vec3, wi: Vec3) -> np.float32:
    n = bsdf.ns
    pdf = shares.diffuse * pdf_hemisphere_cosine(dot(n, wi))
    if shares.highlight > ZERO:
        if bsdf.exponent < ZERO:
            pdf = pdf + shares.highlight * _pdf_phong(-bsdf.exponent, n, wo, wi)
        else:
            pdf = pdf + shares.highlight * _pdf_highlight(bsdf.exponent, n, wo, normalize(wo + wi))
    if shares.microfacet > ZERO:
        pdf = pdf + shares.microfacet * pdf_microfacet(bsdf.roughness2, n, wo, normalize(wo + wi))
    return pdf


@kernel
def pdf_bsdf(bsdf: Bsdf, wo: Vec3, wi: Vec3) -> np.float32:
    """The density with which `sample_bsdf` draws wi, mirror apart."""
    return _pdf_of(bsdf, bsdf.layers, wo, wi)


@kernel
def _pdf_of(bsdf: Bsdf, layers: Layers | None, wo: Vec3, wi: Vec3) -> np.float32:
    if layers is not None:
        if bsdf.layered != 0:
            return pdf_layers(bsdf, wo, wi, False)
    if _is_matte(bsdf):
        return pdf_hemisphere_cosine(dot(bsdf.ns, wi))
    return _pdf(bsdf, _shares(bsdf, wo), wo, wi)


@kernel
def visible_normal(alpha: np.float32, v: Vec3, u: np.float32, w: np.float32) -> Vec3:
    """A microfacet normal as it is seen from v, both in the surface's frame (Heitz 2018, listing 1)."""
    a = max(alpha, _LEAST_ALPHA)
    stretched = normalize(Vec3(a * v.x, a * v.y, v.z))
    squared = stretched.x * stretched.x + stretched.y * stretched.y
    t1 = Vec3(-stretched.y, stretched.x, ZERO) * (ONE / sqrt(squared)) if squared > ZERO else Vec3(ONE, ZERO, ZERO)
    t2 = cross(stretched, t1)
    x, y = warp_disk(u, w)
    s = _HALF * (ONE + stretched.z)
    y = (ONE - s) * safe_sqrt(ONE - x * x) + s * y
    h = t1 * x + t2 * y + stretched * safe_sqrt(ONE - x * x - y * y)
    return normalize(Vec3(a * h.x, a * h.y, max(h.z, ZERO)))


@kernel
def _highlight_normal(p: np.float32, u: np.float32, w: np.float32) -> Vec3:
    """A half vector with density proportional to its cosine to the power p, in the surface's frame."""
    cos_theta = power(u, ONE / (p + ONE))
    sin_theta = safe_sqrt(ONE - cos_theta * cos_theta)
    return Vec3(sin_theta * cos(TWO_PI * w), sin_theta * sin(TWO_PI * w), cos_theta)


@kernel
def sample_bsdf(bsdf: Bsdf, wo: Vec3, choice: np.float32, u: np.float32, w: np.float32) -> BsdfSample:
    """Draw a direction for wo; `choice`, u and w are uniform in [0, 1)."""
    return _sample(bsdf, bsdf.layers, wo, choice, u, w)


@kernel
def _sample(bsdf: Bsdf, layers: Layers | None, wo: Vec3, choice: np.float32, u: np.float32, w: np.float32) -> BsdfSample:
    if layers is not None:
        if bsdf.layered != 0:
            wi = draw_layers(bsdf, wo, choice, u, w, False)
            return BsdfSample(wi, eval_bsdf(bsdf, wo, wi), pdf_layers(bsdf, wo, wi, False), False)
    if _is_matte(bsdf):
        return _sample_matte(bsdf, u, w)
    shares = _shares(bsdf, wo)
    black = Color(ZERO, ZERO, ZERO)
    n = bsdf.ns
    if choice < shares.mirror:
        return BsdfSample(reflect(-wo, n), bsdf.mirror * (ONE / shares.mirror), ONE, True)
    frame = frame_from_normal(n)
    rest = choice - shares.mirror
    if rest < shares.diffuse:
        wi = to_world(frame, warp_hemisphere_cosine(u, w))
    elif rest < shares.diffuse + shares.highlight:
        if bsdf.exponent < ZERO:
            wi = to_world(frame_from_normal(reflect(-wo, n)), _highlight_normal(-bsdf.exponent, u, w))
        else:
            wi = reflect(-wo, to_world(frame, _highlight_normal(bsdf.exponent, u, w)))
    elif shares.microfacet > ZERO:
        wi = reflect(-wo, to_world(frame, visible_normal(bsdf.roughness2, to_local(frame, wo), u, w)))
    else:
        return BsdfSample(n, black, ZERO, False)
    if dot(n, wi) <= ZERO:
        return BsdfSample(wi, black, ZERO, False)
    return BsdfSample(wi, eval_bsdf(bsdf, wo, wi), _pdf(bsdf, shares, wo, wi), False)
