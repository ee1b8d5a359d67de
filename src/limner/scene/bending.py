"""Meshes that bend while a shutter is open: what they are at its first moment, and at keys until it closes.

    scene, bent = bent_meshes(lambda time: posed(animated(walk, "Walk", time), time), (0.0, 0.04))

Between two keys a vertex goes straight. A joint that turns takes it along an arc, so there are as many keys as it takes for the arc and its
chords to look alike: up to 17, evenly in time. A key frame of step animation is passed over as quickly as two keys follow each other.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from ..mesh.mesh import Mesh
from .scene import Scene

__all__ = ["bent_meshes"]

_FEW, _MANY = 9, 17  # keys
_TOLERANCE = 1e-3  # how far a vertex may be from its place, as part of the mesh's size


def bent_meshes(pose_at: Callable[[float], Scene], opening: Scene, shutter: tuple[float, float]) -> dict[Mesh, tuple[Mesh, ...]]:
    """What the meshes of a scene turn into until the shutter closes; those that do not bend are left out.

    Parameters
    ----------
    pose_at : function of a time to Scene
        The same nodes and shapes at each time, their meshes bent (`limner.scene.pose.posed`).
    opening : Scene
        What it gives for the first moment.
    shutter : (float, float)
        When it opens and closes.

    Returns
    -------
    dict of Mesh to tuple of Mesh
        For a mesh of `opening`, its later keys, evenly in time, the last when the shutter closes.
    """
    first, last = shutter
    if not first < last:
        return {}
    times = np.linspace(first, last, _MANY)
    coarse = range(0, _MANY, (_MANY - 1) // (_FEW - 1))
    poses = {k: _meshes(pose_at(float(times[k]))) for k in coarse[1:]}
    poses[0] = _meshes(opening)
    found = {}
    for row, mesh in enumerate(poses[0]):
        keys = [poses[k][row] for k in coarse]
        if not all(_same(mesh, key) for key in keys[1:]):
            found[row] = keys
    # Halving the steps makes an arc's chords four times as good.
    if any(_misfit(keys, 2) > 4.0 * _TOLERANCE for keys in found.values()):
        poses |= {k: _meshes(pose_at(float(times[k]))) for k in range(1, _MANY, 2)}
        found = {row: [poses[k][row] for k in range(_MANY)] for row in found}
    return {poses[0][row]: tuple(_as_few_as_do(keys)[1:]) for row, keys in found.items()}


def _meshes(scene: Scene) -> list[Mesh]:
    """Every mesh, hidden ones too: what is visible may change with time."""
    return [shape.geometry for placed in scene.root.walk() for shape in placed.node.shapes if isinstance(shape.geometry, Mesh)]


def _same(a: Mesh, b: Mesh) -> bool:
    same_normals = a.normals is b.normals or (a.normals is not None and b.normals is not None and np.array_equal(a.normals, b.normals))
    return a is b or (np.array_equal(a.positions, b.positions) and same_normals)


def _as_few_as_do(keys: list[Mesh]) -> list[Mesh]:
    """Every so-manieth of the keys, as few as lead all vertices near enough to where they are."""
    steps = [1 << k for k in range((len(keys) - 1).bit_length() - 1, -1, -1)]
    return next(keys[::step] for step in steps if step == 1 or _misfit(keys, step) <= _TOLERANCE)


def _misfit(keys: list[Mesh], step: int) -> float:
    """How far vertices and normals are from their places, at most, where only every `step`th key is kept; in parts of the mesh's size."""
    box = keys[0].bounds
    size = float(np.linalg.norm(box[1] - box[0])) or 1.0
    worst = 0.0
    for start, end in pairwise(range(0, len(keys), step)):
        for k in range(start + 1, end):
            share = (k - start) / (end - start)
            between = (1.0 - share) * keys[start].positions.astype(np.float64) + share * keys[end].positions
            worst = max(worst, float(np.abs(between - keys[k].positions).max(initial=0.0)) / size)
    return worst
