"""A model as the lines it is made of, those behind its surfaces left out or drawn otherwise (FoCG 8.1.1, 8.2.3, 10.3.1).

    limner.wireframe("part.glb").image().save("part.png")
    limner.wireframe("part.glb", edges="features", hidden="#c8ccd2").svg()        what a technical drawing shows
    limner.wireframe("part.glb", shaded=True, color="#00000080").image()          lines over the shaded picture

The raster pipeline says how deep each pixel's surface lies; what of a line is nearer than that is seen (`limner.draw.wireframe`). The
lines stay lines: they are smooth at any width, and the same drawing is an SVG.

An edge is a *feature* where a surface ends or turns sharply, or where it turns away from the eye: a silhouette.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..draw.canvas import Canvas
from ..draw.ink import Ink, ink
from ..draw.stroke import Pen
from ..draw.wireframe import Seen, draw_wireframe, visible_segments
from ..errors import SceneError, UnsupportedError
from ..linear.affine import transform_points
from ..linear.projection import camera_from_world
from ..progress import OnProgress
from ..scene.camera import Camera, PerspectiveCamera
from ..scene.framing import with_defaults
from ..scene.scene import Scene
from ..tables import layouts
from ..tables.build import flatten
from ..tables.layouts import SceneTables

__all__ = ["EDGES", "Edges", "edges_of", "features", "lines_seen", "wireframe"]

EDGES = ("all", "features")

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class Edges(NamedTuple):
    """The edges of all shapes of a scene, each once, in the world.

    Attributes
    ----------
    starts, ends : (n, 3) float64
    normals : (n, 2, 3) float64
        Unit, of the triangles on both sides; NaN: there is none, or it has no area.
    branching : (n,) bool
        Whether more than two triangles meet.
    """

    starts: Floats
    ends: Floats
    normals: Floats
    branching: NDArray[np.bool_]


def wireframe(
    scene: Any,
    *,
    width: int = 800,
    height: int = 600,
    camera: Camera | None = None,
    edges: str = "all",
    crease_degrees: float = 30.0,
    color: Ink = "black",
    line_width: float = 1.0,
    hidden: Ink | None = None,
    background: Ink | None = "white",
    shaded: bool = False,
    samples: int | None = None,
    threads: int | None = None,
    on_progress: OnProgress | None = None,
    **options: Any,
) -> Canvas:
    """Draw the edges of a scene's triangles.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        As for `limner.render`. Infinite planes have no edges, but they hide what is behind them.
    width, height : int
        Pixels.
    camera : Camera, optional
        As for `limner.render`.
    edges : "all" | "features"
        All edges of all triangles; or those where a surface ends, turns by more than `crease_degrees`, or turns away from the eye.
    crease_degrees : float from 0 to 180
    color : colour
        Of lines that are seen: (r, g, b) in linear light, "#rrggbb", "#rrggbbaa", "black", "white".
    line_width : float > 0
        Pixels.
    hidden : colour, optional
        Of lines behind surfaces, which are drawn two thirds as wide; None: they are left out.
    background : colour, optional
        None: transparent.
    shaded : bool
        Whether the shaded model lies under the lines.
    samples, threads, on_progress, **options
        Of that picture, as for `limner.render`: renderer, seed, ….

    Returns
    -------
    Canvas
        ``.image()`` is the picture, ``.svg()`` the same as vectors.

    **Source**: FoCG 8.2.3 (the z-buffer's test), 10.3.1 (silhouettes and creases).
    """
    if edges not in EDGES:
        raise UnsupportedError(f"edges must be one of {', '.join(EDGES)}, got {edges!r}")
    if not 0.0 <= crease_degrees <= 180.0:
        raise SceneError(f"crease_degrees must lie in [0, 180], got {crease_degrees}")
    if not (math.isfinite(line_width) and line_width > 0.0):
        raise SceneError(f"line_width must be positive, got {line_width}")
    line_ink, hidden_ink = ink(color), None if hidden is None else ink(hidden, "hidden")
    ground = None if background is None else ink(background, "background")
    from ..files.interop import as_scene
    from ..render import Renderer

    scene = (scene if isinstance(scene, Scene) else as_scene(scene)).replace(background=None)
    # Made first: it is what refuses sizes and options.
    renderer = Renderer(
        scene, width=width, height=height, samples=samples if shaded else 1, threads=threads, aovs=("depth",), **options
    )
    if camera is not None:
        scene = scene.replace(camera=camera)
    scene, _ = with_defaults(scene, width / height)
    assert scene.camera is not None
    with renderer:
        picture = renderer.render(scene.camera, on_progress=on_progress)
    if not picture.finished:
        raise KeyboardInterrupt  # which the renderer heard, and half a picture hides no lines
    found = edges_of(flatten(scene, scene.camera, width, height).tables)
    if edges == "features":
        chosen = features(found, scene.camera, crease_degrees)
        found = Edges(found.starts[chosen], found.ends[chosen], found.normals[chosen], found.branching[chosen])
    canvas = Canvas(width, height, ground)
    if shaded:
        canvas.paste(picture, 0, 0)
    seen = lines_seen(found, scene.camera, picture.aov["depth"])
    pen = Pen(line_width, cap="round")
    return draw_wireframe(canvas, seen, line_ink, pen, hidden_ink, Pen(line_width * 2.0 / 3.0, cap="round"))


def lines_seen(edges: Edges, camera: Camera, depth: NDArray[np.float32]) -> Seen:
    """Project edges and cut them where surfaces hide them; see `limner.draw.wireframe.visible_segments`.

    Parameters
    ----------
    edges : Edges
    camera : Camera
    depth : (height, width) float32
        Of the same camera's picture: the channel `depth`.
    """
    height, width = depth.shape
    perspective = isinstance(camera, PerspectiveCamera)
    return visible_segments(
        edges.starts, edges.ends, camera_from_world(camera), camera.intrinsics(width, height), perspective=perspective, width=width,
        height=height, depth=depth, near=camera.near if perspective else None,
    )  # fmt: skip


# --- edges ----------------------------------------------------------------------------------------------------------------


def edges_of(tables: SceneTables, *, planes: bool = False) -> Edges:
    """The edges of what is in tables, instance by instance; corners in one place are one, whatever their normals.

    `planes`: with those of the disks that stand for infinite planes.
    """
    meshes: dict[int, _Topology] = {}
    parts = []
    for instance in tables.instances:
        if instance["mesh"] < 0 or (instance["kind"] == layouts.PLANE and not planes):
            continue
        row = int(instance["mesh"])
        if row not in meshes:
            meshes[row] = _topology(tables, row)
        parts.append(_placed(meshes[row], instance["world_from_object"]))
    if not parts:
        return Edges(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 2, 3)), np.zeros(0, dtype=bool))
    return Edges(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


class _Topology(NamedTuple):
    """Of one mesh: points, triangles (m, 3), edges (n, 2), the triangles beside each (n, 2; -1: none), whether there are more."""

    points: Floats
    triangles: Indices
    edges: Indices
    beside: Indices
    branching: NDArray[np.bool_]


def _topology(tables: SceneTables, row: int) -> _Topology:
    mesh = tables.meshes[row]
    points = tables.positions[mesh["position"] : mesh["position"] + mesh["n_positions"]].astype(np.float64) + 0.0  # -0 is 0
    points, place = np.unique(points, axis=0, return_inverse=True)
    triangles = place.reshape(-1)[tables.triangles[mesh["triangle"] : mesh["triangle"] + mesh["n_triangles"]]]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    keys, edge_of, count = np.unique(sides[:, 0] * len(points) + sides[:, 1], return_inverse=True, return_counts=True)
    owner = np.argsort(edge_of, kind="stable") // 3  # triangles, edge after edge
    first = np.cumsum(count) - count
    last = np.minimum(first + 1, max(len(owner) - 1, 0))
    beside = np.column_stack([owner[first], np.where(count > 1, owner[last], -1)])
    return _Topology(points, triangles, np.column_stack(divmod(keys, max(len(points), 1))), beside, count > 2)


def _placed(mesh: _Topology, world_from_object: NDArray[np.float32]) -> Edges:
    points = transform_points(np.vstack([world_from_object.astype(np.float64), (0.0, 0.0, 0.0, 1.0)]), mesh.points)
    a, b, c = points[mesh.triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    with np.errstate(invalid="ignore"):
        normals /= np.linalg.norm(normals, axis=1)[:, None]
    normals = np.vstack([normals, np.full(3, np.nan)])  # what row -1 reads
    return Edges(points[mesh.edges[:, 0]], points[mesh.edges[:, 1]], normals[mesh.beside], mesh.branching)


def features(edges: Edges, camera: Camera, crease_degrees: float = 30.0) -> NDArray[np.bool_]:
    """(n,) bool: which edges end a surface, crease it by more than an angle, or are its silhouette for a camera."""
    first, second = edges.normals[:, 0], edges.normals[:, 1]
    place = np.asarray(camera.world_from_camera)
    towards = place[:3, 3] - edges.starts if isinstance(camera, PerspectiveCamera) else np.broadcast_to(place[:3, 2], edges.starts.shape)
    with np.errstate(invalid="ignore"):
        creased = (first * second).sum(axis=1) < math.cos(math.radians(crease_degrees))
        sides = [(normal * towards).sum(axis=1) for normal in (first, second)]
        silhouette = (sides[0] > 0.0) != (sides[1] > 0.0)
    ends = np.isnan(second).any(axis=1) | np.isnan(first).any(axis=1)
    return ends | edges.branching | creased | silhouette
