"""Triangles that stand for lines: prisms about the segments and polyhedra where they meet and end, each as fine as it is seen.

A prism has its tube's girth, a polyhedron its sphere's surface, so that neither covers more or less of the picture than what it stands for
(Cauchy; see `limner.tables.clouds`). Prisms have an odd number of sides: those are nearly as wide from everywhere, a square is not.

Lines without radii are as wide as so many pixels: their tubes are made in the world and widen with the depth, which along a segment is a
straight line, as the radius of a tube is. Only what crosses the plane of the eye is cut into parts.

    eye  .              ____----      radius = pixels / 2 * depth / (pixels per unit at depth 1)
         .   ___----    ----____
         .   ----___
"""

from __future__ import annotations

import hashlib
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..linear.transform import transform_points
from ..mesh.mesh import Mesh
from ..scene.line_set import LineSet
from .clouds import MOST_TRIANGLES, fineness, round_solids, solid_errors, tangents

if TYPE_CHECKING:
    from .stand_ins import Sight, StandIns

__all__ = ["line_mesh"]

Floats = NDArray[np.float64]
Levels = NDArray[np.int8]

_CORNERS = (3, 5, 9, 17, 33)  # of prisms
_SEEN = 0.5  # of an outline's error: the girth is right, and most of a joint lies inside the tubes that it joins
_OPEN = 0.2  # pixels by which two tubes may gape that turn into each other without a joint
_BENT = 0.05  # of a radius, how far a cut segment's may be from the truth
_CUTS = 8  # halvings of a segment, at most
_ASIDE = 0.2  # of the distance: depth that is counted at least


class _Tubes(NamedTuple):
    """Segments with the two ends of each side by side: places, radii, colours (or none), and which position an end is; -1: a cut."""

    places: Floats  # (m, 2, 3)
    radii: Floats  # (m, 2)
    colors: Floats | None  # (m, 2, 3 or 4)
    rows: NDArray[np.int32]  # (m, 2)


class _Part(NamedTuple):
    """Corners with what they carry, and the triangles between them."""

    positions: Floats
    normals: Floats
    colors: Floats | None
    triangles: NDArray[np.int64]


def line_mesh(lines: LineSet, matrix: Floats, sight: Sight, stand_ins: StandIns) -> Mesh:
    """The triangles that stand for lines which `matrix` places in the world."""
    in_world = lines.radii is None
    tubes = _tubes(lines, matrix, sight)
    tubes = _cut(tubes, sight, lines.width_pixels) if in_world else tubes
    pixels = _pixel_radii(tubes, None if in_world else matrix, sight, lines.width_pixels)
    sides = fineness(pixels, _SEEN * np.array(_prism_errors()), np.array([2 * n for n in _CORNERS]))
    seen = (tuple(sight.eye), tuple(sight.towards), sight.pixels_per_unit, matrix.tobytes()) if in_world else ()
    state = hashlib.blake2b(_content(lines) + sides.tobytes() + repr(seen).encode(), digest_size=12)
    # Joints are as fine as the pixels ask: their size belongs to the name as well.
    state.update(f"{math.ceil(math.log2(max(float(pixels.max()), 1e-30)))}".encode())
    return stand_ins.named(f"lines {state.hexdigest()}", lambda: _mesh(lines, tubes, sides, pixels, matrix if in_world else None))


def _content(lines: LineSet) -> bytes:
    """Bytes for what lines show."""
    state = hashlib.blake2b(repr(lines.width_pixels).encode(), digest_size=12)
    for array in (lines.positions, lines.segments, lines.colors, lines.radii):
        state.update(b"|" if array is None else np.ascontiguousarray(array).tobytes() + str(np.shape(array)).encode())
    return state.digest()


def _tubes(lines: LineSet, matrix: Floats, sight: Sight) -> _Tubes:
    """The segments in the space where their tubes are round: the lines' own if they have radii, else the world."""
    ends = lines.ends[lines.shown]
    positions = np.where(np.isfinite(lines.positions), lines.positions, 0.0).astype(np.float64)
    colors = None if lines.colors is None else lines.colors.astype(np.float64)[ends]
    if lines.radii is None:
        places = transform_points(matrix, positions)[ends]
        return _Tubes(places, _radii_seen(places, sight, lines.width_pixels), colors, ends)
    radii = np.broadcast_to(np.asarray(lines.radii, dtype=np.float64), (len(positions),))
    return _Tubes(positions[ends], radii[ends], colors, ends)


