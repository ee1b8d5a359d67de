"""Triangles that stand for exact shapes where only triangles will do: in the rasteriser, and under transforms that flatten.

Spheres and planes are tessellated only to tell that they are seen; what is seen is computed exactly (`limner.shading.analytic`). All other
shapes are drawn as their triangles are: their vertices lie on the surface, with its own normals and texture coordinates, and their edges
leave it by a tenth of a pixel at most where it is round about an axis. Quadrics, combinations of solids and fields of distances are cut
out of finer triangles, to a few pixels.
"""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..linear.transform import normal_matrix
from ..mesh.implicit.level_set import level_set
from ..mesh.mesh import Mesh
from ..mesh.reshape.trim import Surface, joined, refined, surface_of, trimmed
from ..mesh.shapes import primitives
from ..scene.camera import Camera, PerspectiveCamera
from ..scene.distance_field import DistanceField
from ..scene.line_set import LineSet
from ..scene.points import PointCloud
from ..scene.shape import BilinearPatch, Box, Combination, Cone, Cylinder, Disk, Plane, Primitive, Quadric, Shape, Sphere, Torus
from .boundary import boundary_of_leaf, quadric_values
from .clouds import cloud_mesh
from .distance import numbers_of
from .distance_mesh import distance_mesh
from .exact import Leaf, leaves_and_program, materials_of
from .lines import line_mesh

__all__ = ["Sight", "StandIns", "flattens", "inverse", "tessellation"]

Matrix = NDArray[np.float64]

_CHORD_ERROR = 0.1  # pixels between a sphere and its tessellation
_STAND_IN = "stand-in: "  # how the names of tessellations begin
_HORIZON = 1e5  # how far an infinite plane is drawn, in units of the distance that matters
_MOST_CUBES = 48  # along each edge of a quadric's box
_MOST_BANDS = 64  # of a combination's leaf
_MOST_FIELD_CUBES = 96  # along each edge of a distance field's box
_PARTS = 48  # of a combination's extent: what is smaller may be missed


class StandIns:
    """Tessellations of exact shapes by what they are made from, so that the same question gets the same object again.

    `before` has those of the last build; what that did not ask for is forgotten.
    """

    def __init__(self, before: StandIns | None = None) -> None:
        self._before: dict[str, Mesh] = {} if before is None else before._known
        self._known: dict[str, Mesh] = {}

    @property
    def is_empty(self) -> bool:
        return not self._known

    def get(self, make: Callable[..., Mesh], *arguments: object) -> Mesh:
        """What `make` makes of these, whose names tell all about them."""
        return self.named(f"{make.__name__}{arguments}", lambda: make(*arguments))

    def named(self, name: str, make: Callable[[], Mesh]) -> Mesh:
        """What `make` makes, or what was made by this name."""
        name = _STAND_IN + name
        if name not in self._known:
            self._known[name] = self._before.get(name) or dataclasses.replace(make(), name=name)
        return self._known[name]


class Sight:
    """How large things are in a picture, which decides how finely they are tessellated."""

    def __init__(self, camera: Camera, width: int, height: int, bounds: NDArray[np.float64]) -> None:
        self.eye = np.asarray(camera.world_from_camera)[:3, 3]
        self.towards = np.asarray(camera.world_from_camera)[:3, 2]
        self.bounds = bounds
        self.is_perspective = isinstance(camera, PerspectiveCamera)
        # Pixels per unit of length, along the denser axis, at distance 1 (perspective) or anywhere (orthographic).
        half = camera.half_height() if isinstance(camera, PerspectiveCamera) else camera.height / 2.0
        self.pixels_per_unit = height / (2.0 * half * min(1.0, camera.pixel_aspect))
        # From the gaze to the farthest corner of the picture, radians.
        half_height, pixel_aspect, shift_x, shift_y = camera.lens()
        half_width = half_height * width / height * pixel_aspect
        self.half_angle = math.atan(math.hypot(half_width * (1.0 + abs(shift_x)), half_height * (1.0 + abs(shift_y))))

    def pixels(self, points: Matrix, radii: NDArray[np.float64]) -> NDArray[np.float64]:
        """How large radii are seen at points of the world, (n, 3)."""
        if not self.is_perspective:
            return radii * self.pixels_per_unit
        # No nearer than the radius: what holds the eye is not seen from outside.
        distance = np.maximum(np.linalg.norm(points - self.eye, axis=1), radii)
        return radii * self.pixels_per_unit / np.maximum(distance, 1e-30)

    def to_eye(self, points: Matrix) -> Matrix:
        """Vectors, (n, 3) of any length, from points of the world against the gaze that sees them."""
        return self.eye - points if self.is_perspective else np.broadcast_to(self.towards, points.shape)

    def bands(self, matrix: NDArray[np.float64], radius: float) -> int:
        """How many bands from pole to pole a sphere of an object's space needs."""
        largest = float(np.linalg.norm(matrix[:3, :3], ord=2)) * radius
        distance = max(float(np.linalg.norm(matrix[:3, 3] - self.eye)) - largest, 0.01 * largest, 1e-30)
        return _sphere_bands(largest * self.pixels_per_unit / (distance if self.is_perspective else 1.0))


