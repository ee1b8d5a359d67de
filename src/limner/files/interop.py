"""Meshes of other libraries, and the formats that trimesh reads for us.

trimesh knows STL, OFF and more; glTF and OBJ are read by limner itself, because trimesh splits vertices and drops
lights, texture transforms and smoothing, and PLY, because it drops what else is known of vertices. It is imported only when such a file,
or such an object, is at hand.
"""

from __future__ import annotations

import io
import os
import tempfile
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..color.transfer import linear_from_srgb
from ..errors import FileFormatError, LimnerError, SceneError, UnsupportedError
from ..mesh.mesh import Mesh
from ..scene.line_set import LineSet
from ..scene.material import AlphaMode, Lambert, Material, MetallicRoughness
from ..scene.node import Node
from ..scene.points import PointCloud
from ..scene.scene import Scene
from ..scene.shape import Shape
from ..scene.texture import Texels, Texture
from .limits import DEFAULT, Limits
from .notes import Notes, quoted
from .obj import CREASE_DEGREES
from .triangles import count_degenerate, finite_rows

__all__ = ["as_scene", "read", "scene_from_arrays", "scene_from_trimesh", "to_trimesh"]

# What trimesh itself needs for a format, beyond NumPy.
_NEEDS = {"dae": "pycollada", "3mf": "networkx lxml"}


def read(data: bytes, path: str | os.PathLike[str], kind: str, *, limits: Limits = DEFAULT, notes: Notes | None = None) -> Scene:
    """Read the bytes of a .stl, .off, .3mf or .dae file with trimesh.

    Parameters
    ----------
    data : bytes
    path : str or path-like
        For messages.
    kind : str
        "stl", "off", "3mf", "dae".

    Raises UnsupportedError, with what to install, where trimesh or what it needs is missing.
    """
    notes = notes if notes is not None else Notes()
    trimesh = _import_trimesh(f"reading .{kind} files")
    if kind not in trimesh.available_formats():
        raise UnsupportedError(f"reading .{kind} files needs more: pip install trimesh {_NEEDS.get(kind, '')}".rstrip())
    if kind == "3mf":
        _check_archive(data, path, limits)
    try:
        # Only STL has no vertices of its own: there equal corners are made one.
        loaded = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=kind == "stl")
    except Exception as error:  # a parser on a foreign file may raise anything
        reason = " ".join(str(error).split())[:160] or type(error).__name__
        raise FileFormatError(f"trimesh cannot read it as {kind.upper()}: {reason}", path) from None
    try:
        scene = scene_from_trimesh(loaded, limits=limits, notes=notes)
    except SceneError as error:
        raise FileFormatError(str(error), path) from None
    return scene.replace(name=Path(path).stem)


def _check_archive(data: bytes, path: str | os.PathLike[str], limits: Limits) -> None:
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            n_bytes = sum(entry.file_size for entry in archive.infolist())
    except (zipfile.BadZipFile, ValueError, OSError) as error:
        raise FileFormatError(f"is no ZIP archive, as 3MF files are: {error}", path) from None
    if n_bytes > limits.max_file_bytes:
        raise FileFormatError(f"unpacks to {n_bytes} bytes, the limit is {limits.max_file_bytes} (max_file_bytes)", path)


def _import_trimesh(purpose: str) -> Any:
    try:
        import trimesh
    except ImportError:
        raise UnsupportedError(f"{purpose} needs trimesh: pip install trimesh") from None
    return trimesh


def as_scene(thing: Any, *, limits: Limits = DEFAULT) -> Scene:
    """Make a scene of what people hold.

    Parameters
    ----------
    thing : Scene | Node | Shape | Mesh | PointCloud | LineSet | path | trimesh | (vertices, triangles) | object
        A path is loaded, unless it is the name of a built-in scene ("teapot", "cornell"); an object of some other library needs
        `vertices`, and `faces` or `triangles`.
    limits : Limits

    Raises SceneError where it is none of these; and what reading a file raises.

    >>> as_scene(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])).shapes()[0][1].geometry
    Mesh('mesh', 3 positions, 1 triangles)
    """
    if isinstance(thing, Scene):
        return thing
    if isinstance(thing, (str, os.PathLike)):
        return _opened(thing, limits)
    if isinstance(thing, Node):
        return Scene(thing, name=thing.name)
    if isinstance(thing, Shape):
        return Scene(Node(shapes=(thing,)))
    if isinstance(thing, (Mesh, PointCloud, LineSet)):
        return Scene(Node(shapes=(Shape(thing, (_plain(thing.colors),)),)))
    if isinstance(thing, (tuple, list)) and len(thing) == 2:
        return scene_from_arrays(*thing)
    if (hasattr(thing, "graph") and hasattr(thing, "geometry")) or (hasattr(thing, "faces") and hasattr(thing, "visual")):
        return scene_from_trimesh(thing, limits=limits)
    if _is_cloud(thing) or _is_path(thing):
        return scene_from_trimesh(thing, limits=limits)
    triangles = getattr(thing, "faces", getattr(thing, "triangles", None))
    if hasattr(thing, "vertices") and triangles is not None and not callable(triangles):
        return scene_from_arrays(thing.vertices, triangles)
    raise SceneError(
        "scene must be a Scene, the path of a model, the name of a built-in, a Mesh, a PointCloud, a LineSet, a trimesh mesh or scene, "
        f"(vertices, triangles), or have vertices and faces, got {type(thing).__name__}"
    )


