"""Pictures from cameras (FoCG 3.1.3): held in eight ways, stored as the sensor saw them, and upright again when they are opened.

Above, what lies in the eight files; the number is the EXIF tag that says how the camera was held. Below, what `limner.open_image` makes of
them: the same picture eight times, to the code. 16 bits, in PNG and TIFF, and half floats in EXR come in by the same door.

    python examples/camera_pictures.py camera_pictures.png
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

import limner
from limner.draw.canvas import Canvas

_ORIENTATION = 274  # the EXIF tag
# Where row 0 and column 0 of the stored picture lie, as what was done to the upright one
STORED = {
    1: lambda p: p, 2: lambda p: p[:, ::-1], 3: lambda p: p[::-1, ::-1], 4: lambda p: p[::-1], 5: lambda p: p.swapaxes(0, 1),
    6: lambda p: p.swapaxes(0, 1)[::-1], 7: lambda p: p.swapaxes(0, 1)[::-1, ::-1], 8: lambda p: p.swapaxes(0, 1)[:, ::-1],
}  # fmt: skip


def main(target: str, small: bool = False) -> None:
    """One picture, eight files, and what comes back."""
    width, height = (24, 16) if small else (192, 144)
    picture = limner.render("teapot", width=width, height=height, samples=8)
    sheet = Canvas(4 * width, 4 * width, (0.9, 0.9, 0.88))
    with tempfile.TemporaryDirectory() as folder:
        for orientation, turn in STORED.items():
            path = Path(folder) / f"{orientation}.png"
            exif = Image.Exif()
            exif[_ORIENTATION] = orientation
            Image.fromarray(np.ascontiguousarray(turn(picture.to_uint8()))).save(path, exif=exif)
            opened = limner.open_image(path)
            assert (opened.to_uint8() == picture.to_uint8()).all()
            left, top = (orientation - 1) % 4 * width, (orientation - 1) // 4 * 2 * width
            for k, shown in enumerate((limner.Image(np.ascontiguousarray(turn(picture.pixels))), opened)):
                sheet.paste(shown, left + (width - shown.width) // 2, top + k * width + (width - shown.height) // 2)
            sheet.text(left + 5, top + 15, f"{orientation}", "black", 13).text(left + 5, top + width + 15, "opened", "black", 11)
    sheet.image().save(target)
    print(f"{target}: eight files, one picture")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "camera_pictures.png", "--small" in sys.argv)
