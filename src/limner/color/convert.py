"""Any colour to any other, by the names of their spaces (FoCG 19.2).

    convert_color([0.2, 0.4, 0.6], "srgb", "lab")
    convert_color(picture, "linear_srgb", "display_p3")       a float32 picture of 4K in a tenth of a second

    srgb, display_p3, rec2020, …        stored numbers of a space of `limner.color.spaces`; linear_srgb, …: its light
    xyz, xyz_d50, xyy                   tristimulus values, Y = 1 for white; xyy: x, y, Y
    lab, lab_d50, luv, lch, lch_uv      CIE 1976; lch: lightness, chroma and hue (radians) of Lab, lch_uv: of Luv
    oklab, oklch                        Oklab and its lightness, chroma and hue (radians)
    hsv, hsl                            of stored sRGB; the hue in turns

All meet in XYZ under D65. Where whites differ, white becomes white (`limner.color.adaptation`).
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from .adaptation import ADAPTATIONS, adaptation_matrix
from .chromaticity import xyy_from_xyz, xyz_from_xyy
from .encodings import Encoding, encoding
from .hue import hsl_from_rgb, hsv_from_rgb, rgb_from_hsl, rgb_from_hsv
from .spaces import SPACES, Space, rgb_from_rgb, space
from .triples import Floats, in_pieces, triples
from .uniform import (
    lab_from_xyz,
    lch_from_rectangular,
    luv_from_xyz,
    oklab_from_xyz,
    rectangular_from_lch,
    xyz_from_lab,
    xyz_from_luv,
    xyz_from_oklab,
)  # fmt: skip

__all__ = ["COLOR_SPACES", "convert_color"]

_LINEAR = "linear_"
_LEAST_FOR_KERNEL = 1 << 14  # numbers: fewer are converted sooner than machine code is loaded

_D65_XYZ = SPACES["srgb"].white_xyz
_D50_XYZ = np.array([0.96422, 1.0, 0.82521])
"""The white of profiles. **Source**: ICC.1:2022, 7.2.16, to five digits."""


class _Model(NamedTuple):
    """A space that is not of three lamps: how it comes from XYZ under D65, and goes there."""

    from_xyz: Callable[[Floats], Any]
    to_xyz: Callable[[Floats], Any]


def _under_d50(from_xyz: Callable[[Floats], Any], to_xyz: Callable[[Floats], Any]) -> _Model:
    there, back = adaptation_matrix(_D50_XYZ, _D65_XYZ), adaptation_matrix(_D65_XYZ, _D50_XYZ)
    return _Model(lambda xyz: from_xyz(xyz @ there.T), lambda rows: to_xyz(rows) @ back.T)


def _of_srgb(from_rgb: Callable[[Floats], Any], to_rgb: Callable[[Floats], Any]) -> _Model:
    srgb = SPACES["srgb"]
    return _Model(
        lambda xyz: from_rgb(srgb.encoding.encode(xyz @ srgb.rgb_from_xyz.T)),
        lambda rows: srgb.encoding.decode(to_rgb(rows)) @ srgb.xyz_from_rgb.T,
    )


_MODELS = {
    "xyz": _Model(lambda xyz: xyz, lambda xyz: xyz),
    "xyz_d50": _under_d50(lambda xyz: xyz, lambda xyz: xyz),
    "xyy": _Model(xyy_from_xyz, xyz_from_xyy),
    "lab": _Model(lab_from_xyz, xyz_from_lab),
    "lab_d50": _under_d50(lambda xyz: lab_from_xyz(xyz, _D50_XYZ), lambda lab: xyz_from_lab(lab, _D50_XYZ)),
    "luv": _Model(luv_from_xyz, xyz_from_luv),
    "lch": _Model(lambda xyz: lch_from_rectangular(lab_from_xyz(xyz)), lambda lch: xyz_from_lab(rectangular_from_lch(lch))),
    "lch_uv": _Model(lambda xyz: lch_from_rectangular(luv_from_xyz(xyz)), lambda lch: xyz_from_luv(rectangular_from_lch(lch))),
    "oklab": _Model(oklab_from_xyz, xyz_from_oklab),
    "oklch": _Model(lambda xyz: lch_from_rectangular(oklab_from_xyz(xyz)), lambda lch: xyz_from_oklab(rectangular_from_lch(lch))),
    "hsv": _of_srgb(hsv_from_rgb, rgb_from_hsv),
    "hsl": _of_srgb(hsl_from_rgb, rgb_from_hsl),
}

COLOR_SPACES = (*SPACES, *(_LINEAR + name for name in SPACES), *_MODELS)
"""All names that `convert_color` knows."""


def convert_color(
    colors: ArrayLike, source: str | Space, target: str | Space, adaptation: str = "bradford", out: NDArray[Any] | None = None
) -> NDArray[np.float32] | NDArray[np.float64]:
    """Convert colours from one space to another.

    Parameters
    ----------
    colors : (..., 3) float
        Of any shape; float32 stays float32, all else becomes float64. Nothing is clipped: what a space cannot show has numbers below 0 or
        above 1 in it. NaN stays NaN.
    source, target : str or Space
        One of `COLOR_SPACES`, or a space of one's own (its stored numbers).
    adaptation : "bradford" | "von_kries" | "cat02" | "xyz"
        How one white becomes another, where lamps' whites differ.
    out : (..., 3) array, optional
        Where to put them, of the shape and dtype of the result; it may be `colors` itself. For a large picture, fresh memory takes as long
        as the conversion.

    Returns
    -------
    (..., 3) float

    >>> convert_color([1.0, 0.0, 0.0], "srgb", "display_p3").round(4).tolist()
    [0.9175, 0.2003, 0.1386]
    >>> convert_color([[0.5, 0.2, 0.2]], "srgb", "lab").round(2).tolist()
    [[32.16, 33.13, 16.81]]
    """
    given = triples(colors)
    if adaptation not in ADAPTATIONS:
        raise UnsupportedError(f"adaptation must be one of {', '.join(ADAPTATIONS)}, got {adaptation!r}")
    if out is not None and (not isinstance(out, np.ndarray) or out.shape != given.shape or out.dtype != given.dtype):
        raise SceneError(f"out must be an array of shape {given.shape} and {given.dtype}")
    of, to = _lamps(source), _lamps(target)
    if of is not None and to is not None:
        made = _between_lamps(given, of, to, adaptation, out)
    else:
        to_xyz, from_xyz = _to_xyz(source, of, adaptation), _from_xyz(target, to, adaptation)
        made = in_pieces(lambda rows: from_xyz(to_xyz(rows)), given)
    if out is None:
        return made
    if made is not out:
        np.copyto(out, made)
    return out


def _lamps(name: str | Space) -> tuple[Space, Encoding] | None:
    """A space of three lamps and how its numbers are stored; None where it is another kind."""
    if isinstance(name, Space):
        return name, name.encoding
    if name in _MODELS:
        return None
    if name in SPACES:
        return space(name), space(name).encoding
    if isinstance(name, str) and name.removeprefix(_LINEAR) in SPACES:
        return space(name.removeprefix(_LINEAR)), encoding("linear")
    raise UnsupportedError(
        f"a colour space must be one of {', '.join(SPACES)} (or linear_ and one of these), {', '.join(_MODELS)}; got {name!r}"
    )


def _to_xyz(name: str | Space, lamps: tuple[Space, Encoding] | None, adaptation: str) -> Callable[[Floats], Floats]:
    if lamps is None:
        return _MODELS[str(name)].to_xyz
    of, curve = lamps
    matrix = SPACES["srgb"].xyz_from_rgb @ rgb_from_rgb("srgb", of, adaptation)
    return lambda rows: np.asarray(curve.decode(rows) @ matrix.T)


def _from_xyz(name: str | Space, lamps: tuple[Space, Encoding] | None, adaptation: str) -> Callable[[Floats], Floats]:
    if lamps is None:
        return _MODELS[str(name)].from_xyz
    to, curve = lamps
    matrix = rgb_from_rgb(to, "srgb", adaptation) @ SPACES["srgb"].rgb_from_xyz
    return lambda rows: curve.encode(np.asarray(rows @ matrix.T))


def _between_lamps(
    given: NDArray[Any], of: tuple[Space, Encoding], to: tuple[Space, Encoding], adaptation: str, out: NDArray[Any] | None
) -> NDArray[Any]:
    matrix, decode, encode = rgb_from_rgb(to[0], of[0], adaptation), of[1], to[1]
    is_mixed = not np.array_equal(matrix, np.eye(3))
    if not is_mixed and decode.name == encode.name:
        return given.copy()
    if given.dtype == np.float32 and given.size >= _LEAST_FOR_KERNEL and decode.curve and encode.curve:
        # By name: whoever describes a scene or saves a picture must not depend on the compiler.
        large = importlib.import_module(".convert_large", __package__)
        made: NDArray[Any] = large.converted(given, matrix, decode, encode, out)
        return made
    if not is_mixed:
        return in_pieces(lambda rows: encode.encode(decode.decode(rows)), given)
    return in_pieces(lambda rows: encode.encode(decode.decode(rows) @ matrix.T), given)
