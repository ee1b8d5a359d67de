"""Reflections that are neither sharp nor matte (FoCG 13.4.4): where the reflected ray goes this time.

Two ways: the book's square, of a chosen width, at right angles to the mirrored ray; and the microfacets of a rough metal, drawn as the eye
sees them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.frame import frame_from_normal, to_local, to_world
from ..kernel.vec import ONE, ZERO, Color, Vec3, dot, normalize, reflect
from ..tables.layouts import MATTE_ONLY
from .layered import draw_layers, eval_layers, pdf_layers
from .lobes import Bsdf, Layers, with_layers, with_lobes
from .microfacet import eval_ggx
from .sample import pdf_microfacet, visible_normal

__all__ = ["FacetSample", "eval_facets", "pdf_facets", "sample_facets", "scatter_in_square", "without_facets"]

f32 = np.float32
_HALF = f32(0.5)


@kernel
def scatter_in_square(r: Vec3, n: Vec3, width: np.float32, u: np.float32, v: np.float32) -> Vec3:
    """r' = r + u u + v v, then of unit length, with u = -a/2 + xi a and v = -a/2 + xi' a (FoCG 13.4.4).

    What would lead below the surface is taken from the other side of the square: r points up, so one of the two does, too.
    """
    frame = frame_from_normal(r)
    aside = frame.tangent * ((u - _HALF) * width) + frame.bitangent * ((v - _HALF) * width)
    scattered = r + aside
    return normalize(scattered if dot(scattered, n) > ZERO else r - aside)


class FacetSample(NamedTuple):
    """A direction reflected by a microfacet, what radiance from there is multiplied by, and the density; 0: none."""

    wi: Vec3
    weight: Color
    pdf: np.float32


@kernel
def pdf_facets(bsdf: Bsdf, wo: Vec3, wi: Vec3) -> np.float32:
    """The density per steradian with which `sample_facets` draws wi."""
    return _pdf(bsdf, bsdf.layers, wo, wi)


@kernel
def _pdf(bsdf: Bsdf, layers: Layers | None, wo: Vec3, wi: Vec3) -> np.float32:
    if layers is not None:
        if bsdf.layered != 0:
            return pdf_layers(bsdf, wo, wi, True)
    return pdf_microfacet(bsdf.roughness2, bsdf.ns, wo, normalize(wo + wi))


@kernel
def eval_facets(bsdf: Bsdf, wo: Vec3, wi: Vec3) -> Color:
    """The part of `eval_bsdf` that rough mirrors reflect."""
    return _eval(bsdf, bsdf.layers, wo, wi)


@kernel
def _eval(bsdf: Bsdf, layers: Layers | None, wo: Vec3, wi: Vec3) -> Color:
    if layers is not None:
        if bsdf.layered != 0:
            return eval_layers(bsdf, wo, wi).facets
    return eval_ggx(bsdf.f0, bsdf.roughness2, bsdf.ns, wi, wo)


@kernel
def sample_facets(bsdf: Bsdf, wo: Vec3, u: np.float32, v: np.float32) -> FacetSample:
    """Draw a direction as the microfacets reflect wo (Heitz 2018)."""
    return _sample(bsdf, bsdf.layers, wo, u, v)


@kernel
def _sample(bsdf: Bsdf, layers: Layers | None, wo: Vec3, u: np.float32, v: np.float32) -> FacetSample:
    if layers is not None:
        if bsdf.layered != 0:
            wi = draw_layers(bsdf, wo, u, u, v, True)
            pdf = pdf_layers(bsdf, wo, wi, True)
            if pdf <= ZERO:
                return FacetSample(wi, Color(ZERO, ZERO, ZERO), ZERO)
            return FacetSample(wi, eval_layers(bsdf, wo, wi).facets * (ONE / pdf), pdf)
    frame = frame_from_normal(bsdf.ns)
    wi = reflect(-wo, to_world(frame, visible_normal(bsdf.roughness2, to_local(frame, wo), u, v)))
    pdf = pdf_facets(bsdf, wo, wi)
    if pdf <= ZERO or dot(wi, bsdf.ns) <= ZERO:
        return FacetSample(wi, Color(ZERO, ZERO, ZERO), ZERO)
    return FacetSample(wi, eval_ggx(bsdf.f0, bsdf.roughness2, bsdf.ns, wi, wo) * (ONE / pdf), pdf)


@kernel
def without_facets(bsdf: Bsdf) -> Bsdf:
    """The lobes less the microfacets, whose light is found by rays; of ambient light, what the base gets."""
    return _matte(bsdf, bsdf.layers)


@kernel
def _matte(bsdf: Bsdf, layers: Layers | None) -> Bsdf:
    if layers is not None:
        if bsdf.layered != 0:
            base = (bsdf.diffuse + layers.behind) * ((ONE - layers.shield) * bsdf.occlusion)
            return with_layers(with_lobes(bsdf, bsdf.ns, bsdf.diffuse, bsdf.f0, base), bsdf.layered | MATTE_ONLY, layers)
    base = bsdf.diffuse * ((ONE - bsdf.dielectric_f0) * bsdf.occlusion)
    return with_lobes(bsdf, bsdf.ns, bsdf.diffuse, Color(ZERO, ZERO, ZERO), base)
