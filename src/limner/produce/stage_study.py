"""One scene as the stages of the pipeline see it: what the panels of `limner.produce.stages` show, each thing made once, when it is wanted.

    study = Study(scene, None, 400, 300, 16, None, None)
    study.main.taken                what the pipeline has of the picture (`limner.raster.stages.Capture`)
    study.close                     of a part of it, so near that single triangles are seen
    study.window                    of a frame in that part, clipped to it
    study.clay                      the scene in plain materials
"""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..draw.wireframe import Seen
from ..image.image import Image
from ..scene.camera import Camera, OrthographicCamera
from ..scene.framing import extent_points, framing_camera, with_defaults
from ..scene.material import BlinnPhong, CoolToWarm, Dielectric, Lambert, Material, MetallicRoughness, ShadowCatcher
from ..scene.node import Node
from ..scene.scene import Scene
from ..scene.texture import AnyTexture, Texels, Texture
from ..tables import layouts
from ..tables.build import View, flatten, view
from ..tables.layouts import SceneTables
from .wireframe import Edges, edges_of, lines_seen

if TYPE_CHECKING:
    from ..raster.stages import Capture

__all__ = ["COVERAGE_SAMPLES", "Look", "Stopped", "Study", "cuts", "face_keys", "part_of"]

COVERAGE_SAMPLES = 16
"""As `limner.raster.stages.N_SAMPLES`, which is not imported until something is computed."""

_CLEAR_EDGE = 14.0  # pixels that an edge should be long to be seen as one
_MOST_ZOOM = 32
_WINDOW = 0.2  # of the panel, that is left on each side of the frame that clips
_CHECKS, _CHECK_TEXELS = 8, 64  # of the borrowed texture: on a side, and in each


class Stopped(Exception):  # noqa: N818 - no error: the user's wish
    """A picture was cancelled."""


def part_of(camera: Camera, width: int, height: int, box: tuple[float, float, float, float]) -> Camera:
    """The camera whose whole picture is a part of another's.

    Parameters
    ----------
    camera : Camera
    width, height : int
        Of its picture.
    box : (left, top, width, height) of float
        The part, pixels from the upper left corner.

    >>> part_of(OrthographicCamera(height=4.0), 8, 8, (4.0, 0.0, 4.0, 4.0)).lens()
    Lens(half_height=1.0, pixel_aspect=1.0, shift_x=1.0, shift_y=1.0)
    """
    left, top, w, h = box
    shift_x = (camera.shift_x + (2.0 * left + w - width) / width) * width / w
    shift_y = (camera.shift_y + (height - 2.0 * top - h) / height) * height / h
    fields: dict[str, Any] = {"shift_x": shift_x, "shift_y": shift_y, "aspect": None}
    if isinstance(camera, OrthographicCamera):
        return camera.replace(height=camera.height * h / height, **fields)
    half = camera.half_height() * h / height
    return camera.replace(yfov_degrees=float(np.degrees(2.0 * np.arctan(half))), **fields)


class Look(NamedTuple):
    """A camera, and what the pipeline makes of what it sees."""

    camera: Camera
    view: View
    taken: Capture


