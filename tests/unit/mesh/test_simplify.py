"""Simplification: fewer triangles, the same surface, and what lives on it."""

from __future__ import annotations

import dataclasses
import sys

import numpy as np
import pytest

from limner.errors import SceneError, UnsupportedError
from limner.mesh.mesh import Mesh
from limner.mesh.reshape.simplify import simplify
from limner.mesh.shapes import primitives


def volume(mesh: Mesh) -> float:
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    return float(np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6)


@pytest.fixture
def library() -> None:
    pytest.importorskip("fast_simplification", reason="the library fast-simplification is not installed")


@pytest.mark.usefixtures("library")
def test_a_ball_of_fewer_triangles_is_a_ball():
    """The number asked for, closed, V - E + F = 2, volume to a percent; colours follow the place, materials their halves."""
    ball = primitives.icosphere(1.0, 4)
    halves = (ball.positions[ball.triangles].mean(axis=1)[:, 1] > 0.0).astype(np.int32)
    ball = dataclasses.replace(
        ball,
        colors=ball.positions / 2 + np.float32(0.5),
        triangle_materials=halves,
        scalars={"y": ball.positions[:, 1]},
        vertex_attributes={"place": ball.positions, "whole": np.ones(len(ball.positions), dtype=int)},
        face_attributes={"half": halves == 1},
    )
    made = simplify(ball, 600)
    assert len(made.triangles) == 600
    assert len(made.positions) == 302
    assert volume(made) == pytest.approx(volume(ball), rel=0.02)
    assert made.vertex_attributes is not None
    assert made.scalars is not None
    assert made.face_attributes is not None
    np.testing.assert_allclose(made.vertex_attributes["place"], made.positions, atol=0.12)
    np.testing.assert_allclose(made.colors, made.positions / 2 + 0.5, atol=0.06)
    np.testing.assert_allclose(made.scalars["y"], made.positions[:, 1], atol=0.12)
    np.testing.assert_array_equal(made.vertex_attributes["whole"], 1.0)
    np.testing.assert_array_equal(made.face_attributes["half"], made.triangle_materials == 1)
    y = made.positions[made.triangles].mean(axis=1)[:, 1]
    clear = np.abs(y) > 0.12
    np.testing.assert_array_equal((y > 0.0)[clear], (made.triangle_materials == 1)[clear])
    assert made.normals is not None
    radial = (made.normals[made.normal_triangles] * made.positions[made.triangles]).sum(axis=-1)
    assert np.quantile(radial, 0.02) > 0.95


@pytest.mark.usefixtures("library")
def test_flat_parts_cost_nothing():
    """A finely divided square keeps its area and its plane; a border that is kept stays to the vertex."""
    plane = primitives.plane(2.0, 12)
    few = simplify(plane, share=0.2)
    assert len(few.triangles) <= 60
    np.testing.assert_allclose(few.positions[:, 1], 0.0, atol=1e-6)
    kept = simplify(plane, 100, keep_border=True)
    rim = plane.positions[np.abs(plane.positions[:, [0, 2]]).max(axis=1) == 1.0]
    assert {tuple(p) for p in rim.tolist()} <= {tuple(p) for p in kept.positions.tolist()}
    assert Mesh(plane.positions, plane.triangles).normals is None
    assert simplify(Mesh(plane.positions, plane.triangles), 50).normals is None


@pytest.mark.usefixtures("library")
def test_more_than_there_is_changes_nothing():
    box = primitives.box()
    assert simplify(box, 12) is box
    assert simplify(box, share=1.0) is box


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "one of both"), ({"triangles": 5, "share": 0.5}, "one of both"), ({"triangles": -1}, "simplify.triangles"),
        ({"triangles": 2.5}, "whole number"), ({"share": 1.5}, "simplify.share"), ({"share": float("nan")}, "simplify.share"),
        ({"triangles": 5, "aggressiveness": 11.0}, "aggressiveness"),
    ],
)  # fmt: skip
def test_impossible_numbers_are_refused(options, words):
    with pytest.raises(SceneError, match=words):
        simplify(primitives.box(), **options)


def test_without_its_library_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "fast_simplification", None)
    with pytest.raises(UnsupportedError, match=r'pip install "limner\[mesh\]"'):
        simplify(primitives.box(), 4)
