"""The hierarchy finds what trying everything finds, to the last bit of t, on random scenes and on nasty ones."""

from __future__ import annotations

import numpy as np
import pytest
from casting import Hits, cast
from staging import grid, place, scene_of

from limner.accel import bvh
from limner.errors import UnsupportedError
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.raycaster import Kind, RayCaster
from limner.scene.camera import PerspectiveCamera
from limner.scene.material import Lambert, MetallicRoughness
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Sphere
from limner.tables.build import build

N_RAYS = 3000


def _random_mesh(random: np.random.Generator, n: int, size: float, spread: float = 1.0) -> Mesh:
    corners = random.normal(size=(n, 1, 3)) * spread + random.normal(size=(n, 3, 3)) * size
    return Mesh(corners.reshape(-1, 3).astype(np.float32), np.arange(3 * n, dtype=np.int32).reshape(-1, 3))


def _mixed(random: np.random.Generator) -> Scene:
    one_sided = MetallicRoughness()
    nodes = [place(_random_mesh(random, 150, 0.2), Lambert(), matrix=transform.rotate_x(k)) for k in range(3)]
    nodes += [place(Sphere(0.3), (Lambert(), one_sided)[k % 2], at=random.normal(size=3)) for k in range(12)]
    nodes += [place(Box((0.4, 0.2, 0.3)), one_sided, matrix=transform.translate(*random.normal(size=3))) for _ in range(6)]
    nodes += [place(Plane(), Lambert(), matrix=transform.translate(0, -2, 0) @ transform.rotate_z(0.2))]
    return scene_of(*nodes)


def _squashed(random: np.random.Generator) -> Scene:
    """Ellipsoids, mirrored, sheared; flattened to nothing."""
    shear = np.eye(4)
    shear[0, 1] = 0.8
    nodes = [
        place(Sphere(0.5), matrix=transform.translate(*random.normal(size=3)) @ transform.scale(*random.uniform(-2, 2, 3)))
        for _ in range(20)
    ]
    nodes += [place(primitives.sphere(0.5, 8), MetallicRoughness(), matrix=shear @ transform.scale(-1, 1, 1))]
    nodes += [place(Box(), matrix=transform.scale(1, 0, 1)), place(Sphere(), matrix=transform.scale(0))]
    return scene_of(*nodes)


def _degenerate(random: np.random.Generator) -> Scene:
    """Triangles without area, all at one point, in one plane, one upon the other."""
    one_point = np.zeros((30, 3), np.float32)
    same = np.tile(random.normal(size=(3, 3)), (40, 1)).astype(np.float32)
    line = np.outer(np.linspace(-1, 1, 60), (1.0, 1.0, 0.5)).astype(np.float32)
    flat = random.normal(size=(90, 3)).astype(np.float32) * (1, 0, 1)
    points = np.concatenate([one_point, same, line, flat.astype(np.float32)])
    return scene_of(place(Mesh(points, np.arange(len(points) - len(points) % 3, dtype=np.int32).reshape(-1, 3))))


def _long_list(random: np.random.Generator) -> Scene:
    """Triangles in a geometric series of places: the heuristic peels them off one by one."""
    x = 2.0 ** np.arange(-60, 60)
    corners = np.array([[0, 0, 0], [0.4, 0, 0.1], [0, 0.4, 0.1]]) * x[:, None, None]
    corners[..., 0] += x[:, None]
    return scene_of(place(Mesh(corners.reshape(-1, 3).astype(np.float32), np.arange(360, dtype=np.int32).reshape(-1, 3))))


def _tiny(random: np.random.Generator) -> Scene:
    """Numbers so small that differences between them are denormal."""
    return scene_of(place(_random_mesh(random, 60, 1e-39, 1e-38)))


SCENES = {f.__name__.strip("_"): f for f in (_mixed, _squashed, _degenerate, _long_list, _tiny)}


