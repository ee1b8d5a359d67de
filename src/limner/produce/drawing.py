"""A scene as a line drawing, and the files that hold one: SVG, PDF, DXF, or a picture (FoCG 3.1.2, 10.3.1).

    limner.drawing("part.glb").save("part.svg")
    limner.drawing("part.glb", style="xray", width=1200, height=900).save("part.pdf")
    limner.drawing("part.glb", camera=camera, style="technical", scale=0.5).save("part.dxf")      half as large as it is

What is saved are lines, whatever the size: they can be printed, cut, edited, and measured. The same scene gives the same bytes.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..artistic.lines import DEFAULT_KINDS, Drawing, LineKind
from ..artistic.plate import page_of, placing
from ..artistic.style import LineStyle, line_style
from ..draw.ink import Ink, Rgba, ink
from ..draw.page import Page, page_image
from ..errors import RenderError, UnsupportedError
from ..image.image import Image
from ..image.save import check_destination
from ..progress import OnProgress
from ..scene.camera import Camera
from ..scene.scene import Scene
from .folder import put

__all__ = ["TONES", "VECTOR_EXTENSIONS", "Plate", "check_plate", "drawing", "lines_of"]

TONES = ("hatching", "stippling")
VECTOR_EXTENSIONS = (".svg", ".pdf", ".dxf")


@dataclass(frozen=True, eq=False)
class Plate:
    """Lines on a page, ready for a file.

    Attributes
    ----------
    page : Page
    drawings : mapping from str to Drawing
        What is on it, by the names of the views.
    facts : dict
        Plain values about it that JSON can hold.
    """

    page: Page
    drawings: Mapping[str, Drawing] = field(default_factory=dict)
    facts: dict[str, Any] = field(default_factory=dict)

    def svg(self) -> str:
        """The page as SVG; see `limner.draw.svg_page`."""
        from ..draw.svg_page import page_svg

        return page_svg(self.page)

    def pdf(self) -> bytes:
        """The page as PDF; see `limner.draw.pdf`."""
        from ..draw.pdf import page_pdf

        return page_pdf(self.page)

    def dxf(self) -> bytes:
        """The page as DXF; see `limner.draw.dxf`."""
        from ..draw.dxf import page_dxf

        return page_dxf(self.page)

    def image(self, dpi: float | None = None) -> Image:
        """The page as a picture, of `dpi` dots per inch; None: 96 of a page in pixels, so that they are its own, else 150."""
        return page_image(self.page, self._dpi(dpi))

    def save(self, path: str | os.PathLike[str], *, dpi: float | None = None) -> None:
        """Write the page to a file.

        Parameters
        ----------
        path : str or path-like
            .svg, .pdf or .dxf for lines; for a picture an extension that `limner.Image.save` knows.
        dpi : float > 0, optional
            Of a picture.
        """
        check_plate(path)
        kind = Path(path).suffix.lower()
        if kind not in VECTOR_EXTENSIONS:
            image, fine = self.image(dpi), self._dpi(dpi)
            image.save(path, dpi=fine if kind == ".png" and self.page.unit == "mm" else None)
            return
        data = {".svg": lambda: self.svg().encode(), ".pdf": self.pdf, ".dxf": self.dxf}[kind]()
        put(Path(os.path.realpath(path)), data)

    def _dpi(self, dpi: float | None) -> float:
        return dpi if dpi is not None else 96.0 if self.page.unit == "px" else 150.0


def check_plate(path: str | os.PathLike[str]) -> None:
    """Refuse a place where no plate can be written, before any work is done for it."""
    name = os.fspath(path)
    vector = Path(name).suffix.lower() in VECTOR_EXTENSIONS
    # The same questions of its folder as for any picture.
    asked = f"{name[:-4]}.png" if vector and not Path(name).is_dir() else name
    try:
        check_destination(asked)
    except RenderError as error:
        raise RenderError(str(error).replace(asked, name)) from error
    except UnsupportedError as error:
        raise UnsupportedError(f"{error}, or {', '.join(VECTOR_EXTENSIONS)}") from error


def drawing(
    scene: Any,
    *,
    width: int = 800,
    height: int = 600,
    camera: Camera | None = None,
    style: LineStyle | str = "plain",
    kinds: Sequence[LineKind] = DEFAULT_KINDS,
    crease_degrees: float = 30.0,
    tone: str | None = None,
    fill: bool = False,
    scale: float | None = None,
    unit_mm: float = 1000.0,
    background: Ink | None = "white",
    title: str = "",
    threads: int | None = None,
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
) -> Plate:
    """Draw the lines of a scene.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        As for `limner.render`.
    width, height : int
        Of the picture, pixels.
    camera : Camera, optional
        As for `limner.render`.
    style : LineStyle or str
        "plain", "technical" (with hidden lines, dashed), "sketch", "xray", "chalk".
    kinds : sequence of LineKind
        Which lines: "silhouette", "smooth_silhouette", "crease", "boundary", "material", "uv_seam", "intersection", "suggestive_contour".
    crease_degrees : float from 0 to 180
        The least turn of a crease.
    tone : "hatching" | "stippling", optional
        How light and shade are shown, as `raster` sees them; None: not at all.
    fill : bool
        Whether what is seen of each shape is filled with its mean colour, as areas under the lines: vectors, too, in the painter's order.
        Shapes that pierce or entwine each other are cut by planes, for which a scene may have 10,000 triangles.
    scale : float > 0, optional
        Millimetres on paper for each of the model, where the camera is parallel; None: the page is in pixels.
    unit_mm : float > 0
        Millimetres of one unit of the model.
    background : colour, optional
        None: transparent.
    title : str
        For the files that hold one; "": the scene's name.
    threads, on_progress, cancel
        As for `limner.render`.

    Returns
    -------
    Plate

    **Source**: FoCG 10.3.1.
    """
    from ..files.interop import as_scene

    chosen = line_style(style)
    if tone not in (None, *TONES):
        raise UnsupportedError(f"tone must be one of {', '.join(TONES)}, got {tone!r}")
    scene = scene if isinstance(scene, Scene) else as_scene(scene)
    made = lines_of(
        scene, camera, width=width, height=height, kinds=kinds, crease_degrees=crease_degrees, hidden=chosen.shows_hidden,
        on_progress=on_progress, cancel=cancel,
    )  # fmt: skip
    below = []
    if tone is not None or fill:
        from .shade import shade_layers

        place = placing(made, scale, unit_mm)
        below = shade_layers(scene, made, place, tone=tone, fill=fill, color=_color_of(chosen), threads=threads)
    page = page_of(made, chosen, scale=scale, unit_mm=unit_mm, background=background, below=below, title=title or scene.name)
    return Plate(page, {"": made}, {"lines": len(made.lines), "width": made.width, "height": made.height})


def _color_of(style: LineStyle) -> Rgba:
    """What strokes of tone are drawn with: the ink of the lines that are seen."""
    return ink("black" if style.visible is None else style.visible.color)


def lines_of(scene: Scene, camera: Camera | None, **options: Any) -> Drawing:
    """The drawing of `limner.artistic.lines`; that it was stopped is said as other errors are."""
    from ..artistic.lines import drawing_of
    from ..tiles import Cancelled

    try:
        return drawing_of(scene, camera, **options)
    except Cancelled:
        raise RenderError("the drawing was stopped before it was done: half of the surfaces would hide the wrong lines") from None
