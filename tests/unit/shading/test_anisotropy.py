"""Textures seen at a slant (FoCG 11.3.3): footprints against singular values, ripmaps against means, pictures against many samples."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from compiled import door_of, over
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, place, scene_of

from limner._door import Array
from limner._jit import MODE
from limner.errors import SceneError
from limner.image.mipmap import copy_places, level_sizes, mipmaps, ripmaps, side_lengths
from limner.kernel.vec import ONE, ZERO, Color, Vec3
from limner.render import render
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import AmbientLight
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.shape import Plane
from limner.scene.texture import Texels, Texture
from limner.shading.anisotropy import MAX_PROBES, probes_of_footprint, reduction_along
from limner.shading.surface import Footprint, SurfacePoint, no_detail
from limner.shading.texture import sample_texture
from limner.tables.layouts import TEXTURE
from limner.tables.textures import texture_tables

SIZES = [(1, 1), (1, 4096), (4096, 1), (3, 5), (64, 32), (255, 129)]
SHARPER = ("anisotropic", "ripmap")


def _look_up(textures, texels, rows, out):
    """rows: u, v, u1, v1 and the eight numbers of the footprint."""
    for k in range(rows.shape[0]):
        r = rows[k]
        up, color = Vec3(ZERO, ZERO, ONE), Color(ONE, ONE, ONE)
        footprint = Footprint(r[4], r[5], r[6], r[7], r[8], r[9], r[10], r[11])
        point = SurfacePoint(up, up, up, up, ONE, r[0], r[1], r[2], r[3], color, ONE, footprint, 0, up, ONE, no_detail(ONE))
        c, alpha = sample_texture(textures[0], texels, point)
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = c.r, c.g, c.b, alpha


def _seen(texture: Texture, at: object, changes: object, *others: Texture) -> NDArray[np.float32]:
    """What is looked up at (n, 2) places over (n, 4) footprints dudx, dvdx, dudy, dvdy; the other uv set stands elsewhere."""
    at, changes = np.atleast_2d(np.asarray(at, np.float32)), np.atleast_2d(np.asarray(changes, np.float32))
    n = max(len(at), len(changes))
    rows = np.full((n, 12), 0.37, np.float32)
    rows[:, 2 * texture.uv_set : 2 * texture.uv_set + 2] = at
    rows[:, 4 + 4 * texture.uv_set : 8 + 4 * texture.uv_set] = changes
    records, texels = texture_tables([texture, *others])
    out = np.zeros((n, 4), np.float32)
    door_of(_look_up, Array(TEXTURE, 1), Array(np.uint8, 1), Array(np.float32, 2), Array(np.float32, 2))(records, texels, rows, out)
    return out


def _noise(height: int, width: int) -> NDArray[np.uint8]:
    return np.random.default_rng(5).integers(0, 256, size=(height, width, 4), dtype=np.uint8)


def _opaque(height: int, width: int) -> NDArray[np.uint8]:
    pixels = _noise(height, width)
    pixels[..., 3] = 255
    return pixels


# --- the footprint --------------------------------------------------------------------------------------------------------


@given(angle=st.floats(0, 6.28), turn=st.floats(0, 6.28), shorter=st.floats(0.01, 100), ratio=st.floats(1.1, 60))
def test_probes_lie_along_the_longer_singular_vector(angle: float, turn: float, shorter: float, ratio: float) -> None:
    """J = U diag(l, s) V^T: as many circles of width max(s, l/16, 1 texel) as cover l from end to end, along U's first column."""
    longer, width, height = shorter * ratio, 64.0, 256.0
    axes = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    jacobian = np.diag([1 / width, 1 / height]) @ axes @ np.diag([longer, shorter]) @ turned
    count, level, du, dv = over(probes_of_footprint, *jacobian.T.reshape(4, 1), width, height)
    wide = max(shorter, longer / MAX_PROBES, 1.0)
    if longer <= 1.07 * wide:
        assert (count[0], du[0], dv[0]) == (1, 0.0, 0.0)
        assert level[0] == pytest.approx(max(0.0, np.log2(longer)), abs=1e-4)
        return
    assert int(np.ceil(longer / wide - 0.07)) <= count[0] <= min(MAX_PROBES, int(np.ceil(longer / wide - 0.06)))
    assert level[0] == pytest.approx(np.log2(wide), abs=1e-3)
    along = np.array([du[0] * width, dv[0] * height])
    assert np.linalg.norm(along) + wide == pytest.approx(longer, rel=1e-3)
    assert abs(along @ axes[:, 0]) == pytest.approx(np.linalg.norm(along), rel=1e-4)


