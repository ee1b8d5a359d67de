"""Animations of a glTF file (glTF 2.0, 3.11), of nodes and, by KHR_animation_pointer, of much else."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import LimnerError, SceneError
from ..linear.decompose import trs
from ..scene.animation import Animation, Channel, FieldChannel, NodeChannel, WeightsChannel
from ..scene.motion import KeyedMotion
from ..scene.track import Interpolation, Track
from .accessors import Accessors
from .document import Element
from .gltf_material import turned_transform
from .gltf_material_parts import DISPERSION, IOR, NORMAL_SCALE, PARTS
from .gltf_tracks import dense, together
from .notes import Notes, quoted, without_path

__all__ = ["Animations", "Names"]

_INTERPOLATIONS: dict[str, Interpolation] = {"STEP": "step", "LINEAR": "linear", "CUBICSPLINE": "cubic"}
_WIDTHS = {"translation": 3, "rotation": 4, "scale": 3}
_TRANSFORM_WIDTHS = {"offset": 2, "rotation": 1, "scale": 2}
_TEXTURES = {
    "pbrMetallicRoughness/baseColorTexture": "base_color_texture",
    "pbrMetallicRoughness/metallicRoughnessTexture": "metallic_roughness_texture",
    "normalTexture": "normal_texture",
    "occlusionTexture": "occlusion_texture",
    "emissiveTexture": "emissive_texture",
    **{f"extensions/{part.extension}/{key}": f"{part.field}.{ours}" for part in PARTS for key, (ours, _) in part.textures.items()},
}
_PLAIN = {
    "pbrMetallicRoughness/metallicFactor": ("metallic", 1),
    "pbrMetallicRoughness/roughnessFactor": ("roughness", 1),
    "alphaCutoff": ("alpha_cutoff", 1),
    "normalTexture/scale": ("normal_scale", 1),
    "occlusionTexture/strength": ("occlusion_strength", 1),
    f"extensions/{IOR}/ior": ("ior", 1),
    f"extensions/{DISPERSION}/dispersion": ("dispersion", 1),
    "extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale": (f"clearcoat.{NORMAL_SCALE}", 1),
    **{f"extensions/{part.extension}/{key}": (f"{part.field}.{ours}", 1) for part in PARTS for key, (ours, _) in part.numbers.items()},
    **{f"extensions/{part.extension}/{key}": (f"{part.field}.{ours}", 3) for part in PARTS for key, (ours, _) in part.colors.items()},
}
"""Of what a pointer says about a material: our field, and how many numbers it has."""
_STRENGTH = "extensions/KHR_materials_emissive_strength/emissiveStrength"
_IN_PARTS = {
    ("materials", "emissiveFactor"): ("emission", 3),
    ("materials", _STRENGTH): ("emission", 1),
    ("cameras", "orthographic/xmag"): ("lens", 1),
    ("cameras", "orthographic/ymag"): ("lens", 1),
}
"""Of what is no field of ours by itself: what it is a part of, and how many numbers it has."""
_DENSE = 32  # keys for each of the file's, where what is linear there is not so here

Floats = NDArray[np.float64]
_Moved = dict[int, dict[str, Track]]  # of each node: translation, rotation, scale


class Names(NamedTuple):
    """What things of the file are called in the scene: paths of nodes, names of materials, lights and cameras, by their index."""

    nodes: Mapping[int, str]
    materials: Callable[[int], str]
    lights: Callable[[int], str]
    cameras: Callable[[int], str]


class Animations:
    """The animations of one glTF file.

    Parameters
    ----------
    root : Element
        The document.
    """

    def __init__(self, root: Element, accessors: Accessors, notes: Notes) -> None:
        self._root = root
        self._animations = root.array("animations")
        self._nodes = root.array("nodes")
        self._accessors = accessors
        self._notes = notes
        # What fields of ours are made of together, in one animation, by where it stands: of each material's textures offset, rotation and
        # scale; of materials emissive factor and strength; of cameras xmag and ymag; of nodes and meshes single weights.
        self._parts: dict[tuple[str, int, str], dict[str, Track]] = {}

    def pointed_at(self, collection: str) -> set[int]:
        """Which materials, cameras or lights are animated: their index after "/materials/"."""
        found = set()
        for animation in self._animations:
            for channel in animation.array("channels"):
                pointer = _pointer_of(channel)
                if pointer.startswith(collection) and pointer[len(collection) :].split("/")[0].isdecimal():
                    found.add(int(pointer[len(collection) :].split("/")[0]))
        return found

    def read(self, names: Names) -> tuple[Animation, ...]:
        """All animations; a channel that cannot be read is left out, with a slip."""
        found = []
        for k, animation in enumerate(self._animations):
            channels = self._channels(animation, names)
            if channels:
                found.append(Animation(animation.name() or f"animation {k}", channels))
        return tuple(found)

    def _channels(self, animation: Element, names: Names) -> tuple[Channel, ...]:
        moved: _Moved = {}
        others: list[Channel] = []
        self._parts = {}
        samplers = animation.array("samplers")
        for channel in animation.array("channels"):
            try:
                self._read_channel(channel, samplers, names, moved, others)
            except LimnerError as error:
                self._notes.slip(f"an animation's channel is left out: {without_path(error)}", channel.pointer)
        for (kind, index, owner), tracks in self._parts.items():
            try:
                others.extend(self._put_together(kind, index, owner, tracks, names, others))
            except LimnerError as error:
                self._notes.slip(f"an animation's channels are left out: {without_path(error)}", f"/{kind}/{index}")
        nodes = [self._node_channel(index, tracks, names) for index, tracks in moved.items()]
        return (*(channel for channel in nodes if channel is not None), *others)

    def _read_channel(self, channel: Element, samplers: list[Element], names: Names, moved: _Moved, others: list[Channel]) -> None:
        target = channel.child("target")
        sampler = samplers[channel.child("sampler").index(len(samplers))]
        path = target.child("path").text()
        if path == "pointer":
            self._read_pointer(channel, sampler, names, moved, others)
            return
        if not target.has("node"):
            return  # 3.11: to be ignored
        index = target.child("node").index(len(self._nodes))
        self._read_node(index, path, sampler, names, moved, others, target)

    def _read_node(
        self, index: int, path: str, sampler: Element, names: Names, moved: _Moved, others: list[Channel], owner: Element
    ) -> None:
        if index not in names.nodes:
            self._notes.add("animations of nodes that the scene does not show are left out")
        elif path in _WIDTHS:
            moved.setdefault(index, {})[path] = self._track(sampler, _WIDTHS[path], rotates=path == "rotation")
        elif path == "weights":
            others.append(WeightsChannel(names.nodes[index], self._track(sampler, None)))
        else:
            raise owner.error(f"must be translation, rotation, scale or weights, got {quoted(path)}", "path")

    def _node_channel(self, index: int, tracks: dict[str, Track], names: Names) -> NodeChannel | None:
        try:
            rest = self._rest(self._nodes[index])
        except LimnerError as error:
            self._notes.slip(f"/nodes/{index} does not move: {without_path(error)}")
            return None
        found = {
            name: tracks.get(name) or Track.constant(value, rotates=name == "rotation")
            for name, value in zip(_WIDTHS, rest, strict=True)
        }  # fmt: skip
        return NodeChannel(names.nodes[index], KeyedMotion(found["translation"], found["rotation"], found["scale"]))

    def _rest(self, node: Element) -> tuple[ArrayLike, ArrayLike, ArrayLike]:
        """Where a node stands while nothing moves it."""
        if node.has("matrix"):
            matrix = np.array(node.get_numbers("matrix", (0.0,) * 16)).reshape(4, 4).T
            matrix[3] = (0.0, 0.0, 0.0, 1.0)
            try:
                parts = trs(matrix)
            except SceneError as error:
                raise node.error(str(error), "matrix") from None
            return parts.translation, parts.rotation, parts.size
        return (
            node.get_numbers("translation", (0.0, 0.0, 0.0)),
            node.get_numbers("rotation", (0.0, 0.0, 0.0, 1.0), -1e6, 1e6),
            node.get_numbers("scale", (1.0, 1.0, 1.0)),
        )

    # Keys

    def _track(self, sampler: Element, width: int | None, *, rotates: bool = False) -> Track:
        """A sampler's keys, `width` numbers each; None: as many as there are for each key."""
        mode = sampler.get_text("interpolation", "LINEAR")
        if mode not in _INTERPOLATIONS:
            raise sampler.error(f"must be one of {', '.join(_INTERPOLATIONS)}, got {quoted(mode)}", "interpolation")
        times = self._accessors.floats(sampler.child("input"), "SCALAR").reshape(-1).astype(np.float64)
        output = sampler.child("output")
        numbers = self._accessors.floats(output, "SCALAR", "VEC2", "VEC3", "VEC4").astype(np.float64).reshape(-1)
        rows = len(times) * (3 if mode == "CUBICSPLINE" else 1)
        if width is None:
            width = len(numbers) // rows
        if width < 1 or len(numbers) != rows * width:
            raise output.error(f"must have {rows} x {width} numbers for {len(times)} keys, got {len(numbers)}")
        values = numbers.reshape((len(times), 3, width) if mode == "CUBICSPLINE" else (len(times), width))
        if not (np.isfinite(times).all() and np.isfinite(values).all()):
            raise sampler.error("its times and values must be finite")
        later = np.concatenate([[True], times[1:] > np.maximum.accumulate(times)[:-1]])
        if not later.all():
            self._notes.slip(f"{int((~later).sum())} keys whose time is not after the one before are left out", sampler.pointer)
        return Track(times[later], values[later], _INTERPOLATIONS[mode], rotates=rotates)

    # KHR_animation_pointer

    def _read_pointer(self, channel: Element, sampler: Element, names: Names, moved: _Moved, others: list[Channel]) -> None:
        pointer = _pointer_of(channel)
        kind, _, rest = pointer.removeprefix("/extensions/KHR_lights_punctual").removeprefix("/").partition("/")
        number, _, field = rest.partition("/")
        collection = self._collections().get(kind)
        if collection is None or not number.isdecimal() or int(number) >= len(collection):
            raise channel.error(f"points to {quoted(pointer)}, which is not there or cannot be animated", "target")
        index = int(number)
        if kind == "nodes":
            if field == "extensions/KHR_node_visibility/visible":
                track = self._track(sampler, 1)
                if index in names.nodes:
                    others.append(FieldChannel("node", names.nodes[index], "visible", Track(track.times, track.values, "step")))
                return
            if _is_weight(field):
                self._parts.setdefault((kind, index, "weights"), {})[field] = self._track(sampler, 1)
                return
            self._read_node(index, field, sampler, names, moved, others, channel)
            return
        if kind == "meshes":
            self._read_weights_of_mesh(index, field, sampler, names, others, channel)
            return
        owner, _, part = field.partition("/extensions/KHR_texture_transform/")
        if kind == "materials" and owner in _TEXTURES and part in _TRANSFORM_WIDTHS:
            self._parts.setdefault((kind, index, owner), {})[part] = self._track(sampler, _TRANSFORM_WIDTHS[part])
            return
        if (kind, field) in _IN_PARTS:
            owner, width = _IN_PARTS[kind, field]
            self._parts.setdefault((kind, index, owner), {})[field] = self._track(sampler, width)
            return
        read = {"materials": self._of_material, "lights": self._of_light, "cameras": self._of_camera}[kind]
        made = read(collection[index], field, sampler)
        if made is None:
            self._notes.add(f"the animation of {quoted(field)} is left out", channel.pointer)
            return
        name = {"materials": names.materials, "lights": names.lights, "cameras": names.cameras}[kind](index)
        others.extend(FieldChannel(kind[:-1], name, ours, track) for ours, track in made.items())  # type: ignore[arg-type]

    def _read_weights_of_mesh(
        self, index: int, field: str, sampler: Element, names: Names, others: list[Channel], channel: Element
    ) -> None:
        """The morphs of a mesh: of every node that shows it, and has no weights of its own."""
        if _is_weight(field):
            self._parts.setdefault(("meshes", index, "weights"), {})[field] = self._track(sampler, 1)
            return
        if field != "weights":
            self._notes.add(f"the animation of {quoted(field)} is left out", channel.pointer)
            return
        track = self._track(sampler, None)
        others.extend(WeightsChannel(path, track) for path in self._shown_with_weights_of(index, names))

    def _shown_with_weights_of(self, mesh: int, names: Names) -> list[str]:
        """The paths of the nodes that show a mesh, and have no weights of their own."""
        return [
            path for number, path in names.nodes.items()
            if not self._nodes[number].has("weights") and self._nodes[number].has("mesh")
            and self._nodes[number].get_number("mesh", -1.0) == mesh
        ]  # fmt: skip

    def _put_together(
        self, kind: str, index: int, owner: str, tracks: dict[str, Track], names: Names, others: list[Channel]
    ) -> list[Channel]:
        """The channels of what was read in parts."""
        thing = self._collections()[kind][index]
        if kind in ("nodes", "meshes"):
            paths = [names.nodes[index]] if kind == "nodes" and index in names.nodes else []
            paths = paths if kind == "nodes" else self._shown_with_weights_of(index, names)
            return [WeightsChannel(path, self._with_weights(kind, index, tracks, path, others)) for path in paths]
        if kind == "cameras":
            lens = thing.child("orthographic")
            return [FieldChannel("camera", names.cameras(index), *found) for found in _of_parallel_view(lens, tracks).items()]
        made = {"emission": self._of_emission(thing, tracks)} if owner == "emission" else self._of_transform(thing, owner, tracks)
        return [FieldChannel("material", names.materials(index), field, track) for field, track in made.items()]

    def _with_weights(self, kind: str, index: int, tracks: dict[str, Track], path: str, others: list[Channel]) -> Track:
        """The weights of a node of which some are animated one by one: the others are as another channel or the file has them."""
        whole = next((held for held in others if isinstance(held, WeightsChannel) and held.target == path), None)
        node = self._nodes[index] if kind == "nodes" else None
        mesh = self._root.array("meshes")[index] if node is None else self._root.array("meshes")[node.child("mesh").index(1 << 30)]
        rest = [0.0] * max(len(primitive.array("targets")) for primitive in mesh.array("primitives"))
        for owner in (mesh, node):
            if owner is not None and owner.has("weights"):
                given = [weight.number() for weight in owner.array("weights")]
                rest[: len(given)] = given[: len(rest)]
        parts: list[Track | list[float]] = [[weight] for weight in rest]
        if whole is not None:
            others.remove(whole)
            parts[: whole.weights.width] = [
                _mapped(whole.weights, lambda v, k=k: v[..., k : k + 1]) for k in range(min(whole.weights.width, len(rest)))  # type: ignore[misc]
            ]
        for field, track in tracks.items():
            number = int(field.removeprefix("weights/"))
            if number >= len(rest):
                raise mesh.error(f"has {len(rest)} morph targets, and an animation moves number {number}", "primitives")
            parts[number] = track
        return together(parts)

    def _of_emission(self, material: Element, tracks: dict[str, Track]) -> Track:
        """Emissive factor times strength."""
        given = material.extension("KHR_materials_emissive_strength")
        factor, strength = tracks.get("emissiveFactor"), tracks.get(_STRENGTH)
        if strength is None:
            assert factor is not None
            times = 1.0 if given is None else given.get_number("emissiveStrength", 1.0, 0.0)
            return _mapped(factor, lambda v: v * times)
        if factor is None:
            at_rest = np.array(material.get_numbers("emissiveFactor", (0.0, 0.0, 0.0), 0.0))
            return _mapped(strength, lambda v: v * at_rest)
        return _mapped(dense(together([factor, strength])), lambda v: v[..., :3] * v[..., 3:])

    def _collections(self) -> dict[str, list[Element]]:
        punctual = self._root.extension("KHR_lights_punctual")
        return {
            "nodes": self._nodes,
            "meshes": self._root.array("meshes"),
            "materials": self._root.array("materials"),
            "cameras": self._root.array("cameras"),
            "lights": [] if punctual is None else punctual.array("lights"),
        }

    def _of_material(self, material: Element, field: str, sampler: Element) -> dict[str, Track] | None:
        if field == "pbrMetallicRoughness/baseColorFactor":
            track = self._track(sampler, 4)
            return {"base_color": _mapped(track, lambda v: v[..., :3]), "alpha": _mapped(track, lambda v: v[..., 3:])}
        if field in _PLAIN:
            ours, width = _PLAIN[field]
            return {ours: self._track(sampler, width)}
        return None

    def _of_transform(self, material: Element, owner: str, tracks: Mapping[str, Track]) -> dict[str, Track]:
        """KHR_texture_transform turned to coordinates whose v points up, where our offset follows from all three (`turned_transform`)."""
        information: Element | None = material
        for key in owner.split("/"):
            information = None if information is None else information.get(key)
        given = None if information is None else information.extension("KHR_texture_transform")
        at_rest: dict[str, Any] = {"offset": (0.0, 0.0), "rotation": 0.0, "scale": (1.0, 1.0)}
        if given is not None:
            at_rest["offset"] = given.get_numbers("offset", (0.0, 0.0))
            at_rest["rotation"] = given.get_number("rotation", 0.0)
            at_rest["scale"] = given.get_numbers("scale", (1.0, 1.0))
        only = tracks.get("offset") if len(tracks) == 1 else None
        if only is None or only.interpolation == "cubic":
            tracks = _dense(tracks)
        first = next(iter(tracks.values()))
        made = []
        for k in range(len(first.times)):
            parts = at_rest | {part: track.values[k].tolist() for part, track in tracks.items()}
            rotation = parts["rotation"] if isinstance(parts["rotation"], float) else parts["rotation"][0]
            made.append(turned_transform(tuple(parts["offset"]), rotation, tuple(parts["scale"]))[0])
        ours = _TEXTURES[owner]
        found = {f"{ours}.offset": Track(first.times, np.array(made), first.interpolation)}
        return found | {f"{ours}.{part}": track for part, track in tracks.items() if part != "offset"}

    def _of_light(self, light: Element, field: str, sampler: Element) -> dict[str, Track] | None:
        if field == "color":
            return {"color": self._track(sampler, 3)}
        if field in ("intensity", "range"):
            return {field: self._track(sampler, 1)}
        cones = {"spot/innerConeAngle": "inner_degrees", "spot/outerConeAngle": "outer_degrees"}
        return {cones[field]: _mapped(self._track(sampler, 1), np.degrees)} if field in cones else None

    def _of_camera(self, camera: Element, field: str, sampler: Element) -> dict[str, Track] | None:
        numbers: dict[str, tuple[str, Callable[[Floats], Floats]]] = {
            "perspective/yfov": ("yfov_degrees", lambda v: v * (180.0 / math.pi)),
            "perspective/aspectRatio": ("aspect", lambda v: v),
            "perspective/znear": ("near", lambda v: v),
            "perspective/zfar": ("far", lambda v: v),
            "orthographic/znear": ("near", lambda v: v),
            "orthographic/zfar": ("far", lambda v: v),
        }
        if field not in numbers:
            return None
        ours, convert = numbers[field]
        return {ours: _mapped(self._track(sampler, 1), convert)}


