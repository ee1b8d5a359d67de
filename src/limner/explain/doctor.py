"""Why is my picture black, empty, faceted, inside out?

    print(limner.doctor("model.glb").text())

The description is looked at first, then a small picture; what is wrong is told with its place, why it matters, and what to do. A scene
with which nothing is wrong is left in peace.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerWarning, UnsupportedError
from ..render import RENDERERS
from ..scene.camera import Camera
from ..scene.scene import Scene
from .examine_meshes import examine_meshes, examine_overlaps
from .examine_picture import examine_picture
from .examine_scene import examine_environment, examine_lights, examine_materials, examine_places, examine_reading
from .findings import Diagnosis, Finding

__all__ = ["doctor"]

_CAUSES = {
    "too-dark": frozenset({"no-power", "dark-sky", "light-inside", "out-of-range", "spot-misses", "normals-flipped"}),
    "looks-past": frozenset({"alpha", "flattened", "degenerate", "units"}),
}
"""What is seen in a picture, and what explains it so that it need not be told, too."""


def doctor(
    scene: Any, *, renderer: str = "raster", camera: Camera | None = None, samples: int | None = None, picture: bool = True
) -> Diagnosis:
    """Tell what is wrong with a scene: why its picture is black, empty, dark, burnt out, noisy, faceted or inside out.

    Parameters
    ----------
    scene : Scene, path, or what else `render` takes
    renderer : "raster" | "ray" | "path"
        By which the picture is to be made.
    camera : Camera, optional
        In place of the scene's own.
    samples : int, optional
        Of the picture; with `path` the noise that they leave is measured.
    picture : bool
        Whether a small picture is drawn and looked at, too; without it only the description is.

    Returns
    -------
    Diagnosis
        Sound, if nothing was found.

    Examples
    --------
    >>> from limner.scene.node import Node
    >>> print(doctor(Scene(Node("world"))).findings[0].what)
    there is nothing to see: no shape is visible
    """
    if renderer not in RENDERERS:
        raise UnsupportedError(f"renderer must be one of {', '.join(RENDERERS)}, got {renderer!r}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimnerWarning)  # what a reader warns of stands in the scene's notes, which are looked at
        seen = _as_scene(scene)
        seen = seen if camera is None else seen.replace(camera=camera)
        found = list(_in_description(seen, renderer))
        if picture:
            causes = {finding.kind for finding in found}
            found += [told for told in examine_picture(seen, renderer, samples) if not causes & _CAUSES.get(told.kind, frozenset())]
    return Diagnosis(tuple(dict.fromkeys(found)))


def _in_description(scene: Scene, renderer: str) -> Iterator[Finding]:
    """What is wrong with the description."""
    yield from examine_reading(scene)
    yield from examine_places(scene)
    yield from examine_lights(scene, renderer)
    yield from examine_environment(scene, _sky_pixels)
    yield from examine_materials(scene)
    yield from examine_meshes(scene)
    yield from examine_overlaps(scene)


def _sky_pixels(environment: Any) -> NDArray[np.float32]:
    source = environment.source
    if isinstance(source, str):
        from ..files.radiance import read_radiance

        return read_radiance(source)
    return np.asarray(source, dtype=np.float32)


def _as_scene(thing: Any) -> Scene:
    if isinstance(thing, Scene):
        return thing
    from ..files.interop import as_scene

    return as_scene(thing)
