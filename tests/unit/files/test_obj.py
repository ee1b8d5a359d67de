"""OBJ as exporters write it, and as they should not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from limner.errors import FileFormatError, LimnerError, LimnerWarning
from limner.files.limits import Limits
from limner.files.load import load
from limner.files.obj import read
from limner.mesh.mesh import Mesh
from limner.scene.material import BlinnPhong, Lambert, MetallicRoughness
from limner.scene.scene import Scene
from limner.scene.texture import Texture

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def scene_of(text: str | bytes, **keywords: Limits) -> Scene:
    """Read an OBJ file that lies nowhere."""
    return read(text if isinstance(text, bytes) else text.encode(), "model.obj", **keywords)


def mesh_of(text: str | bytes) -> Mesh:
    """Return the only mesh of a text."""
    ((_, shape),) = scene_of(text).shapes()
    assert isinstance(shape.geometry, Mesh)
    return shape.geometry


def test_corners_keep_their_indices() -> None:
    """Positions, coordinates and normals are referred to separately; nothing is split."""
    mesh = mesh_of(SQUARE + "vt 0 0\nvt 1 1\nvn 0 0 1\nvn 0 0 2\nf 1/1/1 2/2/1 3/1/2\nf 1/2/2 3/2/2 4/1/1\n")
    np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2], [0, 2, 3]])
    np.testing.assert_array_equal(mesh.uv_triangles, [[0, 1, 0], [1, 1, 0]])
    np.testing.assert_array_equal(mesh.normal_triangles, [[0, 0, 1], [1, 1, 0]])
    np.testing.assert_array_equal(mesh.normals, [[0, 0, 1], [0, 0, 1]])
    assert len(mesh.positions) == 4


@pytest.mark.parametrize("repeat", [1, 40])
@pytest.mark.parametrize("corner", ["{0}", "{0}/{0}", "{0}//{0}", "{0}/{0}/{0}"])
@pytest.mark.parametrize("signed", [False, True])
def test_every_shape_of_corner(corner: str, signed: bool, repeat: int) -> None:
    """a, a/b, a//c, a/b/c, counted from the front or from behind, many alike (in bulk) or few (one by one): one mesh."""
    face = "f " + " ".join(corner.format(i - 5 if signed else i) for i in (1, 2, 3, 4)) + "\n"
    rest = "".join(f"vt 0.{i} 0\nvn 0 0 1\n" for i in range(4))
    mesh = mesh_of(SQUARE + rest + face * repeat)
    np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2], [0, 2, 3]] * repeat)
    assert (mesh.uvs is not None) == (corner.count("/") in (1, 2) and "//" not in corner)
    if mesh.uv_triangles is not None:
        np.testing.assert_array_equal(mesh.uv_triangles, mesh.triangles)


def test_indices_from_behind_count_from_their_line() -> None:
    """-1 is the last vertex so far, not the last of the file."""
    mesh = mesh_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\n")
    np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2], [3, 4, 5]])


def test_layout_does_not_matter() -> None:
    """Other line ends, tabs, indentation, comments, continuations, a byte order mark: the same mesh."""
    plain = SQUARE + "f 1 2 3\nf 1 3 4\n"
    variants = [
        plain.replace("\n", "\r\n"), plain.replace("\n", "\r"), plain.replace(" ", "\t"), plain.replace("\n", "  \n\n  "),
        plain.replace("\n", " # v 9 9 9\n# f 1 2 4\n"), plain.replace("f 1 3", "f 1 \\\n 3"), "\ufeff" + plain, plain.rstrip(),
        plain.replace("f 1 3", "f 1 \\\r\n 3"),
    ]  # fmt: skip
    expected = mesh_of(plain)
    for variant in variants:
        mesh = mesh_of(variant)
        np.testing.assert_array_equal(mesh.positions, expected.positions)
        np.testing.assert_array_equal(mesh.triangles, expected.triangles)


