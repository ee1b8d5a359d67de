"""Calls that cannot be fulfilled end in one clear line; odd but sound ones end in a sound picture."""

from __future__ import annotations

import inspect
import math
import threading
import warnings
from typing import Any

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON, checkers, grid, lit_from, place, point_light_at, scene_of

from limner.aov import CHANNELS
from limner.errors import LimnerError, LimnerWarning
from limner.files.load import load
from limner.image.image import Image
from limner.linear import transform
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.render import Renderer, render
from limner.scene.camera import OrthographicCamera, PerspectiveCamera
from limner.scene.light import AmbientLight, DirectionalLight, PointLight, SpotLight
from limner.scene.material import BlinnPhong, Lambert, MetallicRoughness
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Box, Plane, Shape, Sphere
from limner.scene.texture import Texels, Texture

NAN, INF = math.nan, math.inf
BALL = scene_of(place(Sphere()))
BOTH = ("raster", "ray")


def _small(scene: Any = BALL, **options: Any) -> Image:
    """A picture of 12 x 9, and no warning but limner's."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", LimnerWarning)
        return render(scene, **{"width": 12, "height": 9, "samples": 1, **options})


def _sound(scene: Any, **options: Any) -> list[Image]:
    """Both pictures with all channels; every pixel a number."""
    images = [_small(scene, renderer=name, aovs=CHANNELS, **options) for name in BOTH]
    for image in images:
        assert np.isfinite(image.pixels).all()
        assert image.finished
        assert not np.isnan(image.aov["depth"]).any()
    return images


# --- bad calls ------------------------------------------------------------------------------------------------------------

BAD_CALLS = [
    *[{side: value} for side in ("width", "height") for value in (0, -1, 10**6, 2.5, "8", None, NAN, True)],
    {"width": 32768, "height": 32768},
    *[{"samples": value} for value in (0, -1, 10**9, 2.5, "4", True)],
    *[{"renderer": value} for value in ("rast", None, ["ray"], "RAY")],
    *[{"aovs": value} for value in ("depth", ("depht",), 3, None)],
    *[{"threads": value} for value in (0, -3, 1.5, NAN, "2")],
    *[{"max_depth": value} for value in (-1, 1.5, "2", NAN, 10**6)],
    *[{"tile_size": value} for value in (0, 7, 12.5, "x", 10**6)],
    *[{"camera": value} for value in ("front", 3, PerspectiveCamera)],
    *[{"scene": value} for value in (None, 3, object(), "no such file.glb", "no such format.xyz")],
]


@pytest.mark.parametrize("call", BAD_CALLS, ids=lambda call: ",".join(f"{k}={str(v)[:30].split(' at 0x')[0]}" for k, v in call.items()))
def test_bad_calls_get_one_line(call):
    """The message names what was wrong, and nothing else is raised."""
    with pytest.raises(LimnerError) as caught:
        _small(**call)
    message = str(caught.value)
    assert "\n" not in message
    assert 10 < len(message) < 300
    name = next(iter(call))
    if name != "scene":
        assert name.rstrip("s") in message or "picture" in message


def _eye(*eye: float, target: Any = (0, 0, 0), **fields: Any) -> PerspectiveCamera:
    return PerspectiveCamera.look_at(eye, target, **fields)


BAD_DESCRIPTIONS = {
    "eye = target": lambda: _eye(0, 0, 0),
    "up along the gaze": lambda: _eye(0, 5, 0),
    "no up": lambda: _eye(0, 0, 5, up=(0, 0, 0)),
    "fov 180": lambda: PerspectiveCamera(yfov_degrees=180),
    "fov 0": lambda: PerspectiveCamera(yfov_degrees=0),
    "fov NaN": lambda: PerspectiveCamera(yfov_degrees=NAN),
    "near = far": lambda: PerspectiveCamera(near=2.0, far=2.0),
    "near > far": lambda: OrthographicCamera(near=3.0, far=2.0),
    "near 0": lambda: PerspectiveCamera(near=0.0),
    "far infinite": lambda: PerspectiveCamera(far=INF),
    "NaN eye": lambda: _eye(NAN, 0, 5),
    "NaN matrix": lambda: PerspectiveCamera(world_from_camera=np.full((4, 4), NAN)),
    "singular camera": lambda: PerspectiveCamera(world_from_camera=np.diag([1.0, 1.0, 0.0, 1.0])),
    "orthographic height 0": lambda: OrthographicCamera(height=0.0),
    "two numbers": lambda: _eye(1, 2),
    "light NaN": lambda: PointLight(intensity=NAN),
    "light below 0": lambda: DirectionalLight(intensity=-1.0),
    "light colour NaN": lambda: AmbientLight(color=(NAN, 0, 0)),
    "light range 0": lambda: PointLight(range=0.0),
    "cone inside out": lambda: SpotLight(inner_degrees=40, outer_degrees=30),
    "wide cone": lambda: SpotLight(outer_degrees=120),
    "unknown falloff": lambda: PointLight(falloff="linear"),
    "radius 0": lambda: Sphere(0.0),
    "radius NaN": lambda: Sphere(NAN),
    "flat box": lambda: Box((1, 0, 1)),
    "colour below 0": lambda: Lambert(color=(-1, 0, 0)),
    "alpha 2": lambda: Lambert(alpha=2.0),
    "alpha mode": lambda: Lambert(alpha_mode="glass"),
    "roughness 2": lambda: MetallicRoughness(roughness=2.0),
    "exponent NaN": lambda: BlinnPhong(exponent=NAN),
    "texture by name": lambda: Lambert(texture="bricks.png"),
    "texels of floats": lambda: Texels(np.zeros((2, 2, 4))),
    "no texels": lambda: Texels(np.zeros((0, 2, 4), np.uint8)),
    "unknown filter": lambda: Texture(checkers().texels, filter="best"),
    "NaN in the texture transform": lambda: checkers(rotation=NAN),
    "geometry by name": lambda: Shape("teapot"),
    "material by name": lambda: Shape(Sphere(), ("red",)),
    "index out of range": lambda: Mesh(np.zeros((3, 3)), np.array([[0, 1, 3]])),
    "NaN position": lambda: Mesh(np.full((3, 3), NAN), np.array([[0, 1, 2]])),
    "infinite position": lambda: Mesh(np.full((3, 3), INF), np.array([[0, 1, 2]])),
    "too few materials": lambda: Shape(Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]), triangle_materials=np.array([4])), (Lambert(),)),
    "NaN transform": lambda: Node(parent_from_node=np.full((4, 4), NAN)),
    "background below 0": lambda: Scene(background=(-1, 0, 0)),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD_DESCRIPTIONS)
def test_bad_descriptions_are_refused_at_once(name):
    with pytest.raises(LimnerError) as caught:
        BAD_DESCRIPTIONS[name]()
    assert "\n" not in str(caught.value)


# --- odd scenes -----------------------------------------------------------------------------------------------------------


NO_TRIANGLE = scene_of(place(Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32))))


@pytest.mark.parametrize("scene", [Scene(), NO_TRIANGLE], ids=["no node", "no triangle"])
def test_nothing_to_see(scene):
    for image in _sound(scene):
        assert not image.pixels.any()
        assert np.isinf(image.aov["depth"]).all()
        assert (image.aov["instance_id"] == -1).all()
    for image in _sound(scene.replace(background=(0.1, 0.2, 0.3))):
        np.testing.assert_allclose(image.pixels[0, 0], (0.1, 0.2, 0.3, 1.0), rtol=1e-6)


@pytest.mark.parametrize("size", [(1, 1), (1, 50), (50, 1), (2, 2), (257, 3)])
def test_small_and_narrow_pictures(size):
    for image in _sound(BALL, width=size[0], height=size[1], samples=16):
        assert image.pixels.shape == (size[1], size[0], 4)
        assert image.pixels[..., 3].max() > 0.3


@SLOW_AS_PYTHON
@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
def test_any_unit_of_length(scale):
    """Metres or micrometres: the picture is the same, framed by limner or by hand."""

    def scene(size: float) -> Scene:
        node = Node(parent_from_node=transform.scale(size), children=(place(primitives.sphere(1.0, 24)), place(Box(), at=(1.5, 0, 0))))
        return Scene(node)

    for one, other in zip(_sound(scene(1.0), width=60, height=45), _sound(scene(scale), width=60, height=45), strict=True):
        assert (np.abs(one.pixels - other.pixels).max(axis=2) > 2e-3).mean() < 0.01


@pytest.mark.parametrize("scale", [1e-30, 1e-20, 1e15, 1e30])
def test_lengths_beyond_measure(scale):
    """Where float32 has no squares left, a picture may be wrong but is made."""
    for geometry in (Sphere(), Box(), grid(3, 1.0)):
        for name in BOTH:
            assert np.isfinite(_small(Scene(place(geometry, matrix=transform.scale(scale))), renderer=name, aovs=CHANNELS).pixels).all()


@SLOW_AS_PYTHON
def test_a_camera_on_a_surface_and_within_solids():
    for eye in ((0, 0, 1), (0, 0, 0.5), (0, 0, 0), (0, 0, 1 - 1e-7)):
        for geometry in (Sphere(1.0), Box((2, 2, 2)), primitives.sphere(1.0, 12)):
            for image in _sound(scene_of(place(geometry, checkers_on()), camera=_eye(*eye, target=(0.3, 0.2, -5)))):
                assert (image.pixels[..., 3] == 1.0).all() or eye[2] > 0.9
    _sound(scene_of(place(Plane()), camera=_eye(0, 0, 0, target=(0, 0, -1))))
    _sound(scene_of(place(Plane()), camera=_eye(0, 0, 0, target=(0, -1, -1))))


def checkers_on() -> Lambert:
    return Lambert(texture=checkers())


@SLOW_AS_PYTHON
def test_shapes_that_are_flattened_or_have_no_area():
    line = Mesh(np.array([[0, 0, 0], [1, 1, 0], [2, 2, 0]], np.float32), np.array([[0, 1, 2]], np.int32))
    point = Mesh(np.zeros((3, 3), np.float32), np.array([[0, 1, 2], [0, 0, 0]], np.int32), normals=np.zeros((3, 3), np.float32))
    for image in _sound(scene_of(place(line), place(point), place(Sphere(0.5)))):
        assert set(np.unique(image.aov["instance_id"])) <= {-1, 2}
    # A ball flattened to a disk, a plane scaled along its normal: still there, for both renderers.
    for geometry in (Sphere(), Plane()):
        scene = scene_of(place(geometry, matrix=transform.scale(1, 0, 1)), camera=_eye(0.1, 3, 0.2))
        raster, ray = _sound(scene, width=60, height=45)
        np.testing.assert_array_equal(raster.aov["instance_id"] >= 0, ray.aov["instance_id"] >= 0)
        assert (raster.aov["instance_id"] >= 0).sum() > 300
    for squashed in (transform.scale(0), transform.scale(1, 0, 1), transform.scale(0, 0, 1), transform.scale(1e-30, 1, 1)):
        for geometry in (Sphere(), Box(), Plane(), grid(3, 1.0)):
            _sound(scene_of(place(geometry, checkers_on(), matrix=squashed), camera=_eye(2, 1, 3)))


def test_attributes_that_are_no_numbers():
    base = grid(3, 1.0)
    n = len(base.positions)
    for bad in (NAN, INF, -INF):
        mesh = Mesh(
            base.positions, base.triangles, normals=np.full((n, 3), bad), uvs=np.full((n, 2), bad), uvs1=np.full((n, 2), bad),
            colors=np.full((n, 3), 0.5), tangents=np.full((n, 4), bad),
        )  # fmt: skip
        bumpy = MetallicRoughness(base_color_texture=checkers(), normal_texture=checkers(uv_set=1))
        _sound(scene_of(place(mesh, bumpy)))


def test_lights_where_they_should_not_be():
    """In the surface, on the eye, at one point with another; brighter than numbers go."""
    camera = _eye(0, 0, 3)
    for position in ((0, 0, 1), (0, 0, 3), (0, 0, 0)):
        _sound(scene_of(place(Sphere()), *(point_light_at(position, light) for light in (PointLight(), SpotLight())), camera=camera))
    for name in BOTH:
        with pytest.warns(LimnerWarning, match="not finite"):
            image = render(
                scene_of(place(Sphere(), Lambert(color=1)), lit_from((0, 0, 1), DirectionalLight(intensity=1e300)), camera=camera),
                width=12, height=9, samples=1, renderer=name,
            )  # fmt: skip
        assert np.isfinite(image.pixels).all()
        assert any("not finite" in message for message in image.warnings)


@SLOW_AS_PYTHON
def test_more_layers_than_can_be_told_apart():
    """A hundred panes of glass: all but black behind them, and no endless loop."""
    pane = Lambert(color=0, alpha=0.5, alpha_mode="blend")
    panes = [place(grid(2, 1.0, transform.rotate_x(math.pi / 2)), pane, at=(0, 0, -0.01 * k)) for k in range(100)]
    for image in _sound(scene_of(*panes, camera=_eye(0, 0, 1))):
        assert image.pixels[4, 6, 3] == pytest.approx(1.0, abs=1e-6)


# --- being stopped --------------------------------------------------------------------------------------------------------


class _After:
    """Asked whether to stop, says yes (or is interrupted) after some times."""

    def __init__(self, times: int, interrupt: bool = False) -> None:
        self.left, self.interrupt = times, interrupt

    def is_set(self) -> bool:
        self.left -= 1
        if self.left < 0 and self.interrupt:
            raise KeyboardInterrupt
        return self.left < 0


@SLOW_AS_PYTHON
@pytest.mark.parametrize("interrupt", [False, True], ids=["cancel", "Ctrl+C"])
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("renderer", BOTH)
def test_a_stop_keeps_what_is_done(renderer, threads, interrupt):
    """Unfinished, and every pixel that is there is the final one's; what is not is transparent."""
    scene = scene_of(place(Sphere()), background=(0.2, 0.3, 0.4))
    options = {"width": 512, "height": 512, "renderer": renderer, "threads": threads, "samples": 2, "tile_size": 32}
    image = render(scene, cancel=_After(20, interrupt), **options)
    whole = render(scene, **options)
    assert whole.finished
    assert not image.finished
    there = image.pixels[..., 3] > 0
    assert 0.0 < there.mean() < 1.0
    assert not image.pixels[~there].any()
    np.testing.assert_array_equal(image.pixels[there], whole.pixels[there])


