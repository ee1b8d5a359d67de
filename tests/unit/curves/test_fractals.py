"""Fractals: lengths, ends, dimensions as published, two ways to the same curve, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.curves.fractals import displacement, escape, ifs, lsystem, replacement
from limner.errors import SceneError

Floats = NDArray[np.float64]


def unit(line: Floats) -> Floats:
    """A line from (0, 0) to (1, 0), wherever it was."""
    z = line @ (1.0, 1.0j)
    z = (z - z[0]) / (z[-1] - z[0])
    return np.stack([z.real, z.imag], axis=1)


@pytest.mark.parametrize("times", [0, 1, 2, 5])
def test_turtles_and_replacement_draw_the_same(times: int) -> None:
    """Koch, dragon and Hilbert by words and by formulas."""
    (koch,) = lsystem.NAMED["koch"].lines(times)
    np.testing.assert_allclose(unit(koch), replacement.koch(times), atol=1e-12)
    (dragon,) = lsystem.NAMED["dragon"].lines(times)
    np.testing.assert_allclose(unit(dragon), replacement.dragon(times), atol=1e-12)
    if times:
        (hilbert,) = lsystem.NAMED["hilbert"].lines(times)
        np.testing.assert_allclose(np.abs(unit(hilbert)), np.abs(unit(replacement.hilbert(times))), atol=1e-12)


def test_koch_grows_by_a_third_and_its_snowflake_has_its_area() -> None:
    """Length (4/3)^n; the area of the closed polygon is the series' partial sum, 2/5 sqrt(3) in the end."""
    for times in range(6):
        line = replacement.koch(times)
        assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx((4 / 3) ** times)
        flake = replacement.snowflake(times)
        np.testing.assert_allclose(flake[0], flake[-1], atol=1e-15)
        x, y = flake.T
        area = -0.5 * (x[:-1] * y[1:] - x[1:] * y[:-1]).sum()
        assert area == pytest.approx(math.sqrt(3) / 4 * (1 + 3 / 5 * (1 - (4 / 9) ** times)))


def test_hilbert_visits_every_cell_once_and_neighbours_in_turn() -> None:
    """And the cells of some numbers are those of all."""
    for order in range(1, 7):
        cells = replacement.hilbert_cells(order)
        assert len(np.unique(cells, axis=0)) == 4**order
        assert (np.abs(np.diff(cells, axis=0)).sum(axis=1) == 1).all()
    np.testing.assert_array_equal(replacement.hilbert_cells(6, [5, 4000]), cells[[5, 4000]])
    assert replacement.hilbert_cells(31, [4**31 - 1]).tolist() == [[2**31 - 1, 0]]


def test_the_dragon_does_not_cross_itself() -> None:
    """Every leg is walked once; all turns are right angles."""
    line = replacement.dragon(10) * math.sqrt(2.0) ** 10
    legs = np.diff(line, axis=0)
    middles = np.round(2.0 * (line[:-1] + line[1:]) / 2.0, 6)
    assert len(np.unique(middles, axis=0)) == len(legs)
    np.testing.assert_allclose((legs[1:] * legs[:-1]).sum(axis=1), 0.0, atol=1e-9)


def test_words_grow_as_counted_and_branches_come_back() -> None:
    """Fibonacci's numbers of letters; after a branch the pen goes on where it was."""
    algae = lsystem.LSystem("A", {"A": "AB", "B": "A"}, 0.0)
    assert [algae.length(k) for k in range(8)] == [1, 2, 3, 5, 8, 13, 21, 34]
    assert algae.grown(4) == "ABAABABA"
    lines = lsystem.turtle_lines("F[+F]F|F", 90.0)
    np.testing.assert_allclose(lines[0], [(0, 0), (1, 0), (1, 1)], atol=1e-12)
    np.testing.assert_allclose(lines[1], [(1, 0), (2, 0), (1, 0)], atol=1e-12)
    for name, system in lsystem.NAMED.items():
        assert len(system.lines(2)) >= 1, name


@pytest.mark.parametrize(
    ("scales", "dimension"),
    [([1 / 3] * 4, math.log(4) / math.log(3)), ([1 / 2] * 3, math.log(3) / math.log(2)), ([1 / 3] * 8, math.log(8) / math.log(3)),
     ([1 / 3] * 2, math.log(2) / math.log(3)), ([math.sqrt(0.5)] * 2, 2.0)],
    ids=["Koch", "Sierpinski", "carpet", "Cantor", "dragon"],
)  # fmt: skip
def test_published_dimensions(scales: list[float], dimension: float) -> None:
    """Moran's equation, against Falconer's table."""
    assert replacement.similarity_dimension(scales) == pytest.approx(dimension, abs=1e-12)


@pytest.mark.parametrize(("name", "dimension"), [("sierpinski", 1.585), ("carpet", 1.893), ("koch", 1.262)])
def test_counted_dimensions_are_near_the_published_ones(name: str, dimension: float) -> None:
    """Boxes over five octaves of a set of a hundred thousand points."""
    points = ifs.NAMED[name].points(100_000, 1)
    assert ifs.box_dimension(points, 2, 6) == pytest.approx(dimension, abs=0.06)


