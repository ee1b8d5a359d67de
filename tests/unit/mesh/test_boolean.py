"""Booleans of meshes: volumes of the formulas, inclusion and exclusion, and surfaces that keep what they had."""

from __future__ import annotations

import dataclasses
import math
import sys

import numpy as np
import pytest

from limner.errors import SceneError, UnsupportedError
from limner.mesh.mesh import Mesh
from limner.mesh.reshape.boolean import boolean
from limner.mesh.shapes import primitives


def moved(mesh: Mesh, *offset: float) -> Mesh:
    return dataclasses.replace(mesh, positions=mesh.positions + np.float32(offset))


def volume(mesh: Mesh) -> float:
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    return float(np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6)


def area(mesh: Mesh) -> float:
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    return float(np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum() / 2)


def is_closed(mesh: Mesh) -> bool:
    sides = {(a, b) for t in mesh.triangles.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)}
    return len(sides) == 3 * len(mesh.triangles) and sides == {(b, a) for a, b in sides}


@pytest.fixture
def library() -> None:
    pytest.importorskip("manifold3d", reason="the library manifold3d is not installed")


@pytest.mark.usefixtures("library")
def test_two_balls_have_the_volumes_of_their_lens():
    """|A and B| = pi (4 r + d)(2 r - d)^2 / 12, to the balls' own error; |A or B| + |A and B| = |A| + |B| to rounding."""
    r, d = 1.0, 1.2
    a = primitives.icosphere(r, 4)
    b = moved(a, d, 0.0, 0.0)
    union, both, rest = (boolean(operation, a, b) for operation in ("union", "intersection", "difference"))
    for made in (union, both, rest):
        assert is_closed(made)
        assert len(made.positions) - len(made.triangles) // 2 == 2
    lens = math.pi * (4 * r + d) * (2 * r - d) ** 2 / 12
    assert volume(both) == pytest.approx(lens, rel=6e-3)
    assert volume(union) + volume(both) == pytest.approx(2 * volume(a), rel=1e-6)
    assert volume(rest) + volume(both) == pytest.approx(volume(a), rel=1e-6)
    # The surface of each ball is on the union or on the lens
    assert area(union) + area(both) == pytest.approx(2 * area(a), rel=1e-5)


@pytest.mark.usefixtures("library")
def test_a_hole_has_the_material_the_texture_and_the_normals_of_its_tool():
    """A box without a ball: the cut is the ball's surface seen from inside, its normals exact and turned over."""
    box, ball = primitives.box(2.0), primitives.sphere(1.25, 16)
    made = boolean("difference", box, ball, materials="operand")
    assert is_closed(made)
    assert made.triangle_materials is not None
    assert made.normals is not None
    cut = made.triangle_materials == 1
    p, n = made.positions[made.triangles], made.normals[made.normal_triangles]
    assert np.linalg.norm(p[cut], axis=-1).min() > 1.2
    np.testing.assert_allclose(n[cut], -p[cut] / np.linalg.norm(p[cut], axis=-1, keepdims=True), atol=0.02)
    np.testing.assert_allclose(np.abs(n[~cut]).max(axis=-1), 1.0, atol=1e-6)
    cross = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    assert ((n * cross[:, None]).sum(axis=-1) > 0.0).all()
    # v of the ball's texture is the latitude
    assert made.uvs is not None
    v = made.uvs[made.uv_triangles][cut][..., 1]
    np.testing.assert_allclose(v, 1 - np.arccos(np.clip(p[cut][..., 1] / 1.25, -1, 1)) / np.pi, atol=0.01)


@pytest.mark.usefixtures("library")
def test_materials_of_their_own_and_colours_survive():
    """Two materials on one box, a ball without colours: slots as they were, colours where they were, white elsewhere."""
    box = dataclasses.replace(
        primitives.box(2.0), triangle_materials=np.repeat([5, 3], 6), colors=np.full((8, 3), 0.25, dtype=np.float32), normals=None,
        normal_triangles=None,
    )  # fmt: skip
    made = boolean("union", box, primitives.icosphere(1.2, 2))
    assert set(np.unique(made.triangle_materials)) == {0, 3, 5}
    assert made.colors is not None
    ball = made.triangle_materials == 0
    assert (made.colors[made.triangles[~ball]][..., 3] == 1.0).all()
    np.testing.assert_allclose(made.colors[made.triangles[~ball]][..., :3].min(), 0.25, atol=1e-6)
    assert (np.abs(made.positions[made.triangles[made.triangle_materials == 5]]).max(axis=-1) >= 1.0 - 1e-6).all()


@pytest.mark.usefixtures("library")
def test_nothing_left_coincident_faces_and_triangles_without_neighbours():
    """Disjoint solids share nothing; a solid without itself is nothing; two blocks side by side are one; a soup is welded."""
    box = primitives.box()
    assert len(boolean("intersection", box, moved(box, 5.0, 0.0, 0.0)).triangles) == 0
    assert len(boolean("difference", box, box).triangles) == 0
    pair = boolean("union", box, moved(box, 1.0, 0.0, 0.0))
    assert volume(pair) == pytest.approx(2.0, rel=1e-6)
    assert area(pair) == pytest.approx(10.0, rel=1e-6)
    soup = Mesh(box.positions[box.triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert is_closed(boolean("union", soup))
    empty = Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int))
    assert volume(boolean("union", box, empty)) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.usefixtures("library")
def test_what_is_no_solid_is_refused():
    inside_out = dataclasses.replace(primitives.box(), triangles=primitives.box().triangles[:, ::-1])
    for bad, words in ((primitives.plane(), r"meshes\[1\] must be closed"), (inside_out, r"meshes\[1\] must be turned")):
        with pytest.raises(SceneError, match=words):
            boolean("union", primitives.box(), bad)


@pytest.mark.parametrize(
    ("arguments", "options", "words"),
    [
        (("xor", primitives.box()), {}, "boolean.operation"),
        (("union",), {}, "at least one mesh"),
        (("union", primitives.box()), {"materials": "mine"}, "boolean.materials"),
    ],
)
def test_impossible_calls_are_refused(arguments, options, words):
    with pytest.raises(SceneError, match=words):
        boolean(*arguments, **options)


def test_without_its_library_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    with pytest.raises(UnsupportedError, match=r'pip install "limner\[mesh\]"'):
        boolean("union", primitives.box())
