"""Newell's teapot: the 32 Bézier patches of the most rendered pot in the world (FoCG 15.6.1).

Martin Newell sketched his Melitta teapot and typed its control points in; they are in his thesis (*The Utilization of
Procedure Models in Digital Image Synthesis*, University of Utah, 1975), and became known through Frank Crow, "The Origins of
the Teapot", *IEEE Computer Graphics and Applications* 7(1), 1987. The list as it is passed on, with a bottom that was added
later, has 306 points and 32 bicubic patches; but the pot is regular, and is written here as what it is:

    rim, body, bottom, lid    profiles turned round the axis, in quarters with circle control points at 0.56 of the radius
    handle, spout             half tubes of the given rows, and their mirror images

The numbers are those of the list, in its units: z up, spout towards +x, 3.15 high. They are facts, published by their author
and free for everyone. The list shows the pot as it is known, without the factor 1.3 by which the one on Newell's table is
taller (James Blinn flattened it for a display with tall pixels, and it stayed so): scale y by 1.3 for the pot of clay.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Part", "parts", "patches"]

Points = NDArray[np.float64]
Row = tuple[tuple[float, float], tuple[float, float], float]

# A quarter circle of radius r has its inner control points at r k; the exact circle would ask for 0.5523.
_CIRCLE = 0.56

# Profiles as (radius, height), four points a patch, neighbours sharing one; from the top down the outside, to the axis.
_BODY = (
    (1.4, 2.4), (1.3375, 2.53125), (1.4375, 2.53125), (1.5, 2.4),
    (1.75, 1.875), (2.0, 1.35), (2.0, 0.9), (2.0, 0.45), (1.5, 0.225), (1.5, 0.15),
    (1.5, 0.075), (1.425, 0.0), (0.0, 0.0),
)  # fmt: skip
_LID = ((0.0, 3.15), (0.8, 3.15), (0.0, 2.85), (0.2, 2.7), (0.4, 2.55), (1.3, 2.55), (1.3, 2.4))
# The list rounds one ring of the knob otherwise: 0.45 at radius 0.8.
_KNOB_CIRCLE = 0.5625

# Half tubes as rows of (x, z) in the mirror plane on the one and on the other side, and the half width between.
_HANDLE: tuple[Row, ...] = (
    ((-1.6, 2.025), (-1.5, 2.25), 0.3), ((-2.3, 2.025), (-2.5, 2.25), 0.3), ((-2.7, 2.025), (-3.0, 2.25), 0.3),
    ((-2.7, 1.8), (-3.0, 1.8), 0.3), ((-2.7, 1.575), (-3.0, 1.35), 0.3), ((-2.5, 1.125), (-2.65, 0.9375), 0.3),
    ((-2.0, 0.9), (-1.9, 0.6), 0.3),
)  # fmt: skip
_SPOUT: tuple[Row, ...] = (
    ((1.7, 1.425), (1.7, 0.6), 0.66), ((2.6, 1.425), (3.1, 0.825), 0.66), ((2.3, 2.1), (2.4, 2.025), 0.25),
    ((2.7, 2.4), (3.3, 2.4), 0.25), ((2.8, 2.475), (3.525, 2.49375), 0.25), ((2.9, 2.475), (3.45, 2.5125), 0.15),
    ((2.8, 2.4), (3.2, 2.4), 0.15),
)  # fmt: skip


class Part(NamedTuple):
    """Patches that close to a ring: nets (along, around, 4, 4, 3), and whether the texture runs against both directions."""

    nets: Points
    reversed: bool


def patches() -> Points:
    """Return the control points of the teapot.

    Returns
    -------
    (32, 4, 4, 3) float64
        In the published units, z up: rim, body and bottom (16 patches), lid (8), handle (4), spout (4). Normals point outwards.

    Examples
    --------
    >>> patches()[0, 0].tolist()
    [[1.4, 0.0, 2.4], [1.4, -0.784, 2.4], [0.784, -1.4, 2.4], [0.0, -1.4, 2.4]]

    **Source**: Newell 1975; Crow 1987. The bottom's rows run on from the body's instead of out from its centre.
    """
    return np.concatenate([part.nets.reshape(-1, 4, 4, 3) for part in parts()])


def parts() -> list[Part]:
    """Body with rim and bottom, lid, handle, spout."""
    lid_circles = [_CIRCLE, _KNOB_CIRCLE, *[_CIRCLE] * 5]
    return [
        Part(_turned(_BODY, [_CIRCLE] * len(_BODY)), reversed=True),
        Part(_turned(_LID, lid_circles), reversed=True),
        Part(_tube(_HANDLE), reversed=True),
        Part(_tube(_SPOUT), reversed=False),
    ]


def _turned(profile: tuple[tuple[float, float], ...], circles: list[float]) -> Points:
    """Turn a profile round the z axis, clockwise seen from above."""
    quarter = np.empty((len(profile), 4, 3))
    for row, ((radius, height), circle) in enumerate(zip(profile, circles, strict=True)):
        inner = round(radius * circle, 9)
        quarter[row] = [(radius, 0, height), (radius, -inner, height), (inner, -radius, height), (0, -radius, height)]
    around = [quarter]
    for _ in range(3):
        last = around[-1]
        around.append(np.stack([last[..., 1], -last[..., 0], last[..., 2]], axis=-1))
    return _split_rows(around)


def _tube(rows: tuple[Row, ...]) -> Points:
    """Close half a tube with its mirror image in y = 0."""
    half = np.array(
        [[(x0, 0, z0), (x0, -width, z0), (x1, -width, z1), (x1, 0, z1)] for (x0, z0), (x1, z1), width in rows], dtype=np.float64
    )
    return _split_rows([half, half[:, ::-1] * (1.0, -1.0, 1.0)])


def _split_rows(around: list[Points]) -> Points:
    n_along = (len(around[0]) - 1) // 3
    return np.array([[column[3 * k : 3 * k + 4] for column in around] for k in range(n_along)]) + 0.0
