"""Reading the scenes of Mitsuba 3 (and of 0.5 and 0.6): a text that says what stands where, of what, in which light, and who looks on.

    XML ──► tree of elements ──► shapes, surfaces, lights, sensors ──► Scene
            (`mitsuba_xml`)      (`mitsuba_shape`, `mitsuba_bsdf`, `mitsuba_light`, `mitsuba_sensor`)

Read are the plug-ins that published scenes are made of; what else there is, and each property that makes no difference here, is named in
the scene's notes and in `limner.load_report`. Units are taken for metres, radiance for nit.

**Source**: the Mitsuba 3 documentation, *Scene XML file format* and the plug-ins' pages.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..errors import FileFormatError, SceneError
from ..mesh.mesh import Mesh
from ..scene.camera import Camera
from ..scene.environment import Environment
from ..scene.material import BlinnPhong, Dielectric, Lambert, Material, MetallicRoughness
from ..scene.node import Node
from ..scene.scene import Scene
from ..scene.shape import Geometry, Shape
from ..scene.texture import Texture
from .limits import DEFAULT, Limits
from .mitsuba_bsdf import Materials, Surface
from .mitsuba_light import Glow, Lights, area_light, shining
from .mitsuba_properties import Properties
from .mitsuba_sensor import integrator_settings, read_sensor
from .mitsuba_shape import Geometries
from .mitsuba_texture import Textures, green_turned
from .mitsuba_xml import Element, read_tree
from .notes import Notes, quoted, without_path
from .sources import Sources

__all__ = ["read", "settings_of"]

_GROUPS = ("shapegroup", "instance", "merge")
_FILES = ("obj", "ply", "serialized")
_OPEN = ("rectangle", "disk", "cylinder")
_BACK = "is drawn from behind as from the front, where Mitsuba shows black (it is not twosided)"
_MAX_REFERENCES = 32


def read(
    data: bytes,
    path: str | os.PathLike[str],
    *,
    limits: Limits = DEFAULT,
    notes: Notes | None = None,
    sources: Sources | None = None,
    parameters: Mapping[str, str] | None = None,
) -> Scene:
    """Read the bytes of a scene; what it refers to is looked up beside it.

    Parameters
    ----------
    data : bytes
        XML.
    path : str or path-like
        Where it stands, for what it refers to and for errors.
    limits, notes, sources : optional
    parameters : mapping of str, optional
        Values for the scene's $parameters, before its own defaults.

    Returns
    -------
    Scene
        The first sensor is its camera. `notes.settings` has what the file says about size, samples and depth.

    Raises FileFormatError, with the line, for what is no scene, and for values that cannot be read. A shape or a picture that is missing is
    left out, and told of.
    """
    notes = notes if notes is not None else Notes()
    sources = sources if sources is not None else Sources(path, limits)
    return _Reader(read_tree(data, sources, notes, parameters), sources, notes).scene()


def settings_of(path: str | os.PathLike[str], *, limits: Limits = DEFAULT) -> dict[str, Any]:
    """Tell how the picture of a scene is to be made, without reading what is in the scene.

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    dict
        Arguments of `limner.render`: size, samples, renderer, depth, as the first sensor and the integrator say.
    """
    sources, notes = Sources(path, limits), Notes()
    return _Reader(read_tree(sources.read_model(), sources, notes, None), sources, notes).settings()


class _Reader:
    """One scene while it is read."""

    def __init__(self, root: Element, sources: Sources, notes: Notes) -> None:
        self._root = root
        self._sources = sources
        self._notes = notes
        self._by_id = self._named()
        self._textures = Textures(sources, notes)
        self._materials = Materials(sources, notes, self._textures, self.find)
        self._geometries = Geometries(sources, notes)
        self._lights = Lights(sources, notes, self._textures)
        self._cameras: list[Camera] = []
        self._hides_sky = False
        self._mirrored: dict[int, tuple[Material, Material]] = {}
        self._groups: dict[int, tuple[Node, ...]] = {}
        self._n_nodes = 0

    def scene(self) -> Scene:
        """Read everything."""
        nodes = [node for element in self._root.children if (node := self._placed(element)) is not None]
        if len(self._cameras) > 1:
            nodes.append(Node("sensors", cameras=tuple(self._cameras)))
        self._complete_settings()
        environment: Environment | None = self._lights.environment
        if self._hides_sky and any(placed.node.lights for node in nodes for placed in node.walk()):
            text = "hide_emitters hides the sky only: lights that have a surface are seen"
            self._notes.add(text, kind="approximated", what="integrator")
        return Scene(
            Node(children=tuple(nodes)),
            camera=self._cameras[0] if self._cameras else None,
            background=(0.0, 0.0, 0.0) if environment is None or self._hides_sky else "environment",
            environment=environment,
            notes=self._notes.lines(),
        )

    def settings(self) -> dict[str, Any]:
        """Read only how the picture is to be made."""
        for element in self._root.children:
            if element.tag in ("sensor", "integrator"):
                self._placed(element)
        self._complete_settings()
        return self._notes.settings

    def _complete_settings(self) -> None:
        settings = self._notes.settings
        settings["default_lights"] = False
        # Filters that reach beyond a pixel are the rasteriser's; by rays, each sample counts in its own pixel.
        if settings.get("renderer", "raster") != "raster" and settings.pop("filter", "box") != "box":
            self._notes.add("the film's filter is shown as a box", kind="approximated", what="rfilter")

    # References

    def _named(self) -> dict[str, Element]:
        found: dict[str, Element] = {}
        for element in self._root.walk():
            if element.tag == "alias":
                original, new = element.attributes.get("id", ""), element.attributes.get("as", "")
                if original not in found:
                    raise FileFormatError(f"there is no object of the id {quoted(original)}", self._sources.path, element.where)
                found[new] = found[original]
            elif element.id and element.tag != "ref":
                found.setdefault(element.id, element)
        return found

    def find(self, element: Element) -> Element:
        """What a <ref> refers to; any other element is itself."""
        for _ in range(_MAX_REFERENCES):
            if element.tag != "ref":
                return element
            target = self._by_id.get(element.id)
            if target is None:
                raise FileFormatError(f"there is no object of the id {quoted(element.id)}", self._sources.path, element.where)
            element = target
        raise FileFormatError("references go round in a circle", self._sources.path, element.where)

    # What stands in the scene

    def _placed(self, element: Element) -> Node | None:
        """The node of an element of the scene; what descriptions refuse is an error at its line."""
        try:
            return self._node(element)
        except SceneError as error:
            raise FileFormatError(str(error), self._sources.path, element.where) from None

    def _node(self, element: Element) -> Node | None:
        properties = Properties(element, self._sources)
        if element.tag == "shape":
            return self._shape(properties)
        if element.tag == "emitter":
            return self._lights.node(properties)
        if element.tag == "sensor":
            camera, settings = read_sensor(properties, self._sources, self._notes)
            if camera is not None and not self._cameras:
                self._notes.settings.update(settings)
            self._cameras.extend(() if camera is None else (camera,))
        elif element.tag == "integrator":
            self._hides_sky = properties.flag("hide_emitters", False)
            self._notes.settings.update(integrator_settings(properties, self._notes))
        elif element.tag in ("medium", "phase", "volume"):
            text = f"{properties.what} is ignored: there are no clouds of particles"
            self._notes.add(text, element.where, kind="ignored", what=properties.what)
        elif element.tag not in ("bsdf", "texture", "alias", "ref", "film", "sampler", "rfilter", *_PLAIN):
            self._notes.add(f"<{quoted(element.tag)[1:-1]}> is ignored", element.where, kind="ignored", what=element.tag)
        return None

    def _shape(self, properties: Properties) -> Node | None:
        self._count(1, properties)
        kind, name = properties.element.kind, properties.element.id
        if kind == "shapegroup":
            return None
        if kind in ("instance", "merge"):
            return self._group(properties)
        try:
            placed = self._geometries.placed(properties)
        except FileFormatError as error:
            if "filename" not in {child.name for child in properties.element.children}:
                raise
            self._notes.slip(f"a shape is left out: {without_path(error)}", properties.where, kind="ignored", what=properties.what)
            return None
        if placed is None:
            self._notes.slip(f"{properties.what} is left out: it is not read", properties.where, kind="ignored", what=properties.what)
            return None
        surface, glow = self._surface(properties), self._glow(properties)
        self._lights.note_unknown(properties)
        if glow is not None and glow.texture is None:
            node = self._area_light(properties, surface, glow)
            if node is not None:
                return node
        material = surface.material if glow is None else shining(surface.material, glow, self._textures)
        if material is None:
            return None
        material = self._fitted(properties, material)
        if not surface.two_sided and kind in _OPEN and glow is None and not isinstance(material, Dielectric):
            self._notes.add(f"a {kind} {_BACK}", properties.where, kind="approximated", what=properties.what)
        children = [
            Node(name if len(placed) == 1 else "", world, shapes=(Shape(_colored(geometry, surface), (material,)),))
            for world, geometry in placed
        ]
        return children[0] if len(children) == 1 else Node(name, children=tuple(children))

    def _fitted(self, properties: Properties, material: Material) -> Material:
        """The material as pictures lie on this kind of shape."""
        kind = properties.element.kind
        if kind == "disk" and any(name.endswith("texture") and value is not None for name, value in vars(material).items()):
            text = "a picture on a disk lies flat, where Mitsuba wraps it around the centre"
            self._notes.add(text, properties.where, kind="approximated", what=properties.what)
        normals = getattr(material, "normal_texture", None)
        mirrored = kind == "rectangle" or (kind in _FILES and not properties.flag("flip_tex_coords", kind == "obj"))
        if not (mirrored and isinstance(material, (Lambert, BlinnPhong, MetallicRoughness)) and isinstance(normals, Texture)):
            return material
        if id(material) not in self._mirrored:
            self._mirrored[id(material)] = (material, dataclasses.replace(material, normal_texture=green_turned(normals)))
        return self._mirrored[id(material)][1]

    def _count(self, n_shapes: int, properties: Properties) -> None:
        self._n_nodes += n_shapes
        limit = self._sources.limits.max_nodes
        if self._n_nodes > limit:
            raise FileFormatError(f"has more than {limit} shapes (max_nodes)", self._sources.path, properties.where)

    def _group(self, properties: Properties) -> Node:
        """A <shape type="instance"> shows a group in its place; a "merge" holds shapes."""
        children: list[Node] = []
        for child in properties.element.children:
            target = self.find(child) if child.tag == "ref" else child
            if id(target) not in self._groups:
                held = target.children if target.kind == "shapegroup" else [target]
                shapes = [Properties(shape, self._sources) for shape in held if shape.tag == "shape" and shape.kind not in _GROUPS]
                self._groups[id(target)] = tuple(node for shape in shapes if (node := self._shape(shape)) is not None)
            else:
                self._count(len(self._groups[id(target)]), properties)
            children.extend(self._groups[id(target)])
        return Node(properties.element.id, properties.transform("to_world"), children=tuple(children))

    def _surface(self, properties: Properties) -> Surface:
        found = None
        for child in properties.element.children:
            target = self.find(child) if child.tag == "ref" else child
            if target.tag == "bsdf":
                found = target
            elif target.tag == "medium":
                text = "the medium in a shape is ignored: there are no clouds of particles"
                self._notes.add(text, child.where, kind="ignored", what=properties.what)
        return Surface(Lambert((0.5, 0.5, 0.5))) if found is None else self._materials.surface(found)

    def _glow(self, properties: Properties) -> Glow | None:
        for child in properties.element.children:
            target = self.find(child) if child.tag == "ref" else child
            if target.tag == "emitter":
                return self._lights.glow(Properties(target, self._sources))
        return None

    def _area_light(self, properties: Properties, surface: Surface, glow: Glow) -> Node | None:
        kind = properties.element.kind
        if kind not in ("rectangle", "disk", "sphere"):
            return None
        world, radius = properties.transform("to_world"), 1.0
        if kind == "sphere":
            centre = np.eye(4)
            centre[:3, 3] = properties.point("center")
            world, radius = world @ centre, properties.number("radius", 1.0)
        flipped = properties.flag("flip_normals", False)
        node = area_light(kind, world, glow.radiance, radius, flipped=flipped, name=properties.element.id)
        if node is not None and not _is_black(surface.material):
            text = "shines and reflects nothing, where Mitsuba's surface reflects a little, too"
            self._notes.add(f"a {kind} {text}", properties.where, kind="approximated", what=properties.what)
        return node


_PLAIN = ("string", "integer", "float", "boolean", "rgb", "spectrum", "transform")


def _is_black(material: Material | None) -> bool:
    return material is None or (isinstance(material, Lambert) and not any(material.color))


def _colored(geometry: Geometry, surface: Surface) -> Geometry:
    """The mesh with its own colours only where the surface shows them."""
    if isinstance(geometry, Mesh) and geometry.colors is not None and not surface.by_vertex:
        return dataclasses.replace(geometry, colors=None)
    return geometry
