"""`limner render`: look before the work begins, make the picture, save what there is, tell about it."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

import click

from ..errors import LimnerError, SceneError
from .animate import chosen_animation
from .bar import Bar
from .main import INTERRUPTED
from .model import open_model, report_of_model
from .talk import Talk
from .values import Background, Triple

if TYPE_CHECKING:
    from ..draw.color_bar import ColorBar
    from ..files.report import LoadReport
    from ..image.image import Image
    from ..scene.camera import Camera
    from ..scene.scene import Scene

__all__ = ["Order", "Sight", "chosen_camera", "make_picture"]


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


@dataclass(frozen=True)
class Order:
    """What a command line asks for; None: the default of `limner.render`."""

    model: str
    output: str
    renderer: str
    width: int
    height: int
    samples: int | None
    seed: int
    max_depth: int
    sampler: str | None
    glossy: bool
    emitters: bool
    antialiasing: str
    shadows: bool | None
    shading: str
    hidden_surfaces: str
    clipping: str
    culling: str
    filter: str
    camera: str | None
    eye: Triple | None
    target: Triple | None
    up: Triple | None
    yfov: float | None
    aperture: float | None
    focus: float | None
    scene: str | None
    variant: str | None
    time: float | None
    animation: str | int | None
    shutter: tuple[float, float] | None
    aovs: tuple[str, ...]
    environment: str | None
    ground: bool
    model_up: str
    scalars: str | None
    color_map: str
    scalar_range: tuple[float, float] | None
    point_size: float | None
    background: Background | None
    threads: int | None
    as_json: bool
    view: str = "standard"
    exposure: float = 0.0
    color_space: str = "srgb"
    further: dict[str, Any] = field(default_factory=dict)
    report: bool = False


def make_picture(order: Order, talk: Talk) -> None:
    """Fulfil `order`."""
    _check_output(order)
    started = time.perf_counter()
    report = report_of_model(order.model, order.model_up, order.scene) if order.report else None
    scene, key = _by_numbers(order, open_model(order.model, order.model_up, order.scene) if report is None else report.scene)
    if order.variant is not None:
        from ..scene.variants import with_variant

        scene = with_variant(scene, order.variant)
    if order.environment is not None:
        from ..scene.environment import Environment

        scene = scene.replace(environment=Environment(order.environment))
    if order.background is not None:
        scene = scene.replace(background=None if order.background == "transparent" else order.background)
    camera = _with_lens(order, scene, chosen_camera(order, scene))
    if order.ground:
        scene = scene.with_ground()
    if report is None:
        talk.note(scene.notes)
    else:
        for line in report.lines():
            talk.say("report", line)
    loaded = time.perf_counter()

    from ..render import render

    with Bar(enabled=not talk.quiet) as bar:
        image = render(
            scene,
            width=order.width,
            height=order.height,
            renderer=order.renderer,
            samples=order.samples,
            seed=order.seed,
            max_depth=order.max_depth,
            sampler=order.sampler,
            glossy=order.glossy,
            emitters=order.emitters,
            antialiasing=order.antialiasing,
            shadows=order.shadows,
            shading=order.shading,
            hidden_surfaces=order.hidden_surfaces,
            clipping=order.clipping,
            culling=order.culling,
            filter=order.filter,
            camera=camera,
            time=order.time,
            animation=chosen_animation(order.animation),
            shutter=order.shutter,
            threads=order.threads,
            aovs=order.aovs,
            on_progress=bar,
            **order.further,
        )
    rendered = time.perf_counter()
    talk.warn(image.warnings)
    image = _with_origin(image, order)
    if key is not None:
        from ..draw.color_bar import with_color_bar

        image = with_color_bar(image, key)
    image.save(order.output, view=order.view, exposure=order.exposure, color_space=order.color_space)
    saved = time.perf_counter()

    seconds = {"load": loaded - started, "render": rendered - loaded, "save": saved - rendered}
    talk.detail(", ".join(f"{step} {spent:.3f} s" for step, spent in seconds.items()))
    if not image.finished:
        talk.say("interrupted", f"the picture so far is in {order.output}")
        talk.code = INTERRUPTED
    if order.as_json:
        _tell(order, scene, image, seconds, report)


def _by_numbers(order: Order, scene: Scene) -> tuple[Scene, ColorBar | None]:
    """The scene with its points as large, and by the numbers, as the command line asks; and the key to their colours."""
    if order.scalars is None and order.point_size is None:
        return scene, None
    from ..produce.scalars import colored, with_point_size

    if order.point_size is not None:
        scene = with_point_size(scene, order.point_size)
    return (scene, None) if order.scalars is None else colored(scene, order.scalars, order.color_map, order.scalar_range)


def _with_origin(image: Image, order: Order) -> Image:
    """Let the recipe say where the model is: `limner verify` needs no more."""
    from dataclasses import replace

    from ..image.recipe import Recipe
    from ..produce.again import origin

    if order.model_up != "y" or order.scalars is not None or order.point_size is not None:
        return image  # a recipe does not say these: of what model the picture is has to be named then
    told = origin(
        order.model, order.output, environment=order.environment, ground=order.ground, background=order.background
    )
    recipe = image.recipe if isinstance(image.recipe, Recipe) else Recipe(image.recipe)
    return replace(image, recipe=recipe.with_values(**told))


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


def _with_lens(order: Order, scene: Scene, camera: Camera | None) -> Camera | None:
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


def _check_output(order: Order) -> None:
    """Refuse an output that cannot be written before anything is computed for it."""
    from ..image.save import check_destination, keeps_aovs

    try:
        check_destination(order.output, view=order.view, exposure=order.exposure, color_space=order.color_space)
    except LimnerError as error:
        raise click.UsageError(str(error)) from error
    if order.aovs and not keeps_aovs(order.output):
        raise click.UsageError(f"--aov needs an output that can hold more than a picture (.exr), got {order.output}")
    if order.output == "-":
        import sys

        if sys.stdout.isatty():
            raise click.UsageError("-o - would write a PNG to the terminal; send it to a file or a pipe")


def _tell(order: Order, scene: Scene, image: Image, seconds: dict[str, float], report: LoadReport | None) -> None:
    import json

    told: dict[str, Any] = {
        "output": order.output,
        "width": image.width,
        "height": image.height,
        "finished": image.finished,
        "seconds": {step: round(spent, 6) for step, spent in seconds.items()},
        "aovs": sorted(image.aov),
        "id_names": {name: list(names) for name, names in image.id_names.items()},
        "notes": list(scene.notes),
        "warnings": list(image.warnings),
        "recipe": dict(image.recipe),
        **({} if report is None else {"report": report.as_dict()}),
    }
    click.echo(json.dumps(told, sort_keys=True))