def _same(a: Hits, b: Hits, with_ties: bool = False) -> None:
    """Where two surfaces lie at the very same t, the order of the search says which one is found."""
    np.testing.assert_array_equal(a.t, b.t)
    np.testing.assert_array_equal(a.occluded, b.occluded)
    np.testing.assert_array_equal(a.instance >= 0, np.isfinite(a.t))
    if not with_ties:
        np.testing.assert_array_equal(a.instance, b.instance)
        np.testing.assert_array_equal(a.triangle, b.triangle)


@pytest.mark.parametrize("name", SCENES)
def test_hierarchy_finds_what_the_list_finds(name):
    random = np.random.default_rng(7)
    scene = SCENES[name](random)
    origins, directions = random.normal(size=(N_RAYS, 3)) * 2, random.normal(size=(N_RAYS, 3))
    directions[::3] = random.normal(size=directions[::3].shape) * 0.5 - origins[::3]
    hierarchy, every = (cast(scene, origins, directions, kind) for kind in ("bvh", "linear"))
    _same(hierarchy, every, with_ties=name in ("squashed", "degenerate"))
    if name == "mixed":
        assert 0.3 < (hierarchy.instance >= 0).mean() < 0.99


def _repeated(random: np.random.Generator) -> Scene:
    """One mesh turned, stretched, mirrored and laid over itself, of two materials; beside what stands alone."""
    ball, skins = primitives.sphere(0.3, 10), (MetallicRoughness(), MetallicRoughness(double_sided=True))
    places = np.eye(4) + np.zeros((40, 1, 1))
    places[:, :3, :3], places[:, :3, 3] = random.normal(size=(40, 3, 3)) * 0.7, random.normal(size=(40, 3)) * 1.5
    balls = [place(ball, skins[k % 2], matrix=matrix) for k, matrix in enumerate(places)]
    return scene_of(*balls, place(grid(5, 2.0), at=(0, -1, 0)), place(Sphere(0.4), at=(0.5, 1, 0)), place(Plane(), at=(0, -2, 0)))


def test_a_mesh_in_many_places_is_hit_as_its_copies_are():
    """A ray taken to the mesh's space meets the same triangles at the same t, up to rounding; so does one that looks for any hit."""
    random = np.random.default_rng(9)
    scene, origins, directions = _repeated(random), random.normal(size=(N_RAYS, 3)) * 3, random.normal(size=(N_RAYS, 3))
    directions[::2] = random.normal(size=directions[::2].shape) * 0.5 - origins[::2]
    shared, every = cast(scene, origins, directions, few_copies=0), cast(scene, origins, directions, "linear")
    assert ((every.instance >= 0) & (every.instance < 40)).mean() > 0.1
    np.testing.assert_array_equal(shared.instance, every.instance)
    np.testing.assert_array_equal(shared.triangle, every.triangle)
    np.testing.assert_array_equal(shared.occluded, every.occluded)
    met = np.isfinite(every.t)
    np.testing.assert_allclose(shared.t[met], every.t[met], rtol=2e-5, atol=2e-6)


def test_few_and_small_things_share_a_tree_too():
    """Less than a node is full of, alone and beside others, and a copy whose place is no number."""
    plate = primitives.sphere(0.5, 6)
    for n, extra in ((2, ()), (2, (place(Sphere(0.2), at=(0, 3, 0)),)), (9, ()), (5, (place(grid(3, 1.0), at=(0, -3, 0)),))):
        scene = scene_of(*(place(plate, at=(2.0 * k, 0, 0)) for k in range(n)), *extra)
        origins = np.stack([np.linspace(-0.4, 2.0 * n, 60), np.full(60, 0.05), np.full(60, 5.0)], axis=1)
        shared, every = (cast(scene, origins, (0, 0, -1) * np.ones((60, 1)), few_copies=few) for few in (0, 1 << 20))
        np.testing.assert_array_equal(shared.instance, every.instance)
        assert (every.instance >= 0).any()
    broken = transform.translate(1e300, 0, 0)
    hits = cast(scene_of(place(plate), place(plate, at=(2, 0, 0)), place(plate, matrix=broken)), (0.05, 0.03, 5), (0, 0, -1), few_copies=0)
    assert hits.instance[0] == 0


