"""Drawing onto a picture (FoCG 8.2.1): coverage, alpha, clip, colours between corners."""

from __future__ import annotations

import math

import numpy as np
import pytest

from limner.draw.canvas import Canvas
from limner.draw.coverage import coverage
from limner.draw.ink import ink
from limner.draw.path import TOLERANCE, Path
from limner.draw.stroke import Pen
from limner.errors import SceneError, UnsupportedError
from limner.image.image import Image


def test_rectangles_cover_parts_of_pixels() -> None:
    """Centres are at integers: from 0 to 2 is half a pixel, one, and half a pixel; y goes down."""
    pixels = Canvas(4, 3).rectangle(0, 0.5, 2, 1, fill="white").image().pixels
    np.testing.assert_allclose(pixels[..., 3], [[0, 0, 0, 0], [0.5, 1, 0.5, 0], [0, 0, 0, 0]], atol=1e-7)


def test_colour_lies_over_what_was_there_in_linear_light() -> None:
    """Half covered, half transparent red over blue: a quarter of red, three quarters of blue, opaque."""
    pixels = Canvas(1, 1, background=(0, 0, 1)).rectangle(-0.5, -0.5, 0.5, 1, fill=(1, 0, 0, 0.5)).image().pixels
    np.testing.assert_allclose(pixels[0, 0], [0.25, 0, 0.75, 1.0], atol=1e-7)


def test_transparent_pictures_keep_their_colour() -> None:
    """Straight alpha comes out: the colour of an edge is the shape's colour, not a darker one."""
    pixels = Canvas(8, 8).circle(3.5, 3.5, 3, fill=(0.9, 0.4, 0.1)).image().pixels
    edge = (pixels[..., 3] > 0.01) & (pixels[..., 3] < 0.99)
    assert edge.any()
    np.testing.assert_allclose(pixels[edge][:, :3], np.tile([0.9, 0.4, 0.1], (edge.sum(), 1)), rtol=1e-5)


def test_over_is_associative_enough() -> None:
    """Two layers painted one after the other onto a third = Porter and Duff's formula."""
    canvas = Canvas(1, 1, (0.2, 0.4, 0.6, 0.5))
    canvas.fill(Path().rectangle(-1, -1, 2, 2), (1.0, 0.5, 0.0, 0.25))
    alpha = 0.25 + 0.5 * 0.75
    expected = (np.array([1.0, 0.5, 0.0]) * 0.25 + np.array([0.2, 0.4, 0.6]) * 0.5 * 0.75) / alpha
    np.testing.assert_allclose(canvas.image().pixels[0, 0], [*expected, alpha], rtol=1e-6)


@pytest.mark.parametrize("rule", ["nonzero", "evenodd"])
def test_a_star_has_a_heart_or_a_hole(rule: str) -> None:
    """A pentagram of radius r: its area by geometry, with the pentagon inside or without."""
    r, turn = 20.0, 4.0 * np.pi / 5.0 * np.arange(5)
    star = np.stack([24 + r * np.cos(turn), 24 + r * np.sin(turn)], axis=1)
    inner = r * math.cos(2 * math.pi / 5) / math.cos(math.pi / 5)  # the pentagon's corners
    tips_and_heart = 5.0 * r * inner * math.sin(math.pi / 5)
    heart = 2.5 * inner**2 * math.sin(2 * math.pi / 5)
    pixels = Canvas(48, 48).polygon(star, fill="white", rule=rule).image().pixels
    expected = tips_and_heart if rule == "nonzero" else tips_and_heart - heart
    assert pixels[..., 3].sum(dtype=np.float64) == pytest.approx(expected, abs=1e-3)
    assert pixels[24, 24, 3] == (1.0 if rule == "nonzero" else 0.0)


def test_holes_show_what_is_behind() -> None:
    canvas = Canvas(20, 20, "white").polygon(
        [(1, 1), (18, 1), (18, 18), (1, 18)], holes=[[(5, 5), (9, 5), (9, 9), (5, 9)]], fill="black"
    )
    values = canvas.image().pixels[..., 0]
    assert values[7, 7] == 1.0
    assert values[12, 12] == 0.0
    assert (1.0 - values).sum(dtype=np.float64) == pytest.approx(17**2 - 4**2, abs=1e-4)


def test_circles_and_ellipses_have_their_areas() -> None:
    """Chords leave out less than their tolerance along the whole perimeter."""
    for a, b, rotation in ((20.0, 20.0, 0.0), (19.0, 7.0, 0.6), (0.4, 0.4, 0.0)):
        pixels = Canvas(48, 48).ellipse(23.7, 24.2, a, b, rotation, fill="white").image().pixels
        perimeter = 2.0 * math.pi * max(a, b)
        missing = math.pi * a * b - pixels[..., 3].sum(dtype=np.float64)
        assert 0.0 <= missing <= TOLERANCE * perimeter


