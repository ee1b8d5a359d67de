"""Data sets: what is in the folder, the same bytes every time, nothing half-written, stopped and resumed."""

from __future__ import annotations

import hashlib
import json
import os
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as Picture

import limner
from limner.errors import FileFormatError, RenderError, SceneError, UnsupportedError
from limner.linear import transform
from limner.mesh.shapes import primitives
from limner.produce import dataset
from limner.produce.dataset import orbit_cameras, write
from limner.scene.framing import extent_points

SMALL = {"width": 12, "height": 9, "samples": 1, "threads": 1}


def _scene() -> limner.Scene:
    """Two boxes side by side; one material is on both of them, one on the half of one."""
    clay, chalk = limner.Lambert((0.8, 0.3, 0.2), name="clay"), limner.Lambert(name="chalk")
    box = primitives.box((1.0, 1.0, 1.0))
    slots = (np.arange(len(box.triangles)) % 2).astype(np.int32)
    both = limner.Mesh(box.positions, box.triangles, triangle_materials=slots)
    children = (
        limner.Node("left", transform.translate(-0.8, 0, 0), shapes=(limner.Shape(both, (clay, chalk)),)),
        limner.Node("right", transform.translate(0.8, 0, 0), shapes=(limner.Shape(box, (chalk,)),)),
        limner.Node("sun", lights=(limner.DirectionalLight(), limner.AmbientLight(intensity=0.3))),
    )
    return limner.Scene(limner.Node("world", children=children), background=(0.0, 0.0, 0.0))


def _cameras(n: int = 2) -> tuple[limner.Camera, ...]:
    return orbit_cameras(_scene(), n, elevation_degrees=15.0)


