"""Lengths, curvatures, frames and continuity against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.curves import arc_length, continuity, easing, frames, nurbs
from limner.curves.arc_length import ArcLength, length
from limner.curves.curve import Parametric, Spline, composed
from limner.errors import SceneError

Floats = NDArray[np.float64]

CYCLOID = Parametric(lambda u: np.stack([u - np.sin(u), 1.0 - np.cos(u)], axis=-1), 0.0, 4.0 * math.pi)
A, B = 2.0, 0.5
HELIX = Parametric(lambda u: np.stack([A * np.cos(u), A * np.sin(u), B * u], axis=-1), 0.0, 10.0)


def test_the_rules_integrate_polynomials_of_their_degrees() -> None:
    """Kronrod's rule of fifteen nodes is exact up to degree 22, Gauss's of seven up to 13; no digit of them is wrong."""
    for weights, degree in ((arc_length._KRONROD, 22), (arc_length._GAUSS, 13)):
        for k in range(degree + 1):
            assert weights @ arc_length._NODES**k == pytest.approx((1 + (-1) ** k) / (k + 1), abs=1e-15)


@pytest.mark.parametrize(
    ("curve", "expected"),
    [
        (nurbs.circle(3.0), 6.0 * math.pi),
        (Spline.bezier([[0, 0], [0.5, 0], [1, 1]]), 0.5 * math.sqrt(5.0) + 0.25 * math.asinh(2.0)),
        (CYCLOID, 16.0),
        (HELIX, 10.0 * math.hypot(A, B)),
        (Spline.bezier([[0, 0, 0], [1, 2, 2]]), 3.0),
    ],
    ids=["circle", "parabola", "cycloid with a cusp", "helix", "line"],
)
@pytest.mark.parametrize("tolerance", [1e-4, 1e-11])
def test_lengths_in_closed_form(curve: Spline | Parametric, expected: float, tolerance: float) -> None:
    """To the accuracy that is asked for."""
    assert abs(length(curve, tolerance=tolerance) - expected) <= max(tolerance, 2e-12) * expected


def test_a_speed_that_jumps_is_measured_too() -> None:
    """A corner that the curve does not tell of: |u - 1/3| integrates to a sum of halves of squares."""
    third = 1.0 / 3.0
    kinked = Parametric(
        lambda u: np.stack([np.abs(u - third) * (u - third) / 2, 0 * u], axis=-1), 0.0, 1.0,
        (lambda u: np.stack([np.abs(u - third), 0 * u], axis=-1),),
    )  # fmt: skip
    assert length(kinked) == pytest.approx((1 / 9 + 4 / 9) / 2, rel=1e-9)


def test_equal_lengths_are_equal_steps_on_a_circle() -> None:
    """The rational circle's own parameter is uneven; by its length, angles are equal, and the speed is 1 everywhere."""
    curve = ArcLength(nurbs.circle())
    even = curve.curve_by_length()
    points = even.at(np.linspace(0.0, curve.length, 13)[:-1])
    np.testing.assert_allclose(np.arctan2(points[:, 1], points[:, 0]) % (2 * math.pi), 2 * math.pi * np.arange(12) / 12, atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(even.derivative([0.1, 2.0, 5.0]), axis=1), 1.0)
    np.testing.assert_allclose(np.linalg.norm(even.derivative([0.1, 2.0, 5.0], 2), axis=1), 1.0, rtol=1e-5)


def test_lengths_are_those_of_parts_and_slips_are_refused() -> None:
    curve = nurbs.circle()
    assert length(curve, 1.0, 1.0) == 0.0
    assert length(curve, 1.0, 3.0) == pytest.approx(math.pi)
    for wrong in (lambda: length(curve, 3.0, 1.0), lambda: length(curve, 0.0, 9.0), lambda: length(curve, tolerance=0.0)):
        with pytest.raises(SceneError):
            wrong()
    with pytest.raises(SceneError, match="one point"):
        ArcLength(Spline.bezier([[1.0, 1.0], [1.0, 1.0]]))


def test_a_helix_has_its_curvature_its_torsion_and_its_frame() -> None:
    """a / (a^2 + b^2), b / (a^2 + b^2), and a normal that points to the axis; by differences to some digits."""
    u = np.array([0.0, 1.0, 4.0, 10.0])
    np.testing.assert_allclose(frames.curvature(HELIX, u), A / (A * A + B * B), rtol=1e-6)
    np.testing.assert_allclose(frames.torsion(HELIX, u), B / (A * A + B * B), rtol=1e-3)
    made = frames.frenet_frames(HELIX, u)
    np.testing.assert_allclose(made.normal, np.stack([-np.cos(u), -np.sin(u), 0 * u], axis=1), atol=1e-6)
    np.testing.assert_allclose(np.cross(made.tangent, made.normal), made.binormal, atol=1e-12)


def test_curvature_in_the_plane_has_a_sign() -> None:
    """Left is positive: a circle counter-clockwise has 1/r, its mirror image -1/r; a line has 0 and no normal."""
    u = np.linspace(0.0, 4.0, 9)
    np.testing.assert_allclose(frames.curvature(nurbs.circle(2.0), u), 0.5, rtol=1e-9)
    np.testing.assert_allclose(frames.curvature(nurbs.circle_arc(0.0, -2 * math.pi, 2.0), u), -0.5, rtol=1e-9)
    line = Spline.bezier([[0, 0, 0], [1, 1, 1], [2, 2, 2]])
    assert frames.curvature(line, 0.3) == pytest.approx(0.0)
    assert not frames.frenet_frames(line, 0.3).normal.any()
    with pytest.raises(SceneError, match="space"):
        frames.torsion(nurbs.circle(), 1.0)


