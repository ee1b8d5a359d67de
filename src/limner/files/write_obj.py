"""Writing OBJ, with a library of materials and their textures beside it: text that every program reads.

    mtllib chair.mtl
    o world/seat                  an object for every shape
    v 0 0.5 0                     positions, as many digits as give the same float32 again
    vt 0 1 / vn 0 1 0             texture coordinates and normals, each with indices of its own
    usemtl oak
    f 1/1/1 2/2/1 3/3/1           corners: position / coordinate / normal, counted from 1

Nothing has to be split: OBJ indexes as `Mesh` does. Colours of vertices, sRGB, follow the positions, as most programs write them.

**Source**: Alias/Wavefront, *Object Files (.obj)* and *MTL material format*, appendices B1, 1995; roughness and metallic as proposed by
Exocortex, *Extending the .MTL format for PBR*, 2014.
"""

from __future__ import annotations

import re
from typing import IO, Any
from warnings import warn

import numpy as np
from numpy.typing import NDArray

from ..color.transfer import bytes_from_linear, bytes_from_unit, srgb_from_linear
from ..errors import LimnerWarning
from ..image.png import png_bytes
from ..mesh.mesh import Mesh
from ..scene.line_set import LineSet
from ..scene.material import BlinnPhong, Material, MetallicRoughness
from ..scene.points import PointCloud
from ..scene.texture import Texels, Texture
from .world_parts import Part, base_color

__all__ = ["Library", "write_obj"]

_AT_ONCE = 1 << 16


class Library:
    """The materials of a file and the pictures that they need, under names that each stand for one of them.

    Parameters
    ----------
    parts : list of Part
    stem : str
        Of the file's name: what the names of pictures begin with.
    """

    def __init__(self, parts: list[Part], stem: str) -> None:
        self._stem = stem
        self._names: dict[int, str] = {}
        self._pictures: dict[tuple[Texels, bool], str] = {}
        self._lines = ["# limner"]
        for material in {id(material): material for part in parts for material in part.materials}.values():
            wanted = _word(material.name) or f"material_{len(self._names)}"
            name = wanted
            while name in self._names.values():
                name = f"{wanted}_{len(self._names)}"
            self._names[id(material)] = name
            self._lines += ["", f"newmtl {name}", *self._described(material)]

    def name(self, material: Material) -> str:
        """What a material is called."""
        return self._names[id(material)]

    def text(self) -> bytes:
        """The library as a file."""
        return "\n".join([*self._lines, ""]).encode()

    def pictures(self) -> dict[str, bytes]:
        """PNG files by their names."""
        return {name: png_bytes(_encoded(texels, as_color)) for (texels, as_color), name in self._pictures.items()}

    def _described(self, material: Material) -> list[str]:
        lines = [f"Kd {_numbers(base_color(material))}"]
        if max(material.emission) > 0.0:
            lines.append(f"Ke {_numbers(material.emission)}")
        if material.alpha < 1.0:
            lines.append(f"d {material.alpha:.9g}")
        maps: tuple[tuple[str, object], ...]
        if isinstance(material, MetallicRoughness):
            lines += [f"Pm {material.metallic:.9g}", f"Pr {material.roughness:.9g}"]
            maps = (("map_Kd", material.base_color_texture), ("norm", material.normal_texture), ("map_Ke", material.emissive_texture))
        elif isinstance(material, BlinnPhong):
            shiny = max(material.specular) > 0.0
            lines += [f"Ks {_numbers(material.specular)}", f"Ns {material.exponent:.9g}", f"illum {2 if shiny else 1}"]
            maps = (
                ("map_Kd", material.diffuse_texture), ("map_Ks", material.specular_texture), ("norm", material.normal_texture),
                ("map_Ke", material.emission_texture),
            )  # fmt: skip
        else:
            lines.append("illum 1")
            maps = (("map_Kd", getattr(material, "texture", None)), ("map_Ke", getattr(material, "emission_texture", None)))
        if getattr(material, "alpha_channel", "") == "r":
            maps = (*maps, ("map_d", material.alpha_texture))  # type: ignore[union-attr]
        if any(texture is not None and not isinstance(texture, Texture) for _, texture in maps):
            warn(f"material {material.name!r} has a texture that is a formula, which is left out", LimnerWarning, stacklevel=5)
        return lines + [f"{keyword} {self._map(keyword, texture)}" for keyword, texture in maps if isinstance(texture, Texture)]

    def _map(self, keyword: str, texture: Texture) -> str:
        key = texture.texels, keyword not in ("norm", "map_d")
        if key not in self._pictures:
            self._pictures[key] = f"{_word(self._stem)}_{len(self._pictures)}.png"
        options = ""
        if texture.scale != (1.0, 1.0):
            options += f"-s {_numbers((*texture.scale, 1.0))} "
        if texture.offset != (0.0, 0.0):
            options += f"-o {_numbers((*texture.offset, 0.0))} "
        if texture.wrap_u == texture.wrap_v == "clamp":
            options += "-clamp on "
        return options + self._pictures[key]


