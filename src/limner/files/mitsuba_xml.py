"""The XML of Mitsuba scenes as a tree: includes, defaults and $parameters resolved, every element with its line.

XML can do harm: entities that refer to entities fill the memory with a few lines, and external ones read any file. Scenes need neither,
so a document type is refused as soon as it begins; the parser is expat, and what it has built is counted. Includes are files beside
the scene, as everything else is (`limner.files.sources`).

Names are turned to today's spelling on the way ("toWorld" is "to_world"): scenes of Mitsuba 0.5 and 0.6 read like those of 3.

**Source**: the Mitsuba 3 documentation, *Scene XML file format*.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from xml.parsers import expat

from ..errors import FileFormatError
from .notes import Notes, quoted
from .sources import Sources

__all__ = ["PLUGINS", "Element", "read_tree"]

MAX_DEPTH = 64
MAX_INCLUDES, MAX_INCLUDE_DEPTH = 200, 8
MAX_ELEMENTS = 1_000_000
MAX_FILLED = 1 << 24  # characters of all attributes that parameters were filled into: parameters may refer to parameters

PLUGINS = ("bsdf", "emitter", "film", "integrator", "medium", "phase", "rfilter", "sampler", "sensor", "shape", "texture", "volume")
"""Elements that stand for an object with a type and properties."""

_SCENE_LEVEL = ("default", "include", "alias", "path")
_PARAMETER = re.compile(r"\$([A-Za-z_]\w*)")
_OLD_NAMES = {"luminaire": "emitter", "camera": "sensor", "lookAt": "lookat", "srgb": "rgb"}


@dataclass
class Element:
    """One element.

    Parameters
    ----------
    tag : str
    attributes : dict of str
    where : str
        "line 12"; in an included file "lights.xml, line 12".
    children : list of Element
    """

    tag: str
    attributes: dict[str, str]
    where: str
    children: list[Element] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Which property of its parent it is; empty where it does not say."""
        return self.attributes.get("name", "")

    @property
    def kind(self) -> str:
        """The type of a plug-in."""
        return self.attributes.get("type", "")

    @property
    def id(self) -> str:
        """By which name others refer to it."""
        return self.attributes.get("id", "")

    def walk(self) -> Iterator[Element]:
        """This element and all below it, parents first."""
        stack = [self]
        while stack:
            element = stack.pop()
            yield element
            stack.extend(reversed(element.children))


def read_tree(data: bytes, sources: Sources, notes: Notes, parameters: Mapping[str, str] | None = None) -> Element:
    """Parse a scene.

    Parameters
    ----------
    data : bytes
        UTF-8, or what its declaration names.
    sources : Sources
    notes : Notes
    parameters : mapping of str, optional
        Values for $parameters that go before the scene's own defaults.

    Raises FileFormatError, with the line, for what is no well-formed XML, has a document type, or is too large.
    """
    reader = _TreeReader(sources, notes, dict(parameters or {}))
    root = reader.parse(data, "")
    if root.tag != "scene":
        raise FileFormatError(f"must be a Mitsuba scene, whose root is <scene>, got <{root.tag[:60]}>", sources.path, root.where)
    reader.resolve(root, 0)
    return root


