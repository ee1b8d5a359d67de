"""The process in which a pixel is computed once more as Python, with everything that happens written down.

A process that draws has compiled kernels, in which nothing can be looked at. This one is started with ``LIMNER_MODE=traced``, takes a
request on standard input (what the compiled kernel was called with, for one pixel), makes the same call, and answers with the story and
with what the film then holds. Run by `limner.explain.explain`, not by people.
"""

from __future__ import annotations

import importlib
import json
import pickle
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .lobes import lobes
from .request import Request
from .tell import Teller
from .values import Names, shortest
from .watch import WATCHED, watch

__all__ = ["answer", "main"]

_FOLLOWED = ("limner.raytrace", "limner.raster.fragment", "limner.raster.shadow", "limner.visibility.shadow")
"""Where kernels add light up."""


def answer(request: Request) -> list[dict[str, Any]]:
    """Make the calls; of each plain values: ``steps``; ``film``, the four sums of the pixel; ``lobes`` (`limner.explain.lobes`)."""
    kernel = getattr(importlib.import_module(request.module), request.function)
    arguments = list(request.arguments)
    film: NDArray[np.float32] = np.zeros(arguments[request.film], dtype=np.float32)
    arguments[request.film] = film
    names = Names({kind: (arguments[place], told) for kind, (place, told) in request.names.items()})
    sums, followed, answers = film.reshape(-1, 4)[request.pixel], _followed(), []
    for change in request.changes:
        sums[:] = 0.0
        record = watch(kernel, [change.get(place, value) for place, value in enumerate(arguments)], followed)
        steps = Teller(record, names).steps([made for call in record.calls for made in call.calls])
        film_sums = [shortest(value) for value in sums]
        answers.append({"steps": [step.as_dict() for step in steps], "film": film_sums, "lobes": lobes(record.calls)})
    return answers


def _followed() -> list[Callable[..., Any]]:
    """The kernels that are loaded and add light up."""
    found = []
    for name, module in list(sys.modules.items()):
        if name.startswith(_FOLLOWED):
            for function in vars(module).values():
                inner = getattr(function, "__wrapped__", None)
                if inner is not None and inner.__module__ == name and set(WATCHED) & set(inner.__code__.co_varnames):
                    found.append(function)
    return found


def main() -> None:
    """Answer one request, as JSON."""
    request = pickle.load(sys.stdin.buffer)
    told = json.dumps(answer(request))
    sys.stdout.write(told)


if __name__ == "__main__":
    main()
