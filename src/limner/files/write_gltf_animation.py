"""Animations into glTF (glTF 2.0, section 3.11; KHR_animation_pointer).

    NodeChannel      translation, rotation, scale; what does not move is the node's own place
    WeightsChannel   weights
    FieldChannel     a pointer into the document: "/materials/0/pbrMetallicRoughness/roughnessFactor"
    Node.motion      an animation of its own, "motion"

A field of ours is not always one of glTF's: base colour and alpha share a factor, emission is a factor times a strength, and the offset
of a texture depends on its rotation and scale where v is turned over. Such tracks are put together and converted key by key.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..linear.decompose import trs
from ..scene.animation import Animation, FieldChannel, NodeChannel, WeightsChannel
from ..scene.material import BlinnPhong, Lambert, MetallicRoughness
from ..scene.motion import KeyedMotion, Motion
from ..scene.scene import Scene
from ..scene.texture import Texture
from ..scene.track import Track
from .gltf_material_parts import DISPERSION, IOR, NORMAL_SCALE, PARTS, Part
from .gltf_tracks import dense, key_times, still, together
from .notes import Notes
from .write_gltf_buffers import Buffers, Json
from .write_gltf_camera import Cameras, Lights
from .write_gltf_exact import given_transform
from .write_gltf_material import TEXTURES, Materials, picture_of, plain_text
from .write_gltf_nodes import Stand

__all__ = ["Animations", "Moving", "moving"]

Floats = NDArray[np.float64]

_INTERPOLATIONS = {"step": "STEP", "linear": "LINEAR", "cubic": "CUBICSPLINE"}
_PARTS = ("translation", "rotation", "scale")
_UNIT = 1e-3  # how far a quaternion may be from unit length before it is made unit
_DENSE = 32  # keys between two, where what is to be converted does not go straight
_STRAIGHT = 1e-7  # how far a key may be from the line between its neighbours to be left out, as a share of the greatest
_FEW = 1024  # keys, up to which more are put between them
_LONGEST = 256  # keys that are left out in a row
_OWN_MOTION = "motion"
_VISIBLE = "extensions/KHR_node_visibility/visible"
_LENSES = {
    "near": ("znear", 1.0), "far": ("zfar", 1.0), "yfov_degrees": ("yfov", math.pi / 180.0), "height": ("ymag", 0.5),
    "aspect": ("aspectRatio", 1.0),
}  # fmt: skip
_CONES = {"inner_degrees": "spot/innerConeAngle", "outer_degrees": "spot/outerConeAngle"}


class Moving(NamedTuple):
    """What is animated: of each node's path the parts that stay as they are, the paths of nodes that come and go, and of the names of
    materials and lights each field with the greatest number that it takes."""

    nodes: dict[str, dict[str, Floats]]
    shown: set[str]
    materials: dict[str, dict[str, float]]
    lights: dict[str, dict[str, float]]


def moving(scene: Scene) -> Moving:
    """Find what the animations of a scene change, which decides how the rest is written."""
    found = Moving({}, set(), {}, {})
    for channel in (channel for animation in scene.animations for channel in animation.channels):
        if isinstance(channel, NodeChannel):
            kept = found.nodes.setdefault(channel.target, {})
            for name in _PARTS:
                track: Track = getattr(channel.motion, name)
                if track.is_constant:
                    kept.setdefault(name, _keys(track)[0])
        elif isinstance(channel, FieldChannel):
            if channel.kind == "node":
                found.shown.add(channel.target)
            group = {"material": found.materials, "light": found.lights}.get(channel.kind, {})
            fields = group.setdefault(channel.target, {})
            fields[channel.field] = max(fields.get(channel.field, 0.0), float(_keys(channel.track).max()))
    for placed in scene.root.walk():
        if placed.node.motion is not None:
            found.nodes.setdefault(placed.path, {})
    return found


def _keys(track: Track) -> Floats:
    """(k, n): a track's values, without tangents."""
    return track.values[:, 1] if track.interpolation == "cubic" else track.values


