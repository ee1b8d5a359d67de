"""Reading PLY: every way to write the same surface is read as the same, everything beside triangles is kept, lies are refused."""

from __future__ import annotations

import io
import struct
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limner.color.transfer import linear_from_srgb
from limner.errors import FileFormatError, LimnerWarning
from limner.files.limits import Limits
from limner.files.load import load
from limner.files.ply import read
from limner.mesh.mesh import Mesh
from limner.scene.points import PointCloud

CODES = {"uchar": "B", "int": "i", "uint": "I", "float": "f", "double": "d", "ushort": "H", "char": "b"}
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)]
POSITION = (("float", "x"), ("float", "y"), ("float", "z"))
LISTED = (("list uchar int", "vertex_indices"),)


def ply(order: str, *elements: tuple[str, tuple[tuple[str, str], ...], list[Any]], comments: tuple[str, ...] = ()) -> bytes:
    """A PLY file, row by row; `order` is "ascii", "little" or "big"; in a row a list is a tuple."""
    lines = ["ply", f"format {order if order == 'ascii' else f'binary_{order}_endian'} 1.0", *(f"comment {text}" for text in comments)]
    body = io.BytesIO()
    for name, properties, rows in elements:
        lines.append(f"element {name} {len(rows)}")
        lines += [f"property {kind} {what}" for kind, what in properties]
        for row in rows:
            words = []
            for (kind, _), value in zip(properties, row, strict=True):
                kinds = kind.removeprefix("list ").split()
                numbers = [len(value), *value] if kind.startswith("list") else [value]
                codes = CODES[kinds[0]] + CODES[kinds[-1]] * len(value) if kind.startswith("list") else CODES[kind]
                words += [str(number) for number in numbers]
                if order != "ascii":
                    body.write(struct.pack(("<" if order == "little" else ">") + codes, *numbers))
            if order == "ascii":
                body.write((" ".join(words) + "\n").encode())
    return "\n".join([*lines, "end_header", ""]).encode() + body.getvalue()


def geometry(data: bytes, **limits: int) -> Any:
    """What is read."""
    return read(data, "a.ply", limits=Limits(**limits)).shapes()[0][1].geometry


@pytest.mark.parametrize("order", ["ascii", "little", "big"])
def test_triangles_quads_and_polygons(order: str) -> None:
    """Faces of any size, mixed, become triangles in their order, in text and in bytes of either order."""
    faces = [((0, 1, 2),), ((1, 4, 5, 2),), ((0, 2, 3),), ((0, 1, 4, 5, 3),)]
    mesh = geometry(ply(order, ("vertex", POSITION, SQUARE), ("face", LISTED, faces)))
    assert mesh.positions.tolist() == [list(map(float, p)) for p in SQUARE]
    assert mesh.triangles[[0, 3]].tolist() == [[0, 1, 2], [0, 2, 3]]
    corner, *others = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(others[0] - corner, others[1] - corner), axis=1) / 2
    assert np.allclose(area, [0.5, 0.5, 0.5, 0.5, *area[4:]])
    assert np.isclose(area[4:].sum(), 2.0)


@settings(max_examples=25, deadline=None)
@given(
    sizes=st.lists(st.integers(3, 6), min_size=1, max_size=12),
    order=st.sampled_from(["little", "big", "ascii"]),
    count=st.sampled_from(["uchar", "int", "ushort"]),
    extra=st.booleans(),
)
def test_rows_are_found_whatever_their_lengths(sizes: list[int], order: str, count: str, extra: bool) -> None:
    """Faces keep their corners whatever stands around them in a row: of another number of corners, with further properties and lists."""
    n = max(sizes)
    ring = [(np.cos(a), np.sin(a), 0.0) for a in 2 * np.pi * np.arange(n) / n]
    properties: tuple[tuple[str, str], ...] = ((f"list {count} int", "vertex_index"),)
    rows: list[Any] = [(tuple(range(size)),) for size in sizes]
    if extra:
        properties = (("uchar", "flags"), *properties, ("list uchar float", "weights"), ("double", "quality"))
        rows = [(7, *row, (0.5,) * (k % 3), 0.25) for k, row in enumerate(rows)]
    mesh = geometry(ply(order, ("vertex", POSITION, ring), ("face", properties, rows)))
    assert len(mesh.triangles) == sum(size - 2 for size in sizes)
    first = np.cumsum([0, *(size - 2 for size in sizes)])
    for k, size in enumerate(sizes):
        assert set(mesh.triangles[first[k] : first[k + 1]].reshape(-1).tolist()) == set(range(size))