def _digests(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.rglob("*")) if path.is_file()
    }


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data set of three views with all there is."""
    place = tmp_path_factory.mktemp("made") / "views"
    written = write(_scene(), _cameras(3), place, aovs=("depth", "position"), masks="material", annotations="material", **SMALL)
    assert (written.n_views, written.n_rendered, written.finished, written.folder) == (3, 3, True, place)
    return place


def _listing(folder: Path) -> dict:
    return json.loads((folder / "cameras.json").read_text(encoding="ascii"))


def test_every_file_is_listed_and_there(folder: Path) -> None:
    """And nothing else: no leftovers of writing."""
    listed = {name for view in _listing(folder)["views"] for name in view["files"].values()}
    assert set(_digests(folder)) == listed | {"cameras.json", "annotations.json"}
    assert len(listed) == 9


def test_pictures_are_those_of_render(folder: Path) -> None:
    """The picture, the arrays and the mask of a view are what `render` gives for its camera, exactly."""
    scene, camera = _scene(), _cameras(3)[1]
    image = limner.render(scene, camera=camera, aovs=("depth", "position", "instance_id", "material_id"), **SMALL)
    with Picture.open(folder / "images/000001.png") as picture:
        np.testing.assert_array_equal(np.asarray(picture.convert("RGBA")), image.to_uint8())
    with np.load(folder / "arrays/000001.npz") as arrays:
        assert sorted(arrays) == sorted(image.aov)
        for name in arrays:
            np.testing.assert_array_equal(arrays[name], image.aov[name])
            assert arrays[name].dtype == image.aov[name].dtype
    with Picture.open(folder / "masks/000001.png") as picture:
        assert picture.mode.startswith("I")
        np.testing.assert_array_equal(np.asarray(picture).astype(np.int64) - 1, image.aov["material_id"])


def test_cameras_json_leads_back_to_the_cameras(folder: Path) -> None:
    """Read in OpenCV's and in OpenGL's words, both are the camera; positions lie where its K and pose say."""
    listing = _listing(folder)
    assert listing["n_planned"] == 3
    assert listing["id_names"]["instance_id"] == ["world/left", "world/right"]
    for view, camera in zip(listing["views"], _cameras(3), strict=True):
        size = view["width"], view["height"]
        opencv = limner.Camera.from_opencv(view["K"], view["world_to_camera"], *size)
        opengl = limner.Camera.from_opengl(view["camera_to_world"], K=view["K"], width=size[0], height=size[1])
        for made in (opencv, opengl):
            np.testing.assert_allclose(made.world_from_camera, camera.world_from_camera, atol=1e-12)
            assert made.yfov_degrees == pytest.approx(camera.yfov_degrees)
        with np.load(folder / view["files"]["arrays"]) as arrays:
            hit = arrays["instance_id"] >= 0
            p = arrays["position"][hit] @ np.array(view["world_to_camera"])[:3, :3].T + np.array(view["world_to_camera"])[:3, 3]
            xyw = p @ np.array(view["K"]).T
            y, x = np.nonzero(hit)
            np.testing.assert_allclose(xyw[:, :2] / xyw[:, 2:], np.stack([x, y], axis=1), atol=1e-3)
            np.testing.assert_allclose(xyw[:, 2], arrays["depth"][hit], rtol=1e-5)


@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # of pycocotools
def test_annotations_are_the_masks(folder: Path) -> None:
    """pycocotools' own reader: every annotation's mask is the pixels of its instance that have its material."""
    coco = pytest.importorskip("pycocotools.coco", reason="pycocotools belongs to the extra `test`")
    read = coco.COCO()
    read.dataset = json.loads((folder / "annotations.json").read_text(encoding="ascii"))
    read.createIndex()
    names = {category["id"]: category["name"] for category in read.loadCats(read.getCatIds())}
    assert list(names.values()) == ["clay", "chalk"]
    material_names = _listing(folder)["id_names"]["material_id"]
    for image in read.loadImgs(read.getImgIds()):
        view = _listing(folder)["views"][image["id"] - 1]
        assert view["files"]["image"] == image["file_name"]
        with np.load(folder / view["files"]["arrays"]) as arrays:
            instances, materials = arrays["instance_id"], np.append(material_names, "")[arrays["material_id"]]
        covered = np.zeros(instances.shape, dtype=int)
        for annotation in read.loadAnns(read.getAnnIds(imgIds=image["id"])):
            mask = read.annToMask(annotation).astype(bool)
            expected = (instances == annotation["instance_id"]) & (materials == names[annotation["category_id"]])
            np.testing.assert_array_equal(mask, expected)
            assert annotation["area"] == mask.sum() > 0
            covered += mask
        np.testing.assert_array_equal(covered, instances >= 0)
    assert [a["id"] for a in read.dataset["annotations"]] == list(range(1, len(read.dataset["annotations"]) + 1))


def test_the_same_call_writes_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    """In another folder, at another time, on other threads."""
    options = {**SMALL, "threads": 2}
    write(_scene(), _cameras(3), tmp_path / "b", aovs=("depth", "position"), masks="material", annotations="material", **options)
    assert _digests(tmp_path / "b") == _digests(folder)


def test_only_what_is_asked_is_written(tmp_path: Path) -> None:
    """No channels, no annotations: pictures and cameras. Parallel projection says so."""
    parallel = limner.OrthographicCamera.look_at((0, 0, 5), (0, 0, 0), height=4.0, name="front")
    write(_scene(), parallel, tmp_path / "a", aovs=(), annotations=None, **SMALL)
    assert sorted(_digests(tmp_path / "a")) == ["cameras.json", "images/000000.png"]
    view = _listing(tmp_path / "a")["views"][0]
    assert (view["model"], view["name"], view["files"]) == ("orthographic", "front", {"image": "images/000000.png"})


# --- stopping and going on --------------------------------------------------------------------------------------------------


def test_stopped_and_resumed_is_as_if_never_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cancelled after two views: a data set of two; resumed: the bytes of one that was not stopped, and two views not rendered."""
    cancel, made = threading.Event(), iter(range(10))
    real = dataset.npz_bytes

    def cancelling(arrays: Any) -> bytes:
        if next(made) == 1:
            cancel.set()
        return real(arrays)

    monkeypatch.setattr(dataset, "npz_bytes", cancelling)
    stopped = write(_scene(), _cameras(4), tmp_path / "a", cancel=cancel, **SMALL)
    assert (stopped.n_views, stopped.finished) == (2, False)
    assert len(_listing(tmp_path / "a")["views"]) == 2
    assert len(json.loads((tmp_path / "a/annotations.json").read_text())["images"]) == 2
    resumed = write(_scene(), _cameras(4), tmp_path / "a", resume=True, **SMALL)
    assert (resumed.n_views, resumed.n_rendered, resumed.finished) == (4, 2, True)
    write(_scene(), _cameras(4), tmp_path / "b", **SMALL)
    assert _digests(tmp_path / "a") == _digests(tmp_path / "b")


