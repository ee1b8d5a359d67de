"""Texture coordinates for any surface: what `uv_unwrap` promises, on surfaces that are easy, closed, bored through, broken or not there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from staging import SLOW_AS_PYTHON

from limner.errors import SceneError, UnsupportedError
from limner.mesh.mesh import Mesh
from limner.mesh.shapes import primitives
from limner.mesh.unwrap.distortion import UnwrapReport, rim_edges, unwrap_report, uv_charts, uv_distortion
from limner.mesh.unwrap.gluing import Gluing
from limner.mesh.unwrap.surface import Surface
from limner.mesh.unwrap.unwrap import METHODS, charts_of, uv_unwrap

pytest.importorskip("scipy")
pytestmark = SLOW_AS_PYTHON  # packing and the search for overlaps look at every texel; test_unwrap_maps.py runs as Python, too

MODELS = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "meshes"
TETRAHEDRON = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]
GOLDEN = (1.0 + 5.0**0.5) / 2.0


def mesh_of(positions: object, triangles: object) -> Mesh:
    return Mesh(np.array(positions, np.float32).reshape(-1, 3), np.array(triangles, np.int32).reshape(-1, 3))


def convex(points: object) -> Mesh:
    """The hull of points around the origin, its triangles outwards."""
    from scipy.spatial import ConvexHull

    p = np.array(points, dtype=float)
    corners = ConvexHull(p, qhull_options="Qt").simplices
    first, second = p[corners[:, 1]] - p[corners[:, 0]], p[corners[:, 2]] - p[corners[:, 0]]
    inwards = np.einsum("ij,ij->i", np.cross(first, second), p[corners].mean(axis=1)) < 0.0
    corners[inwards] = corners[inwards][:, ::-1]
    return mesh_of(p, corners)


def platonic() -> dict[str, Mesh]:
    signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    golden = [(0, a, b * GOLDEN) for a in (-1, 1) for b in (-1, 1)]
    turned = [np.roll(point, k) for point in golden for k in range(3)]
    dual = [np.roll((0, a / GOLDEN, b * GOLDEN), k) for a in (-1, 1) for b in (-1, 1) for k in range(3)]
    return {
        "tetrahedron": mesh_of([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]], TETRAHEDRON),
        "cube": convex(signs),
        "octahedron": convex(np.concatenate([np.eye(3), -np.eye(3)])),
        "dodecahedron": convex([*signs, *dual]),
        "icosahedron": convex(turned),
    }


def band(n: int, half_turns: int) -> Mesh:
    """A closed band of n quadrilaterals: a ring, or with one half turn Möbius' strip."""
    a = 2 * np.pi * np.arange(n) / n
    half = half_turns * a / 2
    rims = [((1 + s * np.cos(half)) * np.cos(a), s * np.sin(half), (1 + s * np.cos(half)) * np.sin(a)) for s in (-0.3, 0.3)]
    points = np.stack([np.stack(rim, axis=1) for rim in rims], axis=1)
    i, j = 2 * np.arange(n), 2 * ((np.arange(n) + 1) % n)
    flip = (np.arange(n) == n - 1) & (half_turns % 2 == 1)
    low, high = np.where(flip, j + 1, j), np.where(flip, j, j + 1)
    return mesh_of(points, np.concatenate([np.stack([i, i + 1, low], 1), np.stack([i + 1, high, low], 1)]))


def one_to_one(mesh: Mesh) -> UnwrapReport:
    """Check all that is promised whatever the surface is; the report is returned."""
    assert mesh.uvs is not None
    assert mesh.uv_triangles is not None
    assert mesh.uvs.min(initial=0.0) >= 0.0
    assert mesh.uvs.max(initial=0.0) <= 1.0
    report = unwrap_report(mesh)
    assert (report.n_flipped, report.n_mirrored, report.n_collapsed, report.overlap) == (0, 0, 0, 0.0)
    return report


