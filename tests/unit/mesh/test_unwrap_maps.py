"""The parts of unwrapping by themselves, in double precision: conformal, Tutte's and isometric maps, overlaps, packing of a few texels."""

from __future__ import annotations

import numpy as np
import pytest

from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.mesh.unwrap.conformal import conformal
from limner.mesh.unwrap.gluing import Gluing
from limner.mesh.unwrap.isometric import _value_and_gradient, energies, isometric
from limner.mesh.unwrap.overlap import crossings, overlapping, turned_over
from limner.mesh.unwrap.pieces import Pieces
from limner.mesh.unwrap.surface import Surface
from limner.mesh.unwrap.tutte import tutte
from limner.mesh.unwrap.unwrap import uv_unwrap

pytest.importorskip("scipy")


def sheet(n: int, height: object = None) -> Mesh:
    """A square of n x n vertices, its heights from a function of x and y."""
    side = np.linspace(-1.0, 1.0, n)
    x, y = np.meshgrid(side, side)
    z = np.zeros_like(x) if height is None else height(x, y)  # type: ignore[operator]
    i = np.arange(n * n).reshape(n, n)
    a, b, c, d = i[:-1, :-1], i[:-1, 1:], i[1:, 1:], i[1:, :-1]
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return Mesh(np.stack([x, y, z], -1).reshape(-1, 3).astype(np.float32), triangles.astype(np.int32))


def one_chart(mesh: Mesh) -> Pieces:
    """All of a mesh glued to as few discs as may be."""
    surface = Surface(mesh)
    gluing = Gluing(surface)
    gluing.glue(np.arange(3 * surface.n_triangles), np.zeros(surface.n_triangles, np.int64))
    return Pieces.of(gluing)


def stretches(pieces: Pieces, flat: np.ndarray) -> np.ndarray:
    return np.linalg.svd(np.moveaxis(pieces.jacobians(flat), -1, 0), compute_uv=False)


@pytest.mark.parametrize(
    "mesh", [sheet(5), primitives.cylinder(1.0, 2.0, 24, capped=False), primitives.cone(1.0, 2.0, n=24, capped=False)],
    ids=["square", "cylinder", "cone"],
)  # fmt: skip
def test_conformal_is_isometric_where_that_can_be(mesh: Mesh) -> None:
    """A developable surface in one chart: both stretches are 1, to a millionth; improving changes nothing."""
    pieces = one_chart(mesh)
    assert pieces.n_charts == 1
    flat = conformal(pieces)
    assert stretches(pieces, flat) == pytest.approx(1.0, abs=1e-6)
    assert stretches(pieces, isometric(pieces, flat)) == pytest.approx(1.0, abs=1e-6)
    assert not overlapping(pieces, flat).any()


def test_conformal_keeps_angles() -> None:
    """Of a dome the conformal map has the least loss of angles: s1/s2 comes to 1 as triangles get smaller, like their size squared."""
    worst = []
    for n in (9, 17):
        pieces = one_chart(sheet(n, lambda x, y: 0.5 * np.cos(x) * np.cos(y)))
        s1, s2 = stretches(pieces, conformal(pieces)).T
        worst.append(float((s1 / s2 - 1.0) @ pieces.areas))
    assert worst[1] < 0.6 * worst[0]
    assert worst[1] < 0.04


@pytest.mark.parametrize("uniform", [False, True])
def test_tutte_cannot_fold(uniform: bool) -> None:
    """A crumpled sheet, whose conformal map turns triangles over, lies on a disk without a fold, its rim on the circle."""
    rough = np.random.default_rng(5).normal(size=(9, 9))
    pieces = one_chart(sheet(9, lambda x, y: 1.5 * rough))
    flat = tutte(pieces, uniform)
    assert (pieces.signed_areas(flat) > 0.0).all()
    assert not overlapping(pieces, flat).any()
    radii = np.linalg.norm(flat[pieces.rim_corners], axis=1)
    assert radii == pytest.approx(radii[0])
    assert pieces.signed_areas(flat).sum() == pytest.approx(pieces.chart_areas.sum())


