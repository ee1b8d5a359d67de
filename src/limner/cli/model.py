"""MODEL, as a command line names it: a built-in scene or a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import SceneError

if TYPE_CHECKING:
    from ..files.report import LoadReport
    from ..scene.scene import Scene

__all__ = ["open_model", "report_of_model"]


def open_model(name: str, up: str = "y") -> Scene:
    """Return the built-in scene of that name, or read the file, whose `up` points up; ``./teapot`` is a file."""
    scene = _built_in(name)
    if scene is not None:
        return scene
    from ..files.load import load

    return load(name, up=up)


def report_of_model(name: str, up: str = "y") -> LoadReport:
    """Open a model as `open_model` does, and tell what became of it; a built-in scene is there as it is."""
    from ..files.report import load_report, report_of

    scene = _built_in(name)
    if scene is None:
        return load_report(name, up=up)
    from ..files.notes import Notes

    return report_of(scene, Notes(), name, "built-in")


def _built_in(name: str) -> Scene | None:
    """The built-in scene of that name; None: it must be a file, and there is one."""
    from ..scene.library import BUILTINS, builtin

    if name in BUILTINS:
        return builtin(name)
    if not Path(name).exists():
        raise SceneError(f"there is no file {name!r}, and no built-in scene of that name ({', '.join(sorted(BUILTINS))})")
    return None
