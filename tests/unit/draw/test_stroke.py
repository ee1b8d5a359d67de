"""Strokes: areas that caps, joins and dashes must have."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from limner.curves import bezier
from limner.draw.canvas import Canvas
from limner.draw.path import Path
from limner.draw.stroke import Pen, dashed, segment_polygons, stroke_polygons
from limner.errors import SceneError, UnsupportedError

W = 6.0


def area(path: Path, pen: Pen, size: int = 48) -> float:
    """What a stroke covers, in pixels."""
    return float(Canvas(size, size).stroke(path, "white", pen).image().pixels[..., 3].sum(dtype=np.float64))


@pytest.mark.parametrize(("cap", "more"), [("butt", 0.0), ("square", W * W), ("round", math.pi * W * W / 4)])
def test_caps_have_their_areas(cap: str, more: float) -> None:
    """A slanted line of length 20: its rectangle, and half a square or half a disc more at each end."""
    line = Path().move_to(14.3, 17.1).line_to(30.3, 29.1)
    assert area(line, Pen(W, cap)) == pytest.approx(20.0 * W + more, abs=0.08)
    alone = segment_polygons(np.array([[14.3, 17.1, 30.3, 29.1]]), Pen(W, cap))
    np.testing.assert_allclose(
        Canvas(48, 48).segments([[14.3, 17.1, 30.3, 29.1]], "white", Pen(W, cap)).image().pixels,
        Canvas(48, 48).stroke(line, "white", Pen(W, cap)).image().pixels,
        atol=1e-5,
    )
    assert alone.shape[0] == 1


@pytest.mark.parametrize("turn_degrees", [20.0, 90.0, -90.0, 120.0, -150.0])
def test_joins_have_their_areas(turn_degrees: float) -> None:
    """Beyond two rectangles that overlap on the inner side: a triangle, a kite, a sector, from the turn alone."""
    turn = math.radians(turn_degrees)
    x, y, leg = 24.0, 24.0, 16.0
    path = Path().move_to(x - leg, y).line_to(x, y).line_to(x + leg * math.cos(turn), y + leg * math.sin(turn))
    h, a = W / 2, abs(turn)
    overlap = h * h * math.tan(a / 2)  # the kite where the rectangles lie one over the other
    outer = {"bevel": h * h * math.sin(a) / 2, "miter": h * h * math.tan(a / 2), "round": h * h * a / 2}
    for join, more in outer.items():
        assert area(path, Pen(W, join=join, miter_limit=20)) == pytest.approx(2 * leg * W - overlap + more, abs=0.06), join
    limited = area(path, Pen(W, join="miter", miter_limit=1.01 / math.cos(a / 2)))
    assert limited == pytest.approx(2 * leg * W - overlap + outer["miter"], abs=0.06)
    cut = area(path, Pen(W, join="miter", miter_limit=max(1.0, 0.99 / math.cos(a / 2))))
    expected = outer["bevel"] if 0.99 / math.cos(a / 2) > 1.0 else None
    if expected is not None:
        assert cut == pytest.approx(2 * leg * W - overlap + expected, abs=0.06)


def test_a_line_that_turns_back_has_a_round_join_and_no_miter() -> None:
    """A half turn: half a disc, or nothing."""
    path = Path().polyline([(10, 20), (30, 20), (12, 20)])
    assert area(path, Pen(W, join="round")) == pytest.approx(20 * W + math.pi * W * W / 8, abs=0.05)
    assert area(path, Pen(W, join="miter")) == pytest.approx(20 * W, abs=0.05)


def test_a_closed_line_is_joined_where_it_closes() -> None:
    """A square's outline with miters: the difference of two squares; without closing, two half squares less."""
    corners = [(12, 12), (36, 12), (36, 36), (12, 36)]
    assert area(Path().polyline(corners, closed=True), Pen(W)) == pytest.approx(30**2 - 18**2, abs=0.01)
    open_ = Path().polyline([*corners, corners[0]])
    assert area(open_, Pen(W)) == pytest.approx(30**2 - 18**2 - (W / 2) ** 2, abs=0.01)


def test_overlaps_within_a_stroke_are_painted_once() -> None:
    """A half transparent scribble that crosses itself has one alpha, and no seams where its pieces meet."""
    scribble = Path().polyline([(5, 5), (40, 40), (40, 5), (5, 40), (20, 2)])
    alpha = Canvas(48, 48).stroke(scribble, (1, 1, 1, 0.5), Pen(9, join="round")).image().pixels[..., 3]
    assert alpha.max() == pytest.approx(0.5, abs=1e-6)
    ring = Canvas(48, 48).circle(24, 24, 16, stroke=(1, 1, 1, 0.5), pen=8.0).image().pixels[..., 3]
    at = np.arange(48) - 24.0
    distance = np.hypot(at, at[:, None])
    np.testing.assert_allclose(ring[np.abs(distance - 16) < 3.2], 0.5, atol=1e-5)


