"""Cameras (FoCG 7): where the eye stands, what it sees, and how that is thrown on the picture.

    camera = limner.Camera.look_at(eye=(3, 2, 5), target=(0, 0, 0), yfov_degrees=35)
    camera = limner.Camera.look_at(eye, target, focal_length_mm=85, f_number=1.8)         # a lens, in focus at the target
    camera = limner.Camera.orbit(target=(0, 0, 0), distance=6, azimuth_degrees=30, elevation_degrees=20, focal_length_mm=50)
    camera = limner.Camera.from_opencv(K, world_to_camera, width, height)
    xy, depth = camera.project(points, width, height)

A camera looks along its own -z with +y up; `world_from_camera` places it. Both kinds hold what a person says; the matrices
follow in `limner.linear`.

Pixels are counted as arrays are: x is the column and y the row from the top, the centre of the first pixel is (0, 0), and the
picture covers [-0.5, width - 0.5] x [-0.5, height - 0.5]: ``image.pixels[y, x]`` is what stands at (x, y), as in OpenCV.
"""

from __future__ import annotations

import dataclasses
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import SceneError, UnsupportedError
from ..linear import pose, transform
from ..linear.affine import cross
from ..linear.explain import Steps, point_to_pixel
from ..linear.inverse import inverse_rigid
from ..linear.project import Lens, intrinsics, lens_from_intrinsics, pixels_from_world, world_from_pixels
from ..linear.projection import camera_from_world
from ._values import finite, matrix4, positive, triple
from .motion import Motion

__all__ = ["Camera", "OrthographicCamera", "PerspectiveCamera"]

_FULL_FRAME_HEIGHT_MM = 24.0
_COLMAP_HALF = 0.5  # COLMAP's corner of the picture is (0, 0), so the centre of its first pixel is (0.5, 0.5)


def _look_at(eye: Any, target: Any, up: Any) -> NDArray[np.float64]:
    e = np.array(triple(eye, "camera.eye"))
    g = np.array(triple(target, "camera.target")) - e
    t = np.array(triple(up, "camera.up"))
    if not np.linalg.norm(g) > 0.0:
        raise SceneError(f"camera.eye and camera.target must differ, both are {tuple(e.tolist())}")
    if not np.linalg.norm(cross(t, g)) > 1e-9 * np.linalg.norm(t) * np.linalg.norm(g):
        raise SceneError(f"camera.up must not be zero or along the gaze, got up {tuple(t.tolist())}, gaze {tuple(g.tolist())}")
    return transform.frame_from_gaze(e, g, t)


def _orbit(target: Any, distance: Any, azimuth_degrees: Any, elevation_degrees: Any) -> NDArray[np.float64]:
    """The frame u, v, w of spherical coordinates, which at the poles goes on where `up` along the gaze would fail."""
    elevation_degrees = finite(elevation_degrees, "elevation_degrees")
    if not -90.0 <= elevation_degrees <= 90.0:
        raise SceneError(f"elevation_degrees must lie in [-90, 90], got {elevation_degrees}")
    azimuth, elevation = math.radians(finite(azimuth_degrees, "azimuth_degrees")), math.radians(elevation_degrees)
    w = np.array([math.sin(azimuth) * math.cos(elevation), math.sin(elevation), math.cos(azimuth) * math.cos(elevation)])
    u = np.array([math.cos(azimuth), 0.0, -math.sin(azimuth)])
    made = np.eye(4)
    made[:3, 0], made[:3, 1], made[:3, 2] = u, cross(w, u), w
    made[:3, 3] = np.array(triple(target, "camera.target")) + positive(distance, "distance") * w
    return made


def _identity() -> NDArray[np.float64]:
    return np.eye(4)


