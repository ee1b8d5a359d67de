"""The picture: what a renderer gives and what a file, a notebook or an array takes (FoCG 3).

    image.pixels                 (height, width, 4) float32, linear light, straight alpha, row 0 on top
    image.at(i, j)               the book's pixel: column i, row j counted from the bottom
    image.sample(x, y)           the picture as a function of continuous places
    image.resized(960, 540)      the same picture in other pixels
    image.to_uint8()             as a screen wants it
    image.save("picture.png")    the recipe travels in the file
    Image.open("picture.png")    decoded to light

Light stays linear here; the curve of the screen is applied where the picture leaves (`limner.color.transfer`).
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ..color.transfer import bytes_from_linear, bytes_from_unit
from ..color.views import VIEWS, screen_light
from ..errors import SceneError, UnsupportedError

__all__ = ["DEPTHS", "VIEWS", "Image", "straight"]

_INVISIBLE = 1e-4  # an alpha below which a colour would be a filter's ringing divided by nearly nothing
DEPTHS = ("blender", "open3d", "pyrender", "pyvista")


@dataclass(frozen=True, eq=False)
class Image:
    """A finished picture, or one that was stopped on the way.

    Parameters
    ----------
    pixels : (height, width, 4) float32
        Linear Rec. 709 and straight alpha; row 0 on top. Held read-only.
    aov : dict of str to (height, width) or (height, width, channels) array
        What lies beside the picture: depth, normal, instance_id, …
    id_names : dict of str to tuple of str
        For every id among the AOVs, the name of each number.
    recipe : dict
        How to make the same picture again; plain values that JSON can hold.
    warnings : tuple of str
        Likely slips that were met while rendering.
    finished : bool
        False: stopped by the user; what is there is sound but not all.
    dpi : float, optional
        Pixels per inch on paper.

    >>> image = Image(np.full((2, 3, 4), 0.5, dtype=np.float32))
    >>> image.width, image.height, image.at(0, 0).tolist(), image.to_uint8()[0, 0].tolist()
    (3, 2, [0.5, 0.5, 0.5, 0.5], [188, 188, 188, 128])
    """

    pixels: NDArray[np.float32]
    aov: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    id_names: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    recipe: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    finished: bool = True
    dpi: float | None = None

    def __post_init__(self) -> None:
        pixels = np.ascontiguousarray(self.pixels)
        if pixels.dtype != np.float32 or pixels.ndim != 3 or pixels.shape[2] != 4 or 0 in pixels.shape:
            raise SceneError(f"image.pixels must be (height, width, 4) float32, got {pixels.shape} {pixels.dtype}")
        object.__setattr__(self, "pixels", _frozen(pixels))
        aov = {name: _frozen(np.asarray(values)) for name, values in self.aov.items()}
        for name, values in aov.items():
            if values.shape[:2] != pixels.shape[:2]:
                size = f"{pixels.shape[:2]}, got {values.shape[:2]}"
                raise SceneError(f"image.aov[{name!r}] must be as large as the picture, {size}")
        object.__setattr__(self, "aov", aov)
        if self.dpi is not None:
            from .hardcopy import checked_dpi

            object.__setattr__(self, "dpi", checked_dpi(self.dpi, "image.dpi"))

    @property
    def width(self) -> int:
        """Columns."""
        return int(self.pixels.shape[1])

    @property
    def height(self) -> int:
        """Rows."""
        return int(self.pixels.shape[0])

    def at(self, i: int, j: int) -> NDArray[np.float32]:
        """(4,) float32: the pixel in column `i` and row `j` counted from the bottom, both from 0, as the book counts."""
        if not (0 <= i < self.width and 0 <= j < self.height):
            raise SceneError(f"pixel ({i}, {j}) lies outside the picture of {self.width} x {self.height}")
        pixel: NDArray[np.float32] = self.pixels[self.height - 1 - j, i]
        return pixel

    def sample(self, x: ArrayLike, y: ArrayLike, filter: str = "mitchell") -> NDArray[np.float32]:
        """The picture between its pixels: as the function I(x, y) that the raster stands for.

        Parameters
        ----------
        x, y : (...) float
            Column, and row from the *top*; pixel centres are at integers, so that the picture covers [-0.5, width - 0.5] x
            [-0.5, height - 0.5]. The book's (i, j) is ``x = i``, ``y = height - 1 - j``. Beyond its edges the picture goes on with its
            outermost pixels.
        filter : "box" | "tent" | "gaussian" | "mitchell" | "lanczos3"
            How it is reconstructed (`limner.image.reconstruct`). Box, tent and lanczos3 go through the pixels.

        Returns
        -------
        (..., 4) float32
            Linear, straight alpha; filtered with the colour weighted by alpha, so that what is transparent has no colour.

        >>> ramp = np.zeros((1, 3, 4), dtype=np.float32)
        >>> ramp[0, :, :] = [[0.0], [1.0], [2.0]]
        >>> ramp[..., 3] = 1.0
        >>> Image(ramp).sample([0.25, 1.5, 7.0], 0.0, filter="tent")[:, 0].tolist()
        [0.25, 1.5, 2.0]

        **Source**: FoCG 3.2 and 9.3.
        """
        from .reconstruct import reconstruction, sampled

        kind = reconstruction(filter)
        places = np.broadcast_arrays(np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64))
        if not all(np.isfinite(place).all() for place in places):
            raise SceneError("x and y must be finite")
        shape = places[0].shape
        alpha = self.pixels[..., 3:]
        opaque = bool((alpha == 1.0).all())
        weighted = self.pixels if opaque else np.concatenate([self.pixels[..., :3] * alpha, alpha], axis=2)
        made = sampled(weighted, places[0].reshape(-1), places[1].reshape(-1), kind)
        return (made if opaque else straight(made)).reshape(*shape, 4)

    def resized(self, width: int, height: int, filter: str = "mitchell") -> Image:
        """The same picture in `width` x `height` pixels; what is beside it (AOVs), which must not be mixed, is left out.

        See `limner.image.resize.resized`. Where there are dots per inch they change with the width: the print stays as wide.
        """
        from .resize import resized

        made = resized(self.pixels, width, height, filter)
        dpi = None if self.dpi is None else self.dpi * width / self.width
        return Image(made, recipe=self.recipe, warnings=self.warnings, finished=self.finished, dpi=dpi)

    def halftoned(self, dpi: float, lines_per_inch: float = 75.0, angle_degrees: float = 45.0, shape: str = "round") -> Image:
        """The picture as a printer's dots, one for each pixel: black ink on white paper.

        Save it with ``bits=1``. See `limner.image.hardcopy.halftoned`; resize first to what the paper takes at `dpi`.
        """
        from .formats import luminance_over_white
        from .hardcopy import halftoned

        paper = halftoned(luminance_over_white(self), dpi, lines_per_inch, angle_degrees, shape)
        pixels = np.ones((*paper.shape, 4), dtype=np.float32)
        pixels[..., :3] = paper[..., None]
        return Image(pixels, recipe=self.recipe, warnings=self.warnings, finished=self.finished, dpi=dpi)

    def print_size(self, dpi: float | None = None) -> tuple[float, float]:
        """Width and height on paper in millimetres, at `dpi` pixels per inch; None: the picture's own.

        >>> tuple(round(side) for side in Image(np.ones((3508, 2480, 4), dtype=np.float32)).print_size(300))
        (210, 297)
        """
        from .hardcopy import print_size

        if dpi is None and self.dpi is None:
            raise SceneError("print_size needs the number of pixels per inch: the picture has none of its own")
        return print_size(self.width, self.height, self.dpi if dpi is None else dpi)  # type: ignore[arg-type]

    def to_uint8(self, view: str = "standard", exposure: float = 0.0) -> NDArray[np.uint8]:
        """(height, width, 4) uint8 for a screen: sRGB-encoded colour, straight alpha.

        Parameters
        ----------
        view : str
            How light becomes colour on a screen, of `limner.color.views.VIEWS`: "standard", the sRGB curve alone, with what is brighter
            than 1 cut off; a tone curve before it; or "none", the numbers themselves.
        exposure : float
            Stops by which the light is made brighter first.
        """
        seen = screen_light(self.pixels, view, exposure)
        if view == "none":
            return bytes_from_unit(seen)
        encoded = bytes_from_linear(seen)
        encoded[..., 3] = bytes_from_unit(self.pixels[..., 3])
        return encoded

    def viewed(self, view: str = "standard", exposure: float = 0.0) -> Image:
        """The light that a screen is to emit for this picture, as a picture: what `to_uint8` encodes (`limner.color.views`).

        The views "none" and "standard" change nothing but for the exposure. What lies beside the picture stays.
        """
        seen = screen_light(self.pixels, view, exposure)
        return self if seen is self.pixels else replace(self, pixels=seen)

    def depth_as(self, convention: str) -> NDArray[np.float32]:
        """The channel `depth` as another renderer would have handed it over.

        Parameters
        ----------
        convention : "pyrender" | "open3d" | "blender" | "pyvista"
            All measure along the gaze, in the scene's units. Where nothing is seen, pyrender has 0, Open3D (with
            ``z_in_view_space``) infinity, Blender's Z pass 1e10; PyVista has NaN, and negative depths.

        Returns
        -------
        (height, width) float32

        >>> image = Image(np.zeros((1, 2, 4), dtype=np.float32), aov={"depth": np.array([[2.0, np.inf]], dtype=np.float32)})
        >>> {name: image.depth_as(name).tolist()[0] for name in ("pyrender", "open3d", "blender", "pyvista")}
        {'pyrender': [2.0, 0.0], 'open3d': [2.0, inf], 'blender': [2.0, 10000000000.0], 'pyvista': [-2.0, nan]}

        **Source**: pyrender's `Renderer` (what is at the far plane becomes 0); Open3D, `OffscreenRenderer.render_to_depth_image`;
        PyVista, `Plotter.get_image_depth`.
        """
        if convention not in DEPTHS:
            raise UnsupportedError(f"the convention for depth must be one of {', '.join(DEPTHS)}, got {convention!r}")
        if "depth" not in self.aov:
            raise SceneError('depth_as needs the channel "depth": render with aovs=("depth",)')
        depth = self.aov["depth"]
        sign, nothing = {"blender": (1, 1e10), "open3d": (1, np.inf), "pyrender": (1, 0.0), "pyvista": (-1, np.nan)}[convention]
        return np.where(np.isfinite(depth), sign * depth, nothing).astype(np.float32)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        bits: int | None = None,
        dither: str | None = None,
        dpi: float | None = None,
        seed: int = 0,
        parts: bool = False,
        view: str = "standard",
        exposure: float = 0.0,
        color_space: str = "srgb",
    ) -> None:
        """Write the picture to a file; the extension says as what, "-" is a PNG on standard output.

        Parameters
        ----------
        bits : int, optional
            Of each channel: 1, 8 (the default) or 16 in a PNG, 16 or 32 (the default) in an EXR.
        dither : "ordered" | "blue_noise" | "random" | "floyd_steinberg", optional
            How the error of rounding is spread.
        dpi : float, optional
            Pixels per inch on paper.
        view : str
            How light becomes colour on a screen, of `limner.color.views.VIEWS`; formats that hold light have "standard" only.
        exposure : float
            Stops by which the light is made brighter first.
        color_space : str
            Whose numbers are written: "display_p3", "rec2020", … of `limner.color.spaces.SPACES`. The file says so.

        See `limner.image.save.save` for the rest and for the errors, `limner.image.formats` for what each format keeps.
        """
        from .save import save

        save(self, path, bits=bits, dither=dither, dpi=dpi, seed=seed, parts=parts, view=view, exposure=exposure, color_space=color_space)

    @staticmethod
    def open(path: str | os.PathLike[str]) -> Image:
        """Read a picture file; the same as `limner.open_image`."""
        # A face of the reader above: looked up only when it is asked for, since the picture itself knows no files.
        image: Image = importlib.import_module("..files.open_image", __package__).open_image(path)
        return image

    def _repr_png_(self) -> bytes:
        """The picture as notebooks show it."""
        from .png import png_bytes

        return png_bytes(self.to_uint8())

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """`pixels`, where NumPy is asked for an array."""
        return np.array(self.pixels, dtype=dtype, copy=copy)

    def __repr__(self) -> str:
        beside = f", aov: {', '.join(self.aov)}" if self.aov else ""
        return f"Image({self.width} x {self.height}{beside}{'' if self.finished else ', unfinished'})"


def straight(weighted: NDArray[Any]) -> NDArray[Any]:
    """(..., 4) float, as given: colours that were weighted by alpha, divided by it; black where nothing can be seen."""
    alpha = weighted[..., 3:]
    seen = alpha > _INVISIBLE
    color = np.where(seen, weighted[..., :3], np.float32(0.0)) / np.where(seen, alpha, np.float32(1.0))
    return np.concatenate([color, np.clip(alpha, 0.0, 1.0)], axis=-1)


def _frozen(array: NDArray[Any]) -> NDArray[Any]:
    view = array.view()
    view.flags.writeable = False
    return view
