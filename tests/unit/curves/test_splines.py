"""Splines of all kinds, against SciPy, de Boor's examples, and bad input."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from limner.curves import (
    bezier,
    bounds,
    bspline,
    catmull_rom,
    closest,
    continuity,
    flatten,
    hermite,
    intersect,
    natural,
    nurbs,
    offset,
    rational,
)
from limner.curves.curve import Parametric, Spline, composed
from limner.errors import SceneError, UnsupportedError

RNG = np.random.default_rng(3)
POINTS = RNG.uniform(-1, 1, (7, 2))


def test_against_scipy() -> None:
    """B-splines, their derivatives and basis; Bernstein polynomials; natural, clamped and closed cubics."""
    interpolate = pytest.importorskip("scipy.interpolate")
    u = np.linspace(0.0, 1.0, 41)
    for degree in (1, 2, 3, 5):
        knots = bspline.clamped_knots(7, degree)
        oracle = interpolate.BSpline(knots, POINTS, degree)
        np.testing.assert_allclose(bspline.evaluate(POINTS, u, knots, degree), oracle(u), atol=1e-13)
        for order in (1, 2):
            # At a knot where the derivative jumps SciPy takes the later piece too; the very end is the last one's
            np.testing.assert_allclose(bspline.derivative(POINTS, u, knots, degree, order), oracle(u, order), atol=1e-10)
    np.testing.assert_allclose(bezier.evaluate(POINTS, u), interpolate.BPoly(POINTS[:, None], [0.0, 1.0])(u), atol=1e-13)
    x = np.cumsum(RNG.uniform(0.2, 1.0, 7))
    s = np.linspace(x[0], x[-1], 50)
    given = natural.clamped(POINTS, [[1, 2], [-1, 0]], x)
    for made, kind in ((natural.natural(POINTS, x), "natural"), (given, ((1, [1, 2]), (1, [-1, 0])))):
        oracle = interpolate.CubicSpline(x, POINTS, bc_type=kind)
        np.testing.assert_allclose(made.at(s), oracle(s), atol=1e-12)
        np.testing.assert_allclose(made.derivative(s[:-1], 2), oracle(s[:-1], 2), atol=1e-10)
    ring = np.concatenate([POINTS[:-1], POINTS[:1]])
    np.testing.assert_allclose(natural.closed(POINTS[:-1], x).at(s), interpolate.CubicSpline(x, ring, bc_type="periodic")(s), atol=1e-12)
    control, knots = bspline.interpolate(POINTS, 3)
    t = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(POINTS, axis=0), axis=1))])
    np.testing.assert_allclose(bspline.evaluate(control, t / t[-1], knots), POINTS, atol=1e-12)


def test_the_natural_spline_is_the_one_that_bends_least() -> None:
    """The integral of its squared second derivative is below that of the cardinal curve and of a spline with other ends."""
    u = np.linspace(0, 6, 6001)[:-1]
    energy = [
        (curve.derivative(u, 2) ** 2).sum()
        for curve in (natural.natural(POINTS), catmull_rom.cardinal(POINTS), natural.clamped(POINTS, [[1, 0], [0, 1]]))
    ]
    assert energy[0] == min(energy)


def test_hermite_curves_have_their_points_tangents_and_accelerations() -> None:
    """Values and derivatives at the knots are what was given; the basis is that of the cubic."""
    tangents, bends = RNG.normal(size=(7, 2)), RNG.normal(size=(7, 2))
    knots = np.cumsum(RNG.uniform(0.5, 2.0, 7))
    cubic, quintic = hermite.spline(POINTS, tangents, knots), hermite.quintic(POINTS, tangents, bends, knots)
    for curve in (cubic, quintic):
        np.testing.assert_allclose(curve.at(knots), POINTS, atol=1e-12)
        np.testing.assert_allclose(curve.derivative(knots), tangents, atol=1e-12)
    np.testing.assert_allclose(quintic.derivative(knots, 2), bends, atol=1e-10)
    ends, slopes = hermite.to_hermite(cubic.pieces[0])
    h = knots[1] - knots[0]
    np.testing.assert_allclose(hermite.basis(0.3) @ [ends[0], slopes[0], ends[1], slopes[1]], cubic.at(knots[0] + 0.3 * h))


def test_centripetal_curves_have_no_loop_where_uniform_ones_do() -> None:
    """Yuksel's case: a short leg between long ones; the uniform curve crosses itself there."""
    points = [[0.0, 0.0], [3.0, 0.1], [3.1, 0.3], [0.2, 1.0]]
    piece = {alpha: catmull_rom.catmull_rom(points, alpha).pieces[1] for alpha in (0.0, 0.5)}

    def backs(control: np.ndarray) -> bool:
        along = bezier.derivative(control, np.linspace(0, 1, 200)) @ (control[3] - control[0])
        return bool((along < 0.0).any())

    assert backs(piece[0.0])
    assert not backs(piece[0.5])