def test_reduction_is_that_of_the_ellipse_bounding_box() -> None:
    """A circle of one pixel becomes an ellipse: its extent along u is found by walking round it."""
    dx, dy = np.random.default_rng(1).normal(size=(2, 200)) * 0.2
    round_ = np.linspace(0, 2 * np.pi, 4000)[:, None]
    extent = 2 * 64 * (0.5 * (dx * np.cos(round_) + dy * np.sin(round_))).max(axis=0)
    np.testing.assert_allclose(over(reduction_along, dx, dy, 64.0), np.log2(np.maximum(extent, 1.0)), atol=1e-5)


# --- ripmaps --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("srgb", [False, True])
@pytest.mark.parametrize(("height", "width"), [*SIZES, (5, 3)])
def test_the_mipmap_is_the_diagonal_of_the_ripmap(height: int, width: int, srgb: bool) -> None:
    """To the bit; and the whole is as large as the sum of all widths times the sum of all heights, less than four pictures."""
    pixels, places = _noise(height, width), copy_places(width, height)
    sizes = level_sizes(width, height)
    n_bytes = 4 * sum(side_lengths(width)) * sum(side_lengths(height))
    assert n_bytes < 4 * pixels.size
    mip, rip = np.zeros(4 * sum(w * h for w, h in sizes), np.uint8), np.zeros(n_bytes, np.uint8)
    mipmaps(pixels, srgb, mip)
    ripmaps(pixels, srgb, rip)
    start = 0
    for k, (w, h) in enumerate(sizes):
        place = places[min(k, places.shape[0] - 1), min(k, places.shape[1] - 1)]
        np.testing.assert_array_equal(rip[place : place + 4 * w * h], mip[start : start + 4 * w * h])
        start += 4 * w * h


