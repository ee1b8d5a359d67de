"""What bends a mesh: shapes that it turns into, and bones that it hangs on (glTF 2.0, 3.7.2.2 and 3.7.3).

A *morph* says how far each vertex goes when its weight is 1; the weights are the node's. A *binding* says by which joints each vertex
is led, and how much by each; the joints are the node's *skin*: other nodes of the scene, by their paths, each with the matrix that takes
the mesh into its space. Posing a mesh, `posed_mesh`, is NumPy alone: what comes out is an ordinary mesh.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..mesh.mesh import Mesh, read_only
from ._values import numbers

__all__ = ["Binding", "Morph", "Skin", "posed_mesh"]

Floats = NDArray[np.float64]

_SUM_TOLERANCE = 1e-6  # of weights that sum to 1


@dataclass(frozen=True, eq=False)
class Morph:
    """How far a mesh's vertices go, in its own space, when the weight is 1.

    Parameters
    ----------
    positions : (n, 3) float32, optional
        One row for each position of the mesh; None: they stay.
    normals : (k, 3) float32, optional
        One row for each normal of the mesh. None: the normals stay.
    tangents : (k, 3) float32, optional
        One row for each tangent.
    name : str
    """

    positions: NDArray[np.float32] | None = None
    normals: NDArray[np.float32] | None = None
    tangents: NDArray[np.float32] | None = None
    name: str = ""

    def __post_init__(self) -> None:
        for field in ("positions", "normals", "tangents"):
            given = getattr(self, field)
            if given is not None:
                made = read_only(given, np.float32, (3,), f"morph.{field}")
                if not np.isfinite(made).all():
                    raise SceneError(f"morph.{field} must be finite", self.name)
                object.__setattr__(self, field, made)

    def check(self, mesh: Mesh) -> None:
        """Raise SceneError unless it has a row for each of the mesh's."""
        for field in ("positions", "normals", "tangents"):
            given, moved = getattr(self, field), getattr(mesh, field)
            if given is not None and (moved is None or len(given) != len(moved)):
                count = 0 if moved is None else len(moved)
                raise SceneError(f"morph.{field} must have a row for each of the mesh's {count} {field}, got {len(given)}", self.name)


@dataclass(frozen=True, eq=False)
class Binding:
    """Which joints lead each vertex, and by how much.

    Parameters
    ----------
    joints : (n, k) int32
        Indices into the joints of the node's skin; any number k for a vertex.
    weights : (n, k) float32 >= 0
        Made to sum to 1; a vertex without weights is led by its first joint.
    """

    joints: NDArray[np.int32]
    weights: NDArray[np.float32]

    def __post_init__(self) -> None:
        joints, weights = np.array(self.joints), np.array(self.weights, dtype=np.float32)
        if joints.dtype.kind not in "iu" or joints.ndim != 2 or not joints.shape[1] or (joints.size and int(joints.min()) < 0):
            raise SceneError(f"binding.joints must be integers >= 0 of shape (n, k), got {joints.shape} {joints.dtype}")
        if weights.shape != joints.shape:
            raise SceneError(f"binding.weights must have the shape of binding.joints, {joints.shape}, got {weights.shape}")
        if not np.isfinite(weights).all() or (weights.size and float(weights.min()) < 0.0):
            raise SceneError("binding.weights must be finite and not negative")
        total = weights.sum(axis=1, dtype=np.float64)
        alone = total <= 0.0
        # What rounding left of a sum of 1 stays, so that weights that were made so once are not changed again.
        sound = alone | (np.abs(total - 1.0) <= _SUM_TOLERANCE)
        made = (weights / np.where(sound, 1.0, total)[:, None]).astype(np.float32)
        made[alone, 0] = 1.0
        for name, array in (("joints", np.ascontiguousarray(joints, dtype=np.int32)), ("weights", made)):
            array.flags.writeable = False
            object.__setattr__(self, name, array)


@dataclass(frozen=True, eq=False)
class Skin:
    """The joints that lead the meshes of a node.

    Parameters
    ----------
    joints : tuple of str
        Paths of nodes, as in `Placed.path`.
    joint_from_mesh : (n, 4, 4) float64, optional
        What takes the mesh as it was modelled into each joint's space (glTF's inverse bind matrices); None: identities.
    name : str
    """

    joints: tuple[str, ...]
    joint_from_mesh: Floats | None = None
    name: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "joints", tuple(self.joints))
        if not self.joints or not all(isinstance(joint, str) for joint in self.joints):
            raise SceneError(f"skin.joints must be paths of nodes, at least one, got {self.joints!r}", self.name)
        given = np.tile(np.eye(4), (len(self.joints), 1, 1)) if self.joint_from_mesh is None else self.joint_from_mesh
        matrices = numbers(given, "skin.joint_from_mesh")
        if matrices.shape != (len(self.joints), 4, 4):
            raise SceneError(f"skin.joint_from_mesh must have shape ({len(self.joints)}, 4, 4), got {matrices.shape}", self.name)
        matrices.flags.writeable = False
        object.__setattr__(self, "joint_from_mesh", matrices)


