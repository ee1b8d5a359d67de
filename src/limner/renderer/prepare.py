"""From a scene to what a film is exposed by; what did not change from one picture to the next is kept."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..accel import bvh
from ..accel.layouts import Accelerator
from ..aov import Moments
from ..errors import SceneError
from ..film import Film
from ..kernel.sampler_kinds import SAMPLERS, SOBOL
from ..mesh.mesh import Mesh
from ..pixel_filter import filtered_samples
from ..raster import pipeline
from ..raster.memory import Memory
from ..raytrace import driver
from ..samples import pixel_samples
from ..scene.bending import bent_meshes
from ..scene.camera import Camera
from ..scene.environment import Environment
from ..scene.framing import with_defaults
from ..scene.lamp import has_solids, lights_in_solids, with_lamps
from ..scene.material import Dielectric, Material
from ..scene.node import Node
from ..scene.pose import animated, at, is_rigged, posed
from ..scene.scene import Scene
from ..tables.build import Built, View, flatten, media_table, view
from ..tables.layouts import Instants, Lighting
from ..tables.lighting import lighting
from ..tables.motion import instants
from ..tables.sky_blur import blurred_sky
from .choices import FREQUENCIES, Choices
from .frame import Frame, Work

__all__ = ["Kept", "settings_of"]


class Kept:
    """What stays from one picture of a Renderer to the next: tables, the tree over them, the blurred sky, a film to use again."""

    def __init__(self) -> None:
        self.spare: tuple[Film, Memory] | None = None
        self._built: Built | None = None
        self._tree: tuple[Built, Accelerator] | None = None
        self._stopped: tuple[Scene, Scene, dict[Mesh, tuple[Mesh, ...]]] | None = None
        self._lit: tuple[Built, Scene, Lighting] | None = None
        self._flat: tuple[Scene, float] | None = None
        self._whole: tuple[Node, Environment | None] | None = None
        self._sky: tuple[Environment | None, NDArray[np.float32] | None, NDArray[np.float32] | None] = (None, None, None)

    def forget_moment(self) -> None:
        """Let go of the scene as it was at one moment: the next picture is of another."""
        self._stopped = None

    def frame(self, choices: Choices, scene: Scene, camera: Camera | None) -> Frame:
        """A picture that is ready to be exposed."""
        if camera is not None and not isinstance(camera, Camera):
            raise SceneError(f"camera must be a PerspectiveCamera or an OrthographicCamera, got {type(camera).__name__}")
        given, bent = self._scene_of_the_moment(choices, scene)
        shown, messages = self._completed(choices, given if camera is None else given.replace(camera=camera))
        width, height, opening = choices.width, choices.height, choices.shutter[0]
        assert shown.camera is not None
        built = self._flattened(choices, shown, bent)
        seen = view(shown, built.tables, shown.camera, width, height, opening)
        (film, memory), self.spare = self.spare or (Film(width, height, choices.tile_size), Memory()), None
        stage: driver.Stage | None = None
        notes: list[str] = []
        if choices.is_raster:
            notes.extend(_left_out(shown))
            work = self._pipeline(choices, shown, built, seen, film, memory, notes)
        else:
            stage = self._stage(choices, shown, built, seen)
            prepare = driver.prepare if choices.renderer == "ray" else driver.prepare_paths
            work = prepare(stage, settings_of(choices), film.sums)
        moments = Moments(film.sums, len(film.tiles)) if "variance" in choices.beside else None
        film.on_exposed = None if moments is None else moments.add
        return Frame(shown, shown.camera, built, seen, film, memory, work, (*messages, *built.notes, *notes), stage, moments)

    def _completed(self, choices: Choices, scene: Scene) -> tuple[Scene, tuple[str, ...]]:
        """The scene with the camera and the light that it lacks, and with its shining shapes as lights; what was done is said."""
        known = self._whole
        if known is not None and scene.camera is not None and scene.root is known[0] and scene.environment is known[1]:
            return scene, ()
        complete, messages = with_defaults(scene, choices.width / choices.height, lights=choices.default_lights)
        made, said = with_lamps(complete, choices.shutter[0]), (*messages, *lights_in_solids(complete))
        is_whole = made.root is scene.root and not said and not has_solids(scene)
        self._whole = (scene.root, scene.environment) if is_whole else None
        return made, said

    def _flattened(self, choices: Choices, scene: Scene, bent: dict[Mesh, tuple[Mesh, ...]]) -> Built:
        """The tables of a scene; the last ones where only the camera is another, and they would be the same for every camera."""
        assert scene.camera is not None
        opening, last = choices.shutter[0], self._built
        is_known = self._flat is not None and self._flat[0].root is scene.root and self._flat[1] == opening
        if last is None or not last.is_for_all or not is_known:
            last = flatten(
                scene, scene.camera, choices.width, choices.height, last, tessellate=choices.is_raster, time=opening, bent=bent
            )
            self._built, self._flat = last, (scene, opening)
        return last

    def _pipeline(
        self, choices: Choices, scene: Scene, built: Built, seen: View, film: Film, memory: Memory, notes: list[str]
    ) -> Work:
        """The pipeline over the tables."""
        light = self._lighting(choices, scene, built, None)
        places, weights = filtered_samples(choices.samples, choices.filter)
        shadows = pipeline.Shadows(self._tree_of(built), media_table(scene), choices.tinted_shadows) if choices.shadows else None
        return pipeline.prepare(
            built.tables, light, seen, places, _background(scene), film.sums, sample_weights=weights, culling=choices.culling,
            threads=choices.threads, tile_size=choices.tile_size, multisample=choices.multisample,
            frequency=FREQUENCIES[choices.shading], hidden_surfaces=choices.hidden_surfaces, clipping=choices.clipping,
            on_note=notes.append, shadows=shadows, memory=memory,
        )  # fmt: skip

    def _stage(self, choices: Choices, scene: Scene, built: Built, seen: View) -> driver.Stage:
        """What rays meet."""
        assert scene.camera is not None
        moved = instants(scene, built.tables, scene.camera, choices.width, choices.height, choices.shutter, built.n_keys)
        light = self._lighting(choices, scene, built, moved.moving)
        return driver.Stage(built.tables, self._accelerator(built, moved), light, seen, media_table(scene), moved, _background(scene))

    def _scene_of_the_moment(self, choices: Choices, scene: Scene) -> tuple[Scene, dict[Mesh, tuple[Mesh, ...]]]:
        """The scene with its animation at the time of the picture, and its meshes bent; the same objects while nothing changes.

        And what the meshes turn into until the shutter closes.
        """
        if self._stopped is None or self._stopped[0] is not scene:
            moment = choices.moment
            if moment is not None and moment[0] is not None:
                self._stopped = scene, posed(at(scene, moment[0], moment[1]), choices.shutter[0]), {}
            else:

                def pose_at(time: float) -> Scene:
                    return posed(scene if moment is None else animated(scene, moment[1], time), time)

                opening = pose_at(choices.shutter[0])
                bent = bent_meshes(pose_at, opening, choices.shutter) if is_rigged(scene) else {}
                self._stopped = scene, opening, bent
            self._stopped[1].bounds()  # found once for the pictures of all cameras
        return self._stopped[1:]

    def _accelerator(self, built: Built, moved: Instants) -> Accelerator:
        """The tree over the scene; the last one while nothing in it has moved."""
        return bvh.build(built.tables, instants=moved) if len(moved.moving) else self._tree_of(built)

    def _tree_of(self, built: Built) -> Accelerator:
        if self._tree is None or not _same_primitives(self._tree[0], built):
            self._tree = built, bvh.build(built.tables)
        return self._tree[1]

    def _lighting(self, choices: Choices, scene: Scene, built: Built, moving: NDArray[np.int32] | None) -> Lighting:
        known = self._lit
        if known is not None and moving is None and known[0] is built and known[1].environment is scene.environment:
            if known[1].background == scene.background:
                return known[2]
        made = self._made_lighting(choices, scene, built, moving)
        self._lit = (built, scene, made) if moving is None else None
        return made

    def _made_lighting(self, choices: Choices, scene: Scene, built: Built, moving: NDArray[np.int32] | None) -> Lighting:
        environment = scene.environment
        if environment is None:
            return lighting(built.tables, None, moving=moving)
        if self._sky[0] is not environment:
            pixels = _sky_pixels(environment)
            # A path tracer asks the sky itself.
            blurred = None if choices.renderer == "path" else blurred_sky(pixels, choices.threads)
            self._sky = environment, pixels, blurred
        visible = scene.background == "environment"
        return lighting(built.tables, self._sky[1], environment.intensity, environment.rotation_degrees, visible, self._sky[2], moving)


def settings_of(choices: Choices) -> driver.Settings:
    """What rays are traced by."""
    shares_pattern = choices.sampler is None and choices.renderer == "ray"
    return driver.Settings(
        choices.samples, pixel_samples(choices.samples) if shares_pattern else None,
        SOBOL if choices.sampler is None else SAMPLERS[choices.sampler], choices.seed, choices.max_depth, choices.shadows,
        choices.tinted_shadows, choices.glossy, choices.emitters,
    )  # fmt: skip


def _lets_light_through(material: Material) -> bool:
    transmission = getattr(material, "transmission", None)
    return isinstance(material, Dielectric) or (transmission is not None and transmission.factor > 0.0)


def _left_out(scene: Scene) -> list[str]:
    """What the rasteriser does not show of a scene, a sentence each."""
    said = []
    if any(_lets_light_through(material) for _, shape in scene.shapes() for material in shape.materials):
        said.append("raster cannot bend light: glass is drawn as a veil; ray and path follow light through it")
    if scene.fog is not None:
        said.append("raster has no fog; ray and path have")
    if getattr(scene.camera, "aperture_radius", None):
        said.append("raster sees through a pinhole; ray and path through the camera's lens")
    return said


def _background(scene: Scene) -> NDArray[np.float32]:
    if scene.background is None or isinstance(scene.background, str):
        return np.zeros(4, dtype=np.float32)
    return np.array([*scene.background, 1.0], dtype=np.float32)


def _sky_pixels(environment: Environment) -> NDArray[np.float32]:
    """(height, width, 3) float32 radiance of an environment, read if it is a file."""
    source = environment.source
    if isinstance(source, str):
        from ..files.radiance import read_radiance

        return read_radiance(source)
    if isinstance(source, tuple):
        return np.broadcast_to(np.array(source, dtype=np.float32), (16, 32, 3))
    return np.asarray(source, dtype=np.float32)


def _same_primitives(before: Built, now: Built) -> bool:
    """Whether a tree over one scene serves the other: the same meshes in the same places, their sides and alphas alike."""
    if before is now:
        return True
    a, b = before.tables, now.tables
    if len(before.meshes) != len(now.meshes) or any(x is not y for x, y in zip(before.meshes, now.meshes, strict=True)):
        return False
    same_places = a.instances.tobytes() == b.instances.tobytes()
    fields = ["double_sided", "alpha_mode"]
    return same_places and len(a.materials) == len(b.materials) and (a.materials[fields] == b.materials[fields]).all()
