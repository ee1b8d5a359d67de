"""An animation, picture by picture: which moments, from where, and that each is the picture of its moment."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as Picture

import limner
from limner.errors import SceneError, UnsupportedError
from limner.produce.animate import animate, camera_for_all, frame_times, write_animation
from limner.scene.animation import Animation, NodeChannel
from limner.scene.camera import PerspectiveCamera
from limner.scene.framing import extent_points, framing_camera
from limner.scene.light import DirectionalLight
from limner.scene.material import Lambert
from limner.scene.motion import KeyedMotion, Motion
from limner.scene.node import Node
from limner.scene.scene import Scene
from limner.scene.shape import Shape, Sphere
from limner.scene.track import Track

SLIDE = KeyedMotion(
    Track((0.0, 1.0), ((-2.0, 0.0, 0.0), (2.0, 0.0, 0.0))), Track.constant((0, 0, 0, 1), rotates=True), Track.constant((1, 1, 1))
)
BALL = Scene(
    Node("world", lights=(DirectionalLight(),), children=(Node("ball", shapes=(Shape(Sphere(1.0), (Lambert(emission=(1, 1, 1)),)),)),)),
    animations=(Animation("slide", (NodeChannel("world/ball", SLIDE),)),),
)
CAMERA = PerspectiveCamera.look_at((0, 0, 12), (0, 0, 0), yfov_degrees=30)
SIZE = {"width": 32, "height": 16, "samples": 1, "camera": CAMERA}


def test_times_begin_at_the_start_and_leave_out_the_end() -> None:
    """So that a loop has no picture twice."""
    assert frame_times(BALL, None, 4.0).tolist() == [0.0, 0.25, 0.5, 0.75]
    assert frame_times(BALL, None, 2.0, 0.5, 2.0).tolist() == [0.5, 1.0, 1.5]
    assert frame_times(BALL, None, 4.0, 0.5, 0.5).tolist() == [0.5]


def test_pictures_are_those_of_their_moments() -> None:
    """To the bit what `render` makes of the scene with the ball put there by hand."""
    for image, x in zip(animate(BALL, fps=2.0, **SIZE), (-2.0, 0.0), strict=True):
        place = np.eye(4)
        place[0, 3] = x
        ball = Node("ball", place, shapes=BALL.root.children[0].shapes)
        scene = Scene(Node("world", lights=BALL.root.lights, children=(ball,)))
        np.testing.assert_array_equal(image.pixels, limner.render(scene, **SIZE).pixels)


def test_render_takes_a_time() -> None:
    """`time`, and which animation by name, number, or all."""
    pictures = [limner.render(BALL, time=0.5, animation=which, **SIZE).pixels for which in (None, "slide", 0, "all")]
    for picture in pictures:
        np.testing.assert_array_equal(picture, limner.render(BALL, **SIZE).pixels)


def test_an_open_shutter_blurs_what_an_animation_moves() -> None:
    """As a node's own motion along the same way does, to the bit."""
    options = {**SIZE, "renderer": "ray", "samples": 8, "shutter": (0.25, 0.75)}
    ball = Node("ball", shapes=BALL.root.children[0].shapes, motion=Motion([0.0, 1.0], np.stack([SLIDE.at(0.0), SLIDE.at(1.0)])))
    scene = Scene(Node("world", lights=BALL.root.lights, children=(ball,)))
    blurred = limner.render(BALL, **options).pixels
    np.testing.assert_array_equal(blurred, limner.render(scene, **options).pixels)
    assert ((blurred[..., 3] > 0.0) & (blurred[..., 3] < 1.0)).sum() > 20


def test_one_camera_sees_it_all() -> None:
    """Wider than one for the beginning, and as good as one that is told of all points."""
    camera = camera_for_all(BALL, frame_times(BALL, None, 24.0), None, 2.0)
    ends = np.concatenate([extent_points(BALL.at(time)) for time in (0.0, 23.0 / 24.0)])
    assert isinstance(camera, PerspectiveCamera)
    np.testing.assert_allclose(camera.world_from_camera, framing_camera(ends, 2.0).world_from_camera, atol=1e-6)
    for image in animate(BALL, fps=2.0, width=32, height=16, samples=1):
        alpha = image.pixels[..., 3]
        assert alpha.any()
        assert not np.concatenate([alpha[[0, -1]].ravel(), alpha[:, [0, -1]].ravel()]).any()


def test_a_clip_is_written(tmp_path: Path) -> None:
    """With as many pictures; stopped, there is none."""
    clip = write_animation(BALL, tmp_path / "slide.webp", fps=4.0, **SIZE)
    assert (clip.n_pictures, clip.finished) == (4, True)
    with Picture.open(tmp_path / "slide.webp") as stored:
        assert (stored.n_frames, stored.size) == (4, (32, 16))


def test_the_command_line_plays(limner_process: Any, tmp_path: Path) -> None:
    """Bad words get one line; a model without animation says so."""
    done = limner_process("animate", "cornell", "-o", "clip.gif")
    assert (done.returncode, done.stderr.strip()) == (2, "limner: error: the scene has no animation; `limner info` tells what is in it")
    done = limner_process(
        "animate", "cornell", "-o", "clip.gif", "--end", "0.2", "--fps", "10", "--width", "8", "--height", "8", "--samples", "1", "--json"
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["frames"] == 2


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"fps": 0.0}, SceneError, "fps must be positive"),
        ({"animation": "fly"}, SceneError, "it has 0 'slide'"),
        ({"start": 2.0}, SceneError, "must end after it starts"),
        ({"end": 1e9}, SceneError, "the most is 100000"),
        ({"shutter": 2.0}, SceneError, r"shutter must lie in \[0, 1\]"),
        ({"shutter": 0.5}, UnsupportedError, "raster sees one time only"),
    ],
)
def test_bad_calls_are_refused_at_once(options: dict[str, Any], error: type[Exception], message: str) -> None:
    """Before anything is drawn."""
    with pytest.raises(error, match=message):
        animate(BALL, **options)


def test_time_and_shutter_exclude_each_other() -> None:
    """A picture is of one or the other; times are finite numbers."""
    with pytest.raises(UnsupportedError, match="give time or shutter, not both"):
        limner.render(BALL, time=0.0, shutter=(0.0, 1.0), renderer="ray")
    for time in (float("nan"), "noon"):
        with pytest.raises(SceneError, match="time must be"):
            limner.render(BALL, time=time)  # type: ignore[arg-type]