def tessellation(shape: Shape, matrix: NDArray[np.float64], sight: Sight, stand_ins: StandIns) -> Mesh:
    """The triangles that stand for a shape."""
    geometry = shape.geometry
    if isinstance(geometry, Mesh):
        return geometry
    if isinstance(geometry, PointCloud):
        return cloud_mesh(geometry, matrix, sight, stand_ins)
    if isinstance(geometry, LineSet):
        return line_mesh(geometry, matrix, sight, stand_ins)
    if isinstance(geometry, Box):
        return stand_ins.get(primitives.box, geometry.size)
    if isinstance(geometry, Plane):
        return _plane_around(matrix, sight.eye, sight.bounds, stand_ins)
    if isinstance(geometry, Sphere):
        return stand_ins.get(primitives.sphere, geometry.radius, sight.bands(matrix, geometry.radius))
    if isinstance(geometry, Combination):
        low, high = geometry.bounds
        reach = float(np.abs([low, high]).max()) if np.isfinite([low, high]).all() else 1.0
        bands = sight.bands(matrix, reach)
        return stand_ins.named(f"combination of {_content(shape)} by {bands}", lambda: _combination(shape, bands))
    if isinstance(geometry, DistanceField):
        n = min(2 * sight.bands(matrix, float(np.linalg.norm(np.ptp(geometry.bounds, axis=0))) / 2.0), _MOST_FIELD_CUBES)
        content = hashlib.blake2b(numbers_of(geometry).tobytes(), digest_size=12).hexdigest()
        return stand_ins.named(f"distance field {content} by {n}", lambda: distance_mesh(geometry, n))
    return _primitive(geometry, matrix, sight, stand_ins)


def _primitive(
    geometry: Disk | Cylinder | Cone | Torus | Quadric | BilinearPatch, matrix: Matrix, sight: Sight, stand_ins: StandIns
) -> Mesh:
    """The triangles of what is drawn by them alone."""
    if isinstance(geometry, Disk):
        return stand_ins.get(primitives.disk, geometry.radius, 2 * sight.bands(matrix, geometry.radius))
    if isinstance(geometry, Cylinder):
        n = 2 * sight.bands(matrix, geometry.radius)
        return stand_ins.get(primitives.cylinder, geometry.radius, geometry.height, n, geometry.capped)
    if isinstance(geometry, Cone):
        n = 2 * sight.bands(matrix, max(geometry.radius, geometry.top_radius))
        return stand_ins.get(primitives.cone, geometry.radius, geometry.height, geometry.top_radius, n, geometry.capped)
    if isinstance(geometry, Torus):
        n_u, n_v = (2 * sight.bands(matrix, r) for r in (geometry.major_radius + geometry.minor_radius, geometry.minor_radius))
        return stand_ins.get(primitives.torus, geometry.major_radius, geometry.minor_radius, n_u, n_v)
    reach = float(np.linalg.norm(np.ptp(geometry.hull, axis=0))) / 2.0
    bands = sight.bands(matrix, reach)
    if isinstance(geometry, BilinearPatch):
        return stand_ins.get(primitives.bilinear_patch, geometry.corners, min(bands, 64))
    return stand_ins.get(_quadric, geometry, min(2 * bands, _MOST_CUBES))


