"""A scene as the lines that draw it (FoCG 10.3.1): where it turns away, creases, ends, changes or meets itself, and what hides them.

    drawing = drawing_of(scene, camera, width=800, height=600)
    for line in drawing.lines:
        line.kind, line.picture, line.hidden_by          # "silhouette", (n, 2) pixels from the top left corner, 0: it is seen

A photograph shows every point alike; a drawing shows the few curves from which the eye knows the shape. Each is found on the surface
(`outlines`, `edges`, `contours`, `intersections`), thrown on the picture, and cut exactly where something in front begins or ends to hide
it (`visibility`): there is no grid of samples, and so no jagged ends. What is left is joined to long strokes (`chain`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, UnsupportedError
from ..linear.project import check_size
from ..progress import Meter, OnProgress
from ..scene.camera import Camera
from ..scene.framing import with_defaults
from ..scene.scene import Scene
from ..tiles import Cancel, Cancelled
from .chain import Stroke, strokes_of
from .contours import suggestive_contours
from .doubles import without_doubles
from .edges import Faces, Wanted, edge_kinds, edge_segments, faces_of
from .intersections import intersection_segments
from .outlines import outlines
from .relief import faint
from .segments import ROUNDING, Segments, joined
from .sight_lines import SightLines, sight_lines
from .stitches import StitchKinds, stitched
from .surfaces import Surfaces, surfaces_of
from .visibility import hiding_triangles, parts_of, thrown

__all__ = ["DEFAULT_KINDS", "KINDS", "Drawing", "FeatureLine", "LineKind", "drawing_of"]

LineKind: TypeAlias = Literal[
    "silhouette", "smooth_silhouette", "crease", "boundary", "material", "uv_seam", "intersection", "suggestive_contour"
]
KINDS: tuple[LineKind, ...] = (
    "silhouette", "smooth_silhouette", "crease", "boundary", "material", "uv_seam", "intersection", "suggestive_contour",
)  # fmt: skip
DEFAULT_KINDS: tuple[LineKind, ...] = ("silhouette", "crease", "boundary", "material", "intersection")

_LEAST_SUGGESTION = 8.0  # pixels
_LEAST = 0.1  # pixels: what is shorter would be a dot, as wide as the pen


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
    bridged : (n - 1,) bool, optional
        Which of the pieces between points are drawn as seen though a part is hidden, or the other way round: a part that is too short to be
        told from what is beside it. None: none of them.
    """

    kind: LineKind
    picture: NDArray[np.float64]
    depth: NDArray[np.float64]
    world: NDArray[np.float64]
    hidden_by: int
    instance: int
    closed: bool
    bridged: NDArray[np.bool_] | None = None

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
            line for line in self.lines if (not kinds or line.kind in kinds) and (hidden is None or (line.hidden_by > 0) == hidden)
        )


def drawing_of(
    scene: Scene,
    camera: Camera | None = None,
    *,
    width: int,
    height: int,
    kinds: Sequence[LineKind] = DEFAULT_KINDS,
    crease_degrees: float = 30.0,
    hidden: bool = True,
    on_progress: OnProgress | None = None,
    cancel: Cancel | None = None,
) -> Drawing:
    """Find the lines of a scene and what hides them.

    Parameters
    ----------
    scene : Scene
    camera : Camera, optional
        None: the scene's, else one that frames everything. Perspective or parallel; its lens is a pinhole, and it stands as at time 0.
    width, height : int >= 1
        Of the picture, pixels. Lines end at its edges, at the camera's near plane, and at its far plane where it has one.
    kinds : sequence of LineKind
        An edge that fits more than one is a boundary before it is a silhouette, then a crease, a change of material, a seam.
    crease_degrees : float from 0 to 180
        An edge is a crease where the surface turns by more, and does not because of its grain; at 0 every edge is.
    hidden : bool
        Whether lines that something hides are kept.
    on_progress : callable, optional
        Takes a `Progress` now and then.
    cancel : threading.Event, optional
        Set, it stops the work, which raises `limner.tiles.Cancelled`: half of the surfaces hide the wrong lines.

    Returns
    -------
    Drawing
        The same for the same arguments, to the bit.

    Notes
    -----
    Exact shapes are drawn by the triangles that stand for them, a tenth of a pixel from their surface; infinite planes have no lines but
    those in which other surfaces meet them. Where one line is seen exactly behind another, the nearer one is drawn, for as long as it is
    there. A "silhouette" is smooth where triangles are too small to be told from the smooth surface that they stand for, and runs along
    edges elsewhere; a "smooth_silhouette" is smooth everywhere. The grain of what is scanned is not drawn: silhouettes are of the surface
    without it, and only where something stands out by more than a line is wide. Strokes have the points that they need to be right to a
    tenth of a pixel.

    **Source**: FoCG 10.3.1.
    """
    numbers = _numbers_of(kinds)
    if not 0.0 <= crease_degrees <= 180.0:
        raise SceneError(f"crease_degrees must lie in [0, 180], got {crease_degrees}")
    check_size(width, height)
    scene = scene if camera is None else scene.replace(camera=camera)
    scene, _ = with_defaults(scene, width / height, lights=False)
    assert scene.camera is not None
    standing = scene.camera.standing()
    meter = Meter(on_progress, "draw")

    def report(done: float) -> None:
        if cancel is not None and cancel.is_set():
            raise Cancelled
        meter.report(done)

    report(0.0)
    surfaces = surfaces_of(scene, standing, width, height)
    report(0.1)
    sight = sight_lines(standing, width, height, surfaces.points)
    faces = faces_of(surfaces)
    found = without_doubles(thrown(_segments_of(surfaces, faces, sight, numbers, crease_degrees, report), sight), sight)
    report(0.5)
    triangles, source = hiding_triangles(surfaces, sight)
    parts = parts_of(found, triangles, source, sight, lambda done: report(0.5 + 0.4 * done))
    silhouettes = np.isin(found.segments.kind, (numbers["silhouette"], numbers["smooth_silhouette"]))
    rough = silhouettes | (found.segments.kind == numbers["crease"])
    smooth = rough & (found.segments.slack > 2.0 * ROUNDING * surfaces.extent)
    strokes = strokes_of(found, parts, sight, smooth, faint(found, surfaces, faces, sight, triangles, source))
    lines = tuple(line for line in map(_line_of, strokes) if (hidden or line.hidden_by == 0) and not _is_hair(line))
    report(1.0)
    names = tuple(placed.path for placed, _ in scene.shapes())
    return Drawing(lines, width, height, standing, None if sight.perspective else sight.pixels, names)


