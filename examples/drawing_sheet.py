"""A technical drawing: a bracket of exact solids, in four views on a sheet, to scale, with its hidden lines and its size.

    python examples/drawing_sheet.py bracket.pdf          or .svg, .dxf, .png
"""

from __future__ import annotations

import math
import sys

import limner
from limner.linear.transform import in_order, rotate, translate
from limner.produce.draw_sheet import technical_sheet


def bracket(holes: bool) -> limner.Scene:
    """A base with two holes, and an upright plate with one: millimetres."""
    hole = limner.Cylinder(4.0, 40.0)
    base = limner.Union(
        limner.Solid(limner.Box((60.0, 8.0, 40.0)), translate(0.0, 4.0, 0.0)),
        limner.Solid(limner.Box((60.0, 32.0, 8.0)), translate(0.0, 24.0, -16.0)),
    )
    through = limner.Solid(limner.Cylinder(9.0, 40.0), in_order(rotate((1, 0, 0), math.pi / 2), translate(0.0, 24.0, -16.0)))
    drilled = limner.Difference(
        base, limner.Solid(hole, translate(-20.0, 4.0, 6.0)), limner.Solid(hole, translate(20.0, 4.0, 6.0)), through
    )
    return limner.Scene(root=limner.Node(shapes=(limner.Shape(drilled if holes else base),)), name="bracket")


def main(target: str, small: bool = False) -> None:
    """In first angle, on A4."""
    views = ("front", "top") if small else ("front", "top", "left", "iso")
    sheet = technical_sheet(bracket(not small), views=views, paper="A4", unit="mm", dimensions=True)
    sheet.save(target)
    print(f"{target}: {sheet.facts['lines']} lines at {sheet.facts['scale']}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "bracket.svg", "--small" in sys.argv)
