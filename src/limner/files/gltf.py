"""Reading glTF 2.0, as text (.gltf) and as one binary file (.glb).

    bytes -> document (JSON) + binary chunk -> accessors -> meshes, materials -> nodes -> Scene

A scene keeps the file's graph: a node with a mesh gets one `Shape` for each primitive; meshes, materials and texels that
the file shares are shared objects. What cannot be read is left out and said in `Scene.notes`; a file is refused only where
it is no glTF at all, reaches out of its folder, has a cycle in its graph, or where nothing of its geometry can be read.

**Source**: Khronos Group, *glTF 2.0 Specification*, version 2.0.1; the KHR extensions named in `HANDLED`.
"""

from __future__ import annotations

import dataclasses
import math
import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, LimnerError, UnsupportedError
from ..linear.transform import compose_trs
from ..mesh.mesh import Mesh
from ..scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from ..scene.light import DirectionalLight, Light, PointLight, SpotLight
from ..scene.line_set import LineSet
from ..scene.material import Material, MetallicRoughness
from ..scene.node import MAX_DEPTH, Node, names_among_siblings
from ..scene.points import PointCloud
from ..scene.scene import Scene
from ..scene.shape import Shape
from .accessors import Accessors
from .document import Element, parse_json
from .glb import MAGIC, read_container
from .gltf_animation import Animations, Names
from .gltf_material import Materials
from .gltf_material_parts import DISPERSION, IOR, PARTS
from .gltf_mesh import Meshes
from .gltf_rig import Rigs
from .gltf_slips import note_slips
from .limits import DEFAULT, Limits
from .notes import Notes, quoted, without_path
from .sources import Sources

__all__ = ["HANDLED", "read"]

# What is read. Of the others a note says that they are ignored.
HANDLED = frozenset({
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "EXT_texture_avif", "EXT_texture_webp", "KHR_animation_pointer",
    "KHR_draco_mesh_compression", "KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit", "KHR_materials_variants", "KHR_mesh_quantization", "KHR_meshopt_compression", "KHR_node_visibility",
    "KHR_texture_basisu", "KHR_texture_transform", IOR, DISPERSION, *(part.extension for part in PARTS),
})  # fmt: skip


def read(
    data: bytes,
    path: str | os.PathLike[str],
    *,
    scene: str | int | None = None,
    limits: Limits = DEFAULT,
    notes: Notes | None = None,
    sources: Sources | None = None,
) -> Scene:
    """Read the bytes of a .gltf or .glb file.

    Parameters
    ----------
    data : bytes
        The file itself; which of the two it is, its first bytes say.
    path : str or path-like
        Where it lies: buffers and pictures are looked up beside it.
    scene : str or int, optional
        Which of the file's scenes, by its name or number. None: the one that the file shows by default.
    limits : Limits
    notes : Notes, optional
        Where remarks are collected; they are in `Scene.notes` in any case.
    sources : Sources, optional
        What has counted the bytes read so far.

    Raises FileFormatError, with a JSON pointer, or UnsupportedError.
    """
    notes = notes if notes is not None else Notes()
    sources = sources if sources is not None else Sources(path, limits)
    binary: memoryview | None = None
    text: memoryview = memoryview(data)
    # What is named .glb and is no text either is judged as the container that it claims to be.
    if data[:4] == MAGIC or (Path(path).suffix.lower() == ".glb" and not data.lstrip().startswith((b"{", b"\xef\xbb\xbf"))):
        text, binary = read_container(data, path, notes)
    if len(text) > limits.max_json_bytes:
        raise FileFormatError(f"its JSON has {len(text)} bytes, the limit is {limits.max_json_bytes} (max_json_bytes)", path)
    if bytes(text[:3]) == b"\xef\xbb\xbf":
        notes.add("begins with a byte order mark, which is ignored")
    return _Reader(parse_json(text, path), binary, sources, notes).scene(scene)


