"""Lights of Mitsuba scenes: points, spots, directions, skies, and shapes that shine.

A rectangle, a disk or a ball of even radiance becomes an area light, which every renderer of limner knows; any other shape that shines
becomes a surface with emission, which only `path` (and `ray` with `emitters`) takes for a light. Area lights reflect nothing, where the
surface in Mitsuba may.

Mitsuba's lights shine along +z of their own space, limner's along -z of their node, so what places them is turned about y by half a turn.

**Source**: the Mitsuba 3 documentation, *Emitters*.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerError
from ..linear import transform
from ..scene.environment import Environment, direction_from_uv
from ..scene.light import DirectionalLight, DiskLight, Light, PointLight, RectangleLight, SphereLight, SpotLight
from ..scene.material import Lambert, Material, MetallicRoughness
from ..scene.node import Node
from .mitsuba_properties import Properties
from .mitsuba_texture import Textures
from .mitsuba_xml import Element
from .notes import Notes, quoted, without_path
from .radiance import read_radiance
from .sources import Sources

__all__ = ["HALF_TURN", "Glow", "Lights", "area_light", "shining"]

Matrix = NDArray[np.float64]
Triple = tuple[float, float, float]

HALF_TURN = np.diag([-1.0, 1.0, -1.0, 1.0])
"""From limner's -z to Mitsuba's +z, for what looks or shines along it."""

_SKEW = 1e-5  # what rounding leaves of a right angle


@dataclasses.dataclass(frozen=True)
class Glow:
    """The radiance of a shape that shines, and the picture that multiplies it."""

    radiance: Triple
    texture: Element | None = None


class Lights:
    """The emitters of one scene.

    Parameters
    ----------
    sources : Sources
    notes : Notes
    textures : Textures
    """

    def __init__(self, sources: Sources, notes: Notes, textures: Textures) -> None:
        self._sources = sources
        self._notes = notes
        self._textures = textures
        self.environment: Environment | None = None

    def node(self, properties: Properties) -> Node | None:
        """The light in its place; None for skies, which are kept in `environment`, and for what is not read."""
        kind = properties.element.kind
        make = {"point": self._point, "spot": self._spot, "directional": self._directional, "collimated": self._directional}.get(kind)
        if make is not None:
            place, light = make(properties)
            self.note_unknown(properties)
            return Node(properties.element.id, place, lights=(light,))
        if kind in ("constant", "envmap"):
            self._sky(properties)
            self.note_unknown(properties)
            return None
        self._notes.slip(f"{properties.what} is left out: it is not read", properties.where, kind="ignored", what=properties.what)
        return None

    def glow(self, properties: Properties) -> Glow:
        """What an <emitter type="area"> in a shape says."""
        if properties.element.kind != "area":
            raise properties.error(f"a shape shines by an area emitter, got {quoted(properties.element.kind)}")
        child = properties.child("radiance")
        properties.skip("sampling_weight")
        self.note_unknown(properties)
        if child is not None and child.tag == "texture":
            return Glow((1.0, 1.0, 1.0), child)
        return Glow(properties.color("radiance", 1.0))

    def note_unknown(self, properties: Properties) -> None:
        """Say which properties make no difference here."""
        properties.skip("sampling_weight", "samples")
        for child in properties.unknown():
            self._notes.add(f"{properties.what}: {quoted(child.name)} is ignored", child.where, kind="ignored", what=properties.what)

    # Lights without a surface

    def _point(self, properties: Properties) -> tuple[Matrix, Light]:
        place = properties.transform("to_world")
        if properties.has("position"):
            place = transform.translate(*properties.point("position"))
        color, intensity = _split(self._color(properties, "intensity"))
        return place, PointLight(color, intensity, name=properties.element.id)

    def _spot(self, properties: Properties) -> tuple[Matrix, Light]:
        cutoff = properties.number("cutoff_angle", 20.0)
        beam = properties.number("beam_width", 0.75 * cutoff)
        if not 0.0 < cutoff <= 90.0:
            raise properties.error(f"cutoff_angle must lie in (0, 90] degrees, got {cutoff:g}")
        if beam < cutoff:
            text = "the edge of a spot fades as in glTF: with the square of the cosine instead of linearly with the angle"
            self._notes.add(text, properties.where, kind="approximated", what=properties.what)
        if properties.child("texture") is not None:
            self._notes.add("the picture that a spot projects is ignored", properties.where, kind="ignored", what=properties.what)
        color, intensity = _split(self._color(properties, "intensity"))
        # The cones must differ: a hundred-thousandth of the angle is an edge as sharp as any.
        inner = min(max(beam, 0.0), cutoff * (1.0 - 1e-5))
        light = SpotLight(color, intensity, inner_degrees=inner, outer_degrees=cutoff, name=properties.element.id)
        return _upright(properties.transform("to_world") @ HALF_TURN), light

    def _directional(self, properties: Properties) -> tuple[Matrix, Light]:
        place = properties.transform("to_world") @ HALF_TURN
        if properties.has("direction"):
            along = np.array(properties.point("direction", (0.0, 0.0, 1.0)))
            if not np.linalg.norm(along) > 0.0:
                raise properties.error("direction must not be zero", properties.child("direction"))
            place = np.eye(4)
            place[:3, :3] = transform.basis(-along)
        if properties.element.kind == "collimated":
            text = "a collimated beam is drawn as parallel light everywhere"
            self._notes.slip(text, properties.where, kind="replaced", what=properties.what)
        color, intensity = _split(self._color(properties, "irradiance"))
        return _upright(place), DirectionalLight(color, intensity, name=properties.element.id)

    def _color(self, properties: Properties, name: str) -> Triple:
        child = properties.child(name)
        if child is not None and child.tag == "texture":
            self._notes.add(f"the texture of {name} is drawn as one colour", properties.where, kind="approximated", what=properties.what)
            return self._textures.painted(child).color
        return properties.color(name, 1.0)

    # Skies

    def _sky(self, properties: Properties) -> None:
        if self.environment is not None:
            text = "a second sky is left out: a scene has one"
            self._notes.slip(text, properties.where, kind="ignored", what=properties.what)
            return
        if properties.element.kind == "constant":
            properties.skip("to_world")
            self.environment = Environment(self._color(properties, "radiance"))
            return
        name, scale = properties.text("filename"), properties.number("scale", 1.0)
        turn = properties.transform("to_world")
        properties.skip("mis_compensation")
        try:
            self._sources.read_beside(name, properties.where)
            path = self._sources.locate(name, properties.where)
            around_y = _turn_about_y(turn)
            if around_y is not None:
                self.environment = Environment(str(path), scale, around_y - 90.0)
                return
            picture = read_radiance(path, limits=self._sources.limits)
        except LimnerError as error:
            text = f"the sky is left out: {without_path(error)}"
            self._notes.slip(text, properties.where, kind="ignored", what=properties.what)
            return
        text = "a sky that is not turned about y alone is laid anew into an upright picture"
        self._notes.add(text, properties.where, kind="approximated", what=properties.what)
        self.environment = Environment(_laid_upright(picture, turn), scale)


def shining(material: Material | None, glow: Glow, textures: Textures) -> Material:
    """The surface of a shape that shines to its front only."""
    texture = None if glow.texture is None else textures.painted(glow.texture).texture
    if isinstance(material, Lambert):
        return dataclasses.replace(material, emission=glow.radiance, emission_texture=texture, double_sided=False)
    if isinstance(material, MetallicRoughness):
        return dataclasses.replace(material, emission=glow.radiance, emissive_texture=texture, double_sided=False)
    return Lambert((0.0, 0.0, 0.0), emission=glow.radiance, emission_texture=texture, double_sided=False)


def area_light(kind: str, world: Matrix, radiance: Triple, radius: float, *, flipped: bool, name: str) -> Node | None:
    """The area light that a rectangle, disk or sphere is, exactly; None where its place is sheared or uneven, or it is of another kind.

    `world`: of the rectangle [-1, 1]^2 or the unit disk in z = 0, or of a sphere of `radius` around the origin.
    """
    a, b, c = (world[:3, k] for k in range(3))
    lengths = np.array([np.linalg.norm(axis) for axis in (a, b, c)])
    if not lengths[:2].min() > 0.0 or abs(float(a @ b)) > _SKEW * lengths[0] * lengths[1]:
        return None
    color, intensity = _split(radiance)
    even = bool(abs(lengths[0] - lengths[1]) <= _SKEW * lengths[0])
    if kind == "sphere":
        skew = max(abs(float(a @ c)), abs(float(b @ c)))
        if flipped or not even or abs(lengths[2] - lengths[0]) > _SKEW * lengths[0] or skew > _SKEW * lengths[0] ** 2:
            return None
        place = transform.translate(*world[:3, 3])
        return Node(name, place, lights=(SphereLight(color, intensity, radius * float(lengths[0]), name=name),))
    if kind == "rectangle":
        light: Light = RectangleLight(color, intensity, 2.0 * float(lengths[0]), 2.0 * float(lengths[1]), name=name)
    elif kind == "disk" and even:
        light = DiskLight(color, intensity, float(lengths[0]), name=name)
    else:
        return None
    n = np.cross(a, b) * (1.0 if (np.linalg.det(world[:3, :3]) >= 0.0) != flipped else -1.0)
    w = -n / np.linalg.norm(n)
    place = np.eye(4)
    place[:3, 0], place[:3, 2], place[:3, 3] = a / lengths[0], w, world[:3, 3]
    place[:3, 1] = np.cross(w, place[:3, 0])
    return Node(name, place, lights=(light,))


def _split(color: Triple) -> tuple[Triple, float]:
    """A colour whose greatest channel is 1, and its intensity."""
    most = max(color)
    if not most > 0.0:
        return (1.0, 1.0, 1.0), 0.0
    red, green, blue = (c / most for c in color)
    return (red, green, blue), most


def _upright(place: Matrix) -> Matrix:
    """Without scale, which lights do not have; the gaze is kept."""
    from ..scene.lamp import light_frame

    return light_frame(place)


def _turn_about_y(matrix: Matrix) -> float | None:
    """The angle, degrees, of a rotation about y; None where it is anything else. A uniform scale is of no consequence."""
    m = matrix[:3, :3]
    size = float(np.linalg.norm(m[:, 1]))
    if not size > 0.0:
        return None
    angle = math.atan2(float(m[0, 2]), float(m[2, 2]))
    return math.degrees(angle) if np.allclose(m / size, transform.rotate_y(angle)[:3, :3], atol=1e-5) else None


def _laid_upright(picture: NDArray[np.float32], turn: Matrix) -> NDArray[np.float32]:
    """The picture of a sky as it is seen after a turn, in limner's layout, looked up bilinearly.

    Mitsuba's column is u = atan2(x, -z) / 2 pi and its row v = arccos(y) / pi, in the sky's own space.
    """
    height, width = picture.shape[:2]
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    d = direction_from_uv(np.stack([u, v], axis=-1)) @ np.linalg.inv(turn[:3, :3]).T
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    column = np.arctan2(d[..., 0], -d[..., 2]) / (2.0 * np.pi) * width - 0.5
    row = np.arctan2(np.hypot(d[..., 0], d[..., 2]), d[..., 1]) / np.pi * height - 0.5
    left, top = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
    across, down = (column - left)[..., None], (row - top)[..., None]
    rows, columns = np.clip([top, top + 1], 0, height - 1), np.mod([left, left + 1], width)
    upper = picture[rows[0], columns[0]] * (1.0 - across) + picture[rows[0], columns[1]] * across
    lower = picture[rows[1], columns[0]] * (1.0 - across) + picture[rows[1], columns[1]] * across
    return np.asarray(upper * (1.0 - down) + lower * down, dtype=np.float32)
