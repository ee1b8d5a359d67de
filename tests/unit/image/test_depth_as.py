"""`Image.depth_as`: the same depths as others hand them over."""

from __future__ import annotations

import numpy as np
import pytest

from limner.errors import SceneError, UnsupportedError
from limner.image.image import DEPTHS, Image

DEPTH = np.array([[1.5, np.inf], [np.inf, 250.0]], dtype=np.float32)


def _image(**aov: np.ndarray) -> Image:
    return Image(np.zeros((2, 2, 4), dtype=np.float32), aov=aov)


@pytest.mark.parametrize(
    ("convention", "seen", "nothing"), [("pyrender", 1.5, 0.0), ("open3d", 1.5, np.inf), ("blender", 1.5, 1e10), ("pyvista", -1.5, np.nan)]
)  # fmt: skip
def test_each_convention(convention: str, seen: float, nothing: float) -> None:
    """What is seen keeps its depth, or its negative; what is not becomes what the other has there; float32."""
    depth = _image(depth=DEPTH).depth_as(convention)
    assert (depth.dtype, depth.shape) == (np.float32, (2, 2))
    np.testing.assert_array_equal(depth, np.float32([[seen, nothing], [nothing, 250.0 * np.sign(seen)]]))


def test_every_convention_is_tested() -> None:
    """The list in the module is the list here."""
    assert set(DEPTHS) == {"pyrender", "open3d", "blender", "pyvista"}


def test_slips_are_told() -> None:
    """An unknown convention; no depth to convert."""
    with pytest.raises(UnsupportedError, match="blender, open3d, pyrender, pyvista, got 'vtk'"):
        _image(depth=DEPTH).depth_as("vtk")
    with pytest.raises(SceneError, match='aovs=\\("depth",\\)'):
        _image().depth_as("open3d")
