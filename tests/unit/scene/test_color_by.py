"""Numbers as colours of meshes and clouds, by name or as they are."""

from __future__ import annotations

import numpy as np
import pytest

from limner.color.maps import mapped
from limner.errors import SceneError, UnsupportedError
from limner.mesh.mesh import Mesh
from limner.scene.color_by import color_by
from limner.scene.points import PointCloud

HEAT = np.array([0.0, np.nan, 2.0, 5.0])
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
MESH = Mesh(SQUARE, [[0, 1, 2], [0, 2, 3]], scalars={"heat": HEAT}, name="plate")  # type: ignore[arg-type]
CLOUD = PointCloud(SQUARE, scalars={"heat": HEAT})  # type: ignore[arg-type]


@pytest.mark.parametrize("geometry", [MESH, CLOUD], ids=["mesh", "cloud"])
def test_colours_are_those_of_the_map(geometry: Mesh) -> None:
    """By name and by value the same colours, the map's own; everything else stays."""
    made = color_by(geometry, "heat", "magma", (0.0, 4.0), (0.0, 0.0, 1.0))
    assert made.colors is not None
    assert (made.colors == mapped(HEAT, "magma", (0.0, 4.0), (0.0, 0.0, 1.0))).all()
    assert made.colors[1].tolist() == [0.0, 0.0, 1.0]
    assert (color_by(geometry, HEAT, "magma", (0.0, 4.0), (0.0, 0.0, 1.0)).colors == made.colors).all()
    assert (made.positions is geometry.positions, made.scalars["heat"][3]) == (True, 5.0)  # type: ignore[index]


def test_attributes_of_one_number_count_too() -> None:
    """Vertex attributes that are one number each have names like scalars; vectors do not."""
    mesh = Mesh(SQUARE, [[0, 1, 2]], vertex_attributes={"age": np.arange(4), "flow": np.zeros((4, 3))})  # type: ignore[arg-type]
    colors = color_by(mesh, "age", "grey").colors
    assert colors is not None
    assert colors[3].tolist() == [1.0, 1.0, 1.0]
    with pytest.raises(SceneError, match="there are: age"):
        color_by(mesh, "flow")


def test_what_is_refused() -> None:
    """Unknown names with the known ones, wrong counts, and things without vertices."""
    with pytest.raises(SceneError, match=r"no scalars 'cold'; there are: heat \(plate\)"):
        color_by(MESH, "cold")
    with pytest.raises(SceneError, match="one number for each of 4 positions"):
        color_by(MESH, [1.0, 2.0])
    with pytest.raises(SceneError, match="needs a Mesh, a PointCloud or a LineSet"):
        color_by(SQUARE, HEAT)  # type: ignore[type-var]
    with pytest.raises(UnsupportedError, match="viridis"):
        color_by(MESH, "heat", "rainbow")
    with pytest.raises(SceneError, match=r"mesh\.scalars\['a'\] must have 4 numbers"):
        Mesh(MESH.positions, MESH.triangles, scalars={"a": np.zeros(3)})  # type: ignore[dict-item]
