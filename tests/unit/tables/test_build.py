"""From description to tables: ranges that fit, what is shared stored once, matrices that undo each other, planes that cut nothing off."""

from __future__ import annotations

import math

import numpy as np
import pytest
from staging import WHITE, checkers, grid, place, scene_of

from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.light import AmbientLight, SpotLight
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Shape, Sphere
from limner.tables import layouts
from limner.tables.build import build, names
from limner.tables.camera import camera_record, near_and_far, raster_from_world

CAMERA = PerspectiveCamera.look_at((3, 2, 5), (0, 0, 0))


def test_ranges_lie_within_the_arrays_they_point_to():
    shapes = [Sphere(), Box(), Plane(), grid(4, 1.0), primitives.sphere(1.0, 6)]
    tables = build(scene_of(*(place(shape) for shape in shapes), camera=CAMERA), CAMERA, 64, 48)
    assert tables.instances["kind"].tolist() == [layouts.SPHERE, layouts.BOX, layouts.PLANE, layouts.MESH, layouts.MESH]
    for mesh in tables.meshes:
        rows = tables.triangles[mesh["triangle"] : mesh["triangle"] + mesh["n_triangles"]]
        assert rows.min() == 0
        assert rows.max() == mesh["n_positions"] - 1
        assert mesh["position"] + mesh["n_positions"] <= len(tables.positions)
        for attribute, index, width in (("normal", "normal_triangle", 3), ("uv", "uv_triangle", 2)):
            if mesh[attribute] >= 0:
                start = mesh[index] if mesh[index] >= 0 else mesh["triangle"]
                used = tables.triangles[start : start + mesh["n_triangles"]]
                assert mesh[attribute] + width * (used.max() + 1) <= len(tables.attributes)


def test_what_is_shared_is_stored_once():
    """A mesh in many places, a texture on many materials, a material on many shapes."""
    mesh, picture = grid(5, 1.0), checkers(16)
    painted = [Lambert(texture=picture), MetallicRoughness(base_color_texture=picture)]
    scene = scene_of(*(place(mesh, painted[k % 2], at=(k, 0, 0)) for k in range(20)), camera=CAMERA)
    tables = build(scene, CAMERA, 64, 48)
    assert (len(tables.instances), len(tables.meshes), len(tables.positions)) == (20, 1, 25)
    assert (len(tables.materials), len(tables.textures)) == (2, 1)


def test_material_rows_follow_the_slots():
    """A shape's materials lie side by side, so that its triangles' slots count from the first; names come in the same order."""
    red, green, blue = (MetallicRoughness(base_color=c, name=n) for c, n in (((1, 0, 0), "red"), ((0, 1, 0), "green"), ((0, 0, 1), "blue")))
    base = grid(3, 1.0)
    mesh = type(base)(base.positions, base.triangles, triangle_materials=np.arange(8) % 2)
    scene = Scene(Node(shapes=(Shape(Box(), (blue,)), Shape(mesh, (green, red)), Shape(Box(), (green,)), Shape(mesh, (red, blue)))))
    tables = build(scene, CAMERA, 8, 8)
    colours = [tables.materials["color"][row["material"]].tolist() for row in tables.instances]
    assert colours == [[0, 0, 1], [0, 1, 0], [0, 1, 0], [1, 0, 0]]
    assert names(scene)["material_id"][tables.instances[1]["material"] + 1] == "red"
    assert len(names(scene)["material_id"]) == len(tables.materials)


def test_instances_of_any_transform():
    """Matrix times inverse is 1; what flattens keeps finite numbers; reflection is marked."""
    random = np.random.default_rng(1)
    matrices = [np.eye(4) for _ in range(20)]
    for matrix in matrices:
        matrix[:3] = random.normal(size=(3, 4))
    nodes = [place(Box(), matrix=m) for m in (*matrices, transform.scale(1, 0, 1), transform.scale(0))]
    table = build(scene_of(*nodes), CAMERA, 8, 8).instances
    for row, matrix in zip(table, matrices, strict=False):
        np.testing.assert_allclose(row["world_from_object"], matrix[:3], rtol=1e-6)
        np.testing.assert_allclose(row["object_from_world"], np.linalg.inv(matrix)[:3], rtol=1e-6)
        assert row["flipped"] == (np.linalg.det(matrix[:3, :3]) < 0)
    for field in ("object_from_world", "world_from_normal"):
        assert np.isfinite(table[field]).all()


def test_the_bounds_of_a_scene_are_not_asked_for_each_instance(monkeypatch: pytest.MonkeyPatch):
    """Bug: the bounds of the whole scene were computed anew for every instance. Now three instances ask as often as three hundred."""
    ball, random, asked = primitives.sphere(0.1, 4), np.random.default_rng(0), []
    bounds = Scene.bounds
    monkeypatch.setattr(Scene, "bounds", lambda self: (asked.append(1), bounds(self))[1])

    def times_asked(n: int) -> int:
        nodes = tuple(
            Node(parent_from_node=transform.translate(*random.normal(size=3)), shapes=(Shape(ball, (WHITE,)),)) for _ in range(n)
        )
        asked.clear()
        tables = build(Scene(Node(children=nodes), camera=CAMERA), CAMERA, 64, 48)
        assert (len(tables.instances), len(tables.meshes)) == (n, 1)
        return len(asked)

    assert times_asked(3) == times_asked(300) > 0


