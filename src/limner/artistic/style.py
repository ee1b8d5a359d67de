"""How the lines of a drawing look: a class of lines for each kind, seen and hidden (FoCG 10.3.1).

    style = STYLES["technical"]
    style.look("crease", hidden_by=0).width        0.35, in style.unit
    style.look("crease", hidden_by=2).dashes       two surfaces in front: shorter dashes
    style.replace(depth_cue=0.5, wobble=1.0)

An engineer's drawing says what a line is by its width and its dashes, an artist's by its pressure. Both are a table from a line's kind,
and how many surfaces hide it, to a look.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..draw.ink import Ink, ink
from ..draw.page import UNITS
from ..errors import SceneError, UnsupportedError
from .lines import KINDS

__all__ = ["STYLES", "LineLook", "LineStyle", "line_style"]


@dataclass(frozen=True)
class LineLook:
    """How one class of lines is drawn; lengths are in the unit of its style.

    Parameters
    ----------
    width : float > 0
    color : colour
    opacity : float from 0 to 1
    dashes : tuple of float
        As of `limner.draw.stroke.Pen`.
    """

    width: float = 1.0
    color: Ink = "black"
    opacity: float = 1.0
    dashes: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not (math.isfinite(self.width) and self.width > 0.0):
            raise SceneError(f"a line's width must be positive, got {self.width!r}")
        if not 0.0 <= self.opacity <= 1.0:
            raise SceneError(f"a line's opacity must lie in [0, 1], got {self.opacity!r}")
        if not all(math.isfinite(dash) and dash >= 0.0 for dash in self.dashes) or (self.dashes and not sum(self.dashes) > 0.0):
            raise SceneError(f"a line's dashes must be lengths that are not negative and not all zero, got {self.dashes!r}")
        ink(self.color)


@dataclass(frozen=True)
class LineStyle:
    """The looks of all lines of a drawing.

    Parameters
    ----------
    visible, hidden : LineLook or None
        Of kinds that are not named in the tables below; None: they are not drawn.
    visible_kinds, hidden_kinds : mapping from kind to LineLook or None
    unit : "px" | "mm"
        Of all lengths.
    by_depth : bool
        Whether the dashes of a hidden line are divided by the number of surfaces that hide it.
    depth_cue : float from 0 to 1
        How much thinner and fainter the farthest lines are than the nearest; 0: all alike.
    taper : float from 0 to 1
        How much thinner a stroke's ends are than its middle.
    pressure : float from 0 to 1
        How much a stroke swells and thins along its way.
    wobble : float >= 0
        How far lines stray from where they belong, as of a hand.
    wavelength : float > 0
        Over what length they do.
    seed : int
        Of the hand.
    """

    visible: LineLook | None = LineLook(1.2)
    hidden: LineLook | None = None
    visible_kinds: Mapping[str, LineLook | None] = field(default_factory=dict)
    hidden_kinds: Mapping[str, LineLook | None] = field(default_factory=dict)
    unit: str = "px"
    by_depth: bool = False
    depth_cue: float = 0.0
    taper: float = 0.0
    pressure: float = 0.0
    wobble: float = 0.0
    wavelength: float = 60.0
    seed: int = 0

    def __post_init__(self) -> None:
        if self.unit not in UNITS:
            raise UnsupportedError(f"style.unit must be one of {', '.join(UNITS)}, got {self.unit!r}")
        for kind in (*self.visible_kinds, *self.hidden_kinds):
            if kind not in KINDS:
                raise UnsupportedError(f"a kind of line must be one of {', '.join(KINDS)}, got {kind!r}")
        for name in ("depth_cue", "taper", "pressure"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise SceneError(f"style.{name} must lie in [0, 1], got {getattr(self, name)!r}")
        if not (math.isfinite(self.wobble) and self.wobble >= 0.0):
            raise SceneError(f"style.wobble must not be negative, got {self.wobble!r}")
        if not (math.isfinite(self.wavelength) and self.wavelength > 0.0):
            raise SceneError(f"style.wavelength must be positive, got {self.wavelength!r}")

    def look(self, kind: str, hidden_by: int = 0) -> LineLook | None:
        """How a line of a kind that so many surfaces hide is drawn; None: not at all.

        >>> STYLES["technical"].look("crease", 1).dashes, STYLES["plain"].look("crease", 1)
        ((3.0, 0.75), None)
        """
        if not hidden_by:
            return self.visible_kinds.get(kind, self.visible)
        look = self.hidden_kinds.get(kind, self.hidden)
        if look is None or not self.by_depth or hidden_by == 1:
            return look
        return dataclasses.replace(look, dashes=tuple(dash / min(hidden_by, 4) for dash in look.dashes))

    @property
    def shows_hidden(self) -> bool:
        """Whether any hidden line is drawn."""
        return self.hidden is not None or any(look is not None for look in self.hidden_kinds.values())

    def replace(self, **changes: Any) -> LineStyle:
        """The same style with other fields."""
        return dataclasses.replace(self, **changes)


_OUTLINES = ("silhouette", "smooth_silhouette", "boundary")

STYLES: Mapping[str, LineStyle] = {
    "plain": LineStyle(
        visible=LineLook(1.1), visible_kinds={**dict.fromkeys(_OUTLINES, LineLook(1.7)), "suggestive_contour": LineLook(0.9)}
    ),
    "technical": LineStyle(
        unit="mm", visible=LineLook(0.35), hidden=LineLook(0.25, dashes=(3.0, 0.75)), by_depth=True,
        visible_kinds={**dict.fromkeys(_OUTLINES, LineLook(0.5)), "uv_seam": LineLook(0.18), "suggestive_contour": LineLook(0.25)},
        hidden_kinds={"suggestive_contour": None},
    ),
    "sketch": LineStyle(
        visible=LineLook(2.4, "#2b2723"), visible_kinds=dict.fromkeys(_OUTLINES, LineLook(3.2, "#2b2723")),
        taper=0.85, pressure=0.35, wobble=1.6, depth_cue=0.3,
    ),
    "xray": LineStyle(
        visible=LineLook(1.2, "#0b3a75"), visible_kinds=dict.fromkeys(_OUTLINES, LineLook(1.6, "#0b3a75")),
        hidden=LineLook(0.8, "#2f7fd0", 0.45),
    ),
    "chalk": LineStyle(visible=LineLook(1.6, "#f4f1e6"), hidden=LineLook(0.7, "#f4f1e6", 0.4, (5.0, 4.0)), wobble=0.7, pressure=0.4),
}  # fmt: skip
"""Styles by name. "technical": the widths and dashes of ISO 128-2, in millimetres (line types 01.1, 01.2 and 02.1)."""


def line_style(style: LineStyle | str) -> LineStyle:
    """A style, or the one of that name."""
    if isinstance(style, LineStyle):
        return style
    if style not in STYLES:
        raise UnsupportedError(f"a line style must be one of {', '.join(STYLES)}, or a LineStyle, got {style!r}")
    return STYLES[style]
