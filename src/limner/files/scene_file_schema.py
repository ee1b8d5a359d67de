"""The schema of scene files: one msgspec type for each description, made of its fields, which checks files and is shown to editors.

    limner schema > limner.schema.json

The types say what is written where, and what kind of value it is; what a value must be beyond that (a radius is positive), the
descriptions themselves say when they are made. What msgspec finds is said in the words of people who write files, not types.
"""

from __future__ import annotations

import difflib
import functools
import re
import threading
from collections.abc import Iterable
from typing import Any, ForwardRef, Literal, Union, get_args, get_origin

import msgspec

from ..mesh.mesh import Mesh
from ..scene.camera import PerspectiveCamera
from ..scene.node import Node
from ..scene.points import PointCloud
from ..scene.scene import Scene
from ..scene.texture import Texels
from . import scene_file_types as types
from .notes import quoted
from .scene_file_kinds import ABSENT, DISTANCES, TABLES, Form, Member, kind_names, members_of, table_of
from .scene_file_settings import Settings
from .scene_file_yaml import Where

__all__ = ["CAMERA_WORDS", "VERSION", "MismatchError", "check", "did_you_mean", "json_schema", "type_of_class", "type_of_form"]

VERSION = 1

CAMERA_WORDS = ("focal_length_mm", "sensor_height_mm", "xfov_degrees", "f_number")
"""In which other words a perspective camera's field of view and opening may be said."""

_Row = list[float | list[float | list[float | list[float]]]]
_Triple = tuple[float, float, float]
_ONE_OF = "_kinds"  # how the types of mappings with one key end

_made: set[str] = set()
_making = threading.Lock()


class MismatchError(Exception):
    """A value that is not of its type: where it stands below what was checked, and what is wrong with it."""

    def __init__(self, where: Where, text: str) -> None:
        self.where, self.text = where, text
        super().__init__(text)


class array(msgspec.Struct, forbid_unknown_fields=True):  # noqa: N801 - as it is called in the JSON schema
    """An array: by its name in the file of arrays, or its values with what their type is."""

    array: str | None = None
    dtype: Literal["bool", "uint8", "uint16", "uint32", "uint64", "int8", "int16", "int32", "int64", "float32", "float64"] | None = None
    shape: list[int] | None = None
    values: list[Any] | None = None


_ARRAYS = _Row | array


class rotation(msgspec.Struct, forbid_unknown_fields=True):  # noqa: N801
    """A rotation about an axis through the origin, counter-clockwise seen from its tip."""

    axis: _Triple
    degrees: float


class look_at(msgspec.Struct, forbid_unknown_fields=True):  # noqa: N801
    """Stand at `eye` with -z towards `target`."""

    eye: _Triple
    target: _Triple
    up: _Triple = (0.0, 1.0, 0.0)


class place(msgspec.Struct, forbid_unknown_fields=True):  # noqa: N801
    """Where something stands: scaled first, then rotated, then translated; or with its -z towards something."""

    translate: _Triple | None = None
    rotate: rotation | None = None
    quaternion: tuple[float, float, float, float] | None = None
    scale: float | _Triple | None = None
    look_at: look_at | None = None


class model(msgspec.Struct, forbid_unknown_fields=True):  # noqa: N801
    """What another file holds, or one of its nodes."""

    file: str
    node: str | None = None
    up: Literal["y", "z"] = "y"


_FROM_FILE = {"file": str | None, "node": str | None, "number": int | None}
_MORE: dict[type, dict[str, Any]] = {
    Mesh: {**_FROM_FILE, "builtin": Literal["teapot"] | None},
    PointCloud: _FROM_FILE,
    Texels: {"file": str | None},
    Node: {"model": str | model | None},
    PerspectiveCamera: dict.fromkeys(CAMERA_WORDS, float | None),
}
"""Other ways to say what a description is, so that none of its fields has to be there."""

_REFERRED = (Mesh, PointCloud, Texels)


def _name(kind: type) -> str:
    return f"Distance{kind.__name__}" if kind in DISTANCES else kind.__name__


def type_of_class(kind: type) -> Any:
    """The msgspec type of the mapping that describes a class."""
    name = _name(kind)
    if name not in _made:
        _made.add(name)
        fields = [field for member in members_of(kind) for field in _fields(member, kind in _REFERRED)]
        fields += [(word, hint, None) for word, hint in _MORE.get(kind, {}).items()]
        _define(name, fields, (kind.__doc__ or "").strip().split("\n\n")[0])
    return ForwardRef(name)


def _define(name: str, fields: list[Any], doc: str) -> None:
    made = msgspec.defstruct(
        name, fields, module=types.__name__, namespace={"__doc__": " ".join(doc.split())}, kw_only=True, forbid_unknown_fields=True
    )
    setattr(types, name, made)


