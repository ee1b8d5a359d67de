"""A scene in words: `scene_file.yaml` beside this script, with how its picture is made, and the same scene written again by limner.

    python examples/scene_file.py scene_file.png

    limner render examples/scene_file.yaml -o scene_file.png
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import limner
from limner.files.scene_file import save_scene, settings_of
from limner.scene.digest import scene_digest


def main(target: str, small: bool = False) -> None:
    """Read it, make its picture, write it, and read that."""
    source = Path(__file__).with_name("scene_file.yaml")
    scene, settings = limner.load(source), settings_of(source)
    smaller = {"width": 96, "height": 64, "samples": 1} if small else {}
    limner.render(scene, **{**settings, **smaller}).save(target)
    with tempfile.TemporaryDirectory() as folder:
        again = Path(folder) / "again.yaml"
        save_scene(scene, again, settings=settings)
        same = scene_digest(limner.load(again)) == scene_digest(scene)
        n_lines = len(again.read_text(encoding="utf-8").splitlines())
    n_written = len(source.read_text(encoding="utf-8").splitlines())
    found = "the same" if same else "another"
    print(f"{target}: {len(scene.shapes())} shapes from {n_written} lines; written again in {n_lines}, {found} scene")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "scene_file.png", "--small" in sys.argv)