def _encoded(texels: Texels, as_color: bool) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """A raster as a picture holds it, row 0 on top; floats, which are linear, in eight bits."""
    pixels: NDArray[Any] = np.ascontiguousarray(texels.pixels[::-1])
    if pixels.dtype.kind == "u":
        return pixels
    made = bytes_from_linear(pixels) if as_color else bytes_from_unit(pixels)
    made[..., 3] = bytes_from_unit(pixels[..., 3])
    return made


def write_obj(parts: list[Part], library: Library, library_name: str, stream: IO[bytes]) -> None:
    """Write the shapes; their materials are in the library, which stands beside."""
    stream.write(f"# limner\nmtllib {library_name}\n".encode())
    first = (1, 1, 1)
    for part in parts:
        stream.write(f"o {re.sub(r'[^!-~]', '_', part.name)}\n".encode())
        if isinstance(part.geometry, PointCloud):
            first = _write_cloud(part.geometry, first, stream)
        elif isinstance(part.geometry, LineSet):
            stream.write(f"usemtl {library.name(part.materials[0])}\n".encode())
            first = _write_lines(part.geometry, first, stream)
        else:
            first = _write_mesh(part, first, library, stream)


def _write_mesh(part: Part, first: tuple[int, int, int], library: Library, stream: IO[bytes]) -> tuple[int, int, int]:
    """Write one mesh; `first` is what its positions, coordinates and normals are counted from; return that of the next."""
    mesh = part.geometry
    assert isinstance(mesh, Mesh)
    _write_positions(mesh.positions, mesh.colors, stream)
    corners = [mesh.triangles + first[0]]
    pattern = "%d"
    n_uvs = n_normals = 0
    if mesh.uvs is not None:
        _write_rows("vt", mesh.uvs, stream)
        corners.append((mesh.triangles if mesh.uv_triangles is None else mesh.uv_triangles) + first[1])
        pattern, n_uvs = "%d/%d", len(mesh.uvs)
    if mesh.normals is not None:
        _write_rows("vn", mesh.normals, stream)
        corners.append((mesh.triangles if mesh.normal_triangles is None else mesh.normal_triangles) + first[2])
        pattern, n_normals = ("%d/%d/%d" if mesh.uvs is not None else "%d//%d"), len(mesh.normals)
    else:
        stream.write(b"s off\n")
    indices = np.stack(corners, axis=2)
    slots = np.zeros(len(indices), dtype=np.int32) if mesh.triangle_materials is None else mesh.triangle_materials
    starts = np.flatnonzero(np.concatenate([[True], slots[1:] != slots[:-1]])) if len(slots) else np.zeros(0, dtype=np.int64)
    line = f"f {pattern} {pattern} {pattern}\n"
    for start, end in zip(starts.tolist(), [*starts[1:].tolist(), len(slots)], strict=True):
        stream.write(f"usemtl {library.name(part.materials[int(slots[start])])}\n".encode())
        for begin in range(start, end, _AT_ONCE):
            chunk = indices[begin : min(end, begin + _AT_ONCE)]
            stream.write(((line * len(chunk)) % tuple(chunk.reshape(-1).tolist())).encode())
    return first[0] + len(mesh.positions), first[1] + n_uvs, first[2] + n_normals


def _write_cloud(cloud: PointCloud, first: tuple[int, int, int], stream: IO[bytes]) -> tuple[int, int, int]:
    _write_positions(cloud.positions, cloud.colors, stream)
    count = len(cloud.positions)
    for begin in range(0, count, _AT_ONCE):
        numbers = range(first[0] + begin, first[0] + min(count, begin + _AT_ONCE))
        stream.write((("p %d\n" * len(numbers)) % tuple(numbers)).encode())
    return first[0] + count, first[1], first[2]


def _write_lines(lines: LineSet, first: tuple[int, int, int], stream: IO[bytes]) -> tuple[int, int, int]:
    """Write segments, each chain of them as one line."""
    _write_positions(lines.positions, lines.colors, stream)
    segments = lines.ends[lines.shown] + first[0]
    starts = np.flatnonzero(np.concatenate([[True], segments[1:, 0] != segments[:-1, 1]])).tolist()
    for start, end in zip(starts, [*starts[1:], len(segments)], strict=True):
        stream.write(f"l {' '.join(map(str, [segments[start, 0], *segments[start:end, 1]]))}\n".encode())
    return first[0] + len(lines.positions), first[1], first[2]


def _write_positions(positions: NDArray[np.float32], colors: NDArray[np.float32] | None, stream: IO[bytes]) -> None:
    if colors is None:
        _write_rows("v", positions, stream)
    else:
        _write_rows("v", np.concatenate([positions, srgb_from_linear(colors[:, :3]).astype(np.float32)], axis=1), stream)


def _write_rows(keyword: str, rows: NDArray[np.float32], stream: IO[bytes]) -> None:
    """Write rows of numbers with nine digits, which tell any two float32 apart."""
    line = f"{keyword}{' %.9g' * rows.shape[1]}\n"
    for begin in range(0, len(rows), _AT_ONCE):
        chunk = rows[begin : begin + _AT_ONCE]
        stream.write(((line * len(chunk)) % tuple(chunk.reshape(-1).tolist())).encode())


def _numbers(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _word(name: str) -> str:
    """A name as one word of ASCII."""
    return re.sub(r"[^A-Za-z0-9_.\-]", "_", name)
