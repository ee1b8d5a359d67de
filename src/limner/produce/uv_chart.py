"""The charts of an unwrapped mesh as a picture, coloured by what the flattening did to them (FoCG 11.1).

    uv_chart(uv_unwrap(mesh)).image().save("charts.png")
    uv_chart(mesh, show="area").svg()

White is undistorted. Angles: the redder, the more a small circle has become an ellipse. Areas: blue is too small in the texture, red too
large; for stretch likewise, by the lengths that lie closest together. Black lines are where the surface is cut.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..color.decode_table import SRGB_DECODE
from ..draw.canvas import Canvas
from ..draw.stroke import Pen
from ..errors import SceneError, UnsupportedError
from ..mesh.mesh import Mesh
from ..mesh.unwrap.distortion import rim_edges, unwrap_report, uv_distortion
from .false_color import along
from .sheet import Rgb

__all__ = ["SHOWN", "uv_chart"]

SHOWN = ("conformal", "area", "stretch")

_ONE_WAY: tuple[Rgb, ...] = ((250, 250, 246), (252, 214, 140), (236, 132, 70), (176, 40, 52), (92, 12, 52))
_BOTH_WAYS: tuple[Rgb, ...] = ((30, 70, 150), (110, 160, 214), (250, 250, 246), (236, 132, 70), (150, 24, 44))
_FLIPPED: Rgb = (200, 0, 200)
_PAPER = "#dfe3e8"
_RIM = "#101418"
_BAR_STEPS = 64


def uv_chart(mesh: Mesh, *, show: str = "conformal", size: int = 1024, limit: float = 1.5, legend: bool = True) -> Canvas:
    """Draw the triangles of a mesh where they lie in the texture.

    Parameters
    ----------
    mesh : Mesh
        With texture coordinates in [0, 1]; what lies outside is cut off.
    show : "conformal" | "area" | "stretch"
        What the colour tells: s1/s2; the scale of areas; the least stretch s2, which is Sander's L∞ upside down.
    size : int >= 64
        Pixels along a side of the texture.
    limit : float > 1
        What has the last colour of the key, and of both ways: its inverse the first.
    legend : bool
        Whether a key and numbers stand below.

    Returns
    -------
    Canvas
        v runs up. ``.image()`` is the picture, ``.svg()`` the same as vectors.

    Raises SceneError where the mesh has no texture coordinates.
    """
    if show not in SHOWN:
        raise UnsupportedError(f"show must be one of {', '.join(SHOWN)}, got {show!r}")
    if not (np.isfinite(limit) and limit > 1.0):
        raise SceneError(f"limit must be greater than 1, got {limit}")
    if not (hasattr(size, "__index__") and size >= 64):
        raise SceneError(f"size must be an integer >= 64, got {size!r}")
    found = uv_distortion(mesh)
    values = {"conformal": found.conformal, "area": found.area, "stretch": found.stretch[:, 1]}[show]
    codes = _colors(values, show, limit)
    codes[found.mirrored] = _FLIPPED
    foot = max(size // 12, 24) if legend else 0
    canvas = Canvas(size, size + foot, background=_PAPER)
    assert mesh.uvs is not None
    corners = _in_picture(mesh.uvs[mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles], size)
    colors = np.repeat(SRGB_DECODE[codes].astype(np.float64)[:, None, :], 3, axis=1)
    with canvas.clipped(-0.5, -0.5, size, size):
        canvas.rectangle(-0.5, -0.5, size, size, fill="#c9ced6")
        canvas.triangles(corners, colors)
        rims = _in_picture(rim_edges(mesh), size).reshape(-1, 4)
        canvas.segments(rims, _RIM, Pen(max(size / 1024.0, 0.5), cap="round"))
    if legend:
        _draw_legend(canvas, mesh, show, limit, size, foot)
    return canvas


def _in_picture(uvs: NDArray[np.float32], size: int) -> NDArray[np.float64]:
    """(..., 2) texture coordinates as columns and rows."""
    return np.stack([uvs[..., 0] * float(size) - 0.5, (1.0 - uvs[..., 1]) * float(size) - 0.5], axis=-1)


def _colors(values: NDArray[np.float64], show: str, limit: float) -> NDArray[np.uint8]:
    """(..., 3) codes; by logarithms, so that half and double look alike."""
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.nan_to_num(np.log(values), nan=0.0, posinf=1e9, neginf=-1e9)
    top = float(np.log(limit))
    return along(logs, 0.0, top, _ONE_WAY) if show == "conformal" else along(logs, -top, top, _BOTH_WAYS)


def _draw_legend(canvas: Canvas, mesh: Mesh, show: str, limit: float, size: int, foot: int) -> None:
    """A bar of colours with its ends named, and beside it what came of it in numbers."""
    text = foot * 0.27
    left, top, width, height = foot * 0.25, size + foot * 0.2, size * 0.28, foot * 0.26
    low = 1.0 if show == "conformal" else 1.0 / limit
    codes = _colors(np.geomspace(low, limit, _BAR_STEPS), show, limit)
    step = width / _BAR_STEPS
    for k, (r, g, b) in enumerate(codes.tolist()):
        canvas.rectangle(left + k * step, top, width - k * step, height, fill=f"#{r:02x}{g:02x}{b:02x}")
    below = top + height + text * 1.1
    named = {"conformal": "angles: s1/s2", "area": "scale of areas", "stretch": "least stretch"}[show]
    canvas.text(left, below, f"{low:.2g}", _RIM, size=text)
    canvas.text(left + width / 2.0, below, named, _RIM, size=text, align="center")
    canvas.text(left + width, below, f"{limit:.2g}", _RIM, size=text, align="right")
    report = unwrap_report(mesh)
    beside = left + width + foot * 0.4
    first = f"{report.n_triangles} triangles, {report.n_charts} charts, {100.0 * report.filled:.1f} % filled, {report.n_flipped} flipped"
    second = f"angles {report.conformal_mean:.4f}, areas {report.area_mean:.4f}, stretch {report.stretch_l2:.4f} (1: none)"
    canvas.text(beside, top + text * 0.9, first, _RIM, size=text)
    canvas.text(beside, below, second, _RIM, size=text)
