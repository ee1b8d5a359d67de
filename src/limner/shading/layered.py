"""Base, film, fibres and coat, one over the other, and their sum.

    coat        a rough mirror of index 1.5, with normals of its own              KHR_materials_clearcoat
    sheen       fibres                                                            KHR_materials_sheen
    facets      reflect by Schlick, or as metals or films do; stretched or not    KHR_materials_specular, _anisotropy, _iridescence
    base        matte, or rough and matte                                         KHR_materials_diffuse_transmission, _transmission

What a layer sends back does not reach those below: under facets light is dimmed by their reflectance at this half vector, under fibres by
what they send on of an even sky, under the coat by its reflectance of the eye's ray (as the extensions have it: light is not dimmed twice,
on the way in and on the way out).

Light that is scattered to the far side is seen by lobes of that side: `far_side` turns a point's lobes over, so that whoever asks lights or
draws directions need not know.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel, outlined
from ..kernel.elementary import sqrt
from ..kernel.frame import frame_from_normal, to_local, to_world
from ..kernel.lanes import max, min, where
from ..kernel.vec import ONE, ZERO, Color, Vec3, cross, dot, luminance, max_component, normalize, reflect
from ..kernel.warp import pdf_hemisphere_cosine, warp_hemisphere_cosine
from ..tables.layouts import ANISOTROPY, BEHIND, COAT, COMPENSATED, CONDUCTOR, FAR_SIDE, FILM, ROUGH_MATTE, SHEEN, SHEET
from .anisotropic import anisotropic_ggx, frame_along, pdf_anisotropic, sample_anisotropic
from .conductor import conductor_reflectance
from .fresnel import schlick_weight
from .iridescence import film_reflectance
from .lambert import eval_lambert
from .lobes import Bsdf, Layers, no_layers, with_f90, with_layers, with_lobes
from .microfacet import ggx_distribution, smith_visibility
from .multiscatter import energy_gain
from .oren_nayar import eval_oren_nayar
from .sheen import eval_sheen, sheen_sent_on

__all__ = [
    "Parts", "draw_layers", "eval_layers", "facets_alone", "facets_reflectance", "far_share", "far_side", "given_back", "is_polished",
    "one_channel", "pdf_layers", "veil", "without_glass",
]  # fmt: skip

f32 = np.float32
_LEAST_ALPHA, _GRAZING = f32(1e-3), f32(1e-4)
_COAT_F0 = f32(0.04)
_MOST_FAR, _BELOW_ONE = f32(0.95), f32(1.0 - 2.0**-24)


class Parts(NamedTuple):
    """What irradiance is multiplied by: what is scattered widely, and what rough mirrors reflect."""

    matte: Color
    facets: Color


@kernel
def facets_reflectance(bsdf: Bsdf, cosine: np.float32) -> Color:
    """What the microfacets reflect, `cosine` between them and the light; on the far side, what they let through."""
    layers, bits = bsdf.layers, bsdf.layered
    w = schlick_weight(cosine)
    if bits & FAR_SIDE != 0:
        return bsdf.f0 * (ONE - _shielded(bsdf, w))
    grazing = layers.f90 * w
    mirrored = bsdf.f0 * (ONE - w) + Color(grazing, grazing, grazing)
    if bits & CONDUCTOR != 0:
        mirrored = bsdf.albedo * conductor_reflectance(layers.eta, layers.k, cosine)
    if bits & FILM != 0:
        colored = film_reflectance(bsdf.f0, layers.film_ior, layers.film_thickness, cosine)
        mirrored = mirrored * (ONE - layers.film) + colored * layers.film
    return mirrored


@kernel
def given_back(bsdf: Bsdf, one: np.float32) -> Color:
    """What is left at a further facet: of a sheet all, since what one does not reflect it lets through, tinted."""
    if bsdf.layered & FAR_SIDE != 0:
        return bsdf.f0
    if bsdf.layered & SHEET != 0:
        return Color(one, one, one)
    return facets_reflectance(bsdf, one)


@kernel
def _shielded(bsdf: Bsdf, w: np.float32) -> np.float32:
    """What facets over a matte base keep from it, by Schlick's weight."""
    return bsdf.layers.shield * (ONE - w) + bsdf.layers.grazing * w