def _fields(member: Member, referred: bool) -> Iterable[tuple[Any, ...]]:
    if member.flat:
        for kind, described in kind_names(member.form.classes).items():
            yield kind, _either_of(type_of_class(described), None), None
        yield member.attribute, str | None, None
        return
    hint = type_of_form(member.form)
    if member.default is ABSENT and not referred:
        yield member.name, hint
    elif _is_plain(member.default):
        yield member.name, hint, member.default
    else:
        yield member.name, _either_of(hint, msgspec.UnsetType), msgspec.UNSET


def _either_of(*hints: Any) -> Any:
    """The union of types, of which some are only names yet."""
    return Union.__getitem__(hints)


def _is_plain(value: Any) -> bool:
    return all(map(_is_plain, value)) if isinstance(value, tuple) else value is None or isinstance(value, (bool, int, float, str))


def type_of_form(form: Form) -> Any:
    """The msgspec type of what may stand in a place."""
    members: list[Any] = [None] if form.optional else []
    for hint in form.plain:
        if hint == _Triple:
            members.append(float)
        if not (form.array is not None and get_origin(hint) is tuple):
            members.append(hint)
    if form.array is not None:
        members += [_Row, array]
    if form.place:
        members += [list[tuple[float, float, float, float]], place]
    if form.classes:
        members += [type_of_kinds(form.classes) if form.keyed else type_of_class(form.classes[0])]
        members += [str] if table_of(form.classes) else []
    if form.many is not None:
        one: Any = type_of_form(form.many)
        members += [list.__class_getitem__(one), *(get_args(one) if get_origin(one) is Union else [one])]
    if form.by_name is not None:
        members.append(dict[str, type_of_form(form.by_name)])  # type: ignore[misc]
    return _either_of(*members)


def type_of_kinds(classes: tuple[type, ...]) -> Any:
    """The msgspec type of a mapping whose one key says which class it describes."""
    table = table_of(classes)
    name = (table if table and set(classes) == set(TABLES[table]) else "_or_".join(sorted(map(_name, classes)))[:80]) + _ONE_OF
    if name not in _made:
        _made.add(name)
        fields = [(kind, _either_of(type_of_class(described), None), None) for kind, described in kind_names(classes).items()]
        _define(name, fields, "One key: what it is.")
    return ForwardRef(name)


def _document() -> Any:
    """The type of a whole file; with it all others are there, whichever thread comes first."""
    with _making:
        return _made_document()


@functools.cache
def _made_document() -> Any:
    type_of_class(Settings)
    fields: list[tuple[Any, ...]] = [("limner", Literal[VERSION])]
    fields += [("settings", _either_of(ForwardRef("Settings"), None), None), ("arrays", str | None, None)]
    fields += [field for member in members_of(Scene) for field in _fields(member, False)]
    for name, classes in TABLES.items():
        fields.append((name, dict[str, type_of_form(Form(classes=classes))], {}))  # type: ignore[misc]
    nodes = type_of_form(Form(many=Form(classes=(Node,))))
    fields.append(("nodes", _either_of(nodes, msgspec.UnsetType), msgspec.UNSET))
    _define("SceneFile", fields, "A scene of limner: what there is to see, and how its picture is made.")
    return vars(types)["SceneFile"]


def _resolved(kind: Any) -> Any:
    """A type without names for others, at its top; the rest msgspec looks up itself."""
    document = _document()
    if kind is Scene:
        return document
    hint = type_of_form(kind) if isinstance(kind, Form) else type_of_class(kind)
    return _without_names(hint)


def _without_names(hint: Any) -> Any:
    if isinstance(hint, ForwardRef):
        return vars(types)[hint.__forward_arg__]
    if get_origin(hint) is Union:
        return _either_of(*map(_without_names, get_args(hint)))
    if get_origin(hint) is list:
        return list[_without_names(get_args(hint)[0])]  # type: ignore[misc]
    if get_origin(hint) is dict:
        return dict[str, _without_names(get_args(hint)[1])]  # type: ignore[misc]
    return hint


def json_schema() -> dict[str, Any]:
    """The schema as JSON Schema (2020-12), for editors."""
    schema = msgspec.json.schema(_document())
    for name, described in schema.get("$defs", {}).items():
        if name.endswith(_ONE_OF):
            described |= {"minProperties": 1, "maxProperties": 1}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "limner scene", **schema}


# --- checking -------------------------------------------------------------------------------------------------------------

_STEP = re.compile(r"\.(\w+)|\[(\d+)\]")
_NOUNS = {
    "float": "a number", "int": "a whole number", "str": "text", "bool": "true or false", "array": "a list", "object": "a mapping",
    "null": "nothing",
}  # fmt: skip
_OTHERS: dict[Any, str] = {
    msgspec.inspect.FloatType: "a number", msgspec.inspect.TupleType: "a list", msgspec.inspect.ListType: "a list",
    msgspec.inspect.StructType: "a mapping",
}  # fmt: skip