def _radii_seen(places: Floats, sight: Sight, width_pixels: float) -> Floats:
    """What is half as wide as the pixels say at places of the world, (..., 3)."""
    depth: Floats | float = 1.0
    if sight.is_perspective:
        from_eye = places - sight.eye
        # Beside the eye and behind it things are seen in mirrors alone, but not as nothing.
        depth = np.maximum(np.abs(from_eye @ sight.towards), _ASIDE * np.linalg.norm(from_eye, axis=-1))
    return np.broadcast_to(0.5 * width_pixels / sight.pixels_per_unit * depth, places.shape[:-1])


def _cut(tubes: _Tubes, sight: Sight, width_pixels: float) -> _Tubes:
    """Halve segments until their radii are straight between their ends: what crosses the plane of the eye."""
    if not sight.is_perspective:
        return tubes
    for _ in range(_CUTS):
        middles = tubes.places.mean(axis=1)
        radii = _radii_seen(middles, sight, width_pixels)
        straight = tubes.radii.mean(axis=1)
        bent = np.abs(radii - straight) > _BENT * straight
        if not bent.any() or 2 * len(tubes.radii) * 2 * _CORNERS[1] > MOST_TRIANGLES:
            break
        tubes = _halved(tubes, bent, middles[bent], radii[bent])
    return tubes


def _halved(tubes: _Tubes, chosen: NDArray[np.bool_], middles: Floats, radii: Floats) -> _Tubes:
    def both(values: NDArray[np.generic], between: NDArray[np.generic]) -> NDArray[np.generic]:
        first, second = values[chosen].copy(), values[chosen].copy()
        first[:, 1], second[:, 0] = between, between
        return np.concatenate([values[~chosen], first, second])

    colors = None if tubes.colors is None else both(tubes.colors, tubes.colors[chosen].mean(axis=1))
    cut = np.full(int(chosen.sum()), -1, dtype=np.int32)
    return _Tubes(both(tubes.places, middles), both(tubes.radii, radii), colors, both(tubes.rows, cut))  # type: ignore[arg-type]


def _pixel_radii(tubes: _Tubes, world_from_tubes: Floats | None, sight: Sight, width_pixels: float) -> NDArray[np.float32]:
    """(m,) float32: how large the wider end of each tube is seen."""
    if world_from_tubes is None:
        return np.full(len(tubes.radii), 0.5 * width_pixels, dtype=np.float32)
    scale = float(np.linalg.norm(world_from_tubes[:3, :3], ord=2))
    places = transform_points(world_from_tubes, tubes.places.reshape(-1, 3))
    seen = sight.pixels(places, scale * tubes.radii.reshape(-1)).reshape(-1, 2).max(axis=1)
    return np.asarray(seen, dtype=np.float32)


def _mesh(lines: LineSet, tubes: _Tubes, sides: Levels, pixels: NDArray[np.float32], world_from_object: Floats | None) -> Mesh:
    """The prisms and their joints, in the lines' own space."""
    parts = [*_prisms(tubes, sides), *_joints(tubes, pixels)]
    first = np.cumsum([0, *(len(part.positions) for part in parts)])
    positions, normals = (np.concatenate([part[k] for part in parts]) for k in (0, 1))
    triangles = np.concatenate([part.triangles + start for part, start in zip(parts, first[:-1].tolist(), strict=True)])
    if world_from_object is not None:
        positions = transform_points(np.linalg.pinv(world_from_object), positions)
        normals = normals @ world_from_object[:3, :3]
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.where(length > 0.0, normals / np.where(length > 0.0, length, 1.0), (0.0, 1.0, 0.0))
        if np.linalg.det(world_from_object[:3, :3]) < 0.0:
            triangles = triangles[:, ::-1]
    colors = None if lines.colors is None else np.concatenate([np.asarray(part.colors) for part in parts]).astype(np.float32)
    return Mesh(
        positions.astype(np.float32), np.ascontiguousarray(triangles, dtype=np.int32), normals=normals.astype(np.float32),
        colors=colors, name=lines.name,
    )  # fmt: skip


# --- tubes ------------------------------------------------------------------------------------------------------------------


def _prism_radius(n: int) -> float:
    """From the middle of a regular polygon that is as long around as the unit circle to its corners."""
    return math.pi / (n * math.sin(math.pi / n))


