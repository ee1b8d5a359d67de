"""From plain values with lines to a scene: every description is made by its own class, which checks what it is given.

A value passes two sieves. The schema says whether it is what may stand there at all; the class says whether it makes sense. What either
objects to is told with the line and the way to the place.

Nodes are read without recursion, as they may be deep; all else nests as deep as YAML may.
"""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple, get_origin

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, LimnerError, SceneError
from ..linear import transform
from ..linear.quaternion import from_axis_angle
from ..mesh.mesh import Mesh
from ..mesh.shapes.teapot import teapot
from ..scene.animation import Animation
from ..scene.camera import PerspectiveCamera
from ..scene.environment import Environment
from ..scene.node import MAX_DEPTH, Node, names_among_siblings
from ..scene.points import PointCloud
from ..scene.scene import Scene
from ..scene.shape import Shape
from ..scene.solid import Solid
from ..scene.texture import Texels
from .limits import Limits
from .notes import Notes, quoted
from .pictures import read_texels
from .scene_file_arrays import ArrayReader, outline
from .scene_file_kinds import TABLES, Form, Member, kind_names, members_of, table_of
from .scene_file_models import Models, geometries_of, grafted, part_of
from .scene_file_schema import CAMERA_WORDS, MismatchError, check, did_you_mean
from .scene_file_yaml import Document, Where
from .sources import Sources

__all__ = ["SceneReader"]

_MAX_CHAIN = 64
"""How often a named description may refer to one that refers to one, and so on."""

_NODE = Form(classes=(Node,))


class _Slot:
    """A node that is to be made, when its children are."""

    def __init__(self, plain: Any, where: Where, path: str) -> None:
        self.plain, self.where, self.path = plain, where, path
        self.children: list[_Slot] = []
        self.model: Node | None = None


class _Extent(NamedTuple):
    """How many nodes there are in a node as it is walked, and how deep."""

    n_nodes: int
    depth: int