def test_a_periodic_bspline_is_smooth_all_round() -> None:
    """C^(p-1) at every joint, that of the end and the start included."""
    for degree in (2, 3, 4):
        curve = bspline.periodic(POINTS, degree)
        assert [joint.parametric >= degree - 1 for joint in continuity.joints(curve, 1e-8, closed=True)] == [True] * 7


def test_a_nurbs_circle_of_nine_points() -> None:
    """Piegl and Tiller's: knots twice, weights 1 and sqrt(1/2): every point at distance 1; derivatives stand on the radius."""
    w = math.sqrt(0.5)
    control = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
    weights, knots = [1, w] * 4 + [1], [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
    u = np.linspace(0, 4, 57)
    points = nurbs.evaluate(control, weights, u, knots, 2)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, atol=1e-14)
    assert np.abs((points * nurbs.derivative(control, weights, u, knots, 2)).sum(axis=1)).max() < 1e-12
    np.testing.assert_allclose(nurbs.spline(control, weights, knots, 2).at(u), points, atol=1e-13)
    more = nurbs.insert(control, weights, knots, 2, [0.5, 2.5])
    np.testing.assert_allclose(nurbs.evaluate(more[0], more[1], u, more[2], 2), points, atol=1e-13)


def test_offsets_of_circles_are_circles_and_others_keep_their_distance() -> None:
    """To the tolerance; where the offset is farther than the bend is round, cusps are where 1 = d k."""
    made = offset.offset(nurbs.circle(2.0), 0.5, 1e-5)
    np.testing.assert_allclose(np.linalg.norm(made.at(np.linspace(0, 4, 99)), axis=1), 1.5, atol=2e-5)
    curve = Spline.bezier([[0, 0], [1, 2], [2, 0]])
    u = np.linspace(0.0, 1.0, 77)
    for distance in (-0.4, 0.3, 1.0):
        near = offset.offset(curve, distance, 1e-5)
        np.testing.assert_allclose(near.at(u), offset.offset_points(curve, u, distance), atol=1.2e-5)
    for point in offset.offset(curve, 0.1, 1e-5).at(u[5:-5]):
        assert closest.closest_point(curve, point).distance == pytest.approx(0.1, abs=2e-5)


def test_meetings_of_known_curves() -> None:
    """Two circles meet twice, a circle and a line through its middle twice, touching counts once, nine is the most of two cubics."""
    near = intersect.meetings(nurbs.circle(), nurbs.circle(1.0, (1.0, 0.0)))
    np.testing.assert_allclose(sorted(m.point[1] for m in near), [-math.sqrt(0.75), math.sqrt(0.75)], atol=1e-12)
    np.testing.assert_allclose([m.point[0] for m in near], 0.5, atol=1e-12)
    assert len(intersect.meetings(nurbs.circle(), Spline.bezier([[-2, 0], [2, 0]]))) == 2
    (touching,) = intersect.crossings([[0, 0], [1, 2], [2, 0]], [[0, 1], [2, 1]])
    np.testing.assert_allclose(touching.point, (1.0, 1.0), atol=1e-6)
    # Chebyshev's cubic and its mirror image: T3(T3(x)) = x has nine solutions, the cosines of their angles
    wave = np.array([[-1.0, -1.0], [-1 / 3, 5.0], [1 / 3, -5.0], [1.0, 1.0]])
    nine = intersect.crossings(wave, wave[:, ::-1])
    cosines = np.cos(np.pi * np.array([0, 1 / 5, 1 / 4, 2 / 5, 1 / 2, 3 / 5, 3 / 4, 4 / 5, 1]))
    np.testing.assert_allclose([m.point[0] for m in nine], cosines[::-1], atol=1e-9)
    assert intersect.crossings([[0, 0], [1, 0]], [[0, 1], [1, 1]]) == []
    with pytest.raises(SceneError, match="in common"):
        intersect.crossings(wave, wave)


