"""What holds for all curves: sums of one, hulls, affine maps, parts and elevations that draw the same, derivatives, joints."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from limner.curves import bernstein, bezier, bounds, bspline, catmull_rom, closest, continuity, flatten, intersect, natural, nurbs, rational
from limner.curves.arc_length import ArcLength, length
from limner.curves.curve import Spline, backwards, composed, on_unit_interval

Floats = NDArray[np.float64]

number = st.floats(-10.0, 10.0).map(lambda x: round(x, 3))
share = st.floats(0.0, 1.0)
seeds = st.integers(0, 10_000)


def controls(least: int = 1, most: int = 7, dimension: int = 2) -> st.SearchStrategy[Floats]:
    return st.integers(least, most).flatmap(lambda n: arrays(np.float64, (n, dimension), elements=number))


def random_points(seed: int, n: int, dimension: int = 2) -> Floats:
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (n, dimension))


# --- Bernstein and Bézier -------------------------------------------------------------------------------------------------


@given(st.integers(0, 1500), share)
def test_basis_is_a_partition_of_unity_at_any_degree(degree: int, u: float) -> None:
    """Not negative, with a sum of one, beyond the degree at which binomials overflow too."""
    made = bernstein.basis(degree, u)
    assert (made >= 0.0).all()
    assert made.sum() == pytest.approx(1.0, abs=1e-11)


@settings(max_examples=8)
@given(st.integers(1, 60), st.fractions(0, 1, max_denominator=64), seeds)
def test_high_degrees_are_stable(degree: int, u: Fraction, seed: int) -> None:
    """Against rational numbers: the error is some roundings of the greatest control point, at degree 60 as at degree 1."""
    points = random_points(seed, degree + 1, 1)
    exact = sum(math.comb(degree, k) * u**k * (1 - u) ** (degree - k) * Fraction(float(p)) for k, p in enumerate(points[:, 0]))
    assert bezier.evaluate(points, float(u))[0] == pytest.approx(float(exact), abs=1e-14)


@given(controls(2), share, st.integers(0, 4))
def test_elevation_leaves_the_curve_and_shortens_the_polygon(points: Floats, u: float, times: int) -> None:
    """More control points, the same points on the curve, a polygon between the old one and the curve."""
    raised = bezier.elevate(points, times)
    assert len(raised) == len(points) + times
    np.testing.assert_allclose(bezier.evaluate(raised, u), bezier.evaluate(points, u), atol=1e-11)
    legs = [np.linalg.norm(np.diff(p, axis=0), axis=1).sum() for p in (raised, points)]
    assert legs[0] <= legs[1] * (1.0 + 1e-12) + 1e-12


@given(controls(3), st.integers(1, 3))
def test_reduction_undoes_elevation(points: Floats, times: int) -> None:
    """Exactly, and says that it is exact."""
    made, error = bezier.reduce(bezier.elevate(points, times), times)
    np.testing.assert_allclose(made, points, atol=1e-7)
    assert error < 1e-8


@given(controls(3, 7), share)
def test_reduction_errs_by_no_more_than_it_says(points: Floats, u: float) -> None:
    """Points of the same parameter are no farther apart than the bound; the ends stay."""
    made, error = bezier.reduce(points)
    assert np.linalg.norm(bezier.evaluate(made, u) - bezier.evaluate(points, u)) <= error + 1e-10
    np.testing.assert_array_equal(made[[0, -1]], points[[0, -1]])


@given(controls(1, 9), share)
def test_powers_and_back(points: Floats, u: float) -> None:
    """Horner's rule on the powers gives the curve; their control points are the old ones."""
    coefficients = bezier.to_power(points)
    value = np.zeros(2)
    for row in coefficients[::-1]:
        value = value * u + row
    np.testing.assert_allclose(value, bezier.evaluate(points, u), atol=1e-9)
    np.testing.assert_allclose(bezier.from_power(coefficients), points, atol=1e-9)


@given(controls(), share, share, share)
def test_parts_draw_the_same_curve(points: Floats, start: float, end: float, s: float) -> None:
    """g(s) = f(start + (end - start) s), backwards too."""
    part = bezier.restrict(points, start, end)
    np.testing.assert_allclose(bezier.evaluate(part, s), bezier.evaluate(points, start + (end - start) * s), atol=1e-11)


