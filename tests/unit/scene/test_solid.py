"""Combinations of solids as people describe them (FoCG 13.3)."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

from limner.errors import SceneError
from limner.linear.transform import rotate, scale, translate
from limner.mesh.shapes import primitives
from limner.produce.facts import tight_bounds
from limner.scene import solid as solids
from limner.scene.digest import scene_digest
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.primitive import Box, Cylinder, Disk, Plane, Quadric, Sphere
from limner.scene.scene import Scene
from limner.scene.shape import Shape
from limner.scene.solid import MAX_LEAVES, MAX_NESTING, Complement, Difference, Intersection, Solid, Union
from limner.tables import layouts

RED, BLUE = Lambert((0.7, 0.1, 0.1), name="red"), Lambert((0.1, 0.1, 0.7), name="blue")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Union(Sphere()), "union must have at least 2 parts, got 1"),
        (lambda: Complement(Sphere(), Box()), "complement must have 1 part, got 2"),
        (lambda: Difference(Box(), Disk()), "difference must be made of solids: a Sphere, .* got Disk"),
        (lambda: Intersection(Box(), primitives.box()), "intersection must be made of solids: .* got Mesh"),
        (lambda: Union(Box(), Cylinder(capped=False)), "must have an inside: a Cylinder with capped=False is an open sheet"),
        (lambda: Union(Box(), Quadric((1,) * 10, capped=False)), "a Quadric with capped=False is an open sheet"),
        (lambda: Solid(Solid(Box())), "solid.geometry must be one of the solids: .* got Solid"),
        (lambda: Solid(Box(), scale(1, 0, 1)), "solid.parent_from_solid must not flatten"),
        (lambda: Solid(Box(), np.eye(3)), r"solid.parent_from_solid must be a 4x4 matrix, got shape \(3, 3\)"),
        (lambda: Solid(Box(), material="red"), "solid.material must be a material, got str"),
        (lambda: Shape(Solid(Box())), "shape.geometry must be .* a combination of solids, got Solid"),
        (lambda: Union(*[Sphere()] * (MAX_LEAVES + 1)), "union is made of 63 primitives, more than 62"),
        (lambda: Union(Union(*[Sphere()] * 40), Union(*[Sphere()] * 23)), "union is made of 63 primitives, more than 62"),
    ],
)
def test_what_cannot_be_combined_is_refused(make: Any, message: str) -> None:
    """Sheets have no inside, a ray has 62 bits to count in."""
    with pytest.raises(SceneError, match=message):
        make()


def test_combinations_may_stand_in_each_other_but_not_for_ever() -> None:
    """A double complement is the solid itself; too deep a nest is told before anything has to follow it down."""
    whole: Any = Sphere()
    for _ in range(MAX_NESTING):
        whole = Complement(whole)
    assert scene_digest(Scene(Node(shapes=(Shape(whole),))))
    with pytest.raises(SceneError, match="complement is nested 65 deep, more than 64"):
        Complement(whole)


def test_limits_are_those_of_the_kernels() -> None:
    """The description may not import the tables, so each has the number."""
    assert solids.MAX_LEAVES == layouts.MAX_LEAVES


def test_bounds_follow_the_operations() -> None:
    """Of a union all, of an intersection the common, of a difference the first part's; a half space cuts along its axis."""
    ball, box = Sphere(1.0), Solid(Box((2, 2, 2)), translate(1.5, 0, 0))
    np.testing.assert_array_equal(Union(ball, box).bounds, [[-1, -1, -1], [2.5, 1, 1]])
    np.testing.assert_array_equal(Intersection(ball, box).bounds, [[0.5, -1, -1], [1, 1, 1]])
    np.testing.assert_array_equal(Difference(ball, box).bounds, [[-1, -1, -1], [1, 1, 1]])
    np.testing.assert_array_equal(Intersection(ball, Plane()).bounds, [[-1, -1, -1], [1, 0, 1]])
    assert not np.isfinite(Complement(ball).bounds).any()
    assert len(Complement(ball).hull) == 0
    apart = Intersection(ball, Solid(Box(), translate(9, 0, 0)))
    assert (apart.bounds[0] > apart.bounds[1]).any()
    assert Scene(Node(shapes=(Shape(apart),))).bounds().tolist() == [[np.inf] * 3, [-np.inf] * 3]
    far_box = Union(Solid(Box(), translate(3, 0, 0)), Sphere(0.1))
    turned = Scene(Node(parent_from_node=rotate((0, 0, 1), np.pi / 4), shapes=(Shape(far_box),)))
    np.testing.assert_allclose(tight_bounds(turned)[1], [3 / np.sqrt(2) + np.sqrt(0.5), 3 / np.sqrt(2) + np.sqrt(0.5), 0.5])


def test_parts_tell_what_they_are() -> None:
    """A part without place and material is written as it was given; the digest knows place, order, operation and material."""
    assert repr(Difference(Box(), Union(Sphere(0.5), Sphere(0.25)))) == (
        "Difference(Box(size=(1.0, 1.0, 1.0)), Union(Sphere(radius=0.5), Sphere(radius=0.25)))"
    )
    made = [
        Difference(Box(), Sphere()), Difference(Sphere(), Box()), Union(Box(), Sphere()), Difference(Box(), Complement(Sphere())),
        Difference(Box(), Solid(Sphere(), translate(0, 0, 1e-9))), Difference(Box(), Solid(Sphere(), material=RED)),
        Difference(Box(), Solid(Sphere(), material=BLUE)),
    ]  # fmt: skip
    digests = [scene_digest(Scene(Node(shapes=(Shape(geometry),)))) for geometry in made]
    assert len(set(digests)) == len(made)
    again = [scene_digest(Scene(Node(shapes=(Shape(pickle.loads(pickle.dumps(geometry))),)))) for geometry in made]
    assert again == digests
    assert pickle.loads(pickle.dumps(made[4])).n_leaves == 2
