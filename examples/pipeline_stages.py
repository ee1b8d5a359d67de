"""The graphics pipeline on one sheet (FoCG 8): what each stage makes of the teapot, from its vertices to the picture.

Edges, backs, clipping, the pixels that triangles cover, how often each is drawn, depth, barycentric coordinates, normals, texture
coordinates, three frequencies of shading, and antialiasing under a lens. `limner stages MODEL` makes the same sheet of any model.

    python examples/pipeline_stages.py stages.png
"""

from __future__ import annotations

import sys

import limner


def main(target: str, small: bool = False) -> None:
    """One call."""
    sheet = limner.stages("teapot", width=320 if small else 400, samples=2 if small else 16, title="the teapot's way to the picture")
    sheet.image.save(target)
    print(f"{target}: {len(sheet.facts)} facts about it, among them {', '.join(list(sheet.facts)[:5])}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "stages.png", "--small" in sys.argv)
