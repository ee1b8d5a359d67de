"""Saving: each format read back by somebody else's reader, and no half a file whatever happens."""

from __future__ import annotations

import io
import json
import os
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from PIL import Image as Picture

from limner.errors import RenderError, UnsupportedError
from limner.image import save as saving
from limner.image.image import Image
from limner.image.png import png_bytes

RECIPE = {"model": "Würfel", "seed": 7, "samples": 4}


def _picture(*, opaque: bool = False) -> Image:
    pixels = np.random.default_rng(3).random((17, 23, 4), dtype=np.float32)
    if opaque:
        pixels[..., 3] = 1.0
    depth = np.full((17, 23), np.inf, dtype=np.float32)
    depth[3, 4] = 2.5
    ids = np.full((17, 23), -1, dtype=np.int32)
    ids[3, 4] = 16_777_215
    normal = np.zeros((17, 23, 3), dtype=np.float32)
    normal[..., 1] = 1.0
    uv = np.random.default_rng(4).random((17, 23, 2), dtype=np.float32)
    return Image(pixels, aov={"depth": depth, "instance_id": ids, "normal": normal, "uv": uv, "albedo": normal}, recipe=RECIPE)


@pytest.mark.parametrize("opaque", [False, True])
def test_png_reads_back_to_the_bit(tmp_path: Path, opaque: bool) -> None:
    """RGBA with straight alpha, RGB where all is opaque; the recipe in it."""
    image = _picture(opaque=opaque)
    image.save(tmp_path / "a.png")
    with Picture.open(tmp_path / "a.png") as read:
        assert read.mode == ("RGB" if opaque else "RGBA")
        assert (np.asarray(read.convert("RGBA")) == image.to_uint8()).all()
        assert json.loads(read.text["limner"]) == RECIPE


@given(arrays.arrays(np.uint8, st.tuples(st.integers(1, 9), st.integers(1, 9), st.just(4))))
def test_any_bytes_survive_png(encoded: np.ndarray) -> None:
    """Filter and deflate lose nothing, whatever the size and the values."""
    with Picture.open(io.BytesIO(png_bytes(encoded, {"Title": "äöü"}))) as read:
        assert (np.asarray(read.convert("RGBA")) == encoded).all()
        assert read.text["Title"] == "äöü"


def test_exr_holds_light_and_layers(tmp_path: Path) -> None:
    """Float32, premultiplied, infinite depth, ids with -1, layers by compositors' names, the recipe in the header."""
    image = _picture()
    image.save(tmp_path / "a.exr")
    with OpenEXR.File(os.fspath(tmp_path / "a.exr"), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
        header = dict(file.header())
    alpha = image.pixels[..., 3]
    for index, name in enumerate("RGB"):
        assert (channels[name] == image.pixels[..., index] * alpha).all()
    assert (channels["A"] == alpha).all()
    assert (channels["depth.Z"] == image.aov["depth"]).all()
    assert (channels["instance_id.X"] == image.aov["instance_id"]).all()
    for index, axis in enumerate("XYZ"):
        assert (channels[f"normal.{axis}"] == image.aov["normal"][..., index]).all()
    assert {"uv.U", "uv.V", "albedo.R", "albedo.G", "albedo.B"} <= set(channels)
    assert all(pixels.dtype == np.float32 for pixels in channels.values())
    assert json.loads(header["limner"]) == RECIPE


def test_exr_refuses_ids_that_floats_cannot_tell_apart(tmp_path: Path) -> None:
    """2^24 + 1 would silently become its neighbour."""
    pixels = np.zeros((1, 1, 4), np.float32)
    image = Image(pixels, aov={"triangle_id": np.full((1, 1), (1 << 24) + 1, np.int32)})
    with pytest.raises(UnsupportedError, match="triangle_id"):
        image.save(tmp_path / "a.exr")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("extension", ["webp", "tiff", "tif"])
def test_lossless_formats_read_back_to_the_bit(tmp_path: Path, extension: str) -> None:
    """What Pillow writes without loss is what a screen gets."""
    image = _picture(opaque=True)
    image.save(tmp_path / f"a.{extension}")
    with Picture.open(tmp_path / f"a.{extension}") as read:
        assert (np.asarray(read.convert("RGBA")) == image.to_uint8()).all()


@pytest.mark.parametrize("extension", ["jpg", "jpeg", "JPG"])
def test_jpeg_shows_the_picture_over_white(tmp_path: Path, extension: str) -> None:
    """JPEG has no alpha: what is transparent turns white, mixed in linear light."""
    pixels = np.zeros((16, 16, 4), dtype=np.float32)
    pixels[:, 8:] = (0.0, 0.0, 0.0, 0.5)
    Image(pixels).save(tmp_path / f"a.{extension}")
    with Picture.open(tmp_path / f"a.{extension}") as read:
        shown = np.asarray(read.convert("RGB")).astype(int)
    assert abs(shown[8, 2] - 255).max() <= 2
    assert abs(shown[8, 13] - 188).max() <= 2


@pytest.mark.parametrize("name", ["a.gif3", "a", "a.png.bak", ".png"])
def test_an_unknown_extension_names_the_known_ones(tmp_path: Path, name: str) -> None:
    """And writes nothing."""
    with pytest.raises(UnsupportedError, match=r"\.png, \.exr, \.jpg, \.jpeg, \.webp, \.tif, \.tiff"):
        _picture().save(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_is_refused(tmp_path: Path) -> None:
    """In one line, with its name."""
    with pytest.raises(RenderError, match=r"there is no folder .*missing") as raised:
        _picture().save(tmp_path / "missing" / "a.png")
    assert "\n" not in str(raised.value)


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    """Even if its name ends like a picture's."""
    (tmp_path / "a.png").mkdir()
    with pytest.raises(RenderError, match="it is a folder"):
        _picture().save(tmp_path / "a.png")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="whoever is root may write anywhere")
def test_a_folder_without_permission_is_refused(tmp_path: Path) -> None:
    """Before anything is written."""
    tmp_path.chmod(0o555)
    try:
        with pytest.raises(RenderError, match="no permission"):
            _picture().save(tmp_path / "a.png")
    finally:
        tmp_path.chmod(0o755)


@pytest.mark.parametrize("extension", ["png", "exr", "jpg"])
@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError(28, "No space left on device")])
def test_what_was_there_survives_a_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, extension: str, error: BaseException
) -> None:
    """An interrupt or a full disk in the last moment leaves the old file and nothing else."""
    target = tmp_path / f"a.{extension}"
    target.write_bytes(b"the old picture")

    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr(saving.os, "replace", fail)
    with pytest.raises(KeyboardInterrupt if isinstance(error, KeyboardInterrupt) else RenderError):
        _picture().save(target)
    assert target.read_bytes() == b"the old picture"
    assert list(tmp_path.iterdir()) == [target]