def check(value: Any, kind: Any) -> None:
    """Raise MismatchError unless plain values are of the type of a class, or of a Form; of Scene, the type of a whole file."""
    checked = _resolved(kind)
    try:
        msgspec.convert(value, checked)
    except msgspec.ValidationError as error:
        raise _mismatch(str(error), value, checked) from None
    except RecursionError:
        raise MismatchError((), "is nested too deeply") from None


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """The known word that is most like one that is not known, as a question; else all of them.

    >>> did_you_mean("radus", ("radius", "height"))
    "did you mean 'radius'?"
    """
    known = list(known)
    near = difflib.get_close_matches(word, known, 1, 0.6)
    return f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known) or 'none'}"


def _mismatch(text: str, value: Any, checked: Any) -> MismatchError:
    said, _, place = text.partition(" - at `")
    where = _where(place.rstrip("`"))
    found = _at(value, where)
    if "[...]" in place:
        return _mismatch_by_name(where, found)
    unknown = re.search(r"unknown field `(.*)`", said)
    if unknown:
        known = _keys_of(checked, value, where)
        return MismatchError((*where, unknown[1]), f"unknown key {quoted(unknown[1])}; {did_you_mean(unknown[1], known)}")
    missing = re.search(r"missing required field `(.*)`", said)
    if missing:
        return MismatchError(where, f"{missing[1]} is missing")
    if said.startswith("Invalid enum value"):
        words, nouns = _words_at(checked, value, where)
        hint = f"; {did_you_mean(found, words)}" if isinstance(found, str) and difflib.get_close_matches(found, words, 1, 0.6) else ""
        return MismatchError(where, f"must be {_either([*words, *nouns])}, got {quoted(found)}{hint}")
    expected = re.search(r"Expected `([^`]*)`(?: of (?:at least )?length (.*))?", said)
    if expected is None:
        return MismatchError(where, said[:1].lower() + said[1:])
    if expected[2]:
        length = expected[2].partition(",")[0]
        return MismatchError(where, f"must be a list of {length}, got {len(found) if isinstance(found, (list, tuple)) else quoted(found)}")
    nouns = [_NOUNS.get(noun.strip(), noun.strip()) for noun in expected[1].split("|")]
    return MismatchError(where, f"must be {_either([noun for noun in nouns if noun != 'nothing'] or nouns)}, got {_told(found)}")


def _mismatch_by_name(where: Where, mapping: dict[str, Any]) -> MismatchError:
    """Of a mapping from any names to arrays, which msgspec does not tell, the one that is none."""
    for name, value in mapping.items():
        try:
            msgspec.convert(value, _ARRAYS)
        except msgspec.ValidationError as error:
            found = _mismatch(str(error), value, _ARRAYS)
            return MismatchError((*where, name, *found.where), found.text)
    return MismatchError(where, "must be a mapping from names to arrays")


def _told(value: Any) -> str:
    if isinstance(value, (dict, list)):
        return "a mapping" if isinstance(value, dict) else f"a list of {len(value)}"
    return {None: "nothing", True: "true", False: "false"}[value] if value is None or isinstance(value, bool) else quoted(value)


def _either(words: Iterable[Any]) -> str:
    *most, last = [str(word) for word in words]
    return f"{', '.join(most)} or {last}" if most else last


def _where(place: str) -> Where:
    return tuple(int(number) if number else word for word, number in _STEP.findall(place.removeprefix("$").partition("[...]")[0]))


def _at(value: Any, where: Where) -> Any:
    for step in where:
        value = value[step]
    return value


def _types_at(checked: Any, value: Any, where: Where) -> list[Any]:
    """What msgspec knows of the types that may stand in a place."""
    found, here = [msgspec.inspect.type_info(checked)], value
    for step in where:
        below: list[Any] = []
        for one in _flattened(found):
            if isinstance(one, msgspec.inspect.StructType) and isinstance(step, str):
                below += [field.type for field in one.fields if field.name == step]
            elif isinstance(one, msgspec.inspect.TupleType) and isinstance(step, int):
                below += list(one.item_types[step : step + 1])
            elif isinstance(step, int) and hasattr(one, "item_type"):
                below.append(one.item_type)
        found, here = below, here[step]
    return _flattened(found)


def _flattened(found: list[Any]) -> list[Any]:
    return [one for many in found for one in (many.types if isinstance(many, msgspec.inspect.UnionType) else (many,))]


def _keys_of(checked: Any, value: Any, where: Where) -> list[str]:
    found = _types_at(checked, value, where)
    return [field.name for one in found if isinstance(one, msgspec.inspect.StructType) for field in one.fields]


def _words_at(checked: Any, value: Any, where: Where) -> tuple[list[str], list[str]]:
    """The words that may stand in a place, and what else may."""
    found = _types_at(checked, value, where)
    words = [str(word) for one in found if isinstance(one, msgspec.inspect.LiteralType) for word in one.values]
    return words, [noun for kind, noun in _OTHERS.items() if any(isinstance(one, kind) for one in found)]
