"""Charts for looking at a screen: its gamma, its steps, its colours (FoCG 3.2.2, 19.2).

gamma_chart().image().save("gamma.png")     look at it at full size, from afar; which grey is as bright as the board around it?
banding_chart()                             the same light in few bits, stored as light and as sRGB
checker_chart()                             24 patches of which everybody knows how they look
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..color.encodings import encoded
from ..color.gamut import fit_to_gamut
from ..color.light import rgb_from_reflectance
from ..color.published import published
from ..color.spectrum import Spectrum
from ..color.transfer import bytes_from_linear, gamma_from_linear, linear_from_srgb
from ..draw.canvas import Canvas
from ..errors import SceneError
from ..image.image import Image
from .plot import FAINT, INK, PAPER, text_size

__all__ = ["banding_chart", "checker_chart", "gamma_chart"]

GAMMAS = (1.4, 1.6, 1.8, 2.0, 2.2, 2.4, 2.6, 2.8)
_BITS = (3, 4, 5, 6)


def _picture(linear: NDArray[np.floating]) -> Image:
    pixels = np.ones((*linear.shape[:2], 4), dtype=np.float32)
    pixels[..., :3] = linear
    return Image(pixels)


def gamma_chart(gammas: Sequence[float] = GAMMAS, *, width: int = 960, height: int = 480) -> Canvas:
    """Draw greys on a checkerboard of single black and white pixels.

    From afar the board is half of the greatest intensity. On a display of gamma g the grey ``0.5^(1/g)`` is as bright: the patch that
    disappears tells g, and `limner.color.transfer.gamma_from_match` makes g of any other grey that does.

    Parameters
    ----------
    gammas : sequence of float > 0
        One patch for each, with its gamma and its code below.
    width, height : int >= 200
        It must be shown pixel by pixel, not scaled.
    """
    if not len(gammas):
        raise SceneError("a gamma chart needs at least one gamma")
    text = text_size(width, height)
    canvas = Canvas(width, height, "#ffffff")
    head, foot = round(3.6 * text), round(4.2 * text)
    tall = max(height - head - foot, 8)
    rows, columns = np.indices((tall, width))
    board = ((rows + columns) % 2).astype(np.float32)
    side = width / len(gammas)
    for k, gamma in enumerate(gammas):
        code = round(255.0 * float(gamma_from_linear(0.5, gamma)))
        left, right = round((k + 0.22) * side), round((k + 0.78) * side)
        board[round(0.25 * tall) : round(0.75 * tall), left:right] = linear_from_srgb(code / 255.0)
        canvas.text(
            (k + 0.5) * side,
            height - foot + 0.6 * text,
            f"{gamma:.1f}" if round(gamma, 1) == gamma else f"{gamma:.3g}",
            INK,
            size=1.1 * text,
            align="center",
            baseline="top",
        )
        canvas.text((k + 0.5) * side, height - foot + 2.1 * text, str(code), FAINT, size=0.85 * text, align="center", baseline="top")
    canvas.paste(_picture(np.repeat(board[..., None], 3, axis=2)), 0, head)
    words = "Pixel by pixel, from afar: which patch disappears? Its number is the gamma of your display"
    canvas.text(width / 2.0, 1.1 * text, words, INK, size=_fitting(canvas, words, 1.1 * text, 0.96 * width), align="center", baseline="top")
    return canvas


def _fitting(canvas: Canvas, words: str, size: float, room: float) -> float:
    """The size of text at which words have room."""
    box = canvas.text_box(0.0, 0.0, words, size=size)
    return size * min(1.0, room / max(box.width, 1e-9))


def banding_chart(bits: Sequence[int] = _BITS, *, width: int = 960, height: int = 640) -> Canvas:
    """Draw a ramp from black to white, even to the eye, in few bits: above each pair stored as light, below it as sRGB.

    Stored as light, the dark has next to no steps of its own and the bright has more than are seen. The curve spends them evenly.
    """
    if not len(bits) or min(bits) < 1 or max(bits) > 8:
        raise SceneError(f"bits must be integers from 1 to 8, got {tuple(bits)}")
    text = text_size(width, height)
    canvas = Canvas(width, height, PAPER)
    canvas.text(width / 2.0, 0.6 * text, "The same light in few bits", INK, size=1.25 * text, align="center", baseline="top")
    left, right, top = round(8.0 * text), width - round(1.4 * text), 3.4 * text
    ramp = np.linspace(0.0, 1.0, right - left)
    step = (height - top - 0.6 * text) / len(bits)
    for row, depth in enumerate(bits):
        steps = float((1 << int(depth)) - 1)
        y = top + row * step
        tall = round(0.4 * step)
        as_light = np.round(linear_from_srgb(ramp) * steps) / steps
        as_srgb = linear_from_srgb(np.round(ramp * steps) / steps)
        for half, (light, words) in enumerate(((as_light, "as light"), (as_srgb, "as sRGB"))):
            stripe = np.broadcast_to(light[None, :, None], (tall, len(ramp), 3))
            canvas.paste(_picture(stripe), left, round(y + half * tall))
            middle = y + (half + 0.5) * tall
            canvas.text(left - 0.6 * text, middle, words, FAINT, size=0.85 * text, align="right", baseline="middle")
        canvas.text(1.2 * text, y + tall, f"{depth} bits", INK, size=text, baseline="middle")
    return canvas


def checker_chart(light: str = "D65", *, width: int = 960, height: int = 680) -> Canvas:
    """Draw the colour checker from its measured reflectances, as an eye sees it that is used to a light, with sRGB codes.

    What sRGB cannot show (cyan) is clipped.
    """
    text = text_size(width, height)
    canvas = Canvas(width, height, "#1d1f22")
    table = published("color_checker")
    gap = 0.9 * text
    wide, tall = (width - 7.0 * gap) / 6.0, (height - 5.0 * gap) / 4.0
    for k, (name, column) in enumerate(zip(table.names, table.values.T, strict=True)):
        color = fit_to_gamut(rgb_from_reflectance(Spectrum(table.wavelengths, column), light))
        x, y = gap + (k % 6) * (wide + gap), gap + (k // 6) * (tall + gap)
        canvas.rectangle(x, y, wide, tall, fill=tuple(color.tolist()), radius=0.35 * text)
        dark = float(encoded(color @ np.array([0.2126, 0.7152, 0.0722]), "srgb")) > 0.6
        words = "#000000e0" if dark else "#ffffffd8"
        canvas.text(x + 0.6 * text, y + tall - 1.9 * text, name, words, size=0.85 * text)
        code = "".join(f"{part:02x}" for part in bytes_from_linear(color.astype(np.float32)).tolist())
        canvas.text(x + 0.6 * text, y + tall - 0.7 * text, f"#{code}", words, size=0.75 * text)
    return canvas
