"""How to make a picture again: plain values that travel in its file, some of them worked out only when someone asks.

A digest of the whole scene takes longer than everything else that is kept with a picture; a picture that is shown and thrown away
should not wait for it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any

__all__ = ["KEYWORD", "Recipe", "recipe_from_text", "recipe_text"]

KEYWORD = "limner"
"""The name under which every format that can carry text carries the recipe."""


class Recipe(Mapping[str, Any]):
    """A mapping of which some values are computed on the first look.

    Parameters
    ----------
    values : mapping of str to plain values
    later : mapping of str to callables, optional
        What gives the values of further keys; each is called at most once.

    >>> recipe = Recipe({"seed": 1}, {"scene": lambda: "0af1"})
    >>> dict(recipe.with_values(model="teapot"))
    {'seed': 1, 'model': 'teapot', 'scene': '0af1'}
    """

    def __init__(self, values: Mapping[str, Any], later: Mapping[str, Callable[[], Any]] | None = None) -> None:
        self._values = dict(values)
        self._later = {key: give for key, give in (later or {}).items() if key not in self._values}

    def __getitem__(self, key: str) -> Any:
        give = self._later.get(key)
        if give is not None:
            self._values[key] = give()
            self._later.pop(key, None)
        return self._values[key]

    def __iter__(self) -> Iterator[str]:
        return iter(list(dict.fromkeys([*self._values, *self._later])))

    def __len__(self) -> int:
        return len({*self._values, *self._later})

    def __repr__(self) -> str:
        return f"Recipe({', '.join(self)})"

    def __reduce__(self) -> tuple[type[Recipe], tuple[dict[str, Any]]]:
        """What is sent to another process is complete: the scene stays here."""
        return Recipe, (dict(self),)

    def with_values(self, **values: Any) -> Recipe:
        """Return a copy that holds these, too; nothing is worked out for it."""
        return Recipe({**self._values, **values}, self._later)


def recipe_text(recipe: Mapping[str, Any]) -> str:
    """The recipe as JSON in ASCII, which every format's text fields can hold."""
    return json.dumps(dict(recipe), sort_keys=True)


def recipe_from_text(text: str | bytes) -> dict[str, Any]:
    """The recipe that `recipe_text` wrote; empty where this is none."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}
