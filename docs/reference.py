"""Pages of the documentation that are made from the program itself, so that they cannot go stale.

A page says where: `<!-- commands -->` becomes the help of every command, `<!-- room scene -->` what the room `limner.scene` holds. Both are
put into the page's source when Sphinx reads it, so that nothing generated lies in the tree.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import click
from docstrings import first_paragraph, markdown_of

__all__ = ["commands_markdown", "examples_first", "names_of_room", "room_markdown", "setup"]

_MARK = re.compile(r"^<!-- (commands|room) ?(\w*) -->$", flags=re.MULTILINE)
_PACKAGE = Path(__file__).resolve().parents[1] / "src" / "limner"
_WHOLE = ("color", "curves", "draw", "image", "linear", "mesh")  # rooms of plain functions, of which all are told
_WIDTH = 100  # of a usage line, characters
_LONG = 60  # characters of a default or of a type that say more than `...`


# --- the command line -----------------------------------------------------------------------------------------------------


def commands_markdown() -> str:
    """Return a section in Markdown for each command and subcommand, from the very objects that parse the command line."""
    from limner.cli.commands import limner

    return "\n".join(_sections(limner, None, "limner", level=2))


def _sections(group: click.Group, parent: click.Context | None, name: str, level: int) -> Iterator[str]:
    context = click.Context(group, info_name=name, parent=parent, terminal_width=_WIDTH, max_content_width=_WIDTH)
    for child in sorted(group.list_commands(context)):
        command = group.get_command(context, child)
        assert command is not None
        yield from _section(command, click.Context(command, info_name=child, parent=context, max_content_width=_WIDTH), level)
        if isinstance(command, click.Group):
            yield from _sections(command, context, child, level + 1)


def _section(command: click.Command, context: click.Context, level: int) -> Iterator[str]:
    path = context.command_path
    yield f"({path.replace(' ', '-')})=\n{'#' * level} {path}\n"
    yield f"```text\n{command.get_usage(context).removeprefix('Usage: ')}\n```\n"
    for paragraph in inspect.cleandoc(command.help or "").split("\n\n"):
        if paragraph.startswith("\b"):
            yield f"```text\n{inspect.cleandoc(paragraph[1:].strip(chr(10)))}\n```\n"
        else:
            yield _escaped(" ".join(paragraph.split())) + "\n"
    for parameter in command.get_params(context):
        record = parameter.get_help_record(context)
        if record is not None and record[1]:
            yield f"`{record[0]}`\n: {_escaped(record[1])}\n"


def _escaped(text: str) -> str:
    """Markdown that shows the text as it stands: a star, a bracket or an underscore of the help means nothing else."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(part if part.startswith("`") else re.sub(r"([\\*_\[\]<>#|~$])", r"\\\1", part) for part in parts)


# --- what the rooms hold --------------------------------------------------------------------------------------------------


def names_of_room(room: str) -> list[str]:
    """Return the names of `limner` that come from a room, sorted; those from modules beside the rooms come from the room ``limner``."""
    import limner

    homes = {name: home for home, names in limner._HOMES.items() for name in names} | dict(limner._MODULES)
    return sorted(name for name, home in homes.items() if _room_of(home) == room)


def _room_of(home: str) -> str:
    first = home.split(".")[0]
    return first if (_PACKAGE / first).is_dir() else "limner"


def room_markdown(room: str) -> str:
    """Return what a room holds: its public names first, then its modules, with their functions where these need nothing compiled."""
    import limner

    public = [(name, getattr(limner, name)) for name in names_of_room(room)]
    lines = [_documented(f"limner.{name}", thing) for name, thing in public]
    if room == "limner":
        return "\n".join(lines)
    known = {id(thing) for _, thing in public}
    return "\n".join([*lines, *(_whole_modules(room, known) if room in _WHOLE else _listed_modules(room))])


def _documented(name: str, thing: Any) -> str:
    if inspect.ismodule(thing):
        return f"`{name}`\n: The module `{thing.__name__}`: {first_paragraph(thing.__doc__)}\n"
    if inspect.isclass(thing):
        return _directive("py:class", f"{name}{_signature(thing)}", [markdown_of(thing.__doc__), *_members(thing)], depth=5)
    return _directive("py:function", f"{name}{_signature(thing)}", [markdown_of(thing.__doc__)], depth=5)


def _members(kind: type) -> Iterator[str]:
    """Methods and properties that say what they are for, those of limner's own base classes included."""
    seen = set()
    for base in kind.__mro__:
        if not base.__module__.startswith("limner"):
            continue
        for name, member in vars(base).items():
            plain = getattr(member, "__func__", None) or getattr(member, "fget", None) or member
            if name.startswith("_") or name in seen or not inspect.isfunction(plain) or not plain.__doc__:
                continue
            seen.add(name)
            body = [markdown_of(plain.__doc__)]
            if isinstance(member, property):
                yield _directive("py:property", name, body, depth=4)
            else:
                options = [f":{type(member).__name__}:"] if isinstance(member, classmethod | staticmethod) else []
                yield _directive("py:method", f"{name}{_signature(getattr(kind, name))}", body, depth=4, options=options)


def _signature(thing: Any) -> str:
    """Names and defaults; what each is stands below. `self` is left out, and a default that needs a line of its own is `...`."""
    try:
        signature = inspect.signature(thing)
    except (TypeError, ValueError):
        return ""
    kept = [parameter.replace(annotation=inspect.Parameter.empty) for parameter in signature.parameters.values()]
    if kept and kept[0].name == "self":
        del kept[0]
    shown = [one if one.default is one.empty else one.replace(default=_Shown(one.default)) for one in kept]
    returned = signature.return_annotation
    told = f" -> {returned}" if isinstance(returned, str) and not inspect.isclass(thing) and len(returned) < _LONG else ""
    return str(inspect.Signature(shown)) + told


class _Shown:
    """A default, as short as it can be shown."""

    def __init__(self, value: Any) -> None:
        text = repr(value)
        self.text = text if len(text) < _LONG and not text.startswith("<") else "..."

    def __repr__(self) -> str:
        return self.text


def _directive(kind: str, what: str, body: Iterable[str], *, depth: int, options: Sequence[str] = ()) -> str:
    fence = ":" * depth
    return "\n".join([f"{fence}{{{kind}}} {what}", *options, "", *body, fence, ""])


def _modules(room: str) -> Iterator[tuple[str, ast.Module]]:
    folder = _PACKAGE / room
    for path in sorted(folder.rglob("*.py")):
        if path.name not in ("__init__.py", "__main__.py"):
            yield ".".join(path.relative_to(_PACKAGE).with_suffix("").parts), ast.parse(path.read_text(encoding="utf-8"))


def _listed_modules(room: str) -> Iterator[str]:
    """What each module is for, read without importing it."""
    yield "\n## Modules\n"
    for name, tree in _modules(room):
        yield f"`limner.{name}`\n: {first_paragraph(ast.get_docstring(tree))}\n"


def _whole_modules(room: str, known: set[int]) -> Iterator[str]:
    for name, tree in _modules(room):
        yield f"\n## {name}\n\n{markdown_of(ast.get_docstring(tree))}\n"
        yield f"```{{py:currentmodule}} limner.{name}\n```\n"
        module = importlib.import_module(f"limner.{name}")
        for word in getattr(module, "__all__", ()):
            thing = getattr(module, word)
            is_its_own = getattr(thing, "__module__", None) == module.__name__ and (inspect.isclass(thing) or inspect.isfunction(thing))
            if is_its_own and id(thing) not in known:
                yield _documented(word, thing)


# --- Sphinx ---------------------------------------------------------------------------------------------------------------


def _filled(_app: Any, page: str, source: list[str]) -> None:
    def made(mark: re.Match[str]) -> str:
        return commands_markdown() if mark[1] == "commands" else room_markdown(mark[2])

    source[0] = _MARK.sub(made, source[0])
    if page == "course-map":
        source[0] = examples_first(source[0])


def examples_first(text: str) -> str:
    """A page's tables with their last column of five as the third: on a telephone, what one may look at stands before what is cited.

    >>> examples_first("| 4.7 | Shadows | function | test | example |")
    '| 4.7 | Shadows | example | function | test |'
    """
    rows = []
    for line in text.split("\n"):
        cells = line.split(" | ") if line.startswith("| ") else []
        if len(cells) == 5:
            *head, function, test, example = cells
            line = " | ".join([*head, example.removesuffix(" |"), function, f"{test} |"])
        rows.append(line)
    return "\n".join(rows)


def setup(app: Any) -> dict[str, Any]:
    """Let Sphinx fill the marks of pages."""
    app.connect("source-read", _filled)
    return {"version": "1", "parallel_read_safe": True}
