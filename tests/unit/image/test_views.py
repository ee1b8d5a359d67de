"""Views and exposure where a picture leaves: on the screen, in files, in clips, on the command line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from limner.cli import screen
from limner.color.transfer import bytes_from_linear
from limner.color.views import VIEWS, screen_light
from limner.errors import UnsupportedError
from limner.files.open_image import open_image
from limner.image.image import Image
from limner.produce.clip import write_clip


def _bright(alpha: float = 1.0) -> Image:
    """Light from nothing to 16, with one alpha."""
    pixels = np.random.default_rng(5).uniform(0.0, 4.0, (8, 12, 4)).astype(np.float32) ** 2
    pixels[..., 3] = alpha
    return Image(pixels)


def test_the_command_line_knows_the_same_views() -> None:
    """Its list is written out, as it must not import NumPy."""
    assert screen.VIEWS == VIEWS


@pytest.mark.parametrize("view", VIEWS)
def test_a_file_holds_what_the_screen_gets(tmp_path: Path, view: str) -> None:
    """PNG in 8 and 16 bits, WebP; and the recipe says so, so that the picture can be saved like that again."""
    image = _bright(0.5)
    shown = image.to_uint8(view, -1.0)
    image.save(tmp_path / "a.png", view=view, exposure=-1.0)
    image.save(tmp_path / "b.png", view=view, exposure=-1.0, bits=16)
    read = open_image(tmp_path / "a.png")
    assert (read.to_uint8() == shown).all()
    assert read.recipe["saved"] == ({"exposure": -1.0} if view == "standard" else {"exposure": -1.0, "view": view})
    assert np.abs(open_image(tmp_path / "b.png").to_uint8().astype(int) - shown).max() <= 1


def test_data_come_through_none() -> None:
    """Codes are the numbers themselves, rounded: 0.5 is 128, not 188."""
    image = Image(np.full((1, 1, 4), 0.5, dtype=np.float32))
    assert image.to_uint8("none")[0, 0].tolist() == [128, 128, 128, 128]
    assert image.to_uint8("none", 0.5)[0, 0].tolist() == [180, 180, 180, 128]


def test_standard_is_what_it_was() -> None:
    """Not one array more, and the same codes."""
    image = _bright()
    assert image.viewed() is image
    assert screen_light(image.pixels) is image.pixels
    assert (image.to_uint8()[..., :3] == bytes_from_linear(image.pixels[..., :3])).all()


@pytest.mark.parametrize("name", ["a.exr", "a.hdr", "a.pfm"])
def test_formats_of_light_have_no_views(tmp_path: Path, name: str) -> None:
    """A compositor expects light; nothing is written."""
    for how in ({"view": "agx"}, {"exposure": 1.0}):
        with pytest.raises(UnsupportedError, match="holds light as it is"):
            _bright().save(tmp_path / name, **how)
    assert not list(tmp_path.iterdir())


def test_paper_stays_white(tmp_path: Path) -> None:
    """A JPEG and a GIF put what is transparent before the screen's white, whatever the view does to white light."""
    image = Image(np.zeros((16, 16, 4), dtype=np.float32))
    image.save(tmp_path / "a.jpg", view="agx")
    assert (open_image(tmp_path / "a.jpg").to_uint8()[..., :3] >= 254).all()
    clip = write_clip([image], tmp_path / "a.gif", view="agx", exposure=1.0)
    assert clip.finished
    assert (open_image(tmp_path / "a.gif").to_uint8()[..., :3] == 255).all()


def test_clips_have_views(tmp_path: Path) -> None:
    """Every picture of a folder is what `save` would have written."""
    images = [_bright(), _bright()]
    write_clip(images, tmp_path / "frames", view="hable", exposure=1.0)
    images[0].save(tmp_path / "a.png", view="hable", exposure=1.0)
    assert (tmp_path / "frames" / "0000.png").read_bytes() == (tmp_path / "a.png").read_bytes()


def test_light_is_converted_by_a_view_on_the_command_line(tmp_path: Path) -> None:
    """`limner convert a.exr b.png --view agx`; to an EXR it is refused as wrong usage before anything is written."""
    from limner.cli.commands import limner
    from limner.cli.talk import Talk

    image = _bright()
    image.save(tmp_path / "a.exr")
    how = ["convert", str(tmp_path / "a.exr"), "--view", "agx", "--exposure", "-1"]
    assert CliRunner().invoke(limner, [*how, str(tmp_path / "b.png")], obj=Talk()).exit_code == 0
    assert (open_image(tmp_path / "b.png").to_uint8() == image.to_uint8("agx", -1.0)).all()
    refused = CliRunner().invoke(limner, [*how, str(tmp_path / "c.exr")], obj=Talk())
    assert refused.exit_code == 2
    assert "holds light as it is" in refused.output
    assert not (tmp_path / "c.exr").exists()
