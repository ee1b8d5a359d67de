"""Reading OpenUSD (.usd, .usda, .usdc, .usdz) through its own library: a stage of prims becomes a graph of nodes.

    stage ──► prims ──► nodes: places, moves, instances, and what stands there
              meshes (`usd_mesh`)   surfaces (`usd_material`)   lights (`usd_light`)   cameras

What a stage is made of (layers, references, payloads, variants) the library composes; here what came out of it is read. Axes and units are
those of the stage until the root of the scene turns +z up to +y up and scales them to metres. Times of keys are seconds.

`usd-core` is imported when a file needs it.

**Source**: Pixar Animation Studios, *OpenUSD*, the schemas UsdGeom, UsdShade, UsdLux and the *UsdPreviewSurface Specification*.
"""

from __future__ import annotations

import dataclasses
import importlib
import math
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, LimnerError, UnsupportedError
from ..linear import quaternion
from ..scene.animation import Animation, Channel, FieldChannel, NodeChannel, WeightsChannel
from ..scene.camera import Camera, OrthographicCamera, PerspectiveCamera
from ..scene.motion import KeyedMotion
from ..scene.node import MAX_DEPTH, Node
from ..scene.scene import Scene
from ..scene.track import Track
from .limits import DEFAULT, Limits
from .notes import Notes, quoted, without_path
from .sources import Sources
from .usd_light import Found, Lights
from .usd_material import Materials
from .usd_mesh import Geometries, Standing

__all__ = ["EXTENSIONS", "read"]

EXTENSIONS = (".usd", ".usda", ".usdc", ".usdz")

_Y_UP_FROM_Z_UP = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
_HIDDEN_PURPOSES = ("guide", "proxy")
_MOST_KEYS = 10_000
_SHEARED = 1e-4  # of a cosine, how far axes may be from right angles
_TENTH = 0.1  # lengths of a camera's lens and film are tenths of the stage's unit

Floats = NDArray[np.float64]
Read = TypeVar("Read")


class Modules(NamedTuple):
    """The parts of the library that reading needs."""

    Usd: Any
    UsdGeom: Any
    UsdLux: Any
    UsdShade: Any
    UsdSkel: Any
    UsdUtils: Any
    Ar: Any


def read(
    data: bytes,
    path: str | os.PathLike[str],
    *,
    limits: Limits = DEFAULT,
    notes: Notes | None = None,
    sources: Sources | None = None,
) -> Scene:
    """Read a stage.

    Parameters
    ----------
    data : bytes
        Its first bytes are looked at; the library reads the file itself.
    path : str or path-like
        Layers and pictures that it refers to must lie in its folder or below.
    limits, notes, sources : optional

    Raises FileFormatError where the library cannot read it, UnsupportedError, with what to install, where that is missing.
    """
    notes = notes if notes is not None else Notes()
    sources = sources if sources is not None else Sources(path, limits)
    try:
        modules = Modules(*(importlib.import_module(f"pxr.{name}") for name in Modules._fields))
    except ImportError:
        raise UnsupportedError(f'{os.fspath(path)}: reading USD needs its library: pip install "limner[usd]"') from None
    said = modules.UsdUtils.CoalescingDiagnosticDelegate()
    try:
        stage = modules.Usd.Stage.Open(os.fspath(path))
    except Exception as error:  # a parser on a foreign file may raise anything
        raise FileFormatError(f"OpenUSD cannot read it: {_reason(error)}", path) from None
    _check_layers(stage, Path(path))
    _bake_skins(stage, modules, notes)
    for one in said.TakeUncoalescedDiagnostics():
        notes.slip(f"OpenUSD says: {one.commentary}"[:200], kind="ignored")
    try:
        return _Reader(stage, modules, sources, notes).scene()
    except RecursionError:
        raise FileFormatError("its prims are nested too deeply to be read", path) from None