def assert_discs(mesh: Mesh, charts: np.ndarray, corners: np.ndarray) -> None:
    """V − E + F = 1 for each chart, and each is connected by its construction."""
    for chart in range(charts.max() + 1):
        of = corners[charts == chart]
        edges = np.sort(np.stack([of, np.roll(of, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
        assert len(np.unique(of)) - len(np.unique(edges, axis=0)) + len(of) == 1


@pytest.mark.parametrize("name", ["tetrahedron", "cube", "octahedron", "dodecahedron", "icosahedron"])
def test_platonic_solids_unfold_without_distortion(name: str) -> None:
    """All of them have nets: one chart or a few, and every triangle as it is, to the rounding of float32."""
    report = one_to_one(uv_unwrap(platonic()[name], resolution=128))
    assert report.n_charts <= 3
    assert report.conformal_max == pytest.approx(1.0, abs=3e-6)
    assert report.area_max == pytest.approx(1.0, abs=3e-6)
    assert report.stretch_l2 == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("mesh", "most_charts"),
    [
        (primitives.box((1.0, 2.0, 3.0)), 3),
        (primitives.cylinder(1.0, 2.0, 12), 3),
        (primitives.cylinder(1.0, 2.0, 12, capped=False), 2),
        (primitives.cone(1.0, 2.0, n=12, capped=False), 2),
        (primitives.disk(1.0, 12), 1),
        (band(8, 0), 4),
    ],
    ids=["box", "cylinder", "open cylinder", "cone", "disk", "ring"],
)
def test_developable_surfaces_keep_their_lengths(mesh: Mesh, most_charts: int) -> None:
    """What can be laid flat isometrically is, by few charts: lengths are kept to one part in a million, but for float32."""
    report = one_to_one(uv_unwrap(mesh, resolution=128))
    assert report.n_charts <= most_charts
    assert report.conformal_mean == pytest.approx(1.0, abs=1e-6)
    assert report.area_mean == pytest.approx(1.0, abs=1e-6)
    assert report.conformal_max == pytest.approx(1.0, abs=5e-6)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("shape", ["sphere", "torus"])
def test_closed_surfaces_are_cut_into_discs(shape: str, method: str) -> None:
    """A sphere and a surface of genus 1: every chart a disc, one to one, and not very distorted (where that was asked for)."""
    mesh = primitives.sphere(1.0, 6) if shape == "sphere" else primitives.torus(1.0, 0.4, 12, 8)
    made = uv_unwrap(mesh, method=method, resolution=128)
    report = one_to_one(made)
    assert made.uv_triangles is not None
    assert_discs(made, uv_charts(made), made.uv_triangles)
    assert report.n_charts >= 2
    if method != "tutte":
        assert report.conformal_mean < 1.12
        assert report.area_mean < 1.25


def test_angles_or_areas() -> None:
    """On the same charts, the conformal map keeps angles better than the isometric one, and that areas better; balanced lies between."""
    mesh = primitives.sphere(1.0, 8)
    found = {method: unwrap_report(uv_unwrap(mesh, method=method, distortion=0.3, resolution=128)) for method in METHODS[:3]}
    assert len({report.n_charts for report in found.values()}) == 1
    assert found["balanced"].conformal_mean < found["isometric"].conformal_mean
    assert found["isometric"].area_mean < found["balanced"].area_mean < found["conformal"].area_mean


def test_less_distortion_takes_more_charts() -> None:
    """The one bound that steers the cutting does."""
    coarse, fine = (one_to_one(uv_unwrap(primitives.sphere(1.0, 8), distortion=d, resolution=128)) for d in (0.3, 0.02))
    assert coarse.n_charts < fine.n_charts
    assert coarse.area_mean > fine.area_mean


@pytest.mark.parametrize(
    "mesh",
    [
        band(12, 1),
        mesh_of([[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1]], [[0, 1, 2], [0, 1, 3], [0, 1, 4]]),
        mesh_of(np.random.default_rng(1).normal(size=(12, 3)), np.random.default_rng(2).integers(0, 12, (24, 3))),
        mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 2], [0, 2, 1]]),
        mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 1]]),
        mesh_of([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 3]]),
        mesh_of([[1, 1, 1]] * 3, [[0, 1, 2]]),
        mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]], [[0, 1, 2], [0, 0, 1], [3, 3, 3]]),
        mesh_of(1e-9 * primitives.sphere(1.0, 3).positions, primitives.sphere(1.0, 3).triangles),
        mesh_of(1e12 * primitives.sphere(1.0, 3).positions, primitives.sphere(1.0, 3).triangles),
    ],
    ids=["moebius", "three on an edge", "soup", "one triangle thrice", "pillow", "no area", "a point", "two corners", "tiny", "huge"],
)
def test_nothing_breaks_it(mesh: Mesh) -> None:
    """Not orientable, not manifold, folded onto itself, without area, tiny, huge: one to one all the same."""
    one_to_one(uv_unwrap(mesh, resolution=128))