def test_the_chaos_game_stays_on_the_set_and_repeats() -> None:
    """Koch's points are near Koch's curve; the same seed gives the same points."""
    points = ifs.NAMED["koch"].points(500, 7)
    line = replacement.koch(6)
    away = np.linalg.norm(points[:, None] - line[None], axis=2).min(axis=1)
    assert away.max() < 3.0**-6
    np.testing.assert_array_equal(points, ifs.NAMED["koch"].points(500, 7))
    dense = ifs.NAMED["koch"].images(np.array([[0.0, 0.0], [1.0, 0.0]]), 3)
    np.testing.assert_allclose(np.unique(dense.round(9), axis=0), np.unique(replacement.koch(3).round(9), axis=0), atol=1e-8)


@pytest.mark.parametrize("roughness", [0.3, 0.5, 0.8])
def test_displaced_heights_have_the_roughness_they_are_given(roughness: float) -> None:
    """The mean square of a step grows with the step as t^(2 H), over dyadic legs."""
    steps = np.arange(2, 9)
    squares = np.zeros(len(steps))
    for seed in range(30):
        heights = displacement.displaced_heights(11, roughness, seed)
        squares += [np.mean(np.diff(heights[:: 2**k]) ** 2) for k in steps]
    slope = np.polyfit(steps * math.log(2.0), np.log(squares), 1)[0]
    assert slope == pytest.approx(2.0 * roughness, abs=0.15)


def test_a_coastline_keeps_its_corners() -> None:
    """And repeats with its seed; without a deviation it is the polygon."""
    corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
    line = displacement.displaced_line(corners, 4, seed=2)
    np.testing.assert_array_equal(line[::16], corners)
    np.testing.assert_array_equal(line, displacement.displaced_line(corners, 4, seed=2))
    flat = displacement.displaced_line(corners, 2, deviation=0.0)
    np.testing.assert_allclose(flat[:5, 0], [0, 0.25, 0.5, 0.75, 1.0])


def test_the_mandelbrot_set_has_its_area_and_its_mirror() -> None:
    """1.5066 counted by others; symmetric; 0, -1, i stay, 1 and -2.1 go."""
    counts = escape.mandelbrot((-2.0, -1.25, 0.5, 1.25), 200, 200, 400)
    np.testing.assert_array_equal(np.isinf(counts), np.isinf(counts[::-1]))
    assert np.isinf(counts).mean() * 2.5 * 2.5 == pytest.approx(1.5066, abs=0.03)
    for point, stays in ((0j, True), (-1 + 0j, True), (1j, True), (1 + 0j, False), (-2.1 + 0j, False)):
        x, y = point.real, point.imag
        (found,) = escape.mandelbrot((x - 1e-9, y - 1e-9, x + 1e-9, y + 1e-9), 1, 1, 20)[0]
        assert math.isinf(found) == stays


def test_the_julia_set_of_nothing_is_the_unit_disk_and_counts_are_smooth() -> None:
    """z^2 alone: |z| < 1 stays; outside the count is a logarithm of a logarithm of |z|, without steps."""
    counts = escape.julia(0j, (-1.5, -1.5, 1.5, 1.5), 60, 60, 60)
    z = np.abs(escape.grid((-1.5, -1.5, 1.5, 1.5), 60, 60))
    np.testing.assert_array_equal(np.isinf(counts), z < 1.0)
    away = z > 1.01
    np.testing.assert_allclose(counts[away], np.log2(math.log(256.0) / np.log(z[away])), atol=1e-9)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: lsystem.LSystem("", {}, 90.0), "axiom"),
        (lambda: lsystem.LSystem("F", {"FF": "F"}, 90.0), "one letter"),
        (lambda: lsystem.NAMED["koch"].grown(40), "letters"),
        (lambda: lsystem.turtle_lines("F]", 90.0), "without"),
        (lambda: lsystem.turtle_lines("[F", 90.0), "without"),
        (lambda: replacement.koch(-1), "at least 0"),
        (lambda: replacement.koch(50), "points"),
        (lambda: replacement.replaced([[0, 0], [1, 0]], [[0, 0], [2, 0]], 1), "generator"),
        (lambda: replacement.hilbert_cells(2, [16]), "numbered"),
        (lambda: replacement.similarity_dimension([1.5, 0.5]), "scales"),
        (lambda: ifs.FunctionSystem(np.array([[[2.0, 0, 0], [0, 2.0, 0]]])), "shrink"),
        (lambda: ifs.FunctionSystem(np.zeros((2, 2))), "shape"),
        (lambda: ifs.box_dimension(np.zeros((4, 2))), "not all one"),
        (lambda: displacement.displaced_heights(3, 1.0), "roughness"),
        (lambda: displacement.displaced_line([[0, 0], [1, 1]], 60), "halved"),
        (lambda: escape.mandelbrot((1, 0, 0, 1)), "bounds"),
        (lambda: escape.julia(complex(math.nan, 0)), "finite"),
    ],
)
def test_bad_input_is_refused(call: object, words: str) -> None:
    assert callable(call)
    with pytest.raises(SceneError, match=words):
        call()
