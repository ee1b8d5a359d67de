"""Making pictures again: to the bit from every format, and in clear words where something is not as it was."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import limner
from limner.errors import SceneError
from limner.image.image import Image
from limner.produce.again import camera_from_recipe, moved, origin, render_again, verify
from limner.scene.camera import OrthographicCamera, PerspectiveCamera

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def _made(folder: Path, name: str, renderer: str = "raster", **saved: object) -> Path:
    """A picture of a small model, with its origin in the recipe, as the command line makes it."""
    model = folder / "models" / "corner.obj"
    model.parent.mkdir(exist_ok=True)
    model.write_text(OBJ)
    (folder / "pictures").mkdir(exist_ok=True)
    target = folder / "pictures" / name
    scene = limner.load(model).replace(background=(0.1, 0.2, 0.3)).with_ground()
    image = limner.render(scene, width=24, height=16, renderer=renderer, samples=2, seed=3)
    told = origin(str(model), str(target), environment=None, ground=True, background=(0.1, 0.2, 0.3))
    dataclasses.replace(image, recipe=image.recipe.with_values(**told)).save(target, **saved)  # type: ignore[attr-defined]
    return target


@pytest.mark.parametrize("renderer", ["raster", "ray", "path"])
@pytest.mark.parametrize("name", ["a.png", "a.exr"])
def test_a_picture_is_made_again_to_the_bit(tmp_path: Path, renderer: str, name: str) -> None:
    """Model, ground, background, camera and light from the recipe alone; from another folder; with other threads."""
    found = verify(_made(tmp_path, name, renderer), threads=1)
    assert found == (True, 0, 0.0, ())


@pytest.mark.parametrize(
    ("name", "saved"),
    [
        ("a.png", {"bits": 16}),
        ("a.png", {"dither": "random", "seed": 5}),
        ("a.png", {"bits": 1, "dither": "blue_noise"}),
        ("a.exr", {"bits": 16}),
        ("a.jpg", {}),
        ("a.webp", {}),
        ("a.tiff", {}),
        ("a.hdr", {}),
    ],
)
def test_however_it_was_saved(tmp_path: Path, name: str, saved: dict) -> None:
    """What a format loses it loses again."""
    assert verify(_made(tmp_path, name, **saved)).agrees


def test_another_model_is_told(tmp_path: Path) -> None:
    """Its digest differs, and so do pixels."""
    picture = _made(tmp_path, "a.png")
    (tmp_path / "models" / "corner.obj").write_text(OBJ.replace("v 0 0 1", "v 0 0 2"))
    found = verify(picture)
    assert not found.agrees
    assert found.n_different > 0
    assert "digest differs" in found.reasons[0]


def test_a_model_elsewhere_is_named(tmp_path: Path) -> None:
    """Moved: one line that says what is missing; given: to the bit."""
    picture = _made(tmp_path, "a.png")
    elsewhere = (tmp_path / "models" / "corner.obj").rename(tmp_path / "moved.obj")
    with pytest.raises(SceneError, match=r"model '\.\./models/corner\.obj' that the recipe names is not there"):
        verify(picture)
    assert verify(picture, str(elsewhere)).agrees


def test_a_changed_pixel_is_found(tmp_path: Path) -> None:
    """One of them, by one code."""
    picture = _made(tmp_path, "a.png")
    stored = limner.open_image(picture)
    pixels = stored.pixels.copy()
    pixels[3, 4, 1] += 0.01
    Image(pixels, recipe=stored.recipe).save(picture)
    found = verify(picture)
    assert (found.agrees, found.n_different, found.reasons) == (False, 1, ())
    assert found.max_difference == pytest.approx(0.01, abs=0.005)


def test_other_versions_and_sizes_are_told(tmp_path: Path) -> None:
    """A version that is not this; a picture that was resized since."""
    picture = _made(tmp_path, "a.png")
    stored = limner.open_image(picture)
    dataclasses.replace(stored, recipe={**stored.recipe, "limner": "0.0.1"}).save(picture)
    found = verify(picture)
    assert found.agrees
    assert found.reasons == (f"the picture was made by limner 0.0.1, this is {limner.__version__}",)
    stored.resized(12, 8).save(picture)
    found = verify(picture)
    assert not found.agrees
    assert "resized" in found.reasons[-1]


def test_what_cannot_be_made_again_is_refused(tmp_path: Path) -> None:
    """No recipe; one that was stopped; one that names no model."""
    image = limner.render("teapot", width=8, height=8, samples=1)
    Image(image.pixels).save(tmp_path / "a.png")
    with pytest.raises(SceneError, match="holds no recipe"):
        verify(tmp_path / "a.png")
    Image(image.pixels, recipe={**image.recipe, "finished": False}).save(tmp_path / "b.png")
    with pytest.raises(SceneError, match="stopped before it was finished"):
        verify(tmp_path / "b.png")
    image.save(tmp_path / "c.png")
    with pytest.raises(SceneError, match="does not say of what model"):
        verify(tmp_path / "c.png")
    assert verify(tmp_path / "c.png", "teapot").agrees


def test_render_again_gives_the_picture() -> None:
    """From a recipe in memory."""
    image = limner.render("cornell", width=12, height=12, renderer="path", samples=2, seed=9)
    assert (render_again(image.recipe, model="cornell").pixels == image.pixels).all()


@pytest.mark.parametrize(
    "camera",
    [
        PerspectiveCamera.look_at((1, 2, 3), (0, 0, 0), yfov_degrees=33.3, near=0.1, shift_x=0.2, name="eye"),
        OrthographicCamera.look_at((1, 2, 3), (0, 0, 0), height=1.25),
    ],
)
def test_cameras_come_back_to_the_bit(camera: object) -> None:
    """Through JSON, of both kinds."""
    import json

    told = json.loads(json.dumps({key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in vars(camera).items()}))
    again = camera_from_recipe(told)
    assert type(again) is type(camera)
    for key, value in vars(camera).items():
        np.testing.assert_array_equal(getattr(again, key), value)
    with pytest.raises(SceneError, match="of no kind"):
        camera_from_recipe({"lens": 3})


def test_paths_are_as_seen_from_the_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """So that a folder of both can be moved; a file that is called as a built-in is a file."""
    monkeypatch.chdir(tmp_path)
    told = origin("models/a.glb", "out/deep/a.png", environment="sky.hdr", ground=False, background=(1.0, 0.0, 0.0))
    assert told == {"model": "../../models/a.glb", "environment": "../../sky.hdr", "background": [1.0, 0.0, 0.0]}
    assert origin("./teapot", "a.png", environment=None, ground=False, background=None) == {"model": "./teapot"}
    assert moved(told, "out/deep/a.png", "b.png")["model"] == "./models/a.glb"
    assert moved({"model": "teapot"}, "x/a.png", "b.png") == {"model": "teapot"}
