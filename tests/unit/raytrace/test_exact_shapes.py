"""What rays see of exact shapes and of combinations of solids, against closed forms: depth, holes, cuts, normals, names and shadows."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import SLOW_AS_PYTHON, lit_from, place, scene_of

from limner.image.image import Image
from limner.linear.transform import in_order, rotate, scale, translate
from limner.render import render
from limner.scene.camera import OrthographicCamera
from limner.scene.light import DirectionalLight
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.primitive import BilinearPatch, Box, Cone, Cylinder, Disk, Plane, Quadric, Sphere, Torus
from limner.scene.shape import Geometry
from limner.scene.solid import Complement, Difference, Intersection, Solid, Union

pytestmark = SLOW_AS_PYTHON
N = 129  # pixels a side, of 4 metres
STEP = 4.0 / N
RED, GREEN = Lambert((0.7, 0.1, 0.1), name="red"), Lambert((0.1, 0.6, 0.1), name="green")
ONE_SIDED = Lambert((0.5, 0.5, 0.5), double_sided=False)


def _seen(*nodes: Node, towards: tuple[float, float, float] = (0, 0, -1), **options: object) -> Image:
    """Along a direction, in parallel, from 10 metres away; up is +y, or -z for what is seen from above."""
    up = (0, 0, -1) if towards[1] != 0 else (0, 1, 0)
    eye = -10.0 * np.array(towards)
    camera = OrthographicCamera.look_at(eye, (0, 0, 0), up=up, height=4.0, near=0.001, far=100.0)
    aovs = ("depth", "normal", "normal_geometric", "position", "uv", "instance_id", "material_id")
    return render(scene_of(*nodes, camera=camera), width=N, height=N, renderer="ray", samples=1, aovs=aovs, **options)


def _across() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """x to the right and y up of the pixels' centres."""
    side = (np.arange(N) - (N - 1) / 2) * STEP
    x, y = np.meshgrid(side, -side)
    return x, y


def test_a_cylinder_seen_from_the_side() -> None:
    """A rectangle as wide as twice its radius, as near as a circle is round; u is the angle around, v the height."""
    image, (x, y) = _seen(place(Cylinder(0.9, 1.9))), _across()
    inside = (np.abs(x) < 0.9) & (np.abs(y) < 0.95)
    np.testing.assert_array_equal(image.aov["instance_id"] == 0, inside)
    z = np.sqrt(np.where(inside, 0.81 - x * x, 0.0))
    np.testing.assert_allclose(image.aov["depth"][inside], (10 - z)[inside], rtol=1e-6)
    np.testing.assert_allclose(image.aov["normal"][inside], np.stack([x, 0 * x, z], axis=-1)[inside] / 0.9, atol=2e-6)
    u, v = 0.5 + np.arctan2(-z, x) / (2 * np.pi), 0.5 + y / 1.9
    np.testing.assert_allclose(image.aov["uv"][inside], np.stack([u, v], axis=-1)[inside], atol=2e-6)


def test_a_cone_seen_from_the_side_and_from_below() -> None:
    """A triangle; half of it is one slope. From below there is only its cap."""
    image, (x, y) = _seen(place(Cone(1.2, 2.0))), _across()
    width = 1.2 * (0.5 - y / 2.0)
    inside = (np.abs(x) < width) & (np.abs(y) < 1)
    np.testing.assert_array_equal(image.aov["instance_id"] == 0, inside)
    z = np.sqrt(np.where(inside, width**2 - x * x, 0.0))
    np.testing.assert_allclose(image.aov["depth"][inside], (10 - z)[inside], rtol=1e-6)
    np.testing.assert_allclose(image.aov["normal"][inside][:, 1], 0.6 / np.hypot(1, 0.6), rtol=1e-5)
    below = _seen(place(Cone(1.2, 2.0)), towards=(0, 1, 0))
    np.testing.assert_array_equal(below.aov["normal"][below.aov["instance_id"] == 0], [[0, -1, 0]] * int((x * x + y * y < 1.44).sum()))
    np.testing.assert_array_equal(below.aov["depth"][below.aov["instance_id"] == 0], np.float32(9))


