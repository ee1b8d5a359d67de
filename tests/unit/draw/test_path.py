"""Paths and how they become straight lines."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.curves import bezier
from limner.draw.path import Path, signed_area
from limner.errors import SceneError


def test_flattened_curves_stay_within_the_tolerance() -> None:
    """Points of a cubic curve lie nearer to its chords than the tolerance, and not far more chords are spent than needed."""
    control = np.array([(0, 0), (120, -40), (-30, 130), (90, 80)], dtype=float)
    path = Path().move_to(*control[0]).cubic_to(*control[1:].ravel())
    curve = bezier.evaluate(control, np.linspace(0, 1, 5001))
    counts = []
    for tolerance in (1.0, 0.1, 0.01):
        chain = path.flattened(tolerance)[0].points
        start, way = chain[:-1], np.diff(chain, axis=0)
        t = np.clip(((curve[:, None] - start) * way).sum(2) / (way * way).sum(1), 0, 1)
        distance = np.linalg.norm(curve[:, None] - start - t[..., None] * way, axis=2).min(1)
        assert 0.05 * tolerance < distance.max() <= tolerance
        counts.append(len(chain))
    assert counts[2] < 12 * counts[0]  # the number grows with the root


def test_quadratic_curves_are_their_cubics() -> None:
    chain = Path().move_to(0, 0).quadratic_to(10, 20, 30, 0).flattened(1e-3)[0].points
    u = np.arange(len(chain)) / (len(chain) - 1)
    np.testing.assert_allclose(chain, bezier.evaluate([(0, 0), (10, 20), (30, 0)], u), atol=1e-12)


def test_ellipses_and_arcs_lie_on_their_equation() -> None:
    """x^2/a^2 + y^2/b^2 = 1 in the ellipse's own axes; the start and the end are where they were asked for."""
    points = Path().ellipse(3, 4, 9, 5, rotation=0.7).flattened()[0].points - (3, 4)
    c, s = math.cos(0.7), math.sin(0.7)
    own = points @ np.array([[c, -s], [s, c]])
    np.testing.assert_allclose((own[:, 0] / 9) ** 2 + (own[:, 1] / 5) ** 2, 1.0)
    arc = Path().arc(0, 0, 2, 2, 0.0, math.pi / 2).flattened()[0].points
    np.testing.assert_allclose(arc[[0, -1]], [(2, 0), (0, 2)], atol=1e-12)
    assert (arc[:, 1] >= 0).all()  # from +x towards +y


def test_holes_turn_against_their_outline() -> None:
    """Whichever way they were given."""
    square = np.array([(0, 0), (9, 0), (9, 9), (0, 9)], dtype=float)
    for outline in (square, square[::-1]):
        for hole in (square / 3 + 1, square[::-1] / 3 + 1):
            first, second = Path().polygon(outline, [hole]).flattened()
            assert signed_area(first.points) * signed_area(second.points) < 0


def test_rounded_rectangles_have_their_area_and_bounds() -> None:
    chain = Path().rectangle(1, 2, 20, 10, radius=3).flattened(1e-4)[0].points
    assert signed_area(chain) == pytest.approx(200 - (4 - math.pi) * 9, abs=1e-2)
    np.testing.assert_allclose([chain.min(0), chain.max(0)], [(1, 2), (21, 12)], atol=1e-12)


def test_a_closed_path_goes_on_where_it_began() -> None:
    path = Path().move_to(1, 1).line_to(5, 1).line_to(5, 5).close().line_to(0, 9)
    assert [chain.points.tolist() for chain in path.flattened()][1] == [[1, 1], [0, 9]]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: Path().line_to(1, 2), "must begin with move_to"),
        (lambda: Path().move_to(math.nan, 0), "must be finite"),
        (lambda: Path().polyline([(1, 2, 3)]), r"shape \(n, 2\)"),
        (lambda: Path().circle(0, 0, -1), "must not be negative"),
        (lambda: Path().arc(0, 0, 1, 1, math.inf, 1), "angles of an arc must be finite"),
        (lambda: Path().rectangle(0, 0, -1, 1), "must not be negative"),
        (lambda: Path().polyline("zigzag"), "pairs of numbers"),
    ],
)
def test_bad_calls_say_what_is_wrong(wrong, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        wrong()
