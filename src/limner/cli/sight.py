"""Where a command line puts the eye: a camera of the model, one of its own, or one that shows all; and the lens of that."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import click

from ..errors import SceneError
from .options import check_yfov
from .values import Triple

if TYPE_CHECKING:
    from ..scene.camera import Camera
    from ..scene.scene import Scene

__all__ = ["Lens", "Sight", "check_camera", "chosen_camera", "with_lens"]


class Sight(Protocol):
    """What a command line says about the camera."""

    @property
    def model(self) -> str: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def camera(self) -> str | None: ...
    @property
    def eye(self) -> Triple | None: ...
    @property
    def target(self) -> Triple | None: ...
    @property
    def up(self) -> Triple | None: ...
    @property
    def yfov(self) -> float | None: ...


class Lens(Sight, Protocol):
    """What a command line says about the camera and its lens."""

    @property
    def aperture(self) -> float | None: ...
    @property
    def focus(self) -> float | None: ...


def check_camera(order: Sight) -> None:
    """Refuse two cameras, and half of one."""
    if order.camera is not None and order.eye is not None:
        raise click.UsageError("--camera and --eye exclude each other")
    for name, value in (("--target", order.target), ("--up", order.up), ("--yfov", order.yfov)):
        if value is not None and order.eye is None:
            raise click.UsageError(f"{name} needs --eye")
    if order.yfov is not None:
        check_yfov(order.yfov)


def chosen_camera(order: Sight, scene: Scene) -> Camera | None:
    """The camera that the command line means; None: it does not say."""
    if order.eye is not None:
        from ..scene.camera import PerspectiveCamera

        target = _middle(scene) if order.target is None else order.target
        fields = {} if order.yfov is None else {"yfov_degrees": order.yfov}
        return PerspectiveCamera.look_at(order.eye, target, order.up or (0.0, 1.0, 0.0), **fields)
    if order.camera is None:
        return None
    if order.camera == "frame":
        from ..scene.framing import extent_points, framing_camera

        return framing_camera(extent_points(scene), order.width / order.height)
    cameras = scene.cameras()
    named = [camera for camera in cameras if camera.name == order.camera]
    if named:
        return named[0]
    if order.camera.isdecimal() and int(order.camera) < len(cameras):
        return cameras[int(order.camera)]
    known = ", ".join(f"{index} {camera.name!r}" for index, camera in enumerate(cameras)) or "none"
    raise SceneError(f"there is no camera {order.camera!r} in {order.model}; it has: {known}")


def with_lens(order: Lens, scene: Scene, camera: Camera | None) -> Camera | None:
    """The camera with the lens that the command line asks for, in focus at what it looks at unless that is said, too."""
    if order.aperture is None and order.focus is None:
        return camera
    from ..scene.camera import PerspectiveCamera
    from ..scene.framing import with_defaults

    chosen = camera or with_defaults(scene, order.width / order.height)[0].camera
    if not isinstance(chosen, PerspectiveCamera):
        raise SceneError("a camera with parallel projection has no lens: leave out --aperture and --focus")
    distance = order.focus
    if distance is None:
        x, y, z = _middle(scene) if order.target is None else order.target
        to_target = chosen.world_from_camera[:3, 3] - (x, y, z)
        distance = float(to_target @ chosen.world_from_camera[:3, 2])
    aperture = chosen.aperture_radius if order.aperture is None else order.aperture
    return chosen.replace(aperture_radius=aperture, focus_distance=distance)


def _middle(scene: Scene) -> Triple:
    low, high = scene.bounds()
    x, y, z = (float(value) for value in (low + high) / 2.0) if (low <= high).all() else (0.0, 0.0, 0.0)
    return x, y, z
