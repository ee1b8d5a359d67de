"""Thumbnails of a folder of models, and one sheet of them all; a file that is broken is told, and stops nothing.

The folder is made here: shapes saved as PLY, OBJ, STL and glTF, and one file that is none of them. `limner thumbnails FOLDER` does the
same.

    python examples/thumbnail_folder.py thumbnails.png
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import limner
from limner.mesh.shapes import primitives
from limner.produce.thumbnails import index_sheet

MODELS = {
    "teapot.glb": primitives.teapot(8),
    "knot.ply": primitives.superquadric(2.0, 2.5, 2.5, 48, 32),
    "ring.obj": primitives.torus(1.0, 0.4),
    "gem.stl": primitives.icosahedron(),
    "spring.ply": primitives.capsule(0.4, 1.0),
    "cube.obj": primitives.box((1.0, 1.0, 1.0)),
    "soccer.stl": primitives.dodecahedron(),
}


def main(target: str, small: bool = False) -> None:
    """Save models, draw them all, lay them out."""
    with tempfile.TemporaryDirectory() as folder:
        models, output = Path(folder) / "models", Path(folder) / "thumbnails"
        models.mkdir()
        for name, mesh in list(MODELS.items())[: 3 if small else None]:
            limner.save_model(mesh, models / name)
        (models / "torn.obj").write_text("f 1 2 3\n", encoding="utf-8")
        batch = limner.thumbnails(models, output, size=48 if small else 200)
        index_sheet(batch).save(target)
        for one in batch.items:
            print(one.source.name, one.status)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "thumbnails.png", "--small" in sys.argv)
