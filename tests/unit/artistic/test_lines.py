"""The lines of a drawing against closed forms: which there are, where they run, and how many surfaces hide them."""

from __future__ import annotations

import itertools
import math
import threading
from collections import Counter

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.artistic.lines import KINDS, Drawing, FeatureLine, drawing_of
from limner.errors import SceneError, UnsupportedError
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.progress import Progress
from limner.scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from limner.scene.material import Lambert
from limner.scene.node import Node
from limner.scene.primitive import Box, Plane, Sphere
from limner.scene.scene import Scene
from limner.scene.shape import Geometry, Shape
from limner.tiles import Cancelled

WIDTH, HEIGHT = 200, 160
EYE = PerspectiveCamera.look_at((3.0, 2.0, 4.0), (0.0, 0.0, 0.0), yfov_degrees=40)
FRONT = OrthographicCamera.look_at((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), height=4.0)
ABOVE = OrthographicCamera.look_at((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), height=4.0)
ISOMETRIC = OrthographicCamera.look_at((1.0, 1.0, 1.0), (0.0, 0.0, 0.0), height=4.0)


def shown(geometry: Geometry, matrix: NDArray[np.float64] | None = None, *colors: float) -> Node:
    materials = tuple(Lambert(color=(c, c, c)) for c in colors) or (Lambert(),)
    return Node(parent_from_node=np.eye(4) if matrix is None else matrix, shapes=(Shape(geometry, materials),))


def draw(*nodes: Node, camera: Camera = EYE, **options: object) -> Drawing:
    return drawing_of(Scene(root=Node(children=nodes)), camera, width=WIDTH, height=HEIGHT, **options)  # type: ignore[arg-type]


def at(x: float, y: float, z: float) -> NDArray[np.float64]:
    return transform.translate(x, y, z)


def sheet(width: float, height: float) -> Mesh:
    """A rectangle round the origin that faces +z, in two triangles."""
    x, y = width / 2, height / 2
    return primitives.quad([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]])


def total(lines: tuple[FeatureLine, ...]) -> float:
    return sum(line.length for line in lines)


def edges_of_box(matrix: NDArray[np.float64], camera: Camera) -> float:
    """The length on the picture of all twelve edges of the cube of side 1."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    xy, _ = camera.project(corners @ matrix[:3, :3].T + matrix[:3, 3], WIDTH, HEIGHT)
    pairs = [(i, i | bit) for bit in (1, 2, 4) for i in range(8) if not i & bit]
    return sum(float(np.hypot(*(xy[i] - xy[j]))) for i, j in pairs)


# --- a cube ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("camera", [EYE, OrthographicCamera.look_at((3, 2, 4), (0, 0, 0), height=3.0)])
def test_a_cube_has_a_closed_outline_three_edges_inside_it_and_three_behind_it(camera: Camera) -> None:
    """Twelve edges: six are the outline, one ring; three meet before it, three behind it, hidden by one surface all along."""
    drawing = draw(shown(Box((1.0, 1.0, 1.0))), camera=camera)
    (outline,) = drawing.of("silhouette")
    assert outline.closed
    assert len(outline.picture) == 7
    assert outline.hidden_by == 0
    assert (outline.picture[0] == outline.picture[-1]).all()
    creases = drawing.of("crease")
    assert {line.hidden_by for line in creases} == {0, 1}
    for hidden in (False, True):
        inner = drawing.of("crease", hidden=hidden)
        # Two edges go on into each other, the third ends on them.
        assert sorted(len(line.picture) for line in inner) == [2, 3]
    assert total(drawing.lines) == pytest.approx(edges_of_box(np.eye(4), camera), rel=1e-12)


def test_points_of_lines_are_where_the_camera_sees_them() -> None:
    """`picture` and `depth` are the projection of `world`, half a pixel off because they count from the picture's corner."""
    drawing = draw(shown(Box((1.0, 1.0, 1.0)), at(0.2, 0.1, 0.0)), shown(Sphere(0.4), at(0.0, 0.6, 0.5)))
    for line in drawing.lines:
        xy, depth = EYE.project(line.world, WIDTH, HEIGHT)
        assert np.allclose(line.picture, xy + 0.5, atol=1e-9)
        assert np.allclose(line.depth, depth, rtol=1e-12)


