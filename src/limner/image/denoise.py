"""Denoising: a picture of few samples, as it would look with many (Dammertz 2010).

What lies beside the picture knows no noise: which surface a pixel shows, how it is turned, what it is painted with. Pixels that agree in
all that show the same light, and are averaged; where they differ there is an edge, and it stays.

    limner.render(scene, renderer="path", samples=32, denoise="filter")     while it is made
    limner.denoised(image)                                                  afterwards, of a picture with these channels beside it

What is painted is divided off first, and multiplied on in the end, so that textures stay as sharp as they are. The rest is filtered five
times with holes that grow (à trous): 25 neighbours, one, two, four, eight, sixteen steps apart, reach as far as a filter of 61 x 61. How
much light may differ follows from the picture's variance, where it is known.

    denoising_albedo   denoising_normal   denoising_depth     means over a pixel, seen through mirrors and glass
    albedo             normal             depth               of its centre, in their place
    variance                                                  of each channel's mean; else from how pixels differ from their neighbours

"oidn" is Intel's Open Image Denoise instead, a trained network, which is better where there are few samples (extra ``denoise``).
"""

from __future__ import annotations

import importlib
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._door import Array, Door, Scalar
from ..errors import SceneError, UnsupportedError
from ..tiles import run_all, thread_count, tiles_of
from .formats import LUMINANCE

if TYPE_CHECKING:
    from .image import Image

__all__ = ["DENOISERS", "GUIDES", "checked_denoiser", "denoised"]

DENOISERS = ("filter", "oidn")
GUIDES = ("denoising_albedo", "denoising_normal", "denoising_depth", "variance")
"""What helps it most, of the channels beside a picture."""

Floats = NDArray[np.float32]

_PASSES = 5
_TILE_SIZE = 64
_DARKEST_ALBEDO = 0.02  # is added before dividing: what reflects next to nothing may still shine

_FILTER = Door(
    "limner.image.denoise_kernel",
    "denoise_tile",
    (
        *(Array(np.float32, ndim) for ndim in (3, 2, 3, 3, 2)), Scalar(np.float32), *(6 * (Scalar(np.int64),)),
    ),
    "denoising",
)  # fmt: skip


def denoised(image: Image, method: str = "filter", *, strength: float = 2.0, threads: int | None = None) -> Image:
    """Take the noise out of a picture; what lies beside it, and alpha, stay.

    Parameters
    ----------
    image : Image
        With the channels that the module's page names beside it; the fewer, the more is blurred.
    method : "filter" | "oidn"
        Our own edge-aware filter, or Intel's Open Image Denoise (extra ``denoise``).
    strength : float > 0
        Of the filter: by how many standard deviations of their luminance pixels may differ and still be averaged.
    threads : int, optional
        None: all cores. The picture does not depend on it.

    Returns
    -------
    Image

    Raises
    ------
    UnsupportedError
        An unknown method, or one whose library is not installed.

    **Source**: Dammertz, Sewtz, Hanika and Lensch, *Edge-avoiding à-trous wavelet transform for fast global illumination filtering*, HPG
    2010; what variance decides is after Schied et al., *Spatiotemporal variance-guided filtering*, HPG 2017, 4.3 and 4.4, without what it
    does over time. Planes are recognised by one over depth, which is linear over the picture.
    """
    checked_denoiser(method)
    if not 0.0 < strength < float("inf"):
        raise SceneError(f"strength must be a positive number, got {strength!r}")
    color = _finite(image.pixels[..., :3])
    made = _by_network(image, color) if method == "oidn" else _by_filter(image, color, float(strength), thread_count(threads))
    seen = image.pixels[..., 3:] > 0.0
    return replace(image, pixels=np.concatenate([np.where(seen, made, color), image.pixels[..., 3:]], axis=2, dtype=np.float32))


def checked_denoiser(method: str) -> str:
    """The name, if there is such a method and its library is installed; UnsupportedError else."""
    if method not in DENOISERS:
        raise UnsupportedError(f"denoise must be one of {', '.join(DENOISERS)}, got {method!r}")
    if method == "oidn":
        _network()
    return method


# --- the filter -------------------------------------------------------------------------------------------------------------


