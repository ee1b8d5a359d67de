"""A scene as it is at a moment: animations applied, meshes bent.

    walking = at(scene, 0.4, "Walk")           # a scene in which nothing is left to do
    moving = animated(scene, "Walk")           # one whose nodes move while the shutter is open

What does not change is shared with the scene that is given: meshes, materials, whole branches of the graph.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..mesh.mesh import Mesh
from .animation import Animation, FieldChannel, NodeChannel, WeightsChannel
from .graph import visited
from .node import Node, Placed
from .rig import Skin, posed_mesh
from .scene import Scene
from .shape import Shape

__all__ = ["ALL", "animated", "animation_of", "at", "is_rigged", "posed"]

ALL = "all"


def animation_of(scene: Scene, animation: str | int | None = None) -> Animation | None:
    """The animation of that name or number; None: the first, or None where the scene has none; "all": all of them at once.

    Raises SceneError, which lists the animations that there are.
    """
    if animation is None:
        return scene.animations[0] if scene.animations else None
    if isinstance(animation, str):
        found = [held for held in scene.animations if held.name == animation]
        if not found and animation == ALL and scene.animations:
            return Animation(ALL, tuple(channel for held in scene.animations for channel in held.channels))
    else:
        found = [scene.animations[animation]] if 0 <= animation < len(scene.animations) else []
    if not found:
        known = ", ".join(f"{k} {held.name!r}" for k, held in enumerate(scene.animations)) or "none"
        raise SceneError(f"the scene has no animation {animation!r}; it has {known}")
    return found[0]


def at(scene: Scene, time: float, animation: str | int | None = None) -> Scene:
    """The scene as it is at a time: nothing in it moves any more, and no mesh is left to bend.

    Parameters
    ----------
    scene : Scene
    time : float
        Seconds; before the animation it is at its start, after it at its end. Nodes with a motion of their own stand where that says.
    animation : str | int, optional
        Its name or number; None: the first, if there is one.
    """
    found = animation_of(scene, animation)
    if found is not None:
        scene = animated(scene, animation, time)
    return posed(_standing(scene, time))


def animated(scene: Scene, animation: str | int | None = None, time: float = 0.0) -> Scene:
    """Let the nodes of a scene move as an animation says; all else that it changes is as at `time`.

    For a shutter that stays open: between two of its times nodes move, but meshes do not bend.
    """
    found = animation_of(scene, animation)
    if found is None:
        return scene
    motions = {channel.target: channel.motion for channel in found.channels if isinstance(channel, NodeChannel)}
    weights = {channel.target: channel.weights for channel in found.channels if isinstance(channel, WeightsChannel)}
    fields = _Fields([channel for channel in found.channels if isinstance(channel, FieldChannel)], time)
    _check_targets(scene, {*motions, *weights, *fields.paths}, found)

    def change(placed: Placed) -> Node:
        node, changes = placed.node, dict[str, Any]()
        if placed.path in motions:
            changes["parent_from_node"], changes["motion"] = np.eye(4), motions[placed.path]
        if placed.path in weights:
            changes["weights"] = tuple(weights[placed.path].at(time).tolist())
        changes |= fields.of_node(placed)
        return dataclasses.replace(node, **changes) if changes else node

    return visited(scene, change, time)


def is_rigged(scene: Scene) -> bool:
    """Whether there are meshes to bend."""
    return any(shape.morphs or shape.binding is not None for _, shape in scene.shapes())


def posed(scene: Scene, time: float = 0.0) -> Scene:
    """Bend the meshes by the weights of their nodes and by the joints, as these stand at a time.

    A skinned mesh stands where its joints are; the place of the node that shows it does not count (glTF 2.0, 3.7.3).
    """
    if not is_rigged(scene):
        return scene
    places: dict[str, NDArray[np.float64]] = {}
    for placed in scene.root.walk(time=time):
        places[placed.path] = placed.world_from_object

    def change(placed: Placed) -> Node:
        node = placed.node
        if not any(shape.morphs or shape.binding is not None for shape in node.shapes):
            return node
        matrices = None if node.skin is None else _mesh_from_bound(node.skin, placed, places)
        return dataclasses.replace(node, shapes=tuple(_posed_shape(shape, node, matrices) for shape in node.shapes))

    return visited(scene, change, time)


def _posed_shape(shape: Shape, node: Node, matrices: NDArray[np.float64] | None) -> Shape:
    if not shape.morphs and (shape.binding is None or matrices is None):
        return shape
    assert isinstance(shape.geometry, Mesh)
    weights: Sequence[float] = node.weights or (0.0,) * len(shape.morphs)
    if shape.binding is not None and matrices is not None and int(shape.binding.joints.max(initial=0)) >= len(matrices):
        raise SceneError(f"a mesh hangs on joint {int(shape.binding.joints.max())}, its skin has {len(matrices)}", node.name)
    bent = posed_mesh(shape.geometry, shape.morphs, weights, shape.binding, matrices)
    return dataclasses.replace(shape, geometry=bent, morphs=(), binding=None)


def _mesh_from_bound(skin: Skin, placed: Placed, places: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """For each joint, from the mesh as it was modelled to the space of the node that shows it."""
    missing = [joint for joint in skin.joints if joint not in places]
    if missing:
        raise SceneError(f"a skin names the joint {missing[0]!r}, and there is no such node", placed.path)
    assert skin.joint_from_mesh is not None
    world_from_bound = np.stack([places[joint] for joint in skin.joints]) @ skin.joint_from_mesh
    # A node that is squeezed flat has no way back; what hangs there is not seen, as all else below it.
    back = np.linalg.pinv(placed.world_from_object)
    made: NDArray[np.float64] = back @ world_from_bound
    return made


def _standing(scene: Scene, time: float) -> Scene:
    """Everything that moves, stopped at a time."""

    def change(placed: Placed) -> Node:
        node = placed.node
        return node if node.motion is None else dataclasses.replace(node, parent_from_node=node.place(time), motion=None)

    stopped = visited(scene, change, time)
    return stopped if stopped.camera is None else stopped.replace(camera=stopped.camera.standing(time))


def _check_targets(scene: Scene, paths: set[str], animation: Animation) -> None:
    missing = paths - {placed.path for placed in scene.root.walk()}
    if missing:
        raise SceneError(f"animation {animation.name!r} moves {min(missing)!r}, and there is no such node")


class _Fields:
    """Fields of nodes, materials, lights and cameras at a time; what is shared stays shared."""

    def __init__(self, channels: list[FieldChannel], time: float) -> None:
        self._of: dict[tuple[str, str], dict[str, Any]] = {}
        for channel in channels:
            self._of.setdefault((channel.kind, channel.target), {})[channel.field] = channel.track.at(time)
        self.paths = {target for kind, target in self._of if kind == "node"}
        self._kinds = {kind for kind, _ in self._of}
        self._made: dict[int, tuple[Any, Any]] = {}

    def of_node(self, placed: Placed) -> dict[str, Any]:
        """The fields of a node that change."""
        node, changes = placed.node, dict[str, Any]()
        for field, value in self._of.get(("node", placed.path), {}).items():
            changes[field] = _like(getattr(node, field, None), value, field)
        if "material" in self._kinds:
            shapes = tuple(self._shape(shape) for shape in node.shapes)
            if any(a is not b for a, b in zip(shapes, node.shapes, strict=True)):
                changes["shapes"] = shapes
        for kind, group in (("light", "lights"), ("camera", "cameras")):
            if kind in self._kinds:
                held = tuple(self._named(kind, thing) for thing in getattr(node, group))
                if any(a is not b for a, b in zip(held, getattr(node, group), strict=True)):
                    changes[group] = held
        return changes

    def _shape(self, shape: Shape) -> Shape:
        materials = tuple(self._named("material", material) for material in shape.materials)
        if all(a is b for a, b in zip(materials, shape.materials, strict=True)):
            return shape
        return dataclasses.replace(shape, materials=materials)

    def _named(self, kind: str, thing: Any) -> Any:
        changes = self._of.get((kind, getattr(thing, "name", "")))
        if changes is None:
            return thing
        if id(thing) not in self._made:
            self._made[id(thing)] = thing, _with_fields(thing, {tuple(field.split(".")): value for field, value in changes.items()})
        return self._made[id(thing)][1]


def _with_fields(thing: Any, changes: Mapping[tuple[str, ...], NDArray[np.float64]]) -> Any:
    """A description with some of its fields changed, and fields of what it holds."""
    known = {field.name for field in dataclasses.fields(thing)}
    new: dict[str, Any] = {}
    for (field, *deeper), value in changes.items():
        if field not in known:
            raise SceneError(f"an animation changes {field!r}, and a {type(thing).__name__} has no such field")
        held = new.get(field, getattr(thing, field))
        if not deeper:
            new[field] = _like(held, value, field)
        elif held is not None:
            new[field] = _with_fields(held, {tuple(deeper): value})
    try:
        return dataclasses.replace(thing, **new)
    except SceneError:
        # Curves may overshoot what a field allows; most allow what lies between 0 and 1.
        clipped = {field: value if dataclasses.is_dataclass(value) else _clipped(value) for field, value in new.items()}
        return dataclasses.replace(thing, **clipped)


def _clipped(value: Any) -> Any:
    return tuple(min(max(v, 0.0), 1.0) for v in value) if isinstance(value, tuple) else min(max(value, 0.0), 1.0)


def _like(held: Any, value: NDArray[np.float64], field: str) -> Any:
    """A track's value as the field has it: a flag, a number or several."""
    if isinstance(held, bool):
        return bool(value[0] > 0.5)
    if isinstance(held, tuple):
        if len(held) != len(value):
            raise SceneError(f"an animation gives {len(value)} numbers for {field}, which has {len(held)}")
        return tuple(value.tolist())
    return float(value[0])