def test_a_box_seen_from_the_front_is_a_square() -> None:
    """What is seen of a box whose sides are edge-on is its front's four edges, whatever stands exactly behind them."""
    drawing = draw(shown(Box((1.0, 1.0, 1.0))), camera=FRONT)
    seen = drawing.of(hidden=False)
    points = np.concatenate([line.picture for line in seen])
    assert points.min(axis=0).tolist() == [80.0, 60.0]
    assert points.max(axis=0).tolist() == [120.0, 100.0]
    (outline,) = drawing.lines
    assert outline.closed
    assert outline.length == pytest.approx(160.0)
    assert outline.hidden_by == 0


def test_isometry_shows_three_equal_faces() -> None:
    """All nine visible edges of a cube are seen at the length sqrt(2/3), and its scale is told."""
    drawing = draw(shown(Box((1.0, 1.0, 1.0))), camera=ISOMETRIC)
    assert drawing.pixels_per_metre == pytest.approx(40.0)
    assert total(drawing.of("silhouette")) == pytest.approx(6 * 40.0 * math.sqrt(2 / 3))
    lengths = [np.hypot(*np.diff(line.picture, axis=0).T) for line in drawing.of("crease", hidden=False)]
    assert np.allclose(np.concatenate(lengths), 40.0 * math.sqrt(2 / 3))


def test_surfaces_that_touch_hide_none_of_their_common_lines() -> None:
    """Of two boxes, one upon the other, with whole faces in one plane, the seam is seen wherever either box would show it."""
    low, high = shown(Box((1.0, 1.0, 1.0)), at(0, -0.5, 0)), shown(Box((1.0, 1.0, 1.0)), at(0, 0.5, 0))
    drawing = draw(low, high)
    seam = [[-0.5, 0.0, 0.5], [0.5, 0.0, 0.5], [0.5, 0.0, -0.5], [-0.5, 0.0, -0.5], [-0.5, 0.0, 0.5]]
    xy = EYE.project(seam, WIDTH, HEIGHT)[0] + 0.5
    around = float(np.hypot(*np.diff(xy, axis=0).T).sum())
    # All edges of both, those that they have in common once.
    both = edges_of_box(at(0, -0.5, 0), EYE) + edges_of_box(at(0, 0.5, 0), EYE)
    assert total(drawing.lines) == pytest.approx(both - around, rel=1e-7)
    for p in (xy[:2] + xy[1:3]) / 2:
        assert any(_distance(line.picture, p) < 1e-9 and line.hidden_by == 0 for line in drawing.lines)


def _distance(points: NDArray[np.float64], p: NDArray[np.float64]) -> float:
    """From a point to a polyline."""
    a, way = points[:-1], np.diff(points, axis=0)
    t = np.clip(((p - a) * way).sum(axis=1) / np.maximum((way * way).sum(axis=1), 1e-300), 0.0, 1.0)
    return float(np.hypot(*(a + t[:, None] * way - p).T).min())


def test_every_surface_in_front_counts() -> None:
    """Behind k screens a line is hidden by k; its parts are cut where the screens end, to rounding."""
    screens = [shown(sheet(1.0 + k, 3.0), at(0, 0, 1.0 + 0.5 * k)) for k in range(3)]
    wire = Mesh(np.float32([[-1.8, 0.1, 0], [1.8, 0.1, 0], [0, 0.11, -0.5]]), np.int32([[0, 1, 2]]))
    drawing = draw(*screens, shown(wire), camera=FRONT)
    found = [(p, q, line.hidden_by) for line in drawing.lines if line.instance == 3 for p, q in itertools.pairwise(line.picture)]
    spans = sorted((float(min(p[0], q[0])), float(max(p[0], q[0])), hidden_by) for p, q, hidden_by in found if p[1] == q[1])
    stops = [100.0 + 40.0 * x for x in (-1.8, -1.5, -1.0, -0.5, 0.5, 1.0, 1.5, 1.8)]
    assert np.allclose([span[:2] for span in spans], list(itertools.pairwise(stops)), atol=1e-5)
    assert [span[2] for span in spans] == [0, 1, 2, 3, 2, 1, 0]


