"""`limner info`: what is in a model, and what is wrong with it."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import click

from .model import model_up, open_model, report_of_model
from .options import as_json, report
from .talk import Talk, flattened
from .voice import voice

if TYPE_CHECKING:
    from ..mesh.mesh import Mesh
    from ..scene.scene import Scene
    from ..scene.texture import Texels

__all__ = ["describe", "info"]

_SHOWN = 20  # of a long list


@click.command(short_help="Tell what is in a model, and what is wrong with it.")
@click.argument("model")
@report
@as_json()
@model_up
@voice
@click.pass_obj
def info(talk: Talk, model: str, report: bool, as_json: bool) -> None:
    """Tell what is in MODEL, and what is wrong with it."""

    _tell(model, as_json, talk, report)


def _tell(model: str, as_json: bool, talk: Talk, report: bool = False) -> None:
    """Write about `model` on standard output; with `report`, what became of each part of its file, too."""
    told_of_file = report_of_model(model) if report else None
    told = describe(open_model(model) if told_of_file is None else told_of_file.scene)
    if told_of_file is not None:
        told["report"] = told_of_file.as_dict()
    if as_json:
        import json

        click.echo(json.dumps({"model": model, **told}, sort_keys=True))
        return
    click.echo(flattened(model))
    for line in _lines(told):
        click.echo("  " + flattened(line))
    if told_of_file is None:
        talk.note(told["notes"])
    else:
        click.echo(f"report ({flattened(told_of_file.format)})")
        for line in told_of_file.lines():
            click.echo("  " + flattened(line))
    talk.warn(told["warnings"])


def describe(scene: Scene) -> dict[str, Any]:
    """Count what there is to see, and look for likely slips; plain values that JSON can hold."""
    from ..mesh.mesh import Mesh
    from ..scene.variants import variant_names

    placed = list(scene.root.walk())
    shown = scene.shapes()
    meshes = {id(shape.geometry): shape.geometry for _, shape in shown if isinstance(shape.geometry, Mesh)}
    materials = {id(material): material for _, shape in shown for material in shape.materials}
    bounds = scene.bounds().tolist()
    return {
        "nodes": len(placed),
        "hidden_nodes": len(placed) - len(list(scene.walk())),
        "shapes": len(shown),
        "shapes_by_kind": _counted(type(shape.geometry).__name__ for _, shape in shown),
        "meshes": len(meshes),
        "triangles": sum(len(mesh.triangles) for mesh in meshes.values()),
        "drawn_triangles": sum(len(shape.geometry.triangles) for _, shape in shown if isinstance(shape.geometry, Mesh)),
        "materials": _counted(type(material).__name__ for material in materials.values()),
        "textures": [
            {"name": texels.name, "width": texels.pixels.shape[1], "height": texels.pixels.shape[0]}
            for texels in _texels(list(materials.values()))
        ],
        "lights": [{"kind": type(light).__name__, "name": light.name, "node": place.path} for place, light in scene.lights()],
        "camera": None if scene.camera is None else type(scene.camera).__name__,
        "cameras": [{"kind": type(camera).__name__, "name": camera.name} for camera in scene.cameras()],
        "variants": list(variant_names(scene)),
        "animations": [
            {"name": held.name, "start": held.start, "end": held.end, "channels": len(held.channels)} for held in scene.animations
        ],
        "bounds": bounds if all(math.isfinite(number) for corner in bounds for number in corner) else None,
        "notes": list(scene.notes),
        "warnings": _slips(scene, list(meshes.values())),
    }


def _counted(names: Any) -> dict[str, int]:
    counts: dict[str, int] = {}
    for name in names:
        counts[name] = counts.get(name, 0) + 1
    return counts


def _texels(materials: list[Any]) -> list[Texels]:
    """The pictures that materials look into, each once."""
    from ..scene.texture import Texture

    found: dict[int, Texels] = {}
    for material in materials:
        for field in fields(material):
            value = getattr(material, field.name)
            if isinstance(value, Texture):
                found[id(value.texels)] = value.texels
    return list(found.values())


def _slips(scene: Scene, meshes: list[Mesh]) -> list[str]:
    found = []
    if not scene.shapes():
        found.append("there is nothing to see")
    if not scene.lights():
        found.append("no light: a default light will be used")
    if scene.camera is None and not scene.cameras():
        found.append("no camera: one that frames everything will be used")
    for index, mesh in enumerate(meshes):
        name = repr(mesh.name) if mesh.name else f"{index}"
        degenerate = _degenerate(mesh)
        if not len(mesh.triangles):
            found.append(f"mesh {name} has no triangles")
        elif degenerate:
            found.append(f"mesh {name} has {degenerate} triangles of no area")
    return found


def _degenerate(mesh: Mesh) -> int:
    """How many triangles have no area."""
    import numpy as np

    a, b, c = (mesh.positions[mesh.triangles[:, corner]].astype(np.float64) for corner in range(3))
    return int((~np.cross(b - a, c - a).any(axis=1)).sum())


def _lines(told: dict[str, Any]) -> list[str]:
    hidden = f" ({told['hidden_nodes']} hidden)" if told["hidden_nodes"] else ""
    lines = [
        f"nodes      {told['nodes']}{hidden}",
        f"shapes     {told['shapes']}{_in_brackets(told['shapes_by_kind'])}",
        f"meshes     {told['meshes']}, {told['triangles']} triangles"
        + (f", {told['drawn_triangles']} drawn" if told["drawn_triangles"] != told["triangles"] else ""),
        f"materials  {sum(told['materials'].values())}{_in_brackets(told['materials'])}",
        "textures   " + _listed([f"{t['name'] or '-'} {t['width']} x {t['height']}" for t in told["textures"]]),
        "lights     " + _listed([f"{light['kind']} {light['name'] or light['node']}" for light in told["lights"]]),
        "cameras    " + _listed(_cameras(told)),
        *(["variants   " + _listed(told["variants"])] if told["variants"] else []),
        "animations " + _listed([f"{k} {a['name'] or '-'} {a['end'] - a['start']:.4g} s" for k, a in enumerate(told["animations"])]),
    ]
    if told["bounds"] is None:
        return [*lines, "bounds     none"]
    low, high = (", ".join(f"{number:.4g}" for number in corner) for corner in told["bounds"])
    size = " x ".join(f"{b - a:.4g}" for a, b in zip(*told["bounds"], strict=True))
    return [*lines, f"bounds     ({low}) to ({high}): {size} m"]


def _cameras(told: dict[str, Any]) -> list[str]:
    """The scene's own, which is used first; then those of the graph, by the numbers that ``--camera`` takes."""
    own = [f"the scene's own {told['camera']}"] if told["camera"] else []
    return own + [f"{index} {camera['name'] or '-'} {camera['kind']}" for index, camera in enumerate(told["cameras"])]


def _in_brackets(counts: dict[str, int]) -> str:
    return f" ({', '.join(f'{count} {name}' for name, count in counts.items())})" if counts else ""


def _listed(items: list[str]) -> str:
    more = f"; and {len(items) - _SHOWN} more" if len(items) > _SHOWN else ""
    return "; ".join(items[:_SHOWN]) + more if items else "none"