class SceneReader:
    """Makes the scene of one document."""

    def __init__(self, document: Document, sources: Sources, limits: Limits, notes: Notes, models: Models) -> None:
        self.document, self.sources, self.limits, self.notes, self.models = document, sources, limits, notes, models
        self._named: dict[tuple[str, str], Any] = {}
        self._chain: list[tuple[str, str]] = []
        self._extents: dict[int, tuple[Node, _Extent]] = {}
        self._arrays: ArrayReader | None = None
        self._animations: list[Animation] = []
        self._n_vertices = self._n_triangles = 0

    def scene(self) -> Scene:
        """Everything; raises FileFormatError with the line and the place."""
        top = self.document.top
        if not isinstance(top, dict):
            raise self.document.error((), "a scene file must be a mapping that begins with 'limner: 1'")
        self._check({key: _hollow(key, value) for key, value in top.items()}, Scene, ())
        if "root" in top and "nodes" in top:
            raise self.document.error(("nodes",), "there is a root already; nodes are its children, where nothing else is said of it")
        if top.get("arrays") is not None:
            self._arrays = ArrayReader(self.sources.read_beside(top["arrays"], self._position(("arrays",))), top["arrays"], self.limits)
        for table in TABLES:
            for name in top.get(table, {}):
                self._from_table(table, name, (table, name))
        given = {}
        for member in members_of(Scene):
            if member.name in top and member.name not in ("root", "animations", "notes"):
                given[member.attribute] = self._value(top[member.name], member.form, (member.name,))
        root = self._root(top)
        own = {member.name: self._value(top.get(member.name) or [], member.form, (member.name,)) for member in members_of(Scene)
               if member.name in ("animations", "notes")}  # fmt: skip
        given |= {"root": root, "animations": (*own["animations"], *self._animations), "notes": (*own["notes"], *self.notes.lines())}
        return self._make(Scene, given, ())

    def _root(self, top: dict[str, Any]) -> Node:
        if top.get("root") is not None:
            return self._node(top["root"], ("root",), "")
        children = top.get("nodes", [])
        wrapped = {"children": children}
        return self._node(wrapped, (), "") if children else Node()

    # --- nodes ----------------------------------------------------------------------------------------------------------

    def _node(self, plain: Any, where: Where, path: str) -> Node:
        """A node with all below it. `path` is that of its parent, "" for the root; None below what is shared, which has several."""
        name = self._name_of(plain)
        first = _Slot(plain, where, name or "world" if path == "" else path)
        slots = [first]
        for slot in slots:  # grows on the way: parents first
            self._open(slot)
            slots += slot.children
            if len(slots) > self.limits.max_nodes:
                raise self.document.error(where, f"there are more than {self.limits.max_nodes} nodes (max_nodes)")
        made: dict[int, Node] = {}
        for slot in reversed(slots):
            made[id(slot)] = self._close(slot, [made[id(child)] for child in slot.children])
        return made[id(first)]

    def _open(self, slot: _Slot) -> None:
        """Find the children of a node, and what it shows of another file."""
        if isinstance(slot.plain, str):
            return
        children = slot.plain.get("children") if isinstance(slot.plain, dict) else None
        hollow = {**slot.plain, "children": []} if isinstance(children, (list, dict, str)) else slot.plain
        self._check(hollow, _NODE, slot.where)
        listed = children if isinstance(children, list) else [] if children is None else [children]
        if slot.plain.get("model") is not None:
            slot.model = self._model(slot)
        names = [self._name_of(child) for child in listed]
        before = [] if slot.model is None else [slot.model.name]
        in_paths = names_among_siblings([*before, *names])[len(before) :]
        below = (*slot.where, "children") if slot.where else ("nodes",)
        for index, (child, name) in enumerate(zip(listed, in_paths, strict=True)):
            where = (*below, index) if isinstance(children, list) else below
            slot.children.append(_Slot(child, where, f"{slot.path}/{name}" if slot.path != _SEVERAL else _SEVERAL))

    def _close(self, slot: _Slot, children: list[Node]) -> Node:
        if isinstance(slot.plain, str):
            return self._from_table("subtrees", slot.plain, slot.where)
        below = ([slot.model] if slot.model is not None else []) + children
        given = self._members(slot.plain, Node, slot.where, without=("children", "model"))
        node = self._make(Node, {**given, "children": tuple(below)}, slot.where)
        extents = [self._extent(child) for child in below]
        extent = _Extent(1 + sum(e.n_nodes for e in extents), 1 + max((e.depth for e in extents), default=-1))
        if extent.depth > MAX_DEPTH:
            raise self.document.error(slot.where, f"the scene graph must not be deeper than {MAX_DEPTH} nodes")
        if extent.n_nodes > self.limits.max_nodes:
            raise self.document.error(slot.where, f"there are more than {self.limits.max_nodes} nodes (max_nodes)")
        self._extents[id(node)] = node, extent
        return node

    def _extent(self, node: Node) -> _Extent:
        if id(node) not in self._extents:
            depths = [placed.depth for placed in node.walk()]
            self._extents[id(node)] = node, _Extent(len(depths), max(depths))
        return self._extents[id(node)][1]

    def _name_of(self, plain: Any) -> str:
        """What a node is called, before it is made."""
        if isinstance(plain, str):
            plain = _called((self.document.top.get("subtrees") or {}).get(plain), plain)
        name = plain.get("name") if isinstance(plain, dict) else None
        return name if isinstance(name, str) else ""

    def _model(self, slot: _Slot) -> Node:
        """What another file holds, its paths those of this scene."""
        where, said = (*slot.where, "model"), slot.plain["model"]
        given = {"file": said} if isinstance(said, str) else said
        try:
            scene = self.models.open(given["file"], given.get("up", "y"), self._position(where))
            part, path = part_of(scene, given.get("node"))
        except FileFormatError:
            raise
        except LimnerError as error:
            raise self.document.error(where, str(error)) from None
        for note in scene.notes:
            self.notes.add(f"{given['file']}: {note}")
        lost = [name for name in ("environment", "background", "fog") if getattr(scene, name) is not None]
        if lost:
            self.notes.add(f"{given['file']}: its {' and '.join(lost)} is left out of what includes it")
        names = names_among_siblings([part.name])
        node, animations = grafted(part, scene.animations, path, f"{slot.path}/{names[0]}")
        if slot.path == _SEVERAL and node is not part:
            raise self.document.error(where, "a model with skins or animations must stand in nodes or root: it names nodes by their paths")
        self._animations += animations
        return node

    # --- what is named ----------------------------------------------------------------------------------------------------

    def _from_table(self, table: str, name: str, where: Where) -> Any:
        key = table, name
        if key in self._named:
            return self._named[key]
        entries = self.document.top.get(table) or {}
        if name not in entries:
            raise self.document.error(where, f"there is nothing named {quoted(name)} in {table}; {did_you_mean(name, entries)}")
        if key in self._chain:
            raise self.document.error(where, f"{quoted(name)} refers to itself")
        if len(self._chain) >= _MAX_CHAIN:
            raise self.document.error(where, f"must not refer through more than {_MAX_CHAIN} names")
        self._chain.append(key)
        plain, place, form = entries[name], (table, name), Form(classes=TABLES[table])
        if table == "subtrees":
            made: Any = self._node(_called(plain, name), place, _SEVERAL)
        else:
            self._check(plain, form, place)
            made = self._value(_with_name(plain, form, name), form, place)
        self._chain.pop()
        self._named[key] = made
        return made

    # --- values -----------------------------------------------------------------------------------------------------------

    def _value(self, plain: Any, form: Form, where: Where) -> Any:
        """What a checked value stands for."""
        if plain is None:
            return None
        if form.place:
            return self._place(plain, where)
        if form.many is not None:
            each = [(one, (*where, k)) for k, one in enumerate(plain)] if isinstance(plain, list) else [(plain, where)]
            return tuple(self._value(one, form.many, place) for one, place in each)
        if form.by_name is not None:
            return {name: self._value(held, form.by_name, (*where, name)) for name, held in plain.items()}
        if form.classes:
            return self._described(plain, form, where)
        if form.array is not None and isinstance(plain, (dict, list)):
            if isinstance(plain, list) and len(plain) == 3 and _is_numbers(plain) and any(get_origin(hint) is tuple for hint in form.plain):
                return tuple(plain)
            return self._array(plain, where)
        return _frozen(plain)

    def _described(self, plain: Any, form: Form, where: Where) -> Any:
        if isinstance(plain, str):
            made = self._from_table(table_of(form.classes), plain, where)
            if not isinstance(made, form.classes):
                known = ", ".join(kind_names(form.classes))
                raise self.document.error(where, f"{quoted(plain)} is a {type(made).__name__}, and one of {known} is needed")
            return made
        if not form.keyed:
            return self._record(plain, form.classes[0], where)
        kinds = kind_names(form.classes)
        return self._record(*self._only(plain, kinds, where))

    def _only(self, plain: dict[str, Any], kinds: Mapping[str, type], where: Where) -> tuple[Any, type, Where]:
        """The one key of a mapping that says what it describes."""
        said = [kind for kind in kinds if kind in plain]
        if len(said) != 1:
            got = f"got {' and '.join(said)}" if said else "got none"
            raise self.document.error(where, f"must have exactly one of {', '.join(kinds)}; {got}")
        held = plain[said[0]]
        return {} if held is None else held, kinds[said[0]], (*where, said[0])

    def _record(self, plain: dict[str, Any], kind: type, where: Where) -> Any:
        maker = {
            Mesh: self._geometry, PointCloud: self._geometry, Texels: self._texels, Environment: self._environment,
            PerspectiveCamera: self._camera,
        }.get(kind)  # fmt: skip
        return maker(plain, kind, where) if maker else self._make(kind, self._members(plain, kind, where), where)

    def _members(self, plain: dict[str, Any], kind: type, where: Where, without: tuple[str, ...] = ()) -> dict[str, Any]:
        given = {}
        for member in members_of(kind):
            if member.flat:
                given[member.attribute] = self._flat(plain, member, where)
            elif member.name in plain and member.name not in without:
                given[member.attribute] = self._value(plain[member.name], member.form, (*where, member.name))
        return given

    def _flat(self, plain: dict[str, Any], member: Member, where: Where) -> Any:
        """A description that stands among the keys of what holds it."""
        kinds = kind_names(member.form.classes)
        named = plain.get(member.attribute)
        if named is None:
            return self._record(*self._only(plain, kinds, where))
        other = [kind for kind in kinds if kind in plain]
        if other:
            raise self.document.error((*where, other[0]), f"there is a {member.attribute} already, {quoted(named)}")
        return self._described(named, member.form, (*where, member.attribute))

    def _make(self, kind: type, given: dict[str, Any], where: Where) -> Any:
        """Let a class make what it describes; what it objects to is said of the place."""
        starred = [member.attribute for member in members_of(kind) if member.starred]
        parts = given.get(starred[0], ()) if starred else ()
        try:
            made = kind(*parts, **{name: value for name, value in given.items() if name not in starred})
        except SceneError as error:
            raise self._objection(error, kind, given, where) from None
        except (TypeError, ValueError, OverflowError) as error:
            raise self.document.error(where, f"makes no {kind.__name__}: {' '.join(str(error).split())}") from None
        _keep_digits(made, given)
        return made

    def _objection(self, error: SceneError, kind: type, given: dict[str, Any], where: Where) -> FileFormatError:
        text = str(error).removesuffix(f" ({error.where})") if error.where else str(error)
        said = re.match(r"[\w ']+[.' ]s?(\w+)(?: of '.*?')? ((?:must|needs|is) .*)", text, re.DOTALL)
        names = {member.attribute: member.name for member in members_of(kind)}
        if said and said[1] in given and said[1] in names:
            flat = any(member.flat and member.attribute == said[1] for member in members_of(kind))
            return self.document.error(where if flat else (*where, names[said[1]]), said[2])
        return self.document.error(where, text)

    # --- what can be said in several ways -----------------------------------------------------------------------------------

    def _array(self, plain: Any, where: Where) -> NDArray[Any]:
        if isinstance(plain, dict) and plain.get("array") is not None:
            return self._kept_array(plain["array"], (*where, "array"))
        try:
            made = outline(plain if isinstance(plain, dict) else {"values": plain})
        except (ValueError, TypeError, OverflowError) as error:
            raise self.document.error(where, f"must be an array of numbers: {' '.join(str(error).split())}") from None
        return made

    def _kept_array(self, name: str, where: Where) -> NDArray[Any]:
        if self._arrays is None:
            raise self.document.error(where, "there is no file of arrays; 'arrays' at the top names it")
        try:
            return self._arrays.get(name)
        except KeyError:
            raise self.document.error(where, f"there is no array {quoted(name)}; {did_you_mean(name, self._arrays.names)}") from None
        except FileFormatError as error:
            raise self.document.error(where, str(error)) from None

    def _place(self, plain: Any, where: Where) -> Any:
        """A (4, 4) matrix."""
        if isinstance(plain, list):
            return np.array(plain, dtype=np.float64) if len(plain) == 4 else plain
        turns = [word for word in ("rotate", "quaternion", "look_at") if plain.get(word) is not None]
        if len(turns) > 1 or ("look_at" in turns and len(plain) > 1):
            raise self.document.error(where, f"the rotation must be said once, got {' and '.join(plain)}")
        if turns == ["look_at"]:
            return self._looking(plain["look_at"], (*where, "look_at"))
        turned: Any = plain.get("quaternion") or (0.0, 0.0, 0.0, 1.0)
        if turns == ["rotate"]:
            said = plain["rotate"]
            if not any(said["axis"]):
                raise self.document.error((*where, "rotate", "axis"), "must not be zero")
            turned = from_axis_angle(said["axis"], math.radians(said["degrees"]))
        size = plain.get("scale")
        size = (1.0, 1.0, 1.0) if size is None else size if isinstance(size, list) else (size,) * 3
        return transform.compose_trs(plain.get("translate") or (0.0, 0.0, 0.0), turned, size)

    def _looking(self, said: dict[str, Any], where: Where) -> Any:
        try:
            return PerspectiveCamera.look_at(said["eye"], said["target"], said.get("up", (0.0, 1.0, 0.0))).world_from_camera
        except SceneError as error:
            raise self.document.error(where, str(error).removeprefix("camera.")) from None

    def _camera(self, plain: dict[str, Any], kind: Any, where: Where) -> Any:
        """A perspective camera; its field of view and its lens in any words."""
        words = {word: plain[word] for word in CAMERA_WORDS if plain.get(word) is not None}
        given = self._members(plain, kind, where)
        looking = (plain.get("place") or {}).get("look_at") if isinstance(plain.get("place"), dict) else None
        if looking is None and not words:
            return self._make(kind, given, where)
        try:
            if looking is not None:
                given.pop("world_from_camera", None)
                return kind.look_at(looking["eye"], looking["target"], looking.get("up", (0.0, 1.0, 0.0)), **given, **words)
            if "xfov_degrees" in words:
                words.setdefault("aspect", given.pop("aspect", None))
                return kind.from_xfov(**given, **words)
            return kind.from_focal_length(**{"focal_length_mm": None, **words}, **given)
        except SceneError as error:
            raise self._objection(error, kind, given, where) from None

    def _environment(self, plain: dict[str, Any], kind: type, where: Where) -> Any:
        given = self._members(plain, kind, where)
        if isinstance(given.get("source"), str):
            found = self.sources.locate(given["source"], self._position((*where, "source")))
            if not found.is_file():
                raise self.document.error((*where, "source"), f"{quoted(given['source'])} is missing")
            given["source"] = str(found)
        return self._make(kind, given, where)

    def _texels(self, plain: dict[str, Any], kind: Any, where: Where) -> Any:
        file = plain.get("file")
        if file is None:
            self._needs(plain, ("pixels",), where)
            return self._make(kind, self._members(plain, kind, where), where)
        if "pixels" in plain:
            raise self.document.error((*where, "pixels"), f"there is a file already, {quoted(file)}")
        position = self._position((*where, "file"))
        self.sources.read_beside(file, position)
        try:
            made = read_texels(self.sources.locate(file, position), srgb=plain.get("srgb", True), limits=self.limits)
        except LimnerError as error:
            raise self.document.error((*where, "file"), str(error)) from None
        return kind(made.pixels, srgb=made.srgb, name=plain.get("name", made.name))

    def _geometry(self, plain: dict[str, Any], kind: type, where: Where) -> Any:
        """A mesh or a point cloud: its arrays, or where another file has them."""
        other = [word for word in ("builtin", "file") if plain.get(word) is not None]
        if other:
            found = self._found_geometry(plain, kind, other, where)
        else:
            self._needs(plain, ("positions", "triangles")[: 2 if kind is Mesh else 1], where)
            found = self._make(kind, self._members(plain, kind, where), where)
        self._n_vertices += len(found.positions)
        self._n_triangles += len(getattr(found, "triangles", ()))
        for n, limit in ((self._n_vertices, "max_vertices"), (self._n_triangles, "max_triangles")):
            if n > getattr(self.limits, limit):
                raise self.document.error(where, f"there are more than {getattr(self.limits, limit)} ({limit})")
        return found

    def _found_geometry(self, plain: dict[str, Any], kind: type, said: list[str], where: Where) -> Any:
        more = [key for key in plain if key not in ("builtin", "file", "node", "number")]
        if len(said) > 1 or more:
            raise self.document.error(where, f"must say {said[0]} and nothing of its own, got {' and '.join([*said[1:], *more])}")
        if said == ["builtin"]:
            return teapot()
        where = (*where, "file")
        try:
            scene = self.models.open(plain["file"], "y", self._position(where))
            found = geometries_of(scene, kind, plain.get("node"))
        except FileFormatError:
            raise
        except LimnerError as error:
            raise self.document.error(where, str(error)) from None
        number = plain.get("number")
        if number is None and len(found) != 1:
            raise self.document.error(where, f"holds {len(found)} of what is asked for; say which by 'node' or by 'number'")
        if not 0 <= (number or 0) < len(found):
            raise self.document.error((*where[:-1], "number"), f"must lie in 0..{len(found) - 1}, got {number}")
        return found[number or 0]

    # --- saying where -------------------------------------------------------------------------------------------------------

    def _needs(self, plain: dict[str, Any], names: tuple[str, ...], where: Where) -> None:
        for name in names:
            if plain.get(name) is None:
                raise self.document.error(where, f"{name} is missing")

    def _check(self, plain: Any, kind: Any, where: Where) -> None:
        try:
            check(plain, kind)
        except MismatchError as error:
            raise self.document.error((*where, *error.where), error.text) from None

    def _position(self, where: Where) -> str:
        return self.document.error(where, "").position


