"""Models as lines: which edges there are, which are features, what surfaces hide."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
import pytest
from staging import grid, place, scene_of, two_triangles

import limner
from limner.draw.canvas import Segments
from limner.errors import SceneError, UnsupportedError
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes.primitives import uv_sphere
from limner.produce.wireframe import Edges, edges_of, features, lines_seen, wireframe
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane
from limner.tables.build import flatten

W, H = 60, 48
CORNER = PerspectiveCamera.look_at((3.0, 2.5, 4.0), (0, 0, 0), yfov_degrees=35)
FRONT = OrthographicCamera.look_at((0, 0, 9), (0, 0, 0), height=3.0)


def edges(scene: Scene) -> Edges:
    return edges_of(flatten(scene, CORNER, W, H).tables)


def length(found: Edges) -> np.ndarray:
    return np.linalg.norm(found.ends - found.starts, axis=1)


def test_edges_of_a_box() -> None:
    """Twelve sides and six diagonals, wherever it stands and whatever it is scaled by; only the sides are features."""
    matrix = transform.translate(0.2, 0.1, -0.3) @ transform.rotate_y(0.4) @ transform.scale(2.0, 1.0, -1.0)
    found = edges(scene_of(place(Box(), matrix=matrix)))
    assert len(found.starts) == 18
    chosen = features(found, CORNER)
    assert np.sort(length(found)[chosen]) == pytest.approx([1.0] * 8 + [2.0] * 4)
    assert not found.branching.any()


def test_corners_in_one_place_are_one() -> None:
    """A sphere whose triangles share nothing has the edges of the one whose triangles share all: three for every two triangles."""
    whole = uv_sphere(12, 7)
    torn = Mesh(whole.positions[whole.triangles].reshape(-1, 3), np.arange(3 * len(whole.triangles), dtype=np.int32).reshape(-1, 3))
    for mesh in (whole, torn):
        found = edges(scene_of(place(mesh)))
        assert 2 * len(found.starts) == 3 * len(mesh.triangles)
        assert not np.isnan(found.normals).any()


def test_a_border_is_a_feature_and_a_flat_inside_is_not() -> None:
    """Of a grid of n x n points: 4 (n - 1) edges."""
    found = edges(scene_of(place(grid(5, 1.0))))
    chosen = features(found, CORNER)
    assert chosen.sum() == 16
    assert np.abs(np.stack([found.starts, found.ends])[:, chosen][..., [0, 2]]).max(axis=2).min() == pytest.approx(1.0)


def test_creases_are_measured_by_their_angle() -> None:
    """A roof of 40 degrees is a crease above 39 and below 41 none; nor is it a silhouette from above."""
    rise = np.tan(np.radians(20.0))
    corners = np.array([[-1, 0, -1], [-1, 0, 1], [0, rise, 1], [0, rise, -1], [1, 0, -1], [1, 0, 1]], np.float32)
    roof = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3], [3, 2, 5], [3, 5, 4]], np.int32))
    found = edges(scene_of(place(roof)))
    above = OrthographicCamera.orbit((0, 0, 0), 5.0, elevation_degrees=90.0)
    ridge = (np.abs(found.starts[:, 0]) < 1e-6) & (np.abs(found.ends[:, 0]) < 1e-6)
    assert features(found, above, 39.0)[ridge].all()
    assert not features(found, above, 41.0)[ridge].any()


def test_the_silhouette_of_a_ball_is_a_circle() -> None:
    """From the front: all feature lines of a fine sphere lie at its radius."""
    found = edges(scene_of(place(uv_sphere(96, 64))))
    chosen = features(found, FRONT)
    for ends in (found.starts, found.ends):
        assert np.abs(np.hypot(ends[chosen, 0], ends[chosen, 1]) - 1.0).max() < 0.06
    assert length(found)[chosen].sum() == pytest.approx(2.0 * np.pi, rel=0.01)


def test_three_walls_on_one_edge_branch() -> None:
    walls = [[[0, 0, 0], [0, 1, 0], [np.cos(a), 0, np.sin(a)]] for a in (0.0, 2.0, 4.0)]
    found = edges(scene_of(place(Mesh(np.array(walls, np.float32).reshape(-1, 3), np.arange(9, dtype=np.int32).reshape(3, 3)))))
    assert len(found.starts) == 7
    assert found.branching.sum() == 1
    assert features(found, CORNER).all()


def test_the_far_corner_of_a_box_is_hidden() -> None:
    """From a corner, nine of the twelve sides are seen, and the three that meet behind are not."""
    scene = scene_of(place(Box()))
    found = edges(scene)
    chosen = features(found, CORNER)
    found = Edges(*(part[chosen] for part in found))  # type: ignore[arg-type]
    image = limner.render(scene, width=W, height=H, camera=CORNER, samples=1, aovs=("depth",))
    seen = lines_seen(found, CORNER, image.aov["depth"])
    pieces = np.hypot(*(seen.lines[:, 2:] - seen.lines[:, :2]).T)
    whole = np.bincount(seen.source, pieces, minlength=12)
    shown = np.bincount(seen.source[seen.visible], pieces[seen.visible], minlength=12)
    behind = (np.abs(found.starts + 0.5).sum(axis=1) < 1e-6) | (np.abs(found.ends + 0.5).sum(axis=1) < 1e-6)
    assert behind.sum() == 3
    assert (shown[~behind] > 0.97 * whole[~behind]).all()
    assert (shown[behind] < 2.0).all()  # near an outline, a pixel or so
    assert whole[behind].min() > 9.0


def test_hidden_lines_are_left_out_or_have_their_colour() -> None:
    """A wall before a box: without its colour the middle of the wall is paper; with it, there are such lines and no others."""
    wall = two_triangles((-1.2, -1.2, 1), (1.2, -1.2, 1), (1.2, 1.2, 1), (-1.2, 1.2, 1))
    scene = scene_of(place(Box()), place(wall))
    plain = wireframe(scene, width=W, height=H, camera=FRONT, edges="features").image().pixels
    both = wireframe(scene, width=W, height=H, camera=FRONT, edges="features", hidden=(1.0, 0.0, 0.0)).image().pixels
    inside = np.s_[H // 2 - 14 : H // 2 + 14, W // 2 - 14 : W // 2 + 14]
    assert (plain[inside] == 1.0).all()
    assert plain.min() < 0.3
    red = (both[inside][..., 0] > 0.99) & (both[inside][..., 1] < 0.9)
    assert red.sum() > 40
    assert (both[inside][..., 0] > 0.99).all()


def test_svg_and_picture_are_the_same_drawing() -> None:
    """As many lines as are seen, in a file that XML reads."""
    scene = scene_of(place(Box()), place(Plane(), at=(0, -0.5, 0)))
    canvas = wireframe(scene, width=W, height=H, camera=CORNER)
    root = ET.fromstring(canvas.svg())
    (path,) = root.iter("{http://www.w3.org/2000/svg}path")
    (lines,) = (command.lines for command in canvas.commands if isinstance(command, Segments))
    assert path.get("d", "").count("M") == len(lines)
    assert root.get("width") == str(W)


def test_lines_over_the_shaded_model() -> None:
    """Away from lines it is the picture; on a transparent ground it is transparent where the picture is."""
    scene = scene_of(place(Box()))
    image = limner.render(scene, width=W, height=H, camera=CORNER, samples=4)
    drawn = wireframe(scene, width=W, height=H, camera=CORNER, shaded=True, samples=4, background=None, color="#ff0000").image()
    away = np.abs(drawn.pixels - image.pixels).max(axis=2) < 1e-4
    assert 0.6 < away.mean() < 0.99
    assert (drawn.pixels[0, 0] == 0.0).all()
    changed = drawn.pixels[~away]
    assert (changed[:, 0] > 0.0).all()


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"edges": "some"}, UnsupportedError, "edges must be one of all, features, got 'some'"),
        ({"crease_degrees": 200.0}, SceneError, "crease_degrees must lie in"),
        ({"line_width": 0.0}, SceneError, "line_width must be positive"),
        ({"width": 0}, SceneError, "width must be an integer"),
        ({"color": "purple"}, SceneError, "color must be"),
        ({"hidden": "#12345"}, SceneError, "hidden must be"),
    ],
)
def test_what_cannot_be_is_refused(options: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        wireframe(scene_of(place(Box())), **{"width": 16, "height": 12, **options})


def test_nothing_has_no_lines() -> None:
    """An empty scene is paper."""
    assert (wireframe(Scene(), width=16, height=12).image().pixels == 1.0).all()
