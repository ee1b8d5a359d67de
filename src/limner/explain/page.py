"""A story as a page that needs nothing beside it: pictures as vectors, the tree as nested details. No script, no network."""

from __future__ import annotations

import base64
import html
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from .story import Step
from .values import shortest, text_of

if TYPE_CHECKING:
    from .explain import Explanation

__all__ = ["page"]

_OPEN = 2  # levels of the tree that are unfolded
_SIDE = 320  # of a picture, in units of its own
_COLORS = {"eye": "#1b6ac9", "ray": "#c9741b", "shadow": "#b8a800", "blocked": "#b01030"}
_WORDS = {"eye": "from the eye", "ray": "reflected, refracted, scattered", "shadow": "to a light", "blocked": "to a light, blocked"}

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 0 auto; padding: 1rem; max-width: 75rem; color: #222; background: #fff }
h1 { font-size: 1.3rem } h2 { font-size: 1.05rem; margin: 0 0 .3rem }
.row { display: flex; flex-wrap: wrap; gap: 1rem } figure { margin: 0; flex: 1 1 17rem; max-width: 26rem }
figure svg, figure img { width: 100%; height: auto; background: #f6f6f4; border: 1px solid #ddd }
figcaption { font-size: .85rem; color: #555 }
details { margin-left: .9rem; border-left: 1px solid #ddd; padding-left: .6rem }
details.leaf > summary { list-style: none } summary { cursor: pointer; overflow-wrap: anywhere; padding: .1rem 0 }
.value { font-family: ui-monospace, monospace; font-size: .85em; color: #06427a }
.terms, .formula, .source { display: block; font-size: .82em; color: #555; margin-left: 1rem }
.terms { font-family: ui-monospace, monospace } .source { color: #767 } .change > summary { color: #555 }
.ray > summary { font-weight: 600 }
.swatch { display: inline-block; width: 2.2em; height: 1em; border: 1px solid #999; vertical-align: middle }
"""


def page(told: Explanation) -> str:
    """The page of an explanation."""
    title = f"pixel ({told.x}, {told.y}) by {told.renderer}"
    drawn = told.drawing
    figures = [_thumbnail(told), _triangle_figure(told), _ray_figure(drawn, 0, 2, "from above"), _ray_figure(drawn, 0, 1, "from the front")]
    figures += [_lobe_figure(k, lobe) for k, lobe in enumerate(drawn.get("lobes", ()))]
    exact = "The traced kernels found " + ("the bits of the picture." if told.is_exact else "other bits than the picture has.")
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{html.escape(title)}</title><style>{_STYLE}</style></head><body>"
        f"<h1>Why does {html.escape(title)} look like that?</h1>"
        f'<p><span class="swatch" style="background:{_css(told.pixel)}"></span> <span class="value">'
        f"{html.escape(text_of([shortest(part) for part in told.pixel]))}</span> red, green, blue, alpha; linear light. "
        f"{told.width} × {told.height} pixels, {told.samples} samples. {exact}</p>"
        f'<div class="row">{"".join(figures)}</div>'
        f"{_tree(told.story, 0)}</body></html>\n"
    )


def _css(pixel: Any) -> str:
    from ..color.transfer import bytes_from_linear

    red, green, blue = bytes_from_linear(pixel[None, None, :3])[0, 0, :3].tolist()
    return f"rgb({red},{green},{blue})"


def _tree(step: Step, depth: int) -> str:
    parts = [html.escape(step.title)]
    if step.result is not None:
        parts.append(f' = <span class="value">{html.escape(text_of(step.result))}</span>')
    for name, text in (
        ("terms", "; ".join(f"{term} {text_of(value)}" for term, value in step.terms.items())),
        ("formula", step.formula if step.formula != step.title else ""),
        ("source", " · ".join(part for part in (step.source, step.kernel) if part) if step.kind != "change" else step.kernel),
    ):
        if text:
            parts.append(f'<span class="{name}">{html.escape(text)}</span>')
    inner = "".join(_tree(child, depth + 1) for child in step.steps)
    kind = f"{step.kind} leaf" if not step.steps else step.kind
    is_shown = depth < _OPEN or step.kind == "ray" or any(child.kind == "ray" for child in step.steps)
    unfolded = " open" if step.steps and is_shown and step.kind != "spaces" else ""
    return f'<details class="{kind}"{unfolded}><summary>{"".join(parts)}</summary>{inner}</details>'


def _figure(content: str, caption: str) -> str:
    return f"<figure>{content}<figcaption>{html.escape(caption)}</figcaption></figure>"


def _svg(width: float, height: float, content: str, label: str) -> str:
    label = html.escape(label, quote=True)
    return f'<svg viewBox="0 0 {width:g} {height:g}" role="img" aria-label="{label}" xmlns="http://www.w3.org/2000/svg">{content}</svg>'


def _line(a: Sequence[float], b: Sequence[float], color: str, dash: str = "") -> str:
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return f'<line x1="{a[0]:.2f}" y1="{a[1]:.2f}" x2="{b[0]:.2f}" y2="{b[1]:.2f}" stroke="{color}" stroke-width="1.6"{dashed}/>'


def _thumbnail(told: Explanation) -> str:
    """The picture, small, with the pixel marked."""
    data = told.thumbnail()
    if data is None:
        return ""
    scale = _SIDE / told.width
    x, y, height = (told.x + 0.5) * scale, (told.y + 0.5) * scale, told.height * scale
    encoded = base64.b64encode(data).decode("ascii")
    content = f'<image href="data:image/png;base64,{encoded}" width="{_SIDE}" height="{height:g}" preserveAspectRatio="none"/>'
    content += f'<circle cx="{x:.2f}" cy="{y:.2f}" r="9" fill="none" stroke="#fff" stroke-width="4"/>'
    content += f'<circle cx="{x:.2f}" cy="{y:.2f}" r="9" fill="none" stroke="#b01030" stroke-width="2"/>'
    return _figure(_svg(_SIDE, height, content, "the picture, with the pixel in a ring"), "The picture, and where the pixel is in it.")


def _triangle_figure(told: Explanation) -> str:
    """The triangles that the pixel shows, around it."""
    triangles = told.drawing.get("triangles", ())
    if not triangles:
        return ""
    square = [[told.x - 0.5, told.y - 0.5], [told.x + 0.5, told.y + 0.5]]
    points = [*square, *(corner for triangle in triangles for corner in triangle["corners"])]
    low = [max(min(point[k] for point in points), (told.x, told.y)[k] - 60.0) for k in (0, 1)]
    high = [min(max(point[k] for point in points), (told.x, told.y)[k] + 60.0) for k in (0, 1)]
    extent = max(high[0] - low[0], high[1] - low[1], 2.0) * 1.1
    middle = [(low[k] + high[k]) / 2.0 for k in (0, 1)]

    def at(point: Sequence[float]) -> list[float]:
        return [min(max((point[k] - middle[k]) / extent * _SIDE + _SIDE / 2.0, -4000.0), 4000.0) for k in (0, 1)]

    content = ""
    for k, triangle in enumerate(triangles):
        corners = " ".join("{:.2f},{:.2f}".format(*at(corner)) for corner in triangle["corners"])
        color = ("#1b6ac9", "#c9741b", "#3a8f3a", "#8a3a8f")[k % 4]
        content += f'<polygon points="{corners}" fill="{color}" fill-opacity=".15" stroke="{color}" stroke-width="1.6"><title>'
        content += f"{html.escape(triangle['title'])}</title></polygon>"
    side, (left, top) = _SIDE / extent, at([told.x - 0.5, told.y - 0.5])
    size = f'width="{side:.2f}" height="{side:.2f}"'
    content += f'<rect x="{left:.2f}" y="{top:.2f}" {size} fill="none" stroke="#b01030" stroke-width="1.6"/>'
    names = "; ".join(triangle["title"] for triangle in triangles)
    return _figure(_svg(_SIDE, _SIDE, content, "triangles around the pixel"), f"The pixel (square) and what it shows: {names}.")


def _ray_figure(drawn: dict[str, Any], across: int, up: int, name: str) -> str:
    """The rays in the scene, seen along a world axis."""
    rays, eye = drawn.get("rays", ()), drawn.get("eye")
    if not rays or eye is None:
        return ""
    ends = [eye, *(ray["from"] for ray in rays), *(ray["to"] for ray in rays if ray["kind"] in ("eye", "ray", "blocked"))]
    low = [min(point[k] for point in ends) for k in (across, up)]
    high = [max(point[k] for point in ends) for k in (across, up)]
    extent = max(high[0] - low[0], high[1] - low[1], 1e-9) * 1.25
    middle = [(low[k] + high[k]) / 2.0 for k in (0, 1)]
    downwards = 1.0 if up == 2 else -1.0

    def at(point: Sequence[float]) -> list[float]:
        x = (point[across] - middle[0]) / extent * _SIDE + _SIDE / 2.0
        y = downwards * (point[up] - middle[1]) / extent * _SIDE + _SIDE / 2.0
        return [min(max(x, -4000.0), 4000.0), min(max(y, -4000.0), 4000.0)]

    content = ""
    for box in drawn.get("boxes", ()):
        a, b = at(box["low"]), at(box["high"])
        x, y = min(a[0], b[0]), min(a[1], b[1])
        size = f'width="{abs(b[0] - a[0]):.2f}" height="{abs(b[1] - a[1]):.2f}"'
        content += f'<rect x="{x:.2f}" y="{y:.2f}" {size} fill="none" stroke="#bbb">'
        content += f"<title>{html.escape(box['name'])}</title></rect>"
    for ray in rays:
        content += _line(at(ray["from"]), at(ray["to"]), _COLORS[ray["kind"]], "" if ray["kind"] in ("eye", "ray") else "4 3")
    content += '<circle cx="{:.2f}" cy="{:.2f}" r="4" fill="#222"/>'.format(*at(eye))
    kinds = dict.fromkeys(ray["kind"] for ray in rays)
    names = {"#1b6ac9": "blue", "#c9741b": "orange", "#b8a800": "yellow", "#b01030": "red"}
    legend = ", ".join(f"{names[_COLORS[kind]]}: {_WORDS[kind]}" for kind in kinds)
    return _figure(_svg(_SIDE, _SIDE, content, f"rays, {name}"), f"Rays {name}. The eye is the dot; {legend}.")


def _lobe_figure(number: int, lobe: dict[str, Any]) -> str:
    """A polar plot: how much of light from each direction goes to the eye."""
    greatest = max((value for _, value in lobe["values"]), default=0.0)
    if not greatest > 0.0:
        return ""
    radius, x0, y0 = 0.42 * _SIDE, _SIDE / 2.0, 0.55 * _SIDE

    def at(degrees: float, length: float) -> list[float]:
        angle = math.radians(degrees)
        return [x0 + radius * length * math.sin(angle), y0 - radius * length * math.cos(angle)]

    points = " ".join("{:.2f},{:.2f}".format(*at(angle, value / greatest)) for angle, value in lobe["values"])
    content = _line([x0 - radius, y0], [x0 + radius, y0], "#888") + _line([x0, y0], at(0.0, 1.0), "#bbb", "2 3")
    content += f'<polygon points="{points}" fill="#c9741b" fill-opacity=".2" stroke="#c9741b" stroke-width="1.6"/>'
    content += _line([x0, y0], at(lobe["wo"], 1.0), "#1b6ac9") + _line([x0, y0], at(lobe["wi"], 1.0), "#b8a800", "4 3")
    caption = f"Surface {number + 1}: what it sends to the eye (blue) of light from each direction (orange, at most {greatest:.3g})"
    caption += "; yellow: a light."
    return _figure(_svg(_SIDE, 0.6 * _SIDE, content, "polar plot of the scattering"), caption)
