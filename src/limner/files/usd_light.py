"""Lights of USD: what shines is said as the radiance of a surface, whatever its size, unless it is normalised by that.

    radiance = intensity 2^exposure color     [/ size where normalised]
    sizes      sphere 4 pi r^2    disk pi r^2    rectangle w h    cylinder 2 pi r l    distant pi sin^2(angle / 2)

Sizes are those of the stage; lights of limner have theirs in metres, whatever stands above them.

**Source**: OpenUSD, UsdLux, *Quantities and Units*.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerError
from ..linear.transform import rotate
from ..scene.environment import Environment
from ..scene.light import DirectionalLight, DiskLight, Light, PointLight, RectangleLight, SphereLight, SpotLight
from ..scene.material import Lambert
from ..scene.shape import Cylinder, Shape
from .notes import Notes, quoted, without_path
from .sources import Sources
from .usd_mesh import Standing, along_axis

if TYPE_CHECKING:
    from .usd import Modules

__all__ = ["Found", "Lights"]

_UPRIGHT = 1e-3
_MOST_STOPS = 100.0

Found = tuple[tuple[Light, ...], tuple[Standing, ...]]


class Lights:
    """The lights of one stage.

    Attributes
    ----------
    environment : Environment or None
        That of its first dome.
    """

    def __init__(self, modules: Modules, sources: Sources, notes: Notes, time: Any) -> None:
        self._lux = modules.UsdLux
        self._geometry = modules.UsdGeom
        self._sources = sources
        self._notes = notes
        self._time = time
        self.environment: Environment | None = None

    def of(self, prim: Any, world: NDArray[np.float64]) -> Found:
        """The lights of a prim, and what else of it shines; `world` says how large it is."""
        if not prim.HasAPI(self._lux.LightAPI):
            return (), ()
        kind = str(prim.GetTypeName())
        light = self._lux.LightAPI(prim)
        color = np.array(light.GetColorAttr().Get(self._time), dtype=np.float64)
        if light.GetEnableColorTemperatureAttr().Get(self._time):
            color = color * np.array(self._lux.BlackbodyTemperatureAsRgb(light.GetColorTemperatureAttr().Get(self._time)))
        intensity = float(light.GetIntensityAttr().Get(self._time)) * _factor(float(light.GetExposureAttr().Get(self._time)))
        if light.GetFiltersRel().GetTargets():
            self._notes.add("filters of lights are ignored", str(prim.GetPath()))
        normalized = bool(light.GetNormalizeAttr().Get(self._time))
        r, g, b = np.clip(color, 0.0, None).tolist()
        tint = (float(r), float(g), float(b))
        unit = float(abs(np.linalg.det(world[:3, :3])) ** (1.0 / 3.0))
        if kind.startswith("DomeLight"):
            self._dome(prim, tint, intensity, world)
            return (), ()
        if kind == "DistantLight":
            angle = math.radians(float(self._lux.DistantLight(prim).GetAngleAttr().Get(self._time)))
            size = math.pi * math.sin(min(angle, math.pi) / 2.0) ** 2 if angle > 0.0 and not normalized else 1.0
            if angle > math.radians(1.0):
                self._notes.add("a distant light of some width casts sharp shadows", str(prim.GetPath()), kind="approximated")
            return (DirectionalLight(tint, intensity * size, prim.GetName()),), ()
        made = self._area(prim, kind, tint, intensity, normalized, unit)
        if made is None:
            self._notes.slip(f"{kind} is not supported", str(prim.GetPath()), kind="ignored", what=kind)
            return (), ()
        return made

    def _area(self, prim: Any, kind: str, tint: Any, intensity: float, normalized: bool, unit: float) -> Found | None:
        lux, time, name = self._lux, self._time, prim.GetName()
        if kind == "SphereLight":
            radius = float(lux.SphereLight(prim).GetRadiusAttr().Get(time))
            radiance = _spread(intensity, 4.0 * math.pi * radius**2, normalized)
            candela = radiance * math.pi * (radius * unit) ** 2
            cone = prim.GetAttribute("inputs:shaping:cone:angle")
            if cone and cone.HasAuthoredValue() and float(cone.Get(time)) < 90.0:
                outer = max(float(cone.Get(time)), 0.01)
                softness = prim.GetAttribute("inputs:shaping:cone:softness")
                inner = outer * (1.0 - min(max(float(softness.Get(time) or 0.0) if softness else 0.0, 0.0), 1.0))
                return (SpotLight(tint, candela, min(inner, 0.999 * outer), outer, name=name),), ()
            if lux.SphereLight(prim).GetTreatAsPointAttr().Get(time) or radius <= 0.0:
                return (PointLight(tint, candela if radius > 0.0 else intensity, name=name),), ()
            return (SphereLight(tint, radiance, radius * unit, name=name),), ()
        if prim.GetAttribute("inputs:shaping:cone:angle") and prim.GetAttribute("inputs:shaping:cone:angle").HasAuthoredValue():
            self._notes.add("the cone of a light with an area is ignored", str(prim.GetPath()))
        if kind == "DiskLight":
            radius = float(lux.DiskLight(prim).GetRadiusAttr().Get(time))
            return (DiskLight(tint, _spread(intensity, math.pi * radius**2, normalized), radius * unit, name=name),), ()
        if kind == "RectLight":
            light = lux.RectLight(prim)
            width, height = float(light.GetWidthAttr().Get(time)), float(light.GetHeightAttr().Get(time))
            if light.GetTextureFileAttr().Get(time):
                self._notes.add("the picture of a light is left out", str(prim.GetPath()))
            radiance = _spread(intensity, width * height, normalized)
            return (RectangleLight(tint, radiance, width * unit, height * unit, name=name),), ()
        if kind == "CylinderLight":
            light = lux.CylinderLight(prim)
            radius, length = float(light.GetRadiusAttr().Get(time)), float(light.GetLengthAttr().Get(time))
            radiance = _spread(intensity, 2.0 * math.pi * radius * length, normalized)
            glow = Lambert((0.0, 0.0, 0.0), emission=tuple(radiance * c for c in tint))
            self._notes.add("a cylinder that shines lights in path alone", str(prim.GetPath()), kind="approximated")
            return (), (Standing(Shape(Cylinder(radius, length, capped=False), (glow,)), along_axis("X")),)
        return None

    def _dome(self, prim: Any, tint: Any, intensity: float, world: NDArray[np.float64]) -> None:
        where = str(prim.GetPath())
        if self.environment is not None:
            self._notes.add("only the first dome light is shown, another is ignored", where)
            return
        asset = prim.GetAttribute("inputs:texture:file").Get(self._time)
        if not asset or not asset.path:
            self.environment = Environment(tuple(intensity * c for c in tint))
            return
        layout = prim.GetAttribute("inputs:texture:format").Get(self._time)
        if layout not in (None, "automatic", "latlong"):
            self._notes.slip(f"a dome light of the format {quoted(str(layout))} is not supported", where, kind="ignored")
            return
        try:
            place = self._sources.locate(asset.path.removeprefix("./"))
        except LimnerError as error:
            self._notes.slip(f"the picture of a dome light is left out: {without_path(error)}", where)
            return
        if not place.is_file():
            self._notes.slip(f"the picture {quoted(asset.path)} of a dome light is missing; it is left out", where)
            return
        if max(tint) - min(tint) > 1e-3:
            self._notes.add("the colour of a dome light with a picture is shown as grey", where, kind="approximated")
        turn = world[:3, :3] / np.linalg.norm(world[:3, :3], axis=0)
        pole = prim.GetAttribute("poleAxis")
        axis = str(pole.Get(self._time)) if pole else "Y"
        if axis == "Z" or (axis == "scene" and str(self._geometry.GetStageUpAxis(prim.GetStage())) == "Z"):
            turn = turn @ rotate((1.0, 0.0, 0.0), math.pi / 2.0)[:3, :3]
        if turn[1, 1] < 1.0 - _UPRIGHT:
            self._notes.add("a dome light that is tilted is shown upright", where, kind="approximated")
        # Its picture has +z in the middle and +x to the left; ours has +x in the middle and +z to the right.
        about_y = math.degrees(math.atan2(-turn[2, 0], turn[0, 0])) - 90.0
        self.environment = Environment(str(place), intensity * float(np.mean(tint)), about_y)


def _factor(exposure: float) -> float:
    """What an exposure multiplies by; beyond a hundred stops it makes no difference any more."""
    return 1.0 if math.isnan(exposure) else 2.0 ** min(max(exposure, -_MOST_STOPS), _MOST_STOPS)


def _spread(intensity: float, size: float, normalized: bool) -> float:
    """The radiance of a surface; a normalised light is spread over its size, if it has any."""
    return intensity / size if normalized and size > 0.0 else intensity