def _sphere_bands(radius_in_pixels: float) -> int:
    """Bands from pole to pole whose chords stay within a tenth of a pixel, r (1 - cos(pi/2n)) <= 1/10: a power of two.

    A camera that moves a little then finds the same sphere again.
    """
    ratio = min(_CHORD_ERROR / max(radius_in_pixels, 1e-9), 1.0)
    bands = math.pi / (2.0 * max(math.acos(1.0 - ratio), 1e-3))
    return int(min(max(2 ** math.ceil(math.log2(bands)), 8), 256))


def _plane_around(
    matrix: NDArray[np.float64], eye: NDArray[np.float64], bounds: NDArray[np.float64], stand_ins: StandIns
) -> Mesh:
    """The infinite plane as rings around the point below the eye, as far as the horizon needs."""
    local = inverse(matrix) @ np.append(eye, 1.0)
    height = abs(float(local[1]))
    extent = float(np.linalg.norm(bounds[1] - bounds[0])) if np.isfinite(bounds).all() else 1.0
    reach = max(height, extent, 1e-6)
    foot = (float(local[0]), float(local[2]))
    return stand_ins.get(primitives.plane_disk, foot, max(0.25 * height, 1e-4 * reach), _HORIZON * reach, 48)


def flattens(matrix: Matrix) -> bool:
    """Whether a transform leaves next to nothing of some direction, as far as float32 can tell."""
    lengths = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return not lengths[-1] > 1e-6 * lengths[0]


def inverse(matrix: Matrix) -> Matrix:
    """The inverse, or the pseudo-inverse of a transform that flattens."""
    try:
        return np.linalg.inv(matrix).astype(np.float64)
    except np.linalg.LinAlgError:
        return np.linalg.pinv(matrix).astype(np.float64)


# --- quadrics -------------------------------------------------------------------------------------------------------------


def _quadric(geometry: Quadric, n: int) -> Mesh:
    """A quadric in its box, cut into n cubes along each edge; u around +y, v the share of the height; its caps as faces of a box."""
    low, high = np.array(geometry.low), np.array(geometry.high)
    positions, triangles = level_set(lambda p: quadric_values(geometry, p), low, high, n)
    a, b, c, d, e, f, g, h, i, _ = geometry.coefficients
    x, y, z = positions.T
    gradient = np.stack([2 * a * x + d * y + e * z + g, d * x + 2 * b * y + f * z + h, e * x + f * y + 2 * c * z + i], axis=1)
    u, v = 0.5 + np.arctan2(-z, x) / (2.0 * math.pi), (y - low[1]) / (high[1] - low[1])
    sides = [_without_seam(Surface(np.column_stack([positions, gradient, u, v]), triangles))]
    if geometry.capped:
        faces = surface_of(primitives.box(high - low))
        faces.corners[:, :3] += (low + high) / 2.0
        fine = refined(faces, float((high - low).max()) / n, np.array([low, high]))
        sides.append(trimmed(fine, lambda corners: quadric_values(geometry, corners[:, :3]) <= 0.0))
    return joined(sides).mesh()


def _without_seam(surface: Surface) -> Surface:
    """Where a triangle crosses the seam of u, its corners with u near 0 get corners of their own with u near 1."""
    corners, triangles = surface.corners, surface.triangles.copy()
    u = corners[triangles, 6]
    late = (u < 0.5) & (np.ptp(u, axis=1) > 0.5)[:, None]
    copies = corners[triangles[late]]
    copies[:, 6] += 1.0
    triangles[late] = len(corners) + np.arange(len(copies))
    return Surface(np.concatenate([corners, copies]), triangles)


# --- combinations ---------------------------------------------------------------------------------------------------------


def _content(shape: Shape) -> str:
    """A word for what a combination is made of, its leaves' places and materials among it."""
    assert isinstance(shape.geometry, Combination)
    leaves, program = leaves_and_program(shape.geometry)
    group = [id(material) for material in materials_of(shape)]
    state = hashlib.blake2b(program.tobytes(), digest_size=12)
    for leaf in leaves:
        own = 0 if leaf.material is None else group.index(id(leaf.material))
        state.update(repr((leaf.geometry, leaf.combination_from_leaf.tolist(), own)).encode())
    return state.hexdigest()


