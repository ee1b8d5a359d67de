"""A scene as the lines that draw it (FoCG 10.3.1): where it turns away, creases, ends, changes or meets itself, and what hides them.

    drawing = drawing_of(scene, camera, width=800, height=600)
    for line in drawing.lines:
        line.kind, line.picture, line.hidden_by          # "silhouette", (n, 2) pixels from the top left corner, 0: it is seen

A photograph shows every point alike; a drawing shows the few curves from which the eye knows the shape. Each is found on the surface
(`edges`, `contours`, `intersections`), thrown on the picture, and cut exactly where something in front begins or ends to hide it
(`visibility`): there is no grid of samples, and so no jagged ends. What is left is joined to long strokes (`chain`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..scene.camera import Camera

__all__ = ["DEFAULT_KINDS", "KINDS", "Drawing", "FeatureLine", "LineKind"]

LineKind: TypeAlias = Literal[
    "silhouette", "smooth_silhouette", "crease", "boundary", "material", "uv_seam", "intersection", "suggestive_contour"
]
KINDS: tuple[LineKind, ...] = (
    "silhouette", "smooth_silhouette", "crease", "boundary", "material", "uv_seam", "intersection", "suggestive_contour",
)  # fmt: skip
DEFAULT_KINDS: tuple[LineKind, ...] = ("silhouette", "crease", "boundary", "material", "intersection")


@dataclass(frozen=True, eq=False)
class FeatureLine:
    """A stroke: a chain of straight pieces of one kind, hidden by one number of surfaces. Its arrays are read-only.

    Attributes
    ----------
    kind : LineKind
    picture : (n, 2) float64
        Pixels, x to the right and y down from the top left *corner* of the picture; n >= 2. Of a closed line the first point stands
        once more at the end.
    depth : (n,) float64
        Along the gaze, metres: -z_camera.
    world : (n, 3) float64
        Metres.
    hidden_by : int
        How many surfaces lie in front of it, all along: 0, it is seen (quantitative invisibility).
    instance : int
        Which shape it is on, a row of `Drawing.instance_names`.
    closed : bool
    """

    kind: LineKind
    picture: NDArray[np.float64]
    depth: NDArray[np.float64]
    world: NDArray[np.float64]
    hidden_by: int
    instance: int
    closed: bool

    @property
    def length(self) -> float:
        """On the picture, in pixels."""
        return float(np.hypot(*np.diff(self.picture, axis=0).T).sum())


@dataclass(frozen=True, eq=False)
class Drawing:
    """The lines of a scene, for one camera.

    Attributes
    ----------
    lines : tuple of FeatureLine
        Always in the same order for the same scene; they end at the edge of the picture.
    width, height : int
        Pixels.
    camera : Camera
        It stands still.
    pixels_per_metre : float, optional
        The scale of a parallel projection; None: a perspective has none.
    instance_names : tuple of str
        The path of the node of each shape, in the order of the AOV `instance_id`.
    """

    lines: tuple[FeatureLine, ...]
    width: int
    height: int
    camera: Camera
    pixels_per_metre: float | None
    instance_names: tuple[str, ...]

    def of(self, *kinds: LineKind, hidden: bool | None = None) -> tuple[FeatureLine, ...]:
        """The lines of some kinds (none: of all); with `hidden` only those that are hidden, or only those that are not."""
        return tuple(
            line
            for line in self.lines
            if (not kinds or line.kind in kinds) and (hidden is None or (line.hidden_by > 0) == hidden)
        )


# def drawing_of(
#     scene: Scene, camera: Camera | None = None, *, width: int, height: int, kinds: Sequence[LineKind] = DEFAULT_KINDS,
#     crease_degrees: float = 30.0, hidden: bool = True, on_progress: OnProgress | None = None, cancel: threading.Event | None = None,
# ) -> Drawing: ...
