"""Strokes, dots and areas: as dark as what they stand for, on what they stand for, the same every time."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.artistic.fill import areas_of, clipped, outlines
from limner.artistic.hatching import hatching
from limner.artistic.tone import sampled, stippling, tone_of
from limner.draw.canvas import Canvas
from limner.draw.path import Path
from limner.errors import SceneError


def disk(size: int = 64, radius: float = 24.0) -> NDArray[np.int32]:
    """Ids of a disk in the middle: 0 on its left half, 1 on its right, -1 around it."""
    y, x = np.mgrid[0.5:size, 0.5:size] - size / 2.0
    return np.where(np.hypot(x, y) < radius, (x > 0).astype(np.int32), np.int32(-1))


def test_strokes_lie_on_one_thing_in_the_dark() -> None:
    """Sampled along each stroke: one id, a tone below the threshold; as long together as the area says, a line every few pixels."""
    ids = disk()
    tone = np.tile(np.linspace(0.0, 1.0, 64), (64, 1))
    strokes = hatching(tone, ids, spacing=3.0, angles=(45.0,), thresholds=(0.5,))
    assert strokes
    share = np.linspace(0.01, 0.99, 40)[:, None]
    for start, end in strokes:
        places = start + share * (end - start)
        column, row = np.floor(places).astype(int).T
        assert len(set(ids[row, column].tolist())) == 1
        assert ids[row[0], column[0]] >= 0
        assert (sampled(tone, places) < 0.5 + 0.02).all()
        assert np.isclose(abs((end - start)[0]), abs((end - start)[1]))
    length = sum(float(np.linalg.norm(end - start)) for start, end in strokes)
    dark = int(((ids >= 0) & (tone < 0.5)).sum())
    assert abs(length * 3.0 / dark - 1.0) < 0.1


def test_darker_places_have_more_layers() -> None:
    """The ink on black, grey and white falls, and white has none."""
    ids = np.zeros((40, 40), dtype=np.int32)
    ink = [sum(float(np.linalg.norm(b - a)) for a, b in hatching(np.full((40, 40), tone), ids)) for tone in (0.0, 0.3, 0.5, 0.9)]
    assert ink[0] > ink[1] > ink[2] > ink[3] == 0.0


def test_dots_are_as_dark_as_the_picture_and_spread() -> None:
    """Their area is that of the ink; each half has its share; no two are close; the same seed, the same dots."""
    tone = np.where(np.arange(80) < 40, 0.4, 0.8)[None, :] * np.ones((60, 1))
    covered = np.ones(tone.shape, dtype=bool)
    dots = stippling(tone, covered, radius=1.0)
    assert abs(len(dots) * np.pi - (1.0 - tone).sum()) < np.pi
    left = dots[:, 0] < 40.0
    assert abs(left.mean() - 0.75) < 0.03
    gaps = np.linalg.norm(dots[:, None] - dots[None], axis=2) + np.where(np.eye(len(dots)) > 0, np.inf, 0.0)
    spacing = np.sqrt(np.pi / 0.6)  # of a square grid with the density of the left half
    assert gaps[left].min() > 0.35 * spacing
    assert gaps[left][:, left].min(axis=1).std() < 0.25 * spacing
    assert (dots == stippling(tone, covered, radius=1.0)).all()
    assert ((dots > 0.0) & (dots < (80.0, 60.0))).all()


def test_nothing_is_drawn_where_nothing_is() -> None:
    """An empty picture, and one that is all white."""
    nothing = np.full((8, 8), -1, dtype=np.int32)
    assert hatching(np.zeros((8, 8)), nothing) == []
    assert stippling(np.zeros((8, 8)), nothing >= 0).shape == (0, 2)
    assert stippling(np.ones((8, 8)), np.ones((8, 8), dtype=bool)).shape == (0, 2)


def test_tone_is_lightness() -> None:
    """Middle grey, which reflects 18 parts in a hundred, looks half as light as white."""
    pixels = np.array([[[0.0] * 3, [0.184] * 3, [1.0] * 3, [9.0] * 3]], dtype=np.float32)
    assert np.allclose(tone_of(pixels), [[0.0, 0.5, 1.0, 1.0]], atol=0.001)


@pytest.mark.parametrize("seed", range(3))
def test_outlines_cover_what_the_triangles_cover(seed: int) -> None:
    """Random overlapping triangles, turned either way: filled by their outline, the same coverage as filled one by one as a union."""
    rng = np.random.default_rng(seed)
    shared = rng.uniform(2.0, 38.0, (14, 2))
    corners = shared[np.array([rng.choice(14, 3, replace=False) for _ in range(24)])]
    one, other = Path(), Path()
    for ring in outlines(corners):
        one.polyline(ring, closed=True)
    for triangle in corners:
        a, b, c = triangle
        turned = triangle if np.linalg.det([b - a, c - a]) > 0.0 else triangle[::-1]
        other.polyline(turned, closed=True)
    pictures = [Canvas(40, 40).fill(path, "black").image().pixels[..., 3] for path in (one, other)]
    assert np.abs(pictures[0] - pictures[1]).max() < 1e-4


def test_a_ring_that_is_cut_covers_the_same() -> None:
    """A star that winds twice round its middle and reaches far out: within the picture nothing changes, outside there is nothing."""
    turn = 4.0 * np.pi / 5.0 * np.arange(5) + 0.3
    star = 20.0 + 35.0 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    cut = clipped(star, (-2.0, -2.0), (42.0, 42.0))
    pictures = [Canvas(40, 40).fill(Path().polyline(ring, True), "black").image().pixels[..., 3] for ring in (star, cut)]
    assert np.abs(pictures[0] - pictures[1]).max() < 1e-5
    assert ((cut >= -2.0) & (cut <= 42.0)).all()
    assert len(clipped(star, (90.0, 0.0), (95.0, 40.0))) == 0


def test_a_disk_has_one_outline() -> None:
    """A fan of triangles in one plane: its rim alone, and each owner has areas of its own, in order."""
    turn = 2.0 * np.pi * np.arange(12) / 12
    rim = 20.0 + 10.0 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    fan = np.stack([np.full((12, 2), 20.0), rim, np.roll(rim, -1, axis=0)], axis=1)
    (ring,) = outlines(fan)
    assert sorted(map(tuple, ring.tolist())) == sorted(map(tuple, rim.tolist()))
    areas = areas_of(np.concatenate([fan, fan + 1.0, fan]), np.repeat([0, 1, 0], 12))
    assert [area.owner for area in areas] == [0, 1, 0]
    assert areas_of(np.zeros((0, 3, 2)), np.zeros(0, dtype=np.int64)) == []
    assert outlines(np.zeros((3, 3, 2))) == []


def test_slips() -> None:
    """One line each."""
    with pytest.raises(SceneError, match="spacing"):
        hatching(np.zeros((4, 4)), np.zeros((4, 4), dtype=np.int32), spacing=0.0)
    with pytest.raises(SceneError, match="radius"):
        stippling(np.zeros((4, 4)), np.ones((4, 4), dtype=bool), radius=0.0)
    with pytest.raises(SceneError, match="more than"):
        stippling(np.zeros((900, 900)), np.ones((900, 900), dtype=bool), radius=1.0)