def test_a_torus_has_a_hole() -> None:
    """Seen along its axis: a ring between R - r and R + r, over which it rises as a circle does."""
    image, (x, y) = _seen(place(Torus(1.2, 0.5)), towards=(0, -1, 0)), _across()
    off = np.hypot(x, y) - 1.2
    inside = np.abs(off) < 0.5
    np.testing.assert_array_equal(image.aov["instance_id"] == 0, inside)
    height = np.sqrt(np.where(inside, 0.25 - off * off, 0.0))
    np.testing.assert_allclose(image.aov["depth"][inside], (10 - height)[inside], rtol=2e-6)
    np.testing.assert_allclose(image.aov["normal"][inside][:, 1], height[inside] / 0.5, atol=1e-5)
    np.testing.assert_allclose(image.aov["uv"][inside][:, 1], (0.5 + np.arctan2(height, off) / (2 * np.pi))[inside], atol=1e-5)


def test_a_disk_a_patch_and_a_quadric() -> None:
    """From above: a circle, a twisted sheet y = x z by its corners, and the paraboloid y = x^2 + z^2 - 1, cut off at y = 0.44."""
    x, y = _across()
    disk = _seen(place(Disk(1.1)), towards=(0, -1, 0))
    np.testing.assert_array_equal(disk.aov["instance_id"] == 0, np.hypot(x, y) < 1.1)
    patch = BilinearPatch(((-1, -1, 1), (1, 1, 1), (1, -1, -1), (-1, 1, -1)))
    image = _seen(place(patch), towards=(0, -1, 0))
    inside = (np.abs(x) < 1) & (np.abs(y) < 1)
    np.testing.assert_array_equal(image.aov["instance_id"] == 0, inside)
    np.testing.assert_allclose(image.aov["depth"][inside], (10 + x * y)[inside], rtol=1e-6)
    np.testing.assert_allclose(image.aov["uv"][inside], np.stack([0.5 + x / 2, 0.5 + y / 2], axis=-1)[inside], atol=1e-6)
    bowl = Quadric((1, 0, 1, 0, 0, 0, 0, -1, 0, -1), low=(-1.5, -1, -1.5), high=(1.5, 0.44, 1.5), capped=False)
    image = _seen(place(bowl), towards=(0, -1, 0))
    inside = x * x + y * y < 1.44
    np.testing.assert_array_equal(image.aov["instance_id"] == 0, inside)
    np.testing.assert_allclose(image.aov["depth"][inside], (11 - x * x - y * y)[inside], rtol=1e-6)


@pytest.mark.parametrize("half_height", [0.5, 0.9])
def test_the_napkin_ring_s_volume_depends_on_its_height_alone(half_height: float) -> None:
    """A ball with a hole along its axis: pi h^3 / 6, whatever the ball; measured between two pictures, from above and from below."""
    for radius in (1.0, 1.4, 1.8):
        ring = Difference(Sphere(radius), Cylinder(np.sqrt(radius**2 - half_height**2), 4.0))
        top, bottom = (_seen(place(ring), towards=(0, way, 0)).aov["depth"] for way in (-1, 1))
        seen = np.isfinite(top)
        np.testing.assert_array_equal(seen, np.isfinite(bottom[::-1]))
        thickness = 20.0 - top[seen].astype(np.float64) - bottom[::-1][seen]
        volume = thickness.sum() * STEP**2
        assert abs(volume - np.pi * (2 * half_height) ** 3 / 6) < 0.02 * np.pi * (2 * half_height) ** 3 / 6


