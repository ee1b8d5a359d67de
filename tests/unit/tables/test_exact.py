"""Exact shapes in the tables: what is shared, where things stand, and that a row tells one content from another."""

from __future__ import annotations

import numpy as np
from staging import grid, place, scene_of

from limner.linear.transform import in_order, rotate, scale, translate
from limner.scene.camera import PerspectiveCamera
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.primitive import BilinearPatch, Box, Cylinder, Plane, Primitive, Quadric, Sphere, Torus
from limner.scene.scene import Scene
from limner.scene.shape import Shape
from limner.scene.solid import Complement, Difference, Intersection, Solid, Union
from limner.tables import layouts
from limner.tables.boundary import inside
from limner.tables.build import Built, flatten, names
from limner.tables.exact import leaves_and_program

CAMERA = PerspectiveCamera.look_at((3, 2, 5), (0, 0, 0))
RED, BLUE, GREEN = (Lambert(color, name=name) for color, name in (((1, 0, 0), "red"), ((0, 0, 1), "blue"), ((0, 1, 0), "green")))
BALL = (1, 1, 1, 0, 0, 0, 0, 0, 0, -1)


def _flat(scene: Scene, previous: Built | None = None) -> Built:
    return flatten(scene, CAMERA, 64, 48, previous, tessellate=False)


def test_programs_are_postfix_and_name_a_primitive_in_one_place_once() -> None:
    """Many parts are many operations; the same object in the same place is one leaf, in another place another."""
    ball, box = Sphere(), Box()
    leaves, program = leaves_and_program(Difference(box, Union(ball, Solid(ball, translate(1, 0, 0))), Complement(ball)))
    assert [leaf.geometry for leaf in leaves] == [box, ball, ball]
    assert program.tolist() == [0, 1, 2, layouts.UNION, layouts.DIFFERENCE, 1, layouts.COMPLEMENT, layouts.DIFFERENCE]


def test_places_of_parts_are_joined_and_materials_inherited() -> None:
    """A part stands where all above it put it; without a material it has that of what it is part of."""
    inner = Union(Sphere(), Solid(Box(), translate(0, 1, 0), material=GREEN))
    shape = Shape(Intersection(Solid(inner, rotate((0, 0, 1), np.pi / 2), material=BLUE), Torus()), (RED,))
    scene = scene_of(place(shape.geometry, RED, at=(5, 0, 0)))
    tables = _flat(scene).tables
    whole, ball, box, torus = tables.instances
    assert whole["kind"] == layouts.CSG
    assert [row["kind"] for row in (ball, box, torus)] == [layouts.SPHERE, layouts.BOX, layouts.TORUS]
    assert tables.instances["owner"].tolist() == [0, 0, 0, 0]
    np.testing.assert_allclose(box["world_from_object"][:, 3], [4, 0, 0], atol=1e-6)
    colors = [tables.materials["color"][row["material"]].tolist() for row in (whole, ball, box, torus)]
    assert colors == [[1, 0, 0], [0, 0, 1], [0, 1, 0], [1, 0, 0]]
    assert names(scene)["material_id"] == ("red", "blue", "green")
    assert len(names(scene)["instance_id"]) == 1


def test_numbers_and_programs_stand_behind_those_of_meshes_once() -> None:
    """Every row finds its own; nodes that share a shape share its numbers (FoCG 13.2)."""
    mesh = grid(4, 1.0)
    quadric, patch = Quadric(BALL, low=-2, high=2), BilinearPatch()
    cut = Difference(quadric, Box())
    nodes = [place(mesh, at=(k, 0, 0)) for k in range(3)] + [place(g, at=(0, k, 0)) for k in range(3) for g in (quadric, patch, cut)]
    built = _flat(scene_of(*nodes))
    tables = built.tables
    n_uvs = 2 * 16
    assert (len(tables.attributes), len(tables.slots), len(tables.meshes)) == (n_uvs + 16 + 12, 3, 1)
    for row in tables.instances[tables.instances["kind"] == layouts.QUADRIC]:
        np.testing.assert_array_equal(tables.attributes[row["place"] : row["place"] + 16], [*np.array(BALL) / 2, -2, -2, -2, 2, 2, 2])
    for row in tables.instances[tables.instances["kind"] == layouts.PATCH]:
        np.testing.assert_array_equal(tables.attributes[row["place"] : row["place"] + 12], np.ravel(patch.corners))
    for row in tables.instances[tables.instances["kind"] == layouts.CSG]:
        assert tables.slots[row["place"] : row["place"] + row["n_program"]].tolist() == [0, 1, layouts.DIFFERENCE]
        assert tables.instances["kind"][row["leaf"] : row["leaf"] + row["n_leaves"]].tolist() == [layouts.QUADRIC, layouts.BOX]
    again = _flat(scene_of(*nodes), built).tables
    assert again.positions is tables.positions
    for mine, theirs in zip(again, tables, strict=True):
        assert mine.tobytes() == theirs.tobytes()


