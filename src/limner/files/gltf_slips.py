"""What a glTF document says against its own rules, where reading it has not noticed: in what the scene does not show, or needs no rule.

A reader that only reads what it needs is silent about all else. Here the whole document is walked once: lists that are empty, references to
nothing, members that are missing or out of range, extensions where they do not belong. Each is a line of the report, and none is a reason
to refuse anything.

**Source**: glTF 2.0 and its extensions, the schemas; the codes of the Khronos validator.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from .document import Element
from .notes import Notes, quoted

__all__ = ["note_slips"]

_MOST_DEPTH = 32
_MOST_VALUES = 200_000  # of a document; larger ones are looked at so far
_UNIT = 0.01  # how far a rotation may be from length 1

_COLLECTIONS = {
    "bufferView": "bufferViews", "buffer": "buffers", "sampler": "samplers", "source": "images", "mesh": "meshes", "camera": "cameras",
    "skin": "skins", "skeleton": "nodes", "inverseBindMatrices": "accessors", "input": "accessors", "output": "accessors",
    "indices": "accessors", "material": "materials", "node": "nodes", "scene": "scenes",
}  # fmt: skip
"""What a member of that name refers to, but for those of animations' channels."""
_LISTS = {"children": "nodes", "joints": "nodes", "nodes": "nodes"}
_NEEDED = {
    "accessors": ("componentType", "count", "type"), "bufferViews": ("buffer", "byteLength"), "buffers": ("byteLength",),
    "cameras": ("type",), "meshes": ("primitives",), "skins": ("joints",), "animations": ("channels", "samplers"), "images": (),
    "materials": (), "nodes": (), "scenes": (), "textures": (), "samplers": (),
}  # fmt: skip
"""What an element of each list must have."""
_OF_NODES, _OF_MATERIALS = ("nodes",), ("materials",)
_HOMES = {
    "KHR_lights_punctual": ("", "nodes"), "KHR_node_visibility": _OF_NODES, "EXT_mesh_gpu_instancing": _OF_NODES,
    "KHR_texture_transform": ("texture",), "KHR_texture_basisu": ("textures",), "EXT_texture_webp": ("textures",),
    "KHR_draco_mesh_compression": ("primitives",), "EXT_meshopt_compression": ("bufferViews", "buffers"),
    "KHR_materials_variants": ("", "primitives"), "KHR_animation_pointer": ("target",),
    **{f"KHR_materials_{name}": _OF_MATERIALS for name in (
        "anisotropy", "clearcoat", "diffuse_transmission", "dispersion", "emissive_strength", "ior", "iridescence", "pbrSpecularGlossiness",
        "sheen", "specular", "transmission", "unlit", "volume",
    )},
}  # fmt: skip
"""Where an extension's object may stand: "" is the document itself, "texture" wherever a texture is referred to."""
_UNIT_INTERVAL = (0.0, 1.0)
_RANGES = {
    "KHR_materials_dispersion": {"dispersion": (0.0, math.inf)},
    "KHR_materials_volume": {"thicknessFactor": (0.0, math.inf), "attenuationColor": _UNIT_INTERVAL},
    "KHR_materials_transmission": {"transmissionFactor": _UNIT_INTERVAL},
    "KHR_materials_clearcoat": {"clearcoatFactor": _UNIT_INTERVAL, "clearcoatRoughnessFactor": _UNIT_INTERVAL},
    "KHR_materials_specular": {"specularFactor": _UNIT_INTERVAL},
    "KHR_materials_sheen": {"sheenRoughnessFactor": _UNIT_INTERVAL, "sheenColorFactor": _UNIT_INTERVAL},
    "KHR_materials_emissive_strength": {"emissiveStrength": (0.0, math.inf)},
}


def note_slips(root: Element, notes: Notes) -> None:
    """Note what a document says against its rules; of what has been noted already nothing more is said."""
    said = "\n".join(notes.lines())
    for where, text in _slips(root.value):
        if not where or where not in said:
            notes.add(text, where, kind="ignored")