@pytest.mark.parametrize("across", range(5))
@pytest.mark.parametrize("down", range(6))
def test_a_ripmap_averages_rectangles(across: int, down: int) -> None:
    """A footprint of 2^k x 2^l texels shows the mean of these: copy (k, l), looked up in the middle of its texels."""
    height, width = 64, 32
    pixels = _opaque(height, width)
    wide, high = 1 << across, 1 << down
    rows, columns = np.indices((height // high, width // wide)) + 0.5
    middles = np.stack([columns * wide / width, rows * high / height], axis=-1).reshape(-1, 2)
    seen = _seen(Texture(Texels(pixels, srgb=False), filter="ripmap"), middles, (wide / width, 0, 0, high / height))
    mean = pixels.reshape(height // high, high, width // wide, wide, 4).mean(axis=(1, 3)) / 255.0
    rounded = 0.5 * max(across, down) / 255  # each copy is rounded to bytes
    np.testing.assert_allclose(seen, mean.reshape(-1, 4), atol=rounded + 1e-6)


def test_between_the_copies_of_a_ripmap_all_four_are_mixed() -> None:
    """Bilinear in (k, l): the extents' logarithms weigh the copies (FoCG 11.3.3)."""
    texture = Texture(Texels(_opaque(32, 32), srgb=False), filter="ripmap", wrap_u="mirror")
    at = np.random.default_rng(3).random((50, 2))
    a, b = 0.3, 0.85

    def over_extents(k: float, j: float) -> NDArray[np.float32]:
        return _seen(texture, at, (2**k / 32, 0, 0, 2**j / 32))

    low = (1 - a) * over_extents(1, 2) + a * over_extents(2, 2)
    high = (1 - a) * over_extents(1, 3) + a * over_extents(2, 3)
    np.testing.assert_allclose(over_extents(1 + a, 2 + b), (1 - b) * low + b * high, atol=1e-5)


def test_who_else_looks_into_the_texels_sees_the_same_bits() -> None:
    """Texels stand in the tables once: the mipmaps of other textures are then the ripmap's diagonal."""
    texels = Texels(_noise(37, 90))
    at, changes = np.random.default_rng(4).random((200, 2)), np.random.default_rng(6).normal(size=(200, 4)) * 0.2
    for name in ("nearest", "bilinear", "trilinear", "anisotropic"):
        texture = Texture(texels, filter=name)
        alone, beside = _seen(texture, at, changes), _seen(texture, at, changes, Texture(texels, filter="ripmap"))
        np.testing.assert_array_equal(alone, beside)


def test_levels_are_not_brighter_than_the_picture() -> None:
    """Halves go to the even code: the mean of noise stays, where rounding up would add 1/8 of a code per level."""
    pixels = np.random.default_rng(8).integers(0, 256, size=(1024, 1024, 4), dtype=np.uint8)
    pixels[..., 3] = 255
    out = np.zeros(4 * sum(w * h for w, h in level_sizes(1024, 1024)), np.uint8)
    mipmaps(pixels, False, out)
    start = 4 * (1024**2 + 512**2 + 256**2)
    level3 = out[start : start + 4 * 128**2].reshape(-1, 4)[:, :3]
    assert abs(level3.mean() - pixels[..., :3].mean()) < 0.03


# --- lookups --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [3, 7, 15])
def test_a_thin_footprint_is_the_mean_of_its_texels(count: int) -> None:
    """One texel wide, n long, centred on a texel: their mean, whichever way it lies."""
    pixels = _opaque(32, 32)
    texture, middle = Texture(Texels(pixels, srgb=False), filter="anisotropic"), (np.array([16.5, 16.5]) / 32)
    reach = count // 2
    for changes, block in (
        ((count / 32, 0, 0, 1 / 32), pixels[16, 16 - reach : 17 + reach]),
        ((1 / 32, 0, 0, -count / 32), pixels[16 - reach : 17 + reach, 16]),
        ((0, count / 32, -1 / 32, 0), pixels[16 - reach : 17 + reach, 16]),
    ):
        np.testing.assert_allclose(_seen(texture, middle, changes)[0], block.mean(axis=0) / 255.0, atol=1e-5)


@pytest.mark.parametrize("srgb", [False, True])
@pytest.mark.parametrize("name", SHARPER)
def test_a_constant_texture_stays_constant_to_the_bit(name: str, srgb: bool) -> None:
    """However many probes or copies are mixed."""
    generator = np.random.default_rng(7)
    at = generator.normal(size=(500, 2)) * 3
    changes = generator.normal(size=(500, 4)) * 10.0 ** generator.uniform(-3, 1, size=(500, 1))
    for value in (1, 37, 128, 200, 255):
        texture = Texture(Texels(np.full((21, 64, 4), value, np.uint8), srgb=srgb), filter=name)
        seen = _seen(texture, at, changes)
        exact = _seen(Texture(texture.texels, filter="nearest"), at[:1], changes[:1])
        assert (seen == exact).all()


def test_a_round_footprint_is_looked_up_as_by_trilinear() -> None:
    """Of any size and turned at will: one probe in the same level; a ripmap where the level is whole."""
    generator = np.random.default_rng(9)
    texels = Texels(_noise(64, 64))
    at, angle, size = generator.random((300, 2)), generator.uniform(0, 6.28, 300), 2.0 ** generator.uniform(-2, 8, 300)

    def changes(side: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y = np.cos(angle) * side / 64, np.sin(angle) * side / 64
        return np.stack([x, y, -y, x], axis=1)

    def seen(name: str, side: NDArray[np.float64]) -> NDArray[np.float32]:
        return _seen(Texture(texels, filter=name), at, changes(side))

    np.testing.assert_allclose(seen("anisotropic", size), seen("trilinear", size), atol=1e-5)
    whole = 2.0 ** np.round(np.log2(size))
    np.testing.assert_allclose(seen("ripmap", whole), seen("trilinear", whole), atol=1e-5)


@pytest.mark.parametrize("uv_set", [0, 1])
@pytest.mark.parametrize("name", SHARPER)
def test_the_footprint_is_transformed_with_the_coordinates(name: str, uv_set: int) -> None:
    """Looking through T R S is looking at transformed coordinates over a transformed footprint; each uv set has its own."""
    generator = np.random.default_rng(10)
    at, changes = generator.random((200, 2)), generator.normal(size=(200, 4)) * 0.05
    angle, scale, offset = 0.7, (3.0, -0.4), (0.2, 0.9)
    texels = Texels(_noise(64, 32))
    seen = _seen(Texture(texels, filter=name, rotation=angle, scale=scale, offset=offset, uv_set=uv_set), at, changes)
    linear = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ np.diag(scale)
    moved = np.concatenate([changes[:, :2] @ linear.T, changes[:, 2:] @ linear.T], axis=1)
    expected = _seen(Texture(texels, filter=name), at @ linear.T + offset, moved)
    np.testing.assert_allclose(seen, expected, atol=2e-3)  # float32 coordinates differ in the last bit
    assert np.abs(seen - expected).mean() < 2e-5


@pytest.mark.parametrize(("height", "width"), SIZES)
@pytest.mark.parametrize("name", SHARPER)
def test_any_size_any_footprint_stays_within_the_texels(name: str, height: int, width: int) -> None:
    """Every lookup is a mean: long, thin, huge, tiny, degenerate, infinite and missing footprints, and no place at all."""
    generator = np.random.default_rng(11)
    pixels = _noise(height, width)
    at = generator.normal(size=(600, 2)) * 3
    changes = generator.normal(size=(600, 4)) * 10.0 ** generator.uniform(-6, 6, size=(600, 4))
    nasty = np.array([0.0, np.nan, np.inf, -np.inf, 1e20, 3e38, 1e-45])
    changes[:300] = np.where(generator.random((300, 4)) < 0.4, generator.choice(nasty, (300, 4)), changes[:300])
    at[:100] = np.where(generator.random((100, 2)) < 0.5, generator.choice(nasty, (100, 2)), at[:100])
    with np.errstate(over="ignore"):
        at, changes = at.astype(np.float32), changes.astype(np.float32)
    for wrap in ("repeat", "mirror", "clamp"):
        seen = _seen(Texture(Texels(pixels, srgb=False), filter=name, wrap_u=wrap, wrap_v=wrap), at, changes)
        assert (seen[:, 3] >= pixels[..., 3].min() / 255 - 1e-5).all()
        assert (seen[:, 3] <= pixels[..., 3].max() / 255 + 1e-5).all()
        assert (seen[:, :3] >= -1e-5).all()
        assert (seen[:, :3] <= 1 + 1e-5).all()


def test_an_unknown_filter_is_refused_by_name() -> None:
    """In one line that says what there is."""
    with pytest.raises(SceneError, match=r'"trilinear", "anisotropic" or "ripmap", got \'sharp\''):
        Texture(Texels(_noise(2, 2)), filter="sharp")  # type: ignore[arg-type]


# --- pictures -------------------------------------------------------------------------------------------------------------


def _floor(name: str, samples: int, turned: float, width: int = 144, height: int = 96) -> NDArray[np.float64]:
    """A chessboard to the horizon, which stands at a third from the top."""
    tiles = np.full((64, 64, 4), 255, np.uint8)
    tiles[(np.indices((64, 64)) // 32).sum(axis=0) % 2 == 1, :3] = 30
    texture = Texture(Texels(tiles), filter=name, rotation=turned)
    camera = PerspectiveCamera.look_at((0.3, 0.6, 0.0), (0.3, 0.45, -1.0), yfov_degrees=50)
    sky = Node(lights=(AmbientLight(intensity=1.0),))
    scene = scene_of(place(Plane(), Lambert(color=1, texture=texture)), sky, camera=camera, background=(0.5, 0.5, 0.5))
    image = render(scene, width=width, height=height, samples=samples, antialiasing="supersample", threads=1)
    return image.pixels[..., :3].astype(np.float64)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("turned", [0.0, 0.3, np.pi / 4])
def test_towards_the_horizon_each_filter_is_nearer_to_many_samples(turned: float) -> None:
    """anisotropic < ripmap < trilinear < bilinear, over all and near the horizon; the first no worse than the reference's own noise."""
    truth = _floor("bilinear", 64, turned)
    horizon = int(np.argmax(np.abs(truth - truth[0, 0]).max(axis=(1, 2)) > 1e-3))
    assert 15 < horizon < 45
    errors = {name: (_floor(name, 1, turned) - truth) ** 2 for name in ("anisotropic", "ripmap", "trilinear", "bilinear")}
    for rows in (slice(None), slice(horizon, horizon + 16)):
        anisotropic, ripmap, trilinear, bilinear = (np.sqrt(error[rows].mean()) for error in errors.values())
        assert anisotropic < 0.4 * trilinear
        assert anisotropic < 0.6 * ripmap
        assert ripmap < trilinear if turned == 0.0 else ripmap < 1.02 * trilinear
        assert trilinear < 0.5 * bilinear


# --- modes ----------------------------------------------------------------------------------------------------------------


def _digest() -> str:
    """Of many lookups through each filter."""
    generator = np.random.default_rng(12)
    at = generator.normal(size=(60, 2))
    changes = generator.normal(size=(60, 4)) * 10.0 ** generator.uniform(-3, 1, size=(60, 4))
    found = hashlib.blake2b(digest_size=16)
    for name in ("trilinear", *SHARPER):
        found.update(_seen(Texture(Texels(_noise(24, 37)), filter=name, wrap_v="mirror"), at, changes).tobytes())
    return found.hexdigest()


@pytest.mark.skipif(MODE != "compiled", reason="needs both modes")
def test_compiled_and_python_agree_to_the_bit() -> None:
    """The same lookups in a process whose kernels are Python."""
    here = Path(__file__).resolve()
    paths = (here.parent, here.parents[2], here.parents[3] / "src")
    command = f"import sys; sys.path[:0] = {list(map(str, paths))!r}; import test_anisotropy as t; sys.stdout.write(t._digest())"
    in_python = {**os.environ, "LIMNER_MODE": "python"}
    done = subprocess.run([sys.executable, "-c", command], env=in_python, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == _digest()