def test_a_line_behind_the_inner_edges_of_a_screen_is_hidden() -> None:
    """An edge exactly behind an edge between triangles of a screen does not show through it."""
    screen = sheet(2.0, 2.0)
    n = len(screen.triangles)
    edges = {tuple(sorted((int(a), int(b)))) for t in screen.triangles for a, b in zip(t, np.roll(t, 1), strict=True)}
    inner = [e for e in edges if sum(set(e) <= set(t.tolist()) for t in screen.triangles) == 2]
    assert n == 2
    assert len(inner) == 1
    a, b = screen.positions[list(inner[0])].astype(np.float64)
    # A sliver of a fin, edge-on to the eye, right behind the diagonal.
    fin = Mesh(np.float32([a * 0.5 - [0, 0, 1], b * 0.5 - [0, 0, 1], np.array([0, 0, -2.0])]), np.int32([[0, 1, 2]]))
    drawing = draw(shown(screen), shown(fin), camera=FRONT)
    hidden = [line for line in drawing.lines if line.instance == 1]
    assert hidden
    assert all(line.hidden_by == 1 for line in hidden)


# --- curved surfaces ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("distance", [1.5, 4.0])
def test_a_sphere_is_a_circle(distance: float) -> None:
    """The outline of a ball of radius r at distance d along the gaze is a circle of radius f r / sqrt(d² - r²)."""
    camera = PerspectiveCamera.look_at((0, 0, distance), (0, 0, 0), yfov_degrees=120 if distance < 2 else 60)
    drawing = draw(shown(Sphere(1.0)), camera=camera, kinds=("smooth_silhouette",))
    (line,) = drawing.lines
    radius = camera.intrinsics(WIDTH, HEIGHT)[0, 0] / math.sqrt(distance**2 - 1.0)
    assert line.closed
    assert line.hidden_by == 0
    assert np.abs(np.hypot(*(line.picture - (WIDTH / 2, HEIGHT / 2)).T) - radius).max() < 0.15


def test_a_torus_from_above_is_two_circles() -> None:
    """R + r and R - r; the inner one is seen too."""
    drawing = draw(shown(primitives.torus(1.0, 0.3, 48, 24)), camera=ABOVE, kinds=("smooth_silhouette",))
    radii = sorted((np.hypot(*(line.picture - (100.0, 80.0)).T).mean() for line in drawing.lines), reverse=True)
    assert np.allclose(radii, [52.0, 28.0], atol=0.2)
    assert all(line.closed and not line.hidden_by for line in drawing.lines)


def test_a_cylinder_from_the_side_is_a_rectangle() -> None:
    """Its rims are seen as straight lines, and two sides join them; the edges of its facets are none."""
    drawing = draw(shown(primitives.cylinder(0.5, 2.0, 32)), camera=FRONT)
    seen = np.concatenate([line.picture for line in drawing.of(hidden=False)])
    assert np.allclose(seen.min(axis=0), [80.0, 40.0], atol=0.1)
    assert np.allclose(seen.max(axis=0), [120.0, 120.0], atol=0.1)
    inside = (np.abs(seen[:, 0] - 100.0) < 19.0) & (np.abs(seen[:, 1] - 80.0) < 39.0)
    assert not inside.any()


def test_the_hollow_side_of_a_saddle_hides_its_own_silhouette() -> None:
    """Seen from the side, the inner half of a torus has a silhouette too, which lies behind its outer half."""
    camera = OrthographicCamera.look_at((0.0, 1.0, 5.0), (0.0, 0.0, 0.0), height=4.0)
    drawing = draw(shown(primitives.torus(1.0, 0.3, 48, 24)), camera=camera, kinds=("smooth_silhouette",))
    seen = drawing.of(hidden=False)
    outer = max(seen, key=lambda line: line.length)
    assert outer.closed
    assert outer.length > 0.5 * total(drawing.lines)
    assert drawing.of(hidden=True)