def test_carried_frames_turn_by_the_torsion_less_than_the_curve_s_own() -> None:
    """Against the Frenet frame the carried one turns back by the integral of the torsion; a closed one comes back to itself."""
    u = np.linspace(0.0, 10.0, 801)
    carried, own = frames.turned_along(HELIX, u), frames.frenet_frames(HELIX, u)
    angle = np.unwrap(np.arctan2((carried.normal * own.binormal).sum(axis=1), (carried.normal * own.normal).sum(axis=1)))
    np.testing.assert_allclose(angle[-1] - angle[0], -B / (A * A + B * B) * 10.0 * math.hypot(A, B), rtol=1e-5)
    knot = Parametric(
        lambda t: np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=-1), 0.0, 2 * math.pi
    )
    ring = frames.turned_along(knot, np.linspace(0.0, 2 * math.pi, 200), closed=True)
    np.testing.assert_array_equal(ring.normal[0], ring.normal[-1])
    turned = (ring.normal[1:] * ring.normal[:-1]).sum(axis=1)
    assert turned.min() > 0.9
    np.testing.assert_allclose(np.cross(ring.tangent, ring.normal), ring.binormal, atol=1e-7)


def test_derivatives_by_differences_are_as_exact_as_they_say() -> None:
    """Ten, seven and five digits, also at the ends, where no point beyond may be asked for."""
    asked: list[float] = []

    def function(u: Floats) -> Floats:
        asked.extend([float(np.min(u)), float(np.max(u))])
        return np.stack([np.exp(u), np.sin(3.0 * u)], axis=-1)

    curve = Parametric(function, 0.0, 1.0)
    u = np.array([0.0, 1e-4, 0.3, 1.0])
    for order, digits in ((1, 1e-10), (2, 1e-7), (3, 1e-5)):
        phase = np.sin(3 * u + order * math.pi / 2)
        expected = np.stack([np.exp(u), 3.0**order * phase], axis=-1)
        np.testing.assert_allclose(curve.derivative(u, order), expected, atol=30 * digits)
    assert min(asked) >= 0.0
    assert max(asked) <= 1.0


def test_joints_are_told_apart() -> None:
    """A gap, a corner, equal directions, equal curvatures, equal derivatives: each has its names."""
    base = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 1.0]]
    left = Spline.bezier(base)

    def after(*points: tuple[float, float]) -> continuity.Joint:
        return continuity.between(left, Spline.bezier(points), tolerance=1e-9)

    assert after((3.0, 1.1), (4.0, 2.0), (5.0, 2.0)).geometric == -1
    assert (after((3.0, 1.0), (4.0, 1.0), (5.0, 2.0)).parametric, after((3.0, 1.0), (4.0, 1.0), (5.0, 2.0)).geometric) == (0, 0)
    assert after((3.0, 1.0), (2.0, 0.0), (5.0, 2.0)).geometric == 0  # it turns straight back
    half = after((3.0, 1.0), (3.5, 1.5), (5.0, 2.0), (6.0, 2.0))
    assert (half.parametric, half.geometric) == (0, 1)
    assert half.beta1 == pytest.approx(0.5)
    assert "C0, G1" in half.report()
    whole = continuity.continued(base, 3, 3)
    assert after(*map(tuple, whole)).parametric == 3
    fast = composed(Spline.bezier(whole), lambda s: 2.0 * s, 0.0, 0.5, (lambda s: 2.0 + 0.0 * s, lambda s: 0.0 * s))
    joint = continuity.between(left, fast, tolerance=1e-6)
    assert (joint.parametric, joint.geometric) == (0, 2)
    assert joint.beta1 == pytest.approx(2.0)
    still = after((3.0, 1.0), (3.0, 1.0), (4.0, 2.0), (5.0, 2.0))
    assert (still.geometric, math.isnan(still.angle)) == (0, True)


def test_impossible_continuations_are_refused() -> None:
    for degree, betas in ((1, ()), (3, (-1.0,)), (3, (0.0,))):
        with pytest.raises(SceneError):
            continuity.continued([[0.0, 0.0], [1.0, 1.0]], 2, degree, betas)


def test_easing_holds_the_ends_and_never_turns_back() -> None:
    """At rest at both ends where promised; the style sheets' `ease-in-out` is its own mirror image."""
    t = np.linspace(-0.5, 1.5, 201)
    for ease in (easing.linear, easing.smoothstep, easing.smootherstep, lambda s: easing.cubic_bezier(0.42, 0.0, 0.58, 1.0, s)):
        made = ease(t)
        assert (made[t <= 0] == 0).all()
        assert (made[t >= 1] == 1).all()
        assert (np.diff(made) >= 0).all()
        np.testing.assert_allclose(made + ease(1.0 - t), 1.0, atol=1e-12)
    assert easing.smootherstep(1e-4) < 2e-11
    with pytest.raises(SceneError, match="easing"):
        easing.cubic_bezier(1.5, 0.0, 0.5, 1.0, t)
