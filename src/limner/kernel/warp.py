"""Warps: from the unit square to disks, spheres, caps and triangles, uniformly or by the cosine.

Each place has the same three verbs. `warp_` takes (u, v) in [0, 1]^2 to the place, `pdf_` is the density it produces there
(per unit of area or solid angle; its integral is 1; zero outside), and `inverse_` takes the place back to (u, v). Directions
are about +z.

Maps that keep areas *and* shapes tolerable (concentric disk, folded triangle) keep a stratified pattern stratified.
"""

from __future__ import annotations

import math

import numpy as np

from .._jit import kernel
from .elementary import INV_PI, TWO_PI, atan2, cos, cos_sin_of_octant, safe_sqrt, sin, sqrt
from .lanes import max, where
from .vec import ONE, TWO, ZERO, Vec3

__all__ = [
    "inverse_cone", "inverse_disk", "inverse_hemisphere_cosine", "inverse_sphere", "inverse_triangle",
    "pdf_cone", "pdf_disk", "pdf_hemisphere_cosine", "pdf_sphere", "pdf_triangle",
    "warp_cone", "warp_disk", "warp_hemisphere_cosine", "warp_sphere", "warp_triangle",
]  # fmt: skip

f32 = np.float32
_HALF = f32(0.5)
_QUARTER_PI = f32(0.25 * math.pi)
_FOUR_OVER_PI = f32(4.0 / math.pi)
_INV_TWO_PI = f32(0.5 / math.pi)
_INV_FOUR_PI = f32(0.25 / math.pi)


# --- disk -----------------------------------------------------------------------------------------------------------------


@kernel
def warp_disk(u: np.float32, v: np.float32) -> tuple[np.float32, np.float32]:
    """The point (x, y) of the unit disk: concentric squares become concentric circles.

    **Source**: P. Shirley and K. Chiu, "A low distortion map between disk and square", 1997; the radius may be negative.
    """
    a, b = TWO * u - ONE, TWO * v - ONE
    wide = abs(a) > abs(b)
    r, s = where(wide, a, b), where(wide, b, a)
    apart = r != ZERO
    ratio = where(apart, s / where(apart, r, ONE), ZERO)
    c, s = cos_sin_of_octant(_QUARTER_PI * ratio)
    along, across = r * c, r * s
    return where(wide, along, across), where(wide, across, along)


@kernel
def pdf_disk(x: np.float32, y: np.float32) -> np.float32:
    """1 / pi on the unit disk, per unit of area."""
    return INV_PI if x * x + y * y <= ONE else ZERO


@kernel
def inverse_disk(x: np.float32, y: np.float32) -> tuple[np.float32, np.float32]:
    """The (u, v) that `warp_disk` takes to (x, y)."""
    wide = abs(x) > abs(y)
    along = x if wide else y
    across = y if wide else x
    length = sqrt(x * x + y * y)
    r = length if along >= ZERO else -length
    # atan2(across, |along|) is within 45 degrees of the axis, where it needs no quadrant.
    s = atan2(across, abs(along)) * _FOUR_OVER_PI * length
    a = r if wide else s
    b = s if wide else r
    return (a + ONE) * _HALF, (b + ONE) * _HALF


# --- hemisphere, by the cosine --------------------------------------------------------------------------------------------


@kernel
def warp_hemisphere_cosine(u: np.float32, v: np.float32) -> Vec3:
    """A direction of the upper hemisphere, denser in proportion to the cosine: the disk, lifted (Malley's method)."""
    x, y = warp_disk(u, v)
    return Vec3(x, y, safe_sqrt(ONE - x * x - y * y))


@kernel
def pdf_hemisphere_cosine(cos_theta: np.float32) -> np.float32:
    """cos(theta) / pi above the horizon, per steradian."""
    return max(ZERO, cos_theta) * INV_PI


@kernel
def inverse_hemisphere_cosine(d: Vec3) -> tuple[np.float32, np.float32]:
    """The (u, v) that `warp_hemisphere_cosine` takes to d."""
    return inverse_disk(d.x, d.y)


# --- sphere and cone ------------------------------------------------------------------------------------------------------


@kernel
def _azimuth_fraction(x: np.float32, y: np.float32) -> np.float32:
    """The azimuth of (x, y) in turns, in [0, 1]."""
    turns = atan2(y, x) * _INV_TWO_PI
    return turns + ONE if turns < ZERO else turns


@kernel
def warp_sphere(u: np.float32, v: np.float32) -> Vec3:
    """A uniform direction: z = 1 - 2u, azimuth 2 pi v (Archimedes' hat-box)."""
    r = TWO * safe_sqrt(u * (ONE - u))
    azimuth = TWO_PI * v
    return Vec3(r * cos(azimuth), r * sin(azimuth), ONE - TWO * u)


@kernel
def pdf_sphere() -> np.float32:
    """1 / (4 pi), per steradian."""
    return _INV_FOUR_PI


@kernel
def inverse_sphere(d: Vec3) -> tuple[np.float32, np.float32]:
    """The (u, v) that `warp_sphere` takes to d."""
    return (ONE - d.z) * _HALF, _azimuth_fraction(d.x, d.y)


@kernel
def warp_cone(u: np.float32, v: np.float32, height: np.float32) -> Vec3:
    """A uniform direction of the cap z >= 1 - height, 0 < height <= 2.

    The cone is given by 1 - cos(theta_max), not by the cosine, which in float32 is 1 for the sun and anything smaller; so
    sin^2(theta) = h (2 - h) with h = u height.
    """
    h = u * height
    r = safe_sqrt(h * (TWO - h))
    azimuth = TWO_PI * v
    return Vec3(r * cos(azimuth), r * sin(azimuth), ONE - h)


@kernel
def pdf_cone(height: np.float32) -> np.float32:
    """1 / (2 pi height) inside the cap, per steradian: the cap's area."""
    return _INV_TWO_PI / height


@kernel
def inverse_cone(d: Vec3, height: np.float32) -> tuple[np.float32, np.float32]:
    """The (u, v) that `warp_cone` takes to d; 1 - z is taken from x and y, which are exact near the axis."""
    squared = d.x * d.x + d.y * d.y
    h = squared / (ONE + d.z) if d.z > ZERO else ONE - d.z
    return h / height, _azimuth_fraction(d.x, d.y)


# --- triangle -------------------------------------------------------------------------------------------------------------


@kernel
def warp_triangle(u: np.float32, v: np.float32) -> tuple[np.float32, np.float32]:
    """Uniform barycentrics (b1, b2) with b1, b2 >= 0, b1 + b2 <= 1: the square folded at its diagonal.

    **Source**: E. Heitz, "A low-distortion map between triangle and square", 2019.
    """
    is_upper = v > u
    return where(is_upper, u * _HALF, u - v * _HALF), where(is_upper, v - u * _HALF, v * _HALF)


@kernel
def pdf_triangle(area: np.float32) -> np.float32:
    """1 / area, per unit of area."""
    return ONE / area


@kernel
def inverse_triangle(b1: np.float32, b2: np.float32) -> tuple[np.float32, np.float32]:
    """The (u, v) that `warp_triangle` takes to (b1, b2)."""
    if b2 > b1:
        return TWO * b1, b1 + b2
    return b1 + b2, TWO * b2
