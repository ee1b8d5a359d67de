"""Choosing one of the variants that a scene comes in: the shoe in blue, in red, with laces (KHR_materials_variants).

A material that looks different in some of them says so itself, in `MetallicRoughness.variants`.
"""

from __future__ import annotations

import dataclasses

from ..errors import SceneError
from .material import Material, MetallicRoughness, Variant
from .node import Node
from .scene import Scene
from .shape import Shape

__all__ = ["variant_names", "with_variant"]


def variant_names(scene: Scene) -> tuple[str, ...]:
    """Return the names of a scene's variants, in the order in which its materials name them.

    Parameters
    ----------
    scene : Scene
    """
    names: dict[str, None] = {}
    for node in _nodes(scene.root):
        for shape in node.shapes:
            for material in shape.materials:
                names.update(dict.fromkeys(variant.name for variant in _variants(material)))
    return tuple(names)


def with_variant(scene: Scene, name: str) -> Scene:
    """Return the scene in one of its variants; what is the same in it stays the very same.

    Parameters
    ----------
    scene : Scene
    name : str
        One of `variant_names`. Materials that have nothing to say about it are those of the scene as it is. Every variant can be chosen
        again from the result.

    Raises SceneError where there is none of that name.

    >>> from .shape import Sphere
    >>> shoe = MetallicRoughness(name="blue", variants=(Variant("evening", MetallicRoughness(name="black")),))
    >>> with_variant(Scene(Node(shapes=(Shape(Sphere(1.0), shoe),))), "evening").shapes()[0][1].materials[0].name
    'black'
    """
    names = variant_names(scene)
    if name not in names:
        known = f"its variants are {', '.join(map(repr, names))}" if names else "it has none"
        raise SceneError(f"the scene has no variant {name!r}; {known}")
    made: dict[int, Node] = {}
    for node in reversed(_nodes(scene.root)):
        shapes = tuple(_shape(shape, name) for shape in node.shapes)
        children = tuple(made[id(child)] for child in node.children)
        old = (*node.shapes, *node.children)
        same = all(a is b for a, b in zip((*shapes, *children), old, strict=True))
        made[id(node)] = node if same else dataclasses.replace(node, shapes=shapes, children=children)
    return scene.replace(root=made[id(scene.root)])


def _nodes(root: Node) -> list[Node]:
    """Every node once, each after all of its parents."""
    order: list[Node] = []
    done: set[int] = set()
    stack: list[tuple[Node, bool]] = [(root, False)]
    while stack:
        node, left = stack.pop()
        if left:
            order.append(node)
        elif id(node) not in done:
            done.add(id(node))
            stack.append((node, True))
            stack += [(child, False) for child in node.children]
    return order[::-1]


def _shape(shape: Shape, name: str) -> Shape:
    materials = tuple(_material(material, name) for material in shape.materials)
    same = all(a is b for a, b in zip(materials, shape.materials, strict=True))
    return shape if same else dataclasses.replace(shape, materials=materials)


def _material(material: Material, name: str) -> Material:
    variants = _variants(material)
    chosen = next((variant.material for variant in variants if variant.name == name), None)
    if chosen is None:
        return material
    return dataclasses.replace(chosen, variants=variants) if isinstance(chosen, MetallicRoughness) else chosen


def _variants(material: Material) -> tuple[Variant, ...]:
    return material.variants if isinstance(material, MetallicRoughness) else ()