def test_a_cut_has_the_surface_of_what_cut_it_turned_inside_out() -> None:
    """A box without a ball: in the bowl the normals point to the ball's middle, out of what is left, and so does what is lit."""
    cut = Difference(Box(2.0), Solid(Sphere(0.8), translate(0, 0, 1.0), material=GREEN))
    image, (x, y) = _seen(place(cut, RED), lit_from((0, 0, 1))), _across()
    bowl = x * x + y * y < 0.64
    box = (np.abs(x) < 1) & (np.abs(y) < 1)
    np.testing.assert_array_equal(image.aov["instance_id"] == 0, box)
    assert (image.id_names["material_id"][0], image.id_names["material_id"][1]) == ("red", "green")
    np.testing.assert_array_equal(image.aov["material_id"][box], np.where(bowl, 1, 0)[box])
    expected = np.array([0, 0, 1]) - image.aov["position"][bowl]
    np.testing.assert_allclose(np.linalg.norm(expected, axis=-1), 0.8, rtol=1e-6)
    np.testing.assert_allclose(image.aov["normal_geometric"][bowl], expected / 0.8, atol=1e-6)
    # Lambert by the turned normal: 0.6 cos, and no shadow of its own
    np.testing.assert_allclose(image.pixels[bowl][:, 1], 0.6 * expected[:, 2] / 0.8, rtol=1e-4)


def test_one_sided_solids_show_their_outside_only() -> None:
    """A ray that begins inside a one-sided combination meets nothing of it; a two-sided one closes all around."""
    for material, expected in ((ONE_SIDED, -1), (RED, 0)):
        aside = Difference(Sphere(20.0), Solid(Sphere(1.0), translate(0, 9, 0)))
        for shape in (aside, Union(Sphere(15.0), Box(16.0)), Cylinder(15.0, 30.0), Torus(15.0, 14.0)):
            image = _seen(place(shape, material, at=(15, 0, 0) if isinstance(shape, Torus) else (0, 0, 3)))
            assert (image.aov["instance_id"] == expected).all()
    hole = Difference(Sphere(20.0), Sphere(12.0))
    assert (_seen(place(hole, ONE_SIDED)).aov["instance_id"] == 0).all()  # inside the hole is outside the solid
    assert (_seen(place(Complement(Sphere(12.0)), ONE_SIDED)).aov["instance_id"] == 0).all()


def test_ids_name_the_shape_and_not_its_parts() -> None:
    """Between others in the graph, each combination keeps its one number, and the parts' materials theirs."""
    ball = Difference(Sphere(0.5), Solid(Cylinder(0.2, 2.0), material=GREEN))
    nodes = [
        Node("first", parent_from_node=translate(-1.2, 0, 0), shapes=place(ball, RED).shapes),
        Node("middle", shapes=place(Box(0.5), RED).shapes),
        Node("last", parent_from_node=translate(1.2, 0, 0), shapes=place(Union(ball, Box(0.3)), GREEN).shapes),
    ]
    image = _seen(*nodes, towards=(0, -1, 0))
    assert [name.rpartition("/")[2] for name in image.id_names["instance_id"]] == ["first", "middle", "last"]
    x, _ = _across()
    ids = image.aov["instance_id"]
    assert set(ids[x < -0.6]) == {-1, 0}
    assert set(ids[np.abs(x) < 0.5]) == {-1, 1}
    assert set(ids[x > 0.6]) == {-1, 2}


