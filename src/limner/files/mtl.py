"""Reading MTL, the material libraries of OBJ files.

    newmtl red          a material begins
    Kd 0.8 0.1 0.1      diffuse, Ks specular, Ns the exponent, Ke emission, d opacity (Tr = 1 - d)
    map_Kd brick.png    a picture that multiplies Kd; map_Ks, map_Ke, map_d for opacity, norm for normals
    illum 2             2: highlights, 1: none, 3 and above: ideal reflections too
    Pr 0.4 / Pm 1.0     roughness and metallic, where an exporter knows them

What exporters write is not what the format's description says: `Ka` is 1 1 1 or 0 0 0 without anybody having meant it, so
it is not read and the ambient term takes the diffuse colour; a black `Kd` under a `map_Kd` means "the picture".

**Source**: Alias/Wavefront, *MTL material format*, appendix B1 (1995); the PBR extension as proposed by Exocortex
(*Extending the .MTL format for PBR*, 2014).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path, PureWindowsPath

from ..errors import FileFormatError, LimnerError
from ..scene.material import BlinnPhong, Material, MetallicRoughness
from ..scene.texture import Texels, Texture
from .notes import Notes, quoted, without_path
from .pictures import Pictures
from .sources import Sources

__all__ = ["read_materials"]

Triple = tuple[float, float, float]

# How many numbers may follow an option of a texture map; the file's name begins after the last.
_OPTIONS = {
    "-blendu": 1, "-blendv": 1, "-bm": 1, "-boost": 1, "-cc": 1, "-clamp": 1, "-imfchan": 1, "-mm": 2, "-o": 3, "-s": 3,
    "-t": 3, "-texres": 1, "-type": 1,
}  # fmt: skip
_WORD_OPTIONS = frozenset({"-blendu", "-blendv", "-cc", "-clamp", "-imfchan", "-type"})
_MAPS = ("map_kd", "map_ks", "map_ke", "map_d", "norm", "map_bump", "bump")
_UNREAD_MAPS = frozenset({"map_ka", "map_ns", "map_tr", "disp", "decal", "refl", "map_pr", "map_pm", "map_ps"})
# Whether a picture is a normal map: its mean is near (1/2, 1/2, 1), as heights, which are grey, never are.
_NORMAL_BLUE, _NORMAL_RED_GREEN = 0.7, 0.12


@dataclass
class _Entry:
    """What one `newmtl` says."""

    name: str
    colors: dict[str, Triple] = field(default_factory=dict)
    numbers: dict[str, float] = field(default_factory=dict)
    maps: dict[str, str] = field(default_factory=dict)


def read_materials(data: bytes, library: str, sources: Sources, pictures: Pictures, notes: Notes) -> dict[str, Material]:
    """Read the materials of a library by name.

    Parameters
    ----------
    data : bytes
        The library.
    library : str
        Its name, for remarks.
    sources, pictures : Sources, Pictures
        Where its textures come from.
    """
    if b"\0" in data:
        raise FileFormatError("is no MTL text", library)
    entries = _entries(data.decode("utf-8-sig", errors="replace"), library, notes)
    _prepare_pictures(entries, sources, pictures)
    return {entry.name: _Maker(entry, library, sources, pictures, notes).material() for entry in entries}


def _entries(text: str, library: str, notes: Notes) -> list[_Entry]:
    entries: dict[str, _Entry] = {}
    current: _Entry | None = None
    for number, line in enumerate(text.replace("\\\r\n", " ").replace("\\\n", " ").splitlines(), start=1):
        keyword, _, rest = line.strip().partition(" ") if "\t" not in line else line.replace("\t", " ").strip().partition(" ")
        keyword, rest = keyword.lower(), rest.strip()
        if not keyword or keyword.startswith("#"):
            continue
        if keyword == "newmtl":
            current = entries[rest] = _Entry(rest)
        elif current is not None:
            try:
                _put(current, keyword, rest)
            except ValueError:
                notes.slip(f"a number cannot be read: {quoted(line.strip())}", f"{library}, line {number}")
    return list(entries.values())


def _put(entry: _Entry, keyword: str, rest: str) -> None:
    if keyword in ("kd", "ks", "ke", "tf"):
        words = rest.split("#")[0].split()
        if words and words[0] in ("spectral", "xyz"):
            return
        values = [_non_negative(word) for word in words[:3]]
        # The description allows one number for all three.
        entry.colors[keyword] = (values[0],) * 3 if len(values) == 1 else (values[0], values[1], values[2])
    elif keyword in ("ns", "d", "tr", "illum", "pr", "pm"):
        words = [word for word in rest.split("#")[0].split() if word != "-halo"]
        entry.numbers[keyword] = _non_negative(words[0])
    elif keyword.startswith("map_") or keyword in ("norm", "bump", "disp", "decal", "refl"):
        entry.maps[keyword] = rest


def _non_negative(word: str) -> float:
    value = float(word)
    if not math.isfinite(value):
        raise ValueError(word)
    return max(value, 0.0)


def _split_map(text: str) -> tuple[str, dict[str, list[str]]]:
    """Return the name of the picture, which may hold spaces, and the options before it."""
    options: dict[str, list[str]] = {}
    words = text.split()
    while words and words[0].lower() in _OPTIONS:
        option = words.pop(0).lower()
        taken: list[str] = []
        while words and len(taken) < _OPTIONS[option] and (option in _WORD_OPTIONS or _is_number(words[0])):
            taken.append(words.pop(0))
        options[option] = taken
    # Not joined from the words: a name may hold two spaces in a row.
    name = text[text.index(words[0]) :] if len(words) > 1 and words[0] in text else " ".join(words)
    return name.strip().strip('"'), options


def _is_normal_map(texels: Texels) -> bool:
    """Whether a picture holds directions rather than heights."""
    full = texels.white
    red, green, blue = (texels.pixels[..., :3].reshape(-1, 3).mean(axis=0) / full).tolist()
    return blue > _NORMAL_BLUE and max(abs(red - 0.5), abs(green - 0.5)) < _NORMAL_RED_GREEN


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _picture_source(name: str, sources: Sources) -> tuple[Path, Callable[[], bytes]]:
    """Return what names a picture and what reads it; of a path that leads elsewhere, the file of that name beside the model."""
    try:
        place = sources.locate(name)
    except FileFormatError:
        name = PureWindowsPath(name).name
        place = sources.locate(name)
    return place, lambda: sources.read_beside(name)


def _prepare_pictures(entries: list[_Entry], sources: Sources, pictures: Pictures) -> None:
    wanted: dict[Path, Callable[[], bytes]] = {}
    for entry in entries:
        for keyword in _MAPS:
            if keyword in entry.maps:
                try:
                    place, give = _picture_source(_split_map(entry.maps[keyword])[0], sources)
                except LimnerError:
                    continue
                wanted[place] = give
    pictures.prepare(wanted)


class _Maker:
    """One entry on its way to a material."""

    def __init__(self, entry: _Entry, library: str, sources: Sources, pictures: Pictures, notes: Notes) -> None:
        self._entry = entry
        self._sources = sources
        self._pictures = pictures
        self._notes = notes
        self._where = f"{library}, material {quoted(entry.name)}"

    def material(self) -> Material:
        """Make the material: metallic-roughness where the entry has roughness or metallic, else Blinn-Phong."""
        for keyword in sorted(_UNREAD_MAPS & set(self._entry.maps)):
            self._notes.add(f"{keyword} is ignored", self._where)
        return self._physical() if {"pr", "pm"} & set(self._entry.numbers) else self._phong()

    def _alpha(self) -> float:
        numbers = self._entry.numbers
        alpha = numbers["d"] if "d" in numbers else 1.0 - min(numbers.get("tr", 0.0), 1.0)
        if alpha <= 0.0:
            self._notes.slip("is fully transparent (d 0 or Tr 1) and shows nothing", self._where)
        return min(alpha, 1.0)

    def _diffuse(self) -> tuple[Triple, Texture | None]:
        texture = self._texture("map_kd", srgb=True)
        color = self._entry.colors.get("kd", (1.0, 1.0, 1.0) if texture is not None else (0.8, 0.8, 0.8))
        if texture is not None and max(color) == 0.0:
            self._notes.add("Kd 0 0 0 with map_Kd is read as 1 1 1", self._where)
            color = (1.0, 1.0, 1.0)
        return color, texture

    def _phong(self) -> BlinnPhong:
        colors, numbers = self._entry.colors, self._entry.numbers
        diffuse, texture = self._diffuse()
        illumination = int(min(numbers.get("illum", 2.0), 10.0))
        specular = colors.get("ks", (0.0, 0.0, 0.0)) if illumination != 1 and illumination != 0 else (0.0, 0.0, 0.0)
        if illumination == 0:
            self._notes.add("illum 0 (colour without light) is drawn as a matte surface", self._where)
        if illumination in (4, 6, 7, 9):
            self._notes.add(f"illum {illumination} (glass) is drawn by its opacity alone", self._where)
        alpha, opacity = self._alpha(), self._texture("map_d", srgb=False)
        emissive = self._texture("map_ke", srgb=True)
        return BlinnPhong(
            diffuse=diffuse,
            specular=specular,
            exponent=min(max(numbers.get("ns", 32.0), 1.0), 1e6),
            mirror=specular if 3 <= illumination <= 7 else (0.0, 0.0, 0.0),
            emission=colors.get("ke", (1.0, 1.0, 1.0) if emissive is not None else (0.0, 0.0, 0.0)),
            emission_texture=emissive,
            diffuse_texture=texture,
            specular_texture=self._texture("map_ks", srgb=True) if max(specular) > 0.0 else None,
            normal_texture=self._normals(),
            alpha=alpha,
            alpha_texture=opacity,
            alpha_mode="blend" if alpha < 1.0 or opacity is not None else "opaque",
            name=self._entry.name,
        )

    def _physical(self) -> MetallicRoughness:
        colors, numbers = self._entry.colors, self._entry.numbers
        diffuse, texture = self._diffuse()
        alpha, opacity = self._alpha(), self._texture("map_d", srgb=False)
        emissive = self._texture("map_ke", srgb=True)
        return MetallicRoughness(
            base_color=diffuse,
            metallic=min(numbers.get("pm", 0.0), 1.0),
            roughness=min(numbers.get("pr", 0.5), 1.0),
            base_color_texture=texture,
            normal_texture=self._normals(),
            emission=colors.get("ke", (1.0, 1.0, 1.0) if emissive is not None else (0.0, 0.0, 0.0)),
            emissive_texture=emissive,
            double_sided=True,
            alpha=alpha,
            alpha_texture=opacity,
            alpha_mode="blend" if alpha < 1.0 or opacity is not None else "opaque",
            name=self._entry.name,
        )

    def _normals(self) -> Texture | None:
        """The normal map: `norm`, or what stands as a bump map and is one, as Blender writes it; heights say no unit and are left out."""
        given = self._texture("norm", srgb=False)
        for keyword in ("map_bump", "bump"):
            if given is not None or keyword not in self._entry.maps:
                continue
            found = self._texture(keyword, srgb=False)
            if found is not None and _is_normal_map(found.texels):
                given = found
            elif found is not None:
                self._notes.add(f"{keyword} is ignored: MTL does not say how high its heights are", self._where)
        return given

    def _texture(self, keyword: str, *, srgb: bool) -> Texture | None:
        text = self._entry.maps.get(keyword)
        if not text:
            return None
        name, options = _split_map(text)
        try:
            place, give = _picture_source(name, self._sources)
            texels = self._pictures.texels(place, give, srgb=srgb, name=place.name)
        except LimnerError as error:
            self._notes.slip(f"drawn without {keyword} {quoted(name)}: {without_path(error)}", self._where)
            return None
        scale = [float(word) for word in options.get("-s", [])] + [1.0, 1.0]
        offset = [float(word) for word in options.get("-o", [])] + [0.0, 0.0]
        wrap = "clamp" if options.get("-clamp") == ["on"] else "repeat"
        if not all(math.isfinite(x) for x in (*scale, *offset)):
            scale, offset = [1.0, 1.0], [0.0, 0.0]
        return Texture(
            texels,
            wrap_u="clamp" if wrap == "clamp" else "repeat",
            wrap_v="clamp" if wrap == "clamp" else "repeat",
            offset=(offset[0], offset[1]),
            scale=(scale[0], scale[1]),
        )