def test_memory_does_not_grow_with_the_copies():
    """A thousand places of a mesh of two thousand triangles: a tree of one mesh and a thousand boxes, not of two million triangles."""
    ball = primitives.sphere(0.5, 32)
    trees = []
    for n in (1, 1000):
        tables = build(scene_of(*(place(ball, at=(k % 32, 0, k // 32)) for k in range(n))), PerspectiveCamera(), 4, 4)
        tree = bvh.build(tables)
        trees.append(sum(part.nbytes for part in tree))
    assert trees[1] < trees[0] + 1000 * 512


def test_limits_of_the_ray_are_kept():
    """t_min < t < t_max, both excluded, in both searches."""
    random = np.random.default_rng(8)
    scene, origins, directions = _mixed(random), random.normal(size=(N_RAYS, 3)), random.normal(size=(N_RAYS, 3))
    free = cast(scene, origins, directions)
    for kind in ("bvh", "linear"):
        part = cast(scene, origins, directions, kind, t_min=0.3, t_max=0.9)
        found = np.isfinite(part.t)
        assert ((part.t[found] > 0.3) & (part.t[found] < 0.9)).all()
        sure = (free.t > 0.3) & (free.t < 0.9)
        np.testing.assert_array_equal(part.t[sure], free.t[sure])


def test_rays_along_axes_and_in_the_planes_of_boxes():
    """No direction component but one, origins on the very planes of the vertices: 0 times infinity must count as inside."""
    n = 17
    scene = scene_of(place(grid(n, 1.0)))
    x, z = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, 2 * n - 1), np.linspace(-1, 1, 2 * n - 1)))
    for sign in (1.0, -1.0):
        for zero in (0.0, -0.0):
            origins = np.stack([x, np.full_like(x, -sign), z], axis=1)
            for kind in ("bvh", "linear"):
                hits = cast(scene, origins, (np.array([[zero, sign, zero]]) * np.ones((len(x), 1))), kind)
                np.testing.assert_array_equal(hits.t, np.float32(1.0))
    walls = [place(Box((1, 1, 1)), at=(i, j, k)) for i in range(-2, 3) for j in range(-2, 3) for k in range(-2, 3)]
    side = np.arange(-2.5, 3.0, 0.5)
    a, b = (part.ravel() for part in np.meshgrid(side, side))
    for axis in range(3):
        origins, directions = np.zeros((len(a), 3)), np.zeros((len(a), 3))
        origins[:, axis], directions[:, axis] = -9.0, 1.0
        origins[:, (axis + 1) % 3], origins[:, (axis + 2) % 3] = a, b
        hierarchy, every = (cast(scene_of(*walls), origins, directions, kind) for kind in ("bvh", "linear"))
        _same(hierarchy, every, with_ties=True)
        np.testing.assert_array_equal(hierarchy.t, np.float32(6.5))


def test_no_ray_slips_through_a_closed_surface():
    """From inside a sphere of triangles every ray hits, at vertices and edges too."""
    mesh = primitives.sphere(1.0, 24)
    p = mesh.positions[mesh.triangles].astype(np.float64)
    weights = np.random.default_rng(3).dirichlet((0.3, 0.3, 0.3), size=len(p))
    weights[::4] = np.stack([weights[::4, 0], 1 - weights[::4, 0], 0 * weights[::4, 0]], axis=1)
    weights[1::4] = (1.0, 0.0, 0.0)
    targets = np.concatenate([np.einsum("nk,nkc->nc", weights, p), (p[:, 0] + p[:, 1]) / 2])
    for origin in ((0.0, 0.0, 0.0), (0.3, -0.2, 0.1)):
        hits = cast(scene_of(place(mesh)), origin, targets - origin)
        np.testing.assert_allclose(hits.t, 1.0, atol=2e-5)


def test_one_sided_surfaces_are_met_from_their_front_only():
    """Meshes, spheres and planes alike, also reflected; as occluders both sides count."""
    skin = MetallicRoughness()
    for reflect in (np.eye(4), transform.scale(-1, 1, 1), transform.scale(1, 1, -1)):
        for geometry in (Sphere(), primitives.sphere(), Box((2, 2, 2))):
            scene = scene_of(place(geometry, skin, matrix=reflect))
            outside = cast(scene, (0.01, 0.02, 5), (0, 0, -1))
            assert outside.instance[0] == 0
            assert outside.t[0] == pytest.approx(4.0, abs=0.02)
            inside = cast(scene, (0.01, 0.02, 0), (0, 0, -1))
            assert inside.instance[0] == -1
            assert inside.occluded[0]
        plane = scene_of(place(Plane(), skin, matrix=reflect))
        assert cast(plane, (0, 1, 0), (0, -1, 0)).instance[0] == 0
        assert cast(plane, (0, -1, 0), (0, 1, 0)).instance[0] == -1
        assert cast(plane, (0, -1, 0), (0, 1, 0)).occluded[0]


def test_only_opaque_surfaces_occlude():
    """Masked and blended ones are left to the caller, planes among them."""
    for geometry in (Plane(), Sphere(), grid(3, 2.0)):
        for mode, expected in (("opaque", True), ("mask", False), ("blend", False)):
            scene = scene_of(place(geometry, Lambert(alpha_mode=mode)))
            assert cast(scene, (0.1, 3, 0.2), (0, -1, 0)).occluded[0] == expected


def test_an_empty_scene_is_hit_by_nothing():
    for scene in (Scene(), scene_of(place(Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32))))):
        hits = cast(scene, (0, 0, 0), (0, 0, -1))
        assert np.isinf(hits.t[0])
        assert not hits.occluded[0]