def test_a_view_with_a_missing_file_is_made_again(tmp_path: Path) -> None:
    """Whatever file is missing."""
    write(_scene(), _cameras(), tmp_path, **SMALL)
    before = _digests(tmp_path)
    (tmp_path / "arrays/000001.npz").unlink()
    (tmp_path / "annotations.json").unlink()
    again = write(_scene(), _cameras(), tmp_path, resume=True, **SMALL)
    assert (again.n_rendered, again.finished) == (1, True)
    assert _digests(tmp_path) == before


def test_an_interrupt_while_writing_leaves_whole_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C in the middle of a file of the second view: the first is listed, nothing half-written lies about."""
    real, made = dataset.npz_bytes, iter(range(10))

    def interrupted(arrays: Any) -> bytes:
        if next(made) == 1:
            raise KeyboardInterrupt
        return real(arrays)

    monkeypatch.setattr(dataset, "npz_bytes", interrupted)
    written = write(_scene(), _cameras(3), tmp_path, **SMALL)
    assert (written.n_views, written.finished) == (1, False)
    assert sorted(_digests(tmp_path)) == ["annotations.json", "arrays/000000.npz", "cameras.json", "images/000000.png"]


def test_a_full_disk_leaves_whole_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second array cannot be moved into its place: one line, the first view is listed, no part is left."""
    real = os.replace

    def full(source: Path, target: Path) -> None:
        if Path(target).name == "000001.npz":
            raise OSError(28, "No space left on device")
        real(source, target)

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(RenderError, match=r"cannot write .*000001\.npz: No space left on device"):
        write(_scene(), _cameras(2), tmp_path, **SMALL)
    assert sorted(_digests(tmp_path)) == ["annotations.json", "arrays/000000.npz", "cameras.json", "images/000000.png"]
    assert [view["index"] for view in _listing(tmp_path)["views"]] == [0]


def test_progress_goes_from_nothing_to_all(tmp_path: Path) -> None:
    """Never back, 1 once."""
    heard: list[limner.Progress] = []
    write(_scene(), _cameras(3), tmp_path, on_progress=heard.append, **SMALL)
    shares = [progress.done for progress in heard]
    assert shares[0] == 0.0
    assert shares == sorted(shares)
    assert shares.count(1.0) == 1
    assert {progress.what for progress in heard} == {"dataset"}


# --- slips ------------------------------------------------------------------------------------------------------------------