@given(controls(1, 6), share)
def test_the_construction_ends_on_the_curve(points: Floats, u: float) -> None:
    """Each level has one point less, and its edges are the control points of both parts."""
    levels = bezier.construction(points, u)
    assert [len(level) for level in levels] == list(range(len(points), 0, -1))
    left, right = bezier.split(points, u)
    np.testing.assert_array_equal(left, [level[0] for level in levels])
    np.testing.assert_array_equal(right[::-1], [level[-1] for level in levels])


@given(controls(2, 6), st.integers(0, 4), share)
def test_higher_derivatives_are_those_of_the_powers(points: Floats, order: int, u: float) -> None:
    """Each coefficient times its falling factorial."""
    coefficients = bezier.to_power(points)
    expected = sum((math.perm(k, order) * u ** (k - order) * row for k, row in enumerate(coefficients) if k >= order), np.zeros(2))
    np.testing.assert_allclose(bezier.derivative(points, u, order), expected, atol=1e-7)


@given(controls(1, 7), share)
def test_the_box_is_tight_and_the_hull_holds_the_curve(points: Floats, u: float) -> None:
    """No point is outside of either; the box is touched on all sides by points of the curve."""
    low, high = bounds.box(points)
    p = bezier.evaluate(points, u)
    assert (p >= low - 1e-7).all()
    assert (p <= high + 1e-7).all()
    corners = bounds.hull(points)
    if len(corners) > 2:
        a, b = corners, np.roll(corners, -1, axis=0)
        cross = (b[:, 0] - a[:, 0]) * (p[1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (p[0] - a[:, 0])
        assert (cross >= -1e-9 * 400).all()
    dense = bezier.evaluate(points, np.linspace(0, 1, 513))
    size = float(np.ptp(points, axis=0).max())
    np.testing.assert_allclose(dense.min(axis=0), low, atol=1e-3 * size + 1e-12)
    np.testing.assert_allclose(dense.max(axis=0), high, atol=1e-3 * size + 1e-12)


@given(st.lists(st.floats(0.02, 0.98), min_size=1, max_size=5, unique=True))
def test_roots_are_all_found(places: list[float]) -> None:
    """A polynomial made of its roots, as a product of its factors in the Bernstein basis."""
    places = sorted(places)
    if min(np.diff(places), default=1.0) < 0.02:
        return
    made = np.array([1.0])
    for place in places:
        made = bernstein.product(made, [-place, 1.0 - place])
    np.testing.assert_allclose(bernstein.roots(made), places, atol=1e-8)


@given(controls(2, 5), st.floats(1e-4, 0.1))
def test_chords_stray_by_no_more_than_the_tolerance(points: Floats, tolerance: float) -> None:
    """Looked at in many places of each chord."""
    u = flatten.bezier_parameters(points, tolerance)
    inner = np.linspace(0, 1, 9)[1:-1]
    a, b = bezier.evaluate(points, u[:-1])[:, None], bezier.evaluate(points, u[1:])[:, None]
    seen = bezier.evaluate(points, u[:-1, None] + np.diff(u)[:, None] * inner)
    off = np.linalg.norm(seen - (a + (b - a) * inner[:, None]), axis=2).max()
    assert off <= tolerance + 1e-12


@given(seeds, share)
def test_weights_that_are_equal_change_nothing_and_affine_maps_pass_through(seed: int, u: float) -> None:
    """Of rational curves: the shadow of the lifted curve."""
    points, weights = random_points(seed, 4), np.random.default_rng(seed).uniform(0.2, 5.0, 4)
    np.testing.assert_allclose(rational.evaluate(points, np.full(4, 3.0), u), bezier.evaluate(points, u), atol=1e-13)
    matrix, shift = np.array([[1.0, 2.0], [-0.5, 1.5]]), np.array([3.0, -1.0])
    moved = rational.evaluate(points @ matrix.T + shift, weights, u)
    np.testing.assert_allclose(moved, rational.evaluate(points, weights, u) @ matrix.T + shift, atol=1e-12)
    raised = rational.elevate(points, weights, 2)
    np.testing.assert_allclose(rational.evaluate(*raised, u), rational.evaluate(points, weights, u), atol=1e-12)
    step = 1e-5
    s = min(max(u, 2 * step), 1 - 2 * step)
    expected = (rational.evaluate(points, weights, s + step) - rational.evaluate(points, weights, s - step)) / (2 * step)
    np.testing.assert_allclose(rational.derivative(points, weights, s), expected, atol=1e-5, rtol=1e-5)


# --- splines --------------------------------------------------------------------------------------------------------------


@given(seeds, st.integers(1, 5), st.integers(0, 4), share)
def test_bsplines_are_their_bezier_pieces_and_keep_when_knots_are_inserted(seed: int, degree: int, more: int, s: float) -> None:
    """Three roads to the same point; the basis has no negative value and a sum of one."""
    rng = np.random.default_rng(seed)
    control = random_points(seed, degree + 1 + more)
    knots = np.sort(np.round(rng.uniform(0, 1, len(control) + degree + 1), 2))
    if knots[degree] >= knots[len(control)] or np.unique(knots, return_counts=True)[1].max() > degree + 1:
        return
    u = knots[degree] + s * (knots[len(control)] - knots[degree])
    point = bspline.evaluate(control, u, knots, degree)
    np.testing.assert_allclose(bspline.spline(control, knots, degree).at(u), point, atol=1e-11)
    weights = bspline.basis(knots, degree, u)
    assert weights.min() >= -1e-12
    np.testing.assert_allclose(weights @ control, point, atol=1e-11)
    assert weights.sum() == pytest.approx(1.0)
    place = 0.37 * knots[degree] + 0.63 * knots[len(control)]
    more_control, more_knots = bspline.insert(control, knots, degree, [place])
    np.testing.assert_allclose(bspline.evaluate(more_control, u, more_knots, degree), point, atol=1e-10)


@given(seeds, st.integers(3, 8), st.booleans())
def test_interpolating_curves_go_through_their_points_as_smoothly_as_promised(seed: int, n: int, closed: bool) -> None:
    """Catmull-Rom of all kinds and cardinal C1, natural C2: measured at every joint."""
    points = random_points(seed, n)
    made = [(catmull_rom.catmull_rom(points, alpha, closed), 1) for alpha in (0.0, 0.5, 1.0)]
    made.append((catmull_rom.cardinal(points, 0.3, closed), 1))
    made.append((natural.closed(points) if closed else natural.natural(points), 2))
    for spline, order in made:
        np.testing.assert_allclose(spline.at(spline.knots[: len(points)]), points, atol=1e-12)
        for joint in continuity.joints(spline, 1e-7, closed):
            assert min(joint.parametric, order) == order
            assert joint.geometric >= min(order, 2)


@given(seeds, st.integers(3, 6), st.integers(0, 3), st.floats(0.3, 3.0), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_curves_go_on_as_smoothly_as_asked(seed: int, degree: int, order: int, b1: float, b2: float, b3: float) -> None:
    """With betas G^n, and the betas are measured again; without them C^n."""
    left = random_points(seed, 5)
    free = random_points(seed + 1, degree + 1)
    plain = np.concatenate([continuity.continued(left, order, degree), free[order + 1 :]])
    bent = np.concatenate([continuity.continued(left, order, degree, (b1, b2, b3)), free[order + 1 :]])
    first, second = (continuity.between(Spline.bezier(left), Spline.bezier(right), 3, 1e-7) for right in (plain, bent))
    assert first.parametric >= min(order, degree)
    assert second.geometric >= min(order, 2)
    if order >= 2:
        assert second.beta1 == pytest.approx(b1, rel=1e-7)
        assert second.beta2 == pytest.approx(b2, abs=1e-5)


@given(seeds, st.integers(0, 3))
def test_links_are_smooth_at_both_ends(seed: int, order: int) -> None:
    """The curve between two has as many derivatives in common with both."""
    left, right = random_points(seed, 5), random_points(seed + 1, 4)
    chain = Spline.joined([left, continuity.linked(left, right, order), right])
    assert all(joint.parametric >= order for joint in continuity.joints(chain, 1e-7))


# --- along a curve --------------------------------------------------------------------------------------------------------


@settings(max_examples=20)
@given(seeds, st.integers(2, 5))
def test_lengths_and_parameters_are_inverse(seed: int, n: int) -> None:
    """parameter(at(u)) = u, the parts sum to the whole, and no chord is longer than its arc."""
    curve = catmull_rom.catmull_rom(random_points(seed, n))
    even = ArcLength(curve, 1e-9)
    s = np.linspace(0.0, even.length, 9)
    u = even.parameter(s)
    np.testing.assert_allclose(even.at(u), s, atol=1e-8 * even.length)
    parts = [length(curve, a, b, 1e-10) for a, b in itertools.pairwise(u)]
    np.testing.assert_allclose(parts, even.length / 8.0, rtol=1e-6)
    assert (np.linalg.norm(np.diff(curve.at(u), axis=0), axis=1) <= np.array(parts) * (1.0 + 1e-7)).all()


@settings(max_examples=25)
@given(seeds)
def test_another_parameter_is_the_same_curve(seed: int) -> None:
    """Composition, the unit interval, backwards: lengths stay, derivatives follow the chain rule."""
    curve = natural.natural(random_points(seed, 4))
    squared = composed(curve, lambda s: 3.0 * s * s, 0.0, 1.0, (lambda s: 6.0 * s, lambda s: 6.0 + 0.0 * s))
    numeric = composed(curve, lambda s: 3.0 * s * s, 0.0, 1.0)
    s = np.array([0.2, 0.45, 0.9])
    np.testing.assert_allclose(squared.derivative(s, 1), numeric.derivative(s, 1), atol=1e-2, rtol=1e-2)
    for other in (squared, on_unit_interval(curve), backwards(curve)):
        assert length(other, tolerance=1e-8) == pytest.approx(length(curve), rel=1e-6)
    np.testing.assert_allclose(backwards(curve).at(0.25), curve.at(2.25), atol=1e-13)


# --- finding --------------------------------------------------------------------------------------------------------------


@settings(max_examples=30)
@given(seeds, number, number, st.booleans())
def test_the_closest_point_is_closer_than_all_others(seed: int, x: float, y: float, weighted: bool) -> None:
    """Against two thousand points of the curve."""
    points = random_points(seed, 4) * 5.0
    curve = Spline.bezier(points, np.random.default_rng(seed).uniform(0.3, 3.0, 4) if weighted else None)
    found = closest.closest_point(curve, (x, y))
    assert found.distance == pytest.approx(np.linalg.norm(curve.at(found.u) - (x, y)))
    assert found.distance <= np.linalg.norm(curve.at(np.linspace(0, 1, 2001)) - (x, y), axis=1).min() + 1e-12


@settings(max_examples=30)
@given(seeds)
def test_all_crossings_are_found(seed: int) -> None:
    """Against the crossings of two hundred and fifty chords each, but for nearly parallel ones: none is missed, all are some."""
    a, b = random_points(seed, 4), random_points(seed + 7, 4)
    found = intersect.crossings(a, b)
    for meeting in found:
        np.testing.assert_allclose(bezier.evaluate(a, meeting.u), bezier.evaluate(b, meeting.v), atol=1e-10)
    u = np.linspace(0, 1, 251)
    p, q = bezier.evaluate(a, u), bezier.evaluate(b, u)
    d, e = np.diff(p, axis=0)[:, None], np.diff(q, axis=0)[None]
    cross = d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0]
    gap = q[None, :-1] - p[:-1, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = (gap[..., 0] * e[..., 1] - gap[..., 1] * e[..., 0]) / cross, (gap[..., 0] * d[..., 1] - gap[..., 1] * d[..., 0]) / cross
    i, j = np.nonzero((s >= 0.0) & (s < 1.0) & (t >= 0.0) & (t < 1.0))
    sharp = np.abs(cross[i, j]) > 0.02 * np.linalg.norm(d[i, 0], axis=1) * np.linalg.norm(e[0, j], axis=1)
    for k in np.flatnonzero(sharp).tolist():
        assert any(abs(m.u * 250 - (i[k] + s[i[k], j[k]])) < 1.0 and abs(m.v * 250 - (j[k] + t[i[k], j[k]])) < 1.0 for m in found)


@settings(max_examples=20)
@given(st.floats(0.1, 3.0), st.floats(-1.0, 1.0), st.floats(0.05, 6.2))
def test_arcs_are_exact_circles(radius: float, start: float, sweep: float) -> None:
    """Every point at the radius, and the length that of the arc."""
    arc = nurbs.circle_arc(start, sweep, radius, (2.0, -1.0))
    u = np.linspace(0.0, arc.knots[-1], 33)
    np.testing.assert_allclose(np.linalg.norm(arc.at(u) - (2.0, -1.0), axis=1), radius, rtol=1e-12)
    assert length(arc) == pytest.approx(radius * sweep, rel=1e-9)
