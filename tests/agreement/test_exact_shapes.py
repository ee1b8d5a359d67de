"""All exact shapes and combinations of solids (FoCG 4.4, 13.3) in scenes: the tree against trying everything, rays against triangles."""

from __future__ import annotations

import numpy as np
import pytest
from casting import cast
from hypothesis import given, settings
from hypothesis import strategies as st
from staging import SLOW_AS_PYTHON, grid, interior, lit_from, place, scene_of

from limner.linear.transform import in_order, rotate, scale, translate
from limner.render import Renderer, render
from limner.scene.camera import PerspectiveCamera
from limner.scene.light import AmbientLight
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.primitive import BilinearPatch, Box, Cone, Cylinder, Disk, Plane, Quadric, Sphere, Torus
from limner.scene.scene import Scene
from limner.scene.shape import Geometry
from limner.scene.solid import Complement, Difference, Intersection, Solid, Union

TOWER = Quadric((1, -1, 1, 0, 0, 0, 0, 0, 0, -0.15), low=(-1, -0.8, -1), high=(1, 0.8, 1))
BENT = BilinearPatch(((-0.9, 0, 0.9), (0.9, 1.2, 0.9), (0.9, 0, -0.9), (-0.9, 1.2, -0.9)))
RED, BLUE = Lambert((0.7, 0.1, 0.1)), MetallicRoughness(base_color=(0.1, 0.1, 0.7), metallic=0.0, roughness=0.5)
DRILL = Cylinder(0.35, 3.0)

SHAPES: dict[str, Geometry] = {
    "disk": Disk(0.9),
    "cylinder": Cylinder(0.7, 1.6),
    "tube": Cylinder(0.7, 1.2, capped=False),
    "cone": Cone(0.9, 1.6),
    "open frustum": Cone(0.9, 1.2, 0.4, capped=False),
    "torus": Torus(0.75, 0.28),
    "tower": TOWER,
    "open saddle": Quadric((1, 0, -1, 0, 0, 0, 0, -1, 0, 0), low=-0.8, high=0.8, capped=False),
    "patch": BENT,
    "hollow box": Difference(Box(1.5), Solid(Sphere(0.95), material=RED)),
    "drilled": Difference(Intersection(Box(1.5), Sphere(1.0)), DRILL, Solid(DRILL, rotate((1, 0, 0), np.pi / 2), material=BLUE)),
    "union": Union(Solid(Sphere(0.6), translate(-0.3, 0, 0), material=BLUE), Solid(Sphere(0.6), translate(0.3, 0, 0)), Torus(0.7, 0.15)),
    "half torus": Intersection(Torus(0.75, 0.3), Solid(Plane(), rotate((0, 0, 1), 0.5))),
    "cut tower": Intersection(TOWER, Solid(Complement(Solid(Cone(0.5, 3.0), translate(0.2, 0.3, 0))), material=RED)),
}


def _scattered(seed: int) -> Scene:
    """All shapes in random poses, some reflected, some one-sided, beside meshes, spheres and planes."""
    random = np.random.default_rng(seed)
    nodes = []
    for k, geometry in enumerate(SHAPES.values()):
        sizes = random.uniform(0.4, 1.2, 3) * random.choice([-1.0, 1.0], 3)
        turned = rotate(random.normal(size=3), random.uniform(0, 6))
        material = (RED, BLUE, Lambert(alpha_mode="blend", alpha=0.5))[(seed + k) % 3]
        nodes.append(place(geometry, material, matrix=in_order(scale(*sizes), turned, translate(*random.normal(size=3) * 2))))
    nodes += [place(Complement(Sphere(9.0)), RED), place(Plane(), BLUE, at=(0, -4, 0)), place(Sphere(0.5), BLUE), place(grid(5, 1.0), BLUE)]
    return scene_of(*nodes)