def test_another_data_set_is_not_overwritten(tmp_path: Path) -> None:
    """Neither by chance nor by resuming with other cameras or options; a strange listing is told."""
    write(_scene(), _cameras(), tmp_path, **SMALL)
    before = _digests(tmp_path)
    with pytest.raises(SceneError, match="holds a data set already"):
        write(_scene(), _cameras(), tmp_path, **SMALL)
    for cameras, options in ((_cameras(3), SMALL), (_cameras(), {**SMALL, "width": 13}), (_cameras(), {**SMALL, "seed": 1})):
        with pytest.raises(SceneError, match="begun with other cameras, sizes, options"):
            write(_scene(), cameras, tmp_path, resume=True, **options)
    assert _digests(tmp_path) == before
    (tmp_path / "cameras.json").write_text("[]")
    with pytest.raises(FileFormatError, match=r"cameras\.json"):
        write(_scene(), _cameras(), tmp_path, resume=True, **SMALL)


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"cameras": ()}, SceneError, "at least one camera"),
        ({"cameras": (1,)}, SceneError, r"cameras\[0\] must be a Camera, got int"),
        ({"scene": "model.glb"}, SceneError, "scene must be a Scene, as limner.load gives it, got str"),
        ({"aovs": ("mood",)}, UnsupportedError, "aov must be one of .* got 'mood'"),
        ({"masks": "triangle"}, UnsupportedError, "got 'triangle'"),
        ({"annotations": "everything"}, UnsupportedError, "got 'everything'"),
        ({"renderer": "crayon"}, UnsupportedError, "renderer must be one of"),
        ({"samples": 0}, SceneError, "samples must be"),
        ({"width": 0}, SceneError, "width must be an integer"),
        ({"height": 0}, SceneError, "height must be an integer"),
    ],
)
def test_a_slip_is_told_before_anything_is_written(changes: dict, error: type, message: str, tmp_path: Path) -> None:
    """One line, no folder."""
    options = {"scene": _scene(), "cameras": _cameras(), "folder": tmp_path / "a", **SMALL, **changes}
    with pytest.raises(error, match=message):
        write(**options)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written_is_told_before_rendering(tmp_path: Path) -> None:
    """Not after the first picture."""
    tmp_path.chmod(0o500)
    with pytest.raises(RenderError, match="no permission"):
        write(_scene(), _cameras(), tmp_path / "a", **SMALL)
    tmp_path.chmod(0o700)


def test_a_file_in_the_place_of_the_folder_is_told(tmp_path: Path) -> None:
    """It stays."""
    (tmp_path / "a").write_text("mine")
    with pytest.raises(RenderError, match="is no folder"):
        write(_scene(), _cameras(), tmp_path / "a", **SMALL)
    assert (tmp_path / "a").read_text() == "mine"


# --- cameras ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("aspect", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("elevation", [-90.0, -30.0, 0.0, 60.0, 90.0])
def test_orbit_cameras_see_everything(aspect: float, elevation: float) -> None:
    """Every point of the scene is inside every picture; equal steps, one distance."""
    scene = _scene()
    cameras = orbit_cameras(scene, 7, elevation_degrees=elevation, aspect=aspect, yfov_degrees=30.0)
    height = 100
    width = round(aspect * height)
    for camera in cameras:
        xy, depth = camera.project(extent_points(scene), width, height)
        assert (depth > 0).all()
        assert (np.abs(xy + 0.5 - np.array([width, height]) / 2) < np.array([width, height]) / 2 / 1.079).all()
    eyes = np.array([camera.world_from_camera[:3, 3] for camera in cameras])
    steps = np.linalg.norm(eyes - np.roll(eyes, 1, axis=0), axis=1)
    np.testing.assert_allclose(steps, steps[0], atol=1e-9)
    assert [camera.name for camera in cameras[:2]] == ["orbit 0", "orbit 1"]


def test_the_sphere_round_everything_touches_the_margin() -> None:
    """As near as can be: a sphere's outline reaches 1/1.08 of the shorter side."""
    scene = limner.Scene(limner.Node(shapes=(limner.Shape(primitives.sphere(1.0, 64)),)))
    camera = orbit_cameras(scene, 1, aspect=1.6, yfov_degrees=50.0)[0]
    distance = float(np.linalg.norm(camera.world_from_camera[:3, 3]))
    outline = np.tan(np.arcsin(1.0 / distance))
    assert outline / camera.half_height() == pytest.approx(1 / 1.08, rel=1e-3)


def test_orbit_slips_are_told() -> None:
    """A number of cameras, a shape, a distance that are none; nothing to see is the unit sphere."""
    for n in (0, 2.5):
        with pytest.raises(SceneError, match="number of cameras"):
            orbit_cameras(_scene(), n)  # type: ignore[arg-type]
    with pytest.raises(SceneError, match="aspect must be positive"):
        orbit_cameras(_scene(), 1, aspect=0.0)
    with pytest.raises(SceneError, match="distance must be positive"):
        orbit_cameras(_scene(), 1, distance=-1.0)
    assert np.isfinite(orbit_cameras(limner.Scene(), 1)[0].world_from_camera).all()
