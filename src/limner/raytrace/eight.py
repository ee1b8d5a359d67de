"""Where eight paths stand that are traced together (`limner.raytrace.matte_tile`): numbers of one kind beside one another, eight to a row."""

from __future__ import annotations

__all__ = [
    "AIM", "BLOCK", "BULGE", "CARRIED", "DEPTH", "DIRECTION", "DRAWN", "FROM_SKY", "LAMPS", "LAST", "NORMAL", "ORIGIN", "PAINT", "PATH",
    "PDF", "PIXEL", "POSITION", "REACH", "REACHING", "SAMPLE", "SHADING_NORMAL", "STATE_SIZE", "THROUGHPUT", "TOTAL", "WORDS_SIZE",
]  # fmt: skip

BLOCK = 2048
"""How many paths are traced before what they found goes to the film."""

# Rows of float32: the ray; what the path carries and has found; the place that it was scattered at last, the density of its direction
ORIGIN, DIRECTION, THROUGHPUT, TOTAL, LAST, PDF, CARRIED = 0, 3, 6, 9, 12, 15, 16
# the surface that it met, its colour, and what it gets of lamps and of the sky
POSITION, NORMAL, SHADING_NORMAL, BULGE, REACH, PAINT, LAMPS, FROM_SKY = 17, 20, 23, 26, 29, 30, 33, 36
# points drawn one by one; the shadow ray and how far it reaches
DRAWN, AIM, REACHING = 39, 41, 44
STATE_SIZE = 8 * 45

# Rows of int32: the path's place in its block, -1 for none; its pixel's word; its sample; how often it was scattered
PATH, PIXEL, SAMPLE, DEPTH = 0, 1, 2, 3
WORDS_SIZE = 8 * 4
