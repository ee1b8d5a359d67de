"""Turntables: everything in the picture all the way round, clips that decode to what was drawn, nothing left behind."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as Picture

import limner
from limner.errors import RenderError, SceneError, UnsupportedError
from limner.film import Film
from limner.image.image import Image
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.produce.clip import check_clip, write_clip
from limner.produce.palette import Tally, fitted
from limner.produce.turntable import turntable, turntable_cameras, write_turntable

SMALL: dict[str, Any] = {"width": 24, "height": 17, "samples": 1, "threads": 1}
MARGIN = 1.08


def _points_scene(points: np.ndarray) -> limner.Scene:
    """A cloud of tiny corners: what matters is where they are."""
    positions = np.asarray(points, dtype=np.float32)
    triangles = np.arange(len(positions) // 3 * 3, dtype=np.int32).reshape(-1, 3)
    return limner.Scene(limner.Node(shapes=(limner.Shape(limner.Mesh(positions, triangles)),)))


def _scene(**fields: Any) -> limner.Scene:
    """A red and a blue box, off the axis, so that no two azimuths look alike; few colours."""
    red, blue = limner.Lambert((0.8, 0.1, 0.1)), limner.Lambert((0.1, 0.1, 0.8))
    box = primitives.box((1.0, 1.0, 1.0))
    children = (
        limner.Node("red", transform.translate(0.9, 0, 0), shapes=(limner.Shape(box, (red,)),)),
        limner.Node("blue", transform.translate(-0.9, 0.5, 0.3), shapes=(limner.Shape(box, (blue,)),)),
    )
    return limner.Scene(limner.Node("world", children=children), **fields)


def _ball(*lights: Any) -> limner.Scene:
    """The same from all sides: only light can tell the pictures apart."""
    place = transform.rotate_x(-0.8)  # lights shine along -z: down and forwards
    return limner.Scene(limner.Node(shapes=(limner.Shape(limner.Sphere(1.0)),), children=(limner.Node("sun", place, lights=lights),)))


def _decoded(path: Path, mode: str = "RGBA") -> list[np.ndarray]:
    with Picture.open(path) as clip:
        found = []
        for index in range(getattr(clip, "n_frames", 1)):
            clip.seek(index)
            found.append(np.asarray(clip.convert(mode)))
        return found


def _solid(n: int, *, finished: int | None = None) -> Iterator[Image]:
    """Pictures of one colour each; the last before `finished` ends the clip."""
    for k in range(n):
        pixels = np.full((5, 7, 4), (k + 1) / n, dtype=np.float32)
        pixels[..., 3] = 1.0
        yield Image(pixels, finished=finished is None or k < finished)


# --- the camera -----------------------------------------------------------------------------------------------------------


@given(
    seed=st.integers(0, 10_000),
    elevation=st.floats(-90.0, 90.0),
    yfov=st.floats(5.0, 100.0),
    aspect=st.floats(0.3, 3.0),
)
def test_everything_is_in_the_picture_at_every_azimuth(seed: int, elevation: float, yfov: float, aspect: float) -> None:
    """Random clouds, seen from cameras all round: no point beyond the margin. The eye is where it is because some point needs it: a
    circle touches a side, or the eye would come nearer to something than a quarter of the whole."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(9, 3)) * rng.uniform(0.1, 3.0, size=3) + rng.uniform(-5.0, 5.0, size=3)
    scene = _points_scene(points)
    points = scene.shapes()[0][1].geometry.positions.astype(np.float64)  # type: ignore[union-attr]
    cameras = turntable_cameras(scene, 7, elevation_degrees=elevation, yfov_degrees=yfov, aspect=aspect)
    reach_x, reach_y, nearest = 0.0, 0.0, np.inf
    for camera in (*cameras, *turntable_cameras(scene, 240, elevation_degrees=elevation, yfov_degrees=yfov, aspect=aspect)):
        eye = np.linalg.inv(camera.world_from_camera) @ np.concatenate([points, np.ones((9, 1))], axis=1).T
        depth = -eye[2]
        assert (depth > 0.0).all()
        nearest = min(nearest, float(depth.min()))
        reach_x = max(reach_x, float((np.abs(eye[0]) / (depth * camera.half_height() * aspect)).max()))
        reach_y = max(reach_y, float((np.abs(eye[1]) / (depth * camera.half_height())).max()))
    assert max(reach_x, reach_y) <= 1.0 / MARGIN + 1e-6
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    radius = np.hypot(*(points - middle)[:, [0, 2]].T).max()
    extent = np.hypot(2.0 * radius, np.ptp(points[:, 1]))
    assert max(reach_x, reach_y) > (1.0 - 2e-3) / MARGIN or nearest < 0.25 * extent * (1.0 + 1e-2)