@pytest.mark.parametrize("order", ["ascii", "little"])
def test_what_is_known_of_vertices(order: str) -> None:
    """Normals, colours and texture coordinates have their places; everything else is kept by its name."""
    properties = (
        *POSITION, ("float", "nx"), ("float", "ny"), ("float", "nz"), ("uchar", "red"), ("uchar", "green"), ("uchar", "blue"),
        ("uchar", "alpha"), ("float", "s"), ("float", "t"), ("float", "curvature"), ("int", "label"),
    )  # fmt: skip
    rows = [(*p, 0, 0, 2, 255, 128, 0, 255, 0.25, 0.75, 0.5 * k, k) for k, p in enumerate(SQUARE[:3])]
    mesh = geometry(ply(order, ("vertex", properties, rows), ("face", LISTED, [((0, 1, 2),)])))
    assert mesh.normals.tolist() == [[0.0, 0.0, 1.0]] * 3
    assert np.allclose(mesh.colors, [[1.0, linear_from_srgb(128 / 255), 0.0]] * 3)
    assert mesh.uvs.tolist() == [[0.25, 0.75]] * 3
    assert {name: values.tolist() for name, values in mesh.scalars.items()} == {"curvature": [0.0, 0.5, 1.0], "label": [0.0, 1.0, 2.0]}


def test_colours_and_coordinates_of_faces() -> None:
    """Colours of faces give each its own corners; texture coordinates at corners stay there, through the cutting of a quad, too."""
    properties = (*LISTED, ("list uchar float", "texcoord"), ("uchar", "red"), ("uchar", "green"), ("uchar", "blue"))
    rows = [((0, 1, 2, 3), (0, 0, 1, 0, 1, 1, 0, 1), 255, 0, 0), ((1, 4, 5), (0, 0, 1, 0, 1, 1), 0, 255, 0)]
    mesh = geometry(ply("little", ("vertex", POSITION, SQUARE), ("face", properties, rows)))
    assert (len(mesh.positions), len(mesh.triangles)) == (9, 3)
    assert mesh.colors[mesh.triangles[:, 0]].tolist() == [[1, 0, 0], [1, 0, 0], [0, 1, 0]]
    # On the square the coordinates are the positions.
    assert (mesh.uvs[mesh.uv_triangles][:2] == mesh.positions[mesh.triangles][:2, :, :2]).all()


def test_strips() -> None:
    """Triangle strips, ended by -1, turn every second triangle."""
    data = ply("big", ("vertex", POSITION, SQUARE), ("tristrips", (("list int int", "vertex_indices"),), [((0, 1, 3, 2, -1, 1, 4, 2),)]))
    assert geometry(data).triangles.tolist() == [[0, 1, 3], [1, 2, 3], [1, 4, 2]]


def test_points_are_a_cloud(tmp_path: Path) -> None:
    """Vertices without faces are points; those at infinity are dropped with what is known of them, and that is said."""
    rows = [(*p, float(k), 1.0 + k) for k, p in enumerate(SQUARE)]
    rows[2] = (float("nan"), 0, 0, 9.0, 9.0)
    path = tmp_path / "scan.ply"
    path.write_bytes(ply("ascii", ("vertex", (*POSITION, ("float", "time"), ("float", "radius")), rows)))
    with pytest.warns(LimnerWarning, match="1 of 6 points are not finite"):
        scene = load(path)
    cloud = scene.shapes()[0][1].geometry
    assert isinstance(cloud, PointCloud)
    assert len(cloud.positions) == 5
    assert cloud.scalars is not None
    assert cloud.scalars["time"].tolist() == [0, 1, 3, 4, 5]
    assert cloud.point_radii.tolist() == [1, 2, 4, 5, 6]


