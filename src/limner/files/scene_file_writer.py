"""From a scene to plain values: what differs from the defaults, and what is shared once.

Materials stand in a table of their own and are referred to by name; so do textures, texels, geometries and nodes that are used more than
once. What is written is what the classes are made with, so that reading it gives the same scene, to the bit.
"""

from __future__ import annotations

import functools
import hashlib
import math
import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import RenderError, SceneError, UnsupportedError
from ..mesh.mesh import Mesh
from ..scene.distance import Capsule
from ..scene.environment import Environment
from ..scene.node import Node
from ..scene.scene import Scene
from .scene_file_arrays import ArrayWriter, inline
from .scene_file_kinds import ABSENT, DISTANCES, TABLES, Form, Member, kind_names, members_of, snake, table_of

__all__ = ["SceneWriter"]

_LEVELS = 24
"""How deep nodes stand in each other in the text; what is deeper becomes a named subtree."""

_IDENTITY = np.eye(4)


class SceneWriter:
    """Says one scene in plain values, its arrays and its files apart.

    Parameters
    ----------
    path : Path
        Where the text is to stand: files are named as seen from there.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self.arrays = ArrayWriter()
        self.copies: dict[str, Path] = {}
        self._tables: dict[str, dict[str, Any]] = {table: {} for table in TABLES}
        self._names: dict[int, tuple[Any, str]] = {}
        self._taken: set[str] = set()
        self._numbers: Counter[str] = Counter()
        self._uses: Counter[int] = Counter()

    def document(self, scene: Scene) -> dict[str, Any]:
        """Everything but the version, the settings and the file of arrays."""
        self._count(scene)
        members = {member.name: member for member in members_of(Scene)}
        root = self._graph(scene.root)
        rest = {name: self._member(scene, member) for name, member in members.items() if name != "root"}
        first = ("name", "camera", "background", "environment", "fog")
        said = {name: value for name in first if (value := rest.pop(name)) is not ABSENT}
        said |= {table: entries for table, entries in self._tables.items() if entries}
        # A root of which nothing is said but its children needs no words of its own.
        said |= {"nodes": root["children"]} if isinstance(root, dict) and list(root) == ["children"] else {"root": root} if root else {}
        return said | {name: value for name, value in rest.items() if value is not ABSENT}

    # --- what is used more than once ----------------------------------------------------------------------------------------

    def _count(self, scene: Scene) -> None:
        """Count how often each description that may be named would be said."""
        stack: list[Any] = [scene]
        while stack:
            for held in _held(stack.pop()):
                self._uses[id(held)] += 1
                # What has no name is said once more wherever it stands, and all that it holds.
                if self._uses[id(held)] == 1 or type(held) not in _NAMEABLE:
                    stack.append(held)

    def _named(self, value: Any, table: str) -> str | None:
        """The name of a description that has one, or is to have one."""
        known = self._names.get(id(value))
        if known is not None:
            return known[1]
        always = table == "materials" and value.name
        return self._keep(value, table) if table and (always or self._uses[id(value)] > 1) else None

    def _keep(self, value: Any, table: str) -> str:
        """Put a description into its table."""
        entries = self._tables[table]
        first = getattr(value, "name", "") or snake(type(value)).replace("_", " ")
        name = first
        while name in self._taken:
            self._numbers[first] += 1
            name = f"{first} {self._numbers[first] + 1}"
        self._taken.add(name)
        # The description is kept with its name: its id must stay its own.
        self._names[id(value)] = value, name
        form = Form(classes=TABLES[table])
        said = self._described(value, form) if table != "subtrees" else {}
        entries[name] = said
        for fields in said.values() if form.keyed else (said,):
            if hasattr(value, "name"):
                _name_once(fields, value.name, name)
        return name

    # --- nodes --------------------------------------------------------------------------------------------------------------

    def _graph(self, root: Node) -> Any:
        """The nodes, without recursion into their depth."""
        said: dict[int, Any] = {}
        levels: dict[int, int] = {}
        stack: list[tuple[Node, bool]] = [(root, False)]
        while stack:
            node, is_open = stack.pop()
            if id(node) in said:
                continue
            if not is_open:
                stack.append((node, True))
                stack += [(child, False) for child in reversed(node.children)]
                continue
            plain = {member.name: self._member(node, member) for member in members_of(Node) if member.name != "children"}
            plain = {name: value for name, value in plain.items() if value is not ABSENT}
            if node.children:
                plain["children"] = [said[id(child)] for child in node.children]
            levels[id(node)] = 1 + max((levels[id(child)] for child in node.children), default=0)
            said[id(node)] = plain
            if node is not root and (self._uses[id(node)] > 1 or levels[id(node)] >= _LEVELS):
                name = self._keep(node, "subtrees")
                _name_once(plain, node.name, name)
                self._tables["subtrees"][name] = plain
                said[id(node)], levels[id(node)] = name, 0
        return said[id(root)]

    # --- values -------------------------------------------------------------------------------------------------------------

    def _member(self, thing: Any, member: Member) -> Any:
        """A field in plain values; ABSENT where it is the default."""
        is_height = isinstance(thing, Capsule) and member.attribute == "height"
        held: Any = _height_of(thing) if is_height else getattr(thing, member.attribute)
        if held is member.default:
            return ABSENT
        if member.form.place:
            same = isinstance(member.default, np.ndarray) and held.tobytes() == _IDENTITY.tobytes()
            return ABSENT if same else _place(held)
        if isinstance(thing, Environment) and member.attribute == "source" and isinstance(held, str):
            return self._file(held)
        if member.default is not ABSENT and _is_same(held, member.default):
            return ABSENT
        return self._value(held, member.form, member.name)

    def _value(self, held: Any, form: Form, name: str) -> Any:
        if held is None or isinstance(held, (bool, str)):
            return held
        if isinstance(held, np.ndarray):
            said = inline(held, form.array or ())
            return {"array": self.arrays.add(name, held)} if said is None else said
        if form.many is not None:
            said = [self._value(one, form.many, name) for one in held]
            return said[0] if len(said) == 1 and isinstance(said[0], str) else said
        if form.by_name is not None:
            return {key: self._value(value, form.by_name, key) for key, value in held.items()}
        if form.classes:
            return self._reference(held, form)
        return _plain(held, name)

    def _reference(self, held: Any, form: Form) -> Any:
        return self._named(held, table_of(form.classes)) or self._described(held, form)

    def _described(self, held: Any, form: Form) -> Any:
        kinds = {kind: name for name, kind in kind_names(form.classes).items()}
        if type(held) not in kinds:
            raise UnsupportedError(f"a scene file has no words for a {type(held).__name__} here; it has for: {', '.join(kinds.values())}")
        fields = self._fields(held)
        return {kinds[type(held)]: fields} if form.keyed else fields

    def _fields(self, held: Any) -> dict[str, Any]:
        said: dict[str, Any] = {}
        for member in members_of(type(held)):
            if member.flat:
                geometry = getattr(held, member.attribute)
                named = self._named(geometry, table_of(member.form.classes)) if isinstance(geometry, _LARGE) else None
                said |= {member.attribute: named} if named else self._described(geometry, member.form)
                continue
            value = self._member(held, member)
            if value is not ABSENT:
                said[member.name] = value
        return said

    def _file(self, source: str) -> str:
        """A file as the scene's file names it; one that stands elsewhere is copied beside it."""
        found = Path(source)
        if not found.is_file():
            raise SceneError(f"environment.source names a file that is missing: {source!r}")
        folder = Path(os.path.realpath(self._path)).parent
        real = Path(os.path.realpath(found))
        if real.is_relative_to(folder):
            return _reference_to(real.relative_to(folder).as_posix())
        try:
            digest = hashlib.blake2b(found.read_bytes(), digest_size=8).hexdigest()
        except OSError as error:
            raise RenderError(f"cannot read {source}: {error.strerror or error}") from error
        name = f"{self._path.name}.sky-{digest}{found.suffix}"
        self.copies[name] = found
        return _reference_to(name)