def test_cameras_differ_by_a_turn_and_nothing_else() -> None:
    """No pumping: one distance to the axis, one height, equal steps of azimuth towards +x."""
    cameras = turntable_cameras(_scene(), 8, azimuth_degrees=10.0)
    low, high = _scene().bounds()
    axis = ((low + high) / 2.0)[[0, 2]]
    eyes = np.array([camera.world_from_camera[:3, 3] for camera in cameras])
    around = eyes[:, [0, 2]] - axis
    np.testing.assert_allclose(np.hypot(*around.T), np.hypot(*around[0]))
    np.testing.assert_allclose(eyes[:, 1], eyes[0, 1])
    azimuths = np.degrees(np.unwrap(np.arctan2(around[:, 0], around[:, 1])))
    np.testing.assert_allclose(azimuths, 10.0 + 45.0 * np.arange(8))


@pytest.mark.parametrize("scene", [limner.Scene(), _points_scene(np.ones((3, 3)))], ids=["nothing", "a point"])
def test_what_has_no_extent_is_looked_at_all_the_same(scene: limner.Scene) -> None:
    """An empty scene and one whose points coincide have cameras at a finite distance."""
    (camera,) = turntable_cameras(scene, 1)
    assert np.isfinite(camera.world_from_camera).all()
    assert 0.1 < np.linalg.norm(camera.world_from_camera[:3, 3] - (np.ones(3) if scene.shapes() else 0.0)) < 100.0


# --- pictures -------------------------------------------------------------------------------------------------------------


def test_a_turn_has_no_seam() -> None:
    """n pictures of the asked size; the first does not come again at the end, and would follow the last: a turn of twice as many steps
    has the same pictures at every second place."""
    turn = [image.pixels for image in turntable(_scene(), 4, **SMALL)]
    finer = [image.pixels for image in turntable(_scene(), 8, **SMALL)]
    assert [pixels.shape for pixels in turn] == [(17, 24, 4)] * 4
    assert all(np.abs(a - b).mean() > 0.01 for a, b in zip(turn, turn[1:] + turn[:1], strict=True))
    for k in range(4):
        assert (np.abs(turn[k] - finer[2 * k]).max(axis=2) < 1e-3).mean() > 0.98  # edges may fall on the other side of a sample


def test_pictures_do_not_pile_up() -> None:
    """Bug: what a picture is made with refers to itself, and the collector, which the command line makes rare, left a film for every
    picture behind. Fix: the turn collects what is young. Ten pictures leave no more films than two."""
    gc.collect()
    gc.disable()
    try:
        for _ in turntable(_scene(), 10, **SMALL):
            assert sum(isinstance(thing, Film) for thing in gc.get_objects()) <= 2
    finally:
        gc.enable()


@pytest.mark.parametrize(
    ("own", "lights", "alike"),
    [(False, "auto", True), (False, "world", False), (True, "auto", False), (True, "camera", True), (True, "world", False)],
)
def test_which_lights_go_with_the_camera(own: bool, lights: str, alike: bool) -> None:
    """A ball is lit alike in all pictures where its light goes with the camera, and differently where it stays in the world."""
    scene = _ball(limner.DirectionalLight(intensity=2.0)) if own else _ball()
    images = [image.pixels for image in turntable(scene, 3, renderer="ray", lights=lights, **SMALL)]
    inside = images[0][..., 3] == 1.0
    differences = [float(np.abs(image - images[0])[inside].max()) for image in images[1:]]
    assert max(differences) < 1e-3 if alike else min(differences) > 0.1


def test_surroundings_go_with_the_camera_if_told_to(tmp_path: Path) -> None:
    """Red light from the camera's right stays there when lights go with the camera: the ball looks the same all round."""
    sky = np.zeros((16, 32, 3), dtype=np.float32)
    sky[:, 14:19] = (3.0, 0.2, 0.1)  # towards +x
    scene = _ball().replace(environment=limner.Environment(sky))
    options = {**SMALL, "renderer": "ray", "azimuth_degrees": 0.0}
    images = [image.pixels for image in turntable(scene, 4, lights="camera", **options)]
    inside = images[0][..., 3] == 1.0
    assert max(float(np.abs(image - images[0])[inside].max()) for image in images[1:]) < 0.02
    stays = [image.pixels for image in turntable(scene, 4, lights="auto", **options)]
    assert float(np.abs(stays[2] - stays[0])[inside].max()) > 0.1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"n": 0}, "the number of pictures must be an integer from 1"),
        ({"n": 2.5}, "the number of pictures must be an integer from 1"),
        ({"elevation_degrees": 91.0}, "elevation_degrees must lie in"),
        ({"yfov_degrees": 180.0}, "yfov_degrees must lie between 0 and 180"),
        ({"lights": "sun"}, "lights must be one of auto, camera, world"),
        ({"renderer": "crayon"}, "renderer must be one of"),
        ({"width": 0}, "width must be an integer of at least 1"),
    ],
)
def test_slips_are_told_at_the_call(change: dict[str, Any], message: str) -> None:
    """Before the first picture is asked for."""
    with pytest.raises((SceneError, UnsupportedError), match=message):
        turntable(_scene(), **{**SMALL, "n": 2, **change})


