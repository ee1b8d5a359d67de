"""Point clouds: how large points are, what stands for them in a picture, and that all renderers see the same."""

from __future__ import annotations

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, WHITE, place, scene_of, seen_by_both

from limner.errors import LimnerWarning, SceneError
from limner.files.interop import as_scene
from limner.linear.transform import rotate, scale, translate
from limner.mesh.mesh import Mesh
from limner.render import render
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.points import PointCloud, spacing
from limner.scene.shape import Sphere
from limner.tables import clouds
from limner.tables.stand_ins import Sight, StandIns

CAMERA = PerspectiveCamera.look_at((0, 0, 5), (0, 0, 0), yfov_degrees=40)
RNG = np.random.default_rng(1)
UNIT = RNG.normal(size=(400, 3))
UNIT /= np.linalg.norm(UNIT, axis=1, keepdims=True)


def stand_in(cloud: PointCloud, height: int = 400, matrix: np.ndarray | None = None, camera: object = CAMERA) -> Mesh:
    """The triangles of a cloud in a picture."""
    sight = Sight(camera, height, height, cloud.bounds)  # type: ignore[arg-type]
    return clouds.cloud_mesh(cloud, np.eye(4) if matrix is None else matrix, sight, StandIns())


def surface(mesh: Mesh) -> float:
    """Its area."""
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(float) for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2


@pytest.mark.parametrize(("dimension", "n"), [(1, 2000), (2, 3600), (3, 8000)])
def test_spacing_of_what_was_sampled_evenly(dimension: int, n: int) -> None:
    """The estimate finds the step of a grid along a line, on a surface and in a volume, whatever its size and place."""
    side = round(n ** (1.0 / dimension))
    grid = np.zeros((n, 3))
    grid[:, :dimension] = np.stack(np.meshgrid(*[np.arange(side)] * dimension), axis=-1).reshape(-1, dimension)
    assert spacing(0.01 * grid + 5.0) == pytest.approx(0.01, rel=0.3)