_NAMEABLE = frozenset(kind for family in TABLES.values() for kind in family)
_LARGE = tuple(kind for kind in TABLES["geometries"] if kind is Mesh or not kind.__module__.endswith(".primitive"))


@functools.cache
def _holders(kind: Any) -> tuple[Member, ...]:
    """The fields of a class that may hold descriptions."""
    return tuple(m for m in members_of(kind) if m.form.classes or (m.form.many is not None and m.form.many.classes))


def _held(thing: Any) -> Iterator[Any]:
    for member in _holders(thing.__class__) if type(thing) not in DISTANCES else ():  # nothing in a field of distances has a name
        held = getattr(thing, member.attribute)
        yield from (one for one in (held if isinstance(held, tuple) else (held,)) if one is not None)


def _place(matrix: Any) -> Any:
    moved = _IDENTITY.copy()
    moved[:3, 3] = matrix[:3, 3]
    return {"translate": matrix[:3, 3].tolist()} if moved.tobytes() == matrix.tobytes() else matrix.tolist()


def _plain(held: Any, name: str) -> Any:
    if isinstance(held, (tuple, list)):
        return [_plain(value, name) for value in held]
    if held is None or isinstance(held, (str, bool, int, float)):
        return held
    if isinstance(held, (np.bool_, np.integer, np.floating)):
        return held.item()
    raise UnsupportedError(f"a scene file has no words for {name}: a {type(held).__name__}")


def _is_same(held: Any, default: Any) -> bool:
    """Whether two values are the same to the bit, and of the same types: 1 and 1.0 are not."""
    if isinstance(held, np.ndarray) or isinstance(default, np.ndarray):
        return False
    if isinstance(held, tuple) and isinstance(default, tuple):
        return len(held) == len(default) and all(map(_is_same, held, default))
    return held is default or (type(held) is type(default) and isinstance(held, (str, int, float)) and repr(held) == repr(default))


def _name_once(fields: dict[str, Any], own: str, name: str) -> None:
    """Say the own name of what stands in a table under a name, where it is another."""
    fields.pop("name", None)
    if own != name:
        fields["name"] = own


def _height_of(capsule: Capsule) -> float:
    """The height that a capsule was made with, or one that makes the same."""
    half = capsule.end[1]
    height = 2.0 * (half + capsule.radius)
    for candidate in (height, math.nextafter(height, 0.0), math.nextafter(height, math.inf)):
        if candidate / 2.0 - capsule.radius == half:
            return candidate
    return height


def _reference_to(name: str) -> str:
    return name.replace("%", "%25")