class Animations:
    """The animations of one file.

    Parameters
    ----------
    stands : mapping
        Where the nodes of the scene are in the file, by their paths.
    """

    def __init__(
        self, buffers: Buffers, stands: Mapping[str, Stand], materials: Materials, cameras: Cameras, lights: Lights, notes: Notes
    ) -> None:
        self._buffers = buffers
        self._stands = stands
        self._materials = materials
        self._cameras = cameras
        self._lights = lights
        self._notes = notes
        self.animations: list[Json] = []
        self.extensions: set[str] = set()

    def add(self, animation: Animation) -> None:
        """Write an animation; a channel that nothing in the file answers to is left out, with a note."""
        sheet = _Sheet(self._buffers, self._notes, animation)
        fields: dict[tuple[str, str], dict[str, Track]] = {}
        for channel in animation.channels:
            if isinstance(channel, FieldChannel):
                fields.setdefault((channel.kind, channel.target), {})[channel.field] = channel.track
            elif channel.target not in self._stands:
                self._notes.add("is animated, and there is no such node", channel.target)
            elif isinstance(channel, NodeChannel):
                self._add_node(sheet, self._stands[channel.target], channel.motion)
            else:
                self._add_weights(sheet, self._stands[channel.target], channel)
        for (kind, target), tracks in fields.items():
            self._add_fields(sheet, kind, target, tracks)
        if sheet.channels:
            name = {"name": plain_text(animation.name)} if animation.name else {}
            self.animations.append(name | {"channels": sheet.channels, "samplers": sheet.samplers})

    def add_motions(self, scene: Scene) -> None:
        """Write the motions that nodes have of their own as one animation."""
        channels = []
        for placed in scene.root.walk():
            motion = placed.node.motion
            if motion is None:
                continue
            keyed = _keyed(motion, placed.node.parent_from_node)
            if keyed is None:
                self._notes.add("its motion has shear, which glTF's cannot have, and is left out", placed.path)
            else:
                channels.append(NodeChannel(placed.path, keyed))
        if channels:
            self.add(Animation(_OWN_MOTION, tuple(channels)))

    # Nodes

    def _add_node(self, sheet: _Sheet, stand: Stand, motion: KeyedMotion) -> None:
        for name in _PARTS:
            track: Track = getattr(motion, name)
            if track.is_constant and stand.rest is not None and np.array_equal(_keys(track)[0], getattr(stand.rest, name)):
                continue
            sheet.add({"node": stand.number, "path": name}, _unit(track) if track.rotates else track)

    def _add_weights(self, sheet: _Sheet, stand: Stand, channel: WeightsChannel) -> None:
        for carrier, n_morphs in stand.carriers:
            if n_morphs:
                values = channel.weights.values[..., :n_morphs]
                widths = [(0, 0)] * (values.ndim - 1) + [(0, n_morphs - values.shape[-1])]
                track = Track(channel.weights.times, np.pad(values, widths), channel.weights.interpolation)
                sheet.add({"node": carrier, "path": "weights"}, track, flat=True)

    # Fields

    def _add_fields(self, sheet: _Sheet, kind: str, target: str, tracks: dict[str, Track]) -> None:
        write = {"node": self._of_node, "material": self._of_materials, "light": self._of_lights, "camera": self._of_cameras}[kind]
        left = set(tracks)
        for pointer, track, used in write(target, tracks):
            left -= used
            pointed = {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}
            sheet.add(pointed, track, flag=pointer.endswith(_VISIBLE))
            self.extensions.add("KHR_animation_pointer")
        if left:
            self._notes.add(f"the animation of {', '.join(sorted(left))} is left out", target)

    def _of_node(self, target: str, tracks: dict[str, Track]) -> Iterator[_Pointed]:
        if "visible" in tracks and target in self._stands:
            track = tracks["visible"]
            shown = Track(track.times, (_keys(track) > 0.5).astype(np.float64), "step")
            yield _Pointed(f"/nodes/{self._stands[target].number}/{_VISIBLE}", shown, {"visible"})

    def _of_lights(self, target: str, tracks: dict[str, Track]) -> Iterator[_Pointed]:
        for index, light, strength in self._lights.named(target):
            root = f"/extensions/KHR_lights_punctual/lights/{index}"
            for field, factor in (("color", 1.0 / strength), ("intensity", strength), ("range", 1.0)):
                if field in tracks and field in light:
                    yield _Pointed(f"{root}/{field}", _scaled(tracks[field], factor), {field})
            for field, pointer in _CONES.items():
                if field in tracks and "spot" in light:
                    yield _Pointed(f"{root}/{pointer}", _scaled(tracks[field], math.pi / 180.0), {field})

    def _of_cameras(self, target: str, tracks: dict[str, Track]) -> Iterator[_Pointed]:
        for index, camera in self._cameras.named(target):
            kind = camera["type"]
            for field, (theirs, factor) in _LENSES.items():
                if field in tracks and theirs in camera[kind]:
                    yield _Pointed(f"/cameras/{index}/{kind}/{theirs}", _scaled(tracks[field], factor), {field})
            if kind == "orthographic" and ("height" in tracks or "aspect" in tracks):
                yield _Pointed(f"/cameras/{index}/{kind}/xmag", _half_widths(camera[kind], tracks), {"height", "aspect"})

    def _of_materials(self, target: str, tracks: dict[str, Track]) -> Iterator[_Pointed]:
        for index, given, made in self._materials.named(target):
            root = f"/materials/{index}/"
            color = {Lambert: "color", BlinnPhong: "diffuse"}.get(type(given), "base_color")
            if color in tracks or "alpha" in tracks:
                factor = together([tracks.get(color, np.array(made.base_color)), tracks.get("alpha", np.array([made.alpha]))])
                yield _Pointed(root + "pbrMetallicRoughness/baseColorFactor", factor, {color, "alpha"})
            if "emission" in tracks:
                strength = self._materials.strength(index)
                yield _Pointed(root + "emissiveFactor", _scaled(tracks["emission"], 1.0 / strength), {"emission"})
            if made is given:
                yield from self._of_metallic_roughness(root, made, tracks)
            for field, pointer in TEXTURES.items():
                texture = picture_of(getattr(made, field))
                if texture is not None:
                    yield from _of_texture(f"{root}{pointer}/extensions/KHR_texture_transform/", field, texture, tracks)

    def _of_metallic_roughness(self, root: str, made: MetallicRoughness, tracks: dict[str, Track]) -> Iterator[_Pointed]:
        plain = {
            "metallic": "pbrMetallicRoughness/metallicFactor",
            "roughness": "pbrMetallicRoughness/roughnessFactor",
            "alpha_cutoff": "alphaCutoff",
            "normal_scale": "normalTexture/scale",
            "occlusion_strength": "occlusionTexture/strength",
        }
        there = {"normal_scale": picture_of(made.normal_texture), "occlusion_strength": picture_of(made.occlusion_texture)}
        for field, pointer in plain.items():
            if field in tracks and there.get(field, True) is not None:
                yield _Pointed(root + pointer, tracks[field], {field})
        for field, pointer in (("ior", f"{IOR}/ior"), ("dispersion", f"{DISPERSION}/dispersion")):
            if field in tracks:
                yield _Pointed(f"{root}extensions/{pointer}", tracks[field], {field})
        for part in PARTS:
            if getattr(made, part.field) is not None:
                yield from _of_part(f"{root}extensions/{part.extension}/", part, getattr(made, part.field), tracks)


