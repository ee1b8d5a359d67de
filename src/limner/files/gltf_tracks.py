"""Tracks that are put together, because what a file says in several numbers is one field here, or the other way round.

Where all have keys at the same times and go alike between them, nothing is lost. Where they go straight, or stand still, the times of all
keys are enough. Otherwise there are so many keys that straight lines between them are as good as what they came from.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..scene.track import Track

__all__ = ["dense", "key_times", "still", "together"]

Floats = NDArray[np.float64]

_DENSE = 32  # keys between two, where what is to be put together does not go straight


def together(parts: Sequence[Track | ArrayLike]) -> Track:
    """Tracks, and numbers that do not change, side by side in one track.

    Parameters
    ----------
    parts : sequence of Track or (n,) floats
        At least one of them a track.
    """
    tracks = [part for part in parts if isinstance(part, Track)]
    first = tracks[0]
    if all(np.array_equal(track.times, first.times) and track.interpolation == first.interpolation for track in tracks):
        columns = [part.values if isinstance(part, Track) else still(part, first) for part in parts]
        return Track(first.times, np.concatenate(columns, axis=-1), first.interpolation)
    times = key_times(tracks)
    columns = [part.at(times) if isinstance(part, Track) else np.tile(np.asarray(part), (len(times), 1)) for part in parts]
    return Track(times, np.concatenate(columns, axis=-1), "step" if _all_go(tracks, "step") else "linear")


def still(value: ArrayLike, like: Track) -> Floats:
    """What does not change, as a track of the same keys has it."""
    numbers = np.asarray(value, dtype=np.float64)
    values = np.zeros((*like.values.shape[:-1], len(numbers)))
    (values[:, 1] if like.interpolation == "cubic" else values)[:] = numbers
    return values


def key_times(tracks: Sequence[Track]) -> Floats:
    """The times of all keys, and more between them where the tracks do not all go straight, or all stand still."""
    times = np.unique(np.concatenate([track.times for track in tracks]))
    return times if _all_go(tracks, "linear") or _all_go(tracks, "step") else _with_more(times)


def dense(track: Track) -> Track:
    """Keys so near to each other that straight lines between them are as good as what they came from; what stands still stays."""
    if track.is_constant or track.interpolation == "step":
        return Track(track.times, track.at(track.times), "step" if track.interpolation == "step" else "linear")
    times = _with_more(track.times)
    return Track(times, track.at(times))


def _all_go(tracks: Sequence[Track], how: str) -> bool:
    return all(track.interpolation == how or track.is_constant for track in tracks)


def _with_more(times: Floats) -> Floats:
    if len(times) < 2:
        return times
    return np.unique(np.concatenate([np.linspace(a, b, _DENSE + 1) for a, b in pairwise(times)]))