class Study:
    """One scene, and everything that the panels show of it; each thing is made when the first panel asks for it."""

    def __init__(
        self, scene: Scene, camera: Camera | None, width: int, height: int, samples: int, threads: int | None,
        cancel: threading.Event | None,
    ) -> None:  # fmt: skip
        from ..tiles import thread_count

        self.width, self.height, self.samples = width, height, samples
        self._threads, self._cancel = thread_count(threads), cancel
        chosen = camera or scene.camera or framing_camera(extent_points(scene), width / height)
        self._given = scene
        self.scene, self.messages = with_defaults(scene.replace(camera=chosen), width / height)
        self.camera = chosen
        self.tables: SceneTables = flatten(self.scene, chosen, width, height).tables
        self.warnings: list[str] = []

    def look(
        self, camera: Camera, width: int, height: int, clipping: str = "homogeneous", tables: SceneTables | None = None
    ) -> Look:
        """Send the scene's triangles, or those of other tables of it, through the pipeline."""
        from ..raster.stages import capture

        if self._cancel is not None and self._cancel.is_set():
            raise Stopped
        tables = self.tables if tables is None else tables
        seen = view(self.scene, tables, camera, width, height)
        return Look(camera, seen, capture(tables, seen, width, height, clipping=clipping, threads=self._threads))

    def render(self, scene: Scene, **options: Any) -> Image:
        """A picture of the same camera's."""
        from ..render import Renderer

        with Renderer(scene, width=self.width, height=self.height, threads=self._threads, **options) as renderer:
            image = renderer.render(self.camera, cancel=self._cancel)
        if not image.finished:
            raise Stopped
        self.warnings += [slip for slip in image.warnings if slip not in (*self.warnings, *self.messages)]
        return image

    # --- shared by several panels ----------------------------------------------------------------------------------------

    @cached_property
    def main(self) -> Look:
        """The picture itself."""
        return self.look(self.camera, self.width, self.height)

    @cached_property
    def edges(self) -> Edges:
        return edges_of(self.tables, planes=True)

    @cached_property
    def lines(self) -> Seen:
        return lines_seen(self.edges, self.camera, self.main.taken.channels["depth"])

    @cached_property
    def edge_length(self) -> float:
        """Pixels: the median of the edges that are seen, pieces of less than half a pixel aside."""
        seen = self.lines.lines[self.lines.visible]
        length = np.hypot(seen[:, 2] - seen[:, 0], seen[:, 3] - seen[:, 1])
        length = length[length > 0.5]
        return float(np.median(length)) if len(length) else float(self.width)

    @cached_property
    def zoom(self) -> int:
        """How many times the model must be enlarged round its middle for triangles to be seen one by one: a power of two."""
        x, y = self.middle
        reach = 0.15 * self.width
        box = (slice(max(0, int(y - reach)), int(y + reach) + 1), slice(max(0, int(x - reach)), int(x + reach) + 1))
        seen = self.main.taken.seen[box]
        n = len(np.unique(face_keys(*self.main.taken.faces[box][seen].T)))
        # An equilateral triangle of side s has the area sqrt(3)/4 s^2.
        side = np.sqrt(4.0 / np.sqrt(3.0) * seen.sum() / n) if n else _CLEAR_EDGE
        return int(np.clip(2.0 ** np.round(np.log2(_CLEAR_EDGE / side)), 1, _MOST_ZOOM))

    @cached_property
    def middle(self) -> tuple[float, float]:
        """Where a close look is directed: the visible pixel nearest to the middle of all; from the upper left corner."""
        rows, columns = np.nonzero(self.main.taken.seen)
        if not len(rows):
            return self.width / 2.0, self.height / 2.0
        nearest = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
        return float(columns[nearest]) + 0.5, float(rows[nearest]) + 0.5

    @cached_property
    def close(self) -> Look:
        """As the picture, but so near that single triangles are seen."""
        if self.zoom == 1:
            return self.main
        w, h = self.width / self.zoom, self.height / self.zoom
        box = self.middle[0] - w / 2.0, self.middle[1] - h / 2.0, w, h
        return self.look(part_of(self.camera, self.width, self.height, box), self.width, self.height)

    @cached_property
    def window(self) -> tuple[Look, tuple[int, int]]:
        """What the frame in the middle of the close look shows, clipped to it; and its corner there."""
        x, y = round(_WINDOW * self.width), round(_WINDOW * self.height)
        w, h = self.width - 2 * x, self.height - 2 * y
        return self.look(part_of(self.close.camera, self.width, self.height, (x, y, w, h)), w, h, "world"), (x, y)

    @cached_property
    def covered(self) -> tuple[NDArray[np.int32], bool]:
        """Samples that are covered in each pixel; without infinite planes where these leave nothing to be seen of it, and whether so."""
        samples, bounded = self.main.taken.samples, self.tables.instances["kind"] != layouts.PLANE
        if (samples < COVERAGE_SAMPLES).any() or bounded.all() or not bounded.any():
            return samples, False
        from ..raster.stages import capture

        rest = self.tables.instances[bounded]
        rest["owner"] = np.cumsum(bounded, dtype=np.int32)[rest["owner"]] - 1  # rows are named by their number
        tables = self.tables._replace(instances=rest)
        seen = View(self.main.view.camera, np.ascontiguousarray(self.main.view.raster_from_object[bounded]))
        return capture(tables, seen, self.width, self.height, threads=self._threads).samples, True

    @cached_property
    def clay(self) -> Scene:
        """Of plain materials with a highlight and without textures: what tells ways of shading apart."""
        return self.scene.replace(root=_repainted(self.scene.root, _clay), background=None)

    @cached_property
    def has_uv(self) -> NDArray[np.bool_]:
        """(height, width): where the surface has texture coordinates."""
        instances, faces = self.tables.instances, self.main.taken.faces
        exact = np.isin(instances["kind"], (layouts.SPHERE, layouts.PLANE))
        known = exact | (self.tables.meshes["uv"][instances["mesh"]] >= 0) if len(instances) else np.zeros(0, dtype=bool)
        return self.main.taken.seen & np.append(known, False)[faces[..., 0]]

    @cached_property
    def borrows(self) -> bool:
        """Whether the model could wear a texture and has none."""
        return bool(self.has_uv.any()) and not (self.tables.materials["color_texture"] >= 0).any()

    @cached_property
    def dressed(self) -> tuple[Scene, Capture]:
        """The scene with its textures, or with a borrowed one; and its way through the pipeline."""
        if not self.borrows:
            return self.scene, self.main.taken
        scene = self.scene.replace(root=_repainted(self.scene.root, _checkered))
        tables = flatten(scene, self.camera, self.width, self.height).tables
        return scene, self.look(self.camera, self.width, self.height, tables=tables).taken

    @cached_property
    def aliased(self) -> Image:
        return self.render(self.dressed[0].replace(background=None), samples=1)

    @cached_property
    def smooth(self) -> Image:
        return self.render(self.dressed[0].replace(background=None), samples=self.samples)

    @cached_property
    def picture(self) -> Image:
        return self.render(self.scene, samples=self.samples)

    def facts(self) -> dict[str, Any]:
        """What the numbers on the sheet are."""
        taken, tables = self.main.taken, self.tables
        instances = tables.meshes[tables.instances["mesh"]] if len(tables.instances) else tables.meshes[:0]
        depth, layers = taken.channels["depth"][taken.seen], taken.layers[taken.seen]
        levels = self.dressed[1].mip_level
        levels = levels[np.isfinite(levels)]
        window, _ = self.window
        borrowed = ["the model has no texture: panels 12 to 15 show a borrowed chessboard"] if self.borrows else []
        return {
            "width": self.width,
            "height": self.height,
            "samples": self.samples,
            "vertices": int(instances["n_positions"].sum()),
            "triangles": int(instances["n_triangles"].sum()),
            "screen_triangles": len(taken.screen),
            "fragments": int(taken.layers.sum()),
            "pixels": int(taken.seen.sum()),
            "partly_covered": int(((taken.samples > 0) & (taken.samples < COVERAGE_SAMPLES)).sum()),
            "overdraw": _spread(layers),
            "depth": _spread(depth),
            "mip_level": {"least": float(levels.min()), "greatest": float(levels.max())} if len(levels) else None,
            "clipping": {"zoom": self.zoom, **cuts(window.taken)},
            "notes": [*self._given.notes, *self.messages, *borrowed],
            "warnings": self.warnings if taken.seen.any() else ["nothing of the scene is seen", *self.warnings],
        }


