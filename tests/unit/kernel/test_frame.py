"""Frames are orthonormal and right-handed for every normal, poles included, and carry vectors there and back."""

from __future__ import annotations

import numpy as np
from compiled import over

from limner._jit import kernel
from limner.kernel.frame import frame_from_normal, to_local, to_world
from limner.kernel.vec import Vec3


@kernel
def _there(n: Vec3, v: Vec3) -> Vec3:
    return to_world(frame_from_normal(n), v)


@kernel
def _back(n: Vec3, v: Vec3) -> Vec3:
    return to_local(frame_from_normal(n), v)


def _normals() -> np.ndarray:
    """Random ones, the axes, and the neighbourhood of the pole z = -1, where older constructions break down."""
    rng = np.random.default_rng(0)
    random = rng.normal(size=(400, 3))
    axes = np.vstack([np.eye(3), -np.eye(3)])
    tilt = np.exp2(rng.uniform(-40, -2, 200))
    turn = rng.uniform(0, 2 * np.pi, 200)
    near = np.stack([tilt * np.cos(turn), tilt * np.sin(turn), rng.choice([-1.0, 1.0], 200)], axis=1)
    horizon = np.stack([np.cos(turn), np.sin(turn), rng.choice([0.0, -0.0, 1e-30, -1e-30], 200)], axis=1)
    n = np.vstack([random, axes, near, horizon])
    return (n / np.linalg.norm(n, axis=1, keepdims=True)).astype(np.float32)


def test_frames_are_orthonormal_and_right_handed() -> None:
    """M M^T = 1 within 6 eps and det M = +1; the third axis is the normal itself."""
    n = _normals()
    axes = np.stack(over(frame_from_normal, n), axis=1).astype(np.float64)
    np.testing.assert_allclose(axes @ axes.transpose(0, 2, 1), np.broadcast_to(np.eye(3), axes.shape), atol=7e-7)
    np.testing.assert_allclose(np.linalg.det(axes), 1.0, atol=1e-6)
    np.testing.assert_array_equal(axes[:, 2], n)


def test_there_and_back() -> None:
    """to_local undoes to_world; +z goes to the normal; lengths are kept."""
    n = _normals()
    v = np.random.default_rng(1).normal(size=n.shape).astype(np.float32)
    world = over(_there, n, v)
    np.testing.assert_allclose(over(_back, n, world), v, atol=4e-6)
    np.testing.assert_allclose(np.linalg.norm(world, axis=1), np.linalg.norm(v, axis=1), rtol=1e-6)
    np.testing.assert_array_equal(over(_there, n, [0, 0, 1]), n)