def test_cancelled_before_it_began():
    cancel = threading.Event()
    cancel.set()
    for name in BOTH:
        image = _small(renderer=name, cancel=cancel)
        assert not image.finished
        assert not image.pixels.any()


def test_errors_in_a_callback_are_the_callers():
    def fail(_: Any) -> None:
        raise ZeroDivisionError("of the caller")

    with pytest.raises(ZeroDivisionError, match="of the caller"):
        _small(on_progress=fail)


@SLOW_AS_PYTHON
def test_two_pictures_at_once():
    """Two threads, two scenes, no state between them."""
    scenes = [BALL, scene_of(place(Box(), checkers_on()))] * 3
    expected = [_small(scene, width=64, height=48).pixels for scene in scenes]
    found: dict[int, np.ndarray] = {}

    def work(k: int) -> None:
        found[k] = render(scenes[k], width=64, height=48, samples=1, renderer=BOTH[0], threads=2).pixels

    threads = [threading.Thread(target=work, args=(k,)) for k in range(len(scenes))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k, pixels in enumerate(expected):
        np.testing.assert_array_equal(found[k], pixels)


@pytest.mark.parametrize(("option", "expected"), [("on_progress", "a function of a Progress"), ("cancel", "a threading.Event")])
def test_what_cannot_be_called_or_asked_is_refused(option, expected):
    """One line, before anything is drawn."""
    with pytest.raises(LimnerError, match=f"^{option} must be {expected}, got int$"):
        render("cornell", width=8, height=8, **{option: 3})


def test_load_wants_a_path():
    """And says what takes arrays."""
    with pytest.raises(LimnerError, match="needs the path of a file, got int"):
        load(3)


def test_render_and_renderer_are_told_the_same() -> None:
    """What `render` may be told of a picture `Renderer` may be told of many, by the same names, with the same defaults."""
    of_render, of_many = (inspect.signature(door).parameters for door in (render, Renderer))
    once = {"camera", "on_progress", "cancel"}  # of one picture: `Renderer.render` takes these
    told, kept = ({name: one.default for name, one in of.items() if name not in once} for of in (of_render, of_many))
    assert told == kept
    assert once <= set(inspect.signature(Renderer.render).parameters)
