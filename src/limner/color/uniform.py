"""Spaces in which distance is difference: Lab, Luv, Oklab, and each as lightness, chroma and hue (FoCG 19.2).

Equal steps of XYZ are not equally well seen. CIE 1976 Lab and Luv take a cube root and set black against white, red against green, yellow
against blue; Oklab does so with numbers fitted later, and its hues stay themselves as colours fade.

All take XYZ with Y = 1 for white, and a white of XYZ where they need one. Hues are radians; lightness is 0 to 100 in Lab and Luv, 0 to 1 in
Oklab.

**Source**: CIE 015:2018, 8.2; Ottosson, *A perceptual color space for image processing*, 2020.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .triples import in_pieces

__all__ = [
    "D65_WHITE", "lab_from_xyz", "lch_from_rectangular", "luv_from_xyz", "oklab_from_xyz", "rectangular_from_lch", "xyz_from_lab",
    "xyz_from_luv", "xyz_from_oklab",
]  # fmt: skip

Floats = NDArray[np.float64]
Colors = NDArray[np.floating]

D65_WHITE = (0.3127 / 0.3290, 1.0, (1.0 - 0.3127 - 0.3290) / 0.3290)
"""XYZ of the white of sRGB."""

_EDGE = 6.0 / 29.0
_LINE = 3.0 * _EDGE**2

_LMS_FROM_XYZ = np.array(
    [[0.8189330101, 0.3618667424, -0.1288597137], [0.0329845436, 0.9293118715, 0.0361456387], [0.0482003018, 0.2643662691, 0.6338517070]]
)
_OKLAB_FROM_LMS = np.array(
    [[0.2104542553, 0.7936177850, -0.0040720468], [1.9779984951, -2.4285922050, 0.4505937099], [0.0259040371, 0.7827717662, -0.8086757660]]
)
_XYZ_FROM_LMS, _LMS_FROM_OKLAB = np.linalg.inv(_LMS_FROM_XYZ), np.linalg.inv(_OKLAB_FROM_LMS)


def _root(ratio: Floats) -> Floats:
    """The cube root, straight below (6/29)^3, negative numbers along with it."""
    return np.where(ratio > _EDGE**3, np.cbrt(ratio), ratio / _LINE + 4.0 / 29.0)


def _cube(f: Floats) -> Floats:
    return np.where(f > _EDGE, f**3, _LINE * (f - 4.0 / 29.0))


def lab_from_xyz(xyz: ArrayLike, white: ArrayLike = D65_WHITE) -> Colors:
    """(..., 3): L*, a*, b*.

    >>> lab_from_xyz([0.18 * part for part in D65_WHITE]).round(4).tolist()
    [49.4961, 0.0, 0.0]
    """
    middle = np.asarray(white, dtype=np.float64)

    def change(rows: Floats) -> Floats:
        x, y, z = _root(rows / middle).T
        return np.column_stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])

    return in_pieces(change, xyz, "xyz")


def xyz_from_lab(lab: ArrayLike, white: ArrayLike = D65_WHITE) -> Colors:
    """(..., 3): the inverse of `lab_from_xyz`."""
    middle = np.asarray(white, dtype=np.float64)

    def change(rows: Floats) -> Floats:
        y = (rows[:, 0] + 16.0) / 116.0
        return middle * _cube(np.column_stack([y + rows[:, 1] / 500.0, y, y - rows[:, 2] / 200.0]))

    return in_pieces(change, lab, "lab")


def _white_uv(middle: Floats) -> tuple[float, float]:
    below = middle[0] + 15.0 * middle[1] + 3.0 * middle[2]
    return float(4.0 * middle[0] / below), float(9.0 * middle[1] / below)


def luv_from_xyz(xyz: ArrayLike, white: ArrayLike = D65_WHITE) -> Colors:
    """(..., 3): L*, u*, v*; black, which has no chromaticity, is 0, 0, 0."""
    middle = np.asarray(white, dtype=np.float64)
    white_u, white_v = _white_uv(middle)

    def change(rows: Floats) -> Floats:
        below = rows @ np.array([1.0, 15.0, 3.0])
        lightness = 116.0 * _root(rows[:, 1] / middle[1]) - 16.0
        with np.errstate(divide="ignore", invalid="ignore"):
            u = np.where(below == 0.0, white_u, 4.0 * rows[:, 0] / below)
            v = np.where(below == 0.0, white_v, 9.0 * rows[:, 1] / below)
        return np.column_stack([lightness, 13.0 * lightness * (u - white_u), 13.0 * lightness * (v - white_v)])

    return in_pieces(change, xyz, "xyz")


def xyz_from_luv(luv: ArrayLike, white: ArrayLike = D65_WHITE) -> Colors:
    """(..., 3): the inverse of `luv_from_xyz`; where L* is 0, all is 0."""
    middle = np.asarray(white, dtype=np.float64)
    white_u, white_v = _white_uv(middle)

    def change(rows: Floats) -> Floats:
        lightness = rows[:, 0]
        luminance = middle[1] * _cube((lightness + 16.0) / 116.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            u, v = rows[:, 1] / (13.0 * lightness) + white_u, rows[:, 2] / (13.0 * lightness) + white_v
            made = np.column_stack([luminance * 9.0 * u / (4.0 * v), luminance, luminance * (12.0 - 3.0 * u - 20.0 * v) / (4.0 * v)])
        made[lightness == 0.0] = 0.0
        return made

    return in_pieces(change, luv, "luv")


def oklab_from_xyz(xyz: ArrayLike) -> Colors:
    """(..., 3): L, a, b of Oklab, of XYZ under D65.

    >>> oklab_from_xyz([[0.950, 1.0, 1.089], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).round(3).tolist()
    [[1.0, -0.0, -0.0], [0.45, 1.236, -0.019], [0.922, -0.671, 0.263], [0.153, -1.415, -0.449]]
    """
    return in_pieces(lambda rows: np.cbrt(rows @ _LMS_FROM_XYZ.T) @ _OKLAB_FROM_LMS.T, xyz, "xyz")


def xyz_from_oklab(oklab: ArrayLike) -> Colors:
    """(..., 3): the inverse of `oklab_from_xyz`."""
    return in_pieces(lambda rows: (rows @ _LMS_FROM_OKLAB.T) ** 3 @ _XYZ_FROM_LMS.T, oklab, "oklab")


def lch_from_rectangular(lab: ArrayLike) -> Colors:
    """(..., 3): lightness, chroma and hue (radians, [0, 2 pi)) of Lab, Luv or Oklab; grey has the hue 0.

    >>> lch_from_rectangular([50.0, 0.0, -3.0]).round(4).tolist()
    [50.0, 3.0, 4.7124]
    """

    def change(rows: Floats) -> Floats:
        hue = np.mod(np.arctan2(rows[:, 2], rows[:, 1]), 2.0 * np.pi)
        return np.column_stack([rows[:, 0], np.hypot(rows[:, 1], rows[:, 2]), np.where(hue >= 2.0 * np.pi, 0.0, hue)])

    return in_pieces(change, lab, "lab")


def rectangular_from_lch(lch: ArrayLike) -> Colors:
    """(..., 3): Lab, Luv or Oklab of lightness, chroma and hue (radians)."""
    return in_pieces(
        lambda rows: np.column_stack([rows[:, 0], rows[:, 1] * np.cos(rows[:, 2]), rows[:, 1] * np.sin(rows[:, 2])]), lch, "lch"
    )