def test_spacing_of_a_scan() -> None:
    """Points at random on a sphere are as far apart as its area says; more points on it than are counted change no more than that."""
    points = RNG.normal(size=(200_000, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    for n in (3000, 200_000):
        assert spacing(points[:n]) == pytest.approx(np.sqrt(4 * np.pi / n), rel=0.35)


def test_spacing_of_next_to_nothing() -> None:
    """One place, or none that is finite, has no spacing; the points are then half a metre large."""
    assert spacing(np.zeros((5, 3))) == spacing([[1, 2, 3]]) == spacing(np.full((2, 3), np.nan)) == 0.0
    assert PointCloud([[1, 2, 3]]).point_radii.tolist() == [0.5]


def test_default_radii() -> None:
    """Discs reach their neighbours on a grid; spheres on it just touch."""
    grid = np.stack(np.meshgrid(np.arange(40), np.arange(40), [0]), axis=-1).reshape(-1, 3)
    step = spacing(grid)
    assert PointCloud(grid).point_radii[0] == pytest.approx(step / 2)
    discs = PointCloud(grid, normals=np.tile([0, 0, 1.0], (1600, 1)))
    assert discs.shown_as == "discs"
    assert discs.point_radii[0] == pytest.approx(step)


def test_bounds_and_hull_hold_what_is_shown() -> None:
    """The box, the range along any direction and the hull hold every sphere."""
    cloud = PointCloud(UNIT, radii=RNG.uniform(0.1, 0.5, 400))
    directions = RNG.normal(size=(20, 3))
    low, high = cloud.range_along(directions)
    reach = cloud.point_radii[:, None] * np.linalg.norm(directions, axis=1)
    along = cloud.positions.astype(float) @ directions.T
    assert np.allclose(low, (along - reach).min(axis=0))
    assert np.allclose(high, (along + reach).max(axis=0))
    hull = cloud.hull @ directions.T
    assert (hull.max(axis=0) >= high - 1e-6).all()
    assert (hull.min(axis=0) <= low + 1e-6).all()


@pytest.mark.parametrize("height", [4, 40, 400, 4000])
@pytest.mark.parametrize("shown_as", ["discs", "spheres"])
def test_stand_ins_have_the_size_of_what_they_stand_for(shown_as: str, height: int) -> None:
    """However coarse, polygons have the area of their discs and solids the surface of their spheres, and they are closed."""
    cloud = PointCloud(0.1 * UNIT[:15], radii=RNG.uniform(0.1, 0.3, 15), shown_as=shown_as)
    mesh = stand_in(cloud, height)
    whole = (4.0 if shown_as == "spheres" else 1.0) * np.pi * float((cloud.point_radii.astype(float) ** 2).sum())
    assert surface(mesh) == pytest.approx(whole, rel=1e-5)
    if shown_as == "spheres":
        edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()


def test_finer_where_larger() -> None:
    """Points near the eye get more triangles than those far away; outlines leave the circle by a tenth of a pixel at most."""
    cloud = PointCloud([[0, 0, 4], [0, 0, -2000]], radii=0.2, shown_as="discs")
    near = stand_in(PointCloud([[0, 0, 4]], radii=0.2, shown_as="discs"))
    assert len(stand_in(cloud).triangles) == len(near.triangles) + 1
    pixels = 400 / (2 * np.tan(np.radians(20)))
    off = np.linalg.norm(near.positions - np.float32([0, 0, 4]), axis=1) - 0.2
    assert np.abs(off).max() * pixels < 0.1


def test_memory_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where all points together would need too many triangles they are coarser, in the end one triangle each, which faces the eye."""
    cloud = PointCloud(UNIT, radii=0.5)
    assert len(stand_in(cloud, 4000).triangles) > 100_000
    for most in (20_000, 4000, 1600, 500):
        monkeypatch.setattr(clouds, "MOST_TRIANGLES", most)
        assert len(stand_in(cloud, 4000).triangles) <= most


def test_discs_lie_across_their_normals() -> None:
    """Discs stand across their normals, front out; without normals, across the gaze, in any place that a node gives them."""
    mesh = stand_in(PointCloud(UNIT, normals=3.0 * UNIT, radii=0.1))
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(float) for k in range(3))
    front = np.cross(b - a, c - a)
    middle = (a + b + c) / 3.0
    assert (np.einsum("ij,ij->i", front, middle) > 0.95 * np.linalg.norm(front, axis=1)).all()
    matrix = translate(1, 2, -3) @ rotate((1, 1, 0), 0.7) @ scale(1, 3, 0.5)
    mesh = stand_in(PointCloud([[0.5, 0.25, 1.0]], radii=0.1, shown_as="discs"), matrix=matrix)
    world = mesh.positions.astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    to_eye = np.array([0, 0, 5.0]) - world.mean(axis=0)
    assert np.abs((world - world.mean(axis=0)) @ to_eye).max() < 1e-5


def test_the_same_question_gets_the_same_triangles() -> None:
    """A camera that turns round a cloud without coming nearer finds the same object again."""
    cloud, again = PointCloud(UNIT, radii=0.01), StandIns()
    sights = [Sight(PerspectiveCamera.look_at(eye, (0, 0, 0)), 99, 99, cloud.bounds) for eye in ((0, 0, 9), (0.1, 0, 9))]
    first, second = (clouds.cloud_mesh(cloud, np.eye(4), sight, again) for sight in sights)
    assert first is second


@pytest.mark.parametrize("camera", [CAMERA, OrthographicCamera.look_at((0, 0, 5), (0, 0, 0), height=3.0)], ids=["perspective", "parallel"])
def test_both_renderers_see_the_same(camera: object) -> None:
    """A point is seen where the sphere of its radius is: the same ids, and nearly its depth, by raster and by ray."""
    cloud = place(PointCloud([[-0.4, 0, 0], [0.4, 0, 0.3]], radii=[0.5, 0.4]), WHITE)
    balls = (place(Sphere(0.5), WHITE, at=(-0.4, 0, 0)), place(Sphere(0.4), WHITE, at=(0.4, 0, 0.3)))
    raster, ray = seen_by_both(scene_of(cloud, camera=camera), width=32, height=24)  # type: ignore[arg-type]
    exact, _ = seen_by_both(scene_of(*balls, camera=camera), width=32, height=24)  # type: ignore[arg-type]
    seen = [image.aov["instance_id"] >= 0 for image in (raster, ray, exact)]
    assert (seen[0] == seen[1]).all()
    assert (seen[0] != seen[2]).sum() <= 2
    both = seen[0] & seen[2]
    depths = [image.aov["depth"][both] for image in (raster, ray, exact)]
    assert np.abs(depths[0] - depths[2]).max() < 0.05
    assert np.allclose(depths[0], depths[1], rtol=1e-4)
    assert np.abs(raster.pixels - exact.pixels)[both].max() < 0.06


@SLOW_AS_PYTHON
def test_a_white_cloud_in_a_white_world() -> None:
    """The path tracer sees colours of points, too: red where the red one is, green where the green one is."""
    cloud = PointCloud([[-0.5, 0, 0], [0.5, 0, 0]], [[1, 0, 0], [0, 1, 0]], radii=0.4)
    image = render(scene_of(place(cloud, WHITE), camera=CAMERA), width=24, height=16, renderer="path", samples=4)
    left, right = image.pixels[8, 8, :3], image.pixels[8, 15, :3]
    assert left[0] > 0.1 > left[1]
    assert right[1] > 0.1 > right[0]


def test_render_takes_clouds() -> None:
    """A cloud, and one of trimesh's, are scenes; colours are shown as they are."""
    trimesh = pytest.importorskip("trimesh", reason="the formats extra is not installed")
    ((_, shape),) = as_scene(PointCloud(UNIT, np.abs(UNIT))).shapes()
    assert shape.materials[0].color == (1.0, 1.0, 1.0)  # type: ignore[union-attr]
    ((_, shape),) = as_scene(trimesh.PointCloud(UNIT, colors=np.tile([255, 0, 0, 255], (400, 1)))).shapes()
    assert isinstance(shape.geometry, PointCloud)
    assert shape.geometry.colors is not None
    assert shape.geometry.colors[7].tolist() == [1, 0, 0, 1]


def test_points_at_infinity_are_said_and_keep_their_rows() -> None:
    """What is not finite is not shown, but keeps its place, so that numbers about the points still fit."""
    with pytest.warns(LimnerWarning, match="1 of 3 points are not finite"):
        cloud = PointCloud([[0, 0, 0], [np.inf, 0, 0], [1, 0, 0]], radii=0.25, scalars={"a": [1, 2, 3]})
    assert cloud.bounds.tolist() == [[-0.25] * 3, [1.25, 0.25, 0.25]]
    assert surface(stand_in(cloud)) == pytest.approx(2 * 4 * np.pi * 0.25**2, rel=1e-4)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"positions": []}, "at least one finite row"),
        ({"positions": [[np.nan, 0, 0]]}, "at least one finite row"),
        ({"positions": [[0, 0]]}, r"shape \(n, 3\)"),
        ({"radii": -1.0}, r"radii must be positive, got -1\.0"),
        ({"radii": [1.0, 0.0]}, r"must be positive, got 0\.0 at point 1"),
        ({"radii": [1.0]}, "one per point"),
        ({"radii": "large"}, "must be a number"),
        ({"colors": [[1, 0, 0]]}, "colors must have one row per point"),
        ({"normals": [[1, 0, 0]]}, "normals must have one row per point"),
        ({"shown_as": "cubes"}, "discs, spheres"),
        ({"scalars": {"a": [1.0]}}, r"scalars\['a'\] must have 2 numbers"),
        ({"scalars": [1.0]}, "must map names"),
    ],
)
def test_what_is_refused(fields: dict[str, object], message: str) -> None:
    """Each slip in one line that names the field."""
    with pytest.raises(SceneError, match=message):
        PointCloud(**{"positions": [[0, 0, 0], [1, 1, 1]], **fields})  # type: ignore[arg-type]