class _TreeReader:
    def __init__(self, sources: Sources, notes: Notes, parameters: dict[str, str]) -> None:
        self._sources = sources
        self._notes = notes
        self._values = parameters
        self._n_elements = 0
        self._n_includes = 0
        self._n_filled = 0

    def error(self, message: str, where: str) -> FileFormatError:
        return FileFormatError(message, self._sources.path, where)

    def parse(self, data: bytes, file: str) -> Element:
        """The tree of one file, nothing resolved."""
        parser = expat.ParserCreate()
        document = Element("", {}, "")
        open_elements = [document]

        def line() -> str:
            return f"{file}, line {parser.CurrentLineNumber}" if file else f"line {parser.CurrentLineNumber}"

        def start(tag: str, attributes: dict[str, str]) -> None:
            self._n_elements += 1
            if self._n_elements > MAX_ELEMENTS:
                raise self.error(f"has more than {MAX_ELEMENTS} elements", line())
            if len(open_elements) > MAX_DEPTH:
                raise self.error(f"elements stand deeper in each other than {MAX_DEPTH}", line())
            element = Element(_OLD_NAMES.get(tag, tag), attributes, line())
            open_elements[-1].children.append(element)
            open_elements.append(element)

        def end(_tag: str) -> None:
            open_elements.pop()

        def refuse(*_: object) -> int:
            raise self.error("document types and entities are not read: a scene needs none", line())

        parser.StartElementHandler, parser.EndElementHandler = start, end
        parser.StartDoctypeDeclHandler, parser.EntityDeclHandler, parser.ExternalEntityRefHandler = refuse, refuse, refuse
        try:
            parser.Parse(data, True)
        except expat.ExpatError as error:
            where = f"{file}, line {error.lineno}" if file else f"line {error.lineno}"
            raise self.error(f"is no well-formed XML: {expat.errors.messages[error.code]}", where) from None
        except (LookupError, ValueError) as error:
            raise self.error(f"is in an encoding that is not read: {quoted(str(error))}", file) from None
        return document.children[0]

    def resolve(self, element: Element, depth: int) -> None:
        """Fill in parameters, put included files in, and spell names as today; in the order of the file, as defaults need it."""
        element.attributes = {key: self._filled(value, element.where) for key, value in element.attributes.items()}
        if "name" in element.attributes and element.tag != "default":
            element.attributes["name"] = _snake_case(element.attributes["name"])
        children: list[Element] = []
        for child in element.children:
            if child.tag not in _SCENE_LEVEL:
                self.resolve(child, depth)
                children.append(child)
                continue
            child.attributes = {key: self._filled(value, child.where) for key, value in child.attributes.items()}
            if child.tag == "default":
                self._values.setdefault(self._said(child, "name"), self._said(child, "value"))
            elif child.tag == "include":
                children.extend(self._included(child, depth))
            elif child.tag == "path":
                self._notes.add("search paths are ignored: files are looked up beside the scene", child.where, kind="ignored", what="path")
            else:
                children.append(child)
        element.children = children

    def _included(self, element: Element, depth: int) -> list[Element]:
        name = self._said(element, "filename")
        self._n_includes += 1
        if depth >= MAX_INCLUDE_DEPTH or self._n_includes > MAX_INCLUDES:
            raise self.error(f"includes too many files, or itself, by {quoted(name)}", element.where)
        root = self.parse(self._sources.read_beside(name, element.where), name)
        self.resolve(root, depth + 1)
        return root.children if root.tag == "scene" else [root]

    def _said(self, element: Element, attribute: str) -> str:
        value = element.attributes.get(attribute)
        if value is None:
            raise self.error(f"<{element.tag}> needs {attribute}=", element.where)
        return value

    def _filled(self, value: str, where: str) -> str:
        if "$" not in value:
            return value
        pieces: list[str] = []
        for piece in self._pieces(value, where):
            self._n_filled += len(piece)
            if self._n_filled > MAX_FILLED:
                raise self.error(f"parameters fill in more than {MAX_FILLED} characters", where)
            pieces.append(piece)
        return "".join(pieces)

    def _pieces(self, value: str, where: str) -> Iterator[str]:
        """The text between parameters, and their values."""
        end = 0
        for match in _PARAMETER.finditer(value):
            yield value[end : match.start()]
            if match[1] not in self._values:
                raise self.error(f"the parameter ${match[1]} has no value: the scene has no <default> for it", where)
            yield self._values[match[1]]
            end = match.end()
        yield value[end:]


def _snake_case(name: str) -> str:
    """"intIOR" as "int_ior", "toWorld" as "to_world"."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
