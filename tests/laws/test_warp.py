"""Warps keep their promises: what they produce has the density they claim, its integral is 1, and the inverse inverts.

The chi-squared tests compare counts of warped points with the integral of the pdf over the cells of the *place*, computed in
float64 independently of the warp.
"""

from __future__ import annotations

import numpy as np
import pytest
from compiled import over

from limner._jit import MODE
from limner.kernel import warp

stats = pytest.importorskip("scipy.stats")
N = 40_000 if MODE == "compiled" else 8_000
_HEIGHTS = [2.0, 1.0, 0.3, 1e-3, 1e-6]


def _square(n: int = N) -> tuple[np.ndarray, np.ndarray]:
    u, v = np.random.default_rng(11).random((2, n), dtype=np.float32)
    return u, v


def _corners() -> tuple[np.ndarray, np.ndarray]:
    """The square's corners, edges, centre and diagonals, where branches meet."""
    ticks = np.float32([0.0, 1e-7, 0.25, 0.5, 0.75, 1.0 - 2.0**-24, 1.0])
    u, v = np.meshgrid(ticks, ticks)
    return u.ravel(), v.ravel()


def _assert_even(counts: np.ndarray) -> None:
    assert stats.chisquare(counts.ravel()).pvalue > 1e-3


def _assert_same_place(square: tuple[np.ndarray, np.ndarray], back: tuple[np.ndarray, np.ndarray], tolerance: float) -> None:
    for got, want in zip(back, square, strict=True):
        np.testing.assert_allclose(got, want, atol=tolerance)


def _azimuth_cells(x: np.ndarray, y: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Counts over 16 azimuths x 8 values of a coordinate in [0, 1] that is uniform if the warp is right."""
    turn = np.arctan2(y.astype(np.float64), x) / (2 * np.pi) % 1.0
    return np.histogram2d(turn, np.clip(height, 0, 1), (16, 8), ((0, 1), (0, 1)))[0]


# --- disk -----------------------------------------------------------------------------------------------------------------


def test_disk_is_uniform_and_its_pdf_integrates_to_one() -> None:
    """r^2 and the azimuth are uniform; the pdf is 1/pi inside, 0 outside."""
    x, y = over(warp.warp_disk, *_square())
    _assert_even(_azimuth_cells(x, y, x.astype(np.float64) ** 2 + y.astype(np.float64) ** 2))
    grid = (np.arange(300) + 0.5) / 150 - 1
    a, b = (axis.ravel() for axis in np.meshgrid(grid[::3], grid[::3]))
    assert np.sum(over(warp.pdf_disk, a, b)) / 50**2 == pytest.approx(1.0, abs=5e-3)


def test_disk_there_and_back() -> None:
    """Within 4e-7 of the square's point, also on its edges and diagonals; edges of the square go to the circle."""
    for square in (_square(2000), _corners()):
        x, y = over(warp.warp_disk, *square)
        _assert_same_place(square, over(warp.inverse_disk, x, y), 4e-7)
        radius = np.maximum(np.abs(2 * square[0].astype(np.float64) - 1), np.abs(2 * square[1].astype(np.float64) - 1))
        np.testing.assert_allclose(np.hypot(x, y), radius, atol=3e-7)


def test_disk_is_continuous() -> None:
    """Neighbours stay neighbours across the diagonals: the greatest stretch of the concentric map is 2.77, on the diagonals."""
    t = np.linspace(0, 1, 500, dtype=np.float32)
    step = np.float32(1e-3)
    for u, v in ((t, t), (t, 1 - t), (t, np.full_like(t, 0.5)), (np.full_like(t, 0.5), t)):
        here = np.stack(over(warp.warp_disk, u, v))
        for du, dv in ((step, 0), (0, step), (step, step), (step, -step)):
            there = np.stack(over(warp.warp_disk, u + np.float32(du), v + np.float32(dv)))
            assert np.all(np.hypot(*(there - here)) < 2.8 * np.hypot(du, dv))


# --- directions -----------------------------------------------------------------------------------------------------------


def test_hemisphere_is_cosine_distributed() -> None:
    """1 - z^2 and the azimuth are uniform, directions are unit and up; the pdf integrates to 1 over the hemisphere."""
    d = over(warp.warp_hemisphere_cosine, *_square())
    np.testing.assert_allclose(np.linalg.norm(d.astype(np.float64), axis=1), 1.0, atol=3e-7)
    assert np.all(d[:, 2] >= 0)
    _assert_even(_azimuth_cells(d[:, 0], d[:, 1], 1 - d[:, 2].astype(np.float64) ** 2))
    z = (np.arange(4000) + 0.5) / 2000 - 1
    assert np.sum(over(warp.pdf_hemisphere_cosine, z)) * 2 * np.pi / 2000 == pytest.approx(1.0, rel=1e-5)
    assert np.all(over(warp.pdf_hemisphere_cosine, z[z < 0]) == 0)


def test_hemisphere_there_and_back() -> None:
    """The inverse is the disk's."""
    for square in (_square(2000), _corners()):
        d = over(warp.warp_hemisphere_cosine, *square)
        _assert_same_place(square, over(warp.inverse_hemisphere_cosine, d), 4e-7)


def test_sphere_is_uniform() -> None:
    """z and the azimuth are uniform, directions are unit, the pdf times 4 pi is 1."""
    d = over(warp.warp_sphere, *_square())
    np.testing.assert_allclose(np.linalg.norm(d.astype(np.float64), axis=1), 1.0, atol=4e-7)
    _assert_even(_azimuth_cells(d[:, 0], d[:, 1], (1 + d[:, 2].astype(np.float64)) / 2))
    assert over(warp.pdf_sphere)[0] * 4 * np.pi == pytest.approx(1.0, rel=1e-6)


def test_sphere_there_and_back() -> None:
    """Away from the poles, where the azimuth means nothing; u everywhere."""
    u, v = _square(2000)
    d = over(warp.warp_sphere, u, v)
    back_u, back_v = over(warp.inverse_sphere, d)
    np.testing.assert_allclose(back_u, u, atol=2e-7)
    clear = (u > 0.01) & (u < 0.99) & (v > 1e-5) & (v < 1 - 1e-5)
    np.testing.assert_allclose(back_v[clear], v[clear], atol=2e-6)


@pytest.mark.parametrize("height", _HEIGHTS)
def test_cone_is_uniform_down_to_the_size_of_the_sun(height: float) -> None:
    """1 - z, measured as sin^2/(1 + z), and the azimuth are uniform over the cap; the pdf times its area 2 pi h is 1."""
    d = over(warp.warp_cone, *_square(), height).astype(np.float64)
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1.0, atol=4e-7)
    squared = d[:, 0] ** 2 + d[:, 1] ** 2
    depth = np.where(d[:, 2] > 0, squared / (1 + d[:, 2]), 1 - d[:, 2])
    _assert_even(_azimuth_cells(d[:, 0], d[:, 1], depth / np.float32(height)))
    assert over(warp.pdf_cone, height)[0] * 2 * np.pi * np.float32(height) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("height", _HEIGHTS)
