"""Exact geometries as people describe them: what is refused, and how far they reach."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import limner
from limner.errors import SceneError
from limner.linear.transform import in_order, rotate, scale, translate
from limner.scene.digest import scene_digest
from limner.scene.framing import extent_points
from limner.scene.node import Node
from limner.scene.primitive import BilinearPatch, Box, Cone, Cylinder, Disk, Plane, Primitive, Quadric, Sphere, Torus
from limner.scene.scene import Scene
from limner.scene.shape import Shape
from limner.tables.build import flatten

SADDLE = Quadric((1, 0, -1, 0, 0, 0, 0, -1, 0, 0), low=(-1, -0.9, -0.8), high=(0.7, 1, 1))
BENT = BilinearPatch(((0, 0, 0), (1, 0, 0.2), (1, 1, 1), (0, 1, 0)))
ALL: tuple[Primitive, ...] = (
    Sphere(0.7), Box((0.5, 1.0, 2.0)), Disk(1.3), Cylinder(0.4, 1.7), Cylinder(1.4, 0.3, capped=False), Cone(1.0, 2.0), Cone(0.2, 0.9, 0.8),
    Cone(0.0, 1.0, 0.5), Torus(1.0, 0.3), Torus(0.5, 0.5), SADDLE, BENT,
)  # fmt: skip
NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Disk(0), "disk.radius must be positive, got 0.0"),
        (lambda: Cylinder(-1.0), "cylinder.radius must be positive, got -1.0"),
        (lambda: Cylinder(1.0, NAN), "cylinder.height must be finite, got nan"),
        (lambda: Cylinder(1.0, 1.0, "no"), "cylinder.capped must be True or False, got 'no'"),
        (lambda: Cone(-0.1), "cone.radius must not be negative, got -0.1"),
        (lambda: Cone(0.0, 1.0, 0.0), "cone.radius and cone.top_radius must not both be 0"),
        (lambda: Cone(1.0, INF), "cone.height must be finite, got inf"),
        (lambda: Torus(1.0, 1.5), "torus.minor_radius must not exceed the major radius of 1.0, got 1.5"),
        (lambda: Torus(1.0, "fat"), "torus.minor_radius must be a number, got 'fat'"),
        (lambda: Quadric((1, 2, 3)), "quadric.coefficients must be ten numbers"),
        (lambda: Quadric((0,) * 9 + (1,)), "quadric.coefficients must not all be 0 but the last"),
        (lambda: Quadric((1,) * 9 + (NAN,)), "quadric.coefficients must be finite"),
        (lambda: Quadric((1,) * 10, low=0, high=(1, 0, 1)), "quadric.low must lie below quadric.high along every axis"),
        (lambda: BilinearPatch(((0, 0, 0),) * 3), "bilinear_patch.corners must be four points"),
        (lambda: BilinearPatch(((0, 0, 0), (1, 1, 1), (2, 2, 2), (3, 3, 3))), "must not all lie on one line"),
        (lambda: BilinearPatch(((1, 2, 3),) * 4), "must not all lie on one line"),
        (lambda: BilinearPatch(((0, 0), (1, 0), (1, 1), (0, 1))), "bilinear_patch.corners must be three numbers"),
        (
            lambda: Shape("ball"),
            "shape.geometry must be a Mesh, a PointCloud, a LineSet, a Sphere, Box or another primitive, a DistanceField or a "
            "combination of solids, "
            "got str",
        ),
    ],
)
def test_what_is_no_shape_is_refused(make: Any, message: str) -> None:
    """In one line that names the field, what was expected and what was found."""
    with pytest.raises(SceneError, match=message.replace("(", r"\(").replace(")", r"\)")):
        make()


def _vertices(geometry: Primitive, matrix: Any) -> Any:
    """(n, 3): points of its surface in the world, from its tessellation."""
    scene = Scene(Node(parent_from_node=matrix, shapes=(Shape(geometry),)))
    camera = limner.Camera.look_at((0, 1, 9), (0, 0, 0))
    (mesh,) = flatten(scene, camera, 400, 400).meshes
    return mesh.positions.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


@pytest.mark.parametrize("geometry", ALL, ids=lambda geometry: type(geometry).__name__)
def test_ranges_touch_the_surface(geometry: Primitive) -> None:
    """In any place: no point of its surface lies beyond its range along any direction, and all but a quadric reach it."""
    random = np.random.default_rng(5)
    for _ in range(4):
        turned = rotate(random.normal(size=3), random.uniform(0, 6))
        matrix = in_order(scale(*random.uniform(0.3, 2.0, 3)), turned, translate(*random.normal(size=3)))
        points = _vertices(geometry, matrix)
        directions = random.normal(size=(20, 3))
        low, high = geometry.range_along(directions @ matrix[:3, :3])
        along = directions @ points.T - (directions @ matrix[:3, 3])[:, None]
        size = high - low
        assert (along.min(axis=1) >= low - 1e-5 * size).all()
        assert (along.max(axis=1) <= high + 1e-5 * size).all()
        if not isinstance(geometry, Quadric):
            assert (along.min(axis=1) <= low + 0.01 * size).all()
            assert (along.max(axis=1) >= high - 0.01 * size).all()


@pytest.mark.parametrize("geometry", ALL, ids=lambda geometry: type(geometry).__name__)
def test_hulls_hold_the_surface(geometry: Primitive) -> None:
    """The points that cameras frame reach as far as the shape in every direction, and not much farther."""
    random = np.random.default_rng(6)
    directions = random.normal(size=(200, 3))
    along = directions @ geometry.hull.T
    low, high = geometry.range_along(directions)
    size = high - low
    assert (along.min(axis=1) <= low + 1e-9 * size).all()
    assert (along.max(axis=1) >= high - 1e-9 * size).all()
    # A torus is framed by the cylinder around it, a ball by its box.
    assert (along.max(axis=1) <= high + (0.4 if isinstance(geometry, (Torus, Sphere)) else 0.03) * size).all()


def test_a_plane_has_no_end() -> None:
    """But looks up at 0; it counts nowhere where things are measured."""
    low, high = Plane().range_along([[0, 2, 0], [0, -1, 0], [1, 1, 0]])
    assert low.tolist() == [-INF, 0.0, -INF]
    assert high.tolist() == [0.0, INF, INF]
    scene = Scene(Node(shapes=(Shape(Plane()), Shape(Disk(2.0)))))
    np.testing.assert_array_equal(scene.bounds(), [[-2, 0, -2], [2, 0, 2]])
    assert len(extent_points(scene)) == len(Disk().hull)


def test_every_number_changes_the_digest_and_pickles() -> None:
    """What describes a shape is what tells it from others."""
    shapes = [*ALL, Disk(1.4), Cylinder(0.4, 1.7, capped=False), Torus(1.0, 0.31), Quadric((1, 0, -1, 0, 0, 0, 0, -1, 0, 1e-9))]
    digests = [scene_digest(Scene(Node(shapes=(Shape(shape),)))) for shape in shapes]
    assert len(set(digests)) == len(shapes)
    again = [scene_digest(Scene(Node(shapes=(Shape(pickle.loads(pickle.dumps(shape))),)))) for shape in shapes]
    assert again == digests