def test_improving_turns_nothing_over_and_finds_the_isometry() -> None:
    """From a disk, far from it, back to the square that it was: the energy falls to its least, 1, and no triangle is turned over."""
    pieces = one_chart(sheet(6))
    start = tutte(pieces)
    flat = isometric(pieces, start, steps=200, tolerance=1e-12)
    assert not turned_over(pieces, flat).any()
    before, after = (energies(pieces.jacobians(x), 1.0).mean() for x in (start, flat))
    assert before > 1.1
    assert after == pytest.approx(1.0, abs=1e-6)
    assert stretches(pieces, flat) == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("weight", [0.0, 0.1, 1.0])
def test_the_gradient_is_the_derivative(weight: float) -> None:
    """By central differences, and the energy is that of `energies`, summed by area."""
    rough = np.random.default_rng(5)
    pieces = one_chart(sheet(4, lambda x, y: 0.3 * rough.normal(size=x.shape)))
    flat = tutte(pieces)
    value, gradient = _value_and_gradient(pieces, flat, weight)
    assert value.sum() == pytest.approx(energies(pieces.jacobians(flat), weight) @ pieces.areas)
    for vertex, axis in ((0, 0), (5, 1), (10, 0)):
        step = np.zeros_like(flat)
        step[vertex, axis] = 1e-6
        above, below = (_value_and_gradient(pieces, flat + sign * step, weight)[0].sum() for sign in (1, -1))
        assert gradient[vertex, axis] == pytest.approx((above - below) / 2e-6, rel=1e-4, abs=1e-6)


def test_charts_do_not_enter_each_other() -> None:
    """Two sheets flattened at once come out as each of them alone, to the rounding of the solver."""
    dome = sheet(5, lambda x, y: 0.4 * np.cos(x) * np.cos(y))
    both = Mesh(np.concatenate([dome.positions, 2 * dome.positions + 9]), np.concatenate([dome.triangles, dome.triangles + 25]))
    pieces = one_chart(both)
    found = stretches(pieces, isometric(pieces, conformal(pieces), tolerance=1e-10, steps=60))
    assert pieces.n_charts == 2
    assert found[: len(dome.triangles)] == pytest.approx(found[len(dome.triangles) :], abs=1e-4)
    part, vertices = pieces.only(np.array([1]))
    assert part.n_charts == 1
    assert part.positions == pytest.approx(pieces.positions[vertices])


def test_a_rim_that_crosses_itself_is_found() -> None:
    """A strip that is wound once and a bit lies over itself; less than once it does not."""
    def wound(turns: float) -> tuple[Pieces, np.ndarray]:
        n = 24
        along = np.linspace(0.0, 1.0, n)
        points = np.stack([np.repeat(along, 2), np.tile([0.0, 0.2], n), np.zeros(2 * n)], axis=1)
        i = 2 * np.arange(n - 1)
        strip = np.concatenate([np.stack([i, i + 2, i + 3], 1), np.stack([i, i + 3, i + 1], 1)])
        pieces = one_chart(Mesh(points.astype(np.float32), strip.astype(np.int32)))
        angle = 2 * np.pi * turns * (pieces.positions[:, 0] - pieces.positions[:, 0].min()) / np.ptp(pieces.positions[:, 0])
        radius = 1.0 - (pieces.positions[:, 1] - pieces.positions[:, 1].min())
        return pieces, np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)

    assert overlapping(*wound(1.1)).all()
    assert (crossings(*wound(1.1)) >= 0).all()
    assert not overlapping(*wound(0.9)).any()
    assert not turned_over(*wound(1.1)).any()


def test_a_cube_on_a_few_texels() -> None:
    """The whole way, from clusters to packing: a cube of one scale in 16 x 16 texels, positions as they were."""
    box = primitives.box()
    made = uv_unwrap(box, resolution=16, margin=1)
    assert made.uvs is not None
    assert made.uv_triangles is not None
    a, b, c = made.uvs[made.uv_triangles].astype(float).transpose(1, 0, 2)
    e, f = b - a, c - a
    areas = 0.5 * (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0])
    assert areas == pytest.approx(areas[0], rel=1e-5)
    assert areas[0] > 0.0
    assert (made.positions == box.positions).all()
