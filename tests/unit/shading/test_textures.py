"""Texture lookup against formulas (FoCG 11.3): filters, wrap modes, mipmap levels, and perspective-correct coordinates."""

from __future__ import annotations

import numpy as np
import pytest
from compiled import over
from numpy.typing import NDArray
from staging import place, scene_of

from limner.image.image import Image
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.render import render
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.light import AmbientLight
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.shape import Plane, Sphere
from limner.scene.texture import Texels, Texture
from limner.shading import texture as texture_kernels

AMBIENT = Node(lights=(AmbientLight(intensity=1.0),))
SQUARE = Mesh(
    np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32), np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32),
)  # fmt: skip


def _noise(height: int, width: int) -> NDArray[np.uint8]:
    texels = np.random.default_rng(5).integers(0, 256, size=(height, width, 4), dtype=np.uint8)
    texels[..., 3] = 255
    return texels


def _facing(size: float = 1.0) -> Camera:
    """Sees [0, size] x [0, size] of the plane z = 0."""
    return OrthographicCamera.look_at((size / 2, size / 2, 1), (size / 2, size / 2, 0), height=size)


def _shown(texture: Texture, pixels: int, renderer: str = "raster", size: float = 1.0) -> NDArray[np.float32]:
    """The texture on [0, 1]^2, row 0 at the bottom."""
    node = place(SQUARE if size == 1.0 else Plane(), Lambert(color=1, texture=texture), matrix=_upright(size))
    image = render(scene_of(node, AMBIENT, camera=_facing(size)), width=pixels, height=pixels, renderer=renderer, samples=1)
    return image.pixels[::-1, :, :3]


def _upright(size: float) -> NDArray[np.float64]:
    """The plane y = 0, whose (u, v) is (x, -z), turned so that (u, v) is (x, y)."""
    return np.eye(4) if size == 1.0 else transform.rotate_x(np.pi / 2)


@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_nearest_shows_the_texels(renderer):
    """One pixel a texel, v up, linear values."""
    texels = _noise(8, 8)
    seen = _shown(Texture(Texels(texels, srgb=False), filter="nearest"), 8, renderer)
    np.testing.assert_allclose(seen, texels[..., :3] / 255.0, atol=1e-6)


def test_srgb_texels_are_decoded():
    """The curve of IEC 61966-2-1."""
    texels = _noise(8, 8)
    seen = _shown(Texture(Texels(texels, srgb=True), filter="nearest"), 8)
    c = texels[..., :3] / 255.0
    np.testing.assert_allclose(seen, np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4), atol=1e-6)


@pytest.mark.parametrize("wrap", ["repeat", "mirror", "clamp"])
def test_bilinear(wrap):
    """The four texels around, weighted by nearness (FoCG 11.3.2), also over the border and far outside."""
    h, w, size, pixels = 3, 5, 4.0, 40
    texels = _noise(h, w)
    seen = _shown(Texture(Texels(texels, srgb=False), filter="bilinear", wrap_u=wrap, wrap_v=wrap), pixels, size=size)
    at = (np.arange(pixels) + 0.5) / pixels * size
    modes = {"repeat": "wrap", "mirror": "symmetric", "clamp": "edge"}
    border = 4 * max(h, w)
    padded = np.pad(texels[..., :3] / 255.0, ((border, border), (border, border), (0, 0)), mode=modes[wrap])
    x, y = at * w - 0.5 + border, at * h - 0.5 + border
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    a, b = (x - i)[None, :, None], (y - j)[:, None, None]
    i, j = np.meshgrid(i, j)
    expected = (padded[j, i] * (1 - a) + padded[j, i + 1] * a) * (1 - b) + (padded[j + 1, i] * (1 - a) + padded[j + 1, i + 1] * a) * b
    np.testing.assert_allclose(seen, expected, atol=2e-5)


@pytest.mark.parametrize("renderer", ["raster", "ray"])
@pytest.mark.parametrize("level", range(6))
def test_the_mipmap_level_is_that_of_the_footprint(renderer, level):
    """A pixel as large as 2^k x 2^k texels shows their mean, level k exactly (FoCG 11.3.3)."""
    texels, side = _noise(64, 64), 64 >> level
    seen = _shown(Texture(Texels(texels, srgb=False)), side, renderer)
    block = 1 << level
    mean = texels[..., :3].reshape(side, block, side, block, 3).mean(axis=(1, 3)) / 255.0
    np.testing.assert_allclose(seen, mean, atol=0.5 * level / 255 + 1e-5)  # each level is rounded to bytes