def _plain(colors: NDArray[np.float32] | None) -> Material:
    """A matte material that shows colours, alpha included, as they are; grey without any."""
    if colors is None:
        return Lambert()
    blended = colors.shape[1] == 4 and bool((colors[:, 3] < 1.0).any())
    return Lambert((1.0, 1.0, 1.0), alpha_mode="blend" if blended else "opaque")


def _is_path(thing: Any) -> bool:
    """Whether something is a `trimesh.path.Path3D`: curves, which it can say as points along them."""
    return hasattr(thing, "entities") and hasattr(thing, "vertices") and np.ndim(thing.vertices) == 2 and thing.vertices.shape[1] == 3


def _is_cloud(thing: Any) -> bool:
    """Whether something is a `trimesh.PointCloud`: points with colours, without faces."""
    return hasattr(thing, "vertices") and hasattr(thing, "colors") and hasattr(thing, "visual") and not hasattr(thing, "faces")


def _opened(path: str | os.PathLike[str], limits: Limits) -> Scene:
    from ..scene.library import BUILTINS, builtin
    from .load import load

    return builtin(str(path)) if str(path) in BUILTINS else load(path, limits=limits)


def scene_from_arrays(vertices: ArrayLike, triangles: ArrayLike, material: Material | None = None) -> Scene:
    """Make a scene of bare triangles.

    Parameters
    ----------
    vertices : (n, 3) float
        Metres, +y up.
    triangles : (m, 3) int
        Counter-clockwise seen from outside.
    material : Material, optional
        None: grey.

    Returns
    -------
    Scene
        One mesh, with normals that break at creases sharper than 40 degrees.

    >>> scene_from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).shapes()[0][1].geometry
    Mesh('mesh', 3 positions, 1 triangles)
    """
    try:
        positions, indices = np.array(vertices, dtype=np.float32), np.asarray(triangles)
    except (TypeError, ValueError) as error:
        raise SceneError(f"vertices and triangles must be arrays of numbers: {error}") from None
    mesh = _with_normals(Mesh(positions, indices, name="mesh"))
    return Scene(Node(name="mesh", shapes=(Shape(mesh, (material or Lambert(),)),)), name="mesh")


def _with_normals(mesh: Mesh) -> Mesh:
    from ..mesh.normals import crease_normals

    if not len(mesh.triangles):
        return mesh
    normals, normal_triangles = crease_normals(mesh.positions, mesh.triangles, CREASE_DEGREES)
    return Mesh(
        mesh.positions, mesh.triangles, normals=normals, normal_triangles=normal_triangles, uvs=mesh.uvs, colors=mesh.colors,
        name=mesh.name,
    )  # fmt: skip


def scene_from_trimesh(given: Any, *, limits: Limits = DEFAULT, notes: Notes | None = None) -> Scene:
    """Make a scene of a `trimesh.Trimesh` or a `trimesh.Scene`.

    Parameters
    ----------
    given : trimesh.Trimesh | trimesh.Scene
        Meshes with their vertex or face colours, texture coordinates and materials; point clouds with their colours. Paths are left
        out.
    limits : Limits

    Raises SceneError where there are neither triangles, points nor lines.
    """
    notes = notes if notes is not None else Notes()
    placed: list[tuple[str, NDArray[np.float64], Any]]
    if hasattr(given, "faces") or _is_cloud(given) or _is_path(given):
        placed = [("mesh", np.eye(4), given)]
    elif hasattr(given, "graph") and hasattr(given, "geometry"):
        placed = [(str(node), *_placed_geometry(given, node)) for node in given.graph.nodes_geometry]
    else:
        raise SceneError(f"expected a trimesh.Trimesh, PointCloud, Path3D or Scene, got {type(given).__name__}")
    shapes: dict[int, Shape | None] = {}
    nodes = []
    for name, matrix, geometry in placed:
        if id(geometry) not in shapes:
            shapes[id(geometry)] = _shape(geometry, name, limits, notes)
        shape = shapes[id(geometry)]
        if shape is not None:
            nodes.append(Node(name=name, parent_from_node=matrix, shapes=(shape,)))
    if not nodes:
        raise SceneError("has no triangles")
    return Scene(Node(children=tuple(nodes)), notes=notes.lines())


