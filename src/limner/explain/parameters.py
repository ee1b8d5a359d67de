"""The names of a kernel's arguments, read off its source: importing it would import the compiler."""

from __future__ import annotations

import ast
import importlib.util
from functools import cache
from pathlib import Path

__all__ = ["parameters_of"]


@cache
def parameters_of(name: str) -> tuple[str, ...]:
    """The names of the arguments of ``module.function``; none where it cannot be found.

    >>> parameters_of("limner.shading.lambert.eval_lambert")
    ('kd', 'n', 'l')
    """
    module, _, function = name.rpartition(".")
    return _functions(module).get(function, ())


@cache
def _functions(module: str) -> dict[str, tuple[str, ...]]:
    """The arguments of all functions of a module, by name; of other names for them, too."""
    try:
        found = importlib.util.find_spec(module)
    except (ImportError, ValueError):
        return {}
    if found is None or found.origin is None or not found.origin.endswith(".py"):
        return {}
    held: dict[str, tuple[str, ...]] = {}
    for statement in ast.parse(Path(found.origin).read_text(encoding="utf-8")).body:
        if isinstance(statement, ast.FunctionDef):
            held[statement.name] = tuple(argument.arg for argument in (*statement.args.posonlyargs, *statement.args.args))
        elif isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Name) and statement.value.id in held:
            held |= {target.id: held[statement.value.id] for target in statement.targets if isinstance(target, ast.Name)}
    return held