def _pointer_of(channel: Element) -> str:
    """What a channel of KHR_animation_pointer points to; empty for all others and where it is not said rightly."""
    target = channel.get("target")
    given = target.extension("KHR_animation_pointer") if target is not None else None
    return "" if given is None else given.get_text("pointer")


def _is_weight(field: str) -> bool:
    """Whether a pointer says one weight of several."""
    return field.startswith("weights/") and field.removeprefix("weights/").isdecimal()


def _of_parallel_view(lens: Element, tracks: dict[str, Track]) -> dict[str, Track]:
    """Height and aspect of a camera whose xmag and ymag are animated, or one of them."""
    half_width, half_height = abs(lens.child("xmag").number()), abs(lens.child("ymag").number())
    wide, high = tracks.get("orthographic/xmag"), tracks.get("orthographic/ymag")
    if high is None:
        assert wide is not None
        return {"aspect": _mapped(wide, lambda v: np.abs(v) / half_height)}
    whole = dense(together([[half_width] if wide is None else wide, high]))
    # A height may pass through zero, where there is no aspect.
    aspect = _mapped(whole, lambda v: np.abs(v[..., :1]) / np.maximum(np.abs(v[..., 1:]), 1e-6))
    return {"height": _mapped(high, lambda v: 2.0 * v), "aspect": aspect}


def _mapped(track: Track, change: Callable[[Floats], Floats]) -> Track:
    """The same keys with other numbers, by a function that is linear."""
    return Track(track.times, change(track.values), track.interpolation)


def _dense(tracks: Mapping[str, Track]) -> dict[str, Track]:
    """The same with keys at the same times, so near to each other that straight lines between them are as good as what they came from.

    Where all stand still from key to key, the keys of all are enough.
    """
    times = np.unique(np.concatenate([track.times for track in tracks.values()]))
    steps = all(track.interpolation == "step" for track in tracks.values())
    if len(times) > 1 and not steps:
        times = np.unique(np.concatenate([np.linspace(a, b, _DENSE + 1) for a, b in pairwise(times)]))
    return {part: Track(times, track.at(times), "step" if steps else "linear") for part, track in tracks.items()}
