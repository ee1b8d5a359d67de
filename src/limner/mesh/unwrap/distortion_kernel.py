"""How many triangles lie over each texel."""

from __future__ import annotations

import math

from ..._jit import kernel


@kernel
def count_layers(corners, layers):
    """Count in `layers`, (height, width), the triangles, (k, 3, 2) in texels, in whose inside the texel's centre is; edges do not count."""
    height, width = layers.shape
    for t in range(len(corners)):
        ax, ay, bx, by, cx, cy = corners[t, 0, 0], corners[t, 0, 1], corners[t, 1, 0], corners[t, 1, 1], corners[t, 2, 0], corners[t, 2, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area == 0.0:
            continue
        turn = 1.0 if area > 0.0 else -1.0
        i0, i1 = max(math.ceil(min(ax, bx, cx) - 0.5), 0), min(math.floor(max(ax, bx, cx) - 0.5), width - 1)
        j0, j1 = max(math.ceil(min(ay, by, cy) - 0.5), 0), min(math.floor(max(ay, by, cy) - 0.5), height - 1)
        for j in range(j0, j1 + 1):
            y = j + 0.5
            for i in range(i0, i1 + 1):
                x = i + 0.5
                if (
                    turn * ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) > 1e-9
                    and turn * ((cx - bx) * (y - by) - (cy - by) * (x - bx)) > 1e-9
                    and turn * ((ax - cx) * (y - cy) - (ay - cy) * (x - cx)) > 1e-9
                ):
                    layers[j, i] += 1
