"""From specular and glossiness to metallic and roughness (KHR_materials_pbrSpecularGlossiness, which glTF has given up).

A surface of diffuse colour c and specular colour s scatters ``c (1 - max s)`` and reflects s, seen straight. One of base colour b and
metallic m scatters ``0.96 b (1 - m)`` and reflects ``0.04 (1 - m) + b m``. With ``k = 1 - m`` and ``d = c (1 - max s) / 0.96`` that is

    d = b k,   s = 0.04 k + b (1 - k)      so      0.04 k^2 - (d + s) k + d = 0

for one channel; k is found for the luminances of d and s, and the base colour then from d where k is great, from s where m is. Metals and
what reflects 4 percent, nearly all there is, come back exactly; a coloured reflection of what is no metal cannot.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..color.transfer import linear_from_srgb, srgb_from_linear
from ..scene.texture import Texels

__all__ = ["converted", "converted_texels"]

_F0 = 0.04
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

Floats = NDArray[np.float64]


def converted(diffuse: Any, specular: Any) -> tuple[Floats, Floats]:
    """Return base colour (…, 3) and metallic (…), both in [0, 1], of linear diffuse and specular colours (…, 3).

    >>> base, metallic = converted((0.2, 0.4, 0.6), (0.04, 0.04, 0.04))
    >>> base.round(6).tolist(), float(metallic)
    ([0.2, 0.4, 0.6], 0.0)
    >>> base, metallic = converted((0.0, 0.0, 0.0), (1.0, 0.8, 0.3))
    >>> base.round(6).tolist(), float(metallic)
    ([1.0, 0.8, 0.3], 1.0)

    **Source**: Khronos Group, *KHR_materials_pbrSpecularGlossiness*, "Best practices", has the same equation for m.
    """
    c, s = np.broadcast_arrays(np.asarray(diffuse, dtype=np.float64), np.asarray(specular, dtype=np.float64))
    d = c * (1.0 - s.max(axis=-1, keepdims=True)) / (1.0 - _F0)
    bright, shiny = d @ _LUMINANCE, s @ _LUMINANCE
    both = bright + shiny
    k = (both - np.sqrt(np.maximum(both * both - 4.0 * _F0 * bright, 0.0))) / (2.0 * _F0)
    k = np.where(shiny > _F0, np.clip(k, 0.0, 1.0), 1.0)[..., None]
    m = 1.0 - k
    of_metal = (s - _F0 * k) / np.maximum(m, 1e-6)
    of_others = d / np.maximum(k, 1e-6)
    return np.clip(of_others + (of_metal - of_others) * m * m, 0.0, 1.0), m[..., 0]


def converted_texels(diffuse: Texels | None, specular: Texels | None, factors: tuple[Any, Any, float]) -> tuple[Texels, Texels]:
    """Return the texels of base colour with alpha (sRGB-encoded), and those of metallic and roughness.

    Parameters
    ----------
    diffuse, specular : Texels, optional
        Diffuse colour with alpha; specular colour with glossiness. The smaller is enlarged, texel by texel.
    factors : three floats, three floats, float
        Of diffuse colour, specular colour and glossiness.
    """
    given = [_linear(texels) for texels in (diffuse, specular)]
    height, width = max(texels.shape[0] for texels in given), max(texels.shape[1] for texels in given)
    first, second = (_enlarged(texels, height, width) for texels in given)
    colors = np.empty((height, width, 4), dtype=np.uint8)
    numbers = np.full((height, width, 4), 255, dtype=np.uint8)
    for row in range(height):  # the float64 of a whole picture would be eight times its size
        base, metallic = converted(first[row, :, :3] * factors[0], second[row, :, :3] * factors[1])
        colors[row, :, :3] = np.round(srgb_from_linear(base) * 255.0)
        colors[row, :, 3] = np.round(first[row, :, 3] * 255.0)
        numbers[row, :, 1] = np.round((1.0 - second[row, :, 3] * factors[2]) * 255.0)
        numbers[row, :, 2] = np.round(metallic * 255.0)
    name = next((texels.name for texels in (diffuse, specular) if texels is not None), "")
    return Texels(colors, srgb=True, name=name), Texels(numbers, srgb=False, name=name)


def _linear(texels: Texels | None) -> NDArray[np.float32]:
    if texels is None:
        return np.ones((1, 1, 4), dtype=np.float32)
    values = np.clip(texels.pixels.astype(np.float32) / np.float32(texels.white), np.float32(0.0), np.float32(1.0))
    if texels.srgb:
        values[..., :3] = linear_from_srgb(values[..., :3])
    return values


def _enlarged(values: NDArray[np.float32], height: int, width: int) -> NDArray[np.float32]:
    rows, columns = (np.arange(n) * values.shape[k] // n for k, n in enumerate((height, width)))
    return values[rows[:, None], columns]
