"""Keys over time: against SciPy's interpolators, and what holds at every key."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline, interp1d
from scipy.spatial.transform import Rotation, Slerp

from limner.errors import SceneError
from limner.scene.track import Track

TIMES = np.array([0.5, 1.0, 2.5, 2.75])
LOOKS = np.linspace(0.5, 2.75, 101)


def values(n: int, seed: int = 1) -> np.ndarray:
    """Four rows of n numbers."""
    return np.random.default_rng(seed).normal(size=(4, n))


def test_straight_lines_are_scipys() -> None:
    """At a hundred times between the keys."""
    given_values = values(3)
    np.testing.assert_allclose(Track(TIMES, given_values).at(LOOKS), interp1d(TIMES, given_values, axis=0)(LOOKS), atol=1e-12)


def test_cubic_curves_are_scipys() -> None:
    """Hermite curves with tangents per second; where a key is left in another direction than it was come to, either side counts."""
    keys = np.random.default_rng(2).normal(size=(4, 3, 2))
    made = Track(TIMES, keys, "cubic")
    for k in range(3):
        slopes = np.stack([keys[k, 2], keys[k + 1, 0]])
        inside = np.linspace(TIMES[k], TIMES[k + 1], 17)[:-1]
        expected = CubicHermiteSpline(TIMES[k : k + 2], keys[k : k + 2, 1], slopes)(inside)
        np.testing.assert_allclose(made.at(inside), expected, atol=1e-12)


def test_rotations_are_scipys_slerp() -> None:
    """At constant speed, the short way round."""
    keys = Rotation.random(4, rng=np.random.default_rng(3)).as_quat()
    made = Track(TIMES, keys, rotates=True).at(LOOKS)
    expected = Slerp(TIMES, Rotation.from_quat(keys))(LOOKS)
    assert (Rotation.from_quat(made) * expected.inv()).magnitude().max() < 1e-7


def test_steps_change_at_the_key() -> None:
    """A value stands until the next key's time, and from then on is that."""
    track = Track((0.0, 1.0, 2.0), (10.0, 20.0, 30.0), "step")
    assert track.at([0.0, 0.999, 1.0, 1.5, 2.0, 9.0])[:, 0].tolist() == [10.0, 10.0, 20.0, 20.0, 30.0, 30.0]


@given(st.sampled_from(["step", "linear", "cubic"]), st.integers(0, 3), st.integers(0, 1 << 30))
def test_every_key_is_met(interpolation: str, k: int, seed: int) -> None:
    """At its time a track has the key's very value; before the first and after the last, theirs."""
    keys = values(5, seed)
    track = Track(TIMES, np.stack([keys, keys, keys], axis=1) if interpolation == "cubic" else keys, interpolation)  # type: ignore[arg-type]
    np.testing.assert_allclose(track.at(TIMES[k]), keys[k], rtol=1e-15, atol=1e-15)
    np.testing.assert_allclose(track.at([-9.0, 9.0]), keys[[0, -1]], rtol=1e-15, atol=1e-15)


def test_one_time_is_as_many() -> None:
    """Asked alone or together, a time gives the same bits."""
    track = Track(TIMES, values(3))
    np.testing.assert_array_equal(track.at(LOOKS), [track.at(time) for time in LOOKS])


def test_one_key_is_constant() -> None:
    """At all times; a quaternion is made unit."""
    np.testing.assert_allclose(Track.constant((0, 0, 0, 2), rotates=True).at([0.0, 5.0]), [(0, 0, 0, 1)] * 2)
    assert Track.constant(3.0).at(1.0).tolist() == [3.0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((), ()), "track.times must be a list of times"),
        (((0.0, 0.0), (1.0, 2.0)), "track.times must grow, got 0 and 0 at keys 0 and 1"),
        (((1.0, 0.5), (1.0, 2.0)), "track.times must grow"),
        (((0.0, np.nan), (1.0, 2.0)), "track.times must be finite"),
        (((0.0, 1.0), (1.0,)), "track.values must have shape"),
        (((0.0, 1.0), (1.0, np.inf)), "track.values must be finite"),
        (((0.0, 1.0), ((1.0,), (2.0,)), "cubic"), "track.values must have shape"),
        (((0.0,), (1.0,), "smooth"), "track.interpolation must be"),
        (((0.0,), ((1.0, 2.0, 3.0),), "linear", True), "quaternions"),
        (((0.0,), "never"), "track.values must be numbers"),
    ],
)
def test_bad_keys_are_refused(arguments: tuple, message: str) -> None:
    """In one line that says which field, and what was expected."""
    with pytest.raises(SceneError, match=message):
        Track(*arguments)