class _Reader:
    """One glTF file while it is read."""

    def __init__(self, root: Element, binary: memoryview | None, sources: Sources, notes: Notes) -> None:
        self._root = root
        self._limits = sources.limits
        self._notes = notes
        _check_version(root)
        self._nodes = root.array("nodes")
        self._scenes = root.array("scenes")
        self._cameras = root.array("cameras")
        punctual = root.extension("KHR_lights_punctual")
        self._lights = punctual.array("lights") if punctual is not None else []
        self._accessors = Accessors(root, binary, sources, notes)
        self._meshes = Meshes(root, self._accessors, sources.limits, notes)
        self._materials = Materials(root, self._accessors, sources, notes)
        self._rigs = Rigs(root, self._accessors, notes)
        self._animations = Animations(root, self._accessors, notes)
        self._materials.rename(self._animations.pointed_at("/materials/"))
        self._moving_lights = self._animations.pointed_at("/extensions/KHR_lights_punctual/lights/")
        self._moving_cameras = self._animations.pointed_at("/cameras/")
        self._shapes: dict[int, tuple[Shape, ...]] = {}
        self._unlit: dict[int, tuple[Material, Material]] = {}
        self._paths: dict[int, str] = {}

    def scene(self, wanted: str | int | None = None) -> Scene:
        """Build one of the file's scenes, by its name or number; None: the one that it shows by default."""
        self._note_extensions()
        children = self._children_of_nodes()
        order = self._order(children)
        chosen, roots = self._roots(self._default_scene() if wanted is None else self._named_scene(wanted))
        shown = self._reachable(roots, children)
        self._check_size(roots, children, [node for node in order if node in shown])
        self._prepare_materials(shown)
        self._paths = self._paths_of(roots, children)
        built: dict[int, Node] = {}
        for index in order:
            if index in shown:
                built[index] = self._node(index, tuple(built[child] for child in children[index]))
        if self._meshes.first_error is not None and not self._meshes.n_built:
            raise self._meshes.first_error
        self._note_leftovers(shown)
        name = (chosen.name() if chosen is not None else "") or Path(self._root.path).stem
        root = Node(children=tuple(built[index] for index in roots))
        animations = self._animations.read(Names(self._paths, self._materials.name, self._light_name, self._camera_name))
        note_slips(self._root, self._notes)
        return Scene(root, name=name, notes=self._notes.lines(), animations=animations)

    # The graph

    def _children_of_nodes(self) -> list[list[int]]:
        n_parents = [0] * len(self._nodes)
        children: list[list[int]] = []
        for node in self._nodes:
            found = []
            for reference in node.array("children"):
                try:
                    child = reference.index(len(self._nodes))
                except LimnerError as error:
                    self._notes.slip(f"a child is left out: {without_path(error)}")
                    continue
                found.append(child)
                n_parents[child] += 1
            children.append(found)
        shared = [index for index, n in enumerate(n_parents) if n > 1]
        if shared:
            self._notes.slip(f"{_names(shared)} have more than one parent and are shown below each of them")
        self._n_parents = n_parents
        return children

    def _order(self, children: list[list[int]]) -> list[int]:
        """Return all nodes, children before parents (Tarjan 1976, depth first without recursion); refuse cycles."""
        order: list[int] = []
        state = bytearray(len(children))  # 0: new, 1: on the way down, 2: done
        for start in range(len(children)):
            if state[start]:
                continue
            path, ahead = [start], [iter(children[start])]
            state[start] = 1
            while path:
                child = next(ahead[-1], None)
                if child is None:
                    state[path[-1]] = 2
                    order.append(path.pop())
                    ahead.pop()
                elif state[child] == 1:
                    cycle = [*path[path.index(child) :], child]
                    chain = " -> ".join(self._label(index) for index in cycle[:12])
                    raise self._nodes[child].error(f"the node graph has a cycle: {chain}", "children")
                elif state[child] == 0:
                    state[child] = 1
                    path.append(child)
                    ahead.append(iter(children[child]))
        return order

    def _label(self, index: int) -> str:
        name = self._nodes[index].name()
        return f"{index} {quoted(name, 30)}" if name else str(index)

    def _roots(self, scene: Element | None) -> tuple[Element | None, list[int]]:
        """Return the scene that is shown, and its nodes; without any, those that have no parent."""
        if scene is None:
            return None, [index for index, n in enumerate(self._n_parents) if n == 0]
        roots: list[int] = []
        for reference in scene.array("nodes"):
            try:
                index = reference.index(len(self._nodes))
            except LimnerError as error:
                self._notes.slip(f"a node is left out: {without_path(error)}")
                continue
            if index in roots:
                self._notes.slip(f"{reference.pointer}: node {index} stands twice in the scene and is shown once")
            else:
                roots.append(index)
        return scene, roots

    def _named_scene(self, wanted: str | int) -> Element:
        names = [scene.name() for scene in self._scenes]
        if isinstance(wanted, str) and wanted in names:
            return self._scenes[names.index(wanted)]
        if isinstance(wanted, int) and not isinstance(wanted, bool) and 0 <= wanted < len(names):
            return self._scenes[wanted]
        known = f"its {len(names)} scenes are {', '.join(quoted(name, 30) for name in names[:12])}" if names else "it has none"
        raise self._root.error(f"has no scene {quoted(wanted)}; {known}", "scenes")

    def _default_scene(self) -> Element | None:
        if not self._scenes:
            return None
        reference = self._root.get("scene")
        if len(self._scenes) > 1:
            self._notes.add(f"the file has {len(self._scenes)} scenes; only the default one is read")
        if reference is None:
            return self._scenes[0]
        try:
            return self._scenes[reference.index(len(self._scenes))]
        except LimnerError as error:
            self._notes.slip(f"the first scene is read: {without_path(error)}")
            return self._scenes[0]

    def _reachable(self, roots: list[int], children: list[list[int]]) -> set[int]:
        found, stack = set(roots), list(roots)
        while stack:
            for child in children[stack.pop()]:
                if child not in found:
                    found.add(child)
                    stack.append(child)
        return found

    def _check_size(self, roots: list[int], children: list[list[int]], order: list[int]) -> None:
        """Refuse graphs that are too deep, or that sharing makes too large to walk, before any of it is built."""
        depth: dict[int, int] = {}
        n_walked: dict[int, int] = {}
        for index in order:
            depth[index] = 1 + max((depth[child] for child in children[index]), default=0)
            n_walked[index] = 1 + sum(n_walked[child] for child in children[index])
        if max((depth[index] for index in roots), default=0) > MAX_DEPTH:
            raise self._root.error(f"the node graph is deeper than {MAX_DEPTH} nodes", "nodes")
        self._n_nodes = sum(n_walked[index] for index in roots)
        if self._n_nodes > self._limits.max_nodes:
            raise self._root.error(f"the scene exceeds the limit of {self._limits.max_nodes} nodes (max_nodes)", "nodes")

    def _paths_of(self, roots: list[int], children: list[list[int]]) -> dict[int, str]:
        """What each node's path will be; of one that stands below several parents, the first."""
        paths: dict[int, str] = {}
        stack = [("world", roots)]
        while stack:
            path, below = stack.pop()
            for index, name in zip(below, names_among_siblings([self._nodes[child].name() for child in below]), strict=True):
                if index not in paths:
                    paths[index] = f"{path}/{name}"
                    stack.append((paths[index], children[index]))
        return paths

    def _light_name(self, index: int) -> str:
        return f"light {index}" if index in self._moving_lights else self._lights[index].name()

    def _camera_name(self, index: int) -> str:
        return f"camera {index}" if index in self._moving_cameras else self._cameras[index].name()

    # What stands at the nodes

    def _prepare_materials(self, shown: set[int]) -> None:
        wanted: set[int] = set()
        for mesh in {self._mesh_of(index) for index in shown} - {None}:
            try:
                found = [self._materials.index_of(primitive) for primitive in self._meshes.primitives(mesh or 0)]
            except LimnerError:
                continue
            wanted.update(index for index in found if index is not None)
        self._materials.prepare(wanted)

    def _mesh_of(self, index: int) -> int | None:
        try:
            reference = self._nodes[index].get("mesh")
            return None if reference is None else reference.index(len(self._meshes))
        except LimnerError as error:
            self._notes.slip(f"/nodes/{index} is drawn without its mesh: {without_path(error)}")
            return None

    def _node(self, index: int, children: tuple[Node, ...]) -> Node:
        node = self._nodes[index]
        shapes = self._shapes_of(index)
        instances = self._instances(node, shapes) if shapes else None
        name = node.name()
        return Node(
            name=name,
            parent_from_node=self._matrix(node),
            shapes=shapes if instances is None else (),
            lights=self._lights_of(node),
            cameras=self._cameras_of(node, name),
            children=children if instances is None else (*children, *instances),
            visible=self._visible(node),
            weights=self._weights(index),
            skin=self._rigs.skin(node, self._paths) if shapes else None,
        )

    def _matrix(self, node: Element) -> NDArray[np.float64]:
        try:
            if node.has("matrix"):
                numbers = node.get_numbers("matrix", (0.0,) * 16)
                matrix = np.array(numbers).reshape(4, 4).T
                if tuple(matrix[3]) != (0.0, 0.0, 0.0, 1.0):
                    self._notes.slip(f"{node.pointer}/matrix: its last row is taken as 0 0 0 1, it is {matrix[3].tolist()}")
                    matrix[3] = (0.0, 0.0, 0.0, 1.0)
                return matrix
            return compose_trs(
                node.get_numbers("translation", (0.0, 0.0, 0.0)),
                node.get_numbers("rotation", (0.0, 0.0, 0.0, 1.0), -1e6, 1e6),
                node.get_numbers("scale", (1.0, 1.0, 1.0)),
            )
        except LimnerError as error:
            self._notes.slip(f"{node.pointer} stays where its parent is: {without_path(error)}")
            return np.eye(4)

    def _visible(self, node: Element) -> bool:
        try:
            visibility = node.extension("KHR_node_visibility")
            return True if visibility is None else visibility.get_flag("visible", True)
        except LimnerError as error:
            self._notes.slip(f"{node.pointer} is shown: {without_path(error)}")
            return True

    def _shapes_of(self, index: int) -> tuple[Shape, ...]:
        mesh = self._mesh_of(index)
        if mesh is None:
            return ()
        if mesh not in self._shapes:
            try:
                primitives = self._meshes.primitives(mesh)
            except LimnerError as error:
                self._notes.slip(f"/meshes/{mesh} is left out: {without_path(error)}")
                primitives = []
            found = [(primitive, self._meshes.of(primitive, self._meshes.name(mesh))) for primitive in primitives]
            self._shapes[mesh] = tuple(self._shape(primitive, geometry) for primitive, geometry in found if geometry is not None)
        return self._shapes[mesh]

    def _shape(self, primitive: Element, geometry: Mesh | PointCloud | LineSet) -> Shape:
        if isinstance(geometry, PointCloud):
            return Shape(geometry, (self._materials.of(primitive),))
        if isinstance(geometry, LineSet):
            return Shape(geometry, (self._line_material(primitive),))
        n_vertices, kept = self._meshes.vertices_of(geometry)
        try:
            morphs = self._rigs.morphs(primitive, geometry, n_vertices, kept)
            binding = self._rigs.binding(primitive, n_vertices, kept)
        except LimnerError as error:
            self._notes.slip(f"neither morphed nor skinned: {without_path(error)}")
            morphs, binding = (), None
        return Shape(geometry, (self._materials.of(primitive),), morphs, binding)

    def _line_material(self, primitive: Element) -> Material:
        """The material of lines; without normals they are shown as they are, unlit.

        **Source**: glTF 2.0, 3.9.7, Point and Line Materials.
        """
        material = self._materials.of(primitive)
        if primitive.child("attributes").has("NORMAL") or not isinstance(material, MetallicRoughness) or material.unlit:
            return material
        if id(material) not in self._unlit:
            self._unlit[id(material)] = material, dataclasses.replace(material, unlit=True)
        return self._unlit[id(material)][1]

    def _weights(self, index: int) -> tuple[float, ...]:
        """How far the meshes of a node are morphed: by its own weights, else by those of its mesh."""
        mesh = self._mesh_of(index)
        if mesh is None:
            return ()
        for owner in (self._nodes[index], self._meshes.element(mesh)):
            try:
                if owner.has("weights"):
                    return tuple(weight.number() for weight in owner.array("weights"))
            except LimnerError as error:
                self._notes.slip(f"{owner.pointer} is not morphed: {without_path(error)}")
        return ()

    def _instances(self, node: Element, shapes: tuple[Shape, ...]) -> tuple[Node, ...] | None:
        """Return one child for each place that EXT_mesh_gpu_instancing gives the mesh; None: it stands here, once."""
        try:
            given = node.extension("EXT_mesh_gpu_instancing")
            attributes = given.get("attributes") if given is not None else None
            if attributes is None:
                return None
            columns = {"TRANSLATION": "VEC3", "ROTATION": "VEC4", "SCALE": "VEC3"}
            read = {key: self._accessors.floats(attributes.child(key), kind) for key, kind in columns.items() if attributes.has(key)}
            counts = {len(values) for values in read.values()}
            if len(counts) != 1:
                raise attributes.error(f"must be of one length, got {sorted(counts)}")
            n_instances = counts.pop()
            self._n_nodes += n_instances
            if self._n_nodes > self._limits.max_nodes:
                raise attributes.error(f"exceeds the limit of {self._limits.max_nodes} nodes (max_nodes)")
            default = {"TRANSLATION": (0.0, 0.0, 0.0), "ROTATION": (0.0, 0.0, 0.0, 1.0), "SCALE": (1.0, 1.0, 1.0)}
            rows = [read[key].astype(np.float64) if key in read else np.tile(default[key], (n_instances, 1)) for key in default]
            places = compose_trs(*rows)
            return tuple(Node(name=f"instance {i}", parent_from_node=place, shapes=shapes) for i, place in enumerate(places))
        except LimnerError as error:
            self._notes.slip(f"{node.pointer} shows its mesh once: {without_path(error)}")
            return None

    def _lights_of(self, node: Element) -> tuple[Light, ...]:
        try:
            punctual = node.extension("KHR_lights_punctual")
            reference = punctual.get("light") if punctual is not None else None
            if reference is None:
                return ()
            index = reference.index(len(self._lights))
            return (_light(self._lights[index], self._light_name(index) or node.name()),)
        except LimnerError as error:
            self._notes.slip(f"{node.pointer} has no light: {without_path(error)}")
            return ()

    def _cameras_of(self, node: Element, name: str) -> tuple[Camera, ...]:
        try:
            reference = node.get("camera")
            if reference is None:
                return ()
            index = reference.index(len(self._cameras))
            camera = _camera(self._cameras[index])
            if index in self._moving_cameras:
                name = self._camera_name(index)
                camera = dataclasses.replace(camera, name=name)
        except LimnerError as error:
            self._notes.slip(f"{node.pointer} has no camera: {without_path(error)}")
            return ()
        return (camera if camera.name or not name else dataclasses.replace(camera, name=name),)

    # What is said about it

    def _note_extensions(self) -> None:
        required = _strings(self._root, "extensionsRequired")
        used = _strings(self._root, "extensionsUsed")
        for name in required:
            if name not in HANDLED:
                self._notes.slip(f"the file requires {quoted(name)}, which is not supported; it is drawn without")
        for name in used:
            if name not in HANDLED and name not in required:
                self._notes.add(f"extension {quoted(name)} is ignored")

    def _note_leftovers(self, shown: set[int]) -> None:
        if len(self._meshes) and not any(self._mesh_of(index) is not None for index in shown):
            self._notes.slip("the file has meshes, but its scene shows none of them")
        if self._meshes.n_degenerate:
            self._notes.slip(f"{self._meshes.n_degenerate} triangles have no area; they are kept")


