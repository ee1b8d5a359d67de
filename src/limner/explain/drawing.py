"""What the pictures of a story are drawn from: rays that were followed, triangles that were seen, boxes of what stands around."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..linear.explain import point_to_pixel
from ..render import Frame
from ..tables.build import names as names_of
from .story import Step

__all__ = ["drawing_of"]

_MOST_BOXES = 200
_MOST_RAYS = 400
_MISS = 0.3  # of the scene's size: how long a ray is drawn that meets nothing


def drawing_of(frame: Frame, story: Step, lobes: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Plain values.

    Parameters
    ----------
    frame : Frame
        Of the picture.
    story : Step
    lobes : sequence of dict
        As `limner.explain.lobes` makes them.

    Returns
    -------
    dict
        ``triangles``: of each that was seen its three corners in the picture, in pixels; ``rays``: each with ``from`` and ``to`` in the
        world, ``kind`` ("eye", "ray", "shadow", "blocked") and ``pixels``, the same in the picture, None where one end lies behind the
        eye; ``boxes``: of what stands around, with names; ``eye``; ``lobes``.
    """
    boxes = _boxes(frame)
    corners = np.array([corner for box in boxes for corner in (box["low"], box["high"])]).reshape(-1, 3)
    reach = float(np.linalg.norm(np.ptp(corners, axis=0))) if len(corners) else 1.0
    height, width = frame.film.sums.shape[:2]
    rays = [_ray(frame, step, reach or 1.0, width, height) for step in story.walk() if _is_ray(step)][:_MOST_RAYS]
    return {"triangles": _triangles(story), "rays": rays, "boxes": boxes, "eye": _eye(frame), "lobes": list(lobes)}


def _eye(frame: Frame) -> list[float]:
    return [float(x) for x in frame.camera.world_from_camera[:3, 3]]


def _is_ray(step: Step) -> bool:
    return "o" in step.terms and "d" in step.terms and step.kernel.startswith("accel.walk.")


def _ray(frame: Frame, step: Step, reach: float, width: int, height: int) -> dict[str, Any]:
    start, way = np.array(step.terms["o"], dtype=np.float64), np.array(step.terms["d"], dtype=np.float64)
    limit = float(step.terms.get("t_max", math.inf))
    t = float(step.result["t"]) if isinstance(step.result, dict) else limit
    end = start + way * (t if math.isfinite(t) else _MISS * reach / max(float(np.linalg.norm(way)), 1e-9))
    is_eye = step.kind == "ray" and step.title.startswith("ray 1 ")
    kind = "eye" if is_eye else "ray" if step.kind == "ray" else "blocked" if isinstance(step.result, dict) else "shadow"
    places = [_pixel(frame, point, width, height) for point in (start, end)]
    pixels = None if is_eye or None in places else places
    return {"from": start.tolist(), "to": end.tolist(), "kind": kind, "pixels": pixels, "title": step.title}


def _pixel(frame: Frame, point: Any, width: int, height: int) -> list[float] | None:
    x, y = point_to_pixel(frame.camera, point, width, height).at("pixel")[:2]
    return [float(x), float(y)] if math.isfinite(x) and math.isfinite(y) else None


def _triangles(story: Step) -> list[dict[str, Any]]:
    """The triangles that stand in the story in every space."""
    found = []
    for step in (step for step in story.steps if step.kind == "spaces"):
        vertices = [vertex for vertex in step.steps if vertex.kind == "vertex"]
        places = [next(space.result for space in vertex.steps if space.title == "pixel space")[:2] for vertex in vertices]
        if all(isinstance(number, float) for place in places for number in place):
            found.append({"title": step.title.removesuffix(" on its way to the screen"), "corners": places})
    return found


def _boxes(frame: Frame) -> list[dict[str, Any]]:
    paths = names_of(frame.scene)["instance_id"]
    found: list[dict[str, Any]] = []
    for name, (placed, shape) in zip(paths, frame.scene.shapes(), strict=False):
        low, high = (np.asarray(corner, dtype=np.float64) for corner in shape.geometry.bounds)
        if len(found) == _MOST_BOXES:
            break
        if np.isfinite(low).all() and np.isfinite(high).all() and (low <= high).all():
            local = np.array([[x, y, z, 1.0] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
            corners = (local @ placed.world_from_object.T)[:, :3]
            found.append({"name": name, "low": corners.min(axis=0).tolist(), "high": corners.max(axis=0).tolist()})
    return found
