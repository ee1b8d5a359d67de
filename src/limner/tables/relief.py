"""Displaced shapes as meshes: as fine as the camera needs them, and made anew only when it needs something else.

How fine a surface must be depends on where the camera stands, where it looks, and how large it sees things. A camera that moves or turns a
little should not cost a new surface; but what is remembered must not be seen in a picture. So what counts is not the camera itself, but
the cell of a grid that it is in: its place to a sixteenth of its distance, its gaze to some five degrees. Lengths are measured as the most
demanding camera of the cell sees them: the surface is a little finer than it need be, and a function of the cell alone.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mesh.mesh import Mesh
from ..mesh.reshape.displace import Displaced, displaced
from ..scene.displacement import Displacement
from ..scene.primitive import Sphere
from ..scene.shape import Shape
from .heights import height_function
from .stand_ins import Sight

__all__ = ["Reliefs", "Vantage", "vantage"]

Floats = NDArray[np.float64]

_CELLS = 16.0  # to the camera's distance
_LEAST_DISTANCE = 1.0 / 64.0  # of a shape's size: a camera that is nearer, or inside, counts as standing there
_STEPS_PER_OCTAVE = 8  # of magnification
_LEAST_SHARE = 0.25  # of an edge's length that counts, however it is turned
_ASIDE = 0.25  # of what is seen of an edge that counts where the picture does not reach
_GAZES = 12.0  # cells from the middle of a gaze's cube to its sides
_MARGIN = math.radians(8.0)  # between the gaze of a cell and those of its cameras, and what their places add
_ANGLE_STEP = math.radians(2.0)
_AT_ONCE = 1 << 14  # edges whose numbers stay in the cache
_DIGITS = 5  # of how a transform stretches


class Vantage(NamedTuple):
    """From where a shape is seen, in its own space, and how large: all that its refinement depends on, in plain numbers.

    Attributes
    ----------
    eye : three floats, or None where all is seen at one scale
    slack : float
        How much nearer the camera may be than `eye`.
    least : float
        The distance from which on things do not grow.
    pixels : float
        Of a unit of length at distance 1; without an eye, anywhere.
    stretch : nine floats
        A (3, 3) matrix: lengths in the world, but for scale, are those of what it makes of a vector.
    gaze : three floats
        Unit, in that space.
    cosine : float
        Of the angle to the gaze within which the picture lies; -1: everywhere.
    """

    eye: tuple[float, ...] | None
    slack: float
    least: float
    pixels: float
    stretch: tuple[float, ...]
    gaze: tuple[float, ...] = (0.0, 0.0, 0.0)
    cosine: float = -1.0

    def lengths(self, a: Floats, b: Floats) -> Floats:
        """How many pixels long the edges from (n, 3) to (n, 3) are seen in the picture's middle.

        What points to the camera is seen short, but counts by a quarter at least, and what lies outside the picture by a quarter of that
        in it: it may be seen in a mirror, and throws shadows.
        """
        return np.concatenate([self._seen(a[k : k + _AT_ONCE], b[k : k + _AT_ONCE]) for k in range(0, max(len(a), 1), _AT_ONCE)])

    def _seen(self, a: Floats, b: Floats) -> Floats:
        stretch = np.array(self.stretch).reshape(3, 3)
        along = (b - a) @ stretch.T
        squared = _dot(along, along)
        if self.eye is None:
            return np.asarray(np.sqrt(squared) * self.pixels)
        to_eye = (np.array(self.eye) - a) @ stretch.T
        nearest = np.clip(_dot(to_eye, along) / np.maximum(squared, 1e-300), 0.0, 1.0)
        gap = to_eye - along * nearest[:, None]
        gap_squared = _dot(gap, gap)
        across = squared - _dot(along, gap) ** 2 / np.maximum(gap_squared, 1e-300)
        seen = np.sqrt(np.maximum(across, _LEAST_SHARE**2 * squared))
        distance = np.sqrt(gap_squared)
        inside = self._holds(gap) | self._holds(to_eye) | self._holds(to_eye - along)
        return np.asarray(seen * np.where(inside, 1.0, _ASIDE) * self.pixels / np.maximum(distance - self.slack, max(self.least, 1e-30)))

    def _holds(self, to_eye: Floats) -> NDArray[np.bool_]:
        """Whether points lie in the picture, which vectors (n, 3) from them to the eye tell."""
        return np.asarray(to_eye @ np.array(self.gaze) <= -self.cosine * np.sqrt(_dot(to_eye, to_eye)))


def vantage(matrix: Floats, object_from_world: Floats, sight: Sight, bounds: Floats) -> Vantage:
    """From where a shape of bounds (2, 3) in its own space is seen, rounded to the grid."""
    gram = matrix[:3, :3].T @ matrix[:3, :3]
    size = math.sqrt(max(float(np.trace(gram)) / 3.0, 1e-300))
    values, axes = np.linalg.eigh(np.round(gram / size**2, _DIGITS))
    stretch = np.sqrt(np.maximum(values, 0.0))[:, None] * axes.T
    most = math.sqrt(max(float(values[-1]), 0.0))
    pixels = sight.pixels_per_unit if sight.is_perspective else sight.pixels_per_unit * size
    pixels = 2.0 ** (math.ceil(math.log2(max(pixels, 1e-30)) * _STEPS_PER_OCTAVE) / _STEPS_PER_OCTAVE)
    eye = (object_from_world @ np.append(sight.eye, 1.0))[:3]
    if not sight.is_perspective or not np.isfinite(eye).all():
        return Vantage(None, 0.0, 0.0, pixels, tuple(stretch.ravel().tolist()))
    extent = max(float(np.linalg.norm(bounds[1] - bounds[0])), 1e-30)
    away = float(np.linalg.norm(eye - np.clip(eye, bounds[0], bounds[1])))
    step = 2.0 ** math.floor(math.log2(max(away, _LEAST_DISTANCE * extent) / _CELLS))
    cell = tuple((np.round(eye / step) * step).tolist())
    slack = math.sqrt(3.0) / 2.0 * step * most
    gaze, cosine = _gaze(-(stretch @ object_from_world[:3, :3] @ sight.towards), sight.half_angle)
    return Vantage(cell, slack, _LEAST_DISTANCE / _CELLS * extent * most, pixels, tuple(stretch.ravel().tolist()), gaze, cosine)


def _gaze(direction: Floats, half_angle: float) -> tuple[tuple[float, ...], float]:
    """The gaze in the middle of a direction's cell, and the cosine of the angle round it that holds all that any of the cell sees."""
    length = float(np.linalg.norm(direction))
    wide = math.ceil((half_angle + _MARGIN) / _ANGLE_STEP) * _ANGLE_STEP
    if not length > 0.0 or wide >= math.pi / 2.0:
        return (0.0, 0.0, 0.0), -1.0
    middle = np.round(direction / length * _GAZES)
    return tuple((middle / np.linalg.norm(middle)).tolist()), math.cos(wide)