def face_keys(instance: NDArray[Any], triangle: NDArray[Any]) -> NDArray[np.int64]:
    """Instance and triangle in one number."""
    return instance.astype(np.int64) << 32 | triangle.astype(np.int64) & 0xFFFFFFFF


def _spread(values: NDArray[Any]) -> dict[str, float] | None:
    if not len(values):
        return None
    return {"least": float(values.min()), "mean": float(values.mean(dtype=np.float64)), "greatest": float(values.max())}


def cuts(taken: Capture) -> dict[str, int]:
    """How many triangles are ``whole`` on the screen, how many were ``cut``, and into how many ``pieces``."""
    pieces = taken.screen[taken.cut]
    return {"whole": int((~taken.cut).sum()), "cut": len(np.unique(pieces[["instance", "triangle"]])), "pieces": len(pieces)}


# --- other materials ------------------------------------------------------------------------------------------------------


def _repainted(node: Node, paint: Callable[[Material], Material]) -> Node:
    children = []
    for child in node.children:  # a comprehension's own frame would halve the depth of the graphs that fit on the stack
        children.append(_repainted(child, paint))
    shapes = tuple(dataclasses.replace(shape, materials=tuple(map(paint, shape.materials))) for shape in node.shapes)
    return dataclasses.replace(node, shapes=shapes, children=tuple(children))


def _clay(material: Material) -> Material:
    if isinstance(material, ShadowCatcher):
        return material
    painted, color = _texture_of(material)
    masked = material.alpha_mode == "mask"
    red, green, blue = (0.1 + 0.9 * part for part in color)  # light must show on what is black, too
    return BlinnPhong(
        diffuse=(0.55, 0.55, 0.55) if painted is not None and not masked else (red, green, blue), specular=(0.3, 0.3, 0.3), exponent=40.0,
        emission=material.emission if painted is None else (0.0, 0.0, 0.0), diffuse_texture=painted if masked else None,
        double_sided=material.double_sided, alpha=material.alpha, alpha_mode=material.alpha_mode, alpha_cutoff=material.alpha_cutoff,
        name=material.name,
    )  # fmt: skip


def _texture_of(
    material: Lambert | BlinnPhong | MetallicRoughness | Dielectric | CoolToWarm,
) -> tuple[AnyTexture | None, tuple[float, float, float]]:
    if isinstance(material, Lambert):
        return material.texture, material.color
    if isinstance(material, BlinnPhong):
        return material.diffuse_texture, material.diffuse
    if isinstance(material, Dielectric):
        return None, material.tint
    if isinstance(material, CoolToWarm):
        return None, material.warm
    return material.base_color_texture, material.base_color


def _checkered(material: Material) -> Material:
    texture, white = Texture(_chessboard()), (0.8, 0.8, 0.8)
    if isinstance(material, Lambert):
        return dataclasses.replace(material, texture=texture, color=white)
    if isinstance(material, BlinnPhong):
        return dataclasses.replace(material, diffuse_texture=texture, diffuse=white)
    if isinstance(material, MetallicRoughness):
        return dataclasses.replace(material, base_color_texture=texture, base_color=white, metallic=0.0)
    return material


def _chessboard() -> Texels:
    side = _CHECKS * _CHECK_TEXELS
    dark = (np.indices((side, side)) // _CHECK_TEXELS).sum(axis=0) % 2 == 1
    texels = np.full((side, side, 4), 255, dtype=np.uint8)
    texels[dark, :3] = 120
    return Texels(texels, name="chessboard")
