"""A turntable: the teapot once round, as an animated picture, lit from the camera so that every side is bright.

The extension says the kind of clip: .webp, .gif, .png (animated), .mp4, or a folder of pictures. Lights may stand still in the world, or
turn with the camera (`lights="world"`, "camera"). `limner turntable MODEL` does it from the shell.

    python examples/turntable.py turntable.webp
"""

from __future__ import annotations

import sys

import limner


def main(target: str, small: bool = False) -> None:
    """Write the clip, and tell how much of each picture the pot takes."""
    n, width, height = (4, 48, 36) if small else (36, 320, 240)
    scene = limner.builtin("teapot")
    clip = limner.write_turntable(scene, target, n, fps=15, quality=80, width=width, height=height)
    print(f"{clip.path}: {clip.n_pictures} pictures, {clip.path.stat().st_size // 1024} KiB")

    # Pictures can be had one by one, too: how much of each is the teapot, not its floor?
    turned = limner.turntable(scene, 4, width=width, height=height, aovs=("instance_id",))
    pot = [float((image.aov["instance_id"] == 1).mean()) for image in turned]
    print("the pot takes", ", ".join(f"{share:.0%}" for share in pot), "of the pictures")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "turntable.webp", "--small" in sys.argv)
