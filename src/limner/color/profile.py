"""ICC profiles: how a file says which lamps its numbers are for.

A profile of this kind holds three lamps, under the white D50 that all profiles share, and a curve. Viewers and printers read it, and show
the picture as it was meant on whatever they have. A file without one is taken for sRGB.

**Source**: ICC.1:2022 (4.4), 7.2 (header), 9.2 (tags), 10.15 (mluc), 10.18 (para), 10.22 (sf32), 10.31 (XYZ); annex E (chad).
"""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from ..errors import UnsupportedError
from .adaptation import adaptation_matrix
from .spaces import Space, space

__all__ = ["icc_profile"]

_D50 = (0.9642, 1.0, 0.8249)
_MADE = (2024, 1, 1, 0, 0, 0)  # the same bytes for the same space, whenever they are written
_LICENCE = "CC0 1.0"


def icc_profile(name: str | Space) -> bytes:
    """The profile of a space.

    Parameters
    ----------
    name : str or Space
        Whose curve is a line and a power: not PQ, not HLG.

    Returns
    -------
    bytes
        Version 4.4, for displays, matrix and curve; a few hundred bytes. The same whenever it is made.

    >>> profile = icc_profile("display_p3")
    >>> len(profile), profile[36:40], profile[16:20]
    (500, b'acsp', b'RGB ')
    """
    of = space(name)
    if not of.encoding.curve:
        raise UnsupportedError(f"{of.title} has a curve that no ICC profile of this kind holds; its CICP code says it in a PNG")
    adapted = adaptation_matrix(_D50, of.white_xyz)
    lamps = adapted @ of.xyz_from_rgb
    curve = struct.pack(">4sIHH5i", b"para", 0, 3, 0, *(_fixed(part) for part in of.encoding.curve))
    tags = {
        b"desc": _text(of.title),
        b"cprt": _text(_LICENCE),
        b"wtpt": _xyz(_D50),
        b"chad": struct.pack(">4sI9i", b"sf32", 0, *(_fixed(part) for part in adapted.reshape(-1))),
        b"rXYZ": _xyz(lamps[:, 0]),
        b"gXYZ": _xyz(lamps[:, 1]),
        b"bXYZ": _xyz(lamps[:, 2]),
        b"rTRC": curve,
        b"gTRC": curve,
        b"bTRC": curve,
    }
    return _assembled(tags)


def _fixed(number: float) -> int:
    """As s15Fixed16."""
    return round(float(number) * 65536.0)


def _xyz(values: NDArray[np.float64] | tuple[float, float, float]) -> bytes:
    return struct.pack(">4sI3i", b"XYZ ", 0, *(_fixed(part) for part in values))


def _text(said: str) -> bytes:
    coded = said.encode("utf-16-be")
    return struct.pack(">4sIII2s2sII", b"mluc", 0, 1, 12, b"en", b"US", len(coded), 28) + coded


def _assembled(tags: dict[bytes, bytes]) -> bytes:
    """Header, table of tags, and their data, each once and on a multiple of four bytes."""
    start = 128 + 4 + 12 * len(tags)
    places: dict[bytes, int] = {}
    data = b""
    for body in tags.values():
        if body not in places:
            places[body] = start + len(data)
            data += body + bytes(-len(body) % 4)
    table = struct.pack(">I", len(tags)) + b"".join(struct.pack(">4sII", key, places[body], len(body)) for key, body in tags.items())
    header = struct.pack(">I4sI4s4s4s6H4s4sIIIQI3i4s", start + len(data), bytes(4), 0x04400000, b"mntr", b"RGB ", b"XYZ ", *_MADE, b"acsp",
                         bytes(4), 0, 0, 0, 0, 0, *(_fixed(part) for part in _D50), bytes(4))  # fmt: skip
    return header.ljust(128, b"\0") + table + data
