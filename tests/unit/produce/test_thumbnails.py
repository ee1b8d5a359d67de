"""Thumbnails of a folder: every model once, errors told and passed over, nothing half-written, nothing done twice."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as Picture

from limner.errors import LimnerWarning, RenderError, SceneError, UnsupportedError
from limner.produce import thumbnails as module
from limner.produce.thumbnails import Batch, Thumbnail, index_sheet, models_in, thumbnails

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
OPTIONS: dict[str, Any] = {"size": 32, "samples": 1, "threads": 1}


@pytest.fixture
def models(tmp_path: Path) -> Path:
    """Three sound models, one of them below, a broken one, a hidden one, and what is no model."""
    folder = tmp_path / "models"
    (folder / "parts").mkdir(parents=True)
    (folder / ".git").mkdir()
    for name in ("a.obj", "b.OBJ", "parts/a.obj", ".hidden.obj", ".git/c.obj"):
        (folder / name).write_text(TRIANGLE)
    (folder / "broken.glb").write_bytes(b"glTF nonsense")
    (folder / "readme.txt").write_text("no model")
    return folder


def _files(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_models_are_found_by_name_and_in_order(models: Path) -> None:
    """Hidden files and folders are passed over, sub-folders looked into when asked."""
    assert [path.name for path in models_in(models)] == ["a.obj", "b.OBJ", "broken.glb"]
    assert [str(path.relative_to(models)) for path in models_in(models, recursive=True)] == ["a.obj", "b.OBJ", "broken.glb", "parts/a.obj"]


def test_every_model_has_its_picture_and_every_error_its_line(models: Path, tmp_path: Path) -> None:
    """The broken one is told of in one line without its path; the others are pictures of the asked size, in which something is seen, and
    nothing else is there. The same again gives the same bytes."""
    out = tmp_path / "out"
    batch = thumbnails(models, out, recursive=True, **OPTIONS)
    assert [(item.source.name, item.status) for item in batch.items] == [
        ("a.obj", "made"), ("b.OBJ", "made"), ("broken.glb", "failed"), ("a.obj", "made"),
    ]  # fmt: skip
    assert batch.finished
    (failed,) = (item for item in batch.items if item.error)
    assert "\n" not in failed.error
    assert "broken.glb" not in failed.error
    assert _files(out) == ["a.obj.png", "b.OBJ.png", "parts/a.obj.png"]
    contents = {}
    for item in batch.items:
        if item.status == "made":
            with Picture.open(item.path) as picture:
                pixels = np.asarray(picture.convert("RGBA"))
            assert pixels.shape == (32, 32, 4)
            assert 0.1 < (pixels[..., 3] > 0).mean() < 0.9
            contents[item.path] = item.path.read_bytes()
    thumbnails(models, out, recursive=True, **OPTIONS)
    assert all(path.read_bytes() == data for path, data in contents.items())


def test_update_makes_what_is_missing_old_or_of_another_size(models: Path, tmp_path: Path) -> None:
    """The second time all are kept; a touched model, a deleted picture and another size are made again; failures are tried again."""
    out = tmp_path / "out"

    def statuses(**options: Any) -> dict[str, str]:
        batch = thumbnails(models, out, recursive=True, update=True, **{**OPTIONS, **options})
        return {str(item.source.relative_to(models)): item.status for item in batch.items}

    assert set(statuses().values()) == {"made", "failed"}
    assert statuses() == {"a.obj": "kept", "b.OBJ": "kept", "broken.glb": "failed", "parts/a.obj": "kept"}
    later = (out / "a.obj.png").stat().st_mtime + 10.0
    os.utime(models / "a.obj", (later, later))
    (out / "parts/a.obj.png").unlink()
    assert statuses() == {"a.obj": "made", "b.OBJ": "kept", "broken.glb": "failed", "parts/a.obj": "made"}
    assert statuses(size=16)["b.OBJ"] == "made"
    (out / "b.OBJ.png").write_bytes(b"cut off")
    assert statuses(size=16)["b.OBJ"] == "made"


def test_names_that_differ_by_extension_do_not_meet(tmp_path: Path) -> None:
    """car.obj and car.off are two models and two pictures."""
    for name in ("car.obj", "car.off"):
        (tmp_path / name).write_text(TRIANGLE if name.endswith("obj") else "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    batch = thumbnails(tmp_path, tmp_path / "out", **OPTIONS)
    assert len({item.path for item in batch.items}) == 2


def test_backgrounds(models: Path, tmp_path: Path) -> None:
    """Transparent, or opaque in the colour that was asked for."""
    thumbnails(models, tmp_path / "clear", **OPTIONS)
    thumbnails(models, tmp_path / "white", background=(1.0, 1.0, 1.0), **OPTIONS)
    with Picture.open(tmp_path / "clear/a.obj.png") as clear, Picture.open(tmp_path / "white/a.obj.png") as white:
        assert clear.convert("RGBA").getpixel((0, 0))[3] == 0
        assert white.convert("RGBA").getpixel((0, 0)) == (255, 255, 255, 255)


def test_a_model_without_anything_to_see_is_warned_of(tmp_path: Path) -> None:
    """All its triangles lie in one point: its picture is made, is empty, and that is said."""
    (tmp_path / "dot.obj").write_text("v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimnerWarning)  # about triangles without area
        (item,) = thumbnails(tmp_path, tmp_path / "out", **OPTIONS).items
    assert (item.status, item.warning) == ("made", "nothing is seen")


def test_whatever_is_wrong_with_one_is_not_wrong_with_the_next(models: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bug of ours and a full memory fail for one model each, with a line that says so."""
    drawn = module._Work._drawn

    def trouble(work: Any, source: Path, cancel: Any) -> Any:
        if source.name == "a.obj":
            raise MemoryError
        if source.name == "b.OBJ":
            raise ZeroDivisionError("division by\nzero")
        return drawn(work, source, cancel)

    monkeypatch.setattr(module._Work, "_drawn", trouble)
    (models / "c.obj").write_text(TRIANGLE)
    batch = thumbnails(models, tmp_path / "out", **OPTIONS)
    told = {item.source.name: item.error for item in batch.items}
    assert told["a.obj"] == "not enough memory"
    assert told["b.OBJ"] == "division by zero (ZeroDivisionError, not foreseen)"
    assert told["c.obj"] == ""


