"""MODEL, as a command line names it: a built-in scene or a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import SceneError

if TYPE_CHECKING:
    from ..scene.scene import Scene

__all__ = ["open_model"]


def open_model(name: str) -> Scene:
    """Return the built-in scene of that name, or read the file; ``./teapot`` is a file."""
    from ..scene.library import BUILTINS, builtin

    if name in BUILTINS:
        return builtin(name)
    if not Path(name).exists():
        raise SceneError(f"there is no file {name!r}, and no built-in scene of that name ({', '.join(sorted(BUILTINS))})")
    from ..files.load import load

    return load(name)
