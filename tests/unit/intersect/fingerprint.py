"""Print a digest of what each exact shape and a solid answer to one fixed set of rays, as JSON; run by `test_shapes.py` in each mode."""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from shapes import along, bounds, csg_hits, hits, points, quadric_numbers, row, spans, stack

from limner.intersect.layouts import BOX, CONE, CYLINDER, DIFFERENCE, DISK, PATCH, PLANE, QUADRIC, SPHERE, TORUS, UNION

_NUMBERS = np.concatenate(
    [quadric_numbers((1, -0.5, 1, 0.2, 0, 0.1, 0, -0.3, 0, -0.4), (-1, -1, -1), (1, 1, 1)), [0, 0, 0, 1, 0, 0, 1, 1, 1, 0, 1, 0]]
)
_SHAPES = {
    "ball": row(SPHERE, (0.9,)),
    "plane": row(PLANE),
    "box": row(BOX, (0.5, 0.8, 1.1)),
    "disk": row(DISK, (1.2,)),
    "cylinder": row(CYLINDER, (0.7, 1.6)),
    "tube": row(CYLINDER, (0.7, 1.6), capped=False),
    "cone": row(CONE, (0.9, 0.2, 1.5)),
    "torus": row(TORUS, (0.8, 0.3)),
    "quadric": row(QUADRIC, place=0),
    "patch": row(PATCH, place=16),
}


def _digest(*arrays: np.ndarray) -> str:
    # What a NaN looks like inside is no promise
    return hashlib.blake2b(b"".join(np.where(a != a, 7.0, a).tobytes() for a in arrays), digest_size=8).hexdigest()


def _answers() -> dict[str, str]:
    random = np.random.default_rng(1)
    d = random.normal(size=(120, 3)) * 10.0 ** random.uniform(-3, 3, size=(120, 1))
    d[::5, 0], d[::7, 1], d[::9, 2], d[11] = 0.0, -0.0, 1e-20, np.nan
    rays = along(random.normal(size=(120, 3)), d)
    digests = {}
    for name, shape in _SHAPES.items():
        found, part = hits(shape, rays, _NUMBERS)
        met = np.isfinite(found[:, 0])
        seen = points(shape, rays[met], np.ascontiguousarray(found[met]), part[met], _NUMBERS)
        digests[name] = _digest(*spans(shape, rays, _NUMBERS), found, part, bounds(shape, _NUMBERS), *seen.values())
    solid = stack(*(_SHAPES[name] for name in ("box", "ball", "torus"))), np.array([0, 1, 2, UNION, DIFFERENCE], np.int32)
    digests["solid"] = _digest(*csg_hits(solid, rays, _NUMBERS))
    return digests


if __name__ == "__main__":
    print(json.dumps(_answers()))  # noqa: T201
