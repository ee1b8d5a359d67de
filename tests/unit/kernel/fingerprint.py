"""Print a digest of what each kernel of the room answers to one fixed set of questions, as JSON.

A program, run by `test_bits.py` in each mode and for several CPUs: equal digests mean equal bits. What a NaN looks like inside
is no promise, so that all of them count as one.
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from compiled import door_of, over

from limner._door import Array
from limner.kernel import elementary, frame, rng, sampler, vec, warp
from limner.kernel.elementary import floor, sqrt
from limner.kernel.lanes import highest, lane, load8, lowest, max, min, splat8, store8, to_float, to_int, where

_N = 400
_EDGES = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    np.inf,
    -np.inf,
    np.nan,
    1e-45,
    1e-38,
    3e38,
    -3e38,
    126.0,
    -126.0,
    127.9,
    1e5,
    -1e10,
    1.0000001,
]


def _questions() -> dict[str, np.ndarray]:
    random = np.random.default_rng(2024)
    edges = np.array(np.meshgrid(_EDGES, _EDGES), np.float32).reshape(2, -1)
    wide = (random.normal(size=(2, _N)) * np.exp2(random.uniform(-40, 40, (2, _N)))).astype(np.float32)
    moderate = random.uniform(-100, 100, (2, _N)).astype(np.float32)
    unit = random.random((2, _N), dtype=np.float32)
    directions = random.normal(size=(2, _N, 3))
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    return {
        "x": np.concatenate([edges[0], wide[0], moderate[0], unit[0]]),
        "y": np.concatenate([edges[1], wide[1], moderate[1], unit[1]]),
        "u": unit[0],
        "v": unit[1],
        "d": directions[0].astype(np.float32),
        "e": directions[1].astype(np.float32),
        "long": (directions[0] * 1e4).astype(np.float32),
        "word": random.integers(0, 2**32, _N),
        "index": np.arange(_N),
    }


def _lanes(x, y, out):
    n = x.shape[0] // 8 * 8
    for k in range(0, n, 8):
        a, b = load8(x, k), load8(y, k)
        chosen = where((a < b) ^ (b <= np.float32(1.0)), a * b + a, sqrt(a) / b)
        folded = max(min(a, b), floor(chosen)) - to_float(to_int(b))
        store8(out, k, folded + splat8(lowest(a) + highest(b) + lane(chosen, 3)))
        store8(out, n + k, chosen)


def _answers(q: dict[str, np.ndarray]) -> dict[str, Any]:
    x, y, u, v, d, e = (q[name] for name in ("x", "y", "u", "v", "d", "e"))
    found: dict[str, Any] = {}

    def ask(kernel: Any, *columns: Any) -> None:
        found[getattr(kernel, "__name__", str(kernel))] = over(kernel, *columns)

    for kernel in (elementary.exp2, elementary.log2, elementary.sin, elementary.cos, elementary.acos, elementary.safe_sqrt):
        ask(kernel, x)
    for kernel in (elementary.power, elementary.atan2):
        ask(kernel, x, y)
    for kernel in (vec.dot, vec.cross, vec.reflect):
        ask(kernel, q["long"], e)
    for kernel in (vec.normalize, vec.length, vec.luminance, vec.max_component):
        ask(kernel, q["long"])
    ask(vec.lerp, x, y, 0.3)
    ask(frame.frame_from_normal, d)
    ask(rng.random_float, q["word"], q["index"], 7, 1, 2)
    for kind in (sampler.RANDOM, sampler.SOBOL):
        found[f"sample_1d {kind}"] = over(sampler.sample_1d, kind, 5, q["word"], 3, q["index"], 1)
        found[f"sample_2d {kind}"] = over(sampler.sample_2d, kind, 5, q["word"], 3, q["index"], 1)
    for kernel in (
        warp.warp_disk,
        warp.inverse_disk,
        warp.warp_hemisphere_cosine,
        warp.warp_sphere,
        warp.warp_triangle,
        warp.inverse_triangle,
    ):
        ask(kernel, u, v)
    ask(warp.warp_cone, u, v, 0.1)
    ask(warp.inverse_sphere, d)
    ask(warp.inverse_cone, d, 2.0)
    lanes = np.zeros(len(x) // 8 * 16, np.float32)
    door_of(_lanes, *[Array(np.float32, 1)] * 3)(x, y, lanes)
    found["lanes"] = lanes
    return found


def _digest(answer: Any) -> str:
    digest = hashlib.blake2b(digest_size=12)
    for column in answer if isinstance(answer, tuple) else (answer,):
        one_nan = np.where(np.isnan(column), np.array(np.nan, column.dtype), column)
        digest.update(one_nan.tobytes())
    return digest.hexdigest()


if __name__ == "__main__":
    json.dump({name: _digest(answer) for name, answer in _answers(_questions()).items()}, sys.stdout)
