"""Curves as drawings: where they lie on the canvas, what their paths say, where a comb's teeth stand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.curves import bezier, catmull_rom, natural, nurbs
from limner.curves.curve import Parametric, Spline
from limner.draw.svg import path_data
from limner.errors import SceneError
from limner.produce import curve_pictures

POINTS = [(0.0, 0.0), (1.0, 2.0), (3.0, 2.0), (4.0, 0.0)]


def test_splines_stay_bezier_curves_in_paths() -> None:
    """A cubic is a C to the digit, a parabola is raised to one, a circle becomes lines and closes, gaps become moves."""
    assert path_data(curve_pictures.path_of(Spline.bezier(POINTS))) == "M0 0C1 2 3 2 4 0"
    parabola = curve_pictures.path_of(Spline.bezier([[0, 0], [3, 3], [6, 0]]))
    assert path_data(parabola) == "M0 0C2 2 4 2 6 0"
    ring = curve_pictures.path_of(nurbs.circle(50.0), 0.1)
    assert path_data(ring).endswith("Z")
    assert "C" not in path_data(ring)
    apart = Spline(np.array([0.0, 1.0, 2.0]), np.array([[[0, 0], [1, 0]], [[1, 1], [2, 1]]]))
    assert path_data(curve_pictures.path_of(apart)).count("M") == 2
    with pytest.raises(SceneError, match="plane"):
        curve_pictures.path_of(Spline.bezier([[0, 0, 0], [1, 1, 1]]))


def test_the_frame_shows_everything_upright() -> None:
    """What is higher in the plane is higher on the canvas; all is inside; the rational spline moves with its points."""
    frame = curve_pictures.framing([np.array(POINTS)], 200, 100)
    pixels = frame.pixels(POINTS)
    assert pixels[1, 1] < pixels[0, 1]
    assert (pixels >= 0).all()
    assert (pixels <= (199, 99)).all()
    circle = nurbs.circle(1.0, (2.0, 1.0))
    u = np.linspace(0, 4, 9)
    np.testing.assert_allclose(frame.spline(circle).at(u), frame.pixels(circle.at(u)), atol=1e-9)


def test_teeth_of_a_circle_are_equal_and_outside() -> None:
    """All at one distance beyond it; a straight line has none; a natural spline's comb is continuous, a Catmull-Rom curve's is not."""
    feet, tips = curve_pictures.bends(nurbs.circle(), 40)
    np.testing.assert_allclose(np.linalg.norm(feet, axis=1), 1.0)
    np.testing.assert_allclose(np.linalg.norm(tips, axis=1), 1.5, atol=1e-9)
    feet, tips = curve_pictures.bends(Spline.bezier([[0, 0], [1, 1], [2, 2]]))
    np.testing.assert_allclose(feet, tips, atol=1e-9)

    def steps(curve: Spline) -> float:
        feet, tips = curve_pictures.bends(curve, 120)
        same = np.linalg.norm(np.diff(feet, axis=0), axis=1) < 1e-6
        return float(np.linalg.norm(np.diff(tips, axis=0), axis=1)[same].max())

    points = [*POINTS, (5.0, 2.0), (6.0, -1.0)]
    assert steps(natural.natural(points)) < 1e-5
    assert steps(catmull_rom.catmull_rom(points)) > 0.05


def test_pictures_show_what_they_are_of() -> None:
    """The construction's point is red where the curve is; marks are dots on the curve; ink is on white."""
    canvas = curve_pictures.construction(POINTS, 0.25, 200, 120)
    x, y = curve_pictures.framing([np.array(POINTS)], 200, 120).pixels(bezier.evaluate(POINTS, 0.25))
    red, green, blue = canvas.image().to_uint8()[round(float(y)), round(float(x)), :3].tolist()
    assert red > 150 > green
    assert blue < 100
    for drawn in (
        curve_pictures.drawing(Spline.bezier(POINTS), POINTS, 90, 60),
        curve_pictures.comb(natural.natural(POINTS), 30, width=90, height=60),
        curve_pictures.evenly_marked(nurbs.circle(), 8, 90, 60),
        curve_pictures.drawing(Parametric(lambda u: np.stack([u, np.sin(u)], axis=-1), 0.0, 2 * math.pi), None, 90, 60),
    ):
        codes = drawn.image().to_uint8()
        assert codes.shape[:2] == (60, 90)
        assert (codes[0, 0] == 255).all()
        assert codes[..., :3].min() < 100
        assert drawn.svg().startswith("<svg")


def test_points_and_escapes_are_pixels() -> None:
    """Where points are it is dark; the set is black, and what leaves first is the map's low end."""
    image = curve_pictures.scatter(np.array([[0.0, 0.0], [1.0, 1.0]]), 20, 20).pixels
    assert (image[..., 0] < 0.5).sum() == 2
    shown = curve_pictures.escape_image(np.array([[0.0, np.inf], [10.0, 3.0]])).pixels
    assert not shown[0, 1, :3].any()
    assert shown[1, 0, :3].sum() > shown[1, 1, :3].sum() > shown[0, 0, :3].sum()


def test_slips_are_refused() -> None:
    for wrong in (
        lambda: curve_pictures.construction(POINTS, 1.5),
        lambda: curve_pictures.construction([(0, 0, 0), (1, 1, 1)], 0.5),
        lambda: curve_pictures.line_drawing([]),
        lambda: curve_pictures.evenly_marked(nurbs.circle(), 1),
        lambda: curve_pictures.framing([np.array(POINTS)], 0, 10),
    ):
        with pytest.raises(SceneError):
            wrong()