def _numbers_of(kinds: Sequence[LineKind]) -> dict[LineKind, int]:
    """The rows of the kinds asked for; -1 for all others."""
    if isinstance(kinds, str):
        raise SceneError(f"kinds must be a sequence of kinds of lines, got {kinds!r}")
    for kind in kinds:
        if kind not in KINDS:
            raise UnsupportedError(f"kinds must be of {', '.join(KINDS)}, got {kind!r}")
    return {kind: row if kind in kinds else -1 for row, kind in enumerate(KINDS)}


def _segments_of(
    surfaces: Surfaces, faces: Faces, sight: SightLines, numbers: dict[LineKind, int], crease_degrees: float,
    report: Callable[[float], object],
) -> Segments:  # fmt: skip
    """All pieces of lines, whatever hides them."""
    wanted = Wanted(*(numbers[kind] for kind in ("boundary", "crease", "material", "uv_seam")))
    edges = edge_kinds(surfaces, faces, wanted, crease_degrees)
    report(0.25)
    where_solids_meet = StitchKinds(numbers["silhouette"], numbers["crease"], numbers["boundary"])
    seams, replaced = stitched(surfaces, faces, edges.sharp, sight, where_solids_meet, crease_degrees)
    parts, free = [seams], np.ones(len(edges.kind), dtype=bool)
    for kind in ("silhouette", "smooth_silhouette"):
        if numbers[kind] >= 0:
            found = outlines(surfaces, faces, sight, edges, numbers[kind], smooth=kind == "smooth_silhouette")
            # An edge that both have a part in is one line, that of the first.
            rest = [] if not free.all() else [found.rest]
            parts += [found.segments, *rest]
            free &= found.free
    parts.append(edge_segments(surfaces, faces, edges, free & ~replaced, sight))
    if numbers["intersection"] >= 0:
        parts.append(intersection_segments(surfaces, numbers["intersection"], lambda done: report(0.25 + 0.15 * done)))
    if numbers["suggestive_contour"] >= 0:
        parts.append(suggestive_contours(surfaces, faces.adjacency, sight, numbers["suggestive_contour"]))
    return joined(parts)


def _is_hair(line: FeatureLine) -> bool:
    """Whether it is too short to be seen, or, of a mere suggestion, to suggest anything."""
    return line.length < (_LEAST_SUGGESTION if line.kind == "suggestive_contour" else _LEAST)


def _line_of(stroke: Stroke) -> FeatureLine:
    kind, bridged = KINDS[stroke.kind], stroke.bridged if stroke.bridged.any() else None
    for array in (stroke.picture, stroke.depth, stroke.world, stroke.bridged):
        array.flags.writeable = False
    return FeatureLine(kind, stroke.picture, stroke.depth, stroke.world, stroke.hidden_by, stroke.instance, stroke.closed, bridged)
