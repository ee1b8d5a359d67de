"""What holds for all lines and polygons: nearest pixels, exact areas, nothing twice, nothing left out (FoCG 8.1.1, 8.2.1)."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from limner.draw.coverage import coverage
from limner.draw.midpoint import SUBPIXELS, line_pixels
from limner.draw.path import Path, signed_area
from limner.draw.stroke import CAPS, JOINS, Pen, stroke_polygons

SIZE = 12
whole = st.integers(-40, 40)
real = st.integers(-40 * SUBPIXELS, 40 * SUBPIXELS).map(lambda k: k / SUBPIXELS)
inside = st.floats(0.0, SIZE - 1.0).map(lambda x: round(x, 6))
around = st.floats(-SIZE, 2.0 * SIZE).map(lambda x: round(x, 6))
Floats = NDArray[np.float64]


def nearest(value: Fraction) -> int:
    """The nearest integer, ties to the smaller."""
    return math.ceil(value - Fraction(1, 2))


def oracle(x0: float, y0: float, x1: float, y1: float) -> list[tuple[int, int]]:
    """The nearest pixel of every column (or row), by rational numbers, from the smaller end on."""
    a, b = (Fraction(x0), Fraction(y0)), (Fraction(x1), Fraction(y1))
    steep = abs(b[1] - a[1]) > abs(b[0] - a[0])
    if steep:
        a, b = a[::-1], b[::-1]
    if b[0] < a[0]:
        a, b = b, a
    slope = (b[1] - a[1]) / (b[0] - a[0]) if b[0] != a[0] else Fraction(0)
    pixels = [(x, nearest(a[1] + slope * (x - a[0]))) for x in range(nearest(a[0]), nearest(b[0]) + 1)]
    return [(y, x) for x, y in pixels] if steep else pixels


def as_tuples(pixels: NDArray[np.int64]) -> list[tuple[int, int]]:
    return [tuple(pixel) for pixel in pixels.tolist()]


# --- lines of pixels ------------------------------------------------------------------------------------------------------


@given(real, real, real, real)
def test_line_is_the_nearest_pixel_of_each_column_or_row(x0: float, y0: float, x1: float, y1: float) -> None:
    """All slopes, both directions, ends anywhere: the same pixels as rounding the true line in rational numbers."""
    assert as_tuples(line_pixels(x0, y0, x1, y1)) == oracle(x0, y0, x1, y1)


@given(whole, whole, whole, whole)
def test_line_between_pixels_has_its_ends_and_no_gaps(x0: int, y0: int, x1: int, y1: int) -> None:
    """One pixel per column (or row), both ends among them, neighbours touch, none farther than half a pixel from the line."""
    pixels = line_pixels(x0, y0, x1, y1)
    dx, dy = x1 - x0, y1 - y0
    assert len(pixels) == max(abs(dx), abs(dy)) + 1
    assert {(x0, y0), (x1, y1)} <= set(as_tuples(pixels))
    assert np.abs(np.diff(pixels, axis=0)).max(initial=0) <= 1
    along = 0 if abs(dx) >= abs(dy) else 1
    assert len(set(pixels[:, along].tolist())) == len(pixels)
    # |f(x, y)| <= max(|dx|, |dy|) / 2, with the book's implicit f: in whole numbers.
    f = (y0 - y1) * pixels[:, 0] + (x1 - x0) * pixels[:, 1] + x0 * y1 - x1 * y0
    assert (2 * np.abs(f) <= max(abs(dx), abs(dy))).all()


@given(real, real, real, real)
def test_line_is_the_same_both_ways(x0: float, y0: float, x1: float, y1: float) -> None:
    """Reversal changes nothing, not even the order."""
    assert (line_pixels(x0, y0, x1, y1) == line_pixels(x1, y1, x0, y0)).all()


@given(real, real, real, real, whole, whole, st.integers(0, 30), st.integers(0, 30))
def test_clipping_a_line_keeps_its_pixels(
    x0: float, y0: float, x1: float, y1: float, left: int, top: int, width: int, height: int
) -> None:
    """A clipped line is the whole line's pixels inside the box, no other."""
    box = (left, top, left + width, top + height)
    expected = [(x, y) for x, y in oracle(x0, y0, x1, y1) if box[0] <= x < box[2] and box[1] <= y < box[3]]
    assert as_tuples(line_pixels(x0, y0, x1, y1, clip=box)) == expected


