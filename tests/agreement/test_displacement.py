"""Displaced shapes: one surface for all renderers, whatever was seen before, and equal to what it should be."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from limner.errors import SceneError
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.render import Renderer, render
from limner.scene.camera import PerspectiveCamera
from limner.scene.displacement import Displacement
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.primitive import Box, Plane, Sphere, Torus
from limner.scene.procedural import Gradient, Noise
from limner.scene.shape import Geometry, Shape
from limner.scene.texture import AnyTexture, Texels, Texture
from limner.tables import layouts
from limner.tables.build import flatten
from limner.tables.heights import height_function
from tests.staging import WHITE, flat_picture, grid, interior, lit_from, place, scene_of, seen_by_both

CAMERA = PerspectiveCamera.look_at((0.4, 0.8, 4.0), (0, 0, 0), yfov_degrees=40)


def heights(values: object, **fields: object) -> Texture:
    """A texture of 8-bit heights, row 0 at the bottom."""
    grey = np.asarray(values, dtype=np.uint8)
    return Texture(Texels(np.repeat(grey[..., None], 4, axis=2), srgb=False), **fields)  # type: ignore[arg-type]


BUMPS = heights(np.random.default_rng(3).integers(0, 256, (8, 16)))
FLAT = heights([[255]])


def shown(geometry: Geometry, displacement: Displacement | None, name: str = "rock", matrix: object = None) -> Node:
    return Node(name, np.eye(4) if matrix is None else matrix, shapes=(Shape(geometry, (WHITE,), displacement=displacement),))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "geometry", [Sphere(1.0), Torus(0.8, 0.3), Box((1.2, 1.0, 0.8)), primitives.sphere(1.0, 6)], ids=["sphere", "torus", "box", "mesh"]
)
def test_raster_and_ray_see_one_surface(geometry: Geometry) -> None:
    """The same triangles at the same depth, pixel for pixel away from edges."""
    scene = scene_of(shown(geometry, Displacement(BUMPS, 0.3, 0.5, edge_pixels=6.0)), camera=CAMERA)
    raster, ray = seen_by_both(scene)
    inside = interior(raster.aov["triangle_id"]) & interior(ray.aov["triangle_id"])
    hit = np.isfinite(raster.aov["depth"]) & np.isfinite(ray.aov["depth"])
    assert hit.sum() > 800
    assert (raster.aov["triangle_id"] == ray.aov["triangle_id"])[hit].mean() > 0.99
    np.testing.assert_allclose(raster.aov["depth"][inside], ray.aov["depth"][inside], rtol=1e-5)
    np.testing.assert_allclose(raster.aov["depth"][hit], ray.aov["depth"][hit], atol=0.3)


def test_a_sphere_moved_by_a_constant_is_the_larger_exact_sphere() -> None:
    """Radius 0.7 + 0.3 against the exact sphere of radius 1 by rays: depths differ by less than its chords leave out."""
    moved = scene_of(shown(Sphere(0.7), Displacement(FLAT, 0.3, edge_pixels=2.0)), camera=CAMERA)
    exact = scene_of(shown(Sphere(1.0), None), camera=CAMERA)
    a, b = (render(s, width=96, height=72, renderer="ray", samples=1, aovs=("depth",)).aov["depth"] for s in (moved, exact))
    both = np.isfinite(a) & np.isfinite(b)
    assert both.sum() > 0.97 * np.isfinite(b).sum()
    near = both & (b < 3.6)
    np.testing.assert_allclose(a[near], b[near], atol=6e-3)


def test_a_ramp_has_the_depth_of_a_slope() -> None:
    """A plane lifted by u, seen from straight above: depth falls by scale from side to side, in every row."""
    ramp = heights(np.tile(np.arange(256), (2, 1)), wrap_u="clamp", wrap_v="clamp")
    plane = grid(2, 1.0, transform.rotate((1, 0, 0), math.pi / 2))
    scene = scene_of(shown(plane, Displacement(ramp, 0.4, edge_pixels=4.0)), camera=flat_picture(1.0))
    depth = render(scene, width=64, height=48, samples=1, aovs=("depth",)).aov["depth"]
    x = (np.arange(64) + 0.5) / 64 - 0.5
    # The point (x', z') of column x: x' = x (4 / 3) (1 - z'), and z' is 0.4 of its share of [-1, 1], in texels from centre to centre.
    share = 0.4 * (128.0 / 255.0)
    z = (0.2 + share * (4 / 3) * x) / (1.0 + share * (4 / 3) * x)
    np.testing.assert_allclose(depth, np.tile(1.0 - z, (48, 1)), atol=2e-3)


def test_what_was_seen_before_is_not_seen_in_a_picture() -> None:
    """A Renderer that went round makes, bit for bit, the picture of one that just came; on the way small steps made nothing new."""
    scene = scene_of(shown(Sphere(1.0), Displacement(BUMPS, 0.3, 0.5, edge_pixels=8.0)), camera=CAMERA)
    near = dataclasses.replace(CAMERA, world_from_camera=transform.translate(0.004, 0, 0) @ CAMERA.world_from_camera)
    far = PerspectiveCamera.look_at((6.0, 1.0, 4.0), (0, 0, 0), yfov_degrees=40)
    with Renderer(scene, width=48, height=36, samples=2) as renderer:
        first = renderer.render(CAMERA).pixels
        renderer.render(near)
        renderer.render(far)
        again = renderer.render(near).pixels
        assert (renderer.render(CAMERA).pixels == first).all()
    assert (render(scene.replace(camera=near), width=48, height=36, samples=2).pixels == again).all()


def test_the_picture_says_where_triangles_were_too_few() -> None:
    """The image's warnings name the node; with enough triangles there is none."""
    few = Displacement(BUMPS, 0.3, 0.5, max_triangles=200)
    scene = scene_of(shown(primitives.sphere(1.0, 6), few), camera=CAMERA)
    image = render(scene, width=32, height=24, samples=1)
    (said,) = [warning for warning in image.warnings if "displacement" in warning]
    assert said.startswith("the displacement of world/rock stops at ")
    assert "where 4 were asked for" in said
    enough = scene_of(shown(primitives.sphere(1.0, 6), Displacement(BUMPS, 0.3, 0.5)), camera=CAMERA)
    assert not any("displacement" in warning for warning in render(enough, width=32, height=24, samples=1).warnings)


