"""OpenUSD's cubic curves: the bases and wraps of the schema, as closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pxr", reason="the usd extra is not installed")

from written_usd import stage

from limner.errors import LimnerWarning
from limner.scene.line_set import LineSet

PIECES = {
    "bezier": lambda u: ((1 - u) ** 3, 3 * u * (1 - u) ** 2, 3 * u**2 * (1 - u), u**3),
    "bspline": lambda u: ((1 - u) ** 3 / 6, (3 * u**3 - 6 * u**2 + 4) / 6, (-3 * u**3 + 3 * u**2 + 3 * u + 1) / 6, u**3 / 6),
    "catmullRom": lambda u: (
        (-(u**3) + 2 * u**2 - u) / 2, (3 * u**3 - 5 * u**2 + 2) / 2, (-3 * u**3 + 4 * u**2 + u) / 2, (u**3 - u**2) / 2,
    ),
}  # fmt: skip
"""How much each of a piece's four points counts, from the schema's page."""


def _curves(wrap: str, basis: str, points: str, counts: str, more: str) -> str:
    return f"""def BasisCurves "hair" {{ uniform token type = "cubic"
    uniform token basis = "{basis}"
    uniform token wrap = "{wrap}"
    int[] curveVertexCounts = {counts}
    point3f[] points = {points}
    {more} }}"""


@pytest.mark.parametrize("basis", PIECES)
def test_cubic_curves(tmp_path: Path, basis: str) -> None:
    """Points and widths where the basis has them; a curve of too few points is left out."""
    points = "[(0,0,0), (1,2,0), (2,2,0), (3,0,0), (9,9,9), (8,8,8)]"
    with pytest.warns(LimnerWarning, match="1 curves of too few points are left out"):
        scene = stage(tmp_path, _curves("nonperiodic", basis, points, "[4, 2]", "float[] widths = [1, 2, 2, 1, 1, 1]"))
    hair = scene.shapes()[0][1].geometry
    assert isinstance(hair, LineSet)
    assert hair.ends.tolist() == [[k, k + 1] for k in range(len(hair.positions) - 1)]
    weights = np.array(PIECES[basis](np.linspace(0.0, 1.0, len(hair.positions))))
    np.testing.assert_allclose(hair.positions, weights.T @ [[0, 0, 0], [1, 2, 0], [2, 2, 0], [3, 0, 0]], atol=1e-6)
    np.testing.assert_allclose(hair.radii, weights.T @ [0.5, 1.0, 1.0, 0.5], atol=1e-6)


@pytest.mark.parametrize("basis", ["bspline", "catmullRom"])
def test_curves_that_are_pinned_or_closed(tmp_path: Path, basis: str) -> None:
    """From the first point to the last, in n - 1 pieces, colours of their ends straight between them; or round, without an end."""
    points = "[(0,0,0), (1,2,0), (2,2,0), (3,0,0)]"
    colors = "color3f[] primvars:displayColor = [(0,0,0), (1,0,0), (2,0,0), (3,0,0)] (interpolation = \"varying\")"
    pinned = stage(tmp_path, _curves("pinned", basis, points, "[4]", colors)).shapes()[0][1].geometry
    assert isinstance(pinned, LineSet)
    np.testing.assert_allclose(pinned.positions[[0, -1]], [[0, 0, 0], [3, 0, 0]], atol=1e-6)
    assert pinned.colors is not None
    np.testing.assert_allclose(pinned.colors[:, 0], np.linspace(0.0, 3.0, len(pinned.positions)), atol=1e-6)
    closed = stage(tmp_path, _curves("periodic", basis, points, "[4]", "")).shapes()[0][1].geometry
    assert isinstance(closed, LineSet)
    assert len(closed.ends) == len(closed.positions)
    assert closed.ends[-1].tolist() == [len(closed.positions) - 1, 0]
    # Of four points in a ring the mean of all is the middle of the curve.
    np.testing.assert_allclose(closed.positions.mean(axis=0), [1.5, 1.0, 0.0], atol=1e-6)
