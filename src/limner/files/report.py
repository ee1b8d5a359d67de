"""What became of a file: what was read, and what of it the scene holds only nearly, or not at all.

    report = limner.load_report("scene.xml")
    print(report)                                        # a line for each thing
    image = limner.render(report.scene, **report.settings)

A scene that was made for another renderer never arrives whole. Whoever compares pictures, or hands a model on, needs to know what was
lost on the way, and needs it in a form that programs read as well: each entry has a kind, a place in the file, and what it is about.

    read           it is in the scene as the file has it
    approximated   it is in the scene, but looks a little different
    ignored        it is not in the scene
    replaced       something else stands in its place
    repaired       the file was wrong about it, and what it must have meant was taken
"""

from __future__ import annotations

import json
import math
import os
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, get_args

from ..mesh.mesh import Mesh
from ..scene.scene import Scene
from .limits import DEFAULT, Limits
from .load import read_model
from .notes import Kind, Notes

__all__ = ["KINDS", "LoadEntry", "LoadReport", "load_report", "report_of"]

KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True)
class LoadEntry:
    """One thing that is to be said about a file.

    Parameters
    ----------
    kind : "read" | "approximated" | "ignored" | "replaced" | "repaired"
    text : str
        The remark, one line.
    where : str
        The first place in the file that it is said of: a line ("line 12"), a JSON pointer ("/meshes/0"); empty: the whole file.
    what : str
        What it is about, in the file's own words ("bsdf roughplastic"), where the reader tells.
    n_places : int
        Of how many places it is said.
    """

    kind: Kind
    text: str
    where: str = ""
    what: str = ""
    n_places: int = 1

    def __str__(self) -> str:
        more = f" and {self.n_places - 1} more" if self.n_places > 1 else ""
        return f"{self.kind:<12}  {self.where}{more}: {self.text}" if self.where else f"{self.kind:<12}  {self.text}"


@dataclass(frozen=True, eq=False)
class LoadReport:
    """What became of a file.

    Parameters
    ----------
    path : str
    format : str
        Which reader read it: "gltf", "obj", "mitsuba", …
    entries : tuple of LoadEntry
        What was read comes first; the rest stands in the order in which the reader met it.
    scene : Scene
    settings : mapping
        What the file says about how its picture is to be made, as arguments of `limner.render`; empty where it does not.
    n_more : int
        Further remarks that were too many to be kept.
    """

    path: str
    format: str
    entries: tuple[LoadEntry, ...]
    scene: Scene = field(repr=False)
    settings: Mapping[str, Any] = field(default_factory=dict)
    n_more: int = 0

    @property
    def is_exact(self) -> bool:
        """Whether all that the file holds is in the scene as the file has it."""
        return not self.n_more and all(entry.kind == "read" for entry in self.entries)

    def of(self, kind: Kind) -> tuple[LoadEntry, ...]:
        """The entries of one kind."""
        return tuple(entry for entry in self.entries if entry.kind == kind)

    def counts(self) -> dict[str, int]:
        """How many entries there are of each kind."""
        found = Counter(entry.kind for entry in self.entries)
        return {kind: found[kind] for kind in KINDS}

    def as_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold; the scene is left out."""
        entries = [
            {"kind": entry.kind, "where": entry.where, "what": entry.what, "text": entry.text, "places": entry.n_places}
            for entry in self.entries
        ]
        return {
            "path": self.path, "format": self.format, "exact": self.is_exact, "counts": self.counts(), "entries": entries,
            "more": self.n_more, "settings": dict(self.settings),
        }  # fmt: skip

    def to_json(self) -> str:
        """The report as one line of JSON."""
        return json.dumps(self.as_dict(), sort_keys=True, ensure_ascii=False)

    def lines(self) -> tuple[str, ...]:
        """A line for each entry, and for the settings."""
        told = [str(entry) for entry in self.entries]
        if self.n_more:
            told.append(f"and {self.n_more} more such remarks")
        if self.settings:
            told.append(f"{'settings':<12}  " + ", ".join(f"{name}={value!r}" for name, value in self.settings.items()))
        return tuple(told)

    def __str__(self) -> str:
        return "\n".join((f"{self.path} ({self.format})", *("  " + line for line in self.lines())))


def load_report(
    path: str | os.PathLike[str], *, up: str = "y", scene: str | int | None = None, limits: Limits = DEFAULT
) -> LoadReport:
    """Read a model and tell what became of it.

    Parameters
    ----------
    path, up, scene, limits
        As for `limner.load`, which gives the same scene. Nothing is warned about: all of it is in the report.

    Raises
    ------
    FileFormatError, UnsupportedError
        As `limner.load` does.
    """
    shown, notes, kind = read_model(path, up=up, scene=scene, limits=limits)
    return report_of(shown, notes, os.fspath(path), kind)


def report_of(scene: Scene, notes: Notes, path: str = "", kind: str = "") -> LoadReport:
    """Make the report of a scene from what its reader said."""
    said = tuple(LoadEntry(*remark) for remark in notes.remarks())
    return LoadReport(path, kind, (*_read(scene), *said), scene, dict(notes.settings), notes.n_dropped)


def _read(scene: Scene) -> Iterable[LoadEntry]:
    """What there is in the scene, counted: what nobody remarked upon was read as it stands."""
    shapes = scene.shapes()
    meshes = {id(shape.geometry): shape.geometry for _, shape in shapes if isinstance(shape.geometry, Mesh)}
    n_triangles = sum(len(mesh.triangles) for mesh in meshes.values())
    triangles = f", {n_triangles} triangles" if meshes else ""
    yield LoadEntry("read", f"shapes: {_kinds(shape.geometry for _, shape in shapes)}{triangles}", what="shapes")
    materials = {id(material): material for _, shape in shapes for material in shape.materials}
    lights, cameras = [light for _, light in scene.lights()], scene.cameras()
    own = () if scene.camera is None or any(camera.name == scene.camera.name for camera in cameras) else (scene.camera,)
    for what, found in (("materials", materials.values()), ("lights", lights), ("cameras", (*own, *cameras))):
        held = tuple(found)
        if held:
            yield LoadEntry("read", f"{what}: {_kinds(held)}", what=what)
    if scene.environment is not None:
        yield LoadEntry("read", f"environment: {scene.environment!r}", what="environment")
    if scene.animations:
        yield LoadEntry("read", f"animations: {len(scene.animations)}", what="animations")
    bounds = scene.bounds()
    if all(math.isfinite(number) for number in bounds.ravel().tolist()):
        size = " x ".join(f"{length:.4g}" for length in (bounds[1] - bounds[0]).tolist())
        yield LoadEntry("read", f"bounds: {size} m", what="bounds")


def _kinds(held: Iterable[Any]) -> str:
    counts = Counter(type(one).__name__ for one in held)
    return ", ".join(f"{count} {name}" for name, count in counts.items()) or "none"