class _Placed(ABC):
    """What both kinds of camera share: a place in the world, and a window that may lie off the gaze."""

    world_from_camera: NDArray[np.float64]
    near: float | None
    far: float | None
    aspect: float | None
    shift_x: float
    shift_y: float
    pixel_aspect: float
    name: str
    motion: Motion | None

    def _check(self) -> None:
        matrix = matrix4(self.world_from_camera, "camera.world_from_camera")
        if not abs(np.linalg.det(matrix[:3, :3])) > 0.0:
            raise SceneError("camera.world_from_camera must not be singular", self.name)
        object.__setattr__(self, "world_from_camera", matrix)
        for name, check in (
            ("near", positive), ("far", positive), ("aspect", positive), ("pixel_aspect", positive), ("shift_x", finite),
            ("shift_y", finite),
        ):  # fmt: skip
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, check(value, f"camera.{name}"))
        if self.near is not None and self.far is not None and not self.near < self.far:
            raise SceneError(f"camera.near must be less than camera.far, got {self.near} and {self.far}", self.name)
        if isinstance(self.motion, Mapping):
            object.__setattr__(self, "motion", Motion(**self.motion))
        if self.motion is not None and not isinstance(self.motion, Motion):
            raise SceneError(f"camera.motion must be a Motion, got {type(self.motion).__name__}", self.name)

    def place(self, time: ArrayLike = 0.0) -> NDArray[np.float64]:
        """Where it stands at a time, (4, 4) float64, or at k times, (k, 4, 4) if it moves."""
        return self.world_from_camera if self.motion is None else self.world_from_camera @ self.motion.at(time)

    def standing(self, time: float = 0.0) -> Self:
        """The camera as it stands at a time; itself where it does not move."""
        return self if self.motion is None else self.replace(world_from_camera=self.place(time), motion=None)

    @classmethod
    def _from(cls, world_from_camera: NDArray[np.float64], fields: dict[str, Any]) -> Self:
        return cls(world_from_camera=world_from_camera, **fields)  # type: ignore[call-arg]

    @classmethod
    def look_at(cls, eye: Any, target: Any, up: Any = (0.0, 1.0, 0.0), **fields: Any) -> Self:
        """Stand at `eye`, look at `target`, hold `up` upright: the book's frame w = -g/|g|, u = t x w / |t x w|, v = w x u.

        Parameters
        ----------
        eye, target, up : (3,) floats
        **fields
            Any other field of the camera; a perspective camera also takes what says its field of view in other words:
            `focal_length_mm` (with `sensor_height_mm`, 24 where it is not said), or `xfov_degrees` with `aspect`; and the opening of
            its lens as `f_number`, with `focal_length_mm`. It is in focus at the target, unless `focus_distance` says otherwise.

        **Source**: FoCG 7.1.3.
        """
        return cls._from(_look_at(eye, target, up), _with_focus(fields, float(np.linalg.norm(np.subtract(target, eye)))))

    @classmethod
    def orbit(cls, target: Any, distance: float, azimuth_degrees: float = 0.0, elevation_degrees: float = 0.0, **fields: Any) -> Self:
        """Look at `target` from a point of the sphere around it, +y up.

        Parameters
        ----------
        target : (3,) floats
        distance : float > 0
        azimuth_degrees : float
            From +z (in front) towards +x (from the right).
        elevation_degrees : float in [-90, 90]
            Above the horizon. Straight from above, up is what it was on the way there.
        **fields
            As for `look_at`.

        Examples
        --------
        >>> PerspectiveCamera.orbit((0, 1, 0), 2.0, azimuth_degrees=90).world_from_camera[:3, 3].round(12).tolist()
        [2.0, 1.0, 0.0]
        """
        return cls._from(_orbit(target, distance, azimuth_degrees, elevation_degrees), _with_focus(fields, distance))

    def replace(self, **changes: Any) -> Self:
        """Return a copy with the given fields changed."""
        return dataclasses.replace(self, **changes)  # type: ignore[type-var]

    @abstractmethod
    def lens(self) -> Lens:
        """What the camera shows, whatever the number of pixels; each kind has its own."""

    def intrinsics(self, width: int, height: int) -> NDArray[np.float64]:
        """Return K for a picture of `width` x `height` pixels, centres at integers; see `limner.linear.project.intrinsics`.

        Returns
        -------
        (3, 3) float64
            In pixels; for parallel projection the focal lengths are pixels per metre, and there is no division by the depth.
        """
        return intrinsics(self.lens(), width, height)

    def project(self, points: ArrayLike, width: int, height: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Tell where points are seen.

        Parameters
        ----------
        points : (..., 3) float
            World space.
        width, height : int >= 1
            The picture's size in pixels.

        Returns
        -------
        xy : (..., 2) float64
            Column, and row from the top; pixel centres are integers. May lie outside the picture. NaN where a perspective camera
            has the point beside or behind its eye.
        depth : (...) float64
            Along the gaze, as the AOV `depth` has it; negative behind the eye. Near and far do not cut.

        Examples
        --------
        >>> camera = PerspectiveCamera.look_at((0, 0, 5), (0, 0, 0), yfov_degrees=90)
        >>> xy, depth = camera.project([[0, 0, 0], [0, 5, 0], [0, 0, 6]], 100, 100)
        >>> xy.round(9).tolist(), depth.tolist()
        ([[49.5, 49.5], [49.5, -0.5], [nan, nan]], [5.0, 5.0, -1.0])
        """
        return pixels_from_world(
            points, camera_from_world(self), self.intrinsics(width, height), perspective=isinstance(self, PerspectiveCamera)
        )

    def unproject(self, xy: ArrayLike, depth: ArrayLike, width: int, height: int) -> NDArray[np.float64]:
        """Tell what points are seen in pixels at given depths: the inverse of `project`.

        Parameters
        ----------
        xy : (..., 2) float
            Column, and row from the top; pixel centres are integers.
        depth : (...) float
            Along the gaze, as the AOV `depth` has it.
        width, height : int >= 1

        Returns
        -------
        (..., 3) float64
            World space; NaN where the depth is not finite.

        Examples
        --------
        A depth map becomes points in space:

        >>> camera, depth = PerspectiveCamera(yfov_degrees=90), np.full((2, 2), 3.0)
        >>> y, x = np.indices(depth.shape)
        >>> camera.unproject(np.stack([x, y], axis=-1), depth, 2, 2)[0, 0].round(9).tolist()
        [-1.5, 1.5, -3.0]
        """
        matrix, perspective = self.intrinsics(width, height), isinstance(self, PerspectiveCamera)
        return world_from_pixels(xy, depth, self.world_from_camera, matrix, perspective=perspective)

    def explain(self, point: ArrayLike, width: int, height: int) -> Steps:
        """Follow a point to its pixel step by step, with every matrix and number on the way; printed, a table.

        Parameters
        ----------
        point : (3,) float
            World space.
        width, height : int >= 1
            The picture's size in pixels.

        Examples
        --------
        >>> steps = PerspectiveCamera(yfov_degrees=90).explain((0, 1, -2), 100, 100)
        >>> steps.at("clip")[3], steps.at("pixel")
        (2.0, (49.5, 24.5))

        See `limner.linear.explain.point_to_pixel`, and `pixel_to_ray` for the way back.
        """
        return point_to_pixel(self, point, width, height)

    def to_opencv(self, width: int, height: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Say it in OpenCV's words: (3, 3) K and (4, 4) world_to_camera, x right, y down, z forward; float64.

        Of a camera with parallel projection, K holds pixels per metre.
        """
        return self.intrinsics(width, height), inverse_rigid(pose.turned(self.to_opengl()))

    def to_opengl(self) -> NDArray[np.float64]:
        """Say where it stands in OpenGL's words (and glTF's, Blender's, NeRF's): (4, 4) camera_to_world, looking along -z."""
        return pose.rigid(self.world_from_camera, "camera.world_from_camera")


@dataclass(frozen=True, eq=False)
class PerspectiveCamera(_Placed):
    """A pinhole camera, or one with a thin lens.

    Parameters
    ----------
    world_from_camera : (4, 4) float64
    yfov_degrees : float in (0, 180)
        The full vertical field of view; off centre: that of the same window, were it centred.
    near, far : float > 0, optional
        Distances along the gaze; None: from the scene's bounds.
    aspect : float > 0, optional
        Width / height; None: that of the picture.
    shift_x, shift_y : float
        Move the window over the picture plane, right and up, in half widths and half heights of the picture: with 1, the gaze meets
        the left or lower side. As the rise of a view camera, it shows more above without tilting the verticals.
    pixel_aspect : float > 0
        Width / height of a pixel.
    motion : Motion, optional
        How it moves, in its own space.
    aperture_radius : float >= 0, optional
        Of the opening of the lens, metres (FoCG 13.4.3); None or 0: a pinhole, to which everything is sharp. For `ray` and `path`.
    focus_distance : float > 0, optional
        Along the gaze to the plane that is in focus; needed where there is a lens.
    blades : int >= 3, optional
        Of the iris: the opening is a polygon of so many corners, the first one on top. None: a circle.
    """

    world_from_camera: NDArray[np.float64] = field(default_factory=_identity)
    yfov_degrees: float = 40.0
    near: float | None = None
    far: float | None = None
    aspect: float | None = None
    name: str = ""
    shift_x: float = 0.0
    shift_y: float = 0.0
    pixel_aspect: float = 1.0
    motion: Motion | None = None
    aperture_radius: float | None = None
    focus_distance: float | None = None
    blades: int | None = None

    def __post_init__(self) -> None:
        self._check()
        _check_opening(self)
        yfov = finite(self.yfov_degrees, "camera.yfov_degrees")
        if not 0.0 < yfov < 180.0:
            raise SceneError(f"camera.yfov_degrees must lie between 0 and 180, got {yfov}", self.name)
        object.__setattr__(self, "yfov_degrees", yfov)

    @classmethod
    def _from(cls, world_from_camera: NDArray[np.float64], fields: dict[str, Any]) -> Self:
        return cls(world_from_camera=world_from_camera, **_with_yfov(fields))

    @classmethod
    def from_focal_length(cls, focal_length_mm: float, sensor_height_mm: float = _FULL_FRAME_HEIGHT_MM, **fields: Any) -> PerspectiveCamera:
        """Take the field of view from a lens: the angle whose half has the tangent sensor height / (2 focal length).

        Parameters
        ----------
        focal_length_mm, sensor_height_mm : float > 0
            24 mm is the height of a 35 mm film frame, to which focal lengths are usually converted.
        **fields
            Any other field.

        Examples
        --------
        >>> round(PerspectiveCamera.from_focal_length(50).yfov_degrees, 2)
        26.99
        """
        return cls(**_with_yfov({"focal_length_mm": focal_length_mm, "sensor_height_mm": sensor_height_mm, **fields}))

    @classmethod
    def from_xfov(cls, xfov_degrees: float, aspect: float, **fields: Any) -> PerspectiveCamera:
        """Take the horizontal field of view, for pictures of width / height = `aspect`."""
        return cls(**_with_yfov({"xfov_degrees": xfov_degrees, "aspect": aspect, **fields}))

    @classmethod
    def from_opencv(
        cls,
        K: ArrayLike,  # noqa: N803 - as everyone calls it
        world_to_camera: ArrayLike,
        width: int,
        height: int,
        **fields: Any,
    ) -> PerspectiveCamera:
        """Take a calibrated camera as OpenCV has it.

        Parameters
        ----------
        K : (3, 3) float
            Focal lengths and principal point in pixels, the centre of the first pixel at (0, 0); no skew.
        world_to_camera : (4, 4) or (3, 4) float
            Rigid; x right, y down, z forward. Of `rvec, tvec`: ``np.hstack([cv2.Rodrigues(rvec)[0], tvec.reshape(3, 1)])``.
        width, height : int >= 1
            The size in pixels of the pictures that K belongs to. Pictures of another size show the same.
        **fields
            near, far, name.

        Lens distortion has no place here: undistort the pictures, or compare with `cv2.projectPoints` without coefficients.
        """
        world_from_camera = pose.turned(inverse_rigid(pose.rigid(world_to_camera, "world_to_camera")))
        return cls(world_from_camera=world_from_camera, **{**_lens_fields(lens_from_intrinsics(K, width, height)), **fields})

    @classmethod
    def from_opengl(
        cls,
        camera_to_world: ArrayLike,
        *,
        K: ArrayLike | None = None,  # noqa: N803 - as everyone calls it
        width: int | None = None,
        height: int | None = None,
        **fields: Any,
    ) -> PerspectiveCamera:
        """Take a pose as OpenGL, glTF, Blender and NeRF's data sets have it.

        Parameters
        ----------
        camera_to_world : (4, 4) or (3, 4) float
            Rigid; x right, y up, looking along -z.
        K : (3, 3) float, optional
            With `width` and `height`, as for `from_opencv`. In place of `yfov_degrees`, which may be said in the words of `look_at`.
        **fields
            Any other field.
        """
        place = pose.rigid(camera_to_world, "camera_to_world")
        if K is None:
            return cls._from(place, fields)
        if width is None or height is None:
            raise SceneError("K needs the width and height of the pictures that it belongs to")
        return cls(world_from_camera=place, **{**_lens_fields(lens_from_intrinsics(K, width, height)), **fields})

    @classmethod
    def from_colmap(
        cls,
        qvec: ArrayLike,
        tvec: ArrayLike,
        params: Sequence[float],
        width: int,
        height: int,
        *,
        model: str | None = None,
        **fields: Any,
    ) -> PerspectiveCamera:
        """Take a line of COLMAP's images.txt and one of its cameras.txt.

        Parameters
        ----------
        qvec : (4,) float
            Rotation from the world to the camera as a quaternion (w, x, y, z).
        tvec : (3,) float
        params : sequence of 3 or 4 floats
            SIMPLE_PINHOLE: f, cx, cy; PINHOLE: fx, fy, cx, cy. COLMAP's pixel centres stand at 0.5, which is reckoned with.
        width, height : int >= 1
        model : "SIMPLE_PINHOLE" | "PINHOLE", optional
            As cameras.txt says it; None: what the number of `params` tells. SIMPLE_RADIAL has as many as PINHOLE, so say it.
        **fields
            near, far, name.

        Raises
        ------
        UnsupportedError
            A model with distortion.

        **Source**: COLMAP's documentation, *Output Format* (cameras.txt, images.txt), *Database Format* (pixel centres).
        """
        numbers = [finite(value, "params") for value in params]
        expected = {"SIMPLE_PINHOLE": 3, "PINHOLE": 4, None: len(numbers)}.get(model)
        if expected not in (3, 4):
            found = f"{len(numbers)} parameters" if model is None else repr(model)
            raise UnsupportedError(
                "a COLMAP camera must be a SIMPLE_PINHOLE (f, cx, cy) or a PINHOLE (fx, fy, cx, cy), "
                f"got {found}: undistort first (colmap image_undistorter)"
            )
        if len(numbers) != expected:
            raise SceneError(f"a {model} camera must have {expected} params, got {len(numbers)}")
        fx, fy, cx, cy = (numbers[0], *numbers) if len(numbers) == 3 else numbers
        place = np.eye(4)
        place[:3, :3] = pose.rotation_from_quaternion(qvec, "qvec")
        place[:3, 3] = triple(np.asarray(tvec, dtype=object), "tvec")
        matrix = [[fx, 0.0, cx - _COLMAP_HALF], [0.0, fy, cy - _COLMAP_HALF], [0.0, 0.0, 1.0]]
        return cls.from_opencv(matrix, place, width, height, **fields)

    def to_colmap(self, width: int, height: int) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[float, ...]]:
        """Say it in COLMAP's words: qvec (w, x, y, z), tvec, and the params (fx, fy, cx, cy) of a PINHOLE camera."""
        matrix, world_to_camera = self.to_opencv(width, height)
        qvec = pose.quaternion_from_rotation(world_to_camera[:3, :3])
        (fx, _, cx), (_, fy, cy) = matrix[:2].tolist()
        return qvec, world_to_camera[:3, 3], (fx, fy, cx + _COLMAP_HALF, cy + _COLMAP_HALF)

    def half_height(self) -> float:
        """tan(yfov / 2): half the picture's height at distance 1."""
        return math.tan(math.radians(self.yfov_degrees) / 2.0)

    def focal_length_mm(self, sensor_height_mm: float = _FULL_FRAME_HEIGHT_MM) -> float:
        """The lens that shows as much on a sensor of the given height."""
        return positive(sensor_height_mm, "sensor_height_mm") / (2.0 * self.half_height())

    def lens(self) -> Lens:
        """Half its height at distance 1, the shape of its pixels, and its shift."""
        return Lens(self.half_height(), self.pixel_aspect, self.shift_x, self.shift_y)


