"""What changes with time, beside the scene that it changes (FoCG 16; glTF 2.0, 3.11; KHR_animation_pointer).

An animation is a list of channels. Each names what it changes: a node by its path ("world/car/wheel"), a material, light or camera by
its name. `limner.scene.pose` applies them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from ..errors import SceneError
from .motion import KeyedMotion
from .track import Track

__all__ = ["Animation", "Channel", "FieldChannel", "NodeChannel", "WeightsChannel"]

Kind = Literal["node", "material", "light", "camera"]


@dataclass(frozen=True)
class NodeChannel:
    """Where a node stands in its parent's space; what does not move of it has a track of one key.

    Parameters
    ----------
    target : str
        The node's path.
    motion : KeyedMotion
        In place of the node's own `parent_from_node`.
    """

    target: str
    motion: KeyedMotion


@dataclass(frozen=True)
class WeightsChannel:
    """How far the meshes of a node are morphed.

    Parameters
    ----------
    target : str
        The node's path.
    weights : Track
        One number for each morph.
    """

    target: str
    weights: Track


@dataclass(frozen=True)
class FieldChannel:
    """A number or several of a node, material, light or camera.

    Parameters
    ----------
    kind : "node" | "material" | "light" | "camera"
    target : str
        The node's path, or the name of all else: every material of that name changes.
    field : str
        Such as "roughness", "intensity", "yfov_degrees", "visible"; "base_color_texture.offset" for what lies deeper.
    track : Track
        As many numbers as the field has; above 1/2 a flag is set.
    """

    kind: Kind
    target: str
    field: str
    track: Track

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind):
            raise SceneError(f"channel.kind must be one of {', '.join(get_args(Kind))}, got {self.kind!r}")


Channel: TypeAlias = NodeChannel | WeightsChannel | FieldChannel


@dataclass(frozen=True)
class Animation:
    """One clip: "Walk", "Run".

    Parameters
    ----------
    name : str
    channels : tuple of NodeChannel, WeightsChannel and FieldChannel
    """

    name: str = ""
    channels: tuple[Channel, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", tuple(self.channels))
        for channel in self.channels:
            if not isinstance(channel, Channel):
                raise SceneError(f"animation.channels must be channels, got {type(channel).__name__}", self.name)

    @property
    def start(self) -> float:
        """The time of the first key, seconds; 0 where there is none."""
        return min((float(track.times[0]) for track in self.tracks()), default=0.0)

    @property
    def end(self) -> float:
        """The time of the last key, seconds."""
        return max((float(track.times[-1]) for track in self.tracks()), default=0.0)

    def tracks(self) -> Iterator[Track]:
        """The tracks that change something."""
        for channel in self.channels:
            if isinstance(channel, NodeChannel):
                motion = channel.motion
                found: tuple[Track, ...] = (motion.translation, motion.rotation, motion.scale)
            else:
                found = (channel.weights if isinstance(channel, WeightsChannel) else channel.track,)
            yield from (track for track in found if not track.is_constant)
