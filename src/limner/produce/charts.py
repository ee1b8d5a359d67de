"""Charts of colour by their names, for the command line and for who wants them all.

chromaticity     all that can be seen, and what spaces show of it
matching         the standard observers; rgb-matching: by three lamps, with the lobe below zero; cones
illuminants      lamps and daylight
metamers         two paints that are one colour by day
metals           what metals reflect
checker          24 patches; banding: steps of few bits; gamma: which grey is as bright as a checkerboard
"""

from __future__ import annotations

from collections.abc import Sequence

from ..color.metals import metal_spectrum
from ..draw.canvas import Canvas
from ..errors import UnsupportedError
from .chromaticity_chart import chromaticity_chart
from .screen_charts import banding_chart, checker_chart, gamma_chart
from .spectrum_charts import illuminants_chart, matching_chart, metamers_chart, spectra_chart

__all__ = ["CHARTS", "chart"]

CHARTS = ("chromaticity", "matching", "rgb-matching", "cones", "illuminants", "metamers", "metals", "checker", "banding", "gamma")

_METALS = ("silver", "aluminium", "gold", "copper", "iron")


def chart(
    kind: str, *, width: int = 960, height: int = 720, gamuts: Sequence[str] = ("srgb", "display_p3", "rec2020"), plane: str = "xy",
    points: Sequence[tuple[float, float]] = (), lights: Sequence[str | float] = ("A", "C", "D50", "D65", "E"), observer: str = "cie_1931_2",
) -> Canvas:  # fmt: skip
    """Draw a chart of colour.

    Parameters
    ----------
    kind : str
        One of `CHARTS`.
    width, height : int >= 200
    gamuts, plane, points
        Of chromaticity.
    lights : sequence of str or float
        Of illuminants: names, or temperatures in kelvin.
    observer : str
        Of chromaticity and matching.

    Returns
    -------
    Canvas
        ``.image()`` is the picture, ``.svg()`` the same as vectors.
    """
    if kind == "chromaticity":
        return chromaticity_chart(gamuts, plane=plane, points=points, observer=observer, width=width, height=height)
    if kind == "matching":
        return matching_chart("xyz", observer=observer, width=width, height=height)
    if kind in ("rgb-matching", "cones"):
        return matching_chart(kind.removesuffix("-matching"), width=width, height=height)
    if kind == "illuminants":
        return illuminants_chart(lights, width=width, height=height)
    if kind == "metals":
        spectra = {name: metal_spectrum(name) for name in _METALS}
        return spectra_chart(
            spectra, title="What metals reflect straight on", y_name="reflectance", greatest=1.1, width=width, height=height
        )
    made = {"metamers": metamers_chart, "checker": checker_chart, "banding": banding_chart, "gamma": gamma_chart}.get(kind)
    if made is None:
        raise UnsupportedError(f"a chart must be one of {', '.join(CHARTS)}, got {kind!r}")
    return made(width=width, height=height)