@pytest.mark.parametrize("n_positions", [0, 5])
def test_nothing_to_unwrap(n_positions: int) -> None:
    """No triangles are no error, and are reported as perfectly flat."""
    made = uv_unwrap(mesh_of(np.zeros((n_positions, 3)), []))
    assert made.uvs is not None
    assert made.uvs.shape == (0, 2)
    assert len(made.positions) == n_positions
    assert str(unwrap_report(made)).startswith("triangles     0, 0 flipped")


def test_parts_and_what_no_triangle_uses() -> None:
    """Two boxes and a stray position: all stays where it was, and each part has charts of its own at the same scale."""
    box = primitives.box((1.0, 2.0, 1.0))
    points = np.concatenate([[[9.0, 9.0, 9.0]], box.positions, 2.0 * box.positions + 5.0])
    mesh = mesh_of(points, np.concatenate([box.triangles + 1, box.triangles + 9]))
    made = uv_unwrap(mesh, resolution=128)
    assert (made.positions == mesh.positions).all()
    assert (made.triangles == mesh.triangles).all()
    assert one_to_one(made).area_max == pytest.approx(1.0, abs=1e-5)
    charts = uv_charts(made)
    assert not set(charts[:12]) & set(charts[12:])


def test_split_positions_are_joined() -> None:
    """A file that names three positions for every triangle gets the charts of the same surface whose triangles share them."""
    box = primitives.box()
    soup = mesh_of(box.positions[box.triangles], np.arange(36))
    shared, split = (unwrap_report(uv_unwrap(mesh, resolution=64)) for mesh in (box, soup))
    assert (shared.n_charts, shared.seam_length) == (split.n_charts, pytest.approx(split.seam_length))
    assert len(uv_unwrap(soup, resolution=64).positions) == 36


def test_what_belongs_to_the_mesh_stays() -> None:
    """Normals, colours and materials are kept; tangents and the second coordinates belonged to the old first and go."""
    mesh = replace(primitives.sphere(1.0, 3), triangle_materials=np.zeros(24, np.int32), name="ball")
    mesh = replace(mesh, triangle_materials=np.arange(len(mesh.triangles), dtype=np.int32) % 2)
    assert mesh.normals is not None
    mesh = replace(mesh, tangents=np.tile(np.float32([1, 0, 0, 1]), (len(mesh.normals), 1)), uvs1=mesh.uvs)
    made = uv_unwrap(mesh, resolution=64)
    assert made.name == "ball"
    assert made.normals is mesh.normals
    assert made.triangle_materials is not None
    assert (made.triangle_materials == mesh.triangle_materials).all()
    assert made.uvs1 is None
    assert made.tangents is None