def _reason(error: Exception) -> str:
    """What the library objects to first, without where in its own sources it does."""
    said = re.search(r"in file \S+ : '(.*)", str(error))
    text = said[1].rstrip("'") if said else str(error)
    return " ".join(text.split())[:200] or type(error).__name__


def _check_layers(stage: Any, path: Path) -> None:
    folder = path.resolve().parent
    for layer in stage.GetUsedLayers():
        if not layer.timeCodesPerSecond > 0.0:
            # The library would map times of one layer to those of another for ever.
            raise FileFormatError(f"timeCodesPerSecond must be positive, got {layer.timeCodesPerSecond:g}", path)
        place = layer.realPath.partition("[")[0]
        if place and not Path(place).resolve().is_relative_to(folder):
            remedy = "`usdcat --flatten` makes one file of all"
            raise FileFormatError(f"a layer must stay inside the model's folder, got {quoted(place)}; {remedy}", path)


def _bake_skins(stage: Any, modules: Modules, notes: Notes) -> None:
    """Let the library lead skinned points by their skeletons: afterwards they have keys as any others have."""
    if not any(prim.IsA(modules.UsdSkel.Root) for prim in stage.Traverse()):
        return
    # Not into the layers of the file, which the library may show others.
    stage.SetEditTarget(modules.Usd.EditTarget(stage.GetSessionLayer()))
    try:
        done = modules.UsdSkel.BakeSkinning(modules.Usd.PrimRange(stage.GetPseudoRoot()))
    except Exception:  # a library on a foreign file may raise anything
        done = False
    if done:
        notes.add("skins are led at the keys of their skeletons, and go straight between them", kind="approximated")
    else:
        notes.slip("skins are shown as they are at rest")


class _Moving(NamedTuple):
    """What changes about a node, until its path is known."""

    node: Node
    motion: KeyedMotion | None
    visible: Track | None
    weights: Track | None


