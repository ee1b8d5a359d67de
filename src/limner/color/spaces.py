"""Spaces of red, green and blue: three lamps, a white, and a transfer function (FoCG 19.2).

    space("display_p3").xyz_from_rgb      (3, 3), from the lamps' chromaticities and the white

A screen mixes three lamps. Their chromaticities and that of their sum at full power say the matrix: its columns are the lamps' XYZ, scaled
so that they add up to the white. No matrix is written down here; all are derived.

**Source**: IEC 61966-2-1 (sRGB); ITU-R BT.709-6, BT.2020-2, BT.2100-2; SMPTE EG 432-1 (P3 with D65), RP 431-2 (DCI-P3); Adobe RGB (1998);
ISO 22028-2 (ROMM, ProPhoto); S-2014-004 and TB-2018-001 of the Academy (ACEScg, ACES2065-1); CIE 015 (CIE RGB).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, UnsupportedError
from .adaptation import adaptation_matrix
from .encodings import Encoding, encoding

__all__ = ["SPACES", "Space", "rgb_from_rgb", "space"]

Floats = NDArray[np.float64]
Pair = tuple[float, float]


@dataclass(frozen=True)
class Space:
    """Three lamps, their white, and how numbers are stored.

    Parameters
    ----------
    name : str
    title : str
        As people write it.
    red, green, blue : (x, y)
        Chromaticities of the lamps.
    white : (x, y)
        Of all three at full power.
    transfer : str
        One of `limner.color.encodings.ENCODINGS`.

    >>> Space("mine", "Mine", (0.64, 0.33), (0.3, 0.6), (0.15, 0.06), (0.3127, 0.329), "srgb").xyz_from_rgb[1].round(4).tolist()
    [0.2126, 0.7152, 0.0722]
    """

    name: str
    title: str
    red: Pair
    green: Pair
    blue: Pair
    white: Pair
    transfer: str

    def __post_init__(self) -> None:
        corners = np.array([self.red, self.green, self.blue, self.white], dtype=np.float64)
        if corners.shape != (4, 2) or not np.isfinite(corners).all():
            raise SceneError(f"{self.name}: red, green, blue and white must be chromaticities (x, y)")
        if abs(np.linalg.det(np.column_stack([corners[:3], np.ones(3)]))) < 1e-9:
            raise SceneError(f"{self.name}: red, green and blue lie on one line")
        if corners[3, 1] <= 0.0:
            raise SceneError(f"{self.name}: the y of white must be positive, got {self.white[1]}")
        encoding(self.transfer)

    @cached_property
    def primaries(self) -> Floats:
        """(3, 2) float64: x, y of red, green and blue."""
        return np.array([self.red, self.green, self.blue], dtype=np.float64)

    @cached_property
    def white_xyz(self) -> Floats:
        """(3,) float64: XYZ of white, Y = 1."""
        x, y = self.white
        return np.array([x / y, 1.0, (1.0 - x - y) / y])

    @cached_property
    def xyz_from_rgb(self) -> Floats:
        """(3, 3) float64: XYZ under the space's own white, of linear red, green and blue.

        **Source**: FoCG 19.2; SMPTE RP 177-1993.
        """
        lamps = np.column_stack([self.primaries, 1.0 - self.primaries.sum(axis=1)]).T
        return np.asarray(lamps * np.linalg.solve(lamps, self.white_xyz))

    @cached_property
    def rgb_from_xyz(self) -> Floats:
        """(3, 3) float64: the inverse."""
        return np.asarray(np.linalg.inv(self.xyz_from_rgb), dtype=np.float64)

    @property
    def cicp(self) -> tuple[int, int] | None:
        """Code points of lamps and transfer function in ITU-T H.273, by which videos and PNGs say them; None: it has none."""
        return _CICP.get(self.name)

    @property
    def encoding(self) -> Encoding:
        """How numbers are stored."""
        return encoding(self.transfer)


_REC709 = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
_P3 = ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060))
_REC2020 = ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046))
_D65, _D50, _ACES = (0.3127, 0.3290), (0.3457, 0.3585), (0.32168, 0.33767)

_KNOWN = (
    Space("srgb", "sRGB", *_REC709, _D65, "srgb"),
    Space("rec709", "Rec. 709", *_REC709, _D65, "rec709"),
    Space("display_p3", "Display P3", *_P3, _D65, "srgb"),
    Space("dci_p3", "DCI-P3", *_P3, (0.314, 0.351), "gamma_2.6"),
    Space("rec2020", "Rec. 2020", *_REC2020, _D65, "rec2020"),
    Space("rec2100_pq", "Rec. 2100 PQ", *_REC2020, _D65, "pq"),
    Space("rec2100_hlg", "Rec. 2100 HLG", *_REC2020, _D65, "hlg"),
    Space("adobe_rgb", "Adobe RGB", (0.64, 0.33), (0.21, 0.71), (0.15, 0.06), _D65, "adobe"),
    Space("prophoto", "ProPhoto", (0.7347, 0.2653), (0.1596, 0.8404), (0.0366, 0.0001), _D50, "romm"),
    Space("acescg", "ACEScg", (0.713, 0.293), (0.165, 0.830), (0.128, 0.044), _ACES, "linear"),
    Space("aces2065_1", "ACES2065-1", (0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.077), _ACES, "linear"),
    Space(
        "cie_rgb", "CIE RGB", (0.73474284, 0.26525716), (0.27377903, 0.7174777), (0.16655563, 0.00891073), (1.0 / 3.0, 1.0 / 3.0), "linear"
    ),
)
SPACES = {known.name: known for known in _KNOWN}
"""Spaces by name."""


_CICP = {
    "srgb": (1, 13), "rec709": (1, 1), "display_p3": (12, 13), "rec2020": (9, 15), "rec2100_pq": (9, 16), "rec2100_hlg": (9, 18),
}  # fmt: skip


def space(name: str | Space) -> Space:
    """A space by name, or as it is given; UnsupportedError names all that are known."""
    if isinstance(name, Space):
        return name
    if name not in SPACES:
        raise UnsupportedError(f"a colour space must be one of {', '.join(SPACES)}, got {name!r}")
    return SPACES[name]


def rgb_from_rgb(target: str | Space, source: str | Space, adaptation: str = "bradford") -> Floats:
    """(3, 3) float64, target_from_source, linear; white becomes white.

    >>> rgb_from_rgb("srgb", "rec2020").round(4).tolist()[0]
    [1.6605, -0.5876, -0.0728]
    """
    to, of = space(target), space(source)
    if to.primaries.tolist() == of.primaries.tolist() and to.white == of.white:
        return np.eye(3)
    adapted = np.eye(3) if to.white == of.white else adaptation_matrix(to.white_xyz, of.white_xyz, adaptation)
    return np.asarray(to.rgb_from_xyz @ adapted @ of.xyz_from_rgb)
