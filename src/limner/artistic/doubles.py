"""Lines that are seen in one place, of which one is enough.

Seen from the front, the far edges of a box stand exactly behind its near ones, and two boxes that touch have edges in common. Drawn twice,
a line is darker than its neighbours, and a dashed one is filled by the dashes of the other. The nearest is drawn: what hides it hides
those behind it.
"""

from __future__ import annotations

import numpy as np

from .visibility import Thrown

__all__ = ["without_doubles"]

_GRID = 1e-4  # pixels


def without_doubles(found: Thrown) -> Thrown:
    """Leave out pieces that have both ends, on the picture, in common with a nearer one."""
    ends = np.rint(found.lines[:, :, :2] / _GRID)
    turned = (ends[:, 0, 0] > ends[:, 1, 0]) | ((ends[:, 0, 0] == ends[:, 1, 0]) & (ends[:, 0, 1] > ends[:, 1, 1]))
    ends[turned] = ends[turned, ::-1]
    columns = ends.reshape(-1, 4).T
    nearness = found.lines[:, :, 2].sum(axis=1)
    # Those in one place side by side, the nearest first; of equally near ones the first stays first.
    order = np.lexsort((-nearness, *columns))
    same = np.zeros(len(order), dtype=bool)
    same[1:] = (columns[:, order][:, 1:] == columns[:, order][:, :-1]).all(axis=0)
    kept = np.ones(len(order), dtype=bool)
    kept[order[same]] = False
    return Thrown(found.segments.where(kept), found.lines[kept], found.inside[kept])
