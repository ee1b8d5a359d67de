"""A scene seen by its numbers: everything that has them is coloured by them, by one map and one range, whose key goes with the picture.

    scene, bar = limner.produce.scalars.colored(limner.load("wing.ply"), "pressure")
    image = limner.with_color_bar(limner.render(scene), bar)
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from ..color.maps import DEFAULT_MAP, checked_range
from ..draw.color_bar import ColorBar
from ..errors import SceneError
from ..mesh.mesh import Mesh
from ..scene._values import positive
from ..scene.color_by import color_by, named_numbers
from ..scene.line_set import LineSet
from ..scene.material import Lambert
from ..scene.node import Node
from ..scene.points import PointCloud
from ..scene.scene import Scene
from ..scene.shape import Shape

__all__ = ["colored", "scalar_names", "with_point_size"]

_WHITE = Lambert((1.0, 1.0, 1.0))


def scalar_names(scene: Scene) -> tuple[str, ...]:
    """The names of the numbers that visible meshes, clouds and lines have, sorted."""
    return tuple(sorted({name for geometry in _holders(scene) for name in named_numbers(geometry)}))


def colored(
    scene: Scene, name: str, color_map: str | ArrayLike = DEFAULT_MAP, range: tuple[float, float] | None = None
) -> tuple[Scene, ColorBar]:
    """Colour all that has numbers of a name by them.

    Parameters
    ----------
    scene : Scene
    name : str
    color_map : str or (n, 3) float
        As in `limner.color_by`.
    range : (low, high), optional
        None: of all these numbers together.

    Returns
    -------
    scene : Scene
        What is coloured is matte and white below its colours; the rest is as it was.
    bar : ColorBar
        The key, with the name as its label.

    Raises SceneError, with the names that are known, where nothing has such numbers.
    """
    values = [numbers[name] for numbers in map(named_numbers, _holders(scene)) if name in numbers]
    if not values:
        raise SceneError(f"nothing has scalars {name!r}; there are: {', '.join(scalar_names(scene)) or 'none'}")
    ends = checked_range(range, np.concatenate(values) if range is None else None)

    def change(shape: Shape) -> Shape:
        geometry = shape.geometry
        if not isinstance(geometry, (Mesh, PointCloud, LineSet)) or name not in named_numbers(geometry):
            return shape
        made: Mesh | PointCloud | LineSet
        if isinstance(geometry, Mesh):
            made = dataclasses.replace(color_by(geometry, name, color_map, ends), triangle_materials=None)
        elif isinstance(geometry, PointCloud):
            made = color_by(geometry, name, color_map, ends)
        else:
            made = color_by(geometry, name, color_map, ends)
        return dataclasses.replace(shape, geometry=made, materials=(_WHITE,))

    return _changed(scene, change), ColorBar(color_map, ends, name)


def with_point_size(scene: Scene, radius: float) -> Scene:
    """Give all points of all clouds a radius, in metres of their own space."""
    positive(radius, "point_size")

    def change(shape: Shape) -> Shape:
        if not isinstance(shape.geometry, PointCloud):
            return shape
        return dataclasses.replace(shape, geometry=dataclasses.replace(shape.geometry, radii=radius))

    return _changed(scene, change)


def _holders(scene: Scene) -> list[Mesh | PointCloud | LineSet]:
    found = {id(shape.geometry): shape.geometry for _, shape in scene.shapes()}
    return [geometry for geometry in found.values() if isinstance(geometry, (Mesh, PointCloud, LineSet))]


def _changed(scene: Scene, change: Callable[[Shape], Shape]) -> Scene:
    """The scene with every shape changed; what was shared stays shared."""
    order, seen, stack = [], {id(scene.root)}, [scene.root]
    while stack:
        node = stack.pop()
        order.append(node)
        for child in node.children:
            if id(child) not in seen:
                seen.add(id(child))
                stack.append(child)
    shapes: dict[int, Shape] = {}
    made: dict[int, Node] = {}
    # A child may have been met before one of its parents: what is not there yet is made when its own children are.
    pending = order[::-1]
    while pending:
        waiting = []
        for node in pending:
            if any(id(child) not in made for child in node.children):
                waiting.append(node)
                continue
            for shape in node.shapes:
                if id(shape) not in shapes:
                    shapes[id(shape)] = change(shape)
            made[id(node)] = dataclasses.replace(
                node, shapes=tuple(shapes[id(shape)] for shape in node.shapes), children=tuple(made[id(child)] for child in node.children)
            )
        pending = waiting
    return scene.replace(root=made[id(scene.root)])
