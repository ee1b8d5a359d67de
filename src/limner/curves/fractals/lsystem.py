"""L-systems: words that grow by rules, read by a turtle that draws (FoCG 15.1: generative curves).

    F  a step with the pen down      f  a step with the pen up      |  turn round
    +  turn left      -  turn right      [  remember where it stands      ]  go back there      other letters only grow

All letters are replaced at once, again and again: "F" by "F+F--F+F" is Koch's curve.

**Source**: Lindenmayer, "Mathematical models for cellular interactions in development", 1968; Prusinkiewicz and Lindenmayer, *The
Algorithmic Beauty of Plants*, 1990, 1.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..control import degree_of

__all__ = ["NAMED", "LSystem", "turtle_lines"]

Floats = NDArray[np.float64]

_MOST_LETTERS = 1 << 24


@dataclass(frozen=True)
class LSystem:
    """A word and how it grows.

    Parameters
    ----------
    axiom : str
        The word at first.
    rules : mapping of one letter to a word
        Letters without a rule stay.
    angle_degrees : float
        Of a turn.
    start_degrees : float
        Where the turtle looks at first; 0 is +x.
    drawing : str
        Letters that are steps with the pen down.

    Examples
    --------
    >>> LSystem("F", {"F": "F+F"}, 90.0).grown(2)
    'F+F+F+F'
    """

    axiom: str
    rules: Mapping[str, str]
    angle_degrees: float
    start_degrees: float = 0.0
    drawing: str = "F"

    def __post_init__(self) -> None:
        if not self.axiom:
            raise SceneError("an L-system needs an axiom, got an empty word")
        for letter in self.rules:
            if len(letter) != 1:
                raise SceneError(f"an L-system's rule replaces one letter, got {letter!r}")
        if not (math.isfinite(self.angle_degrees) and math.isfinite(self.start_degrees)):
            raise SceneError(f"an L-system's angles must be finite, got {self.angle_degrees} and {self.start_degrees}")

    def length(self, times: int) -> int:
        """Count the letters after so many replacements, without making them."""
        counts = {letter: self.axiom.count(letter) for letter in set(self.axiom)}
        for _ in range(degree_of(times)):
            grown: dict[str, int] = {}
            for letter, count in counts.items():
                for new in self.rules.get(letter, letter):
                    grown[new] = grown.get(new, 0) + count
            counts = grown
        return sum(counts.values())

    def grown(self, times: int) -> str:
        """Replace all letters so many times."""
        if self.length(times) > _MOST_LETTERS:
            raise SceneError(f"the word would have {self.length(times):,} letters after {times} times; the most is {_MOST_LETTERS:,}")
        word = self.axiom
        for _ in range(times):
            word = "".join(self.rules.get(letter, letter) for letter in word)
        return word

    def lines(self, times: int) -> list[Floats]:
        """Grow, and let a turtle draw with steps of length 1; see `turtle_lines`."""
        return turtle_lines(self.grown(times), self.angle_degrees, self.start_degrees, self.drawing)


def turtle_lines(word: str, angle_degrees: float, start_degrees: float = 0.0, drawing: str = "F") -> list[Floats]:
    """Read a word as a turtle's way from the origin, in steps of length 1.

    Parameters
    ----------
    word : str
    angle_degrees, start_degrees : float
    drawing : str
        Letters that are steps with the pen down.

    Returns
    -------
    list of (k, 2) float64, k >= 2
        A line for each time the pen is down.

    Examples
    --------
    >>> [line.round(9).tolist() for line in turtle_lines("F+F", 90.0)]
    [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]]
    """
    place, turns = 0j, 0
    half_turns = 0
    lines: list[list[complex]] = [[place]]
    kept: list[tuple[complex, int, int]] = []
    headings: dict[tuple[int, int], complex] = {}
    for letter in word:
        if letter in drawing or letter == "f":
            way = headings.get((turns, half_turns))
            if way is None:
                degrees = (start_degrees + turns * angle_degrees + 180.0 * half_turns) % 360.0
                way = headings[turns, half_turns] = complex(math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))
            place += way
            if letter == "f":
                lines.append([place])
            else:
                lines[-1].append(place)
        elif letter == "+":
            turns += 1
        elif letter == "-":
            turns -= 1
        elif letter == "|":
            half_turns = 1 - half_turns
        elif letter == "[":
            kept.append((place, turns, half_turns))
        elif letter == "]":
            if not kept:
                raise SceneError("an L-system's word has a ] without a [ before it")
            place, turns, half_turns = kept.pop()
            lines.append([place])
    if kept:
        raise SceneError(f"an L-system's word has {len(kept)} [ without a ]")
    return [np.array(line).view(np.float64).reshape(-1, 2) for line in lines if len(line) > 1]


NAMED: dict[str, LSystem] = {
    "koch": LSystem("F", {"F": "F+F--F+F"}, 60.0),
    "snowflake": LSystem("F--F--F", {"F": "F+F--F+F"}, 60.0, 60.0),
    "dragon": LSystem("FX", {"X": "X+YF+", "Y": "-FX-Y"}, 90.0),
    "hilbert": LSystem("X", {"X": "+YF-XFX-FY+", "Y": "-XF+YFY+FX-"}, 90.0),
    "gosper": LSystem("A", {"A": "A-B--B+A++AA+B-", "B": "+A-BB--B-A++A+B"}, 60.0, drawing="AB"),
    "sierpinski": LSystem("A", {"A": "B-A-B", "B": "A+B+A"}, 60.0, drawing="AB"),
    "plant": LSystem("X", {"X": "F+[[X]-X]-F[-FX]+X", "F": "FF"}, 25.0, 65.0),
    "levy": LSystem("F", {"F": "+F--F+"}, 45.0),
}
"""Well-known ones, by name."""
