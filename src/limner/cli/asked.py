"""What decides a pixel, as a command line says it: for `render`, which makes them all, and for `explain`, which tells of one.

    @click.command()
    @click.argument("model")
    @size(800, 600)
    @deciding
    def command(...):
        further = settings_of_file(context, options)
        asked = Asked(further=further, **options)
        scene, camera, key = asked.shown(open_model(...))
        render(scene, camera=camera, **asked.settings())
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import click

from .model import numbered
from .options import background, environment, max_depth, samples, seed, sight, together, weights
from .sight import chosen_camera, with_lens
from .surroundings import surrounded
from .values import INTERVAL, Background, Triple

if TYPE_CHECKING:
    from ..draw.color_bar import ColorBar
    from ..scene.camera import Camera
    from ..scene.scene import Scene

__all__ = ["Asked", "deciding", "one_background", "settings_of_file"]

_SETTINGS = (
    "renderer", "width", "height", "samples", "seed", "max_depth", "sampler", "glossy", "emitters", "antialiasing", "shadows", "shading",
    "hidden_surfaces", "clipping", "culling", "filter", "tinted_shadows", "time", "shutter",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What a command line asks of a pixel; None: the default of `limner.render`."""

    model: str
    renderer: str
    width: int
    height: int
    samples: int | None
    seed: int
    max_depth: int
    sampler: str | None
    glossy: bool
    emitters: bool
    tinted_shadows: bool | None
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
    environment: str | None
    ground: bool
    scalars: str | None
    color_map: str
    scalar_range: tuple[float, float] | None
    point_size: float | None
    background: Background | None
    further: dict[str, Any] = field(default_factory=dict)

    def settings(self) -> dict[str, Any]:
        """What `limner.render` is told beside the scene and the camera."""
        told = {name: getattr(self, name) for name in _SETTINGS}
        return {**told, "animation": numbered(self.animation), **self.further}

    def shown(self, scene: Scene) -> tuple[Scene, Camera | None, ColorBar | None]:
        """The scene as it is asked for, its camera if that is said, and the key to its colours if numbers give them."""
        key = None
        if self.point_size is not None or self.scalars is not None:
            from ..produce.scalars import colored, with_point_size

            if self.point_size is not None:
                scene = with_point_size(scene, self.point_size)
            if self.scalars is not None:
                scene, key = colored(scene, self.scalars, self.color_map, self.scalar_range)
        if self.variant is not None:
            from ..scene.variants import with_variant

            scene = with_variant(scene, self.variant)
        scene = surrounded(scene, self.environment, self.background)
        camera = with_lens(self, scene, chosen_camera(self, scene))
        return (scene.with_ground() if self.ground else scene), camera, key


_rasterizing = together(
    click.option(
        "--antialiasing", type=click.Choice(["multisample", "supersample"]), default="multisample", show_default=True,
        help="Shade once what covers several samples of a pixel, or every sample (raster).",
    ),
    click.option("--shadows/--no-shadows", default=None, help="Whether lights can be hidden.  [default: not by raster]"),
    click.option(
        "--shading", type=click.Choice(["fragment", "vertex", "flat"]), default="fragment", show_default=True,
        help="Where colours are computed (raster).",
    ),
    click.option(
        "--hidden-surfaces", type=click.Choice(["zbuffer", "painter"]), default="zbuffer", show_default=True,
        help="How what is in front is found (raster).",
    ),
    click.option(
        "--clipping", type=click.Choice(["homogeneous", "world"]), default="homogeneous", show_default=True,
        help="After the projection, or before it (raster).",
    ),
    click.option(
        "--culling", type=click.Choice(["material", "back", "front", "none"]), default="material", show_default=True,
        help="Which sides are left out (raster).",
    ),
    weights("box", "How the samples around a pixel are weighed (raster)."),
)  # fmt: skip