def test_all_renderers_get_the_same_tables() -> None:
    """Displaced exact shapes are meshes also for rays, with the bits that the rasteriser gets."""
    scene = scene_of(shown(Box(1.0), Displacement(BUMPS, 0.2, edge_pixels=8.0)), camera=CAMERA)
    raster, ray = (flatten(scene, CAMERA, 96, 72, tessellate=tessellate).tables for tessellate in (True, False))
    assert ray.instances["kind"][0] == layouts.MESH
    for name in ("positions", "triangles", "attributes"):
        assert getattr(raster, name).tobytes() == getattr(ray, name).tobytes()


def test_edges_are_as_short_as_asked_where_they_are_seen() -> None:
    """A large plane to the horizon, not moved at all: no edge in the picture is longer than edge_pixels, but for the lens's stretch."""
    camera = PerspectiveCamera.look_at((0.0, 1.0, 0.0), (0.0, 0.3, -3.0), yfov_degrees=30)
    scene = scene_of(shown(grid(2, 20.0), Displacement(FLAT, 0.0, edge_pixels=8.0)), camera=camera)
    built = flatten(scene, camera, 160, 120)
    (mesh,) = built.meshes
    assert not built.notes
    eye = transform.transform_points(np.linalg.inv(np.asarray(camera.world_from_camera)), mesh.positions.astype(float))
    scale = 60.0 / math.tan(math.radians(15.0))
    picture = eye[:, :2] / np.maximum(-eye[:, 2:], 1e-6) * scale
    seen = (np.abs(picture) <= (80.0, 60.0)).all(axis=1) & (eye[:, 2] < 0.0)
    ends = np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    ends = ends[seen[ends].all(axis=1)]
    longest = np.linalg.norm(picture[ends[:, 0]] - picture[ends[:, 1]], axis=1).max()
    assert 3.0 < longest <= 8.0 * 1.15
    assert len(mesh.triangles) < 60_000


def test_a_camera_that_hardly_moves_finds_the_same_mesh() -> None:
    """The very same object for a step of a thousandth; another where the camera comes close."""
    node = shown(primitives.sphere(1.0, 6), Displacement(BUMPS, 0.3, edge_pixels=8.0), matrix=transform.rotate((0, 1, 0), 0.3))
    scene = scene_of(node, camera=CAMERA)
    first = flatten(scene, CAMERA, 96, 72)
    step = dataclasses.replace(CAMERA, world_from_camera=transform.translate(0.0, 0.001, 0.001) @ CAMERA.world_from_camera)
    second = flatten(scene, step, 96, 72, first)
    assert second.meshes[0] is first.meshes[0]
    close = PerspectiveCamera.look_at((0.0, 0.0, 1.8), (0, 0, 0), yfov_degrees=40)
    assert len(flatten(scene, close, 96, 72, second).meshes[0].triangles) > len(first.meshes[0].triangles)


