"""Texture coordinates by projection: the book's formulas, and no triangle with a jump inside."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from limner.errors import SceneError
from limner.mesh.mesh import Mesh
from limner.mesh.projection import project_uvs
from limner.mesh.shapes import primitives

AXES = {"z": (0, 1, 2), "x": (1, 2, 0), "y": (2, 0, 1)}


def _corners(mesh: Mesh) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(m, 3, 3) positions and (m, 3, 2) texture coordinates of the corners."""
    assert mesh.uvs is not None
    assert mesh.uv_triangles is not None
    return mesh.positions[mesh.triangles], mesh.uvs[mesh.uv_triangles]


def _signed_area(uv: NDArray[np.float32]) -> NDArray[np.float32]:
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("mesh", [primitives.sphere(2.0, 12), primitives.torus(1.0, 0.3, 24, 12)], ids=["sphere", "torus"])
def test_a_sphere_is_the_books_formula(mesh: Mesh, axis: str) -> None:
    """u = 1/2 + atan2(y, x) / 2 pi up to whole turns, v = 1 - acos(z / r) / pi, at every corner that is not a pole."""
    p, uv = _corners(project_uvs(mesh, "sphere", axis=axis))  # type: ignore[arg-type]
    x, y, z = (p[..., k].astype(float) for k in AXES[axis])
    off = np.hypot(x, y) > 1e-6
    turns = uv[..., 0] - (0.5 + np.arctan2(y, x) / (2.0 * math.pi))
    assert np.abs(turns - np.round(turns))[off].max() < 1e-6
    np.testing.assert_allclose(uv[..., 1], 1.0 - np.arccos(z / np.sqrt(x * x + y * y + z * z)) / math.pi, atol=1e-6)


@pytest.mark.parametrize("onto", ["sphere", "cylinder"])
def test_no_triangle_spans_the_seam(onto: str) -> None:
    """On a closed sphere all triangles are small on the texture too, poles included, and none is mirrored or begins outside [0, 1]."""
    _, uv = _corners(project_uvs(primitives.sphere(1.0, 16), onto, axis="y"))  # type: ignore[arg-type]
    assert np.ptp(uv[..., 0], axis=1).max() <= 1.0 / 32 + 1e-6
    assert uv[..., 0].min() >= 0.0
    assert uv[..., 0].min(axis=1).max() <= 1.0
    assert (_signed_area(uv) > 0.0).all()


def test_a_pole_takes_the_middle_of_its_triangle() -> None:
    """Corners on the axis have the mean u of the two others."""
    mesh = project_uvs(primitives.sphere(1.0, 8), "sphere", axis="y")
    p, uv = _corners(mesh)
    is_pole = np.hypot(p[..., 0], p[..., 2]) < 1e-6
    touching = is_pole.any(axis=1)
    assert touching.sum() == 32
    others = np.where(is_pole, 0.0, uv[..., 0]).sum(axis=1)[touching] / 2.0
    np.testing.assert_allclose(uv[..., 0][is_pole], others, atol=1e-6)


def test_corners_of_one_position_share_what_is_equal() -> None:
    """Only at the seam, on one side of it or the other, and at the poles do positions have more than one row."""
    mesh = primitives.sphere(1.0, 8)
    made = project_uvs(mesh, "sphere", axis="y")
    assert made.uvs is not None
    assert 7 <= len(made.uvs) - len(mesh.positions) - 2 * 15 <= 2 * 7


def test_a_cylinder_goes_from_bottom_to_top() -> None:
    """v is the share of the height, u that of the turn."""
    p, uv = _corners(project_uvs(primitives.cylinder(0.5, 3.0, 24, capped=False), "cylinder", axis="y"))
    np.testing.assert_allclose(uv[..., 1], (p[..., 1] + 1.5) / 3.0, atol=1e-6)
    turns = uv[..., 0] - (0.5 + np.arctan2(p[..., 0], p[..., 2]) / (2.0 * math.pi))
    assert np.abs(turns - np.round(turns)).max() < 1e-6


def test_a_plane_is_undistorted() -> None:
    """The longest side of the bounds is 1, whatever the center; `size` sets another scale."""
    mesh = Mesh([[1, 1, 0], [5, 1, 0], [5, 3, 7], [1, 3, 7]], [[0, 1, 2], [0, 2, 3]])
    _, uv = _corners(project_uvs(mesh, "plane", center=None, size=4.0))
    np.testing.assert_allclose(uv[0], [[0.0, 0.25], [1.0, 0.25], [1.0, 0.75]], atol=1e-6)
    _, small = _corners(project_uvs(mesh, "plane"))
    np.testing.assert_allclose(small[0], [[0.5 + 1 / 7, 0.5 + 1 / 7], [0.5 + 5 / 7, 0.5 + 1 / 7], [0.5 + 5 / 7, 0.5 + 3 / 7]], atol=1e-6)


@pytest.mark.parametrize("axis", AXES)
def test_a_box_shows_the_texture_on_each_side(axis: str) -> None:
    """Each side of a cube has the whole texture, upright and not mirrored: v grows along the axis on the four sides."""
    cube = primitives.box((2.0, 2.0, 2.0))
    p, uv = _corners(project_uvs(cube, "box", axis=axis))  # type: ignore[arg-type]
    np.testing.assert_allclose(_signed_area(uv), np.ones(12), atol=1e-6)
    assert set(np.unique(uv)) == {0.0, 1.0}
    up = "xyz".index(axis)
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    is_side = normal[:, up] == 0.0
    np.testing.assert_allclose(uv[is_side][..., 1], 0.5 + p[is_side][..., up] / 2.0, atol=1e-6)


def test_what_has_no_area_has_numbers_all_the_same() -> None:
    """No NaN for triangles without area, a point in the center, or no triangles at all."""
    mesh = Mesh([[0, 0, 0], [0, 0, 0], [1, 0, 0]], [[0, 1, 2], [0, 0, 0]])
    for onto in ("sphere", "cylinder", "plane", "box"):
        made = project_uvs(mesh, onto)  # type: ignore[arg-type]
        assert made.uvs is not None
        assert np.isfinite(made.uvs).all()
        assert project_uvs(Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int)), onto).uvs is not None  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("onto", "options", "said"),
    [
        ("cube", {}, "projection must be one of sphere, cylinder, plane, box, got 'cube'"),
        ("box", {"axis": "w"}, "axis must be one of x, y, z, got 'w'"),
        ("box", {"size": 0.0}, "size must be positive, got 0.0"),
        ("plane", {"center": (1.0, 2.0)}, "center must be three finite numbers"),
    ],
)
def test_wrong_words_are_told(onto: str, options: dict[str, object], said: str) -> None:
    """One line says what was expected."""
    with pytest.raises(SceneError, match=said.replace("(", r"\(")):
        project_uvs(primitives.box((1.0, 1.0, 1.0)), onto, **options)  # type: ignore[arg-type]
