"""The meshes of a scene: each once, however often it is shown, and the same scene with others in their place."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from ..mesh.mesh import Mesh
from .node import Node
from .scene import Scene
from .shape import Shape

__all__ = ["meshes_of", "with_meshes"]


def meshes_of(scene: Scene) -> dict[str, Mesh]:
    """Every mesh of a scene, hidden ones too, by the path of the first node that shows it.

    A node's second mesh is "world/car 2", and so on.
    """
    found: dict[str, Mesh] = {}
    seen: set[int] = set()
    for placed in scene.root.walk():
        own = [shape.geometry for shape in placed.node.shapes if isinstance(shape.geometry, Mesh)]
        for number, mesh in enumerate(own):
            if id(mesh) not in seen:
                seen.add(id(mesh))
                found[f"{placed.path} {number + 1}" if number else placed.path] = mesh
    return found


def with_meshes(scene: Scene, change: Callable[[Mesh], Mesh]) -> Scene:
    """Put changed meshes in the place of a scene's own; one that several nodes show is changed once.

    What a rig knows of a mesh (morphs, joints) is dropped where the mesh is another one: its rows would belong to other vertices.
    """
    made: dict[int, Mesh] = {}

    def shape_with(shape: Shape) -> Shape:
        if not isinstance(shape.geometry, Mesh):
            return shape
        if id(shape.geometry) not in made:
            made[id(shape.geometry)] = change(shape.geometry)
        mesh = made[id(shape.geometry)]
        if mesh is shape.geometry:
            return shape
        return dataclasses.replace(shape, geometry=mesh, morphs=(), binding=None)

    def node_with(node: Node) -> Node:
        shapes = tuple(shape_with(shape) for shape in node.shapes)
        weights = node.weights if all(new is old for new, old in zip(shapes, node.shapes, strict=True)) else ()
        return dataclasses.replace(node, shapes=shapes, weights=weights, children=tuple(node_with(child) for child in node.children))

    return scene.replace(root=node_with(scene.root))
