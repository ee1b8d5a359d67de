"""Morph targets and skins of a glTF file (glTF 2.0, 3.7.2.2 and 3.7.3)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..errors import LimnerError
from ..mesh.mesh import Mesh
from ..scene.rig import Binding, Morph, Skin
from .accessors import Accessors
from .document import Element
from .notes import Notes, without_path

__all__ = ["Rigs"]

_MOVED = {"POSITION": "positions", "NORMAL": "normals", "TANGENT": "tangents"}
_MOST_SETS = 16  # of joints and weights; a file has one or two

Kept = NDArray[np.int64] | None


class Rigs:
    """What bends the meshes of one glTF file.

    Parameters
    ----------
    root : Element
        The document.
    """

    def __init__(self, root: Element, accessors: Accessors, notes: Notes) -> None:
        self._skins = root.array("skins")
        self._meshes = root.array("meshes")
        self._accessors = accessors
        self._notes = notes
        self._n_nodes = len(root.array("nodes"))

    def morphs(self, primitive: Element, mesh: Mesh, n_vertices: int, kept: Kept) -> tuple[Morph, ...]:
        """The morph targets of a primitive that has `n_vertices`, of which its mesh kept `kept` (None: all)."""
        if not primitive.has("targets"):
            return ()
        names = _target_names(primitive) or _target_names(self._mesh_of(primitive))
        found = []
        for k, target in enumerate(primitive.array("targets")):
            fields = {}
            for key, field in _MOVED.items():
                values = self._deltas(target, key, n_vertices, kept)
                if values is not None and getattr(mesh, field) is not None:
                    fields[field] = values
            others = [key for key in target.keys() if key not in _MOVED]  # noqa: SIM118 - an Element is no dict
            if others:
                self._notes.add(f"morph targets change {', '.join(sorted(others)[:4])}, which stays as it is", target.pointer)
            found.append(Morph(**fields, name=names[k] if k < len(names) else ""))
        return tuple(found)

    def _mesh_of(self, primitive: Element) -> Element:
        """The mesh that a primitive is part of: "/meshes/0" of "/meshes/0/primitives/1"."""
        return self._meshes[int(primitive.pointer.split("/")[2])]

    def _deltas(self, target: Element, key: str, n_vertices: int, kept: Kept) -> NDArray[np.float32] | None:
        reference = target.get(key)
        if reference is None:
            return None
        try:
            values = self._accessors.floats(reference, "VEC3")
            if len(values) != n_vertices:
                raise reference.error(f"must have one element per position ({n_vertices}), got {len(values)}")
        except LimnerError as error:
            self._notes.slip(f"morphed without: {without_path(error)}")
            return None
        values = values if kept is None else values[kept]
        good = np.isfinite(values).all(axis=1, keepdims=True)
        if not good.all():
            self._notes.slip("rows that are not finite are set to 0", reference.pointer)
        return np.where(good, values, np.float32(0.0))

    def binding(self, primitive: Element, n_vertices: int, kept: Kept) -> Binding | None:
        """Which joints lead each vertex of a primitive; None where it names none."""
        attributes = primitive.child("attributes")
        joints, weights = [], []
        for k in range(_MOST_SETS):
            names = (f"JOINTS_{k}", f"WEIGHTS_{k}")
            references = [attributes.get(name) for name in names]
            if references[0] is None or references[1] is None:
                if references != [None, None]:
                    self._notes.slip(f"{' and '.join(names)} must come together; the set is left out", attributes.pointer)
                break
            try:
                led = self._accessors.read(references[0], "VEC4")
                by = self._accessors.floats(references[1], "VEC4", normalize=True)
                for reference, values in zip(references, (led, by), strict=True):
                    if reference is not None and len(values) != n_vertices:
                        raise reference.error(f"must have one element per position ({n_vertices}), got {len(values)}")
                if led.dtype.kind != "u":
                    raise references[0].error(f"joints must be unsigned integers, got {led.dtype}")
            except LimnerError as error:
                self._notes.slip(f"not led by joints: {without_path(error)}")
                return None
            joints.append(led if kept is None else led[kept])
            weights.append(by if kept is None else by[kept])
        if not joints:
            return None
        led_by, shares = np.concatenate(joints, axis=1).astype(np.int32), np.concatenate(weights, axis=1)
        good = np.isfinite(shares) & (shares >= 0.0)
        if not good.all():
            self._notes.slip("weights that are negative or not finite are set to 0", attributes.pointer)
        # What has no weight may name any joint, also one that does not exist.
        shares = np.where(good, shares, np.float32(0.0))
        return Binding(np.where(shares > 0.0, led_by, 0), shares)

    def skin(self, node: Element, paths: Mapping[int, str]) -> Skin | None:
        """The skin of a node; `paths` are those of the nodes that the scene shows."""
        reference = node.get("skin")
        if reference is None:
            return None
        try:
            skin = self._skins[reference.index(len(self._skins))]
            joints = [joint.index(self._n_nodes) for joint in skin.array("joints")]
            if not joints:
                raise skin.error("must not be empty", "joints")
            missing = [joint for joint in joints if joint not in paths]
            if missing:
                raise skin.error(f"node {missing[0]} is not in the scene", "joints")
            return Skin(tuple(paths[joint] for joint in joints), self._joint_from_mesh(skin, len(joints)), skin.name())
        except LimnerError as error:
            self._notes.slip(f"{node.pointer} is shown without its skin: {without_path(error)}")
            return None

    def _joint_from_mesh(self, skin: Element, n_joints: int) -> NDArray[np.float64] | None:
        reference = skin.get("inverseBindMatrices")
        if reference is None:
            return None
        matrices = self._accessors.floats(reference, "MAT4")
        if len(matrices) < n_joints or not np.isfinite(matrices[:n_joints]).all():
            raise reference.error(f"must be {n_joints} finite matrices, one for each joint, got {len(matrices)}")
        made = matrices[:n_joints].astype(np.float64).reshape(-1, 4, 4).transpose(0, 2, 1).copy()
        made[:, 3] = (0.0, 0.0, 0.0, 1.0)
        return made


def _target_names(owner: Element) -> list[str]:
    """What exporters call the targets, where they say it: in the extras of the mesh, some in those of the primitive."""
    extras = owner.value.get("extras") if isinstance(owner.value, dict) else None
    names = extras.get("targetNames") if isinstance(extras, dict) else None
    return [name if isinstance(name, str) else "" for name in names] if isinstance(names, list) else []
