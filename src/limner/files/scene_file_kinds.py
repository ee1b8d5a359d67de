"""What a scene file can hold, taken from the descriptions themselves: their fields, what those may be, and what they are by default.

There is no second list. A class of `limner.scene` is a mapping of its fields; where several classes may stand, the mapping has one key,
the class, with the fields below:

    material: {lambert: {color: [0.8, 0.2, 0.1]}}          Shape(..., materials=(Lambert((0.8, 0.2, 0.1)),))

Three rules make files shorter than that. A word that all classes of a family end with is left out (`point` for `PointLight`). The
geometry of a shape, and of a part of a solid, stands among the shape's own keys. A matrix named target_from_source is called `place`.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import re
import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Union, get_args, get_origin

import numpy as np

from ..scene import distance
from ..scene.material import Material
from ..scene.node import Node
from ..scene.shape import Combination, Geometry, Shape
from ..scene.solid import Solid
from ..scene.texture import AnyTexture, Texels

__all__ = ["ABSENT", "DISTANCES", "TABLES", "Form", "Member", "form_of", "kind_names", "members_of", "snake", "table_of"]

ABSENT: Any = inspect.Parameter.empty
"""In place of a default where there is none."""

DISTANCES: tuple[type, ...] = tuple(
    kind for name in distance.__all__
    if issubclass(kind := getattr(distance, name), distance.Distance) and kind is not distance.Distance
)  # fmt: skip
"""All fields of distances."""

TABLES: dict[str, tuple[type, ...]] = {
    "materials": get_args(Material),
    "textures": get_args(AnyTexture),
    "texels": (Texels,),
    "geometries": get_args(Geometry),
    "subtrees": (Node,),
}
"""What may be named once at the top of a file and referred to by its name, so that what is shared stays shared."""

_FLAT = {(Shape, "geometry"), (Solid, "geometry")}
_PLAIN_SOLIDS = tuple(kind for kind in get_args(Geometry) if kind.__module__.endswith(".primitive"))
_HINTS: dict[tuple[type, str], Any] = {(Solid, "geometry"): Union[(*_PLAIN_SOLIDS, *get_args(Combination))]}  # said as Any


@dataclass(frozen=True)
class Form:
    """What may stand in a place.

    Parameters
    ----------
    optional : bool
        Nothing.
    plain : tuple of type hints
        Text, numbers, flags, words, rows of them.
    array : tuple of dtypes, or None
        An array of one of these dtypes; (): of any.
    classes : tuple of classes
        A description of one of these.
    many : Form, optional
        Any number of what this says.
    by_name : Form, optional
        A mapping from any names to what this says.
    place : bool
        A (4, 4) matrix, or what makes one.
    """

    optional: bool = False
    plain: tuple[Any, ...] = ()
    array: tuple[np.dtype[Any], ...] | None = None
    classes: tuple[type, ...] = ()
    many: Form | None = None
    by_name: Form | None = None
    place: bool = False

    @property
    def keyed(self) -> bool:
        """Whether a mapping says by a key which class it describes."""
        return len(self.classes) > 1 or len(TABLES.get(table_of(self.classes), ())) > 1


@dataclass(frozen=True)
class Member:
    """A field of a description: its name in files and in Python, what it may be, its default, and how it is given to the class."""

    name: str
    attribute: str
    form: Form
    default: Any = ABSENT
    flat: bool = False
    starred: bool = False


def members_of(kind: Any) -> tuple[Member, ...]:
    """The fields that a class is made with, in their order."""
    return _members_of(kind)


@functools.cache
def _members_of(kind: Any) -> tuple[Member, ...]:
    made_with: Any = vars(kind).get("__init__") or inspect.getattr_static(kind, "__init__")
    hints = {**typing.get_type_hints(made_with), **typing.get_type_hints(kind)}
    factories = {field.name: field.default_factory for field in dataclasses.fields(kind)}
    members = []
    for name, parameter in list(inspect.signature(made_with).parameters.items())[1:]:
        form = form_of(_HINTS.get((kind, name), hints[name]))
        placed = "_from_" in name and form.array == (np.dtype(np.float64),) and not form.optional
        form = dataclasses.replace(form, array=None, place=True) if placed else form
        factory = factories.get(name, dataclasses.MISSING)
        default = parameter.default if factory is dataclasses.MISSING else factory()
        starred = parameter.kind is parameter.VAR_POSITIONAL
        members.append(Member("place" if placed else name, name, form, default, (kind, name) in _FLAT, starred))
    return tuple(members)


def form_of(hint: Any) -> Form:
    """Read a type hint."""
    optional, plain, arrays = False, list[Any](), list[np.dtype[Any]]()
    classes: list[Any] = []
    array: tuple[np.dtype[Any], ...] | None = None
    many = by_name = None
    for member in get_args(hint) if get_origin(hint) in (Union, types.UnionType) else (hint,):
        origin, arguments = get_origin(member), get_args(member)
        if member is type(None):
            optional = True
        elif member is distance.Distance:
            classes += DISTANCES
        elif dataclasses.is_dataclass(member):
            classes.append(member)
        elif origin is np.ndarray:
            arrays += [np.dtype(kind) for kind in get_args(arguments[1]) if kind is not Any]
            array = tuple(arrays)
        elif origin is Mapping:
            by_name = form_of(arguments[1])
        elif origin is tuple and form_of(arguments[0]).classes:
            many = form_of(arguments[0])
        else:
            plain.append(member)
    return Form(optional, tuple(plain), array, tuple(classes), many, by_name)


@functools.cache
def table_of(classes: tuple[type, ...]) -> str:
    """The table in which descriptions of these classes may be named; empty where none may."""
    return next((name for name, family in TABLES.items() if classes and set(classes) <= set(family)), "")


@functools.cache
def kind_names(classes: tuple[type, ...]) -> Mapping[str, type]:
    """What classes are called where a key tells them apart.

    >>> from ..scene.camera import OrthographicCamera, PerspectiveCamera
    >>> list(kind_names((PerspectiveCamera, OrthographicCamera)))
    ['perspective', 'orthographic']
    """
    words = [re.findall(r"[A-Z][a-z0-9]*", kind.__name__) for kind in classes]
    shared = len(classes) > 1 and min(map(len, words)) > 1 and len({each[-1] for each in words}) == 1
    names = ("_".join(each[:-1] if shared else each).lower() for each in words)
    return types.MappingProxyType(dict(zip(names, classes, strict=True)))


def snake(kind: type) -> str:
    """The name of a class as files have names.

    >>> snake(Texels), snake(Solid)
    ('texels', 'solid')
    """
    return "_".join(re.findall(r"[A-Z][a-z0-9]*", kind.__name__)).lower()
