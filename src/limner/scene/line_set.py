"""Lines in space: edges of a model, a graph's links, the paths of particles, all that has length and no width (FoCG 8.1.1).

    lines = limner.LineSet([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 1], [1, 2]])
    limner.render(lines).save("lines.png")

A line has no surface, so each is shown as something that has: a tube about it, closed by spheres where tubes meet and where they end.
How wide, the lines themselves say; without that they are as wide as so many pixels of the picture, wherever they are seen.

    o--------o                   (==========)
             |         ->                 |||        tubes with round joints
             o                            (_)
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import LimnerWarning, SceneError
from ..mesh.mesh import named_scalars, read_only
from ._values import positive
from .points import checked_radii

__all__ = ["LINE_WIDTH", "LineSet"]

Floats = NDArray[np.float64]

LINE_WIDTH = 1.5
"""Of lines that do not say how wide they are, in pixels."""

_MOST_IN_HULL = 1 << 16
_AXES = np.concatenate([np.eye(3), -np.eye(3)])


@dataclass(frozen=True, eq=False)
class LineSet:
    """Straight segments between points, each shown as a tube with round ends.

    Parameters
    ----------
    positions : (n, 3) float32
        Object space, metres.
    segments : (m, 2) int32, optional
        Which positions each segment joins. One that joins a position with itself is a dot. None: each position and the next, one line
        through all. A segment with an end that is not finite is not shown, which a warning says.
    colors : (n, 3) or (n, 4) float32, optional
        Linear colour (and alpha) at each position, mixed along the segments.
    radii : float > 0 or (n,) float32 > 0, optional
        Object space, metres; of each position's own, tubes taper. None: as wide as `width_pixels`.
    width_pixels : float > 0
        How wide lines without radii are in the picture, as far as the camera sees them itself: in mirrors and shadows they are as wide as
        this makes them there.
    scalars : mapping of str to (n,) float, optional
        What else is known at each position, by name, to be shown by `limner.color_by`.
    name : str

    Raises SceneError where shapes do not fit, a segment refers to no position, a width is not positive, or no segment is finite.

    >>> LineSet([[0, 0, 0], [1, 0, 0], [1, 2, 0]], radii=0.5).segments.tolist()
    [[0, 1], [1, 2]]
    """

    positions: NDArray[np.float32]
    segments: NDArray[np.int32] | None = None
    colors: NDArray[np.float32] | None = None
    radii: float | NDArray[np.float32] | None = None
    width_pixels: float = LINE_WIDTH
    scalars: Mapping[str, NDArray[np.float32]] | None = None
    name: str = ""

    def __post_init__(self) -> None:
        def put(field: str, value: Any) -> None:
            object.__setattr__(self, field, value)

        put("positions", read_only(self.positions, np.float32, (3,), "line_set.positions"))
        n_positions = len(self.positions)
        if self.segments is None:
            first = np.arange(max(n_positions - 1, 0), dtype=np.int32)
            put("segments", np.stack([first, first + 1], axis=1))
        put("segments", read_only(self.segments, np.int32, (2,), "line_set.segments"))
        self._check_segments()
        if self.colors is not None:
            put("colors", read_only(self.colors, np.float32, (3, 4), "line_set.colors"))
            if len(self.colors) != n_positions:
                raise SceneError(f"line_set.colors must have one row per position ({n_positions}), got {len(self.colors)}", self.name)
        if self.radii is not None:
            put("radii", checked_radii(self.radii, n_positions, "line_set.radii"))
        put("width_pixels", positive(self.width_pixels, "line_set.width_pixels"))
        put("scalars", named_scalars(self.scalars, n_positions, "line_set.scalars"))

    def _check_segments(self) -> None:
        ends = self.ends
        n_positions = len(self.positions)
        if len(ends) and (int(ends.min()) < 0 or int(ends.max()) >= n_positions):
            bad = int(np.flatnonzero(((ends < 0) | (ends >= n_positions)).any(axis=1))[0])
            raise SceneError(f"line_set.segments must refer to {n_positions} positions, got {ends[bad].tolist()} in row {bad}", self.name)
        n_shown = int(np.count_nonzero(self.shown))
        if not n_shown:
            raise SceneError(f"line_set.segments must have at least one row with finite ends, got {len(ends)} rows", self.name)
        if n_shown < len(ends):
            warn(f"{len(ends) - n_shown} of {len(ends)} segments are not finite and are not shown", LimnerWarning, stacklevel=4)

    @property
    def ends(self) -> NDArray[np.int32]:
        """(m, 2) int32: the segments, which are never None once the lines are made."""
        assert self.segments is not None
        return self.segments

    @cached_property
    def shown(self) -> NDArray[np.bool_]:
        """(m,) bool: which segments are finite."""
        finite = np.asarray(np.isfinite(self.positions).all(axis=1))
        return np.asarray(finite[self.ends].all(axis=1))

    @cached_property
    def _used(self) -> tuple[Floats, Floats]:
        """(k, 3) and (k,): the positions that are shown, and how far lines reach about them; 0 where pixels say how wide they are."""
        used = np.unique(self.ends[self.shown])
        reach = np.broadcast_to(np.asarray(0.0 if self.radii is None else self.radii, dtype=np.float64), (len(self.positions),))
        return self.positions[used].astype(np.float64), reach[used]

    def range_along(self, directions: ArrayLike) -> tuple[Floats, Floats]:
        """Tell the least and the greatest a . p over the lines, (n,) float64 each, for (n, 3) directions a of any length."""
        a = np.asarray(directions, dtype=np.float64)
        points, reach = self._used
        along, around = points @ a.T, reach[:, None] * np.linalg.norm(a, axis=1)
        return (along - around).min(axis=0), (along + around).max(axis=0)

    @cached_property
    def bounds(self) -> Floats:
        """(2, 3) float64: least and greatest corner in the node's own space; of lines without radii, those of what they join."""
        return np.array(self.range_along(np.eye(3)))

    @property
    def hull(self) -> Floats:
        """(k, 3) float64: points whose convex hull holds the lines; of many the corners of their box."""
        points, reach = self._used
        if len(points) > _MOST_IN_HULL:
            low, high = self.bounds
            return np.array([[x[0], y[1], z[2]] for x in (low, high) for y in (low, high) for z in (low, high)])
        if not reach.any():
            return points
        # An octahedron of this size holds the sphere.
        return np.asarray((points[:, None] + math.sqrt(3.0) * reach[:, None, None] * _AXES).reshape(-1, 3))

    def __repr__(self) -> str:
        return f"LineSet({self.name!r}, {len(self.positions)} positions, {len(self.ends)} segments)"