def test_mixed_polygons_stay_in_order() -> None:
    """Triangles, quadrilaterals and pentagons, alternating, come out in the file's order."""
    text = SQUARE + "v 0.5 2 0\n" + "f 1 2 3\nf 1 2 3 4\nf 1 2 3 5 4\nf 2 3 4\n" * 10
    mesh = mesh_of(text)
    block = [[0, 1, 2], [0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 4], [0, 4, 3], [1, 2, 3]]
    np.testing.assert_array_equal(mesh.triangles, block * 10)


def test_materials_are_slots() -> None:
    """usemtl gives each triangle a slot; what is not defined is grey, and said."""
    scene = scene_of(SQUARE + "f 1 2 3\nusemtl a\nf 1 2 4\nusemtl b #1\nf 1 3 4\nusemtl a\nf 2 3 4\n")
    ((_, shape),) = scene.shapes()
    assert isinstance(shape.geometry, Mesh)
    assert shape.geometry.triangle_materials is not None
    names = [shape.materials[slot].name for slot in shape.geometry.triangle_materials]
    assert names == ["", "a", "b #1", "a"]
    assert any("'b #1' is not defined" in note for note in scene.notes)
    assert scene_of(SQUARE + "f 1 2 3\n").shapes()[0][1].materials == (Lambert((0.8, 0.8, 0.8)),)


def test_objects_become_nodes() -> None:
    """One child for each `o` that has faces, with positions of its own; a group only names the whole."""
    scene = scene_of(SQUARE + "o left\ng x\nf 1 2 3\no empty\no right\nv 7 0 0\nv 8 0 0\nv 7 1 0\nf 5 6 7\n")
    assert [placed.path for placed, _ in scene.shapes()] == ["world/left", "world/right"]
    assert [len(shape.geometry.positions) for _, shape in scene.shapes()] == [3, 3]  # type: ignore[union-attr]
    assert scene_of(SQUARE + "g wall\nf 1 2 3\n").shapes()[0][0].path == "world/wall"
    assert scene_of(SQUARE + "f 1 2 3\n").shapes()[0][0].path == "world/model"


def test_smoothing() -> None:
    """Without normals: smooth below the crease; `s off` faceted; a smoothing group smooth whatever the angle."""
    tent = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 {}\n"
    faces = "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
    assert mesh_of(tent.format(3) + "s off\n" + faces).normals is None
    flat, steep = mesh_of(tent.format(0.05) + faces), mesh_of(tent.format(3) + faces)
    grouped = mesh_of(tent.format(3) + "s 1\n" + faces)

    def at_tip(mesh: Mesh) -> int:
        assert mesh.normals is not None
        assert mesh.normal_triangles is not None
        return len(np.unique(mesh.normals[mesh.normal_triangles[:, 2]].round(4), axis=0))

    assert (at_tip(flat), at_tip(steep), at_tip(grouped)) == (1, 4, 1)
    mixed = mesh_of(tent.format(3) + "s 1\nf 1 2 5\nf 2 3 5\ns 0\nf 3 4 5\nf 4 1 5\n")
    assert at_tip(mixed) == 3


def test_faces_with_and_without_normals() -> None:
    """Given normals are kept to the letter, the other faces get their own."""
    mesh = mesh_of(SQUARE + "v 0 0 1\nvn 0.6 0 0.8\nf 1//1 2//1 3//1\nf 1 4 5\n")
    assert mesh.normals is not None
    assert mesh.normal_triangles is not None
    corners = mesh.normals[mesh.normal_triangles]
    np.testing.assert_allclose(corners[0], [[0.6, 0, 0.8]] * 3, rtol=1e-6)
    np.testing.assert_allclose(corners[1], [[1, 0, 0]] * 3, atol=1e-6)


def test_faces_with_and_without_coordinates() -> None:
    """Faces without texture coordinates lie at (0, 0) of the picture."""
    mesh = mesh_of(SQUARE + "vt 0.5 0.25\nf 1/1 2/1 3/1\nf 1 3 4\n")
    assert mesh.uvs is not None
    assert mesh.uv_triangles is not None
    np.testing.assert_array_equal(mesh.uvs[mesh.uv_triangles[:, 0]], [[0.5, 0.25], [0, 0]])