def _by_filter(image: Image, color: Floats, strength: float, threads: int) -> Floats:
    height, width = color.shape[:2]
    albedo = _channel(image, "albedo", 3)
    paint = np.ones_like(color) if albedo is None else np.float32(_DARKEST_ALBEDO) + np.maximum(_finite(albedo), np.float32(0.0))
    light = np.empty((height, width, 4), dtype=np.float32)
    light[..., :3] = color / paint
    light[..., 3] = np.clip(image.pixels[..., 3], 0.0, 1.0)
    variance = _variance(image, light, paint)
    guide = _guide(image)
    to_light, to_variance = np.empty_like(light), np.empty_like(variance)
    tiles = tiles_of(width, height, _TILE_SIZE)
    for step in (1 << k for k in range(_PASSES)):
        work = _FILTER.bind(light, variance, guide, to_light, to_variance, strength, step)
        run_all(lambda tile, work=work: work(*tile), tiles, threads)  # type: ignore[misc]
        light, to_light, variance, to_variance = to_light, light, to_variance, variance
    return light[..., :3] * paint


def _guide(image: Image) -> Floats:
    """(height, width, 9) float32, as the kernel takes it; 0 for channels that are not there."""
    guide = np.zeros((image.height, image.width, 9), dtype=np.float32)
    normal, albedo, depth = (_channel(image, name, n) for name, n in (("normal", 3), ("albedo", 3), ("depth", 1)))
    if normal is not None:
        guide[..., 0:3] = _finite(normal)
    if albedo is not None:
        guide[..., 3:6] = _finite(albedo)
    if depth is not None:
        with np.errstate(divide="ignore"):
            nearness = np.where(np.isfinite(depth) & (depth > 0.0), np.float32(1.0) / depth, np.float32(0.0)).astype(np.float32)
        guide[..., 6] = nearness
        guide[..., 7], guide[..., 8] = _slope(nearness, 1), _slope(nearness, 0)
    return guide


def _channel(image: Image, name: str, n: int) -> Floats | None:
    """What lies beside the picture under a name: the mean over the pixel where there is one."""
    values = image.aov.get(f"denoising_{name}", image.aov.get(name))
    shape = image.pixels.shape[:2] if n == 1 else (*image.pixels.shape[:2], n)
    return None if values is None or values.shape != shape else np.asarray(values, dtype=np.float32)


def _slope(values: Floats, axis: int) -> Floats:
    """The change to the next pixel, of the two neighbours by that which changes less: an edge is no slope."""
    if values.shape[axis] < 2:
        return np.zeros_like(values)
    difference = np.diff(values, axis=axis)
    nothing = np.full_like(difference.take([0], axis=axis), np.inf)
    before, after = np.concatenate([nothing, difference], axis=axis), np.concatenate([difference, nothing], axis=axis)
    return np.where(np.abs(before) < np.abs(after), before, after).astype(np.float32)


def _variance(image: Image, light: Floats, paint: Floats) -> Floats:
    """(height, width) float32: of the luminance of light without paint."""
    told = _channel(image, "variance", 3)
    if told is not None:
        # As if the channels' noise were the same noise, which is nearly so and never too little.
        deviation = np.sqrt(np.maximum(_finite(told), np.float32(0.0))) / paint
        return np.ascontiguousarray((deviation @ LUMINANCE) ** 2, dtype=np.float32)
    return _local_variance(light[..., :3] @ LUMINANCE)


def _local_variance(values: Floats) -> Floats:
    """The variance of each pixel's neighbourhood of 7 x 7."""
    from .separable import convolution_taps, filtered

    box = np.full(7, 1.0 / 7.0)
    exact = values.astype(np.float64)
    planes = np.stack([exact, exact**2], axis=-1)
    mean = filtered(planes, convolution_taps(box, values.shape[0]), convolution_taps(box, values.shape[1]))
    return np.ascontiguousarray(np.maximum(mean[..., 1] - mean[..., 0] ** 2, 0.0), dtype=np.float32)


def _finite(values: NDArray[Any]) -> Floats:
    return np.nan_to_num(np.asarray(values, dtype=np.float32), nan=0.0, posinf=0.0, neginf=0.0)


# --- the network ------------------------------------------------------------------------------------------------------------


def _network() -> Any:
    try:
        return importlib.import_module("pyoidn")
    except ImportError:
        raise UnsupportedError("Open Image Denoise is not installed: pip install 'limner[denoise]', or use \"filter\"") from None


def _by_network(image: Image, color: Floats) -> Floats:
    albedo, normal = _channel(image, "albedo", 3), _channel(image, "normal", 3)
    beside: dict[str, Any] = {}
    if albedo is not None:
        beside["albedo"] = np.clip(_finite(albedo), 0.0, 1.0)
        if normal is not None:  # the library takes normals beside albedo only
            beside["normal"] = np.clip(_finite(normal), -1.0, 1.0)
    try:
        made = _network().denoise(np.ascontiguousarray(np.maximum(color, 0.0)), hdr=True, **beside)
    except RuntimeError as error:
        raise UnsupportedError(f"Open Image Denoise cannot denoise this picture: {' '.join(str(error).split())}") from error
    return np.asarray(made, dtype=np.float32)