def test_a_circle_s_stroke_has_the_ring_s_area() -> None:
    assert area(Path().circle(24, 24, 15), Pen(4)) == pytest.approx(math.pi * (17**2 - 13**2), rel=1e-3)


def test_a_curve_s_stroke_is_what_lies_within_half_a_width() -> None:
    """A cubic curve that turns twice, against the distance from its points at 16 x 16 places a pixel."""
    spatial = pytest.importorskip("scipy.spatial")
    control = np.array([(4, 4), (40, -3), (-4, 33), (28, 28)], dtype=float)
    path = Path().move_to(*control[0]).cubic_to(*control[1:].ravel())
    covered = Canvas(32, 32).stroke(path, "white", Pen(3.3, "round", "round")).image().pixels[..., 3]
    at = (np.arange(32 * 16) + 0.5) / 16 - 0.5
    places = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2)
    distance, _ = spatial.cKDTree(bezier.evaluate(control, np.linspace(0, 1, 4001))).query(places)
    expected = (distance <= 1.65).reshape(32, 16, 32, 16).mean(axis=(1, 3))
    assert np.abs(covered - expected).max() < 0.04


def test_dashes_are_where_they_should_be() -> None:
    """Lengths along a line with a corner; an odd pattern counts twice; an offset begins inside it."""
    chain = Path().polyline([(0, 0), (10, 0), (10, 10)]).flattened()[0]
    found = [dash.points.tolist() for dash in dashed(chain, Pen(dashes=(4, 3)))]
    assert found == [[[0, 0], [4, 0]], [[7, 0], [10, 0], [10, 1]], [[10, 4], [10, 8]]]
    shifted = [dash.points.tolist() for dash in dashed(chain, Pen(dashes=(4, 3), dash_offset=5))]
    assert shifted == [[[2, 0], [6, 0]], [[9, 0], [10, 0], [10, 3]], [[10, 6], [10, 10]]]
    odd = [dash.points.tolist() for dash in dashed(chain, Pen(dashes=(5,)))]
    assert odd == [[[0, 0], [5, 0]], [[10, 0], [10, 5]]]
    closed = Path().polyline([(0, 0), (6, 0), (6, 6), (0, 6)], closed=True).flattened()[0]
    assert [dash.points.tolist() for dash in dashed(closed, Pen(dashes=(12, 6)))] == [
        [[0, 0], [6, 0], [6, 6]],
        [[0, 6], [0, 0]],
    ]


def test_dots_are_dashes_of_no_length() -> None:
    """(0, gap) with round caps: discs a gap apart."""
    line = Path().move_to(8, 24).line_to(40, 24)
    assert area(line, Pen(4, "round", dashes=(0, 8))) == pytest.approx(4 * math.pi * 4, abs=0.2)
    assert stroke_polygons(line, Pen(4, "butt", dashes=(0, 8))) == []


def test_a_thin_line_is_faint() -> None:
    """A tenth of a pixel wide: a tenth of its length in all."""
    assert area(Path().move_to(5, 9).line_to(25, 9), Pen(0.1)) == pytest.approx(2.0, abs=1e-4)


@pytest.mark.parametrize(
    ("fields", "error", "message"),
    [
        ({"width": 0}, SceneError, "pen.width must be positive"),
        ({"width": math.nan}, SceneError, "pen.width"),
        ({"cap": "pointed"}, UnsupportedError, "butt, round, square"),
        ({"join": "none"}, UnsupportedError, "miter, round, bevel"),
        ({"miter_limit": 0.5}, SceneError, "at least 1"),
        ({"dashes": (1, -1)}, SceneError, "pen.dashes"),
        ({"dashes": (0, 0)}, SceneError, "pen.dashes"),
        ({"dash_offset": math.inf}, SceneError, "pen.dash_offset"),
    ],
)
def test_bad_pens_are_refused(fields: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        Pen(**fields)


def test_countless_dashes_are_refused() -> None:
    with pytest.raises(SceneError, match="too many pieces"):
        stroke_polygons(Path().move_to(0, 0).line_to(9e6, 0), Pen(dashes=(1e-3,)))
