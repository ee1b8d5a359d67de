"""What a doctor says: what is wrong, where, why it matters, and what to do."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["Diagnosis", "Finding"]


@dataclass(frozen=True)
class Finding:
    """Something that is wrong.

    Attributes
    ----------
    kind : str
        A word for programs: "empty", "behind-camera", "no-power", "inside-out", …
    what : str
        What was found.
    where : str
        Path of the node, name of the material, or "camera"; empty where it is all of the scene.
    why : str
        What it does to the picture.
    do : str
        What helps: a line of Python, or an option of the command line.
    """

    kind: str
    what: str
    where: str
    why: str
    do: str

    def text(self) -> str:
        """Three lines."""
        place = f" ({self.where})" if self.where else ""
        return f"{self.what}{place}\n    why: {self.why}\n    do:  {self.do}"


@dataclass(frozen=True)
class Diagnosis:
    """All that is wrong with a scene, the most likely cause first.

    Attributes
    ----------
    findings : tuple of Finding
    """

    findings: tuple[Finding, ...]

    @property
    def is_sound(self) -> bool:
        """Whether nothing was found."""
        return not self.findings

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of what was found, each once."""
        return tuple(dict.fromkeys(finding.kind for finding in self.findings))

    def text(self) -> str:
        """For people."""
        return "\n".join(finding.text() for finding in self.findings) if self.findings else "nothing is wrong"

    def as_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold."""
        return {"is_sound": self.is_sound, "findings": [asdict(finding) for finding in self.findings]}

    def json(self) -> str:
        """The same as JSON."""
        return json.dumps(self.as_dict(), ensure_ascii=False)

    def __str__(self) -> str:
        return self.text()