@dataclass(frozen=True, eq=False)
class OrthographicCamera(_Placed):
    """Parallel projection along -z.

    Parameters
    ----------
    world_from_camera : (4, 4) float64
    height : float > 0
        What the picture shows from bottom to top, metres.
    near, far : float > 0, optional
    aspect : float > 0, optional
        Width / height; None: that of the picture.
    shift_x, shift_y : float
        Move the window over the picture plane, right and up, in half widths and half heights of the picture.
    pixel_aspect : float > 0
        Width / height of a pixel.
    motion : Motion, optional
        How it moves, in its own space.
    """

    world_from_camera: NDArray[np.float64] = field(default_factory=_identity)
    height: float = 2.0
    near: float | None = None
    far: float | None = None
    aspect: float | None = None
    name: str = ""
    shift_x: float = 0.0
    shift_y: float = 0.0
    pixel_aspect: float = 1.0
    motion: Motion | None = None

    def __post_init__(self) -> None:
        self._check()
        object.__setattr__(self, "height", positive(self.height, "camera.height"))

    def lens(self) -> Lens:
        """Half its height in metres, the shape of its pixels, and its shift."""
        return Lens(self.height / 2.0, self.pixel_aspect, self.shift_x, self.shift_y)


def _lens_fields(lens: Lens) -> dict[str, float]:
    yfov_degrees = math.degrees(2.0 * math.atan(lens.half_height))
    return {
        "yfov_degrees": yfov_degrees, "pixel_aspect": lens.pixel_aspect, "shift_x": lens.shift_x, "shift_y": lens.shift_y,
    }  # fmt: skip


