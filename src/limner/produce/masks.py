"""Which pixels belong to what: the ids beside a picture, taken apart.

    image = limner.render(scene, aovs=("instance_id",))
    for name, mask in limner.dataset.masks(image).items():
        ...                                                    # mask: (height, width) bool

Training sets write a mask as the lengths of its runs, counted down the columns:

    . # #
    . # .     column by column: . .  # #  # .     counts 2, 3, 1
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from ..image.image import Image

__all__ = ["KINDS", "Region", "channel", "mask_from_counts", "masks", "regions"]

KINDS = ("instance", "material")


class Region(NamedTuple):
    """The pixels of one id.

    Attributes
    ----------
    id : int
    area : int
        Pixels.
    bbox : (int, int, int, int)
        Left, top, width, height in pixels: those of column x cover [x, x + 1), as in COCO.
    counts : tuple of int
        Lengths of the runs down the columns, first of pixels outside, then inside, and so on.
    """

    id: int
    area: int
    bbox: tuple[int, int, int, int]
    counts: tuple[int, ...]


def channel(by: str) -> str:
    """The name of the AOV that tells instances or materials apart."""
    if by not in KINDS:
        raise UnsupportedError(f"by must be one of {', '.join(KINDS)}, got {by!r}")
    return f"{by}_id"


def masks(image: Image, by: str = "instance") -> dict[str, NDArray[np.bool_]]:
    """Take a picture apart by what is seen in the centre of each pixel.

    Parameters
    ----------
    image : Image
        Rendered with ``aovs=("instance_id",)`` or ``("material_id",)``.
    by : "instance" | "material"

    Returns
    -------
    dict of str to (height, width) bool
        For each name that is seen, in the order of the ids; those of one name lie in one mask. They do not overlap.

    Raises
    ------
    SceneError
        The image has no such channel, or no names for it.
    """
    name = channel(by)
    if name not in image.aov or name not in image.id_names:
        raise SceneError(f'masks by {by} need the channel "{name}": render with aovs=("{name}",)')
    ids, names = image.aov[name], image.id_names[name]
    made: dict[str, NDArray[np.bool_]] = {}
    for index in np.unique(ids):
        if index >= 0:
            mask = ids == index
            made[names[index]] = made[names[index]] | mask if names[index] in made else mask
    return made


def regions(ids: NDArray[np.integer]) -> Iterator[Region]:
    """Describe the pixels of every id that is not negative, in ascending order; in one sort, however many there are.

    Parameters
    ----------
    ids : (height, width) int

    **Source**: the run lengths are those of COCO's uncompressed masks (Lin et al., *Microsoft COCO: Common Objects in Context*,
    2014; data format, "segmentation": {"size", "counts"}).
    """
    height = ids.shape[0]
    down_columns = ids.ravel(order="F")
    order = np.argsort(down_columns, kind="stable")
    values, starts = np.unique(down_columns[order], return_index=True)
    for value, places in zip(values.tolist(), np.split(order, starts[1:]), strict=True):
        if value < 0:
            continue
        rows, columns = places % height, places // height
        left, top = int(columns[0]), int(rows.min())
        bbox = left, top, int(columns[-1]) - left + 1, int(rows.max()) - top + 1
        yield Region(value, len(places), bbox, _run_lengths(places, down_columns.size))


def _run_lengths(places: NDArray[np.intp], size: int) -> tuple[int, ...]:
    """Lengths of the runs outside and inside of ascending places among `size`."""
    breaks = np.flatnonzero(np.diff(places) != 1)
    first = places[np.concatenate([[0], breaks + 1])]
    behind = places[np.concatenate([breaks, [-1]])] + 1
    bounds = np.stack([first, behind], axis=1).ravel()
    counts = np.diff(bounds, prepend=0).tolist()
    return (*counts, size - int(bounds[-1])) if bounds[-1] < size else tuple(counts)


def mask_from_counts(counts: Sequence[int] | ArrayLike, height: int, width: int) -> NDArray[np.bool_]:
    """Turn run lengths back into a mask.

    Parameters
    ----------
    counts : (n,) int >= 0
        As in `Region`; they add up to height * width.
    height, width : int

    Returns
    -------
    (height, width) bool

    Examples
    --------
    >>> mask_from_counts([2, 3, 1], 2, 3).astype(int).tolist()
    [[0, 1, 1], [0, 1, 0]]
    """
    lengths = np.asarray(counts)
    if lengths.ndim != 1 or lengths.dtype.kind not in "iu" or (lengths < 0).any() or lengths.sum() != height * width:
        raise SceneError(f"run lengths must be integers that add up to {height} x {width}, got {counts!r}")
    inside = np.arange(len(lengths)) % 2 == 1
    return np.repeat(inside, lengths).reshape((height, width), order="F")