def test_colours_are_interpolated_over_triangles() -> None:
    """Inside, the colour at a pixel's centre is the barycentric mean; it is exact at centres, at edges held in range."""
    corners, colors = np.array([(1.0, 2.0), (30.0, 6.0), (9.0, 28.0)]), np.eye(3)
    pixels = Canvas(32, 32).triangles([corners], [colors]).image().pixels
    y, x = np.mgrid[:32, :32]
    basis = np.linalg.inv(np.vstack([corners.T, np.ones(3)]))
    weights = np.stack([x, y, np.ones_like(x)], axis=-1) @ basis.T
    inside = pixels[..., 3] == 1.0
    assert inside.sum() > 250
    np.testing.assert_allclose(pixels[inside][:, :3], weights[inside], atol=1e-5)
    assert pixels.min() >= 0.0
    assert pixels.max() <= 1.0 + 1e-6


def test_tiles_have_no_seams() -> None:
    """Half transparent triangles that share edges at odd places: one alpha throughout, not two laid over each other."""
    middle = np.array([13.37, 9.71])
    ring = np.array([(2.2, 3.1), (28.4, 1.9), (26.8, 29.3), (3.3, 25.5)])
    corners = [(ring[k], ring[(k + 1) % 4], middle) for k in range(4)]
    pixels = Canvas(32, 32).triangles(corners, np.full((4, 3, 4), 0.5)).image().pixels
    whole = coverage([ring], 32, 32)
    np.testing.assert_allclose(pixels[..., 3], 0.5 * whole, atol=1e-5)


def test_clip_rectangles_cut_exactly_and_nest() -> None:
    """Everything drawn is kept inside, to parts of pixels; the inner of two rectangles counts; afterwards all is open again."""
    canvas = Canvas(16, 16)
    with canvas.clipped(2.25, 3, 9, 9), canvas.clipped(0, 5.75, 20, 20):
        canvas.rectangle(-5, -5, 50, 50, fill="white")
    covered = canvas.image().pixels[..., 3]
    rings = [[(2.25, 5.75), (11.25, 5.75), (11.25, 12), (2.25, 12)]]
    np.testing.assert_allclose(covered, coverage(rings, 16, 16), atol=1e-6)
    for draw in (
        lambda c: c.circle(6, 6, 9, fill="white"),
        lambda c: c.line(0, 0, 16, 13, "white", 5),
        lambda c: c.triangles([[(0, 0), (15, 2), (3, 15)]], np.ones((1, 3, 3))),
        lambda c: c.text(0, 12, "MMM", "white", size=20),
        lambda c: c.paste(Image(np.ones((16, 16, 4), dtype=np.float32)), 0, 0),
    ):
        part, whole = Canvas(16, 16), Canvas(16, 16)
        with part.clipped(1.5, 2.5, 7, 6):
            draw(part)
        draw(whole)
        expected = np.zeros((16, 16))
        expected[3:9, 2:9] = whole.image().pixels[3:9, 2:9, 3]
        np.testing.assert_allclose(part.image().pixels[..., 3], expected, atol=1e-5)
    canvas.rectangle(-5, -5, 50, 50, fill="white")
    assert (canvas.image().pixels[..., 3] == 1.0).all()


def test_what_lies_far_outside_costs_nothing_and_changes_nothing() -> None:
    """A line of a million pixels is where it should be."""
    near = Canvas(20, 20).line(-10, 5, 30, 9, "white", 2).image().pixels
    far = Canvas(20, 20).line(10 - 1e6, 7 - 1e5, 10 + 1e6, 7 + 1e5, "white", 2).image().pixels
    np.testing.assert_allclose(far, near, atol=1e-3)


def test_segments_are_painted_in_order_whatever_the_bands() -> None:
    """Hundreds of lines at once = one call for each, to the bit."""
    rng = np.random.default_rng(5)
    lines, colors = rng.uniform(-5, 45, (300, 4)), rng.uniform(0, 1, (300, 4))
    at_once = Canvas(40, 40).segments(lines, colors, Pen(2.5, cap="round"))
    singly = Canvas(40, 40)
    for line, color in zip(lines, colors, strict=True):
        singly.line(*line, color, Pen(2.5, cap="round"))
    np.testing.assert_allclose(at_once.image().pixels, singly.image().pixels, atol=2e-6)


