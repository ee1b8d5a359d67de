"""Recipe: a mapping like any other, whose dear values are worked out at most once and only if asked for."""

from __future__ import annotations

import pickle

import pytest

from limner.image.recipe import Recipe, recipe_from_text, recipe_text


def _lazy() -> tuple[Recipe, list[str]]:
    asked: list[str] = []

    def give() -> str:
        asked.append("scene")
        return "digest"

    return Recipe({"seed": 1}, {"scene": give}), asked


def test_nothing_is_worked_out_before_it_is_asked_for() -> None:
    """Not by holding, counting, copying or looking at something else; once by looking, and not again."""
    recipe, asked = _lazy()
    copy = recipe.with_values(model="teapot")
    assert (len(recipe), list(recipe), recipe["seed"], "model" in recipe, asked) == (2, ["seed", "scene"], 1, False, [])
    assert (recipe["scene"], recipe["scene"], asked) == ("digest", "digest", ["scene"])
    assert dict(copy) == {"seed": 1, "model": "teapot", "scene": "digest"}


def test_it_equals_a_dict_and_travels_complete() -> None:
    """Equality, JSON and pickles know no difference."""
    recipe, _ = _lazy()
    assert recipe == {"seed": 1, "scene": "digest"}
    assert recipe_from_text(recipe_text(_lazy()[0])) == dict(recipe)
    assert pickle.loads(pickle.dumps(_lazy()[0])) == recipe


@pytest.mark.parametrize("text", ["", "A photograph", "[1, 2]", "{", '"x"', "[" * 100_000, b"\xff\xfe"])
def test_what_is_no_recipe_is_none(text: str | bytes) -> None:
    """Comments of cameras, other programs' words, nonsense."""
    assert recipe_from_text(text) == {}
