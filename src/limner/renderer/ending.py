"""What ends a picture before all its samples are taken, as it is asked for."""

from __future__ import annotations

import math
import os

from ..budget import Budget
from ..errors import SceneError, UnsupportedError

__all__ = ["checked_budget"]


def checked_budget(
    renderer: str, sampler: str | None, noise: float | None, time_limit: float | None, checkpoint: str | os.PathLike[str] | None,
    checkpoint_seconds: float, resume: bool, on_snapshot: object,
) -> Budget | None:  # fmt: skip
    """What ends a picture beside its number of samples; None: nothing."""
    if noise is None and time_limit is None and checkpoint is None and on_snapshot is None:
        if resume:
            raise SceneError("resume needs the checkpoint to go on from")
        return None
    if renderer != "path":
        raise UnsupportedError(f'noise, time_limit, checkpoint and on_snapshot are for renderer="path", got {renderer!r}')
    for name, value in (("noise", noise), ("time_limit", time_limit), ("checkpoint_seconds", checkpoint_seconds)):
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if value is not None and not (is_number and math.isfinite(value) and value > 0):
            raise SceneError(f"{name} must be a positive number, got {value!r}")
    if (noise is not None or time_limit is not None) and sampler not in (None, "sobol", "random"):
        raise UnsupportedError(f'the sampler {sampler!r} must know the number of samples beforehand; "sobol" need not')
    if checkpoint is not None and not isinstance(checkpoint, (str, os.PathLike)):
        raise SceneError(f"checkpoint must be a path, got {checkpoint!r}")
    if on_snapshot is not None and not callable(on_snapshot):
        raise SceneError(f"on_snapshot must be a function of an Image, got {type(on_snapshot).__name__}")
    return Budget(noise, time_limit, checkpoint, float(checkpoint_seconds), bool(resume))
