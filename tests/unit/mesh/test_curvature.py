"""Curvature at vertices: Gauss-Bonnet to rounding, and the smooth surfaces that meshes stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surfaces import fin, heap, klein_bottle, moebius_strip, open_cylinder, plate, platonic_solids, voxels

from limner.mesh.examine.curvature import angle_defects, gaussian_curvature, mean_curvature, mixed_areas, principal_curvatures
from limner.mesh.examine.defects import degenerate_triangles
from limner.mesh.examine.measure import area
from limner.mesh.examine.topology import euler_characteristic
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives

SURFACES = {
    **platonic_solids(), "double torus": plate(2), "cylinder": open_cylinder(), "disk": primitives.disk(), "Moebius": moebius_strip(),
    "Klein": klein_bottle(), "fin": fin(), "voxels": voxels((0, 0, 0), (1, 1, 0), (1, 1, 1)),
}  # fmt: skip


@pytest.mark.parametrize("name", SURFACES)
def test_gauss_bonnet(name):
    """Angle defects, with the turning of the boundary, sum to 2 pi times the Euler characteristic."""
    mesh = SURFACES[name]
    assert angle_defects(mesh).sum() == pytest.approx(2 * math.pi * euler_characteristic(mesh), abs=1e-10)
    assert mixed_areas(mesh).sum() == pytest.approx(area(mesh), rel=1e-12)


@settings(max_examples=30)
@given(st.integers(0, 10_000))
def test_gauss_bonnet_of_heaps(seed):
    """It holds of any triangles that have an area, whatever meets at an edge."""
    mesh = heap(np.random.default_rng(seed), 8, 12)
    mesh = Mesh(mesh.positions, np.delete(mesh.triangles, degenerate_triangles(mesh), axis=0))
    assert angle_defects(mesh).sum() == pytest.approx(2 * math.pi * euler_characteristic(mesh), abs=1e-9)
    assert not np.isinf(gaussian_curvature(mesh)).any()
    assert not np.isinf(mean_curvature(mesh)).any()


def test_sphere():
    """1/r² and 1/r, whatever the radius; turned inside out the mean curvature changes its sign, the Gaussian does not."""
    mesh = primitives.sphere(2.0, 40)
    np.testing.assert_allclose(gaussian_curvature(mesh), 0.25, rtol=2e-3)
    np.testing.assert_allclose(mean_curvature(mesh), 0.5, rtol=1e-3)
    over = Mesh(mesh.positions, mesh.triangles[:, ::-1])
    np.testing.assert_allclose(mean_curvature(over), -mean_curvature(mesh), rtol=1e-9)
    np.testing.assert_allclose(gaussian_curvature(over), gaussian_curvature(mesh), atol=1e-9)
    greatest, least = principal_curvatures(mesh)
    assert (greatest >= least).all()
    np.testing.assert_allclose(greatest, 0.5, rtol=0.05)


def test_torus():
    """Against the torus's own: K = cos v / (r (R + r cos v)), H = (R + 2 r cos v) / (2 r (R + r cos v)); negative inside."""
    big, small = 2.0, 1.0
    u, v = (a.reshape(-1) for a in np.meshgrid(np.arange(96) * 2 * np.pi / 96, np.arange(48) * 2 * np.pi / 48, indexing="ij"))
    ring = big + small * np.cos(v)
    points = np.stack([ring * np.cos(u), small * np.sin(v), -ring * np.sin(u)], axis=1)
    index = np.arange(96 * 48).reshape(96, 48)
    a, b, c, d = (np.roll(index, shift, axis=(0, 1)).reshape(-1) for shift in ((0, 0), (-1, 0), (-1, -1), (0, -1)))
    mesh = Mesh(points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))
    np.testing.assert_allclose(gaussian_curvature(mesh), np.cos(v) / (small * ring), atol=0.01)
    np.testing.assert_allclose(mean_curvature(mesh), (big + 2 * small * np.cos(v)) / (2 * small * ring), atol=0.01)
    greatest, least = principal_curvatures(mesh)
    np.testing.assert_allclose(greatest, 1.0 / small, atol=0.03)
    np.testing.assert_allclose(least, np.cos(v) / ring, atol=0.03)


def test_boundary_and_nothing():
    """A vertex on the rim, at a fin, of no triangle has no curvature; a flat sheet's inside has none, to rounding."""
    disk = primitives.disk()
    curvature = gaussian_curvature(disk)
    assert np.isnan(curvature).sum() == 64
    assert np.nanmax(np.abs(curvature)) < 1e-5
    assert np.isnan(gaussian_curvature(fin())).all()
    lone = Mesh([[0, 0, 0]], np.zeros((0, 3), int))
    assert np.isnan(mean_curvature(lone)).all()
    assert angle_defects(lone).tolist() == [0.0]