def test_unknown_accelerators_are_refused():
    with pytest.raises(UnsupportedError, match=r'must be "bvh" or "linear", got "?\'?octree'):
        bvh.build(build(Scene(), PerspectiveCamera(), 4, 4), "octree")


# --- the ray caster's structures, over triangles ---------------------------------------------------------------------------


def _soup(random: np.random.Generator, n: int, size: float, spread: float = 1.0) -> np.ndarray:
    return random.normal(size=(n, 1, 3)) * spread + random.normal(size=(n, 3, 3)) * size


def _one_upon_the_other(random: np.random.Generator) -> np.ndarray:
    """Points, lines, a pile of equal ones, all in one plane."""
    line = np.outer(np.linspace(-1, 1, 60), (1.0, 1.0, 0.5)).reshape(-1, 3, 3)
    flat = _soup(random, 60, 0.4) * (1, 0, 1)
    return np.concatenate([np.zeros((10, 3, 3)), np.tile(_soup(random, 1, 1.0), (40, 1, 1)), line, flat])


def _in_a_stadium(random: np.random.Generator) -> np.ndarray:
    """A heap of little ones in the middle of a few that are a thousand times as large."""
    return np.concatenate([_soup(random, 400, 0.02, 0.1), _soup(random, 30, 60.0, 90.0)])


def _in_a_series(random: np.random.Generator) -> np.ndarray:
    x = 2.0 ** np.arange(-30, 30)
    corners = np.array([[0, 0, 0], [0.4, 0, 0.1], [0, 0.4, 0.1]]) * x[:, None, None]
    corners[..., 0] += x[:, None]
    return corners


def _walls(random: np.random.Generator) -> np.ndarray:
    """Every side of a block of boxes: what lies in the planes that cut space."""
    boxes = [primitives.box((1, 1, 1)) for _ in range(27)]
    at = np.stack(np.meshgrid(*[np.arange(-1.0, 2.0)] * 3), axis=-1).reshape(-1, 3)
    return np.concatenate([box.positions[box.triangles] + place for box, place in zip(boxes, at, strict=True)])


def _needles(random: np.random.Generator) -> np.ndarray:
    """Long and thin, aslant through everything."""
    a = random.normal(size=(300, 1, 3)) * 2
    return np.concatenate([a, -a + random.normal(size=a.shape), a + 1e-3 * random.normal(size=a.shape)], axis=1)


HEAPS = {
    f.__name__.strip("_"): f for f in (_one_upon_the_other, _in_a_stadium, _in_a_series, _walls, _needles)
}  # fmt: skip
STRUCTURES: tuple[Kind, ...] = ("bvh", "grid", "bsp", "volume_tree")