def to_trimesh(scene: Scene) -> Any:
    """Make a `trimesh.Scene` of a scene: its graph, meshes and materials, as glTF has them; exact shapes become triangles.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    trimesh.Scene

    Raises UnsupportedError where trimesh is missing.
    """
    trimesh = _import_trimesh("a trimesh scene")
    from .write_gltf import write

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.glb"
        write(scene, path)
        return trimesh.load_scene(path)


def _placed_geometry(scene: Any, node: Any) -> tuple[NDArray[np.float64], Any]:
    matrix, geometry = scene.graph[node]
    return matrix, scene.geometry[geometry]


def _shape(geometry: Any, name: str, limits: Limits, notes: Notes) -> Shape | None:
    if _is_cloud(geometry) and len(geometry.vertices):
        return _cloud(geometry, name, limits)
    if _is_path(geometry) and len(geometry.entities):
        return _lines(geometry, name, limits)
    if not hasattr(geometry, "faces") or not len(geometry.faces):
        notes.slip("left out, it has no triangles", quoted(name))
        return None
    for found, limit, what in (
        (len(geometry.vertices), limits.max_vertices, "vertices"), (len(geometry.faces), limits.max_triangles, "triangles")
    ):  # fmt: skip
        if found > limit:
            raise SceneError(f"has {found} {what}, the limit is {limit} (max_{what})")
    with np.errstate(over="ignore"):
        positions = np.array(geometry.vertices, dtype=np.float32)
    triangles = np.asarray(geometry.faces)
    finite = finite_rows(positions)
    kept = np.asarray(np.logical_and(triangles >= 0, triangles < len(positions)).all(axis=1))
    kept[kept] = finite[triangles[kept]].all(axis=1)
    if not kept.all():
        notes.slip(f"{int((~kept).sum())} triangles without finite positions are left out", quoted(name))
    positions[~finite] = 0.0
    n_degenerate = count_degenerate(positions, triangles[kept])
    if n_degenerate:
        notes.slip(f"{n_degenerate} triangles have no area; they are kept", quoted(name))
    return _assemble(geometry, positions, triangles, kept, name)


def _cloud(geometry: Any, name: str, limits: Limits) -> Shape:
    if len(geometry.vertices) > limits.max_vertices:
        raise SceneError(f"has {len(geometry.vertices)} points, the limit is {limits.max_vertices} (max_vertices)")
    with np.errstate(over="ignore"):
        positions = np.array(geometry.vertices, dtype=np.float32)
    colors = _linear_colors(geometry.colors) if np.shape(geometry.colors) == (len(positions), 4) else None
    return Shape(PointCloud(positions, colors, name=name), (_plain(colors),))


def _lines(geometry: Any, name: str, limits: Limits) -> Shape:
    """The curves of a path as lines through the points along them."""
    curves = [np.asarray(entity.discrete(geometry.vertices), dtype=np.float64) for entity in geometry.entities]
    n_points = sum(map(len, curves))
    if n_points > limits.max_vertices:
        raise SceneError(f"has {n_points} points, the limit is {limits.max_vertices} (max_vertices)")
    starts = np.cumsum([0, *map(len, curves)])[:-1].tolist()
    first = np.concatenate([start + np.arange(len(curve) - 1) for start, curve in zip(starts, curves, strict=True)])
    with np.errstate(over="ignore"):
        positions = np.concatenate(curves).astype(np.float32)
    colors = None
    if np.shape(geometry.colors) == (len(curves), 4):
        colors = np.repeat(_linear_colors(geometry.colors), [len(curve) for curve in curves], axis=0)
    return Shape(LineSet(positions, np.stack([first, first + 1], axis=1), colors, name=name), (_plain(colors),))