def test_cone_there_and_back(height: float) -> None:
    """Also for a cone in which every cosine is 1 in float32."""
    u, v = _square(2000)
    back_u, back_v = over(warp.inverse_cone, over(warp.warp_cone, u, v, height), height)
    np.testing.assert_allclose(back_u, u, atol=2e-6)
    clear = (u > 0.01) & (u < 0.99) & (v > 1e-5) & (v < 1 - 1e-5)
    np.testing.assert_allclose(back_v[clear], v[clear], atol=2e-6)


# --- triangle -------------------------------------------------------------------------------------------------------------


def test_triangle_is_uniform() -> None:
    """Folded into 64 triangles of equal area: sub-triangles of the barycentric grid, upright and upside down."""
    b1, b2 = over(warp.warp_triangle, *_square())
    assert np.all((b1 >= 0) & (b2 >= 0) & (b1.astype(np.float64) + b2 <= 1.0))
    column, row = np.floor(b1 * 8).astype(int), np.floor(b2 * 8).astype(int)
    upside = (b1 * 8 - column) + (b2 * 8 - row) > 1
    cells = np.unique(np.stack([column, row, upside]), axis=1, return_counts=True)[1]
    assert len(cells) == 64
    _assert_even(cells)
    assert over(warp.pdf_triangle, 0.5)[0] * 0.5 == 1.0


def test_triangle_there_and_back() -> None:
    """Exact to rounding; the square's corners go to the triangle's corners and the middle of its long side."""
    for square in (_square(2000), _corners()):
        _assert_same_place(square, over(warp.inverse_triangle, *over(warp.warp_triangle, *square)), 2e-7)
    b1, b2 = over(warp.warp_triangle, [0, 1, 0, 1], [0, 0, 1, 1])
    np.testing.assert_array_equal(b1, [0, 1, 0, 0.5])
    np.testing.assert_array_equal(b2, [0, 0, 1, 0.5])