class _Pointed(NamedTuple):
    """A track under a pointer into the document, and the fields that went into it."""

    pointer: str
    track: Track
    used: set[str]


class _Sheet:
    """The channels and samplers of one animation; what is alike is written once."""

    def __init__(self, buffers: Buffers, notes: Notes, animation: Animation) -> None:
        self._buffers = buffers
        self._notes = notes
        self._name = animation.name
        # Times of a file begin at 0 at the earliest.
        self._later = -min([0.0, *(float(track.times[0]) for track in animation.tracks())])
        if self._later:
            notes.add(f"begins before 0 and is moved by {self._later:g} s", animation.name)
        self.channels: list[Json] = []
        self.samplers: list[Json] = []

    def add(self, target: Json, track: Track, *, flat: bool = False, flag: bool = False) -> None:
        """Write a track; `flat`: every number is an element of its own; `flag`: zeros and ones."""
        times = np.maximum(track.times + self._later, 0.0).astype(np.float32)
        kept = np.concatenate([[True], times[1:] > np.maximum.accumulate(times)[:-1]])
        if not kept.all():
            self._notes.add("keys that are too near to each other for single precision are left out", self._name)
        values, interpolation = track.values[kept], track.interpolation
        if interpolation == "cubic" and len(values) == 1:
            values, interpolation = values[:, 1], "linear"
        rows = values.reshape(-1, track.width).astype(np.uint8 if flag else np.float32)
        output = rows.reshape(-1) if flat or track.width == 1 else rows
        sampler = {
            "input": self._buffers.accessor(times[kept], "keys", bounds=True),
            "interpolation": _INTERPOLATIONS[interpolation],
            "output": self._buffers.accessor(output, "keys"),
        }
        if sampler not in self.samplers:
            self.samplers.append(sampler)
        self.channels.append({"sampler": self.samplers.index(sampler), "target": target})