class _Reader:
    """One stage while it is read."""

    def __init__(self, stage: Any, modules: Modules, sources: Sources, notes: Notes) -> None:
        self._stage = stage
        self._modules = modules
        self._sources = sources
        self._notes = notes
        self._time = modules.Usd.TimeCode.EarliestTime()
        self._meters = float(modules.UsdGeom.GetStageMetersPerUnit(stage))
        self._z_up = str(modules.UsdGeom.GetStageUpAxis(stage)) == "Z"
        if not (math.isfinite(self._meters) and self._meters > 0.0):
            notes.slip(f"metersPerUnit of {self._meters:g} is taken for 1", kind="repaired")
            self._meters = 1.0
        self._materials = Materials(modules, sources, notes)
        self._geometries = Geometries(modules, sources, notes, self._time)
        self._lights = Lights(modules, sources, notes, self._time)
        self._moving: list[_Moving] = []
        self._prototypes: dict[tuple[str, str], tuple[Node, ...]] = {}
        self._spreading: set[str] = set()
        self._n_nodes = 0

    def scene(self) -> Scene:
        """Read everything."""
        world = np.diag([self._meters, self._meters, self._meters, 1.0]) @ (_Y_UP_FROM_Z_UP if self._z_up else np.eye(4))
        children = self._children(self._stage.GetPseudoRoot(), None, world, 0)
        root = Node(parent_from_node=world, children=children)
        environment = self._lights.environment
        return Scene(
            root,
            background=None if environment is None else "environment",
            environment=environment,
            name=self._sources.path.stem,
            animations=self._animations(root),
            notes=self._notes.lines(),
        )

    def _children(self, prim: Any, bound: Any, world: Floats, depth: int) -> tuple[Node, ...]:
        if depth > MAX_DEPTH:
            raise FileFormatError(f"the stage must not be deeper than {MAX_DEPTH} prims", self._sources.path, str(prim.GetPath()))
        found = (self._node(child, bound, world, depth + 1) for child in prim.GetChildren())
        return tuple(node for node in found if node is not None)

    def _count(self, n: int, prim: Any) -> None:
        self._n_nodes += n
        limit = self._sources.limits.max_nodes
        if self._n_nodes > limit:
            raise FileFormatError(f"has more than {limit} nodes (max_nodes)", self._sources.path, str(prim.GetPath()))

    def _node(self, prim: Any, bound: Any, world: Floats, depth: int) -> Node | None:
        geometry = self._modules.UsdGeom
        path = str(prim.GetPath())
        if prim.IsA(self._modules.UsdShade.Material) or prim.IsA(self._modules.UsdShade.Shader) or prim.IsA(geometry.Subset):
            return None
        self._count(1, prim)
        if prim.IsA(geometry.Imageable) and str(geometry.Imageable(prim).GetPurposeAttr().Get()) in _HIDDEN_PURPOSES:
            self._notes.add("prims for guides and proxies are left out", path)
            return None
        own = self._materials.bound_to(prim)
        bound = bound if own is None else own
        resting: tuple[Floats, KeyedMotion | None] = np.eye(4), None
        matrix, motion = self._read(resting, path, lambda: self._place(prim, world))
        node_world = world @ matrix
        nothing: tuple[Standing, ...] = ()
        dark: Found = (), ()
        unseen: tuple[Camera, ...] = ()
        standing = self._read(nothing, path, lambda: self._geometries.shapes(prim, bound, self._materials))
        lights, glow = self._read(dark, path, lambda: self._lights.of(prim, node_world))
        standing += glow
        node = Node(
            prim.GetName(), matrix, tuple(one.shape for one in standing if one.node_from_shape is None), lights,
            self._read(unseen, path, lambda: self._cameras(prim, node_world)),
            children=tuple(Node("", one.node_from_shape, (one.shape,)) for one in standing if one.node_from_shape is not None)
            + self._below(prim, bound, node_world, depth),
            visible=self._visible_at(prim, self._time),
        )  # fmt: skip
        shown, weights = self._visibility(prim), self._weights(standing)
        if motion is not None or shown is not None or weights is not None:
            self._moving.append(_Moving(node, motion, shown, weights))
        return node

    def _read(self, otherwise: Read, path: str, read: Callable[[], Read]) -> Read:
        """What is read of a prim; nothing of what cannot be, be it that a value is of another kind than its schema says."""
        try:
            return read()
        except LimnerError as error:
            self._notes.slip(f"left out: {without_path(error)}", path, kind="ignored")
        except (ArithmeticError, LookupError, TypeError, ValueError) as error:  # what NumPy says of values of a wrong kind or number
            self._notes.slip(f"left out: a value is not as its schema says: {' '.join(str(error).split())[:120]}", path, kind="ignored")
        return otherwise

    def _below(self, prim: Any, bound: Any, world: Floats, depth: int) -> tuple[Node, ...]:
        """What stands under a prim: its children, those of the prototype that it is an instance of, or what it spreads."""
        if prim.IsA(self._modules.UsdGeom.PointInstancer):
            return self._spread(prim, bound, world, depth)
        if prim.IsInstance():
            prototype = prim.GetPrototype()
            key = str(prototype.GetPath()), "" if bound is None else str(bound.GetPath())
            if key not in self._prototypes:
                self._prototypes[key] = self._children(prototype, bound, world, depth)
            return self._prototypes[key]
        return self._children(prim, bound, world, depth)

    # Instances of a PointInstancer

    def _spread(self, prim: Any, bound: Any, world: Floats, depth: int) -> tuple[Node, ...]:
        instancer = self._modules.UsdGeom.PointInstancer(prim)
        which = instancer.GetProtoIndicesAttr().Get(self._time)
        targets = instancer.GetPrototypesRel().GetForwardedTargets()
        if not which or not targets:
            self._notes.add("an instancer without instances is left out", str(prim.GetPath()))
            return ()
        self._count(len(which), prim)
        prototypes = [self._prototype(self._stage.GetPrimAtPath(target), bound, world, depth) for target in targets]
        kind = self._modules.UsdGeom.PointInstancer
        places = instancer.ComputeInstanceTransformsAtTime(self._time, self._time, kind.ExcludeProtoXform, kind.IgnoreMask)
        matrices = np.array(places, dtype=np.float64).reshape(-1, 4, 4).transpose(0, 2, 1)
        mask = list(instancer.ComputeMaskAtTime(self._time)) or [True] * len(matrices)
        if instancer.GetPositionsAttr().ValueMightBeTimeVarying():
            self._notes.add("an instancer that moves is shown at rest", str(prim.GetPath()), kind="approximated")
        made = []
        for k, (matrix, of, shown) in enumerate(zip(matrices, which, mask, strict=False)):
            prototype = prototypes[of] if 0 <= of < len(prototypes) else None
            if shown and prototype is not None and np.isfinite(matrix).all():
                made.append(Node(str(k), matrix, children=(prototype,)))
        return tuple(made)

    def _prototype(self, prim: Any, bound: Any, world: Floats, depth: int) -> Node | None:
        path = str(prim.GetPath()) if prim else ""
        if not prim or path in self._spreading:
            self._notes.slip("a prototype that is not there, or that spreads itself, is left out", path)
            return None
        self._spreading.add(path)
        node = self._node(prim, bound, world, depth)
        self._spreading.discard(path)
        # A prototype is shown where it is spread, whether it is hidden where it stands or not.
        return node if node is None or node.visible else dataclasses.replace(node, visible=True)

    # Places and moves

    def _place(self, prim: Any, world: Floats) -> tuple[Floats, KeyedMotion | None]:
        """Where a prim stands in its parent, and how it moves."""
        form = self._modules.UsdGeom.Xformable(prim)
        if not prim.IsA(self._modules.UsdGeom.Xformable):
            return np.eye(4), None
        matrix = self._matrix(form, self._time, prim)
        if form.GetResetXformStack():
            above = np.diag([self._meters, self._meters, self._meters, 1.0]) @ (_Y_UP_FROM_Z_UP if self._z_up else np.eye(4))
            return np.linalg.pinv(world) @ above @ matrix, None
        if not form.TransformMightBeTimeVarying():
            return matrix, None
        return matrix, self._motion(form, prim)

    def _matrix(self, form: Any, time: Any, prim: Any) -> Floats:
        # Gf matrices act on rows.
        matrix = np.array(form.GetLocalTransformation(time), dtype=np.float64).T
        if np.isfinite(matrix).all() and np.allclose(matrix[3], (0.0, 0.0, 0.0, 1.0)):
            return matrix
        self._notes.slip("a transform that is not affine is ignored", str(prim.GetPath()))
        return np.eye(4)

    def _motion(self, form: Any, prim: Any) -> KeyedMotion:
        codes = np.array(form.GetTimeSamples(), dtype=np.float64)
        # Between two samples angles go straight, which keys of whole poses would cut short: every frame becomes a key.
        n_frames = math.floor(codes[-1]) - math.ceil(codes[0]) + 1
        if 0 < n_frames <= _MOST_KEYS:
            codes = np.union1d(codes, math.ceil(codes[0]) + np.arange(n_frames))
        matrices = np.stack([self._matrix(form, float(code), prim) for code in codes])
        scale = np.linalg.norm(matrices[:, :3, :3], axis=1)
        scale[:, 0] *= np.where(np.linalg.det(matrices[:, :3, :3]) < 0.0, -1.0, 1.0)
        axes = matrices[:, :3, :3] / np.where(scale == 0.0, 1.0, scale)[:, None, :]
        if np.abs(axes.transpose(0, 2, 1) @ axes - np.eye(3)).max() > _SHEARED and (scale != 0.0).all():
            self._notes.add("a motion that shears is shown without", str(prim.GetPath()), kind="approximated")
        left, _, right = np.linalg.svd(axes)
        turns = left @ right
        rotation = np.stack([quaternion.from_matrix(turn) for turn in turns])
        times = codes / (float(self._stage.GetTimeCodesPerSecond()) or 24.0)
        return KeyedMotion(Track(times, matrices[:, :3, 3]), Track(times, rotation, rotates=True), Track(times, scale))

    def _visible_at(self, prim: Any, time: Any) -> bool:
        form = self._modules.UsdGeom.Imageable(prim)
        return not prim.IsA(self._modules.UsdGeom.Imageable) or str(form.GetVisibilityAttr().Get(time)) != "invisible"

    def _visibility(self, prim: Any) -> Track | None:
        """When a prim is seen; None where that does not change."""
        if not prim.IsA(self._modules.UsdGeom.Imageable):
            return None
        attribute = self._modules.UsdGeom.Imageable(prim).GetVisibilityAttr()
        codes = attribute.GetTimeSamples()
        if len(codes) < 2:
            return None
        times = np.array(codes) / (float(self._stage.GetTimeCodesPerSecond()) or 24.0)
        return Track(times, np.array([float(self._visible_at(prim, code)) for code in codes]), "step")

    def _weights(self, standing: tuple[Standing, ...]) -> Track | None:
        """Keys for what bends: at each code one morph alone, at the first none, so that points go straight from one to the next."""
        codes = next((one.codes for one in standing if one.codes), ())
        if not codes:
            return None
        return Track(np.array(codes) / (float(self._stage.GetTimeCodesPerSecond()) or 24.0), np.eye(len(codes))[:, 1:])

    def _animations(self, root: Node) -> tuple[Animation, ...]:
        if not self._moving:
            return ()
        by_node = {id(moving.node): moving for moving in self._moving}
        channels: list[Channel] = []
        for placed in root.walk():
            moving = by_node.get(id(placed.node))
            if moving is not None and moving.motion is not None:
                channels.append(NodeChannel(placed.path, moving.motion))
            if moving is not None and moving.visible is not None:
                channels.append(FieldChannel("node", placed.path, "visible", moving.visible))
            if moving is not None and moving.weights is not None:
                channels.append(WeightsChannel(placed.path, moving.weights))
        return (Animation("", tuple(channels)),) if channels else ()

    # Cameras

    def _cameras(self, prim: Any, world: Floats) -> tuple[Camera, ...]:
        if not prim.IsA(self._modules.UsdGeom.Camera):
            return ()
        camera = self._modules.UsdGeom.Camera(prim).GetCamera(self._time)
        unit = float(abs(np.linalg.det(world[:3, :3])) ** (1.0 / 3.0)) or 1.0
        across, upwards = float(camera.horizontalAperture), float(camera.verticalAperture)
        near, far = float(camera.clippingRange.min) * unit, float(camera.clippingRange.max) * unit
        fields: dict[str, Any] = {
            "name": prim.GetName(), "aspect": across / upwards if upwards > 0.0 else None,
            "near": near if 0.0 < near < far else None, "far": far if 0.0 < near < far else None,
            "shift_x": 2.0 * float(camera.horizontalApertureOffset) / across if across > 0.0 else 0.0,
            "shift_y": 2.0 * float(camera.verticalApertureOffset) / upwards if upwards > 0.0 else 0.0,
        }  # fmt: skip
        try:
            if str(camera.projection).endswith("Orthographic"):
                return (OrthographicCamera(height=upwards * _TENTH * unit, **fields),)
            focal, stop, focus = float(camera.focalLength), float(camera.fStop), float(camera.focusDistance)
            if stop > 0.0 and focus > 0.0:
                fields |= {"aperture_radius": focal * _TENTH * unit / (2.0 * stop), "focus_distance": focus * unit}
            return (PerspectiveCamera(yfov_degrees=math.degrees(2.0 * math.atan2(upwards, 2.0 * focal)), **fields),)
        except LimnerError as error:
            self._notes.slip(f"a camera is left out: {error}", str(prim.GetPath()), kind="ignored")
            return ()
