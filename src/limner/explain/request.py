"""What the process that traces a pixel is asked for (`limner.explain.child`)."""

from __future__ import annotations

from typing import Any, NamedTuple

__all__ = ["Request"]


class Request(NamedTuple):
    """Calls to make, which differ in few numbers.

    Attributes
    ----------
    module, function : str
        The kernel.
    arguments : tuple
        As the compiled one was called; in the place of the film, its shape.
    changes : tuple of dict
        For each call, which arguments are others, by their places.
    film : int
        Which of them is the film.
    pixel : int
        Row of the film, if it is taken as (n, 4).
    names : dict of str to (int, tuple of str)
        What rows of tables are called, by what they are, with which argument is the table.
    """

    module: str
    function: str
    arguments: tuple[Any, ...]
    changes: tuple[dict[int, Any], ...]
    film: int
    pixel: int
    names: dict[str, tuple[int, tuple[str, ...]]]
