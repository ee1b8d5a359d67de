"""Fields of distances as they are described: distances, bounds, slopes, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from fields import FIELDS, INFINITE
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from limner.errors import SceneError
from limner.linear.transform import scale
from limner.scene import distance
from limner.scene.distance_field import smooth_minimum
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import DistanceField, Shape

EVERYTHING = {**FIELDS, **INFINITE}
LOOSE = ("julia",)  # what is inside means no distance

point = st.tuples(*[st.floats(-2.5, 2.5)] * 3)


@settings(max_examples=60)
@given(name=st.sampled_from([name for name in EVERYTHING if name not in LOOSE]), p=point, q=point, share=st.floats(1e-6, 1.0))
def test_no_field_is_steeper_than_its_bound(name: str, p: tuple[float, ...], q: tuple[float, ...], share: float) -> None:
    """|f(p) - f(q)| <= L |p - q|, for points far apart and close together."""
    field = EVERYTHING[name]
    ends = np.array([p, np.array(p) + share * (np.array(q) - np.array(p))])
    a, b = field.distance(ends)
    assert abs(a - b) <= field.lipschitz * np.linalg.norm(ends[1] - ends[0]) + 1e-12


def _scattered(n: int, seed: int = 1) -> NDArray[np.float64]:
    return np.random.default_rng(seed).uniform(-2.2, 2.2, size=(n, 3))


@pytest.mark.parametrize("name", EVERYTHING)
def test_nothing_of_the_surface_is_nearer_than_it_says(name: str) -> None:
    """What sphere tracing rests on: around a point outside, a ball of radius f / L holds no point of the inside."""
    field, random = EVERYTHING[name], np.random.default_rng(2)
    p = _scattered(1500)
    f = field.distance(p)
    p, f = p[f > 0], f[f > 0]
    towards = random.normal(size=(8, len(p), 3))
    towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
    assert field.distance(p + towards * (f / field.lipschitz * random.uniform(0.5, 1.0, (8, len(p))))[..., None]).min() > -1e-9


@pytest.mark.parametrize("name", FIELDS)
def test_its_box_holds_it_and_not_much_more(name: str) -> None:
    """No point inside lies beyond the box; a coarse look finds points inside near most faces of it, and both signs."""
    field = FIELDS[name]
    low, high = DistanceField(field).bounds
    share = _scattered(6000) / 2.2 * 0.75 + 0.5
    p = low + share * (high - low)
    inside = field.distance(p) < 0
    beyond = ((share < 0) | (share > 1)).any(axis=1)
    assert inside.any()
    assert not inside.all()
    assert not (inside & beyond).any()


EXACT = ("ball", "block", "rounded block", "ring", "segment", "capsule", "cylinder", "cone", "frustum", "octahedron", "row")


@pytest.mark.parametrize("name", EXACT)
def test_exact_fields_have_a_slope_of_one(name: str) -> None:
    """|grad f| = 1 outside, but on creases of measure zero: then the field is the distance and no mere bound."""
    p = _scattered(600)
    p = p[FIELDS[name].distance(p) > 0.05]
    slope = np.linalg.norm(FIELDS[name].gradient(p, 1e-6), axis=1)
    assert np.quantile(np.abs(slope - 1.0), 0.98) < 1e-6


@given(a=st.floats(-2, 2), b=st.floats(-2, 2), k=st.floats(0.01, 1.0))
def test_the_smooth_minimum_is_less_by_a_quarter_of_its_radius_at_most(a: float, b: float, k: float) -> None:
    """min - k/4 <= smooth <= min, alike in a and b, and the minimum itself where they differ by more than k."""
    smooth, other = (float(smooth_minimum(np.array(x), np.array(y), k)) for x, y in ((a, b), (b, a)))
    assert smooth == other
    assert min(a, b) - k / 4 - 1e-12 <= smooth <= min(a, b)
    assert abs(a - b) < k or smooth == min(a, b)


def test_operators_make_one_of_many() -> None:
    """a | b | c is one union of three, so that long chains are not deep; what is placed twice is placed once."""
    a, b, c = distance.Sphere(1.0), distance.Box(1.0), distance.Torus()
    assert (a | b | c).parts == (a, b, c)
    assert (a - b - c).parts == (a, b, c)
    assert len(((a | b) & c).parts) == 2
    twice = a.translated(1, 0, 0).scaled(2.0)
    assert isinstance(twice, distance.Placed)
    assert twice.part is a
    np.testing.assert_allclose(twice.distance([[2, 0, 0], [5, 0, 0]]), [-2.0, 1.0])


def test_a_smooth_union_in_a_union_stays_smooth() -> None:
    """Bug it prevents: taking a union's parts out of it and losing its radius."""
    smooth = distance.Union(distance.Sphere(1.0), distance.Sphere(1.0).translated(1.5, 0, 0), radius=0.5)
    p = [[0.75, 0.75, 0.0]]
    assert (smooth | distance.Sphere(0.1).translated(9, 9, 9)).distance(p) == smooth.distance(p)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: DistanceField(distance.Plane()), "must have an end"),
        (lambda: DistanceField(distance.Gyroid() | distance.Sphere()), "must have an end"),
        (lambda: DistanceField(distance.Sphere() & distance.Sphere().translated(9, 0, 0)), "holds nothing"),
        (lambda: distance.Sphere(-1.0), r"sphere.radius must be positive, got -1.0"),
        (lambda: distance.Box((1, 0, 1)), r"box.size must be positive"),
        (lambda: distance.RoundedBox(1.0, 0.6), "at most half the shortest edge"),
        (lambda: distance.Capsule(1.0, 1.0), "at least twice the radius"),
        (lambda: distance.Union(distance.Sphere()), "at least 2 parts"),
        (lambda: distance.Union(distance.Sphere(), 3), "must be a distance field"),
        (lambda: distance.Union(distance.Sphere(), distance.Box(), radius=-1.0), "must not be negative"),
        (lambda: distance.Sphere().placed(scale(1, 2, 1)), "alike along all axes"),
        (lambda: distance.Sphere().repeated(1.0), "at least the part's length 2, got 1"),
        (lambda: distance.Sphere().repeated(0.0), "positive along some axis"),
        (lambda: distance.Sphere().repeated(3.0, 1.5), "whole numbers"),
        (lambda: distance.Sphere().mirrored("w"), "some of"),
        (lambda: distance.Gyroid().twisted(10.0), "must end to all sides"),
        (lambda: distance.MengerSponge(1.0, 11), "from 0 to 10"),
        (lambda: distance.QuaternionJulia((1, 2, 3)), "four numbers"),
        (lambda: distance.Sphere().distance([[1, 2]]), "three coordinates"),
        (lambda: DistanceField(2.0), "distance_field.expression"),
    ],
)
def test_what_makes_no_field_is_refused(make: object, says: str) -> None:
    """One clear line each."""
    with pytest.raises(SceneError, match=says):
        make()  # type: ignore[operator]


def test_depth_has_an_end() -> None:
    """A chain that kernels have no stack for is refused while it is described."""
    field: distance.Distance = distance.Sphere()
    for _ in range(47):
        field = field.shell(0.1)
    with pytest.raises(SceneError, match="nested 49 deep"):
        field.shell(0.1)


def test_a_field_is_framed_like_any_shape() -> None:
    """A scene of one knows its bounds; along a slanted direction they are those of its box."""
    shape = Shape(DistanceField(distance.Sphere(0.5).translated(1, 2, 3)))
    np.testing.assert_allclose(Scene(Node(shapes=(shape,))).bounds(), [[0.5, 1.5, 2.5], [1.5, 2.5, 3.5]])
    low, high = shape.geometry.range_along([[1, 1, 1]])  # type: ignore[union-attr]
    np.testing.assert_allclose([low[0], high[0]], [4.5, 7.5])