def test_between_two_levels_both_are_mixed():
    """A pixel of 2^1.5 texels a side: half of level 1, half of level 2, both bilinear."""
    texels = np.zeros((64, 64, 4), np.uint8)
    texels[:, ::4] = texels[:, 1::4] = 255  # level 1: 255, 0, 255, 0; level 2: 127.5 everywhere
    texels[..., 3] = 255
    n = round(64 / 2**1.5)
    seen = _shown(Texture(Texels(texels, srgb=False)), n)[n // 2, :, 0]
    fraction = np.log2(64 / n) - 1
    x = (np.arange(n) + 0.5) / n * 32 - 0.5
    i = np.floor(x).astype(int)
    level1 = np.where(i % 2 == 0, 1 - (x - i), x - i)
    np.testing.assert_allclose(seen[1:-1], ((1 - fraction) * level1 + fraction * 128 / 255)[1:-1], atol=0.005)


def test_texture_coordinates_are_perspective_correct():
    """u = ((1-a) u0/z0 + a u1/z1) / ((1-a)/z0 + a/z1) along a line of the screen (FoCG 11.3.1, as in the errata)."""
    z0, z1, width = 1.5, 9.0, 65
    wall = Mesh(
        np.array([[-1, -3, -z0], [3, -3, -z1], [3, 3, -z1], [-1, 3, -z0]], np.float32), np.array([[0, 1, 2], [0, 2, 3]], np.int32),
        uvs=np.array([[0.25, 0], [7.0, 0], [7.0, 1], [0.25, 1]], np.float32),
    )  # fmt: skip
    camera = PerspectiveCamera(yfov_degrees=90)
    for renderer in ("raster", "ray"):
        image = render(scene_of(place(wall), camera=camera), width=width, height=width, renderer=renderer, samples=1, aovs=("uv",))
        u = image.aov["uv"][width // 2, :, 0]
        x = (np.arange(width) - width // 2) / (width / 2)
        x0, x1 = -1 / z0, 3 / z1
        inside = (x > x0) & (x < x1)
        a = (x[inside] - x0) / (x1 - x0)
        expected = ((1 - a) * 0.25 / z0 + a * 7.0 / z1) / ((1 - a) / z0 + a / z1)
        assert inside.sum() > 20
        np.testing.assert_allclose(u[inside], expected, rtol=2e-5)


@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_coordinates_of_the_sphere(renderer):
    """u = 1/2 + atan2(-z, x) / 2 pi, v = 1 - acos(y / r) / pi (FoCG 11.1, turned to y up)."""
    camera = PerspectiveCamera.look_at((2, 1, 3), (0, 0, 0))
    scene = scene_of(place(Sphere(1.5), at=(0.2, 0, 0)), camera=camera)
    image = render(scene, width=48, height=48, renderer=renderer, samples=1, aovs=("uv", "position", "instance_id", "normal"))
    hit = image.aov["instance_id"] == 0
    x, y, z = (image.aov["position"][hit].astype(np.float64) - (0.2, 0, 0)).T / 1.5
    np.testing.assert_allclose(x * x + y * y + z * z, 1.0, atol=2e-6)
    expected = np.stack([0.5 + np.arctan2(-z, x) / (2 * np.pi), 1 - np.arccos(y) / np.pi], axis=1)
    np.testing.assert_allclose(image.aov["uv"][hit], expected, atol=1e-5)
    np.testing.assert_allclose(image.aov["normal"][hit], np.stack([x, y, z], 1), atol=2e-6)


def test_texture_transform_is_that_of_the_description():
    """T(offset) R(rotation) S(scale) (u, v)."""
    texels, angle = _noise(16, 16), 0.3
    texture = Texture(Texels(texels, srgb=False), filter="nearest", offset=(0.3, -0.2), scale=(1.7, 0.6), rotation=angle)
    seen = _shown(texture, 32)
    v, u = np.meshgrid((np.arange(32) + 0.5) / 32, (np.arange(32) + 0.5) / 32, indexing="ij")
    su, sv = 1.7 * u, 0.6 * v
    s = np.cos(angle) * su - np.sin(angle) * sv + 0.3
    t = np.sin(angle) * su + np.cos(angle) * sv - 0.2
    expected = texels[np.floor(t % 1 * 16).astype(int), np.floor(s % 1 * 16).astype(int), :3] / 255.0
    assert (np.abs(seen - expected).max(axis=2) > 1e-5).mean() < 0.01  # where float32 rounds over a texel's border


def _both(texture: Texture, uvs: object = None) -> list[Image]:
    mesh = SQUARE if uvs is None else Mesh(SQUARE.positions, SQUARE.triangles, uvs=np.asarray(uvs, np.float32))
    scene = scene_of(place(mesh, Lambert(color=1, texture=texture)), AMBIENT, camera=_facing())
    return [render(scene, width=16, height=16, renderer=name, samples=1) for name in ("raster", "ray")]


@pytest.mark.parametrize(("height", "width"), [(1, 1), (1, 4096), (4096, 1), (3, 7), (255, 129)])
@pytest.mark.parametrize("mode", ["nearest", "bilinear", "trilinear", "anisotropic", "ripmap"])
def test_textures_of_any_size(height, width, mode):
    """Every value lies between the least and the greatest texel."""
    texels = _noise(height, width)
    for wrap in ("repeat", "mirror", "clamp"):
        for image in _both(Texture(Texels(texels, srgb=False), filter=mode, wrap_u=wrap, wrap_v=wrap, scale=(3.7, 2.1))):
            low, high = texels[..., :3].min(axis=(0, 1)) / 255.0, texels[..., :3].max(axis=(0, 1)) / 255.0
            assert (image.pixels[..., :3] >= low - 1e-5).all()
            assert (image.pixels[..., :3] <= high + 1e-5).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 3e38, -3e38, 1e20])
def test_coordinates_that_are_no_places(bad):
    """NaN, infinity, and numbers without a fraction: some texel, no crash."""
    uvs = [[bad, 0], [1, bad], [1, 1], [0, 1]]
    for mode in ("nearest", "bilinear", "trilinear", "anisotropic", "ripmap"):
        for image in _both(Texture(Texels(_noise(8, 8)), filter=mode), uvs):
            assert np.isfinite(image.pixels).all()


@pytest.mark.parametrize("wrap", [0, 1, 2])
def test_folding_is_exact(wrap):
    """Repeat: x - floor x. Mirror: the triangle wave of period 2. Clamp: the border. Always within [0, 1]."""
    x = np.concatenate([np.random.default_rng(2).normal(size=2000) * 5, [0, 1, -1, 2, -1e-9, 1e-45, 3e38, -3e38, np.inf, -np.inf, np.nan]])
    x = x.astype(np.float32)
    folded = over(texture_kernels._fold, x, np.full(len(x), wrap))
    assert ((folded >= 0) & (folded <= 1)).all()
    y = x[:2000].astype(np.float64)
    expected = (y - np.floor(y), 1 - np.abs(y % 2 - 1), np.clip(y, 0, 1))[wrap]
    np.testing.assert_allclose(folded[:2000], expected, atol=2e-6)


def test_a_normal_map_leans_the_normal():
    """Green leans it along the bitangent, up the texture; flat blue changes nothing (glTF 2.0, 3.9.3)."""

    def normal_for(rgb: tuple[int, int, int], scale: float = 1.0) -> NDArray[np.float64]:
        texels = np.full((2, 2, 4), (*rgb, 255), np.uint8)
        bumpy = MetallicRoughness(metallic=0.0, normal_texture=Texture(Texels(texels, srgb=False)), normal_scale=scale)
        scene = scene_of(place(SQUARE, bumpy), AMBIENT, camera=_facing())
        return render(scene, width=4, height=4, samples=1, aovs=("normal",)).aov["normal"][1, 1].astype(np.float64)

    np.testing.assert_allclose(normal_for((128, 128, 255)), (0, 0, 1), atol=0.006)
    np.testing.assert_allclose(normal_for((255, 128, 128)), (1, 0, 0), atol=0.006)
    np.testing.assert_allclose(normal_for((128, 255, 128)), (0, 1, 0), atol=0.006)
    lean = 2 * np.array((200, 160, 220)) / 255 - 1
    np.testing.assert_allclose(normal_for((200, 160, 220)), lean / np.linalg.norm(lean), atol=1e-5)
    half = lean * (0.5, 0.5, 1)
    np.testing.assert_allclose(normal_for((200, 160, 220), 0.5), half / np.linalg.norm(half), atol=1e-5)
