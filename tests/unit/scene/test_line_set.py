"""Lines: how wide they are, what stands for them in a picture, that all renderers see the same, and that files give them back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, WHITE, checkers, place, scene_of, seen_by_both

from limner.errors import LimnerWarning, SceneError
from limner.files.interop import as_scene
from limner.files.load import load
from limner.files.save_mesh import save_model
from limner.linear.transform import rotate, scale, transform_points, translate
from limner.mesh.mesh import Mesh
from limner.render import render
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.color_by import color_by
from limner.scene.digest import scene_digest
from limner.scene.displacement import Displacement
from limner.scene.line_set import LineSet
from limner.scene.shape import Shape
from limner.tables.lines import line_mesh
from limner.tables.stand_ins import Sight, StandIns

CAMERA = PerspectiveCamera.look_at((0, 0, 5), (0, 0, 0), yfov_degrees=40)
PARALLEL = OrthographicCamera.look_at((0, 0, 5), (0, 0, 0), height=3.0)
CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], dtype=float)
EDGES = [(a, b) for b in range(8) for a in range(b) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1]


def stand_in(lines: LineSet, matrix: Any = None, camera: Any = CAMERA, height: int = 400) -> Mesh:
    """The triangles of lines in a picture."""
    sight = Sight(camera, height, height, lines.bounds)
    return line_mesh(lines, np.eye(4) if matrix is None else matrix, sight, StandIns())


def surface(mesh: Mesh) -> float:
    """Its area."""
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(float) for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2


def turned_out(mesh: Mesh, matrix: np.ndarray) -> bool:
    """Whether triangles in the world face as their normals do."""
    a, b, c = (transform_points(matrix, mesh.positions.astype(float))[mesh.triangles[:, k]] for k in range(3))
    assert mesh.normals is not None
    normals = mesh.normals.astype(float) @ np.linalg.inv(matrix[:3, :3])
    facing = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals[mesh.triangles[:, 0]])
    return bool((facing * np.linalg.det(matrix[:3, :3]) > 0.0).all())


def test_tubes_have_the_girth_of_what_they_stand_for() -> None:
    """However coarse, a prism is as long around as its tube; at the two ends, and at no straight passage, there is a sphere."""
    for height in (20, 400, 8000):
        mesh = stand_in(LineSet([[-1, 0, 0], [0, 0, 0], [1, 0, 0]], radii=0.1), height=height)
        side = 2 * np.pi * 0.1 * 2.0
        assert surface(mesh) - 2 * 4 * np.pi * 0.1**2 == pytest.approx(side, rel=0.06)
        assert turned_out(mesh, np.eye(4))


def test_joints_close_what_turns() -> None:
    """At a corner, and where more than two meet, there is a sphere; a fine curve needs none between its ends."""
    ball = 4 * np.pi * 0.1**2
    for places, segments, n_balls in (
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], None, 3),
        ([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0]], [[0, 1], [0, 2], [0, 3]], 4),
        ([[0, 0, 0]], [[0, 0]], 1),
    ):
        mesh = stand_in(LineSet(places, segments, radii=0.1))
        length = sum(np.linalg.norm(np.subtract(places[a], places[b])) for a, b in segments or ((0, 1), (1, 2)))
        assert surface(mesh) == pytest.approx(n_balls * ball + 2 * np.pi * 0.1 * length, rel=0.03)
    angles = np.linspace(0, 2 * np.pi, 400)
    curve = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    assert surface(stand_in(LineSet(curve, radii=0.05))) == pytest.approx(2 * np.pi * 0.05 * 2 * np.pi + 2 * 4 * np.pi * 0.05**2, rel=0.03)


@pytest.mark.parametrize("camera", [CAMERA, PARALLEL], ids=["perspective", "parallel"])
def test_width_in_pixels_is_that_wherever_it_is_seen(camera: Any) -> None:
    """A line that goes away from the eye is as wide far off as near by, under any place that a node gives it, mirrors included."""
    matrix = translate(0.3, 0, 1) @ rotate((1, 1, 0), 0.7) @ scale(-1, 3, 0.5)
    ends = np.array([[-1.0, -0.5, 3.0], [1.0, 0.8, -30.0]])
    lines = LineSet(transform_points(np.linalg.inv(matrix), ends), width_pixels=8.0)
    mesh = stand_in(lines, matrix, camera)
    world = transform_points(matrix, mesh.positions.astype(float))
    axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    along = (world - ends[0]) @ axis
    away = np.linalg.norm(world - ends[0] - along[:, None] * axis, axis=1)
    place_on_axis = ends[0] + along[:, None] * axis
    depth = 5.0 - place_on_axis[:, 2] if camera is CAMERA else np.ones(len(along))
    unit = 400 / (2 * np.tan(np.radians(20))) if camera is CAMERA else 400 / 3.0
    prism = (along > 1e-3) & (along < np.linalg.norm(ends[1] - ends[0]) - 1e-3) | (away > 0.9 * 4.0 * depth / unit)
    assert np.abs(away * unit / depth)[prism].max() < 4.0 * 1.25
    assert turned_out(mesh, matrix)
    assert len(line_pixels(lines, matrix, camera)) > 5


def line_pixels(lines: LineSet, matrix: np.ndarray, camera: Any) -> np.ndarray:
    """Pixels that show lines."""
    image = render(scene_of(place(lines, WHITE, matrix=matrix), camera=camera), width=20, height=15, samples=1, aovs=("instance_id",))
    return np.flatnonzero(image.aov["instance_id"] >= 0)


def test_coverage_is_the_width() -> None:
    """The alpha of each column that a line crosses adds up to its width in pixels."""
    for width in (1.0, 1.5, 4.0):
        lines = place(LineSet([[-9, 0.01, 0], [9, 0.01, 0]], width_pixels=width), WHITE)
        image = render(scene_of(lines, camera=PARALLEL), width=12, height=24, samples=32)
        assert image.pixels[:, 2:10, 3].sum(axis=0).mean() == pytest.approx(width, rel=0.12)


def test_what_crosses_the_plane_of_the_eye_is_not_wide_before_it() -> None:
    """A line from behind the eye to far ahead is cut where its width would not be straight."""
    ends = np.array([[0.5, -0.3, 40.0], [0.2, -0.3, -10.0]])
    mesh = stand_in(LineSet(ends, width_pixels=4.0))
    axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    offsets = mesh.positions.astype(float) - ends[0]
    away = np.linalg.norm(offsets - (offsets @ axis)[:, None] * axis, axis=1)
    from_eye = mesh.positions.astype(float) - [0, 0, 5]
    truth = 2.0 * np.maximum(np.abs(from_eye[:, 2]), 0.2 * np.linalg.norm(from_eye, axis=1)) / (400 / (2 * np.tan(np.radians(20))))
    assert (away < 1.5 * truth).all()
    assert len(mesh.triangles) < 2000


@SLOW_AS_PYTHON
@pytest.mark.parametrize("camera", [CAMERA, PARALLEL], ids=["perspective", "parallel"])
def test_both_renderers_see_the_same(camera: Any) -> None:
    """The same ids and depths, by raster and by ray, of wide lines and of lines of pixels."""
    cube = place(LineSet(CORNERS - 0.5, EDGES, radii=0.08), WHITE, matrix=rotate((0, 1, 0), 0.5))
    thin = place(LineSet(CORNERS - 0.5, EDGES, width_pixels=3.0), WHITE, at=(0.4, 0.2, 0.6))
    raster, ray = seen_by_both(scene_of(cube, thin, camera=camera), width=24, height=18)
    ids = [image.aov["instance_id"] for image in (raster, ray)]
    assert set(np.unique(ids[0])) == {-1, 0, 1}
    assert (ids[0] != ids[1]).sum() <= 2
    both = (ids[0] >= 0) & (ids[0] == ids[1])
    assert np.allclose(raster.aov["depth"][both], ray.aov["depth"][both], rtol=1e-3)


@SLOW_AS_PYTHON
def test_paths_of_light_see_their_colours() -> None:
    """The path tracer mixes the colours of the ends along a segment."""
    lines = LineSet([[-1, 0, 0], [1, 0, 0]], colors=[[1, 0, 0], [0, 1, 0]], radii=0.3)
    image = render(scene_of(place(lines, WHITE), camera=CAMERA), width=24, height=16, renderer="path", samples=4)
    left, right = image.pixels[8, 7, :3], image.pixels[8, 16, :3]
    assert left[0] > left[1] > 0.0
    assert right[1] > right[0] > 0.0


def test_bounds_and_hull_hold_what_is_shown() -> None:
    """Box, range and hull hold every tube, tapering ones too, and nothing of what no segment names."""
    rng = np.random.default_rng(3)
    places = np.concatenate([rng.normal(size=(30, 3)), [[99.0, 99.0, 99.0]]])
    lines = LineSet(places, rng.integers(0, 30, (60, 2)), radii=np.append(rng.uniform(0.1, 0.4, 30), 1.0))
    directions = rng.normal(size=(20, 3))
    low, high = lines.range_along(directions)
    seen = stand_in(lines, height=8000).positions @ directions.T
    assert (seen.max(axis=0) <= high + 0.01).all()
    assert (seen.min(axis=0) >= low - 0.01).all()
    assert lines.bounds.max() < 20.0
    hull = lines.hull @ directions.T
    assert (hull.max(axis=0) >= high - 1e-6).all()
    assert LineSet(CORNERS, EDGES).bounds.tolist() == [[0, 0, 0], [1, 1, 1]]


def test_files_give_lines_back(tmp_path: Path) -> None:
    """Our own files to the bit, with all fields; glTF and OBJ what they can hold; files of triangles get tubes."""
    lines = LineSet(CORNERS, EDGES, colors=CORNERS, scalars={"height": CORNERS[:, 1]}, name="cube")
    wide = LineSet(CORNERS, EDGES, radii=np.linspace(0.1, 0.2, 8), width_pixels=2.0)
    scene = scene_of(place(lines, WHITE), place(wide, WHITE, at=(3, 0, 0)))
    save_model(scene, tmp_path / "a.yaml")
    assert scene_digest(load(tmp_path / "a.yaml")) == scene_digest(scene)
    for kind in ("glb", "obj"):
        notes = save_model(scene, tmp_path / f"a.{kind}")
        assert any("without their width" in note for note in notes) == (kind == "glb")
        back = load(tmp_path / f"a.{kind}")
        for (placed, shape), shift in zip(back.shapes(), (0.0, 3.0), strict=True):
            assert isinstance(shape.geometry, LineSet)
            places = transform_points(placed.world_from_object, shape.geometry.positions.astype(float))
            assert np.allclose(places[shape.geometry.ends], (CORNERS + np.array([shift, 0, 0]))[np.array(EDGES)], atol=1e-6)
        first = back.shapes()[0][1].geometry
        assert isinstance(first, LineSet)
        assert first.colors is not None
        assert np.allclose(first.colors[first.ends], CORNERS[np.array(EDGES)], atol=1e-6)
    save_model(scene, tmp_path / "a.ply")
    assert isinstance(load(tmp_path / "a.ply").shapes()[0][1].geometry, Mesh)


def test_objects_materials_and_counts_from_behind(tmp_path: Path) -> None:
    """OBJ lines belong to their object and material, and count as faces do; what cannot be read is left out, with its line."""
    text = "v 0 0 0\nv 1 0 0\no fence\nusemtl red\nl 1 2/7\nv 2 0 0\nl -1 -2\no gate\nl 1 9\nl 1 x\nl 1\nl 3 1 2\n"
    (tmp_path / "a.obj").write_text(text)
    with pytest.warns(LimnerWarning, match="3 lines cannot be read and are left out, the first in line 9"):
        scene = load(tmp_path / "a.obj")
    found = {placed.path: shape for placed, shape in scene.shapes()}
    assert [path.split("/")[-1] for path in found] == ["fence", "gate"]
    fence, gate = (shape.geometry for shape in found.values())
    assert isinstance(fence, LineSet)
    assert isinstance(gate, LineSet)
    assert fence.positions[fence.ends][:, :, 0].tolist() == [[0, 1], [2, 1]]
    assert gate.positions[gate.ends][:, :, 0].tolist() == [[2, 0], [0, 1]]
    assert found["world/fence"].materials[0].name == "red"


def test_numbers_colour_lines_and_paths_are_taken() -> None:
    """`color_by` colours each position; a path of trimesh's is lines through its points; a LineSet is a scene."""
    lines = color_by(LineSet(CORNERS, EDGES, scalars={"x": CORNERS[:, 0]}), "x", "grey")
    assert lines.colors is not None
    assert (lines.colors[:, 0] == (CORNERS[:, 0] > 0.5)).all()
    assert as_scene(lines).shapes()[0][1].materials[0].color == (1.0, 1.0, 1.0)  # type: ignore[union-attr]
    trimesh = pytest.importorskip("trimesh", reason="the formats extra is not installed")
    (_, shape), *_ = as_scene(trimesh.load_path(CORNERS[[0, 1, 3, 2]])).shapes()
    assert isinstance(shape.geometry, LineSet)
    assert len(shape.geometry.ends) == 3