@pytest.mark.parametrize("margin", [0, 3])
def test_texels_between_charts(margin: int) -> None:
    """No texel within `margin` of one that a chart touches is touched by another; nothing touches the border's texels."""
    resolution = 96
    made = uv_unwrap(primitives.cylinder(1.0, 2.0, 10), resolution=resolution, margin=margin)
    assert made.uvs is not None
    assert made.uv_triangles is not None
    charts = uv_charts(made)
    assert charts.max() >= 1
    owner = np.full((resolution, resolution), -1)
    steps = np.linspace(0.0, 1.0, 60)
    u, v = (grid.reshape(-1) for grid in np.meshgrid(steps, steps))
    inside = np.stack([1 - u, u * (1 - v), u * v], axis=1)
    for chart, corners in zip(charts, made.uvs[made.uv_triangles].astype(float), strict=True):
        column, row = np.clip(inside @ corners * resolution, 0, resolution - 1).astype(int).T
        assert set(owner[row, column]) <= {-1, chart}
        owner[row, column] = chart
    border = (margin + 1) // 2
    assert (owner[:border] == -1).all()
    assert (owner[:, :border] == -1).all()
    for dy in range(-margin, margin + 1):
        for dx in range(margin + 1):
            a = owner[max(dy, 0) : resolution + min(dy, 0), dx:]
            b = owner[max(-dy, 0) : resolution + min(-dy, 0), : resolution - dx]
            assert ((a == b) | (a < 0) | (b < 0)).all()


def test_the_same_again() -> None:
    """Nothing is left to chance."""
    mesh = primitives.torus(1.0, 0.4, 10, 6)
    first, second = uv_unwrap(mesh, resolution=64), uv_unwrap(mesh, resolution=64)
    assert first.uvs is not None
    assert second.uvs is not None
    assert first.uvs.tobytes() == second.uvs.tobytes()


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"method": "magic"}, UnsupportedError, "method must be one of balanced, isometric, conformal, tutte, got 'magic'"),
        ({"distortion": 0.0}, SceneError, "distortion must be positive and finite, got 0.0"),
        ({"resolution": 1.5}, SceneError, "resolution must be an integer from 16 to 16384"),
        ({"resolution": 8}, SceneError, "resolution must be an integer from 16 to 16384, got 8"),
        ({"margin": -1}, SceneError, "margin must be an integer >= 0, got -1"),
        ({"resolution": 16, "margin": 7}, SceneError, "do not fit into 16 x 16 texels with a margin of 7"),
    ],
)
def test_what_cannot_be(options: dict[str, object], error: type[Exception], words: str) -> None:
    """A bad call is told in one line."""
    with pytest.raises(error, match=words):
        uv_unwrap(primitives.cylinder(1.0, 1.0, 5), **options)  # type: ignore[arg-type]


def test_without_scipy(monkeypatch: pytest.MonkeyPatch) -> None:
    """The message says what to install."""
    monkeypatch.setitem(__import__("sys").modules, "scipy.sparse", None)
    with pytest.raises(UnsupportedError, match=r'pip install "limner\[mesh\]"'):
        uv_unwrap(primitives.box())


