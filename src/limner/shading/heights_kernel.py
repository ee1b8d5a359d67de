"""Heights for displacement: any texture at many places, each by itself, without a pixel around it."""

from __future__ import annotations

from .._jit import kernel
from ..kernel.vec import ZERO, Vec3
from .surface import Detail
from .texture import Place, sample_place

__all__ = ["heights_at"]


@kernel
def heights_at(textures, texels, places, heights):
    """Fill heights (n,) with the red channel of the first texture at places (n, 8): u, v, the point on the object, its normal."""
    none = Vec3(ZERO, ZERO, ZERO)
    for k in range(places.shape[0]):
        p = Vec3(places[k, 2], places[k, 3], places[k, 4])
        n = Vec3(places[k, 5], places[k, 6], places[k, 7])
        place = Place(places[k, 0], places[k, 1], ZERO, ZERO, ZERO, ZERO, Detail(p, n, none, none, none, none))
        color, _ = sample_place(textures[0], texels, place)
        heights[k] = color.r
