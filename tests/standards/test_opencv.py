"""OpenCV, which measures with pictures for a living, sees every point in the same pixel."""

from __future__ import annotations

import numpy as np
import pytest

from limner.scene.camera import OrthographicCamera, PerspectiveCamera

cv2 = pytest.importorskip("cv2", reason="opencv-python-headless belongs to the extra `test`")


def _random_camera(random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray, int, int]:
    """K, rvec, tvec and a size: off centre, unequal focal lengths, any pose."""
    width, height = (int(n) for n in random.integers(1, 4000, 2))
    fx, fy = random.uniform(0.3, 4.0, 2) * height
    cx, cy = random.uniform(-0.5, 1.5, 2) * (width, height)
    K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    return K, random.normal(size=3), random.uniform(-5.0, 5.0, 3), width, height


@pytest.mark.parametrize("seed", range(50))
def test_projectPoints_agrees(seed: int) -> None:
    """A thousand points before a calibrated camera: within 1e-6 pixel of their distance from the principal point, at most 1e-4."""
    random = np.random.default_rng(seed)
    K, rvec, tvec, width, height = _random_camera(random)
    rotation = cv2.Rodrigues(rvec)[0]
    seen = random.uniform((-2, -2, 0.5), (2, 2, 20), (1000, 3))  # in the camera's frame
    points = (seen - tvec) @ rotation
    expected = cv2.projectPoints(points, rvec, tvec, K, None)[0].reshape(-1, 2)
    camera = PerspectiveCamera.from_opencv(K, np.hstack([rotation, tvec.reshape(3, 1)]), width, height)
    xy, depth = camera.project(points, width, height)
    np.testing.assert_allclose(xy, expected, rtol=0, atol=1e-6)
    np.testing.assert_allclose(depth, seen[:, 2], atol=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_what_we_say_in_its_words_it_understands(seed: int) -> None:
    """`to_opencv` of a camera that looks at something off centre: OpenCV sees the same pixels."""
    random = np.random.default_rng(seed)
    camera = PerspectiveCamera.look_at(
        random.uniform(3, 6, 3), random.uniform(-1, 1, 3), yfov_degrees=35.0, shift_x=random.uniform(-1, 1),
        shift_y=random.uniform(-1, 1), pixel_aspect=random.uniform(0.5, 2.0),
    )  # fmt: skip
    points = random.uniform(-1.0, 1.0, (500, 3))
    K, world_to_camera = camera.to_opencv(640, 480)
    rvec = cv2.Rodrigues(world_to_camera[:3, :3])[0]
    expected = cv2.projectPoints(points, rvec, world_to_camera[:3, 3], K, None)[0].reshape(-1, 2)
    np.testing.assert_allclose(camera.project(points, 640, 480)[0], expected, rtol=0, atol=1e-7)


def test_solvePnP_finds_where_the_camera_stands() -> None:
    """From what `project` says of eight corners and K, the pose comes back: nothing is mirrored or half a pixel off."""
    camera = PerspectiveCamera.orbit((0.2, 0.1, 0.0), 5.0, 40.0, 25.0, yfov_degrees=30.0, shift_x=0.2)
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.4, 0.4) for z in (-0.3, 0.3)])
    K, world_to_camera = camera.to_opencv(800, 600)
    found, rvec, tvec = cv2.solvePnP(corners, camera.project(corners, 800, 600)[0], K, None)
    assert found
    np.testing.assert_allclose(cv2.Rodrigues(rvec)[0], world_to_camera[:3, :3], atol=1e-6)
    np.testing.assert_allclose(tvec.ravel(), world_to_camera[:3, 3], atol=1e-5)


def test_parallel_projection_is_K_without_the_division() -> None:
    """OpenCV has no such camera, but its K and pose say where a point is seen."""
    camera = OrthographicCamera.look_at((3, 4, 5), (0, 0, 0), height=3.0, shift_y=0.5, pixel_aspect=2.0)
    points = np.random.default_rng(1).normal(size=(100, 3))
    K, world_to_camera = camera.to_opencv(64, 48)
    p_camera = points @ world_to_camera[:3, :3].T + world_to_camera[:3, 3]
    xy, depth = camera.project(points, 64, 48)
    np.testing.assert_allclose(xy, p_camera[:, :2] * (K[0, 0], K[1, 1]) + K[:2, 2], atol=1e-10)
    np.testing.assert_allclose(depth, p_camera[:, 2], atol=1e-12)
