"""What is known about a surface, as its colours: one number at each vertex or point, through a colour map.

    mesh = limner.color_by(mesh, "curvature", "cool_warm", range=(-1, 1))

Between vertices the colours are interpolated, not the numbers: triangles have to be small against what changes along them.
"""

from __future__ import annotations

import dataclasses
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..color.maps import DEFAULT_MAP, NAN_COLOR, mapped
from ..errors import SceneError
from ..mesh.mesh import Mesh
from .line_set import LineSet
from .points import PointCloud

__all__ = ["color_by", "named_numbers", "scalars_of"]

Colored = TypeVar("Colored", Mesh, PointCloud, LineSet)


def color_by(
    geometry: Colored,
    values: str | ArrayLike,
    color_map: str | ArrayLike = DEFAULT_MAP,
    range: tuple[float, float] | None = None,
    nan_color: tuple[float, float, float] = NAN_COLOR,
) -> Colored:
    """Colour a mesh, a point cloud or lines by numbers.

    Parameters
    ----------
    geometry : Mesh, PointCloud or LineSet
    values : (n,) float, or str
        One for each position; or the name of those that the geometry has itself (`scalars`, and `vertex_attributes` of one number each).
    color_map : str or (n, 3) float
        "viridis" (the default), "magma", "inferno", "plasma", "cividis", "turbo", "cool_warm", "grey"; or linear colours.
    range : (low, high), optional
        What the ends of the map stand for; beyond them their colours go on. None: the least and the greatest finite number.
    nan_color : three floats
        Linear; where there is no number.

    Returns
    -------
    Mesh, PointCloud or LineSet
        The same with these `colors`. A material multiplies them: ``Lambert((1, 1, 1))`` shows them as they are.

    >>> mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> color_by(mesh, [0, 1, 2], "grey").colors[:, 0].round(2)
    array([0.  , 0.21, 1.  ], dtype=float32)
    """
    if not isinstance(geometry, (Mesh, PointCloud, LineSet)):
        raise SceneError(f"color_by needs a Mesh, a PointCloud or a LineSet, got {type(geometry).__name__}")
    numbers = scalars_of(geometry, values)
    return dataclasses.replace(geometry, colors=mapped(numbers, color_map, range, nan_color))


def named_numbers(geometry: Mesh | PointCloud | LineSet) -> dict[str, NDArray[Any]]:
    """What is known at each position as one real number, (n,), by name: `scalars`, and `vertex_attributes` that are so."""
    attributes = (geometry.vertex_attributes or {}) if isinstance(geometry, Mesh) else {}
    single = {name: values for name, values in attributes.items() if values.ndim == 1 and values.dtype.kind in "biuf"}
    return {**single, **(geometry.scalars or {})}


def scalars_of(geometry: Mesh | PointCloud | LineSet, values: str | ArrayLike) -> NDArray[np.float64]:
    """(n,) float64: numbers at each position, given as they are or by name; SceneError, with the known names, where there are none."""
    n_positions = len(geometry.positions)
    if isinstance(values, str):
        known = named_numbers(geometry)
        if values not in known:
            names = ", ".join(sorted(known)) or "none"
            raise SceneError(f"there are no scalars {values!r}; there are: {names}", geometry.name)
        return np.asarray(known[values], dtype=np.float64)
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(f"values must be numbers, got {type(values).__name__}") from None
    if numbers.shape != (n_positions,):
        raise SceneError(f"values must be one number for each of {n_positions} positions, got shape {numbers.shape}", geometry.name)
    return numbers