# --- areas ----------------------------------------------------------------------------------------------------------------


@st.composite
def star_shaped(draw: st.DrawFn, coordinate: st.SearchStrategy[float] = inside) -> Floats:
    """A polygon without crossings: points in order round their middle."""
    points = np.array(draw(st.lists(st.tuples(coordinate, coordinate), min_size=3, max_size=9, unique=True)))
    about = points - points.mean(axis=0)
    angle = np.arctan2(about[:, 1], about[:, 0])
    return points[np.argsort(angle, kind="stable")]


def is_simple(ring: Floats) -> bool:
    """Whether the points have different directions from the middle that leave no gap of half a turn."""
    about = ring - ring.mean(axis=0)
    angle = np.sort(np.arctan2(about[:, 1], about[:, 0]))
    gaps = np.diff(np.append(angle, angle[0] + 2.0 * np.pi))
    return bool(gaps.min() > 1e-6 and gaps.max() < np.pi - 1e-6 and np.linalg.norm(about, axis=1).min() > 1e-6)


@given(star_shaped())
def test_coverage_adds_up_to_the_area(ring: Floats) -> None:
    """Any polygon without crossings, inside the picture: sum = area to 1e-4, each pixel in [0, 1], both rules alike."""
    if is_simple(ring):
        covered = coverage([ring], SIZE, SIZE)
        assert covered.sum(dtype=np.float64) == pytest.approx(abs(signed_area(ring)), abs=1e-4)
        assert covered.min() >= 0.0
        assert covered.max() <= 1.0
        np.testing.assert_allclose(coverage([ring], SIZE, SIZE, "evenodd"), covered, atol=1e-6)


@given(star_shaped(around))
def test_a_polygon_and_what_is_outside_it_cover_every_pixel_once(ring: Floats) -> None:
    """Ring alone plus ring as a hole in a frame = 1 everywhere, also where the ring leaves the picture."""
    frame = np.array([(-99.0, -99.0), (99.0, -99.0), (99.0, 99.0), (-99.0, 99.0)])
    both = coverage([ring], SIZE, SIZE, "evenodd") + coverage([frame, ring], SIZE, SIZE, "evenodd")
    np.testing.assert_allclose(both, 1.0, atol=1e-6)


@given(st.lists(st.tuples(inside, inside), min_size=1, max_size=6, unique=True))
def test_triangles_that_share_edges_cover_every_pixel_once(points: list[tuple[float, float]]) -> None:
    """A triangulated frame: the triangles' coverages add up to the frame's own."""
    spatial = pytest.importorskip("scipy.spatial")
    corners = [(-0.5, -0.5), (SIZE - 0.5, -0.5), (SIZE - 0.5, SIZE - 0.5), (-0.5, SIZE - 0.5)]
    vertices = np.array(corners + points)
    triangles = spatial.Delaunay(vertices).simplices
    total = sum(coverage([vertices[triangle]], SIZE, SIZE).astype(np.float64) for triangle in triangles)
    np.testing.assert_allclose(total, 1.0, atol=1e-5)


def sampled(rings: list[Floats], rule: str, per_pixel: int) -> Floats:
    """Coverage by counting windings at a grid of points: an oracle that knows no edges' order."""
    at = (np.arange(SIZE * per_pixel) + 0.5) / per_pixel - 0.5
    x, y = np.meshgrid(at, at)
    winding = np.zeros(x.shape, dtype=np.int64)
    for ring in rings:
        for (x0, y0), (x1, y1) in zip(ring.tolist(), np.roll(ring, -1, axis=0).tolist(), strict=True):
            if y0 != y1:
                crosses = (y0 <= y) != (y1 <= y)
                right = x0 + (y - y0) * ((x1 - x0) / (y1 - y0)) > x
                winding += np.where(crosses & right, 1 if y1 > y0 else -1, 0)
    covered = winding % 2 != 0 if rule == "evenodd" else winding != 0
    return covered.reshape(SIZE, per_pixel, SIZE, per_pixel).mean(axis=(1, 3))