def test_what_is_not_finite_is_said() -> None:
    """A segment to infinity is not shown, nor does it count."""
    with pytest.warns(LimnerWarning, match="1 of 2 segments are not finite"):
        lines = LineSet([[0, 0, 0], [1, 0, 0], [np.inf, 0, 0]], radii=0.25)
    assert lines.bounds.tolist() == [[-0.25] * 3, [1.25, 0.25, 0.25]]
    assert np.isfinite(stand_in(lines).positions).all()


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"positions": [[0, 0, 0]]}, "at least one row with finite ends, got 0"),
        ({"segments": [[0, 2]]}, r"must refer to 2 positions, got \[0, 2\] in row 0"),
        ({"segments": [[0, 1, 2]]}, r"shape \(n, 2\)"),
        ({"radii": 0.0}, r"line_set.radii must be positive, got 0\.0"),
        ({"radii": [1.0]}, "line_set.radii must be a number, or one per point"),
        ({"width_pixels": -1.0}, "line_set.width_pixels must be positive"),
        ({"colors": [[1, 0, 0]]}, "colors must have one row per position"),
        ({"scalars": {"a": [1.0]}}, r"scalars\['a'\] must have 2 numbers"),
    ],
)
def test_refusals(fields: dict[str, Any], message: str) -> None:
    """What makes no lines is refused in one line that says why."""
    with pytest.raises(SceneError, match=message):
        LineSet(**{"positions": [[0, 0, 0], [1, 0, 0]], **fields})


def test_lines_cannot_be_displaced() -> None:
    """Displacement moves surfaces."""
    with pytest.raises(SceneError, match="not lines"):
        Shape(LineSet(CORNERS, EDGES), displacement=Displacement(checkers(), 0.1))