def test_vertex_colours() -> None:
    """x y z r g b, with or without w: decoded from sRGB, as fractions or as bytes."""
    for text in ("v {} 0 0 1 0.5 0\n", "v {} 0 0 1.0 1 0.5 0\n", "v {} 0 0 255 127.5 0\n"):
        body = "".join(text.format(x) for x in range(2)) + text.format(0).replace(" 0 0 ", " 1 0 ", 1)
        mesh = mesh_of(body + "f 1 2 3\n")
        assert mesh.colors is not None
        np.testing.assert_allclose(mesh.colors[:, :3], [[1.0, 0.2140411, 0.0]] * 3, atol=1e-6)


@pytest.mark.parametrize(
    "face",
    ["f 1 2", "f 1 2 9", "f 1 2 0", "f a b c", "f 1/ /2 3", "f 1 2 1.5", "f", "f 1 2 -9", "f 1/1/1/1 2 3", "f 1 2 9e9"],
)  # fmt: skip
def test_malformed_faces_are_counted(face: str) -> None:
    """A bad face is left out with the line of the first; alone it is an error with that line."""
    with pytest.raises(FileFormatError, match="no face can be read") as caught:
        scene_of(SQUARE + face + "\n")
    assert caught.value.position == "line 5"
    for good in ("f 1 2 3\n", "f 1 2 3\n" * 50):
        scene = scene_of(SQUARE + good + face + "\n" + face + "\n")
        line = 5 + good.count("\n")
        assert scene.notes[0] == f"2 faces cannot be read and are left out, the first in line {line}"


def test_malformed_vertices_keep_their_number(tmp_path: Path) -> None:
    """A vertex that cannot be read still counts, and only its faces are lost."""
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv x 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 1\nf 1 3 4\nf 1 2 3\nf 1 5 3\nf 1 6 3\n")
    with pytest.warns(LimnerWarning, match="3 faces with positions that are no numbers are left out, the first in line 8"):
        scene = load(path)
    np.testing.assert_array_equal(scene.shapes()[0][1].geometry.triangles, [[0, 2, 3]])  # type: ignore[union-attr]
    assert np.isfinite(scene.bounds()).all()


@pytest.mark.parametrize("text", [SQUARE, "# nothing\n", "hello", "l 1 2\n"])
def test_files_without_faces(text: str) -> None:
    """A file without faces and lines is an error for people."""
    with pytest.raises(FileFormatError, match=r"has no faces|neither faces nor lines"):
        scene_of(text)


def test_binary_rubbish() -> None:
    """Zero bytes are no text."""
    with pytest.raises(FileFormatError, match="no OBJ text"):
        scene_of(b"v 0 0 0\n\0\1\2")


def test_limits() -> None:
    """Too much is refused, by name, before it is parsed."""
    for limits, name in ((Limits(max_vertices=3), "max_vertices"), (Limits(max_triangles=1), "max_triangles")):
        with pytest.raises(FileFormatError, match=name):
            scene_of(SQUARE + "f 1 2 3 4\n", limits=limits)


def test_unread_lines_are_named() -> None:
    """Lines of kinds that are not read are noted, each kind once."""
    notes = scene_of(SQUARE + "curv 1 2\ncurv 2 3\np 1\nf 1 2 3\n").notes
    assert notes == ("line 5: 'curv' lines are ignored", "line 7: 'p' lines are ignored")


LINES = st.one_of(
    st.sampled_from(["v 0 0 0", "v 1 0 0", "v 0 1 0 1 0 0", "vt 0 0", "vn 0 0 1", "f 1 2 3", "f -1 -2 -3", "f 1//1 2//1 3//1"]),
    st.builds("{} {}".format, st.sampled_from(["v", "vt", "vn", "f", "l", "o", "g", "s", "usemtl", "mtllib", "#"]),
              st.text(alphabet="0123456789-+./eE# \t\\naif", max_size=24)),
    st.text(max_size=12),
)  # fmt: skip