@kernel
def _facets(bsdf: Bsdf, wo: Vec3, wi: Vec3, h: Vec3) -> np.float32:
    """V D max(0, n.l)"""
    n, layers = bsdf.ns, bsdf.layers
    facing, n_v = dot(n, wi), max(dot(n, wo), _GRAZING)
    n_l, n_h = where(facing > ZERO, facing, ONE), min(max(dot(n, h), ZERO), ONE)
    a = max(bsdf.roughness2, _LEAST_ALPHA)
    if bsdf.layered & ANISOTROPY != 0:
        t, b = layers.tangent, cross(n, layers.tangent)
        l_in, v_in = Vec3(dot(t, wi), dot(b, wi), n_l), Vec3(dot(t, wo), dot(b, wo), n_v)
        lobe = anisotropic_ggx(max(layers.along, _LEAST_ALPHA), a, l_in, v_in, Vec3(dot(t, h), dot(b, h), n_h))
    else:
        lobe = smith_visibility(a * a, n_l, n_v) * ggx_distribution(a * a, n_h)
    return where(facing > ZERO, lobe * n_l, ZERO)


@kernel
def _coat(bsdf: Bsdf, wo: Vec3, wi: Vec3, h: Vec3) -> np.float32:
    """F V D max(0, n.l) of the coat."""
    n = bsdf.layers.coat_normal
    facing, n_v = dot(n, wi), max(dot(n, wo), _GRAZING)
    n_l = where(facing > ZERO, facing, ONE)
    a = max(bsdf.layers.coat_alpha, _LEAST_ALPHA)
    lobe = smith_visibility(a * a, n_l, n_v) * ggx_distribution(a * a, min(max(dot(n, h), ZERO), ONE)) * n_l
    return where(facing > ZERO, lobe * _coat_reflectance(dot(wo, h)), ZERO)


@kernel
def _coat_reflectance(cosine: np.float32) -> np.float32:
    return _COAT_F0 + (ONE - _COAT_F0) * schlick_weight(cosine)


@outlined
def eval_layers(bsdf: Bsdf, wo: Vec3, wi: Vec3) -> Parts:
    """What irradiance facing wi is multiplied by, towards wo."""
    n, layers, bits = bsdf.ns, bsdf.layers, bsdf.layered
    h = normalize(wo + wi)
    v_h = dot(wo, h)
    matte = eval_lambert(bsdf.diffuse, n, wi)
    if bits & ROUGH_MATTE != 0:
        matte = eval_oren_nayar(bsdf.diffuse, layers.matte_roughness, n, wi, wo)
    reflected = facets_reflectance(bsdf, v_h)
    kept = _shielded(bsdf, schlick_weight(v_h))
    if bits & FILM != 0:
        kept = kept * (ONE - layers.film) + max_component(reflected) * layers.film
    matte = matte * (ONE - kept)
    facets = reflected * _facets(bsdf, wo, wi, h)
    if bits & COMPENSATED != 0:
        facets = facets * energy_gain(given_back(bsdf, ONE + v_h * ZERO), dot(n, wo), sqrt(bsdf.roughness2))
    if bits & SHEEN != 0:
        most = max_component(layers.sheen)
        n_v, n_l = sheen_sent_on(layers.sheen_alpha, dot(n, wo)), sheen_sent_on(layers.sheen_alpha, dot(n, wi))
        left = ONE - most * max(n_v, n_l)
        matte = matte * left + eval_sheen(layers.sheen, layers.sheen_alpha, n, wi, wo)
        facets = facets * left
    if bits & COAT != 0:
        left = ONE - layers.coat * _coat_reflectance(dot(layers.coat_normal, wo))
        mirrored = layers.coat * _coat(bsdf, wo, wi, h)
        matte, facets = matte * left, facets * left + Color(mirrored, mirrored, mirrored)
    return Parts(matte, facets)


# --- drawing directions ---------------------------------------------------------------------------------------------------


class Chances(NamedTuple):
    """Of each lobe to be drawn from."""

    matte: np.float32
    facets: np.float32
    coat: np.float32


@kernel
def _chances(bsdf: Bsdf, wo: Vec3, facets_only: bool) -> Chances:
    layers, bits = bsdf.layers, bsdf.layered
    matte, coat = ZERO, ZERO
    if not facets_only:
        matte = luminance(bsdf.diffuse)
        if bits & SHEEN != 0:
            matte = matte + luminance(layers.sheen) * sheen_sent_on(layers.sheen_alpha, dot(bsdf.ns, wo))
    facets = luminance(facets_reflectance(bsdf, max(dot(bsdf.ns, wo), ZERO)))
    if bits & COAT != 0:
        coat = layers.coat * _coat_reflectance(max(dot(layers.coat_normal, wo), ZERO))
    total = matte + facets + coat
    if total <= ZERO:
        return Chances(ZERO, ZERO, ZERO)
    return Chances(matte / total, facets / total, coat / total)