def _check_opening(camera: PerspectiveCamera) -> None:
    if camera.aperture_radius is not None:
        radius = finite(camera.aperture_radius, "camera.aperture_radius")
        if radius < 0.0:
            raise SceneError(f"camera.aperture_radius must not be negative, got {radius}", camera.name)
        object.__setattr__(camera, "aperture_radius", radius)
        if radius > 0.0 and camera.focus_distance is None:
            raise SceneError("a camera with an aperture_radius needs a focus_distance", camera.name)
    if camera.focus_distance is not None:
        distance = finite(camera.focus_distance, "camera.focus_distance")
        if distance <= 0.0:
            raise SceneError(f"camera.focus_distance must be positive, got {distance}: the focus lies behind the camera", camera.name)
        object.__setattr__(camera, "focus_distance", distance)
    blades = camera.blades
    if blades is not None and (isinstance(blades, bool) or not isinstance(blades, int) or not 3 <= blades <= 1000):
        raise SceneError(f"camera.blades must be an integer from 3 to 1000, got {blades!r}", camera.name)


def _with_focus(fields: dict[str, Any], distance: float) -> dict[str, Any]:
    """The fields with the lens in focus at what the camera looks at, where there is a lens and nobody says otherwise."""
    has_lens = fields.get("aperture_radius") is not None or fields.get("f_number") is not None
    return {**fields, "focus_distance": distance} if has_lens and fields.get("focus_distance") is None else fields