def test_rows_tell_contents_apart() -> None:
    """Whoever compares two tables' instances sees another quadric, patch or program, though it stands at the same place."""

    def rows(geometry: Primitive | Union | Difference) -> bytes:
        return _flat(scene_of(place(geometry))).tables.instances.tobytes()

    other = (*BALL[:9], -1.0000001)
    assert rows(Quadric(BALL)) != rows(Quadric(other))
    assert rows(Quadric(BALL)) == rows(Quadric(BALL))
    assert rows(BilinearPatch()) != rows(BilinearPatch(((0, 0, 0), (1, 0, 0), (1, 1, 1e-9), (0, 1, 0))))
    assert rows(Union(Sphere(), Box())) != rows(Difference(Sphere(), Box()))


def test_kernels_that_know_triangles_find_every_shape() -> None:
    """Tessellated, there are no leaves, every row has a mesh, and a combination is one."""
    scene = scene_of(place(Difference(Box(), Sphere(0.6)), RED), place(Cylinder(), BLUE))
    tables = flatten(scene, CAMERA, 64, 48).tables
    assert tables.instances["kind"].tolist() == [layouts.MESH, layouts.CYLINDER]
    assert (tables.instances["mesh"] >= 0).all()


def test_what_is_flattened_is_a_mesh() -> None:
    """No ray can be taken into the space of what has no thickness, nor back."""
    shapes = (Cylinder(), Torus(), Quadric(BALL), Difference(Box(), Sphere(0.6)))
    scene = Scene(Node(parent_from_node=scale(1, 0, 1), shapes=tuple(Shape(shape) for shape in shapes)))
    tables = _flat(scene).tables
    assert (tables.instances["kind"] == layouts.MESH).all()
    assert (tables.instances["mesh"] >= 0).all()


def test_the_boundary_of_a_combination_is_where_membership_changes() -> None:
    """Just inside each triangle is the whole, just outside it is not; areas and volumes are those of the formulas."""
    cut = Difference(Box(2.0), Sphere(1.2))
    tables = flatten(scene_of(place(cut, RED)), CAMERA, 640, 480).tables
    p = tables.positions[tables.triangles[: tables.meshes[0]["n_triangles"]]].astype(np.float64)
    middle = p.mean(axis=1)
    n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    area = np.linalg.norm(n, axis=1) / 2
    step = 0.001 * n / np.maximum(2 * area, 1e-30)[:, None]

    def whole(points: np.ndarray) -> np.ndarray:
        return inside(Box(2.0), points) & ~inside(Sphere(1.2), points)

    right = whole(middle - step) & ~whole(middle + step)
    assert area[~right].sum() < 0.01 * area.sum()
    # A face without its circle; the sphere without the six caps beyond the faces
    np.testing.assert_allclose(area.sum(), 6 * (4 - np.pi * 0.44) + 4 * np.pi * 1.44 - 6 * 2 * np.pi * 1.2 * 0.2, rtol=0.005)
    volume = np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6
    cap = np.pi * 0.04 * (3 * 1.2 - 0.2) / 3
    np.testing.assert_allclose(volume, 8 - (4 / 3 * np.pi * 1.2**3 - 6 * cap), rtol=0.01)


def test_a_surface_that_two_leaves_share_is_drawn_once() -> None:
    """Two boxes side by side, one on the other's face: no wall between them, no film, and no face twice."""
    for cut, expected in (
        (Union(Box(1.0), Solid(Box(1.0), translate(1, 0, 0))), 10.0),
        (Union(Box(1.0), Solid(Box(1.0), translate(0.5, 0, 0))), 2 + 4 * 1.5),
        (Difference(Box(1.0), Solid(Box(1.0), translate(0.5, 0, 0))), 2 + 4 * 0.5),
        (Intersection(Box(1.0), Box((1.0, 1.0, 3.0))), 6.0),
    ):
        tables = flatten(scene_of(place(cut, RED)), CAMERA, 64, 48).tables
        p = tables.positions[tables.triangles].astype(np.float64)
        area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum() / 2
        np.testing.assert_allclose(area, expected, rtol=1e-4)


def test_a_plane_and_what_has_no_end_are_drawn_where_they_can_be() -> None:
    """Half a ball has a flat face; the complement of a ball is the ball seen from inside."""
    half = Intersection(Sphere(1.0), Solid(Plane(), in_order(rotate((1, 0, 0), 0.3))))
    tables = flatten(scene_of(place(half, RED)), CAMERA, 640, 480).tables
    p = tables.positions[tables.triangles[: tables.meshes[0]["n_triangles"]]].astype(np.float64)
    area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum() / 2
    np.testing.assert_allclose(area, 3 * np.pi, rtol=0.005)
    tables = flatten(scene_of(place(Complement(Sphere()), RED)), CAMERA, 640, 480).tables
    p = tables.positions[tables.triangles[: tables.meshes[0]["n_triangles"]]].astype(np.float64)
    np.testing.assert_allclose(np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6, -4 / 3 * np.pi, rtol=0.01)