_tracing = together(
    max_depth,
    click.option(
        "--sampler", type=click.Choice(["regular", "random", "jittered", "multijittered", "halton", "sobol"]),
        help="How samples are spread (ray, path).  [default: the renderer's]",
    ),
    click.option("--glossy", is_flag=True, help="Follow what rough mirrors reflect by rays (ray; path does anyway)."),
    click.option("--emitters", is_flag=True, help="Let surfaces that shine light others (ray; path does anyway)."),
    click.option(
        "--tinted-shadows/--dark-shadows", default=None, help="Whether light comes straight through glass (ray, path).  [default: in ray]",
    ),
)  # fmt: skip

_lens = together(
    click.option("--aperture", type=click.FloatRange(0.0), metavar="R", help="Radius of the lens (ray, path).  [default: the camera's]"),
    click.option(
        "--focus", type=click.FloatRange(0.0, min_open=True), metavar="D",
        help="Distance at which things are sharp, along the gaze.  [default: that of the target]",
    ),
)  # fmt: skip

_moment = together(
    click.option("--scene", metavar="NAME|INDEX", help="Which of several scenes of the file.  [default: the file's own choice]"),
    click.option("--variant", metavar="NAME", help="Which of the model's variants.  [default: none]"),
    click.option("--time", type=float, metavar="S", help="The moment of the animation, seconds.  [default: what no animation has moved]"),
    click.option("--animation", metavar="NAME|INDEX|all", help="Which animation; all: all at once.  [default: the first]"),
    click.option(
        "--shutter", type=INTERVAL, metavar="S,S", help="When the shutter opens and closes, seconds: what moves is blurred (ray, path).",
    ),
)  # fmt: skip

_numbers = together(
    click.option("--scalars", metavar="NAME", help="Colour by the numbers of that name (PLY properties, glTF _NAME), with a key."),
    click.option(
        "--color-map", metavar="MAP", default="viridis", show_default=True, help="How numbers become colours: cividis, cool_warm, …",
    ),
    click.option("--scalar-range", type=INTERVAL, metavar="LOW,HIGH", help="What the ends of the map stand for.  [default: all there is]"),
    click.option(
        "--point-size", type=click.FloatRange(0.0, min_open=True), metavar="R",
        help="Radius of the points of clouds.  [default: from their spacing]",
    ),
)  # fmt: skip

_surroundings = together(
    environment,
    click.option("--ground", is_flag=True, help="Put a ground under the model that shows its shadow."),
    background,
    click.option("--transparent", is_flag=True, help="The same as --background transparent."),
)

deciding = together(samples(), seed(), _rasterizing, _tracing, sight, _lens, _moment, _surroundings, _numbers)
"""The options that decide a pixel, beside the renderer and the size of the picture."""


def one_background(options: dict[str, Any]) -> Background | None:
    """Take `--background` and `--transparent` out of the options: the one thing that they say."""
    chosen: Background | None = options.pop("background")
    if not options.pop("transparent"):
        return chosen
    if chosen not in (None, "transparent"):
        raise click.UsageError("--transparent and --background say different things")
    return "transparent"


def settings_of_file(context: click.Context, options: dict[str, Any]) -> dict[str, Any]:
    """Put the settings of a scene file, or of a Mitsuba scene, in the place of defaults; return those for which there is no option."""
    model = options["model"]
    if model.lower().endswith((".yaml", ".yml", ".limner")):
        from ..files.scene_file import settings_of
    elif model.lower().endswith(".xml"):
        from ..files.mitsuba import settings_of
    else:
        return {}
    further = {}
    for name, value in settings_of(model).items():
        if name not in options:
            further[name] = value
        elif context.get_parameter_source(name) is click.core.ParameterSource.DEFAULT:
            options[name] = value
    if options["renderer"] != "raster" and context.get_parameter_source("filter") is click.core.ParameterSource.DEFAULT:
        options["filter"] = "box"  # what a file says of another renderer's filter
    return further