@settings(max_examples=300)
@given(lines=st.lists(LINES, max_size=40), end=st.sampled_from(["\n", "\r\n", " \n"]))
def test_any_lines_give_a_scene_or_one_line_of_error(lines: list[str], end: str) -> None:
    """Whatever the lines: a sound scene, or a LimnerError of one line."""
    text = end.join(lines)
    said = ""
    try:
        assert scene_of(text.encode("utf-8", errors="surrogatepass")).shapes()
    except LimnerError as error:
        said = str(error)
    assert "\n" not in said


@settings(max_examples=60)
@given(data=st.data())
def test_bulk_and_careful_paths_agree(data: st.DataObject) -> None:
    """Many lines parsed at once give what the same lines give among odd ones that force the slow path."""
    n = data.draw(st.integers(10, 30))
    number = st.floats(-1e6, 1e6, width=32)
    rows = [" ".join(repr(data.draw(number)) for _ in range(3)) for _ in range(n)]
    faces = [data.draw(st.permutations(range(1, n + 1)))[:3] for _ in range(12)]
    text = "".join(f"v {row}\n" for row in rows) + "".join("f {} {} {}\n".format(*face) for face in faces)
    bulk = mesh_of(text)
    careful = mesh_of(text + "f 1 2 x\nv y 0 0\n")
    np.testing.assert_array_equal(bulk.triangles, careful.triangles)
    np.testing.assert_array_equal(bulk.positions, careful.positions[: len(bulk.positions)])


