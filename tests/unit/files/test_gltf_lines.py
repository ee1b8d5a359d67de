"""Lines of glTF: modes 1 to 3."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.errors import LimnerWarning
from limner.files.load import load
from limner.scene.line_set import LineSet

PLACES = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [np.nan, 0, 0]])


@pytest.mark.parametrize(
    ("mode", "segments"), [(1, [[0, 1], [2, 3]]), (2, [[0, 1], [1, 2], [2, 3], [3, 0]]), (3, [[0, 1], [1, 2], [2, 3]])]
)
@pytest.mark.parametrize("indices", [None, [0, 1, 2, 3]])
def test_modes(triangle: Any, tmp_path: Path, mode: int, segments: list[list[int]], indices: list[int] | None) -> None:
    """Separate lines, a loop and a strip, with colours; without normals they are shown unlit."""
    made = triangle.primitive(PLACES[:4], indices, mode=mode)
    made["attributes"] |= {"COLOR_0": triangle.accessor(np.abs(PLACES[:4])), "_HEAT": triangle.accessor([1, 2, 3, 4], "u2")}
    made["material"] = len(triangle.document.setdefault("materials", []))
    triangle.document["materials"].append({"name": "wire"})
    scene = load(triangle.save(tmp_path))
    shape = scene.shapes()[1][1]
    lines = shape.geometry
    assert isinstance(lines, LineSet)
    assert lines.ends.tolist() == segments
    assert lines.colors is not None
    assert lines.colors.tolist() == np.abs(PLACES[:4]).tolist()
    assert lines.scalars is not None
    assert lines.scalars["HEAT"].tolist() == [1, 2, 3, 4]
    assert shape.materials[0].unlit  # type: ignore[union-attr]
    assert shape.materials[0].name == "wire"


def test_what_lies_nowhere_is_left_out(triangle: Any, tmp_path: Path) -> None:
    """Segments whose ends do not exist or are not finite are left out, which is said; lit where there are normals."""
    made = triangle.primitive(PLACES, [0, 1, 1, 4, 2, 9, 3], mode=1)
    made["attributes"]["NORMAL"] = triangle.accessor([[0, 0, 1.0]] * 5)
    with pytest.warns(LimnerWarning, match="2 of 3 segments"):
        scene = load(triangle.save(tmp_path))
    shape = scene.shapes()[1][1]
    assert isinstance(shape.geometry, LineSet)
    assert shape.geometry.ends.tolist() == [[0, 1]]
    assert not shape.materials[0].unlit  # type: ignore[union-attr]
    made["indices"] = triangle.accessor([4, 4], "u2")
    with pytest.warns(LimnerWarning, match="1 of 1 segments"):
        assert len(load(triangle.save(tmp_path)).shapes()) == 1
