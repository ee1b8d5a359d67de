"""The triangles that a pixel shows, in every space on their way to the screen (FoCG 7), and what clipping does to them (FoCG 8.1)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..linear.explain import Steps, point_to_pixel
from ..raster.layouts import SUBPIXELS
from ..render import Frame
from .story import Step
from .values import shortest

__all__ = ["seen_triangles", "triangle_in_every_space"]

_NAMED = re.compile(r"triangle (\d+) of instance (\d+)((?: \([^()]*\))?)")
_MOST = 8


def seen_triangles(steps: Sequence[Step]) -> list[tuple[int, int, str]]:
    """(instance, triangle, name in brackets) of what is named in a story as seen: by rays that met it, and by samples in the end."""
    found: dict[tuple[int, int, str], None] = {}
    for root in steps:
        for step in root.walk():
            told = " ".join(step.result) if step.title == "seen in the end" and isinstance(step.result, dict) else ""
            told += step.title if step.kind == "ray" else ""
            for triangle, instance, name in _NAMED.findall(told):
                found[int(instance), int(triangle), name] = None
    return list(found)


def triangle_in_every_space(
    frame: Frame, steps: Sequence[Step], width: int, height: int, screen: NDArray[np.void] | None = None
) -> list[Step]:
    """A step for each triangle that was seen, with its vertices in object, world, camera, clip, NDC, raster and pixel coordinates.

    Parameters
    ----------
    frame : Frame
    steps : sequence of Step
        The story that tells what was seen.
    width, height : int
        Of the picture.
    screen : (n,) SCREEN_TRIANGLE, optional
        What clipping left of the triangles around the pixel, on the subpixel grid.
    """
    told = []
    for instance, triangle, name in seen_triangles(steps)[:_MOST]:
        tables = frame.built.tables
        if instance >= len(tables.instances) or tables.instances[instance]["mesh"] < 0:
            continue
        record = tables.instances[instance]
        mesh = tables.meshes[record["mesh"]]
        if triangle >= mesh["n_triangles"]:
            continue
        rows = tables.triangles[mesh["triangle"] + triangle][:3] + mesh["position"]
        world_from_object = np.vstack([np.asarray(record["world_from_object"], dtype=np.float64), [0.0, 0.0, 0.0, 1.0]])
        near, far = float(frame.view.camera[0]["near"]), float(frame.view.camera[0]["far"])
        ways = [
            point_to_pixel(
                frame.camera, tables.positions[row], width, height, near=near, far=far if np.isfinite(far) else None,
                world_from_object=world_from_object,
            )
            for row in rows
        ]  # fmt: skip
        vertices = [_vertex(k, way) for k, way in enumerate(ways)]
        title = f"triangle {triangle} of instance {instance}{name} on its way to the screen"
        cut = [_clipped(ways, near), *_on_screen(screen, instance, triangle)]
        told.append(Step(title, {}, None, "raster_from_object = M_vp M_per M_cam M", "", "FoCG 7, 8", "spaces", [*vertices, *cut]))
    return told


def _vertex(k: int, way: Steps) -> Step:
    spaces = [
        Step(
            f"{step.space} space", {}, [shortest(float(value)) for value in step.coordinates], step.formula, step.matrix_name,
            f"FoCG {step.section}", "space",
        )
        for step in way
    ]  # fmt: skip
    return Step(f"vertex {k}", kind="vertex", steps=spaces)


def _on_screen(screen: NDArray[np.void] | None, instance: int, triangle: int) -> list[Step]:
    """What the rasteriser made of a triangle: one on the subpixel grid, or several where it was cut."""
    if screen is None:
        return []
    rows = screen[(screen["instance"] == instance) & (screen["triangle"] == triangle)]
    steps = []
    for row in rows:
        corners = [[float(x) / SUBPIXELS, float(y) / SUBPIXELS] for x, y in zip(row["x"], row["y"], strict=True)]
        slopes = {"per pixel right": shortest(row["dzdx"]), "per pixel up": shortest(row["dzdy"])}
        terms: dict[str, Any] = {"depth": shortest(row["z"]), **slopes}
        terms["at pixel"] = [int(row["x_reference"]), int(row["y_reference"])]
        formula = f"corners rounded to 1/{SUBPIXELS} pixel, rows from the bottom; near/depth is linear on the screen"
        steps.append(Step("on the screen", terms, corners, formula, "raster.assemble.assemble_triangles", "FoCG 8.1.2, 8.2.3", "screen"))
    return steps


def _clipped(ways: Sequence[Steps], near: float) -> Step:
    """Which vertices lie before the near plane or behind the eye, where the triangle has to be cut."""
    depths = [-float(next(step for step in way if step.space == "camera").coordinates[2]) for way in ways]
    cut = [k for k, depth in enumerate(depths) if depth < near]
    title = "no vertex lies before the near plane: nothing is clipped"
    if cut:
        title = f"vertices {', '.join(map(str, cut))} lie before the near plane: clipped there"
    return Step(title, {"depths": [shortest(depth) for depth in depths], "near": shortest(near)}, source="FoCG 8.1.3", kind="note")