def _combination(shape: Shape, bands: int) -> Mesh:
    """The boundary of a combination; each triangle names the material of its leaf."""
    assert isinstance(shape.geometry, Combination)
    leaves, program = leaves_and_program(shape.geometry)
    group = [id(material) for material in materials_of(shape)]
    within = _region(shape.geometry, leaves)
    extent = float(np.linalg.norm(within[1] - within[0]))
    geometries, places = [leaf.geometry for leaf in leaves], [inverse(leaf.combination_from_leaf) for leaf in leaves]
    found: list[Surface] = []
    slots = [np.zeros(0, dtype=np.int32)]
    for k, leaf in enumerate(leaves):
        surface = _leaf_surface(leaf.geometry, leaf.combination_from_leaf, _leaf_bands(leaf, bands, extent), within)
        parts = boundary_of_leaf(surface, k, geometries, places, program, extent, extent / _PARTS, within)
        own = 0 if leaf.material is None else group.index(id(leaf.material))
        slots.append(np.full(sum(len(part.triangles) for part in parts), own, dtype=np.int32))
        found += parts
    return joined(found).mesh(np.concatenate(slots))


def _leaf_bands(leaf: Leaf, bands: int, extent: float) -> int:
    """Bands for a leaf where the whole would need so many: what a chord leaves out is r / n^2."""
    radius = 0.0 if isinstance(leaf.geometry, Plane) else float(np.linalg.norm(leaf.geometry.bounds, axis=1).max())
    share = 2.0 * radius * float(np.linalg.norm(leaf.combination_from_leaf[:3, :3], ord=2)) / extent
    return int(min(max(2 ** math.ceil(math.log2(max(bands * math.sqrt(share), 1.0))), 8), _MOST_BANDS))


def _region(combination: Combination, leaves: list[Leaf]) -> Matrix:
    """(2, 3): a box that holds a combination; of one without end, what lies round its bounded leaves."""
    low, high = combination.bounds
    if np.isfinite([low, high]).all():
        return np.array([low, high])
    hulls = [leaf.geometry.hull @ leaf.combination_from_leaf[:3, :3].T + leaf.combination_from_leaf[:3, 3] for leaf in leaves]
    points = np.concatenate([*hulls, np.zeros((0, 3))])
    points = points if len(points) else np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
    around = float(np.ptp(points, axis=0).max())
    return np.array([points.min(axis=0) - around, points.max(axis=0) + around])


def _leaf_surface(geometry: Primitive, combination_from_leaf: Matrix, bands: int, within: Matrix) -> Surface:
    """A leaf's whole surface in the space of the combination; of a plane, what lies in the box."""
    if isinstance(geometry, Plane):
        corners = np.array([[within[i, 0], within[j, 1], within[k, 2], 1.0] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
        local = (corners @ inverse(combination_from_leaf).T)[:, :3]
        (x0, _, z0), (x1, _, z1) = local.min(axis=0), local.max(axis=0)
        own = surface_of(primitives.quad([[x0, 0.0, z1], [x1, 0.0, z1], [x1, 0.0, z0], [x0, 0.0, z0]]))
        own.corners[:, 6], own.corners[:, 7] = own.corners[:, 0], -own.corners[:, 2]
    elif isinstance(geometry, Quadric):
        own = surface_of(_quadric(geometry, _MOST_CUBES))
    elif isinstance(geometry, Box):
        own = surface_of(primitives.box(geometry.size))
    elif isinstance(geometry, Sphere):
        own = surface_of(primitives.sphere(geometry.radius, bands))
    elif isinstance(geometry, Cylinder):
        own = surface_of(primitives.cylinder(geometry.radius, geometry.height, 2 * bands))
    elif isinstance(geometry, Cone):
        own = surface_of(primitives.cone(geometry.radius, geometry.height, geometry.top_radius, 2 * bands))
    else:
        assert isinstance(geometry, Torus)
        own = surface_of(primitives.torus(geometry.major_radius, geometry.minor_radius, 2 * bands, bands))
    placed = own.corners.copy()
    placed[:, :3] = own.corners[:, :3] @ combination_from_leaf[:3, :3].T + combination_from_leaf[:3, 3]
    placed[:, 3:6] = own.corners[:, 3:6] @ normal_matrix(combination_from_leaf).T
    reflects = np.linalg.det(combination_from_leaf[:3, :3]) < 0.0
    return Surface(placed, own.triangles[:, ::-1] if reflects else own.triangles)