def test_wrong_displacements_are_told() -> None:
    """One line each, with the node where it is known."""
    bare = dataclasses.replace(primitives.box((1.0, 1.0, 1.0)), uvs=None, uv_triangles=None)
    with pytest.raises(SceneError, match=r"needs texture coordinates, and the mesh has none.*\(world/rock\)"):
        flatten(scene_of(shown(bare, Displacement(BUMPS, 1.0)), camera=CAMERA), CAMERA, 8, 8)
    with pytest.raises(SceneError, match=r"uv_set is 1, and the mesh has only one set"):
        flatten(scene_of(shown(Sphere(), Displacement(heights([[0]], uv_set=1), 1.0)), camera=CAMERA), CAMERA, 8, 8)
    with pytest.raises(SceneError, match="not a plane without end"):
        shown(Plane(), Displacement(BUMPS, 1.0))
    with pytest.raises(SceneError, match=r"shape\.displacement must be a Displacement, got Texture"):
        shown(Sphere(), BUMPS)  # type: ignore[arg-type]
    for fields, said in (
        ({"height": 1.0}, "height must be a Texture or a pattern"),
        ({"scale": math.nan}, "scale must be finite"),
        ({"edge_pixels": 0.0}, "edge_pixels must be positive"),
        ({"max_triangles": 0}, "max_triangles must be an integer"),
    ):
        with pytest.raises(SceneError, match=said):
            Displacement(**{"height": BUMPS, "scale": 1.0, **fields})  # type: ignore[arg-type]


def test_bounds_and_framing_hold_what_is_moved() -> None:
    """A scene's bounds grow by how far its surface may move, and a camera that frames it leaves nothing out."""
    scene = scene_of(shown(Sphere(1.0), Displacement(FLAT, 0.5, edge_pixels=8.0)))
    np.testing.assert_allclose(scene.bounds(), [[-1.5] * 3, [1.5] * 3])
    alpha = render(scene, width=48, height=36, samples=1).pixels[..., 3]
    assert alpha.any()
    for border in (alpha[0], alpha[-1], alpha[:, 0], alpha[:, -1]):
        assert not border.any()


@pytest.mark.parametrize("renderer", ["raster", "ray"])
def test_a_mirrored_normal_map_bends_the_other_way(renderer: str) -> None:
    """A map that tilts normals along u, on a strip mirrored at x = 0: lit from the right, its right half is as bright as its left half
    lit from the left, and brighter than that half is now; the seam's vertices have one position and one normal, and two tangents.
    """
    tilted = Texture(Texels(np.full((1, 1, 4), (200, 128, 220, 255), dtype=np.uint8), srgb=False))
    strip = grid(3, 1.0, transform.rotate((1, 0, 0), math.pi / 2))
    mirrored = dataclasses.replace(
        strip, normals=np.tile(np.float32([0, 0, 1]), (9, 1)), uvs=np.abs(np.asarray(strip.uvs) - np.float32([0.5, 0.0]))
    )
    material = MetallicRoughness(metallic=0.0, roughness=1.0, normal_texture=tilted, double_sided=True)
    halves = []
    for x in (1.0, -1.0):
        scene = scene_of(place(mirrored, material), lit_from((x, 0.0, 1.0)), camera=flat_picture())
        row = render(scene, width=16, height=12, renderer=renderer, samples=1).pixels[6, :, 0]
        halves.append((float(row[3:6].mean()), float(row[10:13].mean())))
    (left, right), (left_again, right_again) = halves
    assert right > 1.3 * left
    assert right == pytest.approx(left_again, rel=1e-3)
    assert left == pytest.approx(right_again, rel=1e-3)


def test_lambert_is_still_what_it_was() -> None:
    """A shape without displacement is the very mesh that was given."""
    mesh = primitives.sphere(1.0, 4)
    assert flatten(scene_of(place(mesh, Lambert()), camera=CAMERA), CAMERA, 8, 8).meshes[0] is mesh


