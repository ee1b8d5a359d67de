"""Shaded pictures that explain: cool to warm, in bands, or seen through, with the lines of a drawing over them (FoCG 10.3).

    limner.stylized("part.glb", style="gooch", lines=True).save("part.png")
    limner.stylized("part.glb", style="toon", renderer="ray", samples=16)
    limner.stylized("part.glb", style="xray")

gooch   every surface is of `CoolToWarm`: its form is told by colour, and no part is lost in the dark
toon    light falls in a few bands of equal lightness, each flat, as in a drawn film
xray    every surface is a veil: the more of them lie behind each other, the denser

**Source**: Gooch, Gooch, Shirley and Cohen, *A non-photorealistic lighting model for automatic technical illustration*, 1998; Decaudin,
*Cartoon-looking rendering of 3D scenes*, 1996 (bands).
"""

from __future__ import annotations

import dataclasses
import threading
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..artistic.plate import Placing, layers_of
from ..artistic.style import LineStyle, line_style
from ..draw.canvas import Canvas
from ..draw.page import paint_layers
from ..errors import SceneError, UnsupportedError
from ..image.image import Image
from ..progress import OnProgress
from ..scene.camera import Camera
from ..scene.framing import with_defaults
from ..scene.material import CoolToWarm, Material, MetallicRoughness
from ..scene.node import Node
from ..scene.scene import Scene
from ..scene.shape import Plane
from .drawing import lines_of

__all__ = ["PICTURE_STYLES", "banded", "stylized", "with_style"]

PICTURE_STYLES = ("gooch", "toon", "xray")

_VEIL = (0.35, 0.62, 1.0)
_VEIL_ALPHA = 0.22
_SOFT = 0.03  # of a band: over how much its edge is smoothed
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)  # Rec. 709


def stylized(
    scene: Any,
    *,
    style: str | None = "gooch",
    lines: bool = False,
    line_look: LineStyle | str = "plain",
    bands: int = 3,
    width: int = 800,
    height: int = 600,
    camera: Camera | None = None,
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
    **options: Any,
) -> Image:
    """Make a picture in a style.

    Parameters
    ----------
    scene : Scene, path, (vertices, triangles), or a trimesh mesh or scene
        As for `limner.render`.
    style : "gooch" | "toon" | "xray", optional
        None: as it is.
    lines : bool
        Whether outlines and creases lie over it.
    line_look : LineStyle or str
        How they look, as for `limner.drawing`.
    bands : int >= 2
        Of light, in "toon".
    width, height, camera, on_progress, cancel, **options
        As for `limner.render`: renderer, samples, ….

    Returns
    -------
    Image
        Beside it lie the channels that were asked for with `aovs`.
    """
    from ..files.interop import as_scene
    from ..render import render

    if bands < 2:
        raise SceneError(f"bands must be at least 2, got {bands}")
    chosen, scene = line_style(line_look), scene if isinstance(scene, Scene) else as_scene(scene)
    wanted = tuple(options.pop("aovs", ()))
    if "time" in options and (options["time"] is not None or options.get("animation") is not None):
        from ..scene.pose import at

        scene = at(scene, options["time"] or 0.0, options.get("animation"))
        options = {**options, "time": None, "animation": None}
    shown = with_style(scene, style)
    aovs = dict.fromkeys((*wanted, *(("albedo",) if style == "toon" else ())))
    image = render(
        shown, width=width, height=height, camera=camera, aovs=tuple(aovs), on_progress=on_progress, cancel=cancel, **options
    )
    if style == "toon":
        image = dataclasses.replace(image, pixels=banded(image.pixels, image.aov["albedo"], bands), recipe={})
        image = dataclasses.replace(image, aov={name: image.aov[name] for name in image.aov if name in wanted})
    elif style is not None:
        image = dataclasses.replace(image, recipe={})  # it names no material of the scene's own
    if not lines or not image.finished:
        return image
    seen = camera if camera is not None else with_defaults(shown, width / height)[0].camera
    drawn = lines_of(scene, seen, width=width, height=height, hidden=chosen.shows_hidden, cancel=cancel)
    return paint_layers(Canvas.on(image), layers_of([(drawn, Placing())], chosen)).image()


def with_style(scene: Scene, style: str | None) -> Scene:
    """The scene with its materials replaced by those of a style; "toon" keeps them, since it bands their light.

    >>> list(with_style(Scene(), "gooch").shapes())
    []
    """
    if style is not None and style not in PICTURE_STYLES:
        raise UnsupportedError(f"style must be one of {', '.join(PICTURE_STYLES)}, got {style!r}")
    if style in (None, "toon"):
        return scene
    return scene.replace(root=_dressed(scene.root, str(style)))


def _dressed(node: Node, style: str) -> Node:
    children = []
    for child in node.children:  # a comprehension's own frame would halve the depth of the graphs that fit on the stack
        children.append(_dressed(child, style))
    # A floor without end, seen through, would be a veil over all.
    kept = [shape for shape in node.shapes if style != "xray" or not isinstance(shape.geometry, Plane)]
    shapes = tuple(dataclasses.replace(shape, materials=tuple(_material(one, style) for one in shape.materials)) for shape in kept)
    return dataclasses.replace(node, shapes=shapes, children=tuple(children))


def _material(material: Material, style: str) -> Material:
    if style == "gooch":
        return CoolToWarm(double_sided=getattr(material, "double_sided", True), name=material.name)
    return MetallicRoughness(
        base_color=_VEIL, unlit=True, alpha=_VEIL_ALPHA, alpha_mode="blend", double_sided=True, name=material.name
    )


def banded(pixels: NDArray[np.float32], albedo: NDArray[np.float32], bands: int = 3) -> NDArray[np.float32]:
    """Let the light on surfaces fall in bands.

    Parameters
    ----------
    pixels : (height, width, 4) float32
        Linear light, straight alpha.
    albedo : (height, width, 3) float32
        Of the surface in the middle of each pixel; 0 where there is none, which stays as it is.
    bands : int >= 2

    Returns
    -------
    (height, width, 4) float32
        Each colour is multiplied so that light over albedo has the value in the middle of its band; the square root counts, so that
        bands look alike. Edges of bands are smoothed over a few hundredths of them.
    """
    own = albedo[..., :3] @ _LUMINANCE
    with np.errstate(divide="ignore", invalid="ignore"):
        light = np.where(own > 1e-4, (pixels[..., :3] @ _LUMINANCE) / own, 0.0)
    level = np.clip(np.sqrt(np.maximum(light, 0.0)), 0.0, 1.0) * bands
    step = np.minimum(np.floor(level), bands - 1)
    edge = np.clip((level - step) / _SOFT, 0.0, 1.0)
    smooth = np.where(step > 0, step - 0.5 + edge * edge * (3.0 - 2.0 * edge), 0.5)
    flat = (smooth / bands) ** 2
    made = pixels.copy()
    factor = np.where((own > 1e-4) & (light > 1e-6), flat / np.maximum(light, 1e-6), 1.0)
    made[..., :3] *= factor[..., None].astype(np.float32)
    return made