@settings(max_examples=30)
@given(
    st.lists(st.lists(st.tuples(around, around), min_size=3, max_size=6), min_size=1, max_size=3),
    st.sampled_from(["nonzero", "evenodd"]),
)
def test_crossing_rings_cover_what_their_windings_say(rings: list[list[tuple[float, float]]], rule: str) -> None:
    """Rings that cross themselves and each other and leave the picture, against 40 x 40 samples a pixel."""
    made = [np.array(ring) for ring in rings]
    difference = coverage(made, SIZE, SIZE, rule) - sampled(made, rule, 40)
    n_edges = sum(map(len, rings))
    assert np.abs(difference).max() < 0.03 * n_edges  # an edge through a pixel misjudges at most a sample in each row
    assert abs(difference.mean()) < 0.002 * n_edges


@given(star_shaped(around), st.integers(1, 5))
def test_order_and_direction_do_not_matter(ring: Floats, turn: int) -> None:
    """The same ring from another point on, turned round, or twice: the same coverage."""
    covered = coverage([ring], SIZE, SIZE)
    for same in ([np.roll(ring, turn, axis=0)], [ring[::-1]], [ring, ring]):
        np.testing.assert_allclose(coverage(same, SIZE, SIZE), covered, atol=1e-6)


@given(star_shaped(), st.integers(-3, 3), st.integers(-3, 3))
def test_moving_by_whole_pixels_moves_the_coverage(ring: Floats, right: int, down: int) -> None:
    """Nothing depends on where in the picture a shape lies."""
    covered = coverage([ring + 4.0], SIZE + 8, SIZE + 8)
    moved = coverage([ring + np.array([4.0 + right, 4.0 + down])], SIZE + 8, SIZE + 8)
    np.testing.assert_allclose(moved, np.roll(covered, (down, right), axis=(0, 1)), atol=1e-6)


def test_a_crowd_of_edges_is_nearly_exact() -> None:
    """A fan of 300 thin teeth, more edges in a row than are sorted out one by one: the area to one part in a thousand."""
    at = np.linspace(0.0, 60.0, 601)
    comb = np.stack([at, np.where(np.arange(601) % 2 == 0, 3.3, 9.9)], axis=1)
    ring = np.concatenate([comb, [(60.0, 3.3), (60.0, 1.1), (0.0, 1.1)]])
    covered = coverage([ring], 62, 12)
    area = abs(signed_area(ring))
    assert covered.sum(dtype=np.float64) == pytest.approx(area, rel=1e-3)


# --- strokes --------------------------------------------------------------------------------------------------------------


@settings(max_examples=30)
@given(
    st.lists(st.tuples(inside, inside), min_size=1, max_size=5),
    st.booleans(),
    st.sampled_from(CAPS),
    st.sampled_from(JOINS),
    st.floats(0.3, 5.0),
)
def test_round_strokes_are_what_lies_within_half_a_width(
    points: list[tuple[float, float]], closed: bool, cap: str, join: str, width: float
) -> None:
    """Pieces of a stroke are convex and turn alike; round ones reach half a width and no farther."""
    path = Path().polyline(points, closed)
    for part in stroke_polygons(path, Pen(width, cap, join)):
        x, y = np.moveaxis(np.roll(part, -1, axis=1) - part, -1, 0)
        turn = x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)
        assert turn.min() > -1e-6
    chain = path.flattened()[0].points
    ends = np.vstack([chain, chain[:1]]) if closed else chain
    rounded = stroke_polygons(path, Pen(width, "round", "round"))
    for part in rounded:
        assert distance_to(ends, part.reshape(-1, 2)).max() <= 0.5 * width + 1e-9
    assert rounded


def distance_to(chain: Floats, points: Floats) -> Floats:
    """How far points lie from a chain of lines."""
    start, way = chain[:-1], np.diff(chain, axis=0)
    if len(start) == 0:
        return np.linalg.norm(points - chain[0], axis=1)
    squared = np.maximum((way * way).sum(axis=1), 1e-300)
    t = np.clip(((points[:, None] - start) * way).sum(axis=2) / squared, 0.0, 1.0)
    return np.linalg.norm(points[:, None] - start - t[..., None] * way, axis=2).min(axis=1)
