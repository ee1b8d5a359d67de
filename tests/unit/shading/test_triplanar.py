"""Tri-planar mapping: one picture along each axis of the object, mixed as the surface faces them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from compiled import door_of
from numpy.typing import NDArray

from limner._door import Array
from limner.errors import SceneError
from limner.kernel.lanes import load8, store8
from limner.kernel.vec import ONE, ZERO, Color, Vec3
from limner.scene.texture import Texels, Texture
from limner.shading.surface import Detail, Footprint, SurfacePoint
from limner.shading.texture import sample_texture
from limner.tables.layouts import TEXTURE
from limner.tables.textures import texture_tables

PIXELS = np.random.default_rng(6).integers(0, 256, (8, 8, 4), dtype=np.uint8)


def _look_up(textures, texels, rows, out):
    """rows: p, n, dp/dx, dp/dy, twelve numbers in columns."""
    for k in range(rows.shape[1]):
        r = rows[:, k]
        up, color = Vec3(ZERO, ZERO, ONE), Color(ONE, ONE, ONE)
        p, n, dpdx, dpdy = Vec3(r[0], r[1], r[2]), Vec3(r[3], r[4], r[5]), Vec3(r[6], r[7], r[8]), Vec3(r[9], r[10], r[11])
        footprint = Footprint(ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO)
        detail = Detail(p, n, dpdx, dpdy, up, up)
        point = SurfacePoint(up, up, up, up, ONE, ZERO, ZERO, ZERO, ZERO, color, ONE, footprint, 0, up, ONE, detail)
        c, a = sample_texture(textures[0], texels, point)
        out[0, k], out[1, k], out[2, k], out[3, k] = c.r, c.g, c.b, a


def _look_up_eight(textures, texels, rows, out):
    for k in range(0, rows.shape[1], 8):
        zero, one = load8(rows[0], k) * ZERO, load8(rows[0], k) * ZERO + ONE
        up, color = Vec3(zero, zero, one), Color(one, one, one)
        p, n = Vec3(load8(rows[0], k), load8(rows[1], k), load8(rows[2], k)), Vec3(load8(rows[3], k), load8(rows[4], k), load8(rows[5], k))
        dpdx = Vec3(load8(rows[6], k), load8(rows[7], k), load8(rows[8], k))
        dpdy = Vec3(load8(rows[9], k), load8(rows[10], k), load8(rows[11], k))
        footprint = Footprint(zero, zero, zero, zero, zero, zero, zero, zero)
        detail = Detail(p, n, dpdx, dpdy, up, up)
        point = SurfacePoint(up, up, up, up, one, zero, zero, zero, zero, color, one, footprint, 0, up, one, detail)
        c, a = sample_texture(textures[0], texels, point)
        store8(out[0], k, c.r)
        store8(out[1], k, c.g)
        store8(out[2], k, c.b)
        store8(out[3], k, a)


def _seen(texture: Texture, p: Any, n: Any, dpdx: Any = 0.0, dpdy: Any = 0.0, entry: Any = _look_up) -> NDArray[np.float32]:
    """(n, 4) at (n, 3) places with (n, 3) normals."""
    p = np.asarray(p, np.float32)
    rows = np.concatenate([np.broadcast_to(x, p.shape) for x in (p, n, dpdx, dpdy)], axis=1).T
    out = np.zeros((4, len(p)), np.float32)
    records, texels = texture_tables([texture])
    door_of(entry, Array(TEXTURE, 1), Array(np.uint8, 1), Array(np.float32, 2), Array(np.float32, 2))(
        records, texels, np.ascontiguousarray(rows, np.float32), out
    )
    return out.T


def _texture(**fields: Any) -> Texture:
    return Texture(Texels(PIXELS, srgb=False), mapping="triplanar", **{"filter": "bilinear", **fields})


def _on_face(p: NDArray[np.float64], u: Any, v: Any, filter_: str = "bilinear", change: Any = 0.0) -> NDArray[np.float32]:
    """The picture looked up at coordinates (u, v), by tri-planar mapping of a face that looks along +z."""
    flat = np.stack([u, v, np.zeros_like(u)], axis=1)
    return _seen(_texture(filter=filter_), flat, (0, 0, 1), change, 0.0)


POINTS = np.random.default_rng(2).uniform(-2, 2, (24, 3))


@pytest.mark.parametrize(
    ("normal", "u", "v"),
    [
        ((1, 0, 0), -POINTS[:, 2], POINTS[:, 1]), ((-1, 0, 0), POINTS[:, 2], POINTS[:, 1]),
        ((0, 1, 0), POINTS[:, 0], -POINTS[:, 2]), ((0, -1, 0), POINTS[:, 0], POINTS[:, 2]), ((0, 0, -1), -POINTS[:, 0], POINTS[:, 1]),
    ],
)  # fmt: skip
def test_each_face_of_a_cube_shows_the_picture_upright(normal, u, v):
    """Seen from outside, u runs to the right and v up (from above and below: away from and towards +z); nothing is mirrored."""
    np.testing.assert_array_equal(_seen(_texture(), POINTS, normal), _on_face(POINTS, u, v))
    right, up = np.cross((0, 1, 0), normal), np.array((0, 1, 0))
    if normal[1] == 0:
        np.testing.assert_allclose(POINTS @ right, u)
        np.testing.assert_allclose(POINTS @ up, v)


@pytest.mark.parametrize("sharpness", [0.0, 1.0, 4.0, 16.0])
def test_between_faces_the_weights_are_powers_of_the_normal(sharpness):
    """|n|^k over their sum."""
    normals = np.random.default_rng(9).normal(size=POINTS.shape)
    seen = _seen(_texture(sharpness=sharpness), POINTS, normals)
    unit = np.abs(normals / np.linalg.norm(normals, axis=1, keepdims=True))
    weights = unit**sharpness / (unit**sharpness).sum(axis=1, keepdims=True)
    x = np.where(normals[:, 0] < 0, POINTS[:, 2], -POINTS[:, 2]), POINTS[:, 1]
    y = POINTS[:, 0], np.where(normals[:, 1] < 0, POINTS[:, 2], -POINTS[:, 2])
    z = np.where(normals[:, 2] < 0, -POINTS[:, 0], POINTS[:, 0]), POINTS[:, 1]
    expected = sum(_on_face(POINTS, *uv) * weights[:, k : k + 1] for k, uv in enumerate((x, y, z)))
    np.testing.assert_allclose(seen, expected, atol=2e-5)


def test_footprints_choose_the_level():
    """A pixel as wide as the picture sees its mean."""
    seen = _seen(_texture(filter="trilinear"), POINTS, (1, 2, 3), (1, 1, 1), (0, 0, 0))
    np.testing.assert_allclose(seen, np.broadcast_to(seen[0], seen.shape), atol=1e-6)
    opaque = PIXELS.astype(np.float64)
    mean = (opaque[..., :3] * opaque[..., 3:]).sum(axis=(0, 1)) / opaque[..., 3:].sum() / 255.0
    np.testing.assert_allclose(seen[0, :3], mean, atol=2.0 / 255.0)


@pytest.mark.parametrize("filter_", ["nearest", "trilinear", "anisotropic", "ripmap"])
def test_eight_lanes_are_eight_numbers(filter_):
    """To the bit, whatever the filter."""
    normals = np.random.default_rng(3).normal(size=POINTS.shape)
    arguments = (_texture(filter=filter_), POINTS, normals, (0.1, 0.3, 0.02), (0.0, 0.1, 0.05))
    one, eight = _seen(*arguments), _seen(*arguments, entry=_look_up_eight)
    np.testing.assert_array_equal(one.view(np.int32), eight.view(np.int32))


def test_what_is_wrong_is_said():
    """Errors name the field, and what was expected."""
    with pytest.raises(SceneError, match='texture.mapping must be "uv" or "triplanar", got "box"'.replace('"box"', "'box'")):
        Texture(Texels(PIXELS), mapping="box")
    with pytest.raises(SceneError, match=r"texture.sharpness must lie in \[0, 64\], got 65"):
        _texture(sharpness=65)