def test_distortion_of_a_known_map() -> None:
    """A unit square stretched by 2 along u and 1/2 along v, and one of its triangles turned over."""
    square = mesh_of([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    stretched = replace(square, uvs=np.float32([[0, 0], [2, 0], [2, 0.5], [0, 0.5]]))
    found = uv_distortion(stretched)
    assert found.stretch == pytest.approx(np.array([[2.0, 0.5]] * 2))
    assert found.conformal == pytest.approx([4.0, 4.0])
    assert found.area == pytest.approx([1.0, 1.0])
    report = unwrap_report(stretched)
    assert report.stretch_l2 == pytest.approx(((4.0 + 0.25) / 2.0) ** 0.5)
    assert report.stretch_max == pytest.approx(2.0)
    assert (report.n_charts, report.seam_length, report.filled) == (1, 0.0, pytest.approx(1.0))
    folded = unwrap_report(replace(square, uvs=np.float32([[0, 0], [1, 0], [1, 1], [1, 0]])))
    assert folded.n_flipped == 1
    assert folded.overlap > 0.0
    with pytest.raises(SceneError, match="no texture coordinates"):
        unwrap_report(square)


def test_seams_are_counted_once() -> None:
    """A box whose six faces are charts has twelve seams of length 1, and an area of 6; each has two sides on the charts' rims."""
    report = unwrap_report(primitives.box())
    assert report.n_charts == 6
    assert report.seam_length == pytest.approx(12.0 / 6.0**0.5)
    assert rim_edges(primitives.box()).shape == (24, 2, 2)
    assert report.overlap == 1.0
    assert report.document()["filled"] == pytest.approx(6.0)


def test_charts_follow_creases() -> None:
    """Where a cube must be cut, it is cut along its edges: no diagonal of a face is a seam."""
    box = primitives.box()
    surface = Surface(box)
    glued = charts_of(surface).glued
    flat = (surface.mates >= 0) & (surface.bends < 0.1)
    assert (glued[flat] == 1).all()
    assert (glued[~flat] == 0).any()


@pytest.mark.parametrize("shape", ["torus", "moebius", "soup"])
def test_whatever_is_glued_is_discs(shape: str) -> None:
    """Gluing all edges in any order never makes anything but discs, on surfaces with handles, one side, or no order at all."""
    random = np.random.default_rng(4)
    soup = mesh_of(random.normal(size=(9, 3)), random.integers(0, 9, (40, 3)))
    mesh = {"torus": primitives.torus(1.0, 0.4, 8, 6), "moebius": band(9, 1), "soup": soup}[shape]
    surface = Surface(mesh)
    for _ in range(3):
        gluing = Gluing(surface)
        gluing.glue(random.permutation(3 * surface.n_triangles), np.zeros(surface.n_triangles, np.int64))
        corners, charts, rims = gluing.corners(), gluing.charts(), gluing.rims()
        assert_discs(mesh, charts, corners)
        assert len(rims.first) - 1 == charts.max() + 1
        assert (np.diff(rims.first) >= 3).all()
        assert len(rims.half_edges) == (gluing.glued == 0).sum()


@pytest.mark.parametrize("name", ["suzanne"])
def test_models(name: str) -> None:
    """Real models keep what is promised, with little distortion and few charts."""
    from limner.files.load import load
    from limner.scene.meshes import meshes_of

    path = MODELS / f"{name}.obj"
    if not path.exists():
        pytest.skip(f"the model {name} is not there")
    for mesh in meshes_of(load(path)).values():
        report = one_to_one(uv_unwrap(mesh, resolution=256))
        assert report.n_charts < 70
        assert report.conformal_mean < 1.08
        assert report.area_mean < 1.12
        assert report.filled > 0.5


def test_the_picture_of_charts() -> None:
    """A square that fills the texture undistorted is white inside, one on its face is not; the key takes room below."""
    from limner.produce.uv_chart import uv_chart

    square = mesh_of([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    flat = replace(square, uvs=np.float32([[0, 0], [1, 0], [1, 1], [0, 1]]))
    codes = uv_chart(flat, size=64, legend=False).image().pixels[8:56, 8:56, :3]
    assert codes.min() > 0.8
    assert flat.uvs is not None
    turned = uv_chart(replace(flat, uvs=flat.uvs[::-1]), size=64, legend=False).image().pixels[8:56, 8:56, 1]
    assert turned.max() < 0.2
    assert uv_chart(flat, size=64).height > 64
    with pytest.raises(UnsupportedError, match="show must be one of conformal, area, stretch, got 'x'"):
        uv_chart(flat, show="x")
    with pytest.raises(SceneError, match="unwrap it first"):
        uv_chart(square)
