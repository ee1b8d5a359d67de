"""How much a file may ask for before it is refused.

A file is written by somebody else. What it declares is compared with these numbers before anything is allocated, so that a
file of a few bytes cannot fill the memory or keep the machine busy for hours.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

from ..errors import SceneError

__all__ = ["DEFAULT", "Limits"]


@dataclass(frozen=True)
class Limits:
    """The most that one model may hold; what is beyond is refused with a line that names the field.

    Parameters
    ----------
    max_file_bytes : int
        The file and everything it refers to, together.
    max_json_bytes : int
        The JSON of a glTF file, which costs some thirty times its size while it is read.
    max_vertices, max_triangles : int
        Of all meshes together, each counted once however often it is shown.
    max_nodes : int
        Of the scene graph as it is walked: a node with two parents counts twice.
    max_texture_pixels : int
        Of one picture.
    max_total_texture_pixels : int
        Of all pictures together.
    """

    max_file_bytes: int = 2 << 30
    max_json_bytes: int = 128 << 20
    max_vertices: int = 50_000_000
    max_triangles: int = 50_000_000
    max_nodes: int = 1_000_000
    max_texture_pixels: int = 1 << 26
    max_total_texture_pixels: int = 1 << 28

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, bool) or not isinstance(value, int) or value < 0:
                raise SceneError(f"limits.{field.name} must be an integer >= 0, got {value!r}")


DEFAULT = Limits()