def test_a_canvas_on_a_picture_leaves_that_alone() -> None:
    """The picture is not changed; what lies beside it goes along; its recipe, which makes another picture, does not."""
    depth = np.ones((3, 4), dtype=np.float32)
    image = Image(np.full((3, 4, 4), 0.5, dtype=np.float32), aov={"depth": depth}, recipe={"samples": 1}, warnings=("dim",))
    drawn = Canvas.on(image).rectangle(-0.5, -0.5, 1, 1, fill="white").image()
    assert (image.pixels == 0.5).all()
    assert drawn.pixels[0, 0].tolist() == [1.0, 1.0, 1.0, 1.0]
    np.testing.assert_allclose(drawn.pixels[1:], 0.5, atol=1e-7)
    assert (drawn.aov["depth"] == depth).all()
    assert drawn.recipe == {}
    assert drawn.warnings == ("dim",)


def test_pictures_are_pasted_where_they_fit() -> None:
    """Whole pixels, over what is there, cut at the border."""
    patch = Image(np.full((3, 3, 4), (1.0, 0.0, 0.0, 0.5), dtype=np.float32))
    pixels = Canvas(4, 4, "black").paste(patch, -1, 2).paste(patch, 9, 9).image().pixels
    expected = np.zeros((4, 4))
    expected[2:, :2] = 0.5
    np.testing.assert_allclose(pixels[..., 0], expected)


def test_colours_are_read_in_all_ways() -> None:
    """sRGB words are decoded, numbers are taken as they stand."""
    assert ink("white") == (1.0, 1.0, 1.0, 1.0)
    assert ink("#f00") == ink("#FF0000FF") == (1.0, 0.0, 0.0, 1.0)
    assert ink("#80808080") == pytest.approx((0.2158605, 0.2158605, 0.2158605, 128 / 255))
    assert ink(0.5) == (0.5, 0.5, 0.5, 1.0)
    assert ink(np.array([0.1, 2.0, 0.3])) == (0.1, 2.0, 0.3, 1.0)
    for wrong in ("red", "#12345", (1, 2), (1, 2, 3, 4), (-1, 0, 0), (math.nan, 0, 0), None, object()):
        with pytest.raises(SceneError, match="color must be"):
            ink(wrong)


def test_colours_for_many_are_one_or_one_each() -> None:
    """A wrong number of them, and the wrong one among them, are named."""
    lines = np.zeros((3, 4))
    Canvas(4, 4).segments(lines, ["#fff", "black", "#f00"]).segments(lines, (1, 0, 0)).segments(lines, np.ones((3, 3)))
    with pytest.raises(SceneError, match="one for each of 3, got 2"):
        Canvas(4, 4).segments(lines, [(1, 1, 1), (0, 0, 0)])
    with pytest.raises(SceneError, match=r"colors\[1\] must be"):
        Canvas(4, 4).segments(lines, ["#fff", "pink", "#f00"])


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        (lambda c: c.fill(Path(), "white", rule="odd"), UnsupportedError, "nonzero, evenodd"),
        (lambda c: c.segments([(1, 2, 3)], "white"), SceneError, r"lines must have shape \(n, 4\)"),
        (lambda c: c.segments([(1, 2, 3, math.nan)], "white"), SceneError, "lines must be finite"),
        (lambda c: c.segments([(1, 2, 3, 4)], "white", Pen(dashes=(1,))), UnsupportedError, "without dashes"),
        (lambda c: c.triangles([[(0, 0), (1, 1), (2, 0)]], np.ones((2, 3, 3))), SceneError, "as many as triangles"),
        (lambda c: c.triangles([[(0, 0), (1, 1), (2, 0)]], -np.ones((1, 3, 3))), SceneError, "must not be negative"),
        (lambda c: c.circle(1e9, 0, 1, fill="white"), SceneError, "within 10000000 pixels"),
        (lambda c: c.paste(Image(np.ones((1, 1, 4), dtype=np.float32)), 0.5, 0), SceneError, "whole pixels"),
        (lambda c: c.clipped(0, 0, -1, 1).__enter__(), SceneError, "clip rectangle"),
        (lambda c: Canvas(0, 4), SceneError, "width must be an integer"),
    ],
)
def test_bad_calls_say_what_is_wrong(wrong, error: type[Exception], message: str) -> None:
    """One line, and nothing has been drawn."""
    canvas = Canvas(4, 4)
    with pytest.raises(error, match=message):
        wrong(canvas)
    assert canvas.commands == []
    assert not canvas.image().pixels.any()


def test_nothing_is_drawn_of_nothing() -> None:
    """Empty paths, lines without length, triangles without area, no lines at all."""
    canvas = Canvas(4, 4)
    canvas.fill(Path(), "white").polygon([], fill="white").polyline([(1, 1)], "white", 3).line(2, 2, 2, 2, "white", 3)
    canvas.segments(np.empty((0, 4)), "white").triangles([[(0, 0), (1, 1), (3, 3)]], np.ones((1, 3, 3)))
    canvas.pixel_lines(np.empty((0, 4)), "white").fill(Path().move_to(1, 1), "white").text(1, 1, "", "white")
    assert not canvas.image().pixels.any()
