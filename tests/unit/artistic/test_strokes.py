"""Strokes of a hand: what is added does not tear a drawing apart."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from limner.artistic.strokes import by_depth, resampled, swelling, waver, wavering

ZIGZAG = np.array([(0.0, 0.0), (50.0, 5.0), (40.0, 60.0), (90.0, 40.0)])


def area(ring: np.ndarray) -> float:
    """By the shoelace formula."""
    x, y = ring.T
    return float(abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2.0)


def test_further_points_lie_on_the_line() -> None:
    """The line's own points stay, and no step is longer than asked."""
    made = resampled(ZIGZAG, 3.0)
    steps = np.linalg.norm(np.diff(made, axis=0), axis=1)
    assert steps.max() <= 3.0 + 1e-9
    assert np.isclose(steps.sum(), np.linalg.norm(np.diff(ZIGZAG, axis=0), axis=1).sum())
    assert all((np.abs(made - corner).sum(axis=1) < 1e-12).any() for corner in ZIGZAG)


def test_the_field_is_smooth_and_spreads() -> None:
    """Values between -1 and 1 that change by little over little, differ between seeds, and have mean 0."""
    places = np.random.default_rng(3).uniform(-4000.0, 4000.0, (4000, 2))
    values = waver(places, 60.0, 1)
    assert np.abs(values).max() <= 1.0
    assert abs(values.mean()) < 0.05
    assert values.std() > 0.25
    assert np.abs(waver(places + 0.01, 60.0, 1) - values).max() < 0.01 * 2 * 3.0 / 30.0 * 2
    assert abs(np.corrcoef(values, waver(places, 60.0, 2))[0, 1]) < 0.1


def test_lines_that_meet_still_meet() -> None:
    """Whatever lines a place is on, it is moved alike, by no more than is allowed."""
    other = np.array([(40.0, 60.0), (10.0, 90.0)])
    a, b = wavering(ZIGZAG, 4.0, 40.0), wavering(other, 4.0, 40.0)
    assert np.linalg.norm(a - b[0], axis=1).min() < 1e-12
    assert 1.0 < np.abs(a - resampled(ZIGZAG, 40.0 / 12.0)).max() <= 4.0
    assert wavering(ZIGZAG, 0.0) is ZIGZAG


def test_strokes_have_the_width_they_are_to_have() -> None:
    """Of even width: area is length times width; tapered: ends without width; closed: a band."""
    line = np.array([(0.0, 0.0), (100.0, 0.0)])
    assert np.isclose(area(swelling(line, 4.0)), 400.0)
    tapered = swelling(line, 4.0, taper=1.0)
    assert np.allclose(tapered[0], tapered[-1])
    assert np.isclose(np.abs(tapered[:, 1]).max(), 2.0, atol=0.01)
    turn = 2.0 * np.pi * np.arange(181) / 180
    circle = 30.0 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    radius = np.linalg.norm(swelling(circle, 4.0, taper=1.0, closed=True), axis=1)
    assert np.allclose(np.sort(radius), np.repeat([28.0, 32.0], len(radius) // 2), atol=0.02)


def test_pieces_by_depth_make_up_the_line() -> None:
    """Each begins where the one before ends, their lengths add up, and their farness grows with depth in equal steps."""
    pieces = by_depth(ZIGZAG, np.array([2.0, 4.0, 6.0, 8.0]), 2.0, 8.0, levels=6)
    assert [round(5 * piece.farness) for piece in pieces] == [0, 1, 2, 3, 4, 5]
    for before, after in pairwise(pieces):
        assert (before.points[-1] == after.points[0]).all()
    total = sum(np.linalg.norm(np.diff(piece.points, axis=0), axis=1).sum() for piece in pieces)
    assert np.isclose(total, np.linalg.norm(np.diff(ZIGZAG, axis=0), axis=1).sum())
    assert [piece.farness for piece in by_depth(ZIGZAG, np.full(4, 3.0), 3.0, 3.0)] == [0.0]