def _assemble(geometry: Any, positions: NDArray[np.float32], triangles: NDArray[Any], kept: NDArray[np.bool_], name: str) -> Shape:
    visual = geometry.visual
    kind = getattr(visual, "kind", None)
    colors = uvs = None
    if kind == "face":
        # Each face has a colour of its own: no position can be shared.
        positions = positions[triangles[kept].reshape(-1)]
        colors = np.repeat(_linear_colors(visual.face_colors)[kept], 3, axis=0)
        triangles = np.arange(len(positions)).reshape(-1, 3)
    else:
        triangles = triangles[kept]
        if kind == "vertex":
            colors = _linear_colors(visual.vertex_colors)
        elif getattr(visual, "uv", None) is not None and len(visual.uv) == len(positions):
            uvs = np.nan_to_num(np.asarray(visual.uv, dtype=np.float32)[:, :2], posinf=0.0, neginf=0.0)
    given = None if kind == "face" else _given_normals(geometry)
    mesh = Mesh(positions, triangles.astype(np.int32), normals=given, uvs=uvs, colors=colors, name=name)
    material = _material(getattr(visual, "material", None), textured=uvs is not None)
    if colors is not None:
        material = _plain(colors)  # the colours say it all
    return Shape(mesh if given is not None else _with_normals(mesh), (material,))


def _linear_colors(encoded: Any) -> NDArray[np.float32]:
    rgba = np.asarray(encoded, dtype=np.float64) / 255.0
    rgba[:, :3] = linear_from_srgb(rgba[:, :3])
    return rgba.astype(np.float32)


def _given_normals(geometry: Any) -> NDArray[np.float32] | None:
    """Return the normals that came with the mesh; those that trimesh would compute know no creases."""
    cached = getattr(geometry, "_cache", None)
    normals = cached.cache.get("vertex_normals") if cached is not None and hasattr(cached, "cache") else None
    if normals is None or np.shape(normals) != np.shape(geometry.vertices):
        return None
    vectors = np.asarray(normals, dtype=np.float64)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    if not (np.isfinite(length).all() and (length > 0.0).all()):
        return None
    return (vectors / length).astype(np.float32)


def _material(given: Any, *, textured: bool) -> Material:
    if given is None:
        return Lambert()
    if hasattr(given, "baseColorFactor"):
        return _physical(given, textured)
    picture = getattr(given, "image", None) if textured else None
    texture = _texture(picture, srgb=True)
    *color, alpha = _unit_color(getattr(given, "diffuse", None), (0.8, 0.8, 0.8, 1.0))
    return Lambert(
        (color[0], color[1], color[2]), texture=texture, alpha=alpha, alpha_mode="blend" if alpha < 1.0 else "opaque",
        name=str(getattr(given, "name", "") or ""),
    )  # fmt: skip


def _physical(given: Any, textured: bool) -> MetallicRoughness:
    *color, alpha = _unit_color(given.baseColorFactor, (1.0, 1.0, 1.0, 1.0))
    modes: dict[str, AlphaMode] = {"MASK": "mask", "BLEND": "blend"}

    def look(name: str, *, srgb: bool) -> Texture | None:
        return _texture(getattr(given, name, None) if textured else None, srgb=srgb)

    emission = _unit_color(given.emissiveFactor, (0.0, 0.0, 0.0))
    return MetallicRoughness(
        base_color=(color[0], color[1], color[2]),
        metallic=1.0 if given.metallicFactor is None else float(np.clip(given.metallicFactor, 0.0, 1.0)),
        roughness=1.0 if given.roughnessFactor is None else float(np.clip(given.roughnessFactor, 0.0, 1.0)),
        base_color_texture=look("baseColorTexture", srgb=True),
        metallic_roughness_texture=look("metallicRoughnessTexture", srgb=False),
        normal_texture=look("normalTexture", srgb=False),
        occlusion_texture=look("occlusionTexture", srgb=False),
        emission=(emission[0], emission[1], emission[2]),
        emissive_texture=look("emissiveTexture", srgb=True),
        double_sided=bool(given.doubleSided),
        alpha=alpha,
        alpha_mode=modes.get(str(given.alphaMode), "opaque"),
        alpha_cutoff=0.5 if given.alphaCutoff is None else float(given.alphaCutoff),
        name=str(given.name or ""),
    )


def _unit_color(given: Any, default: tuple[float, ...]) -> tuple[float, ...]:
    """Return a colour as fractions; trimesh keeps some as bytes, and takes them as linear."""
    if given is None:
        return default
    values = np.asarray(given)
    fractions = values.astype(np.float64).reshape(-1) / (255.0 if values.dtype.kind in "iu" else 1.0)
    fractions = np.clip(np.nan_to_num(fractions), 0.0, 1.0)[: len(default)]
    return (*fractions.tolist(), *default[len(fractions) :])


def _texture(picture: Any, *, srgb: bool) -> Texture | None:
    if picture is None:
        return None
    try:
        return Texture(Texels.from_top_down(np.asarray(picture.convert("RGBA")), srgb=srgb))
    except (LimnerError, OSError, ValueError):
        return None