def test_suggestive_contours_lie_where_curvature_towards_the_eye_vanishes() -> None:
    """Of a corrugated sheet, y = a cos(2 pi x), those inflections, x = n - 1/4, behind which a crest begins to rise before the eye."""
    n, m = 64, 4
    x, z = np.meshgrid(np.linspace(-1.0, 1.0, n + 1), np.linspace(0.5, -0.5, m + 1))
    positions = np.stack([x, 0.05 * np.cos(2.0 * np.pi * x), z], axis=-1).reshape(-1, 3)
    a = (np.arange(m)[:, None] * (n + 1) + np.arange(n)).reshape(-1)
    triangles = np.concatenate([np.stack([a, a + 1, a + n + 1], 1), np.stack([a + 1, a + n + 2, a + n + 1], 1)])
    camera = OrthographicCamera.look_at((4.0, 3.0, 0.0), (0.0, 0.0, 0.0), height=2.0)
    drawing = draw(shown(Mesh(np.float32(positions), np.int32(triangles))), camera=camera, kinds=("suggestive_contour",))
    places = np.concatenate([line.world[:, 0] for line in drawing.lines])
    assert np.abs(places[:, None] - (-0.25, 0.75)).min(axis=1).max() < 0.02
    assert sorted(round(float(line.world[:, 0].mean()), 2) for line in drawing.lines) == [-0.25, 0.75]
    assert all(np.ptp(line.world[:, 2]) == pytest.approx(1.0) for line in drawing.lines)


# --- seams, materials, intersections ---------------------------------------------------------------------------------------


