"""Bicubic patches: positions, exact normals, and the limit of the normal where a border shrinks to a point."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limner.curves import bezier, patch
from limner.errors import SceneError


def random_net(seed: int) -> np.ndarray:
    """A bumpy patch over the unit square."""
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(4) / 3, np.arange(4) / 3, [0.0]), axis=-1).reshape(4, 4, 3)
    return grid + rng.uniform(-0.15, 0.15, (4, 4, 3))


@given(st.integers(0, 1000), st.floats(0, 1), st.floats(0, 1))
def test_positions_are_curves_of_curves(seed, u, v):
    """The tensor product is a Bézier curve along v of the points that the rows' curves have at u."""
    net = random_net(seed)
    along_rows = np.array([bezier.de_casteljau(row, u) for row in net])
    np.testing.assert_allclose(patch.positions(net, u, v), bezier.de_casteljau(along_rows, v), atol=1e-13)


@given(st.integers(0, 1000), st.floats(0, 1), st.floats(0, 1))
def test_normals_stand_on_the_surface(seed, u, v):
    """Unit, and at right angles to differences along both parameters."""
    net = random_net(seed)
    n = patch.normals(net, u, v)
    assert np.linalg.norm(n) == pytest.approx(1.0)
    step = 1e-6
    for du, dv in ((step, 0.0), (0.0, step)):
        tangent = patch.positions(net, u + du, v + dv) - patch.positions(net, u - du, v - dv)
        assert abs(n @ tangent) / step < 1e-5


@pytest.mark.parametrize("turned", [False, True], ids=["pole at v = 0", "pole at v = 1"])
@pytest.mark.parametrize("transposed", [False, True], ids=["rows", "columns"])
def test_normal_at_a_pole_is_the_limit(turned, transposed):
    """At a border shrunk to a point the normal is what it tends to from inside the patch, on either side and in either
    direction; a plain cross product would be zero there."""
    rings = [(0.0, 1.0), (0.3, 1.0), (0.8, 0.7), (1.0, 0.0)]
    net = np.array([[(r, 0, h), (r, 0.56 * r, h), (0.56 * r, r, h), (0, r, h)] for r, h in rings])
    pole = 0.0
    if turned:
        net, pole = net[::-1], 1.0
    if transposed:
        net = net.transpose(1, 0, 2)
    inside = abs(pole - 1e-7)
    for s in (0.0, 0.3, 1.0):
        at, near = ((pole, s), (inside, s)) if transposed else ((s, pole), (s, inside))
        n = patch.normals(net, *at)
        np.testing.assert_allclose(n, patch.normals(net, *near), atol=1e-5)
        assert abs(n[2]) == pytest.approx(1.0, abs=1e-12)


def test_normal_of_a_line_is_zero():
    """A patch without area has none, and says so with zero instead of NaN."""
    net = np.zeros((4, 4, 3))
    net[..., 0] = np.arange(4)
    assert (patch.normals(net, [0.0, 0.5], [0.5, 1.0]) == 0.0).all()


def test_tessellation_faces_its_normals_and_covers_the_patch():
    """The triangles of a flat patch have its area, and every winding agrees with the normals."""
    net = np.stack(np.meshgrid(np.arange(4) * 2.0, np.arange(4), [0.0]), axis=-1).reshape(4, 4, 3)
    made = patch.tessellate(net, 5)
    a, b, c = (made.positions[made.triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    assert cross[:, 2].min() > 0.0
    assert cross[:, 2].sum() / 2 == pytest.approx(18.0)
    np.testing.assert_allclose(made.normals, np.broadcast_to([0, 0, 1.0], made.normals.shape), atol=1e-15)
    np.testing.assert_allclose(made.positions[:, :2], made.uvs * (6.0, 3.0), atol=1e-12)


def test_wrong_nets_are_refused():
    with pytest.raises(SceneError, match=r"\(4, 4, 3\)"):
        patch.positions(np.zeros((3, 4, 3)), 0.5, 0.5)
    with pytest.raises(SceneError, match="at least 1"):
        patch.tessellate(np.zeros((4, 4, 3)), 0)
