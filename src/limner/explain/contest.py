"""Who covers the samples of a pixel, and who lost the depth test to whom: what the fill stage's calls tell.

The depth buffer holds near/depth, so the greater is the nearer. The stage draws triangle after triangle; of each, the kernel that compares
depths is asked with the samples that lie inside and the depths there, and answers which of them become its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .._jit import Call
from .sources import source_of
from .story import Step
from .values import Names, is_lanes, shortest

__all__ = ["contest"]


_UNDRAWN = "not drawn: behind the far plane, cut away, or the texture's alpha is below the cutoff"


def contest(call: Call, names: Names, arguments_of: Callable[[Call], dict[str, Any]]) -> list[Step]:
    """A step for each triangle that covers a sample of the pixel; none where `call` does not fill."""
    fills = [made for made in call.walk() if made.name.endswith(".fill._fill")]
    if not fills or not call.name.endswith((".fill_opaque", ".fill_transparent")):
        return []
    owner: dict[int, str] = {}
    depths: dict[int, np.float32] = {}
    steps = []
    for fill in fills:
        asked = arguments_of(fill)
        record = asked.get("t")
        if not isinstance(record, np.void):
            return []
        what = f"triangle {int(record['triangle'])} of {names.of_row('instance', int(record['instance']))}"
        for test in (made for made in fill.calls if made.name.endswith("._nearer")):
            step = _tested(test, fill, what, arguments_of(test), owner, depths)
            if step is not None:
                steps.append(step)
    if owner:
        winners = list(dict.fromkeys(owner[s] for s in sorted(owner)))
        steps.append(Step("seen in the end", {}, {what: [s for s in sorted(owner) if owner[s] == what] for what in winners}, kind="note"))
    return steps


def _tested(
    test: Call, fill: Call, what: str, asked: dict[str, Any], owner: dict[int, str], depths: dict[int, np.float32]
) -> Step | None:
    inside, z = asked.get("inside"), asked.get("z")
    if inside is None or z is None or not (is_lanes(inside) and is_lanes(z) and is_lanes(test.result)):
        return None
    wins = test.result.values.copy()
    for later in fill.calls:  # what the cuts and the alpha test take away again
        if later.name.endswith("._covers") and is_lanes(later.result):
            wins &= later.result.values
    covered = np.flatnonzero(inside.values)
    if not len(covered):
        return None
    told: dict[str, list[tuple[int, np.float32]]] = {}
    for s in covered.tolist():
        depth = z.values[s]
        if wins[s]:
            outcome = f"nearer than {owner[s]}" if s in owner else "the first there"
            owner[s], depths[s] = what, depth
        else:
            outcome = f"lost to {owner[s]}, which is nearer" if s in owner else _UNDRAWN
        told.setdefault(outcome, []).append((s, depth))
    steps = [
        Step(outcome, {"samples": [s for s, _ in held], "depths": [shortest(depth) for _, depth in held]}, kind="note")
        for outcome, held in told.items()
    ]
    samples = covered.tolist()
    won = int(wins[covered].sum())
    title = f"{what} covers {len(samples)} samples and gets {won}"
    formula = "inside where the three edge functions are not negative; the greater near/depth is the nearer"
    return Step(title, {"samples": samples}, None, formula, fill.name.removeprefix("limner."), source_of(test.name), "triangle", steps)