@kernel
def _facet_frame(bsdf: Bsdf):
    if bsdf.layered & ANISOTROPY != 0:
        return frame_along(bsdf.layers.tangent, bsdf.ns)
    return frame_from_normal(bsdf.ns)


@kernel
def _pdf_of(bsdf: Bsdf, chances: Chances, wo: Vec3, wi: Vec3) -> np.float32:
    layers = bsdf.layers
    h = normalize(wo + wi)
    pdf = chances.matte * pdf_hemisphere_cosine(dot(bsdf.ns, wi))
    if chances.facets > ZERO:
        frame = _facet_frame(bsdf)
        a = max(bsdf.roughness2, _LEAST_ALPHA)
        along = max(layers.along, _LEAST_ALPHA) if bsdf.layered & ANISOTROPY != 0 else a
        pdf = pdf + chances.facets * pdf_anisotropic(along, a, to_local(frame, wo), to_local(frame, h))
    if chances.coat > ZERO:
        frame = frame_from_normal(layers.coat_normal)
        a = max(layers.coat_alpha, _LEAST_ALPHA)
        pdf = pdf + chances.coat * pdf_anisotropic(a, a, to_local(frame, wo), to_local(frame, h))
    return pdf


@outlined
def pdf_layers(bsdf: Bsdf, wo: Vec3, wi: Vec3, facets_only: bool) -> np.float32:
    """The density with which `draw_layers` draws wi."""
    return _pdf_of(bsdf, _chances(bsdf, wo, facets_only), wo, wi)


@outlined
def draw_layers(bsdf: Bsdf, wo: Vec3, choice: np.float32, u: np.float32, w: np.float32, facets_only: bool) -> Vec3:
    """A direction as the layers scatter; `choice`, u and w are uniform in [0, 1).

    `facets_only`: as the facets of base and coat reflect; then u chooses between them, and is used again.
    """
    chances, layers = _chances(bsdf, wo, facets_only), bsdf.layers
    if facets_only:
        choice = u
        if u < chances.coat:
            u = u / chances.coat
        elif chances.coat > ZERO:
            u = min((u - chances.coat) / (ONE - chances.coat), _BELOW_ONE)
    if choice < chances.matte:
        return to_world(frame_from_normal(bsdf.ns), warp_hemisphere_cosine(u, w))
    if choice < chances.matte + chances.coat:
        frame = frame_from_normal(layers.coat_normal)
        along = across = max(layers.coat_alpha, _LEAST_ALPHA)
    else:
        frame = _facet_frame(bsdf)
        along = across = max(bsdf.roughness2, _LEAST_ALPHA)
        if bsdf.layered & ANISOTROPY != 0:
            along = max(layers.along, _LEAST_ALPHA)
    return reflect(-wo, to_world(frame, sample_anisotropic(along, across, to_local(frame, wo), u, w)))


# --- through --------------------------------------------------------------------------------------------------------------


@kernel
def is_polished(bsdf: Bsdf) -> bool:
    """Whether a thin sheet is so smooth that what is behind is seen as through nothing but a colour."""
    return _is_polished(bsdf, bsdf.layers)


@kernel
def _is_polished(bsdf: Bsdf, layers: Layers | None) -> bool:
    if layers is None:
        return False
    return bsdf.layered & SHEET != 0 and bsdf.roughness2 <= _LEAST_ALPHA


@kernel
def veil(bsdf: Bsdf, wo: Vec3) -> Color:
    """What light is multiplied by that goes straight through a sheet towards wo."""
    return _veil(bsdf, bsdf.layers, wo)


@kernel
def _veil(bsdf: Bsdf, layers: Layers | None, wo: Vec3) -> Color:
    if layers is None:
        return Color(ZERO, ZERO, ZERO)
    cosine = max(dot(bsdf.ns, wo), ZERO)
    left = ONE - _shielded(bsdf, schlick_weight(cosine))
    if bsdf.layered & COAT != 0:
        left = left * (ONE - layers.coat * _coat_reflectance(cosine))
    return layers.through * left


@kernel
def far_share(bsdf: Bsdf, wo: Vec3) -> np.float32:
    """How often a path goes to the far side: by how much is let through, against how much is scattered on this side."""
    return _far_share(bsdf, bsdf.layers, wo)


