"""Laws of transformations (FoCG 6, 7), and two oracles that came to the same numbers by themselves: SciPy and trimesh."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation, Slerp

from limner.linear import affine, decompose, inverse, projection, quaternion, transform, viewport

numbers = st.integers(-192, 192).map(lambda n: n / 64.0)
vectors = arrays(np.float64, 3, elements=numbers)
directions = vectors.filter(np.any)
angles = st.floats(-10.0, 10.0)
quaternions = arrays(np.float64, 4, elements=numbers).filter(np.any)
sizes = arrays(np.float64, 3, elements=numbers.filter(bool))
shares = st.floats(0.0, 1.0)
IDENTITY = np.eye(4)


@given(directions, angles)
def test_rotations_keep_lengths_angles_and_hands(axis, angle):
    """R^T R = I and det R = +1."""
    turn = transform.rotate(axis, angle)[:3, :3]
    np.testing.assert_allclose(turn.T @ turn, np.eye(3), atol=1e-14)
    assert np.linalg.det(turn) == pytest.approx(1.0)


@given(directions, angles, angles)
def test_turns_about_one_axis_add(axis, first, second):
    both = affine.in_order(transform.rotate(axis, first), transform.rotate(axis, second))
    np.testing.assert_allclose(both, transform.rotate(axis, first + second), atol=1e-13)


@given(directions, directions)
def test_two_mirrors_are_a_turn_by_twice_the_angle_between_them(a, b):
    """So every rotation is two reflections."""
    _, between = quaternion.axis_and_angle(quaternion.between(a, b))
    turned = affine.in_order(transform.reflect(a), transform.reflect(b))
    _, angle = quaternion.axis_and_angle(quaternion.from_matrix(turned))
    assert np.cos(float(angle)) == pytest.approx(np.cos(2.0 * float(between)), abs=1e-9)
    assert np.linalg.det(turned) == pytest.approx(1.0)
    assert np.linalg.det(transform.reflect(a)) == pytest.approx(-1.0)


@given(vectors, quaternions, sizes, vectors, directions)
def test_inverses_undo_in_reversed_order(move, turn, size, push, normal):
    """(S H R T)^-1 by structure: T, then R, then H, then S are taken back."""
    steps = [transform.translate(*move), affine.affine(quaternion.to_matrix(turn)), transform.shear(push, normal), transform.scale(*size)]
    undo = [inverse.inverse_translation, inverse.inverse_rotation, inverse.inverse_shear, inverse.inverse_scale]
    there = affine.in_order(*steps)
    back = affine.in_order(*(invert(step) for invert, step in zip(reversed(undo), reversed(steps), strict=True)))
    scale = np.abs(there).max() * np.abs(back).max()
    np.testing.assert_allclose(back @ there, IDENTITY, atol=1e-13 * max(scale, 1.0))
    np.testing.assert_allclose(inverse.inverse_affine(there) @ there, IDENTITY, atol=1e-12 * max(scale, 1.0) ** 2)


@given(vectors, directions, vectors, sizes)
def test_a_sheared_surface_keeps_its_normal_by_cofactors_alone(push, normal, along, size):
    """FoCG 6.2.2: tangents go with M, normals with N; they stay at right angles, and on the side they were."""
    m = transform.shear(push, normal[::-1]) @ transform.scale(*size)
    tangent = np.cross(normal, along)
    bent, turned = transform.transform_vectors(m, tangent), transform.transform_normals(m, normal)
    assert abs(bent @ turned) <= 1e-12 * max(np.abs(bent).max(), 1.0)
    assert np.linalg.norm(turned) == pytest.approx(1.0)
    assert transform.transform_vectors(m, normal) @ turned > 0.0


@given(vectors, quaternions, sizes)
def test_trs_is_taken_apart_and_put_together(move, turn, size):
    m = transform.compose_trs(move, turn, size)
    np.testing.assert_allclose(transform.compose_trs(*decompose.trs(m)), m, atol=1e-12)


@given(arrays(np.float64, (4, 3, 3), elements=numbers))
def test_every_matrix_is_rotation_stretch_rotation(m):
    """Whole arrays at once; singular ones too."""
    after, factors, before = decompose.singular(m)
    np.testing.assert_allclose((after * factors[:, None, :]) @ np.swapaxes(before, -1, -2), m, atol=1e-12)
    rotation, stretch = decompose.polar(m)
    np.testing.assert_allclose(rotation @ stretch, m, atol=1e-12)


@given(st.floats(0.1, 3.0), st.floats(0.3, 3.0), st.floats(0.01, 1.0), vectors, st.booleans())
def test_unprojecting_undoes_projecting(half_height, aspect, near, point, endless):
    """World to raster and back, through the divide: the same homogeneous point up to a factor."""
    camera = transform.frame_from_gaze((1, 2, 9), (0, -0.1, -1), (0, 1, 0))
    clip_from_camera = projection.clip_from_camera_perspective(half_height, aspect, near, np.inf if endless else 50.0)
    raster_from_world = affine.in_order(projection.camera_from_world(camera), clip_from_camera, viewport.viewport(640, 480))
    seen = projection.divided(raster_from_world @ [*point, 1.0])
    back = affine.in_order(viewport.inverse_viewport(640, 480), projection.inverse_projection(clip_from_camera), camera)
    np.testing.assert_allclose(projection.divided(back @ [*seen, 1.0]), point, atol=1e-8)


@given(vectors, directions)
def test_lines_stay_lines_in_perspective(point, along):
    """FoCG 7.2: three points of a line are seen on a line, though not at equal distances."""
    m = projection.perspective(-1, 1, -1, 1, -1, -50)
    start = point - (0.0, 0.0, 12.0)
    a, b, c = (projection.divided(m @ [*(start + t * along), 1.0]) for t in (0.0, 1.0, 2.0))
    np.testing.assert_allclose(np.cross(b - a, c - a), 0.0, atol=1e-12)


@given(quaternions, quaternions, vectors)
def test_scipy_turns_alike(p, q, v):
    """Rotation: the same quaternions (x, y, z, w), matrices, products and turned vectors."""
    theirs = Rotation.from_quat(p)
    np.testing.assert_allclose(quaternion.to_matrix(p), theirs.as_matrix(), atol=1e-14)
    np.testing.assert_allclose(quaternion.rotate(p, v), theirs.apply(v), atol=1e-13)
    product = quaternion.to_matrix(quaternion.multiply(p, q))
    norm = np.linalg.norm(p) * np.linalg.norm(q)
    assert norm > 0.0
    np.testing.assert_allclose(product, (theirs * Rotation.from_quat(q)).as_matrix(), atol=1e-13)
    found = quaternion.from_matrix(theirs.as_matrix())
    np.testing.assert_allclose(found * np.sign(found @ theirs.as_quat()), theirs.as_quat(), atol=1e-13)


@given(directions, st.floats(-3.1, 3.1))
def test_scipy_turns_alike_about_any_axis(axis, angle):
    theirs = Rotation.from_rotvec(axis / np.linalg.norm(axis) * angle)
    np.testing.assert_allclose(transform.rotate(axis, angle)[:3, :3], theirs.as_matrix(), atol=1e-14)
    unit, turned = quaternion.axis_and_angle(quaternion.from_axis_angle(axis, angle))
    np.testing.assert_allclose(unit * turned, theirs.as_rotvec(), atol=1e-13)


@given(quaternions, quaternions, shares)
def test_scipy_slerps_alike(p, q, t):
    """But for half turns, where either way is as short."""
    if quaternion.angle_between(p, q) > np.pi - 1e-6:
        return
    theirs = Slerp([0.0, 1.0], Rotation.from_quat([p, q]))(t).as_matrix()
    np.testing.assert_allclose(quaternion.to_matrix(quaternion.slerp(p, q, t)), theirs, atol=1e-9)


@given(directions, vectors, angles)
def test_trimesh_transforms_alike(direction, point, angle):
    """Turns about lines, reflections across planes, shears, moves and scales; quaternions there are (w, x, y, z)."""
    oracle = pytest.importorskip("trimesh.transformations", reason="trimesh is not installed")
    turned = transform.rotate_about(point, direction, angle)
    np.testing.assert_allclose(turned, oracle.rotation_matrix(angle, direction, point), atol=1e-12)
    np.testing.assert_allclose(transform.reflect(direction, point), oracle.reflection_matrix(point, direction), atol=1e-12)
    np.testing.assert_array_equal(transform.translate(*point), oracle.translation_matrix(point))
    across = transform.basis(direction)[:, 0]
    sheared = affine.about(point, transform.shear(np.tan(0.5) * across, direction))
    np.testing.assert_allclose(sheared, oracle.shear_matrix(0.5, across, point, direction), atol=1e-12)
    wxyz = oracle.quaternion_about_axis(angle, direction)
    np.testing.assert_allclose(quaternion.from_axis_angle(direction, angle), wxyz[[1, 2, 3, 0]], atol=1e-14)


@given(vectors, quaternions, quaternions, sizes, shares)
def test_trimesh_decomposes_and_slerps_alike(move, p, q, size, t):
    oracle = pytest.importorskip("trimesh.transformations", reason="trimesh is not installed")
    m = transform.compose_trs(move, p, np.abs(size))
    scale, _, _, translation, _ = oracle.decompose_matrix(m)
    found = decompose.trs(m)
    np.testing.assert_allclose(found.size, scale, rtol=1e-9)
    np.testing.assert_allclose(found.translation, translation, atol=1e-12)
    if quaternion.angle_between(p, q) < np.pi - 1e-6:
        theirs = oracle.quaternion_slerp(p[[3, 0, 1, 2]], q[[3, 0, 1, 2]], t)[[1, 2, 3, 0]]
        np.testing.assert_allclose(quaternion.to_matrix(quaternion.slerp(p, q, t)), quaternion.to_matrix(theirs), atol=1e-9)