class _Made(NamedTuple):
    """A displaced mesh, and the one that it was made from, which is kept so that its identity is its own."""

    of: Mesh
    result: Displaced


class Reliefs:
    """The displaced meshes of a build, and those of the one before, which are used again where nothing changed for them."""

    def __init__(self, before: Reliefs | None = None) -> None:
        self._before: dict[tuple[int, Displacement, Vantage], _Made] = {} if before is None else before._made
        self._made: dict[tuple[int, Displacement, Vantage], _Made] = {}
        self.notes: tuple[str, ...] = ()

    @property
    def is_empty(self) -> bool:
        return not self._made

    def get(self, shape: Shape, mesh: Mesh, matrix: Floats, object_from_world: Floats, sight: Sight, path: str) -> Mesh:
        """The displaced surface of a shape that `mesh` stands for, at its place."""
        displacement = shape.displacement
        assert displacement is not None
        look_up = height_function(displacement.height, mesh, path)
        bounds = mesh.bounds + np.array([[-displacement.reach], [displacement.reach]]) if len(mesh.triangles) else np.zeros((2, 3))
        view = vantage(matrix, object_from_world, sight, bounds)
        key = (id(mesh), displacement, view)
        made = self._made.get(key) or self._before.get(key)
        if made is None:
            radius = shape.geometry.radius if isinstance(shape.geometry, Sphere) else None
            result = displaced(
                mesh, look_up, scale=displacement.scale, midlevel=displacement.midlevel, longest_edge=displacement.edge_pixels,
                length=view.lengths, max_triangles=displacement.max_triangles,
                onto=None if radius is None else lambda _, normals: normals * radius,
            )  # fmt: skip
            made = _Made(mesh, result)
        self._made[key] = made
        if made.result.longest > 0.0:
            self._note(path, displacement, made.result)
        return made.result.mesh

    def _note(self, path: str, displacement: Displacement, result: Displaced) -> None:
        n, longest = len(result.mesh.triangles), result.longest
        said = (
            f"the displacement of {path} stops at {n:,} triangles, with edges of {longest:.1f} pixels where "
            f"{displacement.edge_pixels:g} were asked for: more displacement.max_triangles would help"
        )
        self.notes = (*self.notes, said)


def _dot(p: Floats, q: Floats) -> Floats:
    return np.asarray(p[:, 0] * q[:, 0] + p[:, 1] * q[:, 1] + p[:, 2] * q[:, 2])