def _rays(random: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    o = random.normal(size=(n, 3)) * random.choice([1.0, 4.0, 30.0], size=(n, 1))
    d = (random.normal(size=(n, 3)) * 2 - o) * 10.0 ** random.uniform(-2, 2, size=(n, 1))
    d[::5, random.integers(0, 3)] = 0.0
    return o, d


@SLOW_AS_PYTHON
@settings(max_examples=12)
@given(seed=st.integers(0, 10_000))
def test_the_tree_finds_what_the_list_finds(seed: int) -> None:
    """The same t to the bit, the same leaf of the same shape, the same part, and the same shadows."""
    scene = _scattered(seed)
    o, d = _rays(np.random.default_rng(seed), 1500)
    for t_min, t_max in ((0.0, np.inf), (0.5, 2.0)):
        tree, everything = (cast(scene, o, d, kind, t_min, t_max) for kind in ("bvh", "linear"))
        np.testing.assert_array_equal(tree.t, everything.t)
        np.testing.assert_array_equal(tree.occluded, everything.occluded)
        apart = tree.t != np.inf
        ties = (tree.instance != everything.instance) | (tree.triangle != everything.triangle)
        assert not (ties & ~apart).any()
        assert ties.mean() < 0.002  # two surfaces at the very same t


@SLOW_AS_PYTHON
def test_limits_and_shadows_are_of_one_mind() -> None:
    """What occludes without limits is what is hit by a ray that sees both sides; beyond the nearest hit lies another or nothing."""
    scene = _scattered(3)
    o, d = _rays(np.random.default_rng(4), 2000)
    hits = cast(scene, o, d)
    nearer = cast(scene, o, d, t_max=np.float32(1.0)).t
    np.testing.assert_array_equal(nearer, np.where(hits.t < 1.0, hits.t, np.inf))
    assert hits.occluded.mean() > 0.9  # from inside the great complement, something is always met


CAMERA = PerspectiveCamera.look_at((1.2, 1.9, 3.2), (0, 0, 0), yfov_degrees=40)


@SLOW_AS_PYTHON
@pytest.mark.parametrize("name", SHAPES)
def test_triangles_stand_for_the_exact_shape(name: str) -> None:
    """Raster and rays see the same surface of the same material away from its edges: depth, normal, texture coordinates, colour."""
    scene = scene_of(place(SHAPES[name], BLUE, matrix=in_order(scale(1.1, 1, 0.9), rotate((0.3, 1, 0.1), 0.4))), camera=CAMERA)
    aovs = ("instance_id", "material_id", "depth", "normal", "uv", "triangle_id")
    raster, ray = (
        render(scene, width=160, height=120, renderer=kind, shadows=False, samples=8, aovs=aovs) for kind in ("raster", "ray")
    )
    both = interior(raster.aov["material_id"]) & interior(ray.aov["material_id"])
    np.testing.assert_array_equal(raster.aov["instance_id"][both], ray.aov["instance_id"][both])
    assert (raster.aov["material_id"] != ray.aov["material_id"])[both].mean() < 0.002
    seen = both & (ray.aov["instance_id"] == 0) & (raster.aov["material_id"] == ray.aov["material_id"])
    assert seen.sum() > 150
    assert (ray.aov["triangle_id"] == -1).all()
    depth, uv = (np.abs(raster.aov[channel][seen] - ray.aov[channel][seen]) for channel in ("depth", "uv"))
    cosine = (raster.aov["normal"] * ray.aov["normal"]).sum(axis=-1)[seen]
    uv = uv.max(axis=-1)
    # Where one part of the shape hides another, or a seam or an edge runs, a few pixels see another place.
    assert np.quantile(depth, 0.94) < 0.015
    assert np.quantile(cosine, 0.06) > 0.995
    assert np.quantile(np.minimum(uv, np.abs(1 - uv)), 0.93) < 0.02
    difference = np.abs(raster.pixels - ray.pixels)[seen].max(axis=-1)
    assert np.quantile(difference, 0.93) < 0.02


@SLOW_AS_PYTHON
@pytest.mark.parametrize("renderer", ["ray", "path"])
def test_a_renderer_keeps_its_tree_only_while_shapes_are_the_same(renderer: str) -> None:
    """Bug it prevents: a tree that is kept while a quadric changes its numbers, or a combination its program, at the same place."""
    def scene(c: float, cut: type) -> Scene:
        quadric = Quadric((1, 1, 1, 0, 0, 0, 0, 0, 0, -c), low=-3, high=3)
        shapes = [place(quadric, RED, at=(-1.2, 0, 0)), place(cut(Box(1.0), Sphere(0.6)), BLUE, at=(1, 0, 0))]
        return scene_of(*shapes, camera=CAMERA.look_at((0, 1, 6), (0, 0, 0), yfov_degrees=35))

    options = {"width": 48, "height": 36, "samples": 2, "renderer": renderer}
    with Renderer(scene(0.3, Union), **options) as kept:
        kept.render()
        for now in (scene(1.4, Union), scene(1.4, Intersection), scene(0.3, Difference)):
            kept.scene = now
            np.testing.assert_array_equal(kept.render().pixels, render(now, **options).pixels)


@SLOW_AS_PYTHON
def test_threads_do_not_change_a_bit() -> None:
    """Each thread has its own place to count in."""
    scene = _scattered(8).replace(camera=PerspectiveCamera.look_at((0, 0, 7), (0, 0, 0)))
    one, four = (render(scene, width=64, height=48, renderer="ray", samples=2, threads=n, tile_size=8).pixels for n in (1, 4))
    np.testing.assert_array_equal(one, four)


@SLOW_AS_PYTHON
@pytest.mark.parametrize(
    "geometry", [Cylinder(0.8, 1.2), Cone(1.0, 1.4), TOWER, Intersection(Box(1.4), Sphere(0.95)), Intersection(Sphere(1.0), Plane())],
    ids=["cylinder", "cone", "not convex", "rounded box", "half ball"],
)  # fmt: skip
def test_paths_leave_a_surface_where_they_should(geometry: Geometry) -> None:
    """White light from all around: what is convex shows its albedo everywhere, to rounding; what is not, nowhere more than all light."""
    ambient = Node(lights=(AmbientLight(intensity=1.0),))
    scene = scene_of(place(geometry, Lambert((0.5, 0.5, 0.5))), ambient, camera=CAMERA)
    image = render(scene, width=64, height=48, renderer="path", samples=8, aovs=("instance_id",))
    shown = image.pixels[interior(image.aov["instance_id"]) & (image.aov["instance_id"] == 0), :3]
    assert len(shown) > 100
    if geometry is TOWER:
        assert 0.4 < shown.mean() < 0.7
    else:
        np.testing.assert_allclose(shown, 0.5, rtol=1e-5)


@SLOW_AS_PYTHON
def test_a_solid_lights_itself_as_its_mesh_does() -> None:
    """One picture by rays through the exact drilled ball, one of its triangles: shadows, insides of holes and colours alike."""
    sun = lit_from((0.5, 1.0, 0.8))
    shape = place(SHAPES["drilled"], BLUE, matrix=rotate((1, 0.2, 0), 0.5))
    exact = render(scene_of(shape, sun, camera=CAMERA), width=160, height=120, renderer="ray", samples=4)
    from limner.scene.shape import Shape
    from limner.tables.build import flatten

    (mesh,) = flatten(scene_of(shape, camera=CAMERA), CAMERA, 160, 120).meshes
    triangles = Node(parent_from_node=shape.parent_from_node, shapes=(Shape(mesh, (BLUE, BLUE)),))
    approximate = render(scene_of(triangles, sun, camera=CAMERA), width=160, height=120, renderer="ray", samples=4)
    difference = np.abs(exact.pixels - approximate.pixels).max(axis=-1)
    assert (difference > 0.05).mean() < 0.02