def _prism_errors() -> list[float]:
    """How far the outline of each polygon is from the circle, of its radius."""
    radii = [_prism_radius(n) for n in _CORNERS]
    return [max(radius - 1.0, 1.0 - radius * math.cos(math.pi / n)) for radius, n in zip(radii, _CORNERS, strict=True)]


def _prisms(tubes: _Tubes, sides: Levels) -> list[_Part]:
    axes = tubes.places[:, 1] - tubes.places[:, 0]
    length = np.linalg.norm(axes, axis=1)
    parts = []
    for level, n in enumerate(_CORNERS):
        here = np.flatnonzero((sides == level) & (length > 0.0))
        if not len(here):
            continue
        axis = axes[here] / length[here, None]
        along, across = (made.astype(np.float64) for made in tangents(axis.astype(np.float32)))
        angles = 2.0 * np.pi * np.arange(n) / n
        around = np.cos(angles)[:, None] * along[:, None] + np.sin(angles)[:, None] * across[:, None]
        radii = _prism_radius(n) * tubes.radii[here]
        rings = tubes.places[here][:, :, None] + radii[:, :, None, None] * around[:, None]
        # A tube that widens faces back by as much.
        leaning = around * length[here, None, None] - (tubes.radii[here, 1] - tubes.radii[here, 0])[:, None, None] * axis[:, None]
        normals = leaning / np.linalg.norm(leaning, axis=2, keepdims=True)
        j = np.arange(n)
        after = (j + 1) % n
        pattern = np.concatenate([np.stack([j, after, n + after], axis=1), np.stack([j, n + after, n + j], axis=1)])
        starts = 2 * n * np.arange(len(here))
        colors = None if tubes.colors is None else np.repeat(tubes.colors[here].reshape(-1, tubes.colors.shape[2]), n, axis=0)
        parts.append(
            _Part(rings.reshape(-1, 3), np.repeat(normals[:, None], 2, axis=1).reshape(-1, 3), colors,
                  (starts[:, None, None] + pattern).reshape(-1, 3))
        )  # fmt: skip
    return parts


# --- joints -----------------------------------------------------------------------------------------------------------------


def _joints(tubes: _Tubes, pixels: NDArray[np.float32]) -> list[_Part]:
    """Spheres where lines end, where more than two meet, and where two turn by more than is seen."""
    ends = np.flatnonzero(tubes.rows.reshape(-1) >= 0)
    rows, at = np.unique(tubes.rows.reshape(-1)[ends], return_inverse=True)
    count = np.bincount(at, minlength=len(rows))
    axes = tubes.places[:, 1] - tubes.places[:, 0]
    length = np.linalg.norm(axes, axis=1, keepdims=True)
    away = (np.stack([axes, -axes], axis=1) / np.where(length > 0.0, length, 1.0)[:, None]).reshape(-1, 3)[ends]
    # Two that go on straight leave in opposite directions: what is left of their sum tells how far they turn.
    turn = np.stack([np.bincount(at, away[:, k], minlength=len(rows)) for k in range(3)], axis=1)
    is_dot = np.bincount(at, np.repeat(length[:, 0] == 0.0, 2)[ends], minlength=len(rows)) > 0.0
    seen = np.zeros(len(rows), dtype=np.float32)
    np.maximum.at(seen, at, np.repeat(pixels, 2)[ends])
    needed = (count != 2) | is_dot | (np.linalg.norm(turn, axis=1) * seen > _OPEN)
    if not needed.any():
        return []
    one = np.zeros(len(rows), dtype=np.int64)
    one[at] = ends
    chosen, seen = one[needed], seen[needed]
    places, radii = tubes.places.reshape(-1, 3)[chosen], tubes.radii.reshape(-1)[chosen]
    colors = None if tubes.colors is None else tubes.colors.reshape(-1, tubes.colors.shape[2])[chosen]
    solids = round_solids()
    levels = fineness(seen, _SEEN * np.array(solid_errors()), np.array([len(solid.triangles) for solid in solids]))
    parts = []
    for level, solid in enumerate(solids):
        here = np.flatnonzero(levels == level)
        if len(here):
            k = len(solid.corners)
            corners = places[here, None] + radii[here, None, None] * solid.corners
            outwards = np.tile(solid.corners / np.linalg.norm(solid.corners, axis=1, keepdims=True), (len(here), 1))
            triangles = (k * np.arange(len(here))[:, None, None] + solid.triangles).reshape(-1, 3)
            parts.append(_Part(corners.reshape(-1, 3), outwards, None if colors is None else np.repeat(colors[here], k, axis=0), triangles))
    return parts