def _half_widths(lens: Json, tracks: dict[str, Track]) -> Track:
    """Half of what a parallel view is wide, whose height and aspect are animated."""
    whole = together([tracks.get("height", [2.0 * lens["ymag"]]), tracks.get("aspect", [lens["xmag"] / lens["ymag"]])])
    if "height" in tracks and "aspect" in tracks:
        whole = dense(whole)
        return Track(whole.times, whole.values[..., :1] * whole.values[..., 1:] / 2.0, whole.interpolation)
    factor = lens["xmag"] / lens["ymag"] / 2.0 if "height" in tracks else lens["ymag"]
    return _scaled(tracks["height" if "height" in tracks else "aspect"], factor)


# --- tracks ---------------------------------------------------------------------------------------------------------------


def _unit(track: Track) -> Track:
    """Quaternions of length 1; those that nearly are stay as they are."""
    length = np.linalg.norm(_keys(track), axis=1)
    if (np.abs(length - 1.0) <= _UNIT).all():
        return track
    shape = (-1, *(1,) * (track.values.ndim - 1))
    values = track.values / np.where(length > 0.0, length, 1.0).reshape(shape)
    values.reshape(len(length), -1, 4)[length <= 0.0, -1 if track.interpolation != "cubic" else 1] = (0.0, 0.0, 0.0, 1.0)
    return Track(track.times, values, track.interpolation, rotates=True)


def _scaled(track: Track, factor: float) -> Track:
    """The same keys with numbers in another unit."""
    return Track(track.times, track.values * factor, track.interpolation)


def _of_part(root: str, part: Part, value: Any, tracks: dict[str, Track]) -> Iterator[_Pointed]:
    """What moves of an extension, and of its textures."""
    for key, (ours, _) in (*part.numbers.items(), *part.colors.items()):
        field = f"{part.field}.{ours}"
        if field in tracks:
            yield _Pointed(root + key, tracks[field], {field})
    for key, (ours, _) in part.textures.items():
        texture = picture_of(getattr(value, ours))
        if texture is None:
            continue
        yield from _of_texture(f"{root}{key}/extensions/KHR_texture_transform/", f"{part.field}.{ours}", texture, tracks)
        scale = f"{part.field}.{NORMAL_SCALE}"
        if ours == "normal_texture" and scale in tracks:
            yield _Pointed(f"{root}{key}/scale", tracks[scale], {scale})


