"""Where eight paths stand that are traced together (`limner.raytrace.matte_tile`): numbers of one kind side by side, eight to a row."""

from __future__ import annotations

__all__ = [
    "AIM", "BARYCENTRIC", "BLOCK", "BULGE", "CARRIED", "DEPTH", "DIRECTION", "DRAWN", "FROM_SKY", "INSTANCE", "LAMPS", "LAST",
    "NEXT_COLUMN", "NEXT_DIRECTION", "NEXT_ORIGIN", "NEXT_PIXEL", "NEXT_ROW", "NEXT_SAMPLE", "NORMAL", "ORIGIN", "PAINT", "PATH", "PDF",
    "PIXEL", "POSITION", "REACH", "REACHING", "SAMPLE", "SHADING_NORMAL", "STATE_SIZE", "THROUGHPUT", "TOTAL", "TRIANGLE", "WORDS_SIZE",
]  # fmt: skip

BLOCK = 2048
"""How many paths are traced before what they found goes to the film."""

# Rows of float32: the ray; what the path carries and has found; the place that it was scattered at last, the density of its direction
ORIGIN, DIRECTION, THROUGHPUT, TOTAL, LAST, PDF, CARRIED = 0, 3, 6, 9, 12, 15, 16
# the surface that it met, its colour, and what it gets of lamps and of the sky
POSITION, NORMAL, SHADING_NORMAL, BULGE, REACH, PAINT, LAMPS, FROM_SKY = 17, 20, 23, 26, 29, 30, 33, 36
# points drawn one by one; the shadow ray and how far it reaches
DRAWN, AIM, REACHING = 39, 41, 44
# where on its triangle the ray hit; the rays of the paths that begin next
BARYCENTRIC, NEXT_ORIGIN, NEXT_DIRECTION = 45, 47, 50
STATE_SIZE = 8 * 53

# Rows of int32: the path's place in its block, -1 for none; its pixel's word; its sample; how often it was scattered; the instance and the
# triangle where it is, -1 if the state has the surface already; pixel's word, column, row and sample of the paths that begin next
PATH, PIXEL, SAMPLE, DEPTH, INSTANCE, TRIANGLE, NEXT_PIXEL, NEXT_COLUMN, NEXT_ROW, NEXT_SAMPLE = range(10)
WORDS_SIZE = 8 * 10