def test_a_stop_keeps_what_is_whole(models: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C in the second model: the first picture is there, and nothing else."""
    drawn = module._Work._drawn

    def stopped(work: Any, source: Path, cancel: Any) -> Any:
        if source.name == "b.OBJ":
            raise KeyboardInterrupt
        return drawn(work, source, cancel)

    monkeypatch.setattr(module._Work, "_drawn", stopped)
    batch = thumbnails(models, tmp_path / "out", **OPTIONS)
    assert not batch.finished
    assert [item.status for item in batch.items] == ["made"]
    assert _files(tmp_path / "out") == ["a.obj.png"]


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"folder": "nowhere"}, SceneError, "there is no folder"),
        ({"folder": "models/readme.txt"}, SceneError, "is no folder"),
        ({"folder": "empty"}, SceneError, "there is no model in .*its sub-folders were not looked into"),
        ({"size": 8}, SceneError, "size must be an integer from 16 to 4096"),
        ({"renderer": "crayon"}, UnsupportedError, "renderer must be one of"),
        ({"output": "models/readme.txt"}, RenderError, "cannot write in"),
    ],
)
def test_what_is_wrong_with_all_is_said_once(models: Path, tmp_path: Path, change: dict[str, Any], error: type, message: str) -> None:
    """Before anything is drawn, or with the first that cannot be written; nothing lies about."""
    (tmp_path / "empty").mkdir()
    before = _files(tmp_path)
    options = {"folder": "models", "output": "out", **OPTIONS, **change}
    with pytest.raises(error, match=message):
        thumbnails(tmp_path / options.pop("folder"), tmp_path / options.pop("output"), **options)
    assert _files(tmp_path) == before


# --- the sheet ------------------------------------------------------------------------------------------------------------


def _colored(folder: Path, colors: dict[str, tuple[int, int, int]], size: tuple[int, int] = (40, 20)) -> Batch:
    items = []
    for name, color in colors.items():
        path = folder / f"{name}.png"
        Picture.new("RGB", size, color).save(path)
        items.append(Thumbnail(folder / name, path, "made"))
    return Batch(tuple(items))


def test_the_sheet_shows_every_picture_in_its_cell(tmp_path: Path) -> None:
    """As many areas of each colour as there are pictures of it, as large as they are; one that failed has its reason in red."""
    colors = {"a.obj": (250, 10, 10), "b.obj": (10, 250, 10), "c.obj": (10, 10, 250)}
    batch = _colored(tmp_path, colors)
    failed = Thumbnail(tmp_path / "d.obj", tmp_path / "d.png", "failed", error="it is broken in some way")
    pixels = index_sheet(Batch((*batch.items, failed))).to_uint8()[..., :3]
    for color in colors.values():
        assert (pixels == color).all(axis=2).sum() == 40 * 20
    plain = index_sheet(Batch((*batch.items, Thumbnail(tmp_path / "d.obj", tmp_path / "c.obj.png", "made")))).to_uint8()
    reddish = (pixels[..., 0].astype(int) > 60 + pixels[..., 1:].max(axis=2)) & (np.abs(pixels.astype(int) - (250, 10, 10)).max(axis=2) > 0)
    assert reddish.sum() > 30
    assert plain.shape[:2] == pixels.shape[:2]


def test_large_pictures_shrink_and_many_make_small_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A picture larger than a cell fills it without being cut; with a thousand the sheet stays below its bound, and beyond
    that there is none."""
    batch = _colored(tmp_path, {"a.obj": (250, 10, 10)}, size=(800, 400))
    pixels = index_sheet(batch).to_uint8()[..., :3]
    assert (np.abs(pixels.astype(int) - (250, 10, 10)).max(axis=2) <= 1).sum() == pytest.approx(256 * 128, rel=0.02)
    monkeypatch.setattr(module, "_MOST_SHEET_PIXELS", 1 << 21)
    monkeypatch.setattr(module, "_shrunk", lambda _path, _size: None)
    monkeypatch.setattr(module.Canvas, "text", lambda *_, **__: None)
    made = index_sheet(Batch(batch.items * 1000))
    assert 1 << 19 < made.width * made.height <= 1 << 21
    with pytest.raises(UnsupportedError, match="holds no 100000 pictures"):
        index_sheet(Batch(batch.items * 100_000))


def test_equal_names_are_told_apart(tmp_path: Path) -> None:
    """By the folder they stand in."""
    items = tuple(Thumbnail(tmp_path / name, tmp_path, "kept") for name in ("a/x.obj", "b/x.obj", "b/y.obj"))
    assert module._names(Batch(items)) == ["a/x.obj", "b/x.obj", "y.obj"]


def test_an_empty_batch_makes_no_sheet() -> None:
    with pytest.raises(SceneError, match="at least one"):
        index_sheet(Batch())
