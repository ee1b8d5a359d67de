"""The media that a ray carries: entering, leaving, and who fills the place."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from compiled import door_of

from limner._door import Array
from limner._jit import kernel
from limner.shading.medium import cross_surface, filling, passed, within, without
from limner.tables.layouts import MEDIUM


@kernel
def _cross_all(media, steps, out):
    """Follow steps (n, 2) of medium and whether it is entered; out (n, 3): before, after, inside."""
    inside = np.int64(0)
    for k in range(steps.shape[0]):
        crossing = cross_surface(inside, media, steps[k, 0], steps[k, 1] != 0)
        inside = crossing.inside
        out[k, 0], out[k, 1], out[k, 2] = crossing.before, crossing.after, inside


@kernel
def _pass(media, distances, out):
    for k in range(distances.shape[0]):
        left = passed(media, 1, distances[k])
        out[k, 0], out[k, 1], out[k, 2] = left.r, left.g, left.b


@kernel
def _stack(media, numbers, out):
    for k in range(numbers.shape[0]):
        out[k, 0] = within(numbers[k, 0], numbers[k, 1])
        out[k, 1], out[k, 2] = without(numbers[k, 0], numbers[k, 1]), filling(numbers[k, 0], media)


def _media(*priorities: int) -> np.ndarray:
    media = np.zeros(1 + len(priorities), dtype=MEDIUM)
    media["priority"] = (np.iinfo(np.int32).min, *priorities)
    return media


def _crossed(media: np.ndarray, steps: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """(before, after) at each step."""
    out = np.zeros((len(steps), 3), dtype=np.int64)
    door_of(_cross_all, Array(MEDIUM, 1), Array(np.int64, 2), Array(np.int64, 2))(media, np.array(steps, dtype=np.int64), out)
    assert out[-1, 2] == 0 or not _is_closed(steps)
    return [(int(a), int(b)) for a, b, _ in out]


def _is_closed(steps: list[tuple[int, int]]) -> bool:
    return all(sum(1 if entered else -1 for m, entered in steps if m == medium) == 0 for medium, _ in steps)


@pytest.mark.parametrize("order", list(itertools.permutations([(1, 0), (2, 0), (3, 0)])))
def test_the_place_belongs_to_the_highest_priority(order):
    """Entered in the order 1, 2, 3 and left in any: at every step it is the highest of those it is in."""
    priorities = {1: 5, 2: 9, 3: 7}
    steps = [(1, 1), (2, 1), (3, 1), *order]
    holding: list[int] = []
    expected = []
    for medium, entered in steps:
        before = max(holding, key=priorities.__getitem__, default=0)
        holding = [*holding, medium] if entered else [m for m in holding if m != medium]
        expected.append((before, max(holding, key=priorities.__getitem__, default=0)))
    assert _crossed(_media(5, 9, 7), steps) == expected


def test_among_equals_the_last_one_entered_counts():
    """As bubbles in glass in water need it: in and out again, each what it was before."""
    steps = [(1, 1), (2, 1), (3, 1), (3, 0), (2, 0), (1, 0)]
    assert _crossed(_media(0, 0, 0), steps) == [(0, 1), (1, 2), (2, 3), (3, 2), (2, 1), (1, 0)]


def test_the_same_medium_twice_has_no_surface_between():
    """Two balls of one glass that overlap are one body."""
    assert _crossed(_media(0), [(1, 1), (1, 1), (1, 0), (1, 0)]) == [(0, 1), (1, 1), (1, 1), (1, 0)]


def test_leaving_what_was_never_entered_begins_in_it():
    assert _crossed(_media(0, 3), [(1, 0), (2, 0)]) == [(1, 0), (2, 0)]


def test_seven_deep_and_no_deeper():
    """Seven media in one another; what comes on top of them does not make them forgotten."""
    media = _media(*range(9))
    steps = [(m, 1) for m in range(1, 10)] + [(m, 0) for m in range(9, 0, -1)]
    found = _crossed(media, steps)
    assert found[:7] == [(m - 1, m) for m in range(1, 8)]
    assert found[-1] == (1, 0)


def test_numbers_as_stacks():
    numbers = np.array([(0, 7), (7, 7), (7 + 256 * 5, 5), (7 + 256 * 5 + 65536 * 7, 7), (9, 3)], dtype=np.int64)
    out = np.zeros((5, 3), dtype=np.int64)
    door_of(_stack, Array(MEDIUM, 1), Array(np.int64, 2), Array(np.int64, 2))(_media(*[0] * 12), numbers, out)
    assert out[:, 1].tolist() == [0, 0, 7, 5 + 256 * 7, 9]
    assert out[:, 2].tolist() == [0, 7, 7, 7, 9]
    assert out[:2, 0].tolist() == [7, 7 + 256 * 7]


def test_beer():
    """exp(-a d); all of it where a is 0, even after an endless way, and nothing else after one."""
    media = _media(0)
    media[1]["attenuation"] = (0.0, 0.5, 3.0)
    distances = np.array([0.0, 0.1, 1.0, 30.0, np.inf], dtype=np.float32)
    out = np.zeros((5, 3), dtype=np.float32)
    door_of(_pass, Array(MEDIUM, 1), Array(np.float32, 1), Array(np.float32, 2))(media, distances, out)
    expected = np.stack([np.ones(5), np.exp(-0.5 * distances), np.exp(-3.0 * distances)], axis=1)
    np.testing.assert_allclose(out, expected, rtol=3e-6, atol=1e-37)
