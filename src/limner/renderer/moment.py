"""Which moment of a scene a picture shows: a time, or while a shutter is open."""

from __future__ import annotations

import math

from ..errors import SceneError, UnsupportedError

__all__ = ["Moment", "checked_moment", "checked_shutter"]

Moment = tuple[float | None, str | int | None]


def checked_moment(
    shutter: tuple[float, float] | None, time: float | None, animation: str | int | None
) -> Moment | None:
    """The time and the animation to show, no time where it is the shutter's; None where no animation is asked for."""
    if time is not None:
        if shutter is not None:
            raise UnsupportedError("a picture is of one time, or of a shutter's; give time or shutter, not both")
        try:
            number = float(time)
        except (TypeError, ValueError):
            raise SceneError(f"time must be a number of seconds, got {time!r}") from None
        if not math.isfinite(number):
            raise SceneError(f"time must be finite, got {number}")
        return number, animation
    if shutter is not None:
        return None, animation
    return None if animation is None else (0.0, animation)


def checked_shutter(shutter: tuple[float, float] | None, renderer: str, time: float | None) -> tuple[float, float]:
    if shutter is None or time is not None:
        return 0.0, 0.0
    try:
        opens, closes = (float(time) for time in shutter)
    except (TypeError, ValueError):
        raise SceneError(f"shutter must be two times, as in (0.0, 1.0), got {shutter!r}") from None
    if not (math.isfinite(opens) and math.isfinite(closes) and opens <= closes):
        raise SceneError(f"the shutter must not close before it opens, got {opens} and {closes}")
    if opens < closes and renderer == "raster":
        raise UnsupportedError("raster sees one time only; ray and path can leave the shutter open")
    return opens, closes