def _names(nodes: list[int]) -> str:
    listed = ", ".join(f"/nodes/{index}" for index in nodes[:5])
    return listed + (f" and {len(nodes) - 5} more" if len(nodes) > 5 else "")


def _strings(owner: Element, key: str) -> list[str]:
    found = [element.value for element in owner.array(key)]
    return list(dict.fromkeys(value for value in found if isinstance(value, str)))


def _check_version(root: Element) -> None:
    asset = root.get("asset")
    if asset is None:
        raise root.error("is missing: a glTF 2.0 file must say its version there", "asset")
    version = asset.child("version").text()
    major, point, minor = version.partition(".")
    if not (point and major.isdecimal() and minor.isdecimal() and len(version) < 20):
        raise asset.error(f'must be like "2.0", got {quoted(version)}', "version")
    least = asset.get_text("minVersion", "2.0")
    if int(major) != 2 or least != "2.0":
        found = version if int(major) != 2 else f"{quoted(least)} or later"
        raise UnsupportedError(f"{root.path}: glTF version {found} is not supported, only 2.0 is")


def _light(light: Element, name: str) -> Light:
    """**Source**: Khronos Group, *KHR_lights_punctual*."""
    color = light.get_numbers("color", (1.0, 1.0, 1.0), 0.0)
    intensity = light.get_number("intensity", 1.0, 0.0)
    kind = light.child("type").text()
    if kind == "directional":
        return DirectionalLight((color[0], color[1], color[2]), intensity, name=name)
    reach = light.get("range")
    limit = None if reach is None or reach.number(0.0) == 0.0 else reach.number()
    if kind == "point":
        return PointLight((color[0], color[1], color[2]), intensity, range=limit, name=name)
    if kind != "spot":
        raise light.error(f"must be directional, point or spot, got {quoted(kind)}", "type")
    spot = light.get("spot") or Element({}, light.pointer, light.path)
    inner = spot.get_number("innerConeAngle", 0.0, 0.0)
    outer = spot.get_number("outerConeAngle", math.pi / 4.0, 0.0, math.pi / 2.0 + 1e-6)
    return SpotLight(
        (color[0], color[1], color[2]), intensity, inner_degrees=math.degrees(inner),
        outer_degrees=min(math.degrees(outer), 90.0), range=limit, name=name,
    )  # fmt: skip


