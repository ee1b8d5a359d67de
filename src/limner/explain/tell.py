"""From recorded calls to a story: every kernel that has a chapter becomes a step, all others are folded."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .._jit import Call
from .chapters import Chapter, chapter_of
from .contest import contest
from .parameters import parameters_of
from .sources import formula_of, source_of
from .story import Step
from .values import Names, plain, text_of
from .watch import Change, Record

__all__ = ["Teller", "arguments_of"]


def arguments_of(call: Call) -> dict[str, Any]:
    """A call's arguments by name."""
    return dict(zip(parameters_of(call.name), call.arguments, strict=False))


class Teller:
    """Tells of one record.

    Parameters
    ----------
    record : Record
    names : Names
        What rows of tables are called.
    """

    def __init__(self, record: Record, names: Names) -> None:
        self._record, self._names = record, names

    def steps(self, calls: Sequence[Call]) -> list[Step]:
        """The steps that some calls are."""
        return [step for call in calls for step in self._of_call(call)]

    def _of_call(self, call: Call) -> list[Step]:
        chapter = chapter_of(call.name)
        if chapter is not None and chapter.is_hidden:
            return []
        rays = _rays_begin(call)
        if rays:
            return [self._journey(call, chapter)]
        if chapter is None:
            return self.steps(call.calls)
        step = self._step(call, chapter)
        if not chapter.is_leaf:
            step.steps = contest(call, self._names, arguments_of) or self._interleaved(call)
        return [step]

    def _step(self, call: Call, chapter: Chapter | None) -> Step:
        arguments = arguments_of(call)
        shown = {name: self._value(name, arguments[name]) for name in (chapter.shows if chapter else ()) if name in arguments}
        terms = {name: value for name, value in shown.items() if value is not None}
        formula = formula_of(call.name)
        title = (chapter.title if chapter else "") or formula
        title = title.format_map(_Words({name: text_of(value) for name, value in terms.items()}))
        short = call.name.removeprefix("limner.")
        result = self._result(call)
        return Step(title, terms, result, formula if formula != title else "", short, source_of(call.name))

    def _value(self, name: str, value: Any) -> Any:
        if name in ("instance_id",) and isinstance(value, (int, np.integer)):
            return self._names.of_row("instance", int(value))
        return self._hit(value) if hasattr(value, "instance") and hasattr(value, "t") else plain(value, self._names)

    def _result(self, call: Call) -> Any:
        if call.name.endswith(".occluded"):
            blocker = next((deeper.result for deeper in call.walk() if getattr(deeper.result, "instance", -1) >= 0), None)
            return self._hit(blocker) if call.result and blocker is not None else plain(call.result)
        return self._value("", call.result)

    def _hit(self, hit: Any) -> Any:
        if hit.instance < 0:
            return "nothing"
        what = self._names.of_row("instance", int(hit.instance))
        return {"t": plain(hit.t), "of": f"triangle {int(hit.triangle)} of {what}" if hit.triangle >= 0 else what}

    def _interleaved(self, call: Call) -> list[Step]:
        """What a kernel calls, and how its sums change between."""
        return [step for _, steps in self._events(call) for step in steps]

    def _events(self, call: Call) -> list[tuple[Call | None, list[Step]]]:
        """Steps in order, each with the call that it tells of; None for changes of sums."""
        changes = list(self._record.changes.get(id(call), ()))
        events: list[tuple[Call | None, list[Step]]] = []
        before: dict[str, Any] = {}
        for k in range(len(call.calls) + 1):
            while changes and changes[0].place <= k:
                step = _changed(changes.pop(0), before, call)
                if step is not None:
                    events.append((None, [step]))
            if k < len(call.calls):
                events.append((call.calls[k], self._of_call(call.calls[k])))
        return events

    def _journey(self, call: Call, chapter: Chapter | None) -> Step:
        """A kernel that follows rays: a tree, in which each ray stands under the one that sent it."""
        journey = self._step(call, chapter)
        sent: list[tuple[Any, Any, Step]] = []
        last, here, number = journey, journey, 0
        for made, steps in self._events(call):
            if made is not None and _is_hit(made):
                number += 1
                last = here = self._ray(made, number, _sender(made, sent) or last)
                continue
            here.steps.extend(steps)
            sent.extend((*_way(push), here) for push in (made.walk() if made is not None else ()) if _is_push(push))
        return journey

    def _ray(self, call: Call, number: int, sender: Step) -> Step:
        arguments = arguments_of(call)
        met = self._hit(call.result) if hasattr(call.result, "instance") else plain(call.result)
        words = met if isinstance(met, str) else text_of(met.get("of", "")) if isinstance(met, dict) else "something"
        terms: dict[str, Any] = {name: plain(arguments[name]) for name in ("o", "d", "t_min", "t_max") if name in arguments}
        ray = Step(f"ray {number} meets {words}", terms, met, "p(t) = o + t d", "accel.walk.first_hit", source_of(call.name), "ray")
        sender.steps.append(ray)
        return ray


class _Words(dict[str, str]):
    """Words for a title; one that is not there is named by itself."""

    def __missing__(self, key: str) -> str:
        return f"the {key}"


def _changed(change: Change, before: dict[str, Any], call: Call) -> Step | None:
    """A sum's new value; None where it is the old one, or where the kernel was called with it."""
    value = plain(change.value)
    was, before[change.variable] = before.get(change.variable), value
    if not change.line or value is None or value == was or change.variable not in change.statement.partition("=")[0]:
        return None
    terms = {"was": was} if was is not None else {}
    module = call.name.removeprefix("limner.").rpartition(".")[0]
    return Step(change.variable, terms, value, change.statement, f"{module}:{change.line}", source_of(call.name), "change")


def _is_hit(call: Call) -> bool:
    return call.name.endswith(".first_hit")


def _rays_begin(call: Call) -> bool:
    return call.name.startswith("limner.raytrace.") and any(_is_hit(made) for made in call.calls)


def _is_push(call: Call) -> bool:
    return "push" in call.name and {"o", "d"} <= set(parameters_of(call.name))


def _way(call: Call) -> tuple[Any, Any]:
    arguments = arguments_of(call)
    return plain(arguments["o"]), plain(arguments["d"])


def _sender(call: Call, sent: list[tuple[Any, Any, Step]]) -> Step | None:
    """Who sent the ray of a call: the last that let a ray wait with its origin and direction."""
    way = _way(call) if {"o", "d"} <= set(parameters_of(call.name)) else None
    for k in range(len(sent) - 1, -1, -1):
        if way == sent[k][:2]:
            return sent.pop(k)[2]
    return None