def test_inflections_and_turning_points() -> None:
    """A cubic with a cusp, one with two inflections, a parabola with none."""
    assert bounds.inflections([[0, 0], [1, 1], [2, 0]]).size == 0
    assert len(bounds.inflections([[0, 0], [3, 3], [-2, 1], [1, 0]])) in (0, 2)
    np.testing.assert_allclose(bounds.turning_points([[0, 0], [1, 2], [2, 0]]), [0.5])
    low, high = bounds.spline_box(nurbs.circle(2.0, (1.0, 0.0)))
    np.testing.assert_allclose([low, high], [(-1, -2), (3, 2)], atol=1e-12)


def test_any_curve_is_flattened() -> None:
    """A rational circle, and a function of which nothing is known: chords stay within the tolerance of the circle."""
    spiral = Parametric(lambda u: np.stack([u * np.cos(u), u * np.sin(u)], axis=-1), 0.0, 20.0)
    for curve, tolerance in ((nurbs.circle(), 1e-4), (spiral, 1e-3)):
        u = flatten.parameters_of(curve, tolerance)
        middle = 0.5 * (u[1:] + u[:-1])
        gap = np.linalg.norm(0.5 * (curve.at(u[1:]) + curve.at(u[:-1])) - curve.at(middle), axis=1)
        assert gap.max() < 1.1 * tolerance + 1e-3 * np.diff(u).max()
        assert len(u) < 1200
    assert flatten.chords([[0, 0], [1, 1]], 0.1) == 1


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: bspline.evaluate(POINTS[:3], 0.5), "at least 4 control points"),
        (lambda: bspline.evaluate(POINTS, 1.5), "parameter must lie in"),
        (lambda: bspline.evaluate(POINTS, math.nan), "parameter must lie in"),
        (lambda: bspline.evaluate(POINTS, 0.5, [0] * 5 + [1] * 6), "repeated beyond the order 4"),
        (lambda: bspline.evaluate(POINTS, 0.5, np.arange(11.0)[::-1]), "must not decrease"),
        (lambda: bspline.evaluate(POINTS, 0.5, np.arange(9.0)), "need 11 knots"),
        (lambda: bspline.spline([[0, 0], [math.nan, 1], [2, 2], [3, 3]]), "must be finite"),
        (lambda: nurbs.evaluate(POINTS, np.zeros(7), 0.5), "weights must be positive"),
        (lambda: rational.evaluate(POINTS, np.ones(3), 0.5), "one weight for each"),
        (lambda: catmull_rom.catmull_rom([[0, 0], [0, 0], [1, 1]]), "must differ"),
        (lambda: catmull_rom.catmull_rom([[0, 0]]), "at least 2"),
        (lambda: catmull_rom.catmull_rom(POINTS, 2.0), "alpha"),
        (lambda: natural.natural(POINTS, [0, 1, 1, 2, 3, 4, 5]), "increase"),
        (lambda: hermite.spline(POINTS, POINTS[:3]), "one tangent for each"),
        (lambda: bezier.evaluate(POINTS, [0.5, math.nan]), "parameter"),
        (lambda: bezier.evaluate([["a", "b"]], 0.5), "numbers"),
        (lambda: bezier.reduce(POINTS[:2]), "cannot be reduced"),
        (lambda: Spline.bezier(POINTS).at(1.2), "parameter must lie in"),
        (lambda: Spline(np.array([0.0, 0.0]), POINTS[None]), "increase"),
        (lambda: Parametric(lambda u: u, 0.0, 1.0).at(0.5), "must return shape"),
        (lambda: composed(Spline.bezier(POINTS), lambda s: 3.0 * s, 0.0, 1.0).at(1.0), "parameter must lie in"),
        (lambda: closest.closest_point(Spline.bezier(POINTS), (1.0, 2.0, 3.0)), "target"),
        (lambda: flatten.bezier_parameters(POINTS, 0.0), "tolerance"),
        (lambda: offset.offset(Spline.bezier(POINTS), math.nan), "distance"),
    ],
)
def test_bad_input_is_refused_in_a_line(call: Callable[[], object], words: str) -> None:
    """What, where, and what was expected."""
    with pytest.raises((SceneError, UnsupportedError), match=words) as caught:
        call()
    assert "\n" not in str(caught.value)
