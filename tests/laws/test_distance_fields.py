"""Fields of distances in scenes (FoCG 22): what holds of all pictures of them, whoever draws them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from casting import cast
from fields import FIELDS
from staging import SLOW_AS_PYTHON, interior, lit_from, place, scene_of

from limner.linear.transform import in_order, rotate, scale, translate
from limner.render import Renderer, render
from limner.scene import distance
from limner.scene.camera import PerspectiveCamera
from limner.scene.digest import scene_digest
from limner.scene.light import AmbientLight
from limner.scene.material import Dielectric, Lambert
from limner.scene.motion import Motion
from limner.scene.node import Node
from limner.scene.primitive import Plane, Sphere
from limner.scene.scene import Scene
from limner.scene.shape import DistanceField, Shape

CAMERA = PerspectiveCamera.look_at((1.2, 1.9, 3.2), (0, 0, 0), yfov_degrees=40)
WHITE = Lambert((0.8, 0.8, 0.8))


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", ["smooth union", "difference", "twisted", "gyroid in a ball", "empty"])
def test_triangles_stand_for_the_field(name: str) -> None:
    """Raster and rays see the same surface away from its edges: ids, depth, normal, texture coordinates."""
    field = FIELDS["ball"].offset(-2.0) & distance.Box(1.0) if name == "empty" else FIELDS[name]
    scene = scene_of(place(DistanceField(field), WHITE, matrix=in_order(scale(1.1, 1, 0.9), rotate((0.3, 1, 0.1), 0.4))), camera=CAMERA)
    aovs = ("instance_id", "depth", "normal", "uv")
    raster, ray = (render(scene, width=120, height=90, renderer=kind, shadows=False, samples=1, aovs=aovs) for kind in ("raster", "ray"))
    both = interior(raster.aov["instance_id"]) & interior(ray.aov["instance_id"])
    np.testing.assert_array_equal(raster.aov["instance_id"][both], ray.aov["instance_id"][both])
    seen = both & (ray.aov["instance_id"] == 0)
    if name == "empty":
        assert not seen.any()
        return
    assert seen.sum() > 1000
    depth, uv = (np.abs(raster.aov[channel][seen] - ray.aov[channel][seen]) for channel in ("depth", "uv"))
    cosine = (raster.aov["normal"] * ray.aov["normal"]).sum(axis=-1)[seen]
    # A crease is cut off by the width of a cube.
    assert np.quantile(depth, 0.93) < 0.01
    assert np.quantile(cosine, 0.08) > 0.98
    assert np.quantile(uv.max(axis=-1), 0.9) < 0.02


@SLOW_AS_PYTHON
def test_the_tree_finds_what_the_list_finds() -> None:
    """The same t to the bit, and shadows where something is met, among all fields in random places."""
    random = np.random.default_rng(5)
    nodes = [
        place(DistanceField(field), WHITE, matrix=in_order(rotate(random.normal(size=3), 1.0), translate(*random.normal(size=3) * 3)))
        for field in FIELDS.values()
    ]
    o = random.normal(size=(1500, 3)) * 6
    d = random.normal(size=(1500, 3)) * 3 - o
    tree, everything = (cast(scene_of(*nodes), o, d, kind) for kind in ("bvh", "linear"))
    np.testing.assert_array_equal(tree.t, everything.t)
    np.testing.assert_array_equal(tree.occluded, everything.occluded)
    assert tree.occluded[np.isfinite(tree.t)].all()
    assert np.isfinite(tree.t).mean() > 0.3


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", ["ball", "rounded block", "ellipsoid", "smooth intersection"])
def test_what_is_convex_shows_its_albedo(name: str) -> None:
    """White light from all around: paths leave the surface everywhere, and never meet it again."""
    ambient = Node(lights=(AmbientLight(intensity=1.0),))
    scene = scene_of(place(DistanceField(FIELDS[name]), Lambert((0.5, 0.5, 0.5))), ambient, camera=CAMERA)
    image = render(scene, width=48, height=36, renderer="path", samples=4, aovs=("instance_id",))
    shown = image.pixels[interior(image.aov["instance_id"]) & (image.aov["instance_id"] == 0), :3]
    assert len(shown) > 100
    np.testing.assert_allclose(shown, 0.5, rtol=1e-5)


def _alike(node: Any, other: Any, **options: Any) -> float:
    """The share of pixels in which pictures of two nodes on a ground differ by more than a little."""
    ground = place(Plane(), WHITE, at=(0, -1.0, 0))
    pictures = [
        render(scene_of(shown, ground, lit_from((0.5, 1.0, 0.8)), camera=CAMERA), width=64, height=48, **options).pixels
        for shown in (node, other)
    ]
    return float((np.abs(pictures[0] - pictures[1]).max(axis=-1) > 0.02).mean())


@SLOW_AS_PYTHON
@pytest.mark.parametrize("renderer", ["ray", "path"])
def test_a_ball_of_glass_is_a_ball_of_glass(renderer: str) -> None:
    """Light enters and leaves a field as it does an exact sphere: refraction, reflection inside, tinted shadows."""
    glass = Dielectric(ior=1.5, absorption=(0.3, 0.1, 0.5))
    nodes = (place(DistanceField(distance.Sphere(0.9)), glass), place(Sphere(0.9), glass))
    assert _alike(*nodes, renderer=renderer, samples=4, max_depth=6) < 0.01


@SLOW_AS_PYTHON
def test_a_field_moves_as_a_sphere_does() -> None:
    """Through an open shutter, with its shadow."""

    def moving(geometry: Any) -> Node:
        motion = Motion((0.0, 1.0), np.stack([translate(-0.5, 0, 0), translate(0.5, 0.3, 0)]))
        return Node(motion=motion, shapes=(Shape(geometry, (WHITE,)),))

    nodes = moving(DistanceField(distance.Sphere(0.6))), moving(Sphere(0.6))
    assert _alike(*nodes, renderer="ray", samples=8, shutter=(0.0, 1.0)) < 0.01


@SLOW_AS_PYTHON
def test_a_renderer_sees_that_a_field_changes() -> None:
    """Bug it prevents: a tree, or triangles, that are kept while a field changes one of its numbers."""

    def scene(radius: float) -> Scene:
        return scene_of(place(DistanceField(distance.Sphere(0.4) | distance.Torus(0.8, radius)), WHITE), camera=CAMERA)

    for renderer in ("ray", "raster"):
        options = {"width": 40, "height": 30, "samples": 1, "renderer": renderer}
        with Renderer(scene(0.1), **options) as kept:
            kept.render()
            kept.scene = scene(0.25)
            np.testing.assert_array_equal(kept.render().pixels, render(scene(0.25), **options).pixels)


def test_a_scene_of_another_field_has_another_digest() -> None:
    """Each number of each node counts, and the place of a part."""

    def digest(field: distance.Distance) -> str:
        return scene_digest(scene_of(place(DistanceField(field))))

    part = distance.Sphere(0.5)
    fields = [part, distance.Sphere(0.6), part.shell(0.1), part.translated(0, 0, 1), part | part.translated(1, 0, 0)]
    fields += [distance.Union(part, part.translated(1, 0, 0), radius=0.1), part.repeated(2.0, 2), part.repeated(2.0, 2, alternating=True)]
    assert len({digest(field) for field in fields}) == len(fields)
    assert digest(distance.Sphere(0.5)) == digest(part)


@SLOW_AS_PYTHON
def test_a_field_far_away_is_seen_as_near_by() -> None:
    """Ten thousand times as far and large, and a thousandth as large: the same picture, shadows on itself included."""
    field = DistanceField(distance.Union(distance.Sphere(0.6), distance.Box((1.8, 0.3, 0.3)), radius=0.2))
    pictures = []
    for size in (1.0, 1e4, 1e-3):
        camera = PerspectiveCamera.look_at(np.array([1.2, 1.9, 3.2]) * size, (0, 0, 0), yfov_degrees=40)
        scene = scene_of(place(field, WHITE, matrix=scale(size)), lit_from((0.9, 0.5, 0.2)), camera=camera)
        pictures.append(render(scene, width=48, height=36, renderer="ray", samples=2).pixels)
    for other in pictures[1:]:
        assert (np.abs(other - pictures[0]).max(axis=-1) > 0.01).mean() < 0.01
    assert math.isclose(float(pictures[0][..., 3].max()), 1.0)
