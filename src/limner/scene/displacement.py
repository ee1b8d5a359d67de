"""Displacement: a texture that moves the surface itself, not only its shading (FoCG 11.4.3).

    rocky = limner.Displacement(heights, scale=0.2, midlevel=0.5)
    limner.Shape(limner.Sphere(1.0), (stone,), displacement=rocky)

Unlike with a normal or bump map, outlines change, parts hide each other, and shadows fall where they should. The price is triangles: each
picture has them where it needs them (`limner.mesh.reshape.displace`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ..errors import SceneError
from ._values import finite, positive
from .texture import AnyTexture, Texture

__all__ = ["Displacement", "Height"]

Height: TypeAlias = AnyTexture

_MOST_TRIANGLES = 1 << 24


@dataclass(frozen=True)
class Displacement:
    """How a surface is moved along its smooth normal: by ``scale * (height - midlevel)``.

    Parameters
    ----------
    height : Texture or pattern
        Its red channel is the height: 0 to 1 for texels of integers. Make the texels with ``srgb=False``, or they are decoded as colours
        are. Pictures are seen bilinearly in their finest level, or in steps where the filter is "nearest". Patterns in object space, and
        tri-planar pictures, are asked where the surface was before it was moved.
    scale : float
        Object space, metres: how far the surface moves from height 0 to height 1.
    midlevel : float
        The height that stays where it is.
    edge_pixels : float > 0
        How long the edges of the surface's triangles may be in the picture, as seen in its middle; down to a quarter of that where the
        height changes. Along the gaze, and outside the picture, where only mirrors and shadows tell, up to four times that.
    max_triangles : int > 0
        Where so many are not enough, edges stay longer, and the image's warnings name the shape.
    """

    height: Height
    scale: float
    midlevel: float = 0.0
    edge_pixels: float = 4.0
    max_triangles: int = 1_000_000

    def __post_init__(self) -> None:
        if not isinstance(self.height, Height):
            raise SceneError(f"displacement.height must be a Texture or a pattern, got {type(self.height).__name__}")
        for field in ("scale", "midlevel"):
            object.__setattr__(self, field, finite(getattr(self, field), f"displacement.{field}"))
        object.__setattr__(self, "edge_pixels", positive(self.edge_pixels, "displacement.edge_pixels"))
        most = self.max_triangles
        if isinstance(most, bool) or not isinstance(most, (int, np.integer)) or not 1 <= most <= _MOST_TRIANGLES:
            raise SceneError(f"displacement.max_triangles must be an integer from 1 to {_MOST_TRIANGLES}, got {most!r}")

    @property
    def reach(self) -> float:
        """How far the surface may move at most, in object space; of texels of floats, by the greatest of them."""
        low, high = 0.0, 1.0
        if not isinstance(self.height, Texture):
            reds = [color[0] for color in self.height.colors]
            low, high = min(reds), max(reds)
        elif self.height.texels.pixels.dtype == np.float32:
            red = self.height.texels.pixels[..., 0]
            low, high = float(red.min()), float(red.max())
        return abs(self.scale) * max(abs(low - self.midlevel), abs(high - self.midlevel))
