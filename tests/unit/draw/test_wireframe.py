"""Lines in space before and behind surfaces."""

from __future__ import annotations

import numpy as np
import pytest

from limner.draw.canvas import Canvas
from limner.draw.wireframe import Seen, draw_wireframe, visible_segments
from limner.errors import SceneError
from limner.linear.project import Lens, intrinsics
from limner.scene.camera import OrthographicCamera, PerspectiveCamera

W, H = 64, 48
EYE = np.eye(4)  # looks along -z
K = intrinsics(Lens(0.75), W, H)


def plane(depth: float, columns: slice = slice(None)) -> np.ndarray:
    """A depth picture: a wall across some columns, nothing elsewhere."""
    made = np.full((H, W), np.inf, dtype=np.float32)
    made[:, columns] = depth
    return made


def seen(starts: object, ends: object, **how: object) -> Seen:
    fields = {"perspective": True, "width": W, "height": H, **how}
    return visible_segments(starts, ends, EYE, K, **fields)  # type: ignore[arg-type]


def test_a_line_goes_into_a_wall_where_its_depth_says() -> None:
    """From depth 1 to 10, a wall at 2: on the screen 1/depth is even, so (1 - 1/2) / (1 - 1/10) of its way is seen."""
    found = seen([(-0.5, 0.1, -1)], [(8.0, 0.1, -10)], depth=plane(2.0))
    assert found.visible.tolist() == [True, False]
    start, end = found.lines[0, 0], found.lines[1, 2]
    share = (found.lines[0, 2] - start) / (end - start)
    assert share == pytest.approx((1 - 1 / 2) / (1 - 1 / 10), abs=0.02)


def test_in_parallel_projection_depth_itself_is_even() -> None:
    camera = OrthographicCamera(height=4.0)
    found = visible_segments(
        [(-2, 0, -1)], [(2, 0, -10)], EYE, camera.intrinsics(W, H), perspective=False, width=W, height=H, depth=plane(2.0)
    )
    assert found.visible.tolist() == [True, False]
    share = (found.lines[0, 2] - found.lines[0, 0]) / (found.lines[1, 2] - found.lines[0, 0])
    assert share == pytest.approx(1 / 9, abs=0.02)


def test_a_line_behind_a_pillar_is_cut_in_three() -> None:
    """Seen, hidden, seen: the cuts lie within a pixel of the pillar's sides; before the pillar it is whole."""
    behind = seen([(-2, 0, -4)], [(2, 0, -4)], depth=plane(3.0, slice(20, 40)))
    assert behind.visible.tolist() == [True, False, True]
    assert behind.lines[1, 0] == pytest.approx(19.5, abs=1.01)
    assert behind.lines[1, 2] == pytest.approx(39.5, abs=1.01)
    assert behind.source.tolist() == [0, 0, 0]
    assert seen([(-1, 0, -2)], [(1, 0, -2)], depth=plane(3.0, slice(20, 40))).visible.tolist() == [True]


def test_lines_on_a_surface_are_seen() -> None:
    """On a slanted wall that fills the picture, however steep, also along a valley between two walls."""
    x = np.arange(W) - K[0, 2]
    for steepness in (0.0, 0.5, 5.0):
        depth = np.broadcast_to(1.0 / (0.25 + steepness * 1e-3 * x), (H, W)).astype(np.float32)

        def on_wall(i: float, j: float, slope: float = steepness) -> tuple[float, float, float]:
            d = 1.0 / (0.25 + slope * 1e-3 * (i - K[0, 2]))
            return (i - K[0, 2]) / K[0, 0] * d, -(j - K[1, 2]) / K[1, 1] * d, -d

        starts, ends = [(5.3, 7.1), (30.5, 2), (1, 20.5)], [(50.2, 40.6), (30.5, 45), (60, 20.5)]
        found = seen([on_wall(*start) for start in starts], [on_wall(*end) for end in ends], depth=depth)
        assert found.visible.all(), steepness
    valley = np.broadcast_to(4.0 - 0.03 * np.abs(np.arange(W) - 31.5), (H, W)).astype(np.float32)
    z = -4.0
    up = [((31.5 - K[0, 2]) / K[0, 0] * 4.0, y, z) for y in (-1.0, 1.0)]
    assert seen(up[:1], up[1:], depth=valley).visible.all()