@pytest.mark.parametrize(
    "height",
    [
        Noise(scale=(2.0, 2.0, 2.0), octaves=1),
        Gradient(scale=(0.9, 1.0, 1.0)),
        dataclasses.replace(BUMPS, mapping="triplanar", filter="bilinear"),
    ],
    ids=["noise", "gradient", "triplanar"],
)
def test_heights_of_patterns_are_what_they_show(height: AnyTexture) -> None:
    """On a surface without texture coordinates: the red of what is seen, at every pixel's place, but for what its footprint blurs."""
    mesh = dataclasses.replace(grid(2, 2.0, transform.rotate((1, 0, 0), math.pi / 2)), uvs=None)
    scene = scene_of(place(mesh, Lambert((1.0, 1.0, 1.0), texture=height)), camera=flat_picture(0.5))
    image = render(scene, width=40, height=30, renderer="ray", samples=1, aovs=("position", "normal", "albedo"))
    points, normals = (image.aov[name].reshape(-1, 3).astype(np.float64) for name in ("position", "normal"))
    found = height_function(height, mesh, "")(np.zeros((len(points), 2)), points, normals)
    assert np.ptp(found) > 0.1
    np.testing.assert_allclose(found, image.aov["albedo"].reshape(-1, 3)[:, 0], atol=2e-3)


def test_a_solid_pattern_needs_no_texture_coordinates() -> None:
    """A sphere of bare triangles moved by noise of its place: each vertex is as far out as the noise says; the scene's bounds hold it."""
    ball = dataclasses.replace(primitives.sphere(1.0, 8), uvs=None, uv_triangles=None)
    noise = Noise(scale=(2.0, 2.0, 2.0), octaves=2, colors=((0.25, 0, 0), (0.75, 0, 0)))
    displacement = Displacement(noise, 0.4, midlevel=0.5, edge_pixels=8.0)
    assert displacement.reach == pytest.approx(0.1)
    scene = scene_of(shown(ball, displacement), camera=CAMERA)
    (mesh,) = flatten(scene, CAMERA, 48, 36).meshes
    out = np.linalg.norm(mesh.positions, axis=1)
    assert len(mesh.triangles) > len(ball.triangles)
    assert np.ptp(out) > 0.02
    low, high = scene.bounds()
    assert (mesh.positions >= low).all()
    assert (mesh.positions <= high).all()


@pytest.mark.parametrize("wrap", ["repeat", "mirror", "clamp"])
@pytest.mark.parametrize("filter", ["bilinear", "nearest"])
def test_heights_are_what_the_same_texture_shows(wrap: str, filter: str) -> None:
    """The host's lookup against the kernels', at the texture coordinates of every pixel, with a transform and beyond [0, 1]; sRGB too."""
    values = np.random.default_rng(6).integers(0, 256, (5, 7, 1), dtype=np.uint8)
    texels = Texels(np.concatenate([np.repeat(values, 3, axis=2), np.full_like(values, 255)], axis=2), srgb=wrap == "mirror")
    texture = Texture(texels, wrap_u=wrap, wrap_v=wrap, filter=filter, offset=(0.3, -0.2), scale=(2.1, 1.7), rotation=0.4)  # type: ignore[arg-type]
    mesh = grid(2, 2.0, transform.rotate((1, 0, 0), math.pi / 2))
    scene = scene_of(place(mesh, Lambert((1.0, 1.0, 1.0), texture=texture)), camera=flat_picture())
    image = render(scene, width=40, height=30, renderer="ray", samples=1, aovs=("uv", "albedo"))
    uvs = image.aov["uv"].reshape(-1, 2).astype(np.float64)
    found = height_function(texture, mesh, "")(uvs, np.zeros((len(uvs), 3)), np.zeros((len(uvs), 3)))
    off = np.abs(found - image.aov["albedo"].reshape(-1, 3)[:, 0])
    # Where the nearest texel changes, rounding may take the other one.
    assert np.quantile(off, 0.99 if filter == "nearest" else 1.0) < 2e-5


def test_frames_are_made_once_for_a_mesh() -> None:
    """A mesh under a normal map gets tangents, the same object in every picture; under none, or with its own, it is left alone."""
    flat = Texture(Texels(np.full((1, 1, 4), (128, 128, 255, 255), dtype=np.uint8), srgb=False))
    ball = primitives.sphere(1.0, 4)
    mapped = scene_of(place(ball, MetallicRoughness(normal_texture=flat)), camera=CAMERA)
    first = flatten(mapped, CAMERA, 8, 8).meshes[0]
    assert first.tangents is not None
    assert flatten(mapped, CAMERA, 8, 8).meshes[0] is first
    assert flatten(scene_of(place(first, MetallicRoughness(normal_texture=flat)), camera=CAMERA), CAMERA, 8, 8).meshes[0] is first
    moved = Shape(ball, (MetallicRoughness(normal_texture=flat),), displacement=Displacement(BUMPS, 0.1, edge_pixels=8.0))
    assert flatten(scene_of(Node(shapes=(moved,)), camera=CAMERA), CAMERA, 48, 36).meshes[0].tangents is not None