def test_hidden_nodes_hide_their_own_children_only():
    """Bug: a node of the same name as a hidden one lost its children."""
    leg = Node(name="leg", children=(Node(name="foot", shapes=(Shape(Box()),)),))
    hidden = Node(name="leg", children=leg.children, visible=False)
    scene = Scene(Node(name="body", children=(hidden, leg)))
    assert [placed.path for placed, _ in scene.shapes()] == ["body/leg#2/foot"]


PARALLEL = OrthographicCamera.look_at((3, 2, 5), (0, 0, 0), height=3.0)


@pytest.mark.parametrize("camera", [CAMERA, PARALLEL], ids=["perspective", "orthographic"])
def test_rays_and_vertices_meet_in_the_same_pixel(camera):
    """The ray through raster point (x, y), at depth t, goes to (x w, y w, t, w): the two ways the tables hold a camera."""
    width, height, near, far = 61, 37, 0.5, 40.0
    (row,) = camera_record(camera, width, height, near, far).astype(layouts.CAMERA)
    matrix = raster_from_world(camera, width, height, near, far)
    random = np.random.default_rng(3)
    x, y, t = random.uniform(-5, 65, 50), random.uniform(-5, 40, 50), random.uniform(0.5, 40, 50)
    across = row["corner"] + np.outer(x, row["dx"]) + np.outer(y, row["dy"])
    if row["kind"] == layouts.PERSPECTIVE:
        points = row["position"] + across * t[:, None]
    else:
        points = row["position"] + across + np.outer(t, row["gaze"])
    back = np.concatenate([points.astype(np.float64), np.ones((50, 1))], axis=1) @ matrix.T
    np.testing.assert_allclose(back[:, 0] / back[:, 3], x, atol=2e-3)
    np.testing.assert_allclose(back[:, 1] / back[:, 3], y, atol=2e-3)
    np.testing.assert_allclose(back[:, 2], t, rtol=1e-5)


def test_near_and_far_are_the_cameras_own_where_it_has_them():
    """Bug: a near plane beyond half the far plane was moved."""
    bounds = np.array([[-1.0] * 3, [1.0] * 3])
    assert near_and_far(PerspectiveCamera(near=1.0, far=1.5), bounds) == (1.0, 1.5)
    assert near_and_far(OrthographicCamera(near=1.0, far=1.5), bounds) == (1.0, 1.5)
    near, far = near_and_far(OrthographicCamera(near=100.0), bounds)
    assert near == 100.0
    assert far > near
    near, far = near_and_far(PerspectiveCamera(far=1e-9), bounds)
    assert 0.0 < near < far == 1e-9


def test_planes_from_the_bounds_cut_nothing_off():
    for scale in (1e-6, 1.0, 1e6):
        bounds = np.array([[-1.0] * 3, [1.0] * 3]) * scale
        for camera in (PerspectiveCamera.look_at((0, 0, 3 * scale), (0, 0, 0)), OrthographicCamera.look_at((0, 0, 3 * scale), (0, 0, 0))):
            near, far = near_and_far(camera, bounds)
            assert near < 2 * scale < 4 * scale < far
    assert near_and_far(PerspectiveCamera(), np.array([[np.inf] * 3, [-np.inf] * 3]))[0] > 0


def test_spot_cones_as_the_extension_has_them():
    """KHR_lights_punctual: scale = 1 / max(0.001, cos inner - cos outer), offset = -cos outer scale."""
    for inner, outer in ((0.0, 45.0), (20.0, 30.0), (29.999, 30.0), (0.0, 90.0)):
        spot = Node(lights=(SpotLight(inner_degrees=inner, outer_degrees=outer), AmbientLight()))
        lights = build(Scene(spot), CAMERA, 8, 8).lights
        light = lights[lights["kind"] == layouts.SPOT_LIGHT][0]
        cos_inner, cos_outer = math.cos(math.radians(inner)), math.cos(math.radians(outer))
        scale = 1 / max(0.001, cos_inner - cos_outer)
        assert (light["cone_scale"], light["cone_offset"]) == pytest.approx((scale, -cos_outer * scale), rel=1e-5)


def test_tables_are_aligned_and_contiguous():
    """What the doors insist on, whatever the scene holds."""
    for scene in (Scene(), scene_of(place(Sphere()), place(Plane()), camera=CAMERA)):
        for array in build(scene, CAMERA, 8, 8):
            assert array.flags.c_contiguous
            assert array.flags.writeable