# --- clips ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["clip.gif", "clip.webp", "clip.png", "clip.apng"])
def test_clips_decode_to_what_was_drawn(tmp_path: Path, name: str) -> None:
    """Pillow finds every picture, size and time, for ever; without loss where few colours allow it even for GIF; and the bytes are the
    same again."""
    made = write_turntable(_scene(), tmp_path / name, 5, fps=24, **SMALL)
    assert (made.n_pictures, made.finished, made.path) == (5, True, tmp_path / name)
    background = (1.0, 1.0, 1.0) if name.endswith("gif") else None
    drawn = [image.to_uint8() for image in turntable(_scene(background=background), 5, **SMALL)]
    for seen, meant in zip(_decoded(tmp_path / name), drawn, strict=True):
        visible = meant[..., 3:] > 0
        np.testing.assert_array_equal(np.where(visible, seen, 0), np.where(visible, meant, 0))
        np.testing.assert_array_equal(seen[..., 3], meant[..., 3])
    with Picture.open(tmp_path / name) as clip:
        assert (clip.n_frames, clip.size, clip.info["loop"]) == (5, (24, 17), 0)
        total = 0.0
        for index in range(5):
            clip.seek(index)
            clip.load()
            total += clip.info["duration"]
        assert total == pytest.approx(5000.0 / 24.0, abs=6.0)
    first = (tmp_path / name).read_bytes()
    write_turntable(_scene(), tmp_path / name, 5, fps=24, **SMALL)
    assert (tmp_path / name).read_bytes() == first
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_gif_keeps_its_time(tmp_path: Path) -> None:
    """A GIF counts hundredths: at 24 a second, 4 and 5 of them by turns, and 48 pictures take two seconds."""
    write_clip(_solid(48), tmp_path / "clip.gif", fps=24)
    with Picture.open(tmp_path / "clip.gif") as clip:
        durations = []
        for index in range(clip.n_frames):
            clip.seek(index)
            durations.append(clip.info["duration"])
    assert set(durations) <= {40, 50}
    assert sum(durations) == 2000


def test_a_gif_has_one_palette(tmp_path: Path) -> None:
    """Only the first picture brings colours: no block of the others has a table of its own."""
    write_turntable(_scene(), tmp_path / "clip.gif", 4, **SMALL)
    with Picture.open(tmp_path / "clip.gif") as clip:
        colors = clip.global_palette.palette
        for index in range(clip.n_frames):
            clip.seek(index)
            clip.load()
            assert clip._frame_palette is None or clip._frame_palette is clip.global_palette or clip._frame_palette.palette == colors