_SEVERAL = "…"
"""In place of the path of what is shared, and stands at several."""


def _hollow(key: str, value: Any) -> Any:
    """What is checked piece by piece, left out of the whole."""
    if key in TABLES and isinstance(value, dict):
        return {}
    if key == "nodes" and isinstance(value, list):
        return []
    return {} if key == "root" and isinstance(value, (dict, str)) else value


def _with_name(plain: Any, form: Form, name: str) -> Any:
    """What a table describes, called by its name there unless it says another."""
    if not form.keyed:
        return _called(plain, name)
    if not isinstance(plain, dict):
        return plain
    kinds = kind_names(form.classes)
    return {
        key: _called(held or {}, name) if any(member.name == "name" for member in members_of(kinds[key])) else held
        for key, held in plain.items()
    }  # fmt: skip


def _called(plain: Any, name: str) -> Any:
    says = not isinstance(plain, dict) or plain.get("file") is not None or plain.get("builtin") is not None
    return plain if says or "name" in plain else {**plain, "name": name}


def _is_numbers(plain: list[Any]) -> bool:
    return all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in plain)


def _frozen(plain: Any) -> Any:
    return tuple(map(_frozen, plain)) if isinstance(plain, list) else plain


def _keep_digits(made: Any, given: dict[str, Any]) -> None:
    """Keep numbers as the file has them where the class changed their last digits alone.

    Classes make normals, axes and weights unit. What was made so once is so again but for rounding, and a scene that is written and read
    must be the same to the bit.
    """
    if isinstance(made, (Node, Scene, Shape, Solid)):
        return
    for name, value in given.items():
        kept = getattr(made, name, None)
        if isinstance(kept, np.ndarray) and isinstance(value, np.ndarray) and kept.dtype.kind == "f" and kept.shape == value.shape:
            same = value.astype(kept.dtype)
            if not np.array_equal(kept, same, equal_nan=True) and np.allclose(kept, same, rtol=1e-6, atol=1e-12, equal_nan=True):
                same.flags.writeable = False
                object.__setattr__(made, name, same)
        elif isinstance(kept, tuple) and isinstance(value, tuple) and kept != value and _all_floats(kept) and _all_floats(value):
            with contextlib.suppress(ValueError):
                if np.allclose(kept, value, rtol=1e-12, atol=0.0):
                    object.__setattr__(made, name, value)


def _all_floats(row: tuple[Any, ...]) -> bool:
    return all(type(value) is float for value in row)