def _rays_at(corners: np.ndarray, random: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """From anywhere towards points, edges and vertices of the triangles; along axes, within the planes of their vertices; anywhere."""
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    weights = random.dirichlet((0.4, 0.4, 0.4), size=n)
    weights[::4] = np.eye(3)[random.integers(3, size=len(weights[::4]))]
    targets = np.einsum("nk,nkc->nc", weights, corners[random.integers(len(corners), size=n)])
    origins = random.uniform(2 * low - high, 2 * high - low, (n, 3))
    directions = targets - origins
    axes = np.eye(3)[random.integers(3, size=len(directions[1::3]))] * random.choice([-1.0, 1.0], size=(len(directions[1::3]), 1))
    origins[1::3] = targets[1::3] - 3 * axes * np.linalg.norm(high - low)
    directions[1::3] = axes
    directions[2::9] *= (1, 0, 1)
    directions[5::9] *= (0, 1, -1)
    return origins, directions


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("name", HEAPS)
def test_all_structures_find_what_the_list_finds(name, scale):
    """BVH = grid = BSP = volume tree = list, t to the last bit; all but the BVH also which of several triangles at one t."""
    random = np.random.default_rng(11)
    corners = HEAPS[name](random) * scale
    points, triangles = corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)
    origins, directions = _rays_at(corners, random, N_RAYS)
    every = RayCaster(points, triangles, accelerator="linear")
    expected = every.intersect(origins, directions)
    # Ends of rays a little before, at, and a little behind the hit.
    ends = np.where(expected.hit, expected.t * random.choice([0.999999, 1.0, 1.000001], size=N_RAYS), 1.0)
    shorter = every.intersect(origins, directions, t_max=ends).t
    assert expected.hit.mean() > 0.2
    for kind in STRUCTURES:
        caster = RayCaster(points, triangles, accelerator=kind)
        hits = caster.intersect(origins, directions)
        np.testing.assert_array_equal(hits.t, expected.t, err_msg=kind)
        np.testing.assert_array_equal(caster.occluded(origins, directions), expected.hit, err_msg=kind)
        if kind != "bvh":
            np.testing.assert_array_equal(hits.triangle, expected.triangle, err_msg=kind)
            np.testing.assert_array_equal(hits.u, expected.u, err_msg=kind)
        np.testing.assert_array_equal(caster.intersect(origins, directions, t_max=ends).t, shorter, err_msg=kind)
    one, other = (RayCaster(points, triangles, accelerator=kind).all_hits(origins, directions) for kind in ("bvh", "volume_tree"))
    for part in ("t", "triangle", "u", "v", "starts"):
        np.testing.assert_array_equal(getattr(one, part), getattr(other, part))
    np.testing.assert_array_equal(one.t[one.starts[:-1][expected.hit]], expected.t[expected.hit])


@pytest.mark.parametrize("kind", STRUCTURES)
def test_no_ray_escapes_from_any_structure(kind):
    """From inside a ball of triangles, at vertices, edges and faces, near and far, along axes too: everything is met, at every scale."""
    mesh = primitives.sphere(1.0, 20)
    p = mesh.positions[mesh.triangles].astype(np.float64)
    middles = (p + np.roll(p, 1, axis=1)) / 2
    targets = np.concatenate([p.reshape(-1, 3), middles.reshape(-1, 3), p.mean(axis=1), np.eye(3), -np.eye(3)])
    for scale, shift in ((1.0, 0.0), (1e-6, 0.0), (1e6, 3.0), (1.0, 1e4)):
        caster = RayCaster((mesh.positions.astype(np.float64) + shift) * scale, mesh.triangles, accelerator=kind)
        for origin in ((0.0, 0.0, 0.0), (0.3, -0.2, 0.1), (0.0, 0.5, 0.0), (0.9, 0.0, 0.1)):
            origins = (np.array(origin) + shift) * scale
            directions = (targets - origin) * scale
            hits = caster.intersect(origins, directions)
            assert hits.hit.all()
            assert caster.occluded(origins, directions).all()
            assert (np.abs(hits.t - 1.0) < 0.05).all()
