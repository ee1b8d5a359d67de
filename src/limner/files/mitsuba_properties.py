"""The properties of a Mitsuba plug-in: numbers, flags, vectors, colours, placements; asked for by name, and what nobody asked for is told.

    <sphere …>    properties.number("radius", 1.0)    properties.point("center")    properties.transform("to_world")

Numbers are separated by commas or spaces. A property that is there but cannot be read is an error, with its line.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from ..linear import transform
from .mitsuba_color import color_of
from .mitsuba_xml import PLUGINS, Element
from .notes import quoted
from .sources import Sources

__all__ = ["Properties"]

Matrix = NDArray[np.float64]
Triple = tuple[float, float, float]

_COLORS = ("rgb", "spectrum", "blackbody", "float", "integer")


class Properties:
    """The properties of one element.

    Parameters
    ----------
    element : Element
    sources : Sources
        For errors, and for the files that spectra stand in.
    """

    def __init__(self, element: Element, sources: Sources) -> None:
        self.element = element
        self._sources = sources
        self._by_name = {child.name: child for child in element.children if child.name}
        self._asked: set[str] = set()

    @property
    def what(self) -> str:
        """The element in words: "bsdf diffuse"."""
        return f"{self.element.tag} {self.element.kind}".strip()

    @property
    def where(self) -> str:
        """Its line."""
        return self.element.where

    def of(self, element: Element) -> Properties:
        """Those of another element of the same scene."""
        return Properties(element, self._sources)

    def error(self, message: str, element: Element | None = None) -> FileFormatError:
        """An error at the line of the element, or of one in it."""
        return FileFormatError(message, self._sources.path, (element or self.element).where)

    def has(self, name: str) -> bool:
        """Whether the file says it; to ask is to know it."""
        self._asked.add(name)
        return name in self._by_name

    def child(self, name: str) -> Element | None:
        """The element that says it, whatever its kind."""
        self._asked.add(name)
        return self._by_name.get(name)

    def skip(self, *names: str) -> None:
        """Know properties that make no difference here."""
        self._asked.update(names)

    def unknown(self) -> list[Element]:
        """Properties that nobody asked for."""
        return [child for name, child in self._by_name.items() if name not in self._asked and child.tag not in (*PLUGINS, "ref")]

    # Values

    def number(self, name: str, default: float) -> float:
        """A finite number."""
        element = self.child(name)
        return default if element is None else self._numbers(element, "value", (1,))[0]

    def integer(self, name: str, default: int) -> int:
        """An integer, such as 64."""
        number = self.number(name, default)
        if number != int(number):
            raise self.error(f"{name} must be an integer, got {number:g}", self._by_name[name])
        return int(number)

    def flag(self, name: str, default: bool) -> bool:
        """Either true or false."""
        element = self.child(name)
        if element is None:
            return default
        value = element.attributes.get("value", "").strip().lower()
        if value not in ("true", "false"):
            raise self.error(f'{name} must be "true" or "false", got {quoted(value)}', element)
        return value == "true"

    def text(self, name: str, default: str = "") -> str:
        """A string as it stands."""
        element = self.child(name)
        return default if element is None else element.attributes.get("value", default)

    def point(self, name: str, default: Triple = (0.0, 0.0, 0.0)) -> Triple:
        """A point or a vector: ``value="x, y, z"`` or ``x= y= z=``."""
        element = self.child(name)
        return default if element is None else self._triple(element, 0.0)

    def color(self, name: str, default: float | Triple) -> Triple:
        """A colour in linear Rec. 709, not negative; one number is grey. Textures are not asked for here."""
        element = self.child(name)
        if element is None:
            return (default, default, default) if isinstance(default, (int, float)) else default
        return self.color_in(element)

    def is_color(self, name: str) -> bool:
        """Whether it is a colour rather than a texture."""
        element = self.child(name)
        return element is not None and element.tag in _COLORS

    def color_in(self, element: Element) -> Triple:
        """The colour that an element says."""
        if element.tag not in _COLORS:
            raise self.error(f"{element.name or element.tag} must be a colour, got <{element.tag}>", element)
        try:
            return color_of(element, lambda name: self._sources.read_beside(name, element.where))
        except ValueError as error:
            raise self.error(f"{element.name or element.tag}: {error}", element) from None

    def transform(self, name: str) -> Matrix:
        """A placement, (4, 4) float64, column vectors; the identity where the file says none."""
        element = self.child(name)
        return np.eye(4) if element is None else self._placement(element)

    # Placements

    def _placement(self, element: Element) -> Matrix:
        if element.tag != "transform":
            raise self.error(f"{element.name} must be a <transform>, got <{element.tag}>", element)
        placed = np.eye(4)
        for step in element.children:
            placed = self._step(step) @ placed
        if not np.isfinite(placed).all():
            raise self.error(f"{element.name} is not finite", element)
        return placed

    def _step(self, step: Element) -> Matrix:
        if step.tag == "translate":
            return transform.translate(*self._triple(step, 0.0))
        if step.tag == "scale":
            return transform.scale(*self._triple(step, 1.0))
        if step.tag == "rotate":
            axis = self._triple(Element("rotate", {k: v for k, v in step.attributes.items() if k != "angle"}, step.where), 0.0)
            if not math.hypot(*axis) > 0.0:
                raise self.error("<rotate> needs an axis: x, y or z, or all of them", step)
            return transform.rotate(axis, math.radians(self._numbers(step, "angle", (1,))[0]))
        if step.tag == "matrix":
            numbers = self._numbers(step, "value", (9, 16))
            made = np.eye(4)
            side = 3 if len(numbers) == 9 else 4
            made[:side, :side] = np.reshape(numbers, (side, side))
            if not np.allclose(made[3], (0.0, 0.0, 0.0, 1.0), atol=1e-6):
                raise self.error(f"<matrix> must be affine: its last row must be 0 0 0 1, got {made[3].tolist()}", step)
            made[3] = (0.0, 0.0, 0.0, 1.0)
            return made
        if step.tag == "lookat":
            return self._look_at(step)
        raise self.error(f"a <transform> holds translate, rotate, scale, matrix or lookat, got <{step.tag}>", step)

    def _look_at(self, step: Element) -> Matrix:
        """+z along the gaze, +y upright, and so +x to the left."""
        eye, target = (np.array(self._numbers(step, name, (3,))) for name in ("origin", "target"))
        up = np.array(self._numbers(step, "up", (3,))) if "up" in step.attributes else np.array([0.0, 1.0, 0.0])
        gaze = target - eye
        if not np.linalg.norm(gaze) > 0.0:
            raise self.error("<lookat>: origin and target must differ", step)
        gaze = gaze / np.linalg.norm(gaze)
        if not np.linalg.norm(np.cross(up, gaze)) > 1e-9 * np.linalg.norm(up):
            up = np.eye(3)[int(np.argmin(np.abs(gaze)))]  # as any other: there is no upright where one looks straight up
        left = np.cross(up, gaze)
        left = left / np.linalg.norm(left)
        made = np.eye(4)
        made[:3, 0], made[:3, 1], made[:3, 2], made[:3, 3] = left, np.cross(gaze, left), gaze, eye
        return made

    # Numbers

    def _triple(self, element: Element, default: float) -> Triple:
        if "value" in element.attributes:
            numbers = self._numbers(element, "value", (1, 3))
            x, y, z = numbers * 3 if len(numbers) == 1 else numbers
            return x, y, z
        x, y, z = (self._numbers(element, axis, (1,))[0] if axis in element.attributes else default for axis in "xyz")
        return x, y, z

    def _numbers(self, element: Element, attribute: str, counts: tuple[int, ...]) -> list[float]:
        text = element.attributes.get(attribute, "")
        try:
            numbers = [float(part) for part in text.replace(",", " ").split()]
        except ValueError:
            numbers = []
        if len(numbers) not in counts or not all(math.isfinite(number) for number in numbers):
            expected = " or ".join(f"{count} finite number{'s' if count > 1 else ''}" for count in counts)
            raise self.error(f"{attribute} of <{element.tag}> must be {expected}, got {quoted(text)}", element)
        return numbers