def test_coordinates_on_the_earth_keep_their_digits() -> None:
    """What stands at five million metres, in float64, is as fine as what stands at the origin: it is moved, not rounded."""
    offset = np.array([512345.0, 5412345.0, 300.0])
    rows = [tuple((offset + 0.001 * np.array(p)).tolist()) for p in SQUARE]
    data = ply("little", ("vertex", tuple(("double", name) for name in "xyz"), rows), ("face", LISTED, [((0, 1, 2),), ((1, 4, 5),)]))
    ((placed, shape),) = read(data, "a.ply").shapes()
    assert isinstance(shape.geometry, Mesh)
    world = shape.geometry.positions.astype(float) + placed.world_from_object[:3, 3]
    assert np.abs(world - np.array(rows)).max() < 1e-7


def test_up(tmp_path: Path) -> None:
    """With up="z" what was on top of z is on top of y."""
    path = tmp_path / "a.ply"
    path.write_bytes(ply("ascii", ("vertex", POSITION, [(0, 0, 0), (1, 0, 0), (0, 0, 5)]), ("face", LISTED, [((0, 1, 2),)])))
    assert load(path).bounds()[1].tolist() == [1, 0, 5]
    assert load(path, up="z").bounds()[1].tolist() == [1, 5, 0]
    with pytest.raises(Exception, match="up must be one of y, z"):
        load(path, up="x")


GOOD = ply("little", ("vertex", POSITION, SQUARE), ("face", LISTED, [((0, 1, 2),), ((1, 4, 5, 2),)]))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (GOOD.replace(b"element vertex 6", b"element vertex 600"), "is cut off"),
        (GOOD.replace(b"element vertex 6", b"element vertex 40000000000000"), "the limit is"),
        (GOOD.replace(b"element face 2", b"element face 2000000"), "is cut off"),
        (GOOD.replace(b"list uchar int", b"list int int"), "is cut off or broken at row 1"),
        (GOOD[:-3], "is cut off or broken at row 1"),
        (GOOD.replace(b"binary_little", b"binary_middle"), "line 2: this is no line"),
        (GOOD.replace(b"float z", b"float y"), "declared twice"),
        (GOOD.replace(b"float z", b"float w"), "no vertices with x, y and z"),
        (GOOD.replace(b"end_header", b"end_of_it"), "its header has no end"),
        (GOOD.replace(b"format binary_little_endian 1.0\n", b""), "must say a format"),
        (ply("little", ("vertex", POSITION, [])), "no vertices"),
        (ply("ascii", ("vertex", POSITION, SQUARE)).replace(b"2 0 0", b"2 zero 0"), "no number"),
        (ply("ascii", ("vertex", POSITION, SQUARE))[:-9], "is cut off"),
        (ply("ascii", ("vertex", POSITION, [(float("nan"),) * 3])), "none of its points is finite"),
        (ply("ascii", ("vertex", POSITION, SQUARE), ("face", LISTED, [((0, 1, 99),)])), "none of its faces"),
    ],
)
def test_lies_are_refused(data: bytes, message: str) -> None:
    """What promises more than is there, or is no header, is refused in one line that says what and where."""
    with pytest.raises(FileFormatError, match=message) as caught:
        read(data, "a.ply")
    assert str(caught.value).startswith("a.ply")
    assert "\n" not in str(caught.value)


def test_limits() -> None:
    """Vertices and triangles count against the limits, those of polygons before they are cut."""
    with pytest.raises(FileFormatError, match="max_vertices"):
        geometry(GOOD, max_vertices=5)
    with pytest.raises(FileFormatError, match="max_triangles"):
        geometry(GOOD, max_triangles=2)


def test_broken_bytes_never_crash() -> None:
    """Files with bytes changed at random are read or refused, never anything else."""
    rng = np.random.default_rng(0)
    for _ in range(150):
        data = bytearray(GOOD)
        for at in rng.integers(0, len(data), 3):
            data[at] = rng.integers(0, 256)
        with suppress(FileFormatError):
            read(bytes(data), "a.ply")