_SMALL_DISK = """
import resource, signal, sys
import numpy as np
from limner.errors import RenderError
from limner.image.image import Image
image = Image(np.random.default_rng(0).random((256, 256, 4), dtype=np.float32))
import OpenEXR, PIL.Image
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))
try:
    image.save(sys.argv[1])
except RenderError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="sets a limit on file sizes as Linux knows it")
@pytest.mark.parametrize("extension", ["png", "exr", "tiff"])
def test_a_disk_that_fills_up_is_told_in_one_line(tmp_path: Path, extension: str) -> None:
    """A real write that fails half-way, in a process that may only write 50 kB, leaves no file."""
    target = tmp_path / f"a.{extension}"
    done = subprocess.run([sys.executable, "-c", _SMALL_DISK, str(target)], capture_output=True, text=True, check=True)
    assert done.stdout == f"cannot write {target}: File too large\n"
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("extension", ["png", "exr"])
def test_a_device_is_written_to_and_not_replaced(tmp_path: Path, extension: str) -> None:
    """A link to /dev/full: the error is the device's, and the device is still one."""
    link = tmp_path / f"a.{extension}"
    link.symlink_to("/dev/full")
    # the extension is that of the name given, the place is where the link leads
    with pytest.raises(RenderError, match="No space left on device"):
        _picture().save(link)
    assert stat.S_ISCHR(Path("/dev/full").stat().st_mode)


def test_a_link_is_followed_and_modes_are_kept(tmp_path: Path) -> None:
    """The picture lands where the link leads; a private file stays private; a new one gets what the umask leaves."""
    real = tmp_path / "real.png"
    real.write_bytes(b"")
    real.chmod(0o600)
    (tmp_path / "link.png").symlink_to(real)
    _picture().save(tmp_path / "link.png")
    assert (tmp_path / "link.png").is_symlink()
    assert real.read_bytes().startswith(b"\x89PNG")
    assert stat.S_IMODE(real.stat().st_mode) == 0o600
    umask = os.umask(0o022)
    try:
        _picture().save(tmp_path / "new.png")
    finally:
        os.umask(umask)
    assert stat.S_IMODE((tmp_path / "new.png").stat().st_mode) == 0o644


def test_a_dash_is_standard_output(capfdbinary: Any) -> None:
    """A PNG, and nothing else."""
    _picture().save("-")
    assert capfdbinary.readouterr().out.startswith(b"\x89PNG")


def test_saving_is_the_same_to_the_byte(tmp_path: Path) -> None:
    """No time stamp, no order of a set: the same picture is the same PNG."""
    _picture().save(tmp_path / "a.png")
    _picture().save(tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