def _slips(document: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """(pointer, what is wrong), one after the other."""
    counts = {key: len(value) for key, value in document.items() if isinstance(value, list)}
    used = [name for name in _list(document, "extensionsUsed") if isinstance(name, str)]
    if len(set(used)) < len(used):
        yield "/extensionsUsed", "an extension that is named twice counts once, the other is ignored"
    for pointer, kind, value in _walk(document):
        if isinstance(value, list) and not value:
            yield pointer, "an empty list, which glTF has not, is ignored"
        elif kind in _NEEDED and pointer.count("/") == 2 and not isinstance(value, dict):
            yield pointer, f"must be an object, got {quoted(value)}; it is ignored"
        elif isinstance(value, dict):
            yield from _of_object(pointer, kind, value, counts, used)
    yield from _of_nodes(document)
    yield from _of_storage(document)


def _walk(document: Mapping[str, Any]) -> Iterator[tuple[str, str, Any]]:
    """Every object and list with its pointer, and what it is: the collection that holds it, or the member's name."""
    waiting: list[tuple[str, str, Any, int]] = [("", "", document, 0)]
    n_seen = 0
    while waiting and n_seen < _MOST_VALUES:
        pointer, kind, value, depth = waiting.pop()
        n_seen += 1
        yield pointer, kind, value
        if depth >= _MOST_DEPTH:
            continue
        if isinstance(value, dict):
            waiting.extend(
                (f"{pointer}/{key}", key, held, depth + 1) for key, held in reversed(value.items())
                if key != "extras" and isinstance(held, (dict, list))
            )  # fmt: skip
        elif isinstance(value, list):
            waiting.extend(
                (f"{pointer}/{k}", kind, held, depth + 1) for k, held in reversed(list(enumerate(value)))
                if isinstance(held, (dict, list)) or kind in _NEEDED
            )  # fmt: skip


def _of_object(pointer: str, kind: str, value: Mapping[str, Any], counts: Mapping[str, int], used: list[str]) -> Iterator[tuple[str, str]]:
    is_member = pointer.rpartition("/")[2].isdecimal() or not pointer
    if is_member and pointer.count("/") == 2:
        for key in _NEEDED.get(kind, ()):
            if key not in value:
                yield pointer, f"has no {key}; what refers to it is left out"
    if not pointer.startswith("/animations"):
        for key, collection in _COLLECTIONS.items():
            if key in value and not isinstance(value[key], (dict, list, str)):
                yield from _of_reference(f"{pointer}/{key}", value[key], collection, counts)
    if kind in ("attributes", "targets") and "/primitives/" in pointer and "/extensions/" not in pointer:
        for key, number in value.items():
            if not key.startswith("_"):  # an application's own affair
                yield from _of_reference(f"{pointer}/{key}", number, "accessors", counts)
    for key, collection in _LISTS.items():
        for k, number in enumerate(_list(value, key)):
            if not isinstance(number, (dict, list)):
                yield from _of_reference(f"{pointer}/{key}/{k}", number, collection, counts)
    if kind.endswith("Texture") and "index" in value:
        yield from _of_reference(f"{pointer}/index", value["index"], "textures", counts)
    yield from _of_extensions(pointer, "texture" if kind.endswith("Texture") else kind, value, used)


def _of_reference(pointer: str, number: Any, collection: str, counts: Mapping[str, int]) -> Iterator[tuple[str, str]]:
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < counts.get(collection, 0):
        yield pointer, f"refers to none of the {counts.get(collection, 0)} {collection} and is ignored"


def _of_extensions(pointer: str, kind: str, value: Mapping[str, Any], used: list[str]) -> Iterator[tuple[str, str]]:
    extensions = value.get("extensions")
    if not isinstance(extensions, dict):
        return
    for name, given in extensions.items():
        where = f"{pointer}/extensions/{name}"
        if name not in used and name not in _HOMES:
            yield where, "an extension that is not among the extensionsUsed is ignored"
        if name in _HOMES and kind not in _HOMES[name]:
            yield where, "an extension where it does not belong is ignored"
        if not isinstance(given, dict):
            continue
        for key, (least, most) in _RANGES.get(name, {}).items():
            numbers = given[key] if isinstance(given.get(key), list) else [given.get(key, least)]
            if any(isinstance(number, (int, float)) and not least <= number <= most for number in numbers):
                yield f"{where}/{key}", f"is out of its range, {least:g} to {most:g}; where it is shown, it is clipped to it or left out"
        yield from _of_one_extension(name, kind, where, given)


def _of_one_extension(name: str, kind: str, where: str, given: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    if name == "KHR_materials_ior" and _is_number(given.get("ior")) and given["ior"] < 1.0 and given["ior"] != 0.0:
        yield f"{where}/ior", "is out of its range, 0 or from 1 on; where it is shown, it is left out"
    if name == "KHR_materials_volume" and _is_number(given.get("attenuationDistance")) and given["attenuationDistance"] <= 0.0:
        yield f"{where}/attenuationDistance", "must be greater than 0; where it is shown, it is left out"
    if name == "KHR_lights_punctual" and kind == "nodes" and "light" not in given:
        yield where, "names no light and is ignored"
    if name == "KHR_materials_variants" and kind == "" and "variants" not in given:
        yield where, "has no variants and is ignored"
    if name == "KHR_lights_punctual" and kind == "" and "lights" not in given:
        yield where, "has no lights and is ignored"
    if name == "KHR_lights_punctual" and kind == "":
        for k, light in enumerate(_list(given, "lights")):
            if isinstance(light, dict) and "type" not in light:
                yield f"{where}/lights/{k}", "has no type; what refers to it is left out"
            elif isinstance(light, dict) and light.get("type") == "spot" and "spot" not in light:
                yield f"{where}/lights/{k}", "is a spot without its cone, which is taken for the usual one; nothing more is ignored"


def _of_nodes(document: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    nodes = _objects(document, "nodes")
    parent = {child: k for k, node in nodes for child in _list(node, "children") if isinstance(child, int)}
    for k, node in nodes:
        if "matrix" in node and {"translation", "rotation", "scale"} & set(node):
            yield f"/nodes/{k}", "has both a matrix and its parts, of which only one is read; the other is ignored"
        turn = node.get("rotation")
        if isinstance(turn, list) and len(turn) == 4 and all(map(_is_number, turn)):
            if abs(math.hypot(*(min(max(number, -1e6), 1e6) for number in turn)) - 1.0) > _UNIT:
                yield f"/nodes/{k}/rotation", "a quaternion whose length is not 1 is made unit"
        if "skin" in node and "mesh" not in node:
            yield f"/nodes/{k}/skin", "a skin without a mesh is ignored"
    for k, scene in _objects(document, "scenes"):
        for place, index in enumerate(_list(scene, "nodes")):
            if isinstance(index, int) and index in parent:
                yield f"/scenes/{k}/nodes/{place}", "a node of a scene that has a parent is shown once, below it; it is ignored here"
    for k, skin in _objects(document, "skins"):
        yield from _of_skin(f"/skins/{k}", skin, parent, document)
    for k, camera in _objects(document, "cameras"):
        kinds = [kind for kind in ("perspective", "orthographic") if kind in camera]
        if len(kinds) != 1:
            yield f"/cameras/{k}", f"must have one of perspective and orthographic, has {len(kinds)}; all but its type's is ignored"
        for kind in kinds:
            lens = camera[kind] if isinstance(camera[kind], dict) else {}
            near: Any = lens.get("znear")
            far: Any = lens.get("zfar")
            if _is_number(near) and _is_number(far) and far <= near:
                yield f"/cameras/{k}/{kind}", "its far plane is not beyond its near one; where it is looked through, it is left out"


def _of_skin(where: str, skin: Mapping[str, Any], parent: Mapping[int, int], document: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    joints = [joint for joint in _list(skin, "joints") if isinstance(joint, int)]
    above = [_line(joint, parent) for joint in joints]
    shared = set.intersection(*map(set, above)) if above else set()
    if above and not shared:
        yield f"{where}/joints", "its joints have no node above all of them; each stands where it is, the rule is ignored"
    elif isinstance(skin.get("skeleton"), int) and above and skin["skeleton"] not in shared:
        yield f"{where}/skeleton", "is not above all joints; it is ignored"
    accessors = dict(_objects(document, "accessors"))
    matrices = _named(accessors, skin, "inverseBindMatrices")
    count, view = matrices.get("count"), _named(dict(_objects(document, "bufferViews")), matrices, "bufferView")
    if isinstance(count, int) and count < len(joints):
        yield f"{where}/inverseBindMatrices", f"has {count} matrices for {len(joints)} joints; a mesh that hangs there is left out"
    if "byteStride" in view:
        yield f"{where}/inverseBindMatrices", "its bufferView has a byteStride, which is read as it stands; the rule is ignored"


def _line(node: int, parent: Mapping[int, int]) -> list[int]:
    """A node and those above it."""
    line = [node]
    while line[-1] in parent and len(line) <= len(parent):
        line.append(parent[line[-1]])
    return line


_SIZES = {"5120": 1, "5121": 1, "5122": 2, "5123": 2, "5125": 4, "5126": 4}
_NUMBERS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def _of_storage(document: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    buffers, views = dict(_objects(document, "buffers")), dict(_objects(document, "bufferViews"))
    for k, buffer in buffers.items():
        uri = buffer.get("uri")
        if isinstance(uri, str) and uri[:5].lower() == "data:":
            kind = uri[5:].partition(",")[0].partition(";")[0].lower()
            if ";;" in uri.partition(",")[0] or kind not in ("application/octet-stream", "application/gltf-buffer", ""):
                yield f"/buffers/{k}/uri", f"is data of the kind {quoted(kind)}; what it says it is is ignored"
    for k, view in views.items():
        start, length, stride = view.get("byteOffset", 0), view.get("byteLength"), view.get("byteStride")
        whole = _named(buffers, view, "buffer").get("byteLength")
        if all(isinstance(number, int) for number in (start, length, whole)) and start + length > whole:
            yield f"/bufferViews/{k}", f"reaches beyond the {whole} bytes of its buffer; what reads there is left out"
        if isinstance(stride, int) and stride % 4:
            yield f"/bufferViews/{k}/byteStride", f"must be a multiple of 4, got {stride}; it is read as it stands, the rule is ignored"
    for k, accessor in _objects(document, "accessors"):
        yield from _of_accessor(f"/accessors/{k}", accessor, views)
    textures = [texture for _, texture in _objects(document, "textures")]
    shown = [held.get("source") for texture in textures for held in (texture, *_dicts(texture.get("extensions")))]
    in_textures = {number for number in shown if isinstance(number, int)}
    for k, image in _objects(document, "images"):
        if k not in in_textures:
            yield f"/images/{k}", "is in no texture and is not read"
        if ("uri" in image) + ("bufferView" in image) != 1:
            yield f"/images/{k}", "must have one of uri and bufferView; surfaces are drawn without it"
        if image.get("mimeType") == "image/webp" and "EXT_texture_webp" not in _list(document, "extensionsUsed"):
            yield f"/images/{k}", "is WebP, whose extension is not among the extensionsUsed; that is ignored"


def _of_accessor(where: str, accessor: Mapping[str, Any], views: Mapping[int, Mapping[str, Any]]) -> Iterator[tuple[str, str]]:
    size, numbers = _SIZES.get(str(accessor.get("componentType"))), _NUMBERS.get(str(accessor.get("type")))
    view = _named(views, accessor, "bufferView")
    count: Any = accessor.get("count")
    offset, stride, start = accessor.get("byteOffset", 0), view.get("byteStride"), view.get("byteOffset", 0)
    sparse = accessor.get("sparse")
    if isinstance(sparse, dict) and isinstance(count, int) and isinstance(sparse.get("count"), int) and sparse["count"] > count:
        yield f"{where}/sparse/count", f"replaces {sparse['count']} of {count} elements; what reads it is left out"
    if size is None or numbers is None or not view or not all(isinstance(number, int) for number in (offset, count, start)):
        return
    if (offset + start) % size:
        yield where, f"begins at no multiple of its {size} bytes; it is read as it stands, the rule is ignored"
    if isinstance(stride, int) and stride < size * numbers:
        yield where, f"has elements of {size * numbers} bytes, one each {stride}; what reads it is left out"
    length = view.get("byteLength")
    step = stride if isinstance(stride, int) and stride else size * numbers
    if isinstance(length, int) and count > 0 and offset + (count - 1) * step + size * numbers > length:
        yield where, f"reaches beyond the {length} bytes of its bufferView; what reads it is left out"


def _list(value: Mapping[str, Any], key: str) -> list[Any]:
    held = value.get(key)
    return held if isinstance(held, list) else []


def _objects(document: Mapping[str, Any], key: str) -> list[tuple[int, dict[str, Any]]]:
    return [(k, held) for k, held in enumerate(_list(document, key)) if isinstance(held, dict)]


def _named(known: Mapping[int, Mapping[str, Any]], value: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    """What a member refers to; nothing where it refers to nothing."""
    number = value.get(key)
    return known.get(number, {}) if isinstance(number, int) else {}


def _dicts(held: Any) -> list[dict[str, Any]]:
    return [one for one in held.values() if isinstance(one, dict)] if isinstance(held, dict) else []


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
