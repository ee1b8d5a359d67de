"""The teapot turned once round, three times over: lit from the camera, by its own lamps, and with its own lamps turning with the camera.

python examples/turntable.py            writes turntable-auto.webp, turntable-world.webp, turntable-camera.webp and turntable.gif
"""

from __future__ import annotations

from pathlib import Path

import limner
from limner.produce.turntable import turntable, write_turntable

N_PICTURES = 36
SIZE = {"width": 320, "height": 240}


def main(folder: Path = Path()) -> None:
    """Write the clips into `folder`."""
    scene = limner.builtin("teapot")
    for lights in ("world", "camera"):
        clip = write_turntable(scene, folder / f"turntable-{lights}.webp", N_PICTURES, fps=15, quality=85, lights=lights, **SIZE)
        print(f"{clip.path}: {clip.n_pictures} pictures, {clip.path.stat().st_size // 1024} KiB")
    clip = write_turntable(scene, folder / "turntable.gif", N_PICTURES, fps=15, **SIZE)
    print(f"{clip.path}: {clip.path.stat().st_size // 1024} KiB in 255 colours")

    # Pictures can be had one by one, too: how much of each is the teapot, not its floor?
    pot = [float((image.aov["instance_id"] == 1).mean()) for image in turntable(scene, 8, aovs=("instance_id",), **SIZE)]
    print("the pot takes", ", ".join(f"{share:.0%}" for share in pot), "of the pictures")


if __name__ == "__main__":
    main()