def _camera(camera: Element) -> Camera:
    """**Source**: glTF 2.0, 3.10. What a picture is wide is the picture's affair: `aspect` is what the file said."""
    kind = camera.child("type").text()
    if kind == "perspective":
        lens = camera.child("perspective")
        return PerspectiveCamera(
            yfov_degrees=math.degrees(lens.child("yfov").number(1e-6, math.pi - 1e-6)),
            near=lens.child("znear").number(1e-30),
            far=lens.child("zfar").number(1e-30) if lens.has("zfar") else None,
            aspect=lens.child("aspectRatio").number(1e-6, 1e6) if lens.has("aspectRatio") else None,
            name=camera.name(),
        )
    if kind != "orthographic":
        raise camera.error(f"must be perspective or orthographic, got {quoted(kind)}", "type")
    lens = camera.child("orthographic")
    half_width, half_height = abs(lens.child("xmag").number()), abs(lens.child("ymag").number())
    if not (half_width > 0.0 and half_height > 0.0):
        raise lens.error("xmag and ymag must not be 0")
    # A near plane at 0 is usual for parallel views; there None says the same: from the scene's bounds.
    near = lens.child("znear").number(0.0)
    return OrthographicCamera(
        height=2.0 * half_height,
        near=near if near > 0.0 else None,
        far=lens.child("zfar").number(1e-30),
        aspect=half_width / half_height,
        name=camera.name(),
    )