@pytest.mark.parametrize("mirrored", [1.0, -1.0])
def test_scales_and_mirrors_move_the_surface_and_keep_normals_outside(mirrored: float) -> None:
    """A unit cylinder stretched and mirrored is an elliptic one; so is one that a combination has in a part."""
    matrix = scale(1.5 * mirrored, 0.5, 0.6)
    x, y = _across()
    inside = (np.abs(x) < 1.5) & (np.abs(y) < 0.5)
    z = 0.6 * np.sqrt(np.where(inside, 1 - (x / 1.5) ** 2, 0.0))
    n = np.stack([x / 1.5**2, 0 * x, z / 0.36], axis=-1)
    n /= np.maximum(np.linalg.norm(n, axis=-1, keepdims=True), 1e-9)
    for node in (place(Cylinder(1.0, 2.0), matrix=matrix), place(Union(Solid(Cylinder(1.0, 2.0), matrix), Sphere(0.1)))):
        image = _seen(node)
        np.testing.assert_array_equal(image.aov["instance_id"] == 0, inside)
        np.testing.assert_allclose(image.aov["depth"][inside], (10 - z)[inside], rtol=1e-6)
        np.testing.assert_allclose(image.aov["normal_geometric"][inside], n[inside], atol=1e-5)


@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_worlds_of_any_size_look_the_same(size: float) -> None:
    """A combination a thousandth as large, or a thousand times: the same picture, without specks of its own shadow."""
    ring = Solid(Torus(0.9, 0.2), rotate((1, 0, 0), 0.5), material=GREEN)
    cut = Difference(Intersection(Box(1.5), Sphere(1.0)), Cylinder(0.4, 3.0), ring)

    def picture(s: float) -> NDArray[np.float32]:
        camera = OrthographicCamera.look_at((4 * s, 5 * s, 6 * s), (0, 0, 0), height=3.0 * s)
        node = place(cut, RED, matrix=in_order(rotate((0, 1, 0), 0.3), scale(s)))
        sun = Node(parent_from_node=lit_from((0.3, 1.0, 0.5)).parent_from_node, lights=(DirectionalLight(intensity=np.pi),))
        return render(scene_of(node, sun, camera=camera), width=N, height=N, renderer="ray", samples=1).pixels

    differs = np.abs(picture(1.0) - picture(size)).max(axis=-1) > 0.01
    assert differs.mean() < 0.005


SHADOWS = {
    "disk": (Disk(1.1), lambda x, z: np.hypot(x, z) < 1.1),
    "cylinder": (Cylinder(0.8, 1.0), lambda x, z: np.hypot(x, z) < 0.8),
    "cone": (Cone(0.4, 1.0, 1.2), lambda x, z: np.hypot(x, z) < 1.2),
    "torus": (Torus(1.0, 0.3), lambda x, z: np.abs(np.hypot(x, z) - 1.0) < 0.3),
    "quadric": (Quadric((4, 1, 1, 0, 0, 0, 0, 0, 0, -1), low=-1, high=1), lambda x, z: 4 * x * x + z * z < 1),
    "patch": (BilinearPatch(((-1, 0, 1), (1, 0.3, 1), (1, 0, -1), (-1, 0.3, -1))), lambda x, z: np.maximum(np.abs(x), np.abs(z)) < 1),
    "frame": (Difference(Box((2, 0.4, 2)), Box(1.2)), lambda x, z: np.abs(np.maximum(np.abs(x), np.abs(z)) - 0.8) < 0.2),
    "lens": (
        Intersection(Solid(Sphere(1.0), translate(0.5, 0, 0)), Solid(Sphere(1.0), translate(-0.5, 0, 0))),
        lambda x, z: np.hypot(np.abs(x) + 0.5, z) < 1,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SHADOWS)
def test_shadows_have_the_shape_of_what_throws_them(name: str) -> None:
    """The sun straight above, the camera between the shape and the ground: dark where the shape is, lit everywhere else."""
    geometry: Geometry = SHADOWS[name][0]
    x, y = _across()
    image = _seen(place(Plane(), Lambert((1, 1, 1))), place(geometry, RED, at=(0, 12, 0)), lit_from((0, 1, 0)), towards=(0, -1, 0))
    np.testing.assert_array_equal(image.aov["instance_id"], 0)
    dark = SHADOWS[name][1](x, -y)
    np.testing.assert_array_equal(image.pixels[..., 0] < 0.5, dark)
    assert set(np.unique(image.pixels[..., 0]).round(5)) == {0.0, 1.0}
