"""Surfaces of USD: UsdPreviewSurface, which every program reads, as metallic-roughness.

Its inputs are numbers, or pictures of which one channel is looked at; ours has roughness and metallic in one picture, so that two become
one here. Texture coordinates count v upwards as ours do.

**Source**: Pixar Animation Studios, *UsdPreviewSurface Specification*, 2.6.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError, LimnerError
from ..scene.material import AlphaChannel, AlphaMode, Lambert, Material, MetallicRoughness
from ..scene.material_extensions import Clearcoat, Specular
from ..scene.texture import Texels, Texture, Wrap
from .notes import Notes, quoted, without_path
from .pictures import Pictures
from .sources import Sources

if TYPE_CHECKING:
    from .usd import Modules

__all__ = ["Materials"]

Triple = tuple[float, float, float]

_GREY: Triple = (0.8, 0.8, 0.8)
_OPAQUE_F0 = 0.04  # of an index of 1.5, which specular colours are measured by
_WRAPS: dict[str, Wrap] = {"clamp": "clamp", "mirror": "mirror", "black": "clamp"}
_CHANNELS: dict[str, AlphaChannel] = {"r": "r", "g": "g", "b": "b", "a": "alpha"}
_MOST_LINKS = 16  # from a surface to the picture that it shows


class _Picture(NamedTuple):
    """A picture that an input shows: the texture, which channel ("rgb", "r", …), and what its texels are multiplied by."""

    texture: Texture
    channel: str
    scale: tuple[float, float, float, float]


class Materials:
    """The materials of one stage, each read once."""

    def __init__(self, modules: Modules, sources: Sources, notes: Notes) -> None:
        self._shade = modules.UsdShade
        self._resolver = modules.Ar
        self._sources = sources
        self._notes = notes
        self._pictures = Pictures(sources.limits)
        self._made: dict[str, MetallicRoughness] = {}
        self._plain: dict[tuple[Any, ...], Material] = {}
        self._coordinates: dict[str, str] = {}
        self._packed: dict[tuple[Any, ...], Texels] = {}

    def bound_to(self, prim: Any) -> Any:
        """The material that a prim is bound to itself or from above; None where there is none."""
        found = self._shade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0].GetPrim()
        return found if found else None

    def of(self, prim: Any, color: Triple | None = None, alpha: float = 1.0) -> Material:
        """The material that a prim describes; without one, or where it cannot be read, a matte one of a colour."""
        surface = None if prim is None else self._surface(prim)
        if surface is not None:
            path = str(prim.GetPath())
            if path not in self._made:
                self._made[path] = self._read(surface, prim.GetName())
            return self._made[path]
        name = "" if prim is None else str(prim.GetName())
        key = color, alpha, name
        if key not in self._plain:
            self._plain[key] = Lambert(color or _GREY, alpha=alpha, alpha_mode="blend" if alpha < 1.0 else "opaque", name=name)
        return self._plain[key]

    def reads_display_color(self, prim: Any) -> bool:
        """Whether colours of the mesh are shown: there is no material, or it asks for them."""
        surface = None if prim is None else self._surface(prim)
        if surface is None:
            return True
        source = self._source(surface, "diffuseColor")
        return source is not None and self._varname(source[0]) == "displayColor"

    def coordinates_of(self, prims: list[Any]) -> str:
        """The name of the texture coordinates that the first of these materials with a picture asks for; empty: none."""
        for prim in prims:
            if prim is not None and self._surface(prim) is not None:
                self.of(prim)
                name = self._coordinates.get(str(prim.GetPath()), "")
                if name:
                    return name
        return ""

    def _surface(self, prim: Any) -> Any:
        shader = self._shade.Material(prim).ComputeSurfaceSource()[0]
        if shader and str(shader.GetShaderId()) == "UsdPreviewSurface":
            return shader
        if shader:
            text = f"a surface that is no UsdPreviewSurface but {quoted(str(shader.GetShaderId()) or 'unknown')} is drawn in grey"
            self._notes.slip(text, str(prim.GetPath()), what=str(shader.GetShaderId()))
        return None

    # Inputs

    def _value(self, shader: Any, name: str, otherwise: Any) -> Any:
        given = shader.GetInput(name)
        if not given:
            return otherwise
        attributes = self._shade.Utils.GetValueProducingAttributes(given)
        # What comes out of a shader has no value of its own.
        value = attributes[0].Get() if attributes and not str(attributes[0].GetName()).startswith("outputs:") else None
        return otherwise if value is None else value

    def _number(self, shader: Any, name: str, otherwise: float) -> float:
        given = self._value(shader, name, otherwise)
        return float(given) if isinstance(given, (bool, int, float)) and math.isfinite(given) else otherwise

    def _share(self, shader: Any, name: str, otherwise: float) -> float:
        return min(max(self._number(shader, name, otherwise), 0.0), 1.0)

    def _color(self, shader: Any, name: str, otherwise: Triple) -> Triple:
        r, g, b = (max(float(c), 0.0) if math.isfinite(float(c)) else 0.0 for c in self._value(shader, name, otherwise))
        return r, g, b

    def _source(self, shader: Any, name: str) -> tuple[Any, str] | None:
        """The shader that an input shows, and which output of it."""
        given = shader.GetInput(name)
        for _ in range(_MOST_LINKS):
            sources = given.GetConnectedSources()[0] if given else []
            if not sources:
                return None
            source, output = sources[0].source, str(sources[0].sourceName)
            producer = self._shade.Shader(source.GetPrim())
            if producer and source.GetPrim().IsA(self._shade.Shader):
                return producer, output
            given = source.GetInput(output) or source.GetOutput(output)
        return None

    def _varname(self, shader: Any) -> str:
        """The primvar that a reader reads; empty where it is none."""
        return str(self._value(shader, "varname", "")) if str(shader.GetShaderId()).startswith("UsdPrimvarReader") else ""

    def _picture(self, shader: Any, name: str, where: str, *, srgb: bool = False) -> _Picture | None:
        source = self._source(shader, name)
        if source is None or str(source[0].GetShaderId()).startswith("UsdPrimvarReader"):
            return None
        reader, channel = source
        if str(reader.GetShaderId()) != "UsdUVTexture":
            self._notes.slip(f"{name} of {quoted(str(reader.GetShaderId()))} is ignored", where)
            return None
        asset = self._value(reader, "file", None)
        if asset is None or not asset.path:
            self._notes.slip(f"{name}: a picture without a file is left out", where)
            return None
        space = str(self._value(reader, "sourceColorSpace", "auto"))
        encoded = space == "sRGB" or (space != "raw" and srgb)
        try:
            texels = self._pictures.texels(asset.resolvedPath or asset.path, lambda: self._bytes(asset), srgb=encoded, name=asset.path)
        except LimnerError as error:
            self._notes.slip(f"drawn without the picture of {name}: {without_path(error)}", where)
            return None
        wrap_u, wrap_v = (_WRAPS.get(str(self._value(reader, wrap, "repeat")), "repeat") for wrap in ("wrapS", "wrapT"))
        scale = tuple(float(k) for k in self._value(reader, "scale", (1.0,) * 4))
        bias = [float(k) for k in self._value(reader, "bias", (0.0,) * 4)]
        if name != "normal" and any(bias):
            self._notes.add(f"the bias of the picture of {name} is ignored", where, kind="approximated")
        offset, size, turn = self._transform(reader, where)
        texture = Texture(texels, wrap_u=wrap_u, wrap_v=wrap_v, offset=offset, scale=size, rotation=turn)
        return _Picture(texture, channel, (scale[0], scale[1], scale[2], scale[3]))

    def _transform(self, reader: Any, where: str) -> tuple[tuple[float, float], tuple[float, float], float]:
        """Offset, scale and turn of the coordinates, whose name is kept."""
        offset, size, turn = (0.0, 0.0), (1.0, 1.0), 0.0
        source = self._source(reader, "st")
        if source is not None and str(source[0].GetShaderId()) == "UsdTransform2d":
            moved = source[0]
            x, y = self._value(moved, "translation", (0.0, 0.0))
            u, v = self._value(moved, "scale", (1.0, 1.0))
            offset, size = (float(x), float(y)), (float(u), float(v))
            turn = math.radians(self._number(moved, "rotation", 0.0))
            source = self._source(moved, "in")
        if source is not None:
            self._coordinates.setdefault(where, self._varname(source[0]))
        return offset, size, turn

    def _bytes(self, asset: Any) -> bytes:
        """The picture's bytes: out of the package that it is in, or from beside the model."""
        if self._resolver.IsPackageRelativePath(asset.resolvedPath):
            opened = self._resolver.GetResolver().OpenAsset(self._resolver.ResolvedPath(asset.resolvedPath))
            if not opened:
                raise FileFormatError(f"{quoted(asset.path)} is missing", self._sources.path)
            if opened.GetSize() > self._sources.limits.max_file_bytes:
                raise FileFormatError(f"{quoted(asset.path)} is too large (max_file_bytes)", self._sources.path)
            return bytes(opened.GetBuffer())
        folder = self._sources.path.resolve().parent
        resolved = asset.resolvedPath
        if resolved and resolved.startswith(f"{folder}/"):
            return self._sources.read_beside(resolved[len(str(folder)) + 1 :])
        return self._sources.read_beside(asset.path.removeprefix("./"))

    # The surface

    def _read(self, shader: Any, name: str) -> MetallicRoughness:
        where = str(shader.GetPrim().GetPath().GetParentPath())
        base = self._picture(shader, "diffuseColor", where, srgb=True)
        glow = self._picture(shader, "emissiveColor", where, srgb=True)
        normal = self._picture(shader, "normal", where)
        occlusion = self._picture(shader, "occlusion", where)
        roughness, metallic = (self._picture(shader, kind, where) for kind in ("roughness", "metallic"))
        shows_display = (found := self._source(shader, "diffuseColor")) is not None and self._varname(found[0]) == "displayColor"
        fields: dict[str, Any] = {}
        if int(self._number(shader, "useSpecularWorkflow", 0.0)):
            r, g, b = (k / _OPAQUE_F0 for k in self._color(shader, "specularColor", (0.0, 0.0, 0.0)))
            fields = {"metallic": 0.0, "specular": Specular(color=(r, g, b))}
            metallic = None
            self._notes.add("a specular colour is shown as that of a dielectric", where, kind="approximated")
            if self._source(shader, "specularColor") is not None:
                self._notes.add("the picture of a specular colour is left out", where)
        else:
            fields["metallic"] = self._share(shader, "metallic", 0.0) if metallic is None else min(max(_of(metallic), 0.0), 1.0)
        fields["roughness"] = self._share(shader, "roughness", 0.5) if roughness is None else min(max(_of(roughness), 0.0), 1.0)
        coat = self._share(shader, "clearcoat", 0.0)
        if coat > 0.0:
            fields["clearcoat"] = Clearcoat(coat, self._share(shader, "clearcoatRoughness", 0.01))
        if abs(self._number(shader, "displacement", 0.0)) > 0.0 or self._source(shader, "displacement") is not None:
            self._notes.add("displacement is ignored", where)
        color = (1.0, 1.0, 1.0) if shows_display else self._color(shader, "diffuseColor", (0.18, 0.18, 0.18))
        return MetallicRoughness(
            base_color=color if base is None else self._tint(base),
            base_color_texture=None if base is None else base.texture,
            metallic_roughness_texture=self._rough_and_metal(roughness, metallic),
            emission=self._color(shader, "emissiveColor", (0.0, 0.0, 0.0)) if glow is None else self._tint(glow),
            emissive_texture=None if glow is None else glow.texture,
            normal_texture=None if normal is None else normal.texture,
            occlusion_texture=None if occlusion is None else self._in_channel(occlusion, 0),
            ior=max(self._number(shader, "ior", 1.5), 1.0), double_sided=True, name=name,
            **fields, **self._opacity(shader, where),
        )  # fmt: skip

    @staticmethod
    def _tint(picture: _Picture) -> Triple:
        r, g, b = (max(k, 0.0) for k in picture.scale[:3])
        return r, g, b

    def _opacity(self, shader: Any, where: str) -> dict[str, Any]:
        picture = self._picture(shader, "opacity", where)
        threshold = self._share(shader, "opacityThreshold", 0.0)
        alpha = self._share(shader, "opacity", 1.0) if picture is None else min(max(_of(picture), 0.0), 1.0)
        if picture is None and alpha >= 1.0:
            return {}
        mode: AlphaMode = "mask" if threshold > 0.0 else "blend"
        found: dict[str, Any] = {"alpha": alpha, "alpha_mode": mode, "alpha_cutoff": threshold or 0.5}
        if picture is not None:
            found |= {"alpha_texture": picture.texture, "alpha_channel": _CHANNELS.get(picture.channel, "r")}
        return found

    def _rough_and_metal(self, roughness: _Picture | None, metallic: _Picture | None) -> Texture | None:
        """One texture with roughness in green and metallic in blue, as far as either has a picture."""
        first = roughness or metallic
        if first is None:
            return None
        both = roughness is not None and metallic is not None and roughness.texture.texels is metallic.texture.texels
        if both and roughness is not None and metallic is not None and (roughness.channel, metallic.channel) == ("g", "b"):
            return first.texture
        key = (id(roughness and roughness.texture.texels), id(metallic and metallic.texture.texels),
               roughness and roughness.channel, metallic and metallic.channel)  # fmt: skip
        if key not in self._packed:
            height, width = first.texture.texels.pixels.shape[:2]
            packed = np.full((height, width, 4), 255, dtype=np.uint8)
            for picture, channel in ((roughness, 1), (metallic, 2)):
                if picture is not None:
                    packed[..., channel] = _resampled(_plane(picture), height, width)
            self._packed[key] = Texels(packed, srgb=False, name=first.texture.texels.name)
        return _with(first.texture, self._packed[key])

    def _in_channel(self, picture: _Picture, channel: int) -> Texture:
        """The texture with what an input looks at in a channel of its own."""
        if picture.channel in ("rgb", "rgba", "rgb"[channel]):
            return picture.texture
        key = id(picture.texture.texels), picture.channel, channel
        if key not in self._packed:
            packed = np.full((*picture.texture.texels.pixels.shape[:2], 4), 255, dtype=np.uint8)
            packed[..., channel] = _plane(picture)
            self._packed[key] = Texels(packed, srgb=False, name=picture.texture.texels.name)
        return _with(picture.texture, self._packed[key])


def _of(picture: _Picture) -> float:
    """What the channel of a picture is multiplied by."""
    return picture.scale["rgba".find(picture.channel) if picture.channel in ("r", "g", "b", "a") else 0]


def _plane(picture: _Picture) -> NDArray[np.uint8]:
    """The channel that an input looks at, in eight bits."""
    texels = picture.texture.texels
    values = texels.pixels[..., "rgba".find(picture.channel) if picture.channel in ("r", "g", "b", "a") else 0]
    if values.dtype == np.uint8:
        return np.asarray(values)
    return np.asarray(np.rint(np.clip(values / texels.white, 0.0, 1.0) * 255.0), dtype=np.uint8)


def _resampled(plane: NDArray[np.uint8], height: int, width: int) -> NDArray[np.uint8]:
    """The nearest texels of another size."""
    rows = np.arange(height) * plane.shape[0] // height
    return np.asarray(plane[rows][:, np.arange(width) * plane.shape[1] // width])


def _with(texture: Texture, texels: Texels) -> Texture:
    return Texture(
        texels, wrap_u=texture.wrap_u, wrap_v=texture.wrap_v, offset=texture.offset, scale=texture.scale, rotation=texture.rotation
    )
