"""Image: which way is up, what is refused, what a notebook and NumPy get."""

from __future__ import annotations

import io
import pickle

import numpy as np
import pytest
from PIL import Image as Picture

from limner.errors import SceneError, UnsupportedError
from limner.image.image import Image


def _numbered(height: int, width: int) -> np.ndarray:
    """A picture whose red is the row from the top and whose green is the column."""
    pixels = np.ones((height, width, 4), dtype=np.float32)
    pixels[..., 0] = np.arange(height)[:, None]
    pixels[..., 1] = np.arange(width)
    return pixels


def test_the_book_counts_rows_from_the_bottom() -> None:
    """at(i, j) is column i and row j from below; pixels is row from above, then column."""
    image = Image(_numbered(3, 5))
    assert (image.width, image.height) == (5, 3)
    for i in range(5):
        for j in range(3):
            assert image.at(i, j)[:2].tolist() == [2 - j, i]


@pytest.mark.parametrize("place", [(-1, 0), (0, -1), (5, 0), (0, 3)])
def test_outside_is_refused(place: tuple[int, int]) -> None:
    """A negative index does not wrap round."""
    with pytest.raises(SceneError, match="outside the picture of 5 x 3"):
        Image(_numbered(3, 5)).at(*place)


@pytest.mark.parametrize(
    "pixels",
    [np.zeros((2, 2, 3), np.float32), np.zeros((2, 2, 4)), np.zeros((0, 2, 4), np.float32), np.zeros((2, 4), np.float32)],
)
def test_what_is_no_picture_is_refused(pixels: np.ndarray) -> None:
    """Shape and dtype are part of the promise."""
    with pytest.raises(SceneError, match=r"image\.pixels must be \(height, width, 4\) float32"):
        Image(pixels)


def test_an_aov_is_as_large_as_the_picture() -> None:
    """Anything else would be another picture's."""
    with pytest.raises(SceneError, match=r"image\.aov\['depth'\] must be as large"):
        Image(_numbered(3, 5), aov={"depth": np.zeros((5, 3), np.float32)})


def test_pixels_cannot_be_written_but_the_given_array_can() -> None:
    """The picture is a value; the caller's array stays the caller's."""
    given = _numbered(2, 2)
    image = Image(given)
    with pytest.raises(ValueError, match="read-only"):
        image.pixels[0, 0, 0] = 9.0
    given[0, 0, 0] = 9.0


def test_a_screen_gets_encoded_colour_and_linear_alpha() -> None:
    """Mid grey becomes 188; half covered stays 128."""
    image = Image(np.full((1, 1, 4), 0.5, dtype=np.float32))
    assert image.to_uint8()[0, 0].tolist() == [188, 188, 188, 128]
    with pytest.raises(UnsupportedError, match="view must be one of none, standard"):
        image.to_uint8("sepia")


def test_notebooks_get_the_same_picture() -> None:
    """`_repr_png_` decodes to `to_uint8`."""
    image = Image(np.random.default_rng(1).random((7, 9, 4), dtype=np.float32))
    assert (np.asarray(Picture.open(io.BytesIO(image._repr_png_()))) == image.to_uint8()).all()


def test_numpy_takes_the_pixels() -> None:
    """np.asarray shares, np.array copies, a dtype converts."""
    image = Image(_numbered(2, 3))
    assert np.shares_memory(np.asarray(image), image.pixels)
    assert not np.shares_memory(np.array(image), image.pixels)
    assert np.asarray(image, dtype=np.float64).dtype == np.float64


def test_it_survives_pickling() -> None:
    """Workers send pictures home."""
    image = Image(_numbered(2, 3), aov={"depth": np.ones((2, 3), np.float32)}, recipe={"seed": 1}, finished=False)
    again = pickle.loads(pickle.dumps(image))
    assert (again.pixels == image.pixels).all()
    assert (again.aov["depth"] == 1.0).all()
    assert (again.recipe, again.finished) == ({"seed": 1}, False)