def _of_texture(root: str, field: str, texture: Texture, tracks: dict[str, Track]) -> Iterator[_Pointed]:
    """The three parts of KHR_texture_transform, of which the offset follows from all of ours (`given_transform`)."""
    given = {part: tracks[f"{field}.{part}"] for part in ("offset", "rotation", "scale") if f"{field}.{part}" in tracks}
    if not given:
        return
    used = {f"{field}.{part}" for part in given}
    if set(given) == {"offset"}:
        shift = np.array(given_transform((0.0, 0.0), texture.rotation, texture.scale)[0])
        at_rest = still(shift, given["offset"])
        yield _Pointed(root + "offset", Track(given["offset"].times, given["offset"].values * (1.0, -1.0) + at_rest,
                                              given["offset"].interpolation), used)  # fmt: skip
        return
    standing: dict[str, Any] = {"offset": texture.offset, "rotation": [texture.rotation], "scale": texture.scale}
    whole = together([given.get(part, np.array(standing[part], dtype=np.float64)) for part in standing])
    if whole.interpolation == "cubic":
        whole = dense(whole)
    offset = _given_offsets(whole)
    stays = float(np.ptp(offset, axis=0).max()) <= _STRAIGHT * max(float(np.abs(offset).max()), 1.0)
    if not stays and whole.interpolation == "linear" and len(whole.times) <= _FEW:
        # Between two keys ours goes straight, and what a file has along a curve.
        whole = dense(whole)
        offset = _given_offsets(whole)
    if not stays:
        yield _Pointed(root + "offset", _thinned(Track(whole.times, offset, whole.interpolation)), used)
    for part, values in (("rotation", whole.values[:, 2:3]), ("scale", whole.values[:, 3:])):
        if part in given:
            yield _Pointed(root + part, _thinned(Track(whole.times, values, whole.interpolation)), used)


def _given_offsets(whole: Track) -> Floats:
    """(k, 2): the offsets of KHR_texture_transform for (k, 5) of ours: offset, rotation, scale."""
    return np.array([given_transform((ou, ov), angle, (su, sv))[0] for ou, ov, angle, su, sv in whole.values.tolist()])


def _thinned(track: Track) -> Track:
    """A track without the keys that lie on the line between their neighbours."""
    if track.interpolation != "linear" or len(track.times) < 3:
        return track
    most = _STRAIGHT * max(float(np.abs(track.values).max()), 1.0)
    kept = [0]
    for k in range(1, len(track.times) - 1):
        if k - kept[-1] > _LONGEST:
            kept.append(k)
        span = slice(kept[-1] + 1, k + 1)
        line = Track(track.times[[kept[-1], k + 1]], track.values[[kept[-1], k + 1]])
        if np.abs(line.at(track.times[span]) - track.values[span]).max(initial=0.0) > most:
            kept.append(k)
    kept.append(len(track.times) - 1)
    return Track(track.times[kept], track.values[kept])


def _keyed(motion: Motion | KeyedMotion, parent_from_node: Floats) -> KeyedMotion | None:
    """A node's motion in its parent's space; None where it has shear."""
    if isinstance(motion, KeyedMotion) and np.array_equal(parent_from_node, np.eye(4)):
        return motion
    tracks = [motion.translation, motion.rotation, motion.scale] if isinstance(motion, KeyedMotion) else []
    keys = motion.times if isinstance(motion, Motion) else key_times([track for track in tracks if not track.is_constant] or tracks[:1])
    between = [np.linspace(a, b, _DENSE + 1) for a, b in pairwise(keys)]
    times = np.unique(np.concatenate([keys, *between]))
    try:
        parts = trs(parent_from_node @ motion.at(times))
    except SceneError:
        return None
    turns = parts.rotation.copy()
    for k in range(1, len(turns)):
        # Of the two quaternions that turn alike the one nearer to the last, or slerp would go the long way.
        turns[k] *= -1.0 if float(turns[k] @ turns[k - 1]) < 0.0 else 1.0
    return KeyedMotion(Track(times, parts.translation), Track(times, turns, rotates=True), Track(times, parts.size))