def posed_mesh(
    mesh: Mesh, morphs: Sequence[Morph], weights: Sequence[float], binding: Binding | None = None, mesh_from_bound: Floats | None = None
) -> Mesh:
    """Bend a mesh: morphs first, then the joints.

    Parameters
    ----------
    mesh : Mesh
    morphs, weights : sequences of equal length
        Weights beyond the morphs are left out; missing ones are 0.
    binding : Binding, optional
    mesh_from_bound : (n, 4, 4) float64, optional
        For each joint, what takes the mesh as it was modelled to where the joint holds it now.

    Returns
    -------
    Mesh
        With the triangles, texture coordinates and colours of the given one.

    **Source**: glTF 2.0, 3.7.2.2: ``p + sum w_i d_i``; 3.7.3.1: ``sum w_j M_j p`` (linear blend skinning: Magnenat-Thalmann et al.,
    *Joint-dependent local deformations*, Graphics Interface 1988). Normals go by the cofactors of the blended matrix (FoCG 6.2.2).
    """
    positions = _morphed(mesh.positions, [morph.positions for morph in morphs], weights)
    normals = None if mesh.normals is None else _morphed(mesh.normals, [morph.normals for morph in morphs], weights)
    tangents = None if mesh.tangents is None else _morphed(mesh.tangents[:, :3], [morph.tangents for morph in morphs], weights)
    if binding is not None and mesh_from_bound is not None:
        blended = _blended(binding, mesh_from_bound)
        positions = (blended[:, :, :3] @ positions[:, :, None])[:, :, 0] + blended[:, :, 3]
        if normals is not None:
            linear = blended[_position_of_normal(mesh), :, :3]
            normals = (_cofactors(linear) @ normals[:, :, None])[:, :, 0]
            if tangents is not None:
                tangents = (linear @ tangents[:, :, None])[:, :, 0]
    changes: dict[str, NDArray[np.float32]] = {"positions": _finite(positions, mesh.positions)}
    if normals is not None and mesh.normals is not None:
        changes["normals"] = _unit(normals, mesh.normals)
    if tangents is not None and mesh.tangents is not None:
        changes["tangents"] = np.concatenate([_unit(tangents, mesh.tangents[:, :3]), mesh.tangents[:, 3:]], axis=1)
    return dataclasses.replace(mesh, **changes)  # type: ignore[arg-type]


def _morphed(base: NDArray[np.float32], deltas: list[NDArray[np.float32] | None], weights: Sequence[float]) -> Floats:
    moved = base.astype(np.float64)
    for delta, weight in zip(deltas, weights, strict=False):
        if delta is not None and weight:
            moved += weight * delta
    return moved


def _blended(binding: Binding, matrices: Floats) -> Floats:
    """(n, 3, 4): each vertex's mean of the matrices of its joints."""
    rows = matrices[:, :3].reshape(-1, 12)
    total = np.zeros((len(binding.joints), 12))
    for joint, weight in zip(binding.joints.T, binding.weights.T, strict=True):
        total += weight[:, None] * rows[joint]
    return total.reshape(-1, 3, 4)


def _position_of_normal(mesh: Mesh) -> NDArray[np.int64] | slice:
    """Which position goes with each normal: the first corner that has it says so."""
    if mesh.normal_triangles is None:
        return slice(None)
    assert mesh.normals is not None
    place = np.zeros(len(mesh.normals), dtype=np.int64)
    place[mesh.normal_triangles.reshape(-1)[::-1]] = mesh.triangles.reshape(-1)[::-1]
    return place


def _cofactors(linear: Floats) -> Floats:
    """What normals are multiplied by: the columns are the cross products of the matrix's other two."""
    turned, more = linear[..., [1, 2, 0], :], linear[..., [2, 0, 1], :]
    made: Floats = turned[..., [1, 2, 0]] * more[..., [2, 0, 1]] - more[..., [1, 2, 0]] * turned[..., [2, 0, 1]]
    return made


def _finite(values: Floats, otherwise: NDArray[np.float32]) -> NDArray[np.float32]:
    with np.errstate(over="ignore"):
        made = values.astype(np.float32)
    return np.where(np.isfinite(made).all(axis=1, keepdims=True), made, otherwise)


def _unit(vectors: Floats, otherwise: NDArray[np.float32]) -> NDArray[np.float32]:
    """Unit vectors; those of no length stay as they were."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    good = np.isfinite(length) & (length > 0.0)
    return np.where(good, vectors / np.where(good, length, 1.0), otherwise).astype(np.float32)
