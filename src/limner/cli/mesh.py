"""`limner mesh`: what kind of surface a model's meshes are, and making them sound. Reading a command line imports no NumPy."""

from __future__ import annotations

import importlib
import importlib.util
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from .model import model_up, open_model
from .options import as_json
from .talk import Talk, flattened
from .voice import voice

if TYPE_CHECKING:
    from ..mesh.mesh import Mesh
    from ..scene.scene import Scene

__all__ = ["mesh"]

_UNSOUND = 1
_ELSEWHERE = {"unwrap": "mesh_unwrap"}
"""Commands that stand in files of their own."""


class _Group(click.Group):
    """Imports commands that stand elsewhere when they are asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        there = [name for name, module in _ELSEWHERE.items() if importlib.util.find_spec(f".{module}", __package__)]
        return sorted({*super().list_commands(ctx), *there})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name in _ELSEWHERE and cmd_name in self.list_commands(ctx):
            command: click.Command = getattr(importlib.import_module(f".{_ELSEWHERE[cmd_name]}", __package__), cmd_name)
            return command
        return super().get_command(ctx, cmd_name)


@click.group(cls=_Group, short_help="Check, measure, repair and convert the meshes of a model.")
def mesh() -> None:
    """Check, measure, repair and convert the meshes of a model.

    Positions are metres. Meshes are told of by the path of the node that shows them.
    """


@mesh.command(short_help="Tell whether the meshes of a model are sound.")
@click.argument("model")
@click.option(
    "--weld", type=click.FloatRange(0.0), metavar="D",
    help="Take vertices at most D metres apart for one; 0: those in one place, as texture seams split them.",
)  # fmt: skip
@click.option("--closed", is_flag=True, help="Ask for closed surfaces, too.")
@as_json()
@model_up
@voice
@click.pass_obj
def check(talk: Talk, model: str, weld: float | None, closed: bool, as_json: bool) -> None:
    """Tell whether the meshes of MODEL are sound: manifolds, perhaps with boundary, consistently oriented, without triangles that are
    degenerate or there twice, and without T-junctions. The code is 0 where all are, 1 where one is not.

    \b
        limner mesh check part.stl --weld 0
        limner mesh check model.glb --weld 1e-6 --closed --json
    """
    from ..mesh.examine.report import topology_report
    from ..mesh.mesh import Mesh
    from ..mesh.repair.repair import repair

    def bare(given: Mesh) -> Mesh:
        # Colours and attributes would keep vertices apart that are to be taken for one.
        alone = Mesh(given.positions, given.triangles, name=given.name)
        if weld is None:
            return alone
        only_weld = {"degenerate": False, "duplicates": False, "junctions": False, "orient": False, "unused": False}
        return repair(alone, weld=weld, **only_weld)[0]

    scene, found = _meshes(model)
    reports = {path: topology_report(bare(given)) for path, given in found.items()}
    bad = [path for path, report in reports.items() if not report.is_sound or (closed and not report.is_closed)]
    if as_json:
        _tell_json({"model": model, "is_sound": not bad, "meshes": {path: report.as_dict() for path, report in reports.items()}})
    elif not talk.quiet:
        for path, report in reports.items():
            _tell(path, str(report).splitlines())
        if weld is None and any(report.duplicate_vertices for report in reports.values()):
            talk.say("note", "some vertices stand where others stand; --weld 0 takes them for one")
    talk.note(scene.notes)
    if bad:
        what = "sound and closed" if closed else "sound"
        talk.say("note", f"{len(bad)} of {len(reports)} not {what}: {', '.join(bad[:5])}{', …' if len(bad) > 5 else ''}")
        talk.code = _UNSOUND


@mesh.command(short_help="Measure the meshes of a model.")
@click.argument("model")
@as_json()
@model_up
@voice
@click.pass_obj
def info(talk: Talk, model: str, as_json: bool) -> None:
    """Measure the meshes of MODEL, each in its own space: counts, bounds, area, volume, centre, edges, what lives on them."""
    from ..mesh.examine.measure import summary

    scene, found = _meshes(model)
    told = {path: summary(given) for path, given in found.items()}
    if as_json:
        _tell_json({"model": model, "meshes": told})
    else:
        for path, facts in told.items():
            _tell(path, [path, *(f"  {name.replace('_', ' '):<21} {_shown(value)}" for name, value in facts.items())])
    talk.note(scene.notes)


@mesh.command(short_help="Make the meshes of a model sound.")
@click.argument("model")
@click.option("-o", "--output", required=True, metavar="OUT", help="The model to write; its extension says the format.")
@click.option(
    "--weld", type=click.FloatRange(0.0), default=0.0, show_default=True, metavar="D", help="Weld vertices at most D metres apart.",
)  # fmt: skip
@click.option("--no-weld", is_flag=True, help="Weld no vertices.")
@click.option("--fill-holes", is_flag=True, help="Close all holes.")
@click.option("--max-hole", type=click.IntRange(3), metavar="N", help="Close holes of at most N edges.")
@click.option("--split", is_flag=True, help="Cut surfaces apart where they are no manifold.")
@click.option("--no-orient", is_flag=True, help="Turn no triangles over.")
@as_json("Tell what was done as JSON on standard output.")
@model_up
@voice
@click.pass_obj
def repair(talk: Talk, /, **options: Any) -> None:
    """Make the meshes of MODEL sound: weld vertices, drop triangles that are degenerate or there twice, split edges at T-junctions, turn
    triangles so that neighbours agree and closed surfaces face outwards, drop unused vertices.

    \b
        limner mesh repair scan.ply -o scan.obj --fill-holes
        limner mesh repair part.stl -o part.ply --weld 1e-5 --max-hole 12
    """
    order = Order(**options)
    if order.no_weld and click.get_current_context().get_parameter_source("weld") is click.core.ParameterSource.COMMANDLINE:
        raise click.UsageError("--weld and --no-weld exclude each other")
    _repair(order, talk)


@mesh.command(short_help="Write a model in another format.")
@click.argument("model")
@click.option("-o", "--output", required=True, metavar="OUT", help="The model to write; its extension says the format.")
@model_up
@voice
@click.pass_obj
def convert(talk: Talk, model: str, output: str) -> None:
    """Write the meshes of MODEL to OUT, whose extension says the format.

    \b
        limner mesh convert model.glb -o model.obj
    """
    scene = open_model(model)
    _save(scene, output)
    talk.note(scene.notes)


@dataclass(frozen=True)
class Order:
    """What `limner mesh repair` asks for."""

    model: str
    output: str
    weld: float
    no_weld: bool
    fill_holes: bool
    max_hole: int | None
    split: bool
    no_orient: bool
    as_json: bool


def _repair(order: Order, talk: Talk) -> None:
    from ..mesh.repair.repair import RepairReport
    from ..mesh.repair.repair import repair as repaired
    from ..scene.meshes import with_meshes

    scene, found = _meshes(order.model)
    path_of = {id(given): path for path, given in found.items()}
    reports: dict[str, RepairReport] = {}
    fill = order.max_hole if order.max_hole is not None else order.fill_holes

    def change(given: Mesh) -> Mesh:
        weld = None if order.no_weld else order.weld
        made, report = repaired(given, weld=weld, split=order.split, orient=not order.no_orient, fill_holes=fill)
        reports[path_of[id(given)]] = report
        return made if report.has_changed else given

    _save(with_meshes(scene, change), order.output)
    if order.as_json:
        told = {path: report.as_dict() for path, report in reports.items()}
        _tell_json({"model": order.model, "output": order.output, "meshes": told})
    elif not talk.quiet:
        for path, report in reports.items():
            _tell(path, [f"{path}: {', '.join(str(report).splitlines())}"])
    talk.note(scene.notes)


def _meshes(model: str) -> tuple[Scene, dict[str, Mesh]]:
    """A model, and its meshes by the paths of their nodes."""
    from ..errors import SceneError
    from ..scene.meshes import meshes_of

    scene = open_model(model)
    found = meshes_of(scene)
    if not found:
        raise SceneError(f"{model} has no meshes")
    return scene, found


def _save(scene: Scene, output: str) -> None:
    from ..files.save_mesh import save_model

    save_model(scene, output)


def _tell(path: str, lines: list[str]) -> None:
    """Write about a mesh; the node's path takes the place of the mesh's name."""
    head = lines[0].rpartition(": ")
    first = f"{path}{head[1]}{head[2]}" if head[0] and not head[0].startswith(path) else lines[0]
    for line in [first, *lines[1:]]:
        click.echo(flattened(line) if not line.startswith("  ") else "  " + flattened(line))


def _tell_json(told: dict[str, Any]) -> None:
    import json

    click.echo(json.dumps(told, sort_keys=True, allow_nan=False))


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(_shown(part) for part in value) or "none"
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "-"}[value]
    return f"{value:.6g}" if isinstance(value, float) else str(value)