def _with_yfov(fields: dict[str, Any]) -> dict[str, Any]:
    """The fields with the field of view, however it was said, as `yfov_degrees`, and the opening as `aperture_radius`."""
    fields = dict(fields)
    f_number = fields.pop("f_number", None)
    if f_number is not None:
        if fields.get("focal_length_mm") is None:
            raise SceneError("f_number needs focal_length_mm")
        if fields.get("aperture_radius") is not None:
            raise SceneError("the opening must be said once, got f_number and aperture_radius")
        diameter_mm = positive(fields["focal_length_mm"], "focal_length_mm") / positive(f_number, "f_number")
        fields["aperture_radius"] = diameter_mm / 2000.0
    said = [name for name in ("yfov_degrees", "xfov_degrees", "focal_length_mm") if fields.get(name) is not None]
    if len(said) > 1:
        raise SceneError(f"the field of view must be said once, got {' and '.join(said)}")
    xfov, focal_length = fields.pop("xfov_degrees", None), fields.pop("focal_length_mm", None)
    sensor_height = fields.pop("sensor_height_mm", None)
    if sensor_height is not None and focal_length is None:
        raise SceneError("sensor_height_mm needs focal_length_mm")
    if focal_length is not None:
        height = positive(_FULL_FRAME_HEIGHT_MM if sensor_height is None else sensor_height, "sensor_height_mm")
        fields["yfov_degrees"] = math.degrees(2.0 * math.atan(height / (2.0 * positive(focal_length, "focal_length_mm"))))
    if xfov is not None:
        xfov = finite(xfov, "xfov_degrees")
        if not 0.0 < xfov < 180.0:
            raise SceneError(f"xfov_degrees must lie between 0 and 180, got {xfov}")
        if fields.get("aspect") is None:
            raise SceneError("xfov_degrees needs aspect: the picture's width / height")
        half_width = math.tan(math.radians(xfov) / 2.0)
        fields["yfov_degrees"] = math.degrees(2.0 * math.atan(half_width / positive(fields["aspect"], "camera.aspect")))
    return fields


Camera: TypeAlias = PerspectiveCamera | OrthographicCamera
