"""Texels of 8 and 16 bits and of floats: the same picture in any depth, kept as it is, reduced in linear light."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from compiled import door_of
from numpy.typing import NDArray

from limner._door import Array
from limner.color.transfer import linear_from_srgb, srgb_from_linear
from limner.errors import SceneError
from limner.image.mipmap import copy_places, level_sizes, mipmaps, ripmaps
from limner.kernel.vec import ONE, ZERO, Color, Vec3
from limner.scene.texture import MAX_TEXTURE_SIZE, Texels, Texture
from limner.shading.surface import Footprint, SurfacePoint, no_detail
from limner.shading.texture import sample_texture
from limner.tables.layouts import TEXTURE
from limner.tables.textures import texture_tables

FILTERS = ("nearest", "bilinear", "trilinear", "anisotropic", "ripmap")


def _look_up(textures, texels, rows, out):
    for k in range(rows.shape[0]):
        r = rows[k]
        up, color = Vec3(ZERO, ZERO, ONE), Color(ONE, ONE, ONE)
        footprint = Footprint(r[2], r[3], r[4], r[5], ZERO, ZERO, ZERO, ZERO)
        point = SurfacePoint(up, up, up, up, ONE, r[0], r[1], ZERO, ZERO, color, ONE, footprint, 0, up, ONE, no_detail(ONE))
        c, alpha = sample_texture(textures[0], texels, point)
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = c.r, c.g, c.b, alpha


def _seen(texture: Texture, rows: Any) -> NDArray[np.float32]:
    rows = np.ascontiguousarray(rows, np.float32)
    records, texels = texture_tables([texture])
    out = np.zeros((len(rows), 4), np.float32)
    door_of(_look_up, Array(TEXTURE, 1), Array(np.uint8, 1), Array(np.float32, 2), Array(np.float32, 2))(records, texels, rows, out)
    return out


def _bytes(height: int = 8, width: int = 16) -> NDArray[np.uint8]:
    return np.random.default_rng(8).integers(0, 256, (height, width, 4), dtype=np.uint8)


def _places(n: int = 60) -> NDArray[np.float64]:
    """(n, 6) u, v and footprints from a part of a texel to some texels."""
    random = np.random.default_rng(4)
    return np.concatenate([random.uniform(-1, 2, (n, 2)), random.uniform(-0.2, 0.2, (n, 4)) * random.uniform(0, 1, (n, 1))], axis=1)


@pytest.mark.parametrize("filter_", FILTERS)
def test_a_picture_is_the_same_in_any_depth(filter_):
    """Bytes times 257 in 16 bits, and bytes over 255 as floats, look as the bytes do: up to the rounding of the reduced levels."""
    pixels = _bytes()
    expected = _seen(Texture(Texels(pixels, srgb=False), filter=filter_), _places())
    words = _seen(Texture(Texels(pixels.astype(np.uint16) * 257, srgb=False), filter=filter_), _places())
    floats = _seen(Texture(Texels((pixels / 255.0).astype(np.float32), srgb=False), filter=filter_), _places())
    loose = 1e-6 if filter_ in ("nearest", "bilinear") else 2.5 / 255.0
    np.testing.assert_allclose(words, expected, atol=loose)
    np.testing.assert_allclose(floats, expected, atol=loose)
    np.testing.assert_allclose(floats, words, atol=3e-5)


def test_sixteen_bits_are_decoded_by_the_curve():
    """Every texel of a ramp through all codes, as the formula of sRGB has it (IEC 61966-2-1)."""
    codes = np.linspace(0, 65535, 200).round().astype(np.uint16)
    pixels = np.repeat(codes[None, :, None], 4, axis=2)
    rows = np.zeros((200, 6))
    rows[:, 0] = (np.arange(200) + 0.5) / 200
    seen = _seen(Texture(Texels(pixels), filter="nearest"), rows)
    np.testing.assert_allclose(seen[:, 0], linear_from_srgb(codes / 65535.0), rtol=2e-6, atol=1e-7)
    np.testing.assert_allclose(seen[:, 3], codes / 65535.0, rtol=1e-6)


def test_floats_are_kept_as_they_are():
    """Brighter than white, and below zero, to the bit."""
    pixels = np.random.default_rng(1).normal(0.0, 1e4, (4, 4, 4)).astype(np.float32)
    u, v = np.meshgrid((np.arange(4) + 0.5) / 4, (np.arange(4) + 0.5) / 4)
    rows = np.concatenate([np.stack([u, v], axis=-1).reshape(-1, 2), np.zeros((16, 4))], axis=1)
    seen = _seen(Texture(Texels(pixels, srgb=False), filter="nearest"), rows)
    np.testing.assert_array_equal(seen.view(np.int32), pixels.reshape(-1, 4).view(np.int32))


@pytest.mark.parametrize("dtype", [np.uint16, np.float32])
def test_levels_are_means_in_linear_light(dtype):
    """The last level is the alpha-weighted mean of all texels; the first is the picture itself; ripmaps agree with both."""
    white = 65535.0 if dtype == np.uint16 else 1.0
    pixels = (np.random.default_rng(3).uniform(0, 1, (8, 16, 4)) * white).astype(dtype)
    srgb = dtype == np.uint16
    sizes = level_sizes(16, 8)
    out = np.zeros(sum(w * h for w, h in sizes) * 4 * pixels.itemsize, np.uint8)
    mipmaps(pixels, srgb, out)
    np.testing.assert_array_equal(out[: pixels.nbytes].view(dtype).reshape(pixels.shape), pixels)
    light = pixels.astype(np.float64) / white
    light[..., :3] = linear_from_srgb(light[..., :3]) if srgb else light[..., :3]
    mean = (light[..., :3] * light[..., 3:]).sum(axis=(0, 1)) / light[..., 3:].sum()
    last = out[-4 * pixels.itemsize :].view(dtype) / white
    np.testing.assert_allclose(last[:3], srgb_from_linear(mean) if srgb else mean, atol=2e-5)
    np.testing.assert_allclose(last[3], light[..., 3].mean(), atol=2e-5)
    places = copy_places(16, 8) * pixels.itemsize
    copies = np.zeros(31 * 15 * 4 * pixels.itemsize, np.uint8)
    ripmaps(pixels, srgb, copies)
    smallest = copies[int(places[-1, -1]) :][: 4 * pixels.itemsize].view(dtype) / white
    np.testing.assert_allclose(smallest, last, atol=4e-5)


def test_clear_texels_do_not_bleed():
    """A colour of alpha 0 has no share of what it is averaged into; where all is clear, colours are averaged as they are."""
    pixels = np.zeros((2, 4, 4), np.float32)
    pixels[:, 0], pixels[:, 1] = (1.0, 0.5, 0.25, 1.0), (9.0, 9.0, 9.0, 0.0)
    pixels[:, 2], pixels[:, 3] = (2.0, 0.0, 0.0, 0.0), (4.0, 0.0, 0.0, 0.0)
    out = np.zeros((8 + 2 + 1) * 16, np.uint8)
    mipmaps(pixels, False, out)
    np.testing.assert_array_equal(out[8 * 16 : 10 * 16].view(np.float32).reshape(2, 4), [[1, 0.5, 0.25, 0.5], [3, 0, 0, 0]])


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.float64])
def test_pictures_of_any_depth_and_channels_become_texels(dtype):
    """Grey and colour, with alpha and without, are turned over and filled up with white."""
    white = np.iinfo(dtype).max if np.dtype(dtype).kind == "u" else 1.0
    for channels in (1, 2, 3, 4):
        given = (np.random.default_rng(channels).uniform(0, 1, (3, 2, channels)) * white).astype(dtype)
        texels = Texels.from_top_down(given, srgb=np.dtype(dtype).kind == "u")
        kept = np.float32 if np.dtype(dtype).kind == "f" else dtype
        assert texels.pixels.dtype == kept
        assert texels.white == white
        upright = texels.pixels[::-1]
        np.testing.assert_array_equal(upright[..., :3], np.broadcast_to(given[..., : 3 if channels > 2 else 1], (3, 2, 3)).astype(kept))
        np.testing.assert_array_equal(upright[..., 3], (given[..., -1] if channels in (2, 4) else np.full((3, 2), white)).astype(kept))


def test_what_cannot_be_texels_is_said():
    """Size and limit, place and value, or the kinds that there are."""
    with pytest.raises(SceneError, match=rf"must not exceed {MAX_TEXTURE_SIZE} texels a side, got 1 x {MAX_TEXTURE_SIZE + 1}"):
        Texels(np.zeros((MAX_TEXTURE_SIZE + 1, 1, 4), np.uint8))
    with pytest.raises(SceneError, match=r"uint8, uint16 or float32, got .* int64"):
        Texels(np.zeros((1, 1, 4), np.int64))
    with pytest.raises(SceneError, match="srgb must be False for float32"):
        Texels(np.zeros((1, 1, 4), np.float32))
    with pytest.raises(SceneError, match=r"must be finite, got .* at row 1, column 0"):
        Texels(np.array([[[0, 0, 0, 1]], [[0, np.inf, 0, 1]]], np.float32), srgb=False)
