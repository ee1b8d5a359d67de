"""OpenUSD stages written as text, for the tests that read them."""

from __future__ import annotations

from pathlib import Path

from limner.files.load import load
from limner.mesh.mesh import Mesh
from limner.scene.scene import Scene

HEADER = '#usda 1.0\n(\n    upAxis = "{up}"\n    metersPerUnit = {unit}\n    timeCodesPerSecond = 24\n    {more}\n)\n'


def written(text: str, up: str = "Y", unit: float = 1.0, more: str = "") -> str:
    """A stage as text; its grammar wants braces to stand on lines of their own."""
    return HEADER.format(up=up, unit=unit, more=more) + text.replace("}", "\n}\n")


def stage(folder: Path, text: str, up: str = "Y", unit: float = 1.0, more: str = "", name: str = "a.usda") -> Scene:
    """Read a stage of this text."""
    (folder / name).write_text(written(text, up, unit, more))
    return load(folder / name)


def the_mesh(scene: Scene) -> Mesh:
    """The only geometry of a scene."""
    ((_, shape),) = scene.shapes()
    assert isinstance(shape.geometry, Mesh)
    return shape.geometry