def test_what_is_behind_the_eye_is_cut_off() -> None:
    """A line past the eye keeps its part in front, to the border; one behind it vanishes, and so does what is no number."""
    starts, ends = [(0.5, 0, -2), (0, 0, 1), (0, 0, -1)], [(0.5, 0, 3), (1, 0, 2), (np.nan, 0, -1)]
    found = seen(starts, ends)
    assert found.source.tolist() == [0]
    assert found.lines[0, 0] == pytest.approx(K[0, 0] * 0.25 + K[0, 2])
    assert W <= found.lines[0, 2] <= W + 10
    assert np.isfinite(found.lines).all()


def test_lines_are_cut_to_the_picture() -> None:
    """Ends lie within a few pixels of it; what is inside is the same line."""
    found = seen([(-1000, -500, -3)], [(1000, 500, -3)])
    assert (np.abs(found.lines - (W / 2, H / 2, W / 2, H / 2)) <= (W / 2 + 9, H / 2 + 9, W / 2 + 9, H / 2 + 9)).all()
    (x0, y0, x1, y1) = found.lines[0]
    assert (y1 - y0) / (x1 - x0) == pytest.approx(-0.5)


def test_hidden_lines_are_left_out_or_drawn_otherwise() -> None:
    found = seen([(-2, 0, -4)], [(2, 0, -4)], depth=plane(3.0, slice(20, 40)))
    alone = draw_wireframe(Canvas(W, H), found, "white", 2).image().pixels[..., 3]
    row = int(K[1, 2])
    assert alone[row, 17] > 0.9
    assert not alone[:, 24:36].any()
    both = draw_wireframe(Canvas(W, H), found, "white", 2, hidden=(1, 0, 0, 0.5), hidden_pen=2).image().pixels
    assert both[row, 30].tolist() == pytest.approx([1, 0, 0, 0.5])


@pytest.mark.compiled
def test_a_box_hides_three_of_its_edges() -> None:
    """From above a corner: the nine edges that touch a visible face are seen whole, the other three not at all."""
    import limner
    from limner.linear.projection import camera_from_world
    from limner.scene.light import AmbientLight

    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    edges = np.array([(a, b) for a in range(8) for b in range(a) if (corners[a] != corners[b]).sum() == 1])
    for camera, perspective in (
        (PerspectiveCamera.look_at((4, 3, 5), (0, 0, 0), yfov_degrees=35), True),
        (OrthographicCamera.look_at((4, 3, 5), (0, 0, 0), height=4.2), False),
    ):
        node = limner.Node(shapes=(limner.Shape(limner.Box((2, 2, 2))),), lights=(AmbientLight(),))
        image = limner.render(limner.Scene(node, camera=camera), width=160, height=120, aovs=("depth",))
        found = visible_segments(
            corners[edges[:, 0]], corners[edges[:, 1]], camera_from_world(camera), camera.intrinsics(160, 120),
            perspective=perspective, width=160, height=120, depth=image.aov["depth"],
        )  # fmt: skip
        length = np.linalg.norm(found.lines[:, 2:] - found.lines[:, :2], axis=1)
        behind = (corners[edges] == (-1, -1, -1)).all(axis=2).any(axis=1)
        assert behind.sum() == 3
        for k in range(12):
            share = length[(found.source == k) & found.visible].sum() / length[found.source == k].sum()
            assert share > 0.999 if not behind[k] else share < 0.06, (k, share)


@pytest.mark.parametrize(
    ("starts", "how", "message"),
    [
        ([(0, 0)], {}, r"starts must have shape \(n, 3\)"),
        ([(0, 0, -1), (0, 0, -2)], {}, "as many, got 2 and 1"),
        ([(0, 0, -1)], {"depth": np.ones((2, 2))}, r"depth must have shape \(48, 64\)"),
        ([(0, 0, -1)], {"near": 0.0}, "near must be positive"),
        ([(0, 0, -1)], {"width": 0}, "width must be an integer"),
    ],
)
def test_bad_calls_say_what_is_wrong(starts: object, how: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        seen(starts, [(1, 1, -1)], **how)


def test_no_lines_are_no_lines() -> None:
    assert len(seen([], [], depth=plane(1.0)).lines) == 0
