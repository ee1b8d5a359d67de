"""The lines of a scene as a picture: what `limner.render(scene, renderer="lines")` makes (FoCG 10.3.1)."""

from __future__ import annotations

import threading

import numpy as np

from ..draw.page import page_image
from ..image.image import Image
from ..progress import OnProgress
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..tiles import Cancelled
from .lines import drawing_of
from .plate import page_of
from .style import LineStyle, line_style

__all__ = ["line_picture"]


def line_picture(
    scene: Scene,
    camera: Camera | None = None,
    *,
    width: int,
    height: int,
    style: LineStyle | str = "plain",
    on_progress: OnProgress | None = None,
    cancel: threading.Event | None = None,
) -> Image:
    """Draw what is seen of a scene's lines on paper of its background's colour, or white where it has none.

    Parameters
    ----------
    scene : Scene
    camera : Camera, optional
        In place of the scene's own.
    width, height : int
        Pixels.
    style : LineStyle or str
        As of `limner.artistic.style`.
    on_progress, cancel
        As for `limner.render`.
    """
    chosen = line_style(style)
    try:
        drawing = drawing_of(
            scene, camera, width=width, height=height, hidden=chosen.shows_hidden, on_progress=on_progress, cancel=cancel
        )
    except Cancelled:  # half of the surfaces would hide the wrong lines: the picture so far is empty paper
        return Image(np.ones((height, width, 4), dtype=np.float32), finished=False)
    paper = scene.background if isinstance(scene.background, tuple) else "white"
    return page_image(page_of(drawing, chosen, background=paper))