def test_where_materials_change_runs_a_line() -> None:
    """A flat square in two materials has a line across, one that is cut differently for its texture a seam; else it has none."""
    corners = np.float32([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]) - np.float32([1, 0.5, 0])
    triangles = np.int32([[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
    cut = np.int32([[0, 1, 4], [0, 4, 3], [5, 6, 7], [5, 7, 2]])
    for fields, kind in (
        ({"triangle_materials": np.int32([0, 0, 1, 1])}, "material"),
        ({"uvs": np.float32(np.arange(16).reshape(8, 2)), "uv_triangles": cut}, "uv_seam"),
        ({"uvs": np.float32(np.arange(12).reshape(6, 2))}, None),
    ):  # fmt: skip
        mesh = Mesh(corners, triangles, **fields)  # type: ignore[arg-type]
        drawing = draw(shown(mesh, None, 0.2, 0.8), camera=FRONT, kinds=("material", "uv_seam", "crease"))
        assert [line.kind for line in drawing.lines] == ([kind] if kind else [])
        if kind:
            (line,) = drawing.lines
            assert sorted(line.picture.tolist()) == [[100.0, 60.0], [100.0, 100.0]]


def test_a_sunk_sphere_meets_the_ground_in_a_circle() -> None:
    """A ball sunk to half its radius into a plane meets it in a circle of radius sqrt(3)/2 r: one ring, and no line of the plane."""
    drawing = draw(shown(Plane()), shown(Sphere(1.0), at(0, 0.5, 0)), camera=ABOVE, kinds=("intersection", "boundary"))
    (line,) = drawing.lines
    assert line.closed
    assert line.kind == "intersection"
    assert np.abs(np.hypot(line.world[:, 0], line.world[:, 2]) - math.sqrt(0.75)).max() < 0.01
    assert np.abs(line.world[:, 1]).max() < 1e-5
    assert line.hidden_by == 1


def test_what_stands_on_something_does_not_meet_it() -> None:
    """A box on a table has no line where it only touches it; pushed in a little, it has its outline there."""
    table = shown(Box((3.0, 1.0, 3.0)), at(0, -0.5, 0))
    assert not draw(table, shown(Box((1.0, 1.0, 1.0)), at(0, 0.5, 0)), kinds=("intersection",)).lines
    lines = draw(table, shown(Box((1.0, 1.0, 1.0)), at(0, 0.4, 0)), kinds=("intersection",)).lines
    assert sorted(line.hidden_by for line in lines) == [0, 1]
    assert sum(np.linalg.norm(np.diff(line.world, axis=0), axis=1).sum() for line in lines) == pytest.approx(4.0)


def test_a_surface_that_runs_through_itself_is_found() -> None:
    """Two crossing sheets of one mesh meet in a line, which both show."""
    mesh = Mesh(np.float32([[-1, 0, -1], [1, 0, -1], [0, 0, 1], [-0.5, -1, 0], [0.5, -1, 0], [0, 1, 0]]), np.int32([[0, 1, 2], [3, 4, 5]]))
    (line,) = draw(shown(mesh), kinds=("intersection",)).lines
    ends = line.world[np.argsort(line.world[:, 0])]
    assert np.allclose(ends, [[-0.25, 0, 0], [0.25, 0, 0]], atol=1e-12)


# --- creases, chains ------------------------------------------------------------------------------------------------------


def test_rims_are_rings() -> None:
    """A cylinder from above has two rims, the one behind the other; each is one closed stroke."""
    camera = PerspectiveCamera.look_at((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0))
    drawing = draw(shown(primitives.cylinder(0.5, 1.0, 24)), camera=camera, kinds=("crease",))
    assert sorted((line.closed, len(line.picture), line.hidden_by) for line in drawing.lines) == [(True, 25, 0), (True, 25, 1)]


def test_single_rough_edges_are_no_creases() -> None:
    """One sharp dent in the middle of a plane is left out, as long as it is small; a cross that runs to the rim is not."""
    n = 9
    x, z = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    y = np.zeros((n, n))
    triangles = []
    for i in range(n - 1):
        for j in range(n - 1):
            a = i * n + j
            triangles += [[a, a + n, a + 1], [a + 1, a + n, a + n + 1]]

    def creases(heights: NDArray[np.float64]) -> float:
        mesh = Mesh(np.float32(np.stack([x, heights, z], axis=-1).reshape(-1, 3)), np.int32(triangles))
        return total(draw(shown(mesh), camera=ABOVE, kinds=("crease",), crease_degrees=10.0).lines)

    assert creases(y) == 0.0
    assert creases(np.abs(x)) == pytest.approx(80.0)


def test_no_line_is_drawn_twice() -> None:
    """An edge that is a silhouette, a crease and a change of material is one of them."""
    cube = primitives.cube()
    both = Mesh(cube.positions, cube.triangles, triangle_materials=np.arange(12, dtype=np.int32) // 2)
    drawing = draw(shown(both, None, *np.linspace(0.1, 0.9, 6)), kinds=KINDS[:1] + KINDS[2:6])
    side = float(np.ptp(cube.positions[:, 0]))
    assert total(drawing.lines) == pytest.approx(edges_of_box(np.diag([side, side, side, 1.0]), EYE), rel=1e-9)


# --- what may come ---------------------------------------------------------------------------------------------------------


def test_nothing_to_see_is_an_empty_drawing() -> None:
    """No shapes, or none before the camera, or none in the picture."""
    assert draw().lines == ()
    assert draw(shown(Box((1.0, 1.0, 1.0)), at(30, 20, 40))).lines == ()
    assert draw(shown(Box((1.0, 1.0, 1.0)), at(300, 0, 0))).lines == ()
    assert draw(shown(Box((1.0, 1.0, 1.0))), hidden=False).of(hidden=True) == ()


def test_lines_end_at_the_edges_of_the_picture() -> None:
    """A box larger than the picture: all points lie in it, and some on its edge."""
    drawing = draw(shown(Box((3.0, 3.0, 3.0))))
    points = np.concatenate([line.picture for line in drawing.lines])
    assert (points >= -1e-9).all()
    assert (points <= np.array([WIDTH, HEIGHT]) + 1e-9).all()
    assert (np.abs(points) < 1e-9).any() or (np.abs(points - (WIDTH, HEIGHT)) < 1e-9).any()


def test_from_inside_a_room_its_edges_are_seen() -> None:
    """The camera in the middle of a box sees what of its edges is before it; nothing hides any, not even what is behind the eye."""
    camera = PerspectiveCamera.look_at((0, 0, 0.9), (0, 0, 0), yfov_degrees=70)
    drawing = draw(shown(Box((2.0, 2.0, 2.0))), camera=camera)
    assert {line.hidden_by for line in drawing.lines} == {0}
    corners = [[x, y, -1.0] for x, y in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
    for xy in camera.project(corners, WIDTH, HEIGHT)[0] + 0.5:
        assert sum(bool((np.abs(line.picture - xy) < 1e-9).all(axis=1).any()) for line in drawing.lines) >= 1


def test_near_and_far_cut() -> None:
    """Lines end where the camera's planes are, and what stands before the near plane hides nothing."""
    camera = EYE.replace(near=5.0, far=5.6)
    drawing = draw(shown(Box((1.0, 1.0, 1.0))), shown(sheet(9.0, 9.0), EYE.world_from_camera @ at(0, 0, -2.0)), camera=camera)
    depth = np.concatenate([line.depth for line in drawing.lines])
    assert depth.min() == pytest.approx(5.0)
    assert depth.max() == pytest.approx(5.6)
    assert {line.hidden_by for line in drawing.lines} <= {0, 1}


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e6])
def test_size_does_not_matter(scale: float) -> None:
    """The same scene, a million times smaller or larger, is the same drawing."""
    nodes = (Box((1.0, 1.0, 1.0)), at(0.2, 0.1, 0)), (Box((0.5, 0.5, 2.0)), at(-0.3, 0.2, 0.4))

    def drawn(s: float) -> Drawing:
        camera = PerspectiveCamera.look_at(np.array([3.0, 2.0, 4.0]) * s, (0, 0, 0), yfov_degrees=40)
        scaled = [shown(geometry, transform.scale(s, s, s) @ matrix) for geometry, matrix in nodes]
        return draw(*scaled, camera=camera)

    def summary(drawing: Drawing) -> Counter[tuple[str, int, int]]:
        return Counter((line.kind, line.hidden_by, len(line.picture)) for line in drawing.lines)

    one, other = drawn(1.0), drawn(scale)
    assert summary(one) == summary(other)
    assert total(other.lines) == pytest.approx(total(one.lines), rel=1e-5)


def test_bad_meshes_are_drawn_as_they_are() -> None:
    """Collapsed triangles, three sheets at one edge, triangles turned over: what is there is drawn, the turned one as if it were not."""
    corners = np.float32([[-1, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0.2, 1], [0, 0, 0]])
    flat = Mesh(corners, np.int32([[0, 1, 2], [0, 1, 3]]))
    drawing = draw(shown(flat), camera=FRONT)
    assert {line.kind for line in drawing.lines} == {"boundary"}
    assert total(drawing.lines) == pytest.approx(4 * 40 * math.sqrt(2))
    fins = Mesh(corners, np.int32([[0, 1, 2], [1, 0, 3], [0, 1, 4], [0, 1, 5], [2, 2, 3]]))
    branching = draw(shown(fins), kinds=("crease",))
    assert len(branching.lines) >= 1


def test_calls_that_make_no_drawing_are_refused() -> None:
    """Kinds that there are not, angles that are none, sizes of nothing."""
    with pytest.raises(UnsupportedError, match=r"kinds must be of silhouette, .* got 'outline'"):
        draw(kinds=("outline",))
    with pytest.raises(SceneError, match="kinds must be a sequence"):
        draw(kinds="crease")
    with pytest.raises(SceneError, match=r"crease_degrees must lie in \[0, 180\], got 200"):
        draw(crease_degrees=200.0)
    with pytest.raises(SceneError, match="width must be an integer of at least 1, got 0"):
        drawing_of(Scene(), EYE, width=0, height=1)


def test_it_says_how_far_it_is_and_can_be_stopped() -> None:
    """Progress grows from 0 to 1; a cancelled drawing is none."""
    heard: list[Progress] = []
    draw(shown(Box((1.0, 1.0, 1.0))), on_progress=heard.append)
    done = [progress.done for progress in heard]
    assert done == sorted(done)
    assert done[0] == 0.0
    assert done[-1] == 1.0
    stop = threading.Event()
    stop.set()
    with pytest.raises(Cancelled):
        draw(shown(Box((1.0, 1.0, 1.0))), cancel=stop)


def test_the_same_drawing_every_time() -> None:
    """To the bit, and in the same order."""
    nodes = shown(Box((1.0, 1.0, 1.0))), shown(primitives.torus(0.8, 0.2, 16, 8), at(0, 0.3, 0))
    one, other = draw(*nodes), draw(*nodes)
    assert len(one.lines) == len(other.lines)
    for a, b in zip(one.lines, other.lines, strict=True):
        assert (a.kind, a.hidden_by, a.instance, a.closed) == (b.kind, b.hidden_by, b.instance, b.closed)
        assert all((p == q).all() for p, q in ((a.picture, b.picture), (a.depth, b.depth), (a.world, b.world)))
        assert not a.picture.flags.writeable
