"""What can go wrong, said for people.

    LimnerError
    ├── SceneError         a description that makes no picture: which node, which field, what was expected
    ├── FileFormatError    a file that is not what it claims: which file, where in it
    ├── UnsupportedError   a sound request that limner cannot fulfil: what, and what can
    └── RenderError        a picture that could not be finished

Every message is one line: what was wrong, what was found, where, and what to do where that is not obvious.
"""

from __future__ import annotations

import os

__all__ = ["FileFormatError", "LimnerError", "LimnerWarning", "RenderError", "SceneError", "UnsupportedError"]


class LimnerError(Exception):
    """The base of all errors that limner raises on purpose."""


class SceneError(LimnerError):
    """A scene, or a call, that makes no picture.

    Parameters
    ----------
    message : str
        What was expected and what was found: "sphere.radius must be positive, got -1.0".
    where : str
        Path of the node it stands in, "world/ball"; empty where there is none.
    """

    def __init__(self, message: str, where: str = "") -> None:
        self.where = where
        super().__init__(f"{message} ({where})" if where else message)


class FileFormatError(LimnerError):
    """A file that could not be read as what it claims to be.

    Parameters
    ----------
    message : str
        What was expected and what was found.
    path : str or path-like
        The file.
    position : str
        Where in the file: a line ("line 12"), a JSON pointer ("/meshes/0/primitives/1"), a byte offset.
    """

    def __init__(self, message: str, path: str | os.PathLike[str] = "", position: str = "") -> None:
        self.path = os.fspath(path)
        self.position = position
        place = ", ".join(part for part in (self.path, position) if part)
        super().__init__(f"{place}: {message}" if place else message)


class UnsupportedError(LimnerError):
    """A sound request that limner cannot fulfil; the message says what can."""


class RenderError(LimnerError):
    """A picture that could not be finished."""


class LimnerWarning(UserWarning):
    """A likely slip: no light, a missing texture, degenerate faces, non-finite pixels."""
