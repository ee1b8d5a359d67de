"""What light meets at a point: plain numbers, by which textures, tables and kinds of material are forgotten.

Most materials are a matte base under microfacets. What some have beyond that stands in `Layers`, and `layered` says in bits which of it
there is: one number that eight points share, looked at once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..kernel.lanes import spread
from ..kernel.vec import ZERO, Color, Vec3

__all__ = ["Bsdf", "Layers", "no_layers", "rough_matte", "with_f90", "with_layers", "with_lobes"]

f32 = np.float32


class Layers(NamedTuple):
    """What a glTF material has beyond its core; zero where it has it not."""

    f90: np.float32  # what the microfacets reflect at grazing angles
    shield: np.float32  # what the part that is no metal reflects, straight on: it does not reach the base
    grazing: np.float32  # and at grazing angles
    through: Color  # what goes through the surface, of what is not reflected
    behind: Color  # what is scattered to the far side, likewise
    coat: np.float32
    coat_alpha: np.float32
    coat_normal: Vec3
    sheen: Color
    sheen_alpha: np.float32
    tangent: Vec3  # unit, the direction in which highlights are drawn out
    along: np.float32  # the microfacets' alpha in that direction
    film: np.float32  # how much of it there is
    film_thickness: np.float32  # nanometres
    film_ior: np.float32
    eta: Color  # a conductor's complex index
    k: Color
    matte_roughness: np.float32  # Oren and Nayar's sigma


class Bsdf(NamedTuple):
    """What light meets at a point."""

    ns: Vec3  # shading normal, unit, after the normal map
    diffuse: Color  # kd
    specular: Color  # ks of the highlight
    exponent: np.float32  # its p; negative: Phong's with exponent -p
    f0: Color  # microfacet lobe: reflectance at normal incidence
    roughness2: np.float32  # its alpha: perceptual roughness squared
    ambient: Color  # what ambient light is multiplied by
    occlusion: np.float32  # the share of it that is not hidden nearby
    mirror: Color  # ideal reflection
    emission: Color
    alpha: np.float32  # coverage
    albedo: Color  # the base colour as painted
    dielectric_f0: np.float32  # what the microfacets over a matte base reflect, straight on
    layered: int  # bits: which of the layers there are
    layers: Layers | None  # None, known to the compiler: in a door that knows of no layers


@kernel
def no_layers(like: np.float32) -> Layers:
    """No layers, at one point or at eight."""
    zero = spread(ZERO, like)
    black, none = Color(zero, zero, zero), Vec3(zero, zero, zero)
    empty = Color(ZERO, ZERO, ZERO)
    return Layers(zero, zero, zero, black, black, zero, zero, none, black, zero, none, zero, zero, zero, ZERO, empty, empty, ZERO)


@kernel
def with_lobes(bsdf: Bsdf, ns: Vec3, diffuse: Color, f0: Color, ambient: Color) -> Bsdf:
    """The same with another normal, base and microfacets."""
    return Bsdf(
        ns, diffuse, bsdf.specular, bsdf.exponent, f0, bsdf.roughness2, ambient, bsdf.occlusion, bsdf.mirror, bsdf.emission, bsdf.alpha,
        bsdf.albedo, bsdf.dielectric_f0, bsdf.layered, bsdf.layers,
    )  # fmt: skip


@kernel
def with_layers(bsdf: Bsdf, layered: int, layers: Layers) -> Bsdf:
    """The same with other layers."""
    return Bsdf(
        bsdf.ns, bsdf.diffuse, bsdf.specular, bsdf.exponent, bsdf.f0, bsdf.roughness2, bsdf.ambient, bsdf.occlusion, bsdf.mirror,
        bsdf.emission, bsdf.alpha, bsdf.albedo, bsdf.dielectric_f0, layered, layers,
    )  # fmt: skip


@kernel
def with_f90(layers: Layers, f90: np.float32) -> Layers:
    """The same with another reflectance at grazing angles."""
    return Layers(
        f90, layers.shield, layers.grazing, layers.through, layers.behind, layers.coat, layers.coat_alpha, layers.coat_normal, layers.sheen,
        layers.sheen_alpha, layers.tangent, layers.along, layers.film, layers.film_thickness, layers.film_ior, layers.eta, layers.k,
        layers.matte_roughness,
    )  # fmt: skip


@kernel
def rough_matte(bare: Layers, sigma: np.float32) -> Layers:
    """The same of a matte surface that is rough."""
    return Layers(
        bare.f90, bare.shield, bare.grazing, bare.through, bare.behind, bare.coat, bare.coat_alpha, bare.coat_normal, bare.sheen,
        bare.sheen_alpha, bare.tangent, bare.along, bare.film, bare.film_thickness, bare.film_ior, bare.eta, bare.k, sigma,
    )  # fmt: skip