def test_many_colours_are_shown_by_few() -> None:
    """A gradient of 4096 colours with a white ground: white stays exact, the mean error is below two levels, dithering is on; and the
    dithered mean of a patch is the patch's colour."""
    y, x = np.mgrid[0:128, 0:128]
    picture = np.stack([40 + x, 60 + y, 100 + (x + y) // 4], axis=-1).astype(np.uint8)
    picture[:20] = 255
    tally = Tally()
    tally.add(picture)
    palette = fitted(tally)
    assert len(palette.colors) <= 255
    shown = palette.colors[palette.indices(picture)].astype(float)
    assert (shown[:20] == 255.0).all()
    assert palette.spread > 0.0
    assert np.abs(shown - picture)[20:].mean() < 4.0
    for top in range(32, 96, 32):
        patch = np.s_[top : top + 32, 32:64]
        np.testing.assert_allclose(shown[patch].mean(axis=(0, 1)), picture[patch].mean(axis=(0, 1)), atol=2.0)


def test_few_colours_are_kept_as_they_are() -> None:
    """200 colours need no approximation, and no dither."""
    picture = np.zeros((20, 10, 3), dtype=np.uint8)
    picture[..., 0] = np.arange(200).reshape(20, 10)
    tally = Tally()
    tally.add(np.repeat(np.repeat(picture, 2, axis=0), 2, axis=1))
    palette = fitted(tally)
    assert palette.spread == 0.0
    np.testing.assert_array_equal(palette.colors[palette.indices(picture)], picture)


def test_a_folder_of_pictures(tmp_path: Path) -> None:
    """Numbered PNGs with alpha; the same again is written over; a shorter clip is refused where the end of the longer would stay."""
    made = write_turntable(_scene(), tmp_path / "frames", 3, **SMALL)
    assert made.finished
    names = sorted(path.name for path in (tmp_path / "frames").iterdir())
    assert names == ["0000.png", "0001.png", "0002.png"]
    drawn = [image.to_uint8() for image in turntable(_scene(), 3, **SMALL)]
    for name, meant in zip(names, drawn, strict=True):
        np.testing.assert_array_equal(_decoded(tmp_path / "frames" / name)[0], meant)
    write_turntable(_scene(), tmp_path / "frames", 3, **SMALL)
    with pytest.raises(SceneError, match=r"holds a longer clip, up to 0002\.png"):
        write_turntable(_scene(), tmp_path / "frames", 2, **SMALL)


@pytest.mark.parametrize("name", ["clip.gif", "clip.webp", "clip.png"])
@pytest.mark.parametrize("how", ["unfinished", "interrupt", "error"])
def test_what_was_stopped_leaves_what_was_there(tmp_path: Path, name: str, how: str) -> None:
    """In the third picture: cancelled, Ctrl-C, and a bug. The old file is as it was, and nothing lies beside it."""
    (tmp_path / name).write_bytes(b"old")

    def pictures() -> Iterator[Image]:
        yield from _solid(2)
        if how == "unfinished":
            yield from _solid(1, finished=0)
        raise KeyboardInterrupt if how == "interrupt" else RenderError("broken")

    if how == "error":
        with pytest.raises(RenderError, match="broken"):
            write_clip(pictures(), tmp_path / name)
    else:
        made = write_clip(pictures(), tmp_path / name)
        assert (made.finished, made.n_pictures) == (False, 0)
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [(name, b"old")]


def test_a_stopped_folder_keeps_whole_pictures(tmp_path: Path) -> None:
    """Two of five are there, and both can be read."""
    made = write_clip(_solid(5, finished=2), tmp_path / "frames")
    assert (made.finished, made.n_pictures) == (False, 2)
    assert sorted(path.name for path in (tmp_path / "frames").iterdir()) == ["0000.png", "0001.png"]
    assert [_decoded(tmp_path / "frames" / name)[0].shape for name in ("0000.png", "0001.png")] == [(5, 7, 4)] * 2


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("clip.avi", {}, r"must be \.gif, \.webp"),
        ("clip.gif", {"fps": 60}, "at most 50 in GIF, got 60"),
        ("clip.webp", {"fps": 0}, "fps must be above 0"),
        ("clip.webp", {"fps": float("nan")}, "fps must be above 0"),
        ("clip.gif", {"quality": 80}, "GIF has no quality to choose"),
        ("clip.webp", {"quality": 0}, "quality must be an integer from 1 to 100"),
        ("missing/clip.gif", {}, "there is no folder"),
        ("file/frames", {}, "is no folder"),
    ],
)
def test_what_cannot_be_written_is_refused_first(tmp_path: Path, name: str, options: dict[str, Any], message: str) -> None:
    """In one line, with nothing drawn and nothing written."""
    (tmp_path / "file").write_text("mine")
    with pytest.raises((SceneError, UnsupportedError, RenderError), match=message):
        check_clip(tmp_path / name, **options)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_pictures_of_one_clip_are_of_one_size(tmp_path: Path) -> None:
    """And there is at least one."""
    other = Image(np.ones((4, 4, 4), dtype=np.float32))
    with pytest.raises(SceneError, match="of one size"):
        write_clip([*_solid(1), other], tmp_path / "clip.gif")
    with pytest.raises(SceneError, match="at least one picture"):
        write_clip([], tmp_path / "clip.png")
    assert not list(tmp_path.iterdir())


def test_what_mp4_needs_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the extra: the line that installs it."""
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(UnsupportedError, match=r"pip install 'limner\[video\]'"):
        check_clip(tmp_path / "clip.mp4")


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # the library leaves its pipes to the collector
def test_mp4_has_the_pictures_in_their_colours(tmp_path: Path) -> None:
    """As many as were given, made even in size, and grey levels within what the codec may do."""
    ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="the extra video is not installed")
    made = write_clip(_solid(4), tmp_path / "clip.mp4", fps=10)
    assert (made.n_pictures, made.finished) == (4, True)
    reader = ffmpeg.read_frames(str(tmp_path / "clip.mp4"))
    told = next(reader)
    assert (told["size"], told["fps"]) == ((8, 6), 10.0)
    seen = [np.frombuffer(frame, dtype=np.uint8).mean() for frame in reader]
    np.testing.assert_allclose(seen, [image.to_uint8()[..., :3].mean() for image in _solid(4)], atol=3.0)
    assert [path.name for path in tmp_path.iterdir()] == ["clip.mp4"]