@kernel
def _far_share(bsdf: Bsdf, layers: Layers | None, wo: Vec3) -> np.float32:
    if layers is None:
        return ZERO
    if bsdf.layered & (SHEET | BEHIND) == 0:
        return ZERO
    return _far_chance(bsdf, wo)


@outlined
def _far_chance(bsdf: Bsdf, wo: Vec3) -> np.float32:
    layers = bsdf.layers
    far = luminance(layers.behind)
    if bsdf.layered & SHEET != 0:
        far = far + luminance(veil(bsdf, wo))
    if far <= ZERO:
        return ZERO
    near = luminance(bsdf.diffuse) + luminance(facets_reflectance(bsdf, max(dot(bsdf.ns, wo), ZERO)))
    near = near + luminance(layers.sheen) + layers.coat * _COAT_F0
    return min(far / (far + near), _MOST_FAR) if near > ZERO else ONE


@kernel
def far_side(bsdf: Bsdf) -> Bsdf:
    """The lobes of the side that is not seen, for an eye in the mirrored direction ``wo - 2 n (n.wo)``."""
    return _far_side(bsdf, bsdf.layers)


@kernel
def _far_side(bsdf: Bsdf, layers: Layers | None) -> Bsdf:
    if layers is None:
        return bsdf
    left = ONE - layers.coat * _COAT_F0
    bits = FAR_SIDE | (bsdf.layered & (ANISOTROPY | COMPENSATED))
    bare = no_layers(bsdf.roughness2)
    kept = Layers(
        bare.f90, layers.shield, layers.grazing, bare.through, bare.behind, bare.coat, bare.coat_alpha, bare.coat_normal, bare.sheen,
        bare.sheen_alpha, layers.tangent, layers.along, bare.film, bare.film_thickness, bare.film_ior, bare.eta, bare.k,
        bare.matte_roughness,
    )  # fmt: skip
    through, behind = bare.through, bare.behind
    if bsdf.layered & SHEET != 0:
        # What is polished is looked through, not lit.
        through = where(bsdf.roughness2 > _LEAST_ALPHA, layers.through * left, through)
    if bsdf.layered & BEHIND != 0:
        behind = layers.behind * left
    turned = with_lobes(bsdf, -bsdf.ns, behind, through, behind * (ONE - layers.shield))
    return with_layers(turned, bits, kept)


@kernel
def without_glass(bsdf: Bsdf, share: np.float32) -> Bsdf:
    """The lobes of that part of a surface, 1 - `share` of it, which is no way into a medium."""
    return _without_glass(bsdf, bsdf.layers, share)


@kernel
def _without_glass(bsdf: Bsdf, layers: Layers | None, share: np.float32) -> Bsdf:
    if layers is None:
        return bsdf
    rest = ONE / (ONE - share)
    level = share * layers.shield
    f0 = (bsdf.f0 - Color(level, level, level)) * rest
    f0 = Color(max(f0.r, ZERO), max(f0.g, ZERO), max(f0.b, ZERO))
    plain = with_lobes(bsdf, bsdf.ns, bsdf.diffuse * rest, f0, bsdf.ambient)
    return with_layers(plain, bsdf.layered, with_f90(layers, max((layers.f90 - share * layers.grazing) * rest, ZERO)))


@kernel
def facets_alone(bsdf: Bsdf) -> Bsdf:
    """What the surface of a medium reflects: its microfacets, without layers over them."""
    return _facets_alone(bsdf, bsdf.layers)


@kernel
def _facets_alone(bsdf: Bsdf, layers: Layers | None) -> Bsdf:
    if layers is None:
        return bsdf
    if bsdf.layered == 0:
        return bsdf
    black = Color(ZERO, ZERO, ZERO)
    return with_layers(with_lobes(bsdf, bsdf.ns, black, Color(layers.shield, layers.shield, layers.shield), black), 0, layers)


@kernel
def one_channel(throughput: Color, lot: np.float32) -> Color:
    """One channel of three, thrice as strong, since each is bent its own way; the same where there is one left.

    Which one is a lot in [0, 1) among those that carry light.
    """
    r, g, b = throughput.r > ZERO, throughput.g > ZERO, throughput.b > ZERO
    n = f32(int(r) + int(g) + int(b))
    if n <= ONE:
        return throughput
    chosen = int(lot * n)
    if r and chosen == 0:
        return Color(throughput.r * n, ZERO, ZERO)
    if g and chosen == int(r):
        return Color(ZERO, throughput.g * n, ZERO)
    return Color(ZERO, ZERO, throughput.b * n)