def test_mtl(tmp_path: Path) -> None:
    """The fields of a library arrive: colours, exponent, opacity, mirror; numbers after a comment do not."""
    (tmp_path / "my lib.mtl").write_text(
        "Kd 9 9 9\nnewmtl red\nKa 1 1 1\nKd 0.8 0.1 0.1 # warm\nKs 0.5\nNs 96\nillum 3\nd 0.5\nKe 0 0 2\n"
        "newmtl matte\n\tKd 0.2 0.3 0.4\n\tKs 1 1 1\n\tillum 1\n\tTr 0.25\nnewmtl bad\nKd red\n"
    )
    path = tmp_path / "a.obj"
    path.write_text("mtllib my lib.mtl\n" + SQUARE + "usemtl red\nf 1 2 3\nusemtl matte\nf 1 3 4\n")
    with pytest.warns(LimnerWarning, match="my lib.mtl, line 16: a number cannot be read"):
        red, matte = load(path).shapes()[0][1].materials
    assert isinstance(red, BlinnPhong)
    assert isinstance(matte, BlinnPhong)
    assert (red.diffuse, red.specular, red.exponent) == ((0.8, 0.1, 0.1), (0.5, 0.5, 0.5), 96.0)
    assert (red.mirror, red.emission, red.ambient) == ((0.5, 0.5, 0.5), (0.0, 0.0, 2.0), None)
    assert (red.alpha, red.alpha_mode, matte.alpha) == (0.5, "blend", 0.75)
    assert (matte.diffuse, matte.specular, matte.mirror) == ((0.2, 0.3, 0.4), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_mtl_textures(tmp_path: Path) -> None:
    """Options before a name with spaces; a foreign absolute path falls back to the file of that name beside the model."""
    from PIL import Image

    Image.fromarray(np.arange(12, dtype=np.uint8).reshape(2, 2, 3)).save(tmp_path / "my wall.png")
    (tmp_path / "a.mtl").write_text(
        "newmtl a\nKd 0 0 0\nmap_Kd -s 2 3 1 -o 0.5 0 0 -clamp on my wall.png\n"
        "newmtl b\nmap_Kd C:\\Users\\me\\my wall.png\nPr 0.25\nPm 1\nnewmtl c\nmap_Kd gone.png\n"
    )
    path = tmp_path / "a.obj"
    path.write_text("mtllib a.mtl\n" + SQUARE + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 1 2 4\n")
    with pytest.warns(LimnerWarning, match=r"drawn without map_kd 'gone.png'"):
        a, b, _ = load(path).shapes()[0][1].materials
    texture = a.diffuse_texture  # type: ignore[union-attr]
    assert texture is not None
    assert (texture.scale, texture.offset, texture.wrap_u) == ((2.0, 3.0), (0.5, 0.0), "clamp")
    assert a.diffuse == (1.0, 1.0, 1.0)  # type: ignore[union-attr]
    assert b.base_color_texture.texels is texture.texels  # type: ignore[union-attr]
    assert (b.roughness, b.metallic) == (0.25, 1.0)  # type: ignore[union-attr]
    np.testing.assert_array_equal(texture.texels.pixels[::-1, :, :3], np.arange(12).reshape(2, 2, 3))


def test_mtl_opacity_normals_and_glow(tmp_path: Path) -> None:
    """map_d is alpha; a bump map that holds directions is a normal map, one of heights is left out and said; map_Ke glows white."""
    for name, color in (("blue", (128, 128, 255)), ("grey", (90, 90, 90)), ("half", (128, 128, 128))):
        Image.fromarray(np.full((2, 2, 3), color, dtype=np.uint8)).save(tmp_path / f"{name}.png")
    (tmp_path / "a.mtl").write_text(
        "newmtl a\nKd 1 1 1\nmap_d half.png\nmap_Bump -bm 0.5 blue.png\nmap_Ke grey.png\nnewmtl b\nKd 1 1 1\nbump grey.png\n"
        "newmtl c\nPr 0.5\nnorm blue.png\nmap_d half.png\n"
    )
    path = tmp_path / "a.obj"
    path.write_text("mtllib a.mtl\n" + SQUARE + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 1 2 4\n")
    scene = load(path)
    (shape,) = [shape for _, shape in scene.shapes()]
    a, b, c = shape.materials
    assert isinstance(a, BlinnPhong)
    assert isinstance(b, BlinnPhong)
    assert isinstance(c, MetallicRoughness)
    for material in (a, c):
        assert isinstance(material.alpha_texture, Texture)
        assert isinstance(material.normal_texture, Texture)
        assert (material.alpha_texture.texels.name, material.alpha_mode) == ("half.png", "blend")
        assert material.normal_texture.texels.name == "blue.png"
    assert a.emission == (1.0, 1.0, 1.0)
    assert isinstance(a.emission_texture, Texture)
    assert (b.normal_texture, b.bump_texture) == (None, None)
    assert any("bump is ignored: MTL does not say how high" in note for note in scene.notes)


@pytest.mark.parametrize("library", ["gone.mtl", "../x.mtl", "/etc/passwd"])
def test_missing_libraries(tmp_path: Path, library: str) -> None:
    """A library that is missing or lies elsewhere is a warning; the model is drawn in grey."""
    path = tmp_path / "a.obj"
    path.write_text(f"mtllib {library}\n" + SQUARE + "usemtl a\nf 1 2 3\n")
    with pytest.warns(LimnerWarning, match="materials of .* are missing"):
        assert load(path).shapes()[0][1].materials[0].name == "a"


@pytest.mark.parametrize(
    ("vertex", "face", "reason"),
    [
        ("v 0 1 0", "f 1 2 9", "refers to a vertex that is not there: the file has 3"),
        ("v 0 1 nan", "f 1 2 3", "uses a position that is not finite"),
        ("v 0 1 0", "f 1 x 3", "is not three or more corners of the form"),
    ],
)
def test_a_file_without_a_sound_face_says_why(tmp_path, vertex, face, reason):
    """One line: the file, the line, and what is wrong with its face."""
    path = tmp_path / "broken.obj"
    path.write_text(f"v 0 0 0\nv 1 0 0\n{vertex}\n{face}\n")
    with pytest.raises(FileFormatError, match=reason) as told:
        load(path)
    assert told.value.position == "line 4"
    assert "\n" not in str(told.value)
